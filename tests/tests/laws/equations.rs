//! The engine and the equations agree, scan by scan, on random charts: on
//! situation, outputs, variables, step times, conflicts and faults; every second chart
//! runs with stamps instead of clocks, as printed code of the flat style does.
//!
//! `G7_SCANS` and `G7_SEED` look longer and elsewhere, as in `agree.rs`.

use g7_model::ProfileName;
use g7_tests::agree::{agree, script_text};
use g7_tests::engine::engine;
use g7_tests::equations::{equations, stamped};
use g7_tests::generate::sample;
use g7_tests::shrink::shrink;

fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(otherwise)
}

fn run(profile: ProfileName) {
    let scans = number("G7_SCANS", 30_000) as usize;
    let mut seed = number("G7_SEED", 1);
    let mut sound = 0;
    while sound < scans {
        let form = if seed.is_multiple_of(2) { stamped } else { equations };
        let sample = sample(seed, profile, 50).expect("a random chart can be read");
        match agree(&sample.document, &sample.script, [form, engine]) {
            Ok(statistics) => sound += statistics.sound(),
            Err(why) if why.what.contains(g7_model::codes::TWO_VALUES.id) => {}
            Err(_) => {
                // A chart that is refused does not show the difference.
                let fails =
                    |d: &_, s: &_| agree(d, s, [form, engine]).is_err_and(|e| !e.what.starts_with("the "));
                let (doc, script) = shrink(&sample.document, &sample.script, &fails);
                let why = agree(&doc, &script, [form, engine]).expect_err("it still differs");
                panic!(
                    "{} seed {seed}, event {}, equations against engine: {}\n\n{}\n{}",
                    profile.name(),
                    why.event,
                    why.what,
                    g7_syntax::print(&doc, None),
                    script_text(&script, why.event),
                );
            }
        }
        seed += 1;
    }
}

#[test]
fn iec60848() {
    run(ProfileName::Iec60848);
}

#[test]
fn iec61131() {
    run(ProfileName::Iec61131);
}

#[test]
fn pl7() {
    run(ProfileName::Pl7);
}

#[test]
fn unity() {
    run(ProfileName::Unity);
}

#[test]
fn jgrafchart() {
    run(ProfileName::Jgrafchart);
}
