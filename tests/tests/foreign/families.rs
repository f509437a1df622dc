//! The forms of makers of controllers behave like the engine, or are read by a program that knows the form.
//!
//! AWL for S7-300 and S7-400 is run by awlsim, scan by scan, on every conformance case that can be printed. POUs
//! of TwinCAT are parsed by blark, programs of Logix loaded by the package l5x.
#![allow(clippy::disallowed_methods, reason = "the tests start programs and write files for them")]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::process::Command;

use g7_codegen::plc::{Form, Printed, print};
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::StepId;
use g7_model::Type;
use g7_tests::generated::Subject;
use g7_tests::generated::cases::{self, Folder};
use g7_tests::generated::plc::{Event, Prints, Seen, difference, played, prints, shown};

/// Members as JSON: a name and an index, or null.
fn members<'a>(list: impl Iterator<Item = (&'a Variable, &'a str)>) -> String {
    let mut out = String::new();
    for (v, name) in list {
        for i in 0..v.elements {
            let index = if v.elements == 1 { "null".to_owned() } else { i.to_string() };
            let _ = write!(out, "[\"{name}\",{index}],");
        }
    }
    out.trim_end_matches(',').to_owned()
}

/// A word of the engine as one of the S7: TIME in milliseconds. None where it has none.
fn narrowed(ty: Type, word: u64) -> Option<i64> {
    match ty {
        Type::Real => Some(word as i64),
        Type::Time => (word as i64 % 1_000_000 == 0).then_some(word as i64 / 1_000_000),
        _ => Some(word as i64),
    }
}

/// The chart for awlsim, and what the engine sees; none where the times are no milliseconds.
fn task(folder: &Folder, s: &Subject, printed: &Printed) -> Option<(String, Vec<Seen>, Vec<Type>)> {
    let own = |v: &Variable| printed.variable(v.addr).map(|(n, _)| n.to_owned()).unwrap_or_default();
    let visible: Vec<(&Variable, String)> = shown(s, printed).into_iter().map(|(v, _)| (v, own(v))).collect();
    let each = |v: &Variable| vec![v.ty; v.elements as usize];
    let inputs = || visible.iter().filter(|(v, _)| v.class == VarClass::Input);
    let types: Vec<Type> = inputs().flat_map(|(v, _)| each(v)).collect();
    let (events, seen) = played(s, printed).ok()?;
    let mut list = Vec::new();
    for event in events {
        match event {
            Event::Start => list.push("\"start\"".to_owned()),
            Event::Scan { now, inputs } => {
                let now = narrowed(Type::Time, now as u64)?;
                let words: Option<Vec<i64>> =
                    types.iter().zip(inputs).map(|(t, w)| narrowed(*t, w)).collect();
                list.push(format!("[{now},{:?}]", words?));
            }
        }
    }
    let fault = if printed.text.contains("FAULT : BOOL") { "[\"FAULT\",null]," } else { "" };
    let steps: Vec<String> =
        (0..s.compiled.symbols.steps()).map(|i| format!("[\"{}\",null]", printed.step(StepId(i)))).collect();
    let all = members(visible.iter().map(|(v, n)| (*v, &**n)));
    let [file, symbols] = ["awl", "asc"].map(|e| folder.0.join(format!("{}.{e}", printed.name)));
    std::fs::write(&file, &printed.text).expect("a source");
    let table = printed.beside.first().map_or("", |(_, text)| text);
    std::fs::write(&symbols, table).expect("a symbol table");
    let shown = format!("{fault}{},{all}", steps.join(","));
    let task = format!(
        "{{\"file\":{file:?},\"symbols\":{symbols:?},\"inputs\":[{}],\"shown\":[{}],\"events\":[{}]}}",
        members(inputs().map(|(v, n)| (*v, &**n))),
        shown.trim_matches(','),
        list.join(",")
    );
    let shown = visible.iter().flat_map(|(v, _)| each(v)).collect();
    Some((task, seen, shown))
}

/// The words of a line of the answer.
fn answer(line: &str) -> Result<Vec<Vec<i64>>, String> {
    let Some(list) = line.strip_prefix("{\"seen\": [").and_then(|l| l.strip_suffix("]}")) else {
        return Err(line.to_owned());
    };
    let rows = list.split('[').filter(|row| !row.is_empty());
    rows.map(|row| {
        let row = row.trim_end_matches([']', ',', ' ']).split(", ").filter(|w| !w.is_empty());
        row.map(|w| w.parse().map_err(|_| format!("no number: {w}"))).collect()
    })
    .collect()
}

#[test]
fn conformance_cases_run_in_awlsim_as_in_the_engine() {
    let subjects = cases::spec().unwrap_or_else(|e| panic!("{e}"));
    let Prints { list, refused } = prints(&subjects, Form::Awl).unwrap_or_else(|e| panic!("{e}"));
    println!("awl: {} of {} printed", list.len(), subjects.len());
    refused.iter().for_each(|(why, n)| println!("  {n} refused: {why}"));
    assert!(list.len() > 300, "only {} cases can be printed", list.len());
    let Some(python) = g7_peers::python("awlsim") else { return };
    let folder = Folder::new("awl");
    std::fs::create_dir_all(&folder.0).expect("a folder");
    let tasks: Vec<_> = list.iter().filter_map(|(s, p)| Some((s, p, task(&folder, s, p)?))).collect();
    println!("  {} have times that are no milliseconds", list.len() - tasks.len());
    let file = folder.0.join("cases.json");
    let text: Vec<&str> = tasks.iter().map(|(_, _, (t, _, _))| &**t).collect();
    std::fs::write(&file, format!("[{}]", text.join(",\n"))).expect("the cases");
    let out =
        Command::new(python).arg(g7_peers::script("awl_run.py")).arg(&file).output().expect("it starts");
    let said = String::from_utf8_lossy(&out.stdout);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let mut wrong: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for ((s, printed, (_, seen, types)), line) in tasks.iter().zip(said.lines()) {
        if let Err(why) = compared(s, printed, seen, types, line) {
            wrong.entry(why).or_default().push(s.title.clone());
        }
    }
    assert_eq!(said.lines().count(), tasks.len());
    assert!(wrong.is_empty(), "{wrong:#?}");
    println!("  {} agree", tasks.len());
}

fn compared(s: &Subject, printed: &Printed, seen: &[Seen], types: &[Type], line: &str) -> Result<(), String> {
    let rows = answer(line)?;
    let faults = printed.text.contains("FAULT : BOOL");
    let steps = s.compiled.symbols.steps() as usize;
    if rows.len() != seen.len() {
        return Err(format!("{} scans, not {}", rows.len(), seen.len()));
    }
    for (k, (row, want)) in rows.iter().zip(seen).enumerate() {
        let mut row = row.iter().copied();
        let stopped = faults && row.next() == Some(1);
        let steps: Vec<u64> = row.by_ref().take(steps).map(|w| w as u64).collect();
        let words =
            types.iter().zip(row).map(|(ty, w)| if *ty == Type::Time { w * 1_000_000 } else { w } as u64);
        let words: Vec<u64> = match stopped {
            true => {
                let outputs = shown(s, printed);
                let outputs =
                    outputs.iter().flat_map(|(v, _)| vec![v.class == VarClass::Output; v.elements as usize]);
                words.zip(outputs).filter(|(_, output)| *output).map(|(w, _)| w).collect()
            }
            false => steps.into_iter().chain(words).collect(),
        };
        let got = Seen { stopped, words };
        if got != *want {
            return Err(format!("scan {k}: {}", difference(s, printed, want, &got)));
        }
    }
    Ok(())
}

/// A chart in a file, and what a peer says to it.
struct Read {
    title: String,
    printed: Printed,
    said: String,
}

/// Conformance cases in a form, in files of a folder, read by a script of a peer.
fn read_by(form: Form, ending: &str, module: &str, script: &str) -> Option<Vec<Read>> {
    let subjects = cases::spec().unwrap_or_else(|e| panic!("{e}"));
    let Prints { list, refused } = prints(&subjects, form).unwrap_or_else(|e| panic!("{e}"));
    println!("{ending}: {} of {} printed", list.len(), subjects.len());
    refused.iter().for_each(|(why, n)| println!("  {n} refused: {why}"));
    assert!(list.len() > 300, "only {} cases can be printed", list.len());
    let python = g7_peers::python(module)?;
    let folder = Folder::new(ending);
    std::fs::create_dir_all(&folder.0).expect("a folder");
    let mut read = Vec::new();
    // blark takes about a second for each.
    for (s, printed) in list.into_iter().step_by(24) {
        let name = format!("{}.{ending}", printed.name);
        std::fs::write(folder.0.join(&name), &printed.text).expect("a file");
        let out = Command::new(&python).arg(g7_peers::script(script)).arg(folder.0.join(&name)).output();
        let out = out.expect("it starts");
        let mut said = String::from_utf8_lossy(&out.stdout).trim().to_owned();
        said += String::from_utf8_lossy(&out.stderr).trim();
        assert!(out.status.success(), "{}: {said}", s.title);
        read.push(Read { title: s.title.clone(), printed, said });
    }
    println!("  {} read", read.len());
    Some(read)
}

#[test]
fn units_of_twincat_are_read_by_blark() {
    for r in read_by(Form::TwinCat, "TcPOU", "blark", "twincat_read.py").into_iter().flatten() {
        let number: Option<usize> = r.said.parse().ok();
        assert!(number.is_some_and(|n| n > 0), "{}: {}", r.title, r.said);
    }
}

#[test]
fn programs_of_logix_are_loaded_by_l5x() {
    for r in read_by(Form::Logix, "L5X", "l5x", "l5x_read.py").into_iter().flatten() {
        let tags = r.printed.text.matches("<Tag Name=").count();
        assert_eq!(r.said.parse(), Ok(tags), "{}: {}", r.title, r.said);
    }
}

/// A chart with a delay, a retained count and addresses.
const TANK: &str = "profile iec61131
input start : BOOL at %I0.0 \"push button\"
output motor : BOOL at %Q0.1
var count : INT := 3 retain
chart Tank {
  initial step 1
  step 2 { N motor; P1 count := count + 1 }
  1 -> 2 when start
  2 -> 1 when 2s/X2
}
";

/// The chart in a form: its text, and the file beside it.
fn tank(form: Form) -> (String, String) {
    let (doc, problems) = g7_syntax::parse(TANK, g7_model::FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let compiled = g7_compile::compile(&doc).0.expect("a chart");
    let printed = print(&compiled, form, "tank", TANK).unwrap_or_else(|e| panic!("{e:?}"));
    (printed.text, printed.beside.into_iter().map(|(_, text)| text).collect())
}

fn holds(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
}

#[test]
fn variables_of_scl_are_marked_and_its_tags_have_addresses() {
    let (text, tags) = tank(Form::Scl);
    holds(
        &text,
        &[
            "VAR RETAIN\n      count : INT := 3;",
            "#T_1_to_2 := #X_1 AND #start;",
            "#CLOCK(IN := TRUE, PT := T#20d);",
        ],
    );
    holds(
        &text,
        &[
            "CLOCK {InstructionName := 'TON_TIME'; LibVersion := '1.0'} : TON_TIME;",
            "DATA_BLOCK \"tank_data\"",
        ],
    );
    holds(&tags, &["remark=\"push button\" addr=\"%I0.0\">start</Tag>", "addr=\"%Q0.1\">motor</Tag>"]);
}

#[test]
fn sections_of_control_expert_have_their_variables() {
    let (text, _) = tank(Form::Unity);
    holds(
        &text,
        &["<variables name=\"CLOCK\" typeName=\"TON\">", "<variableInit value=\"3\"/>", "task=\"MAST\""],
    );
    // Signs of XML in the statements are escaped.
    holds(&text, &["&gt;= T#2s", "T_1_to_2 := X_1 AND start;"]);
}

#[test]
fn symbols_of_awl_have_addresses_in_columns() {
    let (text, symbols) = tank(Form::Awl);
    holds(&text, &["DATA_BLOCK DB 1", "count := 3;", "CALL #CLOCK (IN := TRUE, PT := T#20D, ET := #NOW);"]);
    let row = symbols.lines().find(|row| row.starts_with("126,start ")).expect("a row");
    assert_eq!((row.len(), row.get(28..50)), (130, Some("I     0.0   BOOL      ")));
}
