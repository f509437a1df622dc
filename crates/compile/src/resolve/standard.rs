//! Calls of the standard functions.
//!
//! The function of an operator becomes that operator: its types, its conversions and its faults are
//! those of the operator.

use g7_engine::Builtin;
use g7_model::{
    Arg, BinaryOp as Sign, FunctionRow, Moment, Name, Operands, Problem, Said, Span, StandardFunction, Type,
    codes, say,
};

use super::constant;
use super::operator;
use super::resolver::Resolver;
use super::types::{Typed, common, converted};
use crate::ir::{Expr, ExprKind, Value};

/// Most parts of a value that a comparison of three and more takes twice.
const MOST_PARTS: usize = 200;

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
    /// Texts, then whole numbers; the result is a text.
    Text(u8),
    /// Texts; the result is an INT.
    Measure,
    /// A whole number without a sign, which stands for a bit string, then a whole number.
    Bits,
}

/// How a function is resolved.
enum Way {
    /// As an operator.
    Operator(Sign),
    /// As the complement.
    Not,
    /// As its input.
    Move,
    /// TRUNC.
    Truncate,
    /// DAY_OF_WEEK.
    DayOfWeek,
    /// CONCAT_DATE_TOD.
    DayWithTime,
    /// As a function of the tables.
    Builtin(Builtin, Shape),
}

fn way(function: StandardFunction) -> Way {
    use StandardFunction as F;
    let (builtin, shape) = match function {
        F::Operator(op) => return Way::Operator(op),
        F::Not => return Way::Not,
        F::Move => return Way::Move,
        F::Trunc => return Way::Truncate,
        F::DayOfWeek => return Way::DayOfWeek,
        F::ConcatDateTod => return Way::DayWithTime,
        F::Abs => (Builtin::Abs, Shape::Number),
        F::Sqrt => (Builtin::Sqrt, Shape::Real),
        F::Ln => (Builtin::Ln, Shape::Real),
        F::Log => (Builtin::Log, Shape::Real),
        F::Exp => (Builtin::Exp, Shape::Real),
        F::Sin => (Builtin::Sin, Shape::Real),
        F::Cos => (Builtin::Cos, Shape::Real),
        F::Tan => (Builtin::Tan, Shape::Real),
        F::Asin => (Builtin::Asin, Shape::Real),
        F::Acos => (Builtin::Acos, Shape::Real),
        F::Atan => (Builtin::Atan, Shape::Real),
        F::Shl => (Builtin::Shl, Shape::Bits),
        F::Shr => (Builtin::Shr, Shape::Bits),
        F::Rol => (Builtin::Rol, Shape::Bits),
        F::Ror => (Builtin::Ror, Shape::Bits),
        F::Min => (Builtin::Min, Shape::Ordered),
        F::Max => (Builtin::Max, Shape::Ordered),
        F::Limit => (Builtin::Limit, Shape::Limit),
        F::Sel => (Builtin::Sel, Shape::Select),
        F::Mux => (Builtin::Mux, Shape::Multiplex),
        F::Len => (Builtin::Len, Shape::Measure),
        F::Find => (Builtin::Find, Shape::Measure),
        F::Left => (Builtin::Left, Shape::Text(1)),
        F::Right => (Builtin::Right, Shape::Text(1)),
        F::Mid => (Builtin::Mid, Shape::Text(1)),
        F::Concat => (Builtin::Concat, Shape::Text(2)),
        F::Insert => (Builtin::Insert, Shape::Text(2)),
        F::Delete => (Builtin::Delete, Shape::Text(1)),
        F::Replace => (Builtin::Replace, Shape::Text(2)),
    };
    Way::Builtin(builtin, shape)
}

impl Resolver<'_, '_> {
    /// A call of a standard function.
    #[inline(never)]
    pub(super) fn call_standard(
        &mut self,
        standard: StandardFunction,
        name: &Name,
        args: &[Arg],
        hint: Option<Type>,
        at: Span,
    ) -> Option<Typed> {
        let row = standard.row();
        let Some(ordered) = self.arrange(name, args, |n| row.place(n), row.most()) else {
            self.read_all(args);
            return None;
        };
        let given: Vec<&Arg> = ordered.iter().copied().flatten().collect();
        if given.len() < ordered.len().max(row.least()) {
            self.read_all(args);
            let inputs = row.inputs.join(", ");
            let what = say!("`{}` takes ({}), here are {}", row.name, Said::foreign(inputs), args.len());
            return self.report(Problem::new(&codes::WRONG_ARGUMENTS, at, what));
        }
        match way(standard) {
            Way::Operator(op) => self.operated(op, row, &given, hint, at),
            Way::Not => self.complement(&given.first()?.value, hint, at),
            Way::Move => self.infer(&given.first()?.value, hint).map(|mut t| {
                t.expr.at = at;
                t
            }),
            Way::Truncate => self.truncate(given.first()?, hint, at),
            Way::DayOfWeek => {
                let day = self.value(&given.first()?.value, Type::Moment(Moment::Date))?;
                self.day_of_week(day, at)
            }
            Way::DayWithTime => {
                let [day, time] = given.as_slice() else { return None };
                let day = self.value(&day.value, Type::Moment(Moment::Date));
                let time = self.value(&time.value, Type::Moment(Moment::Tod));
                self.day_with_time(day?, time?, at)
            }
            Way::Builtin(function, shape) => self.builtin(function, shape, row, &given, hint, at),
        }
    }

    fn builtin(
        &mut self,
        function: Builtin,
        shape: Shape,
        row: FunctionRow,
        given: &[&Arg],
        hint: Option<Type>,
        at: Span,
    ) -> Option<Typed> {
        match shape {
            Shape::Text(texts) => self.text_function(function, usize::from(texts), given, at),
            Shape::Measure => {
                let values = given.iter().map(|a| self.value(&a.value, Type::String(g7_engine::TEXT)));
                let values = values.collect::<Vec<_>>().into_iter().collect::<Option<Vec<_>>>()?;
                Some(Typed::of(ExprKind::Builtin(function, values), Type::Int, at))
            }
            Shape::Number | Shape::Real | Shape::Ordered | Shape::Limit => {
                let (values, ty) = self.meet(row, shape, given, None, hint, at)?;
                // Bit strings are in the order of the numbers that stand for them (2.5.1.5.4, ANY_BIT).
                let Some(number) = ty.unsigned().filter(|_| ty.is_bits()) else {
                    return Some(nested(function, values, at));
                };
                let numbers = values.into_iter().map(|e| converted(e, number)).collect();
                let chosen = nested(function, numbers, at).expr;
                Some(Typed { expr: converted(chosen, ty), literal: false })
            }
            Shape::Select | Shape::Multiplex => {
                let selector = if shape == Shape::Select { Type::Bool } else { Type::Lint };
                let (first, others) = given.split_first()?;
                let first = self.value(&first.value, selector);
                let (values, ty) = self.meet(row, shape, others, first, hint, at)?;
                Some(Typed::of(ExprKind::Builtin(function, values), ty, at))
            }
            Shape::Bits => self.shifted(function, row, given, hint, at),
        }
    }

    /// `ADD(a, b, c)` as `a + b + c`.
    fn operated(
        &mut self,
        op: Sign,
        row: FunctionRow,
        given: &[&Arg],
        hint: Option<Type>,
        at: Span,
    ) -> Option<Typed> {
        let hint = hint.filter(|_| operator::keeps_type(op));
        let typed: Vec<Option<Typed>> = given.iter().map(|a| self.infer(&a.value, hint)).collect();
        let typed: Vec<Typed> = typed.into_iter().collect::<Option<_>>()?;
        if op.row().operands == Operands::Comparison {
            return self.in_turn(op, row, &typed, at);
        }
        let (first, others) = typed.split_first()?;
        others.iter().try_fold(first.clone(), |all, next| self.combine(op, all, next.clone(), at))
    }

    /// `GT(a, b, c)` as `a > b and b > c`.
    fn in_turn(&mut self, op: Sign, row: FunctionRow, typed: &[Typed], at: Span) -> Option<Typed> {
        let between = typed.iter().skip(1).take(typed.len().saturating_sub(2));
        if let Some(once) = between.into_iter().find(|t| !can_stand_twice(&t.expr)) {
            let what = say!("`{}` would compute this value twice", row.name);
            let problem = Problem::new(&codes::WRONG_ARGUMENTS, once.expr.at, what);
            return self.report(problem.help(say!("give it to a variable first")));
        }
        let mut all = None;
        for pair in typed.windows(2) {
            let [a, b] = pair else { continue };
            let one = self.combine(op, a.clone(), b.clone(), at)?;
            all = Some(match all {
                Some(before) => self.combine(Sign::And, before, one, at)?,
                None => one,
            });
        }
        all
    }

    /// SHL, SHR, ROL and ROR. Bit strings are numbers without a sign here.
    fn shifted(
        &mut self,
        function: Builtin,
        row: FunctionRow,
        given: &[&Arg],
        hint: Option<Type>,
        at: Span,
    ) -> Option<Typed> {
        let [bits, count] = given else { return None };
        let unsigned = |ty: &Type| ty.bounds().is_some_and(|(least, _)| least == 0);
        let hint = hint.filter(unsigned);
        let bits = self.infer(&bits.value, hint);
        let count = self.value(&count.value, Type::Lint);
        let (bits, count) = (bits?, count?);
        let ty = if bits.literal { hint.unwrap_or(Type::Udint) } else { bits.expr.ty };
        if !unsigned(&ty) {
            let what =
                say!("`{}` takes a bit string or a whole number without a sign, this is {ty}", row.name);
            let problem = Problem::new(&codes::WRONG_TYPE, bits.expr.at, what);
            return self.report(match ty {
                Type::Sint | Type::Int | Type::Dint | Type::Lint => {
                    problem.help(say!("convert it with `{ty}_TO_{}(…)`", ty.bit_string().unwrap_or(ty)))
                }
                _ => problem,
            });
        }
        if let ExprKind::Const(Value::Int(..0)) = &count.kind {
            let what = say!("`{}` by a negative number has no result", row.name);
            return self.report(Problem::new(&codes::CONSTANT_FAULT, count.at, what));
        }
        let bits = self.coerce(bits, ty)?;
        Some(Typed::of(ExprKind::Builtin(function, vec![bits, count]), ty, at))
    }

    /// Values in their common type, behind the selector, if there is one.
    fn meet(
        &mut self,
        row: FunctionRow,
        shape: Shape,
        given: &[&Arg],
        selector: Option<Expr>,
        hint: Option<Type>,
        at: Span,
    ) -> Option<(Vec<Expr>, Type)> {
        let selects = matches!(shape, Shape::Select | Shape::Multiplex);
        let typed: Vec<Option<Typed>> = given.iter().map(|a| self.infer(&a.value, hint)).collect();
        let typed: Vec<Typed> = typed.into_iter().collect::<Option<_>>()?;
        let Some(ty) = shared(&typed, shape, hint) else {
            let names: Vec<String> = typed.iter().map(|t| t.expr.ty.to_string()).collect();
            let what = say!("`{}` cannot take {}", row.name, Said::foreign(names.join(", ")));
            let problem = Problem::new(&codes::WRONG_TYPE, at, what);
            return self.report(problem.help(say!("its values must be of one type, or widen to one")));
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
            let what = say!("`TRUNC` takes a REAL or LREAL, this is {from}");
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
}

/// True if a value is the same when it is computed again, and short enough for it: values within
/// values would double without bound.
fn can_stand_twice(e: &Expr) -> bool {
    let mut pending = vec![e];
    let mut parts = 0;
    while let Some(e) = pending.pop() {
        parts += 1;
        if parts > MOST_PARTS || matches!(e.kind, ExprKind::Random) {
            return false;
        }
        pending.extend(e.operands());
    }
    true
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
    let measured = ty.is_number() || ty == Type::Time;
    let fits = match shape {
        Shape::Number => measured,
        Shape::Real if ty.is_integer() => return common(ty, Type::Real),
        Shape::Real => ty.is_real(),
        Shape::Ordered | Shape::Limit => measured || ty.is_moment() || ty.is_bits(),
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
pub(super) fn result_type(function: Builtin, values: &[Expr]) -> Type {
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
