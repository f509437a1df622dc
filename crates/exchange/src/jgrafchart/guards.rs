//! Macro-steps with exception transitions, which leave them at any of their steps.
//!
//! JGrafchart marks an exception transition while its macro-step is active, before any transition
//! is cleared. Clearing it deactivates all steps inside; transitions inside that were marked are no
//! longer cleared, and the actions `A` run instead of `X`. Ordinary transitions behind the
//! macro-step have lower priority.
//!
//! Here such a macro-step is an enclosing step. A variable that is computed at the beginning of
//! each scan tells that an exception transition leaves it. The ordinary transitions behind the
//! macro-step, all transitions inside, and the actions on deactivation test this variable. An
//! ordinary transition also tests its exit step, so several exits are possible.

use std::collections::HashSet;

use g7_model::codes;
use g7_model::{BinaryOp, Expr, ExprKind, Name, Path, Span, UnaryOp, say};

use super::lex::{Kind, tokens};
use super::links::{Ends, exits};
use super::naming::Names;
use super::sheet::{Plan, SheetKind, StepSort};
use g7_iec::nodes::{self, Taken};
use g7_iec::report::{Report, shown};

/// How macro-steps are left.
pub(super) struct Guards {
    /// For each workspace: true if it belongs to an enclosing step, false if it is an expansion.
    pub(super) enclosed: Vec<bool>,
    /// For each workspace: the variable that tells that an exception transition leaves it. It is
    /// declared in the chart that contains the macro-step.
    pub(super) flag: Vec<Option<String>>,
    /// For each workspace: the nearest workspace with such a variable, itself or one around it.
    above: Vec<Option<usize>>,
    /// The exit steps of each workspace, in the order of the ports.
    exits: Vec<Vec<usize>>,
}

impl Guards {
    pub(super) fn find(plan: &Plan, names: &Names, ends: &[Vec<Ends>], report: &mut Report) -> Guards {
        let count = plan.sheets.len();
        let mut guards = Guards {
            enclosed: vec![false; count],
            flag: vec![None; count],
            above: vec![None; count],
            exits: plan.sheets.iter().map(exits).collect(),
        };
        let mut taken = all_names(plan, names);
        let mut excepted: HashSet<(usize, usize)> = HashSet::new();
        for (index, sheet) in plan.sheets.iter().enumerate() {
            for (node, ends) in sheet.transitions.iter().zip(ends.get(index).into_iter().flatten()) {
                if node.exception {
                    excepted.extend(ends.from.iter().map(|step| (index, *step)));
                }
            }
        }
        for (index, sheet) in plan.sheets.iter().enumerate() {
            let Some(owner) = sheet.owner.filter(|_| sheet.kind == SheetKind::Macro) else { continue };
            let exception = excepted.contains(&owner);
            let ways = guards.exits.get(index).map_or(0, Vec::len);
            let endless = sheet.call.is_some() && ways == 0;
            let Some(enclosed) = guards.enclosed.get_mut(index) else { continue };
            *enclosed = exception || ways > 1 || endless;
            if *enclosed {
                differences(plan, index, report);
            }
            if exception && let Some(flag) = guards.flag.get_mut(index) {
                *flag = Some(taken.give(&format!("{}_abort", names.step(owner.0, owner.1))));
            }
        }
        // A workspace comes after the one that contains its step.
        for index in 0..count {
            let own = guards.flag.get(index).is_some_and(Option::is_some);
            let owner = plan.sheets.get(index).and_then(|s| s.owner.or(Some((s.parent?, 0))));
            let outer = owner.filter(|(o, _)| *o < index).and_then(|(o, _)| guards.above.get(o).copied()?);
            if let Some(above) = guards.above.get_mut(index) {
                *above = if own { Some(index) } else { outer };
            }
        }
        guards
    }

    /// An expression in the chart `home` that is true when a workspace is left by an exception;
    /// None if that cannot happen.
    pub(super) fn aborted(
        &self,
        plan: &Plan,
        names: &Names,
        inside: usize,
        home: usize,
        at: Span,
    ) -> Option<Expr> {
        let index = self.above.get(inside).copied()??;
        let flag = self.flag.get(index)?.as_deref()?;
        let (owner, _) = plan.sheets.get(index)?.owner?;
        let path = if owner == home { vec![flag] } else { vec![names.chart(owner), flag] };
        Some(nodes::name(&path, at))
    }

    /// The complete receptivity of a transition, with everything that it tests.
    pub(super) fn receptivity(
        &self,
        (plan, names): (&Plan, &Names),
        (sheet, number): (usize, usize),
        ends: &Ends,
        condition: Expr,
        at: Span,
    ) -> Expr {
        let Some(home) = plan.sheets.get(sheet) else { return condition };
        let exception = home.transitions.get(number).is_some_and(|t| t.exception);
        let mut whole = condition;
        for (step, way) in ends.from.iter().zip(&ends.ways).filter(|_| !exception) {
            let Some(StepSort::Macro(Some(inside))) = home.steps.get(*step).map(|s| s.sort) else { continue };
            if !self.enclosed.get(inside).copied().unwrap_or(false) {
                continue;
            }
            if let Some(exit) = self.exits.get(inside).and_then(|e| e.get(*way)).copied() {
                let active = activity(names.chart(inside), names.step(inside, exit), at);
                whole = both(active, whole, at);
            }
            if self.flag.get(inside).is_some_and(Option::is_some)
                && let Some(flag) = self.aborted(plan, names, inside, sheet, at)
            {
                whole = both(whole, nodes::unary(UnaryOp::Not, flag, at), at);
            }
        }
        if let Some((caller, step)) = home.owner.filter(|_| home.call.is_some())
            && ends.from.iter().any(|s| home.steps.get(*s).is_some_and(|s| s.sort == StepSort::Enter))
        {
            // A procedure does not evolve in the scan after its call.
            let path = [names.chart(caller), names.step(caller, step), "t"];
            let late = nodes::binary(BinaryOp::Gt, nodes::name(&path, at), nodes::int(1, at), at);
            whole = both(whole, late, at);
        }
        match self.aborted(plan, names, sheet, sheet, at) {
            Some(flag) => both(whole, nodes::unary(UnaryOp::Not, flag, at), at),
            None => whole,
        }
    }

    /// The value of a workspace's variable at the beginning of a scan: the macro-step is active,
    /// and an exception transition is marked or leaves a workspace around it.
    pub(super) fn marked(
        &self,
        (plan, names): (&Plan, &Names),
        inside: usize,
        exceptions: &[(&Ends, &Expr)],
        at: Span,
    ) -> Option<Expr> {
        let (owner, step) = plan.sheets.get(inside)?.owner?;
        let active = |step: usize| activity_here(names.step(owner, step), at);
        let mut any: Option<Expr> = None;
        let mut add = |e: Expr| {
            any = Some(match any.take() {
                Some(before) => nodes::binary(BinaryOp::Or, before, e, at),
                None => e,
            });
        };
        for (ends, condition) in exceptions.iter().filter(|(ends, _)| ends.from.contains(&step)) {
            let others = ends.from.iter().filter(|s| **s != step);
            add(others.fold((*condition).clone(), |e, s| both(active(*s), e, at)));
        }
        if let Some(around) = self.aborted(plan, names, owner, owner, at) {
            add(around);
        }
        Some(both(active(step), any?, at))
    }
}

/// `a and b`, simplified if one is TRUE.
pub(super) fn both(a: Expr, b: Expr, at: Span) -> Expr {
    match (nodes::truth(&a), nodes::truth(&b)) {
        (Some(true), _) => b,
        (_, Some(true)) => a,
        _ => nodes::binary(BinaryOp::And, a, b, at),
    }
}

fn activity(chart: &str, step: &str, at: Span) -> Expr {
    nodes::name(&[chart, step, "x"], at)
}

fn activity_here(step: &str, at: Span) -> Expr {
    let path = Path { names: vec![Name::new(step, at), Name::new("x", at)] };
    nodes::expr(ExprKind::Path(path), at)
}

/// The names of all steps, variables and parameters.
fn all_names(plan: &Plan, names: &Names) -> Taken {
    let steps = names.steps.iter().flatten().cloned();
    let vars = plan.sheets.iter().flat_map(|s| s.vars.iter().map(|v| v.name.text.clone()));
    let refs = plan.sheets.iter().flat_map(|s| s.refs.keys().cloned());
    let mut taken = Taken::exact();
    steps.chain(vars).chain(refs).for_each(|name| _ = taken.take(&name));
    taken
}

/// Reports differences between an enclosing step and a macro-step.
fn differences(plan: &Plan, inside: usize, report: &mut Report) {
    let Some(sheet) = plan.sheets.get(inside) else { return };
    let name = shown(&sheet.name.text);
    if sheet.bars > 0 {
        let what = say!(
            "branches of `{name}` that are still active when its exit step is left end with it; JGrafchart goes on with them"
        );
        report.say(&codes::DIFFERENT, &sheet.at, what);
    }
    let Some((owner, step)) = sheet.owner else { return };
    let Some(node) = plan.sheets.get(owner).and_then(|s| s.steps.get(step)) else { return };
    let texts = sheet.steps.iter().flat_map(|s| &s.actions);
    let inner: HashSet<String> = texts.flat_map(|t| words(&t.text)).collect();
    if node.actions.iter().flat_map(|t| words(&t.text)).any(|w| inner.contains(&w)) {
        let what = say!(
            "the actions of `{name}` run before those of the steps in it; in JGrafchart they come behind"
        );
        report.say(&codes::DIFFERENT, &node.at, what);
    }
}

/// The names in a text of actions.
fn words(text: &str) -> Vec<String> {
    if text.len() > super::limits::MOST_BYTES {
        return Vec::new();
    }
    let name = |kind: Kind| if let Kind::Name(name) = kind { Some(name) } else { None };
    let names = tokens(text).into_iter().filter_map(|t| name(t.kind));
    names.filter(|n| !matches!(n.as_str(), "S" | "P" | "X" | "N" | "A")).collect()
}
