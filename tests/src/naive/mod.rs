//! A second engine, written from `docs/spec/semantics.md` and `docs/decisions` alone: it walks
//! through the document as the author wrote it, looks names up when it meets them, and computes
//! everything anew in each pass. It is slow on purpose and independent: it uses neither
//! `g7-compile` nor `g7-engine`, so an error would have to be made twice to remain unseen.

mod arrays;
mod bits;
mod block_charts;
mod builtin;
mod composed;
mod control;
mod evolve;
mod exec;
mod fb;
mod force;
mod instances;
mod literals;
mod model;
mod moments;
mod named;
mod resolve;
mod sample;
mod scan;
mod state;
mod stmt;
mod stored;
mod value;

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use g7_model::{Document, Expr, ProfileName, Type, VarKind};

use exec::Exec;
use model::{FILE, Model};
use state::State;

pub use fb::FbState;
pub use value::{NaiveFault, Value};

/// The variables to which stored actions wrote different values in one pass of the last scan. A
/// user interface reports each once in a run.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    latest: Vec<String>,
}

impl Diagnostics {
    fn conflict(&mut self, variable: &str) {
        self.latest.push(variable.to_owned());
    }
}

/// Counts of what a scan did, for statistics.
#[derive(Clone, Debug, Default)]
pub struct Marks {
    /// The cleared transitions, by their position in the text.
    pub cleared: Vec<usize>,
    /// The number of passes.
    pub passes: usize,
}

/// A document that runs under the naive engine.
#[derive(Clone)]
pub struct Naive {
    model: Rc<Model>,
    state: State,
    first: bool,
    warm: bool,
    fault: Option<NaiveFault>,
    diagnostics: Diagnostics,
    marks: Marks,
    safe: BTreeMap<String, Value>,
}

impl Naive {
    /// Reads a document; `profile` replaces the profile written in it.
    ///
    /// # Errors
    ///
    /// The reason why the document has no meaning.
    pub fn new(doc: &Document, profile: Option<ProfileName>) -> Result<Naive, String> {
        let words = |f: NaiveFault| if let NaiveFault::Bad(w) = f { w } else { format!("{f:?}") };
        let mut model = Model::new(doc, profile).map_err(words)?;
        model.blocked_vars = control::blocked_vars(&model).map_err(words)?;
        let mut state = State::new(&model, &BTreeMap::new()).map_err(words)?;
        let mut safe = BTreeMap::new();
        for var in model.vars.iter().filter(|v| v.kind == VarKind::Output) {
            let value = match &var.safe {
                Some(e) => Exec::new(&model, &mut state).eval_for(var.scope, e, var.ty).map_err(words)?,
                None => value::zero(var.ty),
            };
            safe.insert(var.qualified.clone(), value);
        }
        Ok(Naive {
            model: Rc::new(model),
            state,
            first: true,
            warm: false,
            fault: None,
            diagnostics: Diagnostics::default(),
            marks: Marks::default(),
            safe,
        })
    }

    /// The active steps without macro-steps: `G.5`, `G.M3.E`.
    pub fn active(&self) -> BTreeSet<String> {
        self.situation_of(&self.state)
    }

    fn situation_of(&self, s: &State) -> BTreeSet<String> {
        let m = &self.model;
        let plain = s.active.iter().filter(|&&x| m.steps[x].expansion.is_none());
        plain.map(|&x| m.steps[x].qualified.clone()).collect()
    }

    /// All variables except constants; members of blocks are named `fb.Q`.
    pub fn variables(&self) -> Vec<(String, Type, Value)> {
        let mut all = Vec::new();
        for (var, value) in self.model.vars.iter().zip(&self.state.vars) {
            match value {
                _ if var.kind == VarKind::Const => {}
                Value::Fb(f) => {
                    for (member, value) in f.members() {
                        let ty = FbState::member_type(f.kind, member).unwrap_or(Type::Bool);
                        all.push((format!("{}.{member}", var.qualified), ty, value.clone()));
                    }
                }
                _ => all.push((var.qualified.clone(), var.ty, value.clone())),
            }
        }
        all
    }

    /// The value of a variable: `v`, `G.v`, `fb.Q`.
    pub fn variable(&self, name: &str) -> Option<Value> {
        self.variables().into_iter().find(|(n, ..)| n == name).map(|(.., v)| v)
    }

    /// The outputs that the plant receives: after a fault the safe values.
    pub fn outputs(&self) -> BTreeMap<String, Value> {
        if self.fault.is_some() {
            return self.safe.clone();
        }
        let vars = self.model.vars.iter().zip(&self.state.vars);
        vars.filter(|(v, _)| v.kind == VarKind::Output)
            .map(|(v, x)| (v.qualified.clone(), x.clone()))
            .collect()
    }

    /// The time of each step and macro-step, in nanoseconds, or in scans if the profile counts
    /// scans; the flag is false for macro-steps.
    pub fn step_times(&self) -> Vec<(String, i64, bool)> {
        let m = &self.model;
        let steps = (0..m.steps.len()).filter(|&s| m.is_live(m.steps[s].scope));
        steps
            .map(|x| {
                let t = if m.rules.scan_clock { self.state.scans(m, x) } else { self.state.time(m, x) };
                (m.steps[x].qualified.clone(), t, m.steps[x].expansion.is_none())
            })
            .collect()
    }

    /// The time of one step.
    pub fn step_time(&self, qualified: &str) -> Option<i64> {
        self.step_times().into_iter().find(|(n, ..)| n == qualified).map(|(_, t, _)| t)
    }

    /// Evaluates an expression on the present state; edges and timers inside it are false.
    ///
    /// # Errors
    ///
    /// It has no value.
    pub fn eval(&self, e: &Expr) -> Result<Value, NaiveFault> {
        let mut state = self.state.clone();
        // In a document with one chart, the expressions of tests may use its names without a
        // prefix.
        let scope = if self.model.scopes.len() == 2 { 1 } else { FILE };
        Ok(Exec::new(&self.model, &mut state).eval(scope, e)?.v)
    }

    /// Evaluates a constant expression as a value of a type.
    ///
    /// # Errors
    ///
    /// It is not a constant of this type.
    pub fn constant(&self, e: &Expr, ty: Type) -> Result<Value, NaiveFault> {
        let mut state = self.state.clone();
        Exec::new(&self.model, &mut state).eval_for(FILE, e, ty)
    }

    /// The variables for which the last scan reported conflicting assignments.
    pub fn conflicts(&self) -> &[String] {
        &self.diagnostics.latest
    }

    /// The counts of the last scan.
    pub fn marks(&self) -> &Marks {
        &self.marks
    }

    /// The fault that ended the run, if any.
    pub fn fault(&self) -> Option<&NaiveFault> {
        self.fault.as_ref()
    }

    /// The number of transitions in the document.
    pub fn transitions(&self) -> usize {
        self.model.transitions.len()
    }

    /// The inputs with their types.
    pub fn inputs(&self) -> Vec<(String, Type)> {
        let inputs = self.model.vars.iter().filter(|v| v.kind == VarKind::Input);
        inputs.map(|v| (v.qualified.clone(), v.ty)).collect()
    }
}
