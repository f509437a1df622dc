//! Arguments with a syntax of their own.

use std::ffi::OsStr;

use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Arg, Command};
use g7_model::{Nanos, ProfileName, TargetPlc, codes};
pub(crate) use g7_rig::values::duration;

/// An argument that is read by a function, and whose usual words a shell and the help know.
#[derive(Clone)]
pub(crate) struct Words<T> {
    all: fn() -> Vec<PossibleValue>,
    read: fn(&str) -> Result<T, String>,
}

impl<T: Clone + Send + Sync + 'static> TypedValueParser for Words<T> {
    type Value = T;

    fn parse_ref(&self, cmd: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<T, clap::Error> {
        self.read.parse_ref(cmd, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new((self.all)().into_iter()))
    }
}

/// The name of a profile.
pub(crate) fn profiles() -> Words<ProfileName> {
    let all = || ProfileName::ALL.map(|p| PossibleValue::new(p.name())).to_vec();
    Words { all, read: profile }
}

/// The name of a PLC.
pub(crate) fn targets() -> Words<TargetPlc> {
    let all = || TargetPlc::ALL.map(|p| PossibleValue::new(p.name())).to_vec();
    Words { all, read: target }
}

/// The code of a problem. Every word is accepted here; `g7 explain` reports a code that does not exist.
pub(crate) fn problem_codes() -> Words<String> {
    let all = || codes::ALL.iter().map(|code| PossibleValue::new(code.id).help(code.title)).collect();
    Words { all, read: |text| Ok(text.to_owned()) }
}

/// An assignment at a time: `start=1@2s`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Assign {
    /// The name of the input or state.
    pub(crate) name: String,
    /// The value; it is parsed when the type is known.
    pub(crate) value: String,
    /// The time.
    pub(crate) at: Nanos,
}

pub(crate) fn assign(text: &str) -> Result<Assign, String> {
    let form = "expected NAME=VALUE or NAME=VALUE@TIME, as in start=1@2s";
    let (name, rest) = text.split_once('=').ok_or(form)?;
    // A text may contain `@`; the time follows the last one.
    let (value, at) = match rest.rsplit_once('@') {
        Some((value, at)) => (value, duration(at).map_err(|e| e.to_string())?),
        None => (rest, Nanos::ZERO),
    };
    if name.trim().is_empty() {
        return Err(form.to_owned());
    }
    let name = name.trim().trim_matches('`').to_owned();
    Ok(Assign { name, value: value.to_owned(), at })
}

fn profile(text: &str) -> Result<ProfileName, String> {
    let all = ProfileName::ALL;
    all.into_iter()
        .find(|p| p.name().eq_ignore_ascii_case(text))
        .ok_or_else(|| format!("expected one of {}", all.map(ProfileName::name).join(", ")))
}

fn target(text: &str) -> Result<TargetPlc, String> {
    let all = TargetPlc::ALL;
    all.into_iter()
        .find(|p| p.name().eq_ignore_ascii_case(text))
        .ok_or_else(|| format!("expected one of {}", all.map(TargetPlc::name).join(", ")))
}

/// Two names: an output and the input that it is connected to.
pub(crate) fn wire(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((from, to)) if !from.is_empty() && !to.is_empty() => Ok((from.to_owned(), to.to_owned())),
        _ => Err("write OUTPUT=INPUT".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assignments_name_value_and_time() {
        let a = assign("start=1@2s").unwrap();
        assert_eq!((a.name.as_str(), a.value.as_str(), a.at), ("start", "1", Nanos::SECOND * 2));
        assert_eq!(
            assign("n = 3").unwrap(),
            Assign { name: "n".into(), value: " 3".into(), at: Nanos::ZERO }
        );
        assert_eq!(assign("mail='a@b'@1s").unwrap().value, "'a@b'");
        for bad in ["start", "=1", "a=1@", "a=1@soon"] {
            assert!(assign(bad).is_err(), "{bad:?}");
        }
    }
}
