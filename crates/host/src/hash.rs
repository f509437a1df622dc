//! The hash by which files and states are told apart: FNV-1a, 64 bits. It finds
//! accidents; it keeps no secret and proves nothing.

/// A hash that grows with the bytes that are added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Fnv {
        Fnv(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    /// The hash of some bytes.
    pub fn of(bytes: &[u8]) -> u64 {
        let mut hash = Fnv::default();
        hash.add(bytes);
        hash.value()
    }

    /// Adds bytes: the result is that of all bytes one behind the other.
    pub fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// The hash of all bytes added so far.
    pub fn value(self) -> u64 {
        self.0
    }
}

/// A digest of words, by which two states are told apart: it finds accidents as well, and takes a word
/// at a time. Words that differ in one place have different digests.
pub(crate) fn digest(words: &[u64]) -> u64 {
    const LANES: usize = 4;
    // Four chains of multiplications, since each step of one waits for the step before.
    let mut lanes: [u64; LANES] = [0x9e37_79b9_7f4a_7c15, 0xbf58_476d_1ce4_e5b9, 0x94d0_49bb_1331_11eb, 1];
    let whole = words.chunks_exact(LANES);
    let rest = whole.remainder();
    for chunk in whole {
        lanes.iter_mut().zip(chunk).for_each(|(lane, word)| *lane = mixed(*lane, *word));
    }
    lanes.iter_mut().zip(rest).for_each(|(lane, word)| *lane = mixed(*lane, *word));
    lanes.into_iter().fold(words.len() as u64, mixed)
}

/// Both operations can be undone, so no two words lead from one value to the same next one.
fn mixed(before: u64, word: u64) -> u64 {
    let product = (before ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    product ^ product >> 32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_the_published_test_vectors() {
        // From the authors' suite of FNV-1a, 64 bits.
        assert_eq!(Fnv::of(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(Fnv::of(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(Fnv::of(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn digests_differ_where_one_word_differs_or_two_are_exchanged() {
        let words: Vec<u64> = (0..11).collect();
        let mut seen = std::collections::BTreeSet::from([digest(&words), digest(&words[..10])]);
        for i in 0..words.len() {
            for bit in 0..64 {
                let mut other = words.clone();
                other[i] ^= 1 << bit;
                assert!(seen.insert(digest(&other)), "word {i}, bit {bit}");
            }
            for k in 0..i {
                let mut other = words.clone();
                other.swap(i, k);
                assert!(seen.insert(digest(&other)), "words {i} and {k}");
            }
        }
    }

    #[test]
    fn bytes_may_be_added_in_parts() {
        let mut hash = Fnv::default();
        hash.add(b"foo");
        hash.add(b"bar");
        assert_eq!(hash.value(), Fnv::of(b"foobar"));
    }
}
