//! Calls in expressions: functions of the document, standard functions, conversions.

use g7_model::{Arg, Moment, Name, Nanos, Path, Problem, Said, Span, StandardFunction, Type, codes, say};

use super::bcd::Bcd;
use super::constant;
use super::resolver::{Resolver, Role, nearest};
use super::scopes::Entity;
use super::types::{Typed, converted};
use crate::ir::{BinaryOp, Expr, ExprKind, FunctionId, Value};
use crate::tree::transfers;

/// Nanoseconds of the unit in which TIME is converted to numbers.
const MILLISECOND: i128 = Nanos::MILLISECOND.count() as i128;

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
        if let Some(standard) = called.and_then(|n| StandardFunction::named(n)) {
            return self.call_standard(standard, name, args, hint, at);
        }
        if let Some((from, to)) = called.and_then(|n| conversion(n)) {
            return self.call_conversion(from, to, name, args, at);
        }
        if let Some(bcd) = called.and_then(|n| Bcd::named(n)) {
            return self.call_bcd(bcd, name, args, hint, at);
        }
        self.read_all(args);
        self.not_a_function(path)
    }

    #[inline(never)]
    fn not_a_function<T>(&mut self, path: &Path) -> Option<T> {
        let text = path.text();
        let at = path.names.iter().map(|n| n.at.0).reduce(Span::to).unwrap_or_default();
        let known = match path.names.as_slice() {
            [one] => self.entity(&one.text),
            _ => None,
        };
        let problem = match known {
            Some(Entity::Var(v)) if self.var(v).is_some_and(|v| matches!(v.ty, Type::Fb(_))) => {
                let what = say!("the function block `{text}` is no part of an expression");
                Problem::new(&codes::WRONG_KIND, at, what)
                    .help(say!("call it in an action or PRE section, then read `{text}.Q`"))
            }
            Some(_) => Problem::new(&codes::WRONG_KIND, at, say!("`{text}` is not a function")),
            None => {
                let problem = Problem::new(&codes::UNKNOWN_NAME, at, say!("there is no function `{text}`"));
                let own = self.unit.functions.iter().map(|f| &*f.name);
                match nearest(&text, own.chain(StandardFunction::ALL.into_iter().map(|f| f.row().name))) {
                    _ if text.eq_ignore_ascii_case("R_EDGE") => {
                        problem.help(say!("an edge is written `rise(a)` or `↑a`"))
                    }
                    _ if text.eq_ignore_ascii_case("F_EDGE") => {
                        problem.help(say!("an edge is written `fall(a)` or `↓a`"))
                    }
                    Some(n) => problem.meant(n),
                    None => problem.help(say!("declare it: `function f(x : INT) : INT {{ … }}`")),
                }
            }
        };
        self.report(problem)
    }

    #[inline(never)]
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
                    let what = say!("`{}` needs its input `{missing}`", name.text);
                    let problem = Problem::new(&codes::WRONG_ARGUMENTS, at, what);
                    self.problems.push(problem.related(declared, say!("declared here")));
                    values.push(None);
                }
            }
        }
        let values = values.into_iter().collect::<Option<Vec<Expr>>>()?;
        let ty = self.var(result)?.ty;
        Some(Typed::of(ExprKind::Call(f, values), ty, at))
    }

    /// The arguments in the order of the inputs.
    pub(super) fn arrange<'a>(
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
                let what = say!("`{}` has one result and no outputs", name.text);
                return self.report(Problem::new(&codes::WRONG_ARGUMENTS, at, what));
            }
            let k = match &arg.name {
                None => k,
                Some(n) => match place(&n.text) {
                    Some(k) => k,
                    None => {
                        let what = say!("`{}` has no input `{}`", name.text, n.text);
                        return self.report(Problem::new(&codes::WRONG_ARGUMENTS, at, what));
                    }
                },
            };
            if k >= most {
                let what = say!("`{}` takes {}, here are {}", name.text, counted(most), args.len());
                return self.report(Problem::new(&codes::WRONG_ARGUMENTS, at, what));
            }
            if ordered.len() <= k {
                ordered.resize(k + 1, None);
            }
            if let Some(first) = ordered.get_mut(k).and_then(|slot| slot.replace(arg)) {
                let problem = Problem::new(&codes::WRONG_ARGUMENTS, at, say!("given twice in one call"))
                    .related(first.value.at.0, say!("given here first"));
                return self.report(problem);
            }
        }
        Some(ordered)
    }

    /// The argument of a conversion.
    pub(super) fn only_argument<'a>(&mut self, name: &Name, args: &'a [Arg], at: Span) -> Option<&'a Arg> {
        let Some(ordered) = self.arrange(name, args, |n| (n == "IN").then_some(0), 1) else {
            self.read_all(args);
            return None;
        };
        let Some(arg) = ordered.first().copied().flatten() else {
            let what = say!("`{}` takes one value", name.text);
            return self.report(Problem::new(&codes::WRONG_ARGUMENTS, at, what));
        };
        Some(arg)
    }

    /// `DINT_TO_INT(n)`; TIME and TOD are converted in milliseconds, DATE and DT in seconds.
    #[inline(never)]
    fn call_conversion(
        &mut self,
        from: Type,
        to: Type,
        name: &Name,
        args: &[Arg],
        at: Span,
    ) -> Option<Typed> {
        let arg = self.only_argument(name, args, at)?;
        let want = if matches!(from, Type::String(_)) { Type::String(g7_engine::TEXT) } else { from };
        let e = self.value(&arg.value, want)?;
        let written = |ty: Type| ty.is_moment() || ty.is_bits();
        match (from, to) {
            (_, Type::String(_)) if written(from) => self.written_as_literal(e, at),
            (Type::String(_), _) if to == Type::Time || written(to) => self.read_as_literal(e, to, at),
            (Type::Time, _) if to.is_number() => self.time_as_number(e, to, MILLISECOND, at),
            (_, Type::Time) if from.is_number() => self.number_as_time(e, MILLISECOND, at),
            (Type::Moment(moment), _) if to.is_number() => {
                self.time_as_number(converted(e, Type::Time), to, i128::from(moment.unit().count()), at)
            }
            (_, Type::Moment(moment)) if from.is_number() => {
                let time = self.number_as_time(e, i128::from(moment.unit().count()), at)?;
                self.moment_of(time.expr, moment, at)
            }
            (Type::Moment(Moment::Dt), Type::Moment(Moment::Date)) => self.day(e, at),
            (Type::Moment(Moment::Dt), Type::Moment(Moment::Tod)) => self.time_of_day(e, at),
            _ if from.is_bits() && !whole(to) || to.is_bits() && !whole(from) => {
                let what = say!("there is no conversion from {from} to {to}");
                let problem = Problem::new(&codes::UNKNOWN_NAME, name.at.0, what);
                let between = from.unsigned().or(to.unsigned()).unwrap_or(Type::Udint);
                self.report(problem.help(say!(
                    "convert it by way of a number: `{from}_TO_{between}` and `{between}_TO_{to}`"
                )))
            }
            (Type::Time, Type::Bool) | (Type::Bool, Type::Time) => self.no_conversion(from, to, name.at.0),
            (Type::Moment(_), _) | (_, Type::Moment(_)) if from != to => {
                self.no_conversion(from, to, name.at.0)
            }
            _ => self.convert(e, to, at),
        }
    }

    #[inline(never)]
    fn convert(&mut self, e: Expr, to: Type, at: Span) -> Option<Typed> {
        if e.ty == to {
            return Some(Typed { expr: Expr { at, ..e }, literal: false });
        }
        if transfers(e.ty, to) {
            return Some(Typed { expr: converted(Expr { at, ..e }, to), literal: false });
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

    /// The number of units of so many nanoseconds in a duration.
    fn time_as_number(&mut self, time: Expr, to: Type, unit: i128, at: Span) -> Option<Typed> {
        if to.is_integer() {
            let one = Typed::constant(Value::Int(unit), Type::Lint, at).expr;
            let whole = match &time.kind {
                ExprKind::Const(Value::Int(ns)) => {
                    Typed::constant(Value::Int(ns / unit), Type::Time, at).expr
                }
                _ => {
                    let kind = ExprKind::Binary(BinaryOp::Div, Box::new(time), Box::new(one));
                    Expr { kind, ty: Type::Time, at }
                }
            };
            return self.convert(whole, to, at);
        }
        let ns = converted(time, Type::Lreal);
        let one = Typed::constant(Value::Real(unit as f64), Type::Lreal, at).expr;
        let kind = ExprKind::Binary(BinaryOp::Div, Box::new(ns), Box::new(one));
        self.convert(Expr { kind, ty: Type::Lreal, at }, to, at)
    }

    /// A unit of so many nanoseconds as often as the number says.
    fn number_as_time(&mut self, e: Expr, unit: i128, at: Span) -> Option<Typed> {
        let one = Typed::constant(Value::Int(unit), Type::Time, at).expr;
        let times = if e.ty.is_real() { Type::Lreal } else { Type::Lint };
        let e = converted(e, times);
        if let ExprKind::Const(Value::Int(n)) = &e.kind {
            let ns = n.checked_mul(unit).ok_or(constant::Fault::Overflow);
            return match ns.and_then(|ns| constant::fit(Type::Time, ns)) {
                Ok(ns) => Some(Typed::constant(Value::Int(ns), Type::Time, at)),
                Err(fault) => self.constant_fault(fault, Type::Time, at),
            };
        }
        let kind = ExprKind::Binary(BinaryOp::Mul, Box::new(one), Box::new(e));
        Some(Typed::of(kind, Type::Time, at))
    }
}

/// True if conversions between bit strings and this type exist.
fn whole(ty: Type) -> bool {
    ty.is_bits() || ty.is_integer() || ty == Type::Bool
}

/// The types that the name of a conversion names, `DINT_TO_INT`.
pub fn conversion(name: &str) -> Option<(Type, Type)> {
    let upper = name.to_ascii_uppercase();
    let (from, to) = upper.split_once("_TO_")?;
    let elementary = |name: &str| Type::named(name).filter(|ty| ty.elementary().is_some());
    Some((elementary(from)?, elementary(to)?))
}

fn counted(n: usize) -> Said {
    match n {
        0 => say!("no inputs"),
        1 => say!("one input"),
        _ => say!("{n} inputs"),
    }
}
