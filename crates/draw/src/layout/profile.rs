//! The reach of a sequence to one side, row by row. It is queried and raised over ranges of rows
//! while other parts are placed beside the sequence.

/// The greatest reach over a range of rows, as a segment tree over rows that are known beforehand.
#[derive(Debug)]
pub(crate) struct Profile {
    /// The boundaries of the rows, ascending.
    rows: Vec<i32>,
    /// Number of leaves of the tree.
    size: usize,
    /// The greatest reach in the subtree of each tree node.
    most: Vec<i32>,
    /// The reach that holds for the whole subtree of each tree node.
    all: Vec<i32>,
}

impl Profile {
    /// A profile with reach 0; `rows` holds the boundaries, in any order.
    pub(crate) fn new(mut rows: Vec<i32>) -> Profile {
        rows.sort_unstable();
        rows.dedup();
        let size = rows.len().next_power_of_two();
        Profile { rows, size, most: vec![0; 2 * size], all: vec![0; 2 * size] }
    }

    /// The leaves that the rows from `y0` to `y1` touch.
    fn range(&self, y0: i32, y1: i32) -> (usize, usize) {
        let from = self.rows.partition_point(|y| *y <= y0).saturating_sub(1);
        let to = self.rows.partition_point(|y| *y < y1.max(y0 + 1)).max(from + 1);
        (from, to.min(self.size))
    }

    /// The greatest reach between two heights.
    #[inline(never)]
    pub(crate) fn most(&self, y0: i32, y1: i32) -> i32 {
        let (from, to) = self.range(y0, y1);
        let (mut from, mut to) = (from + self.size, to + self.size);
        let mut found = 0;
        // A reach that holds for a whole subtree holds for its leaves too.
        for mut knot in [from, to - 1] {
            while knot > 0 {
                found = found.max(self.all[knot]);
                knot /= 2;
            }
        }
        while from < to {
            if from % 2 == 1 {
                found = found.max(self.most[from]);
                from += 1;
            }
            if to % 2 == 1 {
                to -= 1;
                found = found.max(self.most[to]);
            }
            from /= 2;
            to /= 2;
        }
        found
    }

    /// Raises the reach between two heights to at least `reach`.
    #[inline(never)]
    pub(crate) fn raise(&mut self, y0: i32, y1: i32, reach: i32) {
        let (from, to) = self.range(y0, y1);
        let (mut left, mut right) = (from + self.size, to + self.size);
        while left < right {
            if left % 2 == 1 {
                self.lift(left, reach);
                left += 1;
            }
            if right % 2 == 1 {
                right -= 1;
                self.lift(right, reach);
            }
            left /= 2;
            right /= 2;
        }
    }

    fn lift(&mut self, knot: usize, reach: i32) {
        self.all[knot] = self.all[knot].max(reach);
        let mut knot = knot;
        while knot > 0 {
            self.most[knot] = self.most[knot].max(reach);
            knot /= 2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_answers_like_a_plain_list() {
        let rows: Vec<i32> = (0..40).map(|k| k * 7).collect();
        let mut profile = Profile::new(rows.clone());
        let mut plain = [0; 39];
        let mut seed = 1u32;
        let mut random = |n: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 16) % n
        };
        for _ in 0..500 {
            let (a, b) = (random(39) as usize, random(39) as usize);
            let (from, to) = (a.min(b), a.max(b) + 1);
            let (y0, y1) = (rows[from], rows[to]);
            if random(3) == 0 {
                let reach = random(1000) as i32;
                profile.raise(y0, y1, reach);
                plain[from..to].iter_mut().for_each(|p| *p = reach.max(*p));
            }
            assert_eq!(profile.most(y0, y1), plain[from..to].iter().copied().max().unwrap_or(0));
        }
    }
}
