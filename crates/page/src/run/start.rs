//! The start of a run: compiles the text, couples the plant, and numbers everything for the page.

use std::sync::Arc;

use g7_host::Kind;
use g7_ide::Positions;
use g7_model::{Language, Nanos, Said};
use g7_rig::{Activity, Conflicts, Role, Source};
use serde::Serialize;

use super::frame::Frame;
use super::past::Past;
use super::places::{Part, Places};
use super::running::{Breaks, Run, recording};
use super::sent::Sent;
use super::wish::{Start, bench};

/// The description of a run: the names of the numbers in its frames.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
pub(crate) struct Started {
    run: String,
    file: String,
    profile: &'static str,
    period_ms: f64,
    signals: Vec<SignalRow>,
    steps: Vec<StepRow>,
    transitions: Vec<Part>,
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
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
struct SignalRow {
    name: String,
    role: SignalRole,
    #[serde(rename = "type")]
    ty: SignalType,
    declared: String,
    /// Of an enumeration: the names of its values.
    #[serde(skip_serializing_if = "Option::is_none")]
    choices: Option<Vec<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    comment: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    address: Option<String>,
    driven: bool,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "RunStep", optional_fields))]
struct StepRow {
    id: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    instance: Option<String>,
    name: String,
    chart: String,
    /// The name of the signal of its activity.
    activity: String,
    #[serde(rename = "macro")]
    is_macro: bool,
    inner: bool,
}

/// The part that a signal plays.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
enum SignalRole {
    Input,
    Output,
    Variable,
    Plant,
}

/// The kinds of values.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
enum SignalType {
    Bool,
    Int,
    Real,
    Time,
    Text,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
struct View {
    file: String,
    bindings: Vec<Binding>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
struct Binding {
    element: String,
    attribute: String,
}

/// Compiles a source and makes the first scan, or those of the run that the page wishes to see.
pub(crate) fn start(source: &Source, wish: &Start, language: Language) -> Result<Run, Said> {
    let bench = bench(source, wish)?;
    let runner = bench.runner(wish.seed);
    let mut run = Run {
        name: wish.run.clone(),
        file: wish.file.clone(),
        places: Places::new(source, &bench),
        recording: recording(&bench),
        past: Past::new(&runner),
        document: Arc::new(source.whole().clone()),
        text: source.text.as_str().into(),
        hash: crate::overview::hash(source),
        positions: Arc::new(Positions::new(&source.text)),
        wish: wish.without_moves(),
        viewed: None,
        runner,
        bench,
        clock: Nanos::ZERO,
        now: Nanos::ZERO,
        conflicts: Conflicts::default(),
        notes: Vec::new(),
        language,
        cleared: Default::default(),
        breaks: Breaks::default(),
        stopped: None,
        late: false,
        sent: Sent::default(),
    };
    match &wish.moves {
        Some(scans) => run.repeat(scans),
        None => {
            run.scan();
        }
    }
    run.clock = run.now;
    Ok(run)
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
                Role::Input(_) => SignalRole::Input,
                Role::Output => SignalRole::Output,
                Role::Variable => SignalRole::Variable,
                Role::Plant => SignalRole::Plant,
            },
            ty: match item.kind {
                Kind::Bool => SignalType::Bool,
                Kind::Int { .. } => SignalType::Int,
                Kind::Real | Kind::Lreal => SignalType::Real,
                Kind::Time | Kind::Moment(_) => SignalType::Time,
                Kind::Text => SignalType::Text,
            },
            declared: item.declared(),
            choices: item
                .held
                .as_ref()
                .map(|h| h.names().map(str::to_owned).collect())
                .filter(|all: &Vec<_>| !all.is_empty()),
            comment: item.comment.clone(),
            address: match item.role {
                Role::Plant => None,
                Role::Input(_) | Role::Output | Role::Variable => {
                    symbols.variable(&item.name).and_then(|v| v.address.as_deref().map(str::to_owned))
                }
            },
            driven: bench.is_driven(&self.runner, item),
        };
        let step = |(item, part): (&g7_rig::StepItem, &Part)| StepRow {
            id: part.id.clone(),
            instance: part.instance.clone(),
            name: item.name.clone(),
            chart: part.id.split_once("/s/").map_or("", |(chart, _)| chart).to_owned(),
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
            period_ms: self.runner.period().as_millis(),
            signals: bench.items.iter().map(signal).collect(),
            steps: bench.steps.iter().zip(self.places.steps()).map(step).collect(),
            transitions: self.places.transitions().to_vec(),
            plant: bench.plant.as_ref().map(|p| p.name.clone()),
            view,
            hash: self.hash.clone(),
            breaks: self.break_ids(),
            frame,
        }
    }
}
