//! The book and the README: each chart in them is correct, each one marked wrong is wrong, the
//! summary lists every page, the function blocks do what their page says, and the book that
//! `make book` builds has every conformance case as a page.
#![allow(clippy::disallowed_methods, reason = "the tests read the pages")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use g7_model::{Problem, ProfileName, Severity, StandardFunction};
use g7_rig::Source;
use g7_tests::book::{assemble, blocks, library};
use g7_tests::generated::cases::Folder;
use g7_tests::{engine, replay, subject};

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

/// The fenced blocks of a page: the line of the fence, the words after it, the text.
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

/// Reads a chart of the book. It can use the parts of the library, and no file.
fn read(text: &str) -> Source {
    let mut source = Source::native("book.g7", text.as_bytes().to_vec(), 0);
    source.link(&mut |path| panic!("{path} is no file of the book"));
    source
}

/// All problems of a document: syntax, charts, plants.
fn problems(text: &str) -> Vec<Problem> {
    let source = read(text);
    let mut problems = source.read_problems();
    problems.extend(source.about(g7_compile::check(source.whole())));
    problems
}

/// The first cells of the page's table are the functions of the language, each once.
#[test]
fn the_page_of_functions_lists_each_of_them() {
    let page = text(&root().join("docs/book/src/language/functions.md"));
    let cells = page.lines().filter_map(|l| l.strip_prefix("| `")?.split(" |").next());
    let words = cells.flat_map(|cell| cell.split(['`', ' ']).filter(|w| !w.is_empty()));
    let mut listed: Vec<&str> = words.collect();
    let mut functions: Vec<&str> = StandardFunction::ALL.into_iter().map(|f| f.row().name).collect();
    listed.sort_unstable();
    functions.sort_unstable();
    assert_eq!(listed, functions);
}

#[test]
fn charts_compile_and_wrong_ones_do_not() {
    let mut found = String::new();
    let (mut right, mut wrong) = (0, 0);
    for page in pages() {
        for (line, kind, chart) in blocks(&text(&page)) {
            // The command line reports mistakes in tests, and has tests of its own for them.
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

/// True if a chart without problems faults in its first scans.
fn faults(chart: &str) -> bool {
    let Some(compiled) = g7_compile::compile(read(chart).whole()).0 else { return true };
    let mut state = g7_engine::State::new(&compiled.program);
    let inputs = compiled.program.tables().inputs;
    let words = state.words().get(inputs.start as usize..inputs.end as usize).unwrap_or(&[]).to_vec();
    (0..3).any(|k| g7_engine::scan(&compiled.program, &mut state, &words, k * 10_000_000).is_err())
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

/// The sections of the page of function blocks.
fn sections() -> Vec<blocks::Section> {
    blocks::sections(&text(&root().join(blocks::PAGE))).unwrap_or_else(|why| panic!("{why}"))
}

#[test]
fn function_blocks_do_what_their_page_says() {
    let sections = sections();
    let names: Vec<&str> = sections.iter().map(|s| s.kind.name()).collect();
    assert_eq!(names, g7_model::FbKind::ALL.map(g7_model::FbKind::name));
    for section in sections {
        let name = section.kind.name();
        let members = section.kind.members().iter().map(|(pin, ty, _)| ((*pin).to_owned(), ty.to_string()));
        assert_eq!(section.pins, members.collect::<Vec<_>>(), "{name}");
        let document = g7_tests::case::document(&section.case.chart).expect(name);
        let trace = section.case.traces.first().expect(name);
        for backend in [engine::engine, subject::naive] {
            let done = replay::replay(&document, ProfileName::Iec61131, trace, backend);
            assert_eq!(done, Ok(()), "{name}");
        }
    }
}

#[test]
fn the_chronograms_are_those_of_the_runs() {
    let page = root().join(blocks::PAGE);
    for section in sections() {
        let drawn = section.chronogram().unwrap_or_else(|why| panic!("{why}"));
        let kept = text(&page.with_file_name(section.picture()));
        assert_eq!(kept, drawn, "{}: draw it again with `make blocks`", section.picture());
        assert!(text(&page).contains(&format!("]({})", section.picture())), "{}", section.picture());
    }
}

#[test]
fn the_pictures_of_the_library_are_those_of_the_runs() {
    for part in g7_rig::LIBRARY {
        let page = text(&root().join(library::PAGES).join(format!("{}.md", part.name)));
        let options = library::options(&page, part.name).unwrap_or_else(|why| panic!("{why}"));
        let drawn = library::chronogram(&root(), part.name, options).unwrap_or_else(|why| panic!("{why}"));
        let kept = text(&library::picture(&root(), part.name));
        assert_eq!(kept, drawn, "{}: draw it again with `make blocks`", part.name);
        assert!(drawn.matches("g7-name").count() > 1, "{}: lanes", part.name);
    }
}

#[test]
fn each_case_is_a_page_of_the_book() {
    let folder = Folder::new("book");
    assemble(&root(), &folder.0).unwrap_or_else(|why| panic!("{why}"));
    let source = folder.0.join("src");
    let summary = text(&source.join("SUMMARY.md"));
    let mut cases = 0;
    for group in ["iec60848", "iec61131", "pl7", "unity", "jgrafchart", "side-by-side", "litmus"] {
        for entry in std::fs::read_dir(root().join("tests/spec").join(group)).expect("cases") {
            let case = entry.expect("a case").path();
            let name = format!("{group}/{}", case.file_name().unwrap_or_default().to_string_lossy());
            let heading = text(&case).lines().next().unwrap_or("").trim_start_matches("# ").to_owned();
            assert!(summary.contains(&format!("[{heading}](cases/{name})")), "{name} is in no chapter");
            cases += 1;
        }
    }
    assert!(cases > 400, "only {cases} cases");
    // No folder of cases is left out, and each entry of the summary is a page.
    let folders = std::fs::read_dir(root().join("tests/spec")).expect("the cases").flatten();
    assert_eq!(folders.filter(|e| e.path().is_dir()).count(), 7);
    let entries = summary.split("](").skip(1).filter_map(|piece| piece.split(')').next());
    for page in entries.filter(|page| !page.is_empty()) {
        assert!(source.join(page).is_file(), "{page} is not there");
    }
    if g7_peers::tool("mdbook") {
        let built = std::process::Command::new("mdbook").arg("build").arg(&folder.0).output();
        let built = built.expect("mdbook starts");
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    }
}
