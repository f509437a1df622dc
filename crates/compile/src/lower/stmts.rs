//! Statements as instructions.

use g7_engine::{Addr, Arith, Cmp, Num, Op, Service as Request};
use g7_model::{FbKind, Span, Type};

use super::Lower;
use super::code::Buf;
use super::words::{block_of, num};
use crate::ir::{CaseArm, ChartId, Expr, ExprKind, Service, StepId, Stmt, StmtKind, Target, Value, VarId};

impl Lower<'_> {
    /// Statements one after the other.
    pub(super) fn stmts(&mut self, b: &mut Buf, list: &[Stmt]) {
        self.depth += 1;
        for s in list {
            if !self.room(b, s.at) {
                break;
            }
            self.stmt(b, s);
        }
        self.depth -= 1;
    }

    /// The statements of a function or section: RETURN goes to their end.
    pub(super) fn inline(&mut self, b: &mut Buf, list: &[Stmt]) {
        let loops = std::mem::take(&mut b.loops);
        b.returns.push(Vec::new());
        self.stmts(b, list);
        for jump in b.returns.pop().unwrap_or_default() {
            b.land(jump);
        }
        b.loops = loops;
    }

    fn stmt(&mut self, b: &mut Buf, s: &Stmt) {
        let at = s.at;
        match &s.kind {
            StmtKind::Assign(target, e) => self.assign(b, target, e, at),
            StmtKind::Fb { var, kind, inputs, outputs } => self.fb(b, (*var, *kind), inputs, outputs, at),
            StmtKind::If(arms, other) => self.alternatives(b, arms, other),
            StmtKind::Case(selector, arms, other) => self.case(b, selector, arms, other),
            StmtKind::For { var, from, to, by, body } => {
                self.for_loop(b, *var, from, to, by.as_ref(), body, at);
            }
            StmtKind::While(e, body) => {
                let start = b.here();
                self.expr(b, e);
                let out = b.jump(Op::JumpUnless, e.at);
                self.loop_body(b, body, |_, b| {
                    b.op(Op::Jump(start), at);
                    b.land(out);
                });
            }
            StmtKind::Repeat(body, e) => {
                let start = b.here();
                self.loop_body(b, body, |l, b| {
                    l.expr(b, e);
                    b.op(Op::JumpUnless(start), e.at);
                });
            }
            StmtKind::Exit => {
                let jump = b.jump(Op::Jump, at);
                if let Some(l) = b.loops.last_mut() {
                    l.push(jump);
                } else {
                    b.land(jump); // outside of a loop: reported, and without effect
                }
            }
            StmtKind::Return => {
                if b.returns.is_empty() {
                    return b.op(Op::Return, at);
                }
                let jump = b.jump(Op::Jump, at);
                if let Some(r) = b.returns.last_mut() {
                    r.push(jump);
                }
            }
            StmtKind::Service(service) => self.service(b, service, at),
        }
    }

    /// A loop's statements and what comes behind them; EXIT goes to the end.
    fn loop_body(&mut self, b: &mut Buf, body: &[Stmt], end: impl FnOnce(&mut Self, &mut Buf)) {
        b.loops.push(Vec::new());
        self.stmts(b, body);
        end(self, b);
        for jump in b.loops.pop().unwrap_or_default() {
            b.land(jump);
        }
    }

    fn assign(&mut self, b: &mut Buf, target: &Target, e: &Expr, at: Span) {
        if let Target::Element(_, index) = target {
            self.expr(b, index);
        }
        self.expr(b, e);
        self.store_to(b, target, at);
    }

    /// Pops into a target whose index, if any, has been pushed before.
    fn store_to(&mut self, b: &mut Buf, target: &Target, at: Span) {
        match target {
            Target::Var(var) => self.store(b, *var, at),
            Target::Element(var, _) => {
                let len = self.unit.vars.get(var.index()).map_or(0, |v| v.elements);
                b.op(Op::StoreAt { base: self.words.addr(*var), len }, at);
            }
            Target::Member(var, member) => {
                b.op(Op::Store(Addr(self.words.addr(*var).0 + u32::from(*member))), at);
            }
        }
    }

    fn fb(
        &mut self,
        b: &mut Buf,
        (var, kind): (VarId, FbKind),
        inputs: &[(u8, Expr)],
        outputs: &[(u8, Target)],
        at: Span,
    ) {
        let base = self.words.addr(var);
        for (member, e) in inputs {
            self.expr(b, e);
            b.op(Op::Store(Addr(base.0 + u32::from(*member))), e.at);
        }
        b.op(Op::Fb(block_of(kind), base), at);
        for (member, target) in outputs {
            if let Target::Element(_, index) = target {
                self.expr(b, index);
            }
            b.op(Op::Load(Addr(base.0 + u32::from(*member))), at);
            self.store_to(b, target, at);
        }
    }

    fn alternatives(&mut self, b: &mut Buf, arms: &[(Expr, Vec<Stmt>)], other: &[Stmt]) {
        let mut ends = Vec::new();
        for (i, (condition, then)) in arms.iter().enumerate() {
            self.expr(b, condition);
            let next = b.jump(Op::JumpUnless, condition.at);
            self.stmts(b, then);
            if i + 1 < arms.len() || !other.is_empty() {
                ends.push(b.jump(Op::Jump, condition.at));
            }
            b.land(next);
        }
        self.stmts(b, other);
        ends.into_iter().for_each(|jump| b.land(jump));
    }

    fn case(&mut self, b: &mut Buf, selector: &Expr, arms: &[CaseArm], other: &[Stmt]) {
        let at = selector.at;
        let chosen = self.words.hidden(0);
        self.expr(b, selector);
        b.op(Op::Store(chosen), at);
        let mut ends = Vec::new();
        for (ranges, then) in arms {
            for (i, (low, high)) in ranges.iter().enumerate() {
                within(b, chosen, *low, *high, at);
                if i > 0 {
                    b.op(Op::Or, at);
                }
            }
            if ranges.is_empty() {
                b.op(Op::Push(0), at);
            }
            let next = b.jump(Op::JumpUnless, at);
            self.stmts(b, then);
            ends.push(b.jump(Op::Jump, at));
            b.land(next);
        }
        self.stmts(b, other);
        ends.into_iter().for_each(|jump| b.land(jump));
    }

    /// FOR. The last value and the step are computed once. A step beyond the end
    /// of the variable's type ends the loop.
    #[allow(clippy::too_many_arguments, reason = "the parts of one statement")]
    fn for_loop(
        &mut self,
        b: &mut Buf,
        var: VarId,
        from: &Expr,
        to: &Expr,
        by: Option<&Expr>,
        body: &[Stmt],
        at: Span,
    ) {
        let ty = self.unit.vars.get(var.index()).map_or(Type::Lint, |v| v.ty);
        let (last, step) = (self.words.hidden(0), self.words.hidden(0));
        self.expr(b, from);
        self.store(b, var, from.at);
        self.expr(b, to);
        b.op(Op::Store(last), to.at);
        let fixed = match by.map(|e| &e.kind) {
            None => Some(1),
            Some(ExprKind::Const(Value::Int(v))) => i64::try_from(*v).ok(),
            Some(_) => None,
        };
        if let (None, Some(by)) = (fixed, by) {
            self.expr(b, by);
            b.op(Op::Store(step), by.at);
        }
        let loop_var = For { var: self.words.addr(var), last, step, fixed, ty, at };
        let start = b.here();
        loop_var.goes_on(b);
        let out = b.jump(Op::JumpUnless, at);
        self.loop_body(b, body, |_, b| {
            loop_var.has_next(b);
            let end = b.jump(Op::JumpUnless, at);
            loop_var.advance(b);
            b.op(Op::Jump(start), at);
            b.land(out);
            b.land(end);
        });
    }

    fn service(&mut self, b: &mut Buf, service: &Service, at: Span) {
        match service {
            Service::InitChart(chart) => {
                if let Some(g) = self.plan.group(*chart) {
                    b.op(Op::Service(Request::Init(g)), at);
                }
            }
            Service::ClearChart(chart) => self.empty(b, *chart, at),
            Service::FreezeChart(chart, e) => {
                self.expr(b, e);
                match self.freezes.get(chart.index()).copied().flatten() {
                    Some(freeze) => b.op(Op::Store(freeze.asked), at),
                    None => b.op(Op::Drop, at),
                }
            }
            Service::SetStep(step) => {
                let mut steps = Vec::new();
                self.plan.entering(self.unit, *step, &mut steps);
                self.plan.around(self.unit, *step, &mut steps);
                steps.into_iter().for_each(|s| b.op(Op::Service(Request::Set(s)), at));
            }
            Service::ResetStep(step) => self.reset(b, *step, at),
            Service::ResetTimes => b.op(Op::Service(Request::ResetTimes), at),
        }
    }

    fn reset(&mut self, b: &mut Buf, step: StepId, at: Span) {
        match self.plan.expansion(self.unit, step) {
            Some(chart) => self.empty(b, chart, at),
            None => {
                if let Some(n) = self.plan.own(step) {
                    b.op(Op::Service(Request::Reset(n)), at);
                }
            }
        }
    }

    /// Asks for all steps of a chart to be deactivated, with the pseudo-step of
    /// the macro-step that it expands.
    pub(super) fn empty(&mut self, b: &mut Buf, chart: ChartId, at: Span) {
        if let Some(g) = self.plan.group(chart) {
            b.op(Op::Service(Request::Clear(g)), at);
        }
        if let Some(p) = super::plan::parent(self.unit, chart).and_then(|m| self.plan.pseudo(m)) {
            b.op(Op::Service(Request::Reset(p)), at);
        }
    }
}

/// Pushes whether a word lies within a range.
fn within(b: &mut Buf, word: Addr, low: i64, high: i64, at: Span) {
    b.op(Op::Load(word), at);
    b.op(Op::Push(low as u64), at);
    if low == high {
        return b.op(Op::Compare(Cmp::Eq, Num::I64), at);
    }
    b.op(Op::Compare(Cmp::Ge, Num::I64), at);
    b.op(Op::Load(word), at);
    b.op(Op::Push(high as u64), at);
    b.op(Op::Compare(Cmp::Le, Num::I64), at);
    b.op(Op::And, at);
}

/// The running part of a FOR loop.
struct For {
    var: Addr,
    last: Addr,
    /// Holds the step where it is not fixed.
    step: Addr,
    fixed: Option<i64>,
    ty: Type,
    at: Span,
}

impl For {
    /// Pushes whether the variable has not passed the last value.
    fn goes_on(&self, b: &mut Buf) {
        self.by_sign(b, |f, b, up| {
            b.op(Op::Load(f.var), f.at);
            b.op(Op::Load(f.last), f.at);
            b.op(Op::Compare(if up { Cmp::Le } else { Cmp::Ge }, num(f.ty)), f.at);
        });
    }

    /// Pushes whether one more step stays within the variable's type.
    fn has_next(&self, b: &mut Buf) {
        let (least, most) = self.ty.bounds().unwrap_or((i64::MIN.into(), i64::MAX.into()));
        self.by_sign(b, |f, b, up| {
            b.op(Op::Load(f.var), f.at);
            b.op(Op::Push(if up { most } else { least } as u64), f.at);
            f.push_step(b);
            b.op(Op::Arith(Arith::Sub, num(f.ty)), f.at);
            b.op(Op::Compare(if up { Cmp::Le } else { Cmp::Ge }, num(f.ty)), f.at);
        });
    }

    fn advance(&self, b: &mut Buf) {
        b.op(Op::Load(self.var), self.at);
        self.push_step(b);
        b.op(Op::Arith(Arith::Add, num(self.ty)), self.at);
        b.op(Op::Store(self.var), self.at);
    }

    fn push_step(&self, b: &mut Buf) {
        b.op(self.fixed.map_or(Op::Load(self.step), |v| Op::Push(v as u64)), self.at);
    }

    /// One of two pieces of code, by the sign of the step.
    fn by_sign(&self, b: &mut Buf, piece: impl Fn(&For, &mut Buf, bool)) {
        if let Some(v) = self.fixed {
            return piece(self, b, v >= 0);
        }
        b.op(Op::Load(self.step), self.at);
        b.op(Op::Push(0), self.at);
        b.op(Op::Compare(Cmp::Ge, num(self.ty)), self.at);
        let down = b.jump(Op::JumpUnless, self.at);
        piece(self, b, true);
        let end = b.jump(Op::Jump, self.at);
        b.land(down);
        piece(self, b, false);
        b.land(end);
    }
}
