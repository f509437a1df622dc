//! Changes single fields of steps, transitions and charts.

use g7_model::{Action, ChartItem, ChartKind, FileId, Problem, Span, StepKind, say};

use super::graph::{arriving, leaving, may_arrive, may_leave};
use super::nodes::{Node, node};
use super::table::add_expansion;
use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::gesture::Sort;
use crate::id::{ItemId, Part};

/// The transition that an id names.
fn transition(d: &Draft<'_>, id: &ItemId) -> Result<g7_model::Span, Refusal> {
    match node(d, id)? {
        Node::Transition(at) => Ok(at),
        Node::Step(_) => refuse(say!("this belongs to a transition, not to a step")),
    }
}

/// The name of the step that an id names.
fn step(d: &Draft<'_>, id: &ItemId) -> Result<String, Refusal> {
    match node(d, id)? {
        Node::Step(name) => Ok(name),
        Node::Transition(_) => refuse(say!("this belongs to a step, not to a transition")),
    }
}

#[inline(never)]
pub(crate) fn receptivity(d: &mut Draft<'_>, id: &ItemId, text: &str) -> Result<(), Refusal> {
    let at = transition(d, id)?;
    let typed = text.trim();
    let typed = if typed.is_empty() { "TRUE" } else { typed };
    let (mut e, problems) = g7_syntax::parse_expr(typed, FileId(0));
    if let Some(problem) = problems.first() {
        return refuse(say!("this is not a receptivity: {}", problem.what));
    }
    e.at = d.fresh_as(typed);
    d.transition_mut(&id.chart, at)?.receptivity = e;
    d.select(id.clone());
    Ok(())
}

/// Stands before the text of an action, so that the parser can read this text alone.
const HEAD: &str = "chart A {\nstep 1 {\n";

/// Reads the actions in a text; each keeps the text that was typed.
#[inline(never)]
pub(crate) fn read_actions(d: &mut Draft<'_>, text: &str) -> Result<Vec<Action>, Refusal> {
    let read = actions(text).map_err(|problems| match problems.first() {
        Some(problem) => Refusal::new(say!("this is not an action: {}", problem.what)),
        None => Refusal::new(say!("this is more than the actions of one step")),
    })?;
    let mut actions = Vec::new();
    for (k, action) in read.iter().enumerate() {
        // Text between two actions, notes included, belongs to the first of them.
        let from = if k == 0 { 0 } else { action.at.0.start as usize };
        let to = read.get(k + 1).map_or(text.len(), |n| n.at.0.start as usize);
        let raw = text.get(from..to).unwrap_or_default().trim();
        actions.push(Action { at: d.fresh_as(raw), kind: action.kind.clone() });
    }
    Ok(actions)
}

/// The actions in a text, with their places in it; or the problems of the text, none if it is more than the actions
/// of one step.
pub(crate) fn actions(text: &str) -> Result<Vec<Action>, Vec<Problem>> {
    let whole = format!("{HEAD}{text}\n}}\n}}\n");
    let (doc, mut problems) = g7_syntax::parse(&whole, FileId(0));
    let own = |at: &mut Span| {
        let head = HEAD.len() as u32;
        (at.start, at.end) = (at.start.saturating_sub(head), at.end.saturating_sub(head));
    };
    if !problems.is_empty() {
        problems
            .iter_mut()
            .flat_map(|p| &mut p.fixes)
            .flat_map(|f| &mut f.edits)
            .for_each(|e| own(&mut e.at));
        return Err(problems);
    }
    let mut charts = doc.charts();
    let items = charts.next().map(|c| c.items.as_slice()).unwrap_or_default();
    let ([ChartItem::Step(step)], None, 1) = (items, charts.next(), doc.items.len()) else {
        return Err(Vec::new());
    };
    let mut actions = step.actions.clone();
    actions.iter_mut().for_each(|a| own(&mut a.at.0));
    Ok(actions)
}

#[inline(never)]
pub(crate) fn action(
    d: &mut Draft<'_>,
    id: &ItemId,
    index: Option<usize>,
    text: &str,
) -> Result<(), Refusal> {
    let name = step(d, id)?;
    let index = match (&id.part, index) {
        (Part::Action(_, k), None) => Some(*k),
        (_, index) => index,
    };
    if text.trim().is_empty() {
        let Some(k) = index else { return Ok(()) };
        return remove_action(d, &id.chart, &name, k);
    }
    let text = text.trim();
    // GRAFCET writes no qualifiers: an assignment is a stored action on activation, any other text
    // is a continuous action.
    let understood = if text.contains(":=") { "P1" } else { "N" };
    let new = read_actions(d, text)
        .or_else(|refusal| read_actions(d, &format!("{understood} {text}")).map_err(|_| refusal))?;
    let count = new.len();
    let there = d.step_mut(&id.chart, &name)?;
    let at = match index {
        Some(k) if k < there.actions.len() => {
            there.actions.splice(k..=k, new);
            k
        }
        Some(k) if k > there.actions.len() => {
            return refuse(say!("step `{name}` has no action number {k}"));
        }
        _ => {
            there.actions.extend(new);
            there.actions.len() - count
        }
    };
    d.select(ItemId::action(id.chart.as_str(), name, at));
    Ok(())
}

pub(crate) fn remove_action(d: &mut Draft<'_>, chart: &str, name: &str, k: usize) -> Result<(), Refusal> {
    let step = d.step_mut(chart, name)?;
    if k >= step.actions.len() {
        return refuse(say!("step `{name}` has no action number {k}"));
    }
    step.actions.remove(k);
    Ok(())
}

#[inline(never)]
pub(crate) fn comment(d: &mut Draft<'_>, id: &ItemId, text: &str) -> Result<(), Refusal> {
    let comment = Some(text.trim()).filter(|t| !t.is_empty()).map(Box::from);
    if let Part::Note(n) = id.part {
        return super::notes::change(d, &id.chart, n, comment.as_deref());
    }
    if id.part == Part::Chart {
        d.chart_mut(&id.chart)?.comment = comment;
    } else {
        match node(d, id)? {
            Node::Step(name) => d.step_mut(&id.chart, &name)?.comment = comment,
            Node::Transition(at) => d.transition_mut(&id.chart, at)?.comment = comment,
        }
    }
    d.select(id.clone());
    Ok(())
}

#[inline(never)]
pub(crate) fn label(d: &mut Draft<'_>, id: &ItemId, text: &str) -> Result<(), Refusal> {
    let at = transition(d, id)?;
    let text = text.trim();
    let old = d.transition(&id.chart, at)?.label.as_ref().map(|l| l.text.to_string());
    if old.as_deref().unwrap_or_default() == text {
        return Ok(());
    }
    let taken = d.chart(&id.chart)?.transitions().any(|t| t.label.as_ref().is_some_and(|l| *l.text == *text));
    if taken {
        return refuse(say!("another transition has the label `{text}` already"));
    }
    let new = if text.is_empty() { None } else { Some(d.new_name(text)) };
    super::places::relabel(d, &id.chart, at, old.as_deref(), new.as_ref())?;
    d.transition_mut(&id.chart, at)?.label = new;
    d.select(id.clone());
    Ok(())
}

pub(crate) fn priority(d: &mut Draft<'_>, id: &ItemId, n: Option<u32>) -> Result<(), Refusal> {
    let at = transition(d, id)?;
    d.transition_mut(&id.chart, at)?.priority = n;
    d.select(id.clone());
    Ok(())
}

/// Changes the preceding or succeeding steps of a transition.
#[inline(never)]
pub(crate) fn ends(
    d: &mut Draft<'_>,
    id: &ItemId,
    before: Option<&[String]>,
    after: Option<&[String]>,
) -> Result<(), Refusal> {
    let at = transition(d, id)?;
    for (names, leaving) in [(before, true), (after, false)] {
        let Some(names) = names else { continue };
        let mut list: Vec<g7_model::Name> = Vec::new();
        for name in names {
            let step = d.step(&id.chart, name)?;
            if leaving {
                may_leave(step)?
            } else {
                may_arrive(step)?
            }
            if !super::graph::has(&list, name) {
                list.push(d.new_name(name));
            }
        }
        let t = d.transition_mut(&id.chart, at)?;
        let there = if leaving { &mut t.from } else { &mut t.to };
        if *there != list {
            *there = list;
        }
    }
    let t = d.transition(&id.chart, at)?;
    if t.from.is_empty() && t.to.is_empty() {
        return refuse(say!("a transition joins steps: leave it one at least"));
    }
    d.select(id.clone());
    Ok(())
}

pub(crate) fn initial(d: &mut Draft<'_>, id: &ItemId, on: bool) -> Result<(), Refusal> {
    let name = step(d, id)?;
    d.step_mut(&id.chart, &name)?.initial = on;
    d.select(id.clone());
    Ok(())
}

#[inline(never)]
pub(crate) fn kind(d: &mut Draft<'_>, id: &ItemId, sort: Sort) -> Result<(), Refusal> {
    let name = step(d, id)?;
    let now = d.step(&id.chart, &name)?.kind.clone();
    let new = match sort {
        Sort::Plain => StepKind::Plain,
        Sort::Enclosing => StepKind::Enclosing,
        Sort::Macro if matches!(now, StepKind::Macro(_)) => now,
        Sort::Macro => {
            let expansion = add_expansion(d, &format!("Expansion{name}"))?;
            StepKind::Macro(d.new_name(&expansion))
        }
        Sort::Entry | Sort::Exit => end(d, &id.chart, &name, sort)?,
    };
    d.step_mut(&id.chart, &name)?.kind = new;
    d.select(id.clone());
    Ok(())
}

/// Checks that a chart may have this entry or exit step: only expansions and tasks have them, one
/// of each.
#[inline(never)]
fn end(d: &Draft<'_>, chart: &str, name: &str, sort: Sort) -> Result<StepKind, Refusal> {
    let home = d.chart(chart)?;
    let entry = sort == Sort::Entry;
    let kind = if entry { StepKind::Entry } else { StepKind::Exit };
    if home.kind == ChartKind::Chart {
        return refuse(match entry {
            true => say!("an entry step belongs to an expansion or a task, `{chart}` is a chart"),
            false => say!("an exit step belongs to an expansion or a task, `{chart}` is a chart"),
        });
    }
    if let Some(other) = home.steps().find(|s| s.kind == kind && *s.name.text != *name) {
        return refuse(match entry {
            true => say!("`{chart}` has its entry step already, `{}`", other.name.text),
            false => say!("`{chart}` has its exit step already, `{}`", other.name.text),
        });
    }
    if entry && arriving(home, name).next().is_some() {
        return refuse(say!("a transition leads to step `{name}`; nothing leads to an entry step"));
    }
    if !entry && leaving(home, name).next().is_some() {
        return refuse(say!("a transition follows step `{name}`; nothing follows an exit step"));
    }
    Ok(kind)
}
