//! Plain words: comments broken into lines, names fitted into a square.

use crate::text::{clean, fits, width};

/// Breaks text at blanks into at most `lines` lines; if there was more, the last line ends in `…`.
/// The flag says that nothing was left out.
pub(crate) fn wrap_words(text: &str, size: i32, most: i32, lines: usize) -> (Vec<String>, bool) {
    let mut out: Vec<String> = Vec::new();
    let mut whole = true;
    for word in clean(text).split_whitespace() {
        let (word, fits) = shortened(word, size, most);
        whole &= fits;
        match out.last_mut() {
            Some(line) if width(&format!("{line} {word}"), size) <= most => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => out.push(word),
        }
    }
    if out.len() > lines.max(1) {
        out.truncate(lines.max(1));
        whole = false;
        if let Some(last) = out.last_mut() {
            let (mut cut, _) = shortened(last, size, most - width(" …", size));
            if !cut.ends_with('…') {
                cut.push_str(" …");
            }
            *last = cut;
        }
    }
    (out, whole)
}

/// The text, or as much of it as fits, followed by `…`; the flag says that all of it fits.
pub(crate) fn shortened(text: &str, size: i32, most: i32) -> (String, bool) {
    if fits(text, size, most) {
        return (text.to_owned(), true);
    }
    let room = most - width("…", size);
    let mut cut = String::new();
    let mut taken = 0;
    for c in text.chars() {
        taken += width(c.encode_utf8(&mut [0; 4]), size);
        if taken > room {
            break;
        }
        cut.push(c);
    }
    cut.push('…');
    (cut, false)
}

/// A step's name, set for its square: lines, text size, and the room they need.
pub(crate) struct Fitted {
    pub(crate) lines: Vec<String>,
    pub(crate) size: i32,
    pub(crate) width: i32,
}

/// A name wider than this is cut.
const WIDEST_NAME: i32 = 2400;

/// Characters of a name after these are not looked at.
const LONGEST_NAME: usize = 200;

/// Fits a name into `room`: at its usual size, a little smaller, or on two lines; if none of these
/// fits, the square becomes wider.
pub(crate) fn name_lines(name: &str, room: i32) -> Fitted {
    let name = match name.char_indices().nth(LONGEST_NAME) {
        Some((at, _)) => format!("{}…", clean(name.get(..at).unwrap_or(""))),
        None => clean(name),
    };
    for size in [140, 120] {
        let w = width(&name, size);
        if w <= room {
            return Fitted { lines: vec![name], size, width: w };
        }
    }
    let two = split(&name, 110);
    let widest = |lines: &[String], size| lines.iter().map(|l| width(l, size)).max().unwrap_or(0);
    if widest(&two, 110) <= room {
        return Fitted { width: widest(&two, 110), lines: two, size: 110 };
    }
    let lines: Vec<String> = two.iter().map(|l| shortened(l, 120, WIDEST_NAME).0).collect();
    Fitted { width: widest(&lines, 120), lines, size: 120 }
}

/// True if a name ends in a number that can stand on its own line: three digits or more.
fn is_number(tail: &str) -> bool {
    tail.len() > 2 && tail.bytes().all(|b| b.is_ascii_digit())
}

/// Divides a name into two lines of nearly the same width, at a blank, at `_`, before a capital
/// that follows a small letter, or before a number that follows letters.
fn split(name: &str, size: i32) -> Vec<String> {
    let mut best: Option<(i32, usize)> = None;
    let mut before: Option<char> = None;
    for (at, c) in name.char_indices() {
        let seam = before.is_some_and(|b| {
            matches!(b, '_' | ' ' | '-' | '.')
                || (b.is_lowercase() && c.is_uppercase())
                || (b.is_alphabetic() && name.get(at..).is_some_and(is_number))
        });
        if seam {
            let (a, b) = name.split_at(at);
            let w = width(a.trim_end(), size).max(width(b.trim_start(), size));
            if best.is_none_or(|(least, _)| w < least) {
                best = Some((w, at));
            }
        }
        before = Some(c);
    }
    match best {
        Some((_, at)) => {
            let (a, b) = name.split_at(at);
            vec![a.trim_end().to_owned(), b.trim_start().to_owned()]
        }
        None => vec![name.to_owned()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comment_breaks_at_blanks_and_says_where_it_was_cut() {
        let text = "one two three four five six";
        let (lines, whole) = wrap_words(text, 120, 700, 9);
        assert!(whole && lines.len() > 1 && lines.join(" ") == text, "{lines:?}");
        let (lines, whole) = wrap_words(text, 120, 700, 2);
        assert!(!whole && lines.len() == 2 && lines[1].ends_with('…'), "{lines:?}");
        assert!(lines.iter().all(|l| width(l, 120) <= 700));
    }

    #[test]
    fn a_short_name_stays_as_it_is_and_a_long_one_breaks_at_its_seam() {
        let one = name_lines("12", 460);
        assert_eq!((one.lines, one.size), (vec!["12".to_owned()], 140));
        let two = name_lines("WaitBead", 460);
        assert_eq!((two.lines.join("|"), two.size), ("Wait|Bead".to_owned(), 110));
        let numbered = name_lines("Release5", 460);
        assert_eq!(numbered.lines, ["Release5"], "one figure is no line");
        assert_eq!(name_lines("Release500", 460).lines, ["Release", "500"]);
        let wide = name_lines("Sequencing", 460);
        assert!(wide.width > 460 && wide.lines.len() == 1, "no seam: the square gets wider");
    }

    #[test]
    fn a_name_of_a_thousand_letters_is_cut() {
        assert!(name_lines(&"a".repeat(1000), 460).width <= WIDEST_NAME);
    }
}
