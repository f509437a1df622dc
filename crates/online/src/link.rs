//! When a device is reached, asked, and given up: a state machine without clock or device.
//!
//! ```text
//!           reached                 answered
//!   Down ------------> Up <----------------------+
//!    ^                  |  due each poll period  |
//!    +------------------+------------------------+
//!         no answer: tried again after 100 ms, 200 ms … `retry`
//! ```

use g7_model::Nanos;

use crate::setup::Timing;

/// The time before the second attempt to reach a device.
const FIRST: Nanos = Nanos::from_millis(100);

/// The next thing to do with a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Reach it.
    Connect,
    /// Write its outputs and read its inputs.
    Exchange,
}

/// The state of the link to a device.
#[derive(Clone, Debug)]
pub struct Link {
    timing: Timing,
    up: bool,
    due: Nanos,
    /// The pause after the next failure.
    pause: Nanos,
}

impl Link {
    /// A link that is due at once.
    pub fn new(timing: Timing) -> Link {
        Link { timing, up: false, due: Nanos::ZERO, pause: FIRST.min(timing.retry) }
    }

    /// The instant of the next order.
    pub fn due(&self) -> Nanos {
        self.due
    }

    /// The next order.
    pub fn order(&self) -> Order {
        if self.up { Order::Exchange } else { Order::Connect }
    }

    /// True while the device answers.
    pub fn is_up(&self) -> bool {
        self.up
    }

    /// Notes at `now` that the order was carried out, or that it failed.
    pub fn settle(&mut self, now: Nanos, order: Order, done: bool) {
        match (order, done) {
            (Order::Connect, true) => {
                self.up = true;
                self.due = now;
            }
            (Order::Exchange, true) => {
                self.pause = FIRST.min(self.timing.retry);
                // Polls that came too late are left out; the next one is on the grid of the period.
                let late = (now - self.due).count_of(self.timing.poll).max(0);
                self.due += self.timing.poll * (late + 1);
            }
            (_, false) => {
                self.up = false;
                self.due = now + self.pause;
                self.pause = (self.pause * 2).min(self.timing.retry);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Nanos = Nanos::MILLISECOND;

    fn link() -> Link {
        Link::new(Timing { poll: MS * 20, retry: MS * 500, ..Timing::default() })
    }

    #[test]
    fn polls_stay_on_their_grid_and_late_ones_are_left_out() {
        let mut link = link();
        assert_eq!((link.due(), link.order()), (Nanos::ZERO, Order::Connect));
        link.settle(MS * 3, Order::Connect, true);
        assert_eq!((link.due(), link.order()), (MS * 3, Order::Exchange));
        link.settle(MS * 5, Order::Exchange, true);
        assert_eq!(link.due(), MS * 23);
        link.settle(MS * 70, Order::Exchange, true);
        assert_eq!(link.due(), MS * 83);
    }

    #[test]
    fn pauses_between_attempts_double_up_to_the_longest() {
        let mut link = link();
        let mut now = Nanos::ZERO;
        let mut pauses = Vec::new();
        for _ in 0..5 {
            link.settle(now, Order::Connect, false);
            pauses.push((link.due() - now).count() / MS.count());
            now = link.due();
        }
        assert_eq!(pauses, [100, 200, 400, 500, 500]);
        // A device that is reached but does not answer is not tried without pause.
        link.settle(now, Order::Connect, true);
        link.settle(now, Order::Exchange, false);
        assert_eq!(link.due() - now, MS * 500);
        // One answer makes the pauses short again.
        now = link.due();
        link.settle(now, Order::Connect, true);
        link.settle(now, Order::Exchange, true);
        link.settle(now, Order::Exchange, false);
        assert_eq!(link.due() - now, MS * 100);
    }
}
