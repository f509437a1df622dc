//! Writes the fields of steps, transitions and variables.

use std::collections::HashMap;

use g7_model::{Action, ActionKind, Chart, ChartKind, Expr, Item, Place, Span, Step, StepKind, Transition};
use g7_model::{ChartItem, Name, VarDecl, VarKind};
use g7_syntax::{Token, TokenKind, print_expr, show_comment, show_name, show_step_name};

use super::lines::{Sheet, reindent};
use super::list::{Block, Style, list};
use super::text::{comment, printed, step_header, step_list, step_words};
use crate::draft::{Draft, is_fresh};

/// The texts of new parts as they were typed, by their places.
type Raw = HashMap<u32, String>;

fn raw(at: Place, raw: &Raw) -> Option<&String> {
    raw.get(&at.0.start).filter(|_| is_fresh(at))
}

fn expr_text(e: &Expr, texts: &Raw) -> String {
    raw(e.at, texts).cloned().unwrap_or_else(|| print_expr(e))
}

// Steps

/// The text of a new step.
pub(crate) fn step_text(step: &Step, texts: &Raw) -> String {
    let head = step_header(step);
    if step.actions.is_empty() {
        return head;
    }
    let actions: Vec<String> = step.actions.iter().map(|a| action_text(a, texts)).collect();
    format!("{head} {}", braces(&actions, "", "\n"))
}

/// Writes actions in braces; a single short action stays on the line of the step.
fn braces(actions: &[String], indent: &str, newline: &str) -> String {
    if let [one] = actions
        && one.len() <= 60
        && !one.contains(['\n'])
        && !one.contains("//")
    {
        return format!("{{ {one} }}");
    }
    let lines: Vec<String> = actions
        .iter()
        .map(|a| format!("{indent}  {}", reindent(a, "", &format!("{indent}  "), newline)))
        .collect();
    format!("{{{newline}{}{newline}{indent}}}", lines.join(newline))
}

/// The text of a new action.
fn action_text(action: &Action, texts: &Raw) -> String {
    if let Some(text) = raw(action.at, texts) {
        return text.clone();
    }
    if let ActionKind::Comment(text) = &action.kind {
        return show_comment(text);
    }
    let at = Place::default();
    let name = Name { text: "1".into(), at };
    let step = Step {
        name: name.clone(),
        kind: StepKind::Plain,
        initial: false,
        linked: false,
        comment: None,
        actions: vec![action.clone()],
        braces: true,
        at,
    };
    let chart = Chart {
        kind: ChartKind::Chart,
        name,
        comment: None,
        every: None,
        items: vec![ChartItem::Step(step)],
        at,
    };
    let text = printed(Item::Chart(chart));
    let inside = text.split_once('{').and_then(|(_, t)| t.split_once('{')).map_or("", |(_, t)| t);
    let inside = inside.trim_end().strip_suffix('}').map_or(inside, str::trim_end);
    let inside = inside.strip_suffix('}').unwrap_or(inside).trim();
    reindent(inside, "    ", "", "\n")
}

/// Changes a step in place.
pub(crate) fn edit_step(sheet: &mut Sheet<'_>, draft: &Draft<'_>, old: &Step, new: &Step) {
    let (start, end) = (old.at.0.start as usize, old.at.0.end as usize);
    let (head, open) = sheet.header(start, end);
    let name = old.name.at.0;
    if (old.initial, kind_word(&old.kind)) != (new.initial, kind_word(&new.kind)) {
        let words = step_words(&new.kind, new.initial);
        sheet.put(start, name.start as usize, format!("{words} "));
    }
    let mut after = name.end as usize;
    match (&old.kind, &new.kind) {
        (StepKind::Macro(a), StepKind::Macro(b)) => {
            after = a.at.0.end as usize;
            if a != b {
                sheet.put(a.at.0.start as usize, after, show_name(&b.text));
            }
        }
        (StepKind::Macro(a), _) => sheet.put(name.end as usize, a.at.0.end as usize, ""),
        (_, StepKind::Macro(b)) => {
            sheet.put(after, after, format!(" = {}", show_name(&b.text)));
        }
        _ => {}
    }
    let star = head.iter().find(|t| t.kind == TokenKind::Star);
    after = after.max(star.map_or(0, |t| t.end));
    if old.comment != new.comment {
        comment(sheet, &head, after, new.comment.as_deref());
    }
    let head_end = head.last().map_or(after, |t| t.end);
    edit_actions(sheet, draft, old, new, (head_end, open));
}

fn kind_word(kind: &StepKind) -> String {
    step_words(kind, false)
}

fn edit_actions(
    sheet: &mut Sheet<'_>,
    draft: &Draft<'_>,
    old: &Step,
    new: &Step,
    (head_end, open): (usize, Option<Token>),
) {
    let (start, end) = (old.at.0.start as usize, old.at.0.end as usize);
    let same = old.actions.iter().map(|a| a.at.0).eq(new.actions.iter().map(|a| a.at.0));
    if same {
        return; // A changed action is a new one at the same place.
    }
    let outer = sheet.indent(start).to_owned();
    let newline = sheet.newline;
    let texts: Vec<String> = new.actions.iter().map(|a| text_of(sheet, draft, a)).collect();
    let Some(open) = open else {
        return sheet.put(head_end, head_end, format!(" {}", braces(&texts, &outer, newline)));
    };
    let notes = sheet.has_notes(open.start, end);
    if new.actions.is_empty() && !notes {
        return sheet.put(head_end, end, "");
    }
    let one_line = !sheet.slice(open.start, end).contains('\n');
    if !notes && (one_line || old.actions.is_empty()) {
        return sheet.put(open.start, end, braces(&texts, &outer, newline));
    }
    let block = Block { open: Some(open.end), close: end - 1, indent: format!("{outer}  "), outer: &outer };
    list(sheet, &old.actions, &new.actions, &block, &Actions { draft });
}

/// The text of an action: from the file, or new.
fn text_of(sheet: &Sheet<'_>, draft: &Draft<'_>, action: &Action) -> String {
    if is_fresh(action.at) {
        return action_text(action, &draft.raw);
    }
    let at = action.at.0;
    reindent(sheet.of(at), sheet.indent(at.start as usize), "", "\n")
}

struct Actions<'d, 's> {
    draft: &'d Draft<'s>,
}

impl Style<Action> for Actions<'_, '_> {
    fn at(&self, thing: &Action) -> Span {
        thing.at.0
    }

    fn edit(&self, _: &mut Sheet<'_>, _: &Action, _: &Action) {}

    fn fresh(&self, sheet: &Sheet<'_>, new: &Action, indent: &str) -> String {
        let text = text_of(sheet, self.draft, new);
        format!("{indent}{}", reindent(&text, "", indent, sheet.newline))
    }

    fn apart(&self, _: &Action, _: &Action) -> bool {
        false
    }
}

// Transitions

/// The text of a new transition.
pub(crate) fn transition_text(t: &Transition, texts: &Raw) -> String {
    let mut out = t.label.as_ref().map_or(String::new(), |l| format!("{}: ", show_step_name(&l.text)));
    let when = expr_text(&t.receptivity, texts);
    out.push_str(&format!("{} -> {} when {when}", step_list(&t.from), step_list(&t.to)));
    if let Some(n) = t.priority {
        out.push_str(&format!(" priority {n}"));
    }
    if let Some(comment) = &t.comment {
        out.push_str(&format!(" {}", show_comment(comment)));
    }
    out
}

/// Where the parts of a transition stand in the text.
struct Parts {
    /// The label and its colon.
    label: Option<(usize, usize)>,
    from: Option<(usize, usize)>,
    to: (usize, usize),
    receptivity: (usize, usize),
    priority: Option<(usize, usize)>,
    comment: Option<(usize, usize)>,
    /// The end of the last clause before `on clearing`.
    clauses_end: usize,
}

fn parts(sheet: &Sheet<'_>, t: &Transition) -> Option<Parts> {
    let tokens = sheet.tokens(t.at.0.start as usize, t.at.0.end as usize);
    let arrow = tokens.iter().position(|x| x.kind == TokenKind::Arrow)?;
    let when = tokens.iter().position(|x| x.kind == TokenKind::Word && sheet.word(x) == "when")?;
    let region = |list: &[Token]| Some((list.first()?.start, list.last()?.end));
    let mut before = tokens.get(..arrow)?;
    let label = match before {
        [name, colon, rest @ ..] if colon.kind == TokenKind::Colon => {
            before = rest;
            Some((name.start, rest.first().map_or(colon.end, |r| r.start)))
        }
        _ => None,
    };
    let rest = tokens.get(when + 1..)?;
    let on = rest.windows(2).enumerate().position(|(k, w)| {
        let next = rest.get(k + 2).map(|t| t.kind);
        matches!(w, [a, b] if sheet.word(a) == "on" && sheet.word(b) == "clearing")
            && matches!(next, Some(TokenKind::LBrace | TokenKind::Colon))
    });
    let rest = rest.get(..on.unwrap_or(rest.len()))?;
    let word = |x: &Token| x.kind == TokenKind::Word && sheet.word(x) == "priority";
    let priority = rest.iter().position(word);
    let comment = rest.iter().position(|x| x.kind == TokenKind::Comment);
    let clause = [priority, comment].into_iter().flatten().min().unwrap_or(rest.len());
    Some(Parts {
        label,
        from: region(before),
        to: region(tokens.get(arrow + 1..when)?)?,
        receptivity: region(rest.get(..clause)?)?,
        priority: priority.and_then(|k| region(rest.get(k..k + 2)?)),
        comment: comment.and_then(|k| region(rest.get(k..=k)?)),
        clauses_end: rest.last()?.end,
    })
}

/// Changes a transition in place. If the transition leaves a chain, the caller writes the part
/// before its arrow.
pub(crate) fn edit_transition(sheet: &mut Sheet<'_>, draft: &Draft<'_>, old: &Transition, new: &Transition) {
    if old == new && !is_fresh(new.receptivity.at) {
        return;
    }
    let Some(parts) = parts(sheet, old) else { return };
    if let (false, Some((start, end))) = (old.chained, parts.from) {
        let shown = new.label.as_ref().map(|l| format!("{}: ", show_step_name(&l.text)));
        match (parts.label, shown) {
            (Some((from, to)), Some(text)) if old.label != new.label => sheet.put(from, to, text),
            (Some((from, to)), None) => sheet.put(from, to, ""),
            (None, Some(text)) => sheet.put(start, start, text),
            _ => {}
        }
        if old.from != new.from {
            sheet.put(start, end, step_list(&new.from));
        }
    }
    if old.to != new.to {
        sheet.put(parts.to.0, parts.to.1, step_list(&new.to));
    }
    if old.receptivity != new.receptivity || is_fresh(new.receptivity.at) {
        sheet.put(parts.receptivity.0, parts.receptivity.1, expr_text(&new.receptivity, &draft.raw));
    }
    if old.priority != new.priority {
        let text = new.priority.map(|n| format!("priority {n}"));
        clause(sheet, parts.priority, parts.receptivity.1, text);
    }
    if old.comment != new.comment {
        clause(sheet, parts.comment, parts.clauses_end, new.comment.as_deref().map(show_comment));
    }
}

fn clause(sheet: &mut Sheet<'_>, there: Option<(usize, usize)>, after: usize, text: Option<String>) {
    match (there, text) {
        (Some((start, end)), Some(text)) => sheet.put(start, end, text),
        (Some((start, end)), None) => sheet.remove_part(start, end),
        (None, Some(text)) => sheet.put(after, after, format!(" {text}")),
        (None, None) => {}
    }
}

// Variables

/// The text of a new declaration, with the values as they were typed.
pub(crate) fn variable_text(v: &VarDecl, texts: &Raw) -> String {
    let class = match v.kind {
        VarKind::Input => "input",
        VarKind::Output => "output",
        VarKind::Var => "var",
        VarKind::Const => "const",
    };
    let names: Vec<String> = v.names.iter().map(|n| show_name(&n.text)).collect();
    let mut out = format!("{class} {} : {}", names.join(", "), v.ty);
    if let Some(e) = &v.init {
        out.push_str(&format!(" := {}", expr_text(e, texts)));
    }
    if let Some(address) = &v.address {
        let bare = VarDecl { init: None, safe: None, comment: None, ..v.clone() };
        let text = printed(Item::Var(VarDecl { inverted: false, retain: false, ..bare }));
        let plain = format!("{class} {} : {}", names.join(", "), v.ty);
        out.push_str(text.strip_prefix(plain.as_str()).unwrap_or(&format!(" at {}", address.text)));
    }
    out.push_str(if v.inverted { " inverted" } else { "" });
    out.push_str(if v.retain { " retain" } else { "" });
    if let Some(e) = &v.safe {
        out.push_str(&format!(" safe {}", expr_text(e, texts)));
    }
    if let Some(comment) = &v.comment {
        out.push_str(&format!(" {}", show_comment(comment)));
    }
    out
}

/// Changes the declaration of a variable.
pub(crate) fn edit_variable(sheet: &mut Sheet<'_>, draft: &Draft<'_>, old: &VarDecl, new: &VarDecl) {
    if old == new {
        return;
    }
    let list = |v: &VarDecl| v.names.iter().map(|n| show_name(&n.text)).collect::<Vec<_>>().join(", ");
    let only_names = *old == VarDecl { names: old.names.clone(), ..new.clone() };
    match (old.names.first(), old.names.last()) {
        (Some(a), Some(b)) if only_names => {
            sheet.put(a.at.0.start as usize, b.at.0.end as usize, list(new));
        }
        _ => {
            let (start, end) = (old.at.0.start as usize, old.at.0.end as usize);
            sheet.put(start, end, variable_text(new, &draft.raw));
        }
    }
}
