//! Code for PLCs does what the engine does, scan by scan, where a compiler that
//! is not ours (matiec, `iec2c` on the PATH) makes C of it: situation, outputs
//! and variables, on every conformance case that can be printed.
//!
//! `G7_ALL` takes every case for Instruction List as well.
//!
//! The library of matiec is looked for in `MATIEC_LIB`, then beside `iec2c`; the
//! folder of the code is kept where `G7_KEEP` is set.
#![allow(clippy::disallowed_methods, reason = "the tests start compilers")]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use g7_codegen::plc::{self, Form, Printed};
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::{FaultKind, State, StepId, scan};
use g7_model::{ProfileName, Type};
use g7_tests::case;
use g7_tests::generate::sample;
use g7_tests::generated::Subject;

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

/// A folder of the test that goes when it is over.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        if std::env::var_os("G7_KEEP").is_none() {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }
}

/// matiec and its library.
fn matiec() -> Option<(PathBuf, PathBuf)> {
    let path = std::env::var_os("PATH")?;
    let tool = std::env::split_paths(&path).map(|d| d.join("iec2c")).find(|p| p.is_file())?;
    let beside = tool.parent().map(|p| p.join("lib"));
    let places =
        [std::env::var_os("MATIEC_LIB").map(PathBuf::from), beside, Some("/usr/share/matiec/lib".into())];
    let lib = places.into_iter().flatten().find(|l| l.join("ieclib.txt").is_file())?;
    Some((tool, lib))
}

fn cases(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.filter_map(|e| e.ok().map(|e| e.path())) {
        if path.is_dir() {
            cases(&path, found);
        } else if path.extension().is_some_and(|e| e == "md")
            && path.file_stem().is_some_and(|s| s != "README")
        {
            found.push(path);
        }
    }
}

/// Every conformance case with a trace, a subject for each profile it runs under.
fn spec() -> Vec<Subject> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("spec");
    let mut files = Vec::new();
    cases(&root, &mut files);
    files.sort();
    let mut subjects: Vec<Subject> = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a case");
        let case = case::read(&text).expect("a case in good form");
        let title = file.strip_prefix(&root).unwrap_or(&file).with_extension("").display().to_string();
        let folder = title.split('/').next().unwrap_or("").to_owned();
        let doc = case::document(&case.chart).expect("a chart");
        for trace in &case.traces {
            let own = doc.profile().map(|p| p.name);
            let profile =
                trace.profile.or_else(|| case::profile_named(&folder).ok()).or(own).unwrap_or_default();
            let title = format!("{title} {}", profile.name());
            let at = match subjects.iter().position(|s| s.title == title) {
                Some(at) => at,
                None => {
                    let subject = Subject::new(&title, &doc, Some(profile), &case.chart);
                    subjects.push(subject.unwrap_or_else(|e| panic!("{title}: {e}")));
                    subjects.len() - 1
                }
            };
            subjects[at].replay(&doc, profile, trace).unwrap_or_else(|e| panic!("{title}: {e}"));
        }
    }
    assert!(subjects.len() > 100, "only {} cases", subjects.len());
    subjects
}

/// Variables that both have.
fn shown<'a>(s: &'a Subject, printed: &Printed) -> Vec<(&'a Variable, String)> {
    let all = s.compiled.symbols.variables.iter();
    let all = all.filter(|v| !matches!(v.class, VarClass::Const | VarClass::Local));
    all.filter_map(|v| printed.variable(v.addr).map(|(n, _)| (v, n.to_uppercase())))
        .filter(|(v, _)| !matches!(v.ty, Type::Fb(_) | Type::String(_)))
        .collect()
}

/// What one scan shows.
#[derive(Debug, PartialEq)]
struct Seen {
    stopped: bool,
    words: Vec<u64>,
}

/// What the program reads, and what the engine shows. A run ends where values
/// fail (a controller goes on) and at a warm restart (what is kept is the
/// controller's matter).
fn played(s: &Subject, printed: &Printed) -> (Vec<u64>, Vec<Seen>) {
    let program = &s.compiled.program;
    let table = program.tables().inputs;
    let n = (table.end - table.start) as usize;
    let (mut input, mut seen) = (Vec::new(), Vec::new());
    let mut bytes = s.input.as_slice();
    let mut state = State::new(program);
    let mut ended = false;
    let shown = shown(s, printed);
    while let Some((event, rest)) = bytes.split_first() {
        bytes = rest;
        match event {
            3 => {
                state = State::new(program);
                input.push(3);
                ended = false;
                continue;
            }
            2 => {
                ended = true;
                continue;
            }
            _ => {}
        }
        let mut words = Vec::new();
        for _ in 0..=n {
            let (word, rest) = bytes.split_first_chunk::<8>().expect("a word");
            words.push(u64::from_le_bytes(*word));
            bytes = rest;
        }
        if ended {
            continue;
        }
        let now = words[0] as i64;
        let done = scan(program, &mut state, &words[1..], now);
        let stopped = match &done {
            Ok(_) => false,
            Err(f) => {
                ended = true;
                if !matches!(
                    f.kind,
                    FaultKind::Unstable { .. } | FaultKind::Forcing { .. } | FaultKind::Bound
                ) {
                    continue;
                }
                true
            }
        };
        input.push(1);
        input.push(now as u64);
        for (v, _) in shown.iter().filter(|(v, _)| v.class == VarClass::Input) {
            let from = 1 + (v.addr.0 - table.start) as usize;
            input.extend(&words[from..from + v.elements as usize]);
        }
        let mut words = Vec::new();
        if !stopped {
            words.extend((0..s.compiled.symbols.steps()).map(|i| u64::from(state.is_active(StepId(i)))));
        }
        for (v, _) in shown.iter().filter(|(v, _)| !stopped || v.class == VarClass::Output) {
            words.extend(v.value(&state));
        }
        seen.push(Seen { stopped, words });
    }
    input.push(0);
    (input, seen)
}

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

/// Cases that matiec itself has otherwise, and why.
const NOT_IN_MATIEC: [(&str, &str); 1] = [(
    "iec60848/time-compared",
    "its sum of two TIMEs is wrong where the parts of a second make exactly one",
)];

/// Charts through matiec and gcc beside the engine; what differs.
fn batch(folder: &Path, ending: &str, list: &[(&Subject, Printed)]) -> Result<(), String> {
    let Some((tool, lib)) = matiec() else { return Ok(()) };
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
        let (words, seen) = played(s, printed);
        input.push(i as u64);
        input.extend(words);
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
    let mut translate = Command::new(tool);
    translate.current_dir(folder).arg("-I").arg(&lib).args(["-T", ".", &file]);
    let out = translate.output().map_err(|e| e.to_string())?;
    if !out.status.success() {
        let said = [&*out.stdout, &*out.stderr].concat();
        let said = String::from_utf8_lossy(&said);
        let internal = out.status.code().is_none() || said.contains("Internal compiler error");
        let lines = said.lines().take(40).collect::<Vec<_>>().join("\n");
        return Err(format!("{}: {lines}", if internal { BROKEN } else { "matiec" }));
    }
    let gcc = ["-w", "-O0", "-std=gnu99", "-o", "charts", "main.c", "-lm"];
    // Of some lists that it takes, matiec makes C that is none.
    run(Command::new("gcc").current_dir(folder).arg("-I").arg(lib.join("C")).args(gcc))
        .map_err(|why| format!("Internal compiler error: {why}"))?;
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

fn difference(s: &Subject, printed: &Printed, want: &Seen, got: &Seen) -> String {
    if want.stopped != got.stopped {
        return format!("stopped: {} by the engine, {} by the code", want.stopped, got.stopped);
    }
    let mut names: Vec<String> = Vec::new();
    if !want.stopped {
        names.extend((0..s.compiled.symbols.steps()).map(|i| printed.step(StepId(i)).to_owned()));
    }
    for (v, name) in shown(s, printed).iter().filter(|(v, _)| !want.stopped || v.class == VarClass::Output) {
        names.extend((0..v.elements).map(|i| format!("{name}[{i}]")));
    }
    let all = names.iter().zip(want.words.iter().zip(&got.words)).filter(|(_, (a, b))| a != b);
    all.take(8)
        .map(|(n, (a, b))| format!("{n} {} against {}", *a as i64, *b as i64))
        .collect::<Vec<_>>()
        .join(", ")
}

/// Prints what can be printed; counts why the rest cannot.
fn printable(subjects: &[Subject], form: Form) -> (Vec<(&Subject, Printed)>, BTreeMap<String, usize>) {
    let mut list = Vec::new();
    let mut refused: BTreeMap<String, usize> = BTreeMap::new();
    for s in subjects {
        if let Some((_, why)) = NOT_IN_MATIEC.iter().find(|(case, _)| s.title.starts_with(case)) {
            *refused.entry(format!("left out, matiec: {why}")).or_default() += 1;
            continue;
        }
        let name = format!("chart_{}", list.len());
        match plc::print(&s.compiled, form, &name, &s.text) {
            Ok(printed) => list.push((s, printed)),
            Err(problems) => {
                let why = problems.first().map_or(String::new(), |p| p.what.clone());
                *refused.entry(why).or_default() += 1;
            }
        }
    }
    (list, refused)
}

/// What begins the message where matiec breaks off by itself: a signal, an
/// "internal compiler error".
const BROKEN: &str = "matiec is broken";

/// The charts of a batch, in parts where matiec fails on all of them together (it
/// mixes up blocks of one file); how many it breaks off on even alone.
fn in_parts(folder: &Path, ending: &str, list: &[(&Subject, Printed)]) -> Result<usize, String> {
    match batch(folder, ending, list) {
        Ok(()) => Ok(0),
        Err(why) if why.starts_with("matiec") && (list.len() > 1 || why.starts_with(BROKEN)) => {
            if list.len() < 2 {
                return Ok(list.len());
            }
            let (a, b) = list.split_at(list.len() / 2);
            Ok(in_parts(&folder.join("a"), ending, a)? + in_parts(&folder.join("b"), ending, b)?)
        }
        Err(why) => Err(why),
    }
}

fn agrees(name: &str, form: Form, ending: &str, subjects: &[Subject]) -> usize {
    let (list, refused) = printable(subjects, form);
    println!("{name}: {} of {} printed", list.len(), subjects.len());
    for (why, n) in &refused {
        println!("  {n} refused: {why}");
    }
    if matiec().is_none() {
        println!("skipped: no iec2c (matiec) on the PATH");
        return list.len();
    }
    let folder = Folder(std::env::temp_dir().join(format!("g7-plc-{}-{name}", std::process::id())));
    let mut left_out = 0;
    for (i, part) in list.chunks(if ending == "il" { 16 } else { 400 }).enumerate() {
        match in_parts(&folder.0.join(i.to_string()), ending, part) {
            Ok(n) => left_out += n,
            Err(why) => panic!("{why}"),
        }
    }
    println!("  {left_out} left out: matiec breaks off with an error of its own");
    assert!(left_out * 5 < list.len(), "matiec takes only {} of {}", list.len() - left_out, list.len());
    list.len()
}

#[test]
fn cases_in_structured_text() {
    let printed = agrees("st", Form::St, "st", &spec());
    assert!(printed > 300, "only {printed} cases can be printed");
}

/// Every sixth case, or every one where `G7_ALL` is set: matiec takes its time
/// over lists.
fn some_cases(from: usize) -> Vec<Subject> {
    let every = if std::env::var_os("G7_ALL").is_some() { 1 } else { 6 };
    spec().into_iter().skip(from % every).step_by(every).collect()
}

#[test]
fn cases_in_instruction_list() {
    let printed = agrees("il", Form::Il, "il", &some_cases(0));
    assert!(printed > 100, "only {printed} cases can be printed");
}

#[test]
fn cases_in_the_manner_of_dolog80() {
    let printed = agrees("dolog80", Form::Dolog80, "il", &some_cases(3));
    assert!(printed > 100, "only {printed} cases can be printed");
}

/// Random charts of a profile.
fn random(profile: ProfileName, charts: usize) -> Vec<Subject> {
    let mut subjects = Vec::new();
    let mut seed = 1;
    while subjects.len() < charts {
        let title = format!("{} seed {seed}", profile.name());
        let sample = sample(seed, profile, 200).expect("a random chart can be read");
        seed += 1;
        let Ok(mut subject) = Subject::new(&title, &sample.document, None, &sample.text) else { continue };
        subject.play(&sample.script).unwrap_or_else(|e| panic!("{title}: {e}"));
        subjects.push(subject);
    }
    subjects
}

#[test]
fn random_charts_in_structured_text() {
    for profile in [
        ProfileName::Iec60848,
        ProfileName::Iec61131,
        ProfileName::Pl7,
        ProfileName::Unity,
        ProfileName::Jgrafchart,
    ] {
        let printed = agrees(&format!("st-{}", profile.name()), Form::St, "st", &random(profile, 60));
        assert!(printed > 0, "no chart of {} can be printed", profile.name());
    }
}
