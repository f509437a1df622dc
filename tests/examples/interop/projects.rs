//! PLCopen XML: charts and Ladder, opened by Beremiz and OpenPLC, compiled by matiec, run beside the engine.

use std::collections::BTreeMap;
use std::path::PathBuf;

use g7_codegen::plc::{self, Printed};
use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_exchange::{Dialect, Format};
use g7_model::{FileId, Nanos, ProfileName, Type};
use g7_peers::Matiec;
use g7_peers::projects::{Projects, readers, schema};
use g7_tests::generate::{Event, Script};
use g7_tests::generated::Subject;
use g7_tests::generated::{blocks, project};
use g7_tests::naive::Value;

use crate::charts::Chart;
use crate::table::{Table, Written, taken};

/// Files that one process opens.
const TOGETHER: usize = 40;
/// Scans of a run.
const SCANS: usize = 300;

/// Charts, by the readers that are installed.
pub(crate) fn charts(table: &mut Table<'_>) {
    for reader in &readers() {
        let dialect = if reader.name == "OpenPLC" { Dialect::OpenPlc } else { Dialect::Beremiz };
        let projects: Vec<(&Chart, String)> = written(table, |chart| project(chart, dialect));
        opened(table, reader, reader.name, &projects, |table, _, chart, text, _| {
            as_the_engine(table, chart, text)
        });
    }
}

/// Ladder, by Beremiz.
pub(crate) fn ladders(table: &mut Table<'_>) {
    if let Some(reader) = readers().iter().find(|r| r.name == "Beremiz") {
        let printed = written(table, |chart| Some(ladder(chart.compiled.as_ref()?).map(|p| p.text)));
        opened(table, reader, "Beremiz on Ladder", &printed, |table, matiec, chart, _, made| {
            ladder_as_the_engine(table, matiec, chart, made)
        });
    }
}

/// Both, by the schema.
pub(crate) fn valid(table: &mut Table<'_>) {
    if let Some(schema) = schema() {
        let mut projects = written(table, |chart| project(chart, Dialect::Standard));
        projects.extend(written(table, |chart| Some(ladder(chart.compiled.as_ref()?).map(|p| p.text))));
        let mut valid = 0;
        for part in projects.chunks(TOGETHER) {
            let files: Vec<PathBuf> =
                part.iter().enumerate().map(|(k, (_, text))| table.file(&format!("{k}.xml"), text)).collect();
            for ((chart, _), said) in part.iter().zip(schema.holds(&files)) {
                match said {
                    Ok(()) => valid += 1,
                    Err(reason) => table.note(&format!("TC6: {reason}"), &chart.file),
                }
            }
        }
        table.row("the schema TC6 2.01 (lxml), charts and Ladder", valid, projects.len(), projects.len());
    }
}

/// The texts that are written of the charts; reasons why some are not are counted.
fn written<'c>(table: &mut Table<'c>, write: impl Fn(&Chart) -> Option<Written>) -> Vec<(&'c Chart, String)> {
    let mut all = Vec::new();
    for chart in table.charts {
        match write(chart) {
            Some(Ok(text)) => all.push((chart, text)),
            Some(Err(reason)) => table.note(&reason, &chart.file),
            None => {}
        }
    }
    all
}

fn plcopen() -> &'static Format {
    g7_exchange::named("plcopen").expect("a format of the table")
}

fn project(chart: &Chart, dialect: Dialect) -> Option<Written> {
    let written = plcopen().write_in(&chart.document, dialect)?;
    Some(taken(written.text, &written.problems).map_err(|why| format!("PLCopen XML, {why}")))
}

fn ladder(compiled: &Compiled) -> Result<Printed, String> {
    plc::print(compiled, plc::Form::Ld, "chart", "").map_err(|lost| {
        lost.first().map_or("no reason".into(), |p| format!("Ladder, refused by G7: {}", p.what))
    })
}

/// Prints how many projects are opened, how many of these matiec compiles, and how many of these run as the engine.
fn opened(
    table: &mut Table<'_>,
    reader: &Projects,
    name: &str,
    projects: &[(&Chart, String)],
    run: impl Fn(&Table<'_>, &Matiec, &Chart, &str, &str) -> Result<(), String>,
) {
    table.begin();
    let (mut made, mut asked) = (Vec::new(), 0);
    for part in projects.chunks(TOGETHER) {
        if table.late() {
            break;
        }
        asked += part.len();
        let file = |(k, (_, text)): (usize, &(&Chart, String))| table.file(&format!("{k}.xml"), text);
        let files: Vec<PathBuf> = part.iter().enumerate().map(file).collect();
        for ((chart, text), answer) in part.iter().zip(reader.texts(&files)) {
            match answer {
                Ok(program) => made.push((*chart, text, program)),
                Err(reason) => table.note(&format!("{name}: {reason}"), &chart.file),
            }
        }
    }
    table.row(name, made.len(), asked, projects.len());
    let Some(matiec) = table.matiec.clone() else { return };
    let (mut begun, mut compiled) = (0, Vec::new());
    for (chart, text, program) in &made {
        if table.late() {
            break;
        }
        begun += 1;
        match table.compiles(&matiec, program) {
            Ok(()) => compiled.push((chart, text, program)),
            Err(why) => table.note(&format!("matiec on the text of {name}: {why}"), &chart.file),
        }
    }
    table.row(&format!("matiec on the text of {name}"), compiled.len(), begun, made.len());
    // A compiler of C and 300 scans take longer, so that fewer may be run than are compiled.
    let (mut begun, mut alike) = (0, 0);
    for (chart, text, program) in &compiled {
        if table.late() {
            break;
        }
        begun += 1;
        match table.compiles(&matiec, program).and_then(|()| run(table, &matiec, chart, text, program)) {
            Ok(()) => alike += 1,
            Err(why) => table.note(&format!("{name}, run: {why}"), &chart.file),
        }
    }
    table.row("its program runs as the engine", alike, begun, compiled.len());
}

/// Runs the C program of matiec beside the engine: on the text that was written, and on the chart where it has the
/// rules of the text.
fn as_the_engine(table: &Table<'_>, chart: &Chart, text: &str) -> Result<(), String> {
    let (again, _) = plcopen().read(text.as_bytes(), FileId(0)).ok_or("it is not read back")?;
    let again = g7_compile::compile(&again).0.ok_or("it is not read back")?;
    let compiled = chart.compiled.as_ref().ok_or("the chart is not compiled")?;
    let cycle = chart.document.cycle().unwrap_or(Nanos::from_millis(10));
    let even = chart.document.charts().any(|c| c.every.is_some_and(|e| e != cycle));
    let scans = project::scans(compiled, 7, SCANS, cycle.count(), even);
    let want = project::of_engine(&again, &scans);
    let got = project::of_matiec(&table.folder.0.join("c"), &table.folder.0.join("C"), &scans)?;
    let (names, differ) = project::difference(&want, &got);
    if let Some(differ) = differ {
        return Err(format!("as the text: {differ}"));
    }
    if names == 0 {
        return Err("no name to compare".into());
    }
    // A switch changes the rules, which is told where the text is written.
    if chart.document.profile().is_some_and(|p| p.name == ProfileName::Iec61131 && p.switches.is_empty()) {
        let want = project::of_engine(compiled, &scans);
        let differ = project::difference(&want, &got).1;
        return differ.map_or(Ok(()), |d| Err(format!("as the chart: {d}")));
    }
    Ok(())
}

/// The same for Ladder, which is one function block.
fn ladder_as_the_engine(table: &Table<'_>, matiec: &Matiec, chart: &Chart, made: &str) -> Result<(), String> {
    let mut subject = Subject::new("chart", &chart.document, None, "")?;
    subject.play(&script(&subject.compiled))?;
    let mut printed = ladder(&subject.compiled)?;
    printed.text = made.to_owned();
    let folder = table.folder.0.join("c");
    let translate = |folder: &std::path::Path, file: &str| matiec.translate(folder, file);
    blocks::batch(&translate, &table.folder.0.join("C"), &folder, "st", &[(&subject, printed)])
}

/// Random inputs, as a script.
fn script(compiled: &Compiled) -> Script {
    let inputs = || compiled.symbols.variables.iter().filter(|v| v.class == VarClass::Input);
    let value = |ty: Type, word: u64| match ty {
        Type::Bool => Value::Bool(word != 0),
        Type::Real => Value::Real(f32::from_bits(word as u32)),
        Type::Lreal => Value::Lreal(f64::from_bits(word)),
        Type::Time | Type::Moment(_) => Value::Time(word as i64),
        _ => Value::Int(i128::from(word)),
    };
    let scans = project::scans(compiled, 7, SCANS, 10_000_000, false);
    let event = |scan: &project::Scan| {
        let given: BTreeMap<String, Value> = inputs()
            .filter_map(|v| {
                Some((v.name.to_string(), value(v.ty, *scan.inputs.get(&v.name.to_uppercase())?)))
            })
            .collect();
        Event::Scan { now: scan.now, inputs: given }
    };
    scans.iter().map(event).collect()
}
