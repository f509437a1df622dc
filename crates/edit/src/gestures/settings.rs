//! Settings of the file: its profile, the switches of the profile, the scan time.

use std::mem::discriminant;

use g7_model::{Item, Nanos, Place, Profile, ProfileName, Switch, say};

use crate::change::{Refusal, refuse};
use crate::draft::Draft;

pub(crate) fn profile(d: &mut Draft<'_>, name: &str) -> Result<(), Refusal> {
    let Some(profile) = ProfileName::ALL.into_iter().find(|p| p.name() == name) else {
        return refuse(say!("there is no profile `{name}`"));
    };
    profile_mut(d, |p, _| p.name = profile);
    Ok(())
}

/// Writes a switch beside the profile, or removes it so that the profile decides.
pub(crate) fn switch(d: &mut Draft<'_>, word: &str, on: bool) -> Result<(), Refusal> {
    let Some((_, switch)) = g7_syntax::SWITCHES.into_iter().find(|(name, _)| *name == word) else {
        return refuse(say!("there is no switch `{word}`"));
    };
    let same = |s: &Switch| if on { discriminant(s) == discriminant(&switch) } else { *s == switch };
    change(d, same, on.then_some(switch));
    Ok(())
}

/// Sets the greatest number of passes in a scan; without a number the profile decides.
pub(crate) fn bound(d: &mut Draft<'_>, passes: Option<u32>) -> Result<(), Refusal> {
    if passes == Some(0) {
        return refuse(say!("a scan needs at least one pass"));
    }
    change(d, |s| matches!(s, Switch::Bound(_)), passes.map(Switch::Bound));
    Ok(())
}

/// Replaces the switches that exclude each other by a new one.
#[inline(never)]
fn change(d: &mut Draft<'_>, instead: impl Fn(&Switch) -> bool, new: Option<Switch>) {
    let there = |i: &Item| matches!(i, Item::Profile(p) if p.switches.iter().any(|(s, _)| instead(s)));
    if new.is_none() && !d.doc.items.iter().any(there) {
        return;
    }
    profile_mut(d, |p, at| {
        let k = p.switches.iter().position(|(s, _)| instead(s)).unwrap_or(p.switches.len());
        p.switches.retain(|(s, _)| !instead(s));
        if let Some(new) = new {
            p.switches.insert(k.min(p.switches.len()), (new, at));
        }
    });
}

/// Changes the profile of the file; if the file names none, the default profile is written.
#[inline(never)]
fn profile_mut(d: &mut Draft<'_>, change: impl FnOnce(&mut Profile, Place)) {
    let at = d.fresh();
    if !d.doc.items.iter().any(|i| matches!(i, Item::Profile(_))) {
        let usual = Profile { name: ProfileName::default(), switches: Vec::new(), at: d.fresh() };
        d.doc.items.insert(0, Item::Profile(usual));
    }
    let found = d.doc.items.iter_mut().find_map(|i| match i {
        Item::Profile(p) => Some(p),
        _ => None,
    });
    if let Some(p) = found {
        change(p, at);
    }
}

#[inline(never)]
pub(crate) fn scan(d: &mut Draft<'_>, ms: f64) -> Result<(), Refusal> {
    if !(ms.is_finite() && ms > 0.0 && ms <= 3_600_000.0) {
        return refuse(say!("a scan takes more than no time, and at most an hour"));
    }
    #[allow(clippy::cast_possible_truncation, reason = "bounded just above")]
    let time = Nanos::new(((ms * 1_000_000.0).round() as i64).max(1));
    let at = d.fresh();
    for item in &mut d.doc.items {
        if let Item::Cycle(there, _) = item {
            *there = time;
            return Ok(());
        }
    }
    let k = d.doc.items.iter().position(|i| matches!(i, Item::Profile(_))).map_or(0, |k| k + 1);
    d.doc.items.insert(k, Item::Cycle(time, at));
    Ok(())
}
