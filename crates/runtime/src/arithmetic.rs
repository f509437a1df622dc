//! Arithmetic with limits: what a type cannot hold is a fault.
//!
//! Each function is generic here; `codegen` prints it for the types that a chart
//! uses, with `T` put in: `add` as `add_i16`, `from_i64` as `i16_from_i64`.

use core::fmt::{Debug, Write as _};
use core::str::FromStr;

use crate::faults::{FAULT_DIVISION, FAULT_OVERFLOW, FAULT_RANGE};
use crate::numbers::{fail, round_even, toward_zero, whole_of};
use crate::text::{Text, text_str};

/// A number of any type.
pub trait Number: Copy + PartialOrd {
    /// Nothing.
    const ZERO: Self;
}

/// A whole number.
pub trait Whole: Number + TryFrom<i64> + TryFrom<u64> + TryFrom<i128> {
    fn checked_add(self, other: Self) -> Option<Self>;
    fn checked_sub(self, other: Self) -> Option<Self>;
    fn checked_mul(self, other: Self) -> Option<Self>;
    fn checked_div(self, other: Self) -> Option<Self>;
    fn checked_neg(self) -> Option<Self>;
    fn wrapping_rem(self, other: Self) -> Self;
}

/// A whole number with a sign.
pub trait Signed: Whole {
    fn checked_abs(self) -> Option<Self>;
}

/// A whole number without a sign, whose bits can be shifted.
pub trait Bits: Whole {
    fn checked_shl(self, by: u32) -> Option<Self>;
    fn checked_shr(self, by: u32) -> Option<Self>;
    fn rotate_left(self, by: u32) -> Self;
    fn rotate_right(self, by: u32) -> Self;
}

/// A real number.
pub trait Real:
    Number + Debug + FromStr + core::ops::Div<Output = Self> + core::ops::Rem<Output = Self>
{
}

macro_rules! number {
    ($zero:literal: $($t:ident)*) => {$(
        impl Number for $t {
            const ZERO: $t = $zero;
        }
    )*};
}

macro_rules! whole {
    ($($t:ident)*) => {$(
        impl Whole for $t {
            fn checked_add(self, other: $t) -> Option<$t> {
                $t::checked_add(self, other)
            }
            fn checked_sub(self, other: $t) -> Option<$t> {
                $t::checked_sub(self, other)
            }
            fn checked_mul(self, other: $t) -> Option<$t> {
                $t::checked_mul(self, other)
            }
            fn checked_div(self, other: $t) -> Option<$t> {
                $t::checked_div(self, other)
            }
            fn checked_neg(self) -> Option<$t> {
                $t::checked_neg(self)
            }
            fn wrapping_rem(self, other: $t) -> $t {
                $t::wrapping_rem(self, other)
            }
        }
    )*};
}

macro_rules! signed {
    ($($t:ident)*) => {$(
        impl Signed for $t {
            fn checked_abs(self) -> Option<$t> {
                $t::checked_abs(self)
            }
        }
    )*};
}

macro_rules! bits {
    ($($t:ident)*) => {$(
        impl Bits for $t {
            fn checked_shl(self, by: u32) -> Option<$t> {
                $t::checked_shl(self, by)
            }
            fn checked_shr(self, by: u32) -> Option<$t> {
                $t::checked_shr(self, by)
            }
            fn rotate_left(self, by: u32) -> $t {
                $t::rotate_left(self, by)
            }
            fn rotate_right(self, by: u32) -> $t {
                $t::rotate_right(self, by)
            }
        }
    )*};
}

macro_rules! real {
    ($($t:ident)*) => {$(
        impl Real for $t {}
    )*};
}

number!(0: i8 i16 i32 i64 u8 u16 u32 u64);
number!(0.0: f32 f64);
whole!(i8 i16 i32 i64 u8 u16 u32 u64);
signed!(i8 i16 i32 i64);
bits!(u8 u16 u32 u64);
real!(f32 f64);

pub fn add<T: Whole>(a: T, b: T, fault: &mut u8) -> T {
    match a.checked_add(b) {
        Some(v) => v,
        None => {
            fail(fault, FAULT_OVERFLOW);
            T::ZERO
        }
    }
}

pub fn sub<T: Whole>(a: T, b: T, fault: &mut u8) -> T {
    match a.checked_sub(b) {
        Some(v) => v,
        None => {
            fail(fault, FAULT_OVERFLOW);
            T::ZERO
        }
    }
}

pub fn mul<T: Whole>(a: T, b: T, fault: &mut u8) -> T {
    match a.checked_mul(b) {
        Some(v) => v,
        None => {
            fail(fault, FAULT_OVERFLOW);
            T::ZERO
        }
    }
}

pub fn div<T: Whole>(a: T, b: T, fault: &mut u8) -> T {
    if b == T::ZERO {
        fail(fault, FAULT_DIVISION);
        return T::ZERO;
    }
    match a.checked_div(b) {
        Some(v) => v,
        None => {
            fail(fault, FAULT_OVERFLOW);
            T::ZERO
        }
    }
}

pub fn rem<T: Whole>(a: T, b: T, fault: &mut u8) -> T {
    if b == T::ZERO {
        fail(fault, FAULT_DIVISION);
        return T::ZERO;
    }
    a.wrapping_rem(b)
}

pub fn neg<T: Whole>(a: T, fault: &mut u8) -> T {
    match a.checked_neg() {
        Some(v) => v,
        None => {
            fail(fault, FAULT_OVERFLOW);
            T::ZERO
        }
    }
}

pub fn abs<T: Signed>(a: T, fault: &mut u8) -> T {
    match a.checked_abs() {
        Some(v) => v,
        None => {
            fail(fault, FAULT_OVERFLOW);
            T::ZERO
        }
    }
}

pub fn shl<T: Bits>(v: T, by: i64, fault: &mut u8) -> T {
    if by < 0 {
        fail(fault, FAULT_RANGE);
        return T::ZERO;
    }
    v.checked_shl(by.min(64) as u32).unwrap_or(T::ZERO)
}

pub fn shr<T: Bits>(v: T, by: i64, fault: &mut u8) -> T {
    if by < 0 {
        fail(fault, FAULT_RANGE);
        return T::ZERO;
    }
    v.checked_shr(by.min(64) as u32).unwrap_or(T::ZERO)
}

pub fn rol<T: Bits>(v: T, by: i64, fault: &mut u8) -> T {
    if by < 0 {
        fail(fault, FAULT_RANGE);
        return T::ZERO;
    }
    v.rotate_left((by % 64) as u32)
}

pub fn ror<T: Bits>(v: T, by: i64, fault: &mut u8) -> T {
    if by < 0 {
        fail(fault, FAULT_RANGE);
        return T::ZERO;
    }
    v.rotate_right((by % 64) as u32)
}

pub fn min<T: Number>(a: T, b: T) -> T {
    if b < a { b } else { a }
}

pub fn max<T: Number>(a: T, b: T) -> T {
    if a < b { b } else { a }
}

pub fn from_i64<T: Whole>(v: i64, fault: &mut u8) -> T {
    match T::try_from(v) {
        Ok(v) => v,
        Err(_) => {
            fail(fault, FAULT_OVERFLOW);
            T::ZERO
        }
    }
}

pub fn from_u64<T: Whole>(v: u64, fault: &mut u8) -> T {
    match T::try_from(v) {
        Ok(v) => v,
        Err(_) => {
            fail(fault, FAULT_OVERFLOW);
            T::ZERO
        }
    }
}

pub fn round<T: Whole>(v: f64, fault: &mut u8) -> T {
    match T::try_from(whole_of(round_even(v))) {
        Ok(v) => v,
        Err(_) => {
            fail(fault, FAULT_OVERFLOW);
            T::ZERO
        }
    }
}

pub fn trunc<T: Whole>(v: f64, fault: &mut u8) -> T {
    match T::try_from(whole_of(toward_zero(v))) {
        Ok(v) => v,
        Err(_) => {
            fail(fault, FAULT_OVERFLOW);
            T::ZERO
        }
    }
}

pub fn div_real<T: Real>(a: T, b: T, fault: &mut u8) -> T {
    if b == T::ZERO {
        fail(fault, FAULT_DIVISION);
        return T::ZERO;
    }
    a / b
}

pub fn rem_real<T: Real>(a: T, b: T, fault: &mut u8) -> T {
    if b == T::ZERO {
        fail(fault, FAULT_DIVISION);
        return T::ZERO;
    }
    a % b
}

pub fn text_to<T: Whole>(a: &[u8], fault: &mut u8) -> T {
    match text_str(a).trim().parse::<i64>().ok().and_then(|v| T::try_from(v).ok()) {
        Some(v) => v,
        None => {
            fail(fault, FAULT_RANGE);
            T::ZERO
        }
    }
}

pub fn text_to_u64(a: &[u8], fault: &mut u8) -> u64 {
    match text_str(a).trim().parse::<i128>().ok().and_then(|v| u64::try_from(v).ok()) {
        Some(v) => v,
        None => {
            fail(fault, FAULT_RANGE);
            0
        }
    }
}

pub fn text_to_real<T: Real>(a: &[u8], fault: &mut u8) -> T {
    match text_str(a).trim().parse::<T>().ok() {
        Some(v) => v,
        None => {
            fail(fault, FAULT_RANGE);
            T::ZERO
        }
    }
}

pub fn text_from_real<T: Real>(v: T, to: &mut [u8], most: usize) {
    let mut text = Text::new(to, most);
    let _ = write!(text, "{:?}", v);
}
