//! Plays a whole project that matiec has translated to C, with its configuration and its tasks, beside the
//! engine: the step flags and the variables after each scan.
//!
//! A project is text with a configuration, as the generators of Beremiz and OpenPLC make it. Its names are
//! those of the text; `VARIABLES.csv` of matiec says where each is in the C program.
#![allow(clippy::disallowed_methods, reason = "compilers are started")]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::{Addr, State, StepId, scan};
use g7_model::{Moment, Type};

use crate::generate::Rng;

/// A scan: its instant in nanoseconds, and the words of the inputs by their names.
#[derive(Clone, Debug)]
pub struct Scan {
    /// The instant.
    pub now: i64,
    /// The inputs.
    pub inputs: BTreeMap<String, u64>,
}

/// The state after a scan: the words of steps (`S1.X`) and variables, by their names in capital letters.
pub type Sight = BTreeMap<String, u64>;

/// Random inputs for a chart. `cycle` is the time of a scan; if `even`, all scans are one cycle apart.
pub fn scans(compiled: &Compiled, seed: u64, count: usize, cycle: i64, even: bool) -> Vec<Scan> {
    let mut rng = Rng::new(seed);
    let mut inputs: BTreeMap<String, u64> = BTreeMap::new();
    let mut now = 0;
    let mut all = Vec::new();
    for number in 0..count {
        for v in simple(compiled).filter(|v| v.class == VarClass::Input) {
            if number > 0 && !rng.percent(25) {
                continue;
            }
            let word = match v.ty {
                Type::Bool => u64::from(rng.percent(50)),
                Type::Real => u64::from((rng.below(80) as f32 * 0.5 - 4.0).to_bits()),
                Type::Lreal => (rng.below(80) as f64 * 0.5 - 4.0).to_bits(),
                Type::Time | Type::Moment(Moment::Tod | Moment::Dt) => (rng.below(8) as u64) * 1_000_000_000,
                Type::Moment(Moment::Date) => (rng.below(8) as u64) * 86_400_000_000_000,
                _ => rng.below(12) as u64,
            };
            inputs.insert(key(&v.name), word);
            if v.inverted {
                // A file of the standard has the channel as it is as a second variable.
                inputs.insert(key(&format!("{}_raw", v.name)), 1 - word);
            }
        }
        all.push(Scan { now, inputs: inputs.clone() });
        let factor = if even { 1 } else { rng.one([1, 1, 1, 1, 2, 10, 50, 100, 300]) };
        now += cycle * factor;
    }
    all
}

/// The variables of one word.
fn simple(compiled: &Compiled) -> impl Iterator<Item = &Variable> {
    let own = |v: &&Variable| {
        matches!(v.class, VarClass::Input | VarClass::Output | VarClass::Internal)
            && !matches!(v.ty, Type::Fb(_) | Type::String(_))
            && v.elements == 1
    };
    compiled.symbols.variables.iter().filter(own)
}

/// A name as it is compared.
fn key(name: &str) -> String {
    name.to_uppercase()
}

/// The course of the engine, scan by scan, until a fault.
pub fn of_engine(compiled: &Compiled, scans: &[Scan]) -> Vec<Sight> {
    over_faults(compiled, scans, |_| true).map_while(|sight| sight).collect()
}

/// The course of the engine, scan by scan, in the variables that are wanted and in the steps. A scan with a fault
/// gives nothing and changes nothing.
pub fn over_faults<'c>(
    compiled: &'c Compiled,
    scans: &'c [Scan],
    wanted: impl Fn(&Variable) -> bool,
) -> impl Iterator<Item = Option<Sight>> {
    let program = &compiled.program;
    let table = program.tables().inputs;
    let mut state = State::new(program);
    let inputs: Vec<&Variable> = simple(compiled).filter(|v| v.class == VarClass::Input).collect();
    let shown: Vec<(String, Addr)> =
        simple(compiled).filter(|v| wanted(v)).map(|v| (key(&v.name), v.addr)).collect();
    scans.iter().map(move |at| {
        let mut words = state.words().get(table.start as usize..table.end as usize).unwrap_or(&[]).to_vec();
        for v in &inputs {
            let given = found(&at.inputs, &v.name);
            if let (Some(word), Some(slot)) = (given, words.get_mut((v.addr.0 - table.start) as usize)) {
                *slot = word;
            }
        }
        let before = state.clone();
        if scan(program, &mut state, &words, at.now).is_err() {
            state = before;
            return None;
        }
        let mut sight = Sight::new();
        for step in (0..compiled.symbols.steps()).map(StepId).filter(|s| compiled.symbols.is_listed(*s)) {
            let name = key(&format!("{}.X", compiled.symbols.step_path(step)));
            sight.insert(name, u64::from(state.is_active(step)));
        }
        sight.extend(shown.iter().map(|(name, addr)| (name.clone(), state.word(*addr))));
        Some(sight)
    })
}

/// The value of a name. A name with its chart or program is also found without it, if it has no other owner.
pub fn found(sight: &BTreeMap<String, u64>, name: &str) -> Option<u64> {
    place(sight, name).map(|(_, word)| *word)
}

/// The same, with the name as it stands there.
fn place<'s>(sight: &'s BTreeMap<String, u64>, name: &str) -> Option<(&'s String, &'s u64)> {
    let name = key(name);
    if let Some(exact) = sight.get_key_value(&name) {
        return Some(exact);
    }
    let tail = |full: &str| full.split_once('.').map(|(_, t)| t.to_owned());
    let one = |wanted: &str| {
        let mut hits =
            sight.iter().filter(|(n, _)| n.as_str() == wanted || tail(n).as_deref() == Some(wanted));
        hits.next().filter(|_| hits.next().is_none())
    };
    one(&name).or_else(|| one(&tail(&name)?))
}

/// The first difference between two runs in the names that both have, and how many names these are.
pub fn difference(want: &[Sight], got: &[Sight]) -> (usize, Option<String>) {
    let names: Vec<&String> = match (want.first(), got.first()) {
        (Some(w), Some(g)) => {
            // The output `Q` of a block `T` is not the variable `Q`: of two names that are found at one place, the
            // equal one is compared, else the shorter one.
            let mut best: BTreeMap<&String, &String> = BTreeMap::new();
            for name in w.keys() {
                let Some((there, _)) = place(g, name) else { continue };
                let worth = |n: &String| (n != there, n.len());
                let known = best.entry(there).or_insert(name);
                if worth(name) < worth(known) {
                    *known = name;
                }
            }
            best.into_values().collect()
        }
        _ => Vec::new(),
    };
    for (number, (want, got)) in want.iter().zip(got).enumerate() {
        let differ: Vec<String> = names
            .iter()
            .filter_map(|n| Some((n, *want.get(*n)?, found(got, n)?)))
            .filter(|(_, a, b)| a != b)
            .map(|(n, a, b)| format!("{n} {} against {}", a as i64, b as i64))
            .collect();
        if !differ.is_empty() {
            let shown = differ.get(..differ.len().min(6)).unwrap_or(&[]).join(", ");
            return (names.len(), Some(format!("scan {number}: {shown}")));
        }
    }
    let short = (got.len() < want.len()).then(|| "it ended early".to_owned());
    (names.len(), short)
}

/// A variable or a step of the C program.
struct Place {
    name: String,
    c: String,
    ty: String,
}

/// The C program in a folder, as `iec2c` made it.
struct Program {
    places: Vec<Place>,
    externs: String,
}

impl Program {
    fn read(folder: &Path) -> Result<Program, String> {
        let text =
            |name: &str| std::fs::read_to_string(folder.join(name)).map_err(|e| format!("{name}: {e}"));
        let table = text("VARIABLES.csv")?;
        let headers = text("POUS.h")?;
        let (mut types, mut places) = (BTreeMap::new(), Vec::new());
        let mut externs = String::new();
        // The list of addresses also has names without one, which are no C.
        for found in text("LOCATED_VARIABLES.h")?.split("__LOCATED_VAR(").skip(1) {
            let mut parts = found.split(',');
            let (ty, name) = (parts.next().unwrap_or(""), parts.next().unwrap_or(""));
            let _ = writeln!(externs, "static {ty} at_{name}; {ty} *{name} = &at_{name};");
        }
        let mut code = String::new();
        for entry in std::fs::read_dir(folder).map_err(|e| e.to_string())?.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.ends_with(".c") && name != "POUS.c" && name != "main.c" {
                code += &text(&name)?;
            }
        }
        for line in table.lines() {
            let columns: Vec<&str> = line.split(';').collect();
            match columns.as_slice() {
                [_, path, ty, _] if path.matches('.').count() == 2 => {
                    let mut parts = path.split('.').skip(1);
                    let (res, run) = (parts.next().unwrap_or(""), parts.next().unwrap_or(""));
                    types.insert(run.to_owned(), (*ty).to_owned());
                    let _ = writeln!(externs, "extern {ty} {res}__{run};");
                }
                [_, kind, path, c, ty, ..] if ["VAR", "IN", "OUT", "MEM"].contains(kind) => {
                    let parts: Vec<&str> = path.split('.').skip(1).collect();
                    let of_c: Vec<&str> = c.split('.').skip(1).collect();
                    match (parts.as_slice(), of_c.as_slice()) {
                        ([_, _], [res, name]) => {
                            let located =
                                code.contains(&format!("__DECLARE_GLOBAL_LOCATED({ty},{res},{name})"));
                            let (sort, star) = if located { ("p", "*") } else { ("t", "") };
                            let _ = writeln!(externs, "extern __IEC_{ty}_{sort} {res}__{name};");
                            let c = format!("{star}{res}__{name}.value");
                            places.push(Place { name: (*name).to_owned(), c, ty: (*ty).to_owned() });
                        }
                        ([_, run, rest @ ..], [res, _, inner @ ..])
                            if rest.len() <= 2 && types.contains_key(*run) =>
                        {
                            let step = inner.first().is_some_and(|i| i.starts_with("__step_list"));
                            if rest.len() == 2 && !step || rest.iter().any(|r| r.contains("->")) {
                                continue;
                            }
                            let ty_of = types.get(*run).map_or(*run, String::as_str);
                            let located = inner.len() == 1
                                && headers.contains(&format!("__DECLARE_LOCATED({ty},{})", inner.join(".")));
                            let star = if located { "*" } else { "" };
                            let c = format!("{star}{res}__{run}.{}.value", inner.join("."));
                            let name = format!("{ty_of}.{}", rest.join("."));
                            places.push(Place { name, c, ty: (*ty).to_owned() });
                        }
                        _ => {}
                    }
                }
                _ => {}
            }
        }
        Ok(Program { places, externs })
    }

    fn main(&self) -> String {
        let mut text = String::from(
            "#include <stdio.h>\n#include <string.h>\n#include <stdint.h>\n#include \"iec_std_lib.h\"\n\
             TIME __CURRENT_TIME;\nBOOL __DEBUG;\n#include \"accessor.h\"\n#include \"POUS.h\"\n\
             extern void config_init__(void);\nextern void config_run__(unsigned long tick);\n\
             extern unsigned long long common_ticktime__;\n\
             static void put(uint64_t w) { (void)fwrite(&w, sizeof w, 1, stdout); }\n\
             static int get(uint64_t *w) { return fread(w, sizeof *w, 1, stdin) == 1; }\n\
             static uint64_t of_time(TIME t) { return (uint64_t)((int64_t)t.tv_sec * 1000000000 + t.tv_nsec); }\n\
             static TIME to_time(uint64_t w) { TIME t; t.tv_sec = (int64_t)w / 1000000000; t.tv_nsec = (int64_t)w % 1000000000; return t; }\n",
        );
        text += &self.externs;
        text += "static void set(uint64_t i, uint64_t w)\n{\n  switch (i) {\n";
        for (i, p) in self.places.iter().enumerate() {
            let c = &p.c;
            let line = match Type::named(&p.ty) {
                Some(Type::Real | Type::Lreal) => format!("memcpy(&{c}, &w, sizeof {c});"),
                Some(Type::Time | Type::Moment(_)) => format!("{c} = to_time(w);"),
                Some(Type::String(_)) | None => String::new(),
                Some(_) => format!("{c} = w;"),
            };
            let _ = writeln!(text, "    case {i}: {line} break;");
        }
        text += "    default: break;\n  }\n}\nstatic void show(void)\n{\n  uint64_t w;\n";
        for p in &self.places {
            let c = &p.c;
            let line = match Type::named(&p.ty) {
                Some(Type::Real | Type::Lreal) => format!("w = 0; memcpy(&w, &{c}, sizeof {c}); put(w);"),
                Some(Type::Time | Type::Moment(_)) => format!("put(of_time({c}));"),
                Some(Type::String(_)) | None => "put(0);".to_owned(),
                Some(Type::Bool) => format!("put({c} ? 1 : 0);"),
                Some(
                    Type::Usint
                    | Type::Uint
                    | Type::Udint
                    | Type::Ulint
                    | Type::Byte
                    | Type::Word
                    | Type::Dword
                    | Type::Lword,
                ) => format!("put((uint64_t){c});"),
                Some(_) => format!("put((uint64_t)(int64_t){c});"),
            };
            let _ = writeln!(text, "  {line}");
        }
        text += "}\nint main(void)\n{\n  uint64_t now, n, i, w;\n  __CURRENT_TIME = to_time(0);\n  config_init__();\n  \
                 while (get(&now) && get(&n)) {\n    while (n-- > 0 && get(&i) && get(&w)) set(i, w);\n    \
                 __CURRENT_TIME = to_time(now);\n    config_run__((unsigned long)(now / common_ticktime__));\n    \
                 show();\n  }\n  return 0;\n}\n";
        text
    }
}

/// Compiles the C that matiec has put into a folder, plays the scans and returns what is seen.
///
/// # Errors
///
/// The compiler refuses the code, or the program fails.
pub fn of_matiec(folder: &Path, library: &Path, scans: &[Scan]) -> Result<Vec<Sight>, String> {
    Built::new(folder, library, &[], |_| true)?.play(scans)
}

/// A project that is compiled.
pub struct Built {
    folder: PathBuf,
    program: Program,
}

impl Built {
    /// Compiles the C that matiec has put into a folder. `flags` are further options of gcc. Only the variables and steps
    /// whose name is `wanted` can be set and are seen.
    ///
    /// # Errors
    ///
    /// The compiler refuses the code.
    pub fn new(
        folder: &Path,
        library: &Path,
        flags: &[&str],
        wanted: impl Fn(&str) -> bool,
    ) -> Result<Built, String> {
        let mut program = Program::read(folder)?;
        program.places.retain(|p| wanted(&p.name));
        let fail = |e: std::io::Error| e.to_string();
        std::fs::write(folder.join("main.c"), program.main()).map_err(fail)?;
        let mut files = vec!["main.c".to_owned()];
        for entry in std::fs::read_dir(folder).map_err(fail)?.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.ends_with(".c") && name != "POUS.c" && name != "main.c" {
                files.push(name);
            }
        }
        // Each with a limit of time.
        let mut gcc = Command::new("timeout");
        gcc.args(["60", "gcc"]);
        gcc.current_dir(folder).arg("-I").arg(library).args(["-w", "-O0", "-std=gnu99", "-o", "project"]);
        run(gcc.args(flags).args(&files).arg("-lm"))?;
        Ok(Built { folder: folder.to_owned(), program })
    }

    /// Plays the scans from the start and returns what is seen.
    ///
    /// # Errors
    ///
    /// The program fails.
    pub fn play(&self, scans: &[Scan]) -> Result<Vec<Sight>, String> {
        let places = &self.program.places;
        let fail = |e: std::io::Error| e.to_string();
        let names: BTreeMap<String, u64> =
            places.iter().enumerate().map(|(i, p)| (p.name.clone(), i as u64)).collect();
        let mut input: Vec<u64> = Vec::new();
        for scan in scans {
            let given: Vec<(u64, u64)> =
                scan.inputs.iter().filter_map(|(n, w)| Some((found(&names, n)?, *w))).collect();
            input.extend([scan.now as u64, given.len() as u64]);
            given.iter().for_each(|(i, w)| input.extend([*i, *w]));
        }
        let bytes: Vec<u8> = input.iter().flat_map(|w| w.to_le_bytes()).collect();
        let file = self.folder.join("input");
        std::fs::write(&file, bytes).map_err(fail)?;
        let stdin = Stdio::from(std::fs::File::open(file).map_err(fail)?);
        let program = self.folder.join("project");
        let out = run(Command::new("timeout").arg("60").arg(program).stdin(stdin))?;
        let words: Vec<u64> = out.as_chunks::<8>().0.iter().map(|c| u64::from_le_bytes(*c)).collect();
        let sight = |part: &[u64]| places.iter().map(|p| p.name.clone()).zip(part.iter().copied()).collect();
        Ok(words.chunks_exact(places.len().max(1)).map(sight).collect())
    }
}

fn run(command: &mut Command) -> Result<Vec<u8>, String> {
    let out = command.output().map_err(|e| e.to_string())?;
    if out.status.success() {
        return Ok(out.stdout);
    }
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    let first = said.lines().find(|l| l.contains("error")).or(said.lines().next());
    Err(first.unwrap_or("it ends with a signal").to_owned())
}
