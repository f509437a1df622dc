//! Values of all nodes of a graph, for 64 patterns at once. Counterexamples are tried with
//! it, and tests compare the engines with it.

use crate::sat::graph::{Graph, Node, Signal, System};

/// The values of all nodes; bit k of a word belongs to pattern k.
#[derive(Clone, Debug, Default)]
pub struct Values(Vec<u64>);

impl Values {
    /// The values of a signal.
    pub fn get(&self, s: Signal) -> u64 {
        let word = self.0.get(s.node() as usize).copied().unwrap_or(0);
        if s.is_negated() { !word } else { word }
    }

    /// The value of a signal in the first pattern.
    pub fn bit(&self, s: Signal) -> bool {
        self.get(s) & 1 != 0
    }
}

/// Evaluates a graph for given values of its latches and inputs; those that are missing are 0.
pub fn evaluate(graph: &Graph, latches: &[u64], inputs: &[u64]) -> Values {
    let mut values = Values(Vec::with_capacity(graph.nodes().len()));
    for node in graph.nodes() {
        let word = match node {
            Node::False => 0,
            Node::Input(i) => inputs.get(*i as usize).copied().unwrap_or(0),
            Node::Latch(i) => latches.get(*i as usize).copied().unwrap_or(0),
            Node::And(a, b) => values.get(*a) & values.get(*b),
        };
        values.0.push(word);
    }
    values
}

/// Words for inputs at random, the same in each run of the program.
pub(crate) fn random() -> impl FnMut() -> u64 {
    let mut x = 0x5EED_u64;
    move || {
        x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        x ^ x >> 32 ^ x << 29
    }
}

/// A run of a system.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Trace {
    /// The latches at the first step.
    pub latches: Vec<bool>,
    /// The inputs of each step; the last step shows the bad signal.
    pub inputs: Vec<Vec<bool>>,
}

/// True if a trace is a run of the system, and the signal is 1 at its last step.
pub fn shows(system: &System, trace: &Trace, bad: Signal) -> bool {
    let word = |b: &bool| u64::from(*b);
    let mut latches: Vec<u64> = trace.latches.iter().map(word).collect();
    let starts = system.latches.len() == trace.latches.len()
        && system.latches.iter().zip(&trace.latches).all(|(l, v)| l.init.value().is_none_or(|i| i == *v));
    let mut is_bad = false;
    for inputs in &trace.inputs {
        let inputs: Vec<u64> = inputs.iter().map(word).collect();
        let values = evaluate(&system.graph, &latches, &inputs);
        if !system.constraints.iter().all(|c| values.bit(*c)) {
            return false;
        }
        is_bad = values.bit(bad);
        latches = system.latches.iter().map(|l| values.get(l.next)).collect();
    }
    starts && is_bad
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each function is the one of its truth table, whatever rule made it shorter.
    #[test]
    fn functions_have_their_truth_tables() {
        let mut s = System::default();
        let inputs: Vec<Signal> = (0..4).map(|_| s.input()).collect();
        let patterns: Vec<u64> =
            (0..4).map(|i| (0..16u64).filter(|p| p >> i & 1 != 0).fold(0, |word, p| word | 1 << p)).collect();
        let mut known: Vec<(Signal, u64)> = inputs.iter().copied().zip(patterns.iter().copied()).collect();
        let mut x = 7u64;
        for _ in 0..3000 {
            x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let pick = |at: u32, known: &[(Signal, u64)]| {
                let (s, v) = known[(x >> at) as usize % known.len().min(40)];
                let negate = x >> (at + 7) & 1 != 0;
                (s.negated_if(negate), if negate { !v & 0xffff } else { v })
            };
            let ((a, va), (b, vb), (c, vc)) = (pick(20, &known), pick(31, &known), pick(42, &known));
            let g = &mut s.graph;
            let new = match x >> 60 & 7 {
                0 | 1 => (g.and(a, b), va & vb),
                2 => (g.or(a, b), va | vb),
                3 => (g.xor(a, b), va ^ vb),
                4 => (g.mux(a, b, c), va & vb | !va & vc),
                5 => (g.all([a, b, c]), va & vb & vc),
                6 => (g.any([a, b, c]), va | vb | vc),
                _ => (g.implies(a, b), (!va | vb) & 0xffff),
            };
            known.insert(x as usize % 40 % known.len(), new);
        }
        let values = evaluate(&s.graph, &[], &patterns);
        for (signal, expected) in known {
            assert_eq!(values.get(signal) & 0xffff, expected & 0xffff, "{signal:?}");
        }
    }
}
