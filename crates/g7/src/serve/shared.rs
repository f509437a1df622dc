//! The data that all requests of a server share: its folder, its runs, its clients and its limits.
//!
//! `serve` makes it at the start; `api`, `assets` and `live` answer from it.
//!
//! # Invariants
//!
//! A client that is gone is not kept: the list holds outboxes only as long as their sockets do.

use std::path::PathBuf;
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};
use std::time::Duration;

use super::access::Access;
use super::drafts::Drafts;
use super::folder::Folder;
use super::outbox::Outbox;
use super::places::Places;
use super::runs::Runs;
use super::together::Together;
use super::watch::Watch;
use super::wiring::Asker;
use crate::audit::Audit;
use crate::operator::Order;

/// The limits of the server.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Greatest number of clients.
    pub(super) clients: usize,
    /// Greatest number of clients from one address.
    pub(super) from_one: usize,
    /// Greatest number of shared runs.
    pub(super) runs: usize,
    /// Greatest length of a message, in bytes.
    pub(super) message: usize,
    /// Time between two pings.
    pub(super) ping: Duration,
    /// A client is disconnected if it is silent for this long.
    pub(super) silence: Duration,
    /// Longest time for sending a message.
    pub(super) send: Duration,
}

impl Limits {
    /// Where others reach the server, none of them takes all places.
    pub(super) fn for_others(self) -> Limits {
        Limits { from_one: 64, ..self }
    }

    /// Beside a machine there is room for many who look, and a client that has stopped is let go within
    /// 10 seconds: at the first ping that comes behind its silence.
    pub(super) fn beside_a_machine() -> Limits {
        let (ping, silence, send) = (Duration::from_secs(2), Duration::from_secs(7), Duration::from_secs(7));
        Limits { clients: 1_200, ping, silence, send, ..Limits::default() }
    }
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            clients: 1_200,
            from_one: 1_200,
            runs: 16,
            message: 1 << 20,
            ping: Duration::from_secs(10),
            silence: Duration::from_secs(35),
            send: Duration::from_secs(20),
        }
    }
}

/// The data that all requests share.
#[derive(Debug)]
pub(super) struct Inner {
    pub(super) folder: Arc<Folder>,
    /// The folder as the user named it.
    pub(super) title: String,
    /// A name that no other folder has.
    pub(super) place: String,
    /// The chart to open first.
    pub(super) start: Option<String>,
    pub(super) page: Option<PathBuf>,
    pub(super) drafts: Drafts,
    pub(super) watch: Watch,
    pub(super) runs: Arc<Runs>,
    pub(super) clients: Clients,
    /// The files that several people edit at once.
    pub(super) together: Together,
    /// The token of guests, where there may be some.
    pub(super) guests: OnceLock<String>,
    pub(super) seats: Places,
    pub(super) limits: Limits,
    /// The way to a running controller.
    pub(super) station: Option<SyncSender<Order>>,
    /// The users, if there are any.
    pub(super) access: Option<Arc<Access>>,
    pub(super) audit: Audit,
    /// The file of the log.
    pub(super) log: Option<PathBuf>,
    /// The record of that controller.
    pub(super) history: OnceLock<PathBuf>,
    /// The one who asks the devices of an io file.
    pub(super) asker: Asker,
}

pub(super) type Shared = Arc<Inner>;

/// The connected clients.
#[derive(Debug, Default)]
pub(super) struct Clients(Mutex<Vec<Weak<Outbox>>>);

impl Clients {
    pub(super) fn enter(&self, outbox: &Arc<Outbox>) {
        let mut list = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        list.retain(|w| w.strong_count() > 0);
        list.push(Arc::downgrade(outbox));
    }

    pub(super) fn is_empty(&self) -> bool {
        let list = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        list.iter().all(|w| w.strong_count() == 0)
    }

    pub(super) fn all(&self) -> Vec<Arc<Outbox>> {
        let list = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        list.iter().filter_map(Weak::upgrade).collect()
    }
}
