//! Two changes of one text brought together, line by line.
//!
//! What must hold: a merged text has what both sides changed and nothing else;
//! where that cannot be said for sure there is no text, never one with marks in it.

use g7_model::{FileId, Severity};
use serde::Serialize;

/// What came of it.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Merged {
    /// The text with both changes; none where they contradict each other.
    text: Option<String>,
    /// Places at which they do.
    conflicts: usize,
}

/// Most lines that differ between two texts; finding what is common takes their square.
const MOST_LINES: usize = 6_000;

/// Longest text, in bytes.
const MOST_BYTES: usize = 4 << 20;

/// `base` with what `mine` and `theirs` each changed of it.
pub(crate) fn merge(base: &str, mine: &str, theirs: &str) -> Result<Merged, String> {
    if [base, mine, theirs].iter().any(|t| t.len() > MOST_BYTES) {
        return Err("these texts are too long to be merged".to_owned());
    }
    if mine == theirs || theirs == base {
        return Ok(Merged { text: Some(mine.to_owned()), conflicts: 0 });
    }
    if mine == base {
        return Ok(Merged { text: Some(theirs.to_owned()), conflicts: 0 });
    }
    if [mine, theirs].iter().any(|t| differing(base, t) > MOST_LINES) {
        return Err("these texts differ too much to be merged".to_owned());
    }
    match diffy::merge(base, mine, theirs) {
        Ok(text) if broken(&text) && !broken(mine) && !broken(theirs) => {
            Ok(Merged { text: None, conflicts: 1 })
        }
        Ok(text) => Ok(Merged { text: Some(text), conflicts: 0 }),
        Err(marked) => {
            let marks = marked.lines().filter(|l| l.starts_with("<<<<<<<")).count();
            Ok(Merged { text: None, conflicts: marks.max(1) })
        }
    }
}

/// Lines between the common beginning and the common end, of both.
fn differing(a: &str, b: &str) -> usize {
    let (a, b): (Vec<&str>, Vec<&str>) = (a.lines().collect(), b.lines().collect());
    let head = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
    let most = a.len().min(b.len()) - head;
    let tail = a.iter().rev().zip(b.iter().rev()).take(most).take_while(|(x, y)| x == y).count();
    a.len() + b.len() - 2 * (head + tail)
}

/// Whether a text has syntax errors.
fn broken(text: &str) -> bool {
    g7_syntax::parse(text, FileId(0)).1.iter().any(|p| p.severity() == Severity::Error)
}

#[cfg(test)]
mod tests {
    use super::{MOST_LINES, Merged, merge};

    const BASE: &str = "input a : BOOL\ninput b : BOOL\n\nchart G {\n  initial step 1\n  step 2\n  1 -> 2 when a\n  2 -> 1 when b\n}\n";

    fn merged(mine: &str, theirs: &str) -> Merged {
        merge(BASE, mine, theirs).expect("small")
    }

    #[test]
    fn changes_at_different_places_come_together() {
        let mine = BASE.replace("  step 2\n", "  step 2 \"mine\"\n");
        let theirs = BASE.replace("2 -> 1 when b", "2 -> 1 when not b");
        let both = mine.replace("2 -> 1 when b", "2 -> 1 when not b");
        assert_eq!(merged(&mine, &theirs), Merged { text: Some(both), conflicts: 0 });
    }

    #[test]
    fn one_side_alone_is_taken_whole() {
        let other = BASE.replace("initial ", "");
        assert_eq!(merged(BASE, &other).text, Some(other.clone()));
        assert_eq!(merged(&other, BASE).text, Some(other.clone()));
        assert_eq!(merged(&other, &other).text, Some(other));
    }

    #[test]
    fn two_changes_of_one_line_are_told_and_never_marked() {
        let mine = BASE.replace("1 -> 2 when a", "1 -> 2 when not a");
        let theirs = BASE.replace("1 -> 2 when a", "1 -> 2 when a and b");
        assert_eq!(merged(&mine, &theirs), Merged { text: None, conflicts: 1 });
    }

    #[test]
    fn what_reads_on_both_sides_and_not_together_is_a_conflict() {
        let base = "chart G {\n  initial step 1 {\n  }\n  // a\n  // b\n  // c\n}\n";
        // Mine closes the chart with the brace of the step; theirs puts a step behind that brace.
        let mine = "chart G {\n  initial step 1\n  }\n  // a\n  // b\n  // c\n";
        let theirs = "chart G {\n  initial step 1 {\n  }\n  // a\n  step 2 {\n  }\n  // b\n  // c\n}\n";
        assert_eq!(merge(base, mine, theirs).expect("small").text, None);
    }

    #[test]
    fn texts_without_anything_in_common_are_refused_at_once() {
        let long = |c: char| (0..MOST_LINES).map(|n| format!("{c}{n}\n")).collect::<String>();
        assert!(merge(&long('a'), &long('b'), &long('c')).is_err());
    }
}
