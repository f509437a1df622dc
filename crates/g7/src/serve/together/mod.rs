//! Files that several people edit at once: who is at a file, where they are in it, and the order of their changes
//! (decision 086).
//!
//! ```text
//! live -> talk -> wish -> Together -> Table of the file (text, version, seats) -> Outbox of everyone at it
//!         talk::tell_moves (ten times a second) -> where people are
//! ```
//!
//! # Invariants
//!
//! A change is taken if it was made on the newest version, and refused otherwise: the page moves it over the changes that it
//! has not seen, and sends it again. So the server needs no history, and all pages make the same changes in the
//! same order. Answers and notices of one table leave under its lock, in one order for everyone.
//! The text of a table lives as long as someone edits at it. Nothing is written to the folder from here.

mod table;
pub(super) mod talk;
mod wish;

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use g7_model::{Said, say};
use serde_json::{Value, json};

use super::outbox::Outbox;
use crate::who::Who;
use table::{Person, Table};
use wish::Wish;

/// Greatest number of files at which people are at the same time.
const TABLES: usize = 256;

/// The tables of a server, by the path of their file.
#[derive(Debug, Default)]
pub(super) struct Together(Mutex<Tables>);

#[derive(Debug, Default)]
struct Tables {
    all: BTreeMap<String, Table>,
    /// The number of the next person.
    next: u64,
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

    fn answer(&mut self, who: &Who, outbox: &Arc<Outbox>, edits: bool, wish: Wish) -> Result<Value, Said> {
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
                    return Err(say!("only who may write files may change this one"));
                }
                let table = self.table(&file)?;
                let Some(by) = table.editor(outbox) else {
                    return Err(say!("only who edits a file together with others may change it"));
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

    fn table(&mut self, file: &str) -> Result<&mut Table, Said> {
        self.all.get_mut(file).ok_or_else(|| say!("nobody is at this file together with others"))
    }

    fn join(&mut self, file: &str, person: Person, outbox: &Arc<Outbox>, text: &str) -> Result<Value, Said> {
        self.leave(file, outbox);
        if !self.all.contains_key(file) && self.all.len() >= TABLES {
            return Err(say!("people are at {TABLES} files already: leave one"));
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
