//! The body of a function block without RETURN: in a call it stands among the statements of the caller, which go on.

use crate::{Expr, ExprKind, Problem, Span, Stmt, StmtKind, UnaryOp, codes, say};

/// The most statements that a body may have when the statements behind a RETURN are put aside.
const MOST: usize = 1 << 14;

/// The statements with the same effect, without RETURN.
pub(super) fn without(list: Vec<Stmt>) -> Result<Vec<Stmt>, Problem> {
    if !list.iter().any(returns) {
        return Ok(list);
    }
    let mut room = MOST;
    before(list, &mut room)
}

/// True if a RETURN stands somewhere in a statement.
fn returns(s: &Stmt) -> bool {
    at_return(s).is_some()
}

/// The place of the first RETURN in a statement.
fn at_return(s: &Stmt) -> Option<Span> {
    let within = |list: &[Stmt]| list.iter().find_map(at_return);
    match &s.kind {
        StmtKind::Return => Some(s.at.0),
        StmtKind::If(arms, otherwise) => {
            arms.iter().find_map(|(_, body)| within(body)).or_else(|| within(otherwise))
        }
        StmtKind::Case(_, arms, otherwise) => {
            arms.iter().find_map(|a| within(&a.body)).or_else(|| within(otherwise))
        }
        StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => within(body),
        StmtKind::Assign { .. } | StmtKind::Call(..) | StmtKind::Exit => None,
    }
}

/// The statements up to a RETURN; what follows an IF or CASE with one goes into the arms that do not return.
fn before(mut list: Vec<Stmt>, room: &mut usize) -> Result<Vec<Stmt>, Problem> {
    let Some(first) = list.iter().position(returns) else { return taken(list, room) };
    let rest = list.split_off(first + 1);
    let Some(Stmt { kind, at }) = list.pop() else { return Ok(list) };
    let mut arm = |body: Vec<Stmt>| before([body, rest.clone()].concat(), room);
    let kind = match kind {
        StmtKind::Return => return taken(list, room),
        StmtKind::If(arms, otherwise) => {
            let arms: Result<_, _> = arms.into_iter().map(|(c, body)| Ok((c, arm(body)?))).collect();
            unless(arms?, arm(otherwise)?)
        }
        StmtKind::Case(selector, mut arms, otherwise) => {
            for a in &mut arms {
                a.body = arm(std::mem::take(&mut a.body))?;
            }
            StmtKind::Case(selector, arms, arm(otherwise)?)
        }
        kind => {
            let at = at_return(&Stmt { kind, at }).unwrap_or(at.0);
            let what = say!("RETURN cannot stand in a loop of a function block");
            let problem = Problem::new(&codes::NOT_HERE, at, what);
            return Err(problem.help(say!("leave the loop by EXIT, and ask behind it whether to go on")));
        }
    };
    list.push(Stmt { kind, at });
    taken(list, room)
}

/// An IF; one whose only arm is empty asks for the contrary.
fn unless(mut arms: Vec<(Expr, Vec<Stmt>)>, otherwise: Vec<Stmt>) -> StmtKind {
    match arms.as_mut_slice() {
        [(condition, body)] if body.is_empty() && !otherwise.is_empty() => {
            let at = condition.at;
            let inner = std::mem::replace(condition, Expr { kind: ExprKind::Bad, at });
            let contrary = match inner.kind {
                ExprKind::Unary(UnaryOp::Not, whole) => *whole,
                kind => {
                    let kind = ExprKind::Unary(UnaryOp::Not, Box::new(Expr { kind, at }));
                    Expr { kind, at }
                }
            };
            StmtKind::If(vec![(contrary, otherwise)], Vec::new())
        }
        _ => StmtKind::If(arms, otherwise),
    }
}

fn taken(list: Vec<Stmt>, room: &mut usize) -> Result<Vec<Stmt>, Problem> {
    match room.checked_sub(list.len()) {
        Some(left) => *room = left,
        None => {
            let at = list.first().map_or(Span::default(), |s| s.at.0);
            let what = say!("too many ways lead past the RETURNs of this function block");
            return Err(Problem::new(&codes::TOO_LARGE, at, what));
        }
    }
    Ok(list)
}
