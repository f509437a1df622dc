//! Programs of a configuration: their parameters, and programs that run more than once (IEC 61131-3:2003, 2.7.1).

use crate::sfc::carried::same;
use crate::sfc::{carried, errors, import};

const COUNT: &str = "PROGRAM Count VAR_INPUT Inc : INT; Go : BOOL; END_VAR VAR_OUTPUT Sum : INT; END_VAR \
     IF Go THEN Sum := Sum + Inc; END_IF; END_PROGRAM ";

/// A configuration with these global variables and programs.
fn configuration(globals: &str, programs: &str) -> String {
    format!(
        "CONFIGURATION C VAR_GLOBAL {globals} END_VAR RESOURCE R ON PLC \
         TASK t(INTERVAL := T#10ms, PRIORITY := 0); {programs} END_RESOURCE END_CONFIGURATION"
    )
}

#[test]
fn parameters_are_copied_before_and_behind_each_run() {
    let programs = "PROGRAM first WITH t : Count(Inc := 1, Go := Go, Sum => One); \
                    PROGRAM second WITH t : Count(Inc := One, Go := TRUE, Sum => Two);";
    let text = format!("{COUNT}{}", configuration("Go AT %IX0.0 : BOOL; One : INT; Two : INT;", programs));
    let (document, problems) = import(&text);
    assert_eq!(errors(&problems), <[&str; 0]>::default());
    // The parameter `Go` of `first` gets another name, so that it does not hide the global variable `Go`.
    same(
        &document,
        "profile iec61131
         scan 10ms
         input Go : BOOL at %IX0.0
         var One : INT
         var Two : INT
         var Inc : INT
         var Go_2 : BOOL
         var Sum : INT
         pre {
           Inc := 1
           Go_2 := Go
           IF Go_2 THEN Sum := Sum + Inc END_IF
           One := Sum
         }
         chart second {
           var Inc : INT
           var Go : BOOL
           var Sum : INT
           pre {
             Inc := One
             Go := TRUE
             IF Go THEN Sum := Sum + Inc END_IF
             Two := Sum
           }
         }",
    );
}

#[test]
fn parameters_of_a_chart_are_copied_around_its_evolution() {
    let text = carried(&format!(
        "PROGRAM Blink VAR_INPUT Go : BOOL; END_VAR VAR_OUTPUT Lamp : BOOL; END_VAR INITIAL_STEP A: END_STEP \
         STEP B: Lamp(N); END_STEP TRANSITION FROM A TO B := Go; END_TRANSITION \
         TRANSITION FROM B TO A := NOT Go; END_TRANSITION END_PROGRAM {}",
        configuration(
            "Go : BOOL; Left : BOOL; Lamp : BOOL;",
            "PROGRAM one WITH t : Blink(Go := Go, Lamp => Left); PROGRAM two WITH t : Blink(Go := Left, Lamp => Lamp);"
        )
    ));
    for line in [
        "chart one {",
        "  pre { Go_2 := Go }",
        "  post { Left := Lamp }",
        "chart two {",
        "  step B { N Lamp_2 }",
        "  A -> B when Go",
        "  pre { Go := Left }",
        "  post { Lamp := Lamp_2 }",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
}

#[test]
fn an_address_stays_one_beside_other_parameters() {
    let programs = "PROGRAM p WITH t : Count(Inc := 2, Go := %IX0.1, Sum => %QW3);";
    let text = carried(&format!("{COUNT}{}", configuration("x : INT;", programs)));
    assert!(
        text.contains("input Go : BOOL at %IX0.1") && text.contains("output Sum : INT at %QW3"),
        "{text}"
    );
    assert!(text.contains("Inc := 2"), "{text}");
}

#[test]
fn what_cannot_be_connected_is_told() {
    let of = |programs: &str, body: &str| {
        let program =
            format!("PROGRAM p VAR_OUTPUT q : INT; END_VAR VAR own : INT; END_VAR {body} END_PROGRAM ");
        let (_, problems) = import(&format!("{program}{}", configuration("g : INT;", programs)));
        errors(&problems).into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    let address = "a variable of a program stands at an address; other values have no counterpart";
    assert_eq!(of("PROGRAM a WITH t : p(q => 3);", "q := 1;"), [address]);
    assert_eq!(of("PROGRAM a WITH t : p(own := g);", "q := 1;"), [address]);
    assert_eq!(of("PROGRAM a WITH t : p(z := g);", "q := 1;"), ["the program has no variable `z`"]);
    assert_eq!(
        of("PROGRAM a WITH t : p(q => g);", "IF own > 0 THEN RETURN; END_IF; q := 1;"),
        ["RETURN in a program whose outputs the configuration connects: they would not be copied"]
    );
}

#[test]
fn programs_without_end_are_bounded() {
    let run = |n: usize| format!("PROGRAM p{n} WITH t : Count(Inc := 1);\n");
    let programs: String = (0..3_000).map(run).collect();
    let (_, problems) = import(&format!("{COUNT}{}", configuration("g : INT;", &programs)));
    assert!(errors(&problems).contains(&"more programs run than are read"), "{:?}", errors(&problems));
}

#[test]
fn a_program_in_two_resources_has_the_variables_of_each() {
    let program =
        "PROGRAM p VAR_INPUT inc : INT; END_VAR VAR_EXTERNAL n : INT; END_VAR n := n + inc; END_PROGRAM ";
    let resource = |name: &str, inc: &str| {
        format!(
            "RESOURCE {name} ON PLC VAR_GLOBAL n : INT; END_VAR TASK t(INTERVAL := T#10ms); \
             PROGRAM run WITH t : p(inc := {inc}); END_RESOURCE "
        )
    };
    let text =
        format!("{program}CONFIGURATION C {}{}END_CONFIGURATION", resource("R", "1"), resource("S", "2"));
    let (document, problems) = import(&text);
    assert_eq!(errors(&problems), <[&str; 0]>::default());
    let text = g7_syntax::print(&document, None);
    assert!(
        text.contains("inc := 1\n  n := n + inc") && text.contains("inc := 2\n    S_n := S_n + inc"),
        "{text}"
    );
}
