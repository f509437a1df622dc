//! The build ends where the runtime is wrong: a name that is not there, a form that the
//! printers do not have, a helper that one language lacks.

#[path = "../../build/read/mod.rs"]
mod read;

use g7_runtime::source::{ALL, File, Source};

/// The error of the build when a file reads otherwise.
fn said(change: impl FnOnce(&mut Source)) -> String {
    let mut source = ALL;
    change(&mut source);
    match read::runtime(&source) {
        Ok(_) => String::new(),
        Err(why) => why,
    }
}

fn changed(file: File, from: &str, to: &str) -> File {
    assert!(file.text.contains(from), "`{from}` in {}", file.path);
    File { path: file.path, text: file.text.replacen(from, to, 1).leak() }
}

/// The files with one of them changed.
fn with(files: &'static [File], path: &str, from: &str, to: &str) -> &'static [File] {
    let mut all = files.to_vec();
    let file = all.iter_mut().find(|f| f.path == path).expect("the file is there");
    *file = changed(*file, from, to);
    all.leak()
}

#[test]
fn the_runtime_can_be_read() {
    assert_eq!(said(|_| ()), "");
}

#[test]
fn a_function_that_is_not_there_ends_the_build() {
    let why = said(|s| {
        s.evolution = with(s.evolution, "src/cycle.rs", "    evolve(s);", "    evolves(s);");
    });
    assert!(why.contains("evolves"), "{why}");
    let why = said(|s| {
        let wrong = "    sections_in_front(s);";
        s.flat = with(s.flat, "src/flat/frame.rs", "    sections_before(s);", wrong);
    });
    assert!(why.contains("sections_in_front"), "the frame of equations as well: {why}");
    let why = said(|s| s.chart = changed(s.chart, "pub fn follow<S>", "pub fn follows<S>"));
    assert!(why.contains("\"follow\""), "{why}");
}

#[test]
fn a_fact_or_table_that_is_not_there_ends_the_build() {
    let why = said(|s| s.chart = changed(s.chart, "pub const HAS_EVENTS: bool = false;", ""));
    assert!(why.contains("`HAS_EVENTS`"), "{why}");
    let why = said(|s| s.chart = changed(s.chart, "pub static PERIOD: [i64; 0] = [];", ""));
    assert!(why.contains("`PERIOD`"), "{why}");
    let why = said(|s| s.chart = changed(s.chart, "pub const STEPS: usize", "pub const STEPS: bool"));
    assert!(why.contains("`STEPS`"), "a truth value is no length: {why}");
}

#[test]
fn what_nothing_uses_ends_the_build() {
    let more = "pub const HAS_EVENTS: bool = false;\npub const HAS_WINGS: bool = false;";
    let why = said(|s| s.chart = changed(s.chart, "pub const HAS_EVENTS: bool = false;", more));
    assert!(why.contains("HAS_WINGS"), "{why}");
}

#[test]
fn a_form_that_the_printers_lack_ends_the_build() {
    for (from, to) in [
        ("    pass(s);\n", "    match s.now {\n        _ => pass(s),\n    }\n"),
        ("    s.dt = 0;", "    let dt = 0;"),
        ("    s.dt = 0;", "    s.dt = i64::MAX;"),
        ("    s.dt = 0;", "    s.dt = (0..3).sum();"),
        ("    s.dt = 0;", "    s.dt =\n        // a note within a statement\n        0;"),
    ] {
        let why = said(|s| s.evolution = with(s.evolution, "src/evolution/scan.rs", from, to));
        assert!(why.contains("src/evolution/scan.rs"), "{to}: `{why}`");
    }
}

#[test]
fn only_what_is_listed_is_offered() {
    let why = said(|s| {
        s.evolution = with(s.evolution, "src/evolution/scan.rs", "pub(crate) fn pass(", "pub fn pass(");
    });
    assert!(why.contains("pass"), "{why}");
}

#[test]
fn a_helper_that_one_language_lacks_ends_the_build() {
    let why = said(|s| s.c = with(s.c, "c/text.h", "static void text_left(", "static void text_lefts("));
    assert!(why.contains("text_left"), "{why}");
    let why = said(|s| s.c = with(s.c, "c/helpers.c", "#define OF(op) op##_u16", "#define OF(op) op##_u17"));
    assert!(why.contains("add_u16"), "{why}");
    let why = said(|s| s.rust = with(s.rust, "src/numbers.rs", "pub fn since(", "pub fn sinces("));
    assert!(why.contains("since"), "{why}");
}
