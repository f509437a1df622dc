//! Two files, or one under two profiles, compared for every sequence of inputs, for the panel *Compare*.
//!
//! A call compares within its limits; the page calls again with larger ones. It counts the time.

use g7_ide::File;
use g7_model::{ProfileName, Severity};
use g7_verify::words::{self, Said};
use g7_verify::{Budget, Compare, Equality, Open, ask};
use serde::{Deserialize, Serialize};

use super::asked::{Limits, MOST};
use crate::run::{Scan, profile};

/// The page's request for a comparison.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields = nullable))]
pub(crate) struct Both {
    /// The names of the two files, which may be one.
    pub(crate) files: [String; 2],
    /// For each of them the profile, if it is not its own.
    #[serde(default)]
    #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
    profiles: [Option<String>; 2],
    /// Situations are compared too.
    #[serde(default)]
    #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
    situations: bool,
    #[serde(flatten)]
    limits: Limits,
}

/// The outcomes of a comparison.
#[derive(Clone, Copy, Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
enum Outcome {
    Equal,
    Apart,
    #[default]
    Open,
    /// They cannot be compared.
    Unlike,
    /// One of them has errors.
    Errors,
}

/// The answer.
#[derive(Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ComparedReport", optional_fields))]
pub(crate) struct Compared {
    is: Outcome,
    /// The reason: the proof, the first difference, what is in the way, why they cannot be compared.
    reason: Said,
    /// The way on; empty if none is known.
    help: Said,
    /// More states or time may decide it.
    more: bool,
    /// There are assumptions, which the inputs of both keep.
    assumed: bool,
    /// The file with errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    side: Option<usize>,
    /// Pairs of states.
    states: usize,
    /// Scans of both: all that were made, or those that do not tell them apart.
    scans: usize,
    /// The shortest run that tells them apart, for each of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    runs: Option<[Vec<Scan>; 2]>,
}

/// Compares two files within the limits.
pub(crate) fn compared(files: [&File; 2], wish: &Both) -> Result<Compared, g7_model::Said> {
    let mut sides = Vec::new();
    for (side, (file, name)) in files.into_iter().zip(&wish.profiles).enumerate() {
        let profile: Option<ProfileName> = name.as_deref().map(profile).transpose()?;
        let wrong = file.problems.iter().any(|p| p.severity() == Severity::Error);
        match ask(file.source.whole(), profile) {
            (Some(asked), problems) if !wrong && problems.iter().all(|p| p.severity() != Severity::Error) => {
                sides.push(asked);
            }
            _ => return Ok(Compared { is: Outcome::Errors, side: Some(side), ..Compared::default() }),
        }
    }
    let [a, b] = sides.as_slice() else { return Err(g7_model::say!("two files are compared")) };
    let budget = Budget {
        states: wish.limits.states.min(MOST.states),
        scans: usize::MAX,
        bytes: wish.limits.mib.min(MOST.mib) << 20,
        stop: &|| false,
    };
    let assume = [a.assume.clone(), b.assume.clone()];
    let assumed = assume.iter().any(|list| !list.is_empty());
    let what = Compare { charts: [&a.compiled, &b.compiled], assume, situations: wish.situations };
    Ok(match g7_verify::compare_once(&what, &budget) {
        Equality::Equal(proof) => {
            Compared { is: Outcome::Equal, reason: words::equal(&proof), assumed, ..Compared::default() }
        }
        Equality::Apart { moves, what } => Compared {
            is: Outcome::Apart,
            reason: words::difference(&what),
            scans: moves.first().map_or(0, Vec::len),
            runs: Some(moves.map(|m| Scan::list(&m))),
            ..Compared::default()
        },
        Equality::Open(Open { scans, states, reason }) => Compared {
            is: Outcome::Open,
            assumed,
            more: reason.is_of_budget(),
            help: if reason.is_of_budget() { Said::default() } else { words::way_on(&reason) },
            reason: words::why(&reason),
            scans,
            states,
            ..Compared::default()
        },
        Equality::Unlike(why) => {
            Compared { is: Outcome::Unlike, reason: words::unlike(&why), ..Compared::default() }
        }
    })
}
