//! No scan of any chart allocates memory: random charts with all features under every profile, with
//! the allocations of this thread counted.

use allocation_counter::measure;
use g7_compile::compile;
use g7_engine::{FaultKind, State, scan};
use g7_model::ProfileName;
use g7_tests::generate::sample;

/// Number of charts for each profile.
const CHARTS: u64 = 250;
/// Number of scans of each chart.
const SCANS: i64 = 40;

#[test]
fn no_scan_of_any_chart_allocates() {
    for profile in ProfileName::ALL {
        let (mut scans, mut cleared, mut ran) = (0, 0, 0);
        for seed in 1..=CHARTS {
            let sample = sample(seed, profile, 1).expect("a random chart can be read");
            let (Some(c), _) = compile(&sample.document) else { continue };
            let program = &c.program;
            let rows = program.tables().inputs;
            let mut state = State::new(program);
            let mut inputs = vec![0u64; (rows.end - rows.start) as usize];
            let (mut other, mut image) = (state.clone(), Vec::with_capacity(state.image().len()));
            let mut chance = seed;
            for k in 0..SCANS {
                for word in &mut inputs {
                    chance = chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(99);
                    *word = (chance >> 33) & 1;
                }
                let mut report = None;
                let counted = measure(|| report = Some(scan(program, &mut state, &inputs, k * 10_000_000)));
                assert_eq!(counted.count_total, 0, "{} seed {seed}, scan {k}", profile.name());
                // A search makes these steps between two scans.
                let counted = measure(|| {
                    state.canonical(program, &mut image);
                    other.restore(program, &image).expect("a canonical image");
                });
                assert_eq!(counted.count_total, 0, "{} seed {seed}, after scan {k}", profile.name());
                match report {
                    Some(Ok(report)) => cleared += report.cleared,
                    // After a fault the run stays stopped.
                    Some(Err(fault)) if fault.kind == FaultKind::Stopped => break,
                    Some(Err(_)) | None => {}
                }
                scans += 1;
                ran += state.ran().len();
            }
        }
        assert!(scans > 1000 && cleared > 1000 && ran > 1000, "{}: {scans} {cleared} {ran}", profile.name());
    }
}
