//! Finds the enclosing steps that can be written as macro-steps with exception transitions: those
//! with the form that the reader produces.

use std::collections::BTreeMap;

use g7_model::{
    ActionKind, BinaryOp, Body, Chart, ChartItem, ChartKind, Expr, ExprKind, Name, Order, Path, Place, Step,
    StepKind, Stmt, StmtKind, Transition, Type, UnaryOp, VarKind,
};

use super::lookup::{Look, Meaning, Property, StepId, VarId};
use g7_iec::nodes;

/// How a transition is written.
#[derive(Clone, Debug)]
pub(super) struct Shown {
    /// An exception transition.
    pub(super) exception: bool,
    /// The exit step by which each preceding macro-step is left, if it has several.
    pub(super) exits: BTreeMap<usize, usize>,
    /// Its own condition.
    pub(super) condition: Expr,
}

/// The enclosing steps that are written as macro-steps.
pub(super) struct Guards {
    /// The variable that tells that an exception transition leaves a step.
    flags: BTreeMap<StepId, VarId>,
    /// For each chart: the nearest step around it with such a variable.
    above: Vec<Option<StepId>>,
    /// The exit steps of each enclosed chart.
    pub(super) exits: BTreeMap<usize, Vec<usize>>,
    /// Transitions of enclosing steps, and others that test such a variable.
    shown: BTreeMap<(usize, usize), Shown>,
}

impl Guards {
    /// Finds these steps, and makes their charts the contents of the steps.
    pub(super) fn find(look: &mut Look<'_>) -> Guards {
        let mut guards = Guards {
            flags: BTreeMap::new(),
            above: vec![None; look.charts.len()],
            exits: BTreeMap::new(),
            shown: BTreeMap::new(),
        };
        let charts = look.charts.clone();
        // The variables assigned at the beginning of each scan; None if assigned twice.
        let mut given: BTreeMap<VarId, Option<&Expr>> = BTreeMap::new();
        for (index, chart) in charts.iter().enumerate() {
            for (number, step) in chart.steps().enumerate() {
                let Some(inside) = encloses(step).and_then(|name| look.chart(name)) else { continue };
                let links = charts.get(inside).map_or(0, |c| c.steps().filter(|s| s.linked).count());
                let chart_of = charts.get(inside).is_some_and(|c| c.kind == ChartKind::Chart);
                if chart_of && links == 1 && inside > index && look.owner.get(inside) == Some(&None) {
                    look.put_inside(inside, (index, number));
                }
            }
        }
        for (index, chart) in charts.iter().enumerate() {
            for (var, value) in beginning(chart).filter_map(|s| assigned(look, index, s)) {
                given.entry(var).and_modify(|v| *v = None).or_insert(Some(value));
                if let Some(step) = tells_of(look, index, var, value) {
                    guards.flags.entry((index, step)).or_insert(var);
                }
            }
        }
        guards.put_above(look);
        for (index, chart) in charts.iter().enumerate() {
            for (number, transition) in chart.transitions().enumerate() {
                if let Some(shown) = guards.show(look, index, transition) {
                    for (step, exit) in &shown.exits {
                        let inside = look.inside_of((index, *step));
                        let list = guards.exits.entry(inside.unwrap_or(usize::MAX)).or_default();
                        if !list.contains(exit) {
                            list.push(*exit);
                        }
                    }
                    guards.shown.insert((index, number), shown);
                }
            }
        }
        guards.keep_sound(look, &given);
        guards
    }

    fn put_above(&mut self, look: &Look<'_>) {
        for index in 0..look.charts.len() {
            let mut here = index;
            let mut found = None;
            // The loop ends because an owner comes before the charts that it owns.
            while let Some(owner) = look.owner.get(here).copied().flatten() {
                if self.flags.contains_key(&owner) {
                    found = Some(owner);
                    break;
                }
                if owner.0 >= here {
                    break;
                }
                here = owner.0;
            }
            if let Some(above) = self.above.get_mut(index) {
                *above = found;
            }
        }
    }

    /// The variable that tells that an exception transition leaves a chart.
    pub(super) fn aborted(&self, chart: usize) -> Option<VarId> {
        self.flags.get(&self.above.get(chart).copied()??).copied()
    }

    /// The same for the actions of a step: its own variable if it has one.
    pub(super) fn aborted_step(&self, step: StepId) -> Option<VarId> {
        self.flags.get(&step).copied().or_else(|| self.aborted(step.0))
    }

    /// True if a variable exists only for this form.
    pub(super) fn is_flag(&self, var: VarId) -> bool {
        self.flags.values().any(|v| *v == var)
    }

    /// How a transition is written; `None` if it does not have the required form.
    pub(super) fn shown(&self, chart: usize, number: usize) -> Option<&Shown> {
        self.shown.get(&(chart, number))
    }

    fn show(&self, look: &Look<'_>, chart: usize, transition: &Transition) -> Option<Shown> {
        let mut condition = transition.receptivity.clone();
        if let Some(flag) = self.aborted(chart) {
            condition = without(look, chart, condition, flag)?;
        }
        let from: Vec<usize> = transition.from.iter().filter_map(|n| look.step(chart, &n.text)).collect();
        let enclosing = |s: &usize| look.step_at((chart, *s)).is_some_and(|s| s.kind == StepKind::Enclosing);
        let mut exits = BTreeMap::new();
        let mut plain = condition.clone();
        // The guard of the last step is outermost.
        let ordinary = from.iter().rev().filter(|s| enclosing(s)).try_for_each(|step| {
            let inside = look.inside_of((chart, *step))?;
            if let Some(flag) = self.flags.get(&(chart, *step)) {
                plain = without(look, chart, plain.clone(), *flag)?;
            }
            let (exit, rest) = behind_exit(look, chart, inside, plain.clone())?;
            exits.insert(*step, exit);
            plain = rest;
            Some(())
        });
        if ordinary.is_some() {
            return Some(Shown { exception: false, exits, condition: plain });
        }
        let all = from.iter().all(|s| self.flags.contains_key(&(chart, *s)));
        all.then(|| Shown { exception: true, exits: BTreeMap::new(), condition })
    }

    /// Drops variables that differ from those that the reader would make.
    fn keep_sound(&mut self, look: &Look<'_>, given: &BTreeMap<VarId, Option<&Expr>>) {
        let mut exceptions: BTreeMap<StepId, Vec<(Vec<usize>, &Expr)>> = BTreeMap::new();
        let mut numbers: Vec<&(usize, usize)> = self.shown.keys().collect();
        numbers.sort_unstable();
        for &(chart, number) in numbers {
            let Some(shown) = self.shown.get(&(chart, number)).filter(|s| s.exception) else { continue };
            let Some(transition) = look.transition_at((chart, number)) else { continue };
            let from: Vec<usize> = transition.from.iter().filter_map(|n| look.step(chart, &n.text)).collect();
            for step in &from {
                exceptions.entry((chart, *step)).or_default().push((from.clone(), &shown.condition));
            }
        }
        let mut wrong: Vec<usize> = Vec::new();
        for (step, flag) in &self.flags {
            let found = given.get(flag).copied().flatten();
            let of = exceptions.get(step).map_or(&[][..], Vec::as_slice);
            let sound = found.zip(self.expected(look, *step, of)).is_some_and(|(f, wanted)| *f == wanted);
            if !sound {
                wrong.push(step.0);
            }
        }
        if !wrong.is_empty() {
            self.shown.retain(|(chart, _), _| !wrong.contains(chart));
        }
    }

    fn expected(
        &self,
        look: &Look<'_>,
        (chart, step): StepId,
        exceptions: &[(Vec<usize>, &Expr)],
    ) -> Option<Expr> {
        let at = Place::default();
        let active = |n: usize| {
            let names = vec![look.step_at((chart, n))?.name.clone(), Name::new("x", at.0)];
            Some(nodes::expr(ExprKind::Path(Path { names }), at.0))
        };
        let mut any: Option<Expr> = None;
        let add = |any: Option<Expr>, e: Expr| {
            Some(match any {
                Some(before) => nodes::binary(BinaryOp::Or, before, e, at.0),
                None => e,
            })
        };
        for (from, condition) in exceptions {
            let mut e = (*condition).clone();
            for other in from.iter().filter(|s| **s != step) {
                e = both(active(*other)?, e);
            }
            any = add(any, e);
        }
        if let Some(above) = self.above.get(chart).copied().flatten() {
            let flag = self.flags.get(&above).copied()?;
            let name = look.decl(flag)?.names.get(flag.name)?.clone();
            let mut names = vec![name];
            if flag.chart != Some(chart) {
                names.insert(0, look.charts.get(flag.chart?)?.name.clone());
            }
            any = add(any, nodes::expr(ExprKind::Path(Path { names }), at.0));
        }
        Some(both(active(step)?, any?))
    }
}

/// The chart that an enclosing step encloses, if it is a single one.
pub(super) fn encloses(step: &Step) -> Option<&str> {
    if step.kind != StepKind::Enclosing {
        return None;
    }
    let mut orders = step.actions.iter().filter_map(|a| match &a.kind {
        ActionKind::Order(Order::Enclose(name)) => Some(&*name.text),
        _ => None,
    });
    orders.next().filter(|_| orders.next().is_none())
}

/// The assignments at the beginning of each scan of a chart.
pub(super) fn beginning(chart: &Chart) -> impl Iterator<Item = &Stmt> {
    chart.items.iter().flat_map(|i| match i {
        ChartItem::Pre(Body::St(b), _) => &b.statements[..],
        _ => &[],
    })
}

/// The variable that a statement assigns, and its value.
fn assigned<'s>(look: &Look<'_>, index: usize, s: &'s Stmt) -> Option<(VarId, &'s Expr)> {
    let StmtKind::Assign { target, value } = &s.kind else { return None };
    let ExprKind::Path(target) = &target.kind else { return None };
    match look.path(index, target) {
        Some(Meaning::Var(var)) => Some((var, value)),
        _ => None,
    }
}

/// The enclosing step of `flag := Step.x and …`, if the chart declares the variable.
fn tells_of(look: &Look<'_>, index: usize, var: VarId, value: &Expr) -> Option<usize> {
    // Without a condition of the exception only the activity remains.
    let first = match &value.kind {
        ExprKind::Binary(BinaryOp::And, first, _) => first,
        _ => value,
    };
    let decl = look.decl(var).filter(|d| var.chart == Some(index) && d.names.len() == 1)?;
    let plain = decl.kind == VarKind::Var && decl.ty == Type::Bool && decl.init.is_none() && !decl.retain;
    let named = decl.names.first().is_some_and(|n| n.text.contains("_abort"));
    let ExprKind::Path(active) = &first.kind else { return None };
    match look.path(index, active) {
        Some(Meaning::Step((chart, step), Property::Active)) if chart == index && plain && named => {
            look.inside_of((chart, step)).map(|_| step)
        }
        _ => None,
    }
}

/// An expression without `and not flag` at its end.
fn without(look: &Look<'_>, chart: usize, e: Expr, flag: VarId) -> Option<Expr> {
    let at = e.at;
    match e.kind {
        ExprKind::Binary(BinaryOp::And, rest, last) if is_not(look, chart, &last, flag) => Some(*rest),
        kind => is_not(look, chart, &Expr { kind, at }, flag).then(|| nodes::boolean(true, at.0)),
    }
}

/// True if the expression is `not flag`.
pub(super) fn is_not(look: &Look<'_>, chart: usize, e: &Expr, flag: VarId) -> bool {
    matches!(&e.kind, ExprKind::Unary(UnaryOp::Not, inner) if is(look, chart, inner, flag))
}

/// True if the expression is `flag`.
pub(super) fn is(look: &Look<'_>, chart: usize, e: &Expr, flag: VarId) -> bool {
    matches!(&e.kind, ExprKind::Path(p) if look.path(chart, p) == Some(Meaning::Var(flag)))
}

/// The exit step that an expression tests first, and the rest of the expression.
fn behind_exit(look: &Look<'_>, chart: usize, inside: usize, e: Expr) -> Option<(usize, Expr)> {
    let exit = |e: &Expr| match &e.kind {
        ExprKind::Path(p) => match look.path(chart, p) {
            Some(Meaning::Step((c, step), Property::Active)) if c == inside => Some(step),
            _ => None,
        },
        _ => None,
    };
    if let Some(step) = exit(&e) {
        return Some((step, nodes::boolean(true, e.at.0)));
    }
    match e.kind {
        ExprKind::Binary(BinaryOp::And, first, rest) => exit(&first).map(|step| (step, *rest)),
        _ => None,
    }
}

fn both(a: Expr, b: Expr) -> Expr {
    crate::jgrafchart::guards::both(a, b, g7_model::Span::default())
}
