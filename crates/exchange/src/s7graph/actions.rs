//! The actions of a step: a qualifier, perhaps an event, and the words of an operation.

use std::collections::HashMap;
use std::ops::Range;

use g7_model::codes;
use g7_model::{
    Action, ActionKind, Expr, ExprKind, Path, Qualifier, Span, Stmt, StmtKind, Target, UnaryOp, say,
};

use super::network::symbol;
use super::read::Xml;
use g7_iec::nodes::{self, assign, boolean, when};
use g7_iec::report::Report;
use g7_iec::st;
use g7_iec::xml::attr;
use g7_model::visit_mut::{self, Use, Visitor};

/// The supervision and the interlock of a step.
#[derive(Clone, Debug, Default)]
pub(super) struct Guards {
    pub(super) interlock: Option<Expr>,
    pub(super) supervision: Option<Expr>,
}

/// The words of an action as text, with the place of each piece. Names that a text cannot hold are
/// replaced by placeholders.
#[derive(Default)]
struct Words {
    text: String,
    pieces: Vec<(Range<usize>, Range<usize>)>,
    names: HashMap<String, Vec<String>>,
}

impl Words {
    fn push(&mut self, text: &str, at: &Range<usize>) {
        let start = self.text.len();
        self.text.push_str(text);
        self.pieces.push((start..self.text.len(), at.clone()));
    }

    /// Adds a name as a placeholder that any parser reads.
    fn name(&mut self, names: Vec<String>, at: &Range<usize>) {
        let stand_in = format!("v__{}", self.names.len());
        self.push(&stand_in, at);
        self.names.insert(stand_in.to_uppercase(), names);
    }

    fn place(&self, part: &Range<usize>) -> Range<usize> {
        let found = |byte: usize| {
            let index = self.pieces.partition_point(|(text, _)| text.start <= byte).saturating_sub(1);
            self.pieces.get(index).map(|(_, at)| at.clone()).unwrap_or_default()
        };
        let (from, to) = (found(part.start), found(part.end.saturating_sub(1).max(part.start)));
        from.start..to.end.max(from.start)
    }
}

/// Replaces the placeholders by the names.
struct Names<'a>(&'a HashMap<String, Vec<String>>);

impl Visitor for Names<'_> {
    fn path(&mut self, path: &mut Path, _: Use, at: Span) {
        let Some((first, rest)) = path.names.split_first() else { return };
        let Some(own) = self.0.get(&first.text.to_uppercase()) else { return };
        let own: Vec<&str> = own.iter().map(String::as_str).collect();
        let mut whole = nodes::path(&own, at);
        whole.names.extend(rest.iter().cloned());
        *path = whole;
    }
}

/// The words of an action element.
fn words(node: Xml) -> Words {
    let mut words = Words::default();
    for piece in node.children().filter(Xml::is_element) {
        let at = attr::head(piece);
        match piece.tag_name().name() {
            "Access" => match symbol(piece) {
                Some(names) => words.name(names, &at),
                None => {
                    let value = piece.descendants().find(|n| n.tag_name().name() == "ConstantValue");
                    let text = value.map(|n| attr::content(n).text).unwrap_or_default();
                    words.push(&text, &at);
                }
            },
            "Token" => {
                if let Some(text) = attr::text(piece, "Text") {
                    token(&text.text, &text.at, &mut words);
                }
            }
            "Blank" | "NewLine" => words.push(" ", &at),
            "Text" | "ConstantValue" => words.push(&attr::content(piece).text, &at),
            _ => {}
        }
    }
    words
}

/// A token may hold more than one word: `"Motor" := #Speed`.
fn token(text: &str, at: &Range<usize>, words: &mut Words) {
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        if let Some(quoted) = rest.strip_prefix('"')
            && let Some((own, behind)) = quoted.split_once('"')
        {
            let mut names = vec![nodes::line(&own.replace('`', "'"))];
            rest = behind;
            // `"DB".member`
            while let Some(member) = rest.strip_prefix('.') {
                let end = member.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(member.len());
                let (own, behind) = member.split_at(end);
                if own.is_empty() {
                    break;
                }
                names.push(own.to_string());
                rest = behind;
            }
            words.name(names, at);
        } else if let Some(local) = rest.strip_prefix('#')
            && !words.text.ends_with(|c: char| c.is_alphanumeric())
        {
            rest = local;
        } else {
            let end = rest
                .char_indices()
                .skip(1)
                .find(|(_, c)| matches!(c, '"' | '#'))
                .map_or(rest.len(), |(i, _)| i);
            let piece = rest.get(..end.max(c.len_utf8())).unwrap_or(rest);
            words.push(piece, at);
            rest = rest.get(piece.len()..).unwrap_or("");
        }
    }
    words.push(" ", at);
}

/// The actions of a step.
pub(super) fn actions(step: Xml, guards: &Guards, report: &mut Report) -> Vec<Action> {
    let mut list = Vec::new();
    for node in super::read::kids(step, "Actions").flat_map(|n| super::read::kids(n, "Action")) {
        list.extend(action(node, guards, report));
    }
    list
}

/// The effect of an action.
enum Deed {
    /// A Boolean variable, perhaps with a time.
    Variable(Path, Option<Expr>),
    /// Statements.
    Work(Vec<Stmt>),
}

fn action(node: Xml, guards: &Guards, report: &mut Report) -> Option<Action> {
    let range = attr::head(node);
    let at = report.span(&range);
    let words = words(node);
    if words.text.trim().is_empty() {
        return None;
    }
    let qualifier = node.attribute("Qualifier").unwrap_or("N").trim().to_ascii_uppercase();
    let event = node.attribute("Event").unwrap_or("").trim().to_ascii_uppercase();
    let locked = node.attribute("Interlock").is_some_and(|w| w.trim() == "true");
    let kind = match qualifier.as_str() {
        "N" | "" => Qualifier::N,
        "S" => Qualifier::S,
        "R" => Qualifier::R,
        "D" => Qualifier::D,
        "L" => Qualifier::L,
        other => {
            let what = say!("the qualifier `{}` of an action has no counterpart", nodes::line(other));
            report.say(&codes::NOT_CARRIED, &range, what);
            return None;
        }
    };
    let deed = deed(&words, kind, &range, report)?;
    let condition = if locked { guards.interlock.clone() } else { None };
    if !event.is_empty() {
        return on_event(&event, kind, deed, condition, guards, &range, report);
    }
    let kind = match deed {
        Deed::Variable(path, time) => {
            if kind.timed() && time.is_none() {
                let what = say!("the qualifier `{}` without its time", kind.name());
                report.say(&codes::BAD_VALUE, &range, what);
                return None;
            }
            ActionKind::Qualified { qualifier: kind, time, target: Target::Path(path), condition }
        }
        Deed::Work(list) => ActionKind::EachScan { work: nodes::work(list, at), condition },
    };
    Some(Action { kind, at: at.into() })
}

/// Parses the words of an action.
fn deed(words: &Words, kind: Qualifier, range: &Range<usize>, report: &mut Report) -> Option<Deed> {
    let place = |part: Range<usize>| words.place(&part);
    if words.text.contains(":=") || words.text.contains('(') && kind == Qualifier::N {
        let mut list = st::single::statements(&words.text, &place, report);
        visit_mut::stmts(&mut list, &mut Names(&words.names));
        let whole = list.iter().all(|s| matches!(s.kind, StmtKind::Assign { .. } | StmtKind::Call(..)));
        if list.is_empty() || !whole {
            return None;
        }
        return Some(Deed::Work(list));
    }
    let (target, time) = match words.text.split_once(',') {
        Some((target, time)) => (target, Some((target.len() + 1, time))),
        None => (words.text.as_str(), None),
    };
    let mut target = st::single::expression(target, &place, report);
    visit_mut::expr(&mut target, &mut Names(&words.names));
    let time = time.map(|(skip, text)| {
        let place = |part: Range<usize>| words.place(&(part.start + skip..part.end + skip));
        let mut time = st::single::expression(text, &place, report);
        visit_mut::expr(&mut time, &mut Names(&words.names));
        time
    });
    match target.kind {
        ExprKind::Path(path) => Some(Deed::Variable(path, time)),
        ExprKind::Bad => None,
        _ => {
            report.say(&codes::BAD_TEXT, range, say!("an action that is no variable and no assignment"));
            None
        }
    }
}

/// An action that waits for an event: S1 and S0 are activation and deactivation of the step, V1 and
/// V0 begin and end of the supervised condition, L0 and L1 those of the interlock.
fn on_event(
    event: &str,
    kind: Qualifier,
    deed: Deed,
    condition: Option<Expr>,
    guards: &Guards,
    range: &Range<usize>,
    report: &mut Report,
) -> Option<Action> {
    let at = report.span(range);
    let statements = match deed {
        Deed::Work(list) => list,
        Deed::Variable(path, time) => {
            if time.is_some() {
                report.say(
                    &codes::NOT_CARRIED,
                    range,
                    say!("an action with an event and a time has no counterpart"),
                );
                return None;
            }
            if kind == Qualifier::N {
                let what = say!("`N` with an event: the variable stays TRUE here, one scan only in GRAPH");
                report.say(&codes::DIFFERENT, range, what);
            }
            let target = nodes::expr(ExprKind::Path(path), at);
            vec![assign(target, boolean(kind != Qualifier::R, at), at)]
        }
    };
    let statements = match condition {
        Some(condition) => vec![when(condition, statements, Vec::new(), at)],
        None => statements,
    };
    let work = nodes::work(statements, at);
    let edge = |guard: &Option<Expr>, op: UnaryOp| guard.clone().map(|g| nodes::unary(op, g, at));
    let event = match event {
        "S1" => return Some(nodes::qualified(Qualifier::P1, None, Target::Work(work), None, at)),
        "S0" => return Some(nodes::qualified(Qualifier::P0, None, Target::Work(work), None, at)),
        "V1" => edge(&guards.supervision, UnaryOp::Rise),
        "V0" => edge(&guards.supervision, UnaryOp::Fall),
        "L1" => edge(&guards.interlock, UnaryOp::Fall),
        "L0" => edge(&guards.interlock, UnaryOp::Rise),
        other => {
            let what = say!("the event `{}` has no counterpart", nodes::line(other));
            report.say(&codes::NOT_CARRIED, range, what);
            return None;
        }
    };
    match event {
        Some(event) => Some(Action { kind: ActionKind::OnEvent { event, work }, at: at.into() }),
        None => {
            let what = say!("an action that waits for the supervision or interlock of a step that has none");
            report.say(&codes::LEFT_OUT, range, what);
            None
        }
    }
}
