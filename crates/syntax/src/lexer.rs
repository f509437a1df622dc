//! Splits a text into tokens, one at a time and without copying it.
//!
//! A token is a kind and two offsets; the text of words and numbers is read again only where it is
//! needed. Notes are kept for the printer. The lexer never fails: characters without a meaning
//! become a `Bad` token with a problem.

use crate::foreign;
use crate::problems::Problems;
use g7_iec::constant;
use g7_model::{FileId, Fix, Note, Problem, Said, Span, Type, codes, say};
use std::{cell::Cell, rc::Rc};

/// Kinds of token.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Tok {
    End,
    /// The end of a line, made by the parser where a construct may not go on behind it.
    Line,
    Word,
    /// A name in back-ticks.
    Ticked,
    Int,
    Real,
    /// `5s`, `T#5s`.
    Time,
    /// `INT#5`.
    Typed,
    Str,
    Comment,
    /// `%I0.1`.
    Direct,
    LBrace,
    RBrace,
    LParen,
    RParen,
    LBracket,
    RBracket,
    Comma,
    Semi,
    Colon,
    Assign,
    Arrow,
    /// `=>`.
    Output,
    /// `=` or `==`.
    Eq,
    Ne,
    Lt,
    Gt,
    Le,
    Ge,
    Plus,
    Minus,
    Star,
    Power,
    Slash,
    Amp,
    AmpAmp,
    Bars,
    /// `·`, or a `.` that is no part of a path.
    Dot,
    /// A `.` with a name directly before and after it.
    PathDot,
    DotDot,
    Bang,
    Rise,
    Fall,
    /// `'` behind an operand.
    Prime,
    /// A combining overline.
    Overline,
    Hash,
    /// `%` between operands, as other languages have it.
    Percent,
    /// `?` with a `:` behind it on its line.
    Question,
    Bad,
}

/// One token.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Token {
    pub(crate) kind: Tok,
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// True if a line ended between the token before and this one.
    pub(crate) newline: bool,
}

/// The position in the text, and the notes and problems so far.
#[derive(Debug)]
pub(crate) struct Lexer<'a> {
    text: &'a str,
    file: FileId,
    pos: usize,
    last: Tok,
    last_end: usize,
    /// One past the last byte of all tokens read, also of those read by lexers that look ahead.
    pub(crate) seen: Rc<Cell<usize>>,
    pub(crate) notes: Vec<Note>,
    pub(crate) problems: Problems,
}

impl Tok {
    /// True for a token, other than a word, that can begin an operand and nothing else.
    pub(crate) fn begins_operand(self) -> bool {
        matches!(
            self,
            Tok::Ticked
                | Tok::Int
                | Tok::Real
                | Tok::Time
                | Tok::Typed
                | Tok::Str
                | Tok::Direct
                | Tok::LParen
                | Tok::LBracket
                | Tok::Bang
                | Tok::Rise
                | Tok::Fall
        )
    }
}

impl<'a> Lexer<'a> {
    /// A lexer that starts at a byte of the text.
    pub(crate) fn new(text: &'a str, file: FileId, pos: usize) -> Lexer<'a> {
        let (notes, problems) = (Vec::new(), Problems::default());
        Lexer { text, file, pos, last: Tok::Bad, last_end: usize::MAX, seen: Rc::default(), notes, problems }
    }

    /// A lexer that looks ahead from the end of a token and changes nothing here.
    pub(crate) fn ahead(&self, token: Token) -> Lexer<'a> {
        let mut other = Lexer::new(self.text, self.file, token.end as usize);
        other.last = token.kind;
        other.last_end = token.end as usize;
        other.seen = Rc::clone(&self.seen);
        other
    }

    /// The next token; at the end of the text always `End`.
    pub(crate) fn token(&mut self) -> Token {
        let mut newline = self.blanks();
        let mut start = self.pos;
        let mut kind = self.scan(start == self.last_end);
        // The problem has been reported; the rest of the text may be right.
        while kind == Tok::Bad {
            newline |= self.blanks();
            start = self.pos;
            kind = self.scan(false);
        }
        self.last = kind;
        self.last_end = self.pos;
        self.seen.set(self.seen.get().max(self.pos));
        Token { kind, start: offset(start), end: offset(self.pos), newline }
    }

    /// The text up to the `}` that closes a block of another language; the lexer goes on at that `}`.
    pub(crate) fn raw_body(&mut self, start: u32) -> &'a str {
        let start = start as usize;
        let mut depth = 0usize;
        let mut end = self.text.len();
        for (i, b) in self.text.bytes().enumerate().skip(start) {
            match b {
                b'{' => depth += 1,
                b'}' if depth == 0 => {
                    end = i;
                    break;
                }
                b'}' => depth -= 1,
                _ => {}
            }
        }
        self.pos = end;
        self.last = Tok::Bad;
        self.text.get(start..end).unwrap_or_default()
    }

    fn byte(&self, ahead: usize) -> u8 {
        self.text.as_bytes().get(self.pos + ahead).copied().unwrap_or(0)
    }

    fn rest(&self) -> &'a str {
        self.text.get(self.pos..).unwrap_or_default()
    }

    fn span(&self, start: usize) -> Span {
        Span { file: self.file, start: offset(start), end: offset(self.pos) }
    }

    fn report(&mut self, start: usize, make: impl FnOnce(Span) -> Problem) {
        let at = self.span(start);
        self.problems.add(at, || make(at));
    }

    /// Skips blanks and notes; returns true if a line ended.
    fn blanks(&mut self) -> bool {
        let mut newline = false;
        loop {
            match self.byte(0) {
                b'\n' => {
                    newline = true;
                    self.pos += 1;
                }
                b' ' | b'\t' | b'\r' => self.pos += 1,
                b'/' if self.byte(1) == b'/' => self.line_note(),
                b'/' if self.byte(1) == b'*' => newline |= self.block_note(b"/*", b"*/"),
                b'(' if self.byte(1) == b'*' => newline |= self.block_note(b"(*", b"*)"),
                b'#' | b'-' => match foreign::note(self.text, self.pos) {
                    Some(sign) => self.foreign_note(sign),
                    None => return newline,
                },
                0x80.. => match self.rest().chars().next() {
                    Some(c) if c.is_whitespace() => self.pos += c.len_utf8(),
                    _ => return newline,
                },
                0x0B | 0x0C => self.pos += 1,
                _ => return newline,
            }
        }
    }

    /// Reads a note that begins with the sign of another language.
    fn foreign_note(&mut self, sign: &str) {
        let start = self.pos;
        self.line_note();
        let at = Span { end: offset(start + sign.len()), ..self.span(start) };
        self.problems.add(at, || {
            let what = say!("a note to the reader does not begin with `{sign}`");
            Problem::new(&codes::BAD_CHARACTER, at, what).help(say!("write `//`")).fix(Fix::sure(
                say!("write `//`"),
                at,
                "//",
            ))
        });
    }

    fn line_note(&mut self) {
        let start = self.pos;
        let rest = self.rest();
        self.pos += rest.find('\n').unwrap_or(rest.len());
        let text = self.text.get(start..self.pos).unwrap_or_default().trim_end();
        let at = Span { end: offset(start + text.len()), ..self.span(start) };
        // Looked for once on a line, because such a note ends it.
        let behind = foreign::line_before(self.text, start);
        self.notes.push(Note { text: text.into(), at, behind });
    }

    fn block_note(&mut self, open: &[u8; 2], close: &[u8; 2]) -> bool {
        let start = self.pos;
        let bytes = self.text.as_bytes();
        let mut depth = 0usize;
        let mut newline = false;
        loop {
            let here = bytes.get(self.pos..).unwrap_or_default();
            if here.starts_with(open) {
                depth += 1;
                self.pos += 2;
            } else if here.starts_with(close) {
                depth -= 1;
                self.pos += 2;
                if depth == 0 {
                    break;
                }
            } else if let Some(b) = here.first() {
                newline |= *b == b'\n';
                self.pos += 1;
            } else {
                let at = Span { end: offset(start + 2), ..self.span(start) };
                let close = if close == b"*/" { "*/" } else { "*)" };
                self.problems.add(at, || {
                    let what = say!("this note is never closed with `{close}`");
                    Problem::new(&codes::UNCLOSED, at, what)
                });
                break;
            }
        }
        let text = self.text.get(start..self.pos).unwrap_or_default();
        let text = if text.contains('\r') { text.replace("\r\n", "\n").into() } else { text.into() };
        self.notes.push(Note { text, at: self.span(start), behind: None });
        newline
    }

    fn take(&mut self, bytes: usize, kind: Tok) -> Tok {
        self.pos += bytes;
        kind
    }

    fn scan(&mut self, glued: bool) -> Tok {
        let next = self.byte(1);
        match self.byte(0) {
            _ if self.pos >= self.text.len() => Tok::End,
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => self.word(),
            b'0'..=b'9' => self.number(glued),
            b'{' => self.take(1, Tok::LBrace),
            b'}' => self.take(1, Tok::RBrace),
            b'(' => self.take(1, Tok::LParen),
            b')' => self.take(1, Tok::RParen),
            b'[' => self.take(1, Tok::LBracket),
            b']' => self.take(1, Tok::RBracket),
            b',' => self.take(1, Tok::Comma),
            b';' => self.take(1, Tok::Semi),
            b'#' => self.take(1, Tok::Hash),
            b'^' => self.take(1, Tok::Rise),
            b'+' => self.take(1, Tok::Plus),
            b'/' => self.take(1, Tok::Slash),
            b':' if next == b'=' => self.take(2, Tok::Assign),
            b':' => self.take(1, Tok::Colon),
            b'-' if next == b'>' => self.take(2, Tok::Arrow),
            b'-' => self.take(1, Tok::Minus),
            b'=' if next == b'=' => self.take(2, Tok::Eq),
            b'=' if next == b'>' => self.take(2, Tok::Output),
            b'=' => self.take(1, Tok::Eq),
            b'<' if next == b'>' => self.take(2, Tok::Ne),
            b'<' if next == b'=' => self.take(2, Tok::Le),
            b'<' => self.take(1, Tok::Lt),
            b'>' if next == b'=' => self.take(2, Tok::Ge),
            b'>' => self.take(1, Tok::Gt),
            b'!' if next == b'=' => self.take(2, Tok::Ne),
            b'!' => self.take(1, Tok::Bang),
            b'*' if next == b'*' => self.take(2, Tok::Power),
            b'*' => self.take(1, Tok::Star),
            b'&' if next == b'&' => self.take(2, Tok::AmpAmp),
            b'&' => self.take(1, Tok::Amp),
            b'|' if next == b'|' => self.take(2, Tok::Bars),
            b'|' => self.take(1, Tok::Bars),
            b'.' if next == b'.' => self.take(2, Tok::DotDot),
            b'.' => self.dot(glued),
            b'%' if next.is_ascii_alphabetic() => self.direct(),
            b'%' => self.take(1, Tok::Percent),
            b'?' if foreign::choice(self.rest()) => self.take(1, Tok::Question),
            b'\'' if glued && self.after_operand() => self.take(1, Tok::Prime),
            b'\'' => self.quoted('\'', '$', Tok::Str, say!("text")),
            b'"' => self.quoted('"', '\\', Tok::Comment, say!("comment")),
            b'`' => self.quoted('`', '\\', Tok::Ticked, say!("name")),
            _ => self.other(),
        }
    }

    fn after_operand(&self) -> bool {
        matches!(
            self.last,
            Tok::Word
                | Tok::Ticked
                | Tok::Direct
                | Tok::RParen
                | Tok::RBracket
                | Tok::Prime
                | Tok::Overline
                | Tok::Int
        )
    }

    /// A `.` joins names only if it directly follows one and directly precedes one; the number of a bit may
    /// follow an index, `w[i].3`.
    fn dot(&mut self, glued: bool) -> Tok {
        let name = matches!(self.last, Tok::Word | Tok::Ticked | Tok::Int);
        let bit = self.last == Tok::RBracket && self.byte(1).is_ascii_digit();
        let before = glued && (name || bit);
        self.pos += 1;
        let after =
            self.rest().chars().next().is_some_and(|c| name_start(c) || c.is_ascii_digit() || c == '`');
        if before && after { Tok::PathDot } else { Tok::Dot }
    }

    /// A word, or a literal that begins with its type.
    fn word(&mut self) -> Tok {
        let start = self.pos;
        self.skip_name();
        if self.byte(0) != b'#' {
            return Tok::Word;
        }
        let word = self.text.get(start..self.pos).unwrap_or_default();
        let Some(ty) = constant::literal_type(word) else { return Tok::Word };
        self.pos += 1;
        if let Type::Moment(moment) = ty {
            self.pos += moment.length(self.rest());
            return Tok::Typed;
        }
        if matches!(self.byte(0), b'+' | b'-') {
            self.pos += 1;
        }
        if ty == Type::Time {
            self.units();
            return Tok::Time;
        }
        if self.byte(0).is_ascii_digit() {
            self.number(false);
        } else {
            self.skip_name();
        }
        Tok::Typed
    }

    fn skip_name(&mut self) {
        loop {
            match self.byte(0) {
                b'a'..=b'z' | b'A'..=b'Z' | b'_' | b'0'..=b'9' => self.pos += 1,
                0x80.. => match self.rest().chars().next() {
                    Some(c) if name_continue(c) => self.pos += c.len_utf8(),
                    _ => return,
                },
                _ => return,
            }
        }
    }

    fn digits(&mut self) {
        while matches!(self.byte(0), b'0'..=b'9' | b'_') {
            self.pos += 1;
        }
    }

    /// The bytes that may follow the first digits of a duration.
    fn units(&mut self) {
        while matches!(self.byte(0), b'0'..=b'9' | b'_' | b'a'..=b'z' | b'A'..=b'Z')
            || (self.byte(0) == b'.' && self.byte(1).is_ascii_digit())
        {
            self.pos += 1;
        }
    }

    fn number(&mut self, glued: bool) -> Tok {
        self.digits();
        if glued && self.last == Tok::PathDot {
            return Tok::Int; // `G.3.12`: step 12 of M3, no real number
        }
        if self.byte(0) == b'#' {
            self.pos += 1;
            while self.byte(0).is_ascii_alphanumeric() || self.byte(0) == b'_' {
                self.pos += 1;
            }
            return Tok::Int;
        }
        let mut kind = Tok::Int;
        if self.byte(0) == b'.' && self.byte(1).is_ascii_digit() {
            kind = Tok::Real;
            self.pos += 1;
            self.digits();
        }
        if matches!(self.byte(0), b'e' | b'E') {
            let sign = usize::from(matches!(self.byte(1), b'+' | b'-'));
            if self.byte(1 + sign).is_ascii_digit() {
                self.pos += 1 + sign;
                self.digits();
                return Tok::Real;
            }
        }
        if self.byte(0).is_ascii_alphabetic() {
            kind = Tok::Time;
            self.units();
        }
        kind
    }

    fn direct(&mut self) -> Tok {
        self.pos += 1;
        loop {
            match self.byte(0) {
                b'a'..=b'z' | b'A'..=b'Z' | b'_' | b'0'..=b'9' => self.pos += 1,
                b'.' if self.byte(1).is_ascii_alphanumeric() => self.pos += 1,
                // A bit of a word: `%MW4:X3`.
                b':' if matches!(self.byte(1), b'x' | b'X') && self.byte(2).is_ascii_digit() => self.pos += 2,
                _ => return Tok::Direct,
            }
        }
    }

    /// A quoted text; it ends at the end of the line at the latest.
    fn quoted(&mut self, quote: char, escape: char, kind: Tok, what: Said) -> Tok {
        let start = self.pos;
        self.pos += 1;
        let mut escaped = false;
        let rest = self.rest();
        for (i, c) in rest.char_indices() {
            if c == '\n' {
                self.pos += i;
                return self.unclosed(start, quote, kind, what);
            }
            if c == quote && !escaped {
                self.pos += i + 1;
                return kind;
            }
            escaped = c == escape && !escaped;
        }
        self.pos = self.text.len();
        self.unclosed(start, quote, kind, what)
    }

    fn unclosed(&mut self, start: usize, quote: char, kind: Tok, what: Said) -> Tok {
        // The brackets behind the text were hardly meant to belong to it.
        let inner = self.text.get(start + 1..self.pos).unwrap_or_default();
        let length = match kind {
            Tok::Ticked => inner.find(|c: char| !name_continue(c)).unwrap_or(inner.len()),
            Tok::Str => {
                inner.trim_end_matches(|c: char| c.is_whitespace() || matches!(c, ')' | ';' | '}')).len()
            }
            _ => inner.find('{').unwrap_or(inner.len()),
        };
        self.pos = start + 1 + inner.get(..length).unwrap_or_default().trim_end().len();
        let shown = Said::foreign(if quote == '`' { "`` ` ``".into() } else { format!("`{quote}`") });
        self.report(start, |at| {
            let help = say!("write {shown} at its end");
            let end = Span { start: at.end, ..at };
            Problem::new(&codes::UNCLOSED, at, say!("this {what} is not closed with {shown} on its line"))
                .help(help.clone())
                .fix(Fix::likely(help, end, quote))
        });
        kind
    }

    /// Letters beyond ASCII, the signs of GRAFCET, and characters without a meaning.
    fn other(&mut self) -> Tok {
        let start = self.pos;
        let Some(c) = self.rest().chars().next() else { return Tok::End };
        let kind = match c {
            '↑' => Tok::Rise,
            '↓' => Tok::Fall,
            '·' | '⋅' => Tok::Dot,
            '≠' => Tok::Ne,
            '≤' => Tok::Le,
            '≥' => Tok::Ge,
            '→' => Tok::Arrow,
            '\u{304}' | '\u{305}' => Tok::Overline,
            '“' | '”' | '„' | '«' | '»' => return self.curly(c, '"', Tok::Comment),
            '‘' | '’' | '‚' => return self.curly(c, '\'', Tok::Str),
            _ => Tok::Bad,
        };
        self.pos += c.len_utf8();
        if kind != Tok::Bad {
            return kind;
        }
        if name_start(c) {
            self.pos = start;
            return self.word();
        }
        self.bad_run(start);
        Tok::Bad
    }

    /// A text in the quotes of a word processor.
    fn curly(&mut self, open: char, straight: char, kind: Tok) -> Tok {
        let start = self.pos;
        self.pos += open.len_utf8();
        let rest = self.rest();
        let line = rest.find('\n').unwrap_or(rest.len());
        let close = |c: char| matches!(c, '“' | '”' | '„' | '«' | '»' | '‘' | '’' | '‚' | '"' | '\'');
        let end = rest.char_indices().take_while(|(i, _)| *i < line).find(|(_, c)| close(*c));
        self.pos += end.map_or(line, |(i, c)| i + c.len_utf8());
        let whole = self.span(start);
        let at = Span { end: offset(start + open.len_utf8()), ..whole };
        let length = end.map_or(line, |(i, _)| i);
        let inner = rest.get(..length).unwrap_or_default();
        self.problems.add(at, || {
            let help = say!("write the straight mark `{straight}` on both sides");
            Problem::new(&codes::BAD_CHARACTER, at, say!("`{open}` is no quotation mark here"))
                .help(help.clone())
                .fix(Fix::sure(help, whole, format!("{straight}{inner}{straight}")))
        });
        kind
    }

    /// Reports one problem for a run of characters without a meaning.
    fn bad_run(&mut self, start: usize) {
        while let Some(c) = self.rest().chars().next() {
            let bad = c.is_control() && !c.is_whitespace() || matches!(c, '?' | '@' | '~' | '$' | '\\');
            if !bad {
                break;
            }
            self.pos += c.len_utf8();
        }
        let run = self.text.get(start..self.pos).unwrap_or_default();
        // `decode` has reported broken UTF-8.
        if run.chars().all(|c| c == crate::decode::SUBSTITUTE) {
            return;
        }
        self.report(start, |at| {
            let shown: String = run.chars().take(8).flat_map(char::escape_debug).collect();
            let problem = Problem::new(&codes::BAD_CHARACTER, at, say!("`{shown}` has no meaning here"));
            if run == "~" { problem.help(say!("the complement is written `not a`")) } else { problem }
        });
    }
}

/// True if a name can begin with this character.
pub(crate) fn name_start(c: char) -> bool {
    c == '_' || unicode_ident::is_xid_start(c)
}

/// True if a name can continue with this character. A combining overline cannot: it means `not`.
pub(crate) fn name_continue(c: char) -> bool {
    // U+00B7 is the GRAFCET dot, although Unicode allows it in names.
    !matches!(c, '\u{304}' | '\u{305}' | '·') && unicode_ident::is_xid_continue(c)
}

fn offset(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}
