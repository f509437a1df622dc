//! `interop FILE…`: writes charts for other tools, has these take them, and prints a table of what was accepted:
//!
//! - PLCopen XML, opened by Beremiz and OpenPLC; matiec compiles what they make;
//! - the same with Ladder (`gen ld`), unless `G7_NO_LADDER` is set;
//! - text as SFC, Structured Text and Instruction List, compiled by matiec;
//! - XMI, loaded by pyecore with the meta-model of the corpus.
//!
//! Files may be charts, files of other tools and conformance cases, or folders of them. Whatever G7
//! refuses with a reason is not tried; a table has each reason with its count, its first file and who is right, and the
//! complaints of the peers stand below it.
#![allow(clippy::disallowed_methods, clippy::print_stdout, reason = "a tool: it starts other programs")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use g7_codegen::plc;
use g7_exchange::{Dialect, Format};
use g7_model::{Document, FileId, Nanos, Problem, ProfileName, Severity};
use g7_peers::Matiec;
use g7_peers::mended::mended;
use g7_peers::projects::{Projects, output, readers};
use g7_tests::case;
use g7_tests::generated::cases::Folder;
use g7_tests::generated::project;

fn main() {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let charts: Vec<(PathBuf, Document)> = arguments
        .iter()
        .flat_map(|p| case::files(p))
        .filter_map(|p| Some((p.clone(), document(&p)?)))
        .collect();
    let folder = Folder::new("interop-table");
    std::fs::create_dir_all(&folder.0).unwrap_or_else(|e| panic!("{}: {e}", folder.0.display()));
    let matiec = g7_peers::matiec();
    if let Some(matiec) = &matiec {
        mended(&matiec.lib.join("C"), &folder.0.join("C")).unwrap_or_else(|e| panic!("{e}"));
    }
    let mut table = Table { charts: &charts, folder, matiec, why: BTreeMap::new() };
    let plcopen: &Format = g7_exchange::named("plcopen").expect("a format of the table");
    println!("| program | accepted / tried |\n|---|---|");
    for reader in readers() {
        let dialect = if reader.name == "OpenPLC" { Dialect::OpenPlc } else { Dialect::Beremiz };
        table.rows(&reader, reader.name, true, |document| {
            let written = plcopen.write_in(document, dialect)?;
            Some(taken(written.text, &written.problems).map_err(|why| format!("{}, {why}", reader.name)))
        });
        if reader.name == "Beremiz" && std::env::var_os("G7_NO_LADDER").is_none() {
            table.rows(&reader, "Beremiz on Ladder", false, |document| {
                let ready = g7_compile::compile(document).0?;
                let printed = plc::print(&ready, plc::Form::Ld, "chart", "");
                let why = |lost: Vec<Problem>| lost.first().map_or("no reason".into(), |p| p.what.clone());
                Some(printed.map(|p| p.text).map_err(|lost| format!("no Ladder: {}", why(lost))))
            });
        }
    }
    table.texts("SFC text", |document| {
        let written = g7_exchange::named("sfc")?.write(document)?;
        Some(taken(written.text, &written.problems))
    });
    for (name, form) in [("flat ST", plc::Form::St), ("IL", plc::Form::Il)] {
        table.texts(name, |document| {
            let ready = g7_compile::compile(document).0?;
            let printed = plc::print(&ready, form, "chart", "");
            Some(match printed {
                Ok(printed) => Ok(printed.text),
                Err(lost) => taken(String::new(), &lost),
            })
        });
    }
    table.models();
    println!("\n{} charts", charts.len());
    println!("\n| reason | charts | first | who is right |\n|---|---|---|---|");
    for (reason, (count, first)) in &table.why {
        println!("| {reason} | {count} | {} | {} |", first.display(), who(reason));
    }
}

/// A text, if nothing is lost in it; otherwise the first loss.
fn taken(text: String, problems: &[Problem]) -> Result<String, String> {
    let lost = problems.iter().find(|p| p.severity() == Severity::Error);
    lost.map_or(Ok(text), |p| Err(format!("refused by G7: {}", p.what)))
}

/// Words of the refusals where the target language has no such construct: G7 is right to refuse there.
const ABSENT: [&str; 4] =
    ["which IEC 61131-3 does not have", "the meta-model has none", "the meta-model's are", "stability"];

/// Who is right where something was not taken.
fn who(reason: &str) -> &'static str {
    let is_own = reason.contains("refused by G7") || reason.contains("no Ladder");
    if !is_own {
        return "a form of G7 that the tool does not take, or a fault of the tool";
    }
    if ABSENT.iter().any(|word| reason.contains(word)) {
        return "G7: the language has no such construct";
    }
    "a limit of G7: a form could be found"
}

/// A reason without the names of one chart, so that equal reasons are counted together.
fn nameless(reason: &str) -> String {
    let parts = reason.split('`').enumerate();
    let parts: String = parts.map(|(i, part)| if i % 2 == 1 { "`…`" } else { part }).collect();
    parts.replace('|', "/").chars().take(100).collect()
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
        self.why.entry(nameless(reason)).or_insert_with(|| (0, file.to_path_buf())).0 += 1;
    }

    /// Prints the projects that the reader opens, of these the ones that matiec compiles, and, if they are run, of
    /// these the ones that do the same as the engine. `written`
    /// gives the project of a chart or the reason why there is none, and nothing for a chart that is left out.
    fn rows(
        &mut self,
        reader: &Projects,
        name: &str,
        run: bool,
        written: impl Fn(&Document) -> Option<Result<String, String>>,
    ) {
        let (mut tried, mut opened, mut compiled, mut alike) = (0, 0, 0, 0);
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
                    if self.compiles(&program, file) {
                        compiled += 1;
                        match run.then(|| self.runs(document, &text)) {
                            Some(Ok(())) => alike += 1,
                            Some(Err(reason)) => self.note(&format!("{name}, run: {reason}"), file),
                            None => {}
                        }
                    }
                }
                Err(reason) => self.note(&format!("{name}: {reason}"), file),
            }
        }
        println!("| {name} | {opened} / {tried} |");
        if self.matiec.is_some() {
            println!("| matiec on the text of {name} | {compiled} / {opened} |");
            if run {
                println!("| its program runs as the engine | {alike} / {compiled} |");
            }
        }
    }

    /// Prints how many texts matiec compiles.
    fn texts(&mut self, name: &str, written: impl Fn(&Document) -> Option<Result<String, String>>) {
        let (mut tried, mut compiled) = (0, 0);
        for (file, document) in self.charts {
            match written(document) {
                Some(Ok(text)) if self.matiec.is_some() => {
                    tried += 1;
                    compiled += u32::from(self.compiles(&text, file));
                }
                Some(Err(reason)) => self.note(&format!("{name}, {reason}"), file),
                _ => {}
            }
        }
        if self.matiec.is_some() {
            println!("| matiec on {name} | {compiled} / {tried} |");
        }
    }

    /// Prints how many models pyecore loads.
    fn models(&mut self) {
        let meta = g7_peers::corpus("agrafe-metamodel/Project-AGRAFE/model");
        let Some((meta, python)) = meta.zip(g7_peers::python("pyecore")) else { return };
        let xmi = g7_exchange::named("xmi").expect("a format of the table");
        let mut command = Command::new(python);
        command.arg(g7_peers::script("xmi_read.py")).arg(meta);
        let mut tried = Vec::new();
        for (file, document) in self.charts {
            let Some(written) = xmi.write(document) else { continue };
            match taken(written.text, &written.problems) {
                Ok(text) => {
                    command.arg(self.file(&format!("{}.grafcet", tried.len()), &text));
                    tried.push(file);
                }
                Err(reason) => self.note(&format!("XMI, {reason}"), file),
            }
        }
        let out = command.output().unwrap_or_else(|e| panic!("{e}"));
        let said = String::from_utf8_lossy(&out.stdout);
        let loaded = said.lines().filter(|line| line.parse::<usize>().is_ok()).count();
        println!("| pyecore on XMI | {loaded} / {} |", tried.len());
        for (file, line) in tried.iter().zip(said.lines()).filter(|(_, line)| line.parse::<usize>().is_err())
        {
            self.note(&format!("pyecore: {line}"), file);
        }
    }

    /// True if matiec is there and takes a text.
    fn compiles(&mut self, program: &str, file: &Path) -> bool {
        let Some(matiec) = &self.matiec else { return false };
        let folder = self.folder.0.join("c");
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
        self.file("c/program.st", program);
        let done = output(&matiec.translate(&folder, "program.st"));
        if let Err(reason) = &done {
            self.note(&format!("matiec: {reason}"), file);
        }
        done.is_ok()
    }

    /// Runs the C program beside the engine: on the text that was written, and on the chart where it has the
    /// rules of the text.
    fn runs(&self, document: &Document, text: &str) -> Result<(), String> {
        let plcopen = g7_exchange::named("plcopen").expect("a format of the table");
        let (again, _) = plcopen.read(text.as_bytes(), FileId(0)).ok_or("it is not read back")?;
        let again = g7_compile::compile(&again).0.ok_or("it is not read back")?;
        let chart = g7_compile::compile(document).0.ok_or("the chart is not compiled")?;
        let cycle = document.cycle().unwrap_or(Nanos::from_millis(10));
        let even = document.charts().any(|c| c.every.is_some_and(|e| e != cycle));
        let scans = project::scans(&chart, 7, 300, cycle.count(), even);
        let want = project::of_engine(&again, &scans);
        let got = project::of_matiec(&self.folder.0.join("c"), &self.folder.0.join("C"), &scans)?;
        let (names, differ) = project::difference(&want, &got);
        if let Some(differ) = differ {
            return Err(format!("as the text: {differ}"));
        }
        if names == 0 {
            return Err("no name to compare".into());
        }
        if document.profile().is_some_and(|p| p.name == ProfileName::Iec61131) {
            let want = project::of_engine(&chart, &scans);
            let differ = project::difference(&want, &got).1;
            return differ.map_or(Ok(()), |d| Err(format!("as the chart: {d}")));
        }
        Ok(())
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
