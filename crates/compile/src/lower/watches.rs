//! Watches: the memories behind `↑e`, `↓e` and `t1/e/t2`.
//!
//! One expression of one period has one watch, however often it is written.
//! A watch is made after those it reads, so their order is topological. What
//! each reads is noted, so that the engine looks only at those that may have
//! changed.

use std::collections::HashMap;

use g7_engine::{Addr, Op, Rows, StepId as Number, Watch, WatchId};
use g7_model::Span;

use super::Lower;
use super::code::{Buf, Reads};
use super::lists::Lists;
use crate::ir::{Expr, ExprKind};

/// What makes two watches the same.
#[derive(PartialEq, Eq, Hash)]
struct Key {
    period: u32,
    code: Vec<Op>,
    times: Option<(Vec<Op>, Vec<Op>)>,
}

/// The watches made so far.
#[derive(Default)]
pub(super) struct Watches {
    known: HashMap<Key, WatchId>,
    /// Edges of a single word, by far the most.
    of_words: HashMap<(u32, Addr), WatchId>,
    /// By watch.
    reads: Vec<Reads>,
}

impl Lower<'_> {
    /// Pushes an edge of an expression.
    pub(super) fn edge(&mut self, b: &mut Buf, e: &Expr, op: fn(WatchId) -> Op, at: Span) {
        if matches!(e.kind, ExprKind::Const(_)) {
            return b.op(Op::Push(0), at); // it never changes
        }
        let mut code = self.buf(b.period);
        self.expr(&mut code, e);
        let watch = self.watch(code, None);
        b.reads.watches.push(watch);
        b.op(op(watch), at);
    }

    /// Pushes the output of a timer.
    pub(super) fn timer(&mut self, b: &mut Buf, t1: &Expr, e: &Expr, t2: Option<&Expr>, at: Span) {
        let mut code = self.buf(b.period);
        self.expr(&mut code, e);
        let mut on = self.buf(b.period);
        self.expr(&mut on, t1);
        let mut off = self.buf(b.period);
        match t2 {
            Some(t2) => self.expr(&mut off, t2),
            None => off.op(Op::Push(0), at),
        }
        self.timer_of(b, code, (on, off), at);
    }

    fn timer_of(&mut self, b: &mut Buf, code: Buf, times: (Buf, Buf), at: Span) {
        let watch = self.watch(code, Some(times));
        b.reads.watches.push(watch);
        b.op(Op::Timer(watch), at);
    }

    fn watch(&mut self, code: Buf, times: Option<(Buf, Buf)>) -> WatchId {
        let id = WatchId(self.t.watches.len() as u32);
        let known = match (code.ops.as_slice(), &times) {
            ([Op::Load(word)], None) => *self.watches.of_words.entry((code.period, *word)).or_insert(id),
            (ops, _) => {
                let times = times.as_ref().map(|(on, off)| (on.ops.clone(), off.ops.clone()));
                let key = Key { period: code.period, code: ops.to_vec(), times };
                *self.watches.known.entry(key).or_insert(id)
            }
        };
        if known != id {
            let (on, off) = times.unzip();
            [Some(code), on, off].into_iter().flatten().for_each(|b| self.drop_buf(b));
            return known;
        }
        let (mut code, mut times) = (code, times);
        let mut reads = std::mem::take(&mut code.reads);
        // A timer that runs goes by its times as they are now.
        if let Some((on, off)) = &mut times {
            reads.append(&mut on.reads);
            reads.append(&mut off.reads);
        }
        let period = code.period;
        let always = reads.time;
        let code = self.place(code);
        let times = times.map(|(on, off)| (self.place(on), self.place(off)));
        self.t.watches.push(Watch { code, times, always, period, watches: Rows::default() });
        self.watches.reads.push(reads);
        id
    }

    /// Tells every word, step, group and watch who watches it. Returns the lists
    /// of the steps.
    pub(super) fn readers(&mut self) -> Lists<WatchId> {
        let mut steps = Lists::default();
        let mut groups: Lists<WatchId> = Lists::default();
        let mut watches: Lists<WatchId> = Lists::default();
        let mut words: Vec<(Addr, WatchId)> = Vec::new();
        for (i, reads) in std::mem::take(&mut self.watches.reads).into_iter().enumerate() {
            let watch = WatchId(i as u32);
            words.extend(reads.words.into_iter().map(|w| (w, watch)));
            reads.steps.into_iter().for_each(|Number(s)| steps.add(s, watch));
            reads.groups.into_iter().for_each(|g| groups.add(g.0, watch));
            reads.watches.into_iter().for_each(|w| watches.add(w.0, watch));
        }
        words.sort_unstable();
        words.dedup();
        self.t.word_watches = words;
        groups.sort_unique();
        watches.sort_unique();
        steps.sort_unique();
        for (i, g) in self.t.groups.iter_mut().enumerate() {
            g.watches = groups.take(i as u32, &mut self.t.watch_lists);
        }
        for (i, w) in self.t.watches.iter_mut().enumerate() {
            w.watches = watches.take(i as u32, &mut self.t.watch_lists);
        }
        steps
    }
}
