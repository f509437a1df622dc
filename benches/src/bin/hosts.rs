//! How fast do several processes visit the states of a chart of cells, and in how much memory?
//!
//! ```text
//! hosts CELLS WORKERS FOLDER
//! ```
//!
//! The cells are those of `cells.rs`; in each scan at most one input differs from its initial value. One
//! process is started for each worker; process 0 prints the numbers of states and scans, each its seconds and
//! the most memory that it had (Linux).
#![allow(clippy::disallowed_methods, reason = "a stopwatch reads the clock")]

use std::process::Command;
use std::time::Instant;

use g7_benches::cells::cells;
use g7_hosts::{Place, Work, answer};
use g7_verify::{Budget, Claim, Model, Question, Tried, ask};

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [count, workers, folder, rest @ ..] = &args[..] else {
        eprintln!("hosts CELLS WORKERS FOLDER");
        std::process::exit(2);
    };
    let workers: usize = workers.parse().expect("a number of workers");
    let addresses: Vec<String> = (0..workers).map(|k| format!("127.0.0.1:{}", 47_100 + k)).collect();
    let Some(me) = rest.first().and_then(|me| me.parse().ok()) else {
        let start = Instant::now();
        let program = std::env::current_exe().expect("this program");
        let all: Vec<_> = (0..workers)
            .map(|k| {
                Command::new(&program).args([count, &workers.to_string(), folder, &k.to_string()]).spawn()
            })
            .collect();
        all.into_iter().for_each(|c| assert!(c.and_then(|mut c| c.wait()).is_ok_and(|s| s.success())));
        println!("{count} cells, {workers} processes: {:.2} s", start.elapsed().as_secs_f64());
        return;
    };
    let text = cells(count.parse().expect("a number of cells"), "iec60848");
    let (document, problems) = g7_syntax::parse(&text, Default::default());
    assert!(problems.is_empty(), "{problems:?}");
    let asked = ask(&document, None).0.expect("it compiles");
    let model = Model::new(&asked.compiled, Vec::new());
    let budget = Budget { states: usize::MAX, scans: usize::MAX, bytes: 8 << 30, stop: &|| false };
    // A claim that every run keeps, so that all states are visited.
    let all = [Question { claim: Claim::AtMost(9, Vec::new()), at: Default::default() }];
    let start = Instant::now();
    let place = Place {
        me,
        addresses: &addresses,
        work: Work { program: 0, task: 0 },
        folder: folder.as_ref(),
        tell: &|line| eprintln!("{me}: {line}"),
        tried: Some(Tried::One),
    };
    let found = answer(&model, &all, &budget, &place).expect("an answer");
    let seconds = start.elapsed().as_secs_f64();
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find(|l| l.starts_with("VmHWM:")).unwrap_or_default().to_owned();
    println!("process {me}: {seconds:.2} s, {peak}");
    if me == 0 {
        println!("{:?}", found.first().map(|(_, v)| v));
    }
}
