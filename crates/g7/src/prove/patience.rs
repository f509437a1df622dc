//! When a search ends before its time: the time is over, or Ctrl-C was pressed. What is known by then is
//! printed.
//!
//! The work on a file is done by a thread of its own, so that the program answers in time even where the
//! work does not ask the clock: a chart with a million steps takes a while to be read and compiled.

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use g7_host::{Clock, WallClock};
use g7_model::{Nanos, Said, say};

use crate::failure::{Failure, raw, refused};

/// Tells that the work is to stop.
pub(super) type Stop = Arc<dyn Fn() -> bool + Send + Sync>;

/// Time between two looks at the clock while a thread works.
const LOOK: Duration = Duration::from_millis(20);
/// Looks that a search has to end by itself: it asks for the time often, but not at every moment.
const SEARCH_ENDS: u32 = 500;
/// The same where there are more questions than [`MANY`]: what comes before the first scan takes long there, and
/// nothing is decided yet.
const BIG_ENDS: u32 = 25;
const MANY: usize = 20_000;
/// Stack of the thread: as large as that of the main thread on most systems.
const STACK: usize = 8 << 20;

/// The part of the work on a file that is being done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    /// The text is read.
    Read,
    /// The chart and its questions are compiled.
    Compile,
    /// The questions are answered.
    Search,
    /// All is known, and is put into words.
    Tell,
}

/// The phase of a work, for whoever waits for it.
#[derive(Clone, Default)]
pub(super) struct Progress {
    phase: Arc<AtomicU8>,
    questions: Arc<AtomicUsize>,
}

impl Progress {
    pub(super) fn enter(&self, phase: Phase) {
        self.phase.store(phase as u8, Ordering::Relaxed);
    }

    /// A search for the answers of so many questions begins.
    pub(super) fn search(&self, questions: usize) {
        self.questions.store(questions, Ordering::Relaxed);
        self.enter(Phase::Search);
    }

    /// The number of questions of the last search.
    pub(super) fn questions(&self) -> usize {
        self.questions.load(Ordering::Relaxed)
    }

    fn phase(&self) -> Phase {
        let all = [Phase::Read, Phase::Compile, Phase::Search];
        all.into_iter().find(|p| *p as u8 == self.phase.load(Ordering::Relaxed)).unwrap_or(Phase::Tell)
    }
}

/// A time that is used up by one work after another.
#[derive(Clone)]
pub(super) struct Share {
    pressed: Arc<AtomicBool>,
    clock: Arc<Mutex<WallClock>>,
    time: Nanos,
}

impl Share {
    /// The part that each of so many works has of what is left.
    pub(super) fn part(&self, works: usize) -> Nanos {
        let left = self.time.count().saturating_sub(self.now().count()).max(0);
        Nanos::new(left / i64::try_from(works).unwrap_or(i64::MAX).max(1))
    }

    /// True as soon as the time is over, or Ctrl-C was pressed.
    pub(super) fn stop(&self) -> Stop {
        let share = self.clone();
        Arc::new(move || share.pressed.load(Ordering::Relaxed) || share.now() >= share.time)
    }

    fn now(&self) -> Nanos {
        self.clock.lock().unwrap_or_else(PoisonError::into_inner).now()
    }
}

/// Knows whether Ctrl-C was pressed. A second time it ends the program.
#[derive(Clone)]
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

    /// A time that begins now.
    pub(super) fn share(&self, time: Nanos) -> Share {
        Share { pressed: self.pressed.clone(), clock: Arc::new(Mutex::new(WallClock::default())), time }
    }

    /// True as soon as Ctrl-C was pressed.
    pub(super) fn pressed(&self) -> Stop {
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
    pub(super) fn within(&self, time: Nanos) -> Stop {
        self.share(time).stop()
    }

    /// Why a search was stopped: Ctrl-C was pressed, the whole time is over, or the part of it that a file
    /// has.
    pub(super) fn reason(&self, whole: &Share) -> Said {
        let time = raw(whole.time.plain());
        if self.pressed.load(Ordering::Relaxed) {
            say!("stopped by Ctrl-C")
        } else if whole.now() >= whole.time {
            say!("the time of {time} is over")
        } else {
            say!("the file's share of the time of {time} is used up")
        }
    }

    /// Does a work in a thread and waits for it. Gives the phase in which it was given up: when it is to
    /// stop and nothing is decided yet, or a search does not end by itself. The thread goes on then, and ends
    /// with the program.
    ///
    /// # Errors
    ///
    /// The system refuses a thread.
    pub(super) fn wait<T: Send + 'static>(
        stop: &Stop,
        progress: &Progress,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Result<Result<T, Phase>, Failure> {
        let (send, receive) = channel();
        let thread = std::thread::Builder::new().name("prove".to_owned()).stack_size(STACK);
        let thread = thread
            .spawn(move || {
                // Nobody listens any more to a work that was given up.
                send.send(work()).ok();
            })
            .map_err(refused)?;
        let mut late = 0;
        loop {
            match receive.recv_timeout(LOOK) {
                Ok(done) => return Ok(Ok(done)),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    // Only a panic ends the thread without a result: it is the same here.
                    if let Err(panic) = thread.join() {
                        std::panic::resume_unwind(panic);
                    }
                    return Err(Failure::Usage(say!("the work ended without a result")));
                }
            }
            if !stop() {
                continue;
            }
            late += 1;
            match progress.phase() {
                Phase::Tell => {}
                Phase::Search if late < BIG_ENDS => {}
                Phase::Search if late < SEARCH_ENDS && progress.questions() <= MANY => {}
                phase => return Ok(Err(phase)),
            }
        }
    }
}
