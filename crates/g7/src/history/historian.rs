//! The one who records: takes the notes of the scan and hands them to the file, each second.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use g7_host::{Clock, WallClock, utc_millis};
use g7_model::{Nanos, say};
use g7_online::{Chosen, Note, Notes, Recorded};
use g7_store::history::{Limits, Signal, Writer};

use crate::failure::{Failure, raw};

/// The pause between two looks at the notes: the ring has room for many times what comes in it.
const PAUSE: Duration = Duration::from_millis(20);
/// The time between two batches for the file.
const BATCH: Nanos = Nanos::SECOND;

/// Something to tell of a record.
#[derive(Clone, Debug)]
pub(crate) enum Kept {
    /// It cannot be written, and why.
    Fails(String),
    /// It goes on; so many changes were lost.
    Goes(u64),
}

/// The thread that records. Dropping it writes the rest.
pub(crate) struct Historian {
    pub(crate) path: PathBuf,
    /// News for the operator.
    pub(crate) told: Receiver<Kept>,
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

/// Opens the record of a controller whose clock is about to begin.
///
/// # Errors
///
/// The file is none of a record, or cannot be written.
pub(crate) fn open(io: &Path, chosen: &Chosen) -> Result<(PathBuf, Writer), Failure> {
    let path = io.with_file_name(&chosen.file);
    let age = Nanos::DAY * i64::from(chosen.days);
    let limits = Limits { age, bytes: u64::from(chosen.megabytes) << 20 };
    let writer = Writer::open(&path, limits, Nanos::ZERO, utc()).map_err(|e| {
        Failure::Usage(say!(
            "cannot use {} for [history]: {e}; move it away to begin anew, or name another `file`",
            raw(path.display()),
            e = raw(&e)
        ))
    })?;
    Ok((path, writer))
}

/// The time of day, in us since 1970.
fn utc() -> i64 {
    i64::try_from(utc_millis()).unwrap_or(i64::MAX).saturating_mul(1000)
}

impl Historian {
    /// Records from here on.
    ///
    /// # Errors
    ///
    /// The system has no more threads.
    pub(crate) fn start(
        (path, writer): (PathBuf, Writer),
        notes: Notes,
        clock: WallClock,
    ) -> std::io::Result<Historian> {
        let (stop, stopped) = channel();
        let (tell, told) = channel();
        let work = Work { writer, notes, clock, tell, failing: false };
        let thread =
            std::thread::Builder::new().name("history".to_owned()).spawn(move || work.run(&stopped))?;
        Ok(Historian { path, told, stop: Some(stop), thread: Some(thread) })
    }
}

impl Drop for Historian {
    fn drop(&mut self) {
        self.stop = None;
        if let Some(thread) = self.thread.take() {
            // A record that failed has told so.
            thread.join().ok();
        }
    }
}

struct Work {
    writer: Writer,
    notes: Notes,
    clock: WallClock,
    tell: Sender<Kept>,
    failing: bool,
}

impl Work {
    fn run(mut self, stopped: &Receiver<()>) {
        let mut due = self.clock.now() + BATCH;
        while let Err(RecvTimeoutError::Timeout) = stopped.recv_timeout(PAUSE) {
            self.take();
            let now = self.clock.now();
            if now >= due {
                due = now + BATCH;
                self.writer.clock(now, utc());
                let done = self.writer.commit().map_err(|e| e.to_string());
                self.told(done);
            }
        }
        // The scan has ended.
        self.take();
        if let Err(e) = self.writer.close() {
            self.tell.send(Kept::Fails(e.to_string())).ok();
        }
    }

    /// Takes all notes that are there.
    fn take(&mut self) {
        while let Ok(note) = self.notes.notes.pop() {
            match note {
                Note::Begin { at, table, lost } => {
                    let signals = self
                        .notes
                        .table(table)
                        .map(|table| table.signals.iter().map(signal).collect::<Vec<_>>());
                    // Each table is given before its first note.
                    match signals {
                        Some(signals) => self.writer.begin(at, &signals, u64::from(lost)),
                        None => self.writer.begin_again(at, u64::from(lost)),
                    }
                    if lost > 0 {
                        self.tell.send(Kept::Goes(u64::from(lost))).ok();
                    }
                }
                Note::Change { at, signal, word } => self.writer.change(at, signal, word),
                Note::Alive { at } => self.writer.alive(at),
            }
        }
    }

    /// Tells that the file fails, or is well again; nobody has to listen.
    fn told(&mut self, done: Result<u64, String>) {
        let news = match done {
            Err(why) if !self.failing => Kept::Fails(why),
            Ok(lost) if self.failing => Kept::Goes(lost),
            Err(_) | Ok(_) => return,
        };
        self.failing = matches!(news, Kept::Fails(_));
        self.tell.send(news).ok();
    }
}

fn signal(recorded: &Recorded) -> Signal {
    let Recorded { name, group, kind, ty, comment, .. } = recorded;
    Signal {
        name: name.clone(),
        kind: *kind,
        class: (*group).to_owned(),
        ty: ty.clone(),
        comment: comment.clone(),
    }
}
