//! Code for PLCs behaves like the engine, scan by scan, when a foreign compiler (matiec, `iec2c` on
//! the PATH) translates it to C: situation, outputs and variables, on every conformance case that
//! can be printed.
//!
//! `g7_peers::matiec` finds the compiler; the folder with the code is kept if `G7_KEEP` is set.
#![allow(clippy::disallowed_methods, reason = "the tests start compilers")]

use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use g7_codegen::plc::{Form, Printed};
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::StepId;
use g7_model::{ProfileName, Type};
use g7_peers::Matiec;
use g7_peers::mended::mended;
use g7_tests::generated::Subject;
use g7_tests::generated::cases::{self, Folder};
use g7_tests::generated::plc::{Event, Prints, Seen, difference, played, prints, shown};

const HEAD: &str = r#"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <stdint.h>
#include "iec_std_lib.h"
TIME __CURRENT_TIME;
BOOL __DEBUG;
#include "accessor.h"
#include "POUS.h"
#include "POUS.c"
static void put(uint64_t w) { (void)fwrite(&w, sizeof w, 1, stdout); }
static int get(uint64_t *w) { return fread(w, sizeof *w, 1, stdin) == 1; }
static uint64_t word(void) { uint64_t w = 0; if (!get(&w)) { exit(3); } return w; }
static uint64_t of_float(float v) { uint32_t w; memcpy(&w, &v, 4); return w; }
static uint64_t of_double(double v) { uint64_t w; memcpy(&w, &v, 8); return w; }
static float to_float(uint64_t w) { float v; const uint32_t u = (uint32_t)w; memcpy(&v, &u, 4); return v; }
static double to_double(uint64_t w) { double v; memcpy(&v, &w, 8); return v; }
static uint64_t of_time(TIME t) { return (uint64_t)((int64_t)t.tv_sec * 1000000000 + t.tv_nsec); }
static TIME to_time(uint64_t w) { TIME t; t.tv_sec = (int64_t)w / 1000000000; t.tv_nsec = (int64_t)w % 1000000000; return t; }
"#;

fn getter(place: &str, ty: Type) -> String {
    match ty {
        Type::Bool => format!("{place} = word() != 0;"),
        Type::Real => format!("{place} = to_float(word());"),
        Type::Lreal => format!("{place} = to_double(word());"),
        Type::Time => format!("{place} = to_time(word());"),
        _ => format!("{place} = word();"),
    }
}

fn putter(place: &str, ty: Type) -> String {
    match ty {
        Type::Bool => format!("put({place} ? 1 : 0);"),
        Type::Real => format!("put(of_float({place}));"),
        Type::Lreal => format!("put(of_double({place}));"),
        Type::Time => format!("put(of_time({place}));"),
        Type::Usint | Type::Uint | Type::Udint | Type::Ulint => format!("put((uint64_t){place});"),
        _ => format!("put((uint64_t)(int64_t){place});"),
    }
}

fn each(name: &str, v: &Variable, line: fn(&str, Type) -> String) -> String {
    let place = |i: u32| {
        if v.elements == 1 { format!("d.{name}.value") } else { format!("d.{name}.value.table[{i}]") }
    };
    (0..v.elements).map(|i| format!("    {}\n", line(&place(i), v.ty))).collect()
}

/// The part of the C program that plays one chart.
fn player(s: &Subject, printed: &Printed) -> String {
    let block = printed.name.to_uppercase();
    let fault = printed.text.contains("FAULT : BOOL");
    let mut t = format!(
        "static void play_{block}(void)\n{{\n  static {block} d;\n  for (uint64_t event = word(); event; event = word()) {{\n    \
         if (event == 3) {{ memset(&d, 0, sizeof d); {block}_init__(&d, 0); continue; }}\n    \
         __CURRENT_TIME = to_time(word());\n"
    );
    let shown = shown(s, printed);
    for (v, name) in shown.iter().filter(|(v, _)| v.class == VarClass::Input) {
        t += &each(name, v, getter);
    }
    let _ = writeln!(t, "    {block}_body__(&d);");
    let fault = if fault { "d.FAULT.value" } else { "0" };
    let outputs: u32 =
        shown.iter().filter(|(v, _)| v.class == VarClass::Output).map(|(v, _)| v.elements).sum();
    let all: u32 = shown.iter().map(|(v, _)| v.elements).sum();
    let steps = s.compiled.symbols.steps();
    let _ = writeln!(t, "    put({fault} ? 1 : 0); put({fault} ? {outputs} : {});", all + steps);
    let _ = writeln!(t, "    if (!{fault}) {{");
    for i in 0..steps {
        let _ = writeln!(t, "    put(d.{}.value ? 1 : 0);", printed.step(StepId(i)).to_uppercase());
    }
    t += "    }\n";
    for (v, name) in &shown {
        let lines = each(name, v, putter);
        if v.class == VarClass::Output {
            t += &lines;
        } else {
            let _ = writeln!(t, "    if (!{fault}) {{\n{lines}    }}");
        }
    }
    t += "  }\n}\n";
    t
}

fn run(command: &mut Command) -> Result<Vec<u8>, String> {
    let out = command.output().map_err(|e| e.to_string())?;
    if out.status.success() {
        return Ok(out.stdout);
    }
    let said = [&*out.stdout, &*out.stderr].concat();
    Err(String::from_utf8_lossy(&said).lines().take(40).collect::<Vec<_>>().join("\n"))
}

/// Cases in which matiec itself behaves differently, with the reason.
const NOT_IN_MATIEC: [(&str, &str); 1] =
    [("iec61131/real-overflow-is-no-fault", "it refuses a LREAL of 1.0E308: it takes the limits of REAL")];

/// Compiles charts with matiec and gcc and compares them with the engine; an error lists the
/// differences. `library` has the C headers of matiec.
fn batch(
    matiec: &Matiec,
    library: &Path,
    folder: &Path,
    ending: &str,
    list: &[(&Subject, Printed)],
) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|e| e.to_string())?;
    let mut code = String::new();
    let mut main = HEAD.to_owned();
    let (mut table, mut input) = (String::new(), Vec::new());
    let mut expected = Vec::new();
    for (i, (s, printed)) in list.iter().enumerate() {
        code += &printed.text;
        code.push('\n');
        main += &player(s, printed);
        let _ = writeln!(table, "    case {i}: play_{}(); break;", printed.name.to_uppercase());
        let (events, seen) = played(s, printed)?;
        input.push(i as u64);
        for event in events {
            match event {
                Event::Start => input.push(3),
                Event::Scan { now, inputs } => {
                    input.extend([1, now as u64]);
                    input.extend(inputs);
                }
            }
        }
        input.push(0);
        expected.push(seen);
    }
    let _ = writeln!(
        main,
        "int main(void)\n{{\n  uint64_t chart;\n  while (get(&chart)) {{\n    switch (chart) {{\n{table}    \
         default: return 2;\n    }}\n    fflush(stdout);\n  }}\n  return 0;\n}}"
    );
    let file = format!("charts.{ending}");
    std::fs::write(folder.join(&file), code).map_err(|e| e.to_string())?;
    std::fs::write(folder.join("main.c"), main).map_err(|e| e.to_string())?;
    let bytes: Vec<u8> = input.iter().flat_map(|w| w.to_le_bytes()).collect();
    std::fs::write(folder.join("input"), bytes).map_err(|e| e.to_string())?;
    run(&mut matiec.translate(folder, &file)).map_err(|why| format!("matiec: {why}"))?;
    let gcc = ["-w", "-O0", "-std=gnu99", "-o", "charts", "main.c", "-lm"];
    run(Command::new("gcc").current_dir(folder).arg("-I").arg(library).args(gcc))?;
    let stdin = std::fs::File::open(folder.join("input")).map_err(|e| e.to_string())?;
    let out = run(Command::new(folder.join("charts")).stdin(Stdio::from(stdin)))?;
    let words: Vec<u64> =
        out.chunks_exact(8).map(|c| u64::from_le_bytes(c.try_into().expect("8 bytes"))).collect();
    let mut at = 0;
    let mut wrong = Vec::new();
    for ((s, printed), seen) in list.iter().zip(&expected) {
        let mut said = false;
        for (k, want) in seen.iter().enumerate() {
            let stopped = words.get(at).copied().ok_or("it ended early")? != 0;
            let n = words.get(at + 1).copied().ok_or("it ended early")? as usize;
            let got =
                Seen { stopped, words: words.get(at + 2..at + 2 + n).ok_or("it ended early")?.to_vec() };
            at += 2 + n;
            if got != *want && !said {
                said = true;
                wrong.push(format!(
                    "{} ({}): scan {k}: {}",
                    s.title,
                    printed.name,
                    difference(s, printed, want, &got)
                ));
            }
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}

/// Prints, compiles, runs and compares subjects; prints how many agree and why others cannot be
/// printed.
fn agrees(name: &str, form: Form, ending: &str, subjects: &[Subject]) -> usize {
    let Prints { mut list, refused } = prints(subjects, form).unwrap_or_else(|e| panic!("{e}"));
    println!("{name}: {} of {} printed", list.len(), subjects.len());
    for (why, n) in &refused {
        println!("  {n} refused: {why}");
    }
    let Some(matiec) = g7_peers::matiec() else { return list.len() };
    for (case, why) in NOT_IN_MATIEC {
        let all = list.len();
        list.retain(|(s, _)| !s.title.starts_with(case));
        println!("  {} left out, matiec: {why}", all - list.len());
    }
    let folder = Folder::new(&format!("plc-{name}"));
    let library = folder.0.join("C");
    mended(&matiec.lib.join("C"), &library).unwrap_or_else(|e| panic!("{}: {e}", matiec.lib.display()));
    for (i, part) in list.chunks(40).enumerate() {
        if let Err(why) = batch(&matiec, &library, &folder.0.join(i.to_string()), ending, part) {
            panic!("{name}: {why}");
        }
    }
    println!("  {} agree", list.len());
    list.len()
}

/// Every conformance case with a trace.
fn spec() -> Vec<Subject> {
    cases::spec().unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn cases_in_structured_text() {
    let agree = agrees("st", Form::St, "st", &spec());
    assert!(agree > 300, "only {agree} cases can be printed");
}

#[test]
fn cases_in_instruction_list() {
    let agree = agrees("il", Form::Il, "il", &spec());
    assert!(agree > 300, "only {agree} cases can be printed");
}

#[test]
fn cases_in_the_manner_of_dolog80() {
    let agree = agrees("dolog80", Form::Dolog80, "il", &spec());
    assert!(agree > 300, "only {agree} cases can be printed");
}

fn random_charts(name: &str, form: Form, ending: &str, charts: usize) {
    for profile in [
        ProfileName::Iec60848,
        ProfileName::Iec61131,
        ProfileName::Pl7,
        ProfileName::Unity,
        ProfileName::Jgrafchart,
    ] {
        let subjects =
            cases::random(profile, 1, 200, |s| s.len() >= charts).unwrap_or_else(|e| panic!("{e}"));
        let agree = agrees(&format!("{name}-{}", profile.name()), form, ending, &subjects);
        assert!(agree > 0, "no chart of {} can be printed", profile.name());
    }
}

#[test]
fn random_charts_in_structured_text() {
    random_charts("st", Form::St, "st", 60);
}

#[test]
fn random_charts_in_instruction_list() {
    random_charts("il", Form::Il, "il", 20);
    random_charts("dolog80", Form::Dolog80, "il", 20);
}
