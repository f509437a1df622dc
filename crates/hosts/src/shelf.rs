//! The states that one worker owns, and the way of each new image to its owner.
//!
//! An image goes to the worker that its own bits name. Before it is sent, a table of what went there lately
//! keeps back what the owner has by now. The owner keeps exact images. Of the scans that lead to a new state
//! it keeps the first in the order of one thread, whatever arrived first.

use g7_verify::Store;

use crate::exchange::{Lost, Phases};
use crate::pack::{Pack, owner};

/// Bits of a key for the number of a scan among those of its state.
pub(crate) const STEP: u32 = 24;
/// The bit of a key that says: the image follows as it is, since it does not fit.
const PLAIN: u64 = 1 << 63;
/// Entries of the table of images that were sent.
const RECENT: usize = 1 << 18;

/// The states of a worker.
pub(crate) struct Shelf {
    pub(crate) pack: Pack,
    /// Inputs, packed; all of their values fit.
    pub(crate) inputs: Pack,
    pub(crate) store: Store,
    /// Number of the first state of the level that is being found.
    pub(crate) from: usize,
    /// For each state of it: the rank of the state before, and the number of the scan.
    pub(crate) keys: Vec<u64>,
    /// For each state of it: the packed inputs of that scan.
    pub(crate) last: Vec<u64>,
    /// The level, as a mark in the table below.
    pub(crate) level: u64,
    /// For each entry: a packed image, the level and the key with which it was sent.
    recent: Vec<u64>,
    /// Images of this worker that do not fit, each with key and inputs, until the mask has grown.
    aside: Vec<u64>,
    /// The bits that the mask lacks.
    missing: Vec<u64>,
    /// Words arrived that are no images.
    broken: bool,
    image: Vec<u64>,
    given: Vec<u64>,
}

impl Shelf {
    pub(crate) fn new(pack: Pack, inputs: Pack) -> Shelf {
        Shelf {
            store: Store::new(),
            from: 0,
            keys: Vec::new(),
            last: Vec::new(),
            level: 0,
            recent: Vec::new(),
            aside: Vec::new(),
            missing: vec![0; pack.width()],
            broken: false,
            image: Vec::new(),
            given: Vec::new(),
            pack,
            inputs,
        }
    }

    /// Bytes in use.
    pub(crate) fn bytes(&self) -> usize {
        self.store.bytes() + (self.keys.len() + self.last.len() + self.recent.len()) * 8
    }

    /// Puts an image where it belongs.
    pub(crate) fn route(&mut self, image: &[u64], inputs: &[u64], key: u64, phases: &mut Phases<'_>) {
        let hash = self.pack.hash(image);
        let to = owner(hash, phases.peers());
        let mine = to == phases.me();
        self.image.clear();
        self.given.clear();
        let fits = self.pack.pack(image, &mut self.image);
        // Values that were not to be tried would show in the run alone.
        if !self.inputs.pack(inputs, &mut self.given) {
            self.given.resize(self.inputs.words(), 0);
        }
        if !fits {
            self.pack.differ(image, &mut self.missing);
        }
        match (mine, fits) {
            (true, true) => self.admit_own(key),
            (true, false) => {
                self.aside.push(key);
                self.aside.extend_from_slice(image);
                self.aside.extend_from_slice(&self.given);
            }
            (false, true) if self.was_sent(hash, key) => {}
            (false, true) => phases.send(to, &[&[key], &self.image, &self.given]),
            (false, false) => phases.send(to, &[&[key | PLAIN], image, &self.given]),
        }
    }

    /// True if the owner of the image in hand has it by now, with this key or one before it; else notes
    /// that it gets it.
    fn was_sent(&mut self, hash: u64, key: u64) -> bool {
        let words = self.image.len();
        if self.recent.is_empty() {
            self.recent = vec![u64::MAX; RECENT * (words + 2)];
        }
        let at = (hash as usize % RECENT) * (words + 2);
        let Some(entry) = self.recent.get_mut(at..at + words + 2) else { return false };
        let (image, mark) = entry.split_at_mut(words);
        let [level, first] = mark else { return false };
        if image == self.image && (*level < self.level || *first <= key) {
            return true;
        }
        image.copy_from_slice(&self.image);
        (*level, *first) = (self.level, key);
        false
    }

    /// Takes words that another worker has sent.
    pub(crate) fn take(&mut self, words: &[u64]) {
        let mut rest = words;
        while let Some((key, behind)) = rest.split_first() {
            let plain = key & PLAIN != 0;
            let width = if plain { self.pack.width() } else { self.pack.words() };
            let parts = behind.split_at_checked(width + self.inputs.words());
            let Some((record, behind)) = parts else {
                self.broken = true;
                return;
            };
            if plain {
                self.aside.push(key & !PLAIN);
                self.aside.extend_from_slice(record);
            } else {
                let (image, given) = record.split_at(width);
                self.image.clear();
                self.image.extend_from_slice(image);
                self.given.clear();
                self.given.extend_from_slice(given);
                self.admit_own(*key);
            }
            rest = behind;
        }
    }

    /// Adds the image in hand to the states, unless it is there.
    fn admit_own(&mut self, key: u64) {
        let Some(number) = self.store.find_or_insert(&self.image) else {
            self.keys.push(key);
            self.last.extend_from_slice(&self.given);
            return;
        };
        let Some(at) = (number as usize).checked_sub(self.from) else { return };
        let words = self.given.len();
        if let Some(first) = self.keys.get_mut(at).filter(|first| key < **first) {
            *first = key;
            if let Some(last) = self.last.get_mut(at * words..(at + 1) * words) {
                last.copy_from_slice(&self.given);
            }
        }
    }

    /// The bits that the mask lacks, to be told to all others.
    pub(crate) fn missing(&self) -> &[u64] {
        &self.missing
    }

    /// Ends a phase: with the bits that some worker misses, the mask grows, and what did not fit is added.
    ///
    /// # Errors
    ///
    /// Another worker has sent what is no image.
    pub(crate) fn settle(&mut self, masks: &[&[u64]]) -> Result<(), Lost> {
        let mut grown = false;
        for mask in masks.iter().filter(|m| m.iter().any(|w| *w != 0)) {
            let old = self.pack.clone();
            if self.pack.grow(mask) {
                self.pack_anew(&old);
                grown = true;
            }
        }
        self.missing.fill(0);
        if grown {
            self.recent.clear();
        }
        let aside = std::mem::take(&mut self.aside);
        let (width, inputs) = (self.pack.width(), self.inputs.words());
        for record in aside.chunks_exact(1 + width + inputs) {
            let (key, rest) = record.split_first().unwrap_or((&0, &[]));
            let (image, given) = rest.split_at(width);
            self.image.clear();
            self.given.clear();
            self.given.extend_from_slice(given);
            self.broken |= !self.pack.pack(image, &mut self.image);
            self.admit_own(*key);
        }
        if self.broken { Err(Lost::Gone) } else { Ok(()) }
    }

    fn pack_anew(&mut self, old: &Pack) {
        let mut store = Store::new();
        let (mut image, mut packed) = (Vec::new(), Vec::new());
        for number in 0..self.store.len() {
            old.unpack(&self.store.image(number), &mut image);
            packed.clear();
            self.pack.pack(&image, &mut packed);
            store.find_or_insert(&packed);
        }
        self.store = store;
    }
}
