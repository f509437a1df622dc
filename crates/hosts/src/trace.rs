//! Runs, found back from their last state through the levels on disk, and the answers.
//!
//! A level on disk knows of each state the rank of the state before and the number of the scan between. All
//! workers go back through the levels together; the one that has the state tells the others. Then each of
//! them makes the scans again from the start.

use g7_engine::Fault;
use g7_verify::{Here, Model, Outcome, Question, Reason, Run, Tried, Verdict, unclear};

use crate::Error;
use crate::exchange::Phases;
use crate::known::{Kind, Known};
use crate::levels::Levels;
use crate::shelf::STEP;
use crate::task::{Task, expander};
use crate::words::{Words, put_list, put_text};

/// A question with its answer, before the scans are made again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Shown {
    question: u64,
    kind: Kind,
    /// The numbers of the scans, from the start.
    steps: Vec<u64>,
}

/// The end of a search.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Ended {
    pub(crate) outcome: Outcome,
    shown: Vec<Shown>,
}

/// Finds the runs to all states that answer something.
pub(crate) fn trace(
    task: &Task<'_, '_>,
    outcome: Outcome,
    known: &Known,
    phases: &mut Phases<'_>,
    levels: &Levels,
) -> Result<Ended, Error> {
    let mut shown = Vec::new();
    for (question, hit) in &known.hits {
        let last = Some(hit.step).filter(|_| hit.kind != Kind::Trap);
        let steps: Vec<u64> = last.into_iter().collect();
        shown.push(Shown { question: *question, kind: hit.kind, steps });
    }
    let mut ranks: Vec<u64> = known.hits.values().map(|h| h.at.rank).collect();
    let starts: Vec<u64> = known.hits.values().map(|h| h.at.level).collect();
    for level in (1..=starts.iter().copied().max().unwrap_or(0)).rev() {
        // 1 more than the key, 0 where another worker has the state.
        let key = |(rank, start): (&u64, &u64)| match *start >= level {
            true => levels.key(task.number, level as usize, *rank).map_or(0, |k| k.saturating_add(1)),
            false => 0,
        };
        let own: Vec<u64> = ranks.iter().zip(&starts).map(key).collect();
        let all = phases.share(&own)?;
        for (k, ((rank, start), shown)) in ranks.iter_mut().zip(&starts).zip(&mut shown).enumerate() {
            if *start < level {
                continue;
            }
            let key = all.iter().filter_map(|w| w.get(k)).find_map(|w| w.checked_sub(1));
            let key = key.ok_or_else(|| Error::Disk("a level on disk lacks a state of a run".to_owned()))?;
            shown.steps.push(key & ((1 << STEP) - 1));
            *rank = key >> STEP;
        }
    }
    shown.iter_mut().for_each(|s| s.steps.reverse());
    Ok(Ended { outcome, shown })
}

impl Ended {
    /// The answers to the questions of the search.
    pub(crate) fn answers(
        &self,
        model: &Model<'_>,
        questions: &[(usize, &Question)],
        tried: Option<Tried>,
    ) -> Vec<(usize, Verdict)> {
        let one = |(i, q): &(usize, &Question)| {
            let verdict = match self.shown.iter().find(|s| s.question == *i as u64) {
                None => self.outcome.left_over(&q.claim),
                Some(Shown { kind, steps, .. }) => {
                    let (mut run, fault) = follow(model, steps, tried);
                    if *kind == Kind::Unclear {
                        let fault = unclear(model, &q.claim, &run);
                        let reason = fault.map_or(Reason::NotRepeated, Reason::Condition);
                        return (*i, Verdict::Open(self.outcome.so_far(reason)));
                    }
                    run.fault = fault.filter(|_| matches!(kind, Kind::Run { fault: true }));
                    self.outcome.shown(model, &q.claim, run)
                }
            };
            (*i, verdict)
        };
        questions.iter().map(one).collect()
    }

    pub(crate) fn put(&self, into: &mut Vec<u64>) {
        let o = &self.outcome;
        into.extend([o.states, o.scans, o.depth].map(|n| n as u64));
        into.extend([o.cut, o.cut_passes].map(u64::from));
        put_reason(into, o.hole.as_ref());
        into.push(self.shown.len() as u64);
        for shown in &self.shown {
            into.push(shown.question);
            match &shown.kind {
                Kind::Run { fault } => into.push(u64::from(*fault)),
                Kind::Trap => into.push(2),
                Kind::Unclear => into.push(3),
            }
            put_list(into, &shown.steps);
        }
    }

    pub(crate) fn get(words: &mut Words<'_>) -> Option<Ended> {
        let outcome = Outcome {
            states: words.count()?,
            scans: words.count()?,
            depth: words.count()?,
            cut: words.next()? != 0,
            cut_passes: words.next()? != 0,
            hole: get_reason(words)?,
        };
        let mut shown = Vec::new();
        for _ in 0..words.next()? {
            let question = words.next()?;
            let kind = match words.next()? {
                2 => Kind::Trap,
                3 => Kind::Unclear,
                fault => Kind::Run { fault: fault != 0 },
            };
            shown.push(Shown { question, kind, steps: words.list()?.to_vec() });
        }
        Some(Ended { outcome, shown })
    }
}

/// Makes the scans with these numbers, one behind the other; gives the fault of the last one too.
fn follow(model: &Model<'_>, steps: &[u64], tried: Option<Tried>) -> (Run, Option<Fault>) {
    let mut expander = expander(model, &[], tried);
    let (mut image, mut inputs) = expander.start();
    let (mut run, mut fault) = (Run::default(), None);
    for (k, wanted) in steps.iter().enumerate() {
        let (mut step, mut made) = (0, None);
        expander.expand(Here { image: &image, inputs: &inputs, first: k == 0 }, |s| {
            if step == *wanted {
                made = Some((s.m.clone(), s.next.map(<[u64]>::to_vec), s.fault));
            }
            step += 1;
            made.is_none()
        });
        let Some((m, next, end)) = made else { break };
        inputs.clone_from(&m.inputs);
        run.moves.push(m);
        fault = end;
        let Some(next) = next else { break };
        image = next;
    }
    (run, fault)
}

/// Writes the reason why a shared search has not seen all runs, if there is one.
fn put_reason(into: &mut Vec<u64>, reason: Option<&Reason>) {
    let (tag, number) = match reason {
        None => (0, 0),
        Some(Reason::States(n)) => (2, *n),
        Some(Reason::Memory(n)) => (3, *n),
        Some(Reason::Combinations(n)) => (4, *n),
        Some(Reason::NoInput(n)) => (5, *n),
        Some(Reason::Chance(n)) => (6, *n),
        Some(Reason::Values(name)) => {
            into.push(7);
            return put_text(into, name);
        }
        // A shared search ends for no other reason.
        Some(_) => (1, 0),
    };
    into.extend([tag, number as u64]);
}

/// Reads what [`put_reason`] has written.
fn get_reason(words: &mut Words<'_>) -> Option<Option<Reason>> {
    let tag = words.next()?;
    if tag == 7 {
        return Some(Some(Reason::Values(words.text()?)));
    }
    let number = words.count()?;
    Some(Some(match tag {
        0 => return Some(None),
        1 => Reason::Stopped,
        2 => Reason::States(number),
        3 => Reason::Memory(number),
        4 => Reason::Combinations(number),
        5 => Reason::NoInput(number),
        6 => Reason::Chance(number),
        _ => return None,
    }))
}
