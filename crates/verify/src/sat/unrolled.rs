//! The next steps of a system with given inputs, as functions of its latches.

use crate::sat::graph::{Graph, Node, Signal, System};

/// The next steps of a system with given inputs, one list for each step.
pub(crate) struct Unrolled<'v> {
    inputs: &'v [Vec<bool>],
    /// For each step and node of the system the function that stands for it, once it is known.
    made: Vec<Vec<Option<Signal>>>,
}

impl<'v> Unrolled<'v> {
    pub(crate) fn new(inputs: &'v [Vec<bool>]) -> Unrolled<'v> {
        Unrolled { inputs, made: vec![Vec::new(); inputs.len()] }
    }

    fn get(&self, step: usize, s: Signal) -> Option<Signal> {
        let row = self.made.get(step)?;
        row.get(s.node() as usize).copied().flatten().map(|m| m.negated_if(s.is_negated()))
    }

    /// A signal of the system in a step, as a function of the latches at the first one. `graph` is that of the
    /// system, perhaps with nodes of its own behind.
    pub(crate) fn signal(&mut self, system: &System, graph: &mut Graph, step: usize, s: Signal) -> Signal {
        let count = system.graph.nodes().len();
        for row in &mut self.made {
            row.resize(count, None);
        }
        let mut work = vec![(step, s.node())];
        while let Some((step, node)) = work.last().copied() {
            let plain = Signal::of(node, false);
            let new = match system.graph.node(plain) {
                Node::False => Signal::FALSE,
                Node::Input(i) => {
                    let given = self.inputs.get(step).and_then(|row| row.get(i as usize));
                    given.copied().unwrap_or(false).into()
                }
                Node::Latch(_) if step == 0 => plain,
                Node::Latch(i) => {
                    let next = system.latches.get(i as usize).map_or(Signal::FALSE, |l| l.next);
                    match self.get(step - 1, next) {
                        Some(known) => known,
                        None => {
                            work.push((step - 1, next.node()));
                            continue;
                        }
                    }
                }
                Node::And(a, b) => match (self.get(step, a), self.get(step, b)) {
                    (Some(a), Some(b)) => graph.and(a, b),
                    (x, y) => {
                        work.extend(x.is_none().then_some((step, a.node())));
                        work.extend(y.is_none().then_some((step, b.node())));
                        continue;
                    }
                },
            };
            work.pop();
            let row = self.made.get_mut(step);
            if let Some(slot) = row.and_then(|row| row.get_mut(node as usize)) {
                *slot = Some(new);
            }
        }
        self.get(step, s).unwrap_or(Signal::FALSE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sat::brute::{Random, system};
    use crate::sat::simulate::evaluate;

    /// The functions have the values that the steps have one after the other.
    #[test]
    fn functions_are_what_the_steps_do() {
        let mut r = Random(11);
        for seed in 0..300 {
            let (s, bad) = system(seed);
            let inputs: Vec<Vec<bool>> =
                (0..3).map(|_| s.inputs.iter().map(|_| r.below(2) == 1).collect()).collect();
            let mut graph = s.graph.clone();
            let mut unrolled = Unrolled::new(&inputs);
            let made: Vec<Signal> = (0..3).map(|k| unrolled.signal(&s, &mut graph, k, bad)).collect();
            let first: Vec<u64> = s.latches.iter().map(|_| r.below(1 << 30) as u64).collect();
            let all = evaluate(&graph, &first, &[]);
            let mut latches = first;
            for (made, given) in made.iter().zip(&inputs) {
                let given: Vec<u64> = given.iter().map(|b| if *b { u64::MAX } else { 0 }).collect();
                let values = evaluate(&s.graph, &latches, &given);
                assert_eq!(all.get(*made), values.get(bad), "seed {seed}");
                latches = s.latches.iter().map(|l| values.get(l.next)).collect();
            }
        }
    }
}
