//! A class at one server: pages that come, work together, drive shared runs and go; a few for seconds in each test, and fifty
//! for an hour with `make page-soak`. The memory of the server must not grow with time.
#![cfg(target_os = "linux")]

use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use g7_host::{Clock as _, WallClock};
use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

use crate::common::{Folder, PINGPONG};
use crate::serve::Served;

/// Pages at the same time: in the hour, and beside the other tests, whose times they must not disturb.
const PAGES: u64 = 50;
const FEW: u64 = 8;
/// Time between two wishes of a page.
const PAUSE: Duration = Duration::from_millis(40);
/// Wishes of a page from its coming to its going.
const WISHES: u64 = 200;
/// Files at which they are.
const FILES: u64 = 5;

/// A page by its WebSocket.
struct Page {
    socket: WebSocket<TcpStream>,
    next: u64,
    /// The newest version of the text that it has heard of.
    version: u64,
}

impl Page {
    fn new(server: &Served, window: u64) -> Page {
        let address = format!("ws://{}/api/live?token={}&window=w{window}", server.host, server.token);
        let (socket, _) = tungstenite::client(address, server.connect()).expect("a WebSocket");
        Page { socket, next: 1, version: 0 }
    }

    /// The answer to a wish; what others do is heard meanwhile.
    fn ask(&mut self, call: &Value) -> Value {
        let id = self.next;
        self.next += 1;
        let text = json!({ "id": id, "call": call }).to_string();
        self.socket.send(Message::text(text)).expect("an open socket");
        loop {
            let Message::Text(text) = self.socket.read().expect("an answer") else { continue };
            let said: Value = serde_json::from_str(&text).expect("JSON");
            if let Some(version) = said["together"]["change"]["version"].as_u64() {
                self.version = version;
            }
            if said["id"] == id {
                return said["answer"].clone();
            }
        }
    }

    /// One of the things that people do.
    fn does(&mut self, number: u64, file: &str) {
        match number % 8 {
            0 => drop(self.ask(
                &json!({ "do": "pace", "run": file, "speed": if number.is_multiple_of(16) { 1.0 } else { 0.0 } }),
            )),
            1 => drop(self.ask(&json!({ "do": "run_frame", "run": file, "full": true }))),
            2 | 5 => {
                let here = json!({ "chart": "G", "point": [number as f64, 2.5], "select": ["G/s/1"], "text": [0, 3] });
                self.ask(&json!({ "do": "together_here", "file": file, "here": here }));
            }
            3 => drop(self.ask(&json!({ "do": "run_advance", "run": file, "ms": 10, "times": true }))),
            _ => {
                let splices = json!([{ "from": 3, "to": 4, "insert": (number % 10).to_string() }]);
                let key = format!("{file} {number} {}", self.next);
                let asked = json!({ "do": "together_change", "file": file, "version": self.version, "splices": splices, "key": key });
                let told = self.ask(&asked);
                assert!(told["ok"].is_object(), "{told}");
                if let Some(version) = told["ok"]["version"].as_u64() {
                    self.version = version;
                }
            }
        }
    }
}

/// A person who comes, works and goes, again and again until the end.
fn comes_and_goes(server: &Served, seat: u64, over: &AtomicBool, wishes: &AtomicU64) {
    let file = format!("chart{}.g7", seat % FILES);
    for visit in 0.. {
        let mut page = Page::new(server, seat);
        let watched = page.ask(&json!({ "do": "watch", "run": file }));
        if watched["ok"].is_null() {
            page.ask(&json!({ "do": "run_start", "run": file, "file": file }));
        }
        let text = format!("// 0\n{PINGPONG}");
        let joined = page
            .ask(&json!({ "do": "together_join", "file": file, "name": "Ana", "text": text, "edits": true }));
        page.version = joined["ok"]["version"].as_u64().expect("a version");
        // Not all come and go at the same time.
        for number in 0..WISHES / 2 + (seat * 7 + visit * 13) % WISHES {
            if over.load(Ordering::Relaxed) {
                return;
            }
            page.does(number + seat, &file);
            wishes.fetch_add(1, Ordering::Relaxed);
            std::thread::sleep(PAUSE);
        }
        // Every other one goes without a word.
        if visit % 2 == 0 {
            page.socket.close(None).ok();
            page.socket.flush().ok();
        }
    }
}

#[test]
fn a_class_takes_no_more_memory_as_time_goes_on() {
    let minutes = std::env::var("G7_SOAK_MINUTES").ok().map(|text| text.parse::<u64>().expect("minutes"));
    let time = minutes.map_or(Duration::from_secs(8), |minutes| Duration::from_secs(60 * minutes));
    let pages = if minutes.is_some() { PAGES } else { FEW };
    let folder = Folder::new();
    for number in 0..FILES {
        folder.write(&format!("chart{number}.g7"), PINGPONG);
    }
    let server = Served::new(&folder, &["--port", "0"]);
    let (over, wishes) = (AtomicBool::new(false), AtomicU64::new(0));
    let mut clock = WallClock::default();
    let mut taken = Vec::new();
    std::thread::scope(|scope| {
        for seat in 0..pages {
            let (server, over, wishes) = (&server, &over, &wishes);
            scope.spawn(move || comes_and_goes(server, seat, over, wishes));
        }
        while clock.now().as_millis() < time.as_millis() as f64 {
            std::thread::sleep(time / 60);
            taken.push(server.memory("VmRSS"));
            if minutes.is_some() {
                let (seconds, mb) =
                    (clock.now().as_millis() / 1000.0, server.memory("VmRSS") as f64 / 1024.0);
                println!("{seconds:5.0} s  {mb:6.1} MB  {} wishes", wishes.load(Ordering::Relaxed));
            }
        }
        over.store(true, Ordering::Relaxed);
    });
    assert!(wishes.load(Ordering::Relaxed) > pages, "they did something");
    // The first third does not count, because the server opens its files and runs then.
    let most =
        |from: usize, to: usize| taken[taken.len() * from / 3..taken.len() * to / 3].iter().max().copied();
    let (second, last) = (most(1, 2).expect("samples"), most(2, 3).expect("samples"));
    println!("second third {second} kB, last third {last} kB");
    let more = if minutes.is_some() { 2_048 } else { 8_192 };
    assert!(last < second + more, "{second} kB became {last} kB");
}
