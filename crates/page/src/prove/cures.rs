//! The cures of a conflict as changes of the text: receptivities that exclude each other, a third
//! and parallel way, priority.
//!
//! A cure is offered only if the changed text has no errors and the run that showed the conflict
//! does not show it any more.

use g7_edit::{Gesture, ItemId, Splice};
use g7_engine::Subject;
use g7_ide::File;
use g7_ide::gestures::draft;
use g7_ide::ids::{self, Thing};
use g7_model::{BinaryOp, Chart, Expr, ExprKind, Name, Transition};
use g7_verify::{Claim, Model, Run, blame};
use serde::Serialize;

use super::asked::changed;
use super::place::line_end;
use crate::places::{Change, outward};

/// The kinds of cures.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "CureSort"))]
#[serde(rename_all = "snake_case")]
pub(super) enum Way {
    Exclusive,
    Parallel,
    Priority,
    Assume,
}

/// A change of the text that a refuted claim offers.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(super) struct Cure {
    sort: Way,
    /// The texts that its title names.
    with: Vec<String>,
    splices: Vec<Change>,
}

/// Two transitions in conflict.
struct Pair<'a> {
    file: &'a File,
    chart: &'a Chart,
    /// The numbers of the transitions in the chart, in the order of the text.
    numbers: [usize; 2],
    both: [&'a Transition; 2],
}

/// The cures of a conflict that a run shows.
pub(super) fn cures(file: &File, model: &Model<'_>, run: &Run) -> Vec<Cure> {
    let found = blame(model, &Claim::NoConflict, run);
    let Some(pair) = pair(file, model, &found.transitions) else { return Vec::new() };
    let offered = [
        (Way::Exclusive, pair.exclusive()),
        (Way::Parallel, pair.parallel()),
        (Way::Priority, pair.priority()),
    ];
    let good = |splices: &Vec<Splice>| cures_it(file, model, run, splices);
    let offered = offered.into_iter().filter_map(|(sort, splices)| Some((sort, splices.filter(good)?)));
    offered.map(|(sort, splices)| Cure::new(sort, pair.receptivities(), outward(file, &splices))).collect()
}

impl Cure {
    pub(super) fn new(sort: Way, with: Vec<String>, splices: Vec<Change>) -> Cure {
        Cure { sort, with, splices }
    }
}

/// The receptivities of the two transitions of a conflict as one condition, if both depend on inputs
/// of this moment alone, so that the environment can exclude them together.
pub(super) fn both(file: &File, model: &Model<'_>, run: &Run) -> Option<String> {
    let found = blame(model, &Claim::NoConflict, run);
    let pair = pair(file, model, &found.transitions)?;
    let inputs = found.transitions.iter().all(|rank| is_of_inputs(model, *rank));
    inputs.then(|| format!("{} and {}", pair.operand(0), pair.operand(1)))
}

fn pair<'a>(file: &'a File, model: &Model<'_>, ranks: &[u32]) -> Option<Pair<'a>> {
    let symbols = &model.compiled.symbols;
    let thing = |rank: &u32| match ids::at(file.source.whole(), symbols.transition_place(*rank))? {
        Thing::Transition(chart, n) if symbols.is_written(*rank) => Some((chart, n)),
        _ => None,
    };
    let [(chart, a), (other, b)] = ranks.iter().filter_map(thing).collect::<Vec<_>>().try_into().ok()?;
    if !std::ptr::eq(chart, other) || a == b {
        return None;
    }
    let numbers = [a.min(b), a.max(b)];
    let both = numbers.map(|n| chart.transitions().nth(n));
    Some(Pair { file, chart, numbers, both: [both[0]?, both[1]?] })
}

/// True if a receptivity depends on inputs of this moment alone, so that the environment can exclude it.
fn is_of_inputs(model: &Model<'_>, rank: u32) -> bool {
    let p = &model.compiled.program;
    let reads = p.reads(Subject::Transition(rank));
    let plain = reads.steps.is_empty() && reads.groups.is_empty() && reads.watches.is_empty() && !reads.time;
    plain && !reads.words.is_empty() && reads.inputs(p).count() == reads.words.len()
}

/// True if a changed text has no errors and the run does not show this conflict any more.
fn cures_it(file: &File, model: &Model<'_>, run: &Run, splices: &[Splice]) -> bool {
    let Some((_, asked)) = changed(file, splices) else { return false };
    let new = Model::new(&asked.compiled, asked.assume.clone());
    if !g7_verify::replay(&new, &Claim::NoConflict, run) {
        return true;
    }
    // Another conflict in the same scan is not this one's.
    let names = |model: &Model<'_>| -> Vec<String> {
        let symbols = &model.compiled.symbols;
        let found = blame(model, &Claim::NoConflict, run);
        found.transitions.iter().map(|r| symbols.transition_text(*r).to_owned()).collect()
    };
    names(&new) != names(model)
}

impl Pair<'_> {
    fn written(&self, e: &Expr) -> &str {
        self.file.text().get(self.file.source.range(e.at.0)).unwrap_or_default()
    }

    fn receptivities(&self) -> Vec<String> {
        self.both.iter().map(|t| self.written(&t.receptivity).to_owned()).collect()
    }

    /// The receptivity of one of the two as an operand of `and`.
    fn operand(&self, n: usize) -> String {
        let Some(t) = self.both.get(n) else { return String::new() };
        let text = self.written(&t.receptivity);
        match &t.receptivity.kind {
            ExprKind::Path(_) | ExprKind::Direct(_) | ExprKind::Literal(_) => text.to_owned(),
            ExprKind::Binary(BinaryOp::And, ..) | ExprKind::Unary(..) => text.to_owned(),
            _ => in_brackets(text),
        }
    }

    fn not(&self, n: usize) -> String {
        let Some(t) = self.both.get(n) else { return String::new() };
        let text = self.written(&t.receptivity);
        match &t.receptivity.kind {
            ExprKind::Path(_) | ExprKind::Direct(_) => format!("not {text}"),
            _ => format!("not {}", in_brackets(text)),
        }
    }

    fn id(&self, n: usize) -> ItemId {
        let number = self.numbers.get(n).copied().unwrap_or_default();
        ItemId::transition(&*self.chart.name.text, number)
    }

    fn gesture(&self, gesture: &Gesture) -> Option<Vec<Splice>> {
        Some(draft(self.file, gesture).ok()?.splices)
    }

    fn receptivity(&self, n: usize, text: String) -> Option<Vec<Splice>> {
        self.gesture(&Gesture::Receptivity { id: self.id(n), text })
    }

    /// The first goes before the second.
    fn exclusive(&self) -> Option<Vec<Splice>> {
        self.receptivity(1, format!("{} and {}", self.operand(1), self.not(0)))
    }

    /// Each way alone, and a third one where both are meant.
    fn parallel(&self) -> Option<Vec<Splice>> {
        let [a, b] = self.both;
        let names = |list: &[Name]| list.iter().map(|n| n.text.clone()).collect::<Vec<_>>();
        let apart = !names(&a.to).iter().any(|n| names(&b.to).contains(n));
        if a.from != b.from || a.chained || b.chained || a.to.is_empty() || b.to.is_empty() || !apart {
            return None;
        }
        let alone = [
            self.receptivity(0, format!("{} and {}", self.operand(0), self.not(1)))?,
            self.receptivity(1, format!("{} and {}", self.operand(1), self.not(0)))?,
        ];
        let from = self.file.source.range(b.at.0);
        let text = self.file.text();
        let start = text.get(..from.start)?.rfind('\n').map_or(0, |at| at + 1);
        let indent: String = text.get(start..)?.chars().take_while(|c| matches!(c, ' ' | '\t')).collect();
        let to: Vec<&Name> = a.to.iter().chain(&b.to).collect();
        let steps = |list: &[&Name]| {
            let texts: Option<Vec<&str>> =
                list.iter().map(|n| text.get(self.file.source.range(n.at.0))).collect();
            Some(match texts?.as_slice() {
                [one] => (*one).to_owned(),
                more => format!("({})", more.join(", ")),
            })
        };
        let from_steps = steps(&a.from.iter().collect::<Vec<_>>())?;
        let (both, end) = (format!("{} and {}", self.operand(0), self.operand(1)), line_end(text, from.end));
        let line = format!("\n{indent}{from_steps} -> {} when {both}", steps(&to)?);
        joined(alone.into_iter().flatten().chain([Splice::new(end, end, line)]))
    }

    /// The first has priority 1, the second 2.
    fn priority(&self) -> Option<Vec<Splice>> {
        let one = |n| self.gesture(&Gesture::Priority { id: self.id(n), n: Some(n as u32 + 1) });
        joined(one(0)?.into_iter().chain(one(1)?))
    }
}

fn in_brackets(text: &str) -> String {
    format!("({text})")
}

/// Splices of one text in order; `None` if they overlap.
fn joined(list: impl Iterator<Item = Splice>) -> Option<Vec<Splice>> {
    let mut list: Vec<Splice> = list.collect();
    list.sort_by_key(|s| (s.start, s.end));
    let apart = list.windows(2).all(|w| matches!(w, [a, b] if a.end <= b.start));
    apart.then_some(list)
}
