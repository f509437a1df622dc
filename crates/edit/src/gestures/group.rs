//! Moves a sequence into the expansion of a new macro-step.
//!
//! The sequence has one step that is entered from outside and one that is left. They become the
//! entry and the exit step if no link inside leads to the first or leaves the last; otherwise an
//! entry or exit step is added. Names in the moved text are adapted to the new chart; `X12` of a
//! moved step becomes `M3.X12`.

use g7_compile::references::Written;
use g7_compile::{Definition, references};
use g7_model::{Chart, ChartItem, FileId, Item, Name, Span, Step, StepKind, Transition, say};
use g7_syntax::{Part, print_part, show_name, show_path_name, show_step_name};

use super::chosen::Chosen;
use super::graph::replace;
use super::insert::macro_name;
use crate::change::{Refusal, refuse};
use crate::difference::reindent;
use crate::draft::Draft;
use crate::id::ItemId;
use crate::splice::{Splice, spliced};

/// The sequence that moves.
struct Sequence {
    steps: Vec<Step>,
    /// The transitions between its steps.
    inner: Vec<Transition>,
    first: String,
    last: String,
    entry: bool,
    exit: bool,
}

#[inline(never)]
pub(crate) fn into_macro(d: &mut Draft<'_>, ids: &[ItemId]) -> Result<(), Refusal> {
    let chosen = Chosen::new(d, ids)?;
    let chart = chosen.chart.clone();
    let home = d.chart(&chart)?.clone();
    let sequence = sequence(&home, &chosen)?;
    let name = macro_name(d, &chart, &d.step_name(&home))?;
    let expansion = d.chart_name(&format!("Expansion{}", name.trim_start_matches('M')));
    let text = expansion_text(d, &home, &sequence, (&name, &expansion))?;
    let (doc, problems) = g7_syntax::parse(&text, FileId(0));
    let (Some(new), None) = (doc.charts().next(), problems.first()) else {
        return refuse(say!("this sequence cannot be written as an expansion"));
    };
    let mut new = new.clone();
    new.at = d.fresh_as(text.trim_end());
    let k = d.doc.items.iter().position(|i| matches!(i, Item::Chart(c) if *c.name.text == *chart));
    d.doc.items.insert(k.map_or(0, |k| k + 1), Item::Chart(new));
    swap(d, &chart, &sequence, (&name, &expansion))?;
    d.select_step(&chart, &name);
    Ok(())
}

#[inline(never)]
fn sequence(home: &Chart, chosen: &Chosen) -> Result<Sequence, Refusal> {
    let inside = |n: &Name| chosen.has_step(&n.text);
    let steps: Vec<Step> = home.steps().filter(|s| inside(&s.name)).cloned().collect();
    if steps.is_empty() {
        return refuse(say!("choose the steps that go into the macro-step"));
    }
    if let Some(s) = steps.iter().find(|s| matches!(s.kind, StepKind::Entry | StepKind::Exit)) {
        return refuse(say!("step `{}` is an end of its chart and stays there", s.name.text));
    }
    let within =
        |t: &&Transition| t.from.iter().chain(&t.to).all(inside) && !(t.from.is_empty() && t.to.is_empty());
    let inner: Vec<Transition> = home.transitions().filter(within).cloned().collect();
    let outer = || home.transitions().filter(|t| !within(t));
    let entered: Vec<&Name> = outer().flat_map(|t| &t.to).filter(|n| inside(n)).collect();
    let left: Vec<&Name> = outer().flat_map(|t| &t.from).filter(|n| inside(n)).collect();
    let first = one_end(&entered, &steps, |s| s.initial || !inner.iter().any(|t| t.to.contains(&s.name)));
    let last = one_end(&left, &steps, |s| !inner.iter().any(|t| t.from.contains(&s.name)));
    let (Some(first), Some(last)) = (first, last) else {
        return refuse(say!(
            "a macro-step is entered at one step and left at one step; choose such a sequence"
        ));
    };
    if let Some(s) = steps.iter().find(|s| s.initial && *s.name.text != *first) {
        return refuse(say!("step `{}` is initial; in a macro-step only its first step can be", s.name.text));
    }
    let plain = |name: &str| steps.iter().any(|s| *s.name.text == *name && s.kind == StepKind::Plain);
    let entry = plain(&first) && !inner.iter().any(|t| t.to.iter().any(|n| *n.text == *first));
    let free = !inner.iter().any(|t| t.from.iter().any(|n| *n.text == *last));
    let exit = plain(&last) && free && !(entry && first == last);
    Ok(Sequence { steps, inner, first, last, entry, exit })
}

/// The only step at which links from outside meet; if there are no such links, the only step for
/// which `fits` holds.
fn one_end(met: &[&Name], steps: &[Step], fits: impl Fn(&Step) -> bool) -> Option<String> {
    if let Some(first) = met.first() {
        return met.iter().all(|n| n == first).then(|| first.text.to_string());
    }
    let mut found = steps.iter().filter(|s| fits(s));
    let step = found.next()?;
    found.next().is_none().then(|| step.name.text.to_string())
}

/// A name that no step of the sequence has.
fn end_name(sequence: &Sequence, base: &str) -> String {
    let taken = |n: &str| sequence.steps.iter().any(|s| *s.name.text == *n);
    if !taken(base) {
        return base.to_owned();
    }
    (1u64..).map(|n| format!("{base}{n}")).find(|n| !taken(n)).unwrap_or_default()
}

/// The text of the expansion, made from the lines that move.
#[inline(never)]
fn expansion_text(
    d: &mut Draft<'_>,
    home: &Chart,
    sequence: &Sequence,
    (name, expansion): (&str, &str),
) -> Result<String, Refusal> {
    let moved: Vec<Span> =
        sequence.steps.iter().map(|s| s.at.0).chain(sequence.inner.iter().map(|t| t.at.0)).collect();
    let names = names(d, home, sequence, &moved, name);
    let mut steps = Vec::new();
    let mut transitions = Vec::new();
    let (entry, exit) = (end_name(sequence, "E"), end_name(sequence, "S"));
    let (first, last) = (show_step_name(&sequence.first), show_step_name(&sequence.last));
    if !sequence.entry {
        steps.push(format!("entry step {entry}"));
        transitions.push(format!("{entry} -> {first} when TRUE"));
    }
    for step in &sequence.steps {
        let mut own = names.clone();
        let words = match &*step.name.text {
            n if n == sequence.first && sequence.entry => Some("entry step "),
            n if n == sequence.last && sequence.exit => Some("exit step "),
            _ if step.initial && step.kind == StepKind::Plain => Some("step "),
            _ if step.initial && matches!(step.kind, StepKind::Macro(_)) => Some("macro "),
            _ if step.initial => Some("enclosing step "),
            _ => None,
        };
        if let Some(words) = words {
            own.push(Splice::new(step.at.0.start as usize, step.name.at.0.start as usize, words));
        }
        steps.push(moved_text(d, step.at.0, own)?);
    }
    for t in &sequence.inner {
        let lead = if t.chained { print_part(Part::Steps(&t.from), None) + " " } else { String::new() };
        transitions.push(lead + &moved_text(d, t.at.0, names.clone())?);
    }
    if !sequence.exit {
        steps.push(format!("exit step {exit}"));
        transitions.push(format!("{last} -> {exit} when TRUE"));
    }
    let lines = |list: &[String]| {
        list.iter().map(|l| format!("  {}\n", reindent(l, "", "  ", "\n"))).collect::<String>()
    };
    let gap = if transitions.is_empty() { "" } else { "\n" };
    Ok(format!("macrochart {} {{\n{}{gap}{}}}\n", show_name(expansion), lines(&steps), lines(&transitions)))
}

/// The text of a part that moves, with its names adapted.
#[inline(never)]
fn moved_text(d: &Draft<'_>, at: Span, splices: Vec<Splice>) -> Result<String, Refusal> {
    let (start, end) = (at.start as usize, at.end as usize);
    let mut own: Vec<Splice> = splices
        .into_iter()
        .filter(|s| s.start >= start && s.end <= end)
        .map(|s| Splice { start: s.start - start, end: s.end - start, ..s })
        .collect();
    own.sort_by_key(|s| (s.start, s.end));
    let text = d.source.text.get(start..end).unwrap_or_default();
    let line = d.source.text.get(..start).unwrap_or_default().rsplit('\n').next().unwrap_or_default();
    let indent = line.get(..line.len() - line.trim_start().len()).unwrap_or_default();
    let text = spliced(text, &own).ok_or_else(|| Refusal::new(say!("this sequence cannot be moved")))?;
    Ok(reindent(&text, indent, "", "\n"))
}

/// Names that must be written differently: returns the changes inside the moved parts, and adds the
/// others to `d.besides`.
#[inline(never)]
fn names(d: &mut Draft<'_>, home: &Chart, sequence: &Sequence, moved: &[Span], name: &str) -> Vec<Splice> {
    let refs = references(d.source.document);
    let within = |at: Span| moved.iter().any(|m| m.start <= at.start && at.end <= m.end);
    let has = |s: &str| sequence.steps.iter().any(|x| *x.name.text == *s);
    let mut inside = Vec::new();
    for found in refs.all() {
        let Written::Path { first, .. } = found.written else { continue };
        let (start, old) = (found.at.start as usize, found.at);
        match &found.definition {
            Definition::Variable { chart: Some(c), .. } | Definition::Action { chart: Some(c), .. }
                if *c == *home.name.text && first && within(old) =>
            {
                inside.push(Splice::new(start, start, format!("{}.", show_path_name(c, true, false))));
            }
            Definition::Step { chart, name: step } if *chart == *home.name.text && has(step) => {
                if first && within(old) {
                    continue; // still in its own chart
                }
                let path = format!("{}.", show_path_name(name, first, false));
                let splice = Splice::new(start, start, path);
                if within(old) { inside.push(splice) } else { d.besides.push(splice) }
            }
            _ => {}
        }
    }
    inside
}

/// Replaces the sequence by the macro-step.
#[inline(never)]
fn swap(
    d: &mut Draft<'_>,
    chart: &str,
    sequence: &Sequence,
    (name, expansion): (&str, &str),
) -> Result<(), Refusal> {
    let mut step = d.new_step(name);
    step.kind = StepKind::Macro(d.new_name(expansion));
    step.initial = sequence.steps.iter().any(|s| s.initial);
    let by = [d.new_name(name)];
    let home = d.chart_mut(chart)?;
    let moved = |n: &Name| sequence.steps.iter().any(|s| s.name == *n);
    let k = home.items.iter().position(|i| matches!(i, ChartItem::Step(s) if moved(&s.name)));
    home.items.insert(k.unwrap_or(0), ChartItem::Step(step));
    home.items.retain_mut(|item| match item {
        ChartItem::Step(s) => !moved(&s.name),
        ChartItem::Transition(t) => {
            if sequence.inner.iter().any(|i| i.at.0 == t.at.0) {
                return false;
            }
            replace(&mut t.to, &sequence.first, &by);
            replace(&mut t.from, &sequence.last, &by);
            true
        }
        _ => true,
    });
    Ok(())
}
