//! Arithmetic, comparison and conversion of every kind of number
//! (IEC 61131-3:2003, 2.5.1.5): one instruction on constants, and what it leaves.

use crate::common;

use common::chart;
use g7_engine::{Arith, Builtin, Cmp, Code, FaultKind, Num, Op, Program, Rules, State, eval};

/// The result of an instruction on these operands.
fn done(operands: &[u64], op: Op) -> Result<u64, FaultKind> {
    let mut t = chart(Rules::IEC61131, 1, 0, &[0], &[]);
    t.code = operands.iter().map(|v| Op::Push(*v)).chain([op]).collect();
    let code = Code { start: 0, end: t.code.len() as u32 };
    t.post = Code::default();
    let p = Program::new(t).expect("tables are sound");
    let mut s = State::new(&p);
    eval(&p, &mut s, code).map_err(|f| f.kind)
}

const OVERFLOW: Result<u64, FaultKind> = Err(FaultKind::Overflow);
const BY_ZERO: Result<u64, FaultKind> = Err(FaultKind::DivisionByZero);

fn f32s(op: Op, operands: &[f32]) -> Result<f32, FaultKind> {
    let words: Vec<u64> = operands.iter().map(|v| u64::from(v.to_bits())).collect();
    done(&words, op).map(|w| f32::from_bits(w as u32))
}

fn f64s(op: Op, operands: &[f64]) -> Result<f64, FaultKind> {
    let words: Vec<u64> = operands.iter().map(|v| v.to_bits()).collect();
    done(&words, op).map(f64::from_bits)
}

/// A whole number as a word of any kind: sign- or zero-extended.
fn ints(op: Op, operands: &[i64]) -> Result<i64, FaultKind> {
    let words: Vec<u64> = operands.iter().map(|v| *v as u64).collect();
    done(&words, op).map(|w| w as i64)
}

#[test]
fn reals_of_both_sizes_calculate() {
    use Arith::{Add, Div, Mod, Mul, Pow, Sub};
    let cases = [(Add, 9.5, 2.0, 11.5), (Sub, 9.5, 2.0, 7.5), (Mul, 9.5, 2.0, 19.0), (Div, 9.5, 2.0, 4.75)];
    for (op, a, b, c) in
        cases.into_iter().chain([(Mod, 9.5, 2.0, 1.5), (Mod, -9.5, 2.0, -1.5), (Pow, 3.0, 4.0, 81.0)])
    {
        assert_eq!(f64s(Op::Arith(op, Num::F64), &[a, b]), Ok(c), "{op:?} {a} {b}");
        let (a, b, c) = (a as f32, b as f32, c as f32);
        assert_eq!(f32s(Op::Arith(op, Num::F32), &[a, b]), Ok(c), "{op:?} {a} {b}");
    }
    for op in [Div, Mod] {
        assert_eq!(f64s(Op::Arith(op, Num::F64), &[1.0, 0.0]), Err(FaultKind::DivisionByZero));
        assert_eq!(f32s(Op::Arith(op, Num::F32), &[1.0, 0.0]), Err(FaultKind::DivisionByZero));
    }
    // REAL has 24 bits, LREAL 53: 2^24 + 1 is no REAL.
    assert_eq!(f32s(Op::Arith(Add, Num::F32), &[16_777_216.0, 1.0]), Ok(16_777_216.0));
    assert_eq!(f64s(Op::Arith(Add, Num::F64), &[16_777_216.0, 1.0]), Ok(16_777_217.0));
    for n in [-2.5, 2.5] {
        assert_eq!(f64s(Op::Neg(Num::F64), &[n]), Ok(-n));
        assert_eq!(f32s(Op::Neg(Num::F32), &[n as f32]), Ok(-n as f32));
    }
}

#[test]
fn whole_numbers_calculate_within_their_kind() {
    use Arith::{Add, Div, Mod, Mul, Sub};
    for n in [Num::I8, Num::I16, Num::I32, Num::I64] {
        for (op, a, b, c) in [
            (Add, 7, -2, 5),
            (Sub, 7, -2, 9),
            (Mul, 7, -2, -14),
            (Div, -7, 2, -3),
            (Mod, -7, 2, -1),
            (Mod, 7, -2, 1),
        ] {
            assert_eq!(ints(Op::Arith(op, n), &[a, b]), Ok(c), "{op:?} {n:?} {a} {b}");
        }
        assert_eq!(ints(Op::Neg(n), &[5]), Ok(-5));
        for op in [Div, Mod] {
            assert_eq!(done(&[1, 0], Op::Arith(op, n)), BY_ZERO);
        }
    }
    // The ends of every kind, and one beyond.
    for (n, low, high) in [
        (Num::I8, i128::from(i8::MIN), i128::from(i8::MAX)),
        (Num::I16, i128::from(i16::MIN), i128::from(i16::MAX)),
        (Num::I32, i128::from(i32::MIN), i128::from(i32::MAX)),
        (Num::I64, i128::from(i64::MIN), i128::from(i64::MAX)),
        (Num::U8, 0, i128::from(u8::MAX)),
        (Num::U16, 0, i128::from(u16::MAX)),
        (Num::U32, 0, i128::from(u32::MAX)),
        (Num::U64, 0, i128::from(u64::MAX)),
    ] {
        let word = |v: i128| v as u64;
        // Each operation between the ends and what lies beside them and beside 0, in numbers without an end.
        let near = [low, low + 1, low / 2, -2, -1, 0, 1, 2, high / 2, high / 2 + 1, high - 1, high];
        let near = || near.into_iter().filter(|v| (low..=high).contains(v));
        for (a, b) in near().flat_map(|a| near().map(move |b| (a, b))) {
            for (op, exact) in [
                (Add, Some(a + b)),
                (Sub, Some(a - b)),
                (Mul, a.checked_mul(b)),
                (Div, a.checked_div(b)),
                (Mod, a.checked_rem(b)),
            ] {
                let wanted = match exact {
                    Some(v) if (low..=high).contains(&v) => Ok(word(v)),
                    None if b == 0 => BY_ZERO,
                    _ => OVERFLOW,
                };
                assert_eq!(done(&[word(a), word(b)], Op::Arith(op, n)), wanted, "{a} {op:?} {b} as {n:?}");
            }
        }
        assert_eq!(done(&[word(high - 1), 1], Op::Arith(Add, n)), Ok(word(high)), "{n:?}");
        assert_eq!(done(&[word(high), 1], Op::Arith(Add, n)), OVERFLOW, "{n:?}");
        assert_eq!(done(&[word(low + 1), 1], Op::Arith(Sub, n)), Ok(word(low)), "{n:?}");
        assert_eq!(done(&[word(low), 1], Op::Arith(Sub, n)), OVERFLOW, "{n:?}");
        assert_eq!(done(&[word(high), word(high)], Op::Arith(Mul, n)), OVERFLOW, "{n:?}");
        assert_eq!(done(&[word(low)], Op::Neg(n)), if low == 0 { Ok(0) } else { OVERFLOW }, "{n:?}");
        assert_eq!(done(&[word(low)], Op::Call(Builtin::Abs, n, 1)), if low == 0 { Ok(0) } else { OVERFLOW });
    }
}

#[test]
fn numbers_compare_by_their_kind() {
    use Cmp::{Eq, Ge, Gt, Le, Lt, Ne};
    let table =
        |a: u64, b: u64, n: Num| [Eq, Ne, Lt, Le, Gt, Ge].map(|c| done(&[a, b], Op::Compare(c, n)) == Ok(1));
    let (equal, less, more) = (
        [true, false, false, true, false, true],
        [false, true, true, true, false, false],
        [false, true, false, false, true, true],
    );
    for n in [Num::I8, Num::I16, Num::I32, Num::I64] {
        assert_eq!(table(3, 3, n), equal);
        assert_eq!(table(-1i64 as u64, 3, n), less);
        assert_eq!(table(3, -1i64 as u64, n), more);
    }
    for n in [Num::Bool, Num::U8, Num::U16, Num::U32, Num::U64] {
        assert_eq!(table(1, 1, n), equal);
        assert_eq!(table(0, 1, n), less);
        assert_eq!(table(1, 0, n), more);
    }
    assert_eq!(table(u64::MAX, 3, Num::U64), more);
    let (one, two, none) = (1f64.to_bits(), (-2f64).to_bits(), f64::NAN.to_bits());
    assert_eq!(table(one, one, Num::F64), equal);
    assert_eq!(table(two, one, Num::F64), less);
    assert_eq!(table(one, two, Num::F64), more);
    // NaN is unequal to everything, and in no order with it.
    assert_eq!(table(none, none, Num::F64), [false, true, false, false, false, false]);
    let (small, none) = (u64::from((-2f32).to_bits()), u64::from(f32::NAN.to_bits()));
    assert_eq!(table(small, u64::from(1f32.to_bits()), Num::F32), less);
    assert_eq!(table(none, small, Num::F32), [false, true, false, false, false, false]);
}

#[test]
fn conversions_round_to_even_and_refuse_what_does_not_fit() {
    for (x, n) in [(0.5, 0), (1.5, 2), (2.5, 2), (-0.5, 0), (-1.5, -2), (-2.5, -2), (2.4, 2), (-2.6, -3)] {
        assert_eq!(done(&[f64::to_bits(x)], Op::Convert(Num::F64, Num::I16)), Ok(n as i64 as u64), "{x}");
        let bits = u64::from((x as f32).to_bits());
        assert_eq!(done(&[bits], Op::Convert(Num::F32, Num::I32)), Ok(n as i64 as u64), "{x}");
    }
    for (x, n) in [(2.9, 2), (-2.9, -2)] {
        assert_eq!(done(&[f64::to_bits(x)], Op::Trunc(Num::F64, Num::I8)), Ok(n as i64 as u64));
    }
    for x in [128.0, -129.0, 1e29, 1e31, f64::INFINITY, f64::NAN] {
        assert_eq!(done(&[x.to_bits()], Op::Convert(Num::F64, Num::I8)), OVERFLOW, "{x}");
        assert_eq!(done(&[x.to_bits()], Op::Trunc(Num::F64, Num::I8)), OVERFLOW, "{x}");
    }
    // Between whole numbers.
    assert_eq!(ints(Op::Convert(Num::I32, Num::I8), &[-128]), Ok(-128));
    assert_eq!(done(&[-129i64 as u64], Op::Convert(Num::I32, Num::I8)), OVERFLOW);
    assert_eq!(done(&[-1i64 as u64], Op::Convert(Num::I8, Num::U64)), OVERFLOW);
    assert_eq!(done(&[u64::MAX], Op::Convert(Num::U64, Num::I64)), OVERFLOW);
    // To a real, straight to its width: 2^60 + 2^36 + 1 lies just above the middle of two REALs.
    let n = (1u64 << 60) + (1 << 36) + 1;
    assert_eq!(
        done(&[n], Op::Convert(Num::I64, Num::F32)),
        Ok(u64::from(((1u64 << 60) as f32 + 137_438_953_472.0).to_bits()))
    );
    assert_eq!(done(&[-3i64 as u64], Op::Convert(Num::I8, Num::F64)), Ok((-3f64).to_bits()));
    assert_eq!(done(&[u64::from(1.5f32.to_bits())], Op::Convert(Num::F32, Num::F64)), Ok(1.5f64.to_bits()));
    assert_eq!(done(&[0.1f64.to_bits()], Op::Convert(Num::F64, Num::F32)), Ok(u64::from(0.1f32.to_bits())));
    // To BOOL: whatever is not zero is true.
    for (v, kind, truth) in [
        (0, Num::I16, 0),
        (2, Num::I16, 1),
        (0f64.to_bits(), Num::F64, 0),
        ((-0f64).to_bits(), Num::F64, 0),
        (0.5f64.to_bits(), Num::F64, 1),
        (u64::from((-0f32).to_bits()), Num::F32, 0),
    ] {
        assert_eq!(done(&[v], Op::Convert(kind, Num::Bool)), Ok(truth), "{v} {kind:?}");
    }
}

#[test]
fn functions_of_numbers() {
    let call = |f, kind, args: &[i64]| ints(Op::Call(f, kind, args.len() as u8), args);
    assert_eq!(call(Builtin::Abs, Num::I16, &[-5]), Ok(5));
    assert_eq!(call(Builtin::Min, Num::I16, &[3, -5, 4]), Ok(-5));
    assert_eq!(call(Builtin::Max, Num::I16, &[3, -5, 4]), Ok(4));
    for (x, limited) in [(-9, -2), (1, 1), (9, 5)] {
        assert_eq!(call(Builtin::Limit, Num::I16, &[-2, x, 5]), Ok(limited));
    }
    // Bounds the wrong way round: MIN(MAX(in, mn), mx), so the upper bound wins.
    assert_eq!(call(Builtin::Limit, Num::I16, &[5, 1, -2]), Ok(-2));
    assert_eq!(call(Builtin::Sel, Num::I16, &[0, 7, 8]), Ok(7));
    assert_eq!(call(Builtin::Sel, Num::I16, &[1, 7, 8]), Ok(8));
    assert_eq!(call(Builtin::Mux, Num::I16, &[1, 7, 8]), Ok(8));
    for k in [-1, 2] {
        assert_eq!(call(Builtin::Mux, Num::I16, &[k, 7, 8]).err(), Some(FaultKind::Range));
    }
    for (f, by, bits) in [
        (Builtin::Shl, 3, 0b1011_0000),
        (Builtin::Shr, 3, 0b0001_0010),
        (Builtin::Rol, 3, 0b1011_0100),
        (Builtin::Ror, 3, 0b1101_0010),
        (Builtin::Shl, 8, 0),
        (Builtin::Shr, i64::MAX, 0),
        (Builtin::Rol, 8, 0b1001_0110),
        (Builtin::Ror, 0, 0b1001_0110),
    ] {
        assert_eq!(call(f, Num::U8, &[0b1001_0110, by]), Ok(bits), "{f:?} {by}");
        assert_eq!(call(f, Num::U8, &[1, -1]).err(), Some(FaultKind::Range));
        assert_eq!(call(f, Num::I8, &[1, 1]).err(), Some(FaultKind::Range), "no bit string");
    }
    assert_eq!(call(Builtin::Ror, Num::U64, &[1, 1]), Ok(i64::MIN));
    assert_eq!(
        (call(Builtin::Shr, Num::U64, &[-1, 63]), call(Builtin::Shl, Num::U64, &[1, 64])),
        (Ok(1), Ok(0))
    );
    let real = |f, x: f64| f64s(Op::Call(f, Num::F64, 1), &[x]).expect("no fault");
    let single = |f, x: f32| f32s(Op::Call(f, Num::F32, 1), &[x]).expect("no fault");
    assert_eq!((real(Builtin::Abs, -2.5), single(Builtin::Abs, -2.5)), (2.5, 2.5));
    assert_eq!((real(Builtin::Sqrt, 6.25), single(Builtin::Sqrt, 6.25)), (2.5, 2.5));
    let about = |f, x, y: f64| assert!((real(f, x) - y).abs() < 1e-12, "{f:?} {x}: {}", real(f, x));
    about(Builtin::Ln, 1.0, 0.0);
    about(Builtin::Log, 1000.0, 3.0);
    about(Builtin::Exp, 1.0, std::f64::consts::E);
    about(Builtin::Sin, std::f64::consts::FRAC_PI_6, 0.5);
    about(Builtin::Cos, std::f64::consts::FRAC_PI_3, 0.5);
    about(Builtin::Tan, std::f64::consts::FRAC_PI_4, 1.0);
    about(Builtin::Asin, 1.0, std::f64::consts::FRAC_PI_2);
    about(Builtin::Acos, 0.0, std::f64::consts::FRAC_PI_2);
    about(Builtin::Atan, 1.0, std::f64::consts::FRAC_PI_4);
    // A string function has no number to give.
    assert_eq!(call(Builtin::Len, Num::I16, &[1]).err(), Some(FaultKind::Range));
}
