//! Faults at random: the laws that hold in any course of them. Each seed gives another course, and the same one
//! each time.
//!
//! A seed that has failed once stands in `seeds.txt`, and is tried first, always.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use g7_host::Start;
use g7_model::Nanos;
use g7_online::{Command, Mode, Raw, Started};
use g7_peers::faults::row;

use crate::common::{Chance, Ill};
use crate::world::{CHART, Fault, IO, MS, Simulation};
use crate::{clock, safe, wrote};

/// Seeds that have failed.
const FAILED: &str = include_str!("seeds.txt");
/// The time of each course, apart from its end: so many pauses of 350 ms on average.
const TURNS: usize = 60;

/// The number behind a variable of the environment.
fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|n| n.parse().unwrap_or_else(|e| panic!("{name}: {e}")))
}

/// The seeds of this run: those that have failed and 200 more, as many as `G7_SEEDS` says, or `G7_SEED` alone,
/// to look at one that failed.
fn seeds() -> Vec<u64> {
    if let Some(seed) = number("G7_SEED") {
        return vec![seed];
    }
    let lines = FAILED.lines().filter_map(|line| line.split('#').next()).map(str::trim);
    let failed = lines.filter(|l| !l.is_empty()).map(|l| l.parse().expect("a seed, and behind # why"));
    failed.chain(0..number("G7_SEEDS").unwrap_or(200)).collect()
}

#[test]
fn row_26_outputs_follow_the_inputs_after_any_course_of_faults() {
    let seeds = seeds();
    let begin = clock();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let parts: Vec<Part> = std::thread::scope(|scope| {
        let part = |first| seeds.iter().skip(first).step_by(threads).copied();
        let begun: Vec<_> = (0..threads).map(|first| scope.spawn(move || Part::of(part(first)))).collect();
        begun.into_iter().map(|part| part.join().expect("panics are caught in it")).collect()
    });
    let failed: Vec<u64> = parts.iter().flat_map(|part| part.failed.iter().copied()).collect();
    let tally = parts.iter().fold(Tally::default(), |sum, part| sum.and(&part.tally));
    let simulated = parts.iter().fold(Nanos::ZERO, |sum, part| sum + part.simulated);
    assert!(failed.is_empty(), "seeds {failed:?}: add each to tests/simulation/seeds.txt, with its cause");
    let hours = simulated.as_seconds() / 3600.0;
    let a_minute = hours * 60.0 / begin.elapsed().as_secs_f64();
    let held = format!("{hours:.1} simulated hours at {a_minute:.0} a minute; {tally}");
    row(26, "courses of faults", seeds.len() as u64, 0, held);
    if seeds.len() > 100 {
        assert!(tally.is_full(), "each kind of fault is met: {tally}");
    }
}

/// The findings of one thread.
#[derive(Default)]
struct Part {
    failed: Vec<u64>,
    simulated: Nanos,
    tally: Tally,
}

impl Part {
    fn of(seeds: impl Iterator<Item = u64>) -> Part {
        let mut part = Part::default();
        for seed in seeds {
            // The name of a course stands before its seed.
            match catch_unwind(AssertUnwindSafe(|| course(seed, &mut part.tally))) {
                Ok(time) => part.simulated += time,
                Err(_) => part.failed.push(seed),
            }
        }
        part
    }
}

/// How often each kind was met.
#[derive(Debug, Default)]
struct Tally {
    watchdog: u64,
    missed: u64,
    unsaved: u64,
    warm: u64,
    fitted: u64,
    newer: u64,
}

impl Tally {
    fn and(&self, other: &Tally) -> Tally {
        Tally {
            watchdog: self.watchdog + other.watchdog,
            missed: self.missed + other.missed,
            unsaved: self.unsaved + other.unsaved,
            warm: self.warm + other.warm,
            fitted: self.fitted + other.fitted,
            newer: self.newer + other.newer,
        }
    }

    fn is_full(&self) -> bool {
        let Tally { watchdog, missed, unsaved, warm, fitted, newer } = *self;
        [watchdog, missed, unsaved, warm, fitted, newer].iter().all(|n| *n > 0)
    }
}

impl std::fmt::Display for Tally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Tally { watchdog, missed, unsaved, warm, fitted, newer } = self;
        write!(
            f,
            "{watchdog} watchdog faults, {missed} scans left out and counted, {unsaved} times unsaved and told, \
             {warm} warm starts, {fitted} with another chart, {newer} with values that were not acknowledged yet"
        )
    }
}

/// The chart with one more step and one more retained variable.
fn other() -> String {
    CHART
        .replace("var presses", "var more : INT := 3 retain\nvar presses")
        .replace("  step 2", "  step 7 { N lamp }\n  step 2")
}

/// One course; returns the time that it took in the simulation.
fn course(seed: u64, tally: &mut Tally) -> Nanos {
    let mut chance = Chance(seed);
    let mut s = Simulation::new(CHART, IO);
    s.guard(MS * 250);
    assert_eq!(s.start(), Started::Cold, "the disk is empty");
    s.command(Command::Run);
    let charts = [CHART.to_owned(), other()];
    for _ in 0..TURNS {
        disturb(&mut s, &mut chance, &charts, tally);
        s.pass(MS * (1 + chance.below(700) as i64));
        s.take_events();
    }
    ends_well(&mut s, seed);
    tally.watchdog += s.modes.iter().filter(|(_, m)| is_watchdog(*m)).count() as u64;
    tally.missed += s.missed;
    tally.unsaved += s.unsaved;
    s.now
}

fn is_watchdog(mode: Mode) -> bool {
    matches!(mode, Mode::Fault(g7_online::Reason::Watchdog))
}

/// One thing that happens.
fn disturb(s: &mut Simulation, chance: &mut Chance, charts: &[String; 2], tally: &mut Tally) {
    let lasts = MS * (1 + chance.below(3_000) as i64);
    match chance.below(25) {
        0..=3 => s.set(|w| w.go = !w.go),
        4 => s.set(|w| w.level = (w.level + 7) % 100),
        5 => s.set(|w| w.fault = Fault::Silent),
        6 => s.set(|w| w.fault = Fault::Gone),
        7 => s.set(|w| w.fault = Fault::NoButton),
        8 => s.set(|w| w.fault = Fault::Nonsense),
        9 => s.set(|w| w.fault = Fault::Slow),
        10 => s.set(|w| w.fault = Fault::Stubborn),
        11 => s.set(|w| w.fault = Fault::Panics),
        // It starts anew and has forgotten its outputs.
        12 => s.set(|w| w.outputs = wrote(true, false, 77)),
        13 | 14 => s.set(|w| w.fault = Fault::None),
        15 => s.command(Command::Stop),
        16 => s.command(Command::Run),
        17 => {
            s.command(Command::Acknowledge);
            s.command(Command::Run);
        }
        18 => {
            let name = ["go", "valve", "lamp", "level"][chance.below(4) as usize];
            let force = s.force_of(name);
            s.command(Command::Force(force, chance.below(2), lasts));
        }
        19 => s.command(Command::Restart(Start::Warm)),
        // Twice as many as not are short enough for the watchdog.
        20 => s.hold_scan(MS * chance.below(375) as i64),
        21 => {
            // The whole machine stands still, no thread works.
            s.now += MS * chance.below(375) as i64;
        }
        22 => {
            let kinds = [Ill::Well, Ill::Full, Ill::NoWrite, Ill::NoSync, Ill::Panics];
            let ill = kinds[chance.below(5) as usize];
            s.disk.plates().ill = ill;
        }
        23 => {
            let between = MS * [0, 25][chance.below(2) as usize];
            s.change(&charts[chance.below(2) as usize], IO, between);
        }
        _ => {
            let (present, acknowledged) = s.presses();
            s.disk.plates().ill = Ill::Well;
            match s.lose_power(chance) {
                Started::Cold => assert_eq!(acknowledged, 0, "what was acknowledged is there"),
                Started::Warm => tally.warm += 1,
                Started::Fitted(..) => tally.fitted += 1,
            }
            let (loaded, _) = s.presses();
            assert!(acknowledged <= loaded && loaded <= present, "{acknowledged} {loaded} {present}");
            tally.newer += u64::from(loaded > acknowledged);
            s.command(Command::Run);
        }
    }
}

/// All is well again and the controller runs: within 5 s all is as it should be.
fn ends_well(s: &mut Simulation, seed: u64) {
    s.set(|w| w.fault = Fault::None);
    s.disk.plates().ill = Ill::Well;
    s.command(Command::ReleaseAll);
    s.command(Command::Acknowledge);
    s.command(Command::Run);
    s.pass(MS * 5_000);
    let (go, mode) = (s.go(), s.machine.controller.mode());
    assert_eq!(mode, Mode::Run, "seed {seed}");
    assert_eq!(s.outputs()[..2], [Raw::Bit(go), Raw::Bit(!go)], "seed {seed}");
    let (present, saved) = s.presses();
    assert_eq!(present, saved, "seed {seed}: saved after at most a second");
    let (scans, missed) = (s.scans(), s.missed);
    s.pass(MS * 1_000);
    assert_eq!((s.scans() - scans, s.missed - missed), (100, 0), "seed {seed}: a scan each 10 ms");
    s.command(Command::Stop);
    s.pass(MS * 50);
    assert_eq!(s.outputs(), safe(), "seed {seed}");
    assert_eq!(s.machine.controller.lost(), 0, "seed {seed}: no event is lost");
}

/// A guard against a course that is so short that nothing happens in it.
#[test]
fn a_course_is_longer_than_the_longest_pause_of_a_device() {
    let least = course(0, &mut Tally::default());
    assert!(Duration::from_nanos(least.count().unsigned_abs()) > Duration::from_secs(10));
}
