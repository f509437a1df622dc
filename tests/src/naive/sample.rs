//! Edges and timers: one memory for each place in the text where one is written, updated at the
//! start of each pass (decisions 2 and 12).

use g7_model::{Action, ActionKind, Block, Body, Expr, ExprKind, Stmt, StmtKind, Target, UnaryOp, Work};

use super::exec::{Exec, key};
use super::model::{Model, ScopeId};
use super::state::{Edge, State};
use super::value::Run;

/// Updates all memories of the charts in `due`.
pub(super) fn sample(m: &Model, s: &mut State, due: &[bool]) -> Run<()> {
    let mut found = Vec::new();
    for (scope, due) in due.iter().enumerate() {
        if *due {
            occurrences(m, scope, &mut |e| found.push((scope, e)));
        }
    }
    for (scope, e) in found {
        match &e.kind {
            ExprKind::Unary(_, inner) => {
                let here = Exec::new(m, s).truth(scope, inner)?;
                let before = s.edges.get(&key(e)).map_or(here, |m| m.here);
                s.edges.insert(key(e), Edge { before, here });
            }
            ExprKind::Timer { t1, e: watched, t2 } => {
                sample_timer(m, s, scope, e, [t1, watched], t2.as_deref())?
            }
            _ => {}
        }
    }
    Ok(())
}

fn sample_timer(
    m: &Model,
    s: &mut State,
    scope: ScopeId,
    whole: &Expr,
    [t1, watched]: [&Expr; 2],
    t2: Option<&Expr>,
) -> Run<()> {
    let mut exec = Exec::new(m, s);
    if exec.watched_step(scope, watched, t2.is_some()).is_some() {
        return Ok(());
    }
    let input = exec.truth(scope, watched)?;
    let t1 = exec.eval(scope, t1)?.duration()?;
    let t2 = match t2 {
        Some(e) => exec.eval(scope, e)?.duration()?,
        None => 0,
    };
    let mut timer = s.timers.get(&key(whole)).copied().unwrap_or_default();
    if timer.input != input {
        timer.input = input;
        timer.since = s.now;
    }
    let run = s.now - timer.since;
    if input && run >= t1 {
        timer.q = true;
    }
    if !input && run >= t2 {
        timer.q = false;
    }
    s.timers.insert(key(whole), timer);
    Ok(())
}

type Visit<'v, 'm> = &'v mut dyn FnMut(&'m Expr);

/// Visits every edge and timer in a scope, inner ones before those around them.
fn occurrences<'m>(m: &'m Model, scope: ScopeId, visit: Visit<'_, 'm>) {
    let s = &m.scopes[scope];
    for &t in &s.transitions {
        expr(&m.transitions[t].receptivity, visit);
        if let Some(b) = &m.transitions[t].on_clearing {
            block(b, visit);
        }
    }
    for &step in &s.steps {
        m.steps[step].actions.iter().for_each(|a| action(a, visit));
    }
    m.bodies.iter().filter(|b| b.0 == scope).for_each(|(.., b)| block(b, visit));
    s.sections.values().for_each(|section| block(&section.body, visit));
    for a in s.actions.values() {
        if let Body::St(b) = &a.body {
            block(b, visit);
        }
    }
}

fn action<'m>(a: &'m Action, visit: Visit<'_, 'm>) {
    match &a.kind {
        ActionKind::Qualified { time, target, condition, .. } => {
            time.iter().for_each(|e| expr(e, visit));
            condition.iter().for_each(|e| expr(e, visit));
            if let Target::Work(w) = target {
                work(w, visit);
            }
        }
        ActionKind::OnEvent { event, work: w } => {
            expr(event, visit);
            work(w, visit);
        }
        ActionKind::EachScan { work: w, condition } => {
            condition.iter().for_each(|e| expr(e, visit));
            work(w, visit);
        }
        ActionKind::Order(_) | ActionKind::Comment(_) => {}
    }
}

fn work<'m>(w: &'m Work, visit: Visit<'_, 'm>) {
    w.statements().iter().for_each(|s| statement(s, visit));
}

fn block<'m>(b: &'m Block, visit: Visit<'_, 'm>) {
    b.statements.iter().for_each(|s| statement(s, visit));
}

fn statement<'m>(s: &'m Stmt, visit: Visit<'_, 'm>) {
    match &s.kind {
        StmtKind::Assign { value, .. } => expr(value, visit),
        StmtKind::Call(_, args) => args.iter().for_each(|a| expr(&a.value, visit)),
        StmtKind::If(branches, otherwise) => {
            for (condition, body) in branches {
                expr(condition, visit);
                body.iter().for_each(|s| statement(s, visit));
            }
            otherwise.iter().for_each(|s| statement(s, visit));
        }
        StmtKind::Case(selector, arms, otherwise) => {
            expr(selector, visit);
            for arm in arms {
                arm.body.iter().for_each(|s| statement(s, visit));
            }
            otherwise.iter().for_each(|s| statement(s, visit));
        }
        StmtKind::For { from, to, by, body, .. } => {
            [from, to].into_iter().chain(by).for_each(|e| expr(e, visit));
            body.iter().for_each(|s| statement(s, visit));
        }
        StmtKind::While(condition, body) => {
            expr(condition, visit);
            body.iter().for_each(|s| statement(s, visit));
        }
        StmtKind::Repeat(body, until) => {
            body.iter().for_each(|s| statement(s, visit));
            expr(until, visit);
        }
        StmtKind::Exit | StmtKind::Return => {}
    }
}

fn expr<'m>(e: &'m Expr, visit: Visit<'_, 'm>) {
    match &e.kind {
        ExprKind::Literal(_) | ExprKind::Path(_) | ExprKind::Direct(_) | ExprKind::Bad => {}
        ExprKind::Unary(op, inner) => {
            expr(inner, visit);
            if matches!(op, UnaryOp::Rise | UnaryOp::Fall) {
                visit(e);
            }
        }
        ExprKind::Binary(_, a, b) => {
            expr(a, visit);
            expr(b, visit);
        }
        ExprKind::Timer { t1, e: watched, t2 } => {
            expr(t1, visit);
            expr(watched, visit);
            t2.iter().for_each(|t| expr(t, visit));
            visit(e);
        }
        ExprKind::Call(_, args) => args.iter().for_each(|a| expr(&a.value, visit)),
        ExprKind::Element(_, index, _) => index.iter().for_each(|e| expr(e, visit)),
        ExprKind::List(values) => values.iter().for_each(|(_, e)| expr(e, visit)),
    }
}
