//! Wrong charts: each file of `tests/check` and each example on the page of a
//! problem code reports what it says, and nothing else.
#![allow(clippy::disallowed_methods, reason = "the runner reads the cases")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use g7_model::FileId;
use g7_model::codes::{self, Code};

/// A line (from 1) and the codes reported there, sorted.
type Reports = Vec<(usize, String)>;

/// The sections whose codes are reported on charts written as text; those of
/// files and of imports have tests beside their readers.
const SECTIONS: [&str; 5] = ["G01", "G02", "G03", "G04", "G050"];

fn codes_here() -> impl Iterator<Item = &'static Code> {
    codes::ALL.iter().copied().filter(|c| SECTIONS.iter().any(|s| c.id.starts_with(s)))
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Reading and checking, as every command does it.
fn reported(text: &str) -> (Reports, String) {
    let (document, mut problems) = g7_syntax::parse(text, FileId::default());
    problems.append(&mut g7_compile::check(&document));
    let mut reports: Reports = Vec::new();
    let mut words = String::new();
    for p in &problems {
        let line = text.get(..p.at.start as usize).unwrap_or(text).matches('\n').count() + 1;
        reports.push((line, p.code.id.to_owned()));
        let _ = writeln!(words, "    {line}: {} {}", p.code.id, p.what);
    }
    reports.sort();
    (reports, words)
}

/// The expectations in the comments of a case.
fn expected(text: &str) -> Reports {
    let mut reports: Reports = Vec::new();
    let mut above = 0;
    for (k, line) in text.lines().enumerate() {
        match line.trim_start().strip_prefix("//~") {
            Some(codes) => reports.extend(codes.split_whitespace().map(|c| (above, c.to_owned()))),
            None => above = k + 1,
        }
    }
    reports.sort();
    reports
}

fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(root().join(folder))
        .expect(folder)
        .map(|e| e.expect(folder).path())
        .filter(|p| p.extension().is_some_and(|e| e == ending))
        .collect();
    files.sort();
    assert!(!files.is_empty(), "no cases in {folder}");
    files
}

fn name(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

#[test]
fn each_wrong_chart_reports_what_it_lists() {
    let mut failures = String::new();
    for file in files("tests/check", "g7") {
        let text = String::from_utf8_lossy(&std::fs::read(&file).expect("a case")).into_owned();
        let want = expected(&text);
        assert!(!want.is_empty(), "{} asks for nothing", file.display());
        let (got, words) = reported(&text);
        let missing = difference(&want, &got);
        let more = difference(&got, &want);
        if want != got {
            let _ = writeln!(
                failures,
                "{}\n  missing {missing:?}\n  not asked for {more:?}\n{words}",
                name(&file)
            );
        }
    }
    assert!(failures.is_empty(), "\n{failures}");
}

/// The column and the help that a mistake asks for, behind `//?`.
fn way_out(text: &str) -> Option<(u32, &str)> {
    let asked = text.lines().find_map(|l| l.trim_start().strip_prefix("//? "))?;
    let (column, help) = asked.split_once(' ')?;
    Some((column.parse().ok()?, help))
}

/// Mistakes that people make: one message each, at the place, with the way out. A sure fix leaves
/// nothing to tell.
#[test]
fn each_typical_mistake_is_told_once_with_its_way_out() {
    let mut failures = String::new();
    let cases = files("tests/check/mistakes", "g7");
    assert!(cases.len() >= 60, "{} mistakes", cases.len());
    for file in cases {
        let text = std::fs::read_to_string(&file).expect("a case");
        let (document, mut problems) = g7_syntax::parse(&text, FileId::default());
        problems.append(&mut g7_compile::check(&document));
        let lines = g7_syntax::LineIndex::new(&text);
        let (got, words) = reported(&text);
        let Some((column, help)) = way_out(&text) else { panic!("{} asks for no help", file.display()) };
        let fits = match problems.as_slice() {
            [p] => lines.place(p.at.start).column == column && p.help.as_deref() == Some(help),
            _ => false,
        };
        if !fits || got != expected(&text) {
            let _ =
                writeln!(failures, "{}\n{words}  wanted {:?} {column}: {help}", name(&file), expected(&text));
        }
        for fix in problems.iter().flat_map(|p| &p.fixes).filter(|f| f.sure) {
            let (mended, _) = g7_model::Fix::apply(&text, FileId::default(), &[fix]);
            let (_, words) = reported(&mended);
            if !words.is_empty() {
                let _ = writeln!(failures, "{}: `{}` leaves\n{words}", name(&file), fix.label);
            }
        }
    }
    assert!(failures.is_empty(), "\n{failures}");
}

/// The items of `a` that `b` does not have.
fn difference(a: &Reports, b: &Reports) -> Reports {
    let mut rest = b.clone();
    let mut more = Vec::new();
    for report in a {
        match rest.iter().position(|r| r == report) {
            Some(k) => drop(rest.remove(k)),
            None => more.push(report.clone()),
        }
    }
    more
}

/// Words of the cases in another order, left out or doubled: the strangest
/// documents that still read like charts. Whatever comes out, it comes out.
#[test]
fn shuffled_charts_are_checked_to_the_end() {
    let mut chance = 1u64;
    let mut next = |below: usize| {
        chance = chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (chance >> 33) as usize % below.max(1)
    };
    let mut problems = 0;
    for file in files("tests/check", "g7") {
        let text = String::from_utf8_lossy(&std::fs::read(&file).expect("a case")).into_owned();
        let words: Vec<&str> = text.split_inclusive([' ', '\n']).filter(|w| !w.contains("//~")).collect();
        // The empty file has no words to shuffle.
        let rounds = if words.len() > 10 { 30 } else { 0 };
        for _ in 0..rounds {
            let mut mixed = words.clone();
            for _ in 0..=next(6) {
                let (a, b) = (next(mixed.len()), next(mixed.len()));
                match next(3) {
                    0 => mixed.swap(a, b),
                    1 => mixed[a] = words[b % words.len()],
                    _ => drop(mixed.remove(a)),
                }
            }
            problems += reported(&mixed.concat()).0.len();
        }
    }
    assert!(problems > 0, "shuffling has made nothing wrong");
}

#[test]
fn the_case_of_a_code_reports_it() {
    let cases = files("tests/check", "g7");
    for code in codes_here() {
        let id = code.id.to_lowercase();
        let own = cases.iter().find(|f| name(f).starts_with(&format!("{id}-")));
        let Some(own) = own else { panic!("{} has no case in tests/check", code.id) };
        let text = String::from_utf8_lossy(&std::fs::read(own).expect("a case")).into_owned();
        assert!(
            expected(&text).iter().any(|(_, c)| c == code.id),
            "{} does not ask for its code",
            own.display()
        );
    }
}

#[test]
fn the_examples_of_each_page_are_as_wrong_as_they_say() {
    let mut failures = String::new();
    for code in codes_here() {
        let file = root().join(format!("docs/book/src/problems/{}.md", code.id));
        let Ok(page) = std::fs::read_to_string(&file) else {
            let _ = writeln!(failures, "{} has no page", code.id);
            continue;
        };
        if !page.starts_with(&format!("# {}: {}\n", code.id, code.title)) {
            let _ = writeln!(failures, "{}: the heading is not `# {}: {}`", code.id, code.id, code.title);
        }
        if !page.contains(code.source) {
            let _ = writeln!(failures, "{}: the source `{}` is not named", code.id, code.source);
        }
        for (kind, text) in blocks(&page) {
            let (got, words) = reported(&text);
            let fine = match kind.as_str() {
                "g7,wrong" => !got.is_empty() && got.iter().all(|(_, c)| c == code.id),
                "g7" => got.is_empty(),
                _ => true,
            };
            if !fine {
                let _ = writeln!(failures, "{}, block {kind}:\n{text}\n{words}", code.id);
            }
        }
    }
    assert!(failures.is_empty(), "\n{failures}");
}

/// The fenced blocks of a page, each with what stands behind its fence.
fn blocks(page: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut open: Option<(String, String)> = None;
    for line in page.lines() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(kind)) => open = Some((kind.trim().to_owned(), String::new())),
            (Some(_), Some(_)) => found.extend(open.take()),
            (Some((_, text)), None) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, None) => {}
        }
    }
    found
}
