//! The book and the README: each chart in them is one, each wrong one is wrong,
//! each link leads somewhere, and the summary lists every page.
#![allow(clippy::disallowed_methods, reason = "the tests read the pages")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use g7_compile::plant;
use g7_model::{FileId, Problem, Severity};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All pages of the book, and the README.
fn pages() -> Vec<PathBuf> {
    let mut pages = vec![root().join("README.md")];
    let mut folders = vec![root().join("docs/book/src")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder of the book") {
            let path = entry.expect("a page").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "md") {
                pages.push(path);
            }
        }
    }
    pages.sort();
    assert!(pages.len() > 50, "only {} pages", pages.len());
    pages
}

fn text(page: &Path) -> String {
    std::fs::read_to_string(page).unwrap_or_else(|e| panic!("{}: {e}", page.display()))
}

/// The fenced blocks of a page: the line of the fence, what stands behind it, the text.
fn blocks(page: &str) -> Vec<(usize, String, String)> {
    let mut found = Vec::new();
    let mut open: Option<(usize, String, String)> = None;
    for (k, line) in page.lines().enumerate() {
        match (&mut open, line.trim_start().strip_prefix("```")) {
            (None, Some(kind)) => open = Some((k + 1, kind.trim().to_owned(), String::new())),
            (Some(_), Some(_)) => found.extend(open.take()),
            (Some((.., text)), None) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a block is never closed");
    found
}

/// Everything that is wrong with a document: reading, charts, plants.
fn problems(text: &str) -> Vec<Problem> {
    let (doc, mut problems) = g7_syntax::parse(text, FileId::default());
    let (compiled, mut more) = g7_compile::compile(&doc);
    problems.append(&mut more);
    for p in compiled.iter().flat_map(|c| plant::plants(&doc).map(move |p| (c, p))) {
        problems.append(&mut plant::compile_plant(&doc, p.1, p.0, &[]).1);
    }
    problems
}

#[test]
fn charts_compile_and_wrong_ones_do_not() {
    let mut found = String::new();
    let (mut right, mut wrong) = (0, 0);
    for page in pages() {
        for (line, kind, chart) in blocks(&text(&page)) {
            // Mistakes in tests are told by the command line, which has tests of its own.
            if page.ends_with("G0550.md") || page.ends_with("G0551.md") || page.ends_with("G0552.md") {
                continue;
            }
            let place = format!("{}:{line}", page.display());
            match kind.as_str() {
                "g7" => {
                    right += 1;
                    for p in problems(&chart).iter().filter(|p| p.severity() == Severity::Error) {
                        let _ = writeln!(found, "{place}: {} {}", p.code.id, p.what);
                    }
                }
                "g7,wrong" => {
                    wrong += 1;
                    if problems(&chart).is_empty() && !faults(&chart) {
                        let _ = writeln!(found, "{place}: nothing is wrong with it");
                    }
                }
                _ => {}
            }
        }
    }
    assert!(found.is_empty(), "\n{found}");
    assert!(right > 80 && wrong > 40, "{right} right and {wrong} wrong charts found");
}

/// Whether a chart that checks stops in its first scans.
fn faults(chart: &str) -> bool {
    let (doc, _) = g7_syntax::parse(chart, FileId::default());
    let Some(compiled) = g7_compile::compile(&doc).0 else { return true };
    let mut state = g7_engine::State::new(&compiled.program);
    let inputs = compiled.program.tables().inputs;
    let words = state.words().get(inputs.start as usize..inputs.end as usize).unwrap_or(&[]).to_vec();
    (0..3).any(|k| g7_engine::scan(&compiled.program, &mut state, &words, k * 10_000_000).is_err())
}

#[test]
fn links_lead_to_files() {
    let mut found = String::new();
    let mut links = 0;
    for page in pages() {
        let whole = text(&page);
        let inside: String = blocks(&whole).into_iter().map(|(.., t)| t).collect();
        for piece in whole.split("](").skip(1) {
            let target = piece.split([')', ' ', '\n']).next().unwrap_or("");
            let file = target.split('#').next().unwrap_or("");
            let elsewhere = target.contains("://") || file.is_empty();
            if elsewhere || inside.contains(&format!("]({piece}")) {
                continue;
            }
            links += 1;
            if !page.parent().is_some_and(|p| p.join(file).exists()) {
                let _ = writeln!(found, "{}: {target}", page.display());
            }
        }
    }
    assert!(found.is_empty(), "links that lead nowhere:\n{found}");
    assert!(links > 50, "only {links} links found");
}

#[test]
fn the_summary_lists_every_page() {
    let source = root().join("docs/book/src");
    let summary = text(&source.join("SUMMARY.md"));
    let mut found = String::new();
    for page in pages() {
        let Ok(name) = page.strip_prefix(&source) else { continue };
        let name = name.display().to_string().replace('\\', "/");
        if name == "SUMMARY.md" {
            continue;
        }
        let heading = text(&page).lines().next().and_then(|l| l.strip_prefix("# ").map(str::to_owned));
        let Some(heading) = heading else {
            let _ = writeln!(found, "{name} does not begin with a heading");
            continue;
        };
        if !summary.contains(&format!("[{heading}]({name})")) {
            let _ = writeln!(found, "[{heading}]({name}) is not in the summary");
        }
    }
    assert!(found.is_empty(), "\n{found}");
}
