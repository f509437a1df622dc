//! Where in the document a place lies, in words: the chart and its step or transition, a function, a test.

use g7_model::{Chart, ChartItem, Document, Item, Language, Span, VarDecl};

use crate::charts::named;
use crate::words;

/// The item at a place, in words; none for a place outside of all.
pub(crate) fn site(document: &Document, at: Span, language: Language) -> Option<String> {
    let told = |word| language.told(word);
    let item = document.items.iter().find(|i| i.at().holds(at))?;
    let of = |word, name: &str| format!("{} {name}", told(word));
    Some(match item {
        Item::Chart(chart) => format!("{}: {}", chart.name.text, inside(chart, at, language)),
        Item::Var(v) | Item::Type(v) => declaration(v, language),
        Item::Action(a) => of(words::ACTION, &a.name.text),
        Item::Section(s) => of(words::SECTION, &s.name.text),
        Item::Function(f) => of(words::FUNCTION, &f.name.text),
        Item::Composed(c) if c.block => of(words::BLOCK, &c.name.text),
        Item::Composed(c) => of(words::STRUCTURE, &c.name.text),
        Item::Plant(p) => of(words::PLANT, &p.name.text),
        Item::Test(t) => format!("{} “{}”", told(words::TEST), t.title),
        Item::Prove(p) => match &p.comment {
            Some(comment) => format!("{} “{comment}”", told(words::PROPERTY)),
            None => told(words::PROPERTY).to_owned(),
        },
        Item::Pre(..) => "PRE".to_owned(),
        Item::Post(..) => "POST".to_owned(),
        Item::Instance(i) => i.chart.text.to_string(),
        Item::Profile(_) | Item::Cycle(..) | Item::Target(..) | Item::Use(_) | Item::Layout(_) => {
            return None;
        }
    })
}

fn declaration(v: &VarDecl, language: Language) -> String {
    let names: Vec<&str> = v.names.iter().map(|n| &*n.text).collect();
    format!("{} {}", language.told(words::DECLARATION), names.join(", "))
}

fn inside(chart: &Chart, at: Span, language: Language) -> String {
    let of = |word, name: &str| format!("{} {name}", language.told(word));
    match chart.items.iter().find(|i| i.at().holds(at)) {
        Some(ChartItem::Step(s)) => of(words::STEP, &s.name.text),
        Some(ChartItem::Transition(t)) => of(words::TRANSITION, &named(t)),
        Some(ChartItem::Action(a)) => of(words::ACTION, &a.name.text),
        Some(ChartItem::Section(s)) => of(words::SECTION, &s.name.text),
        Some(ChartItem::Pre(..)) => "PRE".to_owned(),
        Some(ChartItem::Post(..)) => "POST".to_owned(),
        Some(ChartItem::Var(v)) => declaration(v, language),
        None => language.told(words::DECLARATION).to_owned(),
    }
}
