//! The devices of a machine, each made as its kind asks.

use crate::device::Device;
use crate::modbus::Units;
use crate::mqtt;
use crate::panel::Panels;
use crate::setup::Kind;
use crate::wiring::Wired;

/// The clients and servers of a machine. Slaves on one serial line share it.
#[derive(Default)]
pub struct Clients {
    pub(crate) units: Units,
    /// The panels of the machine, for those who move them.
    pub panels: Panels,
}

impl Clients {
    /// A device that is wired.
    ///
    /// # Errors
    ///
    /// The system has no resources for it.
    pub fn device(&mut self, wired: &Wired) -> std::io::Result<Box<dyn Device>> {
        match &wired.device.kind {
            Kind::Mqtt(broker) => Ok(mqtt::device(broker, wired)),
            Kind::Panel(panel) => Ok(self.panels.device(panel, wired)),
            Kind::ModbusTcp(..) | Kind::ModbusRtu(..) | Kind::ModbusServer(_) => self.units.device(wired),
        }
    }
}
