//! The actions of a step: those of its action blocks and those that CODESYS stores with the step
//! itself.

use g7_model::codes;
use g7_model::{
    Action, ActionKind, Expr, ExprKind, Literal, Nanos, Path, Qualifier, Span, Stmt, StmtKind, Target, Work,
    say,
};

use super::draft::{Draft, Maker, block, guarded, kept};
use super::graph::{Object, Slot};
use super::read::duration;
use super::tree::{self, Language, Xml, documentation, head, kid, kids, name_of, tag, text, word};
use crate::nodes::{self, line};
use crate::st;
use crate::xml::attr::Text;

/// The identifier by which CODESYS marks the action that runs in each scan while the step is
/// active.
pub(super) const STEP_ACTION: &str = "700a583f-b4d4-43e4-8c14-629c7cd3bec8";
/// The identifiers of its actions on activation and on deactivation.
pub(super) const ENTRY_ACTION: &str = "a6b08bd8-b696-47e3-9cbf-7408b61c9ff8";
pub(super) const EXIT_ACTION: &str = "a2621e18-7de3-4ea6-ae6d-89e9e0b7befd";
/// Further attributes of a step in CODESYS that name no action.
const NO_ACTIONS: [&str; 5] = [
    "38391c6d-6d4a-42f8-8ee7-9f45e5adafa8",
    "01580b27-6378-448b-8ecb-0e4b795b58d6",
    "bc882c11-1e91-4dd8-a6b8-2075724ed18b",
    "6844a48e-46c2-4cc8-a185-a478f3b99cc0",
    "23bdaa98-72ec-41f7-817b-9dede5697086",
];

/// All actions of a step, in the order of the file.
pub(super) fn of_step<'a>(
    maker: &mut Maker<'_, '_, '_, 'a>,
    draft: &mut Draft<'_, 'a>,
    step: usize,
) -> Vec<Action> {
    let mut actions = Vec::new();
    let Some(object) = draft.graph.get(step) else { return actions };
    let own = object.node;
    for (id, value) in kept(own) {
        if value.is_empty() || NO_ACTIONS.contains(&id.as_str()) {
            continue;
        }
        let qualifier = match id.as_str() {
            STEP_ACTION => Some(Qualifier::N),
            ENTRY_ACTION => Some(Qualifier::P1),
            EXIT_ACTION => Some(Qualifier::P0),
            _ => None,
        };
        if let Some(qualifier) = qualifier {
            actions.extend(step_action(maker, draft, own, &value, qualifier));
        } else if maker.coder.action(&value, Span::default(), &draft.place).is_some() {
            let what = say!("`{value}`, which the step has in an attribute that is not known");
            maker.coder.say(&codes::NOT_CARRIED, own, what);
        }
    }
    let graph = draft.graph;
    let hanging: Vec<Xml<'a>> = graph
        .objects
        .iter()
        .filter(|o| o.kind == "actionBlock" && leads_to(draft, o, step))
        .map(|o| o.node)
        .collect();
    for hung in hanging {
        for node in kids(hung).filter(|n| tag(*n) == "action") {
            actions.extend(action(maker, draft, node));
        }
    }
    actions
}

/// True if an action block belongs to the step, directly or through connectors.
fn leads_to(draft: &Draft, block: &Object, step: usize) -> bool {
    block.flow().any(|w| {
        let mut from = w.from;
        for _ in 0..8 {
            let Some(object) = draft.graph.get(from) else { return false };
            let next = match object.kind.as_str() {
                "continuation" => draft.graph.connector(object),
                "connector" => object.flow().next().map(|w| w.from),
                _ => return from == step,
            };
            match next {
                Some(next) => from = next,
                None => return false,
            }
        }
        false
    })
}

/// Reports action blocks that belong to no step.
pub(super) fn loose(maker: &mut Maker, draft: &Draft) {
    for object in draft.graph.objects.iter().filter(|o| o.kind == "actionBlock") {
        let hangs = object.inputs.iter().filter(|i| i.slot == Slot::Flow).any(|i| !i.wires.is_empty());
        if !hangs {
            maker.coder.say(&codes::BAD_LINK, object.node, say!("an action block that hangs on no step"));
        }
    }
}

/// An action that CODESYS stores with a step; its name is that of an action of the unit.
fn step_action<'a>(
    maker: &mut Maker<'_, '_, '_, 'a>,
    draft: &mut Draft<'_, 'a>,
    step: Xml<'a>,
    name: &str,
    qualifier: Qualifier,
) -> Option<Action> {
    let at = maker.coder.report.span(&head(step));
    let Some((unit, index)) = maker.coder.action(name, at, &draft.place) else {
        let what = say!("the step's action `{name}` is not there");
        maker.coder.say(&codes::UNKNOWN_OBJECT, step, what);
        return None;
    };
    let body = maker.coder.plan.pou(unit).and_then(|p| p.actions.get(index).copied()).and_then(tree::body);
    let chart = matches!(body, Some((Language::Sfc, _)));
    let kind = if maker.plain_actions || chart || qualifier != Qualifier::N {
        let target = Target::Path(owned(maker, draft, unit, index, at));
        ActionKind::Qualified { qualifier, time: None, target, condition: None }
    } else {
        let (language, node) = body?;
        let place = draft.place.with_unit(unit);
        let statements = maker.coder.body(language, node, &place);
        let statements = guarded(draft.guard.as_ref(), statements, at);
        ActionKind::EachScan { work: Work::Block(block(statements, at)), condition: None }
    };
    Some(Action { kind, at: at.into() })
}

/// The name of an action, preceded by its chart if that is another one.
fn owned(maker: &Maker, draft: &Draft, unit: usize, index: usize, at: Span) -> Path {
    let plan = maker.coder.plan;
    let node = plan.pou(unit).and_then(|p| p.actions.get(index).copied());
    let name = node.and_then(name_of).unwrap_or_default();
    let chart = plan.units.get(unit).map(|u| u.chart.clone()).unwrap_or_default();
    let here = draft.place.inside.as_ref() == Some(&chart);
    if here { nodes::path(&[&name], at) } else { nodes::path(&[&chart, &name], at) }
}

/// One action of an action block.
fn action<'a>(maker: &mut Maker<'_, '_, '_, 'a>, draft: &mut Draft<'_, 'a>, node: Xml<'a>) -> Option<Action> {
    let at = maker.coder.report.span(&head(node));
    let qualifier = qualifier(maker, node)?;
    let time = time(maker, draft, node, qualifier);
    if let Some(indicator) = text(node, "indicator").filter(|t| !t.text.trim().is_empty()) {
        let what = say!("the indicator `{}` of an action is left out", line(&indicator.text));
        maker.coder.report.element(&codes::LEFT_OUT, "indicator", &indicator.at, what);
    }
    let target = if let Some(reference) = kid(node, "reference") {
        reference_target(maker, draft, &text(reference, "name")?)?
    } else if let Some(inline) = kid(node, "inline") {
        inline_target(maker, draft, inline)?
    } else if let Some(name) = text(node, "name").or_else(|| text(node, "actionName")) {
        reference_target(maker, draft, &name)?
    } else {
        maker.coder.say(&codes::BAD_TEXT, node, say!("an action that does nothing"));
        return None;
    };
    if documentation(node).is_some() {
        let what = say!("the documentation of an action is left out");
        maker.coder.report.element(&codes::LEFT_OUT, "documentation", &head(node), what);
    }
    // A body with a condition tests it in its own first line.
    let condition = match &target {
        Target::Path(path) if !is_action(maker, draft, path) => draft.guard.clone(),
        Target::Direct(..) | Target::Element(_) => draft.guard.clone(),
        Target::Path(_) | Target::Work(_) => None,
    };
    Some(Action { kind: ActionKind::Qualified { qualifier, time, target, condition }, at: at.into() })
}

/// True if the target is a named action with a body, not a variable.
fn is_action(maker: &Maker, draft: &Draft, path: &Path) -> bool {
    let found = maker.coder.action(&path.text(), Span::default(), &draft.place);
    let body = found.and_then(|(unit, index)| {
        maker.coder.plan.pou(unit).and_then(|p| p.actions.get(index).copied()).and_then(tree::body)
    });
    matches!(body, Some((language, _)) if language != Language::Sfc)
}

fn qualifier(maker: &mut Maker, node: Xml) -> Option<Qualifier> {
    let Some(word) = word(node, "qualifier") else { return Some(Qualifier::N) };
    let found = Qualifier::named(&word.to_ascii_uppercase());
    if found.is_none() {
        let what = say!("the qualifier `{}` has no counterpart; the action is left out", line(word));
        maker.coder.say(&codes::NOT_CARRIED, node, what);
    }
    found
}

/// The duration behind a qualifier.
fn time(maker: &mut Maker, draft: &Draft, node: Xml, qualifier: Qualifier) -> Option<Expr> {
    let written = text(node, "duration").filter(|t| !t.text.trim().is_empty());
    let at = maker.coder.report.span(&written.as_ref().map_or_else(|| head(node), |t| t.at.clone()));
    match written {
        Some(written) if qualifier.timed() => {
            let word = written.text.trim();
            let plain = word.starts_with(|c: char| c.is_ascii_digit())
                || word.contains('#')
                || word.starts_with("PT");
            if let (true, Some(time)) = (plain, duration(word)) {
                return Some(nodes::expr(ExprKind::Literal(Literal::Time(time)), at));
            }
            let raw = st::expression(&written.text, &|r| written.place(&r), maker.coder.report);
            Some(maker.coder.expr(raw, &draft.place))
        }
        Some(written) if duration(written.text.trim()) != Some(Nanos::ZERO) => {
            let what = say!("a duration with the qualifier {}, which has none, is left out", qualifier);
            maker.coder.report.say(&codes::LEFT_OUT, &written.at, what);
            None
        }
        None if qualifier.timed() => {
            let what = say!("the qualifier {} without its duration; it is taken for 0", qualifier);
            maker.coder.say(&codes::BAD_VALUE, node, what);
            Some(nodes::time(Nanos::ZERO, at))
        }
        Some(_) | None => None,
    }
}

/// A variable or an action, by its name.
fn reference_target(maker: &mut Maker, draft: &mut Draft, name: &Text) -> Option<Target> {
    let at = maker.coder.report.span(&name.at);
    let word = name.text.trim();
    if let Some(address) = word.strip_prefix('%') {
        return Some(Target::Direct(address.to_uppercase().into(), at.into()));
    }
    if let Some((unit, index)) = maker.coder.action(word, at, &draft.place) {
        return Some(Target::Path(owned(maker, draft, unit, index, at)));
    }
    if let Some((path, _)) = maker.coder.variable(word, at, &draft.place) {
        return Some(Target::Path(path));
    }
    if word.ends_with(']') {
        let raw = st::expression(&name.text, &|r| name.place(&r), maker.coder.report);
        let element = maker.coder.expr(raw, &draft.place);
        if matches!(element.kind, ExprKind::Element(..)) {
            return Some(Target::Element(Box::new(element)));
        }
    }
    let what = say!("`{}` is no variable and no action of this unit", line(word));
    maker.coder.report.say(&codes::UNKNOWN_OBJECT, &name.at, what);
    None
}

/// A body that is written in the action block.
fn inline_target<'a>(
    maker: &mut Maker<'_, '_, '_, 'a>,
    draft: &mut Draft<'_, 'a>,
    inline: Xml<'a>,
) -> Option<Target> {
    let at = maker.coder.report.span(&head(inline));
    let Some((language, body)) = tree::body(inline) else {
        maker.coder.say(&codes::BAD_TEXT, inline, say!("an action without a body"));
        return None;
    };
    if language == Language::Sfc {
        maker.coder.say(
            &codes::NOT_CARRIED,
            inline,
            say!("an action within a step that is a chart of its own"),
        );
        return None;
    }
    let statements = maker.coder.body(language, body, &draft.place);
    let statements = guarded(draft.guard.as_ref(), statements, at);
    Some(Target::Work(work(statements, at)))
}

/// A single assignment or call stands alone, other statements in braces.
fn work(mut statements: Vec<Stmt>, at: Span) -> Work {
    let single =
        matches!(statements.as_slice(), [Stmt { kind: StmtKind::Assign { .. } | StmtKind::Call(..), .. }]);
    match statements.pop() {
        Some(only) if single => Work::Single(Box::new(only)),
        last => {
            statements.extend(last);
            Work::Block(block(statements, at))
        }
    }
}
