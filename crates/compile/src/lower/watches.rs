//! Watches: the memories behind `↑e`, `↓e` and `t1/e/t2`.
//!
//! One expression of one period has one watch, however often it is written.
//! A watch is made after those it reads, so their order is topological. What
//! each reads is noted, so that the engine looks only at those that may have
//! changed.

use g7_engine::{Addr, Rows, StepId as Number, Watch, WatchId};
use g7_model::{Span, Type};

use super::lists::Lists;
use super::watched::{Key, Reads};
use super::work::Lower;
use crate::ir;
use crate::tree::{Expr, ExprKind};

impl Lower<'_> {
    /// An edge of an expression.
    pub(super) fn edge(
        &mut self,
        period: u32,
        e: &ir::Expr,
        edge: fn(WatchId) -> ExprKind,
        at: Span,
    ) -> Expr {
        if matches!(e.kind, ir::ExprKind::Const(_)) {
            return Expr::truth(false, at); // it never changes
        }
        let watched = self.expr(period, e);
        let watch = self.watch(period, watched, None);
        Expr::new(edge(watch), at)
    }

    /// The output of a timer.
    pub(super) fn timer(
        &mut self,
        period: u32,
        t1: &ir::Expr,
        e: &ir::Expr,
        t2: Option<&ir::Expr>,
        at: Span,
    ) -> Expr {
        let watched = self.expr(period, e);
        let on = self.expr(period, t1);
        let off =
            t2.map_or_else(|| Expr::new(ExprKind::Const(Type::Time, 0), at), |t2| self.expr(period, t2));
        let watch = self.watch(period, watched, Some((on, off)));
        Expr::new(ExprKind::Timer(watch), at)
    }

    fn watch(&mut self, period: u32, watched: Expr, times: Option<(Expr, Expr)>) -> WatchId {
        let id = WatchId(self.t.watches.len() as u32);
        let known = match (&watched.kind, &times) {
            (ExprKind::Word(_, word), None) => *self.watches.of_words.entry((period, *word)).or_insert(id),
            _ => {
                let code = self.ops(&watched);
                let times = times.as_ref().map(|(on, off)| (self.ops(on), self.ops(off)));
                *self.watches.known.entry(Key { period, code, times }).or_insert(id)
            }
        };
        if known != id {
            return known;
        }
        let mut reads = Reads::default();
        reads.add(&watched, self.locals);
        // A timer that runs goes by its times as they are now.
        if let Some((on, off)) = &times {
            reads.add(on, self.locals);
            reads.add(off, self.locals);
        }
        let always = reads.time;
        let code = self.value(watched);
        let times = times.map(|(on, off)| (self.value(on), self.value(off)));
        self.t.watches.push(Watch { code, times, always, period, watches: Rows::default() });
        self.watches.reads.push(reads);
        id
    }

    /// Tells every word, step, group and watch who watches it. Returns the lists
    /// of the steps.
    #[inline(never)]
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
