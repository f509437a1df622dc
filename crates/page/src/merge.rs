//! Merges two changes of one text, line by line.
//!
//! A merged text contains exactly the changes of both sides. If this is not certain, there is no
//! merged text; a text with conflict marks is never made.

use g7_model::{FileId, Said, Severity, say};
use serde::Serialize;

/// The result of a merge.
#[derive(Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Merged {
    /// The text with both changes; absent if they contradict each other.
    text: Option<String>,
    /// The number of places at which they do.
    conflicts: usize,
}

/// Greatest number of differing lines of two texts; the time of a merge grows with its square.
const MOST_LINES: usize = 6_000;

/// Greatest length of a text, in bytes.
const MOST_BYTES: usize = 4 << 20;

/// Merges the changes that lead from `base` to `mine` and from `base` to `theirs`.
pub(crate) fn merge(base: &str, mine: &str, theirs: &str) -> Result<Merged, Said> {
    if [base, mine, theirs].iter().any(|t| t.len() > MOST_BYTES) {
        return Err(say!("these texts are too long to be merged"));
    }
    if mine == theirs || theirs == base {
        return Ok(Merged { text: Some(mine.to_owned()), conflicts: 0 });
    }
    if mine == base {
        return Ok(Merged { text: Some(theirs.to_owned()), conflicts: 0 });
    }
    if [mine, theirs].iter().any(|t| differing(base, t) > MOST_LINES) {
        return Err(say!("these texts differ too much to be merged"));
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

/// The number of lines between the common beginning and the common end of two texts.
fn differing(a: &str, b: &str) -> usize {
    let (a, b): (Vec<&str>, Vec<&str>) = (a.lines().collect(), b.lines().collect());
    let head = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
    let most = a.len().min(b.len()) - head;
    let tail = a.iter().rev().zip(b.iter().rev()).take(most).take_while(|(x, y)| x == y).count();
    a.len() + b.len() - 2 * (head + tail)
}

/// True if a text has syntax errors.
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
        // `mine` moves the closing brace of the step; `theirs` adds a step after that brace.
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
