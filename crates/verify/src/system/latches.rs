//! Memories that last from scan to scan, as latches.

use std::collections::BTreeSet;
use std::rc::Rc;

use g7_equations::{Class, Equations, Memory, MemoryId, Stmt, expand};
use g7_model::Type;

use super::exec::Exec;
use super::range::{Ranges, is_whole, number};
use super::value::{Value, choose, real_bits};
use super::word::{self, Word, width};
use crate::sat::{Init, Signal, System};

/// A memory, or an element of one, in its latches.
struct Kept {
    memory: MemoryId,
    element: usize,
    latches: Vec<Signal>,
    /// Divides all values.
    step: i128,
    /// Values from this one on act alike.
    cap: Option<i128>,
}

/// All memories that last.
pub(crate) struct Latches(Vec<Kept>);

impl Latches {
    /// Makes the latches; gives the values that the memories have as a scan begins.
    pub(crate) fn new(e: &Equations, ranges: &Ranges, system: &mut System) -> (Latches, Vec<Vec<Value>>) {
        let written = written(e);
        let mut kept = Vec::new();
        let mut cells = Vec::new();
        for (id, m) in (0u32..).map(MemoryId).zip(&e.memories) {
            let lasts = matches!(m.class, Class::Kept | Class::Output) && written.contains(&id);
            cells.push(if !lasts {
                first(m)
            } else if matches!(m.ty, Type::String(_)) {
                vec![Value::Text(None)]
            } else {
                let words = m.init.iter().enumerate();
                words.map(|(k, word)| one(id, k, m, *word, ranges, system, &mut kept)).collect()
            });
        }
        (Latches(kept), cells)
    }

    /// The latches of each whole number, the lowest bit first.
    pub(crate) fn words(&self) -> Vec<Vec<Signal>> {
        self.0.iter().filter(|k| k.latches.len() > 1).map(|k| k.latches.clone()).collect()
    }

    /// Sets what the latches take over to the next scan.
    pub(crate) fn take_over(&self, x: &mut Exec<'_>) {
        for k in &self.0 {
            let Some(value) = x.cell(k.memory).get(k.element).cloned() else { continue };
            let bits = match value {
                Value::Real(bits) => bits,
                Value::Whole(w) => self.bits(x, k, &w),
                Value::Text(_) => continue,
            };
            let last = bits.last().copied().unwrap_or(Signal::FALSE);
            for (i, latch) in k.latches.iter().enumerate() {
                let next = bits.get(i).copied().unwrap_or(last);
                x.system.set_next(*latch, next);
            }
        }
    }

    fn bits(&self, x: &mut Exec<'_>, k: &Kept, w: &Word) -> Vec<Signal> {
        let mut w = w.clone();
        if let Some(cap) = k.cap {
            let cap = Word::constant(cap);
            let over = word::less(x.g(), &cap, &w);
            w = word::choose(x.g(), over, &cap, &w);
        }
        word::divided(x.g(), &w, k.step).bits().to_vec()
    }
}

/// The latches of one element, and its value as a scan begins.
fn one(
    id: MemoryId,
    element: usize,
    m: &Memory,
    word: u64,
    ranges: &Ranges,
    system: &mut System,
    kept: &mut Vec<Kept>,
) -> Value {
    if !is_whole(m.ty) {
        let latch = |i: usize| system.latch(Init::from(word >> i & 1 != 0));
        let latches: Vec<Signal> = (0..real_bits(m.ty)).map(latch).collect();
        kept.push(Kept { memory: id, element, latches: latches.clone(), step: 1, cap: None });
        return Value::Real(latches);
    }
    let range = ranges.of(id);
    let cap = ranges.cap_of(id);
    let step = range.step.max(1);
    let (low, high) = (range.low / step, cap.unwrap_or(range.high) / step);
    let init = cap.map_or(number(m.ty, word), |c| number(m.ty, word).min(c)) / step;
    let n = width(low, high) - usize::from(low >= 0);
    let latches: Vec<Signal> = (0..n).map(|i| system.latch(Init::from(init >> i & 1 != 0))).collect();
    let mut bits = latches.clone();
    if low >= 0 {
        bits.push(Signal::FALSE);
    }
    kept.push(Kept { memory: id, element, latches, step, cap });
    Value::Whole(Word::of(bits, step, low, high))
}

/// The content of a memory before the first scan.
fn first(m: &Memory) -> Vec<Value> {
    if let Type::String(_) = m.ty {
        let n = m.init.first().map_or(0, |w| *w as usize);
        let bytes: Vec<u8> = m.init.iter().skip(1).flat_map(|w| w.to_le_bytes()).take(n).collect();
        return vec![Value::Text(Some(Rc::from(bytes)))];
    }
    m.init.iter().map(|w| Value::of_word(m.ty, *w)).collect()
}

/// The memories that some statement writes.
fn written(e: &Equations) -> BTreeSet<MemoryId> {
    let mut found = BTreeSet::new();
    let mut note = |s: &Stmt| match s {
        Stmt::Set(m, _) | Stmt::SetElement(m, _, _) => drop(found.insert(*m)),
        Stmt::Call(block, memories) => {
            for s in expand(*block, memories) {
                s.visit(&mut |s| {
                    if let Stmt::Set(m, _) = s {
                        found.insert(*m);
                    }
                });
            }
        }
        _ => {}
    };
    e.sections().flat_map(|s| &s.body).for_each(|s| s.visit(&mut note));
    found
}

/// 1 if these memories have the same content in both lists.
pub(crate) fn alike(x: &mut Exec<'_>, of: &[MemoryId], a: &[Vec<Value>], b: &[Vec<Value>]) -> Signal {
    let mut same = Vec::new();
    for m in of {
        let at = m.0 as usize;
        let (Some(a), Some(b)) = (a.get(at), b.get(at)) else { continue };
        for (a, b) in a.iter().zip(b) {
            same.push(match (a, b) {
                (Value::Text(None), _) | (_, Value::Text(None)) => Signal::FALSE,
                _ => super::value::same(x.g(), a, b),
            });
        }
    }
    x.g().all(same)
}

/// The value of an output where a fault has ended the scan.
pub(crate) fn safe(x: &mut Exec<'_>, id: MemoryId, words: &[u64]) -> Vec<Value> {
    let ty = x.e.memory(id).map_or(Type::Bool, |m| m.ty);
    let stopped = x.faults.iter().map(|f| f.2).collect::<Vec<_>>();
    let stopped = x.g().any(stopped);
    let cell = x.cell(id).to_vec();
    let pairs = cell.iter().zip(words);
    pairs.map(|(v, w)| choose(x.g(), stopped, &Value::of_word(ty, *w), v)).collect()
}
