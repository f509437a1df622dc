//! The charts of the examples and of the corpus, with the sizes of their texts and with random
//! sizes.

use std::path::{Path, PathBuf};

use g7_draw::{Extent, Options, Sizes, layout, measure};
use g7_exchange::recognise;
use g7_model::{Chart, Document, FileId, Severity};
use g7_syntax::parse_bytes;

use crate::geometry::faults;
use crate::maker::Random;

/// Random room for every symbol of a chart.
pub(crate) fn random_sizes(chart: &Chart, random: &mut Random) -> Sizes {
    let mut extent = |half: i32, up: i32, down: i32| Extent {
        left: half + if random.below(4) == 0 { random.below(300) as i32 } else { 0 },
        right: half + random.below(1500) as i32,
        up: up + if random.below(8) == 0 { random.below(400) as i32 } else { 0 },
        down: down + if random.below(5) == 0 { random.below(600) as i32 } else { 0 },
    };
    Sizes {
        steps: chart.steps().map(|_| extent(250, 0, 500)).collect(),
        transitions: chart.transitions().map(|_| extent(220, 70, 70)).collect(),
        connectors: chart.steps().map(|s| 80 * s.name.text.len() as i32).collect(),
    }
}

fn check(what: &str, document: &Document) -> usize {
    let mut checked = 0;
    for chart in document.charts() {
        let name = format!("{what}, {}", chart.name.text);
        let sizes = measure(document, chart, &Options::default());
        let p = layout(chart, &sizes, &[]);
        let found = faults(chart, &sizes, &p);
        assert!(found.is_empty(), "{name}: {found:#?}");
        let mut random = Random(checked as u64);
        for _ in 0..5 {
            let sizes = random_sizes(chart, &mut random);
            let found = faults(chart, &sizes, &layout(chart, &sizes, &[]));
            assert!(found.is_empty(), "{name} with random sizes: {found:#?}");
        }
        assert_eq!(p, layout(chart, &sizes, &[]), "{name}");
        checked += 1;
    }
    checked
}

/// The importable charts of a folder of the corpus, or of all of it (`""`); none if
/// it is absent.
pub(crate) fn corpus(part: &str) -> Vec<(String, Document)> {
    let mut all = Vec::new();
    let Some(folder) = g7_peers::corpus(part) else { return Vec::new() };
    files(&folder, None, &mut all);
    assert!(!all.is_empty(), "{}: no files", folder.display());
    let read = |file: &PathBuf| {
        let bytes = std::fs::read(file).expect("a file");
        let name = file.display().to_string();
        let (document, problems) = recognise(&name, &bytes)?.read(&bytes, FileId(0))?;
        problems.iter().all(|p| p.severity() != Severity::Error).then_some((name, document))
    };
    all.iter().filter_map(read).collect()
}

/// Collects the files of a folder with this ending, or all its files.
fn files(folder: &Path, ending: Option<&str>, all: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files(&path, ending, all);
        } else if ending.is_none_or(|ending| path.extension().is_some_and(|e| e == ending)) {
            all.push(path);
        }
    }
    all.sort();
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn examples_are_laid_out_without_overlaps() {
    let mut all = Vec::new();
    files(&root().join("examples"), Some("g7"), &mut all);
    let mut charts = 0;
    for file in &all {
        let bytes = std::fs::read(file).expect("a file");
        charts += check(&file.display().to_string(), &parse_bytes(&bytes, FileId(0)).0);
    }
    assert!(charts > 20, "only {charts} charts");
}

#[test]
fn charts_of_the_corpus_are_laid_out_without_overlaps() {
    let all = corpus("");
    let charts: usize = all.iter().map(|(file, document)| check(file, document)).sum();
    assert!(all.is_empty() || charts > 200, "only {charts} charts in {} files", all.len());
}
