//! The forms of expressions: values and variables of enumerations, and numbers beside them. `walk` brings each to its
//! place.

use std::collections::{BTreeMap, HashMap};

use g7_model::{
    Arg, BinaryOp, Expr, ExprKind, Name, Path, Problem, Span, StandardFunction, Type, codes, say,
};

use super::table::{Table, Why};
use crate::nodes;
use crate::variables::{Declared, Home, Variables};

/// The kind of an expression, as far as it matters here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A variable of an enumeration, or a choice of its values.
    Of(usize),
    /// A value of an enumeration, and its number.
    Value(usize, i128),
    /// A written number.
    Number(i128),
    /// A whole array whose elements are of an enumeration.
    Array(usize),
    /// A variable of an enumeration that has become numbers.
    Former(usize),
    Other,
}

impl Kind {
    pub(super) fn of(self) -> Option<usize> {
        match self {
            Kind::Of(own) | Kind::Value(own, _) | Kind::Array(own) => Some(own),
            Kind::Number(_) | Kind::Former(_) | Kind::Other => None,
        }
    }

    /// The enumeration of which a value without a type is meant, if it stands beside this expression.
    pub(super) fn hint(self) -> Option<usize> {
        if let Kind::Former(own) = self { Some(own) } else { self.of() }
    }
}

/// The form that the place of an expression asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    /// A value of this enumeration.
    Of(usize),
    /// No value of an enumeration.
    Plain,
    /// The same, where no call can stand: in a declaration or a CASE.
    Written,
}

pub(super) struct Walker<'a> {
    pub(super) table: &'a Table,
    pub(super) variables: &'a Variables,
    /// The enumerations that have become numbers.
    numbers: &'a BTreeMap<usize, (Span, Why)>,
    /// The enumerations that must be numbers too, each with the first place that asks for it.
    pub(super) found: BTreeMap<usize, (Span, Why)>,
    pub(super) problems: Vec<Problem>,
    pub(super) home: Home,
    /// The local variables and parameters, and the result of a function.
    pub(super) locals: HashMap<Box<str>, Declared>,
}

impl<'a> Walker<'a> {
    pub(super) fn new(
        table: &'a Table,
        variables: &'a Variables,
        numbers: &'a BTreeMap<usize, (Span, Why)>,
    ) -> Walker<'a> {
        let (found, problems) = (BTreeMap::new(), Vec::new());
        Walker { table, variables, numbers, found, problems, home: Home::File, locals: HashMap::new() }
    }

    pub(super) fn plain(&mut self, e: &mut Expr) {
        self.expect(e, Wanted::Plain);
    }

    pub(super) fn expect(&mut self, e: &mut Expr, wanted: Wanted) {
        self.expect_near(e, wanted, None);
    }

    /// The same where the enumeration of the place is known. It may have become numbers.
    pub(super) fn expect_near(&mut self, e: &mut Expr, wanted: Wanted, hint: Option<usize>) {
        let hint = if let Wanted::Of(own) = wanted { Some(own) } else { hint };
        let kind = self.typed(e, hint);
        self.agree(e, kind, wanted);
    }

    pub(super) fn wanted(&self, of: Option<usize>, otherwise: Wanted) -> Wanted {
        of.filter(|own| self.is_type(*own)).map_or(otherwise, Wanted::Of)
    }

    /// True if an enumeration stays a type; false if its variables become numbers.
    fn is_type(&self, own: usize) -> bool {
        !self.numbers.contains_key(&own)
    }

    /// Gives an expression the form that its place asks for.
    pub(super) fn agree(&mut self, e: &mut Expr, kind: Kind, wanted: Wanted) {
        let at = e.at.0;
        match (kind, wanted) {
            (Kind::Number(n), Wanted::Of(own)) => {
                match self.table.all.get(own).and_then(|t| Some(t.written(t.numbered(n)?, at))) {
                    Some(value) => *e = value,
                    None => self.no_value(own, at),
                }
            }
            (Kind::Of(a) | Kind::Value(a, _), Wanted::Of(b)) if a == b => {}
            (Kind::Value(_, n), Wanted::Written) => *e = nodes::int(n, at),
            (Kind::Array(a), _) => {
                self.used(Some(a), at);
                if let Wanted::Of(b) = wanted {
                    self.no_value(b, at);
                }
            }
            (Kind::Of(a) | Kind::Value(a, _), _) => {
                self.number(e, a);
                if let Wanted::Of(b) = wanted {
                    self.no_value(b, at);
                }
            }
            (Kind::Other | Kind::Former(_), Wanted::Of(own)) if e.kind != ExprKind::Bad => {
                self.no_value(own, at);
            }
            (Kind::Other | Kind::Former(_) | Kind::Number(_), _) => {}
        }
    }

    /// The call that gives the number of a value: `Mode_TO_INT(m)`.
    fn number(&self, e: &mut Expr, own: usize) {
        let Some(own) = self.table.all.get(own) else { return };
        let at = e.at.0;
        let value = std::mem::replace(e, nodes::bad(at));
        *e = nodes::call(&format!("{}_TO_INT", own.name.text), vec![value], at);
        if own.ty != Type::Int {
            let plain = std::mem::replace(e, nodes::bad(at));
            *e = nodes::call(&format!("INT_TO_{}", own.ty.name()), vec![plain], at);
        }
    }

    /// The kind of an expression; its parts get their forms. `hint` is the enumeration of a value that several have.
    pub(super) fn typed(&mut self, e: &mut Expr, hint: Option<usize>) -> Kind {
        let at = e.at.0;
        if let Some(n) = e.kind.whole() {
            return Kind::Number(n);
        }
        match &mut e.kind {
            ExprKind::Literal(_) | ExprKind::Bad => Kind::Other,
            ExprKind::Direct(text) => {
                let found = self.table.at_address(text);
                self.used(found, at);
                Kind::Other
            }
            ExprKind::Path(path) => {
                let names = path.names.clone();
                self.path(e, &names, hint)
            }
            ExprKind::Element(path, index, bit) => {
                index.iter_mut().for_each(|e| self.plain(e));
                self.element(path, bit.is_some(), at)
            }
            ExprKind::Unary(_, a) => {
                self.plain(a);
                Kind::Other
            }
            ExprKind::Binary(BinaryOp::Eq | BinaryOp::Ne, a, b) => {
                self.same(&mut [&mut **a, &mut **b], None);
                Kind::Other
            }
            ExprKind::Binary(_, a, b) => {
                self.plain(a);
                self.plain(b);
                Kind::Other
            }
            ExprKind::Timer { t1, e, t2 } => {
                self.plain(t1);
                self.plain(e);
                t2.iter_mut().for_each(|t| self.plain(t));
                Kind::Other
            }
            ExprKind::List(values) => {
                values.iter_mut().for_each(|(_, e)| self.plain(e));
                Kind::Other
            }
            ExprKind::Call(path, args) => {
                if let Some(kind) = self.conversion(path, args) {
                    *e = args.pop().map_or_else(|| nodes::bad(at), |a| a.value);
                    return kind;
                }
                self.call(path, args, hint)
            }
        }
    }

    fn path(&mut self, e: &mut Expr, names: &[Name], hint: Option<usize>) -> Kind {
        let at = e.at.0;
        match self.named(names, hint) {
            Some(Ok((own, place))) => {
                let Some((of, value)) = self.table.all.get(own).zip(self.table.value(own, place)) else {
                    return Kind::Other;
                };
                let number = value.number;
                if self.numbers.contains_key(&own) {
                    *e = nodes::name(&[&value.constant], at);
                    return Kind::Number(number);
                }
                *e = of.written(value, at);
                Kind::Value(own, number)
            }
            Some(Err(problem)) => {
                self.problems.push(problem);
                e.kind = ExprKind::Bad;
                Kind::Other
            }
            None => {
                self.bit(names, at);
                self.variable(names)
            }
        }
    }

    /// The value that a path names. Err if there is none, or if it means several.
    fn named(&self, names: &[Name], hint: Option<usize>) -> Option<Result<(usize, usize), Problem>> {
        let [name] = names else { return None };
        if self.is_local(names) {
            return None;
        }
        let at = name.at.0;
        if let Some(found) = self.table.typed(&name.text) {
            return Some(found.map_err(|own| {
                let of = self.table.all.get(own).map_or("", |t| &*t.of);
                let value = name.text.split_once('#').map_or("", |(_, value)| value);
                let what = say!("`{}` has no value `{value}`", of);
                Problem::new(&codes::UNKNOWN_OBJECT, at, what)
            }));
        }
        if self.variables.declared(&self.home, names).is_some() {
            return None;
        }
        let number = |(own, place): &(usize, usize)| self.table.value(*own, *place).map(|v| v.number);
        match self.table.bare(&name.text) {
            [] => None,
            [one] => Some(Ok(*one)),
            several => {
                let wanted = several.iter().find(|(own, _)| Some(*own) == hint);
                // With one number for all of them it does not matter whose value it is.
                let first = several.first().filter(|f| several.iter().all(|s| number(s) == number(f)));
                if let Some(found) = wanted.or(first) {
                    return Some(Ok(*found));
                }
                let of = |n: usize| {
                    several.get(n).and_then(|(own, _)| self.table.all.get(*own)).map_or("", |t| &*t.of)
                };
                let (value, one, other) = (&name.text, of(0), of(1));
                let what = say!("`{value}` is a value of `{one}` and of `{other}`");
                Some(Err(Problem::new(&codes::NOT_CARRIED, at, what)))
            }
        }
    }

    /// True if a local variable or a parameter hides the first name.
    pub(super) fn is_local(&self, names: &[Name]) -> bool {
        names.first().is_some_and(|n| self.locals.contains_key(&n.text))
    }

    pub(super) fn kind(&self, declared: &Declared) -> Kind {
        let of = declared.of.as_deref().and_then(|of| self.table.place(of));
        match of {
            Some(own) if self.numbers.contains_key(&own) => Kind::Former(own),
            Some(own) if declared.array => Kind::Array(own),
            Some(own) => Kind::Of(own),
            None => Kind::Other,
        }
    }

    pub(super) fn variable(&self, names: &[Name]) -> Kind {
        if let Some(local) = names.first().and_then(|n| self.locals.get(&n.text)) {
            return if names.len() == 1 { self.kind(local) } else { Kind::Other };
        }
        self.variables.declared(&self.home, names).map_or(Kind::Other, |d| self.kind(d))
    }

    pub(super) fn element(&mut self, path: &Path, bit: bool, at: Span) -> Kind {
        let own = match self.variable(&path.names) {
            Kind::Array(own) | Kind::Of(own) => own,
            other => return other,
        };
        if bit {
            self.used(Some(own), at);
        }
        Kind::Of(own)
    }

    /// An enumeration becomes numbers if a path names a bit of one of its variables.
    pub(super) fn bit(&mut self, names: &[Name], at: Span) {
        let Some((_, before)) = names.split_last() else { return };
        let found = if before.is_empty() { Kind::Other } else { self.variable(before) };
        self.used(found.of(), at);
    }

    /// Expressions that are all of one enumeration, or all of none.
    fn same(&mut self, list: &mut [&mut Expr], hint: Option<usize>) -> Kind {
        let wanted = hint.or_else(|| list.iter().find_map(|e| self.peek(e)));
        let kinds: Vec<Kind> = list.iter_mut().map(|e| self.typed(e, wanted)).collect();
        let own = wanted.filter(|own| self.is_type(*own) && kinds.iter().all(|k| self.fits(*k, *own)));
        for (e, kind) in list.iter_mut().zip(&kinds) {
            self.agree(e, *kind, own.map_or(Wanted::Plain, Wanted::Of));
        }
        match (own, kinds.as_slice()) {
            (Some(own), _) => Kind::Of(own),
            (None, [Kind::Number(n)]) => Kind::Number(*n),
            (None, _) => Kind::Other,
        }
    }

    /// True for a value of an enumeration, or a number that one of its values has.
    pub(super) fn fits(&self, kind: Kind, own: usize) -> bool {
        match kind {
            Kind::Of(of) | Kind::Value(of, _) => of == own,
            Kind::Number(n) => self.table.all.get(own).is_some_and(|t| t.numbered(n).is_some()),
            Kind::Array(_) | Kind::Former(_) | Kind::Other => false,
        }
    }

    /// The enumeration of an expression that can be of one only.
    fn peek(&self, e: &Expr) -> Option<usize> {
        match &e.kind {
            ExprKind::Path(path) => match self.named(&path.names, None) {
                Some(Ok((own, _))) if self.table.bare(&path.text()).len() < 2 => Some(own),
                Some(_) => None,
                None => self.variable(&path.names).hint(),
            },
            ExprKind::Element(path, _, None) => self.variable(&path.names).hint(),
            ExprKind::Call(_, args) if choice(e).is_some() => args.iter().find_map(|a| self.peek(&a.value)),
            ExprKind::Call(path, _) => self.kind(&self.variables.function(path)?.result).hint(),
            _ => None,
        }
    }

    /// `Mode_TO_INT(m)` in the file becomes `m`, whose place asks for the number. None for any other call.
    fn conversion(&mut self, path: &Path, args: &mut [Arg]) -> Option<Kind> {
        let ([name], [only]) = (path.names.as_slice(), args) else { return None };
        let own = self.table.conversion(&name.text)?;
        let kind = self.typed(&mut only.value, Some(own));
        self.agree(&mut only.value, kind, Wanted::Plain);
        Some(if let Kind::Number(n) = kind { Kind::Number(n) } else { Kind::Other })
    }

    fn call(&mut self, path: &Path, args: &mut [Arg], hint: Option<usize>) -> Kind {
        use StandardFunction as F;
        if let Some(function) = self.variables.function(path) {
            for (place, arg) in args.iter_mut().enumerate() {
                let wanted = function.parameter(arg, place).map_or(Kind::Other, |p| self.kind(p));
                self.given(&mut arg.value, wanted);
            }
            return self.kind(&function.result);
        }
        let function = match path.names.as_slice() {
            [name] => F::named(&name.text),
            _ => None,
        };
        match function {
            Some(f @ (F::Move | F::Operator(BinaryOp::Eq | BinaryOp::Ne))) => {
                let hint = hint.filter(|_| f == F::Move);
                let mut list: Vec<&mut Expr> = args.iter_mut().map(|a| &mut a.value).collect();
                let kind = self.same(&mut list, hint);
                if f == F::Move { kind } else { Kind::Other }
            }
            Some(f @ (F::Sel | F::Mux)) => {
                // The first input chooses among the others; with names it can stand anywhere.
                let chooses = |a: &Arg| a.name.as_ref().is_some_and(|n| f.row().place(&n.text) == Some(0));
                let first = args.iter().position(chooses).unwrap_or(0);
                args.get_mut(first).into_iter().for_each(|a| self.plain(&mut a.value));
                let others = args.iter_mut().enumerate().filter(|(n, _)| *n != first);
                let mut list: Vec<&mut Expr> = others.map(|(_, a)| &mut a.value).collect();
                self.same(&mut list, hint)
            }
            _ => {
                args.iter_mut().for_each(|a| self.plain(&mut a.value));
                Kind::Other
            }
        }
    }

    // Enumerations that become numbers

    fn no_value(&mut self, own: usize, at: Span) {
        self.refuse(own, at, Why::Value);
    }

    pub(super) fn used(&mut self, own: Option<usize>, at: Span) {
        own.into_iter().for_each(|own| self.refuse(own, at, Why::Used));
    }

    fn refuse(&mut self, own: usize, at: Span, why: Why) {
        if !self.numbers.contains_key(&own) {
            self.found.entry(own).or_insert((at, why));
        }
    }
}

/// MOVE, SEL or MUX, if a call names one of these: their result is one of their inputs.
fn choice(e: &Expr) -> Option<StandardFunction> {
    use StandardFunction as F;
    let ExprKind::Call(path, _) = &e.kind else { return None };
    let [name] = path.names.as_slice() else { return None };
    F::named(&name.text).filter(|f| matches!(f, F::Move | F::Sel | F::Mux))
}
