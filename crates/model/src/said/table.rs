//! The table of texts in the other languages, and how the holes of a row are filled.
//!
//! A row has three lines: the English text exactly as in `say!`, the French text behind `fr `, and the Portuguese
//! text behind `pt `. All three have the same holes; their order may differ.
//! A hole is named as in English; a hole without a name is `{}`, the next one, or `{0}`, `{1}`, its number
//! among all holes of the English text. `tests/tests/house/tidy/tongues.rs` holds the table to the sources.

use std::collections::HashMap;
use std::sync::OnceLock;

use crate::Language;

/// A text in English, French and Portuguese.
pub type Row = [&'static str; 3];

/// The parts of the table, by the crates that say the texts first. A module for browsers has none: the page
/// fetches them for readers of another language than English (`web/src/lib/said.ts`) and hands them in ([`teach`]).
#[cfg(not(target_arch = "wasm32"))]
const TABLES: &[&str] = &[
    include_str!("titles.txt"),
    include_str!("check.txt"),
    include_str!("tests.txt"),
    include_str!("why.txt"),
    include_str!("iec.txt"),
    include_str!("exchange.txt"),
    include_str!("online.txt"),
    include_str!("codegen.txt"),
    include_str!("edit.txt"),
    include_str!("g7.txt"),
];
#[cfg(target_arch = "wasm32")]
const TABLES: &[&str] = &[];

/// Rows that a program without the table was given later, by [`teach`].
static TAUGHT: OnceLock<String> = OnceLock::new();

/// Hands in rows, in the form of the parts of the table. Only the first call does anything, and only before a text
/// was told in another language than English.
pub fn teach(rows: String) {
    TAUGHT.get_or_init(|| rows);
}

/// All rows, as they stand. A row that is cut short has empty texts.
pub fn rows() -> impl Iterator<Item = Row> {
    let taught = TAUGHT.get().map(String::as_str);
    TABLES.iter().copied().chain(taught).flat_map(|table| {
        let mut lines = table.lines().filter(|l| !l.is_empty() && !l.starts_with("# "));
        std::iter::from_fn(move || {
            let english = lines.next()?;
            let mut told = |tag| lines.next().and_then(|l| l.strip_prefix(tag)).unwrap_or_default();
            Some([english, told("fr "), told("pt ")])
        })
    })
}

/// The text of a template in a language, if there is a row.
pub(super) fn in_language(template: &str, language: Language) -> Option<&'static str> {
    static INDEX: OnceLock<HashMap<&'static str, Row>> = OnceLock::new();
    let index = INDEX.get_or_init(|| rows().map(|row| (row[0], row)).collect());
    let told = language.told(*index.get(template)?);
    (!told.is_empty()).then_some(told)
}

/// The names in the holes of a text, in their order. `{a:?}` has the name `a`, `{}` has none.
fn holes(text: &str) -> Vec<&str> {
    let mut names = Vec::new();
    pieces(text, &mut |piece| {
        if let Piece::Hole(name) = piece {
            names.push(name);
        }
    });
    names
}

/// A text with its holes filled. `row` has the holes of `template`, which number the parts.
pub(super) fn fill(template: &str, row: &str, part: &dyn Fn(usize) -> Option<String>) -> String {
    let names = holes(template);
    let mut unnamed = names.iter().enumerate().filter(|(_, name)| name.is_empty()).map(|(k, _)| k);
    let mut text = String::with_capacity(row.len() + 16);
    pieces(row, &mut |piece| match piece {
        Piece::Text(plain) => text.push_str(plain),
        Piece::Hole(name) => {
            // A name may stand twice in a text: each time it is the same part.
            let rank = if name.is_empty() {
                unnamed.next()
            } else if let Ok(rank) = name.parse() {
                Some(rank)
            } else {
                names.iter().position(|n| *n == name)
            };
            if let Some(part) = rank.and_then(part) {
                text.push_str(&part);
            }
        }
    });
    text
}

enum Piece<'a> {
    Text(&'a str),
    Hole(&'a str),
}

/// Goes over the pieces of a text: `{{` and `}}` are braces.
fn pieces<'a>(text: &'a str, take: &mut dyn FnMut(Piece<'a>)) {
    let mut rest = text;
    while let Some(at) = rest.find(['{', '}']) {
        let (plain, brace) = rest.split_at(at);
        take(Piece::Text(plain));
        let (doubled, inside) = (brace.starts_with("{{") || brace.starts_with("}}"), brace.get(1..));
        let inside = inside.unwrap_or_default();
        if doubled {
            take(Piece::Text(inside.get(..1).unwrap_or_default()));
            rest = inside.get(1..).unwrap_or_default();
        } else {
            let (hole, behind) = inside.split_once('}').unwrap_or((inside, ""));
            take(Piece::Hole(hole.split_once(':').map_or(hole, |(name, _)| name)));
            rest = behind;
        }
    }
    take(Piece::Text(rest));
}
