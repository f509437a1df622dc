//! Our own readers read printed Instruction List and Ladder back, and the engine runs them:
//! situation, outputs and variables equal those of the chart, scan by scan, on conformance cases
//! and random charts.
//!
//! If `G7_KEEP` is set, code that differs is kept in a temporary folder.

use std::collections::BTreeMap;

use g7_codegen::plc::{Form, Printed};
use g7_compile::ir::VarClass;
use g7_compile::{Compiled, compile};
use g7_engine::{Addr, FaultKind, State, StepId, scan};
use g7_exchange::recognise;
use g7_model::{FileId, ProfileName, Severity, codes};
use g7_tests::generated::Subject;
use g7_tests::generated::cases;
use g7_tests::generated::plc::{Event, Prints, Seen, difference, played, prints, shown};

/// Compiles the text of a function block for the engine.
fn read(text: &str, file: &str) -> Result<Compiled, String> {
    let format = recognise(file, text.as_bytes()).ok_or("nobody knows the format")?;
    let (document, mut problems) = format.read(text.as_bytes(), FileId(0)).ok_or("the format is not read")?;
    // A memory of a bit string is read as a number of the same width; that it does the same is seen
    // when it runs.
    problems.retain(|p| p.code.id != codes::DIFFERENT.id);
    let (compiled, more) = compile(&document);
    problems.extend(more.into_iter().filter(|p| p.severity() == Severity::Error));
    match (compiled, problems.first()) {
        (Some(compiled), None) => Ok(compiled),
        (_, Some(p)) => {
            let line = text.get(..p.at.start as usize).unwrap_or("").lines().count();
            let there = text.lines().nth(line.saturating_sub(1)).unwrap_or("").trim();
            Err(format!("{} {} (line {line}: {there})", p.code.id, p.what))
        }
        (None, None) => Err("no program".into()),
    }
}

/// The address of a variable in the compiled text, by its name in the code.
fn place(read: &Compiled, name: &str) -> Result<Addr, String> {
    let mut all = read.symbols.variables.iter();
    all.find(|v| v.name.eq_ignore_ascii_case(name))
        .map(|v| v.addr)
        .ok_or_else(|| format!("no variable {name}"))
}

/// The results of the code, scan by scan.
fn replayed(s: &Subject, printed: &Printed, read: &Compiled, events: &[Event]) -> Result<Vec<Seen>, String> {
    let program = &read.program;
    let table = program.tables().inputs;
    let fault = place(read, "FAULT").ok();
    let mut steps = Vec::new();
    for i in 0..s.compiled.symbols.steps() {
        steps.push(place(read, printed.step(StepId(i)))?);
    }
    let mut variables = Vec::new();
    for (v, name) in shown(s, printed) {
        variables.push((v.class, place(read, &name)?));
    }
    let (mut state, mut seen) = (State::new(program), Vec::new());
    for event in events {
        let Event::Scan { now, inputs } = event else {
            state = State::new(program);
            continue;
        };
        let mut words = state.words().get(table.start as usize..table.end as usize).unwrap_or(&[]).to_vec();
        let places = variables.iter().filter(|(class, _)| *class == VarClass::Input);
        for ((_, at), value) in places.zip(inputs) {
            if let Some(slot) = words.get_mut((at.0 - table.start) as usize) {
                *slot = *value;
            }
        }
        match scan(program, &mut state, &words, *now) {
            Ok(_) => {}
            // Ten thousand passes can exceed the work that the engine allows in a scan.
            Err(f) if f.kind == FaultKind::Work => {
                seen.push(Seen { stopped: true, words: Vec::new() });
                continue;
            }
            Err(f) => return Err(format!("scan {}: fault {:?}", seen.len(), f.kind)),
        }
        let stopped = fault.is_some_and(|f| state.word(f) != 0);
        let mut words = Vec::new();
        if !stopped {
            words.extend(steps.iter().map(|at| state.word(*at)));
        }
        let outputs = variables.iter().filter(|(class, _)| !stopped || *class == VarClass::Output);
        words.extend(outputs.map(|(_, at)| state.word(*at)));
        seen.push(Seen { stopped, words });
    }
    Ok(seen)
}

/// Compares the code of one chart with the chart; an error describes the difference.
fn same(s: &Subject, printed: &Printed, file: &str) -> Result<(), String> {
    let read = read(&printed.text, file)?;
    let (events, want) = played(s, printed)?;
    let got = replayed(s, printed, &read, &events)?;
    for (k, (want, got)) in want.iter().zip(&got).enumerate() {
        let endless = want.stopped && got.stopped && got.words.is_empty();
        if want != got && !endless {
            return Err(format!("scan {k}: {}", difference(s, printed, want, got)));
        }
    }
    if want.len() == got.len() { Ok(()) } else { Err("not as many scans".into()) }
}

fn keep(title: &str, file: &str, text: &str) {
    if std::env::var_os("G7_KEEP").is_some() {
        let folder = std::env::temp_dir().join("g7-readback");
        let name = format!("{}-{file}", title.replace([' ', '/'], "-"));
        let _ = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(folder.join(name), text));
    }
}

/// Compares the code of subjects with their charts; returns how many agree.
fn agree(name: &str, form: Form, file: &str, subjects: &[Subject]) -> usize {
    let Prints { list, refused } = prints(subjects, form).unwrap_or_else(|e| panic!("{e}"));
    println!("{name}: {} of {} printed", list.len(), subjects.len());
    for (why, n) in &refused {
        println!("  {n} refused: {why}");
    }
    let mut wrong: BTreeMap<String, String> = BTreeMap::new();
    for (s, printed) in &list {
        if let Err(why) = same(s, printed, file) {
            keep(&s.title, file, &printed.text);
            wrong.insert(s.title.clone(), why);
        }
    }
    println!("  {} agree", list.len() - wrong.len());
    let all: Vec<String> = wrong.iter().map(|(title, why)| format!("{title}: {why}")).collect();
    assert!(all.is_empty(), "{name}: {} differ:\n{}", all.len(), all.join("\n"));
    list.len()
}

/// A list with one changed instruction behaves differently, and the test notices it.
#[test]
fn a_wrong_list_is_noticed() {
    let all = spec();
    let Prints { list, .. } = prints(&all, Form::Il).unwrap_or_else(|e| panic!("{e}"));
    let (mut noticed, mut changed) = (0, 0);
    for (s, printed) in list.iter().filter(|(_, p)| p.text.contains("  ANDN T_")) {
        let mut wrong = printed.clone();
        wrong.text = wrong.text.replacen("  ANDN T_", "  AND T_", 1);
        changed += 1;
        noticed += usize::from(same(s, &wrong, "chart.il").is_err());
    }
    println!("{noticed} of {changed} wrong lists are noticed");
    assert!(changed > 100 && noticed * 10 >= changed * 9, "{noticed} of {changed}");
}

fn spec() -> Vec<Subject> {
    cases::spec().unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn cases_in_instruction_list() {
    let n = agree("il", Form::Il, "chart.il", &spec());
    assert!(n > 300, "only {n} cases can be printed");
}

#[test]
fn cases_in_the_manner_of_dolog80() {
    let n = agree("dolog80", Form::Dolog80, "chart.il", &spec());
    assert!(n > 300, "only {n} cases can be printed");
}

#[test]
fn cases_in_structured_text() {
    let n = agree("st", Form::St, "chart.st", &spec());
    assert!(n > 300, "only {n} cases can be printed");
}

#[test]
fn cases_in_ladder() {
    let n = agree("ld", Form::Ld, "chart.xml", &spec());
    assert!(n > 100, "only {n} cases can be printed");
}

#[test]
fn random_charts() {
    for profile in [
        ProfileName::Iec60848,
        ProfileName::Iec61131,
        ProfileName::Pl7,
        ProfileName::Unity,
        ProfileName::Jgrafchart,
    ] {
        let subjects = cases::random(profile, 1, 200, |s| s.len() >= 60).unwrap_or_else(|e| panic!("{e}"));
        for (form, word, file) in [
            (Form::Il, "il", "chart.il"),
            (Form::Dolog80, "dolog80", "chart.il"),
            (Form::Ld, "ld", "chart.xml"),
        ] {
            let n = agree(&format!("{word} {}", profile.name()), form, file, &subjects);
            // Ladder has no loops.
            assert!(n > 0 || form == Form::Ld && profile == ProfileName::Iec60848, "{word}: none printed");
        }
    }
}
