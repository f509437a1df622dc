//! Finds the steps before and behind each transition of a drawing, through divergences,
//! convergences and jumps.

use std::collections::{BTreeSet, HashMap};

use g7_model::{Said, codes, say};

use super::graph::{Graph, Object};
use super::tree::{head, word};
use crate::report::Report;

/// The most objects visited in one drawing; real drawings need a few for each object.
const MOST_VISITS: usize = 2_000_000;
/// The most branches of nested convergences.
const MOST_WAYS: usize = 1_000;

/// The chart of a drawing.
#[derive(Default)]
pub(super) struct Flow {
    /// The steps and macro-steps in the order of the file, as indices of the graph.
    pub(super) steps: Vec<usize>,
    /// Its transitions in the order of the file.
    pub(super) ways: Vec<Way>,
}

/// A transition with its steps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Way {
    /// The index of its object.
    pub(super) transition: usize,
    /// The steps before it, as indices of the graph.
    pub(super) from: Vec<usize>,
    pub(super) to: Vec<usize>,
}

/// Follows the wires of a drawing.
pub(super) fn flow(graph: &Graph, report: &mut Report) -> Flow {
    let steps = || graph.objects.iter().enumerate().filter(|(_, o)| is_step(o));
    let mut names: HashMap<String, usize> = HashMap::new();
    for (index, step) in steps() {
        if let Some(name) = word(step.node, "name") {
            names.entry(name.to_uppercase()).or_insert(index);
        }
    }
    let mut walk = Walk { graph, report, left: MOST_VISITS, full: false };
    let behind = walk.behind(&names);
    let mut flow = Flow { steps: steps().map(|(i, _)| i).collect(), ways: Vec::new() };
    for (index, object) in graph.objects.iter().enumerate().filter(|(_, o)| o.kind == "transition") {
        let to: Vec<usize> = behind.get(&index).map(|s| s.iter().copied().collect()).unwrap_or_default();
        let mut before = walk.before(object);
        if before.is_empty() {
            before.push(BTreeSet::new());
        }
        if to.is_empty() && before.iter().all(BTreeSet::is_empty) {
            let what = say!("a transition with no step before it and none behind it; it is left out");
            walk.report.say(&codes::BAD_LINK, &head(object.node), what);
            continue;
        }
        if to.is_empty() || before.iter().any(BTreeSet::is_empty) {
            let side = if to.is_empty() { say!("behind") } else { say!("before") };
            let what = say!("a transition with no step {side} it");
            walk.report.say(&codes::OPEN_LINK, &head(object.node), what);
        }
        for from in before.into_iter().filter(|f| !(f.is_empty() && to.is_empty())) {
            flow.ways.push(Way { transition: index, from: from.into_iter().collect(), to: to.clone() });
        }
    }
    flow
}

pub(super) fn is_step(object: &Object) -> bool {
    matches!(object.kind.as_str(), "step" | "macroStep")
}

struct Walk<'r, 'g, 'a> {
    graph: &'g Graph<'a>,
    report: &'r mut Report,
    left: usize,
    full: bool,
}

impl Walk<'_, '_, '_> {
    /// True if the walk may continue; reports once that it may not.
    fn may(&mut self) -> bool {
        if let Some(left) = self.left.checked_sub(1) {
            self.left = left;
            return true;
        }
        if !self.full {
            self.full = true;
            self.report.say(
                &codes::TOO_LARGE,
                &(0..0),
                say!("the lines of this chart are too many to follow"),
            );
        }
        false
    }

    /// The steps behind each transition.
    fn behind(&mut self, names: &HashMap<String, usize>) -> HashMap<usize, BTreeSet<usize>> {
        let mut behind: HashMap<usize, BTreeSet<usize>> = HashMap::new();
        for (index, object) in self.graph.objects.iter().enumerate() {
            let step = match object.kind.as_str() {
                "step" | "macroStep" => Some(index),
                "jumpStep" => self.target(object, names),
                _ => continue,
            };
            for transition in self.sources(object) {
                if let Some(step) = step {
                    behind.entry(transition).or_default().insert(step);
                }
            }
        }
        behind
    }

    fn target(&mut self, jump: &Object, names: &HashMap<String, usize>) -> Option<usize> {
        let name = word(jump.node, "targetName").unwrap_or("");
        let target = names.get(&name.to_uppercase()).copied();
        if target.is_none() {
            let what = say!("a jump to `{name}`, which is no step of this chart");
            self.report.say(&codes::BAD_LINK, &head(jump.node), what);
        }
        target
    }

    /// The transitions that lead to a step or jump.
    fn sources(&mut self, object: &Object) -> BTreeSet<usize> {
        let mut found = BTreeSet::new();
        let mut seen = BTreeSet::new();
        let mut open: Vec<usize> = object.flow().map(|w| w.from).collect();
        while let Some(index) = open.pop() {
            if !seen.insert(index) || !self.may() {
                continue;
            }
            let Some(from) = self.graph.get(index) else { continue };
            match from.kind.as_str() {
                "transition" => {
                    found.insert(index);
                }
                "selectionConvergence" | "simultaneousDivergence" | "selectionDivergence" | "connector" => {
                    open.extend(from.flow().map(|w| w.from));
                }
                "continuation" => open.extend(self.graph.connector(from)),
                // In CODESYS the branches of a divergence end in a convergence, also those that
                // jump.
                "jumpStep" => {}
                _ => self.odd(object, from, say!("a transition")),
            }
        }
        found
    }

    /// The sets of steps before a transition, one for each path to it.
    fn before(&mut self, transition: &Object) -> Vec<BTreeSet<usize>> {
        let mut ways = Vec::new();
        for wire in transition.flow() {
            ways.append(&mut self.steps(transition, wire.from, 0));
        }
        ways.truncate(MOST_WAYS);
        ways
    }

    fn steps(&mut self, end: &Object, index: usize, depth: usize) -> Vec<BTreeSet<usize>> {
        let Some(from) = self.graph.get(index) else { return Vec::new() };
        if depth > 60 || !self.may() {
            let what = say!("lines that lead through too many divergences, or in a circle without a step");
            self.report.element(&codes::BAD_LINK, "circle", &head(end.node), what);
            return Vec::new();
        }
        match from.kind.as_str() {
            "step" | "macroStep" => vec![BTreeSet::from([index])],
            "selectionDivergence" | "selectionConvergence" | "simultaneousDivergence" | "connector" => {
                let mut ways = Vec::new();
                for wire in from.flow() {
                    ways.append(&mut self.steps(end, wire.from, depth + 1));
                    ways.truncate(MOST_WAYS);
                }
                ways
            }
            "continuation" => {
                self.graph.connector(from).map(|i| self.steps(end, i, depth + 1)).unwrap_or_default()
            }
            "simultaneousConvergence" => {
                let mut ways = vec![BTreeSet::new()];
                for wire in from.flow() {
                    let more = self.steps(end, wire.from, depth + 1);
                    ways = joined(&ways, &more);
                }
                ways
            }
            _ => {
                self.odd(end, from, say!("a step"));
                Vec::new()
            }
        }
    }

    fn odd(&mut self, end: &Object, from: &Object, wanted: Said) {
        let what = say!("a line leads to this `{}` from a `{}`, not from {wanted}", end.kind, from.kind);
        let problem = g7_model::Problem::new(&codes::BAD_LINK, self.report.span(&head(end.node)), what);
        let there = self.report.span(&head(from.node));
        self.report.put(problem.related(there, say!("where it comes from")));
    }
}

/// All unions of one set of the first list with one set of the second.
fn joined(some: &[BTreeSet<usize>], others: &[BTreeSet<usize>]) -> Vec<BTreeSet<usize>> {
    if others.is_empty() {
        return some.to_vec();
    }
    let mut all: Vec<BTreeSet<usize>> = Vec::new();
    for a in some {
        for b in others {
            if all.len() < MOST_WAYS {
                all.push(a.union(b).copied().collect());
            }
        }
    }
    all
}
