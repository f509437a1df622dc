//! Every message gets an answer, whatever it contains.
#![allow(clippy::disallowed_methods, reason = "the tests read the examples")]

use crate::common;

use common::{Chance, example};
use g7_page::Page;
use serde_json::{Value, json};

const PUMP: &str = r#"<GCDocument name="Pump"><GCInitialStep id="1" name="S1" x="0" y="0"/></GCDocument>"#;

fn is_answer(text: &str) -> bool {
    serde_json::from_str::<Value>(text)
        .is_ok_and(|v| v.get("ok").is_some() || v.get("no").is_some_and(Value::is_string))
}

#[test]
fn what_is_no_message_is_refused_in_words() {
    let mut page = Page::new();
    let deep = "[".repeat(100_000);
    for text in ["", "{", "null", "[]", "{\"do\":\"fly\"}", "{\"do\":\"open\"}", "{\"do\":7}", "\u{0}", &deep]
    {
        let answer = page.call(text);
        assert!(answer.starts_with("{\"no\":\""), "{answer}");
        assert!(is_answer(&answer));
    }
}

/// One correct message of each kind.
fn messages(text: &str) -> Vec<Value> {
    let file = "a.g7";
    vec![
        json!({ "do": "open", "file": file, "text": text }),
        json!({ "do": "look", "file": file }),
        json!({ "do": "text", "file": file }),
        json!({ "do": "splice", "file": file, "splices": [{ "from": 3, "to": 9, "insert": "x" }] }),
        json!({ "do": "undo", "file": file }),
        json!({ "do": "redo", "file": file }),
        json!({ "do": "undo", "file": file }),
        json!({ "do": "edit", "file": file, "gesture": { "g": "next", "id": "Sorter/s/Start" } }),
        json!({ "do": "edit", "file": file, "gesture": { "g": "move", "ids": ["Sorter/s/Start"], "dx": 30, "dy": -7 } }),
        json!({ "do": "copy", "file": file, "ids": ["Sorter/s/Start", "Sorter/t/0"] }),
        json!({ "do": "drawing", "file": file, "chart": "Sorter", "look": "sfc", "pages": "pl7" }),
        json!({ "do": "tokens", "file": file, "from": 10, "to": 500 }),
        json!({ "do": "complete", "file": file, "at": 300 }),
        json!({ "do": "hover", "file": file, "at": 1700 }),
        json!({ "do": "references", "file": file, "at": 1740 }),
        json!({ "do": "search", "file": file, "text": "bead" }),
        json!({ "do": "symbols", "file": file }),
        json!({ "do": "format", "file": file }),
        json!({ "do": "style", "dark": true }),
        json!({ "do": "prove", "file": file, "states": 4, "mib": 1 }),
        json!({ "do": "run_start", "file": file, "run": "p", "plant": "none", "moves": [{ "wait_ns": 0, "set": [[0, "1"]] }] }),
        json!({ "do": "run_start", "file": file, "run": "r", "scan_ms": 20, "seed": 4 }),
        json!({ "do": "run_advance", "run": "r", "ms": 250, "times": true }),
        json!({ "do": "run_toggle", "run": "r", "signal": 17 }),
        json!({ "do": "run_set", "run": "r", "signal": 20, "value": "3" }),
        json!({ "do": "run_force", "run": "r", "signal": 3, "value": "TRUE" }),
        json!({ "do": "run_release", "run": "r", "signal": 3 }),
        json!({ "do": "run_pass", "run": "r" }),
        json!({ "do": "run_scan", "run": "r" }),
        json!({ "do": "run_breaks", "run": "r", "ids": ["Sorter/s/Start"] }),
        json!({ "do": "run_lanes", "run": "r", "signals": [0, 1, 2], "from_ms": 0, "to_ms": 300, "most": 10 }),
        json!({ "do": "run_export", "run": "r", "as": "vcd", "from_ms": 5, "to_ms": 100 }),
        json!({ "do": "run_seek", "run": "r", "ms": 90 }),
        json!({ "do": "run_live", "run": "r", "here": true }),
        json!({ "do": "run_frame", "run": "r", "full": true }),
        json!({ "do": "run_signals", "run": "r" }),
        json!({ "do": "run_swap", "run": "r", "file": file, "force": true }),
        json!({ "do": "run_restart", "run": "r" }),
        json!({ "do": "run_stop", "run": "r" }),
        json!({ "do": "close", "file": file }),
        json!({ "between": "import", "ask": { "do": "open", "file": "a.xml", "text": PUMP } }),
        json!({ "between": "imported", "file": "a.xml", "text": text, "told": [{ "code": "G0111", "what": "it ends" }] }),
        json!({ "between": "about", "files": [{ "file": file, "text": text }], "ask": { "do": "look", "file": file } }),
    ]
}

#[test]
fn every_message_is_answered() {
    let mut page = Page::new();
    for message in messages(&example("bead-sorter/chart.g7")) {
        let answer = page.call(&message.to_string());
        assert!(is_answer(&answer), "{message}");
        let refused: Value = serde_json::from_str(&answer).expect("JSON");
        assert!(refused.get("no").is_none(), "{message}: {refused}");
    }
}

#[test]
fn distorted_messages_do_no_harm() {
    let mut chance = Chance(99);
    let odd = [
        json!(null),
        json!(-1),
        json!(1e308),
        json!(u64::MAX),
        json!(""),
        json!("a.g7"),
        json!("Sorter/s/Start"),
        json!([]),
        json!({}),
        json!(true),
        json!("Sorter/t/99999999999999999999"),
        json!("%%%/s/%2"),
        json!(0.5),
    ];
    for round in 0..30 {
        let mut page = Page::new();
        for mut message in messages(&example("bead-sorter/chart.g7")) {
            if let Some(fields) = message.as_object_mut() {
                let keys: Vec<String> =
                    fields.keys().filter(|k| *k != "do" && *k != "between").cloned().collect();
                if !keys.is_empty() && chance.below(2) == 0 && fields.get("do") != Some(&json!("open")) {
                    fields.insert(chance.one(&keys).clone(), chance.one(&odd).clone());
                }
            }
            assert!(is_answer(&page.call(&message.to_string())), "{message} in round {round}");
        }
    }
}

#[test]
fn distorted_texts_do_no_harm() {
    let mut chance = Chance(17);
    let whole: Vec<char> = example("structure/enclosing.g7").chars().collect();
    for _ in 0..60 {
        let mut text = whole.clone();
        for _ in 0..6 {
            let at = chance.below(text.len());
            match chance.below(3) {
                0 => drop(text.drain(at..(at + chance.below(40)).min(whole.len().min(text.len())))),
                1 => {
                    text.insert(at, *chance.one(&['{', '}', '"', '\'', '`', '😀', '\n', '(', '.', '\u{305}']))
                }
                _ => text.swap(at, 0),
            }
        }
        let text: String = text.into_iter().collect();
        let units = text.encode_utf16().count();
        let mut page = Page::new();
        let file = "a.g7";
        let mut ask = |message: Value| assert!(is_answer(&page.call(&message.to_string())), "{message}");
        ask(json!({ "do": "open", "file": file, "text": text }));
        for _ in 0..12 {
            let at = chance.below(units + 2);
            ask(json!({ "do": "complete", "file": file, "at": at }));
            ask(json!({ "do": "hover", "file": file, "at": at }));
            ask(json!({ "do": "references", "file": file, "at": at }));
        }
        ask(json!({ "do": "tokens", "file": file }));
        ask(json!({ "do": "symbols", "file": file }));
        ask(json!({ "do": "drawing", "file": file, "chart": "Main" }));
        ask(json!({ "do": "format", "file": file }));
        ask(json!({ "do": "run_start", "file": file, "run": "r" }));
    }
}
