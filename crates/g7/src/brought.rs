//! The kinds of devices that not each build has: those of crates that a feature of this one brings.

use g7_online::Clients;

/// The clients and servers of a machine, with all kinds of this build.
pub(crate) fn clients() -> Clients {
    let clients = Clients::default();
    #[cfg(feature = "opcua")]
    let clients = clients.with(g7_opcua::OpcUa);
    clients
}
