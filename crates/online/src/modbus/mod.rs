//! Devices of Modbus TCP and Modbus RTU, which G7 is the client of, and masters, which it is the server
//! of (`server`).
//!
//! The library is asynchronous; each device has a thread of its own, in which its requests are waited
//! for one after the other.

mod blocks;
mod masters;
mod rtu;
mod server;
mod shared;

use std::net::ToSocketAddrs as _;
use std::sync::Arc;
use std::time::Duration;

use tokio::runtime::{Builder, Runtime};
use voltage_modbus::{GenericModbusClient, ModbusClient, ModbusError, ModbusTcpClient};

use crate::device::{Absent, Device, Failed};
use crate::setup::{Area, Kind, Modbus, Place, Serial, Tcp};
use crate::value::Raw;
use crate::wired::Wired;

use blocks::{Block, decode, encode, reads, writes};
use rtu::{Line, Slave};
use server::Server;
use shared::{duration, set};

/// The units of a machine. Those on one serial line share it.
#[derive(Default)]
pub(crate) struct Units {
    lines: Vec<(String, Arc<Line>)>,
}

impl Units {
    /// A device that is wired.
    ///
    /// # Errors
    ///
    /// The system has no resources for it.
    pub(crate) fn device(&mut self, wired: &Wired) -> std::io::Result<Box<dyn Device>> {
        if let Kind::ModbusServer(listen) = &wired.device.kind {
            return Ok(Box::new(Server::new(listen.clone(), wired)));
        }
        let client = self.client(wired)?.ok_or(std::io::ErrorKind::Unsupported)?;
        Ok(Box::new(client))
    }

    /// A client of a device that is wired; `None` where it is no slave.
    ///
    /// # Errors
    ///
    /// The system has no resources for it.
    fn client(&mut self, wired: &Wired) -> std::io::Result<Option<Client>> {
        let timeout = duration(wired.device.timing.timeout);
        let (way, modbus) = match wired.device.kind.clone() {
            Kind::ModbusTcp(tcp, modbus) => (Way::Tcp(tcp, None), modbus),
            Kind::ModbusRtu(serial, modbus) => {
                let slave = Slave { line: self.line(serial), timeout };
                (Way::Rtu(GenericModbusClient::new(slave)), modbus)
            }
            _ => return Ok(None),
        };
        let inputs: Vec<Place> = wired.inputs.iter().filter_map(|i| i.wire.place()).collect();
        let outputs = wired.outputs.iter().filter_map(|o| o.wire.place()).collect();
        Ok(Some(Client {
            way,
            modbus,
            timeout,
            reads: reads(&inputs),
            inputs,
            outputs,
            runtime: Builder::new_current_thread().enable_all().build()?,
        }))
    }

    fn line(&mut self, serial: Serial) -> Arc<Line> {
        if let Some((_, line)) = self.lines.iter().find(|(port, _)| *port == serial.port) {
            return Arc::clone(line);
        }
        let port = serial.port.clone();
        let line = Arc::new(Line::new(serial));
        self.lines.push((port, Arc::clone(&line)));
        line
    }
}

/// A client of one unit.
struct Client {
    way: Way,
    modbus: Modbus,
    timeout: Duration,
    inputs: Vec<Place>,
    outputs: Vec<Place>,
    reads: Vec<Block>,
    runtime: Runtime,
}

/// The way to a unit.
enum Way {
    Tcp(Tcp, Option<ModbusTcpClient>),
    Rtu(GenericModbusClient<Slave>),
}

fn failed(error: &ModbusError) -> Failed {
    Failed(error.to_string())
}

async fn reach(tcp: &Tcp, timeout: Duration) -> Result<ModbusTcpClient, Failed> {
    let Tcp { host, port } = tcp;
    let named = (host.as_str(), *port).to_socket_addrs();
    let mut last = Failed(format!("{host} has no address"));
    for address in named.map_err(|e| Failed(format!("{host}: {e}")))? {
        match ModbusTcpClient::new(address, timeout).await {
            Ok(client) => return Ok(client),
            Err(error) => last = failed(&error),
        }
    }
    Err(last)
}

impl Device for Client {
    fn connect(&mut self) -> Result<(), Failed> {
        match &mut self.way {
            Way::Tcp(tcp, line) => *line = Some(self.runtime.block_on(reach(tcp, self.timeout))?),
            Way::Rtu(slave) => slave.transport().line.open().map_err(|e| Failed(e.to_string()))?,
        }
        Ok(())
    }

    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        refused: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let to = To { unit: self.modbus.unit, low_first: self.modbus.low_word_first };
        let blocks = writes(&self.outputs, write);
        let write = Writes { blocks: &blocks, places: &self.outputs, values: outputs };
        let read = Reads { blocks: &self.reads, places: &self.inputs };
        self.runtime.block_on(async {
            match &mut self.way {
                Way::Tcp(_, Some(line)) => to.exchange(line, write, refused, read, inputs).await,
                Way::Rtu(line) => to.exchange(line, write, refused, read, inputs).await,
                Way::Tcp(_, None) => Err(Failed("there is no connection".to_owned())),
            }
        })
    }

    fn close(&mut self) {
        // The connection ends in any case: a device that is gone cannot answer.
        self.runtime.block_on(async {
            match &mut self.way {
                Way::Tcp(_, line) => {
                    if let Some(mut line) = line.take() {
                        line.close().await.ok();
                    }
                }
                Way::Rtu(line) => drop(line.close().await),
            }
        });
    }
}

/// The outputs of an exchange.
#[derive(Clone, Copy)]
struct Writes<'a> {
    blocks: &'a [Block],
    places: &'a [Place],
    values: &'a [Raw],
}

/// The inputs of an exchange.
#[derive(Clone, Copy)]
struct Reads<'a> {
    blocks: &'a [Block],
    places: &'a [Place],
}

/// The unit that requests go to, and the order of its words.
#[derive(Clone, Copy)]
struct To {
    unit: u8,
    low_first: bool,
}

impl To {
    async fn exchange(
        self,
        line: &mut impl ModbusClient,
        write: Writes<'_>,
        refused: &mut [Option<String>],
        read: Reads<'_>,
        inputs: &mut [Result<Raw, Absent>],
    ) -> Result<(), Failed> {
        for block in write.blocks {
            if let Err(why) = self.write(line, block, write).await? {
                for k in &block.places {
                    set(refused, *k, Some(why.clone()));
                }
            }
        }
        for block in read.blocks {
            self.read(line, block, read.places, inputs).await?;
        }
        Ok(())
    }

    /// Writes a block; the reason where the device refuses it.
    async fn write(
        self,
        line: &mut impl ModbusClient,
        block: &Block,
        write: Writes<'_>,
    ) -> Result<Result<(), String>, Failed> {
        let Block { area, from, count, places } = block;
        let member = |k: &usize| Some((write.places.get(*k)?, *write.values.get(*k)?));
        let members = places.iter().filter_map(member);
        let result = if area.is_bits() {
            let bits: Vec<bool> = members.map(|(_, raw)| raw == Raw::Bit(true)).collect();
            match bits.as_slice() {
                [bit] => line.write_05(self.unit, *from, *bit).await,
                bits => line.write_0f(self.unit, *from, bits).await,
            }
        } else {
            let mut registers = vec![0; usize::from(*count)];
            members.for_each(|(place, raw)| encode(place, *from, raw, &mut registers, self.low_first));
            match registers.as_slice() {
                [register] => line.write_06(self.unit, *from, *register).await,
                registers => line.write_10(self.unit, *from, registers).await,
            }
        };
        refusal(result)
    }

    /// Reads a block.
    async fn read(
        self,
        line: &mut impl ModbusClient,
        block: &Block,
        places: &[Place],
        inputs: &mut [Result<Raw, Absent>],
    ) -> Result<(), Failed> {
        let Block { area, from, count, places: members } = block;
        let (mut bits, mut registers) = (Vec::new(), Vec::new());
        let read = match area {
            Area::Coil => refusal(line.read_01(self.unit, *from, *count).await)?.map(|b| bits = b),
            Area::Discrete => refusal(line.read_02(self.unit, *from, *count).await)?.map(|b| bits = b),
            Area::Holding => refusal(line.read_03(self.unit, *from, *count).await)?.map(|r| registers = r),
            Area::Input => refusal(line.read_04(self.unit, *from, *count).await)?.map(|r| registers = r),
        };
        for k in members {
            let Some(place) = places.get(*k) else { continue };
            let value = || {
                if area.is_bits() {
                    let at = usize::from(place.register.address - from);
                    bits.get(at).map(|bit| Raw::Bit(*bit))
                } else {
                    decode(place, *from, &registers, self.low_first)
                }
            };
            let value = match &read {
                Ok(()) => value().ok_or(Absent::Unread),
                Err(why) => Err(Absent::Refused(why.clone())),
            };
            set(inputs, *k, value);
        }
        Ok(())
    }
}

/// An exception of the device is its answer: only this request failed.
fn refusal<T>(result: Result<T, ModbusError>) -> Result<Result<T, String>, Failed> {
    match result {
        Ok(value) => Ok(Ok(value)),
        Err(ModbusError::Exception { code, message, .. }) => Ok(Err(format!("exception {code}: {message}"))),
        Err(error) => Err(failed(&error)),
    }
}
