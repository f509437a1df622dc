//! Drawings as standalone files: a style sheet, the font, and the items of one or several charts on
//! one sheet.

use std::collections::HashMap;
use std::fmt::Write as _;

use g7_model::{ActionKind, Chart, ChartKind, Document, Order, StepKind};

use crate::ink::{Picture, Px, escape};
use crate::text::{FONT_FAMILY, clean, font, shortened, width};
use crate::{Drawing, Options, Part, Point, Rect};

/// Margin round a standalone picture.
const MARGIN: i32 = 200;
/// Distance between two charts on a sheet.
const BETWEEN: i32 = 600;
/// Text size of the name over a chart.
const TITLE: i32 = 180;
/// Text size of the comment beside the name.
const SUBTITLE: i32 = 130;
/// Distance from the title to the chart.
const UNDER_TITLE: i32 = 180;

/// The style sheet for the fragments: one rule for each class.
pub fn style(dark: bool) -> String {
    let (paper, ink, soft, accent) = if dark {
        ("#15181d", "#e8eaed", "#9aa4b2", "#b6c2d2")
    } else {
        ("#ffffff", "#16191d", "#5b6674", "#3d4956")
    };
    format!(
        ".g7{{font-family:\"{FONT_FAMILY}\",\"IBM Plex Sans\",sans-serif;font-kerning:none}}\
.g7 text{{fill:{ink};stroke:none;white-space:pre}}\
.g7 path,.g7 rect,.g7 circle{{fill:none;stroke:{ink};stroke-linejoin:miter}}\
.g7 .g7-paper{{fill:{paper};stroke:none}}\
.g7 .g7-box{{fill:{paper};stroke-width:1.7}}\
.g7 .g7-action{{fill:{paper};stroke-width:1.2}}\
.g7 .g7-inner{{stroke-width:1.2}}\
.g7 .g7-thin{{stroke-width:1.2}}\
.g7 .g7-link{{stroke-width:1.4}}\
.g7 .g7-double{{stroke-width:1.5}}\
.g7 .g7-sign{{stroke-width:1.7}}\
.g7 .g7-over{{stroke-width:1.1}}\
.g7 .g7-ring{{fill:{paper};stroke-width:1.1}}\
.g7 .g7-frame{{stroke:{soft};stroke-width:1}}\
.g7 .g7-grid{{stroke:{soft};stroke-width:.5;stroke-opacity:.5}}\
.g7 .g7-wave{{stroke-width:1.4}}\
.g7 .g7-active{{fill:{accent};fill-opacity:.2;stroke-width:1.2}}\
.g7 .g7-bar,.g7 .g7-mark{{fill:{ink};stroke:none}}\
.g7 .g7-note,.g7 .g7-label,.g7 .g7-ref{{fill:{soft}}}\
.g7 .g7-qual,.g7 .g7-cond{{fill:{accent}}}"
    )
}

/// Draws one chart as an SVG file.
pub fn svg(drawing: &Drawing, options: &Options) -> String {
    let mut out = String::new();
    open(&mut out, drawing.area, options, &drawing.chart);
    body(&mut out, drawing);
    out.push_str("</g></svg>\n");
    out
}

/// Draws several charts as one SVG file: in rows, each under its name.
pub fn sheet(document: &Document, drawings: &[Drawing], options: &Options) -> String {
    let nesting = Nesting::of(document);
    let titles: Vec<Picture> = drawings.iter().map(|d| title(&nesting, d)).collect();
    let boxes: Vec<Rect> = drawings.iter().zip(&titles).map(|(d, t)| with_title(d, t)).collect();
    let places = rows(&boxes);
    let area = boxes.iter().zip(&places).fold(None, |all: Option<Rect>, (b, p)| {
        let here = Rect { x: p.x, y: p.y, ..*b };
        Some(all.map_or(here, |all| all.union(&here)))
    });
    let names: Vec<&str> = drawings.iter().map(|d| &*d.chart).collect();
    let mut out = String::new();
    open(&mut out, area.unwrap_or_default(), options, &names.join(", "));
    for (((d, t), b), p) in drawings.iter().zip(&titles).zip(&boxes).zip(&places) {
        let _ = write!(out, "<g transform=\"translate({} {})\">", Px(p.x - b.x), Px(p.y - b.y));
        out.push_str(&t.svg());
        body(&mut out, d);
        out.push_str("</g>");
    }
    out.push_str("</g></svg>\n");
    out
}

/// The title over a chart: its name, the macro-step or enclosing step it belongs to, and its
/// comment. An enclosed chart also gets a frame with the name of its enclosing step.
fn title(nesting: &Nesting<'_>, drawing: &Drawing) -> Picture {
    let mut p = Picture::default();
    let name = &*drawing.chart;
    let Some(chart) = nesting.charts.get(name) else { return p };
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
        p.rect("g7-frame", all.x - 150, all.y - 120, all.w + 300, all.h + 270);
    }
    p
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

fn with_title(drawing: &Drawing, title: &Picture) -> Rect {
    title.area().map_or(drawing.area, |t| t.union(&drawing.area))
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

/// Wraps other SVG content as a file in the same style.
pub(crate) fn standalone(area: Rect, options: &Options, title: &str, body: &str) -> String {
    let mut out = String::new();
    open(&mut out, area, options, title);
    out.push_str(body);
    out.push_str("</g></svg>\n");
    out
}

/// Writes the head of a file up to and including the opening tag of the group `g7`.
fn open(out: &mut String, area: Rect, options: &Options, title: &str) {
    let (x, y) = (area.x - MARGIN, area.y - MARGIN);
    let (w, h) = (area.w + 2 * MARGIN, area.h + 2 * MARGIN);
    let (x, y, w, h) = (Px(x), Px(y), Px(w), Px(h));
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{x} {y} {w} {h}\" width=\"{w}\" height=\"{h}\" \
role=\"img\"><title>{}</title><style>",
        escape(title)
    );
    if options.font {
        let _ = write!(out, "{FontFace}");
    }
    let _ = write!(
        out,
        "{}</style><g class=\"g7\"><rect class=\"g7-paper\" x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/>",
        style(options.dark)
    );
}

/// The rule of CSS that brings the font.
pub(crate) struct FontFace;

impl std::fmt::Display for FontFace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let font = base64(font());
        write!(f, "@font-face{{font-family:\"{FONT_FAMILY}\";src:url(data:font/ttf;base64,{font})}}")
    }
}

/// Writes the items, each in a group that says which part of the chart it is.
pub(crate) fn body(out: &mut String, drawing: &Drawing) {
    for item in &drawing.items {
        let part = match item.part {
            Part::Step { .. } => "step",
            Part::Action { .. } => "action",
            Part::Transition { .. } => "transition",
            Part::Link { .. } => "link",
            Part::Connector { .. } => "connector",
            Part::Comment { .. } => "comment",
            Part::Text => "text",
        };
        let _ = write!(out, "<g data-part=\"{part}\">{}</g>", item.picture.svg());
    }
}

/// Encodes bytes in base 64 (RFC 4648, section 4).
pub(crate) fn base64(bytes: &[u8]) -> String {
    const SIGNS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let sign = |n: u32| char::from(SIGNS[(n & 63) as usize]);
    let mut out = String::with_capacity(bytes.len() / 3 * 4 + 4);
    for three in bytes.chunks(3) {
        let byte = |i: usize| u32::from(three.get(i).copied().unwrap_or(0));
        let n = byte(0) << 16 | byte(1) << 8 | byte(2);
        out.push(sign(n >> 18));
        out.push(sign(n >> 12));
        out.push(if three.len() > 1 { sign(n >> 6) } else { '=' });
        out.push(if three.len() > 2 { sign(n) } else { '=' });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_64_is_that_of_the_rfc() {
        let cases = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("foobar", "Zm9vYmFy"),
        ];
        for (plain, coded) in cases {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

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
}
