//! Each engine that is broken on purpose is caught by a conformance case.
//!
//! `--nocapture` prints which case catches which defect, and how many cases fail on it.
#![allow(clippy::disallowed_methods, reason = "reads the cases")]

use std::collections::BTreeMap;
use std::path::Path;

use g7_engine::Tables;
use g7_model::ProfileName;
use g7_tests::broken::{DEFECTS, engine, equations, is_of_instructions, leave_out, set};
use g7_tests::case::{self, Case};
use g7_tests::replay::replay;
use g7_tests::subject::Backend;

struct Known {
    title: String,
    profile: ProfileName,
    trace: usize,
    case: Case,
}

fn cases() -> Vec<Known> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("spec");
    let mut known = Vec::new();
    for path in case::cases(&root) {
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

/// True if a case passes on a backend with the present defect.
fn passes(known: &Known, backend: Backend) -> bool {
    let Ok(doc) = case::document(&known.case.chart) else { return false };
    replay(&doc, known.profile, &known.case.traces[known.trace], backend).is_ok()
}

#[test]
fn every_defect_is_caught_by_a_case() {
    caught(engine, false);
}

#[test]
fn every_defect_of_the_tables_is_caught_by_a_case_on_the_equations() {
    caught(equations, true);
}

/// Tables that the equations do not read: the lists by which the engine finds what has
/// changed, and the clock of step times, which the trees of the code name.
const ENGINE_ALONE: [&str; 6] = [
    "switch: step times count scans",
    "switch: step times count time",
    "edges: watches do not see steps",
    "edges: watches do not see variables",
    "edges: edges of edges are not seen",
    "forcing: no order acts",
];

/// `trees`: the backend reads the trees of code and not its instructions.
fn caught(backend: Backend, trees: bool) {
    let cases = cases();
    set(None);
    let sound: Vec<&Known> = cases.iter().filter(|k| passes(k, backend)).collect();
    assert!(sound.len() > 500, "only {} traces pass where nothing is broken", sound.len());
    let mut unseen = Vec::new();
    for (name, case, defect) in DEFECTS {
        let named = || sound.iter().filter(|k| k.title == *case).filter_map(|k| tables(k));
        if trees && named().any(|t| is_of_instructions(*defect, &t)) {
            println!("{name}: of the instructions");
            continue;
        }
        set(Some(*defect));
        let seen: Vec<&str> =
            sound.iter().filter(|k| !passes(k, backend)).map(|k| k.title.as_str()).collect();
        println!("{name}: {case}, of {} that see it", seen.len());
        if trees && ENGINE_ALONE.contains(name) {
            assert!(seen.is_empty(), "{name} is seen by {seen:?}: it is not of the engine alone");
        } else if !seen.contains(case) {
            unseen.push((*name, *case, seen));
        }
    }
    set(None);
    assert!(unseen.is_empty(), "defects that their case does not see: {unseen:#?}");
}

fn tables(known: &Known) -> Option<Tables> {
    let doc = case::document(&known.case.chart).ok()?;
    let (compiled, _) = g7_compile::compile_as(&doc, known.profile);
    Some(compiled?.program.tables().clone())
}

/// No section of the equations can be left out without a case that sees it.
#[test]
fn every_section_of_the_equations_is_needed() {
    let cases = cases();
    set(None);
    leave_out(None);
    let sound: Vec<&Known> = cases.iter().filter(|k| passes(k, equations)).collect();
    let mut titles: BTreeMap<&'static str, Vec<&Known>> = BTreeMap::new();
    for k in &sound {
        let Ok(doc) = case::document(&k.case.chart) else { continue };
        let own = doc.profile().map(|d| d.name).unwrap_or_default();
        let (Some(compiled), _) = g7_compile::compile_with(&doc, Some(k.profile).filter(|p| *p != own), &[])
        else {
            continue;
        };
        for section in g7_equations::equations(&compiled, Default::default()).sections() {
            titles.entry(section.title).or_default().push(k);
        }
    }
    assert!(titles.len() > 20, "{titles:?}", titles = titles.keys());
    let mut needless = Vec::new();
    for (title, holders) in titles {
        leave_out(Some(title));
        let seen = holders.iter().filter(|k| !passes(k, equations)).count();
        println!("{title}: {seen} of {} see that it is left out", holders.len());
        if seen == 0 {
            needless.push(title);
        }
    }
    leave_out(None);
    assert!(needless.is_empty(), "no case sees that these are left out: {needless:?}");
}
