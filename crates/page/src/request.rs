//! What can be asked, as it comes in.

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
    Look {
        file: String,
    },
    Text {
        file: String,
    },
    Splice {
        file: String,
        splices: Vec<Splice>,
        #[serde(default)]
        unit: bool,
    },
    Drawing(crate::drawing::Wish),
    /// The style sheet of the fragments.
    Style {
        #[serde(default)]
        dark: bool,
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
    /// One signal, or all where none is named.
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
    /// What a page is told at the beginning, once more.
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

/// Edges of a lane where nothing is said: more than a screen has columns.
fn lane() -> usize {
    4_000
}

/// A piece of text in place of another; places in code units.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Splice {
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) insert: String,
}
