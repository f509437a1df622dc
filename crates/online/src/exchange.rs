//! Words that one thread hands on to another, neither of them ever waiting.
//!
//! There are three slots. The writer fills one that nobody else has and exchanges it for the middle
//! one; the reader exchanges its own for the middle one where that is new. So the reader always has
//! the words of one call of [`Writer::put`] as a whole, and the latest ones. What was put in between
//! is lost on purpose: an input has one value, the present one.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};

/// The middle slot has words that the reader has not seen.
const NEW: u8 = 4;

#[derive(Debug)]
struct Shared {
    slots: [Box<[AtomicU64]>; 3],
    /// Number of the slot that neither side has, with [`NEW`].
    middle: AtomicU8,
}

impl Shared {
    fn slot(&self, number: u8) -> &[AtomicU64] {
        self.slots.get(usize::from(number)).map_or(&[], |s| s)
    }
}

/// The side that gives words.
#[derive(Debug)]
pub struct Writer {
    shared: Arc<Shared>,
    own: u8,
}

/// The side that takes words.
#[derive(Debug)]
pub struct Reader {
    shared: Arc<Shared>,
    own: u8,
}

/// Makes both sides of an exchange of so many words, which are 0 at first.
pub fn exchange(words: usize) -> (Writer, Reader) {
    let slot = || (0..words).map(|_| AtomicU64::new(0)).collect();
    let shared = Arc::new(Shared { slots: [slot(), slot(), slot()], middle: AtomicU8::new(1) });
    (Writer { shared: Arc::clone(&shared), own: 0 }, Reader { shared, own: 2 })
}

impl Writer {
    /// Gives words to the reader; words beyond the given ones are those of an earlier call.
    pub fn put(&mut self, words: impl IntoIterator<Item = u64>) {
        for (to, word) in self.shared.slot(self.own).iter().zip(words) {
            to.store(word, Ordering::Relaxed);
        }
        // The reader that takes the number of this slot sees all that was stored in it.
        self.own = self.shared.middle.swap(self.own | NEW, Ordering::AcqRel) & !NEW;
    }
}

impl Reader {
    /// The number of words.
    pub(crate) fn words(&self) -> usize {
        self.shared.slot(self.own).len()
    }

    /// Takes the latest words. Returns false, and changes nothing, where nothing was put since the
    /// last call.
    pub fn take(&mut self, into: &mut [u64]) -> bool {
        if self.shared.middle.load(Ordering::Relaxed) & NEW == 0 {
            return false;
        }
        self.own = self.shared.middle.swap(self.own, Ordering::AcqRel) & !NEW;
        for (word, from) in into.iter_mut().zip(self.shared.slot(self.own)) {
            *word = from.load(Ordering::Relaxed);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    use super::exchange;

    #[test]
    fn the_latest_words_are_taken_once() {
        let (mut writer, mut reader) = exchange(2);
        let mut words = [9, 9];
        assert!(!reader.take(&mut words));
        assert_eq!(words, [9, 9]);
        writer.put([1, 2]);
        writer.put([3, 4]);
        assert!(reader.take(&mut words));
        assert_eq!(words, [3, 4]);
        assert!(!reader.take(&mut words));
        writer.put([5, 6]);
        assert!(reader.take(&mut words));
        assert_eq!(words, [5, 6]);
    }

    #[test]
    fn words_of_two_calls_are_never_mixed_and_never_go_back() {
        const TAKEN: u32 = 1_000;
        let (mut writer, mut reader) = exchange(16);
        let enough = Arc::new(AtomicBool::new(false));
        let over = Arc::clone(&enough);
        let giver = std::thread::spawn(move || {
            let mut given = 0;
            while !over.load(Ordering::Relaxed) {
                given += 1;
                writer.put([given; 16]);
            }
            given
        });
        let (mut words, mut before, mut taken) = ([0; 16], 0, 0);
        while taken < TAKEN {
            if reader.take(&mut words) {
                assert_eq!(words, [words[0]; 16]);
                assert!(words[0] > before, "{} after {before}", words[0]);
                before = words[0];
                taken += 1;
            }
        }
        enough.store(true, Ordering::Relaxed);
        let given = giver.join().expect("the giver ends");
        reader.take(&mut words);
        assert_eq!(words, [given; 16], "the last words arrive");
    }
}
