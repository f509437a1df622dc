//! Booleans that are named like a time operator, `2s/X202`.
//!
//! The meta-model has no time operator within a term. Its users declare a Boolean with the text of
//! the operator as its name; `naming` reads it as the operator and `write` makes one.

use g7_model::Nanos;

/// The time and the step in such a name; None for any other name.
pub(super) fn parse(name: &str) -> Option<(Nanos, &str)> {
    let (time, step) = name.split_once("/X")?;
    let (count, unit) = match time.strip_suffix("ms") {
        Some(count) => (count, Nanos::MILLISECOND),
        None => (time.strip_suffix('s')?, Nanos::SECOND),
    };
    let count = count.trim();
    let digits = !count.is_empty() && count.bytes().all(|b| b.is_ascii_digit());
    let count: i32 = digits.then(|| count.parse().ok())??;
    (!step.is_empty()).then_some((unit * i64::from(count), step))
}

/// The name that stands for a time operator; None if its time is not a whole number of milliseconds.
pub(super) fn name(time: Nanos, step: &str) -> Option<String> {
    let written = |unit, word| {
        let count = i32::try_from(time.whole(unit)?).ok().filter(|n| *n >= 0)?;
        Some(format!("{count}{word}/X{step}"))
    };
    written(Nanos::SECOND, "s").or_else(|| written(Nanos::MILLISECOND, "ms"))
}
