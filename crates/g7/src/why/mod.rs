//! `g7 why`: a run is made, or made again from its trace or record, and asked (`g7_why`).

mod args;
mod output;
mod trace;

use std::path::{Path, PathBuf};

pub(crate) use args::Why;

use g7_host::Tape;
use g7_model::{Nanos, say};
use g7_rig::{Bench, Options, question};
use g7_why::{NoAnswer, Question};

use crate::failure::{Failure, Verdict, raw};
use crate::form::Format;
use crate::{files, run, sources, values, wiring};

pub(crate) fn why(args: &Why) -> Result<Verdict, Failure> {
    let recorded = Recorded::of(&args.run)?;
    if recorded != Recorded::No && (args.duration.is_some() || !args.set.is_empty()) {
        return Err(Failure::Usage(say!("--for and --set are for a run that is made; this one is recorded")));
    }
    let path = chart_of(args, recorded)?;
    let source = sources::load(&path, 0)?;
    if run::is_fmu(args.plant.as_deref()) {
        return Err(Failure::Usage(say!(
            "an FMU is no plant of this command: ask the trace that `g7 run --trace` writes with it"
        )));
    }
    let options = Options { profile: args.profile, scan: args.scan, plant: args.plant.as_deref(), asks: &[] };
    let Some(bench) = wiring::build(&source, &options)? else { return Ok(Verdict::Found) };
    let (name, time) = about(args.name.as_deref(), args.time.as_deref())?;
    // A name that nothing has is told before a long run is made.
    let asked = match name {
        Some(name) => question(&bench, name).map_err(Failure::Usage)?,
        None => Question::Scan,
    };
    let tape = match recorded {
        Recorded::No => run::taped(&bench, &args.set, args.seed, args.duration.or(time))?,
        Recorded::Tape => run::tape_of(&bench, &args.run)?,
        Recorded::Csv => {
            // The inputs of a trace are given; the plant gives only the names of its columns.
            let alone = Options { plant: Some("none"), ..options };
            let Some(alone) = g7_rig::build(&source, &alone)?.0 else { return Ok(Verdict::Found) };
            trace::taped(&args.run, &alone, &bench)?
        }
    };
    // A run that is made up to the time ends with the last scan before it, whose situation is that of the time.
    let up_to = recorded == Recorded::No && args.duration.is_none();
    let cause = ask(&bench, &tape, asked, time, up_to)?;
    match args.format {
        Format::Text => output::text(&source, &cause)?,
        Format::Json => output::json(&source, &cause)?,
    }
    Ok(Verdict::Fine)
}

fn ask(
    bench: &Bench,
    tape: &Tape,
    asked: Question,
    time: Option<Nanos>,
    up_to: bool,
) -> Result<g7_why::Cause, Failure> {
    let why = g7_why::Why::new(&bench.compiled, tape).map_err(|d| {
        let now = raw(d.now.plain());
        Failure::Usage(say!("the run takes another course than the record at scan {} ({now})", d.scan))
    })?;
    let end = why.span().ok_or_else(|| Failure::Usage(NoAnswer::Empty.said()))?.1;
    let now = time.map_or(end, |time| if up_to { time.min(end) } else { time });
    why.ask(asked, now).map_err(|e| Failure::Usage(e.said()))
}

/// The name and the time of a question; a time that stands alone is no name.
fn about<'a>(
    first: Option<&'a str>,
    second: Option<&str>,
) -> Result<(Option<&'a str>, Option<Nanos>), Failure> {
    let time = |text: &str| values::duration(text).map_err(|e| Failure::Usage(say!("`{text}`: {e}")));
    match (first, second) {
        (None, _) => Ok((None, None)),
        (Some(one), None) => Ok(values::duration(one).map_or((Some(one), None), |time| (None, Some(time)))),
        (Some(name), Some(text)) => Ok((Some(name), Some(time(text)?))),
    }
}

/// The form of a recorded run.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Recorded {
    /// It is a chart.
    No,
    Csv,
    Tape,
}

impl Recorded {
    fn of(path: &Path) -> Result<Recorded, Failure> {
        let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        match ending.as_deref() {
            Some("csv") => return Ok(Recorded::Csv),
            Some("vcd") => {
                return Err(Failure::Usage(say!(
                    "{} is a trace for viewers of waves; write the run as .csv with --trace, or with --record",
                    raw(path.display())
                )));
            }
            _ => {}
        }
        let is_tape = path.is_file() && files::read(path)?.starts_with(Tape::SIGN.as_bytes());
        Ok(if is_tape { Recorded::Tape } else { Recorded::No })
    }
}

/// The chart: that of the option; of a recorded run, the one beside it with its name, or that of its folder.
fn chart_of(args: &Why, recorded: Recorded) -> Result<PathBuf, Failure> {
    if let Some(chart) = &args.chart {
        return files::one(chart);
    }
    if recorded == Recorded::No {
        return files::one(&args.run);
    }
    let beside = args.run.with_extension("g7");
    if beside.is_file() {
        return Ok(beside);
    }
    let folder = args.run.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    files::one(folder).map_err(|_| {
        Failure::Usage(say!("which chart is {} a run of? --chart PATH names it", raw(args.run.display())))
    })
}
