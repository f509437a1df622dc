//! Conditions on inputs in few words: a set of input values as a sum of products.

use std::collections::{BTreeMap, BTreeSet};

use crate::values::Values;

/// A product: inputs, by their places, with the values that they must have. Empty, it is true.
pub type Cube = Vec<(usize, u64)>;

/// Most sets of values that are put into few words.
const MOST: usize = 1024;

/// A set of values in which some inputs do not matter.
type Row = Vec<Option<u64>>;

/// A sum of products that holds for these values of the inputs at `places` and no other that may
/// be tried. Small, but not the smallest one. `None` where there are too many.
pub(crate) fn fewest(inputs: &[Values], places: &[usize], values: &[Vec<u64>]) -> Option<Vec<Cube>> {
    if values.len() > MOST {
        return None;
    }
    let all: BTreeSet<Row> = values.iter().map(|v| v.iter().copied().map(Some).collect()).collect();
    let mut left: Vec<&Row> = all.iter().collect();
    let primes = primes(inputs, places, &all)?;
    let mut chosen = Vec::new();
    while !left.is_empty() {
        let covers = |p: &Row| left.iter().filter(|row| holds(p, row)).count();
        // The first of the best ones, so that the order of the inputs decides.
        let best = primes.iter().rev().max_by_key(|p| covers(p))?;
        left.retain(|row| !holds(best, row));
        chosen.push(best);
    }
    let cube = |row: &&Row| row.iter().zip(places).filter_map(|(v, p)| v.map(|v| (*p, v))).collect();
    let mut cubes: Vec<Cube> = chosen.iter().map(cube).collect();
    cubes.sort();
    Some(cubes)
}

/// The products that no wider one contains (Quine and McCluskey, for inputs of several values).
fn primes(inputs: &[Values], places: &[usize], all: &BTreeSet<Row>) -> Option<Vec<Row>> {
    let (mut level, mut primes) = (all.clone(), Vec::new());
    while !level.is_empty() {
        let (mut wider, mut contained) = (BTreeSet::new(), BTreeSet::new());
        for (column, place) in places.iter().enumerate() {
            let count = inputs.get(*place).map_or(1, |v| v.tried.len().max(1));
            let mut groups: BTreeMap<Row, Vec<&Row>> = BTreeMap::new();
            for row in level.iter().filter(|r| r.get(column).is_some_and(Option::is_some)) {
                let mut key = row.clone();
                key.get_mut(column).into_iter().for_each(|v| *v = None);
                groups.entry(key).or_default().push(row);
            }
            for (key, members) in groups.into_iter().filter(|(_, m)| m.len() == count) {
                wider.insert(key);
                contained.extend(members.into_iter().cloned());
            }
        }
        if wider.len() > 4 * MOST {
            return None;
        }
        primes.extend(level.difference(&contained).cloned());
        level = wider;
    }
    Some(primes)
}

/// True if a product holds wherever another one does.
fn holds(wide: &Row, row: &Row) -> bool {
    wide.iter().zip(row).all(|(w, r)| w.is_none() || w == r)
}

/// Adds a product to a sum, unless one of it contains it. One that is true by itself is kept beside
/// the others: it tells that in some state the inputs do not matter.
pub(crate) fn add(sum: &mut Vec<Cube>, cube: Cube) {
    let within = |narrow: &Cube, wide: &Cube| wide.iter().all(|literal| narrow.contains(literal));
    let same_kind = |other: &&Cube| other.is_empty() == cube.is_empty();
    if sum.iter().filter(same_kind).any(|wide| within(&cube, wide)) {
        return;
    }
    sum.retain(|narrow| narrow.is_empty() || cube.is_empty() || !within(narrow, &cube));
    sum.push(cube);
    sum.sort();
}

#[cfg(test)]
mod tests {
    use super::{Values, add, fewest};

    fn bools(n: usize) -> Vec<Values> {
        vec![Values { tried: vec![0, 1], whole: true }; n]
    }

    #[test]
    fn a_sum_has_the_products_that_one_would_write() {
        let sum = |values: &[[u64; 2]]| {
            let values: Vec<Vec<u64>> = values.iter().map(|v| v.to_vec()).collect();
            fewest(&bools(9), &[3, 7], &values)
        };
        // a + b, a · not b, all.
        assert_eq!(sum(&[[0, 1], [1, 0], [1, 1]]), Some(vec![vec![(3, 1)], vec![(7, 1)]]));
        assert_eq!(sum(&[[1, 0]]), Some(vec![vec![(3, 1), (7, 0)]]));
        assert_eq!(sum(&[[0, 0], [0, 1], [1, 0], [1, 1]]), Some(vec![vec![]]));
        // Exclusive or has no shorter form.
        assert_eq!(sum(&[[0, 1], [1, 0]]), Some(vec![vec![(3, 0), (7, 1)], vec![(3, 1), (7, 0)]]));
    }

    #[test]
    fn a_number_is_left_out_only_if_all_its_values_lead_there() {
        let inputs = [Values { tried: vec![4, 5, 6], whole: true }];
        let sum =
            |values: &[u64]| fewest(&inputs, &[0], &values.iter().map(|v| vec![*v]).collect::<Vec<_>>());
        assert_eq!(sum(&[4, 5]), Some(vec![vec![(0, 4)], vec![(0, 5)]]));
        assert_eq!(sum(&[4, 5, 6]), Some(vec![vec![]]));
    }

    #[test]
    fn every_sum_holds_for_its_values_and_no_others() {
        for set in 0u32..256 {
            let all: Vec<Vec<u64>> = (0..8u64).map(|v| vec![v & 1, v >> 1 & 1, v >> 2]).collect();
            let mine: Vec<Vec<u64>> = (0..8).filter(|i| set >> i & 1 != 0).map(|i| all[i].clone()).collect();
            let sum = fewest(&bools(3), &[0, 1, 2], &mine).expect("few values");
            for v in &all {
                let is = sum.iter().any(|cube| cube.iter().all(|(place, value)| v[*place] == *value));
                assert_eq!(is, mine.contains(v), "{set}: {sum:?}");
            }
        }
    }

    #[test]
    fn narrower_products_go_and_the_empty_one_stays_beside_the_others() {
        let mut sum = Vec::new();
        for cube in [vec![(0, 1), (1, 1)], vec![(0, 1)], vec![(0, 1), (2, 0)], vec![], vec![(3, 0)]] {
            add(&mut sum, cube);
        }
        assert_eq!(sum, [vec![], vec![(0, 1)], vec![(3, 0)]]);
    }
}
