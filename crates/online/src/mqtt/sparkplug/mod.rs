//! An edge node of Sparkplug B as a device: its outputs and inputs are metrics, and hosts write the
//! inputs by commands (Sparkplug 3.0, 5 and 6).
//!
//! All that it publishes is one sequence: births first, then the metrics that changed since the last
//! message. A metric that changes while the broker is slow waits as one value, the latest.

mod payload;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::device::{Absent, Device, Failed};
use crate::setup::{Broker, Sparkplug};
use crate::value::{Raw, Scaling};
use crate::wire::Wire;
use crate::wired::Wired;

use super::connection::{About, Connection, Message, Opening};
use payload::{Datatype, Metric, Payload, Value};

/// The command that asks for births (Sparkplug 3.0, 6.4.2: by name and without alias).
const REBIRTH: &str = "Node Control/Rebirth";
/// The number that a birth and its death have in common.
const BDSEQ: &str = "bdSeq";

/// A metric that is wired; its alias is its place in the list.
#[derive(Clone, Debug)]
struct Tag {
    name: String,
    datatype: Datatype,
}

/// The commands of hosts.
#[derive(Debug, Default)]
struct Said {
    /// By input: the value that was written last.
    values: Vec<Option<Result<Raw, String>>>,
    /// Inputs that were written since they were published.
    changed: Vec<bool>,
    rebirth: bool,
}

#[derive(Debug, Default)]
struct Shared(Mutex<Said>);

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Said> {
        // A value is set whole.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// An edge node.
pub(super) struct Node {
    broker: Broker,
    names: Sparkplug,
    timeout: Duration,
    /// Outputs, then inputs.
    tags: Vec<Tag>,
    outputs: usize,
    /// The last values of the outputs, and true where they were not published.
    values: Vec<(Raw, bool)>,
    said: Arc<Shared>,
    /// The number of this connection, from 0.
    births: u64,
    seq: u8,
    born: bool,
    connection: Option<Connection>,
}

impl Node {
    /// A node that is not connected.
    pub(super) fn new(broker: &Broker, names: &Sparkplug, timeout: Duration, wired: &Wired) -> Node {
        let tag = |wire: &Wire, scaling: Scaling| match wire {
            Wire::Metric(name) => Some(Tag { name: name.clone(), datatype: Datatype::of(&scaling) }),
            _ => None,
        };
        let mut tags: Vec<Tag> = wired.outputs.iter().filter_map(|o| tag(&o.wire, o.out.scaling)).collect();
        let outputs = tags.len();
        tags.extend(wired.inputs.iter().filter_map(|i| tag(&i.wire, i.scaling)));
        Node {
            broker: broker.clone(),
            names: names.clone(),
            timeout,
            values: vec![(Raw::Bit(false), false); outputs],
            tags,
            outputs,
            said: Arc::default(),
            births: u64::MAX,
            seq: 0,
            born: false,
            connection: None,
        }
    }

    fn topic(&self, of_node: &str, of_device: &str) -> String {
        let Sparkplug { group, node, device } = &self.names;
        match device {
            Some(device) => format!("spBv1.0/{group}/{of_device}/{node}/{device}"),
            None => format!("spBv1.0/{group}/{of_node}/{node}"),
        }
    }

    fn node_topic(&self, kind: &str) -> String {
        format!("spBv1.0/{}/{kind}/{}", self.names.group, self.names.node)
    }

    fn bdseq(&self) -> Metric {
        // The will has the number of its own connection: that of the birth.
        let number = self.births % 256;
        Metric { value: Some(Value::Long(number)), ..named(BDSEQ, Datatype::LONG) }
    }

    /// The message that says that this node is gone (tck-id-payloads-ndeath-seq: without `seq`).
    fn death(&self) -> Message {
        let payload =
            Payload { timestamp: Some(g7_host::utc_millis()), metrics: vec![self.bdseq()], seq: None };
        Message {
            topic: self.node_topic("NDEATH"),
            payload: payload.bytes(),
            acknowledged: true,
            retain: false,
        }
    }

    /// A metric with its present value; in a birth with its name and type as well.
    fn metric(&self, k: usize, now: u64, birth: bool) -> Option<Metric> {
        let tag = self.tags.get(k)?;
        let value = match k.checked_sub(self.outputs) {
            None => self.values.get(k).and_then(|(raw, _)| tag.datatype.value(*raw)),
            Some(input) => {
                let said = self.said.lock();
                let written = said.values.get(input).and_then(|v| v.clone()?.ok());
                written.and_then(|raw| tag.datatype.value(raw))
            }
        };
        Some(Metric {
            name: birth.then(|| tag.name.clone()),
            alias: Some(k as u64),
            timestamp: Some(now),
            datatype: birth.then(|| tag.datatype.number()),
            is_null: value.is_none().then_some(true),
            value,
        })
    }

    /// Publishes metrics with the next number of the sequence; false where it has to be tried again.
    fn publish(&mut self, topic: String, metrics: Vec<Metric>, now: u64) -> bool {
        let Some(connection) = &self.connection else { return false };
        let payload = Payload { timestamp: Some(now), metrics, seq: Some(u64::from(self.seq)) };
        let message = Message { topic, payload: payload.bytes(), acknowledged: false, retain: false };
        let done = connection.publish(About::Own, &message);
        if done {
            self.seq = self.seq.wrapping_add(1);
        }
        done
    }

    /// Publishes the births; they have all metrics, so nothing else waits.
    fn give_birth(&mut self) {
        let now = g7_host::utc_millis();
        self.said.lock().rebirth = false;
        self.take_changes();
        let all: Vec<Metric> = (0..self.tags.len()).filter_map(|k| self.metric(k, now, true)).collect();
        let rebirth = Metric { value: Some(Value::Boolean(false)), ..named(REBIRTH, Datatype::Boolean) };
        let mut of_node: Vec<Metric> =
            [self.bdseq(), rebirth].map(|metric| Metric { timestamp: Some(now), ..metric }).into();
        self.seq = 0;
        let birth = self.node_topic("NBIRTH");
        self.born = if self.names.device.is_some() {
            let device = self.topic("", "DBIRTH");
            self.publish(birth, of_node, now) && self.publish(device, all, now)
        } else {
            of_node.extend(all);
            self.publish(birth, of_node, now)
        };
    }

    /// The metrics that changed, by number, which count as published from here on.
    fn take_changes(&mut self) -> Vec<usize> {
        let mut said = self.said.lock();
        let flags = self.values.iter_mut().map(|(_, changed)| changed).chain(&mut said.changed);
        let changed = flags.enumerate().filter_map(|(k, changed)| std::mem::take(changed).then_some(k));
        changed.collect()
    }

    /// Metrics that have to be published after all.
    fn note_changes(&mut self, numbers: &[usize]) {
        let mut said = self.said.lock();
        let flags = self.values.iter_mut().map(|(_, changed)| changed).chain(&mut said.changed);
        flags.enumerate().filter(|(k, _)| numbers.contains(k)).for_each(|(_, changed)| *changed = true);
    }

    /// Publishes what changed.
    fn send(&mut self) {
        if !self.born || self.said.lock().rebirth {
            return self.give_birth();
        }
        let now = g7_host::utc_millis();
        // Forgotten before the values are read: what a host writes meanwhile is told next time.
        let changed = self.take_changes();
        let metrics: Vec<Metric> = changed.iter().filter_map(|k| self.metric(*k, now, false)).collect();
        if !metrics.is_empty() && !self.publish(self.topic("NDATA", "DDATA"), metrics, now) {
            self.note_changes(&changed);
        }
    }
}

/// A metric without value that has a name and no alias.
fn named(name: &str, datatype: Datatype) -> Metric {
    Metric { name: Some(name.to_owned()), datatype: Some(datatype.number()), ..Metric::default() }
}

impl Said {
    /// Takes the metrics of a command. A name that nobody knows, or an output, is left alone.
    fn obey(&mut self, metrics: Vec<Metric>, tags: &[Tag], outputs: usize) {
        for metric in metrics {
            let found = tags.iter().enumerate().position(|(k, tag)| match (&metric.name, metric.alias) {
                (Some(name), _) => tag.name == *name,
                (None, alias) => alias == Some(k as u64),
            });
            let Some(k) = found else { continue };
            let (Some(input), Some(tag)) = (k.checked_sub(outputs), tags.get(k)) else { continue };
            let value = metric.value.and_then(|value| tag.datatype.raw(value));
            if let (Some(to), Some(changed)) = (self.values.get_mut(input), self.changed.get_mut(input)) {
                *to = Some(value.ok_or_else(|| "the host wrote no value of its type".to_owned()));
                *changed = true;
            }
        }
    }
}

impl Device for Node {
    fn connect(&mut self) -> Result<(), Failed> {
        self.connection = None;
        let inputs = self.tags.len() - self.outputs;
        *self.said.lock() = Said { values: vec![None; inputs], changed: vec![false; inputs], rebirth: false };
        self.born = false;
        self.births = self.births.wrapping_add(1);
        let mut topics = vec![(self.node_topic("NCMD"), true)];
        if self.names.device.is_some() {
            topics.push((self.topic("", "DCMD"), true));
        }
        let (control, command) = (self.node_topic("NCMD"), self.topic("NCMD", "DCMD"));
        let (said, tags, outputs) = (Arc::clone(&self.said), self.tags.clone(), self.outputs);
        let taker = move |topic: &str, bytes: &[u8]| {
            let Some(payload) = Payload::read(bytes) else { return };
            let asks =
                |m: &Metric| m.name.as_deref() == Some(REBIRTH) && m.value == Some(Value::Boolean(true));
            let mut said = said.lock();
            if topic == control && payload.metrics.iter().any(asks) {
                said.rebirth = true;
            }
            if topic == command {
                said.obey(payload.metrics, &tags, outputs);
            }
        };
        let opening = Opening {
            broker: &self.broker,
            client_id: &self.broker.client_id,
            will: Some(self.death()),
            topics,
            timeout: self.timeout,
        };
        let (connection, refused) = Connection::open(opening, Box::new(taker))?;
        if let Some(why) = refused.into_iter().flatten().next() {
            return Err(Failed(format!("no commands: {why}")));
        }
        self.connection = Some(connection);
        Ok(())
    }

    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        _: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let connection =
            self.connection.as_ref().ok_or_else(|| Failed("there is no connection".to_owned()))?;
        if let Err(why) = connection.failed() {
            self.connection = None;
            return Err(why);
        }
        // Messages without acknowledgement are only counted.
        connection.answers();
        for ((value, raw), _) in self.values.iter_mut().zip(outputs).zip(write).filter(|(_, w)| **w) {
            *value = (*raw, true);
        }
        self.send();
        let said = self.said.lock();
        for (to, value) in inputs.iter_mut().zip(&said.values) {
            *to = match value {
                Some(value) => value.clone().map_err(Absent::Refused),
                None => Err(Absent::Refused("no host has written it".to_owned())),
            };
        }
        Ok(())
    }

    /// Publishes what waits and the death (tck-id-operational-behavior-edge-node-intentional-disconnect-ndeath).
    fn close(&mut self) {
        let last = self.death();
        if let Some(connection) = self.connection.take()
            && connection.flush()
            && connection.publish(About::Own, &last)
            && connection.flush()
        {
            connection.end();
        }
    }
}
