//! One device at work: its link, its values as words, and the exchange with the scan.
//!
//! A driver is called at its instants by a thread of its own, or by a simulator. What it does is cut in
//! two so that a simulator can let time pass between: [`Driver::work`] talks to the device,
//! [`Driver::settle`] publishes what came of it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use g7_model::Nanos;

use crate::device::{Absent, Device, Failed, Remark};
use crate::exchange::{Reader, Writer};
use crate::link::{Link, Order};
use crate::setup::Timing;
use crate::value::{Raw, Scaling};

/// The state of a channel, as a word of the exchange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// It has not been read since the start.
    Unread,
    /// The value is that of the device.
    Good,
    /// The device does not answer, or gave no value that the variable can hold.
    Bad,
}

impl Quality {
    pub(crate) fn word(self) -> u64 {
        match self {
            Quality::Unread => 0,
            Quality::Good => 1,
            Quality::Bad => 2,
        }
    }

    pub(crate) fn of(word: u64) -> Quality {
        match word {
            0 => Quality::Unread,
            1 => Quality::Good,
            _ => Quality::Bad,
        }
    }
}

/// The words that a driver gives to the scan: the instant of the latest exchange, whether the device
/// answers, then value and quality of each input.
pub(crate) mod from_device {
    pub(crate) const STAMP: usize = 0;
    pub(crate) const UP: usize = 1;
    pub(crate) const INPUTS: usize = 2;

    pub(crate) fn words(inputs: usize) -> usize {
        INPUTS + 2 * inputs
    }
}

/// The words of a device, judged at an instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Said<'a> {
    words: &'a [u64],
    /// Nothing counts that is older.
    fresh: bool,
}

impl<'a> Said<'a> {
    pub(crate) fn new(words: &'a [u64], now: Nanos, stale: Nanos) -> Said<'a> {
        let said = Said { words, fresh: true };
        Said { fresh: now - Nanos::new(said.word(from_device::STAMP) as i64) <= stale, ..said }
    }

    fn word(&self, at: usize) -> u64 {
        self.words.get(at).copied().unwrap_or(0)
    }

    /// True while the device answers.
    pub(crate) fn is_up(&self) -> bool {
        self.fresh && self.word(from_device::UP) != 0
    }

    /// The value and the quality of an input, by number.
    pub(crate) fn input(&self, number: usize) -> (u64, Quality) {
        let at = from_device::INPUTS + 2 * number;
        let quality = match Quality::of(self.word(at + 1)) {
            Quality::Good if !self.fresh => Quality::Bad,
            said => said,
        };
        (self.word(at), quality)
    }
}

/// An output of a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Out {
    /// How its word becomes a value.
    pub scaling: Scaling,
    /// The word that it has while the controller does not run; `None` for what is only shown, which
    /// keeps its word.
    pub safe: Option<u64>,
}

impl Out {
    /// The word that the device gets for the one of the scan.
    fn word(&self, wanted: u64, safe: bool) -> u64 {
        self.safe.filter(|_| safe).unwrap_or(wanted)
    }
}

/// Something that happened at a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Happened {
    /// It answers.
    Up,
    /// It cannot be reached, or does not answer any more.
    Down(Failed),
    /// An input, by number, has no value.
    NoInput(usize, String),
    /// An input, by number, has a value again.
    Input(usize),
    /// An output, by number, was refused.
    NoOutput(usize, String),
    /// An output, by number, is written again.
    Output(usize),
    /// The value of an output was limited to what its point can hold.
    Limited(usize),
    /// Something that the device tells.
    Note(String),
    /// An input, by number, was given this word by a client; and by which user, where there are users.
    Written(usize, u64, Option<String>),
}

/// The result of one order.
#[derive(Debug)]
pub struct Worked {
    order: Order,
    result: Result<(), Failed>,
}

/// One device at work.
pub struct Driver {
    device: Box<dyn Device>,
    link: Link,
    timing: Timing,
    inputs: Vec<Scaling>,
    outputs: Vec<Out>,
    from_scan: Reader,
    to_scan: Writer,
    /// True while outputs have to be safe whatever the scan says.
    safe: Arc<AtomicBool>,
    /// The words of the scan for the outputs; safe ones before the first scan.
    wanted: Vec<u64>,
    /// The value that each output was given last; `None` where that is not known.
    written: Vec<Option<Raw>>,
    raws: Vec<Raw>,
    write: Vec<bool>,
    limited: Vec<bool>,
    read: Vec<Result<Raw, Absent>>,
    refused: Vec<Option<String>>,
    /// The state of each input and output that was told last: false after a refusal.
    told_inputs: Vec<bool>,
    told_outputs: Vec<bool>,
    told_up: Option<bool>,
    refreshed: Nanos,
    values: Vec<(u64, Quality)>,
}

impl Driver {
    /// A driver of a device that has these inputs and outputs.
    pub fn new(
        device: Box<dyn Device>,
        timing: Timing,
        inputs: Vec<Scaling>,
        outputs: Vec<Out>,
        (from_scan, to_scan): (Reader, Writer),
        safe: Arc<AtomicBool>,
    ) -> Driver {
        let (m, n) = (inputs.len(), outputs.len());
        Driver {
            device,
            link: Link::new(timing),
            timing,
            wanted: outputs.iter().map(|o| o.safe.unwrap_or(0)).collect(),
            written: vec![None; n],
            raws: outputs.iter().map(|o| o.scaling.raw(o.safe.unwrap_or(0)).0).collect(),
            write: vec![false; n],
            limited: vec![false; n],
            read: vec![Err(Absent::Unread); m],
            refused: vec![None; n],
            told_inputs: vec![true; m],
            told_outputs: vec![true; n],
            told_up: None,
            refreshed: Nanos::ZERO,
            values: vec![(0, Quality::Unread); m],
            inputs,
            outputs,
            from_scan,
            to_scan,
            safe,
        }
    }

    /// The instant of the next order.
    pub fn due(&self) -> Nanos {
        self.link.due()
    }

    /// True while the device answers.
    pub fn is_up(&self) -> bool {
        self.link.is_up()
    }

    /// The value and the quality of each input.
    pub fn values(&self) -> &[(u64, Quality)] {
        &self.values
    }

    /// Carries out the order that is due, without telling the scan.
    pub fn work(&mut self, now: Nanos, happened: &mut dyn FnMut(Happened)) -> Worked {
        let order = self.link.order();
        let result = match order {
            Order::Connect => guarded(|| self.device.connect()),
            Order::Exchange => {
                self.take_outputs(now, happened);
                for input in &mut self.read {
                    *input = Err(Absent::Unread);
                }
                self.refused.fill(None);
                self.exchange()
            }
        };
        Worked { order, result }
    }

    fn exchange(&mut self) -> Result<(), Failed> {
        guarded(|| self.device.exchange(&self.raws, &self.write, &mut self.read, &mut self.refused))
    }

    fn close(&mut self) {
        // It is over either way.
        guarded(|| {
            self.device.close();
            Ok(())
        })
        .ok();
    }

    /// Takes the words of the scan and decides which outputs are written.
    fn take_outputs(&mut self, now: Nanos, happened: &mut dyn FnMut(Happened)) {
        self.from_scan.take(&mut self.wanted);
        let safe = self.safe.load(Ordering::Acquire);
        let refresh = now - self.refreshed >= self.timing.refresh;
        if refresh {
            self.refreshed = now;
        }
        for (k, out) in self.outputs.iter().enumerate() {
            let wanted = self.wanted.get(k).copied().unwrap_or(0);
            let (raw, limited) = out.scaling.raw(out.word(wanted, safe));
            if limited && !self.limited.get(k).copied().unwrap_or(true) {
                happened(Happened::Limited(k));
            }
            set(&mut self.limited, k, limited);
            let stale = self.written.get(k).is_none_or(|was| *was != Some(raw));
            set(&mut self.write, k, refresh || stale);
            set(&mut self.raws, k, raw);
        }
    }

    /// Notes at `now` what came of the order, and tells the scan.
    pub fn settle(&mut self, now: Nanos, worked: Worked, happened: &mut dyn FnMut(Happened)) {
        self.link.settle(now, worked.order, worked.result.is_ok());
        for remark in self.device.remarks() {
            match remark {
                Remark::Note(note) => happened(Happened::Note(note)),
                Remark::Written { input, value, who } => {
                    if let Some(word) = self.inputs.get(input).and_then(|scaling| scaling.word(value)) {
                        happened(Happened::Written(input, word, who));
                    }
                }
            }
        }
        match worked.result {
            Ok(()) if worked.order == Order::Connect => return,
            Ok(()) => {
                if self.told_up != Some(true) {
                    happened(Happened::Up);
                    self.told_up = Some(true);
                }
                self.note_outputs(happened);
                self.note_inputs(happened);
            }
            Err(failed) => {
                self.close();
                if self.told_up != Some(false) {
                    happened(Happened::Down(failed));
                    self.told_up = Some(false);
                }
                // The outputs that the device has now are not known.
                self.written.fill(None);
                for (_, quality) in &mut self.values {
                    *quality = if *quality == Quality::Unread { Quality::Unread } else { Quality::Bad };
                }
            }
        }
        let head = [now.count() as u64, u64::from(self.link.is_up())];
        let inputs = self.values.iter().flat_map(|(value, quality)| [*value, quality.word()]);
        self.to_scan.put(head.into_iter().chain(inputs));
    }

    fn note_outputs(&mut self, happened: &mut dyn FnMut(Happened)) {
        for k in 0..self.outputs.len() {
            let refused = self.refused.get_mut(k).and_then(Option::take);
            // A refusal may come later than the exchange that wrote.
            if refused.is_none() && !self.write.get(k).copied().unwrap_or(false) {
                continue;
            }
            let fine = refused.is_none();
            let written = self.raws.get(k).copied().filter(|_| fine);
            set(&mut self.written, k, written);
            let told = self.told_outputs.get(k).copied().unwrap_or(true);
            match refused {
                Some(why) if told => happened(Happened::NoOutput(k, why)),
                None if !told => happened(Happened::Output(k)),
                Some(_) | None => {}
            }
            set(&mut self.told_outputs, k, fine);
        }
    }

    fn note_inputs(&mut self, happened: &mut dyn FnMut(Happened)) {
        for (k, scaling) in self.inputs.iter().enumerate() {
            let raw = self.read.get(k).cloned().unwrap_or(Err(Absent::Unread));
            let read = match raw {
                Ok(raw) => scaling.word(raw).ok_or_else(|| format!("{raw:?} is no value of the variable")),
                Err(Absent::Unread) => Err("the device gave no value".to_owned()),
                Err(Absent::Refused(why)) => Err(why),
            };
            let told = self.told_inputs.get(k).copied().unwrap_or(true);
            match &read {
                Err(why) if told => happened(Happened::NoInput(k, why.clone())),
                Ok(_) if !told => happened(Happened::Input(k)),
                Ok(_) | Err(_) => {}
            }
            set(&mut self.told_inputs, k, read.is_ok());
            if let Some(value) = self.values.get_mut(k) {
                *value = match read {
                    Ok(word) => (word, Quality::Good),
                    Err(_) => (value.0, Quality::Bad),
                };
            }
        }
    }

    /// Writes the safe values once more and ends the connection: the last act of a driver.
    pub fn end(&mut self) {
        if self.link.is_up() && !self.outputs.is_empty() {
            for ((raw, out), wanted) in self.raws.iter_mut().zip(&self.outputs).zip(&self.wanted) {
                *raw = out.scaling.raw(out.word(*wanted, true)).0;
            }
            self.write.fill(true);
            // The program ends either way; a device that does not answer has a watchdog of its own.
            self.exchange().ok();
        }
        self.close();
    }
}

/// Calls a device. Behind it stand libraries, and an error in one must not end the thread that writes the
/// outputs: a device whose call panics has not answered, and is reached anew.
fn guarded(call: impl FnOnce() -> Result<(), Failed>) -> Result<(), Failed> {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|_| Err(Failed("an error of G7".to_owned())))
}

fn set<T>(list: &mut [T], at: usize, value: T) {
    if let Some(slot) = list.get_mut(at) {
        *slot = value;
    }
}
