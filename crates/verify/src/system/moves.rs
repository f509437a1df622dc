//! Inputs of the chart as free bits, and bits of a trace as moves.

use g7_engine::Addr;
use g7_equations::{Class, Equations, Memory, MemoryId, What};
use g7_model::Type;

use super::expr::free;
use super::value::{Value, choose, real_bits};
use crate::explore::Move;
use crate::model::Model;
use crate::sat::{Signal, System};

/// Values of an input up to which a choice among them takes the place of its bits.
const CHOICES: usize = 64;

/// The bits that stand for a word of the inputs.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    /// The number of one of these values; beyond the last stands for the last.
    Choice(Vec<usize>, Vec<u64>),
    /// The word itself, bit by bit; the highest is the sign where the flag says so.
    Bits(Vec<usize>, bool),
    /// A constant.
    Fixed(u64),
}

/// The inputs of a chart: for each word of [`g7_engine::Tables::inputs`] its bits.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sources {
    pub(crate) words: Vec<Source>,
    period: i64,
}

impl Sources {
    pub(crate) fn new(model: &Model<'_>) -> Sources {
        let fixed = |v: &crate::values::Values| Source::Fixed(v.tried.first().copied().unwrap_or(0));
        Sources { words: model.inputs.iter().map(fixed).collect(), period: model.period }
    }

    /// Free bits for an input memory.
    pub(crate) fn memory(
        &mut self,
        model: &Model<'_>,
        system: &mut System,
        m: &Memory,
        at: Addr,
    ) -> Vec<Value> {
        let first = at.0.saturating_sub(model.compiled.program.tables().inputs.start) as usize;
        if matches!(m.ty, Type::String(_)) {
            return vec![Value::Text(None)];
        }
        (0..m.elements as usize).map(|k| self.word(model, system, m.ty, first + k)).collect()
    }

    fn word(&mut self, model: &Model<'_>, system: &mut System, ty: Type, place: usize) -> Value {
        let tried = model.inputs.get(place).filter(|v| v.whole && v.tried.len() <= CHOICES);
        let mut bit = |signals: &mut Vec<Signal>| {
            signals.push(system.input());
            system.inputs.len() - 1
        };
        let mut signals = Vec::new();
        let (source, value) = match tried.filter(|_| ty != Type::Bool) {
            Some(values) => {
                let n = values.tried.len().next_power_of_two().trailing_zeros();
                let bits: Vec<usize> = (0..n).map(|_| bit(&mut signals)).collect();
                let mut list: Vec<Value> = values.tried.iter().map(|w| Value::of_word(ty, *w)).collect();
                list.resize(1 << n, list.last().cloned().unwrap_or(Value::zero(ty)));
                for s in &signals {
                    let pairs = list.chunks(2).map(|pair| match pair {
                        [a, b] => choose(&mut system.graph, *s, b, a),
                        [a] => a.clone(),
                        _ => Value::zero(ty),
                    });
                    list = pairs.collect();
                }
                let value = list.into_iter().next().unwrap_or(Value::zero(ty));
                (Source::Choice(bits, values.tried.clone()), value)
            }
            None => {
                let n =
                    if ty.is_real() { real_bits(ty) } else { ty.elementary().map_or(1, |r| r.bits.into()) };
                let bits = (0..n).map(|_| bit(&mut signals)).collect();
                let signed = super::range::bounds(ty).0 < 0 && !ty.is_real();
                let value = free(ty, signals);
                if let Value::Real(bits) = &value {
                    numbers_only(system, bits);
                }
                (Source::Bits(bits, signed), value)
            }
        };
        if let Some(slot) = self.words.get_mut(place) {
            *slot = source;
        }
        value
    }

    /// The moves of a trace: for each scan the values of [`System::inputs`].
    pub(crate) fn moves(&self, trace: &[Vec<bool>]) -> Vec<Move> {
        let one = |(k, bits): (usize, &Vec<bool>)| Move {
            inputs: self.words.iter().map(|s| s.word(bits)).collect(),
            wait: if k == 0 { 0 } else { self.period },
        };
        trace.iter().enumerate().map(one).collect()
    }
}

impl Source {
    /// The places of its bits in [`System::inputs`].
    pub(crate) fn bits(&self) -> &[usize] {
        match self {
            Source::Choice(bits, _) | Source::Bits(bits, _) => bits,
            Source::Fixed(_) => &[],
        }
    }

    fn word(&self, bits: &[bool]) -> u64 {
        let is = |i: &usize| bits.get(*i).copied().unwrap_or(false);
        let number = |list: &[usize]| (0u64..).zip(list).fold(0u64, |v, (k, i)| v | u64::from(is(i)) << k);
        match self {
            Source::Choice(bits, values) => {
                let k = number(bits) as usize;
                values.get(k).or(values.last()).copied().unwrap_or(0)
            }
            Source::Bits(bits, signed) => {
                let word = number(bits);
                let sign = *signed && bits.last().is_some_and(is) && bits.len() < 64;
                if sign { word | u64::MAX << bits.len() } else { word }
            }
            Source::Fixed(word) => *word,
        }
    }
}

/// Inputs of floating point are numbers.
fn numbers_only(system: &mut System, bits: &[Signal]) {
    let fraction = if bits.len() == 32 { 23 } else { 52 };
    let (low, high) = bits.split_at(fraction);
    let high = high.split_last().map_or(&[][..], |(_, exponent)| exponent);
    let (full, rest) = (system.graph.all(high.iter().copied()), system.graph.any(low.iter().copied()));
    let nan = system.graph.and(full, rest);
    system.constraints.push(!nan);
}

/// The input memories of equations, without the time.
pub(crate) fn inputs(e: &Equations) -> Vec<(MemoryId, &Memory, Addr)> {
    let all = (0u32..).map(MemoryId).zip(&e.memories).filter(|(_, m)| m.class == Class::Input);
    all.filter_map(|(id, m)| match m.what {
        What::Variable(at) => Some((id, m, at)),
        _ => None,
    })
    .collect()
}
