//! OR divergences whose branches can be true together.
//!
//! Under multi-token rules such a divergence starts both branches. Most authors
//! mean one: so `check` asks for receptivities that exclude each other, which it
//! proves over the values of their parts, taking nothing else to be known.

use std::collections::{BTreeMap, HashMap};

use g7_model::{Problem, codes};

use super::tree::{key, operands};
use crate::ir::{BinaryOp, Expr, ExprKind, StepId, Unit, Value};

/// Most combinations of values that are tried for one pair.
const TRIES: usize = 1 << 14;

pub(super) fn check(unit: &Unit, problems: &mut Vec<Problem>) {
    if !unit.rules.multi_token {
        for t in unit.transitions.iter().filter(|t| t.priority == Some(0)) {
            problems.push(Problem::new(&codes::PRIORITY_IGNORED, t.at, "priorities begin at 1"));
        }
        return;
    }
    let mut by_step: BTreeMap<StepId, Vec<usize>> = BTreeMap::new();
    for (i, t) in unit.transitions.iter().enumerate() {
        for from in &t.from {
            by_step.entry(*from).or_default().push(i);
        }
        if t.priority.is_some() && !unit.rules.numbered_exclusive {
            problems.push(
                Problem::new(
                    &codes::PRIORITY_IGNORED,
                    t.at,
                    "this priority has no effect: all branches that are true clear",
                )
                .help("choose `single-token` for the profile, or make the receptivities exclude each other"),
            );
        }
    }
    let mut told = std::collections::BTreeSet::new();
    for list in by_step.values().filter(|l| l.len() > 1) {
        for (k, a) in list.iter().enumerate() {
            for b in list.get(k + 1..).unwrap_or(&[]) {
                if told.insert((*a, *b)) {
                    pair(unit, *a, *b, problems);
                }
            }
        }
    }
}

fn pair(unit: &Unit, a: usize, b: usize, problems: &mut Vec<Problem>) {
    let (Some(a), Some(b)) = (unit.transitions.get(a), unit.transitions.get(b)) else { return };
    let numbered = a.priority.is_some() && b.priority.is_some();
    if unit.rules.numbered_exclusive && numbered || exclude(&a.receptivity, &b.receptivity) {
        return;
    }
    let shared = a.from.iter().find(|f| b.from.contains(f)).and_then(|f| unit.steps.get(f.index()));
    let name = shared.map_or("", |s| &*s.name);
    problems.push(
        Problem::new(&codes::CONFLICT, b.receptivity.at, format!("two branches behind step `{name}` can be true together, and then both clear"))
            .related(a.receptivity.at, "can be true at the same time")
            .help("make the receptivities exclude each other (`a and not b`), or give a priority by `single-token`, or start both branches with one transition `1 -> (2, 3)` if both are meant"),
    );
}

/// What an expression is made of, as far as the proof looks into it.
enum Atom {
    /// True or false.
    Truth,
    /// A number, as the intervals that the constants it is compared with cut.
    Number(Vec<f64>),
    /// How two numbers compare: less, equal, greater.
    Relation,
}

#[derive(Default)]
struct Atoms<'e> {
    index: HashMap<String, usize>,
    list: Vec<Atom>,
    /// Edges seen: atom, operand, whether rising.
    edges: Vec<(usize, &'e Expr, bool)>,
    /// Timers without a second time: atom and condition.
    timers: Vec<(usize, &'e Expr)>,
}

/// Whether two receptivities are never true together, whatever their parts are.
/// False where that is not so, or too much to try.
pub(super) fn exclude(a: &Expr, b: &Expr) -> bool {
    let mut atoms = Atoms::default();
    atoms.gather(a);
    atoms.gather(b);
    let sizes: Vec<usize> = atoms
        .list
        .iter()
        .map(|atom| match atom {
            Atom::Truth => 2,
            Atom::Relation => 3,
            Atom::Number(cuts) => 2 * cuts.len() + 1,
        })
        .collect();
    let total = sizes.iter().try_fold(1usize, |n, s| n.checked_mul(*s)).filter(|n| *n <= TRIES);
    let Some(total) = total else { return false };
    (0..total).all(|mut k| {
        let values: Vec<usize> = sizes
            .iter()
            .map(|s| {
                let v = k % s;
                k /= s;
                v
            })
            .collect();
        !(atoms.possible(&values) && atoms.truth(a, &values) && atoms.truth(b, &values))
    })
}

impl<'e> Atoms<'e> {
    fn add(&mut self, key: String, atom: Atom) -> usize {
        if let Some(i) = self.index.get(&key) {
            return *i;
        }
        self.index.insert(key, self.list.len());
        self.list.push(atom);
        self.list.len() - 1
    }

    fn gather(&mut self, e: &'e Expr) {
        match &e.kind {
            ExprKind::Const(_) => {}
            ExprKind::Not(_) => operands(e).into_iter().for_each(|o| self.gather(o)),
            ExprKind::Binary(BinaryOp::And | BinaryOp::Or | BinaryOp::Xor, ..) => {
                operands(e).into_iter().for_each(|o| self.gather(o));
            }
            ExprKind::Binary(op, a, b) if compares(*op) && a.ty == g7_model::Type::Bool => {
                self.gather(a);
                self.gather(b);
            }
            ExprKind::Binary(op, a, b) if compares(*op) => match (number(a), number(b)) {
                (None, Some(cut)) => self.cut(a, cut),
                (Some(cut), None) => self.cut(b, cut),
                _ => {
                    self.add(format!("{}?{}", key(a), key(b)), Atom::Relation);
                }
            },
            ExprKind::Rise(x) | ExprKind::Fall(x) => {
                let i = self.add(key(e), Atom::Truth);
                self.edges.push((i, x, matches!(e.kind, ExprKind::Rise(_))));
                self.gather(x);
            }
            ExprKind::Timer { e: x, t2, .. } => {
                let i = self.add(key(e), Atom::Truth);
                if t2.is_none() {
                    self.timers.push((i, x));
                    self.gather(x);
                }
            }
            _ => {
                self.add(key(e), Atom::Truth);
            }
        }
    }

    fn cut(&mut self, e: &Expr, at: f64) {
        let i = self.add(format!("{}#", key(e)), Atom::Number(Vec::new()));
        if let Some(Atom::Number(cuts)) = self.list.get_mut(i)
            && !cuts.contains(&at)
        {
            cuts.push(at);
            cuts.sort_by(f64::total_cmp);
        }
    }

    /// An edge up needs its operand true now, an edge down false; a timer its condition.
    fn possible(&self, values: &[usize]) -> bool {
        let on = |i: &usize| values.get(*i) == Some(&1);
        self.edges.iter().all(|(i, x, up)| !on(i) || self.truth(x, values) == *up)
            && self.timers.iter().all(|(i, x)| !on(i) || self.truth(x, values))
    }

    fn value(&self, key: &str, values: &[usize]) -> usize {
        self.index.get(key).and_then(|i| values.get(*i)).copied().unwrap_or(0)
    }

    fn truth(&self, e: &Expr, values: &[usize]) -> bool {
        match &e.kind {
            ExprKind::Const(Value::Bool(v)) => *v,
            ExprKind::Not(a) => !self.truth(a, values),
            ExprKind::Binary(BinaryOp::And, a, b) => self.truth(a, values) && self.truth(b, values),
            ExprKind::Binary(BinaryOp::Or, a, b) => self.truth(a, values) || self.truth(b, values),
            ExprKind::Binary(BinaryOp::Xor, a, b) => self.truth(a, values) != self.truth(b, values),
            ExprKind::Binary(op, a, b) if compares(*op) && a.ty == g7_model::Type::Bool => {
                holds(*op, self.truth(a, values).cmp(&self.truth(b, values)))
            }
            ExprKind::Binary(op, a, b) if compares(*op) => match (number(a), number(b)) {
                (None, Some(cut)) => holds(*op, self.side(a, cut, values)),
                (Some(cut), None) => holds(*op, self.side(b, cut, values).reverse()),
                _ => {
                    let order =
                        [std::cmp::Ordering::Less, std::cmp::Ordering::Equal, std::cmp::Ordering::Greater];
                    let k = self.value(&format!("{}?{}", key(a), key(b)), values);
                    order.get(k).is_some_and(|o| holds(*op, *o))
                }
            },
            _ => self.value(&key(e), values) == 1,
        }
    }

    /// How the number stands to one of its cuts: interval 2k lies below cut k, 2k+1 on it.
    fn side(&self, e: &Expr, cut: f64, values: &[usize]) -> std::cmp::Ordering {
        let name = format!("{}#", key(e));
        let place = self.index.get(&name).and_then(|i| self.list.get(*i));
        let Some(Atom::Number(cuts)) = place else { return std::cmp::Ordering::Equal };
        let k = cuts.iter().position(|c| *c == cut).unwrap_or(0);
        self.value(&name, values).cmp(&(2 * k + 1))
    }
}

fn compares(op: BinaryOp) -> bool {
    matches!(op, BinaryOp::Eq | BinaryOp::Ne | BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge)
}

fn holds(op: BinaryOp, order: std::cmp::Ordering) -> bool {
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

/// A constant number. Beyond 2^53 neighbours fall together; then two cuts become
/// one, and what is proved exclusive might not be: such constants are left alone.
fn number(e: &Expr) -> Option<f64> {
    match &e.kind {
        ExprKind::Const(Value::Int(n)) if n.unsigned_abs() < 1 << 53 => Some(*n as f64),
        ExprKind::Const(Value::Real(x)) if x.is_finite() => Some(*x),
        _ => None,
    }
}
