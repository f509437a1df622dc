//! Finds the steps before and behind each transition from the lines.
//!
//! The preceding steps are found by following the lines backward through joins and posts, the
//! succeeding ones by following them forward through splits and posts. Lines that no chart can have
//! are reported and not followed.

use std::collections::{HashMap, HashSet};

use g7_model::{Said, codes, say};

use super::naming::Names;
use super::sheet::{Node, Plan, Sheet, StepSort};
use g7_iec::report::{Report, shown};

/// The most steps of the walk through a workspace's lines. A file with only joins would otherwise
/// take quadratic time.
const MOST_WORK: usize = 4_000_000;

/// The steps before and behind a transition, by number in their workspace.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Ends {
    pub(super) from: Vec<usize>,
    /// The exit through which each of them is left, counted from 0. Only a macro-step has others
    /// than 0.
    pub(super) ways: Vec<usize>,
    pub(super) to: Vec<usize>,
}

/// The exit steps of a workspace in the order of the ports, from left to right.
pub(super) fn exits(sheet: &Sheet) -> Vec<usize> {
    let sort = |(n, s): (usize, &super::sheet::StepNode)| (s.sort == StepSort::Exit).then_some((s.x, n));
    let mut found: Vec<(i32, usize)> = sheet.steps.iter().enumerate().filter_map(sort).collect();
    found.sort_unstable();
    found.into_iter().map(|(_, n)| n).collect()
}

/// The ends of each transition of a workspace.
pub(super) fn ends(plan: &Plan, index: usize, names: &Names, report: &mut Report) -> Vec<Ends> {
    let Some(sheet) = plan.sheets.get(index) else { return Vec::new() };
    let mut web = Web::new(plan, sheet, index, names);
    web.lines(report);
    web.posts(plan, report);
    let all: Vec<Ends> = (0..sheet.transitions.len()).map(|t| web.ends_of(t, report)).collect();
    if web.work == 0 {
        report.say(&codes::TOO_LARGE, &sheet.at, say!("the lines of this workspace are too many to follow"));
    }
    all
}

/// The lines of one workspace, in both directions.
struct Web<'a> {
    sheet: &'a Sheet,
    index: usize,
    names: &'a Names,
    out: HashMap<Node, Vec<Node>>,
    into: HashMap<Node, Vec<Node>>,
    /// Ends of lines that have been reported and are not followed, with the direction of the line.
    cut: HashSet<(Node, bool)>,
    /// The number of exits of each macro-step, by its workspace.
    exits: HashMap<usize, usize>,
    work: usize,
}

/// An end of a line: the object, and the letter or number of the port.
struct End {
    node: Node,
    port: String,
}

impl<'a> Web<'a> {
    fn new(plan: &Plan, sheet: &'a Sheet, index: usize, names: &'a Names) -> Web<'a> {
        Web {
            sheet,
            index,
            names,
            out: HashMap::new(),
            into: HashMap::new(),
            cut: HashSet::new(),
            exits: ways_out(plan, sheet),
            work: MOST_WORK,
        }
    }

    fn join(&mut self, from: Node, to: Node) {
        self.out.entry(from).or_default().push(to);
        self.into.entry(to).or_default().push(from);
    }

    /// The object at an end of a line. The port follows the identifier: `L` and `R` of a bar, `_1`
    /// for the second port of a macro-step, `H` for history, `E` for an exception.
    fn end(&self, id: &str) -> Option<End> {
        if let Some(&node) = self.sheet.ids.get(id) {
            return Some(End { node, port: String::new() });
        }
        let letter = id.char_indices().last().filter(|(_, c)| matches!(c, 'L' | 'R' | 'N' | 'H' | 'E'));
        let cut = letter.map(|(i, _)| (i, i)).or_else(|| id.rfind('_').map(|i| (i, i + 1)))?;
        let node = *self.sheet.ids.get(id.get(..cut.0)?)?;
        Some(End { node, port: id.get(cut.1..)?.to_string() })
    }

    /// Reads the lines; left ports of a bar come before right ones.
    fn lines(&mut self, report: &mut Report) {
        let sheet = self.sheet;
        let mut later = Vec::new();
        for link in &sheet.links {
            let (from, to) = (self.end(&link.from.text), self.end(&link.to.text));
            let lost = [(&from, &link.from, say!("comes from")), (&to, &link.to, say!("leads to"))];
            for (end, text, way) in lost {
                if end.is_none() {
                    let what =
                        say!("a line {way} `{}`, which is nothing in this workspace", shown(&text.text));
                    let place = if text.text.is_empty() { &link.at } else { &text.at };
                    report.say(&codes::OPEN_LINK, place, what);
                }
            }
            let dropped = match (&from, &to) {
                (Some(from), Some(to)) => {
                    self.special_port(from, to, &link.at, report)
                        || !self.fits(from.node, to.node, &link.at, report)
                }
                _ => true,
            };
            if dropped {
                self.cut.extend(from.map(|end| (end.node, true)));
                self.cut.extend(to.map(|end| (end.node, false)));
                continue;
            }
            let (Some(mut from), Some(to)) = (from, to) else { continue };
            if let (Node::Step(step), Ok(way @ 1..)) = (from.node, from.port.parse::<usize>()) {
                from.node = Node::Way(step, way);
            }
            if from.port == "R" || to.port == "R" {
                later.push((from.node, to.node));
            } else {
                self.join(from.node, to.node);
            }
        }
        for (from, to) in later {
            self.join(from, to);
        }
    }

    /// Reports lines at ports of a macro-step that cannot be carried over.
    fn special_port(&self, from: &End, to: &End, at: &std::ops::Range<usize>, report: &mut Report) -> bool {
        let step = |end: &End| matches!(end.node, Node::Step(_));
        let exception = self.is_exception(to.node);
        let (code, what) = if to.port == "H" && step(to) {
            let what = say!("a line to the history port of a macro-step; resuming it is not carried over");
            (&codes::NOT_CARRIED, what)
        } else if exception && !self.is_macro(from.node) {
            let what = say!("a line to an exception transition from what is no macro-step");
            (&codes::BAD_LINK, what)
        } else if from.port == "E" && step(from) && !exception {
            let what =
                say!("a line from the exception port of a macro-step to what is no exception transition");
            (&codes::BAD_LINK, what)
        } else if step(to) && !matches!(&*to.port, "" | "0" | "N") {
            let what = say!("a line to a further port of a macro-step; only one way in is carried over");
            (&codes::NOT_CARRIED, what)
        } else if step(from) && !exception && !self.has_way(from) {
            (&codes::BAD_LINK, say!("a line from a port that the macro-step does not have"))
        } else {
            return false;
        };
        if from.node != Node::Stranger && to.node != Node::Stranger {
            report.say(code, at, what);
        }
        true
    }

    fn is_exception(&self, node: Node) -> bool {
        matches!(node, Node::Transition(t) if self.sheet.transitions.get(t).is_some_and(|t| t.exception))
    }

    fn is_macro(&self, node: Node) -> bool {
        let sort = |step| self.sheet.steps.get(step).map(|s: &super::sheet::StepNode| s.sort);
        matches!(node, Node::Step(step) if matches!(sort(step), Some(StepSort::Macro(_))))
    }

    /// True if a macro-step has an exit step for the port at which a line begins.
    fn has_way(&self, end: &End) -> bool {
        let way = match &*end.port {
            "" | "0" | "N" => return true,
            port => port.parse::<usize>().ok(),
        };
        let Node::Step(step) = end.node else { return false };
        let Some(StepSort::Macro(Some(inside))) = self.sheet.steps.get(step).map(|s| s.sort) else {
            return false;
        };
        way.is_some_and(|way| self.exits.get(&inside).is_some_and(|n| way < *n))
    }

    /// True if a line may connect the two objects.
    fn fits(&self, from: Node, to: Node, at: &std::ops::Range<usize>, report: &mut Report) -> bool {
        if from == Node::Stranger || to == Node::Stranger {
            return false;
        }
        let fits = allowed(from, to);
        if !fits {
            let what = match (from, to) {
                (Node::Step(_), Node::Step(_)) => {
                    say!(
                        "a line from {} to {} without a transition between",
                        self.called(from),
                        self.called(to)
                    )
                }
                (Node::Transition(_), Node::Transition(_)) => {
                    say!("a line from a transition to a transition without a step between")
                }
                _ => say!("a line cannot lead from {} to {}", self.called(from), self.called(to)),
            };
            report.say(&codes::BAD_LINK, at, what);
        }
        fits
    }

    fn called(&self, node: Node) -> Said {
        match node {
            Node::Step(step) | Node::Way(step, _) => {
                say!("step `{}`", shown(self.names.step(self.index, step)))
            }
            Node::Transition(_) => say!("a transition"),
            Node::Split(_) => say!("a parallel split"),
            Node::Join(_) => say!("a parallel join"),
            Node::PostIn(_) | Node::PostOut(_) => say!("a connection post"),
            Node::Stranger => say!("an element that is not carried over"),
        }
    }

    /// Connects each pair of connection posts.
    fn posts(&mut self, plan: &Plan, report: &mut Report) {
        let sheet = self.sheet;
        let prefix = full_name(plan, self.index);
        let mut at: HashMap<(bool, String), usize> = HashMap::new();
        for (index, post) in sheet.posts.iter().enumerate() {
            at.entry((post.inward, post.name.clone())).or_insert(index);
        }
        let mut paired: HashSet<(usize, usize)> = HashSet::new();
        for (index, post) in sheet.posts.iter().enumerate() {
            let name = post.remote.strip_prefix(&prefix).unwrap_or(&post.remote);
            if let Some(&other) = at.get(&(!post.inward, name.to_string())) {
                paired.insert(if post.inward { (index, other) } else { (other, index) });
            }
        }
        let mut pairs: Vec<(usize, usize)> = paired.into_iter().collect();
        pairs.sort_unstable();
        let mut tied = HashSet::new();
        for (inward, outward) in pairs {
            tied.extend([Node::PostIn(inward), Node::PostOut(outward)]);
            self.tie(inward, outward, report);
        }
        for (index, post) in sheet.posts.iter().enumerate() {
            let node = if post.inward { Node::PostIn(index) } else { Node::PostOut(index) };
            if tied.contains(&node) {
                continue;
            }
            if post.remote.contains('.') {
                let what = say!("a connection post to `{}` in another workspace", shown(&post.remote));
                report.say(&codes::NOT_CARRIED, &post.at, what);
            } else {
                let what = say!("the connection post `{}` has no other end", shown(&post.name));
                report.say(&codes::OPEN_LINK, &post.at, what);
            }
        }
    }

    /// Connects the lines into one post with the lines out of the other.
    fn tie(&mut self, inward: usize, outward: usize, report: &mut Report) {
        let into = self.into.get(&Node::PostIn(inward)).cloned().unwrap_or_default();
        let out = self.out.get(&Node::PostOut(outward)).cloned().unwrap_or_default();
        let place = self.sheet.posts.get(inward).map_or(0..0, |p| p.at.clone());
        for from in &into {
            for to in &out {
                if self.work == 0 {
                    return;
                }
                self.work -= 1;
                if !self.fits(*from, *to, &place, report) {
                    return;
                }
            }
        }
        self.join(Node::PostIn(inward), Node::PostOut(outward));
    }

    fn ends_of(&mut self, transition: usize, report: &mut Report) -> Ends {
        let start = Node::Transition(transition);
        let (from, from_cut) = self.walk(start, false);
        let (to, to_cut) = self.walk(start, true);
        let (from, ways): (Vec<usize>, Vec<usize>) = from.into_iter().unzip();
        let to: Vec<usize> = to.into_iter().map(|(step, _)| step).collect();
        let Some(node) = self.sheet.transitions.get(transition) else { return Ends::default() };
        let lost = match (from.is_empty() && !from_cut, to.is_empty() && !to_cut) {
            (true, true) => say!("a transition without any step"),
            (true, false) => say!("a transition without a step before it; it is always enabled"),
            (false, true) => say!("a transition without a step behind it"),
            (false, false) => Said::default(),
        };
        if !lost.is_empty() {
            report.say(&codes::OPEN_LINK, &node.at, lost);
        }
        Ends { from, ways, to }
    }

    /// The steps reached through bars and posts, in the order of the lines, and whether a line was
    /// cut on the way.
    fn walk(&mut self, start: Node, forward: bool) -> (Vec<(usize, usize)>, bool) {
        let mut steps = Vec::new();
        let mut seen = HashSet::from([start]);
        let mut stack = vec![start];
        let mut touched = false;
        while let Some(node) = stack.pop() {
            touched |= self.cut.contains(&(node, forward));
            if let Node::Step(step) = node {
                steps.push((step, 0));
                continue;
            }
            if let Node::Way(step, way) = node {
                steps.push((step, way));
                continue;
            }
            let next = if forward { self.out.get(&node) } else { self.into.get(&node) };
            for &other in next.into_iter().flatten().rev() {
                if self.work == 0 {
                    return (steps, true);
                }
                self.work -= 1;
                if !matches!(other, Node::Transition(_)) && seen.insert(other) {
                    stack.push(other);
                }
            }
        }
        (steps, touched)
    }
}

/// The number of exit steps in each macro-step of a workspace.
fn ways_out(plan: &Plan, sheet: &Sheet) -> HashMap<usize, usize> {
    let inside = sheet.steps.iter().filter_map(|s| if let StepSort::Macro(i) = s.sort { i } else { None });
    let count = |s: &Sheet| s.steps.iter().filter(|s| s.sort == StepSort::Exit).count();
    inside.map(|i| (i, plan.sheets.get(i).map_or(0, count))).collect()
}

/// The ends that a line may have.
fn allowed(from: Node, to: Node) -> bool {
    use Node::{Join, PostIn, PostOut, Split, Step, Transition, Way};
    match (from, to) {
        (PostIn(_), _) | (_, PostOut(_)) => false,
        (PostOut(_), _) | (_, PostIn(_)) => true,
        (Step(_) | Way(..), Transition(_) | Join(_)) => true,
        (Transition(_), Step(_) | Split(_)) => true,
        (Split(_), Step(_) | Split(_)) => true,
        (Join(_), Transition(_) | Join(_)) => true,
        _ => false,
    }
}

/// The prefix of full names in a workspace: `J1.M1.`
fn full_name(plan: &Plan, index: usize) -> String {
    let mut parts = Vec::new();
    let mut here = Some(index);
    while let Some(sheet) = here.and_then(|i| plan.sheets.get(i)) {
        parts.push(sheet.name.text.as_str());
        here = sheet.parent;
    }
    parts.reverse();
    let mut name = parts.join(".");
    name.push('.');
    name
}
