//! The ways on from a refuted claim: a test that fails, and the changes of the text that cure it.

use g7_edit::spliced;
use g7_engine::{State, scan};
use g7_host::VirtualClock;
use g7_model::{Document, Item};
use g7_rig::Source;
use g7_rig::testing::{self, Coverage};
use g7_verify::{Claim, Model, Move, Question, Run, words};
use serde::{Deserialize, Serialize};

use super::asked::questions;
use super::cures::{Cure, cures};
use super::place::{Sort, place};
use super::saved::{self, Given};
use crate::file::File;
use crate::ids;
use crate::overview::hash;
use crate::positions::Change;
use crate::run::Scan;

/// The page's request for the ways on from an answer.
#[derive(Debug, Deserialize)]
pub(crate) struct Wish {
    /// The fingerprint of the text that was asked.
    hash: String,
    /// The number of the question.
    question: usize,
    run: Vec<Scan>,
}

/// The ways on from a refuted claim.
#[derive(Debug, Serialize)]
pub(crate) struct Ways {
    cures: Vec<Cure>,
    /// The change that adds a test to the file, which fails as long as the claim does.
    #[serde(skip_serializing_if = "Option::is_none")]
    test: Option<Added>,
    /// Why there is no test.
    #[serde(skip_serializing_if = "Option::is_none")]
    untested: Option<String>,
}

/// A test with the change that adds it.
#[derive(Debug, Serialize)]
struct Added {
    title: String,
    splices: Vec<Change>,
}

/// The ways on from a claim that a run refutes.
pub(crate) fn ways(file: &File, wish: &Wish) -> Result<Ways, String> {
    let asked = questions(file).filter(|_| hash(file.text()) == wish.hash);
    let asked = asked.ok_or("the text has changed since: ask again")?;
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let Some(question) = asked.questions.get(wish.question) else {
        let untested = "a plant takes part: `g7 prove --save` writes a test with it".to_owned();
        return Ok(Ways { cures: Vec::new(), test: None, untested: Some(untested) });
    };
    let moves = Scan::moves(&wish.run, model.inputs.len());
    let run = ended(&model, moves);
    let cures = match question.claim {
        Claim::NoConflict => cures(file, &model, &run),
        _ => Vec::new(),
    };
    let (test, untested) = match test(file, &model, question, &run) {
        Ok(test) => (Some(test), None),
        Err(why) => (None, Some(why)),
    };
    Ok(Ways { cures, test, untested })
}

/// A run with the fault that stops its last scan, if one does.
fn ended(model: &Model<'_>, moves: Vec<Move>) -> Run {
    let p = &model.compiled.program;
    let mut s = State::new(p);
    let mut fault = None;
    for m in &moves {
        let now = s.now().saturating_add(m.wait);
        fault = scan(p, &mut s, &m.inputs, now).err();
        if fault.is_some() {
            break;
        }
    }
    Run { moves, fault, ..Run::default() }
}

/// The test of a run, if it fails in its last statement.
fn test(file: &File, model: &Model<'_>, question: &Question, run: &Run) -> Result<Added, String> {
    let unseen = || saved::UNSEEN.to_owned();
    let options = g7_rig::Options { plant: Some("none"), ..g7_rig::Options::default() };
    let bench = g7_rig::build(&file.source, &options).map_err(|e| e.to_string())?.0.ok_or_else(unseen)?;
    let written = file.text().get(file.source.range(question.at)).unwrap_or_default();
    let [claim, ..] = words::claim(written, model.compiled, question);
    let given = Given { source: &file.source, bench: &bench, model, question, run };
    let made = saved::of_run(&given, &fresh(file, saved::title(&claim)))?;
    let title = made.title.to_string();
    let items = vec![Item::Test(made)];
    let printed = g7_syntax::print(&Document { items, ..Document::default() }, None);
    let splice = place(file, Sort::Test, printed.trim());
    let text = spliced(file.text(), std::slice::from_ref(&splice)).ok_or_else(unseen)?;
    if !fails(&file.source.name, text, &title) {
        return Err(unseen());
    }
    Ok(Added { title, splices: file.outward(&[splice]) })
}

/// A title that no test of the file has yet.
fn fresh(file: &File, title: String) -> String {
    let taken = |title: &str| file.source.tests().any(|t| &*t.title == title);
    let numbered = |n: u32| format!("{title} ({n})");
    if taken(&title) { (2..).map(numbered).find(|t| !taken(t)).unwrap_or(title) } else { title }
}

/// True if the test with this title fails in its last statement.
fn fails(name: &str, text: String, title: &str) -> bool {
    let source = Source::new(name, text.into_bytes(), 0);
    let options = testing::Options { filter: Some(title), ..testing::Options::default() };
    let (mut coverage, mut clock) = (Coverage::default(), VirtualClock::default());
    let Ok((outcomes, _)) = testing::file(&source, options, &mut coverage, &mut clock, &mut || {}) else {
        return false;
    };
    let last = source.tests().find(|t| &*t.title == title).and_then(|t| t.body.last()).map(|s| s.at.0);
    let defect = outcomes.iter().find(|o| o.title == title).and_then(|o| o.defect.as_ref());
    last.zip(defect).is_some_and(|(last, d)| ids::holds(last, d.at))
}
