//! The subjects for generated code: conformance cases and random charts; and the folders in which
//! they are compiled.
#![allow(clippy::disallowed_methods, reason = "the cases are files")]

use std::path::{Path, PathBuf};

use g7_model::ProfileName;

use super::Subject;
use crate::case::{self, Line};
use crate::generate::{Event, Script, sample};
use crate::naive::Value;

/// A folder for a test; it is deleted at the end, unless `G7_KEEP` is set.
#[derive(Debug)]
pub struct Folder(pub PathBuf);

impl Folder {
    /// A folder that no other process uses.
    pub fn new(name: &str) -> Folder {
        Folder(std::env::temp_dir().join(format!("g7-{}-{name}", std::process::id())))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if std::env::var_os("G7_KEEP").is_none() {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }
}

/// Every conformance case with a trace, as a subject for each profile under which it runs.
///
/// # Errors
///
/// A case has a wrong form.
pub fn spec() -> Result<Vec<Subject>, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("spec");
    let mut subjects: Vec<Subject> = Vec::new();
    for file in case::cases(&root) {
        let title = file.strip_prefix(&root).unwrap_or(&file).with_extension("").display().to_string();
        add(&mut subjects, &file, &title).map_err(|e| format!("{title}: {e}"))?;
    }
    if subjects.len() > 100 { Ok(subjects) } else { Err(format!("only {} cases", subjects.len())) }
}

fn add(subjects: &mut Vec<Subject>, file: &Path, title: &str) -> Result<(), String> {
    let text = std::fs::read_to_string(file).map_err(|e| e.to_string())?;
    let case = case::read(&text)?;
    let folder = title.split('/').next().unwrap_or("");
    let doc = case::document(&case.chart)?;
    // Printed code has no terminal that sets a system bit.
    let terminal =
        |line: &Line| matches!(line, Line::Row(r) if r.inputs.iter().any(|i| i.0.starts_with('%')));
    for trace in case.traces.iter().filter(|t| !t.lines.iter().any(terminal)) {
        let own = doc.profile().map(|p| p.name);
        let of_folder = || case::profile_named(folder).ok();
        let profile = trace.profile.or_else(of_folder).or(own).unwrap_or_default();
        let title = format!("{title} {}", profile.name());
        let known = subjects.iter().position(|s| s.title == title);
        if known.is_none() {
            subjects.push(Subject::new(&title, &doc, Some(profile), &case.chart)?);
        }
        let at = known.unwrap_or(subjects.len() - 1);
        if let Some(subject) = subjects.get_mut(at) {
            subject.replay(&doc, profile, trace)?;
        }
    }
    Ok(())
}

/// A ring of so many steps, each with a receptivity, an output or a delay, and an action of its
/// own. Tokens go round it, two of them one behind the other; one that waits is caught up with.
///
/// # Errors
///
/// The text cannot be read.
pub fn wide(profile: ProfileName, steps: usize, stored: bool) -> Result<Subject, String> {
    let mut text = format!("profile {}\ninput go : BOOL\ninput n : INT\n", profile.name());
    text += if stored { "var c : INT\n" } else { "" };
    let ring: Vec<usize> = (0..steps).collect();
    ring.iter().for_each(|i| text += &format!("output q{i} : BOOL\n"));
    text += "chart Ring {\n";
    for i in &ring {
        let initial = if i % (steps / 3) == 0 || *i == 1 { "initial " } else { "" };
        let more = if stored { format!("D 3ms q{i} P1 {{ c := {i} }}") } else { format!("N q{i}") };
        text += &format!("  {initial}step {i} {{ {more} }}\n");
    }
    for i in &ring {
        text += &format!("  {i} -> {} when go and n <> {i}\n", (i + 1) % steps);
    }
    text += "}\n";
    let title = format!("{} steps of {}{}", steps, profile.name(), if stored { ", stored" } else { "" });
    let mut subject = Subject::new(&title, &case::document(&text)?, None, &text)?;
    subject.play(&round(steps as i128))?;
    Ok(subject)
}

/// Scans in which the tokens of a ring move one by one, and all together where the profile has
/// no search for stability.
fn round(steps: i128) -> Script {
    let scan = |k: i128, go: bool, n: i128| {
        let inputs = [("go".to_owned(), Value::Bool(go)), ("n".to_owned(), Value::Int(n))];
        Event::Scan { now: (k as i64) * 1_000_000, inputs: inputs.into_iter().collect() }
    };
    let wait = steps / 3 + 5;
    (0..3 * steps).map(|k| scan(k, k % 7 != 0, if k < 2 * steps { wait } else { k % steps })).collect()
}

/// Random charts of a profile, beginning with a seed, until `enough` of them were made; each with
/// this many scans.
///
/// # Errors
///
/// The generator made a text that cannot be read.
pub fn random(
    profile: ProfileName,
    first: u64,
    length: usize,
    enough: impl Fn(&[Subject]) -> bool,
) -> Result<Vec<Subject>, String> {
    let mut subjects = Vec::new();
    let mut seed = first;
    while !enough(&subjects) {
        let title = format!("{} seed {seed}", profile.name());
        let sample = sample(seed, profile, length).map_err(|e| format!("{title}: {e}"))?;
        seed += 1;
        // The checker refuses charts that assign two constants at one moment.
        let Ok(mut subject) = Subject::new(&title, &sample.document, None, &sample.text) else { continue };
        subject.play(&sample.script).map_err(|e| format!("{title}: {e}"))?;
        subjects.push(subject);
    }
    Ok(subjects)
}
