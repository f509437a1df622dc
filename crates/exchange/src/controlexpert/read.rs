//! The objects of each chart, with their places on the grid.

use std::ops::Range;

use g7_model::{Said, codes, say};
use roxmltree::Node;

use g7_iec::nodes;
use g7_iec::report::Report;
use g7_iec::xml::attr::{self, Text};

/// A cell of the grid.
pub(super) type Spot = (i32, i32);

/// The kind of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StepSort {
    Plain,
    Initial,
    Macro,
    In,
    Out,
}

/// An action of a step.
#[derive(Debug)]
pub(super) struct ActionNode {
    pub(super) qualifier: String,
    /// The name of the variable, or of the action section if `section`.
    pub(super) name: Text,
    pub(super) section: bool,
    pub(super) time: Text,
    pub(super) at: Range<usize>,
}

/// A step.
#[derive(Debug)]
pub(super) struct StepNode {
    pub(super) name: String,
    pub(super) sort: StepSort,
    pub(super) spot: Spot,
    pub(super) actions: Vec<ActionNode>,
    pub(super) delay: Option<Range<usize>>,
    pub(super) comment: String,
    pub(super) at: Range<usize>,
}

/// The condition of a transition.
#[derive(Debug)]
pub(super) enum Condition {
    /// A variable or a constant, as text.
    Text(Text),
    /// A transition section.
    Section(Text),
    None,
}

/// A transition.
#[derive(Debug)]
pub(super) struct TransitionNode {
    pub(super) spot: Spot,
    pub(super) condition: Condition,
    pub(super) inverted: bool,
    pub(super) comment: String,
    pub(super) at: Range<usize>,
}

/// The beginning or end of branches.
#[derive(Debug)]
pub(super) struct BarNode {
    pub(super) opens: bool,
    pub(super) parallel: bool,
    pub(super) spot: Spot,
    pub(super) width: i32,
    /// The column of its single line, counted from its left end. The line is above the bar, or
    /// below it if the bar ends branches.
    pub(super) stem: i32,
    pub(super) at: Range<usize>,
}

/// A jump to a step.
#[derive(Debug)]
pub(super) struct JumpNode {
    pub(super) to: String,
    pub(super) spot: Spot,
    pub(super) at: Range<usize>,
}

/// A drawn link.
#[derive(Debug)]
pub(super) struct LinkNode {
    pub(super) from: (String, Spot),
    pub(super) to: (String, Spot),
    pub(super) at: Range<usize>,
}

/// One chart.
#[derive(Debug, Default)]
pub(super) struct Sheet<'a> {
    pub(super) name: String,
    /// True within a macro-step.
    pub(super) inner: bool,
    pub(super) steps: Vec<StepNode>,
    pub(super) transitions: Vec<TransitionNode>,
    pub(super) bars: Vec<BarNode>,
    pub(super) jumps: Vec<JumpNode>,
    pub(super) links: Vec<LinkNode>,
    pub(super) texts: Vec<String>,
    /// The sections of actions and transitions that belong to it.
    pub(super) sections: Vec<Node<'a, 'a>>,
    /// True if the chart has macro-steps: their expansions use its sections too.
    pub(super) shared: bool,
    pub(super) at: Range<usize>,
}

pub(super) fn kids<'a>(node: Node<'a, 'a>, name: &'static str) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(move |n| n.has_tag_name(name))
}

pub(super) fn kid<'a>(node: Node<'a, 'a>, name: &'static str) -> Option<Node<'a, 'a>> {
    kids(node, name).next()
}

/// The text of an element on one line.
pub(super) fn line(node: Option<Node>) -> String {
    node.map_or_else(String::new, |n| nodes::line(&attr::content(n).text))
}

/// All charts of a file, including the contents of macro-steps.
pub(super) fn sheets<'a>(root: Node<'a, 'a>, report: &mut Report) -> Vec<Sheet<'a>> {
    let mut sheets = Vec::new();
    let mut programs: Vec<Node> = root.descendants().filter(|n| n.has_tag_name("SFCProgram")).collect();
    if programs.is_empty() {
        // A part of a file: charts without the program around them.
        programs.extend(root.descendants().filter(|n| kid(*n, "chartSource").is_some()));
    }
    if programs.is_empty() {
        let networks = root.descendants().filter(|n| n.has_tag_name("networkSFC"));
        return networks.map(|network| sheet(network, report)).collect();
    }
    for program in programs {
        let ident = kid(program, "identProgram");
        let name = ident.and_then(|n| n.attribute("name")).unwrap_or("");
        let mut first = true;
        let drawn = |n: &Node| kid(*n, "networkSFC").is_some();
        let shared = kids(program, "chartSource").filter(drawn).nth(1).is_some();
        for chart in kids(program, "chartSource") {
            let Some(network) = kid(chart, "networkSFC") else { continue };
            let own = chart.attribute("name").unwrap_or("");
            let wanted = if first { name } else { own };
            let mut sheet = sheet(network, report);
            sheet.name = nodes::line(&wanted.replace('`', "'"));
            sheet.inner = !first;
            sheet.shared = shared;
            if first {
                let sources = |n: &Node| n.has_tag_name("actionSource") || n.has_tag_name("transitionSource");
                sheet.sections = program.children().filter(sources).collect();
            }
            first = false;
            sheets.push(sheet);
        }
    }
    sheets
}

fn sheet<'a>(network: Node<'a, 'a>, report: &mut Report) -> Sheet<'a> {
    let mut sheet = Sheet { at: attr::head(network), ..Sheet::default() };
    for node in network.children().filter(Node::is_element) {
        let at = attr::head(node);
        let spot = spot(node);
        match node.tag_name().name() {
            "step" => sheet.steps.push(step(node, spot, report)),
            "transition" => sheet.transitions.push(transition(node, spot)),
            "altBranch" | "parBranch" => sheet.bars.push(bar(node, spot, true)),
            "altJoint" | "parJoint" => sheet.bars.push(bar(node, spot, false)),
            "jumpSFC" => {
                let to = node.attribute("stepName").unwrap_or("").to_string();
                sheet.jumps.push(JumpNode { to, spot, at });
            }
            "linkSFC" => sheet.links.extend(link(node, report)),
            "textBox" => {
                let text: String = node.children().filter_map(|n| n.text()).collect();
                sheet.texts.push(nodes::line(&text));
            }
            "comment" => sheet.texts.push(line(Some(node))),
            tag => {
                report.element(&codes::UNKNOWN_ELEMENT, tag, &at, say!("the element `{tag}` is not known"));
            }
        }
    }
    sheet
}

/// A coordinate of the grid; real drawings are far smaller than the limit.
fn number(text: Option<&str>) -> Option<i32> {
    let text = text?.trim();
    let whole = text.split('.').next().unwrap_or(text);
    whole.parse().ok().filter(|n| (-100_000..=100_000).contains(n))
}

fn spot(node: Node) -> Spot {
    let place = node.children().find(|n| n.has_tag_name("objPosition"));
    let of = |name| place.and_then(|p| number(p.attribute(name))).unwrap_or(0);
    (of("posX"), of("posY"))
}

fn step(node: Node, spot: Spot, report: &mut Report) -> StepNode {
    let at = attr::head(node);
    let sort = match node.attribute("stepType") {
        Some("initialStep") => StepSort::Initial,
        Some("macroStep") => StepSort::Macro,
        Some("inStep") => StepSort::In,
        Some("outStep") => StepSort::Out,
        Some("step") | None => StepSort::Plain,
        Some(other) => {
            let what = say!("a step of the type `{other}`, which is not known; it is a plain step");
            report.say(&codes::UNKNOWN_ELEMENT, &at, what);
            StepSort::Plain
        }
    };
    let name = node.attribute("stepName").unwrap_or("").to_string();
    let mut delay = None;
    for literals in node.children().filter(|n| n.has_tag_name("literals")) {
        let set = |name: &str| literals.attribute_node(name).filter(|a| !a.value().trim().is_empty());
        delay = set("delay").map(|a| a.range_value());
        for (word, what) in [("min", say!("shortest")), ("max", say!("longest"))] {
            if let Some(attribute) = set(word) {
                let what = say!(
                    "the {what} time of step `{}` is only watched, and left out: {}",
                    nodes::line(&name),
                    Said::foreign(nodes::line(attribute.value()))
                );
                report.say(&codes::LEFT_OUT, &attribute.range_value(), what);
            }
        }
    }
    let actions = node.children().filter(|n| n.has_tag_name("action")).map(action).collect();
    let comment = line(node.children().find(|n| n.has_tag_name("comment")));
    StepNode { name, sort, spot, actions, delay, comment, at }
}

fn action(node: Node) -> ActionNode {
    let named = node.children().find(|n| n.has_tag_name("actionName"));
    let inner = named.and_then(|n| n.children().find(Node::is_element));
    let time = node.children().find(|n| n.has_tag_name("tValue"));
    let time = time.and_then(|n| n.children().find(Node::is_element));
    ActionNode {
        qualifier: node.attribute("qualifier").unwrap_or("NONE").trim().to_ascii_uppercase(),
        name: inner.map(attr::content).unwrap_or_default(),
        section: inner.is_some_and(|n| n.has_tag_name("sectionName")),
        time: time.map(attr::content).unwrap_or_default(),
        at: attr::head(node),
    }
}

fn transition(node: Node, spot: Spot) -> TransitionNode {
    let inner = node.children().find(|n| n.has_tag_name("transitionCondition"));
    let what = inner.and_then(|n| n.children().find(Node::is_element));
    let condition = match what {
        Some(n) if n.has_tag_name("sectionName") => Condition::Section(attr::content(n)),
        Some(n) => Condition::Text(attr::content(n)),
        None => Condition::None,
    };
    TransitionNode {
        spot,
        condition,
        inverted: inner.and_then(|n| n.attribute("invertLogic")).is_some_and(|w| w.trim() == "true"),
        comment: line(node.children().find(|n| n.has_tag_name("comment"))),
        at: attr::head(node),
    }
}

fn bar(node: Node, spot: Spot, opens: bool) -> BarNode {
    BarNode {
        opens,
        parallel: node.tag_name().name().starts_with("par"),
        spot,
        width: number(node.attribute("width")).unwrap_or(1).clamp(1, 1000),
        stem: number(node.attribute("relativePos")).unwrap_or(0),
        at: attr::head(node),
    }
}

fn link(node: Node, report: &mut Report) -> Option<LinkNode> {
    let end = |tag: &str| {
        let end = node.children().find(|n| n.has_tag_name(tag))?;
        Some((end.attribute("objectType").unwrap_or("").to_string(), spot(end)))
    };
    let at = attr::head(node);
    match (end("directedLinkSource"), end("directedLinkDestination")) {
        (Some(from), Some(to)) => Some(LinkNode { from, to, at }),
        _ => {
            report.say(&codes::OPEN_LINK, &at, say!("a link without its ends"));
            None
        }
    }
}
