//! Turns jumps and labels into conditions and loops.
//!
//! A forward jump becomes a condition around the statements that it skips. Two branches that meet
//! again share the statements behind the meeting point. A backward jump becomes a loop with one
//! entry; it continues behind the last jump back. A jump without such a form is a problem; nothing
//! is guessed.

use std::collections::HashMap;

use g7_model::codes;
use g7_model::{Expr, ExprKind, Literal, Name, Problem, Said, Span, Stmt, StmtKind, say};

use crate::nodes::when;
use crate::terms::not;

/// The most work for one body: statements between entangled jumps may be written several times.
const MOST_WORK: usize = 200_000;
/// The deepest nesting of conditions and loops.
const DEEPEST: usize = 60;

/// A part of a body with jumps.
#[derive(Clone, Debug)]
pub(crate) enum Piece {
    Do(Stmt),
    Label(Name),
    /// A jump with its condition, or an unconditional one.
    Jump(Option<Expr>, Name),
    Return(Option<Expr>, Span),
}

/// Gives the statements that do what the pieces do.
pub(crate) fn structure(pieces: &[Piece], problems: &mut Vec<Problem>) -> Vec<Stmt> {
    let mut labels = HashMap::new();
    for (index, piece) in pieces.iter().enumerate() {
        if let Piece::Label(name) = piece
            && labels.insert(&*name.text, index).is_some()
        {
            let what = say!("the label `{}` stands there twice", name.text);
            problems.push(Problem::new(&codes::BODY_LANGUAGE, name.at.0, what));
        }
    }
    let targets = pieces
        .iter()
        .map(|piece| match piece {
            Piece::Jump(_, name) => {
                let target = labels.get(&*name.text).copied();
                if target.is_none() {
                    let what = say!("there is no label `{}`", name.text);
                    problems.push(Problem::new(&codes::BODY_LANGUAGE, name.at.0, what));
                }
                target
            }
            _ => None,
        })
        .collect();
    let mut flow = Flow { pieces, targets, work: MOST_WORK, problems, stuck: false };
    flow.range(0, pieces.len(), None, 0)
}

struct Flow<'a> {
    pieces: &'a [Piece],
    /// The target of each jump.
    targets: Vec<Option<usize>>,
    work: usize,
    problems: &'a mut Vec<Problem>,
    /// True once a problem of the whole body has been reported.
    stuck: bool,
}

/// A loop: the index of its label and that of its last jump back.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Loop {
    start: usize,
    last: usize,
}

impl Flow<'_> {
    /// Consumes work; returns false when the limit is exceeded.
    fn spend(&mut self, amount: usize, at: Span) -> bool {
        match self.work.checked_sub(amount) {
            Some(left) => {
                self.work = left;
                true
            }
            None => {
                self.stuck(at, say!("these jumps are too entangled to be written as conditions and loops"));
                false
            }
        }
    }

    fn stuck(&mut self, at: Span, what: Said) {
        if !self.stuck {
            self.stuck = true;
            let problem = Problem::new(&codes::BODY_LANGUAGE, at, what);
            self.problems.push(problem.help(say!("write this part in Structured Text")));
        }
    }

    /// Writes the pieces from `at` up to `end`.
    fn range(&mut self, mut at: usize, end: usize, inside: Option<Loop>, depth: usize) -> Vec<Stmt> {
        let mut out = Vec::new();
        while at < end && !self.stuck {
            let Some(piece) = self.pieces.get(at) else { break };
            if !self.spend(1, span_of(piece)) {
                break;
            }
            match piece {
                Piece::Do(stmt) => out.push(stmt.clone()),
                Piece::Label(name) => {
                    if let Some(last) = self.loop_at(at, end, inside) {
                        if depth >= DEEPEST {
                            self.stuck(name.at.0, say!("loops nested too deeply"));
                            break;
                        }
                        out.push(self.repeated(Loop { start: at, last }, depth));
                        at = last;
                    }
                }
                Piece::Return(condition, span) => {
                    let stmt = Stmt { kind: StmtKind::Return, at: (*span).into() };
                    match condition {
                        Some(c) => out.push(when(c.clone(), vec![stmt], Vec::new(), *span)),
                        None => {
                            out.push(stmt);
                            return out;
                        }
                    }
                }
                Piece::Jump(condition, name) => {
                    let Some(target) = self.targets.get(at).copied().flatten() else {
                        at += 1;
                        continue;
                    };
                    match self.jump(at, target, end, inside, condition.as_ref(), name, depth) {
                        Jumped::Leaves(stmts) => {
                            let always = condition.is_none();
                            out.extend(stmts);
                            if always {
                                return out;
                            }
                        }
                        Jumped::On(stmts, next) => {
                            out.extend(stmts);
                            at = next;
                            continue;
                        }
                    }
                }
            }
            at += 1;
        }
        out
    }

    /// The last jump back to the label at `at`, unless that loop is already being written.
    fn loop_at(&mut self, at: usize, end: usize, inside: Option<Loop>) -> Option<usize> {
        if inside.is_some_and(|l| l.start == at) {
            return None;
        }
        if !self.spend(end - at, Span::default()) {
            return None;
        }
        (at + 1..end).rev().find(|i| self.targets.get(*i).copied().flatten() == Some(at))
    }

    fn repeated(&mut self, this: Loop, depth: usize) -> Stmt {
        let body = self.range(this.start, this.last, Some(this), depth + 1);
        let (condition, at) = match self.pieces.get(this.last) {
            Some(Piece::Jump(condition, name)) => (condition.clone(), name.at),
            _ => (None, Span::default().into()),
        };
        let kind = match condition {
            Some(c) => StmtKind::Repeat(body, not(c)),
            None => StmtKind::While(Expr { kind: ExprKind::Literal(Literal::Bool(true)), at }, body),
        };
        Stmt { kind, at }
    }

    #[expect(clippy::too_many_arguments, reason = "the whole of one jump")]
    fn jump(
        &mut self,
        at: usize,
        target: usize,
        end: usize,
        inside: Option<Loop>,
        condition: Option<&Expr>,
        name: &Name,
        depth: usize,
    ) -> Jumped {
        let span = name.at.0;
        if target <= at || target > end {
            return self.leave(target, inside, condition, span);
        }
        let Some(condition) = condition else { return Jumped::On(Vec::new(), target) };
        if depth >= DEEPEST {
            self.stuck(span, say!("jumps within jumps nested too deeply"));
            return Jumped::Leaves(Vec::new());
        }
        let meet = self.meeting(at, target, end, inside, span);
        let taken = self.range(target, meet, inside, depth + 1);
        let skipped = self.range(at + 1, meet, inside, depth + 1);
        let stmts = match (taken.is_empty(), skipped.is_empty()) {
            (true, true) => Vec::new(),
            (true, false) => vec![when(not(condition.clone()), skipped, Vec::new(), span)],
            (false, _) => vec![when(condition.clone(), taken, skipped, span)],
        };
        Jumped::On(stmts, meet)
    }

    /// Finds where the two branches of a jump meet, if no jump between them leads further.
    fn meeting(&mut self, at: usize, target: usize, end: usize, inside: Option<Loop>, span: Span) -> usize {
        let mut meet = target;
        let mut i = at + 1;
        while i < meet {
            if let Some(to) = self.targets.get(i).copied().flatten()
                && to > meet
                && !(to > end && self.exits(to, inside))
            {
                meet = to.min(end);
            }
            i += 1;
        }
        self.spend(i - at, span);
        meet
    }

    /// True if a place is where control continues when the loop ends.
    fn exits(&self, target: usize, inside: Option<Loop>) -> bool {
        let Some(this) = inside else { return false };
        let between = self.pieces.get(this.last + 1..target).unwrap_or(&[]);
        target > this.last && between.iter().all(|p| matches!(p, Piece::Label(_)))
    }

    /// Writes a jump out of the current pieces: out of the loop, or to its next iteration.
    fn leave(&mut self, target: usize, inside: Option<Loop>, condition: Option<&Expr>, span: Span) -> Jumped {
        if !self.exits(target, inside) {
            self.stuck(span, say!("this jump has no form as a condition or loop"));
            return Jumped::Leaves(Vec::new());
        }
        let exit = Stmt { kind: StmtKind::Exit, at: span.into() };
        Jumped::Leaves(match condition {
            Some(c) => vec![when(c.clone(), vec![exit], Vec::new(), span)],
            None => vec![exit],
        })
    }
}

enum Jumped {
    /// If the jump is made, control continues elsewhere.
    Leaves(Vec<Stmt>),
    /// Both branches are written up to this piece.
    On(Vec<Stmt>, usize),
}

fn span_of(piece: &Piece) -> Span {
    match piece {
        Piece::Do(stmt) => stmt.at.0,
        Piece::Label(name) | Piece::Jump(_, name) => name.at.0,
        Piece::Return(_, at) => *at,
    }
}
