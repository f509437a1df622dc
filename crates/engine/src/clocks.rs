//! The words of an image that hold times, and how far anybody reads them.
//!
//! A program that asks `X1.t >= T#5s` cannot tell 6 s from 7 s. So a canonical
//! image (`canonical.rs`) caps each time at the least value from which all later
//! ones look alike, and leaves out the times that nobody reads. The bounds are
//! read from the code: a comparison with a constant gives one, any other use of a
//! time counts as reading it without end.

use alloc::boxed::Box;
use alloc::collections::BTreeSet;
use alloc::vec;
use alloc::vec::Vec;

use crate::bits::word;
use crate::block_words::TIMED;
use crate::layout::{Layout, head};
use crate::ops::{Arith, Block, Builtin, Code, Num, Op};
use crate::reached::{Reached, does_write};
use crate::rules::Rules;
use crate::tables::{NONE, Rows, Tables};

/// The word of the header in which step times count: ns, or scans under the scan clock.
#[inline(always)]
pub(crate) fn clock(rules: &Rules) -> usize {
    if rules.scan_clock { head::SCANS } else { head::NOW }
}

/// The time since a stamp at a word of the image; the stamp itself where its owner is inactive.
#[inline(always)]
pub(crate) fn since(image: &[u64], at: u32, active: bool, now: i64) -> i64 {
    let stamp = word(image, at as usize) as i64;
    if active { now.wrapping_sub(stamp) } else { stamp }
}

/// A cap of a time that is read without end.
const ENDLESS: i64 = i64::MAX;

/// The time of a step or a group: when it became active while it is active, how
/// long it was active while it is not.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stamp {
    /// Word of the image.
    pub(crate) at: u32,
    /// The step or the group.
    pub(crate) of: Owner,
    /// It counts scans.
    pub(crate) scans: bool,
    pub(crate) cap: i64,
}

/// The owner of a [`Stamp`].
#[derive(Clone, Copy, Debug)]
pub(crate) enum Owner {
    Step(u32),
    Group(u32),
}

/// A watch with a timer: caps while it waits to become true, and to become false.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Timer {
    pub(crate) watch: u32,
    pub(crate) caps: [i64; 2],
}

/// The timers of a control block that is not plain, in the order of
/// [`TIMED`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockTimers {
    /// First word of the block in the image.
    pub(crate) at: u32,
    pub(crate) caps: [i64; 5],
    /// Every step that gives the input gives a time with it, so that the time of
    /// an input that is false will not be read again.
    pub(crate) timed: [bool; 5],
}

/// An instance of TON, TOF or TP.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instance {
    /// First word of the instance in the image.
    pub(crate) at: u32,
    pub(crate) block: Block,
    pub(crate) cap: i64,
}

/// The times of a program.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clocks {
    /// Words of the image that no future depends on.
    pub(crate) dead: Box<[Rows]>,
    pub(crate) stamps: Box<[Stamp]>,
    pub(crate) timers: Box<[Timer]>,
    pub(crate) blocks: Box<[BlockTimers]>,
    pub(crate) instances: Box<[Instance]>,
    /// Some code reaches the memory of a timer otherwise than by its call, so that
    /// times must stay absolute. `compile` never makes such code.
    pub(crate) absolute: bool,
}

#[inline(never)]
pub(crate) fn clocks(t: &Tables, l: &Layout) -> Clocks {
    let code = Reading::new(t);
    let (stamps, unread) = code.stamps(l);
    let instances = code.instances();
    let absolute = instances.iter().any(|i| code.is_exposed(*i));
    let place = |(base, block, cap): (u32, Block, i64)| Instance { at: l.vars + base, block, cap };
    Clocks {
        dead: dead(t, l, unread, absolute),
        stamps,
        timers: code.timers(),
        blocks: code.blocks(l),
        instances: instances.into_iter().map(place).collect(),
        absolute,
    }
}

/// The words that no future depends on: the counters of the header, times that
/// nobody reads, locals, and inputs that no watch compares with the next ones.
fn dead(t: &Tables, l: &Layout, mut words: Vec<u32>, absolute: bool) -> Box<[Rows]> {
    words.push(head::DT as u32);
    if !absolute {
        words.extend([head::NOW as u32, head::SCANS as u32]);
    }
    let watched = |a: u32| t.word_watches.binary_search_by(|(w, _)| w.0.cmp(&a)).is_ok();
    words.extend((t.inputs.start..t.inputs.end).filter(|a| !watched(*a)).map(|a| l.vars + a));
    words.extend((t.locals.start..t.locals.end).map(|a| l.vars + a));
    words.sort_unstable();
    words.dedup();
    let mut runs: Vec<Rows> = Vec::new();
    for w in words {
        match runs.last_mut() {
            Some(run) if run.end == w => run.end += 1,
            _ => runs.push(Rows { start: w, end: w + 1 }),
        }
    }
    runs.into_boxed_slice()
}

/// The code of a program, to be searched for reads of times.
pub(crate) struct Reading<'a> {
    pub(crate) t: &'a Tables,
    /// Instructions that some jump leads to.
    targets: Vec<bool>,
    reached: Reached,
}

impl Reading<'_> {
    pub(crate) fn new(t: &Tables) -> Reading<'_> {
        let mut targets = vec![false; t.code.len() + 1];
        for op in &t.code {
            if let Op::Jump(to) | Op::JumpUnless(to) = op
                && let Some(target) = targets.get_mut(*to as usize)
            {
                *target = true;
            }
        }
        Reading { t, targets, reached: Reached::new(t) }
    }

    /// The instruction at a place that is reached from the one before it alone.
    pub(crate) fn op(&self, pc: usize) -> Option<Op> {
        let joined = self.targets.get(pc).copied().unwrap_or(true);
        self.t.code.get(pc).copied().filter(|_| !joined)
    }

    /// The cap for a time in units of `unit`, pushed at `pc`.
    fn cap(&self, pc: usize) -> i64 {
        let bound = |c: u64, unit: i64| (c as i64).max(0).saturating_add(1).saturating_mul(unit);
        let (next, second) = (self.op(pc + 1), self.op(pc + 2));
        match (next, second) {
            (Some(Op::Push(c)), Some(Op::Compare(_, Num::I64))) => bound(c, 1),
            // `c <= X1.t`: the constant was pushed before.
            (Some(Op::Compare(_, Num::I64)), _) => match pc.checked_sub(1).and_then(|b| self.t.code.get(b)) {
                Some(Op::Push(c)) if self.op(pc).is_some() => bound(*c, 1),
                _ => ENDLESS,
            },
            (Some(Op::Push(unit)), Some(Op::Arith(Arith::Div, Num::I64))) if (unit as i64) > 0 => {
                match (self.op(pc + 3), self.op(pc + 4)) {
                    (Some(Op::Push(c)), Some(Op::Compare(_, Num::I64)))
                    | (Some(Op::Push(c)), Some(Op::Call(Builtin::Min, Num::I64, 2))) => bound(c, unit as i64),
                    _ => ENDLESS,
                }
            }
            _ => ENDLESS,
        }
    }

    /// The times of steps and groups that code reads, and the words of the others.
    fn stamps(&self, l: &Layout) -> (Box<[Stamp]>, Vec<u32>) {
        let (t, by_scans) = (self.t, self.t.rules.scan_clock);
        let mut caps: Vec<(u32, Owner, bool, Option<i64>)> = Vec::new();
        let mut place = |at: &dyn Fn(u32) -> u32, count: usize, of: fn(u32) -> Owner, scans: bool| {
            let first = caps.len();
            caps.extend((0..count as u32).map(|i| (at(i), of(i), scans, None)));
            first
        };
        let (s, g) = (t.steps.len(), t.groups.len());
        let steps = place(&|i| l.stamp(i), s, Owner::Step, by_scans);
        let groups = place(&|i| l.group_stamps + i, g, Owner::Group, by_scans);
        // Without the scan clock the ages are the stamps.
        let (ages, group_ages) = if by_scans {
            let ages = place(&|i| l.age(i), s, Owner::Step, false);
            (ages, place(&|i| l.group_ages + i, g, Owner::Group, false))
        } else {
            (steps, groups)
        };
        for (pc, op) in t.code.iter().enumerate() {
            let (row, cap) = match op {
                Op::StepTime(s) => (steps + s.0 as usize, self.cap(pc)),
                Op::StepAge(s) => (ages + s.0 as usize, self.cap(pc)),
                Op::GroupTime(g) => (groups + g.0 as usize, self.cap(pc)),
                Op::GroupAge(g) => (group_ages + g.0 as usize, self.cap(pc)),
                // It counts tenths of a second up to 9999.
                Op::StepTenths(s) => (steps + s.0 as usize, 9999 * 100_000_000),
                _ => continue,
            };
            if let Some((.., known)) = caps.get_mut(row) {
                *known = (*known).max(Some(cap));
            }
        }
        let unread = caps.iter().filter(|c| c.3.is_none() && c.0 != NONE).map(|c| c.0).collect();
        let read = caps
            .iter()
            .filter_map(|(at, of, scans, cap)| cap.map(|cap| Stamp { at: *at, of: *of, scans: *scans, cap }));
        (read.collect(), unread)
    }

    /// The value that a code pushes, where it is a constant.
    fn constant(&self, code: Code) -> Option<i64> {
        match self.t.code.get(code.start as usize..code.end as usize) {
            Some([Op::Push(v)]) => Some(*v as i64),
            _ => None,
        }
    }

    fn timers(&self) -> Box<[Timer]> {
        let cap = |code| self.constant(code).unwrap_or(ENDLESS).max(0);
        let timer = |(i, w): (u32, &crate::tables::Watch)| {
            w.times.map(|(on, off)| Timer { watch: i, caps: [cap(on), cap(off)] })
        };
        (0u32..).zip(&self.t.watches).filter_map(timer).collect()
    }

    fn blocks(&self, l: &Layout) -> Box<[BlockTimers]> {
        let rows = (0u32..).zip(&self.t.blocks).zip(l.block_at.iter());
        let mut found: Vec<(u32, BlockTimers)> = rows
            .filter(|((_, b), _)| !b.plain)
            .map(|((i, _), at)| (i, BlockTimers { at: *at, caps: [0; 5], timed: [true; 5] }))
            .collect();
        for c in &self.t.contributions {
            let Some(k) = TIMED.iter().position(|i| *i == u32::from(c.input)) else { continue };
            let Ok(row) = found.binary_search_by(|(i, _)| i.cmp(&c.block)) else { continue };
            let Some((_, block)) = found.get_mut(row) else { continue };
            let cap = if c.time.is_empty() { 0 } else { self.constant(c.time).unwrap_or(ENDLESS) };
            if let (Some(caps), Some(timed)) = (block.caps.get_mut(k), block.timed.get_mut(k)) {
                *caps = (*caps).max(cap);
                *timed &= !c.time.is_empty();
            }
        }
        found.into_iter().map(|(_, b)| b).collect()
    }

    /// The timers that are called: first word, block, cap.
    fn instances(&self) -> Vec<(u32, Block, i64)> {
        let mut found: Vec<(u32, Block, i64)> = Vec::new();
        let mut seen = BTreeSet::new();
        for op in &self.t.code {
            let Op::Fb(block @ (Block::Ton | Block::Tof | Block::Tp), base) = *op else { continue };
            if seen.insert((base.0, block as u8)) {
                found.push((base.0, block, self.most(base.0 + 1).unwrap_or(ENDLESS)));
            }
        }
        found
    }

    /// The largest value that a word ever has, where code writes constants alone.
    fn most(&self, word: u32) -> Option<i64> {
        Some(self.values(word)?.into_iter().fold(0, i64::max))
    }

    /// The values that a word ever has, where code writes constants alone.
    pub(crate) fn values(&self, word: u32) -> Option<Vec<i64>> {
        let t = self.t;
        let mut values = vec![t.init.get(word as usize).map(|v| *v as i64)?];
        if self.reached.is_tied(word) {
            return None;
        }
        for pc in self.reached.places(word) {
            let Some(op) = t.code.get(pc).filter(|op| does_write(op, word)) else { continue };
            let before = pc.checked_sub(1).and_then(|b| t.code.get(b));
            match (op, before) {
                // A call leaves the times that it is given as they are.
                (Op::Fb(Block::Ton | Block::Tof | Block::Tp, base), _) if base.0 + 1 == word => {}
                (Op::Store(_), Some(Op::Push(v))) if self.op(pc).is_some() => values.push(*v as i64),
                _ => return None,
            }
        }
        Some(values)
    }

    /// True if anything but calls of a timer reaches the words of its memory.
    fn is_exposed(&self, (base, block, _): (u32, Block, i64)) -> bool {
        (base + 4..base + 6).any(|word| self.is_reached(base, block, word))
    }

    /// True if anything but calls of the timer at `base` reaches this word of it. Strings are left out:
    /// none lies over an instance.
    pub(crate) fn is_reached(&self, base: u32, block: Block, word: u32) -> bool {
        let reached = |op: &Op| match *op {
            Op::Fb(b, at) if b == block && at.0 == base => false,
            Op::Fb(b, at) => (at.0..at.0 + b.words()).contains(&word),
            Op::Load(a) => a.0 == word,
            Op::LoadAt { base: at, len } => (at.0..at.0.saturating_add(len)).contains(&word),
            _ => does_write(op, word),
        };
        let mut ops = self.reached.places(word).filter_map(|pc| self.t.code.get(pc));
        self.reached.is_guard(word) || self.reached.is_tied(word) || ops.any(reached)
    }
}
