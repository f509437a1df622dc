//! The devices of a machine, each made as its kind asks.

use std::collections::BTreeMap;

use crate::device::Device;
use crate::mail::Mail;
use crate::modbus::Units;
use crate::mqtt;
use crate::setup::Kind;
use crate::wiring::Wired;

/// The clients and servers of a machine. Slaves on one serial line share it.
#[derive(Default)]
pub struct Clients {
    pub(crate) units: Units,
    mail: BTreeMap<String, Mail>,
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
            Kind::ModbusTcp(..) | Kind::ModbusRtu(..) | Kind::ModbusServer(_) => self.units.device(wired),
        }
    }
}
