//! The run that an editor follows: a connection to `g7 serve` on this machine, on a thread of its own.
//!
//! ```text
//! g7 serve: runs that pages share, or the controller of --online -> WebSocket -> Follower -> Shown
//!                                                      answers (inlay values) <---------------|
//! ```
//!
//! # What must hold
//!
//! - It only watches; it never starts, stops or changes a run.
//! - The thread ends with the follower, however silent the server is.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::net::{IpAddr, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use g7_host::{Clock as _, WallClock};
use g7_ide::inlays::Present;
use g7_model::Nanos;
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Error, Message, WebSocket};

/// Time after which the thread looks whether it is to end, and an unanswered connection is given up.
const LOOK: Duration = Duration::from_millis(200);
const SLOWEST: Duration = Duration::from_secs(5);
/// Looks between two attempts to connect.
const AGAIN: u32 = 10;
/// Time between two tellings of something else that is shown, and between two questions for new runs.
const EACH: Nanos = Nanos::from_millis(500);
const ANEW: Nanos = Nanos::from_millis(2000);
/// The name of a controller beside the runs. No run has it: their names have no control letters.
const ONLINE: &str = "\u{1}";

/// The present states of the runs of a server, by the file of each as the server names it.
#[derive(Clone, Default)]
pub(super) struct Shown(Arc<Mutex<BTreeMap<String, Run>>>);

/// A run as its frames have told it.
#[derive(Default)]
struct Run {
    file: String,
    names: Vec<String>,
    /// Chart and name of each step.
    steps: Vec<(String, String)>,
    present: Present,
}

impl Shown {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<String, Run>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The present state of the run of a file: of those whose file is an end of its path, the longest.
    pub(super) fn of(&self, path: &str) -> Option<Present> {
        let runs = self.lock();
        let ends = |run: &&Run| {
            let file = run.file.trim_start_matches("./");
            let rest = path.strip_suffix(file);
            !file.is_empty()
                && rest.is_some_and(|rest| {
                    rest.is_empty() || rest.ends_with(['/', '\\']) || file.starts_with('/')
                })
        };
        runs.values().filter(ends).max_by_key(|run| run.file.len()).map(|run| run.present.clone())
    }
}

/// The address of a server with its token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Address {
    host: String,
    token: String,
}

impl Address {
    /// Reads an address as `g7 serve` prints it; one of another machine is refused.
    pub(super) fn read(text: &str) -> Result<Address, String> {
        let wrong =
            || format!("`{text}` is no address as `g7 serve` prints it: http://127.0.0.1:4700/?token=…");
        let rest = text.trim().strip_prefix("http://").ok_or_else(wrong)?;
        let (host, query) = rest.split_once('/').ok_or_else(wrong)?;
        let token = query.split(['?', '&']).find_map(|part| part.strip_prefix("token=")).ok_or_else(wrong)?;
        let token = token.split('#').next().unwrap_or_default();
        let name = host.rsplit_once(':').map_or(host, |(name, _)| name);
        let bare = name.trim_start_matches('[').trim_end_matches(']');
        let here = bare == "localhost" || bare.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback());
        if !here {
            return Err(format!("`{name}` is another machine; only a server on this one is followed"));
        }
        let signs = token.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'_'));
        if token.is_empty() || !signs {
            return Err(wrong());
        }
        let host = if name == host { format!("{host}:80") } else { host.to_owned() };
        Ok(Address { host, token: token.to_owned() })
    }
}

/// The thread that follows a server; it ends when this is dropped.
pub(super) struct Follower {
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Follower {
    /// Begins to follow. `changed` is called when something else is shown; `lost` when the server cannot be
    /// reached or is gone, once each time.
    pub(super) fn start(
        address: Address,
        shown: Shown,
        changed: impl Fn() + Send + 'static,
        lost: impl Fn(String) + Send + 'static,
    ) -> Result<Follower, String> {
        let over = Arc::new(AtomicBool::new(false));
        let ends = Arc::clone(&over);
        let work = move || {
            let mut told = false;
            while !ends.load(Ordering::Relaxed) {
                let broken = follow(&address, &shown, &ends, &changed, &mut told);
                if !shown.lock().is_empty() {
                    shown.lock().clear();
                    changed();
                }
                if let Err(why) = broken
                    && !std::mem::replace(&mut told, true)
                {
                    lost(format!("no run can be seen at {}: {why}", address.host));
                }
                let waits = (0..AGAIN).take_while(|_| !ends.load(Ordering::Relaxed));
                waits.for_each(|_| std::thread::sleep(LOOK));
            }
        };
        let thread = std::thread::Builder::new().name("follow".to_owned()).spawn(work);
        Ok(Follower { over, thread: Some(thread.map_err(|e| format!("nothing can be followed: {e}"))?) })
    }
}

impl Drop for Follower {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

type Line = WebSocket<TcpStream>;

/// Follows all runs of a server until the connection breaks or the thread is to end.
fn follow(
    address: &Address,
    shown: &Shown,
    ends: &AtomicBool,
    changed: &impl Fn(),
    told: &mut bool,
) -> Result<(), String> {
    let mut line = connect(address)?;
    *told = false;
    // Answers are known by their numbers: 1 lists the runs, 2 is the controller, others watch a run.
    let mut watched: BTreeMap<u64, String> = BTreeMap::from([(2, ONLINE.to_owned())]);
    let mut next = 3;
    ask(&mut line, 1, &json!({ "do": "runs" }))?;
    ask(&mut line, 2, &json!({ "do": "operator_watch" }))?;
    let mut clock = WallClock::default();
    let (mut dirty, mut due, mut anew) = (false, clock.now(), clock.now() + ANEW);
    while !ends.load(Ordering::Relaxed) {
        let now = clock.now();
        if dirty && now >= due {
            (dirty, due) = (false, now + EACH);
            changed();
        }
        if now >= anew {
            // Runs that have begun in the meantime.
            anew = now + ANEW;
            ask(&mut line, 1, &json!({ "do": "runs" }))?;
        }
        let text = match line.read() {
            Ok(Message::Text(text)) => text,
            Ok(_) => continue,
            Err(Error::Io(e)) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => continue,
            Err(e) => return Err(e.to_string()),
        };
        let Ok(message) = serde_json::from_str::<Value>(&text) else { continue };
        if message["id"] == 1 {
            for run in message["answer"]["ok"]["runs"].as_array().into_iter().flatten() {
                let Some(name) = run["run"].as_str() else { continue };
                if !watched.values().any(|known| known == name) {
                    ask(&mut line, next, &json!({ "do": "watch", "run": name }))?;
                    watched.insert(next, name.to_owned());
                    next += 1;
                }
            }
        } else if message["operator"]["renew"] == true {
            ask(&mut line, 2, &json!({ "do": "operator_watch" }))?;
        } else if let Some(ended) = message["ended"]["run"].as_str() {
            watched.retain(|_, run| run != ended);
            dirty |= shown.lock().remove(ended).is_some();
        } else {
            dirty |= hear(&message, &watched, &mut shown.lock());
        }
    }
    line.close(None).ok();
    line.flush().ok();
    Ok(())
}

/// Takes what a message tells of a run; true if something else is shown now.
fn hear(message: &Value, watched: &BTreeMap<u64, String>, runs: &mut BTreeMap<String, Run>) -> bool {
    let by_answer = message["id"].as_u64().and_then(|id| watched.get(&id));
    let told = &message["answer"]["ok"];
    let (name, begun, frame) = match by_answer {
        Some(_) if !told["signals"].is_array() => return false,
        Some(name) => (name.as_str(), Some(told), &told["frame"]),
        None if message["started"].is_object() => {
            let told = &message["started"];
            (told["run"].as_str().unwrap_or_default(), Some(told), &told["frame"])
        }
        None if message["operator"].is_object() => (ONLINE, None, &message["operator"]),
        None => (message["frame"]["run"].as_str().unwrap_or_default(), None, &message["frame"]),
    };
    if let Some(begun) = begun {
        runs.insert(name.to_owned(), Run::new(begun));
    }
    let Some(run) = runs.get_mut(name) else { return false };
    let before = run.present.clone();
    run.take(frame);
    begun.is_some() || run.present != before
}

impl Run {
    fn new(told: &Value) -> Run {
        let text = |value: &Value| value.as_str().unwrap_or_default().replace('`', "");
        let list = |key: &str| told[key].as_array().map(Vec::as_slice).unwrap_or_default();
        let step = |row: &Value| {
            let id = row["id"].as_str().unwrap_or_default();
            let (chart, name) = id.split_once("/s/").unwrap_or_default();
            (chart.to_owned(), name.to_owned())
        };
        Run {
            file: told["file"].as_str().unwrap_or_default().to_owned(),
            names: list("signals").iter().map(|row| text(&row["name"])).collect(),
            steps: list("steps").iter().map(step).collect(),
            present: Present::default(),
        }
    }

    /// Takes a frame: values that have changed; of a run what became active, of a controller all that is.
    fn take(&mut self, frame: &Value) {
        for row in frame["values"].as_array().into_iter().flatten() {
            let name = row[0].as_u64().and_then(|k| self.names.get(usize::try_from(k).ok()?));
            if let (Some(name), Some(value)) = (name, row[1].as_str()) {
                self.present.values.insert(name.clone(), value.to_owned());
            }
        }
        let step = |k: &Value| k.as_u64().and_then(|k| self.steps.get(usize::try_from(k).ok()?)).cloned();
        let numbers = |key: &str| frame[key].as_array().map(Vec::as_slice).unwrap_or_default();
        for gone in numbers("off").iter().filter_map(step) {
            self.present.active.remove(&gone);
        }
        // That of a controller has no `off`: its frames name all that is active.
        if frame["on"].is_array() && !frame["off"].is_array() || frame["full"] == true {
            self.present.active.clear();
        }
        for row in numbers("on") {
            let (number, ms) = if row.is_array() { (&row[0], row[1].as_f64()) } else { (row, None) };
            if let Some(step) = step(number) {
                self.present.active.insert(step, ms.unwrap_or(0.0));
            }
        }
        for (number, ms) in frame["times"].as_object().into_iter().flatten() {
            let known = number.parse::<usize>().ok().and_then(|k| self.steps.get(k));
            if let (Some(step), Some(ms)) = (known, ms.as_f64()) {
                self.present.active.insert(step.clone(), ms);
            }
        }
    }
}

fn connect(address: &Address) -> Result<Line, String> {
    let stream = TcpStream::connect(&address.host).map_err(|e| e.to_string())?;
    let limit =
        |time| stream.set_read_timeout(Some(time)).and_then(|()| stream.set_write_timeout(Some(SLOWEST)));
    limit(SLOWEST).map_err(|e| e.to_string())?;
    let mut request =
        format!("ws://{}/api/live", address.host).into_client_request().map_err(|e| e.to_string())?;
    let pass = format!("Bearer {}", address.token).parse();
    request.headers_mut().insert("Authorization", pass.map_err(|_| "the token cannot be sent".to_owned())?);
    let (line, _) = tungstenite::client(request, stream).map_err(|e| e.to_string())?;
    line.get_ref().set_read_timeout(Some(LOOK)).map_err(|e| e.to_string())?;
    Ok(line)
}

fn ask(line: &mut Line, id: u64, call: &Value) -> Result<(), String> {
    let text = json!({ "id": id, "call": call }).to_string();
    line.send(Message::text(text)).map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_server_of_this_machine_is_followed() {
        let read = |text| Address::read(text).map(|a| (a.host, a.token));
        let both = |host: &str| Ok((host.to_owned(), "a-b_9".to_owned()));
        assert_eq!(read("http://127.0.0.1:4700/?token=a-b_9"), both("127.0.0.1:4700"));
        assert_eq!(read("http://[::1]:4700/?file=x&token=a-b_9#top"), both("[::1]:4700"));
        assert_eq!(read("http://localhost/?token=a-b_9"), both("localhost:80"));
        assert!(read("http://10.0.0.7:4700/?token=a").is_err_and(|why| why.contains("another machine")));
        for wrong in [
            "",
            "127.0.0.1:4700",
            "http://127.0.0.1:4700/",
            "http://127.0.0.1:4700/?token=",
            "http://127.0.0.1/?token=a%0d",
        ] {
            assert!(read(wrong).is_err_and(|why| why.contains("no address")), "{wrong}");
        }
    }

    #[test]
    fn frames_add_up_to_what_is_shown() {
        let mut runs = BTreeMap::new();
        let watched = BTreeMap::from([(3, "chart.g7".to_owned())]);
        let begun = json!({ "id": 3, "answer": { "ok": {
            "file": "chart.g7", "signals": [{ "name": "go" }, { "name": "`step`" }],
            "steps": [{ "id": "G/s/0" }, { "id": "G/s/1" }],
            "frame": { "run": "chart.g7", "full": true, "on": [0], "off": [], "times": { "0": 40.0 },
                       "values": [[0, "FALSE", 0.0], [1, "3", 3.0]] },
        } } });
        assert!(hear(&begun, &watched, &mut runs));
        let next = json!({ "frame": { "run": "chart.g7", "on": [1], "off": [0], "times": { "1": 0.0 },
            "values": [[0, "TRUE", 1.0]] } });
        assert!(hear(&next, &watched, &mut runs));
        assert!(!hear(&next, &watched, &mut runs), "nothing new");
        let shown = Shown(Arc::new(Mutex::new(runs)));
        let present = shown.of("/plant/chart.g7").expect("a run");
        assert_eq!(
            present.values,
            [("go", "TRUE"), ("step", "3")].map(|(n, v)| (n.to_owned(), v.to_owned())).into()
        );
        assert_eq!(present.active, [(("G".to_owned(), "1".to_owned()), 0.0)].into());
        assert_eq!(shown.of("/plant/otherchart.g7"), None);
        assert_eq!(shown.of("/plant/other.g7"), None);
    }
}
