//! The engine and the naive engine agree on random charts, scan by scan: situation, outputs,
//! variables, step times, conflicts and faults.
//!
//! `G7_SCANS=1000000 G7_SEED=7 cargo test -p g7-tests --test laws agree` runs longer and with other
//! charts. A disagreement is printed as the smallest chart that shows it.

use g7_model::{Document, ProfileName};
use g7_tests::agree::{Disagreement, Statistics, agree, script_text};
use g7_tests::engine::engine;
use g7_tests::generate::{Sample, Script, sample};
use g7_tests::shrink::shrink;
use g7_tests::subject::naive;

/// Number of scans of one chart.
const LENGTH: usize = 50;

/// Number of scans without a fault for each profile.
const SCANS: u64 = 100_000;

fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(otherwise)
}

fn both(doc: &Document, script: &Script) -> Result<Statistics, Disagreement> {
    agree(doc, script, [naive, engine])
}

fn run(profile: ProfileName) {
    let scans = number("G7_SCANS", SCANS) as usize;
    let mut all = Statistics::default();
    let mut seed = number("G7_SEED", 1);
    while all.sound() < scans {
        let sample = sample(seed, profile, LENGTH).expect("a random chart can be read");
        match both(&sample.document, &sample.script) {
            Ok(statistics) => all.add(&statistics),
            // The generator knows no values. The checker refuses charts that assign two constants
            // at one moment, so there is nothing to compare.
            Err(why) if why.what.contains(g7_model::codes::TWO_VALUES.id) => {}
            Err(why) => panic!("{}", smallest(profile, &sample, &why)),
        }
        seed += 1;
    }
    println!("{}: {}", profile.name(), all.line());
}

/// The smallest chart and script with the same kind of disagreement.
fn smallest(profile: ProfileName, sample: &Sample, why: &Disagreement) -> String {
    // If one of them refuses the chart, the kind is the code of its problem.
    let length =
        |what: &str| if what.starts_with("the ") { 17 } else { what.find(':').unwrap_or(12).min(12) };
    let sort = |what: &str| what.chars().take(length(what)).collect::<String>();
    let wanted = sort(&why.what);
    let fails = |d: &Document, s: &Script| both(d, s).is_err_and(|e| sort(&e.what) == wanted);
    let (doc, script) = shrink(&sample.document, &sample.script, &fails);
    let (event, what) = match both(&doc, &script) {
        Err(said) => (said.event, said.what),
        Ok(_) => (why.event, why.what.clone()),
    };
    format!(
        "{} seed {}, event {event}, naive against engine: {what}\n\n{}\n{}",
        profile.name(),
        sample.seed,
        g7_syntax::print(&doc, None),
        script_text(&script, event),
    )
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
