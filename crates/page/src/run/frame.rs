//! A frame: what changed in a run since the previous frame.

use std::collections::{BTreeMap, BTreeSet};

use g7_compile::plant::Binding;
use g7_engine::{Program, State};
use g7_host::{Value, read_text};
use g7_ide::OWN;
use g7_ide::ids;
use g7_model::{Nanos, Type};
use g7_rig::{Activity, Item, Role};
use serde::Serialize;

use super::running::Run;
use super::sent::{Sent, Show};

/// A frame. Steps, transitions, signals and bindings are numbered as in the description of the run.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
pub(crate) struct Frame {
    run: String,
    now_ms: f64,
    scans: u64,
    passes: u32,
    full: bool,
    /// Steps that became active.
    on: Vec<u32>,
    /// Steps that became inactive.
    off: Vec<u32>,
    /// The time since activation of each active step, in ms.
    #[serde(skip_serializing_if = "Option::is_none")]
    times: Option<BTreeMap<u32, f64>>,
    /// Enabled transitions: 0 not enabled, 1 enabled, 2 enabled and the receptivity is true.
    #[cfg_attr(feature = "types", ts(type = "Array<[number, 0 | 1 | 2]>"))]
    enabled: Vec<(u32, u8)>,
    cleared: Vec<u32>,
    values: Vec<(u32, String, f64)>,
    forced: Vec<(u32, bool)>,
    view: Vec<(u32, Show)>,
    /// True between two passes of a scan.
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    within: bool,
    /// True if the frame shows the present and not an earlier scan.
    live: bool,
    /// True if the run could not keep up with the requested time.
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    late: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    stopped: Option<Stopped>,
    #[serde(skip_serializing_if = "Option::is_none")]
    halt: Option<Halted>,
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
}

/// The breakpoint at which a run stopped.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
struct Stopped {
    id: String,
}

/// The fault that ended a run, with its place in the text from which the run was started.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
struct Halted {
    what: String,
    ids: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    from: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    to: Option<usize>,
}

fn halted(run: &Run) -> Option<Halted> {
    let halt = run.watched().halt()?;
    let at = run.bench.halt_place(halt);
    let unit = |byte: u32| run.positions.unit(&run.text, byte as usize);
    Some(Halted {
        what: run.bench.halt(run.watched(), halt).in_language(run.language),
        ids: at.and_then(|at| ids::at(&run.document, at)).map(|t| t.id()).into_iter().collect(),
        // A place in a file that this one uses has no units here.
        from: at.filter(|at| at.file == OWN).map(|at| unit(at.start)),
        to: at.filter(|at| at.file == OWN).map(|at| unit(at.end)),
    })
}

impl Run {
    /// The next frame for the page: the changes since the previous one; a full frame contains
    /// everything.
    pub(crate) fn frame(&mut self, full: bool, times: bool) -> Frame {
        frame(self, full, times)
    }
}

fn frame(run: &mut Run, full: bool, times: bool) -> Frame {
    if full {
        run.sent = Sent::default();
    }
    let active = run.active();
    let enabled = enabled(run);
    let values: Vec<Value> = run.bench.items.iter().map(|i| value(run, i)).collect();
    let forced: Vec<bool> = run.bench.items.iter().map(|i| run.bench.is_forced(run.watched(), i)).collect();
    let view = view(run);
    let sent = &run.sent;
    let numbered = || (0u32..).zip(&run.bench.items).zip(&values);
    let changed = numbered().filter(|((i, _), v)| sent.values.get(*i as usize) != Some(v));
    let mut marks: Vec<(u32, u8)> =
        enabled.iter().filter(|(i, v)| sent.enabled.get(i) != Some(v)).map(|(i, v)| (*i, *v)).collect();
    marks.extend(sent.enabled.keys().filter(|i| !enabled.contains_key(i)).map(|i| (*i, 0)));
    let frame = Frame {
        run: run.name.clone(),
        now_ms: run.viewed.as_ref().map_or(run.now, |v| v.now).as_millis(),
        scans: run.watched().state().scans(),
        passes: run.watched().report().passes,
        full,
        on: active.difference(&sent.active).copied().collect(),
        off: sent.active.difference(&active).copied().collect(),
        times: times.then(|| step_times(run, &active)),
        enabled: marks,
        cleared: std::mem::take(&mut run.cleared).into_iter().collect(),
        values: changed.map(|((i, item), v)| (i, item.show(v), v.number(item.kind))).collect(),
        forced: (0u32..)
            .zip(&forced)
            .filter(|(i, f)| sent.forced.get(*i as usize).copied().unwrap_or(false) != **f)
            .map(|(i, f)| (i, *f))
            .collect(),
        view: (0u32..)
            .zip(&view)
            .filter(|(i, v)| sent.view.get(*i as usize) != Some(v))
            .map(|(i, v)| (i, v.clone()))
            .collect(),
        within: run.watched().is_within_scan(),
        late: std::mem::take(&mut run.late),
        stopped: run.stopped.take().map(|id| Stopped { id }),
        halt: halted(run),
        live: run.viewed.is_none(),
        notes: std::mem::take(&mut run.notes).iter().map(|n| n.in_language(run.language)).collect(),
    };
    run.sent = Sent { active, enabled, values, forced, view };
    frame
}

/// The value of an item to show. For an input it is the value that the next scan will read, so that
/// a switch moves even while the run is paused.
fn value(run: &Run, item: &Item) -> Value {
    match item.role {
        Role::Input(index) if item.words == 1 => Value::Word(run.watched().input(index)),
        Role::Input(_) | Role::Output | Role::Variable | Role::Plant => run.bench.value(run.watched(), item),
    }
}

/// The enabled transitions of the shown state: 1, or 2 if the receptivity is true. A fault in a
/// receptivity is reported when a scan meets it.
fn enabled(run: &Run) -> BTreeMap<u32, u8> {
    let mut found = BTreeMap::new();
    let tell = |rank: u32, holds: bool| {
        if let Some(number) = run.places.transition(rank) {
            let mark = found.entry(number).or_insert(1);
            *mark = (*mark).max(1 + u8::from(holds));
        }
    };
    g7_engine::enabled(run.watched().program(), run.watched().shown(), tell).ok();
    found
}

fn step_times(run: &Run, active: &BTreeSet<u32>) -> BTreeMap<u32, f64> {
    let (program, state) = (run.watched().program(), run.watched().shown());
    let time = |i: &u32| {
        let ns = match run.bench.steps.get(*i as usize)?.id {
            Activity::Step(id) => state.step_age(program, id),
            Activity::Macro(group) => state.group_age(program, group),
        };
        Some((*i, Nanos::new(ns).as_millis()))
    };
    active.iter().filter_map(time).collect()
}

/// The values that the plant's picture shows.
fn view(run: &mut Run) -> Vec<Show> {
    let Some(side) = &run.bench.plant else { return Vec::new() };
    let watched = run.viewed.as_mut().map_or(&mut run.runner, |v| &mut v.runner);
    let Some((program, state)) = watched.plant_mut() else { return Vec::new() };
    let mut values = Vec::with_capacity(side.bindings.len());
    for b in &side.bindings {
        values.push(show(program, state, b));
    }
    values
}

/// The value of a moving part of a plant's picture; 0 where its expression fails.
pub fn show(program: &Program, state: &mut State, binding: &Binding) -> Show {
    let word = g7_engine::eval(program, state, binding.code).unwrap_or(0);
    match binding.ty {
        Type::Bool => Show::Flag(word != 0),
        Type::String(_) => Show::Text(read_text(state.words(), word as u32)),
        Type::Real => Show::Number(rounded(f64::from(f32::from_bits(word as u32)))),
        Type::Lreal => Show::Number(rounded(f64::from_bits(word))),
        Type::Time | Type::Moment(_) => Show::Number(Nanos::new(word as i64).as_seconds()),
        Type::Ulint | Type::Lword => Show::Number(word as f64),
        _ => Show::Number(word as i64 as f64),
    }
}

/// Rounds to four decimals; smaller changes are not visible in a picture.
fn rounded(x: f64) -> f64 {
    if x.is_finite() { (x * 1e4).round() / 1e4 } else { 0.0 }
}
