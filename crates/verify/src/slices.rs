//! The part of a chart that a question depends on: what the other layers may leave out of a state.
//!
//! ```text
//! Equations, Claim -> needs (how far each variable must be told apart) -> Slice -> World::image
//! ```
//!
//! A state of a search is its image; a [`Slice`] puts the same value into each word of it that the question
//! does not depend on (a counter that nothing compares), and a greatest value into each word beyond which all
//! act alike (a counter that is compared with constants alone). So many states become one.
//!
//! # Invariants
//!
//! - A scan of a state in a slice does what the scan of each state does that became it: the same steps,
//!   transitions, actions and conditions of the question, and states behind it that become one again. Only a
//!   fault that the chart meets there may be missing, so a slice has more runs than the chart.
//! - Where a scan of a slice itself ends with a fault, the fault may be one that the chart does not meet: then
//!   nothing is proved.
//! - A proof that no run does something holds for the chart. A run counts once the engine has repeated it. That
//!   a state leads on is proved as well, since a fault counts as leading on; that none does is not.
//! - Under search for stability a variable that changes causes one pass more. That pass does nothing if no
//!   condition is true because an edge is absent ([`edges_help`]).

#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use g7_engine::{Addr, Program, State};
use g7_equations::{Class, Equations, Expr, Memory, MemoryId, Options, Stmt, What, equations};

use crate::layer::{Budget, Layer, undecided};
use crate::model::Model;
use crate::question::{Claim, Query, Question};
use crate::sites::{Site, sites};
use crate::slice::{Cut, Slice};
use crate::system::needs::{NOTHING, needs, ranges};
use crate::system::range::{Ranges, is_whole};
use crate::verdict::{Evidence, Verdict};

/// Most steps of a chart whose slices are looked for.
const LARGE: usize = 2_000;

/// Least scans of the search of a part.
const LEAST: usize = 40_000;

/// Layers that are asked each question about the part of the chart that it depends on, where that is not
/// the whole.
pub(crate) struct Sliced<'l>(pub(crate) &'l [&'l dyn Layer]);

impl Layer for Sliced<'_> {
    fn name(&self) -> &'static str {
        "slices"
    }

    fn answer(
        &self,
        model: &Model<'_>,
        questions: &[Question],
        answers: &mut [Option<Verdict>],
        budget: &Budget<'_>,
    ) {
        let open = undecided(questions, answers);
        if open.is_empty() || (budget.stop)() {
            return;
        }
        let Some(whole) = Whole::new(model) else { return };
        let mut groups: Vec<(Slice, Vec<usize>)> = Vec::new();
        let mut known: BTreeMap<Demand, Slice> = BTreeMap::new();
        for (i, q) in open {
            if (budget.stop)() {
                return;
            }
            let Some(demand) = whole.demand(&q.claim) else { continue };
            let slice = known.entry(demand).or_insert_with_key(|d| whole.cut(&d.roots, &d.queries)).clone();
            match groups.iter_mut().find(|(s, _)| *s == slice) {
                Some((_, list)) => list.push(i),
                None => groups.push((slice, vec![i])),
            }
        }
        let all: usize = groups.iter().map(|(_, list)| list.len()).sum();
        for (slice, list) in groups.into_iter().filter(|(s, _)| !s.is_whole()) {
            if (budget.stop)() {
                return;
            }
            let model = model.sliced(slice);
            // Questions about one part share its scans, so that many parts take no longer than the whole.
            let share = (budget.scans / all.max(1)).saturating_mul(list.len()).max(LEAST);
            let budget = Budget { scans: share.min(budget.scans), ..*budget };
            let mine: Vec<Question> = list.iter().filter_map(|i| questions.get(*i)).cloned().collect();
            let mut found = vec![None; mine.len()];
            self.0.iter().for_each(|layer| layer.answer(&model, &mine, &mut found, &budget));
            for ((i, q), verdict) in list.into_iter().zip(&mine).zip(found) {
                if let Some(verdict) = verdict.filter(|v| holds(&q.claim, v))
                    && let Some(answer) = answers.get_mut(i)
                {
                    *answer = Some(verdict);
                }
            }
        }
    }
}

/// The memories and conditions that a claim asks about, besides the situation. Claims with the same demand have the
/// same slice.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Demand {
    roots: BTreeSet<MemoryId>,
    queries: Vec<Query>,
}

/// True if an answer about a slice is one about the chart.
fn holds(claim: &Claim, verdict: &Verdict) -> bool {
    match verdict {
        Verdict::Open(_) => false,
        // The chart may meet a fault where the slice does not lead on.
        Verdict::Refuted(Evidence::Run(_)) => *claim != Claim::NoDeadlock,
        _ => true,
    }
}

/// A whole chart, from which slices are taken.
pub(crate) struct Whole<'a, 'c> {
    model: &'a Model<'c>,
    e: Equations,
    ranges: Ranges,
    /// The first word of each memory that is a variable, in an image.
    vars: usize,
    fresh: State,
    /// A pass that changes variables alone is followed by one that does nothing.
    quiet: bool,
}

impl<'a, 'c> Whole<'a, 'c> {
    /// `None` for a chart with a plant, which may read all of its outputs, and for one so large that to
    /// read it takes longer than a search may last.
    pub(crate) fn new(model: &'a Model<'c>) -> Option<Whole<'a, 'c>> {
        if model.plant.is_some() || model.compiled.program.tables().steps.len() > LARGE {
            return None;
        }
        let options = Options { conflicts: true, runs: true, ..Options::default() };
        let e = equations(model.compiled, options);
        let ranges = ranges(&e, model, |_| true);
        let p: &Program = &model.compiled.program;
        let fresh = State::new(p);
        let quiet = e.search.is_none() || edges_help(&e);
        Some(Whole { model, e, ranges, vars: fresh.first_variable(), fresh, quiet })
    }

    /// The part of the chart that a claim depends on; `None` where it is about all that changes.
    #[cfg(test)]
    fn slice(&self, claim: &Claim) -> Option<Slice> {
        self.demand(claim).map(|d| self.cut(&d.roots, &d.queries))
    }

    /// The memories and conditions that a claim asks about; `None` where it is about all that changes.
    fn demand(&self, claim: &Claim) -> Option<Demand> {
        let mut queries: Vec<Query> = self.model.assume.clone();
        let mut roots = BTreeSet::new();
        match claim {
            Claim::Active(_)
            | Claim::Clears(_)
            | Claim::Asked(_)
            | Claim::NoDeadlock
            | Claim::NoConflict
            | Claim::NoUnsafe
            | Claim::NoOpposedOrders => {}
            Claim::Runs(rank) => drop(roots.insert(self.e.find(What::Ran(*rank))?)),
            Claim::On(addr) => drop(roots.insert(self.e.find(What::Variable(*addr))?)),
            Claim::Always(q) | Claim::Never(q) | Claim::Reachable(q) => queries.push(*q),
            Claim::AtMost(_, list) => queries.extend(list),
            Claim::Within { cause, effect, .. } => queries.extend([cause, effect]),
            Claim::Until { from, to, holds } => queries.extend([from, to, holds]),
            Claim::Between { from, to, never } => queries.extend([from, to, never]),
            Claim::NoInstability => roots.extend(self.e.find(What::Changed)),
            Claim::NoOpposedWrites => {
                let is_note = |(_, m): &(MemoryId, &Memory)| matches!(m.what, What::Conflict(_));
                roots.extend(self.memories().filter(is_note).map(|(id, _)| id));
            }
            // A run that leads on may meet a fault, which a slice may not have. `faults.rs` asks for faults.
            Claim::LeadsTo { .. } | Claim::NoFault => return None,
        }
        Some(Demand { roots, queries })
    }

    /// For each fault of the equations the part of the chart that it depends on, each part once; `None` where
    /// a fault stands where its conditions are not seen.
    pub(crate) fn of_faults(&self) -> Option<Vec<(Slice, Site)>> {
        let mut found: Vec<(Slice, Site)> = Vec::new();
        for site in sites(&self.e)? {
            let slice = self.cut(&site.reads, &self.model.assume);
            match found.iter_mut().find(|(s, _)| *s == slice) {
                Some((_, same)) if same.counter == site.counter => {}
                Some((_, same)) => same.counter = None,
                None => found.push((slice, site)),
            }
        }
        Some(found)
    }

    /// The slice of the situation alone with the place of a counter in an image, if the situation does not depend
    /// on it, or no more from some value on.
    pub(crate) fn beside(&self, counter: Addr) -> Option<(Slice, usize)> {
        let slice = self.cut(&BTreeSet::new(), &self.model.assume);
        let place = self.vars + counter.0 as usize;
        slice.0.iter().any(|(at, _)| *at == place).then_some((slice, place))
    }

    fn memories(&self) -> impl Iterator<Item = (MemoryId, &Memory)> {
        (0u32..).map(MemoryId).zip(&self.e.memories)
    }

    /// All that the situation, these memories and these conditions do not depend on.
    fn cut(&self, roots: &BTreeSet<MemoryId>, queries: &[Query]) -> Slice {
        let is_root = |id: MemoryId, what: What| match what {
            What::Step(_) | What::Clearable(_) | What::Clears(_) | What::Disagree(_) | What::Started => true,
            What::Changed => !self.quiet,
            _ => roots.contains(&id),
        };
        let first = self.memories().map(|(id, m)| if is_root(id, m.what) { None } else { NOTHING }).collect();
        let queries: Vec<usize> = queries.iter().map(|q| q.0 as usize).collect();
        let needs = needs(&self.e, &self.ranges, first, &queries, false);
        let mut cuts = Vec::new();
        for ((id, m), need) in self.memories().zip(&needs) {
            let What::Variable(at) = m.what else { continue };
            if !matches!(m.class, Class::Kept | Class::Output) {
                continue;
            }
            let first = self.vars + at.0 as usize;
            for place in first..first + m.init.len() {
                let cut = match *need {
                    NOTHING => Cut::Always(self.fresh.image().get(place).copied().unwrap_or(0)),
                    Some(most) if is_whole(m.ty) && self.ranges.of(id).low >= 0 => {
                        match i64::try_from(most) {
                            Ok(most) => Cut::AtMost(most),
                            Err(_) => continue,
                        }
                    }
                    _ => continue,
                };
                cuts.push((place, cut));
            }
        }
        cuts.extend(self.timers(&needs));
        cuts.sort_unstable_by_key(|(at, _)| *at);
        // A word that no run changes needs no cut.
        cuts.retain(|(_, cut)| *cut != Cut::AtMost(i64::MAX));
        Slice(cuts)
    }

    /// The clocks of timers that nothing reads: the fifth word of the block, as the engine has them.
    fn timers(&self, needs: &[Option<i128>]) -> Vec<(usize, Cut)> {
        let mut found = Vec::new();
        let need = |m: &MemoryId| needs.get(m.0 as usize).copied().flatten();
        let mut note = |s: &Stmt| {
            if let Stmt::Call(_, memories) = s
                && memories.iter().all(|m| need(m) == NOTHING)
                && let Some(clock) = memories.get(4)
                && let Some(What::BlockClock(at)) = self.e.memory(*clock).map(|m| m.what)
            {
                let place = self.vars + at.0 as usize + 4;
                found.push((place, Cut::Always(self.fresh.image().get(place).copied().unwrap_or(0))));
            }
        };
        self.e.sections().flat_map(|s| &s.body).for_each(|s| s.visit(&mut note));
        found.sort_unstable_by_key(|(at, _)| *at);
        found.dedup();
        found
    }
}

/// True if in each pass no condition holds because an edge is absent, or because the pass is not the first one.
/// Where a pass has changed no step, the next one then clears no transition and runs no action either: its
/// edges are gone, and all else that it judges by is the same.
fn edges_help(e: &Equations) -> bool {
    let is_edge = |m: MemoryId| {
        e.memory(m).is_some_and(|m| matches!(m.what, What::Rise(_) | What::Fall(_) | What::Opening))
    };
    let has_edge = |x: &Expr| {
        let mut found = false;
        x.visit(&mut |x| found |= matches!(x, Expr::Read(m) if is_edge(*m)));
        found
    };
    // Memories that become true by an edge, and that only what clears and runs asks for.
    let carries = |m: MemoryId| {
        e.memory(m).is_some_and(|m| {
            matches!(
                m.what,
                What::Receptivity(_)
                    | What::Clearable(_)
                    | What::Clears(_)
                    | What::Settled(_)
                    | What::Runs(_)
            )
        })
    };
    let mut fine = true;
    for s in e.pass.iter().flat_map(|s| &s.body) {
        s.visit(&mut |s| match s {
            Stmt::Set(m, x) if has_edge(x) => fine &= carries(*m) && is_positive(x, &has_edge),
            Stmt::SetElement(_, i, x) => fine &= !has_edge(i) && !has_edge(x),
            Stmt::If(c, then, other) if has_edge(c) => {
                let is_opening =
                    matches!(c, Expr::Read(m) if e.memory(*m).is_some_and(|m| m.what == What::Opening));
                let sets = |s: &Stmt| matches!(s, Stmt::Set(m, _) if carries(*m));
                let only = || then.iter().all(|s| sets(s) || matches!(s, Stmt::About(_)));
                fine &= other.is_empty() && is_positive(c, &has_edge) && (is_opening || only());
            }
            _ => {}
        });
    }
    fine
}

/// True if an edge can only help an expression to be true.
fn is_positive(x: &Expr, has_edge: &impl Fn(&Expr) -> bool) -> bool {
    match x {
        Expr::Read(_) => true,
        Expr::And(list) | Expr::Or(list) => list.iter().all(|x| is_positive(x, has_edge)),
        other => !has_edge(other),
    }
}
