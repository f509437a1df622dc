//! The runs that the server holds: by name, each on a thread of its own.
//!
//! ```text
//! live -> Runs -> orders -> Desk (one thread, one Page) -> Outbox of every watcher
//! ```
//!
//! What must hold: what one page asks of one run holds up neither the other
//! runs nor, for longer than that question, the scans of its own.

use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::extract::ws::Utf8Bytes;
use serde::Serialize;
use tokio::sync::oneshot;

use super::desk::Desk;
use super::outbox::Outbox;

/// Orders that wait for a run: more than there can be pages.
const WAITING: usize = 1_024;

/// All runs.
#[derive(Debug)]
pub(super) struct Runs {
    most: usize,
    list: Mutex<List>,
}

#[derive(Debug, Default)]
struct List {
    runs: BTreeMap<Arc<str>, Entry>,
    /// Number of the next one: a name may come again.
    next: u64,
}

#[derive(Debug)]
struct Entry {
    number: u64,
    card: Card,
    orders: SyncSender<Order>,
}

/// What is known of a run without asking it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Card {
    pub(super) run: String,
    pub(super) file: String,
    pub(super) speed: f64,
}

/// What a run is asked.
pub(super) enum Order {
    /// By a page, which waits until it is done.
    Asked { by: Arc<Outbox>, id: u64, what: What, done: oneshot::Sender<()> },
    /// A page that was left behind has read what there was.
    CatchUp(Arc<Outbox>),
}

/// What a page asks.
pub(super) enum What {
    Watch,
    Unwatch,
    Pace(f64),
    /// A message for the page of the run, with the text of the file it names.
    Call {
        message: String,
        text: Option<String>,
    },
}

/// A message as it goes out.
pub(super) fn letter(value: &impl Serialize) -> Utf8Bytes {
    serde_json::to_string(value).unwrap_or_default().into()
}

impl Runs {
    pub(super) fn new(most: usize) -> Runs {
        Runs { most, list: Mutex::default() }
    }

    fn lock(&self) -> MutexGuard<'_, List> {
        self.list.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn list(&self) -> Vec<Card> {
        self.lock().runs.values().map(|e| e.card.clone()).collect()
    }

    /// Starts a run, or starts it anew.
    pub(super) async fn start(
        self: &Arc<Runs>,
        run: &str,
        by: &Arc<Outbox>,
        id: u64,
        message: &str,
        text: Option<String>,
    ) -> Result<(), String> {
        // Runs are called like their files.
        if run.is_empty() || run.len() > 1_024 || run.chars().any(char::is_control) {
            return Err("a run needs a name of at most 1024 letters".to_owned());
        }
        self.open(run)?;
        self.call(run, by, id, message, text).await
    }

    pub(super) async fn watch(&self, run: &str, by: &Arc<Outbox>, id: u64) -> Result<(), String> {
        self.ask(run, by, id, What::Watch).await
    }

    pub(super) async fn unwatch(&self, run: &str, by: &Arc<Outbox>, id: u64) -> Result<(), String> {
        self.ask(run, by, id, What::Unwatch).await
    }

    pub(super) async fn pace(&self, run: &str, by: &Arc<Outbox>, id: u64, speed: f64) -> Result<(), String> {
        if !(speed == 0.0 || (0.001..=1000.0).contains(&speed)) {
            return Err("the speed must lie between 0.001 and 1000; 0 is a pause".to_owned());
        }
        self.ask(run, by, id, What::Pace(speed)).await
    }

    pub(super) async fn call(
        &self,
        run: &str,
        by: &Arc<Outbox>,
        id: u64,
        message: &str,
        text: Option<String>,
    ) -> Result<(), String> {
        self.ask(run, by, id, What::Call { message: message.to_owned(), text }).await
    }

    /// Has a full frame made for a page that was left behind.
    pub(super) fn catch_up(&self, run: &str, outbox: &Arc<Outbox>) {
        let list = self.lock();
        if let Some(entry) = list.runs.get(run) {
            // Where the run is that busy, the next frame left out asks again.
            entry.orders.try_send(Order::CatchUp(Arc::clone(outbox))).ok();
        }
    }

    /// Hands an order to a run and waits until it is done.
    async fn ask(&self, run: &str, by: &Arc<Outbox>, id: u64, what: What) -> Result<(), String> {
        let gone = || format!("there is no run `{}`", run.chars().take(64).collect::<String>());
        let (done, wait) = oneshot::channel();
        let orders = self.lock().runs.get(run).map(|e| e.orders.clone()).ok_or_else(gone)?;
        orders
            .try_send(Order::Asked { by: Arc::clone(by), id, what, done })
            .map_err(|_| "this run is busy: try again".to_owned())?;
        wait.await.map_err(|_| gone())
    }

    /// Makes a thread for a run that is not there yet.
    fn open(self: &Arc<Runs>, run: &str) -> Result<(), String> {
        let mut list = self.lock();
        if list.runs.contains_key(run) {
            return Ok(());
        }
        if list.runs.len() >= self.most {
            return Err(format!("there are {} runs already: stop one", self.most));
        }
        let name: Arc<str> = Arc::from(run);
        let number = list.next;
        list.next += 1;
        let (orders, inbox): (_, Receiver<Order>) = sync_channel(WAITING);
        let card = Card { run: run.to_owned(), file: String::new(), speed: 0.0 };
        let desk = Desk::new(Arc::clone(&name), number, Arc::clone(self));
        std::thread::Builder::new()
            .name(format!("run {number}"))
            .spawn(move || desk.work(&inbox))
            .map_err(|e| format!("no run can be started: {}", crate::failure::plain(&e)))?;
        list.runs.insert(name, Entry { number, card, orders });
        Ok(())
    }

    /// A run tells what is new about it.
    pub(super) fn tell(&self, run: &str, number: u64, change: impl FnOnce(&mut Card)) {
        let mut list = self.lock();
        if let Some(entry) = list.runs.get_mut(run).filter(|e| e.number == number) {
            change(&mut entry.card);
        }
    }

    /// A run has ended.
    pub(super) fn close(&self, run: &str, number: u64) {
        let mut list = self.lock();
        if list.runs.get(run).is_some_and(|e| e.number == number) {
            list.runs.remove(run);
        }
    }
}
