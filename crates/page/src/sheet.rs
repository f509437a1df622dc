//! Drawings of several charts (decision 85): all of a file on one sheet, or a chart with those that its steps open beside it. Their
//! symbols are the same as in drawings of one chart, so gestures, texts and runs need no second way.

use g7_draw::{Arranged, Drawing, Options, Point, Rect};
use g7_edit::{ChartSort, ItemId, StackedAs};
use g7_ide::{File, Readable, ids};
use g7_model::{Chart, Said};

use crate::drawing::{Area, Drawn, Item, Names, Part, Spot, Wish, drawing, opens, sort, unique};

/// The name under which the page asks for all charts of a file on one sheet; no chart can have it.
const SHEET: &str = "*";

/// The drawing that a wish asks for: of one chart, or of several.
pub(crate) fn drawn(file: &File, wish: &Wish) -> Result<Drawn, Said> {
    if wish.chart == SHEET {
        return Ok(all(file.drawn(), wish));
    }
    let readable = file.drawn_chart(&wish.chart);
    let chart = readable.document.charts().find(|c| *c.name.text == *wish.chart);
    match chart {
        Some(chart) if !wish.open.is_empty() => Ok(opened(readable, chart, wish)),
        _ => drawing(file, wish),
    }
}

/// All charts of a document on one sheet, each under its title.
#[inline(never)]
fn all(readable: Readable<'_>, wish: &Wish) -> Drawn {
    let document = readable.document;
    let options = Options { pages: false, ..wish.options() };
    let drawings = g7_draw::draw_all(document, document.charts(), &options);
    let arranged = g7_draw::together(document, &drawings);
    let area = arranged.iter().map(|a| a.area).reduce(|all, area| all.union(&area)).unwrap_or_default();
    let mut items = Vec::new();
    for ((chart, drawing), place) in document.charts().zip(drawings).zip(arranged) {
        put(readable, chart, drawing, Some(place), &mut items);
    }
    Drawn {
        chart: wish.chart.clone(),
        kind: ChartSort::Chart,
        stale: readable.stale,
        area: Area(area),
        actions: StackedAs::Column,
        items: unique(items),
    }
}

/// A chart of a drawing with opened charts.
struct Shown<'d> {
    chart: &'d Chart,
    drawing: Drawing,
    /// Its place if a step opens it; the first chart has none.
    place: Option<Arranged>,
    /// Its box with title and frame.
    area: Rect,
    /// The number of steps that lead to it.
    depth: usize,
}

impl<'d> Shown<'d> {
    /// The charts that its open steps show, each with the square of its step.
    fn wanted(&self, open: &[String]) -> Vec<(&'d str, Rect)> {
        let by = self.place.as_ref().map_or_else(Point::default, |p| p.by);
        let square = |number: u32| {
            let found = self.drawing.items.iter().find_map(|i| match i.part {
                g7_draw::Part::Step { step, square } if step == number => Some(square),
                _ => None,
            });
            found.map(|s| Rect { x: s.x + by.x, y: s.y + by.y, ..s })
        };
        let steps = (0..).zip(self.chart.steps());
        let open = steps.filter(|(_, s)| open.contains(&ids::step(&self.chart.name.text, &s.name.text)));
        let squares = open.filter_map(|(n, step)| Some((step, square(n)?)));
        squares.flat_map(|(step, square)| opens(step).map(move |name| (name, square))).collect()
    }
}

/// A chart, and at its right those that the steps open which the wish names; steps of opened charts open theirs.
#[inline(never)]
fn opened(readable: Readable<'_>, chart: &Chart, wish: &Wish) -> Drawn {
    let document = readable.document;
    let options = Options { pages: false, ..wish.options() };
    let first = g7_draw::draw(document, chart, &options);
    let mut shown = vec![Shown { chart, area: first.area, drawing: first, place: None, depth: 0 }];
    let mut n = 0;
    while let Some(around) = shown.get(n) {
        n += 1;
        let depth = around.depth + 1;
        for (name, square) in around.wanted(&wish.open) {
            // A chart is shown once, however many steps open it.
            if shown.iter().any(|s| *s.chart.name.text == *name) {
                continue;
            }
            let Some(chart) = document.charts().find(|c| *c.name.text == *name) else { continue };
            let drawing = g7_draw::draw(document, chart, &options);
            // At the right of the charts that are opened before it, under those that stand in the same column.
            let before = shown.iter().filter(|s| s.depth < depth);
            let above = shown.iter().filter(|s| s.depth == depth);
            let free = Point {
                x: before.map(|s| s.area.x + s.area.w).max().unwrap_or(0),
                y: above.map(|s| s.area.y + s.area.h + g7_draw::U).max().unwrap_or(i32::MIN),
            };
            let place = g7_draw::opened(document, &drawing, square, free);
            shown.push(Shown { chart, drawing, area: place.area, place: Some(place), depth });
        }
    }
    let area = shown.iter().map(|s| s.area).reduce(|all, area| all.union(&area)).unwrap_or_default();
    let mut items = Vec::new();
    for Shown { chart, drawing, place, .. } in shown {
        put(readable, chart, drawing, place, &mut items);
    }
    Drawn {
        chart: wish.chart.clone(),
        kind: sort(chart.kind),
        stale: readable.stale,
        area: Area(area),
        actions: g7_draw::action_forms(document, chart).usual.into(),
        items: unique(items),
    }
}

/// Adds the symbols of a chart at its place, under its title. Its frame comes first, so that a line to it runs behind
/// symbols.
fn put(
    readable: Readable<'_>,
    chart: &Chart,
    drawing: Drawing,
    place: Option<Arranged>,
    items: &mut Vec<Item>,
) {
    let name = &*chart.name.text;
    let at = readable.units(chart.at.0);
    let by = place.as_ref().map_or_else(Point::default, |p| p.by);
    if let Some(Arranged { title, frame, .. }) = place {
        if frame.area().is_some() {
            items.insert(0, Item::plain(&ItemId::other(name, items.len()), Part::Text, frame, at));
        }
        let mut item = Item::plain(&ItemId::chart(name), Part::Title, title, at);
        item.at = Some(Spot(by));
        item.name = Some(name.to_owned());
        item.comment = chart.comment.as_deref().map(str::to_owned);
        items.push(item);
    }
    let names = Names::new(readable, chart);
    items.extend(drawing.items.into_iter().map(|i| i.moved(by)).enumerate().map(|(n, i)| names.item(n, i)));
}
