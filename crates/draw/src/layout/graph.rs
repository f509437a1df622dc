//! The chart as a graph: which symbol leads to which, where sequences begin, and which links close
//! a loop.

use std::collections::HashMap;

use g7_model::{Chart, Step, StepKind};

use crate::layout::adrift::{Gap, gaps};
use crate::layout::lists::Lists;

/// Steps and transitions as nodes (steps first), and links in the order of the text.
#[derive(Debug)]
pub(crate) struct Graph {
    /// Number of steps.
    pub(crate) steps: usize,
    /// Number of nodes.
    pub(crate) nodes: usize,
    /// The two ends of each link: from node, to node.
    pub(crate) links: Vec<(u32, u32)>,
    /// The links that leave each node.
    pub(crate) out: Lists,
    /// The links that enter each node.
    pub(crate) into: Lists,
    /// True for each link that leads back up, that is, closes a loop.
    pub(crate) back: Vec<bool>,
    /// Number of steps and of transitions that the chart has. What comes behind them among the steps and among
    /// the transitions is missing: it takes room and is not drawn.
    pub(crate) real: (usize, usize),
}

/// Puts missing symbols into the gaps: a transition behind steps, a step and a transition behind a transition.
/// Returns the number of steps and of nodes with them.
#[inline(never)]
fn bridge((steps, transitions): (usize, usize), gaps: &[Gap], links: &mut Vec<(u32, u32)>) -> (usize, usize) {
    let is_step = |n: u32| (n as usize) < steps;
    let behind_transition = |g: &&Gap| g.from.iter().any(|n| !is_step(*n));
    let more = gaps.iter().filter(behind_transition).count() as u32;
    let number = |n: u32| if is_step(n) { n } else { n + more };
    links.iter_mut().for_each(|(from, to)| (*from, *to) = (number(*from), number(*to)));
    let mut step = steps as u32;
    let mut node = (steps + transitions) as u32 + more;
    for gap in gaps {
        if behind_transition(&gap) {
            links.extend(gap.from.iter().map(|n| (number(*n), step)));
            links.push((step, node));
            step += 1;
        } else {
            links.extend(gap.from.iter().map(|n| (*n, node)));
        }
        links.extend(gap.to.iter().map(|n| (node, *n)));
        node += 1;
    }
    (step as usize, node as usize)
}

impl Graph {
    /// Builds the graph of a chart. Names that no step has are ignored.
    #[inline(never)]
    pub(crate) fn new(chart: &Chart) -> Graph {
        let steps: Vec<&Step> = chart.steps().collect();
        let mut numbers: HashMap<&str, u32> = HashMap::with_capacity(steps.len());
        for (n, s) in (0u32..).zip(&steps) {
            numbers.entry(&s.name.text).or_insert(n);
        }
        let mut links = Vec::new();
        let mut node = steps.len() as u32;
        // By step: the last side of a transition that named it; a step counts once a side.
        let mut last = vec![0u32; steps.len()];
        let mut side = 0;
        for t in chart.transitions() {
            let mut number = |name: &g7_model::Name, side: u32| {
                let n = numbers.get(&*name.text).copied()?;
                (std::mem::replace(&mut last[n as usize], side) != side).then_some(n)
            };
            side += 1;
            links.extend(t.from.iter().filter_map(|f| Some((number(f, side)?, node))));
            side += 1;
            links.extend(t.to.iter().filter_map(|f| Some((node, number(f, side)?))));
            node += 1;
        }
        let real = (steps.len(), node as usize - steps.len());
        let gaps = gaps(&steps, node as usize, &links);
        let (count, nodes) = bridge(real, &gaps, &mut links);
        let out = Lists::new(nodes, links.iter().map(|l| l.0));
        let into = Lists::new(nodes, links.iter().map(|l| l.1));
        let back = vec![false; links.len()];
        let mut graph = Graph { steps: count, nodes, links, out, into, back, real };
        graph.find_loops(&steps);
        graph
    }

    /// True if a node is a step.
    pub(crate) fn is_step(&self, n: u32) -> bool {
        (n as usize) < self.steps
    }

    /// Marks the links that close a loop. A loop is opened at the step where it is entered and,
    /// where possible, never between a step and the transition that follows it.
    #[inline(never)]
    fn find_loops(&mut self, steps: &[&Step]) {
        let seeds = self.seeds(steps);
        let mut top = self.tops(&seeds);
        let knots = self.knots();
        for _ in 0..4 {
            self.descend(&seeds, &top, &knots);
            let wrong: Vec<u32> = (0..self.links.len())
                .filter(|&l| self.back[l] && self.is_step(self.links[l].0))
                .map(|l| self.links[l].0)
                .collect();
            if wrong.is_empty() {
                break;
            }
            wrong.into_iter().for_each(|s| top[s as usize] = true);
        }
    }

    /// All nodes, ordered by how likely a sequence begins there: initial steps first. A node may
    /// occur twice.
    #[inline(never)]
    fn seeds(&self, steps: &[&Step]) -> Vec<u32> {
        let mut seeds: Vec<u32> = Vec::with_capacity(2 * self.nodes);
        let of = |which: &dyn Fn(&Step) -> bool| {
            let all = (0u32..).zip(steps).filter(|(_, s)| which(s));
            all.map(|(n, _)| n).collect::<Vec<_>>()
        };
        seeds.extend(of(&|s| s.initial));
        seeds.extend(of(&|s| s.linked || s.kind == StepKind::Entry));
        seeds.extend((self.steps as u32..self.nodes as u32).filter(|&t| self.into.of(t).is_empty()));
        seeds.extend((0..self.steps as u32).filter(|&s| self.into.of(s).is_empty()));
        seeds.extend(0..self.nodes as u32);
        seeds
    }

    /// The nodes from which a walk has to start so that it reaches every node. The walk passes a
    /// transition only after it has reached all its preceding steps.
    #[inline(never)]
    fn tops(&self, seeds: &[u32]) -> Vec<bool> {
        let mut top = vec![false; self.nodes];
        let mut seen = vec![false; self.nodes];
        let mut missing: Vec<usize> = (0..self.nodes as u32).map(|n| self.into.of(n).len()).collect();
        let mut stack = Vec::new();
        for &seed in seeds {
            if seen[seed as usize] {
                continue;
            }
            top[seed as usize] = true;
            seen[seed as usize] = true;
            stack.push(seed);
            while let Some(n) = stack.pop() {
                for &l in self.out.of(n) {
                    let to = self.links[l as usize].1 as usize;
                    missing[to] -= 1;
                    if !seen[to] && (self.is_step(to as u32) || missing[to] == 0) {
                        seen[to] = true;
                        stack.push(to as u32);
                    }
                }
            }
        }
        top
    }

    /// A number for each node; nodes on a common loop (a strongly connected component) share a
    /// number.
    #[inline(never)]
    fn knots(&self) -> Vec<u32> {
        const NEW: u32 = u32::MAX;
        let mut knot = vec![NEW; self.nodes];
        let (mut low, mut first) = (vec![NEW; self.nodes], vec![NEW; self.nodes]);
        let (mut seen, mut path, mut stack) = (0, Vec::new(), Vec::<(u32, usize)>::new());
        for root in 0..self.nodes as u32 {
            if low[root as usize] == NEW {
                stack.push((root, 0));
            }
            while let Some((n, next)) = stack.last_mut() {
                let (n, at) = (*n, *n as usize);
                if *next == 0 {
                    (low[at], first[at]) = (seen, seen);
                    seen += 1;
                    path.push(n);
                }
                let links = self.out.of(n);
                if *next > 0 {
                    let done = self.links[links[*next - 1] as usize].1 as usize;
                    if knot[done] == NEW {
                        low[at] = low[at].min(low[done]);
                    }
                }
                let Some(&l) = links.get(*next) else {
                    stack.pop();
                    // This node was reached first in its component; the rest of the component is
                    // what the path has collected since.
                    while low[at] == first[at] && knot[at] == NEW {
                        let Some(m) = path.pop() else { break };
                        knot[m as usize] = n;
                    }
                    continue;
                };
                *next += 1;
                let to = self.links[l as usize].1 as usize;
                if low[to] == NEW {
                    stack.push((to as u32, 0));
                }
            }
        }
        knot
    }

    /// Walks depth first from the tops. A link closes a loop if it leads to a node on the current
    /// path or to a top of the same component.
    #[inline(never)]
    fn descend(&mut self, seeds: &[u32], top: &[bool], knots: &[u32]) {
        const NEW: u8 = 0;
        const OPEN: u8 = 1;
        const DONE: u8 = 2;
        self.back.iter_mut().for_each(|b| *b = false);
        let mut state = vec![NEW; self.nodes];
        let mut stack: Vec<(u32, usize)> = Vec::new();
        let tops = seeds.iter().filter(|n| top[**n as usize]);
        for &seed in tops.chain(seeds) {
            if state[seed as usize] != NEW {
                continue;
            }
            state[seed as usize] = OPEN;
            stack.push((seed, 0));
            while let Some((n, next)) = stack.last_mut() {
                let Some(&l) = self.out.of(*n).get(*next) else {
                    state[*n as usize] = DONE;
                    stack.pop();
                    continue;
                };
                *next += 1;
                let to = self.links[l as usize].1;
                let loops = knots[*n as usize] == knots[to as usize];
                if top[to as usize] && loops || state[to as usize] == OPEN {
                    self.back[l as usize] = true;
                } else if state[to as usize] == NEW {
                    state[to as usize] = OPEN;
                    stack.push((to, 0));
                }
            }
        }
    }
}
