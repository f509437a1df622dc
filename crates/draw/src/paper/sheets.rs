//! Divides a chart into sheets of paper. A chart that fits is drawn as it is laid out; of others the symbols are taken in
//! the order in which a reader follows the sequences. Parts of as many symbols as fit on a sheet are laid out by
//! themselves, and small parts share a sheet.

use std::collections::{HashMap, HashSet};

use g7_model::{Chart, Document};

use super::frame::Paper;
use super::part::{Flow, Part};
use crate::draw::{draw, notes_of};
use crate::{Drawing, End, Item, Options, Point, Rect};

/// One sheet of a chart.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sheet {
    /// The drawing on it. Symbols have the numbers that they have in the whole chart.
    pub drawing: Drawing,
    /// Its steps and transitions.
    pub symbols: Vec<End>,
    /// The ends of links that lead to other sheets.
    pub away: Vec<Away>,
    /// Thousandths of the usual size.
    pub scale: i32,
}

/// The end of a link that leads to another sheet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Away {
    /// Its start.
    pub from: End,
    /// Its end.
    pub to: End,
    /// True at the start of the link.
    pub leaving: bool,
    /// The number of the sheet with the other end.
    pub page: usize,
    /// The step that is named: at the other end, or beyond the transition there; empty if there is none.
    pub name: String,
}

/// Least size in thousandths: the texts of actions and comments are then 6 pt high.
const LEAST: i32 = 900;
/// Symbols that are tried first on a sheet.
const FIRST: usize = 24;

/// Divides a chart into sheets, which are numbered from `first` on.
pub fn sheets(
    document: &Document,
    chart: &Chart,
    options: &Options,
    paper: &Paper,
    first: usize,
) -> Vec<Sheet> {
    let room = paper.room();
    let whole = draw(document, chart, &Options { pages: false, ..*options });
    let scale = fitting(whole.area, room);
    let count = chart.steps().count() + chart.transitions().count();
    if scale >= LEAST || count < 2 {
        let steps = (0..chart.steps().count() as u32).map(End::Step);
        let transitions = (0..chart.transitions().count() as u32).map(End::Transition);
        let symbols = steps.chain(transitions).collect();
        return vec![Sheet { drawing: whole, symbols, away: Vec::new(), scale }];
    }
    let flow = Flow::new(document, chart, options);
    let digits = (first + flow.cells.order.len()).to_string().len();
    let notes = notes(document, chart, &flow, &whole);
    let full = room.map(|side| side * 1000 / LEAST);
    let parts = Filling { flow: &flow, digits, full, notes: &notes }.parts();
    let shared = in_rows(&parts, full);
    let numbered = (first..).zip(&shared).flat_map(|(number, parts)| {
        parts.iter().flat_map(move |(part, _)| part.own().map(move |s| (s, number)))
    });
    let page: HashMap<End, usize> = numbered.collect();
    let page = |of: End| page.get(&of).copied().unwrap_or(first);
    let put = Putting { flow: &flow, chart, notes: &notes, page: &page, room };
    let mut made: Vec<Sheet> = shared.iter().map(|parts| put.sheet(parts)).collect();
    // All sheets of a chart have one size, but for one with a symbol that is larger than a sheet.
    let common = made.iter().map(|s| s.scale).filter(|s| *s >= LEAST).min().unwrap_or(LEAST);
    made.iter_mut().for_each(|s| s.scale = s.scale.min(common));
    made
}

/// Distance between two parts on a sheet.
const BESIDE: i32 = 500;

/// The parts of each sheet, each with the upper left corner that it gets there: in rows.
fn in_rows(parts: &[Filled], [width, height]: [i32; 2]) -> Vec<Vec<(&Part, Point)>> {
    let mut sheets: Vec<Vec<(&Part, Point)>> = Vec::new();
    // The free end of the row, and the lowest end of what stands in it.
    let (mut at, mut low) = (Point::default(), 0);
    for Filled { part, width: w, height: h } in parts {
        let beside = Point { x: at.x, y: at.y };
        let under = Point { x: 0, y: low + BESIDE };
        let fits = |p: Point| p.x + w <= width && p.y + h <= height;
        let place = [beside, under].into_iter().find(|p| !sheets.is_empty() && fits(*p));
        let place = match (place, sheets.last_mut()) {
            (Some(place), Some(sheet)) => {
                sheet.push((part, place));
                place
            }
            _ => {
                sheets.push(vec![(part, Point::default())]);
                low = 0;
                Point::default()
            }
        };
        at = Point { x: place.x + w + BESIDE, y: place.y };
        low = low.max(place.y + h);
    }
    sheets
}

/// The comments of the layout section, by the symbol that is next to each.
fn notes(document: &Document, chart: &Chart, flow: &Flow<'_>, whole: &Drawing) -> HashMap<End, Vec<Item>> {
    let mut all: HashMap<End, Vec<Item>> = HashMap::new();
    for note in notes_of(document, chart) {
        let centre = |r: &Rect| (i64::from(r.x) + i64::from(r.w) / 2, i64::from(r.y) + i64::from(r.h) / 2);
        let (x, y) = centre(&note.area);
        let far = |item: &&Item| {
            let (a, b) = centre(&item.area);
            (a - x).pow(2) + (b - y).pow(2)
        };
        let symbol = |item: &Item| match item.part {
            crate::Part::Step { step, .. } => Some(End::Step(step)),
            _ => None,
        };
        let near = whole.items.iter().filter(|i| symbol(i).is_some()).min_by_key(far).and_then(symbol);
        if let Some(at) = near.or(flow.cells.order.first().copied()) {
            all.entry(at).or_default().push(note);
        }
    }
    all
}

/// The size at which an area fits, in thousandths; at most the usual size.
fn fitting(area: Rect, room: [i32; 2]) -> i32 {
    let part = |has: i32, needs: i32| i64::from(has) * 1000 / i64::from(needs.max(1));
    let [w, h] = room;
    part(w, area.w).min(part(h, area.h)).clamp(1, 1000) as i32
}

/// Takes symbols in their order, as many as fit on each sheet.
struct Filling<'f, 'a> {
    flow: &'f Flow<'a>,
    digits: usize,
    /// The width and height that a sheet has at the least size.
    full: [i32; 2],
    notes: &'f HashMap<End, Vec<Item>>,
}

/// A part of the chart, and its size with the comments under it.
struct Filled {
    part: Part,
    width: i32,
    height: i32,
}

impl Filling<'_, '_> {
    fn parts(&self) -> Vec<Filled> {
        let mut rest = self.flow.cells.order.as_slice();
        let mut parts = Vec::new();
        while !rest.is_empty() {
            let most = self.most(rest);
            let (count, part) = self.cut(rest, most);
            parts.push(part);
            rest = rest.get(count..).unwrap_or(&[]);
        }
        parts
    }

    fn part(&self, members: &[End]) -> Filled {
        let part = Part::new(self.flow, members, self.digits);
        let wide = self.notes(members).map(|n| n.area.w).max().unwrap_or(0);
        let below: i32 = self.notes(members).map(under).sum();
        Filled { width: part.area.w.max(wide), height: part.area.h + below, part }
    }

    fn notes(&self, members: &[End]) -> impl Iterator<Item = &Item> {
        members.iter().filter_map(|m| self.notes.get(m)).flatten()
    }

    fn fits(&self, members: &[End]) -> Option<Filled> {
        let filled = self.part(members);
        let [w, h] = self.full;
        (filled.width <= w && filled.height <= h).then_some(filled)
    }

    /// The number of symbols that fit on a sheet; at least one.
    fn most(&self, rest: &[End]) -> usize {
        let fits = |count: usize| rest.get(..count).is_some_and(|members| self.fits(members).is_some());
        let mut over = FIRST.min(rest.len());
        let mut under = 1;
        while fits(over) {
            under = over;
            if over == rest.len() {
                return under;
            }
            over = (over * 2).min(rest.len());
        }
        while over - under > 1 {
            let middle = under + (over - under) / 2;
            if fits(middle) { under = middle } else { over = middle }
        }
        under
    }

    /// Ends the sheet where the fewest links are cut, in the last third of what fits; before a step rather than before
    /// a transition.
    fn cut(&self, rest: &[End], most: usize) -> (usize, Filled) {
        if most == rest.len() {
            return (most, self.part(rest));
        }
        let mut open: HashSet<(End, End)> = HashSet::new();
        let mut seen: HashSet<End> = HashSet::new();
        let mut ends: Vec<(usize, std::cmp::Reverse<usize>)> = Vec::new();
        for (count, member) in (1..).zip(rest.iter().take(most)) {
            for other in self.flow.neighbours(*member) {
                if !seen.contains(&other) {
                    open.insert((*member, other));
                }
                open.remove(&(other, *member));
            }
            seen.insert(*member);
            if count * 3 >= most * 2 {
                let splits = !matches!(rest.get(count), Some(End::Step(_)) | None);
                ends.push((open.len() * 2 + usize::from(splits), std::cmp::Reverse(count)));
            }
        }
        ends.sort_unstable();
        for (_, std::cmp::Reverse(count)) in ends {
            if let Some(part) = rest.get(..count).and_then(|members| self.fits(members)) {
                return (count, part);
            }
        }
        // A symbol larger than a sheet stands alone.
        (1, self.part(rest.get(..1).unwrap_or(&[])))
    }
}

/// Distance between a comment and the symbol or comment above it.
const OVER_NOTE: i32 = 150;

/// The height that a comment takes under the symbols.
fn under(note: &Item) -> i32 {
    note.area.h + OVER_NOTE
}

/// Puts parts on their sheets.
struct Putting<'f, 'a> {
    flow: &'f Flow<'a>,
    chart: &'f Chart,
    notes: &'f HashMap<End, Vec<Item>>,
    page: &'f dyn Fn(End) -> usize,
    room: [i32; 2],
}

impl Putting<'_, '_> {
    fn sheet(&self, parts: &[(&Part, Point)]) -> Sheet {
        let mut drawing = Drawing { chart: self.chart.name.text.clone(), ..Drawing::default() };
        let (mut symbols, mut away) = (Vec::new(), Vec::new());
        for (part, at) in parts {
            let drawn = self.with_notes(part);
            // A part has the room for which it was measured, whatever its labels have become.
            let corner = Point { x: drawn.area.x.min(part.area.x), y: drawn.area.y.min(part.area.y) };
            let by = at.minus(corner);
            drawing.add(drawn, by);
            symbols.extend(part.own());
            away.extend(part.away().map(|(t, leaving)| Away {
                from: t.from,
                to: t.to,
                leaving,
                page: (self.page)(if leaving { t.to } else { t.from }),
                name: t.name.clone(),
            }));
        }
        Sheet { scale: fitting(drawing.area, self.room), away, symbols, drawing }
    }

    /// A part with its comments under it.
    fn with_notes(&self, part: &Part) -> Drawing {
        let mut drawing = part.draw(self.flow, self.chart, self.page);
        for note in part.own().filter_map(|s| self.notes.get(&s)).flatten() {
            let at = Point { x: drawing.area.x, y: drawing.area.y + drawing.area.h + OVER_NOTE };
            let note = note.clone().moved(at.minus(Point { x: note.area.x, y: note.area.y }));
            drawing.area = drawing.area.union(&note.area);
            drawing.items.push(note);
        }
        drawing
    }
}
