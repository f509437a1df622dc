//! The findings of a search so far: of one worker in one level, or of all in all levels.
//!
//! Findings of several workers are joined by the place of each in the order of one thread, so it makes no
//! difference who found what first.

use std::collections::BTreeMap;

use g7_verify::{Expanded, Gap, Shown};

use crate::words::Words;

/// A state, by its level and its rank there. The order is that in which one thread visits states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Place {
    pub(crate) level: u64,
    pub(crate) rank: u64,
}

/// A scan that answers a question.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Hit {
    /// The state before the scan.
    pub(crate) at: Place,
    /// The number of the scan among those of its state.
    pub(crate) step: u64,
    pub(crate) kind: Kind,
}

/// The kind of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// The run shows it; with or without the fault that ends its last scan.
    Run { fault: bool },
    /// A condition has a fault there.
    Unclear,
    /// The run leads to the state: it has no scan more.
    Trap,
}

/// A reason why not all scans that matter were made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Hole {
    pub(crate) at: Place,
    pub(crate) gap: (u64, u64),
}

/// Findings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Known {
    pub(crate) states: u64,
    pub(crate) scans: u64,
    pub(crate) cut: bool,
    pub(crate) cut_passes: bool,
    /// The first gap.
    pub(crate) hole: Option<Hole>,
    /// The first state in which no input satisfies the assumptions.
    pub(crate) stuck: Option<Place>,
    /// For each question that has an answer, the first one.
    pub(crate) hits: BTreeMap<u64, Hit>,
}

impl Known {
    /// Notes the end of an expansion.
    pub(crate) fn note(&mut self, at: Place, done: &Expanded) {
        self.scans += done.scans as u64;
        self.cut |= done.cut;
        self.cut_passes |= done.cut_passes;
        let gap = done.gap.map(|gap| match gap {
            Gap::Combinations(count) => (0, count as u64),
            Gap::Values(place) => (1, place as u64),
            // Chart and plant are not searched here.
            Gap::Plant(_) | Gap::Chance => (2, 0),
        });
        self.hole = first(self.hole.take(), gap.map(|gap| Hole { at, gap }));
        self.stuck = first(self.stuck, (done.stuck && !done.stopped).then_some(at));
    }

    /// Notes what a scan shows.
    pub(crate) fn show(&mut self, at: Place, step: u64, shown: &Shown) {
        let (question, kind) = match shown {
            Shown::Run { question, fault } => (*question, Kind::Run { fault: fault.is_some() }),
            Shown::Unclear { question, .. } => (*question, Kind::Unclear),
        };
        self.hit(question as u64, Hit { at, step, kind });
    }

    pub(crate) fn hit(&mut self, question: u64, hit: Hit) {
        let place = self.hits.entry(question).or_insert_with(|| hit.clone());
        if hit < *place {
            *place = hit;
        }
    }

    /// Joins the findings of another worker, or of another level.
    pub(crate) fn join(&mut self, other: Known) {
        self.states = self.states.saturating_add(other.states);
        self.scans = self.scans.saturating_add(other.scans);
        self.cut |= other.cut;
        self.cut_passes |= other.cut_passes;
        self.hole = first(self.hole.take(), other.hole);
        self.stuck = first(self.stuck, other.stuck);
        for (question, hit) in other.hits {
            self.hit(question, hit);
        }
    }

    pub(crate) fn put(&self, into: &mut Vec<u64>) {
        into.extend([self.states, self.scans, u64::from(self.cut), u64::from(self.cut_passes)]);
        let hole = self.hole.map(|h| [h.at.level, h.at.rank, h.gap.0, h.gap.1]);
        into.push(u64::from(hole.is_some()));
        into.extend(hole.into_iter().flatten());
        into.push(u64::from(self.stuck.is_some()));
        into.extend(self.stuck.iter().flat_map(|p| [p.level, p.rank]));
        into.push(self.hits.len() as u64);
        for (question, hit) in &self.hits {
            into.extend([*question, hit.at.level, hit.at.rank, hit.step]);
            match &hit.kind {
                Kind::Run { fault } => into.push(u64::from(*fault)),
                Kind::Trap => into.push(2),
                Kind::Unclear => into.push(3),
            }
        }
    }

    pub(crate) fn get(words: &mut Words<'_>) -> Option<Known> {
        let mut known = Known {
            states: words.next()?,
            scans: words.next()?,
            cut: words.next()? != 0,
            cut_passes: words.next()? != 0,
            ..Known::default()
        };
        if words.next()? != 0 {
            let at = Place { level: words.next()?, rank: words.next()? };
            known.hole = Some(Hole { at, gap: (words.next()?, words.next()?) });
        }
        if words.next()? != 0 {
            known.stuck = Some(Place { level: words.next()?, rank: words.next()? });
        }
        for _ in 0..words.next()? {
            let question = words.next()?;
            let at = Place { level: words.next()?, rank: words.next()? };
            let step = words.next()?;
            let kind = match words.next()? {
                2 => Kind::Trap,
                3 => Kind::Unclear,
                fault => Kind::Run { fault: fault != 0 },
            };
            known.hits.insert(question, Hit { at, step, kind });
        }
        Some(known)
    }
}

fn first<T: Ord>(a: Option<T>, b: Option<T>) -> Option<T> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

#[cfg(test)]
mod tests {
    use super::Known;

    #[test]
    fn numbers_that_another_worker_sends_do_not_overflow() {
        let mut known = Known { states: 2, scans: 2, ..Known::default() };
        known.join(Known { states: u64::MAX, scans: u64::MAX, ..Known::default() });
        assert_eq!((known.states, known.scans), (u64::MAX, u64::MAX));
    }
}
