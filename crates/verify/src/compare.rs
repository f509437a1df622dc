//! Two charts, or one under two profiles, beside each other: equal for every sequence of
//! inputs, or a shortest sequence that tells them apart.
//!
//! Inputs and outputs belong together by name and type. Both charts are scanned at the same
//! instants with the same inputs; outputs (and situations, if wanted) are compared at the
//! end of each scan, and whether a fault stops it.

use g7_compile::Compiled;
use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_engine::{Addr, Program, State, StepId, scan};
use g7_model::Type;

use crate::asked::Asking;
use crate::explore::Move;
use crate::layer::Budget;
use crate::store::Store;
use crate::values::{Values, values};
use crate::verdict::Open;

/// Most combinations of inputs that are tried in one state.
const MOST: usize = 1 << 16;

/// The charts and signals that are compared.
pub struct Compare<'c> {
    /// The two charts.
    pub charts: [&'c Compiled; 2],
    /// Situations are compared too, by the names of the steps.
    pub situations: bool,
}

/// The difference that the last scan of a run shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Difference {
    /// An output has two values.
    Output(String),
    /// A step is active in one chart alone.
    Step(String),
    /// A fault stops one chart alone, or two faults differ.
    Fault,
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Equality {
    /// Equal for every sequence of inputs: numbers of pairs of states and of scans.
    Equal {
        /// Pairs of states.
        states: usize,
        /// Scans of both.
        scans: usize,
    },
    /// A shortest run that tells them apart: for each chart the moves with its own inputs.
    Apart {
        /// The moves of each chart.
        moves: [Vec<Move>; 2],
        /// The first difference in the last scan.
        what: Difference,
    },
    /// Not decided.
    Open(Open),
    /// They cannot be compared: a sentence.
    Unlike(String),
}

/// A pair of words of the same meaning.
struct Pair {
    name: String,
    at: [Addr; 2],
}

/// An input of one or both charts: its place in each, and its values.
struct Input {
    places: [Option<usize>; 2],
    values: Values,
}

/// Compares two charts.
pub fn compare(what: &Compare<'_>, budget: &Budget<'_>) -> Equality {
    match Sides::new(what) {
        Ok(sides) => sides.search(budget),
        Err(sentence) => Equality::Unlike(sentence),
    }
}

struct Sides<'c> {
    charts: [&'c Compiled; 2],
    inputs: Vec<Input>,
    outputs: Vec<Pair>,
    steps: Vec<(String, [Option<StepId>; 2])>,
    asking: [Asking; 2],
    period: i64,
}

fn of_class(c: &Compiled, class: VarClass) -> impl Iterator<Item = &Variable> {
    c.symbols.variables.iter().filter(move |v| v.class == class)
}

impl<'c> Sides<'c> {
    fn new(what: &Compare<'c>) -> Result<Sides<'c>, String> {
        let [a, b] = what.charts;
        let period = a.symbols.cycle.count().max(1);
        if period != b.symbols.cycle.count().max(1) {
            return Err("they are scanned at different periods: write the same `scan` in both".to_owned());
        }
        let asking = [a, b].map(|c| Asking::new(&c.program, std::iter::empty()));
        let mut inputs: Vec<(String, Input)> = Vec::new();
        for (side, c) in [a, b].into_iter().enumerate() {
            let list = values(c);
            let first = c.program.tables().inputs.start;
            for v in of_class(c, VarClass::Input) {
                for k in 0..v.words() {
                    let place = (v.addr.0 + k - first) as usize;
                    let key = format!("{}#{k}", v.name);
                    let mine = list.get(place).cloned().unwrap_or_default();
                    match inputs.iter_mut().find(|(n, _)| *n == key) {
                        Some((_, input)) => {
                            same_type(a, b, v)?;
                            let new: Vec<u64> =
                                mine.tried.into_iter().filter(|v| !input.values.tried.contains(v)).collect();
                            input.values.tried.extend(new);
                            input.values.whole &= mine.whole;
                            if let Some(p) = input.places.get_mut(side) {
                                *p = Some(place);
                            }
                        }
                        None => {
                            let mut places = [None; 2];
                            if let Some(p) = places.get_mut(side) {
                                *p = Some(place);
                            }
                            inputs.push((key, Input { places, values: mine }));
                        }
                    }
                }
            }
        }
        let mut outputs = Vec::new();
        for v in of_class(a, VarClass::Output) {
            same_type(a, b, v)?;
            let other = of_class(b, VarClass::Output).find(|o| o.name == v.name);
            let other = other.ok_or_else(|| only(&v.name, "first"))?;
            let pair =
                |k| Pair { name: v.name.to_string(), at: [Addr(v.addr.0 + k), Addr(other.addr.0 + k)] };
            outputs.extend((0..v.words()).map(pair));
        }
        let gone = of_class(b, VarClass::Output).find(|v| !outputs.iter().any(|o| *o.name == *v.name));
        if let Some(v) = gone {
            return Err(only(&v.name, "second"));
        }
        let steps = if what.situations { steps(a, b) } else { Vec::new() };
        let inputs = inputs.into_iter().map(|(_, i)| i).collect();
        Ok(Sides { charts: [a, b], inputs, outputs, steps, asking, period })
    }

    fn programs(&self) -> [&'c Program; 2] {
        self.charts.map(|c| &*c.program)
    }

    /// The inputs of one chart among those of both.
    fn of_side(&self, side: usize, all: &[u64]) -> Vec<u64> {
        let count = self.asking.get(side).map_or(0, Asking::count);
        let mut own = vec![0; count];
        for (input, value) in self.inputs.iter().zip(all) {
            let place = input.places.get(side).copied().flatten();
            if let Some(word) = place.and_then(|p| own.get_mut(p)) {
                *word = *value;
            }
        }
        own
    }

    fn search(&self, budget: &Budget<'_>) -> Equality {
        let [pa, pb] = self.programs();
        let (mut a, mut b) = (State::new(pa), State::new(pb));
        let (mut image, mut second) = (Vec::new(), Vec::new());
        a.canonical(pa, &mut image);
        let width = image.len();
        b.canonical(pb, &mut second);
        image.extend_from_slice(&second);
        let mut store = Store::new();
        store.insert(&image);
        let count = self.inputs.len();
        let mut parents = vec![0u32];
        let mut inputs: Vec<u64> =
            self.inputs.iter().map(|i| i.values.tried.first().copied().unwrap_or(0)).collect();
        let (mut at, mut level, mut depth, mut scans) = (0usize, 1usize, 0usize, 0usize);
        let mut hole = None;
        let open = |depth, states, reason: &str, help: &str| {
            Equality::Open(Open { scans: depth, states, reason: reason.to_owned(), help: help.to_owned() })
        };
        while at < store.len() {
            if at == level {
                depth += 1;
                level = store.len();
            }
            let bytes = store.bytes() + inputs.len() * 8 + parents.len() * 4;
            if store.len() > budget.states || bytes > budget.bytes {
                return open(
                    depth,
                    store.len(),
                    "there are more states than allowed",
                    "allow more with --states or --memory",
                );
            }
            if at.is_multiple_of(64) && (budget.stop)() {
                return open(depth, store.len(), "the search was stopped", "allow more with --time");
            }
            let from = store.image(at);
            let (own, other) = from.split_at(width.min(from.len()));
            put(pa, &mut a, own);
            put(pb, &mut b, other);
            let last = inputs.get(at * count..(at + 1) * count).unwrap_or(&[]).to_vec();
            let (list, whole) = self.vectors([&a, &b], &last);
            if !whole {
                hole = hole.or(Some(depth));
            }
            let wait = if at == 0 { 0 } else { self.period };
            for vector in list {
                put(pa, &mut a, own);
                put(pb, &mut b, other);
                let now = a.now().max(b.now()).saturating_add(wait);
                let done = [
                    scan(pa, &mut a, &self.of_side(0, &vector), now).map_err(|f| f.kind).err(),
                    scan(pb, &mut b, &self.of_side(1, &vector), now).map_err(|f| f.kind).err(),
                ];
                scans += 1;
                let apart = match done {
                    [None, None] => self.difference(&a, &b),
                    [Some(x), Some(y)] if x.word() == y.word() => None,
                    _ => Some(Difference::Fault),
                };
                if let Some(what) = apart {
                    let moves = self.path(at, &parents, &inputs, &vector);
                    return Equality::Apart { moves, what };
                }
                if done != [None, None] {
                    continue;
                }
                a.canonical(pa, &mut image);
                b.canonical(pb, &mut second);
                image.extend_from_slice(&second);
                if store.insert(&image) {
                    parents.push(at as u32);
                    inputs.extend_from_slice(&vector);
                }
            }
            at += 1;
        }
        match hole {
            None => Equality::Equal { states: store.len(), scans },
            Some(depth) => open(
                depth,
                store.len(),
                "some input takes more values, or more inputs matter at once, than are tried",
                "compare inputs with constants only, or give them smaller types",
            ),
        }
    }

    fn vectors(&self, states: [&State; 2], last: &[u64]) -> (Vec<Vec<u64>>, bool) {
        let mut matter = vec![false; self.inputs.len()];
        for (side, (asking, state)) in self.asking.iter().zip(states).enumerate() {
            let places: Vec<usize> = asking.matter(&asking.asked(state)).iter().collect();
            for (input, m) in self.inputs.iter().zip(&mut matter) {
                *m |= input.places.get(side).copied().flatten().is_some_and(|p| places.contains(&p));
            }
        }
        let mine = || self.inputs.iter().enumerate().zip(&matter).filter(|(_, m)| **m).map(|(i, _)| i);
        let count = mine().fold(1usize, |n, (_, i)| n.saturating_mul(i.values.tried.len().max(1)));
        let whole = count <= MOST && mine().all(|(_, i)| i.values.whole);
        let mut list = vec![last.to_vec()];
        for (place, input) in mine() {
            let set = |old: &Vec<u64>, v: u64| {
                let mut new = old.clone();
                new.get_mut(place).into_iter().for_each(|w| *w = v);
                new
            };
            if count > MOST {
                let base = last.to_vec();
                list.extend(input.values.tried.iter().map(|v| set(&base, *v)));
            } else {
                list = list
                    .iter()
                    .flat_map(|old| input.values.tried.iter().map(move |v| set(old, *v)))
                    .collect();
            }
        }
        (list, whole)
    }

    fn difference(&self, a: &State, b: &State) -> Option<Difference> {
        let [of_a, of_b] = [a, b];
        let output = self.outputs.iter().find(|o| {
            let [x, y] = o.at;
            of_a.word(x) != of_b.word(y)
        });
        if let Some(o) = output {
            return Some(Difference::Output(o.name.clone()));
        }
        let active = |s: &State, step: Option<StepId>| step.is_some_and(|step| s.is_active(step));
        let step = self.steps.iter().find(|(_, [x, y])| active(of_a, *x) != active(of_b, *y));
        step.map(|(name, _)| Difference::Step(name.clone()))
    }

    fn path(&self, mut at: usize, parents: &[u32], inputs: &[u64], last: &[u64]) -> [Vec<Move>; 2] {
        let count = self.inputs.len();
        let mut vectors = vec![last.to_vec()];
        let mut waits = vec![if at == 0 { 0 } else { self.period }];
        while at > 0 {
            vectors.push(inputs.get(at * count..(at + 1) * count).unwrap_or(&[]).to_vec());
            at = parents.get(at).copied().unwrap_or(0) as usize;
            waits.push(if at == 0 { 0 } else { self.period });
        }
        let moves = |side| {
            let list = vectors.iter().zip(&waits).rev();
            list.map(|(v, wait)| Move { inputs: self.of_side(side, v), wait: *wait }).collect()
        };
        [moves(0), moves(1)]
    }
}

fn only(name: &str, which: &str) -> String {
    format!("the output `{name}` is in the {which} chart only")
}

/// An input or output has one type in both charts.
fn same_type(a: &Compiled, b: &Compiled, v: &Variable) -> Result<(), String> {
    let shape = |c: &Compiled| -> Option<(Type, u32)> {
        of_class(c, v.class).find(|o| o.name == v.name).map(|o| (o.ty, o.elements))
    };
    match (shape(a), shape(b)) {
        (Some(x), Some(y)) if x != y => Err(format!("`{}` has two types", v.name)),
        _ => Ok(()),
    }
}

/// The steps of both charts by name.
fn steps(a: &Compiled, b: &Compiled) -> Vec<(String, [Option<StepId>; 2])> {
    let names = |c: &Compiled| -> Vec<(String, StepId)> {
        let listed = (0..c.symbols.steps()).map(StepId).filter(|s| c.symbols.is_listed(*s));
        listed.map(|s| (c.symbols.step_path(s).to_owned(), s)).collect()
    };
    let (of_a, of_b) = (names(a), names(b));
    let find = |list: &[(String, StepId)], name: &str| list.iter().find(|(n, _)| n == name).map(|(_, s)| *s);
    let mut all: Vec<(String, [Option<StepId>; 2])> =
        of_a.iter().map(|(n, s)| (n.clone(), [Some(*s), find(&of_b, n)])).collect();
    all.extend(
        of_b.iter().filter(|(n, _)| find(&of_a, n).is_none()).map(|(n, s)| (n.clone(), [None, Some(*s)])),
    );
    all
}

/// Makes a state one of the store, which holds images of the program alone.
fn put(p: &Program, state: &mut State, image: &[u64]) {
    let done = state.restore(p, image);
    debug_assert!(done.is_ok(), "{done:?}");
}
