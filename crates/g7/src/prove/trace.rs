//! Runs of the prover as chronograms, made by a run of the bench.

use g7_host::{Chronogram, Recording, Runner, Signal, Style};
use g7_model::{Nanos, ProfileName, Said, say};
use g7_rig::testing::causes;
use g7_rig::{Bench, Role, Source};
use g7_verify::Move;
use g7_why::Cause;

use crate::failure::{Failure, raw};
use crate::message::told;

/// Most columns of a chronogram, least, and most for one scan.
const COLUMNS: usize = 60;
const FEW: usize = 12;
const EACH: usize = 6;
/// Scans of a chronogram where the columns are too few for all of a run.
const LAST: usize = 30;
/// Most lanes of a chronogram.
const LANES: usize = 16;
/// The groups of signals, from cause to effect.
const GROUPS: [&str; 4] = ["inputs", "outputs", "variables", "steps"];

/// Draws runs of one file.
pub(super) struct Drawer {
    bench: Bench,
}

impl Drawer {
    pub(super) fn new(source: &Source, profile: Option<ProfileName>) -> Result<Option<Drawer>, Failure> {
        Ok(bench(source, profile)?.map(|bench| Drawer { bench }))
    }

    /// The scans of a run in words.
    pub(super) fn scans(&self, moves: &[Move]) -> Vec<String> {
        in_words(&self.bench, moves)
    }

    /// The chronogram of a run. What the claim names is in it, whether it changes or not.
    pub(super) fn draw(&self, moves: &[Move], claim: &str) -> String {
        let recording = self.record(moves);
        let mut lanes = self.bench.lanes(&recording);
        let words = names(claim);
        let named = |i: &usize| recording.signals().get(*i).is_some_and(|s| words.contains(&&*s.name));
        let all = || 0..recording.signals().len();
        for i in all().filter(named).chain(all().filter(|i| is_on(&recording, *i))) {
            if !lanes.contains(&i) {
                lanes.push(i);
            }
        }
        lanes.truncate(LANES);
        let group =
            |i: &usize| recording.signals().get(*i).and_then(|s| GROUPS.iter().position(|g| *g == s.group));
        lanes.sort_by_key(group);
        self.chronogram(&recording, lanes, moves.len())
    }

    /// Why the first of these names have their values at the end of a run.
    pub(super) fn why(&self, moves: &[Move], names: &[impl AsRef<str>]) -> Vec<Cause> {
        let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
        let runner = repeat(self.bench.runner(0).with_tape(), moves, |_| {});
        causes(&self.bench, &runner, &names)
    }

    /// The two runs of a comparison in one chronogram. A signal that takes the same course in both
    /// has one lane, any other one for each chart: `1: m` above `2: m`.
    pub(super) fn draw_both(both: &[Drawer; 2], moves: &[Vec<Move>; 2]) -> String {
        let [a, b] = both;
        let [first, second] = moves;
        let (one, two) = (a.record(first), b.record(second));
        let find = |r: &Recording, s: &Signal| r.signals().iter().position(|o| o == s);
        let mut lanes: Vec<(Signal, &Recording, usize)> = Vec::new();
        for group in GROUPS {
            let mine = |r: &Recording| -> Vec<(usize, Signal)> {
                r.signals().iter().cloned().enumerate().filter(|(_, s)| s.group == group).collect()
            };
            for (i, s) in mine(&one) {
                match find(&two, &s) {
                    Some(j) if one.changes(i).eq(two.changes(j)) => {
                        lanes.extend(is_on(&one, i).then(|| (s.clone(), &one, i)));
                    }
                    Some(j) => lanes.extend([(numbered(&s, 1), &one, i), (numbered(&s, 2), &two, j)]),
                    None => lanes.extend(is_on(&one, i).then(|| (numbered(&s, 1), &one, i))),
                }
            }
            let alone = mine(&two).into_iter().filter(|(j, s)| find(&one, s).is_none() && is_on(&two, *j));
            lanes.extend(alone.map(|(j, s)| (numbered(&s, 2), &two, j)));
        }
        lanes.truncate(2 * LANES);
        let mut joined = Recording::new(lanes.iter().map(|(s, ..)| s.clone()).collect());
        for (to, (_, recording, from)) in lanes.iter().enumerate() {
            joined.adopt(to, recording, *from);
        }
        a.chronogram(&joined, (0..lanes.len()).collect(), first.len())
    }

    /// The fault that ends a run, in words.
    pub(super) fn fault(&self, moves: &[Move]) -> Option<Said> {
        let mut fault = None;
        repeat(self.bench.runner(0), moves, |runner| {
            fault = runner.halt().map(|halt| self.bench.halt(runner, halt));
        });
        fault
    }

    fn record(&self, moves: &[Move]) -> Recording {
        let bench = &self.bench;
        let mut recording = Recording::new(bench.signals());
        repeat(bench.runner(0), moves, |runner| {
            recording.sample(Nanos::new(runner.state().now()), bench.sample(runner));
        });
        recording
    }

    /// The whole run, unless the columns are too few for its changes: then its last scans.
    fn chronogram(&self, recording: &Recording, lanes: Vec<usize>, scans: usize) -> String {
        let period = self.bench.period.count();
        let after = |n: usize| Nanos::new(period.saturating_mul(i64::try_from(n).unwrap_or(i64::MAX)));
        let scans = scans.max(1);
        let drawn = |shown: usize| {
            let columns = shown.saturating_mul(EACH).clamp(FEW, COLUMNS);
            let (from, to) = (after(scans - shown), after(scans));
            let style = Style { columns, from, to, until: to };
            Chronogram::new(recording, lanes.iter().copied(), style).to_string()
        };
        let whole = drawn(scans);
        if scans > LAST && whole.contains('╳') {
            return format!("the last {LAST} of {scans} scans:\n{}", drawn(LAST));
        }
        whole
    }
}

/// True for an input, output or step that changes, or has all the time another value than 0.
fn is_on(recording: &Recording, signal: usize) -> bool {
    let listed = ["inputs", "outputs", "steps"];
    let group = recording.signals().get(signal).map_or("", |s| s.group);
    let value = || recording.value_at(signal, recording.end());
    recording.count(signal) > 1 || listed.contains(&group) && value().is_some_and(|v| v.word() != 0)
}

/// A signal of one of two charts.
fn numbered(s: &Signal, chart: u8) -> Signal {
    Signal { name: format!("{chart}: {}", s.name), ..s.clone() }
}

/// The words of a claim that may be names.
pub(super) fn names(claim: &str) -> Vec<&str> {
    claim.split(|c: char| !c.is_alphanumeric() && !"_.".contains(c)).filter(|word| !word.is_empty()).collect()
}

/// Repeats a run up to a fault; `see` is shown the runner behind each scan.
fn repeat(mut runner: Runner, moves: &[Move], mut see: impl FnMut(&Runner)) -> Runner {
    for m in moves {
        for (index, value) in (0u32..).zip(&m.inputs) {
            runner.set_input(index, *value);
        }
        let halted = runner.scan().is_err();
        see(&runner);
        if halted {
            break;
        }
    }
    runner
}

/// The scans of a run in words: the time, the inputs that change, the situation behind it.
fn in_words(bench: &Bench, moves: &[Move]) -> Vec<String> {
    let (mut before, mut found) = (Vec::new(), Vec::new());
    repeat(bench.runner(0), moves, |runner| {
        let inputs = bench.items.iter().filter(|i| matches!(i.role, Role::Input(_)));
        let all: Vec<String> =
            inputs.map(|i| format!("{} = {}", i.name, i.show(&bench.value_in(runner.state(), i)))).collect();
        let new: Vec<&str> = all.iter().filter(|text| !before.contains(*text)).map(String::as_str).collect();
        let inputs = if new.is_empty() { told(&say!("the same inputs")) } else { new.join(", ") };
        let now = raw(Nanos::new(runner.state().now()).plain());
        let end = match runner.halt() {
            Some(halt) => say!("a fault: {}", bench.halt(runner, halt)),
            None => raw(format!("{{{}}}", bench.situation(runner.state()).join(", "))),
        };
        found.push(told(&say!("at {now}: {}; then {end}", raw(inputs))));
        before = all;
    });
    found
}

/// A bench of the charts alone, or the problems of the file on the standard error.
pub(super) fn bench(source: &Source, profile: Option<ProfileName>) -> Result<Option<g7_rig::Bench>, Failure> {
    let options = g7_rig::Options { profile, plant: Some("none"), ..g7_rig::Options::default() };
    Ok(g7_rig::build(source, &options)?.0)
}
