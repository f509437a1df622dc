//! Asks the devices of an io file for their values, as `g7 devices` does: they are read, never written.
//!
//! # Invariants
//!
//! One question at a time: several pages that show one wiring share its answer.
//! Nothing is asked while a controller of this server drives the machine, which knows the values; nor by
//! a server that other machines reach, since whoever writes the io file there would choose what this
//! machine connects to, and which password it sends.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex as Lock, PoisonError};

use g7_model::Nanos;
use g7_online::setup::{Device, Kind, Setup, read_secrets};
use g7_online::{Absent, Clients, Failed, Probed, Scaling, Wire, Wired, hear, probe};
use serde_json::{Map, Value, json};

use super::super::aside::aside;
use super::super::fingerprint;
use super::super::refusal::Refusal;
use super::super::shared::Shared;
use super::sight::{Chart, Sight};
use super::turn::Latest;
use crate::devices::{plain, value};
use crate::wiring::secret;

/// The longest time that is waited for a device here, whatever the io file says.
const PATIENCE: Nanos = Nanos::from_millis(2_000);
/// Devices that are asked at the same time.
const AT_ONCE: usize = 16;

/// The values of the devices of a chart, or why they are not asked.
pub(super) async fn live(shared: &Shared, chart: Chart) -> Result<Value, Refusal> {
    if shared.station.is_some() {
        return Ok(json!({ "no": "online" }));
    }
    if !shared.asker.asks() {
        return Ok(json!({ "no": "reached" }));
    }
    let of = shared.clone();
    let asked = chart.clone();
    let sight = aside(move || Sight::new(&of, &asked)).await?;
    let question = (sight.text.clone(), chart.text.unwrap_or_default() + &chart.path);
    let mut turn = shared.asker.turn().await;
    if let Some(answer) = turn.as_ref().and_then(|latest| latest.answers(&question)) {
        return Ok(answer.clone());
    }
    let io = shared.folder.root().join(&sight.io);
    let answer = aside(move || Ok(ask(sight, &io))).await?;
    *turn = Some(Latest::new(question, answer.clone()));
    Ok(answer)
}

/// The answer of one device.
struct Heard {
    name: String,
    device: Value,
    values: Vec<(String, Value)>,
}

/// Asks all devices of an io file.
fn ask(mut sight: Sight, io: &std::path::Path) -> Value {
    let unreadable: Vec<Device> = secrets(&mut sight.setup, io);
    let groups = groups(&sight, &unreadable);
    let (next, heard) = (AtomicUsize::new(0), Lock::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE.min(groups.len()) {
            scope.spawn(|| {
                while let Some(group) = groups.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let mut clients = crate::brought::clients();
                    let all: Vec<Heard> = group.iter().map(|wired| one(&mut clients, wired)).collect();
                    heard.lock().unwrap_or_else(PoisonError::into_inner).extend(all);
                }
            });
        }
    });
    let (mut devices, mut values) = (Map::new(), Map::new());
    for Heard { name, device, values: of } in heard.into_inner().unwrap_or_else(PoisonError::into_inner) {
        devices.insert(name, device);
        values.extend(of);
    }
    for device in unreadable {
        let why = "its password or its certificates cannot be read";
        devices.insert(device.name.value, json!({ "is": "silent", "why": why }));
    }
    let hash = sight.bytes.as_ref().map(|bytes| fingerprint::hash(bytes));
    json!({ "hash": hash, "devices": devices, "values": values })
}

/// Reads passwords, certificates and keys. Returns the devices that lack one of theirs: they are not asked.
fn secrets(setup: &mut Setup, io: &std::path::Path) -> Vec<Device> {
    let mut lacking = Vec::new();
    for device in &mut setup.devices {
        let mut alone = Setup { devices: vec![device.clone()], ..Setup::default() };
        let problems = read_secrets(&mut alone, |origin| secret(io, origin));
        if !problems.is_empty() {
            lacking.push(device.clone());
        } else if let Some(read) = alone.devices.pop() {
            *device = read;
        }
    }
    lacking
}

/// The devices that are asked, those on one serial line one after the other.
fn groups(sight: &Sight, but: &[Device]) -> Vec<Vec<Wired>> {
    let mut groups: Vec<(Option<String>, Vec<Wired>)> = Vec::new();
    for device in &sight.setup.devices {
        if but.iter().any(|other| other.name.value == device.name.value) {
            continue;
        }
        let known = sight.wiring.devices.iter().find(|w| w.device.name.value == device.name.value);
        let mut wired = known.cloned().unwrap_or_else(|| Wired {
            device: device.clone(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            good: Vec::new(),
        });
        // The wiring has a copy of the device from before its password was read.
        wired.device = device.clone();
        wired.device.timing.timeout = device.timing.timeout.min(PATIENCE);
        let line = match &device.kind {
            Kind::ModbusRtu(serial, _) => Some(serial.port.clone()),
            _ => None,
        };
        match groups.iter_mut().find(|(of, _)| line.is_some() && *of == line) {
            Some((_, group)) => group.push(wired),
            None => groups.push((line, vec![wired])),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

/// Asks one device.
fn one(clients: &mut Clients, wired: &Wired) -> Heard {
    let name = wired.device.name.value.clone();
    let probed = match &wired.device.kind {
        Kind::ModbusServer(_) | Kind::OpcUaServer(_) => {
            return Heard { name, device: json!({ "is": "server" }), values: Vec::new() };
        }
        Kind::Panel(_) => return Heard { name, device: json!({ "is": "panel" }), values: Vec::new() },
        Kind::Mqtt(broker) => hear(broker, wired),
        Kind::OpcUa(_) => g7_online::ask(clients, wired),
        Kind::ModbusTcp(..) | Kind::ModbusRtu(..) | Kind::S7(_) | Kind::Gpio(_) => {
            let asked: Vec<Wire> = wires(wired).into_iter().map(|(_, wire, _)| wire.clone()).collect();
            probe(clients, &wired.device, &asked)
        }
    };
    told(name, wired, probed)
}

/// The channels of a device: name, point, scaling.
fn wires(wired: &Wired) -> Vec<(&str, &Wire, Scaling)> {
    let inputs = wired.inputs.iter().map(|i| (i.name.as_str(), &i.wire, i.scaling));
    inputs.chain(wired.outputs.iter().map(|o| (o.name.as_str(), &o.wire, o.out.scaling))).collect()
}

fn told(name: String, wired: &Wired, probed: Result<Probed, Failed>) -> Heard {
    let probed = match probed {
        Ok(probed) => probed,
        Err(why) => {
            let device = json!({ "is": "silent", "why": why.to_string() });
            return Heard { name, device, values: Vec::new() };
        }
    };
    let took = (probed.took.as_secs_f64() * 1e4).round() / 10.0;
    let values = wires(wired).into_iter().zip(probed.values).map(|((name, wire, scaling), answer)| {
        let told = match answer {
            Ok(raw) => match value(raw, &scaling) {
                Some(value) => json!({ "value": value, "raw": plain(raw) }),
                None => json!({ "raw": plain(raw), "why": "too-large" }),
            },
            Err(Absent::Unread) if matches!(wire, Wire::Topic(_)) => json!({ "why": "no-message" }),
            Err(Absent::Unread) if matches!(wire, Wire::Metric(_)) => json!({ "why": "of-node" }),
            Err(Absent::Unread) => json!({ "why": "unread" }),
            Err(Absent::Refused(why)) => json!({ "why": why }),
        };
        (name.to_owned(), told)
    });
    let values = values.collect();
    Heard { name, device: json!({ "is": "answers", "took_ms": took }), values }
}
