//! The space that a scan works in.
//!
//! Nothing in it carries anything from one scan to the next, except the reports of
//! the latest scan and notes that save time ([`Scratch::quiet`],
//! [`Scratch::lone`], [`Scratch::rest`] and [`Scratch::timers_due`]), without which the next scan has the same result.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use crate::ops::Addr;
use crate::program::Program;
use crate::sleepers::Rest;
use crate::stack::Stack;
use crate::tables::NONE;

/// All lists have their room from the start, so that a scan never allocates.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    /// The stack of running code.
    pub(crate) stack: Stack,
    /// Transitions (rank) that clear in this pass.
    pub(crate) fired: Vec<u32>,
    /// The only active step, where that is known; else `NONE` (`moves`).
    pub(crate) lone: u32,
    /// Active steps whose transitions need a closer look (`moves`).
    pub(crate) slow: Vec<u32>,
    /// Steps that a pass need not look at (`sleepers`).
    pub(crate) rest: Rest,
    /// Steps marked to be activated, and to be deactivated.
    pub(crate) on: Vec<u32>,
    pub(crate) off: Vec<u32>,
    /// The same, a bit for each step.
    pub(crate) on_mark: Box<[u64]>,
    pub(crate) off_mark: Box<[u64]>,
    /// Preceding steps that a transition of better rank has taken, a bit each.
    pub(crate) taken: Box<[u64]>,
    /// Steps that follow one another through enclosures (`sequential`).
    pub(crate) chain: Vec<u32>,
    /// Enclosing steps left in this pass, and those entered (`sequential`).
    pub(crate) left: Vec<u32>,
    pub(crate) entered: Vec<u32>,
    /// Steps that changed in this pass, a list and a bit each, and whether they
    /// were active as the pass began; kept where some code reads
    /// [`crate::Op::WasActive`].
    pub(crate) turns: Vec<u32>,
    pub(crate) turned: Box<[u64]>,
    pub(crate) was: Box<[u64]>,
    /// Words written in this pass with their values as it began, and a bit each;
    /// kept where they may change and change back within a pass.
    pub(crate) written: Vec<(u32, u64)>,
    pub(crate) written_mark: Box<[u64]>,
    /// A step was activated or deactivated in this pass.
    pub(crate) stepped: bool,
    /// Actions (rank) to run in this pass.
    pub(crate) runs: Vec<u32>,
    /// Actions (rank) to run at the end of the scan, a bit each.
    pub(crate) late: Box<[u64]>,
    pub(crate) late_any: bool,
    /// Actions of each scan whose step was active before the evolution.
    pub(crate) before: Vec<u64>,
    /// Charts that stand still in this pass.
    pub(crate) blocked: Vec<bool>,
    pub(crate) any_blocked: bool,
    /// For each chart, the order (row) that acts on it in this pass, or `NONE`.
    pub(crate) forced_by: Vec<u32>,
    /// Periods that are due in this scan.
    pub(crate) due: Vec<bool>,
    /// Old values of the words that an action wrote, while `logging`.
    pub(crate) log: Vec<(u32, u64)>,
    pub(crate) logging: bool,
    /// For each word, the `serial` of the latest action that logged it.
    pub(crate) log_mark: Vec<u32>,
    pub(crate) serial: u32,
    /// Words that parallel actions give with their new values.
    pub(crate) commits: Vec<(u32, u64)>,
    /// For each word, the `pass_serial` of the latest pass that committed it.
    pub(crate) commit_mark: Vec<u32>,
    pub(crate) pass_serial: u32,
    /// Groups that lost their last step in the change in hand, with their stamp
    /// and age.
    pub(crate) emptied: Vec<(u32, (u64, u64))>,
    /// This pass changed a step or a variable.
    pub(crate) changed: bool,
    /// Code has run since the locals were cleared, so that they may be set.
    pub(crate) worked: bool,
    /// Jumps made in this scan.
    pub(crate) work: u32,
    /// The image that the search for a cycle compares with.
    pub(crate) saved: Vec<u64>,
    /// Transitions enabled before and after the evolution, a bit each, for `%SW21`.
    pub(crate) enabled: Box<[u64]>,
    pub(crate) enabled_after: Box<[u64]>,
    /// Activations and deactivations in this scan, and steps active before, for
    /// `%SW20`.
    pub(crate) moved: u32,
    pub(crate) active_before: u32,
    /// The next pass is the first one of its scan.
    pub(crate) first_pass: bool,
    /// The latest pass cleared, imposed and ran nothing.
    pub(crate) idle: bool,
    /// Nothing can happen before an input changes or a caller writes to the state.
    pub(crate) quiet: bool,
    /// Before this instant, in ns, no timer of a control block ends.
    pub(crate) timers_due: i64,
    /// Buffers for two operands and the result of string functions.
    pub(crate) text: [Vec<u8>; 3],
    /// Reports of the latest scan: transitions cleared, as far as there is room,
    /// and their number.
    pub(crate) cleared: Vec<u32>,
    pub(crate) cleared_count: u32,
    /// Actions that ran, as far as there is room.
    pub(crate) ran: Vec<u32>,
    /// The first word that parallel actions gave different values.
    pub(crate) conflict: Option<Addr>,
    /// Passes made.
    pub(crate) passes: u32,
}

impl Scratch {
    pub(crate) fn new(p: &Program) -> Scratch {
        let t = &p.tables;
        let bits = |n: usize| vec![0u64; n.div_ceil(64)].into_boxed_slice();
        let steps = t.steps.len();
        let reports = t.transitions.len().saturating_mul(2).saturating_add(64);
        let parallel = t.rules.parallel_actions && p.stored > 0;
        let marks = if parallel { t.init.len() } else { 0 };
        let in_turn = if t.rules.sequential { 2 * steps + 1 } else { 0 };
        let compared = if p.comes_and_goes { t.init.len() } else { 0 };
        let looked_back = if p.looks_back { steps } else { 0 };
        let counted = if t.counts.is_some() { t.transitions.len() } else { 0 };
        Scratch {
            fired: Vec::with_capacity(t.transitions.len()),
            lone: NONE,
            timers_due: i64::MIN,
            worked: true,
            slow: Vec::with_capacity(steps),
            rest: p.sleepers.rest(),
            on: Vec::with_capacity(2 * steps),
            off: Vec::with_capacity(2 * steps),
            on_mark: bits(steps),
            off_mark: bits(steps),
            taken: bits(steps),
            chain: Vec::with_capacity(in_turn),
            left: Vec::with_capacity(in_turn),
            entered: Vec::with_capacity(in_turn),
            turns: Vec::with_capacity(looked_back),
            turned: bits(looked_back),
            was: bits(looked_back),
            written: Vec::with_capacity(compared),
            written_mark: bits(compared),
            runs: Vec::with_capacity(t.actions.len() + t.events.len()),
            late: bits(t.actions.len()),
            before: vec![0; if t.rules.periodic_first { t.periodics.len().div_ceil(64) } else { 0 }],
            blocked: vec![false; t.charts.len()],
            forced_by: vec![NONE; if p.has_orders { t.charts.len() } else { 0 }],
            due: vec![true; t.periods.len()],
            log: Vec::with_capacity(marks),
            log_mark: vec![0; marks],
            commits: Vec::with_capacity(if parallel { p.commit_room } else { 0 }),
            commit_mark: vec![0; marks],
            emptied: Vec::with_capacity(t.groups.len()),
            saved: Vec::with_capacity(if t.rules.stable { p.layout.len as usize } else { 0 }),
            enabled: bits(counted),
            enabled_after: bits(counted),
            text: [
                Vec::with_capacity(p.text_room),
                Vec::with_capacity(p.text_room),
                Vec::with_capacity(2 * p.text_room),
            ],
            cleared: Vec::with_capacity(reports),
            ran: Vec::with_capacity(t.actions.len() + 64),
            ..Scratch::default()
        }
    }

    /// Gives every list the room that it has in another scratch.
    pub(crate) fn make_room(&mut self, of: &Scratch) {
        fn room<T>(to: &mut Vec<T>, of: &Vec<T>) {
            to.reserve_exact(of.capacity().saturating_sub(to.len()));
        }
        room(&mut self.fired, &of.fired);
        room(&mut self.slow, &of.slow);
        room(&mut self.on, &of.on);
        room(&mut self.off, &of.off);
        room(&mut self.chain, &of.chain);
        room(&mut self.left, &of.left);
        room(&mut self.entered, &of.entered);
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

    /// Forgets the scan before, as a scan begins.
    pub(crate) fn begin(&mut self) {
        self.stack.clear();
        self.fired.clear();
        self.runs.clear();
        self.commits.clear();
        self.cleared.clear();
        self.ran.clear();
        self.log.clear();
        self.logging = false;
        self.cleared_count = 0;
        self.passes = 0;
        self.conflict = None;
        self.work = 0;
        self.late_any = false;
    }

    /// Forgets the reports of the scan before, as a scan begins in which nothing is awake.
    #[inline(always)]
    pub(crate) fn begin_brisk(&mut self) {
        self.cleared.clear();
        self.ran.clear();
    }

    /// Makes ready for the passes of such a scan, of which `made` were made, each with one transition
    /// cleared. What is not mentioned was left as it must be by the scan before.
    #[inline(always)]
    pub(crate) fn begin_passes(&mut self, made: u32) {
        self.stack.clear();
        self.runs.clear();
        self.commits.clear();
        self.passes = made;
        self.cleared_count = made;
        self.conflict = None;
        self.work = 0;
        // Watches have nothing to look at before the first pass.
        self.first_pass = true;
    }

    /// Drops the changes of steps and the late actions that a scan had in hand when
    /// it was broken off.
    pub(crate) fn drop_marks(&mut self) {
        self.on_mark.fill(0);
        self.off_mark.fill(0);
        self.on.clear();
        self.off.clear();
        self.late.fill(0);
    }

    /// Forgets all, as for a new state.
    pub(crate) fn reset(&mut self) {
        self.begin();
        self.drop_marks();
        self.quiet = false;
        self.worked = true;
        self.lone = NONE;
        self.rest.end();
        self.timers_due = i64::MIN;
        self.first_pass = false;
        self.any_blocked = false;
    }
}
