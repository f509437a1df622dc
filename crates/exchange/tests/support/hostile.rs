//! Files made to break a reader: it ends soon, with words, never with a panic.

use super::{import, recognise};
use std::time::{Duration, Instant};

use g7_model::{Document, FileId, Problem};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

/// Reads a file: its problems lie in it, and what came of it goes through the checker.
pub(crate) fn survives(format: &str, file: &[u8]) -> (Document, Vec<Problem>) {
    recognise("", file);
    let (document, problems) = import(format, file, FileId(0));
    for p in &problems {
        assert!(p.at.start <= p.at.end && p.at.end as usize <= file.len().max(1), "{p:?}");
    }
    let _ = g7_compile::compile(&document);
    (document, problems)
}

/// The codes of a file that gives no chart, soon.
pub(crate) fn refused(format: &str, file: &[u8]) -> Vec<&'static str> {
    let (document, problems) = within(30, || survives(format, file));
    assert_eq!(document.charts().count(), 0);
    problems.iter().map(|p| p.code.id).collect()
}

/// One change of a file.
#[derive(Clone, Debug)]
enum Change {
    Set(usize, u8),
    Cut(usize, usize),
    Copy(usize, usize, usize),
    Put(usize, &'static str),
}

fn change(words: Vec<&'static str>) -> impl Strategy<Value = Change> {
    let place = any::<prop::sample::Index>().prop_map(|i| i.index(1 << 20));
    prop_oneof![
        (place.clone(), any::<u8>()).prop_map(|(i, b)| Change::Set(i, b)),
        (place.clone(), 0usize..200).prop_map(|(i, n)| Change::Cut(i, n)),
        (place.clone(), place.clone(), 0usize..400).prop_map(|(i, j, n)| Change::Copy(i, j, n)),
        (place, prop::sample::select(words)).prop_map(|(i, w)| Change::Put(i, w)),
    ]
}

fn apply(file: &mut Vec<u8>, change: &Change) {
    let len = file.len().max(1);
    match change {
        Change::Set(i, b) => {
            if let Some(byte) = file.get_mut(i % len) {
                *byte = *b;
            }
        }
        Change::Cut(i, n) => {
            let from = (i % len).min(file.len());
            file.drain(from..(from + n).min(file.len()));
        }
        Change::Copy(i, j, n) => {
            let from = (i % len).min(file.len());
            let piece = file[from..(from + n).min(file.len())].to_vec();
            let at = (j % len).min(file.len());
            file.splice(at..at, piece);
        }
        Change::Put(i, word) => {
            let at = (i % len).min(file.len());
            file.splice(at..at, word.bytes());
        }
    }
}

/// Reads changed files: `words` are put into them besides bytes and pieces of their own.
pub(crate) fn changed(format: &str, files: Vec<Vec<u8>>, words: &[&'static str], cases: u32) {
    changed_for(files, words, (cases, 12), |file| _ = survives(format, file));
}

/// The same for a reader of one's own: so many cases, each with fewer changes than that.
pub(crate) fn changed_for(
    files: Vec<Vec<u8>>,
    words: &[&'static str],
    (cases, most): (u32, usize),
    read: impl Fn(&[u8]),
) {
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    let changes = prop::collection::vec(change(words.to_vec()), 1..most);
    let strategy = (prop::sample::select(files), changes);
    TestRunner::new(config)
        .run(&strategy, |(mut file, changes)| {
            changes.iter().for_each(|c| apply(&mut file, c));
            read(&file);
            Ok(())
        })
        .expect("no file breaks the reader");
}

/// Runs something that has to end within so many seconds.
#[allow(clippy::disallowed_methods, reason = "how long the machine takes is what is asked here")]
pub(crate) fn within<T>(seconds: u64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    assert!(start.elapsed() < Duration::from_secs(seconds));
    result
}
