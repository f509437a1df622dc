//! Errors in the use of a bench, for charts that are correct themselves.

use g7_model::{Said, say};

/// An error that the user can correct by another choice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Error {
    /// The plant that was asked for does not exist.
    NoPlant {
        /// The file.
        file: String,
        /// The name that was asked for.
        name: String,
        /// The plants that exist.
        there: Vec<String>,
    },
    /// The file has several plants, and no name was given.
    SeveralPlants {
        /// The file.
        file: String,
        /// The plants that exist.
        there: Vec<String>,
    },
}

impl Error {
    /// The sentence, for each language.
    pub fn said(&self) -> Said {
        let (Error::NoPlant { file, .. } | Error::SeveralPlants { file, .. }) = self;
        let file = Said::foreign(file.as_str());
        match self {
            Error::NoPlant { name, there, .. } if there.is_empty() => {
                say!("{file} has no plant `{name}`, nor any other")
            }
            Error::NoPlant { name, there, .. } => {
                say!("{file} has no plant `{name}`; it has {}", Said::foreign(there.join(", ")))
            }
            Error::SeveralPlants { there, .. } => {
                say!("{file} has several plants: choose one of {}, or none", Said::foreign(there.join(", ")))
            }
        }
    }
}
impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.said())
    }
}

impl std::error::Error for Error {}
