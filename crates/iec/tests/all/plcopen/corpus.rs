//! Projects that people drew, from the corpus that `g7_peers` finds.
#![allow(clippy::disallowed_methods, reason = "the corpus is read")]

use crate::support;
use crate::support::recognise;

use g7_model::{FileId, Severity};

/// A file, the codes of its errors, and whether it runs.
type Row = (&'static str, &'static [&'static str], bool);

const FILES: [Row; 25] = [
    ("VerifAPS/absintsfc/examples/Scenario8_Final.xml", &[], true),
    ("VerifAPS/aps-rvt/examples/ppumod/02_03/Scenario2v0_Final.xml", &[], true),
    ("VerifAPS/aps-rvt/examples/ppumod/02_03/Scenario3v1_Final.xml", &[], true),
    ("VerifAPS/aps-rvt/examples/ppumod/05_07/Scenario5v1_Final.xml", &[], true),
    ("VerifAPS/aps-rvt/examples/ppumod/12_13/Scenario13_Final.xml", &[], true),
    ("VerifAPS/share/PPU/Scenario0v0_Final.xml", &[], true),
    ("VerifAPS/share/PPU/Scenario10_Final.xml", &[], true),
    ("VerifAPS/share/PPU/Scenario11_Final.xml", &[], true),
    ("VerifAPS/share/PPU/Scenario12_Final.xml", &[], true),
    ("VerifAPS/share/PPU/Scenario13_Final.xml", &[], true),
    ("VerifAPS/share/PPU/Scenario1_Final.xml", &[], true),
    ("VerifAPS/share/PPU/Scenario1v0_Final.xml", &[], true),
    ("VerifAPS/share/PPU/Scenario5v1_Final.xml", &[], true),
    ("VerifAPS/share/PPU/Scenario8_Final.xml", &[], true),
    ("VerifAPS/share/PPU/Scenario9_Final.xml", &[], true),
    ("VerifAPS/share/xPPU/PLCOpenXML_Scenario_1.xml", &[], true),
    ("VerifAPS/share/xPPU/PLCOpenXML_Scenario_3.xml", &[], true),
    ("VerifAPS/share/xPPU/PLCOpenXML_Scenario_7.xml", &[], true),
    // Instruction List that goes on with a result across a label.
    ("beremiz/exemples/first_steps/plc.xml", &[], true),
    ("thiagoralves/examples/Multi_Language/plc.xml", &[], true),
    ("beremiz/tests/SFC_TEST.xml", &[], true),
    // A block in Python.
    ("beremiz/tests/projects/svghmi_basic/plc.xml", &["G0604"], false),
    // Not well-formed on purpose.
    ("elian15122000/SOURCE/src/assets/corruptedXML.xml", &["G0601"], true),
    // A step without its wire, an action block at no step, a variable without one.
    ("ironplc/integrations/vscode/tests/grammar/snap/plcopen-sfc.xml", &["G0604", "G0609", "G0609"], true),
    // Instruction List whose line ends are lost.
    ("jubnzv/test/plcopen/example.xml", &["G0604", "G0606", "G0606"], false),
];

#[test]
fn projects_of_the_corpus_are_read_and_run() {
    let Some(folder) = g7_peers::corpus("plcopen-sfc") else { return };
    for (file, expected, runs) in FILES {
        let bytes = std::fs::read(folder.join(file)).expect(file);
        assert_eq!(recognise("", &bytes), Some("plcopen"), "{file}");
        let (document, problems) = support::import("plcopen", &bytes, FileId(0));
        let errors = problems.iter().filter(|p| p.severity() == Severity::Error);
        let mut codes: Vec<&str> = errors.map(|p| p.code.id).collect();
        codes.sort_unstable();
        let words: Vec<&str> = problems.iter().map(|p| &*p.what).collect();
        assert_eq!(codes, expected, "{file}: {words:?}");
        if expected.is_empty() {
            let printed = g7_syntax::print(&document, None);
            let (again, wrong) = g7_syntax::parse(&printed, FileId(0));
            assert!(wrong.is_empty(), "{file}: {wrong:?}");
            assert_eq!(again.items, document.items, "{file}");
        }
        let (compiled, found) = g7_compile::compile(&document);
        let errors: Vec<_> =
            found.iter().filter(|p| p.severity() == Severity::Error).map(|p| &p.what).collect();
        assert_eq!(compiled.is_some(), runs, "{file}: {errors:?}");
        support::export("plcopen", &document);

        // In these each block has one instance: every step and transition is there once.
        if file.contains("/PPU/") || file.ends_with("SFC_TEST.xml") {
            let text = String::from_utf8_lossy(&bytes);
            let steps: usize = document.charts().map(|c| c.steps().count()).sum();
            assert_eq!(steps, text.matches("<step ").count(), "{file}");
            let transitions: usize = document.charts().map(|c| c.transitions().count()).sum();
            assert_eq!(transitions, text.matches("<transition ").count(), "{file}");
        }
    }
}
