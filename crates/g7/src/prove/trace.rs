//! Runs of the prover as chronograms, made by a run of the bench.

use g7_host::{Chronogram, Recording, Signal, Style};
use g7_model::{Nanos, ProfileName};
use g7_rig::{Bench, Role, Source};
use g7_verify::Move;

use crate::failure::Failure;

/// Columns of a chronogram.
const COLUMNS: usize = 60;
/// Most lanes of a chronogram.
const LANES: usize = 16;

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

    /// The chronogram of a run, and the time of its last scan.
    pub(super) fn draw(&self, moves: &[Move]) -> (String, Nanos) {
        let recording = self.record(moves);
        let mut lanes = self.bench.lanes(&recording);
        let others = (0..recording.signals().len()).filter(|i| !lanes.contains(i) && is_on(&recording, *i));
        lanes.extend(others.collect::<Vec<_>>());
        lanes.truncate(LANES);
        let groups = ["inputs", "outputs", "variables", "steps"];
        let group =
            |i: &usize| recording.signals().get(*i).and_then(|s| groups.iter().position(|g| *g == s.group));
        lanes.sort_by_key(group);
        (self.chronogram(&recording, lanes, moves.len()), recording.end())
    }

    /// The two runs of a comparison in one chronogram. A signal that takes the same course in both
    /// has one lane, any other one for each chart: `1: m` above `2: m`.
    pub(super) fn draw_both(both: &[Drawer; 2], moves: &[Vec<Move>; 2]) -> String {
        let [a, b] = both;
        let [first, second] = moves;
        let of = [a.record(first), b.record(second)];
        let groups = ["inputs", "outputs", "variables", "steps"];
        let mut lanes: Vec<(Signal, usize, usize)> = Vec::new();
        for group in groups {
            let mine = |r: &Recording| {
                let signals = r.signals().iter().enumerate().filter(|(_, s)| s.group == group);
                signals.map(|(i, s)| (i, s.clone())).collect::<Vec<_>>()
            };
            let [left, right] = [mine(&of[0]), mine(&of[1])];
            let course = |side: usize, i: usize| of[side].changes(i).collect::<Vec<_>>();
            for (i, s) in &left {
                let other = right.iter().find(|(_, o)| o.name == s.name);
                match other {
                    Some((j, _)) if course(0, *i) == course(1, *j) => {
                        lanes.extend(is_on(&of[0], *i).then(|| (s.clone(), 0, *i)));
                    }
                    Some((j, o)) => {
                        lanes.extend([(numbered(s, 1), 0, *i), (numbered(o, 2), 1, *j)]);
                    }
                    None => lanes.extend(is_on(&of[0], *i).then(|| (numbered(s, 1), 0, *i))),
                }
            }
            let alone = right.iter().filter(|(_, s)| !left.iter().any(|(_, o)| o.name == s.name));
            lanes.extend(alone.filter(|(j, _)| is_on(&of[1], *j)).map(|(j, s)| (numbered(s, 2), 1, *j)));
        }
        lanes.truncate(2 * LANES);
        let mut joined = Recording::new(lanes.iter().map(|(s, _, _)| s.clone()).collect());
        for (to, (_, side, from)) in lanes.iter().enumerate() {
            if let Some(recording) = of.get(*side) {
                joined.adopt(to, recording, *from);
            }
        }
        a.chronogram(&joined, (0..lanes.len()).collect(), first.len())
    }

    fn record(&self, moves: &[Move]) -> Recording {
        let bench = &self.bench;
        let mut runner = bench.runner(0);
        let mut recording = Recording::new(bench.signals());
        for m in moves {
            for (index, value) in (0u32..).zip(&m.inputs) {
                runner.set_input(index, *value);
            }
            let halted = runner.scan().is_err();
            recording.sample(Nanos::new(runner.state().now()), bench.sample(&runner));
            if halted {
                break;
            }
        }
        recording
    }

    fn chronogram(&self, recording: &Recording, lanes: Vec<usize>, scans: usize) -> String {
        let count = i64::try_from(scans).unwrap_or(i64::MAX);
        let to = Nanos::new(self.bench.period.count().saturating_mul(count.max(1)));
        let style = Style { columns: COLUMNS, from: Nanos::ZERO, to, until: to };
        Chronogram::new(recording, lanes, style).to_string()
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

/// The scans of a run in words: the time, the inputs that change, the situation behind it.
fn in_words(bench: &Bench, moves: &[Move]) -> Vec<String> {
    let mut runner = bench.runner(0);
    let mut before: Vec<String> = Vec::new();
    let mut scan = |m: &Move| {
        for (index, value) in (0u32..).zip(&m.inputs) {
            runner.set_input(index, *value);
        }
        let halted = runner.scan().is_err();
        let inputs = bench.items.iter().filter(|i| matches!(i.role, Role::Input(_)));
        let all: Vec<String> = inputs
            .map(|i| format!("{} = {}", i.name, bench.value_in(runner.state(), i).show(i.kind)))
            .collect();
        let new: Vec<&str> = all.iter().filter(|text| !before.contains(text)).map(String::as_str).collect();
        let inputs = if new.is_empty() { "the same inputs".to_owned() } else { new.join(", ") };
        let now = Nanos::new(runner.state().now()).plain();
        let end = if halted { "a fault".to_owned() } else { bench.situation(runner.state()).join(", ") };
        before = all;
        format!("at {now}: {inputs}; then {{{end}}}")
    };
    moves.iter().map(&mut scan).collect()
}

/// A bench of the charts alone, or the problems of the file on the standard error.
pub(super) fn bench(source: &Source, profile: Option<ProfileName>) -> Result<Option<g7_rig::Bench>, Failure> {
    let options = g7_rig::Options { profile, plant: Some("none"), ..g7_rig::Options::default() };
    Ok(g7_rig::build(source, &options)?.0)
}
