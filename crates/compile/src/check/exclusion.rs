//! Finds branches of an OR divergence that can be true together, and receptivities that are never
//! true.
//!
//! Under multi-token rules both branches of such a divergence clear. Most authors want only one of
//! them, so `check` asks for receptivities that exclude each other and offers the three usual
//! remedies.

use std::collections::BTreeSet;

use g7_model::{Problem, codes, say};

use super::facts::Facts;
use super::solve::Question;
use crate::ir::{BinaryOp, Expr, ExprKind, StepId, Transition, Unit, Value, VarId};

/// The largest number of pairs of branches that are compared in one document.
const PAIRS: usize = 20_000;
/// Most variables of an expression that are compared with each other; longer ones are searched.
const MOST_FREE: usize = 32;

pub(super) fn check(facts: &Facts<'_>, problems: &mut Vec<Problem>) {
    let unit = facts.unit;
    for t in &unit.transitions {
        never(facts, t, problems);
    }
    priorities(facts, problems);
    if unit.rules.multi_token {
        conflicts(facts, problems);
    }
}

/// Warns of a receptivity that no values make true.
#[inline(never)]
fn never(facts: &Facts<'_>, t: &Transition, problems: &mut Vec<Problem>) {
    let what = match &t.receptivity.kind {
        ExprKind::Const(Value::Bool(false)) => say!("this receptivity is never true"),
        _ if is_free(&t.receptivity, &mut Vec::new()) => return,
        // A single value can always be true; only combinations need the search.
        ExprKind::Binary(..) | ExprKind::Not(_) | ExprKind::StepActive(_) => {
            let mut question = Question::new(facts);
            question.demand(&t.receptivity, true);
            if question.possible() == Some(false) {
                say!("this receptivity is never true: its parts contradict each other")
            } else if question.with_active(&t.from) && question.possible() == Some(false) {
                say!("this receptivity is never true while the preceding steps are active")
            } else {
                return;
            }
        }
        _ => return,
    };
    problems.push(Problem::new(&codes::NEVER_CLEARS, t.receptivity.at, what));
}

/// True if an expression joins variables of which none stands there twice: each can have both
/// values, whatever the others have, and so can the expression. No search is needed then.
#[inline(never)]
fn is_free(e: &Expr, seen: &mut Vec<VarId>) -> bool {
    match &e.kind {
        ExprKind::Var(v) if seen.contains(v) || seen.len() > MOST_FREE => false,
        ExprKind::Var(v) => {
            seen.push(*v);
            true
        }
        ExprKind::Rise(x) | ExprKind::Fall(x) => matches!(x.kind, ExprKind::Var(_)) && is_free(x, seen),
        ExprKind::Not(a) => is_free(a, seen),
        ExprKind::Binary(BinaryOp::And | BinaryOp::Or | BinaryOp::Xor, a, b) => {
            is_free(a, seen) && is_free(b, seen)
        }
        _ => false,
    }
}

/// True if an expression is false as soon as some variable has one of its values. No search is
/// needed then to see that it can be false.
fn hangs_on_a_variable(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Var(_) => true,
        ExprKind::Not(a) => matches!(a.kind, ExprKind::Var(_)),
        ExprKind::Binary(BinaryOp::And, a, b) => hangs_on_a_variable(a) || hangs_on_a_variable(b),
        _ => false,
    }
}

/// True if the expression is true for all values of its parts.
#[inline(never)]
pub(super) fn always(facts: &Facts<'_>, e: &Expr, active: &[StepId]) -> bool {
    match &e.kind {
        ExprKind::Const(v) => *v == Value::Bool(true),
        _ if hangs_on_a_variable(e) => false,
        ExprKind::Binary(..) | ExprKind::Not(_) | ExprKind::StepActive(_) => {
            let mut question = Question::new(facts);
            question.demand(e, false);
            question.with_active(active);
            question.possible() == Some(false)
        }
        _ => false,
    }
}

/// Warns of priorities that have no effect.
#[inline(never)]
fn priorities(facts: &Facts<'_>, problems: &mut Vec<Problem>) {
    let rules = &facts.unit.rules;
    for t in &facts.unit.transitions {
        if t.priority.is_none() {
            continue;
        }
        if rules.multi_token && !rules.numbered_exclusive {
            problems.push(
                Problem::new(
                    &codes::PRIORITY_IGNORED,
                    t.at,
                    say!("this priority has no effect: all branches that are true clear"),
                )
                .help(say!(
                    "set `single-token` behind the profile, or make the receptivities exclude each other"
                )),
            );
        } else if t.from.iter().all(|f| facts.branches(*f).len() < 2) {
            problems.push(
                Problem::new(
                    &codes::PRIORITY_IGNORED,
                    t.at,
                    say!("this priority has no effect: no other transition shares a preceding step"),
                )
                .help(say!("leave the number out")),
            );
        }
    }
}

/// For each branch, the first branch before it that can clear at the same time.
#[inline(never)]
fn conflicts(facts: &Facts<'_>, problems: &mut Vec<Problem>) {
    let unit = facts.unit;
    let mut budget = PAIRS;
    let mut told = BTreeSet::new();
    for step in (0..unit.steps.len() as u32).map(StepId) {
        // One token at a time: `settle` has found that its branches exclude each other.
        if facts.group(step).is_some() {
            continue;
        }
        let rows = facts.branches(step);
        for (k, b) in rows.iter().enumerate() {
            for a in rows.get(..k).unwrap_or(&[]) {
                if budget == 0 {
                    return;
                }
                let (Some(x), Some(y)) =
                    (unit.transitions.get(*a as usize), unit.transitions.get(*b as usize))
                else {
                    continue;
                };
                // Two transitions between the same steps lead to one situation, whichever clears.
                if same(&x.from, &y.from) && same(&x.to, &y.to) {
                    continue;
                }
                budget -= 1;
                if facts.meet(x, y) == Some(true) {
                    if told.insert((*a, *b)) {
                        problems.push(conflict(unit, step, x, y));
                    }
                    break;
                }
            }
        }
    }
}

fn same(a: &[StepId], b: &[StepId]) -> bool {
    let set = |list: &[StepId]| list.iter().copied().collect::<BTreeSet<_>>();
    a == b || (a.len() > 1 || b.len() > 1) && set(a) == set(b)
}

#[inline(never)]
fn conflict(unit: &Unit, step: StepId, a: &Transition, b: &Transition) -> Problem {
    let name = unit.steps.get(step.index()).map_or("", |s| &*s.name);
    let what = say!("two branches behind step `{name}` can be true together, and then both clear");
    let cure = if unit.rules.numbered_exclusive {
        say!("number the branches by `priority`")
    } else {
        say!("give the first branch priority by `single-token` behind the profile")
    };
    Problem::new(&codes::CONFLICT, b.receptivity.at, what)
        .related(a.receptivity.at, say!("can be true at the same time"))
        .help(say!(
            "let the receptivities exclude each other (`… and not (…)`); or {cure}; \
             or, if both are meant, start them by one transition, `{name} -> (…, …)`"
        ))
}
