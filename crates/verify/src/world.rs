//! The state of the charts and of their plant, as one.
//!
//! An image of both is that of the charts, then that of the plant. Where a plant draws random
//! numbers, its generator begins each tick in one of [`WAYS`] ways: the search tries each of them, and
//! the generator is no part of an image. The first draw of a tick is in another eighth of its range
//! in each way.

use g7_engine::number::{RANDOM_STEP, random};
use g7_engine::{Addr, Fault, Op, Program, State, eval, scan};
use g7_rig::PlantSide;

use crate::model::Model;
use crate::question::Query;
use crate::slice::Slice;

/// Number of ways in which the search lets a plant with random numbers tick.
pub(crate) const WAYS: u8 = 8;

/// The state of the plant.
#[derive(Clone)]
struct Beside<'a> {
    side: &'a PlantSide,
    state: State,
    inputs: Vec<u64>,
    /// The word of the generator.
    chance: Option<Addr>,
    /// The word with which it begins a tick, for each way.
    begins: Vec<u64>,
    /// The last tick drew a number.
    drew: bool,
}

/// Restores a state from an image of the same program.
pub(crate) fn put(p: &Program, state: &mut State, image: &[u64]) {
    let done = state.restore(p, image);
    debug_assert!(done.is_ok(), "{done:?}");
}

/// The state of the charts and of their plant.
#[derive(Clone)]
pub(crate) struct World<'a> {
    p: &'a Program,
    /// The charts.
    pub(crate) charts: State,
    /// The charts of the image that [`World::put`] was given last.
    base: State,
    plant: Option<Beside<'a>>,
    /// The part that is left out of an image.
    slice: Slice,
}

impl<'a> World<'a> {
    /// The state before the first scan.
    pub(crate) fn new(model: &Model<'a>) -> World<'a> {
        let p: &Program = &model.compiled.program;
        let plant = model.plant.map(|side| {
            let program = &side.compiled.program;
            let rows = program.tables().inputs;
            let state = State::new(program);
            let inputs = (rows.start..rows.end).map(|a| state.word(Addr(a))).collect();
            let chance = chance(side);
            let begins = chance.map_or(Vec::new(), |_| (0..WAYS).map(begin_of).collect());
            Beside { side, state, inputs, chance, begins, drew: false }
        });
        World { p, charts: State::new(p), base: State::new(p), plant, slice: model.slice.clone() }
    }

    /// These charts, with the plant before its first tick.
    #[cfg(test)]
    pub(crate) fn of(model: &Model<'a>, charts: State) -> World<'a> {
        World { charts, ..World::new(model) }
    }

    /// The ways in which the plant may tick.
    pub(crate) fn ways(&self) -> std::ops::Range<u8> {
        0..if self.has_chance() { WAYS } else { 1 }
    }

    /// True if the plant draws random numbers.
    pub(crate) fn has_chance(&self) -> bool {
        self.plant.as_ref().is_some_and(|p| p.chance.is_some())
    }

    /// True if the last tick drew a random number. One that did not is the same in each way.
    pub(crate) fn drew(&self) -> bool {
        self.plant.as_ref().is_some_and(|p| p.drew)
    }

    /// Makes an image of it. Equal images have equal futures.
    pub(crate) fn image(&self, image: &mut Vec<u64>) {
        self.charts.canonical(self.p, image);
        self.slice.apply(image);
        if let Some(plant) = &self.plant {
            let mut own = Vec::new();
            plant.state.canonical(&plant.side.compiled.program, &mut own);
            image.extend_from_slice(&own);
        }
    }

    /// Becomes the state of an image that [`World::image`] has made.
    pub(crate) fn put(&mut self, image: &[u64]) {
        let width = self.base.image().len();
        put(self.p, &mut self.base, image.get(..width).unwrap_or(&[]));
        self.back();
        if let Some(plant) = &mut self.plant {
            put(&plant.side.compiled.program, &mut plant.state, image.get(width..).unwrap_or(&[]));
        }
    }

    /// The charts of the image that [`World::put`] was given last.
    pub(crate) fn base(&self) -> &State {
        &self.base
    }

    /// Makes the charts again those of the image that [`World::put`] was given last.
    pub(crate) fn back(&mut self) {
        self.charts.become_as(&self.base);
    }

    /// Makes the charts those of the image that [`World::put`] of another world was given last.
    pub(crate) fn back_to(&mut self, other: &World<'_>) {
        self.charts.become_as(&other.base);
    }

    /// Lets the plant tick, and puts the inputs that it drives into `inputs`.
    ///
    /// # Errors
    ///
    /// A fault of the plant.
    pub(crate) fn tick(&mut self, wait: i64, way: u8, inputs: &mut [u64]) -> Result<(), Fault> {
        let Some(plant) = &mut self.plant else { return Ok(()) };
        let program = &plant.side.compiled.program;
        let outputs = self.p.tables().outputs.start;
        for (from, to) in &plant.side.coupling.to_plant {
            if let Some(word) = plant.inputs.get_mut(*to as usize) {
                *word = self.charts.word(Addr(outputs.saturating_add(*from)));
            }
        }
        let begin = plant.begins.get(usize::from(way)).copied().unwrap_or(0);
        if let Some(addr) = plant.chance {
            plant.state.set_word(program, addr, begin);
        }
        let now = plant.state.now().saturating_add(wait);
        let done = scan(program, &mut plant.state, &plant.inputs, now);
        if let Some(addr) = plant.chance {
            plant.drew = plant.state.word(addr) != begin;
            plant.state.set_word(program, addr, 0);
        }
        done?;
        let driven = program.tables().outputs.start;
        for (from, to) in &plant.side.coupling.to_charts {
            if let Some(word) = inputs.get_mut(*to as usize) {
                *word = plant.state.word(Addr(driven.saturating_add(*from)));
            }
        }
        Ok(())
    }

    /// The value of a condition.
    ///
    /// # Errors
    ///
    /// A fault in its evaluation.
    pub(crate) fn holds(&mut self, model: &Model<'_>, q: Query) -> Result<bool, Fault> {
        for part in model.conditions.get(q.0 as usize).into_iter().flatten() {
            let value = match &mut self.plant {
                Some(plant) if part.of_plant => {
                    eval(&plant.side.compiled.program, &mut plant.state, part.code)?
                }
                _ => eval(self.p, &mut self.charts, part.code)?,
            };
            if value == 0 {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// The least word of the generator whose next draw is in the part of its range with this number.
fn begin_of(way: u8) -> u64 {
    let part = |word: u64| f64::from_bits(random(word.wrapping_add(RANDOM_STEP))) * f64::from(WAYS);
    // One word in eight does; the bound is never met.
    (0..10_000).find(|word| part(*word) as u8 == way).unwrap_or(0)
}

/// The generator's word, if the plant draws from it.
fn chance(side: &PlantSide) -> Option<Addr> {
    side.compiled.program.tables().code.iter().find_map(|op| match op {
        Op::Random(addr) => Some(*addr),
        _ => None,
    })
}
