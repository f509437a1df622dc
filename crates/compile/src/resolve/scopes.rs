//! Which name means what, and where: the tables that every later lookup reads.
//!
//! A chart has one name space for its variables, named actions and sections,
//! and another one for its steps. Names of the file stand behind those of a
//! chart. All lookups are by hash; nothing here is ever iterated, so no order
//! depends on hashing.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

use crate::ir::{BodyId, ChartId, FunctionId, SectionId, StepId, VarId};

/// What a name of a file or chart stands for, steps and charts apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Entity {
    /// A variable.
    Var(VarId),
    /// A named action.
    Body(BodyId),
    /// A transition section; read as its output.
    Section(SectionId),
    /// A function.
    Function(FunctionId),
}

/// Where a step name is at home.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Home {
    /// In one chart of the document.
    One(ChartId, StepId),
    /// In several; the first two. Each of their charts has it in its own table.
    Several(StepId, StepId),
}

/// The names of one chart.
#[derive(Clone, Debug, Default)]
pub(super) struct ChartScope<'d> {
    pub(super) names: HashMap<&'d str, Entity>,
    /// Steps whose names several charts have; most charts have none of these,
    /// so that a large chart needs one table, not two.
    pub(super) steps: HashMap<&'d str, StepId>,
}

/// The names of a document; made by `resolve`, read by queries.
#[derive(Clone, Debug, Default)]
pub struct Scopes<'d> {
    pub(super) names: HashMap<&'d str, Entity>,
    pub(super) charts: Vec<ChartScope<'d>>,
    pub(super) chart_names: HashMap<&'d str, ChartId>,
    pub(super) step_homes: HashMap<&'d str, Home>,
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
            Home::One(home, step) => (*home == chart).then_some(*step),
            Home::Several(..) => self.charts.get(chart.index())?.steps.get(name).copied(),
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

    /// A step by its bare name: of the chart itself, else the only one of the document.
    pub(super) fn home(&self, chart: Option<ChartId>, name: &str) -> Option<Home> {
        let home = *self.step_homes.get(name)?;
        let (Home::Several(..), Some(c)) = (home, chart) else { return Some(home) };
        let own = self.charts.get(c.index()).and_then(|c| c.steps.get(name));
        Some(own.map_or(home, |s| Home::One(c, *s)))
    }
}

impl<'d> Scopes<'d> {
    /// Gives a step its name; the one that has it in this chart already, else nothing.
    pub(super) fn name_step(&mut self, chart: ChartId, name: &'d str, step: StepId) -> Option<StepId> {
        let before = match self.step_homes.entry(name) {
            Entry::Vacant(free) => {
                free.insert(Home::One(chart, step));
                return None;
            }
            Entry::Occupied(taken) => taken.into_mut(),
        };
        if let Home::One(home, first) = *before {
            if home == chart {
                return Some(first);
            }
            *before = Home::Several(first, step);
            if let Some(c) = self.charts.get_mut(home.index()) {
                c.steps.insert(name, first);
            }
        }
        match self.charts.get_mut(chart.index())?.steps.entry(name) {
            Entry::Vacant(free) => {
                free.insert(step);
                None
            }
            Entry::Occupied(taken) => Some(*taken.get()),
        }
    }
}

/// A direct address in the form of the tables: upper case, `%IX0.1` as `I0.1`.
pub(super) fn normal_address(text: &str) -> String {
    let upper = text.trim_start_matches('%').to_ascii_uppercase();
    let bytes = upper.as_bytes();
    if let [b'I' | b'Q' | b'M', b'X', b'0'..=b'9', ..] = bytes {
        let (area, rest) = upper.split_at(1);
        return format!("{area}{}", rest.trim_start_matches('X'));
    }
    upper
}
