//! Dates and times of day, from the rules (IEC 61131-3:2003, tables 22 and 30; 2013, table 36; decision 65).

use g7_model::{BinaryOp, Moment, Type};

use super::value::{NaiveFault, Run, Typed, Value};

const SECOND: i128 = 1_000_000_000;
const DAY: i128 = 24 * 60 * 60 * SECOND;

/// A value of a type of dates, if it has this one.
fn of(moment: Moment, nanos: i128) -> Run<Typed> {
    let nanos = if moment == Moment::Date { nanos - nanos.rem_euclid(DAY) } else { nanos };
    if moment == Moment::Tod && !(0..DAY).contains(&nanos) {
        return Err(NaiveFault::Index);
    }
    time(Type::Moment(moment), nanos)
}

fn time(ty: Type, nanos: i128) -> Run<Typed> {
    i64::try_from(nanos).map(|t| Typed::of(ty, Value::Time(t))).map_err(|_| NaiveFault::Overflow)
}

/// A sum or a difference, if an operand is a date or a time of day.
pub(super) fn sum(op: BinaryOp, a: &Typed, b: &Typed) -> Option<Run<Typed>> {
    let (Value::Time(x), Value::Time(y)) = (&a.v, &b.v) else { return None };
    let (x, y) = (i128::from(*x), i128::from(*y));
    match (op, a.ty?, b.ty?) {
        (BinaryOp::Sub, Type::Moment(_), Type::Moment(_)) => Some(time(Type::Time, x - y)),
        (BinaryOp::Add, Type::Moment(moment), Type::Time) => {
            Some(time(Type::Time, x + y).and_then(|_| of(moment, x + y)))
        }
        (BinaryOp::Sub, Type::Moment(moment), Type::Time) => {
            Some(time(Type::Time, x - y).and_then(|_| of(moment, x - y)))
        }
        _ => None,
    }
}

/// A conversion from or to a date or a time of day.
pub(super) fn convert(from: Type, to: Type, x: &Typed) -> Option<Run<Typed>> {
    let unit = |moment: Moment| if moment == Moment::Tod { SECOND / 1000 } else { SECOND };
    match (from, to, &x.v) {
        (Type::Moment(Moment::Dt), Type::Moment(Moment::Tod), Value::Time(t)) => {
            Some(of(Moment::Tod, i128::from(*t).rem_euclid(DAY)))
        }
        (Type::Moment(_), Type::Moment(moment), Value::Time(t)) => Some(of(moment, i128::from(*t))),
        (Type::Moment(moment), to, Value::Time(t)) if to.is_integer() => {
            let whole = Typed { ty: None, v: Value::Int(i128::from(*t) / unit(moment)) };
            Some(whole.to(to).map(|v| Typed::of(to, v)))
        }
        (from, Type::Moment(moment), Value::Int(n)) if from.is_integer() => {
            let nanos = n.checked_mul(unit(moment)).ok_or(NaiveFault::Overflow);
            Some(nanos.and_then(|nanos| time(Type::Time, nanos).and_then(|_| of(moment, nanos))))
        }
        _ => None,
    }
}

/// DAY_OF_WEEK, found by walking week by week from a Sunday, and CONCAT_DATE_TOD.
pub(super) fn call(name: &str, args: &[Typed]) -> Option<Run<Typed>> {
    match (name, args) {
        ("DAY_OF_WEEK", [Typed { v: Value::Time(t), .. }]) => {
            // 1970-01-04 was a Sunday.
            let mut days = i128::from(*t) / DAY - 3;
            while days < 0 {
                days += 7;
            }
            while days > 6 {
                days -= 7;
            }
            Some(Ok(Typed::int(days)))
        }
        ("CONCAT_DATE_TOD", [Typed { v: Value::Time(day), .. }, Typed { v: Value::Time(t), .. }]) => {
            Some(time(Type::Moment(Moment::Dt), i128::from(*day) + i128::from(*t)))
        }
        _ => None,
    }
}
