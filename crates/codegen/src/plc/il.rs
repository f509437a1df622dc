//! The equations as Instruction List.

use std::fmt::Write;

use super::form::{Class, Declared, Equations, Ex, Section, St, What, type_name};
use super::st::{declarations, expression, plain};

/// The whole function block.
pub(crate) fn print(e: &Equations) -> String {
    let mut p = Printer {
        variables: e.variables.clone(),
        out: String::new(),
        labels: 0,
        memories: 0,
        loops: Vec::new(),
    };
    p.sections(&e.before);
    let fine = e.safe.is_some().then(|| p.label());
    if let Some(label) = &fine {
        p.line("LD FAULT");
        p.line(&format!("JMPC {label}"));
    }
    match e.bound {
        None => p.sections(&e.pass),
        Some(bound) => {
            p.comment("The evolution, until nothing changes");
            p.lines(&["LD 0", "ST PASSES"]);
            let again = p.label();
            p.mark(&again);
            p.lines(&["LD PASSES", "ADD 1", "ST PASSES"]);
            p.sections(&e.pass);
            let (over, stable) = (p.label(), p.label());
            p.lines(&["LD FAULT", "ORN CHANGED"]);
            p.line(&format!("JMPC {stable}"));
            p.lines(&["LD PASSES", &format!("GE {bound}")]);
            p.line(&format!("JMPC {over}"));
            p.line(&format!("JMP {again}"));
            p.mark(&over);
            p.lines(&["LD TRUE", "S FAULT"]);
            p.mark(&stable);
        }
    }
    if let (Some(label), Some(safe)) = (fine, &e.safe) {
        let (faulty, end) = (p.label(), p.label());
        p.line("LD FAULT");
        p.line(&format!("JMPC {faulty}"));
        p.sections(&e.after);
        p.line(&format!("JMP {end}"));
        p.mark(&label);
        p.mark(&faulty);
        p.comment("No stable situation, or orders that disagree: the safe values, and no further scan");
        p.block(safe);
        p.mark(&end);
    } else {
        p.sections(&e.after);
    }
    let body = if p.out.trim().is_empty() { "  LD TRUE\n".to_owned() } else { p.out };
    let head =
        declarations(&Equations { name: e.name.clone(), variables: p.variables, ..Equations::default() });
    format!("{head}{body}  RET\nEND_FUNCTION_BLOCK\n")
}

struct Printer {
    variables: Vec<Declared>,
    out: String,
    labels: usize,
    memories: usize,
    /// Labels behind the loops round this point.
    loops: Vec<String>,
}

impl Printer {
    fn line(&mut self, text: &str) {
        let _ = writeln!(self.out, "  {text}");
    }

    fn lines(&mut self, list: &[&str]) {
        list.iter().for_each(|l| self.line(l));
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

    fn sections(&mut self, sections: &[Section]) {
        for s in sections.iter().filter(|s| !s.rungs.is_empty()) {
            self.comment(&s.title);
            for r in &s.rungs {
                self.comment(&r.note);
                match &r.what {
                    What::Assign(to, e) => self.store(e, "ST", to),
                    What::Set(to, e) => self.store(e, "S", to),
                    What::Reset(to, e) => self.store(e, "R", to),
                    What::Do(Ex::Bool(true), body) => self.block(body),
                    What::Do(e, body) => {
                        let behind = self.label();
                        self.load(e);
                        self.line(&format!("JMPCN {behind}"));
                        self.block(body);
                        self.mark(&behind);
                    }
                }
            }
        }
    }

    fn store(&mut self, e: &Ex, with: &str, to: &str) {
        self.load(e);
        self.line(&format!("{with} {to}"));
    }

    fn block(&mut self, body: &[St]) {
        body.iter().for_each(|s| self.statement(s));
    }

    fn statement(&mut self, s: &St) {
        match s {
            St::Assign(to, e) => self.store(e, "ST", &expression(to)),
            St::If(c, then, other) => {
                let (behind, end) = (self.label(), self.label());
                self.load(c);
                self.line(&format!("JMPCN {behind}"));
                self.block(then);
                if !other.is_empty() {
                    self.line(&format!("JMP {end}"));
                }
                self.mark(&behind);
                if !other.is_empty() {
                    self.block(other);
                    self.mark(&end);
                }
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
        if operand(e).is_some() {
            return e.clone();
        }
        let ty = type_name(&self.variables, e);
        let name = loop {
            self.memories += 1;
            let name = format!("K_{}", self.memories);
            if self.variables.iter().all(|v| !v.name.eq_ignore_ascii_case(&name)) {
                break name;
            }
        };
        self.variables.push(Declared {
            class: Class::Internal,
            name: name.clone(),
            ty,
            elements: 1,
            init: Vec::new(),
            note: String::new(),
        });
        self.load(e);
        self.line(&format!("ST {name}"));
        Ex::Var(name)
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
                let b = self.kept(b);
                let a = if matches!(**a, Ex::Op(..)) { self.ready(a) } else { self.kept(a) };
                Ex::op(sign, a, b)
            }
            Ex::Neg(inner) => Ex::Neg(Box::new(self.kept(inner))),
            Ex::Call(name, args) => {
                let args: Vec<Ex> = args.iter().map(|a| self.kept(a)).collect();
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
            Ex::Not(inner) => self.line(&format!("LDN {}", expression(inner))),
            Ex::And(list) => self.chain(list, "AND"),
            Ex::Or(list) => self.chain(list, "OR"),
            Ex::Xor(a, b) => {
                self.result(a);
                self.with("XOR", b);
            }
            Ex::Neg(inner) => {
                let real = type_name(&self.variables, inner).ends_with("REAL");
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
            Ex::Bool(_) | Ex::Int(_) | Ex::Real(_) | Ex::Time(_) | Ex::Var(_) | Ex::Index(..) => {}
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

/// An operand, or the complement of one.
fn contact(e: &Ex) -> bool {
    match e {
        Ex::Not(inner) => operand(inner).is_some(),
        e => operand(e).is_some(),
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

/// What can stand behind an operator as it is.
fn operand(e: &Ex) -> Option<String> {
    match e {
        Ex::Bool(_) | Ex::Int(_) | Ex::Real(_) | Ex::Time(_) | Ex::Var(_) | Ex::Index(..) => {
            Some(expression(e))
        }
        _ => None,
    }
}
