//! Translates instructions into statements.
//!
//! The current result is kept as an expression and written where it is used. If a variable that the
//! expression reads is written in between, both cases of a Boolean result are written; for a result
//! of any other type this is a problem.

use g7_model::codes::{self, Code};
use g7_model::{Arg, BinaryOp, Expr, ExprKind, Path, Problem, Said, Span, Stmt, StmtKind, say};

use super::instruction::{Instruction, InstructionKind as Kind, Operand, When};
use super::jumps::{Piece, structure};
use crate::nodes::{assign, boolean};
use crate::terms::{height, not, reads, size};

/// The largest height of an expression. Later stages recurse over it.
const MOST_HIGH: u32 = 400;
/// The most open brackets.
const MOST_OPEN: usize = 100;
/// The most parts of results that are written more than once in one body.
const MOST_COPIED: usize = 1_000_000;

/// Translates a list of instructions into statements.
pub fn translate(list: &[Instruction]) -> (Vec<Stmt>, Vec<Problem>) {
    let (pieces, _, mut problems) = run(list, false);
    let statements = structure(&pieces, &mut problems);
    (statements, problems)
}

/// Translates a list of instructions without effects into the expression that is its last result.
pub fn translate_expr(list: &[Instruction], at: Span) -> (Expr, Vec<Problem>) {
    let (pieces, result, mut problems) = run(list, true);
    let first = pieces.iter().find_map(|p| match p {
        Piece::Do(s) => Some(s.at.0),
        Piece::Jump(_, n) => Some(n.at.0),
        Piece::Return(_, at) => Some(*at),
        Piece::Label(_) => None,
    });
    if let Some(place) = first {
        let what = say!("a condition in Instruction List writes, calls and jumps nowhere");
        problems.push(Problem::new(&codes::BODY_LANGUAGE, place, what));
    }
    if result.is_none() && problems.is_empty() {
        problems.push(Problem::new(&codes::BODY_LANGUAGE, at, say!("this Instruction List has no result")));
    }
    let bad = Expr { kind: ExprKind::Bad, at: at.into() };
    (result.map_or(bad, |r| r.expr), problems)
}

fn run(list: &[Instruction], value: bool) -> (Vec<Piece>, Option<Value>, Vec<Problem>) {
    let mut run = Run::new(None, value);
    run.all(list);
    if let Some(open) = run.open.pop() {
        run.say(&codes::UNCLOSED, open.at, say!("this bracket is never closed"));
    }
    (run.pieces, run.result, run.problems)
}

/// A result, with the height of its tree and the number of its parts.
#[derive(Clone, Debug)]
struct Value {
    expr: Expr,
    height: u32,
    size: usize,
}

impl Value {
    fn bad(at: Span) -> Value {
        Value { expr: Expr { kind: ExprKind::Bad, at: at.into() }, height: 1, size: 1 }
    }

    fn negated(self) -> Value {
        Value { expr: not(self.expr), height: self.height + 1, size: self.size + 1 }
    }
}

/// An open bracket that waits for its `)`.
struct Open {
    before: Value,
    op: BinaryOp,
    negated: bool,
    at: Span,
}

struct Run {
    result: Option<Value>,
    open: Vec<Open>,
    pieces: Vec<Piece>,
    problems: Vec<Problem>,
    /// True if the result at the end is used.
    value: bool,
    /// The number of parts of results that may still be copied.
    copies: usize,
}

impl Run {
    fn new(result: Option<Value>, value: bool) -> Run {
        let (open, pieces, problems) = (Vec::new(), Vec::new(), Vec::new());
        Run { result, open, pieces, problems, value, copies: MOST_COPIED }
    }

    fn say(&mut self, code: &'static Code, at: Span, what: Said) {
        self.problems.push(Problem::new(code, at, what));
    }

    fn all(&mut self, list: &[Instruction]) {
        let mut rest = list;
        while let Some((first, behind)) = rest.split_first() {
            rest = behind;
            if let Kind::Latch { target, value } = &first.kind
                && self.touches(target)
                && self.used(rest)
            {
                rest = self.cases(target, *value, first.at, rest);
                continue;
            }
            self.one(first, rest);
        }
    }

    fn one(&mut self, instruction: &Instruction, rest: &[Instruction]) {
        let at = instruction.at;
        match &instruction.kind {
            Kind::Label(name) => {
                self.closed(at, say!("a label"));
                self.result = None;
                self.pieces.push(Piece::Label(name.clone()));
            }
            Kind::Load { value, negated: n } => self.result = Some(leaf(value, *n)),
            Kind::Store { target, negated: n } => self.store(target, *n, at),
            Kind::Latch { target, value } => self.latch(target, *value, at),
            Kind::Operate { op, negated: n, operand } => self.operate(*op, *n, operand, at),
            Kind::Close => self.close(at),
            Kind::Complement => {
                let value = self.take(at);
                self.result = Some(value.negated());
            }
            Kind::Apply(name, values) => {
                let first = self.take(at);
                let tallest = values.iter().map(height).fold(first.height, u32::max);
                let size = values.iter().map(size).fold(first.size, usize::saturating_add);
                let args = std::iter::once(first.expr).chain(values.iter().cloned()).map(positional);
                let path = Path { names: vec![name.clone()] };
                let kind = ExprKind::Call(path, args.collect());
                self.set(Expr { kind, at: at.into() }, tallest + 1, size + 1);
            }
            Kind::Jump(name, when) => {
                self.closed(at, say!("a jump"));
                if let Some(condition) = self.condition(*when, at) {
                    self.pieces.push(Piece::Jump(condition, name.clone()));
                }
            }
            Kind::Call(path, args, when) => self.call(path, args, *when, at, rest),
            Kind::Input(member, path) => {
                self.closed(at, say!("a call"));
                if let Some(value) = self.need(at) {
                    let arg = Arg::input(Some(member.clone()), value.expr);
                    self.put(StmtKind::Call(path.clone(), vec![arg]), at);
                    self.result = None;
                }
            }
            Kind::Return(when) => {
                self.closed(at, say!("a return"));
                if let Some(condition) = self.condition(*when, at) {
                    self.pieces.push(Piece::Return(condition, at));
                }
            }
        }
    }

    fn put(&mut self, kind: StmtKind, at: Span) {
        self.pieces.push(Piece::Do(Stmt { kind, at: at.into() }));
    }

    fn set(&mut self, expr: Expr, height: u32, size: usize) {
        if height <= MOST_HIGH {
            self.result = Some(Value { expr, height, size });
            return;
        }
        let at = expr.at.0;
        self.say(
            &codes::TOO_DEEP,
            at,
            say!("a result of more than {MOST_HIGH} operations; store it between"),
        );
        self.result = Some(Value::bad(at));
    }

    /// Takes the result, which will be replaced. Returns `Bad` and reports a problem if there is
    /// none.
    fn take(&mut self, at: Span) -> Value {
        self.result.take().unwrap_or_else(|| {
            let what =
                say!("there is no result here; behind a label, a call and at the start one is loaded first");
            self.say(&codes::BODY_LANGUAGE, at, what);
            Value::bad(at)
        })
    }

    /// The result, which is used again later. None if it could not be read.
    fn need(&mut self, at: Span) -> Option<Value> {
        let value = self.take(at);
        match self.copies.checked_sub(value.size) {
            Some(left) => {
                self.copies = left;
                self.result = Some(value.clone());
            }
            None => {
                self.say(
                    &codes::TOO_DEEP,
                    at,
                    say!("results of too many operations are used again; store them"),
                );
                self.result = Some(Value::bad(at));
                self.copies = usize::MAX;
            }
        }
        Some(value).filter(|v| v.expr.kind != ExprKind::Bad)
    }

    /// True if no bracket is open. Instructions with an effect must stand outside of brackets.
    fn closed(&mut self, at: Span, what: Said) {
        if !self.open.is_empty() {
            self.say(&codes::BODY_LANGUAGE, at, say!("{what} cannot stand between brackets"));
        }
    }

    /// The condition of a jump. The outer None means that there is no result.
    fn condition(&mut self, when: When, at: Span) -> Option<Option<Expr>> {
        match when {
            When::Always => Some(None),
            When::True => self.need(at).map(|v| Some(v.expr)),
            When::False => self.need(at).map(|v| Some(not(v.expr))),
        }
    }

    fn store(&mut self, target: &Expr, n: bool, at: Span) {
        self.closed(at, say!("a store"));
        let Some(value) = self.need(at) else { return };
        let stored = if n { not(value.expr) } else { value.expr };
        self.put(StmtKind::Assign { target: target.clone(), value: stored }, at);
        // From here on the variable holds the result.
        self.result = Some(leaf(target, n));
    }

    fn latch(&mut self, target: &Expr, value: bool, at: Span) {
        self.closed(at, say!("a set or reset"));
        let Some(result) = self.need(at) else { return };
        let assigned = assign(target.clone(), boolean(value, at), at);
        self.put(StmtKind::If(vec![(result.expr, vec![assigned])], Vec::new()), at);
    }

    fn operate(&mut self, op: BinaryOp, n: bool, operand: &Operand, at: Span) {
        match operand {
            Operand::Values(values) => {
                for value in values {
                    let left = self.take(at);
                    self.join(op, left, leaf(value, n), at);
                }
            }
            Operand::Open(value) => {
                if self.open.len() >= MOST_OPEN {
                    return self.say(&codes::TOO_DEEP, at, say!("brackets nested too deeply"));
                }
                let before = self.take(at);
                self.open.push(Open { before, op, negated: n, at });
                self.result = value.as_ref().map(|v| leaf(v, false));
            }
        }
    }

    fn close(&mut self, at: Span) {
        let Some(open) = self.open.pop() else {
            return self.say(&codes::BODY_LANGUAGE, at, say!("no bracket is open here"));
        };
        let right = self.take(at);
        let right = if open.negated { right.negated() } else { right };
        self.join(open.op, open.before, right, open.at.to(at));
    }

    fn join(&mut self, op: BinaryOp, left: Value, right: Value, at: Span) {
        let tall = left.height.max(right.height) + 1;
        let size = left.size.saturating_add(right.size).saturating_add(1);
        let kind = ExprKind::Binary(op, Box::new(left.expr), Box::new(right.expr));
        self.set(Expr { kind, at: at.into() }, tall, size);
    }

    fn call(&mut self, path: &Path, args: &[Arg], when: When, at: Span, rest: &[Instruction]) {
        self.closed(at, say!("a call"));
        let Some(condition) = self.condition(when, at) else { return };
        let call = StmtKind::Call(path.clone(), args.to_vec());
        match condition {
            None => self.put(call, at),
            Some(c) => {
                let body = vec![Stmt { kind: call, at: at.into() }];
                self.put(StmtKind::If(vec![(c, body)], Vec::new()), at);
            }
        }
        let written = Expr { kind: ExprKind::Path(path.clone()), at: at.into() };
        let outputs: Vec<&Expr> = args.iter().filter(|a| a.output).map(|a| &a.value).collect();
        if self.touches(&written) || outputs.iter().any(|o| self.touches(o)) {
            if self.used(rest) {
                let what = say!(
                    "the result that is used behind this call is read from what the call changes; store it in a variable first"
                );
                self.say(&codes::BODY_LANGUAGE, at, what);
            }
            self.result = None;
        }
    }

    /// True if the result reads the variable that `target` names.
    fn touches(&self, target: &Expr) -> bool {
        self.result.as_ref().is_some_and(|v| reads(&v.expr, target))
    }

    /// True if one of the following instructions uses the result.
    fn used(&self, rest: &[Instruction]) -> bool {
        for next in rest {
            match &next.kind {
                Kind::Load { .. }
                | Kind::Label(_)
                | Kind::Return(When::Always)
                | Kind::Jump(_, When::Always) => {
                    return false;
                }
                Kind::Call(_, _, When::Always) => {}
                _ => return true,
            }
        }
        self.value
    }

    /// Sets or resets a variable that the result itself reads: writes the following instructions
    /// for both cases.
    fn cases<'i>(
        &mut self,
        target: &Expr,
        value: bool,
        at: Span,
        rest: &'i [Instruction],
    ) -> &'i [Instruction] {
        let ends = |i: &Instruction| matches!(i.kind, Kind::Load { .. } | Kind::Label(_));
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        let (here, behind) = rest.split_at(length);
        self.closed(at, say!("a set or reset"));
        let Some(result) = self.need(at) else { return behind };
        let mut arms = [vec![assign(target.clone(), boolean(value, at), at)], Vec::new()];
        for (arm, case) in arms.iter_mut().zip([true, false]) {
            let mut run = Run::new(Some(leaf(&boolean(case, at), false)), false);
            run.all(here);
            for piece in run.pieces {
                match piece {
                    Piece::Do(stmt) => arm.push(stmt),
                    Piece::Jump(..) | Piece::Return(..) | Piece::Label(_) => {
                        let what = say!(
                            "a jump on a result that was changed by this instruction; store it in a variable first"
                        );
                        run.problems.push(Problem::new(&codes::BODY_LANGUAGE, at, what));
                        break;
                    }
                }
            }
            if case {
                self.problems.append(&mut run.problems);
            }
        }
        let [then, otherwise] = arms;
        self.put(StmtKind::If(vec![(result.expr, then)], otherwise), at);
        self.result = None;
        behind
    }
}

fn leaf(value: &Expr, n: bool) -> Value {
    let value = Value { expr: value.clone(), height: height(value), size: size(value) };
    if n { value.negated() } else { value }
}

fn positional(value: Expr) -> Arg {
    Arg::input(None, value)
}
