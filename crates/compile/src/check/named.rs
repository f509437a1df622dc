//! Collects every name that a document uses, as it is written.

use std::collections::HashSet;

use g7_model::visit::Visitor;
use g7_model::{Document, Index, Item, Name, Order, Situation, Span, instance_of, slot_of};

/// All names except where they are declared. Every word of a body in another language counts.
pub(super) fn names(doc: &Document) -> HashSet<&str> {
    let mut n = Names::default();
    n.document(doc);
    n.found
}

/// The names that charts, what belongs to them, and properties use.
pub(super) fn names_of_charts(doc: &Document) -> HashSet<&str> {
    let mut n = Names::default();
    doc.items.iter().filter(|i| !matches!(i, Item::Plant(_) | Item::Test(_))).for_each(|i| n.item(i));
    n.found
}

#[derive(Default)]
struct Names<'d> {
    found: HashSet<&'d str>,
}

impl<'d> Names<'d> {
    fn name(&mut self, name: &'d Name) {
        self.found.insert(&name.text);
        if let Some((bare, index)) = instance_of(&name.text) {
            self.found.insert(bare);
            self.found.extend(if let Index::Parameter(parameter, _) = index {
                Some(parameter)
            } else {
                None
            });
        }
        self.found.extend(slot_of(&name.text).map(|(bare, _)| bare));
    }
}

impl<'d> Visitor<'d> for Names<'d> {
    fn path(&mut self, names: &'d [Name]) {
        names.iter().for_each(|n| self.name(n));
    }

    fn direct(&mut self, text: &'d str, _: Span) {
        self.found.insert(text);
    }

    fn foreign(&mut self, text: &'d str) {
        let word = |c: char| c.is_alphanumeric() || c == '_';
        self.found.extend(text.split(|c| !word(c)));
    }

    fn order(&mut self, order: &'d Order) {
        match order {
            Order::Force(n, situation) => {
                self.name(n);
                if let Situation::Steps(list) = situation {
                    list.iter().for_each(|n| self.name(n));
                }
            }
            Order::Enable(n) | Order::Mask(n) | Order::Call(n) | Order::Enclose(n) => self.name(n),
        }
    }
}
