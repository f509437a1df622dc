//! Constructs that the meta-model cannot hold are reported at their places in the document.

use crate::support;
use crate::xmi::show::{import, lines, read};

/// The problems of writing a text, and the text that comes back.
fn round(text: &str) -> (Vec<String>, String) {
    let written = support::export("xmi", &read(text));
    let (back, _) = import(written.text.as_bytes());
    (lines(text.as_bytes(), &written.problems), g7_syntax::print(&back, None))
}

#[test]
fn what_means_the_same_is_written_with_what_there_is() {
    let (problems, back) = round(
        "input a, b : BOOL  var n : DINT  const five : DINT := 5
         chart G {
           initial step 1 { S out  R out if b }
           output out : BOOL
           T1: 1 -> 1 when a + b
           T2: 1 -> 1 when a . b xor X1
           T3: 1 -> 1 when n <= five and n <> -five
           T4: 1 -> 1 when 1500ms/G.X1
           T5: 1 -> 1 when -n >= 0
         }",
    );
    assert_eq!(problems, Vec::<String>::new());
    for line in [
        "input a : BOOL",
        "input b : BOOL",
        "P1 out := TRUE",
        "P1 out := FALSE if b",
        "T1: 1 -> 1 when a or b",
        "T2: 1 -> 1 when not ((a and b) = X1)",
        "T3: 1 -> 1 when not (n > 5) and not (n = 0 - 5)",
        "T4: 1 -> 1 when 1.5s/X1",
        "T5: 1 -> 1 when not (0 - n < 0)",
    ] {
        assert!(back.lines().any(|l| l.trim() == line), "{line}\n{back}");
    }
}

#[test]
fn what_cannot_be_held_is_a_problem_with_its_place() {
    let (problems, back) = round(
        "profile pl7
         scan 10ms
         input a : BOOL at %I0.0 \"a button\"
         output lamp : BOOL
         var r : REAL
         var n : INT := 4
         chart Fill \"of the tank\" every 20ms {
           initial step 1 { N lamp if ↑a  \"a comment\"  L 3s lamp if a }
           step Full { S n := 1  P0 { n := 1; n := 2 }  each scan: n := n + 1 }
           go: 1 -> Full when r > 2.5 priority 2 \"why\"
           Full -> 1 when n * 2 = 4 on clearing { n := 0 }
           T3: 1 -> Full when X1.t > 5s
           T4: 1 -> Full when 10us/a
           T5: 1 -> Full when a and 5s/a
         }
         layout Fill { step 1 at (0, 0) }",
    );
    assert_eq!(
        problems,
        [
            "G0604 1: the rules of evolution of `pl7` or its switches; the meta-model's are those of IEC 60848",
            "G0605 2: a scan time: the meta-model has none; it is left out",
            "G0605 3: an address: the meta-model has none; it is left out",
            "G0605 3: a comment: the meta-model has none; it is left out",
            "G0604 5: a variable of the type REAL: the meta-model has none",
            "G0614 6: a variable of the type INT: an integer of the meta-model is a DINT",
            "G0604 6: an initial value: the meta-model has none",
            "G0605 7: a comment: the meta-model has none; it is left out",
            "G0604 7: a period of a chart: the meta-model has none",
            "G0605 8: a comment among the actions: the meta-model has none; it is left out",
            "G0604 8: a delay or limit with a condition beside it: the meta-model has none",
            "G0611 9: the meta-model numbers its steps: `Full` becomes 2",
            "G0604 9: statements with the qualifier S: the meta-model has none",
            "G0604 9: a stored action that is not one assignment: the meta-model has none",
            "G0604 9: an action in each scan: the meta-model has none",
            "G0611 10: the meta-model numbers its transitions: the label `go` is left out",
            "G0605 10: a comment: the meta-model has none; it is left out",
            "G0605 10: a priority: the meta-model has none; it is left out",
            "G0604 10: what `r` stands for: the meta-model has none",
            "G0604 10: a constant that is neither Boolean nor a whole number: the meta-model has none",
            "G0604 11: a stored action on clearing: the meta-model has none",
            "G0604 11: a product, quotient, remainder or power of numbers: the meta-model has none",
            "G0604 12: what `X1.t` stands for: the meta-model has none",
            "G0604 12: a constant that is neither Boolean nor a whole number: the meta-model has none",
            "G0604 13: a time that is no whole number of seconds or milliseconds: the meta-model has none",
            "G0604 14: a time operator within a term: the meta-model has none",
            "G0605 16: a layout: the meta-model has none; it is left out",
        ]
    );
    // All other constructs come back.
    assert!(back.contains("chart Fill {"), "{back}");
    assert!(back.contains("  initial step 1 { N lamp if ↑a }\n  step 2\n"), "{back}");
}

#[test]
fn what_only_plain_steps_can_be_is_refused_for_others() {
    let (problems, back) = round(
        "output lamp : BOOL
         chart G {
           initial step 1 { force F := {E1} }
           macro M2 = F { N lamp }
           enclosing step 3 { enclose H  N lamp }
           1 -> M2 when XM2
           M2 -> 3 when F.XE1 or F.X9
           3 -> 1 when X3
         }
         chart H { step 7*  7 -> 7 when TRUE }
         macrochart F {
           entry step E1 { N lamp }
           step 9
           exit step S1
           E1 -> 9 when TRUE
           9 -> S1 when TRUE
         }",
    );
    assert_eq!(
        problems,
        [
            "G0604 3: a forced macro-step, entry or exit step: the meta-model has none",
            "G0604 4: an action of an enclosing step, macro-step, entry or exit step: the meta-model has none",
            "G0604 5: an action of an enclosing step, macro-step, entry or exit step: the meta-model has none",
            "G0604 6: the activity of a macro-step, entry or exit step as a term: the meta-model has none",
            "G0604 7: the activity of a macro-step, entry or exit step as a term: the meta-model has none",
            "G0604 12: an action of an enclosing step, macro-step, entry or exit step: the meta-model has none",
        ]
    );
    assert!(back.contains("enclosing step 3 { enclose H }"), "{back}");
    assert!(back.contains("when X3"), "{back}");
}

#[test]
fn a_time_operator_within_a_term_is_a_boolean_of_its_name() {
    let text = "input a : BOOL
         chart G {
           initial step 1
           step 202
           1 -> 202 when a
           202 -> 1 when a and (2s/X202 or 1500ms/X202)
         }
         chart H {
           initial step 1
           1 -> 1 when a and 2s/G.X1
         }";
    let (problems, back) = round(text);
    let what = "a time operator within a term: the meta-model has none";
    assert_eq!(
        problems,
        [
            format!("G0614 6: {what}; it is written as a Boolean `2s/X202`"),
            format!("G0614 6: {what}; it is written as a Boolean `1500ms/X202`"),
            // Two charts have a step 1, so a reader would not know which of them.
            "G0604 10: a time operator within a term: the meta-model has none".to_string(),
        ]
    );
    assert!(back.contains("202 -> 1 when a and (2s/X202 or 1.5s/X202)"), "{back}");
    assert!(!back.contains("input 2s") && !back.contains("`2s/X202`"), "{back}");
}
