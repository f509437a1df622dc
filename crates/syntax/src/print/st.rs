//! Blocks and statements of Structured Text.

use super::Printer;
use g7_model::{Block, Body, BodyLang, CaseArm, Expr, ExprKind, Literal, Local, Stmt, StmtKind, Work};

impl Printer<'_> {
    /// Prints `{ … }`, on the current line if it is short and has one statement.
    pub(super) fn block(&mut self, block: &Block) {
        let at = block.at.0;
        let short = match block.statements.as_slice() {
            [one] => block.locals.is_empty() && is_short(&one.kind) && !self.notes_in(at),
            _ => false,
        };
        if short && self.try_inline(|p| p.short_block(&block.statements)) {
            return;
        }
        let locals = block.locals.first().map(|l| l.at.0.start);
        let first = locals.or(block.statements.first().map(|s| s.at.0.start));
        self.braces(at, first, |p| {
            for local in &block.locals {
                p.line(local.at.0, false, |p| p.local(local));
            }
            p.statements(&block.statements);
        });
    }

    fn short_block(&mut self, statements: &[Stmt]) {
        self.push("{ ");
        for statement in statements {
            self.statement(statement);
        }
        self.push(" }");
    }

    fn local(&mut self, local: &Local) {
        self.push("var ");
        self.names(&local.names);
        self.value_type(&local.ty);
        self.initial(local.init.as_ref());
    }

    /// ` := e`, if there is a value.
    pub(super) fn initial(&mut self, value: Option<&Expr>) {
        if let Some(value) = value {
            self.push(" := ");
            self.expr(value);
        }
    }

    /// The body of a named action or of a section, behind a blank.
    pub(super) fn body(&mut self, body: &Body) {
        match body {
            Body::St(block) => self.block(block),
            Body::Other(lang, text, _) => {
                self.push(match lang {
                    BodyLang::Il => "il {",
                    BodyLang::Ld => "ld {",
                });
                self.push(text);
                self.push("}");
            }
        }
    }

    /// Prints the work of an action.
    pub(super) fn work(&mut self, work: &Work) {
        match work {
            Work::Single(statement) => self.statement(statement),
            Work::Block(block) => self.block(block),
        }
    }

    pub(super) fn statements(&mut self, statements: &[Stmt]) {
        for statement in statements {
            if is_short(&statement.kind) {
                self.line(statement.at.0, false, |p| p.statement(statement));
            } else {
                self.group(statement.at.0, false, |p| p.statement(statement));
            }
        }
    }

    fn statement(&mut self, statement: &Stmt) {
        match &statement.kind {
            StmtKind::Assign { target, value } => {
                self.expr(target);
                self.push(" := ");
                self.expr(value);
            }
            StmtKind::Call(path, args) => self.call(path, args),
            StmtKind::If(arms, otherwise) => self.if_statement(statement, arms, otherwise),
            StmtKind::Case(selector, arms, otherwise) => {
                self.case_statement(statement, selector, arms, otherwise);
            }
            StmtKind::For { var, from, to, by, body } => {
                self.push("FOR ");
                self.name(&var.text);
                self.push(" := ");
                self.expr(from);
                self.push(" TO ");
                self.expr(to);
                if let Some(by) = by {
                    self.push(" BY ");
                    self.expr(by);
                }
                self.push(" DO");
                self.nested(statement, body);
                self.push("END_FOR");
            }
            StmtKind::While(condition, body) => {
                self.push("WHILE ");
                self.expr(condition);
                self.push(" DO");
                self.nested(statement, body);
                self.push("END_WHILE");
            }
            StmtKind::Repeat(body, condition) => {
                self.push("REPEAT");
                self.nested(statement, body);
                self.push("UNTIL ");
                self.expr(condition);
                self.push(" END_REPEAT");
            }
            StmtKind::Exit => self.push("EXIT"),
            StmtKind::Return => self.push("RETURN"),
        }
    }

    /// Prints the last statements of a construct, and the start of the line that ends it.
    fn nested(&mut self, whole: &Stmt, body: &[Stmt]) {
        self.header_end(whole, body);
        self.inside(whole.at.0, |p| p.statements(body));
        self.start_line();
    }

    /// Ends a line such as `WHILE a DO`.
    fn header_end(&mut self, whole: &Stmt, body: &[Stmt]) {
        let limit = body.first().map_or(whole.at.0.end, |s| s.at.0.start);
        self.notes_behind(whole.at.0.start, Some(limit));
        self.push("\n");
    }

    fn if_statement(&mut self, whole: &Stmt, arms: &[(Expr, Vec<Stmt>)], otherwise: &[Stmt]) {
        for (i, (condition, body)) in arms.iter().enumerate() {
            self.push(if i == 0 { "IF " } else { "ELSIF " });
            self.expr(condition);
            self.push(" THEN");
            let last = i + 1 == arms.len() && otherwise.is_empty();
            self.arm(whole, body, last);
        }
        if !otherwise.is_empty() {
            self.push("ELSE");
            self.arm(whole, otherwise, true);
        }
        self.push("END_IF");
    }

    /// The statements of one arm; the notes after them belong to it only if it is the last one.
    fn arm(&mut self, whole: &Stmt, body: &[Stmt], last: bool) {
        if last {
            return self.nested(whole, body);
        }
        self.header_end(whole, body);
        self.indent += 1;
        self.last_end = None;
        self.statements(body);
        self.indent -= 1;
        self.start_line();
    }

    fn case_statement(&mut self, whole: &Stmt, selector: &Expr, arms: &[CaseArm], otherwise: &[Stmt]) {
        self.push("CASE ");
        self.expr(selector);
        self.push(" OF\n");
        self.indent += 1;
        self.last_end = None;
        for arm in arms {
            let start = arm.labels.first().map_or(whole.at.0, |(label, _)| label.at.0);
            self.notes_before(start.start, false);
            self.start_line();
            self.labels(&arm.labels);
            self.push(":\n");
            self.indent += 1;
            self.last_end = None;
            self.statements(&arm.body);
            self.indent -= 1;
        }
        self.indent -= 1;
        if otherwise.is_empty() {
            self.inside(whole.at.0, |_| {});
        } else {
            self.start_line();
            self.push("ELSE\n");
            self.inside(whole.at.0, |p| p.statements(otherwise));
        }
        self.start_line();
        self.push("END_CASE");
    }

    fn labels(&mut self, labels: &[(Expr, Option<Expr>)]) {
        for (i, (first, last)) in labels.iter().enumerate() {
            self.push(if i > 0 { ", " } else { "" });
            self.label(first);
            if let Some(last) = last {
                self.push("..");
                self.label(last);
            }
        }
    }

    /// A value of a CASE: in parentheses where it could be read as a statement.
    fn label(&mut self, label: &Expr) {
        let plain = match &label.kind {
            ExprKind::Literal(Literal::Int(v, None)) => *v >= 0,
            ExprKind::Literal(_) | ExprKind::Path(_) => true,
            _ => false,
        };
        if plain {
            self.expr(label);
        } else {
            self.push("(");
            self.expr(label);
            self.push(")");
        }
    }
}

/// True if a statement needs only one line.
fn is_short(kind: &StmtKind) -> bool {
    matches!(kind, StmtKind::Assign { .. } | StmtKind::Call(..) | StmtKind::Exit | StmtKind::Return)
}
