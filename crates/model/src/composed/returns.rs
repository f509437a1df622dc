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
    if !list.iter().any(Stmt::returns) {
        return Ok(list);
    }
    let mut room = MOST;
    before(list, &mut room)
}

/// Replaces each RETURN in a loop of a body: it sets a local variable and leaves the loop by EXIT; the statement behind
/// the loop returns if the variable is set.
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
    block.locals.push(Local { names: vec![flag.clone()], ty: Type::Bool.into(), init: None, at });
    outside(&mut block.statements, &flag);
}

/// True if a RETURN stands in a loop of a list.
pub(super) fn in_loops(list: &[Stmt]) -> bool {
    list.iter().any(in_loop)
}

fn in_loop(s: &Stmt) -> bool {
    if s.is_loop() { s.returns() } else { s.lists().into_iter().any(in_loops) }
}

/// Replaces the RETURNs in the loops of a list of statements that does not stand in a loop itself.
fn outside(list: &mut Vec<Stmt>, flag: &Name) {
    for mut s in std::mem::take(list) {
        let mut asked = false;
        if s.is_loop() {
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

/// Replaces the RETURNs in the body of a loop. The result is true if there were any.
fn inside(list: &mut Vec<Stmt>, flag: &Name) -> bool {
    let mut any = false;
    for mut s in std::mem::take(list) {
        let (at, inner) = (s.at, s.is_loop());
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
    let Some(first) = list.iter().position(Stmt::returns) else { return taken(list, room) };
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
            // `out_of_loops` leaves no RETURN in a loop.
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
