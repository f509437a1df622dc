//! Two systems as one: a step of the whole is a step of both, with inputs in common.

use crate::sat::graph::{Node, Signal, System};

/// Adds a system beside another, in which it takes over latches, conjunctions and constraints. Its
/// input at a place is the signal that `inputs` has there; one without becomes a new input. Gives
/// for each of its nodes the signal that stands for it in the whole.
pub(crate) fn join(whole: &mut System, other: &System, inputs: &[Option<Signal>]) -> Vec<Signal> {
    let mut map: Vec<Signal> = Vec::with_capacity(other.graph.nodes().len());
    for node in other.graph.nodes() {
        let new = match node {
            Node::False => Signal::FALSE,
            Node::Input(i) => match inputs.get(*i as usize).copied().flatten() {
                Some(signal) => signal,
                None => whole.input(),
            },
            Node::Latch(i) => {
                let init = other.latches.get(*i as usize).map_or(false.into(), |l| l.init);
                whole.latch(init)
            }
            Node::And(a, b) => {
                let (a, b) = (mapped(&map, *a), mapped(&map, *b));
                whole.graph.and(a, b)
            }
        };
        map.push(new);
    }
    for latch in &other.latches {
        whole.set_next(mapped(&map, latch.signal), mapped(&map, latch.next));
    }
    for c in &other.constraints {
        let c = mapped(&map, *c);
        if c != Signal::TRUE && !whole.constraints.contains(&c) {
            whole.constraints.push(c);
        }
    }
    map
}

/// A signal of the other system in the whole.
pub(crate) fn mapped(map: &[Signal], s: Signal) -> Signal {
    map.get(s.node() as usize).map_or(Signal::FALSE, |m| m.negated_if(s.is_negated()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sat::brute::{Random, system};
    use crate::sat::simulate::evaluate;

    /// Each part of the whole does what the system does by itself.
    #[test]
    fn both_parts_go_on_as_they_do_alone() {
        let mut r = Random(3);
        let mut shared = 0;
        for seed in 0..300 {
            let (a, _) = system(seed);
            let (b, _) = system(seed + 1);
            let mut whole = a.clone();
            // Every second input is one of the first system's.
            let inputs: Vec<Option<Signal>> =
                (0..b.inputs.len()).map(|i| a.inputs.get(i).copied().filter(|_| i % 2 == 0)).collect();
            let map = join(&mut whole, &b, &inputs);
            shared += inputs.iter().flatten().count();
            assert_eq!(whole.latches.len(), a.latches.len() + b.latches.len());
            for _ in 0..8 {
                let word = |r: &mut Random| (r.below(1 << 30) as u64) << 32 | r.below(1 << 30) as u64;
                let latches: Vec<u64> = whole.latches.iter().map(|_| word(&mut r)).collect();
                let given: Vec<u64> = whole.inputs.iter().map(|_| word(&mut r)).collect();
                let values = evaluate(&whole.graph, &latches, &given);
                let (of_a, of_b) = latches.split_at(a.latches.len());
                let alone = evaluate(&a.graph, of_a, &given);
                let of_input = |s: &Signal| values.get(mapped(&map, *s));
                let inputs_b: Vec<u64> = b.inputs.iter().map(of_input).collect();
                let beside = evaluate(&b.graph, of_b, &inputs_b);
                for l in &a.latches {
                    assert_eq!(values.get(l.next), alone.get(l.next), "seed {seed}");
                }
                let rest = whole.latches.iter().skip(a.latches.len());
                for (l, new) in b.latches.iter().zip(rest) {
                    assert_eq!(values.get(new.next), beside.get(l.next), "seed {seed}");
                    assert_eq!(new.init, l.init);
                }
                let holds = |s: &System, v: &crate::sat::simulate::Values| {
                    s.constraints.iter().fold(u64::MAX, |w, c| w & v.get(*c))
                };
                assert_eq!(holds(&whole, &values), holds(&a, &alone) & holds(&b, &beside), "seed {seed}");
            }
        }
        assert!(shared > 200, "{shared}");
    }
}
