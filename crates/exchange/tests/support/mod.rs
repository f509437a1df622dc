//! The common part of the tests of several formats: files, the laws for each of
//! them, and a bench to run what came of it.
#![allow(dead_code, reason = "each test uses a part of it")]
#![allow(clippy::disallowed_methods, reason = "files are read")]

pub(crate) mod hostile;

use std::path::{Path, PathBuf};

use g7_compile::Compiled;
use g7_engine::State;
use g7_exchange::Written;
use g7_model::{Document, FileId, Problem, Severity};

/// A file of `tests/interchange`.
pub(crate) fn own(folder: &str, name: &str) -> Vec<u8> {
    let root = [env!("CARGO_MANIFEST_DIR"), "..", "..", "tests", "interchange"].iter().collect::<PathBuf>();
    std::fs::read(root.join(folder).join(name)).expect("the file is part of the repository")
}

/// The files of a folder of the corpus with one of these endings, by name; none where it is absent.
pub(crate) fn corpus(folder: &str, endings: &[&str]) -> Vec<(String, Vec<u8>)> {
    let Some(root) = g7_peers::corpus(folder) else { return Vec::new() };
    let mut files = Vec::new();
    collect(&root, endings, &mut files);
    files.sort();
    assert!(!files.is_empty(), "{}: no {endings:?}", root.display());
    files
}

fn collect(folder: &Path, endings: &[&str], into: &mut Vec<(String, Vec<u8>)>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        if path.is_dir() {
            collect(&path, endings, into);
        } else if endings.iter().any(|e| name.ends_with(e)) {
            let bytes = std::fs::read(&path).expect("a file of the corpus");
            into.push((name, bytes));
        }
    }
}

/// The word of the format of which a file is.
pub(crate) fn recognise(name: &str, bytes: &[u8]) -> Option<&'static str> {
    g7_exchange::recognise(name, bytes).map(|format| format.word)
}

/// A file read as one of this format.
pub(crate) fn import(format: &str, bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    g7_exchange::named(format).and_then(|f| f.read(bytes, file)).expect("a format that is read")
}

/// A document written in this format.
pub(crate) fn export(format: &str, document: &Document) -> Written {
    g7_exchange::named(format).and_then(|f| f.write(document)).expect("a format that is written")
}

/// The result of a file that is known as this format; its places lie in the
/// file, and what is printed reads as the same document.
pub(crate) fn read(format: &str, bytes: &[u8]) -> (Document, Vec<Problem>) {
    assert_eq!(recognise("", bytes), Some(format));
    let (document, problems) = import(format, bytes, FileId(0));
    for p in &problems {
        assert!(p.at.start <= p.at.end && p.at.end as usize <= bytes.len().max(1), "{p:?}");
    }
    if errors(&problems).is_empty() {
        let text = g7_syntax::print(&document, None);
        let (again, faults) = g7_syntax::parse(&text, FileId(0));
        assert!(faults.is_empty(), "{faults:?}\n{text}");
        assert_eq!(again.items, document.items, "{text}");
    }
    (document, problems)
}

/// The messages of the errors.
pub(crate) fn errors(problems: &[Problem]) -> Vec<&str> {
    problems.iter().filter(|p| p.severity() == Severity::Error).map(|p| &*p.what).collect()
}

/// `code line: words` of each problem.
pub(crate) fn lines(bytes: &[u8], problems: &[Problem]) -> Vec<String> {
    let line = |at: u32| 1 + bytes.iter().take(at as usize).filter(|b| **b == b'\n').count();
    problems.iter().map(|p| format!("{} {}: {}", p.code.id, line(p.at.start), p.what)).collect()
}

/// The lines of the .g7 text in which `words` stand, without blanks around.
pub(crate) fn text_of(document: &Document) -> String {
    g7_syntax::print(document, None)
}

/// A document at work.
pub(crate) struct Bench {
    compiled: Compiled,
    state: State,
    inputs: Vec<u64>,
    now: i64,
    cycle: i64,
}

impl Bench {
    /// The document must compile.
    pub(crate) fn new(document: &Document) -> Bench {
        let (compiled, problems) = g7_compile::compile(document);
        let compiled = compiled.unwrap_or_else(|| {
            let errors: Vec<_> = problems.iter().filter(|p| p.severity() == Severity::Error).collect();
            panic!("{errors:#?}\n{}", g7_syntax::print(document, None))
        });
        let state = State::new(&compiled.program);
        let rows = compiled.program.tables().inputs;
        let inputs = vec![0; (rows.end - rows.start) as usize];
        let cycle = compiled.symbols.cycle.count();
        Bench { compiled, state, inputs, now: 0, cycle }
    }

    /// Sets an input from the next scan on.
    pub(crate) fn set(&mut self, name: &str, value: i64) -> &mut Bench {
        let addr = self.compiled.symbols.variable(name).unwrap_or_else(|| panic!("no variable {name}")).addr;
        let first = self.compiled.program.tables().inputs.start;
        self.inputs[(addr.0 - first) as usize] = value.cast_unsigned();
        self
    }

    /// One scan.
    pub(crate) fn scan(&mut self) -> &mut Bench {
        self.try_scan().expect("no fault");
        self
    }

    /// One scan, which may end with a fault.
    pub(crate) fn try_scan(&mut self) -> Result<(), g7_engine::Fault> {
        g7_engine::scan(&self.compiled.program, &mut self.state, &self.inputs, self.now)?;
        self.now += self.cycle;
        Ok(())
    }

    /// Scans until so many milliseconds have gone by.
    pub(crate) fn run(&mut self, ms: i64) -> &mut Bench {
        let end = self.now + ms * 1_000_000;
        while self.now < end {
            self.scan();
        }
        self
    }

    /// The value of a variable.
    pub(crate) fn get(&self, name: &str) -> i64 {
        let variable = self.compiled.symbols.variable(name).unwrap_or_else(|| panic!("no variable {name}"));
        variable.value(&self.state)[0].cast_signed()
    }

    /// The value of a variable as users see it: of an enumeration, its name.
    pub(crate) fn shown(&self, name: &str) -> String {
        let variable = self.compiled.symbols.variable(name).unwrap_or_else(|| panic!("no variable {name}"));
        let number = variable.value(&self.state)[0].cast_signed();
        let value = variable.held.as_ref().and_then(|held| held.name_of(number.into()));
        value.map_or_else(|| number.to_string(), str::to_owned)
    }

    /// The active steps.
    pub(crate) fn active(&self) -> Vec<String> {
        self.state.active().map(|s| self.compiled.symbols.step_name(s).to_string()).collect()
    }
}
