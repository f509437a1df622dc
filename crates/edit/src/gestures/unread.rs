//! Finds places of a text with syntax errors that may hold a name, though no name was read there.
//!
//! It stands beside `rename`, which changes every name that is read. A text with errors can hold the name in two
//! more ways: in words that were passed over, and as a name whose meaning is not known because its declaration
//! was passed over.
//!
//! # What must hold
//!
//! A word that may be the name once the errors are corrected is found. A word too many only refuses a change.

use std::ops::Range;

use g7_compile::references::Written;
use g7_compile::{Definition, References};
use g7_model::visit::Visitor;
use g7_model::{Item, Name, Order, Span, codes};
use g7_syntax::{Token, TokenKind, tokens};

use crate::change::Source;

/// The first place that may hold a name, the old or the new one of a part, and was not read as such.
#[inline(never)]
pub(super) fn unread(
    source: &Source<'_>,
    refs: &References,
    definition: &Definition,
    name: &str,
) -> Option<Range<usize>> {
    if source.is_clean() {
        return None;
    }
    let search = Search { source, refs, definition, name, numbers: numbers(source) };
    let unknown = search.unknown();
    let passed = tokens(source.text).filter(|t| search.spelled(*t) && search.passed_over(*t));
    unknown.chain(passed.map(|t| t.start..t.end)).min_by_key(|at| at.start)
}

/// The places of numbers that are read as values.
#[inline(never)]
fn numbers(source: &Source<'_>) -> Vec<Span> {
    struct Values(Vec<Span>);
    impl<'d> Visitor<'d> for Values {
        fn path(&mut self, _: &'d [Name]) {}
        fn direct(&mut self, _: &'d str, _: Span) {}
        fn order(&mut self, _: &'d Order) {}
        fn value(&mut self, at: Span) {
            self.0.push(at);
        }
    }
    let mut values = Values(Vec::new());
    values.document(source.document);
    values.0
}

struct Search<'a> {
    source: &'a Source<'a>,
    refs: &'a References,
    definition: &'a Definition,
    name: &'a str,
    numbers: Vec<Span>,
}

impl Search<'_> {
    /// Names that refer to nothing in the document, and so may refer to this part.
    fn unknown(&self) -> impl Iterator<Item = Range<usize>> {
        let may_be_step =
            |chart: &str| matches!(self.definition, Definition::Step { chart: of, .. } if of == chart);
        let known = self.refs.unknown().iter().filter(move |u| u.step_of.as_deref().is_none_or(may_be_step));
        known
            .map(|u| u.at.bytes())
            .filter(|at| self.source.text.get(at.clone()).is_some_and(|w| self.is_name(w)))
    }

    /// True if a word is the name, or contains it as `X12` and `%X12` contain `12`.
    fn is_name(&self, word: &str) -> bool {
        let word = word.trim_matches('`');
        let one = |w: &str| w == self.name || w.strip_prefix('X') == Some(self.name);
        one(word) || word.split(|c: char| !c.is_alphanumeric() && c != '_').any(one)
    }

    /// True if a token is the name, or may contain it because its end was not found.
    fn spelled(&self, token: Token) -> bool {
        let word = self.source.text.get(token.start..token.end).unwrap_or_default();
        match token.kind {
            TokenKind::Word | TokenKind::Ticked | TokenKind::Number | TokenKind::Time => self.is_name(word),
            TokenKind::Direct => word.starts_with("%X") && self.is_name(word),
            TokenKind::Str | TokenKind::Comment | TokenKind::Note => {
                self.unclosed(token) && word.contains(self.name)
            }
            _ => false,
        }
    }

    /// True if a quotation or a note on the line of this one is never closed.
    fn unclosed(&self, token: Token) -> bool {
        let line = self.line(token.start);
        let opened = |at: usize| line.contains(&at) || at == token.start;
        let mut problems = self.source.problems.iter().filter(|p| p.code == &codes::UNCLOSED);
        problems.any(|p| opened(p.at.bytes().start))
    }

    /// True if a token stands in a broken place, so that nothing was read from it.
    #[inline(never)]
    fn passed_over(&self, token: Token) -> bool {
        let bytes = token.start..token.end;
        let covers = |at: Span| at.bytes().start <= token.start && token.end <= at.bytes().end;
        if self.source.reads_cleanly(bytes)
            || self.refs.all().iter().any(|u| covers(u.at))
            || self.refs.unknown().iter().any(|u| u.step_of.is_some() && covers(u.at))
            || self.numbers.iter().any(|at| covers(*at))
        {
            return false;
        }
        token.kind != TokenKind::Number || self.number_may_be_step(token.start)
    }

    /// True if a plain number may be the name of the step: in its own chart, where no item is read, and where its
    /// chart is named or the step is used without its chart.
    #[inline(never)]
    fn number_may_be_step(&self, at: usize) -> bool {
        let Definition::Step { chart: own, .. } = self.definition else { return false };
        let inside = |span: Span| span.bytes().contains(&at);
        let item = self.source.document.items.iter().find(|i| inside(i.at()));
        let (name, span) = match item {
            Some(Item::Chart(c)) => (&*c.name.text, c.at.0),
            Some(Item::Layout(l)) => (&*l.chart.text, l.at.0),
            _ => return true,
        };
        let used = |u: &g7_compile::references::Use| {
            matches!(u.written, Written::Path { first: true, .. })
                && span.bytes().contains(&u.at.bytes().start)
        };
        let line = self.source.text.get(self.line(at)).unwrap_or_default();
        name == own || line.contains(own.as_str()) || self.refs.uses_of(self.definition).any(used)
    }

    /// The line on which a byte stands.
    fn line(&self, at: usize) -> Range<usize> {
        let (before, behind) = self.source.text.split_at(at.min(self.source.text.len()));
        let start = before.rfind('\n').map_or(0, |k| k + 1);
        start..at + behind.find('\n').unwrap_or(behind.len())
    }
}
