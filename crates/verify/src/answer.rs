//! All layers in their order: the one place that says which there are.

use crate::layer::{Budget, Layer};
use crate::model::Model;
use crate::question::Question;
use crate::search::Explicit;
use crate::verdict::Verdict;

/// Answers questions with all layers, one after the other; each is given what those before it left
/// open. `answers` has an entry for each question; those that are decided already stay.
pub fn answer(
    model: &Model<'_>,
    questions: &[Question],
    answers: &mut [Option<Verdict>],
    budget: &Budget<'_>,
) {
    let layers: [&dyn Layer; 1] = [&Explicit];
    let is_open = |a: &Option<Verdict>| matches!(a, None | Some(Verdict::Open(_)));
    for layer in layers {
        if answers.iter().any(is_open) {
            layer.answer(model, questions, answers, budget);
        }
    }
}
