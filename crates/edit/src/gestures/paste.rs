//! Pastes a copied part. Names that already exist are replaced by new ones in the pasted text and
//! in all references inside it.

use std::collections::BTreeSet;

use g7_compile::{Definition, references};
use g7_model::{
    Chart, ChartItem, ChartKind, Document, FileId, Item, Layout, PlaceAt, Placed, Said, Span, Step, StepKind,
    Transition, VarDecl, say,
};

use super::graph::put_step;
use super::rename::written;
use super::table::{declares, put_variable};
use super::{layout_section, notes, places};
use crate::change::{Refusal, refuse};
use crate::difference::reindent;
use crate::draft::{Draft, Mark};
use crate::id::ItemId;
use crate::needs::needs;
use crate::splice::spliced;
use g7_syntax::{Part, print_part};

/// Greatest length of a pasted text, in bytes.
const MOST: usize = 1 << 20;

#[inline(never)]
pub(crate) fn paste(d: &mut Draft<'_>, chart: &str, text: &str, at: Option<[f64; 2]>) -> Result<(), Refusal> {
    d.chart(chart)?;
    let (text, doc) = fragment(text)?;
    let (text, doc) = without_clashes(d, chart, text, doc)?;
    let mut charts = doc.charts();
    let Some(part) = charts.next() else { return refuse(say!("there is nothing to paste")) };
    let mut pasted = Pasted::default();
    for item in &part.items {
        match item {
            ChartItem::Step(s) => {
                pasted.steps.push(s.name.text.to_string());
                paste_step(d, chart, &text, s)?;
            }
            ChartItem::Transition(t) => pasted.transitions.push(paste_transition(d, chart, &text, t)?),
            // `declare` adds the variables that are needed.
            ChartItem::Var(_) => {}
            _ => return refuse(say!("only steps and transitions are pasted into a chart")),
        }
    }
    for expansion in charts {
        paste_chart(d, &text, expansion);
    }
    declare(d, chart, &doc)?;
    let at = at.map(layout_section::point).transpose()?;
    pasted.put(d, chart, layout_section::layout(&doc, &part.name.text), at)?;
    if d.select.is_empty() {
        return refuse(say!("there is nothing to paste"));
    }
    Ok(())
}

/// The steps and transitions of the pasted text, in its order, as they are in the chart now.
#[derive(Default)]
struct Pasted {
    steps: Vec<String>,
    transitions: Vec<Span>,
}

/// Offset of a pasted comment from the original if no place is given, in hundredths of a unit.
const BESIDE: i32 = 200;

impl Pasted {
    /// Places all parts at `at`, arranged as on the drawing from which they were copied.
    #[inline(never)]
    fn put(
        &self,
        d: &mut Draft<'_>,
        chart: &str,
        layout: Option<&Layout>,
        at: Option<(i32, i32)>,
    ) -> Result<(), Refusal> {
        let places = layout.map_or(&[][..], |l| l.places.as_slice());
        let id = |d: &Draft<'_>, what: &Placed| match what {
            Placed::Step(name) => Some(ItemId::step(chart, &*name.text)),
            Placed::TransitionNumber(n) => self.id(d, chart, *self.transitions.get(*n as usize)?),
            Placed::Transition(label) => {
                let all = d.chart(chart).ok()?.transitions();
                let found = all.filter(|t| t.label.as_ref() == Some(label)).map(|t| t.at.0);
                self.id(d, chart, found.last()?)
            }
            _ => None,
        };
        let known: Vec<(&PlaceAt, Option<ItemId>)> = places.iter().map(|p| (p, id(d, &p.what))).collect();
        let first = known.iter().find(|(p, _)| matches!(p.what, Placed::Step(_))).or(known.first());
        let (dx, dy) = match (first, at) {
            (Some((p, _)), Some((x, y))) => (x.saturating_sub(p.x), y.saturating_sub(p.y)),
            _ => (BESIDE, BESIDE),
        };
        for (p, id) in &known {
            let (x, y) = (p.x.saturating_add(dx), p.y.saturating_add(dy));
            match (&p.what, id) {
                (Placed::Comment(text), _) => notes::put(d, chart, text, (x, y)),
                // Without a given place, the layout places the symbols.
                (_, Some(id)) if at.is_some() => places::place(d, id, (x, y))?,
                _ => {}
            }
        }
        let placed = known.iter().any(|(p, _)| p.what.is_symbol());
        match (self.steps.first(), at) {
            (Some(step), Some(at)) if !placed => places::place(d, &ItemId::step(chart, step.as_str()), at),
            _ => Ok(()),
        }
    }

    fn id(&self, d: &Draft<'_>, chart: &str, at: Span) -> Option<ItemId> {
        let n = d.chart(chart).ok()?.transitions().position(|t| t.at.0 == at)?;
        self.transitions.contains(&at).then(|| ItemId::transition(chart, n))
    }
}

/// Declares the names that the pasted text needs and the file does not have. Existing declarations
/// stay; the user is told if they differ.
#[inline(never)]
fn declare(d: &mut Draft<'_>, chart: &str, doc: &Document) -> Result<(), Refusal> {
    let places: Vec<Span> = doc.charts().map(|c| c.at.0).collect();
    let first = doc.charts().next().map(|c| c.name.text.to_string());
    let own = doc.charts().next().into_iter().flat_map(Chart::vars).cloned();
    let own = own.map(|v| (first.clone(), v));
    for (home, v) in needs(doc, &places).into_iter().chain(own) {
        let mut missing = v.clone();
        missing.names.clear();
        for name in &v.names {
            match meaning(d, chart, &name.text) {
                None => missing.names.push(name.clone()),
                Some(Meaning::Variable(there)) if same(&there, &v) => {}
                Some(Meaning::Variable(there)) => d.told.push(say!(
                    "`{}` is declared here as `{}`; the pasted part had it as `{}`: the declaration here was kept",
                    name.text,
                    sort(&there),
                    sort(&v)
                )),
                Some(Meaning::Other(what)) => d.told.push(say!(
                    "`{}` is {what} here; the variable of the pasted part was not declared",
                    name.text
                )),
            }
        }
        if !missing.names.is_empty() {
            missing.at = d.fresh();
            missing.names.iter_mut().for_each(|n| n.at = d.fresh());
            put_variable(d, home.is_some().then_some(chart), missing)?;
        }
    }
    Ok(())
}

/// The present meaning of a name.
enum Meaning {
    Variable(Box<VarDecl>),
    Other(Said),
}

#[inline(never)]
fn meaning(d: &Draft<'_>, chart: &str, name: &str) -> Option<Meaning> {
    let home = d.chart(chart).ok()?;
    let own = home.vars().find(|v| declares(v, name));
    let of_file = d.doc.items.iter().find_map(|i| match i {
        Item::Var(v) if declares(v, name) => Some(v),
        _ => None,
    });
    if let Some(v) = own.or(of_file) {
        return Some(Meaning::Variable(Box::new(v.clone())));
    }
    d.doc.items.iter().find_map(|i| match i {
        Item::Chart(c) if *c.name.text == *name => Some(Meaning::Other(say!("a chart"))),
        Item::Action(a) if *a.name.text == *name => Some(Meaning::Other(say!("an action"))),
        Item::Section(s) if *s.name.text == *name => Some(Meaning::Other(say!("a transition section"))),
        Item::Function(f) if *f.name.text == *name => Some(Meaning::Other(say!("a function"))),
        _ => None,
    })
}

/// True if two declarations mean the same to a chart; addresses and comments do not matter.
fn same(a: &VarDecl, b: &VarDecl) -> bool {
    (a.kind, &a.ty, &a.init, a.retain) == (b.kind, &b.ty, &b.init, b.retain)
}

/// Describes a declaration: class, type and initial value.
fn sort(v: &VarDecl) -> String {
    let bare = VarDecl { address: None, inverted: false, safe: None, comment: None, ..v.clone() };
    let text = print_part(Part::Variable(&bare), None);
    let names = v.names.iter().map(|n| g7_syntax::show_name(&n.text)).collect::<Vec<_>>().join(", ");
    text.replacen(&format!("{names} : "), "", 1)
}

/// Reads the text to paste: a small file, or only the lines of a chart.
#[inline(never)]
fn fragment(text: &str) -> Result<(String, Document), Refusal> {
    if text.len() > MOST {
        return refuse(say!("this is too long to be pasted into a chart"));
    }
    let (doc, problems) = g7_syntax::parse(text, FileId(0));
    if problems.is_empty() && doc.charts().next().is_some() {
        return Ok((text.to_owned(), doc));
    }
    let wrapped = format!("chart Fragment {{\n{text}\n}}\n");
    let (doc, problems) = g7_syntax::parse(&wrapped, FileId(0));
    match problems.first() {
        Some(_) => refuse(say!("this is not a part of a chart")),
        None => Ok((wrapped, doc)),
    }
}

/// The text with new names for steps, labels and expansions whose names already exist.
#[inline(never)]
fn without_clashes(
    d: &Draft<'_>,
    chart: &str,
    text: String,
    doc: Document,
) -> Result<(String, Document), Refusal> {
    let Some(part) = doc.charts().next() else { return Ok((text, doc)) };
    let home = d.chart(chart)?;
    let owner = part.name.text.to_string();
    let steps = |c: &Chart| c.steps().map(|s| s.name.text.to_string()).collect::<BTreeSet<_>>();
    let labels = |c: &Chart| {
        c.transitions().filter_map(|t| t.label.as_ref()).map(|l| l.text.to_string()).collect::<BTreeSet<_>>()
    };
    let mut new: Vec<(Definition, String)> = Vec::new();
    for (name, to) in fresh_names(&steps(home), &steps(part)) {
        new.push((Definition::Step { chart: owner.clone(), name }, to));
    }
    for (label, to) in fresh_names(&labels(home), &labels(part)) {
        new.push((Definition::Transition { chart: owner.clone(), label }, to));
    }
    let there: BTreeSet<String> = d.doc.charts().map(|c| c.name.text.to_string()).collect();
    let brought: BTreeSet<String> = doc.charts().skip(1).map(|c| c.name.text.to_string()).collect();
    for (name, to) in fresh_names(&there, &brought) {
        new.push((Definition::Chart(name), to));
    }
    if new.is_empty() {
        return Ok((text, doc));
    }
    let refs = references(&doc);
    let mut splices = Vec::new();
    for (definition, to) in &new {
        for found in refs.uses_of(definition) {
            splices.push(written(&text, found, to)?);
        }
    }
    splices.sort_by_key(|s| (s.start, s.end));
    let text = spliced(&text, &splices).ok_or_else(|| Refusal::new(say!("this is not a part of a chart")))?;
    let (doc, problems) = g7_syntax::parse(&text, FileId(0));
    if problems.is_empty() { Ok((text, doc)) } else { refuse(say!("this is not a part of a chart")) }
}

/// New names for those that already exist: the next number, or the name with a number appended.
#[inline(never)]
fn fresh_names(there: &BTreeSet<String>, brought: &BTreeSet<String>) -> Vec<(String, String)> {
    let mut taken: BTreeSet<String> = there.union(brought).cloned().collect();
    let number = |n: &String| n.trim_start_matches('M').parse::<u64>().ok().filter(|n| *n < u64::MAX / 2);
    let mut next = taken.iter().filter_map(number).max().unwrap_or(0) + 1;
    let mut by_number: Vec<&String> = there.intersection(brought).collect();
    by_number.sort_by_key(|n| number(n));
    let mut pairs = Vec::new();
    for name in by_number {
        let to = match number(name) {
            Some(_) => {
                let to = format!("{}{next}", if name.starts_with('M') { "M" } else { "" });
                next += 1;
                to
            }
            None => (2u64..).map(|n| format!("{name}{n}")).find(|n| !taken.contains(n)).unwrap_or_default(),
        };
        taken.insert(to.clone());
        pairs.push((name.clone(), to));
    }
    pairs
}

fn slice(text: &str, at: Span) -> &str {
    text.get(at.start as usize..at.end as usize).unwrap_or_default()
}

/// The text of a part, without the indentation of its first line.
fn lines(text: &str, at: Span) -> String {
    let start = text.get(..at.start as usize).unwrap_or_default();
    let line = start.rsplit('\n').next().unwrap_or_default();
    let indent = line.len() - line.trim_start().len();
    reindent(slice(text, at), line.get(..indent).unwrap_or_default(), "", "\n")
}

#[inline(never)]
fn paste_step(d: &mut Draft<'_>, chart: &str, text: &str, step: &Step) -> Result<(), Refusal> {
    let home = d.chart(chart)?.kind;
    let mut new = step.clone();
    let mut raw = lines(text, step.at.0);
    if matches!(step.kind, StepKind::Entry | StepKind::Exit) {
        // A chart has neither entry nor exit step; an expansion already has its own.
        let of_kind = d.chart(chart)?.steps().any(|s| s.kind == step.kind);
        if home == ChartKind::Chart || of_kind {
            let words = (step.name.at.0.start - step.at.0.start) as usize;
            let initial = if step.initial { "initial " } else { "" };
            raw = format!("{initial}step {}", raw.get(words..).unwrap_or_default());
            new.kind = StepKind::Plain;
        }
    }
    new.at = d.fresh_as(raw);
    put_step(d, chart, new, None)?;
    d.select_step(chart, &step.name.text);
    Ok(())
}

#[inline(never)]
fn paste_transition(d: &mut Draft<'_>, chart: &str, text: &str, t: &Transition) -> Result<Span, Refusal> {
    let mut new = t.clone();
    let lead = if t.chained { print_part(Part::Steps(&t.from), None) + " " } else { String::new() };
    new.chained = false;
    new.at = d.fresh_as(lead + &lines(text, t.at.0));
    let at = new.at.0;
    d.select.push(Mark::Transition(chart.to_owned(), new.at.0));
    let items = &mut d.chart_mut(chart)?.items;
    let last = items.iter().rposition(|i| matches!(i, ChartItem::Transition(_)));
    let last = last.or_else(|| items.iter().rposition(|i| matches!(i, ChartItem::Step(_))));
    items.insert(last.map_or(items.len(), |k| k + 1), ChartItem::Transition(new));
    Ok(at)
}

/// Adds the expansion that a pasted macro-step needs.
fn paste_chart(d: &mut Draft<'_>, text: &str, chart: &Chart) {
    let mut new = chart.clone();
    new.at = d.fresh_as(lines(text, chart.at.0));
    let last = d.doc.items.iter().rposition(|i| matches!(i, Item::Chart(_)));
    d.doc.items.insert(last.map_or(0, |k| k + 1), Item::Chart(new));
}
