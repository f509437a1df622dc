//! Lines between steps and transitions, through the bars of branches.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use g7_model::{codes, say};

use g7_iec::report::Report;

/// The most lines followed for one chart.
const MOST_WORK: usize = 2_000_000;

/// An end of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Node {
    Step(usize),
    Transition(usize),
    /// A branch or a part of one; lines only pass through it.
    Bar(usize),
}

/// The lines of a chart.
#[derive(Debug, Default)]
pub(crate) struct Flow {
    out: HashMap<Node, Vec<Node>>,
    into: HashMap<Node, Vec<Node>>,
}

/// The steps before and behind a transition.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ends {
    pub(crate) from: Vec<usize>,
    pub(crate) to: Vec<usize>,
}

impl Flow {
    /// Adds a line; reports a line that no chart can have.
    pub(crate) fn line(&mut self, from: Node, to: Node, at: &Range<usize>, report: &mut Report) {
        let wrong = match (from, to) {
            (Node::Step(_), Node::Step(_)) => {
                say!("a line from a step to a step without a transition between")
            }
            (Node::Transition(_), Node::Transition(_)) => {
                say!("a line from a transition to a transition without a step between")
            }
            _ => {
                self.out.entry(from).or_default().push(to);
                self.into.entry(to).or_default().push(from);
                return;
            }
        };
        report.say(&codes::BAD_LINK, at, wrong);
    }

    /// The ends of each transition. `transitions` holds the places of the transitions.
    pub(crate) fn ends(&self, transitions: &[Range<usize>], report: &mut Report) -> Vec<Ends> {
        let mut left = MOST_WORK;
        let mut all = Vec::with_capacity(transitions.len());
        for (index, at) in transitions.iter().enumerate() {
            let from = self.walk(index, &self.into, &mut left);
            let to = self.walk(index, &self.out, &mut left);
            if left == 0 {
                report.element(&codes::TOO_LARGE, "line", at, say!("the chart has too many lines"));
            } else if from.is_empty() && to.is_empty() {
                report.say(&codes::OPEN_LINK, at, say!("a transition without any step"));
            } else if from.is_empty() {
                report.say(
                    &codes::OPEN_LINK,
                    at,
                    say!("a transition without a step before it; it is always enabled"),
                );
            } else if to.is_empty() {
                report.say(&codes::OPEN_LINK, at, say!("a transition without a step behind it"));
            }
            all.push(Ends { from, to });
        }
        all
    }

    /// For each transition the first step before it, and the position of the transition among those
    /// behind that step, in the order of the lines. None if there is no step before it.
    pub(crate) fn order(&self, steps: usize, transitions: usize) -> Vec<Option<(usize, usize)>> {
        let mut order = vec![None; transitions];
        let mut left = MOST_WORK;
        for step in 0..steps {
            let mut place = 0;
            let mut seen = HashSet::new();
            let mut stack = vec![Node::Step(step)];
            while let Some(node) = stack.pop() {
                if let Node::Transition(index) = node {
                    if let Some(found) = order.get_mut(index).filter(|o| o.is_none()) {
                        *found = Some((step, place));
                    }
                    place += 1;
                    continue;
                }
                for &other in self.out.get(&node).into_iter().flatten().rev() {
                    if left == 0 {
                        return order;
                    }
                    left -= 1;
                    if !matches!(other, Node::Step(_)) && seen.insert(other) {
                        stack.push(other);
                    }
                }
            }
        }
        order
    }

    /// The steps reached from a transition, in the order of the lines.
    fn walk(&self, transition: usize, next: &HashMap<Node, Vec<Node>>, left: &mut usize) -> Vec<usize> {
        let start = Node::Transition(transition);
        let mut steps = Vec::new();
        let mut seen = HashSet::from([start]);
        let mut stack = vec![start];
        while let Some(node) = stack.pop() {
            if let Node::Step(step) = node {
                steps.push(step);
                continue;
            }
            for &other in next.get(&node).into_iter().flatten().rev() {
                if *left == 0 {
                    return steps;
                }
                *left -= 1;
                if !matches!(other, Node::Transition(_)) && seen.insert(other) {
                    stack.push(other);
                }
            }
        }
        steps
    }
}
