//! Decides whether Boolean expressions can be true, by treating them as formulas.
//!
//! An expression is split into atoms: a value that the search knows nothing about (a variable, a
//! call), the interval of a number between the constants that it is compared with, the result of
//! comparing two numbers. Formulas and values of the atoms become clauses (`clauses`), and the solver
//! says whether all formulas can hold together. The values of every run are among those of the atoms,
//! so a formula that fails for all of them is never true.

#[cfg(test)]
mod tests;

use std::cmp::Ordering;
use std::collections::BTreeMap;

use g7_model::Type;

use super::clauses;
use super::facts::Facts;
use super::formula::{Atom, Cut, Formula, Part, Sort, Values, holds};
use super::tree::{Form, has_edge};
use crate::ir::{BinaryOp, ChartId, Expr, ExprKind, StepId, Value};

/// The deepest expression that is split into atoms.
const DEEPEST: u32 = 200;
/// The largest number of atoms in one question.
const ATOMS: usize = 500;

/// A question: can all these formulas be true together?
pub(super) struct Question<'e, 'f> {
    facts: &'f Facts<'f>,
    atoms: Vec<Atom<'e>>,
    /// More than [`ATOMS`] are needed, so it is not answered.
    too_long: bool,
    parts: Vec<Formula<'e>>,
    goals: Vec<Part>,
}

impl<'e, 'f> Question<'e, 'f> {
    pub(super) fn new(facts: &'f Facts<'f>) -> Self {
        // Enough for most questions, so that none of the lists has to grow.
        let (atoms, parts, goals) = (Vec::with_capacity(8), Vec::with_capacity(16), Vec::with_capacity(8));
        Question { facts, atoms, too_long: false, parts, goals }
    }

    /// The expression has this value.
    pub(super) fn demand(&mut self, e: &'e Expr, value: bool) {
        self.demand_at(e, value, 0);
    }

    /// Several goals are quicker than one that joins them: see [`Question::possible`].
    fn demand_at(&mut self, e: &'e Expr, value: bool, depth: u32) {
        match &e.kind {
            ExprKind::Not(a) if depth < DEEPEST => self.demand_at(a, !value, depth + 1),
            ExprKind::Binary(BinaryOp::And, a, b) if depth < DEEPEST && value => {
                self.demand_at(a, true, depth + 1);
                self.demand_at(b, true, depth + 1);
            }
            ExprKind::Binary(BinaryOp::Or, a, b) if depth < DEEPEST && !value => {
                self.demand_at(a, false, depth + 1);
                self.demand_at(b, false, depth + 1);
            }
            _ => {
                let part = self.formula(e, depth);
                let goal = if value { part } else { self.part(Formula::Not(part)) };
                self.goals.push(goal);
            }
        }
    }

    /// These steps are active. Returns false if the question is about no step, so that this adds
    /// nothing.
    pub(super) fn with_active(&mut self, active: &[StepId]) -> bool {
        let named: Vec<(StepId, usize)> = self.atoms.iter().enumerate().filter_map(step_of).collect();
        if named.is_empty() {
            return false;
        }
        let mut groups: BTreeMap<ChartId, Vec<usize>> = BTreeMap::new();
        for (step, atom) in named {
            if active.contains(&step) {
                self.set(atom, true);
            } else if active.iter().any(|a| self.facts.exclude(*a, step)) {
                self.set(atom, false);
            } else if let Some(chart) = self.facts.group(step) {
                groups.entry(chart).or_default().push(atom);
            }
        }
        for group in groups.into_values().filter(|g| g.len() > 1) {
            let goal = self.part(Formula::OneOf(group));
            self.goals.push(goal);
        }
        true
    }

    /// No edge is present, so an atom that may contain one is false.
    pub(super) fn at_rest(&mut self) {
        for i in 0..self.atoms.len() {
            let Some(atom) = self.atoms.get(i) else { continue };
            let hides = match &atom.of.kind {
                ExprKind::Section(_) | ExprKind::Call(..) | ExprKind::Member(..) => true,
                _ => has_edge(atom.of),
            };
            if hides && matches!(atom.sort, Sort::Truth) {
                self.set(i, false);
            }
        }
    }

    /// Tells whether all formulas can be true together; `None` if the search would be too long.
    pub(super) fn possible(&self) -> Option<bool> {
        if self.too_long {
            return None;
        }
        let mut values = vec![None; self.atoms.len()];
        for goal in &self.goals {
            let Some((atom, value)) = self.given(*goal) else { continue };
            let slot = values.get_mut(atom)?;
            if slot.is_some_and(|v| v != value) {
                return Some(false);
            }
            *slot = Some(value);
        }
        // A first guess is enough for most questions: the receptivities of a branch usually have no variable in
        // common, and an OR is usually true with its first operand. The others go to the solver.
        if self.goals.iter().all(|goal| self.comes_true(*goal, true, &mut values)) {
            return Some(true);
        }
        clauses::possible(&self.atoms, &self.parts, &self.goals)
    }

    /// Gives truths that are still open such values that a part has this value. Returns false if the
    /// first try for each OR fails, or if the part is about more than truths.
    fn comes_true(&self, part: Part, value: bool, values: &mut Vec<Option<bool>>) -> bool {
        let mut either = |a: Part, b: Part| {
            let before = values.clone();
            self.comes_true(a, value, values) || {
                *values = before;
                self.comes_true(b, value, values)
            }
        };
        match self.parts.get(part.0) {
            Some(Formula::Const(v)) => *v == value,
            Some(Formula::Not(a)) => self.comes_true(*a, !value, values),
            Some(Formula::And(a, b)) if !value => either(*a, *b),
            Some(Formula::Or(a, b)) if value => either(*a, *b),
            Some(Formula::And(a, b) | Formula::Or(a, b)) => {
                self.comes_true(*a, value, values) && self.comes_true(*b, value, values)
            }
            Some(Formula::Among(atom, Values::True)) => {
                let truth = self.atoms.get(*atom).is_some_and(|a| matches!(a.sort, Sort::Truth));
                let Some(slot) = values.get_mut(*atom).filter(|_| truth) else { return false };
                *slot.get_or_insert(value) == value
            }
            Some(Formula::Among(..) | Formula::Xor(..) | Formula::OneOf(_)) | None => false,
        }
    }

    /// The value that a goal alone gives to an atom.
    fn given(&self, goal: Part) -> Option<(usize, bool)> {
        match self.parts.get(goal.0)? {
            Formula::Among(atom, Values::True) => Some((*atom, true)),
            Formula::Not(a) => match self.parts.get(a.0)? {
                Formula::Among(atom, Values::True) => Some((*atom, false)),
                _ => None,
            },
            _ => None,
        }
    }

    fn part(&mut self, formula: Formula<'e>) -> Part {
        self.parts.push(formula);
        Part(self.parts.len() - 1)
    }

    /// Adds the goal that an atom has this truth.
    fn set(&mut self, atom: usize, value: bool) {
        let truth = self.part(Formula::Among(atom, Values::True));
        let goal = if value { truth } else { self.part(Formula::Not(truth)) };
        self.goals.push(goal);
    }

    fn atom(&mut self, sort: Sort<'e>, of: &'e Expr) -> usize {
        self.too_long |= self.atoms.len() == ATOMS;
        if !self.too_long {
            self.atoms.push(Atom { sort, of });
        }
        self.atoms.len() - 1
    }

    /// The atom for an expression that is not split, if there is one already.
    fn known(&self, e: &Expr) -> Option<usize> {
        self.atoms.iter().position(|a| matches!(a.sort, Sort::Truth) && Form(a.of) == Form(e))
    }

    fn formula(&mut self, e: &'e Expr, depth: u32) -> Part {
        if self.too_long {
            return self.part(Formula::Const(true));
        }
        if depth > DEEPEST {
            let atom = self.known(e).unwrap_or_else(|| self.atom(Sort::Truth, e));
            return self.part(Formula::Among(atom, Values::True));
        }
        let formula = match &e.kind {
            ExprKind::Const(Value::Bool(v)) => Formula::Const(*v),
            ExprKind::Not(a) => Formula::Not(self.formula(a, depth + 1)),
            ExprKind::Binary(op @ (BinaryOp::And | BinaryOp::Or | BinaryOp::Xor), a, b) => {
                let (a, b) = (self.formula(a, depth + 1), self.formula(b, depth + 1));
                match op {
                    BinaryOp::And => Formula::And(a, b),
                    BinaryOp::Or => Formula::Or(a, b),
                    _ => Formula::Xor(a, b),
                }
            }
            ExprKind::Binary(op, a, b) if compares(*op) && a.ty == Type::Bool => {
                let (a, b) = (self.formula(a, depth + 1), self.formula(b, depth + 1));
                self.of_truths(*op, a, b)
            }
            ExprKind::Binary(op, a, b) if compares(*op) => self.comparison(*op, a, b),
            _ => self.leaf(e, depth),
        };
        self.part(formula)
    }

    fn of_truths(&mut self, op: BinaryOp, a: Part, b: Part) -> Formula<'e> {
        match op {
            BinaryOp::Eq => Formula::Not(self.part(Formula::Xor(a, b))),
            BinaryOp::Lt => Formula::And(self.part(Formula::Not(a)), b),
            BinaryOp::Le => Formula::Or(self.part(Formula::Not(a)), b),
            BinaryOp::Gt => Formula::And(a, self.part(Formula::Not(b))),
            BinaryOp::Ge => Formula::Or(a, self.part(Formula::Not(b))),
            _ => Formula::Xor(a, b),
        }
    }

    fn comparison(&mut self, op: BinaryOp, a: &'e Expr, b: &'e Expr) -> Formula<'e> {
        match (constant(a), constant(b)) {
            (None, Some(cut)) => return self.side(a, op, cut),
            (Some(cut), None) => return self.side(b, mirrored(op), cut),
            _ => {}
        }
        if Form(a) == Form(b) && !a.ty.is_real() {
            return Formula::Const(holds(op, Ordering::Equal));
        }
        let known = self.atoms.iter().enumerate().find_map(|(i, atom)| {
            let Sort::Relation(with) = atom.sort else { return None };
            let (x, y) = (Form(atom.of), Form(with));
            if (x, y) == (Form(a), Form(b)) {
                Some((i, op))
            } else {
                ((x, y) == (Form(b), Form(a))).then_some((i, mirrored(op)))
            }
        });
        let (atom, op) = known.unwrap_or_else(|| (self.atom(Sort::Relation(b), a), op));
        Formula::Among(atom, Values::Order(op))
    }

    fn side(&mut self, e: &'e Expr, op: BinaryOp, cut: Cut<'e>) -> Formula<'e> {
        let place = |a: &Atom<'e>| matches!(a.sort, Sort::Place(..)) && Form(a.of) == Form(e);
        let known = self.atoms.iter().position(place);
        let i = known.unwrap_or_else(|| self.atom(Sort::Place(e.ty, Vec::new()), e));
        if let Some(Sort::Place(_, cuts)) = self.atoms.get_mut(i).map(|a| &mut a.sort)
            && !cuts.contains(&cut)
        {
            cuts.push(cut);
            cuts.sort_by(Cut::order);
        }
        Formula::Among(i, Values::Side(op, cut))
    }

    /// An atom for an expression that is not split; conditions that follow from it are added to the
    /// question.
    fn leaf(&mut self, e: &'e Expr, depth: u32) -> Formula<'e> {
        if let Some(atom) = self.known(e) {
            return Formula::Among(atom, Values::True);
        }
        let atom = self.atom(Sort::Truth, e);
        let consequence = match &e.kind {
            // A rising edge needs an operand that is true now, a falling edge one that is
            // false.
            ExprKind::Rise(x) if self.facts.steady(x) => Some((x, true)),
            ExprKind::Fall(x) if self.facts.steady(x) => Some((x, false)),
            ExprKind::Timer { e: x, t2, .. } if at_once(t2.as_deref()) && self.facts.steady(x) => {
                Some((x, true))
            }
            _ => None,
        };
        if let Some((x, value)) = consequence {
            let then = self.formula(x, depth + 1);
            let then = if value { then } else { self.part(Formula::Not(then)) };
            let own = self.part(Formula::Among(atom, Values::True));
            let not = self.part(Formula::Not(own));
            let goal = self.part(Formula::Or(not, then));
            self.goals.push(goal);
        }
        Formula::Among(atom, Values::True)
    }
}

/// The step whose activity an atom is, with the atom.
fn step_of((i, atom): (usize, &Atom<'_>)) -> Option<(StepId, usize)> {
    match (&atom.sort, &atom.of.kind) {
        (Sort::Truth, ExprKind::StepActive(step)) => Some((*step, i)),
        _ => None,
    }
}

/// True if a timer without this second time ends together with its condition.
fn at_once(t2: Option<&Expr>) -> bool {
    t2.is_none_or(|t| matches!(t.kind, ExprKind::Const(Value::Int(0))))
}

fn compares(op: BinaryOp) -> bool {
    matches!(op, BinaryOp::Eq | BinaryOp::Ne | BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge)
}

/// The operator with its operands exchanged.
fn mirrored(op: BinaryOp) -> BinaryOp {
    match op {
        BinaryOp::Lt => BinaryOp::Gt,
        BinaryOp::Le => BinaryOp::Ge,
        BinaryOp::Gt => BinaryOp::Lt,
        BinaryOp::Ge => BinaryOp::Le,
        other => other,
    }
}

/// The value of a constant to compare with. Above 2^53 neighbours become equal as `f64`, and two
/// constants would count as one, so such constants are left out.
fn constant(e: &Expr) -> Option<Cut<'_>> {
    match &e.kind {
        ExprKind::Const(Value::Int(n)) if n.unsigned_abs() < 1 << 53 => Some(Cut::Number(*n as f64)),
        ExprKind::Const(Value::Real(x)) if x.is_finite() => Some(Cut::Number(*x)),
        ExprKind::Const(Value::Str(s)) => Some(Cut::Text(s)),
        _ => None,
    }
}
