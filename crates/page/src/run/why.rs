//! Why something happened in a run. The record of the run is made where the run is; the answer, which is seldom asked for, by
//! the module that has everything.
//!
//! ```text
//! Run -> record (a tape as text) -> web/src/run/why.svelte.ts -> why: bench, g7_why -> Because
//! ```

use g7_host::Tape;
use g7_ide::{File, ids};
use g7_model::{Document, Language, Nanos, Said, say};
use g7_rig::{Activity, Bench, question};
use g7_why::{Cause, Question, Why};
use serde::{Deserialize, Serialize};

use super::places::{Part, Places};
use super::running::Run;
use super::times::time;
use super::wish::{Start, bench};
use crate::answer::{Shelved, shelf};

/// A question about a run.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "WhyAsked", optional_fields = nullable))]
pub(crate) struct Asked {
    /// The request that started the run.
    #[serde(flatten)]
    start: Start,
    /// The text that runs, and those that it uses.
    text: String,
    uses: Option<Vec<Shelved>>,
    /// The answer of `run_tape`.
    tape: String,
    /// The id of a symbol, or a name; without one it is asked what happened in the scan.
    about: Option<String>,
    /// The instance that is asked about, if the chart of the symbol has parameters.
    instance: Option<String>,
    /// The instant of the scan; without one, that of the last.
    ms: Option<f64>,
}

/// An answer: its sentences in the order in which they are read, causes behind their effects.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Because {
    lines: Vec<WhyLine>,
}

/// A sentence of an answer.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct WhyLine {
    /// How many effects stand above it, one above the other.
    depth: usize,
    said: String,
    /// A word for the kind of the sentence: `input`, `step`, `transition`, `time` and so on.
    fact: &'static str,
    at_ms: f64,
    /// It holds as well, but did not begin the change.
    aside: bool,
    /// The symbols of which it speaks.
    items: Vec<String>,
}

impl Run {
    /// The record of the run, as text.
    pub(crate) fn record(&self) -> Result<String, Said> {
        let tape = self.past.tape(&self.bench).ok_or_else(|| {
            say!("the beginning of this run is no longer kept, as after a change of its chart: start it again, and ask then")
        })?;
        Ok(tape.to_text())
    }
}

/// Answers a question about a run.
pub(crate) fn why(asked: Asked, language: Language) -> Result<Because, Said> {
    let mut file = File::open_native(&asked.start.file, asked.text)?;
    file.lend(shelf(asked.uses));
    let bench = bench(&file.source, &asked.start)?;
    let tape = Tape::from_text(&asked.tape).map_err(|e| Said::foreign(e.to_string()))?;
    let why = Why::new(&bench.compiled, &tape)
        .map_err(|_| say!("this run is not that of the text, or was changed between two passes of a scan"))?;
    let about = match asked.about.as_deref() {
        None => Question::Scan,
        Some(name) => match of_symbol(&file, &bench, name, asked.instance.as_deref()) {
            Some(question) => question,
            None => question(&bench, name)?,
        },
    };
    let now = match asked.ms {
        Some(ms) => time(ms),
        None => why.span().map_or(Nanos::ZERO, |(_, end)| end),
    };
    let cause = why.ask(about, now).map_err(|e| e.said())?;
    Ok(Because { lines: lines(&cause, file.source.whole(), language) })
}

/// The sentences of an answer, in the order in which they are read.
pub(crate) fn lines(cause: &Cause, document: &Document, language: Language) -> Vec<WhyLine> {
    cause.lines().into_iter().map(|(depth, cause)| line(depth, cause, document, language)).collect()
}

/// The question about a symbol of the drawing, by its id.
fn of_symbol(file: &File, bench: &Bench, id: &str, instance: Option<&str>) -> Option<Question> {
    let places = Places::new(&file.source, bench);
    let is_it = |part: &Part| part.id == id && (instance.is_none() || part.instance.as_deref() == instance);
    if let Some(step) = places.steps().iter().position(is_it).and_then(|at| bench.steps.get(at)) {
        return Some(match step.id {
            Activity::Step(step) => Question::Step(step),
            Activity::Macro(group) => Question::Group(group),
        });
    }
    let number = places.transitions().iter().position(is_it)? as u32;
    let ranks = 0..bench.compiled.symbols.transitions();
    ranks.into_iter().find(|rank| places.transition(*rank) == Some(number)).map(Question::Transition)
}

fn line(depth: usize, cause: &Cause, document: &Document, language: Language) -> WhyLine {
    let mut items: Vec<String> = Vec::new();
    for at in &cause.places {
        if let Some(id) = ids::at(document, *at).map(ids::Thing::id).filter(|id| !items.contains(id)) {
            items.push(id);
        }
    }
    WhyLine {
        depth,
        said: cause.said.in_language(language),
        fact: cause.fact.word(),
        at_ms: cause.now.as_millis(),
        aside: cause.aside,
        items,
    }
}
