//! The pages on problems: each stands in three languages, with the same parts and the same code.
#![allow(clippy::disallowed_methods, reason = "the tests read the pages")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use g7_model::{Language, codes};
use g7_page::explain;

/// The languages besides English, each with its folder, its heading for the way out and its word for a source.
const OTHERS: [(&str, &str, &str, &str); 2] = [
    ("fr", "fr/problems", "## Comment corriger", "Source : "),
    ("pt", "pt/problems", "## Como corrigir", "Fonte: "),
];

/// The first line of a page, as French writes a colon and as the others do.
fn heading(id: &str, title: &str, language: Language) -> String {
    let colon = if language == Language::French { " :" } else { ":" };
    format!("# {id}{colon} {title}")
}

#[test]
fn the_title_of_a_code_is_the_heading_of_its_page() {
    for code in codes::ALL {
        for language in Language::ALL {
            let page = explain(code.id, language).expect("a page");
            let title = code.title_in(language);
            assert_eq!(page.lines().next(), Some(&*heading(code.id, &title, language)));
        }
    }
}

/// The pages of a folder of the book, by code.
fn pages(folder: &str) -> BTreeMap<String, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/book").join(folder);
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut found = BTreeMap::new();
    for path in entries.map(|entry| entry.expect("a page").path()) {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let id = name.strip_suffix(".md").unwrap_or_else(|| panic!("{name} is no page"));
        found.insert(id.to_owned(), std::fs::read_to_string(&path).expect("a text"));
    }
    found
}

/// The parts of a page: what stands between empty lines, and each block of code with its fences.
fn parts(page: &str) -> Vec<String> {
    let (mut found, mut part, mut code) = (Vec::new(), String::new(), false);
    for line in page.lines() {
        code ^= line.starts_with("```");
        if line.is_empty() && !code {
            found.push(std::mem::take(&mut part));
        } else {
            part.push_str(line);
            part.push('\n');
        }
    }
    assert!(!code, "a block is never closed");
    found.push(part);
    found.retain(|p| !p.is_empty());
    found
}

/// The kind of a part: a block of code, whole, or a heading, a list of so many items, a paragraph.
fn kind(part: &str) -> String {
    let items = part.lines().filter(|line| line.starts_with("- ")).count();
    match part.split(' ').next().unwrap_or("") {
        _ if part.starts_with("```") => part.to_owned(),
        heading @ ("#" | "##") => heading.to_owned(),
        "-" => format!("{items} items"),
        _ => "paragraph".to_owned(),
    }
}

/// The words in back-ticks outside of code, which are the same in each language. Of a note that silences a
/// warning its reason is not: the note counts up to its code.
fn words(page: &str) -> Vec<String> {
    let prose: Vec<String> = parts(page).into_iter().filter(|p| !p.starts_with("```")).collect();
    let prose = prose.concat();
    let spans = prose.split('`').skip(1).step_by(2);
    let mut found: Vec<String> = spans
        .map(|span| {
            let span = span.split_whitespace().collect::<Vec<_>>().join(" ");
            match span.split_once(": ") {
                Some((note, _)) if note.starts_with("// allow ") => note.to_owned(),
                _ => span,
            }
        })
        .collect();
    found.sort();
    found
}

#[test]
fn each_page_stands_in_each_language_with_the_same_parts_and_the_same_code() {
    let english = pages("src/problems");
    assert_eq!(english.len(), codes::ALL.len());
    let mut blocks = 0;
    for (language, folder, ..) in OTHERS {
        let own = pages(folder);
        let ids = |pages: &BTreeMap<String, String>| pages.keys().cloned().collect::<BTreeSet<_>>();
        assert_eq!(ids(&own), ids(&english), "{language}");
        for (id, page) in &own {
            let [here, there] =
                [page, &english[id]].map(|page| parts(page).iter().map(|p| kind(p)).collect::<Vec<_>>());
            assert_eq!(here, there, "{language} {id}");
            assert_eq!(words(page), words(&english[id]), "{language} {id}");
            blocks += here.iter().filter(|p| p.starts_with("```")).count();
        }
    }
    assert!(blocks > 350, "only {blocks} blocks");
}

#[test]
fn each_page_is_written_in_its_language() {
    let english = pages("src/problems");
    for (language, folder, way_out, source) in OTHERS {
        for (id, page) in pages(folder) {
            let colon = if language == "fr" { " : " } else { ": " };
            assert!(page.starts_with(&format!("# {id}{colon}")), "{language} {id}");
            assert_eq!(page.lines().filter(|line| *line == way_out).count(), 1, "{language} {id}");
            assert!(parts(&page).last().is_some_and(|p| p.starts_with(source)), "{language} {id}");
            let theirs: BTreeSet<String> = parts(&english[&id]).into_iter().collect();
            let kept = parts(&page).into_iter().find(|p| !p.starts_with("```") && theirs.contains(p));
            assert_eq!(kept, None, "{language} {id}: English");
            // One spelling of the word, that of the page's labels.
            assert!(!page.contains("receptiv"), "{language} {id}");
        }
    }
    for (id, page) in english {
        assert!(parts(&page).last().is_some_and(|p| p.starts_with("Source: ")), "{id}");
    }
}

#[test]
fn a_page_is_found_by_its_language() {
    for language in Language::ALL {
        let other = OTHERS.into_iter().find(|(tag, ..)| *tag == language.tag());
        for (id, page) in pages(other.map_or("src/problems", |(_, folder, ..)| folder)) {
            assert_eq!(explain(&id.to_lowercase(), language), Some(page), "{language:?} {id}");
        }
    }
    assert_eq!(explain("G9999", Language::French), None);
}
