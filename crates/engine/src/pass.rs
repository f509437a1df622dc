//! One pass of the evolution (SEMANTICS section 3): judge all, then change all.

use crate::bits::{Walk, bit, set_bit};
use crate::change::{
    activate, add_runs, cascade, commit, deactivate, extra, mark_off, mark_on, marked, run_action,
};
use crate::fault::{Fault, FaultKind};
use crate::run::{guard, read, value};
use crate::state::State;
use crate::{Addr, NONE, Program, Rows, Situation, StepId, Transition};

/// Makes one pass; whether it changed a step or a variable.
pub(crate) fn evolve(p: &Program, s: &mut State) -> Result<bool, Fault> {
    s.x.changed = false;
    s.x.passes += 1;
    s.x.fired.clear();
    if p.has_periods || p.has_orders {
        block(p, s);
        force(s)?;
    }
    if p.looks_back {
        forget_turns(s);
    }
    collect(p, s)?;
    if !p.t.events.is_empty() {
        events(p, s)?;
    }
    // What receptivities leave in the outputs of sections is no change.
    s.x.changed = false;
    if p.comes_and_goes {
        s.x.stepped = false;
        forget_writes(s);
    }
    s.x.idle = s.x.fired.is_empty() && s.x.on.is_empty() && s.x.off.is_empty() && s.x.runs.is_empty();
    if s.x.idle {
        return Ok(false);
    }
    resolve(p, s);
    report(s);
    if p.t.rules.sequential {
        in_turn(p, s)?;
    } else {
        mark(p, s);
        commit(p, s)?;
    }
    if p.comes_and_goes {
        let differs = |w: &(u32, u64)| read(s, Addr(w.0)) != w.1;
        s.x.changed = s.x.stepped || s.x.written.iter().any(differs);
    }
    Ok(s.x.changed)
}

/// A pass begins: no step has changed in it.
fn forget_turns(s: &mut State) {
    while let Some(step) = s.x.turns.pop() {
        set_bit(&mut s.x.turned, 0, step, false);
    }
}

/// A pass begins: no word has been written in it.
fn forget_writes(s: &mut State) {
    while let Some((addr, _)) = s.x.written.pop() {
        set_bit(&mut s.x.written_mark, 0, addr, false);
    }
}

/// Which charts stand still in this pass: those not due, and those forced.
pub(crate) fn block(p: &Program, s: &mut State) {
    s.x.any_blocked = false;
    for (i, chart) in p.t.charts.iter().enumerate() {
        let due = crate::watch::is_due(p, s, chart.period);
        if let Some(b) = s.x.blocked.get_mut(i) {
            *b = !due;
            s.x.any_blocked |= !due;
        }
    }
    s.x.forced_by.fill(NONE);
    if !p.has_orders || p.layout.orders.is_empty(&s.w) {
        return;
    }
    // A forced chart's steps may give orders themselves, and so may the steps it
    // encloses: whether those act depends on what is imposed above them, so
    // orders go down the partial order.
    for i in 0..p.t.orders.len() as u32 {
        let Some(o) = p.t.orders.get(i as usize) else { break };
        if acts(s, o.step) {
            impose(p, s, i);
            if p.has_hierarchy {
                cascade(p, s);
            }
        }
    }
}

/// Whether a step gives its orders in this pass: active, and not taken off by an
/// order above, itself or with its enclosing step; or just forced on so.
fn acts(s: &State, step: StepId) -> bool {
    marked(&s.x.on_mark, step.0) || (s.steps.contains(&s.w, step.0) && !marked(&s.x.off_mark, step.0))
}

/// Marks what an order imposes. A disagreement is kept for [`force`] to tell.
fn impose(p: &Program, s: &mut State, i: u32) {
    let Some(o) = p.t.orders.get(i as usize) else { return };
    let chart = o.chart as usize;
    let Some(first) = s.x.forced_by.get_mut(chart) else { return };
    if *first != NONE {
        let same = p.t.orders.get(*first as usize).is_some_and(|f| agree(p, f.situation, o.situation));
        if !same {
            *first = CONFLICT;
        }
        return;
    }
    *first = i;
    if let Some(b) = s.x.blocked.get_mut(chart) {
        *b = true;
        s.x.any_blocked = true;
    }
    let Situation::Steps(rows) = o.situation else { return };
    for step in arcs(p, rows) {
        mark_on(s, *step);
    }
    let Some(group) = p.t.charts.get(chart).and_then(|c| p.t.groups.get(c.group.0 as usize)) else { return };
    let mut from = group.steps.start;
    while let Some(k) = s.steps.next(&s.w, from).filter(|k| *k < group.steps.end) {
        mark_off(s, StepId(k));
        from = k + 1;
    }
    // An imposed step that is active already has both marks, and stays as it is (rule 5).
}

/// Stands in `forced_by` for "two orders disagree".
const CONFLICT: u32 = NONE - 1;

fn agree(p: &Program, a: Situation, b: Situation) -> bool {
    match (a, b) {
        (Situation::Current, Situation::Current) => true,
        (Situation::Steps(a), Situation::Steps(b)) => {
            let (a, b) = (arcs(p, a), arcs(p, b));
            a.iter().all(|x| b.contains(x)) && b.iter().all(|x| a.contains(x))
        }
        (Situation::Current, Situation::Steps(_)) | (Situation::Steps(_), Situation::Current) => false,
    }
}

pub(crate) fn arcs(p: &Program, rows: Rows) -> &[StepId] {
    p.t.arcs.get(rows.start as usize..rows.end as usize).unwrap_or(&[])
}

/// Tells of two orders that disagree, before anything is judged in the pass.
fn force(s: &mut State) -> Result<(), Fault> {
    match s.x.forced_by.iter().position(|f| *f == CONFLICT) {
        Some(chart) => Err(FaultKind::Forcing { chart: chart as u32 }.nowhere()),
        None => Ok(()),
    }
}

/// Every clearable transition, as far as it can be told without the others.
fn collect(p: &Program, s: &mut State) -> Result<(), Fault> {
    sources(p, s)?;
    let tree = s.steps;
    let mut walk = Walk::new(&tree, &s.w);
    while let Some(step) = walk.next(&tree, &s.w) {
        outs(p, s, step)?;
    }
    Ok(())
}

/// The same for the steps that `bare` leaves over.
pub(crate) fn collect_slow(p: &Program, s: &mut State) -> Result<(), Fault> {
    sources(p, s)?;
    for k in 0..s.x.slow.len() {
        if let Some(&step) = s.x.slow.get(k) {
            outs(p, s, step)?;
        }
    }
    Ok(())
}

fn sources(p: &Program, s: &mut State) -> Result<(), Fault> {
    for &t in &p.t.sources {
        let Some(row) = p.t.transitions.get(t as usize) else { break };
        if !(s.x.any_blocked && is_blocked(s, row.chart)) && guard(p, s, row.guard)? {
            s.x.fired.push(t);
        }
    }
    Ok(())
}

/// The transitions watched by an active step.
#[inline]
fn outs(p: &Program, s: &mut State, step: u32) -> Result<(), Fault> {
    let Some(row) = p.t.steps.get(step as usize) else { return Ok(()) };
    if s.x.any_blocked && is_blocked(s, row.chart) {
        return Ok(());
    }
    for &t in p.t.outs.get(row.out.start as usize..row.out.end as usize).unwrap_or(&[]) {
        let Some(tr) = p.t.transitions.get(t as usize) else { break };
        if rest_active(p, s, tr) && guard(p, s, tr.guard)? {
            s.x.fired.push(t);
            if tr.simple && !p.t.rules.multi_token {
                break;
            }
        }
    }
    Ok(())
}

fn is_blocked(s: &State, chart: u32) -> bool {
    s.x.blocked.get(chart as usize).copied().unwrap_or(false)
}

/// Whether the preceding steps behind the first are active.
#[inline(always)]
pub(crate) fn rest_active(p: &Program, s: &State, t: &Transition) -> bool {
    t.more_from.is_empty() || arcs(p, t.more_from).iter().all(|f| s.steps.contains(&s.w, f.0))
}

/// Event actions of the steps that are active as the pass begins.
fn events(p: &Program, s: &mut State) -> Result<(), Fault> {
    let tree = p.layout.events;
    let mut from = 0;
    while let Some(i) = tree.next(&s.w, from) {
        from = i + 1;
        let Some(e) = p.t.events.get(i as usize) else { break };
        let due = p.t.actions.get(e.action as usize).is_some_and(|a| crate::watch::is_due(p, s, a.period));
        if due && value(p, s, e.event)? != 0 {
            s.x.runs.push(e.action);
        }
    }
    Ok(())
}

/// Drops what priority drops, and puts the rest in order of rank where order matters.
pub(crate) fn resolve(p: &Program, s: &mut State) {
    let rules = &p.t.rules;
    if !rules.multi_token && p.has_contests {
        s.x.fired.sort_unstable();
        exclude(p, s);
    } else if rules.multi_token && rules.numbered_exclusive && p.has_contests {
        by_number(p, s);
        s.x.fired.sort_unstable();
    } else if rules.sequential {
        s.x.fired.sort_unstable();
    }
}

/// Going through the fired transitions in order of rank, drops those that share
/// a step with one that was kept.
fn exclude(p: &Program, s: &mut State) {
    let mut fired = core::mem::take(&mut s.x.fired);
    fired.retain(|i| {
        let Some(t) = p.t.transitions.get(*i as usize) else { return false };
        let free = !t.shares || is_free(p, s, t);
        if free && t.shares {
            each_from(p, t, |f| {
                set_bit(&mut s.x.taken, 0, f, true);
            });
        }
        free
    });
    s.x.taken.fill(0);
    s.x.fired = fired;
}

/// Marks a rank that does not clear; tables are far smaller.
const DROPPED: u32 = 1 << 31;

/// Drops each transition that shares a step with one of a better number; one
/// without a number has the worst. Equal ones do not exclude each other.
fn by_number(p: &Program, s: &mut State) {
    let t = &p.t.transitions;
    let number = |i: u32| t.get(i as usize).map_or(NONE, |t| t.priority);
    let mut fired = core::mem::take(&mut s.x.fired);
    fired.sort_unstable_by_key(|i| (number(*i), *i));
    let mut at = 0;
    while let Some(&first) = fired.get(at) {
        let end =
            at + fired.get(at..).unwrap_or(&[]).iter().take_while(|i| number(**i) == number(first)).count();
        // All of one number are judged before any of them takes its steps; a
        // dropped one takes them as well.
        for j in at..end {
            let Some(t) = fired.get(j).and_then(|i| t.get(*i as usize)) else { continue };
            if !is_free(p, s, t)
                && let Some(i) = fired.get_mut(j)
            {
                *i |= DROPPED;
            }
        }
        for i in fired.get(at..end).unwrap_or(&[]) {
            if let Some(t) = t.get((*i & !DROPPED) as usize) {
                each_from(p, t, |f| {
                    set_bit(&mut s.x.taken, 0, f, true);
                });
            }
        }
        at = end;
    }
    fired.retain(|i| i & DROPPED == 0);
    s.x.taken.fill(0);
    s.x.fired = fired;
}

fn is_free(p: &Program, s: &State, t: &Transition) -> bool {
    let mut free = true;
    each_from(p, t, |f| free &= !bit(&s.x.taken, 0, f));
    free
}

/// Notes what clears, for coverage and traces.
#[inline(always)]
pub(crate) fn report(s: &mut State) {
    let x = &mut s.x;
    x.cleared_count = x.cleared_count.saturating_add(x.fired.len() as u32);
    for i in &x.fired {
        if x.cleared.len() < x.cleared.capacity() {
            x.cleared.push(*i);
        }
    }
}

/// Marks the steps of the transitions that clear, all at once (rules 3 and 4).
fn mark(p: &Program, s: &mut State) {
    for k in 0..s.x.fired.len() {
        let Some(t) = s.x.fired.get(k).and_then(|i| p.t.transitions.get(*i as usize)) else { break };
        each_from(p, t, |from| mark_off(s, StepId(from)));
        if t.drops {
            let rank = s.x.fired.get(k).copied().unwrap_or(NONE);
            drops(p, rank).for_each(|step| mark_off(s, step));
        }
        each_to(p, t, |to| mark_on(s, StepId(to)));
        if t.on_clearing != NONE {
            s.x.runs.push(t.on_clearing);
        }
    }
}

/// The steps that go off with a transition without having to be active for it.
fn drops(p: &Program, rank: u32) -> impl Iterator<Item = StepId> + '_ {
    let from = p.t.drops.partition_point(|d| d.0 < rank);
    p.t.drops.get(from..).unwrap_or(&[]).iter().take_while(move |d| d.0 == rank).map(|d| d.1)
}

#[inline(always)]
pub(crate) fn one_to_one(t: &Transition) -> bool {
    t.more_from.is_empty() && t.more_to.is_empty() && t.from.0 != NONE && t.to.0 != NONE
}

#[inline(always)]
pub(crate) fn each_from(p: &Program, t: &Transition, mut f: impl FnMut(u32)) {
    if t.from.0 != NONE {
        f(t.from.0);
    }
    if !t.more_from.is_empty() {
        arcs(p, t.more_from).iter().for_each(|s| f(s.0));
    }
}

#[inline(always)]
pub(crate) fn each_to(p: &Program, t: &Transition, mut f: impl FnMut(u32)) {
    if t.to.0 != NONE {
        f(t.to.0);
    }
    if !t.more_to.is_empty() {
        arcs(p, t.more_to).iter().for_each(|s| f(s.0));
    }
}

/// Transitions clear one after the other, in order of rank, with their actions
/// at once: a step that one activates and a later one deactivates ends inactive.
/// What forcing orders impose and event actions come behind.
fn in_turn(p: &Program, s: &mut State) -> Result<(), Fault> {
    s.x.left.clear();
    s.x.came.clear();
    for k in 0..s.x.fired.len() {
        let Some(t) = s.x.fired.get(k).and_then(|i| p.t.transitions.get(*i as usize)).copied() else { break };
        // A token that moves within a macro-step does not leave it.
        s.x.emptied.clear();
        if t.on_clearing != NONE {
            run_action(p, s, t.on_clearing)?;
        }
        let mut done = Ok(());
        each_from(p, &t, |f| {
            if done.is_ok() {
                done = leave(p, s, f);
            }
        });
        if t.drops {
            let rank = s.x.fired.get(k).copied().unwrap_or(NONE);
            for step in drops(p, rank) {
                if done.is_ok() {
                    done = leave(p, s, step.0);
                }
            }
        }
        each_to(p, &t, |f| {
            if done.is_ok() {
                done = enter(p, s, f);
            }
        });
        done?;
    }
    if p.has_hierarchy {
        enclosures(p, s);
    }
    commit(p, s)
}

/// What enclosing steps take and bring holds against the turns that came behind:
/// a chart whose enclosing step has gone is empty, linked steps are active.
fn enclosures(p: &Program, s: &mut State) {
    for k in 0..s.x.left.len() {
        let Some(&step) = s.x.left.get(k) else { break };
        if s.steps.contains(&s.w, step) {
            continue;
        }
        let Some(e) = extra(p, step) else { continue };
        for g in p.t.group_lists.get(e.encloses.start as usize..e.encloses.end as usize).unwrap_or(&[]) {
            let Some(group) = p.t.groups.get(g.0 as usize) else { continue };
            for i in group.steps.start..group.steps.end {
                set_bit(&mut s.x.on_mark, 0, i, false);
            }
            let mut from = group.steps.start;
            while let Some(i) = s.steps.next(&s.w, from).filter(|i| *i < group.steps.end) {
                mark_off(s, StepId(i));
                from = i + 1;
            }
        }
    }
    for k in 0..s.x.came.len() {
        let Some(&step) = s.x.came.get(k) else { break };
        if s.x.left.contains(&step) || !s.steps.contains(&s.w, step) {
            continue;
        }
        for link in extra(p, step).map(|e| arcs(p, e.links)).unwrap_or(&[]) {
            mark_on(s, *link);
        }
    }
}

fn run_list(p: &Program, s: &mut State, rows: Rows) -> Result<(), Fault> {
    if p.t.rules.late_actions {
        add_runs(p, s, rows);
        return Ok(());
    }
    for i in rows.start..rows.end {
        if let Some(&action) = p.t.action_lists.get(i as usize) {
            run_action(p, s, action)?;
        }
    }
    Ok(())
}

/// Deactivates a step; its exit actions come first, its enclosed charts with it,
/// step by step, each before the next one.
fn leave(p: &Program, s: &mut State, step: u32) -> Result<(), Fault> {
    s.x.chain.clear();
    s.x.chain.push(step);
    while let Some(step) = s.x.chain.pop() {
        if !s.steps.contains(&s.w, step) {
            continue;
        }
        let e = extra(p, step).copied().unwrap_or_default();
        run_list(p, s, e.off)?;
        deactivate(p, s, step);
        if !e.encloses.is_empty() && s.x.left.len() < s.x.left.capacity() {
            s.x.left.push(step);
        }
        let behind = s.x.chain.len();
        for g in p.t.group_lists.get(e.encloses.start as usize..e.encloses.end as usize).unwrap_or(&[]) {
            let Some(group) = p.t.groups.get(g.0 as usize) else { continue };
            let mut from = group.steps.start;
            while let Some(i) = s.steps.next(&s.w, from).filter(|i| *i < group.steps.end) {
                s.x.chain.push(i);
                from = i + 1;
            }
        }
        s.x.chain.get_mut(behind..).unwrap_or_default().reverse();
    }
    Ok(())
}

/// Activates a step; its entry actions run at once, its linked steps come with it
/// as if a transition led to them: in the order of the text, each with what it
/// brings.
fn enter(p: &Program, s: &mut State, step: u32) -> Result<(), Fault> {
    s.x.chain.clear();
    s.x.chain.push(step);
    while let Some(step) = s.x.chain.pop() {
        if s.steps.contains(&s.w, step) {
            continue;
        }
        activate(p, s, step);
        let e = extra(p, step).copied().unwrap_or_default();
        run_list(p, s, e.on)?;
        if !e.links.is_empty() && s.x.came.len() < s.x.came.capacity() {
            s.x.came.push(step);
        }
        s.x.chain.extend(arcs(p, e.links).iter().rev().map(|l| l.0));
    }
    Ok(())
}
