//! Generated C and Rust do what the engine does, scan by scan: situation, step
//! times, outputs, variables, faults; on every conformance case and on random
//! charts.
//!
//! `G7_SCANS=100000` sets how many random scans each profile makes, and asks for
//! every case by every compiler in both styles; without it some are left out. The
//! folder of the code is kept where `G7_KEEP` is set.
#![allow(clippy::disallowed_methods, reason = "the tests start compilers")]

use std::path::{Path, PathBuf};

use g7_codegen::{Language, Style};
use g7_model::ProfileName;
use g7_tests::case;
use g7_tests::generate::sample;
use g7_tests::generated::{Subject, c_program, compare, has, rust_program};

const SANITIZERS: [&str; 3] = ["-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|v| v.parse().ok())
}

/// Every `step`th, from the `first`; all of them in the long run.
fn some(subjects: &[Subject], first: usize, step: usize) -> Vec<&Subject> {
    let step = if number("G7_SCANS").is_some() { 1 } else { step };
    subjects.iter().skip(first % step).step_by(step).collect()
}

/// A folder of the test that goes when it is over.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        Folder(std::env::temp_dir().join(format!("g7-codegen-{}-{name}", std::process::id())))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if std::env::var_os("G7_KEEP").is_none() {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }
}

fn cases(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.filter_map(|e| e.ok().map(|e| e.path())) {
        if path.is_dir() {
            cases(&path, found);
        } else if path.extension().is_some_and(|e| e == "md")
            && path.file_stem().is_some_and(|s| s != "README")
        {
            found.push(path);
        }
    }
}

/// Every conformance case with a trace, a subject for each profile it runs under.
fn spec() -> Vec<Subject> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("spec");
    let mut files = Vec::new();
    cases(&root, &mut files);
    files.sort();
    let mut subjects: Vec<Subject> = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a case");
        let case = case::read(&text).expect("a case in good form");
        let title = file.strip_prefix(&root).unwrap_or(&file).with_extension("").display().to_string();
        let folder = title.split('/').next().unwrap_or("").to_owned();
        let doc = case::document(&case.chart).expect("a chart");
        for trace in &case.traces {
            let own = doc.profile().map(|p| p.name);
            let profile =
                trace.profile.or_else(|| case::profile_named(&folder).ok()).or(own).unwrap_or_default();
            let title = format!("{title} {}", profile.name());
            let at = match subjects.iter().position(|s| s.title == title) {
                Some(at) => at,
                None => {
                    let subject = Subject::new(&title, &doc, Some(profile), &case.chart);
                    subjects.push(subject.unwrap_or_else(|e| panic!("{title}: {e}")));
                    subjects.len() - 1
                }
            };
            subjects[at].replay(&doc, profile, trace).unwrap_or_else(|e| panic!("{title}: {e}"));
        }
    }
    assert!(subjects.len() > 100, "only {} cases", subjects.len());
    subjects
}

/// Random charts with so many scans in all.
fn random(profile: ProfileName, scans: usize, length: usize) -> Vec<Subject> {
    let mut subjects = Vec::new();
    let (mut sound, mut seed) = (0, number("G7_SEED").unwrap_or(1));
    while sound < scans {
        let title = format!("{} seed {seed}", profile.name());
        let sample = sample(seed, profile, length).expect("a random chart can be read");
        seed += 1;
        // What assigns two constants at one moment is refused by the checker.
        let Ok(mut subject) = Subject::new(&title, &sample.document, None, &sample.text) else { continue };
        subject.play(&sample.script).unwrap_or_else(|e| panic!("{title}: {e}"));
        sound += subject.sound;
        subjects.push(subject);
    }
    subjects
}

/// Prints, compiles and runs them beside the engine.
fn agree(name: &str, compiler: &str, style: Style, subjects: &[&Subject]) {
    if !has(compiler) {
        println!("skipped: no {compiler} on the PATH");
        return;
    }
    let folder = Folder::new(&format!("{name}-{compiler}-{style:?}"));
    let mut wrong = Vec::new();
    for (i, batch) in subjects.chunks(60).enumerate() {
        let place = folder.0.join(i.to_string());
        let program = match compiler {
            "rustc" => rust_program(&place, style, batch),
            _ => c_program(&place, compiler, &SANITIZERS, style, batch),
        };
        if let Err(why) = program.and_then(|p| compare(&p, batch)) {
            wrong.push(format!("batch {i}: {why}"));
        }
    }
    assert!(wrong.is_empty(), "{name} by {compiler}, {style:?}:\n{}", wrong.join("\n\n"));
    let scans: usize = subjects.iter().map(|s| s.sound).sum();
    println!("{name}: {} charts, {scans} scans by {compiler}, {style:?}, as the engine", subjects.len());
}

#[test]
fn cases_in_structured_c() {
    let subjects = spec();
    agree("cases", "gcc", Style::Structured, &some(&subjects, 0, 4));
    agree("cases", "clang", Style::Structured, &some(&subjects, 1, 16));
}

#[test]
fn cases_in_flat_c() {
    let subjects = spec();
    agree("cases", "gcc", Style::Flat, &some(&subjects, 2, 4));
    agree("cases", "clang", Style::Flat, &some(&subjects, 9, 16));
}

#[test]
fn cases_in_rust() {
    let mut subjects = spec();
    // SIN and its like come from the crate `libm`, which a lone rustc has not.
    let all = subjects.len();
    let complete =
        |s: &Subject| s.print(Language::Rust, Style::Structured, "c").is_ok_and(|p| p.problems.is_empty());
    subjects.retain(complete);
    println!("{} of {all} cases without functions of the crate libm", subjects.len());
    assert!(subjects.len() + 10 > all, "only {} of {all} cases", subjects.len());
    agree("cases", "rustc", Style::Structured, &some(&subjects, 1, 4));
    agree("cases", "rustc", Style::Flat, &some(&subjects, 3, 4));
}

fn random_charts(profile: ProfileName) {
    let scans = number("G7_SCANS").unwrap_or(2_000) as usize;
    let subjects = random(profile, scans, (scans / 4).clamp(1, 2_000));
    let all: Vec<&Subject> = subjects.iter().collect();
    agree(profile.name(), "gcc", Style::Structured, &all);
    agree(profile.name(), "clang", Style::Flat, &all);
    agree(profile.name(), "rustc", Style::Structured, &some(&subjects, 0, 2));
    agree(profile.name(), "rustc", Style::Flat, &some(&subjects, 1, 2));
}

#[test]
fn random_iec60848() {
    random_charts(ProfileName::Iec60848);
}

#[test]
fn random_iec61131() {
    random_charts(ProfileName::Iec61131);
}

#[test]
fn random_pl7() {
    random_charts(ProfileName::Pl7);
}

#[test]
fn random_unity() {
    random_charts(ProfileName::Unity);
}

#[test]
fn random_jgrafchart() {
    random_charts(ProfileName::Jgrafchart);
}
