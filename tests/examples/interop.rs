//! `interop FILE…`: writes charts as PLCopen XML, has Beremiz and OpenPLC open them and matiec compile
//! what they make, does the same with Ladder (`gen ld`), and prints a table of what was accepted.
//!
//! Files may be charts, files of other tools and conformance cases, or folders of them. Whatever G7
//! refuses with a reason is not tried; the reasons are counted below the table, as are those of the
//! peers, each with its first file.
#![allow(clippy::disallowed_methods, clippy::print_stdout, reason = "a tool: it starts other programs")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use g7_codegen::plc;
use g7_exchange::{Dialect, Format};
use g7_model::{Document, FileId, Severity};
use g7_peers::projects::{output, readers};
use g7_tests::case;

fn main() {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let folder = std::env::temp_dir().join(format!("g7-interop-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let charts: Vec<(PathBuf, Document)> =
        arguments.iter().flat_map(|p| files(p)).filter_map(|p| Some((p.clone(), document(&p)?))).collect();
    let mut why: BTreeMap<String, (usize, PathBuf)> = BTreeMap::new();
    let mut note = |who: &str, reason: &str, file: &Path| {
        why.entry(format!("{who}: {reason}")).or_insert_with(|| (0, file.to_path_buf())).0 += 1;
    };
    let plcopen: &Format = g7_exchange::named("plcopen").expect("a format of the table");
    let matiec = g7_peers::matiec();
    println!("| program | accepted / tried |\n|---|---|");
    for reader in readers() {
        let dialect = if reader.name == "OpenPLC" { Dialect::OpenPlc } else { Dialect::Beremiz };
        let (mut tried, mut opened, mut compiled) = (0, 0, 0);
        for (file, document) in &charts {
            let Some(written) = plcopen.write_in(document, dialect) else { continue };
            if let Some(lost) = written.problems.iter().find(|p| p.severity() == Severity::Error) {
                note("refused by G7", &lost.what.chars().take(60).collect::<String>(), file);
                continue;
            }
            tried += 1;
            let project = folder.join("plc.xml");
            std::fs::write(&project, &written.text).unwrap_or_else(|e| panic!("{}: {e}", project.display()));
            let text = match reader.text(&project) {
                Ok(text) => text,
                Err(reason) => {
                    note(reader.name, &reason, file);
                    continue;
                }
            };
            opened += 1;
            let Some(matiec) = &matiec else { continue };
            let program = folder.join("program.st");
            std::fs::write(&program, text).unwrap_or_else(|e| panic!("{}: {e}", program.display()));
            match output(&matiec.translate(&folder, "program.st")) {
                Ok(_) => compiled += 1,
                Err(reason) => note("matiec", &reason, file),
            }
        }
        println!("| {} | {opened} / {tried} |", reader.name);
        if matiec.is_some() {
            println!("| matiec on the text of {} | {compiled} / {opened} |", reader.name);
        }
    }
    let (mut tried, mut opened, mut compiled) = (0, 0, 0);
    let beremiz = readers().into_iter().find(|r| r.name == "Beremiz");
    for (file, document) in &charts {
        let (Some(beremiz), Some(ready)) = (&beremiz, g7_compile::compile(document).0) else { continue };
        let printed = match plc::print(&ready, plc::Form::Ld, "chart", "") {
            Ok(printed) => printed,
            Err(lost) => {
                let what = lost.first().map_or("no reason", |p| &p.what);
                note("gen ld", &what.chars().take(60).collect::<String>(), file);
                continue;
            }
        };
        tried += 1;
        let project = folder.join("ladder.xml");
        std::fs::write(&project, &printed.text).unwrap_or_else(|e| panic!("{}: {e}", project.display()));
        let text = match beremiz.text(&project) {
            Ok(text) => text,
            Err(reason) => {
                note("Beremiz on Ladder", &reason, file);
                continue;
            }
        };
        opened += 1;
        let Some(matiec) = &matiec else { continue };
        let program = folder.join("ladder.st");
        std::fs::write(&program, text).unwrap_or_else(|e| panic!("{}: {e}", program.display()));
        match output(&matiec.translate(&folder, "ladder.st")) {
            Ok(_) => compiled += 1,
            Err(reason) => note("matiec on Ladder", &reason, file),
        }
    }
    println!("| Beremiz on Ladder | {opened} / {tried} |");
    println!("| matiec on the text of Beremiz for Ladder | {compiled} / {opened} |");
    println!("\n{} charts", charts.len());
    for (reason, (count, first)) in why {
        println!("{count:4} {reason} ({})", first.display());
    }
    let _ = std::fs::remove_dir_all(folder);
}

/// The files of a folder, at all levels; a file itself.
fn files(path: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(path) else { return vec![path.to_path_buf()] };
    let mut all: Vec<PathBuf> = entries.flatten().map(|e| e.path()).collect();
    all.sort();
    all.into_iter().flat_map(|p| files(&p)).collect()
}

/// The document of a file, if it has charts and no errors.
fn document(path: &Path) -> Option<Document> {
    let bytes = std::fs::read(path).ok()?;
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let found = match ending {
        "md" => case::document(&case::read(&String::from_utf8_lossy(&bytes)).ok()?.chart).ok()?,
        "g7" => {
            let (document, problems) = g7_syntax::parse(&String::from_utf8_lossy(&bytes), FileId(0));
            let wrong = problems.iter().any(|p| p.severity() == Severity::Error);
            if wrong { None } else { Some(document) }?
        }
        _ => {
            let name = path.display().to_string();
            let (document, problems) = g7_exchange::recognise(&name, &bytes)?.read(&bytes, FileId(0))?;
            let wrong = problems.iter().any(|p| p.severity() == Severity::Error);
            if wrong { None } else { Some(document) }?
        }
    };
    let wrong = g7_compile::check(&found).iter().any(|p| p.severity() == Severity::Error);
    (found.charts().next().is_some() && !wrong).then_some(found)
}
