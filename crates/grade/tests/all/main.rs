//! The tests of exercises.
#![allow(missing_docs, reason = "a test")]
#![allow(clippy::disallowed_methods, reason = "tests read the exercises of the repository")]

mod handed;
