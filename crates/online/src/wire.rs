//! The point of a device to which a variable is wired, as far as its device must know it.

use g7_model::Nanos;

use crate::panel::Part;
use crate::setup::{NodeId, Place};

/// A point of a device.
#[derive(Clone, Debug, PartialEq)]
pub enum Wire {
    /// Bits or registers of Modbus.
    Modbus(Place),
    /// A topic of MQTT.
    Topic(Topic),
    /// A metric of Sparkplug, by name.
    Metric(String),
    /// A part of a panel.
    Panel(Part),
    /// A node of an OPC UA server.
    Node(NodeId),
    /// A node of the OPC UA server of our own.
    Shown(Shown),
    /// How good the value of a node of that server is, by the name of the node: a [`Worth`].
    Worth(String),
}

/// A node of the OPC UA server of our own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    /// Its name.
    pub name: String,
    /// Its folder.
    pub folder: Folder,
    /// What is told about it.
    pub about: About,
}

/// The folders of the OPC UA server of our own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Folder {
    /// Inputs of the chart.
    Inputs,
    /// Outputs of the chart.
    Outputs,
    /// Other variables.
    Variables,
    /// Activities and times of steps.
    Steps,
}

/// What is told about a node. It is no part of the wire, so that a chart with another comment has the same
/// wires.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// The author's comment.
    pub comment: Option<String>,
    /// The unit of the value.
    pub unit: Option<String>,
}

impl PartialEq for About {
    fn eq(&self, _: &About) -> bool {
        true
    }
}

impl Eq for About {}

/// How good the value of an input is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Worth {
    /// It has not been read since the start.
    Unread,
    /// It is that of its device.
    Good,
    /// Its device gives none: it is the last one.
    Last,
    /// Its device gives none: it is the substitute.
    Substitute,
    /// Its device gives none, and the controller stops for that.
    None,
}

impl Worth {
    const ALL: [Worth; 5] = [Worth::Unread, Worth::Good, Worth::Last, Worth::Substitute, Worth::None];

    /// Its word.
    pub(crate) fn word(self) -> u64 {
        Worth::ALL.iter().position(|worth| *worth == self).map_or(0, |at| at as u64)
    }

    /// The worth of a word.
    pub fn of(word: i128) -> Worth {
        usize::try_from(word).ok().and_then(|at| Worth::ALL.get(at).copied()).unwrap_or(Worth::None)
    }
}

/// A topic of MQTT and its messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topic {
    /// The topic.
    pub name: String,
    /// The field of a JSON object: its name, or a pointer as RFC 6901 has it.
    pub field: Option<String>,
    /// Quality of service 1 in place of 0.
    pub acknowledged: bool,
    /// The broker keeps the last message of an output.
    pub retain: bool,
    /// The broker publishes the safe value of an output when the connection is lost.
    pub will: bool,
    /// Without a message for so long an input is bad.
    pub silence: Option<Nanos>,
}

impl Wire {
    /// The bits or registers, where it has some.
    pub fn place(&self) -> Option<Place> {
        match self {
            Wire::Modbus(place) => Some(*place),
            Wire::Topic(_)
            | Wire::Metric(_)
            | Wire::Panel(_)
            | Wire::Node(_)
            | Wire::Shown(_)
            | Wire::Worth(_) => None,
        }
    }
}

impl std::fmt::Display for Wire {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Wire::Modbus(place) => place.register.fmt(f),
            Wire::Topic(Topic { name, field: None, .. }) => write!(f, "topic({name})"),
            Wire::Topic(Topic { name, field: Some(field), .. }) => write!(f, "topic({name}) {field}"),
            Wire::Metric(name) => write!(f, "metric({name})"),
            Wire::Node(node) => write!(f, "node({node})"),
            Wire::Shown(Shown { name, .. }) => write!(f, "node({name})"),
            Wire::Worth(name) => write!(f, "node({name}) status"),
            Wire::Panel(part) => part.handle.fmt(f),
        }
    }
}
