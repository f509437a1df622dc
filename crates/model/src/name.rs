//! Names as the author wrote them.
//!
//! All other files of the document use this one; it knows places only.

use crate::{Place, Span};

/// A name with its place. Text without back-ticks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// As the author wrote it.
    pub text: Box<str>,
    /// Where it stands.
    pub at: Place,
}

impl Name {
    /// A name at a place.
    pub fn new(text: impl Into<Box<str>>, at: Span) -> Name {
        Name { text: text.into(), at: at.into() }
    }
}

/// The number in the name of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Index<'n> {
    /// `Axis[3]`.
    Number(i64),
    /// `Axis[i + 1]`, `Axis[i]`: a parameter, and the number added to it.
    Parameter(&'n str, i64),
}

/// Takes the name of an instance of a range apart: the chart with parameters, and the number. None for other names, and
/// for a number that is written in another way (`Axis[03]`), since a name has one spelling.
pub fn instance_of(name: &str) -> Option<(&str, Index<'_>)> {
    let (chart, inner) = name.strip_suffix(']')?.rsplit_once('[')?;
    let whole = |text: &str| text.parse::<i64>().ok().filter(|n| n.to_string() == text);
    let index = match whole(inner) {
        Some(number) => Index::Number(number),
        None => {
            let mut parts = inner.split(' ');
            let parameter = parts.next()?;
            let added = match (parts.next(), parts.next(), parts.next()) {
                (None, ..) => 0,
                (Some("+"), Some(n), None) => whole(n).filter(|n| *n >= 0)?,
                (Some("-"), Some(n), None) => -whole(n).filter(|n| *n >= 0)?,
                _ => return None,
            };
            let plain = |c: char| c.is_alphanumeric() || c == '_';
            if !parameter.starts_with(|c: char| !c.is_numeric()) || !parameter.chars().all(plain) {
                return None;
            }
            Index::Parameter(parameter, added)
        }
    };
    (!chart.is_empty()).then_some((chart, index))
}

/// A name without the index or the place of indexes that it may have, and these: `a` and `[2]` of `a[2]`.
pub fn bare(name: &str) -> (&str, &str) {
    name.split_at(name.find('[').unwrap_or(name.len()))
}

/// A name with the place of so many indexes: `m[,]` for `m` and 2, see [`crate::ExprKind::Element`].
pub fn with_slot(name: &str, indexes: usize) -> String {
    match indexes {
        0 => name.to_owned(),
        n => format!("{name}[{}]", ",".repeat(n - 1)),
    }
}

/// Takes the place of indexes off a name in the path of a member: `m` and 2 for `m[,]`, see
/// [`crate::ExprKind::Element`].
pub fn slot_of(name: &str) -> Option<(&str, usize)> {
    let (bare, commas) = name.strip_suffix(']')?.rsplit_once('[')?;
    commas.bytes().all(|b| b == b',').then_some((bare, commas.len() + 1))
}

/// The chart in a name: `Axis` of `Axis[3]`, otherwise the whole name.
pub fn chart_in(name: &str) -> &str {
    instance_of(name).map_or(name, |(chart, _)| chart)
}

/// A direct address in the form of the tables: upper case, `%IX0.1` as `I0.1`.
pub fn normal_address(text: &str) -> String {
    let upper = text.trim_start_matches('%').to_ascii_uppercase();
    let bytes = upper.as_bytes();
    if let [b'I' | b'Q' | b'M', b'X', b'0'..=b'9', ..] = bytes {
        let (area, rest) = upper.split_at(1);
        return format!("{area}{}", rest.trim_start_matches('X'));
    }
    upper
}
