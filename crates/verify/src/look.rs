//! The sights of the passes of a scan, and runs repeated with `engine::scan`.

use g7_engine::{
    Fault, FaultKind, NONE, Program, Report, Rows, State, StepId, Tables, Transition, begin, enabled, pass,
    scan,
};

use crate::asked::Asking;
use crate::explore::Move;
use crate::model::Model;
use crate::monitor::{IDLE, has_memory, is_of_scans, judge};
use crate::question::{Claim, Query};
use crate::verdict::Run;
use crate::world::World;

/// Passes of a scan that are looked at.
pub(crate) const PASSES: u32 = 256;
/// Passes before a state is saved, to see whether it comes back: most scans have fewer.
const SAVED: u32 = 8;

/// The sights of the passes of a scan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Passes {
    /// Two clearable transitions shared a preceding step, and nothing written chooses.
    pub(crate) conflict: bool,
    /// A step was activated while active, and not deactivated in the same pass.
    pub(crate) unsafe_: bool,
    /// There were more passes than were looked at.
    pub(crate) cut: bool,
}

/// The moment of a pass at which it is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum At {
    /// Before it.
    Ahead,
    /// Behind it: [`State::cleared`] and [`State::ran`] are those of this pass alone.
    Behind,
}

/// Makes the passes of the next scan, as many as the engine makes, and shows each until `look` says that
/// it is enough. A fault ends them; the scan reports it. Gives whether there are more than were made.
///
/// An endless search is over when a state has come back, since then all of its passes were seen.
pub(crate) fn each_pass(
    p: &Program,
    s: &mut State,
    inputs: &[u64],
    now: i64,
    mut look: impl FnMut(&State, At) -> bool,
) -> bool {
    let rules = &p.tables().rules;
    if begin(p, s, inputs, now).is_err() {
        return false;
    }
    let mut saved: Vec<u64> = Vec::new();
    for made in 1..=PASSES.min(rules.bound) {
        if look(s, At::Ahead) {
            return false;
        }
        s.forget_reports();
        let Ok(changed) = pass(p, s) else { return false };
        if look(s, At::Behind) || !changed || !rules.stable || saved == s.image() {
            return false;
        }
        // The distance between saved states doubles, so that one of them is in the cycle, whatever its length.
        if made >= SAVED && made.is_power_of_two() {
            saved = s.image().to_vec();
        }
    }
    PASSES < rules.bound
}

/// Looks at the passes of the next scan. A fault ends the look; the scan reports it.
pub(crate) fn passes(p: &Program, s: &mut State, inputs: &[u64], now: i64, conflicts: bool) -> Passes {
    let mut seen = Passes::default();
    let mut was: Vec<u32> = Vec::new();
    seen.cut = each_pass(p, s, inputs, now, |s, at| {
        match at {
            At::Ahead => {
                seen.conflict |= conflicts && !seen.conflict && conflict(p, s).is_some();
                was.clear();
                was.extend(s.active().map(|s| s.0));
            }
            At::Behind => seen.unsafe_ |= twice(p.tables(), &was, s.cleared()).is_some(),
        }
        false
    });
    seen
}

/// True if some pass of the next scan shows what a claim about transitions or actions looks for. A scan
/// of many passes reports only the first of them.
pub(crate) fn in_some_pass(p: &Program, s: &mut State, inputs: &[u64], now: i64, claim: &Claim) -> bool {
    let mut found = false;
    each_pass(p, s, inputs, now, |s, at| {
        found |= at == At::Behind && happens(p, s, claim);
        found
    });
    found
}

/// True if the reports of a scan or a pass show it.
fn happens(p: &Program, s: &State, claim: &Claim) -> bool {
    match claim {
        // A step counts too if it was active only within the scan.
        Claim::Active(step) => {
            let t = p.tables();
            s.cleared().iter().any(|r| before(t, *r).chain(behind(t, *r)).any(|s| s == step.0))
        }
        Claim::Clears(rank) => s.cleared().contains(rank),
        Claim::Runs(rank) => s.ran().contains(rank),
        _ => false,
    }
}

/// Two transitions that could clear and share a preceding step, where no written priority
/// that the profile follows chooses between them.
pub(crate) fn conflict(p: &Program, s: &State) -> Option<(u32, u32)> {
    let t = p.tables();
    let mut ready = Vec::new();
    let shares = |rank: u32| t.transitions.get(rank as usize).is_some_and(|t| t.shares);
    // A fault of a receptivity shows in the scan itself.
    let _fault = enabled(p, s, |rank, holds| ready.extend((holds && shares(rank)).then_some(rank)));
    let chosen = |a: u32, b: u32| {
        let priority = |r: u32| t.transitions.get(r as usize).map_or(u32::MAX, |t| t.priority);
        let follows = !t.rules.multi_token || t.rules.numbered_exclusive;
        follows && priority(a) != priority(b)
    };
    let meet = |a: u32, b: u32| before(t, a).any(|s| before(t, b).any(|other| other == s));
    let mut pairs =
        ready.iter().enumerate().flat_map(|(i, a)| ready.iter().skip(i + 1).map(move |b| (*a, *b)));
    pairs.find(|(a, b)| !chosen(*a, *b) && meet(*a, *b))
}

/// A step that was activated while active and not left, with a transition that did it.
pub(crate) fn twice(t: &Tables, was: &[u32], cleared: &[u32]) -> Option<(u32, u32)> {
    let leaves = |step: u32| cleared.iter().any(|r| before(t, *r).any(|s| s == step));
    let enters = |step: u32| cleared.iter().copied().find(|r| behind(t, *r).any(|s| s == step));
    was.iter().filter(|step| !leaves(**step)).find_map(|step| Some((*step, enters(*step)?)))
}

/// The steps before and behind a transition.
pub(crate) fn sides(t: &Tables, rank: u32) -> (Vec<u32>, Vec<u32>) {
    (before(t, rank).collect(), behind(t, rank).collect())
}

/// The steps before a transition.
fn before(t: &Tables, rank: u32) -> impl Iterator<Item = u32> + '_ {
    side(t, rank, |tr| (tr.from, tr.more_from))
}

/// The steps behind a transition.
fn behind(t: &Tables, rank: u32) -> impl Iterator<Item = u32> + '_ {
    side(t, rank, |tr| (tr.to, tr.more_to))
}

/// The steps of one side. Scans ask for them so often that they are not put into a list.
fn side(
    t: &Tables,
    rank: u32,
    of: impl Fn(&Transition) -> (StepId, Rows) + 'static,
) -> impl Iterator<Item = u32> + '_ {
    let steps = t.transitions.get(rank as usize).map(of).into_iter().flat_map(|(first, more)| {
        let more = t.arcs.get(more.start as usize..more.end as usize).unwrap_or(&[]);
        std::iter::once(first).chain(more.iter().copied())
    });
    steps.map(|s| s.0).filter(|s| *s != NONE)
}

/// True if all assumptions hold for these inputs. The state of the charts is used up.
pub(crate) fn allowed(model: &Model<'_>, world: &mut World<'_>, m: &Move, now: i64) -> bool {
    let p = &model.compiled.program;
    // A fault before the evolution is shown by the scan.
    begin(p, &mut world.charts, &m.inputs, now).is_err()
        || model.assume.iter().all(|q| world.holds(model, *q).unwrap_or(false))
}

/// Repeats a run with `engine::scan` from the state before the first scan, and tells whether
/// it keeps the assumptions and its last scan shows what the claim is about. What a state
/// cannot do any more (deadlock, `leads to`) is not for a run to show: there it tells that
/// the run leads to a situation of this kind without a fault.
pub fn replay(model: &Model<'_>, claim: &Claim, run: &Run) -> bool {
    let p = &model.compiled.program;
    let asking = Asking::new(p, model.codes());
    let (mut world, mut memory, mut last) = (World::new(model), IDLE, false);
    for (k, m) in run.moves.iter().enumerate() {
        let mut inputs = m.inputs.clone();
        let way = run.ways.get(k).copied().unwrap_or(0);
        if world.tick(m.wait, way, &mut inputs).is_err() || inputs != m.inputs {
            return false;
        }
        let now = world.charts.now().saturating_add(m.wait);
        if !model.assume.is_empty() && !allowed(model, &mut world.clone(), m, now) {
            return false;
        }
        let is_last = k + 1 == run.moves.len();
        let before = world.charts.clone();
        let done = scan(p, &mut world.charts, &m.inputs, now);
        if done.is_err() != (is_last && run.fault.is_some()) || is_last && done.err() != run.fault {
            return false;
        }
        if done.is_ok() && is_of_scans(claim) {
            let Ok(seen) = judge(model, claim, &mut world, memory, m.wait) else { return false };
            memory = seen.memory;
            last = seen.hit;
        }
        if is_last && !is_of_scans(claim) {
            last = match claim {
                Claim::NoConflict => passes(p, &mut before.clone(), &m.inputs, now, true).conflict,
                Claim::NoUnsafe => passes(p, &mut before.clone(), &m.inputs, now, false).unsafe_,
                Claim::NoDeadlock => done.is_ok(),
                Claim::Asked(a) => {
                    let place = (a.0 - p.tables().inputs.start) as usize;
                    asking.asked(&before).iter().any(|i| i == place)
                }
                _ => {
                    shows(p, claim, &Scanned { state: &world.charts, report: done })
                        || in_some_pass(p, &mut before.clone(), &m.inputs, now, claim)
                }
            };
        }
    }
    if matches!(claim, Claim::LeadsTo { .. }) { has_memory(claim) && memory != IDLE } else { last }
}

/// The fault of a condition of the claim at the end of a run: the claim has no value there.
pub fn unclear(model: &Model<'_>, claim: &Claim, run: &Run) -> Option<FaultKind> {
    let (mut world, mut memory) = (World::new(model), IDLE);
    for (k, m) in run.moves.iter().enumerate() {
        let way = run.ways.get(k).copied().unwrap_or(0);
        world.tick(m.wait, way, &mut m.inputs.clone()).ok()?;
        let now = world.charts.now().saturating_add(m.wait);
        scan(&model.compiled.program, &mut world.charts, &m.inputs, now).ok()?;
        match judge(model, claim, &mut world, memory, m.wait) {
            Ok(seen) => memory = seen.memory,
            Err(fault) => return Some(fault.kind),
        }
    }
    None
}

/// The value of a condition at the end of each scan of a run.
pub fn seen(model: &Model<'_>, run: &Run, q: Query) -> Vec<bool> {
    let p = &model.compiled.program;
    let mut world = World::new(model);
    let each = run.moves.iter().enumerate().map(|(k, m)| {
        let way = run.ways.get(k).copied().unwrap_or(0);
        let now = world.charts.now().saturating_add(m.wait);
        world.tick(m.wait, way, &mut m.inputs.clone()).is_ok()
            && scan(p, &mut world.charts, &m.inputs, now).is_ok()
            && world.holds(model, q).unwrap_or(false)
    });
    each.collect()
}

/// The state behind a scan, with its report.
pub(crate) struct Scanned<'s> {
    pub(crate) state: &'s State,
    pub(crate) report: Result<Report, Fault>,
}

impl Scanned<'_> {
    /// True if the scan may have cleared or run more than it reports: its reports are as long as the state has
    /// room for, or tell of fewer transitions than were cleared.
    pub(crate) fn is_cut(&self, p: &Program) -> bool {
        let (s, t) = (self.state, p.tables());
        let (most_run, most_cleared) = (t.actions.len() + 64, 2 * t.transitions.len() + 64);
        let all = self.report.map_or(0, |r| r.cleared as usize);
        let listed = s.cleared().len();
        s.ran().len() >= most_run || listed < all || listed >= most_cleared
    }
}

/// True if a scan shows what the claim is about. For claims that one scan can show as a whole.
pub(crate) fn shows(p: &Program, claim: &Claim, scanned: &Scanned<'_>) -> bool {
    let (t, s) = (p.tables(), scanned.state);
    let fault = scanned.report.err().map(|f| f.kind);
    match claim {
        // The initial situation may be left within the first scan.
        Claim::Active(step) => s.is_active(*step) || t.initial.contains(step) || happens(p, s, claim),
        Claim::Clears(_) | Claim::Runs(_) => happens(p, s, claim),
        Claim::On(addr) => fault.is_none() && s.word(*addr) != 0,
        Claim::NoInstability => matches!(fault, Some(FaultKind::Unstable { .. } | FaultKind::Bound)),
        Claim::NoOpposedOrders => matches!(fault, Some(FaultKind::Forcing { .. })),
        Claim::NoOpposedWrites => scanned.report.is_ok_and(|r| r.conflict.is_some()),
        Claim::NoFault => fault.is_some_and(|f| {
            !matches!(f, FaultKind::Unstable { .. } | FaultKind::Bound | FaultKind::Forcing { .. })
        }),
        _ => false,
    }
}
