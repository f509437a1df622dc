//! Boolean code as decisions: a short list of tests, each of which says which test comes next.
//!
//! Most receptivities, conditions and watched expressions join BOOL words, steps, edges and
//! comparisons by `and`, `or` and `not`. [`Decisions::new`] finds these codes and turns them into
//! tests of the image; `run.rs` evaluates them without a stack. Code with anything else (arithmetic,
//! calls, jumps, indices) is left to the interpreter. Both give the same value: such code has no
//! fault, no loop and no effect, so it does not matter in which order its parts are looked at.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use crate::bits::{bit, word};
use crate::clocks::{clock, since};
use crate::layout::{Layout, head};
use crate::number::compare;
use crate::ops::{Addr, Cmp, Code, Num, Op, StepId};
use crate::tables::{NONE, Receptivity, Tables};

/// Most tests of one decision. Longer code is left to the interpreter.
const MOST: usize = 64;
/// As a next test: the value is TRUE.
const YES: u16 = u16::MAX;
/// As a next test: the value is FALSE.
const NO: u16 = u16::MAX - 1;

/// One test. Its successors are counted from the first test of the decision and lie behind it.
#[derive(Clone, Copy, Debug)]
struct Test {
    /// The bits that are tested; 0 for a comparison.
    mask: u64,
    /// The word of the image, or the row of the comparison.
    at: u32,
    /// The next test where some bit is set or the comparison is true.
    yes: u16,
    /// The next test otherwise.
    no: u16,
}

/// A comparison of two values.
#[derive(Clone, Copy, Debug)]
struct Comparison {
    how: Cmp,
    kind: Num,
    left: Operand,
    right: Operand,
}

/// A value that is read without computing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operand {
    Constant(u64),
    /// A word of the image.
    Word(u32),
    /// The time of a step: the words of its stamp and of the time now.
    Since {
        stamp: u32,
        now: u32,
        step: StepId,
    },
}

/// The decisions of a program.
#[derive(Clone, Debug, Default)]
pub(crate) struct Decisions {
    /// By the first instruction of a code: one past its last, and its first test or `NONE`.
    first: Box<[(u32, u32)]>,
    tests: Box<[Test]>,
    comparisons: Box<[Comparison]>,
    /// The word where the bits of the steps begin.
    steps: u32,
}

impl Decisions {
    /// Finds the codes of a program that are decisions.
    #[inline(never)]
    pub(crate) fn new(t: &Tables, l: &Layout) -> Decisions {
        let mut building = Building { t, l, tests: Vec::new(), comparisons: Vec::new() };
        let mut first = vec![(0, NONE); t.code.len()];
        for code in boolean(t) {
            if let Some(slot) = first.get_mut(code.start as usize)
                && slot.1 == NONE
                && let Some(decision) = building.decision(code)
            {
                *slot = (code.end, decision);
            }
        }
        Decisions {
            first: first.into_boxed_slice(),
            tests: building.tests.into_boxed_slice(),
            comparisons: building.comparisons.into_boxed_slice(),
            steps: l.steps.base(),
        }
    }

    /// The first test of a code; `NONE` if it is no decision.
    #[inline(always)]
    pub(crate) fn of(&self, code: Code) -> u32 {
        match self.first.get(code.start as usize) {
            Some((end, first)) if *end == code.end => *first,
            _ => NONE,
        }
    }

    /// The word and the bits of it that a decision of one test looks at, and whether it is TRUE where one
    /// of them is set; `None` for any other decision.
    pub(crate) fn single(&self, first: u32) -> Option<(u32, u64, bool)> {
        let test = self.tests.get(first as usize)?;
        let over = test.mask != 0 && test.yes >= NO && test.no >= NO && test.yes != test.no;
        over.then_some((test.at, test.mask, test.yes == YES))
    }

    /// The value of a decision, by its first test.
    #[inline(never)]
    pub(crate) fn decide(&self, image: &[u64], first: u32) -> bool {
        let mut next = 0u16;
        while let Some(test) = self.tests.get(first as usize + usize::from(next)) {
            let holds = match test.mask {
                0 => self.compared(image, test.at),
                mask => word(image, test.at as usize) & mask != 0,
            };
            next = if holds { test.yes } else { test.no };
            if next >= NO {
                break;
            }
        }
        next == YES
    }

    fn compared(&self, image: &[u64], row: u32) -> bool {
        let Some(c) = self.comparisons.get(row as usize) else { return false };
        let value = |o: Operand| match o {
            Operand::Constant(v) => v,
            Operand::Word(at) => word(image, at as usize),
            Operand::Since { stamp, now, step } => {
                let now = word(image, now as usize) as i64;
                since(image, stamp, bit(image, self.steps, step.0), now) as u64
            }
        };
        compare(c.how, c.kind, value(c.left), value(c.right))
    }
}

/// The codes that push one BOOL.
fn boolean(t: &Tables) -> impl Iterator<Item = Code> + '_ {
    let receptivities = t.transitions.iter().filter_map(|t| match t.receptivity {
        Receptivity::Code(code) => Some(code),
        _ => None,
    });
    receptivities
        .chain(t.watches.iter().map(|w| w.code))
        .chain(t.events.iter().map(|e| e.event))
        .chain(t.actions.iter().map(|a| a.condition))
        .chain(t.contributions.iter().map(|c| c.condition))
        .chain(t.blocks.iter().map(|b| b.gate))
        .filter(|code| !code.is_empty())
}

/// A part of a Boolean expression: a leaf, or what joins two parts of [`Code`] before it.
#[derive(Clone, Copy, Debug)]
enum Part {
    Value(Operand),
    Bits { at: u32, mask: u64 },
    Comparison(u32),
    Not(usize),
    And(usize, usize),
    Or(usize, usize),
    Xor(usize, usize),
}

struct Building<'a> {
    t: &'a Tables,
    l: &'a Layout,
    tests: Vec<Test>,
    comparisons: Vec<Comparison>,
}

impl Building<'_> {
    /// Adds the tests of a code; returns the first, or `None` if the code is no decision.
    fn decision(&mut self, code: Code) -> Option<u32> {
        let before = (self.tests.len(), self.comparisons.len());
        let first = self.parts(code).and_then(|(parts, root)| {
            let mut order = Vec::new();
            order_tests(&parts, root, YES, NO, &mut order)?;
            self.place(&order)
        });
        if first.is_none() {
            self.tests.truncate(before.0);
            self.comparisons.truncate(before.1);
        }
        first
    }

    /// The parts of a code with the index of the whole.
    fn parts(&mut self, code: Code) -> Option<(Vec<Part>, usize)> {
        let ops = self.t.code.get(code.start as usize..code.end as usize)?;
        let mut parts: Vec<Part> = Vec::new();
        let mut stack: Vec<usize> = Vec::new();
        for op in ops {
            let part = match *op {
                Op::Not => Part::Not(stack.pop()?),
                Op::And | Op::Or | Op::Xor => {
                    let (b, a) = (stack.pop()?, stack.pop()?);
                    match op {
                        Op::And => Part::And(a, b),
                        Op::Or => Part::Or(a, b),
                        _ => Part::Xor(a, b),
                    }
                }
                Op::Compare(how, kind) => {
                    let (b, a) = (stack.pop()?, stack.pop()?);
                    let (&Part::Value(left), &Part::Value(right)) = (parts.get(a)?, parts.get(b)?) else {
                        return None;
                    };
                    self.comparisons.push(Comparison { how, kind, left, right });
                    Part::Comparison(self.comparisons.len() as u32 - 1)
                }
                leaf => self.leaf(leaf)?,
            };
            if parts.len() >= MOST {
                return None;
            }
            stack.push(parts.len());
            parts.push(part);
        }
        match stack[..] {
            [root] => Some((parts, root)),
            _ => None,
        }
    }

    fn leaf(&self, op: Op) -> Option<Part> {
        let l = self.l;
        let bit = |base: u32, i: u32| Part::Bits { at: base + i / 64, mask: 1 << (i % 64) };
        Some(match op {
            Op::Push(v) => Part::Value(Operand::Constant(v)),
            Op::Load(Addr(a)) => Part::Value(Operand::Word(l.vars + a)),
            Op::StepTime(step) => {
                let now = clock(&self.t.rules) as u32;
                Part::Value(Operand::Since { stamp: l.stamp(step.0), now, step })
            }
            Op::StepAge(step) => {
                Part::Value(Operand::Since { stamp: l.age(step.0), now: head::NOW as u32, step })
            }
            Op::Active(step) => bit(l.steps.base(), step.0),
            Op::Rise(w) => bit(l.rise, w.0),
            Op::Fall(w) => bit(l.fall, w.0),
            Op::Timer(w) => bit(l.q, w.0),
            Op::GroupActive(g) => Part::Bits { at: l.groups + g.0, mask: u64::MAX },
            _ => return None,
        })
    }

    /// Puts tests in their order behind those that stand already. The tests were made from the
    /// last to the first.
    fn place(&mut self, order: &[Test]) -> Option<u32> {
        let last = order.len().checked_sub(1)?;
        let turned = |next: u16| if next >= NO { next } else { (last - usize::from(next)) as u16 };
        let first = self.tests.len() as u32;
        self.tests.extend(order.iter().rev().map(|t| Test { yes: turned(t.yes), no: turned(t.no), ..*t }));
        Some(first)
    }
}

/// Makes the tests of a part that lead to `yes` and `no`; returns the first of them. Each test is
/// pushed behind its successors.
fn order_tests(parts: &[Part], at: usize, yes: u16, no: u16, order: &mut Vec<Test>) -> Option<u16> {
    let (at, mask) = match *parts.get(at)? {
        Part::Not(a) => return order_tests(parts, a, no, yes, order),
        Part::And(a, b) => {
            let rest = order_tests(parts, b, yes, no, order)?;
            return order_tests(parts, a, rest, no, order);
        }
        Part::Or(a, b) => {
            let rest = order_tests(parts, b, yes, no, order)?;
            return order_tests(parts, a, yes, rest, order);
        }
        Part::Xor(a, b) => {
            let differs = order_tests(parts, b, no, yes, order)?;
            let same = order_tests(parts, b, yes, no, order)?;
            return order_tests(parts, a, differs, same, order);
        }
        // A BOOL is 0 or 1; a receptivity that is one word asks for other than 0 as well.
        Part::Value(Operand::Word(at)) => (at, u64::MAX),
        // A constant would be a part without a test.
        Part::Value(_) => return None,
        Part::Bits { at, mask } => (at, mask),
        Part::Comparison(row) => (row, 0),
    };
    if order.len() >= MOST {
        return None;
    }
    order.push(Test { mask, at, yes, no });
    Some(order.len() as u16 - 1)
}
