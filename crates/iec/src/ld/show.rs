//! Prints Structured Text as Ladder.

use g7_model::{BinaryOp, Expr, ExprKind, Literal, Stmt, StmtKind, UnaryOp};

use crate::st::Spelling;
use crate::terms::not;

/// The most contacts of an exclusive or that is drawn as two branches; a larger one becomes one
/// contact.
const MOST_IN_XOR: usize = 4;
/// The most text: nested conditions are repeated on every rung.
const MOST_SHOWN: usize = 200_000;

/// Prints the wire through which power flows while the expression is true. `spell` prints the
/// contacts.
pub fn show_expr(e: &Expr, spell: Spelling) -> String {
    wire(e, false, spell)
}

/// Prints rungs that do what the statements do. Returns None if a statement has no form in the
/// language (FOR, CASE).
///
/// `spell` prints contacts and coils. `boolean` tells whether a variable or call is a BOOL; an
/// assignment of any other type is not a coil.
pub fn show(statements: &[Stmt], spell: Spelling, boolean: &dyn Fn(&Expr) -> bool) -> Option<String> {
    let mut shower = Shower { out: String::new(), labels: 0, spell, boolean };
    shower.statements(statements, &[], None)?;
    Some(shower.out)
}

struct Shower<'a> {
    out: String,
    labels: usize,
    spell: Spelling<'a>,
    boolean: &'a dyn Fn(&Expr) -> bool,
}

impl Shower<'_> {
    /// Writes a rung with its power and its coil.
    fn rung(&mut self, power: &[Expr], coil: &str) -> Option<()> {
        for e in power {
            self.out.push_str(&wire(e, false, self.spell));
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

    /// `power` holds the conditions around the statements; `exit` is the label to which EXIT jumps.
    fn statements(&mut self, list: &[Stmt], power: &[Expr], exit: Option<&str>) -> Option<()> {
        list.iter().try_for_each(|s| self.statement(s, power, exit))
    }

    fn statement(&mut self, stmt: &Stmt, power: &[Expr], exit: Option<&str>) -> Option<()> {
        match &stmt.kind {
            StmtKind::Assign { target, value } => self.assign(target, value, power),
            StmtKind::Call(path, args) => {
                let call = Expr { kind: ExprKind::Call(path.clone(), args.clone()), at: stmt.at };
                self.rung(power, &format!("({})", (self.spell)(&call)))
            }
            StmtKind::If(arms, otherwise) => self.conditions(arms, otherwise, power, exit),
            StmtKind::Return => self.rung(power, "(RET)"),
            StmtKind::Exit => self.rung(power, &format!("(JMP {})", exit?)),
            StmtKind::While(condition, body) if power.is_empty() => {
                let (start, end) = (self.label(), self.label());
                self.out.push_str(&format!("{start}: "));
                self.rung(&[not(condition.clone())], &format!("(JMP {end})"))?;
                self.statements(body, &[], Some(&end))?;
                self.rung(&[], &format!("(JMP {start})"))?;
                self.out.push_str(&format!("{end}:\n"));
                Some(())
            }
            StmtKind::Repeat(body, condition) if power.is_empty() => {
                let (start, end) = (self.label(), self.label());
                self.out.push_str(&format!("{start}:\n"));
                self.statements(body, &[], Some(&end))?;
                self.rung(&[not(condition.clone())], &format!("(JMP {start})"))?;
                self.out.push_str(&format!("{end}:\n"));
                Some(())
            }
            StmtKind::While(..) | StmtKind::Repeat(..) | StmtKind::Case(..) | StmtKind::For { .. } => None,
        }
    }

    fn assign(&mut self, target: &Expr, value: &Expr, power: &[Expr]) -> Option<()> {
        let name = (self.spell)(target);
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
            None => self.rung(power, &format!("({name} := {})", (self.spell)(value))),
        }
    }

    /// True if the expression is Boolean, judged by its form or by the types of its names.
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
            ExprKind::Path(_) | ExprKind::Element(..) | ExprKind::Direct(_) | ExprKind::Call(..) => {
                (self.boolean)(e)
            }
            ExprKind::Literal(_) | ExprKind::List(_) | ExprKind::Bad => false,
        }
    }

    /// A condition of a single statement becomes the power of its rung. Longer bodies are skipped
    /// by a jump, because their statements may change the condition.
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
            self.rung(&[not(condition.clone())], &format!("(JMP {next})"))?;
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

/// A wire with the contacts of an expression or of its complement.
fn wire(e: &Expr, complement: bool, spell: Spelling) -> String {
    match &e.kind {
        ExprKind::Literal(Literal::Bool(b)) if *b != complement => "--".to_string(),
        ExprKind::Unary(UnaryOp::Not, inner) => wire(inner, !complement, spell),
        ExprKind::Unary(op @ (UnaryOp::Rise | UnaryOp::Fall), inner)
            if !complement && matches!(inner.kind, ExprKind::Path(_) | ExprKind::Direct(_)) =>
        {
            let sign = if *op == UnaryOp::Rise { "P" } else { "N" };
            format!("--[{sign} {}]", spell(inner))
        }
        ExprKind::Binary(op @ (BinaryOp::And | BinaryOp::Dot | BinaryOp::Or), a, b) => {
            let series = (*op != BinaryOp::Or) != complement;
            if series {
                wire(a, complement, spell) + &wire(b, complement, spell)
            } else {
                let mut ways = Vec::new();
                ways_of(e, complement, &mut ways, spell);
                parallel(&ways)
            }
        }
        ExprKind::Binary(BinaryOp::Xor, a, b) if size(a) + size(b) <= MOST_IN_XOR => parallel(&[
            wire(a, complement, spell) + &wire(b, true, spell),
            wire(a, !complement, spell) + &wire(b, false, spell),
        ]),
        ExprKind::Binary(op, a, b) if complement => match opposite(*op) {
            Some(op) => {
                contact(&Expr { kind: ExprKind::Binary(op, a.clone(), b.clone()), at: e.at }, false, spell)
            }
            None => contact(e, true, spell),
        },
        _ => contact(e, complement, spell),
    }
}

/// Collects the branches of a chain of ors (or of the complement of a chain of ands).
fn ways_of(e: &Expr, complement: bool, ways: &mut Vec<String>, spell: Spelling) {
    match &e.kind {
        ExprKind::Unary(UnaryOp::Not, inner) => ways_of(inner, !complement, ways, spell),
        ExprKind::Binary(op @ (BinaryOp::And | BinaryOp::Dot | BinaryOp::Or), a, b)
            if (*op == BinaryOp::Or) != complement =>
        {
            ways_of(a, complement, ways, spell);
            ways_of(b, complement, ways, spell);
        }
        _ => ways.push(wire(e, complement, spell)),
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

fn contact(e: &Expr, complement: bool, spell: Spelling) -> String {
    let text = spell(e);
    let simple =
        matches!(e.kind, ExprKind::Path(_) | ExprKind::Direct(_) | ExprKind::Call(..) | ExprKind::Literal(_));
    match (complement, simple) {
        (false, _) => format!("--[{text}]"),
        (true, true) => format!("--[/{text}]"),
        (true, false) => format!("--[/({text})]"),
    }
}

/// The number of contacts that an expression takes.
fn size(e: &Expr) -> usize {
    match &e.kind {
        ExprKind::Unary(UnaryOp::Not, inner) => size(inner),
        ExprKind::Binary(BinaryOp::And | BinaryOp::Or | BinaryOp::Dot, a, b) => size(a) + size(b),
        ExprKind::Binary(BinaryOp::Xor, a, b) => 2 * (size(a) + size(b)),
        _ => 1,
    }
}
