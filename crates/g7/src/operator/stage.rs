//! The pages that watch a controller: their orders come in, frames go out.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Weak};

use axum::extract::ws::Utf8Bytes;
use g7_model::Nanos;
use g7_online::{Paces, Sight};
use serde_json::{Value, json};
use tokio::sync::oneshot;

use super::board::Board;
use super::names::Names;
use super::order::{NAME, Order, Wish};
use super::told::Told;
use crate::serve::outbox::Outbox;

/// The time between two frames: 20 frames a second.
const TICK: Nanos = Nanos::from_millis(50);
/// Pages that get that many. For each so many more the time is longer by as much, so that a thousand pages
/// take no more of the machine than these.
const PAGES: usize = 200;
/// Greatest number of orders that wait: more than there are clients.
const WAITING: usize = 1_024;

/// Who waits for an answer.
pub(crate) enum Asker {
    /// The terminal, which hears of refusals alone: what is done is told as an event.
    Line,
    /// A page and the number of its call; the page waits until the last is dropped or told.
    Page(Arc<Outbox>, u64, oneshot::Sender<()>),
}

impl Asker {
    /// Gives the answer to a page.
    pub(crate) fn answer(self, done: Result<Value, String>) {
        let Asker::Page(outbox, id, wait) = self else { return };
        let answer = match done {
            Ok(value) => json!({ "ok": value }),
            Err(why) => json!({ "no": why }),
        };
        outbox.put(json!({ "id": id, "answer": answer }).to_string().into());
        // The client may have gone.
        wait.send(()).ok();
    }
}

/// The stage: the pages before which a controller runs.
pub(crate) struct Stage {
    board: Board,
    orders: Receiver<Order>,
    watchers: Vec<Weak<Outbox>>,
    name: Arc<str>,
    due: Nanos,
}

impl Stage {
    /// The way in for orders, before there is a stage.
    pub(crate) fn door() -> (SyncSender<Order>, Receiver<Order>) {
        sync_channel(WAITING)
    }

    pub(crate) fn new(names: Names, sight: Sight, orders: Receiver<Order>) -> Stage {
        let board = Board::new(names, sight);
        Stage { board, orders, watchers: Vec::new(), name: Arc::from(NAME), due: Nanos::ZERO }
    }

    /// Shows another chart from here on; the watchers are told to ask what it has.
    pub(crate) fn renew(&mut self, names: Names, sight: Sight) {
        self.board.renew(names, sight);
        self.spread(&json!({ "renew": true }));
    }

    /// Tells the watchers how the chart and its file are to each other.
    pub(crate) fn tell_file(&mut self, facts: Value) {
        self.board.tell_file(facts);
    }

    /// Notes an event.
    pub(crate) fn note(&mut self, at: Nanos, told: &Told) {
        self.board.note(at, told);
    }

    /// Takes the next order; `None` where none waits. The wish is returned if it is not answered here.
    pub(crate) fn take(&mut self, now: Nanos, paces: &Paces) -> Option<Option<(Wish, Asker)>> {
        let Order { by, call } = self.orders.try_recv().ok()?;
        match call {
            None => {
                let frame = self.whole(now, paces);
                by.full(&self.name, letter(&frame));
            }
            Some((id, Wish::Watch, wait)) => {
                let mut told = self.board.description();
                let frame = self.whole(now, paces);
                if let Some(fields) = told.as_object_mut() {
                    fields.insert("frame".to_owned(), frame);
                }
                self.enter(&by);
                Asker::Page(by, id, wait).answer(Ok(told));
            }
            Some((id, Wish::Seen { event, all }, wait)) => {
                let done = match self.board.see(event, all) {
                    true => Ok(Value::Null),
                    false => Err("there is no such alarm that nobody has seen".to_owned()),
                };
                Asker::Page(by, id, wait).answer(done);
            }
            Some((id, wish, wait)) => return Some(Some((wish, Asker::Page(by, id, wait)))),
        }
        Some(None)
    }

    /// True while a page watches.
    pub(crate) fn is_watched(&self) -> bool {
        self.watchers.iter().any(|watcher| watcher.strong_count() > 0)
    }

    fn whole(&mut self, now: Nanos, paces: &Paces) -> Value {
        self.board.look(now);
        if self.watchers.is_empty() {
            // Nobody waits for these changes, so that the next frame has those behind this one alone.
            self.board.frame(now, paces);
        }
        self.board.whole(now, paces)
    }

    /// Sends a frame to all watchers, if it is time for it.
    pub(crate) fn tick(&mut self, now: Nanos, paces: &Paces) {
        if now < self.due {
            return;
        }
        self.board.look(now);
        self.watchers.retain(|watcher| watcher.strong_count() > 0);
        let more = self.watchers.len().saturating_sub(1) / PAGES;
        self.due = now + TICK * (1 + i64::try_from(more).unwrap_or(0));
        if !self.watchers.is_empty() {
            let frame = self.board.frame(now, paces);
            self.spread(&frame);
        }
    }

    fn enter(&mut self, by: &Arc<Outbox>) {
        if !self.watchers.iter().filter_map(Weak::upgrade).any(|known| Arc::ptr_eq(&known, by)) {
            self.watchers.push(Arc::downgrade(by));
        }
    }

    fn spread(&self, frame: &Value) {
        let text = letter(frame);
        let all = self.watchers.iter().filter_map(Weak::upgrade);
        all.for_each(|watcher| watcher.frame(&self.name, text.clone()));
    }
}

fn letter(frame: &Value) -> Utf8Bytes {
    json!({ "operator": frame }).to_string().into()
}
