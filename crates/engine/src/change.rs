//! Activation and deactivation of steps, with all that follows from them.
//!
//! A pass first *marks* the steps to be activated and deactivated (by clearing,
//! forcing or requests). Then [`commit`] applies rule 5, enclosures and stored
//! actions, and switches the steps. All marks are gone when it returns.

use crate::bits::{bit, set_bit, word};
use crate::blocks;
use crate::fault::Fault;
use crate::memory::{read, write};
use crate::ops::{Addr, StepId};
use crate::program::Program;
use crate::run::{condition, run};
use crate::state::State;
use crate::tables::{Extra, NONE, Rows};
use crate::watch::mark as mark_watches;

/// Marks a step to be activated.
#[inline(always)]
pub(crate) fn mark_on(s: &mut State, step: StepId) {
    if mark_bit(&mut s.scratch.on_mark, step.0) {
        s.scratch.on.push(step.0);
    }
}

/// Marks a step to be deactivated.
#[inline(always)]
pub(crate) fn mark_off(s: &mut State, step: StepId) {
    if mark_bit(&mut s.scratch.off_mark, step.0) {
        s.scratch.off.push(step.0);
    }
}

/// Sets a mark; tells whether it is new.
#[inline(always)]
fn mark_bit(marks: &mut [u64], i: u32) -> bool {
    match marks.get_mut((i / 64) as usize) {
        Some(w) => {
            let mask = 1u64 << (i % 64);
            let new = *w & mask == 0;
            *w |= mask;
            new
        }
        None => false,
    }
}

#[inline(always)]
fn unmark(marks: &mut [u64], i: u32) {
    if let Some(w) = marks.get_mut((i / 64) as usize) {
        *w &= !(1u64 << (i % 64));
    }
}

#[inline(always)]
pub(crate) fn marked(marks: &[u64], i: u32) -> bool {
    bit(marks, 0, i)
}

/// Makes the marked changes, with everything that follows from them.
pub(crate) fn commit(p: &Program, s: &mut State) -> Result<(), Fault> {
    if p.has_hierarchy {
        cascade(p, s);
    }
    carry_out(p, s)
}

/// Makes the marked changes and no others, with their stored actions.
pub(crate) fn carry_out(p: &Program, s: &mut State) -> Result<(), Fault> {
    if p.stored > 0 {
        gather(p, s);
    }
    let before = p.tables.rules.parallel_actions && !s.scratch.runs.is_empty();
    if before {
        run_parallel(p, s)?;
    }
    apply(p, s);
    if p.tables.rules.parallel_actions {
        write_commits(p, s);
        Ok(())
    } else {
        run_ordered(p, s)
    }
}

/// Enclosed charts follow their enclosing steps, through all levels.
pub(crate) fn cascade(p: &Program, s: &mut State) {
    let mut k = 0;
    while let Some(&step) = s.scratch.off.get(k) {
        k += 1;
        if marked(&s.scratch.on_mark, step) || !s.steps.contains(&s.image, step) {
            continue;
        }
        let Some(e) = p.extra(step) else { continue };
        for g in p.tables.group_lists.get(e.encloses.start as usize..e.encloses.end as usize).unwrap_or(&[]) {
            let Some(group) = p.tables.groups.get(g.0 as usize) else { continue };
            if drop_activations(s, group.steps) {
                k = 0;
            }
            let mut from = group.steps.start;
            while let Some(i) = s.steps.next(&s.image, from).filter(|i| *i < group.steps.end) {
                mark_off(s, StepId(i));
                from = i + 1;
            }
        }
    }
    let mut k = 0;
    while let Some(&step) = s.scratch.on.get(k) {
        k += 1;
        if !marked(&s.scratch.on_mark, step) || s.steps.contains(&s.image, step) {
            continue;
        }
        let Some(e) = p.extra(step) else { continue };
        for link in p.tables.arcs.get(e.links.start as usize..e.links.end as usize).unwrap_or(&[]) {
            mark_on(s, *link);
        }
    }
}

/// Drops the activations in a group that is being emptied. Tells whether a step is
/// deactivated by this that would have stayed active: then the groups that it
/// encloses must be looked at again.
fn drop_activations(s: &mut State, steps: Rows) -> bool {
    let mut goes = false;
    for j in 0..s.scratch.on.len() {
        let Some(&i) = s.scratch.on.get(j) else { break };
        if (steps.start..steps.end).contains(&i) && marked(&s.scratch.on_mark, i) {
            unmark(&mut s.scratch.on_mark, i);
            goes |= marked(&s.scratch.off_mark, i);
        }
    }
    goes
}

/// Collects the stored actions of the marked changes.
fn gather(p: &Program, s: &mut State) {
    for k in 0..s.scratch.off.len() {
        let Some(&step) = s.scratch.off.get(k) else { break };
        if let Some(e) = p.extra(step)
            && !e.off.is_empty()
            && !marked(&s.scratch.on_mark, step)
            && s.steps.contains(&s.image, step)
        {
            add_runs(p, s, e.off);
        }
    }
    for k in 0..s.scratch.on.len() {
        let Some(&step) = s.scratch.on.get(k) else { break };
        if let Some(e) = p.extra(step)
            && !e.on.is_empty()
            && marked(&s.scratch.on_mark, step)
            && !s.steps.contains(&s.image, step)
            // Enclosures can mark a step twice, and then it stands in the list twice.
            && !s.scratch.on.get(..k).unwrap_or(&[]).contains(&step)
        {
            add_runs(p, s, e.on);
        }
    }
}

/// Collects the actions of a step that is activated or deactivated, to run in this
/// pass or, under `late_actions`, at the end of the scan.
pub(crate) fn add_runs(p: &Program, s: &mut State, rows: Rows) {
    for &action in p.tables.action_lists.get(rows.start as usize..rows.end as usize).unwrap_or(&[]) {
        if p.tables.rules.late_actions {
            set_bit(&mut s.scratch.late, 0, action, true);
            s.scratch.late_any = true;
        } else {
            s.scratch.runs.push(action);
        }
    }
}

/// Activates and deactivates the marked steps, and clears the marks.
fn apply(p: &Program, s: &mut State) {
    s.scratch.emptied.clear();
    for k in 0..s.scratch.off.len() {
        let Some(&step) = s.scratch.off.get(k) else { break };
        unmark(&mut s.scratch.off_mark, step);
        if !marked(&s.scratch.on_mark, step) && s.steps.contains(&s.image, step) {
            deactivate(p, s, step);
        }
    }
    s.scratch.off.clear();
    for k in 0..s.scratch.on.len() {
        let Some(&step) = s.scratch.on.get(k) else { break };
        if marked(&s.scratch.on_mark, step) {
            unmark(&mut s.scratch.on_mark, step);
            if !s.steps.contains(&s.image, step) {
                activate(p, s, step);
            }
        }
    }
    s.scratch.on.clear();
}

/// Notes whether a step was active as the pass began, at its first change in it.
#[cold]
fn turn(s: &mut State, step: u32, was: bool) {
    if !set_bit(&mut s.scratch.turned, 0, step, true) {
        set_bit(&mut s.scratch.was, 0, step, was);
        s.scratch.turns.push(step);
    }
}

#[inline]
pub(crate) fn activate(p: &Program, s: &mut State, step: u32) {
    s.scratch.changed = true;
    s.scratch.stepped = true;
    s.scratch.moved += 1;
    s.scratch.lone = NONE;
    let tree = s.steps;
    if p.looks_back {
        turn(s, step, false);
    }
    tree.insert(&mut s.image, step);
    s.scratch.rest.stir(step);
    let now = s.clock(p) as u64;
    s.set(p.layout.stamp(step) as usize, now);
    if p.tables.rules.scan_clock {
        s.set(p.layout.age(step) as usize, s.now() as u64);
    }
    let Some(row) = p.tables.steps.get(step as usize) else { return };
    if row.direct.0 != NONE {
        s.set((s.vars + row.direct.0) as usize, 1);
    }
    if row.extra != NONE
        && let Some(e) = p.tables.extras.get(row.extra as usize)
    {
        s.scratch.moved -= u32::from(e.uncounted);
        carry_on(p, s, e);
    }
}

#[inline]
pub(crate) fn deactivate(p: &Program, s: &mut State, step: u32) {
    s.scratch.changed = true;
    s.scratch.stepped = true;
    s.scratch.moved += 1;
    s.scratch.lone = NONE;
    let tree = s.steps;
    if p.looks_back {
        turn(s, step, true);
    }
    tree.remove(&mut s.image, step);
    let at = p.layout.stamp(step) as usize;
    let gone =
        if p.tables.rules.keep_step_time { s.clock(p).wrapping_sub(word(&s.image, at) as i64) } else { 0 };
    s.set(at, gone as u64);
    if p.tables.rules.scan_clock {
        let at = p.layout.age(step) as usize;
        let age = s.now().wrapping_sub(word(&s.image, at) as i64);
        s.set(at, if p.tables.rules.keep_step_time { age as u64 } else { 0 });
    }
    let Some(row) = p.tables.steps.get(step as usize) else { return };
    if row.direct.0 != NONE {
        s.set((s.vars + row.direct.0) as usize, 0);
    }
    if row.extra != NONE
        && let Some(e) = p.tables.extras.get(row.extra as usize)
    {
        s.scratch.moved -= u32::from(e.uncounted);
        carry_off(p, s, e);
    }
}

/// Updates the counts and sets that follow a step that has become active.
fn carry_on(p: &Program, s: &mut State, e: &Extra) {
    let l = &p.layout;
    for row in e.contributions.start..e.contributions.end {
        if !blocks::give(p, &mut s.image, row, true) && !p.gates.has(row) {
            l.conditions.insert(&mut s.image, row);
        }
    }
    if !e.groups.is_empty() {
        count_groups(p, s, e, true);
    }
    for i in e.events.start..e.events.end {
        l.events.insert(&mut s.image, i);
    }
    for i in e.periodics.start..e.periodics.end {
        l.periodics.insert(&mut s.image, i);
    }
    for i in e.orders.start..e.orders.end {
        l.orders.insert(&mut s.image, i);
    }
    mark_watches(p, &mut s.image, e.watches);
}

/// Updates the counts and sets that follow a step that has become inactive.
fn carry_off(p: &Program, s: &mut State, e: &Extra) {
    let l = &p.layout;
    for row in e.contributions.start..e.contributions.end {
        if blocks::give(p, &mut s.image, row, false) {
            continue;
        }
        if p.gates.has(row) {
            p.gates.close(l, &mut s.image, row);
            continue;
        }
        l.conditions.remove(&mut s.image, row);
        if set_bit(&mut s.image, l.counted, row, false)
            && let Some(c) = p.tables.contributions.get(row as usize)
        {
            blocks::count(p, &mut s.image, c.block, c.input, false);
        }
    }
    if !e.groups.is_empty() {
        count_groups(p, s, e, false);
    }
    for i in e.events.start..e.events.end {
        l.events.remove(&mut s.image, i);
    }
    for i in e.periodics.start..e.periodics.end {
        l.periodics.remove(&mut s.image, i);
    }
    for i in e.orders.start..e.orders.end {
        l.orders.remove(&mut s.image, i);
    }
    mark_watches(p, &mut s.image, e.watches);
}

/// Counts an active step in its groups.
fn count_groups(p: &Program, s: &mut State, e: &Extra, on: bool) {
    for g in p.tables.group_lists.get(e.groups.start as usize..e.groups.end as usize).unwrap_or(&[]) {
        let at = p.layout.groups as usize + g.0 as usize;
        let old = word(&s.image, at);
        let new = if on { old.wrapping_add(1) } else { old.saturating_sub(1) };
        s.set(at, new);
        if (old == 0) == (new == 0) {
            continue;
        }
        stamp_group(p, s, g.0, new != 0);
        if let Some(group) = p.tables.groups.get(g.0 as usize) {
            mark_watches(p, &mut s.image, group.watches);
        }
    }
}

/// Notes when a group became active, or how long it was. A group that loses its last
/// step and gets another one in the same change was active without a break.
fn stamp_group(p: &Program, s: &mut State, group: u32, on: bool) {
    let l = &p.layout;
    let (stamp, age) = ((l.group_stamps + group) as usize, (l.group_ages + group) as usize);
    let (clock, now) = (s.clock(p) as u64, s.now() as u64);
    let old = (word(&s.image, stamp), word(&s.image, age));
    let new = if on {
        let kept = s.scratch.emptied.iter().rev().find(|e| e.0 == group);
        kept.map_or((clock, now), |e| e.1)
    } else {
        if s.scratch.emptied.len() < s.scratch.emptied.capacity() {
            s.scratch.emptied.push((group, old));
        }
        let keep = p.tables.rules.keep_step_time;
        if keep { (clock.wrapping_sub(old.0), now.wrapping_sub(old.1)) } else { (0, 0) }
    };
    s.set(age, new.1);
    s.set(stamp, new.0);
}

/// Runs one action where its condition holds and its period is due.
pub(crate) fn run_action(p: &Program, s: &mut State, action: u32) -> Result<(), Fault> {
    let Some(a) = p.tables.actions.get(action as usize) else { return Ok(()) };
    if s.is_due(p, a.period) && condition(p, s, a.condition)? {
        if s.scratch.ran.len() < s.scratch.ran.capacity() {
            s.scratch.ran.push(action);
        }
        run(p, s, a.body)?;
    }
    Ok(())
}

/// Runs the collected actions one after the other, each seeing the earlier ones.
pub(crate) fn run_ordered(p: &Program, s: &mut State) -> Result<(), Fault> {
    if s.scratch.runs.is_empty() {
        return Ok(());
    }
    s.scratch.runs.sort_unstable();
    for k in 0..s.scratch.runs.len() {
        let Some(&action) = s.scratch.runs.get(k) else { break };
        run_action(p, s, action)?;
    }
    s.scratch.runs.clear();
    Ok(())
}

/// Runs the collected actions on the values from before the pass: the writes of each
/// are noted and taken back, for [`write_commits`] to make.
fn run_parallel(p: &Program, s: &mut State) -> Result<(), Fault> {
    s.scratch.runs.sort_unstable();
    for k in 0..s.scratch.runs.len() {
        let Some(&action) = s.scratch.runs.get(k) else { break };
        s.scratch.serial = s.scratch.serial.wrapping_add(1).max(1);
        s.scratch.log.clear();
        s.scratch.logging = true;
        let was_changed = s.scratch.changed;
        let done = run_action(p, s, action);
        s.scratch.logging = false;
        done?;
        s.scratch.changed = was_changed;
        for i in 0..s.scratch.log.len() {
            let Some(&(addr, old)) = s.scratch.log.get(i) else { break };
            let new = read(s, Addr(addr));
            s.scratch.commits.push((addr, new));
            s.set((s.vars + addr) as usize, old);
        }
    }
    s.scratch.runs.clear();
    Ok(())
}

/// Makes the noted writes. Of two that disagree the later one wins, and the report
/// names the word. A word that ends as it was counts as unchanged.
fn write_commits(p: &Program, s: &mut State) {
    if s.scratch.commits.is_empty() {
        return;
    }
    s.scratch.pass_serial = s.scratch.pass_serial.wrapping_add(1).max(1);
    let serial = s.scratch.pass_serial;
    let mut conflict = None;
    while let Some((addr, new)) = s.scratch.commits.pop() {
        let mark = s.scratch.commit_mark.get_mut(addr as usize);
        if mark.is_none_or(|mark| core::mem::replace(mark, serial) != serial) {
            write(p, s, Addr(addr), new);
        } else if read(s, Addr(addr)) != new {
            conflict = Some(Addr(addr));
        }
    }
    s.scratch.conflict = s.scratch.conflict.or(conflict);
}
