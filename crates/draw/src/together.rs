//! Several charts on one sheet (decision 85): the place of each, its title, and the frame of an enclosed chart. The page
//! and the pictures of files show the same.
//!
//! A chart stands where its layout section says. The others stand in rows, as if nobody had arranged anything; one that
//! would lie on an arranged chart gives way to the right of all. No two charts overlap that nobody has placed.

use std::collections::HashMap;

use g7_model::{ActionKind, Chart, ChartKind, Document, Item as Entry, Order, Placed, StepKind};

use crate::ink::Picture;
use crate::layout::section::FAR;
use crate::text::{clean, shortened, width};
use crate::{Drawing, Point, Rect};

/// Distance between two charts on a sheet.
const BETWEEN: i32 = 600;
/// Text size of the name over a chart.
const TITLE: i32 = 180;
/// Text size of the comment beside the name.
const SUBTITLE: i32 = 130;
/// Distance from the frame round an opened chart to the chart and its title.
const ROUND: i32 = 150;
/// Distance from the title to the chart.
const UNDER_TITLE: i32 = 180;

/// A chart on the sheet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Arranged {
    /// How far its drawing is moved: the place of the origin of the chart on the sheet.
    pub by: Point,
    /// Its title, in the coordinates of the sheet.
    pub title: Picture,
    /// The frame round an enclosed chart, in the coordinates of the sheet; empty for any other.
    pub frame: Picture,
    /// The box of the chart with its title and frame, on the sheet.
    pub area: Rect,
}

/// The places of several charts of a document on one sheet.
#[inline(never)]
pub fn together(document: &Document, drawings: &[Drawing]) -> Vec<Arranged> {
    let nesting = Nesting::of(document);
    let titles: Vec<(Picture, Picture)> = drawings.iter().map(|d| title(&nesting, d)).collect();
    let whole = |(d, (title, frame)): (&Drawing, &(Picture, Picture))| {
        let parts = [title.area(), frame.area()].into_iter().flatten();
        parts.fold(d.area, |all, part| all.union(&part))
    };
    let boxes: Vec<Rect> = drawings.iter().zip(&titles).map(whole).collect();
    let moves = moves(&boxes, &given(document, drawings));
    let arranged = |(((title, frame), area), by): (((Picture, Picture), Rect), Point)| Arranged {
        by,
        title: title.moved(by),
        frame: frame.moved(by),
        area: put(&area, by),
    };
    titles.into_iter().zip(boxes).zip(moves).map(arranged).collect()
}

/// A chart that is opened beside others: in a frame, joined by a thin line to the step that opens it. `square` is the
/// square of that step on the sheet, `free` the corner right of which and below which there is room.
#[inline(never)]
pub fn opened(document: &Document, drawing: &Drawing, square: Rect, free: Point) -> Arranged {
    let (title, frame) = title(&Nesting::of(document), drawing);
    let parts = [title.area(), frame.area()].into_iter().flatten();
    let inner = parts.fold(drawing.area, |all, part| all.union(&part));
    let corner = Point { x: free.x + BETWEEN, y: free.y.max(square.y - ROUND) };
    let by = Point { x: corner.x + ROUND - inner.x, y: corner.y + ROUND - inner.y };
    let area = Rect { x: corner.x, y: corner.y, w: inner.w + 2 * ROUND, h: inner.h + 2 * ROUND };
    let mut frame = Picture::default();
    frame.rect("g7-frame", area.x, area.y, area.w, area.h);
    let middle = square.y + square.h / 2;
    // If the step stands above or below the frame, the line meets the frame near its upper or lower corner.
    let entry = middle.clamp(area.y + ROUND, area.y + area.h - ROUND);
    let bend = area.x - BETWEEN / 2;
    let line = [(square.x + square.w, middle), (bend, middle), (bend, entry), (area.x, entry)];
    frame.line("g7-frame", &line);
    Arranged { by, title: title.moved(by), frame, area }
}

fn put(area: &Rect, by: Point) -> Rect {
    Rect { x: area.x + by.x, y: area.y + by.y, ..*area }
}

/// The places that the layout sections give.
fn given(document: &Document, drawings: &[Drawing]) -> Vec<Option<Point>> {
    let mut places: HashMap<&str, Option<Point>> = HashMap::new();
    for item in &document.items {
        if let Entry::Layout(l) = item {
            let place = l.places.iter().find(|p| p.what == Placed::Sheet);
            let place = place.map(|p| Point { x: p.x.clamp(-FAR, FAR), y: p.y.clamp(-FAR, FAR) });
            places.entry(&l.chart.text).or_insert(place);
        }
    }
    drawings.iter().map(|d| places.get(&*d.chart).copied().flatten()).collect()
}

/// How far each box is moved: to its given place, or into a row.
fn moves(boxes: &[Rect], given: &[Option<Point>]) -> Vec<Point> {
    let mut taken: Vec<Rect> = boxes.iter().zip(given).filter_map(|(b, at)| Some(put(b, (*at)?))).collect();
    let top = taken.iter().map(|t| t.y).min().unwrap_or(0);
    let rows = rows(boxes);
    let mut place = |((b, at), row): ((&Rect, &Option<Point>), Point)| {
        if let Some(at) = at {
            return *at;
        }
        let mut corner = row;
        let room =
            Rect { x: corner.x - BETWEEN / 2, y: corner.y - BETWEEN / 2, w: b.w + BETWEEN, h: b.h + BETWEEN };
        if taken.iter().any(|t| t.overlaps(&room)) {
            let right = taken.iter().map(|t| t.x + t.w).max().unwrap_or(0);
            corner = Point { x: right + BETWEEN, y: top };
        }
        taken.push(Rect { x: corner.x, y: corner.y, ..*b });
        Point { x: corner.x - b.x, y: corner.y - b.y }
    };
    boxes.iter().zip(given).zip(rows).map(&mut place).collect()
}

/// Places boxes in rows without changing their order. A row is no wider than the widest box or than
/// a sheet that is somewhat wider than high.
fn rows(boxes: &[Rect]) -> Vec<Point> {
    let ink: i64 = boxes.iter().map(|b| i64::from(b.w + BETWEEN) * i64::from(b.h + BETWEEN)).sum();
    let widest = boxes.iter().map(|b| b.w).max().unwrap_or(0);
    let room = widest.max(i32::try_from((ink * 3 / 2).isqrt()).unwrap_or(i32::MAX));
    let (mut x, mut y, mut high) = (0, 0, 0);
    let mut places = Vec::new();
    for b in boxes {
        if x > 0 && x + b.w > room {
            (x, y, high) = (0, y + high + BETWEEN, 0);
        }
        places.push(Point { x, y });
        x += b.w + BETWEEN;
        high = high.max(b.h);
    }
    places
}

/// The title over a chart: its name, the macro-step or enclosing step it belongs to, and its
/// comment. An enclosed chart also gets a frame, beside the name of its enclosing step.
fn title(nesting: &Nesting<'_>, drawing: &Drawing) -> (Picture, Picture) {
    let (mut p, mut frame) = (Picture::default(), Picture::default());
    let name = &*drawing.chart;
    let Some(chart) = nesting.charts.get(name) else { return (p, frame) };
    let name = match (chart.kind, nesting.macro_steps.get(name)) {
        (ChartKind::Expansion, Some(step)) if *step != name => {
            format!("{} = {}", short(step), short(name))
        }
        (ChartKind::Chart | ChartKind::Expansion | ChartKind::Task, _) => short(&chart.name.text),
    } + &parameters(chart);
    let (mut x, y) = (drawing.area.x, drawing.area.y - UNDER_TITLE);
    if let Some(step) = nesting.enclosing.get(&*drawing.chart) {
        let (step, _) = shortened(&clean(step), SUBTITLE, 2000);
        x += enclosing_mark(&mut p, x, y, &step) + 100;
    }
    let enclosed = !p.ink.is_empty();
    p.text("g7-title", x, y, TITLE, &name);
    if let Some(comment) = &chart.comment {
        let (comment, _) = shortened(&clean(comment), SUBTITLE, 6000);
        p.text("g7-note", x + width(&name, TITLE) + 120, y, SUBTITLE, &comment);
    }
    if enclosed {
        let all = p.area().unwrap_or_default().union(&drawing.area);
        frame.rect("g7-frame", all.x - 150, all.y - 120, all.w + 300, all.h + 270);
    }
    (p, frame)
}

/// `(i, speed)`, the names of the parameters; ` of Gripper`, the function block of the chart.
fn parameters(chart: &Chart) -> String {
    if let Some(block) = &chart.block {
        return format!(" of {}", short(&block.text));
    }
    let names: Vec<&str> = chart.params.iter().map(|p| &*p.name.text).collect();
    if names.is_empty() { String::new() } else { short(&format!("({})", names.join(", "))) }
}

fn short(name: &str) -> String {
    shortened(&clean(name), TITLE, 4000).0
}

/// Draws a small symbol of an enclosing step with its name; returns its width.
fn enclosing_mark(p: &mut Picture, x: i32, y: i32, step: &str) -> i32 {
    let (h, c) = (260, 60);
    let w = (width(step, SUBTITLE) + 120).max(h);
    let top = y - TITLE * 35 / 100 - h / 2;
    let (right, low) = (x + w, top + h);
    p.rect("g7-box", x, top, w, h);
    p.line("g7-inner", &[(x, top + c), (x + c, top)]);
    p.line("g7-inner", &[(right - c, top), (right, top + c)]);
    p.line("g7-inner", &[(right, low - c), (right - c, low)]);
    p.line("g7-inner", &[(x + c, low), (x, low - c)]);
    p.text("g7-name", x + (w - width(step, SUBTITLE)) / 2, top + h / 2 + SUBTITLE * 35 / 100, SUBTITLE, step);
    w
}

/// The charts of a document by name, and the step that each belongs to. Of several with one name
/// the first in the text counts.
#[derive(Default)]
struct Nesting<'a> {
    charts: HashMap<&'a str, &'a Chart>,
    /// By the name of an expansion: its macro-step.
    macro_steps: HashMap<&'a str, &'a str>,
    /// By the name of an enclosed chart: its enclosing step.
    enclosing: HashMap<&'a str, &'a str>,
}

impl<'a> Nesting<'a> {
    fn of(document: &'a Document) -> Nesting<'a> {
        let mut all = Nesting::default();
        for chart in document.charts() {
            all.charts.entry(&chart.name.text).or_insert(chart);
        }
        for step in document.charts().flat_map(Chart::steps) {
            if let StepKind::Macro(expansion) = &step.kind {
                all.macro_steps.entry(&expansion.text).or_insert(&step.name.text);
            }
            for action in &step.actions {
                if let ActionKind::Order(Order::Enclose(chart)) = &action.kind {
                    all.enclosing.entry(&chart.text).or_insert(&step.name.text);
                }
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn charts_on_a_sheet_keep_their_order_and_their_distance() {
        let boxes = [(900, 2000), (800, 500), (4000, 700), (10, 10)].map(|(w, h)| Rect { x: 5, y: 5, w, h });
        let places = rows(&boxes);
        let put: Vec<Rect> = boxes.iter().zip(&places).map(|(b, p)| Rect { x: p.x, y: p.y, ..*b }).collect();
        for (i, a) in put.iter().enumerate() {
            assert!(put[i + 1..].iter().all(|b| !a.overlaps(b)), "{put:?}");
        }
        assert!(places.windows(2).all(|w| (w[0].y, w[0].x) < (w[1].y, w[1].x)), "{places:?}");
    }

    #[test]
    fn a_chart_that_is_in_the_way_of_an_arranged_one_gives_way() {
        let boxes = [(900, 2000), (800, 500), (4000, 700)].map(|(w, h)| Rect { x: -5, y: 5, w, h });
        let free = moves(&boxes, &[None, None, None]);
        // The first is put on to the second; the third stays.
        let onto = free[1];
        let put_all = moves(&boxes, &[Some(onto), None, None]);
        assert_eq!(put_all[0], onto);
        assert_ne!(put_all[1], free[1]);
        assert_eq!(put_all[2], free[2]);
        let all: Vec<Rect> = boxes.iter().zip(&put_all).map(|(b, by)| put(b, *by)).collect();
        for (i, a) in all.iter().enumerate() {
            assert!(all[i + 1..].iter().all(|b| !a.overlaps(b)), "{all:?}");
        }
    }
}
