//! Values, and the typed arithmetic of decision 18: each operation is computed in the type of its
//! result; literals adapt to the other operand.

use g7_model::{BinaryOp, Type};

use super::fb::FbState;

/// The value of a variable or an expression.
#[derive(Clone, Debug)]
pub enum Value {
    /// BOOL.
    Bool(bool),
    /// Any integer type.
    Int(i128),
    /// REAL.
    Real(f32),
    /// LREAL.
    Lreal(f64),
    /// TIME, in nanoseconds.
    Time(i64),
    /// STRING.
    Str(String),
    /// A function block instance.
    Fb(FbState),
}

impl PartialEq for Value {
    /// Compares bits, so that a state that contains NaN can recur.
    fn eq(&self, other: &Value) -> bool {
        match (self, other) {
            (Value::Bool(a), Value::Bool(b)) => a == b,
            (Value::Int(a), Value::Int(b)) => a == b,
            (Value::Real(a), Value::Real(b)) => a.to_bits() == b.to_bits(),
            (Value::Lreal(a), Value::Lreal(b)) => a.to_bits() == b.to_bits(),
            (Value::Time(a), Value::Time(b)) => a == b,
            (Value::Str(a), Value::Str(b)) => a == b,
            (Value::Fb(a), Value::Fb(b)) => a == b,
            _ => false,
        }
    }
}

/// Why a scan ended with a fault.
#[derive(Clone, Debug, PartialEq)]
pub enum NaiveFault {
    /// A complete state recurred within a scan; the situations of the cycle.
    Unstable(Vec<Vec<String>>),
    /// More passes than `bound n` allows.
    Passes,
    /// Two forcing orders for this chart conflict.
    Forcing(String),
    /// The result does not fit its type.
    Overflow,
    /// Division or modulus by zero.
    Division,
    /// A selector or a position is out of range.
    Index,
    /// More loop iterations than allowed in a scan.
    Work,
    /// More active steps or valid transitions than the target PLC allows.
    Table,
    /// A scan was requested after a fault.
    Stopped,
    /// The document has no meaning; `check` would have refused it.
    Bad(String),
}

pub(super) type Run<T> = Result<T, NaiveFault>;

pub(super) fn bad<T>(what: impl Into<String>) -> Run<T> {
    Err(NaiveFault::Bad(what.into()))
}

/// A value with its type; a literal has no type and adapts.
#[derive(Clone, Debug)]
pub(super) struct Typed {
    pub(super) ty: Option<Type>,
    pub(super) v: Value,
}

impl Typed {
    pub(super) fn of(ty: Type, v: Value) -> Typed {
        Typed { ty: Some(ty), v }
    }

    pub(super) fn bool(b: bool) -> Typed {
        Typed::of(Type::Bool, Value::Bool(b))
    }

    pub(super) fn int(n: i128) -> Typed {
        Typed::of(Type::Int, Value::Int(n))
    }

    pub(super) fn time(t: i64) -> Typed {
        Typed::of(Type::Time, Value::Time(t))
    }

    /// The value as a BOOL; the literals 0 and 1 count as BOOL.
    pub(super) fn truth(&self) -> Run<bool> {
        match (&self.v, self.ty) {
            (Value::Bool(b), _) => Ok(*b),
            (Value::Int(n @ (0 | 1)), None) => Ok(*n == 1),
            (v, _) => bad(format!("{v:?} is no BOOL")),
        }
    }

    /// The value as a duration.
    pub(super) fn duration(&self) -> Run<i64> {
        if let Value::Time(t) = self.v { Ok(t) } else { bad(format!("{:?} is no TIME", self.v)) }
    }

    /// The value as an integer.
    pub(super) fn whole(&self) -> Run<i128> {
        if let Value::Int(n) = self.v { Ok(n) } else { bad(format!("{:?} is no integer", self.v)) }
    }

    /// The value as a text.
    pub(super) fn text(&self) -> Run<&str> {
        if let Value::Str(s) = &self.v { Ok(s) } else { bad(format!("{:?} is no STRING", self.v)) }
    }

    /// The value converted to a type by the implicit conversions.
    pub(super) fn to(&self, ty: Type) -> Run<Value> {
        if let Some((least, most)) = ty.bounds() {
            let n = self.whole()?;
            return if (least..=most).contains(&n) { Ok(Value::Int(n)) } else { Err(NaiveFault::Overflow) };
        }
        Ok(match (ty, &self.v) {
            (Type::Bool, _) => Value::Bool(self.truth()?),
            (Type::Real, Value::Int(n)) => Value::Real(*n as f32),
            (Type::Real, Value::Real(x)) => Value::Real(*x),
            (Type::Real, Value::Lreal(x)) if self.ty.is_none() => Value::Real(*x as f32),
            (Type::Lreal, Value::Int(n)) => Value::Lreal(*n as f64),
            (Type::Lreal, Value::Real(x)) => Value::Lreal(f64::from(*x)),
            (Type::Lreal, Value::Lreal(x)) => Value::Lreal(*x),
            (Type::Time | Type::Moment(_), Value::Time(t)) => Value::Time(*t),
            (Type::String(n), Value::Str(s)) => Value::Str(cut(s, usize::from(n))),
            (Type::Fb(kind), Value::Fb(f)) if f.kind == kind => self.v.clone(),
            (_, v) => return bad(format!("{v:?} where {ty} is needed")),
        })
    }
}

/// The first bytes of a text, cut between two characters.
pub(super) fn cut(s: &str, most: usize) -> String {
    let mut end = most.min(s.len());
    while !s.is_char_boundary(end) {
        end -= 1;
    }
    s[..end].to_owned()
}

/// The value of a variable without an initial value.
pub(super) fn zero(ty: Type) -> Value {
    match ty {
        Type::Bool => Value::Bool(false),
        Type::Real => Value::Real(0.0),
        Type::Lreal => Value::Lreal(0.0),
        Type::Time | Type::Moment(_) => Value::Time(0),
        Type::String(_) => Value::Str(String::new()),
        Type::Fb(kind) => Value::Fb(FbState::new(kind)),
        Type::Sint
        | Type::Int
        | Type::Dint
        | Type::Lint
        | Type::Usint
        | Type::Uint
        | Type::Udint
        | Type::Ulint
        | Type::Byte
        | Type::Word
        | Type::Dword
        | Type::Lword => Value::Int(0),
    }
}

/// The signed integer types by size, for the search of a common type.
const SIGNED: [Type; 4] = [Type::Sint, Type::Int, Type::Dint, Type::Lint];
const UNSIGNED: [Type; 4] = [Type::Usint, Type::Uint, Type::Udint, Type::Ulint];

/// The smallest type to which both integer types widen.
pub(super) fn common_integer(a: Type, b: Type) -> Run<Type> {
    let holds = |wide: &Type| {
        [a, b].iter().all(|t| match (wide.bounds(), t.bounds()) {
            (Some((l, h)), Some((tl, th))) => l <= tl && th <= h,
            _ => false,
        })
    };
    let candidates = UNSIGNED.iter().zip(SIGNED.iter()).flat_map(|(u, s)| [u, s]);
    match candidates.copied().find(holds) {
        Some(t) => Ok(t),
        None => bad(format!("no type holds both {a} and {b}")),
    }
}

/// True if values are whole numbers, or bits that stand for one.
fn is_whole(ty: Type) -> bool {
    ty.is_integer() || ty.is_bits()
}

/// The common type of two operands; `None` if both are literals.
pub(super) fn common(a: &Typed, b: &Typed) -> Run<Option<Type>> {
    let literal_real = |t: &Typed| t.ty.is_none() && matches!(t.v, Value::Lreal(_));
    match (a.ty, b.ty) {
        (None, None) => Ok(None),
        (Some(t), None) | (None, Some(t)) => {
            let other = if a.ty.is_none() { a } else { b };
            match (t, &other.v) {
                (t, Value::Lreal(_)) if t.is_integer() && literal_real(other) => Ok(Some(Type::Real)),
                _ => Ok(Some(t)),
            }
        }
        (Some(x), Some(y)) => match (x, y) {
            (x, y) if is_whole(x) && is_whole(y) && !(x.is_bits() && y.is_bits()) => {
                Ok(Some(common_integer(x, y)?))
            }
            (Type::Lreal, y) if y.is_integer() || y.is_real() => Ok(Some(Type::Lreal)),
            (x, Type::Lreal) if x.is_integer() || x.is_real() => Ok(Some(Type::Lreal)),
            (Type::Real, y) if y.is_integer() || y == Type::Real => Ok(Some(Type::Real)),
            (x, Type::Real) if x.is_integer() => Ok(Some(Type::Real)),
            (Type::String(_), Type::String(_)) => Ok(Some(Type::String(u16::MAX))),
            (x, y) if x.is_bits() && y.is_bits() => {
                Ok(Some(if super::bits::width(x) < super::bits::width(y) { y } else { x }))
            }
            (x, y) if x == y => Ok(Some(x)),
            (x, y) => bad(format!("{x} and {y} do not meet")),
        },
    }
}

/// Arithmetic, comparison or logic with two operands.
pub(super) fn binary(op: BinaryOp, a: &Typed, b: &Typed) -> Run<Typed> {
    use BinaryOp as B;
    let boolean = |t: &Typed| t.ty == Some(Type::Bool);
    if let Some(done) = super::bits::joined(op, a, b) {
        return done;
    }
    match op {
        B::Or => Ok(Typed::bool(a.truth()? | b.truth()?)),
        B::Xor => Ok(Typed::bool(a.truth()? ^ b.truth()?)),
        B::And | B::Dot => Ok(Typed::bool(a.truth()? & b.truth()?)),
        B::Add if boolean(a) || boolean(b) => Ok(Typed::bool(a.truth()? | b.truth()?)),
        B::Mul if boolean(a) || boolean(b) => Ok(Typed::bool(a.truth()? & b.truth()?)),
        B::Eq | B::Ne | B::Lt | B::Le | B::Gt | B::Ge => compare(op, a, b),
        B::Add | B::Sub | B::Mul | B::Div | B::Mod | B::Pow => arithmetic(op, a, b),
    }
}

fn compare(op: BinaryOp, a: &Typed, b: &Typed) -> Run<Typed> {
    use std::cmp::Ordering::{Equal, Greater, Less};
    let (x, y) = match common(a, b)? {
        Some(ty) => (a.to(ty)?, b.to(ty)?),
        None => (a.v.clone(), b.v.clone()),
    };
    let order = match (&x, &y) {
        (Value::Bool(x), Value::Bool(y)) => Some(x.cmp(y)),
        (Value::Int(x), Value::Int(y)) => Some(x.cmp(y)),
        (Value::Real(x), Value::Real(y)) => x.partial_cmp(y),
        (Value::Lreal(x), Value::Lreal(y)) => x.partial_cmp(y),
        (Value::Int(x), Value::Lreal(y)) => (*x as f64).partial_cmp(y),
        (Value::Lreal(x), Value::Int(y)) => x.partial_cmp(&(*y as f64)),
        (Value::Time(x), Value::Time(y)) => Some(x.cmp(y)),
        (Value::Str(x), Value::Str(y)) => Some(x.as_bytes().cmp(y.as_bytes())),
        (x, y) => return bad(format!("{x:?} against {y:?}")),
    };
    Ok(Typed::bool(match op {
        BinaryOp::Eq => order == Some(Equal),
        BinaryOp::Ne => order != Some(Equal),
        BinaryOp::Lt => order == Some(Less),
        BinaryOp::Le => matches!(order, Some(Less | Equal)),
        BinaryOp::Gt => order == Some(Greater),
        BinaryOp::Ge => matches!(order, Some(Greater | Equal)),
        _ => return bad("not a comparison"),
    }))
}

fn arithmetic(op: BinaryOp, a: &Typed, b: &Typed) -> Run<Typed> {
    if let Some(t) = with_time(op, a, b)? {
        return Ok(t);
    }
    let ty = common(a, b)?.map(|ty| ty.unsigned().unwrap_or(ty));
    let (x, y) = match ty {
        // A literal that does not fit the type of the other operand overflows.
        Some(t) => (a.to(t)?, b.to(t)?),
        None => match (&a.v, &b.v) {
            (Value::Int(_), Value::Int(_)) => (a.v.clone(), b.v.clone()),
            _ => (a.to(Type::Lreal)?, b.to(Type::Lreal)?),
        },
    };
    let v = match (x, y) {
        (Value::Int(x), Value::Int(y)) => {
            let n = whole(op, x, y)?;
            match ty {
                Some(t) => Typed { ty: None, v: Value::Int(n) }.to(t)?,
                None => Value::Int(n),
            }
        }
        (Value::Real(x), Value::Real(y)) => Value::Real(match op {
            BinaryOp::Add => x + y,
            BinaryOp::Sub => x - y,
            BinaryOp::Mul => x * y,
            BinaryOp::Div if y == 0.0 => return Err(NaiveFault::Division),
            BinaryOp::Div => x / y,
            BinaryOp::Pow => libm::powf(x, y),
            _ => return bad("no such operation on REAL"),
        }),
        (Value::Lreal(x), Value::Lreal(y)) => Value::Lreal(match op {
            BinaryOp::Add => x + y,
            BinaryOp::Sub => x - y,
            BinaryOp::Mul => x * y,
            BinaryOp::Div if y == 0.0 => return Err(NaiveFault::Division),
            BinaryOp::Div => x / y,
            BinaryOp::Pow => libm::pow(x, y),
            _ => return bad("no such operation on LREAL"),
        }),
        (x, y) => return bad(format!("{op:?} on {x:?} and {y:?}")),
    };
    Ok(Typed { ty, v })
}

/// Integer arithmetic, before the result is checked against its type.
fn whole(op: BinaryOp, x: i128, y: i128) -> Run<i128> {
    Ok(match op {
        BinaryOp::Add => x + y,
        BinaryOp::Sub => x - y,
        BinaryOp::Mul => x.checked_mul(y).ok_or(NaiveFault::Overflow)?,
        BinaryOp::Div | BinaryOp::Mod if y == 0 => return Err(NaiveFault::Division),
        BinaryOp::Div => x / y,
        BinaryOp::Mod => x % y,
        BinaryOp::Pow => {
            let exponent = u32::try_from(y).map_err(|_| NaiveFault::Overflow)?;
            x.checked_pow(exponent).ok_or(NaiveFault::Overflow)?
        }
        _ => return bad("no such operation on integers"),
    })
}

/// Computes TIME + TIME, TIME - TIME, TIME * number and TIME / number.
fn with_time(op: BinaryOp, a: &Typed, b: &Typed) -> Run<Option<Typed>> {
    let in_bounds = |n: i128| match i64::try_from(n) {
        Ok(t) => Ok(Some(Typed::time(t))),
        Err(_) => Err(NaiveFault::Overflow),
    };
    let scaled = |x: f64| {
        if x.is_nan() || x.abs() >= 9.223_372_036_854_776e18 {
            return Err(NaiveFault::Overflow);
        }
        Ok(Some(Typed::time(x as i64)))
    };
    if let Some(done) = super::moments::sum(op, a, b) {
        return done.map(Some);
    }
    match (op, &a.v, &b.v) {
        (BinaryOp::Add, Value::Time(x), Value::Time(y)) => in_bounds(i128::from(*x) + i128::from(*y)),
        (BinaryOp::Sub, Value::Time(x), Value::Time(y)) => in_bounds(i128::from(*x) - i128::from(*y)),
        (BinaryOp::Mul, Value::Time(t), Value::Int(n)) | (BinaryOp::Mul, Value::Int(n), Value::Time(t)) => {
            in_bounds(n.checked_mul(i128::from(*t)).ok_or(NaiveFault::Overflow)?)
        }
        (BinaryOp::Div, Value::Time(_), Value::Int(0)) => Err(NaiveFault::Division),
        (BinaryOp::Div, Value::Time(t), Value::Int(n)) => in_bounds(i128::from(*t) / n),
        (BinaryOp::Mul, Value::Time(t), Value::Real(x)) | (BinaryOp::Mul, Value::Real(x), Value::Time(t)) => {
            scaled(*t as f64 * f64::from(*x))
        }
        (BinaryOp::Mul, Value::Time(t), Value::Lreal(x))
        | (BinaryOp::Mul, Value::Lreal(x), Value::Time(t)) => scaled(*t as f64 * x),
        (BinaryOp::Div, Value::Time(_), Value::Real(0.0))
        | (BinaryOp::Div, Value::Time(_), Value::Lreal(0.0)) => Err(NaiveFault::Division),
        (BinaryOp::Div, Value::Time(t), Value::Real(x)) => scaled(*t as f64 / f64::from(*x)),
        (BinaryOp::Div, Value::Time(t), Value::Lreal(x)) => scaled(*t as f64 / x),
        _ => Ok(None),
    }
}

/// Computes `-e`.
pub(super) fn negate(a: &Typed) -> Run<Typed> {
    let v = match &a.v {
        Value::Int(n) => match a.ty {
            Some(t) => Typed { ty: None, v: Value::Int(-n) }.to(t)?,
            None => Value::Int(-n),
        },
        Value::Real(x) => Value::Real(-x),
        Value::Lreal(x) => Value::Lreal(-x),
        Value::Time(t) => Value::Time(t.checked_neg().ok_or(NaiveFault::Overflow)?),
        v => return bad(format!("- before {v:?}")),
    };
    Ok(Typed { ty: a.ty, v })
}
