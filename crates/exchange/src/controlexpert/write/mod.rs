//! Writes a document as a section of Control Expert in SFC (`.XSF`).
//!
//! The chart becomes the section, the expansions of its macro-steps further drawings in it. What the
//! section cannot say is a problem with its place in the document: a warning if the rest means the
//! same, otherwise an error.
//!
//! ```text
//! Document -> rules (what is refused as a whole), names
//!          -> plan (structure of a chart) -> lay (cells) -> chart
//!          -> text (expressions, statements) -> actions, declare
//! ```

mod actions;
mod chart;
mod declare;
mod declared;
mod lay;
mod names;
mod plan;
mod rules;
#[cfg(test)]
mod tests;
mod text;

use std::collections::BTreeMap;

use g7_iec::report;
use g7_iec::scopes::{Scopes, StepKey};
use g7_iec::signs;
use g7_iec::st::Known;
use g7_iec::xml::controlexpert;
use g7_iec::xml::element::Element;
use g7_model::{ChartItem, ChartKind, Document, Item, say};

use crate::Written;
use names::Names;
use text::Speech;

/// Writes the document.
pub(crate) fn export(document: &Document) -> Written {
    let document = &signs::in_signs(document);
    let scopes = Scopes::new(document);
    let names = Names::new(document, &scopes);
    let list = declared::variables(document);
    let renamed = declared::renamed(&list, &names);
    let types = Known::new(&renamed, None);
    let speech = Speech::new(scopes, names, types);
    let owners = owners(&speech.scopes);
    let mut writer = Writer {
        document,
        speech,
        owners,
        action_sections: Vec::new(),
        transition_sections: Vec::new(),
        conditions: 0,
    };
    let (title, program) = writer.program();
    let variables = writer.variables(&list);
    let Writer { speech, .. } = writer;
    let mut problems = speech.problems;
    problems.extend(report::renamed(&speech.names.renamed));
    problems.sort_by_key(|p| (p.at.start, p.at.end));
    let text = controlexpert::file("SFCExchangeFile", "SFC source file", &title, program, variables);
    Written { text, problems }
}

struct Writer<'d> {
    document: &'d Document,
    speech: Speech<'d>,
    /// The macro-step of each expansion.
    owners: BTreeMap<usize, StepKey>,
    action_sections: Vec<Element>,
    transition_sections: Vec<Element>,
    /// How many conditions have a section of their own so far.
    conditions: usize,
}

impl Writer<'_> {
    /// The name of the section, and the section.
    fn program(&mut self) -> (String, Element) {
        self.rules();
        let document = self.document;
        let mut drawings = Vec::new();
        let mut title = String::new();
        for index in self.order() {
            let Some(chart) = self.speech.scopes.chart(index) else { continue };
            let macro_step = self.owners.get(&index).copied();
            let name = match macro_step {
                Some(key) => self.speech.names.step(key).to_string(),
                None => "Chart".to_string(),
            };
            if macro_step.is_none() {
                title = names::fitting(&chart.name.text);
            }
            let network = self.network(index).unwrap_or_else(|| Element::new("networkSFC"));
            drawings.push(Element::new("chartSource").with("name", name).child(network));
            for item in &chart.items {
                match item {
                    ChartItem::Action(a) => self.named(Some(index), a),
                    ChartItem::Section(s) => self.section(Some(index), s),
                    ChartItem::Pre(_, at) | ChartItem::Post(_, at) => self.around(*at),
                    ChartItem::Var(_) | ChartItem::Step(_) | ChartItem::Transition(_) => {}
                }
            }
        }
        for item in &document.items {
            match item {
                Item::Action(a) => self.named(None, a),
                Item::Section(s) => self.section(None, s),
                Item::Pre(_, at) | Item::Post(_, at) => self.around(*at),
                Item::Use(u) => self.speech.cannot(u.at, say!("a file that is used was not read")),
                Item::Function(f) => self.speech.cannot(f.at, say!("a function")),
                Item::Target(_, at) => self.speech.leave_out(*at, say!("a target")),
                Item::Plant(p) => self.speech.leave_out(p.at, say!("a plant")),
                Item::Test(t) => self.speech.leave_out(t.at, say!("a test")),
                Item::Prove(p) => self.speech.leave_out(p.at, say!("a property")),
                Item::Cycle(_, at) => {
                    let what = say!("the time of a scan is left out: it belongs to the task MAST there");
                    self.speech.say(&g7_model::codes::LEFT_OUT, *at, what);
                }
                Item::Profile(_)
                | Item::Var(_)
                | Item::Chart(_)
                | Item::Instance(_)
                | Item::Composed(_)
                | Item::Type(_)
                | Item::Layout(_) => {}
            }
        }
        let ident =
            Element::new("identProgram").with("name", &title).with("type", "section").with("task", "MAST");
        let program = Element::new("SFCProgram").with("areaNum", 0).with("operatorCtrl", 0).child(ident);
        let sections = std::mem::take(&mut self.action_sections);
        let transitions = std::mem::take(&mut self.transition_sections);
        (title, program.children(drawings).children(sections).children(transitions))
    }

    /// Refuses `pre` and `post`: they are sections of their own there.
    fn around(&mut self, at: g7_model::Place) {
        let what = say!(
            "a body before or behind the evolution: a section in SFC has none; write it as a section in Structured Text"
        );
        self.speech.say(&g7_model::codes::NOT_CARRIED, at, what);
    }

    /// The charts that are written: the first one, then the expansions that it needs.
    fn order(&self) -> Vec<usize> {
        let kinds = self.speech.scopes.charts.iter().enumerate();
        let first = kinds.clone().find(|(_, c)| c.kind == ChartKind::Chart).map(|(i, _)| i);
        let inner = kinds.filter(|(i, c)| c.kind == ChartKind::Expansion && self.owners.contains_key(i));
        first.into_iter().chain(inner.map(|(i, _)| i)).collect()
    }
}

/// The macro-step of each expansion, the first if there are several.
fn owners(scopes: &Scopes) -> BTreeMap<usize, StepKey> {
    let mut owners = BTreeMap::new();
    for (key, _) in (0..scopes.charts.len()).flat_map(|c| scopes.steps_of(c)) {
        if let Some(inner) = scopes.expansion(key) {
            owners.entry(inner).or_insert(key);
        }
    }
    owners
}
