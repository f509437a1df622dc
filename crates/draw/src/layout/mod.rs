//! Automatic layout of a chart.
//!
//! # Where this sits
//!
//! ```text
//! Chart -> graph -> reduce -> tree -> shape, beside -> place -> route -> Placement
//!                                                        \-> moved -/  (layout section)
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

mod beside;
mod graph;
mod lines;
mod moved;
mod place;
mod profile;
mod reduce;
pub(crate) mod rooms;
mod route;
pub(crate) mod section;
mod shape;
mod tree;
mod way;

use g7_model::{Chart, PlaceAt};

use crate::{Placement, Sizes};

/// Number of rounds in which the links that could not be drawn are broken; the round after them
/// breaks all that remain.
const TRIES: usize = 4;

/// Lays a chart out: automatically, except for the symbols that the layout section places.
#[inline(never)]
pub fn layout(chart: &Chart, sizes: &Sizes, places: &[PlaceAt]) -> Placement {
    let graph = graph::Graph::new(chart);
    let mut broken = vec![false; graph.links.len()];
    let mut tries = 0;
    loop {
        let tree = reduce::reduce(&graph, &broken);
        let shapes = shape::shapes(&graph, &tree, sizes);
        if shapes.failed.is_empty() {
            let auto = route::route(&shapes, &place::places(&shapes));
            return moved::moved(&graph, sizes, auto, &moved::given(chart, &graph, places));
        }
        tries += 1;
        shapes.failed.iter().for_each(|l| broken[*l as usize] = true);
        if tries >= TRIES {
            broken.iter_mut().zip(&graph.back).for_each(|(b, back)| *b |= back);
        }
    }
}
