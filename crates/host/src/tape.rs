//! What went into the charts, scan by scan, to be played again.

use g7_engine::{Addr, Program, State, scan};

/// One thing that happened.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Event {
    /// A scan at an instant, the inputs that changed, and a digest of the state it left.
    Scan { now: i64, changed: Vec<(u32, u64)>, digest: u64 },
    /// A variable was written from outside.
    Write(u32, u64),
    /// The charts were started anew.
    Restart,
}

/// A record of everything that entered a program.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    events: Vec<Event>,
    /// As the latest scan read them.
    inputs: Vec<u64>,
}

/// Where a replay left the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Divergence {
    /// Number of the scan, from 0.
    pub scan: usize,
    /// Its instant.
    pub now: i64,
}

const HEAD: &str = "g7 tape 1";

impl Tape {
    /// A tape before the first scan of a program.
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

    pub(crate) fn scan(&mut self, now: i64, inputs: &[u64], state: &State) {
        let changed = (0u32..)
            .zip(self.inputs.iter().zip(inputs))
            .filter(|(_, (before, value))| before != value)
            .map(|(i, (_, value))| (i, *value))
            .collect();
        self.inputs = inputs.to_vec();
        self.events.push(Event::Scan { now, changed, digest: digest(state) });
    }

    /// Number of scans.
    pub fn scans(&self) -> usize {
        self.events.iter().filter(|e| matches!(e, Event::Scan { .. })).count()
    }

    /// Plays it; every state must be the recorded one. `seen` gets each state.
    ///
    /// # Errors
    ///
    /// The first scan whose state differs.
    pub fn replay(&self, program: &Program, mut seen: impl FnMut(i64, &State)) -> Result<State, Divergence> {
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
                    // A fault is part of the record: it stands in the state.
                    scan(program, &mut state, &inputs, *now).ok();
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

    /// The tape as text, one event a line.
    pub fn to_text(&self) -> String {
        let mut out = format!("{HEAD} {}\n", self.inputs.len());
        for event in &self.events {
            match event {
                Event::Write(addr, value) => out.push_str(&format!("w {addr} {value:x}\n")),
                Event::Restart => out.push_str("r\n"),
                Event::Scan { now, changed, digest } => {
                    out.push_str(&format!("s {now} {digest:x}"));
                    for (i, value) in changed {
                        out.push_str(&format!(" {i}={value:x}"));
                    }
                    out.push('\n');
                }
            }
        }
        out
    }

    /// Reads [`Tape::to_text`]; `None` where it is none.
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
                    let (now, digest) = (words.next()?.parse().ok()?, hex(words.next()?)?);
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

/// FNV-1a over the words of the image: tells two runs apart, proves nothing.
fn digest(state: &State) -> u64 {
    state.image().iter().fold(0xcbf2_9ce4_8422_2325, |hash: u64, w| {
        (hash ^ w).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23)
    })
}
