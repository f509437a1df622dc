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

use super::lanes::{LANES, Lanes, NONE, bit, both, first, gather, spread};
use super::program::{Open, Plain, Program};

/// Inputs of which all combinations are tried at once, at most.
pub(super) const TOGETHER: usize = 6;
/// Most splits for one state; one that needs more has too many combinations.
const MOST: u32 = 1 << 12;

/// Which inputs are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tries {
    /// All combinations that matter.
    All,
    /// At most one input is 1.
    One,
}

/// What the moves of some states lead to.
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
    /// The place of the first state in which no inputs satisfy the constraints.
    pub(super) stuck: Option<u32>,
    /// The place of a state with too many combinations.
    pub(super) many: Option<u32>,
}

impl Moves {
    /// No moves, with the room of those that were there.
    pub(super) fn clear(&mut self) {
        self.rows.clear();
        self.from.clear();
        (self.scans, self.stuck, self.many) = (0, None, None);
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

/// A run's target: the inputs that lead from one state to another are looked for.
struct Wanted {
    row: Vec<u64>,
    inputs: Option<Vec<u64>>,
}

/// Expands states. It keeps its room from one call to the next.
pub(super) struct Expander<'p> {
    program: &'p Program,
    tries: Tries,
    /// [`TOGETHER`]; tests try fewer.
    together: usize,
    /// Words of a state, and of the inputs.
    width: usize,
    words: usize,
    plain: Plain,
    open: Open,
    waiting: Cubes,
    ready: Cubes,
    /// Word by word, each of all lanes: the states and the inputs of the next evaluation.
    lanes: Vec<u64>,
    inputs: Vec<u64>,
    /// The state of each lane, by its place.
    from: Vec<u32>,
    /// The next states, word by word.
    next: Vec<u64>,
    /// For each state: some inputs satisfy the constraints.
    fed: Vec<bool>,
    /// For each state: its splits so far.
    splits: Vec<u32>,
    wanted: Option<Wanted>,
}

impl<'p> Expander<'p> {
    pub(super) fn new(program: &'p Program, width: usize, tries: Tries, together: usize) -> Expander<'p> {
        let words = program.inputs.len() / 64 + 1;
        Expander {
            program,
            tries,
            together,
            width,
            words,
            plain: Plain::default(),
            open: Open::default(),
            waiting: Cubes::default(),
            ready: Cubes::default(),
            lanes: vec![0; width * LANES],
            inputs: vec![0; words * LANES],
            from: Vec::new(),
            next: vec![0; width * LANES],
            fed: Vec::new(),
            splits: Vec::new(),
            wanted: None,
        }
    }

    /// Appends all moves of these states, which stand one behind the other.
    pub(super) fn expand(&mut self, states: &[u64], moves: &mut Moves) {
        let count = states.len() / self.width;
        moves.shown.resize(self.program.asked.len(), None);
        self.fed.clear();
        self.fed.resize(count, false);
        self.splits.clear();
        self.splits.resize(count, 0);
        for state in (0..count as u32).rev() {
            self.waiting.state.push(state);
            self.waiting.known.extend(std::iter::repeat_n(0, self.words));
            self.waiting.value.extend(std::iter::repeat_n(0, self.words));
        }
        while !self.waiting.state.is_empty() {
            self.judge(states, moves);
            self.try_all(states, moves);
        }
        self.flush(moves);
        if let Some(k) = self.fed.iter().position(|fed| !fed) {
            moves.stuck = moves.stuck.or(Some(k as u32));
        }
    }

    /// The inputs with which one state leads to another.
    pub(super) fn between(&mut self, from: &[u64], to: &[u64]) -> Option<Vec<u64>> {
        self.wanted = Some(Wanted { row: to.to_vec(), inputs: None });
        self.expand(from, &mut Moves::default());
        self.wanted.take()?.inputs
    }

    /// Looks at the last cubes that wait, as many as there are lanes: those with few inputs that matter are
    /// ready, the others are split and wait on.
    fn judge(&mut self, states: &[u64], moves: &mut Moves) {
        let (words, count) = (self.words, self.waiting.state.len().min(LANES));
        let start = self.waiting.state.len() - count;
        let list: Vec<u32> = self.waiting.state.drain(start..).collect();
        let known: Vec<u64> = self.waiting.known.drain(start * words..).collect();
        let value: Vec<u64> = self.waiting.value.drain(start * words..).collect();
        let column = |of: &[u64], w: usize| -> Vec<u64> { of.iter().skip(w).step_by(words).copied().collect() };
        let (p, width) = (self.program, self.width);
        p.evaluate_open(&mut self.open, |latches, inputs| {
            for (w, latches) in latches.chunks_mut(64).enumerate() {
                let of = |s: &u32| states.get(*s as usize * width + w).copied().unwrap_or(0);
                let packed: Vec<u64> = list.iter().map(of).collect();
                spread(&packed, latches);
            }
            for (w, inputs) in inputs.chunks_mut(64).enumerate() {
                let mut has = [NONE; 64];
                let mut is = [NONE; 64];
                spread(&column(&known, w), &mut has);
                spread(&column(&value, w), &mut is);
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
        let mut needs = vec![0; words * count];
        for w in 0..words {
            let mut packed = vec![0; count];
            let here = p.inputs.len().saturating_sub(64 * w).min(64);
            gather(&mut packed, here, |j| self.open.needs(64 * w + j));
            needs.iter_mut().skip(w).step_by(words).zip(packed).for_each(|(to, from)| *to = from);
        }
        for (k, state) in list.iter().enumerate().filter(|(k, _)| !bit(&none, *k)) {
            let of = |all: &[u64]| -> Vec<u64> { all.get(k * words..(k + 1) * words).unwrap_or(&[]).to_vec() };
            let (known, value, needs) = (of(&known), of(&value), of(&needs));
            let open: u32 = needs.iter().map(|w| w.count_ones()).sum();
            if self.tries == Tries::One || open as usize <= self.together {
                self.ready.push(*state, &known, &value);
                self.ready.needs.extend(needs);
            } else if !self.may_split(*state) {
                moves.many = moves.many.or(Some(*state));
                // It has combinations; whether any of them satisfies the constraints is not asked.
                self.feed(*state);
            } else if let Some(place) = highest(&needs) {
                for one in [true, false] {
                    let (mut known, mut value) = (known.clone(), value.clone());
                    set(&mut known, place, true);
                    set(&mut value, place, one);
                    self.waiting.push(*state, &known, &value);
                }
            }
        }
    }

    /// Makes lanes of all combinations of the cubes that are ready.
    fn try_all(&mut self, states: &[u64], moves: &mut Moves) {
        let ready = std::mem::take(&mut self.ready);
        let each = ready.value.chunks_exact(self.words).zip(ready.needs.chunks_exact(self.words));
        let mut now = Vec::new();
        for (state, (value, needs)) in ready.state.iter().zip(each) {
            now.clear();
            now.extend_from_slice(value);
            let places: Vec<usize> = ones(needs).collect();
            self.lane(states, *state, &now, moves);
            match self.tries {
                Tries::One => {
                    for place in &places {
                        set(&mut now, *place, true);
                        self.lane(states, *state, &now, moves);
                        set(&mut now, *place, false);
                    }
                }
                // Each combination differs from the one before in one input.
                Tries::All => {
                    for k in 1..1usize << places.len() {
                        if let Some(place) = places.get(k.trailing_zeros() as usize) {
                            flip(&mut now, *place);
                        }
                        self.lane(states, *state, &now, moves);
                    }
                }
            }
        }
        self.ready = Cubes {
            state: cleared(ready.state),
            known: cleared(ready.known),
            value: cleared(ready.value),
            needs: cleared(ready.needs),
        };
    }

    /// Takes up one scan; makes all of them once the lanes are full.
    fn lane(&mut self, states: &[u64], state: u32, inputs: &[u64], moves: &mut Moves) {
        let lane = self.from.len();
        let row = states.iter().skip(state as usize * self.width);
        for (to, word) in self.lanes.iter_mut().skip(lane).step_by(LANES).zip(row) {
            *to = *word;
        }
        for (to, word) in self.inputs.iter_mut().skip(lane).step_by(LANES).zip(inputs) {
            *to = *word;
        }
        self.from.push(state);
        if self.from.len() == LANES {
            self.flush(moves);
        }
    }

    /// Makes the scans of all lanes.
    fn flush(&mut self, moves: &mut Moves) {
        let p = self.program;
        p.evaluate(&mut self.plain, |latches, inputs| {
            for (bits, packed) in latches.chunks_mut(64).zip(self.lanes.chunks_exact(LANES)) {
                spread(packed, bits);
            }
            for (bits, packed) in inputs.chunks_mut(64).zip(self.inputs.chunks_exact(LANES)) {
                spread(packed, bits);
            }
        });
        let mut valid = first(self.from.len());
        for c in &p.constraints {
            valid = both(valid, self.plain.get(*c), |a, b| a & b);
        }
        for (signal, shown) in p.asked.iter().zip(&mut moves.shown).filter(|(_, s)| s.is_none()) {
            let here = both(valid, self.plain.get(*signal), |a, b| a & b);
            if let Some(lane) = lowest(&here) {
                let inputs = self.inputs.iter().skip(lane).step_by(LANES).copied().collect();
                *shown = Some((self.from.get(lane).copied().unwrap_or(0), inputs));
            }
        }
        for (w, packed) in self.next.chunks_exact_mut(LANES).enumerate() {
            let here = p.next.get(64 * w..).unwrap_or(&[]);
            gather(packed, here.len().min(64), |j| here.get(j).map_or(NONE, |code| self.plain.get(*code)));
        }
        moves.scans += self.from.len();
        let from = std::mem::take(&mut self.from);
        for (lane, state) in from.iter().enumerate() {
            if !bit(&valid, lane) {
                continue;
            }
            self.feed(*state);
            self.meet(lane);
            let next = || self.next.iter().skip(lane).step_by(LANES);
            if !next().eq(self.lanes.iter().skip(lane).step_by(LANES)) {
                moves.rows.extend(next());
                moves.from.push(*state);
            }
        }
        self.from = cleared(from);
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

    /// Notes the inputs of a lane that leads to the state that is looked for.
    fn meet(&mut self, lane: usize) {
        if let Some(wanted) = self.wanted.as_mut().filter(|w| w.inputs.is_none())
            && self.next.iter().skip(lane).step_by(LANES).eq(&wanted.row)
        {
            wanted.inputs = Some(self.inputs.iter().skip(lane).step_by(LANES).copied().collect());
        }
    }
}

impl Cubes {
    fn push(&mut self, state: u32, known: &[u64], value: &[u64]) {
        self.state.push(state);
        self.known.extend_from_slice(known);
        self.value.extend_from_slice(value);
    }
}

/// The list without its elements, with its room.
fn cleared<T>(mut list: Vec<T>) -> Vec<T> {
    list.clear();
    list
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

/// The first lane with a 1.
fn lowest(lanes: &Lanes) -> Option<usize> {
    let (k, w) = lanes.iter().enumerate().find(|(_, w)| **w != 0)?;
    Some(64 * k + w.trailing_zeros() as usize)
}
