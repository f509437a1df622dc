//! The names in the file. Variables, steps and sections of a project share one space of names there,
//! and capital and small letters are the same.

use std::collections::HashMap;

use g7_iec::nodes::Taken;
use g7_iec::scopes::{Scopes, StepKey, VarKey};
use g7_iec::words;
use g7_model::{ChartItem, Document, Item, Name, Span};

use crate::controlexpert::dialect;

/// The most letters of a name.
const LONGEST: usize = 32;

/// The names of a document.
#[derive(Default)]
pub(super) struct Names<'d> {
    taken: Taken,
    vars: HashMap<VarKey<'d>, String>,
    steps: HashMap<StepKey, String>,
    /// Named actions and transition sections.
    parts: HashMap<VarKey<'d>, String>,
    /// Changed names: the place, the old and the new name.
    pub(super) renamed: Vec<(Span, Box<str>, String)>,
}

impl<'d> Names<'d> {
    pub(super) fn new(document: &'d Document, scopes: &Scopes<'d>) -> Names<'d> {
        let mut names = Names::default();
        for item in &document.items {
            if let Item::Var(v) = item {
                v.names.iter().for_each(|n| names.give_var(None, n));
            }
        }
        for (number, chart) in scopes.charts.iter().enumerate() {
            for (key, step) in scopes.steps_of(number) {
                let digit = step.name.text.starts_with(|c: char| c.is_ascii_digit());
                let wish = if digit { format!("S{}", step.name.text) } else { step.name.text.to_string() };
                let text = names.give(&step.name, &wish, &chart.name.text);
                names.steps.insert(key, text);
            }
            chart.vars().flat_map(|v| &v.names).for_each(|n| names.give_var(Some((number, &chart.name)), n));
        }
        for item in &document.items {
            match item {
                Item::Action(a) => names.give_part(None, &a.name),
                Item::Section(s) => names.give_part(None, &s.name),
                _ => {}
            }
        }
        for (number, chart) in scopes.charts.iter().enumerate() {
            for item in &chart.items {
                match item {
                    ChartItem::Action(a) => names.give_part(Some((number, &chart.name)), &a.name),
                    ChartItem::Section(s) => names.give_part(Some((number, &chart.name)), &s.name),
                    _ => {}
                }
            }
        }
        names
    }

    fn give_var(&mut self, home: Option<(usize, &Name)>, name: &'d Name) {
        let text = self.give(name, &name.text, home.map_or("", |h| &h.1.text));
        self.vars.insert((home.map(|h| h.0), &name.text), text);
    }

    fn give_part(&mut self, home: Option<(usize, &Name)>, name: &'d Name) {
        let text = self.give(name, &name.text, home.map_or("", |h| &h.1.text));
        self.parts.insert((home.map(|h| h.0), &name.text), text);
    }

    /// The author's name if it is free; otherwise with the name of its chart before it.
    fn give(&mut self, name: &Name, wish: &str, home: &str) -> String {
        let plain = fitting(wish);
        let text = if self.taken.has(&plain) && !home.is_empty() {
            self.free(&format!("{home}_{plain}"))
        } else {
            self.free(&plain)
        };
        if *text != *name.text {
            self.renamed.push((name.at.0, name.text.clone(), text.clone()));
        }
        text
    }

    /// A free name for something that the document does not have.
    pub(super) fn free(&mut self, wish: &str) -> String {
        let plain = fitting(wish);
        let short: String = plain.chars().take(LONGEST - 6).collect();
        if self.taken.has(&plain) { self.taken.give(&short) } else { self.taken.give(&plain) }
    }

    pub(super) fn var(&self, key: VarKey<'d>) -> &str {
        self.vars.get(&key).map_or("", String::as_str)
    }

    pub(super) fn step(&self, key: StepKey) -> &str {
        self.steps.get(&key).map_or("", String::as_str)
    }

    pub(super) fn part(&self, chart: Option<usize>, name: &'d str) -> &str {
        self.parts.get(&(chart, name)).map_or("", String::as_str)
    }
}

/// The name if it is valid in the file, otherwise a valid name made from it.
pub(super) fn fitting(name: &str) -> String {
    let starts = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    let plain =
        starts && name.len() <= LONGEST && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let text = if plain { name.to_string() } else { words::identifier(name) };
    let text: String = text.chars().take(LONGEST).collect();
    let reserved = words::everywhere().any(|w| w.eq_ignore_ascii_case(&text)) || dialect::is_word(&text);
    if reserved { format!("{}_2", text.chars().take(LONGEST - 2).collect::<String>()) } else { text }
}
