//! The end of a scan: control blocks, continuous actions, bodies, POST.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{Action, ActionKind, Body, Expr, ProfileName, Qualifier, Target, Type};

use super::evolve::Changes;
use super::exec::Exec;
use super::model::{FILE, Model, ScopeId, StepId, VarId};
use super::resolve::Ref;
use super::state::{Control, Owner, State};
use super::value::{Run, Value, bad};

/// The target of a qualified action.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Goal {
    Var(VarId),
    Named(ScopeId, String),
    Own,
}

/// A qualified action that acts at the end of a scan.
struct Block<'m> {
    step: StepId,
    place: usize,
    owner: Owner,
    qualifier: Qualifier,
    time: Option<&'m Expr>,
    condition: Option<&'m Expr>,
}

pub(super) fn goal(m: &Model, scope: ScopeId, target: &Target) -> Run<Goal> {
    let found = match target {
        Target::Work(_) => return Ok(Goal::Own),
        Target::Path(p) => {
            if let [one] = &p.names[..] {
                for s in [scope, FILE] {
                    if m.scopes[s].actions.contains_key(&*one.text) {
                        return Ok(Goal::Named(s, one.text.to_string()));
                    }
                }
            }
            m.resolve(scope, &m.constants_in(scope, p))
        }
        Target::Element(e) => Some(Exec::known_element(m, scope, e)?),
        Target::Direct(d, _) => m.resolve_direct(d),
    };
    match found {
        Some(Ref::Var(v)) if m.vars[v].ty == Type::Bool => Ok(Goal::Var(v)),
        _ => bad(format!("{target:?} cannot be governed")),
    }
}

/// All qualified actions with their targets.
fn qualified(m: &Model) -> Run<Vec<(Block<'_>, Goal)>> {
    let mut all = Vec::new();
    for scope in FILE + 1..m.scopes.len() {
        for &step in &m.scopes[scope].steps {
            for (place, action) in m.steps[step].actions.iter().enumerate() {
                let ActionKind::Qualified { qualifier, time, target, condition } = &action.kind else {
                    continue;
                };
                let goal = goal(m, scope, target)?;
                let owner = match &goal {
                    Goal::Var(v) => Owner::Var(*v),
                    Goal::Named(s, name) => Owner::Named(*s, name.clone()),
                    Goal::Own => Owner::Own(step, place),
                };
                let (time, condition) = (time.as_ref(), condition.as_ref());
                all.push((Block { step, place, owner, qualifier: *qualifier, time, condition }, goal));
            }
        }
    }
    Ok(all)
}

/// True if an association acts at the end of the scan (decision 10) and not as a stored action.
pub(super) fn through_block(m: &Model, goal: &Goal, q: Qualifier) -> bool {
    let Goal::Var(v) = goal else {
        return !(m.rules.stored_pulses() && matches!(q, Qualifier::P1 | Qualifier::P0));
    };
    if !m.rules.stored_pulses() || !matches!(q, Qualifier::S | Qualifier::R) {
        return true;
    }
    m.blocked_vars.contains(v)
}

/// The variables whose associations all go through a control block.
pub(super) fn blocked_vars(m: &Model) -> Run<BTreeSet<VarId>> {
    use Qualifier as Q;
    let mut vars = BTreeSet::new();
    for (block, goal) in qualified(m)? {
        let needs = match m.rules.profile {
            ProfileName::Iec60848 => {
                matches!(block.qualifier, Q::SD | Q::DS | Q::SL | Q::P | Q::P1 | Q::P0)
            }
            ProfileName::Pl7 | ProfileName::Jgrafchart => !matches!(block.qualifier, Q::S | Q::R),
            ProfileName::Iec61131 | ProfileName::Unity => true,
        };
        if let (Goal::Var(v), true) = (goal, needs) {
            vars.insert(v);
        }
    }
    Ok(vars)
}

/// The results of the evolution of a scan.
pub(super) struct Went {
    /// The steps that were active at its start.
    pub(super) start: BTreeSet<StepId>,
    /// The steps that were activated or deactivated in it, including the initialisation.
    pub(super) changes: Changes,
}

/// The result of a control block.
struct Verdict {
    q: bool,
    /// True if the body of its action runs in this scan.
    runs: bool,
    /// Who runs it: P1 (0), P0 (2) or any other qualifier (1).
    pulse: i8,
}

/// The qualified actions that go through control blocks.
fn blocks(m: &Model) -> Run<Vec<Block<'_>>> {
    let all = qualified(m)?.into_iter();
    Ok(all
        .filter(|(b, goal)| through_block(m, goal, b.qualifier))
        .filter(|(b, _)| !is_late_pulse(m, b.step, &m.steps[b.step].actions[b.place]))
        .map(|(b, _)| b)
        .collect())
}

fn owners<'b>(blocks: &'b [Block<'_>]) -> Vec<&'b Owner> {
    let mut owners: Vec<&Owner> = Vec::new();
    for b in blocks {
        if !owners.contains(&&b.owner) {
            owners.push(&b.owner);
        }
    }
    owners
}

/// The value that an association gives to its block in the present situation.
fn input_of(m: &Model, s: &mut State, b: &Block<'_>) -> Run<bool> {
    let scope = m.steps[b.step].scope;
    let on = s.active.contains(&b.step) && !masked(m, s, scope);
    match b.condition {
        Some(c) if on => Exec::new(m, s).truth(scope, c),
        _ => Ok(on),
    }
}

/// The initialisation or a service made a situation: P1 and P0 see it before the evolution, so that
/// a step that is left in the same scan still has its pulses.
pub(super) fn before_evolution(m: &Model, s: &mut State, due: &[bool]) -> Run<()> {
    if m.rules.stored_pulses() {
        return Ok(());
    }
    let blocks = blocks(m)?;
    for owner in owners(&blocks) {
        for (i, qualifier) in [Qualifier::P1, Qualifier::P0].into_iter().enumerate() {
            let mut input = false;
            let mut any_due = false;
            for b in blocks.iter().filter(|b| b.owner == *owner) {
                let here = due[m.steps[b.step].scope];
                any_due |= here;
                if b.qualifier == qualifier {
                    let held = s.held.get(&(b.step, b.place)).is_some_and(|h| *h);
                    input |= if here { input_of(m, s, b)? } else { held };
                }
            }
            let control = s.control.entry(owner.clone()).or_default();
            if any_due && control.last[i + 1] != input {
                control.last[i + 1] = input;
                control.early[i] |= input == (qualifier == Qualifier::P1);
            }
        }
    }
    Ok(())
}

/// Evaluates all control blocks and continuous actions, then runs the bodies.
pub(super) fn end_of_scan(m: &Model, s: &mut State, due: &[bool], went: &Went) -> Run<()> {
    // JGrafchart executes the periodic actions first and the level actions after them.
    let level_last = m.rules.profile == ProfileName::Jgrafchart;
    if level_last {
        bodies(m, s, due, went, &[], &BTreeMap::new(), true)?;
    }
    let blocks = blocks(m)?;
    let mut verdicts: BTreeMap<&Owner, Verdict> = BTreeMap::new();
    for owner in owners(&blocks) {
        let mine: Vec<&Block<'_>> = blocks.iter().filter(|b| b.owner == *owner).collect();
        if mine.iter().any(|b| due[m.steps[b.step].scope]) {
            let verdict = judge(m, s, due, owner, &mine)?;
            verdicts.insert(owner, verdict);
        }
    }
    for (owner, verdict) in &verdicts {
        if let Owner::Var(v) = owner {
            let control = s.control.entry((*owner).clone()).or_default();
            if control.written != verdict.q {
                control.written = verdict.q;
                s.vars[*v] = Value::Bool(verdict.q);
            }
        }
    }
    bodies(m, s, due, went, &blocks, &verdicts, !level_last)
}

/// Computes the inputs of a block and its result.
fn judge(m: &Model, s: &mut State, due: &[bool], owner: &Owner, blocks: &[&Block<'_>]) -> Run<Verdict> {
    let continuous = match owner {
        Owner::Var(v) => m.rules.profile == ProfileName::Iec60848 && !m.blocked_vars.contains(v),
        Owner::Named(..) | Owner::Own(..) => false,
    };
    let masked_var = match owner {
        Owner::Var(v) => m.var_masks.iter().any(|(by, var)| var == v && s.active.contains(by)),
        Owner::Named(..) | Owner::Own(..) => false,
    };
    let mut inputs = [false; Qualifier::ALL.len()];
    let mut control = s.control.get(owner).cloned().unwrap_or_default();
    let mut any = false;
    let mut timed = [false; 5];
    for b in blocks {
        let scope = m.steps[b.step].scope;
        let place = (b.step, b.place);
        if !due[scope] {
            let held = s.held.get(&place).is_some_and(|h| *h);
            any |= held;
            inputs[b.qualifier as usize] |= held;
            continue;
        }
        let mut input = input_of(m, s, b)?;
        let time = match b.time {
            Some(e) if input => Exec::new(m, s).eval(scope, e)?.duration()?,
            _ => 0,
        };
        if continuous {
            let run = s.now - s.timing[b.step].since;
            input &= match b.qualifier {
                Qualifier::D => run >= time,
                Qualifier::L => run < time,
                _ => true,
            };
        }
        any |= input;
        s.held.insert(place, input);
        if input {
            inputs[b.qualifier as usize] = true;
            if let Some(i) = timer_of(b.qualifier)
                && !timed[i]
            {
                timed[i] = true;
                control.times[i] = time;
            }
        }
    }
    if continuous {
        return Ok(Verdict { q: any && !masked_var, runs: false, pulse: 1 });
    }
    let level_before = control.level;
    let (level, p1, p0) = control.step(&inputs, s.now);
    let q = level || p1 || p0;
    s.control.insert(owner.clone(), control);
    let pulse = if level || (m.rules.final_scan && level_before) {
        1
    } else if p1 {
        0
    } else {
        2
    };
    Ok(Verdict { q: q && !masked_var, runs: q || (m.rules.final_scan && level_before), pulse })
}

/// True if a step with an active order masks the chart of a scope.
fn masked(m: &Model, s: &State, scope: ScopeId) -> bool {
    m.chart_masks.iter().any(|(by, chart)| *chart == m.scopes[scope].root && s.active.contains(by))
}

/// The index of a timed qualifier among the timers.
fn timer_of(q: Qualifier) -> Option<usize> {
    [Qualifier::L, Qualifier::D, Qualifier::SD, Qualifier::DS, Qualifier::SL].iter().position(|t| *t == q)
}

impl Control {
    /// The equations of SEMANTICS section 5: Q without P1 and P0, then P1 and P0.
    fn step(&mut self, inputs: &[bool], now: i64) -> (bool, bool, bool) {
        use Qualifier as Q;
        let on = |q: Q| inputs[q as usize];
        let r = on(Q::R);
        let rs = |ff: bool, set: bool| !r && (set || ff);
        self.s_ff = rs(self.s_ff, on(Q::S));
        let l_tmr = self.ton(0, on(Q::L), now);
        let d_tmr = self.ton(1, on(Q::D), now);
        self.sd_ff = rs(self.sd_ff, on(Q::SD));
        let sd_tmr = self.ton(2, self.sd_ff, now);
        let ds_tmr = self.ton(3, on(Q::DS), now);
        self.ds_ff = rs(self.ds_ff, ds_tmr);
        self.sl_ff = rs(self.sl_ff, on(Q::SL));
        let sl_tmr = self.ton(4, self.sl_ff, now);
        let [p_last, p1_last, p0_last] = self.last;
        self.last = [on(Q::P), on(Q::P1), on(Q::P0)];
        let p_trig = on(Q::P) && !p_last;
        let [p1_early, p0_early] = std::mem::take(&mut self.early);
        let p1 = p1_early || on(Q::P1) && !p1_last;
        let p0 = p0_early || !on(Q::P0) && p0_last;
        let level = !r
            && (on(Q::N)
                || self.s_ff
                || (on(Q::L) && !l_tmr)
                || d_tmr
                || p_trig
                || sd_tmr
                || self.ds_ff
                || (self.sl_ff && !sl_tmr));
        self.level = level;
        (level, p1 && !r, p0 && !r)
    }

    fn ton(&mut self, i: usize, input: bool, now: i64) -> bool {
        if !input {
            self.starts[i] = None;
            return false;
        }
        now - *self.starts[i].get_or_insert(now) >= self.times[i]
    }
}

/// A body that runs at the end of the scan.
enum LateBody<'m> {
    Named(ScopeId, &'m g7_model::Block),
    Work(ScopeId, &'m g7_model::Work),
    Each(ScopeId, &'m g7_model::Work, Option<&'m Expr>),
}

/// True if a P1 or P0 body follows the activation or deactivation itself. With a condition or a
/// mask, its control block sees the step at the end of the scan.
fn is_late_pulse(m: &Model, step: StepId, action: &Action) -> bool {
    let ActionKind::Qualified { qualifier, target: Target::Work(_), condition: None, .. } = &action.kind
    else {
        return false;
    };
    // A control block does not see a step that is activated and deactivated within one scan.
    let through_block = m.rules.stable || m.chart_masks.iter().any(|(_, chart)| *chart == m.root_of(step));
    let pulse = matches!(qualifier, Qualifier::P1 | Qualifier::P0);
    pulse && !m.rules.stored_pulses() && !through_block
}

/// A P1 or P0 body of a step, in profiles where such bodies wait for the end of the scan: it runs
/// once if the step was activated or deactivated in this scan; for an initial step at the start
/// too.
fn late_pulse<'m>(m: &'m Model, went: &Went, step: StepId, action: &'m Action) -> Option<(i8, LateBody<'m>)> {
    let ActionKind::Qualified { qualifier, target: Target::Work(work), .. } = &action.kind else {
        return None;
    };
    let (pulse, happened) = match qualifier {
        Qualifier::P1 => (0, &went.changes.on),
        Qualifier::P0 => (2, &went.changes.off),
        _ => return None,
    };
    let late = is_late_pulse(m, step, action) && happened.contains(&step);
    late.then(|| (pulse, LateBody::Each(m.steps[step].scope, work, None)))
}

/// Bodies and each-scan actions in the order of the text; a named action has the place where it is
/// named first.
fn bodies(
    m: &Model,
    s: &mut State,
    due: &[bool],
    went: &Went,
    blocks: &[Block<'_>],
    verdicts: &BTreeMap<&Owner, Verdict>,
    each_scan: bool,
) -> Run<()> {
    let mut todo: Vec<(i8, LateBody<'_>)> = Vec::new();
    let mut done: BTreeSet<&Owner> = BTreeSet::new();
    for (scope, in_turn) in due.iter().copied().enumerate().skip(FILE + 1) {
        for &step in &m.scopes[scope].steps {
            for (place, action) in m.steps[step].actions.iter().enumerate() {
                if let ActionKind::EachScan { work, condition } = &action.kind {
                    let was = m.rules.profile != ProfileName::Jgrafchart || went.start.contains(&step);
                    if each_scan && in_turn && s.active.contains(&step) && was {
                        todo.push((1, LateBody::Each(scope, work, condition.as_ref())));
                    }
                }
                if in_turn {
                    todo.extend(late_pulse(m, went, step, action));
                }
                let Some(block) = blocks.iter().find(|b| (b.step, b.place) == (step, place)) else {
                    continue;
                };
                let Some(v) = verdicts.get(&block.owner).filter(|v| v.runs) else { continue };
                if !done.insert(&block.owner) {
                    continue;
                }
                match (&block.owner, &action.kind) {
                    (Owner::Named(owner, name), _) => {
                        if let Body::St(b) = &m.scopes[*owner].actions[name].body {
                            todo.push((v.pulse, LateBody::Named(*owner, b)));
                        }
                    }
                    (Owner::Own(..), ActionKind::Qualified { target: Target::Work(work), .. }) => {
                        todo.push((v.pulse, LateBody::Work(scope, work)));
                    }
                    _ => {}
                }
            }
        }
    }
    if m.rules.pulse_first {
        todo.sort_by_key(|(pulse, _)| *pulse);
    }
    for (_, what) in todo {
        let mut exec = Exec::new(m, s);
        match what {
            LateBody::Named(scope, block) => exec.body(scope, block)?,
            LateBody::Work(scope, work) => exec.work(scope, work)?,
            LateBody::Each(scope, work, condition) => {
                let holds = match condition {
                    Some(c) => exec.truth(scope, c)?,
                    None => true,
                };
                if holds {
                    exec.work(scope, work)?;
                }
            }
        }
    }
    Ok(())
}
