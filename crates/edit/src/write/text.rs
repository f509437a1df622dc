//! The text of parts that several writers need: headers of steps, lists of steps, comments, and items
//! as the printer writes them.

use g7_model::{Document, Item, Name, Step, StepKind};
use g7_syntax::{Token, TokenKind, show_comment, show_name, show_step_name};

use super::lines::Sheet;

/// The text of a document with one item, as the printer writes it, without the last line end.
pub(crate) fn printed(item: Item) -> String {
    let doc = Document { items: vec![item], notes: Vec::new() };
    g7_syntax::print(&doc, None).trim_end().to_owned()
}

/// Changes, removes or adds the comment in a header; a new one is written after byte `after`.
pub(crate) fn comment(sheet: &mut Sheet<'_>, head: &[Token], after: usize, text: Option<&str>) {
    let there = head.iter().find(|t| t.kind == TokenKind::Comment);
    match (there, text) {
        (Some(t), Some(text)) => sheet.put(t.start, t.end, show_comment(text)),
        (Some(t), None) => sheet.remove_part(t.start, t.end),
        (None, Some(text)) => sheet.put(after, after, format!(" {}", show_comment(text))),
        (None, None) => {}
    }
}

/// A list of steps: `5`, `(3, 5)` or `()`.
pub(crate) fn step_list(names: &[Name]) -> String {
    match names {
        [one] => show_step_name(&one.text),
        _ => format!("({})", names.iter().map(|n| show_step_name(&n.text)).collect::<Vec<_>>().join(", ")),
    }
}

/// The words at the start of a step's header.
pub(crate) fn step_words(kind: &StepKind, initial: bool) -> String {
    let sort = match kind {
        StepKind::Plain => "step",
        StepKind::Entry => "entry step",
        StepKind::Exit => "exit step",
        StepKind::Enclosing => "enclosing step",
        StepKind::Macro(_) => "macro",
    };
    if initial { format!("initial {sort}") } else { sort.to_owned() }
}

/// The header of a step: `step 5* "comment"`, `macro M3 = Dose`.
pub(crate) fn step_header(step: &Step) -> String {
    let mut out = format!("{} {}", step_words(&step.kind, step.initial), show_name(&step.name.text));
    if let StepKind::Macro(expansion) = &step.kind {
        out.push_str(&format!(" = {}", show_name(&expansion.text)));
    }
    out.push_str(if step.linked { "*" } else { "" });
    if let Some(comment) = &step.comment {
        out.push_str(&format!(" {}", show_comment(comment)));
    }
    out
}
