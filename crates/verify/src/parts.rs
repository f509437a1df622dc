//! Searches side by side: one for each question with a memory, or one for each part of a chart that
//! consists of parts. None of them knows of the others, so their number at a time changes no answer.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::divide::{Division, Who, divide};
use crate::layer::Budget;
use crate::model::Model;
use crate::monitor::has_memory;
use crate::outcome::asks_for_traps;
use crate::question::Question;
use crate::scene::Until;
use crate::search::{Ended, Search};
use crate::verdict::{Certificate, Evidence, Verdict};

/// One search.
pub(crate) struct Job<'q> {
    pub(crate) questions: Vec<(usize, &'q Question)>,
    /// The places of the inputs of a part, of a chart that is divided.
    pub(crate) inputs: Option<&'q [usize]>,
}

/// The searches for some questions: one for those without a memory, and one for each other.
pub(crate) fn jobs<'q>(questions: &[(usize, &'q Question)], inputs: Option<&'q [usize]>) -> Vec<Job<'q>> {
    let (alone, together): (Vec<_>, Vec<_>) =
        questions.iter().copied().partition(|(_, q)| has_memory(&q.claim));
    let groups = std::iter::once(together).chain(alone.into_iter().map(|q| vec![q]));
    groups.filter(|g| !g.is_empty()).map(|questions| Job { questions, inputs }).collect()
}

/// The result of a search.
pub(crate) struct Found {
    /// The answers, with the numbers of their questions.
    pub(crate) answers: Vec<(usize, Verdict)>,
    /// It made as many scans as it was allowed.
    pub(crate) short: bool,
    /// All states were visited, and each has a scan without a fault that the assumptions allow.
    pub(crate) goes_on: bool,
}

/// Does all searches, so many at a time, and gives their answers in the order of the jobs.
pub(crate) fn run(model: &Model<'_>, jobs: &[Job<'_>], budget: &Budget<'_>, threads: usize) -> Vec<Found> {
    let threads = threads.clamp(1, jobs.len().max(1));
    // Each has its share of the memory.
    let budget = Budget { bytes: budget.bytes / threads, ..*budget };
    let one = |job: &Job<'_>| {
        let mut search = Search::new(model, &budget, job.questions.clone());
        search.within = job.inputs.map(<[usize]>::to_vec);
        // Without a question, the search tells if the part goes on.
        if job.questions.is_empty() {
            search.until = Until::Visited;
        }
        let Ended { answers, scans, goes_on } = search.run();
        Found { answers, short: scans >= budget.scans, goes_on }
    };
    if threads == 1 {
        return jobs.iter().map(one).collect();
    }
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        while let Some((at, job)) = {
            let at = next.fetch_add(1, Ordering::Relaxed);
            jobs.get(at).map(|job| (at, job))
        } {
            let done = one(job);
            found.lock().unwrap_or_else(|e| e.into_inner()).push((at, done));
        }
    };
    std::thread::scope(|scope| {
        (1..threads).for_each(|_| drop(scope.spawn(work)));
        work();
    });
    let mut found = found.into_inner().unwrap_or_else(|e| e.into_inner());
    found.sort_by_key(|(at, _)| *at);
    found.into_iter().map(|(_, done)| done).collect()
}

/// Answers the questions that the parts of a chart decide, if it can be divided.
pub(crate) fn divided(
    model: &Model<'_>,
    questions: &[(usize, &Question)],
    budget: &Budget<'_>,
    threads: usize,
) -> Vec<(usize, Verdict)> {
    let claims: Vec<&Question> = questions.iter().map(|(_, q)| *q).collect();
    let Some(division) = divide(model, &claims) else { return Vec::new() };
    let who = || questions.iter().zip(&division.who);
    let (mut all, mut parts): (Vec<Job<'_>>, Vec<usize>) = Default::default();
    for (k, inputs) in division.inputs.iter().enumerate() {
        let mine = who().filter(|(_, w)| matches!(w, Who::Each | Who::Some) || **w == Who::Part(k));
        let mine: Vec<_> = mine.map(|(q, _)| *q).collect();
        all.extend(jobs(&mine, Some(inputs)));
        parts.resize(all.len(), k);
    }
    let found = run(model, &all, budget, threads);
    let of = |i: usize| {
        let each = found.iter().zip(&parts).flat_map(|(f, k)| f.answers.iter().map(move |(n, v)| (n, v, *k)));
        each.filter(move |(n, ..)| **n == i).map(|(_, v, k)| (v, k))
    };
    let mut stops = Stops { model, division: &division, budget, threads, known: BTreeMap::new() };
    for (f, k) in found.iter().zip(&parts).filter(|(f, _)| f.goes_on) {
        stops.known.insert(*k, f.goes_on);
    }
    let mut answers = Vec::new();
    for ((i, q), who) in who() {
        let needs_all = asks_for_traps(&q.claim);
        let mut is_sure = |k| !needs_all || stops.others_go_on(k);
        let verdict = match who {
            Who::Part(_) => of(*i).find(|(v, k)| !is_undecided(v) && is_sure(*k)).map(|(v, _)| v.clone()),
            Who::Each => each(of(*i).map(|(v, _)| v)),
            Who::Some => {
                let mut proved = of(*i).filter(|(v, _)| matches!(v, Verdict::Proved(_)));
                proved.find(|(_, k)| is_sure(*k)).map(|(v, _)| v.clone())
            }
            Who::Nobody => None,
        };
        answers.extend(verdict.filter(|v| !is_undecided(v)).map(|v| (*i, v)));
    }
    answers
}

fn is_undecided(v: &Verdict) -> bool {
    matches!(v, Verdict::Open(_))
}

/// Knows which parts go on from each of their states. A claim about all that can follow needs to know it: where
/// one part has only scans with a fault, or none that the assumptions allow, no part goes on.
struct Stops<'a> {
    model: &'a Model<'a>,
    division: &'a Division,
    budget: &'a Budget<'a>,
    threads: usize,
    known: BTreeMap<usize, bool>,
}

impl Stops<'_> {
    /// True if all parts but this one always have a scan without a fault.
    fn others_go_on(&mut self, part: usize) -> bool {
        let open = (0..self.division.inputs.len()).filter(|k| *k != part && !self.known.contains_key(k));
        let open: Vec<usize> = open.collect();
        let inputs = open.iter().filter_map(|k| self.division.inputs.get(*k));
        let all: Vec<Job<'_>> =
            inputs.map(|inputs| Job { questions: Vec::new(), inputs: Some(inputs) }).collect();
        let found = run(self.model, &all, self.budget, self.threads);
        self.known.extend(open.into_iter().zip(found.iter().map(|f| f.goes_on)));
        self.known.iter().all(|(k, goes_on)| *k == part || *goes_on)
    }
}

/// The answer for a claim that each part must keep: the shortest run that breaks it, or all proofs.
fn each<'v>(answers: impl Iterator<Item = &'v Verdict>) -> Option<Verdict> {
    let (mut shortest, mut states, mut scans, mut open) = (None, 0, 0, false);
    for a in answers {
        match a {
            Verdict::Refuted(Evidence::Run(run)) => {
                let length = run.moves.len();
                if shortest.as_ref().is_none_or(|(least, _)| length < *least) {
                    shortest = Some((length, a.clone()));
                }
            }
            Verdict::Proved(Evidence::Certificate(Certificate::Search { states: s, scans: n })) => {
                states += s;
                scans += n;
            }
            _ => open = true,
        }
    }
    // A part that is open might have a shorter run, but a run is a run.
    match shortest {
        Some((_, verdict)) if !open => Some(verdict),
        None if !open => Some(Verdict::Proved(Evidence::Certificate(Certificate::Search { states, scans }))),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
