//! The kinds of devices that not each build has: those of crates that a feature of this one brings; and who may
//! log in to the servers among them.

use std::net::SocketAddr;
use std::path::Path;

use g7_online::setup::{Kind, OpcUaServer};
use g7_online::{Clients, Wiring};

use g7_model::{Said, say};

use crate::failure::{Failure, raw, unlogged};

/// The clients and servers of a machine, with all kinds of this build. Nobody logs in to them.
pub(crate) fn clients() -> Clients {
    let clients = Clients::default();
    #[cfg(feature = "opcua")]
    let clients = clients.with(g7_opcua::OpcUa::default());
    clients
}

/// The same for a controller: the servers of the wiring have the users of this file. `logged` where deeds are
/// written down.
pub(crate) fn serving(wiring: &Wiring, users: Option<&Path>, logged: bool) -> Result<Clients, Failure> {
    let servers: Vec<(&str, &OpcUaServer)> = wiring
        .devices
        .iter()
        .filter_map(|wired| match &wired.device.kind {
            Kind::OpcUaServer(server) => Some((wired.device.name.value.as_str(), &**server)),
            _ => None,
        })
        .collect();
    for (name, server) in &servers {
        let at = server.address;
        reachable(at, users.is_some(), logged).map_err(|why| Failure::Usage(say!("{}: {why}", raw(name))))?;
        if users.is_none() && server.anonymous == Some(false) {
            let what = say!("nobody can come in: clients without a user are refused, and there are no users");
            return Err(Failure::Usage(say!("{}: {what}; {}", raw(name), users_way())));
        }
    }
    if servers.is_empty() { Ok(clients()) } else { known(users) }
}

/// The way out for who lacks users.
fn users_way() -> Said {
    say!("name their file as `users` in [server] of the io file, and add them by `g7 users`")
}

#[cfg(feature = "opcua")]
fn known(users: Option<&Path>) -> Result<Clients, Failure> {
    use g7_store::users::Users;
    let open = |path: &Path| {
        let failed =
            |e| Failure::Usage(say!("cannot use {} as the users: {e}", raw(path.display()), e = raw(&e)));
        Users::open(path).map(std::sync::Arc::new).map_err(failed)
    };
    Ok(Clients::default().with(g7_opcua::OpcUa { users: users.map(open).transpose()? }))
}

#[cfg(not(feature = "opcua"))]
fn known(_: Option<&Path>) -> Result<Clients, Failure> {
    Ok(clients())
}

/// Refuses what would let strangers in, as the page does.
fn reachable(at: SocketAddr, users: bool, logged: bool) -> Result<(), Said> {
    if at.ip().is_loopback() {
        return Ok(());
    }
    if !users {
        let what = say!("{} is reached from other machines, and there are no users", raw(at));
        return Err(say!("{what}: {}, or listen at 127.0.0.1", users_way()));
    }
    if !logged {
        return Err(unlogged(&at));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_machines_need_users_and_a_log() {
        for (at, users, logged, way) in [
            ("127.0.0.1:4840", false, false, None),
            ("[::1]:4840", false, false, None),
            ("0.0.0.0:4840", false, true, Some("g7 users")),
            ("10.0.0.7:4840", true, false, Some("`log`")),
            ("10.0.0.7:4840", true, true, None),
        ] {
            let found = reachable(at.parse().expect("an address"), users, logged);
            match way {
                None => assert_eq!(found, Ok(()), "{at}"),
                Some(way) => assert!(found.as_ref().is_err_and(|why| why.contains(way)), "{at}: {found:?}"),
            }
        }
    }
}
