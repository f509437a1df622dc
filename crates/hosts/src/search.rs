//! One search: from the last level that all workers have on disk, level after level, to its outcome.

use g7_verify::{Gap, Outcome, Reason, asks_for_traps};

use crate::Error;
use crate::exchange::{Lost, Phases};
use crate::known::{Hit, Kind, Known};
use crate::levels::{Level, Levels};
use crate::task::Task;
use crate::trace::{Ended, trace};
use crate::traps;
use crate::words::{Words, put_list};
use crate::worker::{Halt, Worker};

/// A search between two levels.
struct Between<'a> {
    worker: Worker<'a>,
    /// The findings of all levels.
    known: Known,
    /// Number of states, of all workers, in the level in hand.
    found: u64,
}

/// Searches, with all other workers, and gives what each of them then knows.
///
/// # Errors
///
/// A worker is lost, or the disk refuses.
pub(crate) fn search(
    task: &Task<'_, '_>,
    phases: &mut Phases<'_>,
    levels: &mut Levels,
) -> Result<Ended, Error> {
    let trap = task.questions.iter().find(|(_, q)| asks_for_traps(&q.claim)).map(|(i, _)| *i as u64);
    let Between { mut worker, mut known, mut found } = resume(task, trap.is_some(), phases, levels)?;
    let mut halt = None;
    let mut depth = worker.level;
    while found > 0 && halt.is_none() {
        let is_open = |i: &usize| !known.hits.contains_key(&(*i as u64));
        let open: Vec<_> = task.questions.iter().filter(|(i, _)| is_open(i)).copied().collect();
        if open.is_empty() {
            break;
        }
        worker.expander.look_for(&open);
        let before = known.states;
        halt = worker.expand(phases, task.budget, &mut known)?;
        found = known.states - before;
        if halt.is_none() {
            depth += 1;
            let level = worker.arrange(phases)?;
            keep(task, &worker, levels, level, &known)?;
        }
    }
    let complete = halt.is_none() && known.hole.is_none() && known.stuck.is_none();
    if let Some(question) = trap.filter(|q| complete && !known.hits.contains_key(q))
        && let Some(at) = traps::first(task, question, &mut worker, phases)?
    {
        known.hit(question, Hit { at, step: 0, kind: Kind::Trap });
    }
    let outcome = Outcome {
        states: known.states as usize,
        scans: known.scans as usize,
        depth: depth as usize,
        hole: why(task, halt, &known),
        cut: known.cut,
        cut_passes: known.cut_passes,
    };
    trace(task, outcome, &known, phases, levels)
}

/// Why not all runs were seen.
fn why(task: &Task<'_, '_>, halt: Option<Halt>, known: &Known) -> Option<Reason> {
    match halt {
        Some(Halt::Stopped) => return Some(Reason::Stopped),
        Some(Halt::States) => return Some(Reason::States(task.budget.states)),
        Some(Halt::Memory) => return Some(Reason::Memory(task.budget.bytes >> 20)),
        None => {}
    }
    if let Some(at) = known.stuck {
        return Some(Reason::NoInput(at.level as usize));
    }
    let gap = match known.hole?.gap {
        (0, count) => Gap::Combinations(count as usize),
        (1, place) => Gap::Values(place as usize),
        _ => Gap::Chance,
    };
    Some(gap.reason(task.model))
}

/// Writes a level, with all that is known by then.
fn keep(
    task: &Task<'_, '_>,
    worker: &Worker<'_>,
    levels: &mut Levels,
    mut level: Level,
    known: &Known,
) -> Result<(), Error> {
    put_list(&mut level.rest, worker.shelf.pack.mask());
    known.put(&mut level.rest);
    put_list(&mut level.rest, &worker.blocked_ranks());
    levels.keep(task.number, worker.level as usize, &level)
}

/// Takes back the levels that all workers have on disk; without any, finds the first one.
fn resume<'a>(
    task: &Task<'a, '_>,
    note_blocked: bool,
    phases: &mut Phases<'_>,
    levels: &mut Levels,
) -> Result<Between<'a>, Error> {
    loop {
        let have = levels.count(task.number) as u64;
        let all = phases.share(&[have])?;
        let common = all.iter().filter_map(|w| w.first().copied()).min().unwrap_or(0);
        levels.forget(task.number, common as usize)?;
        let mut worker = Worker::new(task, note_blocked);
        if common == 0 {
            let level = worker.begin(phases)?;
            let known = Known { states: 1, ..Known::default() };
            keep(task, &worker, levels, level, &known)?;
            return Ok(Between { worker, known, found: 1 });
        }
        levels.fit(task.number, common as usize)?;
        let taken = take_back(task, &mut worker, levels, common as usize);
        let whole = taken.as_ref().map_or(0, |(_, count)| count + 1);
        let all = phases.share(&[whole])?;
        let count = |w: &Vec<u64>| w.first().and_then(|w| w.checked_sub(1));
        let counts = all.iter().try_fold(0u64, |sum, w| sum.checked_add(count(w)?));
        match (taken, counts) {
            (Ok((known, _)), Some(found)) => return Ok(Between { worker, known, found }),
            (Err(bad), _) => levels.forget(task.number, bad)?,
            _ => {}
        }
    }
}

/// Takes back so many levels, one at least: what was known then, and the number of states of the last.
///
/// # Errors
///
/// The number of a level that is not whole, or is larger than the memory.
fn take_back(
    task: &Task<'_, '_>,
    worker: &mut Worker<'_>,
    levels: &Levels,
    count: usize,
) -> Result<(Known, u64), usize> {
    let last = count - 1;
    let level = levels.read(task.number, last).ok_or(last)?;
    let mask = Words(&level.rest).list().ok_or(last)?.to_vec();
    worker.shelf.settle(&[&mask]).map_err(|_| last)?;
    let mut end = (Known::default(), 0);
    for number in 0..count {
        let level = levels.read(task.number, number).ok_or(number)?;
        let mut rest = Words(&level.rest);
        let parts = (|| Some((rest.list()?, Known::get(&mut rest)?, rest.list()?)))();
        let (mask, known, blocked) = parts.ok_or(number)?;
        worker.put_back(&level, mask, blocked).ok_or(number)?;
        end = (known, (level.records.len() / level.width) as u64);
    }
    Ok(end)
}

impl From<Lost> for Error {
    fn from(lost: Lost) -> Error {
        match lost {
            Lost::Gone => Error::Lost,
            Lost::Ahead(bytes, from) => Error::Usage(format!(
                "process {from} is ahead of this one by {} MiB, more than the memory that this one may use; give \
                 all of them more with --memory",
                bytes >> 20
            )),
        }
    }
}
