//! The page of function blocks: its charts, their runs and the chronograms of these.

use std::collections::BTreeMap;

use g7_draw::{Chronogram, Edge, Lane, LaneKind, Options, chronogram_svg};
use g7_model::{Document, FbKind, Item, Nanos, ProfileName, Type};

use crate::case::{self, Case, Line};
use crate::engine::engine;
use crate::naive::{Naive, Value};
use crate::replay::input_values;

/// The page, from the root of the repository.
pub const PAGE: &str = "docs/book/src/language/blocks.md";

/// The part of the page on one block.
pub struct Section {
    /// The block.
    pub kind: FbKind,
    /// The pins of its table: name and type.
    pub pins: Vec<(String, String)>,
    /// Its chart and run.
    pub case: Case,
}

/// Reads the page.
///
/// # Errors
///
/// If a section is not one of a block, or is not in the form of a case.
pub fn sections(page: &str) -> Result<Vec<Section>, String> {
    page.split("\n## ").skip(1).map(section).collect()
}

fn section(text: &str) -> Result<Section, String> {
    let name = text.split(':').next().unwrap_or("");
    let kind = FbKind::ALL.into_iter().find(|k| k.name() == name);
    let pin = |line: &str| {
        let mut cells = line.strip_prefix("| `")?.split('|').map(str::trim);
        Some((cells.next()?.trim_end_matches('`').to_owned(), cells.next()?.to_owned()))
    };
    Ok(Section {
        kind: kind.ok_or_else(|| format!("no block `{name}`"))?,
        pins: text.lines().filter_map(pin).collect(),
        case: case::read(&format!("# {text}")).map_err(|why| format!("{name}: {why}"))?,
    })
}

impl Section {
    /// The place of its picture beside the page.
    pub fn picture(&self) -> String {
        format!("blocks/{}.svg", self.kind.name().to_lowercase().replace('_', "-"))
    }

    /// Runs the chart by the engine and draws the pins of its instance. A pin that never
    /// changes, such as PV, has no lane.
    ///
    /// # Errors
    ///
    /// If the chart or its run is wrong.
    pub fn chronogram(&self) -> Result<String, String> {
        let document = case::document(&self.case.chart)?;
        let instance = instance(&document, self.kind).ok_or("the chart has no instance of the block")?;
        let names = Naive::new(&document, Some(ProfileName::Iec61131))?;
        let mut subject = engine(&document, Some(ProfileName::Iec61131), &[])?;
        let mut seen: Vec<(Nanos, BTreeMap<String, Value>)> = Vec::new();
        for line in self.case.traces.iter().flat_map(|t| &t.lines) {
            let Line::Row(row) = line else { return Err("a restart has no picture".into()) };
            let inputs = input_values(row, &names.inputs(), &names)?;
            subject.scan(&inputs, row.at).map_err(|fault| format!("line {}: {fault:?}", row.line))?;
            seen.push((Nanos::new(row.at), subject.variables()));
        }
        let lanes = self.kind.members().iter().map(|(pin, ty, _)| lane(&seen, &instance, pin, *ty));
        let lanes = lanes.filter(|lane| lane.edges.len() > 1).collect();
        let at = |row: Option<&(Nanos, _)>| row.map_or(Nanos::ZERO, |(at, _)| *at);
        // The values of the last scan hold for as long as those of the one before.
        let (from, last) = (at(seen.first()), at(seen.last()));
        let before = at(seen.iter().rev().nth(1));
        let to = last + (last - before);
        Ok(chronogram_svg(&Chronogram { lanes, from, to }, &Options { font: false, ..Options::default() }))
    }
}

/// The name of the variable that is an instance of a block.
fn instance(document: &Document, kind: FbKind) -> Option<String> {
    document.items.iter().find_map(|item| match item {
        Item::Var(v) if v.ty == Type::Fb(kind) => Some(v.names.first()?.text.to_string()),
        _ => None,
    })
}

fn lane(seen: &[(Nanos, BTreeMap<String, Value>)], instance: &str, pin: &str, ty: Type) -> Lane {
    let mut edges: Vec<Edge> = Vec::new();
    for (at, variables) in seen {
        let (value, show) = match variables.get(&format!("{instance}.{pin}")) {
            Some(Value::Bool(b)) => (f64::from(u8::from(*b)), b.to_string()),
            Some(Value::Int(n)) => (*n as f64, n.to_string()),
            Some(Value::Time(t)) => (*t as f64, Nanos::new(*t).plain()),
            _ => continue,
        };
        if edges.last().is_none_or(|e| e.show != show) {
            edges.push(Edge { at: *at, value, show });
        }
    }
    let kind = if ty == Type::Bool { LaneKind::Bool } else { LaneKind::Number };
    Lane { name: pin.to_owned(), kind, edges }
}
