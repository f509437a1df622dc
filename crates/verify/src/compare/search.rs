//! The search of all pairs of states, breadth first.

use g7_engine::State;

use super::equality::Equality;
use super::run::End;
use super::sides::Sides;
use crate::expand::gap;
use crate::layer::Budget;
use crate::reason::Reason;
use crate::store::Store;
use crate::tries::Tries;
use crate::values::Values;
use crate::verdict::{Certificate, Open};
use crate::world::{World, put};

/// Pairs of states, and scans, between two questions whether to stop.
const PATIENCE: usize = 64;

/// The answer of the search.
pub(super) struct Found {
    pub(super) equality: Equality,
    /// In some pair of states not all inputs were tried that matter.
    pub(super) hole: bool,
}

/// A search in the making.
struct Pairs {
    store: Store,
    /// For each pair the one before it.
    parents: Vec<u32>,
    /// For each pair the inputs of the scan that led there.
    inputs: Vec<u64>,
    /// Number of inputs.
    count: usize,
}

impl Pairs {
    fn bytes(&self) -> usize {
        self.store.bytes() + self.inputs.len() * 8 + self.parents.len() * 4
    }

    fn vector(&self, at: usize) -> Vec<u64> {
        self.inputs.get(at * self.count..(at + 1) * self.count).unwrap_or(&[]).to_vec()
    }

    /// The inputs of the run to a pair, and these behind it.
    fn path(&self, mut at: usize, last: &[u64]) -> Vec<Vec<u64>> {
        let mut vectors = vec![last.to_vec()];
        while at > 0 {
            vectors.push(self.vector(at));
            at = self.parents.get(at).copied().unwrap_or(0) as usize;
        }
        vectors.reverse();
        vectors
    }
}

impl Sides<'_> {
    /// Visits all pairs of states, or as many as the budget allows.
    pub(super) fn search(&self, budget: &Budget<'_>) -> Found {
        let [pa, pb] = self.programs();
        let (mut a, mut b) = (State::new(pa), State::new(pb));
        let (mut image, mut second) = (Vec::new(), Vec::new());
        a.canonical(pa, &mut image);
        let width = image.len();
        b.canonical(pb, &mut second);
        image.extend_from_slice(&second);
        let first = self.inputs.iter().map(|i| i.values.tried.first().copied().unwrap_or(0)).collect();
        let mut pairs =
            Pairs { store: Store::new(), parents: vec![0], inputs: first, count: self.inputs.len() };
        pairs.store.insert(&image);
        let assumed = self.models.iter().any(|m| !m.assume.is_empty());
        let values: Vec<Values> = self.inputs.iter().map(|i| i.values.clone()).collect();
        let (mut tries, mut vector) = (Tries::default(), Vec::new());
        let mut worlds = [World::new(&self.models[0]), World::new(&self.models[1])];
        let (mut at, mut level, mut depth, mut scans) = (0usize, 1usize, 0usize, 0usize);
        let mut hole = None;
        let open = |scans, states, reason, hole: Option<usize>| Found {
            equality: Equality::Open(Open { scans, states, reason }),
            hole: hole.is_some(),
        };
        while at < pairs.store.len() {
            if at == level {
                depth += 1;
                level = pairs.store.len();
            }
            let states = pairs.store.len();
            if let Some(reason) = budget.full(states, pairs.bytes()) {
                return open(depth, states, reason, hole);
            }
            if at.is_multiple_of(PATIENCE) && (budget.stop)() {
                return open(depth, states, Reason::Stopped, hole);
            }
            let from = pairs.store.image(at);
            let (own, other) = from.split_at(width.min(from.len()));
            put(pa, &mut a, own);
            put(pb, &mut b, other);
            let places = self.matter([&a, &b]);
            if gap(&values, &places).is_some() {
                hole = hole.or(Some(depth));
            }
            let wait = if at == 0 { 0 } else { self.period };
            let mut tried = false;
            tries.begin(&values, &places, &pairs.vector(at), false);
            while tries.next(&values, &mut vector) {
                if (scans >= budget.scans || scans.is_multiple_of(PATIENCE))
                    && let Some(reason) = budget.over(scans)
                {
                    return open(depth, states, reason, hole);
                }
                if assumed {
                    let [first, second] = &mut worlds;
                    put(pa, &mut first.charts, own);
                    put(pb, &mut second.charts, other);
                    if !self.allowed(&mut worlds, &vector, wait) {
                        continue;
                    }
                }
                tried = true;
                put(pa, &mut a, own);
                put(pb, &mut b, other);
                scans += 1;
                match self.step([&mut a, &mut b], &vector, wait) {
                    End::Apart(_) => {
                        let equality = self.apart(&pairs.path(at, &vector)).unwrap_or(Equality::Open(Open {
                            scans: depth,
                            states,
                            reason: Reason::NotRepeated,
                        }));
                        return Found { equality, hole: hole.is_some() };
                    }
                    End::Alike { goes_on: false } => continue,
                    End::Alike { goes_on: true } => {}
                }
                a.canonical(pa, &mut image);
                b.canonical(pb, &mut second);
                image.extend_from_slice(&second);
                if pairs.store.insert(&image) {
                    pairs.parents.push(at as u32);
                    pairs.inputs.extend_from_slice(&vector);
                }
            }
            if !tried {
                return open(depth, states, Reason::NoInput(depth), hole);
            }
            at += 1;
        }
        let states = pairs.store.len();
        match hole {
            None => Found { equality: Equality::Equal(Certificate::Search { states, scans }), hole: false },
            Some(depth) => open(depth, states, Reason::Inputs, hole),
        }
    }

    /// The places of the inputs that matter in a pair of states, ascending.
    fn matter(&self, states: [&State; 2]) -> Vec<usize> {
        let mut matter = vec![false; self.inputs.len()];
        for (side, (asking, state)) in self.asking.iter().zip(states).enumerate() {
            let places = asking.matter(&asking.asked(state));
            for (input, m) in self.inputs.iter().zip(&mut matter) {
                *m |= input.places.get(side).copied().flatten().is_some_and(|p| places.contains(p));
            }
        }
        matter.iter().enumerate().filter(|(_, m)| **m).map(|(i, _)| i).collect()
    }
}
