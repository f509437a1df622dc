//! The recorded signals: edges for a chronogram, and export to files.

use g7_host::{Recording, write_csv, write_vcd};
use g7_model::Said;
use serde::Serialize;

use super::running::Run;
use super::times::time;
use g7_rig::values::shown;

/// The lanes of a chronogram.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Lanes {
    start_ms: f64,
    end_ms: f64,
    /// For each signal its edges: instant (ms), number, value as text.
    lanes: Vec<Vec<(f64, f64, String)>>,
}

/// The format of a file of signals.
#[derive(Clone, Copy, Debug, serde::Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "SignalsForm"))]
#[serde(rename_all = "snake_case")]
pub(crate) enum Form {
    Csv,
    Vcd,
    Svg,
}

impl Run {
    /// The edges of some signals between two instants, at most about `most` for each signal.
    pub(crate) fn lanes(&self, signals: &[usize], from: f64, to: f64, most: usize) -> Lanes {
        let (from, to) = (time(from), time(to));
        let most = most.clamp(2, 100_000);
        // One lane for each requested signal; an unknown signal has an empty lane.
        let parts = signals.iter().map(|i| self.recording.part(&[*i], from, to));
        Lanes {
            start_ms: self.recording.start().as_millis(),
            end_ms: self.recording.end().as_millis(),
            lanes: parts.map(|part| lane(&part, 0, most)).collect(),
        }
    }

    /// Exports some signals (all if none is named) as a file.
    pub(crate) fn export(
        &self,
        signals: &[usize],
        form: Form,
        from: Option<f64>,
        to: Option<f64>,
    ) -> Result<String, Said> {
        let all: Vec<usize> = (0..self.recording.signals().len()).collect();
        let signals = if signals.is_empty() { &all } else { signals };
        let from = from.map_or(self.recording.start(), time);
        let to = to.map_or(self.recording.end(), time);
        let part = self.recording.part(signals, from, to);
        let mut out = Vec::new();
        let done = match form {
            Form::Csv => write_csv(&part, &mut out),
            Form::Vcd => write_vcd(&part, &mut out),
            Form::Svg => return Ok(picture(&part)),
        };
        done.map_err(|e| Said::foreign(e.to_string()))?;
        String::from_utf8(out).map_err(|e| Said::foreign(e.to_string()))
    }
}

/// Draws the signals as a chronogram.
fn picture(part: &Recording) -> String {
    g7_draw::chronogram_svg(&g7_dossier::chronogram(part), &g7_draw::Options::default())
}

/// The edges of a signal. Of edges that lie too close to be distinguished, only the first and the
/// last are kept.
fn lane(part: &Recording, signal: usize, most: usize) -> Vec<(f64, f64, String)> {
    let Some(kind) = part.signals().get(signal).map(|s| s.kind) else { return Vec::new() };
    let kept = g7_dossier::thinned(part, signal, most);
    kept.into_iter().map(|(at, v)| (at.as_millis(), v.number(kind), shown(&v, kind))).collect()
}
