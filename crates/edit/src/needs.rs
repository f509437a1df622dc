//! The declarations that a part of a document needs: the variables it names, and those named by
//! their initial values.

use std::collections::BTreeSet;

use g7_compile::references::Written;
use g7_compile::{Definition, references};
use g7_model::{ChartItem, Document, Item, Span, VarDecl};

/// A declaration, with its chart if it belongs to one.
pub(crate) type Need = (Option<String>, VarDecl);

/// The declarations that the given places need, in the order of the text. A declaration of several
/// names is reduced to the names needed. Declarations inside the places themselves are left out.
pub(crate) fn needs(doc: &Document, places: &[Span]) -> Vec<Need> {
    let refs = references(doc);
    let declared = declarations(doc);
    let mut places = places.to_vec();
    let mut wanted: BTreeSet<&Definition> = BTreeSet::new();
    loop {
        let within = |at: Span| places.iter().any(|p| p.start <= at.start && at.end <= p.end);
        let uses = refs.all().iter().filter(|u| u.written != Written::Declared && within(u.at));
        let new: Vec<&Definition> = uses
            .map(|u| &u.definition)
            .filter(|d| matches!(d, Definition::Variable { .. }) && !wanted.contains(d))
            .collect();
        if new.is_empty() {
            break;
        }
        wanted.extend(new);
        let needed =
            declared.iter().filter(|(chart, v)| !needed_names(&wanted, chart.as_deref(), v).is_empty());
        let more: Vec<Span> = needed.map(|(_, v)| v.at.0).collect();
        places.extend(more);
        places.sort();
        places.dedup();
    }
    let home = |at: Span, c: &Option<String>| {
        // A declaration inside another part is copied with that part.
        let own = |p: &Span| p.start <= at.start && at.end <= p.end && *p != at;
        c.is_some() && places.iter().any(own)
    };
    declared
        .into_iter()
        .filter(|(chart, v)| !home(v.at.0, chart))
        .filter_map(|(chart, v)| {
            let names = needed_names(&wanted, chart.as_deref(), v);
            (!names.is_empty()).then(|| (chart, VarDecl { names, ..v.clone() }))
        })
        .collect()
}

fn declarations(doc: &Document) -> Vec<(Option<String>, &VarDecl)> {
    let mut found = Vec::new();
    for item in &doc.items {
        match item {
            Item::Var(v) => found.push((None, v)),
            Item::Chart(c) => found.extend(c.items.iter().filter_map(|i| match i {
                ChartItem::Var(v) => Some((Some(c.name.text.to_string()), v)),
                _ => None,
            })),
            _ => {}
        }
    }
    found
}

fn needed_names(wanted: &BTreeSet<&Definition>, chart: Option<&str>, v: &VarDecl) -> Vec<g7_model::Name> {
    let needed = |n: &&g7_model::Name| {
        let def = Definition::Variable { chart: chart.map(str::to_owned), name: n.text.to_string() };
        wanted.contains(&def)
    };
    v.names.iter().filter(needed).cloned().collect()
}
