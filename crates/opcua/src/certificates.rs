//! The folder of the certificates.
//!
//! ```text
//! own/cert.der          that of this machine, made at the first start unless it is there
//! private/private.pem   its key
//! trusted/              those of the other side that are trusted; a person puts them there
//! rejected/             those that came and were not trusted
//! ```
//!
//! The library looks for a trusted certificate under one name, made of its common name and its thumbprint;
//! files under other names are given that one.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use g7_online::Failed;
use opcua::crypto::{CertificateStore, X509, X509Data};

/// The certificate and its key, in the folder.
pub(crate) const OWN: &str = "own/cert.der";
pub(crate) const KEY: &str = "private/private.pem";
const TRUSTED: &str = "trusted";
const REJECTED: &str = "rejected";

/// The life of a certificate that is made here: machines run for years.
const DAYS: u32 = 3650;
const KEY_BITS: u32 = 2048;
/// The longest file that is read as a certificate.
const LONGEST: u64 = 64 << 10;
/// The greatest number of rejected certificates that stay on the disk. Anyone who reaches the port can send more.
const KEPT: usize = 50;

/// The folder of the certificates.
#[derive(Debug)]
pub(crate) struct Folder {
    path: PathBuf,
    /// The rejected files that the operator was told of.
    told: BTreeSet<PathBuf>,
}

impl Folder {
    pub(crate) fn new(path: &Path) -> Folder {
        Folder { path: path.to_path_buf(), told: BTreeSet::new() }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Makes the folders and the certificate of this machine where they are missing.
    ///
    /// # Errors
    ///
    /// A file cannot be made or read, or the certificate cannot be used.
    pub(crate) fn prepare(&mut self, name: &str, uri: &str, address: &str) -> Result<(), Failed> {
        for part in ["own", "private", TRUSTED, REJECTED] {
            self.folder(part)?;
        }
        let (cert, key) = (self.path.join(OWN), self.path.join(KEY));
        if !cert.exists() {
            make(name, uri, address, &cert, &key)?;
        } else if !key.exists() {
            return Err(Failed(format!("{} is there, but its key {} is not", cert.display(), key.display())));
        }
        let own = read(&cert).map_err(Failed)?;
        own.is_time_valid(&chrono::Utc::now()).map_err(|_| {
            let until = own.not_after().map(|time| time.format("%Y-%m-%d").to_string()).unwrap_or_default();
            Failed(format!("the certificate {} is not valid today (until {until}): move it away, and G7 makes another one", cert.display()))
        })?;
        own.is_application_uri_valid(uri)
            .map_err(|_| Failed(format!("the certificate {} is not for the application {uri}: give this device a folder of its own (`certificates`)", cert.display())))?;
        // Certificates that were rejected before this start are no news.
        self.told = self.files(REJECTED).into_iter().collect();
        self.adopt()
    }

    fn folder(&self, part: &str) -> Result<(), Failed> {
        let path = self.path.join(part);
        let failed = |e: std::io::Error| Failed(format!("{}: {e}", path.display()));
        fs::create_dir_all(&path).map_err(failed)?;
        #[cfg(unix)]
        if part == "private" {
            use std::os::unix::fs::PermissionsExt as _;
            fs::set_permissions(&path, fs::Permissions::from_mode(0o700)).map_err(failed)?;
        }
        Ok(())
    }

    /// Gives trusted files the names that the library looks for, and removes them from the rejected ones.
    pub(crate) fn adopt(&self) -> Result<(), Failed> {
        for file in self.files(TRUSTED) {
            let Ok(cert) = read(&file) else { continue };
            let name = CertificateStore::cert_file_name(&cert);
            let there = self.path.join(TRUSTED).join(&name);
            if !there.exists() {
                let der = cert.to_der().map_err(|_| Failed(format!("{} is damaged", file.display())))?;
                g7_host::write_whole(&there, &der)
                    .map_err(|e| Failed(format!("{}: {e}", there.display())))?;
            }
            // It may not be there.
            fs::remove_file(self.path.join(REJECTED).join(name)).ok();
        }
        Ok(())
    }

    /// A sentence for each certificate that was rejected since the last call.
    pub(crate) fn rejected(&mut self) -> Vec<String> {
        let files = self.files(REJECTED);
        let new: Vec<PathBuf> = files.iter().filter(|file| !self.told.contains(*file)).cloned().collect();
        let most = files.len().saturating_sub(KEPT);
        for old in files.iter().filter(|file| self.told.contains(*file)).chain(&new).take(most) {
            fs::remove_file(old).ok();
        }
        self.told = files.into_iter().collect();
        let name = |file: &PathBuf| file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let say = |file: &PathBuf| {
            let path = self.path.display();
            format!(
                "refused the unknown certificate \"{}\": to trust it, move it from {path}/rejected to {path}/trusted",
                name(file)
            )
        };
        new.iter().take(3).map(say).collect()
    }

    /// A sentence for each trusted certificate that is not valid today.
    pub(crate) fn expired(&self) -> Vec<String> {
        let now = chrono::Utc::now();
        let say = |file: &PathBuf| {
            let cert = read(file).ok()?;
            cert.is_time_valid(&now).err()?;
            let name = CertificateStore::cert_file_name(&cert);
            file.ends_with(&name).then(|| format!("the trusted certificate \"{name}\" has expired, or is not valid yet: whoever has it is refused"))
        };
        self.files(TRUSTED).iter().filter_map(say).collect()
    }

    /// Refuses a certificate that is not trusted, with its thumbprint.
    pub(crate) fn check(&self, cert: &X509) -> Result<(), Failed> {
        let name = CertificateStore::cert_file_name(cert);
        let path = self.path.display();
        if !self.path.join(TRUSTED).join(&name).exists() {
            let aside = self.path.join(REJECTED).join(&name);
            if let (false, Ok(der)) = (aside.exists(), cert.to_der()) {
                g7_host::write_whole(&aside, &der)
                    .map_err(|e| Failed(format!("{}: {e}", aside.display())))?;
            }
            return Err(Failed(format!(
                "its certificate is unknown, \"{name}\": compare the thumbprint, and move the file from {path}/rejected to {path}/trusted"
            )));
        }
        let day = |time: Result<chrono::DateTime<chrono::Utc>, _>| {
            time.map(|t| t.format("%Y-%m-%d").to_string()).unwrap_or_default()
        };
        cert.is_time_valid(&chrono::Utc::now()).map_err(|_| {
            let (from, until) = (day(cert.not_before().map_err(drop)), day(cert.not_after().map_err(drop)));
            Failed(format!("its certificate \"{name}\" is valid from {from} until {until}, not today"))
        })
    }

    /// The files of a part, sorted by name.
    fn files(&self, part: &str) -> Vec<PathBuf> {
        let Ok(list) = fs::read_dir(self.path.join(part)) else { return Vec::new() };
        let mut files: Vec<PathBuf> = list.filter_map(|entry| Some(entry.ok()?.path())).collect();
        files.retain(|file| file.is_file());
        files.sort();
        files
    }
}

/// The host of this machine, in names of applications.
pub(crate) fn host() -> String {
    X509Data::computer_hostnames().into_iter().next().unwrap_or_else(|| "localhost".to_owned())
}

/// Makes a certificate that signs itself. The key is there first, so a certificate has its key.
fn make(name: &str, uri: &str, address: &str, cert: &Path, key: &Path) -> Result<(), Failed> {
    let addresses = Some(vec![address.to_owned()]).filter(|a| a.iter().all(|a| !a.is_empty()));
    let data = X509Data {
        key_size: KEY_BITS,
        common_name: name.to_owned(),
        organization: "G7".to_owned(),
        organizational_unit: "G7".to_owned(),
        country: "XX".to_owned(),
        state: "-".to_owned(),
        alt_host_names: X509Data::alt_host_names(uri, addresses, true, true, false),
        certificate_duration_days: DAYS,
    };
    let (new_cert, new_key) = (cert.with_extension("new.der"), key.with_extension("new.pem"));
    let failed = |e: &dyn std::fmt::Display| Failed(format!("cannot make {}: {e}", cert.display()));
    CertificateStore::create_certificate_and_key(&data, true, &new_cert, &new_key).map_err(|e| failed(&e))?;
    fs::rename(&new_key, key).and_then(|()| fs::rename(&new_cert, cert)).map_err(|e| failed(&e))
}

/// Reads a certificate, in DER or PEM.
fn read(file: &Path) -> Result<X509, String> {
    let wrong = |e: &dyn std::fmt::Display| format!("{}: {e}", file.display());
    if fs::metadata(file).map_err(|e| wrong(&e))?.len() > LONGEST {
        return Err(wrong(&"it is too long for a certificate"));
    }
    let bytes = fs::read(file).map_err(|e| wrong(&e))?;
    let cert = if bytes.starts_with(b"-----") { X509::from_pem(&bytes) } else { X509::from_der(&bytes) };
    cert.map_err(|_| wrong(&"it is no certificate"))
}
