//! Signals that are asked for only while no run shows others: a scan that is not known whole casts doubt on a proof,
//! and on nothing else. So the signal that tells of such scans is not asked for behind a refutation.

use crate::sat::graph::Signal;

/// For each signal the numbers of those whose runs make it needless. Without any it is always needed.
#[derive(Default)]
pub(crate) struct Needs(Vec<Vec<usize>>);

impl Needs {
    /// `signals` is in order, without doubles. Of each pair the second is asked for until a run shows the first.
    pub(crate) fn new(signals: &[Signal], pairs: &[[Signal; 2]]) -> Needs {
        let mut of = vec![Vec::new(); signals.len()];
        for [first, second] in pairs {
            if let (Ok(first), Ok(second)) = (signals.binary_search(first), signals.binary_search(second))
                && let Some(list) = of.get_mut(second)
            {
                list.push(first);
            }
        }
        // The first of a pair is needed for itself.
        for [first, _] in pairs {
            if let Some(list) = signals.binary_search(first).ok().and_then(|i| of.get_mut(i)) {
                list.clear();
            }
        }
        Needs(of)
    }

    /// True if a signal is needed, where `is_shown` tells for each number whether a run shows that signal.
    pub(crate) fn is_needed(&self, i: usize, is_shown: impl Fn(usize) -> bool) -> bool {
        self.0.get(i).is_none_or(|list| list.is_empty() || !list.iter().all(|first| is_shown(*first)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sat::graph::{Init, System};

    #[test]
    fn a_signal_is_needed_while_one_of_its_questions_is_open() {
        let mut s = System::default();
        let [a, b, doubt, own]: [Signal; 4] = std::array::from_fn(|_| s.latch(Init::Zero));
        let needs = Needs::new(&[a, b, doubt, own], &[[a, doubt], [b, doubt], [own, own], [a, b]]);
        let needed = |shown: &[usize]| (0..5).filter(|i| needs.is_needed(*i, |k| shown.contains(&k))).count();
        assert!(needs.is_needed(2, |k| k == 0), "the second question is open");
        assert!(!needs.is_needed(2, |k| k < 2));
        // A signal that is the first of a pair stays, whatever else it is.
        assert_eq!(needed(&[0, 1, 3]), 4);
        assert_eq!(needed(&[]), 5);
    }
}
