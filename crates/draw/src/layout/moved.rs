//! Applies a layout section: symbols go where it says, and the links that touch them are routed
//! again. Links between symbols that stay keep their corners.

use std::collections::HashMap;

use g7_model::{Chart, Layout, LinkForm, PlaceAt};

use crate::layout::forms::{self, Jumps};
use crate::layout::graph::Graph;
use crate::layout::rooms::{BAR, CLEAR, DOUBLE, LINK, OVERHANG, SQUARE, extents};
use crate::layout::route::{area, end, tidy};
use crate::layout::section::{FAR, Named};
use crate::layout::way::Ways;
use crate::{Bar, Connector, End, Extent, Link, Placement, Point, Rect, Sizes};

/// The places that the layout section gives, by node.
#[inline(never)]
pub(crate) fn given(chart: &Chart, graph: &Graph, places: &[PlaceAt]) -> Vec<Option<Point>> {
    let mut given = vec![None; graph.nodes];
    if places.is_empty() {
        return given;
    }
    let named = Named::new(chart);
    for place in places {
        let node = named.symbol(&place.what).map(|end| match end {
            End::Step(n) => n as usize,
            End::Transition(n) => graph.steps + n as usize,
        });
        if let Some(slot) = node.and_then(|n| given.get_mut(n)) {
            *slot = Some(Point { x: place.x.clamp(-FAR, FAR), y: place.y.clamp(-FAR, FAR) });
        }
    }
    given
}

/// A horizontal offset no greater than this is straightened.
const ASKEW: i32 = 40;

pub(crate) struct Moved<'a> {
    graph: &'a Graph,
    at: Vec<Point>,
    extents: Vec<Extent>,
    /// Texts of the transitions round their bars, not rounded.
    texts: &'a [Extent],
    moved: Vec<bool>,
    /// Height of the line or double line below and above each node.
    below: Vec<i32>,
    above: Vec<i32>,
    /// The ends of the links that the author wants broken off, shifted with their symbols.
    jumps: Jumps,
}

/// The placement after the given places are applied.
#[inline(never)]
pub(crate) fn moved(
    graph: &Graph,
    sizes: &Sizes,
    auto: Placement,
    given: &[Option<Point>],
    forms: &[Option<LinkForm>],
) -> Placement {
    let count = given.iter().flatten().count();
    if count == 0 {
        return auto;
    }
    let mut at: Vec<Point> = auto.steps.iter().chain(&auto.transitions).copied().collect();
    // If most places are given, a person drew the chart: a new symbol then keeps its automatic
    // offset from a neighbour.
    let by_hand = Layout::is_by_hand(count, graph.real.0 + graph.real.1);
    if by_hand {
        beside_neighbours(graph, &mut at, given);
    }
    at.iter_mut().zip(given).for_each(|(at, g)| *at = g.unwrap_or(*at));
    if by_hand {
        straighten(graph, &mut at);
    }
    let moved = given.iter().map(|g| by_hand || g.is_some()).collect();
    let extents = extents(graph, sizes);
    let texts = &sizes.transitions;
    let jumps = forms::shifted(graph, &auto, forms, &at);
    let mut m = Moved { graph, at, extents, texts, moved, below: Vec::new(), above: Vec::new(), jumps };
    m.lines();
    m.place(auto, sizes)
}

/// Moves a transition exactly under or over a step if it nearly stands there, so that its link has
/// no tiny bend.
fn straighten(graph: &Graph, at: &mut [Point]) {
    for t in graph.steps as u32..graph.nodes as u32 {
        let before = graph.into.of(t).iter().map(|l| graph.links[*l as usize].0);
        let behind = graph.out.of(t).iter().map(|l| graph.links[*l as usize].1);
        let x = at[t as usize].x;
        let near = before.chain(behind).map(|s| at[s as usize].x).find(|s| (s - x).abs() <= ASKEW);
        at[t as usize].x = near.unwrap_or(x);
    }
}

#[inline(never)]
fn beside_neighbours(graph: &Graph, at: &mut [Point], given: &[Option<Point>]) {
    let auto = at.to_vec();
    let mut known: Vec<bool> = given.iter().map(Option::is_some).collect();
    let mut next: Vec<u32> = (0..graph.nodes as u32).filter(|n| known[*n as usize]).collect();
    next.iter().for_each(|n| at[*n as usize] = given[*n as usize].unwrap_or_default());
    while let Some(n) = next.pop() {
        let links = graph.out.of(n).iter().chain(graph.into.of(n));
        for &l in links {
            let (from, to) = graph.links[l as usize];
            let (n, o) = (n as usize, if from == n { to } else { from } as usize);
            if !known[o] {
                known[o] = true;
                at[o] = Point { x: at[n].x + auto[o].x - auto[n].x, y: at[n].y + auto[o].y - auto[n].y };
                next.push(o as u32);
            }
        }
    }
}

/// The symbols and double lines of a placement, which links go round.
pub(crate) fn symbols(graph: &Graph, sizes: &Sizes, p: &Placement) -> Ways {
    // Drawings of other tools are close: symbols have their own height here, without what the grid adds.
    let room = |(n, e): (usize, Extent)| match n.checked_sub(graph.steps) {
        None => Extent { down: sizes.steps.get(n).map_or(e.down, |s| s.down.clamp(SQUARE, e.down)), ..e },
        Some(t) => match sizes.transitions.get(t) {
            Some(text) => Extent { up: text.up.clamp(0, e.up), down: text.down.clamp(0, e.down), ..e },
            None => e,
        },
    };
    let rooms = extents(graph, sizes).into_iter().enumerate().map(room);
    let boxes = p.steps.iter().chain(&p.transitions).zip(rooms).map(|(at, e)| Rect::around(*at, e));
    let double = |b: &Bar| {
        let r = Rect { x: b.at.x, y: b.at.y, w: b.w, h: DOUBLE };
        (graph.steps as u32 + b.transition, r)
    };
    Ways::new((0..).zip(boxes).chain(p.bars.iter().map(double)).collect())
}

/// The arrows of a link: one on each part that runs upward.
pub(crate) fn arrows(points: &[Point]) -> Vec<(Point, (i8, i8))> {
    let up = points.windows(2).filter(|w| w[1].y < w[0].y && w[1].x == w[0].x);
    up.map(|w| (Point { x: w[0].x, y: (w[0].y + w[1].y) / 2 - 60.min((w[0].y - w[1].y) / 2) }, (0, -1)))
        .collect()
}

impl<'a> Moved<'a> {
    /// The symbols of a placement as they stand, with the rows and double lines at which its links part and meet.
    #[inline(never)]
    pub(crate) fn settled(graph: &'a Graph, sizes: &'a Sizes, p: &Placement) -> Moved<'a> {
        let at = p.steps.iter().chain(&p.transitions).copied().collect();
        let (extents, texts) = (extents(graph, sizes), &sizes.transitions[..]);
        let (below, above, jumps) = (Vec::new(), Vec::new(), Jumps::new());
        let mut m = Moved { graph, at, extents, texts, moved: vec![false; graph.nodes], below, above, jumps };
        m.lines();
        for l in p.links.iter().filter(|l| l.points.len() > 2) {
            if let End::Step(n) = l.from {
                m.below[n as usize] = l.points[1].y;
            }
            if let End::Step(n) = l.to {
                m.above[n as usize] = l.points[l.points.len() - 2].y;
            }
        }
        for b in &p.bars {
            let side = if b.join { &mut m.above } else { &mut m.below };
            side[graph.steps + b.transition as usize] = b.at.y;
        }
        m
    }

    fn port(&self, n: u32) -> i32 {
        self.at[n as usize].y + if self.graph.is_step(n) { SQUARE } else { 0 }
    }

    /// Sets the height at which links part below each node and meet above it.
    #[inline(never)]
    fn lines(&mut self) {
        let nodes = 0..self.graph.nodes as u32;
        let (mut below, mut above) = (Vec::new(), Vec::new());
        for n in nodes {
            let port = self.port(n);
            let under =
                self.graph.out.of(n).iter().map(|l| self.at[self.graph.links[*l as usize].1 as usize].y);
            let room = under.filter(|y| *y > port).map(|y| y - port).min().unwrap_or(2 * LINK);
            let top = self.at[n as usize].y;
            let over = self.graph.into.of(n).iter().map(|l| self.port(self.graph.links[*l as usize].0));
            let height = over.filter(|y| *y < top).map(|y| top - y).min().unwrap_or(2 * LINK);
            if self.graph.is_step(n) {
                below.push(self.parting(n, port, room));
                above.push(top - LINK.min(height / 2));
            } else {
                below.push(port + BAR.min((room - DOUBLE) / 2).max(0));
                above.push(top - DOUBLE - BAR.min((height - DOUBLE) / 2).max(0));
            }
        }
        (self.below, self.above) = (below, above);
    }

    /// The height at which the links of a step part: below its actions if there is room and a link
    /// runs past them.
    #[inline(never)]
    fn parting(&self, n: u32, port: i32, room: i32) -> i32 {
        let usual = port + LINK.min(room / 2);
        // Above the texts of the transitions behind it, if it can.
        let over = self.graph.out.of(n).iter().map(|l| {
            let to = self.graph.links[*l as usize].1 as usize;
            let text = to.checked_sub(self.graph.steps).and_then(|t| self.texts.get(t));
            self.at[to].y - text.map_or(0, |e| e.up.clamp(0, 2 * SQUARE))
        });
        let over = over.filter(|top| *top > port).min().unwrap_or(usual);
        let usual = if usual > over { port + (over - port) / 2 } else { usual };
        let low = self.at[n as usize].y + self.extents[n as usize].down + CLEAR;
        let x = self.at[n as usize].x;
        let (mut top, mut to_right) = (i32::MAX, false);
        for l in self.graph.out.of(n) {
            let to = self.graph.links[*l as usize].1 as usize;
            if self.at[to].y > port {
                top = top.min(self.at[to].y - self.extents[to].up);
                to_right |= self.at[to].x > x;
            }
        }
        if to_right && low > usual && low + CLEAR / 2 <= top { low } else { usual }
    }

    #[inline(never)]
    fn place(&self, auto: Placement, sizes: &Sizes) -> Placement {
        let graph = self.graph;
        let touched = |n: u32, links: &[u32], other: fn((u32, u32)) -> u32| {
            let moved = |n: u32| self.moved[n as usize];
            moved(n) || links.iter().any(|l| moved(other(graph.links[*l as usize])))
        };
        let nodes = 0..graph.nodes as u32;
        let below: Vec<bool> = nodes.clone().map(|n| touched(n, graph.out.of(n), |l| l.1)).collect();
        let above: Vec<bool> = nodes.map(|n| touched(n, graph.into.of(n), |l| l.0)).collect();
        let (steps, transitions) = self.at.split_at(graph.steps);
        let mut p =
            Placement { steps: steps.to_vec(), transitions: transitions.to_vec(), ..Placement::default() };
        let side = |b: &Bar| if b.join { &above } else { &below };
        let still = |b: &Bar| !side(b)[graph.steps + b.transition as usize];
        p.bars = auto.bars.into_iter().filter(still).collect();
        self.bars(&mut p, &below, &above);
        let mut ways = symbols(graph, sizes, &p);
        let mut drawn: HashMap<(End, End), Link> =
            auto.links.into_iter().map(|l| ((l.from, l.to), l)).collect();
        let broken = |from: End, to: End| auto.connectors.iter().any(|c| (c.from, c.to) == (from, to));
        let mut links: Vec<Option<Link>> = vec![None; graph.links.len()];
        let mut again = Vec::new();
        for (n, &(from, to)) in graph.links.iter().enumerate() {
            if self.jumps.contains_key(&(n as u32, true)) {
                continue;
            }
            let touched = below[from as usize] || above[to as usize];
            let (a, b) = (end(graph.steps, from), end(graph.steps, to));
            match drawn.remove(&(a, b)) {
                Some(link) if !touched && !ways.blocked(&link.points, from, to) => {
                    ways.draw(&link.points, from, to);
                    links[n] = Some(link);
                }
                None if !touched && broken(a, b) => {}
                _ => again.push(n),
            }
        }
        // Links that can go in one way only come first, so that the others move aside.
        let (x, y) = (|n: u32| self.at[n as usize].x, |n: u32| self.at[n as usize].y);
        let aside = |n: &usize| {
            let (from, to) = graph.links[*n];
            (y(to) <= y(from), (x(to) - x(from)).abs())
        };
        again.sort_by_key(aside);
        for n in again {
            let (from, to) = graph.links[n];
            let link = self.link(&ways, from, to);
            ways.draw(&link.points, from, to);
            links[n] = Some(link);
        }
        p.links = links.into_iter().flatten().collect();
        let keep = |c: &Connector| !p.links.iter().any(|l| (l.from, l.to) == (c.from, c.to));
        p.connectors = auto.connectors.into_iter().filter(keep).collect();
        self.jumps(&mut p.connectors, &below, &above);
        p.area = area(&p, &extents(graph, sizes));
        p
    }

    /// Puts the ends of jumps where their symbols stand now.
    #[inline(never)]
    fn jumps(&self, connectors: &mut [Connector], below: &[bool], above: &[bool]) {
        let graph = self.graph;
        let number = |(from, to): (End, End)| {
            let is = |l: &(u32, u32)| (end(graph.steps, l.0), end(graph.steps, l.1)) == (from, to);
            graph.links.iter().position(is).unwrap_or_default()
        };
        for c in connectors {
            let l = number((c.from, c.to));
            let Some(there) = self.jumps.get(&(l as u32, c.leaving)) else { continue };
            let (from, to) = graph.links[l];
            *c = if c.leaving && below[from as usize] {
                let port = Point { x: self.at[from as usize].x, y: self.port(from) };
                forms::leaving(there, port, self.below[from as usize])
            } else if !c.leaving && above[to as usize] && self.joins(to) {
                forms::arriving(there, self.above[to as usize])
            } else {
                there.clone()
            };
        }
    }

    /// True if links meet at a double line above a node.
    fn joins(&self, n: u32) -> bool {
        !self.graph.is_step(n) && self.graph.into.of(n).len() > 1
    }

    /// Draws the double lines of transitions that moved or whose neighbours moved; they span the
    /// columns of their links.
    #[inline(never)]
    fn bars(&self, p: &mut Placement, below: &[bool], above: &[bool]) {
        let graph = self.graph;
        for t in graph.steps as u32..graph.nodes as u32 {
            for join in [true, false] {
                let (touched, links) =
                    if join { (above, graph.into.of(t)) } else { (below, graph.out.of(t)) };
                if !touched[t as usize] || links.len() < 2 {
                    continue;
                }
                let x = self.at[t as usize].x;
                let columns = links.iter().map(|l| self.column(*l, !join));
                let (from, to) = columns.fold((x, x), |(a, b), x| (a.min(x), b.max(x)));
                let y = if join { self.above[t as usize] } else { self.below[t as usize] };
                let at = Point { x: from - OVERHANG, y };
                let transition = t - graph.steps as u32;
                p.bars.push(Bar { transition, join, at, w: to - from + 2 * OVERHANG });
            }
        }
        p.bars.sort_by_key(|b| (b.transition, !b.join));
    }

    /// Where a link meets the double line of its transition: over or under the step if the step
    /// stands on the right side of it, otherwise beside the other links.
    #[inline(never)]
    fn column(&self, link: u32, fork: bool) -> i32 {
        if let Some(jump) = self.jumps.get(&(link, fork)) {
            return jump.at.x;
        }
        let (from, to) = self.graph.links[link as usize];
        let (t, step) = if fork { (from, to) } else { (to, from) };
        let right_way = match fork {
            true => self.at[step as usize].y > self.below[t as usize] + DOUBLE,
            false => self.port(step) < self.above[t as usize],
        };
        if right_way {
            return self.at[step as usize].x;
        }
        let links = if fork { self.graph.out.of(t) } else { self.graph.into.of(t) };
        let others = links.iter().filter(|l| **l != link).map(|l| {
            let (a, b) = self.graph.links[*l as usize];
            self.at[if fork { b } else { a } as usize].x
        });
        let place = links.iter().position(|l| *l == link).unwrap_or(0) as i32;
        others.min().unwrap_or(self.at[t as usize].x).min(self.at[t as usize].x) - 150 * (1 + place)
    }

    #[inline(never)]
    pub(crate) fn link(&self, ways: &Ways, from: u32, to: u32) -> Link {
        let graph = self.graph;
        let number =
            graph.out.of(from).iter().copied().find(|l| graph.links[*l as usize].1 == to).unwrap_or(0);
        let (a, b) = (self.at[from as usize], self.at[to as usize]);
        let mut points = vec![Point { x: a.x, y: self.port(from) }];
        let mut last = vec![b];
        let (parts, meets) = (graph.out.of(from).len() > 1, graph.into.of(to).len() > 1);
        if parts && !graph.is_step(from) {
            let (x, y) = (self.column(number, true), self.below[from as usize]);
            points.extend([Point { x: a.x, y }, Point { x, y }, Point { x, y: y + DOUBLE }]);
        }
        if meets && !graph.is_step(to) {
            let (x, y) = (self.column(number, false), self.above[to as usize]);
            last.extend([Point { x: b.x, y: y + DOUBLE }, Point { x, y: y + DOUBLE }, Point { x, y }]);
        }
        let (start, goal) = (points.last().copied().unwrap_or(a), last.last().copied().unwrap_or(b));
        let rows = [
            (parts && graph.is_step(from)).then_some(self.below[from as usize]),
            (meets && graph.is_step(to)).then_some(self.above[to as usize]),
        ];
        points.extend(ways.find(start, goal, rows, from, to));
        last.reverse();
        points.extend(last);
        let points = tidy(points);
        let arrows = arrows(&points);
        let (from, to) = (end(graph.steps, from), end(graph.steps, to));
        Link::new(from, to, points, arrows)
    }
}
