//! Turns the drawing of a unit into a chart, together with the charts of its macro-steps and of
//! those of its actions that are charts.

use std::collections::{HashMap, HashSet};

use g7_model::codes;
use g7_model::{
    Body, Chart, ChartItem, ChartKind, Expr, ExprKind, Layout, Name, NamedAction, PlaceAt, Placed, Step,
    StepKind, Transition, Type, VarKind, say,
};

use super::actions;
use super::bodies::Place;
use super::draft::{Draft, Maker, Order, block, guarded, kept, lacking};
use super::flow::{self, Way};
use super::graph::Graph;
use super::tree::{self, Language, Xml, documentation, head, kid, name_of, tag, text, word};
use crate::nodes::{self, Taken, line};
use crate::xml::attr;

impl<'a> Maker<'_, '_, '_, 'a> {
    /// Makes a chart, followed by the charts within it.
    pub(super) fn chart(&mut self, order: Order<'a>) {
        let Order { kind, name, unit, body, of, guard, vars, pre, every } = order;
        let graph = Graph::read(body, self.coder.report);
        let flow = flow::flow(&graph, self.coder.report);
        let at = self.coder.report.span(&head(of));
        let place = Place::of_unit(unit, Some(&name), true);
        let guard = guard.map(|g| nearer(g, &name));
        let mut draft = Draft {
            names: self.names(&graph, &flow.steps),
            graph: &graph,
            place,
            guard,
            unit,
            pre,
            items: vars.into_iter().map(ChartItem::Var).collect(),
            labels: HashSet::new(),
        };
        let index = self.made.charts.len();
        let comment = self.comment(&graph, of, kind);
        let chart_name =
            Name::new(name.as_str(), text(of, "name").map_or(at, |t| self.coder.report.span(&t.at)));
        let empty = Chart {
            kind,
            name: chart_name,
            params: Vec::new(),
            block: None,
            comment,
            every,
            items: Vec::new(),
            at: at.into(),
        };
        self.made.charts.push(empty);
        let ends = (kind == ChartKind::Expansion).then(|| ends(&flow.steps, &flow.ways));
        let mut places = Vec::new();
        for step in &flow.steps {
            places.extend(self.step(&mut draft, *step, ends));
        }
        let ways = in_order(&graph, flow.ways);
        let zero = self.numbers(&graph, &ways);
        for (number, way) in (0u32..).zip(&ways) {
            let item = self.transition(&mut draft, way, zero);
            if let Some(object) = graph.get(way.transition)
                && let Some((x, y)) = tree::place(object.node)
            {
                let at = self.coder.report.span(&head(object.node));
                places.push(placed(Placed::TransitionNumber(number), x, y, at));
            }
            draft.items.push(ChartItem::Transition(item));
        }
        self.strangers(&graph);
        actions::loose(self, &draft);
        if kind == ChartKind::Chart && tag(of) != "action" {
            self.named_actions(&mut draft);
        }
        self.finish(index, draft, places);
    }

    /// Makes a chart without a drawing: the variables and actions of a unit.
    pub(super) fn shell(&mut self, order: Order<'a>) {
        let graph = Graph::default();
        let at = self.coder.report.span(&head(order.of));
        let mut draft = Draft {
            names: HashMap::new(),
            graph: &graph,
            place: Place::of_unit(order.unit, Some(&order.name), true),
            guard: order.guard.map(|g| nearer(g, &order.name)),
            unit: order.unit,
            pre: order.pre,
            items: order.vars.into_iter().map(ChartItem::Var).collect(),
            labels: HashSet::new(),
        };
        let name_at = text(order.of, "name").map_or(at, |t| self.coder.report.span(&t.at));
        let index = self.made.charts.len();
        self.made.charts.push(Chart {
            kind: order.kind,
            name: Name::new(order.name, name_at),
            params: Vec::new(),
            block: None,
            comment: documentation(order.of).map(Into::into),
            every: order.every,
            items: Vec::new(),
            at: at.into(),
        });
        self.named_actions(&mut draft);
        self.finish(index, draft, Vec::new());
    }

    fn finish(&mut self, index: usize, draft: Draft, places: Vec<PlaceAt>) {
        let Some(chart) = self.made.charts.get_mut(index) else { return };
        chart.items = draft.items;
        if !draft.pre.is_empty() {
            chart.items.push(ChartItem::Pre(Body::St(block(draft.pre, chart.at.0)), chart.at));
        }
        // CODESYS writes every place as 0, 0.
        let drawn = places.iter().any(|p| p.x != 0 || p.y != 0);
        if drawn && places.len() > 1 {
            let layout = Layout { chart: chart.name.clone(), places, at: chart.at };
            self.made.layouts.push(layout);
        }
    }

    /// The names of steps; equal names are made different.
    fn names(&mut self, graph: &Graph, steps: &[usize]) -> HashMap<usize, String> {
        let mut names = HashMap::new();
        let mut taken = Taken::default();
        for index in steps {
            let Some(object) = graph.get(*index) else { continue };
            let wanted = name_of(object.node).unwrap_or_else(|| "Step".to_string());
            let name = taken.give(&wanted);
            if name != wanted || word(object.node, "name").is_none() {
                let what = if word(object.node, "name").is_none() {
                    say!("a step without a name; it is called `{name}`")
                } else {
                    say!("a second step is called `{wanted}`; it is renamed to `{name}`")
                };
                self.coder.say(&codes::RENAMED, object.node, what);
            }
            names.insert(*index, name);
        }
        names
    }

    /// The comment of a chart: its documentation, otherwise the notes in the drawing.
    fn comment(&mut self, graph: &Graph, of: Xml, kind: ChartKind) -> Option<Box<str>> {
        let mut texts: Vec<String> = Vec::new();
        if kind == ChartKind::Chart {
            texts.extend(documentation(of));
        }
        for object in graph.objects.iter().filter(|o| o.kind == "comment") {
            let content = kid(object.node, "content").map(attr::content).unwrap_or_default();
            texts.push(line(&content.text));
        }
        texts.retain(|t| !t.is_empty());
        (!texts.is_empty()).then(|| texts.join(" / ").into())
    }

    fn step(&mut self, draft: &mut Draft<'_, 'a>, index: usize, ends: Option<Ends>) -> Option<PlaceAt> {
        let object = draft.graph.get(index)?;
        let node = object.node;
        let at = self.coder.report.span(&head(node));
        let name_at = text(node, "name").map_or(at, |t| self.coder.report.span(&t.at));
        let name = Name::new(draft.names.get(&index)?.as_str(), name_at);
        let kind = match ends {
            _ if object.kind == "macroStep" => self.macro_step(draft, node, &name),
            Some(ends) if ends.entry == Some(index) => StepKind::Entry,
            Some(ends) if ends.exit == Some(index) => StepKind::Exit,
            _ => StepKind::Plain,
        };
        let initial = tree::flag(node, "initialStep") || tree::flag(node, "initial");
        let actions = actions::of_step(self, draft, index);
        let braces = !actions.is_empty();
        let entry = kind == StepKind::Entry;
        draft.items.push(ChartItem::Step(Step {
            name: name.clone(),
            kind,
            initial: initial && !entry,
            linked: false,
            comment: documentation(node).map(Into::into),
            actions,
            braces,
            at: at.into(),
        }));
        let (x, y) = tree::place(node)?;
        Some(placed(Placed::Step(name), x, y, at))
    }

    /// The expansion of a macro-step, made after the chart that uses it.
    fn macro_step(&mut self, draft: &Draft<'_, 'a>, node: Xml<'a>, name: &Name) -> StepKind {
        let Some((Language::Sfc, body)) = tree::body(node) else {
            let what = say!("the macro-step `{}` has no chart within it; it is a plain step", name.text);
            self.coder.say(&codes::BAD_MACRO, node, what);
            return StepKind::Plain;
        };
        let chart = self.charts.give(&name.text);
        self.chart(Order {
            kind: ChartKind::Expansion,
            name: chart.clone(),
            unit: draft.unit,
            body,
            of: node,
            guard: draft.guard.clone().map(|g| farther(g, draft)),
            vars: Vec::new(),
            pre: Vec::new(),
            every: None,
        });
        StepKind::Macro(Name::new(chart, name.at.0))
    }

    /// The number to add to written priorities: theirs may be 0, ours begin with 1. None if all are
    /// equal, because then nobody chose them.
    fn numbers(&mut self, graph: &Graph, ways: &[Way]) -> Option<u32> {
        let given = ways.iter().filter_map(|w| graph.get(w.transition)).map(|o| priority(o.node));
        let all: Vec<Option<u32>> = given.collect();
        let chosen = all.iter().flatten().any(|p| *p != 0);
        chosen.then(|| u32::from(all.contains(&Some(0))))
    }

    fn transition(&mut self, draft: &mut Draft<'_, 'a>, way: &Way, zero: Option<u32>) -> Transition {
        let names = |steps: &[usize], draft: &Draft| -> Vec<Name> {
            let named = |i: &usize| {
                let at = draft.graph.get(*i).map(|o| head(o.node)).unwrap_or_default();
                draft.names.get(i).map(|n| (n.clone(), at))
            };
            let found: Vec<(String, std::ops::Range<usize>)> = steps.iter().filter_map(named).collect();
            found.into_iter().map(|(n, at)| Name::new(n, self.coder.report.span(&at))).collect()
        };
        let (from, to) = (names(&way.from, draft), names(&way.to, draft));
        let Some(object) = draft.graph.get(way.transition) else {
            return empty_transition(from, to);
        };
        let node = object.node;
        let at = self.coder.report.span(&head(node));
        let mut receptivity = self.condition(draft, way.transition);
        if let Some(guard) = draft.guard.as_ref().and_then(|g| lacking(g, &receptivity)) {
            receptivity = nodes::and(guard, receptivity, at);
        }
        Transition {
            label: self.label(draft, node),
            from,
            to,
            receptivity,
            priority: zero.and_then(|z| priority(node).map(|p| p.saturating_add(z))),
            comment: documentation(node).map(Into::into),
            on_clearing: None,
            chained: false,
            at: at.into(),
        }
    }

    /// The name of an inline condition, which tools show beside the transition.
    fn label(&mut self, draft: &mut Draft, node: Xml) -> Option<Name> {
        let inline = kid(node, "condition").and_then(|c| kid(c, "inline"))?;
        let written = text(inline, "name")?;
        let name = line(&written.text);
        let fresh = !name.is_empty() && draft.labels.insert(name.to_uppercase());
        fresh.then(|| Name::new(name, self.coder.report.span(&written.at)))
    }

    /// The named actions of the unit.
    fn named_actions(&mut self, draft: &mut Draft<'_, 'a>) {
        let Some(pou) = self.coder.plan.pou(draft.unit) else { return };
        let actions: Vec<Xml<'a>> = pou.actions.clone();
        for node in actions {
            let Some(name) = name_of(node) else { continue };
            let at = self.coder.report.span(&head(node));
            match tree::body(node) {
                Some((Language::Sfc, body)) => self.sub_chart(draft, node, body, &name),
                Some((language, body)) => {
                    let statements = self.coder.body(language, body, &draft.place);
                    let statements = guarded(draft.guard.as_ref(), statements, at);
                    let comment = documentation(node).map(Into::into);
                    let name =
                        Name::new(name, text(node, "name").map_or(at, |t| self.coder.report.span(&t.at)));
                    let body = Body::St(block(statements, at));
                    draft.items.push(ChartItem::Action(NamedAction { name, comment, body, at: at.into() }));
                }
                None => {}
            }
        }
    }

    /// An action that is a chart: becomes a second chart that evolves while the action is active.
    fn sub_chart(&mut self, draft: &mut Draft<'_, 'a>, node: Xml<'a>, body: Xml<'a>, name: &str) {
        let at = self.coder.report.span(&head(node));
        let what = say!(
            "the action `{name}` is a chart; it is one beside the other, which evolves while the action is active"
        );
        self.coder.say(&codes::DIFFERENT, node, what);
        let owner = self.coder.plan.units.get(draft.unit).map(|u| u.chart.clone()).unwrap_or_default();
        let chart = self.charts.give(&format!("{owner}_{name}"));
        let flag = nodes::variable(VarKind::Var, name, Type::Bool, at);
        draft.items.insert(0, ChartItem::Var(flag));
        let active = nodes::name(&[&owner, name], at);
        let number = self.coder.plan.pou(draft.unit).and_then(|p| p.actions.iter().position(|a| *a == node));
        let guard = match self.guards.get(&(draft.unit, number)) {
            Some(called) => nodes::or(active, called.clone(), at),
            None => active,
        };
        let guard = match draft.guard.clone() {
            Some(outer) => nodes::and(farther(outer, draft), guard, at),
            None => guard,
        };
        self.chart(Order {
            kind: ChartKind::Chart,
            name: chart,
            unit: draft.unit,
            body,
            of: node,
            guard: Some(guard),
            vars: Vec::new(),
            pre: Vec::new(),
            every: None,
        });
    }

    /// Reports objects that have no meaning in a chart or belong to the network of no transition.
    fn strangers(&mut self, graph: &Graph) {
        for object in &graph.objects {
            match object.kind.as_str() {
                "step"
                | "macroStep"
                | "jumpStep"
                | "transition"
                | "selectionDivergence"
                | "selectionConvergence"
                | "simultaneousDivergence"
                | "simultaneousConvergence"
                | "actionBlock"
                | "comment"
                | "connector"
                | "continuation"
                | "inVariable"
                | "contact"
                | "leftPowerRail"
                | "rightPowerRail"
                | "block" => {}
                "coil" | "outVariable" | "inOutVariable" | "label" | "jump" | "return" => {
                    let what = say!("a `{}` in a chart, which belongs to no action", object.kind);
                    self.coder.say(&codes::NOT_CARRIED, object.node, what);
                }
                other => {
                    let what = say!("a `{other}` is not known");
                    self.coder.report.element(&codes::UNKNOWN_ELEMENT, other, &head(object.node), what);
                }
            }
        }
    }
}

/// The first and the last step of a chart within a macro-step.
#[derive(Clone, Copy)]
struct Ends {
    entry: Option<usize>,
    exit: Option<usize>,
}

fn ends(steps: &[usize], ways: &[Way]) -> Ends {
    let into = |s: &usize| ways.iter().any(|w| w.to.contains(s));
    let out = |s: &usize| ways.iter().any(|w| w.from.contains(s));
    let entry = steps.iter().copied().find(|s| !into(s)).or(steps.first().copied());
    let exit = steps.iter().copied().rev().find(|s| !out(s) && Some(*s) != entry);
    Ends { entry, exit }
}

/// Sorts the branches of a divergence from left to right, whatever the order in the file.
fn in_order(graph: &Graph, mut ways: Vec<Way>) -> Vec<Way> {
    let x = |way: &Way| graph.get(way.transition).and_then(|o| tree::place(o.node)).map(|p| p.0);
    let mut groups: HashMap<Vec<usize>, Vec<usize>> = HashMap::new();
    for (index, way) in ways.iter().enumerate() {
        groups.entry(way.from.clone()).or_default().push(index);
    }
    let mut groups: Vec<Vec<usize>> = groups.into_values().filter(|g| g.len() > 1).collect();
    groups.sort_unstable();
    for group in groups {
        let mut sorted: Vec<Way> = group.iter().filter_map(|i| ways.get(*i).cloned()).collect();
        sorted.sort_by_key(x);
        for (place, way) in group.iter().zip(sorted) {
            if let Some(slot) = ways.get_mut(*place) {
                *slot = way;
            }
        }
    }
    ways
}

fn priority(node: Xml) -> Option<u32> {
    word(node, "priority").and_then(|w| w.parse().ok())
}

fn placed(what: Placed, x: i32, y: i32, at: g7_model::Span) -> PlaceAt {
    PlaceAt { what, x, y, then: Vec::new(), at: at.into() }
}

fn empty_transition(from: Vec<Name>, to: Vec<Name>) -> Transition {
    Transition {
        label: None,
        from,
        to,
        receptivity: nodes::bad(Default::default()),
        priority: None,
        comment: None,
        on_clearing: None,
        chained: false,
        at: Default::default(),
    }
}

/// An expression within a chart: names of the chart's own variables without the chart's name.
fn nearer(mut expr: Expr, chart: &str) -> Expr {
    renamed(&mut expr, &|names| {
        if names.len() == 2 && names.first().is_some_and(|n| *n.text == *chart) {
            names.remove(0);
        }
    });
    expr
}

/// The reverse, for use in another chart: names preceded by the chart's name.
fn farther(mut expr: Expr, draft: &Draft) -> Expr {
    renamed(&mut expr, &|names| {
        if let ([only], Some(chart)) = (names.as_slice(), &draft.place.inside) {
            let at = only.at.0;
            names.insert(0, Name::new(chart.as_str(), at));
        }
    });
    expr
}

/// Changes the paths of a guard: names under NOT, AND and OR.
fn renamed(expr: &mut Expr, change: &dyn Fn(&mut Vec<Name>)) {
    match &mut expr.kind {
        ExprKind::Path(path) => change(&mut path.names),
        ExprKind::Unary(_, e) => renamed(e, change),
        ExprKind::Binary(_, a, b) => {
            renamed(a, change);
            renamed(b, change);
        }
        _ => {}
    }
}

/// True if the steps of a file name their actions without action blocks, as in CODESYS.
pub(super) fn without_blocks(root: Xml) -> bool {
    let named = |n: Xml| tag(n) == "step" && !kept(n).is_empty();
    let elements = || root.descendants().filter(roxmltree::Node::is_element);
    !elements().any(|n| tag(n) == "actionBlock") && elements().any(named)
}
