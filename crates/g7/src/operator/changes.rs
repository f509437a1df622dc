//! On-line changes as a person makes them: the files of the chart are read again, or the chart before the
//! latest change comes back.
//!
//! Reading, compiling and carrying over take longer than a scan, so they have a thread of their own; the
//! attendant gets the outcome.

use std::path::Path;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::SystemTime;

use g7_model::Nanos;
use g7_online::{Change, Changer, Running, Sight};
use serde_json::{Value, json};

use super::names::Names;
use super::stage::Asker;
use crate::message::talk;
use crate::origin::Origin;

/// The time between two looks at the file.
const LOOK: Nanos = Nanos::SECOND;

/// A change that is being made.
struct Work {
    by: Asker,
    back: bool,
    anyway: bool,
    outcome: Receiver<Outcome>,
}

/// The end of a change, and the chart that it led to.
struct Outcome {
    changer: Changer,
    end: Result<(Change, Names), String>,
}

/// The new facts behind a change.
pub(crate) struct Adopted {
    pub(crate) names: Names,
    pub(crate) sight: Sight,
    /// The chart before the latest change came back.
    pub(crate) back: bool,
    pub(crate) lost: Vec<String>,
}

/// The changes of one controller.
pub(crate) struct Changes {
    origin: Origin,
    /// The chart before the latest change.
    before: Option<Names>,
    work: Option<Work>,
    made: Option<Adopted>,
    /// Sizes and times of the files at the latest look, and if a text is another one than that which runs.
    file: (Option<Vec<(u64, SystemTime)>>, bool),
    due: Nanos,
}

impl Changes {
    pub(crate) fn new(origin: Origin) -> Changes {
        Changes { origin, before: None, work: None, made: None, file: (None, false), due: Nanos::ZERO }
    }

    /// Begins a change; its end is found by [`Changes::settle`].
    pub(crate) fn begin(
        &mut self,
        names: &Names,
        by: Asker,
        back: bool,
        anyway: bool,
        running: &mut Running,
    ) {
        let refused = match (&self.work, &self.before) {
            (Some(_), _) => Some("a change is being made: wait for its end"),
            (None, None) if back => Some("there was no change that could be taken back"),
            (None, _) if running.changer.is_none() => Some("no change can be made any more: start G7 anew"),
            (None, _) => None,
        };
        let Some(mut changer) = running.changer.take_if(|_| refused.is_none()) else {
            return answer(by, Err(refused.unwrap_or("no change can be made now").to_owned()));
        };
        let (old, origin) = (names.clone(), self.origin.clone());
        let before = self.before.clone().filter(|_| back);
        let (give, outcome) = channel();
        std::thread::spawn(move || {
            let end = before.map_or_else(|| origin.read(), Ok).and_then(|new| {
                let change = changer.change(old.chart(), new.chart(), anyway)?;
                Ok((change, new))
            });
            // The attendant may have ended.
            give.send(Outcome { changer, end }).ok();
        });
        self.work = Some(Work { by, back, anyway, outcome });
    }

    /// Looks if a change has come to its end; those who asked are answered.
    pub(crate) fn settle(&mut self, names: &Names, running: &mut Running) {
        let Some(work) = &self.work else { return };
        let outcome = match work.outcome.try_recv() {
            Ok(outcome) => Some(outcome),
            Err(TryRecvError::Empty) => return,
            Err(TryRecvError::Disconnected) => None,
        };
        let Some(Work { by, back, anyway, .. }) = self.work.take() else { return };
        let Some(Outcome { changer, end }) = outcome else {
            return answer(
                by,
                Err("the change ended by an error of G7; the chart is that of before".to_owned()),
            );
        };
        running.changer = Some(changer);
        match end {
            Err(why) => answer(by, Err(why)),
            Ok((Change::Asks(lost), _)) => {
                debug_assert!(!anyway);
                if let Asker::Line = by {
                    let word = if back { "back" } else { "change" };
                    talk!("nothing is changed, since this would be lost: {}", lost.join("; "));
                    talk!("`{word} anyway` does it all the same");
                }
                answer(by, Ok(json!({ "asks": lost })));
            }
            Ok((Change::Made { lost, sight }, new)) => {
                answer(by, Ok(json!({ "lost": lost })));
                self.before = Some(names.clone());
                self.file.0 = None;
                self.due = Nanos::ZERO;
                self.made = Some(Adopted { names: new, sight: *sight, back, lost });
            }
        }
    }

    /// A change that was made since the last call.
    pub(crate) fn made(&mut self) -> Option<Adopted> {
        self.made.take()
    }

    /// The facts for the page: if the file differs from what runs, and if there is a way back.
    pub(crate) fn facts(&mut self, names: &Names, now: Nanos) -> Value {
        if now >= self.due {
            self.due = now + LOOK;
            // The paths of the chart and of the files that it uses.
            let used = || names.source.files().skip(1).map(|(name, bytes)| (Path::new(name), bytes));
            let files = || std::iter::once((&*self.origin.path, &*names.source.bytes)).chain(used());
            let stamp = |(path, _): (&Path, _)| {
                std::fs::metadata(path).ok().and_then(|m| Some((m.len(), m.modified().ok()?)))
            };
            let is: Option<Vec<_>> = files().map(stamp).collect();
            if is.is_none() || is != self.file.0 {
                // A file that cannot be read at the moment is told when the change is asked for.
                let differs = files().any(|(path, bytes)| std::fs::read(path).is_ok_and(|now| now != bytes));
                self.file = (is, differs);
            }
        }
        json!({ "differs": self.file.1, "back": self.before.is_some(), "busy": self.work.is_some() })
    }
}

/// Answers who asked; the terminal hears of refusals alone.
fn answer(by: Asker, done: Result<Value, String>) {
    match (&by, &done) {
        (Asker::Line, Err(why)) => talk!("{why}"),
        (Asker::Line, Ok(_)) => {}
        (Asker::Page(..), _) => by.answer(done),
    }
}
