//! The state of a running program: one flat array of words.
//!
//! Everything that decides the future is in [`State::image`]: step activity,
//! variables, times, edge memories, timers, control blocks. Nothing in it depends
//! on the path by which it was reached, so equal images have equal futures, and
//! comparing, hashing and saving them loses nothing. Beside it lies scratch space
//! (`scratch.rs`). `canonical.rs` compares states of different times and puts an
//! image back into a state.

use alloc::boxed::Box;
use alloc::vec;

use crate::bits::{Tree, Walk, bit, word};
use crate::clocks::{clock, since};
use crate::layout::{STARTED, STOPPED, head};
use crate::ops::{Addr, GroupId, StepId, WatchId};
use crate::program::Program;
use crate::scratch::Scratch;

/// The memory of a running program.
///
/// Equality and hash are those of [`State::image`].
#[derive(Debug)]
pub struct State {
    pub(crate) image: Box<[u64]>,
    pub(crate) scratch: Scratch,
    /// Place of the variable area in the image, its length, and the set of active
    /// steps, as [`crate::layout::Layout`] has them.
    pub(crate) vars: u32,
    pub(crate) var_words: u32,
    pub(crate) steps: Tree,
}

impl Clone for State {
    /// A copy with the same room in its scratch space, since a scan allocates nothing.
    fn clone(&self) -> State {
        let mut scratch = self.scratch.clone();
        scratch.make_room(&self.scratch);
        State {
            image: self.image.clone(),
            scratch,
            vars: self.vars,
            var_words: self.var_words,
            steps: self.steps,
        }
    }
}

impl PartialEq for State {
    fn eq(&self, other: &State) -> bool {
        self.image == other.image
    }
}

impl Eq for State {}

impl core::hash::Hash for State {
    fn hash<H: core::hash::Hasher>(&self, state: &mut H) {
        self.image.hash(state);
    }
}

impl State {
    /// A state before its first scan: variables have their initial values, and no
    /// step is active yet, since the first scan activates the initial ones.
    /// Only this, [`Clone`] and [`State::from_bytes`] allocate.
    pub fn new(p: &Program) -> State {
        let (t, l) = (&p.tables, &p.layout);
        let mut image = vec![0u64; l.len as usize].into_boxed_slice();
        let vars = l.vars as usize;
        if let Some(area) = image.get_mut(vars..vars + t.init.len()) {
            area.copy_from_slice(&t.init);
        }
        if let Some(w) = image.get_mut(head::PROGRAM) {
            *w = p.fingerprint;
        }
        State {
            image,
            scratch: Scratch::new(p),
            vars: l.vars,
            var_words: t.init.len() as u32,
            steps: l.steps,
        }
    }

    /// Becomes what another state of the same program is between two scans: with its image, and without
    /// reports. Does nothing if the images differ in length. Allocates nothing; a search calls it for
    /// each scan that it tries.
    pub fn become_as(&mut self, other: &State) {
        if self.image.len() == other.image.len() {
            self.image.copy_from_slice(&other.image);
            self.scratch.reset();
        }
    }

    /// All that decides the future, as words. The program fixes their places; two
    /// states of one program with equal images have equal futures. Word 0 is the
    /// fingerprint of the program, the others are the memory.
    ///
    /// The image holds the absolute time and the number of scans, so that two
    /// states that were reached at different times differ in it. States are
    /// compared without regard to that by [`State::canonical`].
    pub fn image(&self) -> &[u64] {
        &self.image
    }

    /// The variable area.
    pub fn words(&self) -> &[u64] {
        let at = self.vars as usize;
        self.image.get(at..at + self.var_words as usize).unwrap_or(&[])
    }

    /// The place of the variable area in the image.
    pub fn first_variable(&self) -> usize {
        self.vars as usize
    }

    /// A word of the variable area, 0 where there is none.
    pub fn word(&self, addr: Addr) -> u64 {
        if addr.0 >= self.var_words { 0 } else { word(&self.image, (self.vars + addr.0) as usize) }
    }

    /// True if a step is active.
    pub fn is_active(&self, step: StepId) -> bool {
        (step.0 as usize) < self.scratch.on_mark.len() * 64 && self.steps.contains(&self.image, step.0)
    }

    /// The active steps, ascending.
    pub fn active(&self) -> impl Iterator<Item = StepId> + '_ {
        let mut walk = Walk::new(&self.steps, &self.image);
        core::iter::from_fn(move || walk.next(&self.steps, &self.image).map(StepId))
    }

    /// True if a step of the group is active.
    pub fn group_active(&self, p: &Program, group: GroupId) -> bool {
        word(&self.image, p.layout.groups as usize + group.0 as usize) != 0
    }

    /// Time since the group became active, in ns (in scans under the scan clock);
    /// how long it was active, while it is not. Only a group whose steps name it in
    /// [`crate::Extra::groups`] has one.
    pub fn group_time(&self, p: &Program, group: GroupId) -> i64 {
        let stamp = word(&self.image, p.layout.group_stamps as usize + group.0 as usize) as i64;
        if self.group_active(p, group) { self.clock(p).wrapping_sub(stamp) } else { stamp }
    }

    /// Time since the step's activation, in ns (in scans under the scan clock); how
    /// long it was active, while it is not.
    pub fn step_time(&self, p: &Program, step: StepId) -> i64 {
        since(&self.image, p.layout.stamp(step.0), self.is_active(step), self.clock(p))
    }

    /// As [`State::step_time`], in ns under every clock.
    pub fn step_age(&self, p: &Program, step: StepId) -> i64 {
        since(&self.image, p.layout.age(step.0), self.is_active(step), self.now())
    }

    /// As [`State::group_time`], in ns under every clock.
    pub fn group_age(&self, p: &Program, group: GroupId) -> i64 {
        let stamp = word(&self.image, p.layout.group_ages as usize + group.0 as usize) as i64;
        if self.group_active(p, group) { self.now().wrapping_sub(stamp) } else { stamp }
    }

    /// The output of a timer.
    pub fn timer(&self, p: &Program, watch: WatchId) -> bool {
        bit(&self.image, p.layout.q, watch.0)
    }

    /// Time of the latest scan, ns.
    pub fn now(&self) -> i64 {
        word(&self.image, head::NOW) as i64
    }

    /// Scans begun.
    pub fn scans(&self) -> u64 {
        word(&self.image, head::SCANS)
    }

    /// True if the first scan has begun.
    pub fn is_started(&self) -> bool {
        word(&self.image, head::FLAGS) & STARTED != 0
    }

    /// True if a fault has stopped the program.
    pub fn is_stopped(&self) -> bool {
        word(&self.image, head::FLAGS) & STOPPED != 0
    }

    /// Ranks of the transitions cleared in the latest scan, pass by pass (within
    /// a pass they clear at once, in no order); a long search may be cut.
    pub fn cleared(&self) -> &[u32] {
        &self.scratch.cleared
    }

    /// Actions (ranks) that ran in the latest scan; a long search may be cut.
    pub fn ran(&self) -> &[u32] {
        &self.scratch.ran
    }

    /// Empties the lists of [`State::cleared`] and [`State::ran`]. Who makes the passes of a scan one by
    /// one calls this before each: then the lists have room for all that one pass does.
    pub fn forget_reports(&mut self) {
        self.scratch.begin_brisk();
    }

    /// The time in which step times count: ns, or scans under the scan clock.
    #[inline(always)]
    pub(crate) fn clock(&self, p: &Program) -> i64 {
        word(&self.image, clock(&p.tables.rules)) as i64
    }

    /// True if a row of [`crate::Tables::periods`] is due in this scan.
    #[inline(always)]
    pub(crate) fn is_due(&self, p: &Program, period: u32) -> bool {
        !p.has_periods || self.scratch.due.get(period as usize).copied().unwrap_or(true)
    }

    pub(crate) fn has_flag(&self, flag: u64) -> bool {
        word(&self.image, head::FLAGS) & flag != 0
    }

    pub(crate) fn has_only_flag(&self, flag: u64) -> bool {
        word(&self.image, head::FLAGS) == flag
    }

    pub(crate) fn set_flag(&mut self, flag: u64, on: bool) {
        if let Some(w) = self.image.get_mut(head::FLAGS) {
            *w = if on { *w | flag } else { *w & !flag };
        }
    }

    pub(crate) fn set(&mut self, at: usize, value: u64) {
        if let Some(w) = self.image.get_mut(at) {
            *w = value;
        }
    }
}
