//! Function blocks of the file in written files: which of them stay, and how they stand there.

use g7_exchange::{Dialect, Written};
use g7_model::{Document, FileId, Severity};

use crate::support;

const COUNT: &str = "function block Count {
  input up : BOOL
  input step_by : REAL := 1.0
  output n : REAL
  output mask : WORD
  inout total : REAL
  var calls : INT
  body {
    var twice : REAL
    calls := calls + 1
    IF not up THEN RETURN END_IF
    twice := step_by * factor
    n := n + step_by
    total := total + twice
    mask.3 := n > limit
  }
}
const factor : REAL := 2.0
const limit : INT := 7
input a : BOOL
output x : REAL
output y : BOOL
var sum : REAL
var first : Count := (step_by := 3)
";

pub(crate) fn document(text: &str) -> Document {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert_eq!(problems, [], "{text}");
    let (_, problems) = g7_compile::compile(&document);
    let errors: Vec<_> = problems.iter().filter(|p| p.severity() == Severity::Error).collect();
    assert_eq!(errors, Vec::<&g7_model::Problem>::new(), "{text}");
    document
}

/// A document with the function block `Count`, its variables, and this text behind them.
fn with_chart(chart: &str) -> Document {
    document(&format!("profile iec61131\n{COUNT}{chart}"))
}

const CHART: &str = "chart G {
  initial step 1 { each scan: first(a, total := sum, n => x) }
  1 -> 1 when first.n > 3 and first.mask.3
}
post { y := first.mask.0  first.up := a }
";

pub(crate) fn text_of(document: &Document) -> String {
    clean(support::export("sfc", document))
}

pub(crate) fn project(document: &Document, dialect: Dialect) -> String {
    let format = g7_exchange::named("plcopen").expect("a format of the table");
    clean(format.write_in(document, dialect).expect("it has dialects"))
}

fn clean(written: Written) -> String {
    let errors: Vec<_> = written.problems.iter().filter(|p| p.severity() == Severity::Error).collect();
    assert_eq!(errors, Vec::<&g7_model::Problem>::new(), "{}", written.text);
    written.text
}

/// True if a text contains these lines in this order, apart from the spaces before them.
pub(crate) fn has(text: &str, lines: &str) -> bool {
    let mut all = text.lines().map(str::trim);
    lines.lines().map(str::trim).all(|line| all.any(|l| l == line))
}

#[test]
fn a_function_block_stays_one_in_text() {
    let text = text_of(&with_chart(CHART));
    let block = "FUNCTION_BLOCK Count
        VAR_INPUT
        up : BOOL;
        step_by : REAL := 1.0;
        END_VAR
        VAR_OUTPUT
        n : REAL;
        mask : WORD;
        END_VAR
        VAR
        calls : INT;
        twice : REAL;
        END_VAR
        VAR_IN_OUT
        total : REAL;
        END_VAR
        twice := 0.0;
        calls := calls + 1;
        IF NOT up THEN
        RETURN;
        END_IF;
        twice := step_by * 2.0;
        n := n + step_by;
        total := total + twice;
        END_FUNCTION_BLOCK";
    assert!(has(&text, block), "{text}");
    assert!(has(&text, "first : Count;"), "{text}");
    assert!(text.contains("first(step_by := 3.0, up := a, total := sum, n => x)"), "{text}");
    assert!(text.contains("first.up := a;"), "{text}");
}

#[test]
fn a_function_block_stays_one_in_a_project() {
    let text = format!("profile iec61131\n{COUNT}{CHART}");
    let document = document(&text.replace("(step_by := 3)", "(step_by := 3, mask := 1)"));
    let xml = project(&document, Dialect::Standard);
    let lines = r#"<pou name="Count" pouType="functionBlock">
        <interface>
        <inputVars>
        <variable name="up">
        <variable name="step_by">
        <outputVars>
        <variable name="n">
        <variable name="mask">
        <localVars>
        <variable name="calls">
        <inOutVars>
        <variable name="total">
        <body>
        <variable name="first">
        <derived name="Count"/>
        <structValue>
        <value member="step_by">
        <simpleValue value="3.0"/>
        <value member="mask">
        <simpleValue value="WORD#1"/>"#;
    assert!(has(&xml, lines), "{xml}");
}

#[test]
fn an_array_of_instances_is_an_instance_for_each_element() {
    let chart = "var all : ARRAY[1..2] OF Count
      var i : INT := 1
      post {
        all[1](up := a, total := sum)
        all[i](up := FALSE, total := sum)
        FOR i := 1 TO 2 DO all[i](total := sum) END_FOR
        y := all[2].mask.0
      }
      chart G { initial step 1 }
      ";
    let written = support::export("sfc", &with_chart(chart));
    let bounds = |p: &&g7_model::Problem| p.what.to_string().contains("of the bounds of `all`");
    assert_eq!(written.problems.iter().filter(bounds).count(), 1, "{:?}", written.problems);
    let text = clean(written);
    let lines = "all_1 : Count;
        all_2 : Count;
        all_1(up := a, total := sum);
        CASE i OF
        1:
        all_1(up := FALSE, total := sum);
        2:
        all_2(up := FALSE, total := sum);
        END_CASE;
        CASE i OF
        1:
        all_1(total := sum);
        2:
        all_2(total := sum);
        END_CASE;
        y := (all_2.mask AND WORD#16#1) <> WORD#16#0;";
    assert!(has(&text, lines), "{text}");
}

/// A condition of an action reads what was there before all bodies.
#[test]
fn an_output_in_a_condition_is_that_from_before_the_bodies() {
    let called = |place: &str| {
        let chart = format!(
            "chart G {{ initial step 1 {{ N y if first.n > 3 {} }} }}\npost {{ x := first.n  {} }}\n",
            if place == "chart" { "each scan: first(a, total := sum)" } else { "" },
            if place == "post" { "first(a, total := sum)" } else { "" },
        );
        text_of(&with_chart(&chart))
    };
    let (within, behind) = (called("chart"), called("post"));
    assert!(has(&within, "first_n_before := first.n;"), "{within}");
    assert!(within.contains("first_n_before > 3.0"), "{within}");
    assert!(behind.contains("first.n > 3.0") && !behind.contains("before"), "{behind}");
}

/// The call changes the variable that an in-out stands for, as an output does.
#[test]
fn a_variable_of_an_in_out_is_written_by_the_call() {
    let chart = "chart G { initial step 1 { N y if sum > 3  each scan: first(a, total := sum) } }\n";
    let text = text_of(&with_chart(chart));
    assert!(has(&text, "sum_before := sum;") && text.contains("sum_before > 3.0"), "{text}");
}

/// The generator of Beremiz leaves out the initial values of an instance, so its calls give these.
#[test]
fn calls_give_the_initial_values_of_inputs_for_matiec() {
    let count = |init: &str| COUNT.replace("(step_by := 3)", init);
    let file = |init: &str, chart: &str| document(&format!("profile iec61131\n{}{chart}", count(init)));
    let chart = "chart G { initial step 1 { each scan: first(a, total := sum, n => x) } }\n";
    for dialect in [Dialect::Beremiz, Dialect::OpenPlc] {
        let xml = project(&file("(step_by := -2.5)", chart), dialect);
        assert!(xml.contains("pouType=\"functionBlock\""), "{xml}");
        assert!(xml.contains("first(step_by := -2.5, up := a, total := sum)"), "{xml}");
        assert!(!xml.contains("structValue"), "{xml}");
        let others = [
            ("(mask := 1)", chart),
            ("(step_by := 3)", "post { first(a, step_by := 1, total := sum) }\nchart G { initial step 1 }\n"),
            (
                "(step_by := 3)",
                "post { first(a, total := sum) first.step_by := 2 }\nchart G { initial step 1 }\n",
            ),
        ];
        for (init, chart) in others {
            let xml = project(&file(init, chart), dialect);
            assert!(!xml.contains("functionBlock"), "{init} {chart} {xml}");
        }
    }
}

/// The names of the function blocks in a document.
fn blocks(document: &Document) -> Vec<&str> {
    document.composed().map(|c| &*c.name.text).collect()
}

#[test]
fn text_that_is_read_again_has_the_function_block() {
    let text = text_of(&with_chart(CHART));
    let (again, problems) = support::import("sfc", text.as_bytes(), FileId(1));
    let errors: Vec<_> = problems.iter().filter(|p| p.severity() == Severity::Error).collect();
    assert_eq!(errors, Vec::<&g7_model::Problem>::new(), "{text}");
    assert_eq!(blocks(&again), ["Count"]);
    assert_eq!(text_of(&again).matches("FUNCTION_BLOCK Count").count(), 1);
}

#[test]
fn a_function_block_stands_behind_those_that_it_has_instances_of() {
    let pair = "function block Pair {
      input go : BOOL
      output done : BOOL
      inout total : REAL
      var one, two : Count
      body {
        one(up := go, total := total)
        two(up := one.mask.3, step_by := one.n, total := total)
        done := two.mask.3
      }
    }
    var pair : Pair
    chart G { initial step 1 { each scan: pair(go := a, total := sum, done => y) } }
    post { x := first.n }
    ";
    // The outer one comes first here.
    let text = text_of(&document(&format!("profile iec61131\n{}{COUNT}", pair)));
    let place = |name: &str| text.find(&format!("FUNCTION_BLOCK {name}\n")).expect(name);
    assert!(place("Count") < place("Pair"), "{text}");
    assert!(
        text.contains("two(up := (one.mask AND WORD#16#8) <> WORD#16#0, step_by := one.n, total := total);"),
        "{text}"
    );
}

#[test]
fn what_a_file_has_no_instance_of_is_left_out() {
    let text = text_of(&with_chart(
        "chart G { initial step 1 }\npost { y := a  first.up := a }\nfunction block Idle { input a : BOOL body { } }\n",
    ));
    assert!(text.contains("FUNCTION_BLOCK Count") && !text.contains("Idle"), "{text}");
}

/// A function block with one of these uses is taken apart: its text stands in the place of its calls.
#[test]
fn a_function_block_is_taken_apart_where_it_could_not_mean_the_same() {
    let call = "each scan: first(a, total := sum)";
    let uses = [
        (
            "an element that an index chooses",
            "var all : ARRAY[1..2] OF Count\nvar i : INT := 1\npost { all[1](up := a, total := sum) x := all[i].n }\nchart G { initial step 1 }",
        ),
        (
            "an inner variable that others read",
            "post { first(up := a, total := sum) y := first.calls > 3 }\nchart G { initial step 1 }",
        ),
        ("an input that a step drives", &format!("chart G {{ initial step 1 {{ N first.up  {call} }} }}")),
        (
            "an instance in a structure",
            "struct Two { one : Count }\nvar two : Two\npost { two.one(up := a, total := sum) y := first.up }\nchart G { initial step 1 }",
        ),
    ];
    for (what, chart) in uses {
        let text = text_of(&with_chart(&format!("{chart}\n")));
        let stays = what == "an instance in a structure";
        assert_eq!(text.contains("FUNCTION_BLOCK"), stays, "{what}: {text}");
    }
}

#[test]
fn a_function_block_that_names_variables_of_the_file_is_taken_apart() {
    for body in ["y := up", "g := 3", "FOR g := 1 TO 3 DO n := n + 1 END_FOR", "n := g"] {
        let text = format!(
            "profile iec61131\nvar y : BOOL\nvar g : INT\nfunction block B {{ input up : BOOL output n : INT body {{ {body} }} }}\nvar b : B\nchart G {{ initial step 1 }}\npost {{ b(up := TRUE) }}\n"
        );
        let written = text_of(&document(&text));
        assert!(!written.contains("FUNCTION_BLOCK"), "{body}: {written}");
    }
}

#[test]
fn names_that_the_standard_does_not_have_are_changed_everywhere() {
    let text = "profile iec61131
function block Zähler { input word : BOOL input größe : INT output höhe : INT body { IF word THEN höhe := höhe + größe END_IF } }
var z : Zähler := (größe := 4)
output x : INT
chart G { initial step 1 { each scan: z(word := TRUE, höhe => x) } 1 -> 1 when z.höhe > 5 }
";
    let written = text_of(&document(text));
    assert!(!written.contains('ä') && !written.contains('ö'), "{written}");
    let (again, problems) = support::import("sfc", written.as_bytes(), FileId(1));
    assert!(problems.iter().all(|p| p.severity() != Severity::Error), "{problems:?} {written}");
    assert_eq!(blocks(&again).len(), 1, "{written}");
}

#[test]
fn codesys_declares_an_instance_of_several_programs_once() {
    let chart = "chart G { initial step 1 { each scan: first(a, total := sum) } }
chart H { initial step 1 1 -> 1 when first.mask.3 }
";
    let document = with_chart(chart);
    let xml = project(&document, Dialect::Codesys);
    assert!(has(&xml, "<globalVars name=\"Variables\">\n<variable name=\"first\">"), "{xml}");
    assert_eq!(xml.matches("pouType=\"functionBlock\"").count(), 1, "{xml}");
}

#[test]
fn parameters_of_an_enumeration_stay_and_their_values_are_numbers() {
    let text = "profile iec61131
type Mode : (Off, Slow := 5, Fast)
type Percent : INT(0..100)
function block Drive {
  input wish : Mode
  output state : Mode
  output speed : INT
  body {
    state := wish
    CASE state OF Mode.Fast: speed := 90 Mode.Slow: speed := 20 ELSE speed := 0 END_CASE
  }
}
var drive : Drive
var seen : Mode
var percent : Percent
output lamp : BOOL
chart G {
  initial step 1 { each scan: drive(wish := Fast, state => seen, speed => percent) }
  1 -> 1 when drive.state = Fast and seen <> Slow
}
post { lamp := drive.state = Mode.Slow }
";
    let written = text_of(&document(text));
    let lines = "FUNCTION_BLOCK Drive
        VAR_INPUT
        wish : INT := 0;
        state : INT := 0;
        state := wish;
        6:
        speed := 90;
        END_FUNCTION_BLOCK
        drive_2(wish := 6);
        seen := drive_2.state;
        := drive_2.state = 6 AND seen <> 5;
        lamp := drive_2.state = 5;";
    assert!(has(&written, lines), "{written}");
    // The bounds are held behind the call.
    assert!(!written.contains("=> percent"), "{written}");
}
