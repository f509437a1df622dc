//! The people at one file, and the text that they edit.
//!
//! # Invariants
//!
//! There is a text as long as someone edits. It is kept in UTF-16 units, in which browsers count; a change that
//! would cut a letter in two is refused, so the text always is one.

use std::collections::VecDeque;
use std::sync::{Arc, Weak};

use g7_model::{Said, say};
use serde::Serialize;
use serde_json::{Value, json};

use super::super::outbox::Outbox;
use super::super::runs::letter;
use super::wish::{Here, Splice};

/// Greatest length of a text that several people edit, in UTF-16 units.
const LONGEST: usize = 1 << 20;
/// Number of changes whose keys are known: more than there are pages whose connection breaks at one time.
const KEYS: usize = 256;

/// Someone at a file.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Person {
    pub(super) id: u64,
    pub(super) name: String,
    /// False for who only looks.
    pub(super) edits: bool,
}

#[derive(Debug)]
struct Seat {
    person: Person,
    outbox: Weak<Outbox>,
    here: Here,
    /// True if the others were not told yet where this person is.
    moved: bool,
}

/// The people at one file.
#[derive(Debug, Default)]
pub(super) struct Table {
    text: Option<Vec<u16>>,
    /// The number of changes so far; it goes on when a later text begins.
    version: u64,
    /// The keys of the last changes.
    keys: VecDeque<String>,
    seats: Vec<Seat>,
}

impl Seat {
    fn is_of(&self, outbox: &Arc<Outbox>) -> bool {
        self.outbox.upgrade().is_some_and(|own| Arc::ptr_eq(&own, outbox))
    }
}

impl Table {
    pub(super) fn version(&self) -> u64 {
        self.version
    }

    pub(super) fn text(&self) -> Option<String> {
        self.text.as_ref().map(|units| String::from_utf16_lossy(units))
    }

    pub(super) fn is_edited(&self) -> bool {
        self.text.is_some()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.seats.is_empty()
    }

    pub(super) fn people(&self) -> Vec<&Person> {
        self.seats.iter().map(|seat| &seat.person).collect()
    }

    /// The number of a person who edits.
    pub(super) fn editor(&self, outbox: &Arc<Outbox>) -> Option<u64> {
        let seat = self.seats.iter().find(|seat| seat.is_of(outbox))?;
        seat.person.edits.then_some(seat.person.id)
    }

    /// Takes a text if there is none; true if it was taken.
    pub(super) fn begin(&mut self, text: &str) -> bool {
        if self.text.is_some() {
            return false;
        }
        self.text = Some(text.encode_utf16().collect());
        self.version += 1;
        true
    }

    pub(super) fn enter(&mut self, person: Person, outbox: &Arc<Outbox>) {
        self.seats.push(Seat { person, outbox: Arc::downgrade(outbox), here: Here::default(), moved: false });
    }

    /// Frees the place of a page; true if it had one. With the last one who edits, the text goes.
    pub(super) fn leave(&mut self, outbox: &Arc<Outbox>) -> bool {
        let before = self.seats.len();
        self.seats.retain(|seat| !seat.is_of(outbox) && seat.outbox.strong_count() > 0);
        if !self.seats.iter().any(|seat| seat.person.edits) {
            self.text = None;
            self.keys.clear();
        }
        self.seats.len() < before
    }

    /// True if one of the last changes has this key.
    pub(super) fn has_made(&self, key: &str) -> bool {
        self.keys.iter().any(|made| made == key)
    }

    /// Changes the text; returns the new version.
    pub(super) fn change(&mut self, splices: &[Splice], key: String) -> Result<u64, Said> {
        let misfit = || say!("these places are none of the text");
        let text = self.text.as_ref().ok_or_else(misfit)?;
        let added: usize = splices.iter().map(|s| s.insert.len()).sum();
        let mut next = Vec::with_capacity(text.len() + added);
        let mut at = 0;
        for s in splices {
            if s.to < s.from {
                return Err(misfit());
            }
            next.extend_from_slice(text.get(at..s.from).ok_or_else(misfit)?);
            next.extend(s.insert.encode_utf16());
            at = s.to;
        }
        next.extend_from_slice(text.get(at..).ok_or_else(misfit)?);
        if next.len() > LONGEST {
            return Err(say!("a text that several people edit has at most {LONGEST} letters"));
        }
        if char::decode_utf16(next.iter().copied()).any(|letter| letter.is_err()) {
            return Err(misfit());
        }
        self.text = Some(next);
        self.version += 1;
        self.keys.truncate(KEYS - 1);
        self.keys.push_front(key);
        Ok(self.version)
    }

    /// Notes where a person is.
    pub(super) fn is_at(&mut self, outbox: &Arc<Outbox>, here: Here) {
        if let Some(seat) = self.seats.iter_mut().find(|seat| seat.is_of(outbox)) {
            (seat.here, seat.moved) = (here, true);
        }
    }

    /// Where everyone is.
    pub(super) fn all_here(&self) -> Value {
        self.seats.iter().map(|seat| json!([seat.person.id, seat.here])).collect()
    }

    /// Where those are who have moved since this was asked last.
    pub(super) fn moves(&mut self) -> Option<Value> {
        let mut rows = Vec::new();
        for seat in &mut self.seats {
            if std::mem::take(&mut seat.moved) {
                rows.push(json!([seat.person.id, seat.here]));
            }
        }
        (!rows.is_empty()).then_some(Value::Array(rows))
    }

    /// Tells everyone but one.
    pub(super) fn tell(&self, but: Option<&Arc<Outbox>>, notice: &Value) {
        let text = letter(notice);
        let all = self.seats.iter().filter_map(|seat| seat.outbox.upgrade());
        all.filter(|own| but.is_none_or(|but| !Arc::ptr_eq(own, but))).for_each(|own| own.put(text.clone()));
    }
}
