//! The graph of situations with the names of the chart, as data and for Graphviz.

use g7_compile::symbols::Symbols;
use g7_engine::Addr;
use g7_verify::{Cube, Edge, Kind, Node, words};
use serde_json::{Value, json};

/// The graph with its words.
pub(super) struct Named<'g> {
    pub(super) symbols: &'g Symbols,
    /// The address of the first input word.
    pub(super) first: u32,
    pub(super) graph: &'g g7_verify::Graph,
}

/// Most products of a label.
const PRODUCTS: usize = 3;

impl Named<'_> {
    /// A node in a drawing: its situation.
    pub(super) fn node(&self, node: &Node) -> String {
        match node.kind {
            Kind::Start => "start".to_owned(),
            Kind::Situation => format!("{{{}}}", self.steps(node).join(", ")),
            Kind::Fault(word) => format!("fault: {word}"),
        }
    }

    pub(super) fn steps(&self, node: &Node) -> Vec<&str> {
        node.steps.iter().map(|s| self.symbols.step_name(*s)).collect()
    }

    pub(super) fn transitions(&self, edge: &Edge) -> Vec<&str> {
        edge.transitions.iter().map(|r| self.symbols.transition_text(*r)).collect()
    }

    /// The condition of an edge, `a · not b + c`; empty if no input matters.
    pub(super) fn condition(&self, cubes: &[Cube], most: usize) -> String {
        let products = cubes.iter().filter(|c| !c.is_empty());
        let mut words: Vec<String> = products.map(|c| self.product(c)).collect();
        if words.len() > most {
            words.truncate(most);
            words.push("…".to_owned());
        }
        words.join(" + ")
    }

    pub(super) fn product(&self, cube: &Cube) -> String {
        let literal = |(place, value): &(usize, u64)| {
            let addr = Addr(self.first + *place as u32);
            let Some(v) = self.symbols.variable_at(addr) else { return String::new() };
            match Symbols::value_text(v.ty, &[*value]).as_str() {
                "TRUE" => v.name.to_string(),
                "FALSE" => format!("not {}", v.name),
                text => format!("{} = {text}", v.name),
            }
        };
        cube.iter().map(literal).collect::<Vec<_>>().join(" · ")
    }

    /// The label of an edge in a drawing.
    pub(super) fn label(&self, edge: &Edge) -> String {
        let condition = match &edge.when {
            None => "many inputs".to_owned(),
            Some(cubes) => self.condition(cubes, PRODUCTS),
        };
        match condition {
            none if none.is_empty() => self.transitions(edge).join(", "),
            condition => condition,
        }
    }

    pub(super) fn json(&self, file: &str) -> Value {
        let node = |(id, n): (usize, &Node)| {
            let (kind, fault) = match n.kind {
                Kind::Start => ("start", None),
                Kind::Situation => ("situation", None),
                Kind::Fault(word) => ("fault", Some(word)),
            };
            let mut row = json!({
                "id": id, "kind": kind, "steps": self.steps(n), "states": n.states, "scans": n.scans,
            });
            if let Some(word) = fault {
                row["fault"] = json!(word);
            }
            row
        };
        let edge = |e: &Edge| {
            let inputs = e.when.as_ref().map(|cubes| self.condition(cubes, usize::MAX));
            let by_itself = e.when.as_ref().map(|cubes| cubes.iter().any(Vec::is_empty));
            json!({
                "from": e.from, "to": e.to, "inputs": inputs, "without_inputs": by_itself,
                "transitions": self.transitions(e),
            })
        };
        let graph = self.graph;
        let mut all = json!({
            "tool": "g7 graph", "file": file, "complete": graph.open.is_none(), "states": graph.states, "scans": graph.scans,
            "nodes": graph.nodes.iter().enumerate().map(node).collect::<Vec<_>>(),
            "edges": graph.edges.iter().map(edge).collect::<Vec<_>>(),
        });
        if let Some(open) = &graph.open {
            let [why, ..] = words::why(&open.reason);
            all["reason"] = json!(why);
        }
        all
    }

    pub(super) fn dot(&self) -> String {
        let mut out = String::from("digraph situations {\n  node [shape=box, fontname=\"sans-serif\"];\n");
        out.push_str("  edge [fontname=\"sans-serif\", fontsize=10];\n");
        for (id, node) in self.graph.nodes.iter().enumerate() {
            let shape = match node.kind {
                Kind::Start => ", shape=point",
                Kind::Situation => "",
                Kind::Fault(_) => ", shape=octagon",
            };
            let tip = format!("states: {}; scans from the start: {}", node.states, node.scans);
            out.push_str(&format!(
                "  n{id} [label={}, tooltip={}{shape}];\n",
                quoted(&self.node(node)),
                quoted(&tip)
            ));
        }
        for e in &self.graph.edges {
            let (label, tip) = (self.label(e), self.transitions(e).join(", "));
            out.push_str(&format!(
                "  n{} -> n{} [label={}, tooltip={}];\n",
                e.from,
                e.to,
                quoted(&label),
                quoted(&tip)
            ));
        }
        out.push_str("}\n");
        out
    }
}

/// Text of a label for Graphviz.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
