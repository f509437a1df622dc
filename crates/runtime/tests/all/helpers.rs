//! The helpers of printed code: limits of types, rounding, texts, function blocks.

use g7_runtime::arithmetic::{
    Number, abs, add, div, div_real, from_i64, from_u64, max, min, mul, neg, rem, rem_real, rol, ror, round,
    shl, shr, sub, text_from_real, text_to, text_to_real, text_to_u64, trunc,
};
use g7_runtime::faults::{FAULT_DIVISION, FAULT_NONE, FAULT_OVERFLOW, FAULT_RANGE};
use g7_runtime::function_blocks::{
    Ctd, Ctu, Ctud, FTrig, RTrig, Rs, Sr, Tof, Ton, Tp, call_ctd, call_ctu, call_ctud, call_f_trig,
    call_r_trig, call_rs, call_sr, call_tof, call_ton, call_tp,
};
use g7_runtime::numbers::{inv, is_due_after, low_bit, real_abs, real_ln, real_log, real_sqrt, since};
use g7_runtime::text::{
    text_compare, text_concat, text_copy, text_delete, text_find, text_from_bool, text_from_i64,
    text_from_time, text_from_u64, text_insert, text_left, text_len, text_mid, text_replace, text_right,
    text_to_bool,
};

/// A result with its fault.
fn told<T>(f: impl FnOnce(&mut u8) -> T) -> (T, u8) {
    let mut fault = FAULT_NONE;
    let value = f(&mut fault);
    (value, fault)
}

/// At the limits of a type.
fn limits<T: g7_runtime::arithmetic::Whole + std::fmt::Debug>(least: T, most: T, one: T) {
    let over = (T::ZERO, FAULT_OVERFLOW);
    assert_eq!(told(|f| add(most, one, f)), over);
    assert_eq!(told(|f| sub(least, one, f)), over);
    assert_eq!(told(|f| mul(most, most, f)), over);
    assert_eq!(told(|f| add(least, one, f)).1, FAULT_NONE);
    assert_eq!(told(|f| sub(most, one, f)).1, FAULT_NONE);
    assert_eq!(told(|f| div(one, T::ZERO, f)), (T::ZERO, FAULT_DIVISION));
    assert_eq!(told(|f| rem(one, T::ZERO, f)), (T::ZERO, FAULT_DIVISION));
    assert_eq!(told(|f| round::<T>(1e30, f)), over);
    assert_eq!(told(|f| trunc::<T>(f64::NAN, f)), over);
    assert_eq!((min(least, most), max(least, most)), (least, most));
}

#[test]
fn what_a_type_cannot_hold_is_a_fault() {
    limits(i8::MIN, i8::MAX, 1);
    limits(i16::MIN, i16::MAX, 1);
    limits(i32::MIN, i32::MAX, 1);
    limits(i64::MIN, i64::MAX, 1);
    limits(u8::MIN, u8::MAX, 1);
    limits(u16::MIN, u16::MAX, 1);
    limits(u32::MIN, u32::MAX, 1);
    limits(u64::MIN, u64::MAX, 1);
    assert_eq!(told(|f| neg(i16::MIN, f)), (0, FAULT_OVERFLOW));
    assert_eq!(told(|f| abs(i32::MIN, f)), (0, FAULT_OVERFLOW));
    assert_eq!(told(|f| div(i64::MIN, -1, f)), (0, FAULT_OVERFLOW));
    assert_eq!(told(|f| rem(i64::MIN, -1, f)), (0, FAULT_NONE), "nothing is left");
    assert_eq!(told(|f| rem(-7i16, 3, f)), (-1, FAULT_NONE), "the sign of the dividend");
    assert_eq!(told(|f| from_i64::<u8>(256, f)), (0, FAULT_OVERFLOW));
    assert_eq!(told(|f| from_i64::<u8>(-1, f)), (0, FAULT_OVERFLOW));
    assert_eq!(told(|f| from_u64::<i64>(1 << 63, f)), (0, FAULT_OVERFLOW));
    assert_eq!(told(|f| from_u64::<u8>(255, f)), (255, FAULT_NONE));
}

#[test]
fn bits_are_shifted_out_or_go_round() {
    let plain = |v: u8| (v, FAULT_NONE);
    let v = 0b1001_0110u8;
    assert_eq!((told(|f| shl(v, 3, f)), told(|f| shr(v, 3, f))), (plain(0b1011_0000), plain(0b0001_0010)));
    assert_eq!((told(|f| shl(v, 8, f)), told(|f| shr(v, i64::MAX, f))), (plain(0), plain(0)));
    assert_eq!((told(|f| rol(v, 3, f)), told(|f| ror(v, 3, f))), (plain(0b1011_0100), plain(0b1101_0010)));
    assert_eq!((told(|f| rol(v, 8, f)), told(|f| ror(v, 19, f))), (plain(v), plain(0b1101_0010)));
    for f in [shl, shr, rol, ror] {
        assert_eq!(told(|fault| f(v, -1, fault)), (0, FAULT_RANGE));
    }
}

#[test]
fn the_first_fault_is_told() {
    let mut fault = FAULT_NONE;
    div(1i16, 0, &mut fault);
    add(i16::MAX, 1, &mut fault);
    assert_eq!(fault, FAULT_DIVISION);
}

#[test]
fn reals_become_whole_numbers() {
    for (v, rounded, cut) in [
        (0.5, 0, 0),
        (1.5, 2, 1),
        (2.5, 2, 2),
        (-0.5, 0, 0),
        (-1.5, -2, -1),
        (-2.6, -3, -2),
        (127.4, 127, 127),
    ] {
        assert_eq!(told(|f| round::<i8>(v, f)), (rounded, FAULT_NONE), "halves of {v} to the even one");
        assert_eq!(told(|f| trunc::<i8>(v, f)), (cut, FAULT_NONE), "{v} toward zero");
    }
    assert_eq!(told(|f| round::<i8>(127.5, f)), (0, FAULT_OVERFLOW));
    assert_eq!(told(|f| trunc::<i8>(127.9, f)), (127, FAULT_NONE));
}

#[test]
fn reals() {
    assert_eq!(told(|f| div_real(1.0, 0.0, f)), (0.0, FAULT_DIVISION));
    assert_eq!(told(|f| rem_real(-7.5f32, 2.0, f)), (-1.5, FAULT_NONE));
    for v in [0.0, 2.0, 3.0, 1e-310, 1e300, f64::MAX, 4503599627370497.0, 0.1] {
        assert_eq!(real_sqrt(v).to_bits(), f64::sqrt(v).to_bits(), "SQRT({v}), rounded as IEEE 754 has it");
    }
    assert!(real_sqrt(-1.0).is_nan());
    assert_eq!(real_abs(-0.0).to_bits(), 0);
    assert_eq!((real_ln(1.0), real_log(1000.0)), (0.0, 3.0));
    assert_eq!(f32::ZERO, 0.0);
}

#[test]
fn time_and_places() {
    assert_eq!(since(i64::MIN, i64::MAX), 1, "the clock passes its end");
    assert!(is_due_after(i64::MAX, i64::MAX - 1, i64::MAX));
    assert!(!is_due_after(9, 0, 10));
    assert!(is_due_after(10, 0, 10));
    assert_eq!((low_bit(0x8000_0000), low_bit(6), inv(1)), (31, 1, 0xffff_fffe));
}

/// A text of 10 bytes.
fn text(letters: &str) -> [u8; 12] {
    let mut a = [0; 12];
    a[0] = letters.len() as u8;
    a[2..2 + letters.len()].copy_from_slice(letters.as_bytes());
    a
}

/// The result of a function of texts.
fn made(f: impl FnOnce(&mut [u8], usize, &mut u8)) -> (String, u8) {
    let (mut to, mut fault) = ([0xffu8; 12], FAULT_NONE);
    f(&mut to, 10, &mut fault);
    let size = usize::from(to[0]);
    let letters = to.get(2..2 + size).unwrap_or(&[]);
    (String::from_utf8_lossy(letters).into_owned(), fault)
}

#[test]
fn texts() {
    let (a, b) = (text("größe"), text("öß"));
    let plain = |letters: &str| (letters.to_owned(), FAULT_NONE);
    assert_eq!(text_len(&a), 5, "characters, not bytes");
    assert_eq!((text_find(&a, &b), text_find(&b, &a), text_find(&a, &text(""))), (3, 0, 0));
    assert_eq!((text_compare(&a, &a), text_compare(&text("a"), &text("b"))), (0, -1));
    assert_eq!(made(|to, most, _| text_copy(&a, to, most)), plain("größe"));
    assert_eq!(made(|to, most, f| text_left(&a, 3, to, most, f)), plain("grö"));
    assert_eq!(made(|to, most, f| text_right(&a, 2, to, most, f)), plain("ße"));
    assert_eq!(made(|to, most, f| text_mid(&a, 2, 3, to, most, f)), plain("öß"));
    assert_eq!(made(|to, most, f| text_delete(&a, 2, 3, to, most, f)), plain("gre"));
    assert_eq!(made(|to, most, f| text_insert(&text("gre"), &b, 2, to, most, f)), plain("größe"));
    assert_eq!(made(|to, most, f| text_replace(&a, &text("oss"), 2, 3, to, most, f)), plain("grosse"));
    assert_eq!(made(|to, most, _| text_concat(&a, &a, to, most)), plain("größegr"), "ö has no room: the end");
    for wrong in [
        made(|to, most, f| text_left(&a, -1, to, most, f)).1,
        made(|to, most, f| text_right(&a, -1, to, most, f)).1,
        made(|to, most, f| text_mid(&a, 1, -1, to, most, f)).1,
    ] {
        assert_eq!(wrong, FAULT_RANGE);
    }
}

#[test]
fn texts_and_numbers() {
    let plain = |letters: &str| (letters.to_owned(), FAULT_NONE);
    assert_eq!(made(|to, most, _| text_from_i64(-12, to, most)), plain("-12"));
    assert_eq!(
        made(|to, most, _| text_from_u64(u64::MAX, to, most)),
        plain("1844674407"),
        "as far as it fits"
    );
    assert_eq!(made(|to, most, _| text_from_bool(true, to, most)), plain("TRUE"));
    assert_eq!(made(|to, most, _| text_from_time(-61_000_000_000, to, most)), plain("T#-1m1s"));
    assert_eq!(made(|to, most, _| text_from_time(0, to, most)), plain("T#0s"));
    assert_eq!(made(|to, most, _| text_from_real(0.5, to, most)), plain("0.5"));
    assert_eq!(told(|f| text_to::<i8>(&text(" -128 "), f)), (-128, FAULT_NONE));
    assert_eq!(told(|f| text_to::<i8>(&text("128"), f)), (0, FAULT_RANGE));
    assert_eq!(told(|f| text_to::<i8>(&text("1x"), f)), (0, FAULT_RANGE));
    assert_eq!(told(|f| text_to_u64(&text("7"), f)), (7, FAULT_NONE));
    assert_eq!(told(|f| text_to_real::<f64>(&text("2.5"), f)), (2.5, FAULT_NONE));
    assert_eq!(told(|f| text_to_bool(&text("0"), f)), (false, FAULT_NONE));
    assert_eq!(told(|f| text_to_bool(&text("yes"), f)), (false, FAULT_RANGE));
}

#[test]
fn counters() {
    let mut up = Ctu { pv: 2, ..Ctu::default() };
    for (cu, q) in [(true, false), (true, false), (false, false), (true, true)] {
        up.cu = cu;
        call_ctu(&mut up);
        assert_eq!(up.q, q, "two rising edges");
    }
    let mut down = Ctd { pv: 1, ld: true, ..Ctd::default() };
    call_ctd(&mut down);
    assert!(!down.q);
    (down.ld, down.cd) = (false, true);
    call_ctd(&mut down);
    assert!(down.q);
    let mut both = Ctud { pv: 1, cu: true, cd: true, ..Ctud::default() };
    call_ctud(&mut both);
    assert_eq!(both.cv, 0, "both at once count nothing");
}

#[test]
fn timers() {
    let mut on = Ton { in_: true, pt: 10, ..Ton::default() };
    let mut off = Tof { in_: true, pt: 10, ..Tof::default() };
    let mut pulse = Tp { in_: true, pt: 10, ..Tp::default() };
    for (now, want) in [(0, (false, true, true)), (9, (false, true, true)), (10, (true, true, false))] {
        call_ton(&mut on, now);
        call_tof(&mut off, now);
        call_tp(&mut pulse, now);
        assert_eq!((on.q, off.q, pulse.q), want, "at {now}");
    }
    off.in_ = false;
    for (now, q) in [(20, true), (29, true), (30, false)] {
        call_tof(&mut off, now);
        assert_eq!(off.q, q, "at {now}");
    }
}

#[test]
fn edges_and_flip_flops() {
    let (mut rise, mut fall) =
        (RTrig { clk: true, ..RTrig::default() }, FTrig { clk: true, ..FTrig::default() });
    call_r_trig(&mut rise);
    call_f_trig(&mut fall);
    assert_eq!((rise.q, fall.q), (true, false));
    (rise.clk, fall.clk) = (false, false);
    call_r_trig(&mut rise);
    call_f_trig(&mut fall);
    assert_eq!((rise.q, fall.q), (false, true));
    let (mut sr, mut rs) = (Sr { s1: true, r: true, q1: false }, Rs { s: true, r1: true, q1: false });
    call_sr(&mut sr);
    call_rs(&mut rs);
    assert_eq!((sr.q1, rs.q1), (true, false), "set wins in SR, reset in RS");
}
