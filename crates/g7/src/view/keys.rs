//! The keys of the terminal view.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use g7_host::Start;
use g7_model::Nanos;

use super::app::App;

/// The keys and their effects, for the help.
pub(super) const HELP: [(&str, &str); 15] = [
    ("1-9 a-z", "turn the input with that key"),
    ("Space", "run, pause"),
    (".", "one scan"),
    (",", "one pass of a scan"),
    ("+ -", "faster, slower"),
    ("Tab", "next list"),
    ("Up Down", "select in the list"),
    ("Enter", "turn or type the selected value"),
    ("F", "hold the selected value, or let it go"),
    ("Left Right", "chronogram: back and forth in time"),
    ("End", "chronogram: follow again"),
    ("[ ]", "chronogram: less or more time"),
    ("PgUp PgDn", "chronogram: other signals"),
    ("R C", "restart warm, cold"),
    ("q Ctrl-C", "quit"),
];

/// Executes the command of a key.
pub(super) fn press(app: &mut App<'_>, key: KeyEvent) {
    if key.kind == KeyEventKind::Release {
        return;
    }
    let control = key.modifiers.contains(KeyModifiers::CONTROL);
    if control && matches!(key.code, KeyCode::Char('c' | 'd')) {
        return app.quit();
    }
    if app.edit.is_some() {
        return type_value(app, key.code);
    }
    if app.help {
        app.help = false;
        return;
    }
    match key.code {
        KeyCode::Char('q') | KeyCode::Esc => app.quit(),
        KeyCode::Char('?') | KeyCode::F(1) => app.help = true,
        KeyCode::Char(' ') => {
            let running = app.is_running();
            app.pause(running);
        }
        KeyCode::Char('.') => app.scan_once(),
        KeyCode::Char(',') => app.pass_once(),
        KeyCode::Char('+' | '=') => app.faster(1),
        KeyCode::Char('-') => app.faster(-1),
        KeyCode::Char('[') => app.zoom(-1),
        KeyCode::Char(']') => app.zoom(1),
        KeyCode::Char('F') => app.toggle_force(),
        KeyCode::Char('R') => app.restart(Start::Warm),
        KeyCode::Char('C') => app.restart(Start::Cold),
        KeyCode::Char(c) if !control => app.press_input(c),
        KeyCode::Tab => app.next_panel(1),
        KeyCode::BackTab => app.next_panel(3),
        KeyCode::Up => app.select(-1),
        KeyCode::Down => app.select(1),
        KeyCode::Enter => {
            if let Some(at) = app.current() {
                app.change(at);
            }
        }
        KeyCode::Left => app.move_time(-1),
        KeyCode::Right => app.move_time(1),
        KeyCode::End => app.back = Nanos::ZERO,
        KeyCode::PageUp => app.lane = app.lane.saturating_sub(4),
        KeyCode::PageDown => app.lane = app.lane.saturating_add(4),
        _ => {}
    }
}

/// Longest value that can be typed.
const LONGEST: usize = 200;

fn type_value(app: &mut App<'_>, code: KeyCode) {
    if code != KeyCode::Enter
        && let Some(edit) = &mut app.edit
    {
        edit.why.clear();
    }
    match code {
        KeyCode::Enter => app.accept(),
        KeyCode::Esc => app.edit = None,
        KeyCode::Backspace => {
            if let Some(edit) = &mut app.edit {
                edit.text.pop();
            }
        }
        KeyCode::Char(c) => {
            if let Some(edit) = app.edit.as_mut().filter(|e| e.text.len() < LONGEST) {
                edit.text.push(c);
            }
        }
        _ => {}
    }
}
