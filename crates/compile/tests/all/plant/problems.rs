//! Faults of a plant, beyond the cases of `tests/check`.

use g7_compile::check;
use g7_model::FileId;

use super::support::{compiled, text};

fn codes(items: &str) -> Vec<&'static str> {
    compiled(&text(items)).err().unwrap_or_default()
}

#[test]
fn names_of_the_plant_are_its_own_only_once() {
    assert_eq!(codes("state x : INT  state x : REAL"), ["G0201"]);
    assert_eq!(codes("parts Q(c : INT) max 2  parts Q(d : INT) max 2"), ["G0201"]);
    assert_eq!(codes("state Q : INT  parts Q(c : INT) max 2"), ["G0201"]);
    assert_eq!(codes("parts Q(c : INT) max 2  state Q : INT"), ["G0201"]);
    assert_eq!(codes("each { var i : INT  var i : INT  i := 1 }"), ["G0201"]);
}

#[test]
fn a_plant_sees_outputs_but_no_inputs_steps_or_variables() {
    assert!(codes("state x : BOOL  each { x := V or W }").is_empty());
    assert_eq!(codes("state x : BOOL  each { x := r > 1.0 }"), ["G0202"]);
    assert_eq!(codes("state x : BOOL  each { x := X1 }").len(), 1);
}

#[test]
fn types_are_held_to_in_plants_too() {
    assert_eq!(codes("state x : LREAL  drive r := x"), ["G0209"]);
    assert_eq!(codes("state x : LREAL  rate x := TRUE"), ["G0209"]);
    assert_eq!(codes("parts Q(c : INT) max 2  each { Q.enter(TRUE) }").first(), Some(&"G0209"));
    assert_eq!(
        codes("parts T(c : INT) max 2 length 1.0  state x : BOOL  each { x := T.at(TRUE, 1.0) }")[0],
        "G0210"
    );
}

#[test]
fn a_state_that_nothing_reads_is_no_problem() {
    let (doc, _) = g7_syntax::parse(&text("state seen : INT  parts Q(c : INT) max 2"), FileId(0));
    assert!(check(&doc).is_empty());
}

#[test]
fn problems_of_each_plant_are_told_by_check() {
    let two = format!("{}\nplant Q {{ drive b := TRUE }}", text("drive a := 3"));
    let (doc, _) = g7_syntax::parse(&two, FileId(0));
    let codes: Vec<&str> = check(&doc).iter().map(|p| p.code.id).collect();
    assert_eq!(codes, ["G0209", "G0501"]);
}

#[test]
fn what_is_written_out_for_each_part_stays_small() {
    let nested = "parts T(c : INT) max 48 length 1.0  state x : LREAL
        each { x := T.position(T.position(T.position(0.0, 1.0), 1.0), 1.0) }";
    assert_eq!(codes(nested), ["G0503", "G0503"]);
    assert_eq!(codes("parts T(c : INT) max 4 length 1.0  each { T.take(random(), 1.0) }"), ["G0503"]);
    assert_eq!(codes("state x : LREAL  each { x := random(random(), 1.0) }"), ["G0503"]);
    let many =
        format!("parts T(c : INT) max 48 length 1.0  each {{ {} }}", "T.take(0.0, 1.0)\n".repeat(3000));
    assert_eq!(codes(&many), ["G0503"]);
}
