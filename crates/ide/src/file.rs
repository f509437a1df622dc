//! A file that is open in an editor.

use std::sync::Arc;

use g7_edit::{Edit, History, Splice, spliced};
use g7_model::{Document, FileId, Problem, Severity, Span};
use g7_rig::Source;

use crate::positions::Positions;

/// The text of a file, its meaning, and its problems.
pub struct File {
    /// The text, the document and the problems of its syntax.
    pub source: Source,
    /// The places of the text in other units.
    pub positions: Arc<Positions>,
    /// The latest document without syntax errors.
    readable: Option<Readable>,
    /// All problems, in the order of the text.
    pub problems: Vec<Problem>,
    /// The number of changes since the file was opened.
    pub version: u64,
    /// True if it was imported from a foreign format.
    pub imported: bool,
    /// The changes that can be undone.
    pub history: History,
}

/// Greatest length of a text that is opened, in bytes.
const MOST: usize = 16 << 20;

impl File {
    /// Reads a text; a file of a foreign format is converted to .g7 text.
    pub fn open(name: &str, text: String) -> Result<File, String> {
        fits(name, &text)?;
        let mut source = Source::new(name, text.into_bytes(), 0);
        let imported = source.format.is_some();
        let mut told = Vec::new();
        if imported {
            if source.has_errors() {
                let why = source.problems.first().map_or(String::new(), |p| format!(": {}", p.what));
                return Err(format!("{name} cannot be imported{why}"));
            }
            // The importer's problems are kept without their places, which do not exist in the new
            // text.
            told = std::mem::take(&mut source.problems);
            g7_draw::make_room(&mut source.document);
            let text = g7_syntax::print(&source.document, None);
            source = Source::native(name, text.into_bytes(), 0);
        }
        let mut file = File::of(source, imported);
        let nowhere = Span { file: FileId(0), start: 0, end: 0 };
        file.problems.extend(told.into_iter().map(|p| Problem {
            at: nowhere,
            related: Vec::new(),
            fixes: Vec::new(),
            ..p
        }));
        Ok(file)
    }

    /// Reads a .g7 text, whatever its name is.
    pub fn open_native(name: &str, text: String) -> Result<File, String> {
        fits(name, &text)?;
        Ok(File::of(Source::native(name, text.into_bytes(), 0), false))
    }

    fn of(source: Source, imported: bool) -> File {
        let mut file = File {
            positions: Arc::new(Positions::new(&source.text)),
            readable: None,
            problems: Vec::new(),
            version: 0,
            imported,
            history: History::default(),
            source,
        };
        file.judge();
        file
    }

    /// Makes a change and records it for undo; typed characters are joined to words.
    pub fn change(&mut self, splices: &[Splice], typed: bool) -> Result<(), String> {
        self.recorded(splices, typed)?;
        self.splice(splices)
    }

    /// Makes the change of a gesture. What the gesture has read of the new text is not read again.
    pub fn make(&mut self, edit: &mut Edit) -> Result<(), String> {
        self.recorded(&edit.splices, false)?;
        match edit.read.take() {
            Some(read) => {
                self.source.put_tree(*read);
                self.changed();
                Ok(())
            }
            None => self.splice(&edit.splices),
        }
    }

    /// Records a change that is about to be made.
    fn recorded(&mut self, splices: &[Splice], typed: bool) -> Result<(), String> {
        let more: usize = splices.iter().map(|s| s.insert.len()).sum();
        let less: usize = splices.iter().map(|s| s.end.saturating_sub(s.start)).sum();
        if (self.text().len() + more).saturating_sub(less) > MOST {
            return Err("the text would be too large for the editor".to_owned());
        }
        if !self.history.record(&self.source.text, splices, typed) {
            return Err("these places are none of the text".to_owned());
        }
        Ok(())
    }

    /// Takes another text, which an editor with an undo of its own has made.
    pub fn take(&mut self, text: String) -> Result<(), String> {
        fits("the text", &text)?;
        let splice = difference(self.text(), &text);
        self.splice(&[splice])
    }

    /// Undoes the last change, or redoes it; returns the splices.
    pub fn travel(&mut self, back: bool) -> Result<Vec<Splice>, String> {
        let splices = if back { self.history.undo() } else { self.history.redo() };
        let nothing = if back { "nothing to undo" } else { "nothing to redo" };
        let splices = splices.ok_or(nothing)?;
        self.splice(&splices).map_err(|_| "the history does not fit the text")?;
        Ok(splices)
    }

    /// The text before the last change, if there was one.
    pub fn before(&self) -> Option<String> {
        let splices = self.history.clone().undo()?;
        spliced(self.text(), &splices)
    }

    /// Changes the text. The form was decided when the file was opened: an imported file keeps its name,
    /// but its text is .g7 text now.
    fn splice(&mut self, splices: &[Splice]) -> Result<(), String> {
        let edits: Vec<_> = splices.iter().map(|s| (s.start..s.end, s.insert.as_str())).collect();
        if !self.source.change(&edits) {
            return Err("these places are none of the text".to_owned());
        }
        self.changed();
        Ok(())
    }

    fn changed(&mut self) {
        self.positions = Arc::new(Positions::new(&self.source.text));
        self.version += 1;
        self.judge();
    }

    /// The file in the form that gestures need.
    pub fn as_edited(&self) -> g7_edit::Source<'_> {
        let Source { text, document, problems, marks, .. } = &self.source;
        g7_edit::Source { text, document, problems, marks: Some(marks) }
    }

    /// A place in code units.
    pub fn units(&self, at: Span) -> (usize, usize) {
        let range = self.source.range(at);
        let unit = |byte| self.positions.unit(self.text(), byte);
        (unit(range.start), unit(range.end))
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.source.text
    }

    /// True if the text has no syntax errors.
    pub fn is_clean(&self) -> bool {
        !self.source.has_errors()
    }

    /// Finds the problems, and keeps the document if it has no syntax errors.
    fn judge(&mut self) {
        self.problems = match g7_rig::testing::problems(&self.source, None) {
            Ok(problems) => problems,
            Err(_) => self.source.problems.clone(),
        };
        self.problems.sort_by_key(|p| (p.at, p.severity() == Severity::Warning));
        if self.is_clean() {
            self.readable = Some(self.present(false));
        }
    }

    fn present(&self, stale: bool) -> Readable {
        Readable {
            document: Arc::new(self.source.document.clone()),
            text: self.source.text.as_str().into(),
            positions: Arc::clone(&self.positions),
            stale,
        }
    }

    /// The document to draw: that of the latest text without syntax errors. If there was never such
    /// a text, it is the readable part of the present one.
    pub fn drawn(&self) -> Readable {
        match &self.readable {
            Some(readable) => Readable { stale: !self.is_clean(), ..readable.clone() },
            None => self.present(false),
        }
    }
}

/// Refuses a text that is too long, under the name of what it belongs to.
fn fits(what: &str, text: &str) -> Result<(), String> {
    if text.len() > MOST { Err(format!("{what} is too large for the editor")) } else { Ok(()) }
}

/// The one change that leads from a text to another: what lies between their common beginning and their
/// common end.
fn difference(old: &str, new: &str) -> Splice {
    let same = old.bytes().zip(new.bytes()).take_while(|(a, b)| a == b).count();
    let start = floor(old, same);
    let most = old.len().min(new.len()) - start;
    let ends = old.bytes().rev().zip(new.bytes().rev()).take(most);
    let mut tail = ends.take_while(|(a, b)| a == b).count();
    while !old.is_char_boundary(old.len() - tail) {
        tail -= 1;
    }
    Splice::new(start, old.len() - tail, new.get(start..new.len() - tail).unwrap_or_default())
}

/// The nearest byte before a place, or at it, at which a character begins.
pub(crate) fn floor(text: &str, byte: usize) -> usize {
    let mut byte = byte.min(text.len());
    while !text.is_char_boundary(byte) {
        byte -= 1;
    }
    byte
}

/// A readable document, with the text from which it was parsed.
#[derive(Clone)]
pub struct Readable {
    /// The document.
    pub document: Arc<Document>,
    /// The text.
    pub text: Arc<str>,
    /// The places of the text in other units.
    pub positions: Arc<Positions>,
    /// True if it is an earlier text, because the present one has syntax errors.
    pub stale: bool,
}

impl Readable {
    /// A place in code units of the text.
    pub fn units(&self, at: Span) -> (usize, usize) {
        let unit = |byte: u32| self.positions.unit(&self.text, byte as usize);
        (unit(at.start), unit(at.end))
    }

    /// The words at a place.
    pub fn words(&self, at: Span) -> String {
        self.text.get(at.start as usize..at.end as usize).unwrap_or("").to_owned()
    }
}
