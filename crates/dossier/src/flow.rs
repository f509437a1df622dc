//! Sheets that are filled from top to bottom: headings, texts, tables and drawings, each where there is room for it.

use g7_draw::{Drawing, MM, Options, Page, Picture, Rect, width};

use crate::data::{Dossier, Entry, Input, Placed};

/// Size of texts.
pub(crate) const TEXT: i32 = 130;
/// Distance between two lines of text, in hundredths of its size.
pub(crate) const LEADING: i32 = 145;
/// Sizes of headings by their level.
const HEADINGS: [i32; 2] = [230, 170];

/// The least height that is left under a heading.
const KEPT: i32 = 1700;

/// The contents of a sheet.
#[derive(Default)]
struct Draft {
    /// The part of the dossier, for the title block.
    part: String,
    picture: Picture,
    drawing: Option<(Drawing, i32, String, String)>,
}

/// Sheets that are being filled.
pub(crate) struct Flow {
    /// Where texts stand.
    pub(crate) inside: Rect,
    drafts: Vec<Draft>,
    /// The one that is being filled.
    current: usize,
    /// The next free height.
    y: i32,
    pub(crate) outline: Vec<Entry>,
    pictures: Vec<Placed>,
    /// The sheets of the contents, behind the cover.
    pub(crate) contents: usize,
}

impl Flow {
    pub(crate) fn new(input: &Input<'_>, contents: usize) -> Flow {
        Flow {
            inside: input.paper.inside(),
            drafts: Vec::new(),
            current: 0,
            y: 0,
            outline: Vec::new(),
            pictures: Vec::new(),
            contents,
        }
    }

    /// The number of the sheet that is being filled.
    pub(crate) fn page(&self) -> usize {
        self.current + 1
    }

    /// Begins a sheet.
    pub(crate) fn next(&mut self, part: &str) {
        self.drafts.push(Draft { part: part.to_owned(), ..Draft::default() });
        self.current = self.drafts.len() - 1;
        self.y = self.inside.y;
    }

    /// Goes on at the top of a sheet that was kept free.
    pub(crate) fn turn_to(&mut self, page: usize) {
        self.current = page - 1;
        self.y = self.inside.y;
    }

    fn draft(&mut self) -> &mut Draft {
        if self.drafts.is_empty() {
            self.next("");
        }
        &mut self.drafts[self.current]
    }

    /// The height that is left.
    pub(crate) fn left(&self) -> i32 {
        self.inside.y + self.inside.h - self.y
    }

    /// Goes on to another sheet if so much height is not left.
    pub(crate) fn need(&mut self, height: i32) {
        if !self.drafts.is_empty() && (height <= self.left() || self.y == self.inside.y) {
            return;
        }
        if self.current + 1 < self.drafts.len() {
            self.turn_to(self.current + 2);
        } else {
            let part = self.drafts.last().map(|d| d.part.clone()).unwrap_or_default();
            self.next(&part);
        }
    }

    /// Leaves so much height free.
    pub(crate) fn skip(&mut self, height: i32) {
        self.y += height;
    }

    /// Writes a heading, and adds it to the outline.
    pub(crate) fn heading(&mut self, level: usize, text: &str) {
        let size = HEADINGS.get(level).copied().unwrap_or(TEXT);
        // A heading stands over something of its own.
        self.need(size * 2 + KEPT);
        if self.y > self.inside.y {
            self.skip(size);
        }
        self.outline.push(Entry { level, title: text.to_owned(), page: self.page() });
        self.lines(&wrap(text, size, self.inside.w), size, "g7-title", 0);
        self.skip(size / 2);
    }

    /// Adds an entry to the outline at the present sheet.
    pub(crate) fn mark(&mut self, level: usize, text: &str) {
        self.outline.push(Entry { level, title: text.to_owned(), page: self.page() });
    }

    /// Writes a text on as many lines as it takes.
    pub(crate) fn text(&mut self, text: &str) {
        self.sized(text, TEXT, "g7-name");
    }

    /// Writes a remark.
    pub(crate) fn remark(&mut self, text: &str) {
        self.sized(text, TEXT, "g7-note");
    }

    /// Writes a text of a size.
    pub(crate) fn sized(&mut self, text: &str, size: i32, class: &'static str) {
        for line in text.lines() {
            self.lines(&wrap(line, size, self.inside.w), size, class, 0);
        }
    }

    /// Begins a part of the dossier on a sheet of its own.
    pub(crate) fn part(&mut self, title: &str) {
        self.next(title);
        self.heading(0, title);
    }

    /// Prints lines of the chart's text with their indentation.
    pub(crate) fn written<'t>(&mut self, lines: impl IntoIterator<Item = &'t str>) {
        for line in lines {
            let text = line.trim_start();
            let blanks = (line.len() - text.len()) as i32;
            let indent = (blanks * TEXT / 2).min(self.inside.w / 2);
            self.lines(&wrap(text, TEXT, self.inside.w - indent), TEXT, "g7-name", indent);
        }
    }

    fn lines(&mut self, lines: &[String], size: i32, class: &'static str, indent: i32) {
        for line in lines {
            self.need(size * LEADING / 100);
            let (x, y) = (self.inside.x + indent, self.y + size);
            self.draft().picture.text(class, x, y, size, line);
            self.skip(size * LEADING / 100);
        }
    }

    /// Writes a line with a text at its left and one at its right end.
    pub(crate) fn between(&mut self, left: &str, right: &str, indent: i32) {
        let (size, right_w) = (TEXT, width(right, TEXT));
        let lines = wrap(left, size, self.inside.w - indent - right_w - 400);
        for (n, line) in lines.iter().enumerate() {
            self.need(size * LEADING / 100);
            let (x, y) = (self.inside.x, self.y + size);
            let end = x + self.inside.w;
            let picture = &mut self.draft().picture;
            picture.text("g7-name", x + indent, y, size, line);
            if n + 1 == lines.len() {
                picture.text("g7-name", end - right_w, y, size, right);
                let from = x + indent + width(line, size) + 100;
                picture.line("g7-grid", &[(from, y), (end - right_w - 100, y)]);
            }
            self.skip(size * LEADING / 100);
        }
    }

    /// Adds a picture at the present height, and goes on below it.
    pub(crate) fn picture(&mut self, picture: Picture, area: Rect) {
        self.need(area.h + 50);
        let by = (self.inside.x - area.x, self.y - area.y);
        self.draft().picture.add(picture, by);
        self.skip(area.h + 50);
    }

    /// The picture of the present sheet, to which strokes are added at their places.
    pub(crate) fn ink(&mut self) -> &mut Picture {
        &mut self.draft().picture
    }

    /// The next free height.
    pub(crate) fn height(&self) -> i32 {
        self.y
    }

    /// Draws an SVG file at the present height of the sheet; what follows stands below it. The unit of its size does not
    /// matter, because only the proportions are used.
    pub(crate) fn place(&mut self, svg: &[u8], [w, h]: [f64; 2]) {
        let most = f64::from((self.inside.h - 10 * MM).min(110 * MM));
        let scale = (f64::from(self.inside.w) / w.max(1.0)).min(most / h.max(1.0)).min(20.0);
        let (w, h) = ((w * scale) as i32, (h * scale) as i32);
        self.need(h + 100);
        let at = Rect { x: self.inside.x, y: self.y, w, h };
        self.pictures.push(Placed { page: self.page(), at, svg: svg.to_vec() });
        self.skip(h + 100);
    }

    /// A sheet with a drawing of a chart.
    pub(crate) fn drawing(&mut self, part: &str, heading: &str, remark: &str, drawing: Drawing, scale: i32) {
        self.next(part);
        self.draft().drawing = Some((drawing, scale, heading.to_owned(), remark.to_owned()));
        // Nothing else has room here.
        self.y = self.inside.y + self.inside.h;
    }

    /// Puts frame and title block round each sheet.
    pub(crate) fn done(self, input: &Input<'_>) -> Dossier {
        let of = self.drafts.len();
        let mut pages = Vec::new();
        for (number, draft) in (1..).zip(self.drafts) {
            let mut page = Page::new(input.paper, &input.block(&draft.part, number, of));
            if let Some((drawing, scale, heading, remark)) = &draft.drawing {
                page.heading(heading, remark);
                page.draw(drawing, *scale);
            }
            page.put(&draft.picture);
            pages.push(page);
        }
        Dossier {
            pages,
            paper: input.paper,
            outline: self.outline,
            pictures: self.pictures,
            title: input.title().to_owned(),
        }
    }
}

/// The options of drawings in a dossier.
pub(crate) fn options(input: &Input<'_>) -> Options {
    Options { look: input.look, ..Options::default() }
}

/// Breaks a text into lines no wider than `most`, at blanks or, in a word that is wider, behind any character. Nothing
/// is left out.
pub(crate) fn wrap(text: &str, size: i32, most: i32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(line) = lines.last_mut()
            && width(&format!("{line} {word}"), size) <= most
        {
            line.push(' ');
            line.push_str(word);
            continue;
        }
        let mut part = String::new();
        for c in word.chars() {
            part.push(c);
            if width(&part, size) > most && part.chars().count() > 1 {
                part.pop();
                lines.push(std::mem::take(&mut part));
                part.push(c);
            }
        }
        lines.push(part);
    }
    if lines.is_empty() {
        lines.push(String::new());
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping_loses_nothing_and_no_line_is_too_wide() {
        let long = "a".repeat(300);
        for text in ["", "one", "one two three four five six seven", &long, &format!("x {long} y")] {
            let lines = wrap(text, TEXT, 1500);
            assert!(lines.iter().all(|l| width(l, TEXT) <= 1500), "{lines:?}");
            let bare = |t: &str| t.chars().filter(|c| !c.is_whitespace()).collect::<String>();
            assert_eq!(bare(&lines.concat()), bare(text));
        }
    }
}
