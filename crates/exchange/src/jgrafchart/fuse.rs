//! Step fusion sets: one step that is drawn in several places.
//!
//! JGrafchart activates all steps of a set together, and a transition behind one is enabled when
//! all are active. The steps of one workspace therefore become one step here, with the lines and
//! the actions of all, in the order of the set. Steps of different workspaces cannot become one
//! step of a chart.

use std::collections::{HashMap, HashSet};

use g7_model::{Said, codes, say};

use super::limits::MOST_BYTES;
use super::phrase::{self, Letter};
use super::sheet::{Node, Plan, Sheet, SheetKind, StepSort};
use g7_iec::report::{Report, shown};

/// Merges the steps of each set.
pub(super) fn fuse(plan: &mut Plan, report: &mut Report) {
    for index in 0..plan.sheets.len() {
        let Some(sheet) = plan.sheets.get_mut(index) else { break };
        for set in std::mem::take(&mut sheet.fusions) {
            let top = sheet.kind == SheetKind::Top;
            let prefix = format!("{}.", sheet.name.text);
            let mut by_name: HashMap<&str, Vec<usize>> = HashMap::new();
            for (number, step) in sheet.steps.iter().enumerate() {
                by_name.entry(&step.name.text).or_default().push(number);
            }
            let mut members: Vec<usize> = Vec::new();
            let mut seen = HashSet::new();
            let mut trouble = None;
            for text in &set.members {
                let name = text.text.trim();
                let name = if top { name.strip_prefix(&prefix).unwrap_or(name) } else { name };
                match by_name.get(name) {
                    Some(found) => members.extend(found.iter().filter(|n| seen.insert(**n))),
                    None if name.contains('.') => {
                        trouble = Some(say!("`{}` is in another workspace", shown(name)));
                    }
                    None => {
                        let what = say!("`{}` is the name of no step in this workspace", shown(name));
                        report.say(&codes::UNKNOWN_OBJECT, &text.at, what);
                    }
                }
            }
            if let Some(what) = trouble.or_else(|| obstacle(sheet, &members, set.abortive)) {
                let what = say!("a step fusion set, whose steps are one step, is not carried over: {what}");
                report.say(&codes::NOT_CARRIED, &set.at, what);
                continue;
            }
            if members.len() < 2 {
                report.say(
                    &codes::LEFT_OUT,
                    &set.at,
                    say!("a step fusion set of less than two steps has no effect"),
                );
                continue;
            }
            unite(sheet, &members);
        }
    }
}

/// The reason why steps cannot be merged.
fn obstacle(sheet: &Sheet, members: &[usize], abortive: bool) -> Option<Said> {
    for step in members.iter().filter_map(|m| sheet.steps.get(*m)) {
        let name = shown(&step.name.text);
        if !matches!(step.sort, StepSort::Plain | StepSort::Initial) {
            return Some(say!("`{name}` is more than a plain step"));
        }
        if step.fused.is_some() || step.actions.len() > 1 {
            return Some(say!("`{name}` is in a second set"));
        }
        let leaves = |text: &str| {
            if text.len() > MOST_BYTES {
                return true;
            }
            let (statements, _) = phrase::actions(text, usize::from(u16::MAX));
            statements.iter().any(|s| matches!(s.letter, Letter::X | Letter::A))
        };
        // In JGrafchart leaving one step aborts the others, which then run `A`, not `X`.
        if abortive && step.actions.iter().any(|t| leaves(&t.text)) {
            return Some(say!("it is abortive, and `{name}` has actions for its end"));
        }
    }
    None
}

/// The first step takes over the lines and actions of the others.
fn unite(sheet: &mut Sheet, members: &[usize]) {
    let Some((&first, others)) = members.split_first() else { return };
    let mut actions = Vec::new();
    let mut initial = false;
    for &other in others {
        let Some(step) = sheet.steps.get_mut(other) else { continue };
        actions.append(&mut step.actions);
        initial |= step.sort == StepSort::Initial;
        step.fused = Some(first);
    }
    if let Some(step) = sheet.steps.get_mut(first) {
        step.actions.append(&mut actions);
        if initial {
            step.sort = StepSort::Initial;
        }
    }
    let others: HashSet<usize> = others.iter().copied().collect();
    for node in sheet.ids.values_mut() {
        if let Node::Step(step) = node
            && others.contains(step)
        {
            *node = Node::Step(first);
        }
    }
}
