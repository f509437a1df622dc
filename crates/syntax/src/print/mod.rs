//! The canonical form of a document, as `g7 fmt` writes it.
//!
//! Two blanks for each level, one statement, action or item on each line, at most one blank line
//! between them. Notes keep their place before, after or at the end of the line of the element that
//! they belong to. The printed text reads as the same document, and printing that again changes
//! nothing.

mod chart;
mod composed;
mod expr;
mod item;
pub(crate) mod part;
mod st;
mod world;

use crate::lexer::{name_continue, name_start};
use crate::quote;
use crate::{LineIndex, words};
use g7_iec::constant;
use g7_model::{Document, Expr, Nanos, Note, Span, Stmt, chart_in, instance_of};

/// The largest width of a line that is joined from several parts.
const WIDTH: usize = 100;

/// The canonical text of a document without `Bad` expressions.
///
/// `source` is the text that it was read from. With it blank lines, notes at
/// the end of a line and the spelling of numbers (`16#FF`) are kept; a document
/// made by a program has none, and is spaced by what its items are.
pub fn print(document: &Document, source: Option<&str>) -> String {
    let mut printer = Printer::new(&document.notes, source);
    printer.document(document);
    printer.out
}

/// The canonical text of an expression.
pub fn print_expr(expr: &Expr) -> String {
    let mut printer = Printer::new(&[], None);
    printer.expr(expr);
    printer.out
}

/// The canonical text of statements, a line each or more.
pub fn print_statements(statements: &[Stmt]) -> String {
    let mut printer = Printer::new(&[], None);
    printer.statements(statements);
    printer.out
}

/// The text of a part that keeps its spelling, by its place; further lines are indented as if the part
/// stood at the left margin. `None` if the part is to be printed.
pub type Spelled<'a> = &'a dyn Fn(Span) -> Option<String>;

/// The text so far, and the notes that are still to be printed.
struct Printer<'a> {
    out: String,
    indent: usize,
    notes: &'a [Note],
    source: Option<LineIndex<'a>>,
    /// The texts of parts that keep their spelling.
    spelled: Option<Spelled<'a>>,
    /// The place in the source where the last element of this block ended; `None` at its start.
    last_end: Option<u32>,
}

impl<'a> Printer<'a> {
    fn new(notes: &'a [Note], source: Option<&'a str>) -> Printer<'a> {
        let source = source.map(LineIndex::new);
        Printer { out: String::new(), indent: 0, notes, source, spelled: None, last_end: None }
    }

    fn push(&mut self, text: &str) {
        self.out.push_str(text);
    }

    /// Prints a word and the duration after it, spelled as in the source if the source has this
    /// duration.
    fn time_clause(&mut self, word: &str, time: Option<Nanos>, at: Span) {
        let Some(time) = time else { return };
        if self.out.ends_with(|c: char| !c.is_whitespace()) {
            self.push(" ");
        }
        self.push(word);
        self.push(" ");
        match self.time_as_written(word, time, at) {
            Some(text) => self.out.push_str(text),
            None => self.push(&time.to_string()),
        }
    }

    /// The tree holds only the value; the source has its spelling after the word.
    fn time_as_written(&self, word: &str, time: Nanos, at: Span) -> Option<&'a str> {
        let text = self.source.as_ref()?.text().get(at.start as usize..at.end as usize)?;
        let mut words = text.split(|c: char| c.is_whitespace() || matches!(c, ';' | '{' | '}'));
        while words.any(|w| w == word) {
            let next = words.clone().find(|w| !w.is_empty())?;
            if constant::duration(next) == Ok(time) && next.starts_with(|c: char| c.is_ascii_alphanumeric()) {
                return Some(next);
            }
        }
        None
    }

    fn start_line(&mut self) {
        for _ in 0..self.indent {
            self.out.push_str("  ");
        }
    }

    /// The number of characters on the current line.
    fn column(&self) -> usize {
        let line = self.out.rsplit('\n').next().unwrap_or_default();
        line.chars().count()
    }

    // Lines and notes

    /// Prints an element on a line of its own that contains no others.
    fn line(&mut self, at: Span, apart: bool, write: impl FnOnce(&mut Self)) {
        self.group_from(at, at.end, apart, write);
    }

    /// Prints an element that begins a line and contains others, which print themselves with their
    /// notes.
    fn group(&mut self, at: Span, apart: bool, write: impl FnOnce(&mut Self)) {
        self.group_from(at, at.start, apart, write);
    }

    fn group_from(&mut self, at: Span, notes_to: u32, apart: bool, write: impl FnOnce(&mut Self)) {
        let waiting = self.notes.len();
        self.notes_before(notes_to, apart);
        // The blank line comes before the notes.
        self.gap(at.start, apart && self.notes.len() == waiting);
        self.start_line();
        write(self);
        self.end_line(at);
    }

    /// Ends a line, after the notes that stand at the end of the line in the source.
    fn end_line(&mut self, at: Span) {
        self.last_end = Some(at.end);
        self.notes_behind(at.end, None);
        self.push("\n");
    }

    /// Prints a blank line before an element if the source has one or its kind needs one.
    fn gap(&mut self, start: u32, apart: bool) {
        let Some(end) = self.last_end else { return };
        if apart || self.source_blank(end, start) {
            self.push("\n");
        }
    }

    fn source_blank(&self, end: u32, start: u32) -> bool {
        let Some(source) = &self.source else { return false };
        let between = source.text().get(end as usize..start as usize).unwrap_or_default();
        // The first part is the rest of a line, the last part the start of one.
        let whole = between.matches('\n').count().saturating_sub(1);
        between.split('\n').skip(1).take(whole).any(|line| line.trim().is_empty())
    }

    /// Prints the notes that begin before a byte, each on a line of its own.
    fn notes_before(&mut self, byte: u32, apart: bool) {
        let mut apart = apart;
        while let Some((note, rest)) = self.notes.split_first() {
            if note.at.start >= byte && note.at.end > 0 {
                return;
            }
            self.notes = rest;
            self.gap(note.at.start, apart);
            apart = false;
            self.start_line();
            self.push(&note.text);
            self.push("\n");
            self.last_end = Some(note.at.end);
        }
    }

    /// Prints the notes that follow a byte directly on its line in the source.
    fn notes_behind(&mut self, byte: u32, limit: Option<u32>) {
        let Some(source) = self.source.take() else { return };
        let mut end = byte;
        while let Some((note, rest)) = self.notes.split_first() {
            let between = source.text().get(end as usize..note.at.start as usize);
            let close = match limit {
                Some(limit) => note.at.start < limit && source.line(note.at.start) == source.line(byte),
                None => between.is_some_and(|b| b.chars().all(|c| matches!(c, ' ' | '\t' | ';' | ','))),
            };
            if !close {
                break;
            }
            self.notes = rest;
            self.push(" ");
            self.push(&note.text);
            end = note.at.end;
            self.last_end = Some(end);
            if note.text.starts_with("//") || note.text.contains('\n') {
                break;
            }
        }
        self.source = Some(source);
    }

    /// True if a note begins in these bytes.
    fn notes_in(&self, at: Span) -> bool {
        self.notes.first().is_some_and(|n| n.at.start < at.end && n.at.start >= at.start)
    }

    /// Prints elements in braces, one on each line; `first` is the start of the first one.
    fn braces(&mut self, at: Span, first: Option<u32>, write: impl FnOnce(&mut Self)) {
        self.push("{");
        if first.is_none() && !self.notes_in(at) {
            self.push("}");
            return;
        }
        self.notes_behind(at.start, Some(first.unwrap_or(at.end)));
        self.push("\n");
        self.inside(at, write);
        self.start_line();
        self.push("}");
    }

    /// Prints the elements of a block one level deeper, and the notes after the last of them.
    fn inside(&mut self, at: Span, write: impl FnOnce(&mut Self)) {
        self.indent += 1;
        self.last_end = None;
        write(self);
        self.notes_before(at.end, false);
        self.indent -= 1;
    }

    /// Tries to print on the current line; undoes it and returns false if it does not fit.
    fn try_inline(&mut self, write: impl FnOnce(&mut Self)) -> bool {
        let (length, last_end) = (self.out.len(), self.last_end);
        write(self);
        let fits = !self.out.get(length..).unwrap_or_default().contains('\n') && self.column() <= WIDTH;
        if !fits {
            self.out.truncate(length);
            self.last_end = last_end;
        }
        fits
    }

    // Words

    /// A name in a place where no word of the language is allowed.
    fn name(&mut self, name: &str) {
        if is_plain(name) {
            self.push(name);
        } else {
            self.push(&quote::quote(name, '`'));
        }
    }

    /// The first name of a path: that of an instance of a chart has an index.
    fn chart_name(&mut self, name: &str) {
        let Some((chart, _)) = instance_of(name) else { return self.name(name) };
        self.name(chart);
        self.push(&name[chart.len()..]);
    }

    /// The name of a chart in an order or a macro-step, which can be that of an instance of a function block:
    /// `gripper[2].Cycle`.
    fn chart_path(&mut self, name: &str) {
        let bare = |part: &str| is_plain(chart_in(part));
        // A name in back-ticks can have any text.
        if !name.contains('.') || !name.split('.').all(bare) {
            return self.chart_name(name);
        }
        for (n, part) in name.split('.').enumerate() {
            self.push(if n > 0 { "." } else { "" });
            self.chart_name(part);
        }
    }

    /// A name in a place where words of the language are allowed.
    fn first_name(&mut self, name: &str) {
        if is_plain(name) && !words::is_contextual(name) {
            self.push(name);
        } else {
            self.push(&quote::quote(name, '`'));
        }
    }

    fn names(&mut self, names: &[g7_model::Name]) {
        for (i, name) in names.iter().enumerate() {
            self.push(if i > 0 { ", " } else { "" });
            self.name(&name.text);
        }
    }

    /// ` "…"`, if there is a comment.
    fn comment(&mut self, comment: Option<&str>) {
        if let Some(comment) = comment {
            self.push(" ");
            self.push(&quote::quote(comment, '"'));
        }
    }
}

/// True if a name needs no back-ticks.
pub(crate) fn is_plain(name: &str) -> bool {
    let mut chars = name.chars();
    let Some(first) = chars.next() else { return false };
    if first.is_ascii_digit() {
        return chars.all(|c| c.is_ascii_digit());
    }
    name_start(first) && chars.all(name_continue) && !words::is_reserved(name)
}
