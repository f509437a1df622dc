//! Shared runs: all clients see what one of them does.

use std::collections::{BTreeMap, BTreeSet};

use super::*;

/// The knowledge of a client, from the frames it received.
#[derive(Debug, Default, PartialEq)]
struct Known {
    on: BTreeSet<u64>,
    enabled: BTreeMap<u64, u64>,
    values: BTreeMap<u64, String>,
    forced: BTreeSet<u64>,
    scans: u64,
}

impl Known {
    fn take(&mut self, frame: &Value) {
        let list = |name: &str| frame[name].as_array().cloned().unwrap_or_default();
        let number = |v: &Value| v.as_u64().expect("a number");
        if frame["full"] == true {
            *self = Known::default();
        }
        for i in list("off") {
            self.on.remove(&number(&i));
        }
        self.on.extend(list("on").iter().map(number));
        for pair in list("enabled") {
            match number(&pair[1]) {
                0 => drop(self.enabled.remove(&number(&pair[0]))),
                mark => drop(self.enabled.insert(number(&pair[0]), mark)),
            }
        }
        for row in list("values") {
            self.values.insert(number(&row[0]), row[1].as_str().expect("a text").to_owned());
        }
        for pair in list("forced") {
            match pair[1] == true {
                true => self.forced.insert(number(&pair[0])),
                false => self.forced.remove(&number(&pair[0])),
            };
        }
        self.scans = number(&frame["scans"]);
    }

    /// Receives all frames until the run pauses.
    async fn until_pause(&mut self, page: &mut Live) {
        loop {
            let said = page.hear().await;
            if let Some(frame) = said.get("frame") {
                self.take(frame);
            }
            if said["pace"]["speed"] == 0.0 {
                return;
            }
        }
    }
}

fn signal(started: &Value, name: &str) -> u64 {
    let signals = started["signals"].as_array().expect("signals");
    signals.iter().position(|s| s["name"] == name).unwrap_or_else(|| panic!("{name}")) as u64
}

#[tokio::test]
async fn a_run_is_started_watched_and_stopped_by_anyone() {
    let server = Server::new().await;
    let (mut one, mut two) = (server.live().await, server.live().await);
    let started = one.start("a").await;
    assert_eq!(
        (&started["run"], &started["file"], &started["speed"]),
        (&json!("a"), &json!("chart.g7"), &json!(0.0))
    );
    assert_eq!(
        two.call(json!({ "do": "runs" })).await["runs"],
        json!([{ "run": "a", "file": "chart.g7", "speed": 0.0 }])
    );
    let watched = two.call(json!({ "do": "watch", "run": "a" })).await;
    for what in ["signals", "steps", "transitions", "period_ms", "speed"] {
        assert_eq!(watched[what], started[what], "{what}");
    }
    assert_eq!(watched["frame"]["full"], true);
    two.call(json!({ "do": "run_stop", "run": "a" })).await;
    assert_eq!(one.hear_of("ended").await["run"], "a");
    assert!(one.no(json!({ "do": "run_scan", "run": "a" })).await.contains("no run"));
    assert_eq!(one.call(json!({ "do": "runs" })).await["runs"], json!([]));
    // The name is free again.
    assert_eq!(two.start("a").await["run"], "a");
}

#[tokio::test]
async fn what_one_page_does_the_others_are_told() {
    let server = Server::new().await;
    let (mut one, mut two) = (server.live().await, server.live().await);
    let started = one.start("a").await;
    two.call(json!({ "do": "watch", "run": "a" })).await;
    let a = signal(&started, "a");
    let toggled = one.call(json!({ "do": "run_toggle", "run": "a", "signal": a })).await;
    assert_eq!(two.hear_of("frame").await, toggled);
    let scanned = one.call(json!({ "do": "run_scan", "run": "a" })).await;
    assert_eq!((&scanned["on"], &scanned["off"]), (&json!([1]), &json!([0])), "step 2 is active now");
    assert_eq!(two.hear_of("frame").await, scanned);
    let m = signal(&started, "m");
    let forced = two.call(json!({ "do": "run_force", "run": "a", "signal": m, "value": "FALSE" })).await;
    assert_eq!(forced["forced"], json!([[m, true]]));
    assert_eq!(one.hear_of("frame").await, forced, "from the other side as well");
    one.call(json!({ "do": "unwatch", "run": "a" })).await;
    two.call(json!({ "do": "run_scan", "run": "a" })).await;
    one.call(json!({ "do": "runs" })).await;
    assert_eq!(one.unread, Vec::<Value>::new(), "who does not watch is not told");
}

#[tokio::test]
async fn a_run_that_is_too_heavy_for_its_speed_answers_between_its_scans() {
    let server = Server::new().await;
    let text = format!("var s, i : DINT\npost {{ FOR i := 1 TO 20000 DO s := s / 2 + i; END_FOR }}\n{CHART}");
    let mut page = server.live().await;
    let start = json!({ "do": "run_start", "run": "a", "file": "chart.g7", "text": text });
    let one = page.call(start).await;
    let begun = std::time::Instant::now();
    // After one tick 4000 scans are due. All of them would take minutes; the server stops after 20 ms.
    page.call(json!({ "do": "pace", "run": "a", "speed": 1000 })).await;
    page.hear_of("frame").await;
    page.call(json!({ "do": "pace", "run": "a", "speed": 0 })).await;
    assert!(begun.elapsed() < Duration::from_secs(30), "{:?}", begun.elapsed());
    // So does an order that asks for many at once.
    let frame = page.call(json!({ "do": "run_advance", "run": "a", "ms": 1e9 })).await;
    assert_eq!((&frame["late"], &frame["halt"]), (&json!(true), &Value::Null));
    assert!(begun.elapsed() < Duration::from_secs(60), "{:?}", begun.elapsed());
    assert!(frame["scans"].as_u64() > one["frame"]["scans"].as_u64());
}

#[tokio::test]
async fn all_who_watch_see_the_same() {
    let server = Server::new().await;
    let (mut one, mut two, mut three) = (server.live().await, server.live().await, server.live().await);
    let started = one.start("a").await;
    let mut known = [Known::default(), Known::default(), Known::default()];
    known[0].take(&started["frame"]);
    known[1].take(&two.call(json!({ "do": "watch", "run": "a" })).await["frame"]);
    one.call(json!({ "do": "pace", "run": "a", "speed": 10.0 })).await;
    assert_eq!(two.hear_of("pace").await, json!({ "run": "a", "speed": 10.0 }));
    let a = signal(&started, "a");
    // A fourth client changes things; the others get the changes as frames.
    let mut four = server.live().await;
    for _ in 0..5 {
        four.call(json!({ "do": "run_toggle", "run": "a", "signal": a })).await;
        // Up to one scan after it.
        let before = known[0].scans;
        while known[0].scans <= before {
            known[0].take(&one.hear_of("frame").await);
        }
    }
    known[2].take(&three.call(json!({ "do": "watch", "run": "a" })).await["frame"]);
    four.call(json!({ "do": "run_force", "run": "a", "signal": signal(&started, "m"), "value": "TRUE" }))
        .await;
    four.call(json!({ "do": "pace", "run": "a", "speed": 0.0 })).await;
    for (known, page) in known.iter_mut().zip([&mut one, &mut two, &mut three]) {
        known.until_pause(page).await;
    }
    let [first, second, third] = &known;
    assert!(first.scans > 1 && first.forced.len() == 1, "it went on by itself: {first:?}");
    assert_eq!(first, second);
    assert_eq!(first, third);
    let mut truth = Known::default();
    truth.take(&four.call(json!({ "do": "run_frame", "run": "a", "full": true })).await);
    assert_eq!((&truth.on, &truth.enabled), (&first.on, &first.enabled));
    assert_eq!((&truth.values, &truth.forced), (&first.values, &first.forced));
}

#[tokio::test]
async fn a_run_goes_by_the_wall_clock_and_stops_where_it_is_told() {
    let server = Server::new().await;
    let mut page = server.live().await;
    let started = page.start("a").await;
    let mut other = server.live().await;
    other.call(json!({ "do": "watch", "run": "a" })).await;
    page.call(json!({ "do": "run_breaks", "run": "a", "ids": ["G/s/2"] })).await;
    assert_eq!(other.hear_of("breaks").await, json!({ "run": "a", "ids": ["G/s/2"] }));
    page.call(json!({ "do": "pace", "run": "a", "speed": 1.0 })).await;
    // Only the time changes: frames come a few times a second.
    let first = page.hear_of("frame").await["scans"].as_u64().expect("scans");
    let then = page.hear_of("frame").await["scans"].as_u64().expect("scans");
    assert!(then > first);
    let a = signal(&started, "a");
    page.call(json!({ "do": "run_toggle", "run": "a", "signal": a })).await;
    loop {
        let frame = page.hear_of("frame").await;
        if frame.get("stopped").is_some() {
            assert_eq!(frame["stopped"]["id"], "G/s/2");
            break;
        }
    }
    assert_eq!(page.hear_of("pace").await, json!({ "run": "a", "speed": 0.0 }));
    for speed in [-1.0, 1e9, 1e-9] {
        assert!(page.no(json!({ "do": "pace", "run": "a", "speed": speed })).await.contains("speed"));
    }
}

#[tokio::test]
async fn a_run_takes_unsaved_text_and_a_changed_chart() {
    let server = Server::new().await;
    let (mut one, mut two) = (server.live().await, server.live().await);
    let text = CHART.replace("step 2", "step 7").replace("1 -> 2", "1 -> 7").replace("2 -> 1", "7 -> 1");
    let started = one.call(json!({ "do": "run_start", "run": "a", "file": "chart.g7", "text": text })).await;
    assert_eq!(started["steps"][1]["id"], "G/s/7");
    two.call(json!({ "do": "watch", "run": "a" })).await;
    let more = text.replace("var n : DINT", "var n : DINT\nvar k : INT");
    let swapped = one.call(json!({ "do": "run_swap", "run": "a", "file": "chart.g7", "text": more })).await;
    assert_eq!(two.hear_of("started").await["signals"], swapped["signals"]);
    assert!(swapped["signals"].as_array().is_some_and(|s| s.iter().any(|s| s["name"] == "k")));
    // A text that cannot run changes nothing.
    let broken = json!({ "do": "run_start", "run": "a", "file": "chart.g7", "text": "chart G { step }" });
    one.no(broken).await;
    assert_eq!(two.call(json!({ "do": "watch", "run": "a" })).await["signals"], swapped["signals"]);
    one.no(json!({ "do": "run_start", "run": "b", "file": "chart.g7", "text": "chart G { step }" })).await;
    assert_eq!(one.call(json!({ "do": "runs" })).await["runs"].as_array().map(Vec::len), Some(1));
    assert!(
        one.no(json!({ "do": "run_start", "run": "b", "file": "../secret.g7" }))
            .await
            .contains("cannot be used")
    );
    assert!(one.no(json!({ "do": "run_start", "run": "b", "file": "none.g7" })).await.contains("no file"));
}

#[tokio::test]
async fn a_started_run_tells_those_who_watched_the_one_before() {
    let server = Server::new().await;
    let (mut one, mut two) = (server.live().await, server.live().await);
    one.start("a").await;
    two.call(json!({ "do": "watch", "run": "a" })).await;
    one.start("a").await;
    assert_eq!(two.hear_of("started").await["run"], "a");
}

#[tokio::test]
async fn there_are_so_many_runs_and_no_more() {
    let server = Server::with(|_| {}, Limits { runs: 2, ..Limits::default() }).await;
    let mut page = server.live().await;
    page.start("a").await;
    page.start("b").await;
    let third = json!({ "do": "run_start", "run": "c", "file": "chart.g7" });
    assert!(page.no(third.clone()).await.contains("stop one"));
    page.call(json!({ "do": "run_stop", "run": "a" })).await;
    page.call(third).await;
    let long = "x".repeat(1_025);
    page.no(json!({ "do": "run_start", "run": long, "file": "chart.g7" })).await;
    page.no(json!({ "do": "run_start", "run": "", "file": "chart.g7" })).await;
    page.no(json!({ "do": "open", "file": "x.g7", "text": CHART })).await;
}
