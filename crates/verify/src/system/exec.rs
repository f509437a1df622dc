//! Statements as bits: what `equations::Machine` does, for all values at once.
//!
//! # Invariants
//!
//! - A statement that sets a memory within a branch leaves what the other branch has there.
//! - Behind a fault nothing is noted any more and no step changes; other memories may take any
//!   value, since no scan follows.
//! - `path` is 1 where the statement in hand is come to, but for faults and exits of loops
//!   before it, which `run` and `inside` tell.

use std::collections::BTreeMap;

use g7_engine::{FaultKind, StepId};
use g7_equations::{About, Equations, Expr, MemoryId, Stmt, What, expand};
use g7_model::{Span, Type};

use super::limit::{Limit, Unknown};
use super::value::{Value, choose};
use super::word;
use crate::model::Model;
use crate::reason::Part;
use crate::sat::{Graph, Signal, System};

/// Rounds of a loop of which it is not known when it ends.
const ROUNDS: usize = 64;
/// Nodes beyond which nothing is unrolled further.
pub(crate) const NODES: usize = 150_000;
/// Statements between two questions to the caller if it is to go on.
const STATEMENTS: u32 = 256;

/// Executes the statements of a scan on signals in place of values.
pub(crate) struct Exec<'a> {
    pub(crate) e: &'a Equations,
    pub(crate) model: &'a Model<'a>,
    pub(crate) system: System,
    cells: Vec<Vec<Value>>,
    /// For each branch round the statement in hand: what its memories were before it.
    before: Vec<BTreeMap<usize, Vec<Value>>>,
    /// The branches round the statement in hand are taken.
    pub(crate) path: Signal,
    /// No fault has ended the scan.
    pub(crate) run: Signal,
    /// The innermost loop has not been left.
    inside: Signal,
    /// The faults, each with the signal that it is the one that ends the scan.
    pub(crate) faults: Vec<(FaultKind, Span, Signal)>,
    /// A loop goes on, or passes do, beyond what was unrolled.
    pub(crate) uncovered: Vec<Signal>,
    pub(crate) unknown: Vec<Unknown>,
    about: About,
    /// True as soon as the caller wants no more; the system is then not whole, and of no use.
    pub(super) stop: &'a (dyn Fn() -> bool + Sync),
    given_up: bool,
    statements: u32,
}

impl<'a> Exec<'a> {
    pub(crate) fn new(
        e: &'a Equations,
        model: &'a Model<'a>,
        cells: Vec<Vec<Value>>,
        system: System,
    ) -> Self {
        Exec {
            e,
            model,
            system,
            cells,
            before: Vec::new(),
            path: Signal::TRUE,
            run: Signal::TRUE,
            inside: Signal::TRUE,
            faults: Vec::new(),
            uncovered: Vec::new(),
            unknown: Vec::new(),
            about: About::Nothing,
            stop: &|| false,
            given_up: false,
            statements: 0,
        }
    }

    /// The same, given up as soon as the caller wants no more.
    pub(super) fn until(self, stop: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Exec { stop, ..self }
    }

    /// True once the caller has wanted no more.
    pub(super) fn given_up(&self) -> bool {
        self.given_up
    }

    pub(crate) fn g(&mut self) -> &mut Graph {
        &mut self.system.graph
    }

    /// The elements of a memory.
    pub(crate) fn cell(&self, m: MemoryId) -> &[Value] {
        self.cells.get(m.0 as usize).map_or(&[], Vec::as_slice)
    }

    /// All memories.
    pub(crate) fn cells(&self) -> &[Vec<Value>] {
        &self.cells
    }

    /// Activity of each step.
    pub(super) fn steps(&mut self) -> Vec<Signal> {
        let known = self.e.by_meaning();
        let count = self.model.compiled.program.tables().steps.len() as u32;
        (0..count).map(|s| self.holds(known.get(&What::Step(StepId(s))).copied())).collect()
    }

    /// A truth value that a memory has.
    pub(crate) fn holds(&mut self, m: Option<MemoryId>) -> Signal {
        let Some(m) = m else { return Signal::FALSE };
        self.truth(&Expr::Read(m))
    }

    /// The place in hand is reached in each scan again, with nothing behind it.
    pub(crate) fn restart(&mut self) {
        (self.path, self.run, self.inside) = (Signal::TRUE, Signal::TRUE, Signal::TRUE);
    }

    /// Gives a memory a value, whatever branch this is.
    pub(crate) fn put(&mut self, m: MemoryId, value: Vec<Value>) {
        let at = m.0 as usize;
        let Some(slot) = self.cells.get_mut(at) else { return };
        let old = std::mem::replace(slot, value);
        if let Some(log) = self.before.last_mut() {
            log.entry(at).or_insert(old);
        }
    }

    /// 1 where the statement in hand is come to.
    pub(crate) fn here(&mut self) -> Signal {
        let (path, run, inside) = (self.path, self.run, self.inside);
        self.g().all([path, run, inside])
    }

    pub(crate) fn note_limit(&mut self, part: Part, bits: &[Signal]) {
        let symbols = &self.model.compiled.symbols;
        let at = match self.about {
            About::Step(s) => symbols.step_place(s),
            About::Transition(rank) => symbols.transition_place(rank),
            About::Action(rank) => symbols.actions.get(rank as usize).map_or(Span::default(), |a| a.at),
            About::Nothing | About::Block(_) | About::Watch(_) | About::Order(_) => Span::default(),
        };
        self.unknown.push(Unknown { limit: Limit { part, at }, bits: bits.to_vec() });
    }

    /// Statements, one after the other.
    pub(crate) fn all(&mut self, list: &[Stmt]) {
        for s in list {
            self.statements = self.statements.wrapping_add(1);
            self.given_up |= self.statements.is_multiple_of(STATEMENTS) && (self.stop)();
            if self.given_up || self.run == Signal::FALSE || self.inside == Signal::FALSE {
                break;
            }
            self.statement(s);
        }
    }

    fn statement(&mut self, s: &Stmt) {
        match s {
            Stmt::Set(to, e) => {
                let value = match e {
                    Expr::Read(m) => self.cell(*m).to_vec(),
                    e => vec![self.eval(e)],
                };
                self.store(*to, value);
            }
            Stmt::SetElement(to, index, e) => {
                let (index, value) = (self.eval(index).whole(), self.eval(e));
                let mut cell = self.cell(*to).to_vec();
                for (k, element) in cell.iter_mut().enumerate() {
                    let here = word::equal(self.g(), &index, &word::Word::constant(k as i128));
                    *element = choose(self.g(), here, &value, element);
                }
                self.store(*to, cell);
            }
            Stmt::If(e, then, other) => {
                let condition = self.truth(e);
                self.fork(condition, |x| x.all(then), |x| x.all(other));
            }
            Stmt::Loop(body) => self.repeat(body),
            Stmt::Exit => {
                let (run, inside) = (self.run, self.inside);
                self.inside = self.g().and(inside, !run);
            }
            Stmt::Fault(kind, at) => {
                let here = self.here();
                self.faults.push((*kind, *at, here));
                let (run, inside) = (self.run, self.inside);
                self.run = self.g().and(run, !inside);
            }
            Stmt::Call(block, memories) => self.all(&expand(*block, memories)),
            Stmt::About(about) => self.about = *about,
        }
    }

    fn store(&mut self, to: MemoryId, value: Vec<Value>) {
        let what = self.e.memory(to).map(|m| m.what);
        let lasting = matches!(what, Some(What::Step(_) | What::Ran(_)));
        let (run, inside) = (self.run, self.inside);
        let takes = if lasting { self.g().and(run, inside) } else { inside };
        let old = self.cell(to).to_vec();
        // A temporary that has had no value of its own.
        let value = if takes == Signal::TRUE || old.len() != value.len() {
            value
        } else {
            value.iter().zip(&old).map(|(new, old)| choose(self.g(), takes, new, old)).collect()
        };
        let value = match self.e.memory(to).map(|m| m.ty) {
            Some(Type::String(cap)) => value.into_iter().map(|v| cut(v, usize::from(cap))).collect(),
            _ => value,
        };
        self.put(to, value);
    }

    /// The first where the condition holds, else the second.
    pub(crate) fn fork(
        &mut self,
        condition: Signal,
        then: impl FnOnce(&mut Self),
        other: impl FnOnce(&mut Self),
    ) {
        match condition.constant() {
            Some(true) => return then(self),
            Some(false) => return other(self),
            None => {}
        }
        let (path, run, inside) = (self.path, self.run, self.inside);
        self.path = self.g().and(path, condition);
        let first = self.apart(then);
        let (run_then, inside_then) = (self.run, self.inside);
        (self.run, self.inside) = (run, inside);
        self.path = self.g().and(path, !condition);
        let second = self.apart(other);
        self.path = path;
        let (run_other, inside_other) = (self.run, self.inside);
        self.run = self.g().mux(condition, run_then, run_other);
        self.inside = self.g().mux(condition, inside_then, inside_other);
        let places: std::collections::BTreeSet<usize> = first.keys().chain(second.keys()).copied().collect();
        for at in places {
            let old = self.cells.get(at).cloned().unwrap_or_default();
            let (a, b) = (first.get(&at).unwrap_or(&old), second.get(&at).unwrap_or(&old));
            let value = if a.len() == b.len() {
                a.iter().zip(b).map(|(a, b)| choose(&mut self.system.graph, condition, a, b)).collect()
            } else if first.contains_key(&at) {
                a.clone()
            } else {
                b.clone()
            };
            self.put(MemoryId(at as u32), value);
        }
    }

    /// Executes `f`, restores all memories, and returns the values of those that `f` had changed.
    fn apart(&mut self, f: impl FnOnce(&mut Self)) -> BTreeMap<usize, Vec<Value>> {
        self.before.push(BTreeMap::new());
        f(self);
        self.take_back()
    }

    /// From here on only where the signal is 1; gives what [`Exec::leave`] needs.
    pub(crate) fn enter(&mut self, on: Signal) -> [Signal; 3] {
        let outer = [self.path, self.run, self.inside];
        let path = self.path;
        self.path = self.g().and(path, on);
        self.before.push(BTreeMap::new());
        outer
    }

    /// The end of what [`Exec::enter`] began.
    pub(crate) fn leave(&mut self, on: Signal, [path, run, inside]: [Signal; 3]) {
        let changed = self.take_back();
        self.path = path;
        let (now, within) = (self.run, self.inside);
        self.run = self.g().mux(on, now, run);
        self.inside = self.g().mux(on, within, inside);
        for (at, new) in changed {
            let old = self.cells.get(at).cloned().unwrap_or_default();
            let pairs = new.iter().zip(&old);
            let value = pairs.map(|(a, b)| choose(&mut self.system.graph, on, a, b)).collect();
            self.put(MemoryId(at as u32), value);
        }
    }

    /// Takes back what was changed since the latest note; gives the memories that were.
    fn take_back(&mut self) -> BTreeMap<usize, Vec<Value>> {
        let mut changed = BTreeMap::new();
        for (at, old) in self.before.pop().unwrap_or_default() {
            if let Some(slot) = self.cells.get_mut(at) {
                changed.insert(at, std::mem::replace(slot, old));
            }
        }
        changed
    }

    /// Looks at what something would give, and leaves no trace of it: memories, faults.
    pub(crate) fn glance<T>(&mut self, f: impl FnOnce(&mut Self) -> T) -> T {
        let (run, inside, path, about) = (self.run, self.inside, self.path, self.about);
        let (faults, uncovered) = (self.faults.len(), self.uncovered.len());
        self.before.push(BTreeMap::new());
        let value = f(self);
        self.take_back();
        (self.run, self.inside, self.path, self.about) = (run, inside, path, about);
        self.faults.truncate(faults);
        self.uncovered.truncate(uncovered);
        value
    }

    fn repeat(&mut self, body: &[Stmt]) {
        let outer = self.inside;
        let mut made = 0;
        loop {
            self.all(body);
            made += 1;
            let (run, inside) = (self.run, self.inside);
            let on = self.g().and(inside, run);
            if on == Signal::FALSE {
                break;
            }
            // No exit has been open so far: then the end of the loop is known.
            let most = if inside == outer { 100 * ROUNDS } else { ROUNDS };
            if made >= most || self.system.graph.nodes().len() > NODES {
                let here = self.here();
                self.leave_uncovered(here);
                break;
            }
        }
        self.inside = outer;
    }

    /// From here on nothing is known where this signal is 1: the scan ends there.
    pub(crate) fn leave_uncovered(&mut self, here: Signal) {
        self.uncovered.push(here);
        let run = self.run;
        self.run = self.g().and(run, !here);
    }
}

fn cut(v: Value, cap: usize) -> Value {
    match v {
        Value::Text(Some(t)) => {
            let n = g7_engine::text::cut(&t, cap);
            Value::Text(Some(t.get(..n).unwrap_or_default().into()))
        }
        v => v,
    }
}
