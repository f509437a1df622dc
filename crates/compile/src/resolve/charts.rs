//! Charts and steps: their rows, their names and how charts nest.

use g7_model::{
    Action, ActionKind as Written, Chart as WrittenChart, ChartKind, Name, Order, Problem, Span, StepKind,
    codes, say,
};

use super::resolver::Resolver;
use super::scopes::ChartScope;
use crate::ir::{Chart, ChartId, ChartRole, Step, StepId, StepSort};

/// Deepest nesting of expansions and enclosed charts.
const DEEPEST: u32 = 64;

/// How deep a chart lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Depth {
    /// Not known yet.
    Unknown,
    /// On the path that is being followed.
    Climbing,
    /// In so many others.
    Known(u32),
}

impl<'d> Resolver<'_, 'd> {
    /// Rows and names of all charts and steps.
    #[inline(never)]
    pub(super) fn declare_charts(&mut self, charts: &[&'d WrittenChart]) {
        let steps = charts.iter().map(|c| c.steps().count()).sum();
        self.unit.steps.reserve(steps);
        self.scopes.step_homes.reserve(steps);
        for (k, chart) in charts.iter().enumerate() {
            let id = ChartId(k as u32);
            let named = !chart.name.text.is_empty();
            match self.scopes.chart(&chart.name.text).and_then(|c| self.unit.charts.get(c.index())) {
                Some(before) => {
                    let first = before.at;
                    self.defined_twice(&chart.name, first);
                }
                None if named => {
                    self.scopes.chart_names.insert(&chart.name.text, id);
                }
                None => {} // The name could not be read; the parser has reported it.
            }
            let proper = chart.kind == ChartKind::Chart;
            self.scopes.charts.push(ChartScope { proper, ..ChartScope::default() });
            let start = self.unit.steps.len() as u32;
            self.unit.charts.push(Chart {
                name: chart.name.text.clone(),
                path: chart.name.text.clone(),
                role: match chart.kind {
                    ChartKind::Chart => ChartRole::Chart,
                    ChartKind::Expansion => ChartRole::Unused,
                    ChartKind::Task => ChartRole::Task,
                },
                every: chart.every,
                steps: start..start,
                transitions: 0..0,
                entry: None,
                exit: None,
                enclosed_by: None,
                at: chart.name.at.0,
            });
            self.declare_steps(id, chart);
        }
    }

    fn declare_steps(&mut self, chart: ChartId, written: &'d WrittenChart) {
        for step in written.steps() {
            let id = StepId(self.unit.steps.len() as u32);
            self.unit.steps.push(Step {
                name: step.name.text.clone(),
                chart,
                sort: if step.kind == StepKind::Enclosing {
                    StepSort::Enclosing(Vec::new())
                } else {
                    StepSort::Plain
                },
                initial: step.initial,
                linked: step.linked,
                actions: Vec::new(),
                calls: Vec::new(),
                at: step.name.at.0,
            });
            self.name_step(chart, &step.name, id);
            match step.kind {
                StepKind::Entry => self.mark_end(chart, &step.name, id, true),
                StepKind::Exit => self.mark_end(chart, &step.name, id, false),
                StepKind::Plain | StepKind::Macro(_) | StepKind::Enclosing => {}
            }
        }
        let end = self.unit.steps.len() as u32;
        if let Some(c) = self.unit.charts.get_mut(chart.index()) {
            c.steps.end = end;
        }
    }

    fn name_step(&mut self, chart: ChartId, name: &'d Name, id: StepId) {
        if name.text.is_empty() {
            return; // The name could not be read; the parser has reported it.
        }
        let before = self.scopes.name_step(chart, &name.text, id);
        if let Some(first) = before.and_then(|s| self.unit.steps.get(s.index())) {
            let what = say!("step `{}` is defined twice", name.text);
            let problem = Problem::new(&codes::DEFINED_TWICE, name.at.0, what);
            self.problems.push(problem.related(first.at, say!("defined here first")));
        }
    }

    /// An expansion or task has one entry step and one exit step.
    fn mark_end(&mut self, chart: ChartId, name: &Name, id: StepId, entry: bool) {
        let Some(c) = self.unit.charts.get_mut(chart.index()) else { return };
        let slot = if entry { &mut c.entry } else { &mut c.exit };
        let Some(first) = *slot else {
            *slot = Some(id);
            return;
        };
        let word = if entry { say!("entry") } else { say!("exit") };
        let what = say!("`{}` has two {word} steps", c.name);
        let at = self.unit.steps.get(first.index()).map(|s| s.at).unwrap_or_default();
        self.problems
            .push(Problem::new(&codes::DEFINED_TWICE, name.at.0, what).related(at, say!("the {word} step")));
    }

    /// Links macro-steps to their expansions and enclosing steps to their charts.
    #[inline(never)]
    pub(super) fn link_charts(&mut self, charts: &[&WrittenChart]) {
        for (k, chart) in charts.iter().enumerate() {
            let first = self.unit.charts.get(k).map_or(0, |c| c.steps.start);
            for (id, step) in (first..).map(StepId).zip(chart.steps()) {
                if let StepKind::Macro(expansion) = &step.kind {
                    self.link_expansion(id, expansion);
                }
                for action in &step.actions {
                    self.link_enclosed(id, action);
                }
            }
        }
        self.cut_circles();
        self.name_paths();
    }

    #[inline(never)]
    fn link_expansion(&mut self, step: StepId, name: &Name) {
        let Some(c) = self.chart_named(name) else { return };
        let Some(chart) = self.unit.charts.get(c.index()) else { return };
        let declared = chart.at;
        match chart.role {
            ChartRole::Chart | ChartRole::Task => {
                let what = say!("`{}` is not the expansion of a macro-step", name.text);
                self.problems.push(
                    Problem::new(&codes::WRONG_KIND, name.at.0, what)
                        .related(declared, say!("declared here"))
                        .help(say!("an expansion is written `macrochart {} {{ … }}`", name.text)),
                );
                return;
            }
            ChartRole::Expansion(first) => {
                if self.is_within(step, c) {
                    self.nested_in_itself(name.at.0, &name.text);
                    return;
                }
                let at = self.unit.steps.get(first.index()).map(|s| s.at).unwrap_or_default();
                let what = say!("`{}` is the expansion of two macro-steps", name.text);
                self.problems.push(
                    Problem::new(&codes::EXPANSION_SHARED, name.at.0, what)
                        .related(at, say!("this macro-step has it already"))
                        .help(say!("give each macro-step an expansion of its own, or make it a task")),
                );
                return;
            }
            ChartRole::Unused => {}
        }
        if self.unit.steps.get(step.index()).map(|s| s.chart) == Some(c) {
            self.nested_in_itself(name.at.0, &name.text);
            return;
        }
        if let Some(chart) = self.unit.charts.get_mut(c.index()) {
            chart.role = ChartRole::Expansion(step);
        }
        if let Some(s) = self.unit.steps.get_mut(step.index()) {
            s.sort = StepSort::Macro(c);
        }
    }

    #[inline(never)]
    fn link_enclosed(&mut self, step: StepId, action: &Action) {
        let Written::Order(Order::Enclose(name)) = &action.kind else { return };
        let Some(s) = self.unit.steps.get(step.index()) else { return };
        let enclosing = matches!(s.sort, StepSort::Enclosing(_));
        let own = s.chart;
        if !enclosing {
            let what = say!("step `{}` is not an enclosing step", s.name);
            let help = say!("write `enclosing step {}`", s.name);
            self.problems.push(Problem::new(&codes::NOT_HERE, name.at.0, what).help(help));
            return;
        }
        let Some(c) = self.chart_named(name) else { return };
        let Some(chart) = self.unit.charts.get(c.index()) else { return };
        if chart.role != ChartRole::Chart {
            let what = say!("`{}` is not a chart that can be enclosed", name.text);
            let problem =
                Problem::new(&codes::WRONG_KIND, name.at.0, what).related(chart.at, say!("declared here"));
            self.problems.push(problem);
            return;
        }
        if let Some(first) = chart.enclosed_by {
            let at = self.unit.steps.get(first.index()).map(|s| s.at).unwrap_or_default();
            let what = say!("`{}` is enclosed twice", name.text);
            self.problems.push(
                Problem::new(&codes::ENCLOSED_TWICE, name.at.0, what)
                    .related(at, say!("enclosed by this step")),
            );
            return;
        }
        if own == c {
            self.nested_in_itself(name.at.0, &name.text);
            return;
        }
        if let Some(chart) = self.unit.charts.get_mut(c.index()) {
            chart.enclosed_by = Some(step);
        }
        if let Some(StepSort::Enclosing(charts)) = self.unit.steps.get_mut(step.index()).map(|s| &mut s.sort)
        {
            charts.push(c);
        }
    }

    fn nested_in_itself(&mut self, at: Span, chart: &str) {
        let what = say!("`{chart}` would contain itself");
        self.problems.push(Problem::new(&codes::NESTED_IN_ITSELF, at, what));
    }

    /// The step that contains a chart.
    fn outer_step(&self, chart: ChartId) -> Option<StepId> {
        let c = self.unit.charts.get(chart.index())?;
        match c.role {
            ChartRole::Expansion(s) => Some(s),
            ChartRole::Chart | ChartRole::Unused | ChartRole::Task => c.enclosed_by,
        }
    }

    fn outer(&self, chart: ChartId) -> Option<ChartId> {
        self.unit.steps.get(self.outer_step(chart)?.index()).map(|s| s.chart)
    }

    /// True if a step lies in a chart, at whatever depth is allowed.
    fn is_within(&self, step: StepId, chart: ChartId) -> bool {
        let mut at = self.unit.steps.get(step.index()).map(|s| s.chart);
        for _ in 0..=DEEPEST {
            match at {
                Some(c) if c == chart => return true,
                Some(c) => at = self.outer(c),
                None => return false,
            }
        }
        false
    }

    /// Cuts nestings that form a circle or are too deep, so that a walk from a chart outward always
    /// ends.
    fn cut_circles(&mut self) {
        let mut depth = vec![Depth::Unknown; self.unit.charts.len()];
        for start in 0..depth.len() {
            let (way, mut level) = self.climb(ChartId(start as u32), &mut depth);
            for c in way.into_iter().rev() {
                if level > DEEPEST {
                    self.cut(c, false);
                    level = 0;
                }
                if let Some(d) = depth.get_mut(c.index()) {
                    *d = Depth::Known(level);
                }
                level += 1;
            }
        }
    }

    /// Returns the charts from this one outward whose depth is not known yet, and the depth of the
    /// last of them. A circle is cut at the place that closes it in the text.
    fn climb(&mut self, start: ChartId, depth: &mut [Depth]) -> (Vec<ChartId>, u32) {
        let mut way = Vec::new();
        let mut at = start;
        loop {
            match depth.get(at.index()).copied() {
                Some(Depth::Known(level)) => return (way, level + 1),
                Some(Depth::Climbing) => {
                    let circle = way.iter().skip_while(|c| **c != at);
                    if let Some(last) = circle.copied().max_by_key(|c| self.outer_step(*c)) {
                        self.cut(last, true);
                    }
                    for c in way.drain(..) {
                        if let Some(d) = depth.get_mut(c.index()) {
                            *d = Depth::Unknown;
                        }
                    }
                    at = start;
                }
                Some(Depth::Unknown) => {
                    if let Some(d) = depth.get_mut(at.index()) {
                        *d = Depth::Climbing;
                    }
                    way.push(at);
                    match self.outer(at) {
                        Some(outer) => at = outer,
                        None => return (way, 0),
                    }
                }
                None => return (way, 0),
            }
        }
    }

    /// Removes a chart from the step that contains it.
    fn cut(&mut self, chart: ChartId, circle: bool) {
        let Some(step) = self.outer_step(chart) else { return };
        let at = self.unit.steps.get(step.index()).map(|s| s.at).unwrap_or_default();
        let Some(c) = self.unit.charts.get_mut(chart.index()) else { return };
        let name = c.name.clone();
        c.enclosed_by = None;
        if matches!(c.role, ChartRole::Expansion(_)) {
            c.role = ChartRole::Unused;
        }
        if let Some(s) = self.unit.steps.get_mut(step.index()) {
            match &mut s.sort {
                StepSort::Enclosing(charts) => charts.retain(|c| *c != chart),
                StepSort::Macro(_) | StepSort::Plain => s.sort = StepSort::Plain,
            }
        }
        if circle {
            self.nested_in_itself(at, &name);
        } else {
            let what = say!("`{name}` lies more than {DEEPEST} charts deep");
            self.problems.push(Problem::new(&codes::NESTED_TOO_DEEPLY, at, what));
        }
    }

    /// `G.M3`: the prefix of steps of an expansion in traces. Circles are cut.
    fn name_paths(&mut self) {
        for k in 0..self.unit.charts.len() {
            let mut parts: Vec<Box<str>> = Vec::new();
            let mut chart = ChartId(k as u32);
            while let Some(c) = self.unit.charts.get(chart.index()) {
                let ChartRole::Expansion(s) = c.role else {
                    parts.push(c.name.clone());
                    break;
                };
                let Some(step) = self.unit.steps.get(s.index()) else { break };
                parts.push(step.name.clone());
                chart = step.chart;
            }
            parts.reverse();
            if let Some(c) = self.unit.charts.get_mut(k) {
                c.path = parts.join(".").into();
            }
        }
    }
}
