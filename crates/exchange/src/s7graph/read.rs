//! Reads the elements of a GRAPH block. Its parts have name spaces of several versions, so only
//! local names count.

use std::collections::HashMap;
use std::ops::Range;

use g7_model::{codes, say};
use roxmltree::Node as Element;

use crate::flow::{Ends, Flow, Node};
use g7_iec::nodes;
use g7_iec::report::Report;
use g7_iec::xml::attr;

pub(super) type Xml<'a> = Element<'a, 'a>;

/// The direct children with this name.
pub(super) fn kids<'a>(node: Xml<'a>, name: &'static str) -> impl Iterator<Item = Xml<'a>> {
    node.children().filter(move |n| n.is_element() && n.tag_name().name() == name)
}

pub(super) fn kid<'a>(node: Xml<'a>, name: &'static str) -> Option<Xml<'a>> {
    kids(node, name).next()
}

/// The text in the first language that has one.
pub(super) fn words(node: Option<Xml>) -> String {
    let texts =
        node.into_iter().flat_map(|n| n.descendants()).filter(|n| n.tag_name().name() == "MultiLanguageText");
    texts.map(|n| nodes::line(&attr::content(n).text)).find(|t| !t.is_empty()).unwrap_or_default()
}

/// A step.
pub(super) struct StepNode<'a> {
    pub(super) name: String,
    pub(super) initial: bool,
    pub(super) node: Xml<'a>,
    pub(super) at: Range<usize>,
}

/// A transition.
pub(super) struct TransitionNode<'a> {
    pub(super) label: String,
    pub(super) node: Xml<'a>,
    pub(super) ends: Ends,
    pub(super) at: Range<usize>,
}

/// One sequence.
pub(super) struct Sequence<'a> {
    pub(super) title: String,
    pub(super) steps: Vec<StepNode<'a>>,
    pub(super) transitions: Vec<TransitionNode<'a>>,
    pub(super) at: Range<usize>,
}

/// Reads a `Sequence` element.
pub(super) fn sequence<'a>(node: Xml<'a>, report: &mut Report) -> Sequence<'a> {
    let mut numbers: HashMap<(&'static str, String), Node> = HashMap::new();
    let mut steps: Vec<StepNode> = Vec::new();
    for step in kid(node, "Steps").into_iter().flat_map(|n| kids(n, "Step")) {
        let at = attr::head(step);
        let number = step.attribute("Number").unwrap_or("").to_string();
        let name = nodes::line(&step.attribute("Name").unwrap_or("").replace('`', "'"));
        let name = if name.is_empty() { number.clone() } else { name };
        if numbers.insert(("Step", number), Node::Step(steps.len())).is_some() {
            report.say(&codes::TWICE, &at, say!("a second step of this number"));
        }
        let initial = step.attribute("Init").is_some_and(|w| w == "true");
        steps.push(StepNode { name, initial, node: step, at });
    }
    let mut transitions: Vec<TransitionNode> = Vec::new();
    for transition in kid(node, "Transitions").into_iter().flat_map(|n| kids(n, "Transition")) {
        let at = attr::head(transition);
        let number = transition.attribute("Number").unwrap_or("").to_string();
        if numbers.insert(("Transition", number), Node::Transition(transitions.len())).is_some() {
            report.say(&codes::TWICE, &at, say!("a second transition of this number"));
        }
        let label = nodes::line(&transition.attribute("Name").unwrap_or("").replace('`', "'"));
        transitions.push(TransitionNode { label, node: transition, ends: Ends::default(), at });
    }
    for (index, branch) in kid(node, "Branches").into_iter().flat_map(|n| kids(n, "Branch")).enumerate() {
        let number = branch.attribute("Number").unwrap_or("").to_string();
        numbers.insert(("Branch", number), Node::Bar(index));
    }
    let flow = connections(node, &numbers, report);
    let places: Vec<Range<usize>> = transitions.iter().map(|t| t.at.clone()).collect();
    for (transition, ends) in transitions.iter_mut().zip(flow.ends(&places, report)) {
        transition.ends = ends;
    }
    // Among the transitions behind one step the left one is evaluated first.
    let order = flow.order(steps.len(), transitions.len());
    let mut ordered: Vec<(Option<(usize, usize)>, TransitionNode)> =
        order.into_iter().zip(transitions).collect();
    ordered.sort_by_key(|(place, _)| (place.is_none(), *place));
    let transitions = ordered.into_iter().map(|(_, t)| t).collect();
    Sequence { title: words(kid(node, "Title")), steps, transitions, at: attr::head(node) }
}

/// Reads the lines; `EndConnection` leads to the end of the sequence.
fn connections(node: Xml, numbers: &HashMap<(&'static str, String), Node>, report: &mut Report) -> Flow {
    let mut flow = Flow::default();
    let mut list: Vec<Xml> =
        kid(node, "Connections").into_iter().flat_map(|n| kids(n, "Connection")).collect();
    // The lines of a branch are sorted from left to right.
    list.sort_by_key(|n| {
        let branch = n.descendants().find(|d| d.tag_name().name() == "BranchRef");
        branch.and_then(|b| b.attribute("Out")).and_then(|o| o.trim().parse::<u32>().ok())
    });
    for connection in list {
        let at = attr::head(connection);
        let end = |tag: &'static str| kid(connection, tag).and_then(|n| n.children().find(Xml::is_element));
        let find = |n: Xml| {
            let number = n.attribute("Number").unwrap_or("").to_string();
            let kind = match n.tag_name().name() {
                "StepRef" => "Step",
                "TransitionRef" => "Transition",
                "BranchRef" => "Branch",
                _ => return None,
            };
            numbers.get(&(kind, number)).copied()
        };
        let (Some(from), Some(to)) = (end("NodeFrom"), end("NodeTo")) else {
            report.say(&codes::OPEN_LINK, &at, say!("a connection without its ends"));
            continue;
        };
        // The end of a sequence: no step is active afterwards.
        if to.tag_name().name() == "EndConnection" {
            continue;
        }
        match (find(from), find(to)) {
            (Some(from), Some(to)) => flow.line(from, to, &at, report),
            _ => {
                report.say(&codes::BAD_LINK, &at, say!("a connection from or to something that is not there"))
            }
        }
    }
    flow
}
