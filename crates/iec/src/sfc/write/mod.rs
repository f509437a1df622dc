//! Writes a document as IEC 61131-3 text.
//!
//! Charts with the same period evolve together, so they become networks of one program, each with
//! its own initial step. Code before and behind the charts, and charts with another period, become
//! separate programs that share global variables.

mod chart;

use std::collections::HashSet;

use g7_model::{
    Arg, Body, Chart, Composed, Document, Expr, ExprKind, Function, Item, Nanos, Problem, Span, Type,
    ValueType, VarDecl, VarKind, codes, say,
};

use crate::Written;
use crate::nodes::{self, Taken};
use crate::st::{Known, Writer};
use crate::standard::{Form, standard};

/// The content of a program of the file.
struct Program<'d> {
    name: String,
    chart: Option<&'d Chart>,
    body: String,
}

/// Writes a document.
pub fn export(document: &Document) -> Written {
    let (document, mut problems) = standard(document, Form::Networks { drawn: false });
    let mut exporter = Exporter::new(&document);
    let text = exporter.text();
    problems.append(&mut exporter.problems);
    problems.sort_by_key(|p| (p.at.start, p.at.end));
    Written { text, problems }
}

struct Exporter<'d> {
    document: &'d Document,
    taken: Taken,
    problems: Vec<Problem>,
}

impl<'d> Exporter<'d> {
    fn new(document: &'d Document) -> Exporter<'d> {
        Exporter { document, taken: Taken::of(document), problems: Vec::new() }
    }

    fn text(&mut self) -> String {
        let document = self.document;
        let mut text = String::new();
        for item in &document.items {
            if let Item::Function(f) = item {
                text.push_str(&self.function(f));
            }
        }
        for item in &document.items {
            if let Item::Composed(c) = item
                && c.block
            {
                text.push_str(&self.function_block(c));
            }
        }
        if !text.is_empty() {
            text.push('\n');
        }
        text.insert_str(0, &types(document));
        let programs = self.programs();
        let alone = programs.len() == 1;
        let globals: Vec<&VarDecl> =
            document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v) } else { None }).collect();
        let used: Vec<HashSet<&str>> = programs.iter().map(|p| words(&p.body)).collect();
        let first = programs.iter().position(|p| p.chart.is_some()).unwrap_or(0);
        for (number, (program, own)) in programs.iter().zip(&used).enumerate() {
            let mut declarations = Declarations::default();
            for decl in &globals {
                for name in &decl.names {
                    let text = &*name.text;
                    let idle = number == first && !used.iter().any(|u| u.contains(text));
                    if alone || local(decl, text, &used) && (own.contains(text) || idle) {
                        declarations.own(decl, text);
                    } else if !local(decl, text, &used) && own.contains(text) {
                        declarations.external(decl, text);
                    }
                }
            }
            for decl in program.chart.into_iter().flat_map(Chart::vars) {
                decl.names.iter().for_each(|n| declarations.own(decl, &n.text));
            }
            if !alone && declarations.sections.is_empty() {
                // Some compilers refuse a program that declares nothing.
                let shared = |d: &&VarDecl, n: &g7_model::Name| !local(d, &n.text, &used);
                let of_decl = |d: &&VarDecl| d.names.iter().any(|n| shared(d, n));
                if let Some(decl) = globals.iter().copied().find(of_decl)
                    && let Some(name) = decl.names.iter().find(|n| shared(&decl, n))
                {
                    declarations.external(decl, &name.text);
                }
            }
            if declarations.sections.is_empty() {
                let at = program.chart.map_or(Span::default(), |c| c.name.at.0);
                declarations
                    .own(&nodes::variable(VarKind::Var, "", Type::Bool, at), &self.taken.give("Unused"));
            }
            let body = if program.body.is_empty() { "  ;\n" } else { &program.body };
            text.push_str(&format!(
                "PROGRAM {}\n{}\n{body}END_PROGRAM\n",
                program.name,
                declarations.print(1)
            ));
            if !alone {
                text.push('\n');
            }
        }
        let mut shared = Declarations::default();
        for decl in globals.iter().filter(|_| !alone) {
            for name in decl.names.iter().filter(|n| !local(decl, &n.text, &used)) {
                if decl.ty != Type::STRING && matches!(decl.ty, Type::String(_)) {
                    let what = say!(
                        "`{}` is a STRING of several programs, which compilers take without a length alone",
                        name.text
                    );
                    self.problems.push(Problem::new(&codes::DIFFERENT, decl.at.0, what));
                }
                shared.global(decl, &name.text);
            }
        }
        let scan = document.cycle();
        let paced = programs.iter().any(|p| p.chart.is_some_and(|c| c.every.is_some()));
        if scan.is_some() || paced || !alone {
            text.push_str(&self.configuration(&programs, scan, &shared));
        }
        text
    }

    /// The resource that runs the programs.
    fn configuration(&mut self, programs: &[Program], scan: Option<Nanos>, shared: &Declarations) -> String {
        const SCAN: Nanos = Nanos::from_millis(10);
        // Some tools require a period in every resource.
        let scan = scan.unwrap_or(SCAN);
        let (config, resource) = (self.taken.give("Config"), self.taken.give("Res"));
        let mut tasks: Vec<(Nanos, String)> = Vec::new();
        let mut lines = String::new();
        let mut runs = String::new();
        // The time of a scan is written even if all charts are slower.
        let paces = programs.iter().map(|p| p.chart.and_then(|c| c.every).unwrap_or(scan));
        for pace in std::iter::once(scan).chain(paces.clone()) {
            if !tasks.iter().any(|t| t.0 == pace) {
                let (name, number) = (self.taken.give("Cycle"), tasks.len());
                lines.push_str(&format!("    TASK {name}(INTERVAL := {pace:#}, PRIORITY := {number});\n"));
                tasks.push((pace, name));
            }
        }
        for (program, pace) in programs.iter().zip(paces) {
            let task = tasks.iter().find(|t| t.0 == pace).map_or("", |t| &t.1);
            let instance = self.taken.give("Instance");
            runs.push_str(&format!("    PROGRAM {instance} WITH {task} : {};\n", program.name));
        }
        format!(
            "\nCONFIGURATION {config}\n{}  RESOURCE {resource} ON PLC\n{lines}{runs}  END_RESOURCE\nEND_CONFIGURATION\n",
            shared.print(1)
        )
    }

    /// The programs in execution order.
    fn programs(&mut self) -> Vec<Program<'d>> {
        let document = self.document;
        let types = Known::new(document, None);
        let body = |code: &Body| {
            let mut text = String::new();
            Writer { types: &types }.statements(&code.block().statements, 1, &mut text);
            text
        };
        let mut programs = Vec::new();
        let charts = document.charts().count();
        for item in &document.items {
            let (name, code) = match item {
                Item::Pre(code, _) => ("Pre", code),
                _ => continue,
            };
            let name = self.taken.give(if charts == 0 { "Main" } else { name });
            programs.push(Program { name, chart: None, body: body(code) });
        }
        for chart in document.charts() {
            self.problems.extend(crate::standard::without_steps(chart));
            let body = self.chart(chart);
            programs.push(Program { name: chart.name.text.to_string(), chart: Some(chart), body });
        }
        for item in &document.items {
            if let Item::Post(code, _) = item {
                programs.push(Program { name: self.taken.give("Post"), chart: None, body: body(code) });
            }
        }
        if programs.is_empty() {
            programs.push(Program { name: self.taken.give("Main"), chart: None, body: String::new() });
        }
        programs
    }

    fn function_block(&self, c: &'d Composed) -> String {
        let mut declarations = Declarations::default();
        for decl in &c.members {
            decl.names.iter().for_each(|n| declarations.own(decl, &n.text));
        }
        for decl in &c.inouts {
            decl.names.iter().for_each(|n| declarations.add("VAR_IN_OUT", line(decl, &n.text)));
        }
        let types = Known::of_block(self.document, c);
        let mut body = String::new();
        if let Some(code) = &c.body {
            Writer { types: &types }.statements(&code.block().statements, 1, &mut body);
        }
        if body.is_empty() {
            body.push_str("  ;\n");
        }
        let comment = c.comment.as_ref().map_or_else(String::new, |c| format!("  (* {} *)\n", clean(c)));
        let (name, declarations) = (&c.name.text, declarations.print(1));
        format!("FUNCTION_BLOCK {name}\n{comment}{declarations}\n{body}END_FUNCTION_BLOCK\n\n")
    }

    fn function(&self, f: &'d Function) -> String {
        let mut text = format!("FUNCTION {} : {}\n", f.name.text, value_type(&f.result));
        let mut types = Known::new(self.document, None).own(&f.name.text, f.result.base);
        if !f.params.is_empty() {
            text.push_str("  VAR_INPUT\n");
            for p in &f.params {
                text.push_str(&format!("    {} : {};\n", p.name.text, value_type(&p.ty)));
                types = types.own(&p.name.text, p.ty.base);
            }
            text.push_str("  END_VAR\n");
        }
        if !f.body.locals.is_empty() {
            text.push_str("  VAR\n");
            for local in &f.body.locals {
                let init = initial(local.init.as_ref(), local.ty.base);
                for name in &local.names {
                    text.push_str(&format!("    {} : {}{init};\n", name.text, value_type(&local.ty)));
                    types = types.own(&name.text, local.ty.base);
                }
            }
            text.push_str("  END_VAR\n");
        }
        Writer { types: &types }.statements(&f.body.statements, 1, &mut text);
        text.push_str("END_FUNCTION\n\n");
        text
    }
}

/// A function block that only one program uses is declared there, because few tools allow global
/// ones, and so is a text, because the standard has no length of one that is external.
fn local(decl: &VarDecl, name: &str, used: &[HashSet<&str>]) -> bool {
    (decl.is_instance() || matches!(decl.ty, Type::String(_)))
        && used.iter().filter(|u| u.contains(name)).count() < 2
}

/// The set of words in a text.
fn words(text: &str) -> HashSet<&str> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect()
}

/// ` := value`, ` := [1, 2, 3(0)]`, or ` := (a := 1, b := 2)`.
fn initial(init: Option<&Expr>, ty: Type) -> String {
    init.map_or_else(String::new, |e| format!(" := {}", initial_value(e, Some(ty))))
}

/// An initial value; `ty` is the type of the elements of an array and unknown for the fields of a structure.
fn initial_value(e: &Expr, ty: Option<Type>) -> String {
    let types = Known::default();
    let writer = Writer { types: &types };
    let one = |(times, e): &(u32, Expr)| match times {
        1 => initial_value(e, ty),
        n => format!("{n}({})", initial_value(e, ty)),
    };
    let field = |f: &Arg| {
        let name = f.name.as_ref().map_or("", |n| &n.text);
        format!("{name} := {}", initial_value(&f.value, None))
    };
    match (&e.kind, ty) {
        (ExprKind::List(values), _) => format!("[{}]", values.iter().map(one).collect::<Vec<_>>().join(", ")),
        (ExprKind::Call(_, fields), _) => {
            format!("({})", fields.iter().map(field).collect::<Vec<_>>().join(", "))
        }
        (_, Some(ty)) => writer.value(e, ty),
        (_, None) => writer.plain(e),
    }
}

/// A comment must not contain the sign that ends it.
fn clean(text: &str) -> String {
    text.replace("*)", "* )").replace("(*", "( *").replace(['\n', '\r'], " ")
}

/// The type of a parameter, of a local variable or of a result.
fn value_type(ty: &ValueType) -> String {
    ty.of.as_ref().map_or_else(|| type_name(ty.base), |of| of.text.to_string())
}

fn type_name(ty: Type) -> String {
    match ty {
        Type::STRING => "STRING".to_string(),
        Type::String(n) => format!("STRING[{n}]"),
        other => other.to_string(),
    }
}

/// The sections of declarations, in the order in which they were met.
#[derive(Default)]
struct Declarations {
    sections: Vec<(&'static str, Vec<String>)>,
}

impl Declarations {
    fn add(&mut self, section: &'static str, line: String) {
        match self.sections.last_mut().filter(|(s, _)| *s == section) {
            Some((_, lines)) => lines.push(line),
            None => self.sections.push((section, vec![line])),
        }
    }

    /// A variable of the program.
    fn own(&mut self, decl: &VarDecl, name: &str) {
        let section = match (decl.kind, decl.address.is_some()) {
            (VarKind::Const, _) => "VAR CONSTANT",
            (VarKind::Var, true) if decl.retain => "VAR RETAIN (* at addresses *)",
            (_, true) => "VAR (* at addresses *)",
            (VarKind::Input, false) => "VAR_INPUT",
            (VarKind::Output, false) => "VAR_OUTPUT",
            (VarKind::Var, false) if decl.retain => "VAR RETAIN",
            (VarKind::Var, false) => "VAR",
        };
        self.add(section, line(decl, name));
    }

    /// Declares a variable of all programs; its comment states its purpose.
    fn global(&mut self, decl: &VarDecl, name: &str) {
        let section = match decl.kind {
            VarKind::Const => "VAR_GLOBAL CONSTANT",
            VarKind::Input => "VAR_GLOBAL (* inputs *)",
            VarKind::Output => "VAR_GLOBAL (* outputs *)",
            VarKind::Var if decl.retain => "VAR_GLOBAL RETAIN",
            VarKind::Var => "VAR_GLOBAL",
        };
        self.add(section, line_of(decl, name, shared_type(decl)));
    }

    /// The same variable, as a program refers to it.
    fn external(&mut self, decl: &VarDecl, name: &str) {
        let section = match decl.kind {
            VarKind::Const => "VAR_EXTERNAL CONSTANT",
            _ => "VAR_EXTERNAL",
        };
        self.add(section, format!("{name} : {};", shared_type(decl)));
    }

    fn print(&self, indent: usize) -> String {
        let pad = "  ".repeat(indent);
        let mut out = String::new();
        for (section, lines) in &self.sections {
            out.push_str(&format!("{pad}{section}\n"));
            for line in lines {
                out.push_str(&format!("{pad}  {line}\n"));
            }
            out.push_str(&format!("{pad}END_VAR\n"));
        }
        out
    }
}

/// A type as variables of several programs have it: without the length of a text.
fn shared_type(decl: &VarDecl) -> String {
    if decl.of.is_none() && matches!(decl.ty, Type::String(_)) { "STRING".to_string() } else { type_of(decl) }
}

/// The type of a variable; that of an array has a name.
fn type_of(decl: &VarDecl) -> String {
    decl.of.as_ref().map_or_else(|| type_name(decl.ty), |of| of.text.to_string())
}

/// The enumerations, the types of arrays, and the structures.
fn types(document: &Document) -> String {
    let types = Known::default();
    let bound = |e: &Expr| Writer { types: &types }.plain(e);
    let mut lines = String::new();
    for item in &document.items {
        match item {
            Item::Type(decl) => {
                let Some(name) = decl.names.first() else { continue };
                let Some(array) = &decl.array else {
                    let values: Vec<&str> = decl.values().iter().map(|(value, _)| &*value.text).collect();
                    lines.push_str(&format!("  {} : ({});\n", name.text, values.join(", ")));
                    continue;
                };
                let range = |(low, high): &(Expr, Expr)| format!("{}..{}", bound(low), bound(high));
                let bounds: Vec<String> = array.dimensions.iter().map(range).collect();
                let bounds = bounds.join(", ");
                lines.push_str(&format!("  {} : ARRAY[{bounds}] OF {};\n", name.text, type_of(decl)));
            }
            Item::Composed(c) if !c.block => lines.push_str(&structure(c)),
            _ => {}
        }
    }
    if lines.is_empty() { lines } else { format!("TYPE\n{lines}END_TYPE\n\n") }
}

fn structure(c: &Composed) -> String {
    let comment = c.comment.as_ref().map_or_else(String::new, |c| format!(" (* {} *)", clean(c)));
    let mut text = format!("  {} : STRUCT{comment}\n", c.name.text);
    for decl in &c.members {
        decl.names.iter().for_each(|name| text.push_str(&format!("    {}\n", line(decl, &name.text))));
    }
    text + "  END_STRUCT;\n"
}

fn line(decl: &VarDecl, name: &str) -> String {
    line_of(decl, name, type_of(decl))
}

fn line_of(decl: &VarDecl, name: &str, ty: String) -> String {
    let at = decl.address.as_ref().map_or(String::new(), |a| format!(" AT {}", a.text));
    let init = initial(decl.init.as_ref(), decl.ty);
    let comment = decl.comment.as_ref().map_or(String::new(), |c| format!(" (* {} *)", clean(c)));
    format!("{name}{at} : {ty}{init};{comment}")
}
