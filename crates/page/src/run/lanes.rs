//! The recorded signals: edges for a chronogram, and export to files.

use g7_host::{Kind, Recording, write_csv, write_vcd};
use g7_model::{Nanos, Said};
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
    let lane = |(i, signal): (usize, &g7_host::Signal)| g7_draw::Lane {
        name: signal.name.clone(),
        kind: match signal.kind {
            Kind::Bool if signal.group == "steps" => g7_draw::LaneKind::Step,
            Kind::Bool => g7_draw::LaneKind::Bool,
            Kind::Int { .. } | Kind::Real | Kind::Lreal | Kind::Time | Kind::Moment(_) => {
                g7_draw::LaneKind::Number
            }
            Kind::Text => g7_draw::LaneKind::Text,
        },
        edges: part
            .changes(i)
            .map(|(at, v)| g7_draw::Edge { at, value: v.number(signal.kind), show: shown(&v, signal.kind) })
            .collect(),
    };
    let lanes = part.signals().iter().enumerate().map(lane).collect();
    let chronogram = g7_draw::Chronogram { lanes, from: part.start(), to: part.end() };
    g7_draw::chronogram_svg(&chronogram, &g7_draw::Options::default())
}

/// The edges of a signal. Of edges that lie too close to be distinguished, only the first and the
/// last are kept.
fn lane(part: &Recording, signal: usize, most: usize) -> Vec<(f64, f64, String)> {
    let Some(kind) = part.signals().get(signal).map(|s| s.kind) else { return Vec::new() };
    let width = ((part.end() - part.start()) / most as i64).max(Nanos::new(1));
    let crowded = part.count(signal) > most;
    let mut kept: Vec<(Nanos, g7_host::Value)> = Vec::new();
    for edge in part.changes(signal) {
        let slot = |e: &(Nanos, g7_host::Value)| e.0.count_of(width);
        let full = kept.iter().rev().take(2).filter(|e| slot(e) == slot(&edge)).count() == 2;
        if crowded && full {
            kept.pop();
        }
        kept.push(edge);
    }
    kept.into_iter().map(|(at, v)| (at.as_millis(), v.number(kind), shown(&v, kind))).collect()
}
