//! The places of all parts of the image of a state.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use crate::bits::Tree;
use crate::block_words::{BLOCK, TIMED};
use crate::ops::Op;
use crate::tables::{NONE, Tables};

/// Words of the header.
pub(crate) mod head {
    /// Fingerprint of the program.
    pub(crate) const PROGRAM: usize = 0;
    /// Time of the latest scan, ns.
    pub(crate) const NOW: usize = 1;
    /// Time between the latest scan and the one before, ns.
    pub(crate) const DT: usize = 2;
    /// Number of scans begun.
    pub(crate) const SCANS: usize = 3;
    /// [`super::STARTED`], [`super::STOPPED`], [`super::REQUESTS`], [`super::START`].
    pub(crate) const FLAGS: usize = 4;
    /// Number of header words.
    pub(crate) const WORDS: u32 = 5;
}

/// Flag: the first scan has begun.
pub(crate) const STARTED: u64 = 1;
/// Flag: a fault has stopped the program.
pub(crate) const STOPPED: u64 = 2;
/// Flag: requests wait for the service point.
pub(crate) const REQUESTS: u64 = 4;
/// Flag: one of the requests is that for the situation of the start.
pub(crate) const START: u64 = 8;
/// All flags.
pub(crate) const FLAGS: u64 = STARTED | STOPPED | REQUESTS | START;

/// The places, as indices of words. A set is a [`Tree`]; "a bit each" is a plain
/// array of bits.
#[derive(Clone, Debug, Default)]
pub(crate) struct Layout {
    /// Set of the active steps.
    pub(crate) steps: Tree,
    /// The variable area.
    pub(crate) vars: u32,
    /// The word of each step that has the clock at its activation while it is active, how
    /// long it was active while it is not; `NONE` where it is not kept.
    pub(crate) stamps: Box<[u32]>,
    /// The same in nanoseconds under the scan clock; otherwise empty, and `stamps` are it.
    ages: Box<[u32]>,
    /// Watches, a bit each: the value of the expression at the latest look.
    pub(crate) value: u32,
    /// Watches, a bit each: the expression rose in this pass.
    pub(crate) rise: u32,
    /// Watches, a bit each: the expression fell in this pass.
    pub(crate) fall: u32,
    /// Watches, a bit each: output of the timer.
    pub(crate) q: u32,
    /// Set of the watches that rose or fell.
    pub(crate) edged: Tree,
    /// Set of the watches to be evaluated.
    pub(crate) dirty: Tree,
    /// Set of the watches whose timer runs.
    pub(crate) running: Tree,
    /// A word for each watch: the time at which its timer was started, 0 while it
    /// does not run.
    pub(crate) start: u32,
    /// A word for each group: the number of its active steps.
    pub(crate) groups: u32,
    /// As `stamps`, for each group.
    pub(crate) group_stamps: u32,
    /// As `ages`, for each group.
    pub(crate) group_ages: u32,
    /// Contributions with a condition or a time, a bit each: it counts at present.
    pub(crate) counted: u32,
    /// Set of the contributions with a condition or a time whose step is active.
    pub(crate) conditions: Tree,
    /// The first word of each control block.
    pub(crate) block_at: Box<[u32]>,
    /// Set of the control blocks to be evaluated.
    pub(crate) blocks: Tree,
    /// Set of the control blocks that only wait for a timer of theirs.
    pub(crate) timing: Tree,
    /// Set of the event actions whose step is active.
    pub(crate) events: Tree,
    /// Set of the actions of each scan whose step is active.
    pub(crate) periodics: Tree,
    /// Set of the rows that say that an active step gives orders.
    pub(crate) orders: Tree,
    /// A word for each period: the time at which it is due next.
    pub(crate) periods: u32,
    /// Requests: groups to be initialised, groups to be cleared, steps to be set,
    /// steps to be reset; a bit each.
    pub(crate) requests: [u32; 4],
    /// Number of words.
    pub(crate) len: u32,
}

impl Layout {
    #[inline(never)]
    pub(crate) fn new(t: &Tables) -> Layout {
        let mut next = head::WORDS;
        let n = |len: usize| u32::try_from(len).unwrap_or(u32::MAX);
        let (steps, watches) = (n(t.steps.len()), n(t.watches.len()));
        let mut l = Layout { steps: Tree::reserve(steps, &mut next), ..Layout::default() };
        fn take(next: &mut u32, words: u32) -> u32 {
            let at = *next;
            *next += words;
            at
        }
        l.vars = take(&mut next, n(t.init.len()));
        let mut times = |kept: Vec<bool>| {
            kept.into_iter().map(|kept| if kept { take(&mut next, 1) } else { NONE }).collect()
        };
        let (stamps, ages) = kept_times(t);
        l.stamps = times(stamps);
        if t.rules.scan_clock {
            l.ages = times(ages);
        }
        let bits = watches.div_ceil(64);
        l.value = take(&mut next, bits);
        l.rise = take(&mut next, bits);
        l.fall = take(&mut next, bits);
        l.q = take(&mut next, bits);
        l.edged = Tree::reserve(watches, &mut next);
        l.dirty = Tree::reserve(watches, &mut next);
        l.running = Tree::reserve(watches, &mut next);
        l.start = take(&mut next, watches);
        let groups = n(t.groups.len());
        l.groups = take(&mut next, groups);
        l.group_stamps = take(&mut next, groups);
        l.group_ages = if t.rules.scan_clock { take(&mut next, groups) } else { l.group_stamps };
        let contributions = n(t.contributions.len());
        l.counted = take(&mut next, contributions.div_ceil(64));
        l.conditions = Tree::reserve(contributions, &mut next);
        l.block_at = t.blocks.iter().map(|b| take(&mut next, if b.plain { 1 } else { BLOCK })).collect();
        l.blocks = Tree::reserve(n(t.blocks.len()), &mut next);
        l.timing = Tree::reserve(timing(t), &mut next);
        l.events = Tree::reserve(n(t.events.len()), &mut next);
        l.periodics = Tree::reserve(n(t.periodics.len()), &mut next);
        l.orders = Tree::reserve(n(t.orders.len()), &mut next);
        l.periods = take(&mut next, n(t.periods.len()));
        let (g, s) = (groups.div_ceil(64), steps.div_ceil(64));
        l.requests = [take(&mut next, g), take(&mut next, g), take(&mut next, s), take(&mut next, s)];
        l.len = next;
        l
    }

    /// The word of [`Layout::stamps`] of a step, `NONE` where there is none.
    #[inline(always)]
    pub(crate) fn stamp(&self, step: u32) -> u32 {
        self.stamps.get(step as usize).copied().unwrap_or(NONE)
    }

    /// As [`Layout::stamp`], in nanoseconds under every clock.
    #[inline(always)]
    pub(crate) fn age(&self, step: u32) -> u32 {
        let ages = if self.ages.is_empty() { &self.stamps } else { &self.ages };
        ages.get(step as usize).copied().unwrap_or(NONE)
    }

    /// The top words of the sets whose members act in a pass or at its end, without those that
    /// are always empty.
    #[inline(never)]
    pub(crate) fn awake(&self, t: &Tables) -> Box<[u32]> {
        let sets = [
            (&self.edged, t.watches.len()),
            (&self.dirty, t.watches.len()),
            (&self.running, t.watches.len()),
            (&self.conditions, t.contributions.len()),
            (&self.blocks, t.blocks.len()),
            (&self.events, t.events.len()),
            (&self.periodics, t.periodics.len()),
            (&self.orders, t.orders.len()),
        ];
        sets.iter().filter(|(_, members)| *members > 0).map(|(set, _)| set.top()).collect()
    }
}

/// The number of members of [`Layout::timing`]: all blocks where one has a timer.
pub(crate) fn timing(t: &Tables) -> u32 {
    let timed = t.contributions.iter().any(|c| TIMED.contains(&u32::from(c.input)));
    if timed { u32::try_from(t.blocks.len()).unwrap_or(u32::MAX) } else { 0 }
}

/// The steps whose stamps are kept, and those whose ages are.
fn kept_times(t: &Tables) -> (Vec<bool>, Vec<bool>) {
    let all = vec![!t.lean; t.steps.len()];
    let (mut stamps, mut ages) = (all.clone(), all);
    for op in &t.code {
        let (list, step) = match op {
            Op::StepTime(step) | Op::StepTenths(step) => (&mut stamps, step),
            Op::StepAge(step) if t.rules.scan_clock => (&mut ages, step),
            Op::StepAge(step) => (&mut stamps, step),
            _ => continue,
        };
        if let Some(kept) = list.get_mut(step.0 as usize) {
            *kept = true;
        }
    }
    (stamps, ages)
}
