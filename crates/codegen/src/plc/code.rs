//! The engine's code as expressions and statements. Its jumps come from IF,
//! CASE and loops; they become those again.

mod arith;

use std::collections::BTreeMap;

use g7_engine::{Addr, Arith, Builtin, Cmp, Code, Num, Op};

use super::form::{Ex, St};
use super::plan::Plan;
use super::vars::{Shape, Ty, members};

/// What is known of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// A constant that takes the type that is wanted.
    Word(u64),
    /// A word without a declaration.
    Hidden(u32),
    Of(Ty),
    /// A step's time in tenths of a second; the expression is the TIME.
    Tenths,
}

#[derive(Clone, Debug)]
struct Value {
    e: Ex,
    kind: Kind,
}

/// Code in translation.
struct Body<'p, 'a> {
    p: &'p mut Plan<'a>,
    stack: Vec<Value>,
    out: Vec<St>,
    loops: BTreeMap<u32, u32>,
    open: Vec<(u32, u32)>,
    at: u32,
}

impl<'a> Plan<'a> {
    /// Code that leaves a BOOL.
    pub(crate) fn condition(&mut self, code: Code) -> Ex {
        if code.is_empty() {
            return Ex::Bool(true);
        }
        self.value(code, Ty::BOOL)
    }

    /// Code that leaves a value and does nothing else.
    pub(crate) fn value(&mut self, code: Code, ty: Ty) -> Ex {
        let (before, e) = self.value_behind(code, ty);
        if !before.is_empty() {
            self.cannot(code.start, "an expression that does something besides");
        }
        e
    }

    /// Statements, and the value that they prepare.
    pub(crate) fn value_behind(&mut self, code: Code, ty: Ty) -> (Vec<St>, Ex) {
        let mut b = Body::new(self, code);
        b.block(code.start, code.end);
        let value = b.pop();
        let e = b.as_ty(&value, ty);
        (b.out, e)
    }

    /// Code that leaves nothing.
    pub(crate) fn body(&mut self, code: Code) -> Vec<St> {
        let mut b = Body::new(self, code);
        b.block(code.start, code.end);
        b.out
    }
}

impl<'p, 'a> Body<'p, 'a> {
    fn new(p: &'p mut Plan<'a>, code: Code) -> Body<'p, 'a> {
        let mut loops = BTreeMap::new();
        for at in code.start..code.end {
            if let Some(Op::Jump(to) | Op::JumpUnless(to)) = p.t.code.get(at as usize)
                && *to <= at
            {
                loops.insert(*to, at);
            }
        }
        Body { p, stack: Vec::new(), out: Vec::new(), loops, open: Vec::new(), at: code.start }
    }

    fn cannot(&mut self, what: &str) {
        self.p.cannot(self.at, what);
    }

    fn op(&self, at: u32) -> Option<Op> {
        self.p.t.code.get(at as usize).copied()
    }

    fn pop(&mut self) -> Value {
        self.stack.pop().unwrap_or(Value { e: Ex::Bool(false), kind: Kind::Word(0) })
    }

    fn push(&mut self, e: Ex, ty: Ty) {
        self.stack.push(Value { e, kind: Kind::Of(ty) });
    }

    fn as_ty(&mut self, v: &Value, ty: Ty) -> Ex {
        match v.kind {
            Kind::Word(w) => ty.literal(w),
            Kind::Hidden(addr) => {
                let have = *self.p.hidden.entry(addr).or_insert(ty);
                self.converted(v.e.clone(), have, ty)
            }
            Kind::Of(have) => self.converted(v.e.clone(), have, ty),
            Kind::Tenths => {
                self.cannot("the time of a step in tenths of a second, other than compared with a number,");
                v.e.clone()
            }
        }
    }

    fn converted(&mut self, e: Ex, from: Ty, to: Ty) -> Ex {
        if from == to {
            return e;
        }
        if from.time || to.time {
            self.cannot("a TIME taken as a number");
            return e;
        }
        let e = match e {
            Ex::Int(n) if !real(to.num) && to.num != Num::Bool => return Ex::Int(n),
            other => other,
        };
        if from.num == Num::Bool {
            // Not every system has conversions of BOOL to all types.
            let one = if real(to.num) { (Ex::Real(0.0), Ex::Real(1.0)) } else { (Ex::Int(0), Ex::Int(1)) };
            return Ex::call(format!("BOOL_TO_{}", to.name()), vec![e]).known(one);
        }
        Ex::call(format!("{}_TO_{}", from.name(), to.name()), vec![e])
    }

    /// The type in which two values meet.
    fn meet(&mut self, a: &Value, b: &Value, num: Num) -> Ty {
        let ty = |v: &Value, p: &Plan<'_>| match v.kind {
            Kind::Of(ty) => Some(ty),
            Kind::Hidden(addr) => p.hidden.get(&addr).copied(),
            Kind::Word(_) | Kind::Tenths => None,
        };
        match (ty(a, self.p), ty(b, self.p)) {
            (Some(x), Some(y)) if x == y => x,
            (Some(x), None) | (None, Some(x)) => x,
            _ => Ty::of(num),
        }
    }

    fn block(&mut self, from: u32, end: u32) {
        let mut at = from;
        while at < end {
            at = self.step(at, end);
        }
    }

    /// Statements of a part, apart from what is there.
    fn part(&mut self, from: u32, end: u32) -> Vec<St> {
        let outer = std::mem::take(&mut self.out);
        self.block(from, end);
        std::mem::replace(&mut self.out, outer)
    }

    fn step(&mut self, at: u32, end: u32) -> u32 {
        self.at = at;
        if let Some(&latch) = self.loops.get(&at)
            && latch < end
            && self.open.iter().all(|(head, _)| *head != at)
        {
            self.spill(|_| true);
            self.open.push((at, latch + 1));
            let mut body = self.part(at, latch);
            if let Some(Op::JumpUnless(_)) = self.op(latch) {
                let v = self.pop();
                let c = self.as_ty(&v, Ty::BOOL);
                body.push(St::If(c, vec![St::Exit], Vec::new()));
            }
            self.open.pop();
            self.out.push(St::Loop(body));
            return latch + 1;
        }
        match self.op(at) {
            Some(Op::JumpUnless(to)) => self.branch(at, to, end),
            Some(Op::Jump(to)) => {
                if self.open.last().is_some_and(|(_, exit)| to == *exit) {
                    self.out.push(St::Exit);
                } else if to != end {
                    self.cannot("a RETURN, or an EXIT of a loop round another one, from within");
                }
                end
            }
            Some(Op::Return) => {
                self.cannot("a RETURN from within");
                end
            }
            Some(op) => {
                self.plain(op);
                at + 1
            }
            None => end,
        }
    }

    fn branch(&mut self, at: u32, to: u32, end: u32) -> u32 {
        let v = self.pop();
        let c = self.as_ty(&v, Ty::BOOL);
        if let Some((_, exit)) = self.open.last()
            && to == *exit
            && to > end
        {
            self.out.push(St::If(c.not(), vec![St::Exit], Vec::new()));
            return at + 1;
        }
        if self.open.last().is_some_and(|(_, exit)| to == *exit) {
            // Out of the loop, at its end.
            self.spill(|_| true);
            self.out.push(St::If(c.not(), vec![St::Exit], Vec::new()));
            return at + 1;
        }
        if to > end {
            self.cannot("a RETURN, or an EXIT of a loop round another one, from within");
            return end;
        }
        let other = match self.op(to.wrapping_sub(1)) {
            // One to the place behind itself leads past nothing.
            Some(Op::Jump(u)) if to > at + 1 && u > to && u <= end => Some(u),
            _ => None,
        };
        let next = other.unwrap_or(to);
        let then_end = if other.is_some() { to - 1 } else { to };
        let below = std::mem::take(&mut self.stack);
        let mut then = self.part(at + 1, then_end);
        let one = self.stack.pop();
        self.stack.clear();
        let (mut otherwise, mut two) = (Vec::new(), None);
        if other.is_some() {
            otherwise = self.part(to, next);
            two = self.stack.pop();
        }
        self.stack = below;
        match (one, two) {
            (Some(a), Some(b)) => {
                let ty = match (a.kind, b.kind) {
                    (Kind::Of(ty), _) | (_, Kind::Of(ty)) => ty,
                    _ => Ty::BOOL,
                };
                let (x, y) = (self.as_ty(&a, ty), self.as_ty(&b, ty));
                // What divides is worked out only where it is wanted.
                let both = then.is_empty() && otherwise.is_empty();
                if both && !x.divides() && !y.divides() {
                    let e = match (&x, &y) {
                        (_, Ex::Bool(false)) => c.and(x),
                        _ => Ex::call("SEL", vec![c, y, x]),
                    };
                    self.push(e, ty);
                } else {
                    self.spill(|_| true);
                    let name = self.p.memory("Z", "", ty, "");
                    then.push(St::set(name.clone(), x));
                    otherwise.push(St::set(name.clone(), y));
                    self.out.push(St::If(c, then, otherwise));
                    self.push(Ex::Var(name), ty);
                }
            }
            _ if then.is_empty() && otherwise.is_empty() => {}
            _ => {
                self.spill(|_| true);
                let (c, then, otherwise) =
                    if then.is_empty() { (c.not(), otherwise, then) } else { (c, then, otherwise) };
                self.out.push(St::If(c, then, otherwise));
            }
        }
        next
    }

    /// Values that wait on the stack keep what they were.
    fn spill(&mut self, which: impl Fn(&Ex) -> bool) {
        for i in 0..self.stack.len() {
            let Some(v) = self.stack.get(i).cloned() else { break };
            let Kind::Of(ty) = v.kind else { continue };
            let constant = matches!(v.e, Ex::Bool(_) | Ex::Int(_) | Ex::Real(_) | Ex::Time(_));
            if constant || !which(&v.e) {
                continue;
            }
            let name = self.p.memory("Z", "", ty, "");
            self.out.push(St::set(name.clone(), v.e));
            if let Some(slot) = self.stack.get_mut(i) {
                slot.e = Ex::Var(name);
            }
        }
    }

    fn place(&mut self, addr: u32) -> Option<(Ex, Option<Ty>)> {
        let Some(slot) = self.p.vars.slot(addr).cloned() else {
            let name = self.p.hidden_name(addr);
            return Some((Ex::Var(name), None));
        };
        let at = addr - slot.start;
        Some(match slot.shape {
            Shape::One(ty) => (Ex::Var(slot.name), Some(ty)),
            Shape::Many(ty, _) => (Ex::Index(slot.name, Box::new(Ex::Int(at.into()))), Some(ty)),
            Shape::Fb(kind) => match members(kind).get(at as usize) {
                Some((member, ty)) => (Ex::Var(format!("{}.{member}", slot.name)), Some(*ty)),
                None => return None,
            },
            Shape::Text => {
                self.cannot("a text");
                return None;
            }
        })
    }

    fn store(&mut self, addr: Addr) {
        let v = self.pop();
        let Some((place, ty)) = self.place(addr.0) else { return };
        let ty = ty.or_else(|| match v.kind {
            Kind::Of(ty) => Some(*self.p.hidden.entry(addr.0).or_insert(ty)),
            _ => self.p.hidden.get(&addr.0).copied(),
        });
        let e = self.as_ty(&v, ty.unwrap_or(Ty::LINT));
        let name = match &place {
            Ex::Var(n) | Ex::Index(n, _) => n.clone(),
            _ => String::new(),
        };
        self.spill(|e| e.reads(&name));
        self.out.push(St::Assign(place, e));
    }

    fn plain(&mut self, op: Op) {
        match op {
            Op::Push(w) => self.stack.push(Value { e: Ex::Bool(false), kind: Kind::Word(w) }),
            Op::Load(a) => match self.place(a.0) {
                Some((e, Some(ty))) => self.push(e, ty),
                Some((e, None)) => self.stack.push(Value { e, kind: Kind::Hidden(a.0) }),
                None => self.stack.push(Value { e: Ex::Bool(false), kind: Kind::Word(0) }),
            },
            Op::Store(a) => self.store(a),
            Op::LoadAt { base, .. } => {
                let i = self.index();
                match self.p.vars.slot(base.0).map(|s| (s.name.clone(), s.shape.clone())) {
                    Some((name, Shape::Many(ty, _))) => self.push(Ex::Index(name, Box::new(i)), ty),
                    Some((name, Shape::One(ty))) => self.push(Ex::Var(name), ty),
                    _ => self.cannot("a table of texts"),
                }
            }
            Op::StoreAt { base, .. } => {
                let v = self.pop();
                let i = self.index();
                match self.p.vars.slot(base.0).map(|s| (s.name.clone(), s.shape.clone())) {
                    Some((name, Shape::Many(ty, _))) => {
                        let e = self.as_ty(&v, ty);
                        self.spill(|e| e.reads(&name));
                        self.out.push(St::Assign(Ex::Index(name, Box::new(i)), e));
                    }
                    Some((name, Shape::One(ty))) => {
                        let e = self.as_ty(&v, ty);
                        self.out.push(St::set(name, e));
                    }
                    _ => self.cannot("a table of texts"),
                }
            }
            Op::Active(step) => {
                let e = Ex::Var(self.p.step(step));
                self.push(e, Ty::BOOL);
            }
            Op::WasActive(step) => {
                let e = self.p.was(step);
                self.push(e, Ty::BOOL);
            }
            Op::GroupActive(g) => {
                let e = self.p.group_active(g);
                self.push(e, Ty::BOOL);
            }
            Op::StepTime(step) if self.p.t.rules.scan_clock => {
                let e = self.p.step_scans(step);
                self.push(e, Ty::LINT);
            }
            Op::StepTime(step) | Op::StepAge(step) => {
                let e = self.p.step_time(step);
                self.push(e, Ty::TIME);
            }
            Op::StepTenths(step) => {
                let e = self.p.step_time(step);
                self.stack.push(Value { e, kind: Kind::Tenths });
            }
            Op::GroupTime(g) | Op::GroupAge(g) => {
                let scans = self.p.t.rules.scan_clock && matches!(op, Op::GroupTime(_));
                if self.p.t.rules.sequential || scans {
                    self.cannot("the time of a macro-step under transitions that clear in turn");
                }
                let e = self.p.group_time(g);
                self.push(e, Ty::TIME);
            }
            Op::Rise(w) => {
                let e = self.p.watch(w, 0);
                self.push(e, Ty::BOOL);
            }
            Op::Fall(w) => {
                let e = self.p.watch(w, 1);
                self.push(e, Ty::BOOL);
            }
            Op::Timer(w) => {
                let e = self.p.watch(w, 2);
                self.push(e, Ty::BOOL);
            }
            Op::ScanTime => {
                let e = self.p.scan_time();
                self.push(e, Ty::TIME);
            }
            Op::Not => {
                let v = self.pop();
                let e = self.as_ty(&v, Ty::BOOL).not();
                self.push(e, Ty::BOOL);
            }
            Op::And | Op::Or | Op::Xor => {
                let (b, a) = (self.pop(), self.pop());
                let (x, y) = (self.as_ty(&a, Ty::BOOL), self.as_ty(&b, Ty::BOOL));
                let e = match op {
                    Op::And => x.and(y),
                    Op::Or => x.or(y),
                    _ => x.xor(y),
                };
                self.push(e, Ty::BOOL);
            }
            Op::Compare(c, n) => self.compare(c, n),
            Op::Neg(n) => {
                let v = self.pop();
                let ty = self.meet(&v, &v, n);
                let e = self.as_ty(&v, ty);
                if ty.time {
                    let zero = Ex::Time(0);
                    return self.push(Ex::op("-", zero, e), ty);
                }
                self.push(Ex::Neg(Box::new(e)), ty);
            }
            Op::Arith(op, n) => self.arith(op, n),
            Op::Convert(from, to) => self.convert(from, to),
            Op::Trunc(from, to) => {
                let v = self.pop();
                let e = self.as_ty(&v, Ty::of(from));
                self.push(Ex::call("TRUNC", vec![e]), Ty::of(to));
            }
            Op::Call(f, n, count) => self.call(f, n, usize::from(count)),
            Op::Fb(_, base) => self.instance(base),
            Op::Drop => {
                self.pop();
            }
            Op::Due(_) => self.cannot("a chart with a period of its own"),
            Op::Service(_) => self.cannot("a service that sets or clears steps"),
            Op::Random(_) => self.cannot("a random number"),
            Op::Text { .. }
            | Op::CompareText(_)
            | Op::StoreText { .. }
            | Op::ToText { .. }
            | Op::FromText(_) => {
                self.cannot("a text");
                if !matches!(op, Op::StoreText { .. }) {
                    self.push(Ex::Bool(false), Ty::BOOL);
                }
            }
            Op::Jump(_) | Op::JumpUnless(_) | Op::Return => {}
        }
    }

    fn index(&mut self) -> Ex {
        let v = self.pop();
        match v.kind {
            Kind::Of(_) => narrow(v.e),
            _ => self.as_ty(&v, Ty::LINT),
        }
    }
}

impl Ex {
    /// BOOL constants need no conversion.
    fn known(self, (zero, one): (Ex, Ex)) -> Ex {
        match &self {
            Ex::Call(_, args) if args[..] == [Ex::Bool(true)] => one,
            Ex::Call(_, args) if args[..] == [Ex::Bool(false)] => zero,
            _ => self,
        }
    }
}

/// A number that was only widened, as it was.
fn narrow(e: Ex) -> Ex {
    match e {
        Ex::Call(name, mut args) if name.ends_with("_TO_LINT") && args.len() == 1 => args.remove(0),
        other => other,
    }
}

fn real(n: Num) -> bool {
    matches!(n, Num::F32 | Num::F64)
}
