//! Expressions as written: receptivities, conditions, right-hand sides.

use crate::{BinaryOp, Moment, Name, Nanos, Place, Type, UnaryOp, slot_of};

/// An expression with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expr {
    /// Its kind.
    pub kind: ExprKind,
    /// Where it stands.
    pub at: Place,
}

/// The forms of an expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExprKind {
    /// A constant.
    Literal(Literal),
    /// A name, resolved by `compile`: `a`, `X12`, `Fill.T`, `Chart.v`, `c.Q`.
    Path(Path),
    /// `%I0.1`, `%X12.T`: without the `%`, upper case.
    Direct(Box<str>),
    /// `not e`, `-e`, `↑e`, `↓e`.
    Unary(UnaryOp, Box<Expr>),
    /// `a op b`.
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `t1/e/t2` (IEC 60848:2013, 4.8): true once `e` has been true for `t1`,
    /// until it has been false for `t2` (0 when absent).
    Timer {
        /// The delay after which it comes true.
        t1: Box<Expr>,
        /// The condition watched.
        e: Box<Expr>,
        /// The delay after which it ends.
        t2: Option<Box<Expr>>,
    },
    /// `f(x, n := y)`. Without a name, the initial value of a structure: `(speed := 2.0)`.
    Call(Path, Vec<Arg>),
    /// An element of an array, or a bit of one: `a[i]`, `Chart.a[i, j]`, `w[i].3`. In the path of a member, `[]` or `[,]`
    /// stands for the indexes that are not at its end: `m[i].t[j].x` is `m[].t[].x` with `i` and `j`.
    Element(Box<Path>, Vec<Expr>, Option<Box<Name>>),
    /// `[1, 2, 4(0)]`, the values of an array, each with its number of repetitions.
    List(Vec<(u32, Expr)>),
    /// Text that could not be read; a problem has been reported.
    Bad,
}

/// A constant as written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Literal {
    /// `TRUE` or `FALSE`.
    Bool(bool),
    /// A whole number, with the type written before `#`, if any.
    Int(i128, Option<Type>),
    /// A number with a point or exponent, kept as written (without `_`).
    Real(Box<str>, Option<Type>),
    /// A duration.
    Time(Nanos),
    /// A date, a time of day, or a date with a time.
    Moment(Moment, Nanos),
    /// Text, escapes undone.
    Str(Box<str>),
}

/// Names joined by dots; at least one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Path {
    /// The names.
    pub names: Vec<Name>,
}

/// An argument of a call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arg {
    /// `n := …` or `n => …`.
    pub name: Option<Name>,
    /// True for an output, `n => v`; then `value` is a path.
    pub output: bool,
    /// True for a variable that the called function block can change. Only [`crate::composed`] knows and sets it.
    pub inout: bool,
    /// The value.
    pub value: Expr,
}

impl Arg {
    /// `value`, or `name := value`.
    pub fn input(name: Option<Name>, value: Expr) -> Arg {
        Arg { name, output: false, inout: false, value }
    }

    /// True if the call gives a variable a value by this argument.
    pub fn writes(&self) -> bool {
        self.output || self.inout
    }
}

impl Expr {
    /// The value that a variable of the type has without one of its own: FALSE, 0, or the empty text.
    pub fn zero(ty: Type, at: Place) -> Expr {
        let literal = match ty {
            Type::Bool | Type::Fb(_) => Literal::Bool(false),
            Type::Real | Type::Lreal => Literal::Real("0.0".into(), None),
            Type::Time => Literal::Time(Nanos::ZERO),
            Type::Moment(moment) => Literal::Moment(moment, Nanos::ZERO),
            Type::String(_) => Literal::Str("".into()),
            _ => Literal::Int(0, None),
        };
        Expr { kind: ExprKind::Literal(literal), at }
    }

    /// True if no part of it is text that could not be read.
    pub fn is_read(&self) -> bool {
        match &self.kind {
            ExprKind::Bad => false,
            ExprKind::Literal(_) | ExprKind::Path(_) | ExprKind::Direct(_) => true,
            ExprKind::Unary(_, e) => e.is_read(),
            ExprKind::Binary(_, a, b) => a.is_read() && b.is_read(),
            ExprKind::Timer { t1, e, t2 } => {
                t1.is_read() && e.is_read() && t2.as_ref().is_none_or(|t| t.is_read())
            }
            ExprKind::Call(_, args) => args.iter().all(|a| a.value.is_read()),
            ExprKind::Element(_, index, _) => index.iter().all(Expr::is_read),
            ExprKind::List(values) => values.iter().all(|(_, e)| e.is_read()),
        }
    }
}

impl ExprKind {
    /// The name of the variable that it is, as other tools see it: `Chart.v`, or `a[1,2]` where the indexes are
    /// written numbers.
    pub fn variable(&self) -> Option<String> {
        match self {
            ExprKind::Path(path) => Some(path.text()),
            ExprKind::Element(path, index, None) => {
                let index: Option<Vec<String>> =
                    index.iter().map(|e| e.kind.whole().map(|n| n.to_string())).collect();
                Some(element_name(&path.text(), &index?))
            }
            _ => None,
        }
    }

    /// The number, if it is a whole one as written, with its sign.
    pub fn whole(&self) -> Option<i128> {
        match self {
            ExprKind::Literal(Literal::Int(n, _)) => Some(*n),
            ExprKind::Unary(UnaryOp::Neg, inner) => match inner.kind {
                ExprKind::Literal(Literal::Int(n, _)) => n.checked_neg(),
                _ => None,
            },
            _ => None,
        }
    }
}

/// An element as it is written: names, and the indexes behind them; behind the last names there may be none. The names
/// of [`ExprKind::Element`] without the signs for their indexes.
pub fn element_parts<'e>(path: &Path, index: &'e [Expr]) -> Vec<(Path, &'e [Expr])> {
    let (mut parts, mut names, mut rest) = (Vec::new(), Vec::new(), index);
    let last = path.names.len().saturating_sub(1);
    for (n, name) in path.names.iter().enumerate() {
        let slot = slot_of(&name.text).filter(|(_, count)| n < last && *count <= rest.len());
        let Some((bare, count)) = slot else {
            names.push(name.clone());
            continue;
        };
        names.push(Name { text: bare.into(), at: name.at });
        let (own, behind) = rest.split_at(count);
        parts.push((Path { names: std::mem::take(&mut names) }, own));
        rest = behind;
    }
    parts.push((Path { names }, rest));
    parts
}

/// The name of an element as all of G7 has it: `a[1,2]`, and `m[3].t[0]` for the element 3, 0 of `m[].t`.
pub fn element_name(array: &str, index: &[String]) -> String {
    let (name, used) = filled(array, index);
    match index.get(used..) {
        None | Some([]) => name,
        Some(rest) => format!("{name}[{}]", rest.join(",")),
    }
}

/// Writes indexes into the places that a name has for them: `m[3].x` for `m[].x`. The number tells how many were used.
pub fn filled(name: &str, index: &[String]) -> (String, usize) {
    let (mut full, mut taken) = (String::new(), 0);
    let mut rest = name;
    while let Some((before, behind)) = rest.split_once('[') {
        let slot = behind.split_once(']').filter(|(commas, _)| commas.bytes().all(|b| b == b','));
        let Some((commas, after)) = slot.filter(|(commas, _)| taken + commas.len() < index.len()) else {
            full.push_str(&format!("{before}["));
            rest = behind;
            continue;
        };
        let numbers = index.get(taken..=taken + commas.len()).unwrap_or_default();
        full.push_str(&format!("{before}[{}]", numbers.join(",")));
        taken += numbers.len();
        rest = after;
    }
    full.push_str(rest);
    (full, taken)
}

impl Path {
    /// The names joined by dots, as in messages.
    pub fn text(&self) -> String {
        self.names.iter().map(|n| &*n.text).collect::<Vec<_>>().join(".")
    }
}
