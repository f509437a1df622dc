//! Charts as FMUs, run by FMPy: the description is valid, and inputs drawn by chance give outputs, variables and
//! steps as in the engine, scan by scan. A state that is saved and read back goes on as it was, two instances do
//! not meet, a fault is an error with a message.
#![allow(clippy::disallowed_methods, reason = "the tests write files and start a compiler and Python")]

use std::path::Path;
use std::process::Command;

use g7_codegen::fmu::{Version, fmu};
use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::{State, StepId, scan};
use g7_host::{read_text, write_text};
use g7_model::Type;
use g7_tests::generated::Subject;
use g7_tests::generated::cases::{self, Folder};
use serde_json::{Value, json};

/// Scans of a run.
const SCANS: usize = 120;

/// A chart to be run, and what the engine says.
struct Run {
    title: String,
    rows: Vec<(Vec<Value>, bool)>,
    expected: Vec<Option<Vec<Value>>>,
    plan: Value,
}

/// Numbers by chance.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    /// The word of an input, and the words of a text. Numbers are small, so that comparisons meet.
    fn words(&mut self, v: &Variable) -> Vec<u64> {
        let n = self.next();
        match v.ty {
            Type::Bool => vec![n & 1],
            Type::Real => vec![u64::from(((n % 41) as f32 / 4.0 - 5.0).to_bits())],
            Type::Lreal => vec![((n % 41) as f64 / 4.0 - 5.0).to_bits()],
            Type::Usint
            | Type::Uint
            | Type::Udint
            | Type::Ulint
            | Type::Byte
            | Type::Word
            | Type::Dword
            | Type::Lword => vec![n % 12],
            Type::Time | Type::Moment(_) => vec![(n % 40) * 50_000_000],
            Type::String(room) => {
                let text: String = "grafcet".chars().take((n % 8).min(room.into()) as usize).collect();
                write_text(&text, v.words() / v.elements.max(1))
            }
            _ => vec![(n % 12) as i64 as u64],
        }
    }
}

/// A value as FMI tells it, to be given.
fn told(ty: Type, words: &[u64]) -> Value {
    let word = words.first().copied().unwrap_or(0);
    match ty {
        Type::Bool => json!(word != 0),
        Type::Real => json!(f64::from(f32::from_bits(word as u32))),
        Type::Lreal => json!(f64::from_bits(word)),
        Type::Usint
        | Type::Uint
        | Type::Udint
        | Type::Ulint
        | Type::Byte
        | Type::Word
        | Type::Dword
        | Type::Lword => json!(word),
        Type::Time | Type::Moment(_) => json!(word as i64 as f64 / 1e9),
        Type::String(_) => json!(read_text(words, 0)),
        _ => json!(word as i64),
    }
}

/// A value as it is seen: reals by their bits.
fn seen(ty: Type, words: &[u64]) -> Value {
    let word = words.first().copied().unwrap_or(0);
    let real = match ty {
        Type::Real => f64::from(f32::from_bits(word as u32)),
        Type::Lreal => f64::from_bits(word),
        Type::Time | Type::Moment(_) => word as i64 as f64 / 1e9,
        _ => return told(ty, words),
    };
    json!(if real.is_nan() { "NaN".to_owned() } else { format!("{:016x}", real.to_bits()) })
}

fn name(v: &Variable, k: u32) -> String {
    if v.elements == 1 { v.name.to_string() } else { format!("{}[{k}]", v.name) }
}

/// The variables that an FMU has, with each element: name, type, first word, words.
fn elements(
    compiled: &Compiled,
    wanted: impl Fn(VarClass) -> bool,
) -> Vec<(String, &Variable, usize, usize)> {
    let seen = compiled.symbols.variables.iter().filter(|v| wanted(v.class) && !matches!(v.ty, Type::Fb(_)));
    seen.flat_map(|v| {
        let size = (v.words() / v.elements.max(1)) as usize;
        (0..v.elements).map(move |k| (name(v, k), v, v.addr.0 as usize + k as usize * size, size))
    })
    .collect()
}

fn step_name(name: &str) -> String {
    let (before, last) = name.rsplit_once('.').map_or((String::new(), name), |(b, l)| (format!("{b}."), l));
    if last.starts_with(|c: char| c.is_ascii_digit()) {
        format!("{before}X{last}")
    } else {
        format!("{name}.X")
    }
}

fn values(compiled: &Compiled, state: &State) -> Vec<Value> {
    let all = elements(compiled, |c| matches!(c, VarClass::Output | VarClass::Internal));
    let words = |at: usize, size: usize| state.words().get(at..at + size).unwrap_or(&[]);
    let steps = (0..compiled.symbols.steps()).map(StepId).filter(|s| compiled.symbols.is_listed(*s));
    all.iter()
        .map(|(_, v, at, size)| seen(v.ty, words(*at, *size)))
        .chain(steps.map(|s| json!(state.is_active(s))))
        .collect()
}

/// The run on the engine.
fn run(subject: &Subject, seed: u64, scans: usize) -> Run {
    let compiled = &subject.compiled;
    let (program, table) = (&compiled.program, compiled.program.tables().inputs);
    let of_inputs = elements(compiled, |c| c == VarClass::Input);
    let mut chance = Chance(seed);
    let mut state = State::new(program);
    let mut words = state.words().get(table.start as usize..table.end as usize).unwrap_or(&[]).to_vec();
    let period = compiled.symbols.cycle.count().max(1);
    let (mut rows, mut expected, mut now) = (Vec::new(), Vec::new(), 0);
    let fresh = values(compiled, &state);
    for _ in 0..scans {
        for (_, v, at, size) in &of_inputs {
            // Most inputs stay as they are from scan to scan.
            if chance.next().is_multiple_of(3) {
                let at = at - table.start as usize;
                words.splice(at..at + size, chance.words(v));
            }
        }
        let row = of_inputs.iter().map(|(_, v, at, size)| {
            let at = at - table.start as usize;
            told(v.ty, words.get(at..at + size).unwrap_or(&[]))
        });
        let row = row.collect();
        match scan(program, &mut state, &words, now) {
            Ok(_) => {
                rows.push((row, true));
                expected.push(Some(values(compiled, &state)));
                now += period;
            }
            Err(_) => {
                rows.push((row, false));
                expected.push(None);
                (state, now) = (State::new(program), 0);
            }
        }
    }
    let steps = (0..compiled.symbols.steps()).map(StepId).filter(|s| compiled.symbols.is_listed(*s));
    let seen = elements(compiled, |c| matches!(c, VarClass::Output | VarClass::Internal));
    let seen: Vec<String> = seen
        .into_iter()
        .map(|e| e.0)
        .chain(steps.map(|s| step_name(compiled.symbols.step_name(s))))
        .collect();
    let inputs: Vec<String> = of_inputs.into_iter().map(|e| e.0).collect();
    let plan = json!({ "period": period as f64 / 1e9, "inputs": inputs, "seen": seen, "fresh": fresh });
    Run { title: subject.title.clone(), rows, expected, plan }
}

/// The files of an FMU in a folder, with the library for this machine.
fn unpacked(folder: &Path, subject: &Subject, version: Version) -> Result<(), String> {
    let made = fmu(&subject.compiled, version, "chart", &subject.text)
        .map_err(|p| p.iter().map(|p| p.what.to_string()).collect::<Vec<_>>().join("; "))?;
    for file in &made.files {
        let path = folder.join(&file.name);
        std::fs::create_dir_all(path.parent().unwrap_or(folder)).map_err(|e| e.to_string())?;
        std::fs::write(path, &file.text).map_err(|e| e.to_string())?;
    }
    let (system, machine) = (std::env::consts::OS, std::env::consts::ARCH);
    let place = version.folder(system, machine).ok_or("no name for this machine")?;
    let binaries = folder.join("binaries").join(place);
    std::fs::create_dir_all(&binaries).map_err(|e| e.to_string())?;
    let library = binaries.join(format!("{}{}", made.identifier, std::env::consts::DLL_SUFFIX));
    let strict =
        ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror", "-O0", "-shared", "-fPIC"];
    let out = Command::new("gcc")
        .args(strict)
        .args(&made.compiled)
        .arg("-o")
        .arg(library)
        .arg("-lm")
        .current_dir(folder.join("sources"))
        .output()
        .map_err(|e| e.to_string())?;
    if out.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&out.stderr).into_owned()) }
}

/// The messages of the FMU and the first difference from the engine.
fn differs(run: &Run, answer: &Value) -> Option<String> {
    let problems = answer["problems"].as_array()?;
    if !problems.is_empty() {
        return Some(format!("{problems:?}"));
    }
    if same(&run.plan["fresh"], &answer["before"]).is_some() {
        return Some(format!("before the first scan: {} against {}", run.plan["fresh"], answer["before"]));
    }
    let faults = run.expected.iter().filter(|e| e.is_none()).count();
    let logged = answer["logged"].as_array().map_or(0, Vec::len);
    if logged < faults {
        return Some(format!("{faults} faults, {logged} messages"));
    }
    for (i, expected) in run.expected.iter().enumerate() {
        let seen = &answer["seen"][i];
        let expected = expected.as_ref().map_or(Value::Null, |v| json!(v));
        if let Some(at) = same(&expected, seen) {
            let name = &run.plan["seen"][at];
            return Some(format!(
                "scan {i}, {name}: {} of the engine, {} of the FMU",
                expected[at], seen[at]
            ));
        }
    }
    None
}

/// The first value that is another; whole numbers may come as reals.
fn same(a: &Value, b: &Value) -> Option<usize> {
    let (Some(all), Some(others)) = (a.as_array(), b.as_array()) else {
        return if a == b { None } else { Some(0) };
    };
    let bits = |y: &Value| u64::from_str_radix(y.as_str()?, 16).ok().map(f64::from_bits);
    let equal =
        |x: &Value, y: &Value| x == y || matches!((x.as_f64(), bits(y)), (Some(x), Some(y)) if x == y);
    if all.len() != others.len() {
        return Some(all.len().min(others.len()));
    }
    all.iter().zip(others).position(|(x, y)| !equal(x, y))
}

fn agree(name: &str, version: Version, subjects: &[&Subject], scans: usize) {
    let Some(python) = g7_peers::python("fmpy") else { return };
    if !g7_peers::tool("gcc") {
        return;
    }
    let folder = Folder::new(&format!("fmu-{name}-{version:?}"));
    let (mut plans, mut runs, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
    for (i, subject) in subjects.iter().enumerate() {
        let place = folder.0.join(i.to_string());
        if let Err(why) = unpacked(&place, subject, version) {
            wrong.push(format!("{}: {why}", subject.title));
            continue;
        }
        let run = run(subject, i as u64 + 1, scans);
        let mut plan = run.plan.clone();
        plan["folder"] = json!(place);
        plan["rows"] = json!(run.rows);
        plans.push(plan);
        runs.push(run);
    }
    let file = folder.0.join("plan.json");
    std::fs::write(&file, json!(plans).to_string()).expect("a file");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/python/fmu_run.py");
    let out = Command::new(python).arg(script).arg(&file).output().expect("Python starts");
    let text = String::from_utf8_lossy(&out.stdout);
    let answers: Vec<Value> = text.lines().filter_map(|l| serde_json::from_str(l).ok()).collect();
    assert_eq!(answers.len(), runs.len(), "{}\n{text}", String::from_utf8_lossy(&out.stderr));
    for (run, answer) in runs.iter().zip(&answers) {
        wrong.extend(differs(run, answer).map(|why| format!("{}: {why}", run.title)));
    }
    assert!(
        wrong.is_empty(),
        "{} of {} charts, {version:?}:\n{}",
        wrong.len(),
        subjects.len(),
        wrong.join("\n")
    );
    let sound: usize = runs.iter().map(|r| r.expected.iter().flatten().count()).sum();
    let faults: usize = runs.iter().map(|r| r.expected.iter().filter(|e| e.is_none()).count()).sum();
    println!("{name}, {version:?}: {} charts, {sound} scans and {faults} faults as the engine", runs.len());
}

/// Every `step`th case that C can say, from `first` on; all of them where `G7_SCANS` asks for a long run.
fn spec(first: usize, step: usize) -> Vec<Subject> {
    let step = if std::env::var_os("G7_SCANS").is_some() { 1 } else { step };
    let mut subjects = cases::spec().unwrap_or_else(|e| panic!("{e}"));
    subjects.retain(|s| s.print(g7_codegen::Language::C, g7_codegen::Style::Structured, "chart").is_ok());
    subjects.into_iter().skip(first % step).step_by(step).collect()
}

#[test]
fn cases_as_fmi_2() {
    let subjects = spec(0, 24);
    agree("cases", Version::V2, &subjects.iter().collect::<Vec<_>>(), SCANS);
}

#[test]
fn cases_as_fmi_3() {
    let subjects = spec(13, 24);
    agree("cases", Version::V3, &subjects.iter().collect::<Vec<_>>(), SCANS);
}

/// A chart with an input and an output of each type.
const TYPES: &str = "profile iec60848
input b : BOOL
input i8 : SINT
input i16 : INT
input i32 : DINT
input i64 : LINT
input u8 : USINT
input u16 : UINT
input u32 : UDINT
input u64 : ULINT
input f32 : REAL
input f64 : LREAL
input t : TIME
input s : STRING(7)
output qb : BOOL
output q8 : SINT := 3
output q16 : INT
output q32 : DINT
output q64 : LINT
output p8 : USINT
output p16 : UINT
output p32 : UDINT
output p64 : ULINT
output r32 : REAL := 0.1
output r64 : LREAL := -1.5
output qt : TIME := T#1s500ms
output qs : STRING(7) := 'start'
output ratio : INT
chart Types {
  initial step 1
  step 2 {
    N qb  P1 { q8 := i8; q16 := i16; q32 := i32; q64 := i64; p8 := u8; p16 := u16; p32 := u32; p64 := u64 }
    P1 { r32 := f32; r64 := f64; qt := t; qs := s; ratio := i16 / i8 }
  }
  1 -> 2 when b
  2 -> 1 when not b
}
";

fn of_text(title: &str, text: &str) -> Subject {
    let (document, problems) = g7_syntax::parse(text, g7_model::FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    Subject::new(title, &document, None, text).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn every_type_and_a_division_by_zero() {
    let subject = of_text("types", TYPES);
    let faults = run(&subject, 1, 3 * SCANS).expected.iter().filter(|e| e.is_none()).count();
    assert!(faults > 2, "the run divides by zero");
    for version in [Version::V2, Version::V3] {
        agree("types", version, &[&subject], 3 * SCANS);
    }
}

#[test]
fn examples() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let mut subjects = Vec::new();
    let plants = std::fs::read_dir(folder).expect("the examples").flatten();
    let files = plants.filter_map(|plant| std::fs::read_dir(plant.path()).ok()).flatten().flatten();
    for file in files.map(|f| f.path()).filter(|p| p.extension().is_some_and(|e| e == "g7")) {
        let text = std::fs::read_to_string(&file).expect("a text");
        if !text.contains("template") {
            let mut source = g7_rig::Source::native("chart.g7", text.into_bytes(), 0);
            source.link(&mut |used| Ok(std::fs::read(file.with_file_name(used)).expect("it is used")));
            let whole = g7_syntax::print(source.whole(), None);
            subjects.push(of_text(&file.display().to_string(), &whole));
        }
    }
    assert!(subjects.len() >= 20, "{} examples", subjects.len());
    let all: Vec<&Subject> = subjects.iter().collect();
    agree("examples", Version::V2, &all, 4 * SCANS);
    agree("examples", Version::V3, &all, 4 * SCANS);
}
