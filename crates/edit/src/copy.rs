//! A part of a chart as text, to be pasted elsewhere: a chart of its own with
//! the chosen steps and transitions, and the expansions of its macro-steps.

use g7_model::{Chart, ChartItem, Document, Item, Name, StepKind};

use crate::Source;
use crate::id::{ItemId, Part};

/// The chosen steps and transitions as the text of a small file. Transitions
/// whose steps are all chosen come along; links to other steps are cut.
pub fn copy(source: &Source<'_>, ids: &[ItemId]) -> String {
    let Some(first) = ids.first() else { return String::new() };
    let Some(chart) = source.document.charts().find(|c| *c.name.text == *first.chart) else {
        return String::new();
    };
    let own = || ids.iter().filter(|id| id.chart == first.chart);
    let steps: Vec<&str> = own()
        .filter_map(|id| match &id.part {
            Part::Step(s) | Part::Action(s, _) => Some(s.as_str()),
            _ => None,
        })
        .collect();
    let numbers: Vec<usize> =
        own().filter_map(|id| if let Part::Transition(n) = id.part { Some(n) } else { None }).collect();
    let chosen = |n: &Name| steps.contains(&&*n.text);
    let mut part = Chart { items: Vec::new(), comment: None, every: None, ..chart.clone() };
    let mut number = 0;
    for item in &chart.items {
        match item {
            ChartItem::Step(s) if chosen(&s.name) => part.items.push(item.clone()),
            ChartItem::Transition(t) => {
                let all = t.from.iter().chain(&t.to).all(chosen) && !(t.from.is_empty() && t.to.is_empty());
                if all || numbers.contains(&number) {
                    let mut t = t.clone();
                    t.from.retain(chosen);
                    t.to.retain(chosen);
                    t.chained = false;
                    part.items.push(ChartItem::Transition(t));
                }
                number += 1;
            }
            _ => {}
        }
    }
    if part.items.is_empty() {
        return String::new();
    }
    let mut doc = Document { items: vec![Item::Chart(part)], notes: Vec::new() };
    with_expansions(source.document, &mut doc);
    g7_syntax::print(&doc, None)
}

/// Adds the expansions of the macro-steps, and those in them.
fn with_expansions(source: &Document, doc: &mut Document) {
    let mut k = 0;
    while let Some(Item::Chart(chart)) = doc.items.get(k) {
        let wanted: Vec<Name> = chart
            .steps()
            .filter_map(|s| if let StepKind::Macro(x) = &s.kind { Some(x.clone()) } else { None })
            .collect();
        for name in wanted {
            let there = doc.charts().any(|c| c.name == name);
            if let (false, Some(c)) = (there, source.charts().find(|c| c.name == name)) {
                doc.items.push(Item::Chart(c.clone()));
            }
        }
        k += 1;
    }
}
