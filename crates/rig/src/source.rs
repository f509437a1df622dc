//! Source files: bytes, document and problems; and the conversion from bytes to lines.

use std::ops::Range;
use std::sync::Arc;

use g7_exchange::Format;
use g7_model::{Document, FileId, Item, Problem, Said, Scenario, Severity, Span, say};
use g7_syntax::{Marks, Tree};

/// A file that was read.
#[derive(Clone, Debug)]
pub struct Source {
    /// The name used in messages, on one line.
    pub name: String,
    /// The text, with one byte for each byte of the file: bytes that are not UTF-8 are replaced by
    /// `?`.
    pub text: String,
    /// The bytes of the file.
    pub bytes: Vec<u8>,
    /// The parsed document.
    pub document: Document,
    /// The problems that the parser found.
    pub problems: Vec<Problem>,
    /// The foreign format of the file, if it is not .g7.
    pub format: Option<&'static Format>,
    /// The marks of the text, with which a change of it reads only a part.
    pub marks: Marks,
    starts: Vec<usize>,
    id: FileId,
    /// The files that it uses, if they were read.
    pub(crate) links: Links,
}

impl Source {
    /// Reads a .g7 file or a file of a foreign format. The content decides which one it is,
    /// otherwise the name.
    pub fn new(name: &str, bytes: Vec<u8>, id: u32) -> Source {
        let format = g7_exchange::recognise(name, &bytes);
        let (document, problems) = format
            .and_then(|format| format.read(&bytes, FileId(id)))
            .unwrap_or_else(|| g7_syntax::parse_bytes(&bytes, FileId(id)));
        let (id, marks) = (FileId(id), Marks::none(FileId(id)));
        Source { document, problems, format, marks, id, ..Source::plain(name, bytes) }
    }

    /// Reads a .g7 text, whatever its name is.
    pub fn native(name: &str, bytes: Vec<u8>, id: u32) -> Source {
        let (document, problems) = g7_syntax::parse_bytes(&bytes, FileId(id));
        let (id, marks) = (FileId(id), Marks::none(FileId(id)));
        Source { document, problems, marks, id, ..Source::plain(name, bytes) }
    }

    /// A file that is no chart, for the places of its problems.
    pub fn plain(name: &str, bytes: Vec<u8>) -> Source {
        let text = same_length(&bytes);
        let starts = starts(&text);
        let name = name.chars().map(|c| if c.is_control() { '?' } else { c }).collect();
        let (document, problems) = (Document::default(), Vec::new());
        let marks = Marks::default();
        let (id, links) = (FileId::default(), Links::default());
        Source { name, text, bytes, document, problems, format: None, marks, starts, id, links }
    }

    /// Changes the text of a .g7 file, each range of bytes to the words, and reads what the change touches.
    /// The ranges are in order and do not overlap. Returns false if they do not fit the text, or if the file
    /// is not UTF-8 text.
    pub fn change(&mut self, edits: &[(Range<usize>, &str)]) -> bool {
        if self.bytes != self.text.as_bytes() {
            return false;
        }
        let mut tree = self.take_tree();
        let fits = tree.change(edits);
        self.put_tree(tree);
        fits
    }

    /// The document with the items of all files that this one uses: what is compiled, run and proved. Drawings,
    /// gestures and the printer see [`Source::document`] alone.
    pub fn whole(&self) -> &Document {
        self.links.whole.as_ref().unwrap_or(&self.document)
    }

    /// Changes what was read, but not the text.
    pub fn amend(&mut self, change: impl Fn(&mut Document)) {
        change(&mut self.document);
        if let Some(whole) = &mut self.links.whole {
            change(whole);
        }
    }

    /// The files that it uses, and those that they use, in the order in which they were found.
    pub fn others(&self) -> &[Other] {
        &self.links.others
    }

    /// True if a place lies in a part of the library that this file uses.
    pub fn is_of_library(&self, at: Span) -> bool {
        self.others().iter().any(|o| o.library && o.source.id() == at.file)
    }

    /// This file and all that it uses, without the parts of the library: their names and bytes.
    pub fn files(&self) -> impl Iterator<Item = (&str, &[u8])> {
        let used = self.links.others.iter().filter(|o| !o.library).map(|o| &*o.source);
        std::iter::once(self).chain(used).map(|s| (s.name.as_str(), s.bytes.as_slice()))
    }

    /// The problems of reading: of its own text, of the used files, and of their `use` lines.
    pub fn read_problems(&self) -> Vec<Problem> {
        self.problems.iter().chain(&self.links.problems).cloned().collect()
    }

    /// The number of the file in places.
    pub fn id(&self) -> FileId {
        self.id
    }

    /// The used file in which a place lies; `None` for a place in this one.
    fn other(&self, at: Span) -> Option<&Other> {
        self.links.others.iter().find(|o| o.source.id == at.file)
    }

    /// The file in which a place lies: this one, or one that it uses.
    pub fn home(&self, at: Span) -> &Source {
        self.other(at).map_or(self, |o| &o.source)
    }

    /// Leaves out the warnings about files that this one uses. They are told when those files are checked.
    pub fn about(&self, mut problems: Vec<Problem>) -> Vec<Problem> {
        problems.retain(|p| p.severity() == Severity::Error || self.other(p.at).is_none());
        problems
    }

    /// The problem with places of this text alone. A place in a used file becomes the `use` line that leads there, and
    /// the message begins with that place.
    pub fn own(&self, mut problem: Problem) -> Problem {
        let told = |at: Span, what: &Said| say!("{}: {}", Said::foreign(self.place(at)), what);
        for (at, there) in &mut problem.related {
            if let Some(other) = self.other(*at) {
                (*at, *there) = (other.through, told(*at, there));
            }
        }
        if let Some(other) = self.other(problem.at) {
            problem.what = told(problem.at, &problem.what);
            problem.at = other.through;
            problem.fixes.clear();
        }
        problem
    }

    fn take_tree(&mut self) -> Tree {
        Tree {
            text: std::mem::take(&mut self.text),
            document: std::mem::take(&mut self.document),
            problems: std::mem::take(&mut self.problems),
            marks: std::mem::take(&mut self.marks),
        }
    }

    /// Takes the text of a .g7 file as somebody else has read it.
    pub fn put_tree(&mut self, tree: Tree) {
        let Tree { text, document, problems, marks } = tree;
        self.starts = starts(&text);
        self.bytes.clear();
        self.bytes.extend_from_slice(text.as_bytes());
        (self.text, self.document, self.problems, self.marks) = (text, document, problems, marks);
        // As `parse_bytes` has them.
        self.problems.sort_by_key(|p| p.at.start);
        self.format = None;
    }

    /// True if one of the problems of its own text is an error.
    pub fn has_errors(&self) -> bool {
        self.problems.iter().any(|p| p.severity() == Severity::Error)
    }

    /// True if there is an error in its text, in one that it uses, or in how they go together.
    pub fn is_broken(&self) -> bool {
        self.has_errors() || self.links.problems.iter().any(|p| p.severity() == Severity::Error)
    }

    /// The tests in the file, in the order of the text.
    pub fn tests(&self) -> impl Iterator<Item = &Scenario> {
        self.document.items.iter().filter_map(|i| if let Item::Test(t) = i { Some(t) } else { None })
    }

    /// The range of a span within the text, rounded to whole characters. Of a place in another file, it is the
    /// `use` line that leads there.
    pub fn range(&self, span: Span) -> std::ops::Range<usize> {
        let span = self.other(span).map_or(span, |o| o.through);
        let floor = |at: u32| {
            let mut at = (at as usize).min(self.text.len());
            while !self.text.is_char_boundary(at) {
                at -= 1;
            }
            at
        };
        let start = floor(span.start);
        start..floor(span.end).max(start)
    }

    /// The words at a place, also if it lies in a file that this one uses.
    pub fn written(&self, span: Span) -> &str {
        let home = self.home(span);
        home.text.get(home.range(span)).unwrap_or_default()
    }

    /// The number of the line of a byte, from 0.
    pub fn line(&self, byte: usize) -> usize {
        self.starts.partition_point(|s| *s <= byte).saturating_sub(1)
    }

    /// The line and the column of a byte, both from 1; the column counts characters.
    pub fn position(&self, byte: usize) -> (usize, usize) {
        let line = self.line(byte);
        let start = self.starts.get(line).copied().unwrap_or(0);
        let column = self.text.get(start..byte).map_or(0, |t| t.chars().count());
        (line + 1, column + 1)
    }

    /// The range of bytes of some lines, line ends included.
    pub fn lines(&self, first: usize, last: usize) -> std::ops::Range<usize> {
        let start = self.starts.get(first).copied().unwrap_or(self.text.len());
        let end = self.starts.get(last + 1).copied().unwrap_or(self.text.len());
        start..end.max(start)
    }

    /// The place of a span as `path:line:column`.
    pub fn place(&self, span: Span) -> String {
        let home = self.home(span);
        let (line, column) = home.position(home.range(span).start);
        format!("{}:{line}:{column}", home.name)
    }
}

/// A file that the head uses, or one that such a file uses.
#[derive(Clone, Debug)]
pub struct Other {
    /// Its path from the folder of the head; of a part of the library, its name.
    pub path: String,
    /// True for a part of the library.
    pub library: bool,
    /// The file itself.
    pub source: Arc<Source>,
    /// The `use` line of the head that leads to it first.
    pub through: Span,
}

/// All that a file uses.
#[derive(Clone, Debug, Default)]
pub(crate) struct Links {
    pub(crate) others: Vec<Other>,
    /// The head with the items of all others; none if it uses no file.
    pub(crate) whole: Option<Document>,
    /// Files that cannot be read, and what does not go together.
    pub(crate) problems: Vec<Problem>,
}

/// The first bytes of the lines.
fn starts(text: &str) -> Vec<usize> {
    std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect()
}

/// Decodes text so that each byte stays one byte, because spans count the bytes of the file.
fn same_length(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len());
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        chunk.invalid().iter().for_each(|_| text.push('?'));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(bytes: &[u8]) -> Source {
        Source::new("a.g7", bytes.to_vec(), 0)
    }

    #[test]
    fn bad_bytes_keep_every_place_where_it_was() {
        let s = source(b"ab\xff\xfe\n\xc3\xa5x");
        assert_eq!(s.text.len(), 8);
        assert_eq!(s.position(7), (2, 2), "one character of two bytes before it");
    }

    #[test]
    fn a_changed_source_is_that_of_the_new_text() {
        let text = "input a : BOOL\nchart G {\n  initial step 0\n  0 -> 1 when a\n  step 1\n}\n";
        let mut changed = source(text.as_bytes());
        let at = text.find("when").expect("it is there");
        for (edits, wanted) in [
            (vec![(0..0, "// é\n"), (at..at, "\n")], true),
            (vec![(9_000..9_000, "x")], false),
            (vec![(3..4, "")], false),
            (vec![(0..6, "")], true),
        ] {
            assert_eq!(changed.change(&edits), wanted, "{edits:?}");
            let whole = Source::native("a.g7", changed.text.clone().into_bytes(), 0);
            let shown = |s: &Source| format!("{:?}", (&s.bytes, &s.document, &s.problems, &s.starts));
            assert_eq!(shown(&changed), shown(&whole));
        }
        assert!(!source(b"ab\xff").change(&[(0..1, "")]), "no text");
    }

    #[test]
    fn places_count_lines_and_characters_from_one() {
        let s = source("x\n  höger\n".as_bytes());
        let span = |start, end| Span { file: FileId(0), start, end };
        assert_eq!(s.place(span(4, 9)), "a.g7:2:3");
        assert_eq!(s.place(span(8, 9)), "a.g7:2:6");
        assert_eq!(s.place(span(900, 901)), "a.g7:3:1");
        assert_eq!(s.lines(1, 1), 2..11);
        assert_eq!(s.range(span(6, 6)), 5..5, "inside of ö: back to its start");
    }
}
