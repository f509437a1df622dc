//! The lines of a text: where they begin and end, and what they contain.

use g7_model::{Note, Span};
use g7_syntax::{Token, TokenKind, show_comment, tokens};

use crate::splice::Splice;

/// A text and the changes collected so far.
pub(crate) struct Sheet<'a> {
    pub(crate) text: &'a str,
    pub(crate) notes: &'a [Note],
    /// The line end of the text: `\n` or `\r\n`.
    pub(crate) newline: &'static str,
    pub(crate) splices: Vec<Splice>,
}

impl<'a> Sheet<'a> {
    pub(crate) fn new(text: &'a str, notes: &'a [Note]) -> Sheet<'a> {
        let newline = if text.contains("\r\n") { "\r\n" } else { "\n" };
        Sheet { text, notes, newline, splices: Vec::new() }
    }

    /// The same text without changes.
    pub(crate) fn blank(&self) -> Sheet<'a> {
        Sheet { text: self.text, notes: self.notes, newline: self.newline, splices: Vec::new() }
    }

    pub(crate) fn put(&mut self, start: usize, end: usize, insert: impl Into<String>) {
        self.splices.push(Splice::new(start, end.max(start), insert));
    }

    pub(crate) fn slice(&self, start: usize, end: usize) -> &'a str {
        self.text.get(start..end).unwrap_or_default()
    }

    pub(crate) fn of(&self, at: Span) -> &'a str {
        self.slice(at.start as usize, at.end as usize)
    }

    /// The first byte of the line.
    pub(crate) fn line_start(&self, at: usize) -> usize {
        self.slice(0, at).rfind('\n').map_or(0, |n| n + 1)
    }

    /// The end of the line, before its line end.
    pub(crate) fn line_end(&self, at: usize) -> usize {
        let rest = self.text.get(at..).unwrap_or_default();
        let end = at + rest.find('\n').unwrap_or(rest.len());
        if self.slice(at, end).ends_with('\r') { end - 1 } else { end }
    }

    /// The first byte of the next line, or the end of the text.
    pub(crate) fn next_line(&self, at: usize) -> usize {
        let rest = self.text.get(at..).unwrap_or_default();
        at + rest.find('\n').map_or(rest.len(), |n| n + 1)
    }

    /// The indentation of the line.
    pub(crate) fn indent(&self, at: usize) -> &'a str {
        let line = self.slice(self.line_start(at), self.line_end(at));
        line.split_at(line.len() - line.trim_start().len()).0
    }

    /// True if only blanks precede the byte on its line.
    pub(crate) fn begins_line(&self, at: usize) -> bool {
        self.slice(self.line_start(at), at).trim().is_empty()
    }

    /// The end of the notes and semicolons that follow on the same line; other text may follow
    /// them.
    #[inline(never)]
    pub(crate) fn tail(&self, at: usize) -> usize {
        let mut at = at;
        let first = self.notes.partition_point(|n| (n.at.start as usize) < at);
        let mut notes = self.notes.get(first..).unwrap_or_default().iter().peekable();
        loop {
            let rest = self.slice(at, self.line_end(at));
            let close = at + (rest.len() - rest.trim_start().len());
            if self.text.get(close..).is_some_and(|t| t.starts_with(';')) {
                at = close + 1;
                continue;
            }
            match notes.next_if(|n| n.at.start as usize <= close) {
                Some(note) if note.at.start as usize == close => at = note.at.end as usize,
                Some(_) => {}
                None => return at,
            }
        }
    }

    /// True if only blanks follow on the line.
    pub(crate) fn ends_line(&self, at: usize) -> bool {
        self.slice(at, self.line_end(at)).trim().is_empty()
    }

    /// True if there is a line at this byte and it is blank.
    pub(crate) fn is_blank_line(&self, start: usize) -> bool {
        start < self.text.len() && self.slice(start, self.line_end(start)).trim().is_empty()
    }

    /// True if a note begins in these bytes.
    pub(crate) fn has_notes(&self, start: usize, end: usize) -> bool {
        let first = self.notes.partition_point(|n| (n.at.start as usize) < start);
        self.notes.get(first).is_some_and(|n| (n.at.start as usize) < end)
    }

    /// The tokens of a part of the text, without notes.
    pub(crate) fn tokens(&self, start: usize, end: usize) -> Vec<Token> {
        tokens(self.slice(start, end))
            .filter(|t| t.kind != TokenKind::Note)
            .map(|t| Token { start: t.start + start, end: t.end + start, ..t })
            .collect()
    }

    /// The tokens before the first `{`, and that `{`.
    #[inline(never)]
    pub(crate) fn header(&self, start: usize, end: usize) -> (Vec<Token>, Option<Token>) {
        let mut head = Vec::new();
        for t in tokens(self.slice(start, end)) {
            let t = Token { start: t.start + start, end: t.end + start, ..t };
            match t.kind {
                TokenKind::Note => {}
                TokenKind::LBrace => return (head, Some(t)),
                _ => head.push(t),
            }
        }
        (head, None)
    }

    pub(crate) fn word(&self, token: &Token) -> &'a str {
        self.slice(token.start, token.end)
    }

    /// Removes a part, with its lines if nothing else stands on them.
    #[inline(never)]
    pub(crate) fn remove(&mut self, start: usize, end: usize) {
        let tail = self.tail(end);
        if !self.begins_line(start) || !self.ends_line(tail) {
            return self.remove_part(start, end);
        }
        let from = self.line_start(start);
        let mut to = self.next_line(tail);
        let above = from > 0 && self.is_blank_line(self.line_start(from - 1));
        if (above || from == 0) && self.is_blank_line(to) {
            to = self.next_line(to);
        }
        let closing =
            to >= self.text.len() || self.slice(to, self.line_end(to)).trim_start().starts_with('}');
        let gap = if above && closing { self.line_start(from - 1) } else { from };
        let from = if self.splices.last().is_none_or(|s| s.end <= gap) { gap } else { from };
        let last = to >= self.text.len() && !self.text.ends_with('\n');
        // The last line has no line end, so the end of the line before is removed.
        let from = if last && from > 0 { self.line_end(self.line_start(from - 1)) } else { from };
        self.put(from, to, "");
    }

    /// Removes a part of a line and the blanks before it or, at the beginning of a line, those
    /// after it.
    pub(crate) fn remove_part(&mut self, start: usize, end: usize) {
        let before = self.slice(self.line_start(start), start);
        if before.trim().is_empty() {
            let rest = self.slice(end, self.line_end(end));
            return self.put(start, end + rest.len() - rest.trim_start().len(), "");
        }
        self.put(start - (before.len() - before.trim_end().len()), end, "");
    }

    /// Changes, removes or adds the comment in a header; a new one is written after byte `after`.
    pub(crate) fn put_comment(&mut self, head: &[Token], after: usize, text: Option<&str>) {
        let there = head.iter().find(|t| t.kind == TokenKind::Comment);
        match (there, text) {
            (Some(t), Some(text)) => self.put(t.start, t.end, show_comment(text)),
            (Some(t), None) => self.remove_part(t.start, t.end),
            (None, Some(text)) => self.put(after, after, format!(" {}", show_comment(text))),
            (None, None) => {}
        }
    }

    /// Inserts lines (each with its indentation) after a part that ends at a byte. `outer` is the
    /// indentation of what follows on the same line.
    pub(crate) fn insert_below(&mut self, end: usize, lines: &str, outer: &str) {
        let at = self.tail(end);
        if self.ends_line(at) {
            let at = self.line_end(at);
            return self.put(at, at, format!("{}{lines}", self.newline));
        }
        let rest = self.slice(at, self.line_end(at));
        let blanks = rest.len() - rest.trim_start().len();
        self.put(at, at + blanks, format!("{nl}{lines}{nl}{outer}", nl = self.newline));
    }

    /// Inserts lines above the line on which a part begins, or directly before the part.
    pub(crate) fn insert_above(&mut self, start: usize, lines: &str) {
        let at = if self.begins_line(start) { self.line_start(start) } else { start };
        self.put(at, at, format!("{lines}{}", self.newline));
    }
}

/// Changes the indentation of all lines of a text; the first line has none.
#[inline(never)]
pub(crate) fn reindent(text: &str, from: &str, to: &str, newline: &str) -> String {
    let mut out = String::with_capacity(text.len() + 16);
    for (k, line) in text.lines().enumerate() {
        if k > 0 {
            out.push_str(newline);
        }
        let line = if k == 0 { line } else { line.strip_prefix(from).unwrap_or(line.trim_start()) };
        if k > 0 && !line.trim().is_empty() {
            out.push_str(to);
        }
        out.push_str(line);
    }
    out
}
