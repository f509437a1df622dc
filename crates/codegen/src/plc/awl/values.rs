//! The values of AWL: the result of logic (RLO) for what is Boolean, the first accumulator for numbers.
//!
//! A value that needs a jump, or more than two accumulators, or deeper brackets, is worked out before, into a
//! memory.

use std::collections::BTreeSet;
use std::fmt::Write;

use g7_model::{Nanos, Said, say};

use crate::plc::form::{Declared, Ex};
use crate::plc::variables::Variables;

/// Labels that four letters and digits have room for.
const LABELS: usize = 36 * 36 * 36;
/// Tables with more elements than this are refused, because an index is compared with each place in turn.
const LONG: u32 = 64;

/// The time of the one timer: not every system reads members of an instance within an instance.
pub(super) const NOW: &str = "NOW";

/// Brackets that stand in each other, of the seven that there is room for.
pub(super) const DEEP: usize = 5;

/// An operand, as it is written.
pub(super) fn variable(e: &Ex) -> String {
    match e {
        Ex::Var(name) if name.ends_with(".ET") => format!("#{NOW}"),
        Ex::Var(name) => format!("#{name}"),
        Ex::Index(name, index) => match **index {
            Ex::Int(n) => format!("#{name}[{n}]"),
            _ => String::new(),
        },
        _ => String::new(),
    }
}

/// A constant, where its type has room for it.
pub(super) fn constant(e: &Ex) -> Option<String> {
    match e {
        Ex::Bool(b) => Some(if *b { "TRUE" } else { "FALSE" }.to_owned()),
        Ex::Int(n) => i32::try_from(*n).ok().map(|n| format!("L#{n}")),
        Ex::Bits(_, word) => u32::try_from(*word).ok().map(|bits| format!("DW#16#{bits:X}")),
        Ex::Time(time) => time_text(*time),
        Ex::Real(x) => real_text(*x),
        _ => None,
    }
}

/// The refusal of a constant.
pub(super) fn no_room(e: &Ex) -> Said {
    let what = match e {
        Ex::Time(_) => say!("a TIME below a millisecond or above 24 days"),
        Ex::Real(_) => say!("a number beyond REAL"),
        _ => say!("a number of more than 32 bits"),
    };
    say!("{what} cannot be printed as AWL")
}

fn time_text(time: Nanos) -> Option<String> {
    let nanos = time.count();
    let millis = i32::try_from(nanos / 1_000_000).ok().filter(|_| nanos % 1_000_000 == 0)?;
    let sign = if millis < 0 { "-" } else { "" };
    let mut rest = millis.unsigned_abs();
    let mut parts = Vec::new();
    for (unit, size) in [("D", 86_400_000), ("H", 3_600_000), ("M", 60_000), ("S", 1_000), ("MS", 1)] {
        if rest >= size {
            parts.push(format!("{}{unit}", rest / size));
            rest %= size;
        }
    }
    let text = if parts.is_empty() { "0MS".to_owned() } else { parts.join("_") };
    Some(format!("T#{sign}{text}"))
}

/// As `1.500000e+000`.
fn real_text(x: f64) -> Option<String> {
    let narrow = x as f32;
    if !narrow.is_finite() {
        return None;
    }
    let text = format!("{narrow:e}");
    let (mantissa, exponent) = text.split_once('e')?;
    let point = if mantissa.contains('.') { "" } else { ".0" };
    let exponent: i32 = exponent.parse().ok()?;
    Some(format!("{mantissa}{point}e{exponent:+04}"))
}

/// A constant, or a variable that is read as it is.
fn is_leaf(e: &Ex) -> bool {
    match e {
        Ex::Index(_, index) => matches!(**index, Ex::Int(_)),
        e => matches!(e, Ex::Bool(_) | Ex::Int(_) | Ex::Bits(..) | Ex::Real(_) | Ex::Time(_) | Ex::Var(_)),
    }
}

fn is_comparison(sign: &str) -> bool {
    matches!(sign, "=" | "<>" | "<" | "<=" | ">" | ">=")
}

/// The type that a variable has there; none where its values have no room.
pub(super) fn type_of(ty: &str) -> Option<&'static str> {
    Some(match ty {
        "BOOL" => "BOOL",
        "SINT" | "USINT" | "INT" => "INT",
        "UINT" | "DINT" => "DINT",
        "REAL" => "REAL",
        "TIME" => "TIME",
        // The block of the system that is the timer of IEC 61131-3.
        "TON" => "SFB 4",
        _ => return None,
    })
}

/// The instructions so far, with the memories that values need.
pub(super) struct Values {
    variables: Variables,
    pub(super) out: String,
    labels: usize,
    cannot: BTreeSet<Said>,
}

impl Values {
    pub(super) fn new(variables: Vec<Declared>) -> Values {
        Values {
            variables: Variables::new(variables),
            out: String::new(),
            labels: 0,
            cannot: BTreeSet::new(),
        }
    }

    /// The instructions, all variables, and what cannot be said.
    pub(super) fn done(mut self) -> (String, Vec<Declared>, BTreeSet<Said>) {
        if self.labels > LABELS {
            self.cannot(say!("a chart that needs more than 46656 jumps"));
        }
        (self.out, self.variables.into_list(), self.cannot)
    }

    fn cannot(&mut self, what: Said) {
        self.cannot.insert(say!("{what} cannot be printed as AWL"));
    }

    pub(super) fn line(&mut self, text: &str) {
        let _ = writeln!(self.out, "      {text};");
    }

    /// A label: a letter and three letters or digits.
    pub(super) fn label(&mut self) -> String {
        let number = self.labels;
        self.labels += 1;
        let digit =
            |k: usize| char::from_digit((number / 36usize.pow(k as u32) % 36) as u32, 36).unwrap_or('0');
        ['L', digit(2), digit(1), digit(0)].iter().collect::<String>().to_ascii_uppercase()
    }

    pub(super) fn mark(&mut self, label: &str) {
        let _ = writeln!(self.out, "{label}: NOP 0;");
    }

    /// A value to an operand.
    pub(super) fn store(&mut self, e: &Ex, to: &str) {
        let whole = self.result(e);
        self.line(&format!("{} {to}", if whole { "T" } else { "=" }));
    }

    pub(super) fn elements(&mut self, name: &str) -> u32 {
        let n = self.variables.elements(name);
        if n > LONG {
            self.cannot(say!("an index into a table of more than 64 elements"));
        }
        n.min(LONG)
    }

    fn is_bool(&self, e: &Ex) -> bool {
        self.variables.type_name(e) == "BOOL"
    }

    fn is_real(&self, e: &Ex) -> bool {
        self.variables.type_name(e).ends_with("REAL")
    }

    /// A value as the result of logic, or in the accumulator; true for the latter.
    pub(super) fn result(&mut self, e: &Ex) -> bool {
        if self.is_bool(e) {
            self.logic(e);
            return false;
        }
        let e = self.ready(e, 0);
        self.number(&e);
        true
    }

    /// A Boolean value as the result of logic.
    pub(super) fn logic(&mut self, e: &Ex) {
        let e = self.ready(e, 0);
        if !self.list(&e) {
            self.contact(&e, 'A', false);
        }
    }

    /// The instructions of a condition that begins anew: a list of contacts, a constant or a comparison. False for
    /// another condition.
    fn list(&mut self, e: &Ex) -> bool {
        match e {
            Ex::And(list) => list.iter().for_each(|e| self.contact(e, 'A', false)),
            Ex::Or(list) => list.iter().for_each(|e| self.contact(e, 'O', false)),
            Ex::Xor(a, b) => {
                self.contact(a, 'X', false);
                self.contact(b, 'X', false);
            }
            Ex::Bool(b) => self.line(if *b { "SET" } else { "CLR" }),
            Ex::Op(sign, a, b) if is_comparison(sign) => self.comparison(sign, a, b),
            _ => return false,
        }
        true
    }

    /// A part of a list of logic.
    fn contact(&mut self, e: &Ex, by: char, negated: bool) {
        let not = if negated { "N" } else { "" };
        match e {
            Ex::Not(inner) => self.contact(inner, by, !negated),
            Ex::Var(_) | Ex::Index(..) => self.line(&format!("{by}{not} {}", variable(e))),
            e => {
                self.line(&format!("{by}{not}("));
                if !self.list(e) {
                    self.cannot(say!("this condition"));
                }
                self.line(")");
            }
        }
    }

    fn comparison(&mut self, sign: &str, a: &Ex, b: &Ex) {
        let ty = if self.is_real(a) || self.is_real(b) { 'R' } else { 'D' };
        let sign = if sign == "=" { "==" } else { sign };
        self.number(a);
        self.number(b);
        self.line(&format!("{sign}{ty}"));
    }

    /// A number in the first accumulator; what was there is in the second if this is a leaf.
    fn number(&mut self, e: &Ex) {
        match e {
            Ex::Var(_) | Ex::Index(..) => {
                self.line(&format!("L {}", variable(e)));
                if type_of(self.variables.type_name(e)) == Some("INT") {
                    self.line("ITD");
                }
            }
            Ex::Op(sign, a, b) => {
                self.number(a);
                self.number(b);
                match (*sign, self.is_real(e)) {
                    ("MOD", false) => self.line("MOD"),
                    ("+" | "-" | "*" | "/", real) => {
                        self.line(&format!("{sign}{}", if real { 'R' } else { 'D' }))
                    }
                    _ => self.cannot(say!("the operator {} of these types", Said::foreign(*sign))),
                }
            }
            Ex::Neg(inner) => {
                self.number(inner);
                self.line(if self.is_real(inner) { "NEGR" } else { "NEGD" });
            }
            e => match constant(e) {
                Some(text) => self.line(&format!("L {text}")),
                None => drop(self.cannot.insert(no_room(e))),
            },
        }
    }

    /// A value in a memory of its own; its name.
    pub(super) fn kept(&mut self, e: &Ex) -> String {
        let ty = match () {
            () if self.is_bool(e) => "BOOL",
            () if self.is_real(e) => "REAL",
            () if self.variables.type_name(e) == "TIME" => "TIME",
            () => "DINT",
        };
        let name = self.variables.memory(ty);
        self.store(e, &format!("#{name}"));
        name
    }

    fn leaf(&mut self, e: &Ex) -> Ex {
        if is_leaf(e) { e.clone() } else { Ex::Var(self.kept(e)) }
    }

    /// The expression with memories for all that [`Values::number`] and [`Values::contact`] cannot say;
    /// these are worked out here.
    fn ready(&mut self, e: &Ex, depth: usize) -> Ex {
        if depth > DEEP && !is_leaf(e) && !matches!(e, Ex::Not(_)) && self.is_bool(e) {
            return Ex::Var(self.kept(e));
        }
        match e {
            Ex::And(list) => Ex::And(list.iter().map(|e| self.ready(e, depth + 1)).collect()),
            Ex::Or(list) => Ex::Or(list.iter().map(|e| self.ready(e, depth + 1)).collect()),
            Ex::Xor(a, b) => Ex::Xor(Box::new(self.ready(a, depth + 1)), Box::new(self.ready(b, depth + 1))),
            Ex::Not(inner) => Ex::Not(Box::new(self.ready(inner, depth))),
            Ex::Neg(inner) => Ex::Neg(Box::new(self.ready(inner, depth))),
            Ex::Op(sign, a, b) if is_comparison(sign) && (self.is_bool(a) || self.is_bool(b)) => {
                match *sign {
                    "=" => self.ready(&(**a).clone().xor((**b).clone()).not(), depth),
                    "<>" => self.ready(&(**a).clone().xor((**b).clone()), depth),
                    _ => {
                        self.cannot(say!("an order of BOOL values"));
                        Ex::Bool(false)
                    }
                }
            }
            Ex::Op(sign, a, b) => {
                if self.is_real(a) != self.is_real(b) {
                    self.cannot(say!("a REAL beside a whole number or a TIME"));
                }
                let b = self.leaf(b);
                let a = self.ready(a, depth);
                Ex::Op(sign, Box::new(a), Box::new(b))
            }
            Ex::Index(name, index) if !is_leaf(e) => Ex::Var(self.element(name, index)),
            Ex::Call(name, args) => self.function(name, args, e),
            plain => plain.clone(),
        }
    }

    /// Copies an element into a memory. The index is compared with each place in turn.
    fn element(&mut self, name: &str, index: &Ex) -> String {
        let index = Ex::Var(self.kept(index));
        let ty = self.variables.type_of(name).to_owned();
        let to = self.variables.memory(&ty);
        let list = (0..self.elements(name)).map(|k| {
            let of = Ex::Index(name.to_owned(), Box::new(Ex::Int(k.into())));
            (Ex::op("=", index.clone(), Ex::Int(k.into())), of)
        });
        self.choose(list.collect(), None, &to);
        to
    }

    /// To a memory the value of the first condition that holds, else another.
    fn choose(&mut self, list: Vec<(Ex, Ex)>, other: Option<&Ex>, to: &str) {
        let end = self.label();
        for (c, value) in list {
            let next = self.label();
            self.logic(&c);
            self.line(&format!("JCN {next}"));
            self.store(&value, &format!("#{to}"));
            self.line(&format!("JU {end}"));
            self.mark(&next);
        }
        if let Some(other) = other {
            self.store(other, &format!("#{to}"));
        }
        self.mark(&end);
    }

    fn function(&mut self, name: &str, args: &[Ex], e: &Ex) -> Ex {
        let args: Vec<Ex> = args.iter().map(|a| self.leaf(a)).collect();
        if let ("ABS", [x]) = (name, args.as_slice()) {
            if self.is_real(x) {
                return self.stored(x, &["ABS"], "REAL");
            }
            let negative = Ex::op("<", x.clone(), Ex::Int(0));
            let to = self.memory_for(e);
            self.choose(vec![(negative, Ex::Neg(Box::new(x.clone())))], Some(x), &to);
            return Ex::Var(to);
        }
        match (name, args.as_slice()) {
            ("SEL", [c, no, yes]) => {
                let to = self.memory_for(e);
                self.choose(vec![(c.clone(), yes.clone())], Some(no), &to);
                Ex::Var(to)
            }
            ("MUX", [k, list @ ..]) => {
                let Some((last, list)) = list.split_last() else { return Ex::Bool(false) };
                let to = self.memory_for(e);
                let at = |i: i128| Ex::op("=", k.clone(), Ex::Int(i));
                self.choose((0..).zip(list).map(|(i, x)| (at(i), x.clone())).collect(), Some(last), &to);
                Ex::Var(to)
            }
            ("MIN" | "MAX", [first, rest @ ..]) => {
                let to = self.memory_for(e);
                self.store(first, &format!("#{to}"));
                let sign = if name == "MIN" { "<" } else { ">" };
                for x in rest {
                    let better = Ex::op(sign, x.clone(), Ex::var(&*to));
                    self.choose(vec![(better, x.clone())], None, &to);
                }
                Ex::Var(to)
            }
            ("LIMIT", [low, x, high]) => {
                let least = Ex::call("MAX", vec![x.clone(), low.clone()]);
                let both = Ex::call("MIN", vec![least, high.clone()]);
                self.ready(&both, 0)
            }
            ("TRUNC", [x]) => self.stored(x, &["TRUNC"], "DINT"),
            ("SQRT" | "LN" | "EXP" | "SIN" | "COS" | "TAN" | "ASIN" | "ACOS" | "ATAN", [x]) => {
                self.stored(x, &[name], "REAL")
            }
            (_, [x]) => match name.split_once("_TO_") {
                Some((from, to)) => self.converted(x, from, to),
                None => self.no_function(name),
            },
            _ => self.no_function(name),
        }
    }

    fn no_function(&mut self, name: &str) -> Ex {
        self.cannot(say!("the function {}", Said::foreign(name)));
        Ex::Bool(false)
    }

    fn memory_for(&mut self, e: &Ex) -> String {
        let ty = match self.variables.type_name(e) {
            ty @ ("BOOL" | "TIME") => ty.to_owned(),
            ty if ty.ends_with("REAL") => "REAL".to_owned(),
            _ => "DINT".to_owned(),
        };
        self.variables.memory(&ty)
    }

    /// A number with some operations, in a memory.
    fn stored(&mut self, x: &Ex, operations: &[&str], ty: &str) -> Ex {
        let to = self.variables.memory(ty);
        self.number(x);
        operations.iter().for_each(|o| self.line(o));
        self.line(&format!("T #{to}"));
        Ex::Var(to)
    }

    /// A conversion. Whole numbers that are narrowed keep their low bits, as in a run.
    fn converted(&mut self, x: &Ex, from: &str, to: &str) -> Ex {
        let bits = |ty: &str| match ty {
            "SINT" | "USINT" => Some(8),
            "INT" | "UINT" => Some(16),
            "DINT" | "LINT" => Some(32),
            _ => None,
        };
        match (from, to) {
            ("BOOL", _) if bits(to).is_some() => {
                let name = self.variables.memory("DINT");
                self.choose(vec![(x.clone(), Ex::Int(1))], Some(&Ex::Int(0)), &name);
                Ex::Var(name)
            }
            ("REAL", "DINT" | "LINT") => self.stored(x, &["RND"], "DINT"),
            (_, "REAL") if bits(from).is_some() => self.stored(x, &["DTR"], "REAL"),
            _ => match (bits(from), bits(to)) {
                (Some(_), Some(32)) => x.clone(),
                (Some(_), Some(_)) => match to {
                    "USINT" => self.stored(x, &["AD DW#16#FF"], "DINT"),
                    "UINT" => self.stored(x, &["AD DW#16#FFFF"], "DINT"),
                    "SINT" => self.stored(x, &["SLD 24", "SSD 24"], "DINT"),
                    _ => self.stored(x, &["SLD 16", "SSD 16"], "DINT"),
                },
                _ => self.no_function(&format!("{from}_TO_{to}")),
            },
        }
    }
}
