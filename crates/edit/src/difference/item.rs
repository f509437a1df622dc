//! Changes the fields of steps, transitions and variables in place.

use std::mem::discriminant;

use g7_model::{Action, Expr, Span, Step, StepKind, Transition, VarDecl};
use g7_syntax::{Part, Token, TokenKind, print_expr, print_part, show_comment, show_name};

use super::lines::{Sheet, reindent};
use super::list::{Block, Style, list};
use crate::draft::{Draft, is_fresh};

pub(super) fn expr_text(e: &Expr, draft: &Draft<'_>) -> String {
    draft.typed(e.at.0).unwrap_or_else(|| print_expr(e))
}

// Steps

/// Changes a step in place.
#[inline(never)]
pub(crate) fn edit_step(sheet: &mut Sheet<'_>, draft: &Draft<'_>, old: &Step, new: &Step) {
    let (start, end) = (old.at.0.start as usize, old.at.0.end as usize);
    let (head, open) = sheet.header(start, end);
    let name = old.name.at.0;
    if old.initial != new.initial || discriminant(&old.kind) != discriminant(&new.kind) {
        let words = print_part(Part::StepWords(&new.kind, new.initial), None);
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
        sheet.put_comment(&head, after, new.comment.as_deref());
    }
    let head_end = head.last().map_or(after, |t| t.end);
    edit_actions(sheet, draft, old, new, (head_end, open));
}

#[inline(never)]
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
    let anew = |sheet: &Sheet<'_>, header: usize| {
        let column = sheet.slice(sheet.line_start(header), header).chars().count();
        let text = print_part(Part::Actions(&new.actions, column), Some(&|at| spelled(sheet, draft, at)));
        reindent(&text, "", &outer, sheet.newline)
    };
    let Some(open) = open else {
        let text = anew(sheet, head_end);
        return sheet.put(head_end, head_end, format!(" {text}"));
    };
    let notes = sheet.has_notes(open.start, end);
    if new.actions.is_empty() && !notes {
        return sheet.put(head_end, end, "");
    }
    let one_line = !sheet.slice(open.start, end).contains('\n');
    if !notes && (one_line || old.actions.is_empty()) {
        let text = anew(sheet, open.start);
        return sheet.put(open.start, end, text);
    }
    let block = Block { open: Some(open.end), close: end - 1, indent: format!("{outer}  "), outer: &outer };
    list(sheet, &old.actions, &new.actions, &block, &Actions { draft });
}

/// The text of an action that stays, or of a new part as it was typed.
fn spelled(sheet: &Sheet<'_>, draft: &Draft<'_>, at: Span) -> Option<String> {
    if is_fresh(at.into()) {
        return draft.typed(at);
    }
    Some(reindent(sheet.of(at), sheet.indent(at.start as usize), "", "\n"))
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
        let text = print_part(Part::Action(new), Some(&|at| spelled(sheet, self.draft, at)));
        format!("{indent}{}", reindent(&text, "", indent, sheet.newline))
    }

    fn apart(&self, _: &Action, _: &Action) -> bool {
        false
    }
}

// Transitions

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

#[inline(never)]
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
#[inline(never)]
pub(crate) fn edit_transition(sheet: &mut Sheet<'_>, draft: &Draft<'_>, old: &Transition, new: &Transition) {
    if old == new && !is_fresh(new.receptivity.at) {
        return;
    }
    let Some(parts) = parts(sheet, old) else { return };
    if let (false, Some((start, end))) = (old.chained, parts.from) {
        let shown = new.label.as_ref().map(|l| print_part(Part::Label(l), None) + " ");
        match (parts.label, shown) {
            (Some((from, to)), Some(text)) if old.label != new.label => sheet.put(from, to, text),
            (Some((from, to)), None) => sheet.put(from, to, ""),
            (None, Some(text)) => sheet.put(start, start, text),
            _ => {}
        }
        if old.from != new.from {
            sheet.put(start, end, print_part(Part::Steps(&new.from), None));
        }
    }
    if old.to != new.to {
        sheet.put(parts.to.0, parts.to.1, print_part(Part::Steps(&new.to), None));
    }
    if old.receptivity != new.receptivity || is_fresh(new.receptivity.at) {
        sheet.put(parts.receptivity.0, parts.receptivity.1, expr_text(&new.receptivity, draft));
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

/// Changes the declaration of a variable.
#[inline(never)]
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
            sheet.put(start, end, print_part(Part::Variable(new), Some(&|at| draft.typed(at))));
        }
    }
}
