//! Files that several people edit at once: who is at a file, where they are in it, and the order of their changes
//! (decision 086).
//!
//! ```text
//! live -> wish -> Together -> Table of the file (text, version, seats) -> Outbox of everyone at it
//! tell_moves (ten times a second) -> where people are
//! ```
//!
//! # Invariants
//!
//! A change is taken if it was made on the newest version, and refused otherwise: the page moves it over the changes that it
//! has not seen, and sends it again. So the server needs no history, and all pages make the same changes in the
//! same order. Answers and notices of one table leave under its lock, in one order for everyone.
//! The text of a table lives as long as someone edits at it. Nothing is written to the folder from here.

mod table;
mod wish;

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use g7_store::users::Role;
use serde_json::{Value, json};

use super::outbox::Outbox;
use super::runs::letter;
use super::shared::{Inner, Shared};
use crate::who::Who;
use table::{Person, Table};
use wish::Wish;

/// Greatest number of files at which people are at the same time.
const TABLES: usize = 256;
/// Time between two notices of where people are.
const MOVES: Duration = Duration::from_millis(100);

/// The tables of a server, by the path of their file.
#[derive(Debug, Default)]
pub(super) struct Together(Mutex<Tables>);

#[derive(Debug, Default)]
struct Tables {
    all: BTreeMap<String, Table>,
    /// The number of the next person.
    next: u64,
}

/// Does what a page asks for and puts the answer into its outbox; or says why that is impossible.
pub(super) fn call(
    shared: &Inner,
    who: &Who,
    outbox: &Arc<Outbox>,
    id: u64,
    message: &str,
) -> Result<(), String> {
    let wish: Wish = serde_json::from_str(message).map_err(|e| format!("this message means nothing: {e}"))?;
    wish.judge()?;
    let edits = who.role >= Role::Engineer && !shared.folder.is_read_only();
    let mut tables = shared.together.lock();
    let before = tables.list();
    let answer = tables.answer(who, outbox, edits, wish)?;
    outbox.put(letter(&json!({ "id": id, "answer": { "ok": answer } })));
    tell_if_changed(shared, &tables, &before);
    Ok(())
}

/// A page has gone: its places at all tables are free.
pub(super) fn gone(shared: &Inner, outbox: &Arc<Outbox>) {
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

/// Tells the people at each table where the others are, as long as the server lives.
pub(super) async fn tell_moves(shared: Shared) {
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

impl Together {
    fn lock(&self) -> MutexGuard<'_, Tables> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Tables {
    /// The files at which people are, with their names.
    fn list(&self) -> Value {
        let row = |(file, table): (&String, &Table)| json!({ "file": file, "edited": table.is_edited(), "people": table.people() });
        self.all.iter().map(row).collect()
    }

    fn answer(&mut self, who: &Who, outbox: &Arc<Outbox>, edits: bool, wish: Wish) -> Result<Value, String> {
        match wish {
            Wish::List => Ok(json!({ "tables": self.list() })),
            Wish::Join { file, name, text, edits: wants, key } => {
                let name = if who.name.is_empty() || who.guest { name } else { who.name.clone() };
                self.next += 1;
                let person = Person { id: self.next, name, edits: edits && wants };
                let made =
                    key.is_some_and(|key| self.all.get(&file).is_some_and(|table| table.has_made(&key)));
                let mut told = self.join(&file, person, outbox, &text)?;
                told["made"] = made.into();
                Ok(told)
            }
            Wish::Leave { file } => {
                self.leave(&file, outbox);
                Ok(Value::Null)
            }
            Wish::Change { file, version, splices, key } => {
                if !edits {
                    return Err("only who may write files may change this one".to_owned());
                }
                let table = self.table(&file)?;
                let Some(by) = table.editor(outbox) else {
                    return Err("only who edits a file together with others may change it".to_owned());
                };
                if version != table.version() {
                    return Ok(json!({ "behind": true }));
                }
                let version = table.change(&splices, key)?;
                let change = json!({ "version": version, "by": by, "splices": splices });
                table.tell(Some(outbox), &json!({ "together": { "file": file, "change": change } }));
                Ok(json!({ "version": version }))
            }
            Wish::Here { file, here } => {
                self.table(&file)?.is_at(outbox, here);
                Ok(Value::Null)
            }
            Wish::Saved { file, tag } => {
                let table = self.table(&file)?;
                if table.editor(outbox).is_some() {
                    table.tell(Some(outbox), &json!({ "together": { "file": file, "saved": tag } }));
                }
                Ok(Value::Null)
            }
        }
    }

    fn table(&mut self, file: &str) -> Result<&mut Table, String> {
        self.all.get_mut(file).ok_or_else(|| "nobody is at this file together with others".to_owned())
    }

    fn join(
        &mut self,
        file: &str,
        person: Person,
        outbox: &Arc<Outbox>,
        text: &str,
    ) -> Result<Value, String> {
        self.leave(file, outbox);
        if !self.all.contains_key(file) && self.all.len() >= TABLES {
            return Err(format!("people are at {TABLES} files already: leave one"));
        }
        let table = self.all.entry(file.to_owned()).or_default();
        let (id, edits) = (person.id, person.edits);
        let begun = edits && table.begin(text);
        table.enter(person, outbox);
        if begun {
            let told = json!({ "version": table.version(), "text": text });
            table.tell(Some(outbox), &json!({ "together": { "file": file, "begun": told } }));
        }
        table.tell(Some(outbox), &json!({ "together": { "file": file, "people": table.people() } }));
        Ok(json!({
            "me": id,
            "edits": edits,
            "version": table.version(),
            "text": table.text(),
            "people": table.people(),
            "here": table.all_here(),
        }))
    }

    fn leave(&mut self, file: &str, outbox: &Arc<Outbox>) {
        let Some(table) = self.all.get_mut(file) else { return };
        if table.leave(outbox) {
            table.tell(None, &json!({ "together": { "file": file, "people": table.people() } }));
        }
        if table.is_empty() {
            self.all.remove(file);
        }
    }
}
