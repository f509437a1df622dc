//! Automatic layout of a chart.
//!
//! # Where this sits
//!
//! ```text
//! Chart -> adrift, graph -> reduce -> tree -> shape, beside -> place -> route -> Placement
//!                                            \-> moved -> unbroken -> bends -/  (layout section)
//! ```
//!
//! A GRAFCET nearly always consists of sequences with branches in them. The graph is therefore
//! reduced to a tree of sequences and branches; widths and heights are computed from the inside
//! out, places from the outside in. A sequence that ends or begins by itself hangs beside the
//! sequence it belongs to, loops go up at the left, and only a link that fits nowhere is broken and
//! named at both ends.
//!
//! # Invariants
//!
//! The same chart and sizes give the same placement; no order depends on a hash.
//! - No recursion: depth costs memory only.
//! - Where nothing is placed by hand, no symbol, text, double line or connector
//!   overlaps another and no link runs through one.
//! - Each link of the chart is in `links` once or in `connectors` twice.

mod adrift;
mod bends;
mod beside;
pub(crate) mod forms;
mod graph;
mod lines;
mod lists;
mod moved;
mod place;
mod profile;
mod reduce;
pub(crate) mod rooms;
mod route;
pub(crate) mod section;
mod shape;
mod tree;
mod unbroken;
mod way;

use g7_model::{Chart, PlaceAt, Step, StepKind};

use crate::{End, Placement, Point, Sizes};

/// Number of rounds in which the links that could not be drawn are broken; the round after them
/// breaks all that remain.
const TRIES: usize = 4;

/// Lays a chart out: automatically, except for the symbols that the layout section places.
#[inline(never)]
pub fn layout(chart: &Chart, sizes: &Sizes, places: &[PlaceAt]) -> Placement {
    let graph = graph::Graph::new(chart);
    let forms = forms::given(chart, &graph, places);
    let mut broken = forms::jumps(&graph, &forms);
    let mut tries = 0;
    loop {
        let tree = reduce::reduce(&graph, &broken);
        let shapes = shape::shapes(&graph, &tree, sizes);
        if shapes.failed.is_empty() {
            let auto = from_first(route::route(&shapes, &place::places(&shapes)), chart);
            let given = moved::given(chart, &graph, places);
            let mut placement = moved::moved(&graph, sizes, auto, &given, &forms);
            unbroken::apply(&graph, sizes, &forms, &mut placement);
            bends::bend(chart, &graph, sizes, places, &mut placement);
            return without_gaps(placement, graph.real);
        }
        tries += 1;
        shapes.failed.iter().for_each(|l| broken[*l as usize] = true);
        if tries >= TRIES {
            broken.iter_mut().zip(&graph.back).for_each(|(b, back)| *b |= back);
        }
    }
}

/// Moves a placement so that the step at which the chart begins stands at the origin: what is added or taken away
/// at its left or above it does not move it.
fn from_first(mut p: Placement, chart: &Chart) -> Placement {
    let begins = |s: &Step| s.initial || s.kind == StepKind::Entry;
    let Some(&by) = p.steps.get(chart.steps().position(begins).unwrap_or(0)) else { return p };
    let moved = |at: &mut Point| (at.x, at.y) = (at.x - by.x, at.y - by.y);
    p.steps.iter_mut().chain(&mut p.transitions).for_each(moved);
    p.bars.iter_mut().for_each(|b| moved(&mut b.at));
    for link in &mut p.links {
        link.points.iter_mut().for_each(moved);
        link.arrows.iter_mut().for_each(|a| moved(&mut a.0));
    }
    for c in &mut p.connectors {
        moved(&mut c.at);
        c.points.iter_mut().for_each(moved);
        (c.text.x, c.text.y) = (c.text.x - by.x, c.text.y - by.y);
    }
    (p.area.x, p.area.y) = (p.area.x - by.x, p.area.y - by.y);
    p
}

/// Takes out the symbols that only hold room, with everything that leads to them.
fn without_gaps(mut p: Placement, (steps, transitions): (usize, usize)) -> Placement {
    p.steps.truncate(steps);
    p.transitions.truncate(transitions);
    let real = |end: End| match end {
        End::Step(n) => (n as usize) < steps,
        End::Transition(n) => (n as usize) < transitions,
    };
    p.links.retain(|l| real(l.from) && real(l.to));
    p.connectors.retain(|c| real(c.from) && real(c.to));
    p.bars.retain(|b| real(End::Transition(b.transition)));
    p
}
