//! Draws the terminal view at any size.

use g7_host::{Chronogram, Kind, Style as Window};
use g7_model::Nanos;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Borders, Clear, Paragraph};

use super::app::{App, Panel};
use super::columns;
use super::keys::HELP;
use super::lines::{DIM, HELD, ON, TITLE, item_line, short, step_line};

const FAULT: Style = Style::new().fg(Color::Red).add_modifier(Modifier::BOLD);

/// Draws everything.
pub(super) fn draw(frame: &mut Frame<'_>, app: &mut App<'_>) {
    let area = frame.area();
    if area.width < 24 || area.height < 6 {
        let text = format!("{} - enlarge the window; q quits", Nanos::new(app.runner.state().now()).plain());
        frame.render_widget(Paragraph::new(text), area);
        return;
    }
    // The lists take what they need, up to half of the screen; the chronogram takes the rest.
    let longest = Panel::ALL.into_iter().map(|p| app.listed(p).len()).chain([app.bench.steps.len()]).max();
    let lists = u16::try_from(longest.unwrap_or(0)).unwrap_or(u16::MAX).saturating_add(2);
    let lists = lists.clamp(3, (area.height / 2).max(3));
    let rows = [Constraint::Length(1), Constraint::Length(lists), Constraint::Min(0), Constraint::Length(2)];
    let [head, lists, chronogram, foot] = Layout::vertical(rows).areas(area);
    frame.render_widget(Paragraph::new(headline(app)), head);
    draw_lists(frame, app, lists);
    draw_chronogram(frame, app, chronogram);
    draw_foot(frame, app, foot);
    if app.help {
        draw_help(frame, area);
    }
}

fn headline(app: &App<'_>) -> Line<'static> {
    let (word, style) = if app.runner.halt().is_some() {
        (" FAULT ", FAULT)
    } else if app.runner.is_within_scan() {
        (" WITHIN A SCAN ", HELD)
    } else if app.is_running() {
        (" RUNS ", ON)
    } else {
        (" PAUSED ", HELD)
    };
    let plant = app.bench.plant.as_ref().map_or_else(String::new, |p| format!(" with {}", p.name));
    let profile = app.bench.compiled.unit.profile.name();
    Line::from(vec![
        Span::styled(word, style),
        Span::styled(format!("{}{plant}", app.title), TITLE),
        Span::raw(format!("  {profile}  t = {}", clock(Nanos::new(app.runner.shown().now())))),
        Span::raw(format!("  scan {}", app.runner.state().scans())),
        Span::raw(format!("  {} each", app.runner.period().plain())),
        Span::raw(format!("  ×{}", app.speed())),
    ])
}

/// The time to a hundredth of a second, so that its width stays the same.
fn clock(time: Nanos) -> String {
    let hundredths = time.count_of(Nanos::from_millis(10));
    let (minutes, seconds) = (hundredths / 6000, hundredths % 6000);
    if minutes > 0 {
        format!("{minutes}m{:02}.{:02}s", seconds / 100, seconds % 100)
    } else {
        format!("{}.{:02}s", seconds / 100, seconds % 100)
    }
}

fn draw_lists(frame: &mut Frame<'_>, app: &App<'_>, area: Rect) {
    let (panels, columns) = columns::share(app, area.width);
    let columns = Layout::horizontal(columns.into_iter().map(Constraint::Length)).split(area);
    for (panel, area) in panels.into_iter().zip(columns.iter()) {
        match panel {
            None => draw_steps(frame, app, *area),
            Some(panel) => draw_panel(frame, app, panel, *area),
        }
    }
}

fn draw_steps(frame: &mut Frame<'_>, app: &App<'_>, area: Rect) {
    let state = app.runner.shown();
    let room = usize::from(area.height.saturating_sub(2));
    let (active, rest): (Vec<_>, Vec<_>) =
        app.bench.steps.iter().partition(|s| app.bench.is_active(state, s));
    // If there is room for all steps they stay in place; otherwise the active ones come first.
    let all = app.bench.steps.len() <= room;
    let listed = if all { app.bench.steps.iter().collect() } else { [active, rest].concat() };
    let lines: Vec<Line<'_>> = listed.into_iter().take(room).map(|step| step_line(app, step)).collect();
    frame.render_widget(Paragraph::new(lines).block(framed("Steps", false)), area);
}

fn framed(title: &str, focus: bool) -> Block<'_> {
    let style = if focus { Style::new().fg(Color::Cyan) } else { DIM };
    Block::new().borders(Borders::ALL).border_style(style).title(Span::styled(title, TITLE))
}

fn draw_panel(frame: &mut Frame<'_>, app: &App<'_>, panel: Panel, area: Rect) {
    let title = match panel {
        Panel::Inputs => "Inputs",
        Panel::Outputs => "Outputs",
        Panel::Variables => "Variables",
        Panel::Plant => "Plant",
    };
    let focus = app.panel == panel;
    let listed = app.listed(panel);
    let selected = app.selected.get(panel as usize).copied().unwrap_or(0);
    let room = usize::from(area.height.saturating_sub(2)).max(1);
    let first = selected.saturating_sub(room.saturating_sub(1));
    let lines: Vec<Line<'_>> = listed
        .iter()
        .enumerate()
        .skip(first)
        .take(room)
        .filter_map(|(number, at)| {
            let number_of_input = (panel == Panel::Inputs).then_some(number);
            let line = item_line(app, *at, number_of_input, usize::from(area.width.saturating_sub(2)))?;
            Some(if focus && number == selected { line.patch_style(Modifier::REVERSED) } else { line })
        })
        .collect();
    frame.render_widget(Paragraph::new(lines).block(framed(title, focus)), area);
}

fn draw_chronogram(frame: &mut Frame<'_>, app: &mut App<'_>, area: Rect) {
    let title = if app.back == Nanos::ZERO {
        "Chronogram".to_owned()
    } else {
        format!("Chronogram, {} ago (End follows)", app.back.plain())
    };
    let block = framed(&title, false);
    let inner = block.inner(area);
    let signals = app.recording.signals();
    let moving = app.bench.lanes(&app.recording);
    let room = usize::from(inner.height.saturating_sub(1));
    app.lane = app.lane.min(moving.len().saturating_sub(room));
    let shown: Vec<usize> = moving.into_iter().skip(app.lane).take(room).collect();
    let labels = shown.iter().filter_map(|i| signals.get(*i)).map(|s| s.name.chars().count().min(24));
    let label = labels.max().unwrap_or(0);
    let columns = usize::from(inner.width).saturating_sub(label + 14).max(1);
    let to = (app.recording.end() - app.back).max(app.span());
    let until = app.recording.end();
    let window = Window { columns, from: to - app.span(), to, until };
    let drawn = Chronogram::new(&app.recording, shown, window);
    let mut lines: Vec<Line<'_>> = drawn
        .lanes
        .iter()
        .map(|lane| {
            let kind = signals.get(lane.signal).map_or(Kind::Bool, |s| s.kind);
            let style =
                if kind == Kind::Bool { Style::new().fg(Color::Green) } else { Style::new().fg(Color::Cyan) };
            Line::from(vec![
                Span::raw(format!("{:>label$} ", lane.label)),
                Span::styled(lane.cells.clone(), style),
                Span::styled(format!(" {}", short(&lane.note)), DIM),
            ])
        })
        .collect();
    if lines.is_empty() {
        lines.push(Line::styled("nothing has moved yet", DIM));
    } else {
        lines.push(Line::styled(format!("{:>label$} {}", "", drawn.axis), DIM));
    }
    frame.render_widget(Paragraph::new(lines).block(block), area);
}

fn draw_foot(frame: &mut Frame<'_>, app: &App<'_>, area: Rect) {
    let first = match &app.edit {
        Some(edit) => {
            let name = app.bench.items.get(edit.item).map_or("", |i| i.name.as_str());
            let hint = if edit.why.is_empty() { "(Enter takes it, Esc does not)" } else { edit.why.as_str() };
            let style = if edit.why.is_empty() { HELD } else { FAULT };
            Line::from(vec![
                Span::styled(format!("{name} := {}_   ", edit.text), HELD),
                Span::styled(hint.to_owned(), style),
            ])
        }
        None => {
            let style = if app.runner.halt().is_some() { FAULT } else { HELD };
            Line::styled(app.message.clone(), style)
        }
    };
    let keys = if app.edit.is_some() { EDIT_KEYS.to_owned() } else { hints(area.width) };
    frame.render_widget(Paragraph::new(vec![first, Line::styled(keys, DIM)]), area);
}

/// The keys while a value is typed.
const EDIT_KEYS: &str = "typing a value: no key operates anything else   Enter takes it  Esc leaves it";
/// The keys in the last line, in the order of the line; where there is no room for all, those with the greatest
/// number are left out first.
const HINTS: [(u8, &str); 9] = [
    (2, "1-9 a-z inputs"),
    (1, "Space run/pause"),
    (4, ". scan"),
    (6, ", pass"),
    (5, "+ - speed"),
    (3, "Tab Up Down Enter change"),
    (7, "F hold"),
    (0, "? help"),
    (0, "q quit"),
];

/// As many keys as fit.
fn hints(width: u16) -> String {
    let line = |least: u8| {
        let shown: Vec<&str> =
            HINTS.iter().filter(|(rank, _)| *rank <= least).map(|(_, text)| *text).collect();
        shown.join("  ")
    };
    let fits = (0..=7).rev().map(line).find(|text| text.len() <= usize::from(width));
    fits.unwrap_or_else(|| line(0))
}

fn draw_help(frame: &mut Frame<'_>, area: Rect) {
    let width = area.width.min(56);
    let height = area.height.min(HELP.len() as u16 + 2);
    let popup =
        Rect { x: area.x + (area.width - width) / 2, y: area.y + (area.height - height) / 2, width, height };
    let lines: Vec<Line<'_>> = HELP
        .iter()
        .map(|(key, what)| Line::from(vec![Span::styled(format!(" {key:<11} "), TITLE), Span::raw(*what)]))
        .collect();
    frame.render_widget(Clear, popup);
    frame.render_widget(Paragraph::new(lines).block(framed("Keys", true)), popup);
}
