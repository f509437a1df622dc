//! How punctual scans are and how long they take.
//!
//! The scan thread notes one record of fixed size a scan in a ring; another thread counts them here.

use std::fmt;

use g7_model::Nanos;
use hdrhistogram::Histogram;

/// The pace of one scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    /// The time from the instant at which it was due to its begin.
    pub late: Nanos,
    /// The time from its begin until its outputs were handed on.
    pub took: Nanos,
}

/// Longer times, in ns, count as this one. The histograms keep two decimal digits.
const MOST: u64 = 60_000_000_000;

/// The paces of many scans.
#[derive(Clone, Debug)]
pub struct Paces {
    late: Histogram<u64>,
    took: Histogram<u64>,
}

impl Default for Paces {
    fn default() -> Paces {
        // hdrhistogram accepts these bounds: the lower is 1 or more, the upper at least twice the lower,
        // and the digits are 5 or fewer.
        let new = || Histogram::new_with_bounds(1, MOST, 2).expect("valid bounds");
        Paces { late: new(), took: new() }
    }
}

impl Paces {
    /// Counts a scan.
    pub fn add(&mut self, pace: Pace) {
        self.late.saturating_record(pace.late.count().max(0).unsigned_abs());
        self.took.saturating_record(pace.took.count().max(0).unsigned_abs());
    }

    /// The number of scans.
    pub fn scans(&self) -> u64 {
        self.late.len()
    }

    /// How late the scans were.
    pub fn late(&self) -> Spread {
        Spread::of(&self.late)
    }

    /// How long the scans took.
    pub fn took(&self) -> Spread {
        Spread::of(&self.took)
    }
}

/// How times are spread: so many of them are at most so long, to two digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spread {
    /// One half.
    pub p50: Nanos,
    /// 99 of 100.
    pub p99: Nanos,
    /// 999 of 1000.
    pub p999: Nanos,
    /// All.
    pub most: Nanos,
}

impl Spread {
    fn of(times: &Histogram<u64>) -> Spread {
        let nanos = |n: u64| Nanos::new(i64::try_from(n).unwrap_or(i64::MAX));
        let at = |share| nanos(times.value_at_quantile(share));
        Spread { p50: at(0.5), p99: at(0.99), p999: at(0.999), most: nanos(times.max()) }
    }
}

impl fmt::Display for Spread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let us = |time: Nanos| time.count() as f64 / 1e3;
        let Spread { p50, p99, p999, most } = *self;
        write!(
            f,
            "half of them {:.0} us, 99 % {:.0} us, 99.9 % {:.0} us, all {:.0} us at most",
            us(p50),
            us(p99),
            us(p999),
            us(most)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_has_the_share_of_times_that_its_name_says() {
        let mut paces = Paces::default();
        for k in 1..=1000 {
            paces.add(Pace { late: Nanos::from_millis(k), took: Nanos::ZERO - Nanos::SECOND });
        }
        let Spread { p50, p99, p999, most } = paces.late();
        // Two digits: within one part in a hundred.
        for (found, expected) in [(p50, 500), (p99, 990), (p999, 999), (most, 1000)] {
            let off = (found - Nanos::from_millis(expected)).count().abs();
            assert!(off * 100 <= Nanos::from_millis(expected).count(), "{found:?} {expected}");
        }
        // A clock that went back counts as no time, and what is beyond all limits as the longest.
        assert_eq!(paces.took().most, Nanos::ZERO);
        paces.add(Pace { late: Nanos::new(i64::MAX), took: Nanos::ZERO });
        assert!(paces.late().most >= Nanos::SECOND * 59);
        assert_eq!(paces.scans(), 1001);
    }
}
