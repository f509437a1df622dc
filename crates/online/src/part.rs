//! A part of a panel.

use crate::setup::Handle;
use crate::value::Raw;

/// A part of a panel, as a channel wires it.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The kind of it.
    pub handle: Handle,
    /// The least number that can be entered.
    pub min: Option<f64>,
    /// The greatest number that can be entered.
    pub max: Option<f64>,
    /// The number until a person enters one.
    pub initial: Option<f64>,
}

/// A number as a value: a whole one is exact.
pub(crate) fn number(x: f64) -> Raw {
    if x.fract() == 0.0 && x.abs() < 1e18 { Raw::Whole(x as i128) } else { Raw::Real(x) }
}
