//! One shared run: its page, its speed, and the pages that watch it.
//!
//! Frames are sent to every watcher in the order of the events, so that all see the same. The speed
//! follows absolute instants of the wall clock, whatever messages come in between. A run that is
//! too heavy for its speed becomes slower but still answers: its scans take at most half of a tick, or one scan.

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Weak};
use std::time::Duration;

use axum::extract::ws::Utf8Bytes;
use g7_host::{Clock as _, WallClock};
use g7_model::Nanos;
use g7_page::Page;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::json;
use serde_json::value::RawValue;

use super::outbox::Outbox;
use super::registry::{Order, Registry, What};

/// Time between two advances of a running run, in nanoseconds: 25 advances a second.
const TICK: Nanos = Nanos::from_millis(40);
/// If only the time has changed, every n-th advance is shown.
const QUIET: u32 = 5;
/// Longest time of the scans of one advance: the rest of the tick is for orders.
const SCANS: Nanos = Nanos::from_millis(20);
/// Longest time of the scans of one order, such as "advance by an hour". Other orders wait until it has ended.
const ASKED: Nanos = Nanos::from_millis(2_000);
/// Greatest length of an answer, in bytes.
const LARGEST: usize = 16 << 20;

/// A run, its clock and its watchers.
pub(super) struct Desk {
    run: Arc<str>,
    number: u64,
    registry: Arc<Registry>,
    page: Page,
    watchers: Vec<Weak<Outbox>>,
    /// True while the page has the run.
    started: bool,
    speed: f64,
    /// A clock that runs at the speed of the run.
    clock: WallClock,
    /// The time of `clock` up to which the run was advanced.
    given: Nanos,
    wall: WallClock,
    /// The instant of the wall clock at which the run is advanced next.
    due: Nanos,
    /// Number of advances since the last frame was shown.
    quiet: u32,
}

/// The parts of a frame that the server needs to know.
#[derive(Deserialize)]
struct Peek {
    now_ms: f64,
    stopped: Option<IgnoredAny>,
    halt: Option<IgnoredAny>,
    on: Vec<IgnoredAny>,
    off: Vec<IgnoredAny>,
    enabled: Vec<IgnoredAny>,
    cleared: Vec<IgnoredAny>,
    values: Vec<IgnoredAny>,
    forced: Vec<IgnoredAny>,
    view: Vec<IgnoredAny>,
    #[serde(default)]
    notes: Vec<IgnoredAny>,
}

impl Peek {
    fn is_news(&self) -> bool {
        let lists =
            [&self.on, &self.off, &self.enabled, &self.cleared, &self.values, &self.forced, &self.view];
        lists.iter().any(|l| !l.is_empty()) || !self.notes.is_empty() || self.ends()
    }

    fn ends(&self) -> bool {
        self.stopped.is_some() || self.halt.is_some()
    }
}

impl Desk {
    pub(super) fn new(run: Arc<str>, number: u64, registry: Arc<Registry>) -> Desk {
        let mut clock = WallClock::default();
        clock.hold(true);
        Desk {
            run,
            number,
            registry,
            page: Page::new(),
            watchers: Vec::new(),
            started: false,
            speed: 0.0,
            clock,
            given: Nanos::ZERO,
            wall: WallClock::default(),
            due: Nanos::ZERO,
            quiet: 0,
        }
    }

    /// Processes orders until the run is stopped.
    pub(super) fn work(mut self, orders: &Receiver<Order>) {
        loop {
            let order = if self.speed == 0.0 {
                orders.recv().map_err(|_| RecvTimeoutError::Disconnected)
            } else {
                let left = (self.due - self.wall.now()).max(Nanos::ZERO);
                orders.recv_timeout(Duration::from_nanos(left.count() as u64))
            };
            match order {
                Ok(Order::Asked { by, id, what, done }) => {
                    let answer = self.answer(&by, what);
                    by.put(answered(id, &answer));
                    if !self.started {
                        // Watchers are told first, because the next call of the page may start the
                        // run again.
                        self.end();
                        done.send(()).ok();
                        return;
                    }
                    done.send(()).ok();
                }
                Ok(Order::CatchUp(outbox)) => self.catch_up(&outbox),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            // The run is advanced when it is due, however many orders come in.
            if self.speed > 0.0 && self.wall.now() >= self.due {
                self.look();
            }
        }
    }

    fn answer(&mut self, by: &Arc<Outbox>, what: What) -> String {
        match what {
            What::Watch if !self.started => no("there is no such run"),
            What::Watch => {
                self.flush(None);
                self.enter(by);
                let told = self.page.call(&json!({ "do": "run_signals", "run": *self.run }).to_string());
                self.with_speed(&told)
            }
            What::Unwatch => {
                self.watchers.retain(|w| w.upgrade().is_some_and(|w| !Arc::ptr_eq(&w, by)));
                r#"{"ok":null}"#.to_owned()
            }
            What::Pace(speed) => {
                self.pace(speed);
                json!({ "ok": { "run": *self.run, "speed": speed } }).to_string()
            }
            What::Call { message, text } => {
                let answer = self.call(by, &message, text);
                if answer.len() > LARGEST {
                    return no("this is too much at once: choose fewer signals or a shorter time");
                }
                answer
            }
        }
    }

    /// Passes a message of a client to the page of the run.
    fn call(&mut self, by: &Arc<Outbox>, message: &str, text: Option<String>) -> String {
        let Ok(mut wish) = serde_json::from_str::<serde_json::Map<_, _>>(message) else {
            return no("this message means nothing");
        };
        let what = wish.get("do").and_then(|w| w.as_str()).unwrap_or_default().to_owned();
        if what == "run_frame" && wish.get("full").is_some_and(|f| f == true) {
            // A full frame resets what the page regards as sent, so the others must get their
            // changes first.
            self.flush(None);
            return self.page.call(message);
        }
        let Some(text) = text else {
            let answer = self.within(ASKED, message);
            self.spread(by, &what, &answer);
            return answer;
        };
        // The file is open only as long as the run needs it.
        let file = wish.get("file").and_then(|f| f.as_str()).unwrap_or_default().to_owned();
        // The page sends the files that this one uses as it sees them, saved or not.
        let open = json!({ "do": "open", "file": file, "text": text, "uses": wish.remove("uses") });
        let opened = self.page.call(&open.to_string());
        let Some(Opened { file: open }) = ok(&opened).and_then(|v| serde_json::from_str(v.get()).ok()) else {
            return opened;
        };
        // An imported file is open under its new name.
        wish.insert("file".to_owned(), json!(open));
        wish.remove("text");
        let answer = self.page.call(&json!(wish).to_string());
        self.page.call(&json!({ "do": "close", "file": open }).to_string());
        if answer.len() > LARGEST {
            // Nobody could see a run whose signals are not told: it ends.
            self.started = false;
            return answer;
        }
        self.spread(by, &what, &answer);
        match what.as_str() {
            "run_start" if ok(&answer).is_some() => self.with_speed(&answer),
            _ => answer,
        }
    }

    /// Sends the effects of a call to the other watchers.
    fn spread(&mut self, by: &Arc<Outbox>, what: &str, answer: &str) {
        let Some(told) = ok(answer) else { return };
        match what {
            "run_start" => {
                self.started = true;
                self.pace(0.0);
                self.enter(by);
                self.head(by, told);
            }
            "run_swap" => self.head(by, told),
            "run_stop" => self.started = false,
            "run_breaks" => {
                let Ok(mut told) = serde_json::from_str::<serde_json::Map<_, _>>(told.get()) else { return };
                told.insert("run".to_owned(), json!(*self.run));
                self.notice(Some(by), &json!({ "breaks": told }).to_string());
            }
            _ => {
                if let Ok(peek) = serde_json::from_str::<Peek>(told.get()) {
                    self.frame(told, Some(by));
                    if peek.ends() {
                        self.pace(0.0);
                    }
                }
            }
        }
    }

    /// Announces a run that has started or continues with a changed chart.
    fn head(&mut self, by: &Arc<Outbox>, told: &RawValue) {
        #[derive(Deserialize)]
        struct Started {
            file: String,
            #[serde(rename = "signals")]
            _signals: IgnoredAny,
        }
        // If a change would lose something, the answer lists the losses and no run has started.
        let Ok(started) = serde_json::from_str::<Started>(told.get()) else { return };
        self.registry.tell(&self.run, self.number, |card| card.file = started.file);
        self.notice(Some(by), &format!(r#"{{"started":{told}}}"#));
    }

    /// Advances the run to the time of its clock.
    fn look(&mut self) {
        let began = self.wall.now();
        self.due += TICK;
        if self.due < began {
            self.due = began + TICK;
        }
        let now = self.clock.now();
        let ms = (now - self.given).as_millis();
        self.given = now;
        let message = json!({ "do": "run_advance", "run": *self.run, "ms": ms, "times": true });
        let answer = self.within(SCANS, &message.to_string());
        let Some((told, peek)) =
            ok(&answer).and_then(|t| Some((t, serde_json::from_str::<Peek>(t.get()).ok()?)))
        else {
            // A run that shows an earlier scan cannot go on.
            self.pace(0.0);
            return;
        };
        self.quiet += 1;
        if peek.is_news() || (self.quiet >= QUIET && peek.now_ms >= 0.0) {
            self.quiet = 0;
            self.frame(told, None);
        }
        if peek.ends() {
            self.pace(0.0);
        }
    }

    /// Calls the page; scans that take longer than this end early, after a whole scan.
    fn within(&mut self, time: Nanos, message: &str) -> String {
        let (mut wall, end) = (self.wall, self.wall.now() + time);
        self.page.call_while(message, move || wall.now() < end)
    }

    /// Sends changes that were not sent yet to all watchers.
    fn flush(&mut self, but: Option<&Arc<Outbox>>) {
        let rest = self.page.call(&json!({ "do": "run_frame", "run": *self.run, "times": true }).to_string());
        let news = |t: &RawValue| serde_json::from_str::<Peek>(t.get()).is_ok_and(|p| p.is_news());
        if let Some(told) = ok(&rest).filter(|t| news(t)) {
            self.frame(told, but);
        }
    }

    /// Sends one full frame to a client that missed frames.
    fn catch_up(&mut self, outbox: &Arc<Outbox>) {
        self.flush(Some(outbox));
        let wish = json!({ "do": "run_frame", "run": *self.run, "full": true, "times": true });
        if let Some(told) = ok(&self.page.call(&wish.to_string())) {
            outbox.full(&self.run, format!(r#"{{"frame":{told}}}"#).into());
        }
    }

    fn pace(&mut self, speed: f64) {
        if speed > 0.0 {
            self.clock.set_speed(speed);
            self.clock.hold(false);
            self.given = self.clock.now();
            self.due = self.wall.now() + TICK;
        } else {
            self.clock.hold(true);
        }
        if self.speed != speed {
            self.speed = speed;
            self.registry.tell(&self.run, self.number, |card| card.speed = speed);
            self.notice(None, &json!({ "pace": { "run": *self.run, "speed": speed } }).to_string());
        }
    }

    fn enter(&mut self, by: &Arc<Outbox>) {
        if !self.watching().any(|w| Arc::ptr_eq(&w, by)) {
            self.watchers.push(Arc::downgrade(by));
        }
    }

    /// The watchers that still exist.
    fn watching(&mut self) -> impl Iterator<Item = Arc<Outbox>> {
        self.watchers.retain(|w| w.strong_count() > 0);
        self.watchers.iter().filter_map(Weak::upgrade)
    }

    fn frame(&mut self, told: &RawValue, but: Option<&Arc<Outbox>>) {
        let run = Arc::clone(&self.run);
        let text: Utf8Bytes = format!(r#"{{"frame":{told}}}"#).into();
        let others = self.watching().filter(|w| but.is_none_or(|b| !Arc::ptr_eq(w, b)));
        others.for_each(|w| w.frame(&run, text.clone()));
    }

    fn notice(&mut self, but: Option<&Arc<Outbox>>, text: &str) {
        let text: Utf8Bytes = text.into();
        let others = self.watching().filter(|w| but.is_none_or(|b| !Arc::ptr_eq(w, b)));
        others.for_each(|w| w.put(text.clone()));
    }

    fn end(&mut self) {
        self.registry.close(&self.run, self.number);
        self.notice(None, &json!({ "ended": { "run": *self.run } }).to_string());
    }

    /// Adds the speed of the run to the description of its start.
    fn with_speed(&self, answer: &str) -> String {
        match answer.strip_suffix("}}") {
            Some(front) => format!(r#"{front},"speed":{}}}}}"#, json!(self.speed)),
            None => answer.to_owned(),
        }
    }
}

impl Drop for Desk {
    /// Removes the run even if the thread ended by a panic.
    fn drop(&mut self) {
        self.registry.close(&self.run, self.number);
    }
}

/// The name under which a file is open.
#[derive(Deserialize)]
struct Opened {
    file: String,
}

/// The value of a successful answer, which may be `null`; `None` for a refusal.
fn ok(answer: &str) -> Option<&RawValue> {
    serde_json::from_str(answer.strip_prefix(r#"{"ok":"#)?.strip_suffix('}')?).ok()
}

fn no(why: &str) -> String {
    json!({ "no": why }).to_string()
}

fn answered(id: u64, answer: &str) -> Utf8Bytes {
    format!(r#"{{"id":{id},"answer":{answer}}}"#).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outer_form_is_that_of_the_page() {
        assert_eq!(ok(r#"{"ok":{"a":1}}"#).map(RawValue::get), Some(r#"{"a":1}"#));
        assert!(ok(&no("a \"word\"")).is_none());
        assert_eq!(answered(7, &no("why")).as_str(), r#"{"id":7,"answer":{"no":"why"}}"#);
        assert_eq!(ok(r#"{"ok":null}"#).map(RawValue::get), Some("null"));
    }
}
