//! The work in hand while a unit is lowered: the unit, the plan, the words, and the tables as far as
//! they are filled.
//!
//! `mod.rs` starts and ends it; the other files add to it, each its part of the tables. The first
//! refusal is kept, and after it nothing more is made.

use std::collections::BTreeMap;

use g7_engine::{Addr, Tables};
use g7_model::Span;

use super::emit::Buf;
use super::plan::Plan;
use super::uses::Uses;
use super::watched::Watches;
use super::words::Words;
use crate::ir::{StepId, Unit, VarId};
use crate::tree::Piece;

/// Why a unit that is right in itself does not become a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// It would be too large.
    Large,
    /// Something is nested too deeply.
    Deep,
}

/// `FREEZECHART`: what the call writes, and what holds back the transitions
/// from the service point on.
#[derive(Clone, Copy)]
pub(super) struct Freeze {
    pub(super) asked: Addr,
    pub(super) holds: Addr,
}

/// The work in hand.
pub(super) struct Lower<'a> {
    pub(super) unit: &'a Unit,
    pub(super) uses: Uses<'a>,
    pub(super) plan: Plan,
    pub(super) words: Words,
    pub(super) t: Tables,
    /// Beside `t.code`.
    pub(super) places: Vec<Span>,
    pub(super) watches: Watches,
    /// A buffer for instructions, to be used again.
    pub(super) buf: Buf,
    /// The tree of each piece of code, by its first instruction, ascending.
    pub(super) pieces: Vec<(u32, Piece)>,
    /// Nodes of all trees made so far.
    pub(super) nodes: usize,
    /// The first word that is set anew at each run.
    pub(super) locals: u32,
    /// Nesting of the expression or statement in hand.
    pub(super) depth: u32,
    pub(super) refused: Option<(Refusal, Span)>,
    /// The generator's word.
    pub(super) random: Option<Addr>,
    /// While TRUE no transition clears: what `%S23` says at the service point.
    pub(super) stop_all: Option<Addr>,
    /// The words of `%S0` and `%S1`, or what stands for them.
    pub(super) restarts: Option<(Addr, Addr)>,
    /// TRUE until the first service point is over; where system bits act on charts.
    pub(super) fresh: Option<Addr>,
    /// By chart: its period's row.
    pub(super) periods: Vec<u32>,
    /// By chart: the steps that enable it.
    pub(super) enabling: Vec<Vec<StepId>>,
    /// By chart: the steps that mask it.
    pub(super) masked_charts: Vec<Vec<StepId>>,
    pub(super) masked_vars: BTreeMap<VarId, Vec<StepId>>,
    /// By task: the steps that call it, in text order.
    pub(super) callers: Vec<Vec<StepId>>,
    /// By task: the word with the number (from 1) of the caller it works for.
    /// Empty where there is no task.
    pub(super) owners: Vec<Option<Addr>>,
    pub(super) freezes: Vec<Option<Freeze>>,
    /// The output of the section in hand and where it is worked out.
    pub(super) section: Option<(VarId, Addr)>,
    /// Some chart is enabled, frozen or can be stopped.
    pub(super) has_blockers: bool,
    pub(super) has_masks: bool,
}

impl Lower<'_> {
    pub(super) fn refuse(&mut self, why: Refusal, at: Span) {
        self.refused.get_or_insert((why, at));
    }

    /// True if a step of the program stands for a macro-step.
    pub(super) fn is_pseudo(&self, number: u32) -> bool {
        let source = self.plan.source.get(number as usize);
        source.and_then(|id| self.plan.pseudo(*id)).is_some_and(|p| p.0 == number)
    }
}
