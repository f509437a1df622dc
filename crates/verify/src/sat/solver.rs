//! The solver of `g7-sat`, which the checks of `compile` ask as well.

pub(crate) use g7_sat::{Answer, Batsat, Literal, Solver};
