//! One scan: inputs, evolution, actions, outputs (SEMANTICS section 4).

use crate::bits::{Walk, bit, set_bit, word};
use crate::change::{activate, carry_out, commit, mark_off, mark_on, run_action};
use crate::fault::{Fault, FaultKind};
use crate::layout::{REQUESTS, START, STARTED, STOPPED, head};
use crate::memory::{notice, write};
use crate::ops::{Addr, Code, StepId};
use crate::pass::evolve;
use crate::program::Program;
use crate::rules::PATIENCE;
use crate::run::{run, value};
use crate::sleepers::Rest;
use crate::state::State;
use crate::tables::NONE;
use crate::{blocks, counts, moves, watch};

/// The report of a scan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Passes made, the last and unchanging one included.
    pub passes: u32,
    /// Transitions cleared.
    pub cleared: u32,
    /// A variable that stored actions of one pass gave different values
    /// (`parallel_actions` only); the first of this scan.
    pub conflict: Option<Addr>,
}

/// Runs one scan.
///
/// `inputs` has a word for each word of [`crate::Tables::inputs`]; `now` is
/// monotonic, in nanoseconds. After the scan the outputs stand in the variable area.
///
/// # Errors
///
/// A [`Fault`]; then the outputs have their safe values and every further scan
/// is refused with [`FaultKind::Stopped`].
///
/// # Source
///
/// IEC 60848:2013, 4.5 (evolution rules) and 4.6 (interpretation);
/// IEC 61131-3:2003, 2.6.5.
pub fn scan(p: &Program, s: &mut State, inputs: &[u64], now: i64) -> Result<Report, Fault> {
    match begin_short(p, s, inputs, now) {
        Begun::Still => Ok(Report { passes: 1, cleared: 0, conflict: None }),
        Begun::Brisk => {
            if !p.tables.rules.stable
                && let Some(moved) = moves::one_token(p, s)
            {
                if to_settle(p, s) {
                    return counted(p, s, 1, u32::from(moved));
                }
                s.scratch.quiet = !moved && p.timeless;
                gates(p, s);
                return Ok(Report { passes: 1, cleared: u32::from(moved), conflict: None });
            }
            brisk(p, s)
        }
        Begun::No => whole(p, s, inputs, now),
    }
}

/// How a scan began.
enum Begun {
    /// It is over: nothing can happen in it.
    Still,
    /// Inputs and time are new, and nothing but transitions acts at first.
    Brisk,
    /// Nothing was done yet.
    No,
}

/// Begins a scan, and ends it where the one before ended in a situation that a further pass does not
/// change, nothing waits for the time, and no input differs. Does nothing where something other than
/// transitions may act, before the first scan, after a fault, or where inputs or time do not fit.
#[inline(always)]
fn begin_short(p: &Program, s: &mut State, inputs: &[u64], now: i64) -> Begun {
    let quiet = s.scratch.quiet;
    let brisk = p.brisk && s.has_only_flag(STARTED) && !moves::is_awake(p, &s.image);
    if !quiet && !brisk {
        return Begun::No;
    }
    let (from, to) = ((s.vars + p.tables.inputs.start) as usize, (s.vars + p.tables.inputs.end) as usize);
    let before = s.now();
    let Some(area) = s.image.get_mut(from..to) else { return Begun::No };
    if area.len() != inputs.len() || now < before {
        return Begun::No;
    }
    let still = quiet && now < s.scratch.timers_due && !differ(area, inputs);
    if !still {
        if !brisk || p.watches_inputs && watched(p, area, inputs) {
            return Begun::No;
        }
        if s.scratch.rest.is_on() {
            take_each(p, area, &mut s.scratch.rest, inputs);
        } else {
            take(area, inputs);
        }
    }
    tick(s, now.wrapping_sub(before), now);
    s.scratch.begin_brisk();
    if still { Begun::Still } else { Begun::Brisk }
}

/// Takes the inputs over. One or two are written faster than by a call.
#[inline(always)]
fn take(area: &mut [u64], inputs: &[u64]) {
    match (area, inputs) {
        ([a], [i]) => *a = *i,
        ([a, b], [i, j]) => (*a, *b) = (*i, *j),
        (area, inputs) => area.copy_from_slice(inputs),
    }
}

/// Takes the inputs over, and wakes the steps that wait for one that changes.
#[inline(never)]
fn take_each(p: &Program, area: &mut [u64], rest: &mut Rest, inputs: &[u64]) {
    if area == inputs {
        return;
    }
    for ((i, old), new) in (p.tables.inputs.start..).zip(area).zip(inputs) {
        if *old != *new {
            *old = *new;
            p.sleepers.wake(rest, Addr(i));
        }
    }
}

/// The rest of a scan that began as [`Begun::Brisk`].
#[inline(never)]
fn brisk(p: &Program, s: &mut State) -> Result<Report, Fault> {
    let mut made = 0;
    if p.tables.rules.stable {
        while made + 1 < PATIENCE
            && let Some(moved) = moves::one_token(p, s)
        {
            if !moved {
                if to_settle(p, s) {
                    return counted(p, s, made + 1, made);
                }
                s.scratch.quiet = p.timeless;
                gates(p, s);
                return Ok(Report { passes: made + 1, cleared: made, conflict: None });
            }
            made += 1;
        }
    }
    s.scratch.begin_passes(made);
    let done = search(p, s, made).and_then(|()| finish_brisk(p, s));
    end(p, s, done)
}

/// True if control blocks are to be evaluated at the end of a scan in which nothing was awake as it
/// began.
#[inline(always)]
fn to_settle(p: &Program, s: &State) -> bool {
    p.counted && moves::is_awake(p, &s.image) || timers_end(s)
}

/// True if a timer of a control block may end in this scan.
#[inline(always)]
fn timers_end(s: &State) -> bool {
    s.now() >= s.scratch.timers_due
}

/// Ends a scan in which nothing but a lone token may have moved, and inputs of control blocks with it.
#[inline(never)]
fn counted(p: &Program, s: &mut State, passes: u32, cleared: u32) -> Result<Report, Fault> {
    s.scratch.begin_passes(cleared);
    s.scratch.passes = passes;
    s.scratch.first_pass = false;
    // A search for stability has made a pass that changed nothing.
    s.scratch.idle = passes > cleared;
    s.scratch.changed = !s.scratch.idle;
    gates(p, s);
    let done = settle(p, s);
    end(p, s, done)
}

/// As [`finish`], for a scan that began as [`Begun::Brisk`].
#[inline(always)]
fn finish_brisk(p: &Program, s: &mut State) -> Result<(), Fault> {
    if s.scratch.late_any || s.scratch.worked || moves::is_awake(p, &s.image) || timers_end(s) {
        return finish(p, s);
    }
    gates(p, s);
    s.scratch.quiet = p.timeless && s.scratch.idle && !s.scratch.changed && !s.has_flag(REQUESTS);
    Ok(())
}

#[inline(always)]
fn gates(p: &Program, s: &mut State) {
    if !p.gates.is_empty() {
        p.gates.follow(&p.layout, &p.decisions, &mut s.image);
    }
}

/// The general way.
#[inline(never)]
fn whole(p: &Program, s: &mut State, inputs: &[u64], now: i64) -> Result<Report, Fault> {
    let done = begin(p, s, inputs, now).and_then(|()| search(p, s, 0)).and_then(|()| finish(p, s));
    end(p, s, done)
}

fn end(p: &Program, s: &mut State, done: Result<(), Fault>) -> Result<Report, Fault> {
    match done {
        Ok(()) => Ok(report(s)),
        Err(fault) => {
            stop(p, s);
            Err(fault)
        }
    }
}

/// True if an input that some watch reads changes.
#[inline(never)]
fn watched(p: &Program, area: &[u64], inputs: &[u64]) -> bool {
    let watches = |i: u32| p.word_index.get(i as usize) != p.word_index.get(i as usize + 1);
    let words = p.tables.inputs.start..;
    words.zip(area.iter().zip(inputs)).any(|(i, (old, new))| old != new && watches(i))
}

/// True if an input has changed. A few are compared word by word, which is faster than a call.
#[inline(always)]
fn differ(area: &[u64], inputs: &[u64]) -> bool {
    if inputs.len() > 8 { area != inputs } else { area.iter().zip(inputs).any(|(a, i)| a != i) }
}

/// Puts the time of a new scan into the header, and counts the scan.
#[inline(always)]
fn tick(s: &mut State, dt: i64, now: i64) {
    if let Some(head) = s.image.first_chunk_mut::<{ head::WORDS as usize }>() {
        head[head::DT] = dt as u64;
        head[head::NOW] = now as u64;
        head[head::SCANS] = head[head::SCANS].wrapping_add(1);
    }
}

fn report(s: &State) -> Report {
    Report { passes: s.scratch.passes, cleared: s.scratch.cleared_count, conflict: s.scratch.conflict }
}

/// Makes passes until one changes nothing, or just one without `stable`. `made` is the number of
/// passes that the scan has made before, fewer than [`PATIENCE`].
#[inline]
fn search(p: &Program, s: &mut State, mut made: u32) -> Result<(), Fault> {
    let rules = &p.tables.rules;
    if !rules.stable {
        return pass(p, s).map(|_| ());
    }
    // Brent's search for cycles compares with a saved image, which is renewed at
    // doubling distances. Within a scan time and inputs do not change, so an image that
    // recurs once recurs for ever.
    let (mut power, mut distance) = (1u32, 0u32);
    while pass(p, s)? {
        made += 1;
        if made >= rules.bound {
            return Err(FaultKind::Bound.nowhere());
        }
        if made < PATIENCE {
            continue;
        }
        if made > PATIENCE {
            distance += 1;
            if s.scratch.saved.as_slice() == &*s.image {
                return Err(FaultKind::Unstable { cycle: distance }.nowhere());
            }
        }
        if made == PATIENCE || distance == power {
            let State { image, scratch, .. } = s;
            scratch.saved.clear();
            scratch.saved.extend_from_slice(image);
            power = if made == PATIENCE { 1 } else { power.saturating_mul(2) };
            distance = 0;
        }
    }
    Ok(())
}

/// The first part of a scan: inputs, time, watches, PRE, services. `now` is in ns.
///
/// # Errors
///
/// [`FaultKind::Inputs`] where there are more or fewer inputs than the program has, or
/// `now` lies before the time of the preceding scan; nothing was changed then. Other
/// faults come from watched expressions, PRE or the initial actions.
pub fn begin(p: &Program, s: &mut State, inputs: &[u64], now: i64) -> Result<(), Fault> {
    let t = &p.tables;
    if s.has_flag(STOPPED) {
        return Err(FaultKind::Stopped.nowhere());
    }
    let fresh = !s.has_flag(STARTED);
    if inputs.len() != (t.inputs.end - t.inputs.start) as usize || (!fresh && now < s.now()) {
        return Err(FaultKind::Inputs.nowhere());
    }
    s.scratch.begin();
    s.scratch.quiet = false;
    let before = if fresh { now } else { s.now() };
    tick(s, now.wrapping_sub(before), now);
    if p.has_periods {
        periods(p, s, now, fresh);
    }
    let (from, to) = ((s.vars + t.inputs.start) as usize, (s.vars + t.inputs.end) as usize);
    if s.image.get(from..to).is_none_or(|area| area != inputs) {
        for (i, v) in (t.inputs.start..).zip(inputs) {
            if word(&s.image, (s.vars + i) as usize) != *v {
                s.set((s.vars + i) as usize, *v);
                notice(p, s, Addr(i));
            }
        }
    }
    if fresh {
        s.set_flag(STARTED, true);
        for step in &t.initial {
            mark_on(s, *step);
        }
        // The initial situation (rule 1) is the initial steps alone: no links.
        carry_out(p, s)?;
    }
    watch::update(p, s, true, fresh)?;
    if p.frame {
        run(p, s, t.pre)?;
        run(p, s, t.services)?;
    }
    s.scratch.stepped = fresh;
    if s.has_flag(REQUESTS) {
        requests(p, s)?;
    }
    if t.rules.late_actions && s.scratch.stepped {
        blocks::look(p, s)?;
    }
    if t.counts.is_some() {
        counts::enabled(p, s, false)?;
    }
    s.scratch.moved = 0;
    if t.rules.periodic_first {
        let base = p.layout.periodics.base() as usize;
        let State { image, scratch, .. } = s;
        for (b, now) in scratch.before.iter_mut().zip(image.get(base..).unwrap_or_default()) {
            *b = *now;
        }
    }
    s.scratch.first_pass = true;
    Ok(())
}

/// Finds the periods that are due. Instants that were missed are skipped, not made up
/// for.
fn periods(p: &Program, s: &mut State, now: i64, fresh: bool) {
    for (i, period) in p.tables.periods.iter().enumerate() {
        let at = p.layout.periods as usize + i;
        let next = word(&s.image, at) as i64;
        let due = *period <= 0 || fresh || now >= next;
        if let Some(d) = s.scratch.due.get_mut(i) {
            *d = due;
        }
        if due && *period > 0 {
            let from = if fresh { now } else { next };
            let missed = now.saturating_sub(from) / period;
            s.set(at, from.saturating_add(period.saturating_mul(missed + 1)) as u64);
        }
    }
}

/// Carries out the requests of services, with the stored actions of the steps
/// that change.
fn requests(p: &Program, s: &mut State) -> Result<(), Fault> {
    s.set_flag(REQUESTS, false);
    let [init, clear, set, reset] = p.layout.requests;
    if s.has_flag(START) {
        s.set_flag(START, false);
        return start(p, s);
    }
    for (i, group) in p.tables.groups.iter().enumerate() {
        let i = i as u32;
        let initialise = set_bit(&mut s.image, init, i, false);
        let empty = set_bit(&mut s.image, clear, i, false);
        if initialise || empty {
            let mut from = group.steps.start;
            while let Some(k) = s.steps.next(&s.image, from).filter(|k| *k < group.steps.end) {
                mark_off(s, StepId(k));
                from = k + 1;
            }
        }
        if initialise {
            for step in p.tables.arcs(group.initial) {
                mark_on(s, *step);
            }
        }
    }
    for i in 0..p.tables.steps.len() as u32 {
        if set_bit(&mut s.image, set, i, false) {
            mark_on(s, StepId(i));
        }
        if set_bit(&mut s.image, reset, i, false) {
            mark_off(s, StepId(i));
        }
    }
    commit(p, s)
}

/// All charts take the situation of the start; nothing else that was asked for
/// takes place.
fn start(p: &Program, s: &mut State) -> Result<(), Fault> {
    let [init, clear, set, reset] = p.layout.requests;
    for i in 0..p.tables.groups.len() as u32 {
        set_bit(&mut s.image, init, i, false);
        set_bit(&mut s.image, clear, i, false);
    }
    let mut from = 0;
    while let Some(k) = s.steps.next(&s.image, from) {
        mark_off(s, StepId(k));
        from = k + 1;
    }
    for i in 0..p.tables.steps.len() as u32 {
        set_bit(&mut s.image, set, i, false);
        set_bit(&mut s.image, reset, i, false);
    }
    for step in &p.tables.initial {
        mark_on(s, *step);
    }
    carry_out(p, s)
}

/// One pass of the evolution, between [`begin`] and [`finish`].
///
/// Tells whether it changed a step or a variable; under the search for stability this
/// means that another pass is needed.
///
/// # Errors
///
/// A [`Fault`] of a receptivity, an action or a forcing order.
pub fn pass(p: &Program, s: &mut State) -> Result<bool, Fault> {
    if s.scratch.first_pass {
        s.scratch.first_pass = false;
    } else {
        watch::update(p, s, false, false)?;
    }
    evolve(p, s)
}

/// The last part of a scan: control blocks, bodies, POST.
///
/// # Errors
///
/// A [`Fault`] of a condition, a body or POST.
pub fn finish(p: &Program, s: &mut State) -> Result<(), Fault> {
    let t = &p.tables;
    if let Some((steps, transitions)) = t.counts {
        let moved = s.scratch.moved;
        counts::count(p, s, moved, steps, transitions)?;
    }
    if t.rules.periodic_first {
        periodics(p, s);
        late(p, s)?;
    }
    if !t.contributions.is_empty() {
        gates(p, s);
        blocks::conditions(p, s, |_| true)?;
    }
    settle(p, s)
}

/// The last part of a scan after conditions were evaluated.
fn settle(p: &Program, s: &mut State) -> Result<(), Fault> {
    let t = &p.tables;
    if t.blocks.is_empty() {
        s.scratch.timers_due = i64::MAX;
    } else {
        blocks::evaluate(p, s)?;
    }
    if !t.rules.periodic_first {
        periodics(p, s);
    }
    late(p, s)?;
    if p.frame {
        run(p, s, t.post)?;
        run(p, s, t.tail)?;
    }
    if let Some((flag, limits)) = t.limits
        && (counts::active_now(p, s) > limits.active || counts::enabled_now(p, s) > limits.enabled)
    {
        write(p, s, flag, 1);
        return Err(FaultKind::Table.nowhere());
    }
    if core::mem::take(&mut s.scratch.worked) && !t.locals.is_empty() {
        let (from, to) = (s.vars + t.locals.start, s.vars + t.locals.end);
        if let Some(words) = s.image.get_mut(from as usize..to as usize) {
            words.fill(0);
        }
    }
    s.scratch.quiet = p.timeless && s.scratch.idle && !s.scratch.changed && !waits(p, s);
    Ok(())
}

/// True if an edge, a timer, a request or an action needs the next scan.
fn waits(p: &Program, s: &State) -> bool {
    let l = &p.layout;
    let watched = !p.tables.watches.is_empty()
        && [&l.edged, &l.dirty, &l.running].iter().any(|tree| !tree.is_empty(&s.image));
    watched || s.has_flag(REQUESTS) || !l.blocks.is_empty(&s.image) || !l.periodics.is_empty(&s.image)
}

/// Puts the `each scan` actions of the active steps aside for the end of the scan.
fn periodics(p: &Program, s: &mut State) {
    if p.tables.periodics.is_empty() {
        return;
    }
    let mut walk = Walk::new(&p.layout.periodics, &s.image);
    while let Some(i) = walk.next(&p.layout.periodics, &s.image) {
        if p.tables.rules.periodic_first && !bit(&s.scratch.before, 0, i) {
            continue;
        }
        let Some(&action) = p.tables.periodics.get(i as usize) else { break };
        set_bit(&mut s.scratch.late, 0, action, true);
        s.scratch.late_any = true;
    }
}

/// Runs the actions that were put aside for the end of the scan, in order of rank.
fn late(p: &Program, s: &mut State) -> Result<(), Fault> {
    if !core::mem::take(&mut s.scratch.late_any) {
        return Ok(());
    }
    for k in 0..s.scratch.late.len() {
        while let Some(w) = s.scratch.late.get(k).copied().filter(|w| *w != 0) {
            let i = w.trailing_zeros();
            if let Some(w) = s.scratch.late.get_mut(k) {
                *w &= !(1u64 << i);
            }
            run_action(p, s, k as u32 * 64 + i)?;
        }
    }
    Ok(())
}

/// Stops the program: the outputs take their safe values, and no further scan runs.
fn stop(p: &Program, s: &mut State) {
    s.set_flag(STOPPED, true);
    s.scratch.quiet = false;
    s.scratch.drop_marks();
    for (i, v) in (p.tables.outputs.start..p.tables.outputs.end).zip(&p.tables.safe) {
        s.set((s.vars + i) as usize, *v);
    }
}

/// Evaluates code that pushes one value on the state as it is, such as the condition of
/// a test or an expression of the debugger.
///
/// # Errors
///
/// A [`Fault`] of the code.
pub fn eval(p: &Program, s: &mut State, code: Code) -> Result<u64, Fault> {
    s.scratch.work = 0;
    s.scratch.stack.clear();
    value(p, s, code)
}

/// Activates or deactivates a step from outside, as a debugger does. Its stored actions
/// do not run and enclosed charts do not follow; the services do that.
pub fn set_step(p: &Program, s: &mut State, step: StepId, on: bool) {
    if step.0 as usize >= p.tables.steps.len() || s.is_active(step) == on {
        return;
    }
    s.scratch.quiet = false;
    s.scratch.lone = NONE;
    if on {
        activate(p, s, step.0);
    } else {
        crate::change::deactivate(p, s, step.0);
    }
}
