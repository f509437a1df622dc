//! A change of the text that solves a problem, as a value.
//!
//! A problem carries its fixes ([`crate::Problem::fixes`]). `g7 check --fix`, the page and a language
//! server apply the same values; none of them knows how a problem is solved.

use crate::{FileId, Said, Span};

/// New text in the place of a span; an empty span is a place where text is put in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextEdit {
    /// The text that goes away.
    pub at: Span,
    /// The text that comes in its place; may be empty.
    pub text: String,
}

/// One way to solve a problem: all its edits belong together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// Its effect, as an order: ``write `step` ``. Lower case, no full stop, names in back-ticks.
    pub label: Said,
    /// The edits; they do not overlap, and none is in another file than the problem.
    pub edits: Vec<TextEdit>,
    /// True if the author can have meant nothing else, or if the meaning stays the same: then a tool may
    /// apply it unasked. A fix that only is likely waits for somebody who chooses it.
    pub sure: bool,
}

impl Fix {
    /// A fix that needs somebody to choose it, with one edit.
    pub fn likely(label: Said, at: Span, text: impl Into<String>) -> Fix {
        Fix { label, edits: vec![TextEdit { at, text: text.into() }], sure: false }
    }

    /// A fix that may be applied unasked, with one edit.
    pub fn sure(label: Said, at: Span, text: impl Into<String>) -> Fix {
        Fix { sure: true, ..Fix::likely(label, at, text) }
    }

    /// Adds another edit.
    #[must_use]
    pub fn and(mut self, at: Span, text: impl Into<String>) -> Fix {
        self.edits.push(TextEdit { at, text: text.into() });
        self
    }

    /// Applies fixes of one file to its text: the new text, and which of them were applied, in their order.
    ///
    /// A fix is left out as a whole if one of its edits touches an edit before it, or lies outside of the
    /// text or within a character. The same edit of two fixes is made once.
    pub fn apply(text: &str, file: FileId, fixes: &[&Fix]) -> (String, Vec<bool>) {
        let mut taken: Vec<&TextEdit> = Vec::new();
        let mut applied = Vec::with_capacity(fixes.len());
        for fix in fixes {
            let fits = |edit: &&TextEdit| {
                let (start, end) = (edit.at.start as usize, edit.at.end as usize);
                let free = |other: &&TextEdit| {
                    *other == *edit || edit.at.end < other.at.start || other.at.end < edit.at.start
                };
                edit.at.file == file && text.get(start..end).is_some() && taken.iter().all(free)
            };
            let whole = !fix.edits.is_empty() && fix.edits.iter().filter(fits).count() == fix.edits.len();
            if whole {
                taken.extend(fix.edits.iter());
            }
            applied.push(whole);
        }
        taken.sort_by_key(|edit| (edit.at.start, edit.at.end));
        taken.dedup();
        let (mut out, mut done) = (String::with_capacity(text.len()), 0);
        for edit in taken {
            out.push_str(text.get(done..edit.at.start as usize).unwrap_or(""));
            out.push_str(&edit.text);
            done = edit.at.end as usize;
        }
        out.push_str(text.get(done..).unwrap_or(""));
        (out, applied)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::say;

    const FILE: FileId = FileId(3);

    fn span(start: u32, end: u32) -> Span {
        Span { file: FILE, start, end }
    }

    #[test]
    fn fixes_are_applied_whole_or_left_out() {
        let one = Fix::sure(say!("write `b`"), span(0, 1), "b").and(span(4, 5), "c");
        let clash = Fix::sure(say!("write `x`"), span(2, 3), "x").and(span(4, 5), "y");
        let same = Fix::sure(say!("write `b`"), span(0, 1), "b");
        let beside = Fix::likely(say!("delete it"), span(6, 7), "");
        let (text, applied) = Fix::apply("a-e-i-o", FILE, &[&one, &clash, &same, &beside]);
        assert_eq!((text.as_str(), applied), ("b-e-c-", vec![true, false, true, true]));
    }

    #[test]
    fn what_does_not_fit_the_text_changes_nothing() {
        let within = Fix::sure(Said::default(), span(1, 2), "x");
        let behind = Fix::sure(Said::default(), span(2, 9), "x");
        let other = Fix::sure(Said::default(), Span { file: FileId(0), start: 0, end: 2 }, "x");
        let none = Fix { label: Said::default(), edits: Vec::new(), sure: true };
        let (text, applied) = Fix::apply("é", FILE, &[&within, &behind, &other, &none]);
        assert_eq!((text.as_str(), applied), ("é", vec![false; 4]));
    }

    #[test]
    fn text_is_put_in_at_the_ends() {
        let (first, last) =
            (Fix::sure(Said::default(), span(0, 0), "<"), Fix::sure(Said::default(), span(2, 2), ">"));
        assert_eq!(Fix::apply("ab", FILE, &[&last, &first]).0, "<ab>");
    }
}
