//! Printed code: names and texts of the chart, refused constructs, and a sketch that compiles. What linters say is
//! tested in `lint.rs`; that the code does what the engine does in `tests/tests/compiled/main.rs`.
#![allow(clippy::disallowed_methods, reason = "the tests start a compiler")]

use std::process::Command;

use g7_codegen::{Language, Options, Printed, Style, print};
use g7_compile::compile;
use g7_model::{FileId, Problem, codes};

const TANK: &str = "profile iec60848

input start : BOOL at 2 \"push button\"
input full : BOOL at %I0.3
output valve : BOOL at D13

chart Tank {
  initial step 1
  step Fill { N valve }
  1 -> Fill when start and not full
  Fill -> 1 when full
}
";

fn printed(text: &str, language: Language) -> Result<Printed, Vec<Problem>> {
    printed_as(text, language, Style::Structured)
}

fn printed_as(text: &str, language: Language, style: Style) -> Result<Printed, Vec<Problem>> {
    let (doc, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (compiled, problems) = compile(&doc);
    let compiled = compiled.unwrap_or_else(|| panic!("{problems:?}"));
    print(&compiled, &Options { language, style, room: Default::default(), name: "tank", source: text })
}

fn file(p: &Printed, name: &str) -> String {
    let found = p.files.iter().find(|f| f.name == name);
    found
        .unwrap_or_else(|| panic!("no {name} in {:?}", p.files.iter().map(|f| &f.name).collect::<Vec<_>>()))
        .text
        .clone()
}

#[test]
fn names_and_texts_of_the_chart_stand_in_the_code() {
    let p = printed(TANK, Language::C).expect("it can be printed");
    let (header, source) = (file(&p, "tank.h"), file(&p, "tank.c"));
    for want in ["TANK_STEP_1 = 0", "TANK_STEP_FILL = 1", "bool start;", "bool valve;", "tank_scan("] {
        assert!(header.contains(want), "no `{want}` in\n{header}");
    }
    assert!(source.contains("1 -> Fill when start and not full"), "{source}");
    for never in ["malloc", "goto", "string.h", "stdio"] {
        assert!(!source.contains(never), "`{never}` in\n{source}");
    }
    let rust = printed(TANK, Language::Rust).expect("it can be printed");
    assert!(file(&rust, "tank.rs").contains("pub const STEP_FILL: usize = 1;"));
}

#[test]
fn the_flat_style_is_equations_with_memories() {
    let c = printed_as(TANK, Language::C, Style::Flat).expect("it can be printed");
    let text = file(&c, "tank.c");
    for want in [
        "s->w.clearable[T_1_TO_FILL] = s->m.x[TANK_STEP_1] && s->inputs.start && !s->inputs.full;",
        "s->w.clearable[T_FILL_TO_1] = s->m.x[TANK_STEP_FILL] && s->inputs.full;",
        "    if (s->w.clearable[T_1_TO_FILL]) {\n        if (!s->m.x[TANK_STEP_FILL]) {\n",
        "            s->m.x[TANK_STEP_FILL] = true;\n        }\n    \
         } else if (s->m.x[TANK_STEP_FILL] && s->w.clearable[T_FILL_TO_1]) {\n",
        "s->outputs.valve = s->m.x[TANK_STEP_FILL];",
    ] {
        assert!(text.contains(want), "no `{want}` in\n{text}");
    }
    assert!(!text.contains("switch"), "{text}");
    let rust = printed_as(TANK, Language::Rust, Style::Flat).expect("it can be printed");
    let want = "s.w.clearable[T_1_TO_FILL] = s.m.x[STEP_1] && s.inputs.start && !s.inputs.full;";
    assert!(file(&rust, "tank.rs").contains(want), "{}", file(&rust, "tank.rs"));
}

#[test]
fn an_input_named_as_what_the_code_remembers_brings_no_warning() {
    if !g7_peers::tool("gcc") {
        return;
    }
    // `start` is a field of timers as well, of which this chart has none.
    for style in [Style::Structured, Style::Flat] {
        let p = printed_as(TANK, Language::C, style).expect("it can be printed");
        let folder = std::env::temp_dir().join(format!("g7-tank-{}-{style:?}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        for f in &p.files {
            std::fs::write(folder.join(&f.name), &f.text).expect("a file");
        }
        let strict =
            ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror", "-fsyntax-only"];
        let out = Command::new("gcc").args(strict).arg("tank.c").current_dir(&folder).output();
        let _ = std::fs::remove_dir_all(&folder);
        let out = out.expect("gcc starts");
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    }
}

/// One step before so many alternatives.
fn alternatives(n: usize) -> String {
    let mut text = String::from("profile iec61131\ninput a : BOOL\nchart G {\n  initial step 0\n");
    for i in 1..=n {
        text += &format!("  step {i}\n  0 -> {i} when a\n  {i} -> 0 when TRUE\n");
    }
    text + "}\n"
}

#[test]
fn priority_is_an_equation_of_few_alternatives_and_a_memory_of_many() {
    let c = printed_as(&alternatives(3), Language::C, Style::Flat).expect("it can be printed");
    let want = "s->w.clearable[T_0_TO_3] = s->m.x[TANK_STEP_0] && !s->w.clearable[T_0_TO_1] && \
                !s->w.clearable[T_0_TO_2] && s->inputs.a;";
    assert!(file(&c, "tank.c").contains(want), "{}", file(&c, "tank.c"));
    let code = |n| {
        let printed = printed_as(&alternatives(n), Language::C, Style::Flat).expect("it can be printed");
        file(&printed, "tank.c").to_owned()
    };
    let (half, whole) = (code(250), code(500));
    assert!(whole.contains("s->w.settled[TANK_STEP_0]"), "one memory says that a transition was found");
    let (half, whole) = (half.len(), whole.len());
    assert!(whole < half * 5 / 2, "{half} and {whole} bytes: not the square of the alternatives");
}

#[test]
fn steps_of_a_large_chart_share_the_question_whether_any_changes() {
    let shared = |n| {
        let printed = printed_as(&alternatives(n), Language::C, Style::Flat).expect("it can be printed");
        let is_shared = |line: &&str| line.starts_with("    if (") && line.matches(" || ").count() >= 8;
        file(&printed, "tank.c").lines().filter(is_shared).count()
    };
    // The first step and its alternatives, eight steps to a group; the first group reads more.
    assert_eq!((shared(5), shared(39)), (0, 5));
}

/// A ring of so many steps, each with an output and a receptivity of its own.
fn ring(n: usize) -> String {
    let mut text = String::from("profile iec60848\ninput a : INT\n");
    (0..n).for_each(|i| text += &format!("output q{i} : BOOL\n"));
    text += "chart G {\n";
    for i in 0..n {
        let word = if i == 0 { "initial step" } else { "step" };
        text += &format!("  {word} {i} {{ N q{i} }}\n  {i} -> {} when a = {i}\n", (i + 1) % n);
    }
    text + "}\n"
}

#[test]
fn outputs_follow_the_steps_of_a_word() {
    let c = |n| file(&printed(&ring(n), Language::C).expect("it can be printed"), "tank.c");
    let (few, many) = (c(32), c(70));
    assert!(!few.contains("switch (word)") && !few.contains("top["), "{few}");
    let cases = many.split_once("switch (word) {").and_then(|(_, r)| r.split_once("default:"));
    assert_eq!(cases.map(|(cases, _)| cases.matches("case ").count()), Some(3));
    assert!(many.contains("s->outputs.q69 = s->m.x[TANK_STEP_69];"), "{many}");
    // Where the steps are the same, the outputs that follow them are.
    assert!(many.contains("same_outputs(") && !many.contains("a->q1 "), "{many}");
}

#[test]
fn a_long_choice_stands_in_several_functions() {
    let c = |n| file(&printed(&ring(n), Language::C).expect("it can be printed"), "tank.c");
    assert!(!c(400).contains("receptivity_part"));
    let long = c(401);
    for want in
        ["return receptivity_part_3(s, transition);", "bool receptivity_part_0(", "switch (transition >> 7)"]
    {
        assert!(long.contains(want), "no `{want}`");
    }
}

#[test]
fn what_nothing_reads_is_left_out() {
    let text = file(&printed(TANK, Language::C).expect("it can be printed"), "tank.c");
    assert!(!text.contains("->scans") && !text.contains("->work") && !text.contains("->dt"), "{text}");
    let uses =
        TANK.replace("input full", "input work : BOOL\ninput full").replace("not full", "not full and work");
    let text = file(&printed(&uses, Language::C).expect("it can be printed"), "tank.c");
    assert!(text.contains("s->inputs.work"), "an input with such a name stays: {text}");
}

#[test]
fn what_c_cannot_say_is_refused() {
    let text = "profile iec60848\noutput t : STRING(20)\nvar x : REAL\nchart G {\n  initial step 1 { P1 t := REAL_TO_STRING(x) }\n}\n";
    let problems = printed(text, Language::C).expect_err("C has no way for it");
    assert_eq!(problems[0].code.id, codes::NOT_CARRIED.id);
    printed(text, Language::Rust).expect("Rust has one");
}

#[test]
fn functions_of_the_library_are_told() {
    let text = "profile iec60848\noutput y : LREAL\ninput x : LREAL\nchart G {\n  initial step 1 { N y := SIN(x) }\n}\n";
    let p = printed(text, Language::C).expect("it can be printed");
    assert_eq!(p.problems[0].code.id, codes::DIFFERENT.id);
    assert!(file(&p, "tank.c").contains("#include <math.h>"));
}

const ARDUINO: &str = "#include <stdint.h>
enum { LOW, HIGH, INPUT, OUTPUT, INPUT_PULLUP, A0 };
static unsigned long millis() { return 0; }
static int digitalRead(int p) { return p; }
static void digitalWrite(int, int) {}
static int analogRead(int p) { return p; }
static void analogWrite(int, int) {}
static void pinMode(int, int) {}
void use() { (void)analogRead(0); analogWrite(0, 0); digitalWrite(0, digitalRead(0)); pinMode(0, 0); (void)millis(); }
void setup();
void loop();
#include \"tank.ino\"
";

#[test]
fn the_sketch_has_the_pins_and_compiles() {
    let p = printed(TANK, Language::Arduino).expect("it can be printed");
    let sketch = file(&p, "tank.ino");
    assert!(sketch.contains("PIN_START = 2;") && sketch.contains("PIN_VALVE = 13;"), "{sketch}");
    assert!(sketch.contains("PIN_FULL = -1;"), "{sketch}");
    if !g7_peers::tool("g++") {
        return;
    }
    let folder = std::env::temp_dir().join(format!("g7-sketch-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    for f in &p.files {
        std::fs::write(folder.join(&f.name), &f.text).expect("a file");
    }
    std::fs::write(folder.join("main.cpp"), ARDUINO).expect("a file");
    let out = Command::new("g++")
        .args(["-Wall", "-Wextra", "-Werror", "-fsyntax-only", "main.cpp"])
        .current_dir(&folder)
        .output()
        .expect("g++ starts");
    let _ = std::fs::remove_dir_all(&folder);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
}
