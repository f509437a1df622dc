//! The function library OSCAT Basic: each function and function block that matiec takes is read, and behaves as
//! matiec's C does, in 10,000 random calls.
//!
//! ```text
//! G7_OSCAT=<the project of OpenPLC with the library> cargo test -p g7-tests --test foreign oscat
//! ```
//!
//! A call that is a fault here (a division by 0, an index outside of an array, a number that its type cannot hold) has
//! no counterpart in C, which goes on with some value. Such a call of a function is left out; a function block starts
//! anew behind it. No TIME is 0, because TON of matiec is one scan late then. Real numbers agree in their first digits: the functions of C compute with double precision.
#![allow(clippy::disallowed_methods, reason = "the tests start compilers")]

mod program;
mod units;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_model::{Moment, Severity, Type};
use g7_peers::Matiec;
use g7_peers::mended::{loops, mended};
use g7_tests::generate::Rng;
use g7_tests::generated::cases::Folder;
use g7_tests::generated::project::{self, Built, Scan, Sight};

use units::{Library, Unit};

/// Units that matiec takes and G7 refuses, with the reason: the table of the book has them.
const REFUSED: [(&str, &str); 4] = [
    ("LOGGER", "its statements are C in a pragma"),
    ("PYTHON_EVAL", "its statements are C in a pragma"),
    ("PYTHON_POLL", "its statements are C in a pragma"),
    ("PYTHON_GEAR", "it calls PYTHON_EVAL"),
];

/// Units that both run and that differ, with the reason.
const DIFFERENT: [(&str, &str); 6] = [
    ("ACTUATOR_3P", "its TP has a PT of 0, at which matiec gives a pulse of one scan"),
    ("CLK_PULSE", "it counts on a UDINT that wraps round below 0, which is the fault `overflow` here"),
    (
        "FILTER_MAV_DW",
        "it reads the variable of a FOR behind the loop, where the standard leaves its value open",
    ),
    (
        "FILTER_MAV_W",
        "it reads the variable of a FOR behind the loop, where the standard leaves its value open",
    ),
    ("GEN_RDT", "its TON has a PT of 0 at first, at which matiec is one scan late"),
    ("GEN_RMP", "it asks for the side of 0 on which the last digits of a real number are"),
];

/// The literals of a REAL are of single precision, as in the standard; matiec writes them as those of C.
const FLAGS: [&str; 1] = ["-fsingle-precision-constant"];
/// Calls of each unit.
const CALLS: usize = 10_000;
/// Calls in one run of a function block.
const RUN: usize = 100;
/// Time between two calls, in nanoseconds.
const CYCLE: i64 = 10_000_000;

/// The fate of a unit.
enum Fate {
    /// matiec does not take it.
    Refused(String),
    /// The calls that were compared.
    Agrees(usize),
    Wrong(String),
}

#[test]
fn oscat_as_matiec_runs_it() {
    let (Some(folder), Some(matiec)) = (g7_peers::oscat(), g7_peers::matiec()) else { return };
    let library = Library::read(&folder);
    assert!(library.units.len() > 400, "only {} units", library.units.len());
    let room = Folder::new("oscat");
    let c = room.0.join("C");
    mended(&matiec.lib.join("C"), &c).unwrap_or_else(|e| panic!("{}: {e}", matiec.lib.display()));
    let only = std::env::var("G7_ONLY").ok();
    let wanted = |name: &&String| {
        only.as_ref().is_none_or(|only| only == *name)
            && REFUSED.iter().chain(&DIFFERENT).all(|(n, _)| n != *name)
    };
    let names: Vec<&String> = library.units.keys().filter(wanted).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut fates = Vec::new();
        while let Some(name) = names.get(next.fetch_add(1, Ordering::Relaxed)) {
            let Some(unit) = library.units.get(*name) else { continue };
            fates.push((name.as_str(), fate(&library, unit, &matiec, &c, &room.0.join(name))));
        }
        fates
    };
    let workers = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let fates: Vec<(&str, Fate)> = std::thread::scope(|scope| {
        let all: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        all.into_iter().flat_map(|w| w.join().unwrap_or_else(|_| panic!("a worker"))).collect()
    });
    let (mut agree, mut calls, mut least, mut wrong) = (0, 0, Vec::new(), Vec::new());
    let mut refused: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for (name, fate) in fates {
        match fate {
            Fate::Refused(why) => refused.entry(why).or_default().push(name),
            Fate::Wrong(what) => wrong.push(format!("{name}: {what}")),
            Fate::Agrees(0) => wrong.push(format!("{name}: each call is a fault")),
            Fate::Agrees(n) => {
                (agree, calls) = (agree + 1, calls + n);
                if n < CALLS / 10 {
                    least.push(format!("{name} {n}"));
                }
            }
        }
    }
    println!("{agree} agree in {calls} calls; few calls without a fault: {}", least.join(", "));
    for (why, names) in &refused {
        println!("{} refused by matiec: {why}: {}", names.len(), names.join(", "));
    }
    for (name, why) in REFUSED {
        let Some(unit) = library.units.get(name) else { continue };
        assert!(compiled(&program::program(&library, unit).for_g7).is_err(), "{name} is read");
        println!("{name} is refused: {why}");
    }
    for (name, why) in DIFFERENT {
        println!("{name} differs: {why}");
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), library.units.len(), wrong.join("\n"));
    assert!(only.is_some() || agree > 450, "only {agree} units agree");
}

fn fate(library: &Library, unit: &Unit, matiec: &Matiec, c: &Path, folder: &Path) -> Fate {
    let program = program::program(library, unit);
    std::fs::create_dir_all(folder).unwrap_or_else(|e| panic!("{e}"));
    std::fs::write(folder.join("unit.st"), &program.for_matiec).unwrap_or_else(|e| panic!("{e}"));
    std::fs::write(folder.join("g7.st"), &program.for_g7).unwrap_or_else(|e| panic!("{e}"));
    let out = matiec.translate(folder, "unit.st").output().unwrap_or_else(|e| panic!("{e}"));
    if !out.status.success() {
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        let first = said.lines().find(|l| l.contains("error")).unwrap_or("");
        return Fate::Refused(first.rsplit("error:").next().unwrap_or("").trim().to_owned());
    }
    let code = folder.join("POUS.c");
    let text = std::fs::read_to_string(&code).unwrap_or_else(|e| panic!("{e}"));
    std::fs::write(&code, loops(&text)).unwrap_or_else(|e| panic!("{e}"));
    let outcome = compiled(&program.for_g7)
        .and_then(|chart| Built::new(folder, c, &FLAGS, of_main).map(|built| (chart, built)))
        .and_then(|(chart, built)| compare(unit, &chart, &built));
    if outcome.is_err() && std::env::var_os("G7_ONLY").is_some() {
        println!("inner variables: {:?}", inner(&program.for_g7, c, folder));
    }
    let outcome = match outcome {
        Err(why) if why.starts_with("POUS.c") => return Fate::Refused(format!("by gcc: {why}")),
        outcome => outcome,
    };
    match outcome {
        Ok(calls) => Fate::Agrees(calls),
        Err(why) => Fate::Wrong(why),
    }
}

/// The first difference in any variable of a short run.
fn inner(text: &str, c: &Path, folder: &Path) -> Result<Option<String>, String> {
    let chart = compiled(text)?;
    let built = Built::new(folder, c, &FLAGS, |_| true)?;
    let mut found = Ok(None);
    for seed in 1..=CALLS / RUN {
        let scans = scans(&chart, seed as u64, RUN, true);
        let ours = project::of_engine(&chart, &scans);
        let theirs = built.play(scans.get(..ours.len()).unwrap_or(&[]))?;
        found = Ok(project::difference(&ours, &theirs).1);
        if found != Ok(None) {
            break;
        }
    }
    found
}

/// The variables of the program itself.
fn of_main(name: &str) -> bool {
    name.split('.').count() == 2
}

/// The program as G7 reads it.
fn compiled(text: &str) -> Result<Compiled, String> {
    let format = g7_exchange::named("sfc").ok_or("no such format")?;
    let (document, problems) =
        format.read(text.as_bytes(), g7_model::FileId(0)).ok_or("it is only written")?;
    let (chart, more) = g7_compile::compile(&document);
    let first = problems.iter().chain(&more).find(|p| p.severity() == Severity::Error);
    if let Some(p) = first {
        let line = text.get(..p.at.start as usize).unwrap_or("").lines().count();
        return Err(format!("line {line}: {} {}", p.code.id, p.what));
    }
    chart.ok_or_else(|| "no program".to_owned())
}

/// Compares all calls; returns how many had no fault.
fn compare(unit: &Unit, chart: &Compiled, built: &Built) -> Result<usize, String> {
    let mut compared = 0;
    let run = if unit.function { CALLS } else { RUN };
    for seed in 0..CALLS / run {
        // C goes on behind a fault, or ends the program: it is given the calls without one.
        let all = scans(chart, seed as u64 + 1, run, !unit.function);
        let ours: Vec<Option<Sight>> =
            project::over_faults(chart, &all, |v| v.class == VarClass::Output).collect();
        let sound = if unit.function { ours.len() } else { ours.iter().take_while(|o| o.is_some()).count() };
        let (scans, ours): (Vec<Scan>, Vec<Sight>) =
            all.into_iter().zip(ours).take(sound).filter_map(|(scan, o)| Some((scan, o?))).unzip();
        let theirs = built.play(&scans)?;
        for (number, ours) in ours.iter().enumerate() {
            let Some(theirs) = theirs.get(number) else {
                return Err(format!("matiec ends at call {number}"));
            };
            if let Some(what) = difference(chart, ours, theirs) {
                let given = scans.get(number).map(|s| &s.inputs);
                return Err(format!("seed {seed}, call {number}: {what}, given {given:?}"));
            }
        }
        compared += ours.len();
    }
    Ok(compared)
}

/// The first output that differs.
fn difference(chart: &Compiled, ours: &Sight, theirs: &Sight) -> Option<String> {
    let outputs = chart.symbols.variables.iter().filter(|v| v.class == VarClass::Output);
    for v in outputs {
        let (a, b) = (project::found(ours, &v.name)?, project::found(theirs, &v.name)?);
        let (near, shown) = match v.ty {
            Type::Real => {
                let (a, b) = (f32::from_bits(a as u32).into(), f32::from_bits(b as u32).into());
                (close(a, b), format!("{a} against {b}"))
            }
            Type::Lreal => {
                let (a, b) = (f64::from_bits(a), f64::from_bits(b));
                (close(a, b), format!("{a} against {b}"))
            }
            // matiec makes a TIME of a double, so that its last nanosecond is open.
            Type::Time => {
                ((a as i64).abs_diff(b as i64) <= 1, format!("{} ns against {}", a as i64, b as i64))
            }
            _ => (a == b, format!("{} against {}", a as i64, b as i64)),
        };
        if !near {
            return Some(format!("{} {shown}", v.name));
        }
    }
    None
}

/// True if two numbers agree in their first digits.
fn close(a: f64, b: f64) -> bool {
    let size = a.abs().max(b.abs()).max(1.0);
    // A filter with random constants can grow without bound, and its rounding with it.
    let part = if size > 1e6 { 1e-2 } else { 1e-3 };
    a == b || a.is_nan() && b.is_nan() || (a - b).abs() <= part * size
}

/// Random calls. Values are held for some time if they are for a function block.
fn scans(chart: &Compiled, seed: u64, count: usize, held: bool) -> Vec<Scan> {
    let mut rng = Rng::new(seed);
    let mut inputs: BTreeMap<String, u64> = BTreeMap::new();
    let mut all = Vec::new();
    for number in 0..count {
        for v in chart.symbols.variables.iter().filter(|v| v.class == VarClass::Input) {
            // A timer of matiec does not look at a new PT behind its end.
            let holds = held && (v.ty == Type::Time || !rng.percent(30));
            if number == 0 || !holds {
                inputs.insert(v.name.to_uppercase(), word(&mut rng, &v.name, v.ty));
            }
        }
        all.push(Scan { now: number as i64 * CYCLE, inputs: inputs.clone() });
    }
    all
}

/// A value that a type can hold: mostly a small one. A year and a date are of this century.
fn word(rng: &mut Rng, name: &str, ty: Type) -> u64 {
    if ty.is_integer() && name.to_uppercase().ends_with("UTC") {
        return 946_728_000 + rng.bits() % 1_000_000_000;
    }
    let plain = name.trim_start_matches(['v', '0', '1', '2']).to_uppercase();
    if ty.is_integer() && (plain.ends_with("YEAR") || plain == "Y") {
        return 1970 + rng.below(80) as u64;
    }
    let small = rng.below(12) as i64;
    let wide = rng.bits();
    match ty {
        Type::Bool => wide & 1,
        Type::Real => u64::from((real(rng) as f32).to_bits()),
        Type::Lreal => real(rng).to_bits(),
        Type::Time => {
            (rng.one([1_i64, 5, 10, 20, 50, 100, 500, 1_000, 5_000, 60_000, 3_600_000]) * 1_000_000) as u64
        }
        Type::Moment(Moment::Date) => (wide % 20_000) * 86_400_000_000_000,
        Type::Moment(Moment::Tod) => (wide % 86_400) * 1_000_000_000,
        Type::Moment(Moment::Dt) => (wide % 1_700_000_000) * 1_000_000_000,
        _ => {
            let (least, most) = ty.bounds().or(ty.unsigned().and_then(Type::bounds)).unwrap_or((0, 1));
            let n = match rng.below(10) {
                0 => i128::from(wide) % (most + 1),
                1 => -i128::from(small),
                2 | 3 => i128::from(wide % 3000),
                _ => i128::from(small),
            };
            n.clamp(least, most) as u64
        }
    }
}

fn real(rng: &mut Rng) -> f64 {
    let n = f64::from(rng.below(161) as u32) - 80.0;
    match rng.below(8) {
        0 => 0.0,
        1 => n * 20.0,
        2 => n * 0.001,
        3 => n,
        4 => n.abs(),
        _ => n * 0.125,
    }
}
