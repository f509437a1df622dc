//! The page's request for a run, and the bench that is built for it.
//!
//! A run keeps the request, so that an on-line change builds the new bench in the same way.

use g7_model::{Nanos, ProfileName, Said, Severity, say};
use g7_rig::{Bench, Options, Source};
use serde::Deserialize;

use super::scans::Scan;

/// The page's request to start a run.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "RunWish", optional_fields = nullable))]
pub(crate) struct Start {
    pub(crate) file: String,
    pub(crate) run: String,
    profile: Option<String>,
    scan_ms: Option<f64>,
    plant: Option<String>,
    #[serde(default)]
    #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
    pub(super) seed: u64,
    /// A run to be repeated from the start, without the user.
    pub(super) moves: Option<Vec<Scan>>,
}

impl Start {
    /// The request without its run, of which a changed chart repeats nothing.
    pub(super) fn without_moves(&self) -> Start {
        Start { moves: None, ..self.clone() }
    }
}

/// Builds the bench for a request.
pub(super) fn bench(source: &Source, wish: &Start) -> Result<Bench, Said> {
    let profile = wish.profile.as_deref().map(profile).transpose()?;
    let scan = match wish.scan_ms {
        Some(ms) if !(0.001..=3.6e6).contains(&ms) => {
            return Err(say!("the scan time must lie between 1 us and 1 h"));
        }
        ms => ms.map(|ms| Nanos::new((ms * 1e6) as i64)),
    };
    // If there are several plants and none is chosen, the run starts with the first.
    let first = g7_compile::plant::plants(&source.document).next().map(|p| p.name.text.to_string());
    let plant = wish.plant.as_deref().or(first.as_deref());
    let (bench, problems) =
        g7_rig::build(source, &Options { profile, scan, plant, asks: &[] }).map_err(|e| e.said())?;
    bench.ok_or_else(|| {
        let mut errors = problems.iter().filter(|p| p.severity() == Severity::Error);
        match (errors.next(), errors.count()) {
            (None, _) => say!("this cannot be run yet"),
            (Some(first), 0) => say!("this cannot be run yet: {}", first.what),
            (Some(first), more) => say!("this cannot be run yet: {} (and {more} more)", first.what),
        }
    })
}

/// The profile with this name.
pub(crate) fn profile(name: &str) -> Result<ProfileName, Said> {
    let found = ProfileName::ALL.into_iter().find(|p| p.name() == name);
    found.ok_or_else(|| say!("there is no profile `{name}`"))
}
