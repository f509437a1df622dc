//! Structured Text as IEC 61131-3 has it, of the document's statements.

use std::fmt::Write;

use g7_model::codes;
use g7_model::{Arg, BinaryOp, Expr, ExprKind, Literal, Path, Place, Problem, Stmt, StmtKind, Type, UnaryOp};

use super::names::{Names, Scope};

/// Writes code in the names of one unit.
pub(super) struct Text<'a> {
    pub(super) names: &'a mut Names,
    pub(super) scope: Scope<'a>,
    pub(super) problems: &'a mut Vec<Problem>,
}

/// How tightly an expression binds; the operand of an operator needs as much.
const ATOM: u8 = 10;

impl Text<'_> {
    fn not_carried(&mut self, at: Place, what: &str) {
        self.problems.push(Problem::new(&codes::NOT_CARRIED, at.0, what));
    }

    /// An expression.
    pub(super) fn expr(&mut self, expr: &Expr) -> String {
        self.tree(expr).0
    }

    /// An expression, in brackets where it binds less than `least`.
    fn operand(&mut self, expr: &Expr, least: u8) -> String {
        let (text, strength) = self.tree(expr);
        if strength < least { format!("({text})") } else { text }
    }

    fn tree(&mut self, expr: &Expr) -> (String, u8) {
        match &expr.kind {
            ExprKind::Literal(l) => literal(l),
            ExprKind::Path(path) => (self.path(path, expr.at), ATOM),
            ExprKind::Direct(address) => (format!("%{address}"), ATOM),
            ExprKind::Unary(UnaryOp::Not, e) => (format!("NOT {}", self.operand(e, 9)), 9),
            ExprKind::Unary(UnaryOp::Neg, e) => (format!("-{}", self.operand(e, ATOM)), 9),
            ExprKind::Unary(UnaryOp::Rise | UnaryOp::Fall, e) => {
                let what =
                    "an edge within an expression: IEC 61131-3 has the blocks R_TRIG and F_TRIG for it";
                self.not_carried(expr.at, what);
                (self.operand(e, ATOM), ATOM)
            }
            ExprKind::Binary(op, a, b) => self.binary(*op, a, b),
            ExprKind::Timer { t1, e, t2 } => self.timer(expr, t1, e, t2.as_deref()),
            ExprKind::Call(path, args) => (self.call(path, args, expr.at), ATOM),
            ExprKind::Bad => ("FALSE".to_string(), ATOM),
        }
    }

    fn binary(&mut self, op: BinaryOp, a: &Expr, b: &Expr) -> (String, u8) {
        let truth = self.scope.is_bool(a) || self.scope.is_bool(b);
        let (sign, strength) = match op {
            BinaryOp::Or => ("OR", 1),
            BinaryOp::Xor => ("XOR", 2),
            BinaryOp::And | BinaryOp::Dot => ("AND", 3),
            // GRAFCET's way to write OR and AND of Booleans.
            BinaryOp::Add if truth => ("OR", 1),
            BinaryOp::Mul if truth => ("AND", 3),
            BinaryOp::Eq => ("=", 4),
            BinaryOp::Ne => ("<>", 4),
            BinaryOp::Lt => ("<", 5),
            BinaryOp::Le => ("<=", 5),
            BinaryOp::Gt => (">", 5),
            BinaryOp::Ge => (">=", 5),
            BinaryOp::Add => ("+", 6),
            BinaryOp::Sub => ("-", 6),
            BinaryOp::Mul => ("*", 7),
            BinaryOp::Div => ("/", 7),
            BinaryOp::Mod => ("MOD", 7),
            BinaryOp::Pow => ("**", 8),
        };
        let left = self.operand(a, strength);
        let right = self.operand(b, strength + 1);
        (format!("{left} {sign} {right}"), strength)
    }

    /// `t/X12` is a comparison of the step's time; other time operators have no counterpart.
    fn timer(&mut self, whole: &Expr, t1: &Expr, e: &Expr, t2: Option<&Expr>) -> (String, u8) {
        if let (ExprKind::Path(path), None) = (&e.kind, t2)
            && let Some(step) = self.names.step_of(&self.scope, path)
        {
            let time = self.operand(t1, 6);
            return (format!("{step}.X AND {step}.T >= {time}"), 3);
        }
        let what = "a time operator `t1/e/t2`: IEC 61131-3 has the blocks TON and TOF for it";
        self.not_carried(whole.at, what);
        (self.operand(e, ATOM), ATOM)
    }

    fn path(&mut self, path: &Path, at: Place) -> String {
        match self.names.path(&self.scope, path) {
            Ok(text) => text,
            Err(what) => {
                self.not_carried(at, &what);
                path.text().replace('.', "_")
            }
        }
    }

    fn call(&mut self, path: &Path, args: &[Arg], at: Place) -> String {
        const SERVICES: [&str; 6] =
            ["INITCHART", "CLEARCHART", "FREEZECHART", "SETSTEP", "RESETSTEP", "RESET_XIT"];
        let name = path.text();
        if SERVICES.iter().any(|s| name.eq_ignore_ascii_case(s)) {
            self.not_carried(at, &format!("`{name}`, which IEC 61131-3 does not have"));
        }
        let args: Vec<String> = args
            .iter()
            .map(|arg| {
                let value = self.expr(&arg.value);
                match &arg.name {
                    Some(n) if arg.output => format!("{} => {value}", n.text),
                    Some(n) => format!("{} := {value}", n.text),
                    None => value,
                }
            })
            .collect();
        let name = self.path(path, at);
        format!("{name}({})", args.join(", "))
    }

    /// Statements, one a line.
    pub(super) fn statements(&mut self, statements: &[Stmt]) -> String {
        let mut text = String::new();
        self.lines(statements, 0, &mut text);
        text.truncate(text.trim_end().len());
        text
    }

    fn lines(&mut self, statements: &[Stmt], level: usize, text: &mut String) {
        let blanks = "  ".repeat(level);
        for statement in statements {
            match &statement.kind {
                StmtKind::Assign { target, value } => {
                    let (target, value) = (self.expr(target), self.expr(value));
                    let _ = writeln!(text, "{blanks}{target} := {value};");
                }
                StmtKind::Call(path, args) => {
                    let call = self.call(path, args, statement.at);
                    let _ = writeln!(text, "{blanks}{call};");
                }
                StmtKind::If(branches, otherwise) => {
                    for (index, (condition, body)) in branches.iter().enumerate() {
                        let word = if index == 0 { "IF" } else { "ELSIF" };
                        let condition = self.expr(condition);
                        let _ = writeln!(text, "{blanks}{word} {condition} THEN");
                        self.lines(body, level + 1, text);
                    }
                    self.otherwise(otherwise, level, text);
                    let _ = writeln!(text, "{blanks}END_IF;");
                }
                StmtKind::Case(selector, arms, otherwise) => {
                    let selector = self.expr(selector);
                    let _ = writeln!(text, "{blanks}CASE {selector} OF");
                    for arm in arms {
                        let labels: Vec<String> = arm
                            .labels
                            .iter()
                            .map(|(from, to)| match to {
                                Some(to) => format!("{}..{}", self.expr(from), self.expr(to)),
                                None => self.expr(from),
                            })
                            .collect();
                        let _ = writeln!(text, "{blanks}  {}:", labels.join(", "));
                        self.lines(&arm.body, level + 2, text);
                    }
                    self.otherwise(otherwise, level, text);
                    let _ = writeln!(text, "{blanks}END_CASE;");
                }
                StmtKind::For { var, from, to, by, body } => {
                    let path = Path { names: vec![var.clone()] };
                    let var = self.path(&path, var.at);
                    let (from, to) = (self.expr(from), self.expr(to));
                    let by = by.as_ref().map(|b| format!(" BY {}", self.expr(b))).unwrap_or_default();
                    let _ = writeln!(text, "{blanks}FOR {var} := {from} TO {to}{by} DO");
                    self.lines(body, level + 1, text);
                    let _ = writeln!(text, "{blanks}END_FOR;");
                }
                StmtKind::While(condition, body) => {
                    let condition = self.expr(condition);
                    let _ = writeln!(text, "{blanks}WHILE {condition} DO");
                    self.lines(body, level + 1, text);
                    let _ = writeln!(text, "{blanks}END_WHILE;");
                }
                StmtKind::Repeat(body, until) => {
                    let _ = writeln!(text, "{blanks}REPEAT");
                    self.lines(body, level + 1, text);
                    let until = self.expr(until);
                    let _ = writeln!(text, "{blanks}UNTIL {until}\n{blanks}END_REPEAT;");
                }
                StmtKind::Exit => {
                    let _ = writeln!(text, "{blanks}EXIT;");
                }
                StmtKind::Return => {
                    let _ = writeln!(text, "{blanks}RETURN;");
                }
            }
        }
    }

    fn otherwise(&mut self, body: &[Stmt], level: usize, text: &mut String) {
        if !body.is_empty() {
            let _ = writeln!(text, "{}ELSE", "  ".repeat(level));
            self.lines(body, level + 1, text);
        }
    }
}

fn literal(literal: &Literal) -> (String, u8) {
    let typed = |ty: &Option<Type>, text: String| match ty {
        Some(ty) => format!("{ty}#{text}"),
        None => text,
    };
    match literal {
        Literal::Bool(true) => ("TRUE".into(), ATOM),
        Literal::Bool(false) => ("FALSE".into(), ATOM),
        Literal::Int(n, ty) => (typed(ty, n.to_string()), if *n < 0 && ty.is_none() { 9 } else { ATOM }),
        Literal::Real(text, ty) => (typed(ty, text.to_string()), ATOM),
        Literal::Time(ns) => (duration(*ns), ATOM),
        Literal::Str(text) => (string(text), ATOM),
    }
}

/// A duration as IEC 61131-3 writes it.
pub(super) fn duration(ns: i64) -> String {
    let mut text = String::from(if ns < 0 { "T#-" } else { "T#" });
    let mut rest = ns.unsigned_abs();
    for (unit, size) in
        [("d", 86_400_000_000_000), ("h", 3_600_000_000_000), ("m", 60_000_000_000), ("s", 1_000_000_000)]
    {
        let count: u64 = rest / size;
        rest %= size;
        if count > 0 {
            let _ = write!(text, "{count}{unit}");
        }
    }
    let (ms, below) = (rest / 1_000_000, rest % 1_000_000);
    if below > 0 {
        let fraction = format!("{below:06}");
        let _ = write!(text, "{ms}.{}ms", fraction.trim_end_matches('0'));
    } else if ms > 0 || text.ends_with(['#', '-']) {
        let _ = write!(text, "{ms}ms");
    }
    text
}

/// Text in quotes; what has no letter of its own as `$` and its number.
fn string(value: &str) -> String {
    let mut text = String::from("'");
    for c in value.chars() {
        match c {
            '$' => text.push_str("$$"),
            '\'' => text.push_str("$'"),
            '\n' => text.push_str("$N"),
            '\r' => text.push_str("$R"),
            '\t' => text.push_str("$T"),
            c if u32::from(c) < 32 => {
                let _ = write!(text, "${:02X}", u32::from(c));
            }
            c => text.push(c),
        }
    }
    text.push('\'');
    text
}
