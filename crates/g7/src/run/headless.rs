//! Runs without the terminal view: virtual time, traces, a printed chronogram.

use std::io::{IsTerminal, Write, stdout};
use std::path::Path;

use g7_host::{
    Chronogram, Clock, Fnv, Kind, Recording, Runner, Style, Tape, Value, VirtualClock, WallClock, write_csv,
    write_vcd,
};

use super::keep::{self, Keeper};
use super::outside::{self, Outside};
use crate::cli::Run;
use crate::ended::Ended;
use crate::failure::{Failure, Verdict, raw};
use crate::message::{note, talk, tell, told, wrote};
use crate::progress::Progress;
use crate::sources::Source;
use crate::values::Assign;
use crate::{files, style};
use g7_model::{Nanos, Said, say};
use g7_rig::{Bench, Conflicts, Item, Role};

/// The length of a run if none is given.
const UNSAID: Nanos = Nanos::from_millis(10_000);
/// Changes kept for each signal if no trace is written.
const KEPT: usize = 200_000;
/// Most lanes of a chronogram.
const LANES: usize = 40;

/// The format of a trace file.
#[derive(Clone, Copy)]
enum Form {
    Csv,
    Vcd,
}

fn form(path: &Path) -> Result<Form, Failure> {
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("csv") => Ok(Form::Csv),
        Some("vcd") => Ok(Form::Vcd),
        _ => Err(Failure::Usage(say!(
            "cannot tell the form of {} by its name: end it in .csv or .vcd",
            raw(path.display())
        ))),
    }
}

pub(super) fn run(bench: &Bench, source: &Source, args: &Run) -> Result<Verdict, Failure> {
    let trace = args.trace.as_deref().map(|path| form(path).map(|form| (path, form))).transpose()?;
    let script = script(bench, &args.set)?;
    let shown = shown(bench, args)?;
    let outside = args.plant.as_deref().filter(|p| outside::is_fmu(Some(p)));
    let mut outside = outside.map(|path| Outside::open(Path::new(path), bench, &args.wire)).transpose()?;
    let mut runner = bench.runner(args.seed);
    if args.record.is_some() {
        runner = runner.with_tape();
    }
    keep::load(bench, &mut runner, args.retain.as_deref())?;
    // A trace needs all changes; the chronogram needs only the latest ones, so the memory of a long
    // run is limited.
    let whole = Recording::new(bench.signals());
    let mut recording = if trace.is_some() { whole } else { whole.with_limit(KEPT) };
    let length = args.duration.unwrap_or(UNSAID);
    let mut clock: Box<dyn Clock> =
        if args.real_time { Box::new(WallClock::default()) } else { Box::new(VirtualClock::default()) };
    let mut keeper = Keeper::new(bench, &runner, args.retain.as_deref());
    let mut live = args.real_time.then_some(&mut keeper);
    let sides = (&mut runner, &mut outside);
    let ended = Ended::new()?;
    let until = (length, &ended);
    let halt = play(bench, sides, &mut recording, &script, until, &mut *clock, &mut live)?;
    if ended.is_so() {
        let now = raw(Nanos::new(runner.state().now()).plain());
        tell(say!("ended at {now}: what is asked for is written up to here"));
    }
    let verdict = if let Some(halt) = halt {
        let place = bench.halt_place(halt).map_or_else(String::new, |at| format!("{}: ", source.place(at)));
        let now = raw(Nanos::new(runner.state().now()).plain());
        let what = told(&say!("fault at {now}: {}", bench.halt(&runner, halt)));
        talk!("{place}{}{what}{:#}", style::BAD, style::BAD);
        Verdict::Found
    } else {
        Verdict::Fine
    };
    if runner.missed() > 0 {
        tell(say!("{} scans came too late and were skipped", runner.missed()));
    }
    if let Some((path, form)) = trace {
        write_trace(&recording, path, form)?;
    }
    if let (Some(path), Some(tape)) = (&args.record, runner.tape()) {
        files::write(path, tape.text_about(inputs(bench)).as_bytes())?;
    }
    keeper.save(&runner)?;
    print(bench, &runner, &recording, source, &shown)?;
    Ok(verdict)
}

/// The values that are set, with their times.
type Script<'b> = Vec<(Nanos, &'b Item, Value)>;

/// The assignments of `--set`, ordered by time, then by their order in the arguments.
fn script<'b>(bench: &'b Bench, set: &[Assign]) -> Result<Script<'b>, Failure> {
    let mut script = Vec::new();
    for assign in set {
        let Some(item) = bench.item(&assign.name) else {
            return Err(Failure::Usage(say!("--set: {}", bench.unknown(&assign.name))));
        };
        let value =
            item.read(&assign.value).map_err(|e| Failure::Usage(say!("--set {}: {e}", raw(&assign.name))))?;
        script.push((assign.at, item, value));
    }
    script.sort_by_key(|(at, ..)| *at);
    Ok(script)
}

fn shown(bench: &Bench, args: &Run) -> Result<Vec<usize>, Failure> {
    let signals = bench.signals();
    let find = |name: &String| {
        signals.iter().position(|s| s.name == *name).ok_or_else(|| {
            Failure::Usage(match bench.near(name) {
                none if none.is_empty() => say!("--show: there is no `{name}`"),
                near => say!("--show: there is no `{name}`; {near}"),
            })
        })
    };
    args.show.iter().map(find).collect()
}

/// Makes scans until `length` has passed, including the scan at its end, or until it is ended.
fn play(
    bench: &Bench,
    (runner, outside): (&mut Runner, &mut Option<Outside>),
    recording: &mut Recording,
    script: &[(Nanos, &Item, Value)],
    (length, ended): (Nanos, &Ended),
    clock: &mut dyn Clock,
    live: &mut Option<&mut Keeper<'_>>,
) -> Result<Option<g7_host::Halt>, Failure> {
    let mut progress = Progress::new("running", length.count().max(1) as u64);
    let mut script = script.iter().peekable();
    let mut conflicts = Conflicts::default();
    while runner.due() <= length && !ended.is_so() {
        clock.wait_until(runner.due());
        runner.catch_up(clock.now());
        while let Some((_, item, value)) = script.next_if(|(at, ..)| *at <= runner.due()) {
            if bench.is_driven(runner, item) || outside.as_ref().is_some_and(|o| o.drives(bench, item)) {
                bench.force(runner, item, value);
            } else {
                bench.set(runner, item, value);
            }
        }
        if let Some(outside) = outside {
            outside.step(bench, runner)?;
        }
        let done = runner.scan();
        recording.sample(Nanos::new(runner.state().now()), bench.sample(runner));
        if let Err(halt) = done {
            progress.end();
            return Ok(Some(halt));
        }
        if let Some(conflict) = conflicts.of(bench, runner) {
            note(conflict);
        }
        if let Some(keeper) = live {
            keeper.tick(runner)?;
        }
        if runner.state().scans().is_multiple_of(256) {
            progress.at(runner.due().count().max(0) as u64);
        }
    }
    progress.end();
    Ok(None)
}

fn write_trace(recording: &Recording, path: &Path, form: Form) -> Result<(), Failure> {
    let mut bytes = Vec::new();
    match form {
        Form::Csv => write_csv(recording, &mut bytes),
        Form::Vcd => write_vcd(recording, &mut bytes),
    }
    .map_err(|e| Failure::Write(path.to_path_buf(), e))?;
    files::write(path, &bytes)?;
    wrote(path.display());
    Ok(())
}

/// Prints the final situation, and the chronogram of the run.
fn print(
    bench: &Bench,
    runner: &Runner,
    recording: &Recording,
    source: &Source,
    shown: &[usize],
) -> Result<(), Failure> {
    let mut out = anstream::stdout().lock();
    let state = runner.state();
    let situation = bench.situation(state).join(", ");
    let (time, scans, period) =
        (raw(Nanos::new(state.now()).plain()), state.scans(), raw(bench.period.plain()));
    let situation = raw(format!("{{{situation}}}"));
    let name = raw(format!("{}{}{:#}", style::STRONG, source.name, style::STRONG));
    let ran = match &bench.plant {
        Some(p) => {
            say!(
                "{name} with plant {}: {time} in {scans} scans of {period}, now in {situation}",
                raw(&p.name)
            )
        }
        None => say!("{name}: {time} in {scans} scans of {period}, now in {situation}"),
    };
    writeln!(out, "{}\n", told(&ran))?;
    let mut lanes: Vec<usize> = shown.to_vec();
    if lanes.is_empty() {
        lanes = Bench::moving(recording);
    }
    if lanes.is_empty() {
        writeln!(out, "{}", told(&nothing_moved(bench, runner)))?;
        return Ok(out.flush()?);
    }
    let left = lanes.len().saturating_sub(LANES);
    lanes.truncate(LANES);
    let columns = columns(recording, &lanes);
    let to = recording.end() + bench.period;
    let style = Style { columns, from: recording.start(), to, until: to };
    write!(out, "{}", Chronogram::new(recording, lanes, style))?;
    if left > 0 {
        let more = say!(
            "… and {left} more signals that changed; --show selects signals, --trace records all of them"
        );
        writeln!(out, "{}", told(&more))?;
    }
    Ok(out.flush()?)
}

/// Tells that nothing moved, and suggests an input to set: one that the plant does not drive, if possible a
/// BOOL.
fn nothing_moved(bench: &Bench, runner: &Runner) -> Said {
    let inputs = || bench.items.iter().filter(|i| matches!(i.role, Role::Input(_)));
    let free = || inputs().filter(|i| !bench.is_driven(runner, i));
    let Some(input) = free().find(|i| i.kind == Kind::Bool).or_else(|| free().next()) else {
        return say!("nothing moved");
    };
    let value = match input.kind {
        Kind::Time => "1s".to_owned(),
        Kind::Moment(moment) => moment.text(Nanos::ZERO),
        _ => "1".to_owned(),
    };
    let assign = format!("{}={value}@1s", input.name);
    let plain = |c: char| c.is_alphanumeric() || "_.=@".contains(c);
    let quote = if assign.chars().all(plain) { "" } else { "'" };
    say!("nothing moved; `--set {quote}{assign}{quote}` sets an input after 1s")
}

/// The number of columns for the lanes: the width of the terminal without labels and notes.
fn columns(recording: &Recording, lanes: &[usize]) -> usize {
    let said = || std::env::var("COLUMNS").ok().and_then(|c| c.parse().ok());
    let size = || crossterm::terminal::size().ok().map(|(columns, _)| usize::from(columns));
    let width = if stdout().is_terminal() { size() } else { said() };
    let width = width.filter(|w| *w > 0).unwrap_or(110).min(200);
    let labels = lanes.iter().filter_map(|i| recording.signals().get(*i));
    let label = labels.map(|s| s.name.chars().count().min(24)).max().unwrap_or(0);
    width.saturating_sub(label + 20).max(20)
}

/// The tape of a run in virtual time up to an instant, or up to a fault.
pub(crate) fn taped(
    bench: &Bench,
    set: &[Assign],
    seed: u64,
    length: Option<Nanos>,
) -> Result<Tape, Failure> {
    let script = script(bench, set)?;
    let mut runner = bench.runner(seed).with_tape();
    let mut recording = Recording::new(bench.signals()).with_limit(1);
    let until = (length.unwrap_or(UNSAID), &Ended::new()?);
    let sides = (&mut runner, &mut None);
    play(bench, sides, &mut recording, &script, until, &mut VirtualClock::default(), &mut None)?;
    Ok(runner.tape().cloned().unwrap_or_default())
}

/// Reads a record of `--record`, which is one of this chart.
pub(crate) fn tape_of(bench: &Bench, path: &Path) -> Result<Tape, Failure> {
    let text = String::from_utf8(files::read(path)?).unwrap_or_default();
    let tape = Tape::from_text(&text)
        .map_err(|e| Failure::Usage(say!("{} {e}", raw(path.display()), e = raw(e))))?;
    if tape.of() != inputs(bench) {
        return Err(Failure::Usage(say!(
            "{} is a record of another chart: its inputs have other names or types",
            raw(path.display())
        )));
    }
    Ok(tape)
}

/// A hash that tells the record of one chart from that of another: the names and types of the inputs. All else may
/// change, so that a replay shows what a change of the chart does.
fn inputs(bench: &Bench) -> u64 {
    let mut hash = Fnv::default();
    for item in bench.items.iter().filter(|i| matches!(i.role, Role::Input(_))) {
        hash.add(format!("{} {}\n", item.name, item.ty).as_bytes());
    }
    hash.value()
}

/// Replays a record and compares every state.
pub(super) fn replay(bench: &Bench, args: &Run, path: &Path) -> Result<Verdict, Failure> {
    let tape = tape_of(bench, path)?;
    let trace = args.trace.as_deref().map(|path| form(path).map(|form| (path, form))).transpose()?;
    let mut recording = Recording::new(bench.signals());
    let played = tape.replay(&bench.compiled.program, |now, state| {
        recording.sample(now, bench.sample_state(state));
    });
    if let Some((path, form)) = trace {
        write_trace(&recording, path, form)?;
    }
    match played {
        Ok(state) => {
            tell(say!("{} scans, every state as recorded", tape.scans()));
            let mut out = anstream::stdout().lock();
            writeln!(out, "{{{}}}", bench.situation(&state).join(", "))?;
            out.flush()?;
            Ok(Verdict::Fine)
        }
        Err(d) => {
            tell(say!("differs from the record at scan {} ({})", d.scan, raw(d.now.plain())));
            Ok(Verdict::Found)
        }
    }
}
