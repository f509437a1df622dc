//! Measures how long the user of the editor waits: a chart of 1000 steps is opened, drawn and
//! changed; and a frame of a run with 50 active steps.
#![allow(clippy::disallowed_methods, reason = "a stopwatch reads the clock")]

use std::fmt::Write;
use std::time::Instant;

use g7_page::Page;

const STEPS: usize = 1000;
const TOKENS: usize = 50;

fn main() {
    let mut page = Page::new();
    let text = chart();
    let open = format!("{{\"do\":\"open\",\"file\":\"a.g7\",\"text\":{text:?}}}");
    let messages = [
        ("open", open.as_str(), 10),
        ("drawing", r#"{"do":"drawing","file":"a.g7","chart":"Big"}"#, 10),
        ("a letter typed", r#"{"do":"splice","file":"a.g7","splices":[{"from":0,"to":0,"insert":" "}]}"#, 10),
        ("undo", r#"{"do":"undo","file":"a.g7"}"#, 10),
        ("next step", r#"{"do":"edit","file":"a.g7","gesture":{"g":"next","id":"Big/s/7"}}"#, 10),
        ("colours", r#"{"do":"tokens","file":"a.g7"}"#, 10),
        ("run_start", r#"{"do":"run_start","file":"a.g7","run":"r"}"#, 10),
        ("a scan, frame", r#"{"do":"run_advance","run":"r","ms":10}"#, 500),
        ("frame with times", r#"{"do":"run_frame","run":"r","times":true}"#, 500),
        ("seek", r#"{"do":"run_seek","run":"r","ms":2345}"#, 50),
    ];
    println!("{:<18}{:>10}{:>12}", "ms", "median", "answer, kB");
    for (name, message, times) in messages {
        let mut took = Vec::new();
        let mut size = 0;
        for _ in 0..times {
            let begin = Instant::now();
            let answer = page.call(message);
            took.push(begin.elapsed().as_secs_f64() * 1e3);
            assert!(answer.starts_with("{\"ok\""), "{name}: {answer}");
            size = answer.len();
        }
        took.sort_by(f64::total_cmp);
        println!("{name:<18}{:>10.3}{:>12.1}", took[took.len() / 2], size as f64 / 1e3);
    }
}

/// Rings in which one token each moves in every scan.
fn chart() -> String {
    let mut text = String::from("profile iec61131\ninput a : BOOL\noutput q : BOOL\nchart Big {\n");
    let length = STEPS / TOKENS;
    for k in 0..STEPS {
        let initial = if k % length == 0 { "initial " } else { "" };
        writeln!(text, "  {initial}step {k} {{ N q }}").expect("a text");
    }
    for k in 0..STEPS {
        let next = if (k + 1) % length == 0 { k + 1 - length } else { k + 1 };
        writeln!(text, "  {k} -> {next} when not a").expect("a text");
    }
    text.push_str("}\n");
    text
}
