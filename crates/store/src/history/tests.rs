//! The changes that were recorded are those that are read: at any time, over restarts, crashes, losses and clocks that jump.

use std::path::{Path, PathBuf};

use g7_host::{Kind, Value};
use g7_model::{Moment, Nanos};

use super::packed::{Changes, Packed};
use super::{Clock, Limits, Overview, Piece, Reader, Seen, Signal, Writer, kind_of, kind_word, lane};

const WIDE: Limits = Limits { age: Nanos::new(i64::MAX), bytes: u64::MAX };
/// 2026-01-01, in us.
const NEW_YEAR: i64 = 1_767_225_600_000_000;
const HOUR: i64 = 3_600_000_000;

struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Scratch {
        let path = std::env::temp_dir().join(format!("g7-history-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Scratch(path)
    }

    fn file(&self) -> PathBuf {
        self.0.join("record")
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).ok();
    }
}

/// Random numbers (SplitMix64).
struct Random(u64);

impl Random {
    fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    fn below(&mut self, most: u64) -> u64 {
        self.word() % most
    }

    /// Of any size up to so many bits.
    fn any_size(&mut self, bits: u64) -> i64 {
        let size = self.below(bits);
        self.below(1 << size) as i64
    }
}

const KINDS: [Kind; 9] = [
    Kind::Bool,
    Kind::Int { bits: 16, signed: true },
    Kind::Int { bits: 64, signed: false },
    Kind::Real,
    Kind::Lreal,
    Kind::Time,
    Kind::Moment(Moment::Date),
    Kind::Moment(Moment::Tod),
    Kind::Moment(Moment::Dt),
];

/// A word of a kind; every kind has its strange ones.
fn word(kind: Kind, random: &mut Random) -> u64 {
    let any = random.word();
    match kind {
        Kind::Bool => any & 1,
        Kind::Int { bits: 16, .. } => (any as i16) as i64 as u64,
        Kind::Int { .. } | Kind::Time | Kind::Moment(_) | Kind::Text => match any % 4 {
            0 => u64::MAX,
            1 => i64::MIN as u64,
            _ => any >> (any % 60),
        },
        Kind::Real => match any % 8 {
            0 => u64::from(f32::NAN.to_bits()),
            1 => u64::from(f32::NEG_INFINITY.to_bits()),
            _ => u64::from(((any % 1000) as f32 / 8.0).to_bits()),
        },
        Kind::Lreal => match any % 8 {
            0 => f64::NAN.to_bits(),
            1 => (-0.0f64).to_bits(),
            2 => any,
            _ => ((any % 1000) as f64 / 10.0).to_bits(),
        },
    }
}

fn signal(name: &str, kind: Kind) -> Signal {
    Signal { name: name.to_owned(), kind, class: "inputs".to_owned(), ty: kind_word(kind), comment: None }
}

#[test]
fn packed_changes_come_back_bit_by_bit() {
    let mut random = Random(7);
    for kind in KINDS {
        assert_eq!(kind_of(&kind_word(kind)), Some(kind));
        let mut packed = Packed::new(kind);
        let mut at = random.below(1 << 40) as i64;
        let mut given = Vec::new();
        for _ in 0..400 {
            at += random.any_size(45);
            given.push((at, word(kind, &mut random)));
            packed.push(at, given[given.len() - 1].1);
        }
        let read: Vec<_> = Changes::new(kind, packed.start, &packed.data).collect();
        assert_eq!(read, given, "{kind:?}");
        // Damaged data ends, and nothing more.
        for _ in 0..300 {
            let mut bytes = packed.data.clone();
            let place = random.below(bytes.len() as u64) as usize;
            bytes[place] = random.word() as u8;
            bytes.truncate(random.below(bytes.len() as u64) as usize + 1);
            assert!(Changes::new(kind, i64::MAX - 5, &bytes).count() <= bytes.len());
        }
    }
}

/// The begin of a span, its end, and its changes.
type Stretch = (i64, i64, Vec<(i64, String, u64)>);

/// The record as it ought to be, in times of the record.
#[derive(Clone, Default)]
struct Truth {
    spans: Vec<Stretch>,
}

impl Truth {
    fn at(&self, name: &str, at: i64) -> Option<u64> {
        let (.., changes) = self.spans.iter().rev().find(|(start, stop, _)| *start <= at && at <= *stop)?;
        changes.iter().rev().find(|(when, of, _)| *when <= at && of == name).map(|(.., word)| *word)
    }

    fn instants(&self) -> Vec<i64> {
        let of = |(start, stop, changes): &Stretch| {
            let changes = changes.iter().map(|(at, ..)| *at);
            changes.chain([*start, *stop]).collect::<Vec<_>>()
        };
        self.spans.iter().flat_map(of).collect()
    }
}

/// The value that a reader shows at an instant.
fn shown(seen: &[Seen], at: i64) -> Option<u64> {
    let mut value = None;
    for part in seen {
        match part {
            Seen::Value(when, word) if *when <= at => value = Some(*word),
            Seen::Unknown(when) if *when < at => value = None,
            _ => {}
        }
    }
    value
}

fn visited(reader: &Reader, all: &Overview, name: &str, span: (i64, i64)) -> Vec<Seen> {
    let (id, signal) = all.named(name).next().unwrap_or_else(|| panic!("no {name}"));
    let mut seen = Vec::new();
    reader.visit(all, (*id, signal.kind), span, |_, _| false, |part| seen.push(part)).expect("it reads");
    seen
}

/// One controller after the other, with all that can happen to them.
fn story(seed: u64, path: &Path) -> (Truth, Vec<Signal>) {
    let mut random = Random(seed);
    let all: Vec<Signal> =
        KINDS.iter().enumerate().map(|(k, kind)| signal(&format!("s{k}"), *kind)).collect();
    let mut truth = Truth::default();
    let mut utc = NEW_YEAR;
    let mut end = None;
    for _ in 0..4 {
        // The clock of a controller begins anew at each start, that of the wall where it likes.
        let mut now = Nanos::from_millis(random.below(5_000) as i64);
        let pause = random.below(3 * 86_400_000_000) as i64;
        utc += pause;
        let mut writer = Writer::open(path, WIDE, now, utc).expect("it opens");
        let base = match end {
            None => 0,
            // A pause counts as a day at most.
            Some(end) => end + pause.clamp(1, 24 * HOUR),
        } - now.count() / 1000;
        let mut committed = truth.clone();
        let mut table: Vec<Signal> = Vec::new();
        for k in 0..300 {
            let passes = random.any_size(31) * 1000;
            now += Nanos::new(passes + 1000);
            utc += passes / 1000 + 1;
            let at = now.count() / 1000 + base;
            let what = if k == 0 { 0 } else { random.below(40) };
            match what {
                0 | 1 => {
                    // Another chart, or notes that were lost.
                    let lost = if k == 0 { 0 } else { what };
                    table = all.iter().filter(|_| random.below(4) > 0).cloned().collect();
                    writer.begin(now, &table, lost);
                    if let (Some(last), true) = (truth.spans.last_mut(), k > 0 && lost == 0) {
                        last.1 = at;
                    }
                    truth.spans.push((at, at, Vec::new()));
                    for (number, signal) in (0..).zip(&table) {
                        let word = word(signal.kind, &mut random);
                        writer.change(now, number, word);
                        truth.spans.last_mut().expect("a span").2.push((at, signal.name.clone(), word));
                    }
                }
                2..30 if !table.is_empty() => {
                    let number = random.below(table.len() as u64) as usize;
                    let word = word(table[number].kind, &mut random);
                    writer.change(now, number as u32, word);
                    let span = truth.spans.last_mut().expect("a span");
                    span.1 = at;
                    span.2.push((at, table[number].name.clone(), word));
                }
                30..34 => {
                    writer.alive(now);
                    truth.spans.last_mut().expect("a span").1 = at;
                }
                34 => {
                    // The wall clock jumps: by an hour, or by ten years.
                    let by = [HOUR, -HOUR, 87_600 * HOUR, -87_600 * HOUR][random.below(4) as usize];
                    utc += by;
                    writer.clock(now, utc);
                }
                _ => {
                    assert_eq!(writer.commit().expect("there is room"), 0);
                    committed = truth.clone();
                }
            }
        }
        if random.below(2) == 0 {
            writer.close().expect("there is room");
        } else {
            // A crash: what was committed is there.
            drop(writer);
            truth = committed;
        }
        end = truth.spans.last().map(|span| span.1);
        // A clock that the record has not seen would make the pause another one.
        let reader = Reader::open(path).expect("it opens");
        let overview = reader.overview().expect("it reads");
        utc = overview.clock.utc(overview.until);
    }
    (truth, all)
}

#[test]
fn whatever_happens_what_was_recorded_is_what_is_read() {
    let mut values = 0;
    for seed in 0..6 {
        let scratch = Scratch::new(&format!("story-{seed}"));
        let (truth, all) = story(seed, &scratch.file());
        let reader = Reader::open(&scratch.file()).expect("it opens");
        let overview = reader.overview().expect("it reads");
        let spans: Vec<_> = overview.spans.iter().map(|span| (span.start, span.stop)).collect();
        assert_eq!(spans, truth.spans.iter().map(|s| (s.0, s.1)).collect::<Vec<_>>(), "seed {seed}");
        assert!(spans.windows(2).all(|two| two[0].1 <= two[1].0), "time went back: {spans:?}");
        let instants = truth.instants();
        let (first, last) = (spans[0].0, overview.until);
        let mut random = Random(seed);
        for signal in &all {
            for _ in 0..6 {
                let mut any = || instants[random.below(instants.len() as u64) as usize];
                let (a, b) = (any(), any());
                let (from, to) = (a.min(b), a.max(b) + (a & 1));
                let seen = visited(&reader, &overview, &signal.name, (from, to));
                // Where one span ends and another begins both are right.
                let border = |at: &i64| spans.windows(2).any(|two| two[0].1 == *at && two[1].0 == *at);
                let within = instants.iter().flat_map(|at| [at - 1, *at, at + 1]).filter(|at| !border(at));
                for at in within.filter(|at| (from..=to).contains(at) && (first..=last).contains(at)) {
                    let expected = truth.at(&signal.name, at);
                    values += u64::from(expected.is_some());
                    assert_eq!(
                        shown(&seen, at),
                        expected,
                        "seed {seed}, {} at {at} of {from}-{to}",
                        signal.name
                    );
                }
            }
        }
    }
    assert!(values > 50_000, "{values} values compared");
}

#[test]
fn a_lane_has_what_its_columns_have() {
    let scratch = Scratch::new("lane");
    let mut writer = Writer::open(&scratch.file(), WIDE, Nanos::ZERO, NEW_YEAR).expect("it opens");
    let signals = [signal("busy", Kind::Bool), signal("level", Kind::Lreal), signal("calm", Kind::Bool)];
    writer.begin(Nanos::ZERO, &signals, 0);
    for (number, word) in [(0, 0), (1, 0f64.to_bits()), (2, 0)] {
        writer.change(Nanos::ZERO, number, word);
    }
    // An hour of a change each 20 ms, and one of the calm signal.
    let level = |k: i64| ((k % 500) as f64) - 100.0;
    for k in 1..180_000 {
        let at = Nanos::from_millis(20 * k);
        writer.change(at, 0, (k % 2) as u64);
        writer.change(at, 1, level(k).to_bits());
        if k == 90_000 {
            writer.change(at, 2, 1);
        }
        if k % 50 == 0 {
            writer.commit().expect("there is room");
        }
    }
    writer.commit().expect("there is room");
    let reader = Reader::open(&scratch.file()).expect("it opens");
    let overview = reader.overview().expect("it reads");
    let of = |name: &str, columns| {
        let (id, signal) = overview.named(name).next().expect("it is there");
        lane(&reader, &overview, (*id, signal.kind), (0, HOUR), columns).expect("it reads")
    };
    let calm = of("calm", 100);
    assert_eq!(calm[..2], [Piece::Value(0, 0), Piece::Value(1_800_000_000, 1)]);
    assert!(matches!(calm[2..], [Piece::Unknown(_)]), "{calm:?}");
    for (name, low, high) in [("busy", 0.0, 1.0), ("level", -100.0, 399.0)] {
        let pieces = of(name, 100);
        let mut changes = 0;
        for piece in &pieces[..pieces.len() - 1] {
            // 36 s of 20 ms each: all values are there.
            let Piece::Busy { start, stop, count, range, .. } = piece else { panic!("{piece:?}") };
            assert!(start / 36_000_000 == stop / 36_000_000, "two columns: {start} to {stop}");
            assert_eq!(*range, Some((low, high)), "{name} at {start}");
            changes += count;
        }
        assert_eq!((changes, pieces.len()), (180_000, 101), "{name}");
    }
    // From near each change is seen.
    let (id, near) = overview.named("level").next().expect("it is there");
    let near = lane(&reader, &overview, (*id, near.kind), (1_000_000, 1_100_000), 100).expect("it reads");
    let expected: Vec<_> = (50..=55).map(|k| Piece::Value(20_000 * k, level(k).to_bits())).collect();
    assert_eq!(near, expected);
}

#[test]
fn what_is_too_old_or_too_much_goes_and_what_stands_stays() {
    for (limits, name) in
        [(Limits { age: Nanos::HOUR, ..WIDE }, "age"), (Limits { bytes: 400_000, ..WIDE }, "bytes")]
    {
        let scratch = Scratch::new(name);
        let mut writer = Writer::open(&scratch.file(), limits, Nanos::ZERO, NEW_YEAR).expect("it opens");
        writer.begin(Nanos::ZERO, &[signal("n", Kind::Lreal), signal("still", Kind::Bool)], 0);
        writer.change(Nanos::ZERO, 0, 0);
        writer.change(Nanos::ZERO, 1, 1);
        let mut random = Random(1);
        for k in 1..50_000 {
            let at = Nanos::from_millis(k * 200);
            writer.change(at, 0, random.word() >> 12);
            if k % 5 == 0 {
                writer.commit().expect("there is room");
            }
        }
        writer.close().expect("there is room");
        let reader = Reader::open(&scratch.file()).expect("it opens");
        let overview = reader.overview().expect("it reads");
        let kept = overview.until - overview.from;
        match name {
            // To the next time that batches are sorted.
            "age" => assert!((HOUR..HOUR + HOUR / 5).contains(&kept), "{kept}"),
            _ => {
                let size = std::fs::metadata(scratch.file()).expect("it is there").len();
                assert!(size < 1_600_000 && kept > HOUR / 4, "{size} bytes, {kept} us");
            }
        }
        // A signal that has not changed since has its value at the first instant that is kept.
        let still = visited(&reader, &overview, "still", (0, overview.until));
        assert_eq!(still, [Seen::Value(overview.from, 1)]);
        let changes = visited(&reader, &overview, "n", (0, overview.until));
        assert_eq!(changes.len() as i64, (kept + 1) / 200_000 + 1, "{name}");
    }
}

#[test]
fn a_full_disk_is_a_gap_with_a_count_and_the_record_goes_on() {
    let scratch = Scratch::new("full");
    let mut writer = Writer::open(&scratch.file(), WIDE, Nanos::ZERO, NEW_YEAR).expect("it opens");
    writer.begin(Nanos::ZERO, &[signal("x", Kind::Lreal)], 0);
    let mut random = Random(3);
    let mut at = 0;
    let mut change = |writer: &mut Writer, at: i64| writer.change(Nanos::from_millis(at), 0, random.word());
    for _ in 0..1000 {
        at += 1;
        change(&mut writer, at);
    }
    writer.commit().expect("there is room");
    let before = at;
    let pages: i64 = {
        let file = rusqlite::Connection::open(scratch.file()).expect("it opens");
        file.pragma_query_value(None, "page_count", |row| row.get(0)).expect("it reads")
    };
    writer.limit_pages(pages);
    let mut failed = 0;
    for _ in 0..20_000 {
        at += 1;
        change(&mut writer, at);
        if at % 1000 == 0 {
            let error = writer.commit().expect_err("the disk is full");
            assert!(error.is_full(), "{error}");
            failed += 1;
        }
    }
    assert_eq!(failed, 20);
    writer.limit_pages(1 << 30);
    let lost = writer.commit().expect("there is room again");
    assert_eq!(lost, 20_000, "each change is written or counted");
    let again = at;
    at += 10;
    change(&mut writer, at);
    writer.close().expect("there is room");
    let reader = Reader::open(&scratch.file()).expect("it opens");
    let overview = reader.overview().expect("it reads");
    let spans: Vec<_> = overview.spans.iter().map(|s| (s.start, s.stop, s.lost)).collect();
    assert_eq!(spans, [(0, before * 1000, 0), (again * 1000, at * 1000, lost)]);
    let seen = visited(&reader, &overview, "x", (0, overview.until));
    assert_eq!(seen.len(), 1000 + 1 + 2, "its value then, and the one behind it");
    assert_eq!(seen[1000], Seen::Unknown(before * 1000));
}

#[test]
fn the_wall_clock_is_noted_and_a_time_of_it_is_found_wherever_it_was() {
    let mut clock = Clock::default();
    clock.add(0, NEW_YEAR);
    assert!(!clock.parts(HOUR, NEW_YEAR + HOUR + 400_000) && clock.parts(HOUR, NEW_YEAR + HOUR + 600_000));
    // After an hour it is set back by one: one hour is there twice.
    clock.add(HOUR, NEW_YEAR);
    assert_eq!(clock.utc(HOUR / 2), clock.utc(HOUR + HOUR / 2));
    let twice = clock.ranges((0, 2 * HOUR), (NEW_YEAR + 600_000_000, NEW_YEAR + 1_200_000_000));
    assert_eq!(twice, [(600_000_000, 1_200_000_000), (HOUR + 600_000_000, HOUR + 1_200_000_000)]);
    assert!(clock.ranges((0, 2 * HOUR), (0, NEW_YEAR - 1)).is_empty());
}

#[test]
fn numbers_of_a_word_are_those_of_the_host() {
    // The summary of a chunk counts what is no number as nothing.
    let mut packed = Packed::new(Kind::Lreal);
    packed.push(0, f64::NAN.to_bits());
    assert_eq!(packed.range, None);
    packed.push(1, 2.5f64.to_bits());
    assert_eq!(packed.range, Some((2.5, 2.5)));
    assert_eq!(Value::Word(2.5f64.to_bits()).number(Kind::Lreal), 2.5);
}
