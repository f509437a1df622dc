//! One pass of the evolution (SEMANTICS section 3): it judges all transitions before
//! it changes any step.

use crate::bits::{Walk, bit, set_bit};
use crate::change::{activate, add_runs, cascade, commit, deactivate, mark_off, mark_on, marked, run_action};
use crate::fault::{Fault, FaultKind};
use crate::memory::read;
use crate::moves;
use crate::ops::{Addr, StepId};
use crate::program::Program;
use crate::run::{holds, value};
use crate::state::State;
use crate::tables::{NONE, Order, Rows, Situation, Transition};

/// Makes one pass; tells whether it changed a step or a variable.
pub(crate) fn evolve(p: &Program, s: &mut State) -> Result<bool, Fault> {
    s.scratch.changed = false;
    s.scratch.passes += 1;
    s.scratch.fired.clear();
    if p.has_periods || p.has_orders {
        block(p, s);
        force(s)?;
    }
    if p.looks_back {
        forget_turns(s);
    }
    collect(p, s)?;
    if !p.tables.events.is_empty() {
        events(p, s)?;
    }
    // A transition section writes variables while it is evaluated; that is no change.
    s.scratch.changed = false;
    if p.comes_and_goes {
        s.scratch.stepped = false;
        forget_writes(s);
    }
    s.scratch.idle = s.scratch.fired.is_empty()
        && s.scratch.on.is_empty()
        && s.scratch.off.is_empty()
        && s.scratch.runs.is_empty();
    if s.scratch.idle {
        return Ok(false);
    }
    resolve(p, s);
    report(s);
    if moves::are_plain(p, &s.scratch) {
        let changed = moves::clear(p, s);
        s.scratch.changed |= changed;
        s.scratch.stepped |= changed;
    } else if p.tables.rules.sequential {
        in_turn(p, s)?;
    } else {
        mark(p, s);
        commit(p, s)?;
    }
    if p.comes_and_goes {
        let differs = |w: &(u32, u64)| read(s, Addr(w.0)) != w.1;
        s.scratch.changed = s.scratch.stepped || s.scratch.written.iter().any(differs);
    }
    Ok(s.scratch.changed)
}

/// Forgets the steps that changed in the pass before.
fn forget_turns(s: &mut State) {
    while let Some(step) = s.scratch.turns.pop() {
        set_bit(&mut s.scratch.turned, 0, step, false);
    }
}

/// Forgets the words that were written in the pass before.
fn forget_writes(s: &mut State) {
    while let Some((addr, _)) = s.scratch.written.pop() {
        set_bit(&mut s.scratch.written_mark, 0, addr, false);
    }
}

/// Finds the charts that stand still in this pass, because they are not due or are
/// forced, and marks the steps that forcing orders impose.
pub(crate) fn block(p: &Program, s: &mut State) {
    s.scratch.any_blocked = false;
    for (i, chart) in p.tables.charts.iter().enumerate() {
        let due = s.is_due(p, chart.period);
        if let Some(b) = s.scratch.blocked.get_mut(i) {
            *b = !due;
            s.scratch.any_blocked |= !due;
        }
    }
    s.scratch.forced_by.fill(NONE);
    if !p.has_orders || p.layout.orders.is_empty(&s.image) {
        return;
    }
    // The steps of a forced chart, and those that it encloses, may give orders too.
    // The orders above them decide if these act, so the rows are taken in
    // their order.
    for i in 0..p.tables.orders.len() as u32 {
        let Some(o) = p.tables.orders.get(i as usize) else { break };
        if acts(s, o.step) {
            impose(p, s, i);
            if p.has_hierarchy {
                cascade(p, s);
            }
        }
    }
}

/// True if a step is active after the orders so far, and so gives its own: it is active
/// and no order above deactivates it or its enclosing step, or an order above has just
/// activated it.
fn acts(s: &State, step: StepId) -> bool {
    marked(&s.scratch.on_mark, step.0)
        || (s.steps.contains(&s.image, step.0) && !marked(&s.scratch.off_mark, step.0))
}

/// Marks the steps that an order imposes. A disagreement is kept for [`force`].
fn impose(p: &Program, s: &mut State, i: u32) {
    let Some(o) = p.tables.orders.get(i as usize) else { return };
    let chart = o.chart as usize;
    let Some(&first) = s.scratch.forced_by.get(chart) else { return };
    let by = match p.tables.orders.get(first as usize) {
        None if first == NONE => i,
        Some(f) if agree(p, s, f.situation, o) => return,
        _ => CONFLICT,
    };
    if let Some(f) = s.scratch.forced_by.get_mut(chart) {
        *f = by;
    }
    if by == CONFLICT {
        return;
    }
    if let Some(b) = s.scratch.blocked.get_mut(chart) {
        *b = true;
        s.scratch.any_blocked = true;
    }
    let Situation::Steps(rows) = o.situation else { return };
    for step in p.tables.arcs(rows) {
        mark_on(s, *step);
    }
    let Some(group) = p.tables.charts.get(chart).and_then(|c| p.tables.groups.get(c.group.0 as usize)) else {
        return;
    };
    let mut from = group.steps.start;
    while let Some(k) = s.steps.next(&s.image, from).filter(|k| *k < group.steps.end) {
        mark_off(s, StepId(k));
        from = k + 1;
    }
    // An imposed step that is active already has both marks, and rule 5 keeps it so.
}

/// Stands in `forced_by` for "two orders disagree".
const CONFLICT: u32 = NONE - 1;

/// True if an order asks for the situation of one that acts on its chart already.
fn agree(p: &Program, s: &State, first: Situation, o: &Order) -> bool {
    match (first, o.situation) {
        (Situation::Current, Situation::Current) => true,
        (Situation::Steps(a), Situation::Steps(b)) => {
            let (a, b) = (p.tables.arcs(a), p.tables.arcs(b));
            a.iter().all(|x| b.contains(x)) && b.iter().all(|x| a.contains(x))
        }
        (Situation::Current, Situation::Steps(rows)) => is_in(p, s, o.chart, p.tables.arcs(rows)),
        // The tables have the orders that keep a situation first.
        (Situation::Steps(_), Situation::Current) => false,
    }
}

/// True if these steps of a chart and no others are active, after the orders above it.
fn is_in(p: &Program, s: &State, chart: u32, steps: &[StepId]) -> bool {
    let group = p.tables.charts.get(chart as usize).and_then(|c| p.tables.groups.get(c.group.0 as usize));
    group.is_some_and(|g| {
        (g.steps.start..g.steps.end).all(|k| acts(s, StepId(k)) == steps.contains(&StepId(k)))
    })
}

/// Reports two orders that disagree, before any transition of the pass is judged.
fn force(s: &mut State) -> Result<(), Fault> {
    match s.scratch.forced_by.iter().position(|f| *f == CONFLICT) {
        Some(chart) => Err(FaultKind::Forcing { chart: chart as u32 }.nowhere()),
        None => Ok(()),
    }
}

/// Collects every transition that is clearable, without regard to the others.
fn collect(p: &Program, s: &mut State) -> Result<(), Fault> {
    // Hot steps are judged before the others. That must not matter, so no receptivity may write.
    if p.judges_freely && !s.scratch.any_blocked {
        moves::collect(p, s);
        if !p.tables.sources.is_empty() {
            sources(p, s)?;
        }
        for k in 0..s.scratch.slow.len() {
            if let Some(&step) = s.scratch.slow.get(k) {
                outs(p, s, step)?;
            }
        }
        return Ok(());
    }
    s.scratch.lone = NONE;
    sources(p, s)?;
    let tree = s.steps;
    let mut walk = Walk::new(&tree, &s.image);
    while let Some(step) = walk.next(&tree, &s.image) {
        outs(p, s, step)?;
    }
    Ok(())
}

fn sources(p: &Program, s: &mut State) -> Result<(), Fault> {
    for &t in &p.tables.sources {
        let Some(row) = p.tables.transitions.get(t as usize) else { break };
        if !(s.scratch.any_blocked && is_blocked(s, row.chart)) && holds(p, s, row.receptivity)? {
            s.scratch.fired.push(t);
        }
    }
    Ok(())
}

/// Collects the clearable transitions whose first preceding step is this active one.
#[inline]
fn outs(p: &Program, s: &mut State, step: u32) -> Result<(), Fault> {
    let Some(row) = p.tables.steps.get(step as usize) else { return Ok(()) };
    if s.scratch.any_blocked && is_blocked(s, row.chart) {
        return Ok(());
    }
    for &t in p.tables.outs.get(row.out.start as usize..row.out.end as usize).unwrap_or(&[]) {
        let Some(tr) = p.tables.transitions.get(t as usize) else { break };
        if rest_active(p, s, tr) && holds(p, s, tr.receptivity)? {
            s.scratch.fired.push(t);
            if tr.simple && !p.tables.rules.multi_token {
                break;
            }
        }
    }
    Ok(())
}

fn is_blocked(s: &State, chart: u32) -> bool {
    s.scratch.blocked.get(chart as usize).copied().unwrap_or(false)
}

/// True if all preceding steps but the first are active.
#[inline(always)]
pub(crate) fn rest_active(p: &Program, s: &State, t: &Transition) -> bool {
    t.more_from.is_empty() || p.tables.arcs(t.more_from).iter().all(|f| s.steps.contains(&s.image, f.0))
}

/// Collects the event actions of the steps that are active as the pass begins.
fn events(p: &Program, s: &mut State) -> Result<(), Fault> {
    let tree = p.layout.events;
    let mut from = 0;
    while let Some(i) = tree.next(&s.image, from) {
        from = i + 1;
        let Some(e) = p.tables.events.get(i as usize) else { break };
        let due = p.tables.actions.get(e.action as usize).is_some_and(|a| s.is_due(p, a.period));
        if due && value(p, s, e.event)? != 0 {
            s.scratch.runs.push(e.action);
        }
    }
    Ok(())
}

/// Drops what priority drops, and puts the rest in order of rank where order matters.
fn resolve(p: &Program, s: &mut State) {
    let rules = &p.tables.rules;
    if !rules.multi_token && p.has_contests {
        s.scratch.fired.sort_unstable();
        exclude(p, s);
    } else if rules.multi_token && rules.numbered_exclusive && p.has_contests {
        by_number(p, s);
        s.scratch.fired.sort_unstable();
    } else if rules.sequential {
        s.scratch.fired.sort_unstable();
    }
}

/// Goes through the clearable transitions in order of rank, and drops those that share
/// a preceding step with one that was kept.
fn exclude(p: &Program, s: &mut State) {
    let mut fired = core::mem::take(&mut s.scratch.fired);
    fired.retain(|i| {
        let Some(t) = p.tables.transitions.get(*i as usize) else { return false };
        let free = !t.shares || is_free(p, s, t);
        if free && t.shares {
            p.tables.each_from(t, |f| {
                set_bit(&mut s.scratch.taken, 0, f, true);
            });
        }
        free
    });
    s.scratch.taken.fill(0);
    s.scratch.fired = fired;
}

/// The bit that marks a rank as dropped. No table is so long that a rank has it.
const DROPPED: u32 = 1 << 31;

/// Drops each transition that shares a preceding step with one of a better number; no
/// number is the worst. Those of equal number do not exclude each other.
fn by_number(p: &Program, s: &mut State) {
    let t = &p.tables.transitions;
    let number = |i: u32| t.get(i as usize).map_or(NONE, |t| t.priority);
    let mut fired = core::mem::take(&mut s.scratch.fired);
    fired.sort_unstable_by_key(|i| (number(*i), *i));
    let mut at = 0;
    while let Some(&first) = fired.get(at) {
        let end =
            at + fired.get(at..).unwrap_or(&[]).iter().take_while(|i| number(**i) == number(first)).count();
        // All of one number are judged before any of them takes its steps, and a dropped
        // one takes them too.
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
                p.tables.each_from(t, |f| {
                    set_bit(&mut s.scratch.taken, 0, f, true);
                });
            }
        }
        at = end;
    }
    fired.retain(|i| i & DROPPED == 0);
    s.scratch.taken.fill(0);
    s.scratch.fired = fired;
}

fn is_free(p: &Program, s: &State, t: &Transition) -> bool {
    let mut free = true;
    p.tables.each_from(t, |f| free &= !bit(&s.scratch.taken, 0, f));
    free
}

/// Notes the transitions that clear, for coverage and traces.
#[inline(always)]
fn report(s: &mut State) {
    let scratch = &mut s.scratch;
    scratch.cleared_count = scratch.cleared_count.saturating_add(scratch.fired.len() as u32);
    let room = scratch.cleared.capacity() - scratch.cleared.len();
    let fired = scratch.fired.get(..room).unwrap_or(&scratch.fired);
    scratch.cleared.extend_from_slice(fired);
}

/// Marks the steps of the transitions that clear, all at once (rules 3 and 4).
fn mark(p: &Program, s: &mut State) {
    for k in 0..s.scratch.fired.len() {
        let Some(t) = s.scratch.fired.get(k).and_then(|i| p.tables.transitions.get(*i as usize)) else {
            break;
        };
        p.tables.each_from(t, |from| mark_off(s, StepId(from)));
        if t.drops {
            let rank = s.scratch.fired.get(k).copied().unwrap_or(NONE);
            drops(p, rank).for_each(|step| mark_off(s, step));
        }
        p.tables.each_to(t, |to| mark_on(s, StepId(to)));
        if t.on_clearing != NONE {
            s.scratch.runs.push(t.on_clearing);
        }
    }
}

/// The steps that a transition deactivates but that need not be active for it.
fn drops(p: &Program, rank: u32) -> impl Iterator<Item = StepId> + '_ {
    let from = p.tables.drops.partition_point(|d| d.0 < rank);
    p.tables.drops.get(from..).unwrap_or(&[]).iter().take_while(move |d| d.0 == rank).map(|d| d.1)
}

/// Clears the transitions one after the other, in order of rank, each with its actions
/// at once: a step that one activates and a later one deactivates ends inactive. Then
/// forcing orders and event actions follow.
fn in_turn(p: &Program, s: &mut State) -> Result<(), Fault> {
    s.scratch.left.clear();
    s.scratch.entered.clear();
    for k in 0..s.scratch.fired.len() {
        let Some(t) = s.scratch.fired.get(k).and_then(|i| p.tables.transitions.get(*i as usize)).copied()
        else {
            break;
        };
        // A token that moves within a macro-step does not leave it.
        s.scratch.emptied.clear();
        if t.on_clearing != NONE {
            run_action(p, s, t.on_clearing)?;
        }
        let mut done = Ok(());
        p.tables.each_from(&t, |f| {
            if done.is_ok() {
                done = leave(p, s, f);
            }
        });
        if t.drops {
            let rank = s.scratch.fired.get(k).copied().unwrap_or(NONE);
            for step in drops(p, rank) {
                if done.is_ok() {
                    done = leave(p, s, step.0);
                }
            }
        }
        p.tables.each_to(&t, |f| {
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

/// Enclosures hold against the transitions that cleared later in the pass: a chart
/// whose enclosing step was left is empty, and linked steps are active.
fn enclosures(p: &Program, s: &mut State) {
    for k in 0..s.scratch.left.len() {
        let Some(&step) = s.scratch.left.get(k) else { break };
        if s.steps.contains(&s.image, step) {
            continue;
        }
        let Some(e) = p.extra(step) else { continue };
        for g in p.tables.group_lists.get(e.encloses.start as usize..e.encloses.end as usize).unwrap_or(&[]) {
            let Some(group) = p.tables.groups.get(g.0 as usize) else { continue };
            for i in group.steps.start..group.steps.end {
                set_bit(&mut s.scratch.on_mark, 0, i, false);
            }
            let mut from = group.steps.start;
            while let Some(i) = s.steps.next(&s.image, from).filter(|i| *i < group.steps.end) {
                mark_off(s, StepId(i));
                from = i + 1;
            }
        }
    }
    for k in 0..s.scratch.entered.len() {
        let Some(&step) = s.scratch.entered.get(k) else { break };
        if s.scratch.left.contains(&step) || !s.steps.contains(&s.image, step) {
            continue;
        }
        for link in p.extra(step).map(|e| p.tables.arcs(e.links)).unwrap_or(&[]) {
            mark_on(s, *link);
        }
    }
}

fn run_list(p: &Program, s: &mut State, rows: Rows) -> Result<(), Fault> {
    if p.tables.rules.late_actions {
        add_runs(p, s, rows);
        return Ok(());
    }
    for i in rows.start..rows.end {
        if let Some(&action) = p.tables.action_lists.get(i as usize) {
            run_action(p, s, action)?;
        }
    }
    Ok(())
}

/// Deactivates a step after its exit actions, and then the steps of the charts that it
/// encloses, one after the other, each with what it encloses.
fn leave(p: &Program, s: &mut State, step: u32) -> Result<(), Fault> {
    s.scratch.chain.clear();
    s.scratch.chain.push(step);
    while let Some(step) = s.scratch.chain.pop() {
        if !s.steps.contains(&s.image, step) {
            continue;
        }
        let e = p.extra(step).copied().unwrap_or_default();
        run_list(p, s, e.off)?;
        deactivate(p, s, step);
        if !e.encloses.is_empty() && s.scratch.left.len() < s.scratch.left.capacity() {
            s.scratch.left.push(step);
        }
        let behind = s.scratch.chain.len();
        for g in p.tables.group_lists.get(e.encloses.start as usize..e.encloses.end as usize).unwrap_or(&[]) {
            let Some(group) = p.tables.groups.get(g.0 as usize) else { continue };
            let mut from = group.steps.start;
            while let Some(i) = s.steps.next(&s.image, from).filter(|i| *i < group.steps.end) {
                s.scratch.chain.push(i);
                from = i + 1;
            }
        }
        s.scratch.chain.get_mut(behind..).unwrap_or_default().reverse();
    }
    Ok(())
}

/// Activates a step and runs its entry actions, and then the steps that its links name,
/// in the order of the text, each with its own links.
fn enter(p: &Program, s: &mut State, step: u32) -> Result<(), Fault> {
    s.scratch.chain.clear();
    s.scratch.chain.push(step);
    while let Some(step) = s.scratch.chain.pop() {
        if s.steps.contains(&s.image, step) {
            continue;
        }
        activate(p, s, step);
        let e = p.extra(step).copied().unwrap_or_default();
        run_list(p, s, e.on)?;
        if !e.links.is_empty() && s.scratch.entered.len() < s.scratch.entered.capacity() {
            s.scratch.entered.push(step);
        }
        s.scratch.chain.extend(p.tables.arcs(e.links).iter().rev().map(|l| l.0));
    }
    Ok(())
}
