//! Decides whether Boolean expressions can be true, by treating them as formulas.
//!
//! An expression is split into atoms: a value that the search knows nothing about (a variable, a
//! call), the interval of a number between the constants that it is compared with, the result of
//! comparing two numbers. Then values are tried for the atoms until all formulas hold or no values
//! are left. The values of every run are among those tried, so a formula that fails for all of them
//! is never true.

use std::cmp::Ordering;
use std::collections::{BTreeMap, HashMap};

use g7_model::Type;

use super::facts::Facts;
use super::tree::{has_edge, key};
use crate::ir::{BinaryOp, ChartId, Expr, ExprKind, StepId, Value};

/// The largest number of assignments that are tried for one question.
const TRIES: u32 = 20_000;
/// The deepest expression that is split into atoms.
const DEEPEST: u32 = 200;
/// The largest number of atoms in one question.
const ATOMS: usize = 200;

/// A formula over atoms.
enum Formula {
    Const(bool),
    /// The atom has one of the values in this mask.
    Among(usize, Values),
    Not(Box<Formula>),
    And(Box<Formula>, Box<Formula>),
    Or(Box<Formula>, Box<Formula>),
    Xor(Box<Formula>, Box<Formula>),
    /// At most one of these atoms is true.
    OneOf(Vec<usize>),
}

/// The values of an atom that make a comparison true.
#[derive(Clone)]
enum Values {
    /// It is true (1).
    True,
    /// The number compares in this way with one of its cuts.
    Side(BinaryOp, Cut),
    /// The two numbers compare in this way.
    Order(BinaryOp),
}

/// A constant that a value is compared with.
#[derive(Clone, PartialEq)]
enum Cut {
    Number(f64),
    Text(Box<str>),
}

impl Cut {
    fn order(&self, other: &Cut) -> Ordering {
        match (self, other) {
            (Cut::Number(a), Cut::Number(b)) => a.total_cmp(b),
            (Cut::Text(a), Cut::Text(b)) => a.cmp(b),
            (Cut::Number(_), Cut::Text(_)) => Ordering::Less,
            (Cut::Text(_), Cut::Number(_)) => Ordering::Greater,
        }
    }
}

enum Sort {
    /// False or true.
    Truth,
    /// The place of a value among the sorted cuts: 2k below cut k, 2k+1 on it.
    Place(Type, Vec<Cut>),
    /// Less, equal, greater.
    Relation,
}

struct Atom<'e> {
    sort: Sort,
    of: &'e Expr,
}

/// A question: can all these formulas be true together?
pub(super) struct Question<'e, 'f> {
    facts: &'f Facts<'f>,
    index: HashMap<String, usize>,
    atoms: Vec<Atom<'e>>,
    goals: Vec<Formula>,
    /// The steps in the question, by their atom.
    steps: BTreeMap<StepId, usize>,
}

impl<'e, 'f> Question<'e, 'f> {
    pub(super) fn new(facts: &'f Facts<'f>) -> Self {
        Question {
            facts,
            index: HashMap::new(),
            atoms: Vec::new(),
            goals: Vec::new(),
            steps: BTreeMap::new(),
        }
    }

    /// The expression has this value.
    pub(super) fn demand(&mut self, e: &'e Expr, value: bool) {
        let formula = self.formula(e, 0);
        self.goals.push(if value { formula } else { Formula::Not(Box::new(formula)) });
    }

    /// These steps are active.
    pub(super) fn with_active(&mut self, active: &[StepId]) {
        let named: Vec<(StepId, usize)> = self.steps.iter().map(|(s, a)| (*s, *a)).collect();
        let mut groups: BTreeMap<ChartId, Vec<usize>> = BTreeMap::new();
        for (step, atom) in named {
            let truth = Formula::Among(atom, Values::True);
            if active.contains(&step) {
                self.goals.push(truth);
            } else if active.iter().any(|a| self.facts.exclude(*a, step)) {
                self.goals.push(Formula::Not(Box::new(truth)));
            } else if let Some(chart) = self.facts.group(step) {
                groups.entry(chart).or_default().push(atom);
            }
        }
        self.goals.extend(groups.into_values().filter(|g| g.len() > 1).map(Formula::OneOf));
    }

    /// No edge is present, so an atom that may contain one is false.
    pub(super) fn at_rest(&mut self) {
        for (i, atom) in self.atoms.iter().enumerate() {
            let hides = match &atom.of.kind {
                ExprKind::Section(_) | ExprKind::Call(..) | ExprKind::Member(..) => true,
                _ => has_edge(atom.of),
            };
            if hides && matches!(atom.sort, Sort::Truth) {
                self.goals.push(Formula::Not(Box::new(Formula::Among(i, Values::True))));
            }
        }
    }

    /// Tells whether all formulas can be true together; `None` if the search would be too long.
    pub(super) fn possible(&self) -> Option<bool> {
        if self.atoms.len() > ATOMS {
            return None;
        }
        let mut values = vec![None; self.atoms.len()];
        let mut tries = 0;
        self.search(&mut values, 0, &mut tries)
    }

    fn search(&self, values: &mut Vec<Option<usize>>, next: usize, tries: &mut u32) -> Option<bool> {
        let mut open = false;
        for goal in &self.goals {
            match self.truth(goal, values) {
                Some(false) => return Some(false),
                Some(true) => {}
                None => open = true,
            }
        }
        let Some(atom) = self.atoms.get(next).filter(|_| open) else { return Some(true) };
        for value in domain(&atom.sort) {
            *tries += 1;
            if *tries > TRIES {
                return None;
            }
            if let Some(slot) = values.get_mut(next) {
                *slot = Some(value);
            }
            match self.search(values, next + 1, tries) {
                Some(false) => {}
                found => return found,
            }
        }
        if let Some(slot) = values.get_mut(next) {
            *slot = None;
        }
        Some(false)
    }

    /// The value of a formula as far as the values tried so far decide it.
    fn truth(&self, f: &Formula, values: &[Option<usize>]) -> Option<bool> {
        match f {
            Formula::Const(v) => Some(*v),
            Formula::Not(a) => self.truth(a, values).map(|v| !v),
            Formula::And(a, b) => match (self.truth(a, values), self.truth(b, values)) {
                (Some(false), _) | (_, Some(false)) => Some(false),
                (Some(true), Some(true)) => Some(true),
                _ => None,
            },
            Formula::Or(a, b) => match (self.truth(a, values), self.truth(b, values)) {
                (Some(true), _) | (_, Some(true)) => Some(true),
                (Some(false), Some(false)) => Some(false),
                _ => None,
            },
            Formula::Xor(a, b) => Some(self.truth(a, values)? != self.truth(b, values)?),
            Formula::OneOf(list) => {
                let on = list.iter().filter(|a| values.get(**a) == Some(&Some(1))).count();
                let open = list.iter().any(|a| values.get(*a) == Some(&None));
                if on > 1 { Some(false) } else { (!open).then_some(true) }
            }
            Formula::Among(a, which) => {
                let value = values.get(*a).copied().flatten()?;
                Some(match (which, self.atoms.get(*a).map(|a| &a.sort)) {
                    (Values::Side(op, cut), Some(Sort::Place(_, cuts))) => {
                        let k = cuts.iter().position(|c| c == cut).unwrap_or(0);
                        holds(*op, value.cmp(&(2 * k + 1)))
                    }
                    (Values::Order(op), _) => holds(*op, value.cmp(&1)),
                    _ => value == 1,
                })
            }
        }
    }

    fn atom(&mut self, name: String, sort: Sort, of: &'e Expr) -> usize {
        let count = self.atoms.len();
        let i = *self.index.entry(name).or_insert(count);
        if i == count {
            self.atoms.push(Atom { sort, of });
        }
        i
    }

    fn formula(&mut self, e: &'e Expr, depth: u32) -> Formula {
        if depth > DEEPEST {
            return Formula::Among(self.atom(key(e), Sort::Truth, e), Values::True);
        }
        let mut part = |e: &'e Expr| Box::new(self.formula(e, depth + 1));
        match &e.kind {
            ExprKind::Const(Value::Bool(v)) => Formula::Const(*v),
            ExprKind::Not(a) => Formula::Not(part(a)),
            ExprKind::Binary(BinaryOp::And, a, b) => Formula::And(part(a), part(b)),
            ExprKind::Binary(BinaryOp::Or, a, b) => Formula::Or(part(a), part(b)),
            ExprKind::Binary(BinaryOp::Xor, a, b) => Formula::Xor(part(a), part(b)),
            ExprKind::Binary(op, a, b) if compares(*op) && a.ty == Type::Bool => {
                of_truths(*op, part(a), part(b))
            }
            ExprKind::Binary(op, a, b) if compares(*op) => self.comparison(*op, a, b),
            _ => self.leaf(e, depth),
        }
    }

    fn comparison(&mut self, op: BinaryOp, a: &'e Expr, b: &'e Expr) -> Formula {
        match (constant(a), constant(b)) {
            (None, Some(cut)) => self.side(a, op, cut),
            (Some(cut), None) => self.side(b, mirrored(op), cut),
            _ => {
                let (x, y) = (key(a), key(b));
                if x == y && !a.ty.is_real() {
                    return Formula::Const(holds(op, Ordering::Equal));
                }
                let swap = x > y;
                let (name, op) =
                    if swap { (format!("{y}?{x}"), mirrored(op)) } else { (format!("{x}?{y}"), op) };
                Formula::Among(self.atom(name, Sort::Relation, a), Values::Order(op))
            }
        }
    }

    fn side(&mut self, e: &'e Expr, op: BinaryOp, cut: Cut) -> Formula {
        let i = self.atom(format!("{}#", key(e)), Sort::Place(e.ty, Vec::new()), e);
        if let Some(Sort::Place(_, cuts)) = self.atoms.get_mut(i).map(|a| &mut a.sort)
            && !cuts.contains(&cut)
        {
            cuts.push(cut.clone());
            cuts.sort_by(Cut::order);
        }
        Formula::Among(i, Values::Side(op, cut))
    }

    /// An atom for an expression that is not split; conditions that follow from it are added to the
    /// question.
    fn leaf(&mut self, e: &'e Expr, depth: u32) -> Formula {
        let known = self.atoms.len();
        let i = self.atom(key(e), Sort::Truth, e);
        if i == known {
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
                let then = Box::new(self.formula(x, depth + 1));
                let then = if value { then } else { Box::new(Formula::Not(then)) };
                let not = Box::new(Formula::Not(Box::new(Formula::Among(i, Values::True))));
                self.goals.push(Formula::Or(not, then));
            }
            if let ExprKind::StepActive(step) = e.kind {
                self.steps.insert(step, i);
            }
        }
        Formula::Among(i, Values::True)
    }
}

/// True if a timer without this second time ends together with its condition.
fn at_once(t2: Option<&Expr>) -> bool {
    t2.is_none_or(|t| matches!(t.kind, ExprKind::Const(Value::Int(0))))
}

/// The values that an atom can have. For a whole number these are the places that hold one.
fn domain(sort: &Sort) -> Vec<usize> {
    match sort {
        Sort::Truth => vec![0, 1],
        Sort::Relation => vec![0, 1, 2],
        Sort::Place(ty, cuts) => {
            let whole = ty.is_integer() || *ty == Type::Time;
            let (least, most) = ty.bounds().map_or((None, None), |(a, b)| (Some(a as f64), Some(b as f64)));
            let at = |k: usize| match cuts.get(k) {
                Some(Cut::Number(x)) => Some(*x),
                _ => None,
            };
            // True if the gap below cut `k` holds a value; a whole-number type needs a whole number there.
            let room = |k: usize| {
                let below = if k == 0 { least.map(|x| x - 1.0) } else { at(k - 1) };
                let above = if k == cuts.len() { most.map(|x| x + 1.0) } else { at(k) };
                below.zip(above).is_none_or(|(a, b)| !whole || b.ceil() - a.floor() >= 2.0)
            };
            let on = |k: usize| {
                at(k).is_none_or(|x| {
                    least.is_none_or(|l| x >= l)
                        && most.is_none_or(|m| x <= m)
                        && (!whole || x.fract() == 0.0)
                })
            };
            (0..=2 * cuts.len()).filter(|p| if p % 2 == 0 { room(p / 2) } else { on(p / 2) }).collect()
        }
    }
}

fn compares(op: BinaryOp) -> bool {
    matches!(op, BinaryOp::Eq | BinaryOp::Ne | BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge)
}

fn of_truths(op: BinaryOp, a: Box<Formula>, b: Box<Formula>) -> Formula {
    let not = |f| Box::new(Formula::Not(f));
    match op {
        BinaryOp::Eq => Formula::Not(Box::new(Formula::Xor(a, b))),
        BinaryOp::Lt => Formula::And(not(a), b),
        BinaryOp::Le => Formula::Or(not(a), b),
        BinaryOp::Gt => Formula::And(a, not(b)),
        BinaryOp::Ge => Formula::Or(a, not(b)),
        _ => Formula::Xor(a, b),
    }
}

fn holds(op: BinaryOp, order: Ordering) -> bool {
    match op {
        BinaryOp::Eq => order.is_eq(),
        BinaryOp::Ne => order.is_ne(),
        BinaryOp::Lt => order.is_lt(),
        BinaryOp::Le => order.is_le(),
        BinaryOp::Gt => order.is_gt(),
        BinaryOp::Ge => order.is_ge(),
        _ => false,
    }
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
fn constant(e: &Expr) -> Option<Cut> {
    match &e.kind {
        ExprKind::Const(Value::Int(n)) if n.unsigned_abs() < 1 << 53 => Some(Cut::Number(*n as f64)),
        ExprKind::Const(Value::Real(x)) if x.is_finite() => Some(Cut::Number(*x)),
        ExprKind::Const(Value::Str(s)) => Some(Cut::Text(s.clone())),
        _ => None,
    }
}
