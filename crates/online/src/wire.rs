//! The point of a device to which a variable is wired, as far as its device must know it.

use g7_model::Nanos;

use crate::part::Part;
use crate::setup::{Address, Bias, Encoding, Memory, NodeId, Place, Width};

/// A point of a device.
#[derive(Clone, Debug, PartialEq)]
pub enum Wire {
    /// Bits or registers of Modbus.
    Modbus(Place),
    /// A topic of MQTT.
    Topic(Topic),
    /// A metric of Sparkplug, by name.
    Metric(String),
    /// Bytes or a bit of a controller of Siemens.
    S7(Cell),
    /// A line of this machine.
    Line(Line),
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
    /// The words about it.
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

/// The words about a node. They are no part of the wire, so that a chart with another comment has the same
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

/// Bytes or a bit of a controller of Siemens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cell {
    /// The memory that it is in.
    pub memory: Memory,
    /// The number of the first byte.
    pub byte: u16,
    /// How it holds the value.
    pub form: Form,
}

/// How bytes hold a value, the highest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Form {
    /// A bit, 0 to 7.
    Bit(u8),
    /// A whole number in one byte.
    Byte {
        /// Two's complement.
        signed: bool,
    },
    /// A number in two, four or eight bytes.
    Number(Encoding),
}

impl Cell {
    /// The number of bytes.
    pub fn bytes(&self) -> u16 {
        match self.form {
            Form::Bit(_) | Form::Byte { .. } => 1,
            Form::Number(encoding) => encoding.registers() * 2,
        }
    }

    /// The number of the byte behind it.
    pub(crate) fn end(&self) -> u32 {
        u32::from(self.byte) + u32::from(self.bytes())
    }

    /// The address, as people write it.
    pub fn address(&self) -> Address {
        let width = match (self.form, self.bytes()) {
            (Form::Bit(bit), _) => Width::Bit(bit),
            (_, 2) => Width::Word,
            (_, 4) => Width::Double,
            _ => Width::Byte,
        };
        Address { memory: self.memory, byte: self.byte, width }
    }
}

/// A line of a chip of this machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// Its number on the chip.
    pub offset: u32,
    /// The resistor; without it that which the line has.
    pub bias: Option<Bias>,
    /// TRUE is the low level.
    pub active_low: bool,
    /// An input has to be steady for so long.
    pub debounce: Option<Nanos>,
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
            _ => None,
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
            Wire::S7(cell) => cell.address().fmt(f),
            Wire::Line(line) => write!(f, "line({})", line.offset),
            Wire::Panel(part) => part.handle.fmt(f),
        }
    }
}
