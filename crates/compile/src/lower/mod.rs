//! From a resolved unit to the tables of a program.
//!
//! ```text
//! ir::Unit -> uses (one look at everything)
//!          -> plan (which step is which) -> words (which word is which)
//!          -> charts, actions, transitions, system bits; their code as trees
//!             (terms, stmts), then as instructions (emit, pieces)
//!          -> watches' readers -> Tables, Symbols, Pieces
//! ```
//!
//! All of them write into one `Lower` (work).
//!
//! Macro-steps, tasks, `enable`, `mask` and freezing end here: they become arcs,
//! guards and conditions. So do the profiles: what follows knows only
//! [`g7_engine::Rules`] and the tables. Nothing here depends on the profile's
//! name, on the clock, or on the order of a hash.

mod actions;
mod associations;
mod charts;
mod distinct;
mod emit;
mod lists;
mod names;
mod pieces;
mod plan;
mod stmts;
mod system;
mod terms;
mod transitions;
mod uses;
mod watched;
mod watches;
mod words;
mod work;

use std::collections::BTreeMap;

use g7_engine::{Addr, Code, Extra, LoadError, NONE, Program, Rows, Step, Tables};
use g7_model::{Problem, Said, Span, codes, say};

use crate::ir::{ChartId, Expr, StepId, Unit};
use crate::symbols::Symbols;
use crate::tree::Piece;
use emit::Buf;
use plan::Plan;
use watched::Watches;
use words::Words;
use work::{Lower, Refusal};

pub use pieces::with_parts;
pub use words::{num, words_for, words_of};

/// The tables of a unit and what their rows are called.
#[derive(Clone, Debug)]
pub struct Lowered {
    /// The tables.
    pub tables: Tables,
    /// Names and places.
    pub symbols: Symbols,
    /// A code for each query, in their order.
    pub queries: Vec<Code>,
    /// The tree of each piece of code.
    pub pieces: Pieces,
}

/// The trees of a program's code.
#[derive(Clone, Debug, Default)]
pub struct Pieces(Vec<(u32, Piece)>);

impl Pieces {
    /// A piece of code; `None` for an empty one.
    pub fn get(&self, code: Code) -> Option<&Piece> {
        let at = self.0.binary_search_by_key(&code.start, |p| p.0).ok()?;
        self.0.get(at).filter(|_| !code.is_empty()).map(|p| &p.1)
    }

    /// All of them, in the order of the code.
    pub fn iter(&self) -> impl Iterator<Item = &Piece> {
        self.0.iter().map(|p| &p.1)
    }
}

/// Lowers a unit, and queries on it, to a program with its symbols.
///
/// # Errors
///
/// A problem with its place where the unit is too large or nested too deeply
/// for the engine.
pub fn program(unit: &Unit, queries: &[Expr]) -> Result<(Program, Symbols, Vec<Code>, Pieces), Problem> {
    let Lowered { tables, symbols, queries, pieces } = lower(unit, queries)?;
    match Program::new(tables) {
        Ok(program) => Ok((program, symbols, queries, pieces)),
        Err(error) => Err(refused_by_engine(error, &symbols)),
    }
}

#[inline(never)]
fn refused_by_engine(error: LoadError, symbols: &Symbols) -> Problem {
    match error {
        LoadError::Deep { at } => deep(symbols.place(at)),
        LoadError::Large { table } => Problem::new(
            &codes::TOO_LARGE,
            Span::default(),
            say!("the program would be too large ({})", Said::foreign(table)),
        ),
        // The tables made here are right; this says which are not, should one be wrong.
        other => {
            Problem::new(&codes::TOO_LARGE, Span::default(), say!("the program cannot be loaded: {other:?}"))
        }
    }
}

fn deep(at: Span) -> Problem {
    Problem::new(&codes::TOO_DEEP, at, say!("this is nested too deeply to be run"))
        .help(say!("give a part of it a variable of its own"))
}

/// Lowers a unit, and queries on it, to tables.
///
/// # Errors
///
/// A problem with its place where the unit is too large or nested too deeply.
#[inline(never)]
pub fn lower<'a>(unit: &'a Unit, queries: &'a [Expr]) -> Result<Lowered, Problem> {
    let uses = uses::uses(unit, queries);
    let plan = Plan::new(unit, &uses);
    let words = Words::new(unit);
    if let Some(step) = plan.too_deep {
        return Err(deep(unit.steps.get(step.index()).map(|s| s.at).unwrap_or_default()));
    }
    if let Some(var) = words.full {
        let at = unit.vars.get(var.index()).map(|v| v.at).unwrap_or_default();
        return Err(Problem::new(&codes::TOO_LARGE, at, say!("the variables take too much room")));
    }
    let mut l = Lower {
        unit,
        uses,
        plan,
        words,
        t: Tables { rules: unit.rules, ..Tables::default() },
        places: Vec::new(),
        watches: Watches::default(),
        buf: Buf::default(),
        pieces: Vec::new(),
        nodes: 0,
        locals: 0,
        depth: 0,
        refused: None,
        random: None,
        stop_all: None,
        restarts: None,
        fresh: None,
        periods: Vec::new(),
        enabling: Vec::new(),
        masked_charts: Vec::new(),
        masked_vars: BTreeMap::new(),
        callers: Vec::new(),
        owners: Vec::new(),
        freezes: Vec::new(),
        section: None,
        has_blockers: false,
        has_masks: false,
    };
    let (mut symbols, queries) = l.all(queries);
    if let Some((refusal, at)) = l.refused {
        return Err(match refusal {
            Refusal::Deep => deep(at),
            Refusal::Large => {
                Problem::new(&codes::TOO_LARGE, at, say!("the program would have too many instructions"))
                    .help(say!("functions are written out at each call: call fewer of them from each other"))
            }
        });
    }
    l.t.init = l.words.init;
    symbols.places = l.places;
    Ok(Lowered { tables: l.t, symbols, queries, pieces: Pieces(l.pieces) })
}

impl Lower<'_> {
    #[inline(never)]
    fn all(&mut self, queries: &[Expr]) -> (Symbols, Vec<Code>) {
        self.t.code.reserve(self.uses.size);
        self.places.reserve(self.uses.size);
        if self.uses.random {
            self.random = Some(self.words.hidden(0));
        }
        self.look_at_system_bits();
        self.look_at_periods();
        self.look_at_orders();
        for text in std::mem::take(&mut self.uses.texts) {
            self.words.text(text);
        }
        self.locals = self.words.place_locals(self.unit);
        self.groups();
        self.t.steps = self.steps();
        let mut actions = self.actions();
        let ranks = self.ranks();
        self.transitions(&ranks, &actions.clearing);
        self.system();
        let queries: Vec<Code> = queries
            .iter()
            .map(|q| {
                let tree = self.expr(0, q);
                self.value(tree)
            })
            .collect();
        self.extras(&mut actions);
        let symbols = self.symbols(&ranks, &mut actions);
        let end = self.words.init.len() as u32;
        self.t.locals = if self.locals < end { Rows { start: self.locals, end } } else { Rows::default() };
        self.t.inputs = self.words.inputs;
        self.t.outputs = self.words.outputs;
        self.t.safe = std::mem::take(&mut self.words.safe);
        (symbols, queries)
    }

    /// The steps, as far as their charts.
    fn steps(&self) -> Vec<Step> {
        let chart_of = |id: &StepId| {
            let chart: Option<ChartId> = self.unit.steps.get(id.index()).map(|s| s.chart);
            chart.and_then(|c| self.plan.chart(c)).unwrap_or(0)
        };
        let row = |id| Step { out: Default::default(), direct: Addr(NONE), extra: NONE, chart: chart_of(id) };
        self.plan.source.iter().map(row).collect()
    }

    /// Gives each step what only few have.
    #[inline(never)]
    fn extras(&mut self, a: &mut actions::Actions) {
        let mut groups = self.counted_groups();
        let orders = self.orders();
        let (mut encloses, mut links) = self.enclosures();
        let mut watches = self.readers();
        for i in 0..self.t.steps.len() as u32 {
            let e = Extra {
                on: a.on.take(i, &mut self.t.action_lists),
                off: a.off.take(i, &mut self.t.action_lists),
                events: a.events.take(i, &mut self.t.events),
                periodics: a.periodics.take(i, &mut self.t.periodics),
                contributions: a.contributions.take(i, &mut self.t.contributions),
                groups: groups.take(i, &mut self.t.group_lists),
                orders: orders
                    .binary_search_by_key(&i, |o| o.0)
                    .ok()
                    .and_then(|k| orders.get(k))
                    .map(|o| o.1)
                    .unwrap_or_default(),
                encloses: encloses.take(i, &mut self.t.group_lists),
                links: links.take(i, &mut self.t.arcs),
                watches: watches.take(i, &mut self.t.watch_lists),
                uncounted: self.is_pseudo(i),
            };
            let lists = [
                e.on,
                e.off,
                e.events,
                e.periodics,
                e.contributions,
                e.groups,
                e.orders,
                e.encloses,
                e.links,
                e.watches,
            ];
            let Some(step) = self.t.steps.get_mut(i as usize) else { break };
            step.direct = a.direct.get(i as usize).copied().unwrap_or(Addr(NONE));
            if e.uncounted || lists.iter().any(|r| !r.is_empty()) {
                step.extra = self.t.extras.len() as u32;
                self.t.extras.push(e);
            }
        }
    }
}
