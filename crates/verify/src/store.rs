//! A set of images of equal length, numbered in the order in which they came.

use crate::rows::{Key, Rows, mix};

/// A set of images, all of one length. They stand packed one behind the other; a table of slots finds them.
pub struct Store {
    rows: Rows,
    /// The number of an image in the lower bits, some bits of its hash in those above; or `FREE`. There
    /// are `2^bits` slots, at least a quarter free, so that a number fits into the lower `bits`.
    slots: Vec<u32>,
    bits: u32,
    key: Key,
}

/// No number has all bits set, since some slots are free.
const FREE: u32 = u32::MAX;
/// Slots of an empty store, as a power of 2.
const LEAST: u32 = 6;

/// A place in the table.
#[derive(Clone, Copy)]
struct Place {
    at: usize,
    /// The bits that stand above the number there.
    tag: u32,
}

impl Default for Store {
    fn default() -> Store {
        Store::new()
    }
}

impl Store {
    /// An empty set.
    pub fn new() -> Store {
        Store { rows: Rows::new(), slots: vec![FREE; 1 << LEAST], bits: LEAST, key: Key::new() }
    }

    /// The number of images.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// The image with a number; an empty one if there is none.
    pub fn image(&self, number: usize) -> Vec<u64> {
        let mut image = Vec::new();
        self.get(number, &mut image);
        image
    }

    /// The same in a room that stands.
    pub fn get(&self, number: usize, image: &mut Vec<u64>) {
        self.rows.get(number, image);
    }

    /// The last word of an image.
    pub(crate) fn last_word(&self, number: usize) -> Option<u64> {
        self.rows.last_word(number)
    }

    /// True if an image is there. Two are equal only if all words agree.
    pub(crate) fn contains(&mut self, image: &[u64]) -> bool {
        let mut key = std::mem::take(&mut self.key);
        let found = self.rows.pack(image, &mut key) && self.find(&key).is_err();
        self.key = key;
        found
    }

    /// True if there is no image.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The number of an image that is there.
    pub fn number(&self, image: &[u64]) -> Option<u32> {
        let mut key = Key::new();
        let fits = self.rows.pack(image, &mut key);
        if fits { self.find(&key).err() } else { None }
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        self.rows.bytes() + self.slots.len() * 4
    }

    /// Adds an image; tells whether it is new.
    pub(crate) fn insert(&mut self, image: &[u64]) -> bool {
        self.find_or_insert(image).is_none()
    }

    /// The number of an image that is there; one that is not is added.
    pub fn find_or_insert(&mut self, image: &[u64]) -> Option<u32> {
        let mut key = std::mem::take(&mut self.key);
        let found = self.find_or_add(image, &mut key);
        self.key = key;
        found
    }

    fn find_or_add(&mut self, image: &[u64], key: &mut Key) -> Option<u32> {
        if !self.rows.pack(image, key) {
            // A word has a value that it never had: the image cannot be there.
            let before = self.rows.layout();
            self.rows.widen(image);
            if self.rows.layout() != before {
                self.index(self.bits);
            }
            let packed = self.rows.pack(image, key);
            debug_assert!(packed, "the layout was made for it");
        }
        if (self.len() + 1) * 4 > self.slots.len() * 3 {
            self.index(self.bits + 1);
        }
        let place = match self.find(key) {
            Ok(place) => place,
            Err(number) => return Some(number),
        };
        let number = self.len() as u32;
        self.rows.push_key(key);
        self.put(place, number);
        None
    }

    fn place(&self, key: &Key) -> Place {
        let hash = key.iter().fold(0, |h, w| mix(h, *w));
        Place {
            at: (hash >> (64 - self.bits)) as usize,
            tag: (hash as u32).checked_shl(self.bits).unwrap_or(0),
        }
    }

    fn put(&mut self, place: Place, number: u32) {
        if let Some(slot) = self.slots.get_mut(place.at) {
            *slot = place.tag | number;
        }
    }

    /// The free place for an image that is not there, or the number of one that is.
    fn find(&self, key: &Key) -> Result<Place, u32> {
        let (mask, low) = (self.slots.len() - 1, 1u32.checked_shl(self.bits).unwrap_or(0).wrapping_sub(1));
        let mut place = self.place(key);
        loop {
            match self.slots.get(place.at).copied() {
                Some(FREE) | None => return Ok(place),
                Some(slot) if slot & !low == place.tag && self.rows.is((slot & low) as usize, key) => {
                    return Err(slot & low);
                }
                Some(_) => place.at = (place.at + 1) & mask,
            }
        }
    }

    /// Makes the table anew, with at least `2^bits` slots.
    fn index(&mut self, bits: u32) {
        self.bits = bits;
        while (self.len() + 1) * 4 > (1usize << self.bits) * 3 {
            self.bits += 1;
        }
        self.slots.clear();
        self.slots.resize(1 << self.bits, FREE);
        let (mask, mut key) = (self.slots.len() - 1, Key::new());
        for number in 0..self.len() {
            self.rows.key(number, &mut key);
            let mut place = self.place(&key);
            while self.slots.get(place.at).is_some_and(|s| *s != FREE) {
                place.at = (place.at + 1) & mask;
            }
            self.put(place, number as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Store;
    use std::collections::HashMap;

    /// Images whose words begin to vary one after the other, and get wider.
    fn image(x: u64, n: u64) -> Vec<u64> {
        let time = 0u64.wrapping_sub((x >> 45) % 30 * 10_000_000);
        vec![8, (x >> 40) % 100, if n > 4000 { time } else { 0 }, ((x >> 50) % 6) << (n / 4000 * 9), 1]
    }

    #[test]
    fn a_store_is_a_set_with_numbers() {
        let (mut store, mut set) = (Store::new(), HashMap::new());
        let mut x = 1u64;
        for n in 0..20_000 {
            x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let image = image(x, n);
            assert_eq!(store.contains(&image), set.contains_key(&image));
            let number = set.len() as u32;
            assert_eq!(store.find_or_insert(&image), set.get(&image).copied(), "image {n}");
            set.entry(image).or_insert(number);
            assert_eq!(store.len(), set.len());
        }
        assert!(set.len() > 9000, "{}", set.len());
        for number in 0..store.len() {
            assert_eq!(set.get(&store.image(number)), Some(&(number as u32)));
        }
    }
}
