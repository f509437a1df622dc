//! Finds what each name of a path refers to, one by one. It repeats the lookup of `refer` for code
//! that follows names through the text, and must keep to its order.

use std::collections::HashSet;

use g7_model::{Name, Type, normal_address};

use super::resolver::{Frame, Resolver};
use super::scopes::{Entity, Home, Scopes};
use crate::ir::{ChartId, StepId, Unit};
use crate::references::Definition;

/// One name of a path: which, what it stands for, and how many bytes before the
/// name itself (`X` in `X12`).
pub(crate) type Traced = (usize, Definition, usize);

/// The names of a path, followed.
#[derive(Debug, Default)]
pub(crate) struct Followed {
    pub(crate) names: Vec<Traced>,
    /// False if it is not known what the names that are missing here refer to.
    pub(crate) whole: bool,
}

impl Followed {
    pub(crate) fn whole(names: Vec<Traced>) -> Followed {
        Followed { names, whole: true }
    }
}

/// Follows names in a resolved document.
pub(crate) struct Tracer<'u, 'd>(Resolver<'u, 'd>);

impl<'u, 'd> Tracer<'u, 'd> {
    pub(crate) fn new(unit: &'u mut Unit, scopes: &'u mut Scopes<'d>) -> Tracer<'u, 'd> {
        Tracer(Resolver::new(unit, scopes))
    }

    /// True if a name behind a variable of a type is a member of a function block of the standard, or the number of
    /// a bit.
    pub(crate) fn has_part(ty: Type, name: &str) -> bool {
        let member = matches!(ty, Type::Fb(kind) if super::fb::member(kind, name).is_some());
        member || Resolver::bit_number(name, ty).is_some()
    }

    /// The chart in which names are looked up first.
    pub(crate) fn enter(&mut self, chart: Option<ChartId>) {
        self.0.frame = Frame { chart, ..Frame::default() };
    }

    pub(crate) fn chart(&self, name: &str) -> Option<Definition> {
        self.0.scopes.chart(name).map(|c| self.of_chart_id(c))
    }

    /// A step of a chart that is named.
    pub(crate) fn step_of(&self, chart: &str, name: &str) -> Option<Definition> {
        let chart = self.0.scopes.chart(chart)?;
        self.0.scopes.step(chart, name).map(|s| self.step(s))
    }

    /// A step of the chart at hand.
    pub(crate) fn own_step(&self, name: &str) -> Option<Definition> {
        let chart = self.0.frame.chart?;
        self.0.scopes.step(chart, name).map(|s| self.step(s))
    }

    /// Finds what the names of a path refer to; `locals` hide all other names.
    pub(crate) fn path(&self, names: &[Name], locals: &[HashSet<&str>]) -> Followed {
        let Some(first) = names.first() else { return Followed::default() };
        if locals.iter().any(|l| l.contains(&*first.text)) {
            return Followed::whole(Vec::new());
        }
        if names.len() == 1 {
            let names = self.single(&first.text);
            return Followed { whole: !names.is_empty(), names };
        }
        let chart = self.0.scopes.chart(&first.text);
        if let Some(c) = chart {
            let rest = self.in_chart(c, names, 1);
            if !rest.is_empty() {
                let mut all = vec![(0, self.of_chart_id(c), 0)];
                all.extend(rest);
                return Followed::whole(all);
            }
        }
        let entity = self.visible(&first.text);
        if let (Some((Entity::Var(v), def)), Some(second)) = (&entity, names.get(1))
            && self.0.part(*v, &second.text).is_some()
        {
            return Followed::whole(vec![(0, def.clone(), 0)]);
        }
        let steps = self.step_path(None, names, 0);
        if !steps.is_empty() {
            return Followed::whole(steps);
        }
        // The path is wrong, but what it refers to is clear.
        let near = chart.map(|c| self.of_chart_id(c)).or(entity.map(|(_, def)| def));
        Followed { names: near.map(|def| vec![(0, def, 0)]).unwrap_or_default(), whole: false }
    }

    /// `%X12`, `%XM3`, `%X3.12`, or the variable declared at an address.
    pub(crate) fn direct(&self, text: &str) -> Vec<Traced> {
        let word = text.split_once(":X").map_or(text, |(word, _)| word);
        if let Some(v) = self.0.scopes.addresses.get(&normal_address(word)) {
            let name = self.0.var(*v).map(|v| v.name.to_string()).unwrap_or_default();
            let (chart, own) = match name.split_once('.') {
                Some((c, own)) if self.0.scopes.chart(c).is_some() => (Some(c.to_owned()), own.to_owned()),
                _ => (None, name),
            };
            return vec![(0, Definition::Variable { chart, name: own }, 0)];
        }
        let Some(rest) = text.strip_prefix('X') else { return Vec::new() };
        let name = rest.strip_suffix(".T").unwrap_or(rest);
        let Some((outer, inner)) = name.split_once('.') else {
            let step = match name.strip_prefix('M') {
                Some(number) => self.0.macro_step(number),
                None => self.0.first_chart().and_then(|c| self.0.scopes.step(c, name)),
            };
            return step.map(|s| vec![(0, self.step(s), 0)]).unwrap_or_default();
        };
        let Some(outer) = self.0.macro_step(outer) else { return Vec::new() };
        let found = self.0.expansion(outer).and_then(|c| {
            let chart = self.0.unit.charts.get(c.index())?;
            match inner {
                "IN" => chart.entry,
                "OUT" => chart.exit,
                _ => self.0.scopes.step(c, inner),
            }
        });
        let mut all = vec![(0, self.step(outer), 0)];
        all.extend(found.map(|s| (1, self.step(s), 0)));
        all
    }

    fn single(&self, name: &str) -> Vec<Traced> {
        if let Some((_, def)) = self.visible(name) {
            return vec![(0, def, 0)];
        }
        if let Some(Home::One(_, s)) = self.0.activity(None, name) {
            return vec![self.active(0, name, s)];
        }
        if let Some(Home::One(_, s)) = self.0.scopes.home(self.0.frame.chart, name) {
            return vec![(0, self.step(s), 0)];
        }
        self.0.scopes.chart(name).map(|c| vec![(0, self.of_chart_id(c), 0)]).unwrap_or_default()
    }

    fn in_chart(&self, chart: ChartId, names: &[Name], k: usize) -> Vec<Traced> {
        let Some(name) = names.get(k) else { return Vec::new() };
        let entity = self.0.scopes.of_chart(chart, &name.text);
        if let Some(member) = names.get(k + 1) {
            if let Some(Entity::Var(v)) = entity {
                if self.0.part(v, &member.text).is_some() && k + 2 == names.len() {
                    return vec![(k, self.named(Some(chart), &name.text, Entity::Var(v)), 0)];
                }
                if matches!(self.0.var(v).map(|v| v.ty), Some(Type::Fb(_))) {
                    return Vec::new();
                }
            }
            return self.step_path(Some(chart), names, k);
        }
        if let Some(e) = entity {
            return vec![(k, self.named(Some(chart), &name.text, e), 0)];
        }
        if let Some(Home::One(_, s)) = self.0.activity(Some(chart), &name.text) {
            return vec![self.active(k, &name.text, s)];
        }
        self.0.scopes.step(chart, &name.text).map(|s| vec![(k, self.step(s), 0)]).unwrap_or_default()
    }

    fn step_path(&self, chart: Option<ChartId>, names: &[Name], k: usize) -> Vec<Traced> {
        let (Some(first), Some(second)) = (names.get(k), names.get(k + 1)) else { return Vec::new() };
        let by_name = match chart {
            Some(c) => self.0.scopes.step(c, &first.text).map(|s| Home::One(c, s)),
            None => self.0.scopes.home(self.0.frame.chart, &first.text),
        };
        let (home, bare) = match by_name {
            Some(home) => (home, true),
            None => match self.0.activity(chart, &first.text) {
                Some(home) => (home, false),
                None => return Vec::new(),
            },
        };
        let Home::One(_, step) = home else { return Vec::new() };
        let here = if bare { (k, self.step(step), 0) } else { self.active(k, &first.text, step) };
        if k + 2 == names.len() && self.0.of_step(step, &second.text, bare).is_some() {
            return vec![here];
        }
        match self.0.expansion(step) {
            Some(inner) if bare => {
                let rest = self.in_chart(inner, names, k + 1);
                if rest.is_empty() { rest } else { [vec![here], rest].concat() }
            }
            _ => Vec::new(),
        }
    }

    /// Looks for a name of the current chart, then of the file.
    fn visible(&self, name: &str) -> Option<(Entity, Definition)> {
        let own = self.0.frame.chart.and_then(|c| Some((c, self.0.scopes.of_chart(c, name)?)));
        if let Some((c, e)) = own {
            return Some((e, self.named(Some(c), name, e)));
        }
        let e = self.0.scopes.visible(None, name)?;
        Some((e, self.named(None, name, e)))
    }

    fn named(&self, chart: Option<ChartId>, name: &str, entity: Entity) -> Definition {
        let chart = chart.and_then(|c| self.0.unit.charts.get(c.index())).map(|c| c.name.to_string());
        let name = name.to_owned();
        match entity {
            Entity::Var(_) | Entity::Array(_) => Definition::Variable { chart, name },
            Entity::Body(_) => Definition::Action { chart, name },
            Entity::Section(_) => Definition::Section { chart, name },
            Entity::Function(_) => Definition::Function(name),
        }
    }

    /// `X12`: the activity of a step; `XM3` may mean macro-step 3.
    fn active(&self, k: usize, written: &str, step: StepId) -> Traced {
        let length = self.0.unit.steps.get(step.index()).map_or(0, |s| s.name.len());
        (k, self.step(step), written.len().saturating_sub(length))
    }

    fn step(&self, step: StepId) -> Definition {
        let found = self.0.unit.steps.get(step.index());
        let chart = found.and_then(|s| self.0.unit.charts.get(s.chart.index()));
        Definition::Step {
            chart: chart.map(|c| c.name.to_string()).unwrap_or_default(),
            name: found.map(|s| s.name.to_string()).unwrap_or_default(),
        }
    }

    fn of_chart_id(&self, chart: ChartId) -> Definition {
        Definition::Chart(
            self.0.unit.charts.get(chart.index()).map(|c| c.name.to_string()).unwrap_or_default(),
        )
    }
}
