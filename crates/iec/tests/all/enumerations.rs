//! Enumerations of the file in written files: which of them stay, and how they stand there.

use g7_exchange::Dialect;
use g7_model::Document;

use crate::blocks::{document, has, project, text_of};

const MODE: &str = "profile iec61131
type Mode : (Off, Manual, Automatic)
type Colour : (Red, Green, Off) := Green
struct Lamp { colour : Colour  before : Colour := Red  lit : BOOL }
function block Choose {
  input wanted : Mode
  output given : Mode := Manual
  var last : Mode
  body { IF wanted <> Mode.Off THEN last := wanted END_IF given := last }
}
input wanted : Mode
input up : BOOL
output lit : BOOL
var mode : Mode := Automatic
var all : ARRAY[1..3] OF Mode
var i : INT := 1
var lamp : Lamp
var chosen : Mode
var choose : Choose
";

fn with(chart: &str) -> Document {
    document(&format!("{MODE}{chart}"))
}

const CHART: &str = "chart G {
  initial step 1 {
    each scan: {
      CASE mode OF
        Mode.Off: mode := Manual
        Manual, Automatic: mode := all[i]
      END_CASE
      choose(wanted := Automatic, given => chosen)
      choose(wanted := wanted)
      IF lamp.colour <> Colour.Off THEN lamp.before := lamp.colour END_IF
    }
  }
  1 -> 1 when choose.given = mode and up
}
post { lit := mode = Mode.Off or chosen <> Manual }
";

#[test]
fn an_enumeration_is_a_type_in_text() {
    let text = text_of(&with(CHART));
    let types = "TYPE
        Mode_2 : (Off, Manual, Automatic);
        Colour_2 : (Red, Green, Off_2);
        Lamp : STRUCT
        colour : Colour_2 := Green;
        before : Colour_2 := Red;
        lit : BOOL;
        END_STRUCT;
        Mode_2_1_3 : ARRAY[1..3] OF Mode_2;
        END_TYPE";
    assert!(has(&text, types), "{text}");
    for used in [
        "wanted : Mode_2 := Off;",
        "given : Mode_2 := Manual;",
        "mode : Mode_2 := Automatic;",
        "all : Mode_2_1_3;",
        "IF wanted <> Off THEN",
        "Manual, Automatic:",
        "mode := all[i];",
        "choose_2(wanted := Automatic);",
        "chosen := choose_2.given;",
        "choose_2(wanted := wanted);",
        "IF lamp_2.colour <> Off_2 THEN",
        "lamp_2.before := lamp_2.colour;",
        "choose_2.given = mode AND up",
        "lit := mode = Off OR chosen <> Manual;",
    ] {
        assert!(text.contains(used), "{used} in {text}");
    }
}

#[test]
fn an_enumeration_is_a_type_in_a_project() {
    let xml = project(&with(CHART), Dialect::Standard);
    let types = r#"<dataType name="Colour_2">
        <enum>
        <values>
        <value name="Red"/>
        <value name="Green"/>
        <value name="Off_2"/>"#;
    assert!(has(&xml, types), "{xml}");
    assert!(has(&xml, "<variable name=\"chosen\">\n<simpleValue value=\"Off\"/>"), "{xml}");
}

/// A variable of an enumeration may stand in a comparison, an assignment, a parameter or a CASE. If one stands anywhere else,
/// all variables of that enumeration are INT.
#[test]
fn other_uses_leave_numbers() {
    let uses = [
        "output n : INT\nchart G { initial step 1 { each scan: n := Mode_TO_INT(mode) } 1 -> 1 when up }\n",
        "chart G { initial step 1 { each scan: mode := SEL(up, Mode.Off, Manual) } 1 -> 1 when up }\n",
        "chart G { initial step 1 { each scan: mode := Manual  N lit if mode = Mode.Off } 1 -> 1 when up }\n",
        "chart G { initial step 1 { each scan: { CASE mode OF Mode.Off..Manual: mode := Automatic END_CASE } } 1 -> 1 when up }\n",
    ];
    for chart in uses {
        let text = text_of(&with(chart));
        assert!(text.contains("mode : INT := 2;"), "{text}");
        assert!(!text.contains("Manual"), "{text}");
    }
}

/// matiec ends at such a list.
#[test]
fn initial_values_of_an_array_stay_for_codesys_alone() {
    let text =
        MODE.replace("all : ARRAY[1..3] OF Mode", "all : ARRAY[1..3] OF Mode := [Manual, 2(Automatic)]");
    let document = document(&format!("{text}{CHART}"));
    let written = text_of(&document);
    assert!(written.contains("all : INT_1_3 := [1, 2, 2];"), "{written}");
    let xml = project(&document, Dialect::Codesys);
    let values = r#"<variable name="all">
        <arrayValue>
        <simpleValue value="Manual"/>
        <simpleValue value="Automatic"/>"#;
    assert!(has(&xml, values), "{xml}");
}

/// A PLC gives the values the numbers 0, 1, 2 …, so the values of an enumeration with other numbers are written as numbers.
#[test]
fn other_numbers_stay_numbers() {
    let text = MODE.replace("Automatic)", "Automatic := 5)");
    let text = text_of(&document(&format!("{text}{CHART}")));
    assert!(text.contains("mode : INT := 5;") && text.contains("1, 5:"), "{text}");
    assert!(text.contains("Colour_2 : (Red, Green, Off);"), "{text}");
}

/// Compilers know the name of a value everywhere, so nothing else has it.
#[test]
fn names_of_values_are_those_of_nothing_else() {
    let text = "profile iec61131
type Mode : (Off, Manual, Automatic)
var mode : Mode
input Manual : BOOL
chart G { var automatic : BOOL  initial step Off { each scan: mode := Mode.Manual } Off -> Off when automatic and Manual }
";
    let text = text_of(&document(text));
    assert!(text.contains("(Off_2, Manual_2, Automatic_2)"), "{text}");
    assert!(text.contains("mode := Manual_2;") && text.contains("automatic AND Manual"), "{text}");
}

#[test]
fn matiec_takes_enumerations() {
    let Some(matiec) = g7_peers::matiec() else { return };
    let text = text_of(&with(CHART));
    assert_eq!(crate::sfc::written::compile(&matiec, &text), Ok(()), "{text}");
}

const NEXT: &str = "function Next(m : Mode, way : BOOL) : Mode {
  var other : Mode := Manual
  CASE m OF
    Mode.Off: Next := other
    Manual: Next := Automatic
  END_CASE
}
";

const CALLS: &str = "chart G {
  initial step 1 {
    each scan: {
      mode := Next(mode, up)
      IF Next(m := Automatic, way := up) = Manual THEN i := 2 END_IF
      chosen := Next(Next(Mode.Off, up), up)
    }
  }
  1 -> 1 when Next(chosen, up) <> mode
}
";

/// A function takes and gives the type.
#[test]
fn functions_take_and_give_enumerations() {
    let text = text_of(&with(&format!("{NEXT}{CALLS}")));
    for line in [
        "FUNCTION Next : Mode_2",
        "m : Mode_2;",
        "other : Mode_2 := Manual;",
        "Next := other;",
        "Next := Automatic;",
        "mode := Next(mode, up);",
        "IF Next(m := Automatic, way := up) = Manual THEN",
        "chosen := Next(Next(Off, up), up);",
        "Next(chosen, up) <> mode",
    ] {
        assert!(text.contains(line), "{line} in {text}");
    }
    let xml = project(&with(&format!("{NEXT}{CALLS}")), Dialect::Standard);
    assert!(has(&xml, "<returnType>\n<derived name=\"Mode_2\"/>"), "{xml}");
    if let Some(matiec) = g7_peers::matiec() {
        assert_eq!(crate::sfc::written::compile(&matiec, &text), Ok(()), "{text}");
    }
}

/// Where another use makes numbers of the enumeration, a function takes and gives these.
#[test]
fn functions_take_and_give_numbers_of_others() {
    let text = text_of(&with(&format!(
        "{NEXT}output n : INT\nchart G {{ initial step 1 {{ each scan: n := Mode_TO_INT(Next(mode, up)) }} 1 -> 1 when up }}\n"
    )));
    for line in
        ["FUNCTION Next : INT", "other : INT := 1;", "Next := 2;", "n := Next(mode, up);", "mode : INT := 2;"]
    {
        assert!(text.contains(line), "{line} in {text}");
    }
}
