//! Prints Structured Text as an Instruction List.

use g7_model::{Arg, BinaryOp, Expr, ExprKind, Literal, Operands, Path, Place, Stmt, StmtKind, UnaryOp};

use crate::st::Spelling;

/// Prints a list whose last result is the expression. `spell` prints the operands.
pub fn show_expr(e: &Expr, spell: Spelling) -> String {
    let mut shower = Shower::new(spell);
    shower.value(e);
    shower.out
}

/// Prints a list that does what the statements do. `spell` prints the operands.
///
/// Returns None if a statement has no form in the language (FOR, CASE).
pub fn show(statements: &[Stmt], spell: Spelling) -> Option<String> {
    let mut shower = Shower::new(spell);
    shower.statements(statements, None)?;
    Some(shower.out)
}

struct Shower<'s> {
    out: String,
    indent: usize,
    labels: usize,
    spell: Spelling<'s>,
}

/// The operator of an operation, and whether its operand may be complemented; the list has no EXPT.
fn operator(op: BinaryOp) -> Option<(&'static str, bool)> {
    let row = op.row();
    (op != BinaryOp::Pow).then_some((row.function, row.operands == Operands::Logic))
}

impl<'s> Shower<'s> {
    fn new(spell: Spelling<'s>) -> Shower<'s> {
        Shower { out: String::new(), indent: 0, labels: 0, spell }
    }

    /// An operand as written behind an operator, if the expression is one.
    fn operand(&self, e: &Expr) -> Option<String> {
        match &e.kind {
            ExprKind::Literal(_)
            | ExprKind::Path(_)
            | ExprKind::Element(..)
            | ExprKind::Direct(_)
            | ExprKind::Call(..) => Some((self.spell)(e)),
            ExprKind::Timer { .. } => Some((self.spell)(e)),
            ExprKind::Unary(UnaryOp::Rise | UnaryOp::Fall, _) => Some((self.spell)(e)),
            ExprKind::Unary(UnaryOp::Neg, inner) if matches!(inner.kind, ExprKind::Literal(_)) => {
                Some((self.spell)(e))
            }
            ExprKind::Unary(..) | ExprKind::Binary(..) | ExprKind::List(_) | ExprKind::Bad => None,
        }
    }

    fn line(&mut self, text: &str) {
        for _ in 0..self.indent {
            self.out.push_str("  ");
        }
        self.out.push_str(text);
        self.out.push('\n');
    }

    /// Writes lines after which the current result is the expression.
    fn value(&mut self, e: &Expr) {
        if let Some(text) = self.operand(e) {
            return self.line(&format!("LD {text}"));
        }
        match &e.kind {
            ExprKind::Unary(UnaryOp::Not, inner) => match self.operand(inner) {
                Some(text) => self.line(&format!("LDN {text}")),
                None => {
                    self.value(inner);
                    self.line("NOT");
                }
            },
            ExprKind::Binary(op, a, b) => match operator(*op) {
                Some((word, complement)) => {
                    self.value(a);
                    self.operation(word, complement, b);
                }
                None => self.line(&format!("LD ({})", (self.spell)(e))),
            },
            _ => self.line(&format!("LD ({})", (self.spell)(e))),
        }
    }

    fn operation(&mut self, word: &str, complement: bool, e: &Expr) {
        let (word, e) = match &e.kind {
            ExprKind::Unary(UnaryOp::Not, inner) if complement => (format!("{word}N"), &**inner),
            _ => (word.to_string(), e),
        };
        match self.operand(e) {
            Some(text) => self.line(&format!("{word} {text}")),
            None => {
                self.line(&format!("{word}("));
                self.indent += 1;
                self.value(e);
                self.indent -= 1;
                self.line(")");
            }
        }
    }

    fn label(&mut self) -> String {
        self.labels += 1;
        format!("L{}", self.labels)
    }

    /// `exit` is the label to which EXIT jumps.
    fn statements(&mut self, list: &[Stmt], exit: Option<&str>) -> Option<()> {
        list.iter().try_for_each(|s| self.statement(s, exit))
    }

    fn statement(&mut self, stmt: &Stmt, exit: Option<&str>) -> Option<()> {
        match &stmt.kind {
            StmtKind::Assign { target, value } => self.assign(target, value),
            StmtKind::Call(path, args) => {
                self.line(&format!("CAL {}", self.call(path, args, stmt.at)));
            }
            StmtKind::If(arms, otherwise) => return self.conditions(arms, otherwise, exit),
            StmtKind::While(condition, body) => {
                let (start, end) = (self.label(), self.label());
                self.line(&format!("{start}:"));
                if condition.kind != ExprKind::Literal(Literal::Bool(true)) {
                    self.value(condition);
                    self.line(&format!("JMPCN {end}"));
                }
                self.statements(body, Some(&end))?;
                self.line(&format!("JMP {start}"));
                self.line(&format!("{end}:"));
            }
            StmtKind::Repeat(body, condition) => {
                let (start, end) = (self.label(), self.label());
                self.line(&format!("{start}:"));
                self.statements(body, Some(&end))?;
                self.value(condition);
                self.line(&format!("JMPCN {start}"));
                self.line(&format!("{end}:"));
            }
            StmtKind::Exit => self.line(&format!("JMP {}", exit?)),
            StmtKind::Return => self.line("RET"),
            StmtKind::Case(..) | StmtKind::For { .. } => return None,
        }
        Some(())
    }

    fn assign(&mut self, target: &Expr, value: &Expr) {
        let target = (self.spell)(target);
        if let ExprKind::Unary(UnaryOp::Not, inner) = &value.kind
            && self.operand(inner).is_none()
        {
            self.value(inner);
            return self.line(&format!("STN {target}"));
        }
        self.value(value);
        self.line(&format!("ST {target}"));
    }

    fn conditions(
        &mut self,
        arms: &[(Expr, Vec<Stmt>)],
        otherwise: &[Stmt],
        exit: Option<&str>,
    ) -> Option<()> {
        if let [(condition, body)] = arms
            && otherwise.is_empty()
            && self.short(condition, body)
        {
            return Some(());
        }
        let end = self.label();
        let mut needs_end = false;
        for (index, (condition, body)) in arms.iter().enumerate() {
            let last = index + 1 == arms.len() && otherwise.is_empty();
            let next = if last { end.clone() } else { self.label() };
            needs_end |= last;
            self.value(condition);
            self.line(&format!("JMPCN {next}"));
            self.statements(body, exit)?;
            if !last {
                needs_end = true;
                self.line(&format!("JMP {end}"));
                self.line(&format!("{next}:"));
            }
        }
        self.statements(otherwise, exit)?;
        if needs_end {
            self.line(&format!("{end}:"));
        }
        Some(())
    }

    /// Writes `S`, `R`, `CALC` and `RETC` where the statement is one of these.
    fn short(&mut self, condition: &Expr, body: &[Stmt]) -> bool {
        let [only] = body else { return false };
        let line = match &only.kind {
            StmtKind::Assign { target, value } => match &value.kind {
                ExprKind::Literal(Literal::Bool(true)) => format!("S {}", (self.spell)(target)),
                ExprKind::Literal(Literal::Bool(false)) => format!("R {}", (self.spell)(target)),
                _ => return false,
            },
            StmtKind::Call(path, args) => {
                format!("CALC {}", self.call(path, args, only.at))
            }
            StmtKind::Return => "RETC".to_string(),
            _ => return false,
        };
        self.value(condition);
        self.line(&line);
        true
    }

    fn call(&self, path: &Path, args: &[Arg], at: Place) -> String {
        (self.spell)(&Expr { kind: ExprKind::Call(path.clone(), args.to_vec()), at })
    }
}
