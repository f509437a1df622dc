//! The search: level by level, each level by as many threads as there are shares of the set.
//!
//! The hash of a state says to which share it belongs; each share has a thread. In a round each thread makes the moves
//! of some states of its share. Then it adds to its share those new states that belong there, whichever thread has
//! found them. All threads wait for each other at the end of each half of a round. Rounds and levels are barriers, so the set of
//! states, the levels and the lengths of the runs do not depend on the number of threads.

use super::expand::{Expander, Moves};
use super::program::Program;
use super::set::{Set, hash_of};
use super::wanted::{Tries, Wanted};
use crate::layer::Budget;
use crate::reason::Reason;

/// States that a thread expands in a round where it is alone: what they lead to stays in the cache.
const ALONE: usize = 1 << 10;
/// The same where others wait for it.
const TOGETHER: usize = 1 << 15;
/// Levels of fewer states are not worth a second thread.
const FEW: usize = 1 << 12;

/// States that one thread owns.
struct Share {
    set: Set,
    /// For each state: the one before, by share and number.
    parents: Vec<Name>,
    /// The states of the level, by their numbers.
    level: std::ops::Range<usize>,
}

/// A state by the number of its share and its own, in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Name(u32);

/// A run that ends with a scan that shows a signal: the last state, and the inputs of the scan.
#[derive(Clone, Debug)]
struct Sight {
    last: Name,
    inputs: Vec<u64>,
}

pub(super) struct Search<'p> {
    stages: &'p [Program],
    tries: Tries,
    together: usize,
    shares: Vec<Share>,
    /// For each signal that is asked for.
    shown: Vec<Option<Sight>>,
    pub(super) scans: usize,
    /// Levels that are expanded.
    pub(super) depth: usize,
    /// Scans before the first state in which no inputs satisfy the constraints.
    pub(super) stuck: Option<usize>,
    /// Why not all states are expanded.
    pub(super) open: Option<Reason>,
}

impl<'p> Search<'p> {
    /// A search from one state.
    pub(super) fn new(stages: &'p [Program], start: &[u64], wanted: &Wanted<'_>) -> Search<'p> {
        let Wanted { tries, threads, together, .. } = *wanted;
        let share = || Share {
            set: Set::new(stages.first().map_or(0, |p| p.latches.len())),
            parents: Vec::new(),
            level: 0..0,
        };
        let mut shares: Vec<Share> = (0..threads.clamp(1, 64)).map(|_| share()).collect();
        let owner = owner(start, shares.len());
        if let Some(share) = shares.get_mut(owner) {
            share.set.add(start, |_| {});
            share.parents.push(FIRST);
            share.level = 0..1;
        }
        let shown = vec![None; stages.first().map_or(0, |p| p.asked.len())];
        Search { stages, tries, together, shares, shown, scans: 0, depth: 0, stuck: None, open: None }
    }

    /// The number of states.
    pub(super) fn states(&self) -> usize {
        self.shares.iter().map(|s| s.set.len()).sum()
    }

    /// Bytes of the states, and of what the runs need.
    pub(super) fn bytes(&self) -> (usize, usize) {
        let sum = |of: fn(&Share) -> usize| self.shares.iter().map(of).sum();
        (sum(|s| s.set.bytes()), sum(|s| 4 * s.parents.capacity()))
    }

    /// Makes the moves of all states, level by level. Ends when no state is left, when the budget is used up, or, but
    /// for `all`, when all signals are shown.
    pub(super) fn run(&mut self, budget: &Budget<'_>, all: bool) {
        let mut hands: Vec<Expander<'p>> = self.shares.iter().map(|_| self.expander()).collect();
        while self.shares.iter().any(|s| !s.level.is_empty()) {
            let ends: Vec<usize> = self.shares.iter().map(|s| s.set.len()).collect();
            while self.shares.iter().any(|s| !s.level.is_empty()) {
                self.round(&mut hands);
                let (states, runs) = self.bytes();
                self.open = budget
                    .full(self.states(), states + runs)
                    .or(budget.over(self.scans))
                    .or(self.open.take());
                if self.open.is_some() || !all && self.shown.iter().all(Option::is_some) {
                    return;
                }
            }
            for (share, end) in self.shares.iter_mut().zip(ends) {
                share.level = end..share.set.len();
            }
            self.depth += 1;
        }
    }

    fn expander(&self) -> Expander<'p> {
        let width = self.shares.first().map_or(1, |s| s.set.width());
        Expander::new(self.stages, width, self.tries, self.together)
    }

    /// Expands some states of each share, and takes in what they lead to.
    fn round(&mut self, hands: &mut [Expander<'p>]) {
        let left: usize = self.shares.iter().map(|s| s.level.len()).sum();
        let side_by_side = self.shares.len() > 1 && left >= FEW;
        let most = if side_by_side { TOGETHER } else { ALONE };
        let count = self.shares.len();
        let work = self.shares.iter().zip(hands.iter_mut()).enumerate();
        let found: Vec<Found> = if side_by_side {
            std::thread::scope(|scope| {
                let each =
                    work.map(|(me, (share, hand))| scope.spawn(move || share.expand(me, count, most, hand)));
                let each: Vec<_> = each.collect();
                each.into_iter().filter_map(|t| t.join().ok()).collect()
            })
        } else {
            work.map(|(me, (share, hand))| share.expand(me, count, most, hand)).collect()
        };
        let take = |(me, share): (usize, &mut Share)| share.take(me, &found, most);
        let shares = self.shares.iter_mut().enumerate();
        if side_by_side {
            std::thread::scope(|scope| shares.for_each(|s| drop(scope.spawn(move || take(s)))));
        } else {
            shares.for_each(take);
        }
        for found in found {
            self.scans += found.scans;
            for (shown, new) in self.shown.iter_mut().zip(found.shown) {
                *shown = shown.take().or(new);
            }
            if found.is_stuck {
                self.stuck = self.stuck.or(Some(self.depth));
            }
            if found.many {
                self.open = self.open.take().or(Some(Reason::Inputs));
            }
        }
    }

    /// The inputs of each scan of the run that ends with a signal.
    pub(super) fn run_to(&self, asked: usize) -> Option<Vec<Vec<u64>>> {
        let sight = self.shown.get(asked)?.as_ref()?;
        let mut hand = self.expander();
        let (mut inputs, mut state) = (vec![sight.inputs.clone()], sight.last);
        while let Some(before) = self.before(state) {
            inputs.push(hand.between(self.state(before), self.state(state))?);
            state = before;
        }
        inputs.reverse();
        Some(inputs)
    }

    fn state(&self, name: Name) -> &[u64] {
        let (share, number) = name.parts(self.shares.len());
        self.shares.get(share).map_or(&[], |s| s.set.get(number))
    }

    /// The state from which a state was found; none for the first.
    fn before(&self, name: Name) -> Option<Name> {
        let (share, number) = name.parts(self.shares.len());
        self.shares.get(share)?.parents.get(number).copied().filter(|n| *n != FIRST)
    }

    /// True if all states were expanded by all moves.
    pub(super) fn is_whole(&self) -> bool {
        self.open.is_none() && self.shares.iter().all(|s| s.level.is_empty())
    }

    /// True if a signal is shown.
    pub(super) fn is_shown(&self, asked: usize) -> bool {
        self.shown.get(asked).is_some_and(Option::is_some)
    }

    /// True if a state was reached.
    pub(super) fn contains(&self, row: &[u64]) -> bool {
        self.shares.get(owner(row, self.shares.len())).is_some_and(|s| s.set.contains(row))
    }

    /// About so many states, evenly spread over all.
    pub(super) fn some(&self, count: usize) -> impl Iterator<Item = &[u64]> {
        let each = self.shares.iter().flat_map(|s| (0..s.set.len()).map(|k| s.set.get(k)));
        each.step_by((self.states() / count.max(1)).max(1))
    }
}

/// The moves of some states, each at the share that owns the state behind it.
struct Found {
    /// For each share: the states that belong there, and for each of them the state from which it was found.
    rows: Vec<(Vec<u64>, Vec<Name>)>,
    scans: usize,
    shown: Vec<Option<Sight>>,
    is_stuck: bool,
    many: bool,
}

impl Share {
    /// The moves of the next states of the level, at most so many.
    fn expand(&self, me: usize, shares: usize, most: usize, hand: &mut Expander<'_>) -> Found {
        let width = self.set.width();
        let mut all = Found {
            rows: vec![Default::default(); shares],
            scans: 0,
            shown: Vec::new(),
            is_stuck: false,
            many: false,
        };
        let end = self.level.end.min(self.level.start + most);
        let mut moves = Moves::default();
        let mut start = self.level.start;
        while start < end {
            let count = ALONE.min(end - start);
            moves.clear();
            hand.expand(self.set.rows(start, count), &mut moves);
            let name = |place: u32| Name::new(me, start + place as usize, shares);
            for (row, from) in moves.rows.chunks_exact(width).zip(&moves.from) {
                let owner = if shares == 1 { 0 } else { owner(row, shares) };
                if let Some((rows, names)) = all.rows.get_mut(owner) {
                    rows.extend_from_slice(row);
                    names.push(name(*from));
                }
            }
            all.scans += moves.scans;
            all.shown.resize(moves.shown.len(), None);
            for (shown, new) in all.shown.iter_mut().zip(&mut moves.shown) {
                let sight = new.take().map(|(last, inputs)| Sight { last: name(last), inputs });
                *shown = shown.take().or(sight);
            }
            all.is_stuck |= moves.is_stuck;
            all.many |= moves.many;
            start += count;
        }
        all
    }

    /// Takes in the states that are found for it.
    fn take(&mut self, me: usize, found: &[Found], most: usize) {
        self.level.start = self.level.end.min(self.level.start + most);
        for (rows, names) in found.iter().filter_map(|f| f.rows.get(me)) {
            let parents = &mut self.parents;
            self.set.add(rows, |place| parents.extend(names.get(place)));
        }
    }
}

/// The name before the first state.
const FIRST: Name = Name(u32::MAX);

impl Name {
    fn new(share: usize, number: usize, shares: usize) -> Name {
        Name((number * shares + share) as u32)
    }

    fn parts(self, shares: usize) -> (usize, usize) {
        (self.0 as usize % shares, self.0 as usize / shares)
    }
}

/// The share that owns a state.
fn owner(row: &[u64], shares: usize) -> usize {
    // The upper bits choose the place within the share.
    ((hash_of(row) & 0xFFFF) as usize * shares) >> 16
}
