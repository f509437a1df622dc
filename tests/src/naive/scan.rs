//! One scan from inputs to outputs, and restarts.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{TargetPlc, VarKind};

use super::control::Went;
use super::evolve::{self, Changes};
use super::exec::Exec;
use super::force::services;
use super::model::StepId;
use super::sample::sample;
use super::state::State;
use super::stored;
use super::value::{NaiveFault, Run, Typed, Value, bad};
use super::{Diagnostics, Marks, Naive};

/// A scan without bound that makes this many passes is given up.
const RUNAWAY: usize = 20_000;

impl Naive {
    /// Makes one scan.
    ///
    /// # Errors
    ///
    /// The fault that ended it; every later scan is refused until [`Naive::restart`].
    pub fn scan(&mut self, inputs: &BTreeMap<String, Value>, now: i64) -> Result<(), NaiveFault> {
        if self.fault.is_some() {
            return Err(NaiveFault::Stopped);
        }
        self.diagnostics.latest.clear();
        self.marks = Marks::default();
        let done = self.try_scan(inputs, now);
        if let Err(fault) = &done {
            if *fault == NaiveFault::Table {
                let model = std::rc::Rc::clone(&self.model);
                self.state.set_system(&model, "S25", Value::Bool(true));
            }
            let model = std::rc::Rc::clone(&self.model);
            for (id, var) in model.vars.iter().enumerate() {
                if let Some(value) = self.safe.get(&var.qualified) {
                    self.state.vars[id] = value.clone();
                }
            }
            self.fault = Some(fault.clone());
        }
        self.first = false;
        done
    }

    /// Restarts: a warm restart keeps the retained variables, a cold one does not.
    ///
    /// # Errors
    ///
    /// An initial value cannot be evaluated.
    pub fn restart(&mut self, cold: bool) -> Result<(), NaiveFault> {
        let kept = if cold { BTreeMap::new() } else { self.state.retained(&self.model) };
        self.state = State::new(&self.model, &kept)?;
        self.first = true;
        self.warm = !cold;
        self.fault = None;
        self.diagnostics = Diagnostics::default();
        Ok(())
    }

    fn try_scan(&mut self, inputs: &BTreeMap<String, Value>, now: i64) -> Run<()> {
        let model = std::rc::Rc::clone(&self.model);
        let m = &*model;
        self.state.now = now;
        self.state.scan += 1;
        self.state.work = 0;
        self.read(inputs)?;
        let due = self.due();
        let s = &mut self.state;
        if self.first {
            s.set_system(m, "S0", Value::Bool(!self.warm));
            s.set_system(m, "S1", Value::Bool(self.warm));
        }
        let mut changes = if self.first { self.initialise()? } else { Changes::default() };
        sample(m, &mut self.state, &due)?;
        if self.state.system(m, "S0") {
            self.state.set_system(m, "S21", Value::Bool(true));
        }
        self.sections(true, &due)?;
        let before = self.state.clone();
        let restarted = self.state.system(m, "S0");
        let requested = services(m, &mut self.state, self.first);
        stored::run(m, &mut self.state, &before, &requested, &mut self.diagnostics)?;
        if self.first || !(requested.on.is_empty() && requested.off.is_empty()) {
            super::control::before_evolution(m, &mut self.state, &due)?;
        }
        changes.add(&requested);
        let start = self.state.active.clone();
        let counted = self.evolve(&due, &mut changes)?;
        self.count(counted);
        super::control::end_of_scan(m, &mut self.state, &due, &Went { start, changes })?;
        self.sections(false, &due)?;
        // Set by an action or by POST, %S0 stays for the next scan.
        if restarted {
            self.state.set_system(m, "S0", Value::Bool(false));
        }
        self.state.set_system(m, "S1", Value::Bool(false));
        Ok(())
    }

    fn read(&mut self, inputs: &BTreeMap<String, Value>) -> Run<()> {
        for (name, value) in inputs {
            if let Some(bit) = name.strip_prefix('%') {
                let model = std::rc::Rc::clone(&self.model);
                self.state.set_system(&model, bit, value.clone());
                continue;
            }
            let found = self.model.vars.iter().position(|v| v.qualified == *name && v.kind == VarKind::Input);
            let Some(id) = found else { return bad(format!("no input {name}")) };
            let value = Typed { ty: None, v: value.clone() }.to(self.model.vars[id].ty)?;
            self.state.vars[id] = value;
        }
        Ok(())
    }

    /// The scopes that take part in this scan (decision 20).
    fn due(&mut self) -> Vec<bool> {
        let now = self.state.now;
        let mut due = Vec::new();
        for (id, scope) in self.model.scopes.iter().enumerate() {
            let Some(period) = scope.every else {
                due.push(true);
                continue;
            };
            let next = self.state.due_next.entry(id).or_insert(now);
            due.push(now >= *next);
            while *next <= now {
                *next += period.max(1);
            }
        }
        self.model.scopes.iter().map(|scope| due[scope.root]).collect()
    }

    /// Runs the PRE or POST bodies, in the order of the text.
    fn sections(&mut self, pre: bool, due: &[bool]) -> Run<()> {
        let model = std::rc::Rc::clone(&self.model);
        for (scope, is_pre, block) in &model.bodies {
            if *is_pre == pre && due[*scope] && model.is_live(*scope) {
                Exec::new(&model, &mut self.state).body(*scope, block)?;
            }
        }
        Ok(())
    }

    /// Makes the initial situation and runs its stored actions before everything else: no action
    /// finds a step active before.
    fn initialise(&mut self) -> Run<Changes> {
        let m = &*std::rc::Rc::clone(&self.model);
        let before = self.state.clone();
        let changes = evolve::settle(m, &mut self.state, m.initial_steps(), &BTreeSet::new());
        stored::run(m, &mut self.state, &before, &changes, &mut self.diagnostics)?;
        Ok(changes)
    }

    /// Makes the passes; returns the steps that changed and the transitions that were enabled at
    /// the start.
    fn evolve(&mut self, due: &[bool], changes: &mut Changes) -> Run<Counted> {
        let model = std::rc::Rc::clone(&self.model);
        let m = &*model;
        let plain = |set: &BTreeSet<StepId>| set.iter().filter(|&&x| m.steps[x].expansion.is_none()).count();
        let enabled = |s: &State| -> BTreeSet<usize> {
            (0..m.transitions.len()).filter(|&t| evolve::enabled(m, s, t)).collect()
        };
        let mut counted =
            Counted { steps: plain(&self.state.active), enabled: enabled(&self.state), moved: 0 };
        let mut history: Vec<State> = Vec::new();
        loop {
            self.marks.passes += 1;
            if self.marks.passes > 1 {
                sample(m, &mut self.state, due)?;
            }
            let before = self.state.clone();
            let passed = evolve::pass(m, &mut self.state, due, &mut self.diagnostics, &mut self.marks)?;
            changes.add(&passed);
            counted.moved += plain(&passed.on) + plain(&passed.off);
            self.check_tables(enabled(&self.state).len())?;
            let s = &self.state;
            // A macro-step without actions of its own counts only through its expansion.
            let counts = |x: &StepId| m.steps[*x].expansion.is_none() || !m.steps[*x].actions.is_empty();
            let still = !passed.on.iter().chain(&passed.off).any(counts);
            let same = still && before.vars == s.vars && before.owners == s.owners;
            if !m.rules.stable || same {
                return Ok(counted);
            }
            let mut seen = self.state.clone();
            seen.work = 0;
            if let Some(at) = history.iter().position(|h| *h == seen) {
                history.push(seen);
                let cycle = history[at + 1..].iter().map(|h| self.situation_of(h).into_iter().collect());
                return Err(NaiveFault::Unstable(cycle.collect()));
            }
            history.push(seen);
            if m.rules.bound.is_some_and(|b| self.marks.passes >= b as usize) {
                return Err(NaiveFault::Passes);
            }
            if self.marks.passes > RUNAWAY {
                return bad("runs away");
            }
        }
    }

    /// Updates %SW20 and %SW21.
    fn count(&mut self, counted: Counted) {
        let m = &*std::rc::Rc::clone(&self.model);
        let enabled: BTreeSet<usize> =
            (0..m.transitions.len()).filter(|&t| evolve::enabled(m, &self.state, t)).collect();
        let steps = counted.steps + counted.moved;
        let transitions = counted.enabled.len() + counted.enabled.symmetric_difference(&enabled).count();
        self.state.set_system(m, "SW20", Value::Int(steps as i128));
        self.state.set_system(m, "SW21", Value::Int(transitions as i128));
    }

    /// Checks the limits of the target PLC.
    fn check_tables(&self, enabled: usize) -> Run<()> {
        let (steps, transitions) = match self.model.target {
            None => return Ok(()),
            Some(TargetPlc::Tsx3710) => (96, 192),
            Some(TargetPlc::Tsx3720) => (128, 256),
            Some(TargetPlc::Tsx57) => (250, 400),
        };
        let active = self.active().len();
        if active > steps || enabled > transitions { Err(NaiveFault::Table) } else { Ok(()) }
    }
}

/// The numbers for %SW20 and %SW21.
struct Counted {
    steps: usize,
    enabled: BTreeSet<usize>,
    moved: usize,
}
