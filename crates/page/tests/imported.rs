//! A file of another tool stays what it was opened as: its text is .g7 text, whatever its name says.
#![allow(clippy::disallowed_methods, reason = "the tests read the files of other tools")]

mod common;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use common::Asked;
use serde_json::{Value, json};

/// All files below a folder.
fn below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            below(&path, found);
        } else {
            found.push(path);
        }
    }
}

fn charts(look: &Value) -> Vec<Value> {
    look["charts"].as_array().expect("a list").iter().map(|c| c["name"].clone()).collect()
}

#[test]
fn a_file_of_every_form_is_still_read_behind_a_keystroke() {
    let mut files = Vec::new();
    below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/interchange"), &mut files);
    let mut endings = BTreeSet::new();
    for path in files {
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let mut page = Asked::default();
        let Ok(opened) = page.ask(json!({ "do": "open", "file": name, "text": text })) else { continue };
        if opened["imported"] != true {
            continue;
        }
        if charts(&opened).is_empty() {
            continue;
        }
        endings.insert(path.extension().map(|e| e.to_string_lossy().into_owned()));
        let (file, end) = (&opened["file"], &opened["length"]);
        let typed = page.ok(json!({
            "do": "splice", "file": file, "splices": [{ "from": end, "to": end, "insert": "\n" }],
        }));
        assert_eq!((charts(&typed), &typed["clean"]), (charts(&opened), &json!(true)), "{name}");
    }
    assert!(endings.len() >= 7, "{endings:?}");
}
