//! Charts as groups of steps: initial situations, enclosures, and what steps
//! order of other charts.

use std::collections::HashMap;

use g7_engine::{Chart, Group, GroupId, Order, Rows, Situation, StepId as Number};

use super::distinct::Distinct;
use super::lists::Lists;
use super::plan::parent;
use super::work::{Freeze, Lower};
use crate::ir::{self, ActionKind, ChartId, ChartRole, StepId, StepSort};

impl Lower<'_> {
    /// Finds who enables, masks and calls what, and gives tasks and frozen
    /// charts their words.
    #[inline(never)]
    pub(super) fn look_at_orders(&mut self) {
        let unit = self.unit;
        let charts = unit.charts.len();
        self.enabling = vec![Vec::new(); charts];
        self.masked_charts = vec![Vec::new(); charts];
        self.callers = vec![Vec::new(); charts];
        for (i, step) in unit.steps.iter().enumerate() {
            let id = StepId(i as u32);
            if self.plan.own(id).is_none() {
                continue;
            }
            for action in &step.actions {
                match action.kind {
                    ActionKind::Enable(chart) => enlist(&mut self.enabling, chart, id),
                    ActionKind::MaskChart(chart) => enlist(&mut self.masked_charts, chart, id),
                    ActionKind::MaskVar(var) => {
                        let steps = self.masked_vars.entry(var).or_default();
                        if steps.last() != Some(&id) {
                            steps.push(id);
                        }
                    }
                    _ => {}
                }
            }
            for (task, _) in &step.calls {
                enlist(&mut self.callers, *task, id);
            }
        }
        self.has_masks = self.masked_charts.iter().any(|m| !m.is_empty());
        if unit.charts.iter().any(|c| c.role == ChartRole::Task) {
            self.owners = unit
                .charts
                .iter()
                .map(|c| (c.role == ChartRole::Task).then(|| self.words.hidden(0)))
                .collect();
        }
        let words = &mut self.words;
        self.freezes = self
            .uses
            .frozen
            .iter()
            .map(|f| f.then(|| Freeze { asked: words.hidden(0), holds: words.hidden(0) }))
            .collect();
        self.has_blockers = self.stop_all.is_some()
            || self.freezes.iter().any(Option::is_some)
            || self.enabling.iter().any(|e| !e.is_empty());
    }

    /// The row of a chart's period.
    pub(super) fn period(&self, chart: ChartId) -> u32 {
        self.periods.get(chart.index()).copied().unwrap_or(0)
    }

    /// Period rows, equal periods sharing one; an expansion has its chart's.
    #[inline(never)]
    pub(super) fn look_at_periods(&mut self) {
        self.t.periods = vec![0];
        let mut known = HashMap::from([(0, 0)]);
        self.periods = vec![0; self.unit.charts.len()];
        for i in 0..self.unit.charts.len() {
            let row = self.plan.chart(ChartId(i as u32));
            let outer = row.and_then(|r| self.plan.outer.get(r as usize));
            let every = outer.and_then(|c| self.unit.charts.get(c.index())).and_then(|c| c.every);
            let every = every.map_or(0, |time| time.count().max(0));
            let row = *known.entry(every).or_insert_with(|| {
                self.t.periods.push(every);
                self.t.periods.len() as u32 - 1
            });
            if let Some(p) = self.periods.get_mut(i) {
                *p = row;
            }
        }
    }

    /// Groups and charts, with their initial situations, and the steps active
    /// at the start.
    #[inline(never)]
    pub(super) fn groups(&mut self) {
        let rows = self.plan.groups.clone();
        for (i, (_, start, end)) in rows.iter().enumerate() {
            let initial = self.initial(GroupId(i as u32));
            let initial = self.list(&initial);
            let steps = Rows { start: *start, end: *end };
            self.t.groups.push(Group { steps, initial, watches: Rows::default() });
        }
        self.t.initial = self.start();
        for chart in &self.plan.outer {
            let Some(group) = self.plan.group(*chart) else { continue };
            self.t.charts.push(Chart { group, period: self.period(*chart) });
        }
    }

    /// The charts whose groups lie within a group, its own first.
    fn within(&self, group: GroupId) -> impl Iterator<Item = ChartId> + '_ {
        let from = group.0 as usize;
        let end = self.plan.groups.get(from).map_or(0, |g| g.2);
        let rows = self.plan.groups.get(from..).unwrap_or(&[]);
        let own = rows.iter().take(1);
        let nested = rows.iter().skip(1).take_while(move |g| g.1 < end && g.2 <= end);
        own.chain(nested).map(|g| g.0)
    }

    /// The steps of a group that a test names, with all that goes on with them.
    fn steps_where(
        &self,
        group: GroupId,
        test: impl Fn(&ir::Chart, StepId, &ir::Step) -> bool,
    ) -> Vec<Number> {
        let mut found = Vec::new();
        for chart in self.within(group) {
            let Some(row) = self.unit.charts.get(chart.index()) else { continue };
            for i in row.steps.clone() {
                let Some(step) = self.unit.steps.get(i as usize) else { continue };
                if test(row, StepId(i), step) {
                    let mut steps = Distinct::default();
                    self.plan.entering(self.unit, StepId(i), &mut steps);
                    self.plan.around(self.unit, StepId(i), &mut steps);
                    found.extend(steps.as_slice());
                }
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The initial situation of a group: initial steps, of a task its entry step.
    fn initial(&self, group: GroupId) -> Vec<Number> {
        self.steps_where(group, is_initial)
    }

    /// The situation at the start: the initial steps of the charts that no step
    /// encloses, and of those that an initial enclosing step encloses. Activation
    /// links act at later activations.
    fn start(&self) -> Vec<Number> {
        let unit = self.unit;
        let mut found = Vec::new();
        let mut done = vec![false; self.plan.groups.len()];
        let mut todo: Vec<GroupId> = Vec::new();
        for chart in &self.plan.outer {
            let row = unit.charts.get(chart.index());
            if let (Some(group), true) =
                (self.plan.group(*chart), row.is_some_and(|c| c.enclosed_by.is_none()))
            {
                todo.push(group);
            }
        }
        while let Some(group) = todo.pop() {
            match done.get_mut(group.0 as usize) {
                Some(d) if !*d => *d = true,
                _ => continue, // enclosed twice, or in a circle: reported
            }
            found.extend(self.steps_where(group, is_initial));
            for chart in self.within(group) {
                let Some(row) = unit.charts.get(chart.index()) else { continue };
                for i in row.steps.clone() {
                    let Some(step) = unit.steps.get(i as usize) else { continue };
                    if let StepSort::Enclosing(charts) = &step.sort
                        && step.initial
                    {
                        todo.extend(charts.iter().filter_map(|c| self.plan.group(*c)));
                    }
                }
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// By step: the groups it counts in. Only those of expansions are counted,
    /// since only macro-steps have an activity of their own; what stands for a
    /// macro-step inside is no step of the expansion.
    #[inline(never)]
    pub(super) fn counted_groups(&self) -> Lists<GroupId> {
        let mut lists = Lists::default();
        if self.plan.groups.len() == self.plan.outer.len() {
            return lists;
        }
        for (i, (chart, start, end)) in self.plan.groups.iter().enumerate() {
            if parent(self.unit, *chart).is_some() {
                let steps = (*start..*end).filter(|s| !self.is_pseudo(*s));
                steps.for_each(|s| lists.add(s, GroupId(i as u32)));
            }
        }
        lists.sort_unique();
        lists
    }

    /// By enclosing step: the groups it encloses, and the steps it activates.
    #[inline(never)]
    pub(super) fn enclosures(&self) -> (Lists<GroupId>, Lists<Number>) {
        let (mut groups, mut links) = (Lists::default(), Lists::default());
        for (i, step) in self.unit.steps.iter().enumerate() {
            let StepSort::Enclosing(charts) = &step.sort else { continue };
            let Some(number) = self.plan.own(StepId(i as u32)) else { continue };
            for chart in charts {
                let Some(group) = self.plan.group(*chart) else { continue };
                groups.add(number.0, group);
                self.linked(group).as_slice().iter().for_each(|s| links.add(number.0, *s));
            }
        }
        groups.sort_unique();
        links.sort();
        (groups, links)
    }

    /// The linked steps of a group in the order of the text, each with all that
    /// goes on with it.
    fn linked(&self, group: GroupId) -> Distinct {
        let mut found = Distinct::default();
        for chart in self.within(group).filter_map(|c| self.unit.charts.get(c.index())) {
            for i in chart.steps.clone() {
                if self.unit.steps.get(i as usize).is_some_and(|s| s.linked) {
                    self.plan.around(self.unit, StepId(i), &mut found);
                    self.plan.entering(self.unit, StepId(i), &mut found);
                }
            }
        }
        found
    }

    /// Fills the table of forcing orders, in the partial order of the charts.
    /// Returns the first row of each step that gives any, by step.
    #[inline(never)]
    pub(super) fn orders(&mut self) -> Vec<(u32, Rows)> {
        let unit = self.unit;
        let mut found: Vec<(u32, ChartId, &ir::Situation)> = Vec::new();
        for (i, step) in unit.steps.iter().enumerate() {
            let Some(number) = self.plan.own(StepId(i as u32)) else { continue };
            for action in &step.actions {
                if let ActionKind::Force(chart, situation) = &action.kind {
                    found.push((number.0, *chart, situation));
                }
            }
        }
        let mut rows: Vec<(u32, Order)> = Vec::new();
        for (step, chart, situation) in found {
            let Some(forced) = self.plan.chart(chart) else { continue };
            let situation = match situation {
                ir::Situation::Current => Situation::Current,
                ir::Situation::Init => {
                    let group = self.plan.group(chart).and_then(|g| self.t.groups.get(g.0 as usize));
                    Situation::Steps(group.map(|g| g.initial).unwrap_or_default())
                }
                ir::Situation::Steps(steps) => {
                    let mut imposed = Distinct::default();
                    for s in steps {
                        self.plan.entering(unit, *s, &mut imposed);
                        self.plan.around(unit, *s, &mut imposed);
                    }
                    Situation::Steps(self.list(imposed.as_slice()))
                }
            };
            rows.push((step, Order { step: Number(step), chart: forced, situation }));
        }
        let depth = self.depths(&rows);
        // By the charts they act on: what rules a chart is settled before it is. The present
        // situation goes before the named ones, which are compared with it.
        rows.sort_by_key(|(step, o)| {
            let below = depth.get(o.chart as usize).copied().unwrap_or(0);
            (below, o.situation != Situation::Current, *step)
        });
        let mut by_step: Vec<(u32, Rows)> = Vec::new();
        for (step, order) in rows {
            let at = self.t.orders.len() as u32;
            self.t.orders.push(order);
            by_step.push((step, Rows { start: at, end: at + 1 }));
        }
        by_step.sort_by_key(|(step, _)| *step);
        by_step.dedup_by_key(|(step, _)| *step);
        by_step
    }

    /// The charts with enclosing steps, each with one that it encloses.
    fn enclosing(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.unit.steps.iter().flat_map(|step| {
            let charts = match &step.sort {
                StepSort::Enclosing(charts) => &charts[..],
                StepSort::Plain | StepSort::Macro(_) => &[],
            };
            charts.iter().filter_map(|c| Some((self.plan.chart(step.chart)?, self.plan.chart(*c)?)))
        })
    }

    /// By chart: the longest way down to it, over forcing orders and enclosures.
    fn depths(&self, rows: &[(u32, Order)]) -> Vec<u32> {
        let mut arcs: Vec<(u32, u32)> = rows
            .iter()
            .filter_map(|(_, o)| self.t.steps.get(o.step.0 as usize).map(|s| (s.chart, o.chart)))
            .chain(self.enclosing())
            .collect();
        arcs.sort_unstable();
        arcs.dedup();
        let mut depth = vec![0u32; self.t.charts.len()];
        let mut waits = vec![0u32; self.t.charts.len()];
        for (_, to) in &arcs {
            if let Some(w) = waits.get_mut(*to as usize) {
                *w += 1;
            }
        }
        // Charts that nothing forces first; a circle (reported) stays where it is.
        let mut ready: Vec<u32> =
            (0..waits.len() as u32).filter(|c| waits.get(*c as usize) == Some(&0)).collect();
        while let Some(chart) = ready.pop() {
            let below = depth.get(chart as usize).copied().unwrap_or(0) + 1;
            let from = arcs.partition_point(|a| a.0 < chart);
            for (_, to) in arcs.iter().skip(from).take_while(|a| a.0 == chart) {
                if let (Some(d), Some(w)) = (depth.get_mut(*to as usize), waits.get_mut(*to as usize)) {
                    *d = (*d).max(below);
                    *w -= 1;
                    if *w == 0 {
                        ready.push(*to);
                    }
                }
            }
        }
        depth
    }
}

fn is_initial(chart: &ir::Chart, id: StepId, step: &ir::Step) -> bool {
    step.initial || (chart.role == ChartRole::Task && chart.entry == Some(id))
}

fn enlist(lists: &mut [Vec<StepId>], chart: ChartId, step: StepId) {
    if let Some(list) = lists.get_mut(chart.index())
        && list.last() != Some(&step)
    {
        list.push(step);
    }
}
