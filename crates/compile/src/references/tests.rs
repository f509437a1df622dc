//! Each name leads to what the rules of the language say (grammar.md, "A `path` names").

use g7_model::{FileId, Span};

use super::{Definition, References, Written, references};

const TEXT: &str = "\
input a, b : BOOL
output V : BOOL
var n : INT
chart G {
  var a : BOOL
  initial step 1 { N V if a }
  step 12 { force H := {5}; P1 n := n + 1 }
  macro M3 = Fill
  go: 1 -> 12 when a and H.X5
    -> M3 when b and X12 and 3s/X1
  M3 -> 1 when M3.X7.t > 1s and %X12
}
chart H {
  initial step 5
  step 12
  5 -> 12 when G.a and G.X12.t > 2s
  12 -> 5 when a and X12
}
macrochart Fill {
  entry step 7
  exit step 8
  7 -> 8 when XM3
}
plant P {
  state n : INT := 0
  on V { n := n + 1 }
  drive b := n > 3
}
test \"t\" with P {
  set a := TRUE
  expect G.X12, V, n = 3
}
layout G {
  step 12 at (0, 0)
  transition go at (1, 1)
}
";

fn read(text: &str) -> (String, References) {
    let text = text.to_owned();
    let (doc, problems) = g7_syntax::parse(&text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    (text, references(&doc))
}

/// The lines on which a thing is named, from 1, with the word there.
fn places(definition: &Definition) -> Vec<(usize, String)> {
    places_in(TEXT, definition)
}

fn places_in(text: &str, definition: &Definition) -> Vec<(usize, String)> {
    let (text, refs) = read(text);
    refs.of(definition).iter().map(|s| place(&text, *s)).collect()
}

/// The line of a place, from 1, with the word there.
fn place(text: &str, s: Span) -> (usize, String) {
    let line = text.get(..s.start as usize).unwrap_or_default().matches('\n').count() + 1;
    (line, text.get(s.start as usize..s.end as usize).unwrap_or_default().to_owned())
}

fn step(chart: &str, name: &str) -> Definition {
    Definition::Step { chart: chart.into(), name: name.into() }
}

fn variable(chart: Option<&str>, name: &str) -> Definition {
    Definition::Variable { chart: chart.map(str::to_owned), name: name.into() }
}

fn listed(places: &[(usize, &str)]) -> Vec<(usize, String)> {
    places.iter().map(|(n, t)| (*n, (*t).to_owned())).collect()
}

#[test]
fn steps_are_found_wherever_they_are_named() {
    let expected = [(7, "12"), (9, "12"), (10, "X12"), (11, "%X12"), (16, "X12"), (31, "X12"), (34, "12")];
    assert_eq!(places(&step("G", "12")), listed(&expected));
    assert_eq!(places(&step("H", "12")), listed(&[(15, "12"), (16, "12"), (17, "12"), (17, "X12")]));
    let expected = [(7, "5"), (9, "X5"), (14, "5"), (16, "5"), (17, "5")];
    assert_eq!(places(&step("H", "5")), listed(&expected));
    assert_eq!(places(&step("Fill", "7")), listed(&[(11, "X7"), (20, "7"), (22, "7")]));
    let expected = [(8, "M3"), (10, "M3"), (11, "M3"), (11, "M3"), (22, "XM3")];
    assert_eq!(places(&step("G", "M3")), listed(&expected));
}

#[test]
fn a_variable_of_a_chart_hides_that_of_the_file() {
    assert_eq!(places(&variable(None, "a")), listed(&[(1, "a"), (17, "a"), (30, "a")]));
    assert_eq!(places(&variable(Some("G"), "a")), listed(&[(5, "a"), (6, "a"), (9, "a"), (16, "a")]));
    assert_eq!(places(&variable(None, "b")), listed(&[(1, "b"), (10, "b"), (27, "b")]));
}

#[test]
fn a_state_of_a_plant_hides_a_variable_in_the_plant_and_its_tests() {
    let own = Definition::PlantItem { plant: "P".into(), name: "n".into() };
    assert_eq!(places(&own), listed(&[(25, "n"), (26, "n"), (26, "n"), (27, "n"), (31, "n")]));
    assert_eq!(places(&variable(None, "n")), listed(&[(3, "n"), (7, "n"), (7, "n")]));
}

#[test]
fn charts_and_labels_have_places_too() {
    let expected = [(4, "G"), (16, "G"), (16, "G"), (31, "G"), (33, "G")];
    assert_eq!(places(&Definition::Chart("G".into())), listed(&expected));
    let label = Definition::Transition { chart: "G".into(), label: "go".into() };
    assert_eq!(places(&label), listed(&[(9, "go"), (35, "go")]));
}

#[test]
fn the_name_at_a_byte_is_found_and_how_it_is_written() {
    let (text, refs) = read(TEXT);
    let at = text.find("X12 and 3s").expect("it is there");
    for offset in [at, at + 1, at + 3] {
        let found = refs.use_at(u32::try_from(offset).expect("short")).expect("a name");
        assert_eq!((&found.definition, found.before), (&step("G", "12"), 1));
        assert_eq!(found.written, Written::Path { first: true, only: true });
    }
    assert_eq!(refs.at(u32::try_from(at + 5).expect("short")), None);
    let declared = refs.declaration(&step("G", "12")).expect("declared");
    assert_eq!(text.get(..declared.start as usize).map(|t| t.ends_with("step ")), Some(true));
}

/// Structures and function blocks: the names of members are those of the type, wherever a path comes from.
const TYPES: &str = "\
const N : INT := 2
struct Motor {
  speed : REAL := 1.5
  limits : ARRAY[1..N] OF INT
}
function block Debounce {
  input raw : BOOL
  output q : BOOL
  inout n : INT
  var t : TON
  body {
    var i : INT
    t(IN := raw, PT := 10ms);
    i := N;
    n := n + i;
    q := t.Q AND NOT raw AND k > 0 AND t.Z;
  }
}
function block Pair {
  input raw : BOOL
  inout sum : INT
  var d : ARRAY[1..N] OF Debounce
  var `m x` : Motor
  body {
    var i : INT
    FOR i := 1 TO N DO
      d[i](raw := raw, n := sum, wrong := 1);
    END_FOR
    `m x`.speed := 1.0;
    d[1].t(IN := d[i + 1].q);
  }
}
var m : ARRAY[1..2] OF Motor := [(speed := 2.0), (limits := [7, 8], size := 1)]
var k, i : INT
var d : Debounce
var p : Pair
output lamp : BOOL
chart G {
  var d : Pair
  var i : INT
  initial step 0 {
    each scan: d[i](raw := m[i].limits[k] > 0, sum := k)
    each scan: p(raw := lamp, sum := k)
    P1 { m[i].speed := m[1].speed; m[i + 1] := m[1] }
    S lamp if d.d[i].q and d.q
  }
  0 -> 0 when not p.d[1].q
}
chart H {
  initial step 0 { each scan: d(raw := lamp, q => lamp, n := k) }
  0 -> 0 when d.q and G.d.d[2].t.Q and nothing.q and m[1].limits[2] > 0
}
chart A(i : INT) {
  var d : Debounce
  initial step 0 { each scan: d(n := k) }
}
instance A[1..2]
instance Lift : A(7)
plant P {
  state x : BOOL := FALSE
  drive lamp := d.q
}
test \"t\" with P {
  expect d.q, G.d.`m x`.speed > 0.5, A[1].d.q, Lift.d.q, A[2].d.t.Q, x, p.d[1].i = 0
}
prove never p.d[1].q and H.d.q
";

fn of_type(name: &str) -> Definition {
    Definition::Type(name.into())
}

fn member(of: &str, name: &str) -> Definition {
    Definition::Member { of: of.into(), name: name.into() }
}

/// The lines on which a thing of [`TYPES`] is named.
fn lines(definition: &Definition) -> Vec<usize> {
    places_in(TYPES, definition).into_iter().map(|(line, _)| line).collect()
}

#[test]
fn members_are_found_in_paths_calls_values_and_bodies() {
    let motor = listed(&[(2, "Motor"), (23, "Motor"), (33, "Motor")]);
    assert_eq!(places_in(TYPES, &of_type("Motor")), motor);
    assert_eq!(lines(&of_type("Debounce")), [6, 22, 35, 54]);
    assert_eq!(lines(&member("Motor", "speed")), [3, 29, 33, 44, 44, 64]);
    assert_eq!(lines(&member("Motor", "limits")), [4, 33, 42, 51]);
    assert_eq!(lines(&member("Debounce", "raw")), [7, 13, 16, 27, 50]);
    assert_eq!(lines(&member("Debounce", "q")), [8, 16, 30, 45, 47, 50, 51, 61, 64, 64, 64, 66]);
    assert_eq!(lines(&member("Debounce", "n")), [9, 15, 15, 27, 50, 55]);
    assert_eq!(lines(&member("Debounce", "t")), [10, 13, 16, 16, 30, 51, 64]);
    assert_eq!(lines(&member("Pair", "sum")), [21, 27, 42, 43]);
    let ticked = listed(&[(23, "`m x`"), (29, "`m x`"), (64, "`m x`")]);
    assert_eq!(places_in(TYPES, &member("Pair", "m x")), ticked);
}

#[test]
fn each_name_before_a_member_hides_those_further_outside() {
    // In the bodies, `d` and `i` are members and local variables.
    assert_eq!(lines(&member("Pair", "d")), [22, 27, 30, 30, 45, 47, 51, 64, 66]);
    assert_eq!(lines(&member("Pair", "i")), [25, 26, 27, 30]);
    assert_eq!(lines(&member("Debounce", "i")), [12, 14, 15, 64]);
    assert_eq!(lines(&variable(None, "d")), [35, 50, 51, 61, 64]);
    assert_eq!(lines(&variable(Some("G"), "d")), [39, 42, 45, 45, 51, 64]);
    // Of instances, too, with a number or with a name of their own.
    assert_eq!(lines(&variable(Some("A"), "d")), [54, 55, 64, 64, 64]);
    assert_eq!(lines(&variable(Some("G"), "i")), [40, 42, 42, 44, 44, 45]);
    assert_eq!(lines(&variable(None, "i")), [34]);
    assert_eq!(lines(&variable(None, "N")), [1, 4, 14, 22, 26]);
    assert_eq!(lines(&variable(None, "m")), [33, 42, 44, 44, 44, 44, 51]);
    assert_eq!(lines(&variable(None, "k")), [16, 34, 42, 42, 43, 50, 55]);
}

const BLOCKS: &str = "\
function block Gripper {
  input close : BOOL
  output coil : BOOL
  body { coil := Cycle.X2 }
}
chart Cycle of Gripper {
  var n : INT
  initial step 1
  step 2 { N coil; force Guard := {1} }
  1 -> 2 when close and n = 0
}
chart Guard of Gripper {
  initial step 1
}
struct Pair { left, right : Gripper }
var pair : ARRAY[1..2] OF Pair
var one : Gripper
chart Main {
  initial step 1
  step 2 { force pair[2].left.Cycle := {2}; force one.Guard := {} }
  1 -> 2 when one.Cycle.X2 and pair[1].right.Cycle.n > 0 and one.Cycle.X7
}
prove never one.Cycle.X2 and one.coil
";

#[test]
fn charts_of_function_blocks_are_found_by_the_paths_of_their_instances() {
    let lines = |definition: Definition| -> Vec<usize> {
        places_in(BLOCKS, &definition).into_iter().map(|(line, _)| line).collect()
    };
    let step = |name: &str| Definition::Step { chart: "Cycle".into(), name: name.into() };
    assert_eq!(lines(Definition::Chart("Cycle".into())), [4, 6, 20, 21, 21, 21, 23]);
    assert_eq!(lines(Definition::Chart("Guard".into())), [9, 12, 20]);
    assert_eq!(lines(step("2")), [4, 9, 10, 20, 21, 23]);
    assert_eq!(lines(variable(Some("Cycle"), "n")), [7, 10, 21]);
    assert_eq!(lines(of_type("Gripper")), [1, 6, 12, 15, 17]);
    assert_eq!(lines(member("Gripper", "coil")), [3, 4, 9, 23]);
    assert_eq!(lines(member("Gripper", "close")), [2, 10]);
    assert_eq!(lines(member("Pair", "left")), [15, 20]);
    assert_eq!(lines(variable(None, "one")), [17, 20, 21, 21, 23, 23]);
    let (text, refs) = read(BLOCKS);
    let unknown: Vec<_> = refs.unknown().iter().map(|u| place(&text, u.at)).collect();
    assert_eq!(unknown, listed(&[(21, "X7")]));
}

#[test]
fn a_member_that_is_not_there_is_unknown() {
    let (text, refs) = read(TYPES);
    let unknown: Vec<_> = refs.unknown().iter().map(|u| place(&text, u.at)).collect();
    let names =
        [(16, "Z"), (27, "wrong"), (33, "size"), (45, "q"), (51, "nothing"), (51, "q"), (66, "d"), (66, "q")];
    assert_eq!(unknown, listed(&names));
    let (_, refs) = read("var d : Missing := (a := 1)\nvar n : INT := (a := 1)\nprove never d.q\n");
    let unknown: Vec<u32> = refs.unknown().iter().map(|u| u.at.start).collect();
    assert_eq!(unknown, [8, 20, 44, 66]);
}

const NAMED: &str = "\
type Mode : (Off, Manual, Automatic) := Off
type Colour : (Red, Off)
type Percent : INT(0..most)
type Row : ARRAY[1..2] OF Percent
const most : INT := 100
struct Lamp {
  mode : Mode := Mode.Manual
}
input want : Mode
var Red : BOOL
var p : Row
chart G {
  var Manual : INT
  var m : Mode := Automatic
  initial step 0 { each scan: m := SEL(Red, Mode.Off, Automatic); }
  0 -> 0 when want = Mode.Manual and Manual = 1 and m <> Mode.Blue
}
prove never G.m = Automatic and want = Colour.Off and Red and p[1] > 3
";

#[test]
fn values_of_enumerations_are_found_behind_their_type_and_alone() {
    let value = |of: &str, name: &str| Definition::Value { of: of.into(), name: name.into() };
    let lines = |definition: &Definition| {
        places_in(NAMED, definition).into_iter().map(|(line, _)| line).collect::<Vec<_>>()
    };
    assert_eq!(lines(&of_type("Mode")), [1, 7, 7, 9, 14, 15, 16, 16]);
    assert_eq!(lines(&of_type("Percent")), [3, 4]);
    assert_eq!(lines(&of_type("Row")), [4, 11]);
    assert_eq!(lines(&value("Mode", "Automatic")), [1, 14, 15, 18]);
    // The variable of the chart hides the bare value.
    assert_eq!(lines(&value("Mode", "Manual")), [1, 7, 16]);
    assert_eq!(lines(&variable(Some("G"), "Manual")), [13, 16]);
    assert_eq!(lines(&value("Colour", "Red")), [2]);
    assert_eq!(lines(&value("Colour", "Off")), [2, 18]);
    assert_eq!(lines(&variable(None, "Red")), [10, 15, 18]);
    assert_eq!(lines(&variable(None, "most")), [3, 5]);
    let (text, refs) = read(NAMED);
    let unknown: Vec<_> = refs.unknown().iter().map(|u| place(&text, u.at)).collect();
    assert_eq!(unknown, listed(&[(15, "SEL"), (16, "Blue")]));
}
