//! Printed code for PLCs can be read by an engineer: memories are named by their signals, AND beside OR
//! has brackets, a list of memories is written once, and the head of the block tells the bound of passes.
//! That the code does what the engine does is tested in
//! `tests/tests/foreign/plc.rs` and `tests/tests/foreign/readback.rs`.

use g7_codegen::plc::{Form, ascii, print};
use g7_compile::compile;
use g7_model::FileId;

fn st(text: &str) -> String {
    printed(text, Form::St)
}

fn printed(text: &str, form: Form) -> String {
    let (doc, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let (compiled, problems) = compile(&doc);
    let compiled = compiled.unwrap_or_else(|| panic!("{problems:?}"));
    print(&compiled, form, "tank", text).unwrap_or_else(|p| panic!("{p:?}")).text
}

#[test]
fn edges_and_delays_are_named_by_what_they_watch() {
    let text = st("profile iec61131\ninput start : BOOL\ninput full : BOOL\ninput re_start : BOOL\n\
                   chart G {\n  initial step 1\n  step 2\n  step 3\n  1 -> 2 when ↑start\n  \
                   2 -> 3 when 5s/full or re_start\n  3 -> 1 when ↑(start and not full) or ↓X2\n}\n");
    for want in [
        "T_1_to_2 := X_1 AND RE_start_2;",
        "T_2_to_3 := X_2 AND (TM_full OR re_start);",
        "RE_start_and_not_full OR FE_X_2",
    ] {
        assert!(text.contains(want), "no `{want}` in\n{text}");
    }
}

/// Scans are counted in a LINT, and `wait` is an INT: the standard compares equal types.
#[test]
fn words_of_two_types_are_compared_as_one() {
    let text =
        st("profile iec61131 { scan-clock }\nvar wait : INT := 5\nchart G {\n  initial step 1\n  step 2\n  \
                   1 -> 2 when X1.t >= wait\n  2 -> 1 when X2.t >= 3\n}\n");
    assert!(text.contains(", 32767) >= INT_TO_LINT(wait)"), "{text}");
    assert!(text.contains(", 32767) >= 3"), "{text}");
}

#[test]
fn and_within_or_has_brackets() {
    let text = st("profile iec61131\ninput a : BOOL\ninput b : BOOL\ninput c : BOOL\nchart G {\n  \
                   initial step 1\n  step 2\n  1 -> 2 when a and b or c\n  2 -> 1 when not a\n}\n");
    assert!(text.contains("T_1_to_2 := X_1 AND ((a AND b) OR c);"), "{text}");
}

#[test]
fn a_list_that_several_outputs_read_is_written_once() {
    let text = st("profile iec61131\ninput a : BOOL\noutput p : BOOL\noutput q : BOOL\nchart G {\n  \
                   initial step 1 { N p; N q if a }\n  step 2 { N p; N q if a }\n  \
                   step 3 { N p; N q if a }\n  step 4\n  1 -> 2 when a\n  2 -> 3 when not a\n  \
                   3 -> 4 when a\n  4 -> 1 when not a\n}\n");
    assert_eq!(text.matches("X_1 OR X_2 OR X_3").count(), 1, "{text}");
}

#[test]
fn the_bound_of_passes_follows_the_chart_and_is_told() {
    let ring = |n: usize| {
        let mut text = String::from("profile iec60848\ninput a : BOOL\nchart G {\n  initial step 0\n");
        for i in 1..n {
            text += &format!("  step {i}\n  {} -> {i} when a\n", i - 1);
        }
        st(&format!("{text}  {} -> 0 when not a\n}}\n", n - 1))
    };
    for (steps, bound) in [(2, 100), (50, 200), (300, 1000)] {
        let text = ring(steps);
        let head = format!("(* A scan makes passes until nothing changes, at most {bound};");
        assert!(text.starts_with(&head), "no `{head}` in\n{text}");
        assert!(text.contains(&format!("PASSES >= {bound}")), "{text}");
    }
}

#[test]
fn comments_can_be_ascii() {
    let text = st("profile iec61131\ninput a : BOOL \"démarrage\"\nchart G {\n  initial step 1\n  \
                   step 2\n  1 -> 2 when ↑a\n  2 -> 1 when not a\n}\n");
    assert!(!text.is_ascii(), "{text}");
    let text = ascii(&text);
    assert!(text.is_ascii() && text.contains("demarrage") && text.contains("rise of a"), "{text}");
}

/// Two steps with one output, of which one has a condition.
const FILL: &str = "profile iec61131
input a : BOOL
input b : BOOL
output q : BOOL
chart G {
  initial step 1
  step 2 { N q }
  step 3 { N q if a }
  1 -> 2 when a
  2 -> 3 when b
  3 -> 1 when not a
}
";

#[test]
fn lines_of_ladder_have_their_points() {
    let text = printed(FILL, Form::Ld);
    let inner = |part: &'static str| move |t: &str| t.split_once(part).map(|(t, _)| t.to_owned());
    let lines: Vec<String> = text.split("<connection ").skip(1).filter_map(inner("</connection>")).collect();
    assert!(lines.len() > 10, "{text}");
    for line in &lines {
        assert_eq!(line.matches("<position ").count(), 2, "{line}");
    }
    // The first line leads from the first rail: it is at (16, 40), and its output at (8, 16) from there.
    assert!(lines.first().is_some_and(|l| l.ends_with("<position x=\"24\" y=\"56\"/>")), "{text}");
}
