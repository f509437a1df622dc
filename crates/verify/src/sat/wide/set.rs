//! A set of packed states, all of one width, numbered in the order in which they came.
//!
//! A state of one word stands in the table itself; of a longer one, the table has its number and a part of
//! its hash. Many states are looked up at a time: first the place of each is read, so that the processor
//! waits for all of them together, and then they are compared.

use super::lanes::LANES;
use crate::rows::mix;

/// Slots of an empty set.
const LEAST: usize = 256;
/// Bits of a number in a slot of a set whose states have several words.
const NUMBER: u32 = 32;

pub(super) struct Set {
    /// Words of a state.
    width: usize,
    /// All states, one behind the other.
    rows: Vec<u64>,
    /// 0 where nothing is. Else 1 more than the state of one word, or the upper half of the hash and 1 more
    /// than the number of the state.
    slots: Vec<u64>,
    len: usize,
}

impl Set {
    /// An empty set of states with so many bits.
    pub(super) fn new(bits: usize) -> Set {
        // One bit stays free, so that 1 more than a state is not 0.
        Set { width: bits / 64 + 1, rows: Vec::new(), slots: vec![0; LEAST], len: 0 }
    }

    /// Words of a state.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Bytes of the states.
    pub(super) fn bytes(&self) -> usize {
        8 * (self.rows.capacity() + self.slots.len())
    }

    /// A state by its number.
    pub(super) fn get(&self, number: usize) -> &[u64] {
        self.rows(number, 1)
    }

    /// So many states from a number on, one behind the other.
    pub(super) fn rows(&self, start: usize, count: usize) -> &[u64] {
        self.rows.get(start * self.width..(start + count) * self.width).unwrap_or(&[])
    }

    /// Adds the states of a list, one behind the other; calls `new` with the place in the list of each
    /// that was not there.
    pub(super) fn add(&mut self, list: &[u64], mut new: impl FnMut(usize)) {
        let mut hashes = [0u64; LANES];
        let mut seen = [0u64; LANES];
        for (block, rows) in list.chunks(LANES * self.width).enumerate() {
            let count = rows.len() / self.width;
            // The table stays as it is within a block.
            while (self.len + count) * 4 > self.slots.len() * 3 {
                self.grow(count);
            }
            for ((row, hash), seen) in rows.chunks_exact(self.width).zip(&mut hashes).zip(&mut seen) {
                *hash = hash_of(row);
                *seen = self.slots.get(self.place(*hash)).copied().unwrap_or(0);
            }
            for (k, ((row, hash), seen)) in rows.chunks_exact(self.width).zip(&hashes).zip(&seen).enumerate()
            {
                if !self.is_in(*seen, row, *hash) && self.add_one(row, *hash) {
                    new(block * LANES + k);
                }
            }
        }
    }

    /// True if a state is there.
    pub(super) fn contains(&self, row: &[u64]) -> bool {
        let hash = hash_of(row);
        let mut place = self.place(hash);
        loop {
            match self.slots.get(place).copied().unwrap_or(0) {
                0 => return false,
                slot if self.is_in(slot, row, hash) => return true,
                _ => place = self.after(place),
            }
        }
    }

    #[inline(always)]
    fn place(&self, hash: u64) -> usize {
        ((u128::from(hash) * self.slots.len() as u128) >> 64) as usize
    }

    #[inline(always)]
    fn after(&self, place: usize) -> usize {
        if place + 1 == self.slots.len() { 0 } else { place + 1 }
    }

    /// True if a slot has this state.
    #[inline(always)]
    fn is_in(&self, slot: u64, row: &[u64], hash: u64) -> bool {
        match row {
            [word] => slot == word + 1,
            _ => {
                let number = slot & ((1 << NUMBER) - 1);
                slot != 0
                    && slot >> NUMBER == hash & ((1 << NUMBER) - 1)
                    && self.get((number - 1) as usize) == row
            }
        }
    }

    /// The slot for the state that comes next.
    fn slot(&self, row: &[u64], hash: u64, number: usize) -> u64 {
        match row {
            [word] => word + 1,
            _ => hash << NUMBER | (number as u64 + 1),
        }
    }

    fn add_one(&mut self, row: &[u64], hash: u64) -> bool {
        let mut place = self.place(hash);
        loop {
            match self.slots.get(place).copied().unwrap_or(0) {
                0 => break,
                slot if self.is_in(slot, row, hash) => return false,
                _ => place = self.after(place),
            }
        }
        let slot = self.slot(row, hash, self.len);
        if let Some(to) = self.slots.get_mut(place) {
            *to = slot;
        }
        self.rows.extend_from_slice(row);
        self.len += 1;
        true
    }

    /// Makes room for so many states more.
    fn grow(&mut self, more: usize) {
        // The old table is not needed: all states stand in their rows.
        self.slots = Vec::new();
        self.slots = vec![0; ((self.len + more) / 10 * 17).max(4 * LANES)];
        // As many as the table takes before it grows again.
        let most = (self.slots.len() * 3 / 4 + 1) * self.width;
        self.rows.reserve_exact(most.saturating_sub(self.rows.len()));
        for number in 0..self.len {
            let row = self.rows(number, 1);
            let hash = hash_of(row);
            let slot = self.slot(row, hash, number);
            let mut place = self.place(hash);
            while self.slots.get(place).is_some_and(|s| *s != 0) {
                place = self.after(place);
            }
            if let Some(to) = self.slots.get_mut(place) {
                *to = slot;
            }
        }
    }
}

/// The hash of a state. The upper bits choose the place, the lower ones tell states of one place apart.
#[inline(always)]
pub(super) fn hash_of(row: &[u64]) -> u64 {
    row.iter().fold(0, |h, w| mix(h, *w))
}

#[cfg(test)]
mod tests {
    use super::Set;
    use std::collections::HashSet;

    #[test]
    fn it_is_a_set_with_numbers() {
        for bits in [40, 63, 64, 150] {
            let mut set = Set::new(bits);
            let (mut known, mut order) = (HashSet::new(), Vec::new());
            let mut x = bits as u64;
            for round in 0..40 {
                let list: Vec<u64> = (0..700 * set.width())
                    .map(|_| {
                        x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                        (x >> 50) % (40 + 3 * round)
                    })
                    .collect();
                let mut new = Vec::new();
                set.add(&list, |place| new.push(place));
                for (place, row) in list.chunks(set.width()).enumerate() {
                    assert_eq!(
                        known.insert(row.to_vec()),
                        new.contains(&place),
                        "{bits} bits, state {place}"
                    );
                    if new.contains(&place) {
                        order.push(row.to_vec());
                    }
                }
            }
            assert_eq!(set.len(), order.len());
            assert!(order.len() > 100);
            for (number, row) in order.iter().enumerate() {
                assert_eq!(set.get(number), row.as_slice());
                assert!(set.contains(row));
            }
            assert!(!set.contains(&vec![7777; set.width()]));
        }
    }
}
