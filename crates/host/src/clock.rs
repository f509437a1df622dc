//! The source of time: a virtual clock, for simulation and tests, or the wall clock.

use std::time::{Duration, Instant};

use g7_model::Nanos;

/// A monotonic clock; its times are since its own start.
pub trait Clock {
    /// The time now.
    fn now(&mut self) -> Nanos;
    /// Returns when `instant` is reached; returns at once if it is past.
    fn wait_until(&mut self, instant: Nanos);
}

/// A clock that jumps to the instant it is asked to wait for, so a run is as fast as the machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct VirtualClock {
    now: Nanos,
}

impl Clock for VirtualClock {
    fn now(&mut self) -> Nanos {
        self.now
    }

    fn wait_until(&mut self, instant: Nanos) {
        self.now = self.now.max(instant);
    }
}

/// The wall clock at a chosen speed; it can be paused.
#[derive(Clone, Copy, Debug)]
pub struct WallClock {
    /// The wall-clock instant at which this clock showed `base`.
    since: Instant,
    base: Nanos,
    /// Nanoseconds of this clock per nanosecond of the wall clock.
    speed: f64,
    held: bool,
}

impl Default for WallClock {
    fn default() -> WallClock {
        WallClock { since: wall(), base: Nanos::ZERO, speed: 1.0, held: false }
    }
}

#[allow(clippy::disallowed_methods, reason = "the one place where time enters")]
fn wall() -> Instant {
    Instant::now()
}

/// The time of day in milliseconds since 1970, UTC: for the time stamps of messages to others, never
/// for a chart.
#[allow(clippy::disallowed_methods, reason = "the one place where time enters")]
pub fn utc_millis() -> u64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
}

impl WallClock {
    fn elapsed(&self) -> Nanos {
        if self.held {
            return Nanos::ZERO;
        }
        // Computed as a float: at 1000 times the speed an integer product would overflow within
        // weeks.
        Nanos::new((self.since.elapsed().as_nanos() as f64 * self.speed) as i64)
    }

    fn rebase(&mut self) {
        self.base += self.elapsed();
        self.since = wall();
    }

    /// Nanoseconds of this clock per nanosecond of the wall clock.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Changes the speed from now on.
    pub fn set_speed(&mut self, speed: f64) {
        self.rebase();
        self.speed = if speed.is_finite() && speed > 0.0 { speed } else { 1.0 };
    }

    /// Pauses the clock, or lets it go on from where it stopped.
    pub fn hold(&mut self, held: bool) {
        self.rebase();
        self.held = held;
    }

    /// True while the clock is paused.
    pub fn is_held(&self) -> bool {
        self.held
    }

    /// Sets the time, for instance after the user made single scans by hand.
    pub fn set(&mut self, now: Nanos) {
        self.base = now;
        self.since = wall();
    }

    /// Wall-clock time left until `instant`; `None` while the clock is paused.
    pub fn until(&mut self, instant: Nanos) -> Option<Duration> {
        if self.held {
            return None;
        }
        let left = (instant - self.now()).max(Nanos::ZERO).count();
        Some(Duration::from_nanos((left as f64 / self.speed) as u64))
    }
}

impl Clock for WallClock {
    fn now(&mut self) -> Nanos {
        self.base + self.elapsed()
    }

    fn wait_until(&mut self, instant: Nanos) {
        while let Some(left) = self.until(instant) {
            if left.is_zero() {
                return;
            }
            std::thread::sleep(left);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_virtual_clock_jumps_to_what_is_waited_for_and_never_back() {
        let mut clock = VirtualClock::default();
        let late = Nanos::SECOND * 5;
        clock.wait_until(late);
        assert_eq!(clock.now(), late);
        clock.wait_until(Nanos::new(1));
        assert_eq!(clock.now(), late);
    }

    #[test]
    fn a_held_wall_clock_stands_and_waits_for_nothing() {
        let mut clock = WallClock::default();
        clock.hold(true);
        let at = clock.now();
        clock.wait_until(at + Nanos::HOUR);
        assert_eq!(clock.now(), at);
    }

    #[test]
    fn a_fast_wall_clock_waits_less() {
        let mut clock = WallClock::default();
        clock.set_speed(1000.0);
        let due = clock.now() + Nanos::SECOND;
        let real = WallClock::default();
        clock.wait_until(due);
        assert!(clock.now() >= due);
        assert!(real.elapsed() < Nanos::from_millis(900), "a second at 1000x takes a millisecond");
    }
}
