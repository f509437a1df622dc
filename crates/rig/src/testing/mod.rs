//! Scenarios in virtual time.
//!
//! ```text
//! model::Scenario -> plan (names to items, expressions to asks) -> exec on a Bench -> Outcome; Coverage
//! ```
//!
//! What each statement means stands in `docs/book/src/language/tests.md`; `exec`
//! is that page as code.

mod coverage;
mod exec;
mod plan;
mod sides;

use std::collections::BTreeSet;

use g7_host::Clock;
use g7_model::{Problem, ProfileName, Scenario, Severity, Span};

use crate::bench::{self, Bench};
use crate::{Error, Source};
pub use coverage::{Coverage, Row, Rows};
pub use exec::Defect;
use plan::Plan;

/// What became of a test.
pub struct Outcome {
    /// The file that it stands in.
    pub file: String,
    /// Its title.
    pub title: String,
    /// `path:line:column` of it.
    pub place: String,
    /// Where it stands.
    pub at: Span,
    /// Why it failed, if it did.
    pub defect: Option<Box<Defect>>,
    /// Time that passed in the test, nanoseconds.
    pub simulated: i64,
    /// Scans made.
    pub scans: u64,
    /// Time that it took, nanoseconds.
    pub took: i64,
    /// What deserves a look although nothing failed.
    pub notes: Vec<String>,
}

/// What is asked for.
#[derive(Clone, Copy, Default)]
pub struct Options<'a> {
    /// In place of the file's own.
    pub profile: Option<ProfileName>,
    /// In place of the file's own, nanoseconds.
    pub scan: Option<i64>,
    /// Only tests with this in their titles.
    pub filter: Option<&'a str>,
}

/// Runs the tests of a file, a compilation for each plant that they use.
///
/// # Errors
///
/// There is no such plant.
pub fn file(
    source: &Source,
    options: Options<'_>,
    coverage: &mut Coverage,
    clock: &mut dyn Clock,
    progress: &mut dyn FnMut(),
) -> Result<(Vec<Outcome>, Vec<Problem>), Error> {
    let mut outcomes: Vec<(usize, Outcome)> = Vec::new();
    let (groups, mut problems) = prepare(source, options)?;
    if problems.iter().all(|p| p.severity() == Severity::Warning) {
        for group in &groups {
            coverage.learn(&group.bench, source);
            for (number, scenario, plan) in &group.plans {
                if options.filter.is_none_or(|f| scenario.title.contains(f)) {
                    outcomes.push((*number, one(source, &group.bench, scenario, plan, coverage, clock)));
                }
                progress();
            }
        }
    }
    outcomes.sort_by_key(|(number, _)| *number);
    problems.sort_by_key(|p| p.at);
    problems.dedup();
    Ok((outcomes.into_iter().map(|(_, o)| o).collect(), problems))
}

/// Tests that run on one bench, each with its place among all.
struct Group<'s> {
    bench: Bench,
    plans: Vec<(usize, &'s Scenario, Plan)>,
}

/// Compiles what the tests of a file need and turns them into plans.
fn prepare<'s>(source: &'s Source, options: Options<'_>) -> Result<(Vec<Group<'s>>, Vec<Problem>), Error> {
    let mut problems = Vec::new();
    let mut groups = Vec::new();
    let tests: Vec<(usize, &Scenario)> = source.tests().enumerate().collect();
    let plants: BTreeSet<Option<&str>> =
        tests.iter().map(|(_, t)| t.plant.as_ref().map(|p| &*p.text)).collect();
    let none = BTreeSet::from([None]);
    for plant in if plants.is_empty() { &none } else { &plants } {
        let wanted = bench::Options {
            profile: options.profile,
            scan: options.scan,
            plant: Some(plant.unwrap_or("none")),
            asks: &[],
        };
        let mine = || tests.iter().filter(|(_, t)| t.plant.as_ref().map(|p| &*p.text) == *plant);
        if let Some(problem) = mine().find_map(|(_, t)| plan::unknown_plant(source, t)) {
            problems.push(problem);
            continue;
        }
        let (bench, found) = bench::build(source, &wanted)?;
        problems.extend(found);
        let Some(bench) = bench else { continue };
        let mut asks = Vec::new();
        let mut plans = Vec::new();
        for (number, scenario) in mine() {
            let (plan, found) = plan::plan(scenario, &bench, &mut asks);
            problems.extend(found);
            plans.push((*number, *scenario, plan));
        }
        let bench = if asks.is_empty() {
            bench
        } else {
            let (bench, found) = bench::build(source, &bench::Options { asks: &asks, ..wanted })?;
            problems.extend(found);
            let Some(bench) = bench else { continue };
            bench
        };
        problems.extend(plan::judge(&plans, &bench));
        groups.push(Group { bench, plans });
    }
    problems.sort_by_key(|p| p.at);
    problems.dedup();
    Ok((groups, problems))
}

/// What is wrong with a file: charts, every plant, every test.
pub fn problems(source: &Source, profile: Option<ProfileName>) -> Result<Vec<Problem>, Error> {
    let mut problems = prepare(source, Options { profile, ..Options::default() })?.1;
    // A plant that no test uses is compiled as well.
    for plant in g7_compile::plant::plants(&source.document) {
        if source.tests().any(|t| t.plant.as_ref().is_some_and(|p| p.text == plant.name.text)) {
            continue;
        }
        let options = bench::Options { profile, plant: Some(&plant.name.text), ..bench::Options::default() };
        problems.extend(bench::build(source, &options)?.1);
    }
    problems.sort_by_key(|p| p.at);
    problems.dedup();
    Ok(problems)
}

/// Runs a test; where it fails, runs it again with a recording.
fn one(
    source: &Source,
    bench: &Bench,
    scenario: &Scenario,
    plan: &Plan,
    coverage: &mut Coverage,
    clock: &mut dyn Clock,
) -> Outcome {
    let begun = clock.now();
    let seed = scenario.seed.unwrap_or(0);
    let mut first = exec::run(bench, plan, seed, Some(coverage), false);
    if first.defect.is_some() {
        first = exec::run(bench, plan, seed, None, true);
    }
    if let Some(defect) = &mut first.defect {
        defect.describe(source);
    }
    Outcome {
        file: source.name.clone(),
        title: scenario.title.to_string(),
        place: source.place(scenario.at.0),
        at: scenario.at.0,
        defect: first.defect,
        simulated: first.simulated,
        scans: first.scans,
        took: clock.now().saturating_sub(begun),
        notes: first.notes,
    }
}
