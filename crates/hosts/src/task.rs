//! The task of one search, the same for all workers.

use g7_verify::{Budget, Expander, Model, Question, Tried};

/// A search: questions that are asked together, by their numbers.
pub(crate) struct Task<'a, 't> {
    pub(crate) model: &'a Model<'a>,
    pub(crate) questions: &'t [(usize, &'a Question)],
    pub(crate) budget: &'t Budget<'a>,
    pub(crate) tried: Option<Tried>,
    /// The number of the search among those of the run.
    pub(crate) number: usize,
}

impl<'a> Task<'a, '_> {
    /// An expander that looks for these questions.
    pub(crate) fn expander(&self, questions: &[(usize, &'a Question)]) -> Expander<'a> {
        expander(self.model, questions, self.tried)
    }
}

/// An expander with a choice of the inputs that are tried.
pub(crate) fn expander<'a>(
    model: &'a Model<'a>,
    questions: &[(usize, &'a Question)],
    tried: Option<Tried>,
) -> Expander<'a> {
    let mut expander = Expander::new(model, questions);
    tried.into_iter().for_each(|tried| expander.try_inputs(tried));
    expander
}
