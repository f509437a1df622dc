//! Actions in the forms of the standard. The standard has no conditions of actions, no actions on
//! events or on clearing, and none that run in each scan except the last.
//!
//! Such actions become bodies with the qualifier N that test their condition themselves.

use std::collections::HashMap;

use g7_model::{
    Action, ActionKind, Block, Expr, FbKind, Name, Nanos, Order, Qualifier, Said, Span, Step, StepKind, Stmt,
    Target, Type, Work, say,
};

use super::bodies::{At, MOST_CONSTANTS};
use super::form::Form;
use super::lower::{Drive, Formula, Lower};
use crate::nodes;
use crate::scopes::{Ref, StepKey, VarKey};

impl<'d> Lower<'d> {
    /// All actions that drive each variable.
    pub(super) fn drives(&self) -> HashMap<VarKey<'d>, Vec<Drive<'d>>> {
        let mut all: HashMap<VarKey, Vec<Drive>> = HashMap::new();
        for chart in 0..self.scopes.charts.len() {
            for (step, def) in self.scopes.steps_of(chart) {
                for (number, action) in def.actions.iter().enumerate() {
                    let ActionKind::Qualified { qualifier, time, target, condition } = &action.kind else {
                        continue;
                    };
                    if let Some(key) = self.driven(chart, target) {
                        let drive = Drive {
                            step,
                            number,
                            qualifier: *qualifier,
                            time: time.as_ref(),
                            condition: condition.as_ref(),
                        };
                        all.entry(key).or_default().push(drive);
                    }
                }
            }
        }
        all
    }

    /// The variable that an action drives.
    fn driven(&self, chart: usize, target: &Target) -> Option<VarKey<'d>> {
        match target {
            Target::Path(path) => match self.scopes.refer(Some(chart), &path.names) {
                Some(Ref::Var(key)) => Some(key),
                _ => None,
            },
            Target::Direct(address, _) => self.scopes.at(address),
            Target::Element(_) | Target::Work(_) => None,
        }
    }

    /// The actions of a step.
    pub(super) fn actions(&mut self, key: StepKey, step: &'d Step, at: &At<'d>) -> Vec<Action> {
        let mut made = Vec::new();
        for (number, action) in step.actions.iter().enumerate() {
            if let Some(kind) = self.action(key, number, action, at) {
                made.push(Action { kind, at: action.at });
            }
        }
        made
    }

    fn action(&mut self, key: StepKey, number: usize, action: &'d Action, at: &At<'d>) -> Option<ActionKind> {
        let span = action.at.0;
        let title = format!("{}_{}", self.names.step(key), number + 1);
        match &action.kind {
            ActionKind::Qualified { qualifier, time, target, condition } => {
                let drive = Drive {
                    step: key,
                    number,
                    qualifier: *qualifier,
                    time: time.as_ref(),
                    condition: condition.as_ref(),
                };
                match target {
                    Target::Work(work) => Some(self.body(&drive, work, span, at, &title)),
                    _ => self.target(&drive, target, span, at, &title),
                }
            }
            ActionKind::EachScan { work, condition } => {
                let mut is = self.active(key, span, at, 0);
                if let Some(c) = condition {
                    is = nodes::and(is, self.expr(c, at), span);
                }
                let list = self.work(work, at, &title);
                Some(body_of(Qualifier::N, vec![nodes::when(is, list, Vec::new(), span)], span))
            }
            ActionKind::OnEvent { event, work } => {
                let what =
                    say!("an action on event becomes a body of its step that runs behind the evolution");
                self.differs(span, what);
                let active = self.active(key, span, at, 0);
                let first = self.initial(key);
                let (mut list, _, was) = self.remembered(active, first, &title, span, at);
                let now = nodes::and(nodes::name(&[&was], span), self.expr(event, at), span);
                let work = self.work(work, at, &title);
                list.push(nodes::when(now, work, Vec::new(), span));
                Some(body_of(Qualifier::N, list, span))
            }
            ActionKind::Order(order) => {
                let what = match order {
                    Order::Force(..) => say!("a forcing order"),
                    Order::Enable(_) => say!("an order that enables a chart"),
                    Order::Mask(_) => say!("an order that masks"),
                    Order::Call(_) => say!("a call of a task"),
                    Order::Enclose(_) => say!("an enclosed chart"),
                };
                self.lost(span, say!("{what}, which IEC 61131-3 does not have: an order to another chart"));
                None
            }
            ActionKind::Comment(text) => Some(ActionKind::Comment(text.clone())),
        }
    }

    pub(super) fn work(&mut self, work: &'d Work, at: &At<'d>, title: &str) -> Vec<Stmt> {
        match work {
            Work::Single(stmt) => self.stmts(std::slice::from_ref(stmt), at),
            Work::Block(block) => self.block(block, at, title),
        }
    }

    /// A body that is written in its step.
    fn body(
        &mut self,
        drive: &Drive<'d>,
        work: &'d Work,
        span: Span,
        at: &At<'d>,
        title: &str,
    ) -> ActionKind {
        let list = self.work(work, at, title);
        self.body_with(drive, list, span, at, title)
    }

    fn body_with(
        &mut self,
        drive: &Drive<'d>,
        list: Vec<Stmt>,
        span: Span,
        at: &At<'d>,
        title: &str,
    ) -> ActionKind {
        let qualifier = drive.qualifier;
        let time = self.drive_time(drive, at);
        let plain = |list| ActionKind::Qualified {
            qualifier,
            time: time.clone(),
            target: Target::Work(work_of(list, span)),
            condition: None,
        };
        let Some(condition) = drive.condition else {
            return match (qualifier, self.final_scan) {
                (_, true) | (Qualifier::P0 | Qualifier::P1, _) => plain(list),
                (Qualifier::N, false) => {
                    let is = self.active(drive.step, span, at, 0);
                    body_of(Qualifier::N, vec![nodes::when(is, list, Vec::new(), span)], span)
                }
                (Qualifier::P, false) => body_of(Qualifier::P1, list, span),
                (_, false) => {
                    self.differs(
                        span,
                        say!("the body runs once more when its action ends, as in IEC 61131-3"),
                    );
                    plain(list)
                }
            };
        };
        if matches!(qualifier, Qualifier::P0 | Qualifier::P1) {
            let is = self.expr(condition, &At { condition: true, ..at.clone() });
            return plain(vec![nodes::when(is, list, Vec::new(), span)]);
        }
        let mut calls = Vec::new();
        let Some(is) = self.part(drive, title, &mut calls, span, at) else {
            self.lost(span, say!("the condition of a body that is stored has no form there"));
            return plain(list);
        };
        let mut whole = calls;
        let mut turn = is;
        if self.final_scan {
            let (keep, now, was) = self.remembered(turn, false, title, span, at);
            whole.extend(keep);
            turn = nodes::or(nodes::name(&[&now], span), nodes::name(&[&was], span), span);
        }
        whole.push(nodes::when(turn, list, Vec::new(), span));
        body_of(Qualifier::N, whole, span)
    }

    /// Keeps a value and its value at the previous run of the body. The body may end early, so
    /// these statements come first. Returns the statements and the names of the two variables.
    fn remembered(
        &mut self,
        value: Expr,
        first: bool,
        title: &str,
        span: Span,
        at: &At<'d>,
    ) -> (Vec<Stmt>, String, String) {
        let was = self.fresh(at.program, &format!("{title}_was"), Type::Bool, span);
        let now = self.fresh(at.program, &format!("{title}_on"), Type::Bool, span);
        if first
            && let Some(decl) = at.program.and_then(|p| self.new_vars.get_mut(p)).and_then(|v| v.last_mut())
        {
            decl.init = Some(nodes::boolean(true, span));
        }
        let keep = nodes::assign(nodes::name(&[&was], span), nodes::name(&[&now], span), span);
        let new = nodes::assign(nodes::name(&[&now], span), value, span);
        (vec![keep, new], now, was)
    }

    /// True while an action that is not stored is on: its step and its condition, by its qualifier.
    fn part(
        &mut self,
        drive: &Drive<'d>,
        title: &str,
        calls: &mut Vec<Stmt>,
        span: Span,
        at: &At<'d>,
    ) -> Option<Expr> {
        let mut is = self.active(drive.step, span, at, 0);
        if let Some(c) = drive.condition {
            is = nodes::and(is, self.expr(c, &At { condition: true, ..at.clone() }), span);
        }
        let (kind, input) = match drive.qualifier {
            Qualifier::N | Qualifier::S | Qualifier::R => return Some(is),
            Qualifier::D | Qualifier::L => (FbKind::Ton, "IN"),
            Qualifier::P => (FbKind::RTrig, "CLK"),
            _ => return None,
        };
        let block = self.fresh(at.program, &format!("{title}_timer"), Type::Fb(kind), span);
        let mut args = vec![(input, is.clone())];
        if kind == FbKind::Ton {
            args.push(("PT", self.drive_time(drive, at).unwrap_or_else(|| nodes::time(Nanos::ZERO, span))));
        }
        calls.push(nodes::invoke(nodes::path(&[&block], span), args, span));
        let q = nodes::name(&[&block, "Q"], span);
        Some(match drive.qualifier {
            Qualifier::L => nodes::and(is, nodes::not(q, span), span),
            _ => q,
        })
    }

    /// The time of a qualifier. That of D and L is read in each scan there, as a TON reads its PT.
    fn drive_time(&mut self, drive: &Drive<'d>, at: &At<'d>) -> Option<Expr> {
        let written = drive.time?;
        let time = self.time(written, at);
        let follows = matches!(drive.qualifier, Qualifier::D | Qualifier::L);
        if follows && self.folded(written, at.chart, MOST_CONSTANTS).is_none() {
            let name = Said::foreign(drive.qualifier.name());
            self.differs(
                written.at.0,
                say!(
                    "the time of {name} is read in each scan there; here it is read as the step is activated"
                ),
            );
        }
        Some(time)
    }

    /// A variable or a named action.
    fn target(
        &mut self,
        drive: &Drive<'d>,
        target: &'d Target,
        span: Span,
        at: &At<'d>,
        title: &str,
    ) -> Option<ActionKind> {
        if let Some(key) = self.driven(drive.step.0, target) {
            return self.driving(key, drive, span, at);
        }
        let (qualifier, time) = (drive.qualifier, self.drive_time(drive, at));
        if matches!(target, Target::Element(_)) {
            self.no_element(span);
            return None;
        }
        let Target::Path(path) = target else {
            self.lost(span, say!("what a step drives has a name; declare a variable at this address"));
            return None;
        };
        let Some(Ref::Action(home, action)) = self.scopes.refer(at.chart, &path.names) else {
            self.lost(span, say!("what a step drives is a variable or a named action"));
            return None;
        };
        let name = self.names.part(home, &action.name.text).unwrap_or(&action.name.text).to_string();
        let own = home.is_none_or(|h| self.program_of(h) == at.program);
        let uses = self.uses.get(&(home, &*action.name.text)).map_or(0, Vec::len);
        let bare = self.form == (Form::Codesys { bare: true });
        let apart = !self.final_scan && !bare && qualifier != Qualifier::N;
        if (drive.condition.is_some() || apart) && uses == 1 || !own {
            // The action has no other use, so its body is written in the step.
            let inner = At { chart: home.or(at.chart), ..at.clone() };
            let list = self.block(action.body.block(), &inner, title);
            return Some(self.body_with(drive, list, span, at, title));
        }
        if drive.condition.is_some() {
            self.lost(span, say!("the condition of an action that is used more than once has no form there"));
        }
        let target = Target::Path(nodes::path(&[&name], span));
        Some(ActionKind::Qualified { qualifier, time, target, condition: None })
    }

    /// A variable that a step drives: by its qualifier, or, if one of its actions has a condition,
    /// by bodies that assign its whole value.
    fn driving(&mut self, key: VarKey<'d>, drive: &Drive<'d>, span: Span, at: &At<'d>) -> Option<ActionKind> {
        if let Some(program) = at.program {
            self.written.insert((key, program));
        }
        let target = self.variable(key, span, at);
        let all = self.driven_by.get(&key).cloned().unwrap_or_default();
        if all.iter().any(|d| d.condition.is_some()) {
            if let Some(formula) = self.formula(key, &all, &target, span) {
                let mut list = formula.calls.get(&(drive.step, drive.number)).cloned().unwrap_or_default();
                list.extend(formula.stored.clone());
                list.push(nodes::assign(target, formula.value.clone(), span));
                self.formulas.insert(key, formula);
                return Some(body_of(Qualifier::N, list, span));
            }
            if drive.condition.is_some() {
                let what = say!("the condition of an action beside others of its variable has no form there");
                self.lost(span, what);
            }
        }
        let time = self.drive_time(drive, at);
        let g7_model::ExprKind::Path(path) = target.kind else { return None };
        let target = Target::Path(path);
        Some(ActionKind::Qualified { qualifier: drive.qualifier, time, target, condition: None })
    }

    /// The value of a variable, computed from all actions that drive it, in one program.
    fn formula(&mut self, key: VarKey<'d>, all: &[Drive<'d>], target: &Expr, span: Span) -> Option<Formula> {
        if let Some(known) = self.formulas.remove(&key) {
            return Some(known);
        }
        let has = |kinds: &[Qualifier]| all.iter().any(|d| kinds.contains(&d.qualifier));
        let program = self.program_of(all.first()?.step.0)?;
        if !all.iter().all(|d| self.program_of(d.step.0) == Some(program)) {
            return None;
        }
        // The parts that hold while a step is active, those that set, and those that reset.
        let none = nodes::boolean(false, span);
        let mut parts = [none.clone(), none.clone(), none];
        let mut calls = HashMap::new();
        for drive in all {
            let at = At { chart: Some(drive.step.0), program: Some(program), ..At::default() };
            let title = format!("{}_{}", self.names.step(drive.step), drive.number + 1);
            let mut own = Vec::new();
            let part = self.part(drive, &title, &mut own, span, &at)?;
            calls.insert((drive.step, drive.number), own);
            let [level, on, off] = &mut parts;
            let side = match drive.qualifier {
                Qualifier::S => on,
                Qualifier::R => off,
                _ => level,
            };
            *side = nodes::or(side.clone(), part, span);
        }
        let [level, on, off] = parts;
        let open = nodes::not(off, span);
        let holds = has(&[Qualifier::N, Qualifier::D, Qualifier::L, Qualifier::P]);
        if !holds {
            let value = nodes::and(nodes::or(target.clone(), on, span), open, span);
            return Some(Formula { value, stored: None, calls });
        }
        if !has(&[Qualifier::S]) {
            return Some(Formula { value: nodes::and(level, open, span), stored: None, calls });
        }
        // The value that was set stays in a memory of its own, so that it outlives the other parts, and they do not set it.
        let own = self.names.var(key.0, key.1).unwrap_or(key.1).to_string();
        let memory =
            nodes::name(&[&self.fresh(Some(program), &format!("{own}_set"), Type::Bool, span)], span);
        let kept = nodes::and(nodes::or(memory.clone(), on, span), open.clone(), span);
        let stored = Some(nodes::assign(memory.clone(), kept, span));
        let value = nodes::and(nodes::or(level, memory, span), open, span);
        Some(Formula { value, stored, calls })
    }

    /// An action on clearing runs with the step behind or before its transition, if that step has
    /// no other transition of this kind.
    pub(super) fn on_clearing(
        &mut self,
        t: &'d g7_model::Transition,
        block: &'d Block,
        chart: usize,
    ) -> Option<(StepKey, Action)> {
        let span = block.at.0;
        let count = |to: bool, name: &Name| {
            let all = self.scopes.chart(chart).into_iter().flat_map(|c| c.transitions());
            all.filter(|t| if to { &t.to } else { &t.from }.iter().any(|n| n.text == name.text)).count()
        };
        let plain = |name: &&Name| {
            let step = self.scopes.step_in(chart, &name.text).and_then(|s| self.scopes.step(s));
            step.is_some_and(|s| matches!(s.kind, StepKind::Plain) && !s.initial)
        };
        let alone = |name: &&Name| !t.to.iter().any(|n| n.text == name.text);
        let before = t.from.iter().filter(plain).filter(alone).find(|n| count(false, n) == 1);
        let behind = t.to.iter().filter(plain).find(|n| count(true, n) == 1);
        let (name, qualifier) = match (before, behind) {
            (Some(name), _) => (name, Qualifier::P0),
            (None, Some(name)) => (name, Qualifier::P1),
            (None, None) => {
                self.lost(span, say!("an action on clearing, of a transition that has no step for itself"));
                return None;
            }
        };
        let what = say!("an action on clearing becomes one of step `{}`, with {}", name.text, qualifier);
        self.differs(span, what);
        let key = self.scopes.step_in(chart, &name.text)?;
        let at = At { chart: Some(chart), program: self.program_of(chart), ..At::default() };
        let title = format!("{}_clearing", self.names.step(key));
        let list = self.block(block, &at, &title);
        Some((key, Action { kind: body_of(qualifier, list, span), at: block.at }))
    }
}

fn work_of(list: Vec<Stmt>, span: Span) -> Work {
    nodes::work(list, span)
}

fn body_of(qualifier: Qualifier, list: Vec<Stmt>, span: Span) -> ActionKind {
    ActionKind::Qualified {
        qualifier,
        time: None,
        target: Target::Work(work_of(list, span)),
        condition: None,
    }
}
