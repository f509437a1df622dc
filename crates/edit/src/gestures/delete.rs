//! Deletes parts of a chart and joins what was around them.
//!
//! With a step, the transitions that only this step enabled are deleted. A transition that led only
//! to this step stays without a succeeding step, so that the user can build on. With `heal`, each
//! connected region that is deleted is bridged if there is only one way to do it:
//!
//! - A transition before it and a step after it, or a step before it and a
//!   transition after it: the two are joined.
//! - Transitions on both sides. If there is one transition after the region and all its preceding
//!   steps are deleted, the transitions before the region lead to its succeeding steps, and it is
//!   deleted too (`A -> x -> B`: the receptivity before `x` is kept). Otherwise, if there is one
//!   transition before the region and all its succeeding steps are deleted, the transitions after
//!   the region take its preceding steps, and it is deleted too.
//! - Steps on both sides: the transition after the preceding step is kept and leads to the
//!   succeeding step.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{Chart, ChartItem, Name, Span, Transition, say};

use super::graph::{has, replace};
use super::nodes::{Node, node, one_chart};
use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::id::{End, ItemId, Part};

/// The chosen steps and transitions of one chart.
pub(crate) struct Chosen {
    pub(crate) chart: String,
    pub(crate) steps: Vec<String>,
    pub(crate) transitions: BTreeSet<Span>,
    names: BTreeSet<String>,
}

impl Chosen {
    /// The steps (in the order of the text) and transitions that the ids name.
    #[inline(never)]
    pub(crate) fn new(d: &Draft<'_>, ids: &[ItemId]) -> Result<Chosen, Refusal> {
        let chart = one_chart(ids)?.to_owned();
        let (mut names, mut transitions) = (BTreeSet::new(), BTreeSet::new());
        for id in ids {
            match node(d, id)? {
                Node::Step(s) => {
                    names.insert(s);
                }
                Node::Transition(t) => {
                    transitions.insert(t);
                }
            }
        }
        let steps = d.chart(&chart)?.steps().map(|s| s.name.text.to_string());
        let steps = steps.filter(|s| names.contains(s)).collect();
        Ok(Chosen { chart, steps, transitions, names })
    }

    pub(crate) fn has_step(&self, name: &str) -> bool {
        self.names.contains(name)
    }

    fn has(&self, t: &Transition) -> bool {
        self.transitions.contains(&t.at.0)
    }
}

#[inline(never)]
pub(crate) fn delete(d: &mut Draft<'_>, ids: &[ItemId], heal: bool) -> Result<(), Refusal> {
    if ids.is_empty() {
        return refuse(say!("nothing is chosen"));
    }
    let mut nodes: Vec<ItemId> = Vec::new();
    let mut links: Vec<(String, String, Span, bool)> = Vec::new();
    let mut actions: Vec<(String, String, usize)> = Vec::new();
    let mut notes: BTreeMap<String, BTreeSet<usize>> = BTreeMap::new();
    for id in ids {
        match &id.part {
            Part::Step(_) | Part::Transition(_) => {
                node(d, id)?;
                nodes.push(id.clone());
            }
            Part::Action(step, k) => actions.push((id.chart.clone(), step.clone(), *k)),
            Part::Link(a, b) | Part::Connector(a, b, _) => links.push(link(d, &id.chart, a, b)?),
            Part::Note(n) => {
                notes.entry(id.chart.clone()).or_default().insert(*n);
            }
            Part::Chart => return refuse(say!("a chart is deleted as a whole, not with symbols")),
            Part::Other(_) => {
                return refuse(say!("this is only drawn; nothing in the text stands for it alone"));
            }
        }
    }
    for (chart, numbers) in &notes {
        super::notes::delete(d, chart, numbers)?;
    }
    actions.sort();
    actions.dedup();
    for (chart, step, k) in actions.iter().rev() {
        super::fields::remove_action(d, chart, step, *k)?;
    }
    for (chart, step, at, leaving) in links {
        let t = d.transition_mut(&chart, at)?;
        let list = if leaving { &mut t.from } else { &mut t.to };
        list.retain(|n| *n.text != *step);
    }
    let charts: BTreeSet<String> = nodes.iter().map(|id| id.chart.clone()).collect();
    for chart in charts {
        let own: Vec<ItemId> = nodes.iter().filter(|id| id.chart == chart).cloned().collect();
        let mut chosen = Chosen::new(d, &own)?;
        let home = d.chart_mut(&chart)?;
        let extra = if heal { heal_all(home, &mut chosen) } else { BTreeSet::new() };
        take_away(home, &chosen, &extra);
    }
    Ok(())
}

/// The chart, step and transition of a link; the flag is true if the link leaves the step.
fn link(d: &Draft<'_>, chart: &str, a: &End, b: &End) -> Result<(String, String, Span, bool), Refusal> {
    let (step, number, leaving) = match (a, b) {
        (End::Step(s), End::Transition(t)) => (s, *t, true),
        (End::Transition(t), End::Step(s)) => (s, *t, false),
        _ => return refuse(say!("a link joins a step and a transition")),
    };
    Ok((chart.to_owned(), step.clone(), d.number(chart, number)?, leaving))
}

/// Removes the chosen parts from the chart, and the transitions that cannot exist without them.
#[inline(never)]
fn take_away(chart: &mut Chart, chosen: &Chosen, extra: &BTreeSet<Span>) {
    chart.items.retain_mut(|item| match item {
        ChartItem::Step(s) => !chosen.has_step(&s.name.text),
        ChartItem::Transition(t) => {
            if chosen.has(t) || extra.contains(&t.at.0) {
                return false;
            }
            let enabled = !t.from.is_empty();
            t.from.retain(|n| !chosen.has_step(&n.text));
            t.to.retain(|n| !chosen.has_step(&n.text));
            !(enabled && t.from.is_empty())
        }
        _ => true,
    });
}

/// A connected region that is deleted.
#[derive(Default)]
struct Region {
    steps: BTreeSet<String>,
    transitions: BTreeSet<Span>,
}

/// Bridges each region; returns the transitions that must be deleted in addition.
fn heal_all(chart: &mut Chart, chosen: &mut Chosen) -> BTreeSet<Span> {
    let mut extra = BTreeSet::new();
    for region in regions(chart, chosen) {
        if let Some(stays) = heal(chart, &region, &mut extra) {
            chosen.transitions.remove(&stays);
        }
    }
    extra
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

/// Bridges a region; returns a chosen transition that must be kept, if there is one.
#[inline(never)]
fn heal(chart: &mut Chart, region: &Region, extra: &mut BTreeSet<Span>) -> Option<Span> {
    let a = around(chart, region);
    let inside = |n: &Name| region.steps.contains(&*n.text);
    let all_inside = |list: &[Name]| list.iter().all(inside);
    let bridge = |list: &mut Vec<Name>, by: &[Name]| {
        let Some(first) = list.iter().find(|n| inside(n)).map(|n| n.text.to_string()) else { return };
        list.retain(|n| !inside(n) || *n.text == *first);
        replace(list, &first, by);
    };
    match (a.t_before.as_slice(), a.s_before.as_slice(), a.t_behind.as_slice(), a.s_behind.as_slice()) {
        ([..], [], [], [_]) if !a.t_before.is_empty() => {
            each(chart, &a.t_before, |t| bridge(&mut t.to, &a.s_behind));
        }
        ([], [_], [..], []) if !a.t_behind.is_empty() => {
            each(chart, &a.t_behind, |t| bridge(&mut t.from, &a.s_before));
        }
        ([..], [], [only], []) if !a.t_before.is_empty() && all_inside(&only.from) => {
            extra.insert(only.at.0);
            each(chart, &a.t_before, |t| bridge(&mut t.to, &only.to));
        }
        ([only], [], [..], []) if !a.t_behind.is_empty() && all_inside(&only.to) => {
            extra.insert(only.at.0);
            each(chart, &a.t_behind, |t| bridge(&mut t.from, &only.from));
        }
        ([], [before], [], [behind]) if !region.steps.is_empty() => {
            return join_steps(chart, region, before, behind);
        }
        _ => {}
    }
    None
}

/// Applies a change to the transitions in the list.
fn each(chart: &mut Chart, list: &[Transition], change: impl Fn(&mut Transition)) {
    for item in &mut chart.items {
        if let ChartItem::Transition(t) = item
            && list.iter().any(|l| l.at.0 == t.at.0)
        {
            change(t);
        }
    }
}

/// Makes the transition after the preceding step lead to the succeeding step.
#[inline(never)]
fn join_steps(chart: &mut Chart, region: &Region, before: &Name, behind: &Name) -> Option<Span> {
    let mut firsts = chart.items.iter_mut().filter_map(|i| match i {
        ChartItem::Transition(t) if region.transitions.contains(&t.at.0) && has(&t.from, &before.text) => {
            Some(t)
        }
        _ => None,
    });
    let (Some(first), None) = (firsts.next(), firsts.next()) else { return None };
    first.to = vec![behind.clone()];
    first.from = vec![before.clone()];
    Some(first.at.0)
}
