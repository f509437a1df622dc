//! The uses of variables, steps and charts in the unit, found in one walk
//! before anything is emitted.
//!
//! The walk decides what costs something at run time: which macro-steps need a
//! step of their own, which outputs may be written with their step at once,
//! which charts can be frozen.

use crate::ir::{
    ActionKind, ChartId, Expr, ExprKind, Service, StepId, Stmt, StmtKind, Target, Unit, Value, VarId,
};
use g7_model::Qualifier;

/// Nesting beyond which a chart is refused; see [`super::work::Lower::expr`].
pub(super) const DEPTH: u32 = 1000;

/// The uses found.
pub(super) struct Uses<'a> {
    /// By variable: read by a receptivity, watch, condition or stored action,
    /// which may run before the end of the scan.
    pub(super) early: Vec<bool>,
    /// By variable: written by a statement.
    pub(super) written: Vec<bool>,
    /// By variable: named anywhere.
    pub(super) named: Vec<bool>,
    /// By chart: `FREEZECHART` names it.
    pub(super) frozen: Vec<bool>,
    /// By step: `enable`, `mask` or `call` stands in it, or other actions.
    pub(super) acts: Vec<bool>,
    /// Every text that is written.
    pub(super) texts: Vec<&'a str>,
    /// Something asks for a random number.
    pub(super) random: bool,
    /// Operands and operators written, about as many as there will be instructions.
    pub(super) size: usize,
}

static NO_TIME: Option<Expr> = None;

struct Walk<'a> {
    unit: &'a Unit,
    uses: Uses<'a>,
    /// Reads from here on come before the end of the scan.
    early: bool,
    depth: u32,
}

/// Looks through the unit and the queries on it.
pub(super) fn uses<'a>(unit: &'a Unit, queries: &'a [Expr]) -> Uses<'a> {
    let vars = unit.vars.len();
    let uses = Uses {
        early: vec![false; vars],
        written: vec![false; vars],
        named: vec![false; vars],
        frozen: vec![false; unit.charts.len()],
        acts: unit.steps.iter().map(|s| !s.actions.is_empty() || !s.calls.is_empty()).collect(),
        texts: vec![""],
        random: false,
        size: 0,
    };
    let mut walk = Walk { unit, uses, early: true, depth: 0 };
    for t in &unit.transitions {
        walk.expr(&t.receptivity);
        walk.stmts(&t.on_clearing);
    }
    // Inlined wherever they are called, so they may run at any time.
    for f in &unit.functions {
        walk.stmts(&f.statements);
    }
    for s in &unit.sections {
        walk.stmts(&s.statements);
    }
    walk.actions();
    // PRE of the first scan comes behind the activation of the initial steps.
    for body in &unit.pre {
        walk.stmts(&body.statements);
    }
    walk.early = false;
    for body in &unit.post {
        walk.stmts(&body.statements);
    }
    for e in queries {
        walk.expr(e);
    }
    walk.uses
}

impl<'a> Walk<'a> {
    #[inline(never)]
    fn actions(&mut self) {
        let unit = self.unit;
        // Pulses of bodies run within the pass in some profiles.
        let mut early_bodies = vec![false; unit.bodies.len()];
        for action in unit.steps.iter().flat_map(|s| &s.actions) {
            match &action.kind {
                ActionKind::Variable { time, var, condition, .. } => {
                    self.name(*var);
                    self.conditions(time, condition);
                }
                ActionKind::Named { qualifier, time, body, condition } => {
                    self.conditions(time, condition);
                    if let Some(early) = early_bodies.get_mut(body.index()) {
                        *early |= self.within_pass(*qualifier);
                    }
                }
                ActionKind::Work { qualifier, time, work, condition } => {
                    self.conditions(time, condition);
                    self.early = self.within_pass(*qualifier);
                    self.stmts(work);
                    self.early = true;
                }
                ActionKind::OnEvent { event, work } => {
                    self.expr(event);
                    self.stmts(work);
                }
                ActionKind::EachScan { work, condition } => {
                    self.conditions(&NO_TIME, condition);
                    // JGrafchart's periodic actions still see the outputs of the scan before.
                    self.early = unit.rules.periodic_first;
                    self.stmts(work);
                    self.early = true;
                }
                ActionKind::MaskVar(var) => self.name(*var),
                ActionKind::Force(..) | ActionKind::Enable(_) | ActionKind::MaskChart(_) => {}
            }
        }
        for (body, early) in unit.bodies.iter().zip(early_bodies) {
            self.early = early;
            self.stmts(&body.statements);
        }
        self.early = true;
    }

    fn within_pass(&self, qualifier: Qualifier) -> bool {
        !self.unit.rules.late_actions && matches!(qualifier, Qualifier::P1 | Qualifier::P0)
    }

    fn conditions(&mut self, time: &'a Option<Expr>, condition: &'a Option<Expr>) {
        for e in [time, condition].into_iter().flatten() {
            self.expr(e);
        }
    }

    fn name(&mut self, var: VarId) {
        if let Some(n) = self.uses.named.get_mut(var.index()) {
            *n = true;
        }
    }

    fn read(&mut self, var: VarId) {
        self.name(var);
        if self.early
            && let Some(e) = self.uses.early.get_mut(var.index())
        {
            *e = true;
        }
    }

    fn write(&mut self, var: VarId) {
        self.name(var);
        if let Some(w) = self.uses.written.get_mut(var.index()) {
            *w = true;
        }
    }

    fn watched(&mut self, e: &'a Expr) {
        let early = std::mem::replace(&mut self.early, true);
        self.expr(e);
        self.early = early;
    }

    fn expr(&mut self, e: &'a Expr) {
        if self.depth > DEPTH {
            return; // the emitter reports it
        }
        self.depth += 1;
        self.uses.size += 1;
        // Long sums lean to the left; go down them without recursion.
        let mut e = e;
        while let ExprKind::Binary(_, left, right) = &e.kind {
            self.expr(right);
            self.uses.size += 1;
            e = left;
        }
        match &e.kind {
            ExprKind::Const(Value::Str(text)) => self.uses.texts.push(text),
            ExprKind::Const(_)
            | ExprKind::StepActive(_)
            | ExprKind::StepTime(_)
            | ExprKind::StepTenths(_)
            | ExprKind::StepScans(_)
            | ExprKind::StepSeconds(_)
            | ExprKind::ScanTime
            | ExprKind::Section(_) => {}
            ExprKind::Random => self.uses.random = true,
            ExprKind::Var(v) | ExprKind::Member(v, _) => self.read(*v),
            ExprKind::Element(all, index) => {
                all.iter().for_each(|v| self.read(v));
                index.iter().for_each(|e| self.expr(e));
            }
            ExprKind::Not(x) | ExprKind::Neg(x) | ExprKind::Convert(x) | ExprKind::Trunc(x) => self.expr(x),
            ExprKind::Rise(x) | ExprKind::Fall(x) => self.watched(x),
            ExprKind::Timer { t1, e, t2 } => {
                self.expr(t1);
                self.watched(e);
                if let Some(t2) = t2 {
                    self.expr(t2);
                }
            }
            ExprKind::Builtin(_, args) | ExprKind::Call(_, args) => {
                for a in args {
                    self.expr(a);
                }
            }
            ExprKind::Binary(..) => {} // gone down above
        }
        self.depth -= 1;
    }

    fn target(&mut self, t: &'a Target) {
        match t {
            Target::Var(v) | Target::Member(v, _) => self.write(*v),
            Target::Element(all, index) => {
                all.iter().for_each(|v| self.write(v));
                index.iter().for_each(|e| self.expr(e));
            }
        }
    }

    fn stmts(&mut self, list: &'a [Stmt]) {
        if self.depth > DEPTH {
            return; // the emitter reports it
        }
        self.depth += 1;
        for s in list {
            self.stmt(s);
        }
        self.depth -= 1;
    }

    fn stmt(&mut self, s: &'a Stmt) {
        self.uses.size += 1;
        match &s.kind {
            StmtKind::Assign(target, e) => {
                self.target(target);
                self.expr(e);
            }
            StmtKind::Fb { var, inputs, outputs, .. } => {
                self.write(*var);
                inputs.iter().for_each(|(_, e)| self.expr(e));
                outputs.iter().for_each(|(_, t)| self.target(t));
            }
            StmtKind::If(arms, other) => {
                for (condition, then) in arms {
                    self.expr(condition);
                    self.stmts(then);
                }
                self.stmts(other);
            }
            StmtKind::Case(selector, arms, other) => {
                self.expr(selector);
                arms.iter().for_each(|(_, then)| self.stmts(then));
                self.stmts(other);
            }
            StmtKind::For { var, from, to, by, body } => {
                self.write(*var);
                self.read(*var);
                self.expr(from);
                self.expr(to);
                if let Some(by) = by {
                    self.expr(by);
                }
                self.stmts(body);
            }
            StmtKind::While(e, body) | StmtKind::Repeat(body, e) => {
                self.expr(e);
                self.stmts(body);
            }
            StmtKind::Service(Service::FreezeChart(chart, e)) => {
                if let Some(f) = self.uses.frozen.get_mut(ChartId::index(*chart)) {
                    *f = true;
                }
                self.expr(e);
            }
            StmtKind::Exit | StmtKind::Return | StmtKind::Service(_) => {}
        }
    }
}

/// `t/X12` without a second time: the step. It is not a timer but a look at the
/// step's own time.
pub(super) fn timed_step(e: &Expr, t2: Option<&Expr>) -> Option<StepId> {
    match (&e.kind, t2) {
        (ExprKind::StepActive(step), None) => Some(*step),
        _ => None,
    }
}
