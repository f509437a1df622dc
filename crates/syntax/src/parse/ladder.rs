//! The rungs of a Ladder Diagram written as text.
//!
//! The signs of a rung are read one by one. The text between its brackets is read as an expression
//! or a statement.

use super::Parser;
use crate::lexer::{Lexer, Tok, Token};
use g7_iec::ld::{Coil, Element, Rung};
use g7_model::{
    BinaryOp, Expr, ExprKind, FileId, Name, Problem, Said, Span, Stmt, StmtKind, UnaryOp, codes, say,
};

/// The deepest nesting of branches.
const DEEPEST: usize = 60;

/// Reads the rungs of `text` from `start` to its end.
pub(crate) fn rungs(text: &str, file: FileId, start: usize) -> (Vec<Rung>, Vec<Problem>) {
    let mut reader = Reader { text, file, pos: start, problems: Vec::new() };
    let mut rungs = Vec::new();
    while let Some(rung) = reader.rung() {
        rungs.push(rung);
    }
    (rungs, reader.problems)
}

struct Reader<'a> {
    text: &'a str,
    file: FileId,
    pos: usize,
    problems: Vec<Problem>,
}

/// Why a wire ended.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    Line,
    Bar,
    Brace,
    Text,
}

impl<'a> Reader<'a> {
    fn rest(&self) -> &'a str {
        self.text.get(self.pos..).unwrap_or("")
    }

    fn byte(&self) -> Option<u8> {
        self.text.as_bytes().get(self.pos).copied()
    }

    fn span(&self, start: usize) -> Span {
        let clip = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Span { file: self.file, start: clip(start), end: clip(self.pos.max(start)) }
    }

    fn say(&mut self, at: Span, what: Said) {
        if self.problems.len() < 200 {
            self.problems.push(Problem::new(&codes::EXPECTED, at, what));
        }
    }

    /// Skips blanks that are no line end, and notes.
    fn blanks(&mut self) {
        loop {
            let rest = self.rest();
            let note = [("(*", "*)"), ("/*", "*/")].iter().find(|(open, _)| rest.starts_with(open));
            if let Some((_, close)) = note {
                self.pos += rest.get(2..).and_then(|r| r.find(close)).map_or(rest.len(), |i| i + 4);
            } else if rest.starts_with("//") {
                self.pos += rest.find('\n').unwrap_or(rest.len());
            } else {
                match rest.chars().next() {
                    Some(c) if c != '\n' && c.is_whitespace() => self.pos += c.len_utf8(),
                    _ => return,
                }
            }
        }
    }

    /// Skips blanks, notes and line ends.
    fn lines(&mut self) {
        loop {
            self.blanks();
            if self.byte() != Some(b'\n') {
                return;
            }
            self.pos += 1;
        }
    }

    fn rung(&mut self) -> Option<Rung> {
        self.lines();
        if self.pos >= self.text.len() {
            return None;
        }
        let start = self.pos;
        let label = self.label();
        let mut elements = Vec::new();
        loop {
            let before = self.pos;
            let end = self.wire(&mut elements, 0);
            match end {
                End::Line | End::Text => break,
                // The rail at the beginning or the end of the line.
                End::Bar => {}
                End::Brace => self.say(self.span(before), say!("this `}}` closes nothing")),
            }
        }
        Some(Rung { label, elements, at: self.span(start) })
    }

    /// `name:` at the beginning of a rung.
    fn label(&mut self) -> Option<Name> {
        let mut lexer = Lexer::new(self.text, self.file, self.pos);
        let name = lexer.token();
        let colon = lexer.token();
        let word = self.text.get(name.start as usize..name.end as usize)?;
        let here = name.kind == Tok::Word && name.start as usize == self.pos;
        let fits = here && colon.kind == Tok::Colon && !colon.newline;
        if !fits {
            return None;
        }
        let at = Span { file: self.file, start: name.start, end: name.end };
        self.pos = colon.end as usize;
        Some(Name::new(word, at))
    }

    /// Elements up to the end of the line, or to what ends a branch.
    fn wire(&mut self, out: &mut Vec<Element>, depth: usize) -> End {
        let mut joined = false;
        loop {
            if depth > 0 {
                self.lines()
            } else {
                self.blanks()
            }
            let start = self.pos;
            let Some(c) = self.rest().chars().next() else { return End::Text };
            match c {
                '\n' => {
                    self.pos += 1;
                    if !joined {
                        return End::Line;
                    }
                    self.lines();
                    joined = false;
                    continue;
                }
                '-' | '+' | '─' => {
                    self.pos += c.len_utf8();
                    joined = true;
                    continue;
                }
                '|' => {
                    self.pos += 1;
                    return End::Bar;
                }
                '}' => {
                    self.pos += 1;
                    return End::Brace;
                }
                '[' => out.extend(self.contact()),
                '(' => out.extend(self.coil()),
                '<' => out.extend(self.block()),
                '{' => out.extend(self.branch(depth)),
                _ => {
                    self.pos += c.len_utf8();
                    self.skip_unknown();
                    let at = self.span(start);
                    self.say(at, say!("a contact `[a]`, a coil `(q)`, a block `<t(IN)>` or a branch `{{ … | … }}` stands here"));
                }
            }
            joined = false;
        }
    }

    /// Skips text that belongs to no element.
    fn skip_unknown(&mut self) {
        let rest = self.rest();
        let stop = |c: char| matches!(c, '\n' | '-' | '|' | '}' | '[' | '(' | '<' | '{');
        self.pos += rest.find(stop).unwrap_or(rest.len());
    }

    /// The text up to the closing bracket; the position moves behind that bracket.
    fn inside(&mut self, open: char, close: char) -> Option<(usize, usize)> {
        let start = self.pos;
        self.pos += open.len_utf8();
        let from = self.pos;
        let mut depth = 0usize;
        let mut quote = None;
        // Within a block, `<` and `>` between parentheses compare.
        let mut parens = 0usize;
        let mut before = ' ';
        for (i, c) in self.rest().char_indices() {
            // Directly after an operand, `'` complements it.
            let prime =
                c == '\'' && (before.is_alphanumeric() || matches!(before, '_' | ')' | ']' | '`' | '\''));
            before = c;
            match (quote, c) {
                (None, '\'') if prime => {}
                (_, '\n') => break,
                (Some(q), c) if c == q => quote = None,
                (Some(_), _) => {}
                (None, '`' | '\'' | '"') => quote = Some(c),
                (None, c) if c == close && depth == 0 && parens == 0 => {
                    let to = from + i;
                    self.pos = to + close.len_utf8();
                    return Some((from, to));
                }
                (None, '(') if open == '<' => parens += 1,
                (None, ')') if open == '<' => parens = parens.saturating_sub(1),
                (None, c) if c == open && parens == 0 => depth += 1,
                (None, c) if c == close && parens == 0 => depth = depth.saturating_sub(1),
                _ => {}
            }
        }
        let rest = self.rest();
        self.pos += rest.find('\n').unwrap_or(rest.len());
        let at = Span { end: u32::try_from(from).unwrap_or(u32::MAX), ..self.span(start) };
        self.problems.push(Problem::new(&codes::UNCLOSED, at, say!("`{close}` is missing on this line")));
        None
    }

    /// A parser of the text from `from` to `to`.
    fn part(&self, from: usize, to: usize) -> Parser<'a> {
        Parser::portion(self.text.get(..to).unwrap_or(""), self.file, from)
    }

    /// The problems of the parser; it must have read everything.
    fn done(&mut self, mut parser: Parser) {
        parser.expect_end();
        self.problems.extend(parser.finish().0);
    }

    /// `[a]`, `[/a]`, `[P a]`, `[N a]`, `[n > 5]`.
    fn contact(&mut self) -> Option<Element> {
        let (from, to) = self.inside('[', ']')?;
        let mut parser = self.part(from, to);
        let word = parser.two_words();
        let op = match word {
            Some("P") => Some(UnaryOp::Rise),
            Some("N") => Some(UnaryOp::Fall),
            _ => None,
        };
        if op.is_some() {
            parser.bump();
        }
        let e = parser.expr();
        self.done(parser);
        let at = e.at;
        Some(Element::Contact(match op {
            Some(op) => Expr { kind: ExprKind::Unary(op, Box::new(e)), at },
            None => e,
        }))
    }

    /// `(q)`, `(/q)`, `(S q)`, `(R q)`, `(P q)`, `(N q)`, `(n := n + 1)`, `(JMP out)`, `(RET)`.
    fn coil(&mut self) -> Option<Element> {
        let start = self.pos;
        let (from, to) = self.inside('(', ')')?;
        let at = self.span(start);
        let mut parser = self.part(from, to);
        let word = parser.two_words();
        let coil = match word {
            Some("JMP") => {
                parser.bump();
                Coil::Jump(parser.name(say!("a label")))
            }
            Some("S" | "R" | "P" | "N") => {
                parser.bump();
                let target = parser.coil_target();
                match word {
                    Some("S") => Coil::Latch(target, true),
                    Some("R") => Coil::Latch(target, false),
                    Some("P") => Coil::Edge(target, UnaryOp::Rise),
                    _ => Coil::Edge(target, UnaryOp::Fall),
                }
            }
            _ => parser.plain_coil(),
        };
        self.done(parser);
        Some(Element::Coil(coil, at))
    }

    /// `<t1(IN, PT := 5s).Q>`.
    fn block(&mut self) -> Option<Element> {
        let start = self.pos;
        let (from, to) = self.inside('<', '>')?;
        let at = self.span(start);
        let mut parser = self.part(from, to);
        let path = parser.path_or_empty(say!("the name of a function block"));
        let args = if parser.at_call() { parser.call_args() } else { Vec::new() };
        let output = if parser.eat(Tok::PathDot) || parser.eat(Tok::Dot) {
            Some(parser.name(say!("the name of an output")))
        } else {
            None
        };
        self.done(parser);
        Some(Element::Block { path, args, output, at })
    }

    fn branch(&mut self, depth: usize) -> Option<Element> {
        let start = self.pos;
        self.pos += 1;
        if depth >= DEEPEST {
            let at = self.span(start);
            let what = say!("branches are nested more than {DEEPEST} deep");
            self.problems.push(Problem::new(&codes::TOO_DEEP, at, what));
            self.pos = self.text.len();
            return None;
        }
        let mut ways = Vec::new();
        loop {
            let mut way = Vec::new();
            let end = self.wire(&mut way, depth + 1);
            ways.push(way);
            match end {
                End::Bar => {}
                End::Brace => break,
                End::Line | End::Text => {
                    let at = Span { end: self.span(start).start + 1, ..self.span(start) };
                    self.problems.push(Problem::new(
                        &codes::UNCLOSED,
                        at,
                        say!("this branch is never closed with `}}`"),
                    ));
                    break;
                }
            }
        }
        Some(Element::Branch(ways, self.span(start)))
    }
}

impl<'a> Parser<'a> {
    /// The first of two words, if two follow each other.
    fn two_words(&mut self) -> Option<&'a str> {
        let second = self.peek();
        let both = self.at(Tok::Word) && matches!(second.kind, Tok::Word | Tok::Ticked | Tok::Direct);
        let first = self.slice(self.cur);
        let operator = BinaryOp::of_word(self.slice(second)).is_some();
        (both && !operator).then_some(first)
    }

    fn coil_target(&mut self) -> Expr {
        let start = self.cur.start;
        if self.at(Tok::Direct) {
            let token: Token = self.bump();
            let kind = ExprKind::Direct(self.direct_name(token));
            return Expr { kind, at: self.since(start).into() };
        }
        let path = self.path_or_empty(say!("a variable"));
        Expr { kind: ExprKind::Path(path), at: self.since(start).into() }
    }

    /// A variable, its complement, an assignment or a call.
    fn plain_coil(&mut self) -> Coil {
        let start = self.cur.start;
        if self.eat(Tok::Slash) || self.eat(Tok::Bang) {
            return Coil::Assign(self.coil_target(), true);
        }
        if self.at(Tok::Word) && self.slice(self.cur) == "RET" && self.peek().kind == Tok::End {
            self.bump();
            return Coil::Return;
        }
        let target = self.coil_target();
        if self.at_call()
            && let ExprKind::Path(path) = target.kind
        {
            let kind = StmtKind::Call(path, self.call_args());
            return Coil::Statement(Box::new(Stmt { kind, at: self.since(start).into() }));
        }
        if self.at(Tok::Assign) {
            let kind = self.assignment(target);
            return Coil::Statement(Box::new(Stmt { kind, at: self.since(start).into() }));
        }
        Coil::Assign(target, false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rung_goes_on_behind_a_line_that_ends_on_a_wire() {
        let text = "--[a]--\n  [/b]--(q)\n--[c]--(r)";
        let (rungs, problems) = rungs(text, FileId(0), 0);
        assert_eq!(problems, []);
        assert_eq!(rungs.iter().map(|r| r.elements.len()).collect::<Vec<_>>(), [3, 2]);
    }
}
