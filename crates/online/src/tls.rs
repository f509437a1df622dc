//! TLS of the connections that G7 makes: whom it trusts, who it is, and why a peer was refused.
//!
//! Pure but for the roots of the system, which the library reads. There is one provider of cryptography
//! in the program, ring, and it is named here, so that no second one comes in by a default.

use std::sync::Arc;

use g7_model::{Said, say};
use rustls::crypto::ring;
use rustls::pki_types::pem::{self, PemObject as _};
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::{AlertDescription, CertificateError, ClientConfig, RootCertStore};

/// The file that is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// The certificates that are trusted: those of a file, or of the system.
    Roots,
    /// The certificate of this client.
    Certificate,
    /// Its key.
    Key,
}

/// The texts of the files, in PEM (RFC 7468).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Files<'a> {
    /// Certificates that are trusted, in place of those of the system.
    pub(crate) roots: Option<&'a [u8]>,
    /// The certificate of this client with those between it and its root, and its key.
    pub(crate) identity: Option<(&'a [u8], &'a [u8])>,
}

/// The settings of TLS for a connection.
///
/// # Errors
///
/// The file that cannot be used, and why.
pub(crate) fn config(files: Files<'_>) -> Result<Arc<ClientConfig>, (Part, Said)> {
    let roots = match files.roots {
        Some(pem) => given(pem).map_err(|why| (Part::Roots, why))?,
        None => of_the_system().map_err(|why| (Part::Roots, why))?,
    };
    let builder = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()))
        .with_safe_default_protocol_versions()
        .map_err(|e| (Part::Roots, Said::foreign(e.to_string())))?
        .with_root_certificates(roots);
    let Some((certificate, key)) = files.identity else {
        return Ok(Arc::new(builder.with_no_client_auth()));
    };
    let chain = certificates(certificate).map_err(|why| (Part::Certificate, why))?;
    let key = PrivateKeyDer::from_pem_slice(key).map_err(|e| (Part::Key, no_key(&e)))?;
    let config = builder.with_client_auth_cert(chain, key).map_err(|e| match e {
        rustls::Error::InconsistentKeys(_) => (Part::Key, say!("it is not the key of this `certificate`")),
        other => (Part::Certificate, Said::foreign(other.to_string())),
    })?;
    Ok(Arc::new(config))
}

fn certificates(text: &[u8]) -> Result<Vec<CertificateDer<'static>>, Said> {
    let found: Result<Vec<CertificateDer<'static>>, pem::Error> =
        CertificateDer::pem_slice_iter(text).collect();
    match found {
        Ok(found) if found.is_empty() => Err(say!("it has no certificate in the form PEM")),
        Ok(found) => Ok(found),
        Err(e) => Err(say!("it is no certificate in the form PEM: {}", Said::foreign(e.to_string()))),
    }
}

fn no_key(error: &pem::Error) -> Said {
    match error {
        pem::Error::NoItemsFound => say!("it has no private key in the form PEM"),
        other => say!("it is no private key in the form PEM: {}", Said::foreign(other.to_string())),
    }
}

fn given(text: &[u8]) -> Result<RootCertStore, Said> {
    let mut roots = RootCertStore::empty();
    for certificate in certificates(text)? {
        let why =
            |e: rustls::Error| say!("a certificate in it cannot be used: {}", Said::foreign(e.to_string()));
        roots.add(certificate).map_err(why)?;
    }
    Ok(roots)
}

fn of_the_system() -> Result<RootCertStore, Said> {
    let mut roots = RootCertStore::empty();
    // Systems have roots that are too old to be understood; the others count.
    roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
    if roots.is_empty() {
        return Err(say!("this system has no certificates that it trusts: name a file by `ca`"));
    }
    Ok(roots)
}

/// Why a connection was refused, where the error is one of TLS. `peer` names the other side: `broker`.
pub(crate) fn refusal(error: &std::io::Error, peer: &str) -> Option<String> {
    let error = error.get_ref()?.downcast_ref::<rustls::Error>()?;
    let of_peer = format!("the certificate of the {peer}");
    Some(match error {
        rustls::Error::InvalidCertificate(wrong) => match wrong {
            CertificateError::Expired | CertificateError::ExpiredContext { .. } => {
                format!("{of_peer} has expired")
            }
            CertificateError::NotValidYet | CertificateError::NotValidYetContext { .. } => {
                format!("{of_peer} is not valid yet, by the clock of this machine")
            }
            CertificateError::UnknownIssuer => {
                format!("{of_peer} is of none that is trusted here: `ca` names the file of its issuer")
            }
            CertificateError::NotValidForName | CertificateError::NotValidForNameContext { .. } => {
                format!("{of_peer} has another name than `host`")
            }
            other => format!("{of_peer} is refused: {other:?}"),
        },
        rustls::Error::NoCertificatesPresented => format!("the {peer} has no certificate"),
        rustls::Error::AlertReceived(alert) => match alert {
            AlertDescription::CertificateRequired => {
                format!("the {peer} wants a `certificate` of this client")
            }
            AlertDescription::BadCertificate
            | AlertDescription::UnsupportedCertificate
            | AlertDescription::CertificateRevoked
            | AlertDescription::CertificateExpired
            | AlertDescription::CertificateUnknown
            | AlertDescription::UnknownCA
            | AlertDescription::AccessDenied => {
                format!("the {peer} refuses the `certificate` of this client: {alert:?}")
            }
            other => format!("the {peer} ends the handshake of TLS: {other:?}"),
        },
        rustls::Error::InvalidMessage(_) => format!("the {peer} does not speak TLS at this port"),
        other => format!("TLS: {other}"),
    })
}
