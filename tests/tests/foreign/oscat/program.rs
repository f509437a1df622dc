//! A program that calls one unit of the library with random values.
//!
//! Values of more than one word are made from single ones within the program: a text is chosen by a number, an array
//! is filled from a seed, a structure has an input for each member. What comes out is put into single values again.

use std::fmt::Write as _;

use g7_model::Type as Elementary;

use super::units::{Library, Parameter, Unit};

/// The functions with which this port of OSCAT asks for the time: the body in C for matiec, and that for G7.
const CLOCKS: [(&str, &str, &str); 2] = [
    ("T_PLC_MS", "__CURRENT_TIME.tv_sec * 1000 + __CURRENT_TIME.tv_nsec / 1000000", "TIME_TO_UDINT(TIME())"),
    (
        "T_PLC_US",
        "__CURRENT_TIME.tv_sec * 1000000 + __CURRENT_TIME.tv_nsec / 1000",
        "TIME_TO_UDINT(TIME()) * 1000",
    ),
];

/// Texts that a program is given.
const TEXTS: [&str; 8] = ["", "a", "Ab1", "0F", "12", "-3.5", "a b c", "xyzxyz09"];

/// The same program for two readers.
pub(crate) struct Program {
    pub(crate) for_matiec: String,
    pub for_g7: String,
}

/// The program that calls a unit.
pub(crate) fn program(library: &Library, unit: &Unit) -> Program {
    let mut made = Made::default();
    let mut args = Vec::new();
    for (k, p) in unit.inputs.iter().chain(&unit.inouts).enumerate() {
        let value = made.given(library, p, &format!("v{k}{}", p.name), k >= unit.inputs.len());
        args.push(format!("{} := {value}", p.name));
    }
    for (k, p) in unit.outputs.iter().enumerate() {
        let own = format!("q{k}{}", p.name);
        let _ = writeln!(made.locals, "  {own} : {};", p.ty);
        args.push(format!("{} => {own}", p.name));
        made.shown(library, &p.ty, &own, &format!("r{k}{}", p.name));
    }
    for (k, p) in unit.inouts.iter().enumerate() {
        let own = format!("v{}{}", k + unit.inputs.len(), p.name);
        made.shown(library, &p.ty, &made.held(&own), &format!("s{k}{}", p.name));
    }
    if args.is_empty() {
        args.push("EN := TRUE".to_owned());
    }
    let args = args.join(", ");
    let call = if unit.function {
        let _ = writeln!(made.locals, "  result : {};", unit.result);
        made.shown(library, &unit.result, "result", "r");
        format!("result := {}({args});\n", unit.name)
    } else {
        let _ = writeln!(made.locals, "  fb : {};", unit.name);
        format!("fb({args});\n")
    };
    let section = |word: &str, text: &str| match text {
        "" => String::new(),
        text => format!("{word}\n{text}END_VAR\n"),
    };
    let main = format!(
        "PROGRAM main\n{}{}{}{}{call}{}END_PROGRAM\nCONFIGURATION c\n  RESOURCE r ON PLC\n    TASK t(INTERVAL := \
         T#10ms, PRIORITY := 0);\n    PROGRAM p WITH t : main;\n  END_RESOURCE\nEND_CONFIGURATION\n",
        section("VAR_INPUT", &made.inputs),
        section("VAR_OUTPUT", &made.outputs),
        section("VAR", &made.locals),
        made.before,
        made.behind,
    );
    let units: Vec<&Unit> = library.needs(&unit.name.to_uppercase());
    let with = |clock: &dyn Fn(usize) -> String| {
        let of = |u: &&Unit| match CLOCKS.iter().position(|c| c.0 == u.name) {
            Some(k) => clock(k),
            None => u.text.clone(),
        };
        let text: String = units.iter().map(of).collect();
        named_arrays(library, &(text + &main))
    };
    let function = |k: usize, body: &str| {
        let name = CLOCKS.get(k).map_or("", |c| c.0);
        format!(
            "FUNCTION {name} : UDINT\nVAR_INPUT debug : BOOL; END_VAR\nVAR TX : UDINT; END_VAR\n{body}{name} := \
             tx;\nEND_FUNCTION\n"
        )
    };
    let in_c = |k: usize| {
        function(k, &format!("tx := 0;\n{{TX = (UDINT)({});}}\n", CLOCKS.get(k).map_or("", |c| c.1)))
    };
    let in_st = |k: usize| function(k, &format!("tx := {};\n", CLOCKS.get(k).map_or("", |c| c.2)));
    Program { for_matiec: with(&in_c), for_g7: with(&in_st) }
}

/// matiec takes two arrays without a named type for different ones: each array type of a text gets a name.
fn named_arrays(library: &Library, text: &str) -> String {
    let mut types = library.types_of(text);
    let mut names: Vec<String> = Vec::new();
    let mut made = String::new();
    for line in text.lines() {
        let array = line.to_uppercase().find("ARRAY").filter(|_| line.contains("..") && line.contains(':'));
        let Some((start, rest)) = array.and_then(|a| Some((a, line.get(a..)?))) else {
            made += &format!("{line}\n");
            continue;
        };
        let end = rest.find(":=").or_else(|| rest.find(';')).unwrap_or(rest.len());
        let ty =
            rest.get(..end).unwrap_or("").split_whitespace().collect::<Vec<_>>().join(" ").to_uppercase();
        let place = names.iter().position(|n| *n == ty).unwrap_or_else(|| {
            names.push(ty);
            names.len() - 1
        });
        let (before, behind) = (line.get(..start).unwrap_or(""), rest.get(end..).unwrap_or(""));
        made += &format!("{before}ZZARRAY{place} {behind}\n");
    }
    for (k, ty) in names.iter().enumerate() {
        let _ = writeln!(types, "ZZARRAY{k} : {ty};");
    }
    if types.is_empty() { made } else { format!("TYPE\n{types}END_TYPE\n{made}") }
}

#[derive(Default)]
struct Made {
    inputs: String,
    outputs: String,
    locals: String,
    before: String,
    behind: String,
    /// The variables that hold a value of more than one word, or stand for an in-out.
    wide: Vec<String>,
}

impl Made {
    /// The variable in which a parameter of this name is held.
    fn held(&self, name: &str) -> String {
        if self.wide.iter().any(|w| w == name) { format!("w{name}") } else { name.to_owned() }
    }

    /// Makes a value of a type; returns the variable that has it. That for an in-out is written by the unit.
    fn given(&mut self, library: &Library, p: &Parameter, name: &str, inout: bool) -> String {
        if single(&p.ty) && !inout {
            let _ = writeln!(self.inputs, "  {name} : {};", p.ty);
            return name.to_owned();
        }
        self.wide.push(name.to_owned());
        let own = self.held(name);
        let _ = writeln!(self.locals, "  {own} : {};", p.ty);
        self.filled(library, &p.ty, &own, name);
        own
    }

    fn filled(&mut self, library: &Library, ty: &str, to: &str, from: &str) {
        if single(ty) {
            let _ = writeln!(self.inputs, "  {from} : {ty};");
            let _ = writeln!(self.before, "{to} := {from};");
        } else if is_text(ty) {
            let _ = writeln!(self.inputs, "  {from} : USINT;");
            for (k, text) in TEXTS.iter().enumerate() {
                let _ = writeln!(self.before, "IF {from} MOD 8 = {k} THEN {to} := '{text}'; END_IF;");
            }
        } else if let Some(array) = Array::of(ty).filter(|a| single(&a.element)) {
            let Some(value) = array.value(from) else { return };
            let _ = writeln!(self.inputs, "  {from} : USINT;");
            self.before += &array.each(&mut self.locals, to, |element, count| {
                format!("{element} := {};\n", value.replace('#', count))
            });
        } else if let Some((members, _)) = library.types.get(&ty.to_uppercase()) {
            for m in members {
                self.filled(library, &m.ty, &format!("{to}.{}", m.name), &format!("{from}_{}", m.name));
            }
        }
    }

    /// Puts what a variable has into outputs.
    fn shown(&mut self, library: &Library, ty: &str, from: &str, to: &str) {
        if single(ty) {
            let _ = writeln!(self.outputs, "  {to} : {ty};");
            let _ = writeln!(self.behind, "{to} := {from};");
        } else if is_text(ty) {
            let _ = writeln!(self.outputs, "  {to} : INT;\n  {to}c : DINT;");
            let _ = writeln!(self.behind, "{to} := LEN({from});\n{to}c := 0;");
            for k in 1..=8 {
                let letters = "'0123456789ABCDEFabcdefxyz -+.:/#%$$'";
                let _ = writeln!(
                    self.behind,
                    "IF {to} >= {k} THEN {to}c := {to}c * 31 + INT_TO_DINT(FIND({letters}, MID({from}, 1, {k}))); {to}c := \
                     {to}c MOD 1000003; END_IF;"
                );
            }
        } else if let Some(array) = Array::of(ty).filter(|a| single(&a.element) && a.value("x").is_some()) {
            let _ = writeln!(self.outputs, "  {to} : LREAL;");
            let _ = writeln!(self.behind, "{to} := 0.0;");
            let element = array.element.to_uppercase();
            self.behind += &array.each(&mut self.locals, from, |cell, count| match element.as_str() {
                "BOOL" => format!("IF {cell} THEN {to} := {to} + DINT_TO_LREAL({count}); END_IF;\n"),
                "LREAL" => format!("{to} := {to} + {cell} * DINT_TO_LREAL({count});\n"),
                ty => format!("{to} := {to} + {ty}_TO_LREAL({cell}) * DINT_TO_LREAL({count});\n"),
            });
        } else if let Some((members, _)) = library.types.get(&ty.to_uppercase()) {
            for m in members {
                self.shown(library, &m.ty, &format!("{from}.{}", m.name), &format!("{to}_{}", m.name));
            }
        }
    }
}

/// An elementary type of one word.
fn single(ty: &str) -> bool {
    Elementary::named(ty).is_some_and(|ty| !matches!(ty, Elementary::String(_) | Elementary::Fb(_)))
}

fn is_text(ty: &str) -> bool {
    ty.to_uppercase().starts_with("STRING")
}

/// `ARRAY [1..20, 0..1] OF REAL`.
struct Array {
    bounds: Vec<(String, String)>,
    element: String,
}

impl Array {
    fn of(ty: &str) -> Option<Array> {
        let upper = ty.to_uppercase();
        let (head, element) = upper.strip_prefix("ARRAY")?.split_once(" OF ")?;
        let bounds = head.trim().trim_matches(['[', ']']).split(',');
        let bounds =
            bounds.filter_map(|b| b.trim().split_once("..")).map(|(a, b)| (a.trim().into(), b.trim().into()));
        Some(Array { bounds: bounds.collect(), element: element.trim().to_owned() })
    }

    /// The value of an element from a seed; `#` is its number.
    fn value(&self, seed: &str) -> Option<String> {
        let number = format!("(# * 7 + USINT_TO_DINT({seed})) MOD 23");
        Some(match Elementary::named(&self.element)? {
            Elementary::Bool => format!("({number}) > 11"),
            Elementary::Dint => number,
            ty if ty.is_number() || ty.is_bits() => format!("DINT_TO_{}({number})", self.element),
            _ => return None,
        })
    }

    /// Statements for each element: its name, and its number from 1.
    fn each(&self, locals: &mut String, array: &str, body: impl Fn(&str, &str) -> String) -> String {
        let plain: String = array.chars().filter(|c| c.is_alphanumeric()).collect();
        let counters: Vec<String> = (0..self.bounds.len()).map(|k| format!("k{k}{plain}")).collect();
        let count = format!("n{plain}");
        // Both the filling and the showing of an array go through it.
        if !locals.contains(&format!("  {count} :")) {
            let _ = writeln!(locals, "  {count} : DINT;");
            counters.iter().for_each(|k| locals.push_str(&format!("  {k} : INT;\n")));
        }
        let mut text = format!("{count} := 0;\n");
        for (k, (low, high)) in counters.iter().zip(&self.bounds) {
            let _ = writeln!(text, "FOR {k} := {low} TO {high} DO");
        }
        let element = format!("{array}[{}]", counters.join(", "));
        text += &format!("{count} := {count} + 1;\n{}", body(&element, &count));
        text + &"END_FOR;\n".repeat(counters.len())
    }
}
