//! Joins what stood before deleted parts to what stood behind them.
//!
//! Each connected region that is deleted is bridged if there is only one way to do it:
//!
//! - Transitions before it and steps behind it: they lead to the step behind it, or to all steps behind its only
//!   last transition. In the same way transitions behind it take the step before it, or all steps before its only
//!   first transition.
//! - Transitions on both sides. If there is one transition behind the region and all its preceding
//!   steps are deleted, the transitions before the region lead to its succeeding steps, and it is
//!   deleted too (`A -> x -> B`: the receptivity before `x` is kept). Otherwise, if there is one
//!   transition before the region and all its succeeding steps are deleted, the transitions behind
//!   the region take its preceding steps, and it is deleted too.
//! - Steps on both sides, and steps between: the first transitions of the region stay and lead to the step behind
//!   it, or to all steps behind its only last transition. Otherwise its last transitions stay and take the steps
//!   before its only first transition.
//!
//! A transition alone is never bridged: the steps on its two sides cannot follow one another without it.

use std::collections::BTreeSet;

use g7_model::{Chart, ChartItem, Name, Span, Transition};

use super::chosen::Chosen;
use super::graph::{has, replace};
use super::nodes::node;
use crate::change::Refusal;
use crate::draft::Draft;
use crate::id::{ItemId, Part};

/// Steps that healing joins: those that stand before and behind a transition that it changes.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub struct Joined {
    /// The preceding steps.
    pub before: Vec<String>,
    /// The succeeding steps.
    pub behind: Vec<String>,
}

/// The steps that healing would join if these parts of one chart were deleted.
#[inline(never)]
pub(crate) fn joins(d: &mut Draft<'_>, ids: &[ItemId]) -> Result<Vec<Joined>, Refusal> {
    let mut nodes = Vec::new();
    for id in ids.iter().filter(|id| matches!(id.part, Part::Step(_) | Part::Transition(_))) {
        node(d, id)?;
        nodes.push(id.clone());
    }
    if nodes.is_empty() {
        return Ok(Vec::new());
    }
    let mut chosen = Chosen::new(d, &nodes)?;
    let chart = d.chart_mut(&chosen.chart.clone())?;
    let changed = bridge(chart, &mut chosen);
    let names = |list: &[Name]| list.iter().map(|n| n.text.to_string()).collect();
    let joined = chart.transitions().filter(|t| changed.contains(&t.at.0));
    Ok(joined.map(|t| Joined { before: names(&t.from), behind: names(&t.to) }).collect())
}

/// A connected region that is deleted.
#[derive(Default)]
struct Region {
    steps: BTreeSet<String>,
    transitions: BTreeSet<Span>,
}

/// Bridges each region: changes the transitions that stay, and adds to the chosen ones those that must go too.
/// Returns the transitions that now lead from the steps before a region to those behind it.
pub(crate) fn bridge(chart: &mut Chart, chosen: &mut Chosen) -> BTreeSet<Span> {
    let mut joined = BTreeSet::new();
    for region in regions(chart, chosen) {
        let way = way(chart, &region);
        for item in &mut chart.items {
            let ChartItem::Transition(t) = item else { continue };
            if let Some(change) = way.changes.iter().find(|c| c.at == t.at.0) {
                change.make(t, &region);
                chosen.transitions.remove(&t.at.0);
                joined.insert(t.at.0);
            }
        }
        chosen.transitions.extend(way.spare);
    }
    joined
}

#[inline(never)]
fn regions(chart: &Chart, chosen: &Chosen) -> Vec<Region> {
    let mut left: BTreeSet<String> = chosen.steps.iter().cloned().collect();
    let mut loose: BTreeSet<Span> = chosen.transitions.clone();
    let mut regions = Vec::new();
    loop {
        let mut region = Region::default();
        if let Some(step) = left.pop_first() {
            region.steps.insert(step);
        } else if let Some(t) = loose.pop_first() {
            region.transitions.insert(t);
        } else {
            return regions;
        }
        let mut grew = true;
        while grew {
            grew = false;
            for t in chart.transitions().filter(|t| chosen.has(t)) {
                let names = || t.from.iter().chain(&t.to).map(|n| n.text.to_string());
                let mine = region.transitions.contains(&t.at.0);
                if !mine && names().any(|n| region.steps.contains(&n)) {
                    loose.remove(&t.at.0);
                    grew |= region.transitions.insert(t.at.0);
                } else if mine {
                    for n in names().filter(|n| chosen.has_step(n)) {
                        left.remove(&n);
                        grew |= region.steps.insert(n);
                    }
                }
            }
        }
        regions.push(region);
    }
}

/// The neighbours of a region: transitions before and after it, steps before and after it.
struct Around {
    t_before: Vec<Transition>,
    t_behind: Vec<Transition>,
    s_before: Vec<Name>,
    s_behind: Vec<Name>,
}

#[inline(never)]
fn around(chart: &Chart, region: &Region) -> Around {
    let inside = |n: &Name| region.steps.contains(&*n.text);
    let mut a = Around { t_before: vec![], t_behind: vec![], s_before: vec![], s_behind: vec![] };
    let fresh = |list: &Vec<Name>, n: &Name| !inside(n) && !has(list, &n.text);
    for t in chart.transitions() {
        if region.transitions.contains(&t.at.0) {
            for n in &t.from {
                if fresh(&a.s_before, n) {
                    a.s_before.push(n.clone());
                }
            }
            for n in &t.to {
                if fresh(&a.s_behind, n) {
                    a.s_behind.push(n.clone());
                }
            }
        } else {
            if t.to.iter().any(inside) {
                a.t_before.push(t.clone());
            }
            if t.from.iter().any(inside) {
                a.t_behind.push(t.clone());
            }
        }
    }
    // A transition that leads from the region back to it is not a neighbour.
    let own: Vec<Span> = a.t_before.iter().map(|t| t.at.0).collect();
    let both: Vec<Span> = a.t_behind.iter().map(|t| t.at.0).filter(|t| own.contains(t)).collect();
    a.t_before.retain(|t| !both.contains(&t.at.0));
    a.t_behind.retain(|t| !both.contains(&t.at.0));
    a
}

/// A change of a transition: these steps stand in the place of the deleted ones, on one of its sides.
struct Change {
    at: Span,
    to: bool,
    by: Vec<Name>,
}

impl Change {
    fn make(&self, t: &mut Transition, region: &Region) {
        let list = if self.to { &mut t.to } else { &mut t.from };
        let inside = |n: &Name| region.steps.contains(&*n.text);
        let Some(first) = list.iter().find(|n| inside(n)).map(|n| n.text.to_string()) else { return };
        list.retain(|n| !inside(n) || *n.text == *first);
        replace(list, &first, &self.by);
    }
}

/// How a region is bridged; nothing if it is not.
#[derive(Default)]
struct Way {
    changes: Vec<Change>,
    /// A transition that the bridge leaves without use.
    spare: Option<Span>,
}

impl Way {
    fn new(these: &[Transition], to: bool, by: &[Name]) -> Way {
        let change = |t: &Transition| Change { at: t.at.0, to, by: by.to_vec() };
        Way { changes: these.iter().map(change).collect(), spare: None }
    }

    fn without(self, spare: &Transition) -> Way {
        Way { spare: Some(spare.at.0), ..self }
    }
}

#[inline(never)]
fn way(chart: &Chart, region: &Region) -> Way {
    let a = around(chart, region);
    let inside = |n: &Name| region.steps.contains(&*n.text);
    let all_inside = |list: &[Name]| list.iter().all(inside);
    let own = |list: fn(&Transition) -> &Vec<Name>| -> Vec<Transition> {
        let of = chart.transitions().filter(|t| region.transitions.contains(&t.at.0));
        of.filter(|t| list(t).iter().any(|n| !inside(n))).cloned().collect()
    };
    let (firsts, lasts) = (own(|t| &t.from), own(|t| &t.to));
    // The steps on one side if they are one step or those of one transition.
    let single = |steps: &[Name], of: &[Transition]| steps.len() == 1 || of.len() == 1;
    let (before, behind) = (single(&a.s_before, &firsts), single(&a.s_behind, &lasts));
    match (a.t_before.as_slice(), a.s_before.as_slice(), a.t_behind.as_slice(), a.s_behind.as_slice()) {
        ([_, ..], [], [], [_, ..]) if behind => Way::new(&a.t_before, true, &a.s_behind),
        ([], [_, ..], [_, ..], []) if before => Way::new(&a.t_behind, false, &a.s_before),
        ([_, ..], [], [only], []) if all_inside(&only.from) => {
            Way::new(&a.t_before, true, &only.to).without(only)
        }
        ([only], [], [_, ..], []) if all_inside(&only.to) => {
            Way::new(&a.t_behind, false, &only.from).without(only)
        }
        ([], [_, ..], [], [_, ..]) if !region.steps.is_empty() => {
            let leads_in = |t: &Transition| !t.to.is_empty() && all_inside(&t.to);
            let leads_out = |t: &Transition| !t.from.is_empty() && all_inside(&t.from);
            if behind && firsts.iter().all(leads_in) {
                Way::new(&firsts, true, &a.s_behind)
            } else if before && lasts.iter().all(leads_out) {
                Way::new(&lasts, false, &a.s_before)
            } else {
                Way::default()
            }
        }
        _ => Way::default(),
    }
}
