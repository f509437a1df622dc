//! Whose turn it is to ask the devices, and the latest answer.

use std::time::Duration;

use serde_json::Value;
use tokio::sync::{Mutex, MutexGuard};
use tokio::time::Instant;

/// An answer is good for others for so long.
const FRESH: Duration = Duration::from_millis(700);

/// The latest answer, and what was asked for it.
#[derive(Debug)]
pub(super) struct Latest {
    question: (String, String),
    at: Instant,
    answer: Value,
}

impl Latest {
    /// An answer that has just come.
    pub(super) fn new(question: (String, String), answer: Value) -> Latest {
        Latest { question, at: Instant::now(), answer }
    }

    /// The answer, if the question is the same and it is not too old.
    pub(super) fn answers(&self, question: &(String, String)) -> Option<&Value> {
        (self.question == *question && self.at.elapsed() < FRESH).then_some(&self.answer)
    }
}

/// The one who asks.
#[derive(Debug)]
pub(crate) struct Asker {
    asks: bool,
    turn: Mutex<Option<Latest>>,
}

impl Asker {
    /// One who asks, or does not.
    pub(crate) fn new(asks: bool) -> Asker {
        Asker { asks, turn: Mutex::new(None) }
    }

    /// Waits until nobody else asks.
    pub(super) async fn turn(&self) -> MutexGuard<'_, Option<Latest>> {
        self.turn.lock().await
    }

    /// True if devices are asked.
    pub(super) fn asks(&self) -> bool {
        self.asks
    }
}
