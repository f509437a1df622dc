//! The terminal view of a running chart.
//!
//! `app` holds the state and the operations, `keys` maps keys to operations, `draw` draws the
//! state. Only this file accesses the terminal; the rest is tested without one.

mod app;
mod columns;
mod draw;
mod keys;
mod lines;
#[cfg(test)]
mod tests;

use std::time::Duration;

use crossterm::event::{self, Event};
use g7_host::Runner;

use crate::cli::Run;
use crate::ended::Ended;
use crate::failure::Failure;
use crate::run::Keeper;
use app::App;
use g7_rig::Bench;

/// Longest time between two pictures.
const FRAME: Duration = Duration::from_millis(40);

/// Shows the running chart until the user quits.
pub(crate) fn run(
    bench: &Bench,
    runner: Runner,
    title: &str,
    args: &Run,
    keeper: &mut Keeper<'_>,
) -> Result<(), Failure> {
    let mut app = App::new(bench, runner, title, args)?;
    // `try_init` also restores the terminal after a panic.
    let mut terminal = ratatui::try_init()?;
    let ended = turn(&mut terminal, &mut app, keeper);
    ratatui::restore();
    ended?;
    keeper.save(&app.runner)
}

fn turn(
    terminal: &mut ratatui::DefaultTerminal,
    app: &mut App<'_>,
    keeper: &mut Keeper<'_>,
) -> Result<(), Failure> {
    // A signal restores the terminal and writes what is retained, as `q` does.
    let ended = Ended::new()?;
    while !app.is_over() && !ended.is_so() {
        app.advance();
        keeper.tick(&app.runner)?;
        terminal.draw(|frame| draw::draw(frame, app))?;
        let mut patience = FRAME;
        while event::poll(patience)? {
            if let Event::Key(key) = event::read()? {
                keys::press(app, key);
            }
            // A resize needs no action: the next picture has the new size.
            patience = Duration::ZERO;
        }
    }
    Ok(())
}
