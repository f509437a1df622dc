//! The questions of a chart, answered by several workers: one search after the other, and again from the
//! last level on disk where a worker was lost.

use std::path::Path;

use g7_verify::{Budget, Expander, Model, Question, Tried, Verdict};

use crate::Error;
use crate::exchange::{Exchange, Phases};
use crate::levels::Levels;
use crate::meet::{Meeting, Work};
use crate::search::search;
use crate::task::Task;
use crate::trace::Ended;
use crate::wire::Wire;
use crate::words::Words;

/// Bytes of packets that may come before their phase, however little memory there is for states: what one phase
/// sends.
const LEAST: usize = 64 << 20;

/// The place of a process in a run.
pub struct Place<'p> {
    /// Its number, from 0.
    pub me: usize,
    /// The addresses of all processes, `host:port`.
    pub addresses: &'p [String],
    /// Hashes of the program and of the search: all processes must have the same ones.
    pub work: Work,
    /// The folder of the levels.
    pub folder: &'p Path,
    /// The inputs that are tried, if not those of [`Expander::new`].
    pub tried: Option<Tried>,
    /// Is told what happens to other processes, a line each.
    pub tell: &'p dyn Fn(&str),
}

/// Answers questions with all processes of a run. Each of them gives the answers to the searches in which
/// it took part; process 0 has all.
///
/// # Errors
///
/// The own address is in use, a process does other work or does not come in time, or the disk refuses. A
/// process that is lost is no error: the others wait until it is there again.
pub fn answer(
    model: &Model<'_>,
    questions: &[Question],
    budget: &Budget<'_>,
    place: &Place<'_>,
) -> Result<Vec<(usize, Verdict)>, Error> {
    let mut levels =
        Levels::open(place.folder, place.work.task, place.me, place.addresses.len(), budget.bytes)?;
    let meeting = Meeting::open(place.me, place.addresses, place.work)?;
    loop {
        let mut wire = Wire::new(place.me, meeting.meet(budget.stop)?)
            .map_err(|e| Error::Usage(format!("the system refuses: {}", crate::meet::plain(&e))))?;
        match searches(model, questions, budget, place.tried, &mut wire, &mut levels) {
            Err(Error::Lost) => {
                wire.cut();
                (place.tell)("a process was lost; when it is there again, all go on from the last level");
            }
            other => return other,
        }
    }
}

/// The same over a transport that is there already, without coming back from a loss.
///
/// # Errors
///
/// A worker is lost, or the disk refuses.
pub fn answer_over(
    model: &Model<'_>,
    questions: &[Question],
    budget: &Budget<'_>,
    tried: Option<Tried>,
    wire: &mut dyn Exchange,
    folder: &Path,
) -> Result<Vec<(usize, Verdict)>, Error> {
    let mut levels = Levels::open(folder, 0, wire.me(), wire.peers(), budget.bytes)?;
    searches(model, questions, budget, tried, wire, &mut levels)
}

/// All searches, the ones that have ended before not again.
fn searches<'a>(
    model: &'a Model<'a>,
    questions: &'a [Question],
    budget: &Budget<'a>,
    tried: Option<Tried>,
    wire: &mut dyn Exchange,
    levels: &mut Levels,
) -> Result<Vec<(usize, Verdict)>, Error> {
    let (alone, together): (Vec<_>, Vec<_>) =
        questions.iter().enumerate().partition(|(_, q)| Expander::remembers(q));
    let groups = std::iter::once(together).chain(alone.into_iter().map(|q| vec![q]));
    let groups: Vec<Vec<(usize, &Question)>> = groups.filter(|g| !g.is_empty()).collect();
    let mut answers = Vec::new();
    let ended =
        |levels: &Levels, n: usize| levels.read_outcome(n).and_then(|words| Ended::get(&mut Words(&words)));
    // Process 0 prints the answers: those that it has are not searched again.
    let have = (0..groups.len()).take_while(|n| ended(levels, *n).is_some()).count() as u64;
    // One for all searches: it keeps the packets of workers that are a phase ahead.
    let mut phases = Phases::new(wire, budget.bytes.max(LEAST));
    let all = phases.share(&[have])?;
    let done = all.first().and_then(|w| w.first().copied()).unwrap_or(0) as usize;
    for (number, group) in groups.iter().enumerate() {
        let end = match ended(levels, number) {
            Some(end) if number < done => end,
            // The answers of a search that this process took no part in are with process 0.
            None if number < done => continue,
            _ => {
                let task = Task { model, questions: group, budget, tried, number };
                let end = search(&task, &mut phases, levels)?;
                let mut words = Vec::new();
                end.put(&mut words);
                levels.keep_outcome(number, &words)?;
                end
            }
        };
        // Levels go when all have the outcome.
        if number >= done {
            phases.share(&[])?;
        }
        levels.forget(number, 0)?;
        answers.extend(end.answers(model, group, tried));
    }
    Ok(answers)
}
