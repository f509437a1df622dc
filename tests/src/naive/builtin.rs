//! The standard functions (decision 19).

use g7_model::{BinaryOp, Moment, Type};

use super::bits;
use super::value::{NaiveFault, Run, Typed, Value, bad, binary, common, cut, negate};

/// Calls a standard function or a conversion by its name, in upper or lower case.
pub(super) fn call(name: &str, args: &[Typed]) -> Run<Typed> {
    let name = name.to_ascii_uppercase();
    if let Some((from, to)) = name.split_once("_TO_")
        && let (Some(from), Some(to)) = (type_named(from), type_named(to))
    {
        return match args {
            [x] => convert(from, to, x),
            _ => bad(format!("{name} takes one argument")),
        };
    }
    if let Some(value) = super::moments::call(&name, args) {
        return value;
    }
    if let [x] = args
        && let Some(value) = bits::decimal(&name, x)
    {
        return value;
    }
    match (&*name, args) {
        ("ABS", [x]) => {
            let zero = Typed { ty: None, v: Value::Int(0) };
            if matches!(x.v, Value::Time(t) if t >= 0) {
                return Ok(x.clone());
            }
            let negative = match x.v {
                Value::Real(r) => r.is_sign_negative(),
                Value::Lreal(r) => r.is_sign_negative(),
                Value::Time(_) => true,
                _ => binary(BinaryOp::Lt, x, &zero)?.truth()?,
            };
            if negative { negate(x) } else { Ok(x.clone()) }
        }
        ("SQRT", [x]) => real(x, libm::sqrtf, libm::sqrt),
        ("LN", [x]) => real(x, libm::logf, libm::log),
        ("LOG", [x]) => real(x, libm::log10f, libm::log10),
        ("EXP", [x]) => real(x, libm::expf, libm::exp),
        ("SIN", [x]) => real(x, libm::sinf, libm::sin),
        ("COS", [x]) => real(x, libm::cosf, libm::cos),
        ("TAN", [x]) => real(x, libm::tanf, libm::tan),
        ("ASIN", [x]) => real(x, libm::asinf, libm::asin),
        ("ACOS", [x]) => real(x, libm::acosf, libm::acos),
        ("ATAN", [x]) => real(x, libm::atanf, libm::atan),
        ("MOVE", [x]) => Ok(x.clone()),
        ("MIN", [first, rest @ ..]) => extreme(BinaryOp::Lt, first, rest),
        ("MAX", [first, rest @ ..]) => extreme(BinaryOp::Gt, first, rest),
        ("LIMIT", [least, x, most]) => {
            let raised = extreme(BinaryOp::Gt, x, std::slice::from_ref(least))?;
            extreme(BinaryOp::Lt, &raised, std::slice::from_ref(most))
        }
        ("SEL", [choice, no, yes]) => {
            alike(if choice.truth()? { yes } else { no }, &[no.clone(), yes.clone()])
        }
        ("MUX", [k, rest @ ..]) => match usize::try_from(k.whole()?).ok().and_then(|k| rest.get(k)) {
            Some(x) => alike(x, rest),
            None => Err(NaiveFault::Index),
        },
        ("NOT", [x]) => bits::complement(x).unwrap_or_else(|| Ok(Typed::bool(!x.truth()?))),
        ("SHL" | "SHR" | "ROL" | "ROR", [bits, by]) => shifted(&name, bits, by),
        ("TRUNC", [x]) => rounded(&truncated(x)?, Type::Dint),
        _ => text(&name, args),
    }
}

/// Moves the bits one place at a time (IEC 61131-3:2003, table 25).
fn shifted(name: &str, bits: &Typed, by: &Typed) -> Run<Typed> {
    let ty = bits.ty.unwrap_or(Type::Udint);
    let Some((0, most)) = ty.bounds() else { return bad(format!("{name} of {ty}")) };
    let by = by.whole()?;
    if by < 0 {
        return Err(NaiveFault::Index);
    }
    let half = (most + 1) / 2;
    let mut v = bits.whole()?;
    // After as many places as there are bits a ring is as it was, and a row is empty.
    let width = i128::from((most + 1).ilog2());
    let places = if name.starts_with('R') { by % width } else { by.min(width) };
    for _ in 0..places {
        v = match name {
            "SHL" => v % half * 2,
            "SHR" => v / 2,
            "ROL" => v % half * 2 + v / half,
            _ => v / 2 + v % 2 * half,
        };
    }
    Ok(Typed::of(ty, Value::Int(v)))
}

fn type_named(name: &str) -> Option<Type> {
    use Type as T;
    let other = T::OTHER_NAMES.into_iter().find(|(other, _)| *other == name).map(|(_, ty)| ty);
    let moments = Moment::ALL.into_iter().map(T::Moment);
    let all = [T::Bool, T::Sint, T::Int, T::Dint, T::Lint, T::Usint, T::Uint, T::Udint, T::Ulint];
    let all = all.into_iter().chain([T::Byte, T::Word, T::Dword, T::Lword]);
    let more = [T::Real, T::Lreal, T::Time, T::String(80)];
    other.or_else(|| all.chain(more).chain(moments).find(|t| t.to_string() == name))
}

fn real(x: &Typed, single: fn(f32) -> f32, double: fn(f64) -> f64) -> Run<Typed> {
    match &x.v {
        Value::Real(r) => Ok(Typed::of(Type::Real, Value::Real(single(*r)))),
        Value::Lreal(r) => Ok(Typed { ty: x.ty, v: Value::Lreal(double(*r)) }),
        Value::Int(n) => Ok(Typed::of(Type::Real, Value::Real(single(*n as f32)))),
        v => bad(format!("a real function of {v:?}")),
    }
}

/// Converts a value to the common type of a list.
fn alike(x: &Typed, all: &[Typed]) -> Run<Typed> {
    // Numbers without a type come last: each need fit only the type that all others have together.
    let (typed, plain): (Vec<&Typed>, Vec<&Typed>) = all.iter().chain([x]).partition(|t| t.ty.is_some());
    let mut ty = None;
    for other in typed.into_iter().chain(plain) {
        ty = common(&Typed { ty: ty.or(other.ty), v: other.v.clone() }, other)?.or(ty);
    }
    match ty {
        Some(ty) => Ok(Typed::of(ty, x.to(ty)?)),
        None => Ok(x.clone()),
    }
}

fn extreme(better: BinaryOp, first: &Typed, rest: &[Typed]) -> Run<Typed> {
    // All are of their common type before they are compared: a number need not fit the narrowest one.
    let all: Vec<Typed> = std::iter::once(first).chain(rest).cloned().collect();
    let mut best = alike(first, &all)?;
    for x in rest {
        let x = alike(x, &all)?;
        if binary(better, &x, &best)?.truth()? {
            best = x;
        }
    }
    Ok(best)
}

fn truncated(x: &Typed) -> Run<f64> {
    match &x.v {
        Value::Real(r) => Ok(libm::trunc(f64::from(*r))),
        Value::Lreal(r) => Ok(libm::trunc(*r)),
        v => bad(format!("TRUNC of {v:?}")),
    }
}

/// Rounds a floating-point number to an integer of a type.
fn rounded(x: &f64, to: Type) -> Run<Typed> {
    if x.is_nan() || x.abs() > 1e30 {
        return Err(NaiveFault::Overflow);
    }
    let whole = Typed { ty: None, v: Value::Int(*x as i128) };
    Ok(Typed::of(to, whole.to(to)?))
}

fn convert(from: Type, to: Type, x: &Typed) -> Run<Typed> {
    let v = x.to(from)?;
    if let Some(done) = super::moments::convert(from, to, &Typed::of(from, v.clone())) {
        return done;
    }
    let done = match (&v, to) {
        (Value::Str(s), _) => return super::literals::read(s, to).unwrap_or_else(|| from_text(s, to)),
        (_, Type::String(n)) => {
            let text = super::literals::written(from, &v).map_or_else(|| as_text(&v), Ok)?;
            Value::Str(cut(&text, usize::from(n)))
        }
        (Value::Int(n), t) if from.is_bits() && t != Type::Bool || t.is_bits() => {
            Value::Int(bits::transferred(*n, t))
        }
        (Value::Bool(b), t) if t.is_integer() || t.is_bits() => Value::Int(i128::from(*b)),
        (Value::Bool(b), Type::Real) => Value::Real(if *b { 1.0 } else { 0.0 }),
        (Value::Bool(b), Type::Lreal) => Value::Lreal(if *b { 1.0 } else { 0.0 }),
        (Value::Int(n), Type::Bool) => Value::Bool(*n != 0),
        (Value::Real(r), Type::Bool) => Value::Bool(*r != 0.0),
        (Value::Lreal(r), Type::Bool) => Value::Bool(*r != 0.0),
        (Value::Real(r), t) if t.is_integer() => return rounded(&libm::rint(f64::from(*r)), t),
        (Value::Lreal(r), t) if t.is_integer() => return rounded(&libm::rint(*r), t),
        (Value::Lreal(r), Type::Real) => Value::Real(*r as f32),
        (Value::Int(_), _) => Typed { ty: None, v: v.clone() }.to(to)?,
        (v, t) => Typed::of(from, v.clone()).to(t)?,
    };
    Ok(Typed::of(to, done))
}

fn as_text(v: &Value) -> Run<String> {
    Ok(match v {
        Value::Bool(b) => if *b { "TRUE" } else { "FALSE" }.to_owned(),
        Value::Int(n) => n.to_string(),
        v => return bad(format!("{v:?} as text")),
    })
}

fn from_text(s: &str, to: Type) -> Run<Typed> {
    match s.trim().parse::<i128>() {
        Ok(n) if to.is_integer() => {
            let v = Typed { ty: None, v: Value::Int(n) }.to(to).map_err(|_| NaiveFault::Index)?;
            Ok(Typed::of(to, v))
        }
        _ if to.is_integer() => Err(NaiveFault::Index),
        _ => bad("a text as this type"),
    }
}

/// Functions of character strings; positions count from 1.
fn text(name: &str, args: &[Typed]) -> Run<Typed> {
    let s = |i: usize| match args.get(i) {
        Some(t) => t.text(),
        None => bad(format!("{name} lacks arguments")),
    };
    let n = |i: usize| match args.get(i).map(Typed::whole) {
        Some(Ok(n)) if n < 0 => Err(NaiveFault::Index),
        Some(Ok(n)) => Ok(usize::try_from(n).unwrap_or(usize::MAX)),
        Some(Err(e)) => Err(e),
        None => bad(format!("{name} lacks arguments")),
    };
    let out = |text: String| Ok(Typed::of(Type::String(u16::MAX), Value::Str(text)));
    let split = |text: &str, at: usize| -> (String, String) {
        let chars: Vec<char> = text.chars().collect();
        let at = at.min(chars.len());
        (chars[..at].iter().collect(), chars[at..].iter().collect())
    };
    match name {
        "LEN" => Ok(Typed::int(s(0)?.chars().count() as i128)),
        "FIND" => {
            let place = s(0)?.find(s(1)?).map_or(0, |b| s(0).map_or(0, |t| t[..b].chars().count() + 1));
            Ok(Typed::int(place as i128))
        }
        "LEFT" => out(split(s(0)?, n(1)?).0),
        "RIGHT" => {
            let length = s(0)?.chars().count();
            out(split(s(0)?, length.saturating_sub(n(1)?)).1)
        }
        "MID" => out(split(&split(s(0)?, n(2)?.saturating_sub(1)).1, n(1)?).0),
        "CONCAT" => {
            let mut all = String::new();
            for i in 0..args.len() {
                all.push_str(s(i)?);
            }
            out(all)
        }
        "INSERT" => {
            let (left, right) = split(s(0)?, n(2)?);
            out(left + s(1)? + &right)
        }
        "DELETE" => {
            let (left, right) = split(s(0)?, n(2)?.saturating_sub(1));
            out(left + &split(&right, n(1)?).1)
        }
        "REPLACE" => {
            let (left, right) = split(s(0)?, n(3)?.saturating_sub(1));
            out(left + s(1)? + &split(&right, n(2)?).1)
        }
        _ => bad(format!("no function {name}")),
    }
}
