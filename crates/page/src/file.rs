//! A file that is open in the page.

use std::sync::Arc;

use g7_model::{FileId, Problem, Severity};
use g7_rig::Source;

use crate::drawing::Good;
use crate::positions::Positions;

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
        let imported = source.imported;
        let mut told = Vec::new();
        if imported {
            if source.has_errors() {
                let why = source.problems.first().map_or(String::new(), |p| format!(": {}", p.what));
                return Err(format!("{name} cannot be imported{why}"));
            }
            // What the importer had to leave out stays said; it has no place in the new text.
            told = std::mem::take(&mut source.problems);
            let text = g7_syntax::print(&source.document, None);
            source = Source::new(name, text.into_bytes(), 0);
        }
        let mut file = File {
            positions: Arc::new(Positions::new(&source.text)),
            good: None,
            problems: Vec::new(),
            version: 0,
            imported,
            source,
        };
        file.judge();
        let nowhere = g7_model::Span { file: FileId(0), start: 0, end: 0 };
        file.problems.extend(told.into_iter().map(|p| Problem { at: nowhere, related: Vec::new(), ..p }));
        Ok(file)
    }

    /// Takes a new text.
    pub(crate) fn set_text(&mut self, text: String) {
        self.source = Source::new(&self.source.name, text.into_bytes(), 0);
        self.positions = Arc::new(Positions::new(&self.source.text));
        self.version += 1;
        self.judge();
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
