//! Compiles many charts as one Rust program.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use g7_codegen::{Clock, Language, Printed, Style};
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::StepId;
use g7_model::Type;

use super::{Subject, run, visible};

const HEAD: &str = r#"
use std::io::{Read, Write};

struct Wires { input: std::io::BufReader<std::io::Stdin>, out: std::io::BufWriter<std::io::Stdout> }

impl Wires {
    fn get<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut b = [0; N];
        self.input.read_exact(&mut b).ok().map(|()| b)
    }
    fn word(&mut self) -> u64 { u64::from_le_bytes(self.get().expect("a word")) }
    fn put(&mut self, w: u64) { self.out.write_all(&w.to_le_bytes()).expect("a pipe"); }
    fn put_text(&mut self, a: &[u8]) {
        self.put(u64::from(a[0]) | u64::from(a[1]) << 8);
        for chunk in a[2..].chunks(8) { self.put(chunk.iter().rev().fold(0, |w, b| w << 8 | u64::from(*b))); }
    }
    fn get_text(&mut self, a: &mut [u8]) {
        let size = self.word();
        a[0] = size as u8; a[1] = (size >> 8) as u8;
        for chunk in a[2..].chunks_mut(8) {
            let w = self.word();
            for (k, b) in chunk.iter_mut().enumerate() { *b = (w >> (8 * k)) as u8; }
        }
    }
}
"#;

fn getter(place: &str, v: &Variable) -> String {
    match v.ty {
        Type::Bool => format!("{place} = w.word() != 0;"),
        Type::Real => format!("{place} = f32::from_bits(w.word() as u32);"),
        Type::Lreal => format!("{place} = f64::from_bits(w.word());"),
        Type::String(_) => format!("w.get_text(&mut {place});"),
        _ => format!("{place} = w.word() as _;"),
    }
}

fn putter(place: &str, v: &Variable) -> String {
    match v.ty {
        Type::Bool => format!("w.put(u64::from({place}));"),
        Type::Real => {
            format!("w.put(if {place}.is_nan() {{ 0x7fc0_0000 }} else {{ u64::from({place}.to_bits()) }});")
        }
        Type::Lreal => {
            format!("w.put(if {place}.is_nan() {{ 0x7ff8_0000_0000_0000 }} else {{ {place}.to_bits() }});")
        }
        Type::String(_) => format!("w.put_text(&{place});"),
        Type::Usint
        | Type::Uint
        | Type::Udint
        | Type::Ulint
        | Type::Byte
        | Type::Word
        | Type::Dword
        | Type::Lword => format!("w.put({place} as u64);"),
        _ => format!("w.put({place} as i64 as u64);"),
    }
}

fn each(path: &str, v: &Variable, line: fn(&str, &Variable) -> String) -> String {
    let place = |i: u32| if v.elements == 1 { path.to_owned() } else { format!("{path}[{i}]") };
    (0..v.elements).map(|i| format!("        {}\n", line(&place(i), v))).collect()
}

fn player(subject: &Subject, printed: &Printed, name: &str) -> String {
    let symbols = &subject.compiled.symbols;
    let mut t = String::new();
    let outputs: u32 =
        visible(&subject.compiled).filter(|v| v.class == VarClass::Output).map(|v| v.words()).sum();
    let all: u32 = visible(&subject.compiled).map(|v| v.words()).sum();
    let _ = writeln!(
        t,
        "fn play_{name}(w: &mut Wires) {{\n    use charts::{name}::*;\n    let mut s = Box::new(State::new());\n    \
         let mut input = Inputs::new();\n    let mut out = Outputs::new();\n    let _ = &mut input;\n    let mut in_place = false;\n    while let Some([event]) = w.get::<1>() {{\n        \
         if event == 0 {{ break; }}\n        if event == 3 {{ init(&mut s); continue; }}\n        \
         if event == 2 {{ restart(&mut s); continue; }}\n        let now = (w.word() as i64 / {}) as {};",
        subject.room.clock.nanoseconds(),
        if subject.room.clock == Clock::Nanoseconds { "i64" } else { "u32" }
    );
    for v in visible(&subject.compiled).filter(|v| v.class == VarClass::Input) {
        let path = printed.places.variable(v.addr).unwrap_or("missing").replacen("inputs.", "input.", 1);
        t += &each(&path, v, getter);
    }
    // Both ways to make a scan take turns.
    let _ = writeln!(
        t,
        "        in_place = !in_place;\n        let fault = if in_place {{ s.inputs = input; \
         let fault = scan_in_place(&mut s, now); out = s.outputs; fault }} \
         else {{ scan(&input, &mut out, &mut s, now) }};\n        w.put(fault.into());"
    );
    let _ =
        writeln!(t, "        w.put(if fault != 0 {{ {outputs} }} else {{ {} }});", all + 2 * symbols.steps());
    t += "        if fault == 0 {\n";
    for i in 0..symbols.steps() {
        let step = printed.places.step(StepId(i));
        let _ = writeln!(t, "        w.put(is_active(&s, {step}).into());");
        let _ = writeln!(t, "        w.put(step_time(&s, {step}) as u64);");
    }
    t += "        }\n";
    for v in visible(&subject.compiled) {
        let path = format!("s.{}", printed.places.variable(v.addr).unwrap_or("missing"));
        if v.class == VarClass::Output {
            t += &each(&path.replacen("s.outputs.", "out.", 1), v, putter);
        } else {
            t += "        if fault == 0 {\n";
            t += &each(&path, v, putter);
            t += "        }\n";
        }
    }
    t += "    }\n}\n";
    t
}

/// Generates Rust for charts and compiles them into one program: the modules form a library without
/// the standard library, in which no warning is allowed.
///
/// # Errors
///
/// The messages of the compiler, or what cannot be generated.
pub fn rust_program(folder: &Path, style: Style, subjects: &[&Subject]) -> Result<PathBuf, String> {
    std::fs::create_dir_all(folder).map_err(|e| e.to_string())?;
    let mut library = String::from("#![no_std]\n#![forbid(unsafe_code)]\n#![deny(warnings)]\n");
    let mut main = String::from(HEAD);
    let mut table = String::new();
    for (i, subject) in subjects.iter().enumerate() {
        let name = format!("c{i}");
        let printed =
            subject.print(Language::Rust, style, &name).map_err(|e| format!("{}: {e}", subject.title))?;
        for file in &printed.files {
            std::fs::write(folder.join(&file.name), &file.text).map_err(|e| e.to_string())?;
        }
        let _ = writeln!(library, "pub mod {name};");
        main += &player(subject, &printed, &name);
        let _ = writeln!(table, "            {i} => play_{name}(&mut w),");
    }
    let _ = writeln!(
        main,
        "fn main() {{\n    let mut w = Wires {{ input: std::io::BufReader::new(std::io::stdin()), \
         out: std::io::BufWriter::new(std::io::stdout()) }};\n    while let Some(chart) = w.get::<4>() {{\n        \
         match u32::from_le_bytes(chart) {{\n{table}            _ => std::process::exit(2),\n        }}\n    }}\n}}"
    );
    std::fs::write(folder.join("charts.rs"), library).map_err(|e| e.to_string())?;
    std::fs::write(folder.join("main.rs"), main).map_err(|e| e.to_string())?;
    let rustc = || {
        let mut c = Command::new("rustc");
        c.args(["--edition", "2024", "-C", "overflow-checks=on"]).current_dir(folder);
        c
    };
    run(rustc().args(["--crate-type", "lib", "charts.rs"]))?;
    run(rustc().args(["-A", "warnings", "--extern", "charts=libcharts.rlib", "-o", "charts", "main.rs"]))?;
    Ok(folder.join("charts"))
}
