//! The rows by which control blocks are evaluated (`blocks.rs`), made as a program is loaded.

use alloc::boxed::Box;
use alloc::vec;

use crate::block_words::{MEMORY, N, R, S};
use crate::layout::Layout;
use crate::tables::{ControlBlock, NONE, Tables};

/// The inputs of a latch: N, S and R.
const LATCH: u16 = 1 << N | 1 << S | 1 << R;

/// A control block, as it is evaluated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// Its first word in the image.
    pub(crate) at: u32,
    /// The variable of its Q, or `NONE`.
    pub(crate) output: u32,
    /// The inputs that contributions name, a bit each.
    pub(crate) uses: u16,
    pub(crate) kind: Kind,
    /// It has neither a gate nor a body, and is evaluated in every scan.
    pub(crate) bare: bool,
}

/// How a block is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// By the count of its inputs N.
    Plain,
    /// By N, S and R.
    Latch,
    /// By all inputs.
    Full,
}

impl Row {
    /// The word whose bit [`WRITTEN`] is the Q written last.
    pub(crate) fn written(&self) -> usize {
        (self.at + if self.kind == Kind::Plain { 0 } else { MEMORY }) as usize
    }

    /// A row for each block.
    #[inline(never)]
    pub(crate) fn all(t: &Tables, l: &Layout) -> Box<[Row]> {
        let mut uses = vec![0u16; t.blocks.len()];
        for c in &t.contributions {
            uses.get_mut(c.block as usize).into_iter().for_each(|u| *u |= 1 << c.input);
        }
        let row = |((b, at), uses): ((&ControlBlock, &u32), u16)| {
            let kind = match uses {
                _ if b.plain => Kind::Plain,
                uses if uses & !LATCH == 0 => Kind::Latch,
                _ => Kind::Full,
            };
            let bare = b.gate.is_empty() && b.action == NONE && t.periods.get(b.period as usize) == Some(&0);
            Row { at: *at, output: b.output.0, uses, kind, bare }
        };
        t.blocks.iter().zip(l.block_at.iter()).zip(uses).map(row).collect()
    }
}
