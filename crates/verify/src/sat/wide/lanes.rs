//! Bits of many patterns side by side: lane `k` of all signals belongs to pattern `k`.

/// Words of a block of lanes.
pub(super) const WORDS: usize = 8;
/// Lanes of a block.
pub(super) const LANES: usize = 64 * WORDS;

/// One bit of each pattern.
pub(super) type Lanes = [u64; WORDS];

/// All patterns have 0.
pub(super) const NONE: Lanes = [0; WORDS];

/// Combines two bits of each pattern.
#[inline(always)]
pub(super) fn both(a: Lanes, b: Lanes, of: impl Fn(u64, u64) -> u64) -> Lanes {
    // The compiler makes vector instructions of a loop over numbers; of iterators over arrays it often does not.
    let (mut out, mut k) = (NONE, 0);
    while k < WORDS {
        out[k] = of(a[k], b[k]);
        k += 1;
    }
    out
}

/// The negation where `negate` is 1, by the low bit of a code.
#[inline(always)]
pub(super) fn negated(a: Lanes, code: u32) -> Lanes {
    let mask = 0u64.wrapping_sub(u64::from(code & 1));
    both(a, NONE, |a, _| a ^ mask)
}

/// True if some pattern has 1.
#[inline(always)]
pub(super) fn any(a: &Lanes) -> bool {
    a.iter().any(|w| *w != 0)
}

/// The bit of one pattern.
#[inline(always)]
pub(super) fn bit(a: &Lanes, lane: usize) -> bool {
    a.get(lane / 64).is_some_and(|w| w >> (lane % 64) & 1 != 0)
}

/// The patterns that have 1, ascending.
pub(super) fn lanes_of(a: &Lanes) -> impl Iterator<Item = usize> + use<> {
    a.iter()
        .copied()
        .enumerate()
        .flat_map(|(k, w)| bits(w).map(move |j| 64 * k + j))
        .collect::<Vec<_>>()
        .into_iter()
}

/// The bits of a word that are 1, ascending.
pub(super) fn bits(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (word != 0).then(|| word.trailing_zeros() as usize)?;
        word &= word - 1;
        Some(bit)
    })
}

/// 1 in the first `count` lanes.
pub(super) fn first(count: usize) -> Lanes {
    let mut lanes = NONE;
    for (k, w) in lanes.iter_mut().enumerate() {
        let here = count.saturating_sub(64 * k).min(64);
        *w = if here == 64 { u64::MAX } else { (1 << here) - 1 };
    }
    lanes
}

/// Exchanges rows and columns: bit `j` of word `k` becomes bit `k` of word `j`.
#[inline]
pub(super) fn transpose(block: &mut [u64; 64]) {
    let (mut width, mut mask) = (32, 0x0000_0000_FFFF_FFFFu64);
    while width > 0 {
        let mut k = 0;
        while k < 64 {
            let moved = (block[k & 63] >> width ^ block[(k + width) & 63]) & mask;
            block[k & 63] ^= moved << width;
            block[(k + width) & 63] ^= moved;
            // The next place whose bit `width` is 0.
            k = (k + width + 1) & !width;
        }
        width /= 2;
        mask ^= mask << width;
    }
}

/// Takes packed patterns apart. `packed` has a word for each pattern, `bits` gets the lanes of each bit.
pub(super) fn spread(packed: &[u64], bits: &mut [Lanes]) {
    let mut block = [0; 64];
    for (k, words) in packed.chunks(64).enumerate() {
        block.fill(0);
        block.iter_mut().zip(words).for_each(|(to, from)| *to = *from);
        transpose(&mut block);
        for (lanes, word) in bits.iter_mut().zip(block) {
            if let Some(w) = lanes.get_mut(k) {
                *w = word;
            }
        }
    }
}

/// Packs patterns: the bits that `of` gives, at most 64, into a word for each pattern of `packed`.
pub(super) fn gather(packed: &mut [u64], count: usize, of: impl Fn(usize) -> Lanes) {
    let mut rows = [NONE; 64];
    rows.iter_mut().take(count).enumerate().for_each(|(j, row)| *row = of(j));
    for (k, words) in packed.chunks_mut(64).enumerate() {
        let mut block = [0; 64];
        block.iter_mut().zip(&rows).for_each(|(to, row)| *to = row.get(k).copied().unwrap_or(0));
        transpose(&mut block);
        words.iter_mut().zip(block).for_each(|(to, from)| *to = from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Patterns of which each word has another rule.
    fn patterns() -> Vec<u64> {
        (0..LANES as u64).map(|k| k.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ k << 7).collect()
    }

    #[test]
    fn the_lane_of_a_bit_has_the_bit_of_each_pattern() {
        let packed = patterns();
        let mut bits = vec![NONE; 64];
        spread(&packed, &mut bits);
        for (lane, word) in packed.iter().enumerate() {
            for (j, lanes) in bits.iter().enumerate() {
                assert_eq!(bit(lanes, lane), word >> j & 1 != 0, "bit {j} of pattern {lane}");
            }
        }
    }

    #[test]
    fn what_is_taken_apart_is_packed_again() {
        let packed = patterns();
        let mut bits = vec![NONE; 64];
        spread(&packed, &mut bits);
        let mut back = vec![0; LANES];
        gather(&mut back, 40, |j| bits[j]);
        let low: Vec<u64> = packed.iter().map(|w| w & ((1 << 40) - 1)).collect();
        assert_eq!(back, low);
    }

    #[test]
    fn the_first_lanes_are_as_many_as_are_asked_for() {
        for count in [0, 1, 63, 64, 65, 500, LANES] {
            let lanes = first(count);
            assert!((0..LANES).all(|k| bit(&lanes, k) == (k < count)), "{count}");
        }
    }
}
