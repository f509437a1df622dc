//! The lines of the lists: one for each step and each item. The widths of the lists follow from them.

use g7_host::Kind;
use g7_rig::{Role, StepItem};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};

use super::app::App;

pub(super) const ON: Style = Style::new().fg(Color::Green).add_modifier(Modifier::BOLD);
pub(super) const DIM: Style = Style::new().add_modifier(Modifier::DIM);
pub(super) const TITLE: Style = Style::new().add_modifier(Modifier::BOLD);
pub(super) const HELD: Style = Style::new().fg(Color::Yellow);

/// A line for a step; the comment comes last, because a narrow panel cuts the end off.
pub(super) fn step_line<'a>(app: &App<'_>, step: &'a StepItem) -> Line<'a> {
    let state = app.runner.shown();
    let on = app.bench.is_active(state, step);
    let time = app.bench.step_time(state, step).filter(|_| on);
    let mut spans = vec![Span::raw(format!("{} {}", if on { "■" } else { "□" }, step.name))];
    spans.extend(time.map(|t| Span::raw(format!(" {t}"))));
    spans.extend(step.comment.as_ref().map(|c| Span::raw(format!(" {c}"))));
    Line::from(spans).style(if on { ON } else { DIM })
}

/// A line for an item, in a list of this width. Where the list is too narrow, the comment is cut off first, then
/// the end of the name. The value is always shown.
pub(super) fn item_line<'a>(
    app: &App<'a>,
    at: usize,
    number: Option<usize>,
    room: usize,
) -> Option<Line<'a>> {
    let item = app.bench.items.get(at)?;
    if let (Some(table), Some((_, state))) = (app.table(at), app.runner.plant()) {
        return Some(Line::raw(table.show(state)));
    }
    let value = match item.role {
        // The value that the next scan reads, so that a key shows its effect even while paused.
        Role::Input(index) if item.words == 1 => g7_host::Value::Word(app.runner.input(index)),
        _ => app.bench.value(&app.runner, item),
    };
    let mut spans = Vec::new();
    if let Some(number) = number {
        let key = app.input_key(number).map_or_else(|| "   ".to_owned(), |k| format!("[{k}]"));
        spans.push(Span::styled(format!("{key} "), TITLE));
    }
    if item.kind == Kind::Bool {
        let on = value.word() != 0;
        spans.push(Span::styled(if on { "● " } else { "○ " }, if on { ON } else { DIM }));
        spans.push(Span::styled(item.name.as_str(), if on { ON } else { Style::new() }));
    } else {
        let value = format!(" = {}", short(&item.show(&value)));
        let taken: usize = spans.iter().map(Span::width).sum::<usize>() + value.chars().count();
        spans.push(Span::raw(cut(&item.name, room.saturating_sub(taken)) + &value));
    }
    if app.bench.is_forced(&app.runner, item) {
        spans.push(Span::styled(" held", HELD));
    } else if app.bench.is_driven(&app.runner, item) {
        spans.push(Span::styled(" plant", DIM));
    }
    if let Some(comment) = &item.comment {
        spans.push(Span::styled(format!(" {comment}"), DIM));
    }
    Some(Line::from(spans))
}

/// A name in this many characters; at least the first of it is left.
fn cut(name: &str, room: usize) -> String {
    if name.chars().count() <= room {
        return name.to_owned();
    }
    name.chars().take(room.saturating_sub(1).max(1)).chain(['…']).collect()
}

/// A value as text, with fewer decimals and visible control characters.
pub(super) fn short(text: &str) -> String {
    let text: String = text.chars().take(40).map(|c| if c.is_control() { '␀' } else { c }).collect();
    match text.split_once('.') {
        Some((whole, decimals))
            if whole.parse::<i64>().is_ok() && decimals.bytes().all(|b| b.is_ascii_digit()) =>
        {
            format!("{whole}.{}", decimals.get(..3).unwrap_or(decimals))
        }
        _ => text,
    }
}
