//! Structures of the file in written files: which variables stay one variable, and how they stand there.

use g7_exchange::Dialect;
use g7_model::Document;

use crate::blocks::{document, has, project, text_of};

const MOTOR: &str = "profile iec61131
struct Gear { ratio : REAL := 1.5  teeth : ARRAY[1..2] OF INT := [3, 4] }
struct Motor \"a motor\" { speed : REAL \"in rpm\"  running : BOOL  gear : Gear }
";

fn with(text: &str) -> Document {
    document(&format!("{MOTOR}{text}"))
}

const CHART: &str = "chart G {
  initial step 1 {
    each scan: {
      m.speed := m.speed + i
      line[i].speed := line[i].speed + m.gear.ratio
      line[i].gear.teeth[i + 1] := 7
      line[2] := m
    }
  }
  step 2 { each scan: m.gear.teeth := m.gear.teeth }
  1 -> 2 when line[1].speed > 9 and m.running
  2 -> 1 when not m.running
}
";

const LINE: &str = "var m : Motor \"at the gate\"
var line : ARRAY[1..3] OF Motor
var i : INT := 1
";

/// The same with initial values.
const WITH_VALUES: &str = "var m : Motor := (speed := 3, gear := (ratio := 2.5))
var line : ARRAY[1..3] OF Motor := [(speed := 5), (gear := (teeth := [1])), (speed := 7)]
var i : INT := 1
";

#[test]
fn a_structure_is_a_type_in_text() {
    let text = text_of(&with(&format!("{LINE}{CHART}")));
    let types = "TYPE
        INT_1_2 : ARRAY[1..2] OF INT;
        Gear : STRUCT
        ratio : REAL := 1.5;
        teeth : INT_1_2 := [3, 4];
        END_STRUCT;
        Motor : STRUCT (* a motor *)
        speed : REAL; (* in rpm *)
        running : BOOL;
        gear : Gear;
        END_STRUCT;
        Motor_1_3 : ARRAY[1..3] OF Motor;
        END_TYPE";
    assert!(has(&text, types), "{text}");
    assert!(
        has(&text, "VAR\nm : Motor; (* at the gate *)\nline : Motor_1_3;\ni : INT := 1;\nEND_VAR"),
        "{text}"
    );
    for used in [
        "m.speed := m.speed + INT_TO_REAL(i);",
        "line[i].speed := line[i].speed + m.gear.ratio;",
        "line[i].gear.teeth[i + 1] := 7;",
        "line[2].gear.ratio := m.gear.ratio;",
        "m.gear.teeth := m.gear.teeth;",
        "line[1].speed > 9.0 AND m.running;",
    ] {
        assert!(text.contains(used), "{used} in {text}");
    }
}

#[test]
fn a_structure_is_a_type_in_a_project() {
    let xml = project(&with(&format!("{LINE}{CHART}")), Dialect::Standard);
    let types = r#"<dataType name="Gear">
        <struct>
        <variable name="ratio">
        <REAL/>
        <simpleValue value="1.5"/>
        <variable name="teeth">
        <derived name="INT_1_2"/>
        <arrayValue>
        <simpleValue value="3"/>
        <dataType name="Motor">
        <variable name="gear">
        <derived name="Gear"/>
        <dataType name="Motor_1_3">
        <dimension lower="1" upper="3"/>
        <baseType>
        <derived name="Motor"/>"#;
    assert!(has(&xml, types), "{xml}");
    assert!(has(&xml, "<variable name=\"line\">\n<derived name=\"Motor_1_3\"/>"), "{xml}");
}

/// matiec knows no initial values of a variable with a structure but that of its first member.
#[test]
fn initial_values_of_a_variable_stay_for_codesys_alone() {
    let document = with(&format!("{WITH_VALUES}{CHART}"));
    let xml = project(&document, Dialect::Codesys);
    let values = r#"<variable name="m">
        <derived name="Motor"/>
        <structValue>
        <value member="speed">
        <simpleValue value="3.0"/>
        <value member="gear">
        <structValue>
        <value member="ratio">
        <simpleValue value="2.5"/>
        <variable name="line">
        <arrayValue>
        <value>
        <value member="speed">
        <simpleValue value="5.0"/>
        <value>
        <value member="gear">
        <value member="teeth">
        <arrayValue>
        <simpleValue value="1"/>
        <simpleValue value="0"/>
        <value>
        <value member="speed">
        <simpleValue value="7.0"/>"#;
    assert!(has(&xml, values), "{xml}");
    let text = text_of(&document);
    assert!(
        has(&text, "m_speed : REAL := 3.0; (* in rpm *)\nm_running : BOOL;\nm_gear_ratio : REAL := 2.5;"),
        "{text}"
    );
    assert!(text.contains("line_speed[i] := line_speed[i] + m_gear_ratio;"), "{text}");
    assert!(!text.contains("STRUCT"), "{text}");
}

/// The association of an action names a variable of the program, and no member of one (2.6.4.3).
#[test]
fn a_variable_of_which_a_step_drives_a_member_is_taken_apart() {
    let chart = "chart G { initial step 1 { N m.running } step 2 { S line[2].running } 1 -> 2 when free.running  2 -> 1 when line[i].running }\n";
    let text = text_of(&with(&format!("{LINE}var free : Motor\n{chart}")));
    assert!(text.contains("m_running(N);") && text.contains("line_2_running(S);"), "{text}");
    assert!(text.contains("line_running[2] := line_2_running;"), "{text}");
    assert!(text.contains("free : Motor;") && text.contains(":= free.running;"), "{text}");
    assert!(!text.contains(": Motor_1_3"), "{text}");
}

#[test]
fn a_member_of_all_elements_at_once_takes_an_array_apart() {
    let chart = "chart G { initial step 1 { each scan: line := other  each scan: line[i].speed := 3 } 1 -> 1 when line[i].running }\n";
    let line = LINE.replace("var m : Motor \"at the gate\"\n", "");
    let text = text_of(&with(&format!("{line}var other : ARRAY[1..3] OF Motor\n{chart}")));
    assert!(text.contains("line_speed := other_speed;") && text.contains("line_speed[i] := 3.0;"), "{text}");
    assert!(!text.contains("STRUCT"), "{text}");
}

#[test]
fn a_structure_that_matiec_cannot_hold_is_taken_apart() {
    let named = "struct Part { name : STRING[12] number : INT }\nvar p : Part\nconst c : Motor := (speed := 4)\ninput a : BOOL\n";
    let chart = "chart G { initial step 1 { each scan: p.number := p.number + 1 each scan: m.speed := c.speed } 1 -> 1 when a }\n";
    let document = with(&format!("{LINE}{named}{chart}"));
    let text = text_of(&document);
    assert!(text.contains("p_name : STRING[12];") && text.contains("p_number := p_number + 1;"), "{text}");
    assert!(text.contains("m.speed := c_speed;"), "{text}");
    let xml = project(&document, Dialect::Codesys);
    assert!(xml.contains("p.number := p.number + 1;"), "{xml}");
}

#[test]
fn variables_of_other_programs_and_of_function_blocks_stay_too() {
    let text = "input a : BOOL
output x : REAL
function block Sum {
  input up : BOOL
  output total : REAL
  var all : Motor
  body { IF up THEN all.speed := all.speed + 1 END_IF total := all.speed * all.gear.ratio }
}
var sum : Sum
chart Mover { var own : Motor  initial step 1 { each scan: own.speed := own.speed + 1 each scan: sum(up := a) } 1 -> 1 when a }
chart B { initial step 1 { each scan: x := Mover.own.speed * 1.5 + sum.total } 1 -> 1 when Mover.own.running }
";
    let document = with(text);
    let written = text_of(&document);
    assert!(
        has(&written, "FUNCTION_BLOCK Sum\nVAR\nall : Motor;\nEND_VAR\nall.speed := all.speed + 1.0;"),
        "{written}"
    );
    assert!(has(&written, "own : Motor;\nown.speed := own.speed + 1.0;"), "{written}");
    let xml = project(&document, Dialect::Codesys);
    assert!(xml.contains("x := Mover.own.speed * 1.5 + sum_2.total;"), "{xml}");
}

/// All conditions of actions are evaluated before all bodies, so they read copies of what these change.
#[test]
fn a_copy_of_a_member_of_all_elements_takes_an_array_apart() {
    let chart = "output lamp : BOOL
chart G {
  initial step 1 { N lamp if m.running and line[1].running  each scan: { line[i].running := TRUE  m.running := FALSE } }
  1 -> 1 when line[2].running
}
";
    let text = text_of(&with(&format!("{LINE}{chart}")));
    assert!(text.contains("line_running_before := line_running;"), "{text}");
    assert!(text.contains("m_running_before := m.running;"), "{text}");
    assert!(!text.contains(": Motor_1_3"), "{text}");
}

/// Names that the standard does not have are changed in the type and at each use.
#[test]
fn names_of_members_are_changed_everywhere() {
    let text = "struct Zähler { on : BOOL  größe : INT  Größe : INT }
var z : Zähler
chart G { initial step 1 { each scan: z.größe := z.größe + z.Größe } 1 -> 1 when z.on }
";
    let document = document(&format!("profile iec61131\n{text}"));
    let written = text_of(&document);
    assert!(has(&written, "on_2 : BOOL;\ngrosse : INT;\nGrosse_2 : INT;"), "{written}");
    assert!(
        written.contains("z.grosse := z.grosse + z.Grosse_2;") && written.contains(":= z.on_2;"),
        "{written}"
    );
    assert!(written.contains("z : Zahler;"), "{written}");
}

/// The types and variables of these tests are what matiec takes.
#[test]
fn matiec_takes_structures() {
    let Some(matiec) = g7_peers::matiec() else { return };
    for values in [LINE, WITH_VALUES] {
        let text = text_of(&with(&format!("{values}{CHART}")));
        assert_eq!(crate::sfc::written::compile(&matiec, &text), Ok(()), "{text}");
    }
}
