//! The end of a run that the user or the system wants: Ctrl-C, or SIGTERM, which services and containers send.
//! All that is asked for is written then. A second signal ends the program at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};

use crate::failure::{Failure, refused};

/// Set by a signal.
pub(crate) struct Ended(Arc<AtomicBool>);

impl Ended {
    /// Listens from here on.
    ///
    /// # Errors
    ///
    /// The system refuses.
    pub(crate) fn new() -> Result<Ended, Failure> {
        let flag = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            signal_hook::flag::register_conditional_default(signal, flag.clone()).map_err(refused)?;
            signal_hook::flag::register(signal, flag.clone()).map_err(refused)?;
        }
        Ok(Ended(flag))
    }

    /// True as soon as a signal has come.
    pub(crate) fn is_so(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
