//! The charts of function blocks: each instance has such charts of its own.
//!
//! `chart Cycle of Gripper` becomes `left.Cycle` for `var left : Gripper`, and `axis[3].Cycle` for an element of an
//! array. In its text, the names of the block are those of the instance.
//!
//! # What must hold
//!
//! - In the result no chart has [`Chart::block`].
//! - A chart and its block have no name twice, so a name has one meaning there.

use std::collections::HashSet;

use super::base::{Composition, Env, Scope, Segment, Spot};
use super::declare::bounds;
use super::paths::{Lost, at_of, member};
use super::types::defined_twice;
use crate::visit_mut::{self, Visitor};
use crate::{
    Chart, Composed, Document, Expr, ExprKind, Index, Item, Layout, Literal, Name, Problem, VarDecl, codes,
    instance_of, say,
};

impl<'d> Composition<'d> {
    /// Checks that each chart of a function block has one, and that each function block does something.
    pub(super) fn owners(&mut self, document: &'d Document) {
        for chart in document.charts() {
            if let Some(block) = &chart.block {
                self.owner(chart, block);
            }
        }
        for item in &document.items {
            let Item::Composed(c) = item else { continue };
            if c.block && c.body.is_none() && !self.owned.contains_key(&*c.name.text) {
                let name = &c.name.text;
                let what = say!("the function block `{name}` has no body and no chart");
                let help =
                    say!("write `body {{ … }}` behind its variables, or `chart Name of {name} {{ … }}`");
                self.problems.push(Problem::new(&codes::EXPECTED, c.name.at.0, what).help(help));
            }
        }
        let types = &self.types;
        self.owned.retain(|name, _| types.get(name).is_some_and(|t| t.block));
        self.holders();
    }

    fn owner(&mut self, chart: &Chart, block: &Name) {
        let Some(of) = self.types.get(&*block.text).copied() else {
            if !block.text.is_empty() && !self.wrong.contains(&*block.text) {
                self.unknown_type(block);
            }
            return;
        };
        if !of.block {
            let what = say!("`{}` is a structure; only a function block has charts", block.text);
            let problem = Problem::new(&codes::WRONG_KIND, block.at.0, what);
            self.problems.push(problem.related(of.name.at.0, say!("declared here")));
        }
        if let Some(inout) = of.inouts.first() {
            let what = say!("a function block with a chart has no `inout`: its chart runs without a call");
            let help = say!("make it an input or an output");
            let problem = Problem::new(&codes::BAD_DECLARATION, inout.at.0, what).help(help);
            self.once(problem.related(chart.name.at.0, say!("the chart")));
        }
        let own = chart.vars().flat_map(|v| &v.names).chain([&chart.name]);
        let twice = own.filter_map(|name| Some((name, member(of, &name.text)?.at.0)));
        self.problems.extend(twice.map(|(name, first)| defined_twice(name, first)));
    }

    /// Finds the types with charts: the function blocks that have some, and the types with a member of such a type.
    fn holders(&mut self) {
        if self.owned.is_empty() {
            return;
        }
        let mut holders: HashSet<&'d str> = self.owned.keys().copied().collect();
        loop {
            let held = |v: &VarDecl| v.of.as_ref().is_some_and(|of| holders.contains(&*of.text));
            let new: Vec<&'d str> = self
                .types
                .values()
                .filter(|t| !holders.contains(&*t.name.text) && t.members.iter().any(held))
                .map(|t| &*t.name.text)
                .collect();
            if new.is_empty() {
                break;
            }
            holders.extend(new);
        }
        self.holders = holders;
    }

    /// True for a chart of a function block, which runs as the charts of its instances.
    pub(super) fn is_of_block(&self, chart: &str) -> bool {
        self.owned.values().flatten().any(|c| *c.name.text == *chart)
    }

    /// The variables of a chart; those of `left.Cycle` are declared in `Cycle`.
    pub(super) fn scope(&self, chart: &str) -> Option<&Scope<'d>> {
        let of_block = || {
            let (_, own) = chart.rsplit_once('.')?;
            self.charts.get(own).filter(|_| self.is_of_block(own))
        };
        self.charts.get(chart).or_else(of_block)
    }

    /// The charts that the variables of a declaration have; `chart` is the chart that declares them, in `env`.
    pub(super) fn charts_of(&mut self, v: &'d VarDecl, chart: Option<&Name>, env: &Env<'_, 'd>) -> Vec<Item> {
        let mut found = Vec::new();
        if v.of.as_ref().is_some_and(|of| self.holders.contains(&*of.text)) {
            for name in &v.names {
                let segment = Segment { name: name.clone(), index: Vec::new() };
                let spot = self.start(&segment, v, chart.cloned(), chart.map(|c| &*c.text));
                let dimensions = v.array.as_ref().map_or(Vec::new(), |a| a.dimensions.clone());
                self.instances(spot, &dimensions, env, &mut found);
            }
        }
        found.into_iter().flat_map(|(spot, chart)| self.chart_of_instance(&spot, chart)).collect()
    }

    /// Finds the instances in a variable, with the charts of each.
    fn instances(
        &mut self,
        spot: Spot<'d>,
        dimensions: &[(Expr, Expr)],
        env: &Env<'_, 'd>,
        found: &mut Vec<(Spot<'d>, &'d Chart)>,
    ) {
        let Some(of) = spot.of.filter(|of| self.holders.contains(&*of.name.text)) else { return };
        for own in self.indexes(dimensions, env).unwrap_or_default() {
            if !self.takes(1, spot.at) {
                return;
            }
            let spot = Spot { own, ..spot.clone() };
            let charts = self.owned.get(&*of.name.text).into_iter().flatten();
            found.extend(charts.map(|c| (spot.clone(), *c)));
            for member in of.members.iter().filter(|m| m.of.is_some()) {
                for name in &member.names {
                    let segment = Segment { name: name.clone(), index: Vec::new() };
                    if let Ok(inner) = self.step(spot.clone(), &segment) {
                        self.instances(inner, &bounds(of, member), env, found);
                    }
                }
            }
        }
    }

    /// A chart of one instance, the places on its drawing, and the charts of its own variables.
    fn chart_of_instance(&mut self, instance: &Spot<'d>, chart: &'d Chart) -> Vec<Item> {
        if !self.takes(1 + chart.items.len(), instance.at) {
            return Vec::new();
        }
        let Ok(name) = self.name_of_chart(instance.clone(), &chart.name.text) else { return Vec::new() };
        // The drawing of all instances is the one chart: problems and references lead there.
        let name = Name::new(name, chart.name.at.0);
        let env = Env::Chart {
            instance: instance.clone(),
            chart: &chart.name.text,
            full: &name,
            locals: Vec::new(),
            uncallable: None,
        };
        let made = self.chart(chart, &name, &env);
        let layouts = self.layouts.get(&*chart.name.text).into_iter().flatten();
        let layouts = layouts.map(|l| {
            let chart = Name::new(name.text.clone(), l.chart.at.0);
            Item::Layout(Layout { chart, ..(*l).clone() })
        });
        let mut items: Vec<Item> = layouts.chain([Item::Chart(made)]).collect();
        for v in chart.vars() {
            items.extend(self.charts_of(v, Some(&name), &env));
        }
        items
    }

    /// The name of a chart of an instance: `cell.gripper[2].Cycle`.
    fn name_of_chart(&mut self, instance: Spot<'d>, chart: &str) -> Result<String, Lost> {
        let prefix = instance.home.as_ref().map_or(String::new(), |home| format!("{home}."));
        let spot = self.entered(instance)?;
        Ok(format!("{prefix}{}.{chart}", self.numbered(&spot)?))
    }

    /// Puts the full name of a chart of an instance in the place of the path that leads to it: `left.Cycle`, or
    /// `Cycle` in the block itself. False if the path leads to none.
    pub(super) fn charted(&mut self, segments: &mut Vec<Segment>, env: &Env<'_, 'd>) -> Result<bool, Lost> {
        for count in self.chart_at(segments, env) {
            let (home, chart) = match segments.get(..count).and_then(<[Segment]>::split_last) {
                Some((chart, home)) => (home, chart.name.clone()),
                None => continue,
            };
            let at = at_of(home);
            let spot = if home.is_empty() { env.instance().cloned() } else { self.spot(home, env)? };
            let has = |of: &Composed| self.charts_named(of, &chart.text);
            let Some(spot) = spot.filter(|s| s.of.is_some_and(has)) else { continue };
            let at = if home.is_empty() { chart.at.0 } else { at.to(chart.at.0) };
            let name = Name::new(self.name_of_chart(spot, &chart.text)?, at);
            segments.splice(..count, [Segment { name, index: Vec::new() }]);
            return Ok(true);
        }
        Ok(false)
    }

    /// How many segments of a path can lead to a chart of an instance, as far as its names tell.
    fn chart_at(&self, segments: &[Segment], env: &Env<'_, 'd>) -> Vec<usize> {
        let Some(first) = segments.first().filter(|_| !self.owned.is_empty()) else { return Vec::new() };
        let own = env.instance().and_then(|i| i.of).is_some_and(|of| self.charts_named(of, &first.name.text));
        if own && first.index.is_empty() && self.base(&first.name.text, env).is_none() {
            return vec![1];
        }
        if !self.is_variable(&first.name.text, env) {
            return Vec::new();
        }
        let is_chart = |s: &Segment| s.index.is_empty() && self.is_of_block(&s.name.text);
        (2..=segments.len()).filter(|k| segments.get(k - 1).is_some_and(is_chart)).collect()
    }

    fn charts_named(&self, of: &Composed, name: &str) -> bool {
        self.owned.get(&*of.name.text).into_iter().flatten().any(|c| *c.name.text == *name)
    }

    /// Puts full names into the orders of a chart, and into its macro-steps.
    pub(super) fn chart_names(&mut self, chart: &mut Chart, env: &Env<'_, 'd>) {
        if !self.owned.is_empty() {
            visit_mut::chart(chart, &mut Orders { types: self, env });
        }
    }

    /// The full name of the chart that an order names: `Main.left.Cycle` for `left.Cycle` in `Main`. None if it is no chart
    /// of an instance.
    fn full_name(&mut self, name: &Name, env: &Env<'_, 'd>) -> Option<Name> {
        let mut segments: Vec<Segment> = name.text.split('.').map(|part| segment(part, name)).collect();
        let charted = self.charted(&mut segments, env).unwrap_or_default();
        match <[Segment; 1]>::try_from(segments) {
            Ok([only]) if charted => Some(Name { at: name.at, ..only.name }),
            _ => None,
        }
    }
}

/// A part of the name of a chart, `axis[3]`.
fn segment(part: &str, name: &Name) -> Segment {
    let number = |n: i64| Expr { kind: ExprKind::Literal(Literal::Int(n.into(), None)), at: name.at };
    let (text, index) = match instance_of(part) {
        Some((bare, Index::Number(n))) => (bare, vec![number(n)]),
        _ => (part, Vec::new()),
    };
    Segment { name: Name { text: text.into(), at: name.at }, index }
}

struct Orders<'o, 'e, 'd> {
    types: &'o mut Composition<'d>,
    env: &'o Env<'e, 'd>,
}

impl Visitor for Orders<'_, '_, '_> {
    fn chart_name(&mut self, name: &mut Name) {
        if let Some(full) = self.types.full_name(name, self.env) {
            *name = full;
        }
    }
}
