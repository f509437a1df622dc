//! The bends that a layout section gives to links (decision 77): the last stage of the layout, when symbols and double
//! lines have their places.
//!
//! A link leaves its start downward, goes sideways at the height of each bend, on from the place of that bend to the
//! height of the next, and from the last height down into its end. Only the part between the double lines is bent. A
//! link keeps the way of the layout where its bends would be worse: where it could not leave downward and arrive from
//! above, or would run through more symbols or lie on more links.

use g7_model::{Chart, PlaceAt, Placed};

use crate::layout::graph::Graph;
use crate::layout::moved::{arrows, symbols};
use crate::layout::rooms::DOUBLE;
use crate::layout::route::tidy;
use crate::layout::section::{FAR, Named};
use crate::{Bar, Bends, End, Link, Placement, Point, Rect, Sizes};

/// The bends that the layout section gives, by the ends of the link.
fn given(chart: &Chart, places: &[PlaceAt]) -> Vec<(End, End, Vec<Point>)> {
    let mut found = Vec::new();
    if places.iter().all(|p| !matches!(p.what, Placed::Link(_))) {
        return found;
    }
    let named = Named::new(chart);
    for place in places {
        let Placed::Link(ends) = &place.what else { continue };
        if let (Some(from), Some(to)) = (named.symbol(&ends.0), named.symbol(&ends.1)) {
            let bends = std::iter::once((place.x, place.y)).chain(place.then.iter().copied());
            let near = |(x, y): (i32, i32)| Point { x: x.clamp(-FAR, FAR), y: y.clamp(-FAR, FAR) };
            found.push((from, to, bends.map(near).collect()));
        }
    }
    found
}

/// Bends the links as the layout section says, and tells for every link which of its segments can be moved.
#[inline(never)]
pub(crate) fn bend(chart: &Chart, graph: &Graph, sizes: &Sizes, places: &[PlaceAt], p: &mut Placement) {
    for k in 0..p.links.len() {
        p.links[k].held = held(&p.links[k], &p.bars);
    }
    let given = given(chart, places);
    let bent: Vec<(usize, Vec<Point>)> = given
        .into_iter()
        .filter_map(|(from, to, bends)| {
            Some((p.links.iter().position(|l| (l.from, l.to) == (from, to))?, bends))
        })
        .collect();
    if bent.is_empty() {
        return;
    }
    let node = |end: End| match end {
        End::Step(n) => n,
        End::Transition(n) => graph.steps as u32 + n,
    };
    let mut ways = symbols(graph, sizes, p);
    bent.iter().for_each(|(k, _)| p.links[*k].bends = Bends::Waived);
    for link in p.links.iter().filter(|l| l.bends == Bends::None) {
        ways.draw(&link.points, node(link.from), node(link.to));
    }
    for (k, bends) in bent {
        let link = &mut p.links[k];
        let (from, to) = (node(link.from), node(link.to));
        let between = [
            bar(&p.bars, link.from, false).map(|b| b.at.y + DOUBLE),
            bar(&p.bars, link.to, true).map(|b| b.at.y),
        ];
        if let Some(points) = way(link, between, &bends)
            && ways.faults(&points, from, to) <= ways.faults(&link.points, from, to)
        {
            link.arrows = arrows(&points);
            link.points = points;
            link.bends = Bends::Followed;
        }
        ways.draw(&link.points, from, to);
    }
    let corners = p.links.iter().filter(|l| l.bends == Bends::Followed).flat_map(|l| &l.points);
    let corners = corners.map(|at| Rect { x: at.x, y: at.y, w: 0, h: 0 });
    p.area = corners.fold(p.area, |area, corner| area.union(&corner));
}

/// The double line below a transition at which links start, or above one at which they arrive.
fn bar(bars: &[Bar], end: End, join: bool) -> Option<&Bar> {
    let End::Transition(t) = end else { return None };
    // They are in this order.
    let found = bars.binary_search_by_key(&(t, !join), |b| (b.transition, !b.join));
    bars.get(found.ok()?)
}

/// The number of segments at the start and at the end of a link that no bend moves: the first and the last one, and
/// those along a double line. `None` where nothing is left between them, or in another form.
fn held(link: &Link, bars: &[Bar]) -> Option<[usize; 2]> {
    let points = &link.points;
    let segments = points.len().saturating_sub(1);
    let along = |end: End, join: bool, next: Option<&Point>, height: i32| {
        bar(bars, end, join).is_some_and(|b| next.is_some_and(|at| at.y == b.at.y + height))
    };
    let first = if along(link.from, false, points.get(1), 0) { 3 } else { 1 };
    let before = points.len().checked_sub(2).and_then(|n| points.get(n));
    let last = if along(link.to, true, before, DOUBLE) { 3 } else { 1 };
    // A part that can be bent begins and ends sideways.
    let inner = segments.checked_sub(first + last).is_some_and(|inner| inner % 2 == 1);
    let upright = points.first().zip(points.get(1)).is_some_and(|(a, b)| a.x == b.x);
    (upright && inner).then_some([first, last])
}

/// The corners of a link with these bends; `None` if it could not leave downward and arrive from above. `between`
/// are the heights of its double lines.
fn way(link: &Link, between: [Option<i32>; 2], bends: &[Point]) -> Option<Vec<Point>> {
    let points = &link.points;
    let [first, last] = if points.len() == 2 { [1, 1] } else { link.held? };
    let (head, tail) = (points.get(..first)?, points.get(points.len().checked_sub(last)?..)?);
    let (start, goal) = (*head.last()?, *tail.first()?);
    if bends.first()?.y <= between[0].unwrap_or(start.y) || bends.last()?.y >= between[1].unwrap_or(goal.y) {
        return None;
    }
    let mut found = head.to_vec();
    let mut x = start.x;
    for (k, bend) in bends.iter().enumerate() {
        found.push(Point { x, y: bend.y });
        x = if k + 1 == bends.len() { goal.x } else { bend.x };
        found.push(Point { x, y: bend.y });
    }
    found.extend(tail);
    Some(tidy(found))
}
