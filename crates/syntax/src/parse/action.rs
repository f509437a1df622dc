//! The actions of a step.

use super::Parser;
use crate::lexer::Tok;
use crate::words;
use g7_model::{
    Action, ActionKind, Expr, ExprKind, Name, Order, Path, Problem, Qualifier, Situation, Span, Stmt, Target,
    Work, codes, say,
    words::{ACTION, has, texts},
};

/// Every word that an action can begin with.
fn beginnings() -> Vec<&'static str> {
    Qualifier::ALL.into_iter().map(Qualifier::name).chain(texts(ACTION)).collect()
}

fn begins_action(word: &str) -> bool {
    has(ACTION, word) || Qualifier::named(word).is_some()
}

impl Parser<'_> {
    /// Reads actions up to the closing brace, and that brace; the opening one stands at `open`.
    pub(super) fn actions(&mut self, open: Span) -> Vec<Action> {
        let mut actions = Vec::new();
        loop {
            self.skip_semis();
            if self.eat(Tok::RBrace) {
                return actions;
            }
            if self.at(Tok::End) || self.cur.newline && self.at_next_item() {
                self.close(Tok::RBrace, say!("`}}` after the actions of the step"), open);
                return actions;
            }
            let start = self.cur.start;
            let kind = match self.line(Parser::action) {
                None if self.correct(&beginnings()) => self.line(Parser::action),
                kind => kind,
            };
            match kind {
                Some(kind) if self.cur.start > start => {
                    if actions.is_empty() {
                        actions.reserve_exact(1); // most steps have one
                    }
                    actions.push(Action { kind, at: self.since(start).into() });
                }
                _ => actions.extend(self.line(|p| p.lost_action(start))),
            }
        }
    }

    /// True if a word stands here that begins an item of a chart or file.
    fn at_next_item(&mut self) -> bool {
        self.at_chart_start() || self.at_file_start() || self.var_kind().is_some()
    }

    fn action(&mut self) -> Option<ActionKind> {
        if self.at(Tok::Comment) {
            return self.comment_if().map(ActionKind::Comment);
        }
        let word = self.word();
        if word.is_empty() || self.misplaced_assignment() {
            return None;
        }
        let order = match word {
            "on" => return Some(self.on_event()),
            "each" => return Some(self.each_scan()),
            "force" => self.force(),
            "enable" => {
                self.bump();
                Order::Enable(self.chart_name(say!("the name of a chart")))
            }
            "mask" => {
                self.bump();
                Order::Mask(self.chart_name(say!("the name of a chart or of an output")))
            }
            "call" => {
                self.bump();
                Order::Call(self.chart_name(say!("the name of a task")))
            }
            "enclose" => {
                self.bump();
                Order::Enclose(self.chart_name(say!("the name of a chart")))
            }
            _ => return self.qualified(),
        };
        Some(ActionKind::Order(order))
    }

    /// True if an assignment without a qualifier stands here. Its variable may have the name of a
    /// word that begins an action.
    fn misplaced_assignment(&mut self) -> bool {
        matches!(self.peek().kind, Tok::Assign | Tok::PathDot)
    }

    /// `on e: …`.
    fn on_event(&mut self) -> ActionKind {
        self.bump();
        let event = self.condition();
        self.expect(Tok::Colon, say!("`:` after the event"));
        ActionKind::OnEvent { event, work: self.work() }
    }

    /// `each scan: …`.
    fn each_scan(&mut self) -> ActionKind {
        self.bump();
        if !self.eat_word("scan") {
            self.expected_help(say!("`scan`"), Some(say!("write `each scan: n := n + 1`")));
        }
        self.expect(Tok::Colon, say!("`:`"));
        let work = self.work();
        ActionKind::EachScan { work, condition: self.if_condition() }
    }

    fn if_condition(&mut self) -> Option<Expr> {
        self.eat_word("if").then(|| self.condition())
    }

    /// `force G := …`.
    fn force(&mut self) -> Order {
        self.bump();
        let chart = self.chart_name(say!("the name of a chart"));
        self.assign_sign();
        if self.eat_word("INIT") {
            return Order::Force(chart, Situation::Init);
        }
        let open = self.here();
        if self.at_name() {
            let text = format!("{{{}}}", self.slice(self.cur));
            self.slip_to(open, say!("the steps of a situation stand in braces"), &text);
            return Order::Force(chart, Situation::Steps(self.names(say!("the name of a step"))));
        }
        if !self.expect(Tok::LBrace, say!("a situation: `{{8, 11}}`, `{{}}`, `{{*}}` or `INIT`")) {
            return Order::Force(chart, Situation::Current);
        }
        if self.eat(Tok::Star) {
            self.close(Tok::RBrace, say!("`}}`"), open);
            return Order::Force(chart, Situation::Current);
        }
        let bare_init = self.at_word("INIT") && self.peek().kind == Tok::RBrace;
        let mut steps: Vec<Name> = Vec::new();
        while !matches!(self.cur.kind, Tok::RBrace | Tok::End) {
            let start = self.cur.start;
            let name = self.name(say!("the name of a step"));
            if self.cur.start == start {
                break;
            }
            steps.push(name);
            if !self.eat(Tok::Comma) {
                break;
            }
        }
        self.close(Tok::RBrace, say!("`}}` or `,`"), open);
        Order::Force(chart, if bare_init { Situation::Init } else { Situation::Steps(steps) })
    }

    /// `P1 n := n + 1`, `L 5s lamp`.
    fn qualified(&mut self) -> Option<ActionKind> {
        let word = self.word();
        let qualifier = Qualifier::named(word)?;
        let at = self.here();
        self.bump();
        let time = self.action_time(qualifier, at);
        let target = self.target_of_action();
        Some(ActionKind::Qualified { qualifier, time, target, condition: self.if_condition() })
    }

    /// The time of L, D, SD, DS and SL.
    fn action_time(&mut self, qualifier: Qualifier, at: Span) -> Option<Expr> {
        let name = qualifier.name();
        let kind = self.cur.kind;
        let time = match kind {
            Tok::Time => {
                let token = self.bump();
                Some(self.time_of(token))
            }
            Tok::LParen => Some(self.expr_in_parens()),
            Tok::Int | Tok::Real if self.unit_ahead() => Some(self.loose_time()),
            Tok::Int | Tok::Real if self.peek().kind != Tok::PathDot && qualifier.timed() => {
                Some(self.bare_time())
            }
            _ => None,
        };
        match &time {
            None if qualifier.timed() => {
                let next = self.peek();
                let named = self.at_name() && !next.newline && matches!(next.kind, Tok::Word | Tok::Ticked);
                if named && self.slice(next) != "if" {
                    self.slip(
                        self.here(),
                        say!("a time that is no number stands in parentheses"),
                        say!("write `(t)`"),
                    );
                    return Some(self.expr());
                }
                let help = say!("write `{name} 5s …`");
                if !matches!(self.cur.kind, Tok::Line | Tok::RBrace | Tok::End) {
                    self.slip(at, say!("`{name}` needs a time"), help);
                } else {
                    self.expected_help(say!("a time and a variable"), Some(help));
                }
            }
            Some(e) if !qualifier.timed() => {
                let place = e.at.0;
                let help = say!("the qualifiers L, D, SD, DS and SL take a time");
                self.slip(place, say!("`{name}` takes no time"), help);
            }
            _ => {}
        }
        time
    }

    pub(super) fn expr_in_parens(&mut self) -> Expr {
        let open = self.here();
        self.bump();
        let e = self.expr();
        self.close(Tok::RParen, say!("`)`"), open);
        e
    }

    /// A Boolean variable, a named action, an assignment, a call or a block.
    fn target_of_action(&mut self) -> Target {
        let start = self.cur.start;
        if self.at(Tok::LBrace) {
            return Target::Work(Work::Block(self.block(say!("`{{`"))));
        }
        if self.at(Tok::Direct) {
            let token = self.bump();
            let name = self.direct_name(token);
            let at = self.since(start).into();
            if !matches!(self.cur.kind, Tok::Assign | Tok::Eq) {
                return Target::Direct(name, at);
            }
            return self.assigned(Expr { kind: ExprKind::Direct(name), at }, start);
        }
        if !self.at_name() {
            self.expected(say!("a variable, the name of an action, an assignment or `{{`"));
            return Target::Path(Path { names: vec![Name::new("", self.behind())] });
        }
        let path = self.path();
        if self.at_call() {
            let kind = g7_model::StmtKind::Call(path, self.call_args());
            return Target::Work(Work::Single(Box::new(Stmt { kind, at: self.since(start).into() })));
        }
        let kind = self.variable_of(path);
        let counted = matches!(self.cur.kind, Tok::Plus | Tok::Minus)
            && matches!(self.peek().kind, Tok::Eq | Tok::Plus | Tok::Minus);
        let at = self.since(start).into();
        if counted || matches!(self.cur.kind, Tok::Assign | Tok::Eq) {
            return self.assigned(Expr { kind, at }, start);
        }
        match kind {
            ExprKind::Path(path) => Target::Path(path),
            kind => Target::Element(Box::new(Expr { kind, at })),
        }
    }

    fn assigned(&mut self, target: Expr, start: u32) -> Target {
        let kind = self.assignment(target);
        Target::Work(Work::Single(Box::new(Stmt { kind, at: self.since(start).into() })))
    }

    /// Reads an unknown word before a target as `N`.
    fn unknown_qualifier(&mut self, start: u32) -> Option<Action> {
        let next = self.peek();
        let before_target = match next.kind {
            Tok::Word => !words::is_reserved(self.slice(next)),
            kind => matches!(kind, Tok::Ticked | Tok::Direct | Tok::Time),
        };
        if !self.at(Tok::Word) || !self.at_name() || next.newline || !before_target {
            return None;
        }
        self.unknown(self.word(), say!("a qualifier"), &beginnings());
        self.duration_if();
        let target = self.target_of_action();
        let condition = self.if_condition();
        let kind = ActionKind::Qualified { qualifier: Qualifier::N, time: None, target, condition };
        Some(Action { kind, at: self.since(start).into() })
    }

    /// Reports text that begins no action. A variable or an assignment alone is read as the action
    /// that was probably meant.
    fn lost_action(&mut self, start: u32) -> Option<Action> {
        let at = self.here();
        if let Some(action) = self.unknown_qualifier(start) {
            return Some(action);
        }
        if self.at(Tok::Direct) || self.at_name() && !self.at(Tok::Int) {
            let target = self.target_of_action();
            let assigned = matches!(target, Target::Work(_));
            let text = self.text.get(start as usize..self.prev.end as usize).unwrap_or_default();
            let short: String = text.chars().take(40).collect();
            let qualifier = if assigned { Qualifier::P1 } else { Qualifier::N };
            self.lexer.problems.add(at, || {
                let problem = Problem::new(&codes::EXPECTED, at, say!("an action begins with its qualifier"));
                problem.help(if assigned {
                    say!("write `P1 {short}` (once, on activation) or `each scan: {short}`")
                } else {
                    say!("write `N {short}` (while the step is active) or `S {short}` (until reset)")
                })
            });
            self.told = Some(self.cur.start);
            let condition = self.if_condition();
            let kind = ActionKind::Qualified { qualifier, time: None, target, condition };
            return Some(Action { kind, at: self.since(start).into() });
        }
        self.unexpected(say!("an action or `}}`"), None);
        if self.cur.start == start {
            self.bump();
        }
        self.recover(|p| begins_action(p.word()) || p.at_next_item());
        None
    }
}
