//! Checks actions, and the events, conditions and times in them.

use std::collections::{HashMap, HashSet};

use g7_model::{Lasting, Problem, Qualifier, Span, codes, say};

use super::facts::Facts;
use super::solve::Question;
use super::tree::{Form, has_edge};
use crate::ir::{Action, ActionKind, Expr, Step, StepId, StepSort, Unit, VarId};

#[inline(never)]
pub(super) fn check(facts: &Facts<'_>, problems: &mut Vec<Problem>) {
    let unit = facts.unit;
    let grafcet = is_grafcet(unit);
    for step in &unit.steps {
        for action in &step.actions {
            pulse(unit, action, problems);
            if grafcet {
                macro_acts(step, action, problems);
                event(facts, action, problems);
                condition(action, problems);
            }
        }
    }
    times(unit, problems);
}

/// True if continuous actions are those of IEC 60848, true in a stable situation.
pub(super) fn is_grafcet(unit: &Unit) -> bool {
    unit.rules.stable && unit.rules.continuous
}

/// Warns of a body under `P` that runs twice.
#[inline(never)]
fn pulse(unit: &Unit, action: &Action, problems: &mut Vec<Problem>) {
    if let ActionKind::Named { qualifier: Qualifier::P, .. }
    | ActionKind::Work { qualifier: Qualifier::P, .. } = &action.kind
        && unit.rules.final_scan
    {
        problems.push(
            Problem::new(
                &codes::PULSE_TWICE,
                action.at,
                say!("under `P` this body runs twice: in the pulse and in the final scan"),
            )
            .help(say!("write `P1`, which runs once, or set `no-final-scan`")),
        );
    }
}

fn macro_acts(step: &Step, action: &Action, problems: &mut Vec<Problem>) {
    if matches!(step.sort, StepSort::Macro(_)) {
        let what = say!("macro-step `{}` has an action of its own", step.name);
        problems.push(Problem::new(&codes::MACRO_ACTS, action.at, what).help(say!(
            "put it into the steps of the expansion; it runs here as long as the macro-step is active"
        )));
    }
}

/// Warns of an event without an edge: it can stay true, and its action runs again and again.
#[inline(never)]
fn event(facts: &Facts<'_>, action: &Action, problems: &mut Vec<Problem>) {
    let ActionKind::OnEvent { event, .. } = &action.kind else { return };
    if !has_edge(event) {
        problems.push(
            Problem::new(
                &codes::EVENT_WITHOUT_EDGE,
                event.at,
                say!("the event of a stored action needs an edge"),
            )
            .help(say!("write `↑` or `↓` before what makes the event, for example `on ↑a: …`")),
        );
        return;
    }
    let mut question = Question::new(facts);
    question.demand(event, true);
    question.at_rest();
    if question.possible() == Some(true) {
        problems.push(
            Problem::new(
                &codes::EVENT_LASTS,
                event.at,
                say!("this event can be true without an edge: the action then runs in every evolution"),
            )
            .help(say!("put an edge into each of its alternatives, for example `↑a or ↑b`")),
        );
    }
}

/// Warns of an edge in the condition of a continuous action.
#[inline(never)]
fn condition(action: &Action, problems: &mut Vec<Problem>) {
    let (ActionKind::Variable { qualifier, condition: Some(c), .. }
    | ActionKind::Named { qualifier, condition: Some(c), .. }
    | ActionKind::Work { qualifier, condition: Some(c), .. }) = &action.kind
    else {
        return;
    };
    let continuous = qualifier.lasting() == Lasting::WithStep;
    if continuous && has_edge(c) {
        problems.push(
            Problem::new(
                &codes::EDGE_IN_CONDITION,
                c.at,
                say!("the condition of a continuous action has an edge"),
            )
            .help(say!("an edge lasts no time: use a stored action, `on ↑a: V := TRUE`")),
        );
    }
}

/// The variable or named action that a timed qualifier drives.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Governed {
    Var(VarId),
    Body(crate::ir::BodyId),
}

/// Warns if one control block gets two times: two timed qualifiers of one action in one step, or in
/// steps that one transition activates together.
#[inline(never)]
fn times(unit: &Unit, problems: &mut Vec<Problem>) {
    let blocked = blocked(unit);
    let mut told: HashSet<Span> = HashSet::new();
    let single = (0..unit.steps.len() as u32).map(|s| vec![StepId(s)]);
    let forked = unit.transitions.iter().filter(|t| t.to.len() > 1).map(|t| t.to.clone());
    for mut steps in single.chain(forked) {
        steps.sort_unstable();
        steps.dedup();
        let mut seen: HashMap<Governed, (Span, StepId, Qualifier, Option<&Expr>)> = HashMap::new();
        for (step, action) in steps.iter().flat_map(|s| of_step(unit, *s)) {
            let Some((governed, qualifier, time)) = timed(&blocked, unit.rules.continuous, action) else {
                continue;
            };
            let Some(first) = seen.insert(governed, (action.at, step, qualifier, time)) else { continue };
            // The same qualifier and time from two steps are one input of the block.
            let same = first.2 == qualifier && first.3.map(Form) == time.map(Form) && first.1 != step;
            if same || !told.insert(action.at) {
                continue;
            }
            let name = match governed {
                Governed::Var(v) => unit.vars.get(v.index()).map_or("", |v| &*v.name),
                Governed::Body(b) => unit.bodies.get(b.index()).map_or("", |b| &*b.name),
            };
            let place = if first.1 == step { say!("one step") } else { say!("steps that start together") };
            let what = say!("`{name}` has two timed qualifiers in {place}");
            problems.push(
                Problem::new(&codes::TWO_TIMES, action.at, what).related(first.0, say!("and this one")),
            );
        }
    }
}

fn of_step(unit: &Unit, step: StepId) -> impl Iterator<Item = (StepId, &Action)> {
    unit.steps.get(step.index()).into_iter().flat_map(|s| &s.actions).map(move |a| (step, a))
}

/// Returns a timed qualifier that has a control block. In GRAFCET `L` and `D` of a variable are
/// continuous actions and have none.
#[inline(never)]
fn timed<'a>(
    blocked: &HashSet<VarId>,
    continuous: bool,
    action: &'a Action,
) -> Option<(Governed, Qualifier, Option<&'a Expr>)> {
    let (qualifier, governed, time) = match &action.kind {
        ActionKind::Variable { qualifier, var, time, .. } => (*qualifier, Governed::Var(*var), time),
        ActionKind::Named { qualifier, body, time, .. } => (*qualifier, Governed::Body(*body), time),
        _ => return None,
    };
    let alone = continuous
        && matches!(qualifier, Qualifier::L | Qualifier::D)
        && matches!(governed, Governed::Var(v) if !blocked.contains(&v));
    (qualifier.timed() && !alone).then_some((governed, qualifier, time.as_ref()))
}

/// The variables with a control block: all their qualifiers are inputs of it.
#[inline(never)]
pub(super) fn blocked(unit: &Unit) -> HashSet<VarId> {
    use Qualifier::{D, L, N, R, S};
    let actions = unit.steps.iter().flat_map(|s| &s.actions);
    actions
        .filter_map(|a| match &a.kind {
            ActionKind::Variable { qualifier, var, .. } if !matches!(qualifier, N | D | L | S | R) => {
                Some(*var)
            }
            _ => None,
        })
        .collect()
}
