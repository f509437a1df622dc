//! States from which no run leads on: deadlocks, and causes whose effect never comes.
//!
//! Only states count that none of their own scans leads on from. They are expanded once more, now that all
//! states have an owner. A state is good as soon as one of its scans leads to a good one; this goes back
//! from state to state, and from worker to worker, in phases. What is left over is bad.

use std::collections::BTreeMap;

use g7_verify::{Expander, Here};

use crate::exchange::{Lost, Phases};
use crate::known::Place;
use crate::pack::owner;
use crate::task::Task;
use crate::worker::Worker;

/// A state of some worker: worker, place in its list.
type Id = (u64, u64);

/// The first bad state in the order of one thread.
pub(crate) fn first(
    task: &Task<'_, '_>,
    question: u64,
    worker: &mut Worker<'_>,
    phases: &mut Phases<'_>,
) -> Result<Option<Place>, Lost> {
    let asked: Vec<_> = task.questions.iter().filter(|(i, _)| *i as u64 == question).copied().collect();
    let remembers = asked.iter().any(|(_, q)| Expander::remembers(q));
    let mut expander = task.expander(&asked);
    let (_, inputs) = expander.start();
    let mut image = Vec::new();
    let mut list = Vec::new();
    for blocked in &worker.blocked {
        let number = blocked.number as usize;
        worker.shelf.pack.unpack(&worker.shelf.store.image(number), &mut image);
        // Behind a state that remembers nothing, nothing is left to come.
        if !remembers || image.last().is_some_and(|w| *w != 0) {
            list.push(*blocked);
        }
    }
    let places: BTreeMap<u32, usize> = list.iter().enumerate().map(|(k, b)| (b.number, k)).collect();
    let mut graph =
        Graph { good: vec![false; list.len()], back: vec![Vec::new(); list.len()], say: Vec::new() };
    let (me, peers) = (phases.me() as u64, phases.peers());
    let (shelf, mut packed) = (&worker.shelf, Vec::new());
    let meet = |graph: &mut Graph, from: Id, packed: &[u64]| {
        let number = shelf.store.number(packed);
        match number.and_then(|n| places.get(&n)) {
            Some(to) => graph.back.get_mut(*to).into_iter().for_each(|b| b.push(from)),
            None => graph.say.push(from),
        }
    };
    let width = shelf.pack.words();
    for (k, blocked) in (0u64..).zip(&list) {
        shelf.pack.unpack(&shelf.store.image(blocked.number as usize), &mut image);
        let first = blocked.at == Place::default();
        expander.expand(Here { image: &image, inputs: &inputs, first }, |s| {
            let Some(next) = s.next else { return true };
            let to = owner(shelf.pack.hash(next), peers);
            packed.clear();
            shelf.pack.pack(next, &mut packed);
            match to as u64 == me {
                true => meet(&mut graph, (me, k), &packed),
                false => phases.send(to, &[&[me, k], &packed]),
            }
            true
        });
        if k.is_multiple_of(64) {
            phases.poll(&mut |_, words| each(words, width, &mut |id, p| meet(&mut graph, id, p)))?;
        }
    }
    phases.end(&[], &mut |_, words| each(words, width, &mut |id, p| meet(&mut graph, id, p)))?;
    graph.spread(phases)?;
    let left = list.iter().zip(&graph.good).filter(|(_, good)| !**good).map(|(b, _)| b);
    let mut bad: Vec<_> = left.collect();
    bad.sort_unstable();
    let mut is_bad = |number: u32| {
        shelf.pack.unpack(&shelf.store.image(number as usize), &mut image);
        remembers || !expander.is_end(&image)
    };
    let own = bad.into_iter().find(|b| is_bad(b.number)).map(|b| vec![b.at.level, b.at.rank]);
    let all = phases.share(&own.unwrap_or_default())?;
    let place = |words: &Vec<u64>| match words[..] {
        [level, rank] => Some(Place { level, rank }),
        _ => None,
    };
    Ok(all.iter().filter_map(place).min())
}

fn each(words: &[u64], width: usize, take: &mut dyn FnMut(Id, &[u64])) {
    for record in words.chunks_exact(2 + width) {
        if let Some(([worker, place], packed)) = record.split_first_chunk() {
            take((*worker, *place), packed);
        }
    }
}

/// The states of a worker that no scan of their own leads on from, with the scans that lead to them.
struct Graph {
    good: Vec<bool>,
    /// For each state: the states of which a scan leads there.
    back: Vec<Vec<Id>>,
    /// States that are to be told that they are good.
    say: Vec<Id>,
}

impl Graph {
    /// Tells all workers of their good states, until nothing is new.
    fn spread(&mut self, phases: &mut Phases<'_>) -> Result<(), Lost> {
        let me = phases.me() as u64;
        loop {
            let mut come: Vec<u64> = Vec::new();
            let said = self.say.len() as u64;
            for (worker, place) in std::mem::take(&mut self.say) {
                match worker == me {
                    true => come.push(place),
                    false => phases.send(worker as usize, &[&[place]]),
                }
            }
            let all = phases.end(&[said], &mut |_, words| come.extend_from_slice(words))?;
            if all.iter().flatten().all(|said| *said == 0) {
                return Ok(());
            }
            for place in come {
                let at = usize::try_from(place).unwrap_or(usize::MAX);
                if let Some(good) = self.good.get_mut(at).filter(|g| !**g) {
                    *good = true;
                    self.back.get_mut(at).into_iter().for_each(|b| self.say.append(b));
                }
            }
        }
    }
}
