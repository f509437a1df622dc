//! Collects the problems of a file in its order and limits their number.

use std::collections::HashMap;
use std::ops::Range;

use g7_model::codes::{self, Code};
use g7_model::{FileId, Note, Problem, Said, Severity, Span, say};

/// The most warnings, and the most errors, that are listed; further ones are only counted.
const MOST: usize = 500;
/// The most places listed with one grouped problem.
const MOST_PLACES: usize = 100;
/// The longest piece of XML that is kept as a note.
const LONGEST_NOTE: usize = 300;

/// The problems found so far.
pub struct Report {
    file: FileId,
    problems: Vec<Problem>,
    /// The number of errors that may still be listed.
    errors: usize,
    warnings: usize,
    /// Problems of the same kind are grouped into one problem with many places.
    groups: HashMap<(&'static str, String), (usize, usize)>,
    left_out: usize,
    notes: Vec<Note>,
}

impl Report {
    /// An empty report on a file.
    pub fn new(file: FileId) -> Report {
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
    pub fn span(&self, at: &Range<usize>) -> Span {
        let clip = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Span { file: self.file, start: clip(at.start), end: clip(at.end.max(at.start)) }
    }

    /// Reports a problem at a range of bytes of the file.
    pub fn say(&mut self, code: &'static Code, at: &Range<usize>, what: Said) {
        self.put(Problem::new(code, self.span(at), what));
    }

    /// Adds a problem.
    pub fn put(&mut self, problem: Problem) {
        let room = if problem.severity() == Severity::Error { &mut self.errors } else { &mut self.warnings };
        match room.checked_sub(1) {
            Some(left) => {
                *room = left;
                self.problems.push(problem);
            }
            None => self.left_out += 1,
        }
    }

    /// Reports an element without counterpart. All elements of one name form one problem.
    pub fn element(&mut self, code: &'static Code, tag: &str, at: &Range<usize>, what: Said) {
        let span = self.span(at);
        let key = (code.id, tag.to_string());
        if let Some((index, count)) = self.groups.get_mut(&key) {
            *count += 1;
            if let Some(problem) = self.problems.get_mut(*index)
                && problem.related.len() < MOST_PLACES
            {
                problem.related.push((span, say!("another `{tag}`")));
            }
            return;
        }
        let before = self.problems.len();
        self.put(Problem::new(code, span, what));
        if self.problems.len() > before {
            self.groups.insert(key, (before, 1));
        }
    }

    /// Keeps the text of an element without counterpart as a note for the reader.
    pub fn keep(&mut self, xml: &str) {
        if self.notes.len() >= MOST {
            return;
        }
        let line: String =
            xml.chars().take(LONGEST_NOTE).map(|c| if c.is_control() { ' ' } else { c }).collect();
        let at = self.span(&(0..0));
        self.notes.push(Note {
            text: format!("// not carried over: {}", line.trim_end()).into(),
            at,
            behind: None,
        });
    }

    /// The notes kept so far.
    pub fn take_notes(&mut self) -> Vec<Note> {
        std::mem::take(&mut self.notes)
    }

    /// All problems, in the order of the file.
    pub fn finish(mut self) -> Vec<Problem> {
        let mut counts: Vec<(usize, usize)> = self.groups.into_values().filter(|(_, n)| *n > 1).collect();
        counts.sort_unstable();
        for (index, count) in counts {
            if let Some(problem) = self.problems.get_mut(index) {
                problem.what = say!("{} ({count} of them)", problem.what);
            }
        }
        if self.left_out > 0 {
            let at = Span { file: self.file, start: 0, end: 0 };
            let what = say!("{} more problems are not listed", self.left_out);
            self.problems.push(Problem::new(&codes::TOO_MANY_PROBLEMS, at, what));
        }
        self.problems.sort_by_key(|p| (p.at.start, p.at.end));
        self.problems
    }
}

/// Text of the file on one line, short enough for a message.
pub fn shown(text: &str) -> String {
    const LONGEST: usize = 80;
    let mut short: String =
        text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        short.push('…');
    }
    short
}

/// One message for all names that had to be changed: the place of each, the old and the new name.
pub fn renamed(list: &[(Span, Box<str>, String)]) -> Option<Problem> {
    let ((at, from, to), others) = list.split_first()?;
    let more = others.len();
    let tail = if more > 0 { say!("; {more} more names are changed as well") } else { Said::default() };
    let word = crate::words::everywhere().any(|w| w.eq_ignore_ascii_case(from));
    let why = if word { say!(", because it is a word of IEC 61131-3") } else { Said::default() };
    let what = say!("`{from}` is called `{to}` there{why}{tail}");
    let mut problem = Problem::new(&codes::RENAMED, *at, what);
    // Places beyond these would be pages of output; the names stand in the file that is written.
    for (at, _, to) in others.iter().take(8) {
        problem.related.push((*at, say!("called `{to}`")));
    }
    Some(problem)
}
