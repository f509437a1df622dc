//! The one who saves the values that are kept: it takes what the scan hands on, and writes what has changed.
//!
//! ```text
//! scan -> Exchange -> Saver -> Slots -> Disk
//! ```
//!
//! A thread calls it from time to time, or a simulator. However long the disk takes, and whatever it does, the
//! scan does not notice. Values that could not be saved are tried again with the next ones, which are newer.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::exchange::Reader;
use crate::keep::KeptFile;
use crate::slots::{Disk, Slots};

/// The one who saves values.
pub struct Saver<D> {
    slots: Slots<D>,
    from_scan: Reader,
    words: Vec<u64>,
    /// The values that were saved last; none at first.
    saved: Vec<u64>,
    failing: bool,
}

impl<D: Disk> Saver<D> {
    /// Saves in this file from here on.
    pub fn new(kept: KeptFile<D>) -> Saver<D> {
        let KeptFile { slots, from_scan, words } = kept;
        Saver { slots, from_scan, words: vec![0; words], saved: Vec::new(), failing: false }
    }

    /// From here on the values come from another chart.
    pub fn renew(&mut self, from_scan: Reader) {
        self.words = vec![0; from_scan.words()];
        self.from_scan = from_scan;
    }

    /// Saves the values that the scan has handed on since the last call, if they are others.
    ///
    /// # Errors
    ///
    /// Saving begins to fail; while it goes on failing, this says nothing more.
    pub fn save(&mut self) -> io::Result<()> {
        let mut words = std::mem::take(&mut self.words);
        let done = if self.from_scan.take(&mut words) { self.save_these(&words) } else { Ok(()) };
        self.words = words;
        done
    }

    /// Saves these values, if they are others than the last ones.
    pub(crate) fn save_these(&mut self, words: &[u64]) -> io::Result<()> {
        if self.saved == words {
            return Ok(());
        }
        if self.slots.words() != words.len() {
            self.slots.renew(words.len());
        }
        // An error in what stands behind the disk does not end the saving of later values.
        let done = catch_unwind(AssertUnwindSafe(|| self.slots.save(words)));
        match done.unwrap_or_else(|_| Err(io::Error::other("an error of G7"))) {
            Ok(()) => {
                self.saved = words.to_vec();
                self.failing = false;
                Ok(())
            }
            Err(_) if self.failing => Ok(()),
            Err(e) => {
                self.failing = true;
                Err(e)
            }
        }
    }
}
