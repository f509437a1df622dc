//! How the stages before the first scan grow with the document: the time at n and at 10 n, and
//! their ratio. About 10 is linear; 100 is a search within a search.
//!
//! With an argument only the rows whose name begins so: `growth 'gen st'`.
#![allow(clippy::disallowed_methods, reason = "a stopwatch reads the clock")]

use std::fmt::Write;
use std::hint::black_box;
use std::time::Instant;

use g7_benches::shape::Shape;
use g7_codegen::{Language, Style, plc};
use g7_compile::Compiled;
use g7_model::{Document, FileId};

/// A family of documents: its name, its smaller size, the text of each size.
type Family = (&'static str, usize, fn(usize) -> String);

const FAMILIES: [Family; 6] = [
    ("steps", 1000, |n| Shape::Linear(n).g7()),
    ("charts", 500, charts),
    ("enclosed charts", 500, enclosed),
    ("fork", 1000, fork),
    ("one output", 1000, one_output),
    ("choices", 1000, choices),
];

/// A stage, measured on a document that has been prepared.
type Stage = (&'static str, fn(&Ready));

const STAGES: [Stage; 10] = [
    ("parse", |r| drop(black_box(g7_syntax::parse(&r.text, FileId(0))))),
    ("check", |r| drop(black_box(g7_compile::check(&r.document)))),
    ("draw", |r| {
        let options = g7_draw::Options::default();
        let drawings = g7_draw::draw_all(&r.document, r.document.charts(), &options);
        drop(black_box(g7_draw::sheet(&r.document, &drawings, &options)));
    }),
    ("gen c", |r| code(r, Language::C, Style::Structured)),
    ("gen c --flat", |r| code(r, Language::C, Style::Flat)),
    ("gen rust", |r| code(r, Language::Rust, Style::Structured)),
    ("gen rust --flat", |r| code(r, Language::Rust, Style::Flat)),
    ("gen st", |r| equations(r, plc::Form::St)),
    ("gen il", |r| equations(r, plc::Form::Il)),
    ("gen ld", |r| equations(r, plc::Form::Ld)),
];

fn main() {
    let only = std::env::args().nth(1).unwrap_or_default();
    println!("{:<36}{:>8}{:>12}{:>12}{:>8}", "", "n", "ms at n", "at 10 n", "ratio");
    for (family, n, text) in FAMILIES {
        let wanted = |stage: &str| format!("{stage}, {family}").starts_with(&only);
        if !STAGES.iter().any(|(stage, _)| wanted(stage)) {
            continue;
        }
        let [small, large] = [n, 10 * n].map(|n| Ready::new(text(n)));
        for (stage, run) in STAGES {
            if wanted(stage) {
                let name = format!("{stage}, {family}");
                let (a, b) = (best(7, || run(&small)), best(2, || run(&large)));
                println!("{name:<36}{n:>8}{a:>12.2}{b:>12.2}{:>8.1}", b / a);
            }
        }
    }
}

/// A document at each stage.
struct Ready {
    text: String,
    document: Document,
    compiled: Compiled,
}

impl Ready {
    fn new(text: String) -> Ready {
        let (document, problems) = g7_syntax::parse(&text, FileId(0));
        assert!(problems.is_empty(), "{problems:?}");
        let (compiled, problems) = g7_compile::compile(&document);
        let compiled = compiled.unwrap_or_else(|| panic!("{problems:?}"));
        Ready { text, document, compiled }
    }
}

fn code(r: &Ready, language: Language, style: Style) {
    let options =
        g7_codegen::Options { language, style, room: Default::default(), name: "chart", source: &r.text };
    drop(black_box(g7_codegen::print(&r.compiled, &options)));
}

fn equations(r: &Ready, form: plc::Form) {
    drop(black_box(plc::print(&r.compiled, form, "chart", &r.text)));
}

/// The least time of a few runs in milliseconds, because other programs use the machine too.
fn best(runs: u32, run: impl Fn()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64() * 1e3
    };
    (0..runs).map(time).fold(f64::MAX, f64::min)
}

/// Charts of two steps, each with an output of its own.
fn charts(n: usize) -> String {
    let mut t = String::from("profile iec60848\ninput a : BOOL\n");
    for k in 0..n {
        let _ = writeln!(t, "output q{k} : BOOL");
    }
    for k in 0..n {
        let _ = writeln!(t, "chart C{k} {{\n  initial step 1\n  step 2 {{ N q{k} }}");
        t.push_str("  1 -> 2 when a\n  2 -> 1 when not a\n}\n");
    }
    t
}

/// A ring of enclosing steps, each with a chart of its own.
fn enclosed(n: usize) -> String {
    let mut t = String::from("profile iec60848\ninput a : BOOL\nchart Main {\n  initial step 0\n");
    for k in 1..=n {
        let _ = writeln!(t, "  enclosing step {k} {{ enclose C{k} }}");
    }
    for k in 0..=n {
        let _ = writeln!(t, "  {k} -> {} when a", (k + 1) % (n + 1));
    }
    t.push_str("}\n");
    for k in 1..=n {
        let _ = writeln!(t, "chart C{k} {{\n  step 1 *\n  step 2\n  1 -> 2 when a\n  2 -> 1 when not a\n}}");
    }
    t
}

/// An AND divergence into n branches of one step, and its convergence.
fn fork(n: usize) -> String {
    let branches: Vec<String> = (1..=n).map(|k| k.to_string()).collect();
    let mut t = String::from("profile iec60848\ninput a : BOOL\nchart Main {\n  initial step 0\n");
    for k in &branches {
        let _ = writeln!(t, "  step {k}");
    }
    let all = branches.join(", ");
    let _ = writeln!(t, "  0 -> ({all}) when a\n  ({all}) -> 0 when not a\n}}");
    t
}

/// A ring of n steps that drive one output.
fn one_output(n: usize) -> String {
    let mut t = String::from("profile iec60848\ninput a : BOOL\noutput q : BOOL\nchart Main {\n");
    for k in 0..n {
        let _ = writeln!(t, "  {}step {k} {{ N q }}", if k == 0 { "initial " } else { "" });
    }
    for k in 0..n {
        let _ = writeln!(t, "  {k} -> {} when a", (k + 1) % n);
    }
    t.push_str("}\n");
    t
}

/// Charts of 25 steps in which every other step has three branches, whose receptivities exclude each other:
/// only a solver sees that one step at a time is active.
fn choices(n: usize) -> String {
    let mut t = String::from("profile iec60848\ninput a, b, c, d : BOOL\ninput n : INT\noutput q : BOOL\n");
    for chart in 0..n / 25 {
        let _ = writeln!(t, "chart C{chart} {{");
        for k in 0..25 {
            let _ = writeln!(
                t,
                "  {}step {k} {{ N q if a or X{k}.t > 1s }}",
                if k == 0 { "initial " } else { "" }
            );
        }
        for k in 0..25 {
            let [next, second, third] = [1, 2, 3].map(|i| (k + i) % 25);
            if k % 2 == 1 {
                let _ = writeln!(t, "  {k} -> {next} when a xor (b and n > {k})");
                continue;
            }
            let _ = writeln!(t, "  {k} -> {next} when (a or b) and n < {k} and not (c and d)");
            let _ = writeln!(t, "  {k} -> {second} when (not a or c) and n >= {k} and n < {}", k + 10);
            let _ = writeln!(
                t,
                "  {k} -> {third} when ((b or d) and n > {} or (a and c and d and n < {k}))",
                k + 9
            );
        }
        t.push_str("}\n");
    }
    t
}
