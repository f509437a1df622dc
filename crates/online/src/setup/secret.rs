//! Passwords, certificates and keys: an io file names them and does not hold them; they are in files beside
//! it or in variables of the environment.

use g7_model::{Problem, Said, Span, codes, say};

use super::table::{At, Found, Table};
use crate::tls::{self, Files, Part};

/// The place of a secret, which is never the io file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A file, beside the io file.
    File(String),
    /// A variable of the environment.
    Variable(String),
}

/// Bytes that are never shown.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Secret(Vec<u8>);

impl Secret {
    /// The bytes, for the peer alone.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }
}

impl std::fmt::Debug for Secret {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Secret")
    }
}

/// A secret: where it is, and what it is as soon as somebody has read it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Held {
    /// The file or variable.
    pub from: At<Origin>,
    /// The secret itself.
    pub secret: Secret,
}

impl Held {
    fn new(from: At<Origin>) -> Held {
        Held { from, secret: Secret::default() }
    }

    /// A file beside the io file.
    fn file(table: &mut Table<'_>, found: &mut Found, key: &'static str) -> Option<Held> {
        table.text(found, key).map(|name| Held::new(At::new(Origin::File(name.value), name.at)))
    }
}

/// How a connection is encrypted, and who trusts whom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tls {
    /// The setting.
    pub at: Span,
    /// The certificates that are trusted; without them those of the system are.
    pub ca: Option<Held>,
    /// The certificate of this client, and its key.
    pub identity: Option<(Held, Held)>,
}

impl Tls {
    /// The texts of the files.
    pub(crate) fn files(&self) -> Files<'_> {
        Files {
            roots: self.ca.as_ref().map(|held| held.secret.bytes()),
            identity: self.identity.as_ref().map(|(one, other)| (one.secret.bytes(), other.secret.bytes())),
        }
    }

    fn held(&mut self) -> impl Iterator<Item = &mut Held> {
        let identity = self.identity.iter_mut().flat_map(|(certificate, key)| [certificate, key]);
        self.ca.iter_mut().chain(identity)
    }
}

/// Reads `password-file` or `password-env`.
pub(super) fn password(table: &mut Table<'_>, found: &mut Found) -> Option<Held> {
    let file = Held::file(table, found, "password-file");
    let variable = table.text(found, "password-env");
    let variable = variable.map(|v| Held::new(At::new(Origin::Variable(v.value), v.at)));
    if let (Some(file), Some(variable)) = (&file, &variable) {
        found
            .wrong(variable.from.at, say!("there are two passwords"))
            .related
            .push((file.from.at, say!("this is the other one")));
    }
    file.or(variable)
}

/// Reads `tls`: true, or a table with files.
pub(super) fn tls(table: &mut Table<'_>, found: &mut Found) -> Option<Tls> {
    let value = table.value(found, "tls")?;
    let at = value.at;
    if let Some(on) = value.value.as_bool() {
        return on.then_some(Tls { at, ca: None, identity: None });
    }
    let Some(rows) = value.value.as_table() else {
        found.wrong(at, say!("`tls` is true, or a table with the files of the certificates")).help =
            Some(say!("write `tls = true` or `tls = {{ ca = \"ca.pem\" }}`"));
        return None;
    };
    let mut table = Table::new(rows, at, Said::foreign("`tls`"));
    let ca = Held::file(&mut table, found, "ca");
    let certificate = Held::file(&mut table, found, "certificate");
    let key = Held::file(&mut table, found, "key");
    let identity = match (certificate, key) {
        (Some(certificate), Some(key)) => Some((certificate, key)),
        (None, None) => None,
        (Some(one), None) | (None, Some(one)) => {
            found.wrong(one.from.at, say!("`certificate` and `key` of a client belong together"));
            None
        }
    };
    table.end(found);
    Some(Tls { at, ca, identity })
}

/// The password and the files of one peer.
pub(super) type Wanted<'d> = (Option<&'d mut Held>, Option<&'d mut Tls>);

/// Gets what peers have in files and variables. `read` gives the bytes, or says why not.
pub(super) fn read<'d>(
    peers: impl Iterator<Item = Wanted<'d>>,
    mut read: impl FnMut(&Origin) -> Result<Vec<u8>, Said>,
) -> Vec<Problem> {
    let mut problems = Vec::new();
    let mut wrong = |at: Span, what: Said| problems.push(Problem::new(&codes::BAD_WIRING, at, what));
    for (password, tls) in peers {
        if let Some(password) = password {
            match read(&password.from.value) {
                Ok(mut bytes) => {
                    // Editors put a line end at the end of a file. It is not part of the password.
                    while bytes.last().is_some_and(|b| matches!(b, b'\n' | b'\r')) {
                        bytes.pop();
                    }
                    password.secret = Secret(bytes);
                }
                Err(why) => wrong(password.from.at, say!("the password cannot be read: {why}")),
            }
        }
        let Some(tls) = tls else { continue };
        let mut complete = true;
        for held in tls.held() {
            match read(&held.from.value) {
                Ok(bytes) => held.secret = Secret(bytes),
                Err(why) => {
                    complete = false;
                    wrong(held.from.at, say!("the file cannot be read: {why}"));
                }
            }
        }
        if let (true, Err((part, why))) = (complete, tls::config(tls.files())) {
            let at = match (part, &tls.ca, &tls.identity) {
                (Part::Roots, Some(ca), _) => ca.from.at,
                (Part::Certificate, _, Some((certificate, _))) => certificate.from.at,
                (Part::Key, _, Some((_, key))) => key.from.at,
                _ => tls.at,
            };
            wrong(at, why);
        }
    }
    problems
}
