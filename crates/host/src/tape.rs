//! A tape: everything that entered the charts, scan by scan, so that the run can be replayed.

use crate::chunks::Chunks;
use crate::hash::digest;
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

/// The first word of an event: its kind, and above it the address or the number of changed inputs.
const SCAN: u64 = 0;
const WRITE: u64 = 1;
const RESTART: u64 = 2;
const KIND: u32 = 2;

/// The record of everything that entered a program.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    /// The events one behind the other: a scan is its first word, instant, digest, and two words for
    /// each changed input; a write is its first word and the value.
    words: Chunks,
    scans: usize,
    /// The inputs that the latest scan read.
    inputs: Vec<u64>,
    /// A hash of the names of what it is about, which the caller knows; 0 for none.
    of: u64,
}

/// Why a text is no record that can be replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TapeError {
    /// It is something else.
    Other,
    /// It was written by a version of G7 with another form of records.
    Version,
    /// It was cut off behind this line.
    Cut(usize),
    /// This line cannot be read.
    Line(usize),
}

impl std::fmt::Display for TapeError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            TapeError::Other => f.write_str("is not a record of a run"),
            TapeError::Version => f.write_str("is a record of another version of g7"),
            TapeError::Cut(line) => {
                write!(f, "is a record that was cut off: its end is missing behind line {line}")
            }
            TapeError::Line(line) => write!(f, "is a record that is damaged: line {line} cannot be read"),
        }
    }
}

impl std::error::Error for TapeError {}

/// The first scan at which a replay differs from the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Divergence {
    /// The number of the scan, from 0.
    pub scan: usize,
    /// The instant of the scan.
    pub now: Nanos,
}

/// A place on a tape, with the state of the charts there. It goes ahead scan by scan; a copy goes on from
/// its place once more.
#[derive(Clone, Debug)]
pub struct Player {
    /// The place of the next event among the words of the tape.
    at: usize,
    inputs: Vec<u64>,
    state: State,
    scans: usize,
}

impl Player {
    /// The place before all events of a tape.
    pub fn new(program: &Program) -> Player {
        let rows = program.tables().inputs;
        let inputs = vec![0; (rows.end - rows.start) as usize];
        Player { at: 0, inputs, state: State::new(program), scans: 0 }
    }

    /// Carries out what was written from outside before the next scan, and takes the inputs of that scan.
    /// Returns its instant, or `None` where no scan follows. A second call for the same scan changes nothing.
    pub fn prepare(&mut self, tape: &Tape, program: &Program) -> Option<Nanos> {
        loop {
            let mut next = self.at;
            match tape.event(&mut next)? {
                Event::Write(addr, value) => self.state.set_word(program, Addr(addr), value),
                Event::Restart => self.state = State::new(program),
                Event::Scan { now, changed, .. } => {
                    for (i, value) in changed {
                        if let Some(word) = self.inputs.get_mut(i as usize) {
                            *word = value;
                        }
                    }
                    return Some(now);
                }
            }
            self.at = next;
        }
    }

    /// Makes the next scan; does nothing where none follows.
    ///
    /// # Errors
    ///
    /// The state behind it is another one than the recorded one.
    pub fn scan(&mut self, tape: &Tape, program: &Program) -> Result<(), Divergence> {
        let Some(now) = self.prepare(tape, program) else { return Ok(()) };
        // A fault is recorded in the state, so the comparison covers it.
        scan(program, &mut self.state, &self.inputs, now.count()).ok();
        let number = self.scans;
        self.scans += 1;
        match tape.event(&mut self.at) {
            Some(Event::Scan { digest, .. }) if digest == digest_of(&self.state) => Ok(()),
            _ => Err(Divergence { scan: number, now }),
        }
    }

    /// The state of the charts at this place.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The inputs of the scan that was prepared or made last.
    pub fn inputs(&self) -> &[u64] {
        &self.inputs
    }

    /// The number of scans before this place.
    pub fn scans(&self) -> usize {
        self.scans
    }

    /// The instant of the latest scan.
    pub fn now(&self) -> Nanos {
        Nanos::new(self.state.now())
    }
}

const HEAD: &str = "g7 tape 3";
/// The last line of a record, before the number of its scans.
const END: &str = "end ";

impl Tape {
    /// The beginning of a record as text, in every version.
    pub const SIGN: &str = "g7 tape ";

    /// An empty tape, for a program before its first scan.
    pub fn new(program: &Program) -> Tape {
        let rows = program.tables().inputs;
        Tape::of_inputs((rows.end - rows.start) as usize)
    }

    fn of_inputs(count: usize) -> Tape {
        Tape { words: Chunks::new(), scans: 0, inputs: vec![0; count], of: 0 }
    }

    pub(crate) fn write(&mut self, addr: Addr, value: u64) {
        self.words.push(WRITE | u64::from(addr.0) << KIND);
        self.words.push(value);
    }

    pub(crate) fn restart(&mut self) {
        self.words.push(RESTART);
    }

    pub(crate) fn scan(&mut self, now: Nanos, inputs: &[u64], state: &State) {
        let changed = || (0u64..).zip(self.inputs.iter().zip(inputs)).filter(|(_, (old, new))| old != new);
        let words = &mut self.words;
        words.push(SCAN | (changed().count() as u64) << KIND);
        words.push(now.count() as u64);
        words.push(digest_of(state));
        changed().for_each(|(i, (_, new))| {
            words.push(i);
            words.push(*new);
        });
        self.inputs.clear();
        self.inputs.extend_from_slice(inputs);
        self.scans += 1;
    }

    /// Adds an event that was read.
    fn push(&mut self, event: &Event) {
        match event {
            Event::Write(addr, value) => self.write(Addr(*addr), *value),
            Event::Restart => self.restart(),
            Event::Scan { now, changed, digest } => {
                let head = [SCAN | (changed.len() as u64) << KIND, now.count() as u64, *digest];
                head.into_iter().for_each(|word| self.words.push(word));
                for (i, value) in changed {
                    self.words.push(u64::from(*i));
                    self.words.push(*value);
                }
                self.scans += 1;
            }
        }
    }

    fn events(&self) -> impl Iterator<Item = Event> + '_ {
        let mut at = 0;
        std::iter::from_fn(move || self.event(&mut at))
    }

    /// The event at a word; the place is then that of the next one.
    fn event(&self, at: &mut usize) -> Option<Event> {
        let mut next = || {
            let word = self.words.get(*at)?;
            *at += 1;
            Some(word)
        };
        let first = next()?;
        Some(match first & ((1 << KIND) - 1) {
            SCAN => {
                let (now, digest) = (Nanos::new(next()? as i64), next()?);
                let change = |_| Some((next()? as u32, next()?));
                Event::Scan { now, changed: (0..first >> KIND).map_while(change).collect(), digest }
            }
            WRITE => Event::Write((first >> KIND) as u32, next()?),
            _ => Event::Restart,
        })
    }

    fn about(self, of: u64) -> Tape {
        Tape { of, ..self }
    }

    /// The hash of what it is about: a record of another chart has another one.
    pub fn of(&self) -> u64 {
        self.of
    }

    /// The number of scans.
    pub fn scans(&self) -> usize {
        self.scans
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
        let mut player = Player::new(program);
        while player.prepare(self, program).is_some() {
            player.scan(self, program)?;
            seen(player.now(), player.state());
        }
        // The writes behind the last scan are in the state already.
        Ok(player.state)
    }

    /// The tape as text, one event per line.
    pub fn to_text(&self) -> String {
        self.text_about(self.of)
    }

    /// The same with a hash of what it is about.
    pub fn text_about(&self, of: u64) -> String {
        let mut out = format!("{HEAD} {} {:x}\n", self.inputs.len(), of);
        for event in self.events() {
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
        out.push_str(&format!("{END}{}\n", self.scans));
        out
    }

    /// Reads the text that [`Tape::to_text`] writes.
    ///
    /// # Errors
    ///
    /// It is not such a text, or not all of it.
    pub fn from_text(text: &str) -> Result<Tape, TapeError> {
        let mut lines = (1..).zip(text.lines());
        let first = lines.next().map_or("", |(_, line)| line);
        if !first.starts_with(Tape::SIGN) {
            return Err(TapeError::Other);
        }
        let head = first.strip_prefix(HEAD).ok_or(TapeError::Version)?;
        let mut tape = head_of(head).ok_or(TapeError::Line(1))?;
        let mut read = 1;
        for (number, line) in lines {
            read = number;
            if let Some(scans) = line.strip_prefix(END) {
                let whole = scans.parse() == Ok(tape.scans) && text.ends_with('\n');
                return if whole { Ok(tape) } else { Err(TapeError::Line(number)) };
            }
            match event_of(line) {
                Some(event) => tape.push(&event),
                // The last line of a file that was cut off is seldom whole.
                None if text.lines().count() == number => return Err(TapeError::Cut(number - 1)),
                None => return Err(TapeError::Line(number)),
            }
        }
        Err(TapeError::Cut(read))
    }
}

/// The empty tape of a first line, without its version.
fn head_of(text: &str) -> Option<Tape> {
    let (inputs, of) = text.trim().split_once(' ')?;
    let inputs: usize = inputs.parse().ok()?;
    let of = u64::from_str_radix(of, 16).ok()?;
    (inputs <= 1_000_000).then(|| Tape::of_inputs(inputs).about(of))
}

fn event_of(line: &str) -> Option<Event> {
    let hex = |w: &str| u64::from_str_radix(w, 16).ok();
    let mut words = line.split(' ');
    Some(match words.next()? {
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
    })
}

/// A digest of the memory of a state. The first word of the image is left out: it differs between
/// programs, and a recording is also replayed on a chart that was changed.
fn digest_of(state: &State) -> u64 {
    digest(state.image().get(1..).unwrap_or(&[]))
}
