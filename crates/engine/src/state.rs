//! The state of a running program: one flat array of words.
//!
//! Everything that decides the future is in [`State::image`]: step activity,
//! variables, times, edge memories, timers, control blocks. Nothing in it
//! depends on the way it was reached, so equal images have equal futures, and
//! comparing, hashing and saving them loses nothing. Beside it lies scratch
//! space that a scan needs and that never carries anything from one scan to
//! the next (but for reports).

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use crate::bits::{Tree, Walk, bit, word};
use crate::{Addr, GroupId, Program, STACK, StepId, Tables, WatchId};

/// Words of a control block that is not plain: 11 counts, memories, 5 starts, 5 times.
pub(crate) const BLOCK: u32 = 22;
/// Place of the memories in a block.
pub(crate) const MEMORY: u32 = 11;
/// Place of the starts of the timers in a block.
pub(crate) const STARTS: u32 = 12;
/// Place of the times of the timers in a block.
pub(crate) const TIMES: u32 = 17;

/// Header words.
pub(crate) mod head {
    /// Time of this scan, ns.
    pub(crate) const NOW: usize = 0;
    /// Time since the scan before, ns.
    pub(crate) const DT: usize = 1;
    /// Scans begun.
    pub(crate) const SCANS: usize = 2;
    /// Bit 0: started. Bit 1: stopped by a fault. Bit 2: requests wait.
    pub(crate) const FLAGS: usize = 3;
    /// Number of header words.
    pub(crate) const WORDS: u32 = 4;
}

/// Set once the first scan has begun.
pub(crate) const STARTED: u64 = 1;
/// Set by a fault.
pub(crate) const STOPPED: u64 = 2;
/// Set while requests wait for the service point.
pub(crate) const REQUESTS: u64 = 4;

/// Where everything lies in the image.
#[derive(Clone, Debug, Default)]
pub(crate) struct Layout {
    /// Active steps.
    pub(crate) steps: Tree,
    /// Variable area.
    pub(crate) vars: u32,
    /// A word a step: when activated while active, how long while not.
    pub(crate) stamps: u32,
    /// The same in nanoseconds: the stamps themselves but under the scan clock.
    pub(crate) ages: u32,
    /// A bit a watch: its value (of a timer: its condition).
    pub(crate) value: u32,
    /// A bit a watch: it rose in this pass.
    pub(crate) rise: u32,
    /// A bit a watch: it fell in this pass.
    pub(crate) fall: u32,
    /// A bit a watch: output of a timer.
    pub(crate) q: u32,
    /// Watches that rose or fell.
    pub(crate) edged: Tree,
    /// Watches to be looked at.
    pub(crate) dirty: Tree,
    /// Timers running.
    pub(crate) running: Tree,
    /// A word a watch: when its timer was started.
    pub(crate) start: u32,
    /// A word a group: its active steps.
    pub(crate) groups: u32,
    /// A word a group: when it became active while active, how long while not.
    pub(crate) group_stamps: u32,
    /// The same in nanoseconds.
    pub(crate) group_ages: u32,
    /// A bit a contribution: it counts at present (those with a condition or time).
    pub(crate) counted: u32,
    /// Contributions with a condition or time whose step is active.
    pub(crate) conditions: Tree,
    /// Words of each control block; `block_at` says where.
    pub(crate) block_at: Box<[u32]>,
    /// Blocks to be evaluated.
    pub(crate) blocks: Tree,
    /// Event actions whose step is active.
    pub(crate) events: Tree,
    /// Actions of each scan whose step is active.
    pub(crate) periodics: Tree,
    /// Rows of active steps that give forcing orders.
    pub(crate) orders: Tree,
    /// A word a period: when it is due next.
    pub(crate) periods: u32,
    /// Bits: groups to be initialised, to be cleared, steps to be set, to be reset.
    pub(crate) requests: [u32; 4],
    /// Words in all.
    pub(crate) len: u32,
}

impl Layout {
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
        l.stamps = take(&mut next, steps);
        l.ages = if t.rules.scan_clock { take(&mut next, steps) } else { l.stamps };
        let bits = watches.div_ceil(64);
        l.value = take(&mut next, bits);
        l.rise = take(&mut next, bits);
        l.fall = take(&mut next, bits);
        l.q = take(&mut next, bits);
        l.edged = Tree::reserve(watches, &mut next);
        l.dirty = Tree::reserve(watches, &mut next);
        l.running = Tree::reserve(watches, &mut next);
        l.start = take(&mut next, watches);
        l.groups = take(&mut next, n(t.groups.len()));
        l.group_stamps = take(&mut next, n(t.groups.len()));
        l.group_ages = if t.rules.scan_clock { take(&mut next, n(t.groups.len())) } else { l.group_stamps };
        let contributions = n(t.contributions.len());
        l.counted = take(&mut next, contributions.div_ceil(64));
        l.conditions = Tree::reserve(contributions, &mut next);
        l.block_at = t.blocks.iter().map(|b| take(&mut next, if b.plain { 1 } else { BLOCK })).collect();
        l.blocks = Tree::reserve(n(t.blocks.len()), &mut next);
        l.events = Tree::reserve(n(t.events.len()), &mut next);
        l.periodics = Tree::reserve(n(t.periodics.len()), &mut next);
        l.orders = Tree::reserve(n(t.orders.len()), &mut next);
        l.periods = take(&mut next, n(t.periods.len()));
        let (g, s) = (n(t.groups.len()).div_ceil(64), steps.div_ceil(64));
        l.requests = [take(&mut next, g), take(&mut next, g), take(&mut next, s), take(&mut next, s)];
        l.len = next;
        l
    }
}

/// Space a scan works in. Never grows after [`State::new`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    pub(crate) stack: Vec<u64>,
    pub(crate) fired: Vec<u32>,
    /// The only active step, where that is known; else `NONE` (`bare`).
    pub(crate) lone: u32,
    /// Active steps whose transitions need a closer look (`bare`).
    pub(crate) slow: Vec<u32>,
    pub(crate) on: Vec<u32>,
    /// Steps that follow one another through enclosures (`sequential`).
    pub(crate) chain: Vec<u32>,
    /// Enclosing steps left in this pass, and those entered.
    pub(crate) left: Vec<u32>,
    pub(crate) came: Vec<u32>,
    /// Steps that changed in this pass, where some code looks back: which, a bit
    /// each, and whether they were active as the pass began.
    pub(crate) turns: Vec<u32>,
    pub(crate) turned: Box<[u64]>,
    pub(crate) was: Box<[u64]>,
    /// Words written in this pass with their values as it began, where they may
    /// change and change back in it; and which, a bit each.
    pub(crate) written: Vec<(u32, u64)>,
    pub(crate) written_mark: Box<[u64]>,
    /// A step came on or went off in this pass.
    pub(crate) stepped: bool,
    pub(crate) off: Vec<u32>,
    pub(crate) on_mark: Box<[u64]>,
    pub(crate) off_mark: Box<[u64]>,
    pub(crate) taken: Box<[u64]>,
    pub(crate) runs: Vec<u32>,
    /// Actions to run at the end of the scan, a bit each.
    pub(crate) late: Box<[u64]>,
    pub(crate) late_any: bool,
    /// Each-scan actions whose step was active before the evolution.
    pub(crate) before: Vec<u64>,
    pub(crate) blocked: Vec<bool>,
    pub(crate) any_blocked: bool,
    /// Which order acts on a chart in this pass.
    pub(crate) forced_by: Vec<u32>,
    pub(crate) due: Vec<bool>,
    /// Old values of the words an action wrote, while logging.
    pub(crate) log: Vec<(u32, u64)>,
    pub(crate) logging: bool,
    pub(crate) log_mark: Vec<u32>,
    pub(crate) serial: u32,
    pub(crate) commits: Vec<(u32, u64)>,
    pub(crate) commit_mark: Vec<u32>,
    pub(crate) pass_serial: u32,
    /// Groups that lost their last step in the change in hand, with their stamps.
    pub(crate) emptied: Vec<(u32, (u64, u64))>,
    pub(crate) changed: bool,
    pub(crate) work: u32,
    pub(crate) saved: Vec<u64>,
    pub(crate) enabled: Box<[u64]>,
    pub(crate) enabled_after: Box<[u64]>,
    pub(crate) moved: u32,
    pub(crate) active_before: u32,
    pub(crate) first_pass: bool,
    /// The latest pass cleared, imposed and ran nothing.
    pub(crate) idle: bool,
    /// Nothing can happen before an input changes or somebody writes from outside.
    pub(crate) quiet: bool,
    pub(crate) text: [Vec<u8>; 3],
    // Reports of the last scan.
    pub(crate) cleared: Vec<u32>,
    pub(crate) cleared_count: u32,
    pub(crate) ran: Vec<u32>,
    pub(crate) conflict: Option<Addr>,
    pub(crate) passes: u32,
}

/// Everything a running program remembers.
///
/// Equality and hash are those of [`State::image`].
#[derive(Debug)]
pub struct State {
    pub(crate) w: Box<[u64]>,
    pub(crate) x: Scratch,
    pub(crate) vars: u32,
    pub(crate) var_words: u32,
    pub(crate) steps: Tree,
}

impl Clone for State {
    /// A copy with the same room to work in: a scan allocates nothing, and what
    /// has no room is left out.
    fn clone(&self) -> State {
        let mut x = self.x.clone();
        x.make_room(&self.x);
        State { w: self.w.clone(), x, vars: self.vars, var_words: self.var_words, steps: self.steps }
    }
}

impl Scratch {
    /// Room in every list as another one has it.
    fn make_room(&mut self, of: &Scratch) {
        fn room<T>(to: &mut Vec<T>, of: &Vec<T>) {
            to.reserve_exact(of.capacity().saturating_sub(to.len()));
        }
        room(&mut self.stack, &of.stack);
        room(&mut self.fired, &of.fired);
        room(&mut self.slow, &of.slow);
        room(&mut self.on, &of.on);
        room(&mut self.off, &of.off);
        room(&mut self.chain, &of.chain);
        room(&mut self.left, &of.left);
        room(&mut self.came, &of.came);
        room(&mut self.turns, &of.turns);
        room(&mut self.written, &of.written);
        room(&mut self.runs, &of.runs);
        room(&mut self.log, &of.log);
        room(&mut self.commits, &of.commits);
        room(&mut self.emptied, &of.emptied);
        room(&mut self.saved, &of.saved);
        room(&mut self.cleared, &of.cleared);
        room(&mut self.ran, &of.ran);
        for (to, of) in self.text.iter_mut().zip(&of.text) {
            room(to, of);
        }
    }
}

impl PartialEq for State {
    fn eq(&self, other: &State) -> bool {
        self.w == other.w
    }
}

impl Eq for State {}

impl core::hash::Hash for State {
    fn hash<H: core::hash::Hasher>(&self, state: &mut H) {
        self.w.hash(state);
    }
}

impl State {
    /// A state before its first scan: no step is active yet (the first scan
    /// activates the initial ones), variables have their initial values.
    /// The only place that allocates.
    pub fn new(p: &Program) -> State {
        let (t, l) = (&p.t, &p.layout);
        let mut w = vec![0u64; l.len as usize].into_boxed_slice();
        let vars = l.vars as usize;
        if let Some(area) = w.get_mut(vars..vars + t.init.len()) {
            area.copy_from_slice(&t.init);
        }
        let bits = |n: usize| vec![0u64; n.div_ceil(64)].into_boxed_slice();
        let steps = t.steps.len();
        let reports = t.transitions.len().saturating_mul(2).saturating_add(64);
        let texts = if p.text_room > 0 { p.text_room } else { 0 };
        let parallel = t.rules.parallel_actions && p.stored > 0;
        let marks = if parallel { t.init.len() } else { 0 };
        let counting = t.counts.is_some();
        let x = Scratch {
            stack: Vec::with_capacity(STACK),
            fired: Vec::with_capacity(t.transitions.len()),
            lone: crate::NONE,
            slow: Vec::with_capacity(if p.bare { steps } else { 0 }),
            on: Vec::with_capacity(2 * steps),
            off: Vec::with_capacity(2 * steps),
            chain: Vec::with_capacity(if t.rules.sequential { 2 * steps + 1 } else { 0 }),
            left: Vec::with_capacity(if t.rules.sequential { 2 * steps + 1 } else { 0 }),
            came: Vec::with_capacity(if t.rules.sequential { 2 * steps + 1 } else { 0 }),
            written: Vec::with_capacity(if p.comes_and_goes { t.init.len() } else { 0 }),
            written_mark: bits(if p.comes_and_goes { t.init.len() } else { 0 }),
            turns: Vec::with_capacity(if p.looks_back { steps } else { 0 }),
            turned: bits(if p.looks_back { steps } else { 0 }),
            was: bits(if p.looks_back { steps } else { 0 }),
            on_mark: bits(steps),
            off_mark: bits(steps),
            taken: bits(steps),
            emptied: Vec::with_capacity(t.groups.len()),
            runs: Vec::with_capacity(t.actions.len() + t.events.len()),
            late: bits(t.actions.len()),
            before: vec![0; if t.rules.periodic_first { t.periodics.len().div_ceil(64) } else { 0 }],
            blocked: vec![false; t.charts.len()],
            forced_by: vec![crate::NONE; if p.has_orders { t.charts.len() } else { 0 }],
            due: vec![true; t.periods.len()],
            log: Vec::with_capacity(marks),
            log_mark: vec![0; marks],
            commits: Vec::with_capacity(if parallel { p.commit_room } else { 0 }),
            commit_mark: vec![0; marks],
            enabled: bits(if counting { t.transitions.len() } else { 0 }),
            enabled_after: bits(if counting { t.transitions.len() } else { 0 }),
            text: [Vec::with_capacity(texts), Vec::with_capacity(texts), Vec::with_capacity(2 * texts)],
            cleared: Vec::with_capacity(reports),
            ran: Vec::with_capacity(t.actions.len() + 64),
            saved: Vec::with_capacity(if t.rules.stable { l.len as usize } else { 0 }),
            ..Scratch::default()
        };
        State { w, x, vars: l.vars, var_words: t.init.len() as u32, steps: l.steps }
    }

    /// All that decides the future, as words. Its layout belongs to the program.
    pub fn image(&self) -> &[u64] {
        &self.w
    }

    /// The image as bytes, little-endian.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.w.iter().flat_map(|w| w.to_le_bytes()).collect()
    }

    /// The state that [`State::to_bytes`] gave, for the same program.
    ///
    /// `None` where the length is not that of the program's image. The bytes
    /// must come from `to_bytes`: others give a state without meaning, but
    /// never a panic.
    pub fn from_bytes(p: &Program, bytes: &[u8]) -> Option<State> {
        let mut state = State::new(p);
        if bytes.len() != state.w.len() * 8 {
            return None;
        }
        for (w, b) in state.w.iter_mut().zip(bytes.as_chunks().0) {
            *w = u64::from_le_bytes(*b);
        }
        Some(state)
    }

    /// The variable area.
    pub fn words(&self) -> &[u64] {
        let at = self.vars as usize;
        self.w.get(at..at + self.var_words as usize).unwrap_or(&[])
    }

    /// A word of the variable area, 0 where there is none.
    pub fn word(&self, addr: Addr) -> u64 {
        if addr.0 >= self.var_words { 0 } else { word(&self.w, (self.vars + addr.0) as usize) }
    }

    /// Writes a word of the variable area from outside (a forced or retained
    /// variable). Watches notice at the next scan.
    pub fn set_word(&mut self, p: &Program, addr: Addr, value: u64) {
        if addr.0 < self.var_words {
            self.x.quiet = false;
            crate::run::write(p, self, addr, value);
        }
    }

    /// Whether a step is active.
    pub fn is_active(&self, step: StepId) -> bool {
        (step.0 as usize) < self.x.on_mark.len() * 64 && self.steps.contains(&self.w, step.0)
    }

    /// The active steps, ascending.
    pub fn active(&self) -> impl Iterator<Item = StepId> + '_ {
        let mut walk = Walk::new(&self.steps, &self.w);
        core::iter::from_fn(move || walk.next(&self.steps, &self.w).map(StepId))
    }

    /// Whether a step of the group is active.
    pub fn group_active(&self, p: &Program, group: GroupId) -> bool {
        word(&self.w, p.layout.groups as usize + group.0 as usize) != 0
    }

    /// Time since the group became active in ns (scans under the scan clock).
    /// Only groups that steps count in have one.
    pub fn group_time(&self, p: &Program, group: GroupId) -> i64 {
        let stamp = word(&self.w, p.layout.group_stamps as usize + group.0 as usize) as i64;
        if self.group_active(p, group) { crate::clock(p, self).wrapping_sub(stamp) } else { stamp }
    }

    /// Time since the step's latest activation in ns (scans under the scan clock).
    pub fn step_time(&self, p: &Program, step: StepId) -> i64 {
        let stamp = word(&self.w, p.layout.stamps as usize + step.0 as usize) as i64;
        if self.is_active(step) { crate::clock(p, self).wrapping_sub(stamp) } else { stamp }
    }

    /// Time since the step's latest activation in ns, whatever the clock.
    pub fn step_age(&self, p: &Program, step: StepId) -> i64 {
        let stamp = word(&self.w, p.layout.ages as usize + step.0 as usize) as i64;
        if self.is_active(step) { self.now().wrapping_sub(stamp) } else { stamp }
    }

    /// Time since the group became active in ns, whatever the clock.
    pub fn group_age(&self, p: &Program, group: GroupId) -> i64 {
        let stamp = word(&self.w, p.layout.group_ages as usize + group.0 as usize) as i64;
        if self.group_active(p, group) { self.now().wrapping_sub(stamp) } else { stamp }
    }

    /// The output of a timer.
    pub fn timer(&self, p: &Program, watch: WatchId) -> bool {
        bit(&self.w, p.layout.q, watch.0)
    }

    /// Time of the latest scan, ns.
    pub fn now(&self) -> i64 {
        word(&self.w, head::NOW) as i64
    }

    /// Scans begun.
    pub fn scans(&self) -> u64 {
        word(&self.w, head::SCANS)
    }

    /// Whether the first scan has begun.
    pub fn is_started(&self) -> bool {
        word(&self.w, head::FLAGS) & STARTED != 0
    }

    /// Whether a fault has stopped the program.
    pub fn is_stopped(&self) -> bool {
        word(&self.w, head::FLAGS) & STOPPED != 0
    }

    /// Ranks of the transitions cleared in the latest scan, pass by pass (within
    /// a pass they clear at once, in no order); a long search may be cut.
    pub fn cleared(&self) -> &[u32] {
        &self.x.cleared
    }

    /// Actions (ranks) that ran in the latest scan; a long search may be cut.
    pub fn ran(&self) -> &[u32] {
        &self.x.ran
    }

    pub(crate) fn has_flag(&self, flag: u64) -> bool {
        word(&self.w, head::FLAGS) & flag != 0
    }

    pub(crate) fn has_only_flag(&self, flag: u64) -> bool {
        word(&self.w, head::FLAGS) == flag
    }

    pub(crate) fn flag(&mut self, flag: u64, on: bool) {
        if let Some(w) = self.w.get_mut(head::FLAGS) {
            *w = if on { *w | flag } else { *w & !flag };
        }
    }

    pub(crate) fn set(&mut self, at: usize, value: u64) {
        if let Some(w) = self.w.get_mut(at) {
            *w = value;
        }
    }
}
