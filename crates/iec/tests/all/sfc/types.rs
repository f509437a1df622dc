//! Types of the file: arrays, structures, and function blocks without a chart.

use g7_compile::compile;
use g7_model::{Item, Type};

use super::carried::same;
use super::{carried, errors, import};

#[test]
fn arrays_and_structures_keep_their_form() {
    let text = "
TYPE
  Percent : INT (0..100);
  Motor : STRUCT
    on : BOOL; (* the contactor *)
    Speed, Limit : REAL := 2.5;
    trip : ARRAY[0..1] OF BOOL;
  END_STRUCT;
  Row : ARRAY[1..3] OF INT;
  Level : INT := 9;
END_TYPE
PROGRAM p
  VAR_INPUT go : BOOL; ready : ARRAY[1..2] OF BOOL; END_VAR
  VAR CONSTANT last : INT := 2; END_VAR
  VAR RETAIN count : ARRAY[0..9] OF INT := [1, 2, 3(0), 5(7)]; END_VAR
  VAR
    motor : ARRAY[1..last] OF Motor := [(speed := 1.5), (ON := TRUE)];
    one : motor := (Limit := 4.0);
    table : ARRAY[0..1] OF Row := [[1, 2, 3], [4, 5, 6]];
    bits : ARRAY[-1..1, 0..3] OF WORD;
    level : ARRAY[0..4] OF Level := [2(1)];
    full : ARRAY[0..4] OF Level;
    own : STRUCT a : BOOL; b : INT; END_STRUCT;
    i : INT;
    share : Percent := 4;
    near : ARRAY[0..1] OF INT(LAST..7);
  END_VAR
  INITIAL_STEP Wait: END_STEP
  STEP Work: Turn(N); END_STEP
  TRANSITION FROM Wait TO Work := GO AND Ready[last]; END_TRANSITION
  TRANSITION FROM Work TO Wait := NOT Motor[2].ON AND bits[0, 3].5; END_TRANSITION
  ACTION Turn:
    FOR i := 1 TO LAST DO
      MOTOR[I].speed := motor[i].SPEED + one.limit;
      count[i + 1] := table[0][i] + TABLE[1, i];
    END_FOR;
    motor[1].Trip[i] := ready[i];
    one := motor[2];
    own.A := one.ON;
  END_ACTION
END_PROGRAM";
    let (document, problems) = import(text);
    let told: Vec<_> = problems.iter().map(|p| (p.code.id, &*p.what)).collect();
    assert_eq!(told, []);
    same(
        &document,
        "profile iec61131
         struct Motor {
           on : BOOL \"the contactor\"
           Speed : REAL := 2.5
           Limit : REAL := 2.5
           trip : ARRAY[0..1] OF BOOL
         }
         struct own_type {
           a : BOOL
           b : INT
         }
         input go : BOOL
         input ready : ARRAY[1..2] OF BOOL
         const last : INT := 2
         var count : ARRAY[0..9] OF INT := [1, 2, 3(0), 5(7)] retain
         var motor : ARRAY[1..last] OF Motor := [(Speed := 1.5), (on := TRUE)]
         var one : Motor := (Limit := 4.0)
         var table : ARRAY[0..1, 1..3] OF INT := [1, 2, 3, 4, 5, 6]
         var bits : ARRAY[-1..1, 0..3] OF WORD
         var level : ARRAY[0..4] OF INT := [2(1), 3(9)]
         var full : ARRAY[0..4] OF INT := [5(9)]
         var own : own_type
         var i : INT
         var share : INT(0..100) := 4
         var near : ARRAY[0..1] OF INT(last..7)
         chart p {
           initial step Wait
           step `Work` { N Turn }
           Wait -> `Work` when go and ready[last]
           `Work` -> Wait when not motor[2].on and bits[0, 3].5
           action Turn {
             FOR i := 1 TO last DO
               motor[i].Speed := motor[i].Speed + one.Limit
               count[i + 1] := table[0, i] + table[1, i]
             END_FOR
             motor[1].trip[i] := ready[i]
             one := motor[2]
             own.a := one.on
           }
         }",
    );
    assert_eq!(errors(&compile(&document).1), <[&str; 0]>::default());
}

#[test]
fn functions_have_limits_and_inputs_of_a_program_have_none() {
    let (document, problems) = import(
        "TYPE Share : INT (0..100) := 5; END_TYPE
         FUNCTION f : Share VAR_INPUT a : Share; END_VAR VAR b : Share; END_VAR f := a + b; END_FUNCTION
         PROGRAM p VAR_INPUT i : Share; END_VAR VAR_OUTPUT o : Share; END_VAR o := f(i); END_PROGRAM",
    );
    let told: Vec<_> = problems.iter().map(|p| &*p.what).collect();
    assert_eq!(told, ["the limits of the input `i` are not checked"]);
    let text = g7_syntax::print(&document, None);
    for part in [
        "output o : INT(0..100) := 5",
        "function f(a : INT(0..100)) : INT(0..100) {",
        "var b : INT(0..100) := 5",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let mut bench = crate::support::Bench::new(&document);
    assert_eq!(bench.set("i", 95).scan().get("o"), 100);
    assert!(bench.set("i", 96).try_scan().is_err());
}

#[test]
fn function_blocks_stay_what_they_are() {
    let (document, problems) = import(
        "FUNCTION_BLOCK Count
           VAR_INPUT up : BOOL; most : INT := 3; END_VAR
           VAR_OUTPUT full : BOOL; END_VAR
           VAR_IN_OUT sum : INT; END_VAR
           VAR n : INT; edge : R_TRIG; END_VAR
           VAR_TEMP before : INT; END_VAR
           edge(CLK := up);
           IF NOT edge.Q THEN RETURN; END_IF;
           before := n;
           N := before + 1; sum := SUM + 1;
           full := n >= most;
         END_FUNCTION_BLOCK
         FUNCTION_BLOCK Pair
           VAR_INPUT a : BOOL; END_VAR
           VAR one : COUNT; all : INT; END_VAR
           LD a
           ST one.UP
           CAL one(SUM := all)
         END_FUNCTION_BLOCK
         FUNCTION_BLOCK Unused VAR_INPUT a : BOOL; END_VAR a := FALSE; END_FUNCTION_BLOCK
         PROGRAM Main
           VAR_INPUT go : BOOL; END_VAR
           VAR_OUTPUT done : BOOL; END_VAR
           VAR c : Count := (MOST := 2); total : INT; p : ARRAY[1..4] OF pair; k : INT; END_VAR
           INITIAL_STEP A: Work(N); END_STEP
           STEP B: END_STEP
           TRANSITION FROM A TO B := c.FULL AND p[3].one.N >= 3; END_TRANSITION
           ACTION Work:
             C(Up := go, sum := total, FULL => done);
             P[1](a := go);
             FOR k := 2 TO 3 DO p[K + 1](A := done); END_FOR;
           END_ACTION
         END_PROGRAM",
    );
    let words: Vec<&str> = problems.iter().map(|p| &*p.what).collect();
    assert_eq!(words, ["the function block `Unused` is not used; it is left out"]);
    same(
        &document,
        "profile iec61131
         function block Count {
           input up : BOOL
           input most : INT := 3
           output full : BOOL
           inout sum : INT
           var n : INT
           var edge : R_TRIG
           body {
             var before : INT
             edge(CLK := up)
             IF not edge.Q THEN RETURN END_IF
             before := n
             n := before + 1
             sum := sum + 1
             full := n >= most
           }
         }
         function block Pair {
           input a : BOOL
           var one : Count
           var all : INT
           body {
             one.up := a
             one(sum := all)
           }
         }
         input go : BOOL
         output done : BOOL
         var c : Count := (most := 2)
         var total : INT
         var p : ARRAY[1..4] OF Pair
         var k : INT
         chart Main {
           initial step A { N `Work` }
           step B
           A -> B when c.full and p[3].one.n >= 3
           action `Work` {
             c(up := go, sum := total, full => done)
             p[1](a := go)
             FOR k := 2 TO 3 DO p[k + 1](a := done) END_FOR
           }
         }",
    );
    assert_eq!(errors(&compile(&document).1), <[&str; 0]>::default());
}

#[test]
fn a_type_that_contains_itself_is_refused() {
    for text in [
        "FUNCTION_BLOCK F VAR f : F; END_VAR f(); END_FUNCTION_BLOCK \
         PROGRAM p VAR f : F; END_VAR f(); END_PROGRAM",
        "TYPE s : STRUCT a : s; END_STRUCT; END_TYPE PROGRAM p VAR v : s; END_VAR v.a.a := v.a; END_PROGRAM",
    ] {
        let (document, _) = import(text);
        let (_, problems) = compile(&document);
        let found = errors(&problems);
        assert!(found.iter().any(|w| w.contains("of its own type")), "{text}: {found:?}");
    }
}

#[test]
fn what_has_no_counterpart_is_told_at_its_place() {
    let program = |vars: &str, body: &str| format!("PROGRAM p VAR {vars} END_VAR {body} END_PROGRAM");
    let block = "FUNCTION_BLOCK b VAR_INPUT x : BOOL; END_VAR x := NOT x; END_FUNCTION_BLOCK ";
    let action =
        "FUNCTION_BLOCK b VAR_INPUT x : BOOL; END_VAR ACTION more: x := TRUE; END_ACTION END_FUNCTION_BLOCK ";
    let (_, problems) = import(&format!("{action}{}", program("f : b;", "f();")));
    let what = "the action `more` of a unit without steps is left out";
    assert!(problems.iter().any(|p| &*p.what == what), "{problems:?}");
    let cases: [(String, &str); 6] = [
        (
            format!(
                "TYPE s : STRUCT x : INT; END_STRUCT := (x := 2); m : (Off, On); END_TYPE {}",
                program("v : s; w : m := On;", "v.x := w;")
            ),
            "initial values of a structure's or array's type are not carried over",
        ),
        (program("m : Missing;", "m.a := 1;"), "there is no type `Missing`"),
        (program("a : ARRAY[] OF INT;", ";"), "expected an expression, found `]`"),
        (
            format!("{block}{}", program("f : ARRAY[0..1] OF b; i : INT;", "f[i * 2](x := TRUE);")),
            "the index of a function block that is called is one number, a name, or a name with a number added",
        ),
        (
            format!(
                "FUNCTION_BLOCK b VAR x AT %QX0.0 : BOOL; END_VAR x := NOT x; END_FUNCTION_BLOCK {}",
                program("f : b;", "f();")
            ),
            "a variable of a function block has no address; `%QX0.0` is left out",
        ),
        (
            program("a : ARRAY[0..1] OF INT := (b := 1); c : INT := [1, 2];", "a[0] := c;"),
            "the initial values of `c` do not fit its type, or cannot be carried over",
        ),
    ];
    for (text, what) in cases {
        let (_, problems) = import(&text);
        let found = errors(&problems);
        assert!(found.contains(&what), "{text}: {found:?}");
    }
}

#[test]
fn an_array_of_instances_with_a_chart_is_a_chart_for_each() {
    let text = carried(
        "FUNCTION_BLOCK Feeder
           VAR_INPUT start : BOOL; END_VAR
           VAR_OUTPUT turning : BOOL; END_VAR
           INITIAL_STEP Rest: END_STEP
           STEP Run: turning(N); END_STEP
           TRANSITION FROM Rest TO Run := start; END_TRANSITION
           TRANSITION FROM Run TO Rest := NOT start; END_TRANSITION
         END_FUNCTION_BLOCK
         PROGRAM Main
           VAR go AT %IX0.0 : BOOL; lamp AT %QX0.0 : BOOL; feed : ARRAY[1..2] OF Feeder; END_VAR
           FEED[1](start := go, turning => lamp);
           feed[2](start := NOT go);
         END_PROGRAM",
    );
    for part in ["chart feed_1 {", "chart feed_2 {", "feed_1.start := go", "feed_2.start := not go"] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

#[test]
fn an_enumeration_becomes_a_type() {
    let text = carried(
        "TYPE
           Mode : (Off, Auto := 5, Hand) := Hand;
           Fault : INT (None := 1, Jam := -3);
         END_TYPE
         PROGRAM p
           VAR_INPUT go : BOOL; END_VAR
           VAR m : Mode; f : fault; all : ARRAY[1..2] OF Fault; END_VAR
           INITIAL_STEP A: Act(N); END_STEP
           STEP B: END_STEP
           TRANSITION FROM A TO B := m = Mode#AUTO; END_TRANSITION
           TRANSITION FROM B TO A := m = MODE.Off; END_TRANSITION
           ACTION Act: CASE m OF Off: f := Jam; Mode#Hand: f := NONE; END_CASE; END_ACTION
         END_PROGRAM",
    );
    for part in [
        "type Mode : (Off, Auto := 5, Hand) := Hand\n",
        "type Fault : (None := 1, Jam := -3)\n",
        "var m : Mode\n",
        "var f : Fault\n",
        "var all : ARRAY[1..2] OF Fault\n",
        "A -> B when m = Auto",
        "B -> A when m = Off",
        "Off:\n        f := Jam",
        "Hand:\n        f := None",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

#[test]
fn a_call_runs_while_en_is_true() {
    let text = carried(
        "FUNCTION_BLOCK Own VAR_INPUT EN, x : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR q := EN AND x; END_FUNCTION_BLOCK
         FUNCTION_BLOCK Pair VAR one : ARRAY[1..2] OF Own; t : TON; END_VAR one[1](EN := TRUE); END_FUNCTION_BLOCK
         PROGRAM p
           VAR_INPUT go, x : BOOL; END_VAR
           VAR t, u : TON; o : Own; two : Pair; ran : BOOL; END_VAR
           two.ONE[2](EN := go); two.t(EN := go); two();
           t(EN := go AND NOT x, IN := x, PT := T#1s, ENO => ran);
           IF go THEN u(IN := x, PT := T#2s, eno => ran); END_IF;
           o(EN := go, x := x);
         END_PROGRAM",
    );
    for part in [
        "IF go and not x THEN\n    t(IN := x, PT := 1s)\n    ran := TRUE\n  ELSE\n    ran := FALSE\n  END_IF",
        "IF TRUE THEN\n      u(IN := x, PT := 2s)\n      ran := TRUE",
        "o(EN := go, x := x)",
        "one[1](EN := TRUE)",
        "two.one[2](EN := go)",
        "IF go THEN\n    two.t()\n  END_IF",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

#[test]
fn a_wide_text_is_a_text_with_room_for_its_characters() {
    let text = "
PROGRAM p
  VAR a : WSTRING; b : WSTRING[20]; c : WSTRING(5) := \"é\"; d : STRING[20]; n : INT; END_VAR
  INITIAL_STEP Wait: Set(N); END_STEP
  TRANSITION FROM Wait TO Wait := n = 3; END_TRANSITION
  ACTION Set:
    b := STRING_TO_WSTRING(d);
    d := WSTRING_TO_STRING(b);
    n := WSTRING_TO_INT(a);
    c := b;
  END_ACTION
END_PROGRAM";
    let (document, problems) = import(text);
    assert_eq!(errors(&problems), Vec::<&str>::new());
    // Up to three bytes each (decision 68).
    let declared = document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(v.ty) } else { None });
    let lengths: Vec<Type> = declared.filter(|ty| matches!(ty, Type::String(_))).collect();
    assert_eq!(lengths, [240, 60, 15, 20].map(Type::String));
    assert_eq!(compile(&document).1, []);
}
