//! The reports, and their places.

use crate::sfc::{file, import};

/// Every problem of the broken file: its line, its code and a part of its words.
#[test]
fn each_mistake_has_its_place() {
    let text = file("broken.st");
    let (_, problems) = import(&text);
    let line = |at: u32| text[..at as usize].matches('\n').count() + 1;
    for (number, code, words) in [
        (5, "G0606", "expected `;`"),
        (6, "G0612", "no day 2026-02-30"),
        (7, "G0604", "no pointers"),
        (8, "G0604", "no type `Motor`"),
        (10, "G0606", "expected `;`"),
        (11, "G0606", "a qualifier"),
        (11, "G0606", "needs a time"),
        (12, "G0606", "expected `TO`"),
        (13, "G0606", "expected an expression"),
        (15, "G0606", "expected `:=`"),
        (17, "G0604", "no counterpart"),
    ] {
        let found = problems
            .iter()
            .any(|p| line(p.at.start) == number && p.code.id == code && p.what.contains(words));
        let all: Vec<(usize, &str, &str)> =
            problems.iter().map(|p| (line(p.at.start), p.code.id, &*p.what)).collect();
        assert!(found, "{number} {code} {words}: {all:#?}");
    }
}

#[test]
fn a_file_without_a_unit_is_refused() {
    let (document, problems) = import("nothing of the kind");
    assert!(document.items.is_empty());
    assert!(problems.iter().any(|p| p.what.contains("no PROGRAM")), "{problems:?}");
}
