//! Actions: which are stored, which feed a control block, which run each scan.
//!
//! The rank of an action is its place among those that run at one moment. In a
//! pass the kinds come one after the other (clearing, deactivation, activation,
//! event), and within a kind the text decides. What runs at the end of a scan goes
//! by the text alone, in some profiles with the pulses P1 first and P0 last.

use g7_engine::{Action, Addr, Cmp, Code, Contribution, ControlBlock, Event, NONE};
use g7_model::{Qualifier, Span, Type};

use super::associations::{Associations, Way};
use super::lists::Lists;
use super::plan::parent;
use super::terms::store_word;
use super::work::Lower;
use crate::ir::{ActionKind, BodyId, ChartId, Expr, ExprKind, StepId, Stmt, TransitionId, Value, VarId};
use crate::symbols::ActionSymbol;
use crate::tree::{self, Gate};

/// How many kinds of actions a pass has.
const KINDS: u8 = 4;

/// When an action runs, as far as its rank depends on it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Moment {
    Clearing,
    Activation,
    /// S and R where they are assignments on activation: no pulses.
    Store,
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

/// The actions of all steps, before ranks are known.
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

/// The target of a control block.
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
    #[inline(never)]
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

    /// The part of an action's rank that comes before the text: its kind, and where
    /// pulses go first and last and each action sees those before it, its pulse.
    fn class(&self, moment: Moment) -> u8 {
        let rules = &self.unit.rules;
        let pulse = |q: Option<Qualifier>| match q {
            Some(Qualifier::P1) if rules.pulse_first => 0,
            Some(Qualifier::P0) if rules.pulse_first => 2,
            _ => 1,
        };
        let (kind, as_pulse) = match moment {
            Moment::Activation if rules.late_actions => (4, Some(Qualifier::P1)),
            Moment::Deactivation if rules.late_actions => (4, Some(Qualifier::P0)),
            Moment::Clearing => (0, None),
            Moment::Deactivation => (1, Some(Qualifier::P0)),
            Moment::Activation => (2, Some(Qualifier::P1)),
            Moment::Store => (2, None),
            Moment::Event => (3, None),
            Moment::End(q) => (4, q),
        };
        match kind {
            4 => 3 * KINDS + pulse(as_pulse),
            _ if rules.parallel_actions => kind,
            _ => pulse(as_pulse) * KINDS + kind,
        }
    }

    fn add(&mut self, a: &mut Actions, moment: Moment, row: Action, at: Span) -> u32 {
        let hidden = at == Span::default();
        let class = self.class(moment);
        a.pending.push(Pending { class, row, symbol: ActionSymbol { at, hidden } });
        a.pending.len() as u32 - 1
    }

    /// The code of statements that stand for themselves.
    fn statements(&mut self, period: u32, list: &[Stmt]) -> Code {
        let list = self.stmts(period, list);
        self.work(list)
    }

    /// The code of a named action, written once.
    fn body(&mut self, a: &mut Actions, all: &Associations, body: BodyId) -> Code {
        if let Some(code) = a.code_of_body.get(body.index()).copied().flatten() {
            return code;
        }
        let Some(row) = self.unit.bodies.get(body.index()) else { return Code::default() };
        let code = self.statements(all.body(body).period(), &row.statements);
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
        let mut list: Vec<tree::Stmt> = ended.into_iter().map(set_free).collect();
        if let Some(owner) = owner {
            list.push(self.take_over(t.chart, owner));
        }
        list.extend(self.stmts(period, &t.on_clearing));
        let body = self.work(list);
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
        let body = self.work(vec![set_free(owner)]);
        let row = Action { condition: Code::default(), body, period: 0 };
        let action = self.add(a, Moment::Clearing, row, Span::default());
        if let Some(slot) = a.clearing.returns.get_mut(task.index()) {
            *slot = action;
        }
    }

    /// Unless the task works for somebody already, notes the first caller, in
    /// text order, that was active as the pass began.
    fn take_over(&mut self, task: ChartId, owner: Addr) -> tree::Stmt {
        let at = Span::default();
        let callers = self.callers(task).to_vec();
        let mut arms = Vec::new();
        for (i, caller) in callers.iter().enumerate() {
            let was = self.plan.own(*caller).map(tree::ExprKind::WasActive);
            let was = was.map_or_else(|| tree::Expr::truth(false, at), |k| tree::Expr::new(k, at));
            arms.push((was, vec![store_word(Type::Lint, owner, tree::Expr::long(i as i64 + 1, at), at)]));
        }
        let nobody = tree::Expr::new(tree::ExprKind::Word(Type::Lint, owner), at).compare(
            Cmp::Eq,
            Type::Lint,
            tree::Expr::long(0, at),
            at,
        );
        let choose = tree::Stmt { kind: tree::StmtKind::If(arms, Vec::new()), at };
        tree::Stmt { kind: tree::StmtKind::If(vec![(nobody, vec![choose])], Vec::new()), at }
    }

    #[inline(never)]
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
                let code = self.statements(place.period, work);
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
                let event = self.expr(place.period, event);
                let event = self.value(event);
                let body = self.statements(place.period, work);
                let row = Action { condition: none, body, period: place.period };
                let action = self.add(a, Moment::Event, row, place.at);
                a.events.add(place.number, Event { event, action });
            }
            ActionKind::EachScan { work, condition } => {
                let condition = self.condition(place.period, condition.as_ref());
                let body = self.statements(place.period, work);
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

    /// True if a pulse without a name differs from its control block, of which
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
            Some(e) => {
                let tree = self.expr(period, e);
                self.value(tree)
            }
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
                let store = self.store(var, tree::Expr::truth(value, place.at), place.at);
                let body = self.work(vec![store]);
                let condition = self.condition(place.period, terms.condition);
                let row = Action { condition, body, period: place.period };
                let action = self.add(a, Moment::Store, row, place.at);
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
            let free = self.any_acting(&masks, place.at).negated();
            self.value(free)
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
        let mut parts = Vec::new();
        if let Some(e) = terms.condition.filter(|e| !matches!(e.kind, ExprKind::Const(Value::Bool(true)))) {
            parts.push(self.expr(place.period, e));
        }
        if let (Way::Delayed | Way::Limited, Some(time)) = (way, terms.time) {
            let age = self.acting_time(place.step, place.at);
            let time = self.expr(place.period, time);
            let c = if way == Way::Delayed { Cmp::Ge } else { Cmp::Lt };
            parts.push(age.compare(c, Type::Time, time, place.at));
        }
        if !masks.is_empty() {
            parts.push(self.any_acting(&masks, place.at).negated());
        }
        let all = parts.into_iter().reduce(|all, e| all.gate(Gate::And, e, place.at));
        let condition = all.map(|e| self.value(e)).unwrap_or_default();
        let (input, time) = match (way, terms.time) {
            (Way::Delayed | Way::Limited, _) => (0, Code::default()),
            (_, Some(e)) if terms.qualifier.timed() => {
                let time = self.expr(place.period, e);
                (input(terms.qualifier), self.value(time))
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

/// A task works for nobody.
fn set_free(owner: Addr) -> tree::Stmt {
    let at = Span::default();
    store_word(Type::Lint, owner, tree::Expr::long(0, at), at)
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
