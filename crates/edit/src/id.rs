//! Ids of the parts of a drawing. The page, gestures and answers use the same ones: `Chart/s/Step`,
//! `Chart/a/Step/0`, `Chart/t/3`, `Chart/l/s:Step>t:3`, `Chart/c/s:Step>t:3/leaving`, `Chart/n/0`,
//! `Chart/x/0`, and `Chart` for a chart itself.
//!
//! Any text can be a name, so `/`, `>`, `:` and `%` inside a name are written `%2F`, `%3E`, `%3A`
//! and `%25`. Reading a printed id gives the same id.

use std::fmt;
use std::str::FromStr;

/// One end of a link.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum End {
    /// A step by its name.
    Step(String),
    /// A transition by its number in the text of the chart, from 0.
    Transition(usize),
}

/// The part of a chart that an id names.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    /// The chart itself.
    Chart,
    /// A step by its name.
    Step(String),
    /// An action: its step, and its number there from 0.
    Action(String, usize),
    /// A transition by its number in the text of the chart, from 0.
    Transition(usize),
    /// A link, by its two ends.
    Link(End, End),
    /// One end of a broken link; the flag is true at the start of the link.
    Connector(End, End, bool),
    /// A comment of the layout section, by its number there from 0.
    Note(usize),
    /// A part that is only drawn, such as a title.
    Other(usize),
}

/// The id of a part of a chart.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(type = "string"))]
pub struct ItemId {
    /// The name of the chart.
    pub chart: String,
    /// The part.
    pub part: Part,
}

impl ItemId {
    /// The id of a chart.
    pub fn chart(chart: impl Into<String>) -> ItemId {
        ItemId { chart: chart.into(), part: Part::Chart }
    }

    /// The id of a step.
    pub fn step(chart: impl Into<String>, step: impl Into<String>) -> ItemId {
        ItemId { chart: chart.into(), part: Part::Step(step.into()) }
    }

    /// The id of an action of a step.
    pub fn action(chart: impl Into<String>, step: impl Into<String>, index: usize) -> ItemId {
        ItemId { chart: chart.into(), part: Part::Action(step.into(), index) }
    }

    /// The id of a transition.
    pub fn transition(chart: impl Into<String>, number: usize) -> ItemId {
        ItemId { chart: chart.into(), part: Part::Transition(number) }
    }

    /// The id of a link.
    pub fn link(chart: impl Into<String>, from: End, to: End) -> ItemId {
        ItemId { chart: chart.into(), part: Part::Link(from, to) }
    }

    /// The id of one end of a broken link.
    pub fn connector(chart: impl Into<String>, from: End, to: End, leaving: bool) -> ItemId {
        ItemId { chart: chart.into(), part: Part::Connector(from, to, leaving) }
    }

    /// The id of a comment of the layout section.
    pub fn note(chart: impl Into<String>, number: usize) -> ItemId {
        ItemId { chart: chart.into(), part: Part::Note(number) }
    }

    /// The id of a part that is only drawn.
    pub fn other(chart: impl Into<String>, number: usize) -> ItemId {
        ItemId { chart: chart.into(), part: Part::Other(number) }
    }
}

impl fmt::Display for ItemId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        escaped(f, &self.chart)?;
        match &self.part {
            Part::Chart => Ok(()),
            Part::Step(name) => {
                f.write_str("/s/")?;
                escaped(f, name)
            }
            Part::Action(step, index) => {
                f.write_str("/a/")?;
                escaped(f, step)?;
                write!(f, "/{index}")
            }
            Part::Transition(number) => write!(f, "/t/{number}"),
            Part::Link(from, to) => write!(f, "/l/{from}>{to}"),
            Part::Connector(from, to, leaving) => {
                write!(f, "/c/{from}>{to}/{}", if *leaving { "leaving" } else { "arriving" })
            }
            Part::Note(number) => write!(f, "/n/{number}"),
            Part::Other(number) => write!(f, "/x/{number}"),
        }
    }
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            End::Step(name) => {
                f.write_str("s:")?;
                escaped(f, name)
            }
            End::Transition(number) => write!(f, "t:{number}"),
        }
    }
}

/// The error for a text that is not an id.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoId(String);

impl fmt::Display for NoId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` names nothing of a chart", self.0)
    }
}

impl std::error::Error for NoId {}

impl FromStr for ItemId {
    type Err = NoId;

    fn from_str(text: &str) -> Result<ItemId, NoId> {
        read(text).ok_or_else(|| NoId(text.chars().take(80).collect()))
    }
}

fn read(text: &str) -> Option<ItemId> {
    let mut parts = text.split('/');
    let chart = unescaped(parts.next()?)?;
    let Some(kind) = parts.next() else { return Some(ItemId { chart, part: Part::Chart }) };
    let first = parts.next()?;
    let part = match kind {
        "s" => Part::Step(unescaped(first)?),
        "a" => Part::Action(unescaped(first)?, number(parts.next()?)?),
        "t" => Part::Transition(number(first)?),
        "l" => {
            let (from, to) = ends(first)?;
            Part::Link(from, to)
        }
        "c" => {
            let (from, to) = ends(first)?;
            let leaving = match parts.next()? {
                "leaving" => true,
                "arriving" => false,
                _ => return None,
            };
            Part::Connector(from, to, leaving)
        }
        "n" => Part::Note(number(first)?),
        "x" => Part::Other(number(first)?),
        _ => return None,
    };
    parts.next().is_none().then_some(ItemId { chart, part })
}

fn ends(text: &str) -> Option<(End, End)> {
    let (from, to) = text.split_once('>')?;
    Some((end(from)?, end(to)?))
}

fn end(text: &str) -> Option<End> {
    match text.split_once(':')? {
        ("s", name) => Some(End::Step(unescaped(name)?)),
        ("t", n) => Some(End::Transition(number(n)?)),
        _ => None,
    }
}

fn number(text: &str) -> Option<usize> {
    text.bytes().all(|b| b.is_ascii_digit()).then(|| text.parse().ok()).flatten()
}

fn escaped(f: &mut fmt::Formatter<'_>, name: &str) -> fmt::Result {
    if !name.contains(['/', '>', ':', '%']) {
        return f.write_str(name);
    }
    for c in name.chars() {
        match c {
            '/' => f.write_str("%2F")?,
            '>' => f.write_str("%3E")?,
            ':' => f.write_str("%3A")?,
            '%' => f.write_str("%25")?,
            _ => fmt::Write::write_char(f, c)?,
        }
    }
    Ok(())
}

fn unescaped(text: &str) -> Option<String> {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('%') {
        out.push_str(before);
        out.push(match after.get(..2)? {
            "2F" => '/',
            "3E" => '>',
            "3A" => ':',
            "25" => '%',
            _ => return None,
        });
        rest = after.get(2..)?;
    }
    if rest.contains(['>', ':']) {
        return None;
    }
    out.push_str(rest);
    Some(out)
}

impl serde::Serialize for ItemId {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl<'de> serde::Deserialize<'de> for ItemId {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<ItemId, D::Error> {
        let text = String::deserialize(from)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::{End, ItemId};

    #[test]
    fn ids_read_as_they_print() {
        let odd = "Vent på/ 3>4: 100%";
        for (id, text) in [
            (ItemId::chart("G.1"), "G.1"),
            (ItemId::step("G", "12"), "G/s/12"),
            (ItemId::step("G", odd), "G/s/Vent på%2F 3%3E4%3A 100%25"),
            (ItemId::action("G", "a.b", 2), "G/a/a.b/2"),
            (ItemId::transition("G", 0), "G/t/0"),
            (ItemId::link("G", End::Step("a>b".into()), End::Transition(3)), "G/l/s:a%3Eb>t:3"),
            (ItemId::link("G", End::Transition(3), End::Step("1".into())), "G/l/t:3>s:1"),
            (ItemId::connector("G", End::Transition(3), End::Step("1".into()), true), "G/c/t:3>s:1/leaving"),
            (ItemId::note("G", 2), "G/n/2"),
            (ItemId::other("G", 7), "G/x/7"),
        ] {
            assert_eq!(id.to_string(), text);
            assert_eq!(text.parse(), Ok(id));
        }
    }

    #[test]
    fn what_is_no_id_is_refused() {
        for text in [
            "G/",
            "G/s",
            "G/s/a/b",
            "G/t/-1",
            "G/t/x",
            "G/l/s:1",
            "G/l/s:1>q:2",
            "G/s/%2",
            "G/s/%zz",
            "G/q/1",
        ] {
            assert!(text.parse::<ItemId>().is_err(), "{text}");
        }
    }
}
