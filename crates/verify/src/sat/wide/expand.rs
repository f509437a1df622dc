//! All moves of many states: for each state the combinations of inputs that matter, for each combination
//! the state behind the scan.
//!
//! ```text
//! states -> cubes (some inputs have values, the others are open) -> split until few inputs matter
//!        -> lanes (all inputs have values) -> next states, and the signals that are 1
//! ```
//!
//! A cube is evaluated with its open inputs as "0 or 1". An input that no open result depends on makes no
//! difference in it: with the values of the inputs that matter, all others are left at 0, and the next
//! state, the constraints and the signals that are asked for are those of all other values too. A cube in
//! which a constraint is 0 whatever the open inputs are is left out. A cube in which few inputs matter
//! becomes all combinations of them; one with more is split at the last of them: the bits of a number come
//! lowest first, and a comparison is decided by the highest ones.
//!
//! All is evaluated by the first stage of the program first. Where its guard is 1, a later stage has the values;
//! the cube or the scan waits until there are as many as lanes. Where the guard is open, the cube is split at an
//! input that this stage reads: later passes read other inputs, but only where the earlier ones lead there.

use super::lanes::{LANES, NONE, bit, both, first, gather, lanes_of, spread};
use super::program::{Open, Plain, Program};
use super::wanted::Tries;

/// Most splits for one state; one that needs more has too many combinations.
const MOST: u32 = 1 << 12;

/// The states to which the moves of some states lead.
#[derive(Default)]
pub(super) struct Moves {
    /// The next states that differ from the state before, one behind the other.
    pub(super) rows: Vec<u64>,
    /// For each of them: the place of the state before in the list that was expanded.
    pub(super) from: Vec<u32>,
    /// Scans made.
    pub(super) scans: usize,
    /// For each signal that is asked for: the place of the first state that shows it, and the inputs.
    pub(super) shown: Vec<Option<(u32, Vec<u64>)>>,
    /// Some state has no inputs that satisfy the constraints.
    pub(super) is_stuck: bool,
    /// Some state has too many combinations.
    pub(super) many: bool,
}

impl Moves {
    /// No moves, with the room of those that were there.
    pub(super) fn clear(&mut self) {
        self.rows.clear();
        self.from.clear();
        (self.scans, self.is_stuck, self.many) = (0, false, false);
        self.shown.clear();
    }
}

/// Cubes of inputs, each for a state.
#[derive(Default)]
struct Cubes {
    state: Vec<u32>,
    /// For each cube a word for each 64 inputs: 1 where an input has a value.
    known: Vec<u64>,
    /// The values.
    value: Vec<u64>,
    /// 1 where an input matters. Empty while it is not known.
    needs: Vec<u64>,
}

/// One of them.
#[derive(Clone, Copy)]
struct Cube<'c> {
    state: u32,
    known: &'c [u64],
    value: &'c [u64],
}

/// A state that is looked for behind another one, and the inputs of the scan that leads to it.
struct Target {
    row: Vec<u64>,
    inputs: Option<Vec<u64>>,
}

/// Scans that wait for a stage.
#[derive(Default)]
struct Scans {
    /// The state of each lane, by its place.
    state: Vec<u32>,
    /// Word by word, a list of all lanes: the states, and the inputs.
    rows: Vec<Vec<u64>>,
    inputs: Vec<Vec<u64>>,
}

/// Expands states. It keeps its room from one call to the next.
pub(super) struct Expander<'p> {
    stages: &'p [Program],
    tries: Tries,
    /// As in [`super::wanted::Wanted`].
    together: usize,
    /// Words of a state, and of the inputs.
    width: usize,
    words: usize,
    plain: Plain,
    open: Open,
    /// For each stage, the last of which is the whole program.
    waiting: Vec<Cubes>,
    scans: Vec<Scans>,
    ready: Cubes,
    /// The next states, word by word.
    next: Vec<Vec<u64>>,
    /// Inputs: room for the work.
    now: Vec<u64>,
    /// For each state: some inputs satisfy the constraints.
    fed: Vec<bool>,
    /// For each state: how often one of its cubes was split so far.
    splits: Vec<u32>,
    target: Option<Target>,
}

impl<'p> Expander<'p> {
    pub(super) fn new(stages: &'p [Program], width: usize, tries: Tries, together: usize) -> Expander<'p> {
        let words = stages.first().map_or(0, |p| p.inputs.len()) / 64 + 1;
        let scans =
            || Scans { state: Vec::new(), rows: vec![Vec::new(); width], inputs: vec![Vec::new(); words] };
        Expander {
            stages,
            tries,
            together,
            width,
            words,
            plain: Plain::default(),
            open: Open::default(),
            waiting: stages.iter().map(|_| Cubes::default()).collect(),
            scans: stages.iter().map(|_| scans()).collect(),
            ready: Cubes::default(),
            next: vec![vec![0; LANES]; width],
            now: Vec::new(),
            fed: Vec::new(),
            splits: Vec::new(),
            target: None,
        }
    }

    /// Appends all moves of these states, which stand one behind the other.
    pub(super) fn expand(&mut self, states: &[u64], moves: &mut Moves) {
        let count = states.len() / self.width;
        let asked = self.stages.first().map_or(0, |p| p.asked.len());
        moves.shown.resize(asked, None);
        self.fed.clear();
        self.fed.resize(count, false);
        self.splits.clear();
        self.splits.resize(count, 0);
        self.split_all(states, moves);
        for stage in 0..self.stages.len() {
            self.flush(stage, moves);
        }
        moves.is_stuck |= self.fed.contains(&false);
    }

    /// The inputs with which one state leads to another.
    pub(super) fn between(&mut self, from: &[u64], to: &[u64]) -> Option<Vec<u64>> {
        self.target = Some(Target { row: to.to_vec(), inputs: None });
        self.expand(from, &mut Moves::default());
        self.target.take()?.inputs
    }

    /// All combinations that matter.
    fn split_all(&mut self, states: &[u64], moves: &mut Moves) {
        let none = vec![0; self.words];
        if let Some(waiting) = self.waiting.first_mut() {
            for state in (0..(states.len() / self.width) as u32).rev() {
                waiting.push(Cube { state, known: &none, value: &none });
            }
        }
        // A later stage waits until the earlier ones have nothing more for it, or much.
        while let Some(stage) = self.next_stage() {
            self.judge(stage, states, moves);
            self.try_all(states, moves);
        }
    }

    /// The last stage with a block of cubes, or else the first with any.
    fn next_stage(&self) -> Option<usize> {
        let full = self.waiting.iter().rposition(|w| w.state.len() >= LANES);
        full.or_else(|| self.waiting.iter().position(|w| !w.state.is_empty()))
    }

    /// Looks at the last cubes that wait for a stage, as many as there are lanes: those with few inputs that
    /// matter are ready, the others are split and wait on.
    fn judge(&mut self, stage: usize, states: &[u64], moves: &mut Moves) {
        let (words, width) = (self.words, self.width);
        let (Some(p), Some(waiting)) = (self.stages.get(stage), self.waiting.get_mut(stage)) else { return };
        let cubes = waiting.last(words);
        let count = cubes.state.len();
        let column =
            |of: &[u64], w: usize| -> Vec<u64> { of.iter().skip(w).step_by(words).copied().collect() };
        p.evaluate_open(&mut self.open, |latches, inputs| {
            for (w, latches) in latches.chunks_mut(64).enumerate() {
                let of = |s: &u32| states.get(*s as usize * width + w).copied().unwrap_or(0);
                let packed: Vec<u64> = cubes.state.iter().map(of).collect();
                spread(&packed, latches);
            }
            for (w, inputs) in inputs.chunks_mut(64).enumerate() {
                let (mut has, mut is) = ([NONE; 64], [NONE; 64]);
                spread(&column(&cubes.known, w), &mut has);
                spread(&column(&cubes.value, w), &mut is);
                for (slot, (has, is)) in inputs.iter_mut().zip(has.iter().zip(&is)) {
                    *slot = [both(*has, *is, |h, v| !h | v), both(*has, *is, |h, v| !h | !v)];
                }
            }
        });
        p.trace(&mut self.open);
        let mut none = NONE;
        for c in &p.constraints {
            none = both(none, self.open.is_zero(*c), |a, b| a | b);
        }
        let (sure, later) = (self.open.is_zero(p.guard), self.open.is_zero(p.guard ^ 1));
        let mut needs = vec![0; words * count];
        for w in 0..words {
            let mut packed = vec![0; count];
            let here = p.inputs.len().saturating_sub(64 * w).min(64);
            gather(&mut packed, here, |j| self.open.needs(64 * w + j));
            needs.iter_mut().skip(w).step_by(words).zip(packed).for_each(|(to, from)| *to = from);
        }
        let is_bound = p.is_bound;
        let each = cubes.known.chunks_exact(words).zip(cubes.value.chunks_exact(words));
        let each = cubes.state.iter().zip(each).zip(needs.chunks_exact(words)).enumerate();
        for (k, ((state, (known, value)), needs)) in each {
            let cube = Cube { state: *state, known, value };
            if bit(&later, k) {
                self.waiting.get_mut(stage + 1).into_iter().for_each(|w| w.push(cube));
            } else if !(bit(&none, k) && (is_bound || bit(&sure, k))) {
                self.settle(stage, cube, needs, bit(&sure, k), states, moves);
            }
        }
    }

    /// A cube of which it is known which inputs matter in it; `sure`: no other ones do.
    fn settle(
        &mut self,
        stage: usize,
        cube: Cube<'_>,
        needs: &[u64],
        sure: bool,
        states: &[u64],
        moves: &mut Moves,
    ) {
        let open: u32 = needs.iter().map(|w| w.count_ones()).sum();
        let few = if self.tries == Tries::One { 0 } else { self.together };
        if sure && open as usize <= few {
            self.ready.push(cube);
            self.ready.needs.extend_from_slice(needs);
        } else if self.tries == Tries::One {
            self.each_alone(stage, cube, needs, states, moves);
        } else if !self.may_split(cube.state) {
            moves.many = true;
            // It has combinations; whether any of them satisfies the constraints is not asked.
            self.feed(cube.state);
        } else if let (Some(place), Some(waiting)) = (highest(needs), self.waiting.get_mut(stage)) {
            for one in [true, false] {
                waiting.push(cube);
                waiting.fix(self.words, place, one);
            }
        }
    }

    /// Each of the inputs that matter alone; then those that matter where all of these are 0.
    fn each_alone(&mut self, stage: usize, cube: Cube<'_>, needs: &[u64], states: &[u64], moves: &mut Moves) {
        let row = row_of(states, cube.state, self.width);
        let mut now = std::mem::take(&mut self.now);
        now.clear();
        now.extend_from_slice(cube.value);
        for place in ones(needs) {
            set(&mut now, place, true);
            self.lane(cube.state, row, &now, moves);
            set(&mut now, place, false);
        }
        self.now = now;
        if let Some(waiting) = self.waiting.get_mut(stage) {
            waiting.push(cube);
            ones(needs).for_each(|place| waiting.fix(self.words, place, false));
        }
    }

    /// Makes lanes of all combinations of the cubes that are ready.
    fn try_all(&mut self, states: &[u64], moves: &mut Moves) {
        let mut ready = std::mem::take(&mut self.ready);
        let each = ready.value.chunks_exact(self.words).zip(ready.needs.chunks_exact(self.words));
        let (mut now, mut places) = (Vec::new(), Vec::new());
        for (state, (value, needs)) in ready.state.iter().zip(each) {
            now.clear();
            now.extend_from_slice(value);
            places.clear();
            places.extend(ones(needs));
            let row = row_of(states, *state, self.width);
            self.lane(*state, row, &now, moves);
            // Each combination differs from the one before in one input.
            for k in 1..1usize << places.len() {
                if let Some(place) = places.get(k.trailing_zeros() as usize) {
                    flip(&mut now, *place);
                }
                self.lane(*state, row, &now, moves);
            }
        }
        ready.clear();
        self.ready = ready;
    }

    /// Takes up one scan; makes all of them once the lanes are full.
    fn lane(&mut self, state: u32, row: &[u64], inputs: &[u64], moves: &mut Moves) {
        moves.scans += 1;
        let Some(scans) = self.scans.first_mut() else { return };
        scans.push(state, row, inputs);
        if scans.state.len() == LANES {
            self.flush(0, moves);
        }
    }

    /// Makes all scans that wait for a stage.
    fn flush(&mut self, stage: usize, moves: &mut Moves) {
        let (Some(p), Some(slot)) = (self.stages.get(stage), self.scans.get_mut(stage)) else { return };
        let mut scans = std::mem::take(slot);
        let mut plain = std::mem::take(&mut self.plain);
        let (changed, later) = {
            p.evaluate(&mut plain, |latches, inputs| {
                latches.chunks_mut(64).zip(&scans.rows).for_each(|(bits, packed)| spread(packed, bits));
                inputs.chunks_mut(64).zip(&scans.inputs).for_each(|(bits, packed)| spread(packed, bits));
            });
            let here = first(scans.state.len());
            let later = both(here, plain.get(p.guard), |a, b| a & b);
            let mut valid = both(here, later, |a, b| a & !b);
            for c in &p.constraints {
                valid = both(valid, plain.get(*c), |a, b| a & b);
            }
            for (signal, shown) in p.asked.iter().zip(&mut moves.shown).filter(|(_, s)| s.is_none()) {
                let seen = both(valid, plain.get(*signal), |a, b| a & b);
                *shown = lanes_of(&seen).next().map(|lane| (scans.state_of(lane), scans.inputs_of(lane)));
            }
            lanes_of(&valid).for_each(|lane| self.feed(scans.state_of(lane)));
            let changed = match self.target {
                Some(_) => valid,
                None => both(valid, plain.moved(p), |a, b| a & b),
            };
            (changed, later)
        };
        if lanes_of(&changed).next().is_some() {
            for (w, packed) in self.next.iter_mut().enumerate() {
                let here = p.next.get(64 * w..).unwrap_or(&[]);
                gather(packed, here.len().min(64), |j| here.get(j).map_or(NONE, |code| plain.get(*code)));
            }
        }
        for lane in lanes_of(&changed) {
            if let Some(target) = self.target.as_mut().filter(|w| w.inputs.is_none())
                && self.next.iter().filter_map(|w| w.get(lane)).eq(&target.row)
            {
                target.inputs = Some(scans.inputs_of(lane));
            }
            moves.rows.extend(self.next.iter().filter_map(|w| w.get(lane)));
            moves.from.push(scans.state_of(lane));
        }
        self.plain = plain;
        for lane in lanes_of(&later) {
            self.wait(stage + 1, &scans, lane, moves);
        }
        scans.clear();
        self.scans.get_mut(stage).into_iter().for_each(|s| *s = std::mem::take(&mut scans));
    }

    /// Hands a scan to a later stage.
    fn wait(&mut self, stage: usize, scans: &Scans, lane: usize, moves: &mut Moves) {
        let Some(later) = self.scans.get_mut(stage) else { return };
        later.state.push(scans.state_of(lane));
        for (to, from) in later.rows.iter_mut().zip(&scans.rows) {
            to.extend(from.get(lane));
        }
        for (to, from) in later.inputs.iter_mut().zip(&scans.inputs) {
            to.extend(from.get(lane));
        }
        if later.state.len() == LANES {
            self.flush(stage, moves);
        }
    }

    /// Counts a split of a state; false if it has had too many.
    fn may_split(&mut self, state: u32) -> bool {
        self.splits.get_mut(state as usize).is_some_and(|n| {
            *n += 1;
            *n <= MOST
        })
    }

    fn feed(&mut self, state: u32) {
        if let Some(fed) = self.fed.get_mut(state as usize) {
            *fed = true;
        }
    }
}

impl Scans {
    fn push(&mut self, state: u32, row: &[u64], inputs: &[u64]) {
        self.state.push(state);
        self.rows.iter_mut().zip(row).for_each(|(to, word)| to.push(*word));
        self.inputs.iter_mut().zip(inputs).for_each(|(to, word)| to.push(*word));
    }

    fn state_of(&self, lane: usize) -> u32 {
        self.state.get(lane).copied().unwrap_or(0)
    }

    fn inputs_of(&self, lane: usize) -> Vec<u64> {
        self.inputs.iter().filter_map(|w| w.get(lane)).copied().collect()
    }

    fn clear(&mut self) {
        self.state.clear();
        self.rows.iter_mut().chain(&mut self.inputs).for_each(Vec::clear);
    }
}

impl Cubes {
    fn push(&mut self, cube: Cube<'_>) {
        self.state.push(cube.state);
        self.known.extend_from_slice(cube.known);
        self.value.extend_from_slice(cube.value);
    }

    /// Gives an input of the last cube a value.
    fn fix(&mut self, words: usize, place: usize, value: bool) {
        let start = self.value.len().saturating_sub(words);
        self.known.get_mut(start..).into_iter().for_each(|w| set(w, place, true));
        self.value.get_mut(start..).into_iter().for_each(|w| set(w, place, value));
    }

    /// Takes the last cubes, as many as there are lanes.
    fn last(&mut self, words: usize) -> Cubes {
        let start = self.state.len().saturating_sub(LANES);
        Cubes {
            state: self.state.split_off(start),
            known: self.known.split_off(start * words),
            value: self.value.split_off(start * words),
            needs: Vec::new(),
        }
    }

    fn clear(&mut self) {
        self.state.clear();
        self.known.clear();
        self.value.clear();
        self.needs.clear();
    }
}

/// A state by its place in the list.
fn row_of(states: &[u64], state: u32, width: usize) -> &[u64] {
    states.get(state as usize * width..(state as usize + 1) * width).unwrap_or(&[])
}

fn set(words: &mut [u64], place: usize, value: bool) {
    if let Some(w) = words.get_mut(place / 64) {
        *w = *w & !(1 << (place % 64)) | u64::from(value) << (place % 64);
    }
}

fn flip(words: &mut [u64], place: usize) {
    if let Some(w) = words.get_mut(place / 64) {
        *w ^= 1 << (place % 64);
    }
}

/// The places of the bits that are 1, ascending.
fn ones(words: &[u64]) -> impl Iterator<Item = usize> {
    words.iter().enumerate().flat_map(|(k, w)| {
        let mut left = *w;
        std::iter::from_fn(move || {
            let bit = (left != 0).then(|| left.trailing_zeros() as usize)?;
            left &= left - 1;
            Some(64 * k + bit)
        })
    })
}

/// The highest place with a 1.
fn highest(words: &[u64]) -> Option<usize> {
    let (k, w) = words.iter().enumerate().rfind(|(_, w)| **w != 0)?;
    Some(64 * k + 63 - w.leading_zeros() as usize)
}
