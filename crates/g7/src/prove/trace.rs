//! Runs of the prover as chronograms, made by a run of the bench.

use g7_host::{Chronogram, Recording, Style};
use g7_model::{Nanos, ProfileName};
use g7_rig::{Bench, Source};
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

    /// The chronogram of a run, and the time of its last scan.
    pub(super) fn draw(&self, moves: &[Move]) -> (String, Nanos) {
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
        let last = Nanos::new(runner.state().now());
        let count = i64::try_from(moves.len()).unwrap_or(i64::MAX);
        let to = Nanos::new(bench.period.count().saturating_mul(count.max(1)));
        let mut lanes = bench.lanes(&recording);
        if lanes.is_empty() {
            let listed = ["inputs", "outputs", "steps"];
            let signals = recording.signals().iter().enumerate();
            lanes = signals.filter(|(_, s)| listed.contains(&s.group)).map(|(i, _)| i).collect();
        }
        lanes.truncate(LANES);
        let style = Style { columns: COLUMNS, from: Nanos::ZERO, to, until: to };
        (Chronogram::new(&recording, lanes, style).to_string(), last)
    }
}

/// A bench of the charts alone, or the problems of the file on the standard error.
fn bench(source: &Source, profile: Option<ProfileName>) -> Result<Option<g7_rig::Bench>, Failure> {
    let options = g7_rig::Options { profile, plant: Some("none"), ..g7_rig::Options::default() };
    Ok(g7_rig::build(source, &options)?.0)
}
