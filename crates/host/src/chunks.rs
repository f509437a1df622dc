//! A list of words that grows by chunks of one size: what is in it is never moved, and of thousands
//! of words that are added one makes a new chunk.

/// Words of a chunk.
const CHUNK: usize = 1 << 14;

/// Words one behind the other.
#[derive(Debug, Default)]
pub(crate) struct Chunks {
    full: Vec<Vec<u64>>,
    /// The chunk in use, with its room.
    last: Vec<u64>,
}

impl Clone for Chunks {
    /// A copy with the same room in its last chunk.
    fn clone(&self) -> Chunks {
        let mut last = Vec::with_capacity(self.last.capacity());
        last.extend_from_slice(&self.last);
        Chunks { full: self.full.clone(), last }
    }
}

impl Chunks {
    /// An empty list with room for its first chunk.
    pub(crate) fn new() -> Chunks {
        Chunks { full: Vec::new(), last: Vec::with_capacity(CHUNK) }
    }

    #[inline]
    pub(crate) fn push(&mut self, word: u64) {
        if self.last.len() >= CHUNK {
            let full = std::mem::replace(&mut self.last, Vec::with_capacity(CHUNK));
            self.full.push(full);
        }
        self.last.push(word);
    }

    /// The word at a place, counted from 0.
    pub(crate) fn get(&self, at: usize) -> Option<u64> {
        let chunk = if at / CHUNK == self.full.len() { &self.last } else { self.full.get(at / CHUNK)? };
        chunk.get(at % CHUNK).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_come_back_in_their_order_over_the_ends_of_chunks() {
        let mut list = Chunks::new();
        (0..CHUNK as u64).for_each(|word| list.push(word));
        assert_eq!((list.get(CHUNK - 1), list.get(CHUNK)), (Some(CHUNK as u64 - 1), None));
        let mut list = Chunks::new();
        let count = 3 * CHUNK as u64 + 5;
        (0..count).for_each(|word| list.push(word));
        assert_eq!(list.full.len(), 3);
        assert!((0..count).all(|at| list.get(at as usize) == Some(at)));
        assert_eq!(list.get(count as usize), None);
        let mut copy = list.clone();
        copy.push(count);
        assert_eq!((copy.get(count as usize), list.get(count as usize)), (Some(count), None));
    }
}
