//! The reasons why a user is not made, changed or let in.

use g7_model::{Said, say};

use crate::file::StoreError;

/// Why a change of the users is refused.
#[derive(Debug, thiserror::Error)]
pub enum UserError {
    /// A fault that a person can correct.
    #[error("{0}")]
    Refused(Said),
    /// The file cannot be read or written.
    #[error("the file of the users: {0}")]
    Store(#[from] StoreError),
}

impl UserError {
    /// The sentence, for each language; what SQLite says stays as it is.
    pub fn said(&self) -> Said {
        match self {
            UserError::Refused(why) => why.clone(),
            UserError::Store(why) => say!("the file of the users: {}", Said::foreign(why.to_string())),
        }
    }
}
