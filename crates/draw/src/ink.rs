//! The strokes of a symbol: lines, boxes and texts, each with a CSS class. A symbol is built round
//! its anchor, moved to its place, and printed last, if at all: the page keeps what it has of a symbol that
//! only moves.

use crate::text::{Line, clean, known, width};
use crate::{Point, Rect};

/// One stroke.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Ink {
    /// An open polyline.
    Line(&'static str, Vec<Point>),
    /// A closed polygon.
    Shape(&'static str, Vec<Point>),
    /// A box.
    Rect(&'static str, Rect),
    /// A circle: centre and radius.
    Circle(&'static str, Point, i32),
    /// A text: left end of its base line, size, characters.
    Text(&'static str, Point, i32, String),
}

/// A symbol or a part of one, as strokes at their places.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Picture {
    /// The strokes, in the order of painting.
    pub(crate) ink: Vec<Ink>,
    /// The title of the SVG group, for screen readers and tooltips: the text in full.
    pub(crate) title: Option<String>,
}

/// Height of the first overline above the base line, in thousandths of the text size.
const OVERLINE: i32 = 880;
/// Distance from one level of overlines to the next, in thousandths of the text size.
const OVERLINE_STEP: i32 = 210;
/// How far characters reach below the base line, in thousandths of the text size.
const BELOW: i32 = 270;
/// How far characters reach above the base line, in thousandths of the text size.
const ABOVE: i32 = 800;

/// How far a set line reaches above its base line.
pub(crate) fn rise(line: &Line, size: i32) -> i32 {
    match line.levels() {
        0 => size * ABOVE / 1000,
        n => size * (OVERLINE + 60) / 1000 + over_step(size) * (n as i32 - 1),
    }
}

/// How far a set line reaches below its base line.
pub(crate) fn sink(size: i32) -> i32 {
    size * BELOW / 1000
}

fn over_step(size: i32) -> i32 {
    size * OVERLINE_STEP / 1000
}

impl Picture {
    /// Adds an open polyline; the class is one of the style sheet.
    pub fn line(&mut self, class: &'static str, points: &[(i32, i32)]) {
        self.ink.push(Ink::Line(class, points.iter().map(|&(x, y)| Point { x, y }).collect()));
    }

    pub(crate) fn shape(&mut self, class: &'static str, points: &[(i32, i32)]) {
        self.ink.push(Ink::Shape(class, points.iter().map(|&(x, y)| Point { x, y }).collect()));
    }

    /// Adds a box.
    pub fn rect(&mut self, class: &'static str, x: i32, y: i32, w: i32, h: i32) {
        self.ink.push(Ink::Rect(class, Rect { x, y, w, h }));
    }

    pub(crate) fn circle(&mut self, class: &'static str, x: i32, y: i32, r: i32) {
        self.ink.push(Ink::Circle(class, Point { x, y }, r));
    }

    /// Adds plain text; (`x`, `y`) is the left end of its base line.
    pub fn text(&mut self, class: &'static str, x: i32, y: i32, size: i32, text: &str) {
        if !text.is_empty() {
            self.ink.push(Ink::Text(class, Point { x, y }, size, clean(text)));
        }
    }

    /// Adds a set line with its overlines.
    pub(crate) fn set(&mut self, class: &'static str, x: i32, y: i32, size: i32, line: &Line) {
        let x = x + line.indent;
        self.text(class, x, y, size, &line.text);
        let to = |at: usize| x + width(line.text.get(..at).unwrap_or(""), size);
        for over in &line.overs {
            let y = y - size * OVERLINE / 1000 - over_step(size) * (over.level as i32 - 1);
            // The overline is slightly shorter than its text, so that two neighbours stay separate.
            self.line("g7-over", &[(to(over.from) + 4, y), (to(over.to) - 4, y)]);
        }
    }

    /// Adds several set lines, the first with its base line at `y`; returns the base line of the
    /// last one.
    pub(crate) fn lines(&mut self, class: &'static str, at: (i32, i32), size: i32, lines: &[Line]) -> i32 {
        let mut y = at.1;
        for (i, line) in lines.iter().enumerate() {
            if i > 0 {
                y += leading(line, size);
            }
            self.set(class, at.0, y, size, line);
        }
        y
    }

    /// The bounding box; `None` if nothing is drawn.
    pub fn area(&self) -> Option<Rect> {
        self.ink.iter().map(Ink::area).reduce(|a, b| a.union(&b))
    }

    /// Adds another picture, shifted by a vector.
    pub fn add(&mut self, other: Picture, (x, y): (i32, i32)) {
        self.ink.extend(other.moved(Point { x, y }).ink);
    }

    /// The picture, shifted by a vector.
    #[must_use]
    pub(crate) fn moved(mut self, by: Point) -> Picture {
        self.ink.iter_mut().for_each(|i| i.shift(by));
        self
    }

    /// How far this picture is moved from another one that looks the same; `None` if they look different.
    pub fn moved_from(&self, other: &Picture) -> Option<Point> {
        let pairs = || self.ink.iter().zip(&other.ink);
        let by = pairs().next().map_or(Point::default(), |(a, b)| a.start().minus(b.start()));
        let alike = self.ink.len() == other.ink.len() && self.title == other.title;
        (alike && pairs().all(|(a, b)| a.is_moved_from(b, by))).then_some(by)
    }

    /// The SVG of the picture, in coordinates of the drawing; it has classes, no colours. The title, if there
    /// is one, comes first.
    pub fn svg(&self) -> String {
        let mut out = String::new();
        if let Some(title) = &self.title {
            out.push_str("<title>");
            out.push_str(&escape(title));
            out.push_str("</title>");
        }
        self.ink.iter().for_each(|i| i.svg(&mut out));
        out
    }

    /// Path data of the lines and boxes without texts, for zoomed-out views; may be empty.
    pub fn far(&self) -> String {
        let mut out = String::new();
        for ink in &self.ink {
            match ink {
                Ink::Line("g7-over", _) | Ink::Text(..) | Ink::Circle(..) => {}
                Ink::Line(_, points) => path(&mut out, points, false),
                Ink::Shape(_, points) => path(&mut out, points, true),
                Ink::Rect(_, r) => rect_path(&mut out, r),
            }
        }
        out
    }
}

/// Distance from the base line of the line above to the base line of this line.
pub(crate) fn leading(line: &Line, size: i32) -> i32 {
    (rise(line, size) + sink(size) + size * 120 / 1000).max(size * 135 / 100)
}

/// The height of several lines: above the first base line, and in total.
pub(crate) fn stack(lines: &[Line], size: i32) -> (i32, i32) {
    let Some(first) = lines.first() else { return (0, 0) };
    let rest: i32 = lines.iter().skip(1).map(|l| leading(l, size)).sum();
    let up = rise(first, size);
    (up, up + rest + sink(size))
}

impl Ink {
    pub(crate) fn area(&self) -> Rect {
        match self {
            Ink::Line(_, points) | Ink::Shape(_, points) => {
                let boxes = points.iter().map(|p| Rect { x: p.x, y: p.y, w: 0, h: 0 });
                boxes.reduce(|a, b| a.union(&b)).unwrap_or_default()
            }
            Ink::Rect(_, r) => *r,
            Ink::Circle(_, at, r) => Rect { x: at.x - r, y: at.y - r, w: 2 * r, h: 2 * r },
            Ink::Text(_, at, size, text) => {
                let (up, down) = (size * ABOVE / 1000, sink(*size));
                Rect { x: at.x, y: at.y - up, w: width(text, *size), h: up + down }
            }
        }
    }

    /// The point by which places of two strokes are compared.
    fn start(&self) -> Point {
        match self {
            Ink::Line(_, points) | Ink::Shape(_, points) => points.first().copied().unwrap_or_default(),
            Ink::Rect(_, r) => Point { x: r.x, y: r.y },
            Ink::Circle(_, at, _) | Ink::Text(_, at, ..) => *at,
        }
    }

    /// True if this stroke is another one moved by a vector.
    fn is_moved_from(&self, other: &Ink, by: Point) -> bool {
        let moved = |a: &Point, b: &Point| a.minus(*b) == by;
        match (self, other) {
            (Ink::Line(class, a), Ink::Line(other, b)) | (Ink::Shape(class, a), Ink::Shape(other, b)) => {
                class == other && a.len() == b.len() && a.iter().zip(b).all(|(a, b)| moved(a, b))
            }
            (Ink::Rect(class, a), Ink::Rect(other, b)) => class == other && a.is_moved_from(b, by),
            (Ink::Circle(class, a, r), Ink::Circle(other, b, s)) => (class, r) == (other, s) && moved(a, b),
            (Ink::Text(class, a, size, text), Ink::Text(other, b, of, words)) => {
                (class, size, text) == (other, of, words) && moved(a, b)
            }
            _ => false,
        }
    }

    fn shift(&mut self, by: Point) {
        let shift = |p: &mut Point| {
            p.x += by.x;
            p.y += by.y;
        };
        match self {
            Ink::Line(_, points) | Ink::Shape(_, points) => points.iter_mut().for_each(shift),
            Ink::Rect(_, r) => {
                r.x += by.x;
                r.y += by.y;
            }
            Ink::Circle(_, at, _) | Ink::Text(_, at, ..) => shift(at),
        }
    }

    fn svg(&self, out: &mut String) {
        let open = |out: &mut String, element: &str, class: &str| {
            out.push_str(element);
            out.push_str(class);
            out.push('"');
        };
        match self {
            Ink::Line(class, points) | Ink::Shape(class, points) => {
                open(out, "<path class=\"", class);
                out.push_str(" d=\"");
                path(out, points, matches!(self, Ink::Shape(..)));
                out.push_str("\"/>");
            }
            Ink::Rect(class, r) => {
                open(out, "<rect class=\"", class);
                lengths(out, &[(" x=\"", r.x), (" y=\"", r.y), (" width=\"", r.w), (" height=\"", r.h)]);
                out.push_str("/>");
            }
            Ink::Circle(class, at, r) => {
                open(out, "<circle class=\"", class);
                lengths(out, &[(" cx=\"", at.x), (" cy=\"", at.y), (" r=\"", *r)]);
                out.push_str("/>");
            }
            Ink::Text(class, at, size, text) => {
                open(out, "<text class=\"", class);
                lengths(out, &[(" x=\"", at.x), (" y=\"", at.y), (" font-size=\"", *size)]);
                if !known(text) {
                    lengths(out, &[(" textLength=\"", width(text, *size))]);
                    out.push_str(" lengthAdjust=\"spacingAndGlyphs\"");
                }
                out.push('>');
                out.push_str(&escape(text));
                out.push_str("</text>");
            }
        }
    }
}

/// Writes attributes whose values are lengths.
fn lengths(out: &mut String, attributes: &[(&str, i32)]) {
    for (name, value) in attributes {
        out.push_str(name);
        px(out, *value);
        out.push('"');
    }
}

/// Writes a length in px with at most one decimal. A chart of 1000 steps has 30,000 of them, so no
/// formatter stands in between.
fn px(out: &mut String, tenths: i32) {
    let tenth = (tenths.unsigned_abs() % 10) as u8;
    let mut rest = tenths.unsigned_abs() / 10;
    let mut digits = [b'0'; 10];
    let mut count = 1;
    for (n, digit) in (1..).zip(&mut digits) {
        *digit += (rest % 10) as u8;
        rest /= 10;
        count = n;
        if rest == 0 {
            break;
        }
    }
    if tenths < 0 {
        out.push('-');
    }
    digits.iter().take(count).rev().for_each(|d| out.push(char::from(*d)));
    if tenth != 0 {
        out.push('.');
        out.push(char::from(b'0' + tenth));
    }
}

/// A length that is printed in px with at most one decimal.
pub(crate) struct Px(pub(crate) i32);

impl std::fmt::Display for Px {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = String::new();
        px(&mut text, self.0);
        f.write_str(&text)
    }
}

fn path(out: &mut String, points: &[Point], closed: bool) {
    let mut last: Option<Point> = None;
    for p in points {
        match last {
            Some(l) if l.y == p.y => coordinate(out, 'H', p.x),
            Some(l) if l.x == p.x => coordinate(out, 'V', p.y),
            _ => {
                coordinate(out, if last.is_none() { 'M' } else { 'L' }, p.x);
                coordinate(out, ' ', p.y);
            }
        }
        last = Some(*p);
    }
    if closed {
        out.push('Z');
    }
}

fn rect_path(out: &mut String, r: &Rect) {
    coordinate(out, 'M', r.x);
    coordinate(out, ' ', r.y);
    coordinate(out, 'H', r.x + r.w);
    coordinate(out, 'V', r.y + r.h);
    coordinate(out, 'H', r.x);
    out.push('Z');
}

fn coordinate(out: &mut String, before: char, value: i32) {
    out.push(before);
    px(out, value);
}

/// Escapes text for SVG.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if (c.is_control() && c != '\n') || matches!(u32::from(c), 0xFFFE | 0xFFFF) => {
                out.push('\u{FFFD}')
            }
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_at_most_one_decimal() {
        let text = |n| Px(n).to_string();
        assert_eq!(
            [text(0), text(-5), text(123), text(-120), text(1000), text(i32::MIN)],
            ["0", "-0.5", "12.3", "-12", "100", "-214748364.8"]
        );
    }

    #[test]
    fn no_text_can_leave_its_element() {
        let mut p = Picture::default();
        p.text("g7-name", 0, 0, 140, "</text><script>\"&\u{1}");
        p.title = Some("<b>".to_owned());
        let svg = p.svg();
        assert!(!svg.contains("<script") && !svg.contains("<b>") && !svg.contains('\u{1}'), "{svg}");
        assert!(svg.contains("&lt;/text&gt;&lt;script&gt;&quot;&amp;"), "{svg}");
    }
}
