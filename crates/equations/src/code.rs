//! Code of the chart (receptivities, conditions, bodies) as statements and total
//! expressions.
//!
//! An operation that can have no value is asked about first, and ends the scan with a fault.
//! RETURN and EXIT become flags and the loop's own exit.

use std::collections::HashMap;

use g7_compile::tree::{self, ExprKind, Gate, Piece, StmtKind};
use g7_engine::{Addr, Arith, Block, Builtin, Cmp, Code, FaultKind, Service, StepId};
use g7_model::{Span, Type};

use crate::fb;
use crate::form::{Class, Expr, MemoryId, Stmt, What};
use crate::make::{Make, lower};

/// Which memories stand in for others while the actions of one pass all read the
/// values from before it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stand {
    /// By memory written: its copy, and the flag that the copy was written.
    pub(crate) own: HashMap<MemoryId, (MemoryId, MemoryId)>,
}

/// One piece of code in translation.
pub(crate) struct Body<'m, 'a> {
    pub(crate) m: &'m mut Make<'a>,
    pub(crate) out: Vec<Stmt>,
    stand: Option<Stand>,
    /// The flag of the body round this point that RETURN leaves.
    returned: Vec<Option<MemoryId>>,
}

/// How control can go on behind a statement.
#[derive(Clone, Copy, Default)]
struct Ways {
    /// RETURN was perhaps reached.
    returns: bool,
}

impl<'a> Make<'a> {
    /// The value of code: statements, then an expression.
    pub(crate) fn value(&mut self, code: Code) -> (Vec<Stmt>, Expr) {
        self.value_in(code, None)
    }

    fn value_in(&mut self, code: Code, stand: Option<Stand>) -> (Vec<Stmt>, Expr) {
        let Some(Piece::Value(e)) = self.piece(code) else { return (Vec::new(), Expr::truth(true)) };
        let mut b = Body { m: self, out: Vec::new(), stand, returned: Vec::new() };
        let value = b.expr(e);
        (b.out, value)
    }

    /// A condition; an empty one holds.
    pub(crate) fn condition(&mut self, code: Code) -> (Vec<Stmt>, Expr) {
        self.value(code)
    }

    /// The statements of code.
    pub(crate) fn work(&mut self, code: Code) -> Vec<Stmt> {
        self.work_in(code, None)
    }

    pub(crate) fn work_in(&mut self, code: Code, stand: Option<Stand>) -> Vec<Stmt> {
        let Some(Piece::Work(list)) = self.piece(code) else { return Vec::new() };
        let mut b = Body { m: self, out: Vec::new(), stand, returned: Vec::new() };
        b.body(list);
        b.out
    }

    /// An action where it runs: its condition and its period are asked for.
    pub(crate) fn run(&mut self, action: u32) -> Vec<Stmt> {
        let Some(a) = self.t.actions.get(action as usize).copied() else { return Vec::new() };
        let due = self.due(a.period);
        let (mut list, condition) = self.condition(a.condition);
        let mut work = self.note_run(action);
        work.extend(self.work(a.body));
        list.extend(Stmt::when(condition, work));
        Stmt::when(due, list)
    }

    /// Notes that an action runs, where that is asked for.
    pub(crate) fn note_run(&mut self, action: u32) -> Vec<Stmt> {
        if !self.options.runs {
            return Vec::new();
        }
        vec![Stmt::Set(self.flag(What::Ran(action)), Expr::truth(true))]
    }

    /// The lasting memories that code writes, in the order of their rows.
    pub(crate) fn written(&mut self, code: Code) -> Vec<MemoryId> {
        let list: &[tree::Stmt] = match self.piece(code) {
            Some(Piece::Work(list)) => list,
            Some(Piece::Value(_)) | None => &[],
        };
        let mut b = Body { m: self, out: Vec::new(), stand: None, returned: Vec::new() };
        b.body(list);
        let out = b.out;
        let mut found = Vec::new();
        for s in &out {
            s.visit(&mut |s| match s {
                Stmt::Set(m, _) | Stmt::SetElement(m, _, _) => found.push(*m),
                Stmt::Call(block, list) => found.extend(fb::written(*block, list)),
                _ => {}
            });
        }
        let lasts = |m: &MemoryId| {
            self.of(*m).is_some_and(|m| {
                matches!(m.class, Class::Output | Class::Kept | Class::Input)
                    && matches!(m.what, What::Variable(_) | What::BlockClock(_))
            })
        };
        found.retain(lasts);
        found.sort_unstable();
        found.dedup();
        found
    }
}

impl Body<'_, '_> {
    pub(crate) fn fault(&mut self, when: Expr, kind: FaultKind, at: Span) {
        self.out.extend(Stmt::when(when, vec![Stmt::Fault(kind, at)]));
    }

    /// A value that can be named more than once.
    pub(crate) fn simple(&mut self, e: Expr, ty: Type) -> Expr {
        match e {
            Expr::Const(..) | Expr::Text(_) | Expr::Read(_) => e,
            e => self.keep(e, ty),
        }
    }

    fn keep(&mut self, e: Expr, ty: Type) -> Expr {
        let to = self.m.temporary(ty);
        self.out.push(Stmt::Set(to, e));
        Expr::Read(to)
    }

    /// The operands of one operation. Where a later one needs statements that
    /// write, what stands before it is put aside.
    fn operands(&mut self, list: &[&tree::Expr]) -> Vec<Expr> {
        let mut ready: Vec<Expr> = Vec::with_capacity(list.len());
        for e in list {
            let before = self.out.len();
            let value = self.expr(e);
            let mut writes = false;
            for s in self.out.get(before..).unwrap_or_default() {
                s.visit(&mut |s| writes |= self.is_write(s));
            }
            if writes {
                let behind = self.out.split_off(before);
                for (old, source) in ready.iter_mut().zip(list) {
                    if !matches!(old, Expr::Const(..) | Expr::Text(_)) {
                        let e = std::mem::replace(old, Expr::truth(false));
                        *old = self.keep(e, source.ty());
                    }
                }
                self.out.extend(behind);
            }
            ready.push(value);
        }
        ready
    }

    fn is_write(&self, s: &Stmt) -> bool {
        match s {
            Stmt::Set(m, _) => {
                self.m.of(*m).is_some_and(|m| !matches!(m.what, What::Temporary(_) | What::Work))
            }
            Stmt::SetElement(..) | Stmt::Call(..) => true,
            Stmt::If(..) | Stmt::Loop(_) | Stmt::Exit | Stmt::Fault(..) | Stmt::About(_) => false,
        }
    }

    pub(crate) fn read(&mut self, ty: Type, addr: Addr) -> Expr {
        let (memory, place) = self.m.word(addr, ty);
        let memory = self.standing(memory);
        match place {
            Some(i) => Expr::Element(memory, Box::new(Expr::long(i.into()))),
            None => Expr::Read(memory),
        }
    }

    fn standing(&self, memory: MemoryId) -> MemoryId {
        self.stand.as_ref().and_then(|s| s.own.get(&memory)).map_or(memory, |o| o.0)
    }

    pub(crate) fn expr(&mut self, e: &tree::Expr) -> Expr {
        let at = e.at;
        match &e.kind {
            ExprKind::Const(ty, v) => Expr::Const(*ty, *v),
            ExprKind::Text(addr, cap) => match self.m.text(*addr, *cap) {
                Ok(memory) => Expr::Read(self.standing(memory)),
                Err(text) => Expr::Text(text),
            },
            ExprKind::Word(ty, addr) => self.read(*ty, *addr),
            ExprKind::Element { ty, base, len, index } => {
                let index = self.expr(index);
                let index = self.within(index, *len, at);
                let (memory, place) = self.m.word(*base, *ty);
                let memory = self.standing(memory);
                match place {
                    Some(_) => Expr::Element(memory, Box::new(index)),
                    None if *len == 1 => Expr::Read(memory),
                    None => self.choice(*ty, *base, *len, &index),
                }
            }
            ExprKind::Active(step) => self.m.active(step.0),
            ExprKind::WasActive(step) => Expr::Read(self.m.flag(What::Was(*step))),
            ExprKind::GroupActive(group) => self.m.group_active(*group),
            ExprKind::Time(clock) => self.m.clock(*clock),
            ExprKind::Tenths(step) => self.m.tenths(*step),
            ExprKind::Rise(w) => Expr::Read(self.m.flag_of_watch(What::Rise(*w), *w)),
            ExprKind::Fall(w) => Expr::Read(self.m.flag_of_watch(What::Fall(*w), *w)),
            ExprKind::Timer(w) => Expr::Read(self.m.kept(What::Timer(*w))),
            ExprKind::Due(period) => self.m.due(*period),
            ExprKind::Not(x) => self.expr(x).negated(),
            ExprKind::Gate(gate, a, b) => self.gate(*gate, a, b),
            ExprKind::Neg(ty, x) => {
                let x = self.expr(x);
                let x = self.simple(x, *ty);
                self.checked(Expr::Neg(*ty, Box::new(x)), !ty.is_real(), FaultKind::Overflow, at)
            }
            ExprKind::Arith(op, ty, a, b) => self.arith(*op, *ty, [a, b], at),
            ExprKind::Compare(c, ty, a, b) => {
                let mut v = self.operands(&[a, b]).into_iter();
                let (Some(a), Some(b)) = (v.next(), v.next()) else { return Expr::truth(false) };
                a.compare(*c, *ty, b)
            }
            ExprKind::CompareText(c, a, b) => {
                let ty = a.ty();
                let mut v = self.operands(&[a, b]).into_iter();
                let (Some(a), Some(b)) = (v.next(), v.next()) else { return Expr::truth(false) };
                a.compare(*c, ty, b)
            }
            ExprKind::Convert(from, to, x) => {
                let x = self.expr(x);
                let fails = tree::narrows(*from, *to);
                let x = if fails { self.simple(x, *from) } else { x };
                self.checked(Expr::Convert(*from, *to, Box::new(x)), fails, FaultKind::Overflow, at)
            }
            ExprKind::Trunc(from, to, x) => {
                let x = self.expr(x);
                let x = self.simple(x, *from);
                self.checked(Expr::Trunc(*from, *to, Box::new(x)), true, FaultKind::Overflow, at)
            }
            ExprKind::Call(f, ty, args) => self.call(*f, *ty, args, at),
            ExprKind::TextCall { function, args, cap, .. } => self.text_call(*function, args, *cap, at),
            ExprKind::ToText { from, cap, value, .. } => {
                let value = self.expr(value);
                Expr::Convert(*from, Type::String(*cap), Box::new(value))
            }
            ExprKind::FromText(ty, x) => {
                let from = x.ty();
                let x = self.expr(x);
                let x = self.simple(x, from);
                self.checked(Expr::Convert(from, *ty, Box::new(x)), true, FaultKind::Range, at)
            }
            ExprKind::ScanTime => Expr::Read(self.m.scan_time()),
            ExprKind::Random(addr) => {
                let (seed, _) = self.m.word(*addr, Type::Ulint);
                let next = Expr::Read(seed).arith(
                    Arith::Add,
                    Type::Ulint,
                    Expr::Const(Type::Ulint, g7_engine::number::RANDOM_STEP),
                );
                self.out.push(Stmt::Set(seed, next));
                let value = Expr::Random(Box::new(Expr::Read(seed)));
                self.keep(value, Type::Lreal)
            }
            ExprKind::After(list, value) => {
                self.body(list);
                self.expr(value)
            }
        }
    }

    /// The expression, behind a question whether it has a value.
    fn checked(&mut self, e: Expr, fails: bool, kind: FaultKind, at: Span) -> Expr {
        if fails {
            self.fault(e.clone().fails(), kind, at);
        }
        e
    }

    /// An index that lies within a table.
    fn gate(&mut self, gate: Gate, a: &tree::Expr, b: &tree::Expr) -> Expr {
        if gate == Gate::Xor {
            let mut v = self.operands(&[a, b]).into_iter();
            let (Some(a), Some(b)) = (v.next(), v.next()) else { return Expr::truth(false) };
            return a.xor(b);
        }
        let left = self.expr(a);
        let before = self.out.len();
        let right = self.expr(b);
        let behind = self.out.split_off(before);
        if behind.is_empty() {
            return if gate == Gate::And { left.and(right) } else { left.or(right) };
        }
        // The right operand is evaluated only where the left one does not decide.
        let to = self.m.temporary(Type::Bool);
        self.out.push(Stmt::Set(to, left));
        let decides = if gate == Gate::And { Expr::Read(to) } else { Expr::Read(to).negated() };
        let mut then = behind;
        then.push(Stmt::Set(to, right));
        self.out.push(Stmt::If(decides, then, Vec::new()));
        Expr::Read(to)
    }

    fn arith(&mut self, op: Arith, ty: Type, parts: [&tree::Expr; 2], at: Span) -> Expr {
        let values = self.operands(&parts);
        let mut v = values.into_iter();
        let (Some(a), Some(b)) = (v.next(), v.next()) else { return Expr::Const(ty, 0) };
        let divides = matches!(op, Arith::Div | Arith::Mod);
        if ty.is_real() && !divides {
            return a.arith(op, ty, b);
        }
        let (a, b) = (self.simple(a, ty), self.simple(b, ty));
        if divides && !matches!(b, Expr::Const(_, v) if v != 0 && v != (-0.0f64).to_bits()) {
            let zero = b.clone().compare(Cmp::Eq, ty, Expr::Const(ty, 0));
            self.fault(zero, FaultKind::DivisionByZero, at);
        }
        let e = a.arith(op, ty, b);
        let overflows = !ty.is_real()
            && match &e {
                Expr::Arith(Arith::Div, _, _, b) => {
                    matches!(**b, Expr::Const(_, u64::MAX)) || !matches!(**b, Expr::Const(..))
                }
                Expr::Arith(Arith::Mod, ..) => false,
                _ => true,
            };
        self.checked(e, overflows, FaultKind::Overflow, at)
    }

    fn call(&mut self, f: Builtin, ty: Type, args: &[tree::Expr], at: Span) -> Expr {
        let list: Vec<&tree::Expr> = args.iter().collect();
        let mut values = self.operands(&list);
        if let Some(k) = values.first_mut().filter(|_| f == Builtin::Mux) {
            let selector = std::mem::replace(k, Expr::truth(false));
            *k = self.within(selector, args.len().saturating_sub(1) as u32, at);
        }
        if let Some(n) = values.last_mut().filter(|_| f.shifts()) {
            let negative = self.negative(n, Type::Lint);
            self.fault(negative, FaultKind::Range, at);
        }
        let fails = f == Builtin::Abs && !ty.is_real();
        if fails && let Some(x) = values.first_mut() {
            let e = std::mem::replace(x, Expr::truth(false));
            *x = self.simple(e, ty);
        }
        self.checked(Expr::Call(f, ty, values), fails, FaultKind::Overflow, at)
    }

    /// A count is below 0; then it is named more than once.
    fn negative(&mut self, count: &mut Expr, ty: Type) -> Expr {
        let e = std::mem::replace(count, Expr::truth(false));
        *count = self.simple(e, ty);
        count.clone().compare(Cmp::Lt, ty, Expr::Const(ty, 0))
    }

    fn text_call(&mut self, f: Builtin, args: &[tree::Expr], cap: u16, at: Span) -> Expr {
        let list: Vec<&tree::Expr> = args.iter().collect();
        let mut values = self.operands(&list);
        let mut negative = Vec::new();
        for (value, arg) in values.iter_mut().zip(args) {
            if !matches!(arg.ty(), Type::String(_)) {
                negative.push(self.negative(value, arg.ty()));
            }
        }
        self.fault(Expr::any(negative), FaultKind::Range, at);
        let ty = match f {
            Builtin::Len | Builtin::Find => Type::Int,
            _ => Type::String(cap),
        };
        Expr::Call(f, ty, values)
    }

    /// The statements of a body; what stands behind a RETURN that may have been
    /// reached runs only where it was not.
    fn body(&mut self, list: &[tree::Stmt]) {
        self.scope(list);
    }

    fn stmts(&mut self, list: &[tree::Stmt]) -> Ways {
        let mut ways = Ways::default();
        for (i, s) in list.iter().enumerate() {
            let w = self.stmt(s);
            ways.returns |= w.returns;
            if w.returns {
                let rest = list.get(i + 1..).unwrap_or_default();
                if !rest.is_empty()
                    && let Some(Some(flag)) = self.returned.last().copied()
                {
                    let outer = std::mem::take(&mut self.out);
                    self.stmts(rest);
                    let then = std::mem::replace(&mut self.out, outer);
                    self.out.extend(Stmt::when(Expr::Read(flag).negated(), then));
                }
                break;
            }
        }
        ways
    }

    /// Statements on their own, and how control goes on behind them.
    fn inner(&mut self, list: &[tree::Stmt]) -> (Vec<Stmt>, Ways) {
        let outer = std::mem::take(&mut self.out);
        let ways = self.stmts(list);
        (std::mem::replace(&mut self.out, outer), ways)
    }

    fn return_flag(&mut self) -> MemoryId {
        if let Some(Some(flag)) = self.returned.last() {
            return *flag;
        }
        self.m.returns += 1;
        let flag = self.m.flag(What::Returned(self.m.returns));
        if let Some(slot) = self.returned.last_mut() {
            *slot = Some(flag);
        }
        flag
    }

    fn stmt(&mut self, s: &tree::Stmt) -> Ways {
        let none = Ways::default();
        match &s.kind {
            StmtKind::Store(ty, tree::Target::Word(addr), e) => {
                let value = self.expr(e);
                let (memory, place) = self.m.word(*addr, *ty);
                self.store(memory, place.map(|i| Expr::long(i.into())), value);
            }
            StmtKind::Store(ty, tree::Target::Element(base, len, index), e) => {
                let index_ = self.expr(index);
                let index_ = self.simple(index_, Type::Lint);
                let value = self.expr(e);
                let index = self.within(index_, *len, s.at);
                let (memory, place) = self.m.word(*base, *ty);
                if place.is_some() || *len == 1 {
                    self.store(memory, place.map(|_| index), value);
                } else {
                    self.store_chosen(*ty, *base, *len, index, value);
                }
            }
            StmtKind::StoreText(addr, cap, e) => {
                let value = self.expr(e);
                if let Ok(memory) = self.m.text(*addr, *cap) {
                    self.store(memory, None, value);
                }
            }
            StmtKind::Evaluate(tree::Expr { kind: ExprKind::Element { len, index, .. }, at }) => {
                let index = self.expr(index);
                self.within(index, *len, *at);
            }
            StmtKind::Evaluate(e) => {
                self.expr(e);
            }
            StmtKind::If(arms, other) => return self.alternatives(arms, other),
            StmtKind::Loop(body, until) => return self.repeat(body, until.as_ref(), s.at),
            StmtKind::LeaveUnless(e) => {
                let stays = self.expr(e);
                self.out.extend(Stmt::when(stays.negated(), vec![Stmt::Exit]));
            }
            StmtKind::Leave => self.out.push(Stmt::Exit),
            StmtKind::Body(list) => self.scope(list),
            StmtKind::Return => {
                let flag = self.return_flag();
                self.out.push(Stmt::Set(flag, Expr::truth(true)));
                return Ways { returns: true };
            }
            StmtKind::Fb(block, base) => self.block(*block, *base),
            StmtKind::Service(service) => self.service(*service),
        }
        none
    }

    /// Statements that RETURN leaves.
    fn scope(&mut self, list: &[tree::Stmt]) {
        self.returned.push(None);
        let (inner, _) = self.inner(list);
        if let Some(Some(flag)) = self.returned.pop() {
            self.out.push(lower(flag));
        }
        self.out.extend(inner);
    }

    pub(crate) fn store(&mut self, memory: MemoryId, index: Option<Expr>, value: Expr) {
        let noted = self.stand.as_ref().and_then(|s| s.own.get(&memory)).copied();
        let to = noted.map_or(memory, |o| o.0);
        self.out.push(match index {
            Some(i) => Stmt::SetElement(to, i, value),
            None => Stmt::Set(to, value),
        });
        if let Some((_, wrote)) = noted {
            self.out.push(Stmt::Set(wrote, Expr::truth(true)));
        }
    }

    fn alternatives(&mut self, arms: &[(tree::Expr, Vec<tree::Stmt>)], other: &[tree::Stmt]) -> Ways {
        let Some(((condition, then), rest)) = arms.split_first() else { return self.stmts(other) };
        let condition = self.expr(condition);
        let (then, a) = self.inner(then);
        let outer = std::mem::take(&mut self.out);
        let b = self.alternatives(rest, other);
        let otherwise = std::mem::replace(&mut self.out, outer);
        match condition.known() {
            Some(true) => self.out.extend(then),
            Some(false) => self.out.extend(otherwise),
            None => self.out.push(Stmt::If(condition, then, otherwise)),
        }
        Ways { returns: a.returns || b.returns }
    }

    fn repeat(&mut self, body: &[tree::Stmt], until: Option<&tree::Expr>, at: Span) -> Ways {
        let outer = std::mem::take(&mut self.out);
        let ways = self.stmts(body);
        let flag = self.returned.last().copied().flatten().filter(|_| ways.returns);
        let leave = |e: Expr| Stmt::when(e, vec![Stmt::Exit]);
        self.out.extend(flag.into_iter().flat_map(|f| leave(Expr::Read(f))));
        if let Some(e) = until {
            let done = self.expr(e);
            self.out.extend(leave(done));
        }
        let work = self.m.memory(What::Work, Class::Scratch, Type::Dint);
        let one = Expr::Const(Type::Dint, 1);
        self.out.push(Stmt::Set(work, Expr::Read(work).arith(Arith::Add, Type::Dint, one)));
        let most = Expr::Const(Type::Dint, u64::from(g7_engine::WORK));
        self.fault(Expr::Read(work).compare(Cmp::Gt, Type::Dint, most), FaultKind::Work, at);
        let list = std::mem::replace(&mut self.out, outer);
        self.out.push(Stmt::Loop(list));
        ways
    }

    fn block(&mut self, block: Block, base: Addr) {
        let memories = self.m.instance(block, base);
        if let Some(stand) = &self.stand {
            let notes: Vec<Stmt> = fb::written(block, &memories)
                .iter()
                .filter_map(|m| stand.own.get(m))
                .map(|(_, wrote)| Stmt::Set(*wrote, Expr::truth(true)))
                .collect();
            let own = memories.iter().map(|m| self.standing(*m)).collect();
            self.out.push(Stmt::Call(block, own));
            self.out.extend(notes);
            return;
        }
        self.out.push(Stmt::Call(block, memories));
    }

    fn service(&mut self, service: Service) {
        let what = match service {
            Service::Start => What::RequestStart,
            Service::Init(g) => What::RequestInit(g),
            Service::Clear(g) => What::RequestClear(g),
            Service::Set(s) => What::RequestSet(s),
            Service::Reset(s) => What::RequestReset(s),
            Service::ResetTimes => return self.out.extend(self.m.reset_times()),
        };
        let flag = self.m.kept(what);
        self.out.push(Stmt::Set(flag, Expr::truth(true)));
        // It takes back what was asked for the same steps before.
        let back: Vec<What> = match service {
            Service::Init(g) | Service::Clear(g) => {
                self.m.group_steps(g).map(|s| What::RequestSet(StepId(s))).collect()
            }
            Service::Set(step) => vec![What::RequestReset(step)],
            Service::Reset(step) => vec![What::RequestSet(step)],
            Service::Start | Service::ResetTimes => Vec::new(),
        };
        let back = back.into_iter().filter_map(|what| self.m.known(what));
        self.out.extend(back.map(lower));
    }
}
