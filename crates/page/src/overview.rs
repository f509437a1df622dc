//! The overview of a file that the frame of the page shows: charts, problems, plants, tests.

use std::collections::HashMap;

use g7_compile::resolve::{of_profile, with_switch};
use g7_edit::ChartSort;
use g7_ide::{File, OWN};
use g7_model::instances::{Drawings, own_instances};
use g7_model::{Document, Nanos, PlantItem, ProfileName, Switch};
use g7_rig::{Source, named};
use serde::Serialize;

use crate::drawing::{opens, sort};
use crate::problems;

/// The overview of a file.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Look"))]
pub(crate) struct Overview {
    file: String,
    version: u64,
    length: usize,
    hash: String,
    clean: bool,
    imported: bool,
    can_undo: bool,
    can_redo: bool,
    problems: Vec<problems::Row>,
    /// The names that nothing declares.
    undeclared: Vec<problems::NewName>,
    charts: Vec<ChartRow>,
    profile: &'static str,
    switches: Vec<SwitchRow>,
    bound: Bound,
    scan_ms: f64,
    plants: Vec<String>,
    /// The files of their pictures, as the text names them: relative to this file.
    pictures: Vec<String>,
    tests: Vec<TestRow>,
    /// The names of the files that it uses, and that those use; also of files that are not there.
    uses: Vec<String>,
    /// The names of those whose texts are to be lent.
    wants: Vec<String>,
    /// The names of the parts of the library that they use.
    parts: Vec<String>,
}

/// A switch of the profile.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
struct SwitchRow {
    /// The words for its two positions.
    words: [&'static str; 2],
    /// The position that the profile implies.
    usual: &'static str,
    /// The position that the file sets beside the profile, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    set: Option<&'static str>,
}

/// The greatest number of passes in a scan.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
struct Bound {
    usual: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    set: Option<u32>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
struct ChartRow {
    name: String,
    kind: ChartSort,
    #[serde(skip_serializing_if = "Option::is_none")]
    comment: Option<String>,
    from: usize,
    to: usize,
    steps: usize,
    transitions: usize,
    /// The file in which it stands, if that is another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    /// The names of its parameters.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    params: Vec<String>,
    /// The function block whose instances have such a chart each.
    #[serde(skip_serializing_if = "Option::is_none")]
    block: Option<String>,
    /// Its instances that have a name of their own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    instances: Vec<String>,
    /// The chart and the step that this chart is the expansion of, or that enclose it.
    #[serde(skip_serializing_if = "Option::is_none")]
    of: Option<[String; 2]>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
struct TestRow {
    name: String,
    from: usize,
    to: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    plant: Option<String>,
}

#[inline(never)]
pub(crate) fn overview(name: &str, file: &File) -> Overview {
    let document = &file.source.document;
    let tests = file.source.tests().map(|t| {
        let (from, to) = file.units(t.at.0);
        TestRow { name: t.title.to_string(), from, to, plant: t.plant.as_ref().map(|p| p.text.to_string()) }
    });
    let scan = document.cycle();
    let (problems, undeclared) = problems::rows(file);
    let parts = file.source.others().iter().filter(|o| o.library);
    Overview {
        file: name.to_owned(),
        version: file.version,
        length: file.positions.units(),
        hash: hash(&file.source),
        clean: file.is_clean(),
        imported: file.imported,
        can_undo: file.history.can_undo(),
        can_redo: file.history.can_redo(),
        problems,
        undeclared,
        charts: charts(file),
        profile: document.profile().map_or(g7_model::ProfileName::default(), |p| p.name).name(),
        switches: switches(document),
        bound: bound(document),
        scan_ms: scan.unwrap_or(SCAN).as_millis(),
        plants: g7_compile::plant::plants(document).map(|p| p.name.text.to_string()).collect(),
        pictures: pictures(document),
        tests: tests.collect(),
        uses: file.uses.iter().map(|path| named(name, path)).collect(),
        wants: file.wants().map(|path| named(name, path)).collect(),
        parts: parts.map(|o| o.path.clone()).collect(),
    }
}

fn pictures(document: &Document) -> Vec<String> {
    let view =
        |item: &PlantItem| if let PlantItem::View(view) = item { Some(view.file.to_string()) } else { None };
    g7_compile::plant::plants(document).flat_map(|p| &p.items).filter_map(view).collect()
}

#[inline(never)]
fn switches(document: &Document) -> Vec<SwitchRow> {
    let profile = document.profile();
    let name = profile.map_or(ProfileName::default(), |p| p.name);
    let set = |s: Switch| profile.is_some_and(|p| p.switches.iter().any(|(there, _)| *there == s));
    let row = |(one, other): (&(&'static str, Switch), &(&'static str, Switch))| SwitchRow {
        words: [one.0, other.0],
        usual: if of_profile(name) == with_switch(of_profile(name), one.1) { one.0 } else { other.0 },
        set: [one, other].iter().find(|(_, s)| set(*s)).map(|(word, _)| *word),
    };
    let all = &g7_syntax::SWITCHES;
    all.iter().step_by(2).zip(all.iter().skip(1).step_by(2)).map(row).collect()
}

fn bound(document: &Document) -> Bound {
    let profile = document.profile();
    let set = profile.and_then(|p| {
        p.switches.iter().find_map(|(s, _)| if let Switch::Bound(n) = s { Some(*n) } else { None })
    });
    Bound { usual: of_profile(profile.map_or(ProfileName::default(), |p| p.name)).bound, set }
}

/// The scan time if the file gives none.
const SCAN: Nanos = Nanos::from_millis(10);

#[inline(never)]
fn charts(file: &File) -> Vec<ChartRow> {
    let readable = file.drawn();
    let document = &*file.with_uses(readable);
    let owners = owners(document);
    let mut instances: HashMap<&str, Vec<String>> = HashMap::new();
    for (name, chart) in own_instances(document) {
        instances.entry(chart).or_default().push(name.to_owned());
    }
    let own = |c: &&g7_model::Chart| c.at.0.file == OWN;
    let row = |c: &g7_model::Chart| {
        let (from, to) = if readable.stale { (0, 0) } else { file.units(c.at.0) };
        ChartRow {
            name: c.name.text.to_string(),
            kind: sort(c.kind),
            comment: c.comment.as_deref().map(str::to_owned),
            from,
            to,
            steps: c.steps().count(),
            transitions: c.transitions().count(),
            file: (!own(&c)).then(|| file.source.home(c.at.0).name.clone()),
            params: c.params.iter().map(|p| p.name.text.to_string()).collect(),
            block: c.block.as_ref().map(|b| b.text.to_string()),
            instances: instances.get(&*c.name.text).cloned().unwrap_or_default(),
            of: owners.get(&*c.name.text).map(|of| of.map(str::to_owned)),
        }
    };
    // Those of other files stand behind its own, wherever their `use` lines are.
    document.charts().filter(own).chain(document.charts().filter(|c| !own(c))).map(row).collect()
}

/// The macro-step that a chart is the expansion of, or the step that encloses it: the first one, with its chart.
fn owners(document: &Document) -> HashMap<&str, [&str; 2]> {
    let drawings = Drawings::of(document);
    let mut owners = HashMap::new();
    for chart in document.charts() {
        for step in chart.steps() {
            for opened in opens(step) {
                owners.entry(drawings.drawn_for(opened)).or_insert([&*chart.name.text, &*step.name.text]);
            }
        }
    }
    owners
}

/// A fingerprint of a text and of those that it uses, in hexadecimal.
pub(crate) fn hash(source: &Source) -> String {
    let mut hash = g7_host::Fnv::default();
    let others = source.others().iter().map(|o| &o.source.text);
    std::iter::once(&source.text).chain(others).for_each(|text| hash.add(text.as_bytes()));
    format!("{:016x}", hash.value())
}
