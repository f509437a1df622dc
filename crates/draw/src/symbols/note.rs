//! Comments of the layout section: a text in quotes (IEC 60848, comment) that belongs to no symbol
//! and stands where its author put it.

use crate::Rect;
use crate::ink::{Picture, stack};
use crate::symbols::parts::SMALL;
use crate::text::{Line, wrap_words};

/// Greatest width of a line.
const WIDEST: i32 = 2400;
/// Most lines of one comment.
const LINES: usize = 40;

/// Draws a comment; the anchor is the upper left corner of its text. Line ends are kept, long lines
/// are broken.
pub(crate) fn note(text: &str) -> Picture {
    let mut picture = Picture::default();
    let quoted = format!("“{text}”");
    let mut lines = Vec::new();
    let mut whole = true;
    for paragraph in quoted.lines() {
        let (mut set, all) = wrap_words(paragraph, SMALL, WIDEST, LINES);
        whole &= all;
        if set.is_empty() {
            // An empty line separates two paragraphs.
            set.push(String::new());
        }
        lines.extend(set.into_iter().map(Line::plain));
    }
    if lines.len() > LINES {
        lines.truncate(LINES);
        lines.push(Line::plain("…”".to_owned()));
        whole = false;
    }
    let (up, _) = stack(&lines, SMALL);
    picture.lines("g7-note", (0, up), SMALL, &lines);
    if !whole {
        picture.title = Some(text.to_owned());
    }
    picture
}

/// The box of a comment, relative to its place.
pub(crate) fn note_area(text: &str) -> Rect {
    note(text).area().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::{LINES, WIDEST, note, note_area};

    #[test]
    fn a_comment_begins_at_its_place_and_is_quoted() {
        let picture = note("two words");
        let area = note_area("two words");
        assert_eq!((area.x, area.y), (0, 0), "the upper left corner is its place");
        assert!(picture.svg().contains(">“two words”<"), "{}", picture.svg());
    }

    #[test]
    fn long_lines_are_broken_and_line_ends_kept() {
        let one = note_area("word").h;
        let (two, three) = (note_area("a\nb").h, note_area("a\n\nb").h);
        assert!(two > one && three - two == two - one, "an empty line counts: {one} {two} {three}");
        let long = note_area(&"word ".repeat(60));
        assert!(long.w <= WIDEST && long.h > 3 * one, "{long:?}");
    }

    #[test]
    fn what_is_cut_is_told_in_full_by_the_title() {
        let text = "word\n".repeat(LINES * 3);
        let picture = note(&text);
        assert_eq!(picture.title.as_deref(), Some(text.as_str()));
        assert_eq!(note("word").title, None);
    }
}
