//! How long and how much a record keeps.

use g7_model::Nanos;

/// How much is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Changes that are older, by the time of the record, are deleted.
    pub age: Nanos,
    /// Beyond so many bytes the oldest is deleted.
    pub bytes: u64,
}
