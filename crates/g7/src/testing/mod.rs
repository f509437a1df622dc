//! `g7 test`: scenarios in virtual time.
//!
//! ```text
//! model::Scenario -> plan (names to items, expressions to asks) -> exec on a Bench
//!                 -> Outcome -> text, JSON, JUnit; coverage
//! ```
//!
//! What each statement means stands in `docs/book/src/language/tests.md`; `exec`
//! is that page as code.

mod coverage;
mod exec;
mod output;
mod plan;
mod sides;

use std::collections::BTreeSet;
use std::io::Write;

use g7_host::{Clock, WallClock};
use g7_model::{Problem, ProfileName, Scenario, Severity};

use crate::bench::{self, Bench};
use crate::cli::{Format, Test};
use crate::failure::{Failure, Verdict};
use crate::progress::Progress;
use crate::report::{self, Tally};
use crate::sources::Source;
use crate::{files, talk};
use coverage::Coverage;
use exec::Defect;
use plan::Plan;

/// What became of a test.
pub(crate) struct Outcome {
    pub(crate) file: String,
    pub(crate) title: String,
    pub(crate) place: String,
    pub(crate) defect: Option<Box<Defect>>,
    /// Time that passed in the test, nanoseconds.
    pub(crate) simulated: i64,
    pub(crate) scans: u64,
    /// Time that it took, nanoseconds.
    pub(crate) took: i64,
    /// What deserves a look although nothing failed.
    pub(crate) notes: Vec<String>,
}

/// What is asked for.
#[derive(Clone, Copy, Default)]
struct Options<'a> {
    profile: Option<ProfileName>,
    scan: Option<i64>,
    filter: Option<&'a str>,
}

pub(crate) fn test(args: &Test) -> Result<Verdict, Failure> {
    let paths = files::all(&args.paths)?;
    let options = Options { profile: args.profile, scan: args.scan, filter: args.filter.as_deref() };
    let mut progress = Progress::new("testing", 0);
    let (mut outcomes, mut covered, mut tally) = (Vec::new(), Vec::new(), Tally::default());
    let mut out = anstream::stdout().lock();
    for path in &paths {
        let source = Source::load(path, 0)?;
        let mut coverage = Coverage::default();
        progress.more(source.tests().count() as u64);
        let (mut done, problems) = file(&source, options, &mut coverage, &mut progress)?;
        progress.end();
        let found = Tally::of(&problems);
        if found.errors > 0 {
            talk!("{}", report::text(&source, &problems).trim_end());
        }
        tally.add(found);
        if args.format == Format::Text {
            output::progress_lines(&mut out, &done)?;
        }
        outcomes.append(&mut done);
        covered.push((source.name(), coverage));
    }
    if let Some(path) = &args.junit {
        files::write(path, output::junit(&outcomes).as_bytes())?;
    }
    match args.format {
        Format::Json => output::json(&mut out, &outcomes, args.coverage.then_some(covered.as_slice()))?,
        Format::Text => {
            output::failures(&mut out, &outcomes)?;
            if args.coverage {
                output::coverage(&mut out, &covered)?;
            }
            output::summary(&mut out, &outcomes)?;
        }
    }
    out.flush()?;
    if outcomes.is_empty() && tally.errors == 0 {
        talk!(
            "{}",
            if args.filter.is_some() { "no test has that in its title" } else { "there are no tests" }
        );
    }
    let failed = tally.errors > 0 || outcomes.iter().any(|o| o.defect.is_some());
    Ok(if failed { Verdict::Found } else { Verdict::Fine })
}

/// Runs the tests of a file, a compilation for each plant that they use.
fn file(
    source: &Source,
    options: Options<'_>,
    coverage: &mut Coverage,
    progress: &mut Progress,
) -> Result<(Vec<Outcome>, Vec<Problem>), Failure> {
    let mut outcomes: Vec<(usize, Outcome)> = Vec::new();
    let (groups, mut problems) = prepare(source, options)?;
    if problems.iter().all(|p| p.severity() == Severity::Warning) {
        for group in &groups {
            coverage.learn(&group.bench, source);
            for (number, scenario, plan) in &group.plans {
                if options.filter.is_none_or(|f| scenario.title.contains(f)) {
                    outcomes.push((*number, one(source, &group.bench, scenario, plan, coverage)));
                }
                progress.step();
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
fn prepare<'s>(source: &'s Source, options: Options<'_>) -> Result<(Vec<Group<'s>>, Vec<Problem>), Failure> {
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
        let (bench, found) = bench::build(source, &bench::Options { asks: &asks, ..wanted })?;
        problems.extend(found);
        let Some(bench) = bench else { continue };
        problems.extend(plan::judge(&plans, &bench));
        groups.push(Group { bench, plans });
    }
    problems.sort_by_key(|p| p.at);
    problems.dedup();
    Ok((groups, problems))
}

/// What is wrong with a file: charts, every plant, every test.
pub(crate) fn problems(source: &Source, profile: Option<ProfileName>) -> Result<Vec<Problem>, Failure> {
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
fn one(source: &Source, bench: &Bench, scenario: &Scenario, plan: &Plan, coverage: &mut Coverage) -> Outcome {
    let mut clock = WallClock::default();
    let seed = scenario.seed.unwrap_or(0);
    let mut first = exec::run(bench, plan, seed, Some(coverage), false);
    if first.defect.is_some() {
        first = exec::run(bench, plan, seed, None, true);
    }
    if let Some(defect) = &mut first.defect {
        defect.describe(source);
    }
    Outcome {
        file: source.name(),
        title: scenario.title.to_string(),
        place: source.place(scenario.at.0),
        defect: first.defect,
        simulated: first.simulated,
        scans: first.scans,
        took: clock.now(),
        notes: first.notes,
    }
}
