//! Forcing orders (decision 4), and the requests of services.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{Situation, StepKind};

use super::evolve::{Changes, hierarchy, settle};
use super::model::{FILE, Model, ScopeId, StepId};
use super::state::{Request, State};
use super::value::{NaiveFault, Run, Value};

/// The charts under forcing orders in this pass, each with the situation that it is forced to;
/// `None` if it only keeps its present one.
pub(super) fn forced_situations(m: &Model, s: &State) -> Run<BTreeMap<ScopeId, Option<BTreeSet<StepId>>>> {
    let mut forced: BTreeMap<ScopeId, Option<BTreeSet<StepId>>> = BTreeMap::new();
    // The situation after the orders so far, with what enclosing steps activate and deactivate in
    // it.
    let mut active = s.active.clone();
    for &chart in &m.order {
        let mut order: Option<Option<BTreeSet<StepId>>> = None;
        for f in m.forcings.iter().filter(|f| f.chart == chart && active.contains(&f.step)) {
            let situation = situation(m, chart, &f.situation)?;
            // They agree if they ask for the same active steps of the chart, in whatever form.
            let mine: BTreeSet<StepId> = m.steps_within(chart).into_iter().collect();
            let asked = |x: &Option<BTreeSet<StepId>>| -> BTreeSet<StepId> {
                mine.intersection(x.as_ref().unwrap_or(&active)).copied().collect()
            };
            match &order {
                Some(first) if asked(first) != asked(&situation) => {
                    return Err(NaiveFault::Forcing(m.scopes[chart].name.clone()));
                }
                _ => order = Some(situation),
            }
        }
        let Some(order) = order else { continue };
        forced.insert(chart, order);
        active.clone_from(&s.active);
        for (chart, set) in forced.iter().filter_map(|(c, order)| Some((*c, order.as_ref()?))) {
            impose(m, chart, set, &mut active);
        }
        hierarchy(m, &s.active, &BTreeSet::new(), &mut active);
    }
    Ok(forced)
}

fn situation(m: &Model, chart: ScopeId, written: &Situation) -> Run<Option<BTreeSet<StepId>>> {
    let steps = match written {
        Situation::Current => return Ok(None),
        Situation::Init => m.initial_of(chart),
        Situation::Steps(names) => m.named_steps(chart, names)?,
    };
    let mut all = BTreeSet::new();
    for step in steps {
        m.activate(step, &mut all);
    }
    Ok(Some(all))
}

/// Puts a chart and its expansions into a situation; the consequences for enclosed charts follow
/// with the hierarchy.
pub(super) fn impose(m: &Model, chart: ScopeId, set: &BTreeSet<StepId>, next: &mut BTreeSet<StepId>) {
    let mine: BTreeSet<StepId> = m.steps_within(chart).into_iter().collect();
    next.retain(|x| !mine.contains(x));
    next.extend(set.intersection(&mine));
}

/// The services between PRE and the evolution (decision 17).
pub(super) fn services(m: &Model, s: &mut State, first: bool) -> Changes {
    let mut next = s.active.clone();
    for request in std::mem::take(&mut s.requests) {
        match request {
            Request::Init(chart) => {
                let mut set = BTreeSet::new();
                for step in m.initial_of(chart) {
                    m.activate(step, &mut set);
                }
                let before = next.clone();
                impose(m, chart, &set, &mut next);
                hierarchy(m, &before, &BTreeSet::new(), &mut next);
            }
            Request::Clear(chart) => clear(m, chart, &mut next),
            Request::Freeze(chart, true) => {
                s.frozen.insert(chart);
            }
            Request::Freeze(chart, false) => {
                s.frozen.remove(&chart);
            }
            // A macro-step stands for its entry step.
            Request::Set(step) if !next.contains(&step) || m.steps[step].expansion.is_some() => {
                m.activate(step, &mut next);
            }
            Request::Set(_) => {}
            Request::Reset(step) => {
                if next.remove(&step) || m.steps[step].expansion.is_some() {
                    next.retain(|x| !m.subordinates(step).contains(x));
                }
            }
        }
    }
    system_bits(m, s, first, &mut next);
    settle(m, s, next, &BTreeSet::new())
}

fn clear(m: &Model, chart: ScopeId, next: &mut BTreeSet<StepId>) {
    let mut all = BTreeSet::new();
    m.everything_in(chart, &mut all);
    next.retain(|x| !all.contains(x));
}

/// One of the bits acts in a scan, the lowest that is set; the others wait.
/// `%S0` sets `%S21`. The first scan has the initial situation already, so that
/// `%S21` takes no turn in it.
fn system_bits(m: &Model, s: &mut State, first: bool, next: &mut BTreeSet<StepId>) {
    s.stopped = false;
    let start = (s.system(m, "S0") || s.system(m, "S21")) && !first;
    s.set_system(m, "S21", Value::Bool(false));
    if start {
        *next = m.initial_steps();
        s.owners.clear();
    } else if s.system(m, "S22") {
        next.clear();
        s.owners.clear();
        s.set_system(m, "S22", Value::Bool(false));
    } else if s.system(m, "S23") {
        s.stopped = true;
    } else if s.system(m, "S24") {
        for (word, name) in ["SW22", "SW23", "SW24", "SW25"].iter().enumerate() {
            let Some(Value::Int(bits)) = m.addresses.get(*name).map(|&v| &s.vars[v]) else { continue };
            for bit in (0..16).filter(|b| bits >> b & 1 == 1) {
                empty_macro(m, word * 16 + bit, next);
            }
        }
        s.set_system(m, "S24", Value::Bool(false));
    }
}

fn empty_macro(m: &Model, number: usize, next: &mut BTreeSet<StepId>) {
    for scope in FILE + 1..m.scopes.len() {
        let Some(step) = m.numbered_macro(scope, &number.to_string()) else { continue };
        if matches!(m.steps[step].kind, StepKind::Macro(_)) {
            next.remove(&step);
            next.retain(|x| !m.subordinates(step).contains(x));
        }
    }
}
