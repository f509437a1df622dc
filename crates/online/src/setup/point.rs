//! Points of devices as the io file writes them: `line1.coil(2)`.

use g7_model::{Said, Span, say};

use super::broker::topic_name;
use super::field::{self, Address, whole};
use super::panel::{self, Handle};
use super::table::{At, Found};

/// A point of a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Point {
    /// A bit or register of Modbus.
    Modbus(Register),
    /// A topic of MQTT.
    Topic(String),
    /// A metric of Sparkplug; without a name it has that of the variable.
    Metric(Option<String>),
    /// A node of OPC UA; on a server of our own, without a name, it has that of the variable.
    Node(Option<String>),
    /// An address of a controller of Siemens.
    S7(Address),
    /// A line of a chip of this machine, by its number there.
    Line(u32),
    /// A part of a panel.
    Panel(Handle),
    /// True while the device answers.
    Good,
}

/// A bit or register of Modbus (Modbus application protocol 1.1b3, 4.3); addresses count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Register {
    /// The table that it is in.
    pub area: Area,
    /// The address of the bit, or of the first register.
    pub address: u16,
    /// One bit of a register, 0 to 15.
    pub bit: Option<u8>,
}

/// The four tables of Modbus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Area {
    /// Bits that can be written.
    Coil,
    /// Bits that can only be read.
    Discrete,
    /// Registers that can only be read.
    Input,
    /// Registers that can be written.
    Holding,
}

impl Area {
    /// The words of the file.
    pub const WORDS: [(&'static str, Area); 4] = [
        ("coil", Area::Coil),
        ("discrete", Area::Discrete),
        ("input", Area::Input),
        ("holding", Area::Holding),
    ];

    /// The word of the file.
    pub fn word(self) -> &'static str {
        match self {
            Area::Coil => "coil",
            Area::Discrete => "discrete",
            Area::Input => "input",
            Area::Holding => "holding",
        }
    }

    /// True if it holds bits.
    pub fn is_bits(self) -> bool {
        matches!(self, Area::Coil | Area::Discrete)
    }

    /// True if it can be written.
    pub fn is_writable(self) -> bool {
        matches!(self, Area::Coil | Area::Holding)
    }
}

/// How registers hold a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Encoding {
    /// An unsigned number of so many registers.
    Unsigned(u8),
    /// A signed number of so many registers, two's complement.
    Signed(u8),
    /// IEEE 754, single precision, in two registers.
    F32,
    /// IEEE 754, double precision, in four registers.
    F64,
}

impl Encoding {
    /// The words of the file.
    pub const WORDS: &'static [(&'static str, Encoding)] = &[
        ("u16", Encoding::Unsigned(1)),
        ("i16", Encoding::Signed(1)),
        ("u32", Encoding::Unsigned(2)),
        ("i32", Encoding::Signed(2)),
        ("u64", Encoding::Unsigned(4)),
        ("i64", Encoding::Signed(4)),
        ("f32", Encoding::F32),
        ("f64", Encoding::F64),
    ];

    /// The number of registers.
    pub fn registers(self) -> u16 {
        match self {
            Encoding::Unsigned(n) | Encoding::Signed(n) => u16::from(n),
            Encoding::F32 => 2,
            Encoding::F64 => 4,
        }
    }
}

/// A point of Modbus: its bit or first register, and its form where it is a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The bit, or the first register.
    pub register: Register,
    /// How registers hold the number; `None` for a bit.
    pub encoding: Option<Encoding>,
}

impl std::fmt::Display for Register {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.bit {
            None => write!(f, "{}({})", self.area.word(), self.address),
            Some(bit) => write!(f, "{}({}.{bit})", self.area.word(), self.address),
        }
    }
}

impl std::fmt::Display for Point {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Point::Modbus(register) => register.fmt(f),
            Point::Topic(topic) => write!(f, "topic({topic})"),
            Point::Metric(name) => write!(f, "metric({})", name.as_deref().unwrap_or("")),
            Point::Node(name) => write!(f, "node({})", name.as_deref().unwrap_or("")),
            Point::S7(address) => address.fmt(f),
            Point::Line(offset) => write!(f, "line({offset})"),
            Point::Panel(handle) => handle.fmt(f),
            Point::Good => f.write_str("good()"),
        }
    }
}

/// Reads `device.point(arguments)`, or `device.address` as it is written for controllers of Siemens.
pub(super) fn read(text: &str, at: Span, found: &mut Found) -> Option<(At<String>, Point)> {
    let read = match addressed(text) {
        Some((device, address)) => address.map(|address| (device, Point::S7(address))).map_err(Some),
        None => parts(text).map_or(Err(None), |(device, word, argument)| {
            point(word, argument).map(|point| (device, point)).map_err(Some)
        }),
    };
    match read {
        Ok((device, point)) => Some((At::new(device.to_owned(), at), point)),
        Err(why) => {
            let what = why.unwrap_or_else(|| say!("\"{}\" is no point of a device", Said::foreign(text)));
            found.wrong(at, what).help = Some(say!(
                "write the device and its point: \"line1.coil(2)\", \"line1.holding(4)\", \
                 \"line1.holding(4.3)\" for one bit, \"broker.topic(plant/level)\", \"plc.DB1.DBX0.0\", \
                 \"board.line(17)\", \"desk.button()\", \"plc.node(ns=2;s=Level)\", \"line1.good()\""
            ));
            None
        }
    }
}

/// The text of a channel with another device; `None` where it names another one.
pub(super) fn renamed(text: &str, from: &str, to: &str) -> Option<String> {
    let (device, rest) = if addressed(text).is_some() {
        text.trim().split_once('.')?
    } else {
        let head = text.split_once('(').map_or(text, |(head, _)| head);
        let dot = head.rfind('.')?;
        (text.get(..dot)?, text.get(dot + 1..)?)
    };
    (device.trim() == from).then(|| format!("{to}.{rest}"))
}

/// `device.DB1.DBX0.0`: the device, and the address or what is wrong with it.
fn addressed(text: &str) -> Option<(&str, Result<Address, Said>)> {
    let (device, address) = text.trim().split_once('.')?;
    field::address(address).map(|address| (device.trim(), address))
}

fn parts(text: &str) -> Option<(&str, &str, &str)> {
    let (head, argument) = called(text)?;
    let (device, word) = head.rsplit_once('.')?;
    Some((device.trim(), word.trim(), argument))
}

/// `head(argument)`.
fn called(text: &str) -> Option<(&str, &str)> {
    let (head, argument) = text.trim().strip_suffix(')')?.split_once('(')?;
    Some((head.trim(), argument.trim()))
}

/// Reads `point(arguments)`.
pub(super) fn of(text: &str) -> Result<Point, Said> {
    if let Some(address) = field::address(text) {
        return address.map(Point::S7);
    }
    let (word, argument) = called(text).ok_or_else(|| say!("`{text}` is no point: write `holding(4)`"))?;
    point(word, argument)
}

fn point(word: &str, argument: &str) -> Result<Point, Said> {
    if word == "good" {
        return if argument.is_empty() { Ok(Point::Good) } else { Err(say!("`good()` has no argument")) };
    }
    match word {
        "topic" => return topic_name(argument).map(|()| Point::Topic(argument.to_owned())),
        "line" => {
            let offset =
                whole(argument, 65_535).ok_or_else(|| say!("a line has a number from 0 to 65535"))?;
            return Ok(Point::Line(u32::from(offset)));
        }
        "metric" => return Ok(Point::Metric(Some(argument.to_owned()).filter(|name| !name.is_empty()))),
        "node" => return Ok(Point::Node(Some(argument.to_owned()).filter(|name| !name.is_empty()))),
        _ => {}
    }
    if let Some(handle) = panel::handle(word, argument) {
        return handle.map(Point::Panel);
    }
    let Some((_, area)) = Area::WORDS.iter().find(|(name, _)| *name == word) else {
        return Err(say!("no point is called `{word}`"));
    };
    let (address, bit) = match argument.split_once('.') {
        Some((address, bit)) => (address, Some(bit)),
        None => (argument, None),
    };
    let address =
        whole(address, 65_535).ok_or_else(|| say!("an address is a whole number from 0 to 65535"))?;
    let bit = match bit {
        Some(_) if area.is_bits() => {
            return Err(say!("{} is one bit already", Said::foreign(format!("{word}({address})"))));
        }
        Some(bit) => Some(whole(bit, 15).ok_or_else(|| say!("a bit of a register is 0 to 15"))? as u8),
        None => None,
    };
    Ok(Point::Modbus(Register { area: *area, address, bit }))
}
