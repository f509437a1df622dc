//! Controllers of Siemens and lines of this machine: their rows, their points, and what channels say
//! about them.

use g7_model::{Nanos, Said, Span, say};

use super::table::{At, Found, Table};

/// A controller of Siemens that speaks S7, which this is a client of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct S7 {
    /// Its name or address.
    pub host: String,
    /// Its port; 102 is that of ISO transport on TCP.
    pub port: u16,
    /// The rack of its processor, 0 to 7.
    pub rack: u8,
    /// The slot of its processor, 0 to 31.
    pub slot: u8,
    /// The resource that the connection takes: 1 of programming devices, 2 of panels, 3 of others.
    pub resource: u8,
}

/// An address of a controller of Siemens: `DB1.DBX0.0`, `MW2`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Address {
    /// The memory that it is in.
    pub memory: Memory,
    /// The number of the first byte.
    pub byte: u16,
    /// How much of it.
    pub width: Width,
}

/// The memories of a controller of Siemens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Memory {
    /// The image of the inputs.
    Input,
    /// The image of the outputs.
    Output,
    /// The bit memory.
    Flag,
    /// A data block, by number.
    Block(u16),
}

/// The widths of an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Width {
    /// A bit, 0 to 7.
    Bit(u8),
    /// A byte, or several from there on.
    Byte,
    /// Two bytes.
    Word,
    /// Four bytes.
    Double,
}

impl std::fmt::Display for Address {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let letter = match self.memory {
            Memory::Input => "I".to_owned(),
            Memory::Output => "Q".to_owned(),
            Memory::Flag => "M".to_owned(),
            Memory::Block(number) => format!("DB{number}.DB"),
        };
        let bit = if matches!(self.memory, Memory::Block(_)) { "X" } else { "" };
        match self.width {
            Width::Bit(number) => write!(f, "{letter}{bit}{}.{number}", self.byte),
            Width::Byte => write!(f, "{letter}B{}", self.byte),
            Width::Word => write!(f, "{letter}W{}", self.byte),
            Width::Double => write!(f, "{letter}D{}", self.byte),
        }
    }
}

/// How a channel uses a line of a chip.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pin {
    /// The resistor at the line.
    pub bias: Option<At<Bias>>,
    /// TRUE is the low level.
    pub active_low: Option<At<bool>>,
    /// An input has to be steady for so long.
    pub debounce: Option<At<Nanos>>,
}

/// The resistor at a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bias {
    /// To the supply.
    Up,
    /// To ground.
    Down,
    /// None.
    None,
}

impl Pin {
    /// The place of the first setting that there is.
    pub(crate) fn first(&self) -> Option<Span> {
        let places = [
            self.bias.as_ref().map(|b| b.at),
            self.active_low.as_ref().map(|a| a.at),
            self.debounce.as_ref().map(|d| d.at),
        ];
        places.into_iter().flatten().next()
    }
}

/// Reads the settings of a channel.
pub(super) fn pin(table: &mut Table<'_>, input: bool, found: &mut Found) -> Pin {
    let words = [("pull-up", Bias::Up), ("pull-down", Bias::Down), ("none", Bias::None)];
    let bias = table.word(found, "bias", &words);
    let active_low = table.flag(found, "active-low");
    let debounce = if input {
        table.duration(found, "debounce", Nanos::MICROSECOND, Nanos::from_millis(4_000))
    } else {
        None
    };
    Pin { bias, active_low, debounce }
}

/// Reads the row of a controller of Siemens.
pub(super) fn s7(table: &mut Table<'_>, found: &mut Found) -> Option<S7> {
    let port = table.whole(found, "port", 1..=65_535).map_or(102, |port| port.value);
    let rack = table.whole(found, "rack", 0..=7).map_or(0, |rack| rack.value);
    let slot = table.whole(found, "slot", 0..=31).map_or(1, |slot| slot.value);
    let resource = table.word(found, "connection", &[("programmer", 1), ("panel", 2), ("basic", 3)]);
    let host = table.needed(found, "host", "10.0.0.8")?;
    Some(S7 {
        host: host.value,
        port: u16::try_from(port).ok()?,
        rack: u8::try_from(rack).ok()?,
        slot: u8::try_from(slot).ok()?,
        resource: resource.map_or(1, |resource| resource.value),
    })
}

/// Reads the row of a chip of lines: its device file.
pub(super) fn chip(table: &mut Table<'_>, found: &mut Found) -> Option<String> {
    table.needed(found, "chip", "/dev/gpiochip0").map(|chip| chip.value)
}

/// Reads an address of a controller of Siemens, in English or German letters; `None` for what is none.
///
/// # Errors
///
/// The text begins like one, and this is wrong with it.
pub(super) fn address(text: &str) -> Option<Result<Address, Said>> {
    let upper = text.trim().to_ascii_uppercase();
    let (memory, rest) = if let Some(block) = upper.strip_prefix("DB") {
        let (number, rest) = block.split_once('.')?;
        match whole(number, 65_535).filter(|number| *number > 0) {
            Some(number) => (Memory::Block(number), rest.strip_prefix("DB")?),
            None => return Some(Err(say!("a data block has a number from 1 to 65535"))),
        }
    } else {
        let memory = match upper.as_bytes().first()? {
            b'I' | b'E' => Memory::Input,
            b'Q' | b'A' => Memory::Output,
            b'M' => Memory::Flag,
            _ => return None,
        };
        (memory, upper.get(1..)?)
    };
    let block = matches!(memory, Memory::Block(_));
    let first = rest.bytes().next()?;
    let (width, rest) = match first {
        b'B' => (Some(Width::Byte), rest.get(1..)?),
        b'W' => (Some(Width::Word), rest.get(1..)?),
        b'D' => (Some(Width::Double), rest.get(1..)?),
        b'X' => (None, rest.get(1..)?),
        b'0'..=b'9' if !block => (None, rest),
        _ => return None,
    };
    Some(placed(memory, width, rest))
}

fn placed(memory: Memory, width: Option<Width>, rest: &str) -> Result<Address, Said> {
    let number = |byte: &str| whole(byte, 65_535).ok_or_else(|| say!("a byte has a number from 0 to 65535"));
    match width {
        Some(width) => Ok(Address { memory, byte: number(rest)?, width }),
        None => {
            let (byte, bit) =
                rest.split_once('.').ok_or_else(|| say!("a bit is written with its byte: `M0.7`"))?;
            let bit = whole(bit, 7).ok_or_else(|| say!("a bit of a byte is 0 to 7"))?;
            Ok(Address { memory, byte: number(byte)?, width: Width::Bit(bit as u8) })
        }
    }
}

/// A number of plain digits.
pub(super) fn whole(text: &str, most: u16) -> Option<u16> {
    let plain = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    text.parse().ok().filter(|n| plain && *n <= most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_as_people_write_them() {
        let shown = |text: &str| address(text).map(|a| a.map(|a| a.to_string()));
        for (text, expected) in [
            ("DB1.DBX0.7", "DB1.DBX0.7"),
            ("db12.dbw4", "DB12.DBW4"),
            ("DB1.DBD8", "DB1.DBD8"),
            ("DB1.DBB65535", "DB1.DBB65535"),
            ("M0.0", "M0.0"),
            ("MX3.1", "M3.1"),
            ("MW2", "MW2"),
            ("E0.3", "I0.3"),
            ("AB1", "QB1"),
            ("ID4", "ID4"),
            ("q1.2", "Q1.2"),
        ] {
            assert_eq!(shown(text), Some(Ok(expected.to_owned())), "{text}");
        }
        for text in ["DB1.DBX0.8", "DB0.DBW0", "DB1.DBX0", "M0.8", "MW70000", "M0", "MB", "DB1.DBW+1"] {
            assert!(matches!(address(text), Some(Err(_))), "{text}");
        }
        for text in ["", "DB1", "DB1.0", "T5", "coil(1)", "X0.0", "DB1.X0.0", "M", "ä"] {
            assert_eq!(address(text), None, "{text}");
        }
    }
}
