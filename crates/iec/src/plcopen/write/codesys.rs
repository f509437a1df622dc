//! The things that CODESYS does by names and attributes of its own, as `build` and `actions` read them.
//!
//! ```text
//! Document -> charts held by flags -> standard -> Document -> steps with their bodies -> project (PLCopen XML)
//! ```
//!
//! A program with a chart may declare `SFCReset`, `SFCInit` and `SFCPause`. CODESYS puts the chart into its
//! initial steps while one of the first two is TRUE, and holds it while one of the last two is. The reader makes
//! `INITCHART` and guards of them. Here a chart of exactly this form loses what CODESYS does by itself; any other
//! use of these names is refused, because it would run otherwise there.

use std::collections::HashSet;

use crate::nodes::conjuncts;
use g7_model::visit_mut::{self, Use, Visitor};
use g7_model::{
    Action, ActionKind, Body, Chart, ChartItem, ChartKind, Document, Expr, ExprKind, Item, Path, Problem,
    Qualifier, Said, Span, Step, StepKind, Stmt, StmtKind, Target, Type, UnaryOp, VarDecl, codes, say,
};

/// The variables by which a program controls its chart: the name, and whether it resets and holds the chart.
const FLAGS: [(&str, bool, bool); 3] =
    [("SFCReset", true, false), ("SFCInit", true, true), ("SFCPause", false, true)];

/// Takes out what CODESYS does by flags.
pub(super) fn by_flags(document: &mut Document, problems: &mut Vec<Problem>) {
    let mut lost = |at: Span, what: Said| problems.push(Problem::new(&codes::NOT_CARRIED, at, what));
    for item in &mut document.items {
        match item {
            Item::Var(decl) => {
                if let Some(name) = decl.names.iter().find(|n| flag(&n.text).is_some()) {
                    let what = say!(
                        "CODESYS controls charts by variables called `{name}`; declare it in the chart that it controls, or call it otherwise",
                        name = name.text
                    );
                    lost(name.at.0, what);
                }
            }
            // In a unit without a chart the names mean nothing.
            Item::Chart(chart) if chart.steps().next().is_some() => of_chart(chart, &mut lost),
            _ => {}
        }
    }
}

/// The flag of this name: whether it resets and whether it holds the chart.
fn flag(name: &str) -> Option<(bool, bool)> {
    FLAGS.iter().find(|f| f.0.eq_ignore_ascii_case(name)).map(|f| (f.1, f.2))
}

fn of_chart(chart: &mut Chart, lost: &mut impl FnMut(Span, Said)) {
    let bools = chart.vars().filter(|v| v.ty == Type::Bool).flat_map(|v| v.names.clone());
    let flags: Vec<_> = bools.filter_map(|n| flag(&n.text).map(|f| (n, f))).collect();
    let mut held: Vec<String> = Vec::new();
    for (name, (resets, holds)) in flags {
        if chart.kind != ChartKind::Chart || resets && !take_reset(chart, &name.text) {
            let what = say!(
                "CODESYS puts a chart into its initial steps while its variable `{name}` is TRUE, and `pre {{ IF {name} THEN INITCHART({chart}) END_IF }}` is missing here; add it, or call the variable otherwise",
                name = name.text,
                chart = chart.name.text
            );
            lost(name.at.0, what);
        } else if holds {
            held.push(name.text.to_string());
        }
    }
    for name in &held {
        let guard = Guard { chart: &chart.name.text, name };
        if let Some(at) = guard.missing(chart) {
            let what = say!(
                "CODESYS holds the chart `{}` while its variable `{name}` is TRUE, which this does not wait for: it needs `not {name}`",
                chart.name.text
            );
            lost(at, what);
        }
    }
    let title = chart.name.text.clone();
    let guards = || held.iter().map(|name| Guard { chart: &title, name });
    // While a flag holds a chart, CODESYS also holds its actions on variables. So a condition of an action that
    // consists of guards alone is left out: CODESYS does the same without it.
    for item in &mut chart.items {
        let ChartItem::Step(step) = item else { continue };
        for action in &mut step.actions {
            if let ActionKind::Qualified { condition, .. } = &mut action.kind {
                condition.take_if(|c| conjuncts(c).into_iter().all(|part| guards().any(|g| g.is(part))));
            }
        }
    }
}

/// Removes the statement `IF flag THEN INITCHART(chart) END_IF` from the PRE section of the chart. Returns false
/// if there is no such statement.
fn take_reset(chart: &mut Chart, flag: &str) -> bool {
    let title = chart.name.text.clone();
    let mut found = false;
    for item in &mut chart.items {
        if let ChartItem::Pre(Body::St(block), _) = item {
            let count = block.statements.len();
            block.statements.retain(|s| !is_reset(s, &title, flag));
            found |= block.statements.len() < count;
        }
    }
    chart.items.retain(|i| !matches!(i, ChartItem::Pre(Body::St(b), _) if b.statements.is_empty()));
    found
}

fn is_reset(stmt: &Stmt, chart: &str, flag: &str) -> bool {
    let StmtKind::If(arms, otherwise) = &stmt.kind else { return false };
    let ([(condition, body)], []) = (arms.as_slice(), otherwise.as_slice()) else { return false };
    let [Stmt { kind: StmtKind::Call(path, args), .. }] = body.as_slice() else { return false };
    let [arg] = args.as_slice() else { return false };
    is_variable(condition, chart, flag)
        && path.text().eq_ignore_ascii_case("INITCHART")
        && matches!(&arg.value.kind, ExprKind::Path(p) if p.text() == chart)
}

/// True if an expression is a variable of a chart.
fn is_variable(e: &Expr, chart: &str, name: &str) -> bool {
    let ExprKind::Path(path) = &e.kind else { return false };
    match path.names.as_slice() {
        [one] => *one.text == *name,
        [home, one] => *home.text == *chart && *one.text == *name,
        _ => false,
    }
}

/// `not flag`, which all that a chart does waits for.
struct Guard<'g> {
    chart: &'g str,
    name: &'g str,
}

impl Guard<'_> {
    fn is(&self, e: &Expr) -> bool {
        matches!(&e.kind, ExprKind::Unary(UnaryOp::Not, inner) if is_variable(inner, self.chart, self.name))
    }

    fn in_condition(&self, e: &Expr) -> bool {
        conjuncts(e).into_iter().any(|part| self.is(part))
    }

    /// True if statements are one that waits for the guard.
    fn in_body(&self, list: &[Stmt]) -> bool {
        match list {
            [] => true,
            [Stmt { kind: StmtKind::If(arms, otherwise), .. }] => {
                otherwise.is_empty()
                    && matches!(arms.as_slice(), [(condition, _)] if self.in_condition(condition))
            }
            _ => false,
        }
    }

    /// The first place that does not wait for the guard.
    fn missing(&self, chart: &Chart) -> Option<Span> {
        chart.items.iter().find_map(|item| match item {
            ChartItem::Transition(t) => {
                let free = t.on_clearing.is_some() || !self.in_condition(&t.receptivity);
                free.then_some(t.at.0)
            }
            ChartItem::Action(a) => (!self.in_body(&a.body.block().statements)).then_some(a.name.at.0),
            ChartItem::Step(step) => self.missing_in(step),
            _ => None,
        })
    }

    fn missing_in(&self, step: &Step) -> Option<Span> {
        if matches!(step.kind, StepKind::Macro(_) | StepKind::Enclosing) {
            return Some(step.name.at.0);
        }
        let waits = |action: &Action| match &action.kind {
            ActionKind::Qualified { target: Target::Work(work), .. }
            | ActionKind::EachScan { work, condition: None } => self.in_body(work.statements()),
            ActionKind::Qualified { condition: Some(c), .. } => self.in_condition(c),
            // The body of a named action is looked at where it stands.
            ActionKind::Qualified { target: Target::Path(_), .. } | ActionKind::Comment(_) => true,
            _ => false,
        };
        step.actions.iter().find(|a| !waits(a)).map(|a| a.at.0)
    }
}

/// True if all actions of steps are bodies of the unit, one of a kind for each step: so CODESYS has them beside
/// its steps, without qualifiers.
pub(super) fn steps_alone(document: &Document) -> bool {
    let charts = || document.charts();
    let fits = |chart: &Chart, step: &Step| {
        let mut seen = HashSet::new();
        step.actions.iter().all(|a| {
            let ActionKind::Qualified { qualifier, time: None, target: Target::Path(path), condition: None } =
                &a.kind
            else {
                return matches!(a.kind, ActionKind::Comment(_));
            };
            let named = |i: &ChartItem| matches!(i, ChartItem::Action(n) if *n.name.text == *path.text());
            attribute(*qualifier).is_some() && seen.insert(*qualifier) && chart.items.iter().any(named)
        })
    };
    let whole = charts().all(|c| c.kind == ChartKind::Chart && c.steps().all(|s| fits(c, s)));
    whole && charts().flat_map(Chart::steps).next().is_some()
}

/// The attribute of a step that holds its action with this qualifier.
pub(super) fn attribute(qualifier: Qualifier) -> Option<&'static str> {
    use crate::plcopen::actions::{ENTRY_ACTION, EXIT_ACTION, STEP_ACTION};
    match qualifier {
        Qualifier::N => Some(STEP_ACTION),
        Qualifier::P1 => Some(ENTRY_ACTION),
        Qualifier::P0 => Some(EXIT_ACTION),
        _ => None,
    }
}

/// The variables of each program that others write, by the program and their names. CODESYS lets others write
/// nothing but the inputs of a program.
pub(super) fn from_outside(document: &Document) -> HashSet<(String, String)> {
    struct Outside(HashSet<(String, String)>);
    impl Visitor for Outside {
        fn path(&mut self, path: &mut Path, how: Use, _: Span) {
            if let ([program, name], Use::Write) = (path.names.as_slice(), how) {
                self.0.insert((program.text.to_string(), name.text.to_string()));
            }
        }
    }
    let mut all = Outside(HashSet::new());
    // A reading visitor does not tell how names are used.
    visit_mut::document(&mut document.clone(), &mut all);
    all.0
}

/// True if a variable of a program is declared as an input of it, so that others may write it.
pub(super) fn is_given(decl: &VarDecl, program: &str, outside: &HashSet<(String, String)>) -> bool {
    let written = |n: &g7_model::Name| outside.contains(&(program.to_string(), n.text.to_string()));
    decl.kind == g7_model::VarKind::Var && !decl.retain && decl.names.iter().any(written)
}
