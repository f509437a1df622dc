//! A construct ends with its line: what is forgotten is told where it is missing, and the next line
//! is read as what it is.

use g7_model::FileId;
use g7_syntax::{LineIndex, parse, print};

/// Checks that the text has one problem, at the end of the line marked by `§`.
fn stops(text: &str) {
    let line = text.lines().position(|l| l.ends_with('§')).expect("a mark");
    let text = text.replace('§', "");
    let lines = LineIndex::new(&text);
    let (_, problems) = parse(&text, FileId(0));
    let shown: Vec<String> = problems
        .iter()
        .map(|p| {
            let place = lines.place(p.at.start);
            format!("{}:{} {} {}", place.line, place.column, p.code.id, p.what)
        })
        .collect();
    let number = u32::try_from(line + 1).expect("few lines");
    let column = lines.line_text(number).chars().count() + 1;
    let wanted = format!("{number}:{column} ");
    assert!(
        shown.len() == 1 && shown[0].starts_with(&wanted),
        "{text}\ntold:\n  {}\nwanted one at {wanted}",
        shown.join("\n  ")
    );
}

/// Checks that the text is read without a problem, and is the same when it is printed.
fn goes_on(text: &str) {
    let (document, problems) = parse(text, FileId(0));
    assert!(problems.is_empty(), "{text}\n{problems:?}");
    let printed = print(&document, Some(text));
    let (again, problems) = parse(&printed, FileId(0));
    assert!(problems.is_empty() && again == document, "{printed}\n{problems:?}");
}

/// In a chart with two steps.
fn chart(lines: &str) -> String {
    format!("chart G {{\n  initial step 0\n  step 1\n{lines}\n}}\n")
}

#[test]
fn a_receptivity_stands_on_the_line_of_its_when() {
    for first in [
        "0 -> 1 when§",
        "0 -> 1 when a and§",
        "0 -> 1 when a +§",
        "0 -> 1 when not§",
        "0 -> 1 when n >§",
        "0 -> 1 when 5s/§",
        "0 -> 1 when a -> 0 when§",
        "0 -> 1 when a priority§",
        "0 -> 1§",
        "0 ->§",
    ] {
        stops(&chart(&format!("  {first}\n  1 -> 0 when b")));
        stops(&chart(&format!("  {first}\n  (1, 0) -> 0 when b")));
        stops(&chart(&format!("  {first}\n  step 2")));
        stops(&chart(&format!("  {first}\n  `1` -> 0 when b")));
        stops(&chart(&format!("  {first}\n  at -> 0 when b")));
    }
}

#[test]
fn an_expression_goes_on_in_brackets_or_from_an_operator() {
    goes_on(&chart("  0 -> 1 when (a and\n    b)"));
    goes_on(&chart("  0 -> 1 when a\n    and b\n    or [c or\n    d]\n    > 3"));
    goes_on(&chart(
        "  0 -> 1\n    when a\n    priority 2\n    \"comment\"\n    on clearing {\n    n := 1\n  }\n  -> 0\n    when b",
    ));
    goes_on(&chart("  0 -> 1 when F(a,\n    b) and rise(\n a)\n  (0,\n   1) -> 0 when delay(5s,\n a)"));
}

#[test]
fn declarations_end_with_their_line() {
    for first in [
        "input§",
        "input a,§",
        "input a :§",
        "input a : BOOL :=§",
        "input a : BOOL at§",
        "output a : BOOL safe§",
        "var n : INT := 1 +§",
        "const n : INT§",
        "const n : INT :=§",
        "scan§",
        "assume§",
        "assume a and§",
        "prove always§",
        "prove never a or§",
        "prove a leads to§",
        "prove between a and§",
        "prove after a within§",
        "prove after a within 5s expect§",
        "prove after a until§",
        "prove always a with§",
        "transition section A :=§",
        "transition section A := a and§",
    ] {
        for next in ["input z : BOOL", "scan 10ms", "assume z", "pre { n := 1; }", "target tsx57"] {
            stops(&format!("{first}\n{next}\n"));
        }
    }
    goes_on(
        "input a : BOOL\n  := TRUE\n  at %I0.0\n  inverted\n  \"comment\"\noutput q : BOOL\n  safe TRUE\n",
    );
    goes_on("prove after a\n  within 5s\n  expect b\n  \"comment\"\nprove between a\n  and b\n  never c\n");
    goes_on("prove a\n  leads to b\nprove after a\n  until b\n  expect c\nprove at most 1 of (\n a,\n b)\n");
}

#[test]
fn clauses_of_a_declaration_may_be_names_of_steps() {
    goes_on(
        "chart G {\n  input a : BOOL\n  initial step at\n  step safe\n  var n : INT\n  at -> safe when a\n  \
             var m : INT\n  safe -> at when a\n}\n",
    );
}

#[test]
fn actions_end_with_their_line() {
    for first in [
        "N§",
        "P1 n :=§",
        "P1 n := n +§",
        "N V if§",
        "N V if a and§",
        "L§",
        "L 5s§",
        "on§",
        "on a:§",
        "on a: n :=§",
        "each scan: n := n *§",
        "force G :=§",
        "force§",
        "enable§",
        "call§",
        "mask§",
        "enclose§",
        "n :=§",
    ] {
        for next in ["N W", "P1 m := 1", "S W", "on b: m := 1", "enable G"] {
            let text = format!("chart G {{\n  initial step 0 {{\n    {first}\n    {next}\n  }}\n}}\n");
            if first == "n :=§" {
                // The missing qualifier is told as well.
                let (_, problems) = parse(&text.replace('§', ""), FileId(0));
                assert_eq!(problems.len(), 2, "{problems:?}");
                continue;
            }
            stops(&text);
        }
    }
    goes_on(
        "chart G {\n  initial step 0\n  {\n    N V\n      if a\n      and b\n    \"comment\"\n    P1\n    { n := 1 }\n    \
             force G := {0,\n 1}\n  }\n}\n",
    );
}

#[test]
fn statements_of_a_test_end_with_their_line() {
    for first in [
        "set§",
        "set a :=§",
        "set a := TRUE,§",
        "pulse§",
        "pulse a for§",
        "wait§",
        "wait until§",
        "wait until a and§",
        "wait until a within§",
        "expect§",
        "expect a,§",
        "expect not§",
        "force a :=§",
        "release§",
    ] {
        for next in ["set b := TRUE", "expect b", "scan 5", "wait 5s", "always b { wait 1s }"] {
            stops(&format!("test \"t\" {{\n  {first}\n  {next}\n}}\n"));
        }
    }
    goes_on(
        "test \"t\"\n  with Plant\n  seed 5\n{\n  wait until a\n    or b\n    within 5s\n  scan\n  restart\n  \"note\"\n  \
             set a\n    := TRUE\n    , b := FALSE\n  expect fault\n  expect a\n  pulse a\n    for 1s\n}\n",
    );
}

#[test]
fn items_of_a_plant_end_with_their_line() {
    for first in [
        "const§",
        "const c : REAL§",
        "const c : REAL :=§",
        "state x : REAL := 1.0 +§",
        "state x : REAL in 0.0 ..§",
        "state x : REAL in§",
        "rate§",
        "rate x :=§",
        "rate x := 1.0 when§",
        "drive§",
        "drive a :=§",
        "drive a := b or§",
        "parts box (w : REAL) max§",
        "parts box (w : REAL) max 3 length§",
    ] {
        for next in ["drive z := TRUE", "state y : REAL", "each { n := 1 }", "view 'a.svg'"] {
            stops(&format!("plant P {{\n  {first}\n  {next}\n}}\n"));
        }
    }
    goes_on(
        "plant P\n{\n  rate x := 1.0\n    when a\n    or b\n  state x : REAL := 1.0\n    in 0.0\n    .. 5.0\n  arrivals n\n    \
             every 1s\n    .. 2s\n    when a { n := 1 }\n}\n",
    );
}

#[test]
fn layouts_and_profiles_end_with_their_line() {
    for first in ["step 1 at§", "step§", "transition§", "transition #§", "comment \"a\"§", "comment§"] {
        stops(&format!("layout G {{\n  {first}\n  step 2 at (0, 0)\n}}\n"));
    }
    stops("profile pl7 {\n  bound§\n  stable\n}\n");
    stops("profile§\nchart G {\n}\n");
    stops("target§\nchart G {\n}\n");
    stops("chart§\nchart G {\n}\n");
    stops("plant§\nchart G {\n}\n");
    stops("layout§\nchart G {\n}\n");
}

#[test]
fn a_statement_runs_on_only_with_a_semicolon() {
    for first in ["x := a and§", "x :=§", "x := not§", "var y : INT := 1 +§", "x := n -§"] {
        for next in ["b(c)", "b := 1", "b := 1;", "IF a THEN b := 1; END_IF"] {
            stops(&format!("pre {{\n  {first}\n  {next}\n  z := 1\n}}\n"));
        }
    }
    goes_on("pre {\n  x := a AND\n    b;\n  x :=\n    5 +\n    3;\n  y := F(a,\n  b) OR\n  c;\n}\n");
    goes_on("pre {\n  IF a AND\n    b\n  THEN\n    x := 1\n  END_IF\n  y := a\n    OR b\n  z := 1\n}\n");
}

#[test]
fn an_instruction_stands_on_its_line() {
    for first in ["MAX b,§", "AND§", "LD§", "ST§", "CAL§", "JMP§"] {
        stops(&format!("pre il {{\n  LD a\n  {first}\n  ST c\n}}\n"));
    }
}
