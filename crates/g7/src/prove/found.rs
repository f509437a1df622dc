//! The answers to the questions of a file, ready to be told.

use std::collections::BTreeMap;

use g7_model::{Nanos, Said};
use g7_verify::{Open, Reason, Verdict, words};
use g7_why::Cause;

use crate::report::Tally;

/// Questions without an answer that are listed for a file, unless all are wanted.
pub(super) const LISTED: usize = 12;

/// Questions that are not decided for one reason: the number that is listed, and of those that are not
/// the numbers by their rules. They are sure up to different numbers of scans; the least counts.
#[derive(Default)]
pub(super) struct More {
    pub(super) listed: usize,
    /// The least number of scans, and the reason with it in words.
    pub(super) least: Option<(usize, Said)>,
    pub(super) hidden: BTreeMap<&'static str, usize>,
}

/// The result of a file.
#[derive(Default)]
pub(super) struct Found {
    /// Its name in messages.
    pub(super) name: String,
    /// The answers, in the order of the questions.
    pub(super) answers: Vec<Answered>,
    /// Further questions that are not decided, by the reason. There are few reasons.
    pub(super) more: Vec<(Reason, More)>,
    /// The problems of its text, and those that contradicting assumptions are.
    pub(super) tally: Tally,
    /// The problems in words, with excerpts of the text.
    pub(super) trouble: String,
    /// Why nothing was asked.
    pub(super) unasked: Option<Said>,
    /// A search was stopped before all was decided.
    pub(super) is_stopped: bool,
}

/// An answered question, ready to be printed.
pub(crate) struct Answered {
    /// `path:line:column` of what is asked about.
    pub(crate) place: String,
    /// The claim in words.
    pub(crate) claim: Said,
    /// The author wrote it.
    pub(crate) own: bool,
    /// The evidence in one line.
    pub(crate) reason: Said,
    /// The steps and transitions that break the claim, in a sentence; empty where nothing is to be added.
    pub(crate) guilt: Said,
    /// The way out; empty where none is known.
    pub(crate) help: Said,
    /// The answer.
    pub(crate) verdict: Verdict,
    /// The run that shows it, drawn; empty without one.
    pub(crate) chronogram: String,
    /// The question by its short name.
    pub(crate) rule: &'static str,
    /// The scans of the run, each in words.
    pub(crate) scans: Vec<String>,
    /// Why what the claim names has its value at the end of the run.
    pub(crate) why: Vec<Cause>,
}

impl Found {
    /// Counts a question that is not decided; true if it is not to be listed.
    pub(super) fn hides(&mut self, open: &Open, verdict: &Verdict, rule: &'static str) -> bool {
        let known = self.more.iter().position(|(reason, _)| *reason == open.reason);
        let at = known.unwrap_or_else(|| {
            self.more.push((open.reason.clone(), More::default()));
            self.more.len() - 1
        });
        let Some((_, more)) = self.more.get_mut(at) else { return false };
        if more.least.as_ref().is_none_or(|(scans, _)| open.scans < *scans) {
            more.least = Some((open.scans, Said::in_each(words::reason(verdict, Nanos::ZERO))));
        }
        if more.listed < LISTED {
            more.listed += 1;
            return false;
        }
        *more.hidden.entry(rule).or_default() += 1;
        true
    }

    /// The number of questions that are not decided and not listed.
    pub(super) fn hidden(&self) -> usize {
        self.more.iter().flat_map(|(_, more)| more.hidden.values()).sum()
    }
}
