//! The certificate of the server: read, judged, and read again when it is renewed.
//!
//! A fault in it is found before anything listens. A renewed file is taken while the server works, if
//! it is right; otherwise the one of before stays and the reason is told.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use g7_host::utc_millis;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::pem::PemObject as _;
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer, UnixTime};
use tokio_rustls::rustls::server::{ClientHello, ResolvesServerCert};
use tokio_rustls::rustls::sign::CertifiedKey;
use tokio_rustls::rustls::{self, ServerConfig};
use webpki::EndEntityCert;

use g7_model::{Said, say};

use crate::failure::{Failure, plain, raw};
use crate::message::tell;

const DAY: u64 = 86_400;
/// A certificate that ends so soon is told, in days.
const SOON: u64 = 14;

/// The files of a certificate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Files {
    pub(super) cert: PathBuf,
    pub(super) key: PathBuf,
}

/// A certificate that is right.
#[derive(Debug)]
struct Right {
    key: Arc<CertifiedKey>,
    /// The names that it is for.
    names: Vec<String>,
    /// The last second at which it is valid, since 1970.
    until: u64,
}

/// The certificate of a server that works.
#[derive(Debug)]
pub(super) struct Certificate {
    files: Files,
    now: Mutex<Right>,
    seen: Mutex<[Option<SystemTime>; 2]>,
}

impl ResolvesServerCert for Certificate {
    fn resolve(&self, _: ClientHello<'_>) -> Option<Arc<CertifiedKey>> {
        Some(Arc::clone(&self.now.lock().unwrap_or_else(PoisonError::into_inner).key))
    }
}

impl Certificate {
    /// Reads a certificate and its key.
    pub(super) fn open(files: Files) -> Result<Arc<Certificate>, Failure> {
        let right = read(&files, utc_millis() / 1_000).map_err(Failure::Usage)?;
        warn(&files, &right);
        let seen = Mutex::new(times(&files));
        Ok(Arc::new(Certificate { files, now: Mutex::new(right), seen }))
    }

    /// The acceptor that takes connections with it.
    pub(super) fn acceptor(self: &Arc<Certificate>) -> Result<TlsAcceptor, Failure> {
        let wrong = |e: rustls::Error| Failure::Usage(say!("no TLS: {e}", e = raw(&e)));
        let config = ServerConfig::builder_with_provider(Arc::new(ring::default_provider()));
        let config = config.with_safe_default_protocol_versions().map_err(wrong)?;
        let resolver: Arc<dyn ResolvesServerCert> = Arc::clone(self) as _;
        let mut config = config.with_no_client_auth().with_cert_resolver(resolver);
        config.alpn_protocols = vec![b"http/1.1".to_vec()];
        Ok(TlsAcceptor::from(Arc::new(config)))
    }

    /// The names that it is for.
    pub(super) fn names(&self) -> Vec<String> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner).names.clone()
    }

    /// Takes the files again if they have changed.
    pub(super) fn look(&self) {
        let found = times(&self.files);
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        if *seen == found {
            return;
        }
        *seen = found;
        drop(seen);
        match read(&self.files, utc_millis() / 1_000) {
            Ok(right) => {
                tell(say!("the certificate {} was renewed", raw(self.files.cert.display())));
                warn(&self.files, &right);
                *self.now.lock().unwrap_or_else(PoisonError::into_inner) = right;
            }
            Err(why) => tell(say!("the certificate of before stays: {why}")),
        }
    }
}

fn times(files: &Files) -> [Option<SystemTime>; 2] {
    [&files.cert, &files.key].map(|path| std::fs::metadata(path).ok().and_then(|m| m.modified().ok()))
}

fn warn(files: &Files, right: &Right) {
    let left = right.until.saturating_sub(utc_millis() / 1_000) / DAY;
    if left < SOON {
        tell(say!("the certificate {} ends in {left} days", raw(files.cert.display())));
    }
}

/// Reads and judges a certificate; `now` in seconds since 1970.
fn read(files: &Files, now: u64) -> Result<Right, Said> {
    let Files { cert, key } = files;
    let (cert_name, key_name) = (raw(cert.display()), raw(key.display()));
    let chain = certificates(cert)?;
    let first = chain.first().ok_or_else(|| say!("{cert_name} has no certificate (PEM)"))?;
    let bytes = bytes(key)?;
    let private =
        PrivateKeyDer::from_pem_slice(&bytes).map_err(|_| say!("{key_name} has no private key (PEM)"))?;
    let unreadable = |e: webpki::Error| say!("{cert_name} has a certificate that cannot be read: {}", raw(e));
    let entity = EndEntityCert::try_from(first).map_err(unreadable)?;
    let (from, until) = validity(&entity).map_err(unreadable)?;
    let names = entity.valid_dns_names().map(str::to_ascii_lowercase).collect();
    let day = |second: u64| raw(g7_host::utc_day(second));
    if now > until {
        return Err(say!("the certificate {cert_name} has expired on {}: renew it", day(until)));
    }
    if now < from {
        return Err(say!(
            "the certificate {cert_name} is valid from {} on, and this machine has {}: wait, or set the clock",
            day(from),
            day(now)
        ));
    }
    let key = CertifiedKey::from_der(chain, private, &ring::default_provider()).map_err(|e| match e {
        rustls::Error::InconsistentKeys(_) => {
            say!("{key_name} is not the key of the certificate {cert_name}")
        }
        other => say!("the certificate {cert_name} cannot be used: {}", raw(other)),
    })?;
    Ok(Right { key: Arc::new(key), names, until })
}

fn bytes(path: &Path) -> Result<Vec<u8>, Said> {
    std::fs::read(path).map_err(|e| say!("cannot read {}: {}", raw(path.display()), plain(&e)))
}

fn certificates(path: &Path) -> Result<Vec<CertificateDer<'static>>, Said> {
    let bytes = bytes(path)?;
    let all: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(&bytes).collect();
    all.map_err(|e| say!("{} is no certificate (PEM): {}", raw(path.display()), raw(e)))
}

/// The first and the last second at which a certificate is valid. It is asked for at the ends of time, and the
/// refusals tell them.
fn validity(cert: &EndEntityCert<'_>) -> Result<(u64, u64), webpki::Error> {
    let at = |second: u64| {
        let time = UnixTime::since_unix_epoch(std::time::Duration::from_secs(second));
        cert.verify_for_usage(
            webpki::ALL_VERIFICATION_ALGS,
            &[],
            &[],
            time,
            webpki::KeyUsage::server_auth(),
            None,
            None,
        )
        .err()
    };
    let from = match at(0) {
        Some(webpki::Error::CertNotValidYet { not_before, .. }) => not_before.as_secs(),
        Some(
            e @ (webpki::Error::BadDer | webpki::Error::BadDerTime | webpki::Error::InvalidCertValidity),
        ) => {
            return Err(e);
        }
        _ => 0,
    };
    // The last second of the year 9999, which is as late as a certificate can say.
    let until = match at(253_402_300_800) {
        Some(webpki::Error::CertExpired { not_after, .. }) => not_after.as_secs(),
        Some(
            e @ (webpki::Error::BadDer | webpki::Error::BadDerTime | webpki::Error::InvalidCertValidity),
        ) => {
            return Err(e);
        }
        _ => u64::MAX,
    };
    Ok((from, until))
}
