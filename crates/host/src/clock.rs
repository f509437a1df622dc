//! Where time comes from: a clock that tests turn, or the wall.

use std::time::{Duration, Instant};

/// A monotonic clock in nanoseconds since its own start.
pub trait Clock {
    /// The time now.
    fn now(&mut self) -> i64;
    /// Returns when `instant` has come; at once where it is past.
    fn wait_until(&mut self, instant: i64);
}

/// A clock that goes only when it is waited for: as fast as the machine can.
#[derive(Clone, Copy, Debug, Default)]
pub struct VirtualClock {
    now: i64,
}

impl Clock for VirtualClock {
    fn now(&mut self) -> i64 {
        self.now
    }

    fn wait_until(&mut self, instant: i64) {
        self.now = self.now.max(instant);
    }
}

/// The wall clock, at a chosen speed; it can be held.
#[derive(Clone, Copy, Debug)]
pub struct WallClock {
    /// Wall instant at which `base` was the time.
    since: Instant,
    base: i64,
    /// Nanoseconds of this clock for one of the wall.
    speed: f64,
    held: bool,
}

impl Default for WallClock {
    fn default() -> WallClock {
        WallClock { since: wall(), base: 0, speed: 1.0, held: false }
    }
}

#[allow(clippy::disallowed_methods, reason = "the one place where time enters")]
fn wall() -> Instant {
    Instant::now()
}

impl WallClock {
    fn elapsed(&self) -> i64 {
        if self.held {
            return 0;
        }
        // As a float: at a thousandfold speed the integer product would overflow in weeks.
        (self.since.elapsed().as_nanos() as f64 * self.speed) as i64
    }

    fn rebase(&mut self) {
        self.base = self.base.saturating_add(self.elapsed());
        self.since = wall();
    }

    /// Nanoseconds of this clock for one of the wall.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Goes faster or slower from now on.
    pub fn set_speed(&mut self, speed: f64) {
        self.rebase();
        self.speed = if speed.is_finite() && speed > 0.0 { speed } else { 1.0 };
    }

    /// Stands still, or goes on from where it stood.
    pub fn hold(&mut self, held: bool) {
        self.rebase();
        self.held = held;
    }

    /// Whether it stands still.
    pub fn is_held(&self) -> bool {
        self.held
    }

    /// Takes this as the time now (after steps were made by hand).
    pub fn set(&mut self, now: i64) {
        self.base = now;
        self.since = wall();
    }

    /// Time of the wall until `instant`; `None` while held.
    pub fn until(&mut self, instant: i64) -> Option<Duration> {
        if self.held {
            return None;
        }
        let left = instant.saturating_sub(self.now()).max(0);
        Some(Duration::from_nanos((left as f64 / self.speed) as u64))
    }
}

impl Clock for WallClock {
    fn now(&mut self) -> i64 {
        self.base.saturating_add(self.elapsed())
    }

    fn wait_until(&mut self, instant: i64) {
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
        clock.wait_until(5_000_000_000);
        assert_eq!(clock.now(), 5_000_000_000);
        clock.wait_until(1);
        assert_eq!(clock.now(), 5_000_000_000);
    }

    #[test]
    fn a_held_wall_clock_stands_and_waits_for_nothing() {
        let mut clock = WallClock::default();
        clock.hold(true);
        let at = clock.now();
        clock.wait_until(at + 3_600_000_000_000);
        assert_eq!(clock.now(), at);
    }

    #[test]
    fn a_fast_wall_clock_waits_less() {
        let mut clock = WallClock::default();
        clock.set_speed(1000.0);
        let due = clock.now() + 1_000_000_000;
        let real = WallClock::default();
        clock.wait_until(due);
        assert!(clock.now() >= due);
        assert!(real.elapsed() < 900_000_000, "a second at 1000x takes a millisecond");
    }
}
