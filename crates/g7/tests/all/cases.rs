//! Runs `g7 check` on the cases of `tests/check/tests`, charts whose tests contain mistakes.
#![allow(missing_docs, reason = "a test")]
#![allow(clippy::disallowed_methods, reason = "the runner reads the cases")]

use crate::common;

use std::fs;
use std::path::{Path, PathBuf};

use common::Folder;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let list = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut files: Vec<PathBuf> = list.map(|e| e.expect("an entry").path()).collect();
    files.retain(|p| p.extension().is_some_and(|e| e == ending));
    files.sort();
    assert!(!files.is_empty(), "no cases in {}", folder.display());
    files
}

/// The lines and codes that `g7 check` reports.
fn reported(folder: &Folder, text: &str) -> Vec<(u64, String)> {
    folder.write("case.g7", text);
    let ran = folder.g7(&["check", "--format", "json", "case.g7"]);
    let all: serde_json::Value =
        serde_json::from_str(&ran.out).unwrap_or_else(|e| panic!("{e}: {}", ran.err));
    let problems = all["problems"].as_array().expect("a list");
    let mut found: Vec<(u64, String)> = problems
        .iter()
        .map(|p| {
            (p["start"]["line"].as_u64().expect("a line"), p["code"].as_str().expect("a code").to_owned())
        })
        .collect();
    found.sort();
    assert_eq!(ran.code, i32::from(problems.iter().any(|p| p["severity"] == "error")));
    found
}

/// The lines and codes that the comments of a case expect.
fn expected(text: &str) -> Vec<(u64, String)> {
    let (mut wanted, mut above) = (Vec::new(), 0);
    for (line, text) in (1..).zip(text.lines()) {
        match text.trim_start().strip_prefix("//~") {
            Some(codes) => wanted.extend(codes.split_whitespace().map(|c| (above, c.to_owned()))),
            None => above = line,
        }
    }
    wanted.sort();
    wanted
}

#[test]
fn every_wrong_test_reports_what_it_lists() {
    let scratch = Folder::new();
    for file in files(&root().join("tests/check/tests"), "g7") {
        let text = fs::read_to_string(&file).expect("a case");
        assert_eq!(reported(&scratch, &text), expected(&text), "{}", file.display());
    }
}

#[test]
fn every_code_of_tests_has_a_case_and_a_page_with_examples() {
    let scratch = Folder::new();
    let cases = files(&root().join("tests/check/tests"), "g7");
    for code in g7_model::codes::ALL.iter().filter(|c| c.id.starts_with("G055")) {
        let id = code.id.to_lowercase();
        let own = cases.iter().find(|f| f.file_name().is_some_and(|n| n.to_string_lossy().starts_with(&id)));
        let text = fs::read_to_string(own.unwrap_or_else(|| panic!("{id} has no case"))).expect("a case");
        assert!(expected(&text).iter().any(|(_, c)| c == code.id), "{id}");
        let page = root().join(format!("docs/book/src/problems/{}.md", code.id));
        let page = fs::read_to_string(page).expect("a page");
        assert!(page.starts_with(&format!("# {}: {}\n", code.id, code.title)), "{id}");
        let mut wrong = 0;
        for block in page.split("```g7").skip(1) {
            let (head, rest) = block.split_once('\n').expect("a fence");
            let body = rest.split("```").next().expect("a block");
            let codes: Vec<String> = reported(&scratch, body).into_iter().map(|(_, c)| c).collect();
            if head == ",wrong" {
                wrong += 1;
                assert!(!codes.is_empty() && codes.iter().all(|c| c == code.id), "{id}: {codes:?}");
            } else {
                assert!(codes.is_empty(), "{id}: {codes:?}");
            }
        }
        assert_eq!(wrong, 1, "{id}");
    }
}
