//! The row of a panel, and its points: what a person finds on the operator page.

use g7_model::{Nanos, Said, Span, say};

use super::catalogue::LAMPS;
use super::table::{At, Found, Table};

/// A panel on the operator page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Panel {
    /// A button is released when its page has been silent for so long.
    pub release: Nanos,
    /// A press lasts at least so long, so that no scan misses it.
    pub press: Nanos,
}

/// A part of a panel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Handle {
    /// TRUE while it is pressed.
    Button,
    /// TRUE while it is on.
    Switch,
    /// A number that a person enters.
    Number,
    /// One of some words; the value is its place, from 0.
    Choice(Vec<String>),
    /// TRUE while a page is open.
    Page,
    /// A lamp, and its colour.
    Lamp(&'static str),
    /// A value that is shown.
    Value,
}

impl Handle {
    /// True if a person moves it.
    pub fn is_input(&self) -> bool {
        !matches!(self, Handle::Lamp(_) | Handle::Value)
    }

    /// The word of the file.
    pub fn word(&self) -> &'static str {
        match self {
            Handle::Button => "button",
            Handle::Switch => "switch",
            Handle::Number => "number",
            Handle::Choice(_) => "choice",
            Handle::Page => "page",
            Handle::Lamp(_) => "lamp",
            Handle::Value => "value",
        }
    }
}

impl std::fmt::Display for Handle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Handle::Choice(words) => write!(f, "choice({})", words.join(", ")),
            Handle::Lamp(colour) => write!(f, "lamp({colour})"),
            other => write!(f, "{}()", other.word()),
        }
    }
}

/// The numbers that a person can enter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limits {
    /// The least.
    pub min: Option<At<f64>>,
    /// The greatest.
    pub max: Option<At<f64>>,
    /// The value until a person gives one.
    pub initial: Option<At<f64>>,
}

impl Limits {
    /// The place of the first setting that there is.
    pub(crate) fn first(&self) -> Option<Span> {
        [&self.min, &self.max, &self.initial].into_iter().flatten().next().map(|n| n.at)
    }
}

/// Reads the row of a panel.
pub(super) fn read(table: &mut Table<'_>, found: &mut Found) -> Panel {
    let release = table.duration(found, "release", Nanos::from_millis(300), Nanos::from_millis(10_000));
    let press = table.duration(found, "press", Nanos::from_millis(10), Nanos::from_millis(10_000));
    Panel {
        release: release.map_or(Nanos::SECOND, |time| time.value),
        press: press.map_or(Nanos::from_millis(200), |time| time.value),
    }
}

/// Reads the limits of a channel.
pub(super) fn limits(table: &mut Table<'_>, found: &mut Found) -> Limits {
    let [min, max, initial] = ["min", "max", "initial"].map(|key| table.number(found, key));
    if let (Some(min), Some(max)) = (&min, &max)
        && min.value > max.value
    {
        found
            .wrong(max.at, say!("the greatest number is less than the least"))
            .related
            .push((min.at, say!("this is the least")));
    }
    let within = |x: f64| {
        min.as_ref().is_none_or(|least| x >= least.value) && max.as_ref().is_none_or(|most| x <= most.value)
    };
    if let Some(initial) = initial.as_ref().filter(|x| !within(x.value)) {
        found.wrong(initial.at, say!("`initial` is not within `min` and `max`"));
    }
    Limits { min, max, initial }
}

/// Reads a part of a panel; `None` where no part is called so.
pub(super) fn handle(word: &str, argument: &str) -> Option<Result<Handle, Said>> {
    let plain = match word {
        "button" => Handle::Button,
        "switch" => Handle::Switch,
        "number" => Handle::Number,
        "page" => Handle::Page,
        "value" => Handle::Value,
        "choice" => return Some(choice(argument)),
        "lamp" => return Some(lamp(argument)),
        _ => return None,
    };
    Some(if argument.is_empty() { Ok(plain) } else { Err(say!("`{word}()` has no argument")) })
}

fn choice(argument: &str) -> Result<Handle, Said> {
    /// The greatest number of words that a person can look through.
    const MOST: usize = 32;
    let words: Vec<String> = argument.split(',').map(|word| word.trim().to_owned()).collect();
    if words.len() < 2 || words.len() > MOST || words.iter().any(String::is_empty) {
        return Err(say!("a choice is among 2 to {MOST} words: `choice(A1, F1, F4)`"));
    }
    let twice = words.iter().enumerate().find(|(k, word)| words.iter().take(*k).any(|w| w == *word));
    match twice {
        Some((_, word)) => Err(say!("the choice has `{word}` twice")),
        None => Ok(Handle::Choice(words)),
    }
}

fn lamp(argument: &str) -> Result<Handle, Said> {
    let colour = match argument {
        "" => LAMPS.first(),
        colour => LAMPS.iter().find(|known| **known == colour),
    };
    let colour = colour.ok_or_else(|| say!("a lamp is {}", Said::foreign(LAMPS.join(", "))))?;
    Ok(Handle::Lamp(colour))
}
