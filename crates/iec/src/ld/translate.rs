//! Translates rungs into statements.
//!
//! The power at each place of a rung is an expression, which is written at each coil. If a coil
//! writes a variable that the power behind it reads, the rest of the rung is written for both
//! cases.

use g7_model::codes;
use g7_model::{Arg, BinaryOp, Expr, ExprKind, Literal, Path, Problem, Said, Span, Stmt, StmtKind, say};

use super::rung::{Coil, Element, Rung};
use crate::il::jumps::{Piece, structure};
use crate::nodes::{assign, boolean};
use crate::terms::{height, not, reads, size};

/// The largest height of a power's expression.
const MOST_HIGH: u32 = 400;
/// The most parts of expressions that are written in one body.
const MOST_PARTS: usize = 1_000_000;

/// Translates rungs into statements.
pub fn translate(rungs: &[Rung], problems: &mut Vec<Problem>) -> Vec<Stmt> {
    let mut run = Run { pieces: Vec::new(), problems, parts: MOST_PARTS };
    for rung in rungs {
        run.pieces.extend(rung.label.clone().map(Piece::Label));
        if !rung.elements.is_empty() && !has_coil(&rung.elements) {
            let what = say!("this rung does nothing: it has no coil");
            run.problems.push(Problem::new(&codes::BODY_LANGUAGE, rung.at, what));
        }
        let base = Power { expr: boolean(true, rung.at), height: 1 };
        run.wire(&rung.elements, base, &mut Vec::new(), false);
    }
    let Run { pieces, .. } = run;
    structure(&pieces, problems)
}

/// Translates one rung of contacts into the power behind its last element: a receptivity.
pub fn translate_expr(rungs: &[Rung], at: Span, problems: &mut Vec<Problem>) -> Expr {
    let [rung] = rungs else {
        problems.push(Problem::new(&codes::BODY_LANGUAGE, at, say!("a condition in Ladder is one rung")));
        return Expr { kind: ExprKind::Bad, at: at.into() };
    };
    let mut run = Run { pieces: Vec::new(), problems, parts: MOST_PARTS };
    let base = Power { expr: boolean(true, rung.at), height: 1 };
    let power = run.wire(&rung.elements, base, &mut Vec::new(), true);
    let wrote = !run.pieces.is_empty();
    if wrote {
        problems.push(Problem::new(
            &codes::BODY_LANGUAGE,
            at,
            say!("a condition in Ladder has contacts only"),
        ));
    }
    power.expr
}

/// An expression, with the height of its tree.
#[derive(Clone, Debug)]
struct Power {
    expr: Expr,
    height: u32,
}

struct Run<'a> {
    pieces: Vec<Piece>,
    problems: &'a mut Vec<Problem>,
    parts: usize,
}

fn has_coil(elements: &[Element]) -> bool {
    elements.iter().any(|e| match e {
        Element::Contact(_) => false,
        Element::Coil(..) | Element::Block { .. } => true,
        Element::Branch(ways, _) => ways.iter().any(|w| has_coil(w)),
    })
}

impl Run<'_> {
    fn say(&mut self, at: Span, what: Said) {
        self.problems.push(Problem::new(&codes::BODY_LANGUAGE, at, what));
    }

    fn join(&mut self, op: BinaryOp, left: Power, right: Power) -> Power {
        let identity = op == BinaryOp::And;
        let constant = |p: &Power| match p.expr.kind {
            ExprKind::Literal(Literal::Bool(b)) => Some(b),
            _ => None,
        };
        match (constant(&left), constant(&right)) {
            (Some(b), _) if b == identity => return right,
            (_, Some(b)) if b == identity => return left,
            (Some(_), _) => return left,
            (_, Some(_)) => return right,
            (None, None) => {}
        }
        let at = left.expr.at.0.to(right.expr.at.0);
        let tall = left.height.max(right.height) + 1;
        if tall > MOST_HIGH {
            let what = say!("a rung with more than {MOST_HIGH} elements in a row");
            self.problems.push(Problem::new(&codes::TOO_DEEP, at, what));
            return Power { expr: Expr { kind: ExprKind::Bad, at: at.into() }, height: 1 };
        }
        let kind = ExprKind::Binary(op, Box::new(left.expr), Box::new(right.expr));
        Power { expr: Expr { kind, at: at.into() }, height: tall }
    }

    /// Copies a power that is used once more.
    fn again(&mut self, power: &Power) -> Power {
        match self.parts.checked_sub(size(&power.expr)) {
            Some(left) => {
                self.parts = left;
                power.clone()
            }
            None => {
                let at = power.expr.at.0;
                if self.parts > 0 {
                    self.parts = 0;
                    let what = say!(
                        "these rungs stand for too long expressions; write some of them as rungs of their own"
                    );
                    self.problems.push(Problem::new(&codes::TOO_DEEP, at, what));
                }
                Power { expr: Expr { kind: ExprKind::Bad, at: at.into() }, height: 1 }
            }
        }
    }

    /// The power at the end of a wire, relative to the power `base` at its beginning.
    /// `held` are expressions that are used later. `wanted` is true if the power at the end is
    /// used.
    fn wire(&mut self, elements: &[Element], base: Power, held: &mut Vec<Expr>, wanted: bool) -> Power {
        let mut own = Power { expr: boolean(true, base.expr.at.0), height: 1 };
        let mut base = base;
        let mut rest = elements;
        while let Some((first, behind)) = rest.split_first() {
            rest = behind;
            match first {
                Element::Contact(e) => {
                    let contact = Power { expr: e.clone(), height: height(e) };
                    own = self.join(BinaryOp::And, own, contact);
                }
                Element::Coil(coil, at) => {
                    let power = self.at_coil(&base, &own);
                    let uses = !rest.is_empty() || wanted;
                    if uses && self.changes(coil, &power.expr) {
                        if !held.is_empty() || wanted {
                            self.say(
                                *at,
                                say!("this coil changes what the rung was read from; write two rungs"),
                            );
                            continue;
                        }
                        self.cases(coil, power, rest, *at);
                        return own;
                    }
                    self.guard(coil, held, *at);
                    self.coil(coil, power.expr, *at);
                }
                Element::Block { path, args, output, at } => {
                    let power = self.at_coil(&base, &own);
                    let written = Expr { kind: ExprKind::Path(path.clone()), at: (*at).into() };
                    if held.iter().any(|h| reads(h, &written)) {
                        self.say(
                            *at,
                            say!("this block changes what the rung was read from; write two rungs"),
                        );
                    }
                    let expr = self.block(path, args, power, *at);
                    if let Some(output) = output {
                        let names = path.names.iter().cloned().chain([output.clone()]).collect();
                        let kind = ExprKind::Path(Path { names });
                        base = Power { expr: boolean(true, *at), height: 1 };
                        own = Power { expr: Expr { kind, at: (*at).into() }, height: 1 };
                    } else if reads(&expr, &written) {
                        self.say(
                            *at,
                            say!("this block changes what the rung was read from; write two rungs"),
                        );
                    }
                }
                Element::Branch(ways, at) => {
                    let after = !rest.is_empty() || wanted;
                    let through = self.branch(ways, &base, &own, held, after, *at);
                    own = self.join(BinaryOp::And, own, through);
                }
            }
        }
        own
    }

    /// The branches of an element: the power behind it, relative to the power before it.
    fn branch(
        &mut self,
        ways: &[Vec<Element>],
        base: &Power,
        own: &Power,
        held: &mut Vec<Expr>,
        after: bool,
        at: Span,
    ) -> Power {
        let mut through: Option<Power> = None;
        let before = held.len();
        for (index, way) in ways.iter().enumerate() {
            let coils = has_coil(way);
            let start =
                if coils { self.at_coil(base, own) } else { Power { expr: boolean(true, at), height: 1 } };
            let last = index + 1 == ways.len();
            if coils && (!last || after) {
                held.push(start.expr.clone());
            }
            let power = self.wire(way, start, held, after);
            if after {
                held.push(power.expr.clone());
            }
            through = Some(match through {
                Some(all) => self.join(BinaryOp::Or, all, power),
                None => power,
            });
        }
        held.truncate(before);
        through.unwrap_or(Power { expr: boolean(true, at), height: 1 })
    }

    /// The power at a place: the power at the beginning and all contacts since.
    fn at_coil(&mut self, base: &Power, own: &Power) -> Power {
        let base = self.again(base);
        let own = self.again(own);
        self.join(BinaryOp::And, base, own)
    }

    /// The variable that a coil writes.
    fn target(coil: &Coil) -> Option<&Expr> {
        match coil {
            Coil::Assign(target, _) | Coil::Latch(target, _) | Coil::Edge(target, _) => Some(target),
            Coil::Statement(stmt) => match &stmt.kind {
                StmtKind::Assign { target, .. } => Some(target),
                _ => None,
            },
            Coil::Jump(_) | Coil::Return => None,
        }
    }

    fn changes(&self, coil: &Coil, power: &Expr) -> bool {
        if let Some(target) = Self::target(coil) {
            return reads(power, target);
        }
        if let Coil::Statement(stmt) = coil
            && let StmtKind::Call(path, _) = &stmt.kind
        {
            return reads(power, &Expr { kind: ExprKind::Path(path.clone()), at: stmt.at });
        }
        false
    }

    /// Reports a coil that changes an expression which is still needed.
    fn guard(&mut self, coil: &Coil, held: &[Expr], at: Span) {
        if held.iter().any(|h| self.changes(coil, h)) {
            self.say(at, say!("this coil changes what the rung was read from; write two rungs"));
        }
    }

    fn coil(&mut self, coil: &Coil, power: Expr, at: Span) {
        let kind = match coil {
            Coil::Assign(target, n) => {
                let value = if *n { not(power) } else { power };
                StmtKind::Assign { target: target.clone(), value }
            }
            Coil::Edge(target, op) => {
                let value = Expr { kind: ExprKind::Unary(*op, Box::new(power)), at: at.into() };
                StmtKind::Assign { target: target.clone(), value }
            }
            Coil::Latch(target, value) => {
                return self.when(power, assign(target.clone(), boolean(*value, at), at), at);
            }
            Coil::Statement(stmt) => return self.when(power, (**stmt).clone(), at),
            Coil::Jump(name) => {
                let condition = Some(power).filter(|p| !is_true(p));
                return self.pieces.push(Piece::Jump(condition, name.clone()));
            }
            Coil::Return => {
                let condition = Some(power).filter(|p| !is_true(p));
                return self.pieces.push(Piece::Return(condition, at));
            }
        };
        self.pieces.push(Piece::Do(Stmt { kind, at: at.into() }));
    }

    /// Writes a statement that is executed while there is power.
    fn when(&mut self, power: Expr, stmt: Stmt, at: Span) {
        let stmt = if is_true(&power) {
            stmt
        } else {
            Stmt { kind: StmtKind::If(vec![(power, vec![stmt])], Vec::new()), at: at.into() }
        };
        self.pieces.push(Piece::Do(stmt));
    }

    /// Writes the call of a block and returns the power that entered it.
    fn block(&mut self, path: &Path, args: &[Arg], power: Power, at: Span) -> Expr {
        let given = power.expr.clone();
        let mut taken = false;
        let args = args
            .iter()
            .map(|arg| match (&arg.name, &arg.value.kind) {
                (None, ExprKind::Path(input)) if input.names.len() == 1 => {
                    if taken {
                        self.say(
                            arg.value.at.0,
                            say!("power goes into one input; the others have values, `PT := 5s`"),
                        );
                    }
                    taken = true;
                    Arg::input(input.names.first().cloned(), power.expr.clone())
                }
                _ => arg.clone(),
            })
            .collect();
        let call = Stmt { kind: StmtKind::Call(path.clone(), args), at: at.into() };
        if taken {
            self.pieces.push(Piece::Do(call))
        } else {
            self.when(power.expr, call, at)
        }
        given
    }

    /// Writes a coil that changes a variable its own power reads: the rest of the rung is written
    /// for both cases.
    fn cases(&mut self, coil: &Coil, power: Power, rest: &[Element], at: Span) {
        let mut arms = Vec::new();
        for case in [true, false] {
            let mut run = Run { pieces: Vec::new(), problems: &mut *self.problems, parts: self.parts };
            let given = Power { expr: boolean(case, at), height: 1 };
            run.coil(coil, given.expr.clone(), at);
            run.wire(rest, given, &mut Vec::new(), false);
            self.parts = run.parts;
            let mut list = Vec::new();
            let mut jumps = false;
            for piece in run.pieces {
                match piece {
                    Piece::Do(stmt) => list.push(stmt),
                    Piece::Jump(..) | Piece::Return(..) | Piece::Label(_) => jumps = true,
                }
            }
            if jumps && case {
                self.say(at, say!("behind this coil, which changes what the rung was read from, stands a jump; write two rungs"));
            }
            arms.push(list);
        }
        let otherwise = arms.pop().unwrap_or_default();
        let then = arms.pop().unwrap_or_default();
        let kind = StmtKind::If(vec![(power.expr, then)], otherwise);
        self.pieces.push(Piece::Do(Stmt { kind, at: at.into() }));
    }
}

fn is_true(e: &Expr) -> bool {
    e.kind == ExprKind::Literal(Literal::Bool(true))
}
