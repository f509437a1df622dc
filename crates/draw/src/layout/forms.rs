//! The forms that a layout section gives to links (decision 84): as a line, or as a jump that is broken off and names
//! its other end.
//!
//! A jump is known before the layout begins, which keeps room for its two ends; here they follow symbols that stand
//! elsewhere. Lines are drawn by `unbroken.rs`.

use std::collections::HashMap;

use g7_model::{Chart, LinkForm, PlaceAt, Placed};

use crate::layout::graph::Graph;
use crate::layout::route::{end, tidy};
use crate::layout::section::Named;
use crate::{Connector, End, Placement, Point};

/// The forms that a layout section gives, by the ends of the links.
#[inline(never)]
pub(crate) fn wanted(chart: &Chart, places: &[PlaceAt]) -> HashMap<(End, End), LinkForm> {
    let forms = places.iter().filter_map(|p| match &p.what {
        Placed::LinkForm(ends, form) => Some((&ends.0, &ends.1, *form)),
        _ => None,
    });
    let mut forms = forms.peekable();
    if forms.peek().is_none() {
        return HashMap::new();
    }
    let named = Named::new(chart);
    forms.filter_map(|(from, to, form)| Some(((named.symbol(from)?, named.symbol(to)?), form))).collect()
}

/// The form of each link of the graph; empty if the layout section gives none.
pub(crate) fn given(chart: &Chart, graph: &Graph, places: &[PlaceAt]) -> Vec<Option<LinkForm>> {
    let wanted = wanted(chart, places);
    if wanted.is_empty() {
        return Vec::new();
    }
    graph.links.iter().map(|l| wanted.get(&ends(graph, *l)).copied()).collect()
}

/// The links that are broken off because the author wants them so.
pub(crate) fn jumps(graph: &Graph, forms: &[Option<LinkForm>]) -> Vec<bool> {
    let mut broken = vec![false; graph.links.len()];
    broken.iter_mut().zip(forms).for_each(|(broken, form)| *broken = *form == Some(LinkForm::Jump));
    broken
}

/// The two ends of a link of the graph.
pub(crate) fn ends(graph: &Graph, (from, to): (u32, u32)) -> (End, End) {
    (end(graph.steps, from), end(graph.steps, to))
}

/// The ends of jumps, by link and by `leaving`, as the automatic layout has them.
pub(crate) type Jumps = HashMap<(u32, bool), Connector>;

/// The two ends of each jump, shifted with the symbol at which they stand.
#[inline(never)]
pub(crate) fn shifted(graph: &Graph, auto: &Placement, forms: &[Option<LinkForm>], at: &[Point]) -> Jumps {
    let mut found = Jumps::new();
    let old: Vec<Point> = auto.steps.iter().chain(&auto.transitions).copied().collect();
    for (l, _) in (0u32..).zip(forms).filter(|(_, form)| **form == Some(LinkForm::Jump)) {
        let (from, to) = graph.links[l as usize];
        let both = ends(graph, (from, to));
        for c in auto.connectors.iter().filter(|c| (c.from, c.to) == both) {
            let node = if c.leaving { from } else { to } as usize;
            found.insert((l, c.leaving), moved(c, at[node].minus(old[node])));
        }
    }
    found
}

/// A connector, moved by a vector.
fn moved(c: &Connector, by: Point) -> Connector {
    let mut c = c.clone();
    let shift = |at: &mut Point| (at.x, at.y) = (at.x + by.x, at.y + by.y);
    c.points.iter_mut().for_each(shift);
    shift(&mut c.at);
    (c.text.x, c.text.y) = (c.text.x + by.x, c.text.y + by.y);
    c
}

/// The start of a jump below the row or the double line in which links part: `below` is its height, `port` the place
/// at which the link leaves its symbol.
pub(crate) fn leaving(c: &Connector, port: Point, below: i32) -> Connector {
    // A jump that goes straight down has no row.
    let Some(row) = c.points.get(1).filter(|_| c.points.len() > 2).map(|at| at.y) else { return c.clone() };
    let mut c = moved(c, Point { x: 0, y: below - row });
    let x = c.at.x;
    c.points = tidy(vec![port, Point { x: port.x, y: below }, Point { x, y: below }, c.at]);
    c
}

/// The end of a jump above a double line whose upper line has this height.
pub(crate) fn arriving(c: &Connector, above: i32) -> Connector {
    moved(c, Point { x: 0, y: above - c.at.y })
}
