//! Every chart of the repository, for tests of grammars: files, conformance cases and blocks of the book.

use crate::house;

/// The texts that the parser reads without an error, each with its place.
///
/// # Panics
///
/// If there are fewer than a thousand.
pub fn charts() -> Vec<(String, String)> {
    let mut all = Vec::new();
    for file in house::files() {
        let name = file.display().to_string();
        if house::ends_in(&file, &["g7"]) {
            all.push((name, house::read(&file)));
        } else if house::ends_in(&file, &["md"]) && (file.starts_with("tests") || file.starts_with("docs")) {
            let blocks = blocks(&house::read(&file));
            all.extend(blocks.into_iter().map(|(line, text)| (format!("{name}:{line}"), text)));
        }
    }
    all.retain(|(_, text)| reads(text));
    assert!(all.len() > 1000, "only {} charts found", all.len());
    all
}

fn reads(text: &str) -> bool {
    let (_, problems) = g7_syntax::parse(text, g7_model::FileId(0));
    problems.iter().all(|p| p.code.severity != g7_model::Severity::Error)
}

/// The blocks of .g7 in a text, each with the line that it begins behind.
fn blocks(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut open: Option<(usize, String)> = None;
    for (i, line) in text.lines().enumerate() {
        match &mut open {
            Some(_) if line.starts_with("```") => found.extend(open.take()),
            Some((_, block)) => {
                block.push_str(line);
                block.push('\n');
            }
            None if line.starts_with("```g7") => open = Some((i + 1, String::new())),
            None => {}
        }
    }
    found
}
