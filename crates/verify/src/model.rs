//! The model that is asked: one definition for all layers.
//!
//! A run is a sequence of scans, one each period, the first at time 0. Before each scan
//! every input takes any of its values so that the assumptions hold; then `engine::scan`
//! makes the step. Assumptions are judged behind the inputs and before the evolution.
//!
//! In a closed loop the plant makes its scan first, with the outputs of the scan before, and
//! gives the inputs that it drives; only the others take any values.

use g7_compile::Compiled;
use g7_engine::Code;
use g7_rig::PlantSide;

use crate::question::Query;
use crate::slice::Slice;
use crate::values::{Values, values};

/// A part of a condition: code of the charts, or of the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// The code, a condition.
    pub code: Code,
    /// True if it is evaluated on the state of the plant.
    pub of_plant: bool,
}

/// A chart with its environment.
pub struct Model<'c> {
    /// The chart, compiled with the conditions of all questions and assumptions.
    pub compiled: &'c Compiled,
    /// For each [`Query`], the parts that all hold where it holds.
    pub conditions: Vec<Vec<Part>>,
    /// The conditions that the environment keeps.
    pub assume: Vec<Query>,
    /// Time between two scans, ns.
    pub period: i64,
    /// For each word of [`g7_engine::Tables::inputs`], the values that it may take.
    pub inputs: Vec<Values>,
    /// The plant of a closed loop.
    pub plant: Option<&'c PlantSide>,
    /// The part of a state that a search leaves out.
    pub(crate) slice: Slice,
}

impl<'c> Model<'c> {
    /// The chart with inputs that take all of their values, scanned at its own period.
    pub fn new(compiled: &'c Compiled, assume: Vec<Query>) -> Model<'c> {
        let conditions = compiled.queries.iter().map(|code| vec![Part { code: *code, of_plant: false }]);
        let conditions = conditions.collect();
        let period = compiled.symbols.cycle.count().max(1);
        Model {
            conditions,
            assume,
            period,
            inputs: values(compiled),
            compiled,
            plant: None,
            slice: Slice::default(),
        }
    }

    /// The same model, of whose states a search leaves something out.
    pub(crate) fn sliced(&self, slice: Slice) -> Model<'c> {
        Model {
            compiled: self.compiled,
            conditions: self.conditions.clone(),
            assume: self.assume.clone(),
            period: self.period,
            inputs: self.inputs.clone(),
            plant: self.plant,
            slice,
        }
    }

    /// The codes of all conditions that are evaluated on the charts.
    pub(crate) fn codes(&self) -> impl Iterator<Item = Code> + '_ {
        self.conditions.iter().flatten().filter(|part| !part.of_plant).map(|part| part.code)
    }

    /// True if the plant drives an input, by its place.
    pub fn is_driven(&self, place: usize) -> bool {
        self.plant.is_some_and(|p| p.coupling.to_charts.iter().any(|(_, to)| *to as usize == place))
    }
}
