//! Code for PLCs behaves like the engine, scan by scan, when a foreign compiler (matiec, `iec2c` on
//! the PATH) translates it to C: situation, outputs and variables, on every conformance case that
//! can be printed.
//!
//! `g7_peers::matiec` finds the compiler; the folder with the code is kept if `G7_KEEP` is set.
#![allow(clippy::disallowed_methods, reason = "the tests start compilers")]

use std::path::Path;

use g7_codegen::plc::{Form, Printed};
use g7_model::ProfileName;
use g7_peers::mended::mended;
use g7_peers::projects::readers;
use g7_tests::generated::Subject;
use g7_tests::generated::blocks::batch;
use g7_tests::generated::cases::{self, Folder};
use g7_tests::generated::plc::{Prints, prints};

/// Cases in which matiec itself behaves differently, with the reason.
const NOT_IN_MATIEC: [(&str, &str); 1] =
    [("iec61131/real-overflow-is-no-fault", "it refuses a LREAL of 1.0E308: it takes the limits of REAL")];

/// Prints, compiles, runs and compares subjects; prints how many agree and why others cannot be
/// printed.
fn agrees(name: &str, form: Form, ending: &str, subjects: &[Subject]) -> usize {
    let Prints { mut list, refused } = prints(subjects, form).unwrap_or_else(|e| panic!("{e}"));
    println!("{name}: {} of {} printed", list.len(), subjects.len());
    for (why, n) in &refused {
        println!("  {n} refused: {why}");
    }
    let Some(matiec) = g7_peers::matiec() else { return list.len() };
    for (case, why) in NOT_IN_MATIEC {
        let all = list.len();
        list.retain(|(s, _)| !s.title.starts_with(case));
        println!("  {} left out, matiec: {why}", all - list.len());
    }
    let folder = Folder::new(&format!("plc-{name}"));
    if form == Form::Ld && !by_beremiz(&folder, &mut list) {
        return list.len();
    }
    let library = folder.0.join("C");
    mended(&matiec.lib.join("C"), &library).unwrap_or_else(|e| panic!("{}: {e}", matiec.lib.display()));
    let translate = |folder: &Path, file: &str| matiec.translate(folder, file);
    let mut wrong = Vec::new();
    for (i, part) in list.chunks(40).enumerate() {
        wrong.extend(batch(&translate, &library, &folder.0.join(i.to_string()), ending, part).err());
    }
    assert!(wrong.is_empty(), "{name}: {}", wrong.join("\n"));
    println!("  {} agree", list.len());
    list.len()
}

/// Ladder becomes the text that Beremiz makes of it. False if Beremiz is not there.
fn by_beremiz(folder: &Folder, list: &mut [(&Subject, Printed)]) -> bool {
    let Some(reader) = readers().into_iter().find(|r| r.name == "Beremiz") else { return false };
    std::fs::create_dir_all(&folder.0).unwrap_or_else(|e| panic!("{e}"));
    let file = |i: usize| folder.0.join(format!("{i}.xml"));
    for (i, (_, printed)) in list.iter().enumerate() {
        std::fs::write(file(i), &printed.text).unwrap_or_else(|e| panic!("{e}"));
    }
    let files: Vec<_> = (0..list.len()).map(file).collect();
    for ((subject, printed), text) in list.iter_mut().zip(reader.texts(&files)) {
        printed.text = text.unwrap_or_else(|e| {
            println!("Beremiz on {}: {e}", subject.title);
            String::new()
        });
    }
    true
}

/// Every conformance case with a trace.
fn spec() -> Vec<Subject> {
    cases::spec().unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn cases_in_structured_text() {
    let agree = agrees("st", Form::St, "st", &spec());
    assert!(agree > 300, "only {agree} cases can be printed");
}

#[test]
fn cases_in_instruction_list() {
    let agree = agrees("il", Form::Il, "il", &spec());
    assert!(agree > 300, "only {agree} cases can be printed");
}

#[test]
fn cases_in_the_manner_of_dolog80() {
    let agree = agrees("dolog80", Form::Dolog80, "il", &spec());
    assert!(agree > 300, "only {agree} cases can be printed");
}

/// IronPLC takes Structured Text; many blocks stand in one file, because a process for each is slow.
#[test]
fn ironplc_checks_structured_text() {
    let Some(ironplc) = g7_peers::ironplc::find() else { return };
    let subjects = spec();
    let Prints { list, .. } = prints(&subjects, Form::St).unwrap_or_else(|e| panic!("{e}"));
    assert!(list.len() > 300, "only {} cases can be printed", list.len());
    let folder = Folder::new("ironplc");
    std::fs::create_dir_all(&folder.0).unwrap_or_else(|e| panic!("{e}"));
    let file = folder.0.join("charts.st");
    let checked = |text: &str| {
        std::fs::write(&file, text).unwrap_or_else(|e| panic!("{e}"));
        ironplc.checks(&file)
    };
    // IronPLC has SEL for numbers alone, though the standard has it for any type (IEC 61131-3:2003, 2.5.1.5.4).
    let of_bits = |text: &str| {
        let strings = ["BYTE#", "WORD#", "DWORD#", "LWORD#"];
        text.lines().any(|l| l.contains("SEL(") && strings.iter().any(|s| l.contains(s)))
    };
    let all = list.len();
    let list: Vec<_> = list.into_iter().filter(|(_, printed)| !of_bits(&printed.text)).collect();
    println!("{} left out: SEL of bit strings", all - list.len());
    for part in list.chunks(40) {
        let text: String = part.iter().map(|(_, printed)| format!("{}\n", printed.text)).collect();
        if let Err(why) = checked(&text) {
            let alone = part.iter().find(|(_, printed)| checked(&printed.text).is_err());
            panic!("{}: {why}", alone.map_or("several blocks together", |(s, _)| &s.title));
        }
    }
}

/// Ladder is taken by Beremiz, whose text is translated.
#[test]
fn cases_in_ladder() {
    let agree = agrees("ld", Form::Ld, "st", &spec());
    assert!(agree > 150, "only {agree} cases can be printed");
}

fn random_charts(name: &str, form: Form, ending: &str, charts: usize) {
    for profile in [
        ProfileName::Iec60848,
        ProfileName::Iec61131,
        ProfileName::Pl7,
        ProfileName::Unity,
        ProfileName::Jgrafchart,
    ] {
        let subjects =
            cases::random(profile, 1, 200, |s| s.len() >= charts).unwrap_or_else(|e| panic!("{e}"));
        let agree = agrees(&format!("{name}-{}", profile.name()), form, ending, &subjects);
        assert!(agree > 0, "no chart of {} can be printed", profile.name());
    }
}

#[test]
fn random_charts_in_structured_text() {
    random_charts("st", Form::St, "st", 60);
}

#[test]
fn random_charts_in_instruction_list() {
    random_charts("il", Form::Il, "il", 20);
    random_charts("dolog80", Form::Dolog80, "il", 20);
}
