//! The equations as AWL (STL) for S7-300 and S7-400: a source with the function block and its data
//! block, and a symbol table. [`values`] has the expressions.
//!
//! # Invariants
//!
//! - All whole numbers are worked out with 32 bits (DINT), TIME among them, as milliseconds.
//! - Brackets nest at most [`values::DEEP`] deep: the stack of the processor has seven places.
//! - No jump leads out of brackets, nor into them.

mod values;

use std::collections::BTreeSet;
use std::fmt::Write;

use g7_model::{Problem, Said, Span, codes};

use super::form::{Block, Class, Declared, Ex, St, not_printed};
use super::st::FAULT_COMES;
use values::{NOW, Values, type_of};

/// The source, and the symbol table in the form ASC.
///
/// # Errors
///
/// Parts that an S7-300 cannot say, at `place`.
pub(super) fn print(e: &Block, place: Span) -> Result<(String, String), Vec<Problem>> {
    let mut variables = e.variables.clone();
    if let Some(clock) = e.variables.iter().find(|v| v.ty == "TON") {
        let (name, ty, note) = (NOW.to_owned(), "TIME".to_owned(), "the time of the timer".to_owned());
        variables.push(Declared { name, ty, note, ..clock.clone() });
    }
    let mut p = Printer { values: Values::new(variables), loops: Vec::new(), depth: 0 };
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
    let (out, variables, mut cannot) = p.values.done();
    let head = declarations(e, &variables, &mut cannot);
    if !cannot.is_empty() {
        let problem = |what| Problem::new(&codes::NOT_CARRIED, place, what);
        return Err(cannot.into_iter().map(problem).collect());
    }
    let body = if out.is_empty() { "      NOP 0;\n".to_owned() } else { out };
    let text = format!(
        "{head}BEGIN\nNETWORK\nTITLE =One call is one scan\n{body}END_FUNCTION_BLOCK\n\n\
         DATA_BLOCK DB 1\nTITLE =Instance of {}\nVERSION : 0.1\n\nFB 1\nBEGIN\n{}END_DATA_BLOCK\n",
        e.name,
        actual(&variables)
    );
    Ok((text, symbols(e)))
}

fn declarations(e: &Block, variables: &[Declared], cannot: &mut BTreeSet<Said>) -> String {
    let mut out = String::new();
    for note in &e.notes {
        let _ = writeln!(out, "// {}", line(note));
    }
    let _ =
        writeln!(out, "FUNCTION_BLOCK FB 1\nTITLE ={}\nNAME : {}\nVERSION : 0.1\n", e.name, cut(&e.name, 8));
    let heads: [(&[Class], &str); 3] = [
        (&[Class::Input], "VAR_INPUT"),
        (&[Class::Output], "VAR_OUTPUT"),
        // The values of a data block outlive a loss of power, unless the block is told otherwise.
        (&[Class::Retain, Class::Internal], "VAR"),
    ];
    for (classes, head) in heads {
        let mut own = variables.iter().filter(|v| classes.contains(&v.class)).peekable();
        if own.peek().is_none() {
            continue;
        }
        let _ = writeln!(out, "{head}");
        for v in own {
            let Some(ty) = type_of(&v.ty) else {
                cannot.insert(not_printed(&v.ty, "S7-300"));
                continue;
            };
            let ty = if v.elements == 1 {
                ty.to_owned()
            } else {
                format!("ARRAY [0 .. {}] OF {ty}", v.elements - 1)
            };
            let init: Vec<String> = v.init.iter().map(|e| initial(e, &v.ty, cannot)).collect();
            let init = if init.is_empty() { init.concat() } else { format!(" := {}", init.join(", ")) };
            let note = if v.note.is_empty() { String::new() } else { format!(" // {}", line(&v.note)) };
            let _ = writeln!(out, "  {} : {ty}{init};{note}", v.name);
        }
        out += "END_VAR\n";
    }
    out
}

/// The values with which the data block begins, once more: not every system takes those of the function block.
fn actual(variables: &[Declared]) -> String {
    let mut out = String::new();
    for v in variables {
        for (i, e) in v.init.iter().enumerate() {
            let index = if v.elements == 1 { String::new() } else { format!("[{i}]") };
            let value = initial(e, &v.ty, &mut BTreeSet::new());
            let _ = writeln!(out, "  {}{index} := {value};", v.name);
        }
    }
    out
}

fn initial(e: &Ex, ty: &str, cannot: &mut BTreeSet<Said>) -> String {
    match (e, type_of(ty)) {
        (Ex::Bool(b), _) => if *b { "TRUE" } else { "FALSE" }.to_owned(),
        (Ex::Int(n), Some("DINT")) => format!("L#{n}"),
        (Ex::Int(n), _) => n.to_string(),
        (e, _) => values::constant(e).unwrap_or_else(|| {
            cannot.insert(values::no_room(e));
            String::new()
        }),
    }
}

/// A comment on one line.
fn line(note: &str) -> String {
    note.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>().trim().to_owned()
}

fn cut(name: &str, letters: usize) -> String {
    name.chars().take(letters).collect()
}

/// The symbol table: the block, its data block, and each variable with an address. The columns are those
/// of the editor's export: 24, 12, 10 and 80 letters behind the number 126.
fn symbols(e: &Block) -> String {
    let mut out = String::new();
    let mut row = |name: &str, address: &str, ty: &str, note: &str| {
        let note: String = line(note).chars().filter(char::is_ascii).collect();
        let _ = write!(out, "126,{:<24}{address:<12}{ty:<10}{:<80}\r\n", cut(name, 24), cut(&note, 80));
    };
    row(&e.name, "FB      1", "FB      1", "chart, printed by G7");
    row(&format!("{}_data", cut(&e.name, 19)), "DB      1", "FB      1", "its data");
    for v in &e.variables {
        let Some((address, note)) = v.addressed() else { continue };
        // The columns of the editor: the area, then the place at the right.
        let digits = address.find(|c: char| c.is_ascii_digit()).unwrap_or(0);
        let (area, place) = address.split_at(digits);
        let address = format!("{area:<4}{place:>5}");
        row(&v.name, &address, type_of(&v.ty).unwrap_or("BOOL"), note);
    }
    out
}

struct Printer {
    values: Values,
    /// Labels behind the loops round this point.
    loops: Vec<String>,
    /// Jumps that lead over this point.
    depth: usize,
}

impl Printer {
    fn comment(&mut self, note: &str) {
        let note = line(note);
        if !note.is_empty() {
            let _ = writeln!(self.values.out, "// {note}");
        }
    }

    fn block(&mut self, body: &[St]) {
        body.iter().for_each(|s| self.statement(s));
    }

    fn inner(&mut self, body: &[St]) {
        self.depth += 1;
        self.block(body);
        self.depth -= 1;
    }

    /// Statements where a condition holds.
    fn when(&mut self, c: &Ex, body: &[St]) {
        let behind = self.values.label();
        self.values.logic(c);
        self.values.line(&format!("JCN {behind}"));
        self.inner(body);
        self.values.mark(&behind);
    }

    fn statement(&mut self, s: &St) {
        if let Some((c, name, on)) = s.latch() {
            self.values.logic(c);
            return self.values.line(&format!("{} #{name}", if on { "S" } else { "R" }));
        }
        match s {
            // Labels are found within a block; a network begins where no jump leads over it.
            St::Title(title) if self.depth == 0 && !self.values.out.is_empty() => {
                let _ = writeln!(self.values.out, "NETWORK\nTITLE ={}", cut(&line(title), 64));
            }
            St::Title(note) | St::Note(note) => self.comment(note),
            St::Assign(Ex::Index(name, index), e) => self.store_element(name, index, e),
            St::Assign(to, e) => self.values.store(e, &values::variable(to)),
            St::If(c, then, other) if other.is_empty() => self.when(c, then),
            St::If(c, then, other) => {
                let (behind, end) = (self.values.label(), self.values.label());
                self.values.logic(c);
                self.values.line(&format!("JCN {behind}"));
                self.inner(then);
                self.values.line(&format!("JU {end}"));
                self.values.mark(&behind);
                self.inner(other);
                self.values.mark(&end);
            }
            St::Until(body, c) => {
                let again = self.values.label();
                self.values.mark(&again);
                self.inner(body);
                self.values.logic(c);
                self.values.line(&format!("JCN {again}"));
            }
            St::Loop(body) => {
                let (again, end) = (self.values.label(), self.values.label());
                self.values.mark(&again);
                self.loops.push(end.clone());
                self.inner(body);
                self.loops.pop();
                self.values.line(&format!("JU {again}"));
                self.values.mark(&end);
            }
            St::Exit => {
                let end = self.loops.last().cloned().unwrap_or_default();
                self.values.line(&format!("JU {end}"));
            }
            St::Call(name, inputs) => self.call(name, inputs),
        }
    }

    fn call(&mut self, name: &str, inputs: &[(String, Ex)]) {
        let mut given = Vec::new();
        for (formal, e) in inputs {
            let actual = match values::constant(e) {
                Some(text) => text,
                None => format!("#{}", self.values.kept(e)),
            };
            given.push(format!("{formal} := {actual}"));
        }
        self.values.line(&format!("CALL #{name} ({}, ET := #{NOW})", given.join(", ")));
    }

    /// Assigns to an element. AWL has no variable index here, so the index is compared with each place in turn.
    fn store_element(&mut self, name: &str, index: &Ex, e: &Ex) {
        if let Ex::Int(n) = index {
            return self.values.store(e, &format!("#{name}[{n}]"));
        }
        let value = self.values.kept(e);
        let of = Ex::Var(value.clone());
        let index = self.values.kept(index);
        let end = self.values.label();
        for k in 0..self.values.elements(name) {
            let next = self.values.label();
            self.values.logic(&Ex::op("=", Ex::var(&*index), Ex::Int(k.into())));
            self.values.line(&format!("JCN {next}"));
            self.values.store(&of, &format!("#{name}[{k}]"));
            self.values.line(&format!("JU {end}"));
            self.values.mark(&next);
        }
        self.values.mark(&end);
    }
}
