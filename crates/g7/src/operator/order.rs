//! A wish of a person, from a line or from the page.

use std::sync::Arc;

use g7_model::Nanos;
use g7_online::USUAL;
use g7_store::users::Role;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tokio::sync::oneshot;

use crate::serve::outbox::Outbox;
use crate::values;
use crate::who::Who;

/// The name under which outboxes keep the frames of the controller. No run has it: names of runs have
/// no control letters.
pub(crate) const NAME: &str = "\u{1}operator";

/// The commands that a line can be, for a message.
pub(crate) const HELP: &str = "commands: run, stop, ack (ends a fault), cold (initial situation), \
    press NAME, set NAME := VALUE (of a panel), \
    force NAME := VALUE for TIME, release NAME, release (all), change (to the chart as its file is now), \
    back (to the one before), status, quit";

/// A wish of a person.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(tag = "do")]
pub(crate) enum Wish {
    /// See all, and every change from here on.
    #[serde(rename = "operator_watch")]
    Watch,
    /// Make scans.
    #[serde(rename = "operator_run")]
    Run,
    /// Make no more scans.
    #[serde(rename = "operator_stop")]
    Stop,
    /// End a fault.
    #[serde(rename = "operator_ack")]
    Acknowledge,
    /// Go back to the initial situation.
    #[serde(rename = "operator_cold")]
    Cold,
    /// Force a variable, for so many seconds.
    #[serde(rename = "operator_force")]
    Force {
        name: String,
        value: String,
        #[serde(default = "usual")]
        seconds: u32,
    },
    /// Take a force back.
    #[serde(rename = "operator_release")]
    Release { name: String },
    /// Take all forces back.
    #[serde(rename = "operator_release_all")]
    ReleaseAll,
    /// Go on with the chart as its file is now; what would be lost is lost only `anyway`.
    #[serde(rename = "operator_change")]
    Change {
        #[serde(default)]
        anyway: bool,
    },
    /// Go on with the chart before the latest change.
    #[serde(rename = "operator_back")]
    Back {
        #[serde(default)]
        anyway: bool,
    },
    /// A button of a panel is pressed, pressed still, or released.
    #[serde(rename = "operator_press")]
    Press { name: String, down: bool },
    /// A switch, number or choice of a panel is set.
    #[serde(rename = "operator_set")]
    Set { name: String, value: String },
    /// An alarm was seen, or all up to this one.
    #[serde(rename = "operator_seen")]
    Seen { event: u64, all: bool },
}

fn usual() -> u32 {
    u32::try_from(USUAL.count() / Nanos::SECOND.count()).unwrap_or(u32::MAX)
}

/// A wish of a client.
pub(crate) struct Order {
    pub(crate) by: Arc<Outbox>,
    /// The number of the call; `None` for a client that missed frames and gets a full one.
    pub(crate) call: Option<(u64, Wish, oneshot::Sender<()>)>,
}

impl Wish {
    /// The role that it needs.
    pub(crate) fn role(&self) -> Role {
        match self {
            Wish::Watch => Role::Viewer,
            Wish::Run
            | Wish::Stop
            | Wish::Acknowledge
            | Wish::Cold
            | Wish::Press { .. }
            | Wish::Set { .. }
            | Wish::Seen { .. } => Role::Operator,
            Wish::Force { .. }
            | Wish::Release { .. }
            | Wish::ReleaseAll
            | Wish::Change { .. }
            | Wish::Back { .. } => Role::Engineer,
        }
    }

    /// True if it is done only once it stands in the log. To stop, or to take a force back, never waits.
    pub(crate) fn waits_for_log(&self) -> bool {
        matches!(self, Wish::Force { .. } | Wish::Change { .. } | Wish::Back { .. })
    }

    /// Its kind and what belongs to it, for the log; `None` for one that changes nothing, and for deeds at a
    /// panel: a held button says so again and again, and its event names the person.
    pub(crate) fn deed(&self) -> Option<(String, Value)> {
        match self {
            Wish::Watch | Wish::Press { .. } | Wish::Set { .. } => None,
            _ => self.parts(),
        }
    }

    /// Its kind and what belongs to it.
    fn parts(&self) -> Option<(String, Value)> {
        let mut data = serde_json::to_value(self).ok()?;
        let kind = data.as_object_mut()?.remove("do")?;
        Some((kind.as_str()?.trim_start_matches("operator_").to_owned(), data))
    }

    /// The wish of someone who may not, for the log.
    pub(crate) fn refused(&self, who: &Who) -> Value {
        let (kind, data) = self.parts().unwrap_or_default();
        json!({ "user": who.name, "from": who.from, "needs": self.role().word(), "wish": kind, "data": data })
    }

    /// Reads a line; `None` where it is no wish of this kind.
    pub(crate) fn of_line(line: &str) -> Option<Result<Wish, String>> {
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        let plain = |wish| if rest.is_empty() { Ok(wish) } else { Err(format!("`{word}` stands alone")) };
        Some(match word {
            "run" => plain(Wish::Run),
            "stop" => plain(Wish::Stop),
            "ack" => plain(Wish::Acknowledge),
            "cold" => plain(Wish::Cold),
            "change" | "back" => match (word, rest) {
                ("change", "" | "anyway") => Ok(Wish::Change { anyway: !rest.is_empty() }),
                ("back", "" | "anyway") => Ok(Wish::Back { anyway: !rest.is_empty() }),
                _ => Err(format!("expected `{word}` or `{word} anyway`")),
            },
            "press" if rest.is_empty() => Err("expected `press NAME`".to_owned()),
            "press" => Ok(Wish::Press { name: rest.to_owned(), down: true }),
            "set" => match rest.split_once('=') {
                Some((name, value)) => {
                    let name = name.trim_end().trim_end_matches(':').trim().to_owned();
                    Ok(Wish::Set { name, value: value.trim().to_owned() })
                }
                None => Err("expected `set NAME := VALUE`".to_owned()),
            },
            "force" => forced(rest),
            "release" if rest.is_empty() => Ok(Wish::ReleaseAll),
            "release" => Ok(Wish::Release { name: rest.to_owned() }),
            _ => return None,
        })
    }
}

/// Reads `NAME := VALUE for TIME`.
fn forced(text: &str) -> Result<Wish, String> {
    let (name, rest) = text.split_once('=').ok_or("expected `force NAME := VALUE for TIME`")?;
    let (value, seconds) = match rest.rsplit_once(" for ") {
        None => (rest, usual()),
        Some((value, time)) => {
            let time = values::duration(time).map_err(|e| e.to_string())?;
            let seconds = time.count() / Nanos::SECOND.count();
            if Nanos::SECOND * seconds != time {
                return Err("the time of a force is in whole seconds".to_owned());
            }
            (value, u32::try_from(seconds).unwrap_or(u32::MAX))
        }
    };
    let name = name.trim_end().trim_end_matches(':').trim().to_owned();
    Ok(Wish::Force { name, value: value.trim().to_owned(), seconds })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_wishes_with_all_that_they_say() {
        let force = |name: &str, value: &str, seconds| {
            let (name, value) = (name.to_owned(), value.to_owned());
            Some(Ok(Wish::Force { name, value, seconds }))
        };
        assert_eq!(Wish::of_line("run"), Some(Ok(Wish::Run)));
        assert_eq!(Wish::of_line("force go := 1"), force("go", "1", 600));
        assert_eq!(Wish::of_line("force level=2.5 for 1m30s"), force("level", "2.5", 90));
        assert_eq!(Wish::of_line("release go"), Some(Ok(Wish::Release { name: "go".to_owned() })));
        assert_eq!(Wish::of_line("release"), Some(Ok(Wish::ReleaseAll)));
        let press = Wish::Press { name: "go".to_owned(), down: true };
        assert_eq!(Wish::of_line("press go"), Some(Ok(press)));
        let set = Wish::Set { name: "mode".to_owned(), value: "F1".to_owned() };
        assert_eq!(Wish::of_line("set mode := F1"), Some(Ok(set)));
        assert_eq!(Wish::of_line("change"), Some(Ok(Wish::Change { anyway: false })));
        assert_eq!(Wish::of_line("back anyway"), Some(Ok(Wish::Back { anyway: true })));
        for wrong in [
            "run now",
            "press",
            "set mode",
            "change it",
            "force go",
            "force go := 1 for soon",
            "force go := 1 for 100ms",
        ] {
            assert!(matches!(Wish::of_line(wrong), Some(Err(_))), "{wrong}");
        }
        for other in ["", "status", "go := 1", "running"] {
            assert_eq!(Wish::of_line(other), None, "{other}");
        }
    }

    #[test]
    fn a_wish_is_a_deed_with_its_words() {
        let (kind, data) =
            Wish::of_line("force go := 1 for 5s").expect("a wish").expect("one").deed().expect("it does");
        assert_eq!((kind.as_str(), data), ("force", json!({ "name": "go", "value": "1", "seconds": 5 })));
        assert_eq!(Wish::Stop.deed(), Some(("stop".to_owned(), json!({}))));
        assert_eq!(Wish::Watch.deed(), None);
        assert!(!Wish::Stop.waits_for_log() && Wish::Change { anyway: false }.waits_for_log());
    }

    #[test]
    fn the_page_names_the_time_of_a_force_or_gets_the_usual_one() {
        let read = |text: &str| serde_json::from_str::<Wish>(text).expect("a wish");
        let usual = read(r#"{"do":"operator_force","name":"a","value":"1"}"#);
        assert!(matches!(usual, Wish::Force { seconds: 600, .. }), "{usual:?}");
        assert!(serde_json::from_str::<Wish>(r#"{"do":"operator_what"}"#).is_err());
    }
}
