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
use super::paths::{Lost, member};
use super::types::defined_twice;
use crate::visit_mut::{self, Visitor};
use crate::{
    Chart, Composed, Document, Expr, ExprKind, Index, Item, Layout, Literal, Name, Path, Problem, VarDecl,
    codes, instance_of, say,
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
        let types = std::mem::take(&mut self.types);
        self.owned.retain(|name, _| types.get(name).is_some_and(|t| t.block));
        self.types = types;
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

    /// Finds the types whose variables have charts, in themselves or in their members.
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
        // A variable of a chart of a block is a variable of each instance.
        let of_charts = |charts: &Vec<&'d Chart>| charts.iter().any(|c| c.vars().any(|v| v.of.is_some()));
        self.nested = self.owned.values().any(of_charts);
        self.holders = holders;
    }

    /// True for a chart of a function block, which runs as the charts of its instances.
    pub(super) fn is_of_block(&self, chart: &Name) -> bool {
        self.owned.values().flatten().any(|c| c.name.text == chart.text)
    }

    /// The variables of a chart; those of `left.Cycle` are declared in `Cycle`.
    pub(super) fn scope(&self, chart: &str) -> Option<&Scope<'d>> {
        let of_block = || {
            let (_, own) = chart.rsplit_once('.')?;
            let owned = self.owned.values().flatten().any(|c| *c.name.text == *own);
            self.charts.get(own).filter(|_| owned)
        };
        self.charts.get(chart).or_else(of_block)
    }

    /// The charts that the variables of a declaration have; `chart` is the chart that declares them, in `env`.
    pub(super) fn charts_of(&mut self, v: &'d VarDecl, chart: Option<&Name>, env: &Env<'_, 'd>) -> Vec<Item> {
        let mut found = Vec::new();
        if v.of.as_ref().is_some_and(|of| self.holders.contains(&*of.text)) {
            for name in &v.names {
                let segment = Segment { name: name.clone(), index: Vec::new() };
                let spot = self.start(&segment, v, chart.cloned());
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
        let Ok(home) = self.entered(instance.clone()).and_then(|spot| self.numbered(&spot)) else {
            return Vec::new();
        };
        let prefix = instance.chart.as_ref().map_or(String::new(), |c| format!("{}.", c.text));
        // The drawing of all instances is the one chart: problems and references lead there.
        let name = Name::new(format!("{prefix}{home}.{}", chart.name.text), chart.name.at.0);
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
        if self.nested {
            for v in chart.vars() {
                items.extend(self.charts_of(v, Some(&name), &env));
            }
        }
        items
    }

    /// Puts the full name of a chart of an instance in the place of the path that leads to it: `left.Cycle`, or
    /// `Cycle` in the block itself. False if the path leads to none.
    pub(super) fn charted(&mut self, segments: &mut Vec<Segment>, env: &Env<'_, 'd>) -> Result<bool, Lost> {
        let Some(count) = self.chart_at(segments, env) else { return Ok(false) };
        let Some(own) = count.checked_sub(1).and_then(|k| segments.get(k)).map(|s| s.name.clone()) else {
            return Ok(false);
        };
        let (spot, env) = match segments.get(..count - 1).unwrap_or_default() {
            [] => (env.instance().cloned(), env.around()),
            home => (self.spot(home, env)?, env),
        };
        let has = |of: &&Composed| self.charts_named(of, &own.text);
        let Some(spot) = spot.filter(|s| s.of.as_ref().is_some_and(has)) else { return Ok(false) };
        let prefix = match &spot.chart {
            Some(chart) => format!("{}.", chart.text),
            None => self.declaring(&spot.text, env).map_or(String::new(), |c| format!("{c}.")),
        };
        let entered = self.entered(spot)?;
        let text = format!("{prefix}{}.{}", self.numbered(&entered)?, own.text);
        let at = entered.at.to(own.at.0);
        segments.splice(..count, [Segment { name: Name::new(text, at), index: Vec::new() }]);
        Ok(true)
    }

    /// How many segments of a path lead to a chart of an instance, as far as its names tell.
    fn chart_at(&self, segments: &[Segment], env: &Env<'_, 'd>) -> Option<usize> {
        if self.owned.is_empty() {
            return None;
        }
        let first = segments.first()?;
        let own = env.instance().and_then(|i| i.of).is_some_and(|of| self.charts_named(of, &first.name.text));
        if own && first.index.is_empty() {
            return Some(1);
        }
        let known = self.is_variable(&first.name.text, env);
        let is_chart = |s: &Segment| {
            s.index.is_empty() && self.owned.values().flatten().any(|c| c.name.text == s.name.text)
        };
        let place = segments.iter().skip(1).position(is_chart).filter(|_| known)?;
        Some(place + 2)
    }

    fn charts_named(&self, of: &Composed, name: &str) -> bool {
        self.owned.get(&*of.name.text).into_iter().flatten().any(|c| *c.name.text == *name)
    }

    /// The chart in hand, if it declares the variable with which a name begins.
    fn declaring<'e>(&self, text: &str, env: &'e Env<'_, 'd>) -> Option<&'e str> {
        let first = text.split(['.', '[']).next().unwrap_or_default();
        let (chart, locals) = env.root();
        let own = self.scope(chart?)?.contains_key(first) && !locals.iter().any(|l| **l == *first);
        env.home().filter(|_| own)
    }

    /// The path to a step of a chart of an instance, or to the chart; None for other paths.
    pub(super) fn step_path(&mut self, e: &Expr, env: &Env<'_, 'd>) -> Result<Option<ExprKind>, Lost> {
        if self.owned.is_empty() {
            return Ok(None);
        }
        let (path, index) = match &e.kind {
            ExprKind::Path(path) => (path, &[][..]),
            ExprKind::Element(path, index, None) => (&**path, index.as_slice()),
            _ => return Ok(None),
        };
        let mut segments = self.segments(path, index, env);
        self.indexed(&mut segments, env);
        if !self.charted(&mut segments, env)? {
            return Ok(None);
        }
        let of_chart = |chart: &Segment, name: &Segment| {
            self.scope(&chart.name.text).is_some_and(|scope| scope.contains_key(&*name.name.text))
        };
        if let [chart, second, ..] = segments.as_slice()
            && of_chart(chart, second)
        {
            return Ok(None);
        }
        let index: Vec<Expr> = segments.iter().flat_map(|s| s.index.iter().cloned()).collect();
        let path = Path { names: segments.into_iter().map(|s| s.name).collect() };
        Ok(Some(match index.is_empty() {
            true => ExprKind::Path(path),
            false => ExprKind::Element(Box::new(path), index, None),
        }))
    }

    /// Puts full names into the orders of a chart, and into its macro-steps.
    pub(super) fn chart_names(&mut self, chart: &mut Chart, env: &Env<'_, 'd>) {
        if !self.owned.is_empty() {
            visit_mut::chart(chart, &mut Orders { types: self, env });
        }
    }

    /// The full name of a chart that an order names, if it is one of an instance.
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
