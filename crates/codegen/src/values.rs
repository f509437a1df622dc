//! The stack of the engine's code, as expressions.

use g7_engine::{Arith, Builtin, Cmp, Num, Op};

use crate::flow::Flow;
use crate::tree::{Bin, Expr, Stmt, Ty, Un};
use crate::vars::{self, Kind, Shape, literal};

/// A value that has been pushed and not yet used.
#[derive(Clone, Debug)]
pub(crate) enum Entry {
    /// Its kind shows where it is used.
    Word(u64),
    /// A word without a declaration.
    Hidden(u32, Expr),
    /// The one or the other, of a kind that shows where it is used.
    Choice(Expr, Box<Entry>, Box<Entry>),
    /// Anything else.
    Typed {
        e: Expr,
        kind: Kind,
        /// It can end in a fault.
        fails: bool,
        /// It changes when something is written.
        reads: bool,
    },
}

impl Entry {
    pub(crate) fn of(e: Expr, n: Num) -> Entry {
        Entry::Typed { e, kind: Kind::Num(n), fails: false, reads: true }
    }

    pub(crate) fn fails(&self) -> bool {
        match self {
            Entry::Typed { fails, .. } => *fails,
            Entry::Choice(_, a, b) => a.fails() || b.fails(),
            Entry::Word(_) | Entry::Hidden(..) => false,
        }
    }

    fn reads(&self) -> bool {
        match self {
            Entry::Typed { reads, .. } => *reads,
            Entry::Word(_) => false,
            Entry::Hidden(..) | Entry::Choice(..) => true,
        }
    }
}

fn bin(c: Cmp) -> Bin {
    match c {
        Cmp::Eq => Bin::Eq,
        Cmp::Ne => Bin::Ne,
        Cmp::Lt => Bin::Lt,
        Cmp::Le => Bin::Le,
        Cmp::Gt => Bin::Gt,
        Cmp::Ge => Bin::Ge,
    }
}

pub(crate) fn is_real(n: Num) -> bool {
    matches!(n, Num::F32 | Num::F64)
}

fn signed(n: Num) -> bool {
    matches!(n, Num::I8 | Num::I16 | Num::I32 | Num::I64)
}

fn bits(n: Num) -> u8 {
    match n {
        Num::Bool => 1,
        Num::I8 | Num::U8 => 8,
        Num::I16 | Num::U16 => 16,
        Num::I32 | Num::U32 | Num::F32 => 32,
        Num::I64 | Num::U64 | Num::F64 => 64,
    }
}

/// Whether every value of one whole kind is one of another.
fn widens(from: Num, to: Num) -> bool {
    from == to
        || (!signed(from) && bits(from) < bits(to))
        || (signed(from) && signed(to) && bits(from) <= bits(to))
}

/// `i16`, as names of functions have it.
pub(crate) fn suffix(n: Num) -> &'static str {
    match n {
        Num::Bool => "bool",
        Num::I8 => "i8",
        Num::I16 => "i16",
        Num::I32 => "i32",
        Num::I64 => "i64",
        Num::U8 => "u8",
        Num::U16 => "u16",
        Num::U32 => "u32",
        Num::U64 => "u64",
        Num::F32 => "f32",
        Num::F64 => "f64",
    }
}

impl Flow<'_, '_> {
    pub(crate) fn pop(&mut self) -> Entry {
        self.stack.pop().unwrap_or(Entry::Word(0))
    }

    /// Pushes what can fail: what can fail and waits below comes first.
    fn push_failing(&mut self, e: Expr, kind: Kind) {
        if self.stack.iter().any(Entry::fails) {
            self.settle();
        }
        self.stack.push(Entry::Typed { e, kind, fails: true, reads: true });
    }

    fn push(&mut self, e: Expr, n: Num, operands: &[&Entry]) {
        let fails = operands.iter().any(|o| o.fails());
        let reads = operands.iter().any(|o| o.reads());
        self.stack.push(Entry::Typed { e, kind: Kind::Num(n), fails, reads });
    }

    /// Keeps what waits on the stack in names of its own, so that what comes
    /// cannot change it.
    pub(crate) fn settle(&mut self) {
        for k in 0..self.stack.len() {
            let Some(entry) = self.stack.get(k).filter(|e| e.reads() || e.fails()).cloned() else { continue };
            let kept = self.keep(entry);
            if let Some(slot) = self.stack.get_mut(k) {
                *slot = kept;
            }
        }
    }

    fn keep(&mut self, entry: Entry) -> Entry {
        match entry {
            Entry::Typed { e, kind: Kind::Num(n), .. } => {
                let name = self.temporary();
                self.out.push(Stmt::Let { mutable: false, name: name.clone(), ty: vars::ty(n), value: e });
                Entry::Typed { e: Expr::Name(name), kind: Kind::Num(n), fails: false, reads: false }
            }
            Entry::Hidden(addr, e) => {
                let n = self.g.vars.hidden.get(&addr).copied().unwrap_or(Num::I64);
                self.keep(Entry::of(e, n))
            }
            // A text that waits stays where it is: what comes writes elsewhere.
            other => other,
        }
    }

    /// The expression of an entry, as one of a kind.
    pub(crate) fn as_kind(&mut self, entry: &Entry, want: Kind) -> Expr {
        match (entry, want) {
            (Entry::Word(w), Kind::Num(n)) => literal(n, *w),
            (Entry::Word(w), Kind::Text) => self.text_at(*w),
            (Entry::Hidden(addr, e), Kind::Num(n)) => {
                let have = *self.g.vars.hidden.entry(*addr).or_insert(n);
                self.converted(e.clone(), have, n)
            }
            (Entry::Choice(c, a, b), want) => {
                let (a, b) = (self.as_kind(a, want), self.as_kind(b, want));
                Expr::If(Box::new(c.clone()), Box::new(a), Box::new(b))
            }
            (Entry::Typed { e, kind: Kind::Num(have), .. }, Kind::Num(n)) => {
                self.converted(e.clone(), *have, n)
            }
            (Entry::Typed { e, kind: Kind::Text, .. }, Kind::Text) => e.clone(),
            (Entry::Typed { .. } | Entry::Hidden(..), _) => {
                self.g.cannot("a text at a place that is worked out");
                Expr::Bool(false)
            }
        }
    }

    pub(crate) fn as_num(&mut self, entry: &Entry, n: Num) -> Expr {
        self.as_kind(entry, Kind::Num(n))
    }

    /// The word of one kind read as another; only ever wider.
    fn converted(&mut self, e: Expr, from: Num, to: Num) -> Expr {
        if from == to {
            return e;
        }
        if to == Num::Bool && !is_real(from) {
            return e.bin(Bin::Ne, Expr::size(0));
        }
        if is_real(from) || is_real(to) {
            self.g.cannot("a real number read as another kind");
        }
        e.cast(vars::ty(to))
    }

    fn text_at(&mut self, addr: u64) -> Expr {
        let addr = addr as u32;
        self.g.reveal_text(addr);
        let Some(slot) = self.g.vars.slot(addr).cloned() else { return Expr::Bool(false) };
        let place = match slot.shape {
            Shape::Texts(cap, _) => {
                let i = (addr - slot.start) / vars::text_words(cap);
                slot.place().at(Expr::size(i as usize))
            }
            Shape::Text(_) => slot.place(),
            Shape::One(_) | Shape::Many(..) | Shape::Fb(_) => {
                self.g.cannot("a text at a place that is worked out");
                slot.place()
            }
        };
        Expr::Ref(false, Box::new(self.own_place(addr, place)))
    }

    fn fault(&self) -> Expr {
        Expr::name("s").field("fault").passed()
    }

    /// A call that can fail.
    fn failing(&mut self, f: String, mut args: Vec<Expr>, n: Num) {
        args.push(self.fault());
        self.push_failing(Expr::Call(f, args), Kind::Num(n));
    }

    /// One instruction that pushes a value; false where it is another.
    pub(crate) fn value_op(&mut self, op: Op) -> bool {
        match op {
            Op::Push(w) => self.stack.push(Entry::Word(w)),
            Op::Load(a) => {
                let entry = self.load(a.0);
                self.stack.push(entry);
            }
            Op::LoadAt { base, len } => {
                let i = self.pop();
                let i = self.as_num(&i, Num::I64);
                let i = self.index(i, len);
                match self.g.vars.slot(base.0).cloned() {
                    Some(slot) => {
                        let place = self.own_place(base.0, slot.place());
                        let n = if let Shape::Many(n, _) = slot.shape { n } else { Num::I64 };
                        let place = if matches!(slot.shape, Shape::One(_)) { place } else { place.at(i) };
                        self.push_failing(place, Kind::Num(n));
                    }
                    None => self.g.cannot("a table without a declaration"),
                }
            }
            Op::Active(step) => {
                let e = self.g.active(step);
                self.stack.push(Entry::of(e, Num::Bool));
            }
            Op::WasActive(step) => {
                let e = Expr::name("s").field("before").at(self.g.step(step));
                self.stack.push(Entry::of(e, Num::Bool));
            }
            Op::GroupActive(g) => self.state_call("group_active", Expr::size(g.0 as usize), Num::Bool),
            Op::GroupTime(g) => self.state_call("group_time", Expr::size(g.0 as usize), Num::I64),
            Op::GroupAge(g) => self.state_call("group_age", Expr::size(g.0 as usize), Num::I64),
            Op::StepTime(step) => self.state_call("step_time", self.g.step(step), Num::I64),
            Op::StepAge(step) => self.state_call("step_age", self.g.step(step), Num::I64),
            Op::StepTenths(step) => self.state_call("step_tenths", self.g.step(step), Num::I64),
            Op::Due(p) => {
                let e = self.g.due(p);
                self.stack.push(Entry::of(e, Num::Bool));
            }
            Op::Rise(w) => self.watch_bit("rise", w.0),
            Op::Fall(w) => self.watch_bit("fall", w.0),
            Op::Timer(w) => self.watch_bit("timer", w.0),
            Op::ScanTime => self.stack.push(Entry::of(Expr::name("s").field("dt"), Num::I64)),
            Op::Not => {
                let a = self.pop();
                let e = self.as_num(&a, Num::Bool).not();
                self.push(e, Num::Bool, &[&a]);
            }
            Op::And | Op::Or | Op::Xor => self.logic(op),
            Op::Compare(c, n) => {
                let (b, a) = (self.pop(), self.pop());
                // Of two words without a declaration the wider kind.
                let (x, y) = (self.as_num(&a, n), self.as_num(&b, n));
                self.push(self.compared(c, n, x, y), Num::Bool, &[&a, &b]);
            }
            Op::Neg(n) => {
                let a = self.pop();
                let e = self.as_num(&a, n);
                if is_real(n) {
                    self.push(Expr::Un(Un::Neg, Box::new(e)), n, &[&a]);
                } else {
                    self.failing(format!("neg_{}", suffix(n)), vec![e], n);
                }
            }
            Op::Arith(op, n) => self.arith(op, n),
            Op::Convert(from, to) => self.convert(from, to),
            Op::Trunc(from, to) => {
                let a = self.pop();
                let e = self.as_num(&a, from);
                let e = if from == Num::F32 { e.cast(vars::ty(Num::F64)) } else { e };
                self.failing(format!("trunc_{}", suffix(to)), vec![e], to);
            }
            Op::Call(f, n, count) => self.function(f, n, usize::from(count)),
            Op::CompareText(c) => {
                let (b, a) = (self.pop(), self.pop());
                let (x, y) = (self.as_kind(&a, Kind::Text), self.as_kind(&b, Kind::Text));
                let e = Expr::call("text_compare", vec![x, y]).bin(bin(c), Expr::size(0));
                self.push(e, Num::Bool, &[&a, &b]);
            }
            Op::FromText(n) => {
                let a = self.pop();
                let e = self.as_kind(&a, Kind::Text);
                if is_real(n) {
                    self.g.needs_real_text();
                }
                self.failing(format!("text_to_{}", suffix(n)), vec![e], n);
            }
            _ => return false,
        }
        true
    }

    fn compared(&self, c: Cmp, n: Num, x: Expr, y: Expr) -> Expr {
        // What can never be otherwise, compilers warn of.
        let same = x == y && !is_real(n) && !matches!(x, Expr::Call(..));
        if same {
            return Expr::Bool(matches!(c, Cmp::Eq | Cmp::Le | Cmp::Ge));
        }
        match (c, n, &x, &y) {
            (Cmp::Eq, Num::Bool, _, Expr::Bool(true)) | (Cmp::Ne, Num::Bool, _, Expr::Bool(false)) => x,
            (Cmp::Eq, Num::Bool, _, Expr::Bool(false)) | (Cmp::Ne, Num::Bool, _, Expr::Bool(true)) => x.not(),
            (Cmp::Eq | Cmp::Ne, ..) => x.bin(bin(c), y),
            (_, Num::Bool, ..) => x.cast(Ty::U8).bin(bin(c), y.cast(Ty::U8)),
            (Cmp::Ge, n, _, Expr::Int(0, None)) if !signed(n) && !is_real(n) => Expr::Bool(true),
            (Cmp::Lt, n, _, Expr::Int(0, None)) if !signed(n) && !is_real(n) => Expr::Bool(false),
            _ => x.bin(bin(c), y),
        }
    }

    fn state_call(&mut self, f: &str, arg: Expr, n: Num) {
        self.stack.push(Entry::of(Expr::call(f, vec![Expr::name("s"), arg]), n));
    }

    fn watch_bit(&mut self, field: &str, w: u32) {
        let e = Expr::name("s").field("m").field(field).at(Expr::size(w as usize));
        self.stack.push(Entry::of(e, Num::Bool));
    }

    pub(crate) fn index(&self, i: Expr, len: u32) -> Expr {
        let i = match i {
            Expr::Int(n, _) => Expr::Int(n, Some(Ty::I64)),
            other => other,
        };
        Expr::call("place", vec![i, Expr::size(len as usize), self.fault()])
    }

    fn logic(&mut self, op: Op) {
        let (b, a) = (self.pop(), self.pop());
        let (x, y) = (self.as_num(&a, Num::Bool), self.as_num(&b, Num::Bool));
        let e = match op {
            Op::Xor => self.compared(Cmp::Ne, Num::Bool, x, y),
            // The right one is worked out in any case where it can fail.
            Op::And if b.fails() => x.bin(Bin::BitAnd, y),
            Op::Or if b.fails() => x.bin(Bin::BitOr, y),
            Op::And => x.and(y),
            _ => x.not().and(y.not()).not_of_and(),
        };
        self.push(e, Num::Bool, &[&a, &b]);
    }

    fn arith(&mut self, op: Arith, n: Num) {
        let (b, a) = (self.pop(), self.pop());
        let (x, y) = (self.as_num(&a, n), self.as_num(&b, n));
        let name = match op {
            Arith::Add => "add",
            Arith::Sub => "sub",
            Arith::Mul => "mul",
            Arith::Div => "div",
            Arith::Mod => "rem",
            Arith::Pow => "pow",
        };
        let plain = match op {
            Arith::Add => Some(Bin::Add),
            Arith::Sub => Some(Bin::Sub),
            Arith::Mul => Some(Bin::Mul),
            Arith::Div | Arith::Mod | Arith::Pow => None,
        };
        match plain.filter(|_| is_real(n)) {
            Some(op) => self.push(x.bin(op, y), n, &[&a, &b]),
            None if op == Arith::Pow => {
                self.g.needs_math();
                self.push(Expr::call(format!("pow_{}", suffix(n)), vec![x, y]), n, &[&a, &b]);
            }
            None => self.failing(format!("{name}_{}", suffix(n)), vec![x, y], n),
        }
    }

    fn convert(&mut self, from: Num, to: Num) {
        let a = self.pop();
        let e = self.as_num(&a, from);
        if from == to && !is_real(from) {
            return self.push(e, to, &[&a]);
        }
        if to == Num::Bool {
            let zero = if is_real(from) { literal(from, 0) } else { Expr::size(0) };
            return self.push(e.bin(Bin::Ne, zero), to, &[&a]);
        }
        match (is_real(from), is_real(to)) {
            (true, true) => self.push(if from == to { e } else { e.cast(vars::ty(to)) }, to, &[&a]),
            (true, false) => {
                let e = if from == Num::F32 { e.cast(vars::ty(Num::F64)) } else { e };
                self.failing(format!("round_{}", suffix(to)), vec![e], to);
            }
            (false, true) => {
                let e = if from == Num::Bool { e.cast(Ty::U8) } else { e };
                let e = match e {
                    Expr::Int(n, None) => Expr::Int(n, Some(vars::ty(from))),
                    other => other,
                };
                self.push(e.cast(vars::ty(to)), to, &[&a]);
            }
            (false, false) if widens(from, to) => self.push(e.cast(vars::ty(to)), to, &[&a]),
            (false, false) if from == Num::U64 => {
                self.failing(format!("{}_from_u64", suffix(to)), vec![e], to);
            }
            (false, false) => {
                let e = if from == Num::I64 { e } else { e.cast(Ty::I64) };
                self.failing(format!("{}_from_i64", suffix(to)), vec![e], to);
            }
        }
    }

    fn function(&mut self, f: Builtin, n: Num, count: usize) {
        let from = self.stack.len().saturating_sub(count);
        let args = self.stack.split_off(from);
        match f {
            Builtin::Sel | Builtin::Mux => return self.select(f, args),
            _ if f.shifts() => {
                let kinds = args.iter().zip([n, Num::I64]);
                let exprs = kinds.map(|(a, n)| self.as_num(a, n)).collect();
                let name = format!("{f:?}_{}", suffix(n)).to_lowercase();
                return self.failing(name, exprs, n);
            }
            Builtin::Abs if !is_real(n) => {
                let e = args.first().cloned().unwrap_or(Entry::Word(0));
                let e = self.as_num(&e, n);
                if signed(n) {
                    return self.failing(format!("abs_{}", suffix(n)), vec![e], n);
                }
                return self.push(e, n, &args.iter().collect::<Vec<_>>());
            }
            _ => {}
        }
        let exprs: Vec<Expr> = args.iter().map(|a| self.as_num(a, n)).collect();
        let named = |f: &str, e: Vec<Expr>| Expr::call(format!("{f}_{}", suffix(n)), e);
        let e = match f {
            Builtin::Min | Builtin::Max => {
                let name = if f == Builtin::Min { "min" } else { "max" };
                exprs.into_iter().reduce(|a, b| named(name, vec![a, b])).unwrap_or(Expr::size(0))
            }
            Builtin::Limit => {
                let [low, x, high] = <[Expr; 3]>::try_from(exprs).unwrap_or([const { Expr::Bool(false) }; 3]);
                named("min", vec![named("max", vec![x, low]), high])
            }
            _ => {
                let name = format!("{f:?}").to_lowercase();
                if !matches!(f, Builtin::Abs | Builtin::Sqrt) {
                    self.g.needs_math();
                }
                let wide =
                    exprs.into_iter().map(|e| if n == Num::F32 { e.cast(vars::ty(Num::F64)) } else { e });
                let e = Expr::call(format!("real_{name}"), wide.collect());
                if n == Num::F32 { e.cast(vars::ty(Num::F32)) } else { e }
            }
        };
        self.push(e, n, &args.iter().collect::<Vec<_>>());
    }

    /// SEL and MUX: all arguments have been worked out.
    fn select(&mut self, f: Builtin, args: Vec<Entry>) {
        // The choice itself fails or not; what is not chosen fails as well.
        let depth = self.stack.len();
        self.stack.extend(args);
        if f == Builtin::Mux || self.stack.iter().skip(depth).skip(1).any(Entry::fails) {
            self.settle();
        }
        let mut args = self.stack.split_off(depth).into_iter();
        let selector = args.next().unwrap_or(Entry::Word(0));
        let rest: Vec<Entry> = args.collect();
        if f == Builtin::Sel {
            let c = self.as_num(&selector, Num::Bool);
            if let [a, b] = rest.as_slice() {
                let entry = self.choice(c, b.clone(), a.clone(), selector.fails());
                self.stack.push(entry);
            }
            return;
        }
        let k = self.as_num(&selector, Num::I64);
        let at = self.temporary();
        let value = self.index(k, rest.len() as u32);
        self.out.push(Stmt::Let { mutable: false, name: at.clone(), ty: Ty::Size, value });
        self.leave_on_fault();
        let entry = rest.into_iter().enumerate().rev().reduce(|(_, other), (i, this)| {
            let c = Expr::name(at.clone()).bin(Bin::Eq, Expr::size(i));
            (i, self.choice(c, this, other, false))
        });
        self.stack.push(entry.map_or(Entry::Word(0), |(_, e)| e));
    }

    /// One of two values; typed as soon as one of them tells its kind.
    pub(crate) fn choice(&mut self, c: Expr, a: Entry, b: Entry, fails: bool) -> Entry {
        let kind = |e: &Entry| match e {
            Entry::Typed { kind, .. } => Some(*kind),
            Entry::Word(_) | Entry::Hidden(..) | Entry::Choice(..) => None,
        };
        match (kind(&a), kind(&b)) {
            (Some(Kind::Num(x)), Some(Kind::Num(y))) => {
                let n = if widens(x, y) { y } else { x };
                let (a, b) = (self.as_num(&a, n), self.as_num(&b, n));
                let e = Expr::If(Box::new(c), Box::new(a), Box::new(b));
                Entry::Typed { e, kind: Kind::Num(n), fails, reads: true }
            }
            (Some(want), _) | (_, Some(want)) => {
                let (a, b) = (self.as_kind(&a, want), self.as_kind(&b, want));
                let e = Expr::If(Box::new(c), Box::new(a), Box::new(b));
                Entry::Typed { e, kind: want, fails, reads: true }
            }
            (None, None) => Entry::Choice(c, Box::new(a), Box::new(b)),
        }
    }
}

impl Expr {
    /// `NOT (NOT a AND NOT b)` as `a OR b`.
    fn not_of_and(self) -> Expr {
        match self {
            Expr::Bin(Bin::And, a, b) => a.not().bin(Bin::Or, b.not()),
            other => other.not(),
        }
    }
}
