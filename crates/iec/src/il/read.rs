//! Reads an Instruction List in the spelling of the standard.

use g7_model::codes;
use g7_model::{Arg, Expr, ExprKind, Name, Path, StandardFunction, Stmt, say};

use super::instruction::{Instruction, InstructionKind as Kind, Mnemonic, Operand, When, is_input, mnemonic};
use super::translate::{translate, translate_expr};
use crate::report::Report;
use crate::st::lex;
use crate::st::parse::{Parser, Places};
use crate::words::closes;

/// Reads an Instruction List as the statements that do the same.
pub fn statements(text: &str, place: Places, report: &mut Report) -> Vec<Stmt> {
    Parser::new(text, place, report).il_statements()
}

/// Reads an Instruction List as the expression that is its last result: a receptivity.
pub fn expression(text: &str, place: Places, report: &mut Report) -> Expr {
    Parser::new(text, place, report).il_expression()
}

impl Parser<'_> {
    /// The statements that do what the Instruction List does.
    pub(crate) fn il_statements(&mut self) -> Vec<Stmt> {
        let list = joined(self.instructions());
        let (statements, problems) = translate(&list);
        self.tell(problems);
        statements
    }

    /// The last result of the Instruction List.
    pub(crate) fn il_expression(&mut self) -> Expr {
        let at = self.token().start;
        let list = self.instructions();
        let span = self.since(at);
        let (expr, problems) = translate_expr(&list, span);
        self.tell(problems);
        expr
    }

    /// True if an Instruction List stands here, not Structured Text.
    pub(crate) fn at_instruction(&self) -> bool {
        let next = self.ahead(1);
        if self.token().kind != lex::Kind::Word {
            return self.at("&");
        }
        if self.ahead_is(1, ":") {
            return true;
        }
        let operand = matches!(
            next.kind,
            lex::Kind::Word | lex::Kind::Number | lex::Kind::Typed | lex::Kind::Direct | lex::Kind::Str
        );
        let word = self.word();
        // `CU count`: a list may begin with an input of a block.
        let input = is_input(&word) && next.kind == lex::Kind::Word && !next.newline;
        input || mnemonic(&word).is_some() && (operand || word == "RET") && !self.ahead_is(1, ":=")
    }

    /// Reports problems of the translation under the code used for imported files.
    fn tell(&mut self, problems: Vec<g7_model::Problem>) {
        for mut problem in problems {
            problem.code = &codes::NOT_CARRIED;
            self.report.put(problem);
        }
    }

    /// Reads instructions up to the end of the text or a word that ends a body.
    fn instructions(&mut self) -> Vec<Instruction> {
        let mut list = Vec::new();
        loop {
            while self.eat(";") {}
            if self.at_end() || closes(&self.word()) {
                return list;
            }
            let before = self.mark();
            self.instruction(&mut list);
            if self.mark() == before {
                self.expected(say!("an instruction"));
                self.bump();
            }
        }
    }

    fn instruction(&mut self, list: &mut Vec<Instruction>) {
        let token = self.token();
        let start = token.start;
        if self.eat(")") {
            list.push(Instruction { kind: Kind::Close, at: self.since(start) });
            return;
        }
        if token.kind == lex::Kind::Word && self.ahead_is(1, ":") {
            let name = self.label();
            self.bump();
            list.extend(name.map(|n| Instruction { kind: Kind::Label(n), at: self.since(start) }));
            return;
        }
        let kind = if self.at("&") { self.ampersand() } else { self.operation() };
        if let Some(kind) = kind {
            list.push(Instruction { kind, at: self.since(start) });
        } else {
            while !self.at_end() && !self.token().newline {
                self.bump();
            }
        }
    }

    /// A label in upper case, because labels are compared without regard to case.
    fn label(&mut self) -> Option<Name> {
        let mut name = self.name(say!("a label"))?;
        name.text = name.text.to_ascii_uppercase().into();
        Some(name)
    }

    fn ampersand(&mut self) -> Option<Kind> {
        self.bump();
        let negated = self.at_word("N") && !self.token().newline && self.operand_behind();
        if negated {
            self.bump();
        }
        Some(Kind::Operate { op: g7_model::BinaryOp::And, negated, operand: self.operand()? })
    }

    /// True if an operand or `(` follows the current word on its line.
    fn operand_behind(&self) -> bool {
        let next = self.ahead(1);
        !next.newline && next.kind != lex::Kind::End && !self.ahead_is(1, ";")
    }

    fn operation(&mut self) -> Option<Kind> {
        let mut word = self.word();
        if word.is_empty() {
            self.expected(say!("an operator"));
            return None;
        }
        let name = self.name(say!("an operator"))?;
        // CODESYS and others write `AND N (`.
        if self.at_word("N") && !self.token().newline && self.ahead_is(1, "(") {
            let with_n = format!("{word}N");
            if mnemonic(&with_n).is_some() {
                self.bump();
                word = with_n;
            }
        }
        let Some(mnemonic) = mnemonic(&word) else { return self.function(name, &word) };
        Some(match mnemonic {
            Mnemonic::Load(negated) => {
                let value =
                    if self.at("(") && !self.token().newline { self.bracketed()? } else { self.value()? };
                Kind::Load { value, negated }
            }
            Mnemonic::Store(negated) => Kind::Store { target: self.target_operand()?, negated },
            Mnemonic::Latch(value) => Kind::Latch { target: self.target_operand()?, value },
            Mnemonic::Operate(op, negated) => Kind::Operate { op, negated, operand: self.operand()? },
            Mnemonic::Complement => {
                // `NOT` may be followed by empty brackets.
                if self.at("(") && self.ahead_is(1, ")") && !self.token().newline {
                    self.bump();
                    self.bump();
                }
                Kind::Complement
            }
            Mnemonic::Jump(when) => Kind::Jump(self.label()?, when),
            Mnemonic::Call(when) => self.call_instruction(when)?,
            Mnemonic::Return(when) => Kind::Return(when),
        })
    }

    /// `LD (a)`, as some tools write it.
    fn bracketed(&mut self) -> Option<Expr> {
        self.bump();
        let e = self.expr();
        self.expect(")");
        Some(e)
    }

    /// The operand of an operation; it stands on the line of its operator.
    fn operand(&mut self) -> Option<Operand> {
        if self.at("(") && !self.token().newline {
            self.bump();
            let same_line = !self.token().newline && !self.at(")");
            let value = if same_line { Some(self.value()?) } else { None };
            return Some(Operand::Open(value));
        }
        let mut values = vec![self.value()?];
        while self.eat(",") {
            values.push(self.value()?);
        }
        Some(Operand::Values(values))
    }

    /// A variable or constant.
    fn value(&mut self) -> Option<Expr> {
        let token = self.token();
        if token.newline || self.at_end() {
            self.expected(say!("an operand"));
            return None;
        }
        let start = token.start;
        let negative = self.eat("-");
        let e = match self.token().kind {
            lex::Kind::Word if !matches!(self.word().as_str(), "TRUE" | "FALSE") => self.variable(),
            lex::Kind::Sign => {
                self.expected(say!("an operand"));
                return None;
            }
            _ => self.expr_operand(),
        };
        if !negative {
            return Some(e);
        }
        let kind = ExprKind::Unary(g7_model::UnaryOp::Neg, Box::new(e));
        Some(Expr { kind, at: self.since(start).into() })
    }

    fn expr_operand(&mut self) -> Expr {
        let token = self.token();
        if token.kind == lex::Kind::Word {
            self.bump();
            return self.boolean(token, self.slice(token).eq_ignore_ascii_case("TRUE"));
        }
        if token.kind == lex::Kind::Direct {
            self.bump();
            let name = self.slice(token).trim_start_matches('%').to_ascii_uppercase();
            return Expr { kind: ExprKind::Direct(name.into()), at: self.span_of(token).into() };
        }
        self.literal()
    }

    fn target_operand(&mut self) -> Option<Expr> {
        let at = self.here();
        let value = self.value()?;
        match value.kind {
            ExprKind::Path(_) | ExprKind::Element(..) | ExprKind::Direct(_) => Some(value),
            ExprKind::Bad => None,
            _ => {
                self.report.say(&codes::BAD_TEXT, &at, say!("only a variable can be written"));
                None
            }
        }
    }

    /// `CAL t1(IN := a, PT := T#5s)`.
    fn call_instruction(&mut self, when: When) -> Option<Kind> {
        let instance = self.variable();
        let args: Vec<Arg> = if self.at("(") { self.args().list } else { Vec::new() };
        Some(Kind::Call(self.called(instance)?, args, when))
    }

    /// A function, or an input of a function block.
    fn function(&mut self, name: Name, word: &str) -> Option<Kind> {
        let next = self.token();
        if self.at("(") && !next.newline {
            let start = name.at.0;
            let args = self.args().list;
            let all = args.iter().all(|a| a.name.is_some());
            if all && StandardFunction::operator(word).is_none() {
                let kind = ExprKind::Call(Path { names: vec![name] }, args);
                let at = start.to(self.since(next.start));
                return Some(Kind::Load { value: Expr { kind, at: at.into() }, negated: false });
            }
            return Some(Kind::Apply(name, args.into_iter().map(|a| a.value).collect()));
        }
        if next.newline || self.at_end() {
            return Some(Kind::Apply(name, Vec::new()));
        }
        if is_input(word) {
            let e = self.value()?;
            let ExprKind::Path(path) = e.kind else { return None };
            return Some(Kind::Input(name, path));
        }
        let mut values = vec![self.value()?];
        while self.eat(",") {
            values.push(self.value()?);
        }
        Some(Kind::Apply(name, values))
    }
}

/// The most instructions behind a label that are copied to a jump.
const MOST_COPIED: usize = 50;
/// The most labels that are removed in this way.
const MOST_JOINED: usize = 100;

/// Copies the instructions behind a label to each jump that leads there, where the label stands
/// before an instruction that uses the result. Beremiz and OpenPLC carry a result across such a
/// label.
///
/// ```text
/// LD a / ADD 1 / JMP q / l: LD b / q: ST c   ->   LD a / ADD 1 / ST c / JMP end / l: LD b / ST c / end:
/// ```
fn joined(mut list: Vec<Instruction>) -> Vec<Instruction> {
    for _ in 0..MOST_JOINED {
        let Some(at) = list.windows(2).position(|w| matches!(w, [a, b] if meets(&a.kind, &b.kind))) else {
            break;
        };
        let (Some(label), Some(tail)) = (list.get(at).cloned(), list.get(at + 1..)) else { break };
        let Kind::Label(name) = &label.kind else { break };
        let plain = |i: &Instruction| !matches!(i.kind, Kind::Label(_) | Kind::Jump(..));
        let jumps = |i: &&Instruction| matches!(&i.kind, Kind::Jump(n, _) if n.text == name.text);
        let sure = list.iter().filter(jumps).all(|i| matches!(i.kind, Kind::Jump(_, When::Always)));
        if tail.len() > MOST_COPIED || !tail.iter().all(plain) || !sure {
            break;
        }
        // The blank makes sure that no label of the list has this name.
        let end = Name { text: format!("{} END", name.text).into(), at: name.at };
        let mut made = Vec::new();
        for (number, instruction) in list.iter().enumerate() {
            if jumps(&instruction) {
                made.extend(tail.iter().cloned());
                made.push(Instruction { kind: Kind::Jump(end.clone(), When::Always), at: instruction.at });
            } else if number != at {
                made.push(instruction.clone());
            }
        }
        made.push(Instruction { kind: Kind::Label(end), at: label.at });
        list = made;
    }
    list
}

/// True if the label stands before an instruction that uses the result.
fn meets(label: &Kind, next: &Kind) -> bool {
    let uses = matches!(
        next,
        Kind::Store { .. }
            | Kind::Latch { .. }
            | Kind::Operate { .. }
            | Kind::Complement
            | Kind::Apply(..)
            | Kind::Input(..)
            | Kind::Return(When::True | When::False)
            | Kind::Call(_, _, When::True | When::False)
    );
    matches!(label, Kind::Label(_)) && uses
}
