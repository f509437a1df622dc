//! Has matiec translate printed code and plays it beside the engine, scan by scan: many function blocks in one program.
//!
//! `plc` says what the engine does with the same events.
#![allow(clippy::disallowed_methods, reason = "compilers are started")]

use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use g7_codegen::plc::Printed;
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::StepId;
use g7_model::Type;

use super::Subject;
use super::plc::{Event, Seen, difference, played, shown};

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
        Type::Time | Type::Moment(_) => format!("{place} = to_time(word());"),
        _ => format!("{place} = word();"),
    }
}

fn putter(place: &str, ty: Type) -> String {
    match ty {
        Type::Bool => format!("put({place} ? 1 : 0);"),
        Type::Real => format!("put(of_float({place}));"),
        Type::Lreal => format!("put(of_double({place}));"),
        Type::Time | Type::Moment(_) => format!("put(of_time({place}));"),
        Type::Usint
        | Type::Uint
        | Type::Udint
        | Type::Ulint
        | Type::Byte
        | Type::Word
        | Type::Dword
        | Type::Lword => format!("put((uint64_t){place});"),
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

/// A command that ends behind five minutes.
fn limited(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new("timeout");
    command.arg("300").arg(program);
    command
}

fn run(command: &mut Command) -> Result<Vec<u8>, String> {
    let out = command.output().map_err(|e| e.to_string())?;
    if out.status.success() {
        return Ok(out.stdout);
    }
    let said = [&*out.stdout, &*out.stderr].concat();
    Err(String::from_utf8_lossy(&said).lines().take(40).collect::<Vec<_>>().join("\n"))
}

/// Compiles charts with matiec and gcc and compares them with the engine; an error lists the
/// differences. `translate` is the call of matiec for a file in a folder; `library` has the C headers of matiec.
///
/// # Errors
///
/// The code is refused, or it does otherwise than the engine.
pub fn batch(
    translate: &dyn Fn(&Path, &str) -> Command,
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
    run(&mut translate(folder, &file)).map_err(|why| format!("matiec: {why}"))?;
    let gcc = ["-w", "-O0", "-std=gnu99", "-o", "charts", "main.c", "-lm"];
    run(limited("gcc").current_dir(folder).arg("-I").arg(library).args(gcc))?;
    let stdin = std::fs::File::open(folder.join("input")).map_err(|e| e.to_string())?;
    let out = run(limited(folder.join("charts")).stdin(Stdio::from(stdin)))?;
    let words: Vec<u64> = out.as_chunks::<8>().0.iter().map(|c| u64::from_le_bytes(*c)).collect();
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
