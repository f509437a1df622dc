//! The meaning of each file, written as the same chart in G7's own text.

use g7_model::{Item, Placed};

use crate::plcopen::show::{bytes, compiles, document, errors, import, places, text};

/// The file means this, and runs.
fn means(name: &str, expected: &str) -> Vec<String> {
    let (found, problems) = import(name);
    assert_eq!(errors(&problems), Vec::<&str>::new(), "{name}");
    assert_eq!(text(&found), text(&document(expected)), "{name}");
    compiles(&found);
    places(&bytes(name), &problems)
}

#[test]
fn branches_actions_and_conditions_of_a_chart() {
    let problems = means(
        "press.xml",
        r#"
profile iec61131
scan 20ms
input Start : BOOL "green button"
input Parts : INT
output Lamp : BOOL
input Upper : BOOL at %IX0.1
input Lower : BOOL at %IX0.2
output Valve : BOOL at %QX0.0
output Motor : BOOL at %QX0.1
var Count : INT := -3
var Speed : REAL := 2.0
var Pause : TIME := 1500ms
var Title : STRING(20) := 'press'
var Total : DINT retain
const Most : INT := 10
chart Press "drawn by hand" {
  initial step Init "at rest"
  step Press {
    N Valve
    S Motor
    R Lamp
    L 2s Tell
    P1 Total := Total + 1
    P0 { Count := 0; Speed := 0.5 }
  }
  step Wait { D (Pause) Lamp  P Keep }
  step Lift { SD 10ms Valve  R Motor }
  step Test { DS 20ms Lamp }
  Init -> (Press, Wait) when Start and Upper priority 1
  lamp_test: Init -> Test when Start and not Upper priority 2
  (Press, Wait) -> Lift when Lower and Wait.t >= Pause
  Lift -> Init when Upper and not Start or rise(Lower)
  Test -> Init when not (Count > Parts)
  action Tell { Count := Count + 1; IF Count > Most THEN Lamp := TRUE END_IF }
  action Keep { IF not Upper THEN Lamp := TRUE END_IF }
}
"#,
    );
    assert_eq!(problems, Vec::<String>::new());
}

#[test]
fn places_are_those_of_the_drawing() {
    let (found, _) = import("press.xml");
    let layout = found.items.iter().find_map(|i| if let Item::Layout(l) = i { Some(l) } else { None });
    let places = &layout.expect("the file has places").places;
    // The middle of the upper side: 100 + 60 / 2, ten hundredths of a unit a pixel.
    let init = places.iter().find(|p| matches!(&p.what, Placed::Step(n) if &*n.text == "Init")).unwrap();
    assert_eq!((init.x, init.y), (1300, 100));
    // The first transition is that of the left branch: 120 + 20 / 2.
    let first = places.iter().find(|p| matches!(p.what, Placed::TransitionNumber(0))).unwrap();
    assert_eq!((first.x, first.y), (1300, 800));
}

#[test]
fn blocks_of_the_file_become_charts_and_statements() {
    let problems = means(
        "blocks.xml",
        r#"
profile iec61131 { no-final-scan }
function block Adder {
  input A : INT
  input B : INT
  output S : INT
  body { S := A + B }
}
input Go : BOOL at %IX0.0
input Safe : BOOL at %IX0.1
output Turn : BOOL at %QX0.0
var Sum : Adder
var Result : INT
pre {
  Second.Called := FALSE
  Sum(Result, 3)
  Result := Sum.S
  Feeder.Start := Go
  Turn := Feeder.Turning
  IF Safe THEN
    Second.Start := Go
    Second.Called := TRUE
  END_IF
}
chart Feeder {
  var Start : BOOL
  var Turning : BOOL
  var SFCReset : BOOL
  initial step Rest
  step Run { N Run_active }
  Rest -> Run when Start
  Run -> Rest when not Start
  action Run_active { Turning := TRUE }
  pre { IF SFCReset THEN INITCHART(Feeder) END_IF }
}
chart Second {
  var Start : BOOL
  var Turning : BOOL
  var SFCReset : BOOL
  var Called : BOOL
  initial step Rest
  step Run { N Run_active }
  Rest -> Run when Called and Start
  Run -> Rest when Called and not Start
  action Run_active { IF Called THEN Turning := TRUE END_IF }
  pre { IF SFCReset THEN INITCHART(Second) END_IF }
}
"#,
    );
    // A block without use; one that is called on a condition; a value that is read
    // before the chart that gives it has evolved.
    assert_eq!(problems, ["G0614 17", "G0614 24", "G0605 39"]);
}

#[test]
fn networks_become_statements_in_their_order() {
    let problems = means(
        "networks.xml",
        r#"
profile iec61131
scan 50ms
input a : BOOL at %IX1.0
input b : BOOL at %IX1.1
input n : INT at %IW2
output q : BOOL at %QX1.0
output late : BOOL at %QX1.1
var level : REAL
var count : INT
var timer : TON
input c : BOOL at %IX3.0
input d : BOOL at %IX3.1
output out : BOOL at %QX3.0
output not_out : BOOL at %QX3.1
output kept : BOOL at %QX3.2
function Mean(A : INT, B : INT) : REAL {
  var Two : REAL := 2.0
  Mean := INT_TO_REAL(A + B) / Two
}
pre {
  level := Mean(A := n, B := count)
  q := a and not b and rise(b)
  IF a THEN count := n + count END_IF
  timer(IN := a, PT := 2s)
  late := timer.Q
  out := (c or not d) and fall(d)
  not_out := not ((c or not d) and fall(d))
  IF not d THEN kept := FALSE END_IF
}
"#,
    );
    assert_eq!(problems, Vec::<String>::new());
}

#[test]
fn connection_points_of_iec_61131_10_carry_the_wires() {
    let problems = means(
        "part10.xml",
        r#"
profile iec61131
input Car : BOOL at %IX0.0
output Open : BOOL at %QX0.0
var Cars : INT := 1
chart Gate {
  initial step Shut
  step Up { N Open  P1 Cars := Cars + 1 }
  Shut -> Up when Car
  Up -> Shut when not Car and Up.t > 3s
}
"#,
    );
    assert_eq!(problems, Vec::<String>::new());
}

#[test]
fn macro_steps_and_actions_that_are_charts() {
    let problems = means(
        "macros.xml",
        r#"
profile iec61131
input go : BOOL at %IX0.0
output done : BOOL at %QX0.0
chart Cell {
  var Blink : BOOL
  initial step Ready
  macro Work = Work
  Ready -> Work when go
  Work -> Ready when not go
}
macrochart Work {
  entry step In
  exit step Out { N Cell.Blink }
  In -> Out when Ready.X = FALSE
}
chart Cell_Blink {
  initial step Dark
  step Light { N done if Cell.Blink }
  Dark -> Light when Cell.Blink and Dark.t > 1s
  Light -> Dark when Cell.Blink
}
"#,
    );
    assert_eq!(problems, ["G0614 10"]);
}

#[test]
fn a_block_alone_runs_as_a_program() {
    let problems = means(
        "alone.xml",
        "profile iec61131
         input a : BOOL
         output q : BOOL
         var n : INT
         pre {
           IF a THEN q := TRUE END_IF
           IF a THEN n := n + 1 END_IF
         }",
    );
    assert_eq!(problems, Vec::<String>::new());
}

#[test]
fn arrays_are_arrays() {
    let problems = means(
        "lamps.xml",
        r#"
profile iec61131
input go : BOOL
input k : INT
output Lamp : ARRAY[0..1] OF BOOL
var row : ARRAY[1..3] OF INT := [4, 2(-1)]
var m : ARRAY[0..1, 1..3] OF INT := [1, 2(2), 1, 2(2)]
chart Lamps {
  initial step Off
  step On {
    N Lamp[1]
    P Add
  }
  Off -> On when go and row[k] < 9
  On -> Off when not go
  action Add { row[k] := row[k] + m[0, k] + m[1, 3] }
}
"#,
    );
    assert_eq!(problems, Vec::<String>::new());
}
