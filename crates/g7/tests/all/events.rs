//! A broker over TLS, and the events of a controller: mosquitto, which is killed, refuses, and has
//! certificates that are none.
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

use crate::common;

use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};

use common::Folder;
use common::broker::{Broker, own_port};
use common::talk::Running;
use g7_peers::faults::{many, row};
use rcgen::{BasicConstraints, CertificateParams, CertifiedIssuer, IsCa, KeyPair, date_time_ymd};
use serde_json::Value;

const CHART: &str = "\
input go : BOOL
output valve : BOOL
var n : DINT
chart Main {
  initial step 1
  step 2 { N valve  P1 n := n + 1 }
  1 -> 2 when go
  2 -> 1 when not go
}
";

/// Who signs certificates here.
fn issuer(name: &str) -> CertifiedIssuer<'static, KeyPair> {
    let mut params = CertificateParams::new(Vec::new()).expect("no names");
    params.distinguished_name.push(rcgen::DnType::CommonName, name);
    params.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
    CertifiedIssuer::self_signed(params, KeyPair::generate().expect("a key")).expect("signed")
}

/// A certificate for a name, valid until a year, and its key.
fn signed(by: &CertifiedIssuer<'static, KeyPair>, name: &str, until: i32) -> (String, String) {
    let mut params = CertificateParams::new(vec![name.to_owned()]).expect("a name");
    params.not_before = date_time_ymd(2001, 1, 1);
    params.not_after = date_time_ymd(until, 1, 1);
    let key = KeyPair::generate().expect("a key");
    let certificate = params.signed_by(&key, by).expect("signed");
    (certificate.pem(), key.serialize_pem())
}

/// A broker with TLS; `more` stands in its settings.
fn broker(port: u16, ca: &str, (certificate, key): &(String, String), more: &str) -> Option<Broker> {
    let settings = format!("allow_anonymous true\ncafile ca.pem\ncertfile own.pem\nkeyfile own.key\n{more}");
    Broker::with(port, &settings, &[("ca.pem", ca), ("own.pem", certificate), ("own.key", key)])
}

fn tls_folder(port: u16, tls: &str, ca: &str) -> Folder {
    let folder = Folder::with(CHART);
    folder.write("ca.pem", ca);
    folder.write(
        "chart.io.toml",
        format!(
            "[controller]\nwatchdog = '20s'\n[devices.hub]\nkind = 'mqtt'\nhost = '127.0.0.1'\nport = {port}\n\
             tls = {tls}\nretry = '200ms'\n[outputs]\nvalve = 'hub.topic(valve)'\n"
        ),
    );
    folder
}

#[test]
fn a_certificate_that_is_none_is_refused_and_tried_again() {
    let (ours, strange, port) = (issuer("ours"), issuer("strange"), own_port());
    let bad = [
        (signed(&ours, "127.0.0.1", 2020), "the certificate of the broker has expired"),
        (signed(&strange, "127.0.0.1", 2040), "of none that is trusted here: `ca` names"),
        (signed(&ours, "hub.example", 2040), "has another name than `host`"),
    ];
    let folder = tls_folder(port, "{ ca = 'ca.pem' }", &ours.pem());
    for (pair, why) in bad {
        let Some(expired) = broker(port, &ours.pem(), &pair, "") else { return };
        let mut g7 = Running::online(&folder, &[]);
        let line = g7.until("hub does not answer");
        assert!(line.contains(why), "{line}");
        let asked = folder.g7(&["devices"]);
        assert!(asked.is(1).out.contains(why), "{}", asked.out);
        // As soon as the broker has another one, it is let in.
        drop(expired);
        let _mended = broker(port, &ours.pem(), &signed(&ours, "127.0.0.1", 2040), "").expect("as before");
        g7.until("hub answers");
        assert_eq!(g7.quit(), 0);
    }
}

#[test]
fn a_broker_may_want_the_certificate_of_the_client() {
    let (ours, port) = (issuer("ours"), own_port());
    let own = signed(&ours, "127.0.0.1", 2040);
    let Some(hub) = broker(port, &ours.pem(), &own, "require_certificate true\n") else { return };
    let folder = tls_folder(port, "{ ca = 'ca.pem' }", &ours.pem());
    let mut g7 = Running::online(&folder, &[]);
    let line = g7.until("hub does not answer");
    assert!(line.contains("wants a `certificate` of this client"), "{line}");
    assert_eq!(g7.quit(), 0);
    let (certificate, key) = signed(&ours, "sorter", 2040);
    let folder = tls_folder(port, "{ ca = 'ca.pem', certificate = 'own.pem', key = 'own.key' }", &ours.pem());
    folder.write("own.pem", &certificate);
    folder.write("own.key", &key);
    let mut g7 = Running::online(&folder, &[]);
    g7.until("hub answers");
    assert_eq!(g7.quit(), 0);
    // A key of somebody else, and files that are none, have a place in the io file.
    folder.write("own.key", signed(&ours, "other", 2040).1);
    let refused = folder.g7(&["devices"]);
    assert!(refused.is(1).err.contains("it is not the key of this `certificate`"), "{}", refused.err);
    assert!(refused.err.contains("chart.io.toml:7:"), "{}", refused.err);
    folder.write("own.pem", "no certificate");
    assert!(folder.g7(&["devices"]).is(1).err.contains("no certificate in the form PEM"));
    std::fs::remove_file(folder.path("ca.pem")).expect("it was there");
    assert!(folder.g7(&["devices"]).is(1).err.contains("the file cannot be read"));
    drop(hub);
}

#[test]
fn a_broker_without_tls_is_told_apart() {
    let Some(broker) = Broker::start() else { return };
    let folder = tls_folder(broker.port, "{ ca = 'ca.pem' }", &issuer("ours").pem());
    let mut g7 = Running::online(&folder, &[]);
    g7.until("hub does not answer");
    assert_eq!(g7.quit(), 0);
}

fn event_folder(port: u16, more: &str) -> Folder {
    let folder = Folder::with(CHART);
    folder.write(
        "chart.io.toml",
        format!(
            "[controller]\nwatchdog = '60s'\nperiod = '1ms'\n[devices.hub]\nkind = 'mqtt'\nhost = '127.0.0.1'\n\
             port = {port}\nretry = '100ms'\npoll = '1ms'\n{more}"
        ),
    );
    folder
}

/// The events that come, until one is of this kind.
fn events_until(watch: &mut common::broker::Watch, kind: &str) -> Vec<Value> {
    let mut events = Vec::new();
    loop {
        let (topic, payload) = watch.next();
        assert_eq!(topic, "plant/events");
        let event: Value = serde_json::from_str(&payload).unwrap_or_else(|e| panic!("{payload}: {e}"));
        let last = event["kind"] == kind;
        events.push(event);
        if last {
            return events;
        }
    }
}

#[test]
fn events_are_published_with_number_and_time_and_wait_for_a_broker() {
    let Some(broker) = Broker::start() else { return };
    let mut watch = broker.watch();
    let folder = event_folder(broker.port, "events = 'plant/events'\n");
    let mut g7 = Running::online(&folder, &[]);
    let events = events_until(&mut watch, "up");
    assert_eq!(events[0]["number"], 1, "{events:#?}");
    assert!(events.iter().any(|e| e["kind"] == "run" && e["level"] == "note"), "{events:#?}");
    let up = events.last().expect("one at least");
    assert_eq!((up["device"].as_str(), up["text"].as_str()), (Some("hub"), Some("hub answers")));
    let at = up["at"].as_str().expect("a time");
    assert!(at.starts_with("20") && at.ends_with('Z') && at.len() == 24, "{at}");
    g7.say("force n := 7 for 1h");
    let forced = events_until(&mut watch, "forced").pop().expect("one");
    assert_eq!((forced["name"].as_str(), forced["value"].as_str()), (Some("n"), Some("7")));
    // The broker goes away and forgets all; what happened meanwhile comes when it is back.
    let port = broker.port;
    drop(broker);
    g7.until("hub does not answer");
    g7.say("stop");
    g7.until("stopped");
    assert_eq!(g7.quit(), 0);
    assert!(folder.names().iter().any(|name| name == "hub.events"), "{:?}", folder.names());
    let broker = Broker::with(port, "allow_anonymous true\n", &[]).expect("it was there before");
    let mut watch = broker.watch();
    // Also over the end of G7.
    let g7 = Running::online(&folder, &[]);
    let events = events_until(&mut watch, "up");
    let kinds: Vec<&str> = events.iter().filter_map(|e| e["kind"].as_str()).collect();
    assert!(kinds.contains(&"down") && kinds.contains(&"stop"), "{kinds:?}");
    let numbers: Vec<i64> = events.iter().filter_map(|e| e["number"].as_i64()).collect();
    assert!(numbers.windows(2).all(|two| two[0] < two[1]), "{numbers:?}");
    let last = numbers.last().copied().expect("one at least");
    assert_eq!(g7.quit(), 0);
    // Events that the broker has taken do not come again: all of the first run are among them.
    let g7 = Running::online(&folder, &[]);
    let mut numbers = Vec::new();
    while numbers.last().is_none_or(|n| *n <= last) {
        let events = events_until(&mut watch, "up");
        let kinds: Vec<&str> = events.iter().filter_map(|e| e["kind"].as_str()).collect();
        assert!(!kinds.contains(&"forced") && !kinds.contains(&"down"), "{kinds:?}");
        numbers.extend(events.iter().filter_map(|e| e["number"].as_i64()));
    }
    assert_eq!(g7.quit(), 0);
}

#[test]
fn a_broker_that_refuses_events_is_told_and_asked_again() {
    let rules = [("rules", "topic readwrite other\n")];
    let Some(broker) = Broker::with(own_port(), "allow_anonymous true\nacl_file rules\n", &rules) else {
        return;
    };
    let folder = event_folder(broker.port, "events = 'plant/events'\n");
    let mut g7 = Running::online(&folder, &[]);
    g7.until("hub: events wait: the broker does not allow its topic");
    assert_eq!(g7.quit(), 0);
    folder.write("hub.events", "something else");
    let refused = folder.g7(&["run", "--online"]);
    for part in ["hub.events", "not a file of this kind", "move it away"] {
        assert!(refused.is(2).err.contains(part), "{part}: {}", refused.err);
    }
}

/// A broker of these tests: it gives each event on and acknowledges most of them. After some it is gone in
/// the midst of a connection, with events that it has taken and not acknowledged.
struct Fragile {
    listener: TcpListener,
    random: u64,
}

impl Fragile {
    /// Serves connections, each until so many events; the last one goes on.
    fn serve(mut self, kills: u64, each: u64, give: &Sender<Vec<u8>>) -> Option<()> {
        for k in 0..=kills {
            let (mut stream, _) = self.listener.accept().ok()?;
            let mut left = if k == kills { u64::MAX } else { each };
            while left > 0
                && let Some((kind, body)) = packet(&mut stream)
            {
                left -= self.answer(&mut stream, kind, &body, left, give).unwrap_or(left);
            }
        }
        None
    }

    /// Answers a packet (MQTT 5.0, 3); returns how many events it was, `None` where the connection ends.
    fn answer(
        &mut self,
        stream: &mut TcpStream,
        kind: u8,
        body: &[u8],
        left: u64,
        give: &Sender<Vec<u8>>,
    ) -> Option<u64> {
        let answer = match kind >> 4 {
            1 => vec![0x20, 3, 0, 0, 0],
            3 => {
                let topic = usize::from(u16::from_be_bytes(*body.first_chunk()?));
                let (id, rest) = body.get(2 + topic..)?.split_first_chunk::<2>()?;
                let payload = rest.get(1 + usize::from(*rest.first()?)..)?;
                give.send(payload.to_vec()).ok()?;
                self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                // Shortly before its end it has no time for answers.
                if left > 1 + (self.random >> 33) % 40 {
                    stream.write_all(&[0x40, 2, id[0], id[1]]).ok()?;
                }
                return Some(1);
            }
            12 => vec![0xd0, 0],
            _ => return None,
        };
        stream.write_all(&answer).ok()?;
        Some(0)
    }
}

/// The first byte of a packet and what follows its length.
fn packet(stream: &mut TcpStream) -> Option<(u8, Vec<u8>)> {
    let mut byte = [0];
    stream.read_exact(&mut byte).ok()?;
    let kind = byte[0];
    let (mut length, mut shift) = (0usize, 0);
    loop {
        stream.read_exact(&mut byte).ok()?;
        length |= usize::from(byte[0] & 0x7f) << shift;
        shift += 7;
        if byte[0] & 0x80 == 0 {
            break;
        }
    }
    let mut body = vec![0; length];
    stream.read_exact(&mut body).ok()?;
    Some((kind, body))
}

#[test]
fn row_15_no_event_is_missing_however_often_the_broker_is_gone() {
    let (kills, each) = if many() { (20, 40_000) } else { (3, 120) };
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port is free");
    let port = listener.local_addr().expect("an address").port();
    let (give, given) = channel();
    std::thread::spawn(move || Fragile { listener, random: 15 }.serve(kills, each, &give));
    // A broker gives a name to a client that has none, which this one does not.
    let events =
        "client-id = 'sorter'\nevents = { topic = 'plant/events', most = 1000000, bytes = 1000000000 }\n";
    let folder = event_folder(port, events);
    let mut g7 = Running::online(&folder, &[]);
    g7.until("hub answers");
    let begin = Instant::now();
    let (mut value, mut heard, mut last, mut again, mut forced, mut stopped) = (0, 0, 0, 0, 0, false);
    let wanted = kills * each + 100;
    while !stopped {
        if last < wanted {
            // As many as the scan takes at once, and never so many ahead that the oldest are dropped.
            let some = if value < heard + 100_000 { 32 } else { 0 };
            for _ in 0..some {
                value += 1;
                g7.say(&format!("force n := {value} for 1h"));
            }
            std::thread::sleep(Duration::from_millis(4));
        } else {
            g7.say("stop");
        }
        let first = given.recv_timeout(Duration::from_secs(60)).expect("events come");
        for payload in std::iter::once(first).chain(given.try_iter()) {
            let event: Value = serde_json::from_slice(&payload).expect("JSON");
            let number = event["number"].as_u64().expect("a number");
            // An event that comes again was there already; a new one comes in order, and none is missing.
            if number <= last {
                again += 1;
                continue;
            }
            assert_eq!(number, last + 1, "{event}");
            last = number;
            heard = event["value"].as_str().and_then(|value| value.parse().ok()).unwrap_or(heard);
            forced += u64::from(event["kind"] == "forced");
            stopped |= event["kind"] == "stop" && last > wanted;
        }
    }
    assert!(again > 0 && forced > kills * each / 2, "{again} again, {forced} forced");
    let time = begin.elapsed().as_secs_f64();
    row(15, "", kills, 0, format!("{last} events, {again} came again, none is missing, {time:.0} s"));
    assert_eq!(g7.quit(), 0);
}
