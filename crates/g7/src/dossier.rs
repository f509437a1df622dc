//! `g7 dossier`: runs the tests and asks the questions of a chart, and prints all that is known of it as one PDF.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use g7_dossier::{Answer, Dossier as Made, Input, Known, Missing, Part, Test, Verdict as Proof, View};
use g7_host::WallClock;
use g7_model::{Item, Nanos, PlantItem, Problem, Said, Severity, say};
use g7_rig::testing::{self, Coverage, Options};

use crate::draw::{Heading, PaperName, pdf};
use crate::failure::{Failure, Verdict};
use crate::message::talk;
use crate::report::{self, Tally};
use crate::sources::{self, Source};
use crate::tongue::language;
use crate::{files, prove, used, values};

const EXAMPLES: &str = "\
Examples:
  g7 dossier tank -o tank.pdf           everything about the chart
  g7 dossier tank -o tank.pdf --lang fr --title \"Tank 4\" --author \"A. Martin\" --date 2026-03-01
  g7 dossier tank -o tank.pdf --paper a3-landscape
  g7 dossier tank -o tank.pdf --part charts,io
  g7 dossier tank -o tank.pdf --no-prove

Exit codes:
  0  fine; a test that fails and a claim that is refuted are told in the dossier
  1  the chart cannot be read
  2  bad usage, or something outside the chart: no such file, a full disk";

/// The arguments of `g7 dossier`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Dossier {
    /// A .g7 file, a file of another tool, or a folder with a chart.g7.
    #[arg(default_value = ".")]
    file: PathBuf,
    /// The PDF to write [default: the standard output].
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The sheets.
    #[arg(long, value_enum, default_value_t = PaperName::A4, value_name = "PAPER")]
    paper: PaperName,
    /// Only these parts, separated by commas.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "PARTS")]
    part: Vec<PartName>,
    #[command(flatten)]
    heading: Heading,
    /// Ask no questions about all runs.
    #[arg(long)]
    no_prove: bool,
    /// Run no tests.
    #[arg(long)]
    no_tests: bool,
    /// The time in which the questions are answered.
    #[arg(long, value_parser = values::duration, value_name = "TIME", default_value = "30s")]
    time: Nanos,
    /// The time that one test may take.
    #[arg(long, value_parser = values::duration, value_name = "TIME", default_value = "60s")]
    timeout: Nanos,
    /// Draw actions with qualifier boxes, as in IEC 61131-3.
    #[arg(long)]
    sfc: bool,
    /// Replace an output that is there and that g7 did not write; never the chart itself.
    #[arg(long)]
    force: bool,
}

/// A part of the dossier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PartName {
    /// Charts, expansions and tasks.
    Charts,
    /// Inputs and outputs.
    Io,
    /// Variables and constants.
    Variables,
    /// Cross references.
    References,
    /// Actions, functions and processing.
    Bodies,
    /// Plants with their pictures.
    Plants,
    /// Tests with their chronograms.
    Tests,
    /// Questions with their answers.
    Proofs,
    /// Problems and warnings.
    Problems,
}

impl PartName {
    fn part(self) -> Part {
        match self {
            PartName::Charts => Part::Charts,
            PartName::Io => Part::Signals,
            PartName::Variables => Part::Variables,
            PartName::References => Part::References,
            PartName::Bodies => Part::Bodies,
            PartName::Plants => Part::Plants,
            PartName::Tests => Part::Tests,
            PartName::Proofs => Part::Proofs,
            PartName::Problems => Part::Problems,
        }
    }
}

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
        parts = Part::ALL.iter().map(|(_, p)| *p).collect();
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
        paper: args.paper.paper(),
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
