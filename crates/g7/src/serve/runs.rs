//! The shared runs: found by name, each on a thread of its own.
//!
//! ```text
//! live -> Runs -> orders -> Desk (one thread, one Page) -> Outbox of every watcher
//!            \-> Registry <-/
//! ```
//!
//! A request to one run delays neither the other runs nor, beyond the time of the request, the
//! scans of its own.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};

use axum::extract::ws::Utf8Bytes;
use serde::Serialize;
use tokio::sync::oneshot;

use super::desk::Desk;
use super::outbox::Outbox;
use super::registry::{Card, Entry, Order, Registry, What};

/// Greatest number of orders that wait for a run: more than there are clients.
const WAITING: usize = 1_024;

/// All runs.
#[derive(Debug)]
pub(super) struct Runs {
    most: usize,
    registry: Arc<Registry>,
}

/// A value as a message to a client.
pub(super) fn letter(value: &impl Serialize) -> Utf8Bytes {
    serde_json::to_string(value).unwrap_or_default().into()
}

impl Runs {
    pub(super) fn new(most: usize) -> Runs {
        Runs { most, registry: Arc::default() }
    }

    pub(super) fn list(&self) -> Vec<Card> {
        self.registry.lock().runs.values().map(|e| e.card.clone()).collect()
    }

    /// Starts a run, or restarts it.
    pub(super) async fn start(
        self: &Arc<Runs>,
        run: &str,
        by: &Arc<Outbox>,
        id: u64,
        message: &str,
        text: Option<String>,
    ) -> Result<(), String> {
        // Runs are named after their files.
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

    /// Asks for a full frame for a client that missed frames.
    pub(super) fn catch_up(&self, run: &str, outbox: &Arc<Outbox>) {
        let list = self.registry.lock();
        if let Some(entry) = list.runs.get(run) {
            // If the run is too busy, the next dropped frame asks again.
            entry.orders.try_send(Order::CatchUp(Arc::clone(outbox))).ok();
        }
    }

    /// Sends an order to a run and waits until it is done.
    async fn ask(&self, run: &str, by: &Arc<Outbox>, id: u64, what: What) -> Result<(), String> {
        let gone = || format!("there is no run `{}`", run.chars().take(64).collect::<String>());
        let (done, wait) = oneshot::channel();
        let orders = self.registry.lock().runs.get(run).map(|e| e.orders.clone()).ok_or_else(gone)?;
        orders
            .try_send(Order::Asked { by: Arc::clone(by), id, what, done })
            .map_err(|_| "this run is busy: try again".to_owned())?;
        wait.await.map_err(|_| gone())
    }

    /// Starts a thread for a run, unless it exists.
    fn open(self: &Arc<Runs>, run: &str) -> Result<(), String> {
        let mut list = self.registry.lock();
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
        let desk = Desk::new(Arc::clone(&name), number, Arc::clone(&self.registry));
        std::thread::Builder::new()
            .name(format!("run {number}"))
            .spawn(move || desk.work(&inbox))
            .map_err(|e| format!("no run can be started: {}", crate::failure::plain(&e)))?;
        list.runs.insert(name, Entry { number, card, orders });
        Ok(())
    }
}
