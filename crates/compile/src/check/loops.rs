//! Finds loops that never become stable: steps joined in a circle by receptivities that are always
//! true, also through AND divergences and macro-steps.
//!
//! First the steps are sorted into circles along the transitions that always clear, because a step
//! can become active again only within its circle. Then a token is moved round each circle.

use std::collections::BTreeSet;

use g7_model::{Problem, Said, codes, say};

use super::exclusion::always;
use super::facts::Facts;
use crate::ir::{StepId, StepSort, Transition, Unit};

/// The largest number of starts that are tried in one circle.
const STARTS: usize = 16;
/// The largest circle that is tried, in steps; larger ones are found in the run.
const LARGEST: usize = 500;
/// Most situations named in a message.
const SHOWN: usize = 8;
/// The number of situations that are tried in one circle, in addition to twice its size.
const LENGTH: usize = 64;

#[inline(never)]
pub(super) fn check(facts: &Facts<'_>, problems: &mut Vec<Problem>) {
    let unit = facts.unit;
    let ever: Vec<&Transition> = unit
        .transitions
        .iter()
        .filter(|t| !t.from.is_empty() && !t.to.is_empty() && always(facts, &t.receptivity, &t.from))
        .collect();
    if ever.is_empty() {
        return;
    }
    let circles = circles(unit, &ever);
    let mut of_step = vec![usize::MAX; unit.steps.len()];
    for (k, step) in circles.iter().enumerate().flat_map(|(k, c)| c.iter().map(move |s| (k, s))) {
        if let Some(circle) = of_step.get_mut(step.index()) {
            *circle = k;
        }
    }
    let home = |s: StepId| of_step.get(s.index()).copied().unwrap_or(usize::MAX);
    let mut own: Vec<Vec<&Transition>> = vec![Vec::new(); circles.len()];
    for t in ever {
        let Some(circle) = t.from.first().map(|s| home(leaves(unit, *s))) else { continue };
        let all = t.from.iter().all(|s| home(leaves(unit, *s)) == circle);
        let some = t.to.iter().any(|s| home(enters(unit, *s)) == circle);
        if let Some(list) = own.get_mut(circle).filter(|_| all && some) {
            list.push(t);
        }
    }
    for (circle, own) in circles.iter().zip(own).filter(|(c, _)| c.len() <= LARGEST) {
        let played = own.iter().take(STARTS);
        let found = played.filter_map(|t| play(unit, &own, &t.from, circle.len()).map(|c| (*t, c))).next();
        let Some((first, names)) = found else { continue };
        let way = if names.len() > SHOWN {
            format!("{} → …", names.get(..SHOWN).unwrap_or(&names).join(" → "))
        } else {
            names.join(" → ")
        };
        let way = Said::foreign(way);
        let what = say!("the loop {way} never rests: each of its receptivities is always true");
        problems.push(
            Problem::new(&codes::RESTLESS_LOOP, first.at, what)
                .help(say!("give at least one of its transitions a receptivity that can be false")),
        );
    }
}

/// The step that becomes active together with this one: for a macro-step its entry step.
fn enters(unit: &Unit, step: StepId) -> StepId {
    end(unit, step, true)
}

/// The step whose activity counts for the transitions after this one: for a macro-step its exit
/// step.
fn leaves(unit: &Unit, step: StepId) -> StepId {
    end(unit, step, false)
}

fn end(unit: &Unit, mut step: StepId, entry: bool) -> StepId {
    // Expansions do not nest in circles; the bound only guards against an error here.
    for _ in 0..=unit.charts.len() {
        let Some(StepSort::Macro(chart)) = unit.steps.get(step.index()).map(|s| &s.sort) else { return step };
        let inner = unit.charts.get(chart.index()).and_then(|c| if entry { c.entry } else { c.exit });
        let Some(inner) = inner else { return step };
        step = inner;
    }
    step
}

/// Sets of steps that all lead to each other (strongly connected, by two walks).
#[inline(never)]
fn circles(unit: &Unit, ever: &[&Transition]) -> Vec<Vec<StepId>> {
    let steps = unit.steps.len();
    // A transition is a node behind the steps: each of its steps on one side leads to each on the
    // other, and these pairs can be many more than the steps.
    let count = steps + ever.len();
    let mut ahead = vec![Vec::new(); count];
    let mut back = vec![Vec::new(); count];
    let mut lead = |from: StepId, to: StepId| {
        if let (Some(a), Some(b)) = (ahead.get_mut(from.index()), back.get_mut(to.index())) {
            a.push(to);
            b.push(from);
        }
    };
    for (t, node) in ever.iter().zip((steps as u32..).map(StepId)) {
        t.from.iter().for_each(|from| lead(leaves(unit, *from), node));
        t.to.iter().for_each(|to| lead(node, enters(unit, *to)));
    }
    let mut seen = vec![false; count];
    let mut order = Vec::new();
    for start in (0..count as u32).map(StepId) {
        walk(start, &ahead, &mut seen, &mut order);
    }
    let mut taken = vec![false; count];
    let mut found = Vec::new();
    for start in order.into_iter().rev() {
        let mut circle = Vec::new();
        walk(start, &back, &mut taken, &mut circle);
        circle.retain(|s| s.index() < steps);
        if circle.len() > 1 {
            found.push(circle);
        }
    }
    found
}

/// The steps that can be reached from one step, each after those that follow it.
#[inline(never)]
fn walk(start: StepId, next: &[Vec<StepId>], seen: &mut [bool], order: &mut Vec<StepId>) {
    if seen.get_mut(start.index()).is_none_or(|s| std::mem::replace(s, true)) {
        return;
    }
    let mut way = vec![(start, 0)];
    while let Some((step, k)) = way.last_mut() {
        let (step, at) = (*step, *k);
        *k += 1;
        match next.get(step.index()).and_then(|n| n.get(at)) {
            Some(to) => {
                if seen.get_mut(to.index()).is_some_and(|s| !std::mem::replace(s, true)) {
                    way.push((*to, 0));
                }
            }
            None => {
                order.push(step);
                way.pop();
            }
        }
    }
}

/// Clears transitions, beginning with the steps of one transition, until a situation recurs or
/// nothing changes. Returns the names of the steps of the cycle, if there is one.
#[inline(never)]
fn play(unit: &Unit, own: &[&Transition], start: &[StepId], size: usize) -> Option<Vec<String>> {
    let mut now: BTreeSet<StepId> = start.iter().map(|s| leaves(unit, *s)).collect();
    let mut seen: Vec<BTreeSet<StepId>> = Vec::new();
    // In a circle without AND one walk round is enough. With AND the situations of the branches
    // combine; a cycle that does not appear soon is left to the run.
    for _ in 0..2 * size + LENGTH {
        if let Some(first) = seen.iter().position(|s| *s == now) {
            let round = seen.get(first..).unwrap_or(&[]);
            return (round.len() > 1).then(|| round.iter().map(|s| names(unit, s)).collect());
        }
        let clearing: Vec<&&Transition> =
            own.iter().filter(|t| t.from.iter().all(|s| now.contains(&leaves(unit, *s)))).collect();
        let mut next = now.clone();
        for t in &clearing {
            t.from.iter().for_each(|s| {
                next.remove(&leaves(unit, *s));
            });
        }
        next.extend(clearing.iter().flat_map(|t| &t.to).map(|s| enters(unit, *s)));
        if clearing.is_empty() {
            return None;
        }
        seen.push(std::mem::replace(&mut now, next));
    }
    None
}

fn names(unit: &Unit, situation: &BTreeSet<StepId>) -> String {
    let name = |s: &StepId| unit.steps.get(s.index()).map_or("", |s| &*s.name).to_owned();
    let all: Vec<String> = situation.iter().map(name).collect();
    if all.len() == 1 { format!("`{}`", all.concat()) } else { format!("`({})`", all.join(", ")) }
}
