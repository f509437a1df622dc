//! The messages that the page can send.

use serde::Deserialize;

/// A message of the page.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub(crate) enum Request {
    Open {
        file: String,
        text: String,
    },
    Close {
        file: String,
    },
    /// Chooses the language of the answers: `en`, `fr`, `pt`. A program without the texts in it is given them.
    Speak {
        language: String,
        words: Option<String>,
    },
    Look {
        file: String,
    },
    Text {
        file: String,
    },
    Splice {
        file: String,
        splices: Vec<crate::places::Change>,
        #[serde(default)]
        unit: bool,
    },
    Edit {
        file: String,
        gesture: g7_edit::Gesture,
    },
    Undo {
        file: String,
    },
    Redo {
        file: String,
    },
    /// Copies symbols as text, to be pasted elsewhere.
    Copy {
        file: String,
        ids: Vec<g7_edit::ItemId>,
    },
    /// Merges two changes of one text.
    Merge {
        base: String,
        mine: String,
        theirs: String,
    },
    Format {
        file: String,
    },
    References {
        file: String,
        at: usize,
    },
    Drawing(crate::drawing::Wish),
    /// Lists the forms in which a chart can be exported.
    Forms,
    /// Exports a file in one of them.
    Export {
        file: String,
        to: String,
    },
    /// The logic of a symbol in the languages of controllers.
    Logic {
        file: String,
        id: String,
    },
    /// Converts logic in one of these languages to an expression of the text.
    LogicRead {
        tongue: crate::language::Tongue,
        text: String,
    },
    /// The style sheet of the drawings.
    Style {
        #[serde(default)]
        dark: bool,
    },
    /// Runs the tests whose titles contain `name`, or all.
    Test {
        file: String,
        name: Option<String>,
    },
    /// Answers all questions about the file, as far as the limits go.
    Prove {
        file: String,
        #[serde(flatten)]
        limits: crate::prove::Limits,
    },
    /// The ways on from a refuted claim.
    ProveWays {
        file: String,
        #[serde(flatten)]
        wish: crate::prove::Wish,
    },
    /// Compares two files for every sequence of inputs, as far as the limits go.
    Compare(crate::prove::Both),
    /// The text before the last change.
    Before {
        file: String,
    },
    Tokens {
        file: String,
        #[serde(default)]
        from: usize,
        #[serde(default = "end")]
        to: usize,
    },
    Complete {
        file: String,
        at: usize,
    },
    Hover {
        file: String,
        at: usize,
    },
    Symbols {
        file: String,
    },
    Search {
        file: String,
        text: String,
    },
    RunStart(crate::run::Start),
    RunAdvance {
        run: String,
        ms: f64,
        most_scans: Option<u32>,
        #[serde(default)]
        times: bool,
    },
    RunScan {
        run: String,
        #[serde(default)]
        times: bool,
    },
    RunPass {
        run: String,
        #[serde(default)]
        times: bool,
    },
    RunSet {
        run: String,
        signal: usize,
        value: String,
    },
    RunToggle {
        run: String,
        signal: usize,
    },
    RunForce {
        run: String,
        signal: usize,
        value: String,
    },
    /// Releases one signal, or all if none is named.
    RunRelease {
        run: String,
        signal: Option<usize>,
    },
    RunRestart {
        run: String,
        #[serde(default)]
        warm: bool,
    },
    RunSeek {
        run: String,
        ms: f64,
    },
    RunLive {
        run: String,
        #[serde(default)]
        here: bool,
    },
    RunBreaks {
        run: String,
        ids: Vec<String>,
    },
    RunSwap {
        run: String,
        file: String,
        #[serde(default)]
        force: bool,
    },
    RunStop {
        run: String,
    },
    RunFrame {
        run: String,
        #[serde(default)]
        full: bool,
        #[serde(default)]
        times: bool,
    },
    /// Asks again for the description of a run that its start returned.
    RunSignals {
        run: String,
    },
    RunLanes {
        run: String,
        signals: Vec<usize>,
        from_ms: f64,
        to_ms: f64,
        #[serde(default = "lane")]
        most: usize,
    },
    RunExport {
        run: String,
        #[serde(default)]
        signals: Vec<usize>,
        r#as: crate::run::Form,
        from_ms: Option<f64>,
        to_ms: Option<f64>,
    },
}

/// The default end of a range: the end of the text.
fn end() -> usize {
    usize::MAX
}

/// The default number of edges in a lane: more than the columns of a screen.
fn lane() -> usize {
    4_000
}
