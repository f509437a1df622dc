//! Expressions as instructions of the stack machine.
//!
//! Code is written into a [`Buf`] with jumps counted from its own start, and
//! moved to its place in the table by [`Lower::place`]. A piece of code belongs
//! to the period of the chart it stands in: its edges and timers are those of
//! that period.

use g7_engine::{Addr, Arith, Builtin, Cmp, Code, GroupId, Num, Op, StepId as Number, WatchId};
use g7_model::{Span, Type};

use super::uses::{DEPTH, timed_step};
use super::words::{capacity, num, word_of};
use super::{Lower, Refusal};
use crate::ir::{
    BinaryOp, Expr, ExprKind, FunctionId, SectionId, StepId, StmtKind, Target, Value, VarClass, VarId,
};

/// Instructions that one program may have; more comes only from functions that
/// call functions that call functions.
const MOST: usize = 1 << 22;

/// The instructions for the time of a step and of a macro-step's group.
type TimeOps = (fn(Number) -> Op, fn(GroupId) -> Op);

/// What a watched expression reads.
#[derive(Default)]
pub(super) struct Reads {
    pub(super) words: Vec<Addr>,
    pub(super) steps: Vec<Number>,
    pub(super) groups: Vec<GroupId>,
    pub(super) watches: Vec<WatchId>,
    /// A time or a random number: never the same for long.
    pub(super) time: bool,
}

impl Reads {
    pub(super) fn append(&mut self, other: &mut Reads) {
        self.words.append(&mut other.words);
        self.steps.append(&mut other.steps);
        self.groups.append(&mut other.groups);
        self.watches.append(&mut other.watches);
        self.time |= other.time;
    }

    fn clear(&mut self) {
        self.words.clear();
        self.steps.clear();
        self.groups.clear();
        self.watches.clear();
        self.time = false;
    }
}

/// Code being written.
#[derive(Default)]
pub(super) struct Buf {
    pub(super) ops: Vec<Op>,
    pub(super) places: Vec<Span>,
    /// The period of its watches.
    pub(super) period: u32,
    pub(super) reads: Reads,
    /// For each loop round this point, the jumps that leave it.
    pub(super) loops: Vec<Vec<usize>>,
    /// For each function or section round this point, the jumps to its end.
    pub(super) returns: Vec<Vec<usize>>,
}

impl Buf {
    pub(super) fn op(&mut self, op: Op, at: Span) {
        self.ops.push(op);
        self.places.push(at);
    }

    /// The place of the next instruction.
    pub(super) fn here(&self) -> u32 {
        self.ops.len() as u32
    }

    /// A jump whose target is not known yet.
    pub(super) fn jump(&mut self, op: fn(u32) -> Op, at: Span) -> usize {
        self.op(op(0), at);
        self.ops.len() - 1
    }

    /// Sends a jump to the next instruction.
    pub(super) fn land(&mut self, jump: usize) {
        let here = self.here();
        match self.ops.get_mut(jump) {
            Some(Op::Jump(to) | Op::JumpUnless(to)) => *to = here,
            _ => debug_assert!(false, "not a jump"),
        }
    }
}

impl Lower<'_> {
    /// An empty buffer for code of a period.
    pub(super) fn buf(&mut self, period: u32) -> Buf {
        Buf { period, ..self.spare.pop().unwrap_or_default() }
    }

    /// Moves code to its place in the table.
    pub(super) fn place(&mut self, mut b: Buf) -> Code {
        let start = self.t.code.len() as u32;
        self.t.code.extend(b.ops.drain(..).map(|op| match op {
            Op::Jump(to) => Op::Jump(to + start),
            Op::JumpUnless(to) => Op::JumpUnless(to + start),
            other => other,
        }));
        self.places.append(&mut b.places);
        self.drop_buf(b);
        Code { start, end: self.t.code.len() as u32 }
    }

    /// Keeps the room of a buffer for the next one.
    pub(super) fn drop_buf(&mut self, mut b: Buf) {
        b.ops.clear();
        b.places.clear();
        b.reads.clear();
        self.spare.push(b);
    }

    /// The code of one expression.
    pub(super) fn code_of(&mut self, period: u32, e: &Expr) -> Code {
        let mut b = self.buf(period);
        self.expr(&mut b, e);
        self.place(b)
    }

    /// Whether there is room for more; says so once if not.
    pub(super) fn room(&mut self, b: &Buf, at: Span) -> bool {
        if self.t.code.len() + b.ops.len() > MOST {
            self.refuse(Refusal::Large, at);
        }
        if self.depth > DEPTH {
            self.refuse(Refusal::Deep, at);
        }
        self.refused.is_none()
    }

    /// Pushes the value of an expression.
    pub(super) fn expr(&mut self, b: &mut Buf, e: &Expr) {
        if !self.room(b, e.at) {
            return;
        }
        self.depth += 1;
        self.kind(b, e);
        self.depth -= 1;
    }

    fn kind(&mut self, b: &mut Buf, e: &Expr) {
        let at = e.at;
        match &e.kind {
            ExprKind::Const(value) => self.constant(b, e.ty, value, at),
            ExprKind::Var(var) => self.load(b, *var, at),
            ExprKind::Element(var, index) => {
                self.expr(b, index);
                let len = self.unit.vars.get(var.index()).map_or(0, |v| v.elements);
                let base = self.words.addr(*var);
                self.reads_words(b, *var, base, len);
                b.op(Op::LoadAt { base, len }, at);
            }
            ExprKind::Member(var, member) => {
                let addr = Addr(self.words.addr(*var).0 + u32::from(*member));
                self.reads_words(b, *var, addr, 1);
                b.op(Op::Load(addr), at);
            }
            ExprKind::StepActive(step) => self.active(b, *step, at),
            ExprKind::StepTime(step) => self.step_time(b, *step, at),
            ExprKind::StepTenths(step) => self.step_tenths(b, *step, at),
            ExprKind::StepScans(step) => {
                self.step_scans(b, *step, at);
                b.op(Op::Push(32767), at);
                b.op(Op::Call(Builtin::Min, Num::I64, 2), at);
            }
            ExprKind::StepSeconds(step) => {
                self.clock(b, *step, at);
                if self.unit.rules.scan_clock {
                    b.op(Op::Push(self.unit.cycle as u64), at);
                    b.op(Op::Arith(Arith::Mul, Num::I64), at);
                }
                b.op(Op::Convert(Num::I64, Num::F64), at);
                b.op(Op::Push(1e9f64.to_bits()), at);
                b.op(Op::Arith(Arith::Div, Num::F64), at);
                b.op(Op::Convert(Num::F64, Num::F32), at);
            }
            ExprKind::Not(x) => {
                self.expr(b, x);
                b.op(Op::Not, at);
            }
            ExprKind::Neg(x) => {
                self.expr(b, x);
                b.op(Op::Neg(num(e.ty)), at);
            }
            ExprKind::Rise(x) => self.edge(b, x, Op::Rise, at),
            ExprKind::Fall(x) => self.edge(b, x, Op::Fall, at),
            ExprKind::Binary(..) => self.binary(b, e),
            ExprKind::Timer { t1, e: x, t2 } => match timed_step(x, t2.as_deref()) {
                Some(step) => {
                    self.active(b, step, at);
                    self.step_time(b, step, at);
                    self.expr(b, t1);
                    b.op(Op::Compare(Cmp::Ge, Num::I64), at);
                    b.op(Op::And, at);
                }
                None => self.timer(b, t1, x, t2.as_deref(), at),
            },
            ExprKind::Convert(x) => self.convert(b, x, e.ty, at),
            ExprKind::Trunc(x) => {
                self.expr(b, x);
                b.op(Op::Trunc(num(x.ty), num(e.ty)), at);
            }
            ExprKind::Builtin(f, args) => self.builtin(b, *f, args, e),
            ExprKind::Call(f, args) => self.call(b, *f, args, at),
            ExprKind::Section(s) => self.section(b, *s, at),
            ExprKind::ScanTime => {
                b.reads.time = true;
                b.op(Op::ScanTime, at);
            }
            ExprKind::Random => {
                b.reads.time = true;
                let seed = self.random;
                b.op(Op::Random(seed.unwrap_or(Addr(0))), at);
            }
        }
    }

    fn constant(&mut self, b: &mut Buf, ty: Type, value: &Value, at: Span) {
        let word = match value {
            Value::Str(text) => u64::from(self.words.text(text).0),
            Value::Bool(_) | Value::Int(_) | Value::Real(_) => word_of(ty, value),
        };
        b.op(Op::Push(word), at);
    }

    fn load(&mut self, b: &mut Buf, var: VarId, at: Span) {
        let Some(v) = self.unit.vars.get(var.index()) else { return };
        let addr = self.addr(var);
        match v.ty {
            Type::String(_) => {
                self.reads_words(b, var, addr, super::words::words_of(v.ty));
                b.op(Op::Push(u64::from(addr.0)), at);
            }
            ty if v.class == VarClass::Const && v.elements == 1 => {
                b.op(Op::Push(word_of(ty, &v.init)), at);
            }
            _ => {
                self.reads_words(b, var, addr, 1);
                b.op(Op::Load(addr), at);
            }
        }
    }

    /// Notes what a watch depends on. Locals are set anew at each run, so a
    /// value left in them decides nothing.
    fn reads_words(&mut self, b: &mut Buf, var: VarId, base: Addr, len: u32) {
        let class = self.unit.vars.get(var.index()).map(|v| v.class);
        if !matches!(class, None | Some(VarClass::Local | VarClass::Const)) {
            b.reads.words.extend((base.0..base.0 + len).map(Addr));
        }
    }

    /// Pushes the activity of a step; of a macro-step, that of its expansion.
    pub(super) fn active(&mut self, b: &mut Buf, step: StepId, at: Span) {
        if let Some(group) = self.plan.expansion(self.unit, step).and_then(|c| self.plan.group(c)) {
            b.reads.groups.push(group);
            b.op(Op::GroupActive(group), at);
        } else if let Some(n) = self.plan.own(step) {
            b.reads.steps.push(n);
            b.op(Op::Active(n), at);
        } else {
            b.op(Op::Push(0), at); // left out: never active
        }
    }

    /// Pushes the activity of the step that carries the actions.
    pub(super) fn acting(&mut self, b: &mut Buf, step: StepId, at: Span) {
        match self.plan.own(step) {
            Some(n) => {
                b.reads.steps.push(n);
                b.op(Op::Active(n), at);
            }
            None => b.op(Op::Push(0), at),
        }
    }

    /// Pushes whether any of the steps is active.
    pub(super) fn any_acting(&mut self, b: &mut Buf, steps: &[StepId], at: Span) {
        let Some((first, rest)) = steps.split_first() else { return b.op(Op::Push(0), at) };
        self.acting(b, *first, at);
        for s in rest {
            self.acting(b, *s, at);
            b.op(Op::Or, at);
        }
    }

    /// Pushes the clock of a step as the engine counts it; of a macro-step, since
    /// a step of its expansion is active.
    fn clock(&mut self, b: &mut Buf, step: StepId, at: Span) {
        self.time(b, step, (Op::StepTime, Op::GroupTime), at);
    }

    /// Pushes the time since activation, ns, whatever the clock.
    pub(super) fn step_time(&mut self, b: &mut Buf, step: StepId, at: Span) {
        let scans = self.unit.rules.scan_clock;
        let ops: TimeOps = if scans { (Op::StepAge, Op::GroupAge) } else { (Op::StepTime, Op::GroupTime) };
        self.time(b, step, ops, at);
    }

    /// Pushes the time for which the actions of a step have been at work, ns.
    pub(super) fn acting_time(&mut self, b: &mut Buf, step: StepId, at: Span) {
        b.reads.time = true;
        let op = if self.unit.rules.scan_clock { Op::StepAge } else { Op::StepTime };
        b.op(self.plan.own(step).map_or(Op::Push(0), op), at);
    }

    /// A time goes on by itself, and starts anew within a scan.
    fn time(&mut self, b: &mut Buf, step: StepId, (of_step, of_group): TimeOps, at: Span) {
        b.reads.time = true;
        let group = self.plan.expansion(self.unit, step).and_then(|c| self.plan.group(c));
        match (group, self.plan.own(step)) {
            (Some(group), _) => {
                b.reads.groups.push(group);
                b.op(of_group(group), at);
            }
            (None, Some(n)) => {
                b.reads.steps.push(n);
                b.op(of_step(n), at);
            }
            (None, None) => b.op(Op::Push(0), at),
        }
    }

    fn step_tenths(&mut self, b: &mut Buf, step: StepId, at: Span) {
        let is_macro = self.plan.expansion(self.unit, step).is_some();
        if let (false, false, Some(n)) = (self.unit.rules.scan_clock, is_macro, self.plan.own(step)) {
            b.reads.time = true;
            b.reads.steps.push(n);
            return b.op(Op::StepTenths(n), at);
        }
        self.step_time(b, step, at);
        b.op(Op::Push(100_000_000), at);
        b.op(Op::Arith(Arith::Div, Num::I64), at);
        b.op(Op::Push(9999), at);
        b.op(Op::Call(Builtin::Min, Num::I64, 2), at);
    }

    fn step_scans(&mut self, b: &mut Buf, step: StepId, at: Span) {
        self.clock(b, step, at);
        if !self.unit.rules.scan_clock {
            b.op(Op::Push(self.unit.cycle.max(1) as u64), at);
            b.op(Op::Arith(Arith::Div, Num::I64), at);
        }
    }

    /// Operators between operands. Long sums lean to the left and are gone
    /// along without recursion.
    fn binary(&mut self, b: &mut Buf, e: &Expr) {
        let mut spine = Vec::new();
        let mut leftmost = e;
        while let ExprKind::Binary(op, left, right) = &leftmost.kind {
            spine.push((leftmost, *op, left, right));
            leftmost = left;
        }
        self.expr(b, leftmost);
        for (node, op, left, right) in spine.into_iter().rev() {
            let scaled =
                left.ty == Type::Time && right.ty.is_real() && matches!(op, BinaryOp::Mul | BinaryOp::Div);
            if scaled {
                b.op(Op::Convert(Num::I64, num(right.ty)), node.at);
            }
            self.expr(b, right);
            let kind = num(if scaled { right.ty } else { left.ty });
            let is_text = matches!(left.ty, Type::String(_));
            b.op(operator(op, kind, is_text), node.at);
            if scaled {
                b.op(Op::Convert(kind, Num::I64), node.at);
            }
        }
    }

    fn convert(&mut self, b: &mut Buf, x: &Expr, ty: Type, at: Span) {
        self.expr(b, x);
        match (x.ty, ty) {
            (Type::String(_), Type::String(_)) => {}
            (from, Type::String(n)) => {
                let cap = capacity(n);
                let to = self.words.text_room(cap);
                b.op(Op::ToText { from: num(from), time: from == Type::Time, to, cap }, at);
            }
            (Type::String(_), to) => b.op(Op::FromText(num(to)), at),
            (from, to) if num(from) == num(to) => {}
            (from, to) => b.op(Op::Convert(num(from), num(to)), at),
        }
    }

    fn builtin(&mut self, b: &mut Buf, f: Builtin, args: &[Expr], e: &Expr) {
        for a in args {
            self.expr(b, a);
        }
        match f {
            Builtin::Len
            | Builtin::Find
            | Builtin::Left
            | Builtin::Right
            | Builtin::Mid
            | Builtin::Concat
            | Builtin::Insert
            | Builtin::Delete
            | Builtin::Replace => {
                let (to, cap) = match e.ty {
                    Type::String(n) => (self.words.text_room(capacity(n)), capacity(n)),
                    _ => (Addr(0), 0),
                };
                b.op(Op::Text { function: f, to, cap }, e.at);
            }
            Builtin::Abs
            | Builtin::Sqrt
            | Builtin::Ln
            | Builtin::Log
            | Builtin::Exp
            | Builtin::Sin
            | Builtin::Cos
            | Builtin::Tan
            | Builtin::Asin
            | Builtin::Acos
            | Builtin::Atan
            | Builtin::Min
            | Builtin::Max
            | Builtin::Limit
            | Builtin::Sel
            | Builtin::Mux => {
                b.op(Op::Call(f, num(e.ty), u8::try_from(args.len()).unwrap_or(u8::MAX)), e.at);
            }
        }
    }

    /// A function, in place: arguments into its parameters, its body, its result.
    fn call(&mut self, b: &mut Buf, f: FunctionId, args: &[Expr], at: Span) {
        let unit = self.unit;
        let Some(function) = unit.functions.get(f.index()) else { return b.op(Op::Push(0), at) };
        for a in args {
            self.expr(b, a);
        }
        for (param, arg) in function.params.iter().zip(args).rev() {
            self.store(b, *param, arg.at);
        }
        self.clear(b, function.result, at);
        self.inline(b, &function.statements);
        let ty = unit.vars.get(function.result.index()).map_or(Type::Bool, |v| v.ty);
        let result = self.words.addr(function.result);
        match ty {
            // A second call would write over it.
            Type::String(n) => {
                let cap = capacity(n);
                let to = self.words.text_room(cap);
                b.op(Op::Push(u64::from(result.0)), at);
                b.op(Op::StoreText { to, cap }, at);
                b.op(Op::Push(u64::from(to.0)), at);
            }
            _ => b.op(Op::Load(result), at),
        }
    }

    /// A transition section, in place. Its output is FALSE at the start of each
    /// run, but takes its value only at the end: what it has been in between is
    /// no change.
    fn section(&mut self, b: &mut Buf, s: SectionId, at: Span) {
        let unit = self.unit;
        let Some(section) = unit.sections.get(s.index()) else { return b.op(Op::Push(0), at) };
        if let [only] = section.statements.as_slice()
            && let StmtKind::Assign(Target::Var(to), e) = &only.kind
            && *to == section.output
        {
            self.expr(b, e);
        } else {
            let value = self.words.hidden(0);
            b.op(Op::Push(0), at);
            b.op(Op::Store(value), at);
            let outer = self.section.replace((section.output, value));
            self.inline(b, &section.statements);
            self.section = outer;
            b.op(Op::Load(value), at);
        }
        let to = self.words.addr(section.output);
        b.op(Op::Store(to), at);
        b.op(Op::Load(to), at);
    }

    /// Where a variable is read and written now.
    fn addr(&self, var: VarId) -> Addr {
        match self.section {
            Some((output, value)) if output == var => value,
            _ => self.words.addr(var),
        }
    }

    fn clear(&mut self, b: &mut Buf, var: VarId, at: Span) {
        let is_text = self.unit.vars.get(var.index()).is_some_and(|v| matches!(v.ty, Type::String(_)));
        let zero = if is_text { u64::from(self.words.text("").0) } else { 0 };
        b.op(Op::Push(zero), at);
        self.store(b, var, at);
    }

    /// Pops into a variable.
    pub(super) fn store(&mut self, b: &mut Buf, var: VarId, at: Span) {
        let to = self.addr(var);
        match self.unit.vars.get(var.index()).map(|v| v.ty) {
            Some(Type::String(n)) => b.op(Op::StoreText { to, cap: capacity(n) }, at),
            Some(_) => b.op(Op::Store(to), at),
            None => b.op(Op::Drop, at),
        }
    }
}

fn operator(op: BinaryOp, kind: Num, is_text: bool) -> Op {
    let compare = |c| if is_text { Op::CompareText(c) } else { Op::Compare(c, kind) };
    match op {
        BinaryOp::Or => Op::Or,
        BinaryOp::Xor => Op::Xor,
        BinaryOp::And => Op::And,
        BinaryOp::Eq => compare(Cmp::Eq),
        BinaryOp::Ne => compare(Cmp::Ne),
        BinaryOp::Lt => compare(Cmp::Lt),
        BinaryOp::Le => compare(Cmp::Le),
        BinaryOp::Gt => compare(Cmp::Gt),
        BinaryOp::Ge => compare(Cmp::Ge),
        BinaryOp::Add => Op::Arith(Arith::Add, kind),
        BinaryOp::Sub => Op::Arith(Arith::Sub, kind),
        BinaryOp::Mul => Op::Arith(Arith::Mul, kind),
        BinaryOp::Div => Op::Arith(Arith::Div, kind),
        BinaryOp::Mod => Op::Arith(Arith::Mod, kind),
        BinaryOp::Pow => Op::Arith(Arith::Pow, kind),
    }
}
