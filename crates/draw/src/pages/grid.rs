//! The size of the cells, and the links between them.

use g7_model::{Chart, Span};

use super::cells::{COLUMNS, Cell, Cells, LINES, cells};
use crate::ink::Picture;
use crate::symbols::{DOUBLE_GAP, SMALL, SQUARE, connector_label, connector_width};
use crate::text::width;
use crate::{Bar, Connector, End, Item, Link, Part, Placement, Point, Rect, Sizes};

/// A chart divided into pages.
pub(crate) struct Paged {
    /// The places of all symbols and links.
    pub(crate) placement: Placement,
    /// The page number of each step, from 1; empty if there is only one page.
    pub(crate) pages: Vec<u32>,
    /// The frames and numbers of the pages.
    pub(crate) frames: Vec<Item>,
}

/// Least half width of a column.
const HALF: i32 = 450;
/// Distance between the texts of two columns.
const GUTTER: i32 = 160;
/// Distance between two pages.
const BETWEEN: i32 = 400;
/// Height of a connector's line.
const CONNECTOR: i32 = 180;
/// Length of the link that is shown before the arrow of an arriving connector.
const ARRIVING: i32 = 160;
/// Distance from a symbol to the links beside it.
const STUB: i32 = 110;

struct Paper<'a> {
    cells: &'a Cells,
    names: Vec<&'a str>,
    /// The left edge of each column, and the right edge of the last one.
    edges: Vec<i32>,
    /// The horizontal position of the link in each column.
    middles: Vec<i32>,
    /// For each page and line: top of the steps' squares, lowest point of the steps, middle of the
    /// bars.
    lines: Vec<[(i32, i32, i32); LINES as usize]>,
    /// The top and bottom of each page.
    spans: Vec<(i32, i32)>,
    /// How far the texts of each transition reach above its bar.
    above: Vec<i32>,
    /// How far the texts of each transition reach below its bar.
    below: Vec<i32>,
    /// How far the texts of each step's actions reach above its square.
    over: Vec<i32>,
}

/// Divides a chart into pages.
pub(crate) fn place(chart: &Chart, sizes: &Sizes) -> Paged {
    let cells = cells(chart);
    let paper = Paper::new(chart, sizes, &cells);
    let mut placement = Placement {
        steps: cells.steps.iter().map(|c| Point { x: paper.x(*c), y: paper.line(*c).0 }).collect(),
        transitions: cells
            .transitions
            .iter()
            .map(|c| Point { x: paper.x(*c), y: paper.line(*c).2 })
            .collect(),
        ..Placement::default()
    };
    paper.links(&mut placement);
    let frames = paper.frames();
    placement.area = frames.iter().map(|f| f.area).fold(Rect::default(), |a, b| a.union(&b));
    let pages = if cells.pages > 1 { cells.steps.iter().map(|c| c.page + 1).collect() } else { Vec::new() };
    Paged { placement, pages, frames }
}

impl<'a> Paper<'a> {
    fn new(chart: &'a Chart, sizes: &Sizes, cells: &'a Cells) -> Paper<'a> {
        let names: Vec<&str> = chart.steps().map(|s| &*s.name.text).collect();
        let mut paper = Paper {
            cells,
            names,
            edges: Vec::new(),
            middles: Vec::new(),
            lines: Vec::new(),
            spans: Vec::new(),
            above: sizes.transitions.iter().map(|e| e.up).collect(),
            below: sizes.transitions.iter().map(|e| e.down).collect(),
            over: sizes.steps.iter().map(|e| e.up).collect(),
        };
        paper.columns(sizes);
        let mut top = 0;
        for page in 0..cells.pages {
            top = paper.page(page, top, sizes) + BETWEEN;
        }
        paper
    }

    fn label(&self, step: u32) -> String {
        let page = self.cells.steps.get(step as usize).map(|c| c.page + 1);
        let name = self.names.get(step as usize).copied().unwrap_or("");
        connector_label(name, page.filter(|_| self.cells.pages > 1))
    }

    /// Computes the width of the columns: on every page as wide as the widest text needs.
    fn columns(&mut self, sizes: &Sizes) {
        let cells = self.cells;
        let widest = |c: Option<(i32, i32)>, e: (i32, i32)| c.map_or(e, |c| (c.0.max(e.0), c.1.max(e.1)));
        let mut sides: Vec<(i32, i32)> = vec![(HALF, HALF); COLUMNS as usize];
        let steps = cells.steps.iter().zip(&sizes.steps);
        for (cell, e) in steps.chain(cells.transitions.iter().zip(&sizes.transitions)) {
            if let Some(side) = sides.get_mut(cell.column as usize) {
                *side = widest(Some(*side), (e.left, e.right));
            }
        }
        for ((from, to), t) in cells.from.iter().zip(&cells.to).zip(&cells.transitions) {
            let labels = from.iter().chain(to).map(|s| connector_width(&self.label(*s)) + 120);
            let need = labels.max().unwrap_or(0);
            for cell in to.iter().filter_map(|s| cells.steps.get(*s as usize)).chain([t]) {
                if let Some(side) = sides.get_mut(cell.column as usize) {
                    side.1 = side.1.max(need);
                }
            }
        }
        let mut x = 0;
        for (left, right) in sides {
            self.edges.push(x);
            self.middles.push(x + left + GUTTER / 2);
            x += left + right + GUTTER;
        }
        self.edges.push(x);
    }

    /// Computes the lines of a page; returns its lower end.
    fn page(&mut self, page: u32, top: i32, sizes: &Sizes) -> i32 {
        let cells = self.cells;
        let mut y = top + 2 * CONNECTOR;
        let mut lines = [(0, 0, 0); LINES as usize];
        for (number, line) in (0..).zip(&mut lines) {
            let here = |c: &Cell| c.page == page && c.line == number;
            let (mut up, mut down) = (0, SQUARE);
            for ((s, _), e) in (0..).zip(&cells.steps).zip(&sizes.steps).filter(|((_, c), _)| here(c)) {
                up = up.max(e.up).max(self.arrivals(s) + STUB);
                down = down.max(e.down).max(self.departing(s));
            }
            let (mut over, mut under) = (0, 0);
            for ((t, _), e) in
                (0..).zip(&cells.transitions).zip(&sizes.transitions).filter(|((_, c), _)| here(c))
            {
                let leaving = self.leaving(t) * CONNECTOR;
                let entering = self.entering(t);
                let double = if entering > 1 { 3 * DOUBLE_GAP } else { 0 };
                over = over.max(e.up + double + entering * CONNECTOR);
                let broken = if leaving > 0 { leaving + STUB + 3 * DOUBLE_GAP } else { 0 };
                under = under.max(e.down + broken);
            }
            line.0 = y + up;
            line.1 = line.0 + down;
            line.2 = line.1 + 2 * STUB + DOUBLE_GAP + over;
            y = line.2 + under + 2 * STUB + DOUBLE_GAP;
        }
        let low = y + CONNECTOR;
        self.lines.push(lines);
        self.spans.push((top, low));
        low
    }

    fn x(&self, cell: Cell) -> i32 {
        self.middles.get(cell.column as usize).copied().unwrap_or(0)
    }

    fn line(&self, cell: Cell) -> (i32, i32, i32) {
        self.lines
            .get(cell.page as usize)
            .and_then(|p| p.get(cell.line as usize))
            .copied()
            .unwrap_or_default()
    }

    /// True if the link from a transition to a step is drawn: the step stands in the next line, and
    /// of the links at one double line either all are drawn or none.
    fn runs_on(&self, t: u32, s: u32) -> bool {
        let to = self.cells.to.get(t as usize).map_or(&[][..], Vec::as_slice);
        match self.cells.transitions.get(t as usize) {
            Some(at) if to.len() > 1 => {
                let next = to.iter().filter_map(|s| self.cells.steps.get(*s as usize));
                let crossed = self.between(next.clone().map(|c| c.column), at.column, |column| {
                    let here = Cell { line: at.line + 1, column, ..*at };
                    self.cells.steps.contains(&here) && !next.clone().any(|c| *c == here)
                });
                !crossed && to.iter().all(|s| self.is_next(t, *s))
            }
            _ => self.is_next(t, s),
        }
    }

    /// True if a step stands in the line below a transition and not left of it.
    fn is_next(&self, t: u32, s: u32) -> bool {
        match (self.cells.transitions.get(t as usize), self.cells.steps.get(s as usize)) {
            (Some(t), Some(s)) => t.page == s.page && t.line + 1 == s.line && s.column >= t.column,
            _ => false,
        }
    }

    /// True if the link from a step to a transition is drawn; of the links at one double line
    /// either all are drawn or none.
    fn runs_into(&self, s: u32, t: u32) -> bool {
        let from = self.cells.from.get(t as usize).map_or(&[][..], Vec::as_slice);
        let (Some(at), Some(to)) = (self.cells.steps.get(s as usize), self.cells.transitions.get(t as usize))
        else {
            return false;
        };
        if from.len() < 2 {
            return at.page == to.page && at.line == to.line;
        }
        // The double line stands where the links to other branches would part.
        let alone = |s: &u32| self.cells.behind.get(*s as usize).is_some_and(|b| b.len() == 1);
        let above = from.iter().filter_map(|s| self.cells.steps.get(*s as usize));
        let crossed = self.between(above.clone().map(|c| c.column), to.column, |column| {
            let here = Cell { column, ..*to };
            here != *to && self.cells.transitions.contains(&here)
        });
        !crossed && from.iter().all(alone) && above.clone().all(|c| c.page == to.page && c.line <= to.line)
    }

    /// True if `met` holds for a column between the outermost of these columns.
    fn between(&self, columns: impl Iterator<Item = u32>, own: u32, met: impl Fn(u32) -> bool) -> bool {
        let (least, most) = columns.fold((own, own), |(a, b), c| (a.min(c), b.max(c)));
        (least..=most).any(met)
    }

    fn count(list: impl Iterator<Item = bool>) -> i32 {
        i32::try_from(list.filter(|b| *b).count()).unwrap_or(0)
    }

    /// The number of broken links that arrive at a step.
    fn arriving(&self, s: u32) -> i32 {
        let into = (0..).zip(&self.cells.to).filter(|(_, to)| to.contains(&s));
        Paper::count(into.map(|(t, _)| !self.runs_on(t, s)))
    }

    /// How high the connectors that arrive at a step stand over it: above the conditions of its
    /// actions.
    fn arrivals(&self, s: u32) -> i32 {
        match self.arriving(s) {
            0 => 0,
            n => self.over.get(s as usize).copied().unwrap_or(0) + n * CONNECTOR,
        }
    }

    /// How far the broken links from a step to its transitions reach below its upper edge.
    fn departing(&self, s: u32) -> i32 {
        let behind = self.cells.behind.get(s as usize).map_or(&[][..], Vec::as_slice);
        let broken = Paper::count(behind.iter().map(|t| !self.runs_into(s, *t)));
        SQUARE + if broken > 0 { STUB + broken * CONNECTOR } else { 0 }
    }

    /// The number of broken links that leave a transition.
    fn leaving(&self, t: u32) -> i32 {
        let to = self.cells.to.get(t as usize).map_or(&[][..], Vec::as_slice);
        Paper::count(to.iter().map(|s| !self.runs_on(t, *s)))
    }

    /// The number of broken links that enter a transition.
    fn entering(&self, t: u32) -> i32 {
        let from = self.cells.from.get(t as usize).map_or(&[][..], Vec::as_slice);
        Paper::count(from.iter().map(|s| !self.runs_into(*s, t)))
    }

    fn links(&self, p: &mut Placement) {
        for ((t, from), to) in (0..).zip(&self.cells.from).zip(&self.cells.to) {
            let Some(at) = p.transitions.get(t as usize).copied() else { continue };
            let Some(cell) = self.cells.transitions.get(t as usize) else { continue };
            let (_, low, _) = self.line(*cell);
            let (join, fork) = (low + STUB, self.fork(*cell));
            self.into(p, t, at, from, join);
            self.onward(p, t, at, to, fork);
        }
    }

    /// The height at which the links below the transitions of a line run.
    fn fork(&self, cell: Cell) -> i32 {
        let below = Cell { line: cell.line + 1, ..cell };
        let next = if below.line < LINES {
            self.line(below).0
        } else {
            self.spans.get(cell.page as usize).map_or(0, |s| s.1)
        };
        // Above the connectors that arrive at the steps of the next line.
        let arrive =
            (0..).zip(&self.cells.steps).filter(|(_, c)| c.page == below.page && c.line == below.line);
        let most = arrive.map(|(s, _)| self.arrivals(s)).max().unwrap_or(0);
        next - STUB - DOUBLE_GAP - most
    }

    fn into(&self, p: &mut Placement, t: u32, at: Point, from: &[u32], join: i32) {
        let double = if from.len() > 1 { 3 * DOUBLE_GAP } else { 0 };
        let high = at.y - self.above.get(t as usize).copied().unwrap_or(0) - double;
        let mut entering = 0;
        let mut reach: Vec<i32> = Vec::new();
        for s in from {
            let Some(step) = p.steps.get(*s as usize).copied() else { continue };
            let bottom = Point { x: step.x, y: step.y + SQUARE };
            let (link_from, link_to) = (End::Step(*s), End::Transition(t));
            if self.runs_into(*s, t) {
                let points = if from.len() > 1 {
                    reach.push(step.x);
                    vec![bottom, Point { x: step.x, y: join }]
                } else {
                    bent(bottom, at, join)
                };
                p.links.push(Link::new(link_from, link_to, points, Vec::new()));
            } else {
                let tip = Point { x: at.x, y: high - entering * CONNECTOR };
                entering += 1;
                let target = self.next_step(t);
                let before = p.connectors.iter().filter(|c| c.leaving && c.from == link_from).count();
                let before = i32::try_from(before).unwrap_or(0);
                let after = Point { x: step.x, y: bottom.y + DOUBLE_GAP + (before + 1) * CONNECTOR };
                p.connectors.push(self.connector(link_from, link_to, true, after, target));
                p.connectors.push(self.connector(link_from, link_to, false, tip, Some(*s)));
            }
        }
        if from.len() > 1 && !reach.is_empty() {
            bar(p, t, true, &reach, at.x, join);
        } else if from.len() > 1 {
            bar(p, t, true, &[at.x - 60, at.x + 60], at.x, high + DOUBLE_GAP);
        }
    }

    fn onward(&self, p: &mut Placement, t: u32, at: Point, to: &[u32], fork: i32) {
        let mut reach: Vec<i32> = Vec::new();
        let low = at.y + self.below.get(t as usize).copied().unwrap_or(0);
        let first = if to.len() > 1 { 3 * DOUBLE_GAP } else { DOUBLE_GAP };
        let mut leaving = 0;
        for s in to {
            let Some(step) = p.steps.get(*s as usize).copied() else { continue };
            let (from, into) = (End::Transition(t), End::Step(*s));
            if self.runs_on(t, *s) {
                let points = if to.len() > 1 {
                    reach.push(step.x);
                    vec![Point { x: step.x, y: fork + DOUBLE_GAP }, step]
                } else {
                    bent(at, step, fork)
                };
                p.links.push(Link::new(from, into, points, Vec::new()));
            } else {
                leaving += 1;
                let tip = Point { x: at.x, y: low + first + leaving * CONNECTOR };
                p.connectors.push(self.connector(from, into, true, tip, Some(*s)));
                let before = p.connectors.iter().filter(|c| !c.leaving && c.to == into).count();
                let before = i32::try_from(before).unwrap_or(0);
                let over = self.over.get(*s as usize).copied().unwrap_or(0);
                let tip = Point { x: step.x, y: step.y - over - before * CONNECTOR };
                let origin = self.cells.from.get(t as usize).and_then(|f| f.first()).copied();
                let mut arriving = self.connector(from, into, false, tip, origin);
                if before == 0 {
                    arriving.at = step;
                    arriving.points = vec![Point { y: tip.y - ARRIVING, ..tip }, step];
                }
                p.connectors.push(arriving);
            }
        }
        if to.len() > 1 && !reach.is_empty() {
            bar(p, t, false, &reach, at.x, fork);
        } else if to.len() > 1 {
            // All links are broken, so their ends stand below the double line.
            bar(p, t, false, &[at.x - 60, at.x + 60], at.x, low + DOUBLE_GAP);
        }
    }

    fn next_step(&self, t: u32) -> Option<u32> {
        self.cells.to.get(t as usize).and_then(|to| to.first()).copied()
    }

    fn connector(&self, from: End, to: End, leaving: bool, at: Point, named: Option<u32>) -> Connector {
        let w = named.map_or(0, |s| connector_width(&self.label(s)));
        let text = Rect { x: at.x + 80, y: at.y - 150, w, h: 150 };
        Connector { from, to, leaving, at, points: Vec::new(), text, form: None }
    }

    fn frames(&self) -> Vec<Item> {
        let mut items = Vec::new();
        let right = self.edges.last().copied().unwrap_or(0);
        for (page, (top, low)) in (1..).zip(&self.spans) {
            let mut p = Picture::default();
            p.rect("g7-frame", 0, *top, right, low - top);
            for x in self.edges.iter().skip(1).take(COLUMNS as usize - 1) {
                p.line("g7-grid", &[(*x, *top), (*x, top + 60)]);
                p.line("g7-grid", &[(*x, low - 60), (*x, *low)]);
            }
            let text = format!("{page} / {}", self.cells.pages);
            p.text("g7-label", right - width(&text, SMALL) - 60, top + 160, SMALL, &text);
            let area = p.area().unwrap_or_default();
            items.push(Item { part: Part::Text, area, picture: p, at: Span::default() });
        }
        items
    }
}

/// A line that goes down, across at a given height, and down again.
fn bent(from: Point, to: Point, across: i32) -> Vec<Point> {
    if from.x == to.x {
        return vec![from, to];
    }
    vec![from, Point { x: from.x, y: across }, Point { x: to.x, y: across }, to]
}

/// A double line over the links that it joins, and the link between it and the transition.
fn bar(p: &mut Placement, t: u32, join: bool, reach: &[i32], x: i32, y: i32) {
    let left = reach.iter().copied().min().unwrap_or(x).min(x) - 100;
    let right = reach.iter().copied().max().unwrap_or(x).max(x) + 100;
    p.bars.push(Bar { transition: t, join, at: Point { x: left, y }, w: right - left });
}
