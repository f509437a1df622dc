//! One pass of the evolution: enabled, clearable, chosen, cleared all at once
//! (or, `sequential`, one after the other), then hierarchy and forcing.

use std::collections::BTreeSet;

use g7_model::{ActionKind, ChartKind, ProfileName};

use super::exec::Exec;
use super::force::{forced_situations, impose};
use super::model::{Model, ScopeId, StepId, TransId};
use super::state::{State, Timing};
use super::stored::{self, Happened};
use super::value::Run;
use super::{Diagnostics, Marks};

/// Steps that a pass, or the services before it, turned on and off.
#[derive(Clone, Debug, Default)]
pub(super) struct Changes {
    pub(super) on: BTreeSet<StepId>,
    pub(super) off: BTreeSet<StepId>,
}

/// Every step of `pre` is active, of a macro-step its exit step.
pub(super) fn enabled(m: &Model, s: &State, t: TransId) -> bool {
    m.transitions[t].pre.iter().all(|&p| match m.steps[p].expansion {
        Some((_, _, exit)) => s.active.contains(&exit),
        None => s.active.contains(&p),
    })
}

/// One pass; `earlier` are changes by services whose stored actions run now.
pub(super) fn pass(
    m: &Model,
    s: &mut State,
    due: &[bool],
    earlier: Changes,
    diagnostics: &mut Diagnostics,
    marks: &mut Marks,
) -> Run<Changes> {
    let before = s.clone();
    let forced = forced_situations(m, &before)?;
    let events = true_events(m, s, due)?;
    let mut clearable = Vec::new();
    for t in 0..m.transitions.len() {
        let scope = m.transitions[t].scope;
        if enabled(m, s, t)
            && due[scope]
            && !forced.contains_key(&m.scopes[scope].root)
            && !held(m, s, scope)
            && task_allows(m, s, t)
            && Exec::new(m, s).truth(scope, &m.transitions[t].receptivity)?
        {
            clearable.push(t);
        }
    }
    let chosen = choose(m, &clearable);
    marks.cleared.extend(&chosen);

    let mut flow = Flow { next: s.active.clone(), left: BTreeSet::new() };
    let steps = chosen.iter().map(|&t| (leaving(m, t), arriving(m, t)));
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
    tasks(m, s, due, &chosen, &mut flow);
    for (chart, situation) in &forced {
        if let Some(set) = situation {
            impose(m, *chart, set, &mut flow.next);
        }
    }
    let again: BTreeSet<StepId> =
        flow.left.iter().copied().filter(|x| before.active.contains(x) && flow.next.contains(x)).collect();
    hierarchy(m, &before.active, &again, &mut flow.next);
    let mut changes = settle(m, s, flow.next, &again);
    changes.on.extend(earlier.on);
    changes.off.extend(earlier.off);
    let happened = Happened { cleared: &chosen, changes: &changes, events: &events, clearing: true };
    stored::run(m, s, &before, &happened, diagnostics)?;
    Ok(changes)
}

/// The situation that the clearings so far lead to.
struct Flow {
    next: BTreeSet<StepId>,
    /// Steps turned off on the way, whether or not they came on again.
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

fn leaving(m: &Model, t: TransId) -> BTreeSet<StepId> {
    let mut off = BTreeSet::new();
    for &p in &m.transitions[t].pre {
        off.insert(p);
        off.extend(m.steps[p].expansion.map(|(_, _, exit)| exit));
    }
    off
}

fn arriving(m: &Model, t: TransId) -> BTreeSet<StepId> {
    let mut on = BTreeSet::new();
    for &p in &m.transitions[t].post {
        on.insert(p);
        on.extend(m.steps[p].expansion.map(|(_, entry, _)| entry));
    }
    on
}

/// Frozen, or not enabled by any step although some step enables it.
fn held(m: &Model, s: &State, scope: ScopeId) -> bool {
    let root = m.scopes[scope].root;
    let waits = m.enables.get(&root).is_some_and(|by| !by.iter().any(|&e| s.is_active(m, e)));
    waits || s.frozen.contains(&root) || s.system(m, "S23")
}

/// The callers of a task, in the order of the text.
fn callers(m: &Model, task: ScopeId) -> impl Iterator<Item = StepId> {
    (0..m.steps.len()).filter(move |&c| m.steps[c].calls.contains(&task))
}

/// The guards of decision 15.
fn task_allows(m: &Model, s: &State, t: TransId) -> bool {
    let transition = &m.transitions[t];
    let scope = transition.scope;
    let leaves_entry = m.scopes[scope].kind == ChartKind::Task
        && m.ends(scope).is_ok_and(|(entry, _)| transition.pre.contains(&entry));
    if leaves_entry && !callers(m, scope).any(|c| s.is_active(m, c)) {
        return false;
    }
    transition.pre.iter().all(|&p| {
        m.steps[p].calls.iter().all(|&task| {
            m.ends(task).is_ok_and(|(_, exit)| s.active.contains(&exit)) && s.owners.get(&task) == Some(&p)
        })
    })
}

/// Hands tasks to their callers, back from them, and back by themselves.
fn tasks(m: &Model, s: &mut State, due: &[bool], chosen: &[TransId], flow: &mut Flow) {
    for task in 0..m.scopes.len() {
        if m.scopes[task].kind != ChartKind::Task {
            continue;
        }
        let Ok((entry, exit)) = m.ends(task) else { continue };
        let handed_back =
            chosen.iter().any(|&t| m.transitions[t].pre.iter().any(|&p| m.steps[p].calls.contains(&task)));
        let owner_gone = !s.owners.get(&task).is_some_and(|&o| s.is_active(m, o));
        let by_itself = due[task] && s.active.contains(&exit) && owner_gone;
        if handed_back || by_itself {
            s.owners.remove(&task);
            flow.turn(&BTreeSet::from([exit]), &BTreeSet::from([entry]));
        }
        let begins =
            chosen.iter().any(|&t| m.transitions[t].scope == task && m.transitions[t].pre.contains(&entry));
        if begins && !s.owners.contains_key(&task) {
            if let Some(first) = callers(m, task).find(|&c| s.is_active(m, c)) {
                s.owners.insert(task, first);
            }
        }
    }
}

/// Which of the clearable transitions clear.
fn choose(m: &Model, clearable: &[TransId]) -> Vec<TransId> {
    let shares =
        |a: TransId, b: TransId| m.transitions[a].pre.iter().any(|p| m.transitions[b].pre.contains(p));
    if !m.rules.multi_token {
        let mut ranked = clearable.to_vec();
        ranked.sort_by_key(|&t| (m.transitions[t].priority.unwrap_or(u32::MAX), t));
        let mut chosen: Vec<TransId> = Vec::new();
        for t in ranked {
            if !chosen.iter().any(|&c| shares(c, t)) {
                chosen.push(t);
            }
        }
        chosen.sort_unstable();
        return chosen;
    }
    if m.rules.profile != ProfileName::Jgrafchart {
        return clearable.to_vec();
    }
    let beaten = |t: TransId| {
        let Some(mine) = m.transitions[t].priority else { return false };
        clearable.iter().any(|&o| shares(o, t) && m.transitions[o].priority.is_some_and(|p| p < mine))
    };
    clearable.iter().copied().filter(|&t| !beaten(t)).collect()
}

/// What enclosing steps bring and take, from the outermost inward.
fn hierarchy(m: &Model, before: &BTreeSet<StepId>, again: &BTreeSet<StepId>, next: &mut BTreeSet<StepId>) {
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

/// Makes `next` the situation, with the times that follow.
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
        let t = s.macro_timing.entry(x).or_insert_with(Timing::default);
        if was && !is {
            t.kept = now - t.since;
            t.kept_scans = scan - t.since_scan;
        }
        if is && !was {
            t.since = now;
            t.since_scan = scan;
        }
    }
    Changes { on, off }
}

/// Steps and actions whose `on e:` is due: the step is active and `e` true at
/// the start of the pass.
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
