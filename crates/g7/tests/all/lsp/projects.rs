//! A new name in a project of several files.

use serde_json::json;

use super::{Editor, range};
use crate::common;

#[test]
fn a_name_is_changed_in_all_files_of_a_project() {
    let folder = common::Folder::with("");
    let uri = |name: &str| format!("file://{}", folder.path(name).display());
    folder.write("g7.toml", "main = \"cell.g7\"\n");
    folder.write("io.g7", "input go : BOOL\noutput V : BOOL\n");
    // It names what only its heads take in.
    folder.write(
        "lib/axis.g7",
        "chart Axis {\n  initial step 0\n  step 1 { N V }\n  0 -> 1 when go\n  1 -> 0 when not go\n}\n",
    );
    let cell = "use 'io.g7'\nuse 'lib/axis.g7'\n\nchart Cell {\n  initial step 0\n  0 -> 0 when ↑go\n}\n";
    folder.write("cell.g7", cell);
    folder
        .write("cell.io.toml", "[devices.d]\nkind = 'modbus-tcp'\nhost = 'd'\n[inputs]\ngo = 'd.coil(0)'\n");
    folder.write("tests/axis.g7", "use '../io.g7'\nuse '../lib/axis.g7'\n\nvar late : BOOL\n\ntest \"goes\" {\n  set go := TRUE\n  scan\n  expect V\n}\n");
    folder.write("other.g7", "input go : BOOL\nchart Other { initial step 0 }\n");
    let mut editor = Editor::open(&uri("cell.g7"), &cell.replace("↑go", "↑ go"));
    let mut rename = |name: &str, line: u32, character: u32, to: &str| {
        let position = json!({ "line": line, "character": character });
        let params = json!({ "textDocument": { "uri": uri(name) }, "position": position, "newName": to });
        editor.answer("textDocument/rename", params)
    };
    let answer = rename("cell.g7", 5, 17, "start");
    let changes = answer["result"]["changes"].as_object().unwrap_or_else(|| panic!("{answer}"));
    let one = |name: &str, line: u32, from: u32, to: u32| {
        let edits = changes[&uri(name)].as_array().expect("edits");
        assert!(edits.iter().any(|e| e["range"] == range(line, from, to)), "{name}: {edits:?}");
        edits.len()
    };
    let counts = [
        one("cell.g7", 5, 16, 18),
        one("cell.io.toml", 4, 0, 2),
        one("io.g7", 0, 6, 8),
        one("lib/axis.g7", 3, 14, 16),
        one("tests/axis.g7", 6, 6, 8),
    ];
    assert_eq!((counts, changes.len()), ([1, 1, 1, 2, 1], 5), "{changes:?}");
    // A chart of another file, and a name that a file has which the first one does not know.
    let answer = rename("cell.g7", 5, 17, "late");
    assert!(answer["error"]["message"].as_str().is_some_and(|m| m.contains("`late`")), "{answer}");
    folder.write("tests/axis.g7", "use '../io.g7'\n\ntest {\n  set go :=\n");
    let answer = rename("cell.g7", 5, 17, "start");
    assert!(answer["error"]["message"].as_str().is_some_and(|m| m.contains("tests/axis.g7")), "{answer}");
}

#[test]
fn a_new_name_changes_nothing_outside_of_the_folder() {
    let folder = common::Folder::with("");
    let uri = |name: &str| format!("file://{}", folder.path(name).display());
    folder.write("io.g7", "input go : BOOL\n");
    // No project file: the folder of the chart is the limit.
    let text =
        "use '../io.g7'\nvar own : BOOL\nchart Cell {\n  initial step 0\n  0 -> 0 when go and own\n}\n";
    folder.write("cells/cell.g7", text);
    let mut editor = Editor::open(&uri("cells/cell.g7"), text);
    let mut rename = |character: u32| {
        let position = json!({ "line": 4, "character": character });
        let params = json!({ "textDocument": { "uri": uri("cells/cell.g7") }, "position": position, "newName": "start" });
        editor.answer("textDocument/rename", params)
    };
    assert!(rename(15)["error"].is_object(), "`go` is not known there");
    let changes = rename(22)["result"]["changes"].clone();
    assert_eq!(
        changes.as_object().map(|c| c.keys().cloned().collect()),
        Some(vec![uri("cells/cell.g7")]),
        "{changes}"
    );
}
