//! Expressions of Structured Text.

use g7_model::codes;
use g7_model::{Arg, BinaryOp, Expr, ExprKind, Name, Path, Said, Span, Type, UnaryOp, say};

use super::lex::Kind;
use super::parse::Parser;
use crate::{nodes, signs};

/// The largest height of an expression's tree. Later stages recurse over it.
const MOST_HIGH: u32 = 400;

/// An expression, with the height of its tree.
pub(crate) struct Tree {
    pub(crate) expr: Expr,
    pub(crate) height: u32,
}

impl Parser<'_> {
    /// Reads an expression; returns `Bad` with a problem if there is none.
    pub(crate) fn expr(&mut self) -> Expr {
        self.tree(1).expr
    }

    fn tree(&mut self, least: u8) -> Tree {
        let mut left = self.unary();
        while let Some(op) = self.operator().filter(|op| op.strength() >= least) {
            self.bump();
            let right = self.tree(op.strength() + 1);
            left = self.join(op, left, right);
        }
        left
    }

    fn operator(&self) -> Option<BinaryOp> {
        let token = self.token();
        let text = self.slice(token);
        let upper = text.to_ascii_uppercase();
        match (token.kind, upper.as_str()) {
            // Further forms of CODESYS and other languages.
            (Kind::Sign, "==") => Some(BinaryOp::Eq),
            (Kind::Sign, "!=") => Some(BinaryOp::Ne),
            (Kind::Sign, "&" | "&&") | (Kind::Word, "AND_THEN") => Some(BinaryOp::And),
            (Kind::Sign, "||") | (Kind::Word, "OR_ELSE") => Some(BinaryOp::Or),
            (Kind::Sign | Kind::Word, sign) => BinaryOp::of_standard(sign),
            _ => None,
        }
    }

    pub(crate) fn join(&mut self, op: BinaryOp, left: Tree, right: Tree) -> Tree {
        let at = left.expr.at.0.to(right.expr.at.0);
        let height = left.height.max(right.height) + 1;
        let kind = ExprKind::Binary(op, Box::new(left.expr), Box::new(right.expr));
        self.bounded(kind, at, height)
    }

    pub(crate) fn bounded(&mut self, kind: ExprKind, at: Span, height: u32) -> Tree {
        if height <= MOST_HIGH {
            return Tree { expr: Expr { kind, at: at.into() }, height };
        }
        let here = self.here();
        self.say(&codes::TOO_DEEP, &here, say!("an expression more than {MOST_HIGH} operators deep"));
        Tree { expr: Expr { kind: ExprKind::Bad, at: at.into() }, height: 1 }
    }

    fn unary(&mut self) -> Tree {
        let mut ops = Vec::new();
        loop {
            let op = match self.word().as_str() {
                "NOT" => Some(UnaryOp::Not),
                _ if self.at("!") => Some(UnaryOp::Not),
                _ if self.at("-") => Some(UnaryOp::Neg),
                _ if self.at("+") => None,
                _ => break,
            };
            ops.push((op, self.bump()));
        }
        let mut tree = self.primary();
        for (op, token) in ops.into_iter().rev() {
            let Some(op) = op else { continue };
            let at = self.span_of(token).to(tree.expr.at.0);
            tree = self.bounded(ExprKind::Unary(op, Box::new(tree.expr)), at, tree.height + 1);
        }
        tree
    }

    fn primary(&mut self) -> Tree {
        let token = self.token();
        let expr = match token.kind {
            Kind::Number | Kind::Typed | Kind::Str | Kind::WideStr => self.literal(),
            Kind::Direct => {
                self.bump();
                let name = self.slice(token).trim_start_matches('%').to_ascii_uppercase();
                Expr { kind: ExprKind::Direct(name.into()), at: self.span_of(token).into() }
            }
            Kind::Word => return self.word_operand(),
            Kind::Sign if self.at("(") => return self.grouped(),
            Kind::Sign if self.at(".") && self.ahead(1).kind == Kind::Word => {
                // CODESYS marks a global variable with a leading dot.
                self.bump();
                return self.word_operand();
            }
            _ => {
                self.expected(say!("an expression"));
                self.bad(token.start)
            }
        };
        Tree { expr, height: 1 }
    }

    fn grouped(&mut self) -> Tree {
        let open = self.token();
        if !self.enter() {
            return Tree { expr: self.bad(open.start), height: 1 };
        }
        self.bump();
        let mut tree = self.tree(1);
        self.expect(")");
        self.leave();
        tree.expr.at = self.since(open.start).into();
        tree
    }

    fn word_operand(&mut self) -> Tree {
        let token = self.token();
        let upper = self.word();
        match upper.as_str() {
            "TRUE" | "FALSE" => {
                self.bump();
                return Tree { expr: self.boolean(token, upper == "TRUE"), height: 1 };
            }
            _ if self.ahead_is(1, "(") => return self.call(),
            word if BinaryOp::of_word(word).is_some() => {
                self.expected(say!("an expression"));
                return Tree { expr: self.bad(token.start), height: 1 };
            }
            "THEN" | "DO" | "OF" | "TO" | "BY" | "END_IF" | "END_TRANSITION" | "END_ACTION" | "END_STEP"
            | "END_VAR" | "ELSE" | "ELSIF" | "UNTIL" => {
                self.expected(say!("an expression"));
                return Tree { expr: self.bad(token.start), height: 1 };
            }
            _ => {}
        }
        self.variable_tree()
    }

    /// A variable: `a`, `Step.X`, `a[1]`, `s.x`, `a[i].x.3`.
    pub(crate) fn variable(&mut self) -> Expr {
        self.variable_tree().expr
    }

    fn variable_tree(&mut self) -> Tree {
        let start = self.token().start;
        let mut names: Vec<Name> = Vec::new();
        let (mut index, mut height, mut bit) = (Vec::new(), 0, None);
        let mut fits = true;
        while let Some(mut name) = self.name(say!("a name")) {
            let before = index.len();
            while self.at("[") {
                let from = index.len();
                height = height.max(self.indexes(&mut index));
                if self.single {
                    fits &= self.joined(&mut name, index.split_off(from), start);
                }
            }
            names.push(name);
            if self.at("^") {
                let at = self.here();
                self.say(&codes::NOT_CARRIED, &at, say!("there are no pointers"));
                self.bump();
                fits = false;
            }
            if !self.at(".") {
                break;
            }
            self.bump();
            if self.token().kind == Kind::Number {
                // A bit of a number: `w.3`.
                let token = self.bump();
                let number = Name::new(self.slice(token), self.span_of(token));
                if index.is_empty() {
                    names.push(number)
                } else {
                    bit = Some(Box::new(number))
                }
                break;
            }
            if let Some(last) = names.last_mut().filter(|_| index.len() > before) {
                last.text = format!("{}[{}]", last.text, ",".repeat(index.len() - before - 1)).into();
            }
        }
        let at = self.since(start);
        if !fits || names.is_empty() {
            return Tree { expr: self.bad(start), height: 1 };
        }
        let path = Path { names };
        let kind = match index.as_slice() {
            [] => ExprKind::Path(path),
            _ => ExprKind::Element(Box::new(path), index, bit),
        };
        self.bounded(kind, at, height + 1)
    }

    /// `[1, i + 1]`. Returns the height of the highest index.
    fn indexes(&mut self, index: &mut Vec<Expr>) -> u32 {
        if !self.enter() {
            return 0;
        }
        self.bump();
        let mut height = 0;
        loop {
            let tree = self.tree(1);
            height = height.max(tree.height);
            index.push(tree.expr);
            if !self.eat(",") {
                break;
            }
        }
        self.expect("]");
        self.leave();
        height
    }

    /// Makes indexes a part of a name. An index that is not constant has no counterpart; then it returns false.
    fn joined(&mut self, name: &mut Name, index: Vec<Expr>, start: u32) -> bool {
        let numbers: Option<Vec<String>> =
            index.iter().map(|e| e.kind.whole().map(|n| n.to_string())).collect();
        if let Some(numbers) = numbers {
            name.text = format!("{}[{}]", name.text, numbers.join(",")).into();
            name.at = self.since(start).into();
            return true;
        }
        let all = index.iter().map(|e| e.at.0).reduce(Span::to);
        let what = say!("an index that is no constant; arrays are carried as single variables");
        self.report.put(g7_model::Problem::new(&codes::NOT_CARRIED, all.unwrap_or_default(), what));
        false
    }

    /// `f(a, n := b, q => c)`.
    fn call(&mut self) -> Tree {
        let start = self.token().start;
        let upper = self.word();
        let Some(name) = self.name(say!("a function")) else {
            return Tree { expr: self.bad(start), height: 1 };
        };
        let args = self.args();
        self.applied(name, &upper, args, start)
    }

    /// A function applied to its arguments; becomes an operator where one exists.
    pub(crate) fn applied(&mut self, name: Name, upper: &str, args: Args, start: u32) -> Tree {
        let at = self.since(start);
        let narrow = of_wide_text(upper);
        let name = narrow.as_ref().map_or(name.clone(), |narrow| Name::new(narrow.as_str(), name.at.0));
        let upper = narrow.as_deref().unwrap_or(upper);
        let height = args.height.saturating_add(u32::try_from(args.list.len()).unwrap_or(u32::MAX));
        let kind = match signs::applied(upper, args.list, at) {
            Ok(operator) => operator.kind,
            Err(list) => match by_number(upper) {
                Some((first, then)) => {
                    self.transfer(upper, at);
                    let inner = nodes::expr(ExprKind::Call(nodes::path(&[&first], name.at.0), list), at);
                    nodes::call(&then, vec![inner], at).kind
                }
                None => ExprKind::Call(Path { names: vec![name] }, list),
            },
        };
        self.bounded(kind, at, height.max(args.height + 1))
    }

    /// Says what a conversion between bits and a real number of the same length does.
    fn transfer(&mut self, upper: &str, at: Span) {
        if matches!(upper, "DWORD_TO_REAL" | "REAL_TO_DWORD" | "LWORD_TO_LREAL" | "LREAL_TO_LWORD") {
            let what = say!(
                "`{}` converts the number, as CODESYS does; where it keeps the bits (IEC 61131-3:2013, table 23), the \
                 value is another one",
                Said::foreign(upper)
            );
            self.report.put(g7_model::Problem::new(&codes::DIFFERENT, at, what));
        }
    }

    /// `(…)` behind a name.
    pub(crate) fn args(&mut self) -> Args {
        let mut args = Args { list: Vec::new(), height: 0 };
        if !self.enter() {
            return args;
        }
        self.expect("(");
        while !self.at(")") && !self.at_end() {
            let before = self.mark();
            if let Some((arg, height)) = self.arg() {
                args.height = args.height.max(height);
                args.list.push(arg);
            }
            if !self.eat(",") || self.mark() == before {
                break;
            }
        }
        self.expect(")");
        self.leave();
        args
    }

    fn arg(&mut self) -> Option<(Arg, u32)> {
        let negated = self.at_word("NOT") && self.ahead(1).kind == Kind::Word && self.ahead_is(2, "=>");
        if negated {
            let at = self.here();
            self.say(
                &codes::NOT_CARRIED,
                &at,
                say!("an output that is negated on its way; assign it behind the call"),
            );
            self.bump();
        }
        let assigned = self.ahead_is(1, ":=");
        let output = self.ahead_is(1, "=>");
        if self.token().kind != Kind::Word || !assigned && !output {
            let tree = self.tree(1);
            return Some((Arg::input(None, tree.expr), tree.height));
        }
        let name = self.name(say!("an input"))?;
        self.bump();
        // An output that is not connected: `Q => ,`.
        if output && (self.at(",") || self.at(")")) {
            return None;
        }
        let tree = self.tree(1);
        Some((Arg { output, ..Arg::input(Some(name), tree.expr) }, tree.height))
    }
}

/// The two conversions that do what one of bits does, by way of the number that stands for them: `TIME_TO_DWORD` is
/// `UDINT_TO_DWORD(TIME_TO_UDINT(…))` (IEC 61131-3:2003, 2.5.1.5.1).
fn by_number(upper: &str) -> Option<(String, String)> {
    let (from, to) = upper.split_once("_TO_")?;
    let (a, b) = (Type::named(from)?, Type::named(to)?);
    let other = |ty: Type| ty.is_real() || ty == Type::Time || ty.is_moment();
    let number = match (a.unsigned(), b.unsigned()) {
        (Some(number), None) if other(b) => number,
        (None, Some(number)) if other(a) => number,
        _ => return None,
    };
    Some((format!("{from}_TO_{number}"), format!("{number}_TO_{to}")))
}

/// The conversion of a STRING that does what one of a WSTRING does: both are one type here (decision 68).
fn of_wide_text(upper: &str) -> Option<String> {
    let (from, to) = upper.split_once("_TO_")?;
    let narrow = |ty: &str| if ty == "WSTRING" { "STRING" } else { ty }.to_owned();
    (from == "WSTRING" || to == "WSTRING").then(|| format!("{}_TO_{}", narrow(from), narrow(to)))
}

/// The arguments of a call, with the height of the highest.
pub(crate) struct Args {
    pub(crate) list: Vec<Arg>,
    pub(crate) height: u32,
}
