//! The point of a device to which a variable is wired, as far as its device must know it.

use g7_model::Nanos;

use crate::part::Part;
use crate::setup::Place;

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
            Wire::Topic(_) | Wire::Metric(_) | Wire::Panel(_) => None,
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
            Wire::Panel(part) => part.handle.fmt(f),
        }
    }
}
