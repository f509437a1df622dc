//! The stage and the board with a controller that a test steps by hand.

use std::sync::Arc;
use std::sync::mpsc::SyncSender;

use g7_model::Nanos;
use g7_online::{Command, Failed, Happened, Machine, Mode, Paces, Reason, Wiring, assemble, runner};
use g7_rig::{Options, Source, build};
use serde_json::{Value, json};
use tokio::sync::oneshot;

use super::{Asker, Names, Order, Stage, Told, Wish};
use crate::serve::outbox::{Next, Outbox};

const CHART: &str = "\
input a : BOOL
output m : BOOL safe TRUE
var n : DINT

chart G {
  initial step 1
  step 2 { N m  N n := n + 1 }
  1 -> 2 when a
  2 -> 1 when not a
}
";

struct Bed {
    machine: Machine,
    stage: Stage,
    orders: SyncSender<Order>,
    now: Nanos,
    paces: Paces,
}

impl Bed {
    fn new() -> Bed {
        let source = Source::new("mixers/chart.g7", CHART.as_bytes().to_vec(), 0);
        let (bench, problems) = build(&source, &Options::default()).expect("no plant");
        let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
        let wiring = Wiring::default();
        let none = |_: &_| Err::<_, ()>(());
        let mut machine = assemble(runner(&bench, &wiring, 0), &wiring, none).expect("it has no device");
        let (orders, door) = Stage::door();
        let stage = Stage::new(Names::new(source, bench, wiring), machine.show(), door);
        Bed { machine, stage, orders, now: Nanos::ZERO, paces: Paces::default() }
    }

    fn command(&mut self, command: Command) {
        self.machine.controller.command(self.now, command).expect("it can");
    }

    /// So many frames, and the scans meanwhile.
    fn ticks(&mut self, count: usize) {
        for _ in 0..count {
            for _ in 0..5 {
                self.now += self.machine.controller.runner().period();
                self.machine.controller.step(self.now);
            }
            self.stage.tick(self.now, &self.paces);
        }
    }

    /// Gives an order; a wish that the stage does not answer is returned.
    fn order(&mut self, by: &Arc<Outbox>, call: Option<(u64, Wish)>) -> Option<(Wish, Asker)> {
        let call = call.map(|(id, wish)| (id, wish, oneshot::channel().0));
        self.orders.try_send(Order { by: Arc::clone(by), call }).expect("there is room");
        self.stage.take(self.now, &self.paces).expect("an order")
    }

    fn watch(&mut self) -> (Arc<Outbox>, Value) {
        let outbox = Arc::new(Outbox::default());
        assert!(self.order(&outbox, Some((1, Wish::Watch))).is_none());
        let told = next(&outbox)["answer"]["ok"].clone();
        (outbox, told)
    }
}

/// The next message of a client.
fn next(outbox: &Outbox) -> Value {
    let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a runtime");
    match runtime.block_on(outbox.next()) {
        Next::Text(text) => serde_json::from_str(&text).expect("JSON"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_frame_has_only_what_changed() {
    let mut bed = Bed::new();
    bed.ticks(1);
    let (page, told) = bed.watch();
    assert_eq!((&told["title"], &told["frame"]["full"]), (&json!("mixers"), &json!(true)));
    assert_eq!(told["frame"]["values"], json!([[0, "FALSE", "free"], [1, "TRUE", "free"], [2, "0", ""]]));
    bed.command(Command::Run);
    bed.ticks(2);
    let (first, second) = (next(&page), next(&page));
    assert_eq!(first["operator"]["values"], json!([[1, "FALSE", "free"]]), "no longer safe");
    assert_eq!(first["operator"]["on"][0][0], 0, "{first}");
    assert_eq!(second["operator"].get("values"), None);
    assert_eq!(second["operator"].get("events"), None);
}

#[test]
fn a_page_left_behind_gets_one_whole_frame() {
    let mut bed = Bed::new();
    let (page, _) = bed.watch();
    let (other, _) = bed.watch();
    bed.command(Command::Run);
    bed.command(Command::SetInput(0, 1));
    bed.ticks(1_000);
    let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a runtime");
    assert!(matches!(runtime.block_on(page.next()), Next::Behind(run) if *run == *super::NAME));
    assert!(bed.order(&page, None).is_none());
    let whole = next(&page)["operator"].clone();
    assert_eq!((&whole["full"], &whole["values"][0][1]), (&json!(true), &json!("TRUE")));
    // From here on it gets the same frames as a new page.
    drop(other);
    bed.ticks(1);
    assert_eq!(next(&page)["operator"]["full"], false);
}

#[test]
fn very_many_pages_get_fewer_frames_each() {
    let mut bed = Bed::new();
    bed.command(Command::Run);
    let pages: Vec<_> = (0..401).map(|_| bed.watch().0).collect();
    let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a runtime");
    // The page that came last was told all, and no other one heard of it.
    bed.ticks(1);
    bed.ticks(3 * 4);
    let mut frames = 0;
    while let Ok(next) = runtime.block_on(async {
        tokio::select! { biased; next = pages[0].next() => Ok(next), () = std::future::ready(()) => Err(()) }
    }) {
        assert!(matches!(next, Next::Text(text) if text.contains("\"full\":false")));
        frames += 1;
    }
    assert_eq!(frames, 1 + 4, "each 150 ms in place of each 50 ms");
}

#[test]
fn commands_are_handed_on_and_alarms_are_seen_here() {
    let mut bed = Bed::new();
    let (page, _) = bed.watch();
    let handed = bed.order(&page, Some((7, Wish::Stop)));
    let Some((Wish::Stop, asker)) = handed else { panic!("it is for the controller") };
    asker.answer(Err("no".to_owned()));
    assert_eq!(next(&page), json!({ "id": 7, "answer": { "no": "no" } }));
    bed.stage.note(Nanos::SECOND, &Told::Mode(Mode::Fault(Reason::Watchdog)));
    bed.ticks(1);
    let alarm = next(&page)["operator"]["events"][0].clone();
    assert_eq!(
        (&alarm["level"], &alarm["seen"], &alarm["at"]),
        (&json!("alarm"), &json!(false), &json!(1.0))
    );
    let event = alarm["n"].as_u64().expect("a number");
    assert!(bed.order(&page, Some((8, Wish::Seen { event, all: false }))).is_none());
    assert_eq!(next(&page)["answer"], json!({ "ok": null }));
    bed.ticks(1);
    assert_eq!(next(&page)["operator"]["events"][0]["seen"], true);
}

#[test]
fn of_many_events_the_alarms_stay_that_nobody_has_seen() {
    let mut bed = Bed::new();
    bed.stage.note(Nanos::ZERO, &Told::Unsaved("the disk is full".to_owned()));
    let events = |bed: &mut Bed| {
        let (_, told) = bed.watch();
        told["frame"]["events"].as_array().expect("a list").clone()
    };
    for k in 0..1_000 {
        bed.stage.note(Nanos::from_millis(k), &Told::Mode(Mode::Run));
    }
    let found = events(&mut bed);
    assert_eq!((found.len(), &found[0]["kind"], &found[1]["kind"]), (100, &json!("unsaved"), &json!("run")));
    // Their number is bounded all the same; scans left out one after the other are one event.
    for k in 0..1_000 {
        bed.stage.note(Nanos::from_millis(k), &Told::Missed(1));
        bed.stage.note(Nanos::from_millis(k), &Told::Missed(2));
        bed.stage.note(Nanos::ZERO, &Told::Device(9, Happened::Down(Failed("gone".to_owned()))));
    }
    let found = events(&mut bed);
    let missed = found.iter().rfind(|e| e["kind"] == "missed").expect("one");
    assert_eq!((found.len(), &missed["count"]), (100, &json!(3)));
}
