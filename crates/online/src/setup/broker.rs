//! The row of an MQTT broker, and what channels say about their messages.

use g7_model::{Nanos, Problem, Span, codes};

use super::table::{At, Found, Table};

/// A broker of MQTT 5, which this is a client of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Broker {
    /// Its name or address.
    pub host: String,
    /// Its port; 1883 is that of MQTT.
    pub port: u16,
    /// The user that it knows this machine by.
    pub user: Option<String>,
    /// The password of the user.
    pub password: Option<Password>,
    /// The name of this client; empty for one that the broker chooses.
    pub client_id: String,
    /// The longest time without a packet to the broker, in whole seconds.
    pub keep_alive: u16,
    /// The topic that says `online` or `offline`.
    pub status: Option<At<String>>,
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

/// A password: where it is, and what it is as soon as somebody has read it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Password {
    /// The file or variable.
    pub from: At<Origin>,
    /// The password itself.
    pub secret: Secret,
}

/// The place of a password, which is never the io file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A file, beside the io file.
    File(String),
    /// A variable of the environment.
    Variable(String),
}

/// Bytes that are never shown.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Secret(Vec<u8>);

impl Secret {
    /// The bytes, for the other side alone.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }
}

impl std::fmt::Debug for Secret {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Secret")
    }
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

/// Reads the row of a broker.
pub(super) fn read(table: &mut Table<'_>, found: &mut Found) -> Option<Broker> {
    let port = table.whole(found, "port", 1..=65_535).map_or(1883, |port| port.value);
    let user = table.text(found, "user");
    let password = password_of(user.as_ref(), table, found);
    let client_id = table.text(found, "client-id");
    if let Some(long) = client_id.as_ref().filter(|id| id.value.is_empty() || id.value.len() > 65_535) {
        found.wrong(long.at, "a `client-id` has 1 to 65535 bytes");
    }
    let keep_alive = table.duration(found, "keep-alive", Nanos::SECOND, Nanos::HOUR);
    let keep_alive = keep_alive.map_or(Nanos::SECOND * 10, |time| time.value);
    let status = status(table, found);
    let sparkplug = table.table(found, "sparkplug").and_then(|table| sparkplug(table, found));
    if let (Some(status), true) = (&status, sparkplug.is_some()) {
        found.wrong(status.at, "an edge node of Sparkplug has no `status`").help =
            Some("its births and deaths say whether it is there".to_owned());
    }
    let host = table.needed(found, "host", "10.0.0.7")?;
    Some(Broker {
        host: host.value,
        port: u16::try_from(port).ok()?,
        user: user.map(|user| user.value),
        password,
        client_id: client_id.map(|id| id.value).unwrap_or_default(),
        keep_alive: u16::try_from(keep_alive.count_of(Nanos::SECOND)).ok()?,
        status,
        sparkplug,
    })
}

/// The password of a user, if there is one.
fn password_of(user: Option<&At<String>>, table: &mut Table<'_>, found: &mut Found) -> Option<Password> {
    let password = password(table, found);
    if let (Some(password), None) = (&password, user) {
        found.wrong(password.from.at, "a password without a `user`").help =
            Some("name the `user` that the other side knows".to_owned());
    }
    password
}

/// A user who has a password, or none.
pub(super) fn user_with_password(table: &mut Table<'_>, found: &mut Found) -> Option<(String, Password)> {
    let user = table.text(found, "user");
    let password = password_of(user.as_ref(), table, found);
    if let (Some(user), None) = (&user, &password) {
        found.wrong(user.at, "a user without a password").help =
            Some("name its file: `password-file = \"line1.password\"`".to_owned());
    }
    user.map(|user| user.value).zip(password)
}

/// A password, by the settings `password-file` and `password-env`.
pub(super) fn password(table: &mut Table<'_>, found: &mut Found) -> Option<Password> {
    let file = table.text(found, "password-file").map(|f| At::new(Origin::File(f.value), f.at));
    let variable = table.text(found, "password-env").map(|v| At::new(Origin::Variable(v.value), v.at));
    if let (Some(file), Some(variable)) = (&file, &variable) {
        found
            .wrong(variable.at, "there are two passwords")
            .related
            .push((file.at, "this is the other one".to_owned()));
    }
    file.or(variable).map(|from| Password { from, secret: Secret::default() })
}

fn status(table: &mut Table<'_>, found: &mut Found) -> Option<At<String>> {
    let status = table.text(found, "status")?;
    match topic_name(&status.value).and_then(|()| publishable(&status.value)) {
        Ok(()) => Some(status),
        Err(why) => {
            found.wrong(status.at, why);
            None
        }
    }
}

fn sparkplug(mut table: Table<'_>, found: &mut Found) -> Option<Sparkplug> {
    let group = table.needed(found, "group", "plant");
    let node = table.needed(found, "node", "sorter");
    let device = table.text(found, "device");
    for name in [&group, &node, &device].into_iter().flatten() {
        if name.value.is_empty() || name.value.contains(['+', '/', '#', '\0']) {
            let what = "a name of Sparkplug has at least one character, and no `+`, `/` or `#`";
            found.wrong(name.at, what);
        }
    }
    table.end(found);
    Some(Sparkplug { group: group?.value, node: node?.value, device: device.map(|d| d.value) })
}

/// Refuses what is no name of a topic (MQTT 5.0, 4.7).
pub(super) fn topic_name(topic: &str) -> Result<(), String> {
    if topic.is_empty() || topic.len() > 65_535 || topic.contains('\0') {
        return Err("the name of a topic has 1 to 65535 bytes".to_owned());
    }
    if topic.contains(['+', '#']) {
        return Err(format!("`{topic}` has a wildcard; a point has one topic"));
    }
    Ok(())
}

/// Refuses topics that belong to the broker (MQTT 5.0, 4.7.2).
pub(crate) fn publishable(topic: &str) -> Result<(), String> {
    if topic.starts_with('$') {
        return Err(format!("`{topic}` belongs to the broker: nothing is published there"));
    }
    Ok(())
}

/// Gets passwords. `read` gives the bytes of a file or variable, or says why not.
pub(super) fn read_passwords<'d>(
    passwords: impl Iterator<Item = &'d mut Password>,
    mut read: impl FnMut(&Origin) -> Result<Vec<u8>, String>,
) -> Vec<Problem> {
    let mut problems = Vec::new();
    for password in passwords {
        match read(&password.from.value) {
            Ok(mut bytes) => {
                // Editors end a file with a line end, which is no part of the password.
                while bytes.last().is_some_and(|b| matches!(b, b'\n' | b'\r')) {
                    bytes.pop();
                }
                password.secret = Secret(bytes);
            }
            Err(why) => {
                let what = format!("the password cannot be read: {why}");
                problems.push(Problem::new(&codes::BAD_WIRING, password.from.at, what));
            }
        }
    }
    problems
}
