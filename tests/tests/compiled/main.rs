//! Generated C and Rust behave like the engine, scan by scan: situation, step times, outputs,
//! variables, faults; on every conformance case and on random charts.
//!
//! `G7_SCANS=100000 cargo test -p g7-tests --test compiled` sets the number of random scans for each profile, and
//! runs every case with every compiler in both styles; otherwise some combinations are left out. The folder with
//! the code is kept if `G7_KEEP` is set.
#![allow(missing_docs, reason = "a test")]

use g7_codegen::{Clock, Language, Room, Style};
use g7_model::ProfileName;
use g7_tests::generated::cases::{self, Folder};
use g7_tests::generated::{Subject, c_program, compare, rust_program};

/// With these options, undefined behaviour ends the program.
const SANITIZERS: [&str; 3] = ["-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|v| v.parse().ok())
}

/// Every `step`th subject, beginning with `first`; all of them in a long run.
fn some(subjects: &[Subject], first: usize, step: usize) -> Vec<&Subject> {
    let step = if number("G7_SCANS").is_some() { 1 } else { step };
    subjects.iter().skip(first % step).step_by(step).collect()
}

fn spec() -> Vec<Subject> {
    cases::spec().unwrap_or_else(|e| panic!("{e}"))
}

/// Random charts with this number of scans in total.
fn random(profile: ProfileName, scans: usize, length: usize) -> Vec<Subject> {
    let enough = |found: &[Subject]| found.iter().map(|s| s.sound).sum::<usize>() >= scans;
    let first = number("G7_SEED").unwrap_or(1);
    cases::random(profile, first, length, enough).unwrap_or_else(|e| panic!("{e}"))
}

/// Generates, compiles and runs the subjects, and compares them with the engine.
fn agree(name: &str, compiler: &str, style: Style, subjects: &[&Subject]) {
    if !g7_peers::tool(compiler) {
        return;
    }
    let sanitizers = if compiler == "rustc" { &[] } else { g7_peers::sanitizers(compiler, &SANITIZERS) };
    let folder = Folder::new(&format!("codegen-{name}-{compiler}-{style:?}"));
    let mut wrong = Vec::new();
    for (i, batch) in subjects.chunks(60).enumerate() {
        let place = folder.0.join(i.to_string());
        let program = match compiler {
            "rustc" => rust_program(&place, style, batch),
            _ => c_program(&place, compiler, sanitizers, style, batch),
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
    // SIN and similar functions come from the crate `libm`, which rustc alone does not have.
    let all = subjects.len();
    let complete =
        |s: &Subject| s.print(Language::Rust, Style::Structured, "c").is_ok_and(|p| p.problems.is_empty());
    subjects.retain(complete);
    println!("{} of {all} cases without functions of the crate libm", subjects.len());
    assert!(subjects.len() + 10 > all, "only {} of {all} cases", subjects.len());
    agree("cases", "rustc", Style::Structured, &some(&subjects, 1, 4));
    agree("cases", "rustc", Style::Flat, &some(&subjects, 3, 4));
}

/// Sets of steps of many words, and choices that stand in several functions.
#[test]
fn wide_charts() {
    let profiles = [ProfileName::Iec61131, ProfileName::Iec60848];
    let each = profiles.into_iter().flat_map(|p| [(p, false), (p, true)]);
    let subjects: Vec<Subject> =
        each.map(|(p, stored)| cases::wide(p, 450, stored).unwrap_or_else(|e| panic!("{e}"))).collect();
    let all: Vec<&Subject> = subjects.iter().collect();
    assert!(all.iter().map(|s| s.sound).sum::<usize>() > 2_500, "the charts run");
    agree("wide", "gcc", Style::Structured, &all);
    agree("wide", "rustc", Style::Structured, &some(&subjects, 0, 4));
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

/// The rooms of code for little memory.
const ROOMS: [Room; 3] = [
    Room { small: true, clock: Clock::Nanoseconds },
    Room { small: true, clock: Clock::Microseconds },
    Room { small: false, clock: Clock::Milliseconds },
];

/// The subjects, by turns in the rooms; in the next where its times do not fit the clock.
fn in_little_room(mut subjects: Vec<Subject>) -> Vec<Subject> {
    let mut k = 0;
    subjects.retain_mut(|s| {
        k += 1;
        (0..ROOMS.len()).any(|i| s.fit(ROOMS[(k + i) % ROOMS.len()]))
    });
    subjects
}

#[test]
fn cases_in_little_room() {
    let all = spec();
    let count = all.len();
    let subjects = in_little_room(all);
    println!("{} of {count} cases have times that fit", subjects.len());
    assert!(subjects.len() * 10 > count * 8, "{} of {count}", subjects.len());
    agree("little room", "gcc", Style::Structured, &some(&subjects, 0, 2));
    agree("little room", "clang", Style::Structured, &some(&subjects, 1, 8));
    let complete =
        |s: &Subject| s.print(Language::Rust, Style::Structured, "c").is_ok_and(|p| p.problems.is_empty());
    let rust: Vec<&Subject> = some(&subjects, 0, 4).into_iter().filter(|s| complete(s)).collect();
    agree("little room", "rustc", Style::Structured, &rust);
}

#[test]
fn random_charts_in_little_room() {
    let profiles = [
        ProfileName::Iec60848,
        ProfileName::Iec61131,
        ProfileName::Pl7,
        ProfileName::Unity,
        ProfileName::Jgrafchart,
    ];
    let scans = number("G7_SCANS").unwrap_or(1_000) as usize;
    for profile in profiles {
        let all = random(profile, scans, (scans / 4).clamp(1, 2_000));
        let count = all.len();
        let subjects = in_little_room(all);
        assert!(subjects.len() * 2 > count, "{}: {} of {count}", profile.name(), subjects.len());
        agree(&format!("little-{}", profile.name()), "gcc", Style::Structured, &some(&subjects, 0, 1));
    }
}

/// The clock begins again at 0 twice, in steps and delays that go on over it; and a step that is
/// active for longer than the clock can tell does not seem young again.
#[test]
fn a_clock_of_32_bits_begins_again() {
    let text = "profile PROFILE
input go : BOOL
output slow, late, pulse : BOOL
chart C {
  initial step 1
  step 2 { N slow if 20d/X2  D 3h late }
  step 3 { L 2h pulse }
  1 -> 2 when go
  2 -> 3 when 5d/X2 and not go
  3 -> 1 when X3.t >= 10h
}
";
    let mut subjects = Vec::new();
    for profile in ["iec60848", "iec61131"] {
        let text = text.replace("PROFILE", profile);
        let (document, _) = g7_syntax::parse(&text, g7_model::FileId(0));
        let mut subject = Subject::new(profile, &document, None, &text).unwrap_or_else(|e| panic!("{e}"));
        let minutes = 90 * 24 * 60 / 7;
        // Most of the time goes by in step 2: 60 days of the 90, which is more than 32 bits say.
        let script = (0..minutes).map(|k| {
            let now = k * 7 * 60 * 1_000_000_000;
            let day = k * 7 / (24 * 60);
            let go = matches!(day, 2..=61 | 70..=78);
            let inputs = [("go".to_owned(), g7_tests::naive::Value::Bool(go))];
            g7_tests::generate::Event::Scan { now, inputs: inputs.into_iter().collect() }
        });
        subject.play(&script.collect()).unwrap_or_else(|e| panic!("{e}"));
        subjects.push(subject);
    }
    let room = Room { small: true, clock: Clock::Milliseconds };
    for subject in &mut subjects {
        assert!(subject.fit_whole(room), "the times are whole milliseconds");
    }
    let all: Vec<&Subject> = subjects.iter().collect();
    agree("clock", "gcc", Style::Structured, &all);
    agree("clock", "rustc", Style::Structured, &all);
}

/// Lints that are allowed at the head of a printed file.
fn allowed(text: &str) -> Vec<String> {
    let names = text.split_once("#![allow(\n").and_then(|(_, r)| r.split_once(")]")).map_or("", |(n, _)| n);
    names.split(',').map(|n| n.trim().trim_start_matches("clippy::").to_owned()).collect()
}

/// The messages of clippy about modules of one crate, with its pedantic lints.
fn clippy(folder: &Folder, modules: &[String]) -> std::process::Output {
    let mut root = String::from("//! Charts.\n#![no_std]\n");
    std::fs::create_dir_all(&folder.0).expect("a folder");
    for (i, text) in modules.iter().enumerate() {
        std::fs::write(folder.0.join(format!("c{i}.rs")), text).expect("a file");
        root += &format!("pub mod c{i};\n");
    }
    std::fs::write(folder.0.join("lib.rs"), root).expect("a file");
    let lints = ["-Dwarnings", "-Wclippy::all", "-Wclippy::pedantic"];
    std::process::Command::new("clippy-driver")
        .args(["--edition=2024", "--crate-type=lib", "--emit=metadata", "--cap-lints=forbid", "lib.rs"])
        .args(lints)
        .current_dir(&folder.0)
        .output()
        .expect("clippy starts")
}

/// Printed Rust is clean under the pedantic lints of clippy but for those at its head, and each of these is needed.
#[test]
fn printed_rust_is_clean_by_clippy() {
    if !g7_peers::tool("clippy-driver") {
        return;
    }
    let mut subjects = spec();
    subjects.extend(in_little_room(spec()).into_iter().step_by(9));
    subjects.extend(random(ProfileName::Iec61131, 500, 300));
    let texts: Vec<String> = subjects
        .iter()
        .filter_map(|s| {
            // The title alone chooses: a new case does not change which of the others are tried.
            let lot = s.title.bytes().fold(0_u32, |h, b| h.wrapping_mul(31).wrapping_add(u32::from(b)));
            let flat = lot % 9 == 6 && s.room == Room::default();
            let style = if flat { Style::Flat } else { Style::Structured };
            let printed = s.print(Language::Rust, style, "c").ok().filter(|p| p.problems.is_empty())?;
            // Few charts read a number from a text, so none of them is left out.
            let file = printed.files.last().filter(|f| lot % 4 != 3 || f.text.contains("text_to_"))?;
            Some(file.text.clone())
        })
        .collect();
    assert!(texts.len() > 40, "{} charts", texts.len());
    let folder = Folder::new("clippy");
    let out = clippy(&folder, &texts);
    let said: String = String::from_utf8_lossy(&out.stderr).chars().take(6_000).collect();
    assert!(out.status.success(), "{said}");
    let names = allowed(&texts[0]);
    let bare: Vec<String> = texts
        .iter()
        .map(|t| {
            let (above, rest) = t.split_once("#![allow(\n").expect("the lints");
            format!("{above}{}", rest.split_once(")]").expect("their end").1)
        })
        .collect();
    let out = clippy(&folder, &bare);
    let said = String::from_utf8_lossy(&out.stderr);
    let unneeded: Vec<&String> =
        names.iter().filter(|n| !said.contains(&format!("index.html#{n}"))).collect();
    assert!(unneeded.is_empty(), "allowed and never found: {unneeded:?}");
    println!("{} charts, {} lints allowed", texts.len(), names.len());
}
