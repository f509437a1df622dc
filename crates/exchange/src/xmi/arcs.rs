//! Finds the steps before and behind each transition from arcs and synchronisations.

use std::collections::HashSet;
use std::ops::Range;

use g7_model::{Said, codes, say};

use super::naming::Names;
use super::read::{Plan, Thing};
use super::refs::Xml;
use g7_iec::report::{Report, shown};
use g7_iec::xml::attr;

/// The most ends of all transitions of a file; a synchronisation counts with all of its steps.
pub(super) const MOST_ENDS: usize = 400_000;

/// The steps of a transition, by their numbers in the chart.
#[derive(Clone, Debug, Default)]
pub(super) struct Ends {
    pub(super) from: Vec<usize>,
    pub(super) to: Vec<usize>,
}

/// One side of a node: the steps and synchronisations at the other ends of its arcs.
#[derive(Clone, Debug, Default)]
struct Side {
    steps: Vec<usize>,
    syncs: Vec<usize>,
    transitions: usize,
}

/// The arcs of a chart, by node.
#[derive(Default)]
struct Web {
    /// Before and behind each transition.
    transitions: Vec<(Side, Side)>,
    /// Before and behind each synchronisation.
    syncs: Vec<(Side, Side)>,
}

/// The ends of every transition of a chart; `left` is the number that may still be listed.
pub(super) fn ends(
    plan: &Plan,
    index: usize,
    names: &Names,
    left: &mut usize,
    report: &mut Report,
) -> Vec<Ends> {
    let Some(sheet) = plan.sheets.get(index) else { return Vec::new() };
    let mut web = Web {
        transitions: vec![<(Side, Side)>::default(); sheet.transitions.len()],
        syncs: vec![<(Side, Side)>::default(); sheet.synchronisations.len()],
    };
    for arc in &sheet.arcs {
        web.arc(plan, index, *arc, report);
    }
    for (xml, sides) in sheet.synchronisations.iter().zip(&web.syncs) {
        judge(*xml, sides, report);
    }
    let mut all = Vec::with_capacity(sheet.transitions.len());
    for (number, (xml, (before, behind))) in sheet.transitions.iter().zip(&web.transitions).enumerate() {
        let ends = Ends {
            from: web.gather(before, |sides| &sides.0, *xml, left, report),
            to: web.gather(behind, |sides| &sides.1, *xml, left, report),
        };
        let label = names.label(index, number).map_or(Said::default(), |l| say!(" `{}`", shown(l)));
        let at = attr::head(*xml);
        if ends.from.is_empty() {
            let what = say!("no step stands before the transition{label}: it is always enabled");
            report.say(&codes::OPEN_LINK, &at, what);
        }
        if ends.to.is_empty() {
            let what = say!("no step stands behind the transition{label}: it ends its branch");
            report.say(&codes::OPEN_LINK, &at, what);
        }
        all.push(ends);
    }
    all
}

impl Web {
    fn arc(&mut self, plan: &Plan, sheet: usize, xml: Xml, report: &mut Report) {
        let source = end(plan, sheet, xml, "source", report);
        let target = end(plan, sheet, xml, "target", report);
        let (Some(source), Some(target)) = (source, target) else { return };
        match (source, target) {
            (Thing::Step(_, s), Thing::Transition(_, t)) => self.transition(t, |w| w.0.steps.push(s)),
            (Thing::Transition(_, t), Thing::Step(_, s)) => self.transition(t, |w| w.1.steps.push(s)),
            (Thing::Step(_, s), Thing::Synchronisation(_, k)) => self.sync(k, |w| w.0.steps.push(s)),
            (Thing::Synchronisation(_, k), Thing::Step(_, s)) => self.sync(k, |w| w.1.steps.push(s)),
            (Thing::Transition(_, t), Thing::Synchronisation(_, k)) => {
                self.transition(t, |w| w.1.syncs.push(k));
                self.sync(k, |w| w.0.transitions += 1);
            }
            (Thing::Synchronisation(_, k), Thing::Transition(_, t)) => {
                self.transition(t, |w| w.0.syncs.push(k));
                self.sync(k, |w| w.1.transitions += 1);
            }
            (Thing::Synchronisation(_, a), Thing::Synchronisation(_, b)) => {
                self.sync(a, |w| w.1.syncs.push(b));
                self.sync(b, |w| w.0.syncs.push(a));
            }
            (Thing::Step(..), Thing::Step(..)) => {
                let what = say!("an arc from a step to a step; a transition stands between two steps");
                report.say(&codes::BAD_LINK, &attr::head(xml), what);
            }
            _ => {
                let what =
                    say!("an arc from a transition to a transition; a step stands between two transitions");
                report.say(&codes::BAD_LINK, &attr::head(xml), what);
            }
        }
    }

    fn transition(&mut self, number: usize, change: impl FnOnce(&mut (Side, Side))) {
        if let Some(sides) = self.transitions.get_mut(number) {
            change(sides);
        }
    }

    fn sync(&mut self, number: usize, change: impl FnOnce(&mut (Side, Side))) {
        if let Some(sides) = self.syncs.get_mut(number) {
            change(sides);
        }
    }

    /// The steps of a side and of all synchronisations on it.
    fn gather(
        &self,
        side: &Side,
        pick: fn(&(Side, Side)) -> &Side,
        xml: Xml,
        left: &mut usize,
        report: &mut Report,
    ) -> Vec<usize> {
        let mut steps = side.steps.clone();
        let mut waiting: Vec<usize> = side.syncs.iter().rev().copied().collect();
        let mut seen = HashSet::new();
        while let Some(sync) = waiting.pop() {
            if !seen.insert(sync) {
                let what =
                    say!("synchronisations before or behind this transition meet twice or form a circle");
                report.say(&codes::BAD_LINK, &attr::head(xml), what);
                return steps;
            }
            let Some(inner) = self.syncs.get(sync).map(pick) else { continue };
            let work = inner.steps.len() + inner.syncs.len() + 1;
            let Some(rest) = left.checked_sub(work) else {
                let what = say!("the transitions of this file name more than {MOST_ENDS} steps");
                report.element(&codes::TOO_LARGE, "transitions", &attr::head(xml), what);
                return steps;
            };
            *left = rest;
            steps.extend(&inner.steps);
            waiting.extend(inner.syncs.iter().rev());
        }
        steps
    }
}

/// The node at one end of an arc.
fn end(plan: &Plan, sheet: usize, arc: Xml, name: &str, report: &mut Report) -> Option<Thing> {
    if arc.attribute(name).is_none() {
        let what = say!("an arc without a `{name}`; it is left out");
        report.say(&codes::OPEN_LINK, &attr::head(arc), what);
        return None;
    }
    let (thing, at): (Thing, Range<usize>) = plan.thing(arc, name, report)?;
    let home = match thing {
        Thing::Step(home, _) | Thing::Transition(home, _) | Thing::Synchronisation(home, _) => home,
        Thing::Var(_) | Thing::Sheet(_) | Thing::Action(_) => {
            let what = say!("the `{name}` of an arc is a step, a transition or a synchronisation");
            report.say(&codes::BAD_LINK, &at, what);
            return None;
        }
    };
    if home != sheet {
        let what = say!("the `{name}` of this arc stands in another chart; an arc stays in its own");
        report.say(&codes::BAD_LINK, &at, what);
        return None;
    }
    Some(thing)
}

/// Reports a synchronisation that is wrong in itself.
fn judge(xml: Xml, (before, behind): &(Side, Side), report: &mut Report) {
    let at = attr::head(xml);
    let empty = |s: &Side| s.steps.is_empty() && s.syncs.is_empty() && s.transitions == 0;
    if !before.steps.is_empty() && !behind.steps.is_empty() {
        let what = say!("a synchronisation from steps to steps; a transition stands between them");
        report.say(&codes::BAD_LINK, &at, what);
    } else if before.transitions > 0 && behind.transitions > 0 {
        let what = say!("a synchronisation from transitions to transitions; steps stand between them");
        report.say(&codes::BAD_LINK, &at, what);
    } else if empty(before) || empty(behind) {
        report.say(&codes::OPEN_LINK, &at, say!("a synchronisation that leads nowhere"));
    }
}
