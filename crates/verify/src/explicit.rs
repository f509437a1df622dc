//! The explicit search as a layer: a small search of the whole chart, then of its parts, then again of the
//! whole as far as the budget allows.

use crate::layer::{Budget, Layer, undecided};
use crate::model::Model;
use crate::parts::{divided, jobs, run};
use crate::question::Question;
use crate::verdict::Verdict;

/// Scans of a search that comes before others.
const SMALL: usize = 2_000;

/// The explicit search as a layer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Explicit;

impl Layer for Explicit {
    fn name(&self) -> &'static str {
        "search"
    }

    fn answer(
        &self,
        model: &Model<'_>,
        questions: &[Question],
        answers: &mut [Option<Verdict>],
        budget: &Budget<'_>,
    ) {
        answer(model, questions, answers, budget, threads());
    }
}

/// A short search of the whole chart: enough for most charts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Brief;

impl Layer for Brief {
    fn name(&self) -> &'static str {
        "short search"
    }

    fn answer(
        &self,
        model: &Model<'_>,
        questions: &[Question],
        answers: &mut [Option<Verdict>],
        budget: &Budget<'_>,
    ) {
        let small = Budget { scans: SMALL.min(budget.scans), ..*budget };
        whole(model, questions, answers, &small, threads());
    }
}

/// Searches that may run at a time.
pub(crate) fn threads() -> usize {
    if cfg!(target_family = "wasm") { 1 } else { std::thread::available_parallelism().map_or(1, usize::from) }
}

/// Answers questions with so many searches at a time. A small search comes first: most charts need no
/// more. Then the chart is divided, if it consists of parts. What is left is searched as far as the budget
/// allows.
pub(crate) fn answer(
    model: &Model<'_>,
    questions: &[Question],
    answers: &mut [Option<Verdict>],
    budget: &Budget<'_>,
    threads: usize,
) {
    let small = Budget { scans: SMALL.min(budget.scans), ..*budget };
    if !whole(model, questions, answers, &small, threads) {
        return;
    }
    let found = divided(model, &undecided(questions, answers), budget, threads);
    give(answers, found);
    if small.scans < budget.scans {
        whole(model, questions, answers, budget, threads);
    }
}

/// Searches the whole chart for what is open; tells whether more scans would have told more.
fn whole(
    model: &Model<'_>,
    questions: &[Question],
    answers: &mut [Option<Verdict>],
    budget: &Budget<'_>,
    threads: usize,
) -> bool {
    let found = run(model, &jobs(&undecided(questions, answers), None), budget, threads);
    let short = found.iter().any(|f| f.short);
    found.into_iter().for_each(|f| give(answers, f.answers));
    short
}

fn give(answers: &mut [Option<Verdict>], found: Vec<(usize, Verdict)>) {
    for (i, verdict) in found {
        if let Some(answer) = answers.get_mut(i) {
            *answer = Some(verdict);
        }
    }
}
