//! Copies a part of a chart as text, to be pasted elsewhere. The text is a small file: a chart with
//! the chosen steps and transitions, the expansions of its macro-steps, the declarations that they
//! need, and the places of the symbols.

use g7_model::{Chart, ChartItem, Document, Item, Layout, Name, PlaceAt, Placed, Span, StepKind, Transition};

use crate::change::{Anchors, Source};
use crate::id::{ItemId, Part};
use crate::needs::needs;

/// The chosen steps and transitions as the text of a small file. A transition whose steps are all
/// chosen is copied too; links to other steps are cut.
pub fn copy(source: &Source<'_>, ids: &[ItemId]) -> String {
    copy_placed(source, ids, &|_| None)
}

/// The same for a chart that is drawn: `anchors` gives the places of its symbols.
pub fn copy_placed(source: &Source<'_>, ids: &[ItemId], anchors: Anchors<'_>) -> String {
    let Some(first) = ids.first() else { return String::new() };
    let Some(chart) = source.document.charts().find(|c| *c.name.text == *first.chart) else {
        return String::new();
    };
    let chosen = Chosen::new(ids, &first.chart);
    let mut part = Chart { items: Vec::new(), comment: None, every: None, ..chart.clone() };
    let mut places = Vec::new();
    let mut spans = Vec::new();
    let mut number = 0;
    for item in &chart.items {
        match item {
            ChartItem::Step(s) if chosen.has(&s.name) => {
                spans.push(s.at.0);
                let id = ItemId::step(&*chart.name.text, &*s.name.text);
                places.extend(placed(Placed::Step(s.name.clone()), anchors(&id)));
                part.items.push(item.clone());
            }
            ChartItem::Transition(t) => {
                if let Some(cut) = chosen.transition(t, number) {
                    spans.push(t.at.0);
                    let id = ItemId::transition(&*chart.name.text, number);
                    let what = match &t.label {
                        Some(label) => Placed::Transition(label.clone()),
                        None => {
                            let there = part.items.iter().filter(|i| matches!(i, ChartItem::Transition(_)));
                            Placed::TransitionNumber(u32::try_from(there.count()).unwrap_or(u32::MAX))
                        }
                    };
                    places.extend(placed(what, anchors(&id)));
                    part.items.push(ChartItem::Transition(cut));
                }
                number += 1;
            }
            _ => {}
        }
    }
    places.extend(chosen.comments(source.document));
    if part.items.is_empty() && places.is_empty() {
        return String::new();
    }
    let name = part.name.clone();
    let mut doc = Document { items: vec![Item::Chart(part)], notes: Vec::new() };
    with_expansions(source.document, &mut doc);
    spans.extend(doc.charts().skip(1).map(|c| c.at.0));
    with_declarations(source.document, &spans, &mut doc);
    if !places.is_empty() {
        let at = Span::default().into();
        doc.items.push(Item::Layout(Layout { chart: name, places, at }));
    }
    g7_syntax::print(&doc, None)
}

fn placed(what: Placed, at: Option<(i32, i32)>) -> Option<PlaceAt> {
    at.map(|(x, y)| PlaceAt { what, x, y, then: Vec::new(), at: Span::default().into() })
}

/// The chosen parts of one chart.
struct Chosen<'i> {
    chart: &'i str,
    steps: Vec<&'i str>,
    numbers: Vec<usize>,
    notes: Vec<usize>,
}

impl<'i> Chosen<'i> {
    fn new(ids: &'i [ItemId], chart: &'i str) -> Chosen<'i> {
        let mut chosen = Chosen { chart, steps: Vec::new(), numbers: Vec::new(), notes: Vec::new() };
        for id in ids.iter().filter(|id| id.chart == chart) {
            match &id.part {
                Part::Step(s) | Part::Action(s, _) => chosen.steps.push(s),
                Part::Transition(n) => chosen.numbers.push(*n),
                Part::Note(n) => chosen.notes.push(*n),
                Part::Chart | Part::Link(..) | Part::Connector(..) | Part::Other(_) => {}
            }
        }
        chosen
    }

    fn has(&self, name: &Name) -> bool {
        self.steps.contains(&&*name.text)
    }

    /// The copy of a transition, if it is to be copied.
    fn transition(&self, t: &Transition, number: usize) -> Option<Transition> {
        let all = t.from.iter().chain(&t.to).all(|n| self.has(n)) && !(t.from.is_empty() && t.to.is_empty());
        if !all && !self.numbers.contains(&number) {
            return None;
        }
        let mut t = t.clone();
        t.from.retain(|n| self.has(n));
        t.to.retain(|n| self.has(n));
        t.chained = false;
        Some(t)
    }

    /// The chosen comments of the layout section.
    fn comments(&self, document: &Document) -> Vec<PlaceAt> {
        let layout = document.items.iter().find_map(|i| match i {
            Item::Layout(l) if *l.chart.text == *self.chart => Some(l),
            _ => None,
        });
        let comments = layout.into_iter().flat_map(|l| &l.places);
        let comments = comments.filter(|p| matches!(p.what, Placed::Comment(_))).enumerate();
        comments.filter(|(n, _)| self.notes.contains(n)).map(|(_, p)| p.clone()).collect()
    }
}

/// Adds the expansions of the macro-steps, and the expansions used in these.
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

/// Adds the declarations of the names that are used; the local ones go into the copied part of
/// their chart.
fn with_declarations(source: &Document, spans: &[Span], doc: &mut Document) {
    let mut before = Vec::new();
    for (chart, v) in needs(source, spans) {
        let Some(home) = chart else {
            before.push(Item::Var(v));
            continue;
        };
        let part = doc.items.iter_mut().find_map(|i| match i {
            Item::Chart(c) if *c.name.text == *home => Some(c),
            _ => None,
        });
        if let Some(part) = part {
            let k = part.items.iter().take_while(|i| matches!(i, ChartItem::Var(_))).count();
            part.items.insert(k, ChartItem::Var(v));
        }
    }
    doc.items.splice(0..0, before);
}
