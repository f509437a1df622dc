//! Splits the text into words, numbers and signs.
//!
//! Comments (`(* *)`, `//`, `/* */`) and pragmas (`{ }`) are skipped; a pragma with statements of another language
//! (matiec: C) is kept for a report. Nothing is refused here: an
//! unknown character becomes a sign that no rule accepts.

use std::ops::Range;

/// Kinds of token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A name or a word of the language.
    Word,
    /// `12`, `16#FF`, `1.5E3`.
    Number,
    /// `T#5s`, `INT#5`, `Colour#Red`.
    Typed,
    /// `'text'`.
    Str,
    /// `"text"`.
    WideStr,
    /// `%IX0.0`.
    Direct,
    Sign,
    End,
}

/// One token.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Token {
    pub(crate) kind: Kind,
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// True if a line ended between the previous token and this one.
    pub(crate) newline: bool,
}

/// A text in tokens.
pub(crate) struct Lexed {
    /// They end with `End`.
    pub(crate) tokens: Vec<Token>,
    pub(crate) comments: Vec<Range<usize>>,
    /// The pragmas with statements of another language.
    pub(crate) foreign: Vec<Range<usize>>,
}

/// Splits a text.
pub(crate) fn tokens(text: &str) -> Lexed {
    let mut lexer = Lexer { text, pos: 0, comments: Vec::new(), foreign: Vec::new(), flat: false };
    let mut tokens = Vec::new();
    loop {
        let newline = lexer.blanks();
        let start = lexer.pos;
        let kind = lexer.scan();
        tokens.push(Token { kind, start: offset(start), end: offset(lexer.pos), newline });
        if kind == Kind::End {
            return Lexed { tokens, comments: lexer.comments, foreign: lexer.foreign };
        }
    }
}

fn offset(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

struct Lexer<'a> {
    text: &'a str,
    pos: usize,
    comments: Vec<Range<usize>>,
    foreign: Vec<Range<usize>>,
    /// True if comments do not nest: with nesting, one would stay open at the end of the text.
    flat: bool,
}

/// Signs of two characters; they are tried before single ones.
const SIGNS: [&str; 12] = [":=", "=>", "<=", ">=", "<>", "==", "!=", "**", "..", "&&", "||", "?="];

impl Lexer<'_> {
    fn rest(&self) -> &str {
        self.text.get(self.pos..).unwrap_or("")
    }

    fn byte(&self, ahead: usize) -> u8 {
        self.text.as_bytes().get(self.pos + ahead).copied().unwrap_or(0)
    }

    /// Skips blanks, comments and pragmas; returns true if a line ended.
    fn blanks(&mut self) -> bool {
        let mut newline = false;
        loop {
            let start = self.pos;
            match (self.byte(0), self.byte(1)) {
                (b'\n', _) => {
                    newline = true;
                    self.pos += 1;
                }
                (b' ' | b'\t' | b'\r' | 0x0B | 0x0C, _) => self.pos += 1,
                (b'(', b'*') => {
                    self.block("(*", "*)");
                    self.comments.push(start..self.pos);
                }
                (b'/', b'*') => {
                    self.block("/*", "*/");
                    self.comments.push(start..self.pos);
                }
                (b'/', b'/') => {
                    let rest = self.rest();
                    self.pos += rest.find('\n').unwrap_or(rest.len());
                    self.comments.push(start..self.pos);
                }
                (b'{', _) => {
                    let rest = self.rest();
                    // matiec: `{{ … }}` holds text with braces.
                    let close = if rest.starts_with("{{") { "}}" } else { "}" };
                    self.pos += rest.find(close).map_or(rest.len(), |i| i + close.len());
                    if self.text.get(start..self.pos).is_some_and(|t| t.contains(';')) {
                        self.foreign.push(start..self.pos);
                    }
                }
                (0x80.., _) => match self.rest().chars().next() {
                    Some(c) if c.is_whitespace() || c == '\u{feff}' => self.pos += c.len_utf8(),
                    _ => return newline,
                },
                _ => return newline,
            }
            newline |= self.text.get(start..self.pos).is_some_and(|t| t.contains('\n'));
        }
    }

    /// Skips a comment in brackets: up to the matching bracket, or to the first closing one if none
    /// matches.
    fn block(&mut self, open: &str, close: &str) {
        let rest = self.rest();
        let flat = rest.get(2..).and_then(|r| r.find(close)).map_or(rest.len(), |i| i + 4);
        let mut end = flat;
        if !self.flat {
            match nested(rest, open, close) {
                Some(all) => end = all,
                None => self.flat = true,
            }
        }
        self.pos += end;
    }

    fn scan(&mut self) -> Kind {
        let rest = self.rest();
        let Some(c) = rest.chars().next() else { return Kind::End };
        if c.is_alphabetic() || c == '_' {
            return self.word();
        }
        match c {
            '0'..='9' => self.number(),
            '%' => {
                self.pos += 1;
                self.take(|c| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '*'));
                Kind::Direct
            }
            '\'' => self.quoted(b'\'', Kind::Str),
            '"' => self.quoted(b'"', Kind::WideStr),
            _ => {
                let two = SIGNS.iter().any(|s| rest.starts_with(s));
                self.pos += if two { 2 } else { c.len_utf8() };
                Kind::Sign
            }
        }
    }

    fn take(&mut self, belongs: impl Fn(char) -> bool) {
        let rest = self.rest();
        self.pos += rest.find(|c| !belongs(c)).unwrap_or(rest.len());
    }

    fn word(&mut self) -> Kind {
        let start = self.pos;
        self.take(|c| c.is_alphanumeric() || c == '_');
        if self.byte(0) != b'#' {
            return Kind::Word;
        }
        let prefix = self.text.get(start..self.pos).unwrap_or("").to_ascii_uppercase();
        self.pos += 1;
        match (prefix.as_str(), self.byte(0)) {
            ("DATE" | "D" | "DT" | "DATE_AND_TIME" | "TOD" | "TIME_OF_DAY" | "LDT" | "LTOD" | "LDATE", _) => {
                self.take(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | ':' | '.' | '_'));
            }
            (_, b'\'') => {
                self.quoted(b'\'', Kind::Str);
            }
            (_, b'+' | b'-') => {
                self.pos += 1;
                self.digits();
            }
            (_, b'0'..=b'9') => self.digits(),
            _ => self.take(|c| c.is_alphanumeric() || c == '_'),
        }
        Kind::Typed
    }

    fn number(&mut self) -> Kind {
        self.digits();
        Kind::Number
    }

    /// `12`, `16#FF`, `1.5`, `1.0E-3`, `1h_30m`, `2.5s`.
    fn digits(&mut self) {
        self.take(|c| c.is_ascii_alphanumeric() || c == '_');
        if self.byte(0) == b'#' {
            self.pos += 1;
            self.take(|c| c.is_ascii_alphanumeric() || c == '_');
            return;
        }
        if self.byte(0) == b'.' && self.byte(1).is_ascii_digit() {
            self.pos += 1;
            self.take(|c| c.is_ascii_alphanumeric() || c == '_');
        }
        let before = self.text.as_bytes().get(self.pos.wrapping_sub(1)).copied().unwrap_or(0);
        if matches!(before, b'e' | b'E')
            && matches!(self.byte(0), b'+' | b'-')
            && self.byte(1).is_ascii_digit()
        {
            self.pos += 1;
            self.take(|c| c.is_ascii_digit() || c == '_');
        }
    }

    /// Skips to the closing quote or the end of the line.
    fn quoted(&mut self, quote: u8, kind: Kind) -> Kind {
        self.pos += 1;
        loop {
            match self.byte(0) {
                _ if self.pos >= self.text.len() => return kind,
                b'\n' => return kind,
                b if b == quote => {
                    self.pos += 1;
                    return kind;
                }
                b'$' if self.byte(1).is_ascii() && !matches!(self.byte(1), b'\n' | 0) => self.pos += 2,
                _ => self.pos += self.rest().chars().next().map_or(1, char::len_utf8),
            }
        }
    }
}

/// The length of a comment with nested comments, if it is closed.
fn nested(text: &str, open: &str, close: &str) -> Option<usize> {
    let mut depth = 0usize;
    let mut at = 0;
    loop {
        let rest = text.get(at..)?;
        let next_close = at + rest.find(close)?;
        let inner = text.get(at..next_close).and_then(|t| t.find(open));
        match inner {
            Some(i) => {
                depth += 1;
                at += i + open.len();
            }
            None => {
                depth = depth.checked_sub(1)?;
                at = next_close + close.len();
                if depth == 0 {
                    return Some(at);
                }
            }
        }
    }
}
