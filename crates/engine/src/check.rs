//! The check that tables are a program: every row points to rows that are there,
//! and every code pops and pushes the values that it should. After that no scan
//! can meet a bad index, whoever made the tables.

use alloc::vec;
use alloc::vec::Vec;

use crate::ops::{Addr, Builtin, Code, Op, STACK, Service, StepId, TEXT};
use crate::tables::{INPUTS, NONE, Receptivity, Rows, Situation, Tables};

type Checked = Result<(), LoadError>;

struct Check<'a> {
    t: &'a Tables,
    /// Stack depth before each instruction, by the code being checked.
    depth: Vec<i16>,
}

fn bad(table: &'static str, row: usize) -> LoadError {
    LoadError::Index { table, row: row as u32 }
}

fn within(i: u32, len: usize, table: &'static str, row: usize) -> Checked {
    if (i as usize) < len { Ok(()) } else { Err(bad(table, row)) }
}

fn rows(r: Rows, len: usize, table: &'static str, row: usize) -> Checked {
    if r.start <= r.end && r.end as usize <= len { Ok(()) } else { Err(bad(table, row)) }
}

/// Why tables are not a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LoadError {
    /// A row of the named table points to a row that is not there.
    Index {
        /// The table.
        table: &'static str,
        /// The row.
        row: u32,
    },
    /// Code at this instruction pops a value that is not there, or leaves one behind.
    Stack {
        /// The instruction.
        at: u32,
    },
    /// Code needs more than [`crate::STACK`] words of stack.
    Deep {
        /// The instruction.
        at: u32,
    },
    /// A table that must be sorted is not.
    Order {
        /// The table.
        table: &'static str,
        /// The row.
        row: u32,
    },
    /// A table is larger than `2^26` rows.
    Large {
        /// The table.
        table: &'static str,
    },
}

/// Checks that tables are a program.
#[inline(never)]
pub(crate) fn check(t: &Tables) -> Result<(), LoadError> {
    let mut check = Check { t, depth: vec![-1; t.code.len()] };
    check.sizes()?;
    check.steps()?;
    check.transitions()?;
    check.actions()?;
    check.watches()?;
    check.rest()
}

/// Most words of the variable area that an instruction writes.
pub(crate) fn writes(op: &Op) -> usize {
    let string = |cap: u16| 1 + usize::from(cap).div_ceil(8);
    match op {
        Op::Store(_) | Op::Random(_) => 1,
        Op::StoreAt { len, .. } => *len as usize,
        Op::StoreText { cap, .. } | Op::Text { cap, .. } | Op::ToText { cap, .. } => string(*cap),
        Op::Fb(block, _) => block.words() as usize,
        _ => 0,
    }
}

impl Check<'_> {
    #[inline(never)]
    fn sizes(&self) -> Checked {
        let t = self.t;
        let sizes = [
            ("steps", t.steps.len()),
            ("transitions", t.transitions.len()),
            ("init", t.init.len()),
            ("code", t.code.len()),
            ("contributions", t.contributions.len()),
            ("blocks", t.blocks.len()),
            ("watches", t.watches.len()),
            ("groups", t.groups.len()),
            ("actions", t.actions.len()),
            ("arcs", t.arcs.len()),
        ];
        for (table, len) in sizes {
            // So small that all words of an image can be counted in a u32.
            if len > 1 << 26 {
                return Err(LoadError::Large { table });
            }
        }
        rows(t.inputs, t.init.len(), "inputs", 0)?;
        rows(t.outputs, t.init.len(), "outputs", 0)?;
        if !t.locals.is_empty() && t.locals.end as usize != t.init.len() {
            return Err(bad("locals", 0));
        }
        if t.safe.len() != (t.outputs.end - t.outputs.start) as usize {
            return Err(bad("safe", 0));
        }
        match t.periods.first() {
            Some(0) => Ok(()),
            _ => Err(bad("periods", 0)),
        }
    }

    #[inline(never)]
    fn steps(&mut self) -> Checked {
        let t = self.t;
        for (i, step) in t.steps.iter().enumerate() {
            rows(step.out, t.outs.len(), "steps", i)?;
            within(step.chart, t.charts.len(), "steps", i)?;
            if step.direct.0 != NONE {
                within(step.direct.0, t.init.len(), "steps", i)?;
            }
            if step.extra != NONE {
                within(step.extra, t.extras.len(), "steps", i)?;
            }
        }
        for (i, e) in t.extras.iter().enumerate() {
            let lists = [
                (e.on, t.action_lists.len()),
                (e.off, t.action_lists.len()),
                (e.events, t.events.len()),
                (e.periodics, t.periodics.len()),
                (e.contributions, t.contributions.len()),
                (e.groups, t.group_lists.len()),
                (e.orders, t.orders.len()),
                (e.encloses, t.group_lists.len()),
                (e.links, t.arcs.len()),
                (e.watches, t.watch_lists.len()),
            ];
            for (r, len) in lists {
                rows(r, len, "extras", i)?;
            }
        }
        for (i, s) in t.arcs.iter().enumerate() {
            within(s.0, t.steps.len(), "arcs", i)?;
        }
        for (i, s) in t.initial.iter().enumerate() {
            within(s.0, t.steps.len(), "initial", i)?;
        }
        for (i, g) in t.group_lists.iter().enumerate() {
            within(g.0, t.groups.len(), "group_lists", i)?;
        }
        for (i, g) in t.groups.iter().enumerate() {
            rows(g.steps, t.steps.len(), "groups", i)?;
            rows(g.initial, t.arcs.len(), "groups", i)?;
            rows(g.watches, t.watch_lists.len(), "groups", i)?;
        }
        for (i, c) in t.charts.iter().enumerate() {
            within(c.group.0, t.groups.len(), "charts", i)?;
            within(c.period, t.periods.len(), "charts", i)?;
        }
        Ok(())
    }

    #[inline(never)]
    fn transitions(&mut self) -> Checked {
        let t = self.t;
        for (i, tr) in t.transitions.iter().enumerate() {
            for step in [tr.from, tr.to] {
                if step.0 != NONE {
                    within(step.0, t.steps.len(), "transitions", i)?;
                }
            }
            rows(tr.more_from, t.arcs.len(), "transitions", i)?;
            rows(tr.more_to, t.arcs.len(), "transitions", i)?;
            within(tr.chart, t.charts.len(), "transitions", i)?;
            if tr.on_clearing != NONE {
                within(tr.on_clearing, t.actions.len(), "transitions", i)?;
            }
            match tr.receptivity {
                Receptivity::True => {}
                Receptivity::Word(a) | Receptivity::NotWord(a) => {
                    within(a.0, t.init.len(), "transitions", i)?
                }
                Receptivity::Code(code) => self.code(code, 1)?,
            }
        }
        let mut last = 0;
        for (i, (rank, step)) in t.drops.iter().enumerate() {
            within(*rank, t.transitions.len(), "drops", i)?;
            within(step.0, t.steps.len(), "drops", i)?;
            if *rank < last {
                return Err(LoadError::Order { table: "drops", row: i as u32 });
            }
            last = *rank;
        }
        for (i, o) in t.outs.iter().enumerate() {
            within(*o, t.transitions.len(), "outs", i)?;
        }
        for (i, o) in t.sources.iter().enumerate() {
            within(*o, t.transitions.len(), "sources", i)?;
        }
        Ok(())
    }

    #[inline(never)]
    fn actions(&mut self) -> Checked {
        let t = self.t;
        for (i, a) in t.actions.iter().enumerate() {
            self.condition(a.condition)?;
            self.code(a.body, 0)?;
            within(a.period, t.periods.len(), "actions", i)?;
        }
        for (i, a) in t.action_lists.iter().enumerate() {
            within(*a, t.actions.len(), "action_lists", i)?;
        }
        for (i, a) in t.periodics.iter().enumerate() {
            within(*a, t.actions.len(), "periodics", i)?;
        }
        for (i, e) in t.events.iter().enumerate() {
            within(e.action, t.actions.len(), "events", i)?;
            self.code(e.event, 1)?;
        }
        for (i, c) in t.contributions.iter().enumerate() {
            within(c.block, t.blocks.len(), "contributions", i)?;
            within(u32::from(c.input), INPUTS.len(), "contributions", i)?;
            within(c.period, t.periods.len(), "contributions", i)?;
            let plain = t.blocks.get(c.block as usize).is_some_and(|b| b.plain);
            if plain && c.input != 0 {
                return Err(bad("contributions", i));
            }
            self.condition(c.condition)?;
            self.condition(c.time)?;
        }
        for (i, b) in t.blocks.iter().enumerate() {
            if b.output.0 != NONE {
                within(b.output.0, t.init.len(), "blocks", i)?;
            }
            if b.action != NONE {
                within(b.action, t.actions.len(), "blocks", i)?;
                if b.plain {
                    return Err(bad("blocks", i));
                }
            }
            within(b.period, t.periods.len(), "blocks", i)?;
            self.condition(b.gate)?;
        }
        Ok(())
    }

    #[inline(never)]
    fn watches(&mut self) -> Checked {
        let t = self.t;
        for (i, w) in t.watches.iter().enumerate() {
            self.code(w.code, 1)?;
            if let Some((a, b)) = w.times {
                self.code(a, 1)?;
                self.code(b, 1)?;
            }
            within(w.period, t.periods.len(), "watches", i)?;
            rows(w.watches, t.watch_lists.len(), "watches", i)?;
            let readers = t.watch_lists.get(w.watches.start as usize..w.watches.end as usize).unwrap_or(&[]);
            if readers.iter().any(|r| r.0 as usize <= i) {
                return Err(LoadError::Order { table: "watches", row: i as u32 });
            }
        }
        for (i, w) in t.watch_lists.iter().enumerate() {
            within(w.0, t.watches.len(), "watch_lists", i)?;
        }
        let mut last = Addr(0);
        for (i, (a, w)) in t.word_watches.iter().enumerate() {
            within(a.0, t.init.len(), "word_watches", i)?;
            within(w.0, t.watches.len(), "word_watches", i)?;
            if *a < last {
                return Err(LoadError::Order { table: "word_watches", row: i as u32 });
            }
            last = *a;
        }
        Ok(())
    }

    #[inline(never)]
    fn rest(&mut self) -> Checked {
        let t = self.t;
        // By chart: an order that names steps has been seen.
        let mut imposed = vec![false; t.charts.len()];
        for (i, o) in t.orders.iter().enumerate() {
            within(o.step.0, t.steps.len(), "orders", i)?;
            within(o.chart, t.charts.len(), "orders", i)?;
            let named = imposed.get_mut(o.chart as usize);
            match o.situation {
                Situation::Steps(r) => {
                    rows(r, t.arcs.len(), "orders", i)?;
                    named.into_iter().for_each(|n| *n = true);
                }
                Situation::Current if named.is_some_and(|n| *n) => {
                    return Err(LoadError::Order { table: "orders", row: i as u32 });
                }
                Situation::Current => {}
            }
        }
        for code in [t.pre, t.services, t.post, t.tail] {
            self.code(code, 0)?;
        }
        let addresses = t.counts.map(|(a, b)| [a, b]).into_iter().flatten().chain(t.limits.map(|l| l.0));
        for a in addresses {
            within(a.0, t.init.len(), "counts", 0)?;
        }
        Ok(())
    }

    fn condition(&mut self, code: Code) -> Checked {
        if code.is_empty() { Ok(()) } else { self.code(code, 1) }
    }

    /// Checks that a code, started on an empty stack, never pops a value that is not
    /// there, and ends with `leaves` values on every path.
    fn code(&mut self, code: Code, leaves: i16) -> Checked {
        if code.start > code.end || code.end as usize > self.t.code.len() {
            return Err(LoadError::Stack { at: code.start });
        }
        let (from, to) = (code.start as usize, code.end as usize);
        let Some(depth) = self.depth.get_mut(from..to) else {
            return Err(LoadError::Stack { at: code.start });
        };
        depth.fill(-1);
        let mut pending = vec![(code.start, 0i16)];
        while let Some((mut pc, mut d)) = pending.pop() {
            loop {
                if pc == code.end {
                    if d != leaves {
                        return Err(LoadError::Stack { at: pc });
                    }
                    break;
                }
                let Some(seen) = self.depth.get_mut(pc as usize) else {
                    return Err(LoadError::Stack { at: pc });
                };
                if *seen >= 0 {
                    if *seen != d {
                        return Err(LoadError::Stack { at: pc });
                    }
                    break;
                }
                *seen = d;
                let Some(op) = self.t.code.get(pc as usize) else { return Err(LoadError::Stack { at: pc }) };
                self.operands(op, pc)?;
                let (pops, pushes) = effect(op);
                d -= pops;
                if d < 0 {
                    return Err(LoadError::Stack { at: pc });
                }
                d += pushes;
                if d as usize > STACK {
                    return Err(LoadError::Deep { at: pc });
                }
                match *op {
                    Op::Jump(target) | Op::JumpUnless(target) => {
                        if target < code.start || target > code.end {
                            return Err(LoadError::Stack { at: pc });
                        }
                        pending.push((target, d));
                        if matches!(op, Op::Jump(_)) {
                            break;
                        }
                    }
                    Op::Return => {
                        if d != leaves {
                            return Err(LoadError::Stack { at: pc });
                        }
                        break;
                    }
                    _ => {}
                }
                pc += 1;
            }
        }
        Ok(())
    }

    /// Checks that the operands of an instruction are there.
    #[inline(never)]
    fn operands(&self, op: &Op, pc: u32) -> Checked {
        let t = self.t;
        let row = pc as usize;
        let words = |base: Addr, n: usize| {
            if base.0 as usize + n <= t.init.len() { Ok(()) } else { Err(bad("code", row)) }
        };
        let string = |cap: u16| 1 + usize::from(cap).div_ceil(8);
        let step = |s: StepId| within(s.0, t.steps.len(), "code", row);
        match *op {
            Op::Load(a) | Op::Store(a) | Op::Random(a) => words(a, 1),
            Op::LoadAt { base, len } | Op::StoreAt { base, len } => words(base, len as usize),
            Op::Active(s) | Op::WasActive(s) | Op::StepAge(s) | Op::StepTime(s) | Op::StepTenths(s) => {
                step(s)
            }
            Op::GroupActive(g) | Op::GroupTime(g) | Op::GroupAge(g) => {
                within(g.0, t.groups.len(), "code", row)
            }
            Op::Due(period) => within(period, t.periods.len(), "code", row),
            Op::Rise(w) | Op::Fall(w) | Op::Timer(w) => within(w.0, t.watches.len(), "code", row),
            Op::Text { to, cap, .. } | Op::StoreText { to, cap } | Op::ToText { to, cap, .. } => {
                words(to, string(cap.min(TEXT)))?;
                if cap > TEXT { Err(bad("code", row)) } else { Ok(()) }
            }
            Op::Fb(block, base) => words(base, block.words() as usize),
            Op::Service(s) => match s {
                Service::Init(g) | Service::Clear(g) => within(g.0, t.groups.len(), "code", row),
                Service::Set(s) | Service::Reset(s) => step(s),
                Service::Start | Service::ResetTimes => Ok(()),
            },
            _ => Ok(()),
        }
    }
}

/// Values that an instruction pops and pushes.
fn effect(op: &Op) -> (i16, i16) {
    match *op {
        Op::Push(_)
        | Op::Load(_)
        | Op::Active(_)
        | Op::WasActive(_)
        | Op::GroupActive(_)
        | Op::GroupTime(_)
        | Op::StepAge(_)
        | Op::GroupAge(_)
        | Op::Due(_)
        | Op::StepTime(_)
        | Op::StepTenths(_)
        | Op::Rise(_)
        | Op::Fall(_)
        | Op::Timer(_)
        | Op::ScanTime
        | Op::Random(_) => (0, 1),
        Op::Store(_) | Op::JumpUnless(_) | Op::Drop | Op::StoreText { .. } => (1, 0),
        Op::StoreAt { .. } => (2, 0),
        Op::LoadAt { .. }
        | Op::Not
        | Op::Neg(_)
        | Op::Convert(..)
        | Op::Trunc(..)
        | Op::ToText { .. }
        | Op::FromText(_) => (1, 1),
        Op::And | Op::Or | Op::Xor | Op::Arith(..) | Op::Compare(..) | Op::CompareText(_) => (2, 1),
        Op::Call(_, _, n) => (i16::from(n), 1),
        Op::Text { function, .. } => (text_arguments(function), 1),
        Op::Fb(..) | Op::Jump(_) | Op::Return | Op::Service(_) => (0, 0),
    }
}

fn text_arguments(f: Builtin) -> i16 {
    match f {
        Builtin::Len => 1,
        Builtin::Left | Builtin::Right | Builtin::Concat | Builtin::Find => 2,
        Builtin::Mid | Builtin::Insert | Builtin::Delete => 3,
        Builtin::Replace => 4,
        // These are no string functions. No code has so many values.
        _ => i16::MAX,
    }
}
