//! A tape: everything that entered the charts, scan by scan, so that the run can be replayed.

use crate::hash::Fnv;
use g7_engine::{Addr, Program, State, scan};
use g7_model::Nanos;

/// One event of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Event {
    /// A scan: its instant, the inputs that changed, and a digest of the state after it.
    Scan { now: Nanos, changed: Vec<(u32, u64)>, digest: u64 },
    /// A variable was written from outside.
    Write(u32, u64),
    /// The charts were restarted.
    Restart,
}

/// The record of everything that entered a program.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    events: Vec<Event>,
    /// The inputs that the latest scan read.
    inputs: Vec<u64>,
}

/// The first scan at which a replay differs from the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Divergence {
    /// The number of the scan, from 0.
    pub scan: usize,
    /// The instant of the scan.
    pub now: Nanos,
}

const HEAD: &str = "g7 tape 1";

impl Tape {
    /// An empty tape, for a program before its first scan.
    pub fn new(program: &Program) -> Tape {
        let rows = program.tables().inputs;
        Tape { events: Vec::new(), inputs: vec![0; (rows.end - rows.start) as usize] }
    }

    pub(crate) fn write(&mut self, addr: Addr, value: u64) {
        self.events.push(Event::Write(addr.0, value));
    }

    pub(crate) fn restart(&mut self) {
        self.events.push(Event::Restart);
    }

    pub(crate) fn scan(&mut self, now: Nanos, inputs: &[u64], state: &State) {
        let changed = (0u32..)
            .zip(self.inputs.iter().zip(inputs))
            .filter(|(_, (before, value))| before != value)
            .map(|(i, (_, value))| (i, *value))
            .collect();
        self.inputs = inputs.to_vec();
        self.events.push(Event::Scan { now, changed, digest: digest(state) });
    }

    /// The number of scans.
    pub fn scans(&self) -> usize {
        self.events.iter().filter(|e| matches!(e, Event::Scan { .. })).count()
    }

    /// Replays the tape and compares every state with the recorded one; `seen` is called with each
    /// state.
    ///
    /// # Errors
    ///
    /// The first scan whose state differs.
    pub fn replay(
        &self,
        program: &Program,
        mut seen: impl FnMut(Nanos, &State),
    ) -> Result<State, Divergence> {
        let mut state = State::new(program);
        let rows = program.tables().inputs;
        let mut inputs = vec![0; (rows.end - rows.start) as usize];
        let mut number = 0;
        for event in &self.events {
            match event {
                Event::Write(addr, value) => state.set_word(program, Addr(*addr), *value),
                Event::Restart => state = State::new(program),
                Event::Scan { now, changed, digest: expected } => {
                    for (i, value) in changed {
                        if let Some(word) = inputs.get_mut(*i as usize) {
                            *word = *value;
                        }
                    }
                    // A fault is recorded in the state, so the comparison covers it.
                    scan(program, &mut state, &inputs, now.count()).ok();
                    if digest(&state) != *expected {
                        return Err(Divergence { scan: number, now: *now });
                    }
                    seen(*now, &state);
                    number += 1;
                }
            }
        }
        Ok(state)
    }

    /// The tape as text, one event per line.
    pub fn to_text(&self) -> String {
        let mut out = format!("{HEAD} {}\n", self.inputs.len());
        for event in &self.events {
            match event {
                Event::Write(addr, value) => out.push_str(&format!("w {addr} {value:x}\n")),
                Event::Restart => out.push_str("r\n"),
                Event::Scan { now, changed, digest } => {
                    out.push_str(&format!("s {} {digest:x}", now.count()));
                    for (i, value) in changed {
                        out.push_str(&format!(" {i}={value:x}"));
                    }
                    out.push('\n');
                }
            }
        }
        out
    }

    /// Reads the text that [`Tape::to_text`] writes; `None` if it is not such a text.
    pub fn from_text(text: &str) -> Option<Tape> {
        let mut lines = text.lines();
        let inputs: usize = lines.next()?.strip_prefix(HEAD)?.trim().parse().ok()?;
        if inputs > 1_000_000 {
            return None;
        }
        let hex = |w: &str| u64::from_str_radix(w, 16).ok();
        let mut tape = Tape { events: Vec::new(), inputs: vec![0; inputs] };
        for line in lines {
            let mut words = line.split(' ');
            let event = match words.next()? {
                "w" => Event::Write(words.next()?.parse().ok()?, hex(words.next()?)?),
                "r" => Event::Restart,
                "s" => {
                    let now = Nanos::new(words.next()?.parse().ok()?);
                    let digest = hex(words.next()?)?;
                    let change = |w: &str| {
                        let (i, value) = w.split_once('=')?;
                        Some((i.parse().ok()?, hex(value)?))
                    };
                    Event::Scan { now, changed: words.map(change).collect::<Option<_>>()?, digest }
                }
                _ => return None,
            };
            tape.events.push(event);
        }
        Some(tape)
    }
}

/// A hash of the memory of a state. It tells two runs apart but does not prove them
/// equal. The first word of the image is left out: it differs between programs, and
/// a recording is also replayed on a chart that was changed.
fn digest(state: &State) -> u64 {
    let mut hash = Fnv::default();
    state.image().iter().skip(1).for_each(|word| hash.add(&word.to_le_bytes()));
    hash.value()
}
