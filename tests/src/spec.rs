//! Runs every case in `../spec` on every backend, as one named trial each.
//!
//! A case is a Markdown file: the reason, the source, a chart, traces. To add a case, add a file.
//! To add a backend, add a line to `BACKENDS`.
#![allow(clippy::disallowed_methods, reason = "the runner reads the cases")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use g7_model::ProfileName;
use g7_tests::case::{self, Case};
use g7_tests::engine;
use g7_tests::equations;
use g7_tests::replay::replay;
use g7_tests::subject::{self, Backend};
use libtest_mimic::{Arguments, Failed, Trial};

const BACKENDS: &[(&str, Backend)] =
    &[("engine", engine::engine), ("equations", equations::equations), ("naive", subject::naive)];

fn main() {
    let args = Arguments::from_args();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("spec");
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    assert!(!files.is_empty(), "no cases under {}", root.display());
    let trials = files.iter().flat_map(|file| trials(&root, file)).collect();
    libtest_mimic::run(&args, trials).exit();
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.filter_map(|e| e.ok().map(|e| e.path())) {
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "md")
            && path.file_stem().is_some_and(|s| s != "README")
        {
            files.push(path);
        }
    }
}

/// The trials of a file; a file in a wrong form gives one trial that fails.
fn trials(root: &Path, file: &Path) -> Vec<Trial> {
    let title = file.strip_prefix(root).unwrap_or(file).with_extension("").display().to_string();
    let folder = title.split('/').next().unwrap_or("").to_owned();
    let read = std::fs::read_to_string(file).map_err(|e| e.to_string()).and_then(|text| case::read(&text));
    let case = match read {
        Ok(case) => case,
        Err(why) => return vec![Trial::test(format!("{title} [form]"), move || Err(Failed::from(why)))],
    };
    let case = std::sync::Arc::new(case);
    let mut all = Vec::new();
    let checked = std::sync::Arc::clone(&case);
    let home = folder.clone();
    all.push(Trial::test(format!("{title} [check]"), move || check(&checked, &home).map_err(Failed::from)));
    for number in 0..case.traces.len() {
        for (backend, make) in BACKENDS {
            let case = std::sync::Arc::clone(&case);
            let named = case.traces[number].profile;
            let profile = named.map_or_else(|| case::profile_named(&folder), Ok);
            let part = match named {
                Some(p) => format!(" {}", p.name()),
                None if case.traces.len() > 1 => format!(" {}", number + 1),
                None => String::new(),
            };
            all.push(Trial::test(format!("{title}{part} [{backend}]"), move || {
                run(&case, number, profile, *make).map_err(Failed::from)
            }));
        }
    }
    all
}

fn run(case: &Case, trace: usize, profile: Result<ProfileName, String>, make: Backend) -> Result<(), String> {
    let doc = case::document(&case.chart)?;
    replay(&doc, profile?, &case.traces[trace], make)
}

/// Checks that the checker reports exactly the codes that the case names, over all profiles of its
/// traces.
fn check(case: &Case, folder: &str) -> Result<(), String> {
    let doc = case::document(&case.chart)?;
    let mut profiles: Vec<ProfileName> = case.traces.iter().filter_map(|t| t.profile).collect();
    if profiles.len() < case.traces.len().max(1) {
        profiles.push(case::profile_named(folder)?);
    }
    let own = doc.profile().map(|d| d.name).unwrap_or_default();
    let mut reported = BTreeSet::new();
    let mut words = String::new();
    for profile in profiles {
        // A document keeps its switches under its own profile.
        let (_, problems) = g7_compile::compile_with(&doc, Some(profile).filter(|p| *p != own), &[]);
        for p in problems {
            if reported.insert(p.code.id) {
                words.push_str(&format!("\n  {} {}", p.code.id, p.what));
            }
        }
    }
    let named: BTreeSet<&str> = case.problems.iter().map(String::as_str).collect();
    if reported == named {
        return Ok(());
    }
    Err(format!("`problems:` names {named:?}, the checker reports {reported:?}{words}"))
}
