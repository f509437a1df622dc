//! How many successors of a state can be had in a second?
//!
//! A search takes a state again and again and makes one scan from it. Prints, for
//! several charts, successors a second where the state is cloned for each and
//! where its image is restored into one that stands, with the ratio; then those
//! with the canonical image of each successor. The two sides take turns, and the
//! best turn of each counts.
#![allow(clippy::disallowed_methods, reason = "a stopwatch reads the clock")]

use std::hint::black_box;
use std::time::Instant;

use g7_benches::shape::Shape;
use g7_compile::{Compiled, compile};
use g7_engine::{State, scan};
use g7_model::FileId;

/// Turns of each side.
const TURNS: usize = 15;

/// A chart with variables, stored actions, a delay, an edge and control blocks.
const MIXED: &str = "
profile iec60848
input a, b, c : BOOL
output Q0, Q1, Q2 : BOOL
var n : INT
chart G {
  initial step 1 { N Q0 on ↑a: n := (n + 1) mod 8 }
  step 2 { N Q1 if c }
  step 3 { N Q2 }
  1 -> 2 when a
  2 -> 3 when 2s/(b)
  3 -> 1 when n > 3 or c
}
chart H {
  initial step 11 { }
  step 12 { }
  11 -> 12 when ↑b
  12 -> 11 when X2 and c
}";

fn main() {
    println!(
        "{:<16}{:>8}{:>12}{:>12}{:>8}{:>14}",
        "M successors/s", "words", "clone", "restore", "ratio", "+ canonical"
    );
    let mixed = std::iter::once(("mixed".to_owned(), MIXED.to_owned()));
    let shapes = [Shape::Linear(10), Shape::Linear(100), Shape::Par(100), Shape::Linear(1000)];
    for (name, text) in mixed.chain(shapes.into_iter().map(|s| (s.name(), s.g7()))) {
        row(&name, &program(&text));
    }
}

fn program(text: &str) -> Compiled {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (compiled, problems) = compile(&document);
    compiled.unwrap_or_else(|| panic!("{problems:?}"))
}

fn row(name: &str, c: &Compiled) {
    let p = &c.program;
    let count = (p.tables().inputs.end - p.tables().inputs.start) as usize;
    let (low, high) = (vec![0u64; count], vec![1u64; count]);
    let mut start = State::new(p);
    for k in 0..4 {
        scan(p, &mut start, &low, k * 1_000_000).expect("no fault");
    }
    let image = start.image().to_vec();
    let now = start.now() + 1_000_000;
    let rounds = 4_000_000 / (20 + image.len());
    let inputs = |k: usize| if k.is_multiple_of(2) { &high } else { &low };
    let (mut work, mut canonical) = (start.clone(), Vec::with_capacity(image.len()));
    let mut best = [f64::MAX; 3];
    for _ in 0..TURNS {
        let cloned = time(rounds, |k| {
            let mut next = black_box(&start).clone();
            scan(p, &mut next, black_box(inputs(k)), now).expect("no fault");
            black_box(&next);
        });
        let restored = time(rounds, |k| {
            work.restore(p, black_box(&image)).expect("its own image");
            scan(p, &mut work, black_box(inputs(k)), now).expect("no fault");
            black_box(&work);
        });
        let compared = time(rounds, |k| {
            work.restore(p, black_box(&image)).expect("its own image");
            scan(p, &mut work, black_box(inputs(k)), now).expect("no fault");
            work.canonical(p, &mut canonical);
            black_box(&canonical);
        });
        for (best, turn) in best.iter_mut().zip([cloned, restored, compared]) {
            *best = best.min(turn);
        }
    }
    let [clone, restore, with] = best.map(|seconds| rounds as f64 / seconds / 1e6);
    let words = image.len();
    println!("{name:<16}{words:>8}{clone:>12.2}{restore:>12.2}{:>8.1}{with:>14.2}", restore / clone);
}

/// Seconds for some rounds.
fn time(rounds: usize, mut round: impl FnMut(usize)) -> f64 {
    let start = Instant::now();
    (0..rounds).for_each(&mut round);
    start.elapsed().as_secs_f64()
}
