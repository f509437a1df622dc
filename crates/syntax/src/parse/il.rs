//! The lines of an Instruction List: one operator each, with its operand.

use super::Parser;
use crate::lexer::Tok;
use g7_iec::il::{Instruction, InstructionKind as Kind, Mnemonic, Operand, When, is_input, mnemonic};
use g7_model::{Arg, BinaryOp, Expr, ExprKind, Name, Path, Said, UnaryOp, codes, say};

impl Parser<'_> {
    /// The instructions up to the end of the text.
    pub(crate) fn instructions(&mut self) -> Vec<Instruction> {
        let mut list = Vec::new();
        loop {
            self.skip_semis();
            if self.at(Tok::End) {
                return list;
            }
            let start = self.cur.start;
            match self.line(Parser::instruction) {
                // A word of the language where a name should be is left standing.
                Some(kind) if self.cur.start > start => {
                    list.push(Instruction { kind, at: self.since(start) })
                }
                _ => self.next_line(start),
            }
        }
    }

    /// Continues on the next line after a problem.
    fn next_line(&mut self, start: u32) {
        if self.cur.start == start {
            self.bump();
        }
        while !self.at(Tok::End) && !self.cur.newline {
            self.bump();
        }
    }

    fn instruction(&mut self) -> Option<Kind> {
        if self.eat(Tok::RParen) {
            return Some(Kind::Close);
        }
        if self.at_name() && self.peek().kind == Tok::Colon {
            let name = self.name(say!("a label"));
            self.bump();
            return Some(Kind::Label(name));
        }
        if self.at(Tok::Amp) {
            self.bump();
            let next = self.peek();
            let negated = matches!(self.slice(self.cur), "N" | "n")
                && !self.cur.newline
                && !next.newline
                && next.kind != Tok::End;
            if negated {
                self.bump();
            }
            return Some(Kind::Operate { op: BinaryOp::And, negated, operand: self.operands()? });
        }
        if !self.at(Tok::Word) && !self.at(Tok::Ticked) {
            self.expected_help(say!("an instruction"), Some(say!("for example `LD a`, `ANDN b` or `ST c`")));
            return None;
        }
        let word = self.slice(self.cur).to_ascii_uppercase();
        let Some(found) = mnemonic(&word) else { return self.applied(&word) };
        self.bump();
        Some(match found {
            Mnemonic::Load(negated) => Kind::Load { value: self.loaded()?, negated },
            Mnemonic::Store(negated) => Kind::Store { target: self.stored()?, negated },
            Mnemonic::Latch(value) => Kind::Latch { target: self.stored()?, value },
            Mnemonic::Operate(op, negated) => Kind::Operate { op, negated, operand: self.operands()? },
            Mnemonic::Complement => Kind::Complement,
            Mnemonic::Jump(when) => Kind::Jump(self.label()?, when),
            Mnemonic::Call(when) => self.block_call(when)?,
            Mnemonic::Return(when) => Kind::Return(when),
        })
    }

    /// True if the operator has an operand on its line.
    fn on_line(&mut self, what: Said) -> bool {
        let here = !self.cur.newline && !matches!(self.cur.kind, Tok::End | Tok::Semi);
        if !here {
            self.expected(what);
        }
        here
    }

    fn label(&mut self) -> Option<Name> {
        if !self.on_line(say!("the name of a label")) {
            return None;
        }
        Some(self.name(say!("the name of a label"))).filter(|n| !n.text.is_empty())
    }

    /// The operand of LD; in parentheses any expression of Structured Text.
    fn loaded(&mut self) -> Option<Expr> {
        self.on_line(say!("a value")).then(|| self.signed(true))
    }

    /// The operand of an operation: `(` opens a bracket.
    fn operands(&mut self) -> Option<Operand> {
        if !self.on_line(say!("a value or `(`")) {
            return None;
        }
        if self.eat(Tok::LParen) {
            let same_line = !self.cur.newline && !matches!(self.cur.kind, Tok::RParen | Tok::End);
            return Some(Operand::Open(same_line.then(|| self.signed(true))));
        }
        let mut values = vec![self.signed(false)];
        while self.eat(Tok::Comma) {
            values.push(self.signed(true));
        }
        Some(Operand::Values(values))
    }

    /// A value with its sign or edge.
    fn signed(&mut self, brackets: bool) -> Expr {
        let start = self.cur.start;
        let op = match self.cur.kind {
            Tok::Minus => UnaryOp::Neg,
            Tok::Rise => UnaryOp::Rise,
            Tok::Fall => UnaryOp::Fall,
            Tok::LParen if !brackets => {
                self.expected(say!("a value"));
                return self.bad();
            }
            _ => return self.operand(),
        };
        self.bump();
        let inner = self.operand();
        Expr { kind: ExprKind::Unary(op, Box::new(inner)), at: self.since(start).into() }
    }

    /// The target of a store: a variable.
    fn stored(&mut self) -> Option<Expr> {
        if !self.on_line(say!("a variable")) {
            return None;
        }
        let e = self.operand();
        match e.kind {
            ExprKind::Path(_) | ExprKind::Direct(_) => Some(e),
            ExprKind::Bad => None,
            _ => {
                self.problem(&codes::EXPECTED, e.at.0, say!("only a variable can be written"));
                None
            }
        }
    }

    /// `CAL c(CU := x)`.
    fn block_call(&mut self, when: When) -> Option<Kind> {
        if !self.on_line(say!("the name of a function block")) {
            return None;
        }
        let path = self.path_or_empty(say!("the name of a function block"));
        let args: Vec<Arg> = if self.at_call() { self.call_args() } else { Vec::new() };
        Some(Kind::Call(path, args, when))
    }

    /// `MAX b`, `LIMIT b, c`, `CU C10`, or a call with all inputs by name.
    fn applied(&mut self, word: &str) -> Option<Kind> {
        let start = self.cur.start;
        let name = self.name(say!("an operator"));
        if self.at_call() {
            let args = self.call_args();
            if args.iter().all(|a| a.name.is_some()) {
                let kind = ExprKind::Call(Path { names: vec![name] }, args);
                let value = Expr { kind, at: self.since(start).into() };
                return Some(Kind::Load { value, negated: false });
            }
            return Some(Kind::Apply(name, args.into_iter().map(|a| a.value).collect()));
        }
        if self.cur.newline || matches!(self.cur.kind, Tok::End | Tok::Semi | Tok::RParen) {
            return Some(Kind::Apply(name, Vec::new()));
        }
        if is_input(word) && self.at_name() {
            return Some(Kind::Input(name, self.path()));
        }
        let mut values = vec![self.signed(true)];
        while self.eat(Tok::Comma) {
            values.push(self.signed(true));
        }
        Some(Kind::Apply(name, values))
    }
}
