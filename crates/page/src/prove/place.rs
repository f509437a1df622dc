//! The places in a text where properties and tests are added.

use g7_edit::Splice;
use g7_ide::File;
use g7_model::{Item, Span};

/// The sort of item that is added to a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sort {
    Property,
    Test,
}

/// Puts an item behind the last one of its sort; else before tests and layout, or at the end.
pub(super) fn place(file: &File, sort: Sort, item: &str) -> Splice {
    let text = file.text();
    let places = || file.source.document.items.iter().filter_map(sorted);
    let gap = if sort == Sort::Test { "\n\n" } else { "\n" };
    if let Some((_, last)) = places().rfind(|(s, _)| *s == Some(sort)) {
        let at = line_end(text, file.source.range(last).end);
        return Splice::new(at, at, format!("{gap}{item}"));
    }
    if let Some((_, behind)) = places().find(|(s, _)| *s != Some(Sort::Property)) {
        let at = above(text, file.source.range(behind).start);
        return Splice::new(at, at, format!("{item}\n\n"));
    }
    let body = text.trim_end().len();
    Splice::new(body, text.len(), format!("\n\n{item}\n"))
}

/// Items that stand behind the charts: their sort, nothing for a layout, and their place.
fn sorted(item: &Item) -> Option<(Option<Sort>, Span)> {
    match item {
        Item::Test(t) => Some((Some(Sort::Test), t.at.0)),
        Item::Prove(p) => Some((Some(Sort::Property), p.at.0)),
        Item::Layout(l) => Some((None, l.at.0)),
        _ => None,
    }
}

/// The end of the line with a place.
pub(super) fn line_end(text: &str, at: usize) -> usize {
    let rest = text.get(at..).unwrap_or_default();
    let line = rest.split('\n').next().unwrap_or_default();
    at + line.trim_end_matches('\r').len()
}

/// The start of the line with a place, or of the notes right above it.
fn above(text: &str, at: usize) -> usize {
    let mut start = text.get(..at).unwrap_or_default().rfind('\n').map_or(0, |n| n + 1);
    loop {
        let before = text.get(..start.saturating_sub(1)).unwrap_or_default();
        let line = before.rfind('\n').map_or(0, |n| n + 1);
        if start == 0 || !before.get(line..).unwrap_or_default().trim_start().starts_with("//") {
            return start;
        }
        start = line;
    }
}
