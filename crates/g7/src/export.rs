//! `g7 export`: writes a chart in the format of another tool.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use clap::builder::PossibleValue;
use g7_exchange::{Dialect, FORMATS, Format};
use g7_model::{Severity, say};

use crate::failure::{Failure, Verdict, raw};
use crate::message::{talk, tell};
use crate::report::{self, Tally};
use crate::{files, sources};

const EXAMPLES: &str = "\
Examples:
  g7 export tank --to mermaid           to the standard output
  g7 export tank -o tank.mmd            to a file; its ending says the form
  g7 export tank --to plcopen -o t.xml --compare   and prove that it does the same

What the form cannot carry is reported with its place, never dropped in silence.

Exit codes:
  0  fine
  1  the chart has errors, the form cannot carry what it means, or --compare shows a difference
  2  bad usage, or something outside the chart: no such file, a full disk
  3  --compare is not decided";

/// The arguments of `g7 export`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Export {
    /// A .g7 file, a file of another tool, or a folder with a chart.g7.
    #[arg(default_value = ".")]
    file: PathBuf,
    /// The format, if the name of the output does not tell it.
    #[arg(long, value_enum, value_name = "FORM")]
    to: Option<Form>,
    /// The tool that is to open a PLCopen file [default: beremiz].
    #[arg(long, value_enum, value_name = "TOOL")]
    dialect: Option<Tool>,
    /// The file to write [default: the standard output].
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the output file if it exists.
    #[arg(long)]
    force: bool,
    /// Write the file even if it would not have the same meaning.
    #[arg(long)]
    lossy: bool,
    /// Read the file back, and compare it with the chart over all runs, as `g7 compare` does.
    #[arg(long, requires = "output")]
    compare: bool,
}

/// A format, as a word of the command line.
#[derive(Clone, Copy, Debug)]
struct Form(&'static Format);

impl ValueEnum for Form {
    fn value_variants<'a>() -> &'a [Form] {
        static ALL: std::sync::LazyLock<Vec<Form>> =
            std::sync::LazyLock::new(|| FORMATS.iter().filter(|f| f.is_written()).map(Form).collect());
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.word).help(self.0.title))
    }
}

/// A dialect, as a word of the command line.
#[derive(Clone, Copy, Debug)]
struct Tool(Dialect);

impl ValueEnum for Tool {
    fn value_variants<'a>() -> &'a [Tool] {
        static ALL: std::sync::LazyLock<Vec<Tool>> =
            std::sync::LazyLock::new(|| Dialect::ALL.into_iter().map(Tool).collect());
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.word()))
    }
}

/// Compares a chart with what was read back.
pub(crate) type ReadBack = fn(sources::Source, sources::Source) -> Result<Verdict, Failure>;

pub(crate) fn export(args: &Export, read_back: ReadBack) -> Result<Verdict, Failure> {
    let to = form(args)?;
    let path = files::one(&args.file)?;
    let source = sources::load(&path, 0)?;
    files::refuse_source(args.output.as_deref(), &[&path])?;
    files::refuse_present(args.output.as_deref(), args.force)?;
    if args.compare && !to.is_read() {
        return Err(Failure::Usage(say!(
            "{} is not read back: there is nothing to compare with",
            raw(to.title)
        )));
    }
    let mut problems = source.read_problems();
    if !source.is_broken() {
        problems.extend(g7_compile::check(source.whole()));
    }
    if problems.iter().any(|p| p.severity() == Severity::Error) {
        problems.retain(|p| p.severity() == Severity::Error);
        return Ok(found(&source, &problems));
    }
    let written = match args.dialect {
        Some(tool) => to.write_in(source.whole(), tool.0).ok_or_else(|| {
            Failure::Usage(say!("{} has no dialects; --dialect is for PLCopen XML", raw(to.title)))
        })?,
        None => to
            .write(source.whole())
            .ok_or_else(|| Failure::Usage(say!("{} is not written", raw(to.title))))?,
    };
    let lost = written.problems.iter().any(|p| p.severity() == Severity::Error);
    if !written.problems.is_empty() {
        found(&source, &written.problems);
    }
    if lost && !args.lossy {
        tell(say!("nothing is written; --lossy writes it all the same"));
        return Ok(Verdict::Found);
    }
    files::deliver(args.output.as_deref(), written.text.as_bytes())?;
    match &args.output {
        Some(path) if args.compare => read_back(source, sources::load(path, 0)?),
        _ => Ok(Verdict::Fine),
    }
}

fn found(source: &sources::Source, problems: &[g7_model::Problem]) -> Verdict {
    talk!("{}", report::text(source, problems).trim_end());
    talk!("{}: {}", source.name, Tally::of(problems));
    Verdict::Found
}

/// The format chosen by `--to` or by the extension of the output.
fn form(args: &Export) -> Result<&'static Format, Failure> {
    let by_name = |path: &Path| {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        let mut fits = FORMATS.iter().filter(|f| f.is_written() && f.ending() == ending);
        // Several formats share an extension such as .xml; then it decides nothing.
        fits.next().filter(|_| fits.next().is_none())
    };
    args.to.map(|form| form.0).or_else(|| by_name(args.output.as_ref()?)).ok_or_else(|| {
        let words: Vec<&str> = FORMATS.iter().filter(|f| f.is_written()).map(|f| f.word).collect();
        Failure::Usage(say!("say the form with --to: {}", raw(words.join(", "))))
    })
}
