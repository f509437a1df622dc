//! The plant of the bead sorter is the same text in all files of the example,
//! since a file cannot include another.
#![allow(clippy::disallowed_methods, reason = "the test reads the example")]

use std::path::Path;

fn plant(file: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/bead-sorter");
    let text = std::fs::read_to_string(folder.join(file)).expect(file);
    let from = text.find("\nplant Unit {").unwrap_or_else(|| panic!("{file} has no plant"));
    let rest = &text[from..];
    rest[..rest.find("\n}").expect("its end")].to_owned()
}

#[test]
fn the_plant_is_the_same_in_all_files() {
    let first = plant("chart.g7");
    assert!(first.contains("drive Tilt"));
    for file in ["template.g7", "exercise-1.g7", "exercise-2.g7", "exercise-3.g7", "exercise-4.g7"] {
        assert_eq!(plant(file), first, "{file}");
    }
}
