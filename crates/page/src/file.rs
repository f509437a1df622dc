//! A file that is open in the page.

use std::sync::Arc;

use g7_edit::{History, Splice, spliced};
use g7_model::{FileId, Problem, Severity};
use g7_rig::Source;

use crate::drawing::Good;
use crate::positions::Positions;
use crate::problems::Change;

/// Text, what it means, and what is wrong with it.
pub(crate) struct File {
    pub(crate) source: Source,
    pub(crate) positions: Arc<Positions>,
    /// The latest document without syntax errors, and the text it came from.
    good: Option<Good>,
    pub(crate) problems: Vec<Problem>,
    pub(crate) version: u64,
    /// Came from a JGrafchart file.
    pub(crate) imported: bool,
    pub(crate) history: History,
}

/// Longest text that is opened, in bytes.
pub(crate) const MOST: usize = 16 << 20;

impl File {
    /// Reads a text; a JGrafchart file becomes .g7 text.
    pub(crate) fn open(name: &str, text: String) -> Result<File, String> {
        if text.len() > MOST {
            return Err(format!("{name} is too large for the editor"));
        }
        let mut source = Source::new(name, text.into_bytes(), 0);
        let imported = source.format.is_some();
        let mut told = Vec::new();
        if imported {
            if source.has_errors() {
                let why = source.problems.first().map_or(String::new(), |p| format!(": {}", p.what));
                return Err(format!("{name} cannot be imported{why}"));
            }
            // What the importer had to leave out stays said; it has no place in the new text.
            told = std::mem::take(&mut source.problems);
            g7_draw::make_room(&mut source.document);
            let text = g7_syntax::print(&source.document, None);
            source = Source::new(name, text.into_bytes(), 0);
        }
        let mut file = File {
            positions: Arc::new(Positions::new(&source.text)),
            good: None,
            problems: Vec::new(),
            version: 0,
            imported,
            history: History::default(),
            source,
        };
        file.judge();
        let nowhere = g7_model::Span { file: FileId(0), start: 0, end: 0 };
        file.problems.extend(told.into_iter().map(|p| Problem { at: nowhere, related: Vec::new(), ..p }));
        Ok(file)
    }

    /// Makes a change and remembers it; typing grows by words.
    pub(crate) fn change(&mut self, splices: &[Splice], typed: bool) -> Result<(), String> {
        let text = spliced(self.text(), splices).ok_or("these places are none of the text")?;
        if text.len() > MOST {
            return Err("the text would be too large for the editor".to_owned());
        }
        if !self.history.record(&self.source.text, splices, typed) {
            return Err("these places are none of the text".to_owned());
        }
        self.set_text(text);
        Ok(())
    }

    /// Takes the last change back, or makes it again; what that changed.
    pub(crate) fn travel(&mut self, back: bool) -> Result<Vec<Splice>, String> {
        let splices = if back { self.history.undo() } else { self.history.redo() };
        let nothing = if back { "nothing to undo" } else { "nothing to redo" };
        let splices = splices.ok_or(nothing)?;
        let text = spliced(self.text(), &splices).ok_or("the history does not fit the text")?;
        self.set_text(text);
        Ok(splices)
    }

    fn set_text(&mut self, text: String) {
        self.source = Source::new(&self.source.name, text.into_bytes(), 0);
        self.positions = Arc::new(Positions::new(&self.source.text));
        self.version += 1;
        self.judge();
    }

    /// The text as gestures take it.
    pub(crate) fn as_edited(&self) -> g7_edit::Source<'_> {
        g7_edit::Source { text: self.text(), document: &self.source.document, clean: self.is_clean() }
    }

    /// Splices as they go out, in code units of the text before them.
    pub(crate) fn outward(&self, splices: &[Splice]) -> Vec<Change> {
        let unit = |byte| self.positions.unit(self.text(), byte);
        let change = |s: &Splice| Change { from: unit(s.start), to: unit(s.end), insert: s.insert.clone() };
        splices.iter().map(change).collect()
    }

    /// Splices as they come in.
    pub(crate) fn inward(&self, splices: &[Change]) -> Vec<Splice> {
        let byte = |unit| self.positions.byte(self.text(), unit);
        splices.iter().map(|s| Splice::new(byte(s.from), byte(s.to), s.insert.as_str())).collect()
    }

    pub(crate) fn text(&self) -> &str {
        &self.source.text
    }

    /// Whether it parses without errors.
    pub(crate) fn is_clean(&self) -> bool {
        !self.source.has_errors()
    }

    /// Looks for problems and keeps the document where it can be drawn.
    fn judge(&mut self) {
        self.problems = match g7_rig::testing::problems(&self.source, None) {
            Ok(problems) => problems,
            Err(_) => self.source.problems.clone(),
        };
        self.problems.sort_by_key(|p| (p.at, p.severity() == Severity::Warning));
        if self.is_clean() {
            self.good = Some(self.present(false));
        }
    }

    fn present(&self, stale: bool) -> Good {
        Good {
            document: Arc::new(self.source.document.clone()),
            text: self.source.text.as_str().into(),
            positions: Arc::clone(&self.positions),
            stale,
        }
    }

    /// The document to draw: that of the latest text without syntax errors. A
    /// text that never was without is drawn as far as it could be read.
    pub(crate) fn drawn(&self) -> Good {
        match &self.good {
            Some(good) => Good { stale: !self.is_clean(), ..good.clone() },
            None => self.present(false),
        }
    }
}
