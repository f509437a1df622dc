//! Outputs that several steps drive with an action `N`.
//!
//! JGrafchart 2.6.1 sets the output FALSE when one of these steps ends, also while another one is
//! active. Here it stays TRUE as long as one of them is active, so two steps that may be active
//! together are told.

use std::collections::HashMap;
use std::ops::Range;

use g7_model::codes;
use g7_model::{
    Action, ActionKind, Chart, ChartItem, ChartKind, Document, Item, Order, Path, Qualifier, Step, StepKind,
    Target, say,
};

use g7_iec::report::{Report, shown};

/// The most pairs of steps that are looked at; of further ones none is taken to exclude another.
const MOST_PAIRS: usize = 1_000_000;

/// Reports each action `N` on a variable that an earlier one writes from a step that may be active
/// at the same time.
pub(super) fn tell(document: &Document, report: &mut Report) {
    let charts = Charts::of(document);
    let mut left = MOST_PAIRS;
    let mut writers: HashMap<Variable<'_>, Vec<Writer<'_>>> = HashMap::new();
    for (number, chart) in charts.list.iter().enumerate() {
        for (place, step) in chart.steps().enumerate() {
            for (path, action) in step.actions.iter().filter_map(level) {
                let Some(variable) = charts.variable(number, path) else { continue };
                let at = (number, place);
                let earlier = writers.entry(variable).or_default();
                let meets = |w: &&Writer| {
                    left = left.saturating_sub(1);
                    w.at != at && (left == 0 || charts.may_meet(w.at, at))
                };
                if let Some(other) = earlier.iter().find(meets) {
                    let what = say!(
                        "`{}` is also driven by `N` of step `{}`: JGrafchart 2.6.1 sets it FALSE when one of the \
                         steps ends, here it stays TRUE as long as one of them is active",
                        shown(&path.text()),
                        shown(&other.step.name.text)
                    );
                    let span = action.at.0;
                    let place: Range<usize> = span.start as usize..span.end as usize;
                    report.say(&codes::DIFFERENT, &place, what);
                }
                earlier.push(Writer { at, step });
            }
        }
    }
}

/// A variable: the chart that declares it, or none for one of the file, and its name.
type Variable<'d> = (Option<usize>, &'d str);

/// A step: its chart and its place there.
type At = (usize, usize);

struct Writer<'d> {
    at: At,
    step: &'d Step,
}

/// The variable of an action `N`.
fn level(action: &Action) -> Option<(&Path, &Action)> {
    match &action.kind {
        ActionKind::Qualified { qualifier: Qualifier::N, target: Target::Path(path), .. } => {
            Some((path, action))
        }
        _ => None,
    }
}

struct Charts<'d> {
    list: Vec<&'d Chart>,
    by_name: HashMap<&'d str, usize>,
    /// The step in which each chart lies, for expansions and enclosed charts.
    owners: HashMap<usize, At>,
    /// The charts of which at most one step is active at a time.
    single: Vec<bool>,
}

impl<'d> Charts<'d> {
    fn of(document: &'d Document) -> Charts<'d> {
        let charts = document.items.iter().filter_map(|item| match item {
            Item::Chart(c) => Some(c),
            _ => None,
        });
        let list: Vec<&Chart> = charts.collect();
        let by_name: HashMap<&str, usize> =
            list.iter().enumerate().map(|(i, c)| (&*c.name.text, i)).collect();
        let mut owners = HashMap::new();
        for (number, chart) in list.iter().enumerate() {
            for (place, step) in chart.steps().enumerate() {
                let expansion = if let StepKind::Macro(name) = &step.kind { Some(name) } else { None };
                let enclosed = step.actions.iter().filter_map(|a| match &a.kind {
                    ActionKind::Order(Order::Enclose(name)) => Some(name),
                    _ => None,
                });
                for inside in expansion.into_iter().chain(enclosed) {
                    owners.extend(by_name.get(&*inside.text).map(|c| (*c, (number, place))));
                }
            }
        }
        let single = list.iter().map(|c| has_one_token(c)).collect();
        Charts { list, by_name, owners, single }
    }

    /// The variable that a path in a chart names: `v`, or `Chart.v`.
    fn variable(&self, chart: usize, path: &'d Path) -> Option<Variable<'d>> {
        match path.names.as_slice() {
            [name] => {
                let own = self.list.get(chart).is_some_and(|c| declares(c, &name.text));
                Some((own.then_some(chart), &*name.text))
            }
            [of, name] => Some((Some(*self.by_name.get(&*of.text)?), &*name.text)),
            _ => None,
        }
    }

    /// A step, the step in which its chart lies, and so on.
    fn around(&self, step: At) -> Vec<At> {
        let mut list = vec![step];
        while let Some(outer) = list.last().and_then(|(chart, _)| self.owners.get(chart)) {
            if list.len() > self.list.len() {
                break;
            }
            list.push(*outer);
        }
        list
    }

    /// False if two steps are surely never active together: they, or steps around them, are two
    /// steps of a chart in which one step is active at a time, and nothing inside outlasts these.
    fn may_meet(&self, a: At, b: At) -> bool {
        let (a, b) = (self.around(a), self.around(b));
        let single = |at: &At| self.single.get(at.0).copied().unwrap_or(false);
        for (i, x) in a.iter().enumerate() {
            for (j, y) in b.iter().enumerate().filter(|(_, y)| y.0 == x.0) {
                let within = a.iter().take(i + 1).chain(b.iter().take(j + 1));
                if x.1 != y.1 && within.into_iter().all(single) {
                    return false;
                }
            }
        }
        true
    }
}

fn declares(chart: &Chart, name: &str) -> bool {
    chart.items.iter().any(|item| match item {
        ChartItem::Var(v) => v.names.iter().any(|n| &*n.text == name),
        _ => false,
    })
}

/// True if a chart begins with one step and no transition adds one: no parallel branches, no
/// sources. Two conditions of an OR divergence are taken to exclude each other.
fn has_one_token(chart: &Chart) -> bool {
    let begins = |s: &&Step| match chart.kind {
        ChartKind::Expansion => s.kind == StepKind::Entry,
        _ => s.initial || s.linked,
    };
    chart.steps().filter(begins).count() <= 1
        && chart.transitions().all(|t| t.from.len() == 1 && t.to.len() <= 1)
}
