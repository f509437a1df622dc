//! `g7 graph`: the situations that a chart reaches, for Graphviz, as data, or as a picture.

mod named;
mod picture;

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use g7_model::{Nanos, ProfileName, Said, say};
use g7_verify::{Budget, Kind, Model, ask, situations, words};

use named::Named;

use crate::failure::{Failure, Verdict, raw};
use crate::message::{talk, tell};
use crate::report::{self, Tally};
use crate::{files, sources, values};

const EXAMPLES: &str = "\
Examples:
  g7 graph tank -o tank.svg           a picture of up to some hundred situations
  g7 graph tank | dot -Tpdf > g.pdf   drawn by Graphviz
  g7 graph tank -o tank.json          as data, of any size

A node is a situation: the active steps. It stands for all states with these steps, whatever their
times and variables. An edge has the inputs under which one scan leads from one situation to the
other in some state, `a · not b + c`; where no input matters, the transitions that clear.

Exit codes:
  0  the graph is complete
  1  the chart has errors
  2  bad usage, or something outside the chart: no such file, a full disk
  3  the graph is not complete";

/// The arguments of `g7 graph`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Graph {
    /// A .g7 file, a file of another tool, or a folder with a chart.g7.
    #[arg(default_value = ".")]
    file: PathBuf,
    /// The file to write: .dot, .json or .svg [default: the standard output].
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The format, if the name of the output does not tell it.
    #[arg(long = "as", value_enum, value_name = "FORM")]
    form: Option<Form>,
    /// Most situations of a drawing.
    #[arg(long, value_name = "NUMBER", default_value_t = 300)]
    most: usize,
    /// The profile to use instead of the file's own.
    #[arg(long, value_parser = values::profiles())]
    profile: Option<ProfileName>,
    /// Stop after this time.
    #[arg(long, value_parser = values::duration, value_name = "TIME", default_value = "60s")]
    time: Nanos,
    /// Memory for states, in MiB.
    #[arg(long, value_name = "MIB", default_value_t = 1024)]
    memory: usize,
    /// Replace an output that is there and that g7 did not write; never the chart itself.
    #[arg(long)]
    force: bool,
    /// Most states of the search.
    #[arg(long, value_name = "NUMBER", default_value_t = 20_000_000)]
    states: usize,
}

/// The form of a graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Form {
    /// For Graphviz.
    Dot,
    /// For programs: one JSON object.
    Json,
    /// A picture.
    Svg,
}

pub(crate) fn graph(args: &Graph) -> Result<Verdict, Failure> {
    let form = form(args)?;
    let path = files::one(&args.file)?;
    files::refuse_foreign(args.output.as_deref(), &[&path], args.force)?;
    let source = sources::load(&path, 0)?;
    let (asked, found) =
        if source.is_broken() { (None, Vec::new()) } else { ask(source.whole(), args.profile) };
    let problems: Vec<_> = source.read_problems().into_iter().chain(found).collect();
    let Some(asked) = asked.filter(|_| Tally::of(&problems).errors == 0) else {
        talk!("{}", report::text(&source, &problems).trim_end());
        return Ok(Verdict::Found);
    };
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let stop = super::patience::Patience::new()?.within(args.time);
    let bytes = args.memory.saturating_mul(1 << 20);
    let budget = Budget { states: args.states, scans: usize::MAX, bytes, stop: &*stop };
    let graph = situations(&model, &budget);
    let named = Named {
        symbols: &asked.compiled.symbols,
        first: asked.compiled.program.tables().inputs.start,
        graph: &graph,
    };
    let drawn = graph.nodes.iter().filter(|n| n.kind == Kind::Situation).count();
    if form != Form::Json && drawn > args.most {
        return Err(Failure::Usage(say!(
            "{drawn} situations are too many for a drawing: write data with --as json, draw one chart alone, \
             assume what the environment keeps, or allow more than {} with --most",
            raw(args.most)
        )));
    }
    let text = match form {
        Form::Dot => named.dot(),
        Form::Json => format!("{:#}\n", named.json(&source.name)),
        Form::Svg => picture::svg(&named),
    };
    files::deliver(args.output.as_deref(), text.as_bytes())?;
    tell(say!(
        "{drawn} situations and {} edges, from {} states by {} scans",
        graph.edges.len(),
        graph.states,
        graph.scans
    ));
    Ok(match &graph.open {
        None => Verdict::Fine,
        Some(open) => {
            let why = Said::in_each(words::why(&open.reason));
            let help = Said::in_each(words::way_on(&open.reason));
            tell(say!("the graph is not complete: {why}; {help}"));
            Verdict::Open
        }
    })
}

fn form(args: &Graph) -> Result<Form, Failure> {
    let ending = |path: &Path| path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    match (args.form, &args.output) {
        (Some(form), _) => Ok(form),
        (None, None) => Ok(Form::Dot),
        (None, Some(path)) => match ending(path).as_deref() {
            Some("dot" | "gv") => Ok(Form::Dot),
            Some("json") => Ok(Form::Json),
            Some("svg") => Ok(Form::Svg),
            _ => {
                let name = path.display();
                Err(Failure::Usage(say!(
                    "{name} ends in none of .dot, .json, .svg; --as says the form",
                    name = raw(&name)
                )))
            }
        },
    }
}
