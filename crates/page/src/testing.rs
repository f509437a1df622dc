//! Runs the tests of a file in virtual time.

use g7_host::VirtualClock;
use g7_ide::File;
use g7_ide::ids;
use g7_model::{Problem, Said};
use g7_rig::testing::{self, Coverage, Defect, Options, Outcome};
use serde::Serialize;

use crate::problems;
use crate::run::{Scan, WhyLine, lines};

/// The results of the tests of a file.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "TestAnswer"))]
pub(crate) struct Report {
    passed: usize,
    failed: usize,
    tests: Vec<Row>,
    coverage: Vec<Reached>,
    /// The problems because of which no test could run.
    problems: Vec<problems::Row>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "TestResult", optional_fields))]
struct Row {
    name: String,
    ok: bool,
    from: usize,
    to: usize,
    simulated_ms: f64,
    scans: u64,
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    failure: Option<Failure>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
struct Failure {
    message: String,
    /// The place of the failed statement.
    from: usize,
    to: usize,
    time_ms: f64,
    got: Vec<(String, String)>,
    situation: String,
    chronogram: String,
}

/// The coverage of one kind of element.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
struct Reached {
    sort: &'static str,
    total: usize,
    reached: usize,
    /// The ids of the symbols that no test reached.
    missed: Vec<String>,
}

/// Why a test failed.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "TestWhy", optional_fields))]
pub(crate) struct Reasons {
    /// Why the names in the condition have their values.
    lines: Vec<WhyLine>,
    /// The scans up to the failure; none if the test also forces, writes or restarts.
    #[serde(skip_serializing_if = "Option::is_none")]
    run: Option<Vec<Scan>>,
}

/// Runs the test of this title once more, and asks why it failed. It is empty if the test passes.
pub(crate) fn why(file: &File, title: &str) -> Result<Reasons, Said> {
    let options = Options { filter: Some(title), causes: Some(testing::causes), ..Options::default() };
    let (outcomes, _) = run(file, options, &mut Coverage::default())?;
    let defect = outcomes.into_iter().filter(|o| o.title == title).find_map(|o| o.defect);
    let document = file.source.whole();
    let told = |d: &Defect| d.why.iter().flat_map(|c| lines(c, document, file.language)).collect();
    Ok(Reasons {
        lines: defect.as_deref().map(told).unwrap_or_default(),
        run: defect.as_deref().and_then(Scan::up_to),
    })
}

/// Runs the tests that the options choose.
pub(crate) fn run(
    file: &File,
    options: Options<'_>,
    coverage: &mut Coverage,
) -> Result<(Vec<Outcome>, Vec<Problem>), Said> {
    testing::file(&file.source, options, coverage, &mut VirtualClock::default(), &mut || {})
        .map_err(|e| e.said())
}

/// Runs the tests whose titles contain a text, or all.
pub(crate) fn test(file: &File, filter: Option<&str>) -> Result<Report, Said> {
    let mut coverage = Coverage::default();
    let (outcomes, problems) = run(file, Options { filter, ..Options::default() }, &mut coverage)?;
    let failed = outcomes.iter().filter(|o| o.defect.is_some()).count();
    let errors = problems.iter().filter(|p| p.severity() == g7_model::Severity::Error);
    let rows = outcomes.iter().map(|o| {
        let (from, to) = file.units(o.at);
        Row {
            name: o.title.clone(),
            ok: o.defect.is_none(),
            from,
            to,
            simulated_ms: o.simulated.as_millis(),
            scans: o.scans,
            notes: o.notes.iter().map(|n| n.in_language(file.language)).collect(),
            failure: o.defect.as_ref().map(|d| {
                let (from, to) = file.units(d.at);
                Failure {
                    message: d.sentence().in_language(file.language),
                    from,
                    to,
                    time_ms: d.time.as_millis(),
                    got: d.got.clone(),
                    situation: d.situation.clone(),
                    chronogram: d.chronogram.clone(),
                }
            }),
        }
    });
    let document = &file.source.document;
    let sorts = coverage.sorts().map(|(sort, rows)| Reached {
        sort: sort.key(),
        total: rows.len(),
        reached: rows.values().filter(|r| r.hits > 0).count(),
        missed: rows
            .iter()
            .filter(|(_, r)| r.hits == 0)
            .filter_map(|(at, _)| ids::at(document, *at).map(|t| t.id()))
            .collect(),
    });
    Ok(Report {
        passed: outcomes.len() - failed,
        failed,
        tests: rows.collect(),
        coverage: sorts.into_iter().collect(),
        problems: errors.map(|p| problems::row(file, p)).collect(),
    })
}
