//! Projects in PLCopen XML and Ladder, opened by the generators of Beremiz and OpenPLC where these are found
//! (`g7_peers::projects`). `make interop` tells what matiec compiles of it.
#![allow(clippy::disallowed_methods, reason = "the test starts other programs")]

use g7_codegen::plc;
use g7_exchange::Dialect;
use g7_model::{FileId, Severity};
use g7_peers::projects::readers;
use g7_tests::generated::cases::Folder;

/// Charts for which the generators need a form of their own: with chained divergences, jumps, macro-steps, two
/// charts, addresses, function blocks, and one without variables.
const CHARTS: [(&str, &str); 4] = [
    (
        "chained",
        "input a, b : BOOL
         chart G {
           initial step S1  step S2  step S3  step S4  macro M = Inner
           S1 -> (S2, S3) when a
           S1 -> S2 when b
           S2 -> S4 when not a
           (S2, S3) -> M when a and b
           M -> S1 when a
           S4 -> S1 when b
         }
         macrochart Inner { entry step I  exit step O  I -> O when a }",
    ),
    ("bare", "chart G { initial step S1  step S2  S1 -> S2 when S1.t >= 1s  S2 -> S1 when S2.t >= 1s }"),
    (
        "two",
        "input a : BOOL at %IX0.0
         output q : BOOL at %QX0.0
         chart One { initial step S1  step S2 { N q }  S1 -> S2 when a  S2 -> S1 when not a }
         chart Two { initial step S3  step S4  S3 -> S4 when One.S2.X  S4 -> S3 when a }",
    ),
    (
        "blocks",
        "input a : BOOL
         output q : BOOL
         var n : INT
         chart G {
           initial step S1 { N q if a  P1 n := n + 1 }
           step S2 { D 2s q }
           S1 -> S2 when ↑a
           S2 -> S1 when 3s/a
         }",
    ),
];

#[test]
fn beremiz_and_openplc_open_projects() {
    let readers = readers();
    let folder = Folder::new("interop");
    std::fs::create_dir_all(&folder.0).expect("a folder");
    let plcopen = g7_exchange::named("plcopen").expect("a format of the table");
    for reader in &readers {
        for (name, text) in CHARTS {
            let (document, problems) = g7_syntax::parse(&format!("profile iec61131\n{text}"), FileId(0));
            assert!(problems.is_empty(), "{name}: {problems:?}");
            let dialect = if reader.name == "OpenPLC" { Dialect::OpenPlc } else { Dialect::Beremiz };
            let written = plcopen.write_in(&document, dialect).expect("it has dialects");
            let lost: Vec<_> = written.problems.iter().filter(|p| p.severity() == Severity::Error).collect();
            assert!(lost.is_empty(), "{name}: {lost:?}");
            let project = folder.0.join("plc.xml");
            std::fs::write(&project, &written.text).expect("a file");
            let made = reader.text(&project).unwrap_or_else(|e| panic!("{} on {name}: {e}", reader.name));
            assert!(made.contains("INITIAL_STEP"), "{name}: {made}");
        }
    }
}

/// A lone contact beside a series (`q`), edges, a timer and a sum, which are blocks of Ladder.
const LADDER: &str = "profile iec61131
input a : BOOL
output q : BOOL
var n : INT
chart G {
  initial step 1
  step 2 { N q  P1 n := n + 1 }
  step 3 { N q if a }
  1 -> 2 when ↑a
  2 -> 3 when 3s/a
  3 -> 1 when not a
}
";

#[test]
fn beremiz_opens_ladder() {
    let Some(reader) = readers().into_iter().find(|r| r.name == "Beremiz") else { return };
    let folder = Folder::new("interop-ladder");
    std::fs::create_dir_all(&folder.0).expect("a folder");
    let (document, problems) = g7_syntax::parse(LADDER, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (compiled, problems) = g7_compile::compile(&document);
    let compiled = compiled.unwrap_or_else(|| panic!("{problems:?}"));
    let printed = plc::print(&compiled, plc::Form::Ld, "tank", LADDER).unwrap_or_else(|p| panic!("{p:?}"));
    let project = folder.0.join("tank.xml");
    std::fs::write(&project, &printed.text).expect("a file");
    let made = reader.text(&project).unwrap_or_else(|e| panic!("{e}"));
    assert!(made.contains("FUNCTION_BLOCK tank") && made.contains("TRUE"), "{made}");
}
