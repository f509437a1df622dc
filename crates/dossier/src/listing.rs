//! Named actions, transition sections, functions, types with members, and what runs before and after the charts, as they
//! are written.

use g7_model::{ChartItem, Item, Span};

use crate::data::Input;
use crate::flow::Flow;
use crate::sites::site;
use crate::words;

/// The part of the dossier.
pub(crate) fn section(flow: &mut Flow, input: &Input<'_>) {
    let told = |word| input.language.told(word);
    flow.part(told(words::BODIES));
    let mut none = true;
    for at in places(input) {
        none = false;
        let title = site(input.source.whole(), at, input.language).unwrap_or_default();
        flow.heading(1, &title);
        flow.written(unindented(input.source.written(at)));
    }
    if none {
        flow.text(told(words::NONE));
    }
}

/// The lines of a text, without the blanks that all lines but the first begin with.
fn unindented(text: &str) -> Vec<&str> {
    let blanks = |l: &str| l.len() - l.trim_start().len();
    let rest = text.lines().skip(1).filter(|l| !l.trim().is_empty());
    let common = rest.map(blanks).min().unwrap_or(0);
    let mut lines = text.lines();
    let first = lines.next().unwrap_or_default();
    std::iter::once(first).chain(lines.map(|l| l.get(common.min(blanks(l))..).unwrap_or(l))).collect()
}

/// The places of all that is listed; of the library nothing.
fn places(input: &Input<'_>) -> Vec<Span> {
    let source = input.source;
    let mut all: Vec<Span> = Vec::new();
    for item in &source.whole().items {
        match item {
            Item::Action(_)
            | Item::Section(_)
            | Item::Function(_)
            | Item::Composed(_)
            | Item::Pre(..)
            | Item::Post(..) => all.push(item.at()),
            Item::Chart(c) => {
                let own = |i: &&ChartItem| {
                    !matches!(i, ChartItem::Var(_) | ChartItem::Step(_) | ChartItem::Transition(_))
                };
                all.extend(c.items.iter().filter(own).map(ChartItem::at));
            }
            _ => {}
        }
    }
    all.retain(|at| !source.is_of_library(*at));
    all
}
