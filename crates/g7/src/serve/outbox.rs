//! The messages that wait for one client, in order and bounded.
//!
//! ```text
//! runs, watch, answers -> Outbox -> the client's socket
//! ```
//!
//! Nobody waits for a slow reader. If a client falls behind, the waiting frames of a run are
//! dropped; after it has read the rest, it gets one full frame. If even that is too much, the
//! client is disconnected.

use std::collections::{BTreeSet, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::extract::ws::Utf8Bytes;
use g7_model::Language;
use tokio::sync::Notify;

use crate::who::Who;

/// Greatest number of frames of one run that wait for a client.
const FRAMES: usize = 50;
/// Greatest number of bytes that wait for a client.
const BYTES: usize = 4 << 20;

/// The messages that wait for a client.
#[derive(Debug, Default)]
pub(crate) struct Outbox {
    /// Who reads them, as of the begin of the connection.
    who: Who,
    language: Language,
    inner: Mutex<Inner>,
    ring: Notify,
}

#[derive(Debug, Default)]
struct Inner {
    queue: VecDeque<Letter>,
    bytes: usize,
    frames: usize,
    /// The runs whose frames were dropped.
    behind: BTreeSet<Arc<str>>,
    closed: bool,
}

#[derive(Debug)]
struct Letter {
    text: Utf8Bytes,
    /// The run, if the message is a frame.
    run: Option<Arc<str>>,
}

/// The next thing to send.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Next {
    Text(Utf8Bytes),
    /// Everything was read, but frames of this run were dropped.
    Behind(Arc<str>),
    /// Too much waits: the client is disconnected.
    Closed,
}

impl Outbox {
    /// The messages for someone.
    pub(crate) fn of(who: Who, language: Language) -> Outbox {
        Outbox { who, language, ..Outbox::default() }
    }

    /// Who reads them.
    pub(crate) fn who(&self) -> &Who {
        &self.who
    }

    /// The language of the page that reads them.
    pub(crate) fn language(&self) -> Language {
        self.language
    }

    /// Adds a frame of a run; it may be dropped if the client is behind.
    pub(crate) fn frame(&self, run: &Arc<str>, text: Utf8Bytes) {
        let mut inner = self.lock();
        if inner.behind.contains(run) {
            return;
        }
        if inner.frames >= FRAMES || inner.bytes + text.len() > BYTES {
            inner.throw_away(run);
            inner.behind.insert(Arc::clone(run));
        } else {
            inner.push(text, Some(Arc::clone(run)));
        }
        drop(inner);
        self.ring.notify_one();
    }

    /// Adds a full frame, which contains everything that was missed.
    pub(crate) fn full(&self, run: &Arc<str>, text: Utf8Bytes) {
        let mut inner = self.lock();
        inner.throw_away(run);
        inner.behind.remove(run);
        inner.push(text, Some(Arc::clone(run)));
        drop(inner);
        self.ring.notify_one();
    }

    /// Adds an answer or a notice; these are never dropped.
    pub(crate) fn put(&self, text: Utf8Bytes) {
        let mut inner = self.lock();
        // One large answer is allowed; many unread ones are not.
        if inner.bytes > BYTES {
            inner.closed = true;
            inner.queue.clear();
        } else {
            inner.push(text, None);
        }
        drop(inner);
        self.ring.notify_one();
    }

    /// True if an answer or a notice waits; no further call is read then.
    pub(crate) fn owes(&self) -> bool {
        self.lock().queue.iter().any(|l| l.run.is_none())
    }

    /// Waits for the next thing to send.
    pub(crate) async fn next(&self) -> Next {
        loop {
            if let Some(next) = self.take() {
                return next;
            }
            self.ring.notified().await;
        }
    }

    fn take(&self) -> Option<Next> {
        let mut inner = self.lock();
        if inner.closed {
            return Some(Next::Closed);
        }
        if let Some(letter) = inner.queue.pop_front() {
            inner.bytes -= letter.text.len();
            inner.frames -= usize::from(letter.run.is_some());
            return Some(Next::Text(letter.text));
        }
        inner.behind.pop_first().map(Next::Behind)
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    fn push(&mut self, text: Utf8Bytes, run: Option<Arc<str>>) {
        self.bytes += text.len();
        self.frames += usize::from(run.is_some());
        self.queue.push_back(Letter { text, run });
    }

    fn throw_away(&mut self, run: &Arc<str>) {
        self.queue.retain(|l| l.run.as_ref() != Some(run));
        self.bytes = self.queue.iter().map(|l| l.text.len()).sum();
        self.frames = self.queue.iter().filter(|l| l.run.is_some()).count();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run() -> Arc<str> {
        Arc::from("a")
    }

    #[test]
    fn what_is_read_comes_in_order() {
        let outbox = Outbox::default();
        outbox.frame(&run(), "1".into());
        outbox.put("2".into());
        outbox.frame(&run(), "3".into());
        for text in ["1", "2", "3"] {
            assert_eq!(outbox.take(), Some(Next::Text(text.into())));
        }
        assert_eq!(outbox.take(), None);
    }

    #[test]
    fn a_reader_left_behind_keeps_its_answers_and_gets_one_full_frame() {
        let outbox = Outbox::default();
        outbox.put("answer".into());
        assert!(outbox.owes());
        for _ in 0..10_000 {
            outbox.frame(&run(), "frame".into());
        }
        assert_eq!(outbox.lock().queue.len(), 1, "the frames are thrown away");
        assert_eq!(outbox.take(), Some(Next::Text("answer".into())));
        assert!(!outbox.owes());
        assert_eq!(outbox.take(), Some(Next::Behind(run())));
        assert_eq!(outbox.take(), None, "asked for once");
        outbox.full(&run(), "all".into());
        outbox.frame(&run(), "more".into());
        assert_eq!(outbox.take(), Some(Next::Text("all".into())));
        assert_eq!(outbox.take(), Some(Next::Text("more".into())));
    }

    #[test]
    fn bytes_are_bounded_whatever_is_sent() {
        let outbox = Outbox::default();
        let large: Utf8Bytes = "x".repeat(1 << 20).into();
        for _ in 0..40 {
            outbox.frame(&run(), large.clone());
            assert!(outbox.lock().bytes <= BYTES);
        }
        for _ in 0..40 {
            outbox.put(large.clone());
        }
        assert_eq!(outbox.take(), Some(Next::Closed));
        assert!(outbox.lock().queue.is_empty(), "nothing is kept for it");
    }
}
