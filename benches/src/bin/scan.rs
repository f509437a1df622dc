//! Measures one scan, and how it grows with the size and with the activity of the chart.
//!
//! Prints ns a scan (moving / idle) for G7, and for matiec if `iec2c` is on the `PATH`, with the
//! ratio; checks first that both visit the same situations. Then prints the time from the text to
//! the first scan.
#![allow(clippy::disallowed_methods, reason = "a stopwatch reads the clock")]

use std::time::Instant;

use g7_benches::matiec::{self, LOOKED_AT, Measured};
use g7_benches::mix::mix;
use g7_benches::shape::Shape;
use g7_compile::{Compiled, compile};
use g7_engine::{State, scan};
use g7_model::FileId;
use g7_peers::Matiec;

fn main() {
    let quick = std::env::args().any(|a| a == "--quick");
    let peer = Matiec::find();
    if peer.is_none() {
        println!("matiec: skipped, no iec2c on the PATH");
    }
    println!("{:<16}{:>22}{:>24}{:>18}", "ns a scan", "G7 moving / idle", "matiec moving / idle", "ratio");
    let small =
        [Shape::Linear(10), Shape::Linear(100), Shape::Par(100), Shape::Alt(100), Shape::AndFork(100)];
    let large = [Shape::Linear(1000), Shape::Par(1000), Shape::Alt(1000), Shape::AndFork(1000)];
    let huge = [Shape::Linear(10_000), Shape::Linear(100_000)];
    let folder = std::env::temp_dir().join(format!("g7-matiec-{}", std::process::id()));
    for shape in small.into_iter().chain(large).chain(huge) {
        let ours = g7(shape);
        let theirs = peer
            .as_ref()
            .filter(|_| shape.steps() <= if quick { 100 } else { 1000 })
            .map(|peer| matiec::measure(peer, &folder.join(shape.name().replace(' ', "-")), shape));
        let mut line =
            format!("{:<16}{:>22}", shape.name(), format!("{:.1} / {:.1}", ours.moving, ours.idle));
        match theirs {
            None => {}
            Some(Ok(m)) if m.digest != ours.digest => line.push_str("  NOT COMPARABLE: other situations"),
            Some(Ok(m)) => line.push_str(&format!(
                "{:>24}{:>18}",
                format!("{:.0} / {:.0}", m.moving, m.idle),
                format!("{:.0} / {:.0}", m.moving / ours.moving, m.idle / ours.idle)
            )),
            Some(Err(why)) => line.push_str(&format!("  {}", why.lines().next().unwrap_or(""))),
        }
        println!("{line}");
    }
    let _ = std::fs::remove_dir_all(&folder);
    println!("\n{:<16}{:>10}", "text to scan", "ms");
    for shape in [Shape::Linear(1000), Shape::Linear(100_000)] {
        println!("{:<16}{:>10.1}", shape.name(), load(&shape.g7()));
    }
    println!("{:<16}{:>10.1}", "mix 1000", load(&mix("iec60848", 1000)));
}

fn program(text: &str) -> Compiled {
    let (doc, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (compiled, problems) = compile(&doc);
    compiled.unwrap_or_else(|| panic!("{problems:?}"))
}

/// A digest of the situations that the first scans visit, computed like that of the C program.
fn digest(c: &Compiled, state: &mut State, now: &mut i64) -> u64 {
    let mut h = 14_695_981_039_346_656_037u64;
    let mut eat = |v: u64| h = (h ^ v).wrapping_mul(1_099_511_628_211);
    for _ in 0..LOOKED_AT {
        *now += 1_000_000;
        scan(&c.program, state, &[1], *now).expect("the shapes run without fault");
        state.active().for_each(|s| eat(u64::from(s.0)));
        eat(0xffff);
    }
    h
}

fn g7(shape: Shape) -> Measured {
    let c = program(&shape.g7());
    let (mut state, mut now) = (State::new(&c.program), 0i64);
    if shape.forks() {
        // The other program needs one scan to start the loops.
        scan(&c.program, &mut state, &[0], now).expect("the shapes run without fault");
    }
    let digest = digest(&c, &mut state, &mut now);
    let mut time = |input: u64| {
        let scans = 4_000_000 / (1 + shape.steps() / 100).min(400);
        let mut best = f64::MAX;
        for _ in 0..9 {
            let start = Instant::now();
            for _ in 0..scans {
                now += 1_000_000;
                let report = scan(&c.program, &mut state, std::hint::black_box(&[input]), now);
                std::hint::black_box(&report).as_ref().expect("the shapes run without fault");
            }
            best = best.min(start.elapsed().as_nanos() as f64 / scans as f64);
        }
        best
    };
    let moving = time(1);
    Measured { moving, idle: time(0), digest }
}

/// The time from the text to the end of the first scan in milliseconds; the best of a few runs.
fn load(text: &str) -> f64 {
    (0..9)
        .map(|_| {
            let start = Instant::now();
            let c = program(text);
            let mut state = State::new(&c.program);
            let inputs = c.program.tables().inputs;
            let inputs = vec![0; (inputs.end - inputs.start) as usize];
            scan(&c.program, &mut state, &inputs, 0).expect("the charts run without fault");
            start.elapsed().as_secs_f64() * 1e3
        })
        .fold(f64::MAX, f64::min)
}
