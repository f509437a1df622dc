//! Trees as instructions of the stack machine.
//!
//! Code is written into a [`Buf`] with jumps counted from its own start; `pieces`
//! moves it to its place in the table.

use g7_engine::number::widens;
use g7_engine::{Addr, Builtin, Op};
use g7_model::{Span, Type};

use super::words::num;
use crate::tree::{Clock, Expr, ExprKind, Gate, Piece, Stmt, StmtKind, Target, transfers};

/// Gates and complements within one another that are written as jumps; deeper ones are worked out on
/// the stack.
const DEEPEST: u32 = 64;

/// With so many operands the value of a gate is stored by jumps, which are then shorter.
const LONG: usize = 4;

/// Code being written.
#[derive(Default)]
pub(super) struct Buf {
    pub(super) ops: Vec<Op>,
    pub(super) places: Vec<Span>,
    /// For each loop round this point, the jumps that leave it.
    loops: Vec<Vec<usize>>,
    /// For each body round this point, the jumps to its end.
    returns: Vec<Vec<usize>>,
}

impl Buf {
    pub(super) fn clear(&mut self) {
        self.ops.clear();
        self.places.clear();
    }

    fn op(&mut self, op: Op, at: Span) {
        self.ops.push(op);
        self.places.push(at);
    }

    /// The place of the next instruction.
    fn here(&self) -> u32 {
        self.ops.len() as u32
    }

    /// Jumps that are made where a condition has this value; code goes on behind where it has the
    /// other. What one operand of a gate decides is settled by its own jump.
    fn branch(&mut self, e: &Expr, value: bool, at: Span, deep: u32) -> Vec<usize> {
        match &e.kind {
            ExprKind::Not(x) if deep < DEEPEST => self.branch(x, !value, at, deep + 1),
            ExprKind::Gate(gate @ (Gate::And | Gate::Or), ..) if deep < DEEPEST => {
                let (mut jumps, mut past) = (Vec::new(), Vec::new());
                let (last, before) = spine(e, *gate);
                // FALSE decides an AND, TRUE an OR.
                let decides = *gate == Gate::Or;
                for x in before {
                    let made = self.branch(x, decides, at, deep + 1);
                    if decides == value { jumps.extend(made) } else { past.extend(made) }
                }
                jumps.extend(self.branch(last, value, at, deep + 1));
                past.into_iter().for_each(|jump| self.land(jump));
                jumps
            }
            _ => {
                self.expr(e);
                if value {
                    self.op(Op::Not, at);
                }
                vec![self.jump(Op::JumpUnless, at)]
            }
        }
    }

    /// Jumps that are made unless a condition holds.
    fn unless(&mut self, condition: &Expr) -> Vec<usize> {
        self.branch(condition, false, condition.at, 0)
    }

    /// A jump whose target is not known yet.
    fn jump(&mut self, op: fn(u32) -> Op, at: Span) -> usize {
        self.op(op(0), at);
        self.ops.len() - 1
    }

    /// Sends a jump to the next instruction.
    fn land(&mut self, jump: usize) {
        self.send(jump, self.here());
    }

    fn send(&mut self, jump: usize, here: u32) {
        match self.ops.get_mut(jump) {
            Some(Op::Jump(to) | Op::JumpUnless(to)) => *to = here,
            _ => debug_assert!(false, "not a jump"),
        }
    }

    pub(super) fn piece(&mut self, piece: &Piece) {
        match piece {
            Piece::Value(e) => self.expr(e),
            Piece::Work(list) => self.stmts(list),
        }
    }

    /// Pushes the value of an expression.
    pub(super) fn expr(&mut self, e: &Expr) {
        let at = e.at;
        match &e.kind {
            ExprKind::Const(_, v) => self.op(Op::Push(*v), at),
            ExprKind::Text(addr, _) => self.op(Op::Push(u64::from(addr.0)), at),
            ExprKind::Word(_, addr) => self.op(Op::Load(*addr), at),
            ExprKind::Element { base, len, index, .. } => {
                self.expr(index);
                self.op(Op::LoadAt { base: *base, len: *len }, at);
            }
            ExprKind::Active(step) => self.op(Op::Active(*step), at),
            ExprKind::WasActive(step) => self.op(Op::WasActive(*step), at),
            ExprKind::GroupActive(group) => self.op(Op::GroupActive(*group), at),
            ExprKind::Time(clock) => {
                let op = match *clock {
                    Clock::Step(step) | Clock::StepScans(step) => Op::StepTime(step),
                    Clock::StepAge(step) => Op::StepAge(step),
                    Clock::Group(group) | Clock::GroupScans(group) => Op::GroupTime(group),
                    Clock::GroupAge(group) => Op::GroupAge(group),
                };
                self.op(op, at);
            }
            ExprKind::Tenths(step) => self.op(Op::StepTenths(*step), at),
            ExprKind::Rise(watch) => self.op(Op::Rise(*watch), at),
            ExprKind::Fall(watch) => self.op(Op::Fall(*watch), at),
            ExprKind::Timer(watch) => self.op(Op::Timer(*watch), at),
            ExprKind::Due(period) => self.op(Op::Due(*period), at),
            ExprKind::Not(x) => self.one(x, Op::Not, at),
            ExprKind::Neg(n, x) => self.one(x, Op::Neg(num(*n)), at),
            // A word of a whole number is the same in each kind that has its value.
            ExprKind::Convert(from, to, x) if widens(num(*from), num(*to)) => self.expr(x),
            ExprKind::Convert(from, to, x) if transfers(*from, *to) => {
                self.one(x, Op::Call(Builtin::Transfer, num(*to), 1), at);
            }
            ExprKind::Convert(from, to, x) => self.one(x, Op::Convert(num(*from), num(*to)), at),
            ExprKind::Trunc(from, to, x) => self.one(x, Op::Trunc(num(*from), num(*to)), at),
            ExprKind::FromText(n, x) => self.one(x, Op::FromText(num(*n)), at),
            ExprKind::Gate(..) | ExprKind::Arith(..) | ExprKind::Compare(..) | ExprKind::CompareText(..) => {
                self.binary(e);
            }
            ExprKind::Call(f, n, args) => {
                args.iter().for_each(|a| self.expr(a));
                self.op(Op::Call(*f, num(*n), u8::try_from(args.len()).unwrap_or(u8::MAX)), at);
            }
            ExprKind::TextCall { function, args, to, cap } => {
                args.iter().for_each(|a| self.expr(a));
                self.op(Op::Text { function: *function, to: *to, cap: *cap }, at);
            }
            ExprKind::ToText { from, to, cap, value } => {
                let time = *from == Type::Time;
                self.one(value, Op::ToText { from: num(*from), time, to: *to, cap: *cap }, at);
            }
            ExprKind::ScanTime => self.op(Op::ScanTime, at),
            ExprKind::Random(addr) => self.op(Op::Random(*addr), at),
            ExprKind::After(list, value) => {
                self.stmts(list);
                self.expr(value);
            }
        }
    }

    fn one(&mut self, x: &Expr, op: Op, at: Span) {
        self.expr(x);
        self.op(op, at);
    }

    /// Operators between two operands. Long sums lean to the left and are gone
    /// along without recursion.
    fn binary(&mut self, e: &Expr) {
        let mut spine = Vec::new();
        let mut leftmost = e;
        while let ExprKind::Gate(_, left, right)
        | ExprKind::Arith(_, _, left, right)
        | ExprKind::Compare(_, _, left, right)
        | ExprKind::CompareText(_, left, right) = &leftmost.kind
        {
            spine.push((leftmost, right));
            leftmost = left;
        }
        self.expr(leftmost);
        for (node, right) in spine.into_iter().rev() {
            let at = node.at;
            let op = match &node.kind {
                ExprKind::Gate(gate @ (Gate::And | Gate::Or), ..) if right.has_effect() => {
                    self.short_circuit(*gate, right, at);
                    continue;
                }
                ExprKind::Gate(Gate::And, ..) => Op::And,
                ExprKind::Gate(Gate::Or, ..) => Op::Or,
                ExprKind::Gate(Gate::Xor, ..) => Op::Xor,
                ExprKind::Arith(op, n, ..) => Op::Arith(*op, num(*n)),
                ExprKind::Compare(c, n, ..) => Op::Compare(*c, num(*n)),
                ExprKind::CompareText(c, ..) => Op::CompareText(*c),
                _ => continue,
            };
            self.expr(right);
            self.op(op, at);
        }
    }

    /// The left operand is on top; the right one is not evaluated where the left
    /// one decides.
    fn short_circuit(&mut self, gate: Gate, right: &Expr, at: Span) {
        if gate == Gate::Or {
            self.op(Op::Not, at);
        }
        let decided = self.jump(Op::JumpUnless, at);
        self.expr(right);
        let end = self.jump(Op::Jump, at);
        self.land(decided);
        self.op(Op::Push(u64::from(gate == Gate::Or)), at);
        self.land(end);
    }

    pub(super) fn stmts(&mut self, list: &[Stmt]) {
        list.iter().for_each(|s| self.stmt(s));
    }

    fn stmt(&mut self, s: &Stmt) {
        let at = s.at;
        match &s.kind {
            StmtKind::Store(_, Target::Word(to), e) if operands(e, 0) >= LONG => self.decide(e, *to, at),
            StmtKind::Store(_, Target::Word(to), e) => self.one(e, Op::Store(*to), at),
            StmtKind::Store(_, Target::Element(base, len, index), e) => {
                self.expr(index);
                self.one(e, Op::StoreAt { base: *base, len: *len }, at);
            }
            StmtKind::StoreText(to, cap, e) => self.one(e, Op::StoreText { to: *to, cap: *cap }, at),
            StmtKind::Evaluate(e) => self.one(e, Op::Drop, at),
            StmtKind::If(arms, other) => self.alternatives(arms, other),
            StmtKind::Loop(body, until) => self.repeat(body, until.as_ref(), at),
            StmtKind::LeaveUnless(e) => {
                for jump in self.unless(e) {
                    self.leave(jump);
                }
            }
            StmtKind::Leave => {
                let jump = self.jump(Op::Jump, at);
                self.leave(jump);
            }
            StmtKind::Body(body) => {
                let loops = std::mem::take(&mut self.loops);
                self.returns.push(Vec::new());
                self.stmts(body);
                for jump in self.returns.pop().unwrap_or_default() {
                    self.land(jump);
                }
                self.loops = loops;
            }
            StmtKind::Return => {
                if self.returns.is_empty() {
                    return self.op(Op::Return, at);
                }
                let jump = self.jump(Op::Jump, at);
                if let Some(r) = self.returns.last_mut() {
                    r.push(jump);
                }
            }
            StmtKind::Fb(block, base) => self.op(Op::Fb(*block, *base), at),
            StmtKind::Service(service) => self.op(Op::Service(*service), at),
        }
    }

    /// Stores the value of a gate, by jumps over the operands that do not decide.
    fn decide(&mut self, e: &Expr, to: Addr, at: Span) {
        let other = self.unless(e);
        self.op(Op::Push(1), at);
        self.op(Op::Store(to), at);
        let end = self.jump(Op::Jump, at);
        other.into_iter().for_each(|jump| self.land(jump));
        self.op(Op::Push(0), at);
        self.op(Op::Store(to), at);
        self.land(end);
    }

    /// A jump out of the innermost loop; outside of a loop (reported) it has no effect.
    fn leave(&mut self, jump: usize) {
        match self.loops.last_mut() {
            Some(l) => l.push(jump),
            None => self.land(jump),
        }
    }

    fn repeat(&mut self, body: &[Stmt], until: Option<&Expr>, at: Span) {
        let start = self.here();
        self.loops.push(Vec::new());
        self.stmts(body);
        match until {
            Some(e) => {
                for jump in self.unless(e) {
                    self.send(jump, start);
                }
            }
            None => self.op(Op::Jump(start), at),
        }
        for jump in self.loops.pop().unwrap_or_default() {
            self.land(jump);
        }
    }

    fn alternatives(&mut self, arms: &[(Expr, Vec<Stmt>)], other: &[Stmt]) {
        let mut ends = Vec::new();
        for (i, (condition, then)) in arms.iter().enumerate() {
            let next = self.unless(condition);
            self.stmts(then);
            if i + 1 < arms.len() || !other.is_empty() {
                ends.push(self.jump(Op::Jump, condition.at));
            }
            next.into_iter().for_each(|jump| self.land(jump));
        }
        self.stmts(other);
        ends.into_iter().for_each(|jump| self.land(jump));
    }
}

/// The number of operands that [`Buf::branch`] asks for one by one.
fn operands(e: &Expr, deep: u32) -> usize {
    match &e.kind {
        ExprKind::Not(x) if deep < DEEPEST => operands(x, deep + 1),
        ExprKind::Gate(gate @ (Gate::And | Gate::Or), ..) if deep < DEEPEST => {
            let (last, before) = spine(e, *gate);
            before.into_iter().chain([last]).map(|x| operands(x, deep + 1)).sum()
        }
        _ => 1,
    }
}

/// The operands of a gate and of the same gates in its left operands: the last, and those before it.
fn spine(e: &Expr, gate: Gate) -> (&Expr, Vec<&Expr>) {
    let (mut e, mut found) = (e, Vec::new());
    while let ExprKind::Gate(g, left, right) = &e.kind
        && *g == gate
    {
        found.push(&**right);
        e = left;
    }
    found.push(e);
    found.reverse();
    let last = found.pop().unwrap_or(e);
    (last, found)
}
