//! The graph of the situations that a chart reaches, with the inputs that lead from one to another.
//!
//! A node stands for all states with the same active steps: they may differ in times, variables
//! and remembered inputs. So an edge says that some of these states lead on under its condition,
//! not that each does.

use std::cell::RefCell;
use std::collections::BTreeMap;

use g7_engine::StepId;

use crate::cubes::{Cube, fewest};
use crate::layer::Budget;
use crate::model::Model;
use crate::scene::{Scene, Until};
use crate::search::Search;
use crate::verdict::Open;

/// Most conditions of one edge that are kept.
const CONDITIONS: usize = 64;

/// The situations that a chart reaches.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    /// The nodes; the first one stands for the time before the first scan.
    pub nodes: Vec<Node>,
    /// The edges, in the order of their nodes. A scan that clears nothing and leaves the situation
    /// as it is has none.
    pub edges: Vec<Edge>,
    /// The number of states.
    pub states: usize,
    /// The number of scans that were tried.
    pub scans: usize,
    /// Why the graph has not all situations.
    pub open: Option<Open>,
}

/// A node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Before the first scan.
    Start,
    /// A situation.
    Situation,
    /// A fault stopped the chart.
    Fault(&'static str),
}

/// A node with what is known of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// Its kind.
    pub kind: Kind,
    /// The active steps, in the order of the program.
    pub steps: Vec<StepId>,
    /// The number of states that it stands for.
    pub states: usize,
    /// The fewest scans that lead there.
    pub scans: usize,
}

/// An edge.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The number of the node at which it begins.
    pub from: usize,
    /// The number of the node at which it ends.
    pub to: usize,
    /// The transitions (ranks) that clear on it in some state, ascending.
    pub transitions: Vec<u32>,
    /// The inputs under which some state takes it: one of these conditions holds. An empty one is
    /// true by itself: time or variables decide. `None` where they are too many.
    pub when: Option<Vec<Cube>>,
}

/// Visits all states, and puts them together by their situations.
pub fn situations(model: &Model<'_>, budget: &Budget<'_>) -> Graph {
    let draft = RefCell::new(Draft::new(model));
    let mut look = |scene: Scene<'_>| draft.borrow_mut().see(&scene);
    let mut search = Search::new(model, budget, Vec::new());
    search.until = Until::Visited;
    search.look = Some(&mut look);
    search.search();
    let seen = search.seen();
    let mut draft = draft.borrow_mut();
    draft.close_state();
    let edges = std::mem::take(&mut draft.edges);
    let edges = edges.into_iter().map(|((from, to), mut edge)| {
        edge.transitions.sort_unstable();
        Edge { from, to, transitions: edge.transitions, when: edge.when }
    });
    Graph {
        nodes: std::mem::take(&mut draft.nodes),
        edges: edges.collect(),
        states: seen.states,
        scans: seen.scans,
        open: seen.open,
    }
}

#[derive(Default)]
struct DraftEdge {
    transitions: Vec<u32>,
    when: Option<Vec<Cube>>,
}

/// The graph as far as it was seen.
struct Draft<'m> {
    model: &'m Model<'m>,
    nodes: Vec<Node>,
    numbers: BTreeMap<(Kind, Vec<u32>), usize>,
    /// The node of each state.
    of_state: Vec<usize>,
    edges: BTreeMap<(usize, usize), DraftEdge>,
    /// The state whose scans are being shown, with the places of the inputs that it tries.
    from: usize,
    tried: Vec<usize>,
    /// For each node behind it, the values of these inputs.
    leads: BTreeMap<usize, Vec<Vec<u64>>>,
}

impl<'m> Draft<'m> {
    fn new(model: &'m Model<'m>) -> Draft<'m> {
        let start = Node { kind: Kind::Start, steps: Vec::new(), states: 1, scans: 0 };
        Draft {
            model,
            nodes: vec![start],
            numbers: BTreeMap::from([((Kind::Start, Vec::new()), 0)]),
            of_state: vec![0],
            edges: BTreeMap::new(),
            from: 0,
            tried: Vec::new(),
            leads: BTreeMap::new(),
        }
    }

    fn see(&mut self, scene: &Scene<'_>) {
        if scene.from != self.from {
            self.close_state();
            self.from = scene.from;
        }
        self.tried.clear();
        self.tried.extend_from_slice(scene.tried);
        let symbols = &self.model.compiled.symbols;
        let listed = scene.state.active().filter(|s| symbols.is_listed(*s));
        let to = match scene.fault {
            None => self.node(Kind::Situation, listed.collect(), scene.depth),
            Some(fault) => self.node(Kind::Fault(fault.kind.word()), Vec::new(), scene.depth),
        };
        if let Some(state) = scene.to.filter(|s| *s == self.of_state.len()) {
            debug_assert_eq!(state, self.of_state.len(), "states come in order");
            self.of_state.push(to);
            if let Some(node) = self.nodes.get_mut(to) {
                node.states += 1;
            }
        }
        let from = self.of_state.get(self.from).copied().unwrap_or(0);
        let cleared: Vec<u32> =
            scene.state.cleared().iter().copied().filter(|r| symbols.is_written(*r)).collect();
        if from == to && cleared.is_empty() {
            return;
        }
        let edge = self
            .edges
            .entry((from, to))
            .or_insert_with(|| DraftEdge { transitions: Vec::new(), when: Some(Vec::new()) });
        for rank in cleared {
            if !edge.transitions.contains(&rank) {
                edge.transitions.push(rank);
            }
        }
        let inputs = &scene.m.inputs;
        let values = scene.tried.iter().map(|i| inputs.get(*i).copied().unwrap_or(0)).collect();
        self.leads.entry(to).or_default().push(values);
    }

    /// The number of a node; a new one is added.
    fn node(&mut self, kind: Kind, steps: Vec<StepId>, depth: usize) -> usize {
        let key = (kind, steps.iter().map(|s| s.0).collect());
        let nodes = &mut self.nodes;
        *self.numbers.entry(key).or_insert_with(|| {
            nodes.push(Node { kind, steps, states: 0, scans: depth + 1 });
            nodes.len() - 1
        })
    }

    /// Gives the edges of a state whose scans were all shown their conditions.
    fn close_state(&mut self) {
        let from = self.of_state.get(self.from).copied().unwrap_or(0);
        for (to, values) in std::mem::take(&mut self.leads) {
            let Some(edge) = self.edges.get_mut(&(from, to)) else { continue };
            let Some(when) = &mut edge.when else { continue };
            match fewest(&self.model.inputs, &self.tried, &values) {
                Some(cubes) => {
                    cubes.into_iter().for_each(|cube| crate::cubes::add(when, cube));
                    if when.len() > CONDITIONS {
                        edge.when = None;
                    }
                }
                None => edge.when = None,
            }
        }
    }
}
