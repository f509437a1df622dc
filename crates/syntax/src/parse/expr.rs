//! Expressions: operators by their binding strength, as `model` has it.
//!
//! The height of every tree is bounded, also for long chains (`a or b or …`), so that all later
//! stages may recurse over it.

use super::{Parser, meant};
use crate::lexer::{Tok, Token};
use crate::words;
use g7_iec::constant;
use g7_model::{
    Arg, BinaryOp, Expr, ExprKind, Fix, Literal, Name, Path, Problem, Said, Span, Type, UnaryOp, codes, say,
};

/// The largest height of an expression's tree.
const MOST_HIGH: u32 = 500;

/// An expression with the height of its tree.
pub(super) struct Tree {
    pub(super) expr: Expr,
    pub(super) height: u32,
}

impl Parser<'_> {
    /// Reads an expression; without one it reports a problem and returns `Bad`.
    pub(crate) fn expr(&mut self) -> Expr {
        self.tree(1).expr
    }

    /// Reads an expression whose operators all bind tighter than this one.
    pub(super) fn operand_above(&mut self, op: BinaryOp) -> Expr {
        self.tree(op.strength() + 1).expr
    }

    /// Reads an expression that is a condition: a `:=` in it is a slip for `=`.
    pub(super) fn condition(&mut self) -> Expr {
        let left = self.tree(1);
        if !self.at(Tok::Assign) {
            return left.expr;
        }
        self.slip_to(self.here(), say!("`:=` assigns; a comparison is written `=`"), "=");
        self.bump();
        let right = self.tree(1);
        self.join(BinaryOp::Eq, left, right).expr
    }

    /// True if an expression can begin here.
    pub(super) fn at_expr(&self) -> bool {
        match self.cur.kind {
            Tok::Word => {
                let word = self.word();
                !words::is_reserved(word)
                    || matches!(
                        word,
                        "not" | "NOT" | "TRUE" | "FALSE" | "true" | "false" | "rise" | "fall" | "delay"
                    )
            }
            Tok::Slash | Tok::Minus | Tok::Eq => true,
            kind => kind.begins_operand(),
        }
    }

    pub(super) fn tree(&mut self, least: u8) -> Tree {
        let left = self.unary();
        let tree = self.operators(left, least);
        // Nothing binds less, so it stands behind the whole condition.
        if least == 1 && self.at(Tok::Question) { self.choice(&tree) } else { tree }
    }

    /// `a ? b : c` of other languages: told once, with the function that chooses.
    fn choice(&mut self, condition: &Tree) -> Tree {
        let sign = self.here();
        if !self.enter() {
            return self.no_tree();
        }
        self.bump();
        let yes = self.tree(1).expr.at.0;
        self.eat(Tok::Colon);
        let no = self.tree(1).expr.at.0;
        self.leave();
        let at = condition.expr.at.0.to(no);
        let call = [no, yes].map(|of| self.text_at(of)).join(", ");
        let call = format!("SEL({}, {call})", self.text_at(condition.expr.at.0));
        self.lexer.problems.add(sign, || {
            let help = say!("write `{call}`, or `IF … THEN … ELSE … END_IF` in a body");
            Problem::new(&codes::EXPECTED, sign, say!("there is no `? :`")).help(help).fix(Fix::likely(
                say!("write `{call}`"),
                at,
                call,
            ))
        });
        Tree { expr: Expr { kind: ExprKind::Bad, at: at.into() }, height: 1 }
    }

    fn operators(&mut self, mut left: Tree, least: u8) -> Tree {
        while let Some(op) = self.operator() {
            if op.strength() < least {
                break;
            }
            self.operator_slip();
            self.bump();
            let right = self.tree(op.strength() + 1);
            left = self.join(op, left, right);
        }
        left
    }

    fn operator(&self) -> Option<BinaryOp> {
        Some(match self.cur.kind {
            Tok::Word => return BinaryOp::of_word(self.word()),
            Tok::Amp | Tok::AmpAmp => BinaryOp::And,
            Tok::Bars => BinaryOp::Or,
            Tok::Eq => BinaryOp::Eq,
            Tok::Ne => BinaryOp::Ne,
            Tok::Lt => BinaryOp::Lt,
            Tok::Le => BinaryOp::Le,
            Tok::Gt => BinaryOp::Gt,
            Tok::Ge => BinaryOp::Ge,
            Tok::Plus => BinaryOp::Add,
            Tok::Minus => BinaryOp::Sub,
            Tok::Star => BinaryOp::Mul,
            Tok::Slash => BinaryOp::Div,
            Tok::Dot => BinaryOp::Dot,
            Tok::Percent => BinaryOp::Mod,
            Tok::Power => BinaryOp::Pow,
            _ => return None,
        })
    }

    /// Reports operators of other languages, which are read as the ones meant.
    fn operator_slip(&mut self) {
        let (sign, word) = match self.cur.kind {
            Tok::AmpAmp => ("&&", "and"),
            Tok::Bars => ("||", "or"),
            Tok::Percent => ("%", "mod"),
            _ => return,
        };
        self.slip_to(self.here(), say!("`{sign}` is no operator here"), word);
    }

    /// Builds `a op b`; a tree that becomes too high is cut.
    fn join(&mut self, op: BinaryOp, left: Tree, right: Tree) -> Tree {
        let at = left.expr.at.0.to(right.expr.at.0);
        let height = left.height.max(right.height) + 1;
        let kind = ExprKind::Binary(op, Box::new(left.expr), Box::new(right.expr));
        self.checked(kind, at, height)
    }

    fn checked(&mut self, kind: ExprKind, at: Span, height: u32) -> Tree {
        if height <= MOST_HIGH {
            return Tree { expr: Expr { kind, at: at.into() }, height };
        }
        let place = Span { start: at.end, ..at };
        self.report(place, || {
            let what = say!("this expression is more than {MOST_HIGH} operators deep");
            Problem::new(&codes::TOO_DEEP, place, what)
                .help(say!("put parts of it in parentheses or in variables"))
        });
        Tree { expr: Expr { kind: ExprKind::Bad, at: at.into() }, height: 1 }
    }

    fn unary(&mut self) -> Tree {
        if self.operand_over_line() {
            self.operand_missing();
            return self.no_tree();
        }
        let outer = self.prefixes.len();
        loop {
            let op = match self.cur.kind {
                Tok::Bang | Tok::Slash => Some(UnaryOp::Not),
                Tok::Minus => Some(UnaryOp::Neg),
                Tok::Plus => None,
                Tok::Rise => Some(UnaryOp::Rise),
                Tok::Fall => Some(UnaryOp::Fall),
                Tok::Word if matches!(self.word(), "not" | "NOT") => Some(UnaryOp::Not),
                _ => break,
            };
            self.prefixes.push((op, self.cur.start));
            self.bump();
        }
        let mut tree = if self.operand_over_line() {
            self.operand_missing();
            self.no_tree()
        } else {
            self.postfix()
        };
        while self.prefixes.len() > outer
            && let Some((op, start)) = self.prefixes.pop()
        {
            let at = Span { start, ..tree.expr.at.0 };
            tree = match op {
                Some(op) => self.checked(ExprKind::Unary(op, Box::new(tree.expr)), at, tree.height + 1),
                None => Tree { expr: Expr { at: at.into(), ..tree.expr }, ..tree },
            };
        }
        tree
    }

    fn postfix(&mut self) -> Tree {
        let mut tree = self.primary();
        while matches!(self.cur.kind, Tok::Prime | Tok::Overline) {
            self.bump();
            let at = Span { end: self.prev.end, ..tree.expr.at.0 };
            tree = self.checked(ExprKind::Unary(UnaryOp::Not, Box::new(tree.expr)), at, tree.height + 1);
        }
        tree
    }

    fn primary(&mut self) -> Tree {
        let token = self.cur;
        match token.kind {
            Tok::Int if self.peek().kind == Tok::PathDot => self.path_or_call(),
            Tok::Int | Tok::Real if self.unit_ahead() => self.loose_timed(),
            Tok::Time if self.slice(token).starts_with("0x") => self.foreign_hexadecimal(),
            Tok::Comment if self.is_text_value() => {
                self.slip(
                    self.here(),
                    say!("a text as a value stands in single quotes"),
                    say!("write `'…'`; a comment, in double quotes, is drawn"),
                );
                self.bump();
                self.leaf(ExprKind::Bad, token.start)
            }
            Tok::Int | Tok::Real | Tok::Typed | Tok::Str => {
                self.bump();
                let literal = self.literal(token);
                self.leaf(literal.map_or(ExprKind::Bad, ExprKind::Literal), token.start)
            }
            Tok::Time => self.timed(),
            Tok::Ticked => self.path_or_call(),
            Tok::Direct => {
                self.bump();
                let name = self.direct_name(token);
                self.leaf(ExprKind::Direct(name), token.start)
            }
            Tok::LParen => self.grouped(Tok::RParen, say!("`)`")),
            Tok::LBracket => self.grouped(Tok::RBracket, say!("`]`")),
            Tok::Eq => self.always_true(),
            Tok::Word => self.word_operand(),
            _ => self.no_operand(),
        }
    }

    /// Reads an operand without operators, sign or complement.
    pub(super) fn operand(&mut self) -> Expr {
        self.primary().expr
    }

    fn leaf(&self, kind: ExprKind, start: u32) -> Tree {
        Tree { expr: Expr { kind, at: self.since(start).into() }, height: 1 }
    }

    fn no_operand(&mut self) -> Tree {
        self.expected(say!("an expression"));
        self.no_tree()
    }

    fn no_tree(&self) -> Tree {
        Tree { expr: Expr { kind: ExprKind::Bad, at: self.here().into() }, height: 1 }
    }

    fn word_operand(&mut self) -> Tree {
        let token = self.cur;
        let literal = match self.slice(token) {
            "TRUE" | "true" => true,
            "FALSE" | "false" => false,
            "rise" => return self.edge(UnaryOp::Rise),
            "fall" => return self.edge(UnaryOp::Fall),
            "delay" => return self.delay(),
            // The function of the operator: `AND(a, b)`.
            word if BinaryOp::of_word(word).is_some() && self.peek_call() => {
                let name = Name::new(word, self.span_of(token));
                self.bump();
                return self.called(Path { names: vec![name] }, token.start);
            }
            word if words::is_reserved(word) => return self.no_operand(),
            _ => return self.path_or_call(),
        };
        self.bump();
        self.leaf(ExprKind::Literal(Literal::Bool(literal)), token.start)
    }

    /// A literal of one token; a problem if it cannot be read.
    fn literal(&mut self, token: Token) -> Option<Literal> {
        let text = self.slice(token);
        let read = match token.kind {
            Tok::Int => constant::integer(text).map(|v| Literal::Int(v, None)),
            Tok::Real => constant::real(text).map(|v| Literal::Real(v, None)),
            Tok::Typed => constant::typed(text),
            Tok::Str => Ok(Literal::Str(self.string(token))),
            _ => return None,
        };
        read.map_err(|what| {
            let at = self.span_of(token);
            let moment =
                matches!(constant::literal_type(text.split('#').next().unwrap_or("")), Some(Type::Moment(_)));
            let code = if moment { &codes::BAD_DURATION } else { &codes::BAD_NUMBER };
            self.lexer.problems.add(at, || Problem::new(code, at, what));
        })
        .ok()
    }

    /// `%I0.1` without the `%`, in upper case.
    pub(super) fn direct_name(&self, token: Token) -> Box<str> {
        self.slice(token).trim_start_matches('%').to_ascii_uppercase().into()
    }

    /// `( … )` or `[ … ]`.
    fn grouped(&mut self, close: Tok, sign: Said) -> Tree {
        let open = self.here();
        if !self.enter() {
            return self.leaf(ExprKind::Bad, open.start);
        }
        self.bump();
        let mut tree = self.tree(1);
        self.close(close, sign, open);
        self.leave();
        tree.expr.at = self.since(open.start).into();
        tree
    }

    /// `=1`.
    fn always_true(&mut self) -> Tree {
        let start = self.bump().start;
        if self.at(Tok::Int) && self.slice(self.cur) == "1" {
            self.bump();
            return self.leaf(ExprKind::Literal(Literal::Bool(true)), start);
        }
        self.expected_help(
            say!("`1` after `=`"),
            Some(say!("`=1` is always true; a comparison has two sides")),
        );
        self.leaf(ExprKind::Bad, start)
    }

    /// True in a comment where a value is needed and no operand can have been forgotten.
    fn is_text_value(&self) -> bool {
        matches!(self.prev.kind, Tok::LParen | Tok::Comma | Tok::Assign | Tok::Eq | Tok::Ne)
            && !self.cur.newline
    }

    /// `0x1F`, which is `16#1F` here.
    fn foreign_hexadecimal(&mut self) -> Tree {
        let token = self.bump();
        let at = self.span_of(token);
        let digits = self.slice(token).trim_start_matches("0x").to_ascii_uppercase();
        self.lexer.problems.add(at, || {
            let problem =
                Problem::new(&codes::BAD_NUMBER, at, say!("a hexadecimal number begins with `16#`"));
            meant(problem, &format!("16#{digits}"))
        });
        self.leaf(ExprKind::Bad, token.start)
    }

    /// `5 s` or `5 s/X1`: told, and read without the blank.
    fn loose_timed(&mut self) -> Tree {
        let start = self.cur.start;
        let t1 = self.loose_time();
        self.delayed(t1, start)
    }

    /// A duration, or `t1/e/t2`.
    fn timed(&mut self) -> Tree {
        let token = self.bump();
        let t1 = self.time_of(token);
        self.delayed(t1, token.start)
    }

    /// The rest of `t1/e/t2`, if a `/` follows.
    fn delayed(&mut self, t1: Expr, start: u32) -> Tree {
        if !self.at(Tok::Slash) {
            return Tree { expr: t1, height: 1 };
        }
        if !self.enter() {
            return self.leaf(ExprKind::Bad, start);
        }
        self.bump();
        let e = self.unary();
        self.leave();
        let mut t2 = None;
        if self.at(Tok::Slash) && self.peek().kind == Tok::Time {
            self.bump();
            let token = self.bump();
            t2 = Some(Box::new(self.time_of(token)));
        }
        let at = self.since(start);
        self.checked(ExprKind::Timer { t1: Box::new(t1), e: Box::new(e.expr), t2 }, at, e.height + 1)
    }

    /// The expression of a duration token just read.
    pub(super) fn time_of(&mut self, token: Token) -> Expr {
        let time = self.duration_of(token);
        Expr { kind: ExprKind::Literal(Literal::Time(time)), at: self.span_of(token).into() }
    }

    /// `rise(e)` and `fall(e)`.
    fn edge(&mut self, op: UnaryOp) -> Tree {
        let start = self.bump().start;
        if !self.at(Tok::LParen) && (self.at_name() || self.at(Tok::Direct)) {
            let (word, sign) = if op == UnaryOp::Rise { ("rise", '↑') } else { ("fall", '↓') };
            let operand = self.slice(self.cur);
            let help = say!("write `{word}({operand})` or `{sign}{operand}`");
            let place = self.here();
            let fix = Fix::sure(help.clone(), Span { start, ..place }, format!("{word}({operand})"));
            self.report(place, || {
                let what = say!("the operand of `{word}` stands in parentheses");
                Problem::new(&codes::EXPECTED, place, what).help(help).fix(fix)
            });
            let inner = self.postfix();
            let at = self.since(start);
            return self.checked(ExprKind::Unary(op, Box::new(inner.expr)), at, inner.height + 1);
        }
        if !self.at(Tok::LParen) {
            self.expected(say!("`(`"));
            return self.leaf(ExprKind::Bad, start);
        }
        let inner = self.grouped(Tok::RParen, say!("`)`"));
        let at = self.since(start);
        self.checked(ExprKind::Unary(op, Box::new(inner.expr)), at, inner.height + 1)
    }

    /// `delay(t1, e, t2)`.
    fn delay(&mut self) -> Tree {
        let start = self.bump().start;
        let open = self.here();
        if !self.at(Tok::LParen) || !self.enter() {
            self.expected(say!("`(`"));
            return self.leaf(ExprKind::Bad, start);
        }
        self.bump();
        let t1 = self.tree(1);
        if !self.expect(Tok::Comma, say!("`,` and the condition")) {
            self.leave();
            self.close(Tok::RParen, say!("`)`"), open);
            return self.leaf(ExprKind::Bad, start);
        }
        let e = self.tree(1);
        let t2 = self.eat(Tok::Comma).then(|| self.tree(1));
        self.close(Tok::RParen, say!("`)`"), open);
        self.leave();
        let height = t1.height.max(e.height).max(t2.as_ref().map_or(0, |t| t.height)) + 1;
        let t2 = t2.map(|t| Box::new(t.expr));
        let kind = ExprKind::Timer { t1: Box::new(t1.expr), e: Box::new(e.expr), t2 };
        let at = self.since(start);
        self.checked(kind, at, height)
    }

    /// Reads `a.b.c`. The caller has checked that a name stands here.
    pub(super) fn path(&mut self) -> Path {
        let first = self.name(say!("a name"));
        self.path_from(first)
    }

    /// The same behind its first name.
    pub(super) fn path_from(&mut self, first: Name) -> Path {
        let mut names = vec![self.chart_of_path(first)];
        while self.eat(Tok::PathDot)
            || names.len() == 1 && self.prev.kind == Tok::RBracket && self.dot_of_member()
        {
            let member = self.member();
            names.push(self.called_instance(member));
        }
        Path { names }
    }

    /// The name after a dot: every word is allowed there.
    pub(super) fn member(&mut self) -> Name {
        if self.at(Tok::Word) {
            let token = self.bump();
            return Name::new(self.slice(token), self.span_of(token));
        }
        self.name(say!("a name after the dot"))
    }

    /// True if the `(` of a call stands here.
    pub(super) fn at_call(&self) -> bool {
        self.at(Tok::LParen) && !self.cur.newline
    }

    /// True if the next token is the `(` of a call.
    pub(super) fn peek_call(&mut self) -> bool {
        let next = self.peek();
        next.kind == Tok::LParen && !next.newline
    }

    fn path_or_call(&mut self) -> Tree {
        let start = self.cur.start;
        let path = self.path();
        if self.at(Tok::LBracket) {
            let (kind, height) = self.element_of(path);
            let at = self.since(start);
            return self.checked(kind, at, height + 1);
        }
        if !self.at_call() {
            return self.leaf(ExprKind::Path(path), start);
        }
        self.called(path, start)
    }

    /// The call of a function whose name has been read.
    fn called(&mut self, path: Path, start: u32) -> Tree {
        let (args, height) = self.args();
        let at = self.since(start);
        self.checked(ExprKind::Call(path, args), at, height + 1)
    }

    /// `(a, n := b, m => c)`, with the height of the highest argument.
    fn args(&mut self) -> (Vec<Arg>, u32) {
        let open = self.here();
        let mut args = Vec::new();
        let mut height = 0;
        if !self.enter() {
            return (args, height);
        }
        self.bump();
        while !matches!(self.cur.kind, Tok::RParen | Tok::End) {
            let name = match self.peek().kind {
                Tok::Assign | Tok::Output => self.name_if(),
                _ => None,
            };
            let output = name.is_some() && self.at(Tok::Output);
            if name.is_some() {
                self.bump();
            }
            let value = self.tree(1);
            height = height.max(value.height);
            let is_path =
                matches!(value.expr.kind, ExprKind::Path(_) | ExprKind::Element(..) | ExprKind::Bad);
            if output && !is_path {
                let at = value.expr.at.0;
                self.slip(
                    at,
                    say!("the result of an output goes to a variable"),
                    say!("write the name of a variable"),
                );
            }
            args.push(Arg { output, ..Arg::input(name, value.expr) });
            if !self.eat(Tok::Comma) {
                break;
            }
        }
        self.close(Tok::RParen, say!("`)`"), open);
        self.leave();
        (args, height)
    }

    /// The arguments of a call statement.
    pub(super) fn call_args(&mut self) -> Vec<Arg> {
        self.args().0
    }
}
