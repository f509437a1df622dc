//! Sheets of paper: their sizes, the frame (ISO 5457) and the title block (ISO 7200), and a sheet as SVG.

use std::fmt::Write as _;

use crate::ink::{Picture, Px, escape};
use crate::svg::{FontFace, base64, body, style};
use crate::text::{clean, shortened, width, wrap_words};
use crate::{Drawing, Options, Rect};

/// Hundredths of u in a millimetre of paper.
pub const MM: i32 = 50;

/// The format of a sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Size {
    /// 210 mm by 297 mm.
    #[default]
    A4,
    /// 297 mm by 420 mm.
    A3,
}

/// A sheet of paper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Paper {
    /// Its format.
    pub size: Size,
    /// The longer side is the width.
    pub landscape: bool,
}

/// Margin at the left in mm, for binding.
const BINDING: i32 = 20;
/// The other margins in mm.
const MARGIN: i32 = 10;
/// Width of the title block in mm.
const BLOCK: i32 = 180;
/// Height of a row of the title block in mm.
const ROW: i32 = 9;
/// Rows of the title block.
const ROWS: i32 = 3;
/// Distance in mm between the frame and what stands in it.
const INSIDE: i32 = 4;
/// Height in mm of the heading over a drawing.
const HEADING: i32 = 10;
/// Text size of labels in the title block.
const LABEL: i32 = 85;
/// Text size of values in the title block.
const VALUE: i32 = 130;
/// Text size of a heading.
const TITLE: i32 = 190;

impl Paper {
    /// All sheets, with their names.
    pub const ALL: [(&'static str, Paper); 4] = [
        ("a4", Paper { size: Size::A4, landscape: false }),
        ("a4-landscape", Paper { size: Size::A4, landscape: true }),
        ("a3", Paper { size: Size::A3, landscape: false }),
        ("a3-landscape", Paper { size: Size::A3, landscape: true }),
    ];

    /// The sheet with a name.
    pub fn named(name: &str) -> Option<Paper> {
        Paper::ALL.iter().find(|(n, _)| *n == name).map(|(_, p)| *p)
    }

    /// Width and height in mm.
    pub fn mm(&self) -> [i32; 2] {
        let (short, long) = match self.size {
            Size::A4 => (210, 297),
            Size::A3 => (297, 420),
        };
        if self.landscape { [long, short] } else { [short, long] }
    }

    /// The frame.
    pub fn frame(&self) -> Rect {
        let [w, h] = self.mm().map(|side| side * MM);
        let (left, margin) = (BINDING * MM, MARGIN * MM);
        Rect { x: left, y: margin, w: w - left - margin, h: h - 2 * margin }
    }

    /// The room inside the frame, over the title block.
    pub fn inside(&self) -> Rect {
        let f = self.frame();
        let gap = INSIDE * MM;
        Rect { x: f.x + gap, y: f.y + gap, w: f.w - 2 * gap, h: f.h - 2 * gap - ROWS * ROW * MM }
    }

    /// Where a drawing stands: inside, under its heading.
    fn field(&self) -> Rect {
        let i = self.inside();
        Rect { y: i.y + HEADING * MM, h: i.h - HEADING * MM, ..i }
    }

    /// The width and height that a drawing has.
    pub(crate) fn room(&self) -> [i32; 2] {
        let f = self.field();
        [f.w, f.h]
    }
}

/// A field of the title block: what it is called, and what stands in it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Field {
    /// The label.
    pub label: String,
    /// The value; may be empty.
    pub value: String,
}

/// The title block of a sheet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TitleBlock {
    /// Whose drawing it is.
    pub company: Field,
    /// The title of the whole document.
    pub title: Field,
    /// The number of the sheet, and of all.
    pub sheet: Field,
    /// Who made it.
    pub author: Field,
    /// The chart, or the part of the document.
    pub part: Field,
    /// The revision.
    pub revision: Field,
    /// The file.
    pub file: Field,
    /// The program that drew it.
    pub program: Field,
    /// The date.
    pub date: Field,
}

/// A sheet that is being filled.
#[derive(Clone, Debug)]
pub struct Page {
    paper: Paper,
    title: String,
    body: String,
    /// Pictures over it.
    over: String,
}

impl Page {
    /// A sheet with its frame and title block.
    pub fn new(paper: Paper, block: &TitleBlock) -> Page {
        let title = [&*block.title.value, &*block.part.value, &*block.sheet.value].join(" · ");
        let mut page = Page { paper, title, body: String::new(), over: String::new() };
        let mut p = Picture::default();
        let f = paper.frame();
        p.rect("g7-box", f.x, f.y, f.w, f.h);
        fields(&mut p, f, block);
        page.put(&p);
        page
    }

    /// Adds strokes at their places.
    pub fn put(&mut self, picture: &Picture) {
        self.body.push_str(&picture.svg());
    }

    /// Adds a heading, with a remark behind it.
    pub fn heading(&mut self, text: &str, remark: &str) {
        let i = self.paper.inside();
        let mut p = Picture::default();
        let base = i.y + TITLE;
        let (text, _) = shortened(&clean(text), TITLE, i.w);
        p.text("g7-title", i.x, base, TITLE, &text);
        let x = width(&text, TITLE) + 150;
        let (lines, _) = wrap_words(remark, 120, (i.w - x).max(0), 2);
        for (n, line) in (0..).zip(lines.iter().filter(|_| i.w - x > 800)) {
            p.text("g7-note", i.x + x, base - 60 + n * 160, 120, line);
        }
        self.put(&p);
    }

    /// Adds a drawing under the heading, at a size in thousandths.
    pub fn draw(&mut self, drawing: &Drawing, scale: i32) {
        let f = self.paper.field();
        let sized = |n: i32| (i64::from(n) * i64::from(scale) / 1000) as i32;
        let (w, a) = (sized(drawing.area.w), drawing.area);
        // In the middle, but high up, as it is read.
        let (x, y) = (f.x + (f.w - w) / 2 - sized(a.x), f.y - sized(a.y));
        let _ = write!(
            self.body,
            "<g transform=\"translate({} {}) scale({}.{:03})\">",
            Px(x),
            Px(y),
            scale / 1000,
            scale % 1000
        );
        body(&mut self.body, drawing);
        self.body.push_str("</g>");
    }

    /// Adds an SVG file as a picture of its own, which nothing here styles; it keeps its proportions in the box.
    pub fn image(&mut self, svg: &[u8], at: Rect) {
        let (x, y, w, h) = (Px(at.x), Px(at.y), Px(at.w), Px(at.h));
        let _ = write!(
            self.over,
            "<image x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" href=\"data:image/svg+xml;base64,{}\"/>",
            base64(svg)
        );
    }

    /// The sheet as an SVG file. The style sheet and, where it is wanted, the font come with it.
    pub fn svg(&self, options: &Options) -> String {
        let [w, h] = self.paper.mm();
        let (pw, ph) = (Px(w * MM), Px(h * MM));
        let font = if options.font { FontFace.to_string() } else { String::new() };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {pw} {ph}\" width=\"{w}mm\" height=\"{h}mm\" \
role=\"img\"><title>{}</title><style>{font}{}</style><g class=\"g7\"><rect class=\"g7-paper\" x=\"0\" y=\"0\" \
width=\"{pw}\" height=\"{ph}\"/>{}</g>{}</svg>\n",
            escape(&self.title),
            style(options.dark),
            self.body,
            self.over
        )
    }
}

/// Draws the title block in the lower right corner of the frame.
fn fields(p: &mut Picture, frame: Rect, b: &TitleBlock) {
    // The widths of the three columns in mm.
    const COLUMNS: [i32; 3] = [52, 92, 36];
    let rows =
        [[&b.company, &b.title, &b.sheet], [&b.author, &b.part, &b.revision], [&b.file, &b.program, &b.date]];
    let (left, top) = (frame.x + frame.w - BLOCK * MM, frame.y + frame.h - ROWS * ROW * MM);
    p.rect("g7-action", left, top, BLOCK * MM, ROWS * ROW * MM);
    let mut y = top;
    for row in rows {
        let mut x = left;
        for (field, w) in row.into_iter().zip(COLUMNS) {
            entry(p, field, Rect { x, y, w: w * MM, h: ROW * MM });
            x += w * MM;
        }
        y += ROW * MM;
        p.line("g7-thin", &[(left, y), (left + BLOCK * MM, y)]);
    }
    let mut x = left;
    for w in COLUMNS {
        p.line("g7-thin", &[(x, top), (x, y)]);
        x += w * MM;
    }
}

/// Writes a field into its box: on a line, smaller, or on two lines.
fn entry(p: &mut Picture, field: &Field, at: Rect) {
    let room = at.w - 100;
    p.text("g7-label", at.x + 50, at.y + 110, LABEL, &shortened(&clean(&field.label), LABEL, room).0);
    let value = clean(&field.value);
    let base = at.y + at.h - 80;
    if let Some(size) = [VALUE, 115, 100].into_iter().find(|size| width(&value, *size) <= room) {
        p.text("g7-name", at.x + 50, base, size, &value);
        return;
    }
    let (lines, _) = wrap_words(&value, 100, room, 2);
    for (n, line) in (0..).zip(lines.iter().rev()) {
        p.text("g7-name", at.x + 50, base + 20 - n * 120, 100, line);
    }
}
