//! The charts of the table, read from files and compiled once.

use std::path::{Path, PathBuf};

use g7_compile::Compiled;
use g7_model::{Document, FileId, Problem, Severity};
use g7_tests::case;

/// A chart that is tried.
#[derive(Debug)]
pub(crate) struct Chart {
    pub(crate) file: PathBuf,
    pub(crate) document: Document,
    pub(crate) compiled: Option<Compiled>,
}

/// The charts at some paths, in an order that mixes the folders, so that a row that ends early has seen of all.
pub(crate) fn read(paths: &[PathBuf]) -> Vec<Chart> {
    let mut all: Vec<Option<Chart>> =
        paths.iter().flat_map(|p| case::files(p)).filter_map(chart).map(Some).collect();
    // No factor of the number of charts, as a prime that is longer than the list would be.
    let (count, stride) = (all.len(), 7_919);
    (0..count).filter_map(|k| all.get_mut(k * stride % count)?.take()).collect()
}

fn failed(problems: &[Problem]) -> bool {
    problems.iter().any(|p| p.severity() == Severity::Error)
}

/// The chart of a file, if there is one without errors.
fn chart(file: PathBuf) -> Option<Chart> {
    let document = document(&file)?;
    let (compiled, problems) = g7_compile::compile(&document);
    let fine = document.charts().next().is_some() && !failed(&problems);
    fine.then_some(Chart { file, document, compiled })
}

fn document(path: &Path) -> Option<Document> {
    let bytes = std::fs::read(path).ok()?;
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let (document, problems) = match ending {
        "md" => (case::document(&case::read(&String::from_utf8_lossy(&bytes)).ok()?.chart).ok()?, Vec::new()),
        "g7" => g7_syntax::parse(&String::from_utf8_lossy(&bytes), FileId(0)),
        _ => {
            let name = path.display().to_string();
            g7_exchange::recognise(&name, &bytes)?.read(&bytes, FileId(0))?
        }
    };
    (!failed(&problems)).then_some(document)
}
