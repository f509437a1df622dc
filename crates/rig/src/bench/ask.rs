//! How a bench is asked for: the profile, the plant, and expressions that a run is to evaluate.

use g7_engine::Code;
use g7_model::{Expr, Nanos, ProfileName, Type};

/// How to build a bench.
#[derive(Clone, Copy, Default)]
pub struct Options<'a> {
    /// The profile that replaces the file's own.
    pub profile: Option<ProfileName>,
    /// The scan period that replaces the file's own.
    pub scan: Option<Nanos>,
    /// The name of the plant, or `none` for no plant. Without it the file's only plant is used.
    pub plant: Option<&'a str>,
    /// Expressions to be compiled for evaluation during the run.
    pub asks: &'a [Ask],
}

/// An expression to be compiled for evaluation.
#[derive(Clone, Debug)]
pub struct Ask {
    /// The expression.
    pub expr: Expr,
    /// True if its names are those of the plant.
    pub of_plant: bool,
}

/// A compiled [`Ask`].
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// The code, for `engine::eval`.
    pub code: Code,
    /// The type of the expression.
    pub ty: Type,
    /// True if the code runs on the state of the plant.
    pub of_plant: bool,
}
