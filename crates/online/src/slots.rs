//! Retained values in a file of two slots, of which one is always whole.
//!
//! A write goes to the slot that does not hold the latest values, and counts as soon as the disk has
//! it. Whenever power fails, the other slot has the values before. The file is laid out once and never
//! grows, so it can be written while the disk is full.
//!
//! ```text
//! slot: magic 8 | version 2 | 0 | length 4 | layout 8 | sequence 8 | values, length bytes | CRC-32 4
//! ```
//!
//! Numbers are little-endian. The slots have the same size and begin at multiples of 4096 bytes, so
//! that no sector belongs to both.

use std::io;

const MAGIC: &[u8; 8] = b"g7slots\n";
const VERSION: u16 = 1;
/// Bytes before the values.
const HEAD: usize = 32;
/// Bytes behind the values.
const TAIL: usize = 4;
/// No slot begins within a block of the other.
const BLOCK: usize = 4096;

/// The file as the slots see it: a real one, or one of a simulator that loses power.
pub trait Disk {
    /// Reads the whole file; empty where there is none yet.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    fn read(&mut self) -> io::Result<Vec<u8>>;
    /// Makes the file of these bytes, in place of an old one; whole or not at all, also where power
    /// fails meanwhile.
    ///
    /// # Errors
    ///
    /// The file is as it was.
    fn create(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Writes bytes at a place within the file.
    ///
    /// # Errors
    ///
    /// The bytes may have been written in part, or not at all.
    fn write(&mut self, at: u64, bytes: &[u8]) -> io::Result<()>;
    /// Returns after all that was written is safe against a loss of power.
    ///
    /// # Errors
    ///
    /// Bytes written since the last call may be lost.
    fn sync(&mut self) -> io::Result<()>;
}

/// Why no values could be loaded.
#[derive(Debug)]
pub enum SlotsError {
    /// The file cannot be read or written.
    Io(io::Error),
    /// It was written for another layout: its values, and what they were written for.
    Layout(Box<Loaded>),
    /// Neither slot is whole.
    Damaged,
}

impl std::fmt::Display for SlotsError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            SlotsError::Io(e) => write!(f, "{e}"),
            SlotsError::Layout(_) => f.write_str("it was written by another chart"),
            SlotsError::Damaged => f.write_str("both of its slots are damaged"),
        }
    }
}

impl std::error::Error for SlotsError {}

impl From<io::Error> for SlotsError {
    fn from(e: io::Error) -> SlotsError {
        SlotsError::Io(e)
    }
}

/// The values of the newest whole slot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loaded {
    /// The layout that they were saved for.
    pub layout: u64,
    /// The values as they were saved.
    pub words: Vec<u64>,
    /// How many times values were saved before and with these.
    pub sequence: u64,
    /// The other slot is damaged: a save was interrupted, or the disk is failing. These values may be
    /// those of the save before the last.
    pub other_damaged: bool,
}

/// The two slots of a file.
#[derive(Debug)]
pub struct Slots<D> {
    disk: D,
    layout: u64,
    words: usize,
    sequence: u64,
    /// The slot that the next save goes to.
    next: usize,
    /// The bytes of a save, kept so that a save does not allocate.
    bytes: Vec<u8>,
    /// The next save makes the file anew: the one that is there has another number of words.
    anew: bool,
}

impl<D: Disk> Slots<D> {
    /// Opens the slots for so many words of a layout and loads the values; `None` where none were
    /// saved yet. A new file is laid out at once, so that a full disk is noticed here and not later.
    ///
    /// # Errors
    ///
    /// The file cannot be read or laid out, belongs to another layout, or has no whole slot; it is
    /// left as it is then. [`Slots::begin`] begins it anew.
    pub fn open(mut disk: D, layout: u64, words: usize) -> Result<(Slots<D>, Option<Loaded>), SlotsError> {
        let bytes = disk.read()?;
        if bytes.is_empty() {
            return Ok((Slots::begin(disk, layout, words)?, None));
        }
        let found = [0, 1].map(|k| slot(&bytes, k * stride_of(&bytes, words)));
        let newest = match &found {
            [Some(a), Some(b)] => usize::from(b.sequence > a.sequence),
            [Some(_), None] => 0,
            [None, Some(_)] => 1,
            [None, None] => return Err(SlotsError::Damaged),
        };
        let [a, b] = found;
        let (newest_slot, other) = if newest == 0 { (a, b) } else { (b, a) };
        let Some(kept) = newest_slot else { return Err(SlotsError::Damaged) };
        let loaded = Loaded {
            layout: kept.layout,
            words: kept.words,
            sequence: kept.sequence,
            other_damaged: other.is_none(),
        };
        if loaded.layout != layout || loaded.words.len() != words {
            return Err(SlotsError::Layout(Box::new(loaded)));
        }
        let bytes = Vec::with_capacity(stride(words));
        let slots =
            Slots { disk, layout, words, sequence: loaded.sequence, next: 1 - newest, bytes, anew: false };
        Ok((slots, (loaded.sequence > 0 || loaded.other_damaged).then_some(loaded)))
    }

    /// Begins a file anew for so many words, whatever it held.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub fn begin(disk: D, layout: u64, words: usize) -> Result<Slots<D>, SlotsError> {
        let bytes = Vec::with_capacity(stride(words));
        let mut slots = Slots { disk, layout, words, sequence: 0, next: 0, bytes, anew: false };
        slots.create(0, &[])?;
        Ok(slots)
    }

    /// The number of words of a save.
    pub fn words(&self) -> usize {
        self.words
    }

    /// From here on saves another number of words. Until the first of them are saved, the file holds
    /// those before.
    pub fn renew(&mut self, words: usize) {
        (self.words, self.anew) = (words, true);
    }

    /// Makes the file with these values in the first slot.
    fn create(&mut self, sequence: u64, words: &[u64]) -> io::Result<()> {
        let mut file = Vec::with_capacity(2 * stride(self.words));
        for (sequence, words, end) in [(sequence, words, 1), (0, &[][..], 2)] {
            self.fill(sequence, words);
            file.extend(&self.bytes);
            file.resize(end * stride(self.words), 0);
        }
        self.disk.create(&file)
    }

    /// Saves values. They count after this has returned; until then, and after an error, those before
    /// them do.
    ///
    /// # Errors
    ///
    /// The disk failed. A later call tries again, in the same slot.
    pub fn save(&mut self, words: &[u64]) -> io::Result<()> {
        let sequence = self.sequence + 1;
        if self.anew {
            self.create(sequence, words)?;
            (self.sequence, self.next, self.anew) = (sequence, 1, false);
            return Ok(());
        }
        self.fill(sequence, words);
        self.disk.write((self.next * stride(self.words)) as u64, &self.bytes)?;
        self.disk.sync()?;
        (self.sequence, self.next) = (sequence, 1 - self.next);
        Ok(())
    }

    /// Makes the bytes of a slot; words that are not given are 0.
    fn fill(&mut self, sequence: u64, words: &[u64]) {
        self.bytes.clear();
        self.bytes.extend(MAGIC);
        self.bytes.extend(VERSION.to_le_bytes());
        self.bytes.extend([0; 2]);
        self.bytes.extend(((8 * self.words) as u32).to_le_bytes());
        self.bytes.extend(self.layout.to_le_bytes());
        self.bytes.extend(sequence.to_le_bytes());
        let given = words.iter().copied().chain(std::iter::repeat(0)).take(self.words);
        given.for_each(|w| self.bytes.extend(w.to_le_bytes()));
        let check = crc32fast::hash(&self.bytes);
        self.bytes.extend(check.to_le_bytes());
    }
}

/// Bytes of a slot, up to the beginning of the next one.
fn stride(words: usize) -> usize {
    (HEAD + 8 * words + TAIL).next_multiple_of(BLOCK)
}

/// The same of a file that may have been written for another number of words.
fn stride_of(bytes: &[u8], words: usize) -> usize {
    match bytes.len() / 2 {
        half if half > 0 && half % BLOCK == 0 => half,
        _ => stride(words),
    }
}

struct Slot {
    layout: u64,
    sequence: u64,
    words: Vec<u64>,
}

/// The slot that begins at a place, if it is whole.
fn slot(bytes: &[u8], at: usize) -> Option<Slot> {
    let (head, rest) = bytes.get(at..)?.split_at_checked(HEAD)?;
    let (magic, numbers) = head.split_at_checked(8)?;
    let number = |from: usize| Some(u64::from_le_bytes(*numbers.get(from..)?.first_chunk()?));
    let [version, length] = [number(0)? & 0xFFFF_FFFF, number(0)? >> 32];
    if magic != MAGIC || version != u64::from(VERSION) || length % 8 != 0 {
        return None;
    }
    let (values, tail) = rest.split_at_checked(usize::try_from(length).ok()?)?;
    let whole = bytes.get(at..at + HEAD + values.len())?;
    if u32::from_le_bytes(*tail.first_chunk()?) != crc32fast::hash(whole) {
        return None;
    }
    let words = values.as_chunks::<8>().0.iter().map(|w| u64::from_le_bytes(*w)).collect();
    Some(Slot { layout: number(8)?, sequence: number(16)?, words })
}
