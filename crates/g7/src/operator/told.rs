//! Something that happened, for the terminal and for the page.

use g7_host::Force;
use g7_online::{Forced, Happened, Mode, Reason};
use serde_json::{Value, json};

use super::names::Names;
use crate::style;

/// Something that happened to a controller.
#[derive(Clone, Debug)]
pub(crate) enum Told {
    /// The mode is another one.
    Mode(Mode),
    /// So many scans came too late and were left out.
    Missed(u64),
    /// A value is forced.
    Forced(Forced),
    /// A force was taken back.
    Released(Force),
    /// The time of a force is over.
    Ended(Force),
    /// It goes on with another chart: that before the latest change, or a new one; and what was lost.
    Changed { back: bool, lost: Vec<String> },
    /// A part of a panel was pressed, or set to a value; and by whom, where that is known.
    Moved { name: String, value: Option<String>, who: Option<String> },
    /// Something happened at a device, by number.
    Device(usize, Happened),
    /// The scan has no priority, and why.
    NoPriority(String),
    /// Values cannot be saved, and why.
    Unsaved(String),
    /// The events for a broker, by number, have trouble, or none any more.
    Events(usize, Option<String>),
    /// The history cannot be written, and why.
    Unrecorded(String),
    /// The history goes on; so many changes were lost.
    Recorded(u64),
}

/// How much an event concerns an operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Level {
    /// It is only noted.
    Note,
    /// It waits until someone has seen it.
    Warning,
    /// The same, and something has failed.
    Alarm,
}

impl Level {
    pub(crate) fn word(self) -> &'static str {
        match self {
            Level::Note => "note",
            Level::Warning => "warning",
            Level::Alarm => "alarm",
        }
    }
}

impl Told {
    pub(crate) fn level(&self, names: &Names) -> Level {
        match self {
            Told::Mode(Mode::Fault(_)) | Told::Unsaved(_) | Told::Unrecorded(_) => Level::Alarm,
            Told::Device(device, Happened::Down(_)) => match names.wired(*device) {
                Some(wired) if wired.device.kind.is_server() => Level::Warning,
                Some(_) | None => Level::Alarm,
            },
            Told::Device(_, Happened::NoInput(..) | Happened::NoOutput(..) | Happened::Note(_))
            | Told::Events(_, Some(_))
            | Told::Missed(_)
            | Told::Recorded(1..)
            | Told::Ended(_) => Level::Warning,
            Told::Mode(Mode::Run | Mode::Stop)
            | Told::Forced(_)
            | Told::Released(_)
            | Told::Changed { .. }
            | Told::Moved { .. }
            | Told::NoPriority(_)
            | Told::Events(_, None)
            | Told::Recorded(0)
            | Told::Device(..) => Level::Note,
        }
    }

    /// The thing that fails or is well again; an event of one thing ends the alarms of the same.
    pub(crate) fn thing(&self) -> Option<(&'static str, usize, usize)> {
        match self {
            Told::Mode(_) => Some(("mode", 0, 0)),
            Told::Unrecorded(_) | Told::Recorded(_) => Some(("history", 0, 0)),
            Told::Device(device, Happened::Up | Happened::Down(_)) => Some(("device", *device, 0)),
            Told::Device(device, Happened::NoInput(k, _) | Happened::Input(k)) => {
                Some(("input", *device, *k))
            }
            Told::Device(device, Happened::NoOutput(k, _) | Happened::Output(k)) => {
                Some(("output", *device, *k))
            }
            Told::Events(device, _) => Some(("events", *device, 0)),
            _ => None,
        }
    }

    /// The event for brokers: that of the page, with its level and its line.
    pub(crate) fn event(&self, names: &Names) -> Value {
        let mut event = self.json(names);
        if let Some(fields) = event.as_object_mut() {
            fields.retain(|_, value| !value.is_null());
            fields.insert("level".to_owned(), json!(self.level(names).word()));
            if let Some(text) = self.text(names) {
                let text = anstream::adapter::strip_str(&text).to_string();
                fields.insert("text".to_owned(), json!(text));
            }
        }
        event
    }

    /// The event for the page: its kind and what belongs to it.
    pub(crate) fn json(&self, names: &Names) -> Value {
        match self {
            Told::Mode(Mode::Stop) => json!({ "kind": "stop" }),
            Told::Mode(Mode::Run) => json!({ "kind": "run" }),
            Told::Mode(Mode::Fault(reason)) => {
                json!({ "kind": "fault", "reason": reason_json(names, *reason) })
            }
            Told::Missed(n) => json!({ "kind": "missed", "count": n }),
            Told::Forced(force) => {
                let (name, value) = names.value_of(*force);
                json!({ "kind": "forced", "name": name, "value": value })
            }
            Told::Released(what) => json!({ "kind": "released", "name": name(names, *what) }),
            Told::Ended(what) => json!({ "kind": "ended", "name": name(names, *what) }),
            Told::Changed { back, lost } => {
                json!({ "kind": if *back { "back" } else { "changed" }, "why": lost.join("; ") })
            }
            Told::Moved { name, value: None, who } => json!({ "kind": "pressed", "name": name, "who": who }),
            Told::Moved { name, value, who } => {
                json!({ "kind": "set", "name": name, "value": value, "who": who })
            }
            Told::NoPriority(why) => json!({ "kind": "no-priority", "why": why }),
            Told::Unsaved(why) => json!({ "kind": "unsaved", "why": why }),
            Told::Events(device, why) => {
                let kind = if why.is_some() { "no-events" } else { "events" };
                json!({ "kind": kind, "device": names.device(*device), "why": why })
            }
            Told::Unrecorded(why) => json!({ "kind": "unrecorded", "why": why }),
            Told::Recorded(lost) => json!({ "kind": "recorded", "count": lost }),
            Told::Device(device, happened) => device_json(names, *device, happened),
        }
    }

    /// The event for the terminal; `None` for one that its device does not have any more.
    pub(crate) fn text(&self, names: &Names) -> Option<String> {
        let (bad, warn) = (style::BAD, style::WARN);
        Some(match self {
            Told::Mode(mode) => mode_text(names, *mode),
            Told::Missed(1) => "1 scan came too late and was left out".to_owned(),
            Told::Missed(n) => format!("{n} scans came too late and were left out"),
            Told::Forced(force) => {
                let (name, value) = names.value_of(*force);
                format!("`{name}` is {warn}forced{warn:#} to {value} until {:.0}s", seconds(force.until))
            }
            Told::Released(what) => format!("`{}` is no longer forced", name(names, *what)),
            Told::Ended(what) => {
                format!("`{}` is no longer forced: its time is over", name(names, *what))
            }
            Told::Changed { back, lost } => {
                let which = if *back { "the chart before the change" } else { "the changed chart" };
                let lost =
                    if lost.is_empty() { String::new() } else { format!("; lost: {}", lost.join("; ")) };
                format!("goes on with {which}{lost}")
            }
            Told::Moved { name, value, who } => moved_text(name, value.as_deref(), who.as_deref()),
            Told::NoPriority(why) => format!("{warn}note:{warn:#} {why}"),
            Told::Unsaved(why) => format!("{bad}values cannot be saved:{bad:#} {why}"),
            Told::Events(device, Some(why)) => {
                format!("{}: {warn}events wait:{warn:#} {why}", names.device(*device))
            }
            Told::Events(device, None) => format!("{} takes events again", names.device(*device)),
            Told::Unrecorded(why) => format!("{bad}the history cannot be written:{bad:#} {why}"),
            Told::Recorded(0) => "the history goes on".to_owned(),
            Told::Recorded(lost) => format!("the history goes on; {warn}{lost} changes were lost{warn:#}"),
            Told::Device(device, happened) => return device_text(names, *device, happened),
        })
    }
}

fn seconds(time: g7_model::Nanos) -> f64 {
    time.count() as f64 / 1e9
}

fn name(names: &Names, what: Force) -> &str {
    names.forced(what).map_or("", |item| &item.name)
}

/// A fault for the page.
pub(crate) fn reason_json(names: &Names, reason: Reason) -> Value {
    match reason {
        Reason::Watchdog => json!({ "kind": "watchdog" }),
        Reason::Input(target) => json!({ "kind": "input", "name": names.input(target) }),
        Reason::Halt(halt) => json!({ "kind": "halt", "why": names.halt(halt) }),
    }
}

/// The mode for the terminal.
pub(crate) fn mode_text(names: &Names, mode: Mode) -> String {
    let (good, bad) = (style::GOOD, style::BAD);
    match mode {
        Mode::Stop => "stopped".to_owned(),
        Mode::Run => format!("{good}running{good:#}"),
        Mode::Fault(reason) => {
            format!("{bad}fault:{bad:#} {}; outputs are safe (`ack` ends it)", names.reason(reason))
        }
    }
}

/// The variable of an event of a device.
fn channel<'n>(names: &'n Names, device: usize, happened: &Happened) -> &'n str {
    let Some(wired) = names.wired(device) else { return "" };
    match happened {
        Happened::NoInput(k, _) | Happened::Input(k) | Happened::Written(k, ..) => {
            wired.inputs.get(*k).map_or("", |i| &i.name)
        }
        Happened::NoOutput(k, _) | Happened::Output(k) | Happened::Limited(k) => {
            wired.outputs.get(*k).map_or("", |o| &o.name)
        }
        Happened::Up | Happened::Down(_) | Happened::Note(_) => "",
    }
}

/// The deed of a person at an input, for the terminal.
fn moved_text(name: &str, value: Option<&str>, who: Option<&str>) -> String {
    let deed = match value {
        None => format!("`{name}` is pressed"),
        Some(value) => format!("`{name}` is set to {value}"),
    };
    who.map_or_else(|| deed.clone(), |who| format!("{deed}, by {who}"))
}

fn device_json(names: &Names, device: usize, happened: &Happened) -> Value {
    let server = names.wired(device).is_some_and(|wired| wired.device.kind.is_server());
    let (kind, why) = match happened {
        Happened::Up => ("up", None),
        Happened::Down(why) => ("down", Some(why.to_string())),
        Happened::NoInput(_, why) => ("no-input", Some(why.clone())),
        Happened::Input(_) => ("input", None),
        Happened::NoOutput(_, why) => ("no-output", Some(why.clone())),
        Happened::Output(_) => ("output", None),
        Happened::Limited(_) => ("limited", None),
        Happened::Note(what) => ("note", Some(what.clone())),
        Happened::Written(k, word, who) => {
            let (name, device_name) = (channel(names, device, happened), names.device(device));
            let value = names.given(device, *k, *word);
            return json!({ "kind": "set", "device": device_name, "name": name, "value": value, "who": who });
        }
    };
    let name = channel(names, device, happened);
    json!({ "kind": kind, "device": names.device(device), "master": server, "name": name, "why": why })
}

fn device_text(names: &Names, device: usize, happened: &Happened) -> Option<String> {
    let wired = names.wired(device)?;
    let (good, bad, warn) = (style::GOOD, style::BAD, style::WARN);
    let (name, server) = (names.device(device), wired.device.kind.is_server());
    let of = channel(names, device, happened);
    Some(match happened {
        Happened::Up if server => format!("{name} {good}has a master{good:#}"),
        Happened::Up => format!("{name} {good}answers{good:#}"),
        Happened::Down(why) if server => format!("{name} {warn}has no master:{warn:#} {why}"),
        Happened::Down(why) => format!("{name} {bad}does not answer:{bad:#} {why}"),
        Happened::NoInput(_, why) => format!("{name}: {warn}no value{warn:#} for `{of}`: {why}"),
        Happened::Input(_) => format!("{name}: `{of}` has a value again"),
        Happened::NoOutput(_, why) => format!("{name} {warn}refuses{warn:#} `{of}`: {why}"),
        Happened::Output(_) => format!("{name} takes `{of}` again"),
        Happened::Note(what) => format!("{name} {warn}note:{warn:#} {what}"),
        Happened::Written(k, word, who) => {
            let value = names.given(device, *k, *word);
            format!("{name}: {}", moved_text(of, Some(&value), who.as_deref()))
        }
        Happened::Limited(_) => {
            format!("{name}: {warn}`{of}` is limited{warn:#} to what its point holds")
        }
    })
}
