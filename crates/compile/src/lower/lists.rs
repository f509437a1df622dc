//! Lists by owner, gathered in any order and laid out one behind the other.

use g7_engine::Rows;

/// Items by owner (a step, a group, a watch).
pub(super) struct Lists<T> {
    pairs: Vec<(u32, T)>,
    next: usize,
}

impl<T> Default for Lists<T> {
    fn default() -> Lists<T> {
        Lists { pairs: Vec::new(), next: 0 }
    }
}

impl<T: Copy> Lists<T> {
    /// Gives an owner one more item.
    pub(super) fn add(&mut self, owner: u32, item: T) {
        self.pairs.push((owner, item));
    }

    /// Puts owners in order, each one's items staying in theirs.
    pub(super) fn sort(&mut self) {
        if !self.pairs.is_sorted_by_key(|p| p.0) {
            self.pairs.sort_by_key(|p| p.0);
        }
    }

    /// Changes every item.
    pub(super) fn map(&mut self, f: impl Fn(T) -> T) {
        for (_, item) in &mut self.pairs {
            *item = f(*item);
        }
    }

    /// Lays out the items of an owner. Owners must be asked for in ascending
    /// order, after [`Lists::sort`].
    pub(super) fn take(&mut self, owner: u32, to: &mut Vec<T>) -> Rows {
        let start = to.len() as u32;
        while let Some((o, item)) = self.pairs.get(self.next) {
            if *o > owner {
                break;
            }
            if *o == owner {
                to.push(*item);
            }
            self.next += 1;
        }
        Rows { start, end: to.len() as u32 }
    }
}

impl<T: Copy + Ord> Lists<T> {
    /// Puts owners and items in order, each item once.
    pub(super) fn sort_unique(&mut self) {
        self.pairs.sort_unstable();
        self.pairs.dedup();
    }
}
