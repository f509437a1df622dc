//! The cost of one scan in each row of `g7_benches::rows`.
//!
//! Without arguments it prints the minimum and the median of several rounds in ns, moving and
//! waiting, and the ratio to a loop in C over the active steps, all in one run.
//!
//! `rows --list` prints the names. `rows --run NAME (moving|waiting) SCANS` makes the scans of one row
//! inside the function `measured`, for a tool that counts instructions.

#![allow(clippy::disallowed_methods, reason = "a stopwatch reads the clock")]

use std::hint::black_box;
use std::time::Instant;

use g7_benches::active_loop::ActiveLoop;
use g7_benches::rows::{Drive, Row, rows};
use g7_compile::{Compiled, compile};
use g7_engine::{State, scan};
use g7_model::FileId;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    match args[..] {
        ["--list"] => rows().iter().for_each(|row| println!("{}", row.name)),
        ["--run", name, how, scans] => {
            let row = rows().into_iter().find(|row| row.name == name).expect("a row of the list");
            let scans = scans.parse().expect("a number of scans");
            let mut bench = Bench::new(&row);
            bench.warm(how == "moving");
            bench.measured(how == "moving", scans);
        }
        _ => table(args.first().copied()),
    }
}

/// One row, ready to run.
struct Bench {
    compiled: Compiled,
    state: State,
    inputs: Vec<u64>,
    drive: Drive,
    now: i64,
    k: u64,
    random: u64,
}

impl Bench {
    fn new(row: &Row) -> Bench {
        let (doc, problems) = g7_syntax::parse(&row.text, FileId(0));
        assert!(problems.is_empty(), "{}: {problems:?}", row.name);
        let (compiled, problems) = compile(&doc);
        let compiled = compiled.unwrap_or_else(|| panic!("{}: {problems:?}", row.name));
        let inputs = compiled.program.tables().inputs;
        Bench {
            state: State::new(&compiled.program),
            inputs: vec![0; (inputs.end - inputs.start) as usize],
            drive: row.drive,
            now: 0,
            k: 0,
            random: 1,
            compiled,
        }
    }

    /// The first scans, which are not measured.
    fn warm(&mut self, moving: bool) {
        self.scans(true, 50);
        self.scans(moving, 50);
    }

    /// The scans whose instructions `instructions.sh` counts: it looks for this name.
    #[inline(never)]
    fn measured(&mut self, moving: bool, scans: u64) {
        self.scans(moving, scans);
    }

    #[inline(always)]
    fn scans(&mut self, moving: bool, scans: u64) {
        for _ in 0..scans {
            self.now += 1_000_000;
            self.k += 1;
            self.drive.set(&mut self.inputs, self.k, moving, &mut self.random);
            let done = scan(&self.compiled.program, &mut self.state, black_box(&self.inputs), self.now);
            black_box(&done).as_ref().expect("the charts run without fault");
        }
    }

    /// ns a scan.
    fn time(&mut self, moving: bool, scans: u64) -> f64 {
        let start = Instant::now();
        self.measured(moving, scans);
        start.elapsed().as_nanos() as f64 / scans as f64
    }
}

/// Minimum and median of a row's rounds.
fn summary(mut times: Vec<f64>) -> (f64, f64) {
    times.sort_by(f64::total_cmp);
    (times.first().copied().unwrap_or(0.0), times.get(times.len() / 2).copied().unwrap_or(0.0))
}

/// All rows whose name begins as asked. The loop in C runs before each row, since the speed of the
/// machine wavers.
fn table(begin: Option<&str>) {
    const ROUNDS: usize = 9;
    let base = ActiveLoop::build();
    if let Err(why) = &base {
        println!("no ratio: {why}");
    }
    println!("{:<32}{:>24}{:>24}{:>16}", "ns a scan: minimum (median)", "moving", "waiting", "to the loop");
    for row in rows().iter().filter(|row| row.name.starts_with(begin.unwrap_or(""))) {
        let mut bench = Bench::new(row);
        bench.warm(true);
        let once = bench.time(true, 200).max(bench.time(false, 200));
        let scans = (4e6 / once.max(1.0)).max(20.0) as u64;
        let mut times: [Vec<f64>; 4] = Default::default();
        for _ in 0..ROUNDS {
            times[0].push(bench.time(true, scans));
            times[1].push(bench.time(false, scans));
            if let Ok((moving, waiting)) = base.as_ref().map(ActiveLoop::time) {
                times[2].push(moving);
                times[3].push(waiting);
            }
        }
        let [moving, waiting, loop_moving, loop_waiting] = times.map(summary);
        let cell = |(least, middle): (f64, f64)| format!("{least:.1} ({middle:.1})");
        let ratio = if loop_moving.0 > 0.0 {
            format!("{:.1} / {:.1}", moving.0 / loop_moving.0, waiting.0 / loop_waiting.0)
        } else {
            String::new()
        };
        println!("{:<32}{:>24}{:>24}{:>16}", row.name, cell(moving), cell(waiting), ratio);
    }
}
