//! The needs of a person at a controller: the log in `[controller]`, and `[server]`, which says who may use the
//! page of the operator and from where.

use std::net::IpAddr;

use g7_model::{Nanos, say};

use super::device::{Device, Kind};
use super::table::{At, Found, Table};

/// The log of events and deeds.
#[derive(Clone, Debug)]
pub struct LogFile {
    /// The file, beside the io file.
    pub file: At<String>,
    /// Rows that are older go, in days.
    pub days: Option<u64>,
    /// The size beyond which the oldest rows go, in MiB.
    pub mib: Option<u64>,
}

/// Who may use the page, and from where: the table `[server]`. Files are beside the io file.
#[derive(Clone, Debug, Default)]
pub struct Server {
    /// The address to listen at; without it this machine alone.
    pub host: Option<At<IpAddr>>,
    /// The port.
    pub port: Option<At<i64>>,
    /// The file of the users.
    pub users: Option<At<String>>,
    /// The file with the certificate and those above it (PEM).
    pub cert: Option<At<String>>,
    /// The file with its private key (PEM).
    pub key: Option<At<String>>,
    /// A session that nobody uses ends after this time.
    pub idle: Option<At<Nanos>>,
    /// Each session ends after this time.
    pub session: Option<At<Nanos>>,
}

pub(super) fn server(mut table: Table<'_>, found: &mut Found) -> Server {
    let read = Server {
        host: host(&mut table, found),
        port: table.whole(found, "port", 0..=65_535),
        users: table.text(found, "users"),
        cert: table.text(found, "cert"),
        key: table.text(found, "key"),
        idle: table.duration(found, "idle", Nanos::MINUTE, Nanos::HOUR * 24 * 30),
        session: table.duration(found, "session", Nanos::MINUTE, Nanos::HOUR * 24 * 365),
    };
    match (&read.cert, &read.key) {
        (Some(only), None) => {
            found.wrong(only.at, say!("[server] has a `cert` and no `key`")).help =
                Some(say!("name the file with its private key as `key`"));
        }
        (None, Some(only)) => {
            found.wrong(only.at, say!("[server] has a `key` and no `cert`")).help =
                Some(say!("name the file with its certificate as `cert`"));
        }
        (Some(_), Some(_)) | (None, None) => {}
    }
    table.end(found);
    read
}

/// Passwords for the page need a certificate; a server of OPC UA has one of its own.
pub(super) fn encrypted(server: &Server, devices: &[Device], found: &mut Found) {
    let elsewhere = devices.iter().any(|device| matches!(device.kind, Kind::OpcUaServer(_)));
    if let (Some(users), None, false) = (&server.users, &server.cert, elsewhere) {
        found
            .wrong(users.at, say!("passwords go over encrypted connections alone, and there is no `cert`"))
            .help = Some(say!("`g7 cert` makes a certificate and its key; name them as `cert` and `key`"));
    }
}

fn host(table: &mut Table<'_>, found: &mut Found) -> Option<At<IpAddr>> {
    let text = table.text(found, "host")?;
    match text.value.parse() {
        Ok(address) => Some(At::new(address, text.at)),
        Err(_) => {
            found.wrong(text.at, say!("`host` is an address of this machine, such as \"127.0.0.1\"")).help =
                Some(say!("\"0.0.0.0\" means each address of it"));
            None
        }
    }
}

pub(super) fn log(table: &mut Table<'_>, found: &mut Found) -> Option<LogFile> {
    let file = table.text(found, "log");
    let days = table.whole(found, "log-days", 1..=36_500);
    let mib = table.whole(found, "log-mib", 1..=100_000);
    match file {
        Some(file) => {
            let whole = |n: Option<At<i64>>| n.and_then(|n| u64::try_from(n.value).ok());
            Some(LogFile { file, days: whole(days), mib: whole(mib) })
        }
        None => {
            if let Some(only) = days.or(mib) {
                found.wrong(only.at, say!("there is no `log` to be kept so long")).help =
                    Some(say!("name its file: `log = \"machine.log\"`"));
            }
            None
        }
    }
}
