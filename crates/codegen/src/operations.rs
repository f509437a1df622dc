//! The operations of the equations on expressions of the code: which operator or
//! helper of the runtime each one is.
//!
//! # Invariants
//!
//! - Both styles and both languages get their operations here.
//! - The operands are expressions of the operation's own type.

use g7_engine::{Arith, Builtin, Cmp, FaultKind, Num};

use crate::tree::{Bin, Expr, Ty, Un};
use crate::vars;

/// An operation on its operands.
pub(crate) enum Made {
    /// An expression that has a value for all operands that reach it.
    Plain(Expr),
    /// A call of a helper whose last parameter takes the fault; it is left out here.
    Checked(String, Vec<Expr>),
}

/// The libraries that an operation needs beside the runtime's helpers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Needs {
    /// Functions of LREAL that C and Rust have from elsewhere.
    pub(crate) math: bool,
    /// A real becomes a text or comes from one.
    pub(crate) real_text: bool,
}

pub(crate) fn is_real(n: Num) -> bool {
    matches!(n, Num::F32 | Num::F64)
}

fn is_signed(n: Num) -> bool {
    matches!(n, Num::I8 | Num::I16 | Num::I32 | Num::I64)
}

fn bits(n: Num) -> u8 {
    match n {
        Num::Bool => 1,
        Num::I8 | Num::U8 => 8,
        Num::I16 | Num::U16 => 16,
        Num::I32 | Num::U32 | Num::F32 => 32,
        Num::I64 | Num::U64 | Num::F64 => 64,
    }
}

/// Every value of the first integer type is one of the second.
fn widens(from: Num, to: Num) -> bool {
    from == to
        || (!is_signed(from) && bits(from) < bits(to))
        || (is_signed(from) && is_signed(to) && bits(from) <= bits(to))
}

/// `i16`, as the names of helpers have it.
pub(crate) fn suffix(n: Num) -> &'static str {
    match n {
        Num::Bool => "bool",
        Num::I8 => "i8",
        Num::I16 => "i16",
        Num::I32 => "i32",
        Num::I64 => "i64",
        Num::U8 => "u8",
        Num::U16 => "u16",
        Num::U32 => "u32",
        Num::U64 => "u64",
        Num::F32 => "f32",
        Num::F64 => "f64",
    }
}

fn named(operation: &str, n: Num) -> String {
    format!("{operation}_{}", suffix(n))
}

/// A literal with its type, where the language would take another one.
pub(crate) fn typed(e: Expr, n: Num) -> Expr {
    match e {
        Expr::Int(v, None) => Expr::Int(v, Some(vars::ty(n))),
        other => other,
    }
}

/// A value of one type as one of another that holds it.
pub(crate) fn cast(e: Expr, from: Num, to: Num) -> Expr {
    match to {
        _ if from == to => e,
        Num::Bool => e.bin(Bin::Ne, Expr::size(0)),
        _ => typed(e, from).cast(vars::ty(to)),
    }
}

/// Minus.
pub(crate) fn negate(n: Num, x: Expr) -> Made {
    if is_real(n) { Made::Plain(minus(x)) } else { Made::Checked(named("neg", n), vec![x]) }
}

/// Minus of a real number, or of an integer whose result has its place.
pub(crate) fn minus(x: Expr) -> Expr {
    Expr::Un(Un::Neg, Box::new(x))
}

/// Arithmetic.
pub(crate) fn arith(op: Arith, n: Num, a: Expr, b: Expr, needs: &mut Needs) -> Made {
    let (name, plain) = match op {
        Arith::Add => ("add", Some(Bin::Add)),
        Arith::Sub => ("sub", Some(Bin::Sub)),
        Arith::Mul => ("mul", Some(Bin::Mul)),
        Arith::Div => ("div", None),
        Arith::Mod => ("rem", None),
        Arith::Pow => ("pow", None),
    };
    match plain.filter(|_| is_real(n)) {
        Some(op) => Made::Plain(a.bin(op, b)),
        None if op == Arith::Pow => {
            needs.math = true;
            Made::Plain(Expr::call(named(name, n), vec![a, b]))
        }
        None => Made::Checked(named(name, n), vec![a, b]),
    }
}

/// Arithmetic whose result has its place in the type: the statements round it see to that.
pub(crate) fn fitting(op: Arith, n: Num, a: Expr, b: Expr) -> Option<Expr> {
    let by_constant = matches!(b, Expr::Int(v, _) if v > 0);
    let op = match op {
        Arith::Add => Bin::Add,
        Arith::Sub => Bin::Sub,
        Arith::Mul => Bin::Mul,
        Arith::Div if is_real(n) || by_constant => Bin::Div,
        Arith::Div | Arith::Mod | Arith::Pow => return None,
    };
    let e = a.bin(op, b);
    // C works in `int` where the type is smaller.
    Some(if bits(n) < 32 { e.cast(vars::ty(n)) } else { e })
}

fn comparison(c: Cmp) -> Bin {
    match c {
        Cmp::Eq => Bin::Eq,
        Cmp::Ne => Bin::Ne,
        Cmp::Lt => Bin::Lt,
        Cmp::Le => Bin::Le,
        Cmp::Gt => Bin::Gt,
        Cmp::Ge => Bin::Ge,
    }
}

/// A comparison of two numbers; known where compilers would warn that it is.
pub(crate) fn compare(c: Cmp, n: Num, x: Expr, y: Expr) -> Expr {
    // NaN is neither greater nor less than itself, and not equal to itself.
    let strict = matches!(c, Cmp::Lt | Cmp::Gt);
    if x == y && (strict || !is_real(n)) && !matches!(x, Expr::Call(..)) {
        return Expr::Bool(matches!(c, Cmp::Eq | Cmp::Le | Cmp::Ge));
    }
    if let (Expr::Int(a, _), Expr::Int(b, _)) = (&x, &y) {
        return Expr::Bool(g7_engine::number::ordered(c, Some(a.cmp(b))));
    }
    let unsigned = !is_signed(n) && !is_real(n);
    // A constant stands on the right, so that it is seen below.
    if matches!(c, Cmp::Eq | Cmp::Ne) && matches!(x, Expr::Bool(_)) && !matches!(y, Expr::Bool(_)) {
        return compare(c, n, y, x);
    }
    match (c, n, &x, &y) {
        (Cmp::Eq, Num::Bool, _, Expr::Bool(true)) | (Cmp::Ne, Num::Bool, _, Expr::Bool(false)) => x,
        (Cmp::Eq, Num::Bool, _, Expr::Bool(false)) | (Cmp::Ne, Num::Bool, _, Expr::Bool(true)) => x.not(),
        (Cmp::Eq | Cmp::Ne, ..) => x.bin(comparison(c), y),
        (_, Num::Bool, ..) => x.cast(Ty::U8).bin(comparison(c), y.cast(Ty::U8)),
        (Cmp::Ge, _, _, Expr::Int(0, _)) if unsigned => Expr::Bool(true),
        (Cmp::Lt, _, _, Expr::Int(0, _)) if unsigned => Expr::Bool(false),
        _ => x.bin(comparison(c), y),
    }
}

/// A comparison of two texts.
pub(crate) fn compare_texts(c: Cmp, x: Expr, y: Expr) -> Expr {
    Expr::call("text_compare", vec![x, y]).bin(comparison(c), Expr::size(0))
}

/// `a != b`, except that NaN equals NaN.
pub(crate) fn differ(n: Num, a: Expr, b: Expr) -> Expr {
    let differs = a.clone().bin(Bin::Ne, b.clone());
    if !is_real(n) {
        return differs;
    }
    let number = |e: Expr| e.clone().bin(Bin::Eq, e);
    differs.and(number(a).bin(Bin::Or, number(b)))
}

/// From one number type to another.
pub(crate) fn convert(from: Num, to: Num, e: Expr) -> Made {
    if from == to {
        return Made::Plain(e);
    }
    if to == Num::Bool {
        let zero = if is_real(from) { vars::literal(from, 0) } else { Expr::size(0) };
        return Made::Plain(e.bin(Bin::Ne, zero));
    }
    match (is_real(from), is_real(to)) {
        (true, true) => Made::Plain(e.cast(vars::ty(to))),
        (true, false) => Made::Checked(named("round", to), vec![wide(from, e)]),
        (false, true) => {
            let e = if from == Num::Bool { e.cast(Ty::U8) } else { typed(e, from) };
            Made::Plain(e.cast(vars::ty(to)))
        }
        (false, false) if widens(from, to) => Made::Plain(typed(e, from).cast(vars::ty(to))),
        (false, false) if from == Num::U64 => Made::Checked(format!("{}_from_u64", suffix(to)), vec![e]),
        (false, false) => Made::Checked(format!("{}_from_i64", suffix(to)), vec![cast(e, from, Num::I64)]),
    }
}

/// Toward zero, from a real to an integer.
pub(crate) fn truncate(from: Num, to: Num, e: Expr) -> Made {
    Made::Checked(named("trunc", to), vec![wide(from, e)])
}

fn wide(n: Num, e: Expr) -> Expr {
    if n == Num::F32 { e.cast(vars::ty(Num::F64)) } else { e }
}

/// A text as a number.
pub(crate) fn read_number(to: Num, text: Expr, needs: &mut Needs) -> Made {
    needs.real_text |= is_real(to);
    Made::Checked(named("text_to", to), vec![text])
}

/// The helper that writes a number as text, and the number as it takes it. A TIME
/// is written as such.
pub(crate) fn write_number(from: Num, time: bool, e: Expr, needs: &mut Needs) -> (String, Expr) {
    needs.real_text |= is_real(from);
    let (name, as_) = match from {
        _ if time => ("time", Num::I64),
        Num::I8 | Num::I16 | Num::I32 | Num::I64 => ("i64", Num::I64),
        Num::U8 | Num::U16 | Num::U32 | Num::U64 => ("u64", Num::U64),
        Num::Bool | Num::F32 | Num::F64 => (suffix(from), from),
    };
    (format!("text_from_{name}"), cast(e, from, as_))
}

/// A function of numbers of one type, but for SEL and MUX.
pub(crate) fn call(f: Builtin, n: Num, mut args: Vec<Expr>, needs: &mut Needs) -> Made {
    match f {
        Builtin::Min | Builtin::Max => {
            let name = named(if f == Builtin::Min { "min" } else { "max" }, n);
            let all = args.into_iter().reduce(|a, b| Expr::call(name.clone(), vec![a, b]));
            Made::Plain(all.unwrap_or(Expr::size(0)))
        }
        Builtin::Limit => {
            let (high, x, low) = (args.pop(), args.pop(), args.pop());
            let (Some(low), Some(x), Some(high)) = (low, x, high) else { return Made::Plain(Expr::size(0)) };
            let above = Expr::call(named("max", n), vec![x, low]);
            Made::Plain(Expr::call(named("min", n), vec![above, high]))
        }
        Builtin::BitAnd | Builtin::BitOr | Builtin::BitXor => {
            let op = match f {
                Builtin::BitAnd => Bin::BitAnd,
                Builtin::BitOr => Bin::BitOr,
                _ => Bin::BitXor,
            };
            let joined = args.into_iter().map(|e| typed(e, n)).reduce(|a, b| a.bin(op, b));
            // C works in `int` where the type is smaller.
            let joined = joined.unwrap_or(Expr::size(0));
            Made::Plain(if bits(n) < 32 { joined.cast(vars::ty(n)) } else { joined })
        }
        _ if f.shifts() => Made::Checked(named(&name(f), n), args),
        Builtin::Abs if is_signed(n) => Made::Checked(named("abs", n), args),
        Builtin::Abs if !is_real(n) => Made::Plain(args.pop().unwrap_or(Expr::size(0))),
        _ => {
            needs.math |= !matches!(f, Builtin::Abs | Builtin::Sqrt);
            let args = args.into_iter().map(|e| wide(n, e)).collect();
            let e = Expr::call(format!("real_{}", name(f)), args);
            Made::Plain(if n == Num::F32 { e.cast(vars::ty(Num::F32)) } else { e })
        }
    }
}

/// The name of a function in those of its helpers.
pub(crate) fn name(f: Builtin) -> String {
    format!("{f:?}").to_lowercase()
}

/// A function that gives a text has a helper that takes the fault of its numbers.
pub(crate) fn text_takes_fault(f: Builtin) -> bool {
    f != Builtin::Concat
}

/// The name of a fault in the code.
pub(crate) fn fault(kind: FaultKind) -> &'static str {
    match kind {
        FaultKind::Unstable { .. } => "FAULT_UNSTABLE",
        FaultKind::Bound | FaultKind::Work => "FAULT_BOUND",
        FaultKind::Overflow => "FAULT_OVERFLOW",
        FaultKind::DivisionByZero => "FAULT_DIVISION",
        FaultKind::Range => "FAULT_RANGE",
        FaultKind::Forcing { .. } => "FAULT_FORCING",
        FaultKind::Table => "FAULT_TABLE",
        FaultKind::Inputs => "FAULT_INPUTS",
        FaultKind::Stopped => "FAULT_STOPPED",
    }
}
