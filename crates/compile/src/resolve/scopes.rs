//! Which name means what, and where: the tables that every later lookup reads.
//!
//! A chart has one name space for its variables, named actions and sections,
//! and another one for its steps. Names of the file stand behind those of a
//! chart; seen from outside, steps of expansions and tasks stand behind those
//! of proper charts. All lookups are by hash; nothing here is ever iterated, so no order
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

/// Where a bare step name leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Home {
    /// To this step.
    One(ChartId, StepId),
    /// To several on a par; two of them.
    Several(StepId, StepId),
}

/// The charts that have a step name. Where several have it, each has it in
/// its own table.
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
    /// It is a chart, no expansion and no task.
    pub(super) proper: bool,
}

/// The names of a document; made by `resolve`, read by queries.
#[derive(Clone, Debug, Default)]
pub struct Scopes<'d> {
    pub(super) names: HashMap<&'d str, Entity>,
    pub(super) charts: Vec<ChartScope<'d>>,
    pub(super) chart_names: HashMap<&'d str, ChartId>,
    pub(super) step_homes: HashMap<&'d str, Homes>,
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

    /// A step by its bare name: of the chart itself, else the only one of the
    /// document, else the only one of its proper charts.
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
    /// Gives a step its name; the one that has it in this chart already, else nothing.
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
