//! The equations behind the window of [`Subject`]: made, run by their interpreter,
//! and their memories read back by name.

use std::collections::{BTreeMap, BTreeSet};

use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_compile::{Compiled, compile_with};
use g7_engine::{Addr, FaultKind, StepId, Tables};
use g7_equations::{Machine, MemoryId, Options, StepTimes, Value as Held, What, equations as made};
use g7_model::{Document, Expr, ProfileName, Type};

use crate::engine::{value, words};
use crate::naive::Value;
use crate::subject::{Fault, Subject};

struct Equations {
    compiled: Compiled,
    machine: Machine,
    queries: Vec<Expr>,
}

/// Makes the equations of a document.
///
/// # Errors
///
/// The first problem that is an error.
pub fn equations(
    doc: &Document,
    profile: Option<ProfileName>,
    queries: &[Expr],
) -> Result<Box<dyn Subject>, String> {
    changed(doc, profile, queries, |_| {}, |_| {})
}

/// The same, but step times are stamps instead of clocks, as in printed code of the flat style.
///
/// # Errors
///
/// The first problem that is an error.
pub fn stamped(
    doc: &Document,
    profile: Option<ProfileName>,
    queries: &[Expr],
) -> Result<Box<dyn Subject>, String> {
    with_times(doc, profile, queries, StepTimes::Stamps, |_| {}, |_| {})
}

/// The same from tables that were changed before they are read, and from equations
/// that were changed before they run.
pub(crate) fn changed(
    doc: &Document,
    profile: Option<ProfileName>,
    queries: &[Expr],
    tables: impl FnOnce(&mut Tables),
    equations: impl FnOnce(&mut g7_equations::Equations),
) -> Result<Box<dyn Subject>, String> {
    with_times(doc, profile, queries, StepTimes::All, tables, equations)
}

fn with_times(
    doc: &Document,
    profile: Option<ProfileName>,
    queries: &[Expr],
    times: StepTimes,
    tables: impl FnOnce(&mut Tables),
    equations: impl FnOnce(&mut g7_equations::Equations),
) -> Result<Box<dyn Subject>, String> {
    let profile = profile.filter(|p| *p != doc.profile().map(|d| d.name).unwrap_or_default());
    let (compiled, problems) = compile_with(doc, profile, queries);
    let Some(mut compiled) = compiled else {
        let first = problems.iter().find(|p| p.severity() == g7_model::Severity::Error);
        return Err(first.map_or("no program".into(), |p| format!("{} {}", p.code.id, p.what)));
    };
    let mut changed = compiled.program.tables().clone();
    tables(&mut changed);
    compiled.program = g7_engine::Program::new(changed).map_err(|e| format!("{e:?}"))?.into();
    let mut made = made(&compiled, Options { times, conflicts: true, ..Options::default() });
    equations(&mut made);
    let machine = Machine::new(made);
    Ok(Box::new(Equations { compiled, machine, queries: queries.to_vec() }))
}

impl Equations {
    fn words(&self, v: &Variable) -> Vec<u64> {
        self.machine.words(v.addr).unwrap_or_else(|| {
            let init = &self.compiled.program.tables().init;
            init.get(v.addr.0 as usize..(v.addr.0 + v.words()) as usize).unwrap_or_default().to_vec()
        })
    }

    fn visible(&self, wanted: impl Fn(VarClass) -> bool) -> BTreeMap<String, Value> {
        let all = self.compiled.symbols.variables.iter();
        all.filter(|v| wanted(v.class) && !matches!(v.ty, Type::Fb(_)))
            .map(|v| (v.name.to_string(), value(v.ty, &self.words(v))))
            .collect()
    }

    fn set(&mut self, addr: Addr, words: &[u64]) {
        if let Some(id) = self.machine.equations().find(What::Variable(addr)) {
            self.machine.set(id, words);
        }
    }

    fn situation(&self, machine: &Machine) -> BTreeSet<String> {
        let symbols = &self.compiled.symbols;
        let steps = (0..symbols.steps()).map(StepId).filter(|s| symbols.is_listed(*s));
        let active = |s: &StepId| machine.equations().find(What::Step(*s)).is_some_and(|m| machine.holds(m));
        steps.filter(active).map(|s| symbols.step_path(s).to_owned()).collect()
    }

    fn cycle(&self, passes: u32) -> Vec<BTreeSet<String>> {
        let mut walk = self.machine.clone();
        let mut cycle = Vec::new();
        for _ in 0..passes {
            if walk.pass().is_err() {
                break;
            }
            cycle.push(self.situation(&walk));
        }
        cycle
    }
}

impl Subject for Equations {
    fn scan(&mut self, inputs: &BTreeMap<String, Value>, now: i64) -> Result<(), Fault> {
        for (name, value) in inputs {
            let Some(addr) = self.compiled.symbols.variable(name).map(|v| v.addr) else {
                return Err(Fault::Other(format!("no input {name}")));
            };
            self.set(addr, &words(value));
        }
        self.machine.scan(now).map_err(|kind| match kind {
            FaultKind::Unstable { cycle } => Fault::Unstable(self.cycle(cycle)),
            FaultKind::Inputs | FaultKind::Stopped => Fault::Other(kind.to_string()),
            kind => Fault::Kind(kind.word()),
        })
    }

    fn restart(&mut self, cold: bool) {
        let fresh = Machine::new(self.machine.equations().clone());
        let old = std::mem::replace(&mut self.machine, fresh);
        if cold {
            return;
        }
        let symbols = self.compiled.symbols.clone();
        for v in symbols.variables.iter().filter(|v| v.retain) {
            if let Some(words) = old.words(v.addr) {
                self.set(v.addr, &words);
            }
        }
        for (addr, word) in [(symbols.s0, 0), (symbols.s1, 1)] {
            if let Some(addr) = addr {
                self.set(addr, &[word]);
            }
        }
    }

    fn active(&self) -> BTreeSet<String> {
        self.situation(&self.machine)
    }

    fn outputs(&self) -> BTreeMap<String, Value> {
        self.visible(|c| c == VarClass::Output)
    }

    fn variables(&self) -> BTreeMap<String, Value> {
        self.visible(|c| {
            matches!(c, VarClass::Input | VarClass::Output | VarClass::Internal | VarClass::System)
        })
    }

    fn step_times(&self) -> BTreeMap<String, i64> {
        let symbols = &self.compiled.symbols;
        let e = self.machine.equations();
        let number = |memory: MemoryId| match self.machine.value(memory)? {
            Held::Words(w) => w.first().map(|w| *w as i64),
            Held::Text(_) => None,
        };
        let stamped = |s: StepId| {
            let stamp = number(e.find(What::Stamp(s))?)?;
            let is_active = e.find(What::Step(s)).is_some_and(|x| self.machine.holds(x));
            if is_active { Some(number(e.find(What::Clock)?)?.wrapping_sub(stamp)) } else { Some(stamp) }
        };
        let clock = |s: StepId| number(e.find(What::StepScans(s)).or_else(|| e.find(What::StepTime(s)))?);
        let time = |s: StepId| stamped(s).or_else(|| clock(s));
        let steps = (0..symbols.steps()).map(StepId).filter(|s| symbols.is_listed(*s));
        steps.map(|s| (symbols.step_path(s).to_owned(), time(s).unwrap_or(0))).collect()
    }

    fn conflicts(&self) -> Vec<String> {
        let e = self.machine.equations();
        let all = (0u32..).map(MemoryId).zip(&e.memories);
        let noted = all.filter(|(id, _)| self.machine.holds(*id)).filter_map(|(_, m)| match m.what {
            What::Conflict(of) => match e.memory(of)?.what {
                What::Variable(addr) => self.compiled.symbols.variable_at(addr),
                _ => None,
            },
            _ => None,
        });
        noted.map(|v| v.name.to_string()).collect()
    }

    fn holds(&mut self, e: &Expr) -> Result<bool, String> {
        let Some(at) = self.queries.iter().position(|q| q == e) else { return Err("not asked for".into()) };
        self.machine.ask(at).map(|w| w != 0).map_err(|kind| kind.to_string())
    }
}
