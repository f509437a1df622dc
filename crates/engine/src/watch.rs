//! Watches: the memories behind `↑e`, `↓e` and `t1/e/t2`.
//!
//! `↑e` compares `e` at the start of this pass with `e` at the start of the preceding
//! one, whether or not the transition that reads it is enabled. So every `e` has a
//! memory of its own. A pass evaluates only those that read a time or whose operands
//! have changed.

use crate::bits::{Walk, bit, set_bit, word};
use crate::fault::Fault;
use crate::layout::head;
use crate::ops::Code;
use crate::program::Program;
use crate::run::value;
use crate::state::State;
use crate::tables::{Rows, Watch};

/// Brings the watches up to date at the start of a pass.
///
/// `first` says that it is the first pass of a scan, so that time has gone on; `fresh`
/// that it is the first scan, in which there are no edges.
pub(crate) fn update(p: &Program, s: &mut State, first: bool, fresh: bool) -> Result<(), Fault> {
    if p.tables.watches.is_empty() {
        return Ok(());
    }
    let l = &p.layout;
    let State { image, scratch, .. } = s;
    forget_edges(p, image, |period| {
        !p.has_periods || scratch.due.get(period as usize).copied().unwrap_or(true)
    });
    if fresh {
        for i in 0..p.tables.watches.len() as u32 {
            l.dirty.insert(&mut s.image, i);
        }
    } else if first {
        for &i in &p.always {
            l.dirty.insert(&mut s.image, i);
        }
        let mut walk = Walk::new(&l.running, &s.image);
        while let Some(i) = walk.next(&l.running, &s.image) {
            l.dirty.insert(&mut s.image, i);
        }
    }
    // An edge makes watches behind it dirty, so the set is searched anew each time.
    let mut from = 0;
    while !l.dirty.is_empty(&s.image)
        && let Some(i) = l.dirty.next(&s.image, from)
    {
        from = i + 1;
        let Some(w) = p.tables.watches.get(i as usize) else { break };
        if !s.is_due(p, w.period) {
            continue;
        }
        l.dirty.remove(&mut s.image, i);
        let now = value(p, s, w.code)? != 0;
        match w.times {
            None => edge(p, s, i, w, now, fresh),
            Some(times) => timer(p, s, i, w, now, times)?,
        }
    }
    Ok(())
}

/// Ends the edges whose period is due: an edge lives one pass of its own charts.
pub(crate) fn forget_edges(p: &Program, image: &mut [u64], is_due: impl Fn(u32) -> bool) {
    let l = &p.layout;
    let mut walk = Walk::new(&l.edged, image);
    while let Some(i) = walk.next(&l.edged, image) {
        let Some(w) = p.tables.watches.get(i as usize) else { break };
        if is_due(w.period) {
            l.edged.remove(image, i);
            set_bit(image, l.rise, i, false);
            set_bit(image, l.fall, i, false);
            mark(p, image, w.watches);
        }
    }
}

fn edge(p: &Program, s: &mut State, i: u32, w: &Watch, now: bool, fresh: bool) {
    let l = &p.layout;
    let before = set_bit(&mut s.image, l.value, i, now);
    if before != now && !fresh {
        set_bit(&mut s.image, if now { l.rise } else { l.fall }, i, true);
        l.edged.insert(&mut s.image, i);
        mark(p, &mut s.image, w.watches);
    }
}

/// Brings a timer up to date. Its expression is judged before the time: where it fell
/// before the timer was seen to be due, the output never became true.
fn timer(p: &Program, s: &mut State, i: u32, w: &Watch, e: bool, times: (Code, Code)) -> Result<(), Fault> {
    let l = &p.layout;
    let before = set_bit(&mut s.image, l.value, i, e);
    let q = bit(&s.image, l.q, i);
    let now = word(&s.image, head::NOW) as i64;
    if e != before {
        if e == q {
            l.running.remove(&mut s.image, i);
            s.set((l.start + i) as usize, 0);
        } else {
            s.set((l.start + i) as usize, now as u64);
            l.running.insert(&mut s.image, i);
        }
    }
    if !l.running.contains(&s.image, i) {
        return Ok(());
    }
    // The time to wait is the one of now, as with PT of a TON.
    let t = value(p, s, if e { times.0 } else { times.1 })? as i64;
    let start = word(&s.image, (l.start + i) as usize) as i64;
    if now >= start.saturating_add(t.max(0)) {
        l.running.remove(&mut s.image, i);
        s.set((l.start + i) as usize, 0);
        set_bit(&mut s.image, l.q, i, e);
        mark(p, &mut s.image, w.watches);
    }
    Ok(())
}

/// Marks watches as to be evaluated, since something that they read has changed.
#[inline]
pub(crate) fn mark(p: &Program, image: &mut [u64], rows: Rows) {
    if rows.is_empty() {
        return;
    }
    for w in p.tables.watch_lists.get(rows.start as usize..rows.end as usize).unwrap_or(&[]) {
        p.layout.dirty.insert(image, w.0);
    }
}
