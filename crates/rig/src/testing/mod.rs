//! Runs tests in virtual time.
//!
//! ```text
//! model::Scenario -> plan (names to items, expressions to asks) -> exec on a Bench -> Outcome; Coverage
//! ```
//!
//! The page `docs/book/src/language/tests.md` says what each statement means; `exec` implements it.

mod coverage;
mod exec;
mod properties;
pub mod script;
mod sides;
mod statements;
mod why;

use std::collections::BTreeSet;

use g7_host::{Clock, Recording};
use g7_model::{Nanos, Problem, ProfileName, Said, Scenario, Severity, Span};

use crate::bench::{self, Bench};
use crate::{Error, Source};
pub use coverage::{Coverage, Row, Rows, Sort};
pub use exec::Defect;
pub use properties::{Claims, Unproved, claims, plants, unproved};
use statements::Plan;
pub use why::{Causes, causes};

/// The result of a test.
pub struct Outcome {
    /// The file that contains it.
    pub file: String,
    /// Its title.
    pub title: String,
    /// Its place as `path:line:column`.
    pub place: String,
    /// Its place in the text.
    pub at: Span,
    /// The failure, if it failed.
    pub defect: Option<Box<Defect>>,
    /// The simulated time.
    pub simulated: Nanos,
    /// The number of scans.
    pub scans: u64,
    /// The real time that it took.
    pub took: Nanos,
    /// Observations that did not make the test fail.
    pub notes: Vec<Said>,
    /// The course of the signals, if it was to be recorded.
    pub recording: Option<Recording>,
}

/// Options of a run of tests.
#[derive(Clone, Copy, Default)]
pub struct Options<'a> {
    /// The profile that replaces the file's own.
    pub profile: Option<ProfileName>,
    /// The scan period that replaces the file's own.
    pub scan: Option<Nanos>,
    /// Run only tests whose title contains this text.
    pub filter: Option<&'a str>,
    /// The real time that a test may take.
    pub limit: Option<Nanos>,
    /// Runs no more tests of a file behind the first that fails.
    pub fail_fast: bool,
    /// Finds the causes of a failure ([`causes`]); a program that shows none need not contain this code.
    pub causes: Option<Causes>,
    /// Records each test, whether it fails or not.
    pub record: bool,
}

/// Runs the tests of a file. Compiles the charts once for each plant that the tests use.
///
/// # Errors
///
/// A test names a plant that does not exist.
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
                if options.fail_fast && outcomes.iter().any(|(_, o)| o.defect.is_some()) {
                    break;
                }
                if options.filter.is_none_or(|f| scenario.title.contains(f)) {
                    outcomes
                        .push((*number, one(source, &group.bench, scenario, plan, coverage, clock, options)));
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

/// The tests that run on one bench, each with its position among all tests.
struct Group<'s> {
    bench: Bench,
    plans: Vec<(usize, &'s Scenario, Plan)>,
}

/// Compiles the benches for the tests of a file and prepares the tests.
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
        if let Some(problem) = mine().find_map(|(_, t)| statements::unknown_plant(source, t.plant.as_ref()?))
        {
            problems.push(problem);
            continue;
        }
        let (bench, found) = bench::build::build(source, &wanted)?;
        problems.extend(found);
        let Some(bench) = bench else { continue };
        let mut asks = Vec::new();
        let mut plans = Vec::new();
        for (number, scenario) in mine() {
            let (plan, found) = statements::plan(scenario, &bench, &mut asks);
            problems.extend(found);
            plans.push((*number, *scenario, plan));
        }
        let bench = if asks.is_empty() {
            bench
        } else {
            let (bench, found) = bench::build::build(source, &bench::Options { asks: &asks, ..wanted })?;
            problems.extend(found);
            let Some(bench) = bench else { continue };
            bench
        };
        problems.extend(statements::judge(&plans, &bench));
        groups.push(Group { bench, plans });
    }
    problems.sort_by_key(|p| p.at);
    problems.dedup();
    Ok((groups, problems))
}

/// All problems of a file: those of the charts, of every plant, test and property.
pub fn problems(source: &Source, profile: Option<ProfileName>) -> Result<Vec<Problem>, Error> {
    let mut problems = prepare(source, Options { profile, ..Options::default() })?.1;
    // A plant that no test uses is compiled too.
    for plant in g7_compile::plant::plants(&source.document) {
        if source.tests().any(|t| t.plant.as_ref().is_some_and(|p| p.text == plant.name.text)) {
            continue;
        }
        let options = bench::Options { profile, plant: Some(&plant.name.text), ..bench::Options::default() };
        problems.extend(bench::build::build(source, &options)?.1);
    }
    for plant in plants(&source.document) {
        problems.extend(claims(source, profile, plant)?.1);
    }
    problems.sort_by_key(|p| p.at);
    problems.dedup();
    Ok(problems)
}

/// Changes of each signal that the recording of a failure keeps.
const RECENT: usize = 4_000;
/// The same for a recording that was asked for.
const RECORDED: usize = 1_000_000;

/// Runs a test; if it fails, or is to be recorded, runs it again with a recording.
fn one(
    source: &Source,
    bench: &Bench,
    scenario: &Scenario,
    plan: &Plan,
    coverage: &mut Coverage,
    clock: &mut dyn Clock,
    options: Options<'_>,
) -> Outcome {
    let begun = clock.now();
    let seed = scenario.seed.unwrap_or(0);
    let limited = options.limit.map(|length| exec::Limit::new(clock, length));
    let mut first = exec::run(bench, plan, seed, Some(coverage), None, limited);
    let limit = if options.record { RECORDED } else { RECENT };
    let again = first.defect.as_ref().map_or(options.record, |d| !d.overdue);
    if again {
        first =
            exec::run(bench, plan, seed, None, Some(exec::Record { causes: options.causes, limit }), None);
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
        took: clock.now() - begun,
        notes: first.notes,
        recording: first.recording.filter(|_| options.record),
    }
}
