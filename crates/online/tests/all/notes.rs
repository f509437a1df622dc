//! The record of a controller: each change of each scan, or a loss that is told.

use std::collections::BTreeMap;

use g7_host::Kind;
use g7_model::{FileId, Nanos, Problem};
use g7_online::{
    Chart, Command, Device, Machine, Note, Notes, Picture, Table, Wiring, assemble, prepare, runner, setup,
    wire,
};
use g7_rig::{Bench, Options, Source, build};

const MS: Nanos = Nanos::MILLISECOND;

/// Step 2 lasts for one scan, and `fast` is another in each.
const CHART: &str = "\
profile iec61131
input go : BOOL
output valve : BOOL
output lamp : BOOL safe TRUE
var fast : DINT
var level : REAL
var name : STRING
chart Main {
  initial step 1 { N lamp }
  step 2 { N valve  P1 level := level + 0.3 }
  1 -> 2 when go
  2 -> 1 when TRUE
}
post { fast := fast + 1; }
";

fn bench(text: &str) -> (Source, Bench) {
    let source = Source::new("chart.g7", text.as_bytes().to_vec(), 0);
    let (bench, problems) = build(&source, &Options::default()).expect("it has no plant");
    let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
    (source, bench)
}

fn wired(bench: &Bench, io: &str) -> (Wiring, Vec<Problem>) {
    let (setup, mut problems) = setup::read(io, FileId(1));
    let (wiring, wrong) = wire(bench, &setup);
    problems.extend(wrong);
    (wiring, problems)
}

fn machine(bench: &Bench, wiring: &Wiring) -> (Machine, Notes) {
    let device = |_: &_| Err::<Box<dyn Device>, _>("there is none");
    let mut machine = assemble(runner(bench, wiring, 0), wiring, device).expect("no devices");
    let notes = machine.record(wiring).expect("signals are chosen");
    (machine, notes)
}

/// Values by name as they are read from notes, as a reader of a record makes them.
struct Read {
    table: Table,
    now: BTreeMap<String, u64>,
    /// By name: the time and the value of each change.
    all: BTreeMap<String, Vec<(Nanos, u64)>>,
    begins: Vec<(Nanos, u32)>,
    until: Nanos,
}

impl Read {
    fn new() -> Read {
        let table = Table { number: u64::MAX, signals: Vec::new() };
        Read { table, now: BTreeMap::new(), all: BTreeMap::new(), begins: Vec::new(), until: Nanos::ZERO }
    }

    fn take(&mut self, notes: &mut Notes) {
        while let Ok(note) = notes.notes.pop() {
            let (Note::Begin { at, .. } | Note::Change { at, .. } | Note::Alive { at }) = note;
            assert!(at >= self.until, "time went back");
            self.until = at;
            match note {
                Note::Begin { table, lost, .. } => {
                    self.table = notes.table(table).unwrap_or_else(|| self.table.clone());
                    assert_eq!(self.table.number, table, "it was given before");
                    self.now.clear();
                    self.begins.push((at, lost));
                }
                Note::Change { signal, word, .. } => {
                    let name = self.table.signals[signal as usize].name.clone();
                    self.now.insert(name.clone(), word);
                    self.all.entry(name).or_default().push((at, word));
                }
                Note::Alive { .. } => {}
            }
        }
    }
}

#[test]
fn each_change_is_noted_also_one_that_lasts_for_a_scan() {
    let (_, bench) = bench(CHART);
    let (wiring, problems) = wired(&bench, "[history]\nfile = 'r'\n");
    assert!(problems.is_empty(), "{problems:?}");
    let (mut machine, mut notes) = machine(&bench, &wiring);
    let controller = &mut machine.controller;
    let mut read = Read::new();
    controller.step(Nanos::ZERO);
    read.take(&mut notes);
    // Stopped: the outputs are safe.
    assert_eq!((read.now["lamp"], read.now["valve"], read.now.contains_key("name")), (1, 0, false));
    controller.command(Nanos::ZERO, Command::Run).expect("it is stopped");
    let mut now = Nanos::ZERO;
    let mut presses = 0;
    for k in 0..1000u64 {
        now = controller.due();
        // The button is pressed before each hundredth scan, for that scan.
        let go = u64::from(k % 100 == 50);
        presses += go;
        controller.command(now, Command::SetInput(0, go)).expect("an input");
        controller.step(now);
        if k % 7 == 0 {
            read.take(&mut notes);
            assert_eq!(read.now["fast"], k + 1);
        }
    }
    controller.command(now, Command::Stop).expect("it runs");
    controller.step(controller.due());
    read.take(&mut notes);
    assert_eq!(read.begins, [(Nanos::ZERO, 0)], "nothing was lost");
    assert_eq!(read.all["fast"].len(), 1001, "the first value, and one of each scan");
    assert!(read.all["fast"].windows(2).all(|two| two[1].0 - two[0].0 <= bench.period * 2));
    assert_eq!(read.all["X2"].iter().filter(|(_, on)| *on == 1).count() as u64, presses);
    for two in read.all["X2"].windows(2).filter(|two| two[0].1 == 1) {
        assert_eq!(two[1].0 - two[0].0, bench.period, "one scan long");
    }
    assert_eq!(read.all["valve"].len() as u64, 1 + 2 * presses);
    assert_eq!((read.now["lamp"], read.now["valve"]), (1, 0), "safe outputs");
}

#[test]
fn a_number_within_its_deadband_is_not_noted_and_is_never_further_off() {
    let (_, bench) = bench(CHART);
    let io = "[history]\nfile = 'r'\nsignals = ['level', 'X2']\ndeadband = { level = 1.0 }\n";
    let (wiring, problems) = wired(&bench, io);
    assert!(problems.is_empty(), "{problems:?}");
    let (mut machine, mut notes) = machine(&bench, &wiring);
    let controller = &mut machine.controller;
    let mut read = Read::new();
    controller.command(Nanos::ZERO, Command::Run).expect("it is stopped");
    controller.command(Nanos::ZERO, Command::SetInput(0, 1)).expect("an input");
    let real = |word: u64| f32::from_bits(word as u32);
    let item = bench.item("level").expect("a variable");
    for _ in 0..200 {
        controller.step(controller.due());
        read.take(&mut notes);
        let is = bench.value(controller.runner(), item).number(Kind::Real);
        assert!((f64::from(real(read.now["level"])) - is).abs() < 1.0);
    }
    let noted = &read.all["level"];
    // 100 steps of 0.3: one note each four of them.
    assert!((20..=26).contains(&noted.len()), "{noted:?}");
    assert!(noted.windows(2).all(|two| real(two[1].1) - real(two[0].1) >= 1.0));
}

#[test]
fn notes_that_find_no_room_are_counted_and_what_follows_begins_anew() {
    let (_, bench) = bench(CHART);
    let (wiring, _) = wired(&bench, "[history]\nfile = 'r'\nsignals = ['fast', 'lamp']\n");
    let (mut machine, mut notes) = machine(&bench, &wiring);
    let controller = &mut machine.controller;
    controller.command(Nanos::ZERO, Command::Run).expect("it is stopped");
    let scans = 200_000u64;
    for _ in 0..scans {
        controller.step(controller.due());
    }
    let mut read = Read::new();
    read.take(&mut notes);
    let before = read.all["fast"].len() as u64;
    assert!(before > 50_000 && before < scans, "{before}");
    let until = read.until;
    controller.step(controller.due());
    read.take(&mut notes);
    let (at, lost) = read.begins[1];
    assert_eq!((read.begins.len(), read.now["fast"], read.now["lamp"]), (2, scans + 1, 1));
    assert!(at > until + bench.period, "a gap");
    // The first value is that of the first scan; what is neither before the gap nor behind it was lost.
    assert_eq!(u64::from(lost), scans - before, "each change is noted or counted");
}

#[test]
fn an_on_line_change_ends_and_begins_signals_by_name() {
    let (source, old) = bench(CHART);
    let io = "[history]\nfile = 'r'\n";
    let (wiring, _) = wired(&old, io);
    let (mut machine, mut notes) = machine(&old, &wiring);
    let controller = &mut machine.controller;
    controller.command(Nanos::ZERO, Command::Run).expect("it is stopped");
    let mut read = Read::new();
    for _ in 0..10 {
        controller.step(controller.due());
    }
    read.take(&mut notes);
    let text = CHART
        .replace("output valve", "output extra : BOOL\noutput valve")
        .replace("var level : REAL\n", "")
        .replace("level := level + 0.3", "extra := TRUE");
    let (new_source, new) = bench(&text);
    let (new_wiring, problems) = wired(&new, io);
    assert!(problems.is_empty(), "{problems:?}");
    let mut picture = Picture::of(controller.runner());
    controller.look(&mut picture);
    let of = |bench, source: &'static Source, wiring| Chart { bench, document: &source.document, wiring };
    let (source, new_source) = (Box::leak(Box::new(source)), Box::leak(Box::new(new_source)));
    let mut prepared =
        prepare(of(&old, source, &wiring), of(&new, new_source, &new_wiring), &picture).expect("it fits");
    let table = prepared.table.take().expect("a history");
    assert!(controller.change(controller.due(), &mut prepared.successor));
    let at = controller.due();
    controller.step(at);
    // The one who makes changes gives the table to the reader.
    let found = std::iter::from_fn(|| notes.notes.pop().ok()).collect::<Vec<_>>();
    assert_eq!(found[0], Note::Begin { at, table: table.number, lost: 0 });
    let names = |table: &Table| table.signals.iter().map(|s| s.name.clone()).collect::<Vec<_>>();
    assert!(names(&table).contains(&"extra".to_owned()) && !names(&table).contains(&"level".to_owned()));
    let values: BTreeMap<String, u64> = found[1..]
        .iter()
        .filter_map(|note| match note {
            Note::Change { signal, word, at: when } if *when == at => {
                Some((table.signals[*signal as usize].name.clone(), *word))
            }
            _ => None,
        })
        .collect();
    assert_eq!(values.len(), table.signals.len(), "the values of all");
    assert_eq!(values["fast"], 11, "it goes on");
    // Another file needs a new start.
    let (other, _) = wired(&new, "[history]\nfile = 'other'\n");
    let refused = prepare(of(&old, source, &wiring), of(&new, new_source, &other), &picture).err();
    assert_eq!(
        refused.as_deref(),
        Some("[history]: the file, `days` or `megabytes` change: this needs a new start")
    );
    let (none, _) = wired(&new, "");
    assert!(prepare(of(&old, source, &wiring), of(&new, new_source, &none), &picture).is_err());
}

#[test]
fn what_cannot_be_recorded_is_told_with_its_place() {
    let (_, bench) = bench(CHART);
    let told = |rows: &str| -> Vec<(String, String)> {
        let io = format!("[history]\n{rows}");
        let place = |p: &Problem| io[p.at.start as usize..p.at.end as usize].to_owned();
        wired(&bench, &io).1.iter().map(|p| (place(p), p.what.to_string())).collect()
    };
    assert_eq!(told("file = 'r'\nsignals = ['go', 'X2', 'LEVEL']\ndays = 7\nmegabytes = 10"), []);
    let cases: &[(&str, &str, &str)] = &[
        ("signals = 'all'", "[history]", "[history] has no `file`"),
        ("file = 'r'\nsignals = ['gone']", "'gone'", "the chart has no variable or step `gone`"),
        ("file = 'r'\nsignals = ['name']", "'name'", "`name` is a STRING, which cannot be recorded"),
        ("file = 'r'\nsignals = ['go', 'GO']", "'GO'", "`go` is named twice"),
        ("file = 'r'\nsignals = []", "[]", "a history without signals records nothing"),
        ("file = 'r'\nsignals = [7]", "7", "a signal is a name in quotes"),
        ("file = 'r'\nsignals = 'some'", "'some'", "`signals` of [history] is \"all\", or a list of names"),
        ("file = 'r'\ndays = 0", "0", "`days` of [history] is a whole number from 1 to 100000"),
        ("file = 'r'\ndeadband = { go = 1 }", "go", "`go` is a BOOL: only numbers have a deadband"),
        ("file = 'r'\ndeadband = { level = -1 }", "-1", "the deadband of `level` is a number above 0"),
        (
            "file = 'r'\nsignals = ['go']\ndeadband = { level = 1 }",
            "level",
            "`level` has a deadband and is not recorded",
        ),
        ("file = 'r'\nkeep = 3", "keep", "[history] has no setting `keep`"),
    ];
    for (rows, place, what) in cases {
        let found = told(rows);
        assert!(found.iter().any(|(at, said)| at == place && said == what), "{rows}: {found:?}");
    }
}

#[test]
fn the_file_of_all_signals_names_steps_and_their_comments() {
    let (_, bench) = bench(&CHART.replace("step 2 {", "step 2 \"filling\" {"));
    let (wiring, _) = wired(&bench, "[history]\nfile = 'r'\n");
    let chosen = wiring.history.expect("a history");
    let names: Vec<_> = chosen.signals.iter().map(|s| (s.group, s.name.as_str(), s.ty.as_str())).collect();
    assert_eq!(
        names,
        [
            ("inputs", "go", "BOOL"),
            ("outputs", "valve", "BOOL"),
            ("outputs", "lamp", "BOOL"),
            ("variables", "fast", "DINT"),
            ("variables", "level", "REAL"),
            ("steps", "X1", "BOOL"),
            ("steps", "X2", "BOOL"),
        ]
    );
    assert_eq!(chosen.signals[6].comment.as_deref(), Some("filling"));
    assert!(MS < bench.period);
}
