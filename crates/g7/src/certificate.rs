//! `g7 cert`: a certificate that vouches for itself, and its private key.
//!
//! A browser asks once whether to trust it; whoever has it compares the fingerprint. It is a file and not made
//! anew at each start, so that the question comes once.

use std::net::IpAddr;
use std::path::PathBuf;

use clap::Args;
use g7_host::{utc_day, utc_millis};
use rcgen::{CertificateParams, DnType, ExtendedKeyUsagePurpose, KeyPair, KeyUsagePurpose, date_time_ymd};
use sha2::{Digest as _, Sha256};

use g7_model::say;

use crate::failure::{Failure, Verdict, raw};
use crate::files;
use crate::message::{tell, wrote};

/// Certificates that last longer are refused by some browsers.
const LONGEST: u16 = 825;
const DAY: u64 = 86_400;

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  g7 cert                             for this machine alone: localhost, 127.0.0.1, ::1
  g7 cert sorter.plant.lan 10.0.0.7   for the names and addresses that others use
  g7 serve --host 0.0.0.0 --cert g7.cert.pem --key g7.key.pem --users g7.users

The certificate vouches for itself: each browser asks once. Compare the fingerprint then.
A certificate of an authority of yours does as well; `g7 serve` takes a renewed file
without a new start.")]
pub(crate) struct Cert {
    /// The names and addresses under which others reach the server.
    names: Vec<String>,
    /// The file for the certificate.
    #[arg(long, value_name = "FILE", default_value = "g7.cert.pem")]
    cert: PathBuf,
    /// The file for the private key; it is its owner's alone.
    #[arg(long, value_name = "FILE", default_value = "g7.key.pem")]
    key: PathBuf,
    /// The days that it is valid for.
    #[arg(long, default_value_t = LONGEST, value_parser = clap::value_parser!(u16).range(1..=i64::from(LONGEST)))]
    days: u16,
    /// Replace files that are there.
    #[arg(long)]
    force: bool,
}

pub(crate) fn certificate(args: &Cert) -> Result<Verdict, Failure> {
    files::refuse_present(Some(&args.cert), args.force)?;
    files::refuse_present(Some(&args.key), args.force)?;
    let mut names = args.names.clone();
    for own in ["localhost", "127.0.0.1", "::1"] {
        if !names.iter().any(|name| name == own) {
            names.push(own.to_owned());
        }
    }
    if let Some(wrong) = names.iter().find(|name| !is_name(name)) {
        return Err(Failure::Usage(say!("`{wrong}` is no name or address of a machine")));
    }
    let failed = |e: rcgen::Error| Failure::Usage(say!("no certificate can be made: {e}", e = raw(&e)));
    let today = utc_millis() / 1_000;
    let mut params = CertificateParams::new(names.clone()).map_err(failed)?;
    // A clock that is a day behind is no reason to refuse it.
    let ((y1, m1, d1), (y2, m2, d2)) = (date(today - DAY), date(today + DAY * u64::from(args.days)));
    params.not_before = date_time_ymd(y1, m1, d1);
    params.not_after = date_time_ymd(y2, m2, d2);
    params
        .distinguished_name
        .push(DnType::CommonName, format!("G7 at {}", names.first().map_or("", String::as_str)));
    params.key_usages = vec![KeyUsagePurpose::DigitalSignature];
    params.extended_key_usages = vec![ExtendedKeyUsagePurpose::ServerAuth];
    let key = KeyPair::generate().map_err(failed)?;
    let cert = params.self_signed(&key).map_err(failed)?;
    g7_host::write_private(&args.key, key.serialize_pem().as_bytes())
        .map_err(|e| Failure::Write(args.key.clone(), e))?;
    files::write(&args.cert, cert.pem().as_bytes())?;
    wrote(args.cert.display());
    wrote(args.key.display());
    let last = raw(utc_day(today + DAY * u64::from(args.days)));
    tell(say!("for {}, until {last}", raw(names.join(", "))));
    let print: Vec<String> = Sha256::digest(cert.der()).iter().map(|byte| format!("{byte:02X}")).collect();
    files::deliver(None, format!("SHA-256 {}\n", print.join(":")).as_bytes())?;
    Ok(Verdict::Fine)
}

/// Year, month and day of a second since 1970.
fn date(second: u64) -> (i32, u8, u8) {
    let day = utc_day(second);
    let mut parts = day.split('-');
    let mut next = || parts.next().unwrap_or_default();
    (next().parse().unwrap_or(1970), next().parse().unwrap_or(1), next().parse().unwrap_or(1))
}

/// True for an address, or a name of DNS that may begin with `*.`.
fn is_name(name: &str) -> bool {
    let label = |label: &str| {
        let fits = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        !label.is_empty() && label.len() <= 63 && label.chars().all(fits)
    };
    name.parse::<IpAddr>().is_ok()
        || name.len() <= 253 && name.strip_prefix("*.").unwrap_or(name).split('.').all(label)
}
