//! Values as texts, and as fields of JSON objects.

use serde_json::{Map, Value};

use crate::value::{Holds, Raw, Scaling};

/// The words of a BOOL, in any case of letters.
const WORDS: [(&str, bool); 6] =
    [("true", true), ("false", false), ("1", true), ("0", false), ("on", true), ("off", false)];
/// Characters of a payload that a message to the engineer shows.
const SHOWN: usize = 40;

/// Reads the value of an input from a payload.
///
/// # Errors
///
/// A few words that say why it has none.
pub(super) fn read(payload: &[u8], field: Option<&str>, scaling: &Scaling) -> Result<Raw, String> {
    let text = std::str::from_utf8(payload).map_err(|_| "the message is no text".to_owned())?;
    let Some(field) = field else { return of_text(text, scaling) };
    let json: Value = serde_json::from_str(text).map_err(|_| format!("{} is no JSON", shown(text)))?;
    let found = if field.starts_with('/') { json.pointer(field) } else { json.get(field) };
    match found {
        None => Err(format!("the message has no field `{field}`")),
        Some(Value::String(text)) => of_text(text, scaling),
        Some(Value::Bool(on)) if scaling.holds == Holds::Bit => Ok(Raw::Bit(*on)),
        Some(Value::Number(number)) => of_text(&number.to_string(), scaling),
        Some(other) => Err(format!("{} is no value of the variable", shown(&other.to_string()))),
    }
}

fn of_text(text: &str, scaling: &Scaling) -> Result<Raw, String> {
    let word = text.trim();
    if scaling.holds == Holds::Bit {
        let found = WORDS.iter().find(|(name, _)| name.eq_ignore_ascii_case(word));
        return found.map(|(_, on)| Raw::Bit(*on)).ok_or_else(|| format!("{} is no BOOL", shown(text)));
    }
    if let Ok(whole) = word.parse::<i128>() {
        return Ok(Raw::Whole(whole));
    }
    // Rust reads the words `inf` and `nan` as well, which are no numbers of a machine.
    let real = word.parse::<f64>().ok().filter(|x| x.is_finite());
    real.map(Raw::Real).ok_or_else(|| format!("{} is no number", shown(text)))
}

/// A payload in quotes, shortened, on one line.
fn shown(text: &str) -> String {
    let mut short: String = text.chars().take(SHOWN).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    format!("{short:?}")
}

/// The payload of an output.
pub(super) fn write(raw: Raw, field: Option<&str>, scaling: &Scaling) -> Vec<u8> {
    let Some(field) = field else { return text(raw, scaling).into_bytes() };
    let value = match raw {
        Raw::Bit(on) => Value::Bool(on),
        // The text of a number is one of JSON as well.
        Raw::Whole(_) | Raw::Real(_) => serde_json::from_str(&text(raw, scaling)).unwrap_or(Value::Null),
    };
    let keys: Vec<String> = match field.strip_prefix('/') {
        Some(pointer) => pointer.split('/').map(|k| k.replace("~1", "/").replace("~0", "~")).collect(),
        None => vec![field.to_owned()],
    };
    let nested = |inner: Value, key: String| Value::Object(Map::from_iter([(key, inner)]));
    keys.into_iter().rev().fold(value, nested).to_string().into_bytes()
}

fn text(raw: Raw, scaling: &Scaling) -> String {
    match raw {
        Raw::Bit(on) => if on { "TRUE" } else { "FALSE" }.to_owned(),
        Raw::Whole(n) => n.to_string(),
        // The shortest text that gives the same REAL again.
        Raw::Real(x) if scaling.holds == Holds::Single => (x as f32).to_string(),
        Raw::Real(x) => x.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use g7_host::Kind;

    use super::*;

    fn scaling(kind: Kind, holds: Holds) -> Scaling {
        Scaling { kind, holds, inverted: false, scale: 1.0, offset: 0.0 }
    }

    fn bit() -> Scaling {
        scaling(Kind::Bool, Holds::Bit)
    }

    fn number() -> Scaling {
        scaling(Kind::Lreal, Holds::Double)
    }

    #[test]
    fn plain_texts_are_read() {
        let cases: &[(&str, Scaling, Result<Raw, &str>)] = &[
            ("TRUE", bit(), Ok(Raw::Bit(true))),
            ("false", bit(), Ok(Raw::Bit(false))),
            ("1", bit(), Ok(Raw::Bit(true))),
            ("0\n", bit(), Ok(Raw::Bit(false))),
            (" On ", bit(), Ok(Raw::Bit(true))),
            ("OFF", bit(), Ok(Raw::Bit(false))),
            ("2", bit(), Err("\"2\" is no BOOL")),
            ("", bit(), Err("\"\" is no BOOL")),
            ("12", number(), Ok(Raw::Whole(12))),
            ("-12", number(), Ok(Raw::Whole(-12))),
            ("18446744073709551615", number(), Ok(Raw::Whole(u64::MAX.into()))),
            ("2.5", number(), Ok(Raw::Real(2.5))),
            ("1e3", number(), Ok(Raw::Real(1000.0))),
            ("TRUE", number(), Err("\"TRUE\" is no number")),
            ("", number(), Err("\"\" is no number")),
            ("nan", number(), Err("\"nan\" is no number")),
            ("-inf", number(), Err("\"-inf\" is no number")),
            ("1e999", number(), Err("\"1e999\" is no number")),
            ("2,5", number(), Err("\"2,5\" is no number")),
            ("{\"value\":1}", number(), Err("\"{\\\"value\\\":1}\" is no number")),
        ];
        for (text, scaling, expected) in cases {
            let read = read(text.as_bytes(), None, scaling);
            assert_eq!(read.as_ref().map_err(String::as_str), expected.as_ref().map_err(|e| *e), "{text}");
        }
        assert_eq!(read(b"\xff", None, &number()), Err("the message is no text".to_owned()));
    }

    #[test]
    fn fields_are_read() {
        let text = r#"{"value":2.5,"on":true,"word":"ON","none":null,"deep":{"a/b":[7]},"/odd":3}"#;
        let cases: &[(&str, Scaling, Result<Raw, &str>)] = &[
            ("value", number(), Ok(Raw::Real(2.5))),
            ("/value", number(), Ok(Raw::Real(2.5))),
            ("on", bit(), Ok(Raw::Bit(true))),
            ("word", bit(), Ok(Raw::Bit(true))),
            ("/deep/a~1b/0", number(), Ok(Raw::Whole(7))),
            ("on", number(), Err("\"true\" is no value of the variable")),
            ("value", bit(), Err("\"2.5\" is no BOOL")),
            ("none", number(), Err("\"null\" is no value of the variable")),
            ("deep", number(), Err("\"{\\\"a/b\\\":[7]}\" is no value of the variable")),
            ("absent", number(), Err("the message has no field `absent`")),
            ("/odd", number(), Err("the message has no field `/odd`")),
        ];
        for (field, scaling, expected) in cases {
            let read = read(text.as_bytes(), Some(field), scaling);
            assert_eq!(read.as_ref().map_err(String::as_str), expected.as_ref().map_err(|e| *e), "{field}");
        }
        assert_eq!(read(b"12", Some("value"), &number()), Err("the message has no field `value`".to_owned()));
        assert_eq!(read(b"{", Some("value"), &number()), Err("\"{\" is no JSON".to_owned()));
    }

    #[test]
    fn outputs_are_written_and_read_again() {
        let single = scaling(Kind::Real, Holds::Single);
        let cases: &[(Raw, Option<&str>, Scaling, &str)] = &[
            (Raw::Bit(true), None, bit(), "TRUE"),
            (Raw::Bit(false), None, bit(), "FALSE"),
            (Raw::Whole(-7), None, number(), "-7"),
            (Raw::Real(f64::from(0.1f32)), None, single, "0.1"),
            (Raw::Real(0.1), None, number(), "0.1"),
            (Raw::Real(3.0), None, number(), "3"),
            (Raw::Bit(true), Some("on"), bit(), "{\"on\":true}"),
            (Raw::Real(0.5), Some("/a/b~1c"), number(), "{\"a\":{\"b/c\":0.5}}"),
        ];
        for (raw, field, scaling, expected) in cases {
            let written = write(*raw, *field, scaling);
            assert_eq!(String::from_utf8_lossy(&written), *expected);
            let again = read(&written, *field, scaling).expect("it is a value");
            assert_eq!(scaling.word(again), scaling.word(*raw), "{expected}");
        }
    }

    #[test]
    fn no_bytes_make_it_panic_or_a_long_text() {
        let long = "x".repeat(100_000);
        let why = read(long.as_bytes(), None, &number()).expect_err("no number");
        assert!(why.len() < 100, "{why}");
        let deep = "[".repeat(100_000);
        read(deep.as_bytes(), Some("a"), &number()).expect_err("no JSON");
        let whole = br#"{"a":{"b":[1.5e3,"\u00e9",true]}}"#;
        for end in 0..whole.len() {
            for byte in [0, 0xff, b'{', b'"'] {
                let bytes = [&whole[..end], &[byte], &whole[end..]].concat();
                for field in [None, Some("a"), Some("/a/b/0"), Some("")] {
                    read(&bytes, field, &number()).ok();
                    read(&bytes, field, &bit()).ok();
                }
            }
        }
    }
}
