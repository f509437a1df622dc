//! Exercises that check themselves (decision 78): made for students from a folder, and a student's work checked.
//!
//! ```text
//! files of a folder          -> grade::Exercise -> Packed: texts, template, the hidden part sealed; or its mistakes
//! Given + text of a student  -> grade::judge    -> Checked: what is wrong, and when, with the runs that show it
//! ```
//!
//! Of a hidden test and a hidden question no more is told than whether it passed, and when it went wrong.

use g7_grade::{Answered, Ended, Exercise, Fault, Files, Graded, Limits, Mark, Tested, judge};
use g7_host::VirtualClock;
use g7_ide::File;
use g7_model::{Language, Nanos, Said, Span};
use g7_verify::{Evidence, Verdict};
use serde::{Deserialize, Serialize};

use crate::answer::{Shelved, shelf};
use crate::problems;
use crate::prove::Found;
use crate::run::Scan;

/// Most memory of a search, in bytes.
const BYTES: usize = 256 << 20;
/// The real time of a test. The page has no clock here, so it is never over; the page ends the work instead.
const TEST: Nanos = Nanos::new(60_000_000_000);

/// The texts of an exercise in one language.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ExerciseTexts"))]
struct Told {
    language: &'static str,
    title: String,
    statement: String,
    hints: Vec<String>,
}

/// The part of an exercise that checks a work.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ExerciseGiven", optional_fields = nullable))]
pub(crate) struct Given {
    /// The text of the template, which the student gets.
    template: String,
    /// The files that it uses, by their paths from its folder.
    uses: Vec<Shelved>,
    /// The hidden part.
    sealed: String,
}

/// A mistake of an exercise.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ExerciseFault"))]
struct Mistake {
    /// A path, or `path:line:column`.
    place: String,
    what: String,
}

/// An exercise as students get it, or the mistakes of its folder.
#[derive(Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ExercisePacked"))]
pub(crate) struct Packed {
    /// One for each language of the page.
    texts: Vec<Told>,
    given: Option<Given>,
    faults: Vec<Mistake>,
}

/// Makes an exercise for students from the files of its folder; `folder` is its name in messages.
pub(crate) fn pack(folder: &str, files: Vec<Shelved>, language: Language) -> Packed {
    let files: Files = files.into_iter().filter_map(|f| Some((f.file, f.text?.into_bytes()))).collect();
    match Exercise::read(&files, folder) {
        Ok(exercise) => packed(&exercise),
        Err(faults) => {
            let mistake = |f: &Fault| Mistake { place: f.place.clone(), what: f.what.in_language(language) };
            Packed { faults: faults.iter().map(mistake).collect(), ..Packed::default() }
        }
    }
}

fn packed(exercise: &Exercise) -> Packed {
    let told = |language: Language| Told {
        language: language.tag(),
        title: exercise.statement.title(language).to_owned(),
        statement: exercise.statement.in_language(language).to_owned(),
        hints: exercise.hints.steps(language).into_iter().map(str::to_owned).collect(),
    };
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let uses = exercise.given().iter();
    let given = Given {
        template: exercise.template.text.clone(),
        uses: uses.map(|(path, bytes)| Shelved { file: path.clone(), text: Some(text(bytes)) }).collect(),
        sealed: exercise.sealed(),
    };
    Packed { texts: Language::ALL.into_iter().map(told).collect(), given: Some(given), faults: Vec::new() }
}

/// The page's request: a work to be checked.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ExerciseWork", optional_fields = nullable))]
pub(crate) struct Work {
    /// The name of the student's file.
    name: String,
    text: String,
    /// The files that it uses.
    uses: Option<Vec<Shelved>>,
    exercise: Given,
    /// Most states of the search for the answers to questions.
    states: usize,
}

/// The result of a check in one word.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ExerciseMark"))]
#[serde(rename_all = "snake_case")]
enum Outcome {
    Passed,
    Changed,
    Fitted,
    Failed,
    Unread,
}

/// A locked part that is not as it was.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ExerciseChange", optional_fields))]
struct Change {
    what: String,
    /// Its place; none where the part is missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    from: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    to: Option<usize>,
}

/// A test of the exercise. Of a hidden one there are only `hidden`, `ok` and the time.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ExerciseTest", optional_fields))]
struct TestRow {
    hidden: bool,
    ok: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    title: Option<String>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<String>,
    /// When it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    time_ms: Option<f64>,
    /// The names in the condition that failed, with their values.
    got: Vec<(String, String)>,
    /// The scans up to that moment; none where inputs alone do not lead there.
    #[serde(skip_serializing_if = "Option::is_none")]
    run: Option<Vec<Scan>>,
}

/// A question of the exercise. A hidden one has neither claim nor run.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ExerciseQuestion", optional_fields))]
struct QuestionRow {
    hidden: bool,
    verdict: Found,
    #[serde(skip_serializing_if = "Option::is_none")]
    claim: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
    /// The run that breaks it.
    #[serde(skip_serializing_if = "Option::is_none")]
    run: Option<Vec<Scan>>,
}

/// A checked work.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ExerciseChecked"))]
pub(crate) struct Checked {
    mark: Outcome,
    /// The errors of the charts; nothing ran then.
    problems: Vec<problems::Row>,
    changed: Vec<Change>,
    /// The names that the exercise looks at and that are missing: a sentence for each.
    missing: Vec<String>,
    tests: Vec<TestRow>,
    questions: Vec<QuestionRow>,
}

/// Checks a work.
///
/// # Errors
///
/// The hidden part of the exercise is damaged, or the text is no chart.
pub(crate) fn check(work: Work, language: Language) -> Result<Checked, Said> {
    let Given { template, uses, sealed } = work.exercise;
    let given: Files = uses.into_iter().filter_map(|f| Some((f.file, f.text?.into_bytes()))).collect();
    let exercise = Exercise::handed(template.as_bytes(), &given, &sealed)?;
    let mut file = File::open(&work.name, work.text)?;
    file.lend(shelf(work.uses));
    file.language = language;
    let mut read = |path: &str| {
        let found = file.lent().find(|(of, _)| of.as_str() == path).and_then(|(_, text)| text.as_deref());
        found.map(|text| text.as_bytes().to_vec()).ok_or_else(|| Said::foreign(path))
    };
    let source = exercise.submission(&work.name, file.text().as_bytes().to_vec(), &mut read);
    let mut limits = Limits {
        test: TEST,
        questions: &|| Box::new(|| false),
        bytes: BYTES,
        states: Some(work.states),
        clock: &mut VirtualClock::default(),
    };
    Ok(told(&file, &judge(&exercise, source, &mut limits)))
}

fn told(file: &File, graded: &Graded) -> Checked {
    let language = file.language;
    let place = |at: Option<Span>| at.map(|at| file.units(at));
    Checked {
        mark: match graded.mark {
            Mark::Passed => Outcome::Passed,
            Mark::Changed => Outcome::Changed,
            Mark::Fitted => Outcome::Fitted,
            Mark::Failed => Outcome::Failed,
            Mark::Unread => Outcome::Unread,
        },
        problems: graded
            .problems
            .iter()
            .map(|p| problems::row(file, &graded.source.own(p.clone())))
            .collect(),
        changed: graded
            .changed
            .iter()
            .map(|c| Change {
                what: c.what.in_language(language),
                from: place(c.at).map(|p| p.0),
                to: place(c.at).map(|p| p.1),
            })
            .collect(),
        missing: graded.lacks.iter().map(|l| l.said().in_language(language)).collect(),
        tests: graded.tests.iter().map(|t| test(t, language)).collect(),
        questions: graded.questions.iter().map(|q| question(q, language)).collect(),
    }
}

fn test(test: &Tested, language: Language) -> TestRow {
    let (time, seen) = match &test.ended {
        Ended::Failed(defect) => (Some(defect.time.as_millis()), Some(defect).filter(|_| !test.hidden)),
        Ended::Passed | Ended::Blocked { .. } => (None, None),
    };
    TestRow {
        hidden: test.hidden,
        ok: test.ended.is_passed(),
        title: (!test.hidden).then(|| test.title.clone()),
        why: test.ended.why().filter(|_| !test.hidden).map(|why| why.in_language(language)),
        time_ms: time,
        got: seen.map(|d| d.got.clone()).unwrap_or_default(),
        run: seen.and_then(|d| Scan::up_to(d)),
    }
}

fn question(question: &Answered, language: Language) -> QuestionRow {
    let seen = !question.hidden;
    QuestionRow {
        hidden: question.hidden,
        // A question that cannot be asked of these charts does not hold.
        verdict: question.verdict.as_ref().map_or(Found::Refuted, Found::of),
        claim: seen.then(|| question.claim.in_language(language)),
        reason: seen.then(|| question.reason.in_language(language)),
        run: match &question.verdict {
            Some(Verdict::Refuted(Evidence::Run(run))) if seen => Some(Scan::list(&run.moves)),
            _ => None,
        },
    }
}
