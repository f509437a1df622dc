//! The stored actions of a pass (decisions 9 and 21).

use std::collections::BTreeMap;

use g7_model::{Action, ActionKind, Block, Body, Expr, Qualifier, Target, Work};

use super::Diagnostics;
use super::control::{self, Goal};
use super::evolve::Changes;
use super::exec::Exec;
use super::model::{FILE, Model, ScopeId, StepId, VarId};
use super::state::State;
use super::value::{Run, Value};

/// The kinds of stored actions, in their order within a pass.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Clearing,
    Deactivation,
    Activation,
    Event,
}

enum What<'m> {
    Body(ScopeId, &'m Block),
    Work(&'m Work),
    Set(VarId, bool),
}

struct Todo<'m> {
    kind: Kind,
    /// P1 comes first and P0 last if `pulse-first` is on.
    pulse: i8,
    scope: ScopeId,
    what: What<'m>,
    condition: Option<&'m Expr>,
}

/// Runs the stored actions of a pass; `before` is the state at its start.
pub(super) fn run(
    m: &Model,
    s: &mut State,
    before: &State,
    happened: &Changes,
    diagnostics: &mut Diagnostics,
) -> Run<()> {
    let mut todo = collect(m, happened)?;
    todo.sort_by_key(|t| t.kind);
    if m.rules.parallel_actions {
        return parallel(m, s, before, &todo, diagnostics);
    }
    if m.rules.pulse_first {
        todo.sort_by_key(|t| t.pulse);
    }
    for t in &todo {
        let mut exec = Exec::new(m, s);
        perform(&mut exec, t)?;
    }
    Ok(())
}

/// Runs the entry or the exit actions of one step on the present state.
pub(super) fn at_once(m: &Model, s: &mut State, step: StepId, on: bool) -> Run<()> {
    let mut changes = Changes::default();
    let set = if on { &mut changes.on } else { &mut changes.off };
    set.insert(step);
    let mut todo = Vec::new();
    for (i, action) in m.steps[step].actions.iter().enumerate() {
        of_action(m, (step, i), action, &changes, &mut todo)?;
    }
    for t in &todo {
        perform(&mut Exec::new(m, s), t)?;
    }
    Ok(())
}

fn perform(exec: &mut Exec<'_>, t: &Todo<'_>) -> Run<()> {
    if let Some(c) = t.condition
        && !exec.truth(t.scope, c)?
    {
        return Ok(());
    }
    match t.what {
        What::Body(scope, block) => exec.body(scope, block),
        What::Work(work) => exec.work(t.scope, work),
        What::Set(v, b) => {
            exec.s.vars[v] = Value::Bool(b);
            exec.written.push(v);
            Ok(())
        }
    }
}

/// All actions read the state at the start of the pass; after that all of them write.
fn parallel(
    m: &Model,
    s: &mut State,
    before: &State,
    todo: &[Todo<'_>],
    diagnostics: &mut Diagnostics,
) -> Run<()> {
    let mut writes: Vec<BTreeMap<VarId, Value>> = Vec::new();
    for t in todo {
        let mut copy = before.clone();
        copy.work = s.work;
        let mut exec = Exec::new(m, &mut copy);
        perform(&mut exec, t)?;
        let written = exec.written;
        s.work = copy.work;
        s.requests.extend(copy.requests.drain(before.requests.len()..));
        writes.push(written.into_iter().map(|v| (v, copy.vars[v].clone())).collect());
    }
    let mut seen: BTreeMap<VarId, Value> = BTreeMap::new();
    for (v, value) in writes.into_iter().flatten() {
        if seen.get(&v).is_some_and(|earlier| *earlier != value) {
            diagnostics.conflict(&m.vars[v].qualified);
        }
        s.vars[v] = value.clone();
        seen.insert(v, value);
    }
    Ok(())
}

/// The actions that run, in the order of the text.
fn collect<'m>(m: &'m Model, h: &Changes) -> Run<Vec<Todo<'m>>> {
    let mut todo = Vec::new();
    for scope in FILE + 1..m.scopes.len() {
        for t in m.scopes[scope].transitions.iter().filter(|t| h.cleared.contains(t)) {
            if let Some(block) = &m.transitions[*t].on_clearing {
                let what = What::Body(scope, block);
                todo.push(Todo { kind: Kind::Clearing, pulse: 1, scope, what, condition: None });
            }
        }
        for &step in &m.scopes[scope].steps {
            for (i, action) in m.steps[step].actions.iter().enumerate() {
                of_action(m, (step, i), action, h, &mut todo)?;
            }
        }
    }
    Ok(todo)
}

fn of_action<'m>(
    m: &'m Model,
    (step, place): (StepId, usize),
    action: &'m Action,
    h: &Changes,
    todo: &mut Vec<Todo<'m>>,
) -> Run<()> {
    let scope = m.steps[step].scope;
    match &action.kind {
        ActionKind::OnEvent { work, .. } if h.events.contains(&(step, place)) => {
            let what = What::Work(work);
            todo.push(Todo { kind: Kind::Event, pulse: 1, scope, what, condition: None });
        }
        ActionKind::Qualified { qualifier, target, condition, .. } => {
            let goal = control::goal(m, scope, target)?;
            if control::through_block(m, &goal, *qualifier) {
                return Ok(());
            }
            let pulse = matches!(qualifier, Qualifier::P1 | Qualifier::P0);
            if pulse && !m.rules.stored_pulses() {
                return Ok(()); // it runs at the end of the scan
            }
            let (on, off) = (h.on.contains(&step), h.off.contains(&step));
            let (kind, pulse, happens) = match qualifier {
                Qualifier::P1 => (Kind::Activation, 0, on),
                Qualifier::P0 => (Kind::Deactivation, 2, off),
                _ => (Kind::Activation, 1, on),
            };
            let what = match (goal, target) {
                (Goal::Var(v), _) => What::Set(v, *qualifier != Qualifier::R),
                (Goal::Named(owner, name), _) => match &m.scopes[owner].actions[&name].body {
                    Body::St(block) => What::Body(owner, block),
                    Body::Other(..) => return Ok(()),
                },
                (Goal::Own, Target::Work(work)) => What::Work(work),
                (Goal::Own, _) => return Ok(()),
            };
            if happens {
                todo.push(Todo { kind, pulse, scope, what, condition: condition.as_ref() });
            }
        }
        ActionKind::OnEvent { .. }
        | ActionKind::EachScan { .. }
        | ActionKind::Order(_)
        | ActionKind::Comment(_) => {}
    }
    Ok(())
}
