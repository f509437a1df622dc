//! Inputs that the file's own code writes become variables.

use std::collections::HashSet;

use g7_model::codes;
use g7_model::{
    ActionKind, Chart, ChartItem, Composed, Document, Expr, ExprKind, Item, Name, Problem, Stmt, StmtKind,
    Target, VarDecl, VarKind, say,
};

use crate::report::Report;

/// Turns inputs that are written into variables.
pub(super) fn settle(document: &mut Document, report: &mut Report) {
    let mut written = HashSet::new();
    for item in &document.items {
        match item {
            Item::Pre(body, _) | Item::Post(body, _) => targets(&body.block().statements, None, &mut written),
            Item::Chart(chart) => of_chart(chart, &mut written),
            Item::Composed(block) => of_block(block, &mut written),
            _ => {}
        }
    }
    for item in &mut document.items {
        match item {
            Item::Var(decl) => change(decl, None, &written, report),
            Item::Chart(chart) => {
                let name = chart.name.text.to_string();
                for item in &mut chart.items {
                    if let ChartItem::Var(decl) = item {
                        change(decl, Some(&name), &written, report);
                    }
                }
            }
            _ => {}
        }
    }
}

/// Names that are written, with the chart that contains the code.
type Written = HashSet<(Option<String>, String)>;

fn change(decl: &mut VarDecl, chart: Option<&str>, written: &Written, report: &mut Report) {
    if decl.kind != VarKind::Input {
        return;
    }
    let hit = |name: &Name, near: Option<&str>| {
        written.contains(&(near.map(str::to_string), name.text.to_string()))
    };
    // A name without a chart may be written in any chart.
    let any = |name: &Name| written.iter().any(|(near, n)| near.is_some() && *n == *name.text);
    let found = decl.names.iter().any(|n| hit(n, chart) || chart.is_none() && any(n));
    if found {
        decl.kind = VarKind::Var;
        // The address is that of an input.
        decl.address = None;
        let what =
            say!("an input that the program writes as well; it is a variable here, without an address");
        report.put(Problem::new(&codes::DIFFERENT, decl.at.0, what));
    }
}

/// The variables of the file that a function block writes.
fn of_block(block: &Composed, written: &mut Written) {
    let Some(body) = &block.body else { return };
    let mut here = Written::new();
    targets(&body.block().statements, None, &mut here);
    let members = block.members.iter().chain(&block.inouts).flat_map(|v| &v.names);
    let own: HashSet<&str> =
        members.chain(body.block().locals.iter().flat_map(|l| &l.names)).map(|n| &*n.text).collect();
    written.extend(here.into_iter().filter(|(near, name)| near.is_none() && !own.contains(name.as_str())));
}

fn of_chart(chart: &Chart, written: &mut Written) {
    let near = Some(&*chart.name.text);
    for item in &chart.items {
        match item {
            ChartItem::Pre(body, _) | ChartItem::Post(body, _) => {
                targets(&body.block().statements, near, written);
            }
            ChartItem::Action(action) => targets(&action.body.block().statements, near, written),
            ChartItem::Section(section) => targets(&section.body.statements, near, written),
            ChartItem::Step(step) => {
                for action in &step.actions {
                    match &action.kind {
                        ActionKind::Qualified { target: Target::Path(path), .. } => {
                            name(&path.names, near, written);
                        }
                        ActionKind::Qualified { target: Target::Element(e), .. } => target(e, near, written),
                        ActionKind::Qualified { target: Target::Work(work), .. }
                        | ActionKind::OnEvent { work, .. }
                        | ActionKind::EachScan { work, .. } => targets(work.statements(), near, written),
                        ActionKind::Qualified { .. } | ActionKind::Order(_) | ActionKind::Comment(_) => {}
                    }
                }
            }
            ChartItem::Var(_) | ChartItem::Transition(_) => {}
        }
    }
}

fn name(names: &[Name], near: Option<&str>, written: &mut Written) {
    match names {
        [one] => written.insert((near.map(str::to_string), one.text.to_string())),
        [chart, one] => written.insert((Some(chart.text.to_string()), one.text.to_string())),
        _ => false,
    };
}

fn target(expr: &Expr, near: Option<&str>, written: &mut Written) {
    match &expr.kind {
        ExprKind::Path(path) => name(&path.names, near, written),
        ExprKind::Element(path, ..) => name(&path.names, near, written),
        _ => {}
    }
}

fn targets(statements: &[Stmt], near: Option<&str>, written: &mut Written) {
    for statement in statements {
        match &statement.kind {
            StmtKind::Assign { target: t, .. } => target(t, near, written),
            StmtKind::Call(_, args) => {
                for arg in args.iter().filter(|a| a.output) {
                    target(&arg.value, near, written);
                }
            }
            StmtKind::If(branches, otherwise) => {
                for (_, body) in branches {
                    targets(body, near, written);
                }
                targets(otherwise, near, written);
            }
            StmtKind::Case(_, arms, otherwise) => {
                for arm in arms {
                    targets(&arm.body, near, written);
                }
                targets(otherwise, near, written);
            }
            StmtKind::For { var, body, .. } => {
                name(std::slice::from_ref(var), near, written);
                targets(body, near, written);
            }
            StmtKind::While(_, body) | StmtKind::Repeat(body, _) => targets(body, near, written),
            StmtKind::Exit | StmtKind::Return => {}
        }
    }
}
