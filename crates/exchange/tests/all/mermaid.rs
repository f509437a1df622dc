//! Charts as Mermaid flowcharts: every step, transition and action is there, and
//! no name breaks the text.

use g7_model::FileId;

fn written(text: &str) -> String {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    let written = g7_exchange::named("mermaid").and_then(|f| f.write(&document)).expect("it is written");
    assert!(written.problems.is_empty());
    written.text
}

#[test]
fn a_chart_is_a_box_of_steps_transitions_and_actions() {
    let text = written(
        "input a : BOOL\noutput m : BOOL\nchart G \"of a pump\" {\n  initial step 1\n  step 2 { N m if a }\n  \
         t1: 1 -> 2 when \u{2191}a\n  2 -> 1 when not a\n}\n",
    );
    assert_eq!(
        text,
        "flowchart TB\n  subgraph c0[\"G<br/>of a pump\"]\n    c0s0[\"1\"]\n    style c0s0 stroke-width:4px\n    \
         c0s1[\"2\"]\n    c0s1a0[\"N m if a\"]:::action\n    c0s1 -.- c0s1a0\n    c0t0{{\"t1: \u{2191}a\"}}\n    \
         c0s0 --- c0t0\n    c0t0 --> c0s1\n    c0t1{{\"not a\"}}\n    c0s1 --- c0t1\n    c0t1 --> c0s0\n  end\n  \
         classDef action fill:none,stroke-dasharray:4\n"
    );
}

#[test]
fn names_and_texts_break_nothing() {
    let text =
        written("chart `a\"]` {\n  initial step `x{{}}` \"end; <b>\"\n  `x{{}}` -> `x{{}}` when TRUE\n}\n");
    assert!(text.contains("c0[\"a#34;#93;\"]"), "{text}");
    assert!(text.contains("c0s0[\"x#123;#123;#125;#125;<br/>end#59; #60;b#62;\"]"), "{text}");
}
