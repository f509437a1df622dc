//! The events of a controller on their way to brokers: each is written down first, then published, and
//! removed when the broker has taken it.
//!
//! ```text
//!   attendant -> Post -> thread: Outbox (a file a broker) -> Mail -> the device of the broker
//! ```
//!
//! A slow disk stops neither the attendant nor a device. While a file cannot be written, events wait in
//! memory, a number of them at most; those beyond are counted, and the count goes out as an event.

use std::collections::VecDeque;
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use g7_online::setup::{Events, Kind};
use g7_online::{Clients, Letter, Mail, Wiring};
use g7_store::{Limits, Outbox, Waiting};
use serde_json::{Value, json};

use g7_model::say;

use crate::failure::{Failure, raw, refused};

/// The pause between two looks at what a broker has taken.
const PAUSE: Duration = Duration::from_millis(20);
/// Events that wait in memory while the disk refuses them.
const HELD: usize = 10_000;

/// An event with the time of day in milliseconds since 1970.
type Noted = (u64, Value);

/// Something that the operator should know of the events of a device, by number; `None` as soon as it is
/// over.
pub(crate) type Trouble = (usize, Option<String>);

/// The events of a controller, for the brokers that want them. Dropping it waits until all are written.
pub(crate) struct Post {
    to: Option<Sender<Noted>>,
    thread: Option<JoinHandle<()>>,
    troubles: Receiver<Trouble>,
}

impl Post {
    /// Opens the files of the brokers that want events; `None` where none does.
    pub(crate) fn open(wiring: &Wiring, io: &Path, clients: &mut Clients) -> Result<Option<Post>, Failure> {
        let mut keepers = Vec::new();
        for (device, wired) in wiring.devices.iter().enumerate() {
            let Kind::Mqtt(broker) = &wired.device.kind else { continue };
            let Some(Events { file, most, bytes, .. }) = &broker.events else { continue };
            let path = io.with_file_name(&file.value);
            let outbox = Outbox::open(&path, Limits { count: *most, bytes: *bytes }).map_err(|e| {
                let name = path.display();
                Failure::Usage(say!(
                    "cannot use {name} for `events`: {e}; move it away to begin anew",
                    name = raw(&name),
                    e = raw(&e)
                ))
            })?;
            keepers.push(Keeper::new(device, outbox, clients.mail(&wired.device.name.value)));
        }
        if keepers.is_empty() {
            return Ok(None);
        }
        let (to, noted) = channel();
        let (tell, troubles) = channel();
        let work = move || keep(&mut keepers, &noted, &tell);
        let thread = std::thread::Builder::new().name("events".to_owned()).spawn(work).map_err(refused)?;
        Ok(Some(Post { to: Some(to), thread: Some(thread), troubles }))
    }

    /// Writes an event down and sends it.
    pub(crate) fn send(&self, event: Value) {
        if let Some(to) = &self.to {
            // The thread ends by an error of its own only, which the end of the program tells.
            to.send((g7_host::utc_millis(), event)).ok();
        }
    }

    /// The troubles that the operator should know of since the last call.
    pub(crate) fn troubles(&self) -> Vec<Trouble> {
        self.troubles.try_iter().collect()
    }
}

impl Drop for Post {
    fn drop(&mut self) {
        self.to = None;
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

/// The thread: it writes what comes and hands on what waits, until nobody sends any more.
fn keep(keepers: &mut [Keeper], noted: &Receiver<Noted>, tell: &Sender<Trouble>) {
    loop {
        let (first, over) = match noted.recv_timeout(PAUSE) {
            Ok(event) => (Some(event), false),
            Err(RecvTimeoutError::Timeout) => (None, false),
            Err(RecvTimeoutError::Disconnected) => (None, true),
        };
        let new: Vec<Noted> = first.into_iter().chain(noted.try_iter()).collect();
        for keeper in keepers.iter_mut() {
            if let Some(trouble) = keeper.step(&new) {
                // Nobody has to listen.
                tell.send((keeper.device, trouble)).ok();
            }
        }
        if over {
            return;
        }
    }
}

/// The events of one broker.
struct Keeper {
    /// The number of the broker among the devices.
    device: usize,
    outbox: Outbox,
    mail: Mail,
    /// Events that the file does not have yet.
    held: VecDeque<(u64, String)>,
    /// Those that were lost because there were too many of them.
    lost: u64,
    /// The number of the last letter that was put into the window.
    last: i64,
    /// Numbers that the broker has taken and the file has still.
    taken: Vec<i64>,
    /// Old events are being dropped: the broker is away for too long.
    drops: bool,
    told: Option<String>,
}

impl Keeper {
    fn new(device: usize, outbox: Outbox, mail: Mail) -> Keeper {
        let (held, taken) = (VecDeque::new(), Vec::new());
        Keeper { device, outbox, mail, held, lost: 0, last: 0, taken, drops: false, told: None }
    }

    /// Writes new events, removes what the broker has taken, and fills the window. Returns the trouble
    /// where it is another one than before.
    fn step(&mut self, new: &[Noted]) -> Option<Option<String>> {
        for (at, event) in new {
            self.held.push_back((*at, event.to_string()));
        }
        let trouble = self.work().err().map(|e| format!("events cannot be written: {e}"));
        while self.held.len() > HELD {
            self.held.pop_front();
            self.lost += 1;
        }
        let full = "the broker is away for too long: the oldest events are dropped";
        let trouble = trouble.or_else(|| self.mail.refused()).or_else(|| self.drops.then(|| full.to_owned()));
        if trouble == self.told {
            return None;
        }
        self.told.clone_from(&trouble);
        Some(trouble)
    }

    fn work(&mut self) -> Result<(), g7_store::StoreError> {
        self.taken.extend(self.mail.taken());
        if !self.taken.is_empty() {
            self.outbox.remove(&self.taken)?;
            self.taken.clear();
            self.drops = false;
        }
        if !self.held.is_empty() {
            let tells = self.lost > 0;
            if tells {
                let at = self.held.front().map_or(0, |(at, _)| *at);
                self.held.push_front((at, lost(self.lost).to_string()));
            }
            let added = self.outbox.add(self.held.make_contiguous());
            if tells && added.is_err() {
                // It is written anew with the next attempt, by which more may be lost.
                self.held.pop_front();
            }
            let dropped = added?;
            self.held.clear();
            self.lost = 0;
            if let Some(number) = dropped {
                self.drops = true;
                // The row that says so has this number, and follows.
                self.mail.begin_anew();
                self.last = number - 1;
            }
        }
        let room = self.mail.room();
        if room > 0 {
            let letters = self.outbox.after(self.last, room)?;
            self.last = letters.last().map_or(self.last, |row| row.number);
            self.mail.put(letters.into_iter().map(letter));
        }
        Ok(())
    }
}

/// The event that says that some were lost before they had a number.
fn lost(count: u64) -> Value {
    json!({ "kind": "lost", "level": "warning", "count": count })
}

/// An event as it is published.
fn letter(row: Waiting) -> Letter {
    let number = row.number;
    let mut event = match row.event {
        // It was written as JSON; a file that somebody has changed is sent as it is.
        Ok(text) => serde_json::from_str(&text).unwrap_or(Value::String(text)),
        Err(first) => json!({
            "kind": "dropped", "level": "warning",
            "first": first, "last": number, "count": number - first + 1,
        }),
    };
    if let Some(fields) = event.as_object_mut() {
        fields.insert("number".to_owned(), json!(number));
        fields.insert("at".to_owned(), json!(row.at));
    }
    Letter { number, payload: event.to_string().into_bytes() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keeper(name: &str, limits: Limits) -> Keeper {
        let folder = std::env::temp_dir().join(format!("g7-post-{name}-{}", std::process::id()));
        std::fs::remove_dir_all(&folder).ok();
        std::fs::create_dir_all(&folder).expect("a folder");
        let outbox = Outbox::open(&folder.join("events"), limits).expect("made");
        Keeper::new(0, outbox, Mail::default())
    }

    /// The events that a broker gets which takes all.
    fn taken(keeper: &mut Keeper) -> Vec<Value> {
        let mut all = Vec::new();
        loop {
            keeper.step(&[]);
            let Some((_, letter)) = keeper.mail.next(0, 0) else { return all };
            keeper.mail.take(letter.number);
            all.push(serde_json::from_slice(&letter.payload).expect("JSON"));
        }
    }

    /// One event a second, and nobody there.
    #[test]
    fn row_16_a_broker_that_is_away_for_a_day_hears_which_events_were_dropped() {
        const DAY: u64 = 86_400;
        const BEGIN: u64 = 1_764_041_726;
        let limits = Limits { count: 1_000, bytes: 40_000 };
        let mut keeper = keeper("day", limits);
        let mut troubles = Vec::new();
        for from in (0..DAY).step_by(900) {
            let noted: Vec<Noted> = (from..from + 900)
                .map(|second| ((BEGIN + second) * 1000, json!({ "kind": "forced", "value": second })))
                .collect();
            troubles.extend(keeper.step(&noted));
            assert!(keeper.outbox.count() <= limits.count, "{}", keeper.outbox.count());
            assert!(keeper.outbox.bytes() <= limits.bytes, "{}", keeper.outbox.bytes());
            assert!(keeper.held.is_empty());
        }
        // Told once, when it began.
        assert_eq!(troubles.len(), 1, "{troubles:?}");
        let mut events = taken(&mut keeper).into_iter();
        let gap = events.next().expect("the gap is told first");
        let last = gap["last"].as_u64().expect("a number");
        assert_eq!((gap["kind"].as_str(), gap["first"].as_u64()), (Some("dropped"), Some(1)));
        assert_eq!(gap["count"].as_u64(), Some(last));
        // Each event behind the gap is there, in order, with its own time.
        let mut number = last;
        for event in events {
            number += 1;
            assert_eq!(event["number"].as_u64(), Some(number));
            assert_eq!(event["value"].as_u64(), Some(number - 1));
        }
        assert_eq!(number, DAY);
        assert!(DAY - last > 800, "only as many were dropped as had to be: {last}");
        assert_eq!((keeper.outbox.count(), keeper.outbox.bytes()), (0, 0));
        let held = format!("{last} dropped and told, {} came, in order", DAY - last);
        g7_peers::faults::row(16, "one event a second", DAY, 0, held);
    }

    /// A broker that takes less than there is, over connections that break with letters on their way.
    #[test]
    fn row_16_a_slow_broker_hears_which_events_were_dropped() {
        let mut keeper = keeper("slow", Limits { count: 300, bytes: 1 << 20 });
        let noted: Vec<Noted> = (0..3_000).map(|n| (1_000 * n, json!({ "kind": "forced" }))).collect();
        let (mut heard, mut turn, mut sent) = (Vec::new(), 0, i64::MIN);
        let mut on_the_way: Vec<Letter> = Vec::new();
        for (round, some) in noted.chunks(24).enumerate() {
            keeper.step(some);
            if round % 7 == 6 {
                on_the_way.clear();
                sent = i64::MIN;
            }
            for letter in on_the_way.drain(..) {
                keeper.mail.take(letter.number);
                heard.push(letter.payload);
            }
            for _ in 0..20 {
                let Some((of, letter)) = keeper.mail.next(turn, sent) else { break };
                (turn, sent) = (of, letter.number);
                on_the_way.push(letter);
            }
        }
        let late = taken(&mut keeper).into_iter();
        let events = heard.iter().map(|bytes| serde_json::from_slice(bytes).expect("JSON")).chain(late);
        // Each number is an event, or between the first and the last of those that were dropped.
        let (mut known, mut drops) = (0, 0);
        for event in events {
            let number = event["number"].as_u64().expect("a number");
            let first = event["first"].as_u64().unwrap_or(number);
            assert!(first <= known + 1, "{event} follows {known}");
            known = known.max(number);
            drops += u64::from(event["kind"] == "dropped");
        }
        assert_eq!(known, 3_000);
        assert!(drops > 1, "the broker was too slow more than once");
        assert_eq!(keeper.outbox.count(), 0);
    }

    #[test]
    fn events_that_the_disk_refuses_are_kept_or_counted() {
        let mut keeper = keeper("refused", Limits { count: 100_000, bytes: 1 << 30 });
        let other = rusqlite::Connection::open(
            std::env::temp_dir().join(format!("g7-post-refused-{}/events", std::process::id())),
        );
        let other = other.expect("opened");
        let refuse = "CREATE TRIGGER no BEFORE INSERT ON waiting BEGIN SELECT RAISE(ABORT, 'no'); END";
        other.execute_batch(refuse).expect("refuses from here on");
        let some = |from: u64| -> Vec<Noted> {
            (from..from + 4_000).map(|n| (1_000 * n, json!({ "kind": "forced", "value": n }))).collect()
        };
        for from in [0, 4_000, 8_000, 12_000] {
            keeper.step(&some(from));
        }
        assert!(keeper.told.as_ref().is_some_and(|why| why.contains("cannot be written")));
        other.execute_batch("DROP TRIGGER no").expect("takes them again");
        let events = taken(&mut keeper);
        assert_eq!((events[0]["kind"].as_str(), events[0]["count"].as_u64()), (Some("lost"), Some(6_000)));
        // Those behind the lost ones are all there, in order.
        let values: Vec<u64> = events[1..].iter().filter_map(|event| event["value"].as_u64()).collect();
        assert_eq!(values, (6_000..16_000).collect::<Vec<u64>>());
    }

    #[test]
    fn events_have_a_number_a_time_and_what_they_are() {
        let mut keeper = keeper("form", Limits { count: 100, bytes: 100_000 });
        keeper.step(&[(1_764_041_726_123, json!({ "kind": "stop", "level": "note" }))]);
        let expected = json!({
            "number": 1, "at": "2025-11-25T03:35:26.123Z", "kind": "stop", "level": "note"
        });
        assert_eq!(taken(&mut keeper), [expected]);
        // A broker that refuses is told once, and once that it takes events again.
        keeper.mail.refuse("no".to_owned());
        assert_eq!(keeper.step(&[]), Some(Some("no".to_owned())));
        assert_eq!(keeper.step(&[]), None);
        keeper.step(&[(0, json!({ "kind": "run" }))]);
        taken(&mut keeper);
        assert_eq!(keeper.told, None);
    }
}
