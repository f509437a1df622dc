//! Changes of one signal in a row, packed: the time since the change before, then the value against the one
//! before. A change of a BOOL has three or four bytes, one of a number a few more.

use g7_host::{Kind, Value};

/// Changes of a chunk, so that a busy one is passed over by its summary.
pub(super) const MOST: usize = 512;

/// Packed changes with their summary.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Packed {
    pub(super) kind: Kind,
    /// The first change and the last one, in us of the record.
    pub(super) start: i64,
    pub(super) stop: i64,
    pub(super) count: usize,
    /// The last value.
    pub(super) last: u64,
    /// The least and the greatest value, as numbers; none where no value is a number.
    pub(super) range: Option<(f64, f64)>,
    pub(super) data: Vec<u8>,
}

impl Packed {
    pub(super) fn new(kind: Kind) -> Packed {
        Packed { kind, start: 0, stop: 0, count: 0, last: 0, range: None, data: Vec::new() }
    }

    /// Adds a change; one that would be before the last counts as at the same time.
    pub(super) fn push(&mut self, at: i64, word: u64) {
        if self.count == 0 {
            (self.start, self.stop) = (at, at);
        }
        let at = at.max(self.stop);
        let after = at.abs_diff(self.stop);
        match self.kind {
            Kind::Bool => put(&mut self.data, u128::from(after) << 1 | u128::from(word & 1)),
            Kind::Int { .. } | Kind::Time | Kind::Moment(_) | Kind::Text => {
                put(&mut self.data, u128::from(after));
                let moved = word.wrapping_sub(self.last) as i64;
                put(&mut self.data, u128::from((moved << 1 ^ moved >> 63) as u64));
            }
            Kind::Real | Kind::Lreal => {
                put(&mut self.data, u128::from(after));
                put_trimmed(&mut self.data, word ^ self.last);
            }
        }
        let number = Value::Word(word).number(self.kind);
        if !number.is_nan() {
            let (low, high) = self.range.unwrap_or((number, number));
            self.range = Some((low.min(number), high.max(number)));
        }
        (self.stop, self.last, self.count) = (at, word, self.count + 1);
    }
}

/// A number in groups of 7 bits, the lowest first.
pub(super) fn put(data: &mut Vec<u8>, mut number: u128) {
    while number >= 0x80 {
        data.push(number as u8 | 0x80);
        number >>= 7;
    }
    data.push(number as u8);
}

/// The bytes of a word between its zeros; a byte in front says where and how many.
fn put_trimmed(data: &mut Vec<u8>, word: u64) {
    let low = word.trailing_zeros() / 8 % 8;
    let count = 8 - word.leading_zeros() / 8;
    let count = count.saturating_sub(low);
    data.push((low << 4 | count) as u8);
    data.extend((word >> (8 * low)).to_le_bytes().iter().take(count as usize));
}

/// Takes a number off the front; `None` where there is none.
pub(super) fn take(data: &mut &[u8]) -> Option<u128> {
    let (mut number, mut shift) = (0u128, 0);
    loop {
        let (byte, rest) = data.split_first()?;
        *data = rest;
        if shift > 70 {
            return None;
        }
        number |= u128::from(byte & 0x7F) << shift;
        shift += 7;
        if byte & 0x80 == 0 {
            return Some(number);
        }
    }
}

fn take_trimmed(data: &mut &[u8]) -> Option<u64> {
    let (head, rest) = data.split_first()?;
    let (low, count) = (u32::from(head >> 4), usize::from(head & 15));
    let (bytes, rest) = rest.split_at_checked(count).filter(|_| count <= 8 && low < 8)?;
    *data = rest;
    let word = bytes.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte));
    Some(word << (8 * low))
}

/// The changes of packed data; a damaged one ends them.
pub(super) struct Changes<'a> {
    kind: Kind,
    data: &'a [u8],
    at: i64,
    word: u64,
}

impl Changes<'_> {
    /// Those that begin at a time.
    pub(super) fn new(kind: Kind, start: i64, data: &[u8]) -> Changes<'_> {
        Changes { kind, data, at: start, word: 0 }
    }
}

impl Iterator for Changes<'_> {
    type Item = (i64, u64);

    fn next(&mut self) -> Option<(i64, u64)> {
        let head = take(&mut self.data)?;
        let after = match self.kind {
            Kind::Bool => {
                self.word = (head & 1) as u64;
                head >> 1
            }
            Kind::Int { .. } | Kind::Time | Kind::Moment(_) | Kind::Text => {
                let moved = u64::try_from(take(&mut self.data)?).ok()?;
                let moved = (moved >> 1) as i64 ^ -((moved & 1) as i64);
                self.word = self.word.wrapping_add(moved as u64);
                head
            }
            Kind::Real | Kind::Lreal => {
                self.word ^= take_trimmed(&mut self.data)?;
                head
            }
        };
        self.at = self.at.checked_add(i64::try_from(after).ok()?)?;
        Some((self.at, self.word))
    }
}

/// The packed changes of several signals one behind the other: a batch.
pub(super) fn put_batch(batch: &mut Vec<u8>, signal: i64, packed: &Packed) {
    put(batch, u128::from(signal.unsigned_abs()));
    put(batch, u128::from(packed.start.max(0).unsigned_abs()));
    put(batch, packed.data.len() as u128);
    batch.extend(&packed.data);
}

/// A part of a batch: the signal, its first instant, its data.
pub(super) fn take_batch<'a>(batch: &mut &'a [u8]) -> Option<(i64, i64, &'a [u8])> {
    let signal = i64::try_from(take(batch)?).ok()?;
    let start = i64::try_from(take(batch)?).ok()?;
    let length = usize::try_from(take(batch)?).ok()?;
    let (data, rest) = batch.split_at_checked(length)?;
    *batch = rest;
    Some((signal, start, data))
}
