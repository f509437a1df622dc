//! How much room printed code may take, and the unit of its clock: chosen by callers, read by `facts`,
//! `build` and the printers.

/// The unit in which the code is told the time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// Nanoseconds in 64 bits.
    #[default]
    Nanoseconds,
    /// Microseconds in 32 bits, which begin again at 0 after 71 minutes.
    Microseconds,
    /// Milliseconds in 32 bits, which begin again at 0 after 49 days.
    Milliseconds,
}

impl Clock {
    /// Nanoseconds in the unit.
    pub fn nanoseconds(self) -> i64 {
        match self {
            Clock::Nanoseconds => 1,
            Clock::Microseconds => 1_000,
            Clock::Milliseconds => 1_000_000,
        }
    }

    /// The longest time that code with this clock tells, in nanoseconds.
    pub fn longest(self) -> i64 {
        match self {
            Clock::Nanoseconds => i64::MAX,
            _ => self.nanoseconds() << 31,
        }
    }

    /// Its unit as a word.
    pub(crate) fn unit(self) -> &'static str {
        match self {
            Clock::Nanoseconds => "nanoseconds",
            Clock::Microseconds => "microseconds",
            Clock::Milliseconds => "milliseconds",
        }
    }
}

/// How much room the code may take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Room {
    /// Truth values are packed, and only steps whose time is read have one.
    pub small: bool,
    /// The unit of the clock.
    pub clock: Clock,
}

impl Room {
    /// True if times are kept in 32 bits.
    pub(crate) fn is_narrow(self) -> bool {
        self.clock != Clock::Nanoseconds
    }

    /// The comment about the clock at the head of the code; empty for nanoseconds.
    pub(crate) fn note(self) -> String {
        if !self.is_narrow() {
            return String::new();
        }
        let (unit, longest) = (self.clock.unit(), self.clock.longest() / 1_000_000_000);
        format!(
            "The time `now` is in {unit} and may begin again at 0. No time is longer than {longest} seconds: \
             what lasts longer stays there."
        )
    }
}
