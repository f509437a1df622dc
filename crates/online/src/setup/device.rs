//! A row of `[devices]`.

use g7_model::Nanos;

use super::table::{At, Found, Row, Table};

/// A device.
#[derive(Clone, Debug)]
pub struct Device {
    /// Its name, by which channels name it.
    pub name: At<String>,
    /// How it is reached.
    pub kind: Kind,
    /// When it is asked.
    pub timing: Timing,
}

/// How a device is reached.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A server of Modbus TCP, which this is a client of.
    ModbusTcp(Tcp, Modbus),
}

impl Kind {
    /// The words of the file.
    pub const WORDS: [&'static str; 1] = ["modbus-tcp"];
}

/// The address of a server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tcp {
    /// Its name or address.
    pub host: String,
    /// Its port; 502 is that of Modbus.
    pub port: u16,
}

/// The settings of Modbus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Modbus {
    /// The unit that is asked, 0 to 247; behind a gateway there are several.
    pub unit: u8,
    /// True if the low word of a value of several registers comes first.
    pub low_word_first: bool,
}

/// When a device is asked, and how long is waited for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// The time between two exchanges.
    pub poll: Nanos,
    /// The longest time that an answer takes.
    pub timeout: Nanos,
    /// Outputs that did not change are written again after this time, so that a device whose own
    /// watchdog waits for them is content.
    pub refresh: Nanos,
    /// The longest time between two attempts to reach a device that is gone.
    pub retry: Nanos,
}

impl Default for Timing {
    fn default() -> Timing {
        Timing {
            poll: Nanos::from_millis(20),
            timeout: Nanos::from_millis(500),
            refresh: Nanos::SECOND,
            retry: Nanos::from_millis(2_000),
        }
    }
}

/// Reads a device.
pub(super) fn read(row: &Row<'_>, found: &mut Found) -> Option<Device> {
    let name = At::new(row.name.to_owned(), row.at);
    let Some(table) = row.value.as_table() else {
        found.wrong(row.value_at, format!("the device {} is a table", row.name)).help =
            Some(format!("begin it by a line `[devices.{}]`", row.name));
        return None;
    };
    let mut table = Table::new(table, row.at, format!("the device {}", row.name));
    let kind = table.needed(found, "kind", "modbus-tcp")?;
    let kind = match kind.value.as_str() {
        "modbus-tcp" => tcp(&mut table, found).map(|tcp| Kind::ModbusTcp(tcp, modbus(&mut table, found))),
        _ => {
            let known: Vec<String> = Kind::WORDS.iter().map(|word| format!("\"{word}\"")).collect();
            found.wrong(kind.at, format!("no kind of device is called \"{}\"", kind.value)).help =
                Some(format!("the kinds are {}", known.join(", ")));
            return None;
        }
    };
    let timing = timing(&mut table, found);
    table.end(found);
    Some(Device { name, kind: kind?, timing })
}

fn tcp(table: &mut Table<'_>, found: &mut Found) -> Option<Tcp> {
    let port = table.whole(found, "port", 1..=65_535).map_or(502, |port| port.value);
    let host = table.needed(found, "host", "10.0.0.7")?;
    Some(Tcp { host: host.value, port: u16::try_from(port).ok()? })
}

fn modbus(table: &mut Table<'_>, found: &mut Found) -> Modbus {
    let unit = table.whole(found, "unit", 0..=247).map_or(1, |unit| unit.value);
    let low_word_first = table.word(found, "words", &[("high-first", false), ("low-first", true)]);
    Modbus { unit: unit as u8, low_word_first: low_word_first.is_some_and(|low| low.value) }
}

fn timing(table: &mut Table<'_>, found: &mut Found) -> Timing {
    let usual = Timing::default();
    let mut time = |key, usual: Nanos, least: Nanos| {
        table.duration(found, key, least, Nanos::HOUR).map_or(usual, |time| time.value)
    };
    Timing {
        poll: time("poll", usual.poll, Nanos::MILLISECOND),
        timeout: time("timeout", usual.timeout, Nanos::MILLISECOND),
        refresh: time("refresh", usual.refresh, Nanos::MILLISECOND),
        retry: time("retry", usual.retry, Nanos::from_millis(10)),
    }
}
