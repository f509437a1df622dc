//! Writes a chart as the content of a workspace: steps, transitions, bars and lines.

use g7_model::{Chart, ChartItem, Name, Nanos, Step, StepKind, Transition, say};

use super::Writer;
use super::guards::{Shown, encloses};
use super::lookup::is_name;
use super::symbols::{self, Places, Port, Spot};
use super::text::Speech;
use super::window;
use g7_iec::xml::element::Element;

/// The kind of a step in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sort {
    Plain,
    Initial,
    Enter,
    Exit,
    /// A macro-step with its chart.
    Macro(usize),
    /// A step that is not written, because reading the file makes it again.
    Unwritten,
}

/// A step that is written.
struct Node {
    id: String,
    sort: Sort,
    at: Spot,
}

/// The elements of a workspace, and its lines, which come after them.
type Content = (Vec<Element>, Vec<Element>);

/// An end of a line: the identifier and the port.
type End = (String, Port);

impl<'d> Writer<'d> {
    /// The content of a chart's workspace.
    pub(super) fn workspace(&mut self, index: usize) -> Content {
        self.order.push(index);
        let Some(chart) = self.look.charts.get(index).copied() else { return Content::default() };
        let places = Places::of(self.document, chart);
        self.spots.insert(index, places.steps.clone());
        let mut parts = Vec::new();
        let mut nth = 0;
        if index == self.look.top {
            self.variables(None, places.beside, &mut nth, &mut parts);
        }
        self.variables(Some(index), places.beside, &mut nth, &mut parts);
        self.chart_items(index, chart);
        let nodes = self.steps(index, chart, &places, &mut parts);
        let mut links = Vec::new();
        for (number, transition) in chart.transitions().enumerate() {
            let at = places.transitions.get(number).copied().unwrap_or_default();
            self.transition((index, number), transition, at, &nodes, (&mut parts, &mut links));
        }
        let above = chart.comment.as_ref().map(|c| (c.to_string(), (0, -60)));
        for (text, at) in above.into_iter().chain(places.comments) {
            parts.push(free_text(&text, at));
        }
        (parts, links)
    }

    /// A chart other than the first one, as a workspace object.
    pub(super) fn object(&mut self, index: usize) -> Element {
        let Some(chart) = self.look.charts.get(index).copied() else {
            return Element::new("WorkspaceObject");
        };
        if !is_name(&chart.name.text) {
            // No text can name its content, but nothing else is wrong.
            self.say(
                &g7_model::codes::DIFFERENT,
                chart.name.at,
                say!("texts of JGrafchart cannot hold this name"),
            );
        }
        let every = chart.every.unwrap_or(self.scan);
        let cycle = every.count().checked_div(self.scan.count()).unwrap_or(1).max(1);
        if every.whole(self.scan.max(Nanos::new(1))).is_none() {
            self.cannot(chart.at, say!("a period that is no multiple of the scan time"));
        }
        let nth = self.order.len();
        let inside = self.inner(index);
        let element = Element::new("WorkspaceObject")
            .with("enabled", 1)
            .with("fileName", "")
            .with("horizontalScrollBar", 1)
            .with("name", &chart.name.text)
            .with("ownerClass", "")
            .with("scanCycle", cycle)
            .with("useIcon", 0)
            .with("verticalScrollBar", 1)
            .child(inside);
        let row = i32::try_from(nth).unwrap_or(0).saturating_mul(100);
        symbols::placed(element, (-200, row), (60, 60))
    }

    /// The workspace within an element.
    fn inner(&mut self, index: usize) -> Element {
        let (parts, links) = self.workspace(index);
        let element = Element::new("GCDocument").with("color", -1).with("socketSendMode", "Inherit");
        window(element).children(parts).children(links)
    }

    /// Reports items of a chart other than variables, steps and transitions.
    fn chart_items(&mut self, index: usize, chart: &'d Chart) {
        let period = match self.look.owner.get(index).copied().flatten() {
            Some((owner, _)) => self.look.charts.get(owner).and_then(|c| c.every),
            None if index == self.look.top => None,
            None => chart.every,
        };
        if chart.every.is_some_and(|every| every != self.scan) && chart.every != period {
            self.cannot(chart.at, say!("a period of such a chart"));
        }
        for item in &chart.items {
            match item {
                ChartItem::Action(a) => self.cannot(a.at, say!("a named action")),
                ChartItem::Section(s) => self.cannot(s.at, say!("a transition section")),
                ChartItem::Post(_, at) => self.cannot(*at, say!("processing behind the evolution")),
                ChartItem::Var(_) | ChartItem::Step(_) | ChartItem::Transition(_) | ChartItem::Pre(..) => {}
            }
        }
    }

    fn steps(
        &mut self,
        index: usize,
        chart: &'d Chart,
        places: &Places,
        parts: &mut Vec<Element>,
    ) -> Vec<Node> {
        let mut nodes = Vec::new();
        let mut unnamed = 0;
        for (number, step) in chart.steps().enumerate() {
            let sort = self.sort(index, number, chart, step);
            let at = places.steps.get(number).copied().unwrap_or_default();
            let id = self.id();
            nodes.push(Node { id: id.clone(), sort, at });
            if sort == Sort::Unwritten {
                continue;
            }
            if step.comment.is_some() {
                self.leave_out(step.at, say!("the comment of a step"));
            }
            let tag = match sort {
                Sort::Initial => "GCInitialStep",
                Sort::Enter => "EnterStep",
                Sort::Exit => "ExitStep",
                Sort::Macro(_) => "MacroStep",
                Sort::Plain | Sort::Unwritten => "GCStep",
            };
            let mut name = self.look.step_name((index, number)).to_string();
            if name == format!("#{unnamed}") {
                // JGrafchart's name for a step without a name.
                unnamed += 1;
                name.clear();
            }
            let actions = self.actions((index, number), &step.actions);
            let element = Element::new(tag)
                .with("actionText", actions)
                .with("fileName", "")
                .with("id", id)
                .with("name", name)
                .with("useIcon", 0);
            parts.push(match sort {
                Sort::Macro(inside) => {
                    self.call_inside(chart, step, inside);
                    symbols::macro_step(element.with("resumeMode", "Default"), at).child(self.inner(inside))
                }
                _ => symbols::step(element.with("actionBlockVisible", 1), at),
            });
        }
        nodes
    }

    /// In JGrafchart an expansion has the name of its macro-step.
    fn call_inside(&mut self, chart: &Chart, step: &Step, inside: usize) {
        let name = self.look.charts.get(inside).map(|c| &c.name);
        let Some(name) = name.filter(|n| n.text != step.name.text).cloned() else { return };
        if *name.text != format!("{}_{}", chart.name.text, step.name.text) {
            let what = say!("`{}` is called as its macro-step there: `{}`", name.text, step.name.text);
            self.say(&g7_model::codes::RENAMED, name.at, what);
        }
    }

    fn sort(&mut self, index: usize, number: usize, chart: &Chart, step: &Step) -> Sort {
        let inside = self.look.inside_of((index, number));
        let nested = self.look.owner.get(index).copied().flatten().is_some();
        if step.initial && (nested || step.kind != StepKind::Plain) {
            self.cannot(step.at, say!("an initial macro-step, enclosing step or step in a macro-step"));
        }
        match &step.kind {
            StepKind::Macro(_) => match inside {
                Some(inside) if self.depth(inside) < MOST_NESTED => Sort::Macro(inside),
                _ => {
                    self.cannot(
                        step.at,
                        say!("a second macro-step with this expansion, or one nested so deep"),
                    );
                    Sort::Plain
                }
            },
            StepKind::Enclosing => match inside.filter(|_| encloses(step).is_some()) {
                Some(inside) if self.depth(inside) < MOST_NESTED => Sort::Macro(inside),
                _ => {
                    self.cannot(step.at, say!("an enclosing step"));
                    Sort::Plain
                }
            },
            StepKind::Entry => Sort::Enter,
            StepKind::Exit if unreached(chart, step) => Sort::Unwritten,
            StepKind::Exit => Sort::Exit,
            StepKind::Plain if nested && step.linked => Sort::Enter,
            StepKind::Plain if self.guards.exits.get(&index).is_some_and(|e| e.contains(&number)) => {
                Sort::Exit
            }
            StepKind::Plain if step.initial && !nested => Sort::Initial,
            StepKind::Plain => Sort::Plain,
        }
    }

    /// The number of workspaces around that of a chart.
    fn depth(&self, index: usize) -> usize {
        let mut here = index;
        let mut depth = 0;
        while let Some((owner, _)) = self.look.owner.get(here).copied().flatten() {
            here = owner;
            depth += 1;
            if depth > MOST_NESTED {
                break;
            }
        }
        depth
    }

    fn transition(
        &mut self,
        (index, number): (usize, usize),
        transition: &Transition,
        at: Spot,
        nodes: &[Node],
        (parts, links): (&mut Vec<Element>, &mut Vec<Element>),
    ) {
        if transition.label.is_some() {
            self.leave_out(transition.at, say!("the label of a transition"));
        }
        if transition.comment.is_some() {
            self.leave_out(transition.at, say!("the comment of a transition"));
        }
        if let Some(block) = &transition.on_clearing {
            self.cannot(block.at, say!("an action on clearing"));
        }
        let shown = self.guards.shown(index, number).cloned().unwrap_or_else(|| {
            self.cannot(
                transition.at,
                say!("a transition of such an enclosing step, or of what it encloses"),
            );
            let condition = transition.receptivity.clone();
            Shown { exception: false, exits: std::collections::BTreeMap::new(), condition }
        });
        let condition =
            (Speech { look: &mut self.look, chart: index, home: index }).condition(&shown.condition);
        let condition = condition.unwrap_or_else(|(at, what)| {
            self.cannot(at, what);
            "0".to_string()
        });
        let tag = if shown.exception { "ExceptionTransition" } else { "GCTransition" };
        let id = self.id();
        let mut element =
            Element::new(tag).with("actionText", condition).with("conditionVisible", 1).with("id", &id);
        if let Some(priority) = transition.priority {
            element = element.with("priority", priority);
        }
        parts.push(symbols::transition(element, at, shown.exception));
        let (inward, outward) = if shown.exception {
            (Port::ExceptionIn(at), Port::ExceptionOut(at))
        } else {
            (Port::TransitionIn(at), Port::TransitionOut(at))
        };
        let from = self.ends(index, &transition.from, nodes, |w, n, node| w.way_out(n, node, &shown));
        let to = self.ends(index, &transition.to, nodes, |_, _, node| way_in(node));
        if shown.exception {
            // Several lines may lead into an exception transition, so it needs no join.
            links.extend(from.into_iter().map(|(name, port)| symbols::link(&name, &id, (port, inward))));
        } else {
            self.bars(from, (id.clone(), inward), at, true, (parts, links));
        }
        self.bars(to, (id, outward), at, false, (parts, links));
    }

    fn ends(
        &mut self,
        index: usize,
        names: &[Name],
        nodes: &[Node],
        end: impl Fn(&Self, usize, &Node) -> End,
    ) -> Vec<End> {
        let steps = names.iter().filter_map(|n| self.look.step(index, &n.text));
        steps.filter_map(|n| Some(end(self, n, nodes.get(n)?))).collect()
    }

    fn way_out(&self, number: usize, node: &Node, shown: &Shown) -> End {
        let Sort::Macro(inside) = node.sort else { return (node.id.clone(), Port::StepOut(node.at)) };
        if shown.exception {
            return (format!("{}E", node.id), Port::MacroException(node.at));
        }
        // Ports count exit steps from left to right.
        let mut ways = self.guards.exits.get(&inside).cloned().unwrap_or_default();
        let spots = self.spots.get(&inside);
        ways.sort_by_key(|s| (spots.and_then(|p| p.get(*s)).map_or(0, |at| at.0), *s));
        let exit = shown.exits.get(&number);
        let way = exit.and_then(|exit| ways.iter().position(|s| s == exit)).unwrap_or(0);
        (format!("{}_{way}", node.id), Port::MacroOut(node.at, way, ways.len().max(1)))
    }

    /// Lines between a transition and its steps, through bars if there are several steps.
    fn bars(
        &mut self,
        mut steps: Vec<End>,
        transition: End,
        at: Spot,
        join: bool,
        (parts, links): (&mut Vec<Element>, &mut Vec<Element>),
    ) {
        let mut line = |a: &End, b: &End| {
            let (from, to) = if join { (a, b) } else { (b, a) };
            links.push(symbols::link(&from.0, &to.0, (from.1, to.1)));
        };
        let mut toward = transition;
        let mut nth = 0;
        steps.reverse();
        while steps.len() > 1 {
            let Some(step) = steps.pop() else { break };
            let id = self.id();
            let place = symbols::bar_place(at, nth, join);
            nth += 1;
            parts.push(symbols::bar(
                Element::new(if join { "ParallelJoin" } else { "ParallelSplit" }).with("id", &id),
                place,
            ));
            let port = |right| if join { Port::JoinIn(place, right) } else { Port::SplitOut(place, right) };
            let whole = if join { Port::JoinOut(place) } else { Port::SplitIn(place) };
            line(&(id.clone(), whole), &toward);
            line(&step, &(format!("{id}L"), port(false)));
            toward = (format!("{id}R"), port(true));
        }
        if let Some(step) = steps.pop() {
            line(&step, &toward);
        }
    }
}

/// The deepest nesting of workspaces that is written; readers accept more.
const MOST_NESTED: usize = 40;

fn way_in(node: &Node) -> End {
    match node.sort {
        Sort::Macro(_) => (format!("{}_0", node.id), Port::MacroIn(node.at)),
        _ => (node.id.clone(), Port::StepIn(node.at)),
    }
}

/// True for an exit step that reading adds to a macro-step without one.
fn unreached(chart: &Chart, step: &Step) -> bool {
    let name = &step.name.text;
    let made = name.trim_end_matches('_') == "no exit" && step.actions.is_empty();
    made && !chart.transitions().any(|t| t.from.iter().chain(&t.to).any(|n| n.text == *name))
}

/// A text on the drawing.
fn free_text(text: &str, at: Spot) -> Element {
    let lines = i32::try_from(text.lines().count()).unwrap_or(1).max(1);
    let element = Element::new("FreeText")
        .with("alignment", 1)
        .with("autoResize", 1)
        .with("backgroundColor", 16_777_215)
        .with("bold", 0)
        .with("editable", 1)
        .with("fontName", "SansSerif")
        .with("fontSize", 14)
        .with("italic", 0)
        .with("multiline", u8::from(lines > 1))
        .with("name", "")
        .with("text", text)
        .with("textColor", -16_777_216)
        .with("transparent", 1)
        .with("underline", 0);
    symbols::placed(element, at, (200, lines.saturating_mul(20)))
}
