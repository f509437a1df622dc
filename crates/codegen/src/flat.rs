//! The evolution as Boolean equations with memories: the flat style.
//!
//! What a pass judges and changes is the same as in the structured style, and so is
//! all that follows from it (`crates/runtime`): stored actions, enclosures, forcing, control
//! blocks. Only the way from the step memories to the marked changes is another.
//!
//! # Invariants
//!
//! - Receptivities are judged in the order of the engine: source transitions, then by
//!   step; the first fault is the one that is told.
//! - No equation reads what another of the same moment changes: all clearing conditions
//!   come before the first memory.

use std::collections::BTreeSet;

use g7_engine::{ControlBlock, NONE, StepId};

use crate::build::{Gen, s, state};
use crate::chart::call;
use crate::tree::{Bin, Block, Expr, Stmt, Ty};

/// Most terms that say which transitions go before which: a chart in which thousands
/// leave one step would be printed as their square.
const MOST_RIVALS: usize = 100_000;

impl Gen<'_> {
    /// Clearing conditions and step memories.
    pub(crate) fn flat_evolution(&mut self) {
        self.clearing_conditions();
        if !self.facts.sequential {
            self.step_memories();
        }
    }

    fn cf(&self, rank: u32) -> Expr {
        s().field("cf").at(self.transition(rank))
    }

    /// For each transition those that, clearable as well, keep it from clearing.
    fn rivals(&mut self) -> Vec<Vec<u32>> {
        let t = self.t;
        let rules = t.rules;
        let mut behind: Vec<Vec<u32>> = vec![Vec::new(); t.steps.len()];
        for (rank, tr) in (0u32..).zip(&t.transitions) {
            for step in self.ends(tr.from, tr.more_from) {
                if let Some(list) = behind.get_mut(step.0 as usize) {
                    list.push(rank);
                }
            }
        }
        let priority = |rank: u32| t.transitions.get(rank as usize).map_or(NONE, |x| x.priority);
        let mut terms = 0;
        let mut all = Vec::new();
        for (rank, tr) in (0u32..).zip(&t.transitions) {
            let mut ahead = BTreeSet::new();
            let numbered = rules.multi_token && rules.numbered_exclusive;
            if tr.shares && terms <= MOST_RIVALS && (numbered || !rules.multi_token) {
                let steps = self.ends(tr.from, tr.more_from);
                let others = steps.iter().filter_map(|s| behind.get(s.0 as usize)).flatten().copied();
                ahead
                    .extend(others.filter(|o| if numbered { priority(*o) < tr.priority } else { *o < rank }));
            }
            terms += ahead.len();
            all.push(ahead.into_iter().collect());
        }
        if terms > MOST_RIVALS {
            self.cannot("a choice among so many transitions, in the flat style,");
        }
        all
    }

    /// The clearing condition of each transition.
    fn clearing_conditions(&mut self) {
        let t = self.t;
        let single = !t.rules.multi_token;
        let rivals = self.rivals();
        let contested: BTreeSet<u32> = rivals.iter().flatten().copied().collect();
        let blocks = self.facts.has_orders || self.facts.has_periods;
        let ranks: Vec<u32> = t.sources.iter().chain(&t.outs).copied().collect();
        let mut body = Block::new();
        let mut late = Vec::new();
        for rank in ranks {
            let Some(tr) = t.transitions.get(rank as usize).copied() else { continue };
            let ahead = rivals.get(rank as usize).map_or(&[] as &[u32], Vec::as_slice);
            let mut e = Expr::Bool(true);
            if blocks {
                e = s().field("blocked").at(Expr::size(tr.chart as usize)).not();
            }
            for step in self.ends(tr.from, tr.more_from) {
                e = e.and(self.active(step));
            }
            // Behind the first that clears of those that need nothing else, none is judged.
            let at_once = single && tr.simple;
            if at_once {
                e = ahead.iter().fold(e, |e, other| e.and(self.cf(*other).not()));
            }
            let (guard, _) = self.guard(rank);
            let e = e.and(guard);
            body.push(Stmt::Note(self.transition_note(rank)));
            if at_once || (ahead.is_empty() && (single || !contested.contains(&rank))) {
                body.push(Stmt::set(self.cf(rank), e));
            } else {
                body.push(Stmt::set(self.clearable(rank), e));
                late.push(rank);
            }
        }
        late.sort_unstable();
        if !late.is_empty() {
            body.push(Stmt::Note("Of those that share a step, the best priority clears.".into()));
        }
        for rank in late {
            let ahead = rivals.get(rank as usize).map_or(&[] as &[u32], Vec::as_slice);
            let other = |o: &u32| if single { self.cf(*o) } else { self.clearable(*o) };
            let e = ahead.iter().fold(self.clearable(rank), |e, o| e.and(other(o).not()));
            body.push(Stmt::set(self.cf(rank), e));
        }
        let note = "Clearing conditions: enabled, the receptivity true, nothing better in the way.";
        self.function("clearing_conditions", note, vec![state()], body);
    }

    fn clearable(&self, rank: u32) -> Expr {
        s().field("clearable").at(self.transition(rank))
    }

    /// Set and reset of each step, then what transitions do as they clear.
    fn step_memories(&mut self) {
        let t = self.t;
        let none = Expr::Bool(false);
        let mut ends: Vec<(Expr, Expr)> = vec![(none.clone(), none); t.steps.len()];
        let mut actions = Block::new();
        for (rank, tr) in (0u32..).zip(&t.transitions) {
            let cf = self.cf(rank);
            for to in self.ends(tr.to, tr.more_to) {
                if let Some((set, _)) = ends.get_mut(to.0 as usize) {
                    *set = either(set.clone(), cf.clone());
                }
            }
            let drops = t.drops.iter().filter(|d| tr.drops && d.0 == rank).map(|d| d.1);
            for from in self.ends(tr.from, tr.more_from).into_iter().chain(drops) {
                if let Some((_, reset)) = ends.get_mut(from.0 as usize) {
                    *reset = either(reset.clone(), cf.clone());
                }
            }
            if tr.on_clearing != NONE {
                let run = call("run_in_pass", Expr::size(tr.on_clearing as usize));
                actions.push(Stmt::If(cf, vec![run], Vec::new()));
            }
        }
        let mut body = Block::new();
        for (i, (set, reset)) in (0u32..).zip(ends) {
            if set == Expr::Bool(false) && reset == Expr::Bool(false) {
                continue;
            }
            let step = StepId(i);
            body.push(Stmt::Note(self.c.symbols.step_path(step).to_owned()));
            body.push(Stmt::Do(Expr::call("set_reset", vec![s(), self.step(step), set, reset])));
        }
        body.extend(actions);
        let note = "The steps: set by the transitions before, reset by those behind.";
        self.function("step_memories", note, vec![state()], body);
    }

    /// Whether a control block is printed as an equation of its steps: nothing but N
    /// without a condition comes in.
    pub(crate) fn is_equation(&self, block: u32) -> bool {
        self.equations.get(block as usize).copied().unwrap_or(false)
    }

    pub(crate) fn find_equations(&mut self) {
        let t = self.t;
        let mut all: Vec<bool> = t.blocks.iter().map(|b| b.plain && b.gate.is_empty()).collect();
        for c in t.contributions.iter().filter(|c| !(c.condition.is_empty() && c.time.is_empty())) {
            if let Some(b) = all.get_mut(c.block as usize) {
                *b = false;
            }
        }
        self.equations = if self.facts.flat { all } else { Vec::new() };
    }

    /// `Q := X1 OR X2`, for an output or a body.
    pub(crate) fn equation(&mut self, i: usize, b: &ControlBlock) -> Block {
        let t = self.t;
        let mut some = Expr::Bool(false);
        for (step, row) in (0u32..).zip(&t.steps) {
            let Some(e) = t.extras.get(row.extra as usize) else { continue };
            let rows = t.contributions.get(e.contributions.start as usize..e.contributions.end as usize);
            if rows.unwrap_or(&[]).iter().any(|c| c.block as usize == i) {
                some = either(some, self.active(StepId(step)));
            }
        }
        let name = format!("q{i}");
        let q = Expr::name(name.clone());
        let mut body = vec![Stmt::Let { mutable: false, name, ty: Ty::Bool, value: some }];
        self.put(&mut body, i, b.output.0, q.clone());
        if b.action != NONE {
            body.push(Stmt::If(q, vec![call("run_at_end", Expr::size(b.action as usize))], Vec::new()));
        }
        let note = self.c.symbols.blocks.get(i).map_or(String::new(), |b| b.name.to_string());
        let mut all = vec![Stmt::Note(note)];
        all.extend(Stmt::when(self.due(b.period), body));
        all
    }
}

/// Disjunction, short where nothing was there before.
fn either(a: Expr, b: Expr) -> Expr {
    if a == Expr::Bool(false) || a == b { b } else { a.bin(Bin::Or, b) }
}
