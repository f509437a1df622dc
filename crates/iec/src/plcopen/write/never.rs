//! Steps that can never be active, and conversions with another value, where Beremiz or OpenPLC make text for matiec.
//!
//! `control.rs` begins with both. The generators write what they find behind the initial steps. A step that no chain
//! of transitions reaches is missing in their text, though a transition names it. So it is left out here, with the
//! transitions behind it, which never clear.

use std::collections::HashSet;

use g7_model::visit_mut::{self, Visitor};
use g7_model::{
    Body, Chart, ChartItem, Composed, Document, Expr, ExprKind, Item, Moment, Nanos, Problem, Said,
    Transition, Type, codes, say,
};

use crate::nodes;

/// Leaves out the steps that no transition can reach, and the transitions behind them.
pub(super) fn never(chart: &mut Chart, problems: &mut Vec<Problem>) {
    let mut reached: HashSet<String> =
        chart.steps().filter(|s| s.initial).map(|s| s.name.text.to_string()).collect();
    loop {
        let known = reached.len();
        for transition in chart.transitions() {
            if clears(transition, &reached) {
                reached.extend(transition.to.iter().map(|n| n.text.to_string()));
            }
        }
        if reached.len() == known {
            break;
        }
    }
    let mut gone = Gone(HashSet::new());
    for step in chart.steps().filter(|s| !reached.contains(&*s.name.text)) {
        gone.0.insert(step.name.text.to_ascii_uppercase());
        let what = say!("step `{}`, which no transition can reach, and what is behind it", step.name.text);
        problems.push(Problem::new(&codes::LEFT_OUT, step.name.at.0, what));
    }
    if gone.0.is_empty() {
        return;
    }
    chart.items.retain(|item| match item {
        ChartItem::Step(step) => reached.contains(&*step.name.text),
        ChartItem::Transition(transition) => clears(transition, &reached),
        _ => true,
    });
    let mut alone = Document { items: vec![Item::Chart(chart.clone())], notes: Vec::new() };
    visit_mut::document(&mut alone, &mut gone);
    if let Some(Item::Chart(without)) = alone.items.pop() {
        *chart = without;
    }
}

fn clears(transition: &Transition, reached: &HashSet<String>) -> bool {
    transition.from.iter().all(|n| reached.contains(&*n.text))
}

/// Puts FALSE and no time in the place of `Fill.X` and `Fill.T` of steps that are left out.
struct Gone(HashSet<String>);

impl Visitor for Gone {
    fn expr(&mut self, e: &mut Expr) {
        let ExprKind::Path(path) = &e.kind else { return };
        let [step, member] = path.names.as_slice() else { return };
        if !self.0.contains(&step.text.to_ascii_uppercase()) {
            return;
        }
        match &*member.text.to_ascii_uppercase() {
            "X" => *e = nodes::boolean(false, e.at.0),
            "T" => *e = nodes::time(Nanos::ZERO, e.at.0),
            _ => {}
        }
    }
}

/// Tells of conversions that give another value in matiec: those between times and numbers count seconds there and
/// milliseconds here, and the texts of REAL, times, dates and bit strings have another form.
pub(super) fn conversions(document: &mut Document, problems: &mut Vec<Problem>) {
    struct Conversions<'p>(&'p mut Vec<Problem>);
    impl Visitor for Conversions<'_> {
        fn expr(&mut self, e: &mut Expr) {
            let ExprKind::Call(path, _) = &e.kind else { return };
            let name = path.text().to_ascii_uppercase();
            let Some((from, to)) = name.split_once("_TO_") else { return };
            let (Some(from), Some(to)) = (Type::named(from), Type::named(to)) else { return };
            let what = match (from, to) {
                (Type::String(_), other) | (other, Type::String(_)) => {
                    if other.is_integer() || other == Type::Bool {
                        return;
                    }
                    say!("the texts of {} have another form there", Said::foreign(name.as_str()))
                }
                (Type::Moment(Moment::Dt), _) => return,
                (Type::Time | Type::Moment(Moment::Tod), _) | (_, Type::Time | Type::Moment(Moment::Tod)) => {
                    say!("{} counts in seconds there, and in milliseconds here", Said::foreign(name.as_str()))
                }
                _ => return,
            };
            self.0.push(Problem::new(&codes::DIFFERENT, e.at.0, what));
        }
    }
    let mut conversions = Conversions(problems);
    visit_mut::document(document, &mut conversions);
    for item in &mut document.items {
        if let Item::Composed(Composed { body: Some(Body::St(block)), .. }) = item {
            visit_mut::stmts(&mut block.statements, &mut conversions);
        }
    }
}
