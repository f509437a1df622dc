//! Values of devices as words of the program, and back.
//!
//! A value that its variable cannot hold is no value: it is bad, never a wrong one. A value that its
//! point cannot hold is limited to the nearest one that it can, and counted.

use g7_host::Kind;
use g7_model::Nanos;

/// A value as a device has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Raw {
    /// A bit.
    Bit(bool),
    /// A whole number.
    Whole(i128),
    /// A number with a fraction.
    Real(f64),
}

/// The values that a point can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// A bit.
    Bit,
    /// Whole numbers of so many bits.
    Whole {
        /// 8 to 64.
        bits: u8,
        /// Two's complement.
        signed: bool,
    },
    /// Single precision.
    Single,
    /// Double precision.
    Double,
}

/// How the value of a point and that of a variable are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaling {
    /// The variable.
    pub kind: Kind,
    /// The point.
    pub holds: Holds,
    /// A bit is the complement of the BOOL.
    pub inverted: bool,
    /// The variable is this times the number of the point …
    pub scale: f64,
    /// … plus this. A TIME and a TOD are a number of milliseconds, a DATE and a DT one of seconds since 1970.
    pub offset: f64,
}

impl Scaling {
    /// The same number, or the same bit.
    pub fn plain(kind: Kind) -> Scaling {
        let holds = if kind == Kind::Bool { Holds::Bit } else { Holds::Double };
        Scaling { kind, holds, inverted: false, scale: 1.0, offset: 0.0 }
    }

    fn is_plain(&self) -> bool {
        self.scale == 1.0 && self.offset == 0.0
    }

    /// The word of the variable for a value of the point; `None` where the variable cannot hold it.
    pub fn word(&self, raw: Raw) -> Option<u64> {
        match (self.kind, raw) {
            (Kind::Bool, Raw::Bit(on)) => Some(u64::from(on != self.inverted)),
            (Kind::Bool | Kind::Text, _) | (_, Raw::Bit(_)) => None,
            (Kind::Int { bits, signed }, Raw::Whole(n)) if self.is_plain() => whole(n, bits, signed),
            (Kind::Time | Kind::Moment(_), Raw::Whole(n)) if self.is_plain() => {
                let unit = self.kind.unit()?.count();
                whole(n.checked_mul(unit.into())?, 64, true).filter(|word| self.kind.admits(*word))
            }
            (kind, raw) => {
                let number = match raw {
                    Raw::Whole(n) => n as f64,
                    Raw::Real(x) => x,
                    Raw::Bit(_) => return None,
                };
                let scaled = number * self.scale + self.offset;
                match kind {
                    Kind::Int { bits, signed } => whole(rounded(scaled)?, bits, signed),
                    Kind::Time | Kind::Moment(_) => {
                        let nanos = rounded(scaled * self.kind.unit()?.count() as f64)?;
                        whole(nanos, 64, true).filter(|word| self.kind.admits(*word))
                    }
                    Kind::Real => {
                        Some(u64::from((scaled as f32).to_bits())).filter(|_| (scaled as f32).is_finite())
                    }
                    Kind::Lreal => Some(scaled.to_bits()).filter(|_| scaled.is_finite()),
                    Kind::Bool | Kind::Text => None,
                }
            }
        }
    }

    /// The value of the point for a word of the variable, and true if it had to be limited.
    pub fn raw(&self, word: u64) -> (Raw, bool) {
        let number = match self.kind {
            Kind::Bool => return (Raw::Bit((word != 0) != self.inverted), false),
            // No text is wired (`wiring`).
            Kind::Text => return (Raw::Whole(0), true),
            Kind::Int { signed, .. } => {
                let n = if signed { i128::from(word as i64) } else { i128::from(word) };
                if self.is_plain() {
                    return self.limited(n);
                }
                n as f64
            }
            Kind::Time | Kind::Moment(_) => {
                let unit = self.kind.unit().unwrap_or(Nanos::MILLISECOND).count();
                if self.is_plain() {
                    return self.limited(i128::from(word as i64) / i128::from(unit));
                }
                word as i64 as f64 / unit as f64
            }
            Kind::Real => f64::from(f32::from_bits(word as u32)),
            Kind::Lreal => f64::from_bits(word),
        };
        let number = (number - self.offset) / self.scale;
        match self.holds {
            Holds::Single => {
                let (most, single) =
                    (f64::from(f32::MAX), number.clamp(f64::from(f32::MIN), f64::from(f32::MAX)));
                (
                    Raw::Real(if number.is_nan() { 0.0 } else { single }),
                    number.is_nan() || number.abs() > most,
                )
            }
            Holds::Double => (Raw::Real(if number.is_nan() { 0.0 } else { number }), number.is_nan()),
            Holds::Bit => (Raw::Bit(number != 0.0), false),
            // Limits of the number first, because a float has no whole number of each size.
            Holds::Whole { .. } => match rounded(number) {
                Some(n) => self.limited(n),
                None => (self.limited(if number > 0.0 { i128::MAX } else { 0 }).0, true),
            },
        }
    }

    /// A whole number within what the point holds.
    fn limited(&self, n: i128) -> (Raw, bool) {
        match self.holds {
            Holds::Whole { bits, signed } => {
                let (least, most) = range(bits, signed);
                (Raw::Whole(n.clamp(least, most)), n < least || n > most)
            }
            Holds::Single | Holds::Double => (Raw::Real(n as f64), false),
            Holds::Bit => (Raw::Bit(n != 0), false),
        }
    }
}

/// The nearest whole number; `None` for what is none or beyond all types.
fn rounded(x: f64) -> Option<i128> {
    let x = x.round();
    (x.abs() < 1e30).then_some(x as i128)
}

fn range(bits: u8, signed: bool) -> (i128, i128) {
    let bits = u32::from(bits.clamp(1, 64));
    if signed { (-(1 << (bits - 1)), (1 << (bits - 1)) - 1) } else { (0, (1 << bits) - 1) }
}

/// The word of a whole number in a type, where it fits.
fn whole(n: i128, bits: u8, signed: bool) -> Option<u64> {
    let (least, most) = range(bits, signed);
    (least..=most).contains(&n).then_some(n as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    const INT: Kind = Kind::Int { bits: 16, signed: true };

    fn scaling(kind: Kind, holds: Holds, scale: f64, offset: f64) -> Scaling {
        Scaling { kind, holds, inverted: false, scale, offset }
    }

    #[test]
    fn whole_numbers_are_exact() {
        let long = Kind::Int { bits: 64, signed: false };
        let plain = scaling(long, Holds::Whole { bits: 64, signed: false }, 1.0, 0.0);
        let most = u64::MAX;
        assert_eq!(plain.word(Raw::Whole(i128::from(most))), Some(most));
        assert_eq!(plain.raw(most), (Raw::Whole(i128::from(most)), false));
        let signed = scaling(INT, Holds::Whole { bits: 16, signed: true }, 1.0, 0.0);
        assert_eq!(signed.word(Raw::Whole(-5)), Some(-5i64 as u64));
        assert_eq!(signed.raw(-5i64 as u64), (Raw::Whole(-5), false));
    }

    #[test]
    fn what_a_variable_cannot_hold_is_no_value() {
        let signed = scaling(INT, Holds::Whole { bits: 32, signed: true }, 1.0, 0.0);
        assert_eq!(signed.word(Raw::Whole(32_767)), Some(32_767));
        assert_eq!(signed.word(Raw::Whole(32_768)), None);
        let real = scaling(Kind::Real, Holds::Single, 1.0, 0.0);
        assert_eq!(real.word(Raw::Real(f64::NAN)), None);
        assert_eq!(real.word(Raw::Real(f64::INFINITY)), None);
        assert_eq!(real.word(Raw::Real(1.5)), Some(u64::from(1.5f32.to_bits())));
        assert_eq!(scaling(INT, Holds::Double, 1.0, 0.0).word(Raw::Real(f64::NAN)), None);
    }

    #[test]
    fn what_a_point_cannot_hold_is_limited_and_told() {
        let small = scaling(INT, Holds::Whole { bits: 8, signed: false }, 1.0, 0.0);
        assert_eq!(small.raw(300), (Raw::Whole(255), true));
        assert_eq!(small.raw(-1i64 as u64), (Raw::Whole(0), true));
        let real = scaling(Kind::Lreal, Holds::Whole { bits: 16, signed: false }, 1.0, 0.0);
        assert_eq!(real.raw(f64::INFINITY.to_bits()), (Raw::Whole(65_535), true));
        assert_eq!(real.raw(f64::NAN.to_bits()), (Raw::Whole(0), true));
        assert_eq!(real.raw(1e300f64.to_bits()), (Raw::Whole(65_535), true));
        let single = scaling(Kind::Lreal, Holds::Single, 1.0, 0.0);
        assert_eq!(single.raw(1e300f64.to_bits()), (Raw::Real(f64::from(f32::MAX)), true));
    }

    #[test]
    fn a_scale_and_an_offset_go_both_ways() {
        // 4 to 20 mA as 0 to 27648 give 0 to 10 m.
        let level = scaling(Kind::Lreal, Holds::Whole { bits: 16, signed: true }, 10.0 / 27_648.0, 0.5);
        let word = level.word(Raw::Whole(13_824)).unwrap();
        assert_eq!(f64::from_bits(word), 5.5);
        assert_eq!(level.raw(word), (Raw::Whole(13_824), false));
        // Whole numbers are rounded to the nearest.
        let tenths = scaling(INT, Holds::Whole { bits: 16, signed: true }, 0.1, 0.0);
        assert_eq!(tenths.word(Raw::Whole(26)), Some(3));
        assert_eq!(tenths.word(Raw::Whole(-26)), Some(-3i64 as u64));
    }

    #[test]
    fn a_time_is_a_number_of_milliseconds() {
        let time = scaling(Kind::Time, Holds::Whole { bits: 32, signed: false }, 1.0, 0.0);
        assert_eq!(time.word(Raw::Whole(1_500)), Some(1_500_000_000));
        assert_eq!(time.raw(1_500_999_999), (Raw::Whole(1_500), false));
        assert_eq!(time.word(Raw::Whole(i128::MAX)), None);
    }

    #[test]
    fn an_inverted_bit_is_the_complement_both_ways() {
        let inverted = Scaling { inverted: true, ..scaling(Kind::Bool, Holds::Bit, 1.0, 0.0) };
        assert_eq!(inverted.word(Raw::Bit(true)), Some(0));
        assert_eq!(inverted.raw(1), (Raw::Bit(false), false));
    }
}
