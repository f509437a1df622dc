//! OPC UA for charts on line: servers that G7 is a client of, and the server of its own (decision 37).
//!
//! # Where this sits
//!
//! ```text
//!   setup: the rows of the io file -> wiring: Wire::Node, Wire::Shown -> here: Client, Server
//!                                                                          |
//!                                        driver <- Device::exchange -> async-opcua, on a thread of its own
//! ```
//!
//! The library has many libraries below it and is under the MPL-2.0, so it is kept in this crate, and
//! `g7` has the crate by its feature `opcua` alone.
//!
//! # Invariants
//!
//! An unknown certificate is never trusted. Work of the library runs in tasks: a panic there is a lost
//! connection, and the scan goes on. A value that its node or variable cannot hold is refused with both types.
#![forbid(unsafe_code)]

mod browse;
mod certificates;
mod client;
mod guard;
mod nodes;
mod server;
mod session;
mod time;
mod values;

use std::sync::Arc;

use g7_online::setup::{self, Kind};
use g7_online::{Brought, Device, Failed, Node, Wired};
use g7_store::users::Users;

use time::duration;

/// The kinds `opc-ua` and `opc-ua-server`.
#[derive(Clone, Debug, Default)]
pub struct OpcUa {
    /// Those who may log in to a server of our own; without them everybody on this machine may use it.
    pub users: Option<Arc<Users>>,
}

impl Brought for OpcUa {
    fn device(&self, wired: &Wired) -> Option<Box<dyn Device>> {
        match &wired.device.kind {
            Kind::OpcUa(server) => Some(Box::new(client::Client::new(server, wired))),
            Kind::OpcUaServer(row) => Some(Box::new(server::Server::new(row, wired, self.users.clone()))),
            _ => None,
        }
    }

    fn browse(&self, device: &setup::Device) -> Option<Result<Vec<Node>, Failed>> {
        match &device.kind {
            Kind::OpcUa(server) => Some(browse::browse(server, duration(device.timing.timeout))),
            _ => None,
        }
    }
}
