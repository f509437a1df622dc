//! Compares generated code with the engine: the events of a chart and the engine's results are
//! recorded scan by scan, the compiled code plays the same events, and the results are compared
//! word by word.
//!
//! Many charts are compiled into one program, because starting a compiler is slow. The program
//! reads events from its standard input and writes results to its standard output.

pub mod blocks;
mod c;
pub mod cases;
pub mod plc;
pub mod project;
mod rust;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

use g7_codegen::{Language, Options, Parts, Printed, Room, Style};
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_compile::{Compiled, compile_with};
use g7_engine::{Addr, FaultKind, State, StepId, scan};
use g7_model::{Document, ProfileName, Severity, Type};

use crate::case::{Line, Trace};
use crate::generate::{Event, Script};
use crate::naive::{Naive, Value};

pub use c::c_program;
pub use rust::rust_program;

/// A chart, its events, and the engine's results.
#[derive(Debug)]
pub struct Subject {
    /// Its name in messages.
    pub title: String,
    /// The compiled chart.
    pub compiled: Compiled,
    /// Its text.
    pub text: String,
    /// The events, in the form that the program reads.
    pub input: Vec<u8>,
    /// The results of the engine, scan by scan.
    pub expected: Vec<Seen>,
    /// Number of scans without a fault.
    pub sound: usize,
    /// How much room its code may take.
    pub room: Room,
    /// The times of its scans, in nanoseconds.
    times: Vec<i64>,
}

/// The result of one scan: the fault, then the words of all variables.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    fault: u64,
    words: Vec<u64>,
}

/// The number of a fault in generated code.
fn number(kind: FaultKind) -> u64 {
    match kind {
        FaultKind::Unstable { .. } => 1,
        FaultKind::Bound | FaultKind::Work => 2,
        FaultKind::Overflow => 3,
        FaultKind::DivisionByZero => 4,
        FaultKind::Range => 5,
        FaultKind::Forcing { .. } => 6,
        FaultKind::Table => 7,
        FaultKind::Inputs => 8,
        FaultKind::Stopped => 9,
    }
}

/// The variables that are compared, in their order.
pub(crate) fn visible(compiled: &Compiled) -> impl Iterator<Item = &Variable> {
    compiled.symbols.variables.iter().filter(|v| {
        let own =
            matches!(v.class, VarClass::Input | VarClass::Output | VarClass::Internal | VarClass::System);
        own && !matches!(v.ty, Type::Fb(_))
    })
}

/// Replaces every NaN by the same bits, because its bits differ between machines.
fn plain(ty: Type, word: u64) -> u64 {
    match ty {
        Type::Real if f32::from_bits(word as u32).is_nan() => 0x7fc0_0000,
        Type::Lreal if f64::from_bits(word).is_nan() => 0x7ff8_0000_0000_0000,
        _ => word,
    }
}

fn values<'a>(compiled: &'a Compiled, state: &'a State, outputs: bool) -> Vec<u64> {
    let wanted = visible(compiled).filter(|v| !outputs || v.class == VarClass::Output);
    wanted.flat_map(|v| v.value(state).iter().map(|w| plain(v.ty, *w))).collect()
}

impl Subject {
    /// A chart without events.
    ///
    /// # Errors
    ///
    /// The first problem of the chart.
    pub fn new(
        title: &str,
        doc: &Document,
        profile: Option<ProfileName>,
        text: &str,
    ) -> Result<Subject, String> {
        let profile = profile.filter(|p| *p != doc.profile().map(|d| d.name).unwrap_or_default());
        let (compiled, problems) = compile_with(doc, profile, &[]);
        let Some(compiled) = compiled else {
            let first = problems.iter().find(|p| p.severity() == Severity::Error);
            return Err(first.map_or("no program".into(), |p| format!("{} {}", p.code.id, p.what)));
        };
        let (title, text) = (title.to_owned(), text.to_owned());
        Ok(Subject {
            title,
            compiled,
            text,
            input: Vec::new(),
            expected: Vec::new(),
            sound: 0,
            room: Room::default(),
            times: Vec::new(),
        })
    }

    fn fresh(&self) -> State {
        State::new(&self.compiled.program)
    }

    fn restarted(&self, cold: bool, old: &State) -> State {
        let (p, symbols) = (&self.compiled.program, &self.compiled.symbols);
        let mut fresh = self.fresh();
        if !cold {
            for v in symbols.variables.iter().filter(|v| v.retain) {
                for (i, word) in v.value(old).iter().enumerate() {
                    fresh.set_word(p, Addr(v.addr.0 + i as u32), *word);
                }
            }
            for (addr, word) in [(symbols.s0, 0), (symbols.s1, 1)] {
                if let Some(addr) = addr {
                    fresh.set_word(p, addr, word);
                }
            }
        }
        fresh
    }

    /// Plays a script on the engine and records the events and the results.
    ///
    /// # Errors
    ///
    /// The script names an input that does not exist.
    pub fn play(&mut self, script: &Script) -> Result<(), String> {
        let mut state = self.fresh();
        let table = self.compiled.program.tables().inputs;
        let mut inputs = state.words().get(table.start as usize..table.end as usize).unwrap_or(&[]).to_vec();
        self.input.push(3);
        for event in script {
            let (now, values) = match event {
                Event::Restart { cold } => {
                    self.input.push(if *cold { 3 } else { 2 });
                    state = self.restarted(*cold, &state);
                    continue;
                }
                Event::Scan { now, inputs } => (*now, inputs),
            };
            for (name, value) in values {
                let v = self.compiled.symbols.variable(name).ok_or_else(|| format!("no input {name}"))?;
                for (i, word) in crate::engine::words(value).into_iter().enumerate() {
                    if let Some(slot) = inputs.get_mut((v.addr.0 - table.start) as usize + i) {
                        *slot = word;
                    }
                }
            }
            self.input.push(1);
            self.times.push(now);
            self.input.extend(now.to_le_bytes());
            inputs.iter().for_each(|w| self.input.extend(w.to_le_bytes()));
            let program = &self.compiled.program;
            match scan(program, &mut state, &inputs, now) {
                Ok(_) => {
                    let steps = (0..self.compiled.symbols.steps()).map(StepId);
                    let mut words: Vec<u64> = steps
                        .flat_map(|s| [u64::from(state.is_active(s)), state.step_time(program, s) as u64])
                        .collect();
                    words.extend(self::values(&self.compiled, &state, false));
                    self.expected.push(Seen { fault: 0, words });
                    self.sound += 1;
                }
                Err(fault) => {
                    let words = self::values(&self.compiled, &state, true);
                    self.expected.push(Seen { fault: number(fault.kind), words });
                    self.input.push(3);
                    state = self.fresh();
                }
            }
        }
        Ok(())
    }

    /// Plays a trace of a conformance case on the engine and records it.
    ///
    /// # Errors
    ///
    /// The inputs of the trace cannot be read.
    pub fn replay(&mut self, doc: &Document, profile: ProfileName, trace: &Trace) -> Result<(), String> {
        let names = Naive::new(doc, Some(profile))?;
        let inputs = names.inputs();
        let mut script = Script::new();
        for line in &trace.lines {
            script.push(match line {
                Line::Restart { cold } => Event::Restart { cold: *cold },
                Line::Row(row) => {
                    let inputs: BTreeMap<String, Value> = crate::replay::input_values(row, &inputs, &names)?;
                    Event::Scan { now: row.at, inputs }
                }
            });
        }
        self.play(&script)
    }

    /// Makes it a subject for code that takes this much room: the clock turns in whole units and never back, and
    /// steps whose time is not read have none. False where its times do not allow that.
    pub fn fit(&mut self, room: Room) -> bool {
        let backward = self.times.windows(2).any(|w| matches!(w, [a, b] if b < a));
        let span = self.times.iter().max().zip(self.times.iter().min()).map_or(0, |(a, b)| a - b);
        let long = backward || span > room.clock.longest();
        !long && self.fit_whole(room)
    }

    /// The same however long it runs: times of steps end at the longest that the clock tells.
    pub fn fit_whole(&mut self, room: Room) -> bool {
        let unit = room.clock.nanoseconds();
        if self.times.iter().any(|t| t % unit != 0) {
            return false;
        }
        self.room = room;
        let Ok(printed) = self.print(Language::C, Style::Structured, "c") else { return false };
        let steps = self.compiled.symbols.steps();
        for seen in self.expected.iter_mut().filter(|s| s.fault == 0) {
            for step in 0..steps {
                let longest = if printed.places.has_time(StepId(step)) { room.clock.longest() } else { 0 };
                if let Some(word) = seen.words.get_mut(2 * step as usize + 1) {
                    *word = (*word).min(longest as u64);
                }
            }
        }
        true
    }

    /// Generates the code of the chart.
    ///
    /// # Errors
    ///
    /// The language cannot express the chart.
    pub fn print(&self, language: Language, style: Style, name: &str) -> Result<Printed, String> {
        self.print_as(language, style, name, Parts::Whole)
    }

    /// The same in these files.
    ///
    /// # Errors
    ///
    /// The language cannot express the chart.
    pub fn print_as(
        &self,
        language: Language,
        style: Style,
        name: &str,
        parts: Parts,
    ) -> Result<Printed, String> {
        let options = Options { language, style, room: self.room, name, source: &self.text };
        g7_codegen::print_as(&self.compiled, &options, parts)
            .map_err(|p| p.iter().map(|p| p.what.to_string()).collect::<Vec<_>>().join("; "))
    }

    fn word_name(&self, fault: u64, at: usize) -> String {
        let steps = self.compiled.symbols.steps() as usize;
        let mut left = at;
        if fault == 0 {
            if at < 2 * steps {
                let name = self.compiled.symbols.step_path(StepId((at / 2) as u32));
                return format!("{}{name}", if at.is_multiple_of(2) { "X of " } else { "time of " });
            }
            left -= 2 * steps;
        }
        for v in visible(&self.compiled).filter(|v| fault == 0 || v.class == VarClass::Output) {
            let words = v.words() as usize;
            if left < words {
                return format!("{}[{left}]", v.name);
            }
            left -= words;
        }
        "?".into()
    }
}

/// Reads a stream of words.
struct Words<'a> {
    bytes: &'a [u8],
}

impl Words<'_> {
    fn next(&mut self) -> Option<u64> {
        let (word, rest) = self.bytes.split_first_chunk::<8>()?;
        self.bytes = rest;
        Some(u64::from_le_bytes(*word))
    }
}

/// Runs a compiled program with the events of its charts and compares the results.
///
/// # Errors
///
/// The program fails, or the first difference of each chart.
pub fn compare(program: &Path, subjects: &[&Subject]) -> Result<(), String> {
    let mut input = Vec::new();
    for (i, subject) in subjects.iter().enumerate() {
        input.extend((i as u32).to_le_bytes());
        input.extend(&subject.input);
        input.push(0);
    }
    let file = program.with_extension("input");
    std::fs::write(&file, input).map_err(|e| e.to_string())?;
    let stdin = std::fs::File::open(&file).map_err(|e| e.to_string())?;
    let out = Command::new(program).stdin(Stdio::from(stdin)).output().map_err(|e| e.to_string())?;
    let mut words = Words { bytes: &out.stdout };
    let mut wrong = Vec::new();
    for subject in subjects {
        if let Err(why) = subject.differs(&mut words) {
            wrong.push(format!("{}: {why}", subject.title));
            break; // later words would be misread
        }
    }
    if !out.status.success() {
        let said = String::from_utf8_lossy(&out.stderr);
        wrong.push(format!("{}: {}", out.status, said.lines().take(12).collect::<Vec<_>>().join("\n")));
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}

impl Subject {
    fn differs(&self, words: &mut Words<'_>) -> Result<(), String> {
        for (i, seen) in self.expected.iter().enumerate() {
            let fault = words.next().ok_or("it ended early")?;
            let count = words.next().ok_or("it ended early")?;
            let mut got = Vec::new();
            for _ in 0..count.min(1 << 20) {
                got.push(words.next().ok_or("it ended early")?);
            }
            if fault != seen.fault {
                return Err(format!("scan {i}: fault {} of the engine, {fault} of the code", seen.fault));
            }
            if got.len() != seen.words.len() {
                return Err(format!("scan {i}: {} words against {}", seen.words.len(), got.len()));
            }
            let wrong: Vec<String> = (0..got.len())
                .filter(|k| got.get(*k) != seen.words.get(*k))
                .take(6)
                .map(|k| {
                    let (a, b) = (seen.words.get(k).copied(), got.get(k).copied());
                    format!("{}: {} against {}", self.word_name(fault, k), text(a), text(b))
                })
                .collect();
            if !wrong.is_empty() {
                return Err(format!("scan {i}: {}", wrong.join(", ")));
            }
        }
        Ok(())
    }
}

fn text(word: Option<u64>) -> String {
    word.map_or("nothing".into(), |w| (w as i64).to_string())
}

pub(crate) fn run(command: &mut Command) -> Result<(), String> {
    let out = command.output().map_err(|e| e.to_string())?;
    if out.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&out.stderr);
    Err(said.lines().take(60).collect::<Vec<_>>().join("\n"))
}
