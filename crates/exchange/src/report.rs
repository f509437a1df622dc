//! What is wrong with the file, collected in its order and without floods.

use std::collections::HashMap;
use std::ops::Range;

use g7_model::codes::{self, Code};
use g7_model::{FileId, Note, Problem, Severity, Span};

/// More warnings, or errors, than anyone reads; the rest is only counted.
const MOST: usize = 500;
/// Places listed with one grouped problem.
const MOST_PLACES: usize = 100;
/// Longest piece of XML kept as a note.
const LONGEST_NOTE: usize = 300;

/// The problems found so far.
pub(crate) struct Report {
    file: FileId,
    problems: Vec<Problem>,
    /// Room for more errors and warnings.
    errors: usize,
    warnings: usize,
    /// Elements of one sort are one problem with many places.
    groups: HashMap<(&'static str, String), (usize, usize)>,
    left_out: usize,
    notes: Vec<Note>,
}

impl Report {
    pub(crate) fn new(file: FileId) -> Report {
        Report {
            file,
            problems: Vec::new(),
            errors: MOST,
            warnings: MOST,
            groups: HashMap::new(),
            left_out: 0,
            notes: Vec::new(),
        }
    }

    /// The span of a range of bytes of the file.
    pub(crate) fn span(&self, at: &Range<usize>) -> Span {
        let clip = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Span { file: self.file, start: clip(at.start), end: clip(at.end.max(at.start)) }
    }

    pub(crate) fn say(&mut self, code: &'static Code, at: &Range<usize>, what: impl Into<String>) {
        self.put(Problem::new(code, self.span(at), what));
    }

    pub(crate) fn put(&mut self, problem: Problem) {
        let room = if problem.severity() == Severity::Error { &mut self.errors } else { &mut self.warnings };
        match room.checked_sub(1) {
            Some(left) => {
                *room = left;
                self.problems.push(problem);
            }
            None => self.left_out += 1,
        }
    }

    /// Reports an element that has no counterpart; all of one name are one problem.
    pub(crate) fn element(&mut self, code: &'static Code, tag: &str, at: &Range<usize>, what: &str) {
        let span = self.span(at);
        let key = (code.id, tag.to_string());
        if let Some((index, count)) = self.groups.get_mut(&key) {
            *count += 1;
            if let Some(problem) = self.problems.get_mut(*index)
                && problem.related.len() < MOST_PLACES
            {
                problem.related.push((span, format!("another `{tag}`")));
            }
            return;
        }
        let before = self.problems.len();
        self.put(Problem::new(code, span, what));
        if self.problems.len() > before {
            self.groups.insert(key, (before, 1));
        }
    }

    /// Keeps the text of an element that has no counterpart as a note to the reader.
    pub(crate) fn keep(&mut self, xml: &str) {
        if self.notes.len() >= MOST {
            return;
        }
        let line: String =
            xml.chars().take(LONGEST_NOTE).map(|c| if c.is_control() { ' ' } else { c }).collect();
        let at = self.span(&(0..0));
        self.notes.push(Note { text: format!("// not carried over: {}", line.trim_end()).into(), at });
    }

    /// The notes kept so far.
    pub(crate) fn take_notes(&mut self) -> Vec<Note> {
        std::mem::take(&mut self.notes)
    }

    /// All problems, in the order of the file.
    pub(crate) fn finish(mut self) -> Vec<Problem> {
        let mut counts: Vec<(usize, usize)> = self.groups.into_values().filter(|(_, n)| *n > 1).collect();
        counts.sort_unstable();
        for (index, count) in counts {
            if let Some(problem) = self.problems.get_mut(index) {
                problem.what.push_str(&format!(" ({count} of them)"));
            }
        }
        if self.left_out > 0 {
            let at = Span { file: self.file, start: 0, end: 0 };
            let what = format!("{} more problems are not listed", self.left_out);
            self.problems.push(Problem::new(&codes::TOO_MANY_PROBLEMS, at, what));
        }
        self.problems.sort_by_key(|p| (p.at.start, p.at.end));
        self.problems
    }
}
