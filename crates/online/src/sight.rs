//! A controller as others see it: from time to time all of its words, for a reader that never holds it
//! up.
//!
//! ```text
//! time, begun, missed, lost | forces | inputs | words of each device | image of the charts | of the plant
//! ```
//!
//! The controller puts the words of one step as a whole into an exchange, where the reader finds the
//! latest ones.

use g7_engine::{Addr, Program, State};
use g7_host::{Force, Runner};
use g7_model::Nanos;

use crate::driver::{Quality, Said, from_device};
use crate::exchange::{Reader, Writer, exchange};
use crate::forces::{FORCES, Forced};

/// The time between two hand-overs.
const EACH: Nanos = Nanos::from_millis(40);
/// The words in front of all others, and those of a force.
const HEAD: usize = 5;
const FORCE: usize = 4;

/// The controller's side.
#[derive(Debug)]
pub(crate) struct Showing {
    writer: Writer,
    due: Nanos,
}

/// The facts of a controller that are no words of its run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facts<'a> {
    pub(crate) now: Nanos,
    /// The charts give the outputs: it runs and has made a scan.
    pub(crate) drives: bool,
    pub(crate) missed: u64,
    pub(crate) lost: u64,
    pub(crate) forces: &'a [Forced],
}

impl Showing {
    /// Hands the words on, if it is time for it.
    pub(crate) fn put<'a>(
        &mut self,
        facts: Facts<'_>,
        runner: &Runner,
        ports: impl Iterator<Item = &'a [u64]>,
    ) {
        let Facts { now, drives, missed, lost, forces } = facts;
        if now < self.due {
            return;
        }
        self.due = now + EACH;
        let head = [now.count() as u64, u64::from(drives), missed, lost, forces.len() as u64];
        let force = |k: usize| forces.get(k).map_or([0; FORCE], force_words);
        let tables = runner.program().tables();
        let inputs = tables.inputs.end.saturating_sub(tables.inputs.start);
        let words = head
            .into_iter()
            .chain((0..FORCES).flat_map(force))
            .chain((0..inputs).map(|index| runner.input(index)))
            .chain(ports.flat_map(|words| words.iter().copied()))
            .chain(runner.state().image().iter().copied())
            .chain(runner.plant().into_iter().flat_map(|(_, state)| state.image().iter().copied()));
        self.writer.put(words);
    }
}

fn force_words(force: &Forced) -> [u64; FORCE] {
    let (kind, number) = match force.what {
        Force::Input(index) => (0, index),
        Force::Output(addr) => (1, addr.0),
        Force::Variable(addr) => (2, addr.0),
    };
    [kind, u64::from(number), force.word, force.until.count() as u64]
}

fn force_of([kind, number, word, until]: [u64; FORCE]) -> Forced {
    let number = number as u32;
    let what = match kind {
        0 => Force::Input(number),
        1 => Force::Output(Addr(number)),
        _ => Force::Variable(Addr(number)),
    };
    Forced { what, word, until: Nanos::new(until as i64) }
}

/// A device in a [`Sight`]: the place of its words, and the age at which they are too old.
#[derive(Clone, Copy, Debug)]
struct At {
    first: usize,
    words: usize,
    stale: Nanos,
}

/// The reader's side.
#[derive(Debug)]
pub struct Sight {
    reader: Reader,
    words: Vec<u64>,
    program: Program,
    state: State,
    devices: Vec<At>,
    inputs: usize,
    image: usize,
    /// The simulated plant, and the place of its image.
    plant: Option<(Program, State, usize)>,
}

/// Both sides for a controller whose devices have so many inputs, and values that are too old after such a
/// time.
pub(crate) fn sight(runner: &Runner, ports: impl Iterator<Item = (usize, Nanos)>) -> (Showing, Sight) {
    let program = runner.program().clone();
    let state = State::new(&program);
    let tables = program.tables();
    let inputs = HEAD + FORCES * FORCE;
    let mut next = inputs + tables.inputs.end.saturating_sub(tables.inputs.start) as usize;
    let mut devices = Vec::new();
    for (inputs, stale) in ports {
        let at = At { first: next, words: from_device::words(inputs), stale };
        next += at.words;
        devices.push(at);
    }
    let after = next + state.image().len();
    let plant = runner.plant().map(|(program, _)| (program.clone(), State::new(program), after));
    let count = after + plant.as_ref().map_or(0, |(_, state, _)| state.image().len());
    let (writer, reader) = exchange(count);
    let showing = Showing { writer, due: Nanos::ZERO };
    (showing, Sight { reader, words: vec![0; count], program, state, devices, inputs, image: next, plant })
}

impl Sight {
    /// Takes what the controller showed last; false where it has shown nothing since the last call.
    pub fn look(&mut self) -> bool {
        if !self.reader.take(&mut self.words) {
            return false;
        }
        if let Some((program, state, from)) = &mut self.plant {
            let image = self.words.get(*from..).unwrap_or(&[]);
            // The words are those of a state of this program; the picture of a plant may lag behind.
            state.restore(program, image).ok();
        }
        let end = self.plant.as_ref().map_or(self.words.len(), |(.., from)| *from);
        let image = self.words.get(self.image..end).unwrap_or(&[]);
        self.state.restore(&self.program, image).is_ok()
    }

    /// The program and the state of the simulated plant, for evaluating expressions; `None` where there
    /// is none.
    pub fn plant_mut(&mut self) -> Option<(&Program, &mut State)> {
        self.plant.as_mut().map(|(program, state, _)| (&*program, state))
    }

    fn word(&self, at: usize) -> u64 {
        self.words.get(at).copied().unwrap_or(0)
    }

    /// The time of the controller.
    pub fn now(&self) -> Nanos {
        Nanos::new(self.word(0) as i64)
    }

    /// True while the charts give the outputs; else these are safe.
    pub fn drives(&self) -> bool {
        self.word(1) != 0
    }

    /// The scans that came too late and were left out.
    pub fn missed(&self) -> u64 {
        self.word(2)
    }

    /// The events that nobody took in time.
    pub fn lost(&self) -> u64 {
        self.word(3)
    }

    /// The program of the charts.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The state of the charts.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The input word that the next scan reads, counted from the first.
    pub fn input(&self, index: u32) -> u64 {
        self.word(self.inputs + index as usize)
    }

    /// The forced values, in the order in which they were begun.
    pub fn forces(&self) -> impl Iterator<Item = Forced> + '_ {
        let count = (self.word(4) as usize).min(FORCES);
        (0..count).map(|k| {
            let first = HEAD + k * FORCE;
            force_of([self.word(first), self.word(first + 1), self.word(first + 2), self.word(first + 3)])
        })
    }

    fn said(&self, device: usize) -> Option<Said<'_>> {
        let At { first, words, stale } = *self.devices.get(device)?;
        Some(Said::new(self.words.get(first..first + words)?, self.now(), stale))
    }

    /// True while a device answers.
    pub fn is_up(&self, device: usize) -> bool {
        self.said(device).is_some_and(|said| said.is_up())
    }

    /// The quality of an input of a device, by number.
    pub fn quality(&self, device: usize, input: usize) -> Quality {
        self.said(device).map_or(Quality::Unread, |said| said.input(input).1)
    }
}
