//! Figures of the history: bytes a change, and how long a page waits for an hour and for a day.
//!
//! `cargo run --release --package g7-store --example history`
#![allow(clippy::disallowed_methods, reason = "it measures")]

use std::time::Instant;

use g7_host::Kind;
use g7_model::Nanos;
use g7_store::history::{Limits, Reader, Signal, Writer, lane};

/// Signals with the time between two changes, in ms.
const SIGNALS: &[(&str, Kind, i64)] = &[
    ("busy", Kind::Bool, 10),
    ("valve", Kind::Bool, 1_000),
    ("step", Kind::Bool, 5_000),
    ("rare", Kind::Bool, 600_000),
    ("level", Kind::Real, 100),
    ("flow", Kind::Lreal, 100),
    ("count", Kind::Int { bits: 32, signed: true }, 1_000),
];
const DAY: i64 = 86_400_000;

fn word(kind: Kind, k: i64) -> u64 {
    match kind {
        Kind::Bool => (k & 1) as u64,
        Kind::Real => u64::from((40.0 + 5.0 * (k as f32 / 300.0).sin()).to_bits()),
        Kind::Lreal => (12.5 + (k as f64 / 700.0).cos()).to_bits(),
        _ => k as u64,
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::temp_dir().join(format!("g7-history-figures-{}", std::process::id()));
    let limits = Limits { age: Nanos::DAY * 30, bytes: 1 << 32 };
    let mut writer = Writer::open(&path, limits, Nanos::ZERO, 1_767_225_600_000_000)?;
    let signals: Vec<Signal> = SIGNALS
        .iter()
        .map(|(name, kind, _)| Signal {
            name: (*name).to_owned(),
            kind: *kind,
            class: "variables".to_owned(),
            ty: String::new(),
            comment: None,
        })
        .collect();
    writer.begin(Nanos::ZERO, &signals, 0);
    let (mut changes, began, mut jitter) = (0u64, Instant::now(), 1u64);
    for ms in (0..DAY).step_by(10) {
        // A scan begins some tens of us late.
        jitter = jitter.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let at = Nanos::new(ms * 1_000_000 + (jitter >> 48) as i64);
        for (number, (_, kind, each)) in (0u32..).zip(SIGNALS) {
            if ms % each == 0 {
                writer.change(at, number, word(*kind, ms / each));
                changes += 1;
            }
        }
        if ms % 1_000 == 0 {
            writer.commit()?;
        }
    }
    writer.close()?;
    let took = began.elapsed();
    let size = std::fs::metadata(&path)?.len();
    println!("{changes} changes of a day: {size} bytes, {:.2} a change", size as f64 / changes as f64);
    println!("written in {took:.1?}: {:.0} changes a second", changes as f64 / took.as_secs_f64());
    for (name, long) in [("an hour", 3_600_000_000), ("a day", DAY * 1000)] {
        let began = Instant::now();
        let reader = Reader::open(&path)?;
        let overview = reader.overview()?;
        let mut pieces = 0;
        for (id, signal) in &overview.signals {
            let range = (overview.until - long, overview.until);
            pieces += lane(&reader, &overview, (*id, signal.kind), range, 1500)?.len();
        }
        let took = began.elapsed();
        println!("{name} of all {} signals in 1500 columns: {pieces} pieces in {took:.1?}", SIGNALS.len());
    }
    std::fs::remove_file(&path)?;
    Ok(())
}
