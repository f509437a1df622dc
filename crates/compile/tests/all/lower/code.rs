//! Expressions and statements, by what they compute.

use g7_engine::FaultKind;

use super::support::{Look, Run, compiled, refused};

/// Runs statements once in a scan and hands the run over.
fn after<T>(declarations: &str, statements: &str, look: impl FnOnce(&Run<'_>) -> T) -> T {
    let c = compiled(&format!("{declarations} post {{ {statements} }} chart G {{ initial step 1 }}"));
    let mut run = c.start();
    run.scan();
    look(&run)
}

fn value(declarations: &str, statements: &str, name: &str) -> String {
    after(declarations, statements, |run| run.value(name))
}

fn fault(declarations: &str, statements: &str) -> FaultKind {
    let c = compiled(&format!("{declarations} post {{ {statements} }} chart G {{ initial step 1 }}"));
    c.start().try_scan().expect_err("a fault").kind
}

#[test]
fn arithmetic_keeps_to_its_type() {
    assert_eq!(value("var n : INT", "n := (7 - 10) * 2 + 9 / 2 - 7 mod 4", "n"), "-5");
    assert_eq!(value("var r : REAL := 3.0", "r := r / 2.0", "r"), "1.5");
    assert_eq!(fault("var n : DINT  var s : INT := 300", "n := s * s + n"), FaultKind::Overflow);
}

#[test]
fn times_are_scaled_by_whole_and_real_numbers() {
    assert_eq!(value("var t : TIME := 3s", "t := t * 2 / 4", "t"), "T#1s500ms");
    assert_eq!(value("var t : TIME := 3s  var r : LREAL := 0.5", "t := t * r", "t"), "T#1s500ms");
}

#[test]
fn texts_are_joined_compared_and_cut() {
    let vars = "var s : STRING(8)  var b : BOOL  var n : INT";
    assert_eq!(value(vars, "s := CONCAT(CONCAT('ab', 'cd'), CONCAT('ef', 'ghij'))", "s"), "'abcdefgh'");
    assert_eq!(value(vars, "b := 'abc' < CONCAT('ab', 'd')", "b"), "TRUE");
    assert_eq!(value(vars, "n := LEN('héé') + FIND('abcd', 'cd')", "n"), "6");
    assert_eq!(value(vars, "s := INT_TO_STRING(n - 7)", "s"), "'-7'");
    assert_eq!(value(vars, "n := STRING_TO_INT('42')", "n"), "42");
}

#[test]
fn case_takes_the_first_arm_that_fits() {
    let arms = "CASE k OF 1: n := 10; 2, 5..7: n := 20; ELSE n := 30; END_CASE";
    for (k, n) in [(1, 10), (2, 20), (4, 30), (5, 20), (7, 20), (8, 30), (-1, 30)] {
        assert_eq!(value(&format!("var n : INT  var k : INT := {k}"), arms, "n"), n.to_string(), "{k}");
    }
}

#[test]
fn if_takes_the_first_true_arm() {
    let arms = "IF k > 5 THEN n := 1; ELSIF k > 3 THEN n := 2; ELSE n := 3; END_IF";
    for (k, n) in [(6, 1), (4, 2), (3, 3)] {
        assert_eq!(value(&format!("var n : INT  var k : INT := {k}"), arms, "n"), n.to_string(), "{k}");
    }
}

/// A condition in three operands, and its value by the rules of its operators.
type Condition = (&'static str, fn(bool, bool, bool) -> bool);

#[test]
fn a_condition_of_any_form_chooses_the_arm_and_ends_the_loop() {
    let conditions: [Condition; 11] = [
        ("a and b or c", |a, b, c| (a && b) || c),
        ("a or b and c", |a, b, c| a || (b && c)),
        ("a or b or c", |a, b, c| a || b || c),
        ("a and b and c", |a, b, c| a && b && c),
        ("a and (b or c) and not (b and c) and (a or b)", |a, b, c| a && b != c),
        ("not a and b or b and c or a and not c or c", |a, b, c| a || b || c),
        ("(a or b) and (not b or c)", |a, b, c| (a || b) && (!b || c)),
        ("not (a and not (b or not c))", |a, b, c| !a || b || !c),
        ("not (a or b) or not (b or c)", |a, b, c| !(b || a && c)),
        ("not (a xor b) and c", |a, b, c| a == b && c),
        ("(a and b) xor (b or c)", |a, b, c| (a && b) != (b || c)),
    ];
    let deep = format!("{}(a and b){}", "not (".repeat(71), ")".repeat(71));
    let all = conditions.into_iter().chain([(deep.as_str(), (|a, b, _| !(a && b)) as _)]);
    for (condition, holds) in all {
        let c = compiled(&format!(
            "input a, b, c : BOOL  var if_, elsif_, while_, until_ : INT  var stored : BOOL
             post {{
               IF {condition} THEN if_ := 1; ELSE if_ := 0; END_IF
               IF FALSE THEN elsif_ := 7; ELSIF {condition} THEN elsif_ := 1; ELSE elsif_ := 0; END_IF
               stored := {condition};
               while_ := 0; WHILE {condition} DO while_ := 1; EXIT; END_WHILE
               until_ := 1;
               REPEAT until_ := until_ - 1; IF until_ < -3 THEN EXIT; END_IF UNTIL {condition} END_REPEAT
             }}
             chart G {{ initial step 1 }}",
        ));
        for bits in 0..8u64 {
            let [a, b, c_] = [0, 1, 2].map(|i| bits >> i & 1);
            let mut run = c.start();
            run.set("a", a).set("b", b).set("c", c_).scan();
            let wanted = holds(a == 1, b == 1, c_ == 1);
            let one = if wanted { "1" } else { "0" };
            let got = ["if_", "elsif_", "while_", "until_"].map(|name| run.value(name));
            assert_eq!(
                run.value("stored"),
                if wanted { "TRUE" } else { "FALSE" },
                "{condition} with {a} {b} {c_}"
            );
            let rounds = if wanted { "0" } else { "-4" };
            assert_eq!(got, [one, one, one, rounds], "{condition} with {a} {b} {c_}");
        }
    }
}

/// The right operand is evaluated only where the left one does not decide (decision 23).
#[test]
fn a_condition_asks_no_further_than_to_its_decision() {
    let vars = "var z : INT  var i : INT := 5  var n : INT";
    let quiet = [
        ("i <= 2 and 9 / z = 0", "0"),
        ("i > 2 or 9 / z = 0", "1"),
        ("not (i > 2 or 9 / z = 0)", "0"),
        ("not (i <= 2 and 9 / z = 0) and i = 5", "1"),
        ("i = 4 or i <= 2 and 9 / z = 0 or i = 5", "1"),
        ("i = 4 and 9 / z = 0 and 9 / z = 1", "0"),
    ];
    for (condition, n) in quiet {
        assert_eq!(value(vars, &format!("IF {condition} THEN n := 1; END_IF"), "n"), n, "{condition}");
    }
    let wrong =
        ["i > 2 and 9 / z = 0", "i <= 2 or 9 / z = 0", "not (i > 2 and 9 / z = 0)", "9 / z = 0 and i = 4"];
    for condition in wrong {
        let statement = format!("IF {condition} THEN n := 1; END_IF");
        assert_eq!(fault(vars, &statement), FaultKind::DivisionByZero, "{condition}");
    }
}

#[test]
fn for_computes_its_ends_once_and_stops_at_the_end_of_its_type() {
    let vars =
        "var n : INT  var i : INT  var top : INT := 3  var down : INT := -2  var s : SINT  var u : USINT";
    let runs = [
        ("FOR i := 1 TO top DO n := n + i; top := 10; END_FOR", "6"),
        ("FOR i := 5 TO 1 BY -2 DO n := n * 10 + i; END_FOR", "531"),
        ("FOR i := 5 TO 1 BY down DO n := n * 10 + i; END_FOR", "531"),
        ("FOR i := 2 TO 1 DO n := 9; END_FOR", "0"),
        ("FOR s := 120 TO 127 DO n := n + 1; END_FOR", "8"),
        ("FOR s := -120 TO -128 BY -1 DO n := n + 1; END_FOR", "9"),
        ("FOR s := 0 TO 127 BY 100 DO n := n + 1; END_FOR", "2"),
        ("FOR u := 250 TO 255 DO n := n + 1; END_FOR", "6"),
        ("FOR i := 1 TO 9 DO IF i = 4 THEN EXIT; END_IF; n := i; END_FOR", "3"),
    ];
    for (statements, n) in runs {
        assert_eq!(value(vars, statements, "n"), n, "{statements}");
    }
}

#[test]
fn while_and_repeat_and_the_innermost_exit() {
    let vars = "var n : INT  var i : INT";
    assert_eq!(value(vars, "WHILE i < 4 DO i := i + 1; n := n + i; END_WHILE", "n"), "10");
    assert_eq!(value(vars, "REPEAT i := i + 1; n := n + i; UNTIL i >= 4 END_REPEAT", "n"), "10");
    let nested = "WHILE i < 3 DO i := i + 1; REPEAT n := n + 1; EXIT; UNTIL FALSE END_REPEAT; END_WHILE";
    assert_eq!(value(vars, nested, "n"), "3");
    assert_eq!(fault(vars, "WHILE TRUE DO n := 1; END_WHILE"), FaultKind::Work);
}

#[test]
fn a_return_ends_its_own_section_only() {
    let c = compiled(
        "var n : INT
         post { n := n + 1; IF n > 0 THEN RETURN; END_IF; n := n + 100; }
         post { n := n + 10; }
         chart G { initial step 1 }",
    );
    assert_eq!(c.start().scan().value("n"), "11");
}

#[test]
fn functions_are_written_out_with_their_own_words() {
    let text = "
        function Twice(x : INT) : INT { IF x > 100 THEN RETURN; END_IF; Twice := x + x; }
        function Quad(x : INT) : INT { var y : INT := 1; Quad := Twice(Twice(x)) + y - 1; y := 5; }
        function Bang(s : STRING(10)) : STRING(10) { Bang := CONCAT(s, '!'); }
        var n : INT  var s : STRING(20)";
    assert_eq!(value(text, "n := Quad(Twice(1) + 1) + Twice(200) + Quad(1)", "n"), "16");
    assert_eq!(value(text, "s := CONCAT(Bang('a'), Bang('b'))", "s"), "'a!b!'");
}

#[test]
fn what_functions_leave_behind_is_no_change() {
    // Two receptivities call one function with different arguments in every
    // pass, and so do two stored actions: nothing of that shows.
    let c = compiled(
        "function Over(x : INT) : BOOL { Over := x > 5; }
         input n : INT  var p, q : BOOL
         chart G { initial step 1 { P1 p := Over(3) P1 q := Over(7) }
           () -> 1 when Over(6)  () -> 1 when Over(1)  1 -> () when Over(n) }",
    );
    let t = c.tables();
    assert_eq!((t.locals.start, t.locals.end), (c.addr("Over.x").0, t.init.len() as u32));
    let mut run = c.start();
    run.scan();
    assert_eq!((run.value("p"), run.value("q")), ("FALSE".into(), "TRUE".to_owned()));
    assert_eq!(run.situation(), "1");
    let words = &run.state.words()[t.locals.start as usize..];
    assert!(words.iter().all(|w| *w == 0), "a scan leaves them zero");
}

#[test]
fn constant_texts_last_and_intermediate_ones_do_not() {
    let c = compiled(
        "var s : STRING(12)  var t : STRING(12) := 'x'
         post { s := CONCAT(CONCAT('ab', t), 'cd') }  chart G { initial step 1 }",
    );
    let mut run = c.start();
    run.scan();
    assert_eq!(run.scan().value("s"), "'abxcd'");
    assert!(run.state.words()[c.tables().locals.start as usize..].iter().all(|w| *w == 0));
}

#[test]
fn a_transition_section_runs_when_the_transition_is_judged() {
    let c = compiled(
        "profile unity  input n : INT
         transition section Ready { var k : INT; k := n * 2; IF k < 6 THEN RETURN; END_IF; Ready := TRUE; }
         chart G { initial step 1  step 2  1 -> 2 when Ready }",
    );
    let mut run = c.start();
    run.set("n", 2).scan();
    assert_eq!(run.situation(), "1", "RETURN leaves the section, not the transition");
    run.set("n", 3).scan();
    assert_eq!(run.situation(), "2");
}

#[test]
fn function_blocks_work_on_their_own_words() {
    let c = compiled(
        "input a : BOOL  var c1 : CTU  var q : BOOL  var n : INT
         post { c1(CU := a, PV := 2, CV => n); q := c1.Q; }
         chart G { initial step 1 }",
    );
    let mut run = c.start();
    run.scan();
    for a in [1, 0, 1] {
        run.set("a", a).scan();
    }
    assert_eq!((run.value("n"), run.value("q")), ("2".into(), "TRUE".to_owned()));
}

#[test]
fn step_times_by_the_clock_and_by_scans() {
    let text = "input a : BOOL  var t : TIME
        chart G { initial step 1  1 -> 1 when FALSE } post { t := X1.t }";
    let c = compiled(text);
    assert_eq!(c.start().scan().scan().scan().value("t"), "T#20ms");
    let c = compiled(
        "profile jgrafchart  scan 40ms  var n : INT  var r : REAL
         chart G { initial step Fill }  post { n := Fill.t; r := Fill.s }",
    );
    let mut run = c.start();
    run.scan().scan().scan();
    assert_eq!((run.value("n"), run.value("r")), ("2".into(), "0.08".to_owned()));
}

#[test]
fn faults_name_the_place_of_the_operation() {
    let text = "var n : INT := 32767  chart G { initial step 1 { P1 n := n + 1 } }";
    let c = compiled(text);
    let fault = c.start().try_scan().expect_err("overflow");
    assert_eq!(fault.kind, FaultKind::Overflow);
    let at = c.symbols.place(fault.at.expect("an instruction"));
    assert_eq!(&text[at.start as usize..at.end as usize], "n + 1");
}

#[test]
fn functions_that_multiply_without_end_are_refused() {
    let mut text = String::from("function F0(x : INT) : INT { F0 := x; }\n");
    for i in 1..40 {
        text += &format!("function F{i}(x : INT) : INT {{ F{i} := F{0}(x) + F{0}(x); }}\n", i - 1);
    }
    text += "var n : INT  post { n := F39(1) }";
    assert_eq!(refused(&text), ["G0008"]);
}

#[test]
fn an_expression_too_deep_for_the_stack_is_refused() {
    let mut text = String::from("a");
    for _ in 0..100 {
        text = format!("a - ({text})");
    }
    let doc = format!("var a, b : INT  post {{ b := {text} }}");
    assert_eq!(refused(&doc), ["G0007"]);
}
