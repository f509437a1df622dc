//! Changing steps: marks, hierarchy, stored actions, and what activity carries.
//!
//! A pass first *marks* which steps go on and off (clearing, forcing, requests),
//! then [`commit`] draws the consequences: rule 5, enclosed charts, stored
//! actions, the step bits themselves. All marks are gone when it returns.

use crate::bits::{bit, set_bit, word};
use crate::fault::Fault;
use crate::run::{clock, condition, read, run, write};
use crate::state::State;
use crate::watch::{is_due, mark as mark_watches};
use crate::{Addr, Extra, NONE, Program, Rows, StepId};

/// Marks a step to be activated.
#[inline(always)]
pub(crate) fn mark_on(s: &mut State, step: StepId) {
    if mark_bit(&mut s.x.on_mark, step.0) {
        s.x.on.push(step.0);
    }
}

/// Marks a step to be deactivated.
#[inline(always)]
pub(crate) fn mark_off(s: &mut State, step: StepId) {
    if mark_bit(&mut s.x.off_mark, step.0) {
        s.x.off.push(step.0);
    }
}

/// Sets a mark; whether it is new.
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

#[inline(always)]
pub(crate) fn extra(p: &Program, step: u32) -> Option<&Extra> {
    let row = p.t.steps.get(step as usize)?.extra;
    if row == NONE { None } else { p.t.extras.get(row as usize) }
}

/// Makes the marked changes, with everything that follows from them.
pub(crate) fn commit(p: &Program, s: &mut State) -> Result<(), Fault> {
    if p.has_hierarchy {
        cascade(p, s);
    }
    if p.stored > 0 {
        gather(p, s);
    }
    let before = p.t.rules.parallel_actions && !s.x.runs.is_empty();
    if before {
        run_parallel(p, s)?;
    }
    apply(p, s);
    if p.t.rules.parallel_actions {
        write_commits(p, s);
        Ok(())
    } else {
        run_ordered(p, s)
    }
}

/// Enclosed charts follow their enclosing steps, through all levels.
pub(crate) fn cascade(p: &Program, s: &mut State) {
    let mut k = 0;
    while let Some(&step) = s.x.off.get(k) {
        k += 1;
        if marked(&s.x.on_mark, step) || !s.steps.contains(&s.w, step) {
            continue;
        }
        let Some(e) = extra(p, step) else { continue };
        for g in p.t.group_lists.get(e.encloses.start as usize..e.encloses.end as usize).unwrap_or(&[]) {
            let Some(group) = p.t.groups.get(g.0 as usize) else { continue };
            if drop_activations(s, group.steps) {
                k = 0;
            }
            let mut from = group.steps.start;
            while let Some(i) = s.steps.next(&s.w, from).filter(|i| *i < group.steps.end) {
                mark_off(s, StepId(i));
                from = i + 1;
            }
        }
    }
    let mut k = 0;
    while let Some(&step) = s.x.on.get(k) {
        k += 1;
        if !marked(&s.x.on_mark, step) || s.steps.contains(&s.w, step) {
            continue;
        }
        let Some(e) = extra(p, step) else { continue };
        for link in p.t.arcs.get(e.links.start as usize..e.links.end as usize).unwrap_or(&[]) {
            mark_on(s, *link);
        }
    }
}

/// An activation in a chart that is being emptied does not take place. Whether
/// a step goes off for that that would have stayed: what it encloses is to be
/// looked at again.
fn drop_activations(s: &mut State, steps: Rows) -> bool {
    let mut goes = false;
    for j in 0..s.x.on.len() {
        let Some(&i) = s.x.on.get(j) else { break };
        if (steps.start..steps.end).contains(&i) && marked(&s.x.on_mark, i) {
            unmark(&mut s.x.on_mark, i);
            goes |= marked(&s.x.off_mark, i);
        }
    }
    goes
}

/// Collects the stored actions of the marked changes.
fn gather(p: &Program, s: &mut State) {
    for k in 0..s.x.off.len() {
        let Some(&step) = s.x.off.get(k) else { break };
        if let Some(e) = extra(p, step)
            && !e.off.is_empty()
            && !marked(&s.x.on_mark, step)
            && s.steps.contains(&s.w, step)
        {
            add_runs(p, s, e.off);
        }
    }
    for k in 0..s.x.on.len() {
        let Some(&step) = s.x.on.get(k) else { break };
        if let Some(e) = extra(p, step)
            && !e.on.is_empty()
            && marked(&s.x.on_mark, step)
            && !s.steps.contains(&s.w, step)
            // A step marked twice (enclosures) stands in the list twice.
            && !s.x.on.get(..k).unwrap_or(&[]).contains(&step)
        {
            add_runs(p, s, e.on);
        }
    }
}

/// Gathers actions of a step that comes on or goes off, for this pass or, with
/// `late_actions`, for the end of the scan.
pub(crate) fn add_runs(p: &Program, s: &mut State, rows: Rows) {
    for &action in p.t.action_lists.get(rows.start as usize..rows.end as usize).unwrap_or(&[]) {
        if p.t.rules.late_actions {
            set_bit(&mut s.x.late, 0, action, true);
            s.x.late_any = true;
        } else {
            s.x.runs.push(action);
        }
    }
}

/// Switches the step bits, and clears the marks.
fn apply(p: &Program, s: &mut State) {
    s.x.emptied.clear();
    for k in 0..s.x.off.len() {
        let Some(&step) = s.x.off.get(k) else { break };
        unmark(&mut s.x.off_mark, step);
        if !marked(&s.x.on_mark, step) && s.steps.contains(&s.w, step) {
            deactivate(p, s, step);
        }
    }
    s.x.off.clear();
    for k in 0..s.x.on.len() {
        let Some(&step) = s.x.on.get(k) else { break };
        if marked(&s.x.on_mark, step) {
            unmark(&mut s.x.on_mark, step);
            if !s.steps.contains(&s.w, step) {
                activate(p, s, step);
            }
        }
    }
    s.x.on.clear();
}

/// Notes what a step was as the pass began, at its first change in it.
#[cold]
fn turn(s: &mut State, step: u32, was: bool) {
    if !set_bit(&mut s.x.turned, 0, step, true) {
        set_bit(&mut s.x.was, 0, step, was);
        s.x.turns.push(step);
    }
}

#[inline]
pub(crate) fn activate(p: &Program, s: &mut State, step: u32) {
    s.x.changed = true;
    s.x.stepped = true;
    s.x.moved += 1;
    let tree = s.steps;
    if p.looks_back {
        turn(s, step, false);
    }
    tree.insert(&mut s.w, step);
    let now = clock(p, s) as u64;
    s.set(p.layout.stamps as usize + step as usize, now);
    if p.t.rules.scan_clock {
        s.set((p.layout.ages + step) as usize, s.now() as u64);
    }
    let Some(row) = p.t.steps.get(step as usize) else { return };
    if row.direct.0 != NONE {
        s.set((s.vars + row.direct.0) as usize, 1);
    }
    if row.extra != NONE
        && let Some(e) = p.t.extras.get(row.extra as usize)
    {
        s.x.moved -= u32::from(e.uncounted);
        carry_on(p, s, e);
    }
}

#[inline]
pub(crate) fn deactivate(p: &Program, s: &mut State, step: u32) {
    s.x.changed = true;
    s.x.stepped = true;
    s.x.moved += 1;
    let tree = s.steps;
    if p.looks_back {
        turn(s, step, true);
    }
    tree.remove(&mut s.w, step);
    let at = p.layout.stamps as usize + step as usize;
    let gone = if p.t.rules.keep_step_time { clock(p, s).wrapping_sub(word(&s.w, at) as i64) } else { 0 };
    s.set(at, gone as u64);
    if p.t.rules.scan_clock {
        let at = (p.layout.ages + step) as usize;
        let age = s.now().wrapping_sub(word(&s.w, at) as i64);
        s.set(at, if p.t.rules.keep_step_time { age as u64 } else { 0 });
    }
    let Some(row) = p.t.steps.get(step as usize) else { return };
    if row.direct.0 != NONE {
        s.set((s.vars + row.direct.0) as usize, 0);
    }
    if row.extra != NONE
        && let Some(e) = p.t.extras.get(row.extra as usize)
    {
        s.x.moved -= u32::from(e.uncounted);
        carry_off(p, s, e);
    }
}

fn carry_on(p: &Program, s: &mut State, e: &Extra) {
    let l = &p.layout;
    for row in e.contributions.start..e.contributions.end {
        let Some(c) = p.t.contributions.get(row as usize) else { break };
        if c.condition.is_empty() && c.time.is_empty() {
            crate::blocks::count(p, s, c.block, c.input, true);
        } else {
            l.conditions.insert(&mut s.w, row);
        }
    }
    count_groups(p, s, e, true);
    for i in e.events.start..e.events.end {
        l.events.insert(&mut s.w, i);
    }
    for i in e.periodics.start..e.periodics.end {
        l.periodics.insert(&mut s.w, i);
    }
    for i in e.orders.start..e.orders.end {
        l.orders.insert(&mut s.w, i);
    }
    mark_watches(p, s, e.watches);
}

fn carry_off(p: &Program, s: &mut State, e: &Extra) {
    let l = &p.layout;
    for row in e.contributions.start..e.contributions.end {
        let Some(c) = p.t.contributions.get(row as usize) else { break };
        if c.condition.is_empty() && c.time.is_empty() {
            crate::blocks::count(p, s, c.block, c.input, false);
        } else {
            l.conditions.remove(&mut s.w, row);
            if set_bit(&mut s.w, l.counted, row, false) {
                crate::blocks::count(p, s, c.block, c.input, false);
            }
        }
    }
    count_groups(p, s, e, false);
    for i in e.events.start..e.events.end {
        l.events.remove(&mut s.w, i);
    }
    for i in e.periodics.start..e.periodics.end {
        l.periodics.remove(&mut s.w, i);
    }
    for i in e.orders.start..e.orders.end {
        l.orders.remove(&mut s.w, i);
    }
    mark_watches(p, s, e.watches);
}

fn count_groups(p: &Program, s: &mut State, e: &Extra, on: bool) {
    for g in p.t.group_lists.get(e.groups.start as usize..e.groups.end as usize).unwrap_or(&[]) {
        let at = p.layout.groups as usize + g.0 as usize;
        let old = word(&s.w, at);
        let new = if on { old.wrapping_add(1) } else { old.saturating_sub(1) };
        s.set(at, new);
        if (old == 0) == (new == 0) {
            continue;
        }
        stamp_group(p, s, g.0, new != 0);
        if let Some(group) = p.t.groups.get(g.0 as usize) {
            mark_watches(p, s, group.watches);
        }
    }
}

/// Notes when a group came on, or how long it was on. One that loses its last
/// step and gets another in the same change was active without a break.
fn stamp_group(p: &Program, s: &mut State, group: u32, on: bool) {
    let l = &p.layout;
    let (stamp, age) = ((l.group_stamps + group) as usize, (l.group_ages + group) as usize);
    let (clock, now) = (clock(p, s) as u64, s.now() as u64);
    let old = (word(&s.w, stamp), word(&s.w, age));
    let new = if on {
        let kept = s.x.emptied.iter().rev().find(|e| e.0 == group);
        kept.map_or((clock, now), |e| e.1)
    } else {
        if s.x.emptied.len() < s.x.emptied.capacity() {
            s.x.emptied.push((group, old));
        }
        let keep = p.t.rules.keep_step_time;
        if keep { (clock.wrapping_sub(old.0), now.wrapping_sub(old.1)) } else { (0, 0) }
    };
    s.set(age, new.1);
    s.set(stamp, new.0);
}

/// Runs one action where its condition holds and its period is due.
pub(crate) fn run_action(p: &Program, s: &mut State, action: u32) -> Result<(), Fault> {
    let Some(a) = p.t.actions.get(action as usize) else { return Ok(()) };
    if is_due(p, s, a.period) && condition(p, s, a.condition)? {
        if s.x.ran.len() < s.x.ran.capacity() {
            s.x.ran.push(action);
        }
        run(p, s, a.body)?;
    }
    Ok(())
}

/// Runs the gathered actions one after the other, each seeing the earlier ones.
pub(crate) fn run_ordered(p: &Program, s: &mut State) -> Result<(), Fault> {
    if s.x.runs.is_empty() {
        return Ok(());
    }
    s.x.runs.sort_unstable();
    for k in 0..s.x.runs.len() {
        let Some(&action) = s.x.runs.get(k) else { break };
        run_action(p, s, action)?;
    }
    s.x.runs.clear();
    Ok(())
}

/// Runs the gathered actions on the values from before the pass: each one's
/// writes are taken back and noted, to be made by [`write_commits`].
fn run_parallel(p: &Program, s: &mut State) -> Result<(), Fault> {
    s.x.runs.sort_unstable();
    for k in 0..s.x.runs.len() {
        let Some(&action) = s.x.runs.get(k) else { break };
        s.x.serial = s.x.serial.wrapping_add(1).max(1);
        s.x.log.clear();
        s.x.logging = true;
        let was_changed = s.x.changed;
        let done = run_action(p, s, action);
        s.x.logging = false;
        done?;
        s.x.changed = was_changed;
        for i in 0..s.x.log.len() {
            let Some(&(addr, old)) = s.x.log.get(i) else { break };
            let new = read(s, Addr(addr));
            s.x.commits.push((addr, new));
            s.set((s.vars + addr) as usize, old);
        }
    }
    s.x.runs.clear();
    Ok(())
}

/// Makes the noted writes; the later one wins, and a disagreement is told. A
/// word that ends as it was has not changed, whatever it was given in between.
fn write_commits(p: &Program, s: &mut State) {
    if s.x.commits.is_empty() {
        return;
    }
    s.x.pass_serial = s.x.pass_serial.wrapping_add(1).max(1);
    let serial = s.x.pass_serial;
    let mut conflict = None;
    while let Some((addr, new)) = s.x.commits.pop() {
        let mark = s.x.commit_mark.get_mut(addr as usize);
        if mark.is_none_or(|mark| core::mem::replace(mark, serial) != serial) {
            write(p, s, Addr(addr), new);
        } else if read(s, Addr(addr)) != new {
            conflict = Some(Addr(addr));
        }
    }
    s.x.conflict = s.x.conflict.or(conflict);
}
