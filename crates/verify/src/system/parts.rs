//! Parts of a chart that evolve by themselves within a scan.
//!
//! A pass gives a step a value that depends on some memories, these on others, and so on. The
//! memories that last among all of them are a part: while inputs and time stand still, its
//! content behind a pass follows from its content before it. If it comes back to what it was
//! and was something else in between, it never rests, whatever the rest of the chart does; and
//! if it comes back, further passes show nothing of it that was not there before.
//! That is so only if nothing but an endless search can end the scan: a chart with a fault in
//! its passes has no parts here.

use std::collections::{BTreeMap, BTreeSet};

use g7_equations::{Class, Equations, Expr, MemoryId, Stmt, What, expand};

/// Most parts that are told apart.
const PARTS: usize = 200;

/// A part of a chart.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Part {
    /// Its memories that last.
    pub(crate) memories: Vec<MemoryId>,
    /// Number of its steps.
    pub(crate) steps: usize,
}

/// The parts of the steps and of these memories, and for each of them its part; nothing where there
/// are too many.
pub(crate) fn parts(e: &Equations, also: &BTreeSet<MemoryId>) -> (Vec<Part>, BTreeMap<MemoryId, usize>) {
    let mut work = Work { e, reads: BTreeMap::new(), simple: true };
    e.pass.iter().for_each(|s| work.list(&s.body, &BTreeSet::new()));
    if !work.simple {
        return Default::default();
    }
    let steps = (0u32..).map(MemoryId).zip(&e.memories).filter(|(_, m)| matches!(m.what, What::Step(_)));
    let (mut list, mut of): (Vec<Part>, BTreeMap<MemoryId, usize>) = Default::default();
    let mut known = BTreeMap::new();
    for id in steps.map(|(id, _)| id).chain(also.iter().copied()) {
        let part = work.part(id);
        let at = *known.entry(part.clone()).or_insert(list.len());
        if at == list.len() {
            list.push(part);
        }
        of.insert(id, at);
        if list.len() > PARTS {
            return Default::default();
        }
    }
    (list, of)
}

struct Work<'a> {
    e: &'a Equations,
    /// For each memory that a pass writes: those that its new value depends on.
    reads: BTreeMap<MemoryId, BTreeSet<MemoryId>>,
    simple: bool,
}

impl Work<'_> {
    fn list(&mut self, list: &[Stmt], under: &BTreeSet<MemoryId>) {
        for s in list {
            match s {
                Stmt::Set(m, value) => self.set(*m, &[value], under),
                Stmt::SetElement(m, index, value) => self.set(*m, &[index, value], under),
                Stmt::If(condition, then, other) => {
                    let mut under = under.clone();
                    collect(condition, &mut under);
                    self.list(then, &under);
                    self.list(other, &under);
                }
                Stmt::Call(block, memories) => self.list(&expand(*block, memories), under),
                Stmt::Loop(_) | Stmt::Exit | Stmt::Fault(..) => self.simple = false,
                Stmt::About(_) => {}
            }
        }
    }

    fn set(&mut self, m: MemoryId, values: &[&Expr], under: &BTreeSet<MemoryId>) {
        let reads = self.reads.entry(m).or_default();
        reads.extend(under);
        values.iter().for_each(|v| collect(v, reads));
    }

    fn part(&self, step: MemoryId) -> Part {
        let mut seen = BTreeSet::from([step]);
        let mut work = vec![step];
        while let Some(m) = work.pop() {
            let reads = self.reads.get(&m).into_iter().flatten();
            work.extend(reads.filter(|r| seen.insert(**r)));
        }
        let lasts =
            |m: &MemoryId| self.e.memory(*m).is_some_and(|m| matches!(m.class, Class::Kept | Class::Output));
        let memories: Vec<MemoryId> = seen.into_iter().filter(lasts).collect();
        let is_step = |m: &&MemoryId| self.e.memory(**m).is_some_and(|m| matches!(m.what, What::Step(_)));
        let steps = memories.iter().filter(is_step).count();
        Part { memories, steps }
    }
}

fn collect(e: &Expr, into: &mut BTreeSet<MemoryId>) {
    e.visit(&mut |e| {
        if let Expr::Read(m) | Expr::Element(m, _) = e {
            into.insert(*m);
        }
    });
}
