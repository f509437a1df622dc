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
use g7_model::{Document, FileId, Problem, Severity};
use g7_peers::Matiec;
use g7_peers::projects::{Projects, output, readers};
use g7_tests::case;
use g7_tests::generated::cases::Folder;

fn main() {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let charts: Vec<(PathBuf, Document)> = arguments
        .iter()
        .flat_map(|p| case::files(p))
        .filter_map(|p| Some((p.clone(), document(&p)?)))
        .collect();
    let folder = Folder::new("interop-table");
    std::fs::create_dir_all(&folder.0).unwrap_or_else(|e| panic!("{}: {e}", folder.0.display()));
    let mut table = Table { charts: &charts, folder, matiec: g7_peers::matiec(), why: BTreeMap::new() };
    let plcopen: &Format = g7_exchange::named("plcopen").expect("a format of the table");
    println!("| program | accepted / tried |\n|---|---|");
    for reader in readers() {
        let dialect = if reader.name == "OpenPLC" { Dialect::OpenPlc } else { Dialect::Beremiz };
        table.rows(&reader, reader.name, |document| {
            let written = plcopen.write_in(document, dialect)?;
            let lost = written.problems.iter().find(|p| p.severity() == Severity::Error);
            Some(lost.map_or(Ok(written.text), |p| Err(format!("refused by G7: {}", p.what))))
        });
        if reader.name == "Beremiz" {
            table.rows(&reader, "Beremiz on Ladder", |document| {
                let ready = g7_compile::compile(document).0?;
                let printed = plc::print(&ready, plc::Form::Ld, "chart", "");
                let why = |lost: Vec<Problem>| lost.first().map_or("no reason".into(), |p| p.what.clone());
                Some(printed.map(|p| p.text).map_err(|lost| format!("no Ladder: {}", why(lost))))
            });
        }
    }
    println!("\n{} charts", charts.len());
    for (reason, (count, first)) in table.why {
        println!("{count:4} {reason} ({})", first.display());
    }
}

/// The charts that are tried, and the reasons why some are not taken.
struct Table<'c> {
    charts: &'c [(PathBuf, Document)],
    folder: Folder,
    matiec: Option<Matiec>,
    /// By reason: how often, and the first file.
    why: BTreeMap<String, (usize, PathBuf)>,
}

impl Table<'_> {
    fn note(&mut self, reason: &str, file: &Path) {
        let reason: String = reason.chars().take(100).collect();
        self.why.entry(reason).or_insert_with(|| (0, file.to_path_buf())).0 += 1;
    }

    /// Prints two rows: the projects that the reader opens, and of these the ones that matiec compiles. `written`
    /// gives the project of a chart or the reason why there is none, and nothing for a chart that is left out.
    fn rows(
        &mut self,
        reader: &Projects,
        name: &str,
        written: impl Fn(&Document) -> Option<Result<String, String>>,
    ) {
        let (mut tried, mut opened, mut compiled) = (0, 0, 0);
        for (file, document) in self.charts {
            let text = match written(document) {
                Some(Ok(text)) => text,
                Some(Err(reason)) => {
                    self.note(&reason, file);
                    continue;
                }
                None => continue,
            };
            tried += 1;
            match reader.text(&self.file("plc.xml", &text)) {
                Ok(program) => {
                    opened += 1;
                    compiled += usize::from(self.compiles(&program, file));
                }
                Err(reason) => self.note(&format!("{name}: {reason}"), file),
            }
        }
        println!("| {name} | {opened} / {tried} |");
        if self.matiec.is_some() {
            println!("| matiec on the text of {name} | {compiled} / {opened} |");
        }
    }

    /// True if matiec is there and takes a text.
    fn compiles(&mut self, program: &str, file: &Path) -> bool {
        self.file("program.st", program);
        let Some(matiec) = &self.matiec else { return false };
        let done = output(&matiec.translate(&self.folder.0, "program.st"));
        if let Err(reason) = &done {
            self.note(&format!("matiec: {reason}"), file);
        }
        done.is_ok()
    }

    fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.folder.0.join(name);
        std::fs::write(&path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        path
    }
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
