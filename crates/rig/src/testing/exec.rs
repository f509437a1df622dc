//! A test at work. One function a statement; the page on tests as code.

use std::collections::BTreeSet;

use g7_engine::eval;
use g7_host::{Chronogram, Halt, Kind, Recording, Runner, Start, Style, Value, format_time, read_text};
use g7_model::{Span, Type};

use super::coverage::Coverage;
use super::plan::{Check, Does, Line, Plan};
use crate::Source;
use crate::{Answer, Bench, Conflicts, Item};

/// Why a test failed, with all that helps to see why.
#[derive(Clone, Debug, Default)]
pub struct Defect {
    /// The statement.
    pub at: Span,
    /// `path:line:column` of it.
    pub place: String,
    /// What happened, in a sentence without the expression.
    pub what: String,
    /// The condition as written, where one failed.
    pub expected: String,
    /// What it mentions, as it was.
    pub got: Vec<(String, String)>,
    /// Time in the test, nanoseconds.
    pub time: i64,
    /// The active steps.
    pub situation: String,
    /// The signals that matter, up to the failure.
    pub chronogram: String,
    /// Where in charts or plant a fault came up.
    pub origin: Option<String>,
    expected_at: Option<Span>,
    origin_at: Option<Span>,
}

impl Defect {
    /// Fills in what the source knows: places and the author's words.
    pub(super) fn describe(&mut self, source: &Source) {
        self.place = source.place(self.at);
        self.origin = self.origin_at.map(|at| source.place(at));
        if let Some(at) = self.expected_at {
            let text = source.text.get(source.range(at)).unwrap_or("");
            self.expected = text.split_whitespace().collect::<Vec<_>>().join(" ");
        }
    }
}

/// How a run of a test ended.
pub(super) struct Done {
    pub(super) defect: Option<Box<Defect>>,
    pub(super) simulated: i64,
    pub(super) scans: u64,
    /// What deserves a look although nothing failed.
    pub(super) notes: Vec<String>,
}

/// Why the statements stop.
enum Stop {
    Failed(Box<Defect>),
    /// A fault that some statement may still expect.
    Fault(Halt),
}

/// Runs a test from the charts' first scan on.
pub(super) fn run<'b>(
    bench: &'b Bench,
    plan: &'b Plan,
    seed: u64,
    coverage: Option<&mut Coverage>,
    record: bool,
) -> Done {
    let mut exec = Exec {
        bench,
        runner: bench.runner(seed),
        recording: record.then(|| Recording::new(bench.signals()).with_limit(4_000)),
        always: Vec::new(),
        coverage,
        at: Span::default(),
        conflicts: Conflicts::default(),
        notes: Vec::new(),
    };
    let ended = exec.scan().and_then(|()| exec.block(&plan.lines));
    let defect = match ended {
        Ok(()) => None,
        Err(Stop::Failed(defect)) => Some(defect),
        Err(Stop::Fault(halt)) => Some(exec.fault(halt)),
    };
    Done { defect, simulated: exec.now(), scans: exec.runner.state().scans(), notes: exec.notes }
}

struct Exec<'b, 'c> {
    bench: &'b Bench,
    runner: Runner,
    recording: Option<Recording>,
    /// Conditions of the `always` blocks that are open.
    always: Vec<&'b Check>,
    coverage: Option<&'c mut Coverage>,
    /// The statement in hand.
    at: Span,
    conflicts: Conflicts,
    notes: Vec<String>,
}

impl<'b> Exec<'b, '_> {
    fn block(&mut self, lines: &'b [Line]) -> Result<(), Stop> {
        let mut lines = lines.iter();
        while let Some(line) = lines.next() {
            self.at = line.at;
            match self.line(line) {
                Err(Stop::Fault(halt)) => match lines.as_slice().first().map(|l| &l.does) {
                    // The statement that made the fault is cut short; this one expected it.
                    Some(Does::ExpectFault(word)) => {
                        self.at = lines.next().map_or(self.at, |l| l.at);
                        self.expect_fault(halt, word.as_deref())?;
                    }
                    _ => return Err(Stop::Fault(halt)),
                },
                done => done?,
            }
        }
        Ok(())
    }

    fn line(&mut self, line: &'b Line) -> Result<(), Stop> {
        match &line.does {
            Does::Set(puts) => self.set(puts),
            Does::Pulse(item, time) => self.pulse(*item, *time),
            Does::Wait(time) => self.pass_time(*time),
            Does::WaitUntil(check, within) => self.wait_until(check, *within),
            Does::Scan(count) => (0..*count).try_for_each(|_| self.scan()),
            Does::Expect(checks) => checks.iter().try_for_each(|c| self.expect(c, "expected")),
            Does::ExpectFault(word) => match self.runner.halt() {
                Some(halt) => self.expect_fault(halt, word.as_deref()),
                None => Err(self.failed("expected a fault, there is none", None)),
            },
            Does::Always(checks, body) => self.always(checks, body),
            Does::Force(item, ask) => {
                let (Some(item), answer) = (self.bench.items.get(*item), self.answer(*ask)) else {
                    return Ok(());
                };
                let value = self.value(item, answer)?;
                self.bench.force(&mut self.runner, item, &value);
                self.scan()
            }
            Does::Release(item) => {
                if let Some(item) = self.bench.items.get(*item) {
                    self.bench.release(&mut self.runner, item);
                }
                self.scan()
            }
            Does::Restart { cold } => {
                self.runner.restart(if *cold { Start::Cold } else { Start::Warm });
                self.scan()
            }
            Does::Repeat(count, body) => (0..*count).try_for_each(|_| self.block(body)),
            Does::Nothing => Ok(()),
        }
    }

    fn now(&self) -> i64 {
        self.runner.state().now()
    }

    /// One scan; then what must always hold is looked at.
    fn scan(&mut self) -> Result<(), Stop> {
        let done = self.runner.scan();
        if let Some(coverage) = &mut self.coverage {
            coverage.see(self.bench, &mut self.runner);
        }
        if let Some(recording) = &mut self.recording {
            recording.sample(self.runner.state().now(), self.bench.sample(&self.runner));
        }
        done.map_err(Stop::Fault)?;
        self.notes.extend(self.conflicts.of(self.bench, &self.runner));
        for check in self.always.clone() {
            self.expect(check, "this did not hold throughout")?;
        }
        Ok(())
    }

    /// Scans until the time has passed.
    fn pass_time(&mut self, time: i64) -> Result<(), Stop> {
        let end = self.now().saturating_add(time);
        while self.now() < end {
            self.scan()?;
        }
        Ok(())
    }

    fn set(&mut self, puts: &[(usize, usize)]) -> Result<(), Stop> {
        for (item, ask) in puts {
            let (Some(item), answer) = (self.bench.items.get(*item), self.answer(*ask)) else { continue };
            let value = self.value(item, answer)?;
            self.bench.set(&mut self.runner, item, &value);
        }
        self.scan()
    }

    fn pulse(&mut self, item: usize, time: Option<i64>) -> Result<(), Stop> {
        let Some(item) = self.bench.items.get(item) else { return Ok(()) };
        self.bench.set(&mut self.runner, item, &Value::Word(1));
        match time {
            Some(time) => self.pass_time(time)?,
            None => self.scan()?,
        }
        self.bench.set(&mut self.runner, item, &Value::Word(0));
        self.scan()
    }

    fn wait_until(&mut self, check: &'b Check, within: i64) -> Result<(), Stop> {
        let end = self.now().saturating_add(within);
        while !self.holds(check)? {
            if self.now() >= end {
                let what = format!("not true within {}", format_time(within));
                return Err(self.failed(&what, Some(check)));
            }
            self.scan()?;
        }
        Ok(())
    }

    fn always(&mut self, checks: &'b [Check], body: &'b [Line]) -> Result<(), Stop> {
        let before = self.always.len();
        self.always.extend(checks);
        let done = self.block(body);
        self.always.truncate(before);
        done
    }

    fn expect(&mut self, check: &'b Check, what: &str) -> Result<(), Stop> {
        if self.holds(check)? { Ok(()) } else { Err(self.failed(what, Some(check))) }
    }

    fn expect_fault(&mut self, halt: Halt, word: Option<&str>) -> Result<(), Stop> {
        let Halt::Charts(fault) = halt else { return Err(Stop::Fault(halt)) };
        match word {
            Some(word) if word != fault.kind.word() => {
                let what = format!("expected fault {word}, got {}", self.bench.halt(&self.runner, halt));
                Err(self.failed(&what, None))
            }
            _ => Ok(()),
        }
    }

    fn answer(&self, ask: usize) -> Option<Answer> {
        self.bench.answers.get(ask).copied()
    }

    fn holds(&mut self, check: &Check) -> Result<bool, Stop> {
        for asked in &check.asks {
            let Some(answer) = self.answer(asked.ask) else { return Ok(false) };
            if self.eval(answer)? == 0 {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn eval(&mut self, answer: Answer) -> Result<u64, Stop> {
        let (program, state) = if answer.of_plant {
            let Some(plant) = self.runner.plant_mut() else { return Ok(0) };
            plant
        } else {
            self.runner.charts_mut()
        };
        // A stopped state still has values to look at.
        eval(program, state, answer.code).map_err(|fault| {
            let what = format!("this cannot be evaluated: {}", fault.kind);
            self.failed(&what, None)
        })
    }

    /// The value of an expression as an item takes it.
    fn value(&mut self, item: &Item, answer: Option<Answer>) -> Result<Value, Stop> {
        let Some(answer) = answer else { return Ok(Value::Word(0)) };
        let word = self.eval(answer)?;
        let words = if answer.of_plant {
            self.runner.plant().map_or(&[][..], |(_, s)| s.words())
        } else {
            self.runner.state().words()
        };
        if item.kind == Kind::Text {
            return Ok(Value::Text(read_text(words, word as u32).into()));
        }
        convert(word, answer.ty, item).ok_or_else(|| {
            let what = format!("`{}` ({}) cannot hold this value", item.name, item.ty);
            self.failed(&what, None)
        })
    }

    /// The text of what a condition mentions.
    fn mention(&mut self, ask: usize) -> Option<String> {
        let answer = self.answer(ask)?;
        let word = self.eval(answer).ok()?;
        let words =
            if answer.of_plant { self.runner.plant()?.1.words() } else { self.runner.state().words() };
        Some(match answer.ty {
            Type::String(_) => format!("'{}'", read_text(words, word as u32)),
            ty => g7_compile::symbols::Symbols::value_text(ty, &[word]),
        })
    }

    fn failed(&mut self, what: &str, check: Option<&Check>) -> Stop {
        let mut got = Vec::new();
        for (name, ask) in check.iter().flat_map(|c| &c.mentions) {
            // No recursion: a mention is a bare path, it has no fault of its own.
            if let Some(text) = self.mention(*ask) {
                got.push((name.clone(), text));
            }
        }
        let names: Vec<&str> = got.iter().map(|(n, _)| n.as_str()).collect();
        Stop::Failed(Box::new(Defect {
            at: check.map_or(self.at, |c| c.at),
            what: what.to_owned(),
            time: self.now(),
            situation: self.situation(),
            chronogram: self.chronogram(&names),
            expected_at: check.map(|c| c.at),
            got,
            ..Defect::default()
        }))
    }

    fn fault(&mut self, halt: Halt) -> Box<Defect> {
        Box::new(Defect {
            at: self.at,
            what: format!("fault: {}", self.bench.halt(&self.runner, halt)),
            origin_at: self.bench.halt_place(halt),
            time: self.now(),
            situation: self.situation(),
            chronogram: self.chronogram(&[]),
            ..Defect::default()
        })
    }

    fn situation(&self) -> String {
        format!("{{{}}}", self.bench.situation(self.runner.state()).join(", "))
    }

    /// What the condition mentions, then what moved lately: steps before
    /// outputs, inputs and variables. Curves and the plant's own affairs only
    /// where they are mentioned: they move all the time.
    fn chronogram(&self, names: &[&str]) -> String {
        let Some(recording) = &self.recording else { return String::new() };
        let all = || recording.signals().iter().enumerate();
        let mut lanes: BTreeSet<usize> =
            all().filter(|(_, s)| names.contains(&s.name.as_str())).map(|(i, _)| i).collect();
        let mut others: Vec<(usize, usize)> = all()
            .filter(|(_, s)| !matches!(s.kind, Kind::Real | Kind::Lreal))
            .filter_map(|(i, s)| Some((GROUPS.iter().position(|g| *g == s.group)?, i)))
            .collect();
        others.sort_unstable();
        let moves = |i: usize| recording.changes(i).skip(1).map(|(at, _)| *at);
        let mut instants: Vec<i64> = others.iter().flat_map(|(_, i)| moves(*i)).collect();
        instants.sort_unstable_by(|a, b| b.cmp(a));
        instants.dedup();
        let least = self.now().saturating_sub(self.bench.period.saturating_mul(20));
        let from = instants.get(12).copied().unwrap_or(recording.start()).min(least).max(recording.start());
        for (_, i) in others {
            if lanes.len() < LANES && moves(i).any(|at| at >= from) {
                lanes.insert(i);
            }
        }
        // One scan more than there was, so that the last one has room.
        let to = recording.end().saturating_add(self.bench.period);
        Chronogram::new(recording, lanes, Style { columns: 60, from, to, until: to }).to_string()
    }
}

/// Which signals matter first.
const GROUPS: [&str; 4] = ["steps", "outputs", "inputs", "variables"];
/// Most lanes of a failure's chronogram.
const LANES: usize = 14;

/// A word of one type as the value of an item, where it can hold it.
fn convert(word: u64, from: Type, item: &Item) -> Option<Value> {
    let whole = |word: u64| -> Option<i128> {
        let (least, _) = from.bounds()?;
        Some(if least < 0 { i128::from(word as i64) } else { i128::from(word) })
    };
    let number = |word: u64| match from {
        Type::Real => f64::from(f32::from_bits(word as u32)),
        Type::Lreal => f64::from_bits(word),
        _ => whole(word).unwrap_or(0) as f64,
    };
    let value = match item.ty {
        Type::Bool => u64::from(word != 0),
        Type::Real => u64::from((number(word) as f32).to_bits()),
        Type::Lreal => number(word).to_bits(),
        Type::Time => word,
        ty => {
            let (least, most) = ty.bounds()?;
            let n = whole(word)?;
            if n < least || n > most {
                return None;
            }
            n as u64
        }
    };
    Some(Value::Word(value))
}
