//! Checks what actions write: variables that are both driven and assigned, and stored actions that
//! give one variable two values at one moment.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use g7_model::{Problem, Qualifier, Span, codes, say};

use super::actions::{blocked, is_grafcet};
use super::tree::{Constant, statements, within, written};
use crate::ir::{
    Action, ActionKind, Expr, ExprKind, StepId, Stmt, StmtKind, Target, Transition, Unit, VarId,
};

#[inline(never)]
pub(super) fn check(unit: &Unit, problems: &mut Vec<Problem>) {
    let blocked = blocked(unit);
    // Where actions run one after another, the later write is not in conflict with the earlier one.
    if unit.rules.parallel_actions && !unit.rules.late_actions {
        let writers: Vec<bool> = unit.steps.iter().map(|s| s.actions.iter().any(stores)).collect();
        let writes = |s: &StepId| writers.get(s.index()) == Some(&true);
        for step in (0..unit.steps.len() as u32).map(StepId).filter(writes) {
            let mut moment = Moment::default();
            moment.step(unit, &blocked, step, Qualifier::P1);
            moment.tell(unit, &codes::TWO_VALUES, problems);
            let mut moment = Moment::default();
            moment.step(unit, &blocked, step, Qualifier::P0);
            moment.tell(unit, &codes::TWO_VALUES, problems);
        }
        for t in &unit.transitions {
            if !t.on_clearing.is_empty() || t.from.iter().chain(&t.to).any(writes) {
                cleared(unit, &blocked, t).tell(unit, &codes::WRITES_MEET, problems);
            }
        }
    }
    classes(unit, &blocked, problems);
}

/// True if an action may write when its step is activated or deactivated.
fn stores(action: &Action) -> bool {
    match &action.kind {
        ActionKind::Work { .. } => true,
        ActionKind::Variable { qualifier, .. } => matches!(qualifier, Qualifier::S | Qualifier::R),
        _ => false,
    }
}

/// A constant that a stored action without a condition writes.
struct Write<'u> {
    var: VarId,
    value: Constant<'u>,
    at: Span,
    /// The action that contains the write; of two writes in one action the later one counts.
    of: Span,
    /// The step or the clearing that it belongs to.
    group: usize,
}

/// All writes of one moment.
#[derive(Default)]
struct Moment<'u> {
    writes: Vec<Write<'u>>,
    group: usize,
}

/// The writes of one variable so far.
#[derive(Default)]
struct Before<'w> {
    writes: Vec<&'w Write<'w>>,
    /// Two values are among them.
    differ: bool,
    told: bool,
}

impl<'w> Before<'w> {
    /// Adds a write; returns the first one that gives the variable another value, if that has not
    /// been told yet.
    fn other(&mut self, b: &'w Write<'w>, meet: bool) -> Option<&'w Write<'w>> {
        self.differ |= self.writes.first().is_some_and(|a| a.value != b.value);
        let other = |a: &&&Write| a.value != b.value && a.of != b.of && (a.group != b.group) == meet;
        // Many steps may write one value: they need not be compared.
        let open = self.differ && !self.told;
        let found = if open { self.writes.iter().find(other).copied() } else { None };
        self.told |= found.is_some();
        self.writes.push(b);
        found
    }
}

impl<'u> Moment<'u> {
    /// Collects the writes of a step at its activation (P1) or deactivation (P0).
    #[inline(never)]
    fn step(&mut self, unit: &'u Unit, blocked: &HashSet<VarId>, step: StepId, when: Qualifier) {
        self.group += 1;
        for action in unit.steps.get(step.index()).map_or(&[][..], |s| &s.actions) {
            match &action.kind {
                ActionKind::Work { qualifier, work, condition: None, .. } if *qualifier == when => {
                    self.body(work, action.at);
                }
                ActionKind::Variable {
                    qualifier: q @ (Qualifier::S | Qualifier::R),
                    var,
                    condition: None,
                    ..
                } if when == Qualifier::P1 && unit.rules.stored_set_reset && !blocked.contains(var) => {
                    self.set_reset(action, *var, *q == Qualifier::S);
                }
                _ => {}
            }
        }
    }

    fn set_reset(&mut self, action: &Action, var: VarId, value: bool) {
        let (at, group) = (action.at, self.group);
        self.writes.push(Write { var, value: Constant::Bool(value), at, of: at, group });
    }

    /// Collects the last constant that a body leaves in each variable in every case.
    #[inline(never)]
    fn body(&mut self, work: &'u [Stmt], of: Span) {
        let mut last: BTreeMap<VarId, Option<(Constant<'u>, Span)>> = BTreeMap::new();
        for s in work {
            match &s.kind {
                StmtKind::Assign(Target::Var(v), Expr { kind: ExprKind::Const(value), .. }) => {
                    last.insert(*v, Some((Constant::of(value), s.at)));
                }
                // Statements after a RETURN may not run.
                StmtKind::Return => break,
                _ => {
                    for v in within([s]).into_iter().flat_map(written) {
                        last.insert(v, None);
                    }
                }
            }
        }
        let returns = within(work).iter().any(|s| matches!(s.kind, StmtKind::Return));
        for (var, write) in last.into_iter().filter(|_| !returns) {
            let Some((value, at)) = write else { continue };
            self.writes.push(Write { var, value, at, of, group: self.group });
        }
    }

    /// Reports each variable that is given two values, once.
    #[inline(never)]
    fn tell(&self, unit: &Unit, code: &'static g7_model::codes::Code, problems: &mut Vec<Problem>) {
        // Most moments write nothing or one variable.
        if self.writes.len() < 2 {
            return;
        }
        let meet = std::ptr::eq(code, &codes::WRITES_MEET);
        let mut before: HashMap<VarId, Before<'_>> = HashMap::new();
        for b in &self.writes {
            let Some(a) = before.entry(b.var).or_default().other(b, meet) else { continue };
            let name = unit.vars.get(b.var.index()).map_or("", |v| &*v.name);
            let (what, help) = if meet {
                (
                    say!("`{name}` gets two values when one transition clears"),
                    say!("the later one stays and each run reports the conflict; keep one of them"),
                )
            } else {
                (
                    say!("`{name}` gets two values at one moment"),
                    say!("both are written when the step changes; keep one of them"),
                )
            };
            problems
                .push(Problem::new(code, b.at, what).related(a.at, say!("another value here")).help(help));
        }
    }
}

/// Collects the writes that always happen when a transition clears: its own stored action, those on
/// deactivation of the preceding steps, those on activation of the succeeding steps.
#[inline(never)]
fn cleared<'u>(unit: &'u Unit, blocked: &HashSet<VarId>, t: &'u Transition) -> Moment<'u> {
    let mut moment = Moment::default();
    moment.body(&t.on_clearing, t.at);
    // A step on both sides stays active.
    let from: BTreeSet<&StepId> = t.from.iter().collect();
    let both: BTreeSet<&StepId> = t.to.iter().filter(|s| from.contains(s)).collect();
    for step in t.from.iter().filter(|s| !both.contains(s)) {
        moment.step(unit, blocked, *step, Qualifier::P0);
    }
    for step in t.to.iter().filter(|s| !both.contains(s)) {
        moment.step(unit, blocked, *step, Qualifier::P1);
    }
    moment
}

/// Finds variables that continuous actions drive and something else writes.
#[inline(never)]
fn classes(unit: &Unit, blocked: &HashSet<VarId>, problems: &mut Vec<Problem>) {
    let mut driven: BTreeMap<VarId, Span> = BTreeMap::new();
    let mut stored: BTreeMap<VarId, Span> = BTreeMap::new();
    for action in unit.steps.iter().flat_map(|s| &s.actions) {
        let ActionKind::Variable { qualifier, var, .. } = &action.kind else { continue };
        let set_reset = matches!(qualifier, Qualifier::S | Qualifier::R) && unit.rules.stored_set_reset;
        // If the variable has a control block, its S and R are inputs of that block.
        if !set_reset {
            driven.entry(*var).or_insert(action.at);
        } else if !blocked.contains(var) {
            stored.entry(*var).or_insert(action.at);
        }
    }
    let mut by_statement: BTreeMap<VarId, Span> = BTreeMap::new();
    for s in statements(unit) {
        for v in written(s).into_iter().filter(|v| driven.contains_key(v)) {
            let first = by_statement.entry(v).or_insert(s.at);
            *first = (*first).min(s.at);
        }
    }
    let grafcet = is_grafcet(unit);
    for (v, at) in driven {
        let by = by_statement.get(&v);
        let Some(other) = stored.get(&v).or(by) else { continue };
        let name = unit.vars.get(v.index()).map_or("", |v| &*v.name);
        let (code, what) = match (grafcet, stored.contains_key(&v)) {
            (true, true) => (
                &codes::TWO_CLASSES,
                say!("`{name}` is driven by a continuous action and set or reset by a stored one"),
            ),
            (true, false) => {
                (&codes::TWO_CLASSES, say!("`{name}` is driven by a continuous action and assigned as well"))
            }
            (false, true) => {
                (&codes::ALSO_WRITTEN, say!("`{name}` follows an action and is set or reset as well"))
            }
            (false, false) => (
                &codes::ALSO_WRITTEN,
                say!("`{name}` follows an action and is written by a statement as well"),
            ),
        };
        problems.push(
            Problem::new(code, *other, what)
                .related(at, say!("follows the activity of steps here"))
                .help(say!("use one of the two ways for a variable, not both")),
        );
    }
}
