//! Answers as the panel shows them.

use g7_ide::File;
use g7_ide::ids;
use g7_model::{Document, Nanos, Span};
use g7_verify::words::{self, Said};
use g7_verify::{Claim, Evidence, Model, Question, Run, Verdict, blame};
use serde::{Deserialize, Serialize};

use crate::run::Scan;

/// All answers to the questions of a file.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ProofReport"))]
pub(crate) struct Report {
    /// The fingerprint of the text that was asked, as in the overview of a file.
    hash: String,
    /// True where errors stand in the way of all questions.
    refused: bool,
    rows: Vec<Row>,
    /// The number of questions.
    #[serde(skip)]
    asked: usize,
}

impl Report {
    pub(super) fn new(hash: &str) -> Report {
        Report { hash: hash.to_owned(), refused: false, rows: Vec::new(), asked: 0 }
    }

    pub(super) fn refused(hash: &str) -> Report {
        Report { refused: true, ..Report::new(hash) }
    }

    /// Adds the answers to questions; their numbers follow those of the earlier ones.
    pub(super) fn add(
        &mut self,
        file: &File,
        model: &Model<'_>,
        questions: &[Question],
        answers: &[Option<Verdict>],
    ) {
        let first = self.asked;
        self.asked += questions.len();
        let numbered = (first..).zip(questions.iter().zip(answers));
        self.rows.extend(numbered.filter_map(|(n, (q, v))| Some(row(file, model, n, q, v.as_ref()?))));
    }
}

/// The kinds of claims.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
enum About {
    Step,
    Transition,
    Action,
    Variable,
    Deadlock,
    Conflict,
    Chart,
    Property,
}

/// The present knowledge of a claim.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Verdict"))]
#[serde(rename_all = "snake_case")]
pub(crate) enum Found {
    Proved,
    Refuted,
    Open,
}

impl Found {
    /// The word for a verdict.
    pub(crate) fn of(verdict: &Verdict) -> Found {
        match verdict {
            Verdict::Proved(_) => Found::Proved,
            Verdict::Refuted(_) => Found::Refuted,
            Verdict::Open(_) => Found::Open,
        }
    }
}

/// The answer to one question.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ProofRow", optional_fields))]
struct Row {
    /// The number of the question.
    number: usize,
    claim: Said,
    /// True if the author asks it in the file.
    own: bool,
    /// The kind of claim, for the panel.
    about: About,
    verdict: Found,
    reason: Said,
    /// The way out; empty if none is known.
    help: Said,
    /// The place of what is asked about.
    from: usize,
    to: usize,
    line: usize,
    /// The symbol that is asked about.
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<String>,
    /// The symbols that take part in what the last scan of the run shows.
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    blame: Vec<String>,
    /// The run that shows the answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    run: Option<Vec<Scan>>,
    /// The ways in which its plant ticked, for each scan; empty unless it draws random numbers.
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    chance: Vec<u8>,
}

/// Most scans of a run that comes with a claim that something can be; refuted claims and those of the
/// author have theirs whatever its length.
const LONG: usize = 200;

fn row(file: &File, model: &Model<'_>, number: usize, question: &Question, verdict: &Verdict) -> Row {
    let range = file.source.range(question.at);
    let (line, _) = file.positions.line_column(file.text(), range.start);
    let written = file.text().get(range).unwrap_or_default();
    let (from, to) = file.units(question.at);
    let own = question.claim.is_own();
    let run = match verdict {
        Verdict::Proved(Evidence::Run(run)) if own || run.moves.len() <= LONG => Some(run),
        Verdict::Refuted(Evidence::Run(run)) => Some(run),
        Verdict::Proved(_) | Verdict::Refuted(_) | Verdict::Open(_) => None,
    };
    let time = |run: &Run| Nanos::new(run.moves.iter().fold(0, |sum, m| m.wait.saturating_add(sum)));
    let time = match verdict {
        Verdict::Proved(Evidence::Run(run)) | Verdict::Refuted(Evidence::Run(run)) => time(run),
        Verdict::Proved(_) | Verdict::Refuted(_) | Verdict::Open(_) => Nanos::ZERO,
    };
    Row {
        number,
        claim: words::claim(written, model.compiled, question),
        own,
        about: about(&question.claim),
        verdict: Found::of(verdict),
        reason: words::reason(verdict, time),
        help: match verdict {
            // The panel has a button for it, and no options.
            Verdict::Open(open) if open.reason.is_of_budget() => Said::default(),
            Verdict::Proved(_) | Verdict::Refuted(_) | Verdict::Open(_) => words::help(question, verdict),
        },
        from,
        to,
        line,
        id: symbol(file.source.whole(), question),
        blame: match (verdict, run) {
            (Verdict::Refuted(_), Some(run)) => guilty(file.source.whole(), model, &question.claim, run),
            _ => Vec::new(),
        },
        chance: run.map_or_else(Vec::new, |run| run.ways.clone()),
        run: run.map(|run| Scan::list(&run.moves)),
    }
}

fn about(claim: &Claim) -> About {
    match claim {
        Claim::Active(_) => About::Step,
        Claim::Clears(_) => About::Transition,
        Claim::Runs(_) => About::Action,
        Claim::On(_) | Claim::Asked(_) => About::Variable,
        Claim::NoDeadlock => About::Deadlock,
        Claim::NoConflict => About::Conflict,
        Claim::NoUnsafe
        | Claim::NoInstability
        | Claim::NoOpposedWrites
        | Claim::NoOpposedOrders
        | Claim::NoFault => About::Chart,
        _ => About::Property,
    }
}

/// The step, transition or action that a question names.
fn symbol(document: &Document, question: &Question) -> Option<String> {
    match question.claim {
        Claim::Active(_) | Claim::Clears(_) | Claim::Runs(_) => Some(ids::at(document, question.at)?.id()),
        _ => None,
    }
}

fn guilty(document: &Document, model: &Model<'_>, claim: &Claim, run: &Run) -> Vec<String> {
    let symbols = &model.compiled.symbols;
    let found = blame(model, claim, run);
    let steps = found.steps.into_iter().filter(|s| symbols.is_listed(*s)).map(|s| symbols.step_place(s));
    let ranks = found.transitions.into_iter().filter(|r| symbols.is_written(*r));
    let places: Vec<Span> = steps.chain(ranks.map(|r| symbols.transition_place(r))).collect();
    let mut found: Vec<String> =
        places.into_iter().filter_map(|at| Some(ids::at(document, at)?.id())).collect();
    found.dedup();
    found
}
