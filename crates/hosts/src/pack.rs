//! Images in few words: only the bits that differ from those of a first image in some state.
//!
//! Most words of an image never change in a search, and of the others only some bits do. A packed image
//! has these bits one behind the other. An image with another bit does not fit; the mask grows then, and
//! what is packed is packed anew. The owner of an image follows from its own bits, not from the mask.

/// A run of bits of one word, and its place in a packed image.
#[derive(Clone, Copy, Debug)]
struct Piece {
    word: usize,
    shift: u32,
    mask: u64,
    to: usize,
    at: u32,
}

/// The bits that are kept.
#[derive(Clone, Debug)]
pub(crate) struct Pack {
    first: Vec<u64>,
    mask: Vec<u64>,
    pieces: Vec<Piece>,
    words: usize,
}

impl Pack {
    /// Keeps these bits of images; the others are those of the first one.
    pub(crate) fn new(first: Vec<u64>, mask: Vec<u64>) -> Pack {
        let mut pack = Pack { first, mask, pieces: Vec::new(), words: 1 };
        pack.mask.resize(pack.first.len(), 0);
        pack.arrange();
        pack
    }

    fn arrange(&mut self) {
        self.pieces.clear();
        let (mut to, mut at) = (0, 0);
        for (word, mask) in self.mask.iter().enumerate() {
            let mut rest = *mask;
            while rest != 0 {
                let shift = rest.trailing_zeros();
                let run = (rest >> shift).trailing_ones();
                if at == 64 {
                    (to, at) = (to + 1, 0);
                }
                let bits = run.min(64 - at);
                let mask = u64::MAX >> (64 - bits);
                self.pieces.push(Piece { word, shift, mask, to, at });
                rest &= !(mask << shift);
                at += bits;
            }
        }
        self.words = to + 1;
    }

    /// Words of a packed image, at least one.
    pub(crate) fn words(&self) -> usize {
        self.words
    }

    /// Words of an image.
    pub(crate) fn width(&self) -> usize {
        self.first.len()
    }

    /// The image of which others are told apart.
    pub(crate) fn first(&self) -> &[u64] {
        &self.first
    }

    /// The bits that are kept, a word for each word of an image.
    pub(crate) fn mask(&self) -> &[u64] {
        &self.mask
    }

    /// Appends an image to `into`; false if it does not fit, and then nothing is appended.
    pub(crate) fn pack(&self, image: &[u64], into: &mut Vec<u64>) -> bool {
        let pairs = || image.iter().zip(&self.first).zip(&self.mask);
        if image.len() != self.first.len() || pairs().any(|((i, f), m)| (i ^ f) & !m != 0) {
            return false;
        }
        let from = into.len();
        into.resize(from + self.words, 0);
        let packed = into.get_mut(from..).unwrap_or(&mut []);
        for p in &self.pieces {
            let (image, first) = (image.get(p.word), self.first.get(p.word));
            if let (Some(i), Some(f), Some(to)) = (image, first, packed.get_mut(p.to)) {
                *to |= ((i ^ f) >> p.shift & p.mask) << p.at;
            }
        }
        true
    }

    /// The image of a packed one.
    pub(crate) fn unpack(&self, packed: &[u64], image: &mut Vec<u64>) {
        image.clear();
        image.extend_from_slice(&self.first);
        for p in &self.pieces {
            if let (Some(from), Some(word)) = (packed.get(p.to), image.get_mut(p.word)) {
                *word ^= (from >> p.at & p.mask) << p.shift;
            }
        }
    }

    /// Adds to `mask` the bits in which an image differs from the first one.
    pub(crate) fn differ(&self, image: &[u64], mask: &mut [u64]) {
        for ((m, i), f) in mask.iter_mut().zip(image).zip(&self.first) {
            *m |= i ^ f;
        }
    }

    /// Keeps these bits too; tells whether there is a new one.
    pub(crate) fn grow(&mut self, mask: &[u64]) -> bool {
        let before = self.mask.clone();
        self.mask.iter_mut().zip(mask).for_each(|(m, new)| *m |= new);
        let grown = before != self.mask;
        if grown {
            self.arrange();
        }
        grown
    }

    /// A number that depends on the image alone, to choose its owner.
    pub(crate) fn hash(&self, image: &[u64]) -> u64 {
        let mut hash = 0u64;
        for (k, (i, f)) in (1u64..).zip(image.iter().zip(&self.first)) {
            if i != f {
                let word = (i ^ f).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ k;
                hash = (hash.rotate_left(23) ^ word).wrapping_mul(0xC2B2_AE3D_27D4_EB4F);
            }
        }
        hash ^ hash >> 29
    }
}

/// The owner of an image with this hash among so many workers.
pub(crate) fn owner(hash: u64, peers: usize) -> usize {
    ((u128::from(hash) * peers as u128) >> 64) as usize
}

#[cfg(test)]
mod tests {
    use super::Pack;

    #[test]
    fn what_is_packed_comes_back_and_nothing_else_fits() {
        let first = vec![7, 0, u64::MAX, 1 << 40];
        let mut pack = Pack::new(first.clone(), vec![0, 0xFF00_0000_0000_0F0F, u64::MAX, 0]);
        assert_eq!(pack.words(), 2);
        let image = vec![7, 0xAB00_0000_0000_0502, 0x1234_5678_9ABC_DEF0, 1 << 40];
        let (mut packed, mut back) = (Vec::new(), Vec::new());
        assert!(pack.pack(&image, &mut packed));
        pack.unpack(&packed, &mut back);
        assert_eq!(back, image);
        let other = vec![6, 0xAB00_0000_0000_0502, 0x1234_5678_9ABC_DEF0, 1 << 40];
        let hash = pack.hash(&image);
        assert!(!pack.pack(&other, &mut packed));
        let mut mask = vec![0; 4];
        pack.differ(&other, &mut mask);
        assert!(pack.grow(&mask) && !pack.grow(&mask));
        packed.clear();
        assert!(pack.pack(&other, &mut packed));
        pack.unpack(&packed, &mut back);
        assert_eq!(back, other);
        assert_eq!(pack.hash(&image), hash, "the owner stays");
        assert_ne!(pack.hash(&other), hash);
    }
}
