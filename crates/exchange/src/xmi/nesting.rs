//! Finds the charts that each step encloses, and the expansion of each macro-step.

use std::collections::HashMap;

use g7_model::{Problem, codes, say};

use super::naming::Names;
use super::read::{Plan, StepSort, Thing};
use g7_iec::report::{Report, shown};
use g7_iec::xml::attr;

/// The charts nested in each step.
pub(super) struct Nesting {
    /// The charts that a step encloses.
    pub(super) enclosed: HashMap<(usize, usize), Vec<usize>>,
    /// The expansion of a macro-step.
    pub(super) expansions: HashMap<(usize, usize), usize>,
    /// The chart around each chart.
    outer: HashMap<usize, usize>,
}

/// Reads the nesting. A chart within itself is reported and not nested.
pub(super) fn read(plan: &Plan, names: &Names, report: &mut Report) -> Nesting {
    let mut nesting = Nesting { enclosed: HashMap::new(), expansions: HashMap::new(), outer: HashMap::new() };
    for (sheet, number) in steps(plan) {
        let Some(step) = plan.step(sheet, number) else { continue };
        match step.sort {
            StepSort::Macro => nesting.expansion(plan, names, (sheet, number), report),
            StepSort::Plain | StepSort::Enclosing => nesting.enclosed(plan, names, (sheet, number), report),
            StepSort::Entry | StepSort::Exit => {}
        }
    }
    for (chart, sheet) in plan.sheets.iter().enumerate() {
        let Some((thing, at)) = plan.thing(sheet.xml, "enclosingStep", report) else { continue };
        let step = match thing {
            Thing::Step(sheet, step) if can_enclose(plan, (sheet, step)) => (sheet, step),
            _ => {
                report.say(&codes::UNKNOWN_OBJECT, &at, say!("the enclosing step of this chart is no step"));
                continue;
            }
        };
        if nesting.enclosed.get(&step).is_some_and(|list| list.contains(&chart)) {
            continue;
        }
        let what = say!(
            "the chart names its enclosing step, which does not name the chart `{}`",
            shown(names.chart(chart))
        );
        report.say(&codes::DIFFERENT, &at, what);
        nesting.nest(names, step, chart, &at, report);
    }
    nesting
}

fn steps(plan: &Plan) -> Vec<(usize, usize)> {
    let numbers =
        |(i, s): (usize, &super::read::Sheet)| (0..s.steps.len()).map(|n| (i, n)).collect::<Vec<_>>();
    plan.sheets.iter().enumerate().flat_map(numbers).collect()
}

fn can_enclose(plan: &Plan, (sheet, step): (usize, usize)) -> bool {
    plan.step(sheet, step).is_some_and(|s| matches!(s.sort, StepSort::Plain | StepSort::Enclosing))
}

impl Nesting {
    fn enclosed(&mut self, plan: &Plan, names: &Names, step: (usize, usize), report: &mut Report) {
        let Some(node) = plan.step(step.0, step.1) else { return };
        for (thing, at) in plan.things(node.xml, "partialGrafcets", report) {
            match thing {
                Thing::Sheet(chart) => self.nest(names, step, chart, &at, report),
                _ => report.say(
                    &codes::UNKNOWN_OBJECT,
                    &at,
                    say!("what an enclosing step encloses is no chart"),
                ),
            }
        }
    }

    fn expansion(&mut self, plan: &Plan, names: &Names, step: (usize, usize), report: &mut Report) {
        let Some(node) = plan.step(step.0, step.1) else { return };
        let at = attr::head(node.xml);
        match plan.thing(node.xml, "expansion", report) {
            Some((Thing::Sheet(chart), _)) if plan.sheets.get(chart).is_some_and(|s| s.expansion) => {
                if self.circle(step.0, chart) {
                    self.say_circle(names, step.0, chart, &at, report);
                } else {
                    self.outer.entry(chart).or_insert(step.0);
                    self.expansions.insert(step, chart);
                }
            }
            found => {
                let name = shown(names.step(step.0, step.1));
                let what = match found {
                    Some(_) => {
                        say!("what the macro-step `{name}` names is no expansion; it is read as a step")
                    }
                    None => say!("the macro-step `{name}` has no expansion; it is read as a step"),
                };
                report.say(&codes::BAD_MACRO, &at, what);
            }
        }
    }

    fn nest(
        &mut self,
        names: &Names,
        step: (usize, usize),
        chart: usize,
        at: &std::ops::Range<usize>,
        report: &mut Report,
    ) {
        if self.circle(step.0, chart) {
            return self.say_circle(names, step.0, chart, at, report);
        }
        self.outer.entry(chart).or_insert(step.0);
        self.enclosed.entry(step).or_default().push(chart);
    }

    /// True if a chart would be nested within itself.
    fn circle(&self, outer: usize, inner: usize) -> bool {
        let mut here = Some(outer);
        // No chart contains itself, so the path outward is no longer than the list.
        for _ in 0..self.outer.len() + 2 {
            match here {
                Some(chart) if chart == inner => return true,
                Some(chart) => here = self.outer.get(&chart).copied(),
                None => return false,
            }
        }
        true
    }

    fn say_circle(
        &self,
        names: &Names,
        outer: usize,
        inner: usize,
        at: &std::ops::Range<usize>,
        report: &mut Report,
    ) {
        let (outer, inner) = (shown(names.chart(outer)), shown(names.chart(inner)));
        let what = match outer == inner {
            true => say!("the chart `{inner}` is nested in a step of its own; it is not nested"),
            false => say!(
                "the chart `{inner}` would stand inside itself: `{outer}` is within it; it is not nested"
            ),
        };
        report.put(Problem::new(&codes::NESTED_IN_ITSELF, report.span(at), what));
    }
}
