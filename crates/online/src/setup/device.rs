//! A row of `[devices]`.

use std::net::SocketAddr;

use g7_model::{Nanos, Said, say};

use super::broker::{self, Broker};
use super::field::{self, S7};
use super::opcua::{self, OpcUa, OpcUaServer};
use super::panel::{self, Panel};
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
    /// A slave on a serial line, which this is the master of.
    ModbusRtu(Serial, Modbus),
    /// Masters of Modbus TCP, which this is the server of.
    ModbusServer(Listen),
    /// A broker of MQTT 5, which this is a client of.
    Mqtt(Box<Broker>),
    /// A controller of Siemens, which this is a client of.
    S7(S7),
    /// A chip with digital lines (GPIO) of this machine, by its device file.
    Gpio(String),
    /// A server of OPC UA, which this is a client of.
    OpcUa(Box<OpcUa>),
    /// Clients of OPC UA, which this is the server of.
    OpcUaServer(Box<OpcUaServer>),
    /// Buttons and lamps on the operator page.
    Panel(Panel),
}

impl Kind {
    /// The words of the file.
    pub const WORDS: [&'static str; 9] = [
        "modbus-tcp",
        "modbus-rtu",
        "modbus-server",
        "mqtt",
        "opc-ua",
        "opc-ua-server",
        "s7",
        "gpio",
        "panel",
    ];

    /// Its word in the file.
    pub fn word(&self) -> &'static str {
        let [tcp, rtu, server, mqtt, opcua, opcua_server, s7, gpio, panel] = Kind::WORDS;
        match self {
            Kind::ModbusTcp(..) => tcp,
            Kind::ModbusRtu(..) => rtu,
            Kind::ModbusServer(_) => server,
            Kind::Mqtt(_) => mqtt,
            Kind::S7(_) => s7,
            Kind::Gpio(_) => gpio,
            Kind::OpcUa(_) => opcua,
            Kind::OpcUaServer(_) => opcua_server,
            Kind::Panel(_) => panel,
        }
    }

    /// How it is reached, in a few words.
    pub fn place(&self) -> String {
        match self {
            Kind::ModbusTcp(Tcp { host, port }, modbus) => format!("{host}:{port} unit {}", modbus.unit),
            Kind::ModbusRtu(serial, modbus) => format!("{} unit {}", serial.port, modbus.unit),
            Kind::ModbusServer(listen) => listen.address.to_string(),
            Kind::Mqtt(broker) => format!("{}:{}", broker.host, broker.port),
            Kind::S7(s7) => format!("{}:{} rack {} slot {}", s7.host, s7.port, s7.rack, s7.slot),
            Kind::Gpio(chip) => chip.clone(),
            Kind::OpcUa(server) => server.url.clone(),
            Kind::OpcUaServer(server) => server.address.to_string(),
            Kind::Panel(_) => "the operator page".to_owned(),
        }
    }

    /// True if G7 is the server: it waits for requests and has no poll period of its own.
    pub fn is_server(&self) -> bool {
        matches!(self, Kind::ModbusServer(_) | Kind::OpcUaServer(_))
    }

    /// The address that it listens at, where G7 is the server.
    pub fn listens(&self) -> Option<SocketAddr> {
        match self {
            Kind::ModbusServer(listen) => Some(listen.address),
            Kind::OpcUaServer(server) => Some(server.address),
            _ => None,
        }
    }
}

/// A server of our own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listen {
    /// The address and port that it listens at.
    pub address: SocketAddr,
    /// Without a request for so long there is no master.
    pub silence: Nanos,
    /// True if the low word of a value of several registers comes first.
    pub low_word_first: bool,
}

/// The address of a server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tcp {
    /// Its name or address.
    pub host: String,
    /// Its port; 502 is that of Modbus.
    pub port: u16,
}

/// A serial line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Serial {
    /// The device file.
    pub port: String,
    /// Bits per second.
    pub baud: u32,
    /// The parity bit.
    pub parity: Parity,
    /// Two stop bits instead of one.
    pub two_stop_bits: bool,
}

/// The parity bit of a serial line. Modbus over serial line 1.02, 2.5.1: even is the default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Parity {
    /// The number of ones is even.
    #[default]
    Even,
    /// The number of ones is odd.
    Odd,
    /// There is none.
    None,
}

/// The settings that Modbus TCP and Modbus RTU have in common.
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
        found.wrong(row.value_at, say!("the device {} is a table", Said::foreign(row.name))).help =
            Some(say!("begin it by a line `[devices.{}]`", row.name));
        return None;
    };
    let mut table = Table::new(table, row.at, say!("the device {}", Said::foreign(row.name)));
    let kind = table.needed(found, "kind", "modbus-tcp")?;
    let kind = match kind.value.as_str() {
        "modbus-tcp" => tcp(&mut table, found).map(|tcp| Kind::ModbusTcp(tcp, modbus(&mut table, found))),
        "modbus-rtu" => {
            serial(&mut table, found).map(|serial| Kind::ModbusRtu(serial, modbus(&mut table, found)))
        }
        "modbus-server" => listen(&mut table, found).map(Kind::ModbusServer),
        "mqtt" => broker::read(row.name, &mut table, found).map(|broker| Kind::Mqtt(Box::new(broker))),
        "s7" => field::s7(&mut table, found).map(Kind::S7),
        "gpio" => field::chip(&mut table, found).map(Kind::Gpio),
        "opc-ua" => opcua::client(&mut table, found).map(|server| Kind::OpcUa(Box::new(server))),
        "opc-ua-server" => {
            opcua::server(row.name, &mut table, found).map(|server| Kind::OpcUaServer(Box::new(server)))
        }
        "panel" => Some(Kind::Panel(panel::read(&mut table, found))),
        _ => {
            let known: Vec<String> = Kind::WORDS.iter().map(|word| format!("\"{word}\"")).collect();
            found
                .wrong(kind.at, say!("no kind of device is called \"{}\"", Said::foreign(kind.value)))
                .help = Some(say!("the kinds are {}", Said::foreign(known.join(", "))));
            return None;
        }
    };
    let timing = match &kind {
        Some(Kind::ModbusServer(_) | Kind::Panel(_)) => SERVER,
        Some(Kind::OpcUaServer(_)) => SHOWN,
        Some(Kind::Mqtt(_)) => timing(&mut table, found, BROKER),
        Some(Kind::OpcUa(_)) => {
            timing(&mut table, found, Timing { timeout: BROKER.timeout, ..Timing::default() })
        }
        Some(Kind::ModbusTcp(..) | Kind::ModbusRtu(..) | Kind::S7(_) | Kind::Gpio(_)) | None => {
            timing(&mut table, found, Timing::default())
        }
    };
    table.end(found);
    Some(Device { name, kind: kind?, timing })
}

fn tcp(table: &mut Table<'_>, found: &mut Found) -> Option<Tcp> {
    let port = table.whole(found, "port", 1..=65_535).map_or(502, |port| port.value);
    let host = table.needed(found, "host", "10.0.0.7")?;
    Some(Tcp { host: host.value, port: u16::try_from(port).ok()? })
}

fn serial(table: &mut Table<'_>, found: &mut Found) -> Option<Serial> {
    let baud = table.whole(found, "baud", 300..=4_000_000).map_or(19_200, |baud| baud.value);
    let parity = [("even", Parity::Even), ("odd", Parity::Odd), ("none", Parity::None)];
    let parity = table.word(found, "parity", &parity).map_or(Parity::Even, |parity| parity.value);
    let stop = table.whole(found, "stop-bits", 1..=2).map_or(1, |stop| stop.value);
    let port = table.needed(found, "port", "/dev/ttyUSB0")?;
    Some(Serial { port: port.value, baud: u32::try_from(baud).ok()?, parity, two_stop_bits: stop == 2 })
}

fn modbus(table: &mut Table<'_>, found: &mut Found) -> Modbus {
    let unit = table.whole(found, "unit", 0..=247).map_or(1, |unit| unit.value);
    Modbus { unit: unit as u8, low_word_first: low_word_first(table, found) }
}

fn low_word_first(table: &mut Table<'_>, found: &mut Found) -> bool {
    let low = table.word(found, "words", &[("high-first", false), ("low-first", true)]);
    low.is_some_and(|low| low.value)
}

/// The times of a server: its values are handed over each 10 ms, also while no master asks.
pub(crate) const SERVER: Timing = Timing {
    poll: Nanos::from_millis(10),
    timeout: Nanos::SECOND,
    refresh: Nanos::SECOND,
    retry: Nanos::from_millis(100),
};

/// The times of a server that keeps what it was told: only what has changed is handed over.
const SHOWN: Timing = Timing { refresh: Nanos::new(i64::MAX), ..SERVER };

fn listen(table: &mut Table<'_>, found: &mut Found) -> Option<Listen> {
    let address = table.needed(found, "listen", "127.0.0.1:1502");
    let silence = table.duration(found, "silence", Nanos::from_millis(100), Nanos::HOUR);
    let open = table.word(found, "access", &[("this-machine", false), ("anyone", true)]);
    let low_word_first = low_word_first(table, found);
    let address = address?;
    let Ok(parsed) = address.value.parse::<SocketAddr>() else {
        found.wrong(address.at, say!("`listen` is an address of this machine with a port")).help =
            Some(say!("write `listen = \"127.0.0.1:1502\"`, or \"0.0.0.0:502\" for all of its addresses"));
        return None;
    };
    if !parsed.ip().is_loopback() && !open.is_some_and(|open| open.value) {
        found
            .wrong(
                address.at,
                say!("Modbus has no users and no keys: whoever reaches this address may write"),
            )
            .help =
            Some(say!("listen at 127.0.0.1, or say `access = \"anyone\"` where the network is closed"));
        return None;
    }
    Some(Listen {
        address: parsed,
        silence: silence.map_or(Nanos::from_millis(5_000), |silence| silence.value),
        low_word_first,
    })
}

/// The times of a broker, which may be far away. It keeps what it was told, so nothing is repeated.
const BROKER: Timing = Timing {
    poll: Nanos::from_millis(20),
    timeout: Nanos::from_millis(2_000),
    refresh: Nanos::new(i64::MAX),
    retry: Nanos::from_millis(2_000),
};

fn timing(table: &mut Table<'_>, found: &mut Found, usual: Timing) -> Timing {
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

/// Devices on one serial port agree about the line.
pub(super) fn one_line_each(devices: &[Device], found: &mut Found) {
    let lines = devices.iter().filter_map(|d| match &d.kind {
        Kind::ModbusRtu(serial, _) => Some((d, serial)),
        _ => None,
    });
    for (k, (device, serial)) in lines.clone().enumerate() {
        let other = lines.clone().take(k).find(|(_, s)| s.port == serial.port && *s != serial);
        if let Some((first, _)) = other {
            let [one, other, port] = [&first.name.value, &device.name.value, &serial.port].map(Said::foreign);
            let what = say!("{one} and {other} set the serial port {port} otherwise");
            found.wrong(device.name.at, what).related.push((first.name.at, say!("this is the other one")));
        }
    }
}

/// No two files of events are one, nor is one that of the kept values.
pub(super) fn one_file_each(devices: &[Device], retain: Option<&At<String>>, found: &mut Found) {
    let events = devices.iter().filter_map(|d| match &d.kind {
        Kind::Mqtt(broker) => broker.events.as_ref().map(|events| &events.file),
        _ => None,
    });
    for (k, file) in events.clone().enumerate() {
        let others = retain.into_iter().chain(events.clone().take(k));
        if let Some(first) = others.into_iter().find(|other| other.value == file.value) {
            found
                .wrong(file.at, say!("`{}` would hold two things", file.value))
                .related
                .push((first.at, say!("this is the other one")));
        }
    }
}

/// No two servers listen at one address.
pub(super) fn one_address_each(devices: &[Device], found: &mut Found) {
    let servers = devices.iter().filter_map(|d| d.kind.listens().map(|address| (d, address)));
    for (k, (device, address)) in servers.clone().enumerate() {
        if let Some((first, _)) = servers.clone().take(k).find(|(_, other)| *other == address) {
            let [one, other] = [&first.name.value, &device.name.value].map(Said::foreign);
            let address = Said::foreign(address.to_string());
            let what = say!("{one} and {other} listen at one address, {address}");
            found.wrong(device.name.at, what).related.push((first.name.at, say!("this is the other one")));
        }
    }
}
