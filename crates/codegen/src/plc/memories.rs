//! The memories of the equations as declarations of IEC 61131-3: names, types,
//! comments.

use std::collections::{HashMap, HashSet};

use g7_compile::Compiled;
use g7_engine::{Addr, INPUTS, StepId, WatchId};
use g7_equations::{Class, Equations, Memory, MemoryId, Part, What};
use g7_model::{FbKind, Nanos, Type};

use super::form::{self, Declared, Ex};
use super::names::Names;
use crate::names::of_transition;

/// Names that are not those of memories of the chart.
const FIXED: [&str; 10] =
    ["FIRST", "CLOCK", "LAST", "SCAN_TIME", "PASSES", "CHANGED", "FAULT", "OPENING", "STEPPED", "NOW"];

/// The name of each memory.
pub(crate) struct Memories {
    /// By memory: its name; none where nothing has to be called.
    names: Vec<String>,
    found: HashMap<What, MemoryId>,
    /// Words for the expressions of edges and delays.
    signals: HashMap<WatchId, String>,
    pub(crate) steps: Vec<String>,
    /// Variables of the chart: first word, name, elements.
    pub(crate) shown: Vec<(Addr, String, u32)>,
    pub(crate) declared: Vec<Declared>,
    pub(crate) given: Names,
}

/// A word of the engine as a literal of its type.
pub(crate) fn literal(ty: Type, word: u64) -> Ex {
    match ty {
        Type::Bool => Ex::Bool(word != 0),
        Type::Real => Ex::Real(f64::from(f32::from_bits(word as u32))),
        Type::Lreal => Ex::Real(f64::from_bits(word)),
        Type::Ulint => Ex::Int(word.into()),
        Type::Byte | Type::Word | Type::Dword | Type::Lword => Ex::Bits(ty, word),
        Type::Time => Ex::Time(Nanos::new(word as i64)),
        _ => Ex::Int((word as i64).into()),
    }
}

impl Memories {
    /// Names and declares what the equations use. `native` are the memories that
    /// the controller's function blocks keep; `calls` those that stand first in a
    /// call of such a block.
    pub(crate) fn new(
        c: &Compiled,
        e: &Equations,
        name: &str,
        calls: &HashSet<MemoryId>,
        (signals, longest): (HashMap<WatchId, String>, usize),
    ) -> (String, Memories) {
        let mut m = Memories {
            names: vec![String::new(); e.memories.len()],
            found: e.by_meaning(),
            signals,
            steps: Vec::new(),
            shown: Vec::new(),
            declared: Vec::new(),
            given: Names::new(longest),
        };
        let name = m.given.variable(name);
        for word in FIXED {
            m.given.variable(word);
        }
        let used = e.used();
        m.variables(c, e, &used.iter().copied().collect(), calls);
        m.elements(c, e);
        for id in used {
            if m.names.get(id.0 as usize).is_some_and(String::is_empty)
                && let Some(memory) = e.memory(id)
            {
                m.other(c, id, memory);
            }
        }
        (name, m)
    }

    /// The name of a memory.
    pub(crate) fn name(&self, id: MemoryId) -> &str {
        self.names.get(id.0 as usize).map_or("", String::as_str)
    }

    /// The memory of something, where it has one.
    pub(crate) fn find(&self, what: What) -> Option<MemoryId> {
        self.found.get(&what).copied()
    }

    fn call(&mut self, id: MemoryId, name: String) {
        if let Some(slot) = self.names.get_mut(id.0 as usize) {
            *slot = name;
        }
    }

    /// A declaration of what the chart does not name.
    pub(crate) fn internal(&mut self, name: &str, ty: &str, note: &str) {
        let (name, ty, note) = (name.to_owned(), ty.to_owned(), note.to_owned());
        let class = form::Class::Internal;
        self.declared.push(Declared { class, name, ty, elements: 1, init: Vec::new(), note });
    }

    /// The variables of the chart.
    fn variables(
        &mut self,
        c: &Compiled,
        e: &Equations,
        used: &HashSet<MemoryId>,
        calls: &HashSet<MemoryId>,
    ) {
        let mut members_until = 0;
        for v in &c.symbols.variables {
            if v.words() == 0 || v.addr.0 < members_until {
                continue; // a member of an instance
            }
            let name = self.given.variable(&v.name);
            if let Type::Fb(kind) = v.ty {
                members_until = v.addr.0 + v.words();
                let first = self.find(What::Variable(v.addr));
                let native = first.is_none_or(|m| calls.contains(&m) || !used.contains(&m));
                self.instance(e, v.addr, kind, &name, native);
                let any = (0..v.words()).any(|i| {
                    self.find(What::Variable(Addr(v.addr.0 + i))).is_some_and(|m| used.contains(&m))
                });
                if native && any {
                    self.internal(&name, kind.name(), "");
                }
                continue;
            }
            let Some(id) = self.find(What::Variable(v.addr)) else { continue };
            let Some(memory) = e.memory(id) else { continue };
            let class = match memory.class {
                Class::Input => form::Class::Input,
                Class::Output => form::Class::Output,
                _ if v.retain => form::Class::Retain,
                Class::Kept | Class::Scratch | Class::Constant => form::Class::Internal,
            };
            let outside = matches!(class, form::Class::Input | form::Class::Output);
            let stands = memory.class == Class::Constant && memory.elements == 1;
            self.call(id, name.clone());
            if stands || !(outside || used.contains(&id)) || matches!(v.ty, Type::String(_)) {
                continue;
            }
            self.shown.push((v.addr, name.clone(), memory.elements));
            let mut note = if *v.name == *name { String::new() } else { v.name.to_string() };
            if let Some(address) = v.address.as_deref() {
                note = format!("{note} at {address}").trim().to_owned();
            }
            if let Some(comment) = v.comment.as_deref() {
                let sign = if note.is_empty() { "" } else { ": " };
                note = format!("{note}{sign}{comment}");
            }
            self.declare(class, &name, memory, note);
        }
    }

    fn declare(&mut self, class: form::Class, name: &str, memory: &Memory, note: String) {
        let zero = memory.init.iter().all(|w| *w == 0);
        let init = memory.init.iter().filter(|_| !zero).map(|w| literal(memory.ty, *w)).collect();
        self.declared.push(Declared {
            class,
            name: name.to_owned(),
            ty: memory.ty.name().to_owned(),
            elements: memory.elements,
            init,
            note,
        });
    }

    /// The members of an instance: those of the controller's block, or memories of
    /// their own.
    fn instance(&mut self, e: &Equations, base: Addr, kind: FbKind, name: &str, native: bool) {
        for (i, (member, ..)) in (0u32..).zip(kind.members()) {
            let Some(id) = self.find(What::Variable(Addr(base.0 + i))) else { continue };
            if native {
                self.call(id, format!("{name}.{member}"));
            } else if let Some(memory) = e.memory(id) {
                let own = self.given.variable(&format!("{name}_{member}"));
                self.call(id, own.clone());
                self.declare(form::Class::Internal, &own, memory, String::new());
            }
        }
    }

    /// Steps and transitions.
    fn elements(&mut self, c: &Compiled, e: &Equations) {
        let symbols = &c.symbols;
        for step in (0..symbols.steps()).map(StepId) {
            let name = self.given.with("X", symbols.step_name(step));
            let path = symbols.step_path(step);
            let note = if symbols.is_listed(step) {
                format!("step {path}")
            } else {
                format!("stands for the macro-step {path}")
            };
            self.internal(&name, "BOOL", &note);
            self.steps.push(name.clone());
            if let Some(id) = self.find(What::Step(step)) {
                self.call(id, name);
            }
        }
        let used = e.used();
        for rank in 0..c.program.tables().transitions.len() as u32 {
            let name = self.given.with("T", &of_transition(symbols, rank));
            let clears = self.find(What::Clears(rank)).or(self.find(What::Clearable(rank)));
            let Some(id) = clears.filter(|id| used.contains(id)) else { continue };
            self.internal(&name, "BOOL", &format!("transition {}", symbols.transition_text(rank)));
            self.call(id, name);
        }
    }

    /// The memory of a transition, by what follows its `T_`.
    fn of_transition(&self, rank: u32) -> String {
        let clears = self.find(What::Clears(rank)).or(self.find(What::Clearable(rank)));
        let name = clears.map_or("", |id| self.name(id));
        match name.strip_prefix("T_") {
            Some(rest) => rest.to_owned(),
            None => (rank + 1).to_string(),
        }
    }

    fn of_step(&self, step: StepId) -> String {
        let name = self.steps.get(step.0 as usize).map_or("", String::as_str);
        name.trim_start_matches("X_").to_owned()
    }

    /// The words for a watched expression, or its number where it has none.
    fn watched(&self, w: WatchId) -> String {
        self.signals.get(&w).cloned().unwrap_or_else(|| (w.0 + 1).to_string())
    }

    /// Declares a memory for a list that several statements read.
    pub(crate) fn any(&mut self) -> String {
        let name = self.given.counted("ANY");
        self.internal(&name, "BOOL", "one of several");
        name
    }

    /// A memory that stands for something else.
    fn other(&mut self, c: &Compiled, id: MemoryId, memory: &Memory) {
        let step = |m: &Self, s: StepId| m.of_step(s);
        let chart = |i: u32| c.symbols.charts.get(i as usize).map_or("", |c| &c.name).to_owned();
        let number = |n: u32| (n + 1).to_string();
        let (before, of, note) = match memory.what {
            What::Started => {
                self.call(id, "FIRST".into());
                self.internal("FIRST", "BOOL", "the first scan");
                if let Some(v) = self.declared.last_mut() {
                    v.init = vec![Ex::Bool(true)];
                }
                return;
            }
            What::Dt | What::Opening | What::Changed | What::Stepped => {
                let (name, note) = match memory.what {
                    What::Dt => ("SCAN_TIME", "time since the scan before"),
                    What::Opening => ("OPENING", "the first pass of a scan"),
                    What::Changed => ("CHANGED", "something changed in this pass"),
                    _ => ("STEPPED", "a step came on before the evolution"),
                };
                self.call(id, name.into());
                return self.internal(name, memory.ty.name(), note);
            }
            What::Variable(_) => ("H", String::new(), ""),
            What::BlockClock(_) => ("HT", String::new(), "the time of a block"),
            What::Work => ("WORK", String::new(), ""),
            What::Step(s) => ("X", step(self, s), ""),
            What::Next(s) => ("N", step(self, s), "the next situation"),
            What::Was(s) => ("W_X", step(self, s), "as the pass began"),
            What::On(s) => ("ON", step(self, s), "comes on"),
            What::Off(s) => ("OFF", step(self, s), "goes off"),
            What::Left(s) => ("LEFT", step(self, s), "left in this pass"),
            What::Came(s) => ("CAME", step(self, s), "entered in this pass"),
            What::StepTime(s) => ("XT", step(self, s), "since its activation"),
            What::StepScans(s) => ("XN", step(self, s), "scans since its activation"),
            What::GroupWas(g) => ("GW", number(g.0), "was active"),
            What::GroupTime(g) => ("GT", number(g.0), "since it came on"),
            What::GroupScans(g) => ("GN", number(g.0), "scans since it came on"),
            What::Watched(w) => ("WE", self.watched(w), ""),
            What::WatchedBefore(w) => ("WB", self.watched(w), "as the pass before began"),
            What::Rise(w) => ("RE", self.watched(w), "rose"),
            What::Fall(w) => ("FE", self.watched(w), "fell"),
            What::Timer(w) => ("TM", self.watched(w), "a delay"),
            What::TimerClock(w) => ("WT", self.watched(w), "since it changed"),
            What::Until(p) => ("UNTIL", p.to_string(), "time until the period is due"),
            What::Due(p) => ("DUE", p.to_string(), "the period is due"),
            What::Receptivity(r) => ("R", self.of_transition(r), "its receptivity"),
            What::Clearable(r) => ("C", self.of_transition(r), "clearable"),
            What::Clears(r) => ("T", self.of_transition(r), ""),
            What::Settled(s) => ("FOUND", step(self, s), "one of its transitions is clearable"),
            What::Taken(s) => ("TAKEN", step(self, s), "a transition has taken it"),
            What::Blocked(i) => ("FORCED", chart(i), "its transitions do not clear"),
            What::Asks(o) => ("ASKS", number(o), "a forcing order acts"),
            What::Imposes(o) => ("IMPOSES", number(o), "the first order on its chart"),
            What::Disagree(i) => ("DISAGREE", chart(i), "orders that disagree"),
            What::Runs(a) => ("A", number(a), "this action runs"),
            What::Late(a) => ("L", number(a), "runs at the end of the scan"),
            What::Ran(a) => ("RAN", number(a), "has run in this scan"),
            What::Periodic(r) => ("B", number(r), "its step was active as the scan began"),
            What::Own(m) => ("OWN", self.name(m).to_owned(), ""),
            What::OwnWrote(m) => ("OWW", self.name(m).to_owned(), "this action wrote it"),
            What::Given(m) => ("NX", self.name(m).to_owned(), "what stored actions write"),
            What::Wrote(m) => ("NXW", self.name(m).to_owned(), "a stored action wrote it"),
            What::Conflict(m) => ("CONFLICT", self.name(m).to_owned(), ""),
            What::Begun(m) => ("P", self.name(m).to_owned(), "as the pass began"),
            What::Condition(r) => ("BC", number(r), "a condition of an action"),
            What::Control(b, part) => return self.control(c, id, memory, (b, part)),
            What::RequestStart => ("START", "all".into(), "all charts are to start anew"),
            What::RequestInit(g) => ("INIT", number(g.0), "is to take its initial situation"),
            What::RequestClear(g) => ("CLEAR", number(g.0), "is to be cleared"),
            What::RequestSet(s) => ("SET", step(self, s), "is to be set"),
            What::RequestReset(s) => ("RESET", step(self, s), "is to be reset"),
            What::Enabled(r) => ("E", self.of_transition(r), "enabled before the evolution"),
            What::StepCount => ("STEPS", "count".into(), ""),
            What::TransitionCount => ("TRANSITIONS", "count".into(), ""),
            What::Returned(n) => ("LEAVE", n.to_string(), "RETURN was reached"),
            What::Temporary(_) => ("Z", String::new(), ""),
            // No memories of equations.
            What::GroupActive(_) | What::ResetTimes | What::Clock | What::Stamp(_) => return,
        };
        self.named(id, memory, (before, &of), note);
    }

    /// The part of a control block: `B_motor_S_FF`.
    fn control(&mut self, c: &Compiled, id: MemoryId, memory: &Memory, (block, part): (u32, Part)) {
        let own = c.symbols.blocks.get(block as usize).map_or("", |b| &b.name);
        let own = if own.is_empty() { (block + 1).to_string() } else { own.to_owned() };
        let input = |k: u8| INPUTS.get(usize::from(k)).copied().unwrap_or("").to_owned();
        let word = match part {
            Part::Before(k) => input(k) + "_WAS",
            Part::Stored => "S_FF".into(),
            Part::StoredDelayed => "SD_FF".into(),
            Part::DelayedStored => "DS_FF".into(),
            Part::StoredLimited => "SL_FF".into(),
            Part::Time(k) => input(k) + "_TIME",
            Part::Clock(k) => input(k) + "_CLOCK",
            Part::Level => "A_WAS".into(),
            Part::Written => "GIVEN".into(),
            Part::Early(k) => input(k) + "_EARLY",
            Part::Q => "Q".into(),
        };
        self.named(id, memory, ("B", &format!("{own}_{word}")), "");
    }

    fn named(&mut self, id: MemoryId, memory: &Memory, (before, of): (&str, &str), note: &str) {
        let name = if of.is_empty() { self.given.counted(before) } else { self.given.with(before, of) };
        self.call(id, name.clone());
        self.declare(form::Class::Internal, &name, memory, note.to_owned());
    }
}
