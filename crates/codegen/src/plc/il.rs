//! The equations as Instruction List.
//!
//! Invariants: brackets hold contacts only, a loop has its one jump back at
//! its end, and members of blocks stand behind LD and ST alone. Not every
//! compiler takes more, and `iec::il` reads no more back.

use std::fmt::Write;

use super::form::{Block, Ex, St};
use super::st::{FAULT_COMES, declarations, expression, plain};
use super::variables::Variables;

/// The whole function block; steps are set and reset by S and R, or by equations.
pub(crate) fn print(e: &Block, set_reset: bool) -> String {
    let mut p = Printer {
        set_reset,
        variables: Variables::new(e.variables.clone()),
        out: String::new(),
        labels: 0,
        loops: Vec::new(),
        wanted: None,
    };
    for (guard, part) in e.guarded() {
        match guard {
            None => p.block(part),
            Some(false) => p.when(&Ex::var("FAULT").not(), part),
            Some(true) => {
                p.comment(FAULT_COMES);
                p.when(&Ex::var("FAULT"), part);
            }
        }
    }
    let body = if p.out.trim().is_empty() { "  LD TRUE\n".to_owned() } else { p.out };
    let variables = p.variables.into_list();
    let head =
        declarations(&Block { name: e.name.clone(), notes: e.notes.clone(), variables, ..Block::default() });
    format!("{head}{body}  RET\nEND_FUNCTION_BLOCK\n")
}

struct Printer {
    set_reset: bool,
    variables: Variables,
    out: String,
    labels: usize,
    /// Labels behind the loops round this point.
    loops: Vec<String>,
    /// While a value without a type of its own is printed: the type that is wanted there.
    wanted: Option<String>,
}

impl Printer {
    fn line(&mut self, text: &str) {
        let _ = writeln!(self.out, "  {text}");
    }

    fn comment(&mut self, note: &str) {
        let note = plain(note);
        if !note.is_empty() {
            self.line(&format!("(* {note} *)"));
        }
    }

    fn label(&mut self) -> String {
        self.labels += 1;
        format!("P_{}", self.labels)
    }

    fn mark(&mut self, label: &str) {
        let _ = writeln!(self.out, "{label}:");
    }

    fn store(&mut self, e: &Ex, with: &str, to: &str) {
        self.load(e);
        self.line(&format!("{with} {to}"));
    }

    fn block(&mut self, body: &[St]) {
        body.iter().for_each(|s| self.statement(s));
    }

    /// Statements where a condition holds.
    fn when(&mut self, c: &Ex, body: &[St]) {
        let behind = self.label();
        self.load(c);
        self.line(&format!("JMPCN {behind}"));
        self.block(body);
        self.mark(&behind);
    }

    /// A BOOL that comes on or goes off, and stays.
    fn latch(&mut self, c: &Ex, name: &str, on: bool) {
        if self.set_reset {
            return self.store(c, if on { "S" } else { "R" }, name);
        }
        // matiec takes S and R for calls of function blocks now and then.
        let own = Ex::var(name);
        let e = if on { c.clone().or(own) } else { own.and(c.clone().not()) };
        self.store(&e, "ST", name);
    }

    fn statement(&mut self, s: &St) {
        if let Some((c, name, on)) = s.latch() {
            return self.latch(c, name, on);
        }
        match s {
            St::Title(note) | St::Note(note) => self.comment(note),
            St::Assign(to, e) => {
                let ty = self.variables.type_name(to).to_owned();
                self.load_as(e, &ty);
                self.line(&format!("ST {}", expression(to)));
            }
            St::If(c, then, other) if other.is_empty() => self.when(c, then),
            St::If(c, then, other) => {
                let (behind, end) = (self.label(), self.label());
                self.load(c);
                self.line(&format!("JMPCN {behind}"));
                self.block(then);
                self.line(&format!("JMP {end}"));
                self.mark(&behind);
                self.block(other);
                self.mark(&end);
            }
            St::Until(body, c) => {
                let again = self.label();
                self.mark(&again);
                self.block(body);
                self.load(c);
                self.line(&format!("JMPCN {again}"));
            }
            St::Loop(body) => {
                let (again, end) = (self.label(), self.label());
                self.mark(&again);
                self.loops.push(end.clone());
                self.block(body);
                self.loops.pop();
                self.line(&format!("JMP {again}"));
                self.mark(&end);
            }
            St::Exit => {
                let end = self.loops.last().cloned().unwrap_or_default();
                self.line(&format!("JMP {end}"));
            }
            St::Call(name, inputs) => {
                // Inputs are stored, then the block is called: some are named as
                // operators are (LD, R, S), which not every compiler takes in a call.
                for (formal, e) in inputs {
                    self.store(e, "ST", &format!("{name}.{formal}"));
                }
                self.line(&format!("CAL {name}"));
            }
        }
    }

    /// A value in a memory of its own, where it is no operand.
    fn kept(&mut self, e: &Ex) -> Ex {
        let ty = self.variables.type_name(e).to_owned();
        self.kept_as(e, &ty)
    }

    /// The operand of a value, the same way.
    fn kept_of(&mut self, of: &Ex, e: &Ex) -> Ex {
        let ty = match &self.wanted {
            Some(ty) if of.is_open() && e.is_open() => ty.clone(),
            _ => self.variables.operand_type(of, e).to_owned(),
        };
        self.kept_as(e, &ty)
    }

    fn kept_as(&mut self, e: &Ex, ty: &str) -> Ex {
        // matiec compares a LINT with a negative literal as if that had no sign.
        let negative = matches!(e, Ex::Int(n) if *n < 0);
        if operand(e).is_some() && !is_member(e) && !negative {
            return e.clone();
        }
        let name = self.variables.memory(ty);
        self.load_as(e, ty);
        self.line(&format!("ST {name}"));
        Ex::Var(name)
    }

    /// Loads a value where this type is wanted.
    fn load_as(&mut self, e: &Ex, ty: &str) {
        let outer = std::mem::replace(&mut self.wanted, e.is_open().then(|| ty.to_owned()));
        self.load(e);
        self.wanted = outer;
    }

    /// An expression whose brackets hold contacts only: whatever is deeper, and
    /// comparisons behind the first, have memories.
    fn ready(&mut self, e: &Ex) -> Ex {
        match e {
            Ex::And(list) | Ex::Or(list) => {
                let mut list = list.clone();
                if let Some(i) = list.iter().position(|e| !contact(e) && !flat(e)) {
                    let first = list.remove(i);
                    list.insert(0, first);
                }
                let mut done = Vec::new();
                for (i, e) in list.iter().enumerate() {
                    done.push(match e {
                        e if contact(e) || flat(e) => e.clone(),
                        Ex::Op(..) if i == 0 => self.ready(e),
                        Ex::Not(inner) => Ex::Not(Box::new(self.kept(inner))),
                        e => self.kept(e),
                    });
                }
                if matches!(e, Ex::And(_)) { Ex::And(done) } else { Ex::Or(done) }
            }
            Ex::Not(inner) if operand(inner).is_none() => Ex::Not(Box::new(self.kept(inner))),
            Ex::Xor(a, b) => {
                let b = if contact(b) { (**b).clone() } else { self.kept(b) };
                let a = if contact(a) { (**a).clone() } else { self.kept(a) };
                Ex::Xor(Box::new(a), Box::new(b))
            }
            Ex::Op(sign, a, b) => {
                let b = self.kept_of(e, b);
                let a = match &**a {
                    Ex::Op(..) => self.ready(a),
                    a if operand(a).is_some() => a.clone(),
                    a => self.kept_of(e, a),
                };
                Ex::op(sign, a, b)
            }
            Ex::Neg(inner) => Ex::Neg(Box::new(self.kept(inner))),
            Ex::Call(name, args) => {
                let args: Vec<Ex> = args.iter().map(|a| self.kept_of(e, a)).collect();
                Ex::Call(name.clone(), args)
            }
            plain => plain.clone(),
        }
    }

    /// The value as the current result.
    fn load(&mut self, e: &Ex) {
        let e = self.ready(e);
        self.result(&e);
    }

    fn result(&mut self, e: &Ex) {
        if let Some(text) = operand(e) {
            return self.line(&format!("LD {text}"));
        }
        match e {
            Ex::Not(inner) => match operand(inner) {
                Some(text) => self.line(&format!("LDN {text}")),
                None => {
                    self.result(inner);
                    self.line("NOT");
                }
            },
            Ex::And(list) => self.chain(list, "AND"),
            Ex::Or(list) => self.chain(list, "OR"),
            Ex::Xor(a, b) => {
                self.result(a);
                self.with("XOR", b);
            }
            Ex::Neg(inner) => {
                let real = self.variables.type_name(inner).ends_with("REAL");
                self.line(if real { "LD 0.0" } else { "LD 0" });
                self.with("SUB", inner);
            }
            Ex::Op(sign, a, b) => {
                self.result(a);
                let word = match *sign {
                    "+" => "ADD",
                    "-" => "SUB",
                    "*" => "MUL",
                    "/" => "DIV",
                    "=" => "EQ",
                    "<>" => "NE",
                    "<" => "LT",
                    "<=" => "LE",
                    ">" => "GT",
                    ">=" => "GE",
                    other => other,
                };
                self.with(word, b);
            }
            Ex::Call(name, args) => self.function(name, args),
            Ex::Bool(_)
            | Ex::Int(_)
            | Ex::Bits(..)
            | Ex::Real(_)
            | Ex::Time(_)
            | Ex::Var(_)
            | Ex::Index(..) => {}
        }
    }

    fn chain(&mut self, list: &[Ex], word: &str) {
        let Some((first, rest)) = list.split_first() else { return };
        self.result(first);
        for e in rest {
            self.with(word, e);
        }
    }

    fn with(&mut self, word: &str, e: &Ex) {
        match e {
            Ex::Not(inner) => self.with(&format!("{word}N"), inner),
            e => match operand(e) {
                Some(text) => self.line(&format!("{word} {text}")),
                None => {
                    self.line(&format!("{word}("));
                    self.result(e);
                    self.line(")");
                }
            },
        }
    }

    fn function(&mut self, name: &str, args: &[Ex]) {
        let Some((first, rest)) = args.split_first() else { return };
        self.result(first);
        let rest: Vec<String> = rest.iter().map(expression).collect();
        self.line(format!("{name} {}", rest.join(", ")).trim_end());
    }
}

/// A member of a block: to be loaded, but not every compiler takes it behind
/// an operator.
fn is_member(e: &Ex) -> bool {
    matches!(e, Ex::Var(name) if name.contains('.'))
}

/// An operand, or the complement of one.
fn contact(e: &Ex) -> bool {
    match e {
        Ex::Not(inner) => contact(inner) && !matches!(**inner, Ex::Not(_)),
        e => operand(e).is_some() && !is_member(e),
    }
}

/// Operands in brackets.
fn flat(e: &Ex) -> bool {
    match e {
        Ex::Not(inner) => matches!(&**inner, Ex::And(_) | Ex::Or(_)) && flat(inner),
        Ex::And(list) | Ex::Or(list) => list.iter().all(contact),
        _ => false,
    }
}

/// An operand that stands behind an operator as it is.
fn operand(e: &Ex) -> Option<String> {
    match e {
        Ex::Bool(_) | Ex::Int(_) | Ex::Bits(..) | Ex::Real(_) | Ex::Time(_) | Ex::Var(_) | Ex::Index(..) => {
            Some(expression(e))
        }
        _ => None,
    }
}
