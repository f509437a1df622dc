//! What the tests reached: steps, transitions, actions, branches.

use std::collections::BTreeMap;

use g7_engine::{Addr, NONE, StepId};
use g7_host::Runner;
use g7_model::Span;

use crate::bench::Bench;
use crate::sources::Source;

/// A thing that tests can reach.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) name: String,
    /// `path:line:column`.
    pub(crate) place: String,
    /// Scans in which it was reached.
    pub(crate) hits: u64,
}

/// One sort of thing, in the order of the text.
pub(crate) type Rows = BTreeMap<Span, Row>;

/// What the tests of one file reached.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coverage {
    pub(crate) steps: Rows,
    pub(crate) transitions: Rows,
    pub(crate) actions: Rows,
    /// Transitions that share a preceding step: the ways of a divergence.
    pub(crate) branches: Rows,
}

impl Coverage {
    /// The four sorts with their headings.
    pub(crate) fn sorts(&self) -> [(&'static str, &Rows); 4] {
        [
            ("steps", &self.steps),
            ("transitions", &self.transitions),
            ("actions", &self.actions),
            ("branches", &self.branches),
        ]
    }

    /// Lists everything that is there.
    pub(super) fn learn(&mut self, bench: &Bench, source: &Source) {
        let symbols = &bench.compiled.symbols;
        let add = |rows: &mut Rows, at: Span, name: &str| {
            rows.entry(at).or_insert_with(|| Row { name: name.to_owned(), place: source.place(at), hits: 0 });
        };
        for step in (0..symbols.steps()).map(StepId).filter(|s| symbols.is_listed(*s)) {
            add(&mut self.steps, symbols.step_place(step), symbols.step_name(step));
        }
        for rank in (0..symbols.transitions()).filter(|r| symbols.is_written(*r)) {
            let text = symbols.transition_text(rank);
            let name = symbols.label(rank).map_or(text.to_owned(), |l| format!("{l}: {text}"));
            let at = symbols.transition_place(rank);
            add(&mut self.transitions, at, &name);
            if bench.compiled.program.tables().transitions.get(rank as usize).is_some_and(|t| t.shares) {
                add(&mut self.branches, at, &name);
            }
        }
        for action in symbols.actions.iter().filter(|a| !a.hidden) {
            add(&mut self.actions, action.at, &first_line(source, action.at));
        }
        for (block, symbol) in bench.compiled.program.tables().blocks.iter().zip(&symbols.blocks) {
            if block.output.0 != NONE {
                add(&mut self.actions, symbol.at, &symbol.name);
            }
        }
    }

    /// Takes in what the latest scan did.
    pub(super) fn see(&mut self, bench: &Bench, runner: &Runner<'_>) {
        let (symbols, state) = (&bench.compiled.symbols, runner.state());
        let tables = bench.compiled.program.tables();
        let hit = |rows: &mut Rows, at: Span| {
            if let Some(row) = rows.get_mut(&at) {
                row.hits += 1;
            }
        };
        for step in state.active() {
            hit(&mut self.steps, symbols.step_place(step));
        }
        for rank in state.cleared() {
            let at = symbols.transition_place(*rank);
            hit(&mut self.transitions, at);
            hit(&mut self.branches, at);
            // A step that was active only within the scan was reached as well.
            if let Some(t) = tables.transitions.get(*rank as usize) {
                let more = tables.arcs.get(t.more_to.start as usize..t.more_to.end as usize).unwrap_or(&[]);
                for step in std::iter::once(&t.to).chain(more).filter(|s| !state.is_active(**s)) {
                    hit(&mut self.steps, symbols.step_place(*step));
                }
            }
        }
        for rank in state.ran() {
            if let Some(action) = symbols.actions.get(*rank as usize) {
                hit(&mut self.actions, action.at);
            }
        }
        for (block, symbol) in tables.blocks.iter().zip(&symbols.blocks) {
            if block.output != Addr(NONE) && state.word(block.output) != 0 {
                hit(&mut self.actions, symbol.at);
            }
        }
    }
}

/// The author's words at a place, as far as one line goes.
fn first_line(source: &Source, at: Span) -> String {
    let text = source.text.get(source.range(at)).unwrap_or("");
    let line = text.lines().next().unwrap_or("").trim();
    if line.chars().count() > 40 { line.chars().take(39).chain(['…']).collect() } else { line.to_owned() }
}
