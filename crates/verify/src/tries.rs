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
    /// For each of them, the number of its value in hand, and the value that comes first.
    turn: Vec<usize>,
    /// There are more than [`MOST`]: the place in hand, then the value in hand.
    alone: Option<(usize, usize)>,
    begun: bool,
    over: bool,
}

impl Tries {
    /// Begins the combinations of these places.
    pub(crate) fn begin(&mut self, inputs: &[Values], places: &[usize], last: &[u64]) {
        self.last.clear();
        self.last.extend_from_slice(last);
        self.places.clear();
        self.places.extend_from_slice(places);
        self.turn.clear();
        self.turn.resize(places.len(), 0);
        self.alone = (count(inputs, places) > MOST).then_some((0, 0));
        (self.begun, self.over) = (false, false);
    }

    /// Puts the next combination into `vector`, which has the one before; false behind the last.
    pub(crate) fn next(&mut self, inputs: &[Values], vector: &mut Vec<u64>) -> bool {
        if self.over {
            return false;
        }
        if !std::mem::replace(&mut self.begun, true) {
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

    fn turn(&mut self, inputs: &[Values], vector: &mut [u64]) -> bool {
        for k in (0..self.places.len()).rev() {
            let (Some(place), Some(turn)) = (self.places.get(k).copied(), self.turn.get(k).copied()) else {
                return false;
            };
            let next = Some(turn + 1).filter(|n| *n < tried(inputs, place).len());
            if let Some(t) = self.turn.get_mut(k) {
                *t = next.unwrap_or(0);
            }
            set(vector, place, self.value(inputs, place, next.unwrap_or(0)));
            if next.is_some() {
                return true;
            }
        }
        false
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
        tries.begin(inputs, places, last);
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
}
