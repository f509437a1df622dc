//! The ways on from a refuted claim: a test that fails, and the changes of the text that cure it.

use g7_edit::spliced;
use g7_engine::{State, scan};
use g7_host::VirtualClock;
use g7_ide::File;
use g7_model::{Document, Item, Said, say};
use g7_rig::testing::{self, Coverage};
use g7_rig::{Bench, Source};
use g7_verify::{Claim, Model, Move, Question, Run, words};
use serde::{Deserialize, Serialize};

use super::asked::{closed, questions};
use super::assume::Refuted;
use super::cures::{Cure, Way, cures};
use super::place::{Sort, place};
use super::saved::{self, Given};
use crate::overview::hash;
use crate::places::{Change, outward};
use crate::run::Scan;

/// The page's request for the ways on from an answer.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "WaysWish"))]
pub(crate) struct Wish {
    /// The fingerprint of the text that was asked.
    hash: String,
    /// The number of the question.
    question: usize,
    run: Vec<Scan>,
    /// The ways in which the plant ticked.
    #[serde(default)]
    #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
    chance: Vec<u8>,
}

/// The ways on from a refuted claim.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ProofWays", optional_fields))]
pub(crate) struct Ways {
    cures: Vec<Cure>,
    /// The change that adds a test to the file, which fails as long as the claim does.
    #[serde(skip_serializing_if = "Option::is_none")]
    test: Option<Added>,
    /// Why there is no test.
    #[serde(skip_serializing_if = "Option::is_none")]
    untested: Option<saved::Said>,
}

/// A test with the change that adds it.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
struct Added {
    title: String,
    splices: Vec<Change>,
}

/// The ways on from a claim that a run refutes.
pub(crate) fn ways(file: &File, wish: &Wish) -> Result<Ways, Said> {
    let asked = questions(file).filter(|_| hash(&file.source) == wish.hash);
    let asked = asked.ok_or_else(|| say!("the text has changed since; ask again"))?;
    if let Some(question) = asked.questions.get(wish.question) {
        let model = Model::new(&asked.compiled, asked.assume.clone());
        let options = g7_rig::Options { plant: Some("none"), ..g7_rig::Options::default() };
        let bench = g7_rig::build(&file.source, &options).ok().and_then(|(bench, _)| bench);
        return Ok(found(file, wish, (&model, question), bench.as_ref(), (None, wish.question)));
    }
    let mut number = wish.question - asked.questions.len();
    for (plant, closed) in closed(&file.source).iter().enumerate() {
        if let Some(question) = closed.questions.get(number) {
            let (model, place) = (closed.model(), (Some(plant), number));
            return Ok(found(file, wish, (&model, question), Some(&closed.bench), place));
        }
        number -= closed.questions.len();
    }
    Err(say!("there is no such question"))
}

fn found(
    file: &File,
    wish: &Wish,
    (model, question): (&Model<'_>, &Question),
    bench: Option<&Bench>,
    place: (Option<usize>, usize),
) -> Ways {
    let moves = Scan::moves(&wish.run, model.inputs.len());
    let run = Run { ways: wish.chance.clone(), ..ended(model, moves) };
    let mut cures = match question.claim {
        Claim::NoConflict => cures(file, model, &run),
        _ => Vec::new(),
    };
    if let Some((text, splice)) = (Refuted { file, model, question, run: &run, place }).assumed() {
        cures.push(Cure::new(Way::Assume, vec![text], outward(file, &[splice])));
    }
    let (test, untested) = match test(file, model, question, &run, bench) {
        Ok(test) => (Some(test), None),
        Err(why) => (None, Some(why)),
    };
    Ways { cures, test, untested }
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
fn test(
    file: &File,
    model: &Model<'_>,
    question: &Question,
    run: &Run,
    bench: Option<&Bench>,
) -> Result<Added, saved::Said> {
    let bench = bench.ok_or(saved::UNSEEN)?;
    let written = file.source.written(question.at);
    let [claim, ..] = words::claim(written, model.compiled, question);
    let given = Given { source: &file.source, bench, model, question, run };
    let made = saved::of_run(&given, &fresh(file, saved::title(&claim)))?;
    let title = made.title.to_string();
    let items = vec![Item::Test(made)];
    let printed = g7_syntax::print(&Document { items, ..Document::default() }, None);
    let splice = place(file, Sort::Test, printed.trim());
    let text = spliced(file.text(), std::slice::from_ref(&splice)).ok_or(saved::UNSEEN)?;
    if !fails(file, text, &title) {
        return Err(saved::UNSEEN);
    }
    Ok(Added { title, splices: outward(file, &[splice]) })
}

/// A title that no test of the file has yet.
fn fresh(file: &File, title: String) -> String {
    let taken = |title: &str| file.source.tests().any(|t| &*t.title == title);
    let numbered = |n: u32| format!("{title} ({n})");
    if taken(&title) { (2..).map(numbered).find(|t| !taken(t)).unwrap_or(title) } else { title }
}

/// True if the test with this title fails in its last statement.
fn fails(file: &File, text: String, title: &str) -> bool {
    let source = Source::new(&file.source.name, text.into_bytes(), 0).linked_like(&file.source);
    let options = testing::Options { filter: Some(title), ..testing::Options::default() };
    let (mut coverage, mut clock) = (Coverage::default(), VirtualClock::default());
    let Ok((outcomes, _)) = testing::file(&source, options, &mut coverage, &mut clock, &mut || {}) else {
        return false;
    };
    let last = source.tests().find(|t| &*t.title == title).and_then(|t| t.body.last()).map(|s| s.at.0);
    let defect = outcomes.iter().find(|o| o.title == title).and_then(|o| o.defect.as_ref());
    last.zip(defect).is_some_and(|(last, d)| last.holds(d.at))
}
