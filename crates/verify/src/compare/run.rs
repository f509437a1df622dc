//! Differences between the ends of two scans, and runs of both charts repeated by the engine.

use g7_engine::{FaultKind, State, StepId, scan};

use super::equality::{Difference, Equality};
use super::sides::Sides;
use crate::explore::Move;
use crate::look::allowed;
use crate::world::World;

/// The end of a scan of both charts.
pub(super) enum End {
    /// Both go on, or end, in the same way.
    Alike {
        /// No fault stops them.
        goes_on: bool,
    },
    /// They differ.
    Apart(Difference),
}

/// The fault as it is compared: all searches for stability that do not end are one.
pub(super) fn class(fault: FaultKind) -> &'static str {
    match fault {
        FaultKind::Unstable { .. } | FaultKind::Bound => "endless",
        FaultKind::Work => "work",
        other => other.word(),
    }
}

impl Sides<'_> {
    /// Scans both charts, and compares what they show.
    pub(super) fn step(&self, states: [&mut State; 2], vector: &[u64], wait: i64) -> End {
        let ([pa, pb], [a, b]) = (self.programs(), states);
        let now = a.now().max(b.now()).saturating_add(wait);
        let done = [
            scan(pa, a, &self.of_side(0, vector), now).map_err(|f| class(f.kind)).err(),
            scan(pb, b, &self.of_side(1, vector), now).map_err(|f| class(f.kind)).err(),
        ];
        match done {
            [None, None] => match self.difference(a, b) {
                Some(what) => End::Apart(what),
                None => End::Alike { goes_on: true },
            },
            [x, y] if x == y => End::Alike { goes_on: false },
            _ => End::Apart(Difference::Fault),
        }
    }

    /// True if the assumptions of both charts hold for these inputs. The states are used up.
    pub(super) fn allowed(&self, worlds: &mut [World<'_>; 2], vector: &[u64], wait: i64) -> bool {
        let sides = self.models.iter().zip(worlds).enumerate();
        let mut each = sides.filter(|(_, (model, _))| !model.assume.is_empty());
        each.all(|(side, (model, world))| {
            let now = world.charts.now().saturating_add(wait);
            allowed(model, world, &Move { inputs: self.of_side(side, vector), wait }, now)
        })
    }

    fn difference(&self, a: &State, b: &State) -> Option<Difference> {
        let output = self.outputs.iter().find(|o| {
            let [x, y] = o.at;
            a.word(x) != b.word(y)
        });
        if let Some(o) = output {
            return Some(Difference::Output(o.name.clone()));
        }
        let active = |s: &State, step: Option<StepId>| step.is_some_and(|step| s.is_active(step));
        let step = self.steps.iter().find(|(_, [x, y])| active(a, *x) != active(b, *y));
        step.map(|(name, _)| Difference::Step(name.clone()))
    }

    /// Repeats a run of both charts from the start. Gives it up to its first difference; none if it shows no
    /// difference, or breaks an assumption before.
    pub(super) fn apart(&self, vectors: &[Vec<u64>]) -> Option<Equality> {
        let [pa, pb] = self.programs();
        let (mut a, mut b) = (State::new(pa), State::new(pb));
        let assumed = self.models.iter().any(|m| !m.assume.is_empty());
        let mut worlds = [World::new(&self.models[0]), World::new(&self.models[1])];
        for (k, vector) in vectors.iter().enumerate() {
            let wait = if k == 0 { 0 } else { self.period };
            if assumed {
                for (world, state) in worlds.iter_mut().zip([&a, &b]) {
                    world.charts.become_as(state);
                }
                if !self.allowed(&mut worlds, vector, wait) {
                    return None;
                }
            }
            match self.step([&mut a, &mut b], vector, wait) {
                End::Alike { goes_on: true } => {}
                End::Alike { goes_on: false } => return None,
                End::Apart(what) => {
                    let moves = self.moves(vectors.get(..=k)?);
                    return Some(Equality::Apart { moves, what });
                }
            }
        }
        None
    }
}
