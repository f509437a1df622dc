//! Durations and instants: whole nanoseconds, and how they are written.

use std::fmt;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A duration, or an instant measured from the start of a run, in whole nanoseconds.
///
/// `+`, `-` and `*` stop at the largest and smallest duration (about 292 years); where an overflow
/// must be reported, the `checked_` forms do so.
///
/// `{}` writes it as .g7 text does: `5s`, `2.5s`, `1m30s`, `T#-5s`. `{:#}` writes the literal of
/// IEC 61131-3, whose smallest unit is the millisecond: `T#1m30s`, `T#0.5ms`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Nanos(i64);

impl Nanos {
    /// No time.
    pub const ZERO: Nanos = Nanos(0);
    /// The longest duration.
    pub const MAX: Nanos = Nanos(i64::MAX);
    /// 1 µs.
    pub const MICROSECOND: Nanos = Nanos(1_000);
    /// 1 ms.
    pub const MILLISECOND: Nanos = Nanos(1_000_000);
    /// 1 s.
    pub const SECOND: Nanos = Nanos(1_000_000_000);
    /// 1 min.
    pub const MINUTE: Nanos = Nanos(60_000_000_000);
    /// 1 h.
    pub const HOUR: Nanos = Nanos(3_600_000_000_000);
    /// 1 d.
    pub const DAY: Nanos = Nanos(86_400_000_000_000);

    /// The units of a duration as .g7 text names them, from large to small.
    pub const UNITS: [(&str, Nanos); 7] = [
        ("d", Nanos::DAY),
        ("h", Nanos::HOUR),
        ("m", Nanos::MINUTE),
        ("s", Nanos::SECOND),
        ("ms", Nanos::MILLISECOND),
        ("us", Nanos::MICROSECOND),
        ("ns", Nanos(1)),
    ];

    /// The words before the `#` of a duration in IEC 61131-3, in capitals: `T#5s` (2003, 2.2.3.1; 2013, table 8).
    pub const WORDS: [&str; 4] = ["T", "TIME", "LT", "LTIME"];

    /// So many nanoseconds.
    pub const fn new(count: i64) -> Nanos {
        Nanos(count)
    }

    /// So many milliseconds, at most [`Nanos::MAX`].
    pub const fn from_millis(count: i64) -> Nanos {
        Nanos(count.saturating_mul(Nanos::MILLISECOND.0))
    }

    /// The number of nanoseconds.
    pub const fn count(self) -> i64 {
        self.0
    }

    /// The time in milliseconds, with their fraction as far as a `f64` holds it.
    #[allow(clippy::cast_precision_loss, reason = "for display; the exact value is `count`")]
    pub fn as_millis(self) -> f64 {
        self.0 as f64 / Nanos::MILLISECOND.0 as f64
    }

    /// The time in seconds, with their fraction as far as a `f64` holds it.
    #[allow(clippy::cast_precision_loss, reason = "for display; the exact value is `count`")]
    pub fn as_seconds(self) -> f64 {
        self.0 as f64 / Nanos::SECOND.0 as f64
    }

    /// The time for a reader: as .g7 text writes it, but a negative one with a sign alone: `-40us`.
    pub fn plain(self) -> String {
        self.to_string().replacen("T#", "", 1)
    }

    /// The time in seconds, exact, with as many decimals as it needs: `0.01`, `12`, `-0.000000001`.
    pub fn in_seconds(self) -> String {
        let sign = if self.0 < 0 { "-" } else { "" };
        let second = Nanos::SECOND.0.unsigned_abs();
        let (whole, part) = (self.0.unsigned_abs() / second, self.0.unsigned_abs() % second);
        if part == 0 {
            return format!("{sign}{whole}");
        }
        let decimals = format!("{part:09}");
        format!("{sign}{whole}.{}", decimals.trim_end_matches('0'))
    }

    /// How often the unit goes into it, without the rest; 0 for a unit of 0.
    pub fn count_of(self, unit: Nanos) -> i64 {
        self.0.checked_div(unit.0).unwrap_or(0)
    }

    /// How often the unit goes into it, or `None` where a rest remains.
    pub fn whole(self, unit: Nanos) -> Option<i64> {
        (self.0.checked_rem(unit.0)? == 0).then(|| self.0.checked_div(unit.0)).flatten()
    }

    /// The sum, or `None` where it overflows.
    pub fn checked_add(self, other: Nanos) -> Option<Nanos> {
        self.0.checked_add(other.0).map(Nanos)
    }

    /// The difference, or `None` where it overflows.
    pub fn checked_sub(self, other: Nanos) -> Option<Nanos> {
        self.0.checked_sub(other.0).map(Nanos)
    }

    /// The product, or `None` where it overflows.
    pub fn checked_mul(self, factor: i64) -> Option<Nanos> {
        self.0.checked_mul(factor).map(Nanos)
    }

    /// The duration with the other sign, or `None` where it overflows.
    pub fn checked_neg(self) -> Option<Nanos> {
        self.0.checked_neg().map(Nanos)
    }
}

impl Add for Nanos {
    type Output = Nanos;

    fn add(self, other: Nanos) -> Nanos {
        Nanos(self.0.saturating_add(other.0))
    }
}

impl AddAssign for Nanos {
    fn add_assign(&mut self, other: Nanos) {
        *self = *self + other;
    }
}

impl Sub for Nanos {
    type Output = Nanos;

    fn sub(self, other: Nanos) -> Nanos {
        Nanos(self.0.saturating_sub(other.0))
    }
}

impl Mul<i64> for Nanos {
    type Output = Nanos;

    fn mul(self, factor: i64) -> Nanos {
        Nanos(self.0.saturating_mul(factor))
    }
}

impl Div<i64> for Nanos {
    type Output = Nanos;

    /// Toward zero; 0 for a divisor of 0.
    fn div(self, divisor: i64) -> Nanos {
        Nanos(self.0.checked_div(divisor).unwrap_or(0))
    }
}

impl Neg for Nanos {
    type Output = Nanos;

    fn neg(self) -> Nanos {
        Nanos(self.0.saturating_neg())
    }
}

impl fmt::Display for Nanos {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let amount = self.0.unsigned_abs();
        match (f.alternate(), self.0 < 0) {
            (false, false) => {}
            (true, false) => f.write_str("T#")?,
            (_, true) => f.write_str("T#-")?,
        }
        if f.alternate() { write_standard(amount, f) } else { write_short(amount, f) }
    }
}

/// An amount as .g7 text has it: seconds and below with up to three decimals rather than a smaller unit.
fn write_short(amount: u64, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    if amount == 0 {
        return f.write_str("0s");
    }
    let mut rest = amount;
    for (unit, size) in Nanos::UNITS {
        let takes_decimals = size <= Nanos::SECOND;
        let size = size.0.unsigned_abs();
        if rest < size {
            continue;
        }
        write!(f, "{}", rest / size)?;
        rest %= size;
        let thousandths = u128::from(rest) * 1000;
        if takes_decimals && rest > 0 && thousandths.is_multiple_of(u128::from(size)) {
            let digits = format!("{:03}", thousandths / u128::from(size));
            write!(f, ".{}", digits.trim_end_matches('0'))?;
            rest = 0;
        }
        f.write_str(unit)?;
    }
    Ok(())
}

/// An amount in the units of IEC 61131-3, 2.2.3: what is less than a second in milliseconds, with
/// the fraction that the standard allows to the smallest unit written.
fn write_standard(amount: u64, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let mut rest = amount;
    for (unit, size) in Nanos::UNITS.iter().take(4) {
        let size = size.0.unsigned_abs();
        if rest >= size {
            write!(f, "{}{unit}", rest / size)?;
            rest %= size;
        }
    }
    let millisecond = Nanos::MILLISECOND.0.unsigned_abs();
    let (whole, part) = (rest / millisecond, rest % millisecond);
    if part > 0 {
        let digits = format!("{part:06}");
        write!(f, "{whole}.{}ms", digits.trim_end_matches('0'))
    } else if whole > 0 || amount == 0 {
        write!(f, "{whole}ms")
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Nanos;

    #[test]
    fn each_duration_has_one_short_and_one_standard_form() {
        let cases = [
            (0, "0s", "T#0ms"),
            (1, "1ns", "T#0.000001ms"),
            (1_500, "1.5us", "T#0.0015ms"),
            (500_000_000, "500ms", "T#500ms"),
            (2_500_000_000, "2.5s", "T#2s500ms"),
            (2_000_000_500, "2s500ns", "T#2s0.0005ms"),
            (60_500_000_000, "1m500ms", "T#1m500ms"),
            (5_400_000_000_000, "1h30m", "T#1h30m"),
            (90_061_000_000_000, "1d1h1m1s", "T#1d1h1m1s"),
            (-5_000_000_000, "T#-5s", "T#-5s"),
        ];
        for (count, short, standard) in cases {
            assert_eq!(Nanos::new(count).to_string(), short);
            assert_eq!(format!("{:#}", Nanos::new(count)), standard);
        }
    }

    #[test]
    fn a_reader_sees_a_sign_alone_and_seconds_are_exact() {
        assert_eq!(Nanos::new(-40_000).plain(), "-40us");
        assert_eq!(Nanos::new(2_500_000_000).plain(), "2.5s");
        assert_eq!(Nanos::ZERO.plain(), "0s");
        assert_eq!(Nanos::new(i64::MIN).plain(), "-106751d23h47m16s854ms775.808us");
        assert_eq!(Nanos::new(10_000_000).in_seconds(), "0.01");
        assert_eq!(Nanos::new(12_000_000_000).in_seconds(), "12");
        assert_eq!(Nanos::new(-1).in_seconds(), "-0.000000001");
        assert_eq!(Nanos::new(i64::MIN).in_seconds(), "-9223372036.854775808");
    }

    #[test]
    fn sums_stop_at_the_ends_and_checked_sums_say_so() {
        let (least, one) = (Nanos::new(i64::MIN), Nanos::new(1));
        assert_eq!(
            (Nanos::MAX + one, least - one, -least, Nanos::MAX * 2),
            (Nanos::MAX, least, Nanos::MAX, Nanos::MAX)
        );
        assert_eq!((Nanos::MAX.checked_add(one), least.checked_sub(one)), (None, None));
        assert_eq!((least.checked_neg(), Nanos::MAX.checked_mul(2)), (None, None));
        assert_eq!(Nanos::from_millis(i64::MAX), Nanos::MAX);
        assert_eq!(Nanos::SECOND.checked_mul(60), Some(Nanos::MINUTE));
        assert_eq!(Nanos::MINUTE.whole(Nanos::SECOND), Some(60));
        assert_eq!((Nanos::SECOND.whole(Nanos::MINUTE), Nanos::SECOND.whole(Nanos::ZERO)), (None, None));
    }
}
