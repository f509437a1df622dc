//! The recorded signals of a run as lanes that `draw` makes a chronogram of.

use g7_draw::{Chronogram, Edge, Lane, LaneKind};
use g7_host::{Kind, Recording, Signal, Value};
use g7_model::Nanos;
use g7_rig::values::shown;

/// Edges of a lane that can be told apart on a sheet.
const EDGES: usize = 1000;

/// The changes of a signal for a picture that can show `most` of them side by side. Where more than two of them fall on one
/// place of the picture, only the first and the last are kept.
pub fn thinned(part: &Recording, signal: usize, most: usize) -> Vec<(Nanos, Value)> {
    let width = ((part.end() - part.start()) / most as i64).max(Nanos::new(1));
    let crowded = part.count(signal) > most;
    let mut kept: Vec<(Nanos, Value)> = Vec::new();
    for edge in part.changes(signal) {
        let slot = |e: &(Nanos, Value)| e.0.count_of(width);
        let full = kept.iter().rev().take(2).filter(|e| slot(e) == slot(&edge)).count() == 2;
        if crowded && full {
            kept.pop();
        }
        kept.push(edge);
    }
    kept
}

/// All signals of a recording, from its first to its last instant, with all their changes.
pub fn chronogram(of: &Recording) -> Chronogram {
    lanes(of, usize::MAX >> 1)
}

/// The same for a sheet of paper: thinned to what can be told apart there ([`thinned`]).
pub fn on_paper(of: &Recording) -> Chronogram {
    lanes(of, EDGES)
}

fn lanes(of: &Recording, most: usize) -> Chronogram {
    let lane = |(i, signal): (usize, &Signal)| Lane {
        name: signal.name.clone(),
        kind: match signal.kind {
            Kind::Bool if signal.group == "steps" => LaneKind::Step,
            Kind::Bool => LaneKind::Bool,
            Kind::Int { .. } | Kind::Real | Kind::Lreal | Kind::Time | Kind::Moment(_) => LaneKind::Number,
            Kind::Text => LaneKind::Text,
        },
        edges: thinned(of, i, most)
            .into_iter()
            .map(|(at, v)| Edge { at, value: v.number(signal.kind), show: shown(&v, signal.kind) })
            .collect(),
    };
    let lanes = of.signals().iter().enumerate().map(lane).collect();
    Chronogram { lanes, from: of.start(), to: of.end() }
}
