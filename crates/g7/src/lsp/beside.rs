//! The files beside a chart that name its variables: io files.

use std::fs;
use std::path::Path;

use g7_ide::Positions;
use g7_model::{Said, say};
use g7_rig::{Bench, Options, Source};
use lsp_types::{Range, TextEdit, Uri};

use super::places;

/// Greatest length of an io file that is read, in bytes.
const MOST: u64 = 4 << 20;

/// The changes of io files that follow from a changed name of a chart, which is given before and after the change.
pub(super) fn renamed(
    uri: &Uri,
    before: &Source,
    after: &Source,
    name: &str,
) -> Result<Vec<(Uri, Vec<TextEdit>)>, Said> {
    let Some(path) = places::path(uri) else { return Ok(Vec::new()) };
    let io_files = io_files(&path);
    if io_files.is_empty() {
        return Ok(Vec::new());
    }
    let benches = bench(before).zip(bench(after));
    let mut changes = Vec::new();
    for (io, text) in io_files {
        let Some((old, new)) = &benches else {
            if text.contains(name) {
                return Err(say!("`{io}` may name `{name}` too: mend the errors of the chart first"));
            }
            continue;
        };
        let positions = Positions::new(&text);
        let place = |byte| places::position(&positions, &text, byte);
        let edits: Vec<TextEdit> = g7_online::renamed(&text, old, new)
            .into_iter()
            .map(|(at, to)| TextEdit::new(Range::new(place(at.start), place(at.end)), to))
            .collect();
        if let Some(uri) = places::beside(uri, &io).filter(|_| !edits.is_empty()) {
            changes.push((uri, edits));
        }
    }
    Ok(changes)
}

/// The io files that wire a chart, by name, with their texts: its own, and the others of its folder if it is the
/// only chart there.
fn io_files(chart: &Path) -> Vec<(String, String)> {
    let entries = chart.parent().and_then(|folder| fs::read_dir(folder).ok()).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort();
    let alone = names.iter().filter(|name| crate::files::is_chart(Path::new(name))).count() <= 1;
    let mine = |name: &&String| {
        let stem = name.strip_suffix(".io.toml").filter(|stem| !stem.is_empty());
        stem.is_some_and(|stem| alone || chart.file_stem().is_some_and(|own| own == stem))
    };
    let read = |name: &String| {
        let path = chart.with_file_name(name);
        let small = fs::metadata(&path).is_ok_and(|meta| meta.is_file() && meta.len() <= MOST);
        let text = small.then(|| fs::read(&path).ok()).flatten()?;
        Some((name.clone(), String::from_utf8(text).ok()?))
    };
    names.iter().filter(mine).filter_map(read).collect()
}

/// The chart of a file with its names, without its plant; `None` if it has errors.
fn bench(source: &Source) -> Option<Bench> {
    let options = Options { plant: Some("none"), ..Options::default() };
    g7_rig::build(source, &options).ok()?.0
}
