//! All that a page sees of a controller, as JSON: a description once, then frames with what has changed.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::Path;

use g7_engine::State as Image;
use g7_host::Value as Word;
use g7_model::Nanos;
use g7_online::{
    FORCES, Forced, Happened, LONGEST, Mode, Paces, Quality, Sight, Spread, Target, USUAL, WhileBad, Wire,
};
use g7_page::{Places, Show};
use g7_rig::{Activity, Item, Other, Role};
use serde_json::{Map, Value, json};

use super::names::{Known, Names};
use super::part;
use super::picture::View;
use super::told::{Level, Told, reason_json};

/// Events that are kept for the page.
const EVENTS: usize = 100;

/// A variable that the page shows.
struct Row {
    /// Its number in the bench.
    item: usize,
    point: At,
}

/// The place to which a variable is wired.
#[derive(Clone, Copy)]
enum At {
    /// An input: device, number, what it is while it is bad.
    Input(usize, usize, WhileBad),
    /// An output: device, number.
    Output(usize, usize),
    /// An input that tells whether a device answers.
    Good,
    /// The plant drives it, or sees it.
    Plant,
    /// No device has it.
    Free,
    /// It is no input and no output.
    Inside,
}

/// The value of a row as it is shown, and its quality.
type Cell = (String, &'static str);

/// A device as the page shows it.
#[derive(Clone, Default)]
struct State {
    up: Option<bool>,
    since: Nanos,
    why: String,
    /// The outputs that it refuses.
    refused: BTreeSet<usize>,
}

/// An event in the list.
struct Entry {
    number: u64,
    /// Those of the chart that ran when it happened.
    names: Names,
    at: Nanos,
    told: Told,
    level: Level,
    /// Its cause is over.
    over: bool,
    /// A person has seen it.
    seen: bool,
}

/// The facts for the page.
pub(super) struct Board {
    names: Names,
    sight: Sight,
    places: Places,
    rows: Vec<Row>,
    mode: (Mode, Nanos),
    devices: Vec<State>,
    events: VecDeque<Entry>,
    next: u64,
    /// The time of the attendant at which the controller was seen last.
    seen: Nanos,
    /// The parts of a frame that every watcher has.
    sent: Map<String, Value>,
    sent_values: Vec<Cell>,
    /// The state of the picture of a machine, and its values as every watcher has them.
    picture: Option<Image>,
    sent_view: Vec<Show>,
    /// How the chart and its file are to each other.
    file: Value,
}

impl Board {
    pub(super) fn new(names: Names, sight: Sight) -> Board {
        Board {
            devices: vec![State::default(); names.wiring.devices.len()],
            places: Places::new(&names.source, &names.bench),
            rows: rows(&names),
            picture: names.view.as_ref().and_then(View::state),
            names,
            sight,
            mode: (Mode::Stop, Nanos::ZERO),
            events: VecDeque::new(),
            next: 1,
            seen: Nanos::ZERO,
            sent: Map::new(),
            sent_values: Vec::new(),
            sent_view: Vec::new(),
            file: json!({ "differs": false, "back": false, "busy": false }),
        }
    }

    /// Goes on with another chart; devices, mode and events are the same.
    pub(super) fn renew(&mut self, names: Names, sight: Sight) {
        self.places = Places::new(&names.source, &names.bench);
        self.rows = rows(&names);
        self.picture = names.view.as_ref().and_then(View::state);
        (self.names, self.sight) = (names, sight);
        self.sent.clear();
        self.sent_values.clear();
        self.sent_view.clear();
    }

    pub(super) fn tell_file(&mut self, facts: Value) {
        self.file = facts;
    }

    /// Notes an event.
    pub(super) fn note(&mut self, at: Nanos, told: &Told) {
        match told {
            Told::Mode(mode) => self.mode = (*mode, at),
            Told::Device(device, happened) => self.device(at, *device, happened),
            _ => {}
        }
        if self.add_to_last(at, told) {
            return;
        }
        if let Some(thing) = told.thing() {
            self.events.iter_mut().filter(|e| e.told.thing() == Some(thing)).for_each(|e| e.over = true);
        }
        let level = told.level(&self.names);
        let seen = level == Level::Note;
        let over = seen || told.thing().is_none();
        let (number, names) = (self.next, self.names.clone());
        let entry = Entry { number, names, at, told: told.clone(), level, over, seen };
        self.next += 1;
        self.events.push_back(entry);
        if self.events.len() > EVENTS {
            // Of the alarms those stay longest that nobody has seen.
            let at = self.events.iter().position(|e| e.seen && e.over).unwrap_or(0);
            self.events.remove(at);
        }
    }

    /// Scans that are left out one after the other are one event; true if this is such a one.
    fn add_to_last(&mut self, at: Nanos, told: &Told) -> bool {
        let (Some(last), Told::Missed(more)) = (self.events.back_mut(), told) else { return false };
        let (false, Told::Missed(count)) = (last.seen, &mut last.told) else { return false };
        (*count, last.at) = (count.saturating_add(*more), at);
        true
    }

    fn device(&mut self, at: Nanos, device: usize, happened: &Happened) {
        let Some(state) = self.devices.get_mut(device) else { return };
        match happened {
            Happened::Up | Happened::Down(_) => {
                let why = if let Happened::Down(why) = happened { why.to_string() } else { String::new() };
                let up = Some(*happened == Happened::Up);
                *state = State { up, since: at, why, refused: std::mem::take(&mut state.refused) };
            }
            Happened::NoOutput(k, _) => {
                state.refused.insert(*k);
            }
            Happened::Output(k) => {
                state.refused.remove(k);
            }
            Happened::NoInput(..)
            | Happened::Input(_)
            | Happened::Limited(_)
            | Happened::Note(_)
            | Happened::Written(..) => {}
        }
    }

    /// Notes that a person has seen an alarm, or all up to it; false where there is none.
    pub(super) fn see(&mut self, number: u64, all: bool) -> bool {
        let mut found = false;
        let is = |e: &&mut Entry| e.number == number || all && e.number < number;
        for entry in self.events.iter_mut().filter(is).filter(|e| !e.seen) {
            (entry.seen, found) = (true, true);
        }
        found
    }

    /// Looks at the controller; `now` is the time of the attendant.
    pub(super) fn look(&mut self, now: Nanos) {
        if self.sight.look() {
            self.seen = now;
        }
    }

    /// The names of all that frames have numbers for.
    pub(super) fn description(&self) -> Value {
        let Known { source, bench, wiring, view } = &*self.names;
        let steps = bench.steps.iter().zip(self.places.steps()).map(|(step, part)| {
            let chart = part.id.split_once("/s/").map_or("", |(chart, _)| chart);
            let is_macro = matches!(step.id, Activity::Macro(_));
            json!({ "id": part.id, "instance": part.instance, "name": step.name, "chart": chart, "comment": step.comment, "macro": is_macro })
        });
        let devices = wiring.devices.iter().map(|wired| {
            let kind = &wired.device.kind;
            json!({ "name": wired.device.name.value, "kind": kind.word(), "place": kind.place() })
        });
        json!({
            "title": title(&source.name),
            "file": source.name,
            "text": source.text,
            "uses": source.others().iter().filter(|o| !o.library).map(used).collect::<Vec<_>>(),
            "profile": bench.compiled.unit.profile.name(),
            "period_ms": bench.period.as_millis(),
            "plant": bench.plant.as_ref().map(|plant| plant.name.clone()),
            "signals": self.rows.iter().filter_map(|row| self.signal(row)).collect::<Vec<_>>(),
            "steps": steps.collect::<Vec<_>>(),
            "transitions": self.places.transitions(),
            "devices": devices.collect::<Vec<_>>(),
            "picture": view.as_ref().and_then(|view| view.json(bench)),
            "force": { "usual_s": seconds(USUAL), "longest_s": seconds(LONGEST), "most": FORCES },
        })
    }

    fn signal(&self, row: &Row) -> Option<Value> {
        let bench = &self.names.bench;
        let item = bench.items.get(row.item)?;
        let role = match item.role {
            Role::Input(_) => "input",
            Role::Output => "output",
            Role::Variable | Role::Plant => "variable",
        };
        let address = bench.compiled.symbols.variable(&item.name).and_then(|v| v.address.as_deref());
        let (device, wire) = match row.point {
            At::Input(device, k, _) => (Some(device), Some(&self.names.wired(device)?.inputs.get(k)?.wire)),
            At::Output(device, k) => (Some(device), Some(&self.names.wired(device)?.outputs.get(k)?.wire)),
            At::Good | At::Plant | At::Free | At::Inside => (None, None),
        };
        let part =
            wire.and_then(|wire| if let Wire::Panel(part) = wire { Some(part::json(part)) } else { None });
        Some(json!({
            "name": item.name,
            "role": role,
            "bool": item.kind == g7_host::Kind::Bool,
            "type": item.ty.to_string(),
            "comment": item.comment,
            "address": address,
            "device": device.map(|device| self.names.device(device)),
            "point": wire.map(ToString::to_string),
            "panel": part,
            "forcible": bench.force_of(item).is_some(),
        }))
    }

    /// All that there is. It does not count as sent: the next frame has the changes for those who watch already.
    pub(super) fn whole(&mut self, now: Nanos, paces: &Paces) -> Value {
        let (cells, view) = (self.cells(), self.view());
        let parts = self.parts(paces).map(|(key, part)| (key.to_owned(), part)).into_iter().collect();
        self.framed(now, parts, (0..).zip(&cells), (0..).zip(&view), true)
    }

    /// The next frame: what has changed since the one before.
    pub(super) fn frame(&mut self, now: Nanos, paces: &Paces) -> Value {
        let (cells, view) = (self.cells(), self.view());
        let mut parts = Map::new();
        for (key, part) in self.parts(paces) {
            if self.sent.get(key) != Some(&part) {
                parts.insert(key.to_owned(), part.clone());
                self.sent.insert(key.to_owned(), part);
            }
        }
        let is_sent = |k: u32, cell: &Cell| self.sent_values.get(k as usize).is_some_and(|sent| sent == cell);
        let changed = (0..).zip(&cells).filter(|(k, cell)| !is_sent(*k, cell));
        let moved = (0..).zip(&view).filter(|(k, show)| self.sent_view.get(*k as usize) != Some(show));
        let frame = self.framed(now, parts, changed, moved, false);
        (self.sent_values, self.sent_view) = (cells, view);
        frame
    }

    fn cells(&self) -> Vec<Cell> {
        self.rows.iter().map(|row| self.cell(row)).collect()
    }

    fn framed<'c>(
        &self,
        now: Nanos,
        mut frame: Map<String, Value>,
        cells: impl Iterator<Item = (u32, &'c Cell)>,
        view: impl Iterator<Item = (u32, &'c Show)>,
        full: bool,
    ) -> Value {
        let values: Vec<Value> = cells.map(|(k, (text, quality))| json!([k, text, quality])).collect();
        if !values.is_empty() {
            frame.insert("values".to_owned(), json!(values));
        }
        let view: Vec<(u32, &Show)> = view.collect();
        if !view.is_empty() {
            frame.insert("view".to_owned(), json!(view));
        }
        frame.insert("now".to_owned(), json!(seconds(self.sight.now())));
        // The age of all this: a controller that shows nothing any more is not alive.
        frame.insert("age".to_owned(), json!(seconds(now - self.seen)));
        frame.insert("full".to_owned(), json!(full));
        Value::Object(frame)
    }

    /// The parts of the picture.
    fn view(&mut self) -> Vec<Show> {
        let Some(view) = &self.names.view else { return Vec::new() };
        view.values(&self.names.bench, &mut self.sight, self.picture.as_mut())
    }

    /// The parts of a frame that are sent as a whole.
    fn parts(&self, paces: &Paces) -> [(&'static str, Value); 8] {
        let (mode, since) = self.mode;
        let reason =
            if let Mode::Fault(reason) = mode { Some(reason_json(&self.names, reason)) } else { None };
        let word = match mode {
            Mode::Stop => "stop",
            Mode::Run => "run",
            Mode::Fault(_) => "fault",
        };
        // A run that drives nothing yet waits for the first values of its devices.
        let waits = mode == Mode::Run && !self.sight.drives();
        let state = self.sight.state();
        let mode = json!({ "is": word, "since": seconds(since), "reason": reason, "waits": waits });
        let counts = json!({ "missed": self.sight.missed(), "lost": self.sight.lost() });
        [
            ("mode", mode),
            ("file", self.file.clone()),
            ("counts", counts),
            ("on", json!(self.active())),
            ("enabled", json!(if state.is_started() { self.enabled() } else { BTreeMap::new() })),
            ("forced", self.sight.forces().filter_map(|force| self.force(force)).collect()),
            ("devices", self.devices.iter().map(device_state).collect()),
            ("events", self.events.iter().map(|entry| self.event(entry)).collect()),
        ]
        .map(|(key, part)| match key {
            "counts" => (key, with_pace(part, paces)),
            _ => (key, part),
        })
    }

    /// The active steps with the time since their activation, in ms.
    fn active(&self) -> Vec<(u32, i64)> {
        let (program, state, bench) = (self.sight.program(), self.sight.state(), &self.names.bench);
        let active = (0u32..).zip(&bench.steps).filter(|(_, step)| bench.is_active(state, step));
        active
            .map(|(number, step)| {
                let age = match step.id {
                    Activity::Step(id) => state.step_age(program, id),
                    Activity::Macro(group) => state.group_age(program, group),
                };
                (number, age / Nanos::MILLISECOND.count())
            })
            .collect()
    }

    /// The enabled transitions: 1, or 2 where the receptivity is true.
    fn enabled(&self) -> BTreeMap<u32, u8> {
        let mut found = BTreeMap::new();
        let tell = |rank: u32, holds: bool| {
            if let Some(number) = self.places.transition(rank) {
                let mark = found.entry(number).or_insert(1);
                *mark = (*mark).max(1 + u8::from(holds));
            }
        };
        // A fault in a receptivity is told when a scan meets it.
        g7_engine::enabled(self.sight.program(), self.sight.state(), tell).ok();
        found
    }

    /// The value of a row and its quality.
    fn cell(&self, row: &Row) -> (String, &'static str) {
        let bench = &self.names.bench;
        let Some(item) = bench.items.get(row.item) else { return (String::new(), "") };
        let drives = self.sight.drives();
        let value = match item.role {
            Role::Input(index) if item.words == 1 => Word::Word(self.sight.input(index)),
            Role::Output if !drives && item.words == 1 => Word::Word(bench.safe(item).unwrap_or(0)),
            Role::Input(_) | Role::Output | Role::Variable | Role::Plant => {
                bench.value_in(self.sight.state(), item)
            }
        };
        (item.show(&value), self.quality(row.point, drives))
    }

    fn quality(&self, point: At, drives: bool) -> &'static str {
        match point {
            At::Input(device, k, bad) => match (self.sight.quality(device, k), bad) {
                (Quality::Good, _) => "good",
                (_, WhileBad::Word(_)) => "substituted",
                (Quality::Unread, _) => "unread",
                (Quality::Bad, _) => "bad",
            },
            At::Output(device, k) => {
                let refused = self.devices.get(device).is_some_and(|state| state.refused.contains(&k));
                match () {
                    () if !self.sight.is_up(device) || refused => "bad",
                    () if !drives => "safe",
                    () => "good",
                }
            }
            At::Good => "good",
            At::Plant => "simulated",
            At::Free => "free",
            At::Inside => "",
        }
    }

    fn force(&self, force: Forced) -> Option<Value> {
        let item = self.names.forced(force.what)?;
        let row = self.rows.iter().position(|row| {
            self.names.bench.items.get(row.item).is_some_and(|known| std::ptr::eq(known, item))
        })?;
        let (_, value) = self.names.value_of(force);
        Some(json!({ "signal": row, "value": value, "until": seconds(force.until) }))
    }

    fn event(&self, entry: &Entry) -> Value {
        let mut event = entry.told.json(&entry.names);
        if let Some(fields) = event.as_object_mut() {
            fields.insert("n".to_owned(), json!(entry.number));
            fields.insert("at".to_owned(), json!(seconds(entry.at)));
            fields.insert("level".to_owned(), json!(entry.level.word()));
            fields.insert("over".to_owned(), json!(entry.over));
            fields.insert("seen".to_owned(), json!(entry.seen));
        }
        event
    }
}

/// The variables that the page shows.
fn rows(names: &Names) -> Vec<Row> {
    let items = names.bench.items.iter().enumerate().filter(|(_, item)| item.role != Role::Plant);
    items.map(|(number, item)| Row { item: number, point: point(names, item) }).collect()
}

/// The name of a machine: that of its chart, or of the folder where the chart is just `chart`.
fn title(file: &str) -> String {
    let path = Path::new(file);
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let folder = path.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    match folder {
        Some(folder) if stem == "chart" => folder,
        Some(_) | None => stem,
    }
}

/// In seconds, to the millisecond.
fn seconds(time: Nanos) -> f64 {
    (time.count() as f64 / 1e6).round() / 1e3
}

fn device_state(state: &State) -> Value {
    json!({ "up": state.up, "since": seconds(state.since), "why": state.why })
}

/// Adds how late the scans were and how long they took.
fn with_pace(mut counts: Value, paces: &Paces) -> Value {
    let us = |time: Nanos| (time.count() as f64 / 1e3).round();
    let spread = |s: Spread| json!({ "p50_us": us(s.p50), "p99_us": us(s.p99), "most_us": us(s.most) });
    if let Some(fields) = counts.as_object_mut() {
        fields.insert("scans".to_owned(), json!(paces.scans()));
        fields.insert("late".to_owned(), spread(paces.late()));
        fields.insert("took".to_owned(), spread(paces.took()));
    }
    counts
}

/// The place to which a variable is wired.
fn point(names: &Names, item: &Item) -> At {
    let bench = &names.bench;
    for (device, wired) in names.wiring.devices.iter().enumerate() {
        match item.role {
            Role::Input(index) => {
                let target = Target::Input(index);
                if let Some(k) = wired.inputs.iter().position(|input| input.target == target) {
                    return At::Input(device, k, wired.inputs.get(k).map_or(WhileBad::Hold, |i| i.bad));
                }
                if wired.good.contains(&index) {
                    return At::Good;
                }
            }
            Role::Output => {
                let is = |out: &g7_online::OutAt| out.name == item.name && out.out.safe.is_some();
                if let Some(k) = wired.outputs.iter().position(is) {
                    return At::Output(device, k);
                }
            }
            Role::Variable | Role::Plant => return At::Inside,
        }
    }
    let coupling = bench.plant.as_ref().map(|plant| &plant.coupling);
    let first = bench.compiled.program.tables().outputs.start;
    let plant = coupling.is_some_and(|coupling| match item.role {
        Role::Input(index) => coupling.to_charts.iter().any(|(_, to)| *to == index),
        Role::Output => coupling.to_plant.iter().any(|(from, _)| first + from == item.addr),
        Role::Variable | Role::Plant => false,
    });
    match item.role {
        Role::Variable | Role::Plant => At::Inside,
        Role::Input(_) | Role::Output if plant => At::Plant,
        Role::Input(_) | Role::Output => At::Free,
    }
}
/// A file that the chart uses, for the page, which opens the text with it.
fn used(other: &Other) -> Value {
    json!({ "file": other.path, "text": other.source.text })
}
