//! Who may use a server and from where, held against each other before anything listens.
//!
//! Users need TLS, since their passwords go over the network. Other machines need both, and beside a
//! controller a log of what people do.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use g7_online::setup::Server;

use g7_model::say;

use super::access::{Access, Lasts};
use super::args::Serve;
use super::guard::{Foreign, Guard, Pass};
use super::listen::Door;
use super::shared::Limits;
use super::tls::{Certificate, Files};
use super::tokens::Tokens;
use crate::audit::Audit;
use crate::failure::{Failure, raw, unlogged};

/// The rules of a server from its start on.
#[derive(Clone, Debug)]
pub(super) struct Rules {
    pub(super) host: IpAddr,
    pub(super) port: Option<u16>,
    pub(super) certificate: Option<Arc<Certificate>>,
    pub(super) access: Option<Arc<Access>>,
    pub(super) audit: Audit,
    /// The file of the log.
    pub(super) log: Option<PathBuf>,
    foreign: Foreign,
    /// The pages that may show this one in a frame.
    framed: Option<String>,
}

/// A file that the arguments name, or the io file beside itself.
fn file(argument: Option<&PathBuf>, setting: Option<&String>, io: Option<&Path>) -> Option<PathBuf> {
    let beside = || Some(io?.with_file_name(setting?));
    argument.cloned().or_else(beside)
}

impl Rules {
    /// Puts the arguments and the io file of a controller together.
    pub(super) fn of(
        args: &Serve,
        controller: Option<(&Server, &Path)>,
        audit: &Audit,
        log: Option<PathBuf>,
    ) -> Result<Rules, Failure> {
        let (set, io) = controller.unzip();
        let text = |of: fn(&Server) -> Option<&String>| set.and_then(of);
        let host = args.host.or(set.and_then(|s| s.host.as_ref()).map(|host| host.value));
        let host = host.unwrap_or(Ipv4Addr::LOCALHOST.into());
        let port = set.and_then(|s| s.port.as_ref()).and_then(|port| u16::try_from(port.value).ok());
        let port = args.port.or(port);
        let users = file(args.users.as_ref(), text(|s| s.users.as_ref().map(|at| &at.value)), io);
        let cert = file(args.cert.as_ref(), text(|s| s.cert.as_ref().map(|at| &at.value)), io);
        let key = file(args.key.as_ref(), text(|s| s.key.as_ref().map(|at| &at.value)), io);
        let files = cert.zip(key).map(|(cert, key)| Files { cert, key });
        reachable(host, files.is_some(), users.is_some())?;
        if controller.is_some() && !host.is_loopback() && !audit.is_kept() {
            return Err(Failure::Usage(unlogged(&host)));
        }
        let certificate = files.map(Certificate::open).transpose()?;
        let time = |of: fn(&Server) -> Option<g7_model::Nanos>| set.and_then(of);
        let idle = time(|s| s.idle.as_ref().map(|at| at.value));
        let whole = time(|s| s.session.as_ref().map(|at| at.value));
        let open = |path: PathBuf| Access::open(&path, Lasts::of(idle, whole), audit.clone()).map(Arc::new);
        let access = users.map(open).transpose()?;
        let framed = args.framed.as_deref().map(frames).transpose()?;
        let (audit, foreign) = (audit.clone(), Foreign::default());
        Ok(Rules { host, port, certificate, access, audit, log, foreign, framed })
    }

    /// The guard that judges requests.
    pub(super) fn guard(&self, pass: Pass, guests: Option<Arc<Tokens>>, bound: SocketAddr) -> Guard {
        let certificate = self.certificate.clone();
        let (audit, foreign, framed) = (self.audit.clone(), self.foreign.clone(), self.framed.clone());
        Guard { pass, guests, bound, certificate, audit, foreign, framed }
    }

    /// The door that lets connections in.
    pub(super) fn door(&self) -> Result<Door, Failure> {
        let tls = self.certificate.as_ref().map(Certificate::acceptor).transpose()?;
        Ok(match self.host.is_loopback() {
            true => Door { tls, ..Door::default() },
            false => Door::for_others(tls),
        })
    }

    pub(super) fn limits(&self, limits: Limits) -> Limits {
        if self.host.is_loopback() { limits } else { limits.for_others() }
    }

    /// Looks at the files of the users and of the certificate, and tells what was refused meanwhile.
    pub(super) fn look(&self) {
        if let Some(access) = &self.access {
            access.look();
        }
        if let Some(certificate) = &self.certificate {
            certificate.look();
        }
        self.foreign.tell(&self.audit);
    }
}

/// The pages that VS Code puts round a panel, on a desktop and in a browser; no site can have such an address.
const EDITORS: &str = "'self' vscode-webview: vscode-file: https://*.vscode-cdn.net";

/// The pages that may show this one: those of VS Code, and the page of one in the browser at an address.
fn frames(address: &str) -> Result<String, Failure> {
    if address.is_empty() {
        return Ok(EDITORS.to_owned());
    }
    let host = ["http://", "https://"].iter().find_map(|scheme| address.strip_prefix(scheme));
    let signs = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | ':' | '[' | ']');
    match host {
        Some(host) if !host.is_empty() && host.chars().all(signs) => Ok(format!("{EDITORS} {address}")),
        _ => Err(Failure::Usage(say!(
            "`{address}` is no address of a page without a path, such as http://127.0.0.1:8080"
        ))),
    }
}

/// Refuses what would let strangers in, or send passwords in plain text.
fn reachable(host: IpAddr, encrypted: bool, users: bool) -> Result<(), Failure> {
    let what = match (host.is_loopback(), encrypted, users) {
        (true, _, false) | (_, true, true) => return Ok(()),
        (true, false, true) => say!("users log in over encrypted connections alone"),
        (false, false, true) => {
            say!("{} is reached from other machines, and nothing is encrypted", raw(host))
        }
        (false, true, false) => say!("{} is reached from other machines, and there are no users", raw(host)),
        (false, false, false) => {
            say!("{} is reached from other machines, without encryption and without users", raw(host))
        }
    };
    let way = match (encrypted, users) {
        (false, false) => {
            say!("`g7 cert` makes a certificate for --cert and --key, --users names the file of the users")
        }
        (false, true) => say!("`g7 cert` makes a certificate for --cert and --key"),
        (true, _) => say!("--users names the file of the users"),
    };
    Err(Failure::Usage(match host.is_loopback() {
        true => say!("{what}: {way}"),
        false => say!("{what}: {way}; or stay at 127.0.0.1 and come by `ssh -L`"),
    }))
}
