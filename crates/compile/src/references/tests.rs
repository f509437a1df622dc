//! Each name leads to what the rules of the language say (grammar.md, "A `path` names").

use g7_model::FileId;

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

fn read() -> (String, References) {
    let text = TEXT.to_owned();
    let (doc, problems) = g7_syntax::parse(&text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    (text, references(&doc))
}

/// The lines on which a thing is named, from 1, with the word there.
fn places(definition: &Definition) -> Vec<(usize, String)> {
    let (text, refs) = read();
    refs.of(definition)
        .iter()
        .map(|s| {
            let line = text.get(..s.start as usize).unwrap_or_default().matches('\n').count() + 1;
            (line, text.get(s.start as usize..s.end as usize).unwrap_or_default().to_owned())
        })
        .collect()
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
    let (text, refs) = read();
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
