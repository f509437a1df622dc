//! Everything that code and documents cite is there: decisions, sections of the semantics, rows and
//! cases of the rules, problem codes, files, links and headings.
#![allow(clippy::disallowed_methods, reason = "the tests read the sources")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use g7_model::codes;
use g7_tests::book::plain;
use g7_tests::house::{ends_in, files, none, read, root};

/// The files whose words are read.
fn texts() -> Vec<(PathBuf, String)> {
    let endings = ["rs", "md", "ts", "svelte", "g", "g7", "toml", "sh", "css", "yml", "js", "mjs"];
    let named = ["Makefile", "run"];
    let mut found = Vec::new();
    for file in files() {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if ends_in(&file, &endings) || named.contains(&name.as_str()) {
            let text = read(&file);
            found.push((file, text));
        }
    }
    found
}

/// The lines of a file that cite: all of a document, the comments of code. With their numbers.
fn prose<'t>(file: &Path, text: &'t str) -> Vec<(usize, &'t str)> {
    let lines = text.lines().enumerate().map(|(k, line)| (k + 1, line));
    if ends_in(file, &["md"]) {
        return lines.collect();
    }
    let marker =
        if ends_in(file, &["rs", "ts", "svelte", "g", "g7", "css", "js", "mjs"]) { "//" } else { "#" };
    lines.filter_map(|(k, line)| Some((k, line.get(line.find(marker)?..)?))).collect()
}

/// Numbers at the head of a text, as in `2`, `7 and 8`, `1, 2 and 3`.
fn numbers(text: &str) -> Vec<u32> {
    let mut found = Vec::new();
    for word in text.split([' ', ',']).filter(|w| !w.is_empty()) {
        let digits = word.trim_end_matches(|c: char| !c.is_ascii_digit());
        match digits.parse() {
            Ok(number) => found.push(number),
            Err(_) if word == "and" => continue,
            Err(_) => break,
        }
        if digits.len() < word.len() {
            break;
        }
    }
    found
}

/// The numbers behind a word, in any case: of decisions, of sections.
fn cited(line: &str, word: &str) -> Vec<u32> {
    let lower = line.to_lowercase();
    lower
        .match_indices(word)
        .flat_map(|(at, _)| numbers(lower.get(at + word.len()..).unwrap_or("")))
        .collect()
}

#[test]
fn numbers_are_read_as_people_write_them() {
    assert_eq!(cited("(decision 13).", "decision "), [13]);
    assert_eq!(cited("Decisions 18 and 19: literals", "decisions "), [18, 19]);
    assert_eq!(cited("by decisions 1, 2 and 3)", "decisions "), [1, 2, 3]);
    assert!(cited("a decision of the author", "decision ").is_empty());
}

/// The decisions, by number.
fn decisions() -> BTreeSet<u32> {
    let mut found = BTreeSet::new();
    for file in files().into_iter().filter(|f| f.starts_with("docs/decisions")) {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let number: u32 = name.get(..3).and_then(|n| n.parse().ok()).expect("NNN-name.md");
        assert!(
            read(&file).starts_with(&format!("# {number}. ")),
            "{name} has another number in its heading"
        );
        assert!(found.insert(number), "{name}: the number is taken");
    }
    found
}

#[test]
fn decisions_are_there() {
    let decisions = decisions();
    assert!(decisions.len() > 15, "only {} decisions", decisions.len());
    let (mut found, mut seen) = (Vec::new(), 0);
    for (file, text) in texts() {
        for (k, line) in prose(&file, &text) {
            for number in cited(line, "decision ").into_iter().chain(cited(line, "decisions ")) {
                seen += 1;
                if !decisions.contains(&number) {
                    found.push(format!("{}:{k}: decision {number}", file.display()));
                }
            }
        }
    }
    assert!(seen > 15, "only {seen} citations of decisions");
    none(&found, "decisions that are not in docs/decisions");
}

#[test]
fn sections_of_the_semantics_are_there() {
    let semantics = read("docs/spec/semantics.md");
    let (mut found, mut seen) = (Vec::new(), 0);
    for (file, text) in texts() {
        for (k, line) in prose(&file, &text) {
            let of_semantics = |at: usize| line.get(at..).unwrap_or("").strip_prefix("SEMANTICS section ");
            for number in line
                .match_indices("SEMANTICS section ")
                .filter_map(|(at, _)| of_semantics(at))
                .flat_map(numbers)
            {
                seen += 1;
                if !semantics.contains(&format!("\n## {number}. ")) {
                    found.push(format!("{}:{k}: section {number}", file.display()));
                }
            }
        }
    }
    assert!(seen > 5, "only {seen} citations of sections");
    none(&found, "sections that docs/spec/semantics.md does not have");
}

#[test]
fn cases_that_are_named_are_there() {
    let groups: BTreeSet<String> = files()
        .iter()
        .filter_map(|f| Some(f.strip_prefix("tests/spec").ok()?.parent()?.to_string_lossy().into_owned()))
        .filter(|g| !g.is_empty())
        .collect();
    let (mut found, mut seen) = (Vec::new(), 0);
    for (file, text) in texts() {
        for (k, line) in prose(&file, &text) {
            for name in line.split('`').skip(1).step_by(2) {
                let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || "-/".contains(c));
                let group = name.split_once('/').map_or("", |(group, _)| group);
                if plain && groups.contains(group) && name.matches('/').count() == 1 && !name.ends_with('/') {
                    seen += 1;
                    if !root().join(format!("tests/spec/{name}.md")).is_file() {
                        found.push(format!("{}:{k}: {name}", file.display()));
                    }
                }
            }
        }
    }
    assert!(seen > 400, "only {seen} cases are named");
    none(&found, "cases that are not in tests/spec");
}

#[test]
fn problem_codes_are_there() {
    let known: BTreeSet<&str> = codes::ALL.iter().map(|c| c.id).collect();
    let (mut found, mut seen) = (Vec::new(), 0);
    for (file, text) in texts() {
        for (k, line) in prose(&file, &text) {
            for word in line.split(|c: char| !c.is_ascii_alphanumeric()) {
                let code = word.len() == 5
                    && word.starts_with("G0")
                    && word.bytes().skip(1).all(|b| b.is_ascii_digit());
                if code {
                    seen += 1;
                    if !known.contains(word) {
                        found.push(format!("{}:{k}: {word}", file.display()));
                    }
                }
            }
        }
    }
    assert!(seen > 200, "only {seen} codes are named");
    none(&found, "problem codes that do not exist");
}

/// The folders at the root that paths begin with.
const TOPS: [&str; 7] = ["docs", "tests", "crates", "web", "examples", "benches", "fuzz"];

/// The paths in a line: from a folder at the root (`docs/spec/rules.md`), or a file of ours in
/// back-ticks (`rules.md`).
fn paths(line: &str) -> Vec<String> {
    let part = |c: char| c.is_alphanumeric() || "/._-*<>{}…".contains(c);
    let mut found = Vec::new();
    for word in line.split(|c: char| !part(c)) {
        let word = word.trim_end_matches(['.', '/']);
        if let Some((top, rest)) = word.split_once('/')
            && TOPS.contains(&top)
            && !rest.is_empty()
        {
            found.push(word.to_owned());
        }
    }
    let quoted = line.split('`').skip(1).step_by(2);
    let file =
        |w: &&str| w.chars().all(part) && [".rs", ".ts", ".svelte", ".g"].iter().any(|e| w.ends_with(e));
    found.extend(quoted.filter(file).map(str::to_owned));
    found.retain(|path| !path.contains(['*', '<', '{', '…']));
    found
}

/// Folders and files, each with all ends of its path: a file may be named from its crate.
fn ends(files: &[PathBuf]) -> BTreeSet<PathBuf> {
    let mut ends = BTreeSet::new();
    for file in files {
        for place in file.ancestors().filter(|p| !p.as_os_str().is_empty()) {
            let parts: Vec<_> = place.iter().collect();
            ends.extend((0..parts.len()).map(|k| parts.iter().skip(k).collect::<PathBuf>()));
        }
    }
    ends
}

/// Paths that a file names although they are not in the repository: what is built, and what
/// a user has.
const NOT_KEPT: &[&str] = &[
    "docs/book/book",
    "web/node_modules",
    "web/dist",
    "web/public/g7.wasm",
    "fuzz/corpus",
    "fuzz/artifacts",
    "fuzz/target",
];

#[test]
fn files_that_are_named_are_there() {
    let ends = ends(&files());
    let (mut found, mut seen) = (Vec::new(), 0);
    for (file, text) in texts() {
        // The change log tells what was; foreign charts name their own files.
        if file.ends_with("CHANGELOG.md") || file.starts_with("tests/interchange") {
            continue;
        }
        // In the book, files in back-ticks are those of a user.
        let book = file.starts_with("docs/book");
        for (k, line) in prose(&file, &text) {
            for path in paths(line).into_iter().filter(|p| p.contains('/') || !book) {
                seen += 1;
                let kept = ends.contains(Path::new(&path)) || NOT_KEPT.iter().any(|p| path.starts_with(p));
                if !kept {
                    found.push(format!("{}:{k}: {path}", file.display()));
                }
            }
        }
    }
    assert!(seen > 100, "only {seen} paths are named");
    none(&found, "files that are not there");
}

/// The anchors of a page: its headings as links write them.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut code = false;
    let mut found = BTreeSet::new();
    for line in text.lines() {
        code ^= line.trim_start().starts_with("```");
        let heading = line.trim_start_matches('#');
        if !code && heading.len() < line.len() && heading.starts_with(' ') {
            let kept = heading.trim().to_lowercase();
            let kept = kept.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
            found.insert(kept.map(|c| if c == ' ' { '-' } else { c }).collect());
        }
    }
    found
}

/// The links of a page outside code.
fn links(text: &str) -> Vec<(usize, String)> {
    let mut code = false;
    let mut found = Vec::new();
    for (k, line) in text.lines().enumerate() {
        code ^= line.trim_start().starts_with("```");
        let targets = line.split("](").skip(1).filter_map(|piece| piece.split([')', ' ']).next());
        found.extend(targets.filter(|_| !code).map(|target| (k + 1, target.to_owned())));
    }
    found
}

#[test]
fn links_lead_to_files_and_headings() {
    let pages: BTreeMap<PathBuf, String> = texts().into_iter().filter(|(f, _)| ends_in(f, &["md"])).collect();
    let (mut found, mut seen) = (Vec::new(), 0);
    for (page, text) in &pages {
        for (k, target) in links(text) {
            let (path, anchor) = target.split_once('#').map_or((&*target, None), |(p, a)| (p, Some(a)));
            if target.contains("://") || target.is_empty() {
                continue;
            }
            seen += 1;
            let leads =
                if path.is_empty() { page.clone() } else { plain(&page.parent().unwrap_or(page).join(path)) };
            let heading =
                anchor.is_none_or(|a| pages.get(&leads).is_some_and(|text| anchors(text).contains(a)));
            if !root().join(&leads).exists() || !heading {
                found.push(format!("{}:{k}: {target}", page.display()));
            }
        }
    }
    assert!(seen > 300, "only {seen} links");
    none(&found, "links that lead nowhere");
}

#[test]
fn anchors_are_made_as_github_and_mdbook_make_them() {
    let text = "# Edges, and times\n```g7\n# no heading\n```\n## `g7 test`: the runner\n#no\n";
    let want = ["edges-and-times", "g7-test-the-runner"].map(str::to_owned);
    assert_eq!(anchors(text), BTreeSet::from(want));
}
