//! The point of a device to which a variable is wired, as far as its device must know it.

use g7_model::Nanos;

use crate::part::Part;
use crate::setup::{Address, Bias, Encoding, Memory, Place, Width};

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
            Wire::Topic(_) | Wire::Metric(_) | Wire::S7(_) | Wire::Line(_) | Wire::Panel(_) => None,
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
            Wire::S7(cell) => cell.address().fmt(f),
            Wire::Line(line) => write!(f, "line({})", line.offset),
            Wire::Panel(part) => part.handle.fmt(f),
        }
    }
}
