//! The values that a receptivity, an edge, a condition or an action depends on.
//!
//! A search asks this to find the inputs that matter in a situation, and a prover
//! to leave out what a question does not reach.

use alloc::collections::BTreeSet;
use alloc::vec::Vec;

use crate::ops::{Addr, Code, GroupId, Op, StepId, TEXT, WatchId};
use crate::program::Program;
use crate::tables::{Receptivity, Rows, Tables};

/// A part of a program that reads values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The receptivity of a transition, by rank.
    Transition(u32),
    /// A watched expression, with the times of a timer.
    Watch(WatchId),
    /// The event of an event action: row of [`Tables::events`]. Its action is
    /// another subject.
    Event(u32),
    /// The condition and the body of an action, by rank.
    Action(u32),
    /// The condition and the time of an input to a control block: row of
    /// [`Tables::contributions`].
    Contribution(u32),
    /// The gate of a control block: row of [`Tables::blocks`].
    Gate(u32),
    /// Any code of the program, such as [`Tables::pre`].
    Code(Code),
}

/// The values that a part of a program may read, directly, in a function that it
/// calls, or through the watches that it asks for edges and delays. All lists are
/// ascending, without repetition.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reads {
    /// Words of the variable area: inputs, outputs and variables, also all elements
    /// of an array that is indexed and all words of a function block that is called.
    /// Locals are left out.
    pub words: Vec<Addr>,
    /// Steps whose activity or time it reads.
    pub steps: Vec<StepId>,
    /// Groups whose activity or time it reads.
    pub groups: Vec<GroupId>,
    /// Watches whose edges or outputs it reads. They remember values from before.
    pub watches: Vec<WatchId>,
    /// It may change with the time alone.
    pub time: bool,
}

impl Reads {
    /// The inputs among the words.
    pub fn inputs<'a>(&'a self, p: &Program) -> impl Iterator<Item = Addr> + 'a {
        let Rows { start, end } = p.tables.inputs;
        self.words.iter().copied().filter(move |a| (start..end).contains(&a.0))
    }
}

impl Program {
    /// The values that a part of the program may read. If two states agree in all of
    /// them (and in the time, where [`Reads::time`] says so), the part has the same
    /// value in both.
    ///
    /// Reading goes through watches and functions, but not through variables: an
    /// input that PRE copies to a variable is not read by those who read the variable.
    ///
    /// A row that is not there reads nothing. Allocates; it is meant to be asked once
    /// for each part. A constant beside string functions may count as the address of
    /// a string, so that a word too many is named.
    ///
    /// # Example
    ///
    /// ```
    /// # use g7_engine::{Addr, Program, Receptivity, Subject, Tables};
    /// # fn inputs_of(program: &Program) -> Vec<Addr> {
    /// // The inputs that the first transition waits for.
    /// program.reads(Subject::Transition(0)).inputs(program).collect()
    /// # }
    /// ```
    pub fn reads(&self, subject: Subject) -> Reads {
        let t = &self.tables;
        let mut found = Found {
            t,
            words: BTreeSet::new(),
            steps: BTreeSet::new(),
            groups: BTreeSet::new(),
            watches: BTreeSet::new(),
            time: false,
        };
        match subject {
            Subject::Transition(rank) => match t.transitions.get(rank as usize).map(|t| t.receptivity) {
                Some(Receptivity::Word(a) | Receptivity::NotWord(a)) => found.word(a.0),
                Some(Receptivity::Code(code)) => found.code(code),
                Some(Receptivity::True) | None => {}
            },
            Subject::Watch(w) => found.watch(w),
            Subject::Event(row) => t.events.get(row as usize).into_iter().for_each(|e| found.code(e.event)),
            Subject::Action(rank) => {
                let codes = t.actions.get(rank as usize).map(|a| [a.condition, a.body]);
                codes.into_iter().flatten().for_each(|c| found.code(c));
            }
            Subject::Contribution(row) => {
                let codes = t.contributions.get(row as usize).map(|c| [c.condition, c.time]);
                codes.into_iter().flatten().for_each(|c| found.code(c));
            }
            Subject::Gate(row) => t.blocks.get(row as usize).into_iter().for_each(|b| found.code(b.gate)),
            Subject::Code(code) => found.code(code),
        }
        Reads {
            words: found.words.into_iter().map(Addr).collect(),
            steps: found.steps.into_iter().collect(),
            groups: found.groups.into_iter().collect(),
            watches: found.watches.into_iter().collect(),
            time: found.time,
        }
    }
}

struct Found<'a> {
    t: &'a Tables,
    words: BTreeSet<u32>,
    steps: BTreeSet<StepId>,
    groups: BTreeSet<GroupId>,
    watches: BTreeSet<WatchId>,
    time: bool,
}

impl Found<'_> {
    fn word(&mut self, at: u32) {
        let locals = self.t.locals;
        if !(locals.start..locals.end).contains(&at) {
            self.words.insert(at);
        }
    }

    fn words(&mut self, from: u32, len: u32) {
        let end = from.saturating_add(len).min(self.t.init.len() as u32);
        (from..end).for_each(|w| self.word(w));
    }

    fn watch(&mut self, id: WatchId) {
        let Some(w) = self.t.watches.get(id.0 as usize) else { return };
        if self.watches.insert(id) {
            self.time |= w.always || w.times.is_some();
            self.code(w.code);
            if let Some((on, off)) = w.times {
                self.code(on);
                self.code(off);
            }
        }
    }

    fn code(&mut self, code: Code) {
        let t = self.t;
        let ops = t.code.get(code.start as usize..code.end as usize).unwrap_or(&[]);
        let strings = ops.iter().any(|op| {
            matches!(op, Op::Text { .. } | Op::CompareText(_) | Op::StoreText { .. } | Op::FromText(_))
        });
        for op in ops {
            match *op {
                Op::Push(v) if strings => self.string(v),
                Op::Load(a) | Op::Random(a) => self.word(a.0),
                Op::LoadAt { base, len } => self.words(base.0, len),
                Op::Fb(block, base) => {
                    self.words(base.0, block.words());
                    self.time = true;
                }
                Op::Active(s) | Op::WasActive(s) => {
                    self.steps.insert(s);
                }
                Op::StepTime(s) | Op::StepTenths(s) | Op::StepAge(s) => {
                    self.steps.insert(s);
                    self.time = true;
                }
                Op::GroupActive(g) => {
                    self.groups.insert(g);
                }
                Op::GroupTime(g) | Op::GroupAge(g) => {
                    self.groups.insert(g);
                    self.time = true;
                }
                Op::Rise(w) | Op::Fall(w) | Op::Timer(w) => self.watch(w),
                Op::ScanTime | Op::Due(_) => self.time = true,
                Op::Push(_)
                | Op::Store(_)
                | Op::StoreAt { .. }
                | Op::Not
                | Op::And
                | Op::Or
                | Op::Xor
                | Op::Neg(_)
                | Op::Arith(..)
                | Op::Compare(..)
                | Op::Convert(..)
                | Op::Trunc(..)
                | Op::Call(..)
                | Op::Text { .. }
                | Op::CompareText(_)
                | Op::StoreText { .. }
                | Op::ToText { .. }
                | Op::FromText(_)
                | Op::Jump(_)
                | Op::JumpUnless(_)
                | Op::Return
                | Op::Service(_)
                | Op::Drop => {}
            }
        }
    }

    /// The words of the string at an address. Its room is that with which code writes
    /// it. An input may be as long as the inputs reach; a constant is as long as it is.
    fn string(&mut self, address: u64) {
        let t = self.t;
        let Some(at) = u32::try_from(address).ok().filter(|a| (*a as usize) < t.init.len()) else { return };
        let written = t.code.iter().filter_map(|op| match *op {
            Op::StoreText { to, cap } | Op::Text { to, cap, .. } | Op::ToText { to, cap, .. }
                if to.0 == at =>
            {
                Some(u64::from(cap))
            }
            _ => None,
        });
        let initial = t.init.get(at as usize).copied().unwrap_or(0);
        let room = written.chain([initial]).max().unwrap_or(0);
        let longest = u64::from(TEXT).div_ceil(8) as u32;
        let words = if (t.inputs.start..t.inputs.end).contains(&at) {
            (t.inputs.end - at - 1).min(longest)
        } else {
            u32::try_from(room.div_ceil(8)).unwrap_or(longest).min(longest)
        };
        self.words(at, 1 + words);
    }
}
