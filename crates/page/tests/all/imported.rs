//! A file of another tool stays what it was opened as: its text is .g7 text, whatever its name says.
#![allow(clippy::disallowed_methods, reason = "the tests read the files of other tools")]

use crate::common;

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

#[test]
fn what_one_page_converts_another_opens_as_if_it_had_read_the_file() {
    let mut files = Vec::new();
    below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/interchange"), &mut files);
    let (mut told, mut refused) = (0, 0);
    for path in files {
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let (mut one, mut two) = (Asked::default(), Asked::default());
        for page in [&mut one, &mut two] {
            page.ok(json!({ "do": "speak", "language": "fr" }));
        }
        let opened = one.ask(json!({ "do": "open", "file": name, "text": text }));
        if opened.as_ref().is_ok_and(|look| look["imported"] != true) {
            continue;
        }
        match two.ask(json!({ "between": "import", "ask": { "file": name, "text": text } })) {
            Ok(message) => {
                let again = Asked::default().ok(message.clone());
                let shown =
                    |look: &Value| (look["file"].clone(), look["hash"].clone(), look["charts"].clone());
                let opened = opened.expect("it is opened");
                assert_eq!(shown(&again), shown(&opened), "{name}");
                let count = |look: &Value| look["problems"].as_array().map(Vec::len);
                assert_eq!(count(&again), count(&opened), "{name}");
                for row in message["told"].as_array().expect("a list") {
                    let there = opened["problems"].as_array().expect("a list");
                    assert!(there.iter().any(|p| p["what"] == row["what"]), "{name}: {row}");
                    told += 1;
                }
            }
            Err(why) => {
                assert_eq!(opened, Err(why), "{name}");
                refused += 1;
            }
        }
    }
    assert!(told > 3 && refused > 0, "{told} problems were told, {refused} files were refused");
}

#[test]
fn a_question_about_lent_files_is_answered_and_leaves_nothing_open() {
    let mut page = Asked::default();
    let text = "chart G {\n  initial step 1\n}\n";
    let lent = json!([{ "file": "a.g7", "text": text }]);
    let mut about = |ask: Value| page.ask(json!({ "between": "about", "files": lent, "ask": ask }));
    let looked = about(json!({ "do": "look", "file": "a.g7" })).expect("it is open there");
    assert_eq!(looked["charts"][0]["name"], "G");
    assert_eq!(about(json!({ "do": "look", "file": "b.g7" })), Err("b.g7 is not open".to_owned()));
    assert_eq!(page.no(json!({ "do": "look", "file": "a.g7" })), "a.g7 is not open");
}
