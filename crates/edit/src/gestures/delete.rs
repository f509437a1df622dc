//! Deletes parts of a chart and joins what was around them.
//!
//! With a step, the transitions that only this step enabled are deleted. A transition that led only
//! to this step stays without a succeeding step, so that the user can build on. With `heal`, each
//! connected region that is deleted is bridged first (`heal`).

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{Chart, ChartItem, Span, say};

use super::chosen::Chosen;
use super::heal::bridge;
use super::nodes::{link, node};
use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::id::{ItemId, Part};

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
        if heal {
            bridge(home, &mut chosen);
        }
        take_away(home, &chosen);
    }
    Ok(())
}

/// Removes the chosen parts from the chart, and the transitions that cannot exist without them.
#[inline(never)]
fn take_away(chart: &mut Chart, chosen: &Chosen) {
    chart.items.retain_mut(|item| match item {
        ChartItem::Step(s) => !chosen.has_step(&s.name.text),
        ChartItem::Transition(t) => {
            if chosen.has(t) {
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
