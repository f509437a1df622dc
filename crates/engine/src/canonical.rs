//! States compared without regard to the time at which they were reached, and put
//! back from their images.

use alloc::vec::Vec;

use crate::bits::{bit, word};
use crate::block_words::{MEMORY, STARTS, TIMED, TIMES, timer_latched};
use crate::clocks::{BlockTimers, Instance, Owner, Stamp, Timer};
use crate::layout::{FLAGS, Layout, head, timing};
use crate::ops::Block;
use crate::program::Program;
use crate::state::State;
use crate::tables::Tables;
use crate::watch::forget_edges;

/// Why words are not an image of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImageError {
    /// There are more or fewer words than an image of the program has.
    Length,
    /// The words, or the state to be overwritten, belong to another program.
    Program,
    /// A word has bits that no image has: a flag that does not exist, a member of a
    /// set beyond its end, or a summary that does not fit its set.
    Bits {
        /// The first word of the set.
        at: u32,
    },
}

impl core::fmt::Display for ImageError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            ImageError::Length => f.write_str("the image is not as long as those of the program"),
            ImageError::Program => f.write_str("the image belongs to another program"),
            ImageError::Bits { at } => write!(f, "the image has bits at word {at} that no image has"),
        }
    }
}

impl core::error::Error for ImageError {}

impl State {
    /// Writes the canonical image into `image`: the image of an equivalent state
    /// whose latest scan was at time 0 and that has counted no scan.
    ///
    /// Two states of one program with equal canonical images have equal futures:
    /// under equal inputs and equal time steps they go through equal situations,
    /// outputs, variables and faults. The same run that began at another time has
    /// the same canonical image. This is what a search compares.
    ///
    /// Left out is all that no future depends on: the absolute time and the number
    /// of scans; the times of steps that no code reads; how far a time lies beyond
    /// the last constant that it is compared with; edges, which the next scan
    /// forgets; inputs that only the present scan could read. `restore` accepts the
    /// result. It is meant for a state between two scans.
    ///
    /// `image` is overwritten; it allocates only while its room is too small. Times
    /// are assumed to stay within `i64` nanoseconds (292 years).
    pub fn canonical(&self, p: &Program, image: &mut Vec<u64>) {
        image.clear();
        image.extend_from_slice(&self.image);
        forget_edges(p, image, |period| p.tables.periods.get(period as usize).is_none_or(|t| *t <= 0));
        if !p.clocks.absolute {
            let from = Origin { now: self.now(), scans: self.scans() as i64 };
            relate(p, from, image);
        }
        for run in &p.clocks.dead {
            if let Some(words) = image.get_mut(run.start as usize..run.end as usize) {
                words.fill(0);
            }
        }
    }

    /// Takes over an image, plain or canonical, of a state of the same program; the
    /// state has no reports then. Allocates nothing.
    ///
    /// # Errors
    ///
    /// [`ImageError`] where the words cannot be an image of this program; nothing was
    /// changed then. The values of variables and times are not judged: words that
    /// no run leads to give a state without meaning, but never a panic.
    pub fn restore(&mut self, p: &Program, image: &[u64]) -> Result<(), ImageError> {
        if image.len() != p.layout.len as usize || self.image.len() != image.len() {
            return Err(ImageError::Length);
        }
        let mine = word(&self.image, head::PROGRAM) == p.fingerprint;
        if !mine || word(image, head::PROGRAM) != p.fingerprint {
            return Err(ImageError::Program);
        }
        check(&p.layout, &p.tables, image)?;
        self.image.copy_from_slice(image);
        self.scratch.reset();
        Ok(())
    }

    /// The image as bytes, little-endian.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.image.iter().flat_map(|w| w.to_le_bytes()).collect()
    }

    /// The state whose bytes [`State::to_bytes`] gave, for the same program.
    ///
    /// # Errors
    ///
    /// As [`State::restore`].
    pub fn from_bytes(p: &Program, bytes: &[u8]) -> Result<State, ImageError> {
        let (words, rest) = bytes.as_chunks();
        if !rest.is_empty() {
            return Err(ImageError::Length);
        }
        let words: Vec<u64> = words.iter().map(|b| u64::from_le_bytes(*b)).collect();
        let mut state = State::new(p);
        state.restore(p, &words)?;
        Ok(state)
    }
}

/// Checks flags and sets.
fn check(l: &Layout, t: &Tables, image: &[u64]) -> Result<(), ImageError> {
    let bad = |at: u32| Err(ImageError::Bits { at });
    if word(image, head::FLAGS) & !FLAGS != 0 {
        return bad(head::FLAGS as u32);
    }
    let (steps, watches, contributions) = (t.steps.len(), t.watches.len(), t.contributions.len());
    let sets = [
        (&l.steps, steps),
        (&l.edged, watches),
        (&l.dirty, watches),
        (&l.running, watches),
        (&l.conditions, contributions),
        (&l.blocks, t.blocks.len()),
        (&l.timing, timing(t) as usize),
        (&l.events, t.events.len()),
        (&l.periodics, t.periodics.len()),
        (&l.orders, t.orders.len()),
    ];
    for (set, count) in sets {
        if count > 0 && !set.is_sound(image, count as u32) {
            return bad(set.base());
        }
    }
    let [init, clear, set, reset] = l.requests;
    let groups = t.groups.len();
    let flags = [
        (l.value, watches),
        (l.rise, watches),
        (l.fall, watches),
        (l.q, watches),
        (l.counted, contributions),
        (init, groups),
        (clear, groups),
        (set, steps),
        (reset, steps),
    ];
    for (at, count) in flags {
        if !count.is_multiple_of(64) && word(image, at as usize + count / 64) >> (count % 64) != 0 {
            return bad(at);
        }
    }
    Ok(())
}

/// The time from which an image counts.
#[derive(Clone, Copy)]
struct Origin {
    now: i64,
    scans: i64,
}

/// The same distance from time 0, at most `cap`.
fn since(now: i64, start: u64, cap: i64) -> u64 {
    let elapsed = now.wrapping_sub(start as i64).min(cap);
    0i64.wrapping_sub(elapsed) as u64
}

/// Makes all times of an image relative, and caps them.
fn relate(p: &Program, from: Origin, image: &mut [u64]) {
    let c = &p.clocks;
    for s in &c.stamps {
        stamp(p, from, image, s);
    }
    for t in &c.timers {
        timer(&p.layout, from.now, image, t);
    }
    for b in &c.blocks {
        block(from.now, image, b);
    }
    for i in &c.instances {
        instance(from.now, image, i);
    }
    for (at, period) in (p.layout.periods..).zip(&p.tables.periods) {
        if *period > 0 {
            change(image, at, |next| (next as i64).wrapping_sub(from.now) as u64);
        }
    }
}

fn change(image: &mut [u64], at: u32, f: impl FnOnce(u64) -> u64) {
    if let Some(w) = image.get_mut(at as usize) {
        *w = f(*w);
    }
}

fn stamp(p: &Program, from: Origin, image: &mut [u64], s: &Stamp) {
    let active = match s.of {
        Owner::Step(i) => p.layout.steps.contains(image, i),
        Owner::Group(i) => word(image, (p.layout.groups + i) as usize) != 0,
    };
    let now = if s.scans { from.scans } else { from.now };
    change(image, s.at, |w| if active { since(now, w, s.cap) } else { (w as i64).min(s.cap) as u64 });
}

fn timer(l: &Layout, now: i64, image: &mut [u64], t: &Timer) {
    let [on, off] = t.caps;
    let cap = if bit(image, l.value, t.watch) { on } else { off };
    let runs = l.running.contains(image, t.watch);
    change(image, l.start + t.watch, |start| if runs { since(now, start, cap) } else { 0 });
}

fn block(now: i64, image: &mut [u64], b: &BlockTimers) {
    let memory = word(image, (b.at + MEMORY) as usize);
    for (k, input) in (0u32..).zip(TIMED) {
        let latched = timer_latched(memory, k);
        let on = word(image, (b.at + input) as usize) != 0;
        let timed = b.timed.get(k as usize).copied().unwrap_or(false);
        if !latched && !on && timed {
            change(image, b.at + TIMES + k, |_| 0);
        }
        let time = word(image, (b.at + TIMES + k) as usize) as i64;
        let cap = b.caps.get(k as usize).copied().unwrap_or(i64::MAX).max(time);
        change(image, b.at + STARTS + k, |start| if latched { since(now, start, cap) } else { 0 });
    }
}

/// The start of a TON is read while its input was true at the latest call, that of
/// a TOF or TP while its time runs.
fn instance(now: i64, image: &mut [u64], i: &Instance) {
    let memory = word(image, (i.at + 5) as usize);
    let runs = if i.block == Block::Ton { memory & 1 != 0 } else { memory & 2 != 0 };
    let time = word(image, (i.at + 1) as usize) as i64;
    change(image, i.at + 4, |start| if runs { since(now, start, i.cap.max(time)) } else { 0 });
}
