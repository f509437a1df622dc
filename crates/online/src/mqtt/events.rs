//! The events of a controller on their way through one connection after the other, in order.
//!
//! A letter leaves the window when the broker has taken it. A new connection begins with the oldest one
//! that is there: so each arrives at least once, and those that arrive again come in order as well.

use g7_model::Nanos;

use super::connection::{About, Connection, Message};
use crate::mail::Mail;

/// Letters that wait for the broker at a time; outputs have room beside them.
const AHEAD: usize = 32;
/// A broker that refuses is asked again after this time.
const AGAIN: Nanos = Nanos::from_millis(2_000);

/// The events of one broker.
pub(super) struct Events {
    topic: String,
    mail: Mail,
    /// The last letter that this connection has: its turn and its number.
    turn: u64,
    sent: i64,
    /// Those of them that the broker has not answered.
    open: usize,
    /// The instant at which the broker refused one last.
    refused: Option<Nanos>,
}

impl Events {
    pub(super) fn new(topic: String, mail: Mail) -> Events {
        Events { topic, mail, turn: 0, sent: i64::MIN, open: 0, refused: None }
    }

    /// Begins with the oldest letter: the connection is a new one.
    pub(super) fn begin(&mut self) {
        (self.sent, self.open, self.refused) = (i64::MIN, 0, None);
    }

    /// Notes the answer of the broker to a letter.
    pub(super) fn note(&mut self, now: Nanos, number: i64, refused: Option<String>) {
        self.open = self.open.saturating_sub(1);
        match refused {
            None => self.mail.take(number),
            Some(why) => {
                self.mail.refuse(why);
                self.refused = Some(now);
            }
        }
    }

    /// Hands over what waits, as far as there is room.
    pub(super) fn send(&mut self, now: Nanos, connection: &Connection) {
        if let Some(at) = self.refused {
            // All that are on their way are answered first, so that the order stays.
            if now - at <= AGAIN || self.open > 0 {
                return;
            }
            self.begin();
        }
        while self.open < AHEAD {
            let Some((turn, letter)) = self.mail.next(self.turn, self.sent) else { return };
            let (topic, payload) = (self.topic.clone(), letter.payload);
            let message = Message { topic, payload, acknowledged: true, retain: false };
            if !connection.publish(About::Event(letter.number), &message) {
                return;
            }
            (self.turn, self.sent) = (turn, letter.number);
            self.open += 1;
        }
    }
}
