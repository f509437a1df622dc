//! XMI, exported, is loaded by pyecore with the meta-model that its maker wrote: `grafcet.ecore` and `terms.ecore` of
//! the corpus. What the meta-model cannot hold is refused by G7 with its place.
#![allow(clippy::disallowed_methods, reason = "the test starts Python and writes files for it")]

use std::path::PathBuf;
use std::process::Command;

use g7_model::{FileId, Severity};
use g7_tests::case;
use g7_tests::generated::cases::Folder;

const META: &str = "agrafe-metamodel/Project-AGRAFE/model";

/// Documents to be written as XMI: conformance cases, and the charts of the maker himself, read and written again.
fn charts() -> Vec<(PathBuf, String)> {
    let spec: PathBuf = [env!("CARGO_MANIFEST_DIR"), "spec"].iter().collect();
    let own = g7_peers::corpus("agrafe-xmi");
    let xmi = g7_exchange::named("xmi").expect("a format of the table");
    let mut made = Vec::new();
    for path in [Some(spec), own].into_iter().flatten().flat_map(|folder| case::files(&folder)) {
        let bytes = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let document = match path.extension().and_then(|e| e.to_str()) {
            Some("md") => {
                let case = case::read(&String::from_utf8_lossy(&bytes)).ok();
                case.and_then(|c| case::document(&c.chart).ok())
            }
            Some("grafcet") => xmi.read(&bytes, FileId(0)).map(|(document, _)| document),
            _ => None,
        };
        let Some(written) = document.and_then(|d| xmi.write(&d)) else { continue };
        if written.problems.iter().all(|p| p.severity() != Severity::Error) {
            made.push((path, written.text));
        }
    }
    made
}

#[test]
fn pyecore_loads_what_is_written() {
    let charts = charts();
    println!("xmi: {} charts are written", charts.len());
    assert!(charts.len() > 100, "only {} charts are written", charts.len());
    let Some(meta) = g7_peers::corpus(META) else { return };
    let Some(python) = g7_peers::python("pyecore") else { return };
    let folder = Folder::new("xmi");
    std::fs::create_dir_all(&folder.0).expect("a folder");
    let mut command = Command::new(python);
    command.arg(g7_peers::script("xmi_read.py")).arg(meta);
    for (number, (_, text)) in charts.iter().enumerate() {
        let file = folder.0.join(format!("{number}.grafcet"));
        std::fs::write(&file, text).expect("a file");
        command.arg(file);
    }
    let out = command.output().expect("it starts");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let said = String::from_utf8_lossy(&out.stdout);
    assert_eq!(said.lines().count(), charts.len());
    let refused = charts.iter().zip(said.lines()).filter(|(_, line)| line.parse::<usize>().is_err());
    let refused: Vec<String> =
        refused.map(|((path, _), line)| format!("{}: {line}", path.display())).collect();
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}
