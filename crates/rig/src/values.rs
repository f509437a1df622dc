//! Reads values that users type: on the command line, in the terminal view, in the page; and shows values.

use g7_compile::Held;
use g7_host::{Kind, Value};
use g7_model::{Moment, Nanos, Said, say};

use crate::Item;

/// Reads a duration such as `1h30m`, `2.5s` or `500ms`. It must be more than 0; 0 itself is written
/// `0s`.
///
/// # Errors
///
/// A text that says what was expected.
pub fn duration(text: &str) -> Result<Nanos, Said> {
    let bad = || say!("expected a duration such as `10ms`, `2.5s` or `1h30m`");
    let text = text.trim();
    let text = text.strip_prefix("T#").or(text.strip_prefix("t#")).unwrap_or(text);
    let mut left = text.replace('_', "");
    let mut total: i128 = 0;
    if left.is_empty() {
        return Err(bad());
    }
    while !left.is_empty() {
        let digits = left.find(|c: char| !c.is_ascii_digit() && c != '.').ok_or_else(bad)?;
        let (number, rest) = left.split_at(digits);
        let letters = rest.find(|c: char| !c.is_alphabetic()).unwrap_or(rest.len());
        let (unit, rest) = rest.split_at(letters);
        total += part(number, unit).ok_or_else(bad)?;
        left = rest.to_owned();
    }
    i64::try_from(total).map(Nanos::new).map_err(|_| say!("this duration is too long"))
}

/// Converts a number with a unit exactly; `None` if it has a fraction of a nanosecond.
fn part(number: &str, unit: &str) -> Option<i128> {
    let unit: i128 = match unit.to_ascii_lowercase().as_str() {
        "min" => Nanos::MINUTE,
        "µs" => Nanos::MICROSECOND,
        name => Nanos::UNITS.iter().find(|(unit, _)| *unit == name)?.1,
    }
    .count()
    .into();
    let (whole, decimals) = number.split_once('.').unwrap_or((number, ""));
    if whole.is_empty() || whole.len() > 18 || decimals.len() > 18 || decimals.contains('.') {
        return None;
    }
    let mut ns = whole.parse::<i128>().ok()? * unit;
    if !decimals.is_empty() {
        let scaled = decimals.parse::<i128>().ok()? * unit;
        let scale = 10i128.pow(decimals.len() as u32);
        if scaled % scale != 0 {
            return None;
        }
        ns += scaled / scale;
    }
    Some(ns)
}

/// Reads a value of a kind; `true`, `on` and `1` are TRUE.
///
/// # Errors
///
/// A text that says what was expected.
pub fn read(text: &str, kind: Kind) -> Result<Value, Said> {
    let plain = text.trim();
    let number = plain.replace('_', "");
    match kind {
        Kind::Bool => match plain.to_ascii_lowercase().as_str() {
            "1" | "true" | "on" => Ok(Value::Word(1)),
            "0" | "false" | "off" => Ok(Value::Word(0)),
            _ => Err(say!("`{plain}` is not a BOOL: write TRUE or FALSE")),
        },
        Kind::Int { bits, signed } => {
            let value: i128 = number.parse().map_err(|_| say!("`{plain}` is not a whole number"))?;
            let bits = u32::from(bits.clamp(1, 64));
            let (least, most) = if signed {
                (-(1i128 << (bits - 1)), (1i128 << (bits - 1)) - 1)
            } else {
                (0, (1i128 << bits) - 1)
            };
            if value < least || value > most {
                let range = Said::foreign(format!("{least} .. {most}"));
                return Err(say!("`{plain}` is outside {range}"));
            }
            Ok(Value::Word(value as u64))
        }
        Kind::Real => number
            .parse::<f32>()
            .map(|x| Value::Word(u64::from(x.to_bits())))
            .map_err(|_| say!("`{plain}` is not a number")),
        Kind::Lreal => number
            .parse::<f64>()
            .map(|x| Value::Word(x.to_bits()))
            .map_err(|_| say!("`{plain}` is not a number")),
        Kind::Moment(moment) => {
            let own = |word: &str| Moment::of_literal(&word.to_ascii_uppercase()) == Some(moment);
            let text = plain.split_once('#').filter(|(word, _)| own(word)).map_or(plain, |(_, text)| text);
            moment.read(text).map(|time| Value::Word(time.count() as u64))
        }
        Kind::Time => duration(plain).map(|time| Value::Word(time.count() as u64)),
        Kind::Text => {
            let inner = plain.strip_prefix('\'').and_then(|t| t.strip_suffix('\''));
            Ok(Value::Text(inner.unwrap_or(text).into()))
        }
    }
}

/// A value as text for the user; numbers have at most four decimals.
pub fn shown(value: &Value, kind: Kind) -> String {
    let real = matches!(kind, Kind::Real | Kind::Lreal);
    let x = value.number(kind);
    if !real || !x.is_finite() || x != 0.0 && !(1e-3..1e9).contains(&x.abs()) {
        return value.show(kind);
    }
    let text = format!("{x:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

impl Item {
    /// Reads a value as users type it: of an enumeration its name, with or without the name of the type, or its number.
    ///
    /// # Errors
    ///
    /// A text that says what was expected.
    pub fn read(&self, text: &str) -> Result<Value, Said> {
        let Some(held) = &self.held else { return read(text, self.kind) };
        let plain = text.trim();
        let bare = plain.rsplit_once('.').map_or(plain, |(_, name)| name);
        if let Some(number) = held.number_of(bare) {
            return Ok(Value::Word(number as u64));
        }
        let names = Said::foreign(held.names().collect::<Vec<_>>().join(", "));
        let value = read(text, self.kind);
        match (&**held, value) {
            (_, Ok(value)) if self.admits(&value) => Ok(value),
            (Held::Range(least, most), Ok(_)) => {
                let range = Said::foreign(format!("{least} .. {most}"));
                Err(say!("`{plain}` is outside {range}"))
            }
            (Held::Range(..), Err(why)) => Err(why),
            (Held::Names(..), _) => Err(say!("`{}` is one of {names}", self.name)),
        }
    }

    /// True if the item can have the value.
    pub fn admits(&self, value: &Value) -> bool {
        self.held.as_ref().is_none_or(|held| held.admits(value.number(self.kind) as i128))
    }

    /// A value as text for the user: of an enumeration its name.
    pub fn show(&self, value: &Value) -> String {
        let name = self.held.as_ref().and_then(|held| held.name_of(value.number(self.kind) as i128));
        name.map_or_else(|| shown(value, self.kind), str::to_owned)
    }

    /// Its type as the text declares it: `INT`, `INT(0..100)`, `Mode`.
    pub fn declared(&self) -> String {
        self.held.as_ref().map_or_else(|| self.ty.to_string(), |held| held.declared(self.ty))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_exact_or_refused() {
        assert_eq!(duration("1h30m"), Ok(Nanos::HOUR + Nanos::MINUTE * 30));
        assert_eq!(duration("2.5s"), Ok(Nanos::from_millis(2_500)));
        assert_eq!(duration("T#1m_30s"), Ok(Nanos::SECOND * 90));
        assert_eq!(duration("0.1us"), Ok(Nanos::new(100)));
        assert_eq!(duration("1d"), Ok(Nanos::DAY));
        for bad in ["", "5", "s", "5x", "-1s", "1.5ns", "1..5s", "999999d999999999999d", "1e3s", "5 s"] {
            assert!(duration(bad).is_err(), "{bad:?}");
        }
    }

    #[test]
    fn values_are_read_by_their_kind_and_range() {
        let int = Kind::Int { bits: 16, signed: true };
        assert_eq!(read("-3", int), Ok(Value::Word(-3i64 as u64)));
        assert_eq!(read("32767", int), Ok(Value::Word(32767)));
        assert!(read("32768", int).is_err());
        assert_eq!(
            read("18446744073709551615", Kind::Int { bits: 64, signed: false }),
            Ok(Value::Word(u64::MAX))
        );
        assert_eq!(read("on", Kind::Bool), Ok(Value::Word(1)));
        assert!(read("2", Kind::Bool).is_err());
        assert_eq!(read("0.1", Kind::Real), Ok(Value::Word(u64::from(0.1f32.to_bits()))));
        assert_eq!(read("1.5s", Kind::Time), Ok(Value::Word(1_500_000_000)));
        let day = Nanos::DAY.count() as u64;
        for text in ["1970-01-02", "D#1970-01-02", " date#1970-01-02"] {
            assert_eq!(read(text, Kind::Moment(Moment::Date)), Ok(Value::Word(day)), "{text}");
        }
        assert_eq!(read("TOD#0:00:00.5", Kind::Moment(Moment::Tod)), Ok(Value::Word(500_000_000)));
        assert_eq!(
            read("1970-01-02-00:00:01", Kind::Moment(Moment::Dt)),
            Ok(Value::Word(day + 1_000_000_000))
        );
        assert!(read("DT#1970-01-02", Kind::Moment(Moment::Date)).is_err());
        assert!(read("1970-02-30", Kind::Moment(Moment::Date)).is_err());
        assert_eq!(read("'a b'", Kind::Text), Ok(Value::Text("a b".into())));
    }
}
