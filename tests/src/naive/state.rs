//! Everything that a scan changes, as plain comparable data.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::VarKind;

use super::exec::Exec;
use super::model::{FILE, Model, ScopeId, StepId, VarId};
use super::value::{Run, Value, zero};

/// When a step was last activated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Timing {
    pub(super) since: i64,
    pub(super) since_scan: i64,
    /// Its time when it was deactivated last.
    pub(super) kept: i64,
    pub(super) kept_scans: i64,
}

/// The memory of one `↑e` or `↓e` in the text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    pub(super) before: bool,
    pub(super) here: bool,
}

/// The memory of one `t1/e/t2` in the text.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Timer {
    pub(super) input: bool,
    pub(super) since: i64,
    pub(super) q: bool,
}

/// The owner of a control block.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Owner {
    Var(VarId),
    Named(ScopeId, String),
    /// An assignment or a body without a name: its step, and its number there.
    Own(StepId, usize),
}

/// The flip-flops and timers of a control block (SEMANTICS section 5).
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Control {
    pub(super) s_ff: bool,
    pub(super) sd_ff: bool,
    pub(super) ds_ff: bool,
    pub(super) sl_ff: bool,
    /// The previous values of P, P1 and P0.
    pub(super) last: [bool; 3],
    /// P1 and P0 as seen before the evolution.
    pub(super) early: [bool; 2],
    /// The start times of the timers of L, D, SD, DS and SL, while their inputs are true.
    pub(super) starts: [Option<i64>; 5],
    /// The times that were last given for them.
    pub(super) times: [i64; 5],
    /// Q without P1 and P0 in the previous scan.
    pub(super) level: bool,
    /// The value that was last written to the variable.
    pub(super) written: bool,
}

/// A request of a Unity service that waits for its moment in the scan.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Request {
    Init(ScopeId),
    Clear(ScopeId),
    Freeze(ScopeId, bool),
    Set(StepId),
    Reset(StepId),
}

/// The state of a run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct State {
    pub(super) now: i64,
    pub(super) scan: i64,
    pub(super) vars: Vec<Value>,
    /// The active steps; a macro-step is listed from its activation to its deactivation.
    pub(super) active: BTreeSet<StepId>,
    /// The timing of steps; for macro-steps that of the step which runs their own actions.
    pub(super) timing: Vec<Timing>,
    /// The timing of the activity of macro-steps.
    pub(super) macro_timing: BTreeMap<StepId, Timing>,
    /// The next instant of each chart with a period.
    pub(super) due_next: BTreeMap<ScopeId, i64>,
    /// The edge memories, by the address of the expression in the model.
    pub(super) edges: BTreeMap<usize, Edge>,
    pub(super) timers: BTreeMap<usize, Timer>,
    /// The step for which a task is being executed.
    pub(super) owners: BTreeMap<ScopeId, StepId>,
    pub(super) frozen: BTreeSet<ScopeId>,
    /// `%S23` acts in this scan.
    pub(super) stopped: bool,
    pub(super) requests: Vec<Request>,
    pub(super) control: BTreeMap<Owner, Control>,
    /// The outputs of transition sections, as last computed by their transitions.
    pub(super) sections: BTreeMap<(ScopeId, String), bool>,
    /// The value that each qualified action last gave to its block; it stays while its chart is not
    /// due.
    pub(super) held: BTreeMap<(StepId, usize), bool>,
    /// The number of loop iterations in this scan.
    pub(super) work: u32,
}

impl State {
    /// The state before the first scan, with no active step; `kept` are the retained values.
    pub(super) fn new(m: &Model, kept: &BTreeMap<VarId, Value>) -> Run<State> {
        let mut state = State {
            now: 0,
            scan: 0,
            vars: m.vars.iter().map(|v| zero(v.ty)).collect(),
            active: BTreeSet::new(),
            timing: vec![Timing::default(); m.steps.len()],
            macro_timing: BTreeMap::new(),
            due_next: BTreeMap::new(),
            edges: BTreeMap::new(),
            timers: BTreeMap::new(),
            owners: BTreeMap::new(),
            frozen: BTreeSet::new(),
            stopped: false,
            requests: Vec::new(),
            control: BTreeMap::new(),
            sections: BTreeMap::new(),
            held: BTreeMap::new(),
            work: 0,
        };
        // Constants come first, because initial values may use them.
        for constants in [true, false] {
            for (id, var) in m.vars.iter().enumerate() {
                let Some(init) = &var.init else { continue };
                if (var.kind == VarKind::Const) == constants {
                    let value = Exec::new(m, &mut state).eval_for(var.scope, init, var.ty)?;
                    state.vars[id] = value;
                }
            }
        }
        for (&id, value) in kept {
            state.vars[id] = value.clone();
        }
        Ok(state)
    }

    /// True if a step is active; a macro-step is active if a step of its expansion is, at any
    /// depth.
    pub(super) fn is_active(&self, m: &Model, step: StepId) -> bool {
        match m.steps[step].expansion {
            None => self.active.contains(&step),
            Some((inner, ..)) => m
                .steps_within(inner)
                .iter()
                .any(|s| m.steps[*s].expansion.is_none() && self.active.contains(s)),
        }
    }

    fn timing_of(&self, m: &Model, step: StepId) -> Timing {
        if m.steps[step].expansion.is_some() {
            self.macro_timing.get(&step).copied().unwrap_or_default()
        } else {
            self.timing[step]
        }
    }

    /// The time since the latest activation.
    pub(super) fn time(&self, m: &Model, step: StepId) -> i64 {
        let t = self.timing_of(m, step);
        if self.is_active(m, step) {
            self.now - t.since
        } else if m.rules.keep_step_time {
            t.kept
        } else {
            0
        }
    }

    /// The number of scans since the latest activation.
    pub(super) fn scans(&self, m: &Model, step: StepId) -> i64 {
        let t = self.timing_of(m, step);
        if self.is_active(m, step) {
            self.scan - t.since_scan
        } else if m.rules.keep_step_time {
            t.kept_scans
        } else {
            0
        }
    }

    /// Sets a system bit or word, if the profile has it.
    pub(super) fn set_system(&mut self, m: &Model, name: &str, value: Value) {
        if let Some(&id) = m.addresses.get(name) {
            self.vars[id] = value;
        }
    }

    /// The value of a system bit.
    pub(super) fn system(&self, m: &Model, name: &str) -> bool {
        m.addresses.get(name).is_some_and(|&id| self.vars[id] == Value::Bool(true))
    }

    /// The values of the retained variables.
    pub(super) fn retained(&self, m: &Model) -> BTreeMap<VarId, Value> {
        (0..m.vars.len()).filter(|&v| m.vars[v].retain).map(|v| (v, self.vars[v].clone())).collect()
    }
}

impl Model {
    /// The situation at the start: initial steps of the charts that no step
    /// encloses, or an initial one; a task waits in its entry step. Activation
    /// links bring nothing in.
    pub(super) fn initial_steps(&self) -> BTreeSet<StepId> {
        let mut active = BTreeSet::new();
        for scope in FILE + 1..self.scopes.len() {
            let s = &self.scopes[scope];
            match s.kind {
                g7_model::ChartKind::Chart if s.enclosed_by.is_none() => {
                    for step in self.initial_of(scope) {
                        self.begin(step, &mut active);
                    }
                }
                g7_model::ChartKind::Task => {
                    if let Ok((entry, _)) = self.ends(scope) {
                        active.insert(entry);
                    }
                }
                g7_model::ChartKind::Chart | g7_model::ChartKind::Expansion => {}
            }
        }
        active
    }

    /// An initial step with the initial steps that it encloses.
    fn begin(&self, step: StepId, active: &mut BTreeSet<StepId>) {
        active.insert(step);
        active.extend(self.steps[step].expansion.map(|(_, entry, _)| entry));
        for &chart in &self.steps[step].encloses {
            for inner in self.initial_of(chart) {
                self.begin(inner, active);
            }
        }
    }

    pub(super) fn initial_of(&self, scope: ScopeId) -> Vec<StepId> {
        self.scopes[scope].steps.iter().copied().filter(|&s| self.steps[s].initial).collect()
    }

    /// Activates a step and the steps that come with it: the entry step of a macro-step, and the
    /// steps with an activation link in the charts that it encloses.
    pub(super) fn activate(&self, step: StepId, active: &mut BTreeSet<StepId>) {
        active.insert(step);
        if let Some((_, entry, _)) = self.steps[step].expansion {
            active.insert(entry);
        }
        for &chart in &self.steps[step].encloses {
            for &inner in &self.scopes[chart].steps {
                if self.steps[inner].linked {
                    self.activate(inner, active);
                }
            }
        }
    }

    /// The steps that are deactivated with a step: its expansion and its enclosed charts.
    pub(super) fn subordinates(&self, step: StepId) -> BTreeSet<StepId> {
        let mut all = BTreeSet::new();
        if let Some((inner, ..)) = self.steps[step].expansion {
            self.everything_in(inner, &mut all);
        }
        for &chart in &self.steps[step].encloses {
            self.everything_in(chart, &mut all);
        }
        all
    }

    /// Collects every step of a chart, of its expansions and of the charts enclosed in it.
    pub(super) fn everything_in(&self, scope: ScopeId, all: &mut BTreeSet<StepId>) {
        for &s in &self.scopes[scope].steps {
            all.insert(s);
            all.extend(self.subordinates(s));
        }
    }
}
