//! A law: a file with those that it uses is the one text in which each stands in the place of its `use` line.
//!
//! Runs of items of examples and cases are moved into files of their own, nested, and put together again: the
//! program must be that of the whole text.
#![allow(clippy::disallowed_methods, reason = "the tests read examples and cases")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use g7_model::{Document, FileId, Item, Name, Place, Span, Use};
use g7_rig::Source;
use g7_tests::case;

/// True for an item that a used file can have.
fn is_movable(item: &Item) -> bool {
    !matches!(
        item,
        Item::Test(_)
            | Item::Plant(_)
            | Item::Prove(_)
            | Item::Profile(_)
            | Item::Cycle(..)
            | Item::Target(..)
            | Item::Use(_)
    )
}

/// Moves the second half of each run of movable items into a file of its own, which uses another one in turn.
fn split(items: Vec<Item>, depth: u32, files: &mut BTreeMap<String, String>) -> Vec<Item> {
    let mut left = Vec::new();
    let mut run: Vec<Item> = Vec::new();
    let mut close = |run: &mut Vec<Item>, left: &mut Vec<Item>| {
        let moved = run.split_off(run.len() / 2);
        left.append(run);
        if moved.is_empty() {
            return;
        }
        let moved = if depth > 0 { split(moved, depth - 1, files) } else { moved };
        let path = format!("d{depth}/f{}.g7", files.len());
        let document = Document { items: moved, notes: Vec::new() };
        files.insert(path.clone(), g7_syntax::print(&document, None));
        // The folder of the file in which the line stands.
        let from = if depth == 2 { String::new() } else { "../".to_owned() };
        let name = Name::new(format!("{from}{path}"), Span::default());
        left.push(Item::Use(Use { name, library: false, at: Place::default() }));
    };
    for item in items {
        if is_movable(&item) {
            run.push(item);
        } else {
            close(&mut run, &mut left);
            left.push(item);
        }
    }
    close(&mut run, &mut left);
    left
}

/// The program of a source, with the names of its variables, steps and transitions; the codes of its errors.
fn meaning(source: &Source) -> Result<String, Vec<&'static str>> {
    let (compiled, problems) = g7_compile::compile(source.whole());
    let mut wrong: Vec<&str> = source.read_problems().iter().chain(&problems).map(|p| p.code.id).collect();
    wrong.sort_unstable();
    let Some(compiled) = compiled else { return Err(wrong) };
    let symbols = &compiled.symbols;
    let names: Vec<&str> = symbols.variables.iter().map(|v| &*v.name).collect();
    let steps: Vec<String> =
        (0..symbols.steps()).map(|s| symbols.step_name(g7_engine::StepId(s)).to_owned()).collect();
    Ok(format!("{names:?} {steps:?} {:?}", compiled.program.tables()))
}

/// The number of files into which a text was split.
fn holds(name: &str, text: &str) -> usize {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    if !problems.is_empty() || document.uses().next().is_some() {
        return 0;
    }
    let mut files = BTreeMap::new();
    let items = split(document.items, 2, &mut files);
    let head = g7_syntax::print(&Document { items, notes: Vec::new() }, None);
    let mut source = Source::native("head.g7", head.clone().into_bytes(), 0);
    source.link(&mut |path| {
        Ok(files.get(path).unwrap_or_else(|| panic!("{name}: {path} of {files:?}")).clone().into_bytes())
    });
    let whole = Source::native("head.g7", text.as_bytes().to_vec(), 0);
    assert_eq!(meaning(&source), meaning(&whole), "{name}\n{head}\n{files:#?}");
    assert_eq!(source.others().len(), files.len(), "{name}: each file is read");
    files.len()
}

#[test]
fn files_put_together_are_the_one_text() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let is_chart = |p: &PathBuf| p.extension().is_some_and(|e| e == "g7");
    let mut files: usize = 0;
    for path in case::files(&root.join("examples")).into_iter().filter(is_chart) {
        let text = std::fs::read_to_string(&path).expect("a text");
        files += holds(&path.display().to_string(), &text);
    }
    for path in case::cases(&root.join("tests/spec")) {
        let text = std::fs::read_to_string(&path).expect("a text");
        let case = case::read(&text).expect("a case has its form");
        files += holds(&path.display().to_string(), &case.chart);
    }
    assert!(files > 1000, "{files} files");
}

#[test]
fn a_part_of_the_library_uses_parts_alone() {
    for part in g7_rig::LIBRARY {
        let (document, problems) = g7_syntax::parse(part.text, FileId(0));
        assert!(problems.is_empty(), "{}: {problems:?}", part.name);
        assert!(document.uses().all(|u| u.library), "{}", part.name);
        assert!(part.title().split_once(": ").is_some_and(|(_, told)| told.len() > 10), "{}", part.name);
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let tests = std::fs::read_to_string(root.join("library/tests").join(format!("{}.g7", part.name)));
        assert!(tests.is_ok_and(|t| t.starts_with(&format!("use {}\n", part.name))), "{}", part.name);
        assert!(
            root.join("docs/book/src/library").join(format!("{}.md", part.name)).is_file(),
            "{}",
            part.name
        );
    }
    assert_eq!(g7_rig::LIBRARY.len(), 14);
}
