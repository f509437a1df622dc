//! Gates: outputs that follow one step alone, under a condition (in IEC 60848 the
//! assignation condition of a continuous action).
//!
//! Such an output needs no control block: after the evolution it takes the value of the condition
//! while its step is active (`blocks.rs` does the same for all others), and as its step is
//! deactivated it becomes FALSE. The latter comes earlier in the scan than with a block, so no code
//! may read the output. The bit of the contribution in [`Layout::counted`] is the value written
//! last: between two changes others may write the variable.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use crate::bits::{Walk, set_bit, word};
use crate::block_words::N;
use crate::check::writes;
use crate::decision::Decisions;
use crate::given::nothing_else;
use crate::layout::Layout;
use crate::ops::{Addr, Op, TEXT};
use crate::tables::{Contribution, Extra, NONE, Receptivity, Rows, Tables};

/// In place of an output in [`crate::rows::Shift`]: the rest is a row of
/// [`Tables::contributions`]. No image is so long.
pub(crate) const GATE: u32 = 1 << 31;
/// Likewise: the rest is a step whose contributions are counted.
pub(crate) const COUNTED: u32 = GATE | 1 << 30;

/// True if rows, steps and words of the image can be told apart by these bits.
pub(crate) fn can_tag(t: &Tables, l: &Layout) -> bool {
    let most = (!COUNTED) as usize;
    l.len < GATE && t.steps.len() < most && t.contributions.len() < most
}

#[derive(Clone, Copy, Debug)]
struct Gate {
    condition: Condition,
    /// Word of the image.
    output: u32,
    /// Row of [`Tables::contributions`].
    row: u32,
}

/// The condition of a gate.
#[derive(Clone, Copy, Debug)]
enum Condition {
    /// `on` says whether it is TRUE where one of these bits of a word of the image is set.
    Bits { at: u32, mask: u64, on: bool },
    /// The first test of a decision.
    Tests(u32),
}

/// The gates of a program.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gates {
    /// In the order of the steps.
    list: Box<[Gate]>,
    /// Where the gates of each step begin in the list; one more at the end.
    of_step: Box<[u32]>,
    /// The output of each contribution that is a gate, as a word of the image; else `NONE`.
    outputs: Box<[u32]>,
    /// The control blocks that gates stand for.
    blocks: Box<[bool]>,
}

impl Gates {
    /// Finds the gates of a program.
    #[inline(never)]
    pub(crate) fn new(t: &Tables, l: &Layout, d: &Decisions) -> Gates {
        let used = used(t);
        let mut givers = vec![0u32; t.blocks.len()];
        for c in &t.contributions {
            givers.get_mut(c.block as usize).into_iter().for_each(|n| *n += 1);
        }
        let gate = |row: u32, c: &Contribution| {
            let block = t.blocks.get(c.block as usize)?;
            let fits = u32::from(c.input) == N
                && c.time.is_empty()
                && c.period == 0
                && block.period == 0
                && block.plain
                && block.gate.is_empty()
                && block.action == NONE
                && givers.get(c.block as usize) == Some(&1)
                && used.get(block.output.0 as usize) == Some(&false);
            let condition = d.of(c.condition);
            let condition = Some(condition).filter(|first| fits && *first != NONE)?;
            let condition = match d.single(condition) {
                Some((at, mask, on)) => Condition::Bits { at, mask, on },
                None => Condition::Tests(condition),
            };
            Some(Gate { condition, output: l.vars + block.output.0, row })
        };
        let (mut list, mut of_step) = (Vec::new(), Vec::with_capacity(t.steps.len() + 1));
        let mut outputs = vec![NONE; t.contributions.len()];
        let mut blocks = vec![false; t.blocks.len()];
        for step in &t.steps {
            of_step.push(list.len() as u32);
            let Some(e) = t.extras.get(step.extra as usize) else { continue };
            for row in e.contributions.start..e.contributions.end {
                let Some(c) = t.contributions.get(row as usize) else { break };
                if let Some(gate) = gate(row, c)
                    && let Some(output) = outputs.get_mut(row as usize).filter(|o| **o == NONE)
                    && let Some(block) = blocks.get_mut(c.block as usize)
                {
                    (*output, *block) = (gate.output, true);
                    list.push(gate);
                }
            }
        }
        of_step.push(list.len() as u32);
        Gates { list: list.into(), of_step: of_step.into(), outputs: outputs.into(), blocks: blocks.into() }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// True if a contribution is a gate.
    #[inline(always)]
    pub(crate) fn has(&self, row: u32) -> bool {
        self.outputs.get(row as usize).is_some_and(|output| *output != NONE)
    }

    /// True if a gate stands for a control block, which then takes no part.
    pub(crate) fn stands_for(&self, block: u32) -> bool {
        self.blocks.get(block as usize).copied().unwrap_or(false)
    }

    /// After an on-line change: outputs of inactive steps are FALSE, the others were written by
    /// their gates.
    pub(crate) fn carry(&self, l: &Layout, image: &mut [u64]) {
        for (step, range) in (0u32..).zip(self.of_step.windows(2)) {
            let &[from, to] = range else { break };
            let active = l.steps.contains(image, step);
            for gate in self.list.get(from as usize..to as usize).unwrap_or(&[]) {
                let on = active && word(image, gate.output as usize) != 0;
                set_bit(image, l.counted, gate.row, on);
                if let Some(output) = image.get_mut(gate.output as usize) {
                    *output = u64::from(on);
                }
            }
        }
    }

    /// The only thing that follows a step with this row, if it is a gate: its contribution.
    pub(crate) fn alone(&self, e: &Extra) -> Option<u32> {
        let Rows { start, end } = e.contributions;
        (end == start + 1 && nothing_else(e) && self.has(start)).then_some(start)
    }

    /// Gives the outputs of the active steps the values of their conditions.
    pub(crate) fn follow(&self, l: &Layout, d: &Decisions, image: &mut [u64]) {
        let mut walk = Walk::new(&l.steps, image);
        while let Some(step) = walk.next(&l.steps, image) {
            let Some([from, to]) = self.of_step.get(step as usize..step as usize + 2) else { break };
            for gate in self.list.get(*from as usize..*to as usize).unwrap_or(&[]) {
                let value = match gate.condition {
                    Condition::Bits { at, mask, on } => (word(image, at as usize) & mask != 0) == on,
                    Condition::Tests(first) => d.decide(image, first),
                };
                if set_bit(image, l.counted, gate.row, value) != value
                    && let Some(output) = image.get_mut(gate.output as usize)
                {
                    *output = u64::from(value);
                }
            }
        }
    }

    /// Makes the output of a gate FALSE, as its step is deactivated.
    pub(crate) fn close(&self, l: &Layout, image: &mut [u64], row: u32) {
        if set_bit(image, l.counted, row, false)
            && let Some(output) = self.outputs.get(row as usize)
            && let Some(output) = image.get_mut(*output as usize)
        {
            *output = 0;
        }
    }
}

/// The words that some code reads or writes, or that something other than one block writes.
fn used(t: &Tables) -> Vec<bool> {
    let mut used = vec![false; t.init.len()];
    let mut mark = |from: u32, len: usize| {
        let words = used.get_mut(from as usize..).unwrap_or_default();
        words.iter_mut().take(len).for_each(|u| *u = true);
    };
    let has_texts = t.code.iter().any(|op| {
        matches!(op, Op::Text { .. } | Op::CompareText(_) | Op::StoreText { .. } | Op::FromText(_))
    });
    for op in &t.code {
        match *op {
            Op::Load(a) => mark(a.0, 1),
            Op::LoadAt { base, len } => mark(base.0, len as usize),
            // It may be the address of a string.
            Op::Push(v) if has_texts => {
                mark(u32::try_from(v).unwrap_or(NONE), 1 + usize::from(TEXT).div_ceil(8));
            }
            Op::Store(a) | Op::Random(a) | Op::Fb(_, a) => mark(a.0, writes(op)),
            Op::StoreAt { base: a, .. }
            | Op::StoreText { to: a, .. }
            | Op::Text { to: a, .. }
            | Op::ToText { to: a, .. } => mark(a.0, writes(op)),
            _ => {}
        }
    }
    for transition in &t.transitions {
        if let Receptivity::Word(a) | Receptivity::NotWord(a) = transition.receptivity {
            mark(a.0, 1);
        }
    }
    let counts = t.counts.map(|(a, b)| [a, b]).into_iter().flatten().chain(t.limits.map(|l| l.0));
    let written = t.steps.iter().map(|s| s.direct).chain(counts).filter(|a| a.0 != NONE);
    written.for_each(|Addr(a)| mark(a, 1));
    t.word_watches.iter().for_each(|(a, _)| mark(a.0, 1));
    mark(t.inputs.start, (t.inputs.end - t.inputs.start) as usize);
    mark(t.locals.start, (t.locals.end - t.locals.start) as usize);
    let mut outputs = vec![0u8; used.len()];
    for b in t.blocks.iter().filter(|b| b.output.0 != NONE) {
        if let Some(n) = outputs.get_mut(b.output.0 as usize) {
            *n = n.saturating_add(1);
        }
    }
    used.iter_mut().zip(outputs).filter(|(_, n)| *n > 1).for_each(|(u, _)| *u = true);
    used
}
