//! Each deliberately broken engine is caught by a conformance case.
//!
//! `--nocapture` prints which case holds which defect, and how many see it.
#![allow(clippy::disallowed_methods, reason = "reads the cases")]

use std::path::{Path, PathBuf};

use g7_model::ProfileName;
use g7_tests::broken::{DEFECTS, engine, set};
use g7_tests::case::{self, Case};
use g7_tests::replay::replay;

struct Known {
    title: String,
    profile: ProfileName,
    trace: usize,
    case: Case,
}

fn files(folder: &Path, list: &mut Vec<PathBuf>) {
    for path in std::fs::read_dir(folder).into_iter().flatten().filter_map(|e| e.ok().map(|e| e.path())) {
        if path.is_dir() {
            files(&path, list);
        } else if path.extension().is_some_and(|e| e == "md") && !path.ends_with("README.md") {
            list.push(path);
        }
    }
    list.sort();
}

fn cases() -> Vec<Known> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("spec");
    let mut list = Vec::new();
    files(&root, &mut list);
    let mut known = Vec::new();
    for path in list {
        let title = path.strip_prefix(&root).unwrap_or(&path).with_extension("").display().to_string();
        let text = std::fs::read_to_string(&path).expect("a case can be read");
        let count = case::read(&text).expect("a case has its form").traces.len();
        for trace in 0..count {
            let case = case::read(&text).expect("a case has its form");
            let folder = title.split('/').next().unwrap_or("").to_owned();
            let named = case.traces[trace].profile;
            let Some(profile) = named.or_else(|| case::profile_named(&folder).ok()) else { continue };
            known.push(Known { title: title.clone(), profile, trace, case });
        }
    }
    known
}

/// Whether a case passes on the engine as it is broken at present.
fn passes(known: &Known) -> bool {
    let Ok(doc) = case::document(&known.case.chart) else { return false };
    replay(&doc, known.profile, &known.case.traces[known.trace], engine).is_ok()
}

#[test]
fn every_defect_is_caught_by_a_case() {
    let cases = cases();
    set(None);
    let sound: Vec<&Known> = cases.iter().filter(|k| passes(k)).collect();
    assert!(sound.len() > 500, "only {} traces pass on the sound engine", sound.len());
    let mut unseen = Vec::new();
    for (name, case, defect) in DEFECTS {
        set(Some(*defect));
        let seen: Vec<&str> = sound.iter().filter(|k| !passes(k)).map(|k| k.title.as_str()).collect();
        println!("{name}: {case}, of {} that see it", seen.len());
        if !seen.contains(case) {
            unseen.push((*name, *case, seen));
        }
    }
    set(None);
    assert!(unseen.is_empty(), "defects that their case does not see: {unseen:#?}");
}
