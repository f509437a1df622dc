//! `g7 serve --online`: the operator's side of a running controller, over HTTP and WebSocket, and the same
//! commands as lines of `g7 run --online`.
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

use crate::common;

use std::io::Read as _;

use common::Folder;
use common::station::{Page, Station};
use common::talk::{Running, Slave};
use serde_json::json;

/// The button `go` opens the valve; `zero` is a divisor.
const CHART: &str = "\
profile iec60848
input go : BOOL \"the button\"
input zero : INT
input line1_ok : BOOL
output valve : BOOL
output lamp : BOOL safe TRUE
output speed : INT safe -1
var n : INT
chart Main {
  initial step 1 { N lamp }
  step 2 { N valve  P1 n := n + 1  P1 speed := 5 }
  step 3 { P1 n := 1 / zero }
  1 -> 2 when go
  2 -> 1 when not go
  1 -> 3 when n = 77
}
";

const PLANT: &str =
    "plant Hand {\n  state pressed : BOOL := FALSE\n  drive go := pressed\n  drive line1_ok := TRUE\n}\n";

fn io(port: u16) -> String {
    format!(
        "[devices.line1]\nkind = 'modbus-tcp'\nhost = '127.0.0.1'\nport = {port}\ntimeout = '1s'\n\
         retry = '500ms'\n[inputs]\ngo = {{ at = 'line1.discrete(3)', bad = false }}\n\
         line1_ok = 'line1.good()'\n\
         [outputs]\nvalve = 'line1.coil(2)'\nlamp = 'line1.coil(3)'\nspeed = 'line1.holding(7)'\n"
    )
}

fn folder(port: u16) -> Folder {
    let folder = Folder::with(&format!("{CHART}{PLANT}"));
    folder.write("chart.io.toml", io(port));
    folder
}

#[test]
fn a_page_sees_starts_and_stops_the_controller() {
    let folder = folder(1);
    let station = Station::new(&folder, &["--simulate"]);
    let mut page = station.page();
    page.becomes("run");
    page.until("step 1", |page| page.situation() == ["1"]);
    page.shows("lamp", "TRUE", "simulated");
    page.shows("go", "FALSE", "simulated");
    page.shows("zero", "0", "free");
    page.shows("n", "0", "");
    let told = &page.seen["told"];
    assert_eq!((&told["file"], &told["steps"][0]["id"]), (&json!("chart.g7"), &json!("Main/s/1")));
    assert!(told["text"].as_str().expect("the text").starts_with(CHART));
    assert_eq!(told["signals"][page.signal("go")]["comment"], "the button");
    page.until("scans are counted", |page| page.seen["counts"]["scans"].as_u64() > Some(50));
    assert!(page.seen["counts"]["late"]["p99_us"].is_number());
    let begin = page.seen["now"].as_f64().expect("a time");
    page.until("time goes on", |page| page.seen["now"].as_f64() > Some(begin + 0.5));

    page.no(json!({ "do": "operator_run" }), "runs already");
    page.no(json!({ "do": "operator_ack" }), "no fault");
    page.does("stop");
    page.becomes("stop");
    page.no(json!({ "do": "operator_stop" }), "does not run");
    // Safe values, whatever the charts say.
    page.shows("lamp", "TRUE", "simulated");
    page.shows("speed", "-1", "simulated");
    page.does("cold");
    page.does("run");
    page.becomes("run");
    page.until("step 1 again", |page| page.situation() == ["1"]);
    let kinds: Vec<_> = page.events().iter().map(|e| e["kind"].clone()).collect();
    assert_eq!(kinds, ["run", "stop", "run"]);
    // Another page sees the same.
    let mut other = station.page();
    assert_eq!(other.events().len(), 3);
    other.does("stop");
    page.becomes("stop");
    other.no(json!({ "do": "operator_dance" }), "means nothing");
    assert_eq!(station.interrupt(), 0);
}

#[test]
fn a_change_of_a_used_file_is_a_change_of_the_chart() {
    let folder = folder(1);
    folder.write("lib/io.g7", "type Mode : (Off, On)\n");
    folder.write("chart.g7", format!("use 'lib/io.g7'\n{CHART}{PLANT}"));
    let station = Station::new(&folder, &["--simulate"]);
    let mut page = station.page();
    page.becomes("run");
    let uses = json!([{ "file": "lib/io.g7", "text": "type Mode : (Off, On)\n" }]);
    assert_eq!(page.seen["told"]["uses"], uses, "the page draws the charts of used files as well");
    assert_eq!(page.seen["file"]["differs"], false);
    folder.write("lib/io.g7", "type Mode : (Off, On, Automatic)\n");
    page.until("the file differs", |page| page.seen["file"]["differs"] == true);
    assert_eq!(page.ok(json!({ "do": "operator_change" })), json!({ "lost": [] }));
    assert_eq!(station.interrupt(), 0);
}

#[test]
fn a_chart_is_changed_while_it_runs_and_the_change_is_taken_back() {
    let folder = folder(1);
    let station = Station::new(&folder, &["--simulate"]);
    let mut page = station.page();
    page.becomes("run");
    page.force("go", "TRUE", 600);
    page.until("step 2", |page| page.situation() == ["2"]);
    page.shows("speed", "5", "simulated");
    assert_eq!(page.seen["file"], json!({ "differs": false, "back": false, "busy": false }));
    page.no(json!({ "do": "operator_back" }), "no change that could be taken back");
    // A file with an error is told with the place; the machine goes on.
    folder.write("chart.g7", format!("{}{PLANT}", CHART.replace("when go", "when gone")));
    page.until("the file differs", |page| page.seen["file"]["differs"] == true);
    page.no(json!({ "do": "operator_change" }), "chart.g7:");
    // Another chart: a step and a variable more, and step 2 has another name.
    let renamed = CHART
        .replace("input go", "input spare : BOOL\ninput go")
        .replace("step 2 {", "step 20 {")
        .replace("1 -> 2 ", "1 -> 20 ")
        .replace("2 -> 1 ", "20 -> 1 ");
    folder.write("chart.g7", format!("{renamed}{PLANT}"));
    let asks = page.ok(json!({ "do": "operator_change" }));
    assert_eq!(asks, json!({ "asks": ["step `2` is active and no longer exists"] }));
    assert_eq!(page.situation(), ["2"], "nothing has changed yet");
    // One that keeps step 2 goes on in it, with its values and forces.
    let changed = CHART
        .replace("input go", "input spare : BOOL\ninput go")
        .replace("2 -> 1 when not go", "2 -> 4 when not go\n  4 -> 1 when 300ms/X4\n  step 4 { N lamp }");
    folder.write("chart.g7", format!("{changed}{PLANT}"));
    assert_eq!(page.ok(json!({ "do": "operator_change" })), json!({ "lost": [] }));
    page.until("the page is told", |page| page.seen["renew"] == true);
    let mut page = station.page();
    page.until("step 2 goes on", |page| page.situation() == ["2"]);
    page.shows("n", "1", "");
    page.shows("go", "TRUE", "simulated");
    page.shows("spare", "FALSE", "free");
    assert_eq!(page.seen["forced"][0]["signal"], page.signal("go"));
    page.until("it is noted", |page| page.events().iter().any(|e| e["kind"] == "changed"));
    assert!(page.has_event("forced", "go"), "events of before keep their names");
    page.until("the way back", |page| {
        page.seen["file"] == json!({ "differs": false, "back": true, "busy": false })
    });
    page.ok(json!({ "do": "operator_release", "name": "go" }));
    page.until("the new step", |page| page.situation() == ["4"]);
    page.until("step 1", |page| page.situation() == ["1"]);
    // Back: the file is the other one now.
    assert_eq!(page.ok(json!({ "do": "operator_back" })), json!({ "lost": [] }));
    let mut page = station.page();
    page.until("step 1 goes on", |page| page.situation() == ["1"]);
    page.until("the file differs", |page| page.seen["file"]["differs"] == true);
    assert!(page.seen["told"]["text"].as_str().expect("the text").starts_with(CHART));
    page.until("it is noted", |page| page.events().iter().any(|e| e["kind"] == "back"));
    assert_eq!(station.interrupt(), 0);
}

#[test]
fn a_force_has_an_end_that_is_told() {
    let folder = folder(1);
    let station = Station::new(&folder, &["--simulate"]);
    let mut page = station.page();
    page.becomes("run");
    page.force("go", "TRUE", 2);
    page.until("it is in the list", |page| page.seen["forced"][0]["signal"] == page.signal("go"));
    let until = page.seen["forced"][0]["until"].as_f64().expect("a time");
    let left = until - page.seen["now"].as_f64().expect("a time");
    assert!(left > 0.5 && left <= 2.1, "{left}");
    page.shows("valve", "TRUE", "simulated");
    assert!(page.has_event("forced", "go"));
    page.until("it is over", |page| page.has_event("ended", "go"));
    page.until("nothing is forced", |page| page.seen["forced"] == json!([]));
    page.shows("valve", "FALSE", "simulated");
    page.no(json!({ "do": "operator_release", "name": "go" }), "not forced");

    // Without a time it is ten minutes.
    page.ok(json!({ "do": "operator_force", "name": "valve", "value": "1" }));
    page.until("the valve", |page| page.seen["forced"][0]["value"] == "TRUE");
    let left = page.seen["forced"][0]["until"].as_f64().expect("a time")
        - page.seen["now"].as_f64().expect("a time");
    assert!((590.0..=600.1).contains(&left), "{left}");
    page.shows("valve", "TRUE", "simulated");
    page.force("n", "12", 60);
    page.shows("n", "12", "");
    page.ok(json!({ "do": "operator_release", "name": "valve" }));
    page.shows("valve", "FALSE", "simulated");
    page.until("one is left", |page| page.seen["forced"].as_array().map(Vec::len) == Some(1));
    page.does("release_all");
    page.until("none is left", |page| page.seen["forced"] == json!([]));
    page.no(json!({ "do": "operator_release_all" }), "not forced");
    let force = |name: &str, value: &str, seconds: u64| json!({ "do": "operator_force", "name": name, "value": value, "seconds": seconds });
    page.no(force("gone", "1", 1), "no `gone`");
    page.no(force("pressed", "1", 1), "state of the plant");
    page.no(force("go", "7", 1), "TRUE");
    page.no(force("go", "1", 0), "longer than 0");
    page.no(force("go", "1", 90_000), "24 hours");
    assert_eq!(page.seen["forced"], json!([]));
}

#[test]
fn a_fault_is_told_with_its_reason_until_a_person_ends_it() {
    let folder = folder(1);
    let station = Station::new(&folder, &["--simulate"]);
    let mut page = station.page();
    page.becomes("run");
    // Step 3 divides by zero.
    page.force("n", "77", 5);
    page.becomes("fault");
    let why = page.seen["mode"]["reason"]["why"].as_str().expect("a reason").to_owned();
    assert!(why.contains("chart.g7:12:") && why.contains("zero"), "{why}");
    page.shows("speed", "-1", "simulated");
    page.no(json!({ "do": "operator_run" }), "acknowledge");
    let alarm = page.events().into_iter().find(|e| e["kind"] == "fault").expect("an alarm").clone();
    assert_eq!(
        (&alarm["level"], &alarm["seen"], &alarm["over"]),
        (&json!("alarm"), &json!(false), &json!(false))
    );
    page.does("ack");
    page.becomes("stop");
    let state = |page: &Page| {
        let events = page.events();
        let found = events.iter().find(|e| e["n"] == alarm["n"]).expect("it stays in the list");
        (found["seen"].clone(), found["over"].clone())
    };
    page.until("the cause is over", |page| state(page) == (json!(false), json!(true)));
    page.ok(json!({ "do": "operator_seen", "event": alarm["n"], "all": false }));
    page.until("it was seen", |page| state(page) == (json!(true), json!(true)));
    page.no(json!({ "do": "operator_seen", "event": alarm["n"], "all": false }), "no such alarm");
    page.answer(&json!({ "do": "operator_release_all" }));
    page.does("cold");
    page.does("run");
    page.becomes("run");
}

#[test]
fn the_outputs_of_a_slave_are_safe_at_the_end() {
    let Some(mut slave) = Slave::start(0) else { return };
    let folder = folder(slave.port());
    let station = Station::new(&folder, &[]);
    let mut page = station.page();
    page.becomes("run");
    page.until("line1 answers", |page| page.seen["devices"][0]["up"] == true);
    let line1 = &page.seen["told"]["devices"][0];
    assert_eq!((&line1["name"], &line1["kind"]), (&json!("line1"), &json!("modbus-tcp")));
    slave.set("discrete 3 1");
    page.shows("go", "TRUE", "good");
    page.shows("valve", "TRUE", "good");
    slave.becomes("holding 7 1", "5");
    page.does("stop");
    slave.becomes("holding 7 1", "65535");
    page.shows("speed", "-1", "safe");
    // Who starts it sees the inputs as they are, although nothing runs.
    slave.set("discrete 3 0");
    page.shows("go", "FALSE", "good");
    slave.set("discrete 3 1");
    page.does("run");
    slave.becomes("coil 2 1", "1");
    slave.becomes("coil 3 1", "0");
    // A forced output reaches the device, and none is forced in STOP.
    page.force("lamp", "TRUE", 60);
    slave.becomes("coil 3 1", "1");
    assert_eq!(station.interrupt(), 0);
    for (what, value) in [("coil 2 1", "0"), ("coil 3 1", "1"), ("holding 7 1", "65535")] {
        assert_eq!(slave.get(what), value, "{what}");
    }
}

#[test]
fn a_device_that_is_gone_is_told_and_its_inputs_are_substituted() {
    let Some(mut slave) = Slave::start(0) else { return };
    let folder = folder(slave.port());
    let station = Station::new(&folder, &[]);
    let mut page = station.page();
    slave.set("discrete 3 1");
    page.shows("go", "TRUE", "good");
    drop(slave);
    page.until("line1 is gone", |page| page.seen["devices"][0]["up"] == false);
    page.shows("go", "FALSE", "substituted");
    page.shows("valve", "FALSE", "bad");
    page.shows("line1_ok", "FALSE", "good");
    assert!(!page.seen["devices"][0]["why"].as_str().expect("a reason").is_empty());
    let alarm = page.events().into_iter().rfind(|e| e["kind"] == "down").expect("an alarm");
    assert_eq!((&alarm["device"], &alarm["level"]), (&json!("line1"), &json!("alarm")));
}

#[test]
fn nobody_else_is_let_in() {
    let folder = folder(1);
    let station = Station::new(&folder, &["--simulate"]);
    assert!(station.host.starts_with("127.0.0.1:"), "{}", station.host);
    // Both are the page, or the sentence that this binary has none.
    assert_eq!(station.get("/operator").0, station.get("/").0);
    assert_ne!(station.get("/operator").0, 404);
    assert_eq!(station.get("/api/info").0, 401);
    let (token, own) = (&station.token, format!("http://{}", station.host));
    assert_eq!(station.try_page(token, Some("http://evil.example")).err(), Some(403));
    assert_eq!(station.try_page("", Some(&own)).err(), Some(401));
    assert!(station.try_page(token, Some(&own)).is_ok());
    for host in ["0.0.0.0", "192.0.2.7", "::"] {
        let refused = folder.g7(&["serve", "chart.g7", "--online", "--simulate", "--listen", host]);
        refused.is_refused(&[host, "without encryption and without users", "g7 cert", "127.0.0.1"]);
    }
    assert!(folder.g7(&["serve", "--io", "x.toml"]).is(2).err.contains("--online"));
    // Without a controller there is no such page, and nothing to command.
    folder.g7(&["serve", "none.g7", "--online"]).is(2);
    folder.write("chart.io.toml", "[devices.line1]\nkind = 'modbus-tpc'\n");
    assert!(folder.g7(&["serve", "chart.g7", "--online", "--port", "0"]).is(1).err.contains("G070"));
}

#[test]
fn a_page_that_gives_no_sign_is_let_go_and_the_others_go_on() {
    let folder = folder(1);
    let station = Station::new(&folder, &["--simulate"]);
    let mut mute = station.page();
    let mut page = station.page();
    // It answers no ping, because it reads nothing.
    let begin = page.seen["now"].as_f64().expect("a time");
    page.until("twelve seconds", |page| page.seen["now"].as_f64() > Some(begin + 12.0));
    let stream = mute.socket.get_mut();
    let mut rest = Vec::new();
    // It ends: either as it should, or because the server has closed it with messages unread.
    match stream.read_to_end(&mut rest) {
        Ok(_) => {}
        Err(e) => assert_eq!(e.kind(), std::io::ErrorKind::ConnectionReset, "{e}"),
    }
    page.does("stop");
    page.becomes("stop");
}

#[test]
fn lines_change_the_chart_and_what_is_kept_goes_with_it() {
    let folder = folder(1);
    folder.write("chart.g7", format!("{}{PLANT}", CHART.replace("var n : INT", "var n : INT := 7 retain")));
    folder.write("chart.io.toml", io(1) + "[controller]\nretain = 'kept'\nchanged = 'fit'\n");
    let mut g7 = Running::online(&folder, &["--simulate"]);
    g7.until("running");
    g7.say("back");
    g7.until("no change that could be taken back");
    g7.say("force go := 1");
    g7.until("forced to TRUE");
    // The values that are kept need another number of words from then on.
    let many: String = (0..600).map(|k| format!("var b{k} : LREAL retain\n")).collect();
    let with = |more: &str| {
        let chart = CHART.replace("var n : INT", &format!("{more}var n : INT := 7 retain"));
        folder.write(
            "chart.g7",
            format!(
                "{}{PLANT}",
                chart
                    .replace("step 2 {", "step 22 {")
                    .replace("2 -> 1 ", "22 -> 1 ")
                    .replace("1 -> 2 ", "1 -> 22 ")
            ),
        );
    };
    with(&many);
    g7.say("change");
    g7.until("this would be lost: step `2` is active and no longer exists");
    g7.say("change anyway");
    g7.until("goes on with the changed chart; lost: step `2`");
    with(&format!("{many}nonsense\n"));
    g7.say("change");
    g7.until("chart.g7:");
    assert_eq!(g7.quit(), 0);
    with(&many);
    let warm = folder.g7(&["run", "--online", "--simulate", "--for", "100ms"]);
    assert!(warm.is(0).err.contains("warm start"), "{}", warm.err);
}

#[test]
fn lines_force_values_as_the_page_does() {
    let folder = folder(1);
    let mut g7 = Running::online(&folder, &["--simulate"]);
    g7.until("running");
    g7.say("force go := 1 for 1s");
    g7.until("`go` is forced to TRUE");
    g7.until("`go` is no longer forced: its time is over");
    g7.say("force speed := 12");
    g7.until("`speed` is forced to 12");
    g7.say("release speed");
    g7.until("`speed` is no longer forced");
    g7.say("release");
    g7.until("it is not forced");
    g7.say("force pressed := 1");
    g7.until("state of the plant");
    g7.say("run");
    g7.until("runs already");
    g7.say("force go");
    g7.until("force NAME := VALUE for TIME");
    assert_eq!(g7.quit(), 0);
}
