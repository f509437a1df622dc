//! One pass of the evolution: finds enabled and clearable transitions, chooses among them, clears
//! all of them at once (or one after the other under `sequential`), then applies hierarchy and
//! forcing.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{ActionKind, ChartKind, ProfileName};

use super::exec::Exec;
use super::force::{forced_situations, impose};
use super::model::{Model, ScopeId, StepId, TransId};
use super::state::State;
use super::stored;
use super::value::Run;
use super::{Diagnostics, Marks};

/// The steps that a pass, or the services before it, activated and deactivated.
#[derive(Clone, Debug, Default)]
pub(super) struct Changes {
    pub(super) on: BTreeSet<StepId>,
    pub(super) off: BTreeSet<StepId>,
    /// Cleared transitions whose actions have not run yet.
    pub(super) cleared: BTreeSet<TransId>,
    /// The steps and actions whose event occurred.
    pub(super) events: BTreeSet<(StepId, usize)>,
}

impl Changes {
    pub(super) fn add(&mut self, more: &Changes) {
        self.on.extend(&more.on);
        self.off.extend(&more.off);
        self.cleared.extend(&more.cleared);
        self.events.extend(&more.events);
    }
}

/// True if every preceding step is active; for a macro-step its exit step.
pub(super) fn enabled(m: &Model, s: &State, t: TransId) -> bool {
    m.transitions[t].pre.iter().all(|&p| match m.steps[p].expansion {
        Some((_, _, exit)) => s.active.contains(&exit),
        None => s.active.contains(&p),
    })
}

/// One pass.
pub(super) fn pass(
    m: &Model,
    s: &mut State,
    due: &[bool],
    diagnostics: &mut Diagnostics,
    marks: &mut Marks,
) -> Run<Changes> {
    let before = s.clone();
    let forced = forced_situations(m, &before)?;
    let events = true_events(m, s, due)?;
    let mut ready = Vec::new();
    for t in 0..m.transitions.len() {
        let scope = m.transitions[t].scope;
        if m.is_live(scope)
            && enabled(m, s, t)
            && due[scope]
            && !forced.contains_key(&m.scopes[scope].root)
            && !held(m, s, scope)
            && task_allows(m, s, t)
        {
            ready.push(t);
        }
    }
    let chosen = choose(m, s, ready)?;
    marks.cleared.extend(&chosen);

    if m.rules.sequential && !m.rules.parallel_actions {
        return one_after_the_other(m, s, due, &chosen, &forced, events, diagnostics);
    }
    let mut flow = Flow { next: s.active.clone(), left: BTreeSet::new() };
    let back = tasks(m, s, due, &chosen);
    let back = back.into_iter().map(|(exit, entry)| (BTreeSet::from([exit]), BTreeSet::from([entry])));
    let steps = chosen.iter().map(|&t| (flat(leaving(m, t)), flat(arriving(m, t)))).chain(back);
    if m.rules.sequential {
        for (off, on) in steps {
            flow.turn(&off, &on);
        }
    } else {
        let (mut off, mut on) = (BTreeSet::new(), BTreeSet::new());
        for (o, n) in steps {
            off.extend(o);
            on.extend(n);
        }
        off.retain(|x| !on.contains(x));
        flow.turn(&off, &on);
    }
    for (chart, situation) in &forced {
        if let Some(set) = situation {
            impose(m, *chart, set, &mut flow.next);
        }
    }
    let again: BTreeSet<StepId> =
        flow.left.iter().copied().filter(|x| before.active.contains(x) && flow.next.contains(x)).collect();
    hierarchy(m, &before.active, &again, &mut flow.next);
    let mut changes = settle(m, s, flow.next, &again);
    changes.cleared.extend(chosen);
    changes.events = events;
    stored::run(m, s, &before, &changes, diagnostics)?;
    Ok(changes)
}

/// The order of JGrafchart: each transition runs the exit actions of its preceding steps,
/// deactivates them, activates the succeeding steps and runs their entry actions, before the next
/// transition does. Hierarchy and forcing follow, with the other stored actions.
fn one_after_the_other(
    m: &Model,
    s: &mut State,
    due: &[bool],
    chosen: &[TransId],
    forced: &BTreeMap<ScopeId, Option<BTreeSet<StepId>>>,
    events: BTreeSet<(StepId, usize)>,
    diagnostics: &mut Diagnostics,
) -> Run<Changes> {
    let before = s.active.clone();
    let mut all = Changes::default();
    // The owners of tasks are decided in the situation at the start of the pass.
    let by_themselves = tasks(m, s, due, chosen);
    for &t in chosen {
        let begun = s.clone();
        if let Some(block) = &m.transitions[t].on_clearing {
            Exec::new(m, s).body(m.transitions[t].scope, block)?;
        }
        for x in leaving(m, t).into_iter().flatten() {
            leave(m, s, x, &mut all)?;
        }
        for x in arriving(m, t).into_iter().flatten() {
            enter(m, s, x, &begun, &mut all)?;
        }
    }
    let mut next = s.active.clone();
    for (exit, entry) in by_themselves {
        next.remove(&exit);
        next.insert(entry);
    }
    for (chart, situation) in forced {
        if let Some(set) = situation {
            impose(m, *chart, set, &mut next);
        }
    }
    hierarchy(m, &before, &BTreeSet::new(), &mut next);
    let mut changes = settle(m, s, next, &BTreeSet::new());
    changes.events = events;
    let so_far = s.clone();
    stored::run(m, s, &so_far, &changes, diagnostics)?;
    all.add(&changes);
    Ok(all)
}

/// Deactivates a step, after its exit actions, and then everything that it encloses.
fn leave(m: &Model, s: &mut State, step: StepId, all: &mut Changes) -> Run<()> {
    if !s.active.contains(&step) {
        return Ok(());
    }
    stored::at_once(m, s, step, false)?;
    let next = &s.active - &BTreeSet::from([step]);
    all.add(&settle(m, s, next, &BTreeSet::new()));
    for &chart in &m.steps[step].encloses {
        let mut enclosed = BTreeSet::new();
        m.everything_in(chart, &mut enclosed);
        for inner in enclosed {
            leave(m, s, inner, all)?;
        }
    }
    Ok(())
}

/// Activates a step and the linked steps of the charts that it encloses, then runs its entry
/// actions. `begun` is the state before the transition cleared.
fn enter(m: &Model, s: &mut State, step: StepId, begun: &State, all: &mut Changes) -> Run<()> {
    if s.active.contains(&step) {
        return Ok(());
    }
    let next = &s.active | &BTreeSet::from([step]);
    all.add(&settle(m, s, next, &BTreeSet::new()));
    // A token that moves inside the expansion does not leave the macro-step.
    for x in (0..m.steps.len()).filter(|&x| m.steps[x].expansion.is_some()) {
        if begun.is_active(m, x) && s.is_active(m, x) {
            let kept = begun.macro_timing.get(&x).copied().unwrap_or_default();
            s.macro_timing.insert(x, kept);
        }
    }
    stored::at_once(m, s, step, true)?;
    for &chart in &m.steps[step].encloses {
        for &inner in m.scopes[chart].steps.iter().filter(|&&inner| m.steps[inner].linked) {
            enter(m, s, inner, begun, all)?;
            if let Some((_, entry, _)) = m.steps[inner].expansion {
                enter(m, s, entry, begun, all)?;
            }
        }
    }
    Ok(())
}

/// The situation after the clearings so far.
struct Flow {
    next: BTreeSet<StepId>,
    /// The steps deactivated on the way, even if they were activated again.
    left: BTreeSet<StepId>,
}

impl Flow {
    fn turn(&mut self, off: &BTreeSet<StepId>, on: &BTreeSet<StepId>) {
        for x in off {
            if self.next.remove(x) {
                self.left.insert(*x);
            }
        }
        self.next.extend(on);
    }
}

/// The steps that a transition deactivates, each with those that follow it: an exit step before its
/// macro-step, the exit step of a task after its caller.
fn leaving(m: &Model, t: TransId) -> Vec<Vec<StepId>> {
    let mut groups = Vec::new();
    for &p in &m.transitions[t].pre {
        groups.push(m.steps[p].expansion.map(|(_, _, exit)| exit).into_iter().chain([p]).collect());
        groups.extend(
            m.steps[p].calls.iter().filter_map(|&task| m.ends(task).ok()).map(|(_, exit)| vec![exit]),
        );
    }
    groups
}

/// The steps that a transition activates: a macro-step before its entry step.
fn arriving(m: &Model, t: TransId) -> Vec<Vec<StepId>> {
    let mut groups: Vec<Vec<StepId>> = Vec::new();
    for &p in &m.transitions[t].pre {
        groups.extend(
            m.steps[p].calls.iter().filter_map(|&task| m.ends(task).ok()).map(|(entry, _)| vec![entry]),
        );
    }
    for &p in &m.transitions[t].post {
        groups.push([p].into_iter().chain(m.steps[p].expansion.map(|(_, entry, _)| entry)).collect());
    }
    groups
}

fn flat(groups: Vec<Vec<StepId>>) -> BTreeSet<StepId> {
    groups.into_iter().flatten().collect()
}

/// True if a chart is frozen, or if steps have enabling orders for it and none of them is active. A
/// macro-step gives its orders like its actions: from its activation to its clearing.
fn held(m: &Model, s: &State, scope: ScopeId) -> bool {
    let root = m.scopes[scope].root;
    let waits = m.enables.get(&root).is_some_and(|by| !by.iter().any(|e| s.active.contains(e)));
    waits || s.frozen.contains(&root) || s.stopped
}

/// The callers of a task, in the order of the text.
fn callers(m: &Model, task: ScopeId) -> impl Iterator<Item = StepId> {
    (0..m.steps.len()).filter(move |&c| m.steps[c].calls.contains(&task))
}

/// True if the conditions of decision 15 let a transition clear.
fn task_allows(m: &Model, s: &State, t: TransId) -> bool {
    let transition = &m.transitions[t];
    let scope = transition.scope;
    let leaves_entry = m.scopes[scope].kind == ChartKind::Task
        && m.ends(scope).is_ok_and(|(entry, _)| transition.pre.contains(&entry));
    if leaves_entry && !callers(m, scope).any(|c| s.active.contains(&c)) {
        return false;
    }
    transition.pre.iter().all(|&p| {
        m.steps[p].calls.iter().all(|&task| {
            m.ends(task).is_ok_and(|(_, exit)| s.active.contains(&exit)) && s.owners.get(&task) == Some(&p)
        })
    })
}

/// Assigns tasks to their callers and releases them; returns the exit and entry steps of the tasks
/// that return by themselves.
fn tasks(m: &Model, s: &mut State, due: &[bool], chosen: &[TransId]) -> Vec<(StepId, StepId)> {
    let mut by_themselves = Vec::new();
    let begun = s.clone();
    for (task, due) in due.iter().enumerate() {
        if m.scopes[task].kind != ChartKind::Task {
            continue;
        }
        let Ok((entry, exit)) = m.ends(task) else { continue };
        let handed_back =
            chosen.iter().any(|&t| m.transitions[t].pre.iter().any(|&p| m.steps[p].calls.contains(&task)));
        let owner_gone = !begun.owners.get(&task).is_some_and(|o| begun.active.contains(o));
        let by_itself = *due && begun.active.contains(&exit) && owner_gone;
        if handed_back || by_itself {
            s.owners.remove(&task);
        }
        if by_itself {
            by_themselves.push((exit, entry));
        }
        let begins =
            chosen.iter().any(|&t| m.transitions[t].scope == task && m.transitions[t].pre.contains(&entry));
        if begins
            && !begun.owners.contains_key(&task)
            && let Some(first) = callers(m, task).find(|c| begun.active.contains(c))
        {
            s.owners.insert(task, first);
        }
    }
    by_themselves
}

/// Chooses the transitions that clear: those with a true receptivity, and of these as many as the
/// profile lets share a preceding step.
fn choose(m: &Model, s: &mut State, ready: Vec<TransId>) -> Run<Vec<TransId>> {
    let shares =
        |a: TransId, b: TransId| m.transitions[a].pre.iter().any(|p| m.transitions[b].pre.contains(p));
    let mut is_true =
        |t: TransId| Exec::new(m, s).receptivity(m.transitions[t].scope, &m.transitions[t].receptivity);
    if !m.rules.multi_token {
        // In order of priority: once a step is used, no further receptivity of it is evaluated.
        let mut ranked = ready;
        ranked.sort_by_key(|&t| (turn(m, t), m.transitions[t].priority.unwrap_or(u32::MAX), t));
        let mut chosen: Vec<TransId> = Vec::new();
        for t in ranked {
            if !chosen.iter().any(|&c| shares(c, t)) && is_true(t)? {
                chosen.push(t);
            }
        }
        return Ok(chosen);
    }
    let mut clearable = Vec::new();
    for t in ready {
        if is_true(t)? {
            clearable.push(t);
        }
    }
    if m.rules.profile != ProfileName::Jgrafchart {
        clearable.sort_by_key(|&t| (turn(m, t), t));
        return Ok(clearable);
    }
    let beaten = |t: TransId| {
        // A transition without a number has the lowest priority.
        let number = |t: TransId| m.transitions[t].priority.unwrap_or(u32::MAX);
        clearable.iter().any(|&o| shares(o, t) && number(o) < number(t))
    };
    let mut chosen: Vec<TransId> = clearable.iter().copied().filter(|&t| !beaten(t)).collect();
    chosen.sort_by_key(|&t| (turn(m, t), t));
    Ok(chosen)
}

/// The order of transitions if they clear one after the other, chart by chart: the number of
/// enclosing macro-steps, then the position of the chart in the text.
fn turn(m: &Model, t: TransId) -> (usize, ScopeId) {
    let scope = m.transitions[t].scope;
    let depth = m.scopes[scope].qualified.split('.').count();
    if m.rules.sequential { (depth, scope) } else { (0, 0) }
}

/// Applies what enclosing steps activate and deactivate, from the outermost inward.
pub(super) fn hierarchy(
    m: &Model,
    before: &BTreeSet<StepId>,
    again: &BTreeSet<StepId>,
    next: &mut BTreeSet<StepId>,
) {
    for &chart in &m.order {
        for e in m.steps_within(chart) {
            let (was, is) = (before.contains(&e), next.contains(&e));
            for &enclosed in &m.steps[e].encloses {
                if was && (!is || again.contains(&e)) {
                    let mut all = BTreeSet::new();
                    m.everything_in(enclosed, &mut all);
                    next.retain(|x| !all.contains(x));
                }
                if is && (!was || again.contains(&e)) {
                    for &inner in &m.scopes[enclosed].steps {
                        if m.steps[inner].linked {
                            m.activate(inner, next);
                        }
                    }
                }
            }
        }
    }
}

/// Makes `next` the present situation and updates the times.
pub(super) fn settle(m: &Model, s: &mut State, next: BTreeSet<StepId>, again: &BTreeSet<StepId>) -> Changes {
    let before = s.clone();
    let again: BTreeSet<StepId> = again.intersection(&next).copied().collect();
    let on: BTreeSet<StepId> = next.difference(&s.active).chain(&again).copied().collect();
    let off: BTreeSet<StepId> = s.active.difference(&next).chain(&again).copied().collect();
    s.active = next;
    for &x in &off {
        let run = s.timing[x];
        s.timing[x].kept = s.now - run.since;
        s.timing[x].kept_scans = s.scan - run.since_scan;
    }
    for &x in &on {
        s.timing[x].since = s.now;
        s.timing[x].since_scan = s.scan;
    }
    for x in (0..m.steps.len()).filter(|&x| m.steps[x].expansion.is_some()) {
        let (was, is) = (before.is_active(m, x), s.is_active(m, x));
        let (now, scan) = (s.now, s.scan);
        let t = s.macro_timing.entry(x).or_default();
        if was && !is {
            t.kept = now - t.since;
            t.kept_scans = scan - t.since_scan;
        }
        if is && !was {
            t.since = now;
            t.since_scan = scan;
        }
    }
    Changes { on, off, ..Changes::default() }
}

/// The steps and actions whose `on e:` occurs: the step is active and `e` is true at the start of
/// the pass.
fn true_events(m: &Model, s: &mut State, due: &[bool]) -> Run<BTreeSet<(StepId, usize)>> {
    let mut events = BTreeSet::new();
    for (id, step) in m.steps.iter().enumerate() {
        if !due[step.scope] || !s.active.contains(&id) {
            continue;
        }
        for (i, action) in step.actions.iter().enumerate() {
            if let ActionKind::OnEvent { event, .. } = &action.kind
                && Exec::new(m, s).truth(step.scope, event)?
            {
                events.insert((id, i));
            }
        }
    }
    Ok(events)
}
