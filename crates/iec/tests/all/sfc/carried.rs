//! The constructs that are carried over, and their forms.

use crate::support::recognise;
use g7_model::FileId;

use crate::sfc::{carried, errors, file, import};

/// Parses the expected text: spellings of the printer do not matter.
#[track_caller]
pub(super) fn same(document: &g7_model::Document, expected: &str) {
    let (expected, problems) = g7_syntax::parse(expected, FileId(1));
    assert_eq!(problems, []);
    assert_eq!(g7_syntax::print(document, None), g7_syntax::print(&expected, None));
}

#[test]
fn a_program_with_everything() {
    let (document, problems) = import(&file("press.st"));
    assert_eq!(errors(&problems), <[&str; 0]>::default());
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert!(problems[0].what.contains("indicator variable"));
    same(
        &document,
        "profile iec61131
         scan 20ms
         input start : BOOL at %IX0.0 \"both buttons\"
         input door : BOOL \"both buttons\"
         input Depth : INT
         output ram : BOOL at %QX0.0
         output Lamp : BOOL
         var strokes : DINT := 0 \"since the last oil\"
         input top : BOOL at %IX0.3
         output oil : BOOL at %QX1.0
         const LIMIT_OF : INT := 100
         var total : UDINT := 1000 retain
         chart Press {
           initial step Rest { N Lamp }
           step Down { S ram  P1 Count  L 1.5s Lamp  D 2s oil }
           step Up { R ram  SL 500ms oil }
           go: Rest -> Down when start and not door priority 2
           Down -> Up when Depth >= LIMIT_OF or Down.t > 3s
           Up -> Rest when top and not (door and start)
           action Count {
             strokes := strokes + 1
             IF strokes mod 10 = 0 THEN total := total + UDINT#1
             ELSIF door THEN strokes := ABS(strokes) END_IF
           }
         }",
    );
    let (_, problems) = g7_compile::compile(&document);
    assert_eq!(errors(&problems), <[&str; 0]>::default());
}

#[test]
fn structures_arrays_enumerations_and_functions() {
    let (document, problems) = import(&file("fork.st"));
    assert_eq!(problems, []);
    same(
        &document,
        "profile iec61131
         type Colour : (Red, Green, Blue) := Green
         struct Pair {
           a : INT
           b : INT
         }
         input go : BOOL
         output done : BOOL
         var c : Colour
         var p : Pair := (a := 1, b := 2)
         var v : ARRAY[1..3] OF INT := [5, 2(7)]
         function Twice(n : INT) : INT { Twice := n * 2 }
         chart Fork {
           initial step S0
           step A { N Work }
           step B
           S0 -> (A, B) when go
           (A, B) -> S0 when c = Blue
           action Work {
             p.b := Twice(p.a + v[2])
             IF go THEN c := Blue END_IF
             done := c = Blue
           }
         }",
    );
    let (_, problems) = g7_compile::compile(&document);
    assert_eq!(errors(&problems), <[&str; 0]>::default());
}

#[test]
fn several_programs_have_their_own_pace() {
    let (document, problems) = import(&file("two.st"));
    assert_eq!(problems, []);
    same(
        &document,
        "profile iec61131
         scan 10ms
         var full : BOOL
         chart Feed {
           var n : INT at %MW1
           initial step Wait
           step Give { P More }
           Wait -> Give when not full
           Give -> Wait when full
           action More { n := n + 1 }
         }
         chart Drain every 50ms {
           initial step Wait
           step Take { R full }
           Wait -> Take when full
           Take -> Wait when not full and Take.t >= 1s
         }",
    );
}

#[test]
fn names_have_the_letters_of_their_declaration() {
    let text = carried(
        "PROGRAM p VAR Init : BOOL; END_VAR INITIAL_STEP INIT: END_STEP STEP On: END_STEP \
         TRANSITION FROM init TO ON := INIT; END_TRANSITION \
         TRANSITION FROM on TO Init := init.x AND ON.t > T#1s; END_TRANSITION END_PROGRAM",
    );
    // A step and a variable of one name: `.X` and `.t` are of the step.
    assert!(text.contains("`INIT` -> On when Init\n"), "{text}");
    assert!(text.contains("On -> `INIT` when INIT.X and On.t > 1s"), "{text}");
}

#[test]
fn a_list_before_a_name_stays_where_the_name_alone_is_another_variable() {
    let text = carried(
        "VAR_GLOBAL n : INT; m : INT; END_VAR FUNCTION_BLOCK b VAR n : INT; END_VAR n := 1; GVL.n := 2; GVL.m := 3; \
         END_FUNCTION_BLOCK PROGRAM p VAR x : b; END_VAR x(); END_PROGRAM",
    );
    // The compiler does not know `GVL.n`, which is better than a value in the wrong variable.
    assert!(text.contains("n := 1\n    GVL.n := 2\n    m := 3"), "{text}");
}

#[test]
fn a_number_as_a_condition_is_told() {
    let (document, problems) = import(
        "PROGRAM p VAR n : INT; END_VAR INITIAL_STEP A: END_STEP STEP B: END_STEP \
         TRANSITION FROM A TO B := n; END_TRANSITION END_PROGRAM",
    );
    assert!(problems.iter().any(|p| p.code.id == "G0614" && p.what.contains("compared with 0")));
    assert!(g7_syntax::print(&document, None).contains("A -> B when n <> 0"));
}

#[test]
fn dialects_are_read() {
    let text = carried(
        "(* outer (* inner *) *) {attribute 'x'}\nPROGRAM p\nVAR a, b : BOOL; n : INT; END_VAR\n\
         INITIAL_STEP A\n : X(N);\nEND_STEP\n\
         ACTION X\n a := b := TRUE; n := ADD(n, 2, 3); a S= b; IF GT(3, n, 1) & a THEN n := 16#F; END_IF; END_ACTION\n\
         END_PROGRAM",
    );
    for part in
        ["b := TRUE", "a := b", "n := n + 2 + 3", "IF b THEN\n      a := TRUE", "3 > n and n > 1 and a"]
    {
        assert!(text.contains(part), "{part} in {text}");
    }
}

#[test]
fn a_file_is_known_by_its_content_and_its_name() {
    let is = |name: &str, text: &str| recognise(name, text.as_bytes()) == Some("sfc");
    assert!(is("", "(* x *) PROGRAM a END_PROGRAM"));
    assert!(is("", "function_block F END_FUNCTION_BLOCK"));
    assert!(is("", "FUNCTION f : INT END_FUNCTION"));
    assert!(is("chart.SFC", "whatever"));
    assert!(!is("", "function Full(n : INT) : BOOL { Full := TRUE }"));
    assert!(!is("", "chart G { initial step 1 }"));
    assert!(!is("x.g7", "PROGRAM a END_PROGRAM"));
}

#[test]
fn a_program_without_steps_runs_before_the_charts() {
    let text = carried("PROGRAM p VAR n : INT; END_VAR n := n + 1; END_PROGRAM");
    assert!(text.contains("pre {"), "{text}");
}

/// Beremiz and OpenPLC: the ways of a list meet at a label with their result.
#[test]
fn a_result_is_carried_across_a_label() {
    let text = carried(
        "PROGRAM p VAR reset : BOOL; cnt, out : INT; END_VAR
         LD reset
         JMPC l
         LD cnt
         ADD 1
         JMP q
         l: LD 5
         q:
         ST cnt
         ST out
         END_PROGRAM",
    );
    for part in ["cnt := cnt + 1", "cnt := 5", "out := cnt"] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

#[test]
fn a_function_block_alone_runs_as_a_program() {
    let block = "FUNCTION_BLOCK b VAR n : INT; END_VAR n := n + 1; END_FUNCTION_BLOCK ";
    assert_eq!(carried(block), carried("PROGRAM b VAR n : INT; END_VAR n := n + 1; END_PROGRAM"));
    // Beside another unit nothing says that it runs.
    let (document, problems) =
        import(&format!("{block} PROGRAM p VAR m : INT; END_VAR m := m + 1; END_PROGRAM"));
    assert!(problems.iter().any(|p| p.code.id == "G0605" && p.what.contains("`b`")), "{problems:?}");
    assert!(!g7_syntax::print(&document, None).contains("n + 1"));
}

#[test]
fn a_list_with_a_loop_is_read_as_one() {
    let text = carried(
        "FUNCTION_BLOCK b VAR_INPUT x : BOOL; END_VAR VAR q : BOOL; i : INT; END_VAR
         LD x
         S q
         LD 0
         ST i
         again:
         LD i
         ADD 1
         ST i
         LD i
         GE 3
         OR x
         JMPCN again
         LD q
         R q
         END_FUNCTION_BLOCK",
    );
    let same = "PROGRAM b VAR_INPUT x : BOOL; END_VAR VAR q : BOOL; i : INT; END_VAR
         IF x THEN q := TRUE; END_IF;
         i := 0;
         REPEAT i := i + 1; UNTIL i >= 3 OR x END_REPEAT;
         IF q THEN q := FALSE; END_IF;
         END_PROGRAM";
    assert_eq!(text, carried(same));
}

#[test]
fn a_part_that_cannot_be_read_does_not_block_the_rest() {
    let text = "PROGRAM P
VAR a, b : BOOL; END_VAR
INITIAL_STEP S0: b(N); END_STEP
STEP 7x: b(N); END_STEP
STEP S1: END_STEP
TRANSITION FROM S0 TO S1 := ) a; END_TRANSITION
ACTION 8y: b := a; END_ACTION
TRANSITION FROM S1 TO S0 := a; END_TRANSITION
END_PROGRAM
";
    let (document, problems) = import(text);
    let line = |at: u32| text[..at as usize].matches('\n').count() + 1;
    let told: std::collections::BTreeSet<usize> = problems.iter().map(|p| line(p.at.start)).collect();
    assert_eq!(told.into_iter().collect::<Vec<_>>(), [4, 6, 7], "{problems:?}");
    let chart = document.charts().next().expect("a chart");
    let steps: Vec<&str> = chart.steps().map(|s| &*s.name.text).collect();
    assert_eq!((steps, chart.transitions().count()), (vec!["S0", "S1"], 2));
}

#[test]
fn a_list_may_begin_with_an_input_of_a_block() {
    let text = "PROGRAM P
VAR c : CTU; a, b : BOOL; END_VAR
INITIAL_STEP S0: Act(N); END_STEP
ACTION Act:
  CU c
  LD a
  ST b
END_ACTION
END_PROGRAM
";
    let list = text.replace("  CU c\n", "  LD a\n  ST b\n  CU c\n");
    let said = |text: &str| import(text).1.into_iter().map(|p| p.what.to_string()).collect::<Vec<_>>();
    assert!(!said(text).iter().any(|w| w.starts_with("expected")), "{:?}", said(text));
    assert_eq!(said(&list), Vec::<String>::new());
    let back = g7_syntax::print(&import(text).0, None);
    assert!(back.contains("b := a"), "{back}");
}
