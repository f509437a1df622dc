//! The list of shared runs: what is known of each without asking its thread, and the way to send it
//! orders. The threads of the runs keep their own entries up to date.

use std::collections::BTreeMap;
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde::Serialize;
use tokio::sync::oneshot;

use super::outbox::Outbox;

/// The list of runs, shared by all threads.
#[derive(Debug, Default)]
pub(super) struct Registry(Mutex<List>);

#[derive(Debug, Default)]
pub(super) struct List {
    pub(super) runs: BTreeMap<Arc<str>, Entry>,
    /// The number of the next run; numbers are unique, names may be reused.
    pub(super) next: u64,
}

/// A run in the list.
#[derive(Debug)]
pub(super) struct Entry {
    pub(super) number: u64,
    pub(super) card: Card,
    pub(super) orders: SyncSender<Order>,
}

/// The description of a run, available without asking its thread.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Card {
    pub(super) run: String,
    pub(super) file: String,
    pub(super) speed: f64,
}

/// An order to a run.
pub(super) enum Order {
    /// A request of a client, which waits until it is done.
    Asked { by: Arc<Outbox>, id: u64, what: What, done: oneshot::Sender<()> },
    /// A client that missed frames has read all waiting messages.
    CatchUp(Arc<Outbox>),
}

/// A request of a client.
pub(super) enum What {
    Watch,
    Unwatch,
    Pace(f64),
    /// A message for the page of the run, with the text of the file that it names.
    Call {
        message: String,
        text: Option<String>,
    },
}

impl Registry {
    pub(super) fn lock(&self) -> MutexGuard<'_, List> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the description of a run.
    pub(super) fn tell(&self, run: &str, number: u64, change: impl FnOnce(&mut Card)) {
        let mut list = self.lock();
        if let Some(entry) = list.runs.get_mut(run).filter(|e| e.number == number) {
            change(&mut entry.card);
        }
    }

    /// Removes a run that has ended.
    pub(super) fn close(&self, run: &str, number: u64) {
        let mut list = self.lock();
        if list.runs.get(run).is_some_and(|e| e.number == number) {
            list.runs.remove(run);
        }
    }
}
