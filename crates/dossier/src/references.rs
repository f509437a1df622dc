//! Cross references: for each name where it is declared, and which steps, transitions, functions and tests read and
//! write it.

use std::collections::BTreeMap;

use g7_compile::references::{Definition, Written};
use g7_model::Span;

use crate::data::Input;
use crate::flow::Flow;
use crate::sites::site;
use crate::table::Table;
use crate::words;
use crate::writes::writes;

/// A name with its places.
#[derive(Default)]
struct Named {
    declared: Option<Span>,
    reads: Vec<String>,
    writes: Vec<String>,
}

/// The name and its owner, if it is one of the names that the table has.
fn shown(definition: &Definition) -> Option<(String, String)> {
    let owned = |owner: &Option<String>| owner.clone().unwrap_or_default();
    match definition {
        Definition::Variable { chart, name } => Some((name.clone(), owned(chart))),
        Definition::Action { chart, name } | Definition::Section { chart, name } => {
            Some((name.clone(), owned(chart)))
        }
        Definition::Step { chart, name } => Some((format!("X{name}"), chart.clone())),
        Definition::Function(name) | Definition::Type(name) | Definition::Chart(name) => {
            Some((name.clone(), String::new()))
        }
        // The parts of a type or a plant are told there.
        Definition::Value { .. }
        | Definition::Member { .. }
        | Definition::Transition { .. }
        | Definition::Plant(_)
        | Definition::PlantItem { .. } => None,
    }
}

/// The part of the dossier.
pub(crate) fn section(flow: &mut Flow, input: &Input<'_>) {
    let told = |word| input.language.told(word);
    let document = input.source.whole();
    let written = writes(document);
    let mut all: BTreeMap<(String, String), Named> = BTreeMap::new();
    for used in g7_compile::references(document).all() {
        // The steps that a transition joins are told by the chart itself.
        if used.written == Written::Step {
            continue;
        }
        let Some(name) = shown(&used.definition) else { continue };
        let known = all.entry(name).or_default();
        if used.written == Written::Declared {
            known.declared = Some(used.at);
            continue;
        }
        let Some(site) = site(document, used.at, input.language) else { continue };
        let list = if written.contains(&used.at) { &mut known.writes } else { &mut known.reads };
        if list.last() != Some(&site) {
            list.push(site);
        }
    }
    flow.part(told(words::REFERENCES));
    let mut table = Table::new(&[
        (told(words::NAME), 24),
        (told(words::DECLARED), 20),
        (told(words::READ), 40),
        (told(words::WRITTEN), 40),
    ]);
    for ((name, owner), named) in all {
        // A step that nothing asks for is told with its chart.
        if name.starts_with('X') && named.reads.is_empty() && named.writes.is_empty() && !owner.is_empty() {
            continue;
        }
        let name = if owner.is_empty() { name } else { format!("{name}\n({owner})") };
        let declared =
            named.declared.map_or(String::new(), |at| input.place(&input.source.place(at)).to_owned());
        table.row(vec![name, declared, list(named.reads), list(named.writes)]);
    }
    table.write_or(flow, told(words::NONE));
}

fn list(mut sites: Vec<String>) -> String {
    let mut seen = std::collections::HashSet::new();
    sites.retain(|s| seen.insert(s.clone()));
    if sites.is_empty() { "–".to_owned() } else { sites.join("\n") }
}
