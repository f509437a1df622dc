//! All layers: the one place that says which there are.
//!
//! The explicit search answers small charts at once; the search by zones answers charts with times, however
//! long they are; the solver answers charts with many sequences side by side, and what it leaves open is searched
//! once more over its own system of bits. Each search is asked first about the part of a chart that a question
//! depends on (`slices.rs`, `faults.rs`). They take turns, and each turn
//! allows several times the work of the turn before. Work is counted in scans and ticks, not in seconds: unless
//! the caller stops it, the answers depend on the chart alone.

use crate::explicit::{Brief, Explicit};
use crate::faults::Faults;
use crate::layer::{Budget, Layer};
use crate::model::Model;
use crate::question::Question;
use crate::sat::Satisfiability;
use crate::slices::Sliced;
use crate::verdict::{Verdict, is_open};
use crate::zones::Zones;

/// Scans of the search in the first turn.
const SCANS: usize = 400_000;
/// Turns of the solver in the first turn: they take a moment.
const SOLVER: u32 = 5;

/// The searches in their order: small charts need a moment, times are passed at once by zones.
const SEARCHES: [&dyn Layer; 3] = [&Brief, &Zones, &Explicit];

/// Answers questions with all layers, until the budget is used up. `answers` has an entry for each
/// question; those that are decided already stay.
pub fn answer(
    model: &Model<'_>,
    questions: &[Question],
    answers: &mut [Option<Verdict>],
    budget: &Budget<'_>,
) {
    turns(
        model,
        questions,
        answers,
        budget,
        &[&Brief, &Sliced(&SEARCHES), &Faults(&SEARCHES), &Zones, &Explicit],
    );
}

/// Asks all layers but the explicit search, until the budget is used up: for a caller that has searched already.
pub fn solve(
    model: &Model<'_>,
    questions: &[Question],
    answers: &mut [Option<Verdict>],
    budget: &Budget<'_>,
) {
    turns(model, questions, answers, budget, &[&Sliced(&SEARCHES), &Faults(&SEARCHES), &Zones]);
}

/// Lets these searches and the solver take turns.
fn turns(
    model: &Model<'_>,
    questions: &[Question],
    answers: &mut [Option<Verdict>],
    budget: &Budget<'_>,
    searches: &[&dyn Layer],
) {
    let mut scans = SCANS;
    let mut solver = Satisfiability { turns: SOLVER };
    loop {
        let before = answers.to_vec();
        let small = Budget { scans: scans.min(budget.scans), ..*budget };
        searches.iter().for_each(|layer| layer.answer(model, questions, answers, &small));
        solver.answer(model, questions, answers, budget);
        // More work changes nothing where all have come to their end.
        if !answers.iter().any(is_open) || (budget.stop)() || before == answers {
            return;
        }
        scans = scans.saturating_mul(16);
        solver.turns += 4;
    }
}

/// As [`answer`], for a caller whose budget cannot stop a solver: a search within the budget, and then, with
/// `solve`, a short attempt of the solver at what is open.
pub fn attempt(
    model: &Model<'_>,
    questions: &[Question],
    answers: &mut [Option<Verdict>],
    budget: &Budget<'_>,
    solve: bool,
) {
    if solve {
        let searches: [&dyn Layer; 3] = [&Brief, &Sliced(&SEARCHES), &Faults(&SEARCHES)];
        searches.iter().for_each(|layer| layer.answer(model, questions, answers, budget));
    }
    Explicit.answer(model, questions, answers, budget);
    Zones.answer(model, questions, answers, budget);
    if solve {
        Satisfiability { turns: SOLVER }.answer(model, questions, answers, budget);
    }
}
