//! Parts of a chart that bits cannot express, with their places.

use g7_model::Span;

use crate::reason::Part;
use crate::sat::Signal;

/// A part that bits cannot express.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Limit {
    pub(crate) part: Part,
    /// The step, transition or action that it stands in; empty if it is none of these.
    pub(crate) at: Span,
}

/// A limit, with the inputs that stand for what is not known.
#[derive(Clone, Debug)]
pub(crate) struct Unknown {
    pub(crate) limit: Limit,
    pub(crate) bits: Vec<Signal>,
}
