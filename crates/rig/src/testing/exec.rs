//! Executes a test: one function for each statement. The meaning is the book's page on tests.

use std::collections::BTreeSet;

use g7_engine::eval;
use g7_host::{Chronogram, Clock, Halt, Kind, Recording, Runner, Start, Style, Value, read_text};
use g7_model::{Nanos, Said, Span, Type, say};
use g7_why::Cause;

use super::coverage::Coverage;
use super::statements::{Check, Does, Line, Plan};
use super::why::Causes;
use crate::Source;
use crate::{Answer, Bench, Conflicts, Item, Role, fault};

/// The failure of a test, with what helps to understand it.
#[derive(Clone, Debug, Default)]
pub struct Defect {
    /// The place of the statement.
    pub at: Span,
    /// The same place as `path:line:column`.
    pub place: String,
    /// A sentence that says what happened, without the expression.
    pub what: Said,
    /// The failed condition as written; empty if no condition failed.
    pub expected: String,
    /// The names in the condition, with their values.
    pub got: Vec<(String, String)>,
    /// The time since the start of the test.
    pub time: Nanos,
    /// The active steps.
    pub situation: String,
    /// A chronogram of the relevant signals up to the failure.
    pub chronogram: String,
    /// The place in charts or plant at which a fault occurred.
    pub origin: Option<String>,
    /// Why the names in the condition have their values.
    pub why: Vec<Cause>,
    /// True if the test was ended because it took too much real time.
    pub overdue: bool,
    /// The input words that each scan read, from the first scan to the failure. Empty if inputs alone do not lead
    /// there (something was forced, written or restarted), or if they are too many.
    pub inputs: Vec<Vec<u64>>,
    expected_at: Option<Span>,
    origin_at: Option<Span>,
}

impl Defect {
    /// The event, with the condition that failed.
    pub fn sentence(&self) -> Said {
        if self.expected.is_empty() {
            return self.what.clone();
        }
        say!("{}: {}", self.what, Said::foreign(&*self.expected))
    }

    /// Adds what only the source knows: places and the text of the condition.
    pub(super) fn describe(&mut self, source: &Source) {
        self.place = source.place(self.at);
        self.origin = self.origin_at.map(|at| source.place(at));
        if let Some(at) = self.expected_at {
            let text = source.written(at);
            self.expected = text.split_whitespace().collect::<Vec<_>>().join(" ");
        }
    }
}

/// The end of a run of a test.
pub(super) struct Done {
    pub(super) defect: Option<Box<Defect>>,
    pub(super) simulated: Nanos,
    pub(super) scans: u64,
    /// Observations that did not make the test fail.
    pub(super) notes: Vec<Said>,
    pub(super) recording: Option<Recording>,
}

/// Why the execution of the statements stops.
enum Stop {
    Failed(Box<Defect>),
    /// A fault, which a later statement may expect.
    Fault(Halt),
}

/// The real time that a test may take.
pub(super) struct Limit<'c> {
    clock: &'c mut dyn Clock,
    length: Nanos,
    end: Nanos,
    turn: u32,
}

impl<'c> Limit<'c> {
    /// A limit that begins now.
    pub(super) fn new(clock: &'c mut dyn Clock, length: Nanos) -> Limit<'c> {
        let end = clock.now() + length;
        Limit { clock, length, end, turn: 0 }
    }

    /// True if the time is over; the clock is asked now and then.
    fn is_over(&mut self) -> bool {
        self.turn += 1;
        self.turn.is_multiple_of(64) && self.clock.now() >= self.end
    }
}

/// A run that is recorded.
#[derive(Clone, Copy)]
pub(super) struct Record {
    pub(super) causes: Option<Causes>,
    /// Changes of each signal that are kept; the latest.
    pub(super) limit: usize,
}

/// Runs a test, beginning with the charts' first scan.
pub(super) fn run<'b>(
    bench: &'b Bench,
    plan: &'b Plan,
    seed: u64,
    coverage: Option<&mut Coverage>,
    record: Option<Record>,
    limit: Option<Limit<'_>>,
) -> Done {
    let causes = record.and_then(|r| r.causes);
    let kept = record.map(|r| r.limit);
    let record = record.is_some();
    let mut exec = Exec {
        bench,
        runner: if causes.is_some() { bench.runner(seed).with_tape() } else { bench.runner(seed) },
        causes,
        recording: kept.map(|most| Recording::new(bench.signals()).with_limit(most)),
        inputs: record.then(Vec::new),
        always: Vec::new(),
        coverage,
        at: Span::default(),
        conflicts: Conflicts::default(),
        notes: Vec::new(),
        limit,
    };
    let ended = exec.scan().and_then(|()| exec.block(&plan.lines));
    let mut defect = match ended {
        Ok(()) => None,
        Err(Stop::Failed(defect)) => Some(defect),
        Err(Stop::Fault(halt)) => Some(exec.fault(halt)),
    };
    if let Some(defect) = &mut defect {
        defect.inputs = exec.inputs.take().unwrap_or_default();
    }
    Done {
        defect,
        simulated: exec.now(),
        scans: exec.runner.state().scans(),
        notes: exec.notes,
        recording: exec.recording,
    }
}

struct Exec<'b, 'c, 'l> {
    bench: &'b Bench,
    runner: Runner,
    recording: Option<Recording>,
    causes: Option<Causes>,
    /// The inputs of each scan; none where they do not say how the charts came here.
    inputs: Option<Vec<Vec<u64>>>,
    /// The conditions of the enclosing `always` blocks.
    always: Vec<&'b Check>,
    coverage: Option<&'c mut Coverage>,
    /// The statement that is being executed.
    at: Span,
    conflicts: Conflicts,
    notes: Vec<Said>,
    limit: Option<Limit<'l>>,
}

impl<'b> Exec<'b, '_, '_> {
    fn block(&mut self, lines: &'b [Line]) -> Result<(), Stop> {
        let mut lines = lines.iter();
        while let Some(line) = lines.next() {
            self.at = line.at;
            match self.line(line) {
                Err(Stop::Fault(halt)) => match lines.as_slice().first().map(|l| &l.does) {
                    // The statement that caused the fault ends early, because this one expects the
                    // fault.
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

    /// Ends the test if it takes too much real time.
    fn tick(&mut self) -> Result<(), Stop> {
        let Some(limit) = self.limit.as_mut() else { return Ok(()) };
        if !limit.is_over() {
            return Ok(());
        }
        let length = Said::foreign(limit.length.plain());
        let what = say!("ended after {length} of real time, the limit of a test");
        let Stop::Failed(mut defect) = self.failed(what, None) else { return Ok(()) };
        defect.overdue = true;
        Err(Stop::Failed(defect))
    }

    fn line(&mut self, line: &'b Line) -> Result<(), Stop> {
        self.tick()?;
        match &line.does {
            Does::Set(puts) => self.set(puts),
            Does::Pulse(item, time) => self.pulse(*item, *time),
            Does::Wait(time) => self.pass_time(*time),
            Does::WaitUntil(check, within) => self.wait_until(check, *within),
            Does::Scan(count) => (0..*count).try_for_each(|_| self.scan()),
            Does::Expect(checks) => checks.iter().try_for_each(|c| self.expect(c, say!("expected"))),
            Does::ExpectFault(word) => match self.runner.halt() {
                Some(halt) => self.expect_fault(halt, word.as_deref()),
                None => Err(self.failed(say!("expected a fault, there is none"), None)),
            },
            Does::Always(checks, body) => self.always(checks, body),
            Does::Force(item, ask) => {
                let (Some(item), answer) = (self.bench.items.get(*item), self.answer(*ask)) else {
                    return Ok(());
                };
                let value = self.value(item, answer)?;
                self.inputs = None;
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
                self.inputs = None;
                self.runner.restart(if *cold { Start::Cold } else { Start::Warm });
                self.scan()
            }
            Does::Repeat(count, body) => (0..*count).try_for_each(|_| {
                self.tick()?;
                self.block(body)
            }),
            Does::Nothing => Ok(()),
        }
    }

    fn now(&self) -> Nanos {
        Nanos::new(self.runner.state().now())
    }

    /// Makes one scan, then checks the conditions of the enclosing `always` blocks.
    fn scan(&mut self) -> Result<(), Stop> {
        self.tick()?;
        let done = self.runner.scan();
        if let Some(coverage) = &mut self.coverage {
            coverage.see(self.bench, self.runner.charts_mut().1);
        }
        if let Some(recording) = &mut self.recording {
            recording.sample(Nanos::new(self.runner.state().now()), self.bench.sample(&self.runner));
        }
        self.note_inputs();
        done.map_err(Stop::Fault)?;
        self.notes.extend(self.conflicts.of(self.bench, &self.runner));
        for check in self.always.clone() {
            self.expect(check, say!("this did not hold throughout"))?;
        }
        Ok(())
    }

    /// Notes what the scan has read.
    fn note_inputs(&mut self) {
        let read = self.runner.read();
        if let Some(inputs) = &mut self.inputs {
            inputs.push(read.to_vec());
            if inputs.len() * read.len().max(1) > WORDS {
                self.inputs = None;
            }
        }
    }

    /// Makes scans until the time has passed.
    fn pass_time(&mut self, time: Nanos) -> Result<(), Stop> {
        let end = self.now() + time;
        while self.now() < end {
            self.scan()?;
        }
        Ok(())
    }

    fn set(&mut self, puts: &[(usize, usize)]) -> Result<(), Stop> {
        for (item, ask) in puts {
            let (Some(item), answer) = (self.bench.items.get(*item), self.answer(*ask)) else { continue };
            let value = self.value(item, answer)?;
            if !matches!(item.role, Role::Input(_)) {
                self.inputs = None;
            }
            self.bench.set(&mut self.runner, item, &value);
        }
        self.scan()
    }

    fn pulse(&mut self, item: usize, time: Option<Nanos>) -> Result<(), Stop> {
        let Some(item) = self.bench.items.get(item) else { return Ok(()) };
        self.bench.set(&mut self.runner, item, &Value::Word(1));
        match time {
            Some(time) => self.pass_time(time)?,
            None => self.scan()?,
        }
        self.bench.set(&mut self.runner, item, &Value::Word(0));
        self.scan()
    }

    fn wait_until(&mut self, check: &'b Check, within: Nanos) -> Result<(), Stop> {
        let end = self.now() + within;
        while !self.holds(check)? {
            if self.now() >= end {
                let what = say!("not true within {}", Said::foreign(within.plain()));
                return Err(self.failed(what, Some(check)));
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

    fn expect(&mut self, check: &'b Check, what: Said) -> Result<(), Stop> {
        if self.holds(check)? { Ok(()) } else { Err(self.failed(what, Some(check))) }
    }

    fn expect_fault(&mut self, halt: Halt, word: Option<&str>) -> Result<(), Stop> {
        let Halt::Charts(fault) = halt else { return Err(Stop::Fault(halt)) };
        match word {
            Some(word) if word != fault.kind.word() => {
                let what = say!(
                    "expected fault {}, got {}",
                    Said::foreign(word),
                    self.bench.halt(&self.runner, halt)
                );
                Err(self.failed(what, None))
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
        // Expressions can still be evaluated on a stopped state.
        eval(program, state, answer.code)
            .map_err(|stopped| self.failed(say!("this cannot be evaluated: {}", fault(stopped.kind)), None))
    }

    /// The value of an expression, converted to the type of an item.
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
        convert(word, answer.ty, item).filter(|value| item.admits(value)).ok_or_else(|| {
            self.failed(
                say!("`{}` ({}) cannot hold this value", item.name, Said::foreign(item.declared())),
                None,
            )
        })
    }

    /// The value of a name in a condition, as text.
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

    fn failed(&mut self, what: Said, check: Option<&Check>) -> Stop {
        let mut got = Vec::new();
        for (name, ask) in check.iter().flat_map(|c| &c.mentions) {
            // A mention is a single name and cannot fail, so this call does not recurse.
            if let Some(text) = self.mention(*ask) {
                let held = self.bench.item(name).and_then(|item| item.held.as_ref());
                let value = held.zip(text.parse().ok()).and_then(|(held, n)| held.name_of(n));
                got.push((name.clone(), value.map_or(text.clone(), str::to_owned)));
            }
        }
        let names: Vec<&str> = got.iter().map(|(n, _)| n.as_str()).collect();
        Stop::Failed(Box::new(Defect {
            at: check.map_or(self.at, |c| c.at),
            what,
            time: self.now(),
            situation: self.situation(),
            chronogram: self.chronogram(&names),
            why: self.causes.map_or_else(Vec::new, |causes| causes(self.bench, &self.runner, &names)),
            expected_at: check.map(|c| c.at),
            got,
            ..Defect::default()
        }))
    }

    fn fault(&mut self, halt: Halt) -> Box<Defect> {
        Box::new(Defect {
            at: self.at,
            what: say!("fault: {}", self.bench.halt(&self.runner, halt)),
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

    /// The chronogram of a failure: first the names in the condition, then the signals that changed
    /// lately, steps before outputs, inputs and variables. Curves and states of the plant change
    /// all the time, so they appear only if the condition names them.
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
        let moves = |i: usize| recording.changes(i).skip(1).map(|(at, _)| at);
        let mut instants: Vec<Nanos> = others.iter().flat_map(|(_, i)| moves(*i)).collect();
        instants.sort_unstable_by(|a, b| b.cmp(a));
        instants.dedup();
        let least = self.now() - self.bench.period * 20;
        let from = instants.get(12).copied().unwrap_or(recording.start()).min(least).max(recording.start());
        for (_, i) in others {
            if lanes.len() < LANES && moves(i).any(|at| at >= from) {
                lanes.insert(i);
            }
        }
        // One period more, so that the last scan is visible.
        let to = recording.end() + self.bench.period;
        Chronogram::new(recording, lanes, Style { columns: 60, from, to, until: to }).to_string()
    }
}

/// The groups of signals, the most relevant first.
const GROUPS: [&str; 4] = ["steps", "outputs", "inputs", "variables"];
/// Most lanes of a failure's chronogram.
const LANES: usize = 14;
/// Most input words that are noted of a test.
const WORDS: usize = 1 << 20;

/// Converts a word of one type to the type of an item; `None` if the value does not fit.
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
        Type::Time | Type::Moment(_) => word,
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
