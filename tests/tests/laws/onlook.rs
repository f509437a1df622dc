//! The marks of a user interface come true: the transitions that `enabled` reports as true are those
//! that clear in the next pass.

use g7_compile::compile;
use g7_engine::{State, begin, enabled, finish, pass};
use g7_model::ProfileName;
use g7_tests::generate::sample;

/// Number of charts for each profile.
const CHARTS: u64 = 150;
/// Number of scans of each chart.
const SCANS: i64 = 30;
/// Greatest number of passes of a scan that are compared; reports of longer scans are cut.
const PASSES: usize = 8;

/// Compares charts of a profile; returns the number of clearings.
fn look(profile: ProfileName) -> usize {
    let mut seen = 0;
    for seed in 1..=CHARTS {
        let sample = sample(seed, profile, 1).expect("a random chart can be read");
        let (Some(c), _) = compile(&sample.document) else { continue };
        let (program, rules) = (&c.program, c.program.tables().rules);
        let all_clear = rules.multi_token && !rules.numbered_exclusive && !rules.sequential;
        let rows = program.tables().inputs;
        let mut state = State::new(program);
        let mut chance = seed;
        for scan in 0..SCANS {
            let inputs: Vec<u64> = (rows.start..rows.end)
                .map(|_| {
                    chance = chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(99);
                    (chance >> 33) & 1
                })
                .collect();
            if begin(program, &mut state, &inputs, scan * 10_000_000).is_err() {
                break;
            }
            for _ in 0..PASSES {
                let mut told = Vec::new();
                let judged = enabled(program, &state, |rank, holds| told.extend(holds.then_some(rank)));
                let before = state.cleared().len();
                let Ok(more) = pass(program, &mut state) else { break };
                if judged.is_err() {
                    break;
                }
                told.sort_unstable();
                let mut cleared = state.cleared().get(before..).unwrap_or(&[]).to_vec();
                cleared.sort_unstable();
                let at = || format!("{} seed {seed}, scan {scan}: told {told:?}", profile.name());
                assert!(cleared.iter().all(|t| told.contains(t)), "{}, cleared {cleared:?}", at());
                assert!(!all_clear || told == cleared, "{}, cleared {cleared:?}", at());
                assert!(told.is_empty() || !cleared.is_empty(), "{}, nothing cleared", at());
                seen += cleared.len();
                if !rules.stable || !more {
                    break;
                }
            }
            if finish(program, &mut state).is_err() {
                break;
            }
        }
    }
    seen
}

#[test]
fn what_is_called_true_clears_in_the_next_pass() {
    for profile in ProfileName::ALL {
        let seen = look(profile);
        assert!(seen > 1_000, "{}: only {seen} clearings", profile.name());
    }
}
