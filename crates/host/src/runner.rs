//! The loop of a run: plant, inputs, scan, outputs, one instant after the other.

use std::ops::Range;
use std::sync::Arc;

use g7_engine::{Addr, Fault, ImageError, Program, Report, State, begin, pass, scan};
use g7_model::Nanos;

use crate::tape::Tape;

/// Which words of the charts and of the plant are connected. Words are counted from the first
/// output or input word of each program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Coupling {
    /// Pairs of (output word of the charts, input word of the plant).
    pub to_plant: Vec<(u32, u32)>,
    /// Pairs of (output word of the plant, input word of the charts).
    pub to_charts: Vec<(u32, u32)>,
}

/// The kind of a restart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Keeps nothing; `%S0` is true in the first scan.
    Cold,
    /// Keeps the retained variables; `%S1` is true in the first scan.
    Warm,
}

/// A variable that the user can force to a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Force {
    /// An input word, counted from the first: the charts read the forced value.
    Input(u32),
    /// An output: the plant and the devices get the forced value, while the charts go on with their
    /// own value.
    Output(Addr),
    /// Any other variable: the value is written before and after each scan.
    Variable(Addr),
}

/// The program in which a fault stopped the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halt {
    /// The charts.
    Charts(Fault),
    /// The plant.
    Plant(Fault),
}

/// A force in effect.
#[derive(Clone, Copy, Debug)]
struct Held {
    what: Force,
    value: u64,
    /// The charts' own value of a forced output.
    own: u64,
}

impl Held {
    fn output(&self) -> Option<Addr> {
        if let Force::Output(addr) = self.what { Some(addr) } else { None }
    }
}

#[derive(Clone)]
struct Plant {
    program: Arc<Program>,
    state: State,
    inputs: Vec<u64>,
    coupling: Coupling,
}

/// A running program, with its plant if it has one. It owns all its data, so a clone is an
/// independent run from this instant on.
#[derive(Clone)]
pub struct Runner {
    program: Arc<Program>,
    state: State,
    /// The inputs as the user or the plant set them; forced values take precedence.
    inputs: Vec<u64>,
    /// The inputs that the latest scan read.
    read: Vec<u64>,
    plant: Option<Plant>,
    /// Ascending by what is forced.
    forces: Vec<Held>,
    period: Nanos,
    due: Nanos,
    missed: u64,
    halt: Option<Halt>,
    report: Report,
    retained: Vec<Range<u32>>,
    flags: Option<(Addr, Addr)>,
    tape: Option<Tape>,
    /// The state within a scan that is executed pass by pass.
    slow: Option<State>,
    /// True if plant and inputs are already prepared for the next scan.
    ready: bool,
}

impl Runner {
    /// A cold run before its first scan, which is due at 0.
    pub fn new(program: impl Into<Arc<Program>>, period: Nanos) -> Runner {
        let program = program.into();
        let rows = program.tables().inputs;
        let mut runner = Runner {
            state: State::new(&program),
            program,
            inputs: Vec::new(),
            read: Vec::new(),
            plant: None,
            forces: Vec::new(),
            period: period.max(Nanos::new(1)),
            due: Nanos::ZERO,
            missed: 0,
            halt: None,
            report: Report::default(),
            retained: Vec::new(),
            flags: None,
            tape: None,
            slow: None,
            ready: false,
        };
        runner.inputs = (rows.start..rows.end).map(|a| runner.state.word(Addr(a))).collect();
        runner.read = runner.inputs.clone();
        runner
    }

    /// Connects the charts to a plant.
    #[must_use]
    pub fn with_plant(mut self, program: impl Into<Arc<Program>>, coupling: Coupling) -> Runner {
        let program = program.into();
        let rows = program.tables().inputs;
        let state = State::new(&program);
        let inputs = (rows.start..rows.end).map(|a| state.word(Addr(a))).collect();
        self.plant = Some(Plant { program, state, inputs, coupling });
        self
    }

    /// Connects other words of charts and plant than before.
    pub fn couple(&mut self, coupling: Coupling) {
        if let Some(plant) = &mut self.plant {
            plant.coupling = coupling;
        }
    }

    /// Sets which words are kept over a warm restart.
    #[must_use]
    pub fn with_retained(mut self, words: Vec<Range<u32>>) -> Runner {
        self.retained = words;
        self
    }

    /// Sets the addresses of `%S0` and `%S1`.
    #[must_use]
    pub fn with_flags(mut self, flags: Option<(Addr, Addr)>) -> Runner {
        self.flags = flags;
        self.set_flags(Start::Cold);
        self
    }

    /// Records a tape from here on.
    #[must_use]
    pub fn with_tape(mut self) -> Runner {
        self.tape = Some(Tape::new(&self.program));
        if let (Some(flags), Some(tape)) = (self.flags, &mut self.tape) {
            tape.write(flags.0, self.state.word(flags.0));
            tape.write(flags.1, self.state.word(flags.1));
        }
        self
    }

    /// The tape, if one is recorded.
    pub fn tape(&self) -> Option<&Tape> {
        self.tape.as_ref()
    }

    /// The program.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The state of the charts.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The program and the state of the charts, for evaluating expressions.
    pub fn charts_mut(&mut self) -> (&Program, &mut State) {
        (&self.program, &mut self.state)
    }

    /// The program and the state of the plant.
    pub fn plant(&self) -> Option<(&Program, &State)> {
        self.plant.as_ref().map(|p| (&*p.program, &p.state))
    }

    /// The program and the state of the plant, for evaluating expressions.
    pub fn plant_mut(&mut self) -> Option<(&Program, &mut State)> {
        self.plant.as_mut().map(|p| (&*p.program, &mut p.state))
    }

    /// The instant of the next scan.
    pub fn due(&self) -> Nanos {
        self.due
    }

    /// The time between two scans.
    pub fn period(&self) -> Nanos {
        self.period
    }

    /// The number of scans that were skipped because they were late.
    pub fn missed(&self) -> u64 {
        self.missed
    }

    /// The engine's report on the latest scan.
    pub fn report(&self) -> Report {
        self.report
    }

    /// The fault that stopped the run, if any.
    pub fn halt(&self) -> Option<Halt> {
        self.halt
    }

    /// The inputs that the latest scan read.
    pub fn read(&self) -> &[u64] {
        &self.read
    }

    /// The output words that the plant and the devices get.
    pub fn outputs(&self) -> &[u64] {
        let rows = self.program.tables().outputs;
        self.state.words().get(rows.start as usize..rows.end as usize).unwrap_or(&[])
    }

    /// Sets an input word, counted from the first. If the plant drives it, the plant overwrites it
    /// in its next scan.
    pub fn set_input(&mut self, index: u32, value: u64) {
        if let Some(word) = self.inputs.get_mut(index as usize) {
            *word = value;
        }
    }

    /// The input word that the next scan will read, unless the plant changes it before.
    pub fn input(&self, index: u32) -> u64 {
        let held = self.place(Force::Input(index)).ok().and_then(|at| self.forces.get(at));
        held.map(|h| h.value).or(self.inputs.get(index as usize).copied()).unwrap_or(0)
    }

    /// True if the plant drives this input.
    pub fn is_driven(&self, index: u32) -> bool {
        self.plant.as_ref().is_some_and(|p| p.coupling.to_charts.iter().any(|(_, to)| *to == index))
    }

    /// Writes a variable of the charts once.
    pub fn set_word(&mut self, addr: Addr, value: u64) {
        self.state.set_word(&self.program, addr, value);
        if let Some(tape) = &mut self.tape {
            tape.write(addr, value);
        }
    }

    /// Writes a variable of the plant once.
    pub fn set_plant_word(&mut self, addr: Addr, value: u64) {
        if let Some(p) = &mut self.plant {
            p.state.set_word(&p.program, addr, value);
        }
    }

    /// Makes room for so many forces: within it, forcing allocates nothing.
    pub fn reserve_forces(&mut self, count: usize) {
        self.forces.reserve(count);
    }

    /// The place of a force, or that where it would be.
    fn place(&self, what: Force) -> Result<usize, usize> {
        self.forces.binary_search_by_key(&what, |held| held.what)
    }

    /// Forces a variable to a value, from now on until it is released.
    pub fn force(&mut self, what: Force, value: u64) {
        let own = if let Force::Output(addr) = what { self.state.word(addr) } else { 0 };
        match self.place(what) {
            Ok(at) => {
                if let Some(held) = self.forces.get_mut(at) {
                    held.value = value;
                }
            }
            Err(at) => self.forces.insert(at, Held { what, value, own }),
        }
        if let Force::Output(addr) | Force::Variable(addr) = what {
            self.set_word(addr, value);
        }
    }

    /// Ends a force; true if there was one. An output gets the charts' own value again.
    pub fn release(&mut self, what: Force) -> bool {
        let Ok(at) = self.place(what) else { return false };
        let held = self.forces.remove(at);
        if let Force::Output(addr) = what {
            self.set_word(addr, held.own);
        }
        true
    }

    /// True if the variable is forced.
    pub fn is_forced(&self, what: Force) -> bool {
        self.place(what).is_ok()
    }

    /// The forced variables with their values.
    pub fn forces(&self) -> impl Iterator<Item = (Force, u64)> + '_ {
        self.forces.iter().map(|held| (held.what, held.value))
    }

    /// The charts' own values of the forced outputs.
    pub fn own_outputs(&self) -> impl Iterator<Item = (Addr, u64)> + '_ {
        self.forces.iter().filter_map(|held| Some((held.output()?, held.own)))
    }

    /// Makes this run, a clone of an earlier instant, equal to the other one. Allocates nothing where
    /// that one has no more forces than there is room for here. What is recorded is left out.
    ///
    /// # Errors
    ///
    /// The other run is one of another program; this one is as it was.
    pub fn copy_from(&mut self, other: &Runner) -> Result<(), ImageError> {
        self.state.restore(&self.program, other.state.image())?;
        if let (Some(to), Some(from)) = (&mut self.plant, &other.plant) {
            to.state.restore(&to.program, from.state.image())?;
            to.inputs.clone_from(&from.inputs);
        }
        self.inputs.clone_from(&other.inputs);
        self.read.clone_from(&other.read);
        self.forces.clone_from(&other.forces);
        (self.due, self.missed, self.halt) = (other.due, other.missed, other.halt);
        (self.report, self.ready, self.slow) = (other.report, other.ready, None);
        Ok(())
    }

    /// Calls with the state in which forced outputs have the charts' own values.
    pub fn without_forced_outputs<T>(&mut self, look: impl FnOnce(&Runner) -> T) -> T {
        let forces = std::mem::take(&mut self.forces);
        let outputs = || forces.iter().filter_map(|h| Some((h.output()?, h)));
        outputs().for_each(|(addr, held)| self.state.set_word(&self.program, addr, held.own));
        let seen = look(self);
        outputs().for_each(|(addr, held)| self.state.set_word(&self.program, addr, held.value));
        self.forces = forces;
        seen
    }

    /// Skips the scans that were due before `now`, except the latest of them.
    pub fn catch_up(&mut self, now: Nanos) {
        let late = (now - self.due).count_of(self.period);
        if late > 0 {
            self.missed = self.missed.saturating_add(late as u64);
            self.due += self.period * late;
        }
    }

    /// Makes the next scan, at the instant it is due: the plant makes its scan first, then the
    /// charts read their inputs and evolve.
    ///
    /// # Errors
    ///
    /// A fault of the charts or the plant; every later call returns it again until
    /// [`Runner::restart`].
    pub fn scan(&mut self) -> Result<Report, Halt> {
        if let Some(halt) = self.halt {
            return Err(halt);
        }
        let now = self.due;
        let done = self.prepare(now).and_then(|()| self.evolve(now));
        self.due = now + self.period;
        (self.ready, self.slow) = (false, None);
        match done {
            Ok(report) => self.report = report,
            Err(halt) => self.halt = Some(halt),
        }
        done
    }

    /// Makes one pass of the next scan. Returns true if it was the last pass, so that the scan is
    /// complete; until then [`Runner::shown`] gives the state between two passes.
    ///
    /// # Errors
    ///
    /// The same as [`Runner::scan`].
    pub fn pass(&mut self) -> Result<bool, Halt> {
        if let Some(halt) = self.halt {
            return Err(halt);
        }
        let now = self.due;
        let mut state = match self.slow.take() {
            Some(state) => state,
            None => {
                if self.prepare(now).is_err() {
                    return self.scan().map(|_| true);
                }
                let mut state = self.state.clone();
                if begin(&self.program, &mut state, &self.read, now.count()).is_err() {
                    return self.scan().map(|_| true);
                }
                state
            }
        };
        // The passes run on a copy. After the last pass, or at a fault, the whole scan is made on
        // the state itself, so that a scan is always made in the same way.
        match pass(&self.program, &mut state) {
            Ok(true) if self.program.tables().rules.stable => {
                self.slow = Some(state);
                Ok(false)
            }
            Ok(_) | Err(_) => self.scan().map(|_| true),
        }
    }

    /// The state between two passes, or that of the charts if no scan is in progress.
    pub fn shown(&self) -> &State {
        self.slow.as_ref().unwrap_or(&self.state)
    }

    /// True while a scan is executed pass by pass.
    pub fn is_within_scan(&self) -> bool {
        self.slow.is_some()
    }

    /// Makes the plant's scan and takes the inputs of the scan due at `now`; a second call for the
    /// same scan does nothing.
    fn prepare(&mut self, now: Nanos) -> Result<(), Halt> {
        if !self.ready {
            self.move_plant(now).map_err(Halt::Plant)?;
            self.take_inputs();
            self.ready = true;
        }
        Ok(())
    }

    fn move_plant(&mut self, now: Nanos) -> Result<(), Fault> {
        let Some(p) = &mut self.plant else { return Ok(()) };
        let outputs = self.program.tables().outputs.start;
        for (from, to) in &p.coupling.to_plant {
            if let Some(word) = p.inputs.get_mut(*to as usize) {
                *word = self.state.word(Addr(outputs.saturating_add(*from)));
            }
        }
        scan(&p.program, &mut p.state, &p.inputs, now.count())?;
        let driven = p.program.tables().outputs.start;
        for (from, to) in &p.coupling.to_charts {
            if let Some(word) = self.inputs.get_mut(*to as usize) {
                *word = p.state.word(Addr(driven.saturating_add(*from)));
            }
        }
        Ok(())
    }

    fn take_inputs(&mut self) {
        self.read.clone_from(&self.inputs);
        // Put back below: what is set meanwhile is the state, and no force.
        let forces = std::mem::take(&mut self.forces);
        for Held { what, value, own } in &forces {
            match what {
                Force::Input(index) => {
                    if let Some(word) = self.read.get_mut(*index as usize) {
                        *word = *value;
                    }
                }
                Force::Output(addr) => self.set_word(*addr, *own),
                Force::Variable(addr) => self.set_word(*addr, *value),
            }
        }
        self.forces = forces;
    }

    fn evolve(&mut self, now: Nanos) -> Result<Report, Halt> {
        let done = scan(&self.program, &mut self.state, &self.read, now.count());
        if let Some(tape) = &mut self.tape {
            tape.scan(now, &self.read, &self.state);
        }
        if done.is_ok() {
            let mut forces = std::mem::take(&mut self.forces);
            for held in &mut forces {
                if let Force::Output(addr) = held.what {
                    held.own = self.state.word(addr);
                }
                if let Force::Output(addr) | Force::Variable(addr) = held.what {
                    self.set_word(addr, held.value);
                }
            }
            self.forces = forces;
        }
        done.map_err(Halt::Charts)
    }

    /// Restarts the charts; inputs, forced values and the plant stay as they are.
    pub fn restart(&mut self, start: Start) {
        let kept = match start {
            Start::Cold => Vec::new(),
            Start::Warm => self.retained(),
        };
        self.state = State::new(&self.program);
        (self.halt, self.ready, self.slow) = (None, false, None);
        if let Some(tape) = &mut self.tape {
            tape.restart();
        }
        self.retain(&kept);
        self.set_flags(start);
        let mut forces = std::mem::take(&mut self.forces);
        for held in &mut forces {
            if let Force::Output(addr) = held.what {
                held.own = self.state.word(addr);
                self.set_word(addr, held.value);
            }
        }
        self.forces = forces;
    }

    /// Continues from the state of another run; the next scan is at `due`.
    #[must_use]
    pub fn from_state(mut self, state: State, due: Nanos) -> Runner {
        (self.state, self.due) = (state, due);
        self
    }

    /// Continues warm from a state of an earlier run: the next scan is one period after that of the
    /// state, and `%S1` is true in it.
    #[must_use]
    pub fn resume(mut self, state: State) -> Runner {
        let due = Nanos::new(state.now()) + self.period;
        self = self.from_state(state, due);
        self.set_flags(Start::Warm);
        self
    }

    /// Replaces the state of the plant.
    pub fn set_plant_state(&mut self, state: State) {
        if let Some(plant) = &mut self.plant {
            plant.state = state;
        }
    }

    /// The present values of the words that a warm restart keeps.
    pub fn retained(&self) -> Vec<u64> {
        self.retained_words().collect()
    }

    /// The same words, one after the other.
    pub fn retained_words(&self) -> impl Iterator<Item = u64> + '_ {
        self.retained.iter().cloned().flatten().map(|a| self.state.word(Addr(a)))
    }

    /// Writes retained values; words beyond the given ones stay unchanged.
    pub fn retain(&mut self, words: &[u64]) {
        let all: Vec<u32> = self.retained.iter().cloned().flatten().collect();
        for (addr, value) in all.into_iter().zip(words) {
            self.set_word(Addr(addr), *value);
        }
    }

    fn set_flags(&mut self, start: Start) {
        if let Some((cold, warm)) = self.flags {
            self.set_word(cold, u64::from(start == Start::Cold));
            self.set_word(warm, u64::from(start == Start::Warm));
        }
    }
}
