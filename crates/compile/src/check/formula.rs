//! Formulas over atoms: the form of a question between its expressions (`solve`) and its clauses
//! (`clauses`).

use std::cmp::Ordering;

use g7_model::Type;

use crate::ir::{BinaryOp, Expr};

/// A row of the parts of a question.
#[derive(Clone, Copy)]
pub(super) struct Part(pub(super) usize);

/// A formula over atoms, which are rows of the atoms of a question.
pub(super) enum Formula<'e> {
    Const(bool),
    /// The atom has one of the values in this mask.
    Among(usize, Values<'e>),
    Not(Part),
    And(Part, Part),
    Or(Part, Part),
    Xor(Part, Part),
    /// At most one of these atoms is true. It stands for itself, not within another formula.
    OneOf(Vec<usize>),
}

/// The values of an atom that make a comparison true.
#[derive(Clone, Copy)]
pub(super) enum Values<'e> {
    /// It is true (1).
    True,
    /// The number compares in this way with one of its cuts.
    Side(BinaryOp, Cut<'e>),
    /// The two numbers compare in this way.
    Order(BinaryOp),
}

/// A constant that a value is compared with.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Cut<'e> {
    Number(f64),
    Text(&'e str),
}

impl Cut<'_> {
    pub(super) fn order(&self, other: &Cut<'_>) -> Ordering {
        match (self, other) {
            (Cut::Number(a), Cut::Number(b)) => a.total_cmp(b),
            (Cut::Text(a), Cut::Text(b)) => a.cmp(b),
            (Cut::Number(_), Cut::Text(_)) => Ordering::Less,
            (Cut::Text(_), Cut::Number(_)) => Ordering::Greater,
        }
    }
}

pub(super) enum Sort<'e> {
    /// False or true.
    Truth,
    /// The place of a value among the sorted cuts: 2k below cut k, 2k+1 on it.
    Place(Type, Vec<Cut<'e>>),
    /// Less, equal, greater than this value.
    Relation(&'e Expr),
}

pub(super) struct Atom<'e> {
    pub(super) sort: Sort<'e>,
    pub(super) of: &'e Expr,
}

/// True if some value of a type has this place among the cuts.
#[inline(never)]
pub(super) fn is_taken(ty: Type, cuts: &[Cut<'_>], place: usize) -> bool {
    let whole = ty.is_integer() || ty.stored() == Type::Time;
    let (least, most) = ty.bounds().map_or((None, None), |(a, b)| (Some(a as f64), Some(b as f64)));
    let at = |k: usize| match cuts.get(k) {
        Some(Cut::Number(x)) => Some(*x),
        _ => None,
    };
    let k = place / 2;
    if place % 2 == 1 {
        return at(k).is_none_or(|x| {
            least.is_none_or(|l| x >= l) && most.is_none_or(|m| x <= m) && (!whole || x.fract() == 0.0)
        });
    }
    // The gap below cut `k`; a whole-number type needs a whole number there.
    let below = if k == 0 { least.map(|x| x - 1.0) } else { at(k - 1) };
    let above = if k == cuts.len() { most.map(|x| x + 1.0) } else { at(k) };
    below.zip(above).is_none_or(|(a, b)| !whole || b.ceil() - a.floor() >= 2.0)
}

pub(super) fn holds(op: BinaryOp, order: Ordering) -> bool {
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
