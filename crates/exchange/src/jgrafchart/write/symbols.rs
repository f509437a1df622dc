//! Symbols of the drawing: elements with their places, and lines between them.

use g7_draw::Options;
use g7_model::{Chart, Document, Item, PlaceAt, Placed};

use crate::jgrafchart::read::{STEP_AXIS, TRANSITION_AXIS};
use g7_iec::xml::element::Element;

/// Hundredths of the drawing's unit per pixel of JGrafchart.
const PER_PIXEL: i32 = 10;
/// The size of JGrafchart's step with its action block.
const STEP: (i32, i32) = (200, 70);
const MACRO: (i32, i32) = (60, 70);
const TRANSITION: (i32, i32) = (30, 25);
const EXCEPTION: (i32, i32) = (40, 30);
const BAR: (i32, i32) = (280, 15);
/// The distance from the middle of a bar to each of its branches.
const BRANCH: i32 = 110;

/// The most symbols of a chart that gets a layout; symbols of larger charts are placed one below
/// the other.
const MOST_DRAWN: usize = 2_000;
/// The distance between two of those.
const ROW: i32 = 1_500;

/// A point of the drawing, in pixels.
pub(super) type Spot = (i32, i32);

/// The places of a chart's symbols: their upper left corners.
pub(super) struct Places {
    pub(super) steps: Vec<Spot>,
    pub(super) transitions: Vec<Spot>,
    pub(super) comments: Vec<(String, Spot)>,
    /// The first free column to the right of the chart.
    pub(super) beside: i32,
}

impl Places {
    /// Places from the layout of the document, otherwise from the automatic layout.
    pub(super) fn of(document: &Document, chart: &Chart) -> Places {
        let mut given: Vec<&PlaceAt> = Vec::new();
        for item in &document.items {
            if let Item::Layout(l) = item
                && l.chart.text == chart.name.text
            {
                given.extend(&l.places);
            }
        }
        let mut steps = vec![None; chart.steps().count()];
        let mut transitions = vec![None; chart.transitions().count()];
        let mut comments = Vec::new();
        let numbers: std::collections::HashMap<&str, usize> =
            chart.steps().enumerate().map(|(n, s)| (&*s.name.text, n)).collect();
        for place in given {
            let at = (place.x, place.y);
            match &place.what {
                Placed::Step(name) => {
                    let slot = numbers.get(&*name.text).and_then(|n| steps.get_mut(*n));
                    slot.into_iter().for_each(|s| *s = Some(at));
                }
                Placed::Transition(label) => {
                    let number = chart.transitions().position(|t| t.label.as_ref() == Some(label));
                    let slot = number.and_then(|n| transitions.get_mut(n));
                    slot.into_iter().for_each(|s| *s = Some(at));
                }
                Placed::TransitionNumber(number) => {
                    let slot = usize::try_from(*number).ok().and_then(|n| transitions.get_mut(n));
                    slot.into_iter().for_each(|s| *s = Some(at));
                }
                Placed::Comment(text) => comments.push((text.to_string(), pixels(at, 0))),
                _ => {}
            }
        }
        if steps.len() + transitions.len() > MOST_DRAWN {
            let row = |n: usize| i32::try_from(n).unwrap_or(i32::MAX).saturating_mul(ROW);
            for (n, slot) in steps.iter_mut().enumerate() {
                slot.get_or_insert((0, row(n)));
            }
            for (n, slot) in transitions.iter_mut().enumerate() {
                slot.get_or_insert((ROW, row(n)));
            }
        } else if steps.iter().chain(&transitions).any(Option::is_none) {
            let sizes = g7_draw::measure(document, chart, &Options::default());
            let drawn = g7_draw::layout(chart, &sizes, &[]);
            let fill = |slots: &mut Vec<Option<Spot>>, points: &[g7_draw::Point]| {
                for (slot, p) in slots.iter_mut().zip(points) {
                    slot.get_or_insert((p.x, p.y));
                }
            };
            fill(&mut steps, &drawn.steps);
            fill(&mut transitions, &drawn.transitions);
        }
        let put = |list: Vec<Option<Spot>>, axis| -> Vec<Spot> {
            list.into_iter().map(|at| pixels(at.unwrap_or_default(), axis)).collect()
        };
        let (steps, transitions) = (put(steps, STEP_AXIS), put(transitions, TRANSITION_AXIS));
        let beside = steps.iter().map(|s| s.0).max().unwrap_or(0).saturating_add(STEP.0 + 100);
        Places { steps, transitions, comments, beside }
    }
}

fn pixels((x, y): Spot, axis: i32) -> Spot {
    ((x / PER_PIXEL).saturating_sub(axis), y / PER_PIXEL)
}

/// The points at which lines begin and end.
#[derive(Clone, Copy, Debug)]
pub(super) enum Port {
    /// Into a step.
    StepIn(Spot),
    /// Out of a step.
    StepOut(Spot),
    /// Into a macro-step.
    MacroIn(Spot),
    /// Out of a macro-step: the number of the exit and of all exits.
    MacroOut(Spot, usize, usize),
    /// At the left of a macro-step.
    MacroException(Spot),
    TransitionIn(Spot),
    TransitionOut(Spot),
    ExceptionIn(Spot),
    ExceptionOut(Spot),
    /// The single port of a bar: above a split, below a join.
    SplitIn(Spot),
    JoinOut(Spot),
    /// One of the two ports on the other side of a bar; true for the left one.
    SplitOut(Spot, bool),
    JoinIn(Spot, bool),
}

impl Port {
    fn spot(self) -> Spot {
        let side = |right: bool| if right { BRANCH } else { -BRANCH };
        let (at, dx, dy) = match self {
            Port::StepIn(at) => (at, STEP_AXIS, -1),
            Port::StepOut(at) => (at, STEP_AXIS, STEP.1 + 1),
            Port::MacroIn(at) => (at, MACRO.0 / 2, -1),
            Port::MacroOut(at, way, of) => {
                let share = |n: usize| i32::try_from(n).unwrap_or(i32::MAX);
                let dx = MACRO.0 / share(of).saturating_add(1).max(1);
                (at, dx.saturating_mul(share(way).saturating_add(1)), MACRO.1 + 1)
            }
            Port::MacroException(at) => (at, -1, MACRO.1 / 2),
            Port::TransitionIn(at) => (at, TRANSITION_AXIS, -1),
            Port::TransitionOut(at) => (at, TRANSITION_AXIS, TRANSITION.1 + 1),
            Port::ExceptionIn(at) => (at, EXCEPTION.0 + 1, EXCEPTION.1 / 2),
            Port::ExceptionOut(at) => (at, -1, EXCEPTION.1 / 2),
            Port::SplitIn(at) => (at, BAR.0 / 2, -1),
            Port::JoinOut(at) => (at, BAR.0 / 2, BAR.1 + 1),
            Port::SplitOut(at, right) => (at, BAR.0 / 2 + side(right), BAR.1 + 1),
            Port::JoinIn(at, right) => (at, BAR.0 / 2 + side(right), -1),
        };
        (at.0.saturating_add(dx), at.1.saturating_add(dy))
    }
}

/// Gives an element its size and place.
pub(super) fn placed(element: Element, (x, y): Spot, (width, height): (i32, i32)) -> Element {
    element.with("width", width).with("height", height).with("x", x).with("y", y)
}

/// A step with its action block, or a macro-step.
pub(super) fn step(element: Element, at: Spot) -> Element {
    placed(element, at, STEP)
}

pub(super) fn macro_step(element: Element, at: Spot) -> Element {
    placed(element, at, MACRO)
}

/// A transition; an exception transition lies at the left of its place.
pub(super) fn transition(element: Element, at: Spot, exception: bool) -> Element {
    placed(element, at, if exception { EXCEPTION } else { TRANSITION })
}

/// The place of the nth parallel split below a transition, or of the nth join above it.
pub(super) fn bar_place(transition: Spot, nth: usize, join: bool) -> Spot {
    let way = i32::try_from(nth).unwrap_or(i32::MAX).saturating_mul(20).saturating_add(30);
    let y = if join { transition.1.saturating_sub(way) } else { transition.1.saturating_add(way) };
    (transition.0.saturating_add(TRANSITION_AXIS - BAR.0 / 2), y)
}

pub(super) fn bar(element: Element, at: Spot) -> Element {
    placed(element, at, BAR)
}

/// A line: down, across, down.
pub(super) fn link(from: &str, to: &str, ports: (Port, Port)) -> Element {
    let ((x, y), (u, v)) = (ports.0.spot(), ports.1.spot());
    let middle = y.saturating_add(v) / 2;
    let corners =
        [(x, y), (x, y.saturating_add(10)), (x, middle), (u, middle), (u, v.saturating_sub(10)), (u, v)];
    let stroke = |(x, y): Spot| Element::new("Stroke").with("x", x).with("y", y);
    Element::new("GCLink")
        .with("fromObject", from)
        .with("manAdj", 0)
        .with("toObject", to)
        .children(corners.map(stroke))
}
