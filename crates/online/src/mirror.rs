//! The other side of a wiring: the plant of a chart in the place of its devices.
//!
//! Where the controller is a client of Modbus TCP, the plant is a server at the same address, with the
//! same points: what the controller writes there are the outputs of the charts, which the plant sees,
//! and what it reads are the inputs, which the plant drives. So a controller, of G7 or of somebody
//! else, is tried with its real wires against a machine that does not exist.

use std::net::{IpAddr, SocketAddr, ToSocketAddrs as _};

use g7_engine::Addr;
use g7_model::Nanos;
use g7_rig::Bench;

use crate::driver::Out;
use crate::setup::{Device, Kind, Listen, SERVER, Tcp};
use crate::wired::{In, OutAt, WhileBad, Wired, Wiring};
use crate::word::{Source, Target};

/// A controller that is silent for so long is gone: its outputs count as safe, as at a device that has
/// a watchdog.
const SILENCE: Nanos = Nanos::from_millis(1_000);

/// Turns a wiring round. The bench has the inputs and outputs of the chart and its plant, but no charts.
/// With `listen` all servers listen at that address instead of their own.
///
/// # Errors
///
/// A sentence that says which device the plant cannot stand for.
pub fn mirror(bench: &Bench, wiring: &Wiring, listen: Option<IpAddr>) -> Result<Wiring, String> {
    let mut mirrored = Wiring::default();
    for wired in &wiring.devices {
        let name = &wired.device.name.value;
        let (address, low_word_first) = match &wired.device.kind {
            Kind::ModbusTcp(tcp, modbus) => (address(name, tcp, listen)?, modbus.low_word_first),
            Kind::ModbusRtu(serial, _) => {
                return Err(format!(
                    "{name} is on the serial line {}: the plant answers over Modbus TCP alone",
                    serial.port
                ));
            }
            Kind::OpcUa(_) | Kind::S7(_) | Kind::Gpio(_) => {
                return Err(format!(
                    "{name} is of the kind \"{}\": the plant answers over Modbus TCP alone",
                    wired.device.kind.word()
                ));
            }
            // The masters of the chart are not part of its machine; nor is a broker, which is there
            // all the same, nor is a panel of the page.
            Kind::ModbusServer(_) | Kind::Mqtt(_) | Kind::Panel(_) | Kind::OpcUaServer(_) => continue,
        };
        let at = |w: &&Wired| matches!(&w.device.kind, Kind::ModbusServer(l) if l.address == address);
        if let Some(other) = mirrored.devices.iter().find(at) {
            return Err(format!("{name} and {} would both listen at {address}", other.device.name.value));
        }
        let kind = Kind::ModbusServer(Listen { address, silence: SILENCE, low_word_first });
        let device = Device { name: wired.device.name.clone(), kind, timing: SERVER };
        let (inputs, outputs) = (given(bench, wired), driven(bench, wired));
        mirrored.devices.push(Wired { device, inputs, outputs, good: Vec::new() });
    }
    Ok(mirrored)
}

/// The inputs of the server: outputs of the charts.
fn given(bench: &Bench, wired: &Wired) -> Vec<In> {
    let of = |out: &OutAt| {
        let item = bench.item(&out.name)?;
        Some(In {
            name: out.name.clone(),
            target: Target::Word(Addr(item.addr)),
            wire: out.wire.clone(),
            scaling: out.out.scaling,
            bad: out.out.safe.map_or(WhileBad::Hold, WhileBad::Word),
        })
    };
    wired.outputs.iter().filter_map(of).collect()
}

/// The outputs of the server: inputs of the charts.
fn driven(bench: &Bench, wired: &Wired) -> Vec<OutAt> {
    let of = |input: &In| {
        let item = bench.item(&input.name)?;
        Some(OutAt {
            name: input.name.clone(),
            source: Source::Word(Addr(item.addr)),
            wire: input.wire.clone(),
            out: Out { scaling: input.scaling, safe: None },
        })
    };
    wired.inputs.iter().filter_map(of).collect()
}

/// The address of a server, as far as it is one of this machine or `listen` says another.
fn address(name: &str, Tcp { host, port }: &Tcp, listen: Option<IpAddr>) -> Result<SocketAddr, String> {
    if let Some(ip) = listen {
        return Ok(SocketAddr::new(ip, *port));
    }
    let mut named = (host.as_str(), *port).to_socket_addrs().map_err(|e| format!("{name}: {host}: {e}"))?;
    named.find(|address| address.ip().is_loopback()).ok_or_else(|| {
        format!("{name} is at {host}, which is not this machine: --listen 127.0.0.1 answers there instead")
    })
}
