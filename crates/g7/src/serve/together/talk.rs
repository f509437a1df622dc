//! The talk of the server with pages about files that several people edit: wishes come in, answers and notices go out.
//!
//! ```text
//! live -> call -> Tables -> Outbox of the page, of those at the file, of all
//! ```

use std::sync::Arc;
use std::time::Duration;

use g7_model::{Said, say};
use g7_store::users::Role;
use serde_json::{Value, json};

use super::super::outbox::Outbox;
use super::super::runs::letter;
use super::super::shared::{Inner, Shared};
use super::Tables;
use super::wish::Wish;
use crate::failure::raw;
use crate::who::Who;

/// Time between two notices of where people are.
const MOVES: Duration = Duration::from_millis(100);

/// Does what a page asks for and puts the answer into its outbox; or says why that is impossible.
pub(crate) fn call(
    shared: &Inner,
    who: &Who,
    outbox: &Arc<Outbox>,
    id: u64,
    message: &str,
) -> Result<(), Said> {
    let wish: Wish =
        serde_json::from_str(message).map_err(|e| say!("this message means nothing: {e}", e = raw(e)))?;
    wish.judge()?;
    let edits = who.role >= Role::Engineer && !shared.folder.is_read_only();
    let comes_or_goes = matches!(wish, Wish::Join { .. } | Wish::Leave { .. });
    let mut tables = shared.together.lock();
    // Changes of the text and of places come many times a second, and change nothing of who is where.
    let before = comes_or_goes.then(|| tables.list());
    let answer = tables.answer(who, outbox, edits, wish)?;
    outbox.put(letter(&json!({ "id": id, "answer": { "ok": answer } })));
    if let Some(before) = before {
        tell_if_changed(shared, &tables, &before);
    }
    Ok(())
}

/// A page has gone: its places at all tables are free.
pub(crate) fn gone(shared: &Inner, outbox: &Arc<Outbox>) {
    let mut tables = shared.together.lock();
    let before = tables.list();
    let files: Vec<String> = tables.all.keys().cloned().collect();
    for file in files {
        tables.leave(&file, outbox);
    }
    tell_if_changed(shared, &tables, &before);
}

/// Tells every page at which files people are, after a change of that.
fn tell_if_changed(shared: &Inner, tables: &Tables, before: &Value) {
    let now = tables.list();
    if now != *before {
        let text = letter(&json!({ "tables": now }));
        shared.clients.all().iter().for_each(|client| client.put(text.clone()));
    }
}

/// Runs as long as the server: tells everyone at a file where those have gone who have moved since the last time.
pub(crate) async fn tell_moves(shared: Shared) {
    let mut tick = tokio::time::interval(MOVES);
    tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    loop {
        tick.tick().await;
        for (file, table) in &mut shared.together.lock().all {
            if let Some(moves) = table.moves() {
                table.tell(None, &json!({ "together": { "file": file, "here": moves } }));
            }
        }
    }
}
