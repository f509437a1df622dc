//! Builds the document from a GRAPH block.

use std::collections::BTreeMap;

use g7_model::{
    Body, Chart, ChartItem, ChartKind, Document, Expr, Item, Name, Path, Profile, ProfileName, Span, Stmt,
    Switch, Type, VarDecl, VarKind, codes, say,
};

use super::actions::{Guards, actions};
use super::network::network;
use super::read::{self, Sequence, StepNode, Xml, kid, kids, words};
use crate::undeclared;
use g7_iec::nodes::{self, Taken, boolean};
use g7_iec::report::Report;
use g7_iec::st::{self, elementary};
use g7_iec::xml::attr;
use g7_model::visit_mut::{self, Use, Visitor};

/// The parameters that every GRAPH block has and that control the sequencer itself.
const OWN: [&str; 58] = [
    "OFF_SQ",
    "INIT_SQ",
    "ACK_EF",
    "REG_EF",
    "ACK_S",
    "REG_S",
    "HALT_SQ",
    "HALT_TM",
    "ZERO_OP",
    "EN_IL",
    "EN_SV",
    "EN_ACKREQ",
    "EN_SSKIP",
    "DISP_SACT",
    "DISP_SEF",
    "DISP_SALL",
    "S_PREV",
    "S_NEXT",
    "SW_AUTO",
    "SW_TAP",
    "SW_TOP",
    "SW_MAN",
    "S_SEL",
    "S_SELOK",
    "S_ON",
    "S_OFF",
    "T_PREV",
    "T_NEXT",
    "T_PUSH",
    "S_NO",
    "S_MORE",
    "S_ACTIVE",
    "S_TIME",
    "S_TIMEOK",
    "S_CRITLOC",
    "S_CRITLOCERR",
    "S_CRITSUP",
    "S_STATE",
    "T_NO",
    "T_MORE",
    "T_CRIT",
    "T_CRITOLD",
    "T_CRITFLT",
    "ERROR",
    "FAULT",
    "ERR_FLT",
    "SQ_ISOFF",
    "SQ_HALTED",
    "TM_HALTED",
    "OP_ZEROED",
    "IL_ENABLED",
    "SV_ENABLED",
    "ACKREQ_ENABLED",
    "SSKIP_ENABLED",
    "SACT_DISP",
    "SEF_DISP",
    "AUTO_ON",
    "MAN_ON",
];
/// Further parameters of this kind.
const MODES: [&str; 2] = ["TAP_ON", "TOP_ON"];

/// The document of a file with a block in GRAPH.
pub(super) fn document(root: Xml, report: &mut Report) -> Document {
    let at = report.span(&attr::head(root));
    let mut items = vec![Item::Profile(Profile {
        name: ProfileName::Iec61131,
        switches: vec![(Switch::FinalScan(false), at.into())],
        at: at.into(),
    })];
    let blocks: Vec<Xml> =
        root.descendants().filter(|n| n.tag_name().name().starts_with("SW.Blocks.")).collect();
    let mut left_out = Vec::new();
    for block in &blocks {
        items.extend(interface(*block, &mut left_out, report).into_iter().map(Item::Var));
    }
    if let Some((range, _)) = left_out.first() {
        let what = say!(
            "{} parameters of the sequencer itself (modes, acknowledgement, display) are left out; it runs in automatic mode",
            left_out.len()
        );
        report.say(&codes::LEFT_OUT, range, what);
    }
    for unit in root.descendants().filter(|n| n.tag_name().name() == "SW.Blocks.CompileUnit") {
        if !unit.descendants().any(|n| n.tag_name().name() == "Graph") {
            let what = say!("a network of a block in another language is left out");
            report.element(&codes::LEFT_OUT, "CompileUnit", &attr::head(unit), what);
        }
    }
    let mut taken = Taken::default();
    let (mut pre, mut post, mut charts) = (Vec::new(), Vec::new(), Vec::new());
    for graph in root.descendants().filter(|n| n.tag_name().name() == "Graph") {
        pre.extend(kids(graph, "PreOperations").flat_map(|n| permanent(n, report)).collect::<Vec<Stmt>>());
        post.extend(kids(graph, "PostOperations").flat_map(|n| permanent(n, report)).collect::<Vec<Stmt>>());
        let title = block_name(graph);
        for sequence in kids(graph, "Sequence") {
            let sequence = read::sequence(sequence, report);
            let own = taken.give(&title);
            charts.push(Item::Chart(chart(&sequence, &own, report)));
        }
    }
    items.extend((!pre.is_empty()).then(|| Item::Pre(Body::St(nodes::block(pre, at)), at.into())));
    items.extend(charts);
    items.extend((!post.is_empty()).then(|| Item::Post(Body::St(nodes::block(post, at)), at.into())));
    let mut document = Document { items, notes: report.take_notes() };
    addresses(&mut document);
    st::settle(&mut document);
    undeclared::declare(&mut document, report);
    st::settle(&mut document);
    document
}

/// The name of the block that a graph belongs to.
fn block_name(graph: Xml) -> String {
    let block = graph.ancestors().find(|n| n.tag_name().name().starts_with("SW.Blocks.F"));
    let name = block.and_then(|n| kid(n, "AttributeList")).and_then(|n| kid(n, "Name"));
    let name = name.map(|n| nodes::line(&attr::content(n).text.replace('`', "'"))).unwrap_or_default();
    if name.is_empty() { "Graph".to_string() } else { name }
}

/// The declared variables of a block, without those of the sequencer.
fn interface(
    block: Xml,
    left_out: &mut Vec<(std::ops::Range<usize>, String)>,
    report: &mut Report,
) -> Vec<VarDecl> {
    let mut vars = Vec::new();
    let sections =
        kid(block, "AttributeList").and_then(|n| kid(n, "Interface")).and_then(|n| kid(n, "Sections"));
    for section in sections.into_iter().flat_map(|n| kids(n, "Section")) {
        let kind = match section.attribute("Name") {
            Some("Input") => VarKind::Input,
            Some("Output") => VarKind::Output,
            Some("Constant") => VarKind::Const,
            Some("Base") => continue,
            _ => VarKind::Var,
        };
        for member in kids(section, "Member") {
            declare(member, kind, "", 0, left_out, &mut vars, report);
        }
    }
    vars
}

/// Declares a member, or the members of a structure.
fn declare(
    member: Xml,
    kind: VarKind,
    before: &str,
    depth: usize,
    left_out: &mut Vec<(std::ops::Range<usize>, String)>,
    vars: &mut Vec<VarDecl>,
    report: &mut Report,
) {
    let range = attr::head(member);
    let own = nodes::line(&member.attribute("Name").unwrap_or("").replace('`', "'"));
    let name = if before.is_empty() { own } else { format!("{before}.{own}") };
    let ty = member.attribute("Datatype").unwrap_or("");
    if OWN.contains(&name.as_str()) || MODES.contains(&name.as_str()) {
        left_out.push((range, name));
        return;
    }
    // The sequencer's own data for each step and each transition.
    if ty.starts_with("G7_") || ty.starts_with("GRAPH_") {
        return;
    }
    if ty.trim_matches('"') == "Struct" && depth < 16 {
        for inner in kids(member, "Member") {
            declare(inner, kind, &name, depth + 1, left_out, vars, report);
        }
        return;
    }
    let upper = ty.trim_matches('"').to_ascii_uppercase();
    let upper = upper.strip_suffix("_TIME").map_or(upper.as_str(), |block| block);
    let text = upper.strip_prefix("STRING[").and_then(|n| n.strip_suffix(']')).and_then(|n| n.parse().ok());
    let known = text.map(Type::String).or_else(|| elementary(upper));
    let Some(known) = known else {
        report.say(
            &codes::LEFT_OUT,
            &range,
            say!("`{name}` is of the type `{}`, which is not known", nodes::line(ty)),
        );
        return;
    };
    let mut decl = nodes::variable(
        if matches!(known, Type::Fb(_)) { VarKind::Var } else { kind },
        &name,
        known,
        report.span(&range),
    );
    let comment = words(kid(member, "Comment"));
    decl.comment = (!comment.is_empty()).then(|| comment.into());
    decl.retain = kind == VarKind::Var && member.attribute("Remanence") == Some("Retain");
    let start = kid(member, "StartValue").map(attr::content).filter(|t| !t.text.trim().is_empty());
    if let Some(text) = start {
        let place = |part: std::ops::Range<usize>| text.place(&part);
        let value = st::single::expression(&text.text, &place, report);
        decl.init = Some(value).filter(|v| nodes::truth(v) != Some(false));
    } else if kind == VarKind::Const {
        decl.init = Some(if known == Type::Bool {
            boolean(false, report.span(&range))
        } else {
            nodes::int(0, report.span(&range))
        });
    }
    vars.push(decl);
}

/// Permanent instructions.
fn permanent(node: Xml, report: &mut Report) -> Vec<Stmt> {
    let mut list = Vec::new();
    for operation in kids(node, "PermanentOperation") {
        if let Some(mut network) = network(operation, report) {
            list.extend(network.statements(report));
        }
    }
    list
}

fn chart(sequence: &Sequence, title: &str, report: &mut Report) -> Chart {
    let at = report.span(&sequence.at);
    let names = step_names(sequence, report);
    let mut items = Vec::new();
    let mut watched: Vec<Option<Expr>> = Vec::new();
    for (node, own) in sequence.steps.iter().zip(&names) {
        let guards = guards(node, report);
        let span = report.span(&node.at);
        let mut step = nodes::step(Name::new(own.as_str(), span), node.initial, span);
        let comment = words(kid(node.node, "Actions").and_then(|n| kid(n, "Title")));
        let comment = if comment.is_empty() { words(kid(node.node, "Comment")) } else { comment };
        step.comment = (!comment.is_empty()).then(|| comment.into());
        step.actions = actions(node.node, &guards, report);
        step.braces = !step.actions.is_empty();
        times(node, report);
        items.push(ChartItem::Step(step));
        watched.push(guards.supervision);
    }
    let mut labels = Taken::default();
    for node in &sequence.transitions {
        let span = report.span(&node.at);
        let value = network(node.node, report).and_then(|mut n| n.value("TrCoil", report));
        let mut receptivity = value.unwrap_or_else(|| boolean(true, span));
        for guard in node.ends.from.iter().filter_map(|i| watched.get(*i)?.clone()) {
            receptivity = nodes::and(receptivity, nodes::not(guard, span), span);
        }
        let step = |i: &usize| names.get(*i).map(|n| Name::new(n.as_str(), span));
        let from = node.ends.from.iter().filter_map(step).collect();
        let to = node.ends.to.iter().filter_map(step).collect();
        let mut transition = nodes::transition(from, to, receptivity, span);
        if !node.label.is_empty() {
            transition.label = Some(Name::new(labels.give(&node.label), span));
        }
        items.push(ChartItem::Transition(transition));
    }
    Chart {
        params: Vec::new(),
        block: None,
        kind: ChartKind::Chart,
        name: Name::new(title, at),
        comment: (!sequence.title.is_empty()).then(|| sequence.title.as_str().into()),
        every: None,
        items,
        at: at.into(),
    }
}

fn step_names(sequence: &Sequence, report: &mut Report) -> Vec<String> {
    let mut taken = Taken::default();
    let mut names = Vec::new();
    for step in &sequence.steps {
        let own = taken.give(&step.name);
        if own != step.name {
            let what = say!("a second step `{}`; it is called `{own}`", step.name);
            report.say(&codes::RENAMED, &step.at, what);
        }
        names.push(own);
    }
    names
}

/// The supervision and the interlock of a step; several of the same kind are alternatives.
fn guards(node: &StepNode, report: &mut Report) -> Guards {
    let mut guards = Guards::default();
    let span = report.span(&node.at);
    for supervision in kids(node.node, "Supervisions").flat_map(|n| kids(n, "Supervision")) {
        let value = network(supervision, report).and_then(|mut n| n.value("SvCoil", report));
        guards.supervision = match (guards.supervision, value) {
            (Some(a), Some(b)) => Some(nodes::or(a, b, span)),
            (a, b) => a.or(b),
        };
    }
    for interlock in kids(node.node, "Interlocks").flat_map(|n| kids(n, "Interlock")) {
        let value = network(interlock, report).and_then(|mut n| n.value("IlCoil", report));
        guards.interlock = match (guards.interlock, value) {
            (Some(a), Some(b)) => Some(nodes::and(a, b, span)),
            (a, b) => a.or(b),
        };
    }
    if guards.supervision.is_some() {
        let what =
            say!("the supervision of a step holds its transitions back; here no acknowledgement is needed");
        report.element(&codes::DIFFERENT, "Supervision", &node.at, what);
    }
    guards
}

/// Reports the times of a step, which are only supervised.
fn times(node: &StepNode, report: &mut Report) {
    let set = |name: &str| {
        let word = node.node.attribute(name)?.trim();
        word.chars().any(|c| ('1'..='9').contains(&c)).then(|| word.to_string())
    };
    if set("MaximumStepTime").or_else(|| set("WarningTime")).is_some() {
        let what = say!("the longest time and the warning time of a step are only watched, and left out");
        report.element(&codes::LEFT_OUT, "step time", &node.at, what);
    }
}

/// Declares the absolute addresses that are used.
fn addresses(document: &mut Document) {
    #[derive(Default)]
    struct Found(BTreeMap<String, (bool, Span)>);
    impl Visitor for Found {
        fn path(&mut self, path: &mut Path, how: Use, at: Span) {
            let [name] = path.names.as_slice() else { return };
            if name.text.starts_with('%') {
                let entry = self.0.entry(name.text.to_string()).or_insert((false, at));
                entry.0 |= how != Use::Read;
            }
        }
    }
    let mut found = Found::default();
    visit_mut::document(document, &mut found);
    let vars = found.0.into_iter().map(|(address, (_, at))| {
        let area = address.chars().nth(1);
        let kind = match area {
            Some('I') => VarKind::Input,
            Some('Q') => VarKind::Output,
            _ => VarKind::Var,
        };
        let ty = match address.chars().nth(2) {
            Some('B') => Type::Usint,
            Some('W') => Type::Int,
            Some('D') => Type::Dint,
            _ => Type::Bool,
        };
        let mut decl = nodes::variable(kind, &address, ty, at);
        decl.address = Some(Name::new(address.as_str(), at));
        Item::Var(decl)
    });
    let vars: Vec<Item> = vars.collect();
    document.items.splice(1..1, vars);
}
