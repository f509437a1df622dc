//! Changes the list of the items of a file.

use g7_model::{Item, Layout, PlaceAt, Span};
use g7_syntax::{Part, items_apart, print_part};

use super::chart;
use super::item;
use super::lines::Sheet;
use super::list::{Block, Style, list};
use super::plant;
use crate::draft::Draft;

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

    #[inline(never)]
    fn edit(&self, sheet: &mut Sheet<'_>, old: &Item, new: &Item) {
        match (old, new) {
            (Item::Chart(a), Item::Chart(b)) => chart::edit(sheet, self.draft, a, b),
            (Item::Layout(a), Item::Layout(b)) => edit_layout(sheet, a, b),
            (Item::Var(a), Item::Var(b)) => item::edit_variable(sheet, self.draft, a, b),
            (Item::Plant(a), Item::Plant(b)) => plant::edit(sheet, self.draft, a, b),
            (Item::Profile(a), Item::Profile(b)) if a.name != b.name => {
                let tokens = sheet.tokens(a.at.0.start as usize, a.at.0.end as usize);
                if let Some(word) = tokens.get(1) {
                    sheet.put(word.start, word.end, b.name.name());
                }
            }
            (a, b) if a != b => {
                let at = a.at();
                sheet.put(at.start as usize, at.end as usize, print_part(Part::Item(b), None));
            }
            _ => {}
        }
    }

    fn fresh(&self, sheet: &Sheet<'_>, new: &Item, _indent: &str) -> String {
        let typed = |at| self.draft.typed(at);
        let text = match (new, typed(new.at())) {
            (_, Some(typed)) => typed,
            (Item::Chart(c), None) => chart::fresh(sheet, self.draft, c),
            (other, None) => print_part(Part::Item(other), Some(&typed)),
        };
        text.replace('\n', sheet.newline).replace("\r\r", "\r")
    }

    fn apart(&self, a: &Item, b: &Item) -> bool {
        items_apart(a, b)
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
            sheet.put(old.at.0.start as usize, old.at.0.end as usize, print_part(Part::Place(new), None));
        }
    }

    fn fresh(&self, _sheet: &Sheet<'_>, new: &PlaceAt, indent: &str) -> String {
        format!("{indent}{}", print_part(Part::Place(new), None))
    }

    fn apart(&self, _: &PlaceAt, _: &PlaceAt) -> bool {
        false
    }
}
