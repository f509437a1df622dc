//! The rules that every automatic layout must meet.

use std::collections::HashMap;

use g7_draw::{End, Placement, Point, Rect, Sizes};
use g7_model::Chart;

/// The faults in the links of a layout by hand; there, symbols may overlap.
pub(crate) fn link_faults(chart: &Chart, p: &Placement) -> Vec<String> {
    let mut found = Vec::new();
    whole(chart, p, &mut found);
    links(p, &mut found);
    found
}

/// The links that cross a symbol. Beside a step's square its actions may be higher than the square: below the square
/// is no symbol then.
pub(crate) fn runs_through(sizes: &Sizes, p: &Placement) -> Vec<String> {
    let mut found = Vec::new();
    let mut symbols = Vec::new();
    for (solid, whole) in solids(sizes, p) {
        match solid {
            Solid::Symbol(End::Step(n)) => {
                let middle = p.steps[n as usize].x;
                let square = Rect { w: middle + 250 - whole.x, h: whole.h.min(500), ..whole };
                symbols.push((solid, square));
                symbols.push((solid, Rect { x: middle + 250, w: whole.x + whole.w - middle - 250, ..whole }));
            }
            Solid::Symbol(End::Transition(_)) => symbols.push((solid, whole)),
            Solid::Bar(_) | Solid::Connector(..) => {}
        }
    }
    crossings(p, &symbols, &mut found);
    found
}

/// The pairs of links with no end in common of which a piece lies on the other: nobody could tell them apart.
pub(crate) fn shared(p: &Placement) -> Vec<String> {
    let mut found = Vec::new();
    for (k, a) in p.links.iter().enumerate() {
        for b in p.links.iter().skip(k + 1).filter(|b| a.from != b.from && a.to != b.to) {
            let lies = |v: &[Point], w: &[Point]| {
                let along = |a: Point, b: Point| (a.x.min(b.x), a.x.max(b.x), a.y.min(b.y), a.y.max(b.y));
                let (v, w) = (along(v[0], v[1]), along(w[0], w[1]));
                let upright = v.0 == v.1 && w.0 == w.1 && v.0 == w.0 && v.2.max(w.2) < v.3.min(w.3);
                upright || v.2 == v.3 && w.2 == w.3 && v.2 == w.2 && v.0.max(w.0) < v.1.min(w.1)
            };
            if a.points.windows(2).any(|v| b.points.windows(2).any(|w| lies(v, w))) {
                found.push(format!("{:?} -> {:?} and {:?} -> {:?} share a line", a.from, a.to, b.from, b.to));
            }
        }
    }
    found
}

/// A part of the drawing that takes room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Solid {
    Symbol(End),
    Bar(u32),
    Connector(End, End),
}

/// All faults of a placement, as text.
pub(crate) fn faults(chart: &Chart, sizes: &Sizes, p: &Placement) -> Vec<String> {
    let mut found = Vec::new();
    let solids = solids(sizes, p);
    overlaps(&solids, &mut found);
    whole(chart, p, &mut found);
    links(p, &mut found);
    crossings(p, &solids, &mut found);
    for (_, r) in &solids {
        let inside = p.area.union(r) == p.area;
        if !inside {
            found.push(format!("{r:?} is outside of the area {:?}", p.area));
        }
    }
    found
}

fn solids(sizes: &Sizes, p: &Placement) -> Vec<(Solid, Rect)> {
    let mut solids = Vec::new();
    for (n, (at, e)) in (0..).zip(p.steps.iter().zip(&sizes.steps)) {
        solids.push((Solid::Symbol(End::Step(n)), Rect::around(*at, *e)));
    }
    for (n, (at, e)) in (0..).zip(p.transitions.iter().zip(&sizes.transitions)) {
        solids.push((Solid::Symbol(End::Transition(n)), Rect::around(*at, *e)));
    }
    for b in &p.bars {
        solids.push((Solid::Bar(b.transition), Rect { x: b.at.x, y: b.at.y, w: b.w, h: 50 }));
    }
    for c in &p.connectors {
        solids.push((Solid::Connector(c.from, c.to), c.text));
    }
    solids
}

/// A coarse search grid over boxes.
struct Grid {
    cells: HashMap<(i32, i32), Vec<usize>>,
}

const CELL: i32 = 1500;

impl Grid {
    fn new(solids: &[(Solid, Rect)]) -> Grid {
        let mut cells: HashMap<(i32, i32), Vec<usize>> = HashMap::new();
        for (k, (_, r)) in solids.iter().enumerate() {
            Grid::over(r, |c| cells.entry(c).or_default().push(k));
        }
        Grid { cells }
    }

    fn over(r: &Rect, mut f: impl FnMut((i32, i32))) {
        for x in r.x.div_euclid(CELL)..=(r.x + r.w).div_euclid(CELL) {
            for y in r.y.div_euclid(CELL)..=(r.y + r.h).div_euclid(CELL) {
                f((x, y));
            }
        }
    }

    fn near(&self, r: &Rect) -> Vec<usize> {
        let mut all = Vec::new();
        Grid::over(r, |c| all.extend(self.cells.get(&c).into_iter().flatten()));
        all.sort_unstable();
        all.dedup();
        all
    }
}

fn overlaps(solids: &[(Solid, Rect)], found: &mut Vec<String>) {
    let grid = Grid::new(solids);
    for (k, (what, r)) in solids.iter().enumerate() {
        for o in grid.near(r).into_iter().filter(|o| *o > k) {
            let (other, s) = &solids[o];
            if r.overlaps(s) {
                found.push(format!("{what:?} {r:?} overlaps {other:?} {s:?}"));
            }
        }
    }
}

/// Checks that each link of the chart is drawn once, or broken with two ends.
fn whole(chart: &Chart, p: &Placement, found: &mut Vec<String>) {
    let mut expected: Vec<(End, End)> = Vec::new();
    let mut numbers: HashMap<&str, u32> = HashMap::new();
    for (n, s) in (0..).zip(chart.steps()) {
        numbers.entry(&s.name.text).or_insert(n);
    }
    let step = |n: &g7_model::Name| numbers.get(&*n.text).map(|n| End::Step(*n));
    for (n, t) in (0..).zip(chart.transitions()) {
        let mut of: Vec<(End, End)> =
            t.from.iter().filter_map(step).map(|s| (s, End::Transition(n))).collect();
        of.extend(t.to.iter().filter_map(step).map(|s| (End::Transition(n), s)));
        of.sort_by_key(|l| format!("{l:?}"));
        of.dedup();
        expected.extend(of);
    }
    let mut drawn: HashMap<(End, End), usize> = HashMap::new();
    p.links.iter().for_each(|l| *drawn.entry((l.from, l.to)).or_default() += 2);
    for c in &p.connectors {
        *drawn.entry((c.from, c.to)).or_default() += 1;
        let ends = p.connectors.iter().filter(|o| (o.from, o.to, o.leaving) == (c.from, c.to, c.leaving));
        if ends.count() != 1 {
            found.push(format!("connector {c:?} is there more than once"));
        }
    }
    for l in &expected {
        if drawn.remove(l) != Some(2) {
            found.push(format!("link {l:?} is not drawn once"));
        }
    }
    if !drawn.is_empty() {
        found.push("links that the chart does not have".to_owned());
    }
}

fn port(p: &Placement, end: End, leaving: bool) -> Option<Point> {
    match end {
        End::Step(n) => {
            let at = p.steps.get(n as usize)?;
            Some(Point { x: at.x, y: at.y + if leaving { 500 } else { 0 } })
        }
        End::Transition(n) => p.transitions.get(n as usize).copied(),
    }
}

/// Checks that links are orthogonal, begin and end at their symbols, and have an arrow if they run
/// upward.
fn links(p: &Placement, found: &mut Vec<String>) {
    for l in &p.links {
        if l.points.first().copied() != port(p, l.from, true)
            || l.points.last().copied() != port(p, l.to, false)
        {
            found.push(format!("link {l:?} hangs in the air"));
        }
        let pieces = || l.points.windows(2).map(|w| (w[0], w[1]));
        if pieces().any(|(a, b)| (a.x == b.x) == (a.y == b.y)) {
            found.push(format!("link {l:?} has a piece that is oblique or empty"));
        }
        for (a, b) in pieces().filter(|(a, b)| b.y < a.y) {
            let on = |q: &Point| q.x == a.x && q.y >= b.y && q.y <= a.y;
            if !l.arrows.iter().any(|(q, way)| on(q) && *way == (0, -1)) {
                found.push(format!("link {l:?} runs up without an arrow"));
            }
        }
    }
}

/// Checks that no line crosses a part that it does not belong to.
fn crossings(p: &Placement, solids: &[(Solid, Rect)], found: &mut Vec<String>) {
    let grid = Grid::new(solids);
    let lines = p.links.iter().map(|l| (l.from, l.to, &l.points, true));
    let broken = p.connectors.iter().map(|c| (c.from, c.to, &c.points, false));
    for (from, to, points, whole) in lines.chain(broken) {
        let own = |s: &Solid| match s {
            Solid::Symbol(e) => *e == from || *e == to,
            Solid::Bar(t) => [from, to].contains(&End::Transition(*t)),
            Solid::Connector(a, b) => !whole && (*a, *b) == (from, to),
        };
        for w in points.windows(2) {
            let (a, b) = (w[0], w[1]);
            let (x, y) = (a.x.min(b.x), a.y.min(b.y));
            let line = Rect { x, y, w: (a.x - b.x).abs(), h: (a.y - b.y).abs() };
            for k in grid.near(&line) {
                let (what, r) = &solids[k];
                let through = line.x < r.x + r.w
                    && r.x < line.x + line.w.max(1)
                    && line.y < r.y + r.h
                    && r.y < line.y + line.h.max(1);
                if through && !own(what) {
                    found.push(format!("{from:?} -> {to:?} runs through {what:?} {r:?}: {a:?} {b:?}"));
                }
            }
        }
    }
}
