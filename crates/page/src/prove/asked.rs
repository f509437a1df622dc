//! The questions of a text, with the answers found so far.

use g7_edit::{Splice, spliced};
use g7_ide::File;
use g7_model::Severity;
use g7_rig::Source;
use g7_rig::testing::plants;
use g7_verify::{Asked, Budget, Closed, Model, Verdict, ask, ask_with, attempt};
use serde::Deserialize;

use super::rows::Report;
use crate::overview::hash;

/// The page's request: how far the search may go.
#[derive(Clone, Copy, Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Limits {
    /// Most states kept.
    pub(super) states: usize,
    /// Most memory for them, in MiB.
    pub(super) mib: usize,
}

/// Greatest limits, whatever the page asks for.
pub(super) const MOST: Limits = Limits { states: 20_000_000, mib: 1024 };

/// States from which on a search is long enough that a solver may try as well.
const SOLVED: usize = 100_000;

/// The questions of a text, with the answers found so far.
pub(crate) struct Proof {
    /// The fingerprint of the text.
    hash: String,
    /// Absent where errors stand in the way.
    asked: Option<Asked>,
    answers: Vec<Option<Verdict>>,
    /// The questions with a plant, with their answers.
    closed: Vec<(Closed, Vec<Option<Verdict>>)>,
}

/// Searches for the answers that are still open. `known` are those of an earlier call.
pub(crate) fn prove(file: &File, known: Option<Proof>, limits: Limits) -> (Proof, Report) {
    let hash = hash(&file.source);
    let mut proof = known.filter(|p| p.hash == hash).unwrap_or_else(|| begin(file, hash));
    let Some(asked) = &proof.asked else {
        let report = Report::refused(&proof.hash);
        return (proof, report);
    };
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let budget = Budget {
        states: limits.states.min(MOST.states),
        scans: usize::MAX,
        bytes: limits.mib.min(MOST.mib) << 20,
        stop: &|| false,
    };
    // The quick search while somebody types has fewer states.
    let solve = limits.states >= SOLVED;
    attempt(&model, &asked.questions, &mut proof.answers, &budget, solve);
    let mut report = Report::new(&proof.hash);
    report.add(file, &model, &asked.questions, &proof.answers);
    for (closed, answers) in &mut proof.closed {
        let model = closed.model();
        attempt(&model, &closed.questions, answers, &budget, solve);
        report.add(file, &model, &closed.questions, answers);
    }
    (proof, report)
}

fn begin(file: &File, hash: String) -> Proof {
    let asked = questions(file);
    let answers = asked.as_ref().map_or_else(Vec::new, |a| vec![None; a.questions.len()]);
    let closed = if asked.is_some() { closed(&file.source) } else { Vec::new() };
    let closed =
        closed.into_iter().map(|c| (vec![None; c.questions.len()], c)).map(|(a, c)| (c, a)).collect();
    Proof { hash, asked, answers, closed }
}

/// The questions about charts and plants, in the order of their numbers. Their problems are among those
/// of the file.
pub(super) fn closed(source: &Source) -> Vec<Closed> {
    let one = |plant: &str| ask_with(source, None, plant, false).ok()?.0;
    plants(&source.document).into_iter().filter_map(one).collect()
}

/// The text with these changes, and its questions, if it has no errors.
pub(super) fn changed(file: &File, splices: &[Splice]) -> Option<(Source, Asked)> {
    let source = Source::new(&file.source.name, spliced(file.text(), splices)?.into_bytes(), 0);
    let source = source.linked_like(&file.source);
    let (asked, problems) = ask(source.whole(), None);
    let wrong = source.is_broken() || problems.iter().any(|p| p.severity() == Severity::Error);
    asked.filter(|_| !wrong).map(|asked| (source, asked))
}

/// The questions of a file without errors.
pub(super) fn questions(file: &File) -> Option<Asked> {
    let wrong = file.problems.iter().any(|p| p.severity() == Severity::Error);
    if wrong { None } else { ask(file.source.whole(), None).0 }
}
