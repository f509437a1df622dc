//! Charts with parameters: their instances, and the names of these.

use super::Parser;
use crate::lexer::{Tok, Token};
use g7_model::{Instance, InstanceNames, Name, Said, Span, say};

impl Parser<'_> {
    /// `instance Axis[1..6](speed := 2.5)`, `instance Lift : Axis(7)`.
    pub(super) fn instance(&mut self) -> Instance {
        let start = self.bump().start;
        let first = self.name(say!("the name of a chart with parameters, or of the instance"));
        let open = self.here();
        let (chart, names) = if self.eat(Tok::LBracket) {
            let least = self.expr();
            self.expect(Tok::DotDot, say!("`..` and the greatest number"));
            let most = self.expr();
            self.close(Tok::RBracket, say!("`]`"), open);
            (first, InstanceNames::Range(Box::new(least), Box::new(most)))
        } else {
            self.expect(Tok::Colon, say!("`[1..6]`, or `:` and the name of a chart with parameters"));
            (self.name(say!("the name of a chart with parameters")), InstanceNames::One(first))
        };
        let args = if self.at_call() { self.call_args() } else { Vec::new() };
        let comment = self.comment_if();
        Instance { chart, names, args, comment, at: self.since(start).into() }
    }

    /// True if `instance` begins an item here: the name of a variable or step can be the same word.
    pub(super) fn at_instance(&mut self) -> bool {
        let name = self.peek();
        let named = matches!(name.kind, Tok::Word | Tok::Ticked) && !name.newline;
        named && matches!(self.lexer.ahead(name).token().kind, Tok::LBracket | Tok::Colon)
    }

    /// The name of a chart, which can be an instance of a range, `Axis[3]`, `Axis[i + 1]`, or that of an instance of
    /// a function block, `left.Cycle`, `gripper[2].Cycle`.
    pub(super) fn chart_name(&mut self, what: Said) -> Name {
        let first = self.name(what);
        let mut name = self.numbered_chart(first);
        while self.eat(Tok::PathDot) || self.prev.kind == Tok::RBracket && self.dot_of_member() {
            let member = self.member();
            let member = self.numbered_chart(member);
            let at = Span { end: self.prev.end, ..name.at.0 };
            name = Name::new(format!("{}.{}", name.text, member.text), at);
        }
        name
    }

    fn numbered_chart(&mut self, name: Name) -> Name {
        if !self.at(Tok::LBracket) || self.cur.start != self.prev.end {
            return name;
        }
        let Some((text, tokens)) = self.index_ahead() else {
            self.bump();
            self.expected(say!("a number, or a parameter such as `i` or `i + 1`"));
            return name;
        };
        self.numbered(name, &text, tokens)
    }

    /// Reads the index behind a name of a path, if a member or the arguments of a call follow it: `Axis[3].X12`,
    /// `d[3](x := a)`. Otherwise the index is that of an array, and is left.
    pub(super) fn chart_of_path(&mut self, name: Name) -> Name {
        if !self.at(Tok::LBracket) || self.cur.start != self.prev.end {
            return name;
        }
        match self.index_ahead() {
            Some((text, tokens)) if self.member_behind(tokens) => self.numbered(name, &text, tokens),
            _ => name,
        }
    }

    /// Reads the index behind the name of a member, if the arguments of a call follow it: `a.d[3](x := b)`.
    pub(super) fn called_instance(&mut self, name: Name) -> Name {
        if !self.at(Tok::LBracket) || self.cur.start != self.prev.end {
            return name;
        }
        match self.index_ahead() {
            Some((text, tokens)) if self.called_behind(tokens) => self.numbered(name, &text, tokens),
            _ => name,
        }
    }

    /// A name with an index whose tokens are ahead. Its place is that of the chart, so that renaming finds it.
    fn numbered(&mut self, name: Name, index: &str, tokens: u32) -> Name {
        for _ in 0..tokens {
            self.bump();
        }
        Name::new(format!("{}[{index}]", name.text), name.at.0)
    }

    /// Reads `[3]`, `[-3]`, `[i]`, `[i + 1]` or `[i - 1]` ahead: the text between the brackets, and the number of
    /// tokens with these.
    fn index_ahead(&mut self) -> Option<(String, u32)> {
        // Renaming finds a parameter right behind the bracket.
        let first = Some(self.peek()).filter(|t| t.start == self.cur.end)?;
        let then = |token: Token| self.lexer.ahead(token).token();
        let second = then(first);
        let (text, count, close) = match (first.kind, second.kind) {
            (Tok::Int, _) => (self.whole(first)?.to_string(), 2, second),
            (Tok::Minus, Tok::Int) => (format!("-{}", self.whole(second)?), 3, then(second)),
            (Tok::Word, Tok::Plus | Tok::Minus) => {
                let third = then(second);
                let sign = if second.kind == Tok::Plus { "+" } else { "-" };
                (format!("{} {sign} {}", self.slice(first), self.whole(third)?), 4, then(third))
            }
            (Tok::Word, _) => (self.slice(first).to_owned(), 2, second),
            _ => return None,
        };
        (close.kind == Tok::RBracket).then_some((text, count + 1))
    }

    fn whole(&self, token: Token) -> Option<i64> {
        (token.kind == Tok::Int).then(|| self.slice(token).parse().ok()).flatten()
    }

    /// True if `.name` or `(` follows so many tokens ahead; a number there is that of a bit.
    fn member_behind(&self, tokens: u32) -> bool {
        let [close, dot, name] = self.behind_index(tokens);
        called(close, dot) || is_member(close, dot, name)
    }

    /// True if `(` follows so many tokens ahead.
    fn called_behind(&self, tokens: u32) -> bool {
        let [close, open, _] = self.behind_index(tokens);
        called(close, open)
    }

    /// The bracket that closes an index of so many tokens, and the two tokens behind it.
    fn behind_index(&self, tokens: u32) -> [Token; 3] {
        let mut ahead = self.lexer.ahead(self.cur);
        // The bracket that opens is in hand already.
        let mut close = self.cur;
        (1..tokens).for_each(|_| close = ahead.token());
        [close, ahead.token(), ahead.token()]
    }

    /// Reads the dot between an index and the name of a member, `m[i].b`. Returns false, and reads nothing, if there
    /// is none.
    pub(super) fn dot_of_member(&mut self) -> bool {
        if self.eat(Tok::PathDot) {
            return true;
        }
        let member = self.at(Tok::Dot) && {
            let name = self.peek();
            is_member(self.prev, self.cur, name)
        };
        if member {
            self.bump();
        }
        member
    }
}

/// True if the arguments of a call stand close behind an index.
fn called(close: Token, open: Token) -> bool {
    open.kind == Tok::LParen && open.start == close.end
}

/// True if a dot joins a name to an index: without a blank on either side. Elsewhere a `.` behind a bracket is AND.
fn is_member(close: Token, dot: Token, name: Token) -> bool {
    let glued = close.end == dot.start && dot.end == name.start;
    glued && dot.kind == Tok::Dot && matches!(name.kind, Tok::Word | Tok::Ticked)
}
