//! The strokes of a symbol: lines, boxes and texts, each with a CSS class. A symbol is built round
//! its anchor, moved to its place, and printed last.

use std::fmt::Write as _;

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

/// A symbol or a part of one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Picture {
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
    pub(crate) fn line(&mut self, class: &'static str, points: &[(i32, i32)]) {
        self.ink.push(Ink::Line(class, points.iter().map(|&(x, y)| Point { x, y }).collect()));
    }

    pub(crate) fn shape(&mut self, class: &'static str, points: &[(i32, i32)]) {
        self.ink.push(Ink::Shape(class, points.iter().map(|&(x, y)| Point { x, y }).collect()));
    }

    pub(crate) fn rect(&mut self, class: &'static str, x: i32, y: i32, w: i32, h: i32) {
        self.ink.push(Ink::Rect(class, Rect { x, y, w, h }));
    }

    pub(crate) fn circle(&mut self, class: &'static str, x: i32, y: i32, r: i32) {
        self.ink.push(Ink::Circle(class, Point { x, y }, r));
    }

    /// Adds plain text; (`x`, `y`) is the left end of its base line.
    pub(crate) fn text(&mut self, class: &'static str, x: i32, y: i32, size: i32, text: &str) {
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
    pub(crate) fn area(&self) -> Option<Rect> {
        self.ink.iter().map(Ink::area).reduce(|a, b| a.union(&b))
    }

    /// The picture, shifted by a vector.
    #[must_use]
    pub(crate) fn moved(mut self, by: Point) -> Picture {
        self.ink.iter_mut().for_each(|i| i.shift(by));
        self
    }

    /// The SVG of the picture; the title, if there is one, comes first.
    pub(crate) fn svg(&self) -> String {
        let mut out = String::new();
        if let Some(title) = &self.title {
            let _ = write!(out, "<title>{}</title>", escape(title));
        }
        self.ink.iter().for_each(|i| i.svg(&mut out));
        out
    }

    /// Path data of the lines and boxes without texts, for zoomed-out views.
    pub(crate) fn far(&self) -> String {
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
        let _ = match self {
            Ink::Line(class, points) => {
                let _ = write!(out, "<path class=\"{class}\" d=\"");
                path(out, points, false);
                write!(out, "\"/>")
            }
            Ink::Shape(class, points) => {
                let _ = write!(out, "<path class=\"{class}\" d=\"");
                path(out, points, true);
                write!(out, "\"/>")
            }
            Ink::Rect(class, r) => write!(
                out,
                "<rect class=\"{class}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>",
                Px(r.x),
                Px(r.y),
                Px(r.w),
                Px(r.h)
            ),
            Ink::Circle(class, at, r) => {
                write!(
                    out,
                    "<circle class=\"{class}\" cx=\"{}\" cy=\"{}\" r=\"{}\"/>",
                    Px(at.x),
                    Px(at.y),
                    Px(*r)
                )
            }
            Ink::Text(class, at, size, text) => {
                let _ = write!(
                    out,
                    "<text class=\"{class}\" x=\"{}\" y=\"{}\" font-size=\"{}\"",
                    Px(at.x),
                    Px(at.y),
                    Px(*size)
                );
                if !known(text) {
                    let w = Px(width(text, *size));
                    let _ = write!(out, " textLength=\"{w}\" lengthAdjust=\"spacingAndGlyphs\"");
                }
                write!(out, ">{}</text>", escape(text))
            }
        };
    }
}

/// A length that is printed in px with at most one decimal.
pub(crate) struct Px(pub(crate) i32);

impl std::fmt::Display for Px {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (sign, n) = (if self.0 < 0 { "-" } else { "" }, self.0.unsigned_abs());
        match n % 10 {
            0 => write!(f, "{sign}{}", n / 10),
            tenth => write!(f, "{sign}{}.{tenth}", n / 10),
        }
    }
}

fn path(out: &mut String, points: &[Point], closed: bool) {
    let mut last: Option<Point> = None;
    for p in points {
        let _ = match last {
            None => write!(out, "M{} {}", Px(p.x), Px(p.y)),
            Some(l) if l.y == p.y => write!(out, "H{}", Px(p.x)),
            Some(l) if l.x == p.x => write!(out, "V{}", Px(p.y)),
            Some(_) => write!(out, "L{} {}", Px(p.x), Px(p.y)),
        };
        last = Some(*p);
    }
    if closed {
        out.push('Z');
    }
}

fn rect_path(out: &mut String, r: &Rect) {
    let _ = write!(out, "M{} {}H{}V{}H{}Z", Px(r.x), Px(r.y), Px(r.x + r.w), Px(r.y + r.h), Px(r.x));
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
            [text(0), text(-5), text(123), text(-120), text(1000)],
            ["0", "-0.5", "12.3", "-12", "100"]
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
