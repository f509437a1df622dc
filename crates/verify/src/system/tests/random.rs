//! Random charts, the conformance cases and the examples.
//!
//! `G7_PAIRS` is the number of (state, inputs) pairs a profile, `G7_SEED` the first chart.
#![allow(clippy::disallowed_methods, reason = "the tests read charts and variables of the environment")]

use std::path::{Path, PathBuf};

use g7_model::{FileId, ProfileName};
use g7_tests::generate::sample;

use super::{Count, Rng, asked, parsed, side_by_side};
use crate::system::Observed;

pub(super) fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(otherwise)
}

/// A random chart with questions and an assumption about its inputs and outputs.
pub(super) fn with_questions(text: &str, seed: u64) -> String {
    let document = parsed(text);
    let Some(asked) = asked(&document, None) else { return text.to_owned() };
    let mut names = Vec::new();
    for v in &asked.compiled.symbols.variables {
        use g7_compile::ir::VarClass::{Input, Output};
        if matches!(v.class, Input | Output) && v.ty == g7_model::Type::Bool && v.elements == 1 {
            names.push(v.name.to_string());
        }
    }
    if names.len() < 2 {
        return text.to_owned();
    }
    let mut rng = Rng(seed);
    let mut name = || names[rng.next() as usize % names.len()].clone();
    let (a, b, c) = (name(), name(), name());
    let within = 10 * (seed % 5) + seed % 3;
    let mut text = format!(
        "{text}\nprove always {a} or not {b}\nprove never {b} and {c}\nprove reachable {a} and {c}\n\
         prove at most 1 of ({a}, {b}, {c})\nprove after {a} within {within}ms expect {b}\n\
         prove after {a} until {b} expect {c}\nprove between {c} and {a} never {b}\n"
    );
    let first = asked.compiled.symbols.variables.iter().find(|v| {
        v.class == g7_compile::ir::VarClass::Input && v.ty == g7_model::Type::Bool && v.elements == 1
    });
    if let (Some(v), true) = (first, seed.is_multiple_of(4)) {
        text += &format!("assume {} or not {b} or {a}\n", v.name);
    }
    text
}

/// Random charts until so many pairs were compared.
fn random(profile: ProfileName) {
    let pairs = number("G7_PAIRS", 10_000) as usize;
    let mut seed = number("G7_SEED", 1);
    let mut count = Count::default();
    while count.pairs < pairs {
        let sample = sample(seed, profile, 1).expect("a random chart can be read");
        let text = with_questions(&sample.text, seed);
        if let Some(asked) = asked(&parsed(&text), None) {
            let observed = if seed.is_multiple_of(2) { Observed::All } else { Observed::Asked };
            match side_by_side(&asked, observed, seed, 12) {
                Ok(done) => count.add(done),
                Err(why) => panic!("{} seed {seed}: {why}\n{text}", profile.name()),
            }
        }
        seed += 1;
    }
    println!("{}: {count:?}, {seed} seeds", profile.name());
    assert!(
        count.pairs < 8_000 || count.limited * 2 < count.charts && count.uncovered * 5 < count.pairs,
        "{count:?}"
    );
}

#[test]
fn iec60848() {
    random(ProfileName::Iec60848);
}

#[test]
fn iec61131() {
    random(ProfileName::Iec61131);
}

#[test]
fn pl7() {
    random(ProfileName::Pl7);
}

#[test]
fn unity() {
    random(ProfileName::Unity);
}

#[test]
fn jgrafchart() {
    random(ProfileName::Jgrafchart);
}

fn files(folder: &Path, ext: &str, into: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.filter_map(|e| e.ok().map(|e| e.path())) {
        if path.is_dir() {
            files(&path, ext, into);
        } else if path.extension().is_some_and(|e| e == ext) {
            into.push(path);
        }
    }
    into.sort();
}

/// The charts of the conformance cases, each in the profiles of its traces.
#[test]
fn conformance_cases() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/spec");
    let mut list = Vec::new();
    files(&root, "md", &mut list);
    let (mut count, mut wrong) = (Count::default(), Vec::new());
    for file in list {
        let folder = file.strip_prefix(&root).ok().and_then(|p| p.iter().next()).and_then(|p| p.to_str());
        let text = std::fs::read_to_string(&file).expect("a case can be read");
        let Ok(case) = g7_tests::case::read(&text) else { continue };
        let document = parsed(&case.chart);
        let own = folder.and_then(|f| g7_tests::case::profile_named(f).ok());
        let mut profiles: Vec<_> = case.traces.iter().filter_map(|t| t.profile.or(own)).collect();
        profiles.dedup();
        for profile in profiles {
            let Some(asked) = asked(&document, Some(profile)) else { continue };
            match side_by_side(&asked, Observed::All, 7, 12) {
                Ok(done) => count.add(done),
                Err(why) => wrong.push(format!("{} {}: {why}", file.display(), profile.name())),
            }
        }
    }
    println!("{count:?}");
    assert!(wrong.is_empty(), "{} of {} charts:\n{}", wrong.len(), count.charts, wrong.join("\n"));
    assert!(count.charts > 300 && count.limited * 10 < count.charts, "{count:?}");
}

#[test]
fn examples() {
    let mut list = Vec::new();
    files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples"), "g7", &mut list);
    let mut count = Count::default();
    for file in list {
        let text = std::fs::read_to_string(&file).expect("an example can be read");
        let (document, _) = g7_syntax::parse(&text, FileId(0));
        let Some(asked) = asked(&document, None) else { continue };
        match side_by_side(&asked, Observed::All, 3, 200) {
            Ok(done) => count.add(done),
            Err(why) => panic!("{}: {why}", file.display()),
        }
    }
    println!("{count:?}");
    assert!(count.charts > 10, "{count:?}");
}
