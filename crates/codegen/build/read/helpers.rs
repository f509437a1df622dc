//! Helpers of printed code as they stand in their files: Rust in `src/`, C in `c/`.
//!
//! A file is cut at its first column, as `rustfmt` and the house's C have it.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::Result;

/// A function, or a structure with its methods.
#[derive(Clone, Debug)]
pub(crate) struct Helper {
    pub(crate) name: String,
    /// True if the chart's code may call it.
    pub(crate) offered: bool,
    /// As it is printed.
    pub(super) text: String,
    /// True if C has it from `<math.h>`.
    pub(super) math: bool,
    /// All that it needs, in the order of the files.
    needs: Vec<usize>,
}

impl Helper {
    pub(super) fn new(name: &str, offered: bool, text: String) -> Helper {
        Helper { name: name.to_owned(), offered, text, math: false, needs: Vec::new() }
    }
}

/// Helpers that only Rust has: C turns no real into a text or back without a library, and its
/// printer writes the complement as an operator.
const ONLY_RUST: [&str; 5] = ["inv", "text_to_f32", "text_to_f64", "text_from_f32", "text_from_f64"];

/// True if a name stands in a text as a word before `(` or `::`, and not as a method.
fn uses(text: &str, name: &str) -> bool {
    text.match_indices(name).any(|(at, _)| {
        let (before, behind) = (&text[..at], &text[at + name.len()..]);
        let longer = before.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        // `..f(x)` is the end of a range.
        let method = before.ends_with('.') && !before.ends_with("..");
        !longer && !method && (behind.starts_with('(') || behind.starts_with("::"))
    })
}

/// Puts a word in for another, where it stands as a word of its own.
pub(super) fn put_in(text: &str, word: &str, other: &str) -> String {
    let letter = |c: char| c.is_alphanumeric() || c == '_';
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(word) {
        let (before, behind) = (&rest[..at], &rest[at + word.len()..]);
        out += before;
        let part = out.ends_with(letter) || behind.starts_with(letter);
        out += if part { word } else { other };
        rest = behind;
    }
    out + rest
}

/// The pieces of a file that begin at the first column, comments and attributes with
/// what stands behind them.
pub(super) fn pieces(text: &str) -> Vec<String> {
    let (mut all, mut piece) = (Vec::new(), String::new());
    let mut open = false;
    for line in text.lines() {
        let comment = line.starts_with("//") || line.starts_with("/*") || line.starts_with(" *");
        let blank = line.trim().is_empty();
        if line.starts_with("//!") {
            continue;
        }
        if blank && !open {
            piece.clear(); // the header of the file
            continue;
        }
        piece += line;
        piece.push('\n');
        open |= !comment && !line.starts_with('#');
        let first = line.starts_with(|c: char| !c.is_whitespace());
        let ends = line == "}" || line == "};" || (line.ends_with([';', '}']) && !line.starts_with('}'));
        if first && !comment && (ends || line.starts_with("#define") || line.starts_with("#include")) {
            all.push(std::mem::take(&mut piece));
            open = false;
        } else if line.starts_with("#") && !line.starts_with("#[") {
            piece.clear();
        }
    }
    if !piece.is_empty() {
        all.push(piece);
    }
    all
}

/// Finds what each needs, in the order of the files.
pub(super) fn link(all: &mut [Helper]) {
    let direct: Vec<Vec<usize>> = all
        .iter()
        .map(|h| (0..all.len()).filter(|i| all[*i].name != h.name && uses(&h.text, &all[*i].name)).collect())
        .collect();
    for (i, h) in all.iter_mut().enumerate() {
        let mut found: BTreeSet<usize> = BTreeSet::new();
        let mut waiting = direct[i].clone();
        while let Some(k) = waiting.pop() {
            if found.insert(k) {
                waiting.extend(&direct[k]);
            }
        }
        h.needs = found.into_iter().collect();
    }
}

/// Checks that a chart may call the same helpers in both languages.
pub(crate) fn hold_the_same(rust: &[Helper], c: &[Helper]) -> Result<()> {
    let needed = |h: &&Helper| h.offered && !ONLY_RUST.contains(&h.name.as_str());
    let missing: Vec<&str> = rust
        .iter()
        .filter(needed)
        .map(|h| h.name.as_str())
        .filter(|n| !c.iter().any(|h| h.name == *n))
        .collect();
    if missing.is_empty() { Ok(()) } else { Err(format!("crates/runtime/c: not there: {missing:?}")) }
}

/// The helpers as a constant.
pub(crate) fn text(name: &str, all: &[Helper]) -> String {
    let mut out = format!("/// The helpers of printed code.\npub(crate) static {name}: &[Helper] = &[\n");
    for h in all {
        let Helper { name, text, math, needs, .. } = h;
        let text = text.trim();
        let _ = writeln!(
            out,
            "    Helper {{ name: {name:?}, text: {text:?}, math: {math}, needs: &{needs:?} }},"
        );
    }
    out + "];\n"
}
