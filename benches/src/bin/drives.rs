//! A machine of many drives: each a chart of 12 steps with five function blocks, four of the standard and one of its own.
//!
//! Prints the time from the text to the first scan, the time of a scan with all drives moving, with one moving and with none,
//! that of one drive alone, and the bytes of the state; the same of matiec's C if `iec2c` is on the `PATH`, with the
//! ratio. Then the time of a body that goes through an array, beside the C of `g7 gen c`.
#![allow(clippy::disallowed_methods, reason = "a stopwatch reads the clock")]

use std::fmt::Write;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use g7_benches::tools::run;
use g7_codegen::{Language, Options, Style};
use g7_compile::{Compiled, compile};
use g7_engine::{State, scan};
use g7_model::FileId;
use g7_peers::Matiec;

/// The steps of a drive.
const STEPS: usize = 12;
/// The drives of the machine.
const MANY: usize = 200;
/// The elements of the array.
const CELLS: usize = 100;

fn main() {
    let peer = Matiec::find();
    if peer.is_none() {
        println!("matiec: skipped, no iec2c on the PATH");
    }
    let folder = std::env::temp_dir().join(format!("g7-drives-{}", std::process::id()));
    let (many, alone) = (ours(MANY), ours(1));
    let theirs = peer.as_ref().map(|peer| matiec(peer, &folder.join("matiec")));
    println!("{MANY} drives of {STEPS} steps with 5 function blocks");
    println!("{:<34}{:>14}{:>14}{:>10}", "", "G7", "matiec", "ratio");
    let rows = [
        ("text to the first scan, ms", many.text, theirs.as_ref().map(|t| t.as_ref().map(|t| t.text))),
        ("scan, all move, ns", many.all, theirs.as_ref().map(|t| t.as_ref().map(|t| t.all))),
        ("scan, one moves, ns", many.one, theirs.as_ref().map(|t| t.as_ref().map(|t| t.one))),
        ("scan, none moves, ns", many.none, theirs.as_ref().map(|t| t.as_ref().map(|t| t.none))),
        ("state, bytes", many.bytes, theirs.as_ref().map(|t| t.as_ref().map(|t| t.bytes))),
    ];
    for (name, own, other) in rows {
        let mut line = format!("{name:<34}{own:>14.1}");
        match other {
            Some(Ok(other)) => _ = write!(line, "{other:>14.1}{:>10.2}", own / other),
            Some(Err(why)) => _ = write!(line, "  {}", why.lines().next().unwrap_or_default()),
            None => {}
        }
        println!("{line}");
    }
    println!("one of {MANY} moves / one drive alone: {:.2}", many.one / alone.one);
    let (own, other) = (array(), generated(&folder.join("array")));
    match other {
        Ok(other) => println!(
            "array of {CELLS}, read and written in a body: {own:.0} ns, gen c {other:.0} ns, ratio {:.2}",
            own / other
        ),
        Err(why) => println!("array: {why}"),
    }
    let _ = std::fs::remove_dir_all(&folder);
}

struct Measured {
    text: f64,
    all: f64,
    one: f64,
    none: f64,
    bytes: f64,
}

/// The machine as .g7 text.
fn text(drives: usize) -> String {
    let mut t = format!(
        "profile iec61131\ninput go : ARRAY[1..{drives}] OF BOOL\noutput motor : ARRAY[1..{drives}] OF BOOL\n\
         function block Scale {{\n  input raw : INT\n  output value : INT\n  var last : INT\n  \
         body {{ value := (raw + last) / 2; last := raw }}\n}}\n\
         chart Drive(i : INT) {{\n  var on, off : TON\n  var edge : R_TRIG\n  var count : CTU\n  var scale : Scale\n  \
         action Work {{\n    on(IN := go[i], PT := 3ms)\n    off(IN := not go[i], PT := 3ms)\n    edge(CLK := on.Q)\n    \
         count(CU := edge.Q, R := off.Q, PV := 100)\n    scale(raw := count.CV)\n  }}\n  initial step 1\n"
    );
    for s in 2..=STEPS {
        let _ = writeln!(t, "  step {s} {{\n    N motor[i]\n    N Work\n  }}");
    }
    for s in 1..STEPS {
        let _ = writeln!(t, "  {s} -> {} when go[i]", s + 1);
    }
    let _ = writeln!(t, "  {STEPS} -> 1 when go[i]\n}}\ninstance Drive[1..{drives}]");
    t
}

fn program(text: &str) -> Compiled {
    let (doc, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (compiled, problems) = compile(&doc);
    compiled.unwrap_or_else(|| panic!("{problems:?}"))
}

/// The shortest of some times.
fn best(rounds: usize, mut time: impl FnMut() -> f64) -> f64 {
    (0..rounds).map(|_| time()).fold(f64::MAX, f64::min)
}

/// ns a scan of a program with these inputs.
fn scans(c: &Compiled, state: &mut State, now: &mut i64, inputs: &[u64]) -> f64 {
    const SCANS: usize = 3000;
    best(9, || {
        let start = Instant::now();
        for _ in 0..SCANS {
            *now += 1_000_000;
            let report = scan(&c.program, state, std::hint::black_box(inputs), *now);
            std::hint::black_box(&report).as_ref().expect("the drives run without fault");
        }
        start.elapsed().as_nanos() as f64 / SCANS as f64
    })
}

fn ours(drives: usize) -> Measured {
    let text = text(drives);
    let loaded = best(9, || {
        let start = Instant::now();
        let c = program(&text);
        let mut state = State::new(&c.program);
        scan(&c.program, &mut state, &vec![0; drives], 0).expect("the drives run without fault");
        start.elapsed().as_secs_f64() * 1e3
    });
    let c = program(&text);
    let inputs = c.program.tables().inputs;
    assert_eq!((inputs.end - inputs.start) as usize, drives, "a word for each input");
    let (mut state, mut now) = (State::new(&c.program), 0);
    let mut only = vec![0; drives];
    // Idle drives stand in their first steps.
    let none = scans(&c, &mut state, &mut now, &only);
    only[0] = 1;
    let one = scans(&c, &mut state, &mut now, &only);
    let all = scans(&c, &mut state, &mut now, &vec![1; drives]);
    Measured { text: loaded, all, one, none, bytes: size_of_val(state.image()) as f64 }
}

const HARNESS: &str = r#"
#include <stdio.h>
#include <stdint.h>
#include <time.h>
#include "POUS.h"
TIME __CURRENT_TIME;
BOOL __DEBUG = 0;
#include "POUS.c"
static uint64_t ns(void) { struct timespec t; clock_gettime(CLOCK_MONOTONIC, &t);
  return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec; }
static MACHINE m;
static void tick(void) {
  __CURRENT_TIME.tv_nsec += 1000000;
  if (__CURRENT_TIME.tv_nsec >= 1000000000) { __CURRENT_TIME.tv_sec++; __CURRENT_TIME.tv_nsec -= 1000000000; }
  MACHINE_body__(&m); }
static double best(void) {
  double least = 1e18;
  for (int r = 0; r < 9; r++) {
    uint64_t a = ns();
    for (int k = 0; k < 3000; k++) tick();
    double t = (double)(ns() - a) / 3000;
    if (t < least) least = t;
  }
  return least; }
int main(void) {
  MACHINE_init__(&m, 0);
  double none = best();
  m.GO1.value = 1;
  double one = best();
  SET
  double all = best();
  printf("%.3f %.3f %.3f %zu\n", all, one, none, sizeof m);
  return 0;
}
"#;

/// The machine for matiec, which takes no array of function blocks with a chart.
fn standard(drives: usize) -> String {
    let mut t = String::from(
        "FUNCTION_BLOCK Scale\n VAR_INPUT raw : INT; END_VAR\n VAR_OUTPUT value : INT; END_VAR\n VAR last : INT; END_VAR\n \
         value := (raw + last) / 2; last := raw;\nEND_FUNCTION_BLOCK\n\
         FUNCTION_BLOCK Drive\n VAR_INPUT go : BOOL; END_VAR\n VAR_OUTPUT motor : BOOL; END_VAR\n \
         VAR switch_on : TON; switch_off : TON; rise : R_TRIG; ups : CTU; scaled : Scale; END_VAR\n INITIAL_STEP S1: END_STEP\n",
    );
    for s in 2..=STEPS {
        let _ = writeln!(t, " STEP S{s}: motor(N); Work(N); END_STEP");
    }
    for s in 1..=STEPS {
        let _ = writeln!(t, " TRANSITION FROM S{s} TO S{} := go; END_TRANSITION", s % STEPS + 1);
    }
    t.push_str(
        " ACTION Work:\n  switch_on(IN := go, PT := T#3ms); switch_off(IN := NOT go, PT := T#3ms); rise(CLK := switch_on.Q);\n  \
         ups(CU := rise.Q, R := switch_off.Q, PV := 100); scaled(raw := ups.CV);\n END_ACTION\nEND_FUNCTION_BLOCK\n\
         PROGRAM Machine\n VAR_INPUT\n",
    );
    (1..=drives).for_each(|n| _ = writeln!(t, "  go{n} : BOOL;"));
    t.push_str(" END_VAR\n VAR_OUTPUT\n");
    (1..=drives).for_each(|n| _ = writeln!(t, "  motor{n} : BOOL;"));
    t.push_str(" END_VAR\n VAR\n");
    (1..=drives).for_each(|n| _ = writeln!(t, "  d{n} : Drive;"));
    t.push_str(" END_VAR\n");
    (1..=drives).for_each(|n| _ = writeln!(t, " d{n}(go := go{n}, motor => motor{n});"));
    t.push_str(
        "END_PROGRAM\nCONFIGURATION conf\n RESOURCE res ON PLC\n  TASK t(INTERVAL := T#1ms, PRIORITY := 0);\n  \
         PROGRAM p WITH t : Machine;\n END_RESOURCE\nEND_CONFIGURATION\n",
    );
    t
}

/// The same measurements of matiec's C; its time from the text is that of `iec2c` and gcc.
fn matiec(peer: &Matiec, folder: &Path) -> Result<Measured, String> {
    let io = |e: std::io::Error| e.to_string();
    std::fs::create_dir_all(folder).map_err(io)?;
    std::fs::write(folder.join("machine.st"), standard(MANY)).map_err(io)?;
    let set: String = (1..=MANY).map(|n| format!("m.GO{n}.value = 1; ")).collect();
    std::fs::write(folder.join("main.c"), HARNESS.replace("SET", &set)).map_err(io)?;
    let start = Instant::now();
    run(&mut peer.translate(folder, "machine.st"))?;
    run(Command::new("gcc")
        .args(["-O2", "-w", "-o", "machine", "main.c", "-I"])
        .arg(peer.lib.join("C"))
        .args(["-lrt", "-lm"])
        .current_dir(folder))?;
    let text = start.elapsed().as_secs_f64() * 1e3;
    let out = run(Command::new(folder.join("machine")).current_dir(folder))?;
    let numbers: Vec<f64> = out.split_whitespace().filter_map(|w| w.parse().ok()).collect();
    let [all, one, none, bytes] = numbers[..] else { return Err("the timer printed nothing".into()) };
    Ok(Measured { text, all, one, none, bytes })
}

/// A body that goes through an array.
fn cells() -> String {
    format!(
        "profile iec61131\ninput go : BOOL\noutput total : DINT\nvar a : ARRAY[1..{CELLS}] OF DINT\npre {{\n  var i : INT\n  \
         total := 0\n  FOR i := 1 TO {CELLS} DO\n    a[i] := (a[i] + i) MOD 1000\n    total := total + a[i]\n  END_FOR\n}}\n\
         chart G {{\n  initial step 1\n  step 2\n  1 -> 2 when go\n  2 -> 1 when not go\n}}\n"
    )
}

fn array() -> f64 {
    let c = program(&cells());
    scans(&c, &mut State::new(&c.program), &mut 0, &[0])
}

/// ns a scan of the same body in the C of `g7 gen c`.
fn generated(folder: &Path) -> Result<f64, String> {
    let text = cells();
    let c = program(&text);
    let options = Options {
        language: Language::C,
        style: Style::Structured,
        room: Default::default(),
        name: "chart",
        source: &text,
    };
    let printed = g7_codegen::print(&c, &options).map_err(|p| format!("{p:?}"))?;
    let io = |e: std::io::Error| e.to_string();
    std::fs::create_dir_all(folder).map_err(io)?;
    for file in &printed.files {
        std::fs::write(folder.join(&file.name), &file.text).map_err(io)?;
    }
    std::fs::write(folder.join("main.c"), ARRAY).map_err(io)?;
    run(Command::new("gcc").args(["-O2", "-o", "chart", "main.c", "chart.c"]).current_dir(folder))?;
    run(&mut Command::new(folder.join("chart")))?.trim().parse().map_err(|_| "no number".into())
}

const ARRAY: &str = r#"
#include <stdio.h>
#include <time.h>
#include "chart.h"
static uint64_t ns(void) { struct timespec t; clock_gettime(CLOCK_MONOTONIC, &t);
  return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec; }
static chart_state s;
int main(void) {
  chart_init(&s);
  int64_t now = 0;
  double least = 1e18;
  for (int r = 0; r < 9; r++) {
    uint64_t a = ns();
    for (int k = 0; k < 3000; k++) { now += 1000000; if (chart_scan_in_place(&s, now)) { printf("fault\n"); return 1; } }
    double t = (double)(ns() - a) / 3000;
    if (t < least) least = t;
  }
  printf("%.3f\n", least);
  return 0;
}
"#;
