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
use alloc::vec::Vec;

use crate::layout::Layout;
use crate::ops::{Addr, Arith, Builtin, Cmp, Num, Op};
use crate::tables::Tables;

/// Most operands of a step.
const MOST: usize = 3;

/// The computation of a step on its operands. A frequent one has a word of its own, so that it is
/// known after one look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Compute {
    /// The operand.
    Same,
    Not,
    And,
    Or,
    Xor,
    /// Comparisons of signed and unsigned integers and of LREAL.
    Signed(Orders),
    Unsigned(Orders),
    Real(Orders),
    /// Arithmetic of LREAL, which has no fault.
    Add,
    Sub,
    Mul,
    /// LIMIT of LREAL.
    Limit,
    /// SEL of three operands.
    Sel,
    /// A comparison of REAL.
    Compare(Cmp, Num),
    Arith(Arith, Num),
    Neg(Num),
    Convert(Num, Num),
    /// A cell of an array, by its place: the row of [`Joined::arrays`].
    Cell(u32),
    /// The same, by its index and the lower bound: two instructions.
    Element(u32),
    /// Nothing here: the instruction stands alone, and does with the stack what it does.
    Alone,
}

/// The orders of two values in which a comparison is true, a bit each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Orders(u8);

impl Orders {
    /// One of the values is NaN.
    const NONE: u8 = 1;
    const GREATER: u8 = 1 << 1;
    const LESS: u8 = 1 << 2;
    const EQUAL: u8 = 1 << 3;

    fn of(c: Cmp) -> Orders {
        Orders(match c {
            Cmp::Eq => Orders::EQUAL,
            Cmp::Ne => Orders::LESS | Orders::GREATER | Orders::NONE,
            Cmp::Lt => Orders::LESS,
            Cmp::Le => Orders::LESS | Orders::EQUAL,
            Cmp::Gt => Orders::GREATER,
            Cmp::Ge => Orders::GREATER | Orders::EQUAL,
        })
    }

    /// 1 if the order of two values is one of these, else 0.
    #[inline(always)]
    pub(crate) fn hold<T: PartialOrd>(self, a: T, b: T) -> u64 {
        // The number of the bit: neither is true of NaN, both are of equal values.
        let order = u64::from(a >= b) | u64::from(a <= b) << 1;
        u64::from(self.0) >> order & 1
    }
}

/// The use of the value of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sink {
    Push,
    /// Into a word of the variable area.
    Store(Addr),
    /// Into a cell of an array, whose place is popped: the row of [`Joined::arrays`].
    StoreAt(u32),
    /// A jump where the value is 0.
    Unless(u32),
    /// A jump where it is not.
    When(u32),
}

/// Where an operand comes from: a word of the image by its place, a constant by its place behind
/// these words, or the stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Operand(pub(crate) u32);

impl Operand {
    /// Popped.
    pub(crate) const TOP: Operand = Operand(u32::MAX);
}

/// One step. It is found by a shift of its number.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
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

/// The code of a program as steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct Joined {
    /// A step for each instruction.
    pub(crate) steps: Box<[Step]>,
    /// The constants that instructions push, ascending and without repetition.
    pub(crate) constants: Box<[u64]>,
    /// The first word of each array that is indexed, and its length, ascending and without repetition.
    pub(crate) arrays: Box<[(Addr, u32)]>,
    /// Number of words of the image.
    pub(crate) words: u32,
    /// The place of the variable area there.
    vars: u32,
}

impl Joined {
    #[inline(never)]
    pub(crate) fn new(t: &Tables, l: &Layout) -> Joined {
        let pushed = |op: &Op| if let Op::Push(v) = op { Some(*v) } else { None };
        let mut constants: Vec<u64> = t.code.iter().filter_map(pushed).collect();
        constants.sort_unstable();
        constants.dedup();
        let mut arrays: Vec<(Addr, u32)> = t.code.iter().filter_map(array).collect();
        arrays.sort_unstable();
        arrays.dedup();
        let mut joined = Joined {
            constants: constants.into_boxed_slice(),
            arrays: arrays.into_boxed_slice(),
            words: l.len,
            vars: l.vars,
            ..Joined::default()
        };
        let end = t.code.len() as u32;
        joined.steps = (0..end).map(|at| joined.step(&t.code, at, end)).collect();
        joined
    }

    /// The step that begins at an instruction and ends no later than `end`.
    pub(crate) fn step(&self, code: &[Op], at: u32, end: u32) -> Step {
        let op = |k: usize| code.get(at as usize + k).copied().filter(|_| at as usize + k < end as usize);
        let mut given = [Operand::TOP; MOST];
        let mut lead = 0;
        for (slot, k) in given.iter_mut().zip(0..) {
            let Some(operand) = op(k).and_then(|op| self.operand(op)) else { break };
            *slot = operand;
            lead = k + 1;
        }
        let (compute, wanted, own) =
            op(lead).map_or((Compute::Alone, 0, 1), |first| self.computation(first, op(lead + 1)));
        if lead > wanted {
            // The instruction wants fewer operands, or takes them from the stack: the first is pushed.
            let operands = [given[0], Operand::TOP, Operand::TOP];
            return Step { compute: Compute::Same, sink: Sink::Push, operands, lead: 0, len: 1 };
        }
        // Operands before those that are given are on the stack.
        given.rotate_right(wanted - lead);
        let (sink, more) = match compute {
            Compute::Alone => (Sink::Push, 0),
            _ => self.sink(op(lead + own), op(lead + own + 1)),
        };
        Step { compute, sink, operands: given, lead: lead as u8, len: (lead + own + more) as u8 }
    }

    /// The operand that an instruction pushes. There are fewer words and constants than [`Operand::TOP`]:
    /// `check.rs` refuses larger tables.
    fn operand(&self, op: Op) -> Option<Operand> {
        match op {
            Op::Load(a) => Some(Operand(self.vars + a.0)),
            Op::Push(v) => self.constants.binary_search(&v).ok().map(|at| Operand(self.words + at as u32)),
            _ => None,
        }
    }

    /// The row of the array that an instruction indexes.
    fn array(&self, op: Op) -> u32 {
        let row = array(&op).and_then(|array| self.arrays.binary_search(&array).ok());
        row.map_or(u32::MAX, |row| row as u32)
    }

    /// The computation of an instruction, the number of its operands, and the number of instructions that are
    /// more than a sink.
    fn computation(&self, op: Op, next: Option<Op>) -> (Compute, usize, usize) {
        match (op, next) {
            (Op::LoadAt { .. }, _) => (Compute::Cell(self.array(op)), 1, 1),
            (Op::Arith(Arith::Sub, Num::I64), Some(load @ Op::LoadAt { .. })) => {
                (Compute::Element(self.array(load)), 2, 2)
            }
            (op, _) => computation(op),
        }
    }

    /// The use that the two instructions behind a computation make of its value, and how many of them do.
    fn sink(&self, next: Option<Op>, second: Option<Op>) -> (Sink, usize) {
        match (next, second) {
            (Some(Op::Store(a)), _) => (Sink::Store(a), 1),
            (Some(op @ Op::StoreAt { .. }), _) => (Sink::StoreAt(self.array(op)), 1),
            (Some(Op::JumpUnless(to)), _) => (Sink::Unless(to), 1),
            (Some(Op::Not), Some(Op::JumpUnless(to))) => (Sink::When(to), 2),
            _ => (Sink::Push, 0),
        }
    }
}

/// The array that an instruction indexes.
fn array(op: &Op) -> Option<(Addr, u32)> {
    match *op {
        Op::LoadAt { base, len } | Op::StoreAt { base, len } => Some((base, len)),
        _ => None,
    }
}

/// As [`Joined::computation`], for instructions that index no array.
fn computation(op: Op) -> (Compute, usize, usize) {
    match op {
        Op::Store(_) | Op::StoreAt { .. } | Op::JumpUnless(_) => (Compute::Same, 1, 0),
        Op::Not => (Compute::Not, 1, 1),
        Op::Neg(n) => (Compute::Neg(n), 1, 1),
        Op::Convert(from, to) => (Compute::Convert(from, to), 1, 1),
        Op::And => (Compute::And, 2, 1),
        Op::Or => (Compute::Or, 2, 1),
        Op::Xor => (Compute::Xor, 2, 1),
        Op::Compare(c, n) => (comparison(c, n), 2, 1),
        Op::Arith(a, n) => (arithmetic(a, n), 2, 1),
        Op::Call(Builtin::Limit, Num::F64, 3) => (Compute::Limit, 3, 1),
        Op::Call(Builtin::Sel, _, 3) => (Compute::Sel, 3, 1),
        _ => (Compute::Alone, 0, 1),
    }
}

fn comparison(c: Cmp, n: Num) -> Compute {
    match n {
        Num::I8 | Num::I16 | Num::I32 | Num::I64 => Compute::Signed(Orders::of(c)),
        Num::Bool | Num::U8 | Num::U16 | Num::U32 | Num::U64 => Compute::Unsigned(Orders::of(c)),
        Num::F64 => Compute::Real(Orders::of(c)),
        Num::F32 => Compute::Compare(c, n),
    }
}

fn arithmetic(a: Arith, n: Num) -> Compute {
    match (a, n) {
        (Arith::Add, Num::F64) => Compute::Add,
        (Arith::Sub, Num::F64) => Compute::Sub,
        (Arith::Mul, Num::F64) => Compute::Mul,
        _ => Compute::Arith(a, n),
    }
}
