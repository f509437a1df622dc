//! Constants of the languages (numbers, durations and strings): how they are read and written.

use g7_model::{Literal, Moment, Nanos, Said, Type, say};
use std::fmt::Write;

/// The type before the `#` of a literal, in upper or lower case: of `INT#5`, `T#5s`, `D#2026-11-28`.
pub fn literal_type(word: &str) -> Option<Type> {
    let upper = word.to_ascii_uppercase();
    if Nanos::WORDS.contains(&&*upper) {
        return Some(Type::Time);
    }
    if let Some(moment) = Moment::of_literal(&upper) {
        return Some(Type::Moment(moment));
    }
    let ty = type_named(word)?;
    (ty.is_integer() || ty.is_bits() || ty.is_real() || ty == Type::Bool).then_some(ty)
}

/// A type by its name, in upper or in lower case.
pub fn type_named(word: &str) -> Option<Type> {
    if word.bytes().any(|b| b.is_ascii_lowercase()) {
        let lower = !word.bytes().any(|b| b.is_ascii_uppercase());
        return lower.then(|| word.to_ascii_uppercase()).and_then(|upper| Type::named(&upper));
    }
    Type::named(word)
}

/// `12`, `1_000`, `16#FF`.
pub fn integer(text: &str) -> Result<i128, Said> {
    let (base, digits) = match text.split_once('#') {
        Some((base, digits)) => (base, digits),
        None => ("10", text),
    };
    let base = match base {
        "2" => 2,
        "8" => 8,
        "10" => 10,
        "16" => 16,
        _ => return Err(say!("`{base}` is no base of a number; there are 2#, 8#, 10# and 16#")),
    };
    let mut value: i128 = 0;
    let mut any = false;
    for c in digits.chars().filter(|c| *c != '_') {
        let digit = c.to_digit(base).ok_or_else(|| say!("`{c}` is no digit of base {base}"))?;
        value = value * i128::from(base) + i128::from(digit);
        any = true;
        if value > i128::from(u64::MAX) {
            return Err(say!("the number does not fit into 64 bits"));
        }
    }
    if any { Ok(value) } else { Err(say!("digits are missing")) }
}

/// A real number without `_`, as the model keeps it.
pub fn real(text: &str) -> Result<Box<str>, Said> {
    let plain: String = text.chars().filter(|c| *c != '_').collect();
    match plain.parse::<f64>() {
        Ok(v) if v.is_finite() => Ok(plain.into()),
        Ok(_) => Err(say!("the number is larger than LREAL can hold")),
        Err(_) => Err(say!("this is no real number")),
    }
}

/// `INT#5`, `REAL#2`, `BOOL#1`, `D#2026-11-28`.
pub fn typed(text: &str) -> Result<Literal, Said> {
    let (word, value) = text.split_once('#').ok_or(say!("`#` is missing"))?;
    let ty = literal_type(word).ok_or(say!("this type has no such literals"))?;
    if let Type::Moment(moment) = ty {
        return moment.read(value).map(|time| Literal::Moment(moment, time));
    }
    if ty == Type::Time {
        return duration(value).map(Literal::Time);
    }
    if ty == Type::Bool {
        return match value {
            "1" | "TRUE" | "true" => Ok(Literal::Bool(true)),
            "0" | "FALSE" | "false" => Ok(Literal::Bool(false)),
            _ => Err(say!("a BOOL is 0, 1, FALSE or TRUE")),
        };
    }
    if ty.is_real() {
        return Ok(Literal::Real(real(value.strip_prefix('+').unwrap_or(value))?, Some(ty)));
    }
    let (negative, digits) = match value.strip_prefix('-') {
        Some(digits) => (true, digits),
        None => (false, value.strip_prefix('+').unwrap_or(value)),
    };
    let value = integer(digits)?;
    let value = if negative { -value } else { value };
    match ty.bounds() {
        Some((least, most)) if value < least || value > most => {
            Err(say!("{value} is no {ty}: it holds {least} to {most}"))
        }
        _ => Ok(Literal::Int(value, Some(ty))),
    }
}

/// `1h30m`, `2.5s`, `T#5s`.
pub fn duration(text: &str) -> Result<Nanos, Said> {
    let body = text.split_once('#').map_or(text, |(_, body)| body);
    let (negative, mut rest) = match body.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, body.strip_prefix('+').unwrap_or(body)),
    };
    let mut total: i128 = 0;
    let mut unit_before = 0;
    let mut fraction_before = false;
    if rest.is_empty() {
        return Err(say!("the duration has no number"));
    }
    while !rest.is_empty() {
        let (number, after) = split(rest, |c| c.is_ascii_digit() || c == '.' || c == '_');
        let (unit, after) = split(after, |c| c.is_ascii_alphabetic());
        let place = Nanos::UNITS.iter().position(|(name, _)| unit.eq_ignore_ascii_case(name));
        let Some((place, (_, size))) = place.and_then(|p| Some((p, Nanos::UNITS.get(p)?))) else {
            return Err(match (number, unit) {
                ("", _) => say!("the duration has no number before its unit"),
                (_, "") => say!("the duration has no unit behind its last number"),
                _ => say!("`{unit}` is no unit of time; there are d, h, m, s, ms, us and ns"),
            });
        };
        if fraction_before {
            return Err(say!("only the last number of a duration can have a fraction"));
        }
        if unit_before > place {
            return Err(say!("the units of a duration go from large to small"));
        }
        unit_before = place + 1;
        fraction_before = number.contains('.');
        total += amount(number, i128::from(size.count()))?;
        if total > i128::from(i64::MAX) {
            return Err(say!("the duration is too long: at most 106751 days"));
        }
        rest = after.strip_prefix('_').unwrap_or(after);
    }
    let total = if negative { -total } else { total };
    i64::try_from(total).map(Nanos::new).map_err(|_| say!("the duration is too long: at most 106751 days"))
}

fn split(text: &str, mut belongs: impl FnMut(char) -> bool) -> (&str, &str) {
    text.split_at(text.find(|c| !belongs(c)).unwrap_or(text.len()))
}

/// A number, perhaps with a fraction, times a unit; the result is exact.
fn amount(number: &str, unit: i128) -> Result<i128, Said> {
    let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
    let too_long = || say!("the duration is too long: at most 106751 days");
    let mut value: i128 = 0;
    let mut any = false;
    for c in whole.chars().filter(|c| *c != '_') {
        let digit = c.to_digit(10).ok_or(say!("a duration has one point at most"))?;
        value = value * 10 + i128::from(digit);
        any = true;
        if value > i128::from(i64::MAX) {
            return Err(too_long());
        }
    }
    if !any {
        return Err(say!("the duration has no number before its unit"));
    }
    let mut total = value.checked_mul(unit).ok_or_else(too_long)?;
    let mut part = unit;
    for c in fraction.chars().filter(|c| *c != '_') {
        let digit = i128::from(c.to_digit(10).ok_or(say!("a duration has one point at most"))?);
        if part % 10 != 0 && digit != 0 {
            return Err(say!("the duration is finer than one nanosecond"));
        }
        part /= 10;
        total += digit * part;
    }
    Ok(total)
}

/// Removes the quotes and escapes of a string. The second value describes an escape that is not
/// understood. `$C3$A4` is one letter: bytes above 127 that together are UTF-8 are read as it,
/// others as the letters of Latin-1 with these numbers.
pub fn unquote_st(text: &str) -> (String, Option<Said>) {
    let inner = text.strip_prefix('\'').unwrap_or(text);
    let inner = inner.strip_suffix('\'').unwrap_or(inner);
    let mut out = String::with_capacity(inner.len());
    let mut wrong = None;
    let mut high = Vec::new();
    let mut chars = inner.chars();
    while let Some(c) = chars.next() {
        let code = if c == '$' { hexadecimal(chars.as_str()) } else { None };
        if let Some(byte) = code {
            chars.nth(1);
            if byte > 127 {
                high.push(byte);
                continue;
            }
        }
        letters(&mut high, &mut out);
        if let Some(byte) = code {
            out.push(char::from(byte));
            continue;
        }
        if c != '$' {
            out.push(c);
            continue;
        }
        match chars.next() {
            Some(c @ ('$' | '\'')) => out.push(c),
            Some('n' | 'N' | 'l' | 'L') => out.push('\n'),
            Some('r' | 'R') => out.push('\r'),
            Some('t' | 'T') => out.push('\t'),
            Some('p' | 'P') => out.push('\u{c}'),
            Some(other) => wrong = Some(say!("`${other}` is no escape; a dollar sign is written `$$`")),
            None => wrong = Some(say!("a `$` stands before the end of the text; write `$$`")),
        }
    }
    letters(&mut high, &mut out);
    (out, wrong)
}

/// The byte of the two hexadecimal digits at the beginning of a text.
fn hexadecimal(text: &str) -> Option<u8> {
    let mut digits = text.chars().map(|c| c.to_digit(16));
    let (first, second) = (digits.next()??, digits.next()??);
    u8::try_from(first * 16 + second).ok()
}

/// Adds escaped bytes above 127 as letters.
fn letters(bytes: &mut Vec<u8>, out: &mut String) {
    match std::str::from_utf8(bytes) {
        Ok(text) => out.push_str(text),
        Err(_) => out.extend(bytes.iter().copied().map(char::from)),
    }
    bytes.clear();
}

/// A string of Structured Text with its quotes.
pub fn quote_st(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('\'');
    for c in text.chars() {
        match c {
            '$' => out.push_str("$$"),
            '\'' => out.push_str("$'"),
            '\n' => out.push_str("$n"),
            '\r' => out.push_str("$r"),
            '\t' => out.push_str("$t"),
            c if c.is_ascii_control() => {
                let _ = write!(out, "${:02X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('\'');
    out
}
