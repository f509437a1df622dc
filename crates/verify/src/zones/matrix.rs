//! Sets of values of several clocks: difference-bound matrices over whole numbers.
//!
//! A zone has all vectors whose clocks, and whose differences of two clocks, lie within bounds. Every
//! matrix here is closed (each bound is the least one that follows from all) and holds some vector;
//! an operation whose result would be empty gives `None`. So one zone contains another where no bound
//! is less, and the least values of all clocks together are a vector of the zone, as the greatest are.

use std::fmt;

/// No bound.
const FREE: i64 = i64::MAX / 4;

/// Lower and upper limit of a clock, both included.
pub(crate) type Span = (i64, i64);

/// The origin of a clock behind a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum From {
    /// It has begun in the scan.
    Zero,
    /// It went on: the place of the clock before the scan.
    Old(usize),
}

/// A zone. Row and column 0 stand for the number 0, those behind it for the clocks.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct Zone {
    /// Rows and columns.
    side: usize,
    /// At row i and column j the bound of the difference of i and j.
    bounds: Vec<i64>,
}

impl fmt::Debug for Zone {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.bounds.chunks(self.side.max(1))).finish()
    }
}

impl Zone {
    /// All of these clocks are 0.
    pub(crate) fn zero(clocks: usize) -> Zone {
        let side = clocks + 1;
        Zone { side, bounds: vec![0; side * side] }
    }

    /// Every vector of values that are not negative.
    fn all(clocks: usize) -> Zone {
        let mut zone = Zone::zero(clocks);
        for i in 1..zone.side {
            (0..zone.side).filter(|j| *j != i).for_each(|j| zone.set(i, j, FREE));
        }
        zone
    }

    /// Number of clocks.
    pub(crate) fn clocks(&self) -> usize {
        self.side - 1
    }

    /// Bytes in use.
    pub(crate) fn bytes(&self) -> usize {
        self.bounds.len() * 8
    }

    fn at(&self, i: usize, j: usize) -> i64 {
        self.bounds.get(i * self.side + j).copied().unwrap_or(FREE)
    }

    fn set(&mut self, i: usize, j: usize, bound: i64) {
        if let Some(b) = self.bounds.get_mut(i * self.side + j) {
            *b = bound;
        }
    }

    /// The least and the greatest value of a clock.
    pub(crate) fn span(&self, clock: usize) -> Span {
        (-self.at(0, clock + 1), self.at(clock + 1, 0))
    }

    /// The least values of all clocks, which are a vector of the zone.
    pub(crate) fn least(&self) -> Vec<i64> {
        (0..self.clocks()).map(|c| self.span(c).0).collect()
    }

    /// The greatest values of all clocks; a clock without a bound has its least one.
    pub(crate) fn greatest(&self) -> Vec<i64> {
        let spans = (0..self.clocks()).map(|c| self.span(c));
        spans.map(|(least, most)| if most >= FREE { least } else { most }).collect()
    }

    /// True if a vector belongs to it.
    pub(crate) fn has(&self, values: &[i64]) -> bool {
        let value = |i: usize| i.checked_sub(1).and_then(|c| values.get(c)).copied().unwrap_or(0);
        (0..self.side).all(|i| (0..self.side).all(|j| value(i) - value(j) <= self.at(i, j)))
    }

    /// True if every vector of the other one belongs to it.
    pub(crate) fn contains(&self, other: &Zone) -> bool {
        self.side == other.side && self.bounds.iter().zip(&other.bounds).all(|(mine, its)| its <= mine)
    }

    /// The vectors so much later.
    pub(crate) fn later(&self, by: i64) -> Zone {
        let mut zone = self.clone();
        for i in 1..self.side {
            let (above, below) = (self.at(i, 0), self.at(0, i));
            zone.set(i, 0, if above >= FREE { FREE } else { above + by });
            zone.set(0, i, below - by);
        }
        zone
    }

    /// The vectors at any later time.
    pub(crate) fn ever_later(&self) -> Zone {
        let mut zone = self.clone();
        (1..self.side).for_each(|i| zone.set(i, 0, FREE));
        zone
    }

    /// The vectors at any earlier time, as long as no clock is negative.
    pub(crate) fn ever_earlier(&self) -> Option<Zone> {
        let mut zone = self.clone();
        (1..self.side).for_each(|i| zone.set(0, i, 0));
        zone.closed()
    }

    /// The vectors whose clocks lie within these limits.
    pub(crate) fn within(&self, limits: &[Span]) -> Option<Zone> {
        let mut zone = self.clone();
        for (i, (least, most)) in (1..).zip(limits) {
            zone.set(0, i, zone.at(0, i).min(-least));
            zone.set(i, 0, zone.at(i, 0).min(*most));
        }
        zone.closed()
    }

    /// The vectors that belong to both.
    pub(crate) fn and(&self, other: &Zone) -> Option<Zone> {
        let mut zone = self.clone();
        for (mine, its) in zone.bounds.iter_mut().zip(&other.bounds) {
            *mine = (*mine).min(*its);
        }
        zone.closed()
    }

    /// The clocks behind a scan, made of these. Clocks that are not named are gone.
    pub(crate) fn moved(&self, to: &[From]) -> Zone {
        let old = |i: usize| i.checked_sub(1).map_or(0, |c| to.get(c).map_or(0, |f| f.old()));
        let mut zone = Zone::zero(to.len());
        for i in 0..zone.side {
            for j in (0..zone.side).filter(|j| *j != i) {
                zone.set(i, j, self.at(old(i), old(j)));
            }
        }
        zone
    }

    /// All vectors of so many clocks from which [`Zone::moved`] makes one of these.
    pub(crate) fn unmoved(&self, to: &[From], clocks: usize) -> Option<Zone> {
        let old = |i: usize| i.checked_sub(1).map_or(0, |c| to.get(c).map_or(0, |f| f.old()));
        let mut zone = Zone::all(clocks);
        for i in 0..self.side {
            for j in (0..self.side).filter(|j| *j != i) {
                let (a, b) = (old(i), old(j));
                zone.set(a, b, zone.at(a, b).min(self.at(i, j)));
            }
        }
        zone.closed()
    }

    /// Finds the least bounds that follow from all.
    fn closed(mut self) -> Option<Zone> {
        for k in 0..self.side {
            for i in 0..self.side {
                let to = self.at(i, k);
                if to >= FREE {
                    continue;
                }
                for j in 0..self.side {
                    let on = self.at(k, j);
                    if on < FREE && to + on < self.at(i, j) {
                        self.set(i, j, to + on);
                    }
                }
            }
        }
        (0..self.side).all(|i| self.at(i, i) >= 0).then_some(self)
    }
}

impl From {
    /// The value of the clock behind a scan; these were those of all clocks at the scan.
    pub(crate) fn of(self, scanned: &[i64]) -> i64 {
        match self {
            From::Zero => 0,
            From::Old(clock) => scanned.get(clock).copied().unwrap_or(0),
        }
    }

    /// The row of the clock before the scan.
    fn old(self) -> usize {
        match self {
            From::Zero => 0,
            From::Old(clock) => clock + 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{From, Span, Zone};
    use std::collections::BTreeSet;

    /// Most of a clock.
    const MOST: i64 = 7;

    type Set = BTreeSet<Vec<i64>>;

    fn every(clocks: usize) -> Vec<Vec<i64>> {
        let mut list = vec![Vec::new()];
        for _ in 0..clocks {
            list = list.into_iter().flat_map(|v| (0..=MOST).map(move |x| [&v[..], &[x]].concat())).collect();
        }
        list
    }

    fn vectors(zone: &Zone) -> Set {
        every(zone.clocks()).into_iter().filter(|v| zone.has(v)).collect()
    }

    fn later(v: &[i64], by: i64) -> Vec<i64> {
        v.iter().map(|x| x + by).collect()
    }

    /// Zones as scans make them, each with its vectors.
    fn zones() -> Vec<(Zone, Set)> {
        let mut list = vec![(Zone::zero(2), Set::from([vec![0, 0]]))];
        let mut random = 1u64;
        let mut next = |n: u64| {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 33) % n
        };
        while list.len() < 400 {
            let (zone, set) = list[next(list.len() as u64) as usize].clone();
            let limits: Vec<Span> = (0..2).map(|_| (next(3) as i64, 2 + next(5) as i64)).collect();
            let up: Set = set.iter().flat_map(|v| (0..=MOST).map(move |k| later(v, k))).collect();
            let inside = |v: &&Vec<i64>| v.iter().zip(&limits).all(|(x, (a, b))| a <= x && x <= b);
            let set: Set = up.iter().filter(inside).cloned().collect();
            let Some(zone) = zone.ever_later().within(&limits) else {
                assert!(set.is_empty());
                continue;
            };
            let to = match next(4) {
                0 => [From::Zero, From::Old(1)],
                1 => [From::Old(1), From::Old(0)],
                2 => [From::Old(0), From::Zero],
                _ => [From::Old(0), From::Old(1)],
            };
            list.push((zone.moved(&to), set.iter().map(|v| moved(v, &to)).collect()));
        }
        list
    }

    fn moved(v: &[i64], to: &[From]) -> Vec<i64> {
        to.iter().map(|f| if let From::Old(c) = f { v[*c] } else { 0 }).collect()
    }

    #[test]
    fn a_zone_is_the_set_of_its_vectors() {
        for (zone, set) in zones() {
            assert_eq!(vectors(&zone), set, "{zone:?}");
            assert!(zone.has(&zone.least()) && zone.has(&zone.greatest()), "{zone:?}");
            let spans = |v: &Vec<i64>| (0..2).all(|c| (zone.span(c).0..=zone.span(c).1).contains(&v[c]));
            assert!(set.iter().all(spans));
        }
    }

    #[test]
    fn zones_contain_and_meet_as_sets_do() {
        let all = zones();
        for (a, b) in all.iter().zip(all.iter().skip(7)) {
            assert_eq!(a.0.contains(&b.0), b.1.is_subset(&a.1), "{:?} {:?}", a.0, b.0);
            let both: Set = a.1.intersection(&b.1).cloned().collect();
            assert_eq!(a.0.and(&b.0).map_or(Set::new(), |z| vectors(&z)), both);
        }
    }

    #[test]
    fn what_was_before_is_what_leads_there() {
        for (zone, set) in zones() {
            let before: Set =
                every(2).into_iter().filter(|v| (0..=MOST).any(|k| set.contains(&later(v, k)))).collect();
            assert_eq!(vectors(&zone.ever_earlier().expect("it has vectors")), before, "{zone:?}");
            for to in [[From::Zero, From::Old(1)], [From::Old(2), From::Old(0)], [From::Zero, From::Zero]] {
                let before: Set = every(3).into_iter().filter(|v| set.contains(&moved(v, &to))).collect();
                let zone = zone.unmoved(&to, 3);
                assert_eq!(zone.as_ref().map_or(Set::new(), vectors), before, "{zone:?} {to:?}");
            }
        }
    }
}
