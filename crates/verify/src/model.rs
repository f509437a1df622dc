//! The model that is asked: one definition for all layers.
//!
//! A run is a sequence of scans, one each period, the first at time 0. Before each scan
//! every input takes any of its values so that the assumptions hold; then `engine::scan`
//! makes the step. Assumptions are judged behind the inputs and before the evolution.

use g7_compile::Compiled;

use crate::question::Query;
use crate::values::{Values, values};

/// A chart with its environment.
pub struct Model<'c> {
    /// The chart, compiled with the conditions of all questions and assumptions.
    pub compiled: &'c Compiled,
    /// The conditions that the environment keeps.
    pub assume: Vec<Query>,
    /// Time between two scans, ns.
    pub period: i64,
    /// For each word of [`g7_engine::Tables::inputs`], the values that it may take.
    pub inputs: Vec<Values>,
}

impl<'c> Model<'c> {
    /// The chart with inputs that take all of their values, scanned at its own period.
    pub fn new(compiled: &'c Compiled, assume: Vec<Query>) -> Model<'c> {
        let period = compiled.symbols.cycle.count().max(1);
        Model { assume, period, inputs: values(compiled), compiled }
    }
}
