//! The book as it is built: the pages of `docs/book/src`, and behind them the rules, the
//! decisions and every conformance case, each a page. The pages are not kept twice:
//! [`assemble`] puts them together for mdbook, and turns links between the folders of the
//! repository into links within the book.
#![allow(clippy::disallowed_methods, reason = "it reads the pages")]

pub mod blocks;
pub mod library;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Component, Path, PathBuf};

use g7_model::ProfileName;

/// The pages of the book, from the root of the repository.
const SOURCE: &str = "docs/book/src";

/// Files by their place in the repository, each with its place in the book.
type Places = BTreeMap<PathBuf, PathBuf>;

/// Puts the book together in a folder, which mdbook can then build.
///
/// # Errors
///
/// If a file cannot be read or written, or a link leads to nothing.
pub fn assemble(root: &Path, to: &Path) -> Result<(), String> {
    let places = places(root)?;
    for (file, place) in &places {
        let target = to.join("src").join(place);
        let folder = target.parent().unwrap_or(to);
        std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        if file.extension().is_some_and(|e| e == "md") {
            let text = page(root, file, &places)?;
            std::fs::write(&target, text).map_err(|e| format!("{}: {e}", target.display()))?;
        } else {
            std::fs::copy(root.join(file), &target).map_err(|e| format!("{}: {e}", file.display()))?;
        }
    }
    let settings = to.join("book.toml");
    std::fs::copy(root.join("docs/book/book.toml"), &settings)
        .map_err(|e| format!("{}: {e}", settings.display()))?;
    Ok(())
}

/// Where each file goes.
fn places(root: &Path) -> Result<Places, String> {
    let mut places = Places::new();
    for (folder, place) in
        [(SOURCE, ""), ("docs/spec", "spec"), ("docs/decisions", "decisions"), ("tests/spec", "cases")]
    {
        let mut files = Vec::new();
        walk(&root.join(folder), &mut files)?;
        for file in files {
            let inside = file.strip_prefix(root.join(folder)).map_err(|e| e.to_string())?.to_path_buf();
            places.insert(Path::new(folder).join(&inside), Path::new(place).join(inside));
        }
    }
    Ok(places)
}

fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), String> {
    let entries = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for path in entries.flatten().map(|e| e.path()) {
        if path.is_dir() {
            walk(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
}

/// A page as it stands in the book.
fn page(root: &Path, file: &Path, places: &Places) -> Result<String, String> {
    let mut text = read(root, file)?;
    if file.ends_with("SUMMARY.md") {
        text += &chapters(root, places)?;
        return Ok(text);
    }
    if file.ends_with("rules.md") {
        text = with_links_to_cases(&text, places);
    } else if let Some(case) = case_name(file) {
        let heading = text.split_inclusive('\n').next().unwrap_or("").to_owned();
        let note = format!("\nConformance case `{case}`; every build runs it.\n");
        text.insert_str(heading.len(), &note);
    }
    links_within(&text, file, places)
}

fn read(root: &Path, file: &Path) -> Result<String, String> {
    std::fs::read_to_string(root.join(file)).map_err(|e| format!("{}: {e}", file.display()))
}

/// `iec60848/rule-3-fork` of a case.
fn case_name(file: &Path) -> Option<String> {
    let inside = file.strip_prefix("tests/spec").ok()?.with_extension("");
    let parts: Vec<String> = inside.iter().map(|p| p.to_string_lossy().into_owned()).collect();
    (parts.len() == 2).then(|| parts.join("/"))
}

/// The table of rules names its cases; in the book each name is a link.
fn with_links_to_cases(text: &str, places: &Places) -> String {
    let mut out = String::new();
    for (k, piece) in text.split('`').enumerate() {
        let case = PathBuf::from(format!("tests/spec/{piece}.md"));
        match (k % 2, places.contains_key(&case)) {
            (0, _) => out += piece,
            (_, true) => {
                let _ = write!(out, "[`{piece}`](../../{})", case.display());
            }
            (_, false) => {
                let _ = write!(out, "`{piece}`");
            }
        }
    }
    out
}

/// The chapters behind those of the summary.
fn chapters(root: &Path, places: &Places) -> Result<String, String> {
    let mut text = String::from("\n# Rules and cases\n\n");
    let below = |folder: &str| -> Vec<&PathBuf> { places.keys().filter(|f| f.starts_with(folder)).collect() };
    text += &entry(root, places, 0, Path::new("docs/spec/semantics.md"))?;
    text += &entry(root, places, 0, Path::new("docs/spec/rules.md"))?;
    text += "- [Decisions]()\n";
    for file in below("docs/decisions") {
        text += &entry(root, places, 1, file)?;
    }
    text += &entry(root, places, 0, Path::new("tests/spec/README.md"))?;
    for (folder, name) in groups() {
        let cases = below(&format!("tests/spec/{folder}"));
        let _ = writeln!(text, "- [{name}]()");
        for case in cases {
            text += &entry(root, places, 1, case)?;
        }
    }
    Ok(text)
}

/// A line of the summary.
fn entry(root: &Path, places: &Places, depth: usize, file: &Path) -> Result<String, String> {
    let place = places.get(file).ok_or_else(|| format!("{} is not there", file.display()))?;
    let text = read(root, file)?;
    let title = text.lines().next().and_then(|l| l.strip_prefix("# "));
    let title = title.ok_or_else(|| format!("{}: no heading", file.display()))?;
    Ok(format!("{}- [{title}]({})\n", "  ".repeat(depth), slashes(place)))
}

/// The folders of cases with the names of their chapters.
fn groups() -> Vec<(&'static str, &'static str)> {
    let rules = |profile: ProfileName| match profile {
        ProfileName::Iec60848 => "Cases of IEC 60848 (GRAFCET)",
        ProfileName::Iec61131 => "Cases of IEC 61131-3 (SFC)",
        ProfileName::Pl7 => "Cases of PL7",
        ProfileName::Unity => "Cases of Unity Pro and Control Expert",
        ProfileName::Jgrafchart => "Cases of JGrafchart",
    };
    let mut groups: Vec<_> = ProfileName::ALL.into_iter().map(|p| (p.name(), rules(p))).collect();
    groups.push(("side-by-side", "Cases of several profiles, side by side"));
    groups.push(("litmus", "Twenty small charts that tell engines apart"));
    groups
}

fn slashes(path: &Path) -> String {
    path.iter().map(|p| p.to_string_lossy()).collect::<Vec<_>>().join("/")
}

/// Turns the links of a page into links within the book; those in code stay.
fn links_within(text: &str, file: &Path, places: &Places) -> Result<String, String> {
    let mut out = String::new();
    let mut code = false;
    for line in text.split_inclusive('\n') {
        code ^= line.trim_start().starts_with("```");
        let mut pieces = line.split("](");
        out += pieces.next().unwrap_or("");
        for piece in pieces {
            out += "](";
            match piece.split_once(')') {
                Some((target, rest)) if !code => {
                    let _ = write!(out, "{})", link(target, file, places)?);
                    out += rest;
                }
                _ => out += piece,
            }
        }
    }
    Ok(out)
}

fn link(target: &str, file: &Path, places: &Places) -> Result<String, String> {
    let (path, anchor) = target.split_once('#').map_or((target, None), |(p, a)| (p, Some(a)));
    if target.contains("://") || path.is_empty() {
        return Ok(target.to_owned());
    }
    let leads = plain(&file.parent().unwrap_or(file).join(path));
    let from = places.get(file).and_then(|p| p.parent()).unwrap_or(Path::new(""));
    let place = places.get(&leads);
    let place = place.ok_or_else(|| format!("{}: `{target}` leads out of the book", file.display()))?;
    let anchor = anchor.map_or(String::new(), |a| format!("#{a}"));
    Ok(format!("{}{}{anchor}", "../".repeat(from.iter().count()), slashes(place)))
}

/// A path without `.` and `..`.
pub fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                plain.pop();
            }
            Component::CurDir => {}
            Component::Normal(_) | Component::RootDir | Component::Prefix(_) => plain.push(part),
        }
    }
    plain
}
