//! The reasons why a user is not made, changed or let in.

use crate::file::StoreError;

/// Why a change of the users is refused.
#[derive(Debug, thiserror::Error)]
pub enum UserError {
    /// A fault that a person can correct.
    #[error("{0}")]
    Refused(String),
    /// The file cannot be read or written.
    #[error("the file of the users: {0}")]
    Store(#[from] StoreError),
}
