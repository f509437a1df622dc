//! Writes the drawing of a chart.

use g7_iec::xml::element::Element;
use g7_model::{Chart, Name, Step, StepKind, codes, say};

use super::Writer;
use super::lay::{self, Bar, Grid, Kind, Link};
use super::plan::{Plan, Undrawn};
use crate::controlexpert::read::Spot;
use crate::flow::Ends;

impl<'d> Writer<'d> {
    /// The drawing of a chart; None, with a problem reported, if the grid cannot hold it.
    pub(super) fn network(&mut self, index: usize) -> Option<Element> {
        let chart = self.speech.scopes.chart(index)?;
        let plan = self.plan(index, chart)?;
        let grid = lay::grid(&plan);
        let mut network = Element::new("networkSFC");
        for ((key, step), spot) in self.speech.scopes.steps_of(index).zip(&grid.steps) {
            let step = self.step(key, step, *spot);
            network.push(step);
        }
        for kind in [Kind::ParBranch, Kind::ParJoint, Kind::AltBranch, Kind::AltJoint] {
            network.extend(grid.bars.iter().filter(|b| b.kind == kind).map(bar));
        }
        for (transition, spot) in chart.transitions().zip(&grid.transitions) {
            let mut element = Element::new("transition").child(place(*spot));
            element.push(self.receptivity(index, transition));
            element.extend(transition.comment.iter().map(|c| Element::with_text("comment", c)));
            network.push(element);
            if transition.label.is_some() {
                self.speech.leave_out(transition.at, say!("the label of a transition"));
            }
            if let Some(block) = &transition.on_clearing {
                self.speech.cannot(block.at, say!("an action on clearing"));
            }
        }
        for (step, spot) in &grid.jumps {
            let name = self.speech.names.step((index, *step));
            network.push(Element::new("jumpSFC").with("stepName", name).child(place(*spot)));
        }
        network.extend(grid.links.iter().map(link));
        network.extend(chart.comment.iter().map(|text| text_box(text, &grid)));
        Some(network)
    }

    /// The structure of a chart.
    fn plan(&mut self, index: usize, chart: &'d Chart) -> Option<Plan> {
        let numbers = |scopes: &g7_iec::scopes::Scopes, names: &[Name]| {
            let mut list = Vec::new();
            for step in names.iter().filter_map(|n| scopes.step_in(index, &n.text)) {
                if !list.contains(&step.1) {
                    list.push(step.1);
                }
            }
            list
        };
        let scopes = &self.speech.scopes;
        let ends =
            |t: &g7_model::Transition| Ends { from: numbers(scopes, &t.from), to: numbers(scopes, &t.to) };
        let transitions: Vec<Ends> = chart.transitions().map(ends).collect();
        let ranks: Vec<(u32, usize)> =
            chart.transitions().enumerate().map(|(i, t)| (t.priority.unwrap_or(u32::MAX), i)).collect();
        let begins = |(_, s): &(usize, &Step)| s.initial || s.kind == StepKind::Entry;
        let first = chart.steps().enumerate().filter(begins).map(|(i, _)| i).collect();
        match Plan::new(chart.steps().count(), transitions, &ranks, first) {
            Ok(plan) => Some(plan),
            Err(wrong) => {
                wrong.into_iter().for_each(|w| self.undrawn(chart, w));
                None
            }
        }
    }

    fn undrawn(&mut self, chart: &Chart, wrong: Undrawn) {
        let (Undrawn::Source(number)
        | Undrawn::Sink(number)
        | Undrawn::Joined(number, _)
        | Undrawn::Parted(number, _)) = wrong;
        let Some(transition) = chart.transitions().nth(number) else { return };
        let name = |step: usize| chart.steps().nth(step).map_or("", |s| &*s.name.text);
        let at = transition.at;
        match wrong {
            Undrawn::Source(_) => self.speech.cannot(at, say!("a transition without a step before it")),
            Undrawn::Sink(_) => self.speech.cannot(at, say!("a transition without a step behind it")),
            Undrawn::Joined(_, step) => {
                let what = say!(
                    "a transition behind several steps, where `{}` has another one besides: on the grid the joint stands directly below its steps",
                    name(step)
                );
                self.speech.say(&codes::NOT_CARRIED, at, what);
            }
            Undrawn::Parted(_, step) => {
                let what = say!(
                    "a transition before several steps, where `{}` begins other branches too: on the grid the branch stands directly above its steps",
                    name(step)
                );
                self.speech.say(&codes::NOT_CARRIED, at, what);
            }
        }
    }

    fn step(&mut self, key: (usize, usize), step: &'d Step, spot: Spot) -> Element {
        let sort = match &step.kind {
            StepKind::Macro(_) => "macroStep",
            StepKind::Entry => "inStep",
            StepKind::Exit => "outStep",
            StepKind::Plain | StepKind::Enclosing if step.initial => "initialStep",
            StepKind::Plain | StepKind::Enclosing => "step",
        };
        let name = self.speech.names.step(key).to_string();
        let mut element =
            Element::new("step").with("stepType", sort).with("stepName", name).child(place(spot));
        element.extend(self.actions(key, &step.actions));
        element.push(Element::new("literals").with("max", "").with("min", "").with("delay", ""));
        element.extend(step.comment.iter().map(|c| Element::with_text("comment", c)));
        element
    }
}

fn place((x, y): Spot) -> Element {
    Element::new("objPosition").with("posX", x).with("posY", y)
}

fn bar(bar: &Bar) -> Element {
    Element::new(bar.kind.word()).with("width", bar.width).with("relativePos", 0).child(place(bar.at))
}

/// A link with its corners, in the middle between two columns.
fn link(link: &Link) -> Element {
    let ((from, start), (to, end)) = (link.from, link.to);
    let directed = |tag: &str, kind: Kind, spot: Spot| {
        Element::new(tag).with("objectType", kind.word()).child(place(spot))
    };
    // A joint is entered at the lower edge of its row.
    let row = if matches!(to, Kind::ParJoint | Kind::AltJoint) { end.1 + 1 } else { end.1 };
    let aside = if row <= start.1 { end.0 } else { start.0 + 1 };
    let middle = |column: i32| format!("{column}.5");
    let mut corners = vec![(middle(start.0), start.1 + 1)];
    if row <= start.1 {
        corners.extend([(format!("{aside}"), start.1 + 1), (format!("{aside}"), row)]);
    }
    corners.push((middle(end.0), row));
    let corners =
        corners.into_iter().map(|(x, y)| Element::new("gridObjPosition").with("posX", x).with("posY", y));
    Element::new("linkSFC")
        .child(directed("directedLinkSource", from, start))
        .child(directed("directedLinkDestination", to, end))
        .children(corners)
}

/// The comment of a chart, beside the drawing.
fn text_box(text: &str, grid: &Grid) -> Element {
    Element::with_text("textBox", text)
        .with("width", 2)
        .with("height", 1)
        .child(place((grid.right + 1, 0)))
        .on_one_line()
}
