//! Charts: steps and transitions.

use super::Parser;
use super::marks::Level;
use crate::lexer::Tok;
use g7_model::{
    Chart, ChartItem, ChartKind, Expr, ExprKind, Fix, Name, Nanos, Place, Problem, Said, Span, Step,
    StepKind, Transition, codes, say, words,
};

/// The words that a step can begin with.
const STEP_WORDS: [&str; 6] = ["initial", "entry", "exit", "enclosing", "step", "macro"];

/// A slip that is told in two places: the words, and the way out.
fn step_in_transition() -> (Said, Said) {
    (say!("only the name of the step stands in a transition"), say!("leave out `step`"))
}

impl Parser<'_> {
    /// A chart, an expansion or a task; its first word is in hand.
    pub(super) fn chart(&mut self) -> Chart {
        let kind = match self.word() {
            "macrochart" => ChartKind::Expansion,
            "task" => ChartKind::Task,
            _ => ChartKind::Chart,
        };
        let start = self.cur.start;
        let (name, params, block, comment, every) = self.head(|p| {
            p.bump();
            let name = p.name(say!("the name of the chart"));
            let params = if p.at_call() { p.params() } else { Vec::new() };
            let block = p.eat_word("of").then(|| p.name(say!("the name of a function block")));
            (name, params, block, p.comment_if(), p.period(kind))
        });
        let open = self.here();
        let mut items = Vec::new();
        if self.expect(Tok::LBrace, say!("`{{` and the steps of the chart")) || self.at_chart_start() {
            self.chart_items(&mut items, open);
        }
        Chart { kind, name, params, block, comment, every, items, at: self.since(start).into() }
    }

    /// `every 20ms`.
    fn period(&mut self, kind: ChartKind) -> Option<Nanos> {
        let at = self.here();
        if !self.eat_word("every") {
            return None;
        }
        if kind != ChartKind::Chart {
            self.slip(
                at,
                say!("only a `chart` has a period"),
                say!("write `every` at the chart that uses this one"),
            );
        }
        Some(self.duration(say!("the period, a duration"))).filter(|_| kind == ChartKind::Chart)
    }

    /// The items up to the end of the chart, or to where the rest is known.
    pub(super) fn chart_items(&mut self, items: &mut Vec<ChartItem>, open: Span) {
        loop {
            self.skip_semis();
            if self.mark(items.len(), Level::Chart(open)) {
                return;
            }
            match self.cur.kind {
                Tok::RBrace => {
                    self.bump();
                    return;
                }
                Tok::End => {
                    self.close(Tok::RBrace, say!("`}}` after the last item of the chart"), open);
                    return;
                }
                _ => {}
            }
            if self.cur.newline && self.at_file_start() {
                self.close(Tok::RBrace, say!("`}}` before the next item of the file"), open);
                return;
            }
            let start = self.cur.start;
            let read =
                self.chart_item(items) || self.correct(&words::texts(words::CHART)) && self.chart_item(items);
            // A reserved word before `:` is read as a label although it is not a name.
            if !read || self.cur.start == start {
                self.lost_chart_item(start);
            }
        }
    }

    fn chart_item(&mut self, items: &mut Vec<ChartItem>) -> bool {
        self.fold(&STEP_WORDS);
        if self.at_transition() || self.step_for_transition() {
            self.line(|p| p.transitions(items));
            return true;
        }
        if let Some(kind) = self.var_kind() {
            items.push(ChartItem::Var(self.line(|p| p.variable(kind))));
            return true;
        }
        let start = self.cur.start;
        let item = match self.word() {
            word if STEP_WORDS.contains(&word) => ChartItem::Step(self.line(Parser::step)),
            "pre" => {
                self.bump();
                let body = self.body();
                ChartItem::Pre(body, self.since(start).into())
            }
            "post" => {
                self.bump();
                let body = self.body();
                ChartItem::Post(body, self.since(start).into())
            }
            "action" => ChartItem::Action(self.line(Parser::named_action)),
            "transition" => ChartItem::Section(self.line(Parser::section)),
            _ => return false,
        };
        items.push(item);
        true
    }

    /// True if a step or a transition begins here.
    pub(super) fn at_chart_start(&mut self) -> bool {
        match self.word() {
            "step" | "initial" | "enclosing" | "macro" => true,
            "entry" | "exit" => self.peek_word("step") || self.peek_word("initial"),
            "transition" => self.peek_word("section"),
            _ => (self.at_name() || self.at(Tok::LParen)) && self.arrow_ahead(),
        }
    }

    /// True if a transition begins here: a name before `->` or `:`, or a bracket before an arrow.
    fn at_transition(&mut self) -> bool {
        match self.cur.kind {
            Tok::LParen | Tok::Arrow => true,
            Tok::Int | Tok::Ticked | Tok::Word => {
                let next = self.peek();
                matches!(next.kind, Tok::Arrow | Tok::Colon | Tok::Comma | Tok::Output)
                    || next.kind == Tok::Minus && self.lexer.ahead(next).token().kind == Tok::Arrow
            }
            _ => false,
        }
    }

    /// True at `step 0 -> …`: the word is told and passed.
    fn step_for_transition(&mut self) -> bool {
        if !self.at_word("step") {
            return false;
        }
        let name = self.peek();
        let mut ahead = self.lexer.ahead(name);
        let arrow = ahead.token();
        if !matches!(name.kind, Tok::Word | Tok::Int | Tok::Ticked)
            || arrow.kind != Tok::Arrow
            || arrow.newline
        {
            return false;
        }
        let again = self.slice(ahead.token()) == "step";
        if !again {
            let (what, help) = step_in_transition();
            self.slip(self.here(), what, help);
        }
        self.bump();
        true
    }

    /// Reads a word of the language in capitals as that word. Several in a row are told once.
    #[inline(never)]
    fn fold(&mut self, list: &[&'static str]) {
        let word = self.word();
        let Some(meant) = list.iter().copied().find(|w| *w != word && w.eq_ignore_ascii_case(word)) else {
            return;
        };
        let again = self.corrected.is_some_and(|(start, _)| start == self.prev.start);
        // A step or a variable can have such a name.
        let next = self.peek();
        let named = matches!(next.kind, Tok::Arrow | Tok::Colon | Tok::Comma | Tok::Assign | Tok::PathDot);
        if named || next.newline {
            return;
        }
        if !again {
            let at = self.here();
            let help = say!("write it in small letters: `{meant}`");
            let mut fix = Fix::sure(help.clone(), at, meant);
            // The words behind it are mended with it.
            let mut token = next;
            while token.kind == Tok::Word && list.contains(&&*self.slice(token).to_ascii_lowercase()) {
                fix = fix.and(self.span_of(token), self.slice(token).to_ascii_lowercase());
                token = self.lexer.ahead(token).token();
            }
            self.report(at, || {
                Problem::new(&codes::UNKNOWN_WORD, at, say!("`{word}` is no word of the language here"))
                    .help(help)
                    .fix(fix)
            });
        }
        self.corrected = Some((self.cur.start, meant));
    }

    /// True if `name ->` or `( … ) ->` stands here; only a few names are read ahead.
    fn arrow_ahead(&mut self) -> bool {
        if !self.at(Tok::LParen) {
            return self.peek().kind == Tok::Arrow;
        }
        let mut ahead = self.lexer.ahead(self.cur);
        for _ in 0..64 {
            match ahead.token().kind {
                Tok::RParen => return ahead.token().kind == Tok::Arrow,
                Tok::Int | Tok::Word | Tok::Ticked | Tok::Comma => {}
                _ => return false,
            }
        }
        false
    }

    /// Reports text that begins no item of a chart.
    #[inline(never)]
    fn lost_chart_item(&mut self, start: u32) {
        if matches!(self.cur.kind, Tok::RParen | Tok::RBracket) {
            self.closes_nothing();
        } else if self.at_name() {
            self.bump();
            let name = self.text.get(start as usize..self.prev.end as usize).unwrap_or_default();
            let what = say!("`->` after the preceding step `{name}`");
            self.expected_help(what, Some(say!("a transition is written `1 -> 2 when …`, a step `step 1`")));
        } else {
            self.unexpected(say!("a step, a transition or another item of the chart"), None);
        }
        if self.cur.start == start {
            self.bump();
        }
        self.recover(|p| p.at_chart_start() || p.var_kind().is_some() || p.at_name());
    }

    // Steps

    /// A step or macro-step; one of its words is in hand.
    #[inline(never)]
    fn step(&mut self) -> Step {
        let start = self.cur.start;
        let mut initial = false;
        let mut kind = StepKind::Plain;
        loop {
            let at = self.here();
            self.fold(&STEP_WORDS);
            let sort = match self.word() {
                "initial" => {
                    initial = true;
                    self.bump();
                    continue;
                }
                "entry" => StepKind::Entry,
                "exit" => StepKind::Exit,
                "enclosing" => StepKind::Enclosing,
                _ => break,
            };
            if kind != StepKind::Plain {
                self.slip(
                    at,
                    say!("a step is only one of entry, exit and enclosing"),
                    say!("leave out one of the words"),
                );
            }
            kind = sort;
            self.bump();
        }
        if self.eat_word("macro") {
            return self.macro_step(start, initial, &kind);
        }
        if !self.eat_word("step") {
            self.expected_help(say!("`step`"), Some(say!("for example `initial step 0`")));
        }
        let name = self.name(say!("the name or number of the step"));
        self.broken_name(&name);
        self.step_rest(start, name, kind, initial)
    }

    /// Tells of a blank or another sign in a name, and passes the rest of it.
    fn broken_name(&mut self, name: &Name) {
        let part = |kind: Tok| matches!(kind, Tok::Word | Tok::Int | Tok::Minus);
        if name.text.is_empty() || self.cur.newline || !self.at_name() && !self.at(Tok::Minus) {
            return;
        }
        // A transition can follow on the line; then the word is no part of the name.
        let mut ahead = self.lexer.ahead(self.cur);
        let mut end = ahead.token();
        let mut length = 1;
        while part(end.kind) && !end.newline {
            length += 1;
            end = ahead.token();
        }
        let over = end.newline || matches!(end.kind, Tok::LBrace | Tok::Comment | Tok::RBrace | Tok::End);
        if !over || self.word_of_chart() {
            return;
        }
        for _ in 0..length {
            self.bump();
        }
        let at = self.since(name.at.0.start);
        let text = self.text_at(at);
        self.lexer.problems.add(at, || {
            Problem::new(
                &codes::EXPECTED,
                at,
                say!("a name with a blank or another sign stands in back-ticks"),
            )
            .help(say!("write `` `{text}` `` or `{}`", text.replace([' ', '-'], "_")))
        });
    }

    /// True at a word that can begin an item of a chart.
    fn word_of_chart(&self) -> bool {
        words::has(words::CHART, self.word())
    }

    #[inline(never)]
    fn macro_step(&mut self, start: u32, initial: bool, kind: &StepKind) -> Step {
        if *kind != StepKind::Plain {
            let at = self.since(start);
            self.slip(
                at,
                say!("a macro-step is neither entry, exit nor enclosing"),
                say!("leave out that word"),
            );
        }
        self.eat_word("step");
        let name = self.name(say!("the name of the macro-step"));
        if self.at(Tok::Assign) {
            self.slip_to(self.here(), say!("a macro-step's expansion stands behind `=`"), "=");
            self.bump();
        } else {
            self.expect(Tok::Eq, say!("`=` and the name of the expansion"));
        }
        let expansion = self.chart_name(say!("the name of the expansion, a `macrochart`"));
        self.step_rest(start, name, StepKind::Macro(expansion), initial)
    }

    fn step_rest(&mut self, start: u32, name: Name, kind: StepKind, initial: bool) -> Step {
        let linked = self.eat(Tok::Star);
        let comment = self.comment_if();
        let open = self.here();
        let braces = self.eat(Tok::LBrace);
        let actions = if braces { self.actions(open) } else { Vec::new() };
        Step { name, kind, initial, linked, comment, actions, braces, at: self.since(start).into() }
    }

    // Transitions

    /// A transition and those chained to it.
    #[inline(never)]
    fn transitions(&mut self, items: &mut Vec<ChartItem>) {
        let start = self.cur.start;
        let label = if self.peek().kind == Tok::Colon { self.name_if() } else { None };
        if label.is_some() {
            self.bump();
        }
        let from = if self.at(Tok::Arrow) {
            let at = self.here();
            self.slip(
                at,
                say!("the preceding steps are missing"),
                say!("a source transition is written `() -> 1 when …`"),
            );
            Vec::new()
        } else {
            self.step_list(say!("the preceding steps"))
        };
        if self.at(Tok::Minus) && self.peek().kind == Tok::Arrow {
            let at = self.here().to(self.next.map_or(self.here(), |next| self.span_of(next)));
            self.slip_to(at, say!("a transition is written with `->`"), "->");
            self.bump();
        }
        if self.at(Tok::Output) {
            self.slip_to(self.here(), say!("a transition is written with `->`"), "->");
            self.cur.kind = Tok::Arrow;
        }
        if !self.expect(Tok::Arrow, say!("`->` after the preceding steps")) {
            self.recover(|p| p.at_chart_start() || p.var_kind().is_some());
            return;
        }
        let mut last = self.transition(start, label, from, false);
        while self.at(Tok::Arrow) {
            let start = self.bump().start;
            let from = last.to.clone();
            let next = self.transition(start, None, from, true);
            items.push(ChartItem::Transition(std::mem::replace(&mut last, next)));
        }
        items.push(ChartItem::Transition(last));
    }

    /// Reads the part after the arrow.
    #[inline(never)]
    fn transition(&mut self, start: u32, label: Option<Name>, from: Vec<Name>, chained: bool) -> Transition {
        let to = if self.at_word("when") {
            let at = self.behind();
            self.slip(
                at,
                say!("the succeeding steps are missing"),
                say!("a sink transition is written `1 -> () when …`"),
            );
            Vec::new()
        } else {
            self.step_list(say!("the succeeding steps"))
        };
        let receptivity = self.receptivity(&from, &to);
        let at = Place::default();
        let mut t = Transition {
            label,
            from,
            to,
            receptivity,
            priority: None,
            comment: None,
            on_clearing: None,
            chained,
            at,
        };
        while self.transition_clause(&mut t) {}
        t.at = self.since(start).into();
        t
    }

    /// Reads one of the clauses after the receptivity.
    #[inline(never)]
    fn transition_clause(&mut self, t: &mut Transition) -> bool {
        if t.comment.is_none() && self.at(Tok::Comment) {
            t.comment = self.comment_if();
        } else if t.priority.is_none() && self.eat_word("priority") {
            t.priority = Some(self.integer_u32(say!("a number, 1 is first")));
        } else if t.on_clearing.is_none() && self.at_two_words("on", "clearing") {
            self.eat_word("on");
            self.eat_word("clearing");
            self.eat(Tok::Colon);
            t.on_clearing = Some(self.block(say!("`{{` and the statements")));
        } else {
            return false;
        }
        true
    }

    /// Reads `when e`, and words that are written for it by mistake.
    #[inline(never)]
    fn receptivity(&mut self, from: &[Name], to: &[Name]) -> Expr {
        self.fold(&["when"]);
        if self.eat_word("when") {
            return self.condition();
        }
        let same_line = !self.cur.newline;
        if same_line && (self.at_word("if") || self.at(Tok::Colon)) {
            self.slip_to(self.here(), say!("a receptivity stands behind `when`"), "when");
            self.bump();
            return self.condition();
        }
        if same_line && self.at_expr() {
            self.slip(
                self.here(),
                say!("`when` is missing before the receptivity"),
                say!("write `1 -> 2 when …`"),
            );
            return self.condition();
        }
        let help = if self.at(Tok::Arrow) {
            let (a, b) = (shown(from), shown(to));
            say!(
                "a step cannot follow a step: write a transition `{a} -> {b} when …` between them; \
                 `when =1` is always true"
            )
        } else {
            say!("`when =1` is always true")
        };
        self.expected_help(say!("`when` and the receptivity"), Some(help));
        Expr { kind: ExprKind::Bad, at: self.behind().into() }
    }

    /// `5`, `(3, 5)` or `()`.
    fn step_list(&mut self, what: Said) -> Vec<Name> {
        let open = self.here();
        let mut names = Vec::new();
        if self.eat(Tok::LParen) {
            while !matches!(self.cur.kind, Tok::RParen | Tok::End) {
                names.extend(self.step_name(say!("the name of a step")));
                if !self.eat(Tok::Comma) {
                    break;
                }
            }
            self.close(Tok::RParen, say!("`)` after the steps"), open);
            return names;
        }
        // Most lists hold one step, and charts may have many thousands, so no more room is
        // reserved.
        names.reserve_exact(1);
        names.extend(self.step_name(what));
        if self.at(Tok::Comma) {
            self.slip(self.here(), say!("several steps stand in parentheses"), say!("write `(1, 2)`"));
            while self.eat(Tok::Comma) {
                names.extend(self.step_name(say!("the name of a step")));
            }
        }
        names
    }

    fn step_name(&mut self, what: Said) -> Option<Name> {
        if self.at_word("step") && self.peek().kind != Tok::Arrow {
            let (what, help) = step_in_transition();
            self.slip(self.here(), what, help);
            self.bump();
        }
        let at = self.cur.start;
        let name = self.name(what);
        (self.cur.start != at).then_some(name)
    }
}

/// Steps as a transition names them.
fn shown(names: &[Name]) -> String {
    match names {
        [one] => one.text.to_string(),
        _ => format!("({})", names.iter().map(|n| &*n.text).collect::<Vec<_>>().join(", ")),
    }
}
