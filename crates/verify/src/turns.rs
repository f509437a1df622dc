//! All layers in turns: what one cannot answer with little work the other may.
//!
//! An explicit search answers small charts at once, with timers and all; a solver answers
//! wide ones. Each turn allows several times the work of the one before, counted and not timed,
//! so that the answers depend on the chart alone as long as the caller does not stop.

use crate::layer::{Budget, Layer};
use crate::model::Model;
use crate::question::Question;
use crate::sat::Satisfiability;
use crate::search::Explicit;
use crate::verdict::Verdict;

/// Scans of the first turn.
const SCANS: usize = 200_000;
/// Turns of the solver in the first turn.
const SOLVER: u32 = 4;

/// All layers in turns.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turns;

impl Layer for Turns {
    fn name(&self) -> &'static str {
        "all"
    }

    fn answer(
        &self,
        model: &Model<'_>,
        questions: &[Question],
        answers: &mut [Option<Verdict>],
        budget: &Budget<'_>,
    ) {
        let mut scans = SCANS;
        let mut solver = Satisfiability { turns: SOLVER };
        loop {
            let before = answers.to_vec();
            let small = Budget { scans: scans.min(budget.scans), ..*budget };
            Explicit.answer(model, questions, answers, &small);
            solver.answer(model, questions, answers, budget);
            let done = answers.iter().all(|a| !matches!(a, None | Some(Verdict::Open(_))));
            // More work changes nothing where both have come to their end.
            if done || (budget.stop)() || before == answers {
                return;
            }
            scans = scans.saturating_mul(8);
            solver.turns += 3;
        }
    }
}
