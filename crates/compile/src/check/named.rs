//! Every name that a document uses, as it is written.

use std::collections::HashSet;

use g7_model::{Block, Chart, ChartItem, Document, Item, Name, Order, Situation, Span, VarDecl};

use crate::mentions::Mentions;

/// All names outside of their own declarations; of bodies in other languages
/// every word.
pub(super) fn names(doc: &Document) -> HashSet<&str> {
    let mut n = Names::default();
    for item in &doc.items {
        match item {
            Item::Var(v) => n.variable(v),
            Item::Chart(c) => n.chart(c),
            Item::Action(a) => n.body(&a.body),
            Item::Section(s) => n.block(&s.body),
            Item::Function(f) => n.block(&f.body),
            Item::Pre(b, _) | Item::Post(b, _) => n.body(b),
            Item::Plant(p) => p.items.iter().for_each(|i| n.plant_item(i)),
            Item::Test(t) => t.body.iter().for_each(|s| n.test(s)),
            Item::Prove(p) => n.property(&p.kind),
            Item::Profile(_) | Item::Cycle(..) | Item::Target(..) | Item::Layout(_) => {}
        }
    }
    n.found
}

#[derive(Default)]
struct Names<'d> {
    found: HashSet<&'d str>,
}

impl<'d> Names<'d> {
    fn name(&mut self, name: &'d Name) {
        self.found.insert(&name.text);
    }

    fn variable(&mut self, v: &'d VarDecl) {
        self.exprs(v.init.iter().chain(&v.safe));
    }

    fn chart(&mut self, c: &'d Chart) {
        for item in &c.items {
            match item {
                ChartItem::Var(v) => self.variable(v),
                ChartItem::Step(s) => s.actions.iter().for_each(|a| self.action(a)),
                ChartItem::Transition(t) => {
                    self.expr(&t.receptivity);
                    t.on_clearing.iter().for_each(|b: &Block| self.block(b));
                }
                ChartItem::Pre(b, _) | ChartItem::Post(b, _) => self.body(b),
                ChartItem::Action(a) => self.body(&a.body),
                ChartItem::Section(s) => self.block(&s.body),
            }
        }
    }
}

impl<'d> Mentions<'d> for Names<'d> {
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
