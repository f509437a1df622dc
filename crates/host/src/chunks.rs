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

    pub(crate) fn iter(&self) -> impl Iterator<Item = u64> + '_ {
        self.full.iter().chain([&self.last]).flatten().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_come_back_in_their_order_over_the_ends_of_chunks() {
        let mut list = Chunks::new();
        let count = 3 * CHUNK as u64 + 5;
        (0..count).for_each(|word| list.push(word));
        assert!(list.iter().eq(0..count));
        assert_eq!(list.full.len(), 3);
        let mut copy = list.clone();
        copy.push(count);
        assert!(copy.iter().eq(0..=count) && list.iter().eq(0..count));
    }
}
