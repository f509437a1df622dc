//! The cells of a page: strokes as boxes, texts and lines, in symbols that move as one.

use std::collections::HashMap;
use std::fmt::Write as _;

use crate::draw::Inked;
use crate::ink::{Ink, Px, escape};
use crate::svg::style;
use crate::text::width;
use crate::{End, Link, Part, Placement, Point, Rect};

/// Cells, as text, and where the symbols stand that links may end at.
pub(super) struct Cells {
    out: String,
    /// The style sheet of the pictures, which has the colours.
    sheet: String,
    /// The box of each step and transition, by the name of its cell.
    ends: HashMap<String, Rect>,
    /// Links wait until both ends are there.
    links: Vec<(Link, u32, Point)>,
    count: usize,
}

/// Values of a class in the style sheet.
struct Pen {
    fill: String,
    stroke: String,
    width: String,
    /// The colour of a text.
    text: String,
}

impl Cells {
    pub(super) fn new(dark: bool) -> Cells {
        Cells { out: String::new(), sheet: style(dark), ends: HashMap::new(), links: Vec::new(), count: 0 }
    }

    /// Adds a symbol.
    pub(super) fn add(&mut self, symbol: Inked, placement: &Placement, shift: Point) {
        let strokes = symbol.picture.moved(shift).ink;
        let moved = |r: Rect| Rect { x: r.x + shift.x, y: r.y + shift.y, ..r };
        match symbol.part {
            Part::Step { step, square } => self.symbol(&format!("s{step}"), "1", moved(square), strokes),
            Part::Transition { transition, bar, .. } => {
                self.symbol(&format!("t{transition}"), "1", moved(bar), strokes);
            }
            Part::Action { step, index } => {
                let (name, owner) = (format!("a{step}.{index}"), format!("s{step}"));
                let back = self.ends.get(&owner).map_or(Point::default(), |r| Point { x: -r.x, y: -r.y });
                let strokes: Vec<Ink> = strokes.into_iter().map(|i| moved_by(i, back)).collect();
                match boxed(&strokes) {
                    Some(area) => self.symbol(&name, &owner, area, strokes),
                    None => strokes.into_iter().for_each(|ink| self.stroke(&owner, ink)),
                }
            }
            Part::Link { link, .. } => {
                if let Some(l) = placement.links.get(link as usize) {
                    self.links.push((l.clone(), link, shift));
                }
            }
            Part::Connector { .. } | Part::Comment { .. } | Part::Text => self.loose(strokes),
        }
    }

    /// The cells as a model, on a page of this width and height.
    pub(super) fn model(&self, size: [i32; 2]) -> String {
        let [width, height] = size.map(|n| n / 10 + 1);
        format!(
            "<mxGraphModel grid=\"1\" gridSize=\"10\" guides=\"1\" tooltips=\"1\" connect=\"1\" arrows=\"1\" fold=\"1\" \
             page=\"1\" pageScale=\"1\" pageWidth=\"{width}\" pageHeight=\"{height}\" math=\"0\" shadow=\"0\"><root>\
             <mxCell id=\"0\"/><mxCell id=\"1\" parent=\"0\"/>{}</root></mxGraphModel>\n",
            self.text()
        )
    }

    /// The cells as XML.
    fn text(&self) -> String {
        let mut out = self.out.clone();
        for (link, number, shift) in &self.links {
            self.link(&mut out, link, *number, *shift);
        }
        out
    }

    /// A symbol with a box of its own: the other strokes are a part of it. A text in the middle of the box
    /// is the text of the box.
    fn symbol(&mut self, name: &str, parent: &str, area: Rect, strokes: Vec<Ink>) {
        let (own, rest): (Vec<Ink>, Vec<Ink>) =
            strokes.into_iter().partition(|i| matches!(i, Ink::Rect(_, r) if *r == area));
        let class = own.iter().find_map(|i| if let Ink::Rect(class, _) = i { Some(*class) } else { None });
        let (label, rest) = labelled(area, rest);
        let pen = self.pen(class.unwrap_or("g7-bar"));
        let (text, words) = match &label {
            Some(l) => {
                let side = match l.indent {
                    Some(n) => format!("align=left;spacing=0;spacingLeft={};", Px(n)),
                    None => "align=center;".to_owned(),
                };
                let words = format!("{side}{}", font(&self.pen(l.class), l.size));
                (escape(&l.lines.join("\n")).replace('\n', "&#10;"), words)
            }
            None => (String::new(), String::new()),
        };
        let style = format!(
            "container=1;collapsible=0;foldable=0;rounded=0;whiteSpace=nowrap;html=0;verticalAlign=middle;{}{words}",
            pen.shape()
        );
        self.vertex(name, parent, &style, &text, area);
        self.ends.insert(name.to_owned(), area);
        let back = Point { x: -area.x, y: -area.y };
        for ink in rest {
            self.stroke(name, moved_by(ink, back));
        }
    }

    /// Strokes that belong to no symbol.
    fn loose(&mut self, strokes: Vec<Ink>) {
        for ink in strokes {
            self.stroke("1", ink);
        }
    }

    fn name(&mut self) -> String {
        self.count += 1;
        format!("p{}", self.count)
    }

    /// One stroke as a cell of its own.
    fn stroke(&mut self, parent: &str, ink: Ink) {
        let name = self.name();
        match ink {
            Ink::Rect(class, r) => {
                let style = format!("rounded=0;html=0;{}", self.pen(class).shape());
                self.vertex(&name, parent, &style, "", r);
            }
            Ink::Circle(class, at, r) => {
                let style = format!("shape=ellipse;html=0;{}", self.pen(class).shape());
                self.vertex(&name, parent, &style, "", Rect { x: at.x - r, y: at.y - r, w: 2 * r, h: 2 * r });
            }
            Ink::Text(class, at, size, text) => {
                let style = format!(
                    "text;html=0;fillColor=none;strokeColor=none;whiteSpace=nowrap;align=left;verticalAlign=middle;spacing=0;spacingLeft=0;resizable=0;{}",
                    font(&self.pen(class), size)
                );
                let area = Rect { x: at.x, y: at.y - size, w: width(&text, size) + 20, h: size * 13 / 10 };
                self.vertex(&name, parent, &style, &escape(&text), area);
            }
            Ink::Line(class, points) => self.line(&name, parent, class, &points),
            Ink::Shape(class, points) => self.polygon(&name, parent, class, &points),
        }
    }

    fn vertex(&mut self, name: &str, parent: &str, style: &str, text: &str, r: Rect) {
        let _ = write!(
            self.out,
            "<mxCell id=\"{name}\" parent=\"{parent}\" style=\"{}\" value=\"{text}\" vertex=\"1\"><mxGeometry x=\"{}\" \
             y=\"{}\" width=\"{}\" height=\"{}\" as=\"geometry\"/></mxCell>",
            escape(style),
            Px(r.x),
            Px(r.y),
            Px(r.w),
            Px(r.h)
        );
    }

    /// A line that ends at no symbol.
    fn line(&mut self, name: &str, parent: &str, class: &str, points: &[Point]) {
        let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
        let inner = points.get(1..points.len().saturating_sub(1)).unwrap_or(&[]);
        let style = format!("endArrow=none;html=0;rounded=0;{}", self.pen(class).line());
        let _ = write!(
            self.out,
            "<mxCell id=\"{name}\" parent=\"{parent}\" style=\"{}\" edge=\"1\"><mxGeometry relative=\"1\" \
             as=\"geometry\">{}{}{}</mxGeometry></mxCell>",
            escape(&style),
            point(*first, "sourcePoint"),
            point(*last, "targetPoint"),
            bends(inner)
        );
    }

    fn polygon(&mut self, name: &str, parent: &str, class: &str, points: &[Point]) {
        let r = Ink::Shape("", points.to_vec()).area();
        if let Some(direction) = pointed(points) {
            return self.vertex(name, parent, &triangle(direction, &self.pen(class)), "", r);
        }
        let of = |at: i32, from: i32, size: i32| {
            let thousandths = i64::from(at - from) * 1000 / i64::from(size.max(1));
            format!("{}.{:03}", thousandths / 1000, thousandths % 1000)
        };
        let corners: Vec<String> =
            points.iter().map(|p| format!("[{},{}]", of(p.x, r.x, r.w), of(p.y, r.y, r.h))).collect();
        let style = format!(
            "shape=mxgraph.basic.polygon;polyCoords=[{}];polyline=0;html=0;{}",
            corners.join(","),
            self.pen(class).shape()
        );
        self.vertex(name, parent, &style, "", r);
    }

    /// A link between two symbols, with its bends and the arrows on it.
    fn link(&self, out: &mut String, link: &Link, number: u32, shift: Point) {
        let moved = |p: &Point| Point { x: p.x + shift.x, y: p.y + shift.y };
        let points: Vec<Point> = link.points.iter().map(moved).collect();
        let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
        let [from, to] = [link.from, link.to].map(cell);
        let at = |name: &String, p: Point, side: &str| {
            let r = self.ends.get(name).copied().unwrap_or_default();
            format!(
                "{side}X=0;{side}Y=0;{side}Dx={};{side}Dy={};{side}Perimeter=0;",
                Px(p.x - r.x),
                Px(p.y - r.y)
            )
        };
        let style = format!(
            "endArrow=none;html=0;rounded=0;{}{}{}",
            at(&from, *first, "exit"),
            at(&to, *last, "entry"),
            self.pen("g7-link").line()
        );
        let inner = points.get(1..points.len().saturating_sub(1)).unwrap_or(&[]);
        let _ = write!(
            out,
            "<mxCell id=\"l{number}\" parent=\"1\" source=\"{from}\" target=\"{to}\" style=\"{}\" edge=\"1\">\
             <mxGeometry relative=\"1\" as=\"geometry\">{}</mxGeometry></mxCell>",
            escape(&style),
            bends(inner)
        );
        for (k, (tip, way)) in link.arrows.iter().enumerate() {
            arrow(out, &format!("l{number}.{k}"), moved(tip), *way, &self.pen("g7-mark"));
        }
    }

    /// The values of a class in the style sheet of the pictures.
    fn pen(&self, class: &str) -> Pen {
        let of = |selector: &str, key: &str| {
            let rules = self.sheet.split('}').filter_map(|rule| rule.split_once('{'));
            let mine = rules.filter(|(names, _)| names.split(',').any(|n| n.trim() == selector));
            let values = mine.flat_map(|(_, body)| body.split(';')).filter_map(|v| v.split_once(':'));
            values.filter(|(k, _)| *k == key).map(|(_, v)| v.to_owned()).next_back()
        };
        let own = format!(".g7 .{class}");
        let value = |key: &str, kind: &str| of(&own, key).or_else(|| of(kind, key)).unwrap_or_default();
        Pen {
            fill: value("fill", ".g7 path"),
            stroke: value("stroke", ".g7 path"),
            width: of(&own, "stroke-width").unwrap_or_else(|| "1".to_owned()),
            text: value("fill", ".g7 text"),
        }
    }
}

impl Pen {
    fn shape(&self) -> String {
        format!("fillColor={};strokeColor={};strokeWidth={};", self.fill, self.stroke, self.width)
    }

    fn line(&self) -> String {
        format!("strokeColor={};strokeWidth={};", self.stroke, self.width)
    }
}

/// The style of a text, in a font that draw.io has everywhere.
fn font(pen: &Pen, size: i32) -> String {
    format!("fontFamily=Helvetica;fontSize={};fontColor={};", Px(size), pen.text)
}

/// The name of the cell of a symbol.
fn cell(end: End) -> String {
    match end {
        End::Step(n) => format!("s{n}"),
        End::Transition(n) => format!("t{n}"),
    }
}

fn point(p: Point, name: &str) -> String {
    format!("<mxPoint x=\"{}\" y=\"{}\" as=\"{name}\"/>", Px(p.x), Px(p.y))
}

fn bends(points: &[Point]) -> String {
    if points.is_empty() {
        return String::new();
    }
    let mut out = String::from("<Array as=\"points\">");
    for p in points {
        let _ = write!(out, "<mxPoint x=\"{}\" y=\"{}\"/>", Px(p.x), Px(p.y));
    }
    out.push_str("</Array>");
    out
}

/// The direction in which a triangle points; nothing for another shape, and for a triangle that leans.
fn pointed(points: &[Point]) -> Option<&'static str> {
    let [tip, a, b] = points else { return None };
    // Any corner may come first.
    [[tip, a, b], [a, b, tip], [b, tip, a]].into_iter().find_map(|[tip, a, b]| {
        if a.y == b.y && 2 * tip.x == a.x + b.x {
            Some(if tip.y < a.y { "north" } else { "south" })
        } else if a.x == b.x && 2 * tip.y == a.y + b.y {
            Some(if tip.x < a.x { "west" } else { "east" })
        } else {
            None
        }
    })
}

fn triangle(direction: &str, pen: &Pen) -> String {
    format!("shape=triangle;direction={direction};html=0;{}", pen.shape())
}

/// An arrow head on a link: a triangle that points its way.
fn arrow(out: &mut String, name: &str, tip: Point, (dx, dy): (i8, i8), pen: &Pen) {
    let (direction, r) = match (dx, dy) {
        (_, -1) => ("north", Rect { x: tip.x - 44, y: tip.y, w: 88, h: 120 }),
        (_, 1) => ("south", Rect { x: tip.x - 44, y: tip.y - 120, w: 88, h: 120 }),
        (-1, _) => ("west", Rect { x: tip.x, y: tip.y - 44, w: 120, h: 88 }),
        _ => ("east", Rect { x: tip.x - 120, y: tip.y - 44, w: 120, h: 88 }),
    };
    let _ = write!(
        out,
        "<mxCell id=\"{name}\" parent=\"1\" style=\"{}\" vertex=\"1\"><mxGeometry \
         x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" as=\"geometry\"/></mxCell>",
        escape(&triangle(direction, pen)),
        Px(r.x),
        Px(r.y),
        Px(r.w),
        Px(r.h)
    );
}

/// The largest box among strokes.
fn boxed(strokes: &[Ink]) -> Option<Rect> {
    let boxes = strokes.iter().filter_map(|i| if let Ink::Rect(_, r) = i { Some(*r) } else { None });
    boxes.max_by_key(|r| i64::from(r.w) * i64::from(r.h))
}

/// The text of a box.
struct Label {
    class: &'static str,
    size: i32,
    lines: Vec<String>,
    /// Distance from the left side of the box; nothing where the text stands in the middle.
    indent: Option<i32>,
}

/// The text in a box, and the strokes without it. Texts of several kinds, and those with a line over them, stay texts
/// of their own.
fn labelled(area: Rect, strokes: Vec<Ink>) -> (Option<Label>, Vec<Ink>) {
    let is_inside = |i: &Ink| {
        let r = i.area();
        r.x >= area.x && r.y >= area.y && r.x + r.w <= area.x + area.w && r.y + r.h <= area.y + area.h
    };
    let is_text = |i: &Ink| matches!(i, Ink::Text(..)) && is_inside(i);
    let is_over = |i: &Ink| matches!(i, Ink::Line("g7-over", _)) && is_inside(i);
    let mut classes: Vec<&str> = strokes.iter().filter(|i| is_text(i)).filter_map(class).collect();
    classes.dedup();
    if classes.len() != 1 || strokes.iter().any(is_over) {
        return (None, strokes);
    }
    let (texts, rest): (Vec<Ink>, Vec<Ink>) = strokes.into_iter().partition(is_text);
    let mut label: Option<Label> = None;
    for ink in texts {
        if let Ink::Text(class, at, size, text) = ink {
            let off = 2 * (at.x - area.x) + width(&text, size) - area.w;
            let indent = (off.abs() > 40).then_some(at.x - area.x);
            label.get_or_insert_with(|| Label { class, size, lines: Vec::new(), indent }).lines.push(text);
        }
    }
    (label, rest)
}

/// The class of a text.
fn class(ink: &Ink) -> Option<&'static str> {
    if let Ink::Text(class, ..) = ink { Some(class) } else { None }
}

/// A stroke, shifted by a vector.
fn moved_by(ink: Ink, by: Point) -> Ink {
    let picture = crate::ink::Picture { ink: vec![ink], title: None };
    picture.moved(by).ink.pop().unwrap_or(Ink::Line("", Vec::new()))
}
