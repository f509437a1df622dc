//! The engine as a [`Subject`]: compiles and runs a document, and reads the values back by name.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_compile::{Compiled, compile_with};
use g7_engine::{FaultKind, State, StepId, eval, pass, scan};
use g7_model::{Document, Expr, ProfileName, Type};

use crate::naive::Value;
use crate::subject::{Fault, Subject};

struct Engine {
    compiled: Compiled,
    state: State,
    inputs: Vec<u64>,
    queries: Vec<Expr>,
    conflicts: Vec<String>,
}

/// Compiles a document together with the expressions that will be evaluated.
///
/// # Errors
///
/// The first problem that is an error.
pub fn engine(
    doc: &Document,
    profile: Option<ProfileName>,
    queries: &[Expr],
) -> Result<Box<dyn Subject>, String> {
    with_program(doc, profile, queries, Ok)
}

/// The same, with a program that was changed after compilation.
pub(crate) fn with_program(
    doc: &Document,
    profile: Option<ProfileName>,
    queries: &[Expr],
    change: impl FnOnce(g7_engine::Program) -> Result<g7_engine::Program, String>,
) -> Result<Box<dyn Subject>, String> {
    // A document keeps its switches under its own profile.
    let profile = profile.filter(|p| *p != doc.profile().map(|d| d.name).unwrap_or_default());
    let (compiled, problems) = compile_with(doc, profile, queries);
    let Some(mut compiled) = compiled else {
        let first = problems.iter().find(|p| p.severity() == g7_model::Severity::Error);
        return Err(first.map_or("no program".into(), |p| format!("{} {}", p.code.id, p.what)));
    };
    compiled.program = change(Arc::unwrap_or_clone(compiled.program))?.into();
    let state = State::new(&compiled.program);
    let inputs = compiled.program.tables().inputs;
    let inputs = state.words().get(inputs.start as usize..inputs.end as usize).unwrap_or(&[]).to_vec();
    Ok(Box::new(Engine { compiled, state, inputs, queries: queries.to_vec(), conflicts: Vec::new() }))
}

impl Engine {
    fn visible(&self) -> impl Iterator<Item = &Variable> {
        let shown = |v: &&Variable| {
            let own =
                matches!(v.class, VarClass::Input | VarClass::Output | VarClass::Internal | VarClass::System);
            own && !matches!(v.ty, Type::Fb(_))
        };
        self.compiled.symbols.variables.iter().filter(shown)
    }

    fn cycle(&mut self, passes: u32) -> Vec<BTreeSet<String>> {
        // The state at the fault lies on the cycle: further passes walk round it.
        let mut walk = self.state.clone();
        let mut cycle = Vec::new();
        for _ in 0..passes {
            if pass(&self.compiled.program, &mut walk).is_err() {
                break;
            }
            cycle.push(self.situation(&walk));
        }
        cycle
    }

    fn situation(&self, state: &State) -> BTreeSet<String> {
        let symbols = &self.compiled.symbols;
        state.active().filter(|s| symbols.is_listed(*s)).map(|s| symbols.step_path(s).to_owned()).collect()
    }
}

pub(crate) fn value(ty: Type, words: &[u64]) -> Value {
    let word = words.first().copied().unwrap_or(0);
    match ty {
        Type::Bool => Value::Bool(word != 0),
        Type::Sint | Type::Int | Type::Dint | Type::Lint => Value::Int((word as i64).into()),
        Type::Usint
        | Type::Uint
        | Type::Udint
        | Type::Ulint
        | Type::Byte
        | Type::Word
        | Type::Dword
        | Type::Lword => Value::Int(word.into()),
        Type::Real => Value::Real(f32::from_bits(word as u32)),
        Type::Lreal => Value::Lreal(f64::from_bits(word)),
        Type::Time | Type::Moment(_) => Value::Time(word as i64),
        Type::String(_) => {
            let bytes: Vec<u8> =
                words.iter().skip(1).flat_map(|w| w.to_le_bytes()).take(word as usize).collect();
            Value::Str(String::from_utf8_lossy(&bytes).into_owned())
        }
        Type::Fb(_) => Value::Bool(false),
    }
}

pub(crate) fn words(value: &Value) -> Vec<u64> {
    match value {
        Value::Bool(b) => vec![u64::from(*b)],
        Value::Int(n) => vec![*n as u64],
        Value::Real(x) => vec![x.to_bits().into()],
        Value::Lreal(x) => vec![x.to_bits()],
        Value::Time(t) => vec![*t as u64],
        Value::Str(s) => {
            let chunks = s.as_bytes().chunks(8);
            let packed = chunks.map(|c| c.iter().rev().fold(0, |acc, b| acc << 8 | u64::from(*b)));
            [s.len() as u64].into_iter().chain(packed).collect()
        }
        Value::Fb(_) => Vec::new(),
    }
}

impl Subject for Engine {
    fn scan(&mut self, inputs: &BTreeMap<String, Value>, now: i64) -> Result<(), Fault> {
        self.conflicts.clear();
        let start = self.compiled.program.tables().inputs.start;
        for (name, value) in inputs {
            let Some(v) = self.compiled.symbols.variable(name) else {
                return Err(Fault::Other(format!("no input {name}")));
            };
            // A system bit is set by the terminal, before the scan.
            if v.class == VarClass::System {
                let word = words(value).first().copied().unwrap_or(0);
                self.state.set_word(&self.compiled.program, v.addr, word);
                continue;
            }
            for (i, word) in words(value).into_iter().enumerate() {
                if let Some(slot) = self.inputs.get_mut((v.addr.0 - start) as usize + i) {
                    *slot = word;
                }
            }
        }
        match scan(&self.compiled.program, &mut self.state, &self.inputs, now) {
            Ok(report) => {
                let conflict = report.conflict.and_then(|a| self.compiled.symbols.variable_at(a));
                self.conflicts.extend(conflict.map(|v| v.name.to_string()));
                Ok(())
            }
            Err(fault) => Err(match fault.kind {
                FaultKind::Unstable { cycle } => Fault::Unstable(self.cycle(cycle)),
                FaultKind::Inputs | FaultKind::Stopped => Fault::Other(fault.kind.to_string()),
                FaultKind::Bound
                | FaultKind::Overflow
                | FaultKind::DivisionByZero
                | FaultKind::Range
                | FaultKind::Work
                | FaultKind::Forcing { .. }
                | FaultKind::Table => Fault::Kind(fault.kind.word()),
            }),
        }
    }

    fn restart(&mut self, cold: bool) {
        let symbols = &self.compiled.symbols;
        let mut fresh = State::new(&self.compiled.program);
        if !cold {
            for v in symbols.variables.iter().filter(|v| v.retain) {
                for (i, word) in v.value(&self.state).iter().enumerate() {
                    fresh.set_word(&self.compiled.program, g7_engine::Addr(v.addr.0 + i as u32), *word);
                }
            }
            for (addr, word) in [(symbols.s0, 0), (symbols.s1, 1)] {
                if let Some(addr) = addr {
                    fresh.set_word(&self.compiled.program, addr, word);
                }
            }
        }
        self.state = fresh;
    }

    fn active(&self) -> BTreeSet<String> {
        self.situation(&self.state)
    }

    fn outputs(&self) -> BTreeMap<String, Value> {
        let outputs = self.visible().filter(|v| v.class == VarClass::Output);
        outputs.map(|v| (v.name.to_string(), value(v.ty, v.value(&self.state)))).collect()
    }

    fn variables(&self) -> BTreeMap<String, Value> {
        self.visible().map(|v| (v.name.to_string(), value(v.ty, v.value(&self.state)))).collect()
    }

    fn step_times(&self) -> BTreeMap<String, i64> {
        let symbols = &self.compiled.symbols;
        let steps = (0..symbols.steps()).map(StepId).filter(|s| symbols.is_listed(*s));
        let program = &self.compiled.program;
        steps.map(|s| (symbols.step_path(s).to_owned(), self.state.step_time(program, s))).collect()
    }

    fn conflicts(&self) -> Vec<String> {
        self.conflicts.clone()
    }

    fn holds(&mut self, e: &Expr) -> Result<bool, String> {
        let Some(at) = self.queries.iter().position(|q| q == e) else { return Err("not asked for".into()) };
        let Some(code) = self.compiled.queries.get(at) else { return Err("not compiled".into()) };
        let word = eval(&self.compiled.program, &mut self.state, *code).map_err(|f| f.kind.to_string())?;
        Ok(word != 0)
    }
}
