//! How a variable is carried by messages: a topic of MQTT, or a metric of Sparkplug.
//!
//! Pure: `wiring` holds the channel against the chart and the device, and asks here for the rest.

use g7_host::Kind;
use g7_model::{Said, Span, say};

use crate::setup::{Broker, Channel, Point, publishable};
use crate::value::{Holds, Scaling};
use crate::wire::{Topic, Wire};

/// Why a channel is refused: the place, the reason, and what to do instead.
pub(crate) struct Refused {
    pub(crate) at: Span,
    pub(crate) what: Said,
    pub(crate) help: Option<Said>,
}

/// The variable of a channel.
pub(crate) struct Carried<'a> {
    pub(crate) name: &'a str,
    pub(crate) kind: Kind,
    /// A bit is the complement of the BOOL.
    pub(crate) inverted: bool,
    /// It is an input of the chart.
    pub(crate) input: bool,
    /// It has a safe value.
    pub(crate) safe: bool,
}

/// The point of a channel at a broker, and how its value becomes a word.
pub(crate) fn wire(
    channel: &Channel,
    carried: &Carried<'_>,
    broker: &Broker,
) -> Result<(Wire, Scaling), Refused> {
    let refused = |at, what: Said, help: Option<Said>| Refused { at, what, help };
    if carried.kind == Kind::Text {
        let what = say!("a message cannot carry `{}`, which is a STRING", carried.name);
        return Err(refused(channel.at, what, Some(say!("a STRING cannot be wired"))));
    }
    if let Some(form) = &channel.encoding {
        return Err(refused(form.at, say!("a message has no form of number"), None));
    }
    let scaling = number(channel, carried)?;
    let wire = match (&channel.point, &broker.sparkplug) {
        (Point::Topic(name), None) => Wire::Topic(topic(channel, carried, broker, name)?),
        (Point::Metric(name), Some(_)) => {
            if let Some(at) = channel.message.first() {
                let what = say!("a metric has no field, quality of service, retain, will or silence");
                return Err(refused(at, what, None));
            }
            let name = name.as_deref().unwrap_or(carried.name);
            if name == "bdSeq" || name.starts_with("Node Control/") {
                return Err(refused(channel.at, say!("`{name}` belongs to Sparkplug itself"), None));
            }
            Wire::Metric(name.to_owned())
        }
        (point, sparkplug) => {
            let what = say!("`{point}` is no point of a broker");
            let help = match sparkplug {
                Some(_) => say!("points of an edge node are metrics: `metric(Tank/Level)`"),
                None => say!("points of a broker are topics: `topic(plant/level)`"),
            };
            return Err(refused(channel.at, what, Some(help)));
        }
    };
    Ok((wire, scaling))
}

fn topic(channel: &Channel, carried: &Carried<'_>, broker: &Broker, name: &str) -> Result<Topic, Refused> {
    let message = &channel.message;
    if !carried.input {
        publishable(name).map_err(|what| Refused { at: channel.at, what, help: None })?;
    }
    let will = message.will.as_ref().filter(|will| will.value);
    if let (Some(will), false) = (will, carried.safe) {
        let what = say!("`{}` is no output: it has no safe value for a will", carried.name);
        return Err(Refused { at: will.at, what, help: None });
    }
    if let (Some(will), Some(_)) = (will, &broker.status) {
        let what = say!("a client of MQTT has one will, and `status` of the broker is it");
        return Err(Refused { at: will.at, what, help: Some(say!("give up one of the two")) });
    }
    Ok(Topic {
        name: name.to_owned(),
        field: message.field.as_ref().map(|f| f.value.clone()),
        acknowledged: message.qos.as_ref().is_none_or(|qos| qos.value == 1),
        retain: message.retain.as_ref().is_none_or(|retain| retain.value),
        will: will.is_some(),
        silence: message.silence.as_ref().map(|s| s.value),
    })
}

/// A message carries any number: only the variable and the scale say what is lost.
pub(crate) fn number(channel: &Channel, carried: &Carried<'_>) -> Result<Scaling, Refused> {
    let numbers = [&channel.scale, &channel.offset];
    if let (Kind::Bool, Some(number)) = (carried.kind, numbers.into_iter().flatten().next()) {
        let what = say!("a BOOL has no scale or offset");
        return Err(Refused { at: number.at, what, help: None });
    }
    let [scale, offset] = [(&channel.scale, 1.0), (&channel.offset, 0.0)]
        .map(|(number, usual)| number.as_ref().map_or(usual, |n| n.value));
    let plain = scale == 1.0 && offset == 0.0;
    let holds = match carried.kind {
        Kind::Bool | Kind::Text => Holds::Bit,
        Kind::Int { bits, signed } if plain => Holds::Whole { bits, signed },
        Kind::Time | Kind::Moment(_) if plain => Holds::Whole { bits: 64, signed: true },
        Kind::Real => Holds::Single,
        Kind::Int { .. } | Kind::Time | Kind::Moment(_) | Kind::Lreal => Holds::Double,
    };
    Ok(Scaling { kind: carried.kind, holds, inverted: carried.inverted, scale, offset })
}
