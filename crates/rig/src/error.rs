//! Errors in the use of a bench, for charts that are correct themselves.

/// An error that the user can correct by another choice.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// The plant that was asked for does not exist.
    #[error("{file} has no plant `{name}`{}", rest(.there))]
    NoPlant {
        /// The file.
        file: String,
        /// The name that was asked for.
        name: String,
        /// The plants that exist.
        there: Vec<String>,
    },
    /// The file has several plants, and no name was given.
    #[error("{file} has several plants: choose one of {}, or none", .there.join(", "))]
    SeveralPlants {
        /// The file.
        file: String,
        /// The plants that exist.
        there: Vec<String>,
    },
}

fn rest(there: &[String]) -> String {
    if there.is_empty() { ", nor any other".to_owned() } else { format!("; it has {}", there.join(", ")) }
}
