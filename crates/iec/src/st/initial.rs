//! Initial values, and declarations with them.

use g7_model::codes;
use g7_model::{Arg, Array, Expr, ExprKind, Limits, Name, Path, Place, Problem, Type, VarDecl, VarKind, say};

use super::lex::Kind;
use super::parse::Parser;
use super::shape::Shape;

impl Parser<'_> {
    /// Reads the whole text as an initial value.
    pub(crate) fn whole_initial(mut self) -> Initial {
        let value = self.initial();
        self.expect_end();
        value
    }

    /// Reads an initial value.
    pub(crate) fn initial(&mut self) -> Initial {
        let start = self.token().start;
        if self.at("[") {
            return self.array_value(start, "[", "]");
        }
        let named = self.at("(") && self.ahead(1).kind == Kind::Word && self.ahead_is(2, ":=");
        if named {
            return self.struct_value();
        }
        Initial::One(self.expr())
    }

    /// `[1, 2, 3(0)]`.
    fn array_value(&mut self, start: u32, open: &str, close: &str) -> Initial {
        let mut list = Vec::new();
        if !self.enter() {
            return Initial::One(self.bad(start));
        }
        self.expect(open);
        while !self.at_end() && !self.at(close) {
            let token = self.token();
            let times = self.slice(token).parse::<u32>().ok();
            if let Some(times) = times.filter(|_| token.kind == Kind::Number && self.ahead_is(1, "(")) {
                self.bump();
                // The values of a structure have brackets of their own, or these.
                let fields = self.ahead(1).kind == Kind::Word && self.ahead_is(2, ":=");
                if fields {
                    list.push((times, self.struct_value()));
                } else {
                    self.bump();
                    list.push((times, self.initial()));
                    self.expect(")");
                }
            } else {
                list.push((1, self.initial()));
            }
            if !self.eat(",") || list.len() > 10_000 {
                break;
            }
        }
        self.expect(close);
        self.leave();
        Initial::List(list)
    }

    /// `(a := 1, b := 2)`.
    fn struct_value(&mut self) -> Initial {
        let mut fields = Vec::new();
        if !self.enter() {
            return Initial::Fields(fields);
        }
        self.bump();
        while let Some(name) = self.name(say!("the name of an element")) {
            self.expect(":=");
            fields.push((name, self.initial()));
            if !self.eat(",") {
                break;
            }
        }
        self.expect(")");
        self.leave();
        Initial::Fields(fields)
    }
}

/// An initial value as written.
#[derive(Clone, Debug)]
pub(crate) enum Initial {
    One(Expr),
    /// Values, each with the number of its repetitions.
    List(Vec<(u32, Initial)>),
    Fields(Vec<(Name, Initial)>),
}

impl Initial {
    /// The value of one variable; None if it is a list.
    fn one(&self, at: Place) -> Option<Expr> {
        match self {
            Initial::One(e) => Some(e.clone()),
            Initial::List(_) => None,
            Initial::Fields(fields) => {
                let field = |(name, value): &(Name, Initial)| {
                    let value = value.one(at).unwrap_or_else(|| value.list(at));
                    Arg::input(Some(name.clone()), value)
                };
                let args = fields.iter().map(field).collect();
                Some(Expr { kind: ExprKind::Call(Path { names: Vec::new() }, args), at })
            }
        }
    }

    /// The values of an array.
    fn list(&self, at: Place) -> Expr {
        let mut values = Vec::new();
        self.elements(1, at, &mut values);
        Expr { kind: ExprKind::List(values), at }
    }

    /// The values of rows stand one behind the other.
    fn elements(&self, times: u32, at: Place, into: &mut Vec<(u32, Expr)>) {
        let Initial::List(list) = self else {
            return into.extend(self.one(at).map(|e| (times, e)));
        };
        let mut row = Vec::new();
        list.iter().for_each(|(n, value)| value.elements(*n, at, &mut row));
        repeat(&row, times, into);
    }
}

/// The most values of an array that are listed: more than an array can have elements.
const MOST_VALUES: usize = 1 << 16;

/// Appends the values of a row as often as it is repeated. A list that is longer than any array ends.
pub(crate) fn repeat(row: &[(u32, Expr)], times: u32, into: &mut Vec<(u32, Expr)>) {
    if let [(n, value)] = row {
        return into.push((n.saturating_mul(times), value.clone()));
    }
    for _ in 0..times {
        if row.is_empty() || into.len() > MOST_VALUES {
            return;
        }
        into.extend_from_slice(row);
    }
}

impl Shape {
    /// The type with an initial value; the type alone if it cannot have this one.
    pub(crate) fn starting_with(self, init: Initial) -> Result<Shape, Shape> {
        match (self, init) {
            (Shape::Simple(ty, _), Initial::One(init)) => Ok(Shape::Simple(ty, Some(init))),
            (Shape::Range(ty, limits, _), Initial::One(init)) => Ok(Shape::Range(ty, limits, Some(init))),
            (Shape::Enum(own, _), Initial::One(init)) => {
                let init = own.initial(init);
                Ok(Shape::Enum(own, Some(init)))
            }
            (other, _) => Err(other),
        }
    }
}

/// The declaration of a variable or member with its type and value.
pub(crate) fn declared(
    name: &Name,
    shape: &Shape,
    init: Option<&Initial>,
    at: Place,
) -> (VarDecl, Option<Problem>) {
    let dimensions = if let Shape::Array(bounds, _) = shape { Some(bounds) } else { None };
    let (ty, of, default) = match shape.element() {
        Shape::Simple(ty, default) | Shape::Range(ty, _, default) => (*ty, None, default.clone()),
        Shape::Enum(own, default) => {
            // An array without a list starts with zeros, so a first value of 0 needs no list.
            let first = own.first().filter(|_| dimensions.is_none() || own.least != Some(0));
            (own.ty, None, default.clone().or(first))
        }
        Shape::Struct(of) | Shape::Unknown(of) => (Type::Bool, Some(Box::new(of.clone())), None),
        Shape::Array(..) => (Type::Bool, None, None),
    };
    let array = dimensions.map(|d| Box::new(Array { dimensions: d.clone(), at }));
    let mut problem = None;
    let value = match (init, dimensions) {
        (None, None) => default,
        (None, Some(bounds)) => default.and_then(|e| all(bounds, &e, at)),
        (Some(Initial::One(e)), None) if e.kind == ExprKind::Bad => default,
        (Some(given), None) => given.one(at),
        (Some(given @ Initial::List(_)), Some(bounds)) => Some(filled(given.list(at), bounds, default)),
        // Tools differ in what one value means for an array.
        (Some(_), Some(_)) => None,
    };
    let value = match shape.element() {
        Shape::Enum(own, _) => value.map(|e| own.initial(e)),
        _ => value,
    };
    let bad = matches!(init, Some(Initial::One(e)) if e.kind == ExprKind::Bad);
    if init.is_some() && value.is_none() && !bad {
        let what =
            say!("the initial values of `{}` do not fit its type, or cannot be carried over", name.text);
        problem = Some(Problem::new(&codes::NOT_CARRIED, at.0, what));
    }
    let limits = match shape.element() {
        Shape::Range(_, limits, _) => Some(Box::new(Limits::Range(limits.0.clone(), limits.1.clone()))),
        Shape::Enum(own, _) => Some(Box::new(Limits::Of(own.name.clone()))),
        _ => None,
    };
    let names = vec![name.clone()];
    let decl = VarDecl { array, of, limits, init: value, ..VarDecl::new(VarKind::Var, names, ty, at) };
    (decl, problem)
}

/// The number of elements of an array whose bounds are written as numbers.
fn count(bounds: &[(Expr, Expr)]) -> Option<u32> {
    bounds.iter().try_fold(1_u32, |count, (low, high)| {
        let length = high.kind.whole()?.checked_sub(low.kind.whole()?)?.checked_add(1)?;
        count.checked_mul(u32::try_from(length).ok()?)
    })
}

/// One value for all elements of an array.
fn all(bounds: &[(Expr, Expr)], e: &Expr, at: Place) -> Option<Expr> {
    Some(Expr { kind: ExprKind::List(vec![(count(bounds)?, e.clone())]), at })
}

/// A list with the value of the elements' type for those that it leaves out.
fn filled(mut list: Expr, bounds: &[(Expr, Expr)], default: Option<Expr>) -> Expr {
    if let (ExprKind::List(values), Some(default), Some(count)) = (&mut list.kind, default, count(bounds)) {
        let given = values.iter().fold(0_u32, |sum, (times, _)| sum.saturating_add(*times));
        values.extend(count.checked_sub(given).filter(|rest| *rest > 0).map(|rest| (rest, default)));
    }
    list
}
