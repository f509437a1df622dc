//! The devices of a machine, each made as its kind asks.

use std::collections::BTreeMap;

use g7_model::{Problem, codes};

use crate::device::Device;
use crate::mail::Mail;
use crate::modbus::Units;
use crate::mqtt;
use crate::panel::Panels;
use crate::setup::{Device as Wanted, Kind, Setup};
use crate::wiring::Wired;

/// The clients and servers of a machine. Slaves on one serial line share it.
#[derive(Default)]
pub struct Clients {
    pub(crate) units: Units,
    mail: BTreeMap<String, Mail>,
    /// The panels of the machine, for those who move them.
    pub panels: Panels,
}

impl Clients {
    /// The broker of this name gets events; they come through the result.
    pub fn mail(&mut self, broker: &str) -> Mail {
        self.mail.entry(broker.to_owned()).or_default().clone()
    }

    /// A device that is wired.
    ///
    /// # Errors
    ///
    /// The system has no resources for it.
    pub fn device(&mut self, wired: &Wired) -> std::io::Result<Box<dyn Device>> {
        match &wired.device.kind {
            Kind::Mqtt(broker) => {
                Ok(mqtt::device(broker, wired, self.mail.get(&wired.device.name.value).cloned()))
            }
            Kind::Panel(panel) => Ok(self.panels.device(panel, wired)),
            Kind::ModbusTcp(..) | Kind::ModbusRtu(..) | Kind::ModbusServer(_) => self.units.device(wired),
            Kind::S7(_) | Kind::Gpio(_) => field(&wired.device.kind, wired, false),
        }
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

/// The kinds that not every build has.
const OPTIONAL: [(&str, bool); 2] =
    [("s7", cfg!(feature = "s7")), ("gpio", cfg!(all(feature = "gpio", target_os = "linux")))];

/// True if this build has devices of the kind with this word.
pub fn has(word: &str) -> bool {
    !OPTIONAL.iter().any(|(kind, there)| *kind == word && !there)
}

/// The problems of devices of a kind that this build does not have.
pub fn lacking(setup: &Setup) -> Vec<Problem> {
    let wrong = |device: &Wanted| {
        let word = device.kind.word();
        let what = format!("this build of G7 has no devices of the kind \"{word}\"");
        let mut problem = Problem::new(&codes::BAD_WIRING, device.name.at, what);
        let linux = if word == "gpio" { ", for Linux" } else { "" };
        problem.help =
            Some(format!("build it with `cargo install --path crates/g7 --features {word}`{linux}"));
        problem
    };
    setup.devices.iter().filter(|device| !has(device.kind.word())).map(wrong).collect()
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
        other => Err(std::io::Error::other(format!("this build has no kind \"{}\"", other.word()))),
    }
}
