//! Controllers of Siemens, which G7 is a client of (decision 35).
//!
//! Inputs that stand near each other are read as one item, and items share a request as far as both
//! messages hold them. What an item is refused for is told for its points; a joined item is taken apart
//! then, so that one wrong address does not cost its neighbours their values.

mod blocks;
mod frames;

use std::io::{Read as _, Write as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::time::Duration;

use g7_host::{Clock as _, WallClock};
use g7_model::Nanos;

use crate::device::{Absent, Device, Failed};
use crate::setup::S7;
use crate::value::Raw;
use crate::wire::{Cell, Wire};
use crate::wired::Wired;

use blocks::Block;
use frames::{Item, PACKET, Wrong};

/// A client of a controller.
pub(crate) struct Client {
    s7: S7,
    timeout: Duration,
    inputs: Vec<Cell>,
    outputs: Vec<Cell>,
    line: Option<Line>,
}

/// A connection that is set up.
struct Line {
    stream: TcpStream,
    number: u16,
    /// The length of messages.
    agreed: u16,
    reads: Vec<Block>,
}

/// A controller that is wired.
pub(crate) fn device(s7: &S7, wired: &Wired) -> Box<dyn Device> {
    let cell = |wire: &Wire| if let Wire::S7(cell) = wire { Some(*cell) } else { None };
    let nanos = wired.device.timing.timeout.count().max(0).unsigned_abs();
    Box::new(Client {
        s7: s7.clone(),
        timeout: Duration::from_nanos(nanos),
        inputs: wired.inputs.iter().filter_map(|i| cell(&i.wire)).collect(),
        outputs: wired.outputs.iter().filter_map(|o| cell(&o.wire)).collect(),
        line: None,
    })
}

fn failed(error: &std::io::Error) -> Failed {
    match error.kind() {
        std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut => {
            Failed("no answer within the time-out".to_owned())
        }
        std::io::ErrorKind::UnexpectedEof => Failed("it has closed the connection".to_owned()),
        _ => Failed(error.to_string()),
    }
}

impl Client {
    fn reach(&self) -> Result<TcpStream, Failed> {
        let S7 { host, port, .. } = &self.s7;
        let named = (host.as_str(), *port).to_socket_addrs().map_err(|e| Failed(format!("{host}: {e}")))?;
        let mut last = Failed(format!("{host} has no address"));
        for address in named {
            match TcpStream::connect_timeout(&address, self.timeout) {
                Ok(stream) => {
                    stream.set_nodelay(true).map_err(|e| failed(&e))?;
                    return Ok(stream);
                }
                Err(e) => last = failed(&e),
            }
        }
        Err(last)
    }
}

/// Sends a packet and takes the next one, both within the time-out.
fn ask(stream: &mut TcpStream, packet: &[u8], timeout: Duration) -> Result<Vec<u8>, Failed> {
    let mut clock = WallClock::default();
    stream.set_write_timeout(Some(timeout)).map_err(|e| failed(&e))?;
    stream.write_all(packet).map_err(|e| failed(&e))?;
    let mut head = [0; PACKET];
    hear(stream, &mut clock, timeout, &mut head)?;
    let length = frames::length(&head).ok_or_else(|| Failed("it does not speak ISO transport".to_owned()))?;
    let mut answer = head.to_vec();
    answer.resize(length, 0);
    hear(stream, &mut clock, timeout, answer.get_mut(PACKET..).unwrap_or(&mut []))?;
    Ok(answer)
}

fn hear(
    stream: &mut TcpStream,
    clock: &mut WallClock,
    timeout: Duration,
    into: &mut [u8],
) -> Result<(), Failed> {
    let mut got = 0;
    while let Some(rest) = into.get_mut(got..).filter(|rest| !rest.is_empty()) {
        let spent = Duration::from_nanos(clock.now().max(Nanos::ZERO).count().unsigned_abs());
        let left = timeout.checked_sub(spent).filter(|left| !left.is_zero());
        let late = || failed(&std::io::ErrorKind::TimedOut.into());
        stream.set_read_timeout(Some(left.ok_or_else(late)?)).map_err(|e| failed(&e))?;
        match stream.read(rest).map_err(|e| failed(&e))? {
            0 => return Err(failed(&std::io::ErrorKind::UnexpectedEof.into())),
            count => got += count,
        }
    }
    Ok(())
}

fn broken(wrong: Wrong) -> Failed {
    match wrong {
        Wrong::Broken(why) => Failed(why.to_owned()),
        Wrong::Refused(why) => Failed(why),
    }
}

impl Line {
    fn number(&mut self) -> u16 {
        self.number = self.number.wrapping_add(1);
        self.number
    }

    /// Writes a cell; the reason where the controller refuses it.
    fn write(&mut self, cell: &Cell, raw: Raw, timeout: Duration) -> Result<Result<(), String>, Failed> {
        let number = self.number();
        let request = frames::write(number, cell, &blocks::encode(cell, raw));
        match frames::written(&ask(&mut self.stream, &request, timeout)?, number) {
            Ok(done) => Ok(done),
            Err(Wrong::Refused(why)) => Ok(Err(why)),
            Err(wrong) => Err(broken(wrong)),
        }
    }

    /// Reads all blocks into the inputs.
    fn read(
        &mut self,
        cells: &[Cell],
        inputs: &mut [Result<Raw, Absent>],
        timeout: Duration,
    ) -> Result<(), Failed> {
        let items: Vec<Item> = self.reads.iter().map(|block| block.item.clone()).collect();
        let mut apart = Vec::new();
        let mut at = 0;
        while let Some(rest) = items.get(at..).filter(|rest| !rest.is_empty()) {
            let asked = rest.get(..frames::share(rest, self.agreed)).unwrap_or(rest);
            let number = self.number();
            let answer = ask(&mut self.stream, &frames::read(number, asked), timeout)?;
            let values = match frames::values(&answer, number, asked) {
                Ok(values) => values,
                Err(Wrong::Refused(why)) => vec![Err(why); asked.len()],
                Err(wrong) => return Err(broken(wrong)),
            };
            for (k, value) in values.into_iter().enumerate() {
                let Some(block) = self.reads.get(at + k) else { continue };
                if value.is_err() && block.cells.len() > 1 {
                    apart.push(at + k);
                }
                block.give(&value, cells, inputs);
            }
            at += asked.len();
        }
        self.take_apart(&apart, cells);
        Ok(())
    }

    /// Reads the points of refused blocks one by one from here on.
    fn take_apart(&mut self, apart: &[usize], cells: &[Cell]) {
        for at in apart.iter().rev() {
            let single = self.reads.remove(*at).cells.into_iter();
            self.reads.extend(single.filter_map(|k| cells.get(k).map(|cell| Block::of(k, cell))));
        }
    }
}

impl Device for Client {
    fn connect(&mut self) -> Result<(), Failed> {
        self.line = None;
        let mut stream = self.reach()?;
        let request = frames::connect(self.s7.resource, self.s7.rack, self.s7.slot);
        if !frames::is_connected(&ask(&mut stream, &request, self.timeout)?) {
            return Err(Failed(
                "it has no processor at this rack and slot, or no connection free".to_owned(),
            ));
        }
        let number = 1;
        let answer = ask(&mut stream, &frames::setup(number), self.timeout)?;
        let agreed = frames::agreed(&answer, number).map_err(broken)?;
        let reads = blocks::reads(&self.inputs, frames::most(agreed));
        self.line = Some(Line { stream, number, agreed, reads });
        Ok(())
    }

    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        refused: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let line = self.line.as_mut().ok_or_else(|| Failed("there is no connection".to_owned()))?;
        let wanted = self.outputs.iter().zip(outputs).zip(write).zip(refused);
        for (((cell, raw), _), refused) in wanted.filter(|(((_, _), write), _)| **write) {
            *refused = line.write(cell, *raw, self.timeout)?.err();
        }
        line.read(&self.inputs, inputs, self.timeout)
    }

    fn close(&mut self) {
        self.line = None;
    }
}
