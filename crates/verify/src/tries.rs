//! The combinations of values that the inputs of a scan take, one after the other in place.
//!
//! The first place counts slowest. The present value of an input comes before the others, so that a run
//! changes an input only where it must. Where there are more combinations than [`MOST`], only one input
//! differs from the present ones at a time.

use crate::values::Values;

/// Most combinations of inputs that are tried in one state.
pub(crate) const MOST: usize = 1 << 16;

/// The combinations of one state. Room is kept from one state to the next.
#[derive(Debug, Default)]
pub(crate) struct Tries {
    /// The present inputs.
    last: Vec<u64>,
    /// The places that vary.
    places: Vec<usize>,
    /// For each of them, the number of its value in hand.
    turn: Vec<usize>,
    /// For each of them: some scan read it, since the places before it have their values.
    read: Vec<bool>,
    /// One input differs at a time: the place in hand, then the value in hand.
    alone: Option<(usize, usize)>,
    /// [`Tries::read`] tells which places vary.
    lazy: bool,
    /// Combinations so far.
    made: usize,
    over: bool,
}

impl Tries {
    /// Begins the combinations of these places, which are ascending. Of too many, or with `alone`, one
    /// input differs at a time.
    pub(crate) fn begin(&mut self, inputs: &[Values], places: &[usize], last: &[u64], alone: bool) {
        self.begin_read(places, last);
        self.read.fill(true);
        self.lazy = false;
        self.alone = (alone || count(inputs, places) > MOST).then_some((0, 0));
    }

    /// Begins those combinations that differ in what the scans read. [`Tries::read`] tells it behind
    /// each of them.
    pub(crate) fn begin_read(&mut self, places: &[usize], last: &[u64]) {
        self.last.clear();
        self.last.extend_from_slice(last);
        self.places.clear();
        self.places.extend_from_slice(places);
        self.turn.clear();
        self.turn.resize(places.len(), 0);
        self.read.clear();
        self.read.resize(places.len(), false);
        (self.alone, self.lazy, self.made, self.over) = (None, true, 0, false);
    }

    /// Notes what the scan with the combination in hand has read: any other values of the rest would
    /// have made no difference. Gives a place that it read first now and that takes more values than are
    /// tried.
    pub(crate) fn read(&mut self, inputs: &[Values], is_read: impl Fn(usize) -> bool) -> Option<usize> {
        let mut gap = None;
        for (place, read) in self.places.iter().zip(&mut self.read) {
            if !*read && is_read(*place) {
                *read = true;
                gap = gap.or_else(|| inputs.get(*place).is_some_and(|v| !v.whole).then_some(*place));
            }
        }
        gap
    }

    /// The number of places read, if they have more combinations than are tried.
    pub(crate) fn too_many(&self, inputs: &[Values]) -> Option<usize> {
        let read = || self.places.iter().zip(&self.read).filter(|(_, r)| **r).map(|(i, _)| *i);
        let many = read().fold(1usize, |n, i| n.saturating_mul(tried(inputs, i).len().max(1))) > MOST;
        (many && self.made == 1 || self.made > MOST).then(|| read().count())
    }

    /// Puts the next combination into `vector`, which has the one before; false behind the last.
    pub(crate) fn next(&mut self, inputs: &[Values], vector: &mut Vec<u64>) -> bool {
        if self.over {
            return false;
        }
        self.made += 1;
        if self.made == 1 {
            vector.clear();
            vector.extend_from_slice(&self.last);
            if self.alone.is_none() {
                for i in &self.places {
                    set(vector, *i, self.value(inputs, *i, 0));
                }
            }
            return true;
        }
        let more = match self.alone {
            Some(from) => self.one_by_one(inputs, vector, from),
            None => self.turn(inputs, vector),
        };
        self.over = !more;
        more
    }

    /// The value of an input with this number, the present one first if it is one of those tried.
    fn value(&self, inputs: &[Values], place: usize, number: usize) -> Option<u64> {
        let tried = tried(inputs, place);
        let now = self.last.get(place).and_then(|now| tried.iter().position(|v| v == now));
        let number = match now {
            Some(at) if number == 0 => at,
            Some(at) if number <= at => number - 1,
            _ => number,
        };
        tried.get(number).copied()
    }

    /// The next combination in order, without those that differ from one before only in what no scan
    /// has read: under the values before it, a place that was not read need not take another one.
    fn turn(&mut self, inputs: &[Values], vector: &mut [u64]) -> bool {
        for k in (0..self.places.len()).rev() {
            let is_read = self.read.get(k).copied().unwrap_or(false);
            let (Some(place), Some(turn), true) =
                (self.places.get(k).copied(), self.turn.get(k).copied(), is_read)
            else {
                continue;
            };
            let next = Some(turn + 1).filter(|n| *n < tried(inputs, place).len());
            if let Some(t) = self.turn.get_mut(k) {
                *t = next.unwrap_or(0);
            }
            set(vector, place, self.value(inputs, place, next.unwrap_or(0)));
            if next.is_some() {
                self.forget(k + 1);
                return true;
            }
        }
        false
    }

    /// The places from this one on have new values before them.
    fn forget(&mut self, from: usize) {
        if self.lazy {
            self.read.iter_mut().skip(from).for_each(|r| *r = false);
        }
    }

    fn one_by_one(&mut self, inputs: &[Values], vector: &mut [u64], from: (usize, usize)) -> bool {
        let (mut k, mut number) = from;
        while let Some(place) = self.places.get(k).copied() {
            let now = self.last.get(place).copied();
            set(vector, place, now);
            while let Some(value) = tried(inputs, place).get(number).copied() {
                number += 1;
                if Some(value) != now {
                    set(vector, place, Some(value));
                    self.alone = Some((k, number));
                    return true;
                }
            }
            (k, number) = (k + 1, 0);
        }
        false
    }
}

/// The number of combinations of these places.
pub(crate) fn count(inputs: &[Values], places: &[usize]) -> usize {
    places.iter().fold(1usize, |n, i| n.saturating_mul(tried(inputs, *i).len().max(1)))
}

fn tried(inputs: &[Values], place: usize) -> &[u64] {
    inputs.get(place).map_or(&[][..], |v| &v.tried)
}

fn set(vector: &mut [u64], place: usize, value: Option<u64>) {
    if let (Some(word), Some(value)) = (vector.get_mut(place), value) {
        *word = value;
    }
}

#[cfg(test)]
mod tests {
    use super::{MOST, Tries};
    use crate::values::Values;

    fn all(inputs: &[Values], places: &[usize], last: &[u64]) -> Vec<Vec<u64>> {
        let (mut tries, mut vector, mut list) = (Tries::default(), Vec::new(), Vec::new());
        tries.begin(inputs, places, last, false);
        while tries.next(inputs, &mut vector) {
            list.push(vector.clone());
        }
        assert!(!tries.next(inputs, &mut vector), "it stays over");
        list
    }

    /// An input with the values 0 to `n - 1`.
    fn of(n: u64) -> Values {
        Values { tried: (0..n).collect(), whole: true }
    }

    #[test]
    fn each_combination_comes_once_with_the_present_one_first() {
        let inputs = [of(3), of(2), of(2)];
        let list = all(&inputs, &[0, 2], &[1, 1, 0]);
        let expected = [[1, 1, 0], [1, 1, 1], [0, 1, 0], [0, 1, 1], [2, 1, 0], [2, 1, 1]];
        assert_eq!(list, expected.map(|v| v.to_vec()));
        assert_eq!(all(&inputs, &[], &[2, 0, 1]), [[2, 0, 1].to_vec()]);
    }

    #[test]
    fn of_too_many_one_input_differs_at_a_time() {
        let inputs: Vec<Values> = (0..17).map(|_| of(2)).collect();
        assert!(1 << inputs.len() > MOST);
        let places: Vec<usize> = (0..17).collect();
        let mut last = vec![0; 17];
        last[3] = 1;
        let list = all(&inputs, &places, &last);
        assert_eq!(list.len(), 18);
        assert_eq!(list[0], last);
        for (k, vector) in list[1..].iter().enumerate() {
            let differ: Vec<usize> = (0..17).filter(|i| vector[*i] != last[*i]).collect();
            assert_eq!(differ, [k]);
        }
    }

    /// A scan that reads one input after the other, and the next one depends on what it read.
    fn outcome(rule: u64, v: &[u64]) -> (Vec<usize>, u64) {
        let (mut read, mut at, mut result) = (Vec::new(), rule, 1);
        for _ in 0..rule % 4 {
            at = at.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let place = (at >> 33) as usize % v.len();
            read.push(place);
            result = result * 5 + v[place];
            at ^= v[place] << 40;
        }
        (read, result)
    }

    #[test]
    fn the_first_combination_of_each_outcome_is_tried() {
        let inputs = [of(2), of(3), of(2), of(2), of(4)];
        let places = [0, 1, 2, 3, 4];
        let mut fewer = 0;
        for rule in 0..400 {
            let last = [rule % 2, rule % 3, 0, 1, rule % 4];
            let list = all(&inputs, &places, &last);
            let (mut tries, mut vector, mut some) = (Tries::default(), Vec::new(), Vec::new());
            tries.begin_read(&places, &last);
            while tries.next(&inputs, &mut vector) {
                let (read, _) = outcome(rule, &vector);
                tries.read(&inputs, |i| read.contains(&i));
                some.push(vector.clone());
            }
            let firsts = |list: &[Vec<u64>]| {
                let mut seen = Vec::new();
                for v in list {
                    let (_, result) = outcome(rule, v);
                    if !seen.iter().any(|(r, _)| *r == result) {
                        seen.push((result, v.clone()));
                    }
                }
                seen
            };
            assert_eq!(firsts(&some), firsts(&list), "rule {rule}");
            fewer += list.len() - some.len();
        }
        assert!(fewer > 30_000, "{fewer}");
    }
}
