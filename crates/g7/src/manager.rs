//! Tells the service manager, if one has started this process, how the controller does (sd_notify(3)).
//! Without one, and on systems other than Linux, nothing is told.

use std::time::Duration;

use g7_host::{Clock, WallClock};
use g7_model::Nanos;

/// A message to the manager.
#[derive(Clone, Copy, Debug)]
enum Sign<'a> {
    Ready,
    Alive,
    Status(&'a str),
    Stopping,
}

/// The service manager.
pub(crate) struct Manager {
    clock: WallClock,
    /// The time between two signs of life, if the manager wants them.
    every: Option<Nanos>,
    next: Nanos,
}

impl Manager {
    /// Tells the manager that the controller has started.
    pub(crate) fn ready() -> Manager {
        tell(Sign::Ready);
        // Twice as often as the manager wants, as sd_watchdog_enabled(3) advises.
        let every = watchdog().map(|time| nanos(time / 2));
        Manager { clock: WallClock::default(), every, next: Nanos::ZERO }
    }

    /// Gives the manager a sign of life where one is due.
    pub(crate) fn alive(&mut self) {
        let now = self.clock.now();
        if let Some(every) = self.every
            && now >= self.next
        {
            self.next = now + every;
            tell(Sign::Alive);
        }
    }

    /// Says in a few words how it goes; colours are left out.
    pub(crate) fn status(&self, text: &str) {
        tell(Sign::Status(&anstream::adapter::strip_str(text).to_string()));
    }

    /// Says that the controller ends.
    pub(crate) fn stopping(&self) {
        tell(Sign::Stopping);
    }
}

fn nanos(time: Duration) -> Nanos {
    Nanos::new(i64::try_from(time.as_nanos()).unwrap_or(i64::MAX))
}

#[cfg(target_os = "linux")]
fn watchdog() -> Option<Duration> {
    sd_notify::watchdog_enabled()
}

#[cfg(not(target_os = "linux"))]
fn watchdog() -> Option<Duration> {
    None
}

#[cfg(target_os = "linux")]
fn tell(sign: Sign<'_>) {
    use sd_notify::NotifyState;
    let state = match sign {
        Sign::Ready => NotifyState::Ready,
        Sign::Alive => NotifyState::Watchdog,
        Sign::Status(text) => NotifyState::Status(text),
        Sign::Stopping => NotifyState::Stopping,
    };
    // A manager that is gone cannot be told; the controller goes on.
    sd_notify::notify(&[state]).ok();
}

#[cfg(not(target_os = "linux"))]
fn tell(_: Sign<'_>) {}
