//! The rows that go into the log of a controller: its events, and the deeds of persons before they are done.
//!
//! Without a log nothing is written and nothing is refused for it.

use std::path::Path;
use std::time::Duration;

use g7_host::utc_millis;
use g7_model::{Nanos, say};
use g7_online::setup::LogFile;
use g7_store::log::{Entrance, Entry, Keep, Log, Mark, Opened, State, Ticket};
use serde_json::{Value, json};

use crate::failure::{Failure, raw};
use crate::message::talk;
use crate::who::Who;

/// A deed whose row is not written after this time is refused.
const PATIENCE: Duration = Duration::from_secs(4);

/// The way into the log, if there is one; clones are the same.
#[derive(Clone, Debug, Default)]
pub(crate) struct Audit(Option<Entrance>);

/// A deed that waits for its row.
#[derive(Debug)]
pub(crate) struct Pending(Option<Ticket>);

/// Opens the log and says where it stands, so that the terminal or the journal of the system keeps a mark of it.
pub(crate) fn open(path: &Path, days: Option<u64>, mib: Option<u64>) -> Result<(Log, Audit), Failure> {
    let usual = Keep::default();
    let days = days.unwrap_or(usual.days);
    let bytes = mib.map_or(usual.bytes, |mib| mib << 20);
    let Opened { log, newest } = Log::open(path, Keep { days, bytes, ..usual }, utc_millis).map_err(|e| {
        Failure::Usage(say!("cannot use {} as the log: {e}", raw(path.display()), e = raw(&e)))
    })?;
    tell(path, newest);
    let audit = Audit::of(&log);
    Ok((log, audit))
}

/// Opens the log that an io file names.
pub(crate) fn of_file(io: &Path, file: &LogFile) -> Result<(Log, Audit), Failure> {
    open(&io.with_file_name(&file.file.value), file.days, file.mib)
}

fn tell(path: &Path, newest: Mark) {
    match newest.n {
        0 => talk!("log {}: new", path.display()),
        _ => talk!("log {}: newest row {newest}", path.display()),
    }
}

/// A deed as a row.
fn deed(who: &Who, kind: &str, at: Option<Nanos>, data: &Value) -> Entry {
    Entry {
        wall: utc_millis(),
        at: at.map(Nanos::count),
        level: "deed".to_owned(),
        kind: kind.to_owned(),
        who: who.name.clone(),
        from: who.from.clone(),
        data: data.to_string(),
    }
}

impl Audit {
    /// The way into a log.
    pub(crate) fn of(log: &Log) -> Audit {
        Audit(log.entrance())
    }

    /// True if there is a log.
    pub(crate) fn is_kept(&self) -> bool {
        self.0.is_some()
    }

    /// Writes an event.
    pub(crate) fn event(&self, level: &str, kind: &str, at: Option<Nanos>, data: &Value) {
        let Some(log) = &self.0 else { return };
        log.event(Entry {
            wall: utc_millis(),
            at: at.map(Nanos::count),
            level: level.to_owned(),
            kind: kind.to_owned(),
            data: data.to_string(),
            ..Entry::default()
        });
    }

    /// Writes a deed that is done in any case.
    pub(crate) fn note(&self, who: &Who, kind: &str, at: Option<Nanos>, data: &Value) {
        if let Some(log) = &self.0 {
            log.event(deed(who, kind, at, data));
        }
    }

    /// Writes a deed that is done only once its row is written.
    pub(crate) fn before(&self, who: &Who, kind: &str, at: Option<Nanos>, data: &Value) -> Pending {
        Pending(self.0.as_ref().map(|log| log.deed(deed(who, kind, at, data))))
    }

    /// The same, and waits: for threads that may.
    pub(crate) fn must(&self, who: &Who, kind: &str, data: &Value) -> Result<(), String> {
        match self.before(who, kind, None, data).0 {
            None => Ok(()),
            Some(ticket) => ticket.wait(PATIENCE).map_err(|why| {
                // A row that comes later than anyone waits is no deed.
                self.event("warning", "not-done", None, &json!({ "deed": kind, "user": who.name }));
                unwritten(&why)
            }),
        }
    }

    /// How the log is.
    pub(crate) fn state(&self) -> Option<State> {
        self.0.as_ref().map(Entrance::state)
    }

    /// The facts for the page and the metrics.
    pub(crate) fn facts(&self) -> Value {
        let Some(State { newest, lost, failing }) = self.state() else { return Value::Null };
        json!({ "rows": newest.n, "newest": newest.to_string(), "lost": lost, "failing": failing })
    }
}

fn unwritten(why: &str) -> String {
    format!("nothing is done, since it cannot be written into the log: {why}")
}

impl Pending {
    /// True once the deed may be done; an error where it may not.
    pub(crate) fn look(&self) -> Option<Result<(), String>> {
        match &self.0 {
            None => Some(Ok(())),
            Some(ticket) => ticket.look().map(|done| done.map_err(|why| unwritten(&why))),
        }
    }
}
