//! The io file: which devices a machine has, and which inputs and outputs of the chart are wired to
//! them (decision 28).
//!
//! ```toml
//! [devices.line1]
//! kind = "modbus-tcp"
//! host = "10.0.0.7"
//!
//! [inputs]
//! start = "line1.discrete(0)"
//! level = { at = "line1.input(4)", as = "f32", bad = 0.0 }
//!
//! [outputs]
//! valve = "line1.coil(2)"
//!
//! [shown]
//! X3 = "scada.discrete(0)"
//! ```
//!
//! Reading knows nothing of a chart; `wiring` holds the two together.

mod broker;
pub mod catalogue;
mod device;
mod edit;
mod field;
mod history;
mod no_toml;
mod opcua;
mod outline;
mod panel;
mod point;
mod secret;
mod server;
mod table;

use std::net::SocketAddr;
use std::path::Path;

use g7_model::{FileId, Nanos, Problem, Said, Span, say};
use toml::de::{DeTable, DeValue};

pub(crate) use broker::publishable;
pub use broker::{Broker, Events, Message, Sparkplug};
pub(crate) use device::SERVER;
pub use device::{Device, Kind, Listen, Modbus, Parity, Serial, Tcp, Timing};
pub use edit::{Change, Plain, Uneditable, edit};
pub use field::{Address, Bias, Memory, Pin, S7, Width};
pub use history::History;
pub(crate) use history::SIGNALS;
pub use opcua::{Namespace, NodeId, OpcUa, OpcUaServer, Policy, Security, read_node};
pub use outline::{Entry, outline};
pub use panel::{Handle, Limits, Panel};
pub use point::{Area, Encoding, Place, Point, Register};
pub use secret::{Held, Origin, Secret, Tls};
pub use server::{LogFile, Server};
pub use table::At;

use table::{Found, MOST, Row, Table};

/// The contents of an io file.
#[derive(Clone, Debug, Default)]
pub struct Setup {
    /// How the controller runs.
    pub controller: Controller,
    /// Who may use the page of the operator.
    pub server: Server,
    /// The devices, in the order of the file.
    pub devices: Vec<Device>,
    /// The inputs of the chart that are wired.
    pub inputs: Vec<Channel>,
    /// The outputs of the chart that are wired.
    pub outputs: Vec<Channel>,
    /// Variables and steps that masters may read.
    pub shown: Vec<Channel>,
    /// The signals that are recorded.
    pub history: Option<History>,
}

/// The policy for kept values of another program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Changed {
    /// It does not start, and says so.
    #[default]
    Refuse,
    /// It starts cold.
    Cold,
    /// It keeps the retained variables that are the same, and starts in the initial situation.
    Fit,
}

/// How the controller runs: the table `[controller]`.
#[derive(Clone, Debug)]
pub struct Controller {
    /// The time between two scans; without it that of the chart.
    pub period: Option<At<Nanos>>,
    /// The longest time between the ends of two scans; without it ten periods, and 100 ms at least.
    pub watchdog: Option<At<Nanos>>,
    /// The file of the retained values, beside the io file.
    pub retain: Option<At<String>>,
    /// The policy for kept values of another program.
    pub changed: Changed,
    /// True if the controller runs as soon as it is started.
    pub run: bool,
    /// The priority of the scan among the threads of the system, 1 to 99; without it that of others.
    pub priority: Option<At<i64>>,
    /// The address of this machine at which a monitoring system asks.
    pub metrics: Option<At<SocketAddr>>,
    /// The log of events and deeds.
    pub log: Option<LogFile>,
}

impl Default for Controller {
    fn default() -> Controller {
        Controller {
            period: None,
            watchdog: None,
            retain: None,
            changed: Changed::Refuse,
            run: true,
            priority: None,
            metrics: None,
            log: None,
        }
    }
}

/// The policy for an input whose value is bad.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Bad {
    /// It holds the last good value.
    #[default]
    Hold,
    /// It has a value of its own.
    Value(Literal),
    /// The controller stops with a fault.
    Fault,
}

/// A value of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Literal {
    /// A BOOL.
    Bool(bool),
    /// A number.
    Number(f64),
}

/// An input or output of the chart, or what masters read, and where it is wired to.
#[derive(Clone, Debug)]
pub struct Channel {
    /// The variable, by name or by address (`%I0.0`).
    pub variable: At<String>,
    /// The name of the device, and the point of it.
    pub device: At<String>,
    /// The point, as the file writes it.
    pub point: Point,
    /// The place of the point.
    pub at: Span,
    /// How registers hold the value; without it as the type of the variable suggests.
    pub encoding: Option<At<Encoding>>,
    /// The value of the chart is this times the number of the device …
    pub scale: Option<At<f64>>,
    /// … plus this.
    pub offset: Option<At<f64>>,
    /// An input while its value is bad.
    pub bad: At<Bad>,
    /// How the messages of a topic are used.
    pub message: Message,
    /// How a line of a chip is used.
    pub pin: Pin,
    /// The unit of the value, such as `m/s`.
    pub unit: Option<At<String>>,
    /// The numbers that a person can enter on a panel.
    pub limits: Limits,
}

/// Reads an io file. What is wrong is left out and told.
pub fn read(text: &str, file: FileId) -> (Setup, Vec<Problem>) {
    let mut found = Found { file, problems: Vec::new() };
    if text.len() > MOST {
        found.wrong(Span { file, start: 0, end: 0 }, say!("an io file has at most {MOST} bytes"));
        return (Setup::default(), found.problems);
    }
    let (table, errors) = DeTable::parse_recoverable(text);
    for error in errors {
        let at = found.span(error.span().unwrap_or(0..0));
        found.wrong(at, no_toml::no_toml(error.message()));
    }
    let setup = setup(table.get_ref(), &mut found);
    (setup, found.problems)
}

/// Reads a point without its device: `holding(4.3)`.
///
/// # Errors
///
/// A sentence that says what is wrong with it.
pub fn read_point(text: &str) -> Result<Point, Said> {
    point::of(text)
}

/// Gets the passwords, certificates and keys that the file names. `from` gives the bytes of a file or
/// variable, or says why not.
pub fn read_secrets(setup: &mut Setup, from: impl FnMut(&Origin) -> Result<Vec<u8>, Said>) -> Vec<Problem> {
    let peers = setup.devices.iter_mut().filter_map(|device| match &mut device.kind {
        Kind::Mqtt(broker) => Some((broker.password.as_mut(), broker.tls.as_mut())),
        Kind::OpcUa(server) => Some((server.password(), None)),
        _ => None,
    });
    secret::read(peers, from)
}

/// The folders that the file names are in this one from here on, that of the io file.
pub fn settle(setup: &mut Setup, folder: &Path) {
    for device in &mut setup.devices {
        match &mut device.kind {
            Kind::OpcUa(server) => server.settle(folder),
            Kind::OpcUaServer(server) => server.settle(folder),
            _ => {}
        }
    }
}

fn setup(table: &DeTable<'_>, found: &mut Found) -> Setup {
    let top = Span { file: found.file, start: 0, end: 0 };
    let mut top = Table::new(table, top, say!("an io file"));
    let controller = top.table(found, "controller").map(|table| controller(table, found));
    let server = top.table(found, "server").map(|table| server::server(table, found)).unwrap_or_default();
    let rows = top.rows(found, "devices");
    let devices: Vec<Device> = rows.iter().filter_map(|row| device::read(row, found)).collect();
    server::encrypted(&server, &devices, found);
    device::one_line_each(&devices, found);
    device::one_address_each(&devices, found);
    let retain = controller.as_ref().and_then(|controller| controller.retain.as_ref());
    device::one_file_each(&devices, retain, found);
    let rows = top.rows(found, "inputs");
    let inputs = rows.iter().filter_map(|row| channel(row, true, found)).collect();
    let rows = top.rows(found, "outputs");
    let outputs = rows.iter().filter_map(|row| channel(row, false, found)).collect();
    let rows = top.rows(found, "shown");
    let shown = rows.iter().filter_map(|row| channel(row, false, found)).collect();
    let history = top.table(found, "history").and_then(|table| history::history(table, found));
    top.end(found);
    Setup { controller: controller.unwrap_or_default(), server, devices, inputs, outputs, shown, history }
}

fn controller(mut table: Table<'_>, found: &mut Found) -> Controller {
    let usual = Controller::default();
    let read = Controller {
        period: table.duration(found, "period", Nanos::MICROSECOND * 100, Nanos::MINUTE),
        watchdog: table.duration(found, "watchdog", Nanos::MILLISECOND, Nanos::HOUR),
        retain: table.text(found, "retain"),
        changed: table
            .word(
                found,
                "changed",
                &[("refuse", Changed::Refuse), ("cold", Changed::Cold), ("fit", Changed::Fit)],
            )
            .map_or(usual.changed, |c| c.value),
        run: table.word(found, "start", &[("run", true), ("stop", false)]).map_or(usual.run, |run| run.value),
        priority: table.whole(found, "priority", 1..=99),
        metrics: metrics(&mut table, found),
        log: server::log(&mut table, found),
    };
    table.end(found);
    read
}

fn metrics(table: &mut Table<'_>, found: &mut Found) -> Option<At<SocketAddr>> {
    let text = table.text(found, "metrics")?;
    match text.value.parse::<SocketAddr>() {
        Ok(address) if address.ip().is_loopback() => Some(At::new(address, text.at)),
        Ok(_) | Err(_) => {
            found.wrong(text.at, say!("`metrics` is an address of this machine alone, with a port")).help =
                Some(say!(
                    "write `metrics = \"127.0.0.1:9464\"`; from elsewhere, ask through an agent or a tunnel"
                ));
            None
        }
    }
}

/// A row of `[inputs]`, `[outputs]` or `[shown]`: a point, or a table with more.
fn channel(row: &Row<'_>, input: bool, found: &mut Found) -> Option<Channel> {
    let variable = At::new(row.name.to_owned(), row.at);
    if let Some(text) = row.value.as_str() {
        let (device, point) = point::read(text, row.value_at, found)?;
        let bad = At::new(Bad::Hold, row.at);
        let at = row.value_at;
        let (message, pin) = (Message::default(), Pin::default());
        return Some(Channel {
            variable,
            device,
            point,
            at,
            encoding: None,
            scale: None,
            offset: None,
            bad,
            message,
            pin,
            unit: None,
            limits: Limits::default(),
        });
    }
    let Some(table) = row.value.as_table() else {
        found.wrong(row.value_at, say!("`{}` is wired to a text or a table", row.name)).help =
            Some(say!("write `{} = \"device.point\"`", row.name));
        return None;
    };
    let mut table = Table::new(table, row.at, say!("the channel {}", Said::foreign(row.name)));
    let text = table.needed(found, "at", "device.point");
    let encoding = table.word(found, "as", Encoding::WORDS);
    let (scale, offset) = (table.number(found, "scale"), table.number(found, "offset"));
    let message = broker::message(&mut table, input, found);
    let pin = field::pin(&mut table, input, found);
    let unit = table.text(found, "unit");
    let limits = if input { panel::limits(&mut table, found) } else { Limits::default() };
    let bad = if input { table.value(found, "bad") } else { None };
    let bad = match bad {
        None => At::new(Bad::Hold, row.at),
        Some(bad) => At::new(substitute(bad.value, bad.at, found)?, bad.at),
    };
    if let Some(scale) = scale.as_ref().filter(|s| s.value == 0.0) {
        found.wrong(scale.at, say!("a scale is not 0"));
        return None;
    }
    table.end(found);
    let text = text?;
    let (device, point) = point::read(&text.value, text.at, found)?;
    Some(Channel {
        variable,
        device,
        point,
        at: text.at,
        encoding,
        scale,
        offset,
        bad,
        message,
        pin,
        unit,
        limits,
    })
}

/// Reads the policy for an input whose value is bad.
fn substitute(value: &DeValue<'_>, at: Span, found: &mut Found) -> Option<Bad> {
    if let Some(on) = value.as_bool() {
        return Some(Bad::Value(Literal::Bool(on)));
    }
    if let Some(number) = table::number(value) {
        return Some(Bad::Value(Literal::Number(number)));
    }
    match value.as_str() {
        Some("hold") => Some(Bad::Hold),
        Some("fault") => Some(Bad::Fault),
        _ => {
            found.wrong(at, say!("`bad` is \"hold\", \"fault\", or the value that the input takes"));
            None
        }
    }
}
