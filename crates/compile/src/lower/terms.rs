//! Typed expressions as trees of words, steps and watches.
//!
//! A piece of code belongs to the period of the chart it stands in: its edges
//! and timers are those of that period.

use g7_engine::{Addr, Arith, Builtin, Cmp, GroupId, StepId as Number};
use g7_model::{Span, Type};

use super::uses::{DEPTH, timed_step};
use super::words::{capacity, word_of};
use super::work::{Lower, Refusal};
use crate::ir::{self, BinaryOp, FunctionId, SectionId, StepId, StmtKind, Target, Value, VarClass, VarId};
use crate::tree::{self, Clock, Expr, ExprKind, Gate, Stmt};

/// Nodes that the code of one program may have; more comes only from functions
/// that call functions that call functions.
const MOST: usize = 1 << 22;

/// The clock of a step and of a group.
type Clocks = (fn(Number) -> Clock, fn(GroupId) -> Clock);

/// Nanoseconds in a unit of `%Xi.T`.
const TENTH: i64 = 100_000_000;

impl Lower<'_> {
    /// True if there is room for one node more; says so once if not.
    pub(super) fn room(&mut self, at: Span) -> bool {
        self.nodes += 1;
        if self.nodes > MOST {
            self.refuse(Refusal::Large, at);
        }
        if self.depth > DEPTH {
            self.refuse(Refusal::Deep, at);
        }
        self.refused.is_none()
    }

    /// The tree of an expression in a piece of code of a period.
    pub(super) fn expr(&mut self, period: u32, e: &ir::Expr) -> Expr {
        if !self.room(e.at) {
            return Expr::truth(false, e.at);
        }
        self.depth += 1;
        let tree = self.kind(period, e);
        self.depth -= 1;
        tree
    }

    fn boxed(&mut self, period: u32, e: &ir::Expr) -> Box<Expr> {
        Box::new(self.expr(period, e))
    }

    fn kind(&mut self, period: u32, e: &ir::Expr) -> Expr {
        let at = e.at;
        let kind = match &e.kind {
            ir::ExprKind::Const(value) => return self.constant(e.ty.stored(), value, at),
            ir::ExprKind::Var(var) => return self.load(*var, at),
            ir::ExprKind::Element(all, index) => {
                let index = Box::new(self.element_place(period, all, index));
                ExprKind::Element {
                    ty: e.ty.stored(),
                    base: self.words.addr(all.first),
                    len: all.count(),
                    index,
                }
            }
            ir::ExprKind::Member(var, member) => {
                ExprKind::Word(e.ty, Addr(self.words.addr(*var).0 + u32::from(*member)))
            }
            ir::ExprKind::StepActive(step) => return self.active(*step, at),
            ir::ExprKind::StepTime(step) => return self.step_time(*step, at),
            ir::ExprKind::StepTenths(step) => return self.step_tenths(*step, at),
            ir::ExprKind::StepScans(step) => {
                let scans = vec![self.step_scans(*step, at), Expr::long(32767, at)];
                ExprKind::Call(Builtin::Min, Type::Lint, scans)
            }
            ir::ExprKind::StepSeconds(step) => return self.step_seconds(*step, at),
            ir::ExprKind::Not(x) => ExprKind::Not(self.boxed(period, x)),
            ir::ExprKind::Neg(x) => ExprKind::Neg(e.ty, self.boxed(period, x)),
            ir::ExprKind::Rise(x) => return self.edge(period, x, ExprKind::Rise, at),
            ir::ExprKind::Fall(x) => return self.edge(period, x, ExprKind::Fall, at),
            ir::ExprKind::Binary(..) => return self.binary(period, e),
            ir::ExprKind::Timer { t1, e: x, t2 } => match timed_step(x, t2.as_deref()) {
                Some(step) => {
                    let active = self.active(step, at);
                    let time = self.step_time(step, at);
                    let t1 = self.expr(period, t1);
                    return active.gate(Gate::And, time.compare(Cmp::Ge, Type::Time, t1, at), at);
                }
                None => return self.timer(period, t1, x, t2.as_deref(), at),
            },
            ir::ExprKind::Convert(x) => return self.convert(period, x, e.ty, at),
            ir::ExprKind::Trunc(x) => {
                let value = self.boxed(period, x);
                ExprKind::Trunc(x.ty, e.ty, value)
            }
            ir::ExprKind::Builtin(f, args) => return self.builtin(period, *f, args, e),
            ir::ExprKind::Call(f, args) => return self.call(period, *f, args, at),
            ir::ExprKind::Section(s) => return self.section(period, *s, at),
            ir::ExprKind::ScanTime => ExprKind::ScanTime,
            ir::ExprKind::Random => ExprKind::Random(self.random.unwrap_or(Addr(0))),
        };
        Expr::new(kind, at)
    }

    /// The place of an element among all of them. In several dimensions each index is held to its own bounds, by
    /// an element that is read for nothing: an index outside of them must not lead to another element.
    pub(super) fn element_place(&mut self, period: u32, all: &ir::Elements, index: &[ir::Expr]) -> Expr {
        let base = self.words.addr(all.first);
        let ty = self.stored_type(all.first).unwrap_or(Type::Bool);
        let at = index.first().map_or(Span::default(), |e| e.at);
        let (mut stride, mut sum, mut held) = (1, None, Vec::new());
        for (e, count) in index.iter().zip(&*all.counts).rev() {
            let one = self.expr(period, e);
            if index.len() > 1 && !matches!(one.kind, ExprKind::Const(..)) {
                let kind = ExprKind::Element { ty, base, len: *count, index: Box::new(one.clone()) };
                held.push(Stmt { kind: tree::StmtKind::Evaluate(Expr::new(kind, e.at)), at: e.at });
            }
            let part = match (stride, &one.kind) {
                (1, _) => one,
                (_, ExprKind::Const(_, n)) => Expr::long(*n as i64 * stride, e.at),
                _ => one.arith(Arith::Mul, Type::Lint, Expr::long(stride, e.at), e.at),
            };
            sum = Some(match sum {
                Some(sum) => part.arith(Arith::Add, Type::Lint, sum, e.at),
                None => part,
            });
            stride *= i64::from(*count);
        }
        let sum = sum.unwrap_or_else(|| Expr::long(0, at));
        held.reverse();
        if held.is_empty() { sum } else { Expr::new(ExprKind::After(held, Box::new(sum)), at) }
    }

    fn constant(&mut self, ty: Type, value: &Value, at: Span) -> Expr {
        let kind = match value {
            Value::Str(text) => {
                let cap = capacity(u16::try_from(text.len()).unwrap_or(u16::MAX));
                ExprKind::Text(self.words.text(text), cap)
            }
            Value::Bool(_) | Value::Int(_) | Value::Real(_) => ExprKind::Const(ty, word_of(ty, value)),
        };
        Expr::new(kind, at)
    }

    fn load(&mut self, var: VarId, at: Span) -> Expr {
        let Some(v) = self.unit.vars.get(var.index()) else { return Expr::truth(false, at) };
        let addr = self.addr(var);
        let kind = match v.ty.stored() {
            Type::String(n) => ExprKind::Text(addr, capacity(n)),
            ty if v.class == VarClass::Const && v.elements == 1 => ExprKind::Const(ty, word_of(ty, &v.init)),
            ty => ExprKind::Word(ty, addr),
        };
        Expr::new(kind, at)
    }

    /// The activity of a step; of a macro-step, that of its expansion.
    pub(super) fn active(&mut self, step: StepId, at: Span) -> Expr {
        match self.plan.expansion(self.unit, step).and_then(|c| self.plan.group(c)) {
            Some(group) => Expr::new(ExprKind::GroupActive(group), at),
            None => self.acting(step, at),
        }
    }

    /// The activity of the step that carries the actions. A step that was left
    /// out is never active.
    pub(super) fn acting(&mut self, step: StepId, at: Span) -> Expr {
        match self.plan.own(step) {
            Some(n) => Expr::new(ExprKind::Active(n), at),
            None => Expr::truth(false, at),
        }
    }

    /// One of the steps is active.
    pub(super) fn any_acting(&mut self, steps: &[StepId], at: Span) -> Expr {
        let Some((first, rest)) = steps.split_first() else { return Expr::truth(false, at) };
        let mut any = self.acting(*first, at);
        for s in rest {
            any = any.gate(Gate::Or, self.acting(*s, at), at);
        }
        any
    }

    /// The time since activation (TIME); of a macro-step, since a step of its
    /// expansion is active.
    pub(super) fn step_time(&self, step: StepId, at: Span) -> Expr {
        let clocks: Clocks = if self.unit.rules.scan_clock {
            (Clock::StepAge, Clock::GroupAge)
        } else {
            (Clock::Step, Clock::Group)
        };
        self.clock(step, clocks, Type::Time, at)
    }

    fn clock(&self, step: StepId, (of_step, of_group): Clocks, ty: Type, at: Span) -> Expr {
        let group = self.plan.expansion(self.unit, step).and_then(|c| self.plan.group(c));
        let kind = match (group, self.plan.own(step)) {
            (Some(group), _) => ExprKind::Time(of_group(group)),
            (None, Some(n)) => ExprKind::Time(of_step(n)),
            (None, None) => ExprKind::Const(ty, 0),
        };
        Expr::new(kind, at)
    }

    /// The time for which the actions of a step have been at work (TIME).
    pub(super) fn acting_time(&self, step: StepId, at: Span) -> Expr {
        let clock = if self.unit.rules.scan_clock { Clock::StepAge } else { Clock::Step };
        let kind = self.plan.own(step).map_or(ExprKind::Const(Type::Time, 0), |n| ExprKind::Time(clock(n)));
        Expr::new(kind, at)
    }

    /// The time since activation in nanoseconds (LINT).
    fn step_nanos(&self, step: StepId, at: Span) -> Expr {
        let time = self.step_time(step, at);
        Expr::new(ExprKind::Convert(Type::Time, Type::Lint, Box::new(time)), at)
    }

    fn step_tenths(&self, step: StepId, at: Span) -> Expr {
        let is_macro = self.plan.expansion(self.unit, step).is_some();
        if let (false, false, Some(n)) = (self.unit.rules.scan_clock, is_macro, self.plan.own(step)) {
            return Expr::new(ExprKind::Tenths(n), at);
        }
        let tenths = self.step_nanos(step, at).arith(Arith::Div, Type::Lint, Expr::long(TENTH, at), at);
        Expr::new(ExprKind::Call(Builtin::Min, Type::Lint, vec![tenths, Expr::long(9999, at)]), at)
    }

    fn step_scans(&self, step: StepId, at: Span) -> Expr {
        if self.unit.rules.scan_clock {
            return self.clock(step, (Clock::StepScans, Clock::GroupScans), Type::Lint, at);
        }
        let cycle = Expr::long(self.unit.cycle.count().max(1), at);
        self.step_nanos(step, at).arith(Arith::Div, Type::Lint, cycle, at)
    }

    fn step_seconds(&self, step: StepId, at: Span) -> Expr {
        let nanos = if self.unit.rules.scan_clock {
            let scans = self.clock(step, (Clock::StepScans, Clock::GroupScans), Type::Lint, at);
            scans.arith(Arith::Mul, Type::Lint, Expr::long(self.unit.cycle.count(), at), at)
        } else {
            self.step_nanos(step, at)
        };
        let real = |kind| Expr::new(kind, at);
        let nanos = real(ExprKind::Convert(Type::Lint, Type::Lreal, Box::new(nanos)));
        let second = real(ExprKind::Const(Type::Lreal, 1e9f64.to_bits()));
        let seconds = nanos.arith(Arith::Div, Type::Lreal, second, at);
        real(ExprKind::Convert(Type::Lreal, Type::Real, Box::new(seconds)))
    }

    /// Operators between operands. Long sums lean to the left and are gone
    /// along without recursion.
    fn binary(&mut self, period: u32, e: &ir::Expr) -> Expr {
        let mut spine = Vec::new();
        let mut leftmost = e;
        while let ir::ExprKind::Binary(op, left, right) = &leftmost.kind {
            spine.push((leftmost, *op, left, right));
            leftmost = left;
        }
        let mut tree = self.expr(period, leftmost);
        for (node, op, left, right) in spine.into_iter().rev() {
            let at = node.at;
            let scaled =
                left.ty == Type::Time && right.ty.is_real() && matches!(op, BinaryOp::Mul | BinaryOp::Div);
            if scaled {
                tree = Expr::new(ExprKind::Convert(Type::Time, right.ty, Box::new(tree)), at);
            }
            let other = self.expr(period, right);
            let kind = if scaled { right.ty } else { left.ty.stored() };
            let is_text = matches!(left.ty, Type::String(_));
            tree = operator(op, kind, is_text, tree, other, at);
            if scaled {
                tree = Expr::new(ExprKind::Convert(kind, Type::Time, Box::new(tree)), at);
            }
        }
        tree
    }

    fn convert(&mut self, period: u32, x: &ir::Expr, ty: Type, at: Span) -> Expr {
        let value = self.expr(period, x);
        let kind = match (x.ty.stored(), ty.stored()) {
            (Type::String(_), Type::String(_)) => return value,
            (from, Type::String(n)) => {
                let cap = capacity(n);
                let to = self.words.text_room(cap);
                let value = Box::new(value);
                ExprKind::ToText { from, to, cap, value }
            }
            (Type::String(_), to) => ExprKind::FromText(to, Box::new(value)),
            (from, to) if from == to => return value,
            (from, to) => ExprKind::Convert(from, to, Box::new(value)),
        };
        Expr::new(kind, at)
    }

    fn builtin(&mut self, period: u32, function: Builtin, args: &[ir::Expr], e: &ir::Expr) -> Expr {
        let args: Vec<Expr> = args.iter().map(|a| self.expr(period, a)).collect();
        let kind = if function.is_of_texts() {
            let (to, cap) = match e.ty {
                Type::String(n) => (self.words.text_room(capacity(n)), capacity(n)),
                _ => (Addr(0), 0),
            };
            ExprKind::TextCall { function, args, to, cap }
        } else {
            ExprKind::Call(function, e.ty.stored(), args)
        };
        Expr::new(kind, e.at)
    }

    /// A function, in place: arguments into its parameters, its body, its result.
    fn call(&mut self, period: u32, f: FunctionId, args: &[ir::Expr], at: Span) -> Expr {
        let unit = self.unit;
        let Some(function) = unit.functions.get(f.index()) else { return Expr::truth(false, at) };
        let mut list = Vec::new();
        let args = self.arguments(period, args, &mut list);
        for (param, arg) in function.params.iter().zip(args) {
            let place = arg.at;
            list.push(self.store(*param, arg, place));
        }
        list.push(self.clear(function.result, at));
        list.push(self.inline(period, &function.statements));
        let ty = self.stored_type(function.result).unwrap_or(Type::Bool);
        let result = self.words.addr(function.result);
        let value = match ty {
            // A second call would write over it.
            Type::String(n) => {
                let cap = capacity(n);
                let to = self.words.text_room(cap);
                let text = Expr::new(ExprKind::Text(result, cap), at);
                list.push(Stmt { kind: tree::StmtKind::StoreText(to, cap, text), at });
                ExprKind::Text(to, cap)
            }
            _ => ExprKind::Word(ty, result),
        };
        Expr::new(ExprKind::After(list, Box::new(Expr::new(value, at))), at)
    }

    /// The arguments of a call. Where a later one calls a function itself, which
    /// might be the same, the earlier ones are put aside first.
    fn arguments(&mut self, period: u32, args: &[ir::Expr], list: &mut Vec<Stmt>) -> Vec<Expr> {
        let trees: Vec<Expr> = args.iter().map(|a| self.expr(period, a)).collect();
        let calls = |e: &Expr| {
            let mut found = false;
            e.visit(&mut |e| found |= matches!(e.kind, ExprKind::After(..)));
            found
        };
        let aside = trees.iter().rposition(calls).unwrap_or(0);
        let mut ready = Vec::with_capacity(trees.len());
        for (i, (tree, arg)) in trees.into_iter().zip(args).enumerate() {
            ready.push(if i < aside { self.put_aside(tree, arg.ty.stored(), list) } else { tree });
        }
        ready
    }

    fn put_aside(&mut self, e: Expr, ty: Type, list: &mut Vec<Stmt>) -> Expr {
        let at = e.at;
        if let Type::String(n) = ty {
            let cap = capacity(n);
            let to = self.words.text_room(cap);
            list.push(Stmt { kind: tree::StmtKind::StoreText(to, cap, e), at });
            return Expr::new(ExprKind::Text(to, cap), at);
        }
        let to = self.words.hidden(0);
        list.push(store_word(ty, to, e, at));
        Expr::new(ExprKind::Word(ty, to), at)
    }

    /// A transition section, in place. Its output is FALSE at the start of each
    /// run, but takes its value only at the end: what it has been in between is
    /// no change.
    fn section(&mut self, period: u32, s: SectionId, at: Span) -> Expr {
        let unit = self.unit;
        let Some(section) = unit.sections.get(s.index()) else { return Expr::truth(false, at) };
        let to = self.words.addr(section.output);
        let mut list = Vec::new();
        let value = if let [only] = section.statements.as_slice()
            && let StmtKind::Assign(Target::Var(output), e) = &only.kind
            && *output == section.output
        {
            self.expr(period, e)
        } else {
            let word = self.words.hidden(0);
            list.push(store_word(Type::Bool, word, Expr::truth(false, at), at));
            let outer = self.section.replace((section.output, word));
            list.push(self.inline(period, &section.statements));
            self.section = outer;
            Expr::new(ExprKind::Word(Type::Bool, word), at)
        };
        list.push(store_word(Type::Bool, to, value, at));
        Expr::new(ExprKind::After(list, Box::new(Expr::new(ExprKind::Word(Type::Bool, to), at))), at)
    }

    /// The type that the values of a variable have in a run.
    pub(super) fn stored_type(&self, var: VarId) -> Option<Type> {
        self.unit.vars.get(var.index()).map(|v| v.ty.stored())
    }

    /// Where a variable is read and written now.
    pub(super) fn addr(&self, var: VarId) -> Addr {
        match self.section {
            Some((output, value)) if output == var => value,
            _ => self.words.addr(var),
        }
    }

    /// Zero, FALSE or the empty text into a variable.
    fn clear(&mut self, var: VarId, at: Span) -> Stmt {
        let ty = self.stored_type(var).unwrap_or(Type::Bool);
        let zero = match ty {
            Type::String(_) => ExprKind::Text(self.words.text(""), 0),
            _ => ExprKind::Const(ty, 0),
        };
        self.store(var, Expr::new(zero, at), at)
    }

    /// A value into a variable.
    pub(super) fn store(&mut self, var: VarId, value: Expr, at: Span) -> Stmt {
        let to = self.addr(var);
        match self.stored_type(var) {
            Some(Type::String(n)) => Stmt { kind: tree::StmtKind::StoreText(to, capacity(n), value), at },
            Some(ty) => store_word(ty, to, value, at),
            None => Stmt { kind: tree::StmtKind::Evaluate(value), at },
        }
    }
}

/// A number into a word.
pub(super) fn store_word(ty: Type, to: Addr, value: Expr, at: Span) -> Stmt {
    Stmt { kind: tree::StmtKind::Store(ty, tree::Target::Word(to), value), at }
}

fn operator(op: BinaryOp, ty: Type, is_text: bool, left: Expr, right: Expr, at: Span) -> Expr {
    let gate = match op {
        BinaryOp::Or => Some(Gate::Or),
        BinaryOp::Xor => Some(Gate::Xor),
        BinaryOp::And => Some(Gate::And),
        _ => None,
    };
    let compare = match op {
        BinaryOp::Eq => Some(Cmp::Eq),
        BinaryOp::Ne => Some(Cmp::Ne),
        BinaryOp::Lt => Some(Cmp::Lt),
        BinaryOp::Le => Some(Cmp::Le),
        BinaryOp::Gt => Some(Cmp::Gt),
        BinaryOp::Ge => Some(Cmp::Ge),
        _ => None,
    };
    let (left, right) = (Box::new(left), Box::new(right));
    let kind = match (gate, compare) {
        (Some(gate), _) => ExprKind::Gate(gate, left, right),
        (_, Some(c)) if is_text => ExprKind::CompareText(c, left, right),
        (_, Some(c)) => ExprKind::Compare(c, ty, left, right),
        (None, None) => ExprKind::Arith(arithmetic(op), ty, left, right),
    };
    Expr::new(kind, at)
}

fn arithmetic(op: BinaryOp) -> Arith {
    match op {
        BinaryOp::Sub => Arith::Sub,
        BinaryOp::Mul => Arith::Mul,
        BinaryOp::Div => Arith::Div,
        BinaryOp::Mod => Arith::Mod,
        BinaryOp::Pow => Arith::Pow,
        BinaryOp::Add
        | BinaryOp::Or
        | BinaryOp::Xor
        | BinaryOp::And
        | BinaryOp::Eq
        | BinaryOp::Ne
        | BinaryOp::Lt
        | BinaryOp::Le
        | BinaryOp::Gt
        | BinaryOp::Ge => Arith::Add,
    }
}
