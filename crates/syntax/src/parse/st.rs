//! Blocks and statements of Structured Text.

use super::{Parser, meant};
use crate::lexer::Tok;
use crate::words::{self, St};
use crate::{il, ladder};
use g7_model::{
    Block, Body, BodyLang, CaseArm, Expr, ExprKind, Local, Path, Problem, Said, Span, Stmt, StmtKind, Work,
    codes, say,
};

impl Parser<'_> {
    /// Reads `{ … }`; without a brace it reports a problem and returns an empty block.
    pub(super) fn block(&mut self, what: Said) -> Block {
        let open = self.here();
        if !self.at(Tok::LBrace) {
            self.expected(what);
            return Block { at: open.into(), ..Block::default() };
        }
        if !self.enter() {
            return Block { at: open.into(), ..Block::default() };
        }
        self.bump();
        let locals = self.locals();
        let statements = self.statements(false);
        self.close(Tok::RBrace, say!("`}}` after the statements"), open);
        self.leave();
        Block { locals, statements, at: self.since(open.start).into() }
    }

    fn locals(&mut self) -> Vec<Local> {
        let mut locals = Vec::new();
        self.skip_semis();
        while self.at_word("var") {
            locals.push(self.line(Parser::local));
            self.skip_semis();
        }
        locals
    }

    fn local(&mut self) -> Local {
        let start = self.bump().start;
        let names = self.names(say!("the name of a variable"));
        let ty = self.value_type();
        let init = self.initial_value();
        Local { names, ty, init, at: self.since(start).into() }
    }

    /// `st { … }`, `{ … }`, `il { … }` or `ld { … }`.
    pub(super) fn body(&mut self) -> Body {
        let start = self.cur.start;
        let lang = match self.word() {
            "il" => Some(BodyLang::Il),
            "ld" => Some(BodyLang::Ld),
            _ => None,
        };
        let Some(lang) = lang else {
            self.eat_word("st");
            return Body::St(self.block(say!("`{{` and the statements")));
        };
        self.bump();
        if !self.at(Tok::LBrace) || self.next.is_some() {
            self.expected(say!("`{{`"));
            let at = self.since(start).into();
            return Body::Other(lang, "".into(), Block { at, ..Block::default() });
        }
        let open = self.here();
        let from = self.cur.end as usize;
        let raw = self.lexer.raw_body(self.cur.end);
        let statements = self.other_body(lang, from, from + raw.len());
        let text = if raw.contains('\r') { raw.replace("\r\n", "\n").into() } else { raw.into() };
        self.bump();
        self.close(Tok::RBrace, say!("`}}`"), open);
        let at = self.since(start).into();
        Body::Other(lang, text, Block { locals: Vec::new(), statements, at })
    }

    /// The statements that a body in another language means.
    fn other_body(&mut self, lang: BodyLang, from: usize, to: usize) -> Vec<Stmt> {
        let text = self.text.get(..to).unwrap_or_default();
        let (statements, problems) = match lang {
            BodyLang::Il => il::statements_from(text, self.file, from),
            BodyLang::Ld => ladder::statements_from(text, self.file, from),
        };
        for problem in problems {
            self.lexer.problems.add(problem.at, || problem);
        }
        statements
    }

    /// An assignment, a call or a block, as in an action.
    pub(super) fn work(&mut self) -> Work {
        if self.at(Tok::LBrace) {
            return Work::Block(self.block(say!("`{{`")));
        }
        let start = self.cur.start;
        let kind = match self.simple_statement() {
            Some(kind) => kind,
            None => {
                self.expected(say!("an assignment, a call or `{{`"));
                StmtKind::Assign { target: self.bad(), value: self.bad() }
            }
        };
        Work::Single(Box::new(Stmt { kind, at: self.since(start).into() }))
    }

    pub(super) fn bad(&self) -> Expr {
        Expr { kind: ExprKind::Bad, at: self.behind().into() }
    }

    /// Reads statements up to a word or brace that ends them; in an arm of a CASE also up to the
    /// next label.
    pub(crate) fn statements(&mut self, in_case: bool) -> Vec<Stmt> {
        let mut list = Vec::new();
        loop {
            self.skip_semis();
            self.misspelt_end();
            if matches!(self.cur.kind, Tok::End | Tok::RBrace) || self.at_closing_word() {
                return list;
            }
            if in_case && self.at_label() || self.cur.newline && self.at_outer_start() {
                return list;
            }
            let start = self.cur.start;
            match self.statement() {
                Some(kind) if self.cur.start > start => {
                    list.push(Stmt { kind, at: self.since(start).into() });
                }
                _ => self.lost_statement(start),
            }
        }
    }

    /// Reads `ENDIF`, `END IF` or `END_IFF` as the word that was meant.
    fn misspelt_end(&mut self) {
        let word = self.word();
        let begins = word.get(..3).is_some_and(|w| w.eq_ignore_ascii_case("end"));
        if !begins || words::st(word).is_some() {
            return;
        }
        let next = self.peek();
        let at = self.here();
        let joined = format!("END_{}", self.slice(next).to_ascii_uppercase());
        let two = word.len() == 3 && next.kind == Tok::Word && words::END.contains(&&*joined);
        let likely = if two { Some(&*joined) } else { words::similar(word, &words::END) };
        let called = matches!(next.kind, Tok::Assign | Tok::Eq | Tok::LParen | Tok::PathDot);
        let Some(near) = likely.and_then(|m| words::END.into_iter().find(|w| *w == m)).filter(|_| !called)
        else {
            return;
        };
        let at = if two { Span { end: next.end, ..at } } else { at };
        let what = say!("`{}` is no word of Structured Text", self.text_at(at));
        self.report(at, || meant(Problem::new(&codes::UNKNOWN_WORD, at, what), near));
        if two {
            self.bump();
        }
        self.corrected = Some((self.cur.start, near));
    }

    /// The words that end the statements of a construct.
    fn at_closing_word(&self) -> bool {
        matches!(
            self.st_word(),
            Some(
                St::Elsif
                    | St::Else
                    | St::EndIf
                    | St::EndCase
                    | St::EndFor
                    | St::EndWhile
                    | St::Until
                    | St::EndRepeat
            )
        )
    }

    /// True if an item begins here that is not allowed among statements.
    fn at_outer_start(&mut self) -> bool {
        self.at_file_start() || self.at_chart_start()
    }

    fn lost_statement(&mut self, start: u32) {
        self.unexpected(say!("a statement"), None);
        if self.cur.start == start {
            self.bump();
        }
        self.recover(|p| {
            p.at_closing_word()
                || matches!(
                    p.st_word(),
                    Some(St::If | St::Case | St::For | St::While | St::Repeat | St::Exit | St::Return)
                )
                || p.at(Tok::Direct)
                || p.at_name()
        });
    }

    fn statement(&mut self) -> Option<StmtKind> {
        let Some(word) = self.st_word() else { return self.statement_line(Parser::simple_statement) };
        let nesting = matches!(word, St::If | St::Case | St::For | St::While | St::Repeat);
        if !nesting {
            self.bump();
            return match word {
                St::Exit => Some(StmtKind::Exit),
                St::Return => Some(StmtKind::Return),
                _ => None,
            };
        }
        if !self.enter() {
            return Some(StmtKind::Return);
        }
        let kind = match word {
            St::If => self.if_statement(),
            St::Case => self.case_statement(),
            St::For => self.for_statement(),
            St::While => self.while_statement(),
            _ => self.repeat_statement(),
        };
        self.leave();
        Some(kind)
    }

    fn then_word(&mut self, word: St, text: &str) {
        if !self.eat_st(word) {
            self.expected_help(
                say!("`{text}`"),
                Some(say!("blocks have words and no braces: `IF a THEN … END_IF`")),
            );
        }
    }

    fn end_word(&mut self, word: St, text: &str, open: g7_model::Span) {
        if !self.eat_st(word) {
            let (at, words) = self.expected_words(say!("`{text}`"));
            self.report(at, || {
                let help = if word == St::EndIf {
                    say!("each IF has an END_IF of its own; `ELSE IF` begins another one, `ELSIF` does not")
                } else {
                    say!("write `{text}` behind its statements")
                };
                Problem::new(&codes::UNCLOSED, at, words)
                    .related(open, say!("the statement begins here"))
                    .help(help)
            });
        }
    }

    fn if_statement(&mut self) -> StmtKind {
        let open = self.here();
        let mut arms = Vec::new();
        let mut otherwise = Vec::new();
        self.bump();
        loop {
            let condition = self.condition();
            self.then_word(St::Then, "THEN");
            if self.eat(Tok::LBrace) {
                // C and Rust have braces here. The problem is reported already, so the block is read up
                // to its `}`, and what is inside causes no second problem.
                arms.push((condition, self.statements(false)));
                self.eat(Tok::RBrace);
                return StmtKind::If(arms, otherwise);
            }
            arms.push((condition, self.statements(false)));
            if !self.eat_st(St::Elsif) {
                break;
            }
        }
        if self.eat_st(St::Else) {
            otherwise = self.statements(false);
        }
        self.end_word(St::EndIf, "END_IF", open);
        StmtKind::If(arms, otherwise)
    }

    fn case_statement(&mut self) -> StmtKind {
        let open = self.here();
        self.bump();
        let selector = self.expr();
        self.then_word(St::Of, "OF");
        let mut arms = Vec::new();
        loop {
            self.skip_semis();
            if !self.at_label() {
                break;
            }
            let before = self.cur.start;
            arms.push(self.case_arm());
            if self.cur.start == before {
                break;
            }
        }
        let mut otherwise = Vec::new();
        if self.eat_st(St::Else) {
            self.eat(Tok::Colon);
            otherwise = self.statements(false);
        }
        self.end_word(St::EndCase, "END_CASE", open);
        StmtKind::Case(selector, arms, otherwise)
    }

    fn case_arm(&mut self) -> CaseArm {
        let mut labels = Vec::new();
        loop {
            let first = self.expr();
            let last = self.eat(Tok::DotDot).then(|| self.expr());
            labels.push((first, last));
            if !self.eat(Tok::Comma) {
                break;
            }
        }
        self.expect(Tok::Colon, say!("`:` after the values"));
        CaseArm { labels, body: self.statements(true) }
    }

    /// True if the values of a CASE arm stand here, and not a statement.
    fn at_label(&self) -> bool {
        match self.cur.kind {
            Tok::Word if matches!(self.word(), "TRUE" | "FALSE" | "true" | "false") => true,
            Tok::Word | Tok::Ticked | Tok::Int if self.at_name() => self.at_path_label(),
            Tok::Int
            | Tok::Real
            | Tok::Typed
            | Tok::Time
            | Tok::Str
            | Tok::Minus
            | Tok::Plus
            | Tok::LParen => true,
            _ => false,
        }
    }

    fn at_path_label(&self) -> bool {
        if self.at(Tok::Int) {
            return true;
        }
        let mut ahead = self.lexer.ahead(self.cur);
        let mut token = ahead.token();
        // The index of an instance has at most three tokens, and the name of a member stands behind it.
        if token.kind == Tok::LBracket {
            let mut inner = (0..4).map(|_| ahead.token().kind);
            if !inner.any(|kind| kind == Tok::RBracket) || ahead.token().kind != Tok::Dot {
                return false;
            }
            ahead.token();
            token = ahead.token();
        }
        while token.kind == Tok::PathDot {
            ahead.token();
            token = ahead.token();
        }
        matches!(token.kind, Tok::Comma | Tok::Colon | Tok::DotDot)
    }

    fn for_statement(&mut self) -> StmtKind {
        let open = self.here();
        self.bump();
        let var = self.name(say!("the loop's variable"));
        self.assign_sign();
        let from = self.expr();
        self.then_word(St::To, "TO");
        let to = self.expr();
        let by = self.eat_st(St::By).then(|| self.expr());
        self.then_word(St::Do, "DO");
        let body = self.statements(false);
        self.end_word(St::EndFor, "END_FOR", open);
        StmtKind::For { var, from, to, by, body }
    }

    fn while_statement(&mut self) -> StmtKind {
        let open = self.here();
        self.bump();
        let condition = self.condition();
        self.then_word(St::Do, "DO");
        let body = self.statements(false);
        self.end_word(St::EndWhile, "END_WHILE", open);
        StmtKind::While(condition, body)
    }

    fn repeat_statement(&mut self) -> StmtKind {
        let open = self.here();
        self.bump();
        let body = self.statements(false);
        let condition = if self.eat_st(St::Until) {
            self.condition()
        } else {
            self.expected(say!("`UNTIL` and a condition"));
            self.bad()
        };
        self.end_word(St::EndRepeat, "END_REPEAT", open);
        StmtKind::Repeat(body, condition)
    }

    /// `:=`, or `=` with a problem.
    pub(super) fn assign_sign(&mut self) -> bool {
        if self.at(Tok::Eq) {
            self.slip_to(self.here(), say!("`=` compares; an assignment is written `:=`"), ":=");
            self.bump();
            return true;
        }
        self.expect(Tok::Assign, say!("`:=`"))
    }

    /// An assignment or a call, if a target stands here.
    pub(super) fn simple_statement(&mut self) -> Option<StmtKind> {
        let start = self.cur.start;
        if self.at(Tok::Direct) {
            let token = self.bump();
            let kind = ExprKind::Direct(self.direct_name(token));
            return Some(self.assignment(Expr { kind, at: self.since(start).into() }));
        }
        if !self.at_name() || self.at(Tok::Int) && self.peek().kind != Tok::PathDot {
            return None;
        }
        let path = self.path();
        if self.at_call() {
            return Some(StmtKind::Call(path, self.call_args()));
        }
        let kind = self.variable_of(path);
        let at = self.since(start).into();
        Some(self.assignment(Expr { kind, at }))
    }

    /// The rest of `target := value`.
    pub(super) fn assignment(&mut self, target: Expr) -> StmtKind {
        if matches!(self.cur.kind, Tok::Plus | Tok::Minus)
            && matches!(self.peek().kind, Tok::Eq | Tok::Plus | Tok::Minus)
        {
            let sign = self.slice(self.cur);
            let name = self.text_at(target.at.0).to_owned();
            let help = say!("write `{name} := {name} {sign} 1`");
            self.expected_help(say!("`:=`"), Some(help));
            self.bump();
            self.bump();
            let value = if self.at_expr() && !self.cur.newline { self.expr() } else { self.bad() };
            return StmtKind::Assign { target, value };
        }
        let value = if self.assign_sign() { self.expr() } else { self.bad() };
        StmtKind::Assign { target, value }
    }

    /// The path of an expression that must be one.
    pub(super) fn path_or_empty(&mut self, what: Said) -> Path {
        if self.at_name() {
            return self.path();
        }
        Path { names: vec![self.name(what)] }
    }
}
