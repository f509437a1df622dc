//! Parses JGrafchart's action language into a tree: `S v = e;`, `N out;`, conditions.
//!
//! The precedence is that of Java: `?:`, `|`, `&`, equality, comparison, sum, product, then the
//! signs before an operand (`!`, `-`, `/` for a rising and `\` for a falling edge).

use g7_model::{Said, say};
use std::ops::Range;

use super::lex::{Kind, Token, tokens};

/// The deepest nesting of brackets and signs.
const DEEPEST: u16 = 100;
/// The greatest height of a tree, for chains like `a | b | c`; functions on the tree recurse that
/// deep.
const TALLEST: u16 = 400;

/// An expression with its place in the text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Phrase {
    pub(super) kind: PhraseKind,
    pub(super) at: Range<usize>,
    depth: u16,
}

/// The forms of an expression.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum PhraseKind {
    Int(i64),
    Real(f64),
    Str(String),
    Name(Vec<String>),
    Unary(Unary, Box<Phrase>),
    Binary(Binary, Box<Phrase>, Box<Phrase>),
    /// `c ? a : b`.
    Choice(Box<Phrase>, Box<Phrase>, Box<Phrase>),
    /// A function or method call. Its arguments are parsed and dropped.
    Call(Vec<String>),
}

/// Signs before an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unary {
    Not,
    Minus,
    Rise,
    Fall,
}

/// Signs between operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binary {
    Or,
    And,
    Eq,
    Ne,
    Lt,
    Gt,
    Le,
    Ge,
    Add,
    Sub,
    Mul,
    Div,
    Mod,
}

/// The letter of an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Letter {
    /// On activation.
    S,
    /// Each scan.
    P,
    /// On deactivation.
    X,
    /// While active.
    N,
    /// On deactivation by an exception transition.
    A,
}

/// One action of a step.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Statement {
    pub(super) letter: Letter,
    pub(super) deed: Deed,
    pub(super) at: Range<usize>,
}

/// The effect of an action.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Deed {
    /// `v = e`.
    Assign { target: (Vec<String>, Range<usize>), value: Phrase },
    /// `N out`.
    Level(Vec<String>, Range<usize>),
    /// `f(…)`, `object.method(…)`.
    Call(Vec<String>, Range<usize>),
}

/// The reason why a text cannot be read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    pub(super) at: Range<usize>,
    pub(super) what: Said,
}

/// Parses a condition: one expression and nothing behind it (a `;` is allowed).
pub(super) fn condition(text: &str) -> Result<Phrase, Fault> {
    let tokens = tokens(text);
    let mut reader = Reader { tokens: &tokens, next: 0, depth: 0 };
    let phrase = reader.expression()?;
    while reader.take(";") {}
    match reader.peek().kind {
        Kind::End => Ok(phrase),
        _ => Err(reader.fault(say!("the end of the condition"))),
    }
}

/// Parses the actions of a step. After one that cannot be read, continues behind the next `;`.
pub(super) fn actions(text: &str, most: usize) -> (Vec<Statement>, Vec<Fault>) {
    let tokens = tokens(text);
    let mut reader = Reader { tokens: &tokens, next: 0, depth: 0 };
    let (mut list, mut faults) = (Vec::new(), Vec::new());
    loop {
        while reader.take(";") {}
        if reader.peek().kind == Kind::End || list.len() + faults.len() > most {
            return (list, faults);
        }
        let start = reader.next;
        match reader.statement() {
            Ok(statement) => list.push(statement),
            Err(fault) => {
                faults.push(fault);
                reader.next += usize::from(reader.next == start);
                reader.recover();
            }
        }
    }
}

struct Reader<'t> {
    tokens: &'t [Token],
    next: usize,
    depth: u16,
}

static END: Token = Token { kind: Kind::End, at: 0..0, fresh: false };

impl Reader<'_> {
    fn peek(&self) -> &Token {
        self.tokens.get(self.next).or(self.tokens.last()).unwrap_or(&END)
    }

    fn sign(&self) -> &str {
        match &self.peek().kind {
            Kind::Sign(sign) => sign,
            _ => "",
        }
    }

    fn take(&mut self, sign: &str) -> bool {
        let found = self.sign() == sign;
        self.next += usize::from(found);
        found
    }

    fn need(&mut self, sign: &str) -> Result<(), Fault> {
        if self.take(sign) { Ok(()) } else { Err(self.fault(say!("`{sign}`"))) }
    }

    fn fault(&self, wanted: Said) -> Fault {
        let token = self.peek();
        let found = match &token.kind {
            Kind::Name(name) => say!("`{name}`"),
            Kind::Int(n) => say!("`{n}`"),
            Kind::Real(n) => say!("`{n}`"),
            Kind::Str(_) => say!("a text"),
            Kind::Sign(sign) => say!("`{sign}`"),
            Kind::Unclosed => say!("a text without its closing quote"),
            Kind::Huge => say!("a number that is too large"),
            Kind::Odd(c) => say!("`{}`", c.escape_default()),
            Kind::End => say!("the end"),
        };
        Fault { at: token.at.clone(), what: say!("{wanted} was expected, not {found}") }
    }

    /// Skips to the next `;`, or to the next line that begins with a letter.
    fn recover(&mut self) {
        while self.peek().kind != Kind::End && self.sign() != ";" && self.letter_ahead().is_none() {
            self.next += 1;
        }
    }

    /// The letter of a new action, if one begins here at the start of a line.
    fn letter_ahead(&self) -> Option<Letter> {
        if self.peek().fresh { self.letter() } else { None }
    }

    fn letter(&self) -> Option<Letter> {
        let Kind::Name(name) = &self.peek().kind else { return None };
        let letter = match name.as_str() {
            "S" => Letter::S,
            "P" => Letter::P,
            "X" => Letter::X,
            "N" => Letter::N,
            "A" => Letter::A,
            _ => return None,
        };
        // `S = 1` assigns to a variable `S`.
        let behind = self.tokens.get(self.next + 1).map(|t| &t.kind);
        matches!(behind, Some(Kind::Name(_))).then_some(letter)
    }

    fn statement(&mut self) -> Result<Statement, Fault> {
        let start = self.peek().at.start;
        let Some(letter) = self.letter() else {
            let lone =
                matches!(&self.peek().kind, Kind::Name(n) if matches!(&**n, "S" | "P" | "X" | "N" | "A"));
            self.next += usize::from(lone);
            let wanted =
                if lone { say!("a name") } else { say!("`S`, `P`, `X`, `N` or `A` and then a name") };
            return Err(self.fault(wanted));
        };
        self.next += 1;
        let target = self.name()?;
        let deed = if self.take("=") {
            Deed::Assign { target, value: self.expression()? }
        } else if self.sign() == "(" {
            self.arguments()?;
            Deed::Call(target.0, target.1)
        } else if letter == Letter::N {
            Deed::Level(target.0, target.1)
        } else {
            return Err(self.fault(say!("`=`")));
        };
        let at = start..self.end();
        let done = self.sign() == ";" || self.peek().kind == Kind::End || self.letter_ahead().is_some();
        if done { Ok(Statement { letter, deed, at }) } else { Err(self.fault(say!("`;`"))) }
    }

    /// The end of the previous token.
    fn end(&self) -> usize {
        self.next.checked_sub(1).and_then(|i| self.tokens.get(i)).map_or(0, |t| t.at.end)
    }

    fn name(&mut self) -> Result<(Vec<String>, Range<usize>), Fault> {
        let start = self.peek().at.start;
        let mut names = Vec::new();
        loop {
            let Kind::Name(name) = &self.peek().kind else { return Err(self.fault(say!("a name"))) };
            names.push(name.clone());
            self.next += 1;
            if !self.take(".") {
                return Ok((names, start..self.end()));
            }
            if names.len() >= usize::from(DEEPEST) {
                return Err(self.fault(say!("a shorter name")));
            }
        }
    }

    fn arguments(&mut self) -> Result<(), Fault> {
        self.need("(")?;
        if self.take(")") {
            return Ok(());
        }
        loop {
            self.expression()?;
            if !self.take(",") {
                return self.need(")");
            }
        }
    }

    fn expression(&mut self) -> Result<Phrase, Fault> {
        if self.depth >= DEEPEST {
            return Err(self.too_deep());
        }
        self.depth += 1;
        let result = self.choice();
        self.depth -= 1;
        result
    }

    fn too_deep(&self) -> Fault {
        let what = say!("the expression is nested too deeply or chained too long");
        Fault { at: self.peek().at.clone(), what }
    }

    fn choice(&mut self) -> Result<Phrase, Fault> {
        let condition = self.binary(0)?;
        if !self.take("?") {
            return Ok(condition);
        }
        let yes = self.expression()?;
        self.need(":")?;
        let no = self.expression()?;
        let at = condition.at.start..no.at.end;
        let depth = condition.depth.max(yes.depth).max(no.depth);
        self.node(PhraseKind::Choice(condition.into(), yes.into(), no.into()), at, depth)
    }

    /// A node, one higher than its parts.
    fn node(&self, kind: PhraseKind, at: Range<usize>, parts: u16) -> Result<Phrase, Fault> {
        if parts >= TALLEST { Err(self.too_deep()) } else { Ok(Phrase { kind, at, depth: parts + 1 }) }
    }

    /// Parses operands joined by operators that bind at least as strongly as `least`.
    fn binary(&mut self, least: u8) -> Result<Phrase, Fault> {
        let mut left = self.unary()?;
        while let Some((operator, strength)) = operator(self.sign()) {
            if strength < least {
                break;
            }
            self.next += 1;
            let right = self.binary(strength + 1)?;
            let at = left.at.start..right.at.end;
            let depth = left.depth.max(right.depth);
            left = self.node(PhraseKind::Binary(operator, left.into(), right.into()), at, depth)?;
        }
        Ok(left)
    }

    fn unary(&mut self) -> Result<Phrase, Fault> {
        let start = self.peek().at.start;
        let operator = match self.sign() {
            "!" => Unary::Not,
            "-" => Unary::Minus,
            "/" => Unary::Rise,
            "\\" => Unary::Fall,
            _ => return self.primary(),
        };
        self.next += 1;
        if self.depth >= DEEPEST {
            return Err(self.too_deep());
        }
        self.depth += 1;
        let operand = self.unary();
        self.depth -= 1;
        let operand = operand?;
        let (at, depth) = (start..operand.at.end, operand.depth);
        self.node(PhraseKind::Unary(operator, operand.into()), at, depth)
    }

    fn primary(&mut self) -> Result<Phrase, Fault> {
        let token = self.peek().clone();
        let kind = match token.kind {
            Kind::Int(n) => PhraseKind::Int(n),
            Kind::Real(n) => PhraseKind::Real(n),
            Kind::Str(text) => PhraseKind::Str(text),
            // The letter of the next action follows, so this one has no end.
            Kind::Name(_) if self.letter_ahead().is_some() => {
                return Err(self.fault(say!("a name, a number or `(`")));
            }
            Kind::Name(_) => {
                let (names, at) = self.name()?;
                if self.sign() == "(" {
                    self.arguments()?;
                    return self.node(PhraseKind::Call(names), at.start..self.end(), 0);
                }
                return self.node(PhraseKind::Name(names), at, 0);
            }
            Kind::Sign("(") => {
                self.next += 1;
                let mut inner = self.expression()?;
                self.need(")")?;
                inner.at = token.at.start..self.end();
                return Ok(inner);
            }
            _ => return Err(self.fault(say!("a name, a number or `(`"))),
        };
        self.next += 1;
        self.node(kind, token.at, 0)
    }
}

/// The operator of a sign, and its binding strength.
fn operator(sign: &str) -> Option<(Binary, u8)> {
    Some(match sign {
        "|" => (Binary::Or, 1),
        "&" => (Binary::And, 2),
        "==" => (Binary::Eq, 3),
        "!=" => (Binary::Ne, 3),
        "<" => (Binary::Lt, 4),
        ">" => (Binary::Gt, 4),
        "<=" => (Binary::Le, 4),
        ">=" => (Binary::Ge, 4),
        "+" => (Binary::Add, 5),
        "-" => (Binary::Sub, 5),
        "*" => (Binary::Mul, 6),
        "/" => (Binary::Div, 6),
        "%" => (Binary::Mod, 6),
        _ => return None,
    })
}

/// A parameter of the call of a procedure.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Parameter {
    /// True for `R`: the name stands for another variable. False for `V`: it takes a value.
    pub(super) by_reference: bool,
    pub(super) name: String,
    pub(super) value: Phrase,
    pub(super) at: Range<usize>,
}

/// Parses the parameters of a call, `V x = e; R y = z;`, with the faults in them.
pub(super) fn parameters(text: &str) -> (Vec<Parameter>, Vec<Fault>) {
    let tokens = tokens(text);
    let mut reader = Reader { tokens: &tokens, next: 0, depth: 0 };
    let (mut list, mut faults) = (Vec::new(), Vec::new());
    loop {
        while reader.take(";") {}
        if reader.peek().kind == Kind::End {
            return (list, faults);
        }
        match reader.parameter() {
            Ok(parameter) => list.push(parameter),
            Err(fault) => {
                faults.push(fault);
                reader.next += 1;
                while reader.peek().kind != Kind::End && reader.sign() != ";" {
                    reader.next += 1;
                }
            }
        }
    }
}

impl Reader<'_> {
    fn parameter(&mut self) -> Result<Parameter, Fault> {
        let start = self.peek().at.start;
        let by_reference = match &self.peek().kind {
            Kind::Name(letter) if letter == "V" => false,
            Kind::Name(letter) if letter == "R" => true,
            _ => return Err(self.fault(say!("`V` or `R` and then a name"))),
        };
        self.next += 1;
        let Kind::Name(name) = self.peek().kind.clone() else { return Err(self.fault(say!("a name"))) };
        self.next += 1;
        self.need("=")?;
        let value = self.expression()?;
        if self.sign() != ";" && self.peek().kind != Kind::End {
            return Err(self.fault(say!("`;`")));
        }
        Ok(Parameter { by_reference, name, value, at: start..self.end() })
    }
}
