//! Typed statements as trees.

use g7_engine::{Addr, Arith, Cmp, Service as Request};
use g7_model::{FbKind, Span, Type};

use super::distinct::Distinct;
use super::terms::store_word;
use super::words::block_of;
use super::work::Lower;
use crate::ir::{self, CaseArm, ChartId, Service, StepId, Target, Value, VarId};
use crate::tree::{self, Expr, ExprKind, Gate, Stmt, StmtKind};

impl Lower<'_> {
    /// Statements one after the other, in a piece of code of a period.
    pub(super) fn stmts(&mut self, period: u32, list: &[ir::Stmt]) -> Vec<Stmt> {
        let mut to = Vec::with_capacity(list.len());
        self.depth += 1;
        for s in list {
            if !self.room(s.at) {
                break;
            }
            self.stmt(period, s, &mut to);
        }
        self.depth -= 1;
        to
    }

    /// The statements of a function or section: RETURN leaves them alone.
    pub(super) fn inline(&mut self, period: u32, list: &[ir::Stmt]) -> Stmt {
        let at = list.first().map(|s| s.at).unwrap_or_default();
        Stmt { kind: StmtKind::Body(self.stmts(period, list)), at }
    }

    fn stmt(&mut self, period: u32, s: &ir::Stmt, to: &mut Vec<Stmt>) {
        let at = s.at;
        let kind = match &s.kind {
            ir::StmtKind::Assign(target, e) => {
                let target = self.target(period, target);
                let value = self.expr(period, e);
                return to.push(self.store_to(target, value, at));
            }
            ir::StmtKind::Fb { var, kind, inputs, outputs } => {
                return self.fb(period, (*var, *kind), inputs, outputs, at, to);
            }
            ir::StmtKind::If(arms, other) => {
                let arms = arms.iter().map(|(c, then)| (self.expr(period, c), self.stmts(period, then)));
                let arms = arms.collect();
                StmtKind::If(arms, self.stmts(period, other))
            }
            ir::StmtKind::Case(selector, arms, other) => return self.case(period, selector, arms, other, to),
            ir::StmtKind::For { var, from, to: last, by, body } => {
                return self.for_loop(period, *var, [Some(from), Some(last), by.as_ref()], body, at, to);
            }
            ir::StmtKind::While(e, body) => {
                let mut list = vec![Stmt { kind: StmtKind::LeaveUnless(self.expr(period, e)), at: e.at }];
                list.extend(self.stmts(period, body));
                StmtKind::Loop(list, None)
            }
            ir::StmtKind::Repeat(body, e) => {
                let list = self.stmts(period, body);
                StmtKind::Loop(list, Some(self.expr(period, e)))
            }
            ir::StmtKind::Exit => StmtKind::Leave,
            ir::StmtKind::Return => StmtKind::Return,
            ir::StmtKind::Service(service) => return self.service(period, service, at, to),
        };
        to.push(Stmt { kind, at });
    }

    fn target(&mut self, period: u32, target: &Target) -> To {
        match target {
            Target::Var(var) => To::Variable(*var),
            Target::Element(all, index) => {
                let index = self.element_place(period, all, index);
                let ty = self.stored_type(all.first).unwrap_or(Type::Bool);
                To::Number(ty, tree::Target::Element(self.words.addr(all.first), all.count(), index))
            }
            Target::Member(var, member) => {
                let ty = match self.unit.vars.get(var.index()).map(|v| v.ty) {
                    Some(Type::Fb(kind)) => kind.members().get(usize::from(*member)).map(|m| m.1),
                    _ => None,
                };
                let word = Addr(self.words.addr(*var).0 + u32::from(*member));
                To::Number(ty.unwrap_or(Type::Bool), tree::Target::Word(word))
            }
        }
    }

    fn store_to(&mut self, target: To, value: Expr, at: Span) -> Stmt {
        match target {
            To::Variable(var) => self.store(var, value, at),
            To::Number(ty, target) => Stmt { kind: StmtKind::Store(ty, target, value), at },
        }
    }

    fn fb(
        &mut self,
        period: u32,
        (var, kind): (VarId, FbKind),
        inputs: &[(u8, ir::Expr)],
        outputs: &[(u8, Target)],
        at: Span,
        to: &mut Vec<Stmt>,
    ) {
        let base = self.words.addr(var);
        let member = |m: u8| {
            let ty = kind.members().get(usize::from(m)).map_or(Type::Bool, |m| m.1);
            (ty, Addr(base.0 + u32::from(m)))
        };
        for (m, e) in inputs {
            let (ty, word) = member(*m);
            let value = self.expr(period, e);
            to.push(store_word(ty, word, value, e.at));
        }
        to.push(Stmt { kind: StmtKind::Fb(block_of(kind), base), at });
        for (m, target) in outputs {
            let (ty, word) = member(*m);
            let target = self.target(period, target);
            to.push(self.store_to(target, Expr::new(ExprKind::Word(ty, word), at), at));
        }
    }

    fn case(
        &mut self,
        period: u32,
        selector: &ir::Expr,
        arms: &[CaseArm],
        other: &[ir::Stmt],
        to: &mut Vec<Stmt>,
    ) {
        let at = selector.at;
        let chosen = self.words.hidden(0);
        let value = self.expr(period, selector);
        to.push(store_word(Type::Lint, chosen, value, at));
        let arms = arms.iter().map(|(ranges, then)| {
            let mut ranges = ranges.iter().map(|(low, high)| within(chosen, *low, *high, at));
            let first = ranges.next().unwrap_or_else(|| Expr::truth(false, at));
            (ranges.fold(first, |any, e| any.gate(Gate::Or, e, at)), self.stmts(period, then))
        });
        let arms = arms.collect();
        to.push(Stmt { kind: StmtKind::If(arms, self.stmts(period, other)), at });
    }

    /// FOR. The last value and the step are computed once. A step beyond the end
    /// of the variable's type ends the loop.
    fn for_loop(
        &mut self,
        period: u32,
        var: VarId,
        [from, last, by]: [Option<&ir::Expr>; 3],
        body: &[ir::Stmt],
        at: Span,
        to: &mut Vec<Stmt>,
    ) {
        let (Some(from), Some(last)) = (from, last) else { return };
        let ty = self.unit.vars.get(var.index()).map_or(Type::Lint, |v| v.ty);
        let (limit, step) = (self.words.hidden(0), self.words.hidden(0));
        let value = self.expr(period, from);
        to.push(self.store(var, value, from.at));
        let value = self.expr(period, last);
        to.push(store_word(ty, limit, value, last.at));
        let fixed = match by.map(|e| &e.kind) {
            None => Some(1),
            Some(ir::ExprKind::Const(Value::Int(v))) => i64::try_from(*v).ok(),
            Some(_) => None,
        };
        if let (None, Some(by)) = (fixed, by) {
            let value = self.expr(period, by);
            to.push(store_word(ty, step, value, by.at));
        }
        let parts = For { var: self.words.addr(var), limit, step, fixed, ty, at };
        let mut list = parts.by_sign(For::goes_on);
        list.extend(self.stmts(period, body));
        list.extend(parts.by_sign(For::has_next));
        list.push(parts.advance());
        to.push(Stmt { kind: StmtKind::Loop(list, None), at });
    }

    fn service(&mut self, period: u32, service: &Service, at: Span, to: &mut Vec<Stmt>) {
        let request = |r| Stmt { kind: StmtKind::Service(r), at };
        match service {
            Service::InitChart(chart) => {
                to.extend(self.plan.group(*chart).map(|g| request(Request::Init(g))))
            }
            Service::ClearChart(chart) => to.extend(self.empty(*chart, at)),
            Service::FreezeChart(chart, e) => {
                let value = self.expr(period, e);
                to.push(match self.freezes.get(chart.index()).copied().flatten() {
                    Some(freeze) => store_word(Type::Bool, freeze.asked, value, at),
                    None => Stmt { kind: StmtKind::Evaluate(value), at },
                });
            }
            Service::SetStep(step) => {
                let mut steps = Distinct::default();
                self.plan.entering(self.unit, *step, &mut steps);
                self.plan.around(self.unit, *step, &mut steps);
                to.extend(steps.as_slice().iter().map(|s| request(Request::Set(*s))));
            }
            Service::ResetStep(step) => to.extend(self.reset(*step, at)),
            Service::ResetTimes => to.push(request(Request::ResetTimes)),
        }
    }

    fn reset(&self, step: StepId, at: Span) -> Vec<Stmt> {
        match self.plan.expansion(self.unit, step) {
            Some(chart) => self.empty(chart, at),
            None => {
                let request = |n| Stmt { kind: StmtKind::Service(Request::Reset(n)), at };
                self.plan.own(step).map(request).into_iter().collect()
            }
        }
    }

    /// Asks for all steps of a chart to be deactivated, with the pseudo-step of
    /// the macro-step that it expands.
    pub(super) fn empty(&self, chart: ChartId, at: Span) -> Vec<Stmt> {
        let group = self.plan.group(chart).map(Request::Clear);
        let pseudo = super::plan::parent(self.unit, chart).and_then(|m| self.plan.pseudo(m));
        let all = group.into_iter().chain(pseudo.map(Request::Reset));
        all.map(|r| Stmt { kind: StmtKind::Service(r), at }).collect()
    }
}

/// Where a value goes.
enum To {
    Variable(VarId),
    Number(Type, tree::Target),
}

/// A word lies within a range.
fn within(word: Addr, low: i64, high: i64, at: Span) -> Expr {
    let value = || Expr::new(ExprKind::Word(Type::Lint, word), at);
    if low == high {
        return value().compare(Cmp::Eq, Type::Lint, Expr::long(low, at), at);
    }
    let from = value().compare(Cmp::Ge, Type::Lint, Expr::long(low, at), at);
    from.gate(Gate::And, value().compare(Cmp::Le, Type::Lint, Expr::long(high, at), at), at)
}

/// The running part of a FOR loop.
struct For {
    var: Addr,
    limit: Addr,
    /// Holds the step where it is not fixed.
    step: Addr,
    fixed: Option<i64>,
    ty: Type,
    at: Span,
}

impl For {
    fn word(&self, addr: Addr) -> Expr {
        Expr::new(ExprKind::Word(self.ty, addr), self.at)
    }

    fn constant(&self, value: i128) -> Expr {
        Expr::new(ExprKind::Const(self.ty, value as u64), self.at)
    }

    fn step(&self) -> Expr {
        self.fixed.map_or_else(|| self.word(self.step), |v| self.constant(v.into()))
    }

    /// The variable has not passed the last value.
    fn goes_on(&self, up: bool) -> Expr {
        let c = if up { Cmp::Le } else { Cmp::Ge };
        self.word(self.var).compare(c, self.ty, self.word(self.limit), self.at)
    }

    /// One more step stays within the variable's type.
    fn has_next(&self, up: bool) -> Expr {
        let (least, most) = self.ty.bounds().unwrap_or((i64::MIN.into(), i64::MAX.into()));
        let end = if up { most } else { least };
        let room = match self.fixed {
            Some(step) => self.constant(end - i128::from(step)),
            None => self.constant(end).arith(Arith::Sub, self.ty, self.step(), self.at),
        };
        let c = if up { Cmp::Le } else { Cmp::Ge };
        self.word(self.var).compare(c, self.ty, room, self.at)
    }

    fn advance(&self) -> Stmt {
        let next = self.word(self.var).arith(Arith::Add, self.ty, self.step(), self.at);
        store_word(self.ty, self.var, next, self.at)
    }

    /// Leaves the loop unless a condition holds, which depends on the sign of the step.
    fn by_sign(&self, condition: impl Fn(&For, bool) -> Expr) -> Vec<Stmt> {
        let leave = |up| Stmt { kind: StmtKind::LeaveUnless(condition(self, up)), at: self.at };
        if let Some(v) = self.fixed {
            return vec![leave(v >= 0)];
        }
        let rises = self.word(self.step).compare(Cmp::Ge, self.ty, self.constant(0), self.at);
        let choice = StmtKind::If(vec![(rises, vec![leave(true)])], vec![leave(false)]);
        vec![Stmt { kind: choice, at: self.at }]
    }
}
