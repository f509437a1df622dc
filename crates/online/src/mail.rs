//! Events on their way to a broker: the window between the one who keeps them and the one who publishes
//! them.
//!
//! The keeper puts letters in, oldest first; the device publishes them and says which the broker has
//! taken. A letter stays here until then, so that a new connection begins with the oldest one again.
//! Neither side waits for the other.
//!
//! Where the oldest were dropped, the letter that says so stands in front, and each such drop begins a new
//! turn: what is on its way is sent again behind that letter, so that the order holds.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Letters in the window at most.
const WINDOW: usize = 256;

/// An event with its number, as it is published.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Letter {
    /// Its number; later ones have greater numbers.
    pub number: i64,
    /// The payload of the message.
    pub payload: Vec<u8>,
}

#[derive(Debug, Default)]
struct Tray {
    ready: VecDeque<Letter>,
    /// How often letters were dropped.
    turn: u64,
    taken: Vec<i64>,
    refused: Option<String>,
}

/// The window; clones are the same.
#[derive(Clone, Debug, Default)]
pub struct Mail(Arc<Mutex<Tray>>);

impl Mail {
    fn lock(&self) -> MutexGuard<'_, Tray> {
        // A letter is put in or taken out whole.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The number of letters that there is room for.
    pub fn room(&self) -> usize {
        WINDOW.saturating_sub(self.lock().ready.len())
    }

    /// Puts letters behind those that are there.
    pub fn put(&self, letters: impl IntoIterator<Item = Letter>) {
        self.lock().ready.extend(letters);
    }

    /// Empties the window, because the oldest letters were dropped: the keeper puts the rest in anew, the letter
    /// that tells of it first.
    pub fn begin_anew(&self) {
        let mut tray = self.lock();
        tray.ready.clear();
        tray.turn += 1;
    }

    /// The numbers of the letters that the broker has taken since the last call.
    pub fn taken(&self) -> Vec<i64> {
        std::mem::take(&mut self.lock().taken)
    }

    /// Why the broker does not take letters, where it says so.
    pub fn refused(&self) -> Option<String> {
        self.lock().refused.clone()
    }

    /// The first letter behind a number, for the device, and the turn that it belongs to. Where that is another
    /// one than the device knows, it is the first letter of all.
    pub fn next(&self, turn: u64, number: i64) -> Option<(u64, Letter)> {
        // Numbers grow, so the letters that are on their way stand in front.
        let tray = self.lock();
        let at = if turn == tray.turn { tray.ready.partition_point(|l| l.number <= number) } else { 0 };
        Some((tray.turn, tray.ready.get(at)?.clone()))
    }

    /// Notes that the broker has taken a letter. What came before it on the connection was taken as well, so
    /// it may be the one that tells of a drop up to this number, too.
    pub fn take(&self, number: i64) {
        let mut tray = self.lock();
        tray.ready.retain(|letter| letter.number != number);
        tray.taken.push(number);
        tray.refused = None;
    }

    /// Notes that the broker has refused a letter.
    pub fn refuse(&self, why: String) {
        self.lock().refused = Some(why);
    }
}
