//! The devices of a machine, each made as its kind asks.

use std::collections::BTreeMap;

use g7_model::{Problem, Said, codes, say};

use crate::device::{Device, Failed};
use crate::mail::Mail;
use crate::modbus::Units;
use crate::mqtt;
use crate::panel::Panels;
use crate::setup::{Device as Wanted, Kind, Setup};
use crate::wired::Wired;

/// Devices of kinds that a crate beside this one brings, because not each build has it.
pub trait Brought: Send {
    /// A device that is wired; `None` where its kind is another one.
    fn device(&self, wired: &Wired) -> Option<Box<dyn Device>>;

    /// The points of a device; `None` where its kind is another one.
    fn browse(&self, device: &Wanted) -> Option<Result<Vec<Node>, Failed>>;
}

/// A point that a device tells of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// The point, as the io file writes it.
    pub point: String,
    /// Its name.
    pub name: String,
    /// The number of nodes above it.
    pub depth: usize,
    /// True if it has a value.
    pub value: bool,
}

/// The clients and servers of a machine. Slaves on one serial line share it.
#[derive(Default)]
pub struct Clients {
    pub(crate) units: Units,
    brought: Vec<Box<dyn Brought>>,
    mail: BTreeMap<String, Mail>,
    /// The panels of the machine, for those who move them.
    pub panels: Panels,
}

impl Clients {
    /// With the kinds of a crate beside this one.
    pub fn with(mut self, brought: impl Brought + 'static) -> Clients {
        self.brought.push(Box::new(brought));
        self
    }

    /// The broker of this name gets events; they come through the result.
    pub fn mail(&mut self, broker: &str) -> Mail {
        self.mail.entry(broker.to_owned()).or_default().clone()
    }

    /// A device that is wired.
    ///
    /// # Errors
    ///
    /// The system has no resources for it, or this build has no device of its kind.
    pub fn device(&mut self, wired: &Wired) -> std::io::Result<Box<dyn Device>> {
        match &wired.device.kind {
            Kind::Mqtt(broker) => {
                Ok(mqtt::device(broker, wired, self.mail.get(&wired.device.name.value).cloned()))
            }
            Kind::Panel(panel) => Ok(self.panels.device(panel, wired)),
            Kind::ModbusTcp(..) | Kind::ModbusRtu(..) | Kind::ModbusServer(_) => self.units.device(wired),
            Kind::OpcUa(_) | Kind::OpcUaServer(_) => {
                let made = self.brought.iter().find_map(|brought| brought.device(wired));
                made.ok_or_else(|| no_kind(&wired.device.kind))
            }
            Kind::S7(_) | Kind::Gpio(_) => field(&wired.device.kind, wired, false),
        }
    }

    /// The points of a device, where it can tell them.
    ///
    /// # Errors
    ///
    /// It cannot be reached, or does not answer.
    pub fn browse(&self, device: &Wanted) -> Option<Result<Vec<Node>, Failed>> {
        self.brought.iter().find_map(|brought| brought.browse(device))
    }
}

impl Clients {
    /// A device that is only looked at: nothing of it changes by that.
    pub(crate) fn looker(&mut self, wired: &Wired) -> std::io::Result<Box<dyn Device>> {
        match &wired.device.kind {
            kind @ Kind::Gpio(_) => field(kind, wired, true),
            _ => self.device(wired),
        }
    }
}

/// The kinds that not every build has, each with the feature that brings it.
const OPTIONAL: [(&str, &str, bool); 4] = [
    ("s7", "s7", cfg!(feature = "s7")),
    ("gpio", "gpio", cfg!(all(feature = "gpio", target_os = "linux"))),
    ("opc-ua", "opcua", cfg!(feature = "opcua")),
    ("opc-ua-server", "opcua", cfg!(feature = "opcua")),
];

/// The feature that brings devices of the kind with this word, where this build lacks it.
fn lacks(word: &str) -> Option<&'static str> {
    OPTIONAL.iter().find(|(kind, _, there)| *kind == word && !there).map(|(_, feature, _)| *feature)
}

/// True if this build has devices of the kind with this word.
pub fn has(word: &str) -> bool {
    lacks(word).is_none()
}

/// The problems of devices of a kind that this build does not have.
pub fn lacking(setup: &Setup) -> Vec<Problem> {
    let wrong = |device: &Wanted| {
        let word = device.kind.word();
        let feature = lacks(word)?;
        let what = say!("this build of G7 has no devices of the kind \"{}\"", Said::foreign(word));
        let mut problem = Problem::new(&codes::BAD_WIRING, device.name.at, what);
        problem.help = Some(match word {
            "gpio" => say!("build it with `cargo install --path crates/g7 --features {feature}`, for Linux"),
            _ => say!("build it with `cargo install --path crates/g7 --features {feature}`"),
        });
        Some(problem)
    };
    setup.devices.iter().filter_map(wrong).collect()
}

/// A device of a kind that not every build has; `looks` for one that only reads and changes nothing.
pub(crate) fn field(kind: &Kind, wired: &Wired, looks: bool) -> std::io::Result<Box<dyn Device>> {
    // Where a build lacks both, nothing is asked for.
    let _ = (wired, looks);
    match kind {
        #[cfg(feature = "s7")]
        Kind::S7(s7) => Ok(crate::s7::device(s7, wired)),
        #[cfg(all(feature = "gpio", target_os = "linux"))]
        Kind::Gpio(chip) if looks => Ok(crate::gpio::look(chip, wired)),
        #[cfg(all(feature = "gpio", target_os = "linux"))]
        Kind::Gpio(chip) => Ok(crate::gpio::device(chip, wired)),
        other => Err(no_kind(other)),
    }
}

fn no_kind(kind: &Kind) -> std::io::Error {
    std::io::Error::other(format!("this build has no kind \"{}\"", kind.word()))
}
