//! One worker: expands its states of a level, sends what it finds to the owners, and puts the new level in
//! the order of one thread.

use g7_verify::{Budget, Expander, Here};

use crate::exchange::{Lost, Phases};
use crate::known::{Known, Place};
use crate::levels::Level;
use crate::pack::Pack;
use crate::shelf::{STEP, Shelf};
use crate::task::Task;
use crate::words::Words;

/// Scans of a phase: so much is under way between two workers at most.
const SCANS: usize = 1 << 16;
/// After so many states a worker takes the packets that have arrived.
const LOOK: usize = 256;

/// A state that none of its scans leads on from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Blocked {
    pub(crate) at: Place,
    pub(crate) number: u32,
}

/// The reason why a level was not expanded as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Halt {
    /// A worker is to stop.
    Stopped,
    /// There are too many states.
    States,
    /// Some worker has no memory left.
    Memory,
}

/// A worker with its states.
pub(crate) struct Worker<'a> {
    pub(crate) expander: Expander<'a>,
    pub(crate) shelf: Shelf,
    /// The number of the level whose states are expanded next.
    pub(crate) level: u64,
    /// The number of levels that were found.
    levels: u64,
    /// Its states, in the order of one thread: number and rank.
    order: Vec<(u32, u64)>,
    /// The number of its first state, and for each the packed inputs of the scan before.
    first: usize,
    last: Vec<u64>,
    /// The states that nothing leads on from, if a question asks for them.
    pub(crate) blocked: Vec<Blocked>,
    note_blocked: bool,
}

impl<'a> Worker<'a> {
    /// A worker without states.
    pub(crate) fn new(task: &Task<'a, '_>, note_blocked: bool) -> Worker<'a> {
        let model = task.model;
        let mut expander = task.expander(task.questions);
        expander.stop_when(task.budget.stop);
        let (image, inputs) = expander.start();
        let differ = |v: &g7_verify::Values, first: &u64| v.tried.iter().fold(0, |m, t| m | (t ^ first));
        let mask = model.inputs.iter().zip(&inputs).map(|(v, first)| differ(v, first)).collect();
        let none = vec![0; image.len()];
        Worker {
            expander,
            shelf: Shelf::new(Pack::new(image, none), Pack::new(inputs, mask)),
            level: 0,
            levels: 0,
            order: Vec::new(),
            first: 0,
            last: Vec::new(),
            blocked: Vec::new(),
            note_blocked,
        }
    }

    /// Puts the state before the first scan where it belongs, and gives the first level.
    pub(crate) fn begin(&mut self, phases: &mut Phases<'_>) -> Result<Level, Lost> {
        let (image, inputs) = self.expander.start();
        if phases.me() == 0 {
            self.shelf.route(&image, &inputs, 0, phases);
        }
        let shelf = &mut self.shelf;
        phases.end(&[], &mut |_, words| shelf.take(words))?;
        self.shelf.settle(&[])?;
        self.arrange(phases)
    }

    /// Expands the states of the level, with all other workers. `known` gets what all of them have found.
    pub(crate) fn expand(
        &mut self,
        phases: &mut Phases<'_>,
        budget: &Budget<'_>,
        known: &mut Known,
    ) -> Result<Option<Halt>, Lost> {
        let (mut own, mut next) = (Known::default(), 0);
        self.shelf.level = self.level + 1;
        let halt = loop {
            let stopped = self.round(phases, &mut next, &mut own)? || (budget.stop)();
            let left = u64::from(next < self.order.len());
            let full = u64::from(self.bytes() > budget.bytes);
            let mut words = vec![left, u64::from(stopped), full, self.shelf.store.len() as u64];
            words.extend_from_slice(self.shelf.missing());
            let shelf = &mut self.shelf;
            let all = phases.end(&words, &mut |_, words| shelf.take(words))?;
            let masks: Vec<&[u64]> = all.iter().map(|w| w.get(4..).unwrap_or(&[])).collect();
            self.shelf.settle(&masks)?;
            let any = |k: usize| all.iter().any(|w| w.get(k).is_some_and(|w| *w != 0));
            let states = all.iter().filter_map(|w| w.get(3)).fold(0u64, |sum, w| sum.saturating_add(*w));
            match () {
                () if any(1) => break Some(Halt::Stopped),
                () if states > budget.states as u64 => break Some(Halt::States),
                () if any(2) => break Some(Halt::Memory),
                () if !any(0) => break None,
                () => {}
            }
        };
        own.states = (self.shelf.store.len() - self.shelf.from) as u64;
        let mut words = Vec::new();
        own.put(&mut words);
        for words in phases.share(&words)? {
            known.join(Known::get(&mut Words(&words)).ok_or(Lost::Gone)?);
        }
        Ok(halt)
    }

    /// Expands states until the phase is full; tells whether the work is to stop.
    fn round(&mut self, phases: &mut Phases<'_>, next: &mut usize, own: &mut Known) -> Result<bool, Lost> {
        let (mut packed, mut image, mut inputs) = (Vec::new(), Vec::new(), Vec::new());
        let mut scans = 0;
        let Worker { expander, shelf, .. } = self;
        while scans < SCANS
            && let Some((number, rank)) = self.order.get(*next).copied()
        {
            let at = Place { level: self.level, rank };
            shelf.store.get(number as usize, &mut packed);
            shelf.pack.unpack(&packed, &mut image);
            let words = shelf.inputs.words();
            let from = (number as usize - self.first) * words;
            shelf.inputs.unpack(self.last.get(from..from + words).unwrap_or(&[]), &mut inputs);
            let first = at == Place::default();
            let (mut on, mut step) = (false, 0u64);
            let done = expander.expand(Here { image: &image, inputs: &inputs, first }, |s| {
                on |= s.leads_on;
                s.shown.iter().for_each(|shown| own.show(at, step, shown));
                if let Some(image) = s.next {
                    shelf.route(image, &s.m.inputs, rank << STEP | step, phases);
                }
                step += 1;
                true
            });
            own.note(at, &done);
            if done.stopped {
                return Ok(true);
            }
            if !on && self.note_blocked {
                self.blocked.push(Blocked { at, number });
            }
            scans += done.scans.max(1);
            *next += 1;
            if next.is_multiple_of(LOOK) {
                phases.poll(&mut |_, words| shelf.take(words))?;
            }
        }
        Ok(false)
    }

    fn bytes(&self) -> usize {
        self.shelf.bytes() + self.order.len() * 16 + self.last.len() * 8 + self.blocked.len() * 24
    }

    /// Gives each new state its rank: the number of new states, of all workers, that one thread finds before
    /// it. Then the new level is the one in hand, and its records are given.
    pub(crate) fn arrange(&mut self, phases: &mut Phases<'_>) -> Result<Level, Lost> {
        let shelf = &mut self.shelf;
        let from = shelf.from as u32;
        let mut sorted: Vec<(u64, u32)> = shelf.keys.iter().copied().zip(from..).collect();
        sorted.sort_unstable();
        let keys: Vec<u64> = sorted.iter().map(|(key, _)| *key).collect();
        let me = phases.me();
        for to in (0..phases.peers()).filter(|to| *to != me) {
            keys.chunks(1024).for_each(|part| phases.send(to, &[part]));
        }
        // For each place among the own keys, how many of the others come directly before it.
        let mut before = vec![0u64; keys.len() + 1];
        let mut at = vec![0usize; phases.peers()];
        phases.end(&[], &mut |worker, others| {
            let Some(at) = at.get_mut(worker) else { return };
            for other in others {
                while keys.get(*at).is_some_and(|key| key < other) {
                    *at += 1;
                }
                before.get_mut(*at).into_iter().for_each(|n| *n += 1);
            }
        })?;
        let words = (shelf.pack.words(), shelf.inputs.words());
        let mut level = Level { width: 2 + words.0 + words.1, ..Level::default() };
        level.records.reserve(sorted.len() * level.width);
        self.order.clear();
        let (mut others, mut packed) = (0, Vec::new());
        for ((own, (key, number)), before) in (0u64..).zip(&sorted).zip(&before) {
            others += before;
            let rank = own + others;
            self.order.push((*number, rank));
            level.records.extend([rank, *key]);
            shelf.store.get(*number as usize, &mut packed);
            level.records.extend_from_slice(&packed);
            let last = (*number - from) as usize * words.1;
            level.records.extend_from_slice(shelf.last.get(last..last + words.1).unwrap_or(&[]));
        }
        self.advance();
        Ok(level)
    }

    /// The states that were new are the level in hand.
    fn advance(&mut self) {
        let shelf = &mut self.shelf;
        self.first = shelf.from;
        self.last = std::mem::take(&mut shelf.last);
        shelf.keys.clear();
        shelf.from = shelf.store.len();
        self.level = self.levels;
        self.levels += 1;
    }

    /// The ranks of the states of the level before the one in hand that nothing leads on from.
    pub(crate) fn blocked_ranks(&self) -> Vec<u64> {
        let before = |b: &&Blocked| b.at.level + 1 == self.level;
        self.blocked.iter().rev().take_while(before).map(|b| b.at.rank).collect()
    }

    /// Takes back a level that was kept, behind those before it. `blocked` are the ranks of those states of
    /// the level before that nothing leads on from.
    pub(crate) fn put_back(&mut self, level: &Level, mask: &[u64], blocked: &[u64]) -> Option<()> {
        for rank in blocked {
            let at = Place { level: self.level, rank: *rank };
            let place = self.order.binary_search_by_key(rank, |(_, rank)| *rank).ok()?;
            self.blocked.push(Blocked { at, number: self.order.get(place)?.0 });
        }
        let Shelf { pack, inputs, store, last, .. } = &mut self.shelf;
        let old = Pack::new(pack.first().to_vec(), mask.to_vec());
        let (mut image, mut packed) = (Vec::new(), Vec::new());
        self.order.clear();
        for record in level.records.chunks_exact(level.width) {
            let (head, rest) = record.split_at_checked(2)?;
            let (own, given) = rest.split_at_checked(old.words())?;
            if given.len() != inputs.words() {
                return None;
            }
            old.unpack(own, &mut image);
            packed.clear();
            if !pack.pack(&image, &mut packed) {
                return None;
            }
            self.order.push((store.len() as u32, *head.first()?));
            if store.find_or_insert(&packed).is_some() {
                return None;
            }
            last.extend_from_slice(given);
        }
        self.advance();
        Some(())
    }
}
