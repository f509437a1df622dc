//! One scan: inputs in, evolution, actions, outputs (SEMANTICS section 4).

use crate::bits::{Walk, bit, set_bit, word};
use crate::change::{activate, commit, mark_off, mark_on, run_action};
use crate::fault::{Fault, FaultKind};
use crate::pass::{arcs, evolve, rest_active};
use crate::run::{self, write};
use crate::state::{REQUESTS, STARTED, STOPPED, State, head};
use crate::watch;
use crate::{Addr, Code, NONE, Program, StepId, blocks};

/// What a scan did.
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

/// Passes before cycles are looked for: most searches are shorter, and looking
/// costs a copy of the image.
const PATIENCE: u32 = 48;

/// Runs one scan.
///
/// `inputs` has a word for each word of [`crate::Tables::inputs`]; `now` is
/// monotonic, in nanoseconds. After it the outputs stand in the variable area.
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
    if s.x.quiet && still(p, s, inputs, now) {
        return Ok(Report { passes: 1, cleared: 0, conflict: None });
    }
    if p.bare && begin_bare(p, s, inputs, now) {
        if !p.t.rules.stable
            && let Some(moved) = crate::bare::one_token(p, s, now as u64)
        {
            s.x.quiet = !moved && p.timeless;
            return Ok(Report { passes: 1, cleared: u32::from(moved), conflict: None });
        }
        return bare(p, s);
    }
    whole(p, s, inputs, now)
}

/// The rest of the short way, behind [`begin_bare`].
#[inline(never)]
fn bare(p: &Program, s: &mut State) -> Result<Report, Fault> {
    let x = &mut s.x;
    x.cleared_count = 0;
    x.passes = 0;
    x.conflict = None;
    x.work = 0;
    let done = search(p, s, crate::bare::evolve);
    s.x.quiet = p.timeless && s.x.idle;
    end(p, s, done)
}

/// The general way.
#[inline(never)]
fn whole(p: &Program, s: &mut State, inputs: &[u64], now: i64) -> Result<Report, Fault> {
    let done = begin(p, s, inputs, now).and_then(|()| search(p, s, pass)).and_then(|()| finish(p, s));
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

/// What [`begin`] does for programs that consist of steps, transitions and
/// outputs that follow one step. False where a scan before is missing, a fault
/// came or the inputs do not fit; then nothing was done.
#[inline(always)]
fn begin_bare(p: &Program, s: &mut State, inputs: &[u64], now: i64) -> bool {
    let (from, to) = ((s.vars + p.t.inputs.start) as usize, (s.vars + p.t.inputs.end) as usize);
    let before = s.now();
    if !s.has_only_flag(STARTED) || now < before {
        return false;
    }
    let Some(area) = s.w.get_mut(from..to) else { return false };
    if area.len() != inputs.len() {
        return false;
    }
    take(area, inputs);
    tick(s, now.wrapping_sub(before), now);
    s.x.cleared.clear();
    true
}

/// Copies the inputs; few of them word by word, which takes less than a call.
#[inline(always)]
fn take(area: &mut [u64], inputs: &[u64]) {
    if inputs.len() > 8 {
        area.copy_from_slice(inputs);
        return;
    }
    for (a, i) in area.iter_mut().zip(inputs) {
        if *a != *i {
            *a = *i;
        }
    }
}

/// A scan begins: time goes on.
#[inline(always)]
fn tick(s: &mut State, dt: i64, now: i64) {
    if let Some(head) = s.w.first_chunk_mut::<{ head::WORDS as usize }>() {
        head[head::DT] = dt as u64;
        head[head::NOW] = now as u64;
        head[head::SCANS] = head[head::SCANS].wrapping_add(1);
    }
}

/// A scan in which nothing can happen: the one before ended in a situation that
/// a further pass does not change, no input differs, and nothing waits for the
/// time. Then only the time goes on.
#[inline]
fn still(p: &Program, s: &mut State, inputs: &[u64], now: i64) -> bool {
    let (from, to) = ((s.vars + p.t.inputs.start) as usize, (s.vars + p.t.inputs.end) as usize);
    let before = s.now();
    let Some(area) = s.w.get(from..to) else { return false };
    if area.len() != inputs.len() || now < before || area.iter().zip(inputs).any(|(a, i)| a != i) {
        return false;
    }
    tick(s, now.wrapping_sub(before), now);
    s.x.cleared.clear();
    s.x.ran.clear();
    true
}

fn report(s: &State) -> Report {
    Report { passes: s.x.passes, cleared: s.x.cleared_count, conflict: s.x.conflict }
}

/// Passes until nothing changes, or just one.
#[inline]
fn search(
    p: &Program,
    s: &mut State,
    pass: impl Fn(&Program, &mut State) -> Result<bool, Fault>,
) -> Result<(), Fault> {
    let rules = &p.t.rules;
    if !rules.stable {
        return pass(p, s).map(|_| ());
    }
    // Brent's cycle search: a saved image, renewed at doubling distances. Within
    // a scan time and inputs stand still, so a recurring image recurs for ever.
    let (mut power, mut distance) = (1u32, 0u32);
    let mut made = 0u32;
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
            if s.x.saved.as_slice() == &*s.w {
                return Err(FaultKind::Unstable { cycle: distance }.nowhere());
            }
        }
        if made == PATIENCE || distance == power {
            let State { w, x, .. } = s;
            x.saved.clear();
            x.saved.extend_from_slice(w);
            power = if made == PATIENCE { 1 } else { power.saturating_mul(2) };
            distance = 0;
        }
    }
    Ok(())
}

/// The first part of a scan: inputs, time, watches, PRE, services.
///
/// # Errors
///
/// [`FaultKind::Inputs`] where the inputs are not as many as the program's or
/// `now` lies before the scan before; nothing was changed then. Other faults
/// come from PRE.
pub fn begin(p: &Program, s: &mut State, inputs: &[u64], now: i64) -> Result<(), Fault> {
    let t = &p.t;
    if s.has_flag(STOPPED) {
        return Err(FaultKind::Stopped.nowhere());
    }
    let fresh = !s.has_flag(STARTED);
    if inputs.len() != (t.inputs.end - t.inputs.start) as usize || (!fresh && now < s.now()) {
        return Err(FaultKind::Inputs.nowhere());
    }
    reset_scratch(s);
    s.x.quiet = false;
    s.x.lone = NONE;
    let before = if fresh { now } else { s.now() };
    tick(s, now.wrapping_sub(before), now);
    if p.has_periods {
        periods(p, s, now, fresh);
    }
    for (i, v) in (t.inputs.start..).zip(inputs) {
        if word(&s.w, (s.vars + i) as usize) != *v {
            s.set((s.vars + i) as usize, *v);
            run::notice(p, s, Addr(i));
        }
    }
    if fresh {
        s.flag(STARTED, true);
        for step in &t.initial {
            mark_on(s, *step);
        }
        initial(p, s)?;
    }
    watch::update(p, s, true, fresh)?;
    if p.frame {
        run::run(p, s, t.pre)?;
        run::run(p, s, t.services)?;
    }
    s.x.stepped = fresh;
    if s.has_flag(REQUESTS) {
        requests(p, s)?;
    }
    if t.rules.late_actions && s.x.stepped {
        blocks::look(p, s)?;
    }
    if t.counts.is_some() {
        enabled(p, s, false)?;
    }
    s.x.moved = 0;
    if t.rules.periodic_first {
        let base = p.layout.periodics.base() as usize;
        let State { w, x, .. } = s;
        for (b, now) in x.before.iter_mut().zip(w.get(base..).unwrap_or_default()) {
            *b = *now;
        }
    }
    s.x.first_pass = true;
    Ok(())
}

/// The initial situation (rule 1). Under `sequential` its actions run at once as well.
fn initial(p: &Program, s: &mut State) -> Result<(), Fault> {
    commit(p, s)
}

fn reset_scratch(s: &mut State) {
    let x = &mut s.x;
    x.stack.clear();
    x.fired.clear();
    x.runs.clear();
    x.commits.clear();
    x.cleared.clear();
    x.ran.clear();
    x.log.clear();
    x.logging = false;
    x.cleared_count = 0;
    x.passes = 0;
    x.conflict = None;
    x.work = 0;
    x.late_any = false;
}

/// Which periods are due; instants missed are skipped, not queued.
fn periods(p: &Program, s: &mut State, now: i64, fresh: bool) {
    for (i, period) in p.t.periods.iter().enumerate() {
        let at = p.layout.periods as usize + i;
        let next = word(&s.w, at) as i64;
        let due = *period <= 0 || fresh || now >= next;
        if let Some(d) = s.x.due.get_mut(i) {
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
    s.flag(REQUESTS, false);
    let [init, clear, set, reset] = p.layout.requests;
    for (i, group) in p.t.groups.iter().enumerate() {
        let i = i as u32;
        let initialise = set_bit(&mut s.w, init, i, false);
        let empty = set_bit(&mut s.w, clear, i, false);
        if initialise || empty {
            let mut from = group.steps.start;
            while let Some(k) = s.steps.next(&s.w, from).filter(|k| *k < group.steps.end) {
                mark_off(s, StepId(k));
                from = k + 1;
            }
        }
        if initialise {
            for step in arcs(p, group.initial) {
                mark_on(s, *step);
            }
        }
    }
    for i in 0..p.t.steps.len() as u32 {
        if set_bit(&mut s.w, set, i, false) {
            mark_on(s, StepId(i));
        }
        if set_bit(&mut s.w, reset, i, false) {
            mark_off(s, StepId(i));
        }
    }
    commit(p, s)
}

/// One pass of the evolution, between [`begin`] and [`finish`].
///
/// Whether it changed a step or a variable: under search for stability, whether
/// another is needed.
///
/// # Errors
///
/// A [`Fault`] of a receptivity, an action or a forcing order.
pub fn pass(p: &Program, s: &mut State) -> Result<bool, Fault> {
    s.x.lone = NONE;
    if s.x.first_pass {
        s.x.first_pass = false;
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
    let t = &p.t;
    if let Some((steps, transitions)) = t.counts {
        let moved = s.x.moved;
        count(p, s, moved, steps, transitions)?;
    }
    if t.rules.periodic_first {
        periodics(p, s);
        late(p, s)?;
    }
    if !t.contributions.is_empty() {
        blocks::conditions(p, s, |_| true)?;
    }
    if !t.blocks.is_empty() {
        blocks::evaluate(p, s)?;
    }
    if !t.rules.periodic_first {
        periodics(p, s);
    }
    late(p, s)?;
    if p.frame {
        run::run(p, s, t.post)?;
        run::run(p, s, t.tail)?;
    }
    if let Some((flag, limits)) = t.limits
        && (active_now(p, s) > limits.active || enabled_now(p, s) > limits.enabled)
    {
        write(p, s, flag, 1);
        return Err(FaultKind::Table.nowhere());
    }
    if !t.locals.is_empty() {
        let (from, to) = (s.vars + t.locals.start, s.vars + t.locals.end);
        if let Some(words) = s.w.get_mut(from as usize..to as usize) {
            words.fill(0);
        }
    }
    s.x.quiet = p.timeless && s.x.idle && !s.x.changed && !waits(p, s);
    Ok(())
}

/// Whether an edge, a timer or a control block wants the next scan.
fn waits(p: &Program, s: &State) -> bool {
    let l = &p.layout;
    let watched =
        !p.t.watches.is_empty() && [&l.edged, &l.dirty, &l.running].iter().any(|tree| !tree.is_empty(&s.w));
    watched || s.has_flag(REQUESTS) || !l.blocks.is_empty(&s.w) || !l.periodics.is_empty(&s.w)
}

/// Actions of each scan of the active steps.
fn periodics(p: &Program, s: &mut State) {
    let mut walk = Walk::new(&p.layout.periodics, &s.w);
    while let Some(i) = walk.next(&p.layout.periodics, &s.w) {
        if p.t.rules.periodic_first && !bit(&s.x.before, 0, i) {
            continue;
        }
        let Some(&action) = p.t.periodics.get(i as usize) else { break };
        set_bit(&mut s.x.late, 0, action, true);
        s.x.late_any = true;
    }
}

/// Runs what was put aside for the end of the scan, in order.
fn late(p: &Program, s: &mut State) -> Result<(), Fault> {
    if !core::mem::take(&mut s.x.late_any) {
        return Ok(());
    }
    for k in 0..s.x.late.len() {
        while let Some(w) = s.x.late.get(k).copied().filter(|w| *w != 0) {
            let i = w.trailing_zeros();
            if let Some(w) = s.x.late.get_mut(k) {
                *w &= !(1u64 << i);
            }
            run_action(p, s, k as u32 * 64 + i)?;
        }
    }
    Ok(())
}

/// Outputs to their safe values; no further scan.
fn stop(p: &Program, s: &mut State) {
    s.flag(STOPPED, true);
    s.x.on_mark.fill(0);
    s.x.off_mark.fill(0);
    s.x.on.clear();
    s.x.off.clear();
    s.x.late.fill(0);
    for (i, v) in (p.t.outputs.start..p.t.outputs.end).zip(&p.t.safe) {
        s.set((s.vars + i) as usize, *v);
    }
}

/// Runs code that pushes one value, on the state as it is: a condition of a
/// test, a watch expression of the debugger.
///
/// # Errors
///
/// A [`Fault`] of its arithmetic.
pub fn eval(p: &Program, s: &mut State, code: Code) -> Result<u64, Fault> {
    s.x.work = 0;
    s.x.stack.clear();
    run::value(p, s, code)
}

/// The active steps of the text.
fn active_now(p: &Program, s: &State) -> u32 {
    let stands_in = |step: &u32| crate::change::extra(p, *step).is_some_and(|e| e.uncounted);
    s.active().filter(|step| !stands_in(&step.0)).count() as u32
}

/// Whether a transition is enabled, of those that count.
fn is_enabled(p: &Program, s: &State, i: usize) -> bool {
    p.t.transitions
        .get(i)
        .filter(|t| !t.uncounted)
        .is_some_and(|t| (t.from.0 == NONE || s.steps.contains(&s.w, t.from.0)) && rest_active(p, s, t))
}

fn enabled_now(p: &Program, s: &State) -> u32 {
    (0..p.t.transitions.len()).filter(|i| is_enabled(p, s, *i)).count() as u32
}

/// Notes which transitions are enabled, before or after the evolution.
fn enabled(p: &Program, s: &mut State, after: bool) -> Result<(), Fault> {
    for i in 0..p.t.transitions.len() {
        let on = is_enabled(p, s, i);
        let x = &mut s.x;
        set_bit(if after { &mut x.enabled_after } else { &mut x.enabled }, 0, i as u32, on);
    }
    if !after {
        s.x.active_before = active_now(p, s);
    }
    Ok(())
}

/// `%SW20` and `%SW21`: what was, and what changed in this scan.
fn count(p: &Program, s: &mut State, moved: u32, steps: Addr, transitions: Addr) -> Result<(), Fault> {
    enabled(p, s, true)?;
    let (mut was, mut changed) = (0, 0);
    for (b, a) in s.x.enabled.iter().zip(s.x.enabled_after.iter()) {
        was += b.count_ones();
        changed += (b ^ a).count_ones();
    }
    let total = |n: u32| u64::from(n.min(32767));
    let active = s.x.active_before;
    write(p, s, steps, total(active.saturating_add(moved)));
    write(p, s, transitions, total(was + changed));
    Ok(())
}

/// Sets a step from outside, as a debugger does: without its stored actions.
/// Enclosed charts do not follow; use the services for that.
pub fn set_step(p: &Program, s: &mut State, step: StepId, on: bool) {
    if step.0 as usize >= p.t.steps.len() || s.is_active(step) == on {
        return;
    }
    s.x.quiet = false;
    s.x.lone = NONE;
    if on {
        activate(p, s, step.0);
    } else {
        crate::change::deactivate(p, s, step.0);
    }
}
