//! Any text: problems, never a panic, in bounded time.

use std::time::{Duration, Instant};

use proptest::prelude::*;

use crate::sfc::import;

fn quickly(text: &str) {
    let start = Instant::now();
    let (document, _) = import(text);
    let _ = g7_compile::compile(&document);
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}

#[test]
fn brackets_and_blocks_without_end() {
    for (open, count) in
        [("(", 100_000), ("IF a THEN ", 50_000), ("NOT ", 50_000), ("a[", 50_000), ("(* ", 50_000)]
    {
        let all = open.repeat(count);
        quickly(&format!("PROGRAM p x := {all}"));
        quickly(&format!("PROGRAM p {all}"));
    }
    quickly(&"RESOURCE r ON PLC ".repeat(50_000));
    quickly(&format!("CONFIGURATION c {}", "RESOURCE r ON PLC ".repeat(50_000)));
}

#[test]
fn long_chains_and_lists() {
    quickly(&format!("PROGRAM p x := a{}; END_PROGRAM", " OR a".repeat(100_000)));
    quickly(&format!("PROGRAM p LD a\n{} END_PROGRAM", "AND a\n".repeat(50_000)));
    quickly(&format!("PROGRAM p {} END_PROGRAM", "LD a\nJMPC x\n".repeat(20_000)));
    quickly("PROGRAM p VAR a : ARRAY [1..1000, 1..1000, 1..1000] OF INT; END_VAR END_PROGRAM");
    for row in ["", "1", "1, 2"] {
        let rows = "[4000000000(".repeat(20);
        let ends = ")]".repeat(20);
        quickly(&format!(
            "PROGRAM p VAR a : ARRAY [1..2] OF INT := {rows}[{row}]{ends}; END_VAR END_PROGRAM"
        ));
    }
}

proptest! {
    #[test]
    fn any_words(words in prop::collection::vec(prop::sample::select(vec![
        "PROGRAM", "p", "VAR", "END_VAR", ":", ";", ":=", "BOOL", "(", ")", "STEP", "INITIAL_STEP", "END_STEP",
        "TRANSITION", "FROM", "TO", "END_TRANSITION", "ACTION", "END_ACTION", "IF", "THEN", "END_IF", "CASE", "OF",
        "LD", "ST", "JMP", "1", "..", "T#5s", "%IX0.0", "AT", ",", "[", "]", "ARRAY", "STRUCT", "TYPE", "'", "\n",
        "CONFIGURATION", "TASK", "RESOURCE", "END_PROGRAM", "FUNCTION", "INT", "N", "PRIORITY", "16#", "INT#",
        "END_FUNCTION", "VAR_IN_OUT", "VAR_OUTPUT", "VAR_INPUT", "VAR_EXTERNAL", "WHILE a DO", "END_WHILE", "ELSIF", "TIME()",
        "{ a; }", "f(p)", "f(p := 1)", "RETURN", "END_RESOURCE", "f : INT", "EN := TRUE", "INT (0..9)", "p.f",
    ]), 0..80)) {
        let text = words.join(" ");
        let (document, _) = import(&text);
        let _ = g7_compile::compile(&document);
    }

    #[test]
    fn any_text(text in "\\PC{0,200}") {
        let _ = import(&text);
        let _ = import(&format!("PROGRAM p {text}"));
    }
}
