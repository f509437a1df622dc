//! The body of a function block without RETURN: in a call it stands among the statements of the caller, which go on.

use crate::visit_mut::{self, Use, Visitor};
use crate::{
    Block, Composed, Expr, ExprKind, Literal, Local, Name, Path, Place, Problem, Span, Stmt, StmtKind, Type,
    UnaryOp, codes, say,
};

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

/// Puts each RETURN out of the loops of a body: it sets a local variable and leaves the loop, and behind the loop that
/// variable is asked.
pub(super) fn out_of_loops(of: &Composed, block: &mut Block) {
    if !in_loops(&block.statements) {
        return;
    }
    let at = block.at;
    let mut names = Names(of.members.iter().chain(&of.inouts).flat_map(|m| &m.names).cloned().collect());
    names.0.extend(block.locals.iter().flat_map(|l| l.names.clone()));
    visit_mut::stmts(&mut block.statements, &mut names);
    let numbered = (2..).map(|n| format!("returned_{n}"));
    let free = |n: &String| !names.0.iter().any(|given| *given.text == **n);
    let Some(flag) = std::iter::once("returned".to_owned()).chain(numbered).find(free) else { return };
    let flag = Name { text: flag.into(), at };
    block.locals.push(Local { names: vec![flag.clone()], ty: Type::Bool, init: None, at });
    outside(&mut block.statements, &flag);
}

/// True if a RETURN stands in a loop of a list.
pub(super) fn in_loops(list: &[Stmt]) -> bool {
    list.iter().any(in_loop)
}

fn in_loop(s: &Stmt) -> bool {
    match &s.kind {
        _ if is_loop(s) => returns(s),
        StmtKind::If(arms, otherwise) => arms.iter().flat_map(|a| &a.1).chain(otherwise).any(in_loop),
        StmtKind::Case(_, arms, otherwise) => arms.iter().flat_map(|a| &a.body).chain(otherwise).any(in_loop),
        _ => false,
    }
}

/// True for a loop.
fn is_loop(s: &Stmt) -> bool {
    matches!(s.kind, StmtKind::For { .. } | StmtKind::While(..) | StmtKind::Repeat(..))
}

/// Rewrites the loops of a list that stands in none.
fn outside(list: &mut Vec<Stmt>, flag: &Name) {
    for mut s in std::mem::take(list) {
        let mut asked = false;
        if is_loop(&s) {
            visit_mut::lists(&mut s, |body| asked = inside(body, flag));
        } else {
            visit_mut::lists(&mut s, |body| outside(body, flag));
        }
        let at = s.at;
        list.push(s);
        if asked {
            list.push(ask(flag, StmtKind::Return, at));
        }
    }
}

/// Rewrites the body of a loop. Returns true if it had a RETURN.
fn inside(list: &mut Vec<Stmt>, flag: &Name) -> bool {
    let mut any = false;
    for mut s in std::mem::take(list) {
        let (at, inner) = (s.at, is_loop(&s));
        let mut had = false;
        visit_mut::lists(&mut s, |body| had |= inside(body, flag));
        if s.kind == StmtKind::Return {
            let target = Expr { kind: ExprKind::Path(Path { names: vec![flag.clone()] }), at };
            let value = Expr { kind: ExprKind::Literal(Literal::Bool(true)), at };
            list.push(Stmt { kind: StmtKind::Assign { target, value }, at });
            (s.kind, any) = (StmtKind::Exit, true);
        }
        list.push(s);
        if had && inner {
            list.push(ask(flag, StmtKind::Exit, at));
        }
        any |= had;
    }
    any
}

/// `IF returned THEN … END_IF`.
fn ask(flag: &Name, then: StmtKind, at: Place) -> Stmt {
    let condition = Expr { kind: ExprKind::Path(Path { names: vec![flag.clone()] }), at };
    Stmt { kind: StmtKind::If(vec![(condition, vec![Stmt { kind: then, at }])], Vec::new()), at }
}

/// All first names of the paths of a body.
struct Names(Vec<Name>);

impl Visitor for Names {
    fn path(&mut self, path: &mut Path, _: Use, _: Span) {
        self.0.extend(path.names.first().cloned());
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
            // A loop has none any more, see `out_of_loops`.
            list.push(Stmt { kind, at });
            list.extend(rest);
            return taken(list, room);
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
