//! A draft: a copy of the document that a gesture changes, and the texts of its new parts as the
//! user typed them.
//!
//! A part that comes from the text keeps its place in the text; a new part gets a place in a file
//! of its own ([`FRESH`]). The writer compares these places to find out which parts stayed, which
//! were removed and which were added.

use std::collections::HashMap;

use g7_model::{
    Chart, ChartItem, Document, Expr, ExprKind, FileId, Item, Literal, Name, Place, Said, Span, Step,
    StepKind, Transition, say,
};

use crate::change::{Anchors, Refusal, Source, refuse};
use crate::id::ItemId;
use crate::splice::Splice;

/// The file in which all new parts have their places.
pub(crate) const FRESH: FileId = FileId(u32::MAX);

/// A part to be selected after the gesture.
#[derive(Clone, Debug)]
pub(crate) enum Mark {
    Id(ItemId),
    /// A transition of a chart; its number is known only at the end of the gesture.
    Transition(String, Span),
}

/// A document that is being changed.
pub(crate) struct Draft<'s> {
    pub(crate) source: &'s Source<'s>,
    pub(crate) anchors: Anchors<'s>,
    pub(crate) doc: Document,
    /// The texts of new parts, by their places.
    pub(crate) raw: HashMap<u32, String>,
    /// Further changes of names, which the comparison of documents does not find.
    pub(crate) besides: Vec<Splice>,
    pub(crate) select: Vec<Mark>,
    pub(crate) begin: Option<Mark>,
    /// Sentences for the user.
    pub(crate) told: Vec<Said>,
    fresh: u32,
}

impl<'s> Draft<'s> {
    pub(crate) fn new(source: &'s Source<'s>, anchors: Anchors<'s>) -> Draft<'s> {
        Draft {
            source,
            anchors,
            doc: source.document.clone(),
            raw: HashMap::new(),
            besides: Vec::new(),
            select: Vec::new(),
            begin: None,
            told: Vec::new(),
            fresh: 0,
        }
    }

    /// A place for a new part.
    pub(crate) fn fresh(&mut self) -> Place {
        self.fresh += 1;
        Place(Span { file: FRESH, start: self.fresh, end: self.fresh })
    }

    /// A place for a new part that is written as `raw`.
    pub(crate) fn fresh_as(&mut self, raw: impl Into<String>) -> Place {
        let at = self.fresh();
        self.raw.insert(at.0.start, raw.into());
        at
    }

    /// The text of a new part as it was typed.
    pub(crate) fn typed(&self, at: Span) -> Option<String> {
        self.raw.get(&at.start).filter(|_| is_fresh(at.into())).cloned()
    }

    pub(crate) fn chart(&self, name: &str) -> Result<&Chart, Refusal> {
        self.doc.charts().find(|c| *c.name.text == *name).ok_or_else(|| no_chart(name))
    }

    pub(crate) fn chart_mut(&mut self, name: &str) -> Result<&mut Chart, Refusal> {
        let found = self.doc.items.iter_mut().find_map(|i| match i {
            Item::Chart(c) if *c.name.text == *name => Some(c),
            _ => None,
        });
        found.ok_or_else(|| no_chart(name))
    }

    pub(crate) fn step(&self, chart: &str, name: &str) -> Result<&Step, Refusal> {
        let found = self.chart(chart)?.steps().find(|s| *s.name.text == *name);
        found.ok_or_else(|| no_step(chart, name))
    }

    pub(crate) fn step_mut(&mut self, chart: &str, name: &str) -> Result<&mut Step, Refusal> {
        let found = self.chart_mut(chart)?.items.iter_mut().find_map(|i| match i {
            ChartItem::Step(s) if *s.name.text == *name => Some(s),
            _ => None,
        });
        found.ok_or_else(|| no_step(chart, name))
    }

    /// The place in the text of a transition, given its number; it identifies the transition.
    pub(crate) fn number(&self, chart: &str, number: usize) -> Result<Span, Refusal> {
        match self.chart(chart)?.transitions().nth(number) {
            Some(t) => Ok(t.at.0),
            None => refuse(say!("chart `{chart}` has no transition number {number}")),
        }
    }

    pub(crate) fn transition(&self, chart: &str, at: Span) -> Result<&Transition, Refusal> {
        let found = self.chart(chart)?.transitions().find(|t| t.at.0 == at);
        found.ok_or_else(|| Refusal::new(say!("chart `{chart}` does not have this transition")))
    }

    pub(crate) fn transition_mut(&mut self, chart: &str, at: Span) -> Result<&mut Transition, Refusal> {
        let found = self.chart_mut(chart)?.items.iter_mut().find_map(|i| match i {
            ChartItem::Transition(t) if t.at.0 == at => Some(t),
            _ => None,
        });
        found.ok_or_else(|| Refusal::new(say!("chart `{chart}` does not have this transition")))
    }

    // New parts

    /// A name that no step of the chart has: the next number if the names of steps are numbers,
    /// otherwise `Step1` and so on.
    pub(crate) fn step_name(&self, chart: &Chart) -> String {
        let taken = |name: &str| chart.steps().any(|s| *s.name.text == *name);
        let number = |s: &Step| s.name.text.parse::<u64>().ok().filter(|n| *n < u64::MAX / 2);
        let plain: Vec<&Step> =
            chart.steps().filter(|s| !matches!(s.kind, StepKind::Entry | StepKind::Exit)).collect();
        let numbers = plain.iter().filter_map(|s| macro_number(s).or_else(|| number(s))).max();
        if plain.iter().all(|s| macro_number(s).or_else(|| number(s)).is_some()) {
            return free(numbers.map_or(1, |n| n + 1), String::new(), taken);
        }
        free(1, "Step".to_owned(), taken)
    }

    /// A name that no chart of the document has.
    pub(crate) fn chart_name(&self, base: &str) -> String {
        let taken = |name: &str| self.doc.charts().any(|c| *c.name.text == *name);
        if taken(base) { free(2, base.to_owned(), taken) } else { base.to_owned() }
    }

    pub(crate) fn new_step(&mut self, name: &str) -> Step {
        Step {
            name: Name { text: name.into(), at: self.fresh() },
            kind: StepKind::Plain,
            initial: false,
            linked: false,
            comment: None,
            actions: Vec::new(),
            braces: false,
            at: self.fresh(),
        }
    }

    /// A new transition whose receptivity is always true.
    pub(crate) fn new_transition(&mut self, from: &[&str], to: &[&str]) -> Transition {
        let list = |d: &mut Self, names: &[&str]| names.iter().map(|n| d.new_name(n)).collect();
        Transition {
            label: None,
            from: list(self, from),
            to: list(self, to),
            receptivity: self.always(),
            priority: None,
            comment: None,
            on_clearing: None,
            chained: false,
            at: self.fresh(),
        }
    }

    /// The receptivity `TRUE`.
    pub(crate) fn always(&mut self) -> Expr {
        Expr { kind: ExprKind::Literal(Literal::Bool(true)), at: self.fresh() }
    }

    pub(crate) fn new_name(&mut self, name: &str) -> Name {
        Name { text: name.into(), at: self.fresh() }
    }

    // Selection

    pub(crate) fn select(&mut self, id: ItemId) {
        self.select.push(Mark::Id(id));
    }

    pub(crate) fn select_step(&mut self, chart: &str, name: &str) {
        self.select(ItemId::step(chart, name));
    }

    pub(crate) fn begin_transition(&mut self, chart: &str, at: Place) {
        self.begin = Some(Mark::Transition(chart.to_owned(), at.0));
    }

    /// The id of a mark, after the numbers of transitions are final.
    pub(crate) fn resolved(&self, mark: &Mark) -> Option<ItemId> {
        match mark {
            Mark::Id(id) => Some(id.clone()),
            Mark::Transition(chart, at) => {
                let n = self.chart(chart).ok()?.transitions().position(|t| t.at.0 == *at)?;
                Some(ItemId::transition(chart, n))
            }
        }
    }
}

/// The number in the name of a macro-step such as `M3`.
fn macro_number(step: &Step) -> Option<u64> {
    let StepKind::Macro(_) = step.kind else { return None };
    step.name.text.strip_prefix('M')?.parse().ok().filter(|n| *n < u64::MAX / 2)
}

/// The first of `base1`, `base2`, … that is not taken; the count starts at `first`.
fn free(first: u64, base: String, taken: impl Fn(&str) -> bool) -> String {
    (first..).map(|n| format!("{base}{n}")).find(|n| !taken(n)).unwrap_or(base)
}

fn no_chart(name: &str) -> Refusal {
    Refusal::new(say!("there is no chart `{name}`"))
}

fn no_step(chart: &str, name: &str) -> Refusal {
    Refusal::new(say!("chart `{chart}` has no step `{name}`"))
}

/// True if a part is new.
pub(crate) fn is_fresh(at: Place) -> bool {
    at.0.file == FRESH
}
