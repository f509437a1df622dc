//! The plant of the bead sorter is the same text in all files of the example and in the templates of the
//! laboratory's exercises, since nothing outside of their folder is read. So is its picture.
#![allow(clippy::disallowed_methods, reason = "the test reads examples and exercises")]

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn text(file: &str) -> String {
    fs::read_to_string(root().join(file)).expect(file)
}

/// The templates of the exercises of the laboratory, as paths from the root.
fn exercises() -> Vec<String> {
    let list = fs::read_dir(root().join("exercises")).expect("the exercises");
    let names = list.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned());
    names.filter(|n| n.starts_with("bead-sorter")).map(|n| format!("exercises/{n}")).collect()
}

fn plant(file: &str) -> String {
    let text = text(file);
    let from = text.find("\nplant Unit {").unwrap_or_else(|| panic!("{file} has no plant"));
    let rest = &text[from..];
    rest[..rest.find("\n}").expect("its end")].to_owned()
}

#[test]
fn the_plant_is_the_same_in_all_files() {
    let first = plant("examples/bead-sorter/chart.g7");
    assert!(first.contains("drive Tilt"));
    let of_the_example = ["template", "exercise-1", "exercise-2", "exercise-3", "exercise-4"]
        .map(|name| format!("examples/bead-sorter/{name}.g7"));
    let templates = exercises().into_iter().map(|folder| format!("{folder}/template.g7"));
    for file in of_the_example.into_iter().chain(templates) {
        assert_eq!(plant(&file), first, "{file}");
    }
}

#[test]
fn the_picture_is_the_same_in_each_exercise() {
    let first = text("examples/bead-sorter/bead-sorter.svg");
    let all = exercises();
    assert_eq!(all.len(), 6, "two preparations and four exercises: {all:?}");
    for folder in all {
        let file = format!("{folder}/bead-sorter.svg");
        assert!(text(&file) == first, "{file} differs from that of the example");
    }
}
