//! Several workers give the answers of one thread: the same verdicts, runs, and numbers of states and scans.
#![allow(missing_docs, reason = "a test")]

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

use g7_hosts::{Error, Exchange, Near, answer_over};
use g7_model::{Document, ProfileName};
use g7_tests::generate::sample;
use g7_verify::{Asked, Budget, Evidence, Expander, Model, Question, Tried, Verdict, ask, watch};

/// Most states of a search. One that has more is left out: it ends at another place.
const STATES: usize = 400;
/// Most combinations of inputs of a random chart.
const WIDE: usize = 64;

fn budget(states: usize) -> Budget<'static> {
    Budget { states, scans: usize::MAX, bytes: 256 << 20, stop: &|| false }
}

/// A folder that goes with its owner.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Folder {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let name = format!("g7-hosts-{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
        Folder(std::env::temp_dir().join(name))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = std::fs::remove_dir_all(&self.0);
    }
}

type Answers = Result<Vec<(usize, Verdict)>, Error>;

/// The answers that each of the workers at these ends gives.
fn by<E: Exchange + Send>(asked: &Asked, ends: Vec<E>, folder: &Folder, states: usize) -> Vec<Answers> {
    let one = |mut end: E| {
        let model = Model::new(&asked.compiled, asked.assume.clone());
        answer_over(&model, &asked.questions, &budget(states), Some(Tried::Matter), &mut end, &folder.0)
    };
    std::thread::scope(|scope| {
        let all: Vec<_> = ends.into_iter().map(|end| scope.spawn(move || one(end))).collect();
        all.into_iter().map(|t| t.join().expect("no worker panics")).collect()
    })
}

/// The answers of one thread, in the order of the questions. Each question that remembers something has a
/// search of its own.
fn alone(asked: &Asked, states: usize) -> Vec<Verdict> {
    let model = Model::new(&asked.compiled, asked.assume.clone());
    let rows = || asked.questions.iter().enumerate();
    let (alone, together): (Vec<_>, Vec<_>) = rows().partition(|(_, q)| Expander::remembers(q));
    let groups = std::iter::once(together).chain(alone.into_iter().map(|q| vec![q]));
    let mut answers = vec![None; asked.questions.len()];
    for group in groups {
        let questions: Vec<Question> = group.iter().map(|(_, q)| (*q).clone()).collect();
        for (k, verdict) in watch(&model, &questions, &budget(states), Tried::Matter, &mut |_, _| {}) {
            answers[group[k].0] = Some(verdict);
        }
    }
    answers.into_iter().map(|a| a.expect("each question has an answer")).collect()
}

/// True for a search that a bound has ended.
fn is_bounded(v: &Verdict) -> bool {
    matches!(v, Verdict::Open(open) if open.reason.is_of_budget())
}

#[track_caller]
fn equal(expected: &[Verdict], found: Answers, at: &str) {
    let mut found = found.unwrap_or_else(|e| panic!("{e}: {at}"));
    found.sort_by_key(|(i, _)| *i);
    assert_eq!(found.len(), expected.len(), "{at}");
    for ((_, found), expected) in found.iter().zip(expected) {
        match (found, expected) {
            // How far a search had come when a condition was found to be unclear is another thing.
            (Verdict::Open(a), Verdict::Open(b)) => assert_eq!(a.reason, b.reason, "{at}"),
            _ => assert_eq!(found, expected, "{at}"),
        }
    }
}

/// Asks 1, 2 and 3 workers; gives the number of answers, of runs among them, and of states.
fn same(document: &Document, at: &str) -> (usize, usize, usize) {
    let Some(asked) = ask(document, None).0 else { return (0, 0, 0) };
    let inputs = Model::new(&asked.compiled, Vec::new()).inputs;
    if inputs.iter().fold(1usize, |n, v| n.saturating_mul(v.tried.len().max(1))) > WIDE {
        return (0, 0, 0);
    }
    let expected = alone(&asked, STATES);
    if expected.iter().any(is_bounded) {
        return (0, 0, 0);
    }
    for workers in 1..=3 {
        let folder = Folder::new();
        for found in by(&asked, Near::net(workers), &folder, STATES) {
            equal(&expected, found, &format!("{workers} workers: {at}"));
        }
    }
    let is_run =
        |v: &&Verdict| matches!(v, Verdict::Proved(Evidence::Run(_)) | Verdict::Refuted(Evidence::Run(_)));
    let states = |v: &Verdict| match v {
        Verdict::Proved(Evidence::Certificate(g7_verify::Certificate::Search { states, .. }))
        | Verdict::Refuted(Evidence::Certificate(g7_verify::Certificate::Search { states, .. })) => *states,
        _ => 0,
    };
    let most = expected.iter().map(states).max().unwrap_or(0);
    (expected.len(), expected.iter().filter(is_run).count(), most)
}

#[test]
fn random_charts() {
    let (mut answers, mut runs, mut states) = (0, 0, 0);
    // Which charts of the generator can be searched whole is chance: more are made until enough is compared.
    for seed in 1..=75 {
        if seed > 25 && answers > 600 && runs > 250 && states > 2000 {
            break;
        }
        for profile in ProfileName::ALL {
            let sample = sample(seed, profile, 1).expect("a random chart can be read");
            let (a, r, s) =
                same(&sample.document, &format!("{} seed {seed}\n{}", profile.name(), sample.text));
            (answers, runs, states) = (answers + a, runs + r, states + s);
        }
    }
    println!("{answers} answers, {runs} runs, {states} states");
    assert!(answers > 600 && runs > 250 && states > 2000, "{answers} {runs} {states}");
}

fn document(text: &str) -> Document {
    let (document, problems) = g7_syntax::parse(text, Default::default());
    assert!(problems.is_empty(), "{problems:?}");
    document
}

/// Cells that run side by side, each step with its own input, and two cells share a resource.
fn cells(count: usize, profile: &str) -> String {
    let inputs = |c| format!("a{c}, b{c}, c{c}");
    let all: Vec<String> = (0..count).map(inputs).collect();
    let mut text = format!("profile {profile}\ninput {} : BOOL\noutput q : BOOL\n", all.join(", "));
    for c in 0..count {
        let other = c ^ 1;
        text.push_str(&format!(
            "chart C{c} {{\n  initial step 1\n  step 2\n  step 3 {{ N q }}\n  \
             1 -> 2 when a{c}\n  2 -> 3 when b{c} and not C{other}.X3\n  3 -> 1 when c{c}\n}}\n"
        ));
    }
    text
}

#[test]
fn charts_with_all_forms_of_claims() {
    let claims = "prove never C0.X3 and C1.X3\n\
        prove reachable C0.X3 and C1.X2\nprove after C0.X2 until C0.X3 expect not C0.X1\n\
        prove between C0.X2 and C0.X3 never C0.X1\nprove C0.X2 leads to C0.X3\nprove C0.X1 leads to C1.X3\n\
        prove after a0 within 30ms expect C0.X2\nprove at most 1 of (C0.X2, C1.X2)\n";
    for profile in ["iec60848", "iec61131"] {
        let (answers, runs, states) = same(&document(&(cells(2, profile) + claims)), profile);
        assert!(answers > 20 && runs > 8 && states > 8, "{profile}: {answers} {runs} {states}");
    }
    // A state that nothing leaves, found by going back from the good ones.
    let stuck = "profile iec61131\ninput a, b : BOOL\nchart G {\n  initial step 1\n  step 2\n  step 3\n  step 4\n\
        1 -> 2 when a\n  2 -> 1 when b and not a\n  1 -> 3 when b\n  3 -> 4 when false\n}\n\
        prove X2 leads to X1\nprove X1 leads to X4\nassume not (a and b)\n";
    let (answers, ..) = same(&document(stuck), "a deadlock");
    assert!(answers > 8, "{answers}");
    // Without an input that satisfies the assumptions there are no runs.
    let none = "profile iec61131\ninput a : BOOL\nchart G {\n  initial step 1\n  step 2\n  1 -> 2 when a\n\
        2 -> 1 when not a\n}\nassume not X2 or (a and not a)\nprove never X2\n";
    assert!(same(&document(none), "stuck").0 > 3);
}

/// An end that is lost behind so many packets.
struct Frail {
    end: Option<Near>,
    me: usize,
    peers: usize,
    left: usize,
}

impl Exchange for Frail {
    fn me(&self) -> usize {
        self.me
    }

    fn peers(&self) -> usize {
        self.peers
    }

    fn send(&mut self, to: usize, packet: Vec<u64>) {
        if self.left == 0 {
            self.end = None;
        }
        self.left = self.left.saturating_sub(1);
        self.end.iter_mut().for_each(|end| end.send(to, packet.clone()));
    }

    fn receive(&mut self, wait: bool) -> Option<(usize, Vec<u64>)> {
        self.end.as_mut().and_then(|end| end.receive(wait))
    }

    fn is_gone(&self, peer: usize) -> bool {
        self.end.as_ref().is_none_or(|end| end.is_gone(peer))
    }
}

#[test]
fn a_worker_that_is_lost_costs_no_more_than_a_level() {
    let text = cells(4, "iec61131")
        + "prove never C0.X3 and C1.X3\nprove reachable C0.X3 and C2.X3 and not C3.X1\n\
        prove C0.X2 leads to C0.X3\n";
    let asked = ask(&document(&text), None).0.expect("it compiles");
    let expected = alone(&asked, STATES);
    let (mut left, mut lost) = (1, 0);
    loop {
        let folder = Folder::new();
        let frail = |end: Near| {
            let (me, peers) = (end.me(), end.peers());
            Frail { end: Some(end), me, peers, left: if me == 1 { left } else { usize::MAX } }
        };
        let first = by(&asked, Near::net(3).into_iter().map(frail).collect(), &folder, STATES);
        let is_lost = first.iter().any(|a| matches!(a, Err(Error::Lost)));
        for found in first.into_iter().filter(|a| *a != Err(Error::Lost)) {
            equal(&expected, found, "before the loss");
        }
        if !is_lost {
            break;
        }
        lost += 1;
        let again = by(&asked, Near::net(3), &folder, STATES);
        equal(&expected, again.into_iter().next().expect("a worker"), &format!("{left} packets"));
        left += 4;
    }
    assert!(lost > 20, "lost {lost} times");
}

/// An end that has all packets of a phase of the second worker, and those of its next phase, before it sees the
/// end of the phase of the third. So packets come early in each phase.
struct Hasty {
    end: Near,
    /// Packets of the third worker that are held back.
    held: std::collections::VecDeque<Vec<u64>>,
    /// Phases that the second and the third have ended, as this end has seen it.
    ended: [usize; 2],
    /// Packets of the second that came before their phase.
    early: usize,
    /// Calls in a row that have waited for nothing.
    idle: usize,
}

/// The first word of the packet that ends a phase.
const END: u64 = 1;
/// Waits in vain, 50 ms each, before the others count as gone.
const PATIENCE: usize = 400;

impl Hasty {
    fn is_held(&self, packet: &[u64]) -> bool {
        packet.first() == Some(&END) && self.ended[0] < self.ended[1] + 2 && !self.end.is_gone(1)
    }
}

impl Exchange for Hasty {
    fn me(&self) -> usize {
        self.end.me()
    }

    fn peers(&self) -> usize {
        self.end.peers()
    }

    fn send(&mut self, to: usize, packet: Vec<u64>) {
        self.end.send(to, packet);
    }

    fn receive(&mut self, wait: bool) -> Option<(usize, Vec<u64>)> {
        if self.me() != 0 {
            return self.end.receive(wait);
        }
        if self.held.front().is_none_or(|p| self.is_held(p)) {
            match self.end.receive(wait) {
                Some((2, packet)) => self.held.push_back(packet),
                Some((from, packet)) => {
                    self.idle = 0;
                    self.early += usize::from(self.ended[0] > self.ended[1]);
                    self.ended[0] += usize::from(packet.first() == Some(&END));
                    return Some((from, packet));
                }
                None => self.idle += usize::from(wait),
            }
        }
        let packet = self.held.front().filter(|p| !self.is_held(p)).cloned()?;
        self.held.pop_front();
        self.idle = 0;
        self.ended[1] += usize::from(packet.first() == Some(&END));
        Some((2, packet))
    }

    fn is_gone(&self, peer: usize) -> bool {
        self.idle > PATIENCE || self.held.is_empty() && self.end.is_gone(peer)
    }
}

impl Drop for Hasty {
    fn drop(&mut self) {
        // Each phase but the last one begins with the packet by which the second ends it.
        let phases = self.ended[1];
        assert!(self.me() != 0 || std::thread::panicking() || self.early + 2 > phases && phases > 20);
    }
}

/// A worker that goes on to the next search sends packets of it while another one still waits for the end of the
/// search before: they count there.
#[test]
fn a_packet_that_comes_a_phase_early_is_not_lost() {
    let claims = "prove never C0.X3 and C1.X3\nprove C0.X2 leads to C0.X3\nprove C0.X1 leads to C1.X3\n\
        prove after C0.X2 until C0.X3 expect not C0.X1\n";
    let asked = ask(&document(&(cells(2, "iec61131") + claims)), None).0.expect("it compiles");
    let expected = alone(&asked, STATES);
    let folder = Folder::new();
    let hasty = |end: Near| Hasty { end, held: Default::default(), ended: [0, 0], early: 0, idle: 0 };
    for found in by(&asked, Near::net(3).into_iter().map(hasty).collect(), &folder, STATES) {
        equal(&expected, found, "packets come early");
    }
}
