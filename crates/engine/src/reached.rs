//! Finds the instructions that read or write a word of the variable area, for `clocks.rs` and `times.rs`.
//! An instruction *reaches* the words that it reads or writes.
//!
//! The two ask this for each timer, and a large machine has hundreds of timers and thousands of instructions.
//! So the index is made in one pass over the code.

use alloc::vec;
use alloc::vec::Vec;

use crate::bits::{bit, set_bit};
use crate::check::writes;
use crate::ops::{Addr, Op};
use crate::tables::{Receptivity, Rows, Tables};

/// Most words that an instruction of [`Reached::near`] reaches; no control block has more.
const NEAR: u32 = 16;

/// An index of the words that are read and written.
pub(crate) struct Reached {
    /// The instructions that reach few words: the first word and the place of the instruction, ascending.
    near: Vec<(u32, u32)>,
    /// The longer ranges that instructions reach: first word, length, true if the range is written, the place of one
    /// such instruction.
    wide: Vec<(u32, u32, bool, u32)>,
    /// The words that are inputs, outputs or locals, or follow a step or a block, a bit each.
    tied: Vec<u64>,
    /// The words that some receptivity consists of, a bit each.
    guards: Vec<u64>,
}

impl Reached {
    pub(crate) fn new(t: &Tables) -> Reached {
        let (mut near, mut wide) = (Vec::new(), Vec::new());
        for (pc, op) in (0u32..).zip(&t.code) {
            match range(op) {
                Some((_, 0)) | None => {}
                Some((first, len)) if len <= NEAR => near.push((first, pc)),
                Some((first, len)) => wide.push((first, len, writes(op) > 0, pc)),
            }
        }
        near.sort_unstable();
        wide.sort_unstable();
        wide.dedup_by_key(|w| (w.0, w.1, w.2));
        Reached { near, wide, tied: tied(t), guards: guards(t) }
    }

    /// The places of all instructions that may reach a word; the caller checks each. Of several that read the same long
    /// range, or write it, only one is given.
    pub(crate) fn places(&self, word: u32) -> impl Iterator<Item = usize> + '_ {
        let from = self.near.partition_point(|(first, _)| first.saturating_add(NEAR) <= word);
        let near = self.near.get(from..).unwrap_or(&[]).iter().take_while(move |(first, _)| *first <= word);
        let covers = move |w: &&(u32, u32, bool, u32)| (w.0..w.0.saturating_add(w.1)).contains(&word);
        let wide = self.wide.iter().filter(covers);
        near.map(|n| n.1 as usize).chain(wide.map(|w| w.3 as usize))
    }

    /// True if a word is an input, an output or a local, or follows a step or a block.
    pub(crate) fn is_tied(&self, word: u32) -> bool {
        bit(&self.tied, 0, word)
    }

    /// True if some receptivity is this word, or its complement, and nothing else.
    pub(crate) fn is_guard(&self, word: u32) -> bool {
        bit(&self.guards, 0, word)
    }
}

/// The words that an instruction reads or writes: the first of them, and their number.
fn range(op: &Op) -> Option<(u32, u32)> {
    let first = match *op {
        Op::Load(a) => return Some((a.0, 1)),
        Op::LoadAt { base, len } => return Some((base.0, len)),
        Op::Store(a) | Op::Random(a) | Op::Fb(_, a) => a,
        Op::StoreAt { base, .. } => base,
        Op::StoreText { to, .. } | Op::Text { to, .. } | Op::ToText { to, .. } => to,
        _ => return None,
    };
    Some((first.0, writes(op) as u32))
}

/// True if an instruction can write a word of the variable area.
pub(crate) fn does_write(op: &Op, word: u32) -> bool {
    let within = |(first, len): (u32, u32)| (first..first.saturating_add(len)).contains(&word);
    writes(op) > 0 && range(op).is_some_and(within)
}

fn tied(t: &Tables) -> Vec<u64> {
    let within = |r: Rows| r.start..r.end;
    let counts = t.counts.map(|(a, b)| [a, b]).into_iter().flatten().chain(t.limits.map(|l| l.0));
    let follow = t.steps.iter().map(|s| s.direct).chain(t.blocks.iter().map(|b| b.output));
    let words = within(t.inputs).chain(within(t.outputs)).chain(within(t.locals));
    marked(t, words.chain(follow.chain(counts).map(|a| a.0)))
}

fn guards(t: &Tables) -> Vec<u64> {
    let word = |receptivity| match receptivity {
        Receptivity::Word(Addr(a)) | Receptivity::NotWord(Addr(a)) => Some(a),
        Receptivity::True | Receptivity::Code(_) => None,
    };
    marked(t, t.transitions.iter().filter_map(|t| word(t.receptivity)))
}

/// A bit for each word of the variable area; [`crate::tables::NONE`] is none of them.
fn marked(t: &Tables, words: impl Iterator<Item = u32>) -> Vec<u64> {
    let mut marked = vec![0; t.init.len().div_ceil(64)];
    for word in words {
        set_bit(&mut marked, 0, word, true);
    }
    marked
}
