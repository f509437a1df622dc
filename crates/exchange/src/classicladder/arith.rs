//! Expressions of compare and operate boxes: `@200/1@:=@200/1@+1`, `@220/9@>5`.
//!
//! ClassicLadder evaluates them without blanks, from left to right: `!` and brackets, then `* / %`,
//! `+ -`, `&`, `^`, `|`. All values are signed 32-bit numbers.

use std::collections::BTreeSet;
use std::ops::Range;

use g7_model::{BinaryOp, Expr, Said, Stmt, codes, say};

use super::project::Key;
use super::tables::table_name;
use super::variables::{self, Vars, kind};
use g7_iec::nodes::{self, binary, call, int};
use g7_iec::report::Report;

/// The longest expression; ClassicLadder itself has 50 characters.
const MOST_BYTES: usize = 1000;
/// The deepest nesting of brackets.
const DEEPEST: usize = 40;

/// Functions that a project needs and the language lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Helper {
    And,
    Or,
    Xor,
    Power,
}

/// Parses one expression.
pub(super) struct Arith<'a, 'b, 'c> {
    pub(super) vars: &'a mut Vars<'b>,
    pub(super) helpers: &'a mut BTreeSet<Helper>,
    pub(super) report: &'c mut Report,
    text: &'a str,
    /// The place of the text in the file.
    start: usize,
    at: usize,
    depth: usize,
}

/// A variable by its number, or by a number and the value of another variable.
enum Named {
    One(Key),
    At(Key, Key),
}

/// The expression cannot be read or carried over; a problem has been reported.
struct Stop;

type Read = Result<Expr, Stop>;

impl<'a, 'b, 'c> Arith<'a, 'b, 'c> {
    pub(super) fn new(
        text: &'a str,
        place: &Range<usize>,
        vars: &'a mut Vars<'b>,
        helpers: &'a mut BTreeSet<Helper>,
        report: &'c mut Report,
    ) -> Self {
        Arith { vars, helpers, report, text, start: place.start, at: 0, depth: 0 }
    }

    /// A comparison, used as a condition.
    pub(super) fn compare(&mut self) -> Option<Expr> {
        self.fits().ok()?;
        let at = self.whole();
        let Some(found) = self.text.find(['<', '>', '=']) else {
            self.say(&codes::BAD_TEXT, at, say!("a comparison without `<`, `>` or `=`"));
            return None;
        };
        let rest = self.text.get(found..).unwrap_or("");
        let mut chars = rest.chars();
        let (first, second) = (chars.next().unwrap_or('='), chars.next());
        // ClassicLadder looks at the second character only if it is `=` or `>`.
        let (op, len) = match (first, second) {
            ('>', Some('=')) => (BinaryOp::Ge, 2),
            ('<', Some('=')) => (BinaryOp::Le, 2),
            ('<', Some('>')) => (BinaryOp::Ne, 2),
            ('=', Some('=' | '>')) => (BinaryOp::Eq, 2),
            ('>', Some('>')) => (BinaryOp::Gt, 2),
            ('>', _) => (BinaryOp::Gt, 1),
            ('<', _) => (BinaryOp::Lt, 1),
            _ => (BinaryOp::Eq, 1),
        };
        if rest.starts_with("=>") {
            let place = self.start + found..self.start + found + 2;
            self.report.say(
                &codes::DIFFERENT,
                &place,
                say!("`=>` is read as `=`, as ClassicLadder reads it"),
            );
        }
        let (whole, span) = (self.text, self.report.span(&self.whole()));
        self.text = whole.get(..found).unwrap_or("");
        let left = self.all().ok();
        self.text = whole;
        self.at = found + len;
        let right = self.all().ok();
        Some(binary(op, left?, right?, span))
    }

    /// An assignment, with the names that it may write.
    pub(super) fn operate(&mut self) -> Option<(Stmt, Vec<String>)> {
        self.fits().ok()?;
        let span = self.report.span(&self.whole());
        let start = self.at;
        let target = self.variable().ok()?;
        let place = self.start + start..self.start + self.at;
        let rest = self.text.get(self.at..).unwrap_or("");
        let blank = |n: &usize| rest.get(..*n).is_some_and(|s| s.chars().all(|c| ": ".contains(c)));
        let Some(skip) = rest.find('=').filter(blank) else {
            self.say(&codes::BAD_TEXT, self.whole(), say!("an operation without `:=`"));
            return None;
        };
        self.at += skip + 1;
        while self.peek() == Some(b' ') {
            self.at += 1;
        }
        let value = self.all();
        let (Named::One(key) | Named::At(key, _)) = target;
        let truth = |value: Expr| {
            if key.0 < kind::FIRST_WORD { binary(BinaryOp::Ne, value, int(0, span), span) } else { value }
        };
        match target {
            Named::One(key) => {
                let target = self.vars.target(key, &place, self.report)?;
                let mut names = BTreeSet::new();
                variables::reads(&target, &mut names);
                names.extend(table_name(key.0));
                Some((nodes::assign(target, truth(value.ok()?), span), names.into_iter().collect()))
            }
            Named::At(key, index) => {
                let value = truth(value.ok()?);
                self.vars.indexed_target(key, index, &value, &place, self.report)
            }
        }
    }

    fn whole(&self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }

    fn fits(&mut self) -> Result<(), Stop> {
        if self.text.len() > MOST_BYTES {
            let what = say!("an expression of {} bytes; at most {MOST_BYTES} are read", self.text.len());
            return Err(self.say(&codes::TOO_LARGE, self.whole(), what));
        }
        Ok(())
    }

    fn say(&mut self, code: &'static g7_model::codes::Code, at: Range<usize>, what: Said) -> Stop {
        self.report.say(code, &at, what);
        Stop
    }

    fn fault(&mut self, what: Said) -> Stop {
        let here = self.start + self.at;
        let end = (here + 1).min(self.start + self.text.len());
        self.say(&codes::BAD_TEXT, here..end.max(here), what)
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    /// A whole expression, up to the end of the text.
    fn all(&mut self) -> Read {
        let e = self.bits(0)?;
        if self.at < self.text.len() {
            return Err(self.fault(say!("something that is no part of an expression")));
        }
        Ok(e)
    }

    /// `|`, `^`, `&`, from the weakest to the strongest binding.
    fn bits(&mut self, level: usize) -> Read {
        let (sign, name, helper) = match level {
            0 => (b'|', "BITS_OR", Helper::Or),
            1 => (b'^', "BITS_XOR", Helper::Xor),
            2 => (b'&', "BITS_AND", Helper::And),
            _ => return self.sum(),
        };
        let start = self.at;
        let mut left = self.bits(level + 1)?;
        while self.take(sign) {
            let right = self.bits(level + 1)?;
            let span = self.span(start);
            // Any word XOR itself is zero; projects write zero in this way.
            left = if helper == Helper::Xor && left == right {
                int(0, span)
            } else {
                self.helpers.insert(helper);
                call(name, vec![left, right], span)
            };
        }
        Ok(left)
    }

    fn span(&self, start: usize) -> g7_model::Span {
        self.report.span(&(self.start + start..self.start + self.at))
    }

    fn sum(&mut self) -> Read {
        let start = self.at;
        let mut left = self.product()?;
        loop {
            let op = match self.peek() {
                Some(b'+') => BinaryOp::Add,
                Some(b'-') => BinaryOp::Sub,
                _ => return Ok(left),
            };
            self.at += 1;
            let right = self.product()?;
            left = binary(op, left, right, self.span(start));
        }
    }

    fn product(&mut self) -> Read {
        let start = self.at;
        let mut left = self.term()?;
        loop {
            let op = match self.peek() {
                Some(b'*') => BinaryOp::Mul,
                Some(b'/') => BinaryOp::Div,
                Some(b'%') => BinaryOp::Mod,
                _ => return Ok(left),
            };
            self.at += 1;
            let right = self.term()?;
            left = binary(op, left, right, self.span(start));
        }
    }

    fn term(&mut self) -> Read {
        let start = self.at;
        match self.peek() {
            Some(b'(') => {
                self.depth += 1;
                if self.depth > DEEPEST {
                    return Err(self.fault(say!("brackets nested too deeply")));
                }
                self.at += 1;
                let e = self.bits(0)?;
                self.depth -= 1;
                if !self.take(b')') {
                    return Err(self.fault(say!("a bracket that is not closed")));
                }
                Ok(e)
            }
            Some(b'!') => {
                self.at += 1;
                self.depth += 1;
                if self.depth > DEEPEST {
                    return Err(self.fault(say!("nested too deeply")));
                }
                let e = self.term()?;
                self.depth -= 1;
                let span = self.span(start);
                Ok(call("BOOL_TO_DINT", vec![binary(BinaryOp::Eq, e, int(0, span), span)], span))
            }
            Some(b'A'..=b'Z') => self.function(),
            _ => self.operand(),
        }
    }

    /// A variable or a constant.
    fn operand(&mut self) -> Read {
        let start = self.at;
        match self.peek() {
            Some(b'@') => {
                let variable = self.variable()?;
                let place = self.start + start..self.start + self.at;
                let span = self.report.span(&place);
                Ok(match variable {
                    Named::One(key) => self.vars.number(key, &place, self.report),
                    Named::At(key, index) => {
                        let value = self.vars.indexed(key, index, &place, self.report);
                        if key.0 < kind::FIRST_WORD { call("BOOL_TO_DINT", vec![value], span) } else { value }
                    }
                })
            }
            Some(b'0'..=b'9' | b'-' | b'$' | b'\'') => self.constant(),
            _ => Err(self.fault(say!("a variable, number or function is missing"))),
        }
    }

    fn constant(&mut self) -> Read {
        let start = self.at;
        let negative = self.take(b'-');
        let (radix, text) = if self.take(b'$') {
            (16, self.run(|b| b.is_ascii_hexdigit()))
        } else if self.take(b'\'') {
            let text = self.run(|b| b != b'\'');
            if !self.take(b'\'') {
                return Err(self.fault(say!("a character that is not closed")));
            }
            let value = text.bytes().try_fold(0i128, |v, b| (v < 1 << 40).then(|| v * 256 + i128::from(b)));
            return self.in_range(value, negative, start);
        } else {
            (10, self.run(|b| b.is_ascii_digit()))
        };
        self.in_range(i128::from_str_radix(text, radix).ok(), negative, start)
    }

    /// A 32-bit number; the upper half of the range is negative.
    fn in_range(&mut self, value: Option<i128>, negative: bool, start: usize) -> Read {
        let span = self.span(start);
        match value.filter(|v| *v < 1 << 32) {
            Some(value) => {
                let value = if value >= 1 << 31 { value - (1 << 32) } else { value };
                Ok(int(if negative { -value } else { value }, span))
            }
            None => Err(self.fault(say!("a number that does not fit into 32 bits"))),
        }
    }

    fn run(&mut self, fits: impl Fn(u8) -> bool) -> &'a str {
        let start = self.at;
        while self.peek().is_some_and(&fits) {
            self.at += 1;
        }
        self.text.get(start..self.at).unwrap_or("")
    }

    /// `@200/3@`, or with an index `@200/3[200/4]@`.
    fn variable(&mut self) -> Result<Named, Stop> {
        if !self.take(b'@') {
            return Err(self.fault(say!("a variable is missing")));
        }
        let key = self.key()?;
        let index = if self.take(b'[') { Some(self.key()?) } else { None };
        if index.is_some() {
            self.take(b']');
        }
        if !self.take(b'@') {
            return Err(self.fault(say!("a variable that is not closed")));
        }
        Ok(index.map_or(Named::One(key), |index| Named::At(key, index)))
    }

    /// `200/3`.
    fn key(&mut self) -> Result<Key, Stop> {
        let kind = self.run(|b| b.is_ascii_digit()).parse();
        let slash = self.take(b'/');
        let number = self.run(|b| b.is_ascii_digit()).parse();
        match (kind, slash, number) {
            (Ok(kind), true, Ok(number)) => Ok((kind, number)),
            _ => Err(self.fault(say!("a variable that cannot be read"))),
        }
    }

    fn function(&mut self) -> Read {
        let start = self.at;
        let name = self.run(|b| b.is_ascii_uppercase());
        if !self.take(b'(') {
            return Err(self.fault(say!("a function without brackets")));
        }
        let mut args = vec![self.operand()?];
        while self.take(b',') {
            args.push(self.operand()?);
        }
        if !self.take(b')') {
            return Err(self.fault(say!("a bracket that is not closed")));
        }
        let span = self.span(start);
        let count = args.len();
        Ok(match (name, count) {
            ("ABS", 1) => call("ABS", args, span),
            ("MINI" | "MAXI", 1) | ("MOY" | "AVG", 1) => args.remove(0),
            ("MINI", _) => call("MIN", args, span),
            ("MAXI", _) => call("MAX", args, span),
            ("MOY" | "AVG", _) => {
                let sum = args.into_iter().reduce(|a, b| binary(BinaryOp::Add, a, b, span));
                let sum = sum.unwrap_or_else(|| int(0, span));
                binary(BinaryOp::Div, sum, int(i128::try_from(count).unwrap_or(1), span), span)
            }
            ("POW", 2) => {
                self.helpers.insert(Helper::Power);
                call("POWER", args, span)
            }
            _ => {
                let what = say!("the function `{name}` with {count} values has no counterpart");
                return Err(self.say(
                    &codes::UNKNOWN_FUNCTION,
                    self.start + start..self.start + self.at,
                    what,
                ));
            }
        })
    }
}
