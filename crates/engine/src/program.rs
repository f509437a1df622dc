//! The compiled chart: tables that are known to be sound, with what a scan wants
//! to know of them beforehand.

use alloc::boxed::Box;
use alloc::vec::Vec;

use crate::block_rows::Row;
use crate::check::{LoadError, check, writes};
use crate::clocks::{Clocks, clocks};
use crate::decision::Decisions;
use crate::fingerprint::fingerprint;
use crate::gates::{Gates, can_tag};
use crate::given::Given;
use crate::joined::Joined;
use crate::layout::Layout;
use crate::ops::{Op, TEXT};
use crate::rows::{Hot, Move, Parts};
use crate::rules::PATIENCE;
use crate::sleepers::Sleepers;
use crate::tables::{Extra, NONE, Receptivity, Tables};

/// A checked, immutable compiled chart. Only [`Program::new`] makes one.
#[derive(Clone, Debug)]
pub struct Program {
    pub(crate) tables: Tables,
    pub(crate) layout: Layout,
    /// The same for equal tables, and different for most others.
    pub(crate) fingerprint: u64,
    /// For each word, where its watches begin in `word_watches`; one more at the end.
    pub(crate) word_index: Box<[u32]>,
    /// There are forcing orders.
    pub(crate) has_orders: bool,
    /// Some code asks for the situation as the pass began.
    pub(crate) looks_back: bool,
    /// First word of the locals, or a place past all words.
    pub(crate) locals: u32,
    /// Within a pass of a search for stability a variable can change and change back.
    pub(crate) comes_and_goes: bool,
    /// Some step encloses a group or has an activation link.
    pub(crate) has_hierarchy: bool,
    /// Some chart or action does not run in every scan.
    pub(crate) has_periods: bool,
    /// Some transitions share a preceding step and are not settled by their place.
    pub(crate) has_contests: bool,
    /// No receptivity writes a variable, so they may be judged in any order.
    pub(crate) judges_freely: bool,
    /// Where nothing is awake and no watched input changes, a scan begins with its passes.
    pub(crate) brisk: bool,
    /// Some watch reads an input.
    pub(crate) watches_inputs: bool,
    /// The top words of the sets whose members act in a pass or at its end.
    pub(crate) awake: Box<[u32]>,
    /// No code reads a time, and no code runs in every scan.
    pub(crate) timeless: bool,
    /// There is PRE, POST or code for system bits.
    pub(crate) frame: bool,
    /// Number of references to stored actions.
    pub(crate) stored: usize,
    /// Most words that the stored actions of one pass can write.
    pub(crate) commit_room: usize,
    /// Room for one string at work, in bytes; 0 where there are none.
    pub(crate) text_room: usize,
    /// A row for each control block.
    pub(crate) blocks: Box<[Row]>,
    /// The contributions that are given as long as their step is active.
    pub(crate) given: Given,
    /// A row for each step.
    pub(crate) hot: Box<[Hot]>,
    /// A row for each transition.
    pub(crate) moves: Box<[Move]>,
    /// The steps that a pass need not look at while what they wait for stays as it is.
    pub(crate) sleepers: Sleepers,
    /// All transitions are plain.
    pub(crate) all_plain: bool,
    /// Moves of a token may change the inputs of control blocks.
    pub(crate) counted: bool,
    /// Watches that are evaluated in every scan.
    pub(crate) always: Box<[u32]>,
    /// The words of the image that hold times.
    pub(crate) clocks: Clocks,
    /// The outputs that follow a step under a condition without a control block.
    pub(crate) gates: Gates,
    /// The code that is evaluated as tests.
    pub(crate) decisions: Decisions,
    /// The steps in which other code runs.
    pub(crate) joined: Joined,
}

impl Program {
    /// Checks tables and makes them a program.
    ///
    /// # Errors
    ///
    /// [`LoadError`] names the first bad row or instruction.
    pub fn new(tables: Tables) -> Result<Program, LoadError> {
        check(&tables)?;
        Ok(Program::build(tables))
    }

    /// The tables.
    pub fn tables(&self) -> &Tables {
        &self.tables
    }

    /// The row of what follows a step, if it has one.
    #[inline(always)]
    pub(crate) fn extra(&self, step: u32) -> Option<&Extra> {
        let row = self.tables.steps.get(step as usize)?.extra;
        if row == NONE { None } else { self.tables.extras.get(row as usize) }
    }

    #[inline(never)]
    fn build(t: Tables) -> Program {
        let layout = Layout::new(&t);
        let always = t.watches.iter().enumerate().filter(|(_, w)| w.always).map(|(i, _)| i as u32).collect();
        let stored = t.action_lists.len()
            + t.events.len()
            + t.transitions.iter().filter(|t| t.on_clearing != NONE).count();
        let frame = [t.pre, t.services, t.post, t.tail].iter().any(|c| !c.is_empty());
        let has_hierarchy = t.extras.iter().any(|e| !e.encloses.is_empty() || !e.links.is_empty());
        let has_periods = t.periods.iter().any(|p| *p > 0);
        let single = !t.rules.multi_token;
        let contest = |t: &crate::tables::Transition| {
            t.shares && !(single && t.simple) && (single || t.priority != NONE)
        };
        let decisions = Decisions::new(&t, &layout);
        let looks_back = t.code.iter().any(|op| matches!(op, Op::WasActive(_)));
        let counts = t.counts.is_some() || t.limits.is_some();
        // Steps under the scan clock count from a scan that is not over yet.
        let plain = !t.rules.sequential && !t.rules.scan_clock && !looks_back && !counts;
        let tags = plain && !has_periods && can_tag(&t, &layout);
        let gates = match tags {
            true => Gates::new(&t, &layout, &decisions),
            false => Gates::default(),
        };
        let given = Given::new(&t, &layout);
        let parts = Parts { t: &t, l: &layout, gates: &gates, given: &given, tags };
        let moves = parts.moves(plain);
        let hot = parts.hot(&decisions, &moves);
        let judges_freely = t.transitions.iter().all(|tr| !writes_in(&t, tr.receptivity));
        let calm = !frame && !has_periods && !counts && t.sources.is_empty();
        Program {
            judges_freely,
            sleepers: if judges_freely { Sleepers::new(&t, &hot) } else { Sleepers::default() },
            brisk: plain
                && calm
                && !t.rules.periodic_first
                && t.rules.bound > PATIENCE
                && !t.watches.iter().any(|w| w.always),
            watches_inputs: t.word_watches.iter().any(|(a, _)| (t.inputs.start..t.inputs.end).contains(&a.0)),
            awake: layout.awake(&t),
            blocks: Row::all(&t, &layout),
            hot,
            all_plain: moves.iter().all(|m| m.plain),
            counted: tags && t.extras.iter().any(|e| given.alone(e)),
            moves,
            timeless: !frame
                && !has_periods
                && t.counts.is_none()
                && t.limits.is_none()
                && !t.code.iter().any(reads_time),
            frame,
            locals: if t.locals.is_empty() { u32::MAX } else { t.locals.start },
            comes_and_goes: t.rules.stable && (t.rules.sequential || !t.rules.parallel_actions),
            looks_back,
            has_orders: !t.orders.is_empty(),
            has_hierarchy,
            has_periods,
            has_contests: t.transitions.iter().any(contest),
            stored,
            commit_room: commit_room(&t),
            text_room: text_room(&t.code),
            always,
            word_index: word_index(&t),
            clocks: clocks(&t, &layout),
            gates,
            given,
            decisions,
            joined: Joined::new(&t, &layout),
            fingerprint: fingerprint(&t),
            layout,
            tables: t,
        }
    }
}

/// True if a receptivity writes a variable.
fn writes_in(t: &Tables, receptivity: Receptivity) -> bool {
    let Receptivity::Code(code) = receptivity else { return false };
    let ops = t.code.get(code.start as usize..code.end as usize).unwrap_or(&[]);
    ops.iter().any(|op| writes(op) > 0)
}

fn reads_time(op: &Op) -> bool {
    matches!(
        op,
        Op::StepTime(_)
            | Op::StepTenths(_)
            | Op::GroupTime(_)
            | Op::StepAge(_)
            | Op::GroupAge(_)
            | Op::ScanTime
            | Op::Random(_)
            | Op::Fb(..)
    )
}

#[inline(never)]
fn word_index(t: &Tables) -> Box<[u32]> {
    let mut k = 0u32;
    let mut index = Vec::with_capacity(t.init.len() + 1);
    for word in 0..=t.init.len() as u32 {
        while t.word_watches.get(k as usize).is_some_and(|(a, _)| a.0 < word) {
            k += 1;
        }
        index.push(k);
    }
    index.into_boxed_slice()
}

/// Distinct words that each stored action can write, added up.
#[inline(never)]
fn commit_room(t: &Tables) -> usize {
    let lists = t.action_lists.iter().copied();
    let events = t.events.iter().map(|e| e.action);
    let clearings = t.transitions.iter().map(|t| t.on_clearing).filter(|a| *a != NONE);
    lists
        .chain(events)
        .chain(clearings)
        .filter_map(|a| t.actions.get(a as usize))
        .map(|a| {
            let code = t.code.get(a.body.start as usize..a.body.end as usize).unwrap_or(&[]);
            let condition = t.code.get(a.condition.start as usize..a.condition.end as usize).unwrap_or(&[]);
            code.iter().chain(condition).map(writes).sum::<usize>()
        })
        .fold(0, usize::saturating_add)
}

#[inline(never)]
fn text_room(code: &[Op]) -> usize {
    let any = code.iter().any(|op| {
        matches!(
            op,
            Op::StoreText { .. } | Op::Text { .. } | Op::ToText { .. } | Op::FromText(_) | Op::CompareText(_)
        )
    });
    if any { usize::from(TEXT) } else { 0 }
}
