//! Instructions joined into steps of the interpreter: a computation with the constants and words
//! that are pushed right before it, and what becomes of its value right behind it.
//!
//! ```text
//! Load a, Push 1, Arith(Add), Store a   four instructions, one step
//! ```
//!
//! There is a step for each instruction of [`crate::Tables::code`], at the same place, which begins
//! there. So jumps, faults and the order of what happens are those of the instructions, and a jump
//! into the middle of a longer step finds the step that begins there. `run.rs` runs the steps; it
//! has no other way to run code.

use alloc::boxed::Box;

use crate::layout::Layout;
use crate::ops::{Addr, Arith, Builtin, Cmp, Num, Op};
use crate::tables::Tables;

/// Most operands of a step.
const MOST: usize = 3;

/// What a step computes from its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Compute {
    /// The operand.
    Same,
    Not,
    And,
    Or,
    Xor,
    Compare(Cmp, Num),
    Arith(Arith, Num),
    Neg(Num),
    Convert(Num, Num),
    /// LIMIT of three operands.
    Limit(Num),
    /// SEL of three operands.
    Sel,
    /// Nothing here: the instruction stands alone, and does with the stack what it does.
    Alone,
}

/// What becomes of the value of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sink {
    Push,
    /// Into a word of the variable area.
    Store(Addr),
    /// A jump where the value is 0.
    Unless(u32),
    /// A jump where it is not.
    When(u32),
}

/// Where an operand comes from: two bits of kind, and a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Operand(u32);

/// An [`Operand`], taken apart.
pub(crate) enum Source {
    /// Popped.
    Top,
    /// A word of the image.
    Word(usize),
    /// The constant that this instruction pushes.
    Constant(usize),
}

impl Operand {
    const TOP: Operand = Operand(0);
    const KIND: u32 = 30;
    const WORD: u32 = 1 << Operand::KIND;
    const CONSTANT: u32 = 2 << Operand::KIND;

    /// The operand that an instruction pushes. Numbers of 30 bits suffice: `check.rs` refuses larger
    /// tables.
    fn of(op: Op, at: u32, vars: u32) -> Option<Operand> {
        match op {
            Op::Load(a) => Some(Operand(Operand::WORD | (vars + a.0))),
            Op::Push(_) => Some(Operand(Operand::CONSTANT | at)),
            _ => None,
        }
    }

    #[inline(always)]
    pub(crate) fn source(self) -> Source {
        let number = (self.0 & (Operand::WORD - 1)) as usize;
        match self.0 >> Operand::KIND {
            0 => Source::Top,
            1 => Source::Word(number),
            _ => Source::Constant(number),
        }
    }
}

/// One step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub(crate) compute: Compute,
    pub(crate) sink: Sink,
    /// In the order in which they are pushed.
    pub(crate) operands: [Operand; MOST],
    /// Number of instructions before the one that computes; a fault names that one.
    pub(crate) lead: u8,
    /// Number of instructions.
    pub(crate) len: u8,
}

/// A step for each instruction.
pub(crate) fn steps(t: &Tables, l: &Layout) -> Box<[Step]> {
    let end = t.code.len() as u32;
    (0..end).map(|at| Step::new(&t.code, at, end, l.vars)).collect()
}

impl Step {
    /// The step that begins at an instruction and ends no later than `end`.
    pub(crate) fn new(code: &[Op], at: u32, end: u32, vars: u32) -> Step {
        let op = |k: usize| code.get(at as usize + k).copied().filter(|_| at as usize + k < end as usize);
        let mut given = [Operand::TOP; MOST];
        let mut lead = 0;
        for (slot, k) in given.iter_mut().zip(0..) {
            let Some(operand) = op(k).and_then(|op| Operand::of(op, at + k as u32, vars)) else { break };
            *slot = operand;
            lead = k + 1;
        }
        let (compute, wanted, own) = op(lead).map_or((Compute::Alone, 0, 1), computation);
        if lead > wanted {
            // The instruction wants fewer operands, or takes them from the stack: the first is pushed.
            let operands = [given[0], Operand::TOP, Operand::TOP];
            return Step { compute: Compute::Same, sink: Sink::Push, operands, lead: 0, len: 1 };
        }
        // Operands before those that are given are on the stack.
        given.rotate_right(wanted - lead);
        let (sink, more) = match compute {
            Compute::Alone => (Sink::Push, 0),
            _ => sink(op(lead + own), op(lead + own + 1)),
        };
        Step { compute, sink, operands: given, lead: lead as u8, len: (lead + own + more) as u8 }
    }
}

/// What an instruction computes, from how many operands, and 1 where it is more than a sink.
fn computation(op: Op) -> (Compute, usize, usize) {
    match op {
        Op::Store(_) | Op::JumpUnless(_) => (Compute::Same, 1, 0),
        Op::Not => (Compute::Not, 1, 1),
        Op::Neg(n) => (Compute::Neg(n), 1, 1),
        Op::Convert(from, to) => (Compute::Convert(from, to), 1, 1),
        Op::And => (Compute::And, 2, 1),
        Op::Or => (Compute::Or, 2, 1),
        Op::Xor => (Compute::Xor, 2, 1),
        Op::Compare(c, n) => (Compute::Compare(c, n), 2, 1),
        Op::Arith(a, n) => (Compute::Arith(a, n), 2, 1),
        Op::Call(Builtin::Limit, n, 3) => (Compute::Limit(n), 3, 1),
        Op::Call(Builtin::Sel, _, 3) => (Compute::Sel, 3, 1),
        _ => (Compute::Alone, 0, 1),
    }
}

/// What two instructions behind a computation do with its value, and how many of them.
fn sink(next: Option<Op>, second: Option<Op>) -> (Sink, usize) {
    match (next, second) {
        (Some(Op::Store(a)), _) => (Sink::Store(a), 1),
        (Some(Op::JumpUnless(to)), _) => (Sink::Unless(to), 1),
        (Some(Op::Not), Some(Op::JumpUnless(to))) => (Sink::When(to), 2),
        _ => (Sink::Push, 0),
    }
}
