//! When a search ends before its time: the time is over, or Ctrl-C was pressed. What is known by then is
//! printed.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use g7_host::{Clock, WallClock};
use g7_model::Nanos;

use crate::failure::Failure;

/// Knows whether Ctrl-C was pressed. A second time it ends the program.
pub(super) struct Patience {
    pressed: Arc<AtomicBool>,
}

impl Patience {
    pub(super) fn new() -> Result<Patience, Failure> {
        let pressed = Arc::new(AtomicBool::new(false));
        for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
            signal_hook::flag::register_conditional_default(signal, pressed.clone())?;
            signal_hook::flag::register(signal, pressed.clone())?;
        }
        Ok(Patience { pressed })
    }

    /// True as soon as Ctrl-C was pressed.
    pub(super) fn pressed(&self) -> Arc<dyn Fn() -> bool + Send + Sync> {
        let pressed = self.pressed.clone();
        Arc::new(move || pressed.load(Ordering::Relaxed))
    }

    /// Counts the end of the standard input as Ctrl-C.
    pub(super) fn until_input_ends(&self) -> Result<(), Failure> {
        let pressed = self.pressed.clone();
        let watch = move || {
            // An input that cannot be read has ended too.
            let _end = std::io::copy(&mut std::io::stdin().lock(), &mut std::io::sink());
            pressed.store(true, Ordering::Relaxed);
        };
        std::thread::Builder::new().spawn(watch).map_err(crate::failure::refused)?;
        Ok(())
    }

    /// True as soon as this time is over, counted from now, or Ctrl-C was pressed.
    pub(super) fn within(&self, time: Nanos) -> Arc<dyn Fn() -> bool + Send + Sync> {
        let (pressed, clock) = (self.pressed.clone(), Mutex::new(WallClock::default()));
        Arc::new(move || {
            pressed.load(Ordering::Relaxed)
                || clock.lock().unwrap_or_else(PoisonError::into_inner).now() >= time
        })
    }
}
