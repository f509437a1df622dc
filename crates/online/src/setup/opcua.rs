//! The rows of OPC UA servers, and of an OPC UA server of our own.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use g7_model::{Nanos, Said, say};

use super::secret::{self, Held};
use super::table::{Found, Table};

/// A server of OPC UA, which this is a client of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpcUa {
    /// Its address: `opc.tcp://10.0.0.7:4840/path`.
    pub url: String,
    /// The security of the connection.
    pub security: Security,
    /// The algorithms of signature and encryption.
    pub policy: Policy,
    /// The user that it knows this machine by, with the password.
    pub user: Option<(String, Held)>,
    /// The folder of the certificates: `own`, `trusted` and `rejected`.
    pub certificates: PathBuf,
    /// The time between two messages of the server with changed values.
    pub interval: Nanos,
    /// Without a change the server gives a sign of life after this time.
    pub keep_alive: Nanos,
    /// True if a value that the server calls uncertain counts as good.
    pub uncertain_is_good: bool,
}

/// An OPC UA server of our own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpcUaServer {
    /// The address and port that it listens at.
    pub address: SocketAddr,
    /// The least security of a connection; whatever is more is offered as well.
    pub security: Security,
    /// The rule of the file for clients without a user: true if they may read, false if they are refused.
    pub anonymous: Option<bool>,
    /// The folder of the certificates: `own`, `trusted` and `rejected`.
    pub certificates: PathBuf,
    /// True if all variables and steps are shown, not only those of `[shown]`.
    pub all: bool,
    /// A client without a request for so long is gone.
    pub silence: Nanos,
}

/// How messages are secured (OPC 10000-4, 7.20).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Security {
    /// Not at all.
    None,
    /// Signed: nobody can change them.
    Sign,
    /// Signed and encrypted: nobody can read them either.
    SignAndEncrypt,
}

impl Security {
    /// The words of the file.
    pub const WORDS: &'static [(&'static str, Security)] =
        &[("none", Security::None), ("sign", Security::Sign), ("sign-and-encrypt", Security::SignAndEncrypt)];
}

/// The algorithms of signature and encryption (OPC 10000-7); those that are broken are not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Policy {
    /// The one that each server has.
    Basic256Sha256,
    /// AES-128 with RSA-OAEP.
    Aes128Sha256RsaOaep,
    /// AES-256 with RSA-PSS.
    Aes256Sha256RsaPss,
}

impl Policy {
    /// The words of the file.
    pub const WORDS: &'static [(&'static str, Policy)] = &[
        ("Basic256Sha256", Policy::Basic256Sha256),
        ("Aes128-Sha256-RsaOaep", Policy::Aes128Sha256RsaOaep),
        ("Aes256-Sha256-RsaPss", Policy::Aes256Sha256RsaPss),
    ];
}

/// The folder of certificates without a setting: that of all clients. A server has one of its own, because
/// its certificate has its address.
const CERTIFICATES: &str = "opcua-certificates";

impl OpcUa {
    /// The password that its row names.
    pub(super) fn password(&mut self) -> Option<&mut Held> {
        self.user.as_mut().map(|(_, password)| password)
    }

    /// Its folder, from the folder of the io file.
    pub(super) fn settle(&mut self, folder: &Path) {
        self.certificates = folder.join(&self.certificates);
    }
}

impl OpcUaServer {
    /// Its folder, from the folder of the io file.
    pub(super) fn settle(&mut self, folder: &Path) {
        self.certificates = folder.join(&self.certificates);
    }
}

/// Reads the row of a server that this is a client of.
pub(super) fn client(table: &mut Table<'_>, found: &mut Found) -> Option<OpcUa> {
    let security = table.word(found, "security", Security::WORDS);
    let policy = table.word(found, "policy", Policy::WORDS);
    if let (Some(policy), Some(Security::None)) = (&policy, security.as_ref().map(|s| s.value)) {
        found.wrong(policy.at, say!("without security there is no policy"));
    }
    let user = user(table, found);
    let certificates = certificates(table, found, CERTIFICATES.to_owned());
    let interval = table.duration(found, "interval", Nanos::from_millis(10), Nanos::MINUTE);
    let interval = interval.map_or(Nanos::from_millis(100), |i| i.value);
    let keep_alive = table.duration(found, "keep-alive", Nanos::from_millis(100), Nanos::HOUR);
    let uncertain = table.word(found, "uncertain", &[("bad", false), ("good", true)]);
    let url = table.needed(found, "url", "opc.tcp://10.0.0.7:4840")?;
    if let Err(why) = address(&url.value) {
        found.wrong(url.at, why).help = Some(say!("write `url = \"opc.tcp://10.0.0.7:4840\"`"));
        return None;
    }
    Some(OpcUa {
        url: url.value,
        security: security.map_or(Security::SignAndEncrypt, |s| s.value),
        policy: policy.map_or(Policy::Basic256Sha256, |p| p.value),
        user,
        certificates,
        interval,
        keep_alive: keep_alive.map_or(Nanos::SECOND, |k| k.value).max(interval),
        uncertain_is_good: uncertain.is_some_and(|u| u.value),
    })
}

/// A user who has a password, or none.
fn user(table: &mut Table<'_>, found: &mut Found) -> Option<(String, Held)> {
    let user = table.text(found, "user");
    let password = secret::password(table, found);
    match (&user, &password) {
        (None, Some(password)) => {
            found.wrong(password.from.at, say!("a password without a `user`")).help =
                Some(say!("name the `user` that the server knows"));
        }
        (Some(user), None) => {
            found.wrong(user.at, say!("a user without a password")).help =
                Some(say!("name its file: `password-file = \"line1.password\"`"));
        }
        (None, None) | (Some(_), Some(_)) => {}
    }
    user.map(|user| user.value).zip(password)
}

/// Refuses what is no address of OPC UA over TCP (OPC 10000-6, 7.2).
fn address(url: &str) -> Result<(), Said> {
    let rest =
        url.strip_prefix("opc.tcp://").ok_or_else(|| say!("`{url}` does not begin with `opc.tcp://`"))?;
    let host = rest.split('/').next().unwrap_or("");
    let (name, port) = match host.rsplit_once(':') {
        Some((name, port)) if !port.contains(']') => (name, Some(port)),
        _ => (host, None),
    };
    if name.is_empty() || url.contains(char::is_whitespace) {
        return Err(say!("`{url}` has no name of a host"));
    }
    match port.map(str::parse::<u16>) {
        None => Ok(()),
        Some(Ok(port)) if port > 0 => Ok(()),
        Some(_) => Err(say!("the port of `{url}` is no number from 1 to 65535")),
    }
}

fn certificates(table: &mut Table<'_>, found: &mut Found, usual: String) -> PathBuf {
    let folder = table.text(found, "certificates").map(|folder| folder.value);
    PathBuf::from(folder.unwrap_or(usual))
}

/// Reads the row of a server of our own, which has this name.
pub(super) fn server(name: &str, table: &mut Table<'_>, found: &mut Found) -> Option<OpcUaServer> {
    let address = table.needed(found, "listen", "127.0.0.1:4840");
    let security = table.word(found, "security", Security::WORDS);
    let anonymous = table.word(found, "anonymous", &[("refuse", false), ("read", true)]);
    let certificates = certificates(table, found, format!("opcua-{name}"));
    let all = table.word(found, "expose", &[("shown", false), ("all", true)]);
    let silence = table.duration(found, "silence", Nanos::SECOND, Nanos::HOUR);
    let address = address?;
    let Ok(parsed) = address.value.parse::<SocketAddr>() else {
        found.wrong(address.at, say!("`listen` is an address of this machine with a port")).help =
            Some(say!("write `listen = \"127.0.0.1:4840\"`, or \"0.0.0.0:4840\" for all of its addresses"));
        return None;
    };
    let server = OpcUaServer {
        address: parsed,
        security: security.as_ref().map_or(Security::SignAndEncrypt, |s| s.value),
        anonymous: anonymous.map(|a| a.value),
        certificates,
        all: all.is_some_and(|all| all.value),
        silence: silence.map_or(Nanos::SECOND * 30, |s| s.value),
    };
    let others = !parsed.ip().is_loopback();
    if let Some(none) = security.filter(|s| others && s.value == Security::None) {
        let what = say!("without security whoever reaches this address reads along and writes");
        found.wrong(none.at, what).help = Some(say!("leave `security` out, or listen at 127.0.0.1"));
        return None;
    }
    Some(server)
}

/// A node of a server (OPC 10000-6, 5.3.1.10).
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct NodeId {
    /// The namespace.
    pub namespace: Namespace,
    /// The identifier with its kind: `s=Tank.Level`, `i=85`, `g=…`, `b=…`.
    pub identifier: String,
}

/// A namespace of a server.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Namespace {
    /// Its number, which may be another one when the server starts again.
    Index(u16),
    /// Its name.
    Uri(String),
}

impl std::fmt::Display for NodeId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.namespace {
            Namespace::Index(0) => f.write_str(&self.identifier),
            Namespace::Index(index) => write!(f, "ns={index};{}", self.identifier),
            Namespace::Uri(uri) => write!(f, "nsu={uri};{}", self.identifier),
        }
    }
}

/// Reads `ns=2;s=Tank.Level`, `nsu=urn:tanks;s=Level` or `i=2258`.
///
/// # Errors
///
/// A sentence that says what is wrong with it.
pub fn read_node(text: &str) -> Result<NodeId, Said> {
    let wrong = |why: Said| Err(say!("`{text}` is no node: {why}"));
    let (namespace, identifier) = if let Some(rest) = text.strip_prefix("ns=") {
        let Some((index, rest)) = rest.split_once(';') else {
            return wrong(say!("`;` follows the namespace"));
        };
        match index.parse() {
            Ok(index) => (Namespace::Index(index), rest),
            Err(_) => return wrong(say!("`ns=` is a number from 0 to 65535; a name begins with `nsu=`")),
        }
    } else if let Some(rest) = text.strip_prefix("nsu=") {
        match rest.split_once(';') {
            Some((uri, rest)) if !uri.is_empty() => (Namespace::Uri(uri.to_owned()), rest),
            _ => return wrong(say!("a name and `;` follow `nsu=`")),
        }
    } else {
        (Namespace::Index(0), text)
    };
    let fits = match identifier.split_once('=') {
        Some(("i", number)) => is_number(number),
        Some(("s", name)) => !name.is_empty() && name.len() <= 4096 && !name.contains(['\n', '\r']),
        Some(("g", guid)) => is_guid(guid),
        Some(("b", bytes)) => is_base64(bytes),
        _ => {
            return wrong(say!(
                "it has a number (`i=85`), a name (`s=Tank`), a GUID (`g=`) or base64 (`b=`)"
            ));
        }
    };
    if !fits {
        return wrong(say!("`{identifier}` has not the form that its letter asks for"));
    }
    Ok(NodeId { namespace, identifier: identifier.to_owned() })
}

fn is_number(text: &str) -> bool {
    text.bytes().all(|b| b.is_ascii_digit()) && text.parse::<u32>().is_ok()
}

fn is_guid(text: &str) -> bool {
    let parts: Vec<&str> = text.split('-').collect();
    parts.iter().map(|part| part.len()).eq([8, 4, 4, 4, 12])
        && parts.iter().all(|part| part.bytes().all(|b| b.is_ascii_hexdigit()))
}

fn is_base64(text: &str) -> bool {
    let plain = text.trim_end_matches('=');
    let padding = text.len() - plain.len();
    !plain.is_empty()
        && text.len().is_multiple_of(4)
        && padding <= 2
        && plain.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'/'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_have_the_forms_of_the_standard() {
        for fine in [
            "i=2258",
            "ns=2;s=Tank.Level",
            "ns=2;s=a;b=c(d)",
            "nsu=urn:tanks:1;s=Level",
            "ns=1;g=72962B91-FA75-4AE6-8D28-B404DC7DAF63",
            "ns=65535;b=M/RbKBsRVkePCePcx24oRA==",
        ] {
            assert_eq!(read_node(fine).expect(fine).to_string(), fine);
        }
        assert_eq!(read_node("ns=0;i=85").expect("fine").to_string(), "i=85");
        for bad in [
            "",
            "Tank",
            "ns=2",
            "ns=2;",
            "ns=x;s=a",
            "ns=65536;s=a",
            "nsu=;s=a",
            "nsu=urn:a",
            "i=-1",
            "i=",
            "i=4294967296",
            "s=",
            "g=1234",
            "b=abc",
            "b====",
            "x=1",
        ] {
            assert!(read_node(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn addresses_are_those_of_opc_ua() {
        for fine in ["opc.tcp://a", "opc.tcp://10.0.0.7:4840/x/y", "opc.tcp://[::1]:4840", "opc.tcp://[::1]"]
        {
            assert_eq!(address(fine), Ok(()), "{fine}");
        }
        for bad in [
            "",
            "a",
            "http://a",
            "opc.tcp://",
            "opc.tcp://:1",
            "opc.tcp://a:0",
            "opc.tcp://a:b",
            "opc.tcp://a b",
        ] {
            assert!(address(bad).is_err(), "{bad}");
        }
    }
}
