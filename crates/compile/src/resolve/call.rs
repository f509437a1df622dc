//! Calls in expressions: functions of the document, standard functions, conversions.

use g7_engine::Builtin;
use g7_model::{Arg, Name, Nanos, Path, Problem, Span, Type, codes};

use super::constant;
use super::resolver::{Resolver, Role, nearest};
use super::scopes::Entity;
use super::types::{Typed, common, converted};
use crate::ir::{BinaryOp, Expr, ExprKind, FunctionId, Value};

/// Nanoseconds of the unit in which TIME is converted to numbers.
const MILLISECOND: i128 = Nanos::MILLISECOND.count() as i128;

/// How the arguments of a standard function are typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    /// One number or TIME; the result is of its type.
    Number,
    /// One REAL or LREAL; the result is of its type.
    Real,
    /// Two or more values that can be ordered; the result is of their common type.
    Ordered,
    /// LIMIT: three of one type.
    Limit,
    /// SEL: a BOOL, then two of one type.
    Select,
    /// MUX: a whole number, then any number of one type.
    Multiplex,
    /// Any value: MOVE.
    Any,
    /// TRUNC.
    Truncate,
    /// Texts, then whole numbers; the result is a text.
    Text(u8),
    /// Texts; the result is an INT.
    Measure,
}

/// A standard function: its name, what it is in the tables, its shape, the
/// names of its inputs (the last one repeats where it ends in `…`).
struct Standard(&'static str, Option<Builtin>, Shape, &'static [&'static str]);

/// IEC 61131-3:2003, 2.5.1.5.
const STANDARD: &[Standard] = &[
    Standard("ABS", Some(Builtin::Abs), Shape::Number, &["IN"]),
    Standard("SQRT", Some(Builtin::Sqrt), Shape::Real, &["IN"]),
    Standard("LN", Some(Builtin::Ln), Shape::Real, &["IN"]),
    Standard("LOG", Some(Builtin::Log), Shape::Real, &["IN"]),
    Standard("EXP", Some(Builtin::Exp), Shape::Real, &["IN"]),
    Standard("SIN", Some(Builtin::Sin), Shape::Real, &["IN"]),
    Standard("COS", Some(Builtin::Cos), Shape::Real, &["IN"]),
    Standard("TAN", Some(Builtin::Tan), Shape::Real, &["IN"]),
    Standard("ASIN", Some(Builtin::Asin), Shape::Real, &["IN"]),
    Standard("ACOS", Some(Builtin::Acos), Shape::Real, &["IN"]),
    Standard("ATAN", Some(Builtin::Atan), Shape::Real, &["IN"]),
    Standard("MIN", Some(Builtin::Min), Shape::Ordered, &["IN1", "IN2", "…"]),
    Standard("MAX", Some(Builtin::Max), Shape::Ordered, &["IN1", "IN2", "…"]),
    Standard("LIMIT", Some(Builtin::Limit), Shape::Limit, &["MN", "IN", "MX"]),
    Standard("SEL", Some(Builtin::Sel), Shape::Select, &["G", "IN0", "IN1"]),
    Standard("MUX", Some(Builtin::Mux), Shape::Multiplex, &["K", "IN0", "IN1", "…"]),
    Standard("MOVE", None, Shape::Any, &["IN"]),
    Standard("TRUNC", None, Shape::Truncate, &["IN"]),
    Standard("LEN", Some(Builtin::Len), Shape::Measure, &["IN"]),
    Standard("FIND", Some(Builtin::Find), Shape::Measure, &["IN1", "IN2"]),
    Standard("LEFT", Some(Builtin::Left), Shape::Text(1), &["IN", "L"]),
    Standard("RIGHT", Some(Builtin::Right), Shape::Text(1), &["IN", "L"]),
    Standard("MID", Some(Builtin::Mid), Shape::Text(1), &["IN", "L", "P"]),
    Standard("CONCAT", Some(Builtin::Concat), Shape::Text(2), &["IN1", "IN2", "…"]),
    Standard("INSERT", Some(Builtin::Insert), Shape::Text(2), &["IN1", "IN2", "P"]),
    Standard("DELETE", Some(Builtin::Delete), Shape::Text(1), &["IN", "L", "P"]),
    Standard("REPLACE", Some(Builtin::Replace), Shape::Text(2), &["IN1", "IN2", "L", "P"]),
];

/// Most arguments of MIN, MAX, MUX and CONCAT.
const MOST: usize = 32;

impl Standard {
    fn repeats(&self) -> bool {
        self.3.last() == Some(&"…")
    }

    fn least(&self) -> usize {
        self.3.len() - usize::from(self.repeats())
    }

    fn find(name: &str) -> Option<&'static Standard> {
        STANDARD.iter().find(|s| s.0.eq_ignore_ascii_case(name))
    }

    /// The place of a named input: `IN4` of MUX is place 5.
    fn place(&self, name: &str) -> Option<usize> {
        if let Some(k) = self.3.iter().position(|p| p.eq_ignore_ascii_case(name)) {
            return Some(k);
        }
        let upper = name.to_ascii_uppercase();
        let number: usize = upper.strip_prefix("IN")?.parse().ok()?;
        let first = if self.3.first() == Some(&"K") { 1 } else { 0 };
        let place = if first == 1 { number.checked_add(1)? } else { number.checked_sub(1)? };
        (self.repeats() && place < MOST).then_some(place)
    }
}

impl Resolver<'_, '_> {
    /// `f(x, n := y)`.
    pub(super) fn call(&mut self, path: &Path, args: &[Arg], hint: Option<Type>, at: Span) -> Option<Typed> {
        let [name] = path.names.as_slice() else {
            self.read_all(args);
            return self.not_a_function(path);
        };
        if let Some(own) = super::process::function(&name.text, at) {
            return Some(own);
        }
        // Inside a function its name is also that of its result.
        let own = self.scopes.names.get(&*name.text).copied();
        let entity = match self.entity(&name.text) {
            Some(Entity::Var(_)) if matches!(own, Some(Entity::Function(_))) => own,
            entity => entity,
        };
        let called = match entity {
            Some(Entity::Function(f)) => return self.call_function(f, name, args, at),
            Some(_) => None,
            None => Some(&name.text),
        };
        if let Some(standard) = called.and_then(|n| Standard::find(n)) {
            return self.call_standard(standard, name, args, hint, at);
        }
        if let Some((from, to)) = called.and_then(|n| conversion(n)) {
            return self.call_conversion(from, to, name, args, at);
        }
        self.read_all(args);
        self.not_a_function(path)
    }

    fn not_a_function<T>(&mut self, path: &Path) -> Option<T> {
        let text = path.text();
        let at = path.names.iter().map(|n| n.at.0).reduce(Span::to).unwrap_or_default();
        let known = match path.names.as_slice() {
            [one] => self.entity(&one.text),
            _ => None,
        };
        let problem = match known {
            Some(Entity::Var(v)) if self.var(v).is_some_and(|v| matches!(v.ty, Type::Fb(_))) => {
                let what = format!("the function block `{text}` is no part of an expression");
                Problem::new(&codes::WRONG_KIND, at, what)
                    .help(format!("call it in an action or PRE section, then read `{text}.Q`"))
            }
            Some(_) => Problem::new(&codes::WRONG_KIND, at, format!("`{text}` is not a function")),
            None => {
                let problem =
                    Problem::new(&codes::UNKNOWN_NAME, at, format!("there is no function `{text}`"));
                let own = self.unit.functions.iter().map(|f| &*f.name);
                match nearest(&text, own.chain(STANDARD.iter().map(|s| s.0))) {
                    Some(n) => problem.help(format!("did you mean `{n}`?")),
                    None => problem,
                }
            }
        };
        self.report(problem)
    }

    fn call_function(&mut self, f: FunctionId, name: &Name, args: &[Arg], at: Span) -> Option<Typed> {
        let names: Vec<String> =
            self.scopes.params.get(f.index()).into_iter().flatten().map(|n| (*n).to_owned()).collect();
        let function = self.unit.functions.get(f.index())?;
        let (result, declared) = (function.result, function.at);
        let types: Vec<Type> = function.params.iter().filter_map(|p| self.var(*p)).map(|v| v.ty).collect();
        if let Role::Function(caller) = self.frame.role {
            self.calls.push((caller, f, name.at.0));
        }
        let place = |n: &str| names.iter().position(|p| p == n);
        let ordered = self.arrange(name, args, place, types.len());
        let Some(ordered) = ordered else {
            self.read_all(args);
            return None;
        };
        let mut values = Vec::new();
        for (k, ty) in types.iter().enumerate() {
            match ordered.get(k).copied().flatten() {
                Some(arg) => values.push(self.value(&arg.value, *ty)),
                None => {
                    let missing = names.get(k).map_or("", |n| n);
                    let what = format!("`{}` needs its input `{missing}`", name.text);
                    let problem = Problem::new(&codes::WRONG_ARGUMENTS, at, what);
                    self.problems.push(problem.related(declared, "declared here"));
                    values.push(None);
                }
            }
        }
        let values = values.into_iter().collect::<Option<Vec<Expr>>>()?;
        let ty = self.var(result)?.ty;
        Some(Typed::of(ExprKind::Call(f, values), ty, at))
    }

    /// The arguments in the order of the inputs.
    fn arrange<'a>(
        &mut self,
        name: &Name,
        args: &'a [Arg],
        place: impl Fn(&str) -> Option<usize>,
        most: usize,
    ) -> Option<Vec<Option<&'a Arg>>> {
        let mut ordered: Vec<Option<&Arg>> = Vec::new();
        for (k, arg) in args.iter().enumerate() {
            let at = arg.name.as_ref().map_or(arg.value.at.0, |n| n.at.0);
            if arg.output {
                let what = format!("`{}` has one result and no outputs", name.text);
                return self.report(Problem::new(&codes::WRONG_ARGUMENTS, at, what));
            }
            let k = match &arg.name {
                None => k,
                Some(n) => match place(&n.text) {
                    Some(k) => k,
                    None => {
                        let what = format!("`{}` has no input `{}`", name.text, n.text);
                        return self.report(Problem::new(&codes::WRONG_ARGUMENTS, at, what));
                    }
                },
            };
            if k >= most {
                let what = format!("`{}` takes {}, here are {}", name.text, counted(most), args.len());
                return self.report(Problem::new(&codes::WRONG_ARGUMENTS, at, what));
            }
            if ordered.len() <= k {
                ordered.resize(k + 1, None);
            }
            if let Some(first) = ordered.get_mut(k).and_then(|slot| slot.replace(arg)) {
                let problem = Problem::new(&codes::WRONG_ARGUMENTS, at, "given twice in one call")
                    .related(first.value.at.0, "given here first");
                return self.report(problem);
            }
        }
        Some(ordered)
    }

    fn call_standard(
        &mut self,
        standard: &'static Standard,
        name: &Name,
        args: &[Arg],
        hint: Option<Type>,
        at: Span,
    ) -> Option<Typed> {
        let most = if standard.repeats() { MOST } else { standard.least() };
        let Some(ordered) = self.arrange(name, args, |n| standard.place(n), most) else {
            self.read_all(args);
            return None;
        };
        let given: Vec<&Arg> = ordered.iter().copied().flatten().collect();
        if given.len() < ordered.len().max(standard.least()) {
            self.read_all(args);
            let inputs = standard.3.join(", ");
            let what = format!("`{}` takes ({inputs}), here are {}", standard.0, args.len());
            return self.report(Problem::new(&codes::WRONG_ARGUMENTS, at, what));
        }
        match standard.2 {
            Shape::Truncate => self.truncate(given.first()?, hint, at),
            Shape::Any => self.infer(&given.first()?.value, hint).map(|mut t| {
                t.expr.at = at;
                t
            }),
            Shape::Text(texts) => self.text_function(standard.1?, usize::from(texts), &given, at),
            Shape::Measure => {
                let values = given.iter().map(|a| self.value(&a.value, Type::String(g7_engine::TEXT)));
                let values = values.collect::<Vec<_>>().into_iter().collect::<Option<Vec<_>>>()?;
                Some(Typed::of(ExprKind::Builtin(standard.1?, values), Type::Int, at))
            }
            Shape::Number | Shape::Real | Shape::Ordered | Shape::Limit => {
                let (values, _) = self.meet(standard, &given, None, hint, at)?;
                Some(nested(standard.1?, values, at))
            }
            Shape::Select | Shape::Multiplex => {
                let selector = if standard.2 == Shape::Select { Type::Bool } else { Type::Lint };
                let (first, others) = given.split_first()?;
                let first = self.value(&first.value, selector);
                let (values, ty) = self.meet(standard, others, first, hint, at)?;
                Some(Typed::of(ExprKind::Builtin(standard.1?, values), ty, at))
            }
        }
    }

    /// Values in their common type, behind the selector, if there is one.
    fn meet(
        &mut self,
        standard: &Standard,
        given: &[&Arg],
        selector: Option<Expr>,
        hint: Option<Type>,
        at: Span,
    ) -> Option<(Vec<Expr>, Type)> {
        let selects = matches!(standard.2, Shape::Select | Shape::Multiplex);
        let typed: Vec<Option<Typed>> = given.iter().map(|a| self.infer(&a.value, hint)).collect();
        let typed: Vec<Typed> = typed.into_iter().collect::<Option<_>>()?;
        let Some(ty) = shared(&typed, standard.2, hint) else {
            let names: Vec<String> = typed.iter().map(|t| t.expr.ty.to_string()).collect();
            let what = format!("`{}` cannot take {}", standard.0, names.join(", "));
            let problem = Problem::new(&codes::WRONG_TYPE, at, what);
            return self.report(problem.help("its values must be of one type, or widen to one"));
        };
        let mut values: Vec<Option<Expr>> = Vec::new();
        if selects {
            values.push(selector);
        }
        for t in typed {
            values.push(self.coerce(t, ty));
        }
        let values: Option<Vec<Expr>> = values.into_iter().collect();
        Some((values?, ty))
    }

    fn text_function(&mut self, function: Builtin, texts: usize, given: &[&Arg], at: Span) -> Option<Typed> {
        let texts = if function == Builtin::Concat { given.len() } else { texts };
        let mut values = Vec::new();
        for (k, arg) in given.iter().enumerate() {
            let want = if k < texts { Type::String(g7_engine::TEXT) } else { Type::Lint };
            values.push(self.value(&arg.value, want));
        }
        let values = values.into_iter().collect::<Option<Vec<Expr>>>()?;
        Some(nested(function, values, at))
    }

    /// TRUNC goes to the whole type that its place needs, else to DINT.
    fn truncate(&mut self, arg: &Arg, hint: Option<Type>, at: Span) -> Option<Typed> {
        let to = hint.filter(|t| t.is_integer()).unwrap_or(Type::Dint);
        let typed = self.infer(&arg.value, None)?;
        let from = if typed.literal || typed.expr.ty.is_integer() { Type::Lreal } else { typed.expr.ty };
        if !from.is_real() {
            let what = format!("`TRUNC` takes a REAL or LREAL, this is {from}");
            return self.report(Problem::new(&codes::WRONG_TYPE, typed.expr.at, what));
        }
        let e = self.coerce(typed, from)?;
        if let ExprKind::Const(v) = &e.kind {
            match constant::truncate(v, to) {
                Ok(Some(v)) => return Some(Typed::constant(v, to, at)),
                Ok(None) => {}
                Err(fault) => return self.constant_fault(fault, to, at),
            }
        }
        Some(Typed::of(ExprKind::Trunc(Box::new(e)), to, at))
    }

    /// `DINT_TO_INT(n)`; TIME is converted in milliseconds.
    fn call_conversion(
        &mut self,
        from: Type,
        to: Type,
        name: &Name,
        args: &[Arg],
        at: Span,
    ) -> Option<Typed> {
        let Some(ordered) = self.arrange(name, args, |n| (n == "IN").then_some(0), 1) else {
            self.read_all(args);
            return None;
        };
        let Some(arg) = ordered.first().copied().flatten() else {
            let what = format!("`{}` takes one value", name.text);
            return self.report(Problem::new(&codes::WRONG_ARGUMENTS, at, what));
        };
        let want = if matches!(from, Type::String(_)) { Type::String(g7_engine::TEXT) } else { from };
        let e = self.value(&arg.value, want)?;
        match (from, to) {
            (Type::Time, _) if to.is_number() => self.time_as_number(e, to, at),
            (_, Type::Time) if from.is_number() => self.number_as_time(e, at),
            (Type::Time, Type::Bool) | (Type::Bool | Type::String(_), Type::Time) => {
                let what = format!("there is no conversion from {from} to {to}");
                self.report(Problem::new(&codes::UNKNOWN_NAME, name.at.0, what))
            }
            _ => self.convert(e, to, at),
        }
    }

    fn convert(&mut self, e: Expr, to: Type, at: Span) -> Option<Typed> {
        if e.ty == to {
            return Some(Typed { expr: Expr { at, ..e }, literal: false });
        }
        if let ExprKind::Const(v) = &e.kind {
            match constant::convert(v, to) {
                Ok(Some(v)) => return Some(Typed::constant(v, to, at)),
                Ok(None) => {}
                Err(fault) => return self.constant_fault(fault, to, at),
            }
        }
        Some(Typed::of(ExprKind::Convert(Box::new(e)), to, at))
    }

    fn time_as_number(&mut self, time: Expr, to: Type, at: Span) -> Option<Typed> {
        if to.is_integer() {
            let ms = Typed::constant(Value::Int(MILLISECOND), Type::Lint, at).expr;
            let whole = match &time.kind {
                ExprKind::Const(Value::Int(ns)) => {
                    Typed::constant(Value::Int(ns / MILLISECOND), Type::Time, at).expr
                }
                _ => {
                    let kind = ExprKind::Binary(BinaryOp::Div, Box::new(time), Box::new(ms));
                    Expr { kind, ty: Type::Time, at }
                }
            };
            return self.convert(whole, to, at);
        }
        let ns = converted(time, Type::Lreal);
        let ms = Typed::constant(Value::Real(MILLISECOND as f64), Type::Lreal, at).expr;
        let kind = ExprKind::Binary(BinaryOp::Div, Box::new(ns), Box::new(ms));
        self.convert(Expr { kind, ty: Type::Lreal, at }, to, at)
    }

    /// A millisecond as often as the number says.
    fn number_as_time(&mut self, e: Expr, at: Span) -> Option<Typed> {
        let ms = Typed::constant(Value::Int(MILLISECOND), Type::Time, at).expr;
        let times = if e.ty.is_real() { Type::Lreal } else { Type::Lint };
        let e = converted(e, times);
        if let ExprKind::Const(Value::Int(n)) = &e.kind {
            let ns = n.checked_mul(MILLISECOND).ok_or(constant::Fault::Overflow);
            return match ns.and_then(|ns| constant::fit(Type::Time, ns)) {
                Ok(ns) => Some(Typed::constant(Value::Int(ns), Type::Time, at)),
                Err(fault) => self.constant_fault(fault, Type::Time, at),
            };
        }
        let kind = ExprKind::Binary(BinaryOp::Mul, Box::new(ms), Box::new(e));
        Some(Typed::of(kind, Type::Time, at))
    }
}

/// The type that all arguments take.
fn shared(typed: &[Typed], shape: Shape, hint: Option<Type>) -> Option<Type> {
    let mut ty: Option<Type> = None;
    for t in typed.iter().filter(|t| !t.literal) {
        ty = Some(match ty {
            None => t.expr.ty,
            Some(before) => common(before, t.expr.ty)?,
        });
    }
    let real = typed.iter().any(|t| t.literal && matches!(t.value(), Some(Value::Real(_))));
    let ty = match ty {
        // Literals alone: what the place needs, if they can take it.
        None => match hint.filter(|h| h.is_number() && (h.is_real() || !real)) {
            Some(h) => h,
            None if real || shape == Shape::Real => Type::Lreal,
            None => Type::Dint,
        },
        Some(t) if real && t.is_integer() => common(t, Type::Real)?,
        Some(t) => t,
    };
    let fits = match shape {
        Shape::Number => ty.is_number() || ty == Type::Time,
        Shape::Real if ty.is_integer() => return common(ty, Type::Real),
        Shape::Real => ty.is_real(),
        Shape::Ordered | Shape::Limit => ty.is_number() || ty == Type::Time,
        _ => !matches!(ty, Type::Fb(_)),
    };
    fits.then_some(ty)
}

/// MIN, MAX and CONCAT of more than two, as calls of two.
fn nested(function: Builtin, values: Vec<Expr>, at: Span) -> Typed {
    let of = |values: Vec<Expr>| {
        let ty = result_type(function, &values);
        Expr { kind: ExprKind::Builtin(function, values), ty, at }
    };
    if !matches!(function, Builtin::Min | Builtin::Max | Builtin::Concat) {
        return Typed { expr: of(values), literal: false };
    }
    let mut values = values.into_iter();
    let first = values.next();
    let all = first.map(|first| values.fold(first, |a, b| of(vec![a, b])));
    Typed { expr: all.unwrap_or_else(|| of(Vec::new())), literal: false }
}

/// Of the type of the values; a text has room for all that can come out.
fn result_type(function: Builtin, values: &[Expr]) -> Type {
    let room = |k: usize| match values.get(k).map(|v| v.ty) {
        Some(Type::String(n)) => n,
        _ => 0,
    };
    match function {
        Builtin::Left | Builtin::Right | Builtin::Mid | Builtin::Delete => Type::String(room(0)),
        Builtin::Concat | Builtin::Insert | Builtin::Replace => {
            Type::String(room(0).saturating_add(room(1)).min(g7_engine::TEXT))
        }
        _ => values.first().map_or(Type::Dint, |v| v.ty),
    }
}

/// `DINT_TO_INT`.
fn conversion(name: &str) -> Option<(Type, Type)> {
    let upper = name.to_ascii_uppercase();
    let (from, to) = upper.split_once("_TO_")?;
    let elementary = |name: &str| Type::named(name).filter(|ty| ty.elementary().is_some());
    Some((elementary(from)?, elementary(to)?))
}

fn counted(n: usize) -> String {
    match n {
        0 => "no inputs".to_owned(),
        1 => "one input".to_owned(),
        _ => format!("{n} inputs"),
    }
}
