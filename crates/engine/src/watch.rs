//! Watches: the memories behind `↑e`, `↓e` and `t1/e/t2`.
//!
//! `↑e` compares `e` at the start of this pass with `e` at the start of the
//! preceding one, whether or not the transition that reads it is enabled. So
//! every `e` has a memory of its own; but a pass looks only at those whose
//! operands changed (or that read a time), not at all of them.

use crate::bits::{bit, set_bit, word};
use crate::fault::Fault;
use crate::run::value;
use crate::state::{State, head};
use crate::{Code, Program, Rows, Watch};

/// Brings the watches up to date at the start of a pass.
///
/// `first`: the first pass of a scan, when time has moved on. `fresh`: the very
/// first scan, in which nothing is an edge.
pub(crate) fn update(p: &Program, s: &mut State, first: bool, fresh: bool) -> Result<(), Fault> {
    if p.t.watches.is_empty() {
        return Ok(());
    }
    let l = &p.layout;
    forget_edges(p, s);
    if fresh {
        for i in 0..p.t.watches.len() as u32 {
            l.dirty.insert(&mut s.w, i);
        }
    } else if first {
        for &i in &p.always {
            l.dirty.insert(&mut s.w, i);
        }
        let mut from = 0;
        while let Some(i) = l.running.next(&s.w, from) {
            l.dirty.insert(&mut s.w, i);
            from = i + 1;
        }
    }
    let mut from = 0;
    while let Some(i) = l.dirty.next(&s.w, from) {
        from = i + 1;
        let Some(w) = p.t.watches.get(i as usize) else { break };
        if !is_due(p, s, w.period) {
            continue;
        }
        l.dirty.remove(&mut s.w, i);
        let now = value(p, s, w.code)? != 0;
        match w.times {
            None => edge(p, s, i, w, now, fresh),
            Some(times) => timer(p, s, i, w, now, times)?,
        }
    }
    Ok(())
}

/// Whether a period's charts evolve in this scan.
#[inline(always)]
pub(crate) fn is_due(p: &Program, s: &State, period: u32) -> bool {
    !p.has_periods || s.x.due.get(period as usize).copied().unwrap_or(true)
}

/// Edges live one pass (of their own charts).
fn forget_edges(p: &Program, s: &mut State) {
    let l = &p.layout;
    let mut from = 0;
    while let Some(i) = l.edged.next(&s.w, from) {
        from = i + 1;
        let Some(w) = p.t.watches.get(i as usize) else { break };
        if is_due(p, s, w.period) {
            l.edged.remove(&mut s.w, i);
            set_bit(&mut s.w, l.rise, i, false);
            set_bit(&mut s.w, l.fall, i, false);
            mark(p, s, w.watches);
        }
    }
}

fn edge(p: &Program, s: &mut State, i: u32, w: &Watch, now: bool, fresh: bool) {
    let l = &p.layout;
    let before = set_bit(&mut s.w, l.value, i, now);
    if before != now && !fresh {
        set_bit(&mut s.w, if now { l.rise } else { l.fall }, i, true);
        l.edged.insert(&mut s.w, i);
        mark(p, s, w.watches);
    }
}

/// The condition is sampled first: where it fell before the timer was seen to
/// be due, the timer never came true.
fn timer(p: &Program, s: &mut State, i: u32, w: &Watch, e: bool, times: (Code, Code)) -> Result<(), Fault> {
    let l = &p.layout;
    let before = set_bit(&mut s.w, l.value, i, e);
    let q = bit(&s.w, l.q, i);
    let now = word(&s.w, head::NOW) as i64;
    if e != before {
        if e == q {
            l.running.remove(&mut s.w, i);
            s.set((l.start + i) as usize, 0);
        } else {
            s.set((l.start + i) as usize, now as u64);
            l.running.insert(&mut s.w, i);
        }
    }
    if !l.running.contains(&s.w, i) {
        return Ok(());
    }
    // The time is taken as it is now, like PT of a TON.
    let t = value(p, s, if e { times.0 } else { times.1 })? as i64;
    let start = word(&s.w, (l.start + i) as usize) as i64;
    if now >= start.saturating_add(t.max(0)) {
        l.running.remove(&mut s.w, i);
        s.set((l.start + i) as usize, 0);
        set_bit(&mut s.w, l.q, i, e);
        mark(p, s, w.watches);
    }
    Ok(())
}

/// Marks watches that read something that changed.
pub(crate) fn mark(p: &Program, s: &mut State, rows: Rows) {
    for w in p.t.watch_lists.get(rows.start as usize..rows.end as usize).unwrap_or(&[]) {
        p.layout.dirty.insert(&mut s.w, w.0);
    }
}
