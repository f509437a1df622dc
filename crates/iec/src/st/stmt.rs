//! Statements of Structured Text.

use g7_model::codes;
use g7_model::{
    Arg, BinaryOp, CaseArm, Expr, ExprKind, Literal, Name, Path, Stmt, StmtKind, element_parts, say,
};

use super::lex::Kind;
use super::parse::Parser;
use crate::words::closes;

impl Parser<'_> {
    /// Reads statements up to a word that ends them or the end of the text.
    pub(crate) fn statements(&mut self) -> Vec<Stmt> {
        let mut list = Vec::new();
        loop {
            while self.eat(";") {}
            if self.at_end() || self.at_closing() {
                return list;
            }
            let before = self.mark();
            self.statement(&mut list);
            if self.mark() == before {
                self.expected(say!("a statement"));
                self.bump();
                self.recover();
            }
        }
    }

    /// True if the statements of a body end here.
    fn at_closing(&self) -> bool {
        let word = self.word();
        ends(&word) || begins(&word) && self.ahead(1).kind == Kind::Word
    }

    /// Skips to the end of the statement after a problem.
    fn recover(&mut self) {
        while !self.at_end() && !self.at(";") && !self.at_closing() {
            self.bump();
        }
    }

    /// Reads `;`, which is required if another statement follows.
    fn end_statement(&mut self) {
        if !self.eat(";") && !self.at_end() && !self.at_closing() && !self.closed() {
            self.expected(say!("`;`"));
            self.recover();
        }
    }

    /// True if `END_IF` or a similar word precedes; tools omit the `;` there.
    fn closed(&self) -> bool {
        let before = self.text.get(..self.behind()).unwrap_or("");
        let word = before.rsplit(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("");
        closes(word)
    }

    fn statement(&mut self, list: &mut Vec<Stmt>) {
        let start = self.token().start;
        let kind = match self.word().as_str() {
            "IF" => self.if_statement(),
            "CASE" => self.case_statement(),
            "FOR" => self.for_statement(),
            "WHILE" => {
                self.bump();
                let condition = self.expr();
                self.expect_word("DO");
                let body = self.nested();
                self.expect_word("END_WHILE");
                Some(StmtKind::While(condition, body))
            }
            "REPEAT" => {
                self.bump();
                let body = self.nested();
                self.expect_word("UNTIL");
                let condition = self.expr();
                self.eat(";");
                self.expect_word("END_REPEAT");
                Some(StmtKind::Repeat(body, condition))
            }
            "EXIT" => {
                self.bump();
                Some(StmtKind::Exit)
            }
            "RETURN" => {
                self.bump();
                Some(StmtKind::Return)
            }
            "CONTINUE" | "JMP" | "GOTO" => {
                let at = self.here();
                let what = say!("`{}` has no counterpart", self.word());
                self.say(&codes::NOT_CARRIED, &at, what);
                self.recover();
                None
            }
            _ => return self.simple(list),
        };
        self.end_statement();
        if let Some(kind) = kind {
            list.push(Stmt { kind, at: self.since(start).into() });
        }
    }

    /// Reads statements one level deeper.
    fn nested(&mut self) -> Vec<Stmt> {
        if !self.enter() {
            return Vec::new();
        }
        let list = self.statements();
        self.leave();
        list
    }

    fn if_statement(&mut self) -> Option<StmtKind> {
        self.bump();
        let mut arms = Vec::new();
        loop {
            let condition = self.expr();
            self.expect_word("THEN");
            arms.push((condition, self.nested()));
            if !self.eat_word("ELSIF") {
                break;
            }
        }
        let otherwise = if self.eat_word("ELSE") { self.nested() } else { Vec::new() };
        self.expect_word("END_IF");
        Some(StmtKind::If(arms, otherwise))
    }

    fn case_statement(&mut self) -> Option<StmtKind> {
        self.bump();
        let selector = self.expr();
        self.expect_word("OF");
        if !self.enter() {
            return None;
        }
        let mut arms: Vec<CaseArm> = Vec::new();
        while !self.at_end() && !matches!(self.word().as_str(), "ELSE" | "END_CASE") {
            let before = self.mark();
            let mut labels = Vec::new();
            loop {
                let from = self.expr();
                let to = self.eat("..").then(|| self.expr());
                labels.push((from, to));
                if !self.eat(",") {
                    break;
                }
            }
            self.expect(":");
            let body = self.arm();
            arms.push(CaseArm { labels, body });
            if self.mark() == before {
                self.bump();
            }
        }
        let otherwise = if self.eat_word("ELSE") {
            self.eat(":");
            self.statements()
        } else {
            Vec::new()
        };
        self.leave();
        self.expect_word("END_CASE");
        Some(StmtKind::Case(selector, arms, otherwise))
    }

    /// Reads the statements of an arm, which end at the labels of the next one.
    fn arm(&mut self) -> Vec<Stmt> {
        let mut list = Vec::new();
        loop {
            while self.eat(";") {}
            if self.at_end() || self.at_closing() || self.at_labels() {
                return list;
            }
            let before = self.mark();
            self.statement(&mut list);
            if self.mark() == before {
                self.expected(say!("a statement"));
                self.bump();
                self.recover();
            }
        }
    }

    /// True if labels and their `:` follow.
    fn at_labels(&self) -> bool {
        let mut n = 0;
        loop {
            let token = self.ahead(n);
            match token.kind {
                Kind::Number | Kind::Typed | Kind::Word => {}
                Kind::Sign => match self.slice(token) {
                    ":" => return n > 0,
                    "-" | "," | ".." | "." => {}
                    _ => return false,
                },
                _ => return false,
            }
            n += 1;
            if n > 200 {
                return false;
            }
        }
    }

    fn for_statement(&mut self) -> Option<StmtKind> {
        self.bump();
        let at = self.here();
        let variable = self.variable();
        self.expect(":=");
        let from = self.expr();
        self.expect_word("TO");
        let to = self.expr();
        let by = self.eat_word("BY").then(|| self.expr());
        self.expect_word("DO");
        let body = self.nested();
        self.expect_word("END_FOR");
        let var = match variable.kind {
            ExprKind::Path(path) if path.names.len() == 1 => path.names.into_iter().next(),
            ExprKind::Bad => None,
            _ => {
                self.report.say(&codes::NOT_CARRIED, &at, say!("only a plain variable can count a loop"));
                None
            }
        };
        Some(StmtKind::For { var: var?, from, to, by, body })
    }

    /// Reads an assignment or a call.
    fn simple(&mut self, list: &mut Vec<Stmt>) {
        let start = self.token().start;
        if self.token().kind == Kind::Word && self.ahead_is(1, "(") {
            let name = self.name(say!("a function block"));
            let args = self.args();
            self.end_statement();
            let Some(name) = name else { return };
            if name.text.eq_ignore_ascii_case("SUPER") || closes(&name.text) {
                return;
            }
            let kind = StmtKind::Call(Path { names: vec![name] }, args.list);
            list.push(Stmt { kind, at: self.since(start).into() });
            return;
        }
        let direct = self.token().kind == Kind::Direct;
        if !direct && self.token().kind != Kind::Word && !self.at(".") {
            return;
        }
        let target = self.target();
        // CODESYS has `x S= e` and `x R= e`.
        for (word, value) in [("S", true), ("R", false)] {
            if self.at_word(word) && self.ahead_is(1, "=") {
                self.bump();
                self.bump();
                let condition = self.expr();
                self.end_statement();
                let at = self.since(start).into();
                let value = Expr { kind: ExprKind::Literal(Literal::Bool(value)), at };
                let body = vec![Stmt { kind: StmtKind::Assign { target, value }, at }];
                list.push(Stmt { kind: StmtKind::If(vec![(condition, body)], Vec::new()), at });
                return;
            }
        }
        if self.at("(") {
            return self.method(target, list, start);
        }
        if !self.at(":=") {
            if self.at(";") {
                let at = self.since(start);
                self.report.put(g7_model::Problem::new(
                    &codes::BAD_TEXT,
                    at,
                    say!("a name alone is no statement"),
                ));
            } else {
                self.expected(say!("`:=`"));
            }
            self.recover();
            return self.end_statement();
        }
        self.assignments(target, list, start);
        self.end_statement();
    }

    /// `a := b := e` assigns `b` first.
    fn assignments(&mut self, target: Expr, list: &mut Vec<Stmt>, start: u32) {
        let mut targets = vec![target];
        let mut value = None;
        while self.eat(":=") {
            let next = self.expr();
            if self.at(":=") {
                targets.push(next);
            } else {
                value = Some(next);
            }
        }
        let at = self.since(start).into();
        let Some(mut value) = value else { return };
        while let Some(target) = targets.pop() {
            let next = target.clone();
            if target.kind != ExprKind::Bad {
                list.push(Stmt { kind: StmtKind::Assign { target, value }, at });
            }
            value = next;
        }
    }

    fn target(&mut self) -> Expr {
        if self.token().kind == Kind::Direct {
            return self.expr();
        }
        self.eat(".");
        self.variable()
    }

    /// `a.b(…)`, `a[i](…)`: a function block in a structure or an array.
    fn method(&mut self, target: Expr, list: &mut Vec<Stmt>, start: u32) {
        let args: Vec<Arg> = self.args().list;
        self.end_statement();
        if let Some(path) = self.called(target) {
            let kind = StmtKind::Call(path, args);
            list.push(Stmt { kind, at: self.since(start).into() });
        }
    }

    /// The path of a function block that is called. An index at its end is a part of the name.
    pub(crate) fn called(&mut self, e: Expr) -> Option<Path> {
        let at = e.at.0;
        let (path, index) = match e.kind {
            ExprKind::Path(path) => return Some(path),
            ExprKind::Element(path, index, None) => (*path, index),
            _ => return None,
        };
        if let Some(names) = instance(&path, &index) {
            return Some(Path { names });
        }
        let what = say!(
            "the index of a function block that is called is one number, a name, or a name with a number added"
        );
        self.report.put(g7_model::Problem::new(&codes::NOT_CARRIED, at, what));
        None
    }
}

/// The names of an instance with the indexes in them.
fn instance(path: &Path, index: &[Expr]) -> Option<Vec<Name>> {
    let mut names: Vec<Name> = Vec::new();
    for (part, own) in element_parts(path, index) {
        names.extend(part.names);
        match (own, names.last_mut()) {
            ([], _) => {}
            ([one], Some(last)) => last.text = format!("{}[{}]", last.text, chosen(one)?).into(),
            _ => return None,
        }
    }
    Some(names)
}

/// The text of an index that a name of an instance can have: `3`, `i`, `i + 1`.
fn chosen(index: &Expr) -> Option<String> {
    let name = |e: &Expr| match &e.kind {
        ExprKind::Path(path) if path.names.len() == 1 => path.names.first().map(|n| n.text.to_string()),
        _ => None,
    };
    let added = |e: &Expr| e.kind.whole().filter(|n| *n >= 0);
    match &index.kind {
        ExprKind::Binary(BinaryOp::Add, a, b) => Some(format!("{} + {}", name(a)?, added(b)?)),
        ExprKind::Binary(BinaryOp::Sub, a, b) => Some(format!("{} - {}", name(a)?, added(b)?)),
        kind => kind.whole().map(|n| n.to_string()).or_else(|| name(index)),
    }
}

/// Words that end a list of statements.
fn ends(word: &str) -> bool {
    matches!(word, "ELSE" | "ELSIF" | "UNTIL" | "VAR_GLOBAL") || closes(word)
}

/// Words that end a list if a name follows; elsewhere they are names.
fn begins(word: &str) -> bool {
    matches!(
        word,
        "STEP"
            | "INITIAL_STEP"
            | "TRANSITION"
            | "ACTION"
            | "PROGRAM"
            | "FUNCTION"
            | "FUNCTION_BLOCK"
            | "CONFIGURATION"
    )
}
