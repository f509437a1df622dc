//! The engine's code as statements. Its jumps come from IF, CASE, loops and
//! returns; they become those again.

use std::collections::{BTreeMap, BTreeSet};

use g7_engine::{Code, Num, Op};

use crate::build::Gen;
use crate::tree::{Bin, Block, Expr, Stmt, Ty};
use crate::values::Entry;
use crate::vars::{self, Kind, Shape, members};

/// What a stored action writes when all of a pass run on the values before it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Deferred {
    /// Slots of which the action has a copy of its own, by their first word.
    pub(crate) own: BTreeMap<u32, String>,
}

/// Code in translation.
pub(crate) struct Flow<'g, 'a> {
    pub(crate) g: &'g mut Gen<'a>,
    pub(crate) stack: Vec<Entry>,
    pub(crate) out: Block,
    code: Code,
    /// What is given back where a fault ends it.
    result: Option<Kind>,
    temporaries: u32,
    /// The latch of each loop by its head.
    loops: BTreeMap<u32, u32>,
    /// Heads of the loops round this point, and where control goes behind them.
    open: Vec<(u32, u32)>,
    /// Flags of jumps that leave several constructs at once, by their targets.
    flags: BTreeMap<u32, String>,
    /// Targets of such jumps in what was translated last.
    escapes: BTreeSet<u32>,
    pub(crate) deferred: Option<Deferred>,
}

impl<'g, 'a> Flow<'g, 'a> {
    pub(crate) fn new(g: &'g mut Gen<'a>, code: Code, result: Option<Kind>) -> Flow<'g, 'a> {
        let mut loops = BTreeMap::new();
        for at in code.start..code.end {
            if let Some(Op::Jump(to) | Op::JumpUnless(to)) = g.t.code.get(at as usize)
                && *to <= at
            {
                loops.insert(*to, at);
            }
        }
        Flow {
            g,
            stack: Vec::new(),
            out: Block::new(),
            code,
            result,
            temporaries: 0,
            loops,
            open: Vec::new(),
            flags: BTreeMap::new(),
            escapes: BTreeSet::new(),
            deferred: None,
        }
    }

    /// Code that leaves nothing behind.
    pub(crate) fn body(mut self) -> Block {
        let block = self.block(self.code.start, self.code.end, self.code.end);
        self.with_flags(block)
    }

    /// Code that leaves a value behind: statements, and the value.
    pub(crate) fn value(mut self, want: Kind) -> (Block, Expr, bool) {
        let block = self.block(self.code.start, self.code.end, self.code.end);
        let entry = self.pop();
        let fails = entry.fails();
        let e = self.as_kind(&entry, want);
        (self.with_flags(block), e, fails)
    }

    fn with_flags(&mut self, block: Block) -> Block {
        let flags = std::mem::take(&mut self.flags);
        let mut all: Block = flags
            .into_values()
            .map(|name| Stmt::Let { mutable: true, name, ty: Ty::Bool, value: Expr::Bool(false) })
            .collect();
        all.extend(block);
        all
    }

    pub(crate) fn temporary(&mut self) -> String {
        self.temporaries += 1;
        format!("x{}", self.temporaries)
    }

    /// Ends the code where a fault has come.
    pub(crate) fn leave_on_fault(&mut self) {
        let fault = Expr::name("s").field("fault").bin(Bin::Ne, Expr::size(0));
        let value = self.result.map(|k| match k {
            Kind::Num(n) => vars::literal(n, 0),
            Kind::Text => Expr::Bool(false),
        });
        self.out.push(Stmt::If(fault, vec![Stmt::Return(value)], Vec::new()));
    }

    fn op(&self, at: u32) -> Option<Op> {
        self.g.t.code.get(at as usize).copied()
    }

    /// Instructions `from..end`; behind them control goes to `follow`.
    fn block(&mut self, from: u32, end: u32, follow: u32) -> Block {
        let outer = std::mem::take(&mut self.out);
        let mut escapes = BTreeSet::new();
        let mut at = from;
        while at < end {
            let (next, ends) = self.step(at, end, follow);
            let new = std::mem::take(&mut self.escapes);
            at = next;
            if ends {
                escapes.extend(new);
                break;
            }
            let mut left: Vec<u32> = new.into_iter().collect();
            // A jump to a place in this very block: what lies between is for the others.
            while let Some(target) = left.first().copied() {
                let flag = Expr::Name(self.flag(target));
                let inner =
                    self.open.last().copied().filter(|(head, exit)| target < *head || target >= *exit);
                if inner.is_some() {
                    self.out.push(Stmt::If(flag, vec![Stmt::Break], Vec::new()));
                } else {
                    let stop = target.min(end).max(at);
                    if stop > at {
                        let rest = self.block(at, stop, if stop == end { follow } else { stop });
                        let more = std::mem::take(&mut self.escapes);
                        left.extend(more.into_iter().filter(|t| !left.contains(t)).collect::<Vec<_>>());
                        self.out.push(Stmt::If(flag.not(), rest, Vec::new()));
                        at = stop;
                    }
                }
                if target >= end && target != follow {
                    escapes.insert(target);
                }
                left.remove(0);
            }
        }
        self.escapes = escapes;
        std::mem::replace(&mut self.out, outer)
    }

    fn flag(&mut self, target: u32) -> String {
        let next = self.flags.len() + 1;
        self.flags.entry(target).or_insert_with(|| format!("left{next}")).clone()
    }

    /// One instruction, or the construct that it begins; where to go on, and
    /// whether the block ends here.
    fn step(&mut self, at: u32, end: u32, follow: u32) -> (u32, bool) {
        if let Some(&latch) = self.loops.get(&at)
            && latch < end
            && self.open.iter().all(|(head, _)| *head != at)
        {
            self.settle();
            return (self.round(at, latch), false);
        }
        let Some(op) = self.op(at) else { return (end, true) };
        self.g.at = at;
        if self.value_op(op) {
            return (at + 1, false);
        }
        match op {
            Op::JumpUnless(to) => return self.branch(at, to, end, follow),
            Op::Jump(to) => {
                self.jump(to, follow);
                return (end, true);
            }
            Op::Return => {
                self.jump(self.code.end, follow);
                return (end, true);
            }
            Op::Drop => {
                let e = self.pop();
                if e.fails() {
                    self.stack.push(e);
                    self.settle();
                    self.pop();
                    self.leave_on_fault();
                }
            }
            other => self.statement(other),
        }
        (at + 1, false)
    }

    fn jump(&mut self, to: u32, follow: u32) {
        match self.open.last() {
            Some((_, exit)) if to == *exit => self.out.push(Stmt::Break),
            _ if to == follow => {}
            _ if to == self.code.end && self.result.is_none() && self.deferred.is_none() => {
                self.out.push(Stmt::Return(None));
            }
            inner => {
                let leaves = inner.is_some_and(|(head, exit)| to < *head || to >= *exit);
                let flag = self.flag(to);
                self.out.push(Stmt::set(Expr::Name(flag), Expr::Bool(true)));
                if leaves {
                    self.out.push(Stmt::Break);
                }
                self.escapes.insert(to);
            }
        }
    }

    /// A loop from its head to its latch.
    fn round(&mut self, head: u32, latch: u32) -> u32 {
        self.open.push((head, latch + 1));
        let mut body = self.block(head, latch, head);
        let escapes = std::mem::take(&mut self.escapes);
        let outer = std::mem::take(&mut self.out);
        if let Some(Op::JumpUnless(_)) = self.op(latch) {
            let c = self.condition();
            self.out.push(Stmt::If(c, vec![Stmt::Break], Vec::new()));
        }
        let work = Expr::name("s").field("work");
        self.out.push(Stmt::Assign(Some(Bin::Add), work.clone(), Expr::size(1)));
        let over = work.bin(Bin::Gt, Expr::size(g7_engine::WORK as usize));
        let fail = Stmt::set(Expr::name("s").field("fault"), Expr::name("FAULT_BOUND"));
        self.leave_on_fault();
        let leave = self.out.pop();
        let stop = match leave {
            Some(Stmt::If(_, leave, _)) => [vec![fail], leave].concat(),
            _ => vec![fail],
        };
        self.out.push(Stmt::If(over, stop, Vec::new()));
        body.append(&mut self.out);
        self.out = outer;
        self.open.pop();
        // `while` with its condition where that comes first.
        let statement = match body.split_first() {
            Some((Stmt::If(c, then, other), rest)) if then[..] == [Stmt::Break] && other.is_empty() => {
                Stmt::While(c.clone().not(), rest.to_vec())
            }
            _ => Stmt::While(Expr::Bool(true), body),
        };
        self.out.push(statement);
        self.escapes = escapes;
        latch + 1
    }

    /// Pops a condition; a fault in it ends the code.
    fn condition(&mut self) -> Expr {
        let entry = self.pop();
        if !entry.fails() {
            return self.as_num(&entry, Num::Bool);
        }
        let value = self.as_num(&entry, Num::Bool);
        let name = self.temporary();
        self.out.push(Stmt::Let { mutable: false, name: name.clone(), ty: Ty::Bool, value });
        self.leave_on_fault();
        Expr::Name(name)
    }

    fn branch(&mut self, at: u32, to: u32, end: u32, follow: u32) -> (u32, bool) {
        let c = self.condition();
        if let Some((_, exit)) = self.open.last()
            && to == *exit
        {
            self.settle();
            self.out.push(Stmt::If(c.not(), vec![Stmt::Break], Vec::new()));
            return (at + 1, false);
        }
        if to > end {
            let outer = std::mem::take(&mut self.out);
            self.jump(to, follow);
            let leave = std::mem::replace(&mut self.out, outer);
            self.out.push(Stmt::If(c.not(), leave, Vec::new()));
            return (at + 1, false);
        }
        let other = match self.op(to.wrapping_sub(1)) {
            Some(Op::Jump(u)) if to > at + 1 && u >= to && u <= end => Some(u),
            _ => None,
        };
        let next = other.unwrap_or(to);
        let behind = if next == end { follow } else { next };
        let then_end = if other.is_some() { to - 1 } else { to };
        let below = std::mem::take(&mut self.stack);
        let then = self.block(at + 1, then_end, behind);
        let mut escapes = std::mem::take(&mut self.escapes);
        let one = self.stack.pop();
        let mut otherwise = Block::new();
        let mut two = None;
        if other.is_some() {
            self.stack.clear();
            otherwise = self.block(to, next, behind);
            escapes.extend(std::mem::take(&mut self.escapes));
            two = self.stack.pop();
        }
        self.stack = below;
        self.join(c, (then, one), (otherwise, two));
        self.escapes = escapes;
        (next, false)
    }

    /// Behind both ways, with the value that both leave.
    fn join(&mut self, c: Expr, one: (Block, Option<Entry>), two: (Block, Option<Entry>)) {
        let (Some(a), Some(b)) = (&one.1, &two.1) else {
            if !(one.0.is_empty() && two.0.is_empty()) {
                self.settle();
                let (c, then, other) =
                    if one.0.is_empty() { (c.not(), two.0, one.0) } else { (c, one.0, two.0) };
                self.out.push(Stmt::If(c, then, other));
            }
            return;
        };
        if one.0.is_empty() && two.0.is_empty() {
            let fails = a.fails() || b.fails();
            let entry = match (a, b) {
                (_, Entry::Word(0)) if matches!(a, Entry::Typed { kind: Kind::Num(Num::Bool), .. }) => {
                    let e = c.and(self.as_num(a, Num::Bool));
                    Entry::Typed { e, kind: Kind::Num(Num::Bool), fails, reads: true }
                }
                _ => self.choice(c, a.clone(), b.clone(), fails),
            };
            if fails && self.stack.iter().any(Entry::fails) {
                self.settle();
            }
            self.stack.push(entry);
            return;
        }
        self.settle();
        let kind = |e: &Entry| if let Entry::Typed { kind: Kind::Num(n), .. } = e { Some(*n) } else { None };
        let n = kind(a).or(kind(b)).unwrap_or(Num::Bool);
        let name = self.temporary();
        let (x, y) = (self.as_num(a, n), self.as_num(b, n));
        let (mut then, mut other) = (one.0, two.0);
        then.push(Stmt::set(Expr::name(name.clone()), x));
        other.push(Stmt::set(Expr::name(name.clone()), y));
        let value = vars::literal(n, 0);
        self.out.push(Stmt::Let { mutable: true, name: name.clone(), ty: vars::ty(n), value });
        self.out.push(Stmt::If(c, then, other));
        let fails = a.fails() || b.fails();
        if fails {
            self.leave_on_fault();
        }
        self.stack.push(Entry::Typed { e: Expr::Name(name), kind: Kind::Num(n), fails: false, reads: false });
    }

    /// The place of a slot: the action's own copy where it has one.
    pub(crate) fn own_place(&self, addr: u32, place: Expr) -> Expr {
        let own = self.deferred.as_ref().and_then(|d| {
            let slot = self.g.vars.slot(addr)?;
            d.own.get(&slot.start)
        });
        match (own, place) {
            (Some(name), Expr::Index(_, i)) => Expr::name(name.clone()).at(*i),
            (Some(name), _) => Expr::name(name.clone()),
            (None, place) => place,
        }
    }

    pub(crate) fn load(&mut self, addr: u32) -> Entry {
        self.g.reveal(addr);
        let Some(slot) = self.g.vars.slot(addr).cloned() else { return Entry::Word(0) };
        let declared = self.g.is_declared(addr);
        let place = self.own_place(addr, slot.place());
        match slot.shape {
            Shape::One(n) if declared => Entry::of(place, n),
            Shape::One(_) => Entry::Hidden(addr, place),
            Shape::Many(n, _) => Entry::of(place.at(Expr::size((addr - slot.start) as usize)), n),
            Shape::Fb(kind) => match members(kind).get((addr - slot.start) as usize) {
                Some((name, n)) => Entry::of(place.field(*name), *n),
                None => {
                    self.g.cannot("a table of function blocks");
                    Entry::Word(0)
                }
            },
            Shape::Text(_) | Shape::Texts(..) => {
                self.g.cannot("a word of a text");
                Entry::Word(0)
            }
        }
    }

    /// Notes that an action's own copy was written.
    pub(crate) fn wrote(&mut self, addr: u32, index: Option<Expr>) {
        let Some(d) = &self.deferred else { return };
        let Some(slot) = self.g.vars.slot(addr) else { return };
        let Some(own) = d.own.get(&slot.start) else { return };
        let flag = format!("{own}_set");
        let flag = match (slot.shape, index) {
            (Shape::Many(..), Some(i)) => Expr::name(flag).at(i),
            (Shape::Many(..) | Shape::Fb(_), None) => {
                Expr::name(flag).at(Expr::size((addr - slot.start) as usize))
            }
            (Shape::Texts(cap, _), _) => {
                Expr::name(flag).at(Expr::size(((addr - slot.start) / vars::text_words(cap)) as usize))
            }
            _ => Expr::name(flag),
        };
        self.out.push(Stmt::set(flag, Expr::Bool(true)));
    }
}
