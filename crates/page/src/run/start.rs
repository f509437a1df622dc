//! The start of a run: compiles the text, couples the plant, and numbers everything for the page.

use std::collections::BTreeMap;
use std::sync::Arc;

use g7_host::Kind;
use g7_model::{Nanos, ProfileName, Severity, Span};
use g7_rig::{Activity, Bench, Conflicts, Options, Role, Source};
use serde::{Deserialize, Serialize};

use super::frame::Sent;
use super::past::Past;
use super::{Breaks, Frame, Run};
use crate::ids::{self, Thing};
use crate::positions::Positions;

/// The page's request to start a run.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Start {
    pub(crate) file: String,
    pub(crate) run: String,
    profile: Option<String>,
    scan_ms: Option<f64>,
    plant: Option<String>,
    #[serde(default)]
    seed: u64,
}

/// The description of a run: the names of the numbers in its frames.
#[derive(Debug, Serialize)]
pub(crate) struct Started {
    run: String,
    file: String,
    profile: &'static str,
    period_ms: f64,
    signals: Vec<SignalRow>,
    steps: Vec<StepRow>,
    transitions: Vec<TransitionRow>,
    #[serde(skip_serializing_if = "Option::is_none")]
    plant: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    view: Option<View>,
    /// The fingerprint of the text that runs, as in the overview of a file.
    hash: String,
    /// The ids of the breakpoints.
    breaks: Vec<String>,
    frame: Frame,
}

#[derive(Debug, Serialize)]
struct SignalRow {
    name: String,
    role: &'static str,
    #[serde(rename = "type")]
    ty: &'static str,
    declared: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    comment: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    address: Option<String>,
    driven: bool,
}

#[derive(Debug, Serialize)]
struct StepRow {
    id: String,
    name: String,
    chart: String,
    /// The name of the signal of its activity.
    activity: String,
    #[serde(rename = "macro")]
    is_macro: bool,
    inner: bool,
}

#[derive(Debug, Serialize)]
struct TransitionRow {
    id: String,
}

#[derive(Debug, Serialize)]
struct View {
    file: String,
    bindings: Vec<Binding>,
}

#[derive(Debug, Serialize)]
struct Binding {
    element: String,
    attribute: String,
}

/// The ids of the parts of a program, by their numbers in frames.
#[derive(Debug, Default)]
pub(super) struct Places {
    steps: Vec<String>,
    transitions: Vec<String>,
    /// The number of the transition with each rank.
    ranks: Vec<Option<u32>>,
}

impl Places {
    pub(super) fn new(source: &Source, bench: &Bench) -> Places {
        let mut steps: BTreeMap<Span, String> = BTreeMap::new();
        let mut places = Places::default();
        let mut numbers: BTreeMap<Span, u32> = BTreeMap::new();
        for (at, thing) in ids::things(&source.document) {
            match thing {
                Thing::Step(_, s) => {
                    steps.insert(s.name.at.0, thing.id());
                }
                Thing::Transition(..) => {
                    numbers.insert(at, places.transitions.len() as u32);
                    places.transitions.push(thing.id());
                }
                Thing::Action(..) => {}
            }
        }
        places.steps = bench.steps.iter().map(|s| steps.get(&s.at).cloned().unwrap_or_default()).collect();
        let symbols = &bench.compiled.symbols;
        let number =
            |rank| symbols.is_written(rank).then(|| numbers.get(&symbols.transition_place(rank)).copied());
        places.ranks = (0..symbols.transitions()).map(|rank| number(rank).flatten()).collect();
        places
    }

    /// The number of the transition with this rank.
    pub(super) fn transition(&self, rank: u32) -> Option<u32> {
        self.ranks.get(rank as usize).copied().flatten()
    }

    pub(super) fn transition_id(&self, number: u32) -> Option<String> {
        self.transitions.get(number as usize).cloned()
    }

    pub(super) fn step(&self, id: &str) -> Option<u32> {
        self.steps.iter().position(|s| s == id).and_then(|i| u32::try_from(i).ok())
    }

    pub(super) fn transition_of(&self, id: &str) -> Option<u32> {
        self.transitions.iter().position(|t| t == id).and_then(|i| u32::try_from(i).ok())
    }

    pub(super) fn step_id(&self, number: u32) -> Option<String> {
        self.steps.get(number as usize).cloned()
    }
}

/// Compiles a source and makes the first scan.
pub(crate) fn start(source: &Source, wish: &Start) -> Result<Run, String> {
    let bench = bench(source, wish)?;
    let runner = bench.runner(wish.seed);
    let mut run = Run {
        name: wish.run.clone(),
        file: wish.file.clone(),
        places: Places::new(source, &bench),
        recording: super::recording(&bench),
        past: Past::new(&runner),
        document: Arc::new(source.document.clone()),
        text: source.text.as_str().into(),
        positions: Arc::new(Positions::new(&source.text)),
        wish: wish.clone(),
        viewed: None,
        runner,
        bench,
        clock: 0,
        now: 0,
        conflicts: Conflicts::default(),
        notes: Vec::new(),
        cleared: Default::default(),
        breaks: Breaks::default(),
        stopped: None,
        late: false,
        sent: Sent::default(),
    };
    run.scan();
    run.clock = run.now;
    Ok(run)
}

/// Builds the bench for a request.
pub(super) fn bench(source: &Source, wish: &Start) -> Result<Bench, String> {
    let profile = wish.profile.as_deref().map(profile).transpose()?;
    let scan = match wish.scan_ms {
        Some(ms) if !(0.001..=3.6e6).contains(&ms) => {
            return Err("the scan time must lie between 1 us and 1 h".to_owned());
        }
        ms => ms.map(|ms| Nanos::new((ms * 1e6) as i64)),
    };
    // If there are several plants and none is chosen, the run starts with the first.
    let first = g7_compile::plant::plants(&source.document).next().map(|p| p.name.text.to_string());
    let plant = wish.plant.as_deref().or(first.as_deref());
    let (bench, problems) =
        g7_rig::build(source, &Options { profile, scan, plant, asks: &[] }).map_err(|e| e.to_string())?;
    bench.ok_or_else(|| {
        let mut errors = problems.iter().filter(|p| p.severity() == Severity::Error);
        let first = errors.next().map_or(String::new(), |p| format!(": {}", p.what));
        let more = match errors.count() {
            0 => String::new(),
            n => format!(" (and {n} more)"),
        };
        format!("this cannot be run yet{first}{more}")
    })
}

fn profile(name: &str) -> Result<ProfileName, String> {
    let found = ProfileName::ALL.into_iter().find(|p| p.name() == name);
    found.ok_or_else(|| format!("there is no profile `{name}`"))
}

impl Run {
    /// The description of the run for the page.
    pub(crate) fn started(&mut self) -> Started {
        let frame = self.frame(true, true);
        let bench = &self.bench;
        let symbols = &bench.compiled.symbols;
        let signal = |item: &g7_rig::Item| SignalRow {
            name: item.name.clone(),
            role: match item.role {
                Role::Input(_) => "input",
                Role::Output => "output",
                Role::Variable => "variable",
                Role::Plant => "plant",
            },
            ty: match item.kind {
                Kind::Bool => "bool",
                Kind::Int { .. } => "int",
                Kind::Real | Kind::Lreal => "real",
                Kind::Time => "time",
                Kind::Text => "text",
            },
            declared: item.ty.to_string(),
            comment: item.comment.clone(),
            address: match item.role {
                Role::Plant => None,
                Role::Input(_) | Role::Output | Role::Variable => {
                    symbols.variable(&item.name).and_then(|v| v.address.as_deref().map(str::to_owned))
                }
            },
            driven: bench.is_driven(&self.runner, item),
        };
        let step = |(item, id): (&g7_rig::StepItem, &String)| StepRow {
            id: id.clone(),
            name: item.name.clone(),
            chart: id.split_once("/s/").map_or("", |(chart, _)| chart).to_owned(),
            activity: item.activity(),
            is_macro: matches!(item.id, Activity::Macro(_)),
            inner: item.inner,
        };
        let view = bench.plant.as_ref().and_then(|p| {
            let bindings = p
                .bindings
                .iter()
                .map(|b| Binding { element: b.element.to_string(), attribute: b.attribute.to_string() });
            Some(View { file: p.view.clone()?, bindings: bindings.collect() })
        });
        Started {
            run: self.name.clone(),
            file: self.file.clone(),
            profile: bench.compiled.unit.profile.name(),
            period_ms: self.runner.period() as f64 / 1e6,
            signals: bench.items.iter().map(signal).collect(),
            steps: bench.steps.iter().zip(&self.places.steps).map(step).collect(),
            transitions: self.places.transitions.iter().map(|id| TransitionRow { id: id.clone() }).collect(),
            plant: bench.plant.as_ref().map(|p| p.name.clone()),
            view,
            hash: crate::overview::hash(&self.text),
            breaks: self.break_ids(),
            frame,
        }
    }
}
