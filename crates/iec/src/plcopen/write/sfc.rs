//! Writes a chart as the objects of an SFC body, connected by wires that are stored backwards.

use std::collections::HashMap;

use g7_model::codes;
use g7_model::{
    Action, ActionKind, Chart, ChartItem, Document, Expr, ExprKind, Item, Literal, Problem, Said, Step,
    StepKind, Target, Transition, Work, say,
};

use super::codesys::attribute;
use super::place::Places;
use crate::plcopen::Dialect;
use crate::st::Writer;
use crate::xml::element::Element;

const STEP: (f64, f64) = (60.0, 30.0);
const TRANSITION: (f64, f64) = (20.0, 2.0);
const ACTION: (f64, f64) = (120.0, 20.0);

/// Writes the bodies of one program.
pub(super) struct Sfc<'a> {
    pub(super) document: &'a Document,
    /// The chart that is the program. Its sections are visible in its macro-steps too.
    pub(super) chart: &'a Chart,
    pub(super) writer: Writer<'a>,
    pub(super) problems: &'a mut Vec<Problem>,
    pub(super) dialect: Dialect,
    /// True if the bodies of steps stand beside them without qualifiers, as CODESYS has them.
    pub(super) bare: bool,
    pub(super) next: u64,
}

/// The identifier of the object where a wire begins.
type Id = u64;

/// The objects of a drawing so far.
struct Drawing<'d> {
    chart: &'d Chart,
    places: Places,
    objects: Vec<Element>,
    /// The object at which the flow behind each step begins: the step itself or the divergence
    /// behind it.
    out: HashMap<String, Id>,
    /// The steps themselves.
    steps: HashMap<String, Id>,
    /// The objects that lead to each step.
    into: HashMap<String, Vec<Id>>,
}

impl Sfc<'_> {
    fn id(&mut self) -> Id {
        self.next += 1;
        self.next
    }

    /// The body of a chart or of the expansion of a macro-step.
    pub(super) fn body(&mut self, chart: &Chart, depth: usize) -> Element {
        let mut drawing = Drawing {
            chart,
            places: Places::of(self.document, chart),
            objects: Vec::new(),
            out: HashMap::new(),
            steps: HashMap::new(),
            into: HashMap::new(),
        };
        // Identifiers come first, because wires lead forward and backward.
        let steps: Vec<(Id, &Step)> = chart.steps().map(|s| (self.id(), s)).collect();
        let ways: Vec<(Id, &Transition)> = chart.transitions().map(|t| (self.id(), t)).collect();
        for (id, step) in &steps {
            drawing.out.insert(step.name.text.to_string(), *id);
            drawing.steps.insert(step.name.text.to_string(), *id);
        }
        self.divergences(&mut drawing);
        for (number, (id, transition)) in ways.iter().enumerate() {
            self.transition(&mut drawing, number, *id, transition);
        }
        let rows: HashMap<&str, f64> =
            chart.steps().map(|s| (&*s.name.text, drawing.places.step(&s.name.text).1)).collect();
        for (id, step) in &steps {
            self.step(&mut drawing, *id, step, &rows, depth);
        }
        let body = Element::new("SFC").children(drawing.objects);
        // CODESYS places all symbols itself, and its own files have no places.
        let placed = self.document.items.iter().any(|i| matches!(i, Item::Layout(_)));
        if self.dialect == Dialect::Codesys && !placed { body.unplaced() } else { body }
    }

    /// Puts a bar behind each step with several transitions.
    fn divergences(&mut self, drawing: &mut Drawing) {
        for step in drawing.chart.steps() {
            let name = &step.name.text;
            // Beremiz follows no wire from a convergence to a divergence: there a transition behind
            // several steps is connected to each of them.
            let joint = |t: &&Transition| self.dialect.is_of_matiec() && t.from.len() > 1;
            let from_here = |t: &&Transition| t.from.iter().any(|n| n.text == *name);
            let behind = drawing.chart.transitions().filter(from_here).filter(|t| !joint(t)).count();
            if behind < 2 {
                continue;
            }
            let id = self.id();
            let from = drawing.out.insert(name.to_string(), id).unwrap_or(id);
            let (x, y) = drawing.places.step(name);
            let bar = object("selectionDivergence", id, (x, y + STEP.1 + 10.0), (ACTION.0, 1.0))
                .child(input(&[from]))
                .children(
                    (0..behind).map(|_| Element::new("connectionPointOut").with("formalParameter", "")),
                );
            drawing.objects.push(bar);
        }
    }

    fn transition(&mut self, drawing: &mut Drawing, number: usize, id: Id, transition: &Transition) {
        let place = drawing.places.transition(number);
        let own = self.dialect.is_of_matiec() && transition.from.len() > 1;
        let out = if own { &drawing.steps } else { &drawing.out };
        let from: Vec<Id> = transition.from.iter().filter_map(|n| out.get(&*n.text).copied()).collect();
        let before = match from.as_slice() {
            [] => None,
            [one] => Some(*one),
            several => {
                let bar = self.id();
                let inputs: Vec<Element> = several.iter().map(|s| input(&[*s])).collect();
                drawing.objects.push(
                    object("simultaneousConvergence", bar, (place.0, place.1 - 10.0), (ACTION.0, 3.0))
                        .children(inputs)
                        .child(Element::new("connectionPointOut")),
                );
                Some(bar)
            }
        };
        let mut element = object("transition", id, place, TRANSITION);
        if let Some(priority) = self.priority(drawing.chart, number, transition) {
            element = element.with("priority", priority);
        }
        element = element
            .child(before.map_or_else(|| Element::new("connectionPointIn"), |b| input(&[b])))
            .child(Element::new("connectionPointOut"))
            .child(self.condition(transition));
        if let Some(comment) = &transition.comment {
            element.push(Element::formatted("documentation", comment));
        }
        drawing.objects.push(element);
        let mut behind = id;
        if transition.to.len() > 1 {
            behind = self.id();
            let bar = object("simultaneousDivergence", behind, (place.0, place.1 + 10.0), (ACTION.0, 3.0))
                .child(input(&[id]))
                .children(
                    transition
                        .to
                        .iter()
                        .map(|_| Element::new("connectionPointOut").with("formalParameter", "")),
                );
            drawing.objects.push(bar);
        }
        for step in &transition.to {
            drawing.into.entry(step.text.to_string()).or_default().push(behind);
        }
        // A jump replaces a line that would lead back up.
        let row = drawing.places.step(transition.from.first().map_or("", |n| &n.text)).1;
        for step in transition.to.iter().filter(|_| !transition.from.is_empty()) {
            let place = drawing.places.step(&step.text);
            let into = |t: &&Transition| t.to.iter().any(|n| n.text == step.text);
            let several = || drawing.chart.transitions().filter(into).count() > 1;
            // Nor does Beremiz follow a wire from a divergence to a convergence.
            let chained = self.dialect.is_of_matiec() && transition.to.len() > 1 && several();
            if place.1 <= row || chained {
                if let Some(into) = drawing.into.get_mut(&*step.text) {
                    into.pop();
                }
                let jump = self.id();
                let at = drawing.places.transition(number);
                drawing.objects.push(
                    object("jumpStep", jump, (at.0, at.1 + 20.0), TRANSITION)
                        .with("targetName", &step.text)
                        .child(input(&[behind])),
                );
            }
        }
    }

    /// The priority of a transition. Beremiz and OpenPLC know the order of branches by priorities
    /// alone; there they have one where a step before the transition has several.
    fn priority(&self, chart: &Chart, number: usize, transition: &Transition) -> Option<u32> {
        let shares =
            |t: &&Transition| t.from.iter().any(|n| transition.from.iter().any(|m| n.text == m.text));
        if !self.dialect.is_of_matiec() || chart.transitions().filter(shares).count() < 2 {
            return transition.priority;
        }
        let of = |(i, t): (usize, &Transition)| (t.priority.unwrap_or(u32::MAX), i);
        let own = (transition.priority.unwrap_or(u32::MAX), number);
        let rank = chart.transitions().enumerate().map(of).filter(|other| *other < own).count();
        u32::try_from(rank + 1).ok()
    }

    fn condition(&self, transition: &Transition) -> Element {
        let condition = Element::new("condition");
        if let Some(name) = self.section(&transition.receptivity) {
            return condition.child(Element::new("reference").with("name", name));
        }
        let text = self.writer.condition(&transition.receptivity);
        let label = transition.label.as_ref().map(|l| l.text.to_string()).unwrap_or_default();
        condition.child(Element::new("inline").with("name", label).child(Element::formatted("ST", &text)))
    }

    /// The name of the section, if the receptivity is one.
    fn section<'e>(&self, receptivity: &'e Expr) -> Option<&'e str> {
        let ExprKind::Path(path) = &receptivity.kind else { return None };
        let [name] = path.names.as_slice() else { return None };
        let is = |c: &Chart| {
            c.items.iter().any(|i| matches!(i, ChartItem::Section(s) if s.name.text == name.text))
        };
        let expansions = self.document.charts().filter(|c| c.kind == g7_model::ChartKind::Expansion);
        std::iter::once(self.chart).chain(expansions).any(is).then_some(&*name.text)
    }

    fn step(&mut self, drawing: &mut Drawing, id: Id, step: &Step, rows: &HashMap<&str, f64>, depth: usize) {
        let place = drawing.places.step(&step.name.text);
        let name = &step.name.text;
        let into = drawing.into.remove(&*step.name.text).unwrap_or_default();
        let into = match into.len() {
            0 | 1 => into,
            _ => {
                let bar = self.id();
                let inputs: Vec<Element> = into.iter().map(|s| input(&[*s])).collect();
                let at = (place.0, rows.get(&*step.name.text).copied().unwrap_or(place.1) - 10.0);
                drawing.objects.push(
                    object("selectionConvergence", bar, at, (ACTION.0, 1.0))
                        .children(inputs)
                        .child(Element::new("connectionPointOut")),
                );
                vec![bar]
            }
        };
        let entry = into.is_empty();
        let expansion = match &step.kind {
            StepKind::Macro(expansion) => self.document.charts().find(|c| c.name.text == expansion.text),
            StepKind::Plain | StepKind::Entry | StepKind::Exit | StepKind::Enclosing => None,
        };
        if let StepKind::Macro(_) = step.kind {
            let mut element = object("macroStep", id, place, STEP).with("name", name);
            element =
                element.children((!entry).then(|| input(&into))).child(Element::new("connectionPointOut"));
            if let Some(chart) = expansion.filter(|_| depth < 20) {
                element.push(Element::new("body").child(self.body(chart, depth + 1)));
            }
            drawing.objects.push(documented(element, step));
        } else {
            let mut element = object("step", id, place, STEP).with("name", name);
            if step.initial || step.kind == StepKind::Entry {
                element = element.with("initialStep", true);
            }
            element = element
                .children((!entry).then(|| input(&into)))
                .child(Element::new("connectionPointOut").with("formalParameter", ""));
            if self.bare {
                element = element.children(bodies(step));
            } else if step.actions.iter().any(is_action) {
                element.push(Element::new("connectionPointOutAction").with("formalParameter", ""));
            }
            drawing.objects.push(documented(element, step));
        }
        if !self.bare {
            self.block(drawing, id, step, place);
        }
    }

    /// The action block of a step.
    fn block(&mut self, drawing: &mut Drawing, step_id: Id, step: &Step, place: (f64, f64)) {
        let actions: Vec<Element> = step.actions.iter().filter_map(|a| self.action(a)).collect();
        if actions.is_empty() {
            return;
        }
        let id = self.id();
        let height = ACTION.1 * f64::from(u32::try_from(actions.len()).unwrap_or(1));
        let at = (place.0 + STEP.0 + ACTION.0 / 2.0, place.1);
        let block = object("actionBlock", id, at, (ACTION.0, height));
        drawing.objects.push(block.child(input(&[step_id])).children(actions));
    }

    fn action(&mut self, action: &Action) -> Option<Element> {
        let (qualifier, time, target) = match &action.kind {
            ActionKind::Qualified { qualifier, time, target, .. } => (qualifier, time, target),
            ActionKind::Comment(text) => {
                let what = say!("the comment \"{}\" beside a step", Said::foreign(text.as_ref()));
                self.problems.push(Problem::new(&codes::LEFT_OUT, action.at.0, what));
                return None;
            }
            ActionKind::EachScan { .. } | ActionKind::OnEvent { .. } | ActionKind::Order(_) => return None,
        };
        let id = self.id();
        let mut element = Element::new("action").with("localId", id).with("qualifier", qualifier.name());
        if let Some(time) = time {
            element = element.with("duration", self.time(time));
        }
        let what = match target {
            Target::Path(path) => Element::new("reference").with("name", path.text()),
            Target::Direct(address, _) => Element::new("reference").with("name", format!("%{address}")),
            Target::Element(element) => Element::new("reference").with("name", self.writer.plain(element)),
            Target::Work(work) => self.inline(work),
        };
        let place = Element::new("relPosition").with("x", 0).with("y", 0);
        Some(element.child(place).child(what))
    }

    fn time(&self, e: &Expr) -> String {
        match &e.kind {
            ExprKind::Literal(Literal::Time(time)) => format!("{time:#}"),
            _ => self.writer.plain(e),
        }
    }

    fn inline(&self, work: &Work) -> Element {
        Element::new("inline").child(Element::formatted("ST", &self.writer.body(work.statements())))
    }
}

/// The attributes by which CODESYS stores the bodies of a step.
fn bodies(step: &Step) -> Option<Element> {
    let attributes: Vec<Element> = step
        .actions
        .iter()
        .filter_map(|a| match &a.kind {
            ActionKind::Qualified { qualifier, target: Target::Path(path), .. } => {
                Some(Element::with_text("attribute", &path.text()).with("guid", attribute(*qualifier)?))
            }
            _ => None,
        })
        .collect();
    if attributes.is_empty() {
        return None;
    }
    let data = Element::new("data")
        .with("name", "http://www.3s-software.com/plcopenxml/sfc/element")
        .with("handleUnknown", "implementation");
    let all = Element::new("attributes").with("xmlns", "").children(attributes);
    Some(Element::new("addData").child(data.child(all)))
}

fn is_action(action: &Action) -> bool {
    matches!(action.kind, ActionKind::Qualified { .. })
}

/// An object; its place is the middle of its upper side.
fn object(tag: &str, id: Id, at: (f64, f64), size: (f64, f64)) -> Element {
    let position = Element::new("position").with("x", at.0 - size.0 / 2.0).with("y", at.1);
    Element::new(tag).with("localId", id).with("height", size.1).with("width", size.0).child(position)
}

fn input(from: &[Id]) -> Element {
    let wires = from.iter().map(|id| Element::new("connection").with("refLocalId", id));
    Element::new("connectionPointIn").children(wires)
}

fn documented(mut element: Element, step: &Step) -> Element {
    if let Some(comment) = &step.comment {
        element.push(Element::formatted("documentation", comment));
    }
    element
}
