//! Conversions between STRING and the types whose literals have a `#`, written from the rule (IEC 61131-3:2003, table 22;
//! decision 65). The calendar, the units and the words are those of `g7-model`, which has tests of its own.

use g7_model::{Nanos, Type};

use super::value::{NaiveFault, Run, Typed, Value};

/// The text of a value; None if literals of the type have no `#`.
pub(super) fn written(from: Type, v: &Value) -> Option<String> {
    match (from, v) {
        (Type::Moment(moment), Value::Time(t)) => {
            let [word, ..] = moment.words();
            Some(format!("{word}#{}", moment.text(Nanos::new(*t))))
        }
        (Type::Time, Value::Time(t)) => {
            let mut left = i128::from(*t).abs();
            let mut text = String::from(if *t < 0 { "T#-" } else { "T#" });
            for (unit, size) in Nanos::UNITS {
                let nanos = i128::from(size.count());
                if left >= nanos {
                    text.push_str(&format!("{}{unit}", left / nanos));
                    left %= nanos;
                }
            }
            Some(if *t == 0 { "T#0s".to_owned() } else { text })
        }
        (bits, Value::Int(n)) if bits.is_bits() => {
            let digits = bits.elementary().map_or(0, |row| usize::from(row.bits) / 4);
            Some(format!("16#{n:0digits$X}"))
        }
        _ => None,
    }
}

/// The value of a text; None if literals of the type have no `#`.
pub(super) fn read(text: &str, to: Type) -> Option<Run<Typed>> {
    match to {
        Type::Moment(moment) => Some(behind(text, moment.words()).and_then(|t| match moment.read(t) {
            Ok(t) => Ok(Typed::of(to, Value::Time(t.count()))),
            Err(why) if why.contains("1677-09-22") => Err(NaiveFault::Overflow),
            Err(_) => Err(NaiveFault::Index),
        })),
        Type::Time => Some(behind(text, Nanos::WORDS).and_then(duration)),
        bits if bits.is_bits() => Some(whole(text, bits).ok_or(NaiveFault::Index)),
        _ => None,
    }
}

fn behind<'t>(text: &'t str, words: [&str; 4]) -> Run<&'t str> {
    match text.split_once('#') {
        None => Ok(text),
        Some((word, rest)) if words.iter().any(|w| *w == word || w.to_lowercase() == word) => Ok(rest),
        Some(_) => Err(NaiveFault::Index),
    }
}

fn duration(text: &str) -> Run<Typed> {
    let (sign, mut rest) = text.strip_prefix('-').map_or((1, text), |rest| (-1, rest));
    let (mut sum, mut from) = (0i128, 0);
    while !rest.is_empty() {
        let number = rest.find(|c: char| !c.is_ascii_digit() && c != '.').ok_or(NaiveFault::Index)?;
        let (number, behind) = rest.split_at(number);
        let letters = behind.find(|c: char| !c.is_ascii_lowercase()).unwrap_or(behind.len());
        let (unit, behind) = behind.split_at(letters);
        let place = Nanos::UNITS.iter().position(|(name, _)| *name == unit).ok_or(NaiveFault::Index)?;
        if place < from {
            return Err(NaiveFault::Index);
        }
        (from, rest) = (place + 1, behind);
        let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
        if fraction.len() > 9 || fraction.contains('.') {
            return Err(NaiveFault::Index);
        }
        let digits = |d: &str| d.parse::<i128>().map_err(|_| NaiveFault::Index);
        let nanos = i128::from(Nanos::UNITS[place].1.count());
        sum += digits(whole)? * nanos + digits(&format!("{fraction:0<9}"))? * nanos / 1_000_000_000;
    }
    if from == 0 {
        return Err(NaiveFault::Index);
    }
    let t = i64::try_from(sign * sum).map_err(|_| NaiveFault::Overflow)?;
    Ok(Typed::of(Type::Time, Value::Time(t)))
}

fn whole(text: &str, to: Type) -> Option<Typed> {
    let n = match text.strip_prefix("16#") {
        Some(digits) if digits.len() <= 16 => u64::from_str_radix(digits, 16).ok()?,
        Some(_) => return None,
        None => text.parse::<u64>().ok()?,
    };
    let most = to.bounds().map(|(_, most)| most)?;
    (i128::from(n) <= most).then(|| Typed::of(to, Value::Int(i128::from(n))))
}
