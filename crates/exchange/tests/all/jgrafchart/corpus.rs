//! Charts that people drew, from the corpus that `g7_peers` finds.

use crate::support;
use crate::support::recognise;
use std::collections::BTreeSet;

use g7_model::{FileId, Severity};

const FILES: [&str; 5] = [
    "boremodell_test.xml",
    "fritz_test_marcus_ole_heis5_emptystep.xml",
    "sorting.xml",
    "sugekopp.xml",
    "test_kurz.xml",
];

/// How often an element stands in the file, by its opening words.
fn count(text: &str, tag: &str) -> usize {
    text.matches(&format!("<{tag} ")).count()
}

/// The names of all elements with one of these tags, as the file has them.
fn named(text: &str, tags: &[&str]) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for tag in tags {
        for (at, _) in text.match_indices(&format!("<{tag} ")) {
            let element = text[at..].split('>').next().unwrap_or("");
            let name = element.split(" name=\"").nth(1).and_then(|n| n.split('"').next());
            names.extend(name.map(str::to_string));
        }
    }
    names
}

#[test]
fn charts_of_the_corpus_come_over_whole() {
    let Some(folder) = g7_peers::corpus("jgrafchart-xml/fschimpf/examples") else { return };
    for file in FILES {
        let bytes = std::fs::read(folder.join(file)).expect(file);
        let text = String::from_utf8(bytes.clone()).expect(file);
        assert_eq!(recognise("", &bytes), Some("jgrafchart"), "{file}");
        let (document, problems) = support::import("jgrafchart", &bytes, FileId(0));
        let errors: Vec<&str> =
            problems.iter().filter(|p| p.severity() == Severity::Error).map(|p| &*p.what).collect();
        assert!(errors.is_empty(), "{file}: {errors:?}");

        let chart = document.charts().next().expect(file);
        assert_eq!(document.charts().count(), 1, "{file}");
        let steps = count(&text, "GCStep") + count(&text, "GCInitialStep");
        assert_eq!(chart.steps().count(), steps, "{file}");
        assert_eq!(chart.transitions().count(), count(&text, "GCTransition"), "{file}");
        // No splits or joins in these: two lines a transition, one before and one behind it.
        assert!(chart.transitions().all(|t| t.from.len() == 1 && t.to.len() == 1), "{file}");
        assert_eq!(chart.transitions().count() * 2, count(&text, "GCLink"), "{file}");
        assert_eq!(chart.steps().filter(|s| s.initial).count(), count(&text, "GCInitialStep"), "{file}");

        let names: BTreeSet<String> = chart.steps().map(|s| s.name.text.to_string()).collect();
        assert_eq!(names, named(&text, &["GCStep", "GCInitialStep"]), "{file}");
        let vars = document.items.iter().filter_map(|i| match i {
            g7_model::Item::Var(v) => Some(v),
            _ => None,
        });
        let names: BTreeSet<String> = vars.flat_map(|v| &v.names).map(|n| n.text.to_string()).collect();
        assert_eq!(names, named(&text, &["DigitalIn", "DigitalIn1", "DigitalOut"]), "{file}");
        // Each `S v = e` of the file is an action; they use no other letter.
        let actions: usize = chart.steps().map(|s| s.actions.len()).sum();
        let written = text.matches("\"S ").count() + text.matches("&#10;S ").count();
        assert_eq!(actions, written, "{file}");
    }
}
