//! A drawing as objects and wires. Wires are stored backwards: the object that receives a value or
//! a flow names the object that gives it.

use std::collections::HashMap;
use std::ops::Range;

use g7_model::{Said, codes, say};

use super::tree::{self, Xml, head, kid, kids, tag, word};
use crate::report::Report;
use crate::xml::attr::{self, Text};

/// A drawing: the body of a POU, an action or a transition.
#[derive(Default)]
pub(super) struct Graph<'a> {
    pub(super) objects: Vec<Object<'a>>,
    /// Connectors by name; a continuation takes its flow from the connector with its name.
    connectors: HashMap<String, usize>,
}

/// An object of the drawing.
pub(super) struct Object<'a> {
    /// `step`, `contact`, `block`, …
    pub(super) kind: String,
    pub(super) node: Xml<'a>,
    pub(super) inputs: Vec<Input>,
}

/// A connection point of an object where wires end.
pub(super) struct Input {
    pub(super) slot: Slot,
    pub(super) negated: bool,
    pub(super) edge: Edge,
    pub(super) wires: Vec<Wire>,
    /// A value written at the pin instead of a wire.
    pub(super) value: Option<Text>,
    pub(super) at: Range<usize>,
}

/// The kind of connection point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    /// The object's own connection point.
    Flow,
    /// The condition of a transition.
    Condition,
    /// An input of a block.
    Pin(String),
}

/// The edge of a signal that is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edge {
    Level,
    Rising,
    Falling,
}

/// A wire, described at its end.
#[derive(Clone)]
pub(super) struct Wire {
    /// The index of the object where it begins.
    pub(super) from: usize,
    /// The output of that object, if it has several.
    pub(super) pin: String,
}

/// The reference of a `Connection`, before all objects are known.
struct Loose {
    object: usize,
    input: usize,
    id: Text,
    pin: String,
}

impl<'a> Graph<'a> {
    /// Reads the objects within a body.
    pub(super) fn read(body: Xml<'a>, report: &mut Report) -> Graph<'a> {
        let mut reader = Reader::default();
        reader.objects(body, report);
        reader.join(report);
        reader.graph
    }

    pub(super) fn get(&self, index: usize) -> Option<&Object<'a>> {
        self.objects.get(index)
    }

    /// The connector from which a continuation takes its flow.
    pub(super) fn connector(&self, continuation: &Object) -> Option<usize> {
        let name = word(continuation.node, "name").or_else(|| word(continuation.node, "label"))?;
        self.connectors.get(name).copied()
    }
}

impl Object<'_> {
    /// The wires that end at the object's own connection points.
    pub(super) fn flow(&self) -> impl Iterator<Item = &Wire> {
        self.inputs.iter().filter(|i| i.slot == Slot::Flow).flat_map(|i| &i.wires)
    }

    /// The text of its `expression` or `variable` element, or the corresponding attribute of IEC
    /// 61131-10.
    pub(super) fn text(&self) -> Option<Text> {
        let inner = kid(self.node, "expression").or_else(|| kid(self.node, "variable")).map(attr::content);
        let written = inner.filter(|t| !t.text.trim().is_empty());
        let known = || ["identifier", "operand", "variable"].iter().find_map(|n| tree::text(self.node, n));
        written.or_else(known)
    }

    pub(super) fn edge(&self) -> Edge {
        edge(self.node)
    }
}

fn edge(node: Xml) -> Edge {
    match word(node, "edge") {
        Some("rising") => Edge::Rising,
        Some("falling") => Edge::Falling,
        _ => Edge::Level,
    }
}

#[derive(Default)]
struct Reader<'a> {
    graph: Graph<'a>,
    /// Objects by `localId`.
    ids: HashMap<String, usize>,
    /// Connection points by `connectionPointOutId`, with the name of the pin.
    points: HashMap<String, (usize, String)>,
    loose: Vec<Loose>,
}

impl<'a> Reader<'a> {
    fn objects(&mut self, body: Xml<'a>, report: &mut Report) {
        for child in kids(body) {
            match tag(child).as_str() {
                "network" => self.objects(child, report),
                "addData" | "documentation" | "addDataInfo" => {}
                _ => self.object(child, report),
            }
        }
    }

    fn object(&mut self, node: Xml<'a>, report: &mut Report) {
        let kind = tag(node);
        let index = self.graph.objects.len();
        if let Some(id) = word(node, "localId")
            && self.ids.insert(id.to_string(), index).is_some()
        {
            let what = say!("a second object has the localId {}", Said::foreign(id));
            report.element(&codes::BAD_LINK, "localId", &head(node), what);
        }
        if kind == "connector"
            && let Some(name) = word(node, "name").or_else(|| word(node, "label"))
        {
            self.graph.connectors.insert(name.to_string(), index);
        }
        self.graph.objects.push(Object { kind, node, inputs: Vec::new() });
        self.pins(node, index, &Slot::Flow);
    }

    /// Collects all points of an object at which a wire can end or begin.
    fn pins(&mut self, node: Xml<'a>, object: usize, slot: &Slot) {
        for child in kids(node) {
            match tag(child).as_str() {
                "connectionPointIn" => self.input(child, node, object, slot.clone()),
                "condition" => {
                    self.pins(child, object, &Slot::Condition);
                    // The first edition has its wires directly here.
                    if kid(child, "connection").is_some() {
                        self.input(child, child, object, Slot::Condition);
                    }
                }
                "inputVariables" | "outputVariables" | "inOutVariables" => self.pins(child, object, slot),
                "variable" => {
                    let name = word(child, "formalParameter").or_else(|| word(child, "parameterName"));
                    self.pins(child, object, &Slot::Pin(name.unwrap_or("").to_string()));
                }
                "connectionPointOut" | "connectionPointOutAction" => {
                    let pin = match slot {
                        Slot::Pin(name) => name.clone(),
                        _ => word(child, "formalParameter").unwrap_or("").to_string(),
                    };
                    if let Some(id) = word(child, "connectionPointOutId") {
                        self.points.insert(id.to_string(), (object, pin));
                    }
                }
                _ => {}
            }
        }
    }

    fn input(&mut self, point: Xml<'a>, owner: Xml<'a>, object: usize, slot: Slot) {
        let input = self.graph.objects.get(object).map_or(0, |o| o.inputs.len());
        for wire in kids(point).filter(|n| tag(*n) == "connection") {
            let pin = word(wire, "formalParameter").unwrap_or("").to_string();
            let id = tree::text(wire, "refLocalId").or_else(|| tree::text(wire, "refConnectionPointOutId"));
            if let Some(id) = id {
                self.loose.push(Loose { object, input, id, pin });
            }
        }
        let pin = matches!(slot, Slot::Pin(_));
        let value = kid(point, "expression").map(attr::content).filter(|t| !t.text.trim().is_empty());
        let read = Input {
            negated: (pin || slot == Slot::Condition) && tree::flag(owner, "negated"),
            edge: if pin { edge(owner) } else { Edge::Level },
            slot,
            wires: Vec::new(),
            value,
            at: head(point),
        };
        if let Some(known) = self.graph.objects.get_mut(object) {
            known.inputs.push(read);
        }
    }

    /// Finds the object at the beginning of every wire.
    fn join(&mut self, report: &mut Report) {
        for loose in std::mem::take(&mut self.loose) {
            let id = loose.id.text.trim();
            let known = self.ids.get(id).map(|i| (*i, loose.pin.clone()));
            let Some((from, pin)) = known.or_else(|| self.points.get(id).cloned()) else {
                let what = say!("a wire comes from the object {}, which is not there", Said::foreign(id));
                report.say(&codes::BAD_LINK, &loose.id.at, what);
                continue;
            };
            let input = self.graph.objects.get_mut(loose.object).and_then(|o| o.inputs.get_mut(loose.input));
            if let Some(input) = input {
                input.wires.push(Wire { from, pin });
            }
        }
    }
}
