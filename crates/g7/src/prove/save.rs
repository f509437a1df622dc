//! `g7 prove --save`: refuted claims as tests that fail.
//!
//! A test states what the claim expects of the shortest run that breaks it. Each one was run
//! before it is written, and it fails where the claim does.

use g7_model::{ProfileName, Said, Scenario};
use g7_page::saved::{Given, NO_RUN, UNSEEN, of_run, short, title};
use g7_rig::{Bench, Source};
use g7_verify::{Evidence, Model, Question, Verdict, words};

use super::added;
use crate::failure::Failure;

/// The tests of refuted claims.
#[derive(Default)]
pub(super) struct Saved {
    /// The tests, in the order of the questions.
    pub(super) tests: Vec<Scenario>,
    /// Claims that are refuted without a test, each with the reason.
    pub(super) left: Vec<(Said, Said)>,
}

/// Adds the tests of refuted claims about charts on a bench.
pub(super) fn tests(
    saved: &mut Saved,
    source: &Source,
    bench: &Bench,
    model: &Model<'_>,
    answered: (&[Question], &[Option<Verdict>]),
    profile: Option<ProfileName>,
) -> Result<(), Failure> {
    for (question, verdict) in answered.0.iter().zip(answered.1) {
        let Some(Verdict::Refuted(evidence)) = verdict else { continue };
        let written = source.written(question.at);
        let claims = words::claim(written, model.compiled, question);
        let title = title(&claims[0]);
        let claim = || Said::in_each(claims.each_ref().map(|claim| short(claim)));
        let reason = |told: g7_model::words::Told| Said::in_each(told.map(str::to_owned));
        let made = match evidence {
            Evidence::Run(run) => of_run(&Given { source, bench, model, question, run }, &title),
            Evidence::Certificate(_) => Err(NO_RUN),
        };
        match made {
            Ok(test) if saved.tests.contains(&test) => {}
            Ok(test) if fails(source, &test, profile)? => saved.tests.push(test),
            Ok(_) => saved.left.push((claim(), reason(UNSEEN))),
            Err(why) => saved.left.push((claim(), reason(why))),
        }
    }
    Ok(())
}

/// True if a test fails in its last statement, or in the one before where the last is a comment.
fn fails(source: &Source, test: &Scenario, profile: Option<ProfileName>) -> Result<bool, Failure> {
    let (made, outcomes, _) = added::run(source, std::slice::from_ref(test), profile)?;
    let last = made.tests().last().and_then(|t| t.body.last()).map(|s| s.at.0);
    let at = outcomes.last().and_then(|o| o.defect.as_ref()).map(|d| d.at);
    Ok(matches!((last, at), (Some(last), Some(at)) if last.start <= at.start && at.end <= last.end))
}
