//! Transitions: their order, their arcs, their receptivities.
//!
//! The condition that a task, an `enable` order or a freeze asks of a transition is ANDed to
//! its receptivity; what a call needs of the task's steps is added to its arcs.

use g7_engine::{Addr, Cmp, NONE, Receptivity, Rows, StepId as Number, Transition};
use g7_model::{Span, Type};

use super::actions::Clearing;
use super::distinct::Distinct;
use super::lists::Lists;
use super::plan::parent;
use super::work::Lower;
use crate::ir::{self, ChartId, ChartRole, Expr, ExprKind, StepId, TransitionId, Value, VarClass, VarId};
use crate::tree::{self, Gate};

/// Where a transition of the program comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// The text.
    Written(TransitionId),
    /// A task whose caller has gone: its exit step gives way to its entry step.
    Return(ChartId),
}

/// The conditions besides the receptivity.
enum Extra {
    /// One of the steps is active.
    Any(Vec<StepId>),
    /// The word is FALSE.
    Off(Addr),
    /// The task works for its caller of this number.
    OwnedBy(Addr, u64),
    /// The task's owner is no longer active.
    Orphaned(Addr, Vec<StepId>),
}

/// The parts of a transition.
#[derive(Default)]
struct Parts {
    from: Distinct,
    to: Distinct,
    /// Go off with it.
    drops: Distinct,
    extras: Vec<Extra>,
}

impl Parts {
    fn clear(&mut self) {
        self.from.clear();
        self.to.clear();
        self.drops.clear();
        self.extras.clear();
    }
}

impl Lower<'_> {
    /// The transitions by rank.
    #[inline(never)]
    pub(super) fn ranks(&self) -> Vec<Origin> {
        let rules = &self.unit.rules;
        let mut order: Vec<(u32, u32, u32, TransitionId)> = Vec::with_capacity(self.unit.transitions.len());
        for (i, t) in self.unit.transitions.iter().enumerate() {
            if self.plan.chart(t.chart).is_none() {
                continue;
            }
            // One after the other: chart by chart, the outermost first. Where all
            // that can clear do, a number only excludes, and the text orders.
            let (level, chart) =
                if rules.sequential { (self.plan.level(t.chart), t.chart.0) } else { (0, 0) };
            let by_number = !rules.sequential || !rules.multi_token;
            let number = if by_number { t.priority.unwrap_or(NONE) } else { NONE };
            order.push((level, chart, number, TransitionId(i as u32)));
        }
        if !order.is_sorted() {
            order.sort_unstable();
        }
        let returns = (0..self.unit.charts.len() as u32)
            .map(ChartId)
            .filter(|c| self.owner(*c).is_some())
            .map(Origin::Return);
        order.into_iter().map(|(.., id)| Origin::Written(id)).chain(returns).collect()
    }

    /// Fills the tables of transitions.
    #[inline(never)]
    pub(super) fn transitions(&mut self, ranks: &[Origin], clearing: &Clearing) {
        let steps = self.plan.source.len();
        let (mut uses, mut joint) = (vec![0u8; steps], vec![false; steps]);
        let mut p = Parts::default();
        let mut outs = Lists::default();
        for (rank, origin) in ranks.iter().enumerate() {
            p.clear();
            let (chart, mut row) = match *origin {
                Origin::Written(id) => {
                    let Some(t) = self.unit.transitions.get(id.index()) else { continue };
                    self.written(t, &mut p);
                    if self.has_blockers {
                        p.extras.extend(self.blockers(t.chart));
                    }
                    let row = self.row(&t.receptivity, &p.extras, t.chart);
                    let on_clearing = clearing.written(id);
                    (t.chart, Transition { on_clearing, priority: t.priority.unwrap_or(NONE), ..row })
                }
                Origin::Return(task) => {
                    self.returning(task, &mut p);
                    let at = self.unit.charts.get(task.index()).map(|c| c.at).unwrap_or_default();
                    let always = Expr { kind: ExprKind::Const(Value::Bool(true)), ty: Type::Bool, at };
                    let on_clearing = clearing.returning(task);
                    let row = self.row(&always, &p.extras, task);
                    (task, Transition { on_clearing, uncounted: true, ..row })
                }
            };
            row.chart = self.plan.chart(chart).unwrap_or(0);
            let (from, drops) = (p.from.as_slice(), p.drops.as_slice());
            (row.from, row.more_from) = self.arcs(from);
            (row.to, row.more_to) = self.arcs(p.to.as_slice());
            row.drops = !drops.is_empty();
            self.t.drops.extend(drops.iter().map(|s| (rank as u32, *s)));
            for s in from {
                if let (Some(n), Some(j)) = (uses.get_mut(s.0 as usize), joint.get_mut(s.0 as usize)) {
                    *n = n.saturating_add(1);
                    *j |= from.len() > 1;
                }
            }
            match from.first() {
                Some(s) => outs.add(s.0, rank as u32),
                None => self.t.sources.push(rank as u32),
            }
            self.t.transitions.push(row);
        }
        let shared = |s: Number| uses.get(s.0 as usize).is_some_and(|n| *n > 1);
        let arcs = &self.t.arcs;
        for row in &mut self.t.transitions {
            let more = arcs.get(row.more_from.start as usize..row.more_from.end as usize).unwrap_or(&[]);
            row.shares = shared(row.from) || more.iter().any(|s| shared(*s));
            row.simple = joint.get(row.from.0 as usize).is_some_and(|j| !j);
        }
        outs.sort();
        for (i, step) in self.t.steps.iter_mut().enumerate() {
            step.out = outs.take(i as u32, &mut self.t.outs);
        }
    }

    /// The first step, and the rest as rows of arcs.
    fn arcs(&mut self, steps: &[Number]) -> (Number, Rows) {
        let Some((first, rest)) = steps.split_first() else { return (Number(NONE), Rows::default()) };
        (*first, self.list(rest))
    }

    /// A list of steps as rows of arcs.
    pub(super) fn list(&mut self, steps: &[Number]) -> Rows {
        if steps.is_empty() {
            return Rows::default();
        }
        let start = self.t.arcs.len() as u32;
        self.t.arcs.extend_from_slice(steps);
        Rows { start, end: self.t.arcs.len() as u32 }
    }

    fn written(&self, t: &ir::Transition, p: &mut Parts) {
        for step in &t.from {
            self.plan.leaving(self.unit, *step, &mut p.from, &mut p.drops);
            for task in self.tasks_of(*step) {
                self.hand_back(task, *step, p);
            }
        }
        t.to.iter().for_each(|s| self.plan.entering(self.unit, *s, &mut p.to));
        if self.owners.is_empty() {
            return;
        }
        let chart = self.unit.charts.get(t.chart.index());
        if let Some(chart) = chart.filter(|c| c.role == ChartRole::Task)
            && chart.entry.is_some_and(|e| t.from.contains(&e))
        {
            p.extras.push(Extra::Any(self.callers(t.chart).to_vec()));
        }
    }

    /// A caller is left when the task's exit step is active on its behalf; the
    /// task then stands at its entry step again.
    fn hand_back(&self, task: ChartId, caller: StepId, p: &mut Parts) {
        let Some(owner) = self.owner(task) else { return };
        let Ok(number) = self.callers(task).binary_search(&caller) else { return };
        self.to_entry(task, p);
        p.extras.push(Extra::OwnedBy(owner, number as u64 + 1));
    }

    fn returning(&self, task: ChartId, p: &mut Parts) {
        self.to_entry(task, p);
        if let Some(owner) = self.owner(task) {
            p.extras.push(Extra::Orphaned(owner, self.callers(task).to_vec()));
        }
    }

    /// From the exit step of a task to its entry step.
    fn to_entry(&self, task: ChartId, p: &mut Parts) {
        let Some(chart) = self.unit.charts.get(task.index()) else { return };
        if let Some(exit) = chart.exit {
            self.plan.leaving(self.unit, exit, &mut p.from, &mut p.drops);
        }
        if let Some(entry) = chart.entry {
            self.plan.entering(self.unit, entry, &mut p.to);
        }
    }

    /// The tasks that a step calls.
    pub(super) fn tasks_of(&self, step: StepId) -> impl Iterator<Item = ChartId> + '_ {
        let calls = self.unit.steps.get(step.index()).map_or(&[][..], |s| &s.calls);
        calls.iter().map(|c| c.0).filter(|t| self.owner(*t).is_some())
    }

    /// The word with the number of the caller that a task works for, 0 for none.
    pub(super) fn owner(&self, task: ChartId) -> Option<Addr> {
        self.owners.get(task.index()).copied().flatten()
    }

    /// The steps that call a task, in text order.
    pub(super) fn callers(&self, task: ChartId) -> &[StepId] {
        self.callers.get(task.index()).map_or(&[], Vec::as_slice)
    }

    fn row(&mut self, receptivity: &Expr, extras: &[Extra], chart: ChartId) -> Transition {
        Transition {
            receptivity: self.guard(receptivity, extras, chart),
            from: Number(NONE),
            to: Number(NONE),
            more_from: Rows::default(),
            more_to: Rows::default(),
            chart: 0,
            on_clearing: NONE,
            shares: false,
            priority: NONE,
            simple: false,
            drops: false,
            uncounted: false,
        }
    }

    fn guard(&mut self, receptivity: &Expr, extras: &[Extra], chart: ChartId) -> Receptivity {
        if extras.is_empty()
            && let Some(guard) = self.plain_guard(receptivity)
        {
            return guard;
        }
        let at = receptivity.at;
        let held = extras.iter().map(|e| self.extra(e, at)).reduce(|all, e| all.gate(Gate::And, e, at));
        let tree = match held {
            None => self.expr(self.period(chart), receptivity),
            Some(free) if is_true(receptivity) => free,
            // The conditions that hold a transition back come first: then its receptivity is not
            // even looked at, and cannot fail.
            Some(free) => {
                let receptivity = self.expr(self.period(chart), receptivity);
                free.gate(Gate::And, receptivity, at)
            }
        };
        Receptivity::Code(self.value(tree))
    }

    /// Receptivities that need no code.
    fn plain_guard(&self, e: &Expr) -> Option<Receptivity> {
        if is_true(e) {
            return Some(Receptivity::True);
        }
        let word = |var: VarId| {
            let v = self.unit.vars.get(var.index())?;
            (v.class != VarClass::Const).then(|| self.words.addr(var))
        };
        match &e.kind {
            ExprKind::Var(v) => word(*v).map(Receptivity::Word),
            ExprKind::Not(x) => match x.kind {
                ExprKind::Var(v) => word(v).map(Receptivity::NotWord),
                _ => None,
            },
            _ => None,
        }
    }

    /// The conditions that hold back every transition of a chart and of the charts round it.
    fn blockers(&self, chart: ChartId) -> Vec<Extra> {
        let mut found: Vec<Extra> = self.stop_all.map(Extra::Off).into_iter().collect();
        let mut at = Some(chart);
        for _ in 0..=super::plan::NESTING {
            let Some(c) = at else { break };
            if let Some(steps) = self.enabling.get(c.index()).filter(|s| !s.is_empty()) {
                found.push(Extra::Any(steps.clone()));
            }
            if let Some(freeze) = self.freezes.get(c.index()).copied().flatten() {
                found.push(Extra::Off(freeze.holds));
            }
            at = parent(self.unit, c).and_then(|m| self.unit.steps.get(m.index())).map(|s| s.chart);
        }
        found
    }

    fn extra(&mut self, e: &Extra, at: Span) -> tree::Expr {
        match e {
            Extra::Any(steps) => self.any_acting(steps, at),
            Extra::Off(word) => tree::Expr::new(tree::ExprKind::Word(Type::Bool, *word), at).negated(),
            Extra::OwnedBy(owner, number) => owned_by(*owner, *number, at),
            Extra::Orphaned(owner, callers) => {
                let mut any = tree::Expr::truth(false, at);
                for (i, caller) in callers.iter().enumerate() {
                    let active = self.acting(*caller, at);
                    let works = owned_by(*owner, i as u64 + 1, at).gate(Gate::And, active, at);
                    any = any.gate(Gate::Or, works, at);
                }
                any.negated()
            }
        }
    }
}

fn is_true(e: &Expr) -> bool {
    matches!(e.kind, ExprKind::Const(Value::Bool(true)))
}

fn owned_by(owner: Addr, number: u64, at: Span) -> tree::Expr {
    let owner = tree::Expr::new(tree::ExprKind::Word(Type::Lint, owner), at);
    owner.compare(Cmp::Eq, Type::Lint, tree::Expr::long(number as i64, at), at)
}
