//! A file of `g7 check` with what was found in it.

use g7_model::{Problem, Said};
use g7_rig::testing::Unproved;

use crate::sources::Source;

pub(super) struct Checked {
    pub(super) source: Source,
    pub(super) problems: Vec<Problem>,
    pub(super) unproved: Vec<Unproved>,
    /// Why it is no chart; then this is its only problem.
    pub(super) no_form: Option<Said>,
}
