//! Arithmetic on constants, with the overflow rules of the engine.
//!
//! Untyped literals are computed in `i128` and `f64` and take a type when they meet one. Typed
//! constants are computed in their type.

use g7_model::Type;

use crate::ir::{BinaryOp, Value};

/// Why a constant expression has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// Beyond the type.
    Overflow,
    /// Division or remainder by zero.
    Division,
}

/// The result; `None` if it is left to the run.
type Folded = Result<Option<Value>, Fault>;

/// Applies an operator to two untyped literals. The flag is true if the result is untyped too.
pub(super) fn literals(op: BinaryOp, a: &Value, b: &Value) -> Result<Option<(Value, bool)>, Fault> {
    let compared = |o: Option<std::cmp::Ordering>| Ok(compare(op, o).map(|b| (Value::Bool(b), false)));
    match (a, b) {
        (Value::Int(x), Value::Int(y)) if op == BinaryOp::Pow => {
            Ok(Some((Value::Real((*x as f64).powf(*y as f64)), true)))
        }
        (Value::Int(x), Value::Int(y)) => match whole(op, *x, *y)? {
            Some(v) => Ok(Some((Value::Int(v), true))),
            None => compared(Some(x.cmp(y))),
        },
        (Value::Real(_) | Value::Int(_), Value::Real(_) | Value::Int(_)) => {
            let (x, y) = (as_real(a), as_real(b));
            match real(op, x, y)? {
                Some(v) => Ok(Some((Value::Real(v), true))),
                None => compared(x.partial_cmp(&y)),
            }
        }
        _ => Ok(None),
    }
}

/// Applies an operator to two constants of one type.
pub(super) fn binary(op: BinaryOp, ty: Type, a: &Value, b: &Value) -> Folded {
    match (a, b) {
        (Value::Bool(x), Value::Bool(y)) => Ok(match op {
            BinaryOp::Or => Some(Value::Bool(x | y)),
            BinaryOp::And => Some(Value::Bool(x & y)),
            BinaryOp::Xor => Some(Value::Bool(x ^ y)),
            _ => compare(op, Some(x.cmp(y))).map(Value::Bool),
        }),
        (Value::Str(x), Value::Str(y)) => {
            Ok(compare(op, Some(x.as_bytes().cmp(y.as_bytes()))).map(Value::Bool))
        }
        (Value::Int(x), Value::Int(y)) => match whole(op, *x, *y)? {
            Some(v) => fit(ty, v).map(|v| Some(Value::Int(v))),
            None => Ok(compare(op, Some(x.cmp(y))).map(Value::Bool)),
        },
        (Value::Real(x), Value::Real(y)) => match real(op, *x, *y)? {
            Some(v) => {
                let v = narrow(ty, v);
                Ok(v.is_finite().then_some(Value::Real(v)))
            }
            None => Ok(compare(op, x.partial_cmp(y)).map(Value::Bool)),
        },
        _ => Ok(None),
    }
}

/// Multiplies or divides a TIME by a number.
pub(super) fn scaled(op: BinaryOp, time: &Value, by: &Value) -> Folded {
    match (time, by) {
        (Value::Int(_), Value::Int(_)) => binary(op, Type::Lint, time, by),
        // Rounding is done by the engine only.
        (Value::Int(_), Value::Real(0.0)) if op == BinaryOp::Div => Err(Fault::Division),
        _ => Ok(None),
    }
}

/// Minus, in the type.
pub(super) fn negate(ty: Type, v: &Value) -> Folded {
    match v {
        Value::Int(n) => fit(ty, -n).map(|n| Some(Value::Int(n))),
        Value::Real(x) => Ok(Some(Value::Real(-x))),
        Value::Bool(_) | Value::Str(_) => Ok(None),
    }
}

/// Converts a constant as the engine converts values.
pub(super) fn convert(v: &Value, to: Type) -> Folded {
    match (v, to) {
        (Value::Bool(_), Type::Bool) | (Value::Str(_), Type::String(_)) => Ok(Some(v.clone())),
        (Value::Bool(b), _) if to.is_integer() || to.is_bits() => Ok(Some(Value::Int(i128::from(*b)))),
        (Value::Bool(b), Type::Real | Type::Lreal) => Ok(Some(Value::Real(f64::from(u8::from(*b))))),
        (Value::Int(n), Type::Bool) => Ok(Some(Value::Bool(*n != 0))),
        (Value::Real(x), Type::Bool) => Ok(Some(Value::Bool(*x != 0.0))),
        (Value::Int(n), Type::Real) => Ok(Some(Value::Real(f64::from(*n as f32)))),
        (Value::Int(n), Type::Lreal) => Ok(Some(Value::Real(*n as f64))),
        (Value::Real(x), Type::Real | Type::Lreal) => {
            let x = narrow(to, *x);
            Ok(x.is_finite().then_some(Value::Real(x)))
        }
        (Value::Int(n), _) if to.is_integer() || to.stored() == Type::Time => {
            fit(to, *n).map(|n| Some(Value::Int(n)))
        }
        (Value::Real(x), _) if to.is_integer() || to == Type::Time => real_to_whole(x.round_ties_even(), to),
        _ => Ok(None),
    }
}

/// Toward zero.
pub(super) fn truncate(v: &Value, to: Type) -> Folded {
    match v {
        Value::Real(x) => real_to_whole(x.trunc(), to),
        Value::Int(n) => fit(to, *n).map(|n| Some(Value::Int(n))),
        Value::Bool(_) | Value::Str(_) => Ok(None),
    }
}

fn real_to_whole(x: f64, to: Type) -> Folded {
    if x.abs() < 1e30 { fit(to, x as i128).map(|n| Some(Value::Int(n))) } else { Err(Fault::Overflow) }
}

/// True if a type holds the whole number.
pub(super) fn fit(ty: Type, v: i128) -> Result<i128, Fault> {
    let (least, most) = match ty {
        Type::Time | Type::Moment(_) => (i64::MIN.into(), i64::MAX.into()),
        _ => ty.bounds().unwrap_or((i128::MIN, i128::MAX)),
    };
    if v < least || v > most { Err(Fault::Overflow) } else { Ok(v) }
}

/// The lowest bits of a whole number, as a value of the type.
pub(super) fn transferred(n: i128, to: Type) -> i128 {
    let Some((least, most)) = to.bounds() else { return n };
    let count = most - least + 1;
    (n - least).rem_euclid(count) + least
}

/// REAL keeps 32 bits.
pub(super) fn narrow(ty: Type, x: f64) -> f64 {
    if ty == Type::Real { f64::from(x as f32) } else { x }
}

fn as_real(v: &Value) -> f64 {
    match v {
        Value::Int(n) => *n as f64,
        Value::Real(x) => *x,
        Value::Bool(_) | Value::Str(_) => 0.0,
    }
}

fn whole(op: BinaryOp, a: i128, b: i128) -> Result<Option<i128>, Fault> {
    let result = match op {
        BinaryOp::Add => a.checked_add(b),
        BinaryOp::Sub => a.checked_sub(b),
        BinaryOp::Mul => a.checked_mul(b),
        BinaryOp::Div | BinaryOp::Mod if b == 0 => return Err(Fault::Division),
        BinaryOp::Div => a.checked_div(b),
        BinaryOp::Mod => a.checked_rem(b),
        BinaryOp::Or
        | BinaryOp::Xor
        | BinaryOp::And
        | BinaryOp::Eq
        | BinaryOp::Ne
        | BinaryOp::Lt
        | BinaryOp::Le
        | BinaryOp::Gt
        | BinaryOp::Ge
        | BinaryOp::Pow => return Ok(None),
    };
    result.map(Some).ok_or(Fault::Overflow)
}

fn real(op: BinaryOp, a: f64, b: f64) -> Result<Option<f64>, Fault> {
    Ok(Some(match op {
        BinaryOp::Add => a + b,
        BinaryOp::Sub => a - b,
        BinaryOp::Mul => a * b,
        BinaryOp::Div if b == 0.0 => return Err(Fault::Division),
        BinaryOp::Div => a / b,
        BinaryOp::Pow => a.powf(b),
        BinaryOp::Or
        | BinaryOp::Xor
        | BinaryOp::And
        | BinaryOp::Eq
        | BinaryOp::Ne
        | BinaryOp::Lt
        | BinaryOp::Le
        | BinaryOp::Gt
        | BinaryOp::Ge
        | BinaryOp::Mod => return Ok(None),
    }))
}

/// Compares two values; "not a number" is unequal to everything.
fn compare(op: BinaryOp, order: Option<std::cmp::Ordering>) -> Option<bool> {
    let holds = |f: fn(std::cmp::Ordering) -> bool| Some(order.is_some_and(f));
    match op {
        BinaryOp::Eq => holds(std::cmp::Ordering::is_eq),
        BinaryOp::Ne => Some(order.is_none_or(std::cmp::Ordering::is_ne)),
        BinaryOp::Lt => holds(std::cmp::Ordering::is_lt),
        BinaryOp::Le => holds(std::cmp::Ordering::is_le),
        BinaryOp::Gt => holds(std::cmp::Ordering::is_gt),
        BinaryOp::Ge => holds(std::cmp::Ordering::is_ge),
        _ => None,
    }
}
