//! Reads one SFC routine: its objects, and the lines between them by number.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use g7_model::codes;
use g7_model::{
    Action, Body, Chart, ChartItem, ChartKind, Expr, Layout, Name, NamedAction, Nanos, PlaceAt, Placed,
    Qualifier, Span, Step, Stmt, Target, say,
};
use roxmltree::Node as Element;

use super::dialect::{self, Presets};
use crate::flow::{Flow, Node};
use g7_iec::nodes::{self, Taken};
use g7_iec::report::Report;
use g7_iec::st;
use g7_iec::xml::attr::{self, Text};

pub(super) type Xml<'a> = Element<'a, 'a>;

pub(super) fn kids<'a>(node: Xml<'a>, name: &'static str) -> impl Iterator<Item = Xml<'a>> {
    node.children().filter(move |n| n.has_tag_name(name))
}

pub(super) fn kid<'a>(node: Xml<'a>, name: &'static str) -> Option<Xml<'a>> {
    kids(node, name).next()
}

/// A chart with the names that must be declared for it.
pub(super) struct Read {
    pub(super) chart: Chart,
    pub(super) layout: Layout,
    /// The outputs of Boolean actions: `Action_000.Q`.
    pub(super) flags: Vec<Name>,
}

/// Lines of structured text joined into one text, each with its place.
pub(super) struct Lines {
    text: String,
    pieces: Vec<(usize, Text)>,
}

impl Lines {
    pub(super) fn of(content: Option<Xml>) -> Lines {
        let mut lines = Lines { text: String::new(), pieces: Vec::new() };
        for line in content.into_iter().flat_map(|n| n.descendants()).filter(|n| n.has_tag_name("Line")) {
            let text = attr::content(line);
            let trimmed = text.text.trim_end();
            let start = lines.text.len();
            lines.text.push_str(trimmed);
            lines.text.push('\n');
            lines.pieces.push((start, text));
        }
        lines
    }

    fn place(&self, part: &Range<usize>) -> Range<usize> {
        let find = |byte: usize| {
            let index = self.pieces.partition_point(|(start, _)| *start <= byte).checked_sub(1)?;
            let (start, text) = self.pieces.get(index)?;
            Some(text.place(&(byte - start..byte - start)).start)
        };
        let from = find(part.start).unwrap_or_default();
        from..find(part.end).unwrap_or(from).max(from)
    }

    fn is_empty(&self) -> bool {
        self.text.trim().is_empty()
    }

    /// Parses the lines as statements; `[:=]` is read as an assignment.
    pub(super) fn statements(&self, report: &mut Report) -> Vec<Stmt> {
        let place = |part: Range<usize>| self.place(&part);
        let text = dialect::retentive(&self.text, &place, report);
        st::single::statements(&text, &place, report)
    }

    fn expression(&self, report: &mut Report) -> Expr {
        let place = |part: Range<usize>| self.place(&part);
        st::single::expression(&self.text, &place, report)
    }
}

/// A number of milliseconds.
fn milliseconds(node: Xml, name: &str) -> Option<i64> {
    node.attribute(name)?.trim().parse().ok().filter(|n| (0..=i64::from(i32::MAX)).contains(n))
}

/// Hundredths of the drawing's unit per pixel.
const PER_PIXEL: i32 = 8;

fn spot(node: Xml) -> (i32, i32) {
    let of = |name| node.attribute(name).and_then(|n| n.trim().parse::<i32>().ok()).unwrap_or(0);
    (of("X").clamp(-100_000, 100_000), of("Y").clamp(-100_000, 100_000))
}

fn operand(node: Xml) -> String {
    nodes::line(&node.attribute("Operand").unwrap_or("").replace('`', "'"))
}

/// The description of an element.
pub(super) fn description(node: Xml) -> Option<Box<str>> {
    let text = nodes::line(&attr::content(kid(node, "Description")?).text);
    (!text.is_empty()).then(|| text.into())
}

/// Reads a chart.
pub(super) fn read(content: Xml, title: &str, presets: &mut Presets, report: &mut Report) -> Read {
    let at = report.span(&attr::head(content));
    let mut reader = Reader {
        numbers: HashMap::new(),
        items: Vec::new(),
        places: Vec::new(),
        flags: Vec::new(),
        known: HashSet::new(),
    };
    let mut steps: Vec<(Name, i32)> = Vec::new();
    let mut actions = Vec::new();
    let mut taken = Taken::default();
    for node in content.children().filter(|n| n.has_tag_name("Step") || n.has_tag_name("Stop")) {
        reader.number(node, Node::Step(steps.len()), report);
        let step = reader.step(node, &mut taken, &mut actions, presets, report);
        steps.push((step.name.clone(), spot(node).0));
        reader.items.push(ChartItem::Step(step));
    }
    let transitions: Vec<Xml> = kids(content, "Transition").collect();
    for (index, node) in transitions.iter().enumerate() {
        reader.number(*node, Node::Transition(index), report);
    }
    for (index, branch) in kids(content, "Branch").enumerate() {
        reader.number(branch, Node::Bar(index), report);
        for leg in kids(branch, "Leg") {
            reader.number(leg, Node::Bar(index), report);
        }
        if branch.attribute("Priority").is_some_and(|p| p != "Default") {
            let what =
                say!("priorities of the author's own in a branch; here the branches go from left to right");
            report.say(&codes::DIFFERENT, &attr::head(branch), what);
        }
    }
    let mut texts = Vec::new();
    for node in content.children().filter(Xml::is_element) {
        match node.tag_name().name() {
            "Step" | "Stop" | "Transition" | "Branch" | "DirectedLink" | "Attachment" => {}
            "TextBox" => texts.push(nodes::line(&attr::content(node).text)),
            "SbrRet" => {
                let what = say!("a subroutine's entry and return; the chart runs by itself here");
                report.say(&codes::NOT_CARRIED, &attr::head(node), what);
            }
            tag => report.element(
                &codes::UNKNOWN_ELEMENT,
                tag,
                &attr::head(node),
                say!("the element `{tag}` is not known"),
            ),
        }
    }
    let flow = reader.flow(content, report);
    let places: Vec<Range<usize>> = transitions.iter().map(|n| attr::head(*n)).collect();
    let ends = flow.ends(&places, report);
    // Among the transitions behind one step the leftmost is evaluated first.
    let mut order: Vec<usize> = (0..transitions.len()).collect();
    order.sort_by_key(|i| {
        let first = ends.get(*i).and_then(|e| e.from.first().copied());
        (first, transitions.get(*i).map(|n| spot(*n).0))
    });
    for (number, index) in (0u32..).zip(order) {
        let (Some(node), Some(ends)) = (transitions.get(index), ends.get(index)) else { continue };
        let span = report.span(&attr::head(*node));
        let lines = Lines::of(kid(*node, "Condition"));
        let receptivity = if lines.is_empty() {
            report.say(&codes::BAD_TEXT, &attr::head(*node), say!("a transition without a condition"));
            nodes::bad(span)
        } else {
            lines.expression(report)
        };
        let step = |i: &usize| steps.get(*i).map(|(n, _)| n.clone());
        let from = ends.from.iter().filter_map(step).collect();
        let to = ends.to.iter().filter_map(step).collect();
        let mut transition = nodes::transition(from, to, receptivity, span);
        let label = operand(*node);
        if !label.is_empty() {
            transition.label = Some(Name::new(taken.give(&label), span));
        }
        transition.comment = description(*node);
        reader.place(Placed::TransitionNumber(number), *node, span);
        reader.items.push(ChartItem::Transition(transition));
    }
    reader.items.extend(actions.into_iter().map(ChartItem::Action));
    let chart = Chart {
        params: Vec::new(),
        block: None,
        kind: ChartKind::Chart,
        name: Name::new(title, at),
        comment: (!texts.is_empty()).then(|| texts.join(" / ").into()),
        every: None,
        items: reader.items,
        at: at.into(),
    };
    let layout = Layout { chart: chart.name.clone(), places: reader.places, at: at.into() };
    Read { chart, layout, flags: reader.flags }
}

struct Reader {
    numbers: HashMap<String, Node>,
    items: Vec<ChartItem>,
    places: Vec<PlaceAt>,
    flags: Vec<Name>,
    /// The actions whose bodies are known, in upper case.
    known: HashSet<String>,
}

impl Reader {
    fn number(&mut self, node: Xml, what: Node, report: &mut Report) {
        let number = node.attribute("ID").unwrap_or("").to_string();
        if self.numbers.insert(number, what).is_some() {
            report.say(&codes::TWICE, &attr::head(node), say!("a second object of this number"));
        }
    }

    fn place(&mut self, what: Placed, node: Xml, at: Span) {
        let (x, y) = spot(node);
        self.places.push(PlaceAt {
            what,
            x: x * PER_PIXEL,
            y: y * PER_PIXEL,
            then: Vec::new(),
            at: at.into(),
        });
    }

    fn flow(&self, content: Xml, report: &mut Report) -> Flow {
        let mut flow = Flow::default();
        for link in kids(content, "DirectedLink") {
            let at = attr::head(link);
            let find = |name: &str| link.attribute(name).and_then(|n| self.numbers.get(n)).copied();
            match (find("FromID"), find("ToID")) {
                (Some(from), Some(to)) => flow.line(from, to, &at, report),
                _ => report.say(&codes::BAD_LINK, &at, say!("a link from or to an object that is not there")),
            }
        }
        flow
    }

    fn step(
        &mut self,
        node: Xml,
        taken: &mut Taken,
        actions: &mut Vec<NamedAction>,
        presets: &mut Presets,
        report: &mut Report,
    ) -> Step {
        let range = attr::head(node);
        let at = report.span(&range);
        let mut own = operand(node);
        if own.is_empty() {
            own = format!("Step{}", nodes::line(node.attribute("ID").unwrap_or("")));
        }
        let wanted = std::mem::take(&mut own);
        own = taken.give(&wanted);
        if own != wanted {
            report.say(&codes::RENAMED, &range, say!("a second step `{wanted}`; it is called `{own}`"));
        }
        if let Some(ms) = milliseconds(node, "Preset") {
            presets.steps.insert(own.to_uppercase(), ms);
        } else {
            presets.steps.entry(own.to_uppercase()).or_insert(0);
        }
        let initial = node.attribute("InitialStep").is_some_and(|w| w == "true");
        let mut step = nodes::step(Name::new(own, at), initial, at);
        step.comment = description(node);
        self.place(Placed::Step(step.name.clone()), node, at);
        for action in kids(node, "Action") {
            step.actions.extend(self.action(action, actions, presets, report));
        }
        step.braces = !step.actions.is_empty();
        step
    }

    fn action(
        &mut self,
        node: Xml,
        actions: &mut Vec<NamedAction>,
        presets: &Presets,
        report: &mut Report,
    ) -> Option<Action> {
        let range = attr::head(node);
        let at = report.span(&range);
        let word = node.attribute("Qualifier").unwrap_or("NonStored");
        let Some(qualifier) = qualifier(word) else {
            report.say(&codes::BAD_VALUE, &range, say!("the qualifier `{}` is not known", nodes::line(word)));
            return None;
        };
        let own = operand(node);
        let name = Name::new(own.as_str(), at);
        let ms = milliseconds(node, "Preset").or_else(|| presets.actions.get(&own.to_uppercase()).copied());
        let time = qualifier.timed().then(|| nodes::time(Nanos::from_millis(ms.unwrap_or(0)), at));
        if qualifier.timed() && node.attribute("PresetUsesExpr").is_some_and(|w| w == "true") {
            report.say(
                &codes::NOT_CARRIED,
                &range,
                say!("a time that is an expression; it is constant here"),
            );
        }
        if node.attribute("IsBoolean").is_some_and(|w| w == "true") {
            let flag = Name::new(format!("{own}.Q"), at);
            let path = g7_model::Path { names: vec![flag.clone()] };
            self.flags.push(flag);
            return Some(nodes::qualified(qualifier, time, Target::Path(path), None, at));
        }
        let body = kid(node, "Body");
        if self.known.insert(own.to_uppercase()) {
            for other in body
                .into_iter()
                .flat_map(|n| n.children())
                .filter(|n| n.is_element() && !n.has_tag_name("STContent"))
            {
                let what = say!("`{}` in an action has no counterpart", other.tag_name().name());
                report.say(&codes::NOT_CARRIED, &attr::head(other), what);
            }
            let statements = Lines::of(body).statements(report);
            let body = Body::St(nodes::block(statements, at));
            actions.push(NamedAction { name: name.clone(), comment: description(node), body, at: at.into() });
        }
        let path = g7_model::Path { names: vec![name] };
        Some(nodes::qualified(qualifier, time, Target::Path(path), None, at))
    }
}

/// A qualifier by its long name or its letters.
fn qualifier(word: &str) -> Option<Qualifier> {
    let plain: String = word.chars().filter(|c| c.is_ascii_alphanumeric()).collect();
    let plain = plain.to_ascii_lowercase().replace("and", "");
    Some(match plain.as_str() {
        "nonstored" | "n" => Qualifier::N,
        "stored" | "set" | "s" => Qualifier::S,
        "reset" | "r" => Qualifier::R,
        "timelimited" | "limited" | "l" => Qualifier::L,
        "timedelayed" | "delayed" | "d" => Qualifier::D,
        "pulse" | "p" => Qualifier::P,
        "pulserisingedge" | "pulserising" | "p1" => Qualifier::P1,
        "pulsefallingedge" | "pulsefalling" | "p0" => Qualifier::P0,
        "storedtimelimited" | "sl" => Qualifier::SL,
        "storedtimedelayed" | "sd" => Qualifier::SD,
        "timedelayedstored" | "delayedstored" | "ds" => Qualifier::DS,
        _ => return None,
    })
}
