//! Recursive descent over the tokens: grammar rules are functions of [`Parser`].
//!
//! Each rule reads as much as it can, reports what is wrong and continues, so that one run reports
//! many problems. Two conditions must hold: every loop consumes a token or ends (linear time), and
//! every recursion passes [`Parser::enter`] (no overflow).

mod action;
mod chart;
mod composed;
mod element;
mod expr;
mod extent;
mod file;
mod il;
mod instance;
pub(crate) mod ladder;
mod lines;
mod literal;
pub(crate) mod marks;
mod named;
mod plant;
pub(crate) mod reading;
mod scenario;
mod st;
mod variable;

pub use file::SWITCHES;
pub use literal::UNITS;

use crate::lexer::{Lexer, Tok, Token};
use crate::quote;
use crate::words;
use g7_model::codes::{self, Code};
use g7_model::{FileId, Fix, Name, Problem, Said, Span, UnaryOp, say};

/// The deepest nesting of brackets, blocks and operands.
const MOST_NESTED: u32 = 128;

/// A problem at whose place this text was surely meant.
fn meant(problem: Problem, text: &str) -> Problem {
    let (at, help) = (problem.at, say!("write `{text}`"));
    problem.help(help.clone()).fix(Fix::sure(help, at, text))
}

/// The parser: the current token, and at most one read ahead.
pub(crate) struct Parser<'a> {
    lexer: Lexer<'a>,
    text: &'a str,
    file: FileId,
    cur: Token,
    next: Option<Token>,
    /// How far the construct in hand may run on, and where the line ended that it stands on.
    lines: extent::Lines,
    prev: Token,
    nested: u32,
    /// Signs before operands that are being read, each with its start; `+` has no operator.
    prefixes: Vec<(Option<UnaryOp>, u32)>,
    /// The start of the token at which a problem was last reported.
    told: Option<u32>,
    /// A misspelt word: its place, and the word it is read as.
    corrected: Option<(u32, &'static str)>,
    /// Where a later reading can begin and end; only for a [`crate::Tree`].
    marks: Option<Box<marks::Marks>>,
}

impl<'a> Parser<'a> {
    pub(crate) fn new(text: &'a str, file: FileId) -> Parser<'a> {
        let start = if text.starts_with('\u{feff}') { 3 } else { 0 };
        Parser::portion(text, file, start)
    }

    /// A parser of the end of a text, from a byte on.
    pub(crate) fn portion(text: &'a str, file: FileId, start: usize) -> Parser<'a> {
        let mut lexer = Lexer::new(text, file, start);
        let cur = lexer.token();
        let prev = Token { kind: Tok::Bad, start: cur.start, end: cur.start, newline: true };
        let prefixes = Vec::new();
        let lines = extent::Lines::default();
        Parser {
            lexer,
            text,
            file,
            cur,
            next: None,
            lines,
            prev,
            nested: 0,
            prefixes,
            told: None,
            corrected: None,
            marks: None,
        }
    }

    /// The problems, and the notes.
    pub(crate) fn finish(self) -> (Vec<Problem>, Vec<g7_model::Note>) {
        (self.lexer.problems.finish(), self.lexer.notes)
    }

    // Tokens

    fn bump(&mut self) -> Token {
        let token = self.cur;
        match token.kind {
            Tok::End => return token,
            Tok::Line => {
                self.pass_line_end();
                return token;
            }
            _ => self.lines.bracket(token.kind),
        }
        self.prev = token;
        self.cur = match self.next.take() {
            Some(next) => next,
            None => self.lexer.token(),
        };
        self.hold_line_end();
        token
    }

    fn peek(&mut self) -> Token {
        if let Some(behind) = self.lines.behind {
            return behind;
        }
        match self.next {
            Some(next) => next,
            None => {
                let next = self.lexer.token();
                self.next = Some(next);
                next
            }
        }
    }

    fn at(&self, kind: Tok) -> bool {
        self.cur.kind == kind
    }

    fn eat(&mut self, kind: Tok) -> bool {
        let here = self.at(kind);
        if here {
            self.bump();
        }
        here
    }

    fn slice(&self, token: Token) -> &'a str {
        self.text_at(self.span_of(token))
    }

    /// The current word; empty for any other token.
    fn word(&self) -> &'a str {
        match self.corrected {
            Some((start, word)) if start == self.cur.start => word,
            _ if self.at(Tok::Word) => self.slice(self.cur),
            _ => "",
        }
    }

    /// Reads a misspelt word as the word of the list that was most likely meant, if there is one,
    /// and reports it. This happens only before a token that can follow such a word.
    fn correct(&mut self, list: &[&'static str]) -> bool {
        let word = self.word();
        let at = self.here();
        if word.is_empty() || list.contains(&word) || self.silent() {
            return false;
        }
        let follows = matches!(
            self.peek().kind,
            Tok::Word
                | Tok::Int
                | Tok::Ticked
                | Tok::Comment
                | Tok::Str
                | Tok::Time
                | Tok::LBrace
                | Tok::Direct
                | Tok::Rise
                | Tok::Fall
        );
        let Some(near) = words::similar(word, list).filter(|_| follows) else { return false };
        self.report(at, || {
            let what = say!("`{word}` is no word of the language here");
            let problem = Problem::new(&codes::UNKNOWN_WORD, at, what).help(say!("did you mean `{near}`?"));
            // The rest of the text fits the word, and it is read as such.
            problem.fix(Fix::sure(say!("write `{near}`"), at, near))
        });
        self.corrected = Some((at.start, near));
        true
    }

    fn at_word(&self, word: &str) -> bool {
        self.word() == word
    }

    /// Reads this word if it stands here, or at the start of the next line: a word that is asked for
    /// by its name goes on with a construct and begins nothing else.
    fn eat_word(&mut self, word: &str) -> bool {
        let next = self.behind_line_end().is_some_and(|t| t.kind == Tok::Word && self.slice(t) == word);
        if next {
            self.pass_line_end();
        }
        let here = self.at_word(word);
        if here {
            self.bump();
        }
        here
    }

    /// The current word of Structured Text.
    fn st_word(&self) -> Option<words::St> {
        words::st(self.word())
    }

    fn eat_st(&mut self, word: words::St) -> bool {
        let next = self.behind_line_end().is_some_and(|t| words::st(self.slice(t)) == Some(word));
        if next {
            self.pass_line_end();
        }
        let here = self.st_word() == Some(word);
        if here {
            self.bump();
        }
        here
    }

    fn peek_word(&mut self, word: &str) -> bool {
        let next = self.peek();
        next.kind == Tok::Word && self.slice(next) == word
    }

    // Places

    fn here(&self) -> Span {
        self.span_of(self.cur)
    }

    fn span_of(&self, token: Token) -> Span {
        Span { file: self.file, start: token.start, end: token.end }
    }

    /// The text at a place.
    fn text_at(&self, at: Span) -> &'a str {
        self.text.get(at.bytes()).unwrap_or_default()
    }

    /// From a byte to the end of the last token read.
    fn since(&self, start: u32) -> Span {
        Span { file: self.file, start, end: self.prev.end.max(start) }
    }

    /// The place just after the last token.
    fn behind(&self) -> Span {
        Span { file: self.file, start: self.prev.end, end: self.prev.end }
    }

    // Problems

    /// True if a problem was reported at this token already, or too many in the text.
    fn silent(&self) -> bool {
        self.told == Some(self.cur.start) || self.lexer.problems.is_full()
    }

    /// Reports a problem, unless [`Parser::silent`] holds.
    fn report(&mut self, at: Span, make: impl FnOnce() -> Problem) {
        if !self.silent() {
            self.told = Some(self.cur.start);
            self.lexer.problems.add(at, make);
        }
    }

    fn problem(&mut self, code: &'static Code, at: Span, what: Said) {
        self.report(at, || Problem::new(code, at, what));
    }

    fn problem_help(&mut self, code: &'static Code, at: Span, what: Said, help: Said) {
        self.report(at, || Problem::new(code, at, what).help(help));
    }

    /// Reports a slip whose meaning is clear; reading continues as if it were right.
    fn slip(&mut self, at: Span, what: Said, help: Said) {
        if self.silent() {
            return;
        }
        self.lexer.problems.add(at, || Problem::new(&codes::EXPECTED, at, what).help(help));
    }

    /// Reports a slip for which this text was meant.
    fn slip_to(&mut self, at: Span, what: Said, text: &str) {
        if self.silent() {
            return;
        }
        self.lexer.problems.add(at, || meant(Problem::new(&codes::EXPECTED, at, what), text));
    }

    /// The current token, in words.
    fn found(&self) -> Said {
        match self.cur.kind {
            Tok::End => say!("the end of the text"),
            Tok::Comment => say!("a comment"),
            Tok::Str => say!("a text in quotes"),
            _ => {
                let text = self.slice(self.cur);
                let short: String = text.chars().take(24).collect();
                let dots = if short.len() < text.len() { "…" } else { "" };
                say!("`{short}{dots}`")
            }
        }
    }

    /// Reports that something else was expected at this token.
    fn expected(&mut self, what: Said) {
        self.expected_help(what, None);
    }

    fn expected_help(&mut self, what: Said, help: Option<Said>) {
        if self.silent() {
            return;
        }
        let (at, words) = self.expected_words(what);
        self.report(at, || {
            let problem = Problem::new(&codes::EXPECTED, at, words);
            match help {
                Some(help) => problem.help(help),
                None => problem,
            }
        });
    }

    /// Reports a token that cannot begin the expected text.
    fn unexpected(&mut self, what: Said, help: Option<Said>) {
        if self.silent() {
            return;
        }
        let at = self.here();
        let problem = Problem::new(&codes::EXPECTED, at, say!("expected {what}, found {}", self.found()));
        self.report(at, || match help {
            Some(help) => problem.help(help),
            None => problem,
        });
    }

    /// If the line ended before this token, the problem is placed at that end.
    fn expected_words(&self, what: Said) -> (Span, Said) {
        let ended = self.cur.newline && self.prev.kind != Tok::Bad || self.at(Tok::End);
        if ended {
            (self.behind(), say!("expected {what}"))
        } else {
            (self.here(), say!("expected {what}, found {}", self.found()))
        }
    }

    fn expect(&mut self, kind: Tok, what: Said) -> bool {
        let here = self.eat(kind);
        if !here {
            self.expected(what);
        }
        here
    }

    /// Reports any text that follows.
    pub(crate) fn expect_end(&mut self) {
        if !self.at(Tok::End) {
            self.expected(say!("nothing more"));
        }
    }

    /// Reports a closing bracket that belongs to no other.
    fn closes_nothing(&mut self) {
        // A text of millions of brackets is not worded for nobody.
        if self.silent() {
            return;
        }
        let at = self.here();
        let what = say!("this `{}` closes nothing", self.slice(self.cur));
        let help = say!("delete it, or write the bracket that it closes");
        self.problem_help(&codes::UNCLOSED, at, what, help);
    }

    /// Expects the bracket that closes the one at `open`.
    fn close(&mut self, kind: Tok, sign: Said, open: Span) -> bool {
        let here = self.eat(kind);
        if !here && !self.silent() {
            let (at, words) = self.expected_words(sign);
            let open_sign = self.text_at(open);
            self.report(at, || {
                Problem::new(&codes::UNCLOSED, at, words)
                    .related(open, say!("`{open_sign}` stands here"))
                    .help(say!("each bracket that is opened has to be closed"))
            });
        }
        if !here {
            self.lines.unclosed();
            self.hold_line_end();
        }
        here
    }

    // Nesting

    /// Goes one level deeper; if that is not allowed, skips the nested text.
    fn enter(&mut self) -> bool {
        if self.nested < MOST_NESTED {
            self.nested += 1;
            return true;
        }
        let at = self.here();
        self.report(at, || {
            let what = say!("brackets or blocks are nested more than {MOST_NESTED} levels deep");
            Problem::new(&codes::TOO_DEEP, at, what)
        });
        self.skip_nested();
        false
    }

    fn leave(&mut self) {
        self.nested -= 1;
    }

    /// Skips to the bracket that closes the current one.
    fn skip_nested(&mut self) {
        let mut depth = 0u32;
        loop {
            match self.cur.kind {
                Tok::End => return,
                Tok::LBrace | Tok::LParen | Tok::LBracket => depth += 1,
                Tok::RBrace | Tok::RParen | Tok::RBracket if depth == 0 => return,
                Tok::RBrace | Tok::RParen | Tok::RBracket => depth -= 1,
                _ => {}
            }
            self.bump();
        }
    }

    /// Continues after a problem: skips to a token at the start of a line that `stop` accepts, to a
    /// `;`, or to the brace that closes the current block.
    fn recover(&mut self, stop: impl Fn(&mut Parser<'a>) -> bool) {
        let mut depth = 0u32;
        loop {
            let kind = self.cur.kind;
            match kind {
                Tok::End => return,
                Tok::RBrace if depth == 0 => return,
                Tok::RBrace => depth -= 1,
                Tok::LBrace => depth += 1,
                Tok::Semi if depth == 0 => return,
                _ if depth == 0 && self.cur.newline && stop(self) => return,
                _ if self.cur.newline && self.at_file_start() => return,
                _ => {}
            }
            self.bump();
        }
    }

    /// True if an item begins here that is allowed only outside of all braces.
    fn at_file_start(&mut self) -> bool {
        match self.word() {
            "chart" | "macrochart" | "task" | "plant" | "layout" | "function" => {
                matches!(self.peek().kind, Tok::Word | Tok::Ticked | Tok::Int)
            }
            "profile" => self.peek().kind == Tok::Word,
            "test" => self.peek().kind == Tok::Comment,
            "prove" => self.peek().kind == Tok::Word,
            "instance" => self.at_instance(),
            "struct" => self.at_structure(),
            "type" => self.at_type(),
            "use" => self.at_use(),
            _ => false,
        }
    }

    // Names

    /// Reads a name; without one it reports a problem and returns an empty name.
    fn name(&mut self, what: Said) -> Name {
        if let Some(name) = self.name_if() {
            return name;
        }
        if self.at(Tok::Word) {
            return self.reserved_name(what);
        }
        self.expected(what);
        Name::new("", self.here())
    }

    /// A name, if one stands here.
    fn name_if(&mut self) -> Option<Name> {
        let token = self.cur;
        let at = self.span_of(token);
        let text = self.slice(token);
        let name = match token.kind {
            Tok::Word if words::is_reserved(text) => return None,
            Tok::Word => Name::new(text, at),
            Tok::Ticked => Name::new(quote::unquote(text, '`'), at),
            Tok::Int if text.bytes().all(|b| b.is_ascii_digit()) => Name::new(text, at),
            _ => return None,
        };
        self.bump();
        if name.text.is_empty() {
            self.slip(at, say!("a name cannot be empty"), say!("write something between the back-ticks"));
        }
        Some(name)
    }

    /// Reads a reserved word in the place of a name as that name, if a token follows that fits.
    fn reserved_name(&mut self, what: Said) -> Name {
        let at = self.here();
        let word = self.slice(self.cur);
        let fits = matches!(
            self.peek().kind,
            Tok::Colon
                | Tok::Comma
                | Tok::Arrow
                | Tok::LBrace
                | Tok::RBrace
                | Tok::RParen
                | Tok::Assign
                | Tok::Comment
        );
        let fits = fits || self.peek().newline;
        if !fits || self.cur.newline && self.prev.kind != Tok::Bad {
            let help = say!("`{word}` is a word of the language; as a name it stands in back-ticks");
            self.expected_help(what, Some(help));
            return Name::new("", at);
        }
        self.slip(
            at,
            say!("`{word}` is a word of the language, not a name"),
            say!("write it in back-ticks: `` `{word}` ``"),
        );
        self.bump();
        Name::new(word, at)
    }

    /// `a, b, c`.
    fn names(&mut self, what: Said) -> Vec<Name> {
        let mut names = vec![self.name(what.clone())];
        while self.eat(Tok::Comma) {
            names.push(self.name(what.clone()));
        }
        names
    }

    /// True if a name stands here.
    fn at_name(&self) -> bool {
        match self.cur.kind {
            Tok::Word => !words::is_reserved(self.slice(self.cur)),
            Tok::Ticked => true,
            Tok::Int => self.slice(self.cur).bytes().all(|b| b.is_ascii_digit()),
            _ => false,
        }
    }

    // Separators

    fn skip_semis(&mut self) {
        while self.eat(Tok::Semi) {}
    }
}
