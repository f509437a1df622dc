//! Writes the items of a file.

use g7_model::{Item, Layout, PlaceAt, Placed, Span};

use super::chart;
use super::item;
use super::lines::Sheet;
use super::list::{Block, Style, list};
use super::text::printed;
use crate::draft::{Draft, is_fresh};

/// Writes the whole file.
pub(crate) fn write(sheet: &mut Sheet<'_>, draft: &Draft<'_>) {
    let old = &draft.source.document.items;
    let block = Block { open: None, close: sheet.text.len(), indent: String::new(), outer: "" };
    list(sheet, old, &draft.doc.items, &block, &Items { draft });
}

struct Items<'d, 's> {
    draft: &'d Draft<'s>,
}

impl Style<Item> for Items<'_, '_> {
    fn at(&self, thing: &Item) -> Span {
        thing.at()
    }

    fn edit(&self, sheet: &mut Sheet<'_>, old: &Item, new: &Item) {
        match (old, new) {
            (Item::Chart(a), Item::Chart(b)) => chart::edit(sheet, self.draft, a, b),
            (Item::Layout(a), Item::Layout(b)) => edit_layout(sheet, a, b),
            (Item::Var(a), Item::Var(b)) => item::edit_variable(sheet, self.draft, a, b),
            (Item::Profile(a), Item::Profile(b)) if a.name != b.name => {
                let tokens = sheet.tokens(a.at.0.start as usize, a.at.0.end as usize);
                if let Some(word) = tokens.get(1) {
                    sheet.put(word.start, word.end, b.name.name());
                }
            }
            (a, b) if a != b => {
                let at = a.at();
                sheet.put(at.start as usize, at.end as usize, printed(b.clone()));
            }
            _ => {}
        }
    }

    fn fresh(&self, sheet: &Sheet<'_>, new: &Item, _indent: &str) -> String {
        let raw = self.draft.raw.get(&new.at().start).filter(|_| is_fresh(new.at().into()));
        match (new, raw) {
            (_, Some(raw)) => raw.clone(),
            (Item::Chart(c), None) => chart::fresh(sheet, self.draft, c),
            (Item::Var(v), None) => item::variable_text(v, &self.draft.raw),
            (other, None) => printed(other.clone()),
        }
        .replace('\n', sheet.newline)
        .replace("\r\r", "\r")
    }

    fn apart(&self, a: &Item, b: &Item) -> bool {
        family(a) == 9 || family(a) != family(b)
    }
}

fn edit_layout(sheet: &mut Sheet<'_>, old: &Layout, new: &Layout) {
    let (start, end) = (old.at.0.start as usize, old.at.0.end as usize);
    let Some(open) = sheet.header(start, end).1 else { return };
    let outer = sheet.indent(start);
    let block = Block { open: Some(open.end), close: end - 1, indent: format!("{outer}  "), outer };
    list(sheet, &old.places, &new.places, &block, &Places);
}

/// Writes the places of a layout section, one on each line.
struct Places;

impl Style<PlaceAt> for Places {
    fn at(&self, thing: &PlaceAt) -> Span {
        thing.at.0
    }

    fn edit(&self, sheet: &mut Sheet<'_>, old: &PlaceAt, new: &PlaceAt) {
        if old != new {
            sheet.put(old.at.0.start as usize, old.at.0.end as usize, place_text(new));
        }
    }

    fn fresh(&self, _sheet: &Sheet<'_>, new: &PlaceAt, indent: &str) -> String {
        format!("{indent}{}", place_text(new))
    }

    fn apart(&self, _: &PlaceAt, _: &PlaceAt) -> bool {
        false
    }
}

fn place_text(place: &PlaceAt) -> String {
    let number = |n: i32| {
        let (sign, n) = (if n < 0 { "-" } else { "" }, n.unsigned_abs());
        match (n / 100, n % 100) {
            (whole, 0) => format!("{sign}{whole}"),
            (whole, part) if part % 10 == 0 => format!("{sign}{whole}.{}", part / 10),
            (whole, part) => format!("{sign}{whole}.{part:02}"),
        }
    };
    let what = match &place.what {
        Placed::Step(name) => format!("step {}", g7_syntax::show_name(&name.text)),
        Placed::Transition(label) => format!("transition {}", g7_syntax::show_name(&label.text)),
        Placed::TransitionNumber(n) => format!("transition #{n}"),
        Placed::Comment(text) => format!("comment {}", g7_syntax::show_comment(text)),
    };
    format!("{what} at ({}, {})", number(place.x), number(place.y))
}

/// The group of an item: items of one group stand together without blank lines; group 9 always has
/// blank lines.
fn family(item: &Item) -> u8 {
    match item {
        Item::Profile(_) | Item::Cycle(..) | Item::Target(..) => 0,
        Item::Var(_) => 1,
        Item::Prove(_) => 2,
        Item::Chart(_)
        | Item::Action(_)
        | Item::Section(_)
        | Item::Function(_)
        | Item::Pre(..)
        | Item::Post(..)
        | Item::Plant(_)
        | Item::Test(_)
        | Item::Layout(_) => 9,
    }
}
