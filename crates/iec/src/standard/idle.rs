//! Removes arms of IF and CASE that have no statement. Compilers such as matiec refuse `IF a THEN END_IF`, with a
//! single `;` in it as well.
//!
//! `standard` ends with it, and so do writers that put bodies into guards of their own.

use g7_model::{
    BinaryOp, Body, CaseArm, ChartItem, Composed, Document, Expr, Item, Span, Stmt, StmtKind, Target, Work,
};

use crate::nodes;

/// Removes empty arms everywhere, and a `pre` or `post` that has no statement left.
pub(crate) fn without_idle(document: &mut Document) {
    document.items.retain_mut(|item| match item {
        Item::Pre(Body::St(block), _) | Item::Post(Body::St(block), _) => {
            shorter(&mut block.statements);
            !block.statements.is_empty()
        }
        Item::Composed(Composed { body: Some(Body::St(block)), .. }) => {
            shorter(&mut block.statements);
            true
        }
        Item::Function(function) => {
            shorter(&mut function.body.statements);
            true
        }
        Item::Chart(chart) => {
            chart.items.iter_mut().for_each(of_chart);
            true
        }
        _ => true,
    });
}

fn of_chart(item: &mut ChartItem) {
    match item {
        ChartItem::Action(action) => {
            if let Body::St(block) = &mut action.body {
                shorter(&mut block.statements);
            }
        }
        ChartItem::Section(section) => shorter(&mut section.body.statements),
        ChartItem::Step(step) => {
            for action in &mut step.actions {
                let at = action.at.0;
                if let g7_model::ActionKind::Qualified { target: Target::Work(work), .. } = &mut action.kind {
                    let mut list = work.statements().to_vec();
                    shorter(&mut list);
                    *work = match work {
                        Work::Block(_) => Work::Block(nodes::block(list, at)),
                        Work::Single(_) => nodes::work(list, at),
                    };
                }
            }
        }
        _ => {}
    }
}

/// Removes empty arms from a list of statements.
fn shorter(list: &mut Vec<Stmt>) {
    *list = std::mem::take(list).into_iter().filter_map(kept).collect();
}

/// The statement without empty arms; `None` if nothing is left of it.
fn kept(mut stmt: Stmt) -> Option<Stmt> {
    let at = stmt.at.0;
    match stmt.kind {
        StmtKind::If(mut arms, mut otherwise) => {
            arms.iter_mut().for_each(|a| shorter(&mut a.1));
            shorter(&mut otherwise);
            return chosen(arms, otherwise, at);
        }
        StmtKind::Case(selector, mut arms, mut otherwise) => {
            arms.iter_mut().for_each(|a| shorter(&mut a.body));
            shorter(&mut otherwise);
            return of_case(selector, arms, otherwise, at);
        }
        StmtKind::For { ref mut body, .. }
        | StmtKind::While(_, ref mut body)
        | StmtKind::Repeat(ref mut body, _) => shorter(body),
        StmtKind::Assign { .. } | StmtKind::Call(..) | StmtKind::Exit | StmtKind::Return => {}
    }
    Some(stmt)
}

/// An IF without its empty arms. The arms after an empty one may run only if its condition is false: `NOT` of
/// that condition guards them.
fn chosen(mut arms: Vec<(Expr, Vec<Stmt>)>, otherwise: Vec<Stmt>, at: Span) -> Option<Stmt> {
    let Some(idle) = arms.iter().position(|a| a.1.is_empty()) else {
        return Some(Stmt { kind: StmtKind::If(arms, otherwise), at: at.into() });
    };
    let mut rest = arms.split_off(idle);
    let (condition, _) = rest.remove(0);
    let behind = if rest.is_empty() { otherwise } else { chosen(rest, otherwise, at).into_iter().collect() };
    if !behind.is_empty() {
        arms.push((nodes::not(condition, at), behind));
    }
    (!arms.is_empty()).then(|| Stmt { kind: StmtKind::If(arms, Vec::new()), at: at.into() })
}

/// A CASE without its empty arms. If it has an ELSE, the values of the empty arms must not reach it: an IF in front
/// of the CASE keeps them out.
fn of_case(selector: Expr, mut arms: Vec<CaseArm>, otherwise: Vec<Stmt>, at: Span) -> Option<Stmt> {
    let mut idle = nodes::boolean(false, at);
    for (from, to) in arms.iter().filter(|a| a.body.is_empty()).flat_map(|a| &a.labels) {
        let against = |op, value: &Expr| nodes::binary(op, selector.clone(), value.clone(), at);
        let is = match to {
            Some(to) => nodes::and(against(BinaryOp::Ge, from), against(BinaryOp::Le, to), at),
            None => against(BinaryOp::Eq, from),
        };
        idle = nodes::or(idle, is, at);
    }
    arms.retain(|a| !a.body.is_empty());
    let guarded = !otherwise.is_empty() && nodes::truth(&idle).is_none();
    let inner = match (arms.is_empty(), otherwise.is_empty()) {
        (true, true) => return None,
        (true, false) => otherwise,
        _ => vec![Stmt { kind: StmtKind::Case(selector, arms, otherwise), at: at.into() }],
    };
    match inner.as_slice() {
        [only] if !guarded => Some(only.clone()),
        _ => {
            let open = if guarded { nodes::not(idle, at) } else { nodes::boolean(true, at) };
            Some(nodes::when(open, inner, Vec::new(), at))
        }
    }
}
