//! Actions: which are stored, which feed a control block, which run each scan.
//!
//! The rank of an action is its place among those that run at one moment.
//! Where stored actions act in parallel the kinds come one after the other
//! (clearing, deactivation, activation, event), else all go by the text, in some
//! profiles with the pulses P1 first and P0 last.

use g7_engine::{Action, Addr, Cmp, Code, Contribution, ControlBlock, Event, NONE, Num, Op};
use g7_model::{Qualifier, Span};

use super::Lower;
use super::associations::{Associations, Way};
use super::code::Buf;
use super::lists::Lists;
use super::plan::parent;
use crate::ir::{ActionKind, BodyId, ChartId, Expr, ExprKind, StepId, Stmt, TransitionId, Value, VarId};
use crate::symbols::ActionSymbol;

/// When an action runs, as far as its rank depends on it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Moment {
    Clearing,
    Activation,
    Deactivation,
    Event,
    /// At the end of the scan; for pulses only, which.
    End(Option<Qualifier>),
}

struct Pending {
    class: u8,
    row: Action,
    symbol: ActionSymbol,
}

/// What the actions of all steps come to, before ranks are known.
#[derive(Default)]
pub(super) struct Actions {
    pending: Vec<Pending>,
    pub(super) clearing: Clearing,
    pub(super) on: Lists<u32>,
    pub(super) off: Lists<u32>,
    pub(super) periodics: Lists<u32>,
    pub(super) events: Lists<Event>,
    pub(super) contributions: Lists<Contribution>,
    /// By step of the program: the output written with it.
    pub(super) direct: Vec<Addr>,
    /// By rank.
    pub(super) symbols: Vec<ActionSymbol>,
    pub(super) blocks: Vec<(Drives, Span)>,
    block_of_var: Vec<u32>,
    block_of_body: Vec<u32>,
    code_of_body: Vec<Option<Code>>,
}

/// The stored actions of transitions, by number, then by rank.
#[derive(Default)]
pub(super) struct Clearing {
    transitions: Vec<u32>,
    /// Of the hidden transitions of tasks, by chart.
    returns: Vec<u32>,
}

impl Clearing {
    pub(super) fn written(&self, id: TransitionId) -> u32 {
        self.transitions.get(id.index()).copied().unwrap_or(NONE)
    }

    pub(super) fn returning(&self, task: ChartId) -> u32 {
        self.returns.get(task.index()).copied().unwrap_or(NONE)
    }
}

/// What a control block drives.
#[derive(Clone, Copy)]
pub(super) enum Drives {
    Variable(VarId),
    Named(BodyId),
    Work,
}

/// The step that an action stands in.
#[derive(Clone, Copy)]
struct In {
    step: StepId,
    number: u32,
    period: u32,
    at: Span,
}

/// A qualifier with its time and condition.
#[derive(Clone, Copy)]
struct Terms<'a> {
    qualifier: Qualifier,
    time: Option<&'a Expr>,
    condition: Option<&'a Expr>,
}

impl Lower<'_> {
    /// Lowers the actions of all charts, in text order.
    pub(super) fn actions(&mut self) -> Actions {
        let unit = self.unit;
        let all = self.associations();
        let mut a = Actions {
            clearing: Clearing {
                transitions: vec![NONE; unit.transitions.len()],
                returns: vec![NONE; unit.charts.len()],
            },
            direct: vec![Addr(NONE); self.plan.source.len()],
            block_of_var: vec![NONE; unit.vars.len()],
            block_of_body: vec![NONE; unit.bodies.len()],
            code_of_body: vec![None; unit.bodies.len()],
            ..Actions::default()
        };
        for (i, chart) in unit.charts.iter().enumerate() {
            let id = ChartId(i as u32);
            if self.plan.chart(id).is_none() {
                continue;
            }
            let period = self.period(id);
            self.sets_free(&mut a, id);
            for t in chart.transitions.clone() {
                self.clearing(&mut a, t, period);
            }
            for s in chart.steps.clone() {
                let step = StepId(s);
                let (Some(row), Some(number)) = (unit.steps.get(s as usize), self.plan.own(step)) else {
                    continue;
                };
                for action in &row.actions {
                    let place = In { step, number: number.0, period, at: action.at };
                    self.action(&mut a, &all, place, &action.kind);
                }
            }
        }
        self.rank(&mut a);
        a
    }

    /// Puts the actions in their order and everything that names them after it.
    fn rank(&mut self, a: &mut Actions) {
        let mut order: Vec<u32> = (0..a.pending.len() as u32).collect();
        order.sort_by_key(|i| a.pending.get(*i as usize).map(|p| p.class));
        let mut rank = vec![NONE; order.len()];
        for (r, i) in order.iter().enumerate() {
            if let (Some(slot), Some(p)) = (rank.get_mut(*i as usize), a.pending.get(*i as usize)) {
                *slot = r as u32;
                self.t.actions.push(p.row);
                a.symbols.push(p.symbol);
            }
        }
        a.pending.clear();
        let to = |i: u32| rank.get(i as usize).copied().unwrap_or(NONE);
        a.clearing.transitions.iter_mut().chain(&mut a.clearing.returns).for_each(|c| *c = to(*c));
        for list in [&mut a.on, &mut a.off, &mut a.periodics] {
            list.map(to);
            list.sort_unique();
        }
        a.events.map(|e| Event { action: to(e.action), ..e });
        a.events.sort();
        a.contributions.sort();
        self.t.blocks.iter_mut().for_each(|b| b.action = to(b.action));
    }

    fn class(&self, moment: Moment) -> u8 {
        let rules = &self.unit.rules;
        let pulse = |q: Option<Qualifier>| match q {
            Some(Qualifier::P1) if rules.pulse_first => 0,
            Some(Qualifier::P0) if rules.pulse_first => 2,
            _ => 1,
        };
        let as_pulse = match moment {
            Moment::Activation => Some(Qualifier::P1),
            Moment::Deactivation => Some(Qualifier::P0),
            Moment::End(q) => q,
            Moment::Clearing | Moment::Event => None,
        };
        match moment {
            _ if !rules.parallel_actions => pulse(as_pulse),
            Moment::Activation | Moment::Deactivation if rules.late_actions => 10 + pulse(as_pulse),
            Moment::End(_) => 10 + pulse(as_pulse),
            Moment::Clearing => 0,
            Moment::Deactivation => 1,
            Moment::Activation => 2,
            Moment::Event => 3,
        }
    }

    fn add(&mut self, a: &mut Actions, moment: Moment, row: Action, at: Span) -> u32 {
        let hidden = at == Span::default();
        let class = self.class(moment);
        a.pending.push(Pending { class, row, symbol: ActionSymbol { at, hidden } });
        a.pending.len() as u32 - 1
    }

    /// The code of statements that stand for themselves.
    fn work(&mut self, period: u32, work: &[Stmt]) -> Code {
        let mut b = self.buf(period);
        self.stmts(&mut b, work);
        self.place(b)
    }

    /// The code of a named action, written once.
    fn body(&mut self, a: &mut Actions, all: &Associations, body: BodyId) -> Code {
        if let Some(code) = a.code_of_body.get(body.index()).copied().flatten() {
            return code;
        }
        let Some(row) = self.unit.bodies.get(body.index()) else { return Code::default() };
        let code = self.work(all.body(body).period(), &row.statements);
        if let Some(slot) = a.code_of_body.get_mut(body.index()) {
            *slot = Some(code);
        }
        code
    }

    /// A stored action on clearing. A transition out of a calling step gives the
    /// task free, one out of a task's entry step notes for whom it works.
    fn clearing(&mut self, a: &mut Actions, transition: u32, period: u32) {
        let unit = self.unit;
        let Some(t) = unit.transitions.get(transition as usize) else { return };
        let chart = unit.charts.get(t.chart.index());
        let begins = chart.is_some_and(|c| c.entry.is_some_and(|e| t.from.contains(&e)));
        let owner = self.owner(t.chart).filter(|_| begins);
        let ended: Vec<Addr> =
            t.from.iter().flat_map(|s| self.tasks_of(*s)).filter_map(|task| self.owner(task)).collect();
        if t.on_clearing.is_empty() && owner.is_none() && ended.is_empty() {
            return;
        }
        let mut b = self.buf(period);
        for owner in ended {
            b.op(Op::Push(0), Span::default());
            b.op(Op::Store(owner), Span::default());
        }
        if let Some(owner) = owner {
            self.take_over(&mut b, t.chart, owner);
        }
        self.stmts(&mut b, &t.on_clearing);
        let body = self.place(b);
        let at = if t.on_clearing.is_empty() { Span::default() } else { t.at };
        let row = Action { condition: Code::default(), body, period };
        let action = self.add(a, Moment::Clearing, row, at);
        if let Some(slot) = a.clearing.transitions.get_mut(transition as usize) {
            *slot = action;
        }
    }

    /// A task that goes back by itself is free.
    fn sets_free(&mut self, a: &mut Actions, task: ChartId) {
        let Some(owner) = self.owner(task) else { return };
        let mut b = self.buf(0);
        b.op(Op::Push(0), Span::default());
        b.op(Op::Store(owner), Span::default());
        let body = self.place(b);
        let row = Action { condition: Code::default(), body, period: 0 };
        let action = self.add(a, Moment::Clearing, row, Span::default());
        if let Some(slot) = a.clearing.returns.get_mut(task.index()) {
            *slot = action;
        }
    }

    /// Unless the task works for somebody already, notes the first caller, in
    /// text order, that was active as the pass began.
    fn take_over(&mut self, b: &mut Buf, task: ChartId, owner: Addr) {
        let at = Span::default();
        let callers = self.callers(task).to_vec();
        b.op(Op::Load(owner), at);
        b.op(Op::Push(0), at);
        b.op(Op::Compare(Cmp::Eq, Num::I64), at);
        let mut ends = vec![b.jump(Op::JumpUnless, at)];
        for (i, caller) in callers.iter().enumerate() {
            let was = self.plan.own(*caller).map_or(Op::Push(0), Op::WasActive);
            b.op(was, at);
            let next = b.jump(Op::JumpUnless, at);
            b.op(Op::Push(i as u64 + 1), at);
            b.op(Op::Store(owner), at);
            ends.push(b.jump(Op::Jump, at));
            b.land(next);
        }
        ends.into_iter().for_each(|jump| b.land(jump));
    }

    fn action(&mut self, a: &mut Actions, all: &Associations, place: In, kind: &ActionKind) {
        let none = Code::default();
        match kind {
            ActionKind::Variable { qualifier, time, var, condition } => {
                let terms =
                    Terms { qualifier: *qualifier, time: time.as_ref(), condition: condition.as_ref() };
                self.variable(a, all, place, terms, *var);
            }
            ActionKind::Named { qualifier, time, body, condition } => {
                let terms =
                    Terms { qualifier: *qualifier, time: time.as_ref(), condition: condition.as_ref() };
                if self.is_stored_pulse(*qualifier) && !self.unit.rules.late_actions {
                    let code = self.body(a, all, *body);
                    self.pulse(a, place, terms, code);
                } else {
                    let block = self.block_of_body(a, all, place, *body);
                    self.contribute(a, place, terms, Way::Block, block);
                }
            }
            ActionKind::Work { qualifier, time, work, condition } => {
                let terms =
                    Terms { qualifier: *qualifier, time: time.as_ref(), condition: condition.as_ref() };
                let code = self.work(place.period, work);
                if self.is_stored_pulse(*qualifier) && !self.needs_block(place, terms) {
                    self.pulse(a, place, terms, code);
                } else {
                    let pulse = self.is_stored_pulse(*qualifier).then_some(*qualifier);
                    let row = Action { condition: none, body: code, period: place.period };
                    let action = self.add(a, Moment::End(pulse), row, place.at);
                    let block = self.block(a, (Addr(NONE), action), place.period, Drives::Work, place.at);
                    self.contribute(a, place, terms, Way::Block, block);
                }
            }
            ActionKind::OnEvent { event, work } => {
                let event = self.code_of(place.period, event);
                let body = self.work(place.period, work);
                let row = Action { condition: none, body, period: place.period };
                let action = self.add(a, Moment::Event, row, place.at);
                a.events.add(place.number, Event { event, action });
            }
            ActionKind::EachScan { work, condition } => {
                let condition = self.condition(place.period, condition.as_ref());
                let body = self.work(place.period, work);
                let row = Action { condition, body, period: place.period };
                let action = self.add(a, Moment::End(None), row, place.at);
                a.periodics.add(place.number, action);
            }
            // Looked at with the charts, see `orders`.
            ActionKind::Force(..)
            | ActionKind::Enable(_)
            | ActionKind::MaskChart(_)
            | ActionKind::MaskVar(_) => {}
        }
    }

    fn is_stored_pulse(&self, qualifier: Qualifier) -> bool {
        matches!(qualifier, Qualifier::P1 | Qualifier::P0)
    }

    /// Whether a pulse without a name differs from its control block, of which
    /// it is the short form in profiles with `late_actions`: where the input of
    /// the block is more than the step, or a step can come and go within a scan.
    fn needs_block(&self, place: In, terms: Terms<'_>) -> bool {
        let chart = self.unit.steps.get(place.step.index()).map(|s| s.chart);
        let masked = || chart.is_some_and(|c| !self.masking_chart(c).is_empty());
        let rules = &self.unit.rules;
        rules.late_actions && (rules.stable || terms.condition.is_some() || masked())
    }

    /// The code of a condition; empty where it is always true.
    fn condition(&mut self, period: u32, condition: Option<&Expr>) -> Code {
        match condition {
            Some(Expr { kind: ExprKind::Const(Value::Bool(true)), .. }) | None => Code::default(),
            Some(e) => self.code_of(period, e),
        }
    }

    /// A stored action on activation (P1) or deactivation (P0).
    fn pulse(&mut self, a: &mut Actions, place: In, terms: Terms<'_>, body: Code) {
        let off = terms.qualifier == Qualifier::P0;
        let condition = self.condition(place.period, terms.condition);
        let moment = if off { Moment::Deactivation } else { Moment::Activation };
        let row = Action { condition, body, period: place.period };
        let action = self.add(a, moment, row, place.at);
        if off { &mut a.off } else { &mut a.on }.add(place.number, action);
    }

    fn variable(&mut self, a: &mut Actions, all: &Associations, place: In, terms: Terms<'_>, var: VarId) {
        let together = all.var(var);
        match self.way(terms.qualifier, together) {
            Way::Store(value) => {
                let mut b = self.buf(place.period);
                b.op(Op::Push(u64::from(value)), place.at);
                self.store(&mut b, var, place.at);
                let body = self.place(b);
                let condition = self.condition(place.period, terms.condition);
                let row = Action { condition, body, period: place.period };
                // Only pulses come first or last.
                let moment =
                    if self.unit.rules.parallel_actions { Moment::Activation } else { Moment::Event };
                let action = self.add(a, moment, row, place.at);
                a.on.add(place.number, action);
            }
            way @ (Way::Block | Way::Delayed | Way::Limited) => {
                let free = a.direct.get(place.number as usize) == Some(&Addr(NONE));
                if terms.qualifier == Qualifier::N
                    && terms.condition.is_none()
                    && free
                    && self.may_be_direct(place.step, var, together)
                {
                    if let Some(slot) = a.direct.get_mut(place.number as usize) {
                        *slot = self.words.addr(var);
                    }
                    return;
                }
                let block = self.block_of_var(a, all, place, var);
                self.contribute(a, place, terms, way, block);
            }
        }
    }

    fn block_of_var(&mut self, a: &mut Actions, all: &Associations, place: In, var: VarId) -> u32 {
        let known = a.block_of_var.get(var.index()).copied().unwrap_or(NONE);
        if known != NONE {
            return known;
        }
        let together = all.var(var);
        let masks = self.masking(var).to_vec();
        let gate = if masks.is_empty() {
            Code::default()
        } else {
            let mut b = self.buf(together.period());
            self.any_acting(&mut b, &masks, place.at);
            b.op(Op::Not, place.at);
            self.place(b)
        };
        let block =
            self.block(a, (self.words.addr(var), NONE), together.period(), Drives::Variable(var), place.at);
        if let Some(row) = self.t.blocks.last_mut() {
            row.gate = gate;
            row.plain = together.is_plain();
        }
        if let Some(slot) = a.block_of_var.get_mut(var.index()) {
            *slot = block;
        }
        block
    }

    fn block_of_body(&mut self, a: &mut Actions, all: &Associations, place: In, body: BodyId) -> u32 {
        let known = a.block_of_body.get(body.index()).copied().unwrap_or(NONE);
        if known != NONE {
            return known;
        }
        let together = all.body(body);
        let code = self.body(a, all, body);
        let row = Action { condition: Code::default(), body: code, period: together.period() };
        let action = self.add(a, Moment::End(together.pulse()), row, place.at);
        let at = self.unit.bodies.get(body.index()).map_or(place.at, |b| b.at);
        let block = self.block(a, (Addr(NONE), action), together.period(), Drives::Named(body), at);
        if let Some(slot) = a.block_of_body.get_mut(body.index()) {
            *slot = block;
        }
        block
    }

    fn block(
        &mut self,
        a: &mut Actions,
        (output, action): (Addr, u32),
        period: u32,
        drives: Drives,
        at: Span,
    ) -> u32 {
        self.t.blocks.push(ControlBlock { output, action, plain: false, gate: Code::default(), period });
        a.blocks.push((drives, at));
        self.t.blocks.len() as u32 - 1
    }

    /// One step's input to a control block: its condition, the time before or
    /// after which it holds, and what masks its chart, ANDed.
    fn contribute(&mut self, a: &mut Actions, place: In, terms: Terms<'_>, way: Way, block: u32) {
        let masks =
            self.unit.steps.get(place.step.index()).map(|s| self.masking_chart(s.chart)).unwrap_or_default();
        let mut b = self.buf(place.period);
        let mut any = false;
        let mut and = |b: &mut Buf| {
            if std::mem::replace(&mut any, true) {
                b.op(Op::And, place.at);
            }
        };
        if let Some(e) = terms.condition.filter(|e| !matches!(e.kind, ExprKind::Const(Value::Bool(true)))) {
            self.expr(&mut b, e);
            and(&mut b);
        }
        if let (Way::Delayed | Way::Limited, Some(time)) = (way, terms.time) {
            self.acting_time(&mut b, place.step, place.at);
            self.expr(&mut b, time);
            let c = if way == Way::Delayed { Cmp::Ge } else { Cmp::Lt };
            b.op(Op::Compare(c, Num::I64), place.at);
            and(&mut b);
        }
        if !masks.is_empty() {
            self.any_acting(&mut b, &masks, place.at);
            b.op(Op::Not, place.at);
            and(&mut b);
        }
        let condition = self.place(b);
        let (input, time) = match (way, terms.time) {
            (Way::Delayed | Way::Limited, _) => (0, Code::default()),
            (_, Some(e)) if terms.qualifier.timed() => {
                (input(terms.qualifier), self.code_of(place.period, e))
            }
            _ => (input(terms.qualifier), Code::default()),
        };
        let row = Contribution { block, input, condition, time, period: place.period };
        a.contributions.add(place.number, row);
    }

    /// The steps that mask a chart or one of the charts round it.
    pub(super) fn masking_chart(&self, chart: ChartId) -> Vec<StepId> {
        let mut found = Vec::new();
        if !self.has_masks {
            return found;
        }
        let mut at = Some(chart);
        for _ in 0..=super::plan::NESTING {
            let Some(c) = at else { break };
            found.extend(self.masked_charts.get(c.index()).into_iter().flatten());
            at = parent(self.unit, c).and_then(|m| self.unit.steps.get(m.index())).map(|s| s.chart);
        }
        found
    }

    /// The steps that mask a variable.
    pub(super) fn masking(&self, var: VarId) -> &[StepId] {
        self.masked_vars.get(&var).map_or(&[], Vec::as_slice)
    }
}

/// The place of a qualifier in [`g7_engine::INPUTS`].
fn input(qualifier: Qualifier) -> u8 {
    match qualifier {
        Qualifier::N => 0,
        Qualifier::S => 1,
        Qualifier::R => 2,
        Qualifier::L => 3,
        Qualifier::D => 4,
        Qualifier::P => 5,
        Qualifier::P1 => 6,
        Qualifier::P0 => 7,
        Qualifier::SD => 8,
        Qualifier::DS => 9,
        Qualifier::SL => 10,
    }
}
