//! Signs of other languages that the lexer knows, so that what they were meant for is told once.

/// The sign of a note in other languages that begins at a byte: `#` or `--`, at the beginning of a line or
/// behind a blank, and before words. A wire of a ladder stands before a bracket.
pub(crate) fn note(text: &str, at: usize) -> Option<&'static str> {
    let (before, rest) = text.split_at_checked(at)?;
    if !(before.is_empty() || before.ends_with([' ', '\t', '\n', ';'])) {
        return None;
    }
    if let Some(said) = rest.strip_prefix('#') {
        let begins = |c: char| matches!(c, ' ' | '\t' | '#') || c.is_ascii_alphabetic();
        return said.starts_with(begins).then_some("#");
    }
    let said = rest.strip_prefix("--")?;
    let words = said.trim_start_matches(['-', ' ', '\t', '\r']);
    let ends = words.is_empty() || words.starts_with('\n');
    // `--b` within a line is a sign twice.
    let apart = ends || words.len() < said.len() || line_begins(before);
    (apart && (ends || words.starts_with(char::is_alphanumeric))).then_some("--")
}

/// True if nothing but blanks stands between the beginning of a line and the end of this text.
pub(crate) fn line_begins(before: &str) -> bool {
    let before = before.trim_end_matches([' ', '\t']);
    before.is_empty() || before.ends_with('\n')
}

/// The first byte of the line of a place, if something stands before the place on that line.
pub(crate) fn line_before(text: &str, at: usize) -> Option<u32> {
    let before = text.get(..at)?;
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    (!line_begins(before)).then(|| u32::try_from(start).unwrap_or(u32::MAX))
}

/// Bytes behind a `?` in which its `:` is looked for.
const NEAR: usize = 400;

/// True if a text that begins with `?` is the rest of `a ? b : c`.
pub(crate) fn choice(rest: &str) -> bool {
    let line = rest.as_bytes().get(..NEAR.min(rest.len())).unwrap_or_default();
    let line = line.split(|b| *b == b'\n').next().unwrap_or_default();
    line.iter().enumerate().any(|(i, b)| *b == b':' && line.get(i + 1) != Some(&b'='))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_is_known_by_what_stands_round_it() {
        let signs = |text: &str| (0..text.len()).find_map(|at| note(text, at).map(|sign| (at, sign)));
        assert_eq!(signs("step 1 # one"), Some((7, "#")));
        assert_eq!(signs("V -- the valve"), Some((2, "--")));
        assert_eq!(signs("  --the valve"), Some((2, "--")));
        assert_eq!(signs("-----"), Some((0, "--")));
        for none in ["INT#5", "x := 5 --y", "--[a]--(q)", "---- [a] --- (q)", "0 -> 1", "a--"] {
            assert_eq!(signs(none), None, "{none}");
        }
    }

    #[test]
    fn a_question_is_a_choice_if_a_colon_follows() {
        assert!(choice("? b : c"));
        assert!(choice("? b:c"));
        assert!(!choice("? b := c"));
        assert!(!choice("?\n a : b"));
    }
}
