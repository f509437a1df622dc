//! The tables of names that every later lookup reads.
//!
//! A chart has one name space for its variables, named actions and sections, and another one for
//! its steps. Names of a chart come before those of the file. Seen from outside, steps of charts
//! come before those of expansions and tasks. All lookups are by hash and nothing here is iterated,
//! so no order depends on hashing.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use g7_model::{Span, Type};

use crate::held::Held;
use crate::ir::{BodyId, ChartId, FunctionId, SectionId, StepId, VarId};

/// The meaning of a name of a file or chart, except charts and steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Entity {
    /// A variable.
    Var(VarId),
    /// An array: its row of [`Scopes::arrays`].
    Array(u32),
    /// A named action.
    Body(BodyId),
    /// A transition section; read as its output.
    Section(SectionId),
    /// A function.
    Function(FunctionId),
}

/// The meaning of a step name without its chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Home {
    /// To this step.
    One(ChartId, StepId),
    /// To several on a par; two of them.
    Several(StepId, StepId),
}

/// The charts that have a step of this name. If several have it, each has it in its own table too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Homes {
    /// One chart of the document.
    One(ChartId, StepId),
    /// Several, of which this one alone is a proper chart, no expansion or task.
    Before(ChartId, StepId),
    /// Several on a par; two of them, and whether these are proper charts.
    Several(StepId, StepId, bool),
}

/// The names of one chart.
#[derive(Clone, Debug, Default)]
pub(super) struct ChartScope<'d> {
    pub(super) names: HashMap<&'d str, Entity>,
    /// Steps whose names several charts have; most charts have none of these,
    /// so that a large chart needs one table, not two.
    pub(super) steps: HashMap<&'d str, StepId>,
    /// True for a chart that is neither an expansion nor a task.
    pub(super) proper: bool,
}

/// An array.
#[derive(Clone, Debug)]
pub(super) struct Array {
    /// Its name as users write it from elsewhere.
    pub(super) name: Box<str>,
    /// Its first element.
    pub(super) first: VarId,
    /// The least index and the number of indexes of each dimension; none if its declaration is wrong.
    pub(super) dimensions: Vec<(i64, u32)>,
    /// Type of the elements.
    pub(super) ty: Type,
    /// Its declaration.
    pub(super) at: Span,
}

/// The names of a document; `resolve` makes them, queries read them.
#[derive(Clone, Debug, Default)]
pub struct Scopes<'d> {
    pub(super) names: HashMap<&'d str, Entity>,
    pub(super) charts: Vec<ChartScope<'d>>,
    pub(super) chart_names: HashMap<&'d str, ChartId>,
    pub(super) step_homes: HashMap<&'d str, Homes>,
    /// Arrays, in the order of the text.
    pub(super) arrays: Vec<Array>,
    /// The values of the enumerations, by their names.
    pub(super) enumerations: HashMap<&'d str, Arc<Held>>,
    /// Direct addresses, upper case without the `%`.
    pub(super) addresses: HashMap<String, VarId>,
    /// Outputs of sections: written by their section only.
    pub(super) section_outputs: HashSet<VarId>,
    /// Names of the inputs of each function, in the order of [`crate::ir::Unit::functions`].
    pub(super) params: Vec<Vec<&'d str>>,
}

impl Scopes<'_> {
    /// The chart with this name.
    pub fn chart(&self, name: &str) -> Option<ChartId> {
        self.chart_names.get(name).copied()
    }

    /// A step of a chart by its name.
    pub fn step(&self, chart: ChartId, name: &str) -> Option<StepId> {
        match self.step_homes.get(name)? {
            Homes::One(home, step) => (*home == chart).then_some(*step),
            Homes::Before(..) | Homes::Several(..) => {
                self.charts.get(chart.index())?.steps.get(name).copied()
            }
        }
    }

    /// A name seen from a chart: the chart's own, then the file's.
    pub(super) fn visible(&self, chart: Option<ChartId>, name: &str) -> Option<Entity> {
        chart.and_then(|c| self.of_chart(c, name)).or_else(|| self.names.get(name).copied())
    }

    /// A name of a chart itself.
    pub(super) fn of_chart(&self, chart: ChartId, name: &str) -> Option<Entity> {
        self.charts.get(chart.index())?.names.get(name).copied()
    }

    /// Finds a step by its name alone: of the chart itself, else the only one of the document, else
    /// the only one outside of expansions and tasks.
    pub(super) fn home(&self, chart: Option<ChartId>, name: &str) -> Option<Home> {
        let home = *self.step_homes.get(name)?;
        let own = |c: ChartId| self.step(c, name).map(|s| Home::One(c, s));
        Some(chart.and_then(own).unwrap_or(match home {
            Homes::One(c, s) | Homes::Before(c, s) => Home::One(c, s),
            Homes::Several(a, b, _) => Home::Several(a, b),
        }))
    }
}

impl<'d> Scopes<'d> {
    /// Gives a step its name; returns the step of this chart that has it already, if there is one.
    pub(super) fn name_step(&mut self, chart: ChartId, name: &'d str, step: StepId) -> Option<StepId> {
        let proper = self.is_proper(chart);
        let before = match self.step_homes.get(name) {
            None => {
                self.step_homes.insert(name, Homes::One(chart, step));
                return None;
            }
            Some(Homes::One(home, first)) if *home == chart => return Some(*first),
            Some(home) => *home,
        };
        if let Homes::One(home, first) = before
            && let Some(c) = self.charts.get_mut(home.index())
        {
            c.steps.insert(name, first);
        }
        match self.charts.get_mut(chart.index())?.steps.entry(name) {
            Entry::Vacant(free) => free.insert(step),
            Entry::Occupied(taken) => return Some(*taken.get()),
        };
        let now = match before {
            Homes::One(home, first) => match (self.is_proper(home), proper) {
                (true, false) => Homes::Before(home, first),
                (false, true) => Homes::Before(chart, step),
                (true, true) | (false, false) => Homes::Several(first, step, proper),
            },
            Homes::Before(_, first) if proper => Homes::Several(first, step, true),
            Homes::Several(_, _, false) if proper => Homes::Before(chart, step),
            Homes::Before(..) | Homes::Several(..) => before,
        };
        self.step_homes.insert(name, now);
        None
    }

    fn is_proper(&self, chart: ChartId) -> bool {
        self.charts.get(chart.index()).is_some_and(|c| c.proper)
    }
}
