//! Arithmetic on words, with overflow judged in the type of the result.

use crate::fault::FaultKind;
use crate::ops::{Arith, Builtin, Cmp, Num};

/// Smallest and largest value of an integer kind other than ULINT (BOOL counts as 0..1). Most sums and
/// products are those of such kinds, and words of 128 bits cost several times as much.
#[inline(always)]
fn short_bounds(n: Num) -> (i64, i64) {
    match n {
        Num::Bool => (0, 1),
        Num::I8 => (i8::MIN.into(), i8::MAX.into()),
        Num::I16 => (i16::MIN.into(), i16::MAX.into()),
        Num::I32 => (i32::MIN.into(), i32::MAX.into()),
        Num::U8 => (0, u8::MAX.into()),
        Num::U16 => (0, u16::MAX.into()),
        Num::U32 => (0, u32::MAX.into()),
        Num::I64 | Num::U64 | Num::F32 | Num::F64 => (i64::MIN, i64::MAX),
    }
}

/// Smallest and largest value of an integer kind.
fn bounds(n: Num) -> (i128, i128) {
    let (least, most) = short_bounds(n);
    if n == Num::U64 { (0, u64::MAX.into()) } else { (least.into(), most.into()) }
}

/// True if each value of a kind is a value of another one and has the same word there.
pub fn widens(from: Num, to: Num) -> bool {
    let ((least, most), (low, high)) = (bounds(from), bounds(to));
    from == to || !is_real(from) && !is_real(to) && low <= least && most <= high
}

/// The number that a word of an integer kind stands for.
fn whole(n: Num, v: u64) -> i128 {
    match n {
        Num::Bool | Num::U8 | Num::U16 | Num::U32 | Num::U64 => i128::from(v),
        Num::I8 | Num::I16 | Num::I32 | Num::I64 | Num::F32 | Num::F64 => i128::from(v as i64),
    }
}

fn fit(n: Num, v: i128) -> Result<u64, FaultKind> {
    let (least, most) = bounds(n);
    if v < least || v > most { Err(FaultKind::Overflow) } else { Ok(v as u64) }
}

/// [`fit`] for a kind other than ULINT.
#[inline(always)]
fn fit_short(n: Num, v: i64) -> Result<u64, FaultKind> {
    let (least, most) = short_bounds(n);
    if v < least || v > most { Err(FaultKind::Overflow) } else { Ok(v as u64) }
}

/// The number that a word of a real kind stands for. LREAL holds every REAL exactly.
pub(crate) fn real(n: Num, v: u64) -> f64 {
    if n == Num::F32 { f64::from(f32::from_bits(v as u32)) } else { f64::from_bits(v) }
}

pub(crate) fn from_real(n: Num, v: f64) -> u64 {
    if n == Num::F32 { u64::from((v as f32).to_bits()) } else { v.to_bits() }
}

fn is_real(n: Num) -> bool {
    matches!(n, Num::F32 | Num::F64)
}

/// Compares two words of a kind; NaN is only unequal.
#[inline]
pub fn compare(c: Cmp, n: Num, a: u64, b: u64) -> bool {
    match n {
        Num::F64 => is(c, f64::from_bits(a), f64::from_bits(b)),
        Num::F32 => is(c, f32::from_bits(a as u32), f32::from_bits(b as u32)),
        Num::I8 | Num::I16 | Num::I32 | Num::I64 => is(c, a as i64, b as i64),
        Num::Bool | Num::U8 | Num::U16 | Num::U32 | Num::U64 => is(c, a, b),
    }
}

#[inline(always)]
fn is<T: PartialOrd>(c: Cmp, a: T, b: T) -> bool {
    match c {
        Cmp::Eq => a == b,
        Cmp::Ne => a != b,
        Cmp::Lt => a < b,
        Cmp::Le => a <= b,
        Cmp::Gt => a > b,
        Cmp::Ge => a >= b,
    }
}

/// LIMIT, which the standard defines as `MIN(MAX(v, least), most)`.
#[inline]
pub fn limit(n: Num, least: u64, v: u64, most: u64) -> u64 {
    let low = if compare(Cmp::Lt, n, v, least) { least } else { v };
    if compare(Cmp::Lt, n, most, low) { most } else { low }
}

/// True if a comparison is true. `None` stands for operands of which one is NaN; then
/// only `<>` is true.
pub fn ordered(c: Cmp, order: Option<core::cmp::Ordering>) -> bool {
    let Some(o) = order else { return c == Cmp::Ne };
    match c {
        Cmp::Eq => o.is_eq(),
        Cmp::Ne => o.is_ne(),
        Cmp::Lt => o.is_lt(),
        Cmp::Le => o.is_le(),
        Cmp::Gt => o.is_gt(),
        Cmp::Ge => o.is_ge(),
    }
}

/// Minus.
///
/// # Errors
///
/// Overflow.
pub fn negate(n: Num, v: u64) -> Result<u64, FaultKind> {
    if is_real(n) { Ok(from_real(n, -real(n, v))) } else { fit(n, -whole(n, v)) }
}

/// Arithmetic between two words of 64 bits, both signed or both unsigned.
macro_rules! arith_64 {
    ($op:expr, $x:expr, $y:expr) => {{
        let (x, y) = ($x, $y);
        let v = match $op {
            Arith::Add => x.checked_add(y),
            Arith::Sub => x.checked_sub(y),
            Arith::Mul => x.checked_mul(y),
            Arith::Div | Arith::Mod if y == 0 => return Err(FaultKind::DivisionByZero),
            Arith::Div => x.checked_div(y),
            // The remainder of the least number by -1 is 0, though the quotient is too large.
            Arith::Mod => Some(x.wrapping_rem(y)),
            Arith::Pow => return Err(FaultKind::Range),
        };
        v.ok_or(FaultKind::Overflow)
    }};
}

/// Arithmetic between two words of a kind.
///
/// # Errors
///
/// Overflow, division by zero.
pub fn arith(op: Arith, n: Num, a: u64, b: u64) -> Result<u64, FaultKind> {
    match n {
        Num::F32 => arith_f32(op, f32::from_bits(a as u32), f32::from_bits(b as u32)),
        Num::F64 => arith_f64(op, f64::from_bits(a), f64::from_bits(b)),
        Num::U64 => arith_64!(op, a, b),
        Num::Bool | Num::I8 | Num::I16 | Num::I32 | Num::I64 | Num::U8 | Num::U16 | Num::U32 => {
            let v: Result<i64, FaultKind> = arith_64!(op, a as i64, b as i64);
            fit_short(n, v?)
        }
    }
}

fn arith_f32(op: Arith, a: f32, b: f32) -> Result<u64, FaultKind> {
    let v = match op {
        Arith::Add => a + b,
        Arith::Sub => a - b,
        Arith::Mul => a * b,
        Arith::Div | Arith::Mod if b == 0.0 => return Err(FaultKind::DivisionByZero),
        Arith::Div => a / b,
        Arith::Mod => libm::fmodf(a, b),
        Arith::Pow => libm::powf(a, b),
    };
    Ok(u64::from(v.to_bits()))
}

fn arith_f64(op: Arith, a: f64, b: f64) -> Result<u64, FaultKind> {
    let v = match op {
        Arith::Add => a + b,
        Arith::Sub => a - b,
        Arith::Mul => a * b,
        Arith::Div | Arith::Mod if b == 0.0 => return Err(FaultKind::DivisionByZero),
        Arith::Div => a / b,
        Arith::Mod => libm::fmod(a, b),
        Arith::Pow => libm::pow(a, b),
    };
    Ok(v.to_bits())
}

/// Converts to another kind; reals are rounded half to even (IEC 61131-3:2003, 2.5.1.5.1).
pub fn convert(from: Num, to: Num, v: u64) -> Result<u64, FaultKind> {
    if to == Num::Bool {
        let truth = if is_real(from) { real(from, v) != 0.0 } else { v != 0 };
        return Ok(u64::from(truth));
    }
    match (is_real(from), is_real(to)) {
        (true, true) => Ok(from_real(to, real(from, v))),
        (true, false) => to_whole(to, libm::rint(real(from, v))),
        (false, true) => {
            let x = whole(from, v);
            // It is rounded once, to the width of the result: twice could give another value.
            Ok(if to == Num::F32 { u64::from((x as f32).to_bits()) } else { (x as f64).to_bits() })
        }
        (false, false) if from == Num::U64 || to == Num::U64 => fit(to, whole(from, v)),
        (false, false) => fit_short(to, v as i64),
    }
}

/// Toward zero, from a real kind to an integer kind.
///
/// # Errors
///
/// Overflow, of NaN as well.
pub fn truncate(from: Num, to: Num, v: u64) -> Result<u64, FaultKind> {
    to_whole(to, libm::trunc(real(from, v)))
}

fn to_whole(to: Num, x: f64) -> Result<u64, FaultKind> {
    // A larger f64 fits no kind, and NaN fails this comparison too.
    if x.abs() < 1e30 { fit(to, x as i128) } else { Err(FaultKind::Overflow) }
}

/// Calls a function of numbers; `args` are in the order of the call.
pub fn call(f: Builtin, n: Num, args: &[u64]) -> Result<u64, FaultKind> {
    let arg = |i: usize| args.get(i).copied().unwrap_or(0);
    let less = |a: u64, b: u64| compare(Cmp::Lt, n, a, b);
    let on_real = |f64: fn(f64) -> f64| Ok(from_real(n, f64(real(n, arg(0)))));
    match f {
        Builtin::Abs if is_real(n) => Ok(from_real(n, real(n, arg(0)).abs())),
        Builtin::Abs => fit(n, whole(n, arg(0)).abs()),
        Builtin::Sqrt => on_real(libm::sqrt),
        Builtin::Ln => on_real(libm::log),
        Builtin::Log => on_real(libm::log10),
        Builtin::Exp => on_real(libm::exp),
        Builtin::Sin => on_real(libm::sin),
        Builtin::Cos => on_real(libm::cos),
        Builtin::Tan => on_real(libm::tan),
        Builtin::Asin => on_real(libm::asin),
        Builtin::Acos => on_real(libm::acos),
        Builtin::Atan => on_real(libm::atan),
        Builtin::Min => Ok(args.iter().copied().reduce(|a, b| if less(b, a) { b } else { a }).unwrap_or(0)),
        Builtin::Max => Ok(args.iter().copied().reduce(|a, b| if less(a, b) { b } else { a }).unwrap_or(0)),
        Builtin::Limit => Ok(limit(n, arg(0), arg(1), arg(2))),
        Builtin::Sel => Ok(if arg(0) == 0 { arg(1) } else { arg(2) }),
        Builtin::Mux => {
            let k = usize::try_from(arg(0) as i64).map_err(|_| FaultKind::Range)?;
            args.get(1..).unwrap_or(&[]).get(k).copied().ok_or(FaultKind::Range)
        }
        Builtin::Shl | Builtin::Shr | Builtin::Rol | Builtin::Ror => shift(f, n, arg(0), arg(1) as i64),
        Builtin::BitAnd => Ok(arg(0) & arg(1)),
        Builtin::BitOr => Ok(arg(0) | arg(1)),
        Builtin::BitXor => Ok(arg(0) ^ arg(1)),
        Builtin::Transfer => Ok(transfer(n, arg(0))),
        Builtin::Len
        | Builtin::Left
        | Builtin::Right
        | Builtin::Mid
        | Builtin::Concat
        | Builtin::Insert
        | Builtin::Delete
        | Builtin::Replace
        | Builtin::Find => Err(FaultKind::Range),
    }
}

/// The bits of an unsigned kind.
fn width(n: Num) -> Option<u32> {
    match n {
        Num::U8 => Some(8),
        Num::U16 => Some(16),
        Num::U32 => Some(32),
        Num::U64 => Some(64),
        Num::Bool | Num::I8 | Num::I16 | Num::I32 | Num::I64 | Num::F32 | Num::F64 => None,
    }
}

/// The lowest bits of a whole number, as a word of the kind (IEC 61131-3:2013, 6.6.2.5.2, binary
/// transfer).
fn transfer(n: Num, v: u64) -> u64 {
    match n {
        Num::Bool => u64::from(v != 0),
        Num::I8 => i64::from(v as i8) as u64,
        Num::I16 => i64::from(v as i16) as u64,
        Num::I32 => i64::from(v as i32) as u64,
        Num::U8 => u64::from(v as u8),
        Num::U16 => u64::from(v as u16),
        Num::U32 => u64::from(v as u32),
        Num::I64 | Num::U64 | Num::F32 | Num::F64 => v,
    }
}

/// SHL, SHR, ROL and ROR (IEC 61131-3:2003, table 25). A shift by the width and more leaves no
/// bit; a rotation counts modulo the width.
fn shift(f: Builtin, n: Num, v: u64, by: i64) -> Result<u64, FaultKind> {
    let (Some(width), Ok(by)) = (width(n), u64::try_from(by)) else { return Err(FaultKind::Range) };
    let all = u64::MAX >> (64 - width);
    let bits = u32::try_from(by).unwrap_or(u32::MAX);
    let left = match f {
        Builtin::Shl => return Ok(v.checked_shl(bits).unwrap_or(0) & all),
        Builtin::Shr => return Ok(v.checked_shr(bits).unwrap_or(0)),
        Builtin::Rol => (by % u64::from(width)) as u32,
        _ => (width - (by % u64::from(width)) as u32) % width,
    };
    // A shift by 64 has no meaning for a word.
    Ok(((v << left) | v.checked_shr(width - left).unwrap_or(0)) & all)
}

/// The step by which a generator's word grows for each random number.
pub const RANDOM_STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// The random number (F64, at least 0 and below 1) of a generator's word:
/// splitmix64 (Steele, Lea, Flood 2014); any first word will do.
pub fn random(word: u64) -> u64 {
    let mut z = word;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^= z >> 31;
    ((z >> 11) as f64 / (1u64 << 53) as f64).to_bits()
}
