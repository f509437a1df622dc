//! Why no bench could be made although the charts are right.

/// What the user of a bench can mend.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// The plant asked for is not there.
    #[error("{file} has no plant `{name}`{}", rest(.there))]
    NoPlant {
        /// The file.
        file: String,
        /// What was asked for.
        name: String,
        /// The plants that it has.
        there: Vec<String>,
    },
    /// There are several plants, and none was asked for.
    #[error("{file} has several plants: choose one of {}, or none", .there.join(", "))]
    SeveralPlants {
        /// The file.
        file: String,
        /// The plants that it has.
        there: Vec<String>,
    },
}

fn rest(there: &[String]) -> String {
    if there.is_empty() { ", nor any other".to_owned() } else { format!("; it has {}", there.join(", ")) }
}
