//! `g7 lsp` as an editor sees it: messages of the Language Server Protocol in and out.
#![allow(clippy::disallowed_methods, reason = "tests start programs and look at the clock")]

use crate::common;
mod editor;
mod helix;
mod projects;

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};

use editor::{Editor, URI, range};
use serde_json::{Value, json};
use snapbox::cmd::cargo_bin;
use tungstenite::client::IntoClientRequest;

const TEXT: &str = "input go : BOOL
output V : BOOL

// One.
// Two.
chart Main \"the machine\" {
  initial step 0
  step 1 { N V }
  0 -> 1 when go
  1 -> 0 when not go
}

test \"it starts\" {
  set go := TRUE
  wait 1s
  expect V
}
";

#[test]
fn problems_are_told_as_the_text_changes_and_taken_back_when_it_is_closed() {
    let mut editor = Editor::with(TEXT);
    let told = editor.problems();
    assert_eq!((&told["uri"], &told["version"], &told["diagnostics"]), (&json!(URI), &json!(1), &json!([])));
    editor.type_at(2, 8, 14, 16, "göh");
    let told = editor.problems();
    let first = &told["diagnostics"][0];
    assert_eq!(
        (&told["version"], &first["code"], &first["source"]),
        (&json!(2), &json!("G0202"), &json!("g7"))
    );
    assert_eq!((&first["range"], &first["severity"]), (&range(8, 14, 17), &json!(1)));
    editor.type_at(3, 8, 14, 17, "go");
    assert_eq!(editor.problems()["diagnostics"], json!([]));
    editor.type_at(4, 6, 10, 14, "stop");
    assert_ne!(editor.problems()["diagnostics"], json!([]), "a syntax error");
    editor.tell("textDocument/didClose", json!({ "textDocument": { "uri": URI } }));
    assert_eq!(editor.problems()["diagnostics"], json!([]));
}

#[test]
fn columns_are_counted_in_code_units() {
    let mut editor = Editor::with("chart Main {\n  initial step 0 \"😀\" { N nothing }\n}\n");
    let told = editor.problems();
    let found = told["diagnostics"].as_array().expect("a list");
    let unknown = found.iter().find(|d| d["code"] == "G0202").expect("the unknown name");
    assert_eq!(unknown["range"], range(1, 26, 33), "the sign is two units");
}

#[test]
fn names_are_found_explained_and_changed_everywhere() {
    let mut editor = Editor::with(TEXT);
    let declared = editor.at("textDocument/definition", 8, 15);
    assert_eq!(declared["range"], range(0, 6, 8));
    let uses = editor.at("textDocument/references", 0, 7);
    let lines: Vec<_> =
        uses.as_array().expect("a list").iter().map(|u| u["range"]["start"]["line"].clone()).collect();
    assert_eq!(lines, [0, 8, 9, 13]);
    let hover = editor.at("textDocument/hover", 8, 15);
    let said = hover["contents"]["value"].as_str().expect("a text");
    assert!(said.contains("input go : BOOL"), "{said}");
    assert_eq!(editor.at("textDocument/prepareRename", 8, 15)["placeholder"], "go");
    let rename = |editor: &mut Editor, to: &str| {
        let params = json!({
            "textDocument": { "uri": URI }, "position": { "line": 8, "character": 15 }, "newName": to,
        });
        editor.answer("textDocument/rename", params)
    };
    let edits = rename(&mut editor, "start")["result"]["changes"][URI].clone();
    let edits = edits.as_array().expect("changes");
    assert_eq!(edits.len(), 4);
    assert!(edits.iter().all(|e| e["newText"] == "start"), "{edits:?}");
    let refused = rename(&mut editor, "V");
    assert!(refused["error"]["message"].as_str().is_some_and(|m| m.contains("`V`")), "{refused}");
}

#[test]
fn a_name_is_changed_beside_a_syntax_error_but_not_where_that_may_hold_it() {
    let rename = |text: &str, locale: &str| {
        let mut editor = Editor::speaking(Some(locale)).opened(URI, text);
        let at = json!({ "line": 0, "character": 7 });
        assert_eq!(editor.at("textDocument/prepareRename", 0, 7)["placeholder"], "go");
        let params = json!({ "textDocument": { "uri": URI }, "position": at, "newName": "start" });
        editor.answer("textDocument/rename", params)
    };
    let broken = TEXT.replacen("expect V", "expect V and", 1);
    let edits = rename(&broken, "en")["result"]["changes"][URI].clone();
    assert_eq!(edits.as_array().map(Vec::len), Some(4), "{edits}");
    let broken = TEXT.replacen("expect V", "expect V what go", 1);
    for (locale, words) in [
        ("en", "line 16 may name `go`"),
        ("fr", "la ligne 16 peut nommer `go`"),
        ("pt", "a linha 16 pode nomear `go`"),
    ] {
        let refused = rename(&broken, locale)["error"]["message"].clone();
        assert!(refused.as_str().is_some_and(|m| m.starts_with(words)), "{locale}: {refused}");
    }
}

#[test]
fn a_word_and_a_sign_are_explained_by_their_rule_and_its_case() {
    let mut editor = Editor::with(TEXT);
    let mut hover = |line, character| {
        let told = editor.at("textDocument/hover", line, character);
        told["contents"]["value"].as_str().unwrap_or_default().to_owned()
    };
    let arrow = hover(8, 5);
    assert!(arrow.starts_with("transition from `0` to `1`"), "{arrow}");
    assert!(arrow.contains("IEC 60848:2013, 4.5 evolution rule 2"), "{arrow}");
    assert!(arrow.contains("```g7\ninput a, b : BOOL\nchart G {"), "{arrow}");
    let qualifier = hover(7, 11);
    assert!(qualifier.contains("while the step is active"), "{qualifier}");
    assert!(qualifier.contains("2.6.4.4, table 45 (N)"), "{qualifier}");
    assert!(hover(6, 4).contains("**The initial situation.** At the start every initial step"));
    let text = TEXT
        .replace("0 -> 1 when go", "0 -> (1, 2) when ↑go")
        .replace("step 1 {", "step 2\n  step 1 {")
        .replace("1 -> 0", "(1, 2) -> 0");
    let mut editor = Editor::with(&text);
    let mut hover = |line, character| {
        let told = editor.at("textDocument/hover", line, character);
        told["contents"]["value"].as_str().unwrap_or_default().to_owned()
    };
    let fork = hover(9, 5);
    assert!(fork.starts_with("transition that forks from `0` to `1`, `2`"), "{fork}");
    assert!(fork.contains("**A fork activates all its branches.**"), "{fork}");
    let edge = hover(9, 19);
    assert!(edge.starts_with("**rise**: a rising edge"), "{edge}");
    assert!(edge.contains("**An event mixed with a condition.**"), "{edge}");
    let mut editor = Editor::with(&TEXT.replace("not go", "not gone"));
    let told = editor.at("textDocument/hover", 9, 19);
    let problem = told["contents"]["value"].as_str().unwrap_or_default();
    assert!(
        problem.starts_with("**G0202**") && problem.ends_with("Rule: IEC 61131-3:2003, 2.4."),
        "{problem}"
    );
}

#[test]
fn a_new_name_goes_into_the_io_files_of_the_chart() {
    let folder = common::Folder::with(TEXT);
    let io = "[devices.d]\nkind = 'modbus-tcp'\nhost = 'ö'\n[inputs]\n'go' = 'd.coil(0)'\n\
        [outputs]\nV = 'd.coil(1)'\n[shown]\nX1 = 'd.coil(2)'\n";
    folder.write("chart.io.toml", io);
    folder.write("line 2.io.toml", io);
    let uri = |name: &str| format!("file://{}", folder.path(name).display());
    let mut editor = Editor::open(&uri("chart.g7"), TEXT);
    let mut rename = |line: u32, character: u32, to: &str| {
        let params = json!({
            "textDocument": { "uri": uri("chart.g7") }, "position": { "line": line, "character": character },
            "newName": to,
        });
        editor.answer("textDocument/rename", params)["result"]["changes"].clone()
    };
    let changes = rename(8, 15, "start");
    assert_eq!(changes[uri("chart.g7")].as_array().map(Vec::len), Some(4));
    let edit = json!([{ "range": range(4, 0, 4), "newText": "'start'" }]);
    assert_eq!(changes[uri("chart.io.toml")], edit);
    assert_eq!(changes[uri("line%202.io.toml")], edit, "the only chart of the folder");
    assert_eq!(
        rename(7, 7, "9")[uri("chart.io.toml")],
        json!([{ "range": range(8, 0, 2), "newText": "X9" }])
    );
    // With another chart beside it, an io file of another name may be that one's.
    folder.write("other.g7", TEXT);
    let changes = rename(1, 7, "valve");
    assert_eq!(changes[uri("chart.io.toml")], json!([{ "range": range(6, 0, 1), "newText": "valve" }]));
    assert_eq!(changes.as_object().map(serde_json::Map::len), Some(2), "{changes}");
    // Where the chart has errors, nobody knows what the names of an io file mean.
    let mut editor = Editor::open(&uri("chart.g7"), &TEXT.replace("not go", "not go and gone"));
    let params = json!({
        "textDocument": { "uri": uri("chart.g7") }, "position": { "line": 8, "character": 15 }, "newName": "start",
    });
    let refused = editor.answer("textDocument/rename", params);
    assert!(refused["error"]["message"].as_str().is_some_and(|m| m.contains("chart.io.toml")), "{refused}");
}

#[test]
fn names_lead_into_the_files_that_are_used() {
    let folder = common::Folder::with("");
    let uri = |name: &str| format!("file://{}", folder.path(name).display());
    folder.write("lib/io.g7", "input go : BOOL\noutput V : BOOL\n");
    let text = "use 'lib/io.g7'\nuse debounce\n\nchart Main {\n  initial step 0\n  step 1 { N V }\n  0 -> 1 when go\n  1 -> 0 when not go\n}\n\nvar d : Debounce\n\npre {\n  d(raw := go)\n}\n";
    let mut editor = Editor::open(&uri("chart.g7"), text);
    assert_eq!(editor.problems()["diagnostics"], json!([]));
    let at = |editor: &mut Editor, method: &str, line: u32, character: u32| {
        let place = json!({
            "textDocument": { "uri": uri("chart.g7") }, "position": { "line": line, "character": character },
        });
        editor.ask(method, place)
    };
    let declared = at(&mut editor, "textDocument/definition", 6, 15);
    assert_eq!((&declared["uri"], &declared["range"]), (&json!(uri("lib/io.g7")), &range(0, 6, 8)));
    assert_eq!(at(&mut editor, "textDocument/definition", 10, 10), json!(null), "the library is no file");
    let hover = at(&mut editor, "textDocument/hover", 6, 15);
    assert!(hover["contents"]["value"].as_str().is_some_and(|t| t.contains("input go : BOOL")), "{hover}");
    let rename = json!({
        "textDocument": { "uri": uri("chart.g7") }, "position": { "line": 10, "character": 10 }, "newName": "x",
    });
    let refused = editor.answer("textDocument/rename", rename);
    let places = "library/debounce.g7";
    assert!(refused["error"]["message"].as_str().is_some_and(|m| m.contains(places)), "{refused}");
    let choices = at(&mut editor, "textDocument/completion", 1, 4);
    assert!(choices.to_string().contains("two_hand"), "{choices}");
    // The text of another file counts as the editor has it, saved or not.
    let mut editor = editor.opened(&uri("lib/io.g7"), "input og : BOOL\noutput V : BOOL\n");
    let told = [editor.problems(), editor.problems()];
    let of_head = told.iter().find(|t| t["uri"] == uri("chart.g7")).expect("the head is told anew");
    assert_eq!(of_head["diagnostics"][0]["code"], "G0202", "{of_head}");
    editor.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri("lib/io.g7") } }));
    let told = [editor.problems(), editor.problems()];
    let of_head = told.iter().find(|t| t["uri"] == uri("chart.g7")).expect("the head is told anew");
    assert_eq!(of_head["diagnostics"], json!([]), "the disk counts again");
    folder.write("lib/io.g7", "input og : BOOL\noutput V : BOOL\n");
    editor.tell("textDocument/didSave", json!({ "textDocument": { "uri": uri("chart.g7") } }));
    assert_eq!(editor.problems()["diagnostics"][0]["code"], "G0202", "saving looks at the disk");
}

/// A server of the page that ends with the test.
struct Served(Child);

impl Drop for Served {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

#[test]
fn the_values_of_a_running_chart_stand_beside_its_names() {
    let folder = common::Folder::with(TEXT);
    let mut command = Command::new(cargo_bin!("g7"));
    command.args(["serve", "--no-open", "--port", "0"]).current_dir(folder.root());
    command.env("XDG_STATE_HOME", folder.path(".state"));
    let mut served = Served(command.stdout(Stdio::piped()).spawn().expect("g7 serve"));
    let mut address = String::new();
    BufReader::new(served.0.stdout.take().expect("its output")).read_line(&mut address).expect("an address");
    let address = address.trim();
    let (host, token) = address.trim_start_matches("http://").split_once("/?token=").expect("a token");
    let mut request =
        IntoClientRequest::into_client_request(format!("ws://{host}/api/live")).expect("an address");
    request.headers_mut().insert("Authorization", format!("Bearer {token}").parse().expect("a token"));
    let stream = std::net::TcpStream::connect(host).expect("the server");
    let (mut page, _) = tungstenite::client(request, stream).expect("a connection");
    let mut call = |id: u64, call: Value| {
        page.send(json!({ "id": id, "call": call }).to_string().into()).expect("sent");
        loop {
            let text = page.read().expect("an answer").into_text().expect("a text");
            // A ping has no text.
            let Ok(told) = serde_json::from_str::<Value>(&text) else { continue };
            if told["id"] == id {
                return told["answer"].clone();
            }
        }
    };
    let begun = call(1, json!({ "do": "run_start", "run": "chart.g7", "file": "chart.g7" }));
    let signals = begun["ok"]["signals"].as_array().unwrap_or_else(|| panic!("{begun}"));
    let go = signals.iter().position(|s| s["name"] == "go").expect("the input");

    let uri = format!("file://{}", folder.path("chart.g7").display());
    let mut editor = Editor::open(&uri, TEXT);
    let whole = json!({
        "textDocument": { "uri": uri },
        "range": { "start": { "line": 0, "character": 0 }, "end": { "line": 99, "character": 0 } },
    });
    assert_eq!(editor.ask("textDocument/inlayHint", whole.clone()), Value::Null, "nothing is followed");
    let follow = |address: &str| json!({ "command": "g7.follow", "arguments": [address] });
    let refused = editor.answer("workspace/executeCommand", follow("http://10.1.2.3:4700/?token=abc"));
    assert!(refused["error"]["message"].as_str().is_some_and(|m| m.contains("another machine")), "{refused}");
    editor.ask("workspace/executeCommand", follow(address));
    // Each refresh of the server is followed by a look, as an editor does it.
    let shown = |editor: &mut Editor, wanted: &[&str]| {
        loop {
            let hints = editor.ask("textDocument/inlayHint", whole.clone());
            let told = |hint: &Value| {
                let at = &hint["position"];
                format!("{}:{} {}", at["line"], at["character"], hint["label"].as_str().unwrap_or_default())
            };
            let hints: Vec<String> = hints.as_array().into_iter().flatten().map(told).collect();
            if hints == wanted {
                return;
            }
            while editor.read()["method"] != "workspace/inlayHint/refresh" {}
        }
    };
    let off = ["0:8 = FALSE", "1:8 = FALSE", "6:16 active 0.0s", "8:16 = FALSE", "9:20 = FALSE"];
    shown(&mut editor, &off);
    call(2, json!({ "do": "run_set", "run": "chart.g7", "signal": go, "value": "TRUE" }));
    call(3, json!({ "do": "run_scan", "run": "chart.g7" }));
    let on = ["0:8 = TRUE", "1:8 = TRUE", "7:8 active 0.0s", "8:16 = TRUE", "9:20 = TRUE"];
    shown(&mut editor, &on);
    editor.ask("workspace/executeCommand", follow(""));
    assert_eq!(editor.ask("textDocument/inlayHint", whole.clone()), Value::Null, "no longer followed");
    assert_eq!(editor.ask("shutdown", Value::Null), Value::Null);
    editor.tell("exit", Value::Null);
    assert!(editor.server.wait().expect("it ends").success());
}

#[test]
fn the_libraries_of_vs_code_see_a_problem_while_its_line_is_typed() {
    let Some(mut client) = g7_peers::node("vscode-languageserver-protocol", "lsp_client.cjs") else { return };
    let text = TEXT.replace("0 -> 1 when go", "0->1  when ");
    let at = |line: u32, character: u32| json!({ "line": line, "character": character });
    let steps = json!([
        { "do": "complete", "at": at(8, 13) },
        { "do": "type", "at": at(8, 13), "characters": "gox" },
        { "do": "erase", "range": range(8, 15, 16) },
        { "do": "hover", "at": at(8, 4) },
        { "do": "rename", "at": at(8, 14), "to": "start" },
        { "do": "format" },
    ]);
    let asked = json!({ "g7": cargo_bin!("g7"), "uri": URI, "text": text, "steps": steps });
    let mut ran = client
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("node runs");
    ran.stdin.take().expect("its input").write_all(asked.to_string().as_bytes()).expect("sent");
    let ran = ran.wait_with_output().expect("an end");
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let told: Value = serde_json::from_slice(&ran.stdout).expect("JSON");
    assert_eq!((&told["name"], &told["code"]), (&json!("g7"), &json!(0)));
    let [opened, completed, typed, erased, hover, renamed, formatted] =
        &told["answers"].as_array().expect("answers")[..]
    else {
        panic!("{told}")
    };
    assert_eq!(opened, &json!(["G0004"]), "the receptivity is missing");
    assert!(completed.as_array().is_some_and(|words| words.contains(&json!("go"))), "{completed}");
    assert_eq!(typed, &json!([["G0202 8:13"], [], ["G0202 8:13"]]));
    assert_eq!(erased, &json!([]));
    assert!(hover.as_str().is_some_and(|said| said.contains("evolution rule 2")), "{hover}");
    assert_eq!(renamed[URI].as_array().map(Vec::len), Some(4));
    assert_eq!(formatted.as_array().map(Vec::len), Some(1), "{formatted}");
}

#[test]
fn a_misspelt_name_has_a_fix() {
    let mut editor = Editor::with(&TEXT.replace("initial step", "intial step"));
    let params = json!({
        "textDocument": { "uri": URI }, "range": range(6, 2, 8), "context": { "diagnostics": [] },
    });
    let fixes = editor.ask("textDocument/codeAction", params);
    assert_eq!(fixes[0]["title"], "write `initial`");
    assert_eq!(fixes[0]["edit"]["changes"][URI], json!([{ "range": range(6, 2, 8), "newText": "initial" }]));
}

#[test]
fn the_structure_of_a_text_is_told() {
    let mut editor = Editor::with(TEXT);
    let only = json!({ "textDocument": { "uri": URI } });
    let outline = editor.ask("textDocument/documentSymbol", only.clone());
    let names: Vec<_> = outline.as_array().expect("a list").iter().map(|s| s["name"].clone()).collect();
    assert_eq!(names, ["go", "V", "Main", "it starts"]);
    let steps: Vec<_> =
        outline[2]["children"].as_array().expect("steps").iter().map(|s| s["name"].clone()).collect();
    assert_eq!(steps, ["0", "1"]);
    let folds = editor.ask("textDocument/foldingRange", only.clone());
    let lines: Vec<_> = folds
        .as_array()
        .expect("a list")
        .iter()
        .map(|f| (f["startLine"].clone(), f["endLine"].clone()))
        .collect();
    assert_eq!(lines, [(json!(3), json!(4)), (json!(5), json!(10)), (json!(12), json!(16))]);
    let lenses = editor.ask("textDocument/codeLens", only.clone());
    let commands: Vec<_> =
        lenses.as_array().expect("a list").iter().map(|l| l["command"]["command"].clone()).collect();
    assert_eq!(commands, ["g7.run", "g7.draw", "g7.test"]);
    let tokens = editor.ask("textDocument/semanticTokens/full", only);
    let data = tokens["data"].as_array().expect("numbers");
    // `input` is a keyword of five letters, and `go` a variable behind it.
    assert_eq!(data[..10], [0, 0, 5, 0, 0, 0, 6, 2, 3, 0].map(|n| json!(n)));
    let words = editor.at("textDocument/completion", 8, 16);
    let labels: Vec<_> = words.as_array().expect("a list").iter().map(|w| w["label"].clone()).collect();
    assert!(labels.contains(&json!("go")), "{labels:?}");
}

#[test]
fn a_text_is_formatted() {
    let mut editor = Editor::with(&TEXT.replace("  0 -> 1 when go", " 0->1   when go"));
    let params = json!({ "textDocument": { "uri": URI }, "options": { "tabSize": 2, "insertSpaces": true } });
    let edits = editor.ask("textDocument/formatting", params);
    let lines: Vec<&str> = TEXT.lines().collect();
    let edit = &edits[0];
    let start = edit["range"]["start"]["character"].as_u64().expect("a column") as usize;
    let end = edit["range"]["end"]["character"].as_u64().expect("a column") as usize;
    let old = " 0->1   when go";
    let new = format!("{}{}{}", &old[..start], edit["newText"].as_str().expect("a text"), &old[end..]);
    assert_eq!((edits.as_array().map(Vec::len), new.as_str()), (Some(1), lines[8]));
}

#[test]
fn what_means_nothing_is_answered_and_the_server_goes_on() {
    let mut editor = Editor::with(TEXT);
    assert_eq!(editor.answer("textDocument/nothing", json!({}))["error"]["code"], -32601);
    assert_eq!(editor.answer("textDocument/hover", json!({ "at": 3 }))["error"]["code"], -32602);
    editor.tell("textDocument/didChange", json!({ "textDocument": 7 }));
    editor.tell("nothing/known", json!([1, 2]));
    let far = json!({ "textDocument": { "uri": URI }, "position": { "line": 4_000_000, "character": 9 } });
    assert_eq!(editor.ask("textDocument/hover", far), Value::Null);
    let other =
        json!({ "textDocument": { "uri": "file:///other.g7" }, "position": { "line": 0, "character": 0 } });
    assert_eq!(editor.ask("textDocument/hover", other), Value::Null);
    assert_eq!(editor.ask("shutdown", Value::Null), Value::Null);
    editor.tell("exit", Value::Null);
    assert!(editor.server.wait().expect("it ends").success());
}

/// Opens a chart in Neovim, types a name that does not exist, and prints the problems of the buffer
/// before and after.
const NEOVIM: &str = r#"
local id = vim.lsp.start_client({ name = 'g7', cmd = { vim.env.G7, 'lsp' } })
vim.cmd('edit chart.g7')
vim.lsp.buf_attach_client(0, id)
local function codes()
  local list = {}
  for _, d in ipairs(vim.diagnostic.get(0)) do
    table.insert(list, string.format('%s %d:%d', d.code or d.user_data.lsp.code, d.lnum, d.col))
  end
  return table.concat(list, ' ')
end
vim.wait(20000, function() return vim.lsp.get_client_by_id(id).initialized == true end)
vim.api.nvim_win_set_cursor(0, { 9, 14 })
vim.api.nvim_feedkeys('cwgone', 'x', false)
vim.wait(20000, function() return codes() ~= '' end)
io.stdout:write('typed: ' .. codes() .. '\n')
vim.api.nvim_feedkeys('u', 'x', false)
vim.wait(20000, function() return codes() == '' end)
io.stdout:write('undone: ' .. codes() .. '\n')
vim.cmd('qall!')
"#;

/// The output of a Neovim script that runs beside the chart, and its errors; none if there is no Neovim.
fn neovim(script: &str) -> Option<(String, String)> {
    if !g7_peers::tool("nvim") {
        return None;
    }
    let folder = common::Folder::with(TEXT);
    folder.write("try.lua", script);
    let files = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../editors/vim");
    let ran = Command::new("nvim")
        .args(["--headless", "-u", "NONE", "-i", "NONE", "-n", "-c", "luafile try.lua"])
        .current_dir(folder.path(""))
        .env("G7", cargo_bin!("g7"))
        .env("VIM_FILES", files)
        .env("HOME", folder.path(""))
        .stdin(Stdio::null())
        .output()
        .expect("nvim runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).replace('\r', "");
    Some((text(&ran.stdout), text(&ran.stderr)))
}

#[test]
fn neovim_shows_a_problem_while_its_line_is_typed() {
    let Some((said, errors)) = neovim(NEOVIM) else { return };
    assert_eq!(said, "typed: G0202 8:14\nundone: \n", "{errors}");
}

/// The files of `editors/vim` as a plugin: they find the type of the file and start the server by themselves.
const PLUGIN: &str = r#"
vim.opt.runtimepath:prepend(vim.env.VIM_FILES)
vim.g.g7_program = vim.env.G7
vim.cmd('filetype plugin on')
vim.cmd('syntax on')
vim.cmd('edit chart.g7')
local function attached() return vim.lsp.buf_get_clients(0) end
vim.wait(20000, function()
  for _, client in pairs(attached()) do
    if client.initialized then return true end
  end
  return false
end)
vim.api.nvim_win_set_cursor(0, { 9, 14 })
vim.api.nvim_feedkeys('cwgone', 'x', false)
vim.wait(20000, function() return #vim.diagnostic.get(0) > 0 end)
local names = {}
for _, client in pairs(attached()) do table.insert(names, client.name) end
io.stdout:write(vim.bo.filetype .. ' ' .. vim.b.current_syntax .. ' ' .. table.concat(names, ' ') .. '\n')
io.stdout:write(#vim.diagnostic.get(0) .. ' problem\n')
io.stdout:write(tostring(vim.lsp.commands['g7.test'] ~= nil) .. '\n')
vim.cmd('qall!')
"#;

#[test]
fn the_files_for_vim_start_the_server_in_neovim() {
    let Some((said, errors)) = neovim(PLUGIN) else { return };
    assert_eq!(said, "g7 g7 g7\n1 problem\ntrue\n", "{errors}");
}

#[test]
fn problems_are_told_in_the_language_of_the_editor() {
    let broken = TEXT.replacen("when go", "when gone", 1);
    assert_ne!(broken, TEXT);
    for (locale, word) in [
        (Some("fr"), "rien ne s’appelle"),
        (Some("pt-PT"), "nada se chama"),
        (Some("nl"), "nothing is called"),
    ] {
        let mut editor = Editor::speaking(locale).opened(URI, &broken);
        let told = editor.problems().to_string();
        assert!(told.contains(word), "{locale:?}: {told}");
    }
}

#[test]
fn kinds_of_parts_and_refused_names_are_told_in_the_language_of_the_editor() {
    let text = TEXT.replacen("chart Main", "action Fill { V := TRUE }\nchart Main", 1);
    let line = text.lines().position(|l| l.starts_with("action")).expect("the action");
    let arrow = text.lines().position(|l| l.starts_with("  0 -> 1")).expect("the transition");
    for (locale, kind, shape, refused) in [
        (None, "action `Fill`", "transition from `0` to `1`", "there is a variable `V` already"),
        (Some("fr"), "action `Fill`", "transition de `0` vers `1`", "il y a déjà une variable `V`"),
        (Some("pt"), "ação `Fill`", "transição de `0` para `1`", "já há uma variável `V`"),
    ] {
        let mut editor = Editor::speaking(locale).opened(URI, &text);
        let said = editor.at("textDocument/hover", line as u32, 8)["contents"]["value"].to_string();
        assert!(said.contains(kind), "{locale:?}: {said}");
        let said = editor.at("textDocument/hover", arrow as u32, 5)["contents"]["value"].to_string();
        assert!(said.contains(shape), "{locale:?}: {said}");
        let params = json!({ "textDocument": { "uri": URI }, "position": { "line": 0, "character": 6 }, "newName": "V" });
        let told = editor.answer("textDocument/rename", params).to_string();
        assert!(told.contains(refused), "{locale:?}: {told}");
    }
}
