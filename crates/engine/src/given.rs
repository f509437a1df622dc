//! Contributions that are given as long as their step is active: without a condition, and with a
//! constant time if the input has one.
//!
//! These are counted as the step is activated and deactivated (`change.rs`, `moves.rs`). All others are
//! counted at the end of a scan, after their conditions and times were evaluated (`blocks.rs`).

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use crate::block_words::{TIMED, TIMES};
use crate::layout::Layout;
use crate::ops::Op;
use crate::tables::{Contribution, Extra, NONE, Rows, Tables};

/// For each row of [`Tables::contributions`] the contribution, if it is given.
#[derive(Clone, Debug, Default)]
pub(crate) struct Given {
    rows: Box<[Option<Contributes>]>,
}

/// A given contribution.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contributes {
    /// The word of the image that counts the contributions to the input.
    pub(crate) count: u32,
    pub(crate) block: u32,
    /// The word of the image that has the time of the input, and the time in ns; `NONE` and 0 for an
    /// input without a time, and for the time 0.
    pub(crate) timer: u32,
    pub(crate) time: u64,
}

impl Given {
    #[inline(never)]
    pub(crate) fn new(t: &Tables, l: &Layout) -> Given {
        // The time of each input of each block: the same in all contributions, or none.
        let mut times = vec![Times::default(); t.blocks.len()];
        for c in &t.contributions {
            let Some(k) = TIMED.iter().position(|input| *input == u32::from(c.input)) else { continue };
            let Some(of) = times.get_mut(c.block as usize).and_then(|times| times.get_mut(k)) else {
                continue;
            };
            let time = constant(t, c);
            *of = match of {
                None => Some(time),
                Some(other) if *other == time => Some(time),
                Some(_) => Some(None),
            };
        }
        let row = |c: &Contribution| {
            if !c.condition.is_empty() {
                return None;
            }
            let at = *l.block_at.get(c.block as usize)?;
            let plain = t.blocks.get(c.block as usize)?.plain;
            let count = at + if plain { 0 } else { u32::from(c.input) };
            let mut row = Contributes { count, block: c.block, timer: NONE, time: 0 };
            if !c.time.is_empty() {
                let k = TIMED.iter().position(|input| *input == u32::from(c.input))?;
                row.time = times.get(c.block as usize)?.get(k)?.flatten().filter(|_| c.period == 0)?;
                // A timer has the time 0 from the start.
                row.timer = if row.time == 0 { NONE } else { at + TIMES + k as u32 };
            }
            Some(row)
        };
        Given { rows: t.contributions.iter().map(row).collect::<Vec<_>>().into() }
    }

    /// A contribution, if it is given.
    #[inline(always)]
    pub(crate) fn of(&self, row: u32) -> Option<&Contributes> {
        self.rows.get(row as usize)?.as_ref()
    }

    /// True if all of these contributions are given, and there are some.
    pub(crate) fn all(&self, rows: Rows) -> bool {
        let Rows { start, end } = rows;
        let some = self.rows.get(start as usize..end as usize).unwrap_or(&[]);
        !some.is_empty() && some.iter().all(Option::is_some)
    }

    /// True if nothing but given contributions follows a step with this row.
    pub(crate) fn alone(&self, e: &Extra) -> bool {
        nothing_else(e) && self.all(e.contributions)
    }
}

/// For each timed input of a block its constant time, if all contributions to it have this one.
type Times = [Option<Option<u64>>; TIMED.len()];

/// The time of a contribution, where it is a constant.
fn constant(t: &Tables, c: &Contribution) -> Option<u64> {
    match t.code.get(c.time.start as usize..c.time.end as usize)? {
        [Op::Push(time)] => Some(*time),
        _ => None,
    }
}

/// True if nothing but its contributions follows a step with this row.
pub(crate) fn nothing_else(e: &Extra) -> bool {
    let lists = [e.on, e.off, e.events, e.periodics, e.groups, e.orders, e.encloses, e.links, e.watches];
    !e.uncounted && lists.into_iter().all(Rows::is_empty)
}
