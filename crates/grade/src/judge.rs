//! Grades one submission: its charts under the tests and questions of the exercise.
//!
//! ```text
//! charts of the submission + plants, tests, properties of the exercise -> rig::testing -> Tested
//!                                                                     -> verify       -> Answered
//! ```
//!
//! # What must hold
//!
//! - A test that cannot be asked of a submission, because a name is missing, has failed; all others run.
//! - A test that takes too long is ended and has failed. A question that is not decided in time stays open.

use std::collections::BTreeSet;

use g7_host::Clock;
use g7_model::{Item, Nanos, Problem, Property, PropertyKind, Said, Span, say};
use g7_rig::testing::{self, Coverage, Defect, Options, Outcome};
use g7_rig::{Error, Source};
use g7_verify::{Budget, Evidence, Model, Open, Question, Verdict, answer, ask, ask_with, attempt, words};

use crate::exercise::{Exercise, errors};
use crate::locked::{self, Changed};
use crate::needs::{self, Lack};

/// True when a search is to end.
pub type Stop = Box<dyn Fn() -> bool + Sync>;

/// How much work a submission may make.
pub struct Limits<'a> {
    /// The real time of a test.
    pub test: Nanos,
    /// Starts the clock of the questions; what it returns says when their time is over.
    pub questions: &'a dyn Fn() -> Stop,
    /// Most bytes that a search keeps.
    pub bytes: usize,
    /// Most states that a search keeps, for a caller without a clock, who cannot end it; `None` for one who can.
    pub states: Option<usize>,
    /// The clock of the tests.
    pub clock: &'a mut dyn Clock,
}

/// The result of a submission, in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mark {
    /// All tests passed, and nothing is refuted.
    Passed,
    /// The same, but a locked part is not as in the template.
    Changed,
    /// All that the student sees passed, and something hidden did not.
    Fitted,
    /// A test failed that the student sees.
    Failed,
    /// The charts have errors, so nothing ran.
    Unread,
}

impl Mark {
    /// The key in reports for programs.
    pub fn key(self) -> &'static str {
        match self {
            Mark::Passed => "passed",
            Mark::Changed => "locked part changed",
            Mark::Fitted => "passes the visible tests only",
            Mark::Failed => "failed",
            Mark::Unread => "errors",
        }
    }

    /// The word for a reader.
    pub fn said(self) -> Said {
        match self {
            Mark::Passed => say!("passed"),
            Mark::Changed => say!("locked part changed"),
            Mark::Fitted => say!("passes the visible tests only"),
            Mark::Failed => say!("failed"),
            Mark::Unread => say!("errors"),
        }
    }
}

/// How a test of the exercise ended.
#[derive(Clone, Debug)]
pub enum Ended {
    /// It passed.
    Passed,
    /// It failed.
    Failed(Box<Defect>),
    /// It could not be asked of these charts: the place in the exercise, and why.
    Blocked {
        /// `path:line:column`.
        place: String,
        /// The problem.
        what: Said,
    },
}

impl Ended {
    /// True for a test that passed.
    pub fn is_passed(&self) -> bool {
        matches!(self, Ended::Passed)
    }

    /// Why it did not pass.
    pub fn why(&self) -> Option<Said> {
        match self {
            Ended::Passed => None,
            Ended::Failed(defect) => Some(defect.sentence()),
            Ended::Blocked { what, .. } => Some(what.clone()),
        }
    }

    /// The place at which it ended.
    pub fn place(&self) -> Option<&str> {
        match self {
            Ended::Passed => None,
            Ended::Failed(defect) => Some(&defect.place),
            Ended::Blocked { place, .. } => Some(place),
        }
    }
}

/// A test of the exercise, and how it ended.
#[derive(Clone, Debug)]
pub struct Tested {
    /// Its title.
    pub title: String,
    /// True if the student does not see it.
    pub hidden: bool,
    /// Its place as `path:line:column`.
    pub place: String,
    /// The result.
    pub ended: Ended,
}

/// A question of the exercise, and its answer.
#[derive(Clone, Debug)]
pub struct Answered {
    /// As written.
    pub claim: Said,
    /// True if the student does not see it.
    pub hidden: bool,
    /// Its place as `path:line:column`.
    pub place: String,
    /// The answer; none if the question could not be asked of these charts.
    pub verdict: Option<Verdict>,
    /// The evidence, or why there is no answer.
    pub reason: Said,
}

impl Answered {
    /// True if a run breaks the claim, or if it cannot be asked.
    pub fn is_refuted(&self) -> bool {
        matches!(self.verdict, None | Some(Verdict::Refuted(_)))
    }

    /// True if the claim holds.
    pub fn is_proved(&self) -> bool {
        matches!(self.verdict, Some(Verdict::Proved(_)))
    }
}

/// A graded submission.
#[derive(Debug)]
pub struct Graded {
    /// Its charts with all that was asked of them, for places.
    pub source: Source,
    /// The result.
    pub mark: Mark,
    /// The errors of its charts.
    pub problems: Vec<Problem>,
    /// The names that the exercise looks at and that are not there.
    pub lacks: Vec<Lack>,
    /// The locked parts that it changes.
    pub changed: Vec<Changed>,
    /// The tests, those that the student sees first.
    pub tests: Vec<Tested>,
    /// The steps, transitions, actions and branches that the tests reached.
    pub coverage: Coverage,
    /// The questions, in the order of the text.
    pub questions: Vec<Answered>,
}

impl Graded {
    /// The number of tests that passed, and the number of all tests.
    pub fn passed(&self) -> (usize, usize) {
        (self.tests.iter().filter(|t| t.ended.is_passed()).count(), self.tests.len())
    }

    /// The number of questions that are proved, and the number of all questions.
    pub fn proved(&self) -> (usize, usize) {
        (self.questions.iter().filter(|q| q.is_proved()).count(), self.questions.len())
    }

    /// The first test that did not pass.
    pub fn first_failing(&self) -> Option<&Tested> {
        self.tests.iter().find(|t| !t.ended.is_passed())
    }

    /// The elements that the tests reached, and all of them.
    pub fn reached(&self) -> (usize, usize) {
        let rows = || self.coverage.sorts().into_iter().flat_map(|(_, rows)| rows.values());
        (rows().filter(|r| r.hits > 0).count(), rows().count())
    }
}

/// Grades a submission.
pub fn judge(exercise: &Exercise, submission: Source, limits: &mut Limits<'_>) -> Graded {
    let changed = locked::changed(&exercise.locked, &exercise.template.document, &submission);
    let lacks = needs::lacks(&exercise.needs, &submission);
    let mut graded = Graded {
        source: submission.charts_alone().asked_by(&exercise.asked),
        mark: Mark::Unread,
        problems: Vec::new(),
        lacks,
        changed,
        tests: Vec::new(),
        coverage: Coverage::default(),
        questions: Vec::new(),
    };
    let tests = if graded.source.is_broken() {
        Err(errors(graded.source.read_problems()))
    } else {
        tested(&graded.source, exercise, limits, &mut graded.coverage)
    };
    match tests {
        Ok(tests) => graded.tests = tests,
        Err(problems) => {
            // Charts that cannot be read may still have the names and parts, so nothing is said of these.
            return Graded { problems, lacks: Vec::new(), changed: Vec::new(), ..graded };
        }
    }
    graded.questions = answered(&graded.source, exercise, limits);
    graded.mark = mark(&graded);
    graded
}

fn mark(graded: &Graded) -> Mark {
    let failed = |hidden: bool| {
        graded.tests.iter().any(|t| t.hidden == hidden && !t.ended.is_passed())
            || graded.questions.iter().any(|q| q.hidden == hidden && q.is_refuted())
    };
    let sees_none = graded.tests.iter().all(|t| t.hidden);
    match (failed(false), failed(true)) {
        (true, _) => Mark::Failed,
        (false, true) if sees_none => Mark::Failed,
        (false, true) => Mark::Fitted,
        (false, false) if !graded.changed.is_empty() => Mark::Changed,
        (false, false) => Mark::Passed,
    }
}

/// True for a place in template or model solution, of a source that has these beside its own files.
fn is_hidden(exercise: &Exercise, at: Span) -> bool {
    at.file == exercise.model.id()
}

/// Runs the tests. A test that has an error with these charts is left out, and all others are run again.
///
/// # Errors
///
/// The errors of the charts themselves.
fn tested(
    source: &Source,
    exercise: &Exercise,
    limits: &mut Limits<'_>,
    coverage: &mut Coverage,
) -> Result<Vec<Tested>, Vec<Problem>> {
    let options = Options { limit: Some(limits.test), ..Options::default() };
    let mut blocked: Vec<(Span, Problem)> = Vec::new();
    let mut runs = without(source, &BTreeSet::new());
    loop {
        *coverage = Coverage::default();
        let run = testing::file(&runs, options, coverage, limits.clock, &mut || {});
        let (outcomes, problems) = match run {
            Ok((outcomes, problems)) => (outcomes, errors(problems)),
            // The plants of tests stand beside them, so no name of one can be missing.
            Err(Error::NoPlant { .. } | Error::SeveralPlants { .. }) => (Vec::new(), Vec::new()),
        };
        if problems.is_empty() {
            return Ok(in_order(source, exercise, outcomes, &blocked));
        }
        let before = blocked.len();
        for test in runs.tests() {
            let plant = test.plant.as_ref().and_then(|name| plant(&runs, &name.text));
            let of_it = |p: &&Problem| test.at.0.holds(p.at) || plant.is_some_and(|plant| plant.holds(p.at));
            if let Some(problem) = problems.iter().find(of_it) {
                blocked.push((test.at.0, problem.clone()));
            }
        }
        let own: Vec<Problem> = problems.iter().filter(|p| !is_asked(exercise, p.at)).cloned().collect();
        if !own.is_empty() || blocked.len() == before {
            return Err(if own.is_empty() { problems } else { own });
        }
        runs = without(source, &blocked.iter().map(|(at, _)| *at).collect());
    }
}

/// True for a place in what the exercise asks.
fn is_asked(exercise: &Exercise, at: Span) -> bool {
    at.file == exercise.template.id() || at.file == exercise.model.id()
}

/// The place of a plant.
fn plant(source: &Source, name: &str) -> Option<Span> {
    source.document.items.iter().find_map(|i| match i {
        Item::Plant(p) if *p.name.text == *name => Some(p.at.0),
        _ => None,
    })
}

/// The same charts without some tests. Properties are left out too: they are asked later.
fn without(source: &Source, tests: &BTreeSet<Span>) -> Source {
    let mut copy = source.clone();
    copy.amend(|document| {
        document.items.retain(|i| match i {
            Item::Prove(_) => false,
            Item::Test(t) => !tests.contains(&t.at.0),
            _ => true,
        });
    });
    copy
}

/// All tests in the order of the exercise.
fn in_order(
    source: &Source,
    exercise: &Exercise,
    outcomes: Vec<Outcome>,
    blocked: &[(Span, Problem)],
) -> Vec<Tested> {
    let mut outcomes: Vec<Option<Outcome>> = outcomes.into_iter().map(Some).collect();
    source
        .tests()
        .map(|test| {
            let at = test.at.0;
            let outcome = outcomes.iter_mut().find(|o| o.as_ref().is_some_and(|o| o.at == at));
            let ended = match (outcome.and_then(Option::take), blocked.iter().find(|(of, _)| *of == at)) {
                (Some(Outcome { defect: None, .. }), _) => Ended::Passed,
                (Some(Outcome { defect: Some(defect), .. }), _) => Ended::Failed(defect),
                (None, Some((_, p))) => Ended::Blocked { place: source.place(p.at), what: p.what.clone() },
                (None, None) => Ended::Blocked { place: source.place(at), what: say!("it was not run") },
            };
            let hidden = is_hidden(exercise, at);
            Tested { title: test.title.to_string(), hidden, place: source.place(at), ended }
        })
        .collect()
}

/// Answers the questions of the exercise. A question that has an error with these charts is left out, and all others
/// are asked.
fn answered(source: &Source, exercise: &Exercise, limits: &Limits<'_>) -> Vec<Answered> {
    if source.document.properties().next().is_none() {
        return Vec::new();
    }
    let stop = (limits.questions)();
    let search = limits.states.map_or(Search::Whole, |_| Search::Short);
    let budget = Budget {
        states: limits.states.unwrap_or(usize::MAX),
        scans: usize::MAX,
        bytes: limits.bytes,
        stop: &*stop,
    };
    let mut found: Vec<(Span, Answered)> = Vec::new();
    let mut asks = source.clone();
    let mut plants: Vec<Option<String>> = vec![None];
    plants.extend(testing::plants(&source.document).into_iter().map(|name| Some(name.to_owned())));
    for plant in &plants {
        let is_mine = |p: &Property| p.plant.as_ref().map(|name| &*name.text) == plant.as_deref();
        while asks.document.properties().any(|p| is_mine(p) && !is_assumption(p)) {
            let problems = match asked(&asks, plant.as_deref(), search, &budget) {
                Ok(verdicts) => {
                    found.extend(verdicts.into_iter().map(|one| (one.at, one.said(source, exercise))));
                    break;
                }
                Err(problems) => problems,
            };
            let mut wrong: Vec<(Span, Said)> = Vec::new();
            for property in asks.document.properties().filter(|p| is_mine(p)) {
                let problem = problems.iter().find(|p| property.at.0.holds(p.at));
                wrong.extend(problem.map(|p| (property.at.0, p.what.clone())));
            }
            if wrong.is_empty() {
                let why = problems.first().map_or_else(|| say!("it was not asked"), |p| p.what.clone());
                wrong = asks
                    .document
                    .properties()
                    .filter(|p| is_mine(p))
                    .map(|p| (p.at.0, why.clone()))
                    .collect();
            }
            asks.amend(|d| {
                d.items.retain(|i| !matches!(i, Item::Prove(p) if wrong.iter().any(|(at, _)| *at == p.at.0)));
            });
            found.extend(wrong.into_iter().map(|(at, why)| (at, blocked(source, exercise, at, why))));
        }
    }
    found.sort_by_key(|(at, _)| *at);
    found.into_iter().map(|(_, one)| one).collect()
}

fn is_assumption(property: &Property) -> bool {
    matches!(property.kind, PropertyKind::Assume(_))
}

/// How far a search goes.
#[derive(Clone, Copy)]
enum Search {
    /// Until the caller ends it.
    Whole,
    /// As far as the number of states allows, and a little further.
    Short,
}

/// A question that was asked.
struct Asked {
    at: Span,
    claim: Said,
    verdict: Option<Verdict>,
}

impl Asked {
    fn said(self, source: &Source, exercise: &Exercise) -> Answered {
        let reason = self.verdict.as_ref().map_or_else(
            || say!("the time for questions was over"),
            |verdict| Said::in_each(words::reason(verdict, length(verdict))),
        );
        Answered {
            claim: self.claim,
            hidden: is_hidden(exercise, self.at),
            place: source.place(self.at),
            // Nothing is known of a question that was not reached, which is not the same as one that cannot be asked.
            verdict: self.verdict.or(Some(Verdict::Open(Open::default()))),
            reason,
        }
    }
}

/// Asks the questions about the charts alone, or about charts and a plant.
///
/// # Errors
///
/// The errors of charts or questions.
fn asked(
    source: &Source,
    plant: Option<&str>,
    search: Search,
    budget: &Budget<'_>,
) -> Result<Vec<Asked>, Vec<Problem>> {
    let put = |model: &Model<'_>, questions: &[Question]| {
        let own: Vec<Question> = questions.iter().filter(|q| q.claim.is_own()).cloned().collect();
        let mut verdicts = vec![None; own.len()];
        match search {
            Search::Whole => answer(model, &own, &mut verdicts, budget),
            Search::Short => attempt(model, &own, &mut verdicts, budget, true),
        }
        let claim = |q: &Question| Said::in_each(words::claim(source.written(q.at), model.compiled, q));
        let asked = own.iter().zip(verdicts).map(|(q, verdict)| Asked { at: q.at, claim: claim(q), verdict });
        asked.collect()
    };
    let Some(plant) = plant else {
        let (asked, problems) = ask(source.whole(), None);
        let asked = asked.ok_or_else(|| errors(problems))?;
        return Ok(put(&Model::new(&asked.compiled, asked.assume.clone()), &asked.questions));
    };
    match ask_with(source, None, plant, false) {
        Ok((Some(closed), _)) => Ok(put(&closed.model(), &closed.questions)),
        Ok((None, problems)) => Err(errors(problems)),
        Err(_) => Err(Vec::new()),
    }
}

/// A question that cannot be asked of these charts: its claim names what is not there, so it does not hold.
fn blocked(source: &Source, exercise: &Exercise, at: Span, reason: Said) -> Answered {
    let claim = Said::foreign(source.written(at).split_whitespace().collect::<Vec<_>>().join(" "));
    Answered { claim, hidden: is_hidden(exercise, at), place: source.place(at), verdict: None, reason }
}

/// The time of the run that an answer shows.
fn length(verdict: &Verdict) -> Nanos {
    match verdict {
        Verdict::Proved(Evidence::Run(run)) | Verdict::Refuted(Evidence::Run(run)) => {
            Nanos::new(run.moves.iter().fold(0, |sum, m| i64::saturating_add(sum, m.wait)))
        }
        _ => Nanos::ZERO,
    }
}
