//! A number that tells programs apart: equal tables have an equal one, on every
//! machine.

use core::hash::{Hash, Hasher};

use crate::tables::Tables;

/// Mixes in words as they come. The standard library promises no stable hash, and
/// an image may be saved on one machine and read on another.
struct Mix(u64);

impl Mix {
    fn add(&mut self, word: u64) {
        let mixed = (self.0 ^ word).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 = mixed ^ (mixed >> 29);
    }
}

impl Hasher for Mix {
    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            self.add(chunk.iter().rev().fold(0, |word, b| word << 8 | u64::from(*b)));
        }
    }

    fn write_u8(&mut self, i: u8) {
        self.add(u64::from(i));
    }

    fn write_u16(&mut self, i: u16) {
        self.add(u64::from(i));
    }

    fn write_u32(&mut self, i: u32) {
        self.add(u64::from(i));
    }

    fn write_u64(&mut self, i: u64) {
        self.add(i);
    }

    // Lengths and discriminants: as wide on a machine of 32 bits as on one of 64.
    fn write_usize(&mut self, i: usize) {
        self.add(i as u64);
    }

    fn write_isize(&mut self, i: isize) {
        self.add(i as u64);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

pub(crate) fn fingerprint(tables: &Tables) -> u64 {
    let mut mix = Mix(0);
    tables.hash(&mut mix);
    mix.finish()
}
