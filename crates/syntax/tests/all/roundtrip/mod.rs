//! A printed document reads as the same document, whatever it is.

mod charts;
mod expressions;
mod world;

use charts::document;
use expressions::expr;
use g7_model::FileId;
use g7_syntax::{parse, parse_expr, print, print_expr};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn an_expression_reads_as_it_was(e in expr()) {
        let text = print_expr(&e);
        let (again, problems) = parse_expr(&text, FileId(0));
        prop_assert!(problems.is_empty(), "{text}: {problems:?}");
        prop_assert_eq!(&again, &e, "{}", text);
        prop_assert_eq!(print_expr(&again), text);
    }
}

/// Runs a property of documents with room for their strategies, whose values are large in a build for tests.
fn with_room(property: impl FnOnce() + Send + 'static) {
    let thread = std::thread::Builder::new().stack_size(64 << 20).spawn(property).expect("a thread");
    if let Err(failure) = thread.join() {
        std::panic::resume_unwind(failure);
    }
}

fn config() -> ProptestConfig {
    ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() }
}

#[test]
fn a_document_reads_as_it_was() {
    with_room(|| {
        proptest!(config(), |(d in document())| {
            let text = print(&d, None);
            let (again, problems) = parse(&text, FileId(0));
            prop_assert!(problems.is_empty(), "{problems:?}\n{text}");
            prop_assert_eq!(&again, &d, "\n{}", text);
            prop_assert_eq!(print(&again, None), text.clone());
        });
    });
}

/// Formatting a text keeps its meaning and its notes, and doing it twice changes nothing more.
#[test]
fn formatting_a_text_twice_changes_nothing() {
    with_room(|| {
        proptest!(config(), |(d in document(), notes in prop::collection::vec(0usize..4, 0..24))| {
            let text = with_notes(&print(&d, None), &notes);
            let (first, problems) = parse(&text, FileId(0));
            prop_assert!(problems.is_empty(), "{problems:?}\n{text}");
            let formatted = print(&first, Some(&text));
            let (second, problems) = parse(&formatted, FileId(0));
            prop_assert!(problems.is_empty(), "{problems:?}\n{formatted}");
            prop_assert_eq!(&second, &first, "\n{}\n-- from --\n{}", formatted, text);
            prop_assert_eq!(print(&second, Some(&formatted)), formatted);
        });
    });
}

/// Notes of several sorts between the lines and at their ends.
fn with_notes(text: &str, sorts: &[usize]) -> String {
    // Not within a body of another language, which keeps all its text.
    if text.contains("il {") || text.contains("ld {") {
        return text.into();
    }
    let mut sorts = sorts.iter().cycle();
    let mut out = String::new();
    for (i, line) in text.lines().enumerate() {
        match sorts.next() {
            Some(0) => out.push_str(&format!("{line} // behind {i}\n")),
            Some(1) => out.push_str(&format!("\n\n\n// before {i}\n{line}\n")),
            Some(2) => out.push_str(&format!("/* two\n   lines */ {line} (* {i} *)   // and more\n\n")),
            _ => out.push_str(&format!("{line}\n")),
        }
    }
    out
}
