//! Where a name is declared and used, and its change everywhere.

use std::ops::Range;

use g7_edit::Splice;
use g7_model::{Said, Span, say};

use crate::file::{File, OWN};
use crate::names::{meaning, word_at};

/// The places of a name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Uses {
    /// Every place, the declaration among them, in the order of the text.
    pub all: Vec<Range<usize>>,
    /// The declaration.
    pub declared: Option<Range<usize>>,
    /// The declaration, where it stands in a file that this one uses.
    pub elsewhere: Option<Span>,
}

/// All places that name the same part as the word at a byte.
pub fn uses(file: &File, at: usize) -> Uses {
    let known = g7_compile::references(file.source.whole()).seen_from(OWN);
    match known.at(offset(at)) {
        Some(named) => {
            let own = |at: &Span| at.file == OWN;
            let declared = known.declaration(named);
            Uses {
                all: known.of(named).into_iter().filter(own).map(Span::bytes).collect(),
                declared: declared.filter(own).map(Span::bytes),
                elsewhere: declared.filter(|at| !own(at)),
            }
        }
        // Names that are not indexed, such as a function's name inside the function, are found by
        // spelling.
        None => spelled(file, at).unwrap_or_default(),
    }
}

fn spelled(file: &File, at: usize) -> Option<Uses> {
    let word = word_at(file.text(), at)?;
    let named = meaning(&file.source.document, &word)?;
    let all = g7_syntax::tokens(file.text())
        .filter(|t| file.text().get(t.start..t.end).is_some_and(|w| w.trim_matches('`') == word.text))
        .map(|t| t.start..t.end)
        .collect();
    Some(Uses { all, declared: Some(named.name.at.0.bytes()), elsewhere: None })
}

/// The name at a byte that can be changed: its place, and its spelling without back-ticks.
pub fn changeable(file: &File, at: usize) -> Option<(Range<usize>, String)> {
    let known = g7_compile::references(file.source.whole()).seen_from(OWN);
    let found = known.use_at(offset(at))?;
    let whole = found.at.bytes();
    let name = whole.start + found.before..whole.end;
    let text = file.text().get(name.clone())?;
    Some((name, text.trim_matches('`').to_owned()))
}

/// The change that gives the part named at a byte another name, or why it cannot have it.
pub fn rename(file: &File, at: usize, to: &str) -> Result<Vec<Splice>, Said> {
    if let Some(there) = uses(file, at).elsewhere {
        return Err(say!("this is declared in {}; rename it there", Said::foreign(file.source.place(there))));
    }
    Ok(g7_edit::rename_at(&file.as_edited(), at, to)?.splices)
}

fn offset(at: usize) -> u32 {
    u32::try_from(at).unwrap_or(u32::MAX)
}
