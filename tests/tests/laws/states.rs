//! States as a search uses them, on random charts of all features and profiles:
//! equal canonical images have equal futures, runs that began at another time have
//! equal canonical images, and no words can harm a state that they are put into.

use std::collections::BTreeSet;

use g7_compile::{Compiled, compile};
use g7_engine::{
    Addr, Block, FaultKind, ImageError, Op, Program, State, Subject, WatchId, begin, enabled, pass, scan,
};
use g7_model::ProfileName;
use g7_tests::generate::{Rng, sample};

/// Charts of each profile.
const CHARTS: u64 = 120;
/// Scans of each chart.
const SCANS: usize = 40;
/// Scans for which two equal states are followed.
const AHEAD: usize = 12;
const MS: i64 = 1_000_000;

/// Random charts that compile.
fn charts() -> impl Iterator<Item = (String, Compiled)> {
    ProfileName::ALL.into_iter().flat_map(|profile| {
        (1..=CHARTS).filter_map(move |seed| {
            let sample = sample(seed, profile, 1).expect("a random chart can be read");
            compile(&sample.document).0.map(|c| (format!("{} seed {seed}", profile.name()), c))
        })
    })
}

/// The inputs of a scan and the time since the one before.
#[derive(Clone)]
struct Move {
    inputs: Vec<u64>,
    wait: i64,
}

fn moves(rng: &mut Rng, p: &Program, count: usize) -> Vec<Move> {
    let rows = p.tables().inputs;
    let mut inputs = vec![0; (rows.end - rows.start) as usize];
    let mut list = Vec::new();
    for _ in 0..count {
        for word in &mut inputs {
            if rng.percent(30) {
                *word = rng.below(2) as u64;
            }
        }
        let wait = rng.one([0, 1, MS, 5 * MS, 10 * MS, 10 * MS, 20 * MS, 37 * MS, 400 * MS, 20_000 * MS]);
        list.push(Move { inputs: inputs.clone(), wait });
    }
    list
}

/// All that can be seen of a scan but times: situation, variables, transitions
/// cleared, actions run, faults.
#[derive(Debug, PartialEq)]
struct Seen {
    steps: Vec<u32>,
    words: Vec<u64>,
    cleared: Vec<u32>,
    ran: Vec<u32>,
    end: String,
}

/// The words that are no values of the chart: those in which timers keep absolute
/// times, and locals, which a fault leaves as they are.
fn hidden(p: &Program) -> BTreeSet<usize> {
    let start = |op: &Op| match op {
        Op::Fb(Block::Ton | Block::Tof | Block::Tp, base) => Some(base.0 as usize + 4),
        _ => None,
    };
    let locals = p.tables().locals;
    p.tables().code.iter().filter_map(start).chain(locals.start as usize..locals.end as usize).collect()
}

fn step(p: &Program, s: &mut State, m: &Move, hidden: &BTreeSet<usize>) -> Seen {
    let now = s.now() + m.wait;
    let end = scan(p, s, &m.inputs, now);
    // A scan that is refused leaves the inputs and the reports of the one before.
    let refused = end.is_err_and(|f| f.kind == FaultKind::Stopped);
    let inputs = p.tables().inputs;
    let is_old = |i: usize| refused && (inputs.start as usize..inputs.end as usize).contains(&i);
    let words =
        s.words().iter().enumerate().filter(|(i, _)| !hidden.contains(i) && !is_old(*i)).map(|(_, w)| *w);
    Seen {
        steps: s.active().map(|s| s.0).collect(),
        words: words.collect(),
        cleared: if refused { Vec::new() } else { s.cleared().to_vec() },
        ran: if refused { Vec::new() } else { s.ran().to_vec() },
        end: format!("{end:?}"),
    }
}

fn canonical(p: &Program, s: &State) -> Vec<u64> {
    let mut image = Vec::new();
    s.canonical(p, &mut image);
    image
}

/// A state and the one that its canonical image gives go the same way. So two
/// states with equal canonical images do, since both go the way of that one.
#[test]
fn equal_canonical_images_have_equal_futures() {
    let (mut states, mut changes) = (0, 0);
    for (name, c) in charts() {
        let p = &c.program;
        let hidden = hidden(p);
        let mut rng = Rng::new(states + 1);
        let mut run = State::new(p);
        for (k, m) in moves(&mut rng, p, SCANS).iter().enumerate() {
            step(p, &mut run, m, &hidden);
            if rng.percent(70) {
                continue;
            }
            let image = canonical(p, &run);
            let mut other = State::new(p);
            other.restore(p, &image).expect("a canonical image is an image");
            assert_eq!((other.now(), other.scans()), (0, 0), "{name}, scan {k}");
            assert_eq!(canonical(p, &other), image, "{name}, scan {k}: canonical twice");
            let mut one = run.clone();
            states += 1;
            for (j, m) in moves(&mut rng, p, AHEAD).iter().enumerate() {
                let (a, b) = (step(p, &mut one, m, &hidden), step(p, &mut other, m, &hidden));
                assert_eq!(a, b, "{name}, scan {k}, {j} scans later\n{}", text(&name));
                assert_eq!(canonical(p, &one), canonical(p, &other), "{name}, scan {k}, {j} scans later");
                changes += usize::from(!a.cleared.is_empty());
            }
        }
    }
    assert!(
        states > 5_000 && changes > 10_000,
        "{states} states, {changes} scans in which something cleared"
    );
}

fn text(name: &str) -> String {
    let (profile, seed) = name.split_once(" seed ").unwrap_or((name, "1"));
    let profile = ProfileName::ALL.into_iter().find(|p| p.name() == profile).unwrap_or_default();
    sample(seed.parse().unwrap_or(1), profile, 1).map(|s| s.text).unwrap_or_default()
}

/// The same run at another time of day, after other scans, has the same canonical
/// images.
#[test]
fn the_start_of_a_run_is_not_seen() {
    for (name, c) in charts() {
        let p = &c.program;
        let mut rng = Rng::new(7);
        let (mut early, mut late) = (State::new(p), State::new(p));
        let list = moves(&mut rng, p, SCANS);
        let (mut now, shift) = (0, 86_400_000_000_123);
        for (k, m) in list.iter().enumerate() {
            now += m.wait;
            let a = scan(p, &mut early, &m.inputs, now);
            let b = scan(p, &mut late, &m.inputs, now + shift);
            assert_eq!(a, b, "{name}, scan {k}");
            assert_eq!(canonical(p, &early), canonical(p, &late), "{name}, scan {k}");
            assert_ne!(early.image(), late.image(), "{name}, scan {k}");
        }
    }
}

/// Where nothing moves any more and no time is left to wait for, states no longer
/// differ, however long it lasts.
#[test]
fn states_of_a_chart_at_rest_become_one() {
    let (mut rest, mut charts_seen) = (0, 0);
    for (_, c) in charts() {
        let p = &c.program;
        let mut s = State::new(p);
        let inputs = vec![0; (p.tables().inputs.end - p.tables().inputs.start) as usize];
        let mut images = Vec::new();
        for k in 0..30 {
            let Ok(report) = scan(p, &mut s, &inputs, k * 100_000 * MS) else { break };
            if report.cleared == 0 && k > 20 {
                images.push(canonical(p, &s));
            }
        }
        let still = images.len();
        images.dedup();
        charts_seen += usize::from(still > 5);
        rest += usize::from(still > 5 && images.len() == 1);
    }
    println!("{rest} of {charts_seen}");
    // The others count scans in a variable, or read a time without end.
    assert!(rest * 10 > charts_seen * 6, "{rest} of {charts_seen} charts come to rest");
}

/// Whatever the words, restoring them is refused or gives a state that runs.
#[test]
fn no_words_harm_a_state() {
    let (mut taken, mut refused) = (0, 0);
    for (name, c) in charts().step_by(3) {
        let p = &c.program;
        let hidden = hidden(p);
        let mut rng = Rng::new(11);
        let mut run = State::new(p);
        for m in moves(&mut rng, p, 10) {
            step(p, &mut run, &m, &hidden);
        }
        let sound = run.image().to_vec();
        let mut state = run.clone();
        for round in 0..40 {
            let mut words = sound.clone();
            for _ in 0..rng.between(1, 6) {
                let at = rng.below(words.len());
                words[at] = match rng.below(4) {
                    0 => rng.bits(),
                    1 => words[at] ^ (1 << rng.below(64)),
                    2 => u64::MAX,
                    _ => rng.below(5) as u64,
                };
            }
            let before = state.image().to_vec();
            match state.restore(p, &words) {
                Ok(()) => {
                    taken += 1;
                    assert_eq!(state.image(), words, "{name}, round {round}");
                    canonical(p, &state);
                    for m in moves(&mut rng, p, 4) {
                        // From a time that may lie anywhere.
                        let now = state.now().saturating_add(m.wait);
                        scan(p, &mut state, &m.inputs, now).ok();
                        canonical(p, &state);
                    }
                }
                Err(_) => {
                    refused += 1;
                    assert_eq!(
                        state.image(),
                        before,
                        "{name}, round {round}: a refused image changes nothing"
                    );
                }
            }
        }
        for len in [0, 1, sound.len() - 1, sound.len() + 1] {
            let words = vec![0; len];
            assert_eq!(state.restore(p, &words), Err(ImageError::Length), "{name}");
        }
        // A state is whole again after what it was given.
        state.restore(p, &sound).expect("its own image");
        assert!(state == run, "{name}");
        for (j, m) in moves(&mut rng, p, AHEAD).iter().enumerate() {
            assert_eq!(
                step(p, &mut run, m, &hidden),
                step(p, &mut state, m, &hidden),
                "{name}, {j} scans later"
            );
        }
    }
    assert!(taken > 2_000 && refused > 500, "{taken} taken, {refused} refused");
}

/// A state that was left in the middle of a scan is as good as any to restore into.
#[test]
fn a_scan_that_was_broken_off_leaves_nothing_behind() {
    for (name, c) in charts().step_by(2) {
        let p = &c.program;
        let hidden = hidden(p);
        let mut rng = Rng::new(13);
        let mut run = State::new(p);
        let mut used = State::new(p);
        for (k, m) in moves(&mut rng, p, SCANS).iter().enumerate() {
            used.restore(p, run.image()).expect("its own image");
            let now = used.now() + m.wait;
            // As far as it goes: faults are among the ways to break off.
            if begin(p, &mut used, &m.inputs, now).is_ok() && rng.percent(70) {
                pass(p, &mut used).ok();
            }
            used.restore(p, run.image()).expect("its own image");
            assert_eq!(step(p, &mut run, m, &hidden), step(p, &mut used, m, &hidden), "{name}, scan {k}");
            assert!(run == used, "{name}, scan {k}");
        }
    }
}

/// Another program's image is refused, though it may be as long.
#[test]
fn an_image_of_another_program_is_refused() {
    let all: Vec<Compiled> = charts().map(|(_, c)| c).take(60).collect();
    let mut as_long = 0;
    for a in &all {
        for b in all.iter().filter(|b| b.program.tables().code != a.program.tables().code) {
            let (mut s, other) = (State::new(&a.program), State::new(&b.program));
            let same = s.image().len() == other.image().len();
            as_long += usize::from(same);
            let wanted = if same { ImageError::Program } else { ImageError::Length };
            assert_eq!(s.restore(&a.program, other.image()), Err(wanted));
            assert_eq!(s.restore(&b.program, other.image()), Err(wanted), "a state stays with its program");
        }
    }
    assert!(as_long > 0, "no two images were equally long");
}

/// Two scans begin in one state at one time with other inputs: receptivities that
/// read no word in which they differ are true in both or in none.
#[test]
fn a_receptivity_depends_on_what_it_reads() {
    let (mut compared, mut differed) = (0, 0);
    for (name, c) in charts() {
        let p = &c.program;
        let t = p.tables();
        let reads: Vec<_> =
            (0..t.transitions.len() as u32).map(|r| p.reads(Subject::Transition(r))).collect();
        let mut rng = Rng::new(17);
        let mut run = State::new(p);
        for m in moves(&mut rng, p, SCANS) {
            let now = run.now() + m.wait;
            let mut other = m.clone();
            if other.inputs.is_empty() {
                break;
            }
            let at = rng.below(other.inputs.len());
            other.inputs[at] = rng.one([0, 1, 2, 5]);
            let (mut a, mut b) = (run.clone(), run.clone());
            if begin(p, &mut a, &m.inputs, now).is_ok() && begin(p, &mut b, &other.inputs, now).is_ok() {
                let told = |s: &State| {
                    let mut told = Vec::new();
                    enabled(p, s, |rank, holds| told.push((rank, holds))).ok().map(|()| told)
                };
                // PRE may ask for steps, which then give orders.
                let alike = a.active().eq(b.active());
                if let (true, Some(x), Some(y)) = (alike, told(&a), told(&b)) {
                    let differs = |w: &Addr| a.word(*w) != b.word(*w);
                    for ((rank, one), (other, two)) in x.into_iter().zip(y).filter(|(x, y)| x.0 == y.0) {
                        assert_eq!(rank, other);
                        if !reads[rank as usize].words.iter().any(differs) {
                            compared += 1;
                            assert_eq!(one, two, "{name}: transition {rank}\n{}", text(&name));
                        } else if one != two {
                            differed += 1;
                        }
                    }
                }
            }
            if scan(p, &mut run, &m.inputs, now).is_err() {
                break;
            }
        }
    }
    assert!(compared > 10_000 && differed > 500, "{compared} alike, {differed} told apart");
}

/// Whatever wakes a watch is among the words that it reads: what `compile` notes
/// from the expression is found in the code.
#[test]
fn a_watch_reads_the_words_that_wake_it() {
    let mut watches = 0;
    for (name, c) in charts() {
        let (p, t) = (&c.program, c.program.tables());
        for i in 0..t.watches.len() as u32 {
            let reads = p.reads(Subject::Watch(WatchId(i)));
            let wakes = |w: &WatchId| {
                t.word_watches.iter().filter(|(_, by)| by == w).map(|(a, _)| *a).collect::<Vec<_>>()
            };
            let woken: BTreeSet<Addr> = reads.watches.iter().flat_map(wakes).collect();
            // A string that no code writes is as long as its initial value.
            let rest = |a: &&Addr| t.init[a.0 as usize] == 0 && !t.code.iter().any(|op| writes(op, **a));
            let missing: Vec<_> =
                woken.iter().filter(|a| !reads.words.contains(a)).filter(|a| !rest(a)).collect();
            assert!(missing.is_empty(), "{name}: watch {i} is woken by {missing:?}\n{}", text(&name));
            watches += 1;
        }
    }
    assert!(watches > 500, "{watches} watches");
}

/// True if an instruction writes a word of a string.
fn writes(op: &Op, word: Addr) -> bool {
    match *op {
        Op::StoreText { to, cap } | Op::Text { to, cap, .. } | Op::ToText { to, cap, .. } => {
            (to.0..=to.0 + u32::from(cap).div_ceil(8)).contains(&word.0)
        }
        Op::Store(a) => a == word,
        _ => false,
    }
}
