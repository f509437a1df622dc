//! All layers: the one place that says which there are.

use crate::layer::{Budget, Layer};
use crate::model::Model;
use crate::question::Question;
use crate::sat::Satisfiability;
use crate::search::Explicit;
use crate::turns::Turns;
use crate::verdict::Verdict;

/// Turns of the solver that take a moment.
const FEW: u32 = 5;

/// Answers questions with all layers, until the budget is used up. `answers` has an entry for each
/// question; those that are decided already stay.
pub fn answer(
    model: &Model<'_>,
    questions: &[Question],
    answers: &mut [Option<Verdict>],
    budget: &Budget<'_>,
) {
    Turns.answer(model, questions, answers, budget);
}

/// The same for a caller whose budget cannot stop a solver: a search within the budget, and then, with
/// `solve`, a short attempt of the solver at what is open.
pub fn attempt(
    model: &Model<'_>,
    questions: &[Question],
    answers: &mut [Option<Verdict>],
    budget: &Budget<'_>,
    solve: bool,
) {
    Explicit.answer(model, questions, answers, budget);
    if solve {
        Satisfiability { turns: FEW }.answer(model, questions, answers, budget);
    }
}
