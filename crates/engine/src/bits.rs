//! Sets of small numbers as bits with summaries, inside a flat word array.
//!
//! Level 0 has a bit for each number; each further level has a bit for each word of
//! the level below, which is set while that word is not zero. So walking a set in
//! ascending order takes time in proportion to its members, and the words depend on
//! the members alone: two equal sets are equal words.

/// Most levels; they make room for `64^5` members.
pub(crate) const LEVELS: usize = 5;

/// A place beyond the end of every word array, with room for the members of a set after it.
const NOWHERE: u32 = u32::MAX / 2;

/// Where a set lies in the word array.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tree {
    /// First word of each level.
    at: [u32; LEVELS],
    /// Levels in use, at least 1 unless the set can have no member.
    levels: u32,
}

impl Default for Tree {
    /// The set that can have no member: it owns no word, so that removing from it changes none.
    fn default() -> Tree {
        Tree { at: [NOWHERE; LEVELS], levels: 0 }
    }
}

/// The word at a place, or 0 beyond the end, where checked tables never lead.
#[inline(always)]
pub(crate) fn word(words: &[u64], at: usize) -> u64 {
    words.get(at).copied().unwrap_or(0)
}

#[inline(always)]
fn or(words: &mut [u64], at: usize, mask: u64) -> u64 {
    match words.get_mut(at) {
        Some(w) => {
            let old = *w;
            *w = old | mask;
            old
        }
        None => u64::MAX,
    }
}

#[inline(always)]
fn and_not(words: &mut [u64], at: usize, mask: u64) -> u64 {
    match words.get_mut(at) {
        Some(w) => {
            *w &= !mask;
            *w
        }
        None => u64::MAX,
    }
}

/// Bit `i` of a plain array of bits that begins at word `base`.
#[inline(always)]
pub(crate) fn bit(words: &[u64], base: u32, i: u32) -> bool {
    word(words, base as usize + (i / 64) as usize) & (1 << (i % 64)) != 0
}

/// Writes a bit of a plain array of bits; returns the old one.
#[inline(always)]
pub(crate) fn set_bit(words: &mut [u64], base: u32, i: u32, on: bool) -> bool {
    let Some(w) = words.get_mut(base as usize + (i / 64) as usize) else { return on };
    let mask = 1u64 << (i % 64);
    let old = *w & mask != 0;
    if on {
        *w |= mask;
    } else {
        *w &= !mask;
    }
    old
}

impl Tree {
    /// Reserves room for members `0..n` from `next` on.
    pub(crate) fn reserve(n: u32, next: &mut u32) -> Tree {
        let mut tree = Tree::default();
        let mut count = n;
        while count > 0 && (tree.levels as usize) < LEVELS {
            let words = count.div_ceil(64);
            if let Some(at) = tree.at.get_mut(tree.levels as usize) {
                *at = *next;
            }
            *next += words;
            tree.levels += 1;
            if words == 1 {
                break;
            }
            count = words;
        }
        tree
    }

    /// True if words hold a set of members below `n`, with its summaries.
    pub(crate) fn is_sound(&self, words: &[u64], n: u32) -> bool {
        let mut count = n;
        let mut below: Option<u32> = None;
        for at in self.at.iter().take(self.levels as usize) {
            let len = count.div_ceil(64);
            let beyond = match count % 64 {
                0 => 0,
                used => word(words, (at + len - 1) as usize) >> used,
            };
            let fits =
                |base: u32| (0..count).all(|i| bit(words, *at, i) == (word(words, (base + i) as usize) != 0));
            if beyond != 0 || !below.is_none_or(fits) {
                return false;
            }
            below = Some(*at);
            count = len;
        }
        true
    }

    /// First word of level 0.
    pub(crate) fn base(&self) -> u32 {
        self.at[0]
    }

    #[inline(always)]
    pub(crate) fn contains(&self, words: &[u64], i: u32) -> bool {
        bit(words, self.at[0], i)
    }

    #[inline(always)]
    pub(crate) fn insert(&self, words: &mut [u64], i: u32) {
        self.add(words, i);
    }

    #[inline(always)]
    pub(crate) fn remove(&self, words: &mut [u64], i: u32) {
        self.take(words, i);
    }

    /// Inserts a member; tells whether it is new.
    #[inline(always)]
    pub(crate) fn add(&self, words: &mut [u64], i: u32) -> bool {
        let Some(w) = words.get_mut((self.at[0] + i / 64) as usize) else { return false };
        let mask = 1u64 << (i % 64);
        let old = *w;
        *w = old | mask;
        if old == 0 && self.levels > 1 {
            self.summarise(words, i);
        }
        old & mask == 0
    }

    /// Removes a member; tells whether it was there.
    #[inline(always)]
    pub(crate) fn take(&self, words: &mut [u64], i: u32) -> bool {
        let Some(w) = words.get_mut((self.at[0] + i / 64) as usize) else { return false };
        let mask = 1u64 << (i % 64);
        let old = *w;
        *w = old & !mask;
        if old == mask && self.levels > 1 {
            self.forget(words, i);
        }
        old & mask != 0
    }

    /// Of a set whose only member is `from`, makes the set whose only member is
    /// `to`.
    #[inline(always)]
    pub(crate) fn pass_on(&self, words: &mut [u64], from: u32, to: u32) {
        if from / 64 != to / 64 {
            self.pass_far(words, from, to);
        } else if let Some(w) = words.get_mut((self.at[0] + to / 64) as usize) {
            // The old word is not read, so the processor need not wait for it.
            *w = 1 << (to % 64);
        }
    }

    /// Removes the member `from` and inserts `to`, which is no member.
    #[inline(always)]
    pub(crate) fn hand_on(&self, words: &mut [u64], from: u32, to: u32) {
        match words.get_mut((self.at[0] + to / 64) as usize) {
            Some(w) if from / 64 == to / 64 => *w = *w & !(1 << (from % 64)) | 1 << (to % 64),
            _ => self.pass_far(words, from, to),
        }
    }

    /// Calls `f` with each word that has members, ascending, and with its index: member `64 i + k` is bit `k` of
    /// word `i`. The only word of a small set comes in any case.
    #[inline(always)]
    pub(crate) fn each_word(&self, words: &[u64], mut f: impl FnMut(u32, u64)) {
        // The words of the lowest level that are not 0 are a set as well, one level up.
        let above = Tree {
            at: [self.at[1], self.at[2], self.at[3], self.at[4], 0],
            levels: self.levels.saturating_sub(1),
        };
        let mut walk = Walk::new(&above, words);
        let mut next = if self.levels == 1 { Some(0) } else { walk.next(&above, words) };
        while let Some(i) = next {
            f(i, word(words, (self.at[0] + i) as usize));
            next = walk.next(&above, words);
        }
    }

    #[inline(never)]
    fn pass_far(&self, words: &mut [u64], from: u32, to: u32) {
        self.take(words, from);
        self.add(words, to);
    }

    /// Sets the summaries above a word that has its first member.
    fn summarise(&self, words: &mut [u64], i: u32) {
        let mut i = i / 64;
        for at in self.at.iter().take(self.levels as usize).skip(1) {
            if or(words, *at as usize + (i / 64) as usize, 1 << (i % 64)) != 0 {
                return;
            }
            i /= 64;
        }
    }

    /// Clears the summaries above a word that lost its last member.
    fn forget(&self, words: &mut [u64], i: u32) {
        let mut i = i / 64;
        for at in self.at.iter().take(self.levels as usize).skip(1) {
            if and_not(words, *at as usize + (i / 64) as usize, 1 << (i % 64)) != 0 {
                return;
            }
            i /= 64;
        }
    }

    /// The word that is 0 while the set is empty.
    pub(crate) fn top(&self) -> u32 {
        self.at.get((self.levels as usize).saturating_sub(1)).copied().unwrap_or(0)
    }

    #[inline(always)]
    pub(crate) fn is_empty(&self, words: &[u64]) -> bool {
        match self.levels {
            0 => true,
            n => word(words, self.at.get(n as usize - 1).copied().unwrap_or(0) as usize) == 0,
        }
    }

    /// True if `i` is the only member.
    pub(crate) fn has_only(&self, words: &[u64], i: u32) -> bool {
        self.next(words, i + 1).is_none() && self.next(words, 0) == Some(i)
    }

    /// The smallest member `>= from`. Members may come and go between calls.
    pub(crate) fn next(&self, words: &[u64], from: u32) -> Option<u32> {
        let mut i = from;
        let mut level = 0usize;
        // Climb until a word has a member at or behind `i`.
        while level < self.levels as usize {
            let at = *self.at.get(level)? as usize + (i / 64) as usize;
            let end = self.at.get(level + 1).filter(|_| level + 1 < self.levels as usize);
            if level + 1 == self.levels as usize && i >= 64 || end.is_some_and(|e| at >= *e as usize) {
                return None;
            }
            let rest = word(words, at) & (u64::MAX << (i % 64));
            if rest != 0 {
                let mut found = (i / 64) * 64 + rest.trailing_zeros();
                // Descend to the first member below that bit.
                while level > 0 {
                    level -= 1;
                    let w = word(words, *self.at.get(level)? as usize + found as usize);
                    if w == 0 {
                        return None;
                    }
                    found = found * 64 + w.trailing_zeros();
                }
                return Some(found);
            }
            i = i / 64 + 1;
            level += 1;
        }
        None
    }
}

/// Walks a set that does not change meanwhile, in ascending order.
pub(crate) struct Walk {
    /// The members of the current word of each level that are still to come.
    rest: [u64; LEVELS],
    /// Index of the current word of each level.
    index: [u32; LEVELS],
}

impl Walk {
    #[inline(always)]
    pub(crate) fn new(tree: &Tree, words: &[u64]) -> Walk {
        let mut walk = Walk { rest: [0; LEVELS], index: [0; LEVELS] };
        if tree.levels > 0 {
            let top = tree.levels as usize - 1;
            if let (Some(rest), Some(at)) = (walk.rest.get_mut(top), tree.at.get(top)) {
                *rest = word(words, *at as usize);
            }
        }
        walk
    }

    #[inline(always)]
    pub(crate) fn next(&mut self, tree: &Tree, words: &[u64]) -> Option<u32> {
        let r0 = self.rest[0];
        if r0 != 0 {
            self.rest[0] = r0 & (r0 - 1);
            return Some(self.index[0] * 64 + r0.trailing_zeros());
        }
        self.climb(tree, words)
    }

    fn climb(&mut self, tree: &Tree, words: &[u64]) -> Option<u32> {
        let levels = tree.levels as usize;
        let mut level = 1;
        while level < levels {
            let rest = *self.rest.get(level)?;
            if rest != 0 {
                *self.rest.get_mut(level)? = rest & (rest - 1);
                let mut member = *self.index.get(level)? * 64 + rest.trailing_zeros();
                while level > 0 {
                    level -= 1;
                    let w = word(words, *tree.at.get(level)? as usize + member as usize);
                    *self.index.get_mut(level)? = member;
                    *self.rest.get_mut(level)? = w & w.wrapping_sub(1);
                    member = member * 64 + w.trailing_zeros();
                }
                return Some(member);
            }
            level += 1;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::{Tree, Walk};
    use alloc::collections::BTreeSet;
    use alloc::vec;
    use alloc::vec::Vec;

    #[test]
    fn a_tree_is_a_set() {
        for n in [1u32, 63, 64, 65, 4096, 4097, 300_000] {
            let mut next = 3;
            let tree = Tree::reserve(n, &mut next);
            let mut words = vec![0; next as usize];
            let mut set = BTreeSet::new();
            let mut x = 12345u64;
            for _ in 0..2000 {
                x = x.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                let i = (x >> 33) as u32 % n;
                if x & 4096 == 0 {
                    tree.remove(&mut words, i);
                    set.remove(&i);
                } else {
                    tree.insert(&mut words, i);
                    set.insert(i);
                }
                assert_eq!(tree.next(&words, i), set.range(i..).next().copied());
                assert_eq!(tree.is_empty(&words), set.is_empty());
                assert_eq!(tree.has_only(&words, i), set.len() == 1 && set.contains(&i));
            }
            let mut walk = Walk::new(&tree, &words);
            let mut seen = Vec::new();
            while let Some(i) = walk.next(&tree, &words) {
                seen.push(i);
            }
            assert_eq!(seen, set.iter().copied().collect::<Vec<_>>());
            assert_eq!(tree.next(&words, n), None);
            for i in set {
                tree.remove(&mut words, i);
            }
            assert!(words.iter().all(|w| *w == 0), "no summary is left behind");
            // One member alone, passed on near and far.
            let mut at = 0;
            tree.insert(&mut words, at);
            for step in [1, 62, 1, 64, 4096, 5000, 1, 100_001] {
                let to = (at + step) % n;
                tree.pass_on(&mut words, at, to);
                let mut other = vec![0; words.len()];
                tree.insert(&mut other, to);
                assert_eq!(words, other, "{at} to {to} of {n}");
                at = to;
            }
        }
    }
}
