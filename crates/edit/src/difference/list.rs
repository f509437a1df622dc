//! Writes lists: which elements stayed, which were removed, which were added.
//!
//! Elements on one line form an island. If only fields change, an island is changed in place; if an
//! element of it is removed or a new one is added inside, the island is written anew, one element
//! on a line.

use std::collections::HashMap;

use g7_model::Span;

use super::lines::Sheet;
use crate::draft::FRESH;
use crate::splice::spliced;

/// How one kind of element is written.
pub(crate) trait Style<T> {
    /// The place of an element in the text.
    fn at(&self, thing: &T) -> Span;
    /// Changes the fields of an element in place.
    fn edit(&self, sheet: &mut Sheet<'_>, old: &T, new: &T);
    /// Text that must precede an element because the element before it no longer implies it.
    fn lead(&self, _old: &T, _new: &T) -> Option<String> {
        None
    }
    /// The text of a new element with its indentation, without the last line end.
    fn fresh(&self, sheet: &Sheet<'_>, new: &T, indent: &str) -> String;
    /// True if a blank line separates the two elements when both are written anew.
    fn apart(&self, a: &T, b: &T) -> bool;
    /// True if the element continues the one before it and is indented further.
    fn inner(&self, _thing: &T) -> bool {
        false
    }
}

/// The text that encloses the list.
pub(crate) struct Block<'a> {
    /// The byte after the `{`; none for a file.
    pub(crate) open: Option<usize>,
    /// The byte of the `}`, or the end of the file.
    pub(crate) close: usize,
    /// The indentation of the elements, used if no element shows it.
    pub(crate) indent: String,
    /// The indentation of the `}`.
    pub(crate) outer: &'a str,
}

/// Changes a list.
#[inline(never)]
pub(crate) fn list<T>(sheet: &mut Sheet<'_>, old: &[T], new: &[T], block: &Block<'_>, style: &impl Style<T>) {
    let mut work = Work::new(sheet, old, new, block, style);
    work.at_start();
    let mut a = 0;
    while a < old.len() {
        let mut b = a;
        while b + 1 < old.len() && !work.between(b).contains('\n') {
            b += 1;
        }
        work.island(a, b);
        a = b + 1;
    }
}

struct Work<'w, 's, 't, T, S> {
    sheet: &'w mut Sheet<'s>,
    old: &'t [T],
    block: &'w Block<'w>,
    style: &'w S,
    indent: String,
    /// For each old element its new version; none if it was removed.
    kept: Vec<Option<&'t T>>,
    /// The elements added before the first old element, and after each of them.
    came: Vec<Vec<&'t T>>,
}

impl<'w, 's, 't, T, S: Style<T>> Work<'w, 's, 't, T, S> {
    #[inline(never)]
    fn new(sheet: &'w mut Sheet<'s>, old: &'t [T], new: &'t [T], block: &'w Block<'w>, style: &'w S) -> Self {
        let places: HashMap<u32, usize> =
            old.iter().enumerate().map(|(k, t)| (style.at(t).start, k)).collect();
        let mut kept = vec![None; old.len()];
        let mut came = vec![Vec::new(); old.len() + 1];
        let mut next = 0;
        for thing in new {
            let at = style.at(thing);
            let place = places.get(&at.start).copied().filter(|k| at.file != FRESH && *k >= next);
            if let (Some(k), Some(slot)) = (place, place.and_then(|k| kept.get_mut(k))) {
                *slot = Some(thing);
                next = k + 1;
            } else if let Some(slot) = came.get_mut(next) {
                slot.push(thing);
            }
        }
        let first = old.iter().map(|t| (t, style.at(t).start as usize));
        let told = first.filter(|(t, at)| sheet.begins_line(*at) && !style.inner(t)).map(|(_, at)| at).next();
        let indent = told.map_or(block.indent.clone(), |at| sheet.indent(at).to_owned());
        Work { sheet, old, block, style, indent, kept, came }
    }

    fn span(&self, k: usize) -> (usize, usize) {
        let at = self.old.get(k).map(|t| self.style.at(t)).unwrap_or_default();
        (at.start as usize, at.end as usize)
    }

    /// The text between an old element and the next.
    fn between(&self, k: usize) -> &'s str {
        self.sheet.slice(self.span(k).1, self.span(k + 1).0)
    }

    fn new_after(&self, k: usize) -> &[&'t T] {
        self.came.get(k + 1).map_or(&[], Vec::as_slice)
    }

    fn kept(&self, k: usize) -> Option<(&'t T, &'t T)> {
        Some((self.old.get(k)?, self.kept.get(k).copied().flatten()?))
    }

    /// Lines for new elements, written after another element.
    #[inline(never)]
    fn lines(&self, things: &[&'t T], after: Option<&'t T>) -> String {
        let mut out = String::new();
        let mut before = after;
        for (k, thing) in things.iter().enumerate() {
            if k > 0 {
                out.push_str(self.sheet.newline);
            }
            if before.is_some_and(|b| self.style.apart(b, thing)) {
                out.push_str(self.sheet.newline);
            }
            out.push_str(&self.style.fresh(self.sheet, thing, &self.indent));
            before = Some(thing);
        }
        out
    }

    #[inline(never)]
    fn at_start(&mut self) {
        let things = self.came.first().cloned().unwrap_or_default();
        let Some(last) = things.last() else { return };
        let mut lines = self.lines(&things, None);
        let nl = self.sheet.newline;
        let (first, outer) = (self.span(0).0, self.block.outer);
        let follows = self.old.first().is_some_and(|f| self.style.apart(last, f));
        if follows {
            lines.push_str(nl);
        }
        match (self.block.open, self.old.is_empty()) {
            (Some(open), false) if self.sheet.begins_line(first) => {
                let indent = self.indent.clone();
                self.sheet.insert_below(open, &lines, &indent);
            }
            (Some(open), false) => self.sheet.put(open, open, format!("{nl}{lines}{nl}{}", self.indent)),
            (None, false) => self.sheet.insert_above(first, &lines),
            (Some(open), true) => self.fill_empty(open, &lines, outer),
            (None, true) => {
                let end = self.sheet.text.len();
                let before = match self.sheet.text {
                    "" => String::new(),
                    t if t.ends_with('\n') => nl.to_owned(),
                    _ => format!("{nl}{nl}"),
                };
                self.sheet.put(end, end, format!("{before}{lines}{nl}"));
            }
        }
    }

    /// Writes into braces that contain nothing or only notes.
    #[inline(never)]
    fn fill_empty(&mut self, open: usize, lines: &str, outer: &str) {
        let (close, nl) = (self.block.close, self.sheet.newline);
        let inside = self.sheet.slice(open, close);
        if inside.trim().is_empty() {
            self.sheet.put(open, close, format!("{nl}{lines}{nl}{outer}"));
        } else if self.sheet.begins_line(close) {
            let at = self.sheet.line_start(close);
            self.sheet.put(at, at, format!("{lines}{nl}"));
        } else {
            self.sheet.put(close, close, format!("{nl}{lines}{nl}{outer}"));
        }
    }

    /// Changes the elements `a..=b`, which share a line.
    #[inline(never)]
    fn island(&mut self, a: usize, b: usize) {
        if (a..=b).all(|k| self.kept(k).is_none()) {
            return self.sheet.remove(self.span(a).0, self.span(b).1);
        }
        let led = |w: &Self, k| w.kept(k).is_some_and(|(o, n)| w.style.lead(o, n).is_some());
        let torn = (a..=b).any(|k| {
            self.kept(k).is_none() || k < b && !self.new_after(k).is_empty() || k > a && led(self, k)
        });
        if torn {
            return self.laid_anew(a, b);
        }
        for k in a..=b {
            let Some((old, new)) = self.kept(k) else { continue };
            if let Some(lead) = self.style.lead(old, new) {
                let start = self.span(k).0;
                if self.sheet.begins_line(start) {
                    let from = self.sheet.line_start(start);
                    self.sheet.put(from, start, format!("{}{lead}", self.indent));
                } else {
                    self.sheet.put(start, start, lead);
                }
            }
            self.style.edit(self.sheet, old, new);
        }
        self.below(b);
    }

    /// Writes the elements added after the last element of an island.
    #[inline(never)]
    fn below(&mut self, b: usize) {
        let things = self.new_after(b).to_vec();
        let (Some(last), Some((_, anchor))) = (things.last(), self.kept(b)) else { return };
        if let (Some(first), Some((_, next))) = (things.first(), self.kept(b + 1))
            && self.style.apart(anchor, first)
            && !self.style.apart(last, next)
        {
            // They belong to the elements that follow.
            let lines = self.lines(&things, None);
            return self.sheet.insert_above(self.span(b + 1).0, &lines);
        }
        let mut lines = self.lines(&things, Some(anchor));
        let end = self.span(b).1;
        let next = (b + 1..self.old.len()).find_map(|k| self.kept(k)).map(|(_, n)| n);
        let line = self.sheet.next_line(self.sheet.tail(end));
        // If the author wrote no blank line between the two, none is added.
        let wanted = next.is_some_and(|n| self.style.apart(last, n) && !self.style.apart(anchor, n));
        if wanted && !self.sheet.is_blank_line(line) {
            lines.push_str(self.sheet.newline);
        }
        self.sheet.insert_below(end, &lines, self.block.outer);
    }

    #[inline(never)]
    fn laid_anew(&mut self, a: usize, b: usize) {
        let nl = self.sheet.newline;
        let mut out = String::new();
        for k in a..=b {
            if let Some((old, new)) = self.kept(k) {
                let lead = self.style.lead(old, new);
                let joined = k > a && self.kept(k - 1).is_some() && self.new_after(k - 1).is_empty();
                if joined && lead.is_none() {
                    out.push_str(self.between(k - 1));
                } else if !out.is_empty() {
                    out.push_str(nl);
                    out.push_str(&self.indent);
                }
                out.push_str(&lead.unwrap_or_default());
                out.push_str(&self.changed(old, new));
            }
            let things = self.new_after(k).to_vec();
            if !things.is_empty() {
                out.push_str(nl);
                out.push_str(&self.lines(&things, self.kept(k).map(|(_, n)| n)));
            }
            if k < b && self.sheet.has_notes(self.span(k).1, self.span(k + 1).0) && self.kept(k).is_some() {
                self.keep_notes(k, &mut out);
            }
        }
        let (start, end) = (self.span(a).0, self.span(b).1);
        if !self.new_after(b).is_empty() && !self.sheet.ends_line(self.sheet.tail(end)) {
            out.push_str(nl);
            out.push_str(self.block.outer);
        }
        self.sheet.put(start, end, out);
    }

    /// Keeps the notes between two elements that are no longer joined.
    fn keep_notes(&self, k: usize, out: &mut String) {
        let joined = self.new_after(k).is_empty()
            && self.kept(k + 1).is_some_and(|(o, n)| self.style.lead(o, n).is_none());
        if !joined {
            out.push(' ');
            out.push_str(self.between(k).trim_matches([' ', '\t', ';']));
        }
    }

    /// The text of an element with its fields changed.
    fn changed(&self, old: &T, new: &T) -> String {
        changed(self.sheet, self.style, old, new)
    }
}

/// The text of an element with its fields changed.
#[inline(never)]
pub(crate) fn changed<T>(sheet: &Sheet<'_>, style: &impl Style<T>, old: &T, new: &T) -> String {
    let mut sub = sheet.blank();
    style.edit(&mut sub, old, new);
    let at = style.at(old);
    let start = at.start as usize;
    sub.splices.sort_by_key(|s| (s.start, s.end));
    for s in &mut sub.splices {
        s.start = s.start.saturating_sub(start);
        s.end = s.end.saturating_sub(start);
    }
    let text = sheet.of(at);
    spliced(text, &sub.splices).unwrap_or_else(|| text.to_owned())
}
