//! A device asked once, by hand: what it is wired to, or any points.

use std::time::Duration;

use g7_host::{Clock as _, WallClock};

use crate::clients::Clients;
use crate::device::{Absent, Failed};
use crate::mqtt;
use crate::setup::{Broker, Device};
use crate::value::{Holds, Raw, Scaling};
use crate::wire::Wire;
use crate::wired::{In, WhileBad, Wired};
use crate::word::Target;

/// A point to read.
pub type Asked = Wire;

/// The answer of a device.
#[derive(Debug)]
pub struct Probed {
    /// The time from the request to the last answer.
    pub took: Duration,
    /// The value of each point, in the order in which they were asked for.
    pub values: Vec<Result<Raw, Absent>>,
}

/// Reaches a device and reads points once. Writes nothing.
///
/// # Errors
///
/// The device cannot be reached, or does not answer.
pub fn probe(clients: &mut Clients, device: &Device, asked: &[Asked]) -> Result<Probed, Failed> {
    // The use of the points does not matter here.
    let scaling =
        Scaling { kind: g7_host::Kind::Bool, holds: Holds::Bit, inverted: false, scale: 1.0, offset: 0.0 };
    let (target, bad) = (Target::Input(0), WhileBad::Hold);
    let input = |wire: &Wire| In { name: String::new(), target, wire: wire.clone(), scaling, bad };
    let inputs = asked.iter().map(input).collect();
    let wired = Wired { device: device.clone(), inputs, outputs: Vec::new(), good: Vec::new() };
    let mut client = clients.looker(&wired).map_err(|e| Failed(e.to_string()))?;
    client.connect()?;
    let mut clock = WallClock::default();
    let mut values = vec![Err(Absent::Unread); asked.len()];
    let done = client.exchange(&[], &[], &mut values, &mut []);
    let took = Duration::from_nanos(clock.now().count().max(0).unsigned_abs());
    client.close();
    done.map(|()| Probed { took, values })
}

/// Reaches a broker and listens for the messages of all inputs and then all outputs that are wired to
/// it, for the time-out at most. Publishes nothing.
///
/// # Errors
///
/// The broker cannot be reached, or does not let this client in.
pub fn hear(broker: &Broker, wired: &Wired) -> Result<Probed, Failed> {
    let mut clock = WallClock::default();
    let values = mqtt::listen(broker, wired)?;
    let took = Duration::from_nanos(clock.now().count().max(0).unsigned_abs());
    Ok(Probed { took, values })
}

/// Reaches a device and waits for the values of all inputs and then all outputs that are wired to it, for
/// the time-out at most. Writes nothing.
///
/// # Errors
///
/// The device cannot be reached, or does not answer.
pub fn ask(clients: &mut Clients, wired: &Wired) -> Result<Probed, Failed> {
    let outputs = wired.outputs.iter().map(|out| In {
        name: out.name.clone(),
        target: Target::Input(0),
        wire: out.wire.clone(),
        scaling: out.out.scaling,
        bad: WhileBad::Hold,
    });
    let inputs: Vec<In> = wired.inputs.iter().cloned().chain(outputs).collect();
    let asked = Wired { device: wired.device.clone(), inputs, outputs: Vec::new(), good: Vec::new() };
    let mut device = clients.device(&asked).map_err(|e| Failed(e.to_string()))?;
    let mut clock = WallClock::default();
    let mut values = vec![Err(Absent::Unread); asked.inputs.len()];
    device.connect()?;
    let mut done = Ok(());
    while done.is_ok() && values.contains(&Err(Absent::Unread)) && clock.now() < wired.device.timing.timeout {
        std::thread::sleep(PAUSE);
        done = device.exchange(&[], &[], &mut values, &mut []);
    }
    let took = Duration::from_nanos(clock.now().count().max(0).unsigned_abs());
    device.close();
    done.map(|()| Probed { took, values })
}

/// The time between two looks at a device that sends its values by itself.
const PAUSE: Duration = Duration::from_millis(10);
