//! Functions with structures, arrays and outputs, the time of the controller, in-outs that are used as variables, and
//! statements of other languages.

use crate::sfc::{carried, errors, import};

/// A text is read without problems as this .g7 text, but for the order of declarations that its places give.
#[track_caller]
fn becomes(text: &str, wanted: &str) {
    let found = carried(text);
    let (document, wrong) = g7_syntax::parse(wanted, g7_model::FileId(0));
    assert_eq!(wrong, []);
    assert_eq!(found, g7_syntax::print(&document, None));
    let (document, _) = g7_syntax::parse(&found, g7_model::FileId(0));
    let (chart, problems) = g7_compile::compile(&document);
    assert!(chart.is_some(), "{problems:?}\n{found}");
}

#[test]
fn a_function_with_structures_is_a_function_block_without_memory() {
    becomes(
        "TYPE V : STRUCT x : REAL; y : REAL := 2.0; END_STRUCT; END_TYPE
         FUNCTION Plus : V
           VAR_INPUT a, b : V; END_VAR
           Plus.x := a.x + B.X;
         END_FUNCTION
         PROGRAM Main
           VAR p, q, r : V; END_VAR
           r := Plus(a := p, b := Plus(p, q));
         END_PROGRAM",
        "profile iec61131
         struct V { x : REAL y : REAL := 2.0 }
         function block Plus {
           var Plus_first : V output Plus : V input a : V input b : V
           body { Plus := Plus_first Plus.x := a.x + b.x }
         }
         var p : V var q : V var r : V var Plus_2 : Plus var Plus_3 : Plus
         pre {
           Plus_2(a := p, b := q)
           Plus_3(a := p, b := Plus_2.Plus)
           r := Plus_3.Plus
         }",
    );
}

#[test]
fn calls_in_conditions_run_where_the_condition_is_asked() {
    becomes(
        "FUNCTION Down : BOOL
           VAR_INPUT n : INT; d : INT := 2; END_VAR
           VAR_OUTPUT left : INT; END_VAR
           VAR k : INT := 1; END_VAR
           left := n - d * k;
           Down := left > 0;
         END_FUNCTION
         PROGRAM Main
           VAR n, m : INT; END_VAR
           IF n > 3 THEN m := 0;
           ELSIF Down(N := n, left => m) THEN m := m + 1;
           ELSE m := 2;
           END_IF;
           WHILE Down(m, 3, m) DO n := n + 1; END_WHILE;
           REPEAT n := n + 1; UNTIL Down(n := n, EN := TRUE) END_REPEAT;
         END_PROGRAM",
        "profile iec61131
         function block Down {
           output Down : BOOL input n : INT input d : INT := 2 output left : INT
           body {
             var k : INT := 1
             left := 0
             Down := FALSE
             left := n - d * k
             Down := left > 0
           }
         }
         var n : INT var m : INT var Down_2 : Down var Down_3 : Down var Down_4 : Down
         pre {
           IF n > 3 THEN m := 0
           ELSE
             Down_2(n := n, left => m, d := 2)
             IF Down_2.Down THEN m := m + 1 ELSE m := 2 END_IF
           END_IF
           WHILE TRUE DO
             Down_3(n := m, d := 3, left => m)
             IF not Down_3.Down THEN EXIT END_IF
             n := n + 1
           END_WHILE
           REPEAT
             n := n + 1
             Down_4(n := n, d := 2)
           UNTIL Down_4.Down END_REPEAT
         }",
    );
}

#[test]
fn an_input_that_is_written_and_one_that_is_left_out() {
    becomes(
        "FUNCTION Rest : INT
           VAR_INPUT n : INT; d : INT := 7; last : INT; END_VAR
           WHILE N >= d DO n := n - d; END_WHILE;
           Rest := n + last;
         END_FUNCTION
         PROGRAM Main
           VAR a, b : INT; END_VAR
           a := Rest(n := b) + Rest(b, 3);
         END_PROGRAM",
        "profile iec61131
         var a : INT var b : INT
         function Rest(n : INT, d : INT, last : INT) : INT {
           var n_2 : INT
           n_2 := n
           WHILE n_2 >= d DO n_2 := n_2 - d END_WHILE
           Rest := n_2 + last
         }
         pre { a := Rest(n := b, d := 7, last := 0) + Rest(b, 3, 0) }",
    );
}

#[test]
fn the_time_of_the_controller_is_a_timer() {
    becomes(
        "FUNCTION Now : UDINT VAR_INPUT b : BOOL; END_VAR Now := TIME_TO_UDINT(TIME()); END_FUNCTION
         PROGRAM Main
           VAR t : UDINT; w : WORD; x : REAL; plc_time : INT; END_VAR
           t := Now(TRUE);
           x := WORD_TO_REAL(w);
           w := TIME_TO_WORD(T#5ms);
         END_PROGRAM",
        "profile iec61131
         var plc_time_2 : TON
         pre { plc_time_2(IN := not plc_time_2.Q, PT := 49d17h2m47.295s) }
         var t : UDINT var w : WORD var x : REAL var plc_time : INT
         function Now(b : BOOL) : UDINT { Now := TIME_TO_UDINT(plc_time_2.ET) }
         pre {
           t := Now(TRUE)
           x := UINT_TO_REAL(WORD_TO_UINT(w))
           w := UINT_TO_WORD(TIME_TO_UINT(5ms))
         }",
    );
}

#[test]
fn an_in_out_that_is_a_variable_is_copied_in_and_out() {
    let block = "FUNCTION_BLOCK Twice
           VAR_IN_OUT x : INT; END_VAR
           x := 2 * x;
         END_FUNCTION_BLOCK ";
    let program = |body: &str| {
        format!(
            "{block} PROGRAM Main VAR a : INT; t : ARRAY[1..2] OF Twice; i : INT; END_VAR {body} END_PROGRAM"
        )
    };
    let (found, problems) = import(&program("t[i](X := a); a := t[1].x;"));
    let told: Vec<(&str, &str)> = problems.iter().map(|p| (p.code.id, &*p.what)).collect();
    let what = "`x` is used as a variable of the instance: a call copies it in and out, as matiec does";
    assert_eq!(told, [("G0614", what)]);
    let text = g7_syntax::print(&found, None);
    for part in ["input x : INT", "t[i](x := a)", "a := t[i].x", "a := t[1].x"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let (found, problems) = import(&program("t[1](x := a); t[2](a);"));
    assert_eq!(problems, []);
    assert!(g7_syntax::print(&found, None).contains("inout x : INT"));
}

#[test]
fn what_is_not_read_is_told_at_its_place() {
    let block =
        "FUNCTION_BLOCK b VAR n : INT; END_VAR {attribute 'hide'} n := n + 1; {n++;} END_FUNCTION_BLOCK ";
    let wide =
        "FUNCTION f : BOOL VAR_INPUT a : INT; END_VAR VAR_OUTPUT q : INT; END_VAR f := TRUE; END_FUNCTION ";
    let cases: [(String, &str, &str); 5] = [
        (
            format!("{block} PROGRAM p VAR i : b; END_VAR i(); END_PROGRAM"),
            "{n++;}",
            "statements in a pragma, in C or another language, are not read",
        ),
        (
            "PROGRAM p VAR n : INT; END_VAR n := 1; {{ if (n) { n = 2; } }} END_PROGRAM".into(),
            "{{ if (n) { n = 2; } }}",
            "statements in a pragma, in C or another language, are not read",
        ),
        (
            "PROGRAM p VAR a : BOOL; n : INT; END_VAR n := ABS(IN := n, EN := a); END_PROGRAM".into(),
            "a",
            "`EN` of a function in an expression is TRUE, and `ENO` is not read; write an IF",
        ),
        (
            format!(
                "{wide} PROGRAM p INITIAL_STEP S: END_STEP STEP T: END_STEP TRANSITION FROM S TO T := f(a := 1); \
                 END_TRANSITION END_PROGRAM"
            ),
            "f(a := 1)",
            "a function with structures, arrays or outputs in a receptivity; call it in an action",
        ),
        (
            "FUNCTION f : INT VAR_INPUT a : ARRAY[0..1] OF INT; END_VAR VAR t : TON; END_VAR f := a[0]; END_FUNCTION"
                .into(),
            "t : TON;",
            "a function has no memory, and so no function block",
        ),
    ];
    for (text, place, what) in cases {
        let (_, problems) = import(&text);
        assert_eq!(errors(&problems), [what], "{text}");
        let at = problems
            .iter()
            .find(|p| &*p.what == what)
            .map_or(0..0, |p| p.at.start as usize..p.at.end as usize);
        assert_eq!(text.get(at), Some(place), "{text}");
    }
    // A block that is not used may have what is not read, and a pragma without statements says nothing.
    let unused = format!("{block} PROGRAM p VAR n : INT; END_VAR {{attribute 'x'}} n := 1; END_PROGRAM");
    assert_eq!(errors(&import(&unused).1), Vec::<&str>::new());
}

#[test]
fn many_functions_that_call_each_other_are_read_in_time() {
    let mut text =
        String::from("FUNCTION f0 : INT VAR_IN_OUT a : INT; END_VAR a := a + 1; f0 := a; END_FUNCTION\n");
    for n in 1..3000 {
        let before = n - 1;
        text +=
            &format!("FUNCTION f{n} : INT VAR_IN_OUT a : INT; END_VAR f{n} := f{before}(a); END_FUNCTION\n");
    }
    text += "PROGRAM p VAR n : INT; m : INT; END_VAR m := f2999(n); END_PROGRAM";
    let start = std::time::Instant::now();
    let (document, problems) = import(&text);
    assert_eq!(problems, []);
    let (_, problems) = g7_compile::compile(&document);
    let told: Vec<&str> = errors(&problems);
    assert_eq!(told, ["types stand in each other at most 64 deep"]);
    let program = |arms: usize| {
        let more = "ELSIF f0(n) > 5 THEN m := 2; ".repeat(arms);
        let first = text.lines().next().unwrap_or("");
        format!(
            "{first} PROGRAM p VAR n : INT; m : INT; END_VAR IF n > 1 THEN m := 1; {more} END_IF; END_PROGRAM"
        )
    };
    assert_eq!(errors(&import(&program(100)).1), <[&str; 0]>::default());
    let (document, problems) = import(&program(20_000));
    let what = "more than 100 calls of functions with outputs in conditions of ELSIF";
    assert_eq!(errors(&problems), [what]);
    let _ = g7_compile::compile(&document);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

#[test]
fn bits_of_real_numbers_are_told() {
    for (name, back) in
        [("DWORD_TO_REAL", "r := DWORD_TO_REAL(d);"), ("LREAL_TO_LWORD", "l := LREAL_TO_LWORD(x);")]
    {
        let text =
            format!("PROGRAM p VAR r : REAL; d : DWORD; x : LREAL; l : LWORD; END_VAR {back} END_PROGRAM");
        let (_, problems) = import(&text);
        let start = format!("`{name}` converts the number, as CODESYS does");
        assert!(problems.iter().any(|p| p.code.id == "G0614" && p.what.starts_with(&start)), "{problems:?}");
    }
}
