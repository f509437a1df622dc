//! The equations as Structured Text.

use std::fmt::Write;

use g7_model::Nanos;

use super::form::{Block, Class, Declared, Ex, St};

/// The text before the safe values.
pub(crate) const FAULT_COMES: &str = "A fault: the safe values, and no further scan";

/// Letters of a line up to which an IF with one assignment stands on it.
const WIDE: usize = 110;

/// The whole function block.
pub(crate) fn print(e: &Block) -> String {
    format!("{}{}END_FUNCTION_BLOCK\n", declarations(e), body(e, "FAULT"))
}

/// The statements; `fault` is how the memory of a fault is written.
pub(crate) fn body(e: &Block, fault: &str) -> String {
    let mut p = Printer { out: String::new(), depth: 0, fresh: true };
    for (guard, part) in e.guarded() {
        match guard {
            None => p.block(part),
            Some(false) => p.guarded(&format!("IF NOT {fault} THEN"), part),
            Some(true) => {
                p.comment(FAULT_COMES);
                p.guarded(&format!("IF {fault} THEN"), part);
            }
        }
    }
    p.out
}

/// The sections of variables of a function block: the first line of each (`VAR_INPUT` …), and its variables. A section
/// without variables is left out.
pub(crate) fn sections(variables: &[Declared]) -> impl Iterator<Item = (&'static str, Vec<&Declared>)> {
    let heads = [
        (Class::Input, "VAR_INPUT"),
        (Class::Output, "VAR_OUTPUT"),
        (Class::Retain, "VAR RETAIN"),
        (Class::Internal, "VAR"),
    ];
    let own = |class: Class| variables.iter().filter(|v| v.class == class).collect::<Vec<_>>();
    heads.into_iter().map(move |(class, head)| (head, own(class))).filter(|(_, own)| !own.is_empty())
}

/// The head of the function block with its variables.
pub(crate) fn declarations(e: &Block) -> String {
    let mut out = String::new();
    for note in &e.notes {
        let _ = writeln!(out, "(* {} *)", plain(note));
    }
    let _ = writeln!(out, "FUNCTION_BLOCK {}", e.name);
    for (head, own) in sections(&e.variables) {
        let _ = writeln!(out, "{head}");
        for v in own {
            let note = if v.note.is_empty() { String::new() } else { format!(" (* {} *)", plain(&v.note)) };
            let _ = writeln!(out, "  {} : {};{note}", v.name, type_text(v));
        }
        out += "END_VAR\n";
    }
    out.push('\n');
    out
}

/// The type of a variable with its initial value.
pub(crate) fn type_text(v: &Declared) -> String {
    let ty = if v.elements == 1 { v.ty.clone() } else { format!("ARRAY[0..{}] OF {}", v.elements - 1, v.ty) };
    let init: Vec<String> = v.init.iter().map(expression).collect();
    match (init.as_slice(), v.elements) {
        ([], _) => ty,
        ([one], 1) => format!("{ty} := {one}"),
        (many, _) => format!("{ty} := [{}]", many.join(", ")),
    }
}

/// A comment cannot hold the end of a comment.
pub(crate) fn plain(note: &str) -> String {
    let mut text: String = note.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    while text.contains("*)") || text.contains("(*") {
        text = text.replace("*)", "* )").replace("(*", "( *");
    }
    text.trim().to_owned()
}

struct Printer {
    out: String,
    depth: usize,
    /// Nothing stands yet where a heading would be set apart from it.
    fresh: bool,
}

impl Printer {
    fn line(&mut self, text: &str) {
        let _ = writeln!(self.out, "{}{text}", "  ".repeat(self.depth));
        self.fresh = false;
    }

    fn comment(&mut self, note: &str) {
        let note = plain(note);
        if !note.is_empty() {
            self.line(&format!("(* {note} *)"));
        }
    }

    fn guarded(&mut self, head: &str, body: &[St]) {
        self.line(head);
        self.inner(body);
        self.line("END_IF;");
    }

    fn block(&mut self, body: &[St]) {
        body.iter().for_each(|s| self.statement(s));
    }

    fn inner(&mut self, body: &[St]) {
        self.depth += 1;
        self.fresh = true;
        self.block(body);
        self.depth -= 1;
    }

    /// IF with one assignment on a line, where it is short.
    fn short(&self, s: &St) -> Option<String> {
        let St::If(c, then, other) = s else { return None };
        let ([St::Assign(to, e)], []) = (then.as_slice(), other.as_slice()) else { return None };
        let text = format!("IF {} THEN {} := {}; END_IF;", expression(c), expression(to), expression(e));
        (text.len() + 2 * self.depth <= WIDE).then_some(text)
    }

    fn statement(&mut self, s: &St) {
        if let Some(text) = self.short(s) {
            return self.line(&text);
        }
        match s {
            St::Title(title) => {
                if !self.fresh {
                    self.out.push('\n');
                }
                self.comment(title);
            }
            St::Note(note) => self.comment(note),
            St::Assign(to, e) => self.line(&format!("{} := {};", expression(to), expression(e))),
            St::If(c, then, other) => {
                self.line(&format!("IF {} THEN", expression(c)));
                self.inner(then);
                let mut other = other.as_slice();
                while let [St::If(c, then, rest)] = other {
                    self.line(&format!("ELSIF {} THEN", expression(c)));
                    self.inner(then);
                    other = rest;
                }
                if !other.is_empty() {
                    self.line("ELSE");
                    self.inner(other);
                }
                self.line("END_IF;");
            }
            St::Loop(body) => {
                let (c, body) = match body.split_first() {
                    Some((St::If(c, then, other), rest)) if then[..] == [St::Exit] && other.is_empty() => {
                        (c.clone().not(), rest)
                    }
                    _ => (Ex::Bool(true), body.as_slice()),
                };
                self.line(&format!("WHILE {} DO", expression(&c)));
                self.inner(body);
                self.line("END_WHILE;");
            }
            St::Until(body, c) => {
                self.line("REPEAT");
                self.inner(body);
                self.line(&format!("UNTIL {} END_REPEAT;", expression(c)));
            }
            St::Exit => self.line("EXIT;"),
            St::Call(name, inputs) => {
                let inputs: Vec<String> = inputs.iter().map(input).collect();
                self.line(&format!("{name}({});", inputs.join(", ")));
            }
        }
    }
}

/// An input of a call; one without a name stands by its place.
fn input((name, e): &(String, Ex)) -> String {
    if name.is_empty() { expression(e) } else { format!("{name} := {}", expression(e)) }
}

/// How tightly it binds.
fn tightness(e: &Ex) -> u8 {
    match e {
        Ex::Or(_) => 1,
        Ex::Xor(..) => 2,
        Ex::Call(name, _) if is_bitwise(name) => 1,
        Ex::And(_) => 3,
        Ex::Op("=" | "<>", ..) => 4,
        Ex::Op("<" | "<=" | ">" | ">=", ..) => 5,
        Ex::Op("+" | "-", ..) => 6,
        Ex::Op("**", ..) => 9,
        Ex::Op(..) => 7,
        Ex::Not(_) | Ex::Neg(_) => 8,
        Ex::Int(n) if *n < 0 => 8,
        Ex::Real(x) if *x < 0.0 => 8,
        _ => 10,
    }
}

/// The functions of bit strings that are operators in Structured Text.
fn is_bitwise(name: &str) -> bool {
    matches!(name, "AND" | "OR" | "XOR")
}

/// An expression of Structured Text.
pub(crate) fn expression(e: &Ex) -> String {
    let within = |inner: &Ex, least: u8| {
        let text = expression(inner);
        if tightness(inner) < least { format!("({text})") } else { text }
    };
    let list = |list: &[Ex], sign: &str, least: u8| {
        let parts: Vec<String> = list.iter().map(|e| within(e, least)).collect();
        parts.join(sign)
    };
    match e {
        Ex::Bool(true) => "TRUE".into(),
        Ex::Bool(false) => "FALSE".into(),
        Ex::Int(n) => n.to_string(),
        Ex::Bits(ty, word) => format!("{}#16#{word:X}", ty.name()),
        Ex::Real(x) => real(*x),
        Ex::Time(amount) => time(*amount),
        Ex::Var(name) => name.clone(),
        Ex::Index(name, i) => format!("{name}[{}]", expression(i)),
        Ex::Not(inner) => format!("NOT {}", within(inner, 9)),
        Ex::Neg(inner) => format!("-{}", within(inner, 9)),
        Ex::And(parts) => list(parts, " AND ", 4),
        // AND beside OR or XOR has brackets, so that nobody has to know which binds closer.
        Ex::Or(parts) => list(parts, " OR ", 4),
        Ex::Xor(a, b) => format!("{} XOR {}", within(a, 4), within(b, 4)),
        Ex::Op(sign, a, b) => {
            let t = tightness(e);
            format!("{} {sign} {}", within(a, t), within(b, t + 1))
        }
        Ex::Call(name, args) if is_bitwise(name) => list(args, &format!(" {name} "), 4),
        Ex::Call(name, args) => {
            let args: Vec<String> = args.iter().map(expression).collect();
            format!("{name}({})", args.join(", "))
        }
    }
}

/// A time in one unit: `T#1500ms`, `T#90s`. IronPLC reads no second unit behind a first.
fn time(amount: Nanos) -> String {
    let count = amount.count();
    let units = Nanos::UNITS.iter().take(4).find(|(_, size)| count != 0 && count % size.count() == 0);
    if let Some((unit, size)) = units {
        return format!("T#{}{unit}", count / size.count());
    }
    let (whole, part) = (count / 1_000_000, (count % 1_000_000).unsigned_abs());
    let sign = if count < 0 { "-" } else { "" };
    let part = format!(".{part:06}");
    format!("T#{sign}{}{}ms", whole.unsigned_abs(), part.trim_end_matches('0').trim_end_matches('.'))
}

pub(crate) fn real(x: f64) -> String {
    let text = format!("{x:?}");
    match text.split_once('e') {
        Some((m, e)) if m.contains('.') => format!("{m}E{e}"),
        Some((m, e)) => format!("{m}.0E{e}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_has_one_unit() {
        let rows = [
            (0, "T#0ms"),
            (1_500_000_000, "T#1500ms"),
            (90_000_000_000, "T#90s"),
            (5_400_000_000_000, "T#90m"),
            (90_000_000_000_000, "T#25h"),
            (172_800_000_000_000, "T#2d"),
            (2_000_000_500, "T#2000.0005ms"),
            (-1_000_500_000, "T#-1000.5ms"),
            (-250_000, "T#-0.25ms"),
            (-3_000_000_000, "T#-3s"),
        ];
        for (count, text) in rows {
            assert_eq!(time(Nanos::new(count)), text);
        }
    }
}
