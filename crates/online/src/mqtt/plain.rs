//! A broker with plain topics as a device: each input and output has a topic.
//!
//! An output that changes while the broker is slow waits as one value, the latest: what waits is
//! bounded by the number of outputs.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use g7_host::{Clock as _, WallClock};
use g7_model::Nanos;

use crate::device::{Absent, Device, Failed};
use crate::mail::Mail;
use crate::setup::Broker;
use crate::value::{Raw, Scaling};
use crate::wire::{Topic, Wire};
use crate::wired::Wired;

use super::connection::{About, Connection, Message, Opening};
use super::events::Events;
use super::payload;

/// An output that the broker refuses is published again after this time.
const AGAIN: Nanos = Nanos::from_millis(2_000);
/// Messages that the broker keeps are waited for so long.
const KEPT: Duration = Duration::from_millis(100);

/// A topic with the scaling of its variable.
#[derive(Clone, Debug)]
struct End {
    topic: Topic,
    scaling: Scaling,
    /// The payload while the controller does not run; of an output.
    safe: Vec<u8>,
}

/// The last message of an input.
#[derive(Clone, Debug, Default)]
struct Seen {
    value: Option<Result<Raw, String>>,
    at: Nanos,
}

/// The inputs, which the thread of the connection fills.
#[derive(Debug, Default)]
struct Inputs {
    seen: Mutex<(Vec<Seen>, WallClock)>,
}

impl Inputs {
    fn lock(&self) -> MutexGuard<'_, (Vec<Seen>, WallClock)> {
        // A value is set whole.
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A broker with plain topics.
pub(super) struct Plain {
    broker: Broker,
    timeout: Duration,
    inputs: Vec<End>,
    outputs: Vec<End>,
    seen: Arc<Inputs>,
    /// Why the broker does not give the messages of an input.
    denied: Vec<Option<String>>,
    /// Values that were not handed to the connection yet.
    pending: Vec<Option<Raw>>,
    /// Outputs that the broker refuses: why, and when it said so.
    refused: Vec<Option<(String, Nanos)>>,
    connection: Option<Connection>,
    events: Option<Events>,
    /// It only listens, to the topics of outputs as well, and leaves no trace at the broker.
    listens: bool,
}

impl Plain {
    /// A client that is not connected.
    pub(super) fn new(broker: &Broker, timeout: Duration, wired: &Wired) -> Plain {
        let end = |wire: &Wire, scaling: Scaling, safe: Option<u64>| match wire {
            Wire::Topic(topic) => {
                let raw = scaling.raw(safe.unwrap_or(0)).0;
                let safe = payload::write(raw, topic.field.as_deref(), &scaling);
                Some(End { topic: topic.clone(), scaling, safe })
            }
            _ => None,
        };
        let inputs: Vec<End> = wired.inputs.iter().filter_map(|i| end(&i.wire, i.scaling, None)).collect();
        let outputs: Vec<End> =
            wired.outputs.iter().filter_map(|o| end(&o.wire, o.out.scaling, o.out.safe)).collect();
        Plain {
            broker: broker.clone(),
            timeout,
            seen: Arc::default(),
            denied: vec![None; inputs.len()],
            pending: vec![None; outputs.len()],
            refused: vec![None; outputs.len()],
            inputs,
            outputs,
            connection: None,
            events: None,
            listens: false,
        }
    }

    /// Publishes these events as well.
    pub(super) fn with_events(self, mail: Option<Mail>) -> Plain {
        let topic = self.broker.events.as_ref().map(|events| events.topic.value.clone());
        let events = topic.zip(mail).map(|(topic, mail)| Events::new(topic, mail));
        Plain { events, ..self }
    }

    /// A client that listens to all topics, those of outputs too, and publishes nothing.
    pub(super) fn listener(broker: &Broker, timeout: Duration, wired: &Wired) -> Plain {
        let mut plain = Plain::new(broker, timeout, wired);
        plain.inputs.append(&mut plain.outputs);
        plain.pending.clear();
        plain.denied = vec![None; plain.inputs.len()];
        plain.listens = true;
        plain
    }

    /// The inputs by topic.
    fn by_topic(&self) -> BTreeMap<String, Vec<usize>> {
        let mut topics: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (k, end) in self.inputs.iter().enumerate() {
            topics.entry(end.topic.name.clone()).or_default().push(k);
        }
        topics
    }

    /// The message by which the broker tells others that this client is lost.
    fn will(&self) -> Option<Message> {
        if self.listens {
            return None;
        }
        let of = |end: &End| Message {
            topic: end.topic.name.clone(),
            payload: end.safe.clone(),
            acknowledged: end.topic.acknowledged,
            retain: end.topic.retain,
        };
        self.outputs.iter().find(|end| end.topic.will).map(of).or_else(|| self.status("offline"))
    }

    fn status(&self, word: &str) -> Option<Message> {
        let topic = self.broker.status.as_ref().filter(|_| !self.listens)?.value.clone();
        Some(Message { topic, payload: word.into(), acknowledged: true, retain: true })
    }

    /// Hands over what waits, as far as there is room.
    fn send(&mut self) {
        let Some(connection) = &self.connection else { return };
        for (k, (pending, end)) in self.pending.iter_mut().zip(&self.outputs).enumerate() {
            let Some(raw) = *pending else { continue };
            let message = Message {
                topic: end.topic.name.clone(),
                payload: payload::write(raw, end.topic.field.as_deref(), &end.scaling),
                acknowledged: end.topic.acknowledged,
                retain: end.topic.retain,
            };
            if !connection.publish(About::Output(k), &message) {
                return;
            }
            *pending = None;
        }
        if let Some(events) = &mut self.events {
            let now = self.seen.lock().1.now();
            events.send(now, connection);
        }
    }

    /// The present value of each input.
    fn take(&self, inputs: &mut [Result<Raw, Absent>]) {
        let mut seen = self.seen.lock();
        let now = seen.1.now();
        for (k, (to, end)) in inputs.iter_mut().zip(&self.inputs).enumerate() {
            *to = match (self.denied.get(k), seen.0.get(k)) {
                (Some(Some(why)), _) => Err(Absent::Refused(why.clone())),
                (_, Some(Seen { value: Some(value), at })) => match end.topic.silence {
                    Some(most) if now - *at > most => {
                        Err(Absent::Refused(format!("no message for {}", most.plain())))
                    }
                    Some(_) | None => value.clone().map_err(Absent::Refused),
                },
                (_, Some(Seen { value: None, .. }) | None) if self.listens => Err(Absent::Unread),
                (_, Some(Seen { value: None, .. }) | None) => {
                    Err(Absent::Refused("there is no message yet".to_owned()))
                }
            };
        }
    }

    /// Waits for so long at most until each input has had a message, or will have none.
    pub(super) fn wait_for_values(&self, time: Duration) {
        let is_complete = || {
            let seen = self.seen.lock();
            self.denied.iter().zip(&seen.0).all(|(denied, seen)| denied.is_some() || seen.value.is_some())
        };
        if let Some(connection) = &self.connection {
            connection.wait(time, is_complete);
        }
    }

    /// Notes what the broker answered.
    fn note_answers(&mut self) {
        let Some(connection) = &self.connection else { return };
        let now = self.seen.lock().1.now();
        for (about, why) in connection.answers() {
            match about {
                About::Output(k) => {
                    if let Some(refused) = self.refused.get_mut(k) {
                        *refused = why.map(|why| (why, now));
                    }
                }
                About::Event(number) => {
                    if let Some(events) = &mut self.events {
                        events.note(now, number, why);
                    }
                }
                About::Own => {}
            }
        }
    }

    /// Notes what the scan wants to be published.
    fn note(&mut self, outputs: &[Raw], write: &[bool]) {
        let now = self.seen.lock().1.now();
        let wanted = self.pending.iter_mut().zip(&self.refused).zip(outputs.iter().zip(write));
        for ((pending, refused), (raw, _)) in wanted.filter(|(_, (_, write))| **write) {
            // A broker that refuses is not asked again at once.
            if refused.as_ref().is_none_or(|(_, at)| now - *at > AGAIN) {
                *pending = Some(*raw);
            }
        }
    }
}

impl Device for Plain {
    fn connect(&mut self) -> Result<(), Failed> {
        self.connection = None;
        self.seen.lock().0 = vec![Seen::default(); self.inputs.len()];
        let topics = self.by_topic();
        let sure = |members: &[usize]| {
            members.iter().any(|k| self.inputs.get(*k).is_some_and(|end| end.topic.acknowledged))
        };
        let opening = Opening {
            broker: &self.broker,
            // A second client of one name would end the connection of the first.
            client_id: if self.listens { "" } else { &self.broker.client_id },
            will: self.will(),
            topics: topics.iter().map(|(topic, members)| (topic.clone(), sure(members))).collect(),
            timeout: self.timeout,
        };
        let (ends, seen, by_topic) = (self.inputs.clone(), Arc::clone(&self.seen), topics.clone());
        let taker = move |topic: &str, bytes: &[u8]| {
            let mut seen = seen.lock();
            let at = seen.1.now();
            for k in by_topic.get(topic).into_iter().flatten() {
                if let (Some(end), Some(to)) = (ends.get(*k), seen.0.get_mut(*k)) {
                    let value = Some(payload::read(bytes, end.topic.field.as_deref(), &end.scaling));
                    *to = Seen { value, at };
                }
            }
        };
        let (connection, refused) = Connection::open(opening, Box::new(taker))?;
        for (members, why) in topics.values().zip(refused) {
            for k in members {
                if let Some(denied) = self.denied.get_mut(*k) {
                    denied.clone_from(&why);
                }
            }
        }
        if let Some(status) = self.status("online") {
            connection.publish(About::Own, &status);
        }
        self.connection = Some(connection);
        self.refused.fill(None);
        if let Some(events) = &mut self.events {
            events.begin();
        }
        // Messages that the broker keeps come at once.
        self.wait_for_values(KEPT.min(self.timeout));
        Ok(())
    }

    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        refused: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let connection =
            self.connection.as_ref().ok_or_else(|| Failed("there is no connection".to_owned()))?;
        if let Err(why) = connection.failed() {
            // A message that the broker has taken is not published again.
            self.note_answers();
            self.connection = None;
            self.pending.fill(None);
            return Err(why);
        }
        self.note_answers();
        self.note(outputs, write);
        for (to, why) in refused.iter_mut().zip(&self.refused) {
            *to = why.as_ref().map(|(why, _)| why.clone());
        }
        self.send();
        self.take(inputs);
        Ok(())
    }

    /// Publishes what waits and says good-bye; a connection that is lost already is only given up.
    fn close(&mut self) {
        while let Some(connection) = &self.connection {
            if !connection.flush() {
                self.connection = None;
            } else if self.pending.iter().any(Option::is_some) {
                self.send();
            } else {
                break;
            }
        }
        self.note_answers();
        let last = self.status("offline");
        let Some(connection) = self.connection.take() else { return };
        // Without these words the broker publishes the will, which says the same.
        if last.is_none_or(|last| connection.publish(About::Own, &last) && connection.flush()) {
            connection.end();
        }
    }
}
