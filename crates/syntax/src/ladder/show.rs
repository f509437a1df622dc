//! Structured Text shown as Ladder.

use g7_model::{BinaryOp, Expr, ExprKind, Literal, Stmt, StmtKind, UnaryOp};

use crate::il::negated;
use crate::print::print_expr;

/// An exclusive or is drawn as two ways while this many contacts stand in it; a larger one is a contact.
const MOST_IN_XOR: usize = 4;
/// Conditions within one another are written out on every rung.
const MOST_SHOWN: usize = 200_000;

/// The wire through which power flows where the expression is true.
pub fn show_expr_as_ladder(e: &Expr) -> String {
    wire(e, false)
}

/// The rungs that do what the statements do; none where a statement has no form in them (FOR, CASE).
///
/// `boolean`: whether a variable or call is a BOOL; an assignment of anything else is no coil.
pub fn show_as_ladder(statements: &[Stmt], boolean: &dyn Fn(&Expr) -> bool) -> Option<String> {
    let mut shower = Shower { out: String::new(), labels: 0, boolean };
    shower.statements(statements, &[], None)?;
    Some(shower.out)
}

struct Shower<'a> {
    out: String,
    labels: usize,
    boolean: &'a dyn Fn(&Expr) -> bool,
}

impl Shower<'_> {
    /// A rung with its power and coil.
    fn rung(&mut self, power: &[Expr], coil: &str) -> Option<()> {
        for e in power {
            self.out.push_str(&wire(e, false));
        }
        self.out.push_str("--");
        self.out.push_str(coil);
        self.out.push('\n');
        (self.out.len() < MOST_SHOWN).then_some(())
    }

    fn label(&mut self) -> String {
        self.labels += 1;
        format!("L{}", self.labels)
    }

    /// `power`: what the statements are under; `exit`: where EXIT goes to.
    fn statements(&mut self, list: &[Stmt], power: &[Expr], exit: Option<&str>) -> Option<()> {
        list.iter().try_for_each(|s| self.statement(s, power, exit))
    }

    fn statement(&mut self, stmt: &Stmt, power: &[Expr], exit: Option<&str>) -> Option<()> {
        match &stmt.kind {
            StmtKind::Assign { target, value } => self.assign(target, value, power),
            StmtKind::Call(path, args) => {
                let call = Expr { kind: ExprKind::Call(path.clone(), args.clone()), at: stmt.at };
                self.rung(power, &format!("({})", print_expr(&call)))
            }
            StmtKind::If(arms, otherwise) => self.conditions(arms, otherwise, power, exit),
            StmtKind::Return => self.rung(power, "(RET)"),
            StmtKind::Exit => self.rung(power, &format!("(JMP {})", exit?)),
            StmtKind::While(condition, body) if power.is_empty() => {
                let (start, end) = (self.label(), self.label());
                self.out.push_str(&format!("{start}: "));
                self.rung(&[negated(condition.clone())], &format!("(JMP {end})"))?;
                self.statements(body, &[], Some(&end))?;
                self.rung(&[], &format!("(JMP {start})"))?;
                self.out.push_str(&format!("{end}:\n"));
                Some(())
            }
            StmtKind::Repeat(body, condition) if power.is_empty() => {
                let (start, end) = (self.label(), self.label());
                self.out.push_str(&format!("{start}:\n"));
                self.statements(body, &[], Some(&end))?;
                self.rung(&[negated(condition.clone())], &format!("(JMP {start})"))?;
                self.out.push_str(&format!("{end}:\n"));
                Some(())
            }
            StmtKind::While(..) | StmtKind::Repeat(..) | StmtKind::Case(..) | StmtKind::For { .. } => None,
        }
    }

    fn assign(&mut self, target: &Expr, value: &Expr, power: &[Expr]) -> Option<()> {
        let name = print_expr(target);
        let constant = match value.kind {
            ExprKind::Literal(Literal::Bool(b)) => Some(b),
            _ => None,
        };
        if power.is_empty() && self.is_boolean(value) {
            return match (constant, &value.kind) {
                (Some(true), _) => self.rung(&[], &format!("({name})")),
                (Some(false), _) => self.rung(&[], &format!("(/{name})")),
                (None, ExprKind::Unary(UnaryOp::Not, inner))
                    if matches!(inner.kind, ExprKind::Binary(..)) =>
                {
                    self.rung(std::slice::from_ref(inner), &format!("(/{name})"))
                }
                (None, _) => self.rung(std::slice::from_ref(value), &format!("({name})")),
            };
        }
        match constant {
            Some(true) => self.rung(power, &format!("(S {name})")),
            Some(false) => self.rung(power, &format!("(R {name})")),
            None => self.rung(power, &format!("({name} := {})", print_expr(value))),
        }
    }

    /// Whether an expression is true or false, by its form or by what its names are.
    fn is_boolean(&self, e: &Expr) -> bool {
        match &e.kind {
            ExprKind::Literal(Literal::Bool(_)) | ExprKind::Timer { .. } => true,
            ExprKind::Unary(op, _) => *op != UnaryOp::Neg,
            ExprKind::Binary(op, left, _) => match op {
                BinaryOp::Add | BinaryOp::Mul => self.is_boolean(left),
                BinaryOp::Sub | BinaryOp::Div | BinaryOp::Mod | BinaryOp::Pow => false,
                BinaryOp::Or | BinaryOp::Xor | BinaryOp::And | BinaryOp::Dot => true,
                BinaryOp::Eq | BinaryOp::Ne | BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge => {
                    true
                }
            },
            ExprKind::Path(_) | ExprKind::Direct(_) | ExprKind::Call(..) => (self.boolean)(e),
            ExprKind::Literal(_) | ExprKind::Bad => false,
        }
    }

    /// A condition of one statement is the power of its rung; others are jumped over,
    /// since what they do may change the condition.
    fn conditions(
        &mut self,
        arms: &[(Expr, Vec<Stmt>)],
        otherwise: &[Stmt],
        power: &[Expr],
        exit: Option<&str>,
    ) -> Option<()> {
        if let [(condition, body)] = arms
            && otherwise.is_empty()
            && let [only] = body.as_slice()
            && !matches!(only.kind, StmtKind::While(..) | StmtKind::Repeat(..) | StmtKind::If(..))
        {
            let inner: Vec<Expr> = power.iter().cloned().chain([condition.clone()]).collect();
            return self.statement(only, &inner, exit);
        }
        if !power.is_empty() {
            return None;
        }
        let end = self.label();
        for (index, (condition, body)) in arms.iter().enumerate() {
            let last = index + 1 == arms.len() && otherwise.is_empty();
            let next = if last { end.clone() } else { self.label() };
            self.rung(&[negated(condition.clone())], &format!("(JMP {next})"))?;
            self.statements(body, &[], exit)?;
            if !last {
                self.rung(&[], &format!("(JMP {end})"))?;
                self.out.push_str(&format!("{next}:\n"));
            }
        }
        self.statements(otherwise, &[], exit)?;
        self.out.push_str(&format!("{end}:\n"));
        Some(())
    }
}

/// A wire with the contacts of an expression, or of its complement.
fn wire(e: &Expr, complement: bool) -> String {
    match &e.kind {
        ExprKind::Literal(Literal::Bool(b)) if *b != complement => "--".to_string(),
        ExprKind::Unary(UnaryOp::Not, inner) => wire(inner, !complement),
        ExprKind::Unary(op @ (UnaryOp::Rise | UnaryOp::Fall), inner)
            if !complement && matches!(inner.kind, ExprKind::Path(_) | ExprKind::Direct(_)) =>
        {
            let sign = if *op == UnaryOp::Rise { "P" } else { "N" };
            format!("--[{sign} {}]", print_expr(inner))
        }
        ExprKind::Binary(op @ (BinaryOp::And | BinaryOp::Dot | BinaryOp::Or), a, b) => {
            let series = (*op != BinaryOp::Or) != complement;
            if series {
                wire(a, complement) + &wire(b, complement)
            } else {
                let mut ways = Vec::new();
                ways_of(e, complement, &mut ways);
                parallel(&ways)
            }
        }
        ExprKind::Binary(BinaryOp::Xor, a, b) if size(a) + size(b) <= MOST_IN_XOR => {
            parallel(&[wire(a, complement) + &wire(b, true), wire(a, !complement) + &wire(b, false)])
        }
        ExprKind::Binary(op, a, b) if complement => match opposite(*op) {
            Some(op) => contact(&Expr { kind: ExprKind::Binary(op, a.clone(), b.clone()), at: e.at }, false),
            None => contact(e, true),
        },
        _ => contact(e, complement),
    }
}

/// The ways of a chain of ors (or of the complement of a chain of ands).
fn ways_of(e: &Expr, complement: bool, ways: &mut Vec<String>) {
    match &e.kind {
        ExprKind::Unary(UnaryOp::Not, inner) => ways_of(inner, !complement, ways),
        ExprKind::Binary(op @ (BinaryOp::And | BinaryOp::Dot | BinaryOp::Or), a, b)
            if (*op == BinaryOp::Or) != complement =>
        {
            ways_of(a, complement, ways);
            ways_of(b, complement, ways);
        }
        _ => ways.push(wire(e, complement)),
    }
}

fn parallel(ways: &[String]) -> String {
    let ways: Vec<&str> =
        ways.iter().map(|w| w.strip_prefix("--").filter(|r| !r.is_empty()).unwrap_or(w)).collect();
    format!("--{{ {} }}", ways.join(" | "))
}

fn opposite(op: BinaryOp) -> Option<BinaryOp> {
    Some(match op {
        BinaryOp::Eq => BinaryOp::Ne,
        BinaryOp::Ne => BinaryOp::Eq,
        _ => return None,
    })
}

fn contact(e: &Expr, complement: bool) -> String {
    let text = print_expr(e);
    let simple =
        matches!(e.kind, ExprKind::Path(_) | ExprKind::Direct(_) | ExprKind::Call(..) | ExprKind::Literal(_));
    match (complement, simple) {
        (false, _) => format!("--[{text}]"),
        (true, true) => format!("--[/{text}]"),
        (true, false) => format!("--[/({text})]"),
    }
}

/// How many contacts an expression takes.
fn size(e: &Expr) -> usize {
    match &e.kind {
        ExprKind::Unary(UnaryOp::Not, inner) => size(inner),
        ExprKind::Binary(BinaryOp::And | BinaryOp::Or | BinaryOp::Dot, a, b) => size(a) + size(b),
        ExprKind::Binary(BinaryOp::Xor, a, b) => 2 * (size(a) + size(b)),
        _ => 1,
    }
}
