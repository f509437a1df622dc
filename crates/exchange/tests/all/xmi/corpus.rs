//! Charts that people drew, from the corpus that `g7_peers` finds.

use crate::support;
use crate::support::recognise;
use std::path::{Path, PathBuf};

use g7_model::{ActionKind, Document, FileId, Severity};

/// How many charts the corpus has.
const FILES: usize = 39;

/// The charts in a folder and below.
fn charts(folder: &Path, all: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let path = entry.path();
        if path.is_dir() {
            charts(&path, all);
        } else if path.extension().is_some_and(|e| e == "grafcet" || e == "ecore") {
            all.push(path);
        }
    }
}

/// All of them, with their names; none if the corpus is absent.
fn all() -> Vec<(String, Vec<u8>)> {
    let Some(folder) = g7_peers::corpus("agrafe-xmi") else { return Vec::new() };
    let mut paths = Vec::new();
    charts(&folder, &mut paths);
    paths.sort();
    let read = |path: &PathBuf| {
        let name = path.strip_prefix(&folder).expect("a path in the folder").display().to_string();
        (name, std::fs::read(path).expect("a file of the corpus"))
    };
    let all: Vec<_> = paths.iter().map(read).collect();
    assert_eq!(all.len(), FILES);
    all
}

/// How often an element stands in the file.
fn count(text: &str, element: &str) -> usize {
    text.matches(&format!("<{element} ")).count()
}

/// Links that have both of their ends.
fn whole_links(text: &str) -> usize {
    text.split("<actionLinks ")
        .skip(1)
        .filter(|l| {
            let element = l.split("/>").next().unwrap_or("");
            element.contains("step=") && element.contains("actionType=")
        })
        .count()
}

#[test]
fn charts_of_the_corpus_come_over_whole() {
    for (name, bytes) in &all() {
        let text = String::from_utf8_lossy(bytes);
        assert_eq!(recognise("", bytes), Some("xmi"), "{name}");
        let (document, problems) = support::import("xmi", bytes, FileId(0));
        let errors: Vec<&str> =
            problems.iter().filter(|p| p.severity() == Severity::Error).map(|p| &*p.what).collect();
        assert!(errors.is_empty(), "{name}: {errors:?}");

        let steps = || document.charts().flat_map(g7_model::Chart::steps);
        assert_eq!(steps().count(), count(&text, "steps"), "{name}");
        assert_eq!(
            steps().filter(|s| s.initial).count(),
            text.matches(" initial=\"true\"").count(),
            "{name}"
        );
        assert_eq!(
            steps().filter(|s| s.linked).count(),
            text.matches(" activationLink=\"true\"").count(),
            "{name}"
        );
        let transitions = document.charts().map(|c| c.transitions().count()).sum::<usize>();
        assert_eq!(transitions, count(&text, "transitions"), "{name}");
        let of_file: Vec<_> = document.items.iter().filter(|i| matches!(i, g7_model::Item::Var(_))).collect();
        let declared = count(&text, "variableDeclarations");
        let of_steps = text.matches(" variableDeclarationType=\"step\"").count();
        let timed = problems.iter().filter(|p| p.what.contains("read as the time operator")).count();
        assert_eq!(of_file.len(), declared - of_steps - timed, "{name}");
        let told = problems.iter().filter(|p| p.what.contains("`2s/X202`")).count();
        assert_eq!(told, text.matches("name=\"2s/X202\"").count(), "{name}");
        let enclosing = |k: &ActionKind| matches!(k, ActionKind::Order(g7_model::Order::Enclose(_)));
        let actions = steps().flat_map(|s| &s.actions).filter(|a| !enclosing(&a.kind)).count();
        assert_eq!(actions, whole_links(&text), "{name}");
    }
}

/// A document without what stands for unread parts, as .g7 text and back.
fn printed(document: &Document) -> Document {
    let text = g7_syntax::print(document, None);
    let (back, problems) = g7_syntax::parse(&text, FileId(1));
    assert!(problems.is_empty(), "{problems:?}\n{text}");
    back
}

#[test]
fn charts_of_the_corpus_go_out_and_come_back() {
    for (name, bytes) in all() {
        let (document, _) = support::import("xmi", &bytes, FileId(0));
        assert_eq!(printed(&document), document, "{name}");
        let written = support::export("xmi", &document);
        // The tool's users write a time operator within a term as a Boolean of its name.
        let other = |p: &&g7_model::Problem| {
            p.severity() == Severity::Error || !p.what.starts_with("a time operator within a term: ")
        };
        assert_eq!(written.problems.iter().filter(other).count(), 0, "{name}: {:?}", written.problems);
        let (back, problems) = support::import("xmi", written.text.as_bytes(), FileId(0));
        let errors: Vec<_> = problems.iter().filter(|p| p.severity() == Severity::Error).collect();
        assert!(errors.is_empty(), "{name}: {errors:?}");
        assert_eq!(back, document, "{name}");
    }
}
