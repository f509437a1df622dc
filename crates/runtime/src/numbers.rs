//! Numbers: time, places in tables, reals to whole numbers, functions of reals.
//!
//! `codegen` prints each function that a chart calls as it stands here; C has its own
//! in `c/`.

/// The complement of a word. Both languages print it as an operator.
pub fn inv(word: u32) -> u32 {
    !word
}

/// The place of the lowest bit that is set.
pub fn low_bit(word: u32) -> usize {
    word.trailing_zeros() as usize
}

/// Time gone by; the clock may pass its end.
pub fn since(now: i64, then: i64) -> i64 {
    now.wrapping_sub(then)
}

/// Ticks gone by; the clock may pass its end.
pub fn ticks_gone(now: u32, then: u32) -> u32 {
    now.wrapping_sub(then)
}

/// Ticks from an event to now, as far as they tell.
pub fn ticks_since(now: u32, then: u32) -> u32 {
    now.wrapping_sub(then).min(0x8000_0000)
}

/// The instant `then`. If it is longer ago than ticks can tell, the instant that is just as long ago as they can.
pub fn ticks_held(now: u32, then: u32) -> u32 {
    now.wrapping_sub(ticks_since(now, then))
}

/// True if the clock came into another quarter of its range.
pub fn has_turned(now: u32, then: u32) -> bool {
    (now >> 30) != (then >> 30)
}

pub fn is_due_after(now: i64, start: i64, time: i64) -> bool {
    now >= start.saturating_add(time)
}

/// A whole number; what is none lies beyond every type.
pub(crate) fn whole_of(v: f64) -> i128 {
    if v > -1e30 && v < 1e30 { v as i128 } else { i128::MAX }
}

/// To a whole number, halves to the even one.
pub(crate) fn round_even(v: f64) -> f64 {
    if !(v > -4503599627370496.0 && v < 4503599627370496.0) {
        return v;
    }
    let whole = (v as i64) as f64;
    let rest = v - whole;
    let odd = (v as i64) % 2 != 0;
    if rest > 0.5 || (rest == 0.5 && odd) {
        whole + 1.0
    } else if rest < -0.5 || (rest == -0.5 && odd) {
        whole - 1.0
    } else {
        whole
    }
}

pub(crate) fn toward_zero(v: f64) -> f64 {
    if v > -4503599627370496.0 && v < 4503599627370496.0 { (v as i64) as f64 } else { v }
}

/// The first fault is the one that is told.
pub fn fail(fault: &mut u8, kind: u8) {
    if *fault == 0 {
        *fault = kind;
    }
}

pub fn real_abs(v: f64) -> f64 {
    f64::from_bits(v.to_bits() & (u64::MAX >> 1))
}

/// The square root, rounded as IEEE 754 has it, digit by digit.
pub fn real_sqrt(v: f64) -> f64 {
    if v.is_nan() || v == 0.0 || v > f64::MAX {
        return v;
    }
    if v < 0.0 {
        return f64::NAN;
    }
    let mut part = v;
    let mut scale = 1.0;
    while part >= 4.0 {
        part /= 4.0;
        scale *= 2.0;
    }
    while part < 1.0 {
        part *= 4.0;
        scale /= 2.0;
    }
    let number = (part * 4503599627370496.0) as u64;
    let (mut root, mut rest) = (0u64, 0u64);
    for i in 0..53u32 {
        let two = if i < 27 { (number >> (52 - 2 * i)) & 3 } else { 0 };
        rest = (rest << 2) | two;
        root <<= 1;
        if rest > root << 1 {
            rest -= (root << 1) + 1;
            root += 1;
        }
    }
    if rest > root {
        root += 1;
    }
    (root as f64 / 4503599627370496.0) * scale
}

pub fn real_acos(a: f64) -> f64 {
    libm::acos(a)
}

pub fn real_asin(a: f64) -> f64 {
    libm::asin(a)
}

pub fn real_atan(a: f64) -> f64 {
    libm::atan(a)
}

pub fn real_cos(a: f64) -> f64 {
    libm::cos(a)
}

pub fn real_exp(a: f64) -> f64 {
    libm::exp(a)
}

pub fn real_sin(a: f64) -> f64 {
    libm::sin(a)
}

pub fn real_tan(a: f64) -> f64 {
    libm::tan(a)
}

pub fn real_ln(a: f64) -> f64 {
    libm::log(a)
}

pub fn real_log(a: f64) -> f64 {
    libm::log10(a)
}

pub fn pow_f32(a: f32, b: f32) -> f32 {
    libm::powf(a, b)
}

pub fn pow_f64(a: f64, b: f64) -> f64 {
    libm::pow(a, b)
}
