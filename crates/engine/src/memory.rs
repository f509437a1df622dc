//! Reading and writing the variable area of a state.

use crate::bits::{set_bit, word};
use crate::ops::Addr;
use crate::program::Program;
use crate::state::State;

/// The value of a word of the variable area.
#[inline(always)]
pub(crate) fn read(s: &State, addr: Addr) -> u64 {
    word(&s.image, (s.vars + addr.0) as usize)
}

/// Writes a word of the variable area, and marks the watches that read it.
#[inline(always)]
pub(crate) fn write(p: &Program, s: &mut State, addr: Addr, value: u64) {
    // Parallel actions also conflict over a word that one of them leaves unchanged.
    if s.scratch.logging || read(s, addr) != value {
        change(p, s, addr, value);
    }
}

/// Writes a word that changes, or that an action gives.
fn change(p: &Program, s: &mut State, addr: Addr, value: u64) {
    let at = (s.vars + addr.0) as usize;
    let old = word(&s.image, at);
    let lasts = addr.0 < p.locals;
    if s.scratch.logging && lasts {
        log(s, addr, old);
    }
    if old == value {
        return;
    }
    if p.comes_and_goes && lasts {
        note(s, addr, old);
    }
    s.set(at, value);
    s.scratch.changed |= lasts;
    notice(p, s, addr);
}

/// Notes what a word was as the pass began, at the first write to it.
#[cold]
fn note(s: &mut State, addr: Addr, old: u64) {
    if !set_bit(&mut s.scratch.written_mark, 0, addr.0, true) {
        s.scratch.written.push((addr.0, old));
    }
}

/// Notes what a word was as the action began, at the first write to it.
fn log(s: &mut State, addr: Addr, old: u64) {
    let serial = s.scratch.serial;
    if let Some(mark) = s.scratch.log_mark.get_mut(addr.0 as usize)
        && *mark != serial
    {
        *mark = serial;
        s.scratch.log.push((addr.0, old));
    }
}

/// Marks the watches that read a word as to be evaluated, and wakes the steps that wait for it.
#[inline]
pub(crate) fn notice(p: &Program, s: &mut State, addr: Addr) {
    if s.scratch.rest.is_on() {
        p.sleepers.wake(&mut s.scratch.rest, addr);
    }
    if p.tables.word_watches.is_empty() {
        return;
    }
    let at = addr.0 as usize;
    let (Some(&from), Some(&to)) = (p.word_index.get(at), p.word_index.get(at + 1)) else { return };
    for (_, watch) in p.tables.word_watches.get(from as usize..to as usize).unwrap_or(&[]) {
        p.layout.dirty.insert(&mut s.image, watch.0);
    }
}

impl State {
    /// Writes a word of the variable area from outside (a forced or retained
    /// variable). Watches notice at the next scan. An address behind the area
    /// changes nothing.
    pub fn set_word(&mut self, p: &Program, addr: Addr, value: u64) {
        if addr.0 < self.var_words {
            self.scratch.quiet = false;
            self.scratch.worked = true;
            write(p, self, addr, value);
        }
    }
}
