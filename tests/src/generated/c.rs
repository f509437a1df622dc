//! Compiles many charts as one C program.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use g7_codegen::{Clock, Language, Parts, Printed, Style};
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::StepId;
use g7_model::Type;

use super::{Subject, run, visible};

const HEAD: &str = r#"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <stdint.h>
#include <stdbool.h>

static void put(uint64_t w) { (void)fwrite(&w, sizeof w, 1, stdout); }
static bool get(void *to, size_t size) { return fread(to, size, 1, stdin) == 1; }
static uint64_t word(void) { uint64_t w = 0; if (!get(&w, sizeof w)) { exit(3); } return w; }
static uint64_t of_float(float v) { uint32_t w; if (v != v) { return 0x7fc00000; } memcpy(&w, &v, 4); return w; }
static uint64_t of_double(double v) { uint64_t w; if (v != v) { return 0x7ff8000000000000; } memcpy(&w, &v, 8); return w; }
static float to_float(uint64_t w) { float v; const uint32_t u = (uint32_t)w; memcpy(&v, &u, 4); return v; }
static double to_double(uint64_t w) { double v; memcpy(&v, &w, 8); return v; }
static void put_text(const uint8_t *a, unsigned most)
{
    put((uint64_t)a[0] | (uint64_t)a[1] << 8);
    for (unsigned k = 0; k < (most + 7) / 8; k++) {
        uint64_t w = 0;
        for (unsigned j = 0; j < 8 && 8 * k + j < most; j++) { w |= (uint64_t)a[2 + 8 * k + j] << (8 * j); }
        put(w);
    }
}
static void get_text(uint8_t *a, unsigned most)
{
    const uint64_t size = word();
    memset(a, 0, most + 2);
    a[0] = (uint8_t)size; a[1] = (uint8_t)(size >> 8);
    for (unsigned k = 0; k < (most + 7) / 8; k++) {
        const uint64_t w = word();
        for (unsigned j = 0; j < 8 && 8 * k + j < most; j++) { a[2 + 8 * k + j] = (uint8_t)(w >> (8 * j)); }
    }
}
"#;

fn c_type(ty: Type) -> &'static str {
    match ty {
        Type::Sint => "int8_t",
        Type::Int => "int16_t",
        Type::Dint => "int32_t",
        Type::Usint | Type::Byte => "uint8_t",
        Type::Uint | Type::Word => "uint16_t",
        Type::Udint | Type::Dword => "uint32_t",
        Type::Ulint | Type::Lword => "uint64_t",
        _ => "int64_t",
    }
}

/// C code that reads a variable from the input words.
fn getter(place: &str, v: &Variable) -> String {
    match v.ty {
        Type::Bool => format!("{place} = word() != 0;"),
        Type::Real => format!("{place} = to_float(word());"),
        Type::Lreal => format!("{place} = to_double(word());"),
        Type::String(cap) => format!("get_text({place}, {cap});"),
        ty => format!("{place} = ({})word();", c_type(ty)),
    }
}

fn putter(place: &str, v: &Variable) -> String {
    match v.ty {
        Type::Bool => format!("put({place} ? 1 : 0);"),
        Type::Real => format!("put(of_float({place}));"),
        Type::Lreal => format!("put(of_double({place}));"),
        Type::String(cap) => format!("put_text({place}, {cap});"),
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

/// Writes one line of code for each element of a variable.
fn each(path: &str, v: &Variable, line: fn(&str, &Variable) -> String) -> String {
    let place = |i: u32| if v.elements == 1 { path.to_owned() } else { format!("{path}[{i}]") };
    (0..v.elements).map(|i| format!("    {}\n", line(&place(i), v))).collect()
}

/// The part of the program that plays one chart.
fn player(subject: &Subject, printed: &Printed, name: &str) -> String {
    let symbols = &subject.compiled.symbols;
    let mut t = String::new();
    let _ = writeln!(t, "static void show_{name}(const {name}_state *s, uint8_t fault)\n{{\n    put(fault);");
    let outputs: u32 =
        visible(&subject.compiled).filter(|v| v.class == VarClass::Output).map(|v| v.words()).sum();
    let all: u32 = visible(&subject.compiled).map(|v| v.words()).sum();
    let _ = writeln!(t, "    put(fault ? {outputs} : {});", all + 2 * symbols.steps());
    t += "    if (!fault) {\n";
    for i in 0..symbols.steps() {
        let step = format!("{}_{}", name.to_uppercase(), printed.places.step(StepId(i)));
        let _ = writeln!(t, "    put({name}_is_active(s, {step}) ? 1 : 0);");
        let _ = writeln!(t, "    put((uint64_t){name}_step_time(s, {step}));");
    }
    t += "    }\n";
    for v in visible(&subject.compiled) {
        let path = format!("s->{}", printed.places.variable(v.addr).unwrap_or("missing"));
        if v.class == VarClass::Output {
            t += &each(&path, v, putter);
        } else {
            t += "    if (!fault) {\n";
            t += &each(&path, v, putter);
            t += "    }\n";
        }
    }
    t += "}\n";
    let _ = writeln!(
        t,
        "static void play_{name}(void)\n{{\n    static {name}_state s;\n    static {name}_inputs in;\n    \
         static {name}_outputs out;\n    uint8_t event;\n    memset(&in, 0, sizeof in);\n    \
         while (get(&event, 1) && event) {{\n    \
         if (event == 3) {{ {name}_init(&s); continue; }}\n    if (event == 2) {{ {name}_restart(&s); continue; }}\n    \
         const {} now = ({0})((int64_t)word() / {});",
        if subject.room.clock == Clock::Nanoseconds { "int64_t" } else { "uint32_t" },
        subject.room.clock.nanoseconds()
    );
    for v in visible(&subject.compiled).filter(|v| v.class == VarClass::Input) {
        let path = printed.places.variable(v.addr).unwrap_or("missing").replacen("inputs.", "in.", 1);
        t += &each(&path, v, getter);
    }
    // Both ways to make a scan take turns.
    let _ = writeln!(
        t,
        "    static bool in_place;\n    uint8_t fault;\n    in_place = !in_place;\n    if (in_place) {{\n    \
         s.inputs = in;\n    fault = {name}_scan_in_place(&s, now);\n    }} else {{\n    \
         fault = {name}_scan(&in, &out, &s, now);\n    \
         if (memcmp(&out, &s.outputs, sizeof out)) {{ exit(4); }}\n    }}"
    );
    let _ = writeln!(t, "    show_{name}(&s, fault);\n    }}\n}}");
    t
}

/// Generates C for charts and compiles them into one program.
///
/// # Errors
///
/// The messages of the compiler, or the titles of the charts for which no code can be generated.
pub fn c_program(
    folder: &Path,
    compiler: &str,
    flags: &[&str],
    style: Style,
    subjects: &[&Subject],
) -> Result<PathBuf, String> {
    std::fs::create_dir_all(folder).map_err(|e| e.to_string())?;
    let mut main = String::from(HEAD);
    let mut files = Vec::new();
    let mut table = String::new();
    for (i, subject) in subjects.iter().enumerate() {
        let name = format!("c{i}");
        // Charts with files of their own and charts that share `g7.c` are one program.
        let parts = if i % 4 == 3 { Parts::Whole } else { Parts::Apart };
        let printed = subject
            .print_as(Language::C, style, &name, parts)
            .map_err(|e| format!("{}: {e}", subject.title))?;
        for file in &printed.files {
            std::fs::write(folder.join(&file.name), &file.text).map_err(|e| e.to_string())?;
        }
        let _ = writeln!(main, "#include \"{name}.h\"");
        main += &player(subject, &printed, &name);
        let _ = writeln!(table, "        case {i}: play_{name}(); break;");
        let sources = printed.files.iter().map(|f| f.name.clone()).filter(|n| n.ends_with(".c"));
        files.extend(sources.filter(|n| n != "g7.c" || !files.contains(n)).collect::<Vec<_>>());
    }
    let _ = writeln!(
        main,
        "int main(void)\n{{\n    uint32_t chart;\n    while (get(&chart, sizeof chart)) {{\n        \
         switch (chart) {{\n{table}        default: return 2;\n        }}\n        fflush(stdout);\n    }}\n    return 0;\n}}"
    );
    std::fs::write(folder.join("main.c"), main).map_err(|e| e.to_string())?;
    let program = folder.join("charts");
    let strict = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror"];
    let start = || {
        let mut command = Command::new(compiler);
        command.args(flags).current_dir(folder);
        command
    };
    run(start().args(strict).arg("-c").args(&files))?;
    let objects = files.iter().map(|f| f.replace(".c", ".o"));
    run(start().args(["-std=c99", "-w", "main.c"]).args(objects).args(["-o", "charts", "-lm"]))?;
    Ok(program)
}
