//! Builds the document from sheets and declarations.

use std::collections::HashMap;

use g7_model::{
    Action, Body, Chart, ChartItem, ChartKind, Document, Expr, ExprKind, Item, Layout, Name, NamedAction,
    Nanos, PlaceAt, Placed, Profile, ProfileName, Qualifier, Section, Span, Step, StepKind, Stmt, Target,
    codes, say,
};
use roxmltree::Node;

use super::declarations::{self, members};
use super::dialect::Words;
use super::grid;
use super::read::{ActionNode, Condition, Sheet, StepNode, StepSort, TransitionNode, kid, kids};
use crate::undeclared;
use g7_iec::nodes::{self, Taken, assign, name};
use g7_iec::report::Report;
use g7_iec::st;
use g7_iec::xml::attr::{self, Text};
use g7_model::visit_mut;

/// The distance between two columns and between two rows, in hundredths of the drawing's unit.
const COLUMN: i32 = 1300;
const ROW: i32 = 600;

/// The charts within macro-steps, by the names of the macro-steps in upper case.
type Inner = HashMap<String, String>;

/// The document of a file.
pub(super) fn document<'a>(root: Node<'a, 'a>, sheets: &[Sheet<'a>], report: &mut Report) -> Document {
    let at = report.span(&attr::head(root));
    let mut items =
        vec![Item::Profile(Profile { name: ProfileName::Unity, switches: Vec::new(), at: at.into() })];
    items.extend(cycle(root, report));
    let data = declarations::data(root, report);
    items.extend(data.vars.iter().cloned().map(Item::Var));
    let (pre, post) = programs(root, report);
    items.extend((!pre.is_empty()).then(|| Item::Pre(Body::St(nodes::block(pre, at)), at.into())));
    let mut taken = Taken::default();
    let names: Vec<String> = sheets.iter().map(|s| chart_name(s, &mut taken, report)).collect();
    let insides = sheets.iter().zip(&names).filter(|(s, _)| s.inner).rev();
    let inner: Inner = insides.map(|(s, n)| (s.name.to_uppercase(), n.clone())).collect();
    let mut layouts = Vec::new();
    for node in sheets.iter().filter(|s| s.shared).flat_map(|s| &s.sections) {
        items.extend(section(*node, report).and_then(|item| match item {
            ChartItem::Action(a) => Some(Item::Action(a)),
            ChartItem::Section(s) => Some(Item::Section(s)),
            _ => None,
        }));
    }
    for (sheet, title) in sheets.iter().zip(&names) {
        let (chart, layout) = chart(sheet, title, &inner, report);
        items.push(Item::Chart(chart));
        layouts.push(Item::Layout(layout));
    }
    items.extend((!post.is_empty()).then(|| Item::Post(Body::St(nodes::block(post, at)), at.into())));
    items.extend(layouts);
    let mut document = Document { items, notes: report.take_notes() };
    visit_mut::document(&mut document, &mut Words);
    let more = members(&document, &data.open, report);
    document.items.splice(1..1, more.into_iter().map(Item::Var));
    st::settle(&mut document);
    undeclared::declare(&mut document, report);
    st::settle(&mut document);
    undeclared::open(&mut document, report);
    document
}

/// The period of the task that runs the charts.
fn cycle(root: Node, report: &Report) -> Option<Item> {
    let task =
        root.descendants().find(|n| n.has_tag_name("taskDesc") && n.attribute("task") == Some("MAST"))?;
    if task.attribute("taskType") != Some("periodic") {
        return None;
    }
    let ms: i64 = task.attribute("valueType")?.trim().parse().ok()?;
    let at = report.span(&attr::head(task));
    (1..=3_600_000).contains(&ms).then(|| Item::Cycle(Nanos::from_millis(ms), at.into()))
}

fn chart_name(sheet: &Sheet, taken: &mut Taken, report: &mut Report) -> String {
    let wanted = if sheet.name.is_empty() { "Chart".to_string() } else { sheet.name.clone() };
    let title = taken.give(&wanted);
    if title != wanted {
        let what = say!("a second chart `{wanted}`; it is called `{title}`");
        report.say(&codes::RENAMED, &sheet.at, what);
    }
    title
}

/// The text sections around the charts: those before the first chart, and the others.
fn programs(root: Node, report: &mut Report) -> (Vec<Stmt>, Vec<Stmt>) {
    let order = |node: Node| -> i64 {
        let ident = node.children().find(|n| n.has_tag_name("identProgram"));
        ident
            .and_then(|n| n.attribute("SectionOrder"))
            .and_then(|o| o.trim().parse().ok())
            .unwrap_or(i64::MAX)
    };
    let first = root.descendants().filter(|n| n.has_tag_name("SFCProgram")).map(order).min().unwrap_or(0);
    let mut sections: Vec<Node> = root.descendants().filter(|n| n.has_tag_name("program")).collect();
    sections.sort_by_key(|n| order(*n));
    let (mut pre, mut post) = (Vec::new(), Vec::new());
    for section in sections {
        let statements = source(section, report);
        if order(section) < first { pre.extend(statements) } else { post.extend(statements) }
    }
    (pre, post)
}

/// The statements of a section in any language.
fn source(section: Node, report: &mut Report) -> Vec<Stmt> {
    let mut statements = Vec::new();
    for node in section.children().filter(Node::is_element) {
        let text = || attr::content(node);
        match node.tag_name().name() {
            "STSource" => statements.extend(structured(&text(), report)),
            "ILSource" => {
                let text = text();
                let place = |part: std::ops::Range<usize>| text.place(&part);
                statements.extend(st::single::instructions(&text.text, &place, report));
            }
            tag @ ("LDSource" | "FBDSource" | "LL984Source") => {
                let what = say!("a section in a drawn language (`{tag}`) is left out");
                report.say(&codes::NOT_CARRIED, &attr::head(node), what);
            }
            _ => {}
        }
    }
    statements
}

fn structured(text: &Text, report: &mut Report) -> Vec<Stmt> {
    let place = |part: std::ops::Range<usize>| text.place(&part);
    st::single::statements(&text.text, &place, report)
}

fn expression(text: &Text, report: &mut Report) -> Expr {
    let place = |part: std::ops::Range<usize>| text.place(&part);
    st::single::expression(&text.text, &place, report)
}

fn chart(sheet: &Sheet, title: &str, inner: &Inner, report: &mut Report) -> (Chart, Layout) {
    let at = report.span(&sheet.at);
    let mut items = Vec::new();
    let mut places = Vec::new();
    let mut place = |what: Placed, (x, y): (i32, i32), at: Span| {
        places.push(PlaceAt {
            what,
            x: x.saturating_mul(COLUMN),
            y: y.saturating_mul(ROW),
            then: Vec::new(),
            at: at.into(),
        });
    };
    for node in &sheet.steps {
        let step = step(node, sheet, inner, report);
        place(Placed::Step(step.name.clone()), node.spot, step.at.0);
        items.push(ChartItem::Step(step));
    }
    let ends = grid::ends(sheet, report);
    // Branches are evaluated from left to right.
    let mut order: Vec<usize> = (0..sheet.transitions.len()).collect();
    order.sort_by_key(|i| sheet.transitions.get(*i).map(|t| (t.spot.1, t.spot.0)));
    for (number, index) in (0u32..).zip(order) {
        let (Some(node), Some(ends)) = (sheet.transitions.get(index), ends.get(index)) else { continue };
        let at = report.span(&node.at);
        let step = |i: &usize| sheet.steps.get(*i).map(|s| Name::new(clean(&s.name), at));
        let receptivity = receptivity(node, report);
        let from = ends.from.iter().filter_map(step).collect();
        let to = ends.to.iter().filter_map(step).collect();
        let mut transition = nodes::transition(from, to, receptivity, at);
        transition.comment = (!node.comment.is_empty()).then(|| node.comment.as_str().into());
        place(Placed::TransitionNumber(number), node.spot, at);
        items.push(ChartItem::Transition(transition));
    }
    for node in sheet.sections.iter().filter(|_| !sheet.shared) {
        items.extend(section(*node, report));
    }
    let texts: Vec<&str> = sheet.texts.iter().map(String::as_str).filter(|t| !t.is_empty()).collect();
    let chart = Chart {
        params: Vec::new(),
        block: None,
        kind: if sheet.inner { ChartKind::Expansion } else { ChartKind::Chart },
        name: Name::new(title, at),
        comment: (!texts.is_empty()).then(|| texts.join(" / ").into()),
        every: None,
        items,
        at: at.into(),
    };
    let layout = Layout { chart: chart.name.clone(), places, at: at.into() };
    (chart, layout)
}

/// A name without the characters that a name cannot have.
fn clean(text: &str) -> String {
    nodes::line(&text.replace('`', "'"))
}

fn step(node: &StepNode, sheet: &Sheet, inner: &Inner, report: &mut Report) -> Step {
    let at = report.span(&node.at);
    let mut step = nodes::step(Name::new(clean(&node.name), at), node.sort == StepSort::Initial, at);
    step.kind = match node.sort {
        StepSort::Plain | StepSort::Initial => StepKind::Plain,
        StepSort::In | StepSort::Out if !sheet.inner => StepKind::Plain,
        StepSort::In => StepKind::Entry,
        StepSort::Out => StepKind::Exit,
        StepSort::Macro => {
            let wanted = clean(&node.name);
            match inner.get(&wanted.to_uppercase()) {
                Some(inner) => StepKind::Macro(Name::new(inner.as_str(), at)),
                None => {
                    report.say(
                        &codes::BAD_MACRO,
                        &node.at,
                        say!("the macro-step `{wanted}` without its inside"),
                    );
                    StepKind::Plain
                }
            }
        }
    };
    step.comment = (!node.comment.is_empty()).then(|| node.comment.as_str().into());
    if let Some(delay) = &node.delay {
        let what = say!("the delay time of step `{}` has no counterpart", clean(&node.name));
        report.say(&codes::NOT_CARRIED, delay, what);
    }
    step.actions = node.actions.iter().filter_map(|a| action(a, report)).collect();
    step.braces = !step.actions.is_empty();
    step
}

fn action(node: &ActionNode, report: &mut Report) -> Option<Action> {
    let at = report.span(&node.at);
    let qualifier = match node.qualifier.as_str() {
        "NONE" | "" => Some(Qualifier::N),
        word => Qualifier::named(word),
    };
    let Some(qualifier) = qualifier else {
        let what = say!("the qualifier `{}` is not known", nodes::line(&node.qualifier));
        report.say(&codes::BAD_VALUE, &node.at, what);
        return None;
    };
    if node.name.text.trim().is_empty() {
        report.say(&codes::LEFT_OUT, &node.at, say!("an action without a name"));
        return None;
    }
    let target = if node.section {
        let own = report.span(&node.name.at);
        Target::Path(nodes::path(&[&clean(&node.name.text)], own))
    } else {
        match expression(&node.name, report).kind {
            ExprKind::Path(path) => Target::Path(path),
            ExprKind::Direct(name) => Target::Direct(name, at.into()),
            ExprKind::Bad => return None,
            _ => {
                report.say(&codes::BAD_TEXT, &node.name.at, say!("an action that is no variable"));
                return None;
            }
        }
    };
    let written = !node.time.text.trim().is_empty();
    let time = match (qualifier.timed(), written) {
        (true, true) => Some(expression(&node.time, report)),
        (true, false) => {
            let what = say!("the qualifier `{}` without its time", qualifier.name());
            report.say(&codes::BAD_VALUE, &node.at, what);
            return None;
        }
        (false, _) => None,
    };
    Some(nodes::qualified(qualifier, time, target, None, at))
}

fn receptivity(node: &TransitionNode, report: &mut Report) -> Expr {
    let at = report.span(&node.at);
    let condition = match &node.condition {
        Condition::Text(text) if !text.text.trim().is_empty() => expression(text, report),
        Condition::Section(text) if !text.text.trim().is_empty() => {
            name(&[&clean(&text.text)], report.span(&text.at))
        }
        _ => {
            report.say(&codes::BAD_TEXT, &node.at, say!("a transition without a condition"));
            return nodes::bad(at);
        }
    };
    if node.inverted { nodes::not(condition, at) } else { condition }
}

/// The section of an action or a transition.
fn section<'a>(node: Node<'a, 'a>, report: &mut Report) -> Option<ChartItem> {
    let range = attr::head(node);
    let at = report.span(&range);
    let title = Name::new(clean(node.attribute("name").unwrap_or("")), at);
    if node.has_tag_name("actionSource") {
        let body = Body::St(nodes::block(source(node, report), at));
        return Some(ChartItem::Action(NamedAction { name: title, comment: None, body, at: at.into() }));
    }
    let text = kid(node, "STSource").map(attr::content);
    let il = kids(node, "ILSource").next().map(attr::content);
    let (statements, short) = match (text, il) {
        // A section may consist of only the expression.
        (Some(text), _) if !text.text.contains(":=") => {
            let value = expression(&text, report);
            (vec![assign(name(&[&title.text], at), value, at)], true)
        }
        (Some(text), _) => (structured(&text, report), false),
        (None, Some(text)) => {
            let place = |part: std::ops::Range<usize>| text.place(&part);
            let value = st::single::result(&text.text, &place, report);
            (vec![assign(name(&[&title.text], at), value, at)], true)
        }
        (None, None) => {
            let what = say!("the transition section `{}` is drawn, and not carried over", title.text);
            report.say(&codes::NOT_CARRIED, &range, what);
            return None;
        }
    };
    let body = nodes::block(statements, at);
    Some(ChartItem::Section(Section { name: title, body, short, at: at.into() }))
}
