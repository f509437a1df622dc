//! Charts that people wrote, from the corpus that `g7_peers` finds.

use crate::support;
use crate::support::recognise;
use std::path::{Path, PathBuf};

use g7_model::FileId;

use crate::sfc::errors;
use crate::support::Bench;

fn files(folder: &Path, out: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).expect("a folder");
    for path in entries.map(|e| e.expect("an entry").path()) {
        if path.is_dir() { files(&path, out) } else { out.push(path) }
    }
}

/// Files that are wrong, each with the line and a part of what is told.
/// Python's operators, a `%` between numbers, a `;` left out, steps and names that are not there.
const REFUSED: [(&str, usize, &str); 10] = [
    ("oscat/36_standard.st", 17, "expected `;`"),
    ("oscat/42_standard.st", 10, "expected `;`"),
    ("sfclang/Delay1_left.sfc", 36, "no step `I1`"),
    ("sfclang/Input1_right.sfc", 21, "no step `Add`"),
    ("identifier/identifier_in_sfc.test", 98, "the address of two variables"),
    ("test/first_steps.st", 174, "no program `plc_prg`"),
    ("test/first_steps_semantic_error.st", 174, "no program `plc_prg`"),
    ("test/first_steps_syntax_error.st", 148, "expected `;`"),
    ("oscat/42_standard.st", 17, "expected `;`"),
    ("identifier/identifier_in_sfc.test", 108, "nothing is called `IX3`"),
];

#[test]
fn charts_of_the_corpus_run_or_are_refused_with_their_reason() {
    let Some(folder) = g7_peers::corpus("sfc-text") else { return };
    let mut all = Vec::new();
    files(&folder, &mut all);
    assert_eq!(all.len(), 70);
    let mut ran = 0;
    for path in &all {
        let name = path.to_string_lossy().replace('\\', "/");
        let bytes = std::fs::read(path).expect("a file");
        let text = String::from_utf8_lossy(&bytes).into_owned();
        assert_eq!(recognise(&name, &bytes), Some("sfc"), "{name}");
        let (document, mut problems) = support::import("sfc", &bytes, FileId(0));
        let (compiled, more) = g7_compile::compile(&document);
        problems.extend(more);
        let expected: Vec<&(&str, usize, &str)> = REFUSED.iter().filter(|r| name.ends_with(r.0)).collect();
        if expected.is_empty() {
            assert!(compiled.is_some(), "{name}: {:?}", errors(&problems));
            ran += 1;
            continue;
        }
        for (_, number, words) in expected {
            let line = |at: u32| text[..at as usize].matches('\n').count() + 1;
            let found = problems.iter().any(|p| line(p.at.start) == *number && p.what.contains(words));
            assert!(found, "{name}: line {number}: {words}: {:?}", errors(&problems));
        }
    }
    assert_eq!(ran, 62);
}

/// The outputs of two files for the same input, scan by scan.
fn outputs(folder: &Path, name: &str, input: i64) -> Vec<i64> {
    let bytes = std::fs::read(folder.join(name)).expect(name);
    let (document, problems) = support::import("sfc", &bytes, FileId(0));
    assert_eq!(errors(&problems), Vec::<&str>::new());
    let mut bench = Bench::new(&document);
    bench.set("i", input);
    (0..40).map(|_| bench.scan().get("o")).collect()
}

/// The pairs of the corpus of which both files are whole: the one cuts a branch in two,
/// the other computes a root with the next number instead of this.
#[test]
fn pairs_of_the_corpus_are_equal() {
    let Some(folder) = g7_peers::corpus("sfc-text/VerifAPS/sfclang") else { return };
    let outputs = |name: &str, input: i64| outputs(&folder, name, input);
    for input in [-5, 0, 1, 561, 562, 563, 599, 600, 601, 30_000] {
        let (left, right) = (outputs("Transition2_left.sfc", input), outputs("Transition2_right.sfc", input));
        assert_eq!(left, right, "{input}");
        let end = if input <= 562 { 1 } else { 2 };
        assert_eq!(left.last(), Some(&end), "{input}");
    }
    for input in [0, 1, 8, 9, 100] {
        // A is left in the first scan, before its action ran: `t` stays 0. B counts in the
        // scan in which it is entered, and once more when it is left in the next.
        let left = outputs("Algo1_left.sfc", input).last().copied();
        let right = outputs("Algo1_right.sfc", input).last().copied();
        assert_eq!((left, right), (Some(2), Some(2)), "{input}");
    }
}
