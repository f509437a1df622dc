//! Tests, properties and the layout.

use super::Parser;
use super::marks::Level;
use crate::lexer::Tok;
use crate::words::St;
use g7_iec::constant;
use g7_model::{
    ActionForm, BinaryOp, Expr, ExprKind, Layout, LinkForm, Name, PlaceAt, Placed, Problem, Property,
    PropertyKind, Said, Scenario, Span, TestStmt, TestStmtKind, codes, say, words,
};

impl Parser<'_> {
    /// `test "…" { … }`.
    pub(super) fn test(&mut self) -> Scenario {
        let start = self.cur.start;
        let (title, plant, seed) = self.head(Parser::test_head);
        let body = self.test_block();
        Scenario { title, plant, seed, body, at: self.since(start).into() }
    }

    /// The title, the plant and the seed.
    fn test_head(&mut self) -> (Box<str>, Option<Name>, Option<u64>) {
        self.bump();
        let title = self.text_if().unwrap_or_else(|| {
            self.expected(say!("the title of the test in double quotes"));
            "".into()
        });
        let plant = self.with_plant();
        let seed = if self.eat_word("seed") {
            let seed = self.integer_if(u64::MAX);
            if seed.is_none() {
                self.expected(say!("a whole number"));
            }
            seed
        } else {
            None
        };
        (title, plant, seed)
    }

    fn test_block(&mut self) -> Vec<TestStmt> {
        let open = self.here();
        let mut list = Vec::new();
        if !self.at(Tok::LBrace) {
            self.expected(say!("`{{` and what happens in the test"));
            return list;
        }
        if !self.enter() {
            return list;
        }
        self.bump();
        loop {
            self.skip_semis();
            if self.eat(Tok::RBrace) {
                break;
            }
            if self.at(Tok::End) || self.cur.newline && self.at_file_start() {
                self.close(Tok::RBrace, say!("`}}` after the statements of the test"), open);
                break;
            }
            let start = self.cur.start;
            let kind = match self.line(Parser::test_statement) {
                None if self.correct(&words::texts(words::TEST)) => self.line(Parser::test_statement),
                kind => kind,
            };
            match kind {
                Some(kind) => list.push(TestStmt { kind, at: self.since(start).into() }),
                None => self.lost_test_statement(start),
            }
        }
        self.leave();
        list
    }

    fn lost_test_statement(&mut self, start: u32) {
        if self.at_name() && matches!(self.peek().kind, Tok::Assign | Tok::Eq) {
            self.unexpected(say!("a statement of a test"), Some(say!("inputs are moved by `set a := TRUE`")));
        } else {
            let help = match self.word() {
                "assert" | "check" | "verify" => say!("a condition is asked by `expect a`"),
                _ => say!("there are {}", Said::foreign(words::texts(words::TEST).join(", "))),
            };
            self.unexpected(say!("a statement of a test"), Some(help));
        }
        if self.cur.start == start {
            self.bump();
        }
        self.recover(|p| p.at(Tok::Word));
    }

    fn test_statement(&mut self) -> Option<TestStmtKind> {
        if self.at(Tok::Comment) {
            return self.comment_if().map(TestStmtKind::Comment);
        }
        Some(match self.word() {
            "set" => self.set(),
            "pulse" => {
                self.bump();
                let target = self.settable(say!("the name of an input"));
                let time = self.eat_st(St::For).then(|| self.duration(say!("a duration")));
                TestStmtKind::Pulse(target, time)
            }
            "wait" => self.wait(),
            "scan" => {
                self.bump();
                let n =
                    self.integer_if(u64::from(u32::MAX)).map_or(1, |n| u32::try_from(n).unwrap_or(u32::MAX));
                TestStmtKind::Scan(n)
            }
            "expect" => self.expectation(),
            "always" => {
                self.bump();
                let list = self.conditions();
                TestStmtKind::Always(list, self.test_block())
            }
            "force" => {
                self.bump();
                let (target, value) = self.target_and_value();
                TestStmtKind::Force(target, value)
            }
            "release" => {
                self.bump();
                TestStmtKind::Release(self.settable(say!("the name of a variable")))
            }
            "restart" => {
                self.bump();
                TestStmtKind::Restart { cold: self.eat_word("cold") }
            }
            "repeat" => {
                self.bump();
                let n = self.integer_u32(say!("how many times"));
                TestStmtKind::Repeat(n, self.test_block())
            }
            _ => return None,
        })
    }

    /// A name, or a direct name such as `%S21`.
    fn settable(&mut self, what: Said) -> Expr {
        let start = self.cur.start;
        let kind = if self.at(Tok::Direct) {
            let token = self.bump();
            ExprKind::Direct(self.direct_name(token))
        } else {
            let path = self.path_or_empty(what);
            self.variable_of(path)
        };
        Expr { kind, at: self.since(start).into() }
    }

    fn target_and_value(&mut self) -> (Expr, Expr) {
        let target = self.settable(say!("the name of a variable"));
        let value = if self.assign_sign() { self.expr() } else { self.bad() };
        (target, value)
    }

    fn set(&mut self) -> TestStmtKind {
        self.bump();
        let mut list = vec![self.target_and_value()];
        while self.eat(Tok::Comma) {
            list.push(self.target_and_value());
        }
        TestStmtKind::Set(list)
    }

    fn wait(&mut self) -> TestStmtKind {
        self.bump();
        if self.st_word() == Some(St::For) {
            self.slip(self.here(), say!("`wait` takes its duration alone"), say!("leave out `for`"));
            self.bump();
        }
        if !self.eat_st(St::Until) {
            return TestStmtKind::Wait(self.duration(say!("a duration or `until`")));
        }
        let e = self.condition();
        let within = self.eat_word("within").then(|| self.duration(say!("a duration")));
        TestStmtKind::WaitUntil(e, within)
    }

    /// `expect fault unstable`, or `expect a, not b`.
    fn expectation(&mut self) -> TestStmtKind {
        self.bump();
        if !self.at_word("fault") {
            return TestStmtKind::Expect(self.conditions());
        }
        self.bump();
        let named = match self.cur.kind {
            Tok::Word => !words::has(words::TEST, self.word()) && self.at_name(),
            kind => kind == Tok::Ticked,
        };
        TestStmtKind::ExpectFault(if named { self.name_if() } else { None })
    }

    fn conditions(&mut self) -> Vec<Expr> {
        let mut list = vec![self.condition()];
        while self.eat(Tok::Comma) {
            list.push(self.condition());
        }
        list
    }

    /// `prove …`.
    pub(super) fn property(&mut self) -> Property {
        let start = self.bump().start;
        let word = self.word();
        let kind = match word {
            "always" => {
                self.bump();
                PropertyKind::Always(self.condition())
            }
            "never" => {
                self.bump();
                PropertyKind::Never(self.condition())
            }
            "reachable" => {
                self.bump();
                PropertyKind::Reachable(self.condition())
            }
            "after" => self.response(),
            "between" => self.between(),
            "at" if self.peek_word("most") => self.at_most(),
            // `and(a, b)` is the function of the operator.
            _ if BinaryOp::of_word(word).is_some() && self.peek_call() => self.leads_to(),
            _ if self.at_expr() && !self.is_before_condition() => self.leads_to(),
            _ => {
                let forms = ["always", "never", "reachable", "after", "between", "at most"];
                self.unknown(word, say!("a form of property"), &forms);
                PropertyKind::Always(if self.at_expr() { self.condition() } else { self.bad() })
            }
        };
        let plant = self.with_plant();
        let comment = self.comment_if();
        Property { kind, plant, comment, at: self.since(start).into() }
    }

    /// `with Tank`.
    fn with_plant(&mut self) -> Option<Name> {
        self.eat_word("with").then(|| self.name(say!("the name of a plant")))
    }

    /// `assume e`.
    pub(super) fn assumption(&mut self) -> Property {
        let start = self.bump().start;
        let kind = PropertyKind::Assume(self.claim());
        let comment = self.comment_if();
        Property { kind, plant: None, comment, at: self.since(start).into() }
    }

    /// True at a word with a condition right behind it, such as `alwys a`.
    fn is_before_condition(&mut self) -> bool {
        let next = self.peek();
        let word = self.slice(next);
        self.at(Tok::Word)
            && !next.newline
            && !crate::words::is_reserved(self.word())
            && match next.kind {
                Tok::Word => {
                    word != "leads" && (!crate::words::is_reserved(word) || matches!(word, "not" | "NOT"))
                }
                kind => kind == Tok::Ticked,
            }
    }

    /// A condition that a word of its own leads in.
    fn claim(&mut self) -> Expr {
        if self.at_expr() {
            return self.condition();
        }
        self.expected(say!("a condition"));
        self.bad()
    }

    /// `a leads to b`.
    fn leads_to(&mut self) -> PropertyKind {
        let cause = self.condition();
        if !(self.eat_word("leads") && self.eat_word("to")) {
            self.expected(say!("`leads to` and a condition"));
        }
        PropertyKind::LeadsTo(cause, self.claim())
    }

    /// `between a and b never e`. An `and` within the first condition needs parentheses.
    fn between(&mut self) -> PropertyKind {
        self.bump();
        let first = self.operand_above(BinaryOp::And);
        if !self.eat_word("and") {
            self.expected(say!("`and` and a condition"));
        }
        let second = self.claim();
        if !self.eat_word("never") {
            self.expected(say!("`never` and a condition"));
        }
        PropertyKind::Between(first, second, self.claim())
    }

    /// `at most 1 of (a, b, c)`.
    fn at_most(&mut self) -> PropertyKind {
        self.bump();
        self.bump();
        let count = self.integer_u32(say!("how many may hold at once"));
        if !self.eat_word("of") {
            self.expected(say!("`of` and conditions in parentheses"));
        }
        let open = self.here();
        let mut list = Vec::new();
        if self.expect(Tok::LParen, say!("`(` and conditions")) {
            list = self.conditions();
            self.close(Tok::RParen, say!("`)` after the conditions"), open);
        }
        PropertyKind::AtMost(count, list)
    }

    /// `after a within 5s expect b`, or `after a until b expect e`.
    fn response(&mut self) -> PropertyKind {
        self.bump();
        let first = self.condition();
        if self.eat_st(St::Until) {
            let end = self.claim();
            if !self.eat_word("expect") {
                self.expected(say!("`expect` and a condition"));
            }
            return PropertyKind::Until(first, end, self.claim());
        }
        if !self.eat_word("within") {
            self.expected(say!("`within` and a duration, or `until` and a condition"));
        }
        let time = self.duration(say!("a duration"));
        if !self.eat_word("expect") {
            self.expected(say!("`expect` and a condition"));
        }
        PropertyKind::After(first, time, self.claim())
    }

    /// `layout Main { … }`.
    pub(super) fn layout(&mut self) -> Layout {
        let start = self.cur.start;
        let chart = self.head(|p| {
            p.bump();
            p.name(say!("the name of a chart"))
        });
        let open = self.here();
        let mut places = Vec::new();
        if self.expect(Tok::LBrace, say!("`{{` and the places")) {
            self.places(&mut places, open);
        }
        Layout { chart, places, at: self.since(start).into() }
    }

    /// The places up to the end of the layout, or to where the rest is known.
    pub(super) fn places(&mut self, places: &mut Vec<PlaceAt>, open: Span) {
        loop {
            self.skip_semis();
            if self.mark(places.len(), Level::Layout(open)) {
                return;
            }
            match self.line(Parser::place_at) {
                Some(place) => places.push(place),
                None => break,
            }
        }
        self.close(Tok::RBrace, say!("`}}` after the places"), open);
    }

    fn place_at(&mut self) -> Option<PlaceAt> {
        let start = self.cur.start;
        let what = match self.word() {
            "step" | "transition" => self.placed_symbol()?,
            "link" => {
                self.bump();
                let from = self.link_end()?;
                self.expect(Tok::Arrow, say!("`->`"));
                let ends = Box::new((from, self.link_end()?));
                if self.eat_word("as") { self.link_form(ends) } else { Placed::Link(ends) }
            }
            "actions" => {
                self.bump();
                self.action_form()
            }
            "sheet" => {
                self.bump();
                Placed::Sheet
            }
            "comment" => {
                self.bump();
                let text = self.text_if();
                if text.is_none() {
                    self.expected(say!("the text of the comment in double quotes"));
                }
                Placed::Comment(text.unwrap_or_default())
            }
            _ => return None,
        };
        if !what.has_place() {
            return Some(PlaceAt { what, x: 0, y: 0, then: Vec::new(), at: self.since(start).into() });
        }
        if !self.eat_word("at") {
            self.expected(say!("`at` and a place such as `(0, 1.5)`"));
        }
        let (x, y) = self.point();
        let mut then = Vec::new();
        while matches!(what, Placed::Link(_)) && self.eat(Tok::Comma) {
            then.push(self.point());
        }
        Some(PlaceAt { what, x, y, then, at: self.since(start).into() })
    }

    /// `step 2`, `transition t7` or `transition #0`; `None` for anything else.
    fn placed_symbol(&mut self) -> Option<Placed> {
        let is_step = match self.word() {
            "step" => true,
            "transition" => false,
            _ => return None,
        };
        self.bump();
        Some(if is_step {
            Placed::Step(self.name(say!("the name of a step")))
        } else if self.eat(Tok::Hash) {
            Placed::TransitionNumber(self.integer_u32(say!("the transition's place in the text, from 0")))
        } else {
            Placed::Transition(self.name(say!("the label of a transition, or `#` and its place in the text")))
        })
    }

    /// `of step 3 in row`, or `in row` for all steps.
    fn action_form(&mut self) -> Placed {
        let step = self.eat_word("of").then(|| {
            if !self.eat_word("step") {
                self.expected(say!("`step` and the name of a step"));
            }
            Box::new(Placed::Step(self.name(say!("the name of a step"))))
        });
        let is_in = self.eat_word("in");
        match ActionForm::ALL.into_iter().find(|form| is_in && self.eat_word(form.word())) {
            Some(form) => Placed::Actions(step, form),
            None => {
                self.expected(say!("`in row` or `in column`"));
                Placed::Actions(step, ActionForm::Column)
            }
        }
    }

    /// `line` or `jump`.
    fn link_form(&mut self, ends: Box<(Placed, Placed)>) -> Placed {
        match LinkForm::ALL.into_iter().find(|form| self.eat_word(form.word())) {
            Some(form) => Placed::LinkForm(ends, form),
            None => {
                self.expected(say!("`line` or `jump`"));
                Placed::LinkForm(ends, LinkForm::Line)
            }
        }
    }

    /// One end of a link.
    fn link_end(&mut self) -> Option<Placed> {
        let end = self.placed_symbol();
        if end.is_none() {
            self.expected(say!("`step` or `transition`, an end of the link"));
        }
        end
    }

    /// `(0, 1.5)`, in hundredths.
    fn point(&mut self) -> (i32, i32) {
        let open = self.here();
        self.expect(Tok::LParen, say!("`(`"));
        let x = self.hundredths();
        self.expect(Tok::Comma, say!("`,`"));
        let y = self.hundredths();
        self.close(Tok::RParen, say!("`)`"), open);
        (x, y)
    }

    /// A number in hundredths, rounded.
    fn hundredths(&mut self) -> i32 {
        let negative = self.eat(Tok::Minus);
        if !matches!(self.cur.kind, Tok::Int | Tok::Real) {
            self.expected(say!("a number"));
            return 0;
        }
        let token = self.bump();
        let at = self.span_of(token);
        let value = constant::real(self.slice(token)).ok().and_then(|t| t.parse::<f64>().ok());
        let value = value.map(|v| (v * 100.0).round()).filter(|v| *v <= f64::from(i32::MAX));
        let Some(value) = value else {
            self.lexer.problems.add(at, || {
                Problem::new(
                    &codes::BAD_NUMBER,
                    at,
                    say!("a place is a decimal number of at most 21474836.47"),
                )
            });
            return 0;
        };
        #[allow(clippy::cast_possible_truncation, reason = "bounded above by the filter, and not negative")]
        let value = value as i32;
        if negative { -value } else { value }
    }
}
