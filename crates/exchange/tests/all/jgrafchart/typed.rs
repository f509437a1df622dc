//! The context of an expression decides in JGrafchart how it is evaluated:
//! 1 is true and every other number false, numbers are cut to whole ones, a
//! division in the value of a real variable is one of reals.

use crate::jgrafchart::show::{actions, bytes, chart, import, problems, step, transitions, vars};

#[test]
fn initial_values_and_channels_are_kept() {
    let (document, _) = import("texts.xml");
    assert_eq!(
        vars(&document),
        [
            "var b BOOL := TRUE retain",
            "var c BOOL := TRUE",
            "var n DINT := -7",
            "var m DINT := -2147483648 retain",
            "const k DINT := 12",
            "var r LREAL := 1.0",
            "var s STRING(255) := 'a \"b\" <å>'",
            "output ao REAL at 2",
            "output do BOOL at Q 0.1",
        ]
    );
}

#[test]
fn each_letter_has_its_moment() {
    let (document, _) = import("texts.xml");
    assert_eq!(
        actions(step(&document, "Texts", "work")),
        [
            "P1 b := TRUE",
            "each scan: n := (n + 1)",
            "P0 c := FALSE",
            "N do",
            "P1 ao := LREAL_TO_REAL((r / 2.0))",
            "P1 n := 1",
        ]
    );
}

#[test]
fn a_boolean_takes_one_as_true() {
    let (document, _) = import("texts.xml");
    assert_eq!(
        actions(step(&document, "Texts", "bool")),
        [
            "P1 b := FALSE",
            "P1 b := TRUE",
            "P1 b := FALSE",
            "P1 b := (n = 1)",
            "P1 b := (TRUNC(r) = 1)",
            "P1 b := (s = '1')",
            "P1 b := (not c and (b or (n > 3)))",
            "P1 b := (↑c or ↓do)",
            "P1 b := (n = 1)",
            "P1 b := (c = TRUE)",
            "P1 b := (c <> b)",
            "P1 b := (BOOL_TO_DINT(c) = n)",
            "P1 b := (n < r)",
            "P1 b := (s = 'x')",
        ]
    );
}

#[test]
fn a_number_takes_what_its_type_says() {
    let (document, _) = import("texts.xml");
    assert_eq!(
        actions(step(&document, "Texts", "numbers")),
        [
            "P1 n := BOOL_TO_DINT(b)",
            "P1 n := TRUNC(r)",
            "P1 n := 2",
            "P1 n := (((n + 2) * 3) - (n mod 4))",
            "P1 n := -n",
            // Counts of scans have 16 bits here and 32 there.
            "P1 n := (INT_TO_DINT(work.t) + 1)",
            // Real where a real is wanted: no whole division.
            "P1 r := (DINT_TO_LREAL(n) / m)",
            "P1 r := (1.0 / DINT_TO_LREAL(n))",
            "P1 r := n",
            "P1 r := work.s",
            "P1 r := (BOOL_TO_LREAL(b) + 1.0)",
            "P1 ao := (ao * 2.0)",
            "P1 n := SEL(b, n, 1)",
        ]
    );
}

#[test]
fn texts_are_joined_and_compared() {
    let (document, _) = import("texts.xml");
    assert_eq!(
        actions(step(&document, "Texts", "strings")),
        ["P1 s := CONCAT('a', s)", "P1 s := SEL(b, '0', '1')", "P1 s := '5'"]
    );
}

#[test]
fn conditions_read_steps_and_edges() {
    let (document, found) = import("texts.xml");
    assert_eq!(
        transitions(chart(&document, "Texts")),
        [
            "work -> bool when ((work.x and (INT_TO_DINT(work.t) > 100000)) or (work.s >= 2.5))",
            "bool -> numbers when (work.t > 10)",
            "numbers -> strings when (↑b or ↓b)",
            "strings -> work when (((n / 2) = 1) and (r = n))",
        ]
    );
    assert_eq!(problems(&bytes("texts.xml"), &found), Vec::<String>::new());
}
