//! A system in the binary form of AIGER 1.9, which other model checkers read.
//!
//! After A. Biere, K. Heljanko, S. Wieringa, "AIGER 1.9 and beyond" (2011): inputs, latches and
//! conjunctions are numbered in this order; bad signals and constraints are listed as such.

use crate::sat::graph::{Init, Node, Signal, System};

/// The bytes of an AIGER file with one bad signal for each of these.
pub fn aiger(system: &System, bad: &[Signal]) -> Vec<u8> {
    let nodes = system.graph.nodes();
    let mut numbers = vec![0u32; nodes.len()];
    let mut count = 0u32;
    let rank = |n: &Node| match n {
        Node::False => 0,
        Node::Input(_) => 1,
        Node::Latch(_) => 2,
        Node::And(..) => 3,
    };
    for kind in 1..=3 {
        for (number, _) in numbers.iter_mut().zip(nodes).filter(|(_, n)| rank(n) == kind) {
            count += 1;
            *number = count;
        }
    }
    let code = |s: Signal| {
        let number = numbers.get(s.node() as usize).copied().unwrap_or(0);
        number * 2 + u32::from(s.is_negated())
    };
    let ands = nodes.iter().filter(|n| rank(n) == 3).count();
    let (inputs, latches) = (system.inputs.len(), system.latches.len());
    let constraints = system.constraints.len();
    let mut out = format!("aig {count} {inputs} {latches} 0 {ands} {} {constraints}\n", bad.len());
    for l in &system.latches {
        let init = match l.init {
            Init::Zero => 0,
            Init::One => 1,
            Init::Free => code(l.signal),
        };
        out.push_str(&format!("{} {init}\n", code(l.next)));
    }
    for s in bad.iter().chain(&system.constraints) {
        out.push_str(&format!("{}\n", code(*s)));
    }
    let mut out = out.into_bytes();
    for (node, number) in nodes.iter().zip(&numbers) {
        if let Node::And(a, b) = node {
            let (most, least) = (code(*a).max(code(*b)), code(*a).min(code(*b)));
            put(&mut out, number * 2 - most);
            put(&mut out, most - least);
        }
    }
    out
}

/// Seven bits a byte, the low ones first; the top bit says that more follow.
fn put(out: &mut Vec<u8>, mut value: u32) {
    while value > 0x7f {
        out.push(value as u8 & 0x7f | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sat::brute::{shortest, system};
    use g7_peers::checkers::{Abc, Ric3, Said, one_of};

    #[test]
    fn a_latch_that_an_input_sets_for_ever() {
        let mut s = System::default();
        let latch = s.latch(Init::Free);
        let input = s.input();
        let next = s.graph.or(latch, input);
        s.set_next(latch, next);
        s.constraints.push(!latch);
        // Input 1 (2), latch 2 (4), conjunction 3 (6) of not 4 and not 2; next is not 6.
        let mut expected = b"aig 3 1 1 0 1 1 1\n7 4\n4\n5\n".to_vec();
        expected.extend([1, 2]);
        assert_eq!(aiger(&s, &[latch]), expected);
    }

    /// Other programs read the file, and say of each signal what is said here.
    #[test]
    fn other_model_checkers_agree() {
        let all: Vec<_> = (0..300).map(system).collect();
        let files: Vec<Vec<u8>> = all.iter().map(|(s, bad)| aiger(s, &[*bad, !*bad])).collect();
        let wanted = |i: usize| [all[i].1, !all[i].1].map(|bad| shortest(&all[i].0, bad));
        if let Some(abc) = Abc::find() {
            for (i, said) in abc.ask(&files, 20).iter().enumerate() {
                let said: Vec<Option<usize>> = said.iter().map(steps).collect();
                assert_eq!(said, wanted(i), "seed {i}");
            }
        }
        if let Some(ric3) = Ric3::find() {
            for (i, file) in files.iter().enumerate().take(40) {
                let said = [0, 1].map(|k| steps(&ric3.ask(&one_of(file, k), 20)).is_some());
                assert_eq!(said, wanted(i).map(|steps| steps.is_some()), "seed {i}");
            }
        }
    }

    fn steps(said: &Said) -> Option<usize> {
        match said {
            Said::Never => None,
            Said::Reached(steps) => Some(*steps),
            Said::Open => panic!("no answer"),
        }
    }

    #[test]
    fn numbers_take_seven_bits_a_byte() {
        let bytes = |value| {
            let mut out = Vec::new();
            put(&mut out, value);
            out
        };
        assert_eq!(bytes(0x7f), [0x7f]);
        assert_eq!(bytes(0x80), [0x80, 1]);
        assert_eq!(bytes(16387), [0x83, 0x80, 1]);
    }
}
