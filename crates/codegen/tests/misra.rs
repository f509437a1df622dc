//! The rules of MISRA C:2012 that printed C keeps, as the addon of cppcheck finds them.
#![allow(clippy::disallowed_methods, reason = "the test starts a program")]

use std::process::Command;

use g7_codegen::{Language, Options, Style, print};
use g7_compile::compile;
use g7_model::FileId;

const CHART: &str = "profile iec60848
input a : BOOL
input b : BOOL
output p : BOOL
chart G {
  initial step 1
  step 2 { N p }
  step 3
  1 -> 2 when ↑a
  2 -> 3 when ↓b
  3 -> 1 when not a
}
";

/// Rules that are kept: numbers beside unsigned values, chains that end with `else`, names of the
/// library.
const KEPT: [&str; 3] = ["misra-c2012-10.4]", "misra-c2012-15.7]", "misra-c2012-21.2]"];

#[test]
fn rules_are_kept_as_cppcheck_finds_them() {
    if !g7_peers::tool("cppcheck") {
        return;
    }
    let (doc, problems) = g7_syntax::parse(CHART, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (compiled, problems) = compile(&doc);
    let compiled = compiled.unwrap_or_else(|| panic!("{problems:?}"));
    for style in [Style::Structured, Style::Flat] {
        let options = Options { language: Language::C, style, name: "t", source: CHART };
        let printed = print(&compiled, &options).expect("it can be printed");
        let folder = std::env::temp_dir().join(format!("g7-misra-{}-{style:?}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        for f in &printed.files {
            std::fs::write(folder.join(&f.name), &f.text).expect("a file");
        }
        let out = Command::new("cppcheck")
            .args(["--addon=misra", "--std=c99", "--quiet", "t.c"])
            .current_dir(&folder)
            .output();
        let _ = std::fs::remove_dir_all(&folder);
        let text = String::from_utf8_lossy(&out.expect("cppcheck starts").stderr).into_owned();
        // The addon has run: functions with several exits are found.
        assert!(text.contains("misra-c2012-15.5]"), "{text}");
        for rule in KEPT {
            assert!(!text.contains(rule), "{style:?}: {rule}\n{text}");
        }
    }
}
