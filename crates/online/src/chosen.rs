//! The table `[history]` held against the chart: which words of a run are recorded.

use g7_host::Kind;
use g7_model::{Problem, Said, codes, say};
use g7_rig::{Bench, Item, Role, StepItem};

use crate::names::{Named, named, source_of};
use crate::setup::{At, History, SIGNALS};
use crate::word::Source;

/// The signals that are recorded, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// The file beside the io file.
    pub file: String,
    /// Changes that are older than so many days are deleted.
    pub days: u32,
    /// The greatest size of the record, in MB.
    pub megabytes: u32,
    /// The signals.
    pub signals: Vec<Recorded>,
}

/// A signal that is recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// The variable, or the step by its step variable.
    pub name: String,
    /// `inputs`, `outputs`, `variables` or `steps`.
    pub group: &'static str,
    /// How its word is to be read.
    pub kind: Kind,
    /// Its type, as the language writes it.
    pub ty: String,
    /// The author's comment.
    pub comment: Option<String>,
    pub(crate) source: Source,
    /// The number of an input word.
    pub(crate) input: Option<u32>,
    /// The safe value of an output.
    pub(crate) safe: Option<u64>,
    /// A number is recorded when it has moved by so much; 0 for each change.
    pub(crate) band: f64,
}

/// Chooses the signals. A name that cannot be recorded is left out and told.
pub(crate) fn choose(bench: &Bench, history: &History, problems: &mut Vec<Problem>) -> Chosen {
    let mut signals: Vec<Recorded> = Vec::new();
    match &history.signals {
        None => {
            let items = bench.items.iter().filter(|i| i.role != Role::Plant && i.kind != Kind::Text);
            signals.extend(items.map(|item| of_item(bench, item)));
            signals.extend(bench.steps.iter().map(of_step));
        }
        Some(names) => {
            for name in names {
                match of_name(bench, name) {
                    Ok(signal) if signals.iter().any(|s| s.name == signal.name) => problems.push(
                        Problem::new(&codes::WIRED_TWICE, name.at, say!("`{}` is named twice", signal.name)),
                    ),
                    Ok(signal) => signals.push(signal),
                    Err(problem) => problems.push(*problem),
                }
            }
        }
    }
    if signals.len() > SIGNALS {
        let what = say!("{} signals are too many: {SIGNALS} can be recorded", signals.len());
        let mut problem = Problem::new(&codes::BAD_WIRING, history.file.at, what);
        problem.help = Some(say!("name those that matter: `signals = [\"start\", \"X3\"]`"));
        problems.push(problem);
        signals.truncate(SIGNALS);
    }
    for (name, band) in &history.deadband {
        if let Err(problem) = set_band(bench, &mut signals, name, *band) {
            problems.push(*problem);
        }
    }
    let History { file, days, megabytes, .. } = history;
    Chosen { file: file.value.clone(), days: *days, megabytes: *megabytes, signals }
}

fn of_name(bench: &Bench, name: &At<String>) -> Result<Recorded, Box<Problem>> {
    match named(bench, name)? {
        Named::Step(step) => Ok(of_step(step)),
        Named::Item(item) if item.kind == Kind::Text => {
            let what = say!("`{}` is a STRING, which cannot be recorded", item.name);
            Err(Box::new(Problem::new(&codes::WRONG_CHANNEL, name.at, what)))
        }
        Named::Item(item) => Ok(of_item(bench, item)),
    }
}

fn of_step(step: &StepItem) -> Recorded {
    Recorded {
        name: step.activity(),
        group: "steps",
        kind: Kind::Bool,
        ty: "BOOL".to_owned(),
        comment: step.comment.clone(),
        source: source_of(step),
        input: None,
        safe: None,
        band: 0.0,
    }
}

fn of_item(bench: &Bench, item: &Item) -> Recorded {
    let (group, input) = match item.role {
        Role::Input(index) => ("inputs", Some(index)),
        Role::Output => ("outputs", None),
        Role::Variable | Role::Plant => ("variables", None),
    };
    Recorded {
        name: item.name.clone(),
        group,
        kind: item.kind,
        ty: item.ty.to_string(),
        comment: item.comment.clone(),
        source: Source::Word(g7_engine::Addr(item.addr)),
        input,
        safe: bench.safe(item),
        band: 0.0,
    }
}

fn set_band(
    bench: &Bench,
    signals: &mut [Recorded],
    name: &At<String>,
    band: f64,
) -> Result<(), Box<Problem>> {
    let known = match named(bench, name)? {
        Named::Item(item) => item.name.clone(),
        Named::Step(step) => step.activity(),
    };
    let wrong = |what: Said| Err(Box::new(Problem::new(&codes::WRONG_CHANNEL, name.at, what)));
    match signals.iter_mut().find(|s| s.name == known) {
        None => wrong(say!("`{known}` has a deadband and is not recorded")),
        Some(signal) if signal.kind == Kind::Bool => {
            wrong(say!("`{known}` is a BOOL: only numbers have a deadband"))
        }
        Some(signal) => {
            signal.band = band;
            Ok(())
        }
    }
}
