//! The row of an MQTT broker, and what channels say about their messages.

use g7_model::{Nanos, Said, Span, say};

use super::secret::{self, Held, Tls};
use super::table::{At, Found, Table};

/// A broker of MQTT 5, which this is a client of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Broker {
    /// Its name or address.
    pub host: String,
    /// Its port; 1883 is that of MQTT, 8883 that of MQTT over TLS.
    pub port: u16,
    /// The user that it knows this machine by.
    pub user: Option<String>,
    /// The password of the user.
    pub password: Option<Held>,
    /// How the connection is encrypted; without it it is not.
    pub tls: Option<Tls>,
    /// The name of this client; empty for one that the broker chooses.
    pub client_id: String,
    /// The longest time without a packet to the broker, in whole seconds.
    pub keep_alive: u16,
    /// The topic that says `online` or `offline`.
    pub status: Option<At<String>>,
    /// The topic of the events of the controller, and how they are kept.
    pub events: Option<Events>,
    /// The names of this edge node; without them messages are plain.
    pub sparkplug: Option<Sparkplug>,
}

/// The names of an edge node (Sparkplug 3.0, 4.1).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sparkplug {
    /// The group.
    pub group: String,
    /// The edge node.
    pub node: String,
    /// The device whose metrics they are; without it they are those of the node.
    pub device: Option<String>,
}

/// The events of the controller on their way to a broker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Events {
    /// The topic that they are published to.
    pub topic: At<String>,
    /// The file in which they wait, beside the io file.
    pub file: At<String>,
    /// Events that wait at most.
    pub most: u64,
    /// Bytes of them at most.
    pub bytes: u64,
}

/// How a channel uses the messages of its topic.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Message {
    /// The field of a JSON object: its name, or a pointer as RFC 6901 has it.
    pub field: Option<At<String>>,
    /// The quality of service, 0 or 1.
    pub qos: Option<At<i64>>,
    /// The broker keeps the last message.
    pub retain: Option<At<bool>>,
    /// The broker publishes the safe value when the connection is lost.
    pub will: Option<At<bool>>,
    /// Without a message for so long the input is bad.
    pub silence: Option<At<Nanos>>,
}

impl Message {
    /// The place of the first setting that there is.
    pub(crate) fn first(&self) -> Option<Span> {
        let places = [
            self.field.as_ref().map(|f| f.at),
            self.qos.as_ref().map(|q| q.at),
            self.retain.as_ref().map(|r| r.at),
            self.will.as_ref().map(|w| w.at),
            self.silence.as_ref().map(|s| s.at),
        ];
        places.into_iter().flatten().next()
    }
}

/// Reads the settings of a channel.
pub(super) fn message(table: &mut Table<'_>, input: bool, found: &mut Found) -> Message {
    let (field, qos) = (table.text(found, "field"), table.whole(found, "qos", 0..=1));
    let mut message = Message { field, qos, ..Message::default() };
    if input {
        message.silence = table.duration(found, "silence", Nanos::from_millis(10), Nanos::HOUR * 24);
    } else {
        (message.retain, message.will) = (table.flag(found, "retain"), table.flag(found, "will"));
    }
    message
}

/// Reads the row of a broker of this name.
pub(super) fn read(name: &str, table: &mut Table<'_>, found: &mut Found) -> Option<Broker> {
    let tls = secret::tls(table, found);
    let usual = if tls.is_some() { 8883 } else { 1883 };
    let port = table.whole(found, "port", 1..=65_535).map_or(usual, |port| port.value);
    let user = table.text(found, "user");
    let password = secret::password(table, found);
    if let (Some(password), None) = (&password, &user) {
        found.wrong(password.from.at, say!("a password without a `user`")).help =
            Some(say!("name the `user` that the broker knows"));
    }
    let client_id = table.text(found, "client-id");
    if let Some(long) = client_id.as_ref().filter(|id| id.value.is_empty() || id.value.len() > 65_535) {
        found.wrong(long.at, say!("a `client-id` has 1 to 65535 bytes"));
    }
    let keep_alive = table.duration(found, "keep-alive", Nanos::SECOND, Nanos::HOUR);
    let keep_alive = keep_alive.map_or(Nanos::SECOND * 10, |time| time.value);
    let status = status(table, found);
    let sparkplug = table.table(found, "sparkplug").and_then(|table| sparkplug(table, found));
    if let (Some(status), true) = (&status, sparkplug.is_some()) {
        found.wrong(status.at, say!("an edge node of Sparkplug has no `status`")).help =
            Some(say!("its births and deaths say whether it is there"));
    }
    let events = events(name, table, found);
    if let (Some(events), true) = (&events, sparkplug.is_some()) {
        found.wrong(events.topic.at, say!("an edge node of Sparkplug publishes metrics, no events")).help =
            Some(say!("declare the broker a second time, without `sparkplug`"));
    }
    let host = table.needed(found, "host", "10.0.0.7")?;
    Some(Broker {
        host: host.value,
        port: u16::try_from(port).ok()?,
        user: user.map(|user| user.value),
        password,
        tls,
        client_id: client_id.map(|id| id.value).unwrap_or_default(),
        keep_alive: u16::try_from(keep_alive.count_of(Nanos::SECOND)).ok()?,
        status,
        events,
        sparkplug,
    })
}

fn status(table: &mut Table<'_>, found: &mut Found) -> Option<At<String>> {
    let status = table.text(found, "status")?;
    own_topic(status, found)
}

/// A topic that this client publishes to.
fn own_topic(topic: At<String>, found: &mut Found) -> Option<At<String>> {
    match topic_name(&topic.value).and_then(|()| publishable(&topic.value)) {
        Ok(()) => Some(topic),
        Err(why) => {
            found.wrong(topic.at, why);
            None
        }
    }
}

/// Events and bytes of them that wait at most, where the file does not say it.
const EVENTS: (i64, i64) = (100_000, 64 << 20);

/// Reads `events`: a topic, or a table with more.
fn events(name: &str, table: &mut Table<'_>, found: &mut Found) -> Option<Events> {
    let value = table.value(found, "events")?;
    let (mut topic, mut file, mut most, mut bytes) = (None, None, None, None);
    if let Some(text) = value.value.as_str() {
        topic = Some(At::new(text.to_owned(), value.at));
    } else if let Some(rows) = value.value.as_table() {
        let mut table = Table::new(rows, value.at, Said::foreign("`events`"));
        topic = table.needed(found, "topic", "plant/sorter/events");
        file = table.text(found, "file");
        most = table.whole(found, "most", 100..=10_000_000);
        bytes = table.whole(found, "bytes", 100_000..=1 << 40);
        table.end(found);
    } else {
        found.wrong(value.at, say!("`events` is the text of a topic, or a table")).help =
            Some(say!("write `events = \"plant/sorter/events\"`"));
    }
    let topic = own_topic(topic?, found)?;
    let usual = || At::new(format!("{name}.events"), value.at);
    let file = file.unwrap_or_else(usual);
    if file.value.is_empty() || file.value.contains(['/', '\\', '\0']) {
        found
            .wrong(file.at, say!("the `file` of the events is the name of a file beside the io file"))
            .help =
            Some(say!("write `events = {{ topic = \"plant/sorter/events\", file = \"sorter.events\" }}`"));
        return None;
    }
    let number = |n: Option<At<i64>>, usual: i64| n.map_or(usual, |n| n.value).unsigned_abs();
    Some(Events { topic, file, most: number(most, EVENTS.0), bytes: number(bytes, EVENTS.1) })
}

fn sparkplug(mut table: Table<'_>, found: &mut Found) -> Option<Sparkplug> {
    let group = table.needed(found, "group", "plant");
    let node = table.needed(found, "node", "sorter");
    let device = table.text(found, "device");
    for name in [&group, &node, &device].into_iter().flatten() {
        if name.value.is_empty() || name.value.contains(['+', '/', '#', '\0']) {
            let what = say!("a name of Sparkplug has at least one character, and no `+`, `/` or `#`");
            found.wrong(name.at, what);
        }
    }
    table.end(found);
    Some(Sparkplug { group: group?.value, node: node?.value, device: device.map(|d| d.value) })
}

/// Refuses what is no name of a topic (MQTT 5.0, 4.7).
pub(super) fn topic_name(topic: &str) -> Result<(), Said> {
    if topic.is_empty() || topic.len() > 65_535 || topic.contains('\0') {
        return Err(say!("the name of a topic has 1 to 65535 bytes"));
    }
    if topic.contains(['+', '#']) {
        return Err(say!("`{topic}` has a wildcard; a point has one topic"));
    }
    Ok(())
}

/// Refuses topics that belong to the broker (MQTT 5.0, 4.7.2).
pub(crate) fn publishable(topic: &str) -> Result<(), Said> {
    if topic.starts_with('$') {
        return Err(say!("`{topic}` belongs to the broker: nothing is published there"));
    }
    Ok(())
}
