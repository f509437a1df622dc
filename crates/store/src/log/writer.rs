//! The thread that writes the log, and the ways to it.
//!
//! Nobody waits for the disk: an event is left in a bounded queue, and who must know that a deed is written
//! before it is done looks at a [`Ticket`]. While the disk is full, events wait in a backlog of bounded
//! length; those that find no place are counted, and the count is a row as soon as there is room.

use std::collections::VecDeque;
use std::path::Path;
use std::sync::mpsc::{
    Receiver, RecvTimeoutError, SyncSender, TryRecvError, TrySendError, channel, sync_channel,
};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use rusqlite::{Connection, OptionalExtension as _, Transaction, TransactionBehavior, params};

use super::{CUT, Entry, GAP, Hash, KIND, LAYOUTS, Mark, PRUNED, chained};
use crate::file::{self, Durable, StoreError};

/// Greatest number of letters in the queue.
const QUEUE: usize = 1_024;
/// Greatest number of rows in one write.
const BATCH: usize = 256;
/// The time between two tries while the file cannot be written.
const AGAIN: Duration = Duration::from_millis(500);
/// Rows are removed after so many writes at the earliest.
const PRUNE_EACH: u32 = 256;
const DAY: u64 = 86_400_000;
/// The longest wait for the last rows, in ms.
const END: u64 = 3_000;

/// How much is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Keep {
    /// Rows that are older go, in days.
    pub days: u64,
    /// The size of the file beyond which the oldest rows go, in bytes.
    pub bytes: u64,
    /// Greatest number of events that wait while the file cannot be written.
    pub backlog: usize,
}

impl Default for Keep {
    fn default() -> Keep {
        Keep { days: 400, bytes: 100 << 20, backlog: 4_096 }
    }
}

/// How the log is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct State {
    /// The newest row.
    pub newest: Mark,
    /// Events that were lost since the start.
    pub lost: u64,
    /// Why the file cannot be written at present.
    pub failing: Option<String>,
}

type Shared = Arc<Mutex<State>>;

/// A letter to the thread.
enum Letter {
    /// The last one: what comes later is not written.
    End,
    Event(Entry),
    Deed(Entry, std::sync::mpsc::Sender<Result<(), String>>),
}

/// A deed on its way into the log.
#[derive(Debug)]
pub struct Ticket(Receiver<Result<(), String>>);

impl Ticket {
    /// True once the deed is written, an error where it cannot be; `None` until then.
    pub fn look(&self) -> Option<Result<(), String>> {
        match self.0.try_recv() {
            Ok(done) => Some(done),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err("the log has ended".to_owned())),
        }
    }

    /// Waits until the deed is written, for a thread that may wait.
    ///
    /// # Errors
    ///
    /// Why it is not written, or not within this time.
    pub fn wait(&self, longest: Duration) -> Result<(), String> {
        self.0.recv_timeout(longest).unwrap_or_else(|_| Err("the log does not answer".to_owned()))
    }
}

/// A way into the log; clones are the same.
#[derive(Clone, Debug)]
pub struct Entrance {
    give: SyncSender<Letter>,
    state: Shared,
}

impl std::fmt::Debug for Letter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("letter")
    }
}

impl Entrance {
    /// Leaves an event. Never waits; what finds no place is counted.
    pub fn event(&self, entry: Entry) {
        if self.give.try_send(Letter::Event(entry)).is_err() {
            lock(&self.state).lost += 1;
        }
    }

    /// Leaves a deed that is to be written before it is done.
    pub fn deed(&self, entry: Entry) -> Ticket {
        let (done, ticket) = channel();
        if let Err(TrySendError::Full(letter) | TrySendError::Disconnected(letter)) =
            self.give.try_send(Letter::Deed(entry, done))
            && let Letter::Deed(_, done) = letter
        {
            done.send(Err("too much waits to be written into the log".to_owned())).ok();
        }
        Ticket(ticket)
    }

    /// How the log is now.
    pub fn state(&self) -> State {
        lock(&self.state).clone()
    }
}

fn lock(state: &Shared) -> std::sync::MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A log that is written. When it is dropped, what waits is written first.
#[derive(Debug)]
pub struct Log {
    entrance: Option<Entrance>,
    thread: Option<std::thread::JoinHandle<()>>,
}

/// A log as it was found at the start.
#[derive(Debug)]
pub struct Opened {
    /// The log.
    pub log: Log,
    /// The newest row that was there.
    pub newest: Mark,
}

impl Log {
    /// Opens or makes a log. `now` gives the time of day in ms since 1970, UTC.
    ///
    /// # Errors
    ///
    /// The file is none of a log, or cannot be read or written.
    pub fn open(path: &Path, keep: Keep, now: fn() -> u64) -> Result<Opened, StoreError> {
        let file = file::open(path, KIND, &LAYOUTS, Durable::AtOnce)?;
        let newest = newest(&file)?;
        let state: Shared = Arc::new(Mutex::new(State { newest, ..State::default() }));
        let (give, letters) = sync_channel(QUEUE);
        let writer = Writer {
            file,
            keep,
            now,
            state: Arc::clone(&state),
            newest,
            backlog: VecDeque::new(),
            counted: 0,
            writes: 0,
        };
        let thread = std::thread::Builder::new().name("log".to_owned()).spawn(move || writer.work(&letters));
        let thread = thread.map_err(|e| rusqlite::Error::ToSqlConversionFailure(Box::new(e)))?;
        let entrance = Some(Entrance { give, state });
        Ok(Opened { log: Log { entrance, thread: Some(thread) }, newest })
    }

    /// A way into the log.
    pub fn entrance(&self) -> Option<Entrance> {
        self.entrance.clone()
    }
}

impl Drop for Log {
    fn drop(&mut self) {
        let (Some(entrance), Some(thread)) = (self.entrance.take(), self.thread.take()) else { return };
        // Bounded: a disk that does not answer does not hold up the end.
        for _ in 0..END / 5 {
            match entrance.give.try_send(Letter::End) {
                Err(TrySendError::Full(_)) => std::thread::sleep(Duration::from_millis(5)),
                Ok(()) | Err(TrySendError::Disconnected(_)) => break,
            }
        }
        for _ in 0..END / 5 {
            if thread.is_finished() {
                break;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

struct Writer {
    file: Connection,
    keep: Keep,
    now: fn() -> u64,
    state: Shared,
    /// The newest row that this process has seen.
    newest: Mark,
    backlog: VecDeque<Entry>,
    /// The lost events that are already a row.
    counted: u64,
    writes: u32,
}

impl Writer {
    fn work(mut self, letters: &Receiver<Letter>) {
        loop {
            let lost = lock(&self.state).lost > self.counted;
            let waits = lost || !self.backlog.is_empty();
            let first = match letters.recv_timeout(if waits { AGAIN } else { Duration::from_secs(3_600) }) {
                Ok(letter) => Some(letter),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => {
                    self.write(Vec::new());
                    return;
                }
            };
            let more = std::iter::from_fn(|| letters.try_recv().ok()).take(BATCH);
            let mut batch: Vec<Letter> = first.into_iter().chain(more).collect();
            let end = batch.iter().position(|letter| matches!(letter, Letter::End));
            batch.truncate(end.unwrap_or(batch.len()));
            self.write(batch);
            if end.is_some() {
                return;
            }
        }
    }

    /// Writes what waits and these letters, whole or not at all.
    fn write(&mut self, letters: Vec<Letter>) {
        let mut deeds = Vec::new();
        let mut fresh: Vec<Entry> = Vec::new();
        for letter in letters {
            match letter {
                Letter::End => {}
                Letter::Event(entry) => fresh.push(entry),
                Letter::Deed(entry, done) => {
                    fresh.push(entry);
                    deeds.push((fresh.len() - 1, done));
                }
            }
        }
        match self.commit(&fresh) {
            Ok(()) => {
                self.backlog.clear();
                lock(&self.state).failing = None;
                deeds.into_iter().for_each(|(_, done)| drop(done.send(Ok(()))));
                self.writes += 1;
                if self.writes.is_multiple_of(PRUNE_EACH) || self.writes == 1 {
                    // Without room for it, the next time is soon enough.
                    self.prune().ok();
                }
            }
            Err(why) => {
                let why = why.to_string();
                lock(&self.state).failing = Some(why.clone());
                // A deed that is not written is not done: it is nothing to be written later.
                let refused: Vec<usize> = deeds.iter().map(|(at, _)| *at).collect();
                for (_, done) in deeds {
                    done.send(Err(why.clone())).ok();
                }
                for (k, entry) in fresh.into_iter().enumerate() {
                    if refused.contains(&k) {
                        continue;
                    }
                    // Once one is lost, so are those behind it: the count stands where they would.
                    let lost = lock(&self.state).lost > self.counted;
                    if lost || self.backlog.len() >= self.keep.backlog {
                        lock(&self.state).lost += 1;
                    } else {
                        self.backlog.push_back(entry);
                    }
                }
            }
        }
    }

    fn commit(&mut self, fresh: &[Entry]) -> Result<(), StoreError> {
        let lost = lock(&self.state).lost;
        if fresh.is_empty() && self.backlog.is_empty() && lost == self.counted {
            return Ok(());
        }
        let now = (self.now)();
        let step = self.file.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let mut last = newest(&step)?;
        if !holds(&step, &self.newest)? {
            let data = format!("{{\"known\":\"{}\",\"found\":\"{last}\"}}", self.newest);
            last = add(&step, last, &own(now, "alarm", CUT, data))?;
        }
        for entry in &self.backlog {
            last = add(&step, last, entry)?;
        }
        if lost > self.counted {
            let data = format!("{{\"count\":{}}}", lost - self.counted);
            last = add(&step, last, &own(now, "alarm", GAP, data))?;
        }
        for entry in fresh {
            last = add(&step, last, entry)?;
        }
        step.commit()?;
        (self.newest, self.counted) = (last, lost);
        lock(&self.state).newest = last;
        Ok(())
    }

    /// Removes the oldest rows where the log is too long; a row in the chain says which.
    fn prune(&mut self) -> Result<(), StoreError> {
        let now = (self.now)();
        let step = self.file.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let number = |name: &str| step.pragma_query_value(None, name, |row| row.get::<_, i64>(0));
        let used = (number("page_count")? - number("freelist_count")?) * number("page_size")?;
        let (first, count): (Option<i64>, i64) =
            step.query_row("SELECT min(n), count(*) FROM row", (), |r| Ok((r.get(0)?, r.get(1)?)))?;
        let Some(first) = first else { return Ok(()) };
        let old = now.saturating_sub(self.keep.days.saturating_mul(DAY));
        // By number and not by time: a clock that was set back makes no hole.
        let young: Option<i64> = step
            .query_row("SELECT min(n) FROM row WHERE wall >= ?1", [old as i64], |r| r.get(0))
            .optional()?
            .flatten();
        let mut upto = young.unwrap_or(first + count) - 1;
        if u64::try_from(used).unwrap_or_default() > self.keep.bytes {
            upto = upto.max(first + count / 5);
        }
        // The newest stays: the next is chained to it.
        upto = upto.min(first + count - 2);
        if upto < first {
            return Ok(());
        }
        let hash: [u8; 32] = step.query_row("SELECT hash FROM row WHERE n = ?1", [upto], |r| r.get(0))?;
        step.execute("DELETE FROM row WHERE n <= ?1", [upto])?;
        step.execute("INSERT OR REPLACE INTO anchor VALUES (1, ?1, ?2)", params![upto, hash])?;
        let gone = Mark { n: upto as u64, hash: Hash(hash) };
        let newest = newest(&step)?;
        let last = add(&step, newest, &own(now, "note", PRUNED, format!("{{\"upto\":\"{gone}\"}}")))?;
        step.commit()?;
        self.newest = last;
        lock(&self.state).newest = last;
        Ok(())
    }
}

/// A row of the log about itself.
fn own(wall: u64, level: &str, kind: &str, data: String) -> Entry {
    Entry { wall, level: level.to_owned(), kind: kind.to_owned(), data, ..Entry::default() }
}

/// The newest row, or the anchor where there is none.
pub(super) fn newest(file: &Connection) -> Result<Mark, StoreError> {
    let mark =
        |row: &rusqlite::Row<'_>| Ok(Mark { n: row.get::<_, i64>(0)? as u64, hash: Hash(row.get(1)?) });
    let row = file.query_row("SELECT n, hash FROM row ORDER BY n DESC LIMIT 1", (), mark).optional()?;
    if let Some(row) = row {
        return Ok(row);
    }
    Ok(file.query_row("SELECT n, hash FROM anchor", (), mark).optional()?.unwrap_or_default())
}

/// True if a row is still there, or was removed as an old one.
fn holds(step: &Transaction<'_>, mark: &Mark) -> Result<bool, StoreError> {
    if mark.n == 0 {
        return Ok(true);
    }
    let found = step
        .query_row("SELECT hash FROM row WHERE n = ?1", [mark.n as i64], |r| r.get::<_, [u8; 32]>(0))
        .optional()?;
    let gone = |step: &Transaction<'_>| {
        step.query_row("SELECT n FROM anchor", (), |r| r.get::<_, i64>(0)).optional()
    };
    Ok(match found {
        Some(hash) => Hash(hash) == mark.hash,
        None => gone(step)?.is_some_and(|n| n as u64 >= mark.n),
    })
}

fn add(step: &Transaction<'_>, last: Mark, entry: &Entry) -> Result<Mark, StoreError> {
    let n = last.n + 1;
    let hash = chained(&last.hash, n, entry);
    let mut insert = step.prepare_cached("INSERT INTO row VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)")?;
    let Entry { wall, at, level, kind, who, from, data } = entry;
    insert.execute(params![n as i64, *wall as i64, at, level, kind, who, from, data, hash.0])?;
    Ok(Mark { n, hash })
}
