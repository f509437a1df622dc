//! The cost of a run with its plant, as `g7 run` makes it, for an hour of virtual time.
//!
//! Without arguments it prints, for each example, the time of an hour: charts and plant alone, with
//! a tape (`--record`), and with tape and all signals recorded, as `g7 run --record` does.
//!
//! `plants --run NAME (alone|tape|signals) SCANS` makes the scans of one example inside the function
//! `measured`, for a tool that counts instructions.
#![allow(clippy::disallowed_methods, reason = "a stopwatch reads the clock")]

use std::time::Instant;

use g7_host::{Recording, Runner};
use g7_model::Nanos;
use g7_rig::{Bench, Options, Source, build};

/// The examples: a name and the text.
const EXAMPLES: [(&str, &str); 4] = [
    ("bead-sorter", include_str!("../../../examples/bead-sorter/chart.g7")),
    ("transport-workcell", include_str!("../../../examples/transport-workcell/improved.g7")),
    ("two-tanks", include_str!("../../../examples/two-tanks/chart.g7")),
    ("bottle-conveyor", include_str!("../../../examples/bottle-conveyor/chart.g7")),
];

/// The parts of a run that are recorded.
#[derive(Clone, Copy, PartialEq, Eq)]
enum How {
    Alone,
    Tape,
    Signals,
}

const HOWS: [(&str, How); 3] = [("alone", How::Alone), ("tape", How::Tape), ("signals", How::Signals)];

/// Changes kept for each signal, as in `g7 run`.
const KEPT: usize = 200_000;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    match args[..] {
        ["--run", name, how, scans] => {
            let how = HOWS.iter().find(|(word, _)| *word == how).expect("alone, tape or signals").1;
            let scans: u64 = scans.parse().expect("a number of scans");
            Run::new(&bench(name), how).measured(scans);
        }
        _ => table(args.first().copied()),
    }
}

fn bench(name: &str) -> Bench {
    let (_, text) = EXAMPLES.iter().find(|(n, _)| *n == name).expect("an example of the list");
    let source = Source::new("chart.g7", text.as_bytes().to_vec(), 0);
    let (bench, problems) = build(&source, &Options::default()).expect("the plant is there");
    bench.unwrap_or_else(|| panic!("{name}: {problems:?}"))
}

/// A run, ready for its first scan.
struct Run<'b> {
    bench: &'b Bench,
    runner: Runner,
    recording: Option<Recording>,
}

impl<'b> Run<'b> {
    fn new(bench: &'b Bench, how: How) -> Run<'b> {
        let mut runner = bench.runner(1);
        if how != How::Alone {
            runner = runner.with_tape();
        }
        let recording = (how == How::Signals).then(|| Recording::new(bench.signals()).with_limit(KEPT));
        Run { bench, runner, recording }
    }

    /// The scans whose instructions are counted, by this name.
    #[inline(never)]
    fn measured(&mut self, scans: u64) {
        for _ in 0..scans {
            self.runner.scan().expect("the examples run without fault");
            if let Some(recording) = &mut self.recording {
                recording.sample(Nanos::new(self.runner.state().now()), self.bench.sample(&self.runner));
            }
        }
    }
}

/// Minimum and median of the seconds of some hours.
fn table(begin: Option<&str>) {
    const ROUNDS: usize = 5;
    print!("{:<24}", "s an hour: minimum (median)");
    HOWS.iter().for_each(|(word, _)| print!("{word:>18}"));
    println!();
    for (name, _) in EXAMPLES.iter().filter(|(name, _)| name.starts_with(begin.unwrap_or(""))) {
        let bench = bench(name);
        let scans = Nanos::HOUR.count_of(bench.period) as u64;
        print!("{name:<27}");
        for (_, how) in HOWS {
            let mut times: Vec<f64> = (0..ROUNDS)
                .map(|_| {
                    let mut run = Run::new(&bench, how);
                    let start = Instant::now();
                    run.measured(scans);
                    start.elapsed().as_secs_f64()
                })
                .collect();
            times.sort_by(f64::total_cmp);
            let cell = format!("{:.3} ({:.3})", times[0], times[ROUNDS / 2]);
            print!("{cell:>18}");
        }
        println!();
    }
}
