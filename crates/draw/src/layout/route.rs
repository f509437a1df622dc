//! The corners of links, double lines and connectors of an automatic layout.

use crate::layout::place::Places;
use crate::layout::rooms::{ASIDE, DOUBLE, OVERHANG, ROW_TEXT, STUB, connector_width, extents};
use crate::layout::shape::Shapes;
use crate::{Bar, Connector, End, Extent, Link, Placement, Point, Rect};

/// A return longer than this has an arrow at both ends.
const LONG: i32 = 4000;

/// A node as the end of a link.
pub(crate) fn end(steps: usize, n: u32) -> End {
    match (n as usize) < steps {
        true => End::Step(n),
        false => End::Transition(n - steps as u32),
    }
}

/// Computes the links, double lines and connectors.
#[inline(never)]
pub(crate) fn route(s: &Shapes, p: &Places) -> Placement {
    let graph = s.graph;
    let (steps, transitions) = p.at.split_at(graph.steps);
    let mut placement =
        Placement { steps: steps.to_vec(), transitions: transitions.to_vec(), ..Placement::default() };
    let mut back = vec![None; graph.links.len()];
    for (r, of) in (0u32..).zip(&s.tree.returns) {
        of.links.iter().for_each(|l| back[*l as usize] = Some(r));
    }
    let mut broken = vec![false; graph.links.len()];
    s.tree.cuts.iter().for_each(|l| broken[*l as usize] = true);
    for l in (0..graph.links.len()).filter(|l| !broken[*l]) {
        let (from, to) = graph.links[l];
        let (a, b) = (end(graph.steps, from), end(graph.steps, to));
        let mut link = Link::new(a, b, Vec::new(), Vec::new());
        let mut points = start(s, p, l);
        match back[l] {
            None => finish(s, p, l, &mut points),
            Some(r) => link.arrows = up(s, p, r, to, &mut points),
        }
        link.points = tidy(points);
        placement.links.push(link);
    }
    bars(s, p, &mut placement);
    connectors(s, p, &mut placement);
    placement.area = area(&placement, &extents(graph, s.sizes));
    placement
}

/// The bounding box of a placement.
pub(crate) fn area(p: &Placement, extents: &[Extent]) -> Rect {
    let at = p.steps.iter().chain(&p.transitions).zip(extents).map(|(at, e)| Rect::around(*at, *e));
    let bars = p.bars.iter().map(|b| Rect { x: b.at.x, y: b.at.y, w: b.w, h: DOUBLE });
    let corners = p.links.iter().map(|l| &l.points).chain(p.connectors.iter().map(|c| &c.points));
    let corners = corners.flatten().map(|p| Rect { x: p.x, y: p.y, w: 0, h: 0 });
    let texts = p.connectors.iter().map(|c| c.text);
    at.chain(bars).chain(corners).chain(texts).reduce(|a, b| a.union(&b)).unwrap_or_default()
}

/// The first points of a link: from the node above to the link's column.
fn start(s: &Shapes, p: &Places, l: usize) -> Vec<Point> {
    let from = s.graph.links[l].0 as usize;
    let at = p.at[from];
    let mut points = vec![Point { x: at.x, y: at.y + s.rooms[from].port }];
    if let Some(line) = p.below_line[from] {
        let x = p.column(l as u32, true, at.x);
        points.extend([Point { x: at.x, y: line }, Point { x, y: line }]);
    }
    points
}

/// Appends the last points of a link: down to the node below.
#[inline(never)]
fn finish(s: &Shapes, p: &Places, l: usize, points: &mut Vec<Point>) {
    let to = s.graph.links[l].1 as usize;
    let at = p.at[to];
    if let Some(mut line) = p.above_line[to] {
        if !s.graph.is_step(to as u32) {
            line += DOUBLE;
        }
        let x = points.last().map_or(at.x, |p| p.x);
        points.extend([Point { x, y: line }, Point { x: at.x, y: line }]);
    }
    points.push(at);
}

/// Appends the points of a return (to the left, up beside the chart, into the step from above) and
/// gives its arrows.
#[inline(never)]
fn up(s: &Shapes, p: &Places, back: u32, to: u32, points: &mut Vec<Point>) -> Vec<(Point, (i8, i8))> {
    let at = p.at[to as usize];
    let (row, lane) = (p.row[back as usize], p.lane[back as usize]);
    let entry = p.above_line[to as usize].unwrap_or(at.y - s.entry[to as usize]);
    let x = points.last().map_or(at.x, |p| p.x);
    let corners = [(x, row), (lane, row), (lane, entry), (at.x, entry), (at.x, at.y)];
    points.extend(corners.map(|(x, y)| Point { x, y }));
    let height = row - entry;
    let tips = if height > LONG {
        [Some(entry + 300), Some(row - 400)]
    } else {
        [Some(entry + height / 2 - 60), None]
    };
    tips.into_iter().flatten().map(|y| (Point { x: lane, y }, (0, -1))).collect()
}

/// Removes points at which the line does not turn.
#[inline(never)]
pub(crate) fn tidy(points: Vec<Point>) -> Vec<Point> {
    let mut found: Vec<Point> = Vec::with_capacity(points.len());
    for p in points {
        if found.last() == Some(&p) {
            continue;
        }
        if let [.., a, b] = found[..]
            && (a.x == b.x && b.x == p.x || a.y == b.y && b.y == p.y)
        {
            found.pop();
        }
        found.push(p);
    }
    found
}

/// Adds the double lines, as wide as the links that meet at them.
#[inline(never)]
fn bars(s: &Shapes, p: &Places, placement: &mut Placement) {
    let graph = s.graph;
    for t in graph.steps as u32..graph.nodes as u32 {
        let at = p.at[t as usize];
        for (join, line) in [(true, p.above_line[t as usize]), (false, p.below_line[t as usize])] {
            let Some(line) = line else { continue };
            let links = if join { graph.into.of(t) } else { graph.out.of(t) };
            let column = |l: &u32| p.column(*l, !join, at.x);
            let (from, to) = links.iter().map(column).fold((at.x, at.x), |(a, b), x| (a.min(x), b.max(x)));
            let (x, w) = (from - OVERHANG, to - from + 2 * OVERHANG);
            let transition = t - graph.steps as u32;
            placement.bars.push(Bar { transition, join, at: Point { x, y: line }, w });
        }
    }
}

/// Adds the ends of broken links, with the boxes of their texts.
#[inline(never)]
fn connectors(s: &Shapes, p: &Places, placement: &mut Placement) {
    for &(l, leaving, tail, tip) in &p.broken {
        let (from, to) = s.graph.links[l as usize];
        let mut points = vec![tail, tip];
        if leaving {
            // The link starts at the step's square, whatever stands beside the step.
            let mut before = start(s, p, l as usize);
            before.extend(points);
            points = tidy(before);
        }
        let w = connector_width(s.graph, s.sizes, l, leaving);
        let text = match (leaving, tail.y == tip.y) {
            (true, _) => Rect { x: tip.x + ASIDE, y: tip.y - ROW_TEXT + 20, w, h: ROW_TEXT },
            (false, true) => Rect { x: tip.x + STUB, y: tip.y - ROW_TEXT / 2, w, h: ROW_TEXT },
            (false, false) => Rect { x: tip.x + ASIDE, y: tail.y, w, h: ROW_TEXT },
        };
        let steps = s.graph.steps;
        placement.connectors.push(Connector {
            from: end(steps, from),
            to: end(steps, to),
            leaving,
            at: tip,
            points,
            text,
            form: None,
        });
    }
    placement.connectors.sort_by_key(|c| {
        let key = |e: End| match e {
            End::Step(n) => (0, n),
            End::Transition(n) => (1, n),
        };
        (key(c.from), key(c.to), !c.leaving)
    });
}
