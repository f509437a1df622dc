//! `g7 dossier`: runs the tests and asks the questions of a chart, and prints all that is known of it as one PDF.

pub(crate) mod args;

use std::path::Path;

use g7_dossier::{Answer, Dossier as Made, Input, Known, Missing, Part, Test, Verdict as Proof, View};
use g7_host::WallClock;
use g7_model::{Item, PlantItem, Problem, Said, Severity, say};
use g7_rig::testing::{self, Coverage, Options};

use args::Dossier;

use crate::draw::pdf;
use crate::failure::{Failure, Verdict};
use crate::message::talk;
use crate::report::{self, Tally};
use crate::sources::{self, Source};
use crate::tongue::language;
use crate::{files, prove, used};

pub(crate) fn dossier(args: &Dossier) -> Result<Verdict, Failure> {
    let path = files::one(&args.file)?;
    let source = sources::load(&path, 0)?;
    files::refuse_foreign(args.output.as_deref(), &[&path], args.force)?;
    if source.has_errors() || source.others().iter().any(|other| other.source.has_errors()) {
        let problems = source.read_problems();
        talk!("{}", report::text(&source, &problems).trim_end());
        talk!("{}: {}", source.name, Tally::of(&problems));
        return Ok(Verdict::Found);
    }
    let mut parts: Vec<Part> = args.part.iter().map(|p| p.part()).collect();
    if parts.is_empty() {
        parts = Part::ALL.to_vec();
    }
    let problems = problems(&source)?;
    let is_wrong = problems.iter().any(|p| p.severity() == Severity::Error);
    let has = |part| parts.contains(&part);
    let tests = tests(args, &source, is_wrong, has(Part::Tests))?;
    let answers = match () {
        () if !has(Part::Proofs) || args.no_prove => Known::Missing(Missing::NotRun),
        () if is_wrong => Known::Missing(Missing::Errors),
        () => prove::answers(&path, args.time)?,
    };
    let input = Input {
        head: args.heading.head(),
        paper: args.paper.0,
        language: language(),
        look: if args.sfc { g7_draw::Look::Sfc } else { g7_draw::Look::Iec60848 },
        views: views(&source),
        source: &source,
        parts,
        problems,
        tests,
        answers,
    };
    let made = g7_dossier::dossier(&input);
    files::deliver(args.output.as_deref(), &pdf(&made, &input.head)?)?;
    conclude(&input, &made);
    Ok(Verdict::Fine)
}

/// All problems of the text, in its order.
fn problems(source: &Source) -> Result<Vec<Problem>, Failure> {
    let mut all = source.read_problems();
    all.extend(source.about(testing::problems(source, None)?));
    all.sort_by_key(|p| (p.at.file, p.at.start, p.at.end));
    all.dedup();
    Ok(all)
}

/// Runs the tests.
fn tests(args: &Dossier, source: &Source, is_wrong: bool, wanted: bool) -> Result<Known<Test>, Failure> {
    if !wanted || args.no_tests {
        return Ok(Known::Missing(Missing::NotRun));
    }
    if is_wrong {
        return Ok(Known::Missing(Missing::Errors));
    }
    let options = Options { limit: Some(args.timeout), record: true, ..Options::default() };
    let (outcomes, _) =
        testing::file(source, options, &mut Coverage::default(), &mut WallClock::default(), &mut || {})?;
    Ok(Known::Here(outcomes.into_iter().map(Test::from).collect()))
}

/// The pictures of the plants, or why they cannot be read.
fn views(source: &Source) -> Vec<View> {
    let mut all = Vec::new();
    for item in &source.whole().items {
        let Item::Plant(plant) = item else { continue };
        let home = &source.home(plant.at.0).name;
        for item in &plant.items {
            if let PlantItem::View(view) = item {
                let file = view.file.to_string();
                all.push(View { svg: picture(Path::new(home), &file), file });
            }
        }
    }
    all
}

fn picture(chart: &Path, file: &str) -> Result<Vec<u8>, Said> {
    let folder = chart.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = std::fs::canonicalize(folder).map_err(|e| Said::foreign(e.to_string()))?;
    used::within(&used::root(&folder)?, &used::plain(&folder.join(file)))
}

/// Tells what the reader of the dossier will find.
fn conclude(input: &Input<'_>, made: &Made) {
    let mut parts = vec![say!("{} sheets", made.pages.len())];
    if let Known::Here(tests) = &input.tests {
        let failed = tests.iter().filter(|t| t.failure.is_some()).count();
        parts.push(say!("{} tests, {failed} failed", tests.len()));
    }
    if let Known::Here(answers) = &input.answers {
        let of = |proof| answers.iter().filter(|a: &&Answer| a.verdict == proof).count();
        let (proved, refuted, open) = (of(Proof::Proved), of(Proof::Refuted), of(Proof::Open));
        parts.push(say!("{proved} proved, {refuted} refuted, {open} not decided"));
    }
    let told: Vec<String> = parts.iter().map(|p| p.in_language(language())).collect();
    talk!("{}", told.join("; "));
}
