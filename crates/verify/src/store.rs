//! A set of images of equal length, numbered in the order in which they came.

/// A set of images of equal length, which stand one behind the other; a table of slots finds them.
pub struct Store {
    /// Words of an image.
    width: usize,
    images: Vec<u64>,
    len: usize,
    /// Number of an image, or `FREE`. There are `2^n` slots, at least a third free.
    slots: Vec<u32>,
}

const FREE: u32 = u32::MAX;

impl Store {
    /// An empty set of images of so many words.
    pub fn new(width: usize) -> Store {
        Store { width, images: Vec::new(), len: 0, slots: vec![FREE; 64] }
    }

    /// The number of images.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True if there is no image.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// An image by its number; empty if there is none.
    pub fn image(&self, number: usize) -> &[u64] {
        self.images.get(number * self.width..(number + 1) * self.width).unwrap_or(&[])
    }

    /// True if an image is there. Two are equal only if all words agree.
    pub(crate) fn contains(&self, image: &[u64]) -> bool {
        self.slot(image).is_err()
    }

    /// The number of an image that is there.
    pub fn find(&self, image: &[u64]) -> Option<u32> {
        self.slot(image).err().and_then(|at| self.slots.get(at).copied())
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        self.images.len() * 8 + self.slots.len() * 4
    }

    /// Adds an image; tells whether it is new.
    pub(crate) fn insert(&mut self, image: &[u64]) -> bool {
        self.find_or_insert(image).is_none()
    }

    /// The number of an image that is there; one that is not is added.
    pub fn find_or_insert(&mut self, image: &[u64]) -> Option<u32> {
        if (self.len + 1) * 3 > self.slots.len() * 2 {
            self.grow();
        }
        let at = match self.slot(image) {
            Ok(at) => at,
            Err(at) => return self.slots.get(at).copied(),
        };
        if let Some(slot) = self.slots.get_mut(at) {
            *slot = self.len as u32;
        }
        self.images.extend_from_slice(image);
        self.len += 1;
        None
    }

    /// The free slot for an image that is not there, or the slot of one that is.
    fn slot(&self, image: &[u64]) -> Result<usize, usize> {
        let mask = self.slots.len() - 1;
        let mut at = hash(image) as usize & mask;
        loop {
            match self.slots.get(at).copied() {
                Some(FREE) | None => return Ok(at),
                Some(number) if self.image(number as usize) == image => return Err(at),
                Some(_) => at = (at + 1) & mask,
            }
        }
    }

    fn grow(&mut self) {
        let mask = self.slots.len() * 2 - 1;
        let mut slots = vec![FREE; mask + 1];
        for number in 0..self.len {
            let mut at = hash(self.image(number)) as usize & mask;
            while slots.get(at).is_some_and(|s| *s != FREE) {
                at = (at + 1) & mask;
            }
            if let Some(slot) = slots.get_mut(at) {
                *slot = number as u32;
            }
        }
        self.slots = slots;
    }
}

fn hash(image: &[u64]) -> u64 {
    let mixed = image.iter().fold(0u64, |h, w| (h.rotate_left(5) ^ w).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    mixed ^ (mixed >> 32)
}

#[cfg(test)]
mod tests {
    use super::Store;
    use std::collections::HashSet;

    #[test]
    fn a_store_is_a_set() {
        let (mut store, mut set) = (Store::new(2), HashSet::new());
        let mut x = 1u64;
        for _ in 0..20_000 {
            x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let image = [(x >> 40) % 100, (x >> 50) % 60];
            assert_eq!(store.insert(&image), set.insert(image));
            assert_eq!(store.len(), set.len());
        }
        let all: HashSet<[u64; 2]> =
            (0..store.len()).map(|i| [store.image(i)[0], store.image(i)[1]]).collect();
        assert_eq!(all, set);
    }
}
