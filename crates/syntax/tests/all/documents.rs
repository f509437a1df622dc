//! The charts in the book and in the conformance cases are read without a problem.
#![allow(clippy::disallowed_methods, reason = "a test reads the files that it is about")]

use g7_model::{Document, FileId, codes};
use g7_syntax::{LineIndex, parse, print};
use std::path::{Path, PathBuf};

fn pages(folder: &Path, ending: &str, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            pages(&path, ending, into);
        } else if path.extension().is_some_and(|e| e == ending) {
            into.push(path);
        }
    }
}

/// The blocks marked just `g7`, each with the line it begins on.
fn blocks(page: &str) -> Vec<(usize, String)> {
    marked_blocks(page, "g7")
}

fn marked_blocks(page: &str, mark: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut fence = "";
    let mut block: Option<(usize, String)> = None;
    for (i, line) in page.lines().enumerate() {
        let ticks = line.len() - line.trim_start_matches('`').len();
        if fence.is_empty() && ticks >= 3 {
            fence = &line[..ticks];
            block = (&line[ticks..] == mark).then(|| (i + 2, String::new()));
        } else if !fence.is_empty() && line == fence {
            fence = "";
            found.extend(block.take());
        } else if let Some((_, text)) = &mut block {
            text.push_str(line);
            text.push('\n');
        }
    }
    found
}

/// The fault of the canonical form of a document, if it has one.
fn misprint(text: &str, document: &Document) -> Option<String> {
    for source in [None, Some(text)] {
        let printed = print(document, source);
        let (again, problems) = parse(&printed, FileId(0));
        if !problems.is_empty() || again != *document {
            return Some(format!("reads otherwise when printed: {problems:?}\n{printed}"));
        }
        let twice = print(&again, source.map(|_| &*printed));
        if twice != printed {
            return Some(format!("printed twice is not the same:\n{printed}\n-- and --\n{twice}"));
        }
    }
    None
}

fn wrong_blocks(folder: &str, at_least: usize) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(folder);
    let mut files = Vec::new();
    pages(&root, "md", &mut files);
    let mut seen = 0;
    let mut wrong = Vec::new();
    for file in files {
        let page = std::fs::read_to_string(&file).expect("a readable page");
        for (line, text) in blocks(&page) {
            seen += 1;
            let (document, problems) = parse(&text, FileId(0));
            if document.items.is_empty() {
                wrong.push(format!("{}:{line}: nothing in the block", file.display()));
            }
            if problems.is_empty() {
                wrong.extend(misprint(&text, &document).map(|w| format!("{}:{line}: {w}", file.display())));
            }
            let lines = LineIndex::new(&text);
            for p in problems {
                let place = lines.place(p.at.start);
                let at = line as u32 + place.line - 1;
                wrong.push(format!(
                    "{}:{at}:{}: {} {p} ({:?})",
                    file.display(),
                    place.column,
                    p.code.id,
                    p.help
                ));
            }
        }
    }
    assert!(seen >= at_least, "only {seen} blocks in {folder}");
    wrong
}

#[test]
fn charts_of_the_book_are_read() {
    let wrong = wrong_blocks("docs/book", 30);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn charts_of_the_cases_are_read() {
    let wrong = wrong_blocks("tests/spec", 50);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_examples_are_read_and_stand_in_canonical_form() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut files = Vec::new();
    pages(&root, "g7", &mut files);
    assert!(files.len() > 5, "only {} examples", files.len());
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a readable example");
        let (document, problems) = parse(&text, FileId(0));
        assert!(problems.is_empty(), "{}: {problems:?}", file.display());
        let wrong = misprint(&text, &document);
        assert!(wrong.is_none(), "{}: {wrong:?}", file.display());
        assert!(print(&document, Some(&text)) == text, "{} is not as `g7 fmt` writes it", file.display());
    }
}

const DURATIONS: &str = "\
input a : BOOL

chart G every 120s {
  initial step 1 { D 60s go }
  1 -> 1 when X1.t > 90s
}

test \"t\" {
  pulse a for 0d
  wait 60s
  wait until a within T#1m_30s
}

prove after a within 90m expect not a
";

/// Written durations stay as they are; those of a tree alone are short, large units first.
#[test]
fn durations_are_printed_as_written_else_in_their_natural_form() {
    let (document, problems) = parse(DURATIONS, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    assert_eq!(print(&document, Some(DURATIONS)), DURATIONS);
    let bare = print(&document, None);
    for part in [
        "every 2m {",
        "D 1m go",
        "X1.t > 1m30s",
        "for 0s\n",
        "wait 1m\n",
        "within 1m30s\n",
        "within 1h30m expect",
    ] {
        assert!(bare.contains(part), "{part} in\n{bare}");
    }
    assert_eq!(misprint(DURATIONS, &document), None);
}

#[test]
fn a_number_in_brackets_keeps_its_spelling() {
    for (e, want) in [
        ("a · not (0d)", "a · not (0d)"),
        ("a and (( 16#FF )) > n", "a and 16#FF > n"),
        ("not ([2.50e1] > x)", "not (2.50e1 > x)"),
        ("(1h) / 2 > t", "(1h) / 2 > t"),
    ] {
        let text = format!("chart G {{\n  initial step 1\n  1 -> 1 when {e}\n}}\n");
        let (document, problems) = parse(&text, FileId(0));
        assert!(problems.is_empty(), "{e}: {problems:?}");
        let printed = print(&document, Some(&text));
        assert!(printed.contains(&format!("when {want}\n")), "{e}: {printed}");
        assert_eq!(misprint(&text, &document), None, "{e}");
    }
}

/// The pages of the codes of files and words are about what the reader reports.
#[test]
fn the_pages_of_the_codes_of_reading_hold() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let cases: Vec<String> = std::fs::read_dir(root.join("tests/check"))
        .expect("the cases")
        .map(|e| e.expect("a case").file_name().to_string_lossy().into_owned())
        .collect();
    // A file that is too large, no UTF-8 or full of mistakes is tried in `hostile.rs` and `problems.rs`.
    let no_text = ["G0001", "G0008", "G0010"];
    for code in codes::ALL.iter().filter(|c| c.id.starts_with("G00")) {
        let page = root.join(format!("docs/book/src/problems/{}.md", code.id));
        let page = std::fs::read_to_string(&page).unwrap_or_else(|e| panic!("{}: {e}", code.id));
        assert!(page.starts_with(&format!("# {}: {}\n", code.id, code.title)), "{}", code.id);
        assert!(page.contains(code.source), "{}", code.id);
        let case = format!("{}-", code.id.to_lowercase());
        assert!(no_text.contains(&code.id) || cases.iter().any(|c| c.starts_with(&case)), "{case}");
        for (_, wrong) in marked_blocks(&page, "g7,wrong") {
            let (_, problems) = parse(&wrong, FileId(0));
            assert!(
                !problems.is_empty() && problems.iter().all(|p| p.code.id == code.id),
                "{wrong}{problems:#?}"
            );
        }
    }
}

/// Texts that are wrong in one place: the start of a chart, a chart without a
/// line, a chart without a word. All end, with or without a problem.
#[test]
fn broken_charts_of_the_cases_are_survived() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/spec");
    let mut files = Vec::new();
    pages(&root, "md", &mut files);
    files.sort();
    let mut broken = 0;
    for file in files.iter().step_by(5) {
        let page = std::fs::read_to_string(file).expect("a readable page");
        for (_, text) in blocks(&page) {
            for cut in (0..text.len()).step_by(7).filter(|i| text.is_char_boundary(*i)) {
                let (start, rest) = text.split_at(cut);
                let after = rest.split_once(|c: char| !c.is_alphanumeric()).map_or("", |(_, after)| after);
                for wrong in [start, rest, &format!("{start} {after}"), &format!("{start} }} {rest}")] {
                    let (document, problems) = parse(wrong, FileId(0));
                    let printed = print(&document, Some(wrong));
                    broken += usize::from(!problems.is_empty());
                    let (again, more) = parse(&printed, FileId(0));
                    assert!(!problems.is_empty() || more.is_empty() && again == document, "{wrong}");
                }
            }
        }
    }
    assert!(broken > 500, "only {broken} broken texts");
}
