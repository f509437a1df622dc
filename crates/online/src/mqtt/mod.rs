//! Brokers of MQTT 5, which G7 is a client of.

mod connection;
mod events;
mod payload;
mod plain;
mod sparkplug;

use std::time::Duration;

use crate::device::{Absent, Device, Failed};
use crate::mail::Mail;
use crate::setup::Broker;
use crate::value::Raw;
use crate::wired::Wired;

use plain::Plain;
use sparkplug::Node;

/// A broker that is wired; `mail` has the events for it.
pub(crate) fn device(broker: &Broker, wired: &Wired, mail: Option<Mail>) -> Box<dyn Device> {
    match &broker.sparkplug {
        Some(names) => Box::new(Node::new(broker, names, timeout(wired), wired)),
        None => Box::new(Plain::new(broker, timeout(wired), wired).with_events(mail)),
    }
}

fn timeout(wired: &Wired) -> Duration {
    Duration::from_nanos(wired.device.timing.timeout.count().max(0).unsigned_abs())
}

/// The values that a broker has for the inputs and then the outputs of a device, as far as they come
/// within the time-out. Publishes nothing.
pub(crate) fn listen(broker: &Broker, wired: &Wired) -> Result<Vec<Result<Raw, Absent>>, Failed> {
    let mut listener = Plain::listener(broker, timeout(wired), wired);
    listener.connect()?;
    let mut values = vec![Err(Absent::Unread); wired.inputs.len() + wired.outputs.len()];
    listener.wait_for_values(timeout(wired));
    listener.exchange(&[], &[], &mut values, &mut [])?;
    listener.close();
    Ok(values)
}
