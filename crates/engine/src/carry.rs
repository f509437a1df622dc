//! An on-line change: a new program takes over where an old one stands.
//!
//! The caller says which parts are the same in both, since names are not known here.
//! A part without a partner begins as in a new state. The change itself causes no
//! edge and runs no stored action.

use alloc::vec::Vec;

use crate::bits::{bit, word};
use crate::block_words::{BLOCK, MEMORY, WRITTEN};
use crate::fault::Fault;
use crate::layout::{STARTED, head};
use crate::memory::read;
use crate::ops::{Addr, GroupId, StepId};
use crate::program::Program;
use crate::scan::set_step;
use crate::state::State;
use crate::tables::{Contribution, NONE};

/// The common parts of two programs, in pairs with the new one first.
#[derive(Clone, Debug, Default)]
pub struct Common<'a> {
    /// Words of the variable area.
    pub words: &'a [(Addr, Addr)],
    /// Steps.
    pub steps: &'a [(StepId, StepId)],
    /// Steps of the new program that become active, in charts without a partner.
    pub begin: &'a [StepId],
    /// Groups whose time goes on.
    pub groups: &'a [(GroupId, GroupId)],
    /// Control blocks of variables and named bodies. The others are found by their
    /// steps.
    pub blocks: &'a [(u32, u32)],
}

/// Makes the state in which a new program goes on. Returns it with the number of
/// delays `t1/e/t2` that were running or over in the old one, since these begin anew.
///
/// # Errors
///
/// A [`Fault`] of a watched expression, evaluated on the new state.
pub fn carry(p: &Program, old: (&Program, &State), common: &Common<'_>) -> Result<(State, u32), Fault> {
    let (was, from) = old;
    let mut s = State::new(p);
    for at in [head::NOW, head::DT, head::SCANS] {
        s.set(at, word(&from.image, at));
    }
    s.set_flag(STARTED, from.is_started());
    for (new, old) in common.words {
        s.set_word(p, *new, from.word(*old));
    }
    // A block writes its variable where Q differs from the value written last.
    for (b, row) in (0u32..).zip(&p.tables.blocks).filter(|(b, _)| !p.gates.stands_for(*b)) {
        if row.output.0 != NONE && read(&s, row.output) != 0 {
            crate::blocks::take_as_written(p, &mut s, b);
        }
        p.layout.blocks.insert(&mut s.image, b);
    }
    for (new, old) in common.steps {
        set_step(p, &mut s, *new, from.is_active(*old));
        stamps(p, &mut s, (p.layout.stamp(new.0), p.layout.age(new.0)), was, from, {
            (was.layout.stamp(old.0), was.layout.age(old.0))
        });
    }
    for step in common.begin {
        set_step(p, &mut s, *step, true);
    }
    for step in (0u32..).zip(&p.tables.steps).filter(|(_, row)| row.direct.0 != NONE).map(|(i, _)| StepId(i))
    {
        let on = u64::from(s.is_active(step));
        if let Some(row) = p.tables.steps.get(step.0 as usize) {
            s.set((s.vars + row.direct.0) as usize, on);
        }
    }
    p.gates.carry(&p.layout, &mut s.image);
    for (new, old) in common.groups {
        if s.group_active(p, *new) == from.group_active(was, *old) {
            stamps(p, &mut s, (p.layout.group_stamps + new.0, p.layout.group_ages + new.0), was, from, {
                (was.layout.group_stamps + old.0, was.layout.group_ages + old.0)
            });
        }
    }
    blocks(p, &mut s, was, from, common);
    // A timer that runs takes the time of the new program.
    for step in s.active().collect::<Vec<_>>() {
        crate::blocks::set_times(p, &mut s.image, step);
    }
    crate::watch::update(p, &mut s, true, true)?;
    s.scratch.quiet = false;
    s.scratch.any_blocked = false;
    Ok((s, delays(was, from)))
}

/// Takes over the time of a step or a group, where both programs count in one unit. A time that
/// the old program does not keep begins with the change.
fn stamps(p: &Program, s: &mut State, to: (u32, u32), was: &Program, from: &State, at: (u32, u32)) {
    if at.1 == NONE {
        return;
    }
    let age = word(&from.image, at.1 as usize);
    if p.tables.rules.scan_clock == was.tables.rules.scan_clock {
        s.set(to.0 as usize, word(&from.image, at.0 as usize));
    } else if !p.tables.rules.scan_clock {
        s.set(to.0 as usize, age);
    }
    s.set(to.1 as usize, age);
}

/// Takes over the memory of control blocks: set and reset, pulses, timers.
fn blocks(p: &Program, s: &mut State, was: &Program, from: &State, common: &Common<'_>) {
    for (new, old) in common.blocks {
        block(p, s, was, from, (*new, *old));
    }
    // Blocks of bodies without a name are found by the steps that they belong to.
    for (new, old) in common.steps {
        let (Some(a), Some(b)) = (inputs(p, *new), inputs(was, *old)) else { continue };
        let same = a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.input == b.input);
        for (a, b) in a.iter().zip(b).filter(|_| same) {
            if !common.blocks.iter().any(|(new, _)| *new == a.block) {
                block(p, s, was, from, (a.block, b.block));
            }
        }
    }
}

fn inputs(p: &Program, step: StepId) -> Option<&[Contribution]> {
    let extra = p.extra(step.0)?;
    p.tables.contributions.get(extra.contributions.start as usize..extra.contributions.end as usize)
}

fn block(p: &Program, s: &mut State, was: &Program, from: &State, (new, old): (u32, u32)) {
    let full = |p: &Program, b: u32| p.tables.blocks.get(b as usize).is_some_and(|b| !b.plain);
    let (Some(to), Some(at)) = (p.layout.block_at.get(new as usize), was.layout.block_at.get(old as usize))
    else {
        return;
    };
    if full(p, new) && full(was, old) {
        // The bit of the value written last belongs to the new variable.
        let written = word(&s.image, (to + MEMORY) as usize) & WRITTEN;
        for k in MEMORY..BLOCK {
            s.set((to + k) as usize, word(&from.image, (at + k) as usize));
        }
        let memory = word(&s.image, (to + MEMORY) as usize) & !WRITTEN;
        s.set((to + MEMORY) as usize, memory | written);
    }
}

/// Number of the delays that were running or over.
fn delays(p: &Program, s: &State) -> u32 {
    let timers = (0u32..).zip(&p.tables.watches).filter(|(_, w)| w.times.is_some());
    timers.filter(|(i, _)| bit(&s.image, p.layout.q, *i) || p.layout.running.contains(&s.image, *i)).count()
        as u32
}
