//! Statements of the equations as statements of the code, for both styles.
//!
//! ```text
//! g7_equations::{Stmt, Expr} + where each memory lives (Places) -> tree::Block
//! ```
//!
//! # Invariants
//!
//! - Nothing is decided here: order, conditions and faults are those of the equations.
//! - Where a statement asks whether an operation has a value, and then uses it, the
//!   code has one call of a checked helper, and uses what it gives.

mod texts;

use std::collections::HashMap;

use g7_engine::{Block as FunctionBlock, Builtin, Cmp, Num};
use g7_equations::{About, Expr as Term, Memory, MemoryId, Stmt as Line, expand};
use g7_model::{Said, Type, say};

use crate::lets::{Lets, drop_unused};
use crate::operations::{self, Made, Needs};
use crate::tree::{Bin, Block, Expr, Stmt, Ty};
use crate::vars::{self, literal, num};

/// Where a memory lives in the code.
pub(crate) enum Home {
    /// In a name of the function in hand.
    Local(Option<String>),
    /// A number, by the expression that reads it.
    Number(Expr, Num),
    /// A text of so many bytes.
    Text(Expr, u16),
    /// A table.
    Table(Expr, Num),
}

/// The memories of the code in hand.
pub(crate) trait Places {
    fn memory(&self, id: MemoryId) -> Option<&Memory>;

    fn home(&mut self, id: MemoryId) -> Home;

    /// Gives a number another value, where that is more than an assignment.
    fn assign(&mut self, _id: MemoryId, _value: &Expr) -> Option<Block> {
        None
    }

    /// Calls a function block, where the code has a function for it.
    fn call(&mut self, _block: FunctionBlock, _memories: &[MemoryId]) -> Option<Block> {
        None
    }

    /// A text that never changes.
    fn constant(&mut self, text: &str) -> Expr;

    fn about(&mut self, _about: About) -> Option<String> {
        None
    }

    /// Looks at a time that stands in the chart.
    fn time(&mut self, _nanoseconds: i64) {}

    /// Says where the code needs something of a library.
    fn needs(&mut self, needs: Needs);

    /// Says that the language of the code has no way for this.
    fn cannot(&mut self, what: Said);
}

/// Code that was translated.
#[derive(Default)]
pub(crate) struct Code {
    pub(crate) block: Block,
    /// The value it gives.
    pub(crate) value: Option<Expr>,
    /// It can end in a fault.
    pub(crate) fails: bool,
}

/// Translates statements, and the value behind them.
pub(crate) fn translate(places: &mut dyn Places, list: &[Line], value: Option<(&Term, Num)>) -> Code {
    let lets = Lets::of(list, value.map(|v| v.0));
    let mut body = Body {
        places,
        lets,
        result: value.map(|v| v.1),
        names: HashMap::new(),
        top: Block::new(),
        out: Block::new(),
        checked: Vec::new(),
        count: 0,
        fails: false,
    };
    body.all(list);
    let value = value.map(|(e, n)| body.number(e, n));
    let mut block = body.top;
    block.append(&mut body.out);
    drop_unused(&mut block, value.as_ref());
    Code { block, value, fails: body.fails }
}

/// Translation in hand.
struct Body<'p> {
    places: &'p mut dyn Places,
    lets: Lets,
    /// The type of what is given back where a fault ends the code.
    result: Option<Num>,
    names: HashMap<MemoryId, String>,
    /// Names that are declared before the first statement.
    top: Block,
    out: Block,
    /// Operations that were found to have a value, and the names that have it.
    checked: Vec<(Term, Expr)>,
    count: u32,
    fails: bool,
}

fn s() -> Expr {
    Expr::name("s")
}

/// The memories that an operation reads.
fn operands(e: &Term) -> Vec<MemoryId> {
    let mut found = Vec::new();
    e.visit(&mut |e| {
        if let Term::Read(m) | Term::Element(m, _) = e {
            found.push(*m);
        }
    });
    found
}

fn text_ty(cap: u16) -> Ty {
    Ty::Array(Box::new(Ty::U8), usize::from(cap) + 2)
}

impl Body<'_> {
    fn all(&mut self, list: &[Line]) {
        for line in list {
            self.line(line);
        }
    }

    /// Statements of a list of their own.
    fn inner(&mut self, list: &[Line]) -> Block {
        let outer = std::mem::take(&mut self.out);
        let known = self.checked.len();
        self.all(list);
        self.checked.truncate(known);
        std::mem::replace(&mut self.out, outer)
    }

    fn line(&mut self, line: &Line) {
        match line {
            Line::Set(m, e) => self.set(*m, e),
            Line::SetElement(m, i, e) => self.set_element(*m, i, e),
            Line::If(Term::Fails(e), then, other)
                if other.is_empty() && matches!(then[..], [Line::Fault(..)]) =>
            {
                self.check(e);
            }
            Line::If(c, then, other) => {
                let c = self.truth(c);
                let (then, other) = (self.inner(then), self.inner(other));
                if c == Expr::Bool(false) {
                    self.out.extend(other);
                } else if then.is_empty() && !other.is_empty() {
                    self.out.push(Stmt::If(c.not(), other, then));
                } else if !then.is_empty() {
                    self.out.push(Stmt::If(c, then, other));
                }
            }
            Line::Loop(list) => {
                // A value that was checked before the loop may change within it.
                let outer = std::mem::take(&mut self.checked);
                let inner = self.inner(list);
                self.checked = outer;
                self.out.push(Stmt::repeated(inner));
                list.iter().for_each(|l| self.changes_of(l));
            }
            Line::Exit => self.out.push(Stmt::Break),
            Line::Fault(kind, _) => {
                self.fails = true;
                let fault = Stmt::set(s().field("fault"), Expr::name(operations::fault(*kind)));
                let back = self.back();
                self.out.extend([fault, back]);
            }
            Line::Call(block, memories) => {
                match self.places.call(*block, memories) {
                    Some(block) => self.out.extend(block),
                    None => self.all(&expand(*block, memories)),
                }
                memories.iter().for_each(|m| self.changes(*m));
            }
            Line::About(about) => self.out.extend(self.places.about(*about).map(Stmt::Note)),
        }
    }

    fn changes_of(&mut self, line: &Line) {
        let mut found = Vec::new();
        line.visit(&mut |l| match l {
            Line::Set(m, _) | Line::SetElement(m, ..) => found.push(*m),
            Line::Call(_, all) => found.extend(all),
            _ => {}
        });
        found.into_iter().for_each(|m| self.changes(m));
    }

    /// Forgets the checks that have this memory as an operand.
    fn changes(&mut self, m: MemoryId) {
        self.checked.retain(|(e, _)| !operands(e).contains(&m));
    }

    fn back(&self) -> Stmt {
        Stmt::Return(self.result.map(|n| literal(n, 0)))
    }

    fn leave_on_fault(&mut self) {
        self.fails = true;
        let fault = s().field("fault").bin(Bin::Ne, Expr::size(0));
        let back = self.back();
        self.out.push(Stmt::If(fault, vec![back], Vec::new()));
    }

    fn fresh(&mut self) -> String {
        self.count += 1;
        format!("x{}", self.count)
    }

    fn let_(&mut self, ty: Ty, value: Expr) -> Expr {
        let name = self.fresh();
        self.out.push(Stmt::Let { mutable: false, name: name.clone(), ty, value });
        Expr::Name(name)
    }

    /// Asks whether an operation has a value, and keeps the value.
    fn check(&mut self, e: &Term) {
        let (made, n) = self.operation(e);
        match made {
            Made::Checked(f, mut args) => {
                args.push(s().field("fault").passed());
                let value = self.let_(vars::ty(n), Expr::Call(f, args));
                self.leave_on_fault();
                self.checked.push((e.clone(), value));
            }
            Made::Plain(_) => {}
        }
    }

    fn ty(&self, m: MemoryId) -> Type {
        self.places.memory(m).map_or(Type::Bool, |m| m.ty)
    }

    /// The name of a local memory, declared at its first mention.
    fn local(&mut self, m: MemoryId, name: Option<String>) -> Expr {
        if let Some(name) = self.names.get(&m) {
            return Expr::name(name.clone());
        }
        let name = name.unwrap_or_else(|| self.fresh());
        self.names.insert(m, name.clone());
        let (ty, value) = match self.ty(m) {
            Type::String(cap) => (text_ty(cap), Expr::call("zeroed", Vec::new())),
            ty => {
                let n = num(ty).unwrap_or(Num::I64);
                (vars::ty(n), literal(n, 0))
            }
        };
        self.top.push(Stmt::Let { mutable: true, name: name.clone(), ty, value });
        Expr::Name(name)
    }

    fn set(&mut self, m: MemoryId, e: &Term) {
        self.set_value(m, e);
        self.changes(m);
    }

    fn set_value(&mut self, m: MemoryId, e: &Term) {
        match (self.places.home(m), self.ty(m)) {
            (Home::Local(name), Type::String(cap)) => {
                let place = self.local(m, name);
                self.set_text(m, place, cap, e);
            }
            (Home::Text(place, cap), _) => self.set_text(m, place, cap, e),
            (Home::Local(name), ty) => {
                let n = num(ty).unwrap_or(Num::I64);
                let value = self.number(e, n);
                if self.lets.is_simple(m) && !self.names.contains_key(&m) {
                    let name = name.unwrap_or_else(|| self.fresh());
                    self.names.insert(m, name.clone());
                    self.out.push(Stmt::Let { mutable: false, name, ty: vars::ty(n), value });
                } else {
                    let place = self.local(m, name);
                    self.out.push(Stmt::set(place, value));
                }
            }
            (Home::Number(place, n), ty) => {
                let of = num(ty).unwrap_or(n);
                let value = self.number(e, of);
                match self.places.assign(m, &value) {
                    Some(block) => self.out.extend(block),
                    None => self.out.push(Stmt::set(place, operations::cast(value, of, n))),
                }
            }
            (Home::Table(place, _), _) => {
                if let Term::Read(from) = e
                    && let Home::Table(from, _) = self.places.home(*from)
                {
                    self.out.push(Stmt::set(place, from));
                } else {
                    self.places.cannot(say!("a table that is given as one"));
                }
            }
        }
    }

    fn set_text(&mut self, m: MemoryId, place: Expr, cap: u16, e: &Term) {
        let same = matches!(e, Term::Call(_, Type::String(c), _) | Term::Convert(_, Type::String(c), _) if *c == cap);
        if same && !e.reads(m) {
            return self.text_into(e, place, cap);
        }
        let from = self.text(e);
        if !matches!(&from, Expr::Ref(_, e) if **e == place) {
            self.out
                .push(Stmt::Do(Expr::call("text_copy", vec![from, place.passed(), Expr::size(cap.into())])));
        }
    }

    fn set_element(&mut self, m: MemoryId, i: &Term, e: &Term) {
        let Home::Table(place, n) = self.places.home(m) else {
            return self.places.cannot(say!("a table of this kind"));
        };
        let i = self.number(i, Num::I64).cast(Ty::Size);
        let value = self.number(e, n);
        self.out.push(Stmt::set(place.at(i), value));
        self.changes(m);
    }

    fn truth(&mut self, e: &Term) -> Expr {
        self.number(e, Num::Bool)
    }

    fn each(&mut self, list: &[Term], n: Num) -> Vec<Expr> {
        list.iter().map(|e| self.number(e, n)).collect()
    }

    /// An expression that gives a number of the type.
    fn number(&mut self, e: &Term, n: Num) -> Expr {
        if let Some((_, value)) = self.checked.iter().rev().find(|(known, _)| known == e) {
            return value.clone();
        }
        let have = self.kind(e, n);
        if have != n {
            let value = self.number(e, have);
            return operations::cast(value, have, n);
        }
        match e {
            Term::Const(ty, v) => {
                if *ty == Type::Time {
                    self.places.time(*v as i64);
                }
                literal(n, *v)
            }
            Term::Read(m) => match self.places.home(*m) {
                Home::Local(name) => self.local(*m, name),
                Home::Number(place, have) => operations::cast(place, have, n),
                Home::Text(..) | Home::Table(..) => self.none(say!("a text read as a number")),
            },
            Term::Element(m, i) => {
                let i = self.number(i, Num::I64).cast(Ty::Size);
                match self.places.home(*m) {
                    Home::Table(place, _) => place.at(i),
                    _ => self.none(say!("a table of this kind")),
                }
            }
            Term::Not(x) => self.truth(x).not(),
            Term::And(list) => {
                let all = self.each(list, Num::Bool);
                Expr::joined(all, Expr::and).unwrap_or(Expr::Bool(true))
            }
            Term::Or(list) => {
                let all = self.each(list, Num::Bool);
                Expr::joined(all, Expr::or).unwrap_or(Expr::Bool(false))
            }
            Term::Xor(a, b) => {
                let (a, b) = (self.truth(a), self.truth(b));
                operations::compare(Cmp::Ne, Num::Bool, a, b)
            }
            Term::Compare(c, Type::String(_), a, b) => {
                let (a, b) = (self.text(a), self.text(b));
                operations::compare_texts(*c, a, b)
            }
            Term::Compare(c, ty, a, b) => {
                let n = num(*ty).unwrap_or(Num::I64);
                let (a, b) = (self.number(a, n), self.number(b, n));
                operations::compare(*c, n, a, b)
            }
            Term::Differs(Type::String(_), a, b) => {
                let (a, b) = (self.text(a), self.text(b));
                operations::compare_texts(Cmp::Ne, a, b)
            }
            Term::Differs(ty, a, b) => {
                let n = num(*ty).unwrap_or(Num::I64);
                let (a, b) = (self.number(a, n), self.number(b, n));
                operations::differ(n, a, b)
            }
            Term::Call(Builtin::Sel, _, list) => self.select(list, n),
            Term::Call(Builtin::Mux, _, list) => self.choose(list, n),
            Term::Neg(ty, x) if !ty.is_real() => operations::minus(self.number(x, n)),
            Term::Arith(op, ty, a, b) => {
                let of = num(*ty).unwrap_or(n);
                let (x, y) = (self.number(a, of), self.number(b, of));
                match operations::fitting(*op, of, x, y) {
                    Some(e) => e,
                    None => self.operate(e),
                }
            }
            Term::Convert(from, to, x) if !matches!(from, Type::String(_)) => {
                let (from, to) = (num(*from).unwrap_or(n), num(*to).unwrap_or(n));
                let x = self.number(x, from);
                match operations::convert(from, to, x.clone()) {
                    Made::Plain(e) => e,
                    // The statements round it see to it that it has its place.
                    Made::Checked(..) if !operations::is_real(from) => operations::cast(x, from, to),
                    Made::Checked(..) => self.operate(e),
                }
            }
            Term::Random(_) => self.none(say!("a random number")),
            Term::Fails(_) | Term::Text(_) => self.none(say!("a question of this kind")),
            Term::Neg(..) | Term::Convert(..) | Term::Trunc(..) | Term::Call(..) => self.operate(e),
        }
    }

    /// The type of the words of an expression, where it tells one.
    fn kind(&self, e: &Term, n: Num) -> Num {
        match e {
            Term::Read(m) | Term::Element(m, _) => num(self.ty(*m)).unwrap_or(n),
            Term::Neg(ty, _)
            | Term::Arith(_, ty, ..)
            | Term::Convert(_, ty, _)
            | Term::Trunc(_, ty, _)
            | Term::Call(_, ty, _) => num(*ty).unwrap_or(n),
            _ => n,
        }
    }

    fn none(&mut self, what: Said) -> Expr {
        self.places.cannot(what);
        Expr::Bool(false)
    }

    /// An operation that was not asked about; what it gives where it has no value
    /// does not matter.
    fn operate(&mut self, e: &Term) -> Expr {
        match self.operation(e).0 {
            Made::Plain(e) => e,
            Made::Checked(f, mut args) => {
                args.push(s().field("fault").passed());
                Expr::Call(f, args)
            }
        }
    }

    /// An operation, and the type of its value.
    fn operation(&mut self, e: &Term) -> (Made, Num) {
        let mut needs = Needs::default();
        let made = match e {
            Term::Neg(ty, x) => {
                let n = num(*ty).unwrap_or(Num::I64);
                (operations::negate(n, self.number(x, n)), n)
            }
            Term::Arith(op, ty, a, b) => {
                let n = num(*ty).unwrap_or(Num::I64);
                let (a, b) = (self.number(a, n), self.number(b, n));
                (operations::arith(*op, n, a, b, &mut needs), n)
            }
            Term::Convert(Type::String(_), to, x) => {
                let to = num(*to).unwrap_or(Num::I64);
                let x = self.text(x);
                (operations::read_number(to, x, &mut needs), to)
            }
            Term::Convert(from, to, _) if g7_compile::tree::transfers(*from, *to) => {
                let n = num(*to).unwrap_or(Num::I64);
                (Made::Plain(self.number(e, n)), n)
            }
            Term::Convert(from, to, x) => {
                let (from, to) = (num(*from).unwrap_or(Num::I64), num(*to).unwrap_or(Num::I64));
                let x = self.number(x, from);
                (operations::convert(from, to, x), to)
            }
            Term::Trunc(from, to, x) => {
                let (from, to) = (num(*from).unwrap_or(Num::F64), num(*to).unwrap_or(Num::I64));
                let x = self.number(x, from);
                (operations::truncate(from, to, x), to)
            }
            Term::Call(f @ (Builtin::Len | Builtin::Find), _, list) => {
                let args = list.iter().map(|e| self.text(e)).collect();
                let count = Expr::Call(format!("text_{}", operations::name(*f)), args);
                (Made::Plain(operations::cast(count, Num::I64, Num::I16)), Num::I16)
            }
            Term::Call(f, ty, list) => {
                let n = num(*ty).unwrap_or(Num::I64);
                let count = list.len().saturating_sub(1);
                // The last operand of a shift is the number of places.
                let of = |i: usize| if f.shifts() && i == count { Num::I64 } else { n };
                let args = list.iter().enumerate().map(|(i, e)| self.number(e, of(i))).collect();
                (operations::call(*f, n, args, &mut needs), n)
            }
            _ => (Made::Plain(self.none(say!("an operation of this kind"))), Num::I64),
        };
        if needs != Needs::default() {
            self.places.needs(needs);
        }
        made
    }

    /// SEL: the second where the first is FALSE, else the third.
    fn select(&mut self, list: &[Term], n: Num) -> Expr {
        let [c, a, b] = list else { return self.none(say!("SEL without its operands")) };
        let c = self.truth(c);
        let (a, b) = (self.number(a, n), self.number(b, n));
        if a == b { a } else { Expr::If(Box::new(c), Box::new(b), Box::new(a)) }
    }

    /// MUX: one of several by a number from 0.
    fn choose(&mut self, list: &[Term], n: Num) -> Expr {
        let Some((k, rest)) = list.split_first() else { return self.none(say!("MUX without its operands")) };
        let k = self.number(k, Num::I64);
        let all = self.each(rest, n);
        let chosen = all.into_iter().enumerate().rev().reduce(|(_, other), (i, this)| {
            let c = k.clone().bin(Bin::Eq, Expr::size(i));
            (i, Expr::If(Box::new(c), Box::new(this), Box::new(other)))
        });
        chosen.map_or(Expr::Bool(false), |(_, e)| e)
    }
}
