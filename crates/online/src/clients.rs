//! The devices of a machine, each made as its kind asks.

use crate::device::{Device, Failed};
use crate::modbus::Units;
use crate::mqtt;
use crate::panel::Panels;
use crate::setup::{self, Kind};
use crate::wiring::Wired;

/// Devices of kinds that a crate beside this one brings, because not each build has it.
pub trait Brought: Send {
    /// A device that is wired; `None` where its kind is another one.
    fn device(&self, wired: &Wired) -> Option<Box<dyn Device>>;

    /// The points of a device; `None` where its kind is another one.
    fn browse(&self, device: &setup::Device) -> Option<Result<Vec<Node>, Failed>>;
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
    /// The panels of the machine, for those who move them.
    pub panels: Panels,
}

impl Clients {
    /// With the kinds of a crate beside this one.
    pub fn with(mut self, brought: impl Brought + 'static) -> Clients {
        self.brought.push(Box::new(brought));
        self
    }

    /// A device that is wired.
    ///
    /// # Errors
    ///
    /// The system has no resources for it, or this build has no device of its kind.
    pub fn device(&mut self, wired: &Wired) -> std::io::Result<Box<dyn Device>> {
        match &wired.device.kind {
            Kind::Mqtt(broker) => Ok(mqtt::device(broker, wired)),
            Kind::Panel(panel) => Ok(self.panels.device(panel, wired)),
            Kind::ModbusTcp(..) | Kind::ModbusRtu(..) | Kind::ModbusServer(_) => self.units.device(wired),
            Kind::OpcUa(_) | Kind::OpcUaServer(_) => {
                let made = self.brought.iter().find_map(|brought| brought.device(wired));
                made.ok_or_else(|| std::io::ErrorKind::Unsupported.into())
            }
        }
    }

    /// The points of a device, where it can tell them.
    ///
    /// # Errors
    ///
    /// It cannot be reached, or does not answer.
    pub fn browse(&self, device: &setup::Device) -> Option<Result<Vec<Node>, Failed>> {
        self.brought.iter().find_map(|brought| brought.browse(device))
    }
}
