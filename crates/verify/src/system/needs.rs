//! How far each memory of whole numbers must be told apart: the demands of all that reads it.
//!
//! A demand is a number from which on all values may act alike, or that all differ. `range.rs` asks for the
//! needs of a whole chart, `slices.rs` for those of a question. In the second case what only leads to
//! a fault demands nothing: then a run may go on where the chart would have stopped.

use g7_engine::{Arith, Builtin, Cmp};
use g7_equations::{Equations, Expr, Memory, MemoryId, Stmt, What};
use g7_model::Type;

use super::range::{LONGEST, ROUNDS, Ranges, all, is_whole};
use crate::model::Model;

/// Nothing reads the memory: all of its values may act alike, those below 0 too.
pub(crate) const NOTHING: Option<i128> = Some(i128::MIN);

/// For each memory the value from which on all may act alike, or `None` where all differ. `first` are the
/// needs from outside; those of these questions come on top. With `faults`, what decides on a fault is read as well.
pub(crate) fn needs(
    e: &Equations,
    ranges: &Ranges,
    first: Vec<Option<i128>>,
    questions: &[usize],
    faults: bool,
) -> Vec<Option<i128>> {
    let mut needs = Needs { e, ranges, needs: first, moved: true, faults, ends: false };
    for round in 0.. {
        if !std::mem::replace(&mut needs.moved, false) {
            break;
        }
        // After so many rounds a need that still grows becomes "all values differ", so that the loop ends.
        needs.ends = round > 3 * ROUNDS;
        for s in all(e) {
            needs.statement(s);
        }
        for (_, value) in questions.iter().filter_map(|q| e.questions.get(*q)) {
            needs.demand(value, None);
        }
    }
    needs.needs
}

/// The ranges of all memories, with the values from which on those of each act alike. `observed` memories are
/// told apart as they are.
pub(crate) fn ranges(e: &Equations, model: &Model<'_>, observed: impl Fn(What) -> bool) -> Ranges {
    let ranges = Ranges::new(e, model);
    let first = |m: &Memory| {
        let exact = observed(m.what) || !is_whole(m.ty) || m.ty == Type::Bool;
        if exact { None } else { Some(0) }
    };
    let first = e.memories.iter().map(first).collect();
    let all: Vec<usize> = (0..e.questions.len()).collect();
    let needs = needs(e, &ranges, first, &all, true);
    let is_clock = |m: &Memory| {
        matches!(m.what, What::StepScans(_) | What::GroupScans(_))
            || m.ty == Type::Time && !matches!(m.what, What::Variable(_) | What::Until(_))
    };
    let caps = e.memories.iter().zip(&needs);
    let caps = caps.map(|(m, need)| need.or(is_clock(m).then_some(LONGEST))).collect();
    ranges.with_caps(caps)
}

/// The demands of all readers, until they settle.
struct Needs<'a> {
    e: &'a Equations,
    ranges: &'a Ranges,
    /// For each memory, the value from which on all may act alike; nothing where they differ.
    needs: Vec<Option<i128>>,
    moved: bool,
    /// Conditions of faults are read too.
    faults: bool,
    /// A need that is raised becomes that of a memory whose values all differ.
    ends: bool,
}

impl Needs<'_> {
    fn need(&self, m: MemoryId) -> Option<i128> {
        self.needs.get(m.0 as usize).copied().flatten()
    }

    fn raise(&mut self, m: MemoryId, need: Option<i128>) {
        let Some(old) = self.needs.get_mut(m.0 as usize) else { return };
        let has_order = self.e.memory(m).is_some_and(|m| is_whole(m.ty) && m.ty != Type::Bool);
        let mut new = old.and_then(|old| need.map(|need| old.max(need)));
        if new != *old && (self.ends || !has_order) {
            new = None;
        }
        self.moved |= new != *old;
        *old = new;
    }

    /// Makes the demands of a statement and of all within it. True if some demand is made of a memory that it writes,
    /// or if it may leave a loop or, where faults are read, end the scan: only then its conditions are read. All in
    /// one walk, since statements may be nested some hundreds deep.
    fn statement(&mut self, s: &Stmt) -> bool {
        match s {
            Stmt::Set(m, value) => {
                let need = self.need(*m);
                let matters = need != NOTHING;
                if matters {
                    self.demand(value, need);
                }
                matters
            }
            Stmt::SetElement(m, index, value) => {
                let need = self.need(*m);
                let matters = need != NOTHING;
                if matters {
                    self.demand(index, None);
                    self.demand(value, need);
                }
                matters
            }
            Stmt::If(condition, then, other) => {
                let matters = self.statements(then) | self.statements(other);
                if matters {
                    self.demand(condition, None);
                }
                matters
            }
            Stmt::Loop(body) => self.statements(body),
            Stmt::Call(_, memories) => {
                let matters = memories.iter().any(|m| self.need(*m) != NOTHING);
                if matters {
                    self.call(memories);
                }
                matters
            }
            Stmt::Exit => true,
            Stmt::Fault(..) => self.faults,
            Stmt::About(_) => false,
        }
    }

    fn statements(&mut self, list: &[Stmt]) -> bool {
        list.iter().fold(false, |matters, s| self.statement(s) | matters)
    }

    fn call(&mut self, memories: &[MemoryId]) {
        for (i, m) in memories.iter().enumerate() {
            // A timer asks whether its length is over, and shows no time beyond it.
            let is_clock = i == 4 && self.e.memory(*m).is_some_and(|m| is_of_clock(self.e, m.what));
            let length = memories.get(1).and_then(|m| self.bound(&Expr::Read(*m)));
            self.raise(*m, if is_clock { length.map(|l| l.max(0)) } else { None });
        }
    }

    /// The greatest value of an expression, where it has one short of its type's.
    fn bound(&self, x: &Expr) -> Option<i128> {
        let high = self.ranges.range(x).high;
        (high < LONGEST).then_some(high)
    }

    /// Values of this expression from `need` on may act alike.
    fn demand(&mut self, x: &Expr, need: Option<i128>) {
        match x {
            Expr::Read(m) => self.raise(*m, need),
            Expr::Element(m, index) => {
                self.raise(*m, need);
                self.demand(index, None);
            }
            Expr::Compare(c, _, a, b) => {
                // At or beyond: the bound itself; beyond: one more.
                let more = |strict: bool| i128::from(strict);
                let (left, right) =
                    (more(!matches!(c, Cmp::Ge | Cmp::Lt)), more(!matches!(c, Cmp::Le | Cmp::Gt)));
                let (ba, bb) = (self.bound(a), self.bound(b));
                self.demand(a, bb.map(|v| (v + left).max(0)));
                self.demand(b, ba.map(|v| (v + right).max(0)));
            }
            Expr::Differs(_, a, b) => match (&**a, &**b) {
                // Within a scan a clock stands still or becomes 0.
                (Expr::Read(x), Expr::Read(y)) if self.is_clock(*x) && self.is_clock(*y) => {}
                _ => {
                    self.demand(a, None);
                    self.demand(b, None);
                }
            },
            Expr::Call(Builtin::Min, _, list) => {
                for (i, a) in list.iter().enumerate() {
                    let others = list.iter().enumerate().filter(|(k, _)| *k != i);
                    let least = others.filter_map(|(_, o)| self.bound(o)).min();
                    let need = match (need, least) {
                        (Some(n), Some(l)) => Some(n.min(l.max(0))),
                        (n, l) => n.or(l.map(|l| l.max(0))),
                    };
                    self.demand(a, need);
                }
            }
            Expr::Call(Builtin::Max, _, list) => list.iter().for_each(|a| self.demand(a, need)),
            Expr::Call(Builtin::Sel, _, list) => {
                for (i, a) in list.iter().enumerate() {
                    self.demand(a, if i == 0 { None } else { need });
                }
            }
            Expr::Convert(Type::Time, Type::Lint, a) => self.demand(a, need),
            Expr::Arith(Arith::Div, _, a, b) if matches!(**b, Expr::Const(..)) => {
                let by = self.ranges.range(b).low;
                self.demand(a, need.filter(|_| by > 0).and_then(|n| n.checked_mul(by)));
            }
            // A sum that is too large has no value of other types: without faults it does not come to that.
            Expr::Arith(Arith::Add, ty, a, b)
                if matches!(ty, Type::Lint | Type::Time)
                    || !self.faults && *ty != Type::Ulint && is_whole(*ty) =>
            {
                let grows = [a, b].iter().all(|x| self.ranges.range(x).low >= 0);
                let need = need.filter(|_| grows);
                self.demand(a, need);
                self.demand(b, need);
            }
            Expr::Const(..) | Expr::Text(_) => {}
            Expr::Not(a) | Expr::Neg(_, a) | Expr::Convert(_, _, a) | Expr::Trunc(_, _, a) => {
                self.demand(a, None);
            }
            Expr::Random(a) | Expr::Fails(a) => self.demand_exact(a),
            Expr::And(list) | Expr::Or(list) | Expr::Call(_, _, list) => {
                list.iter().for_each(|a| self.demand(a, None));
            }
            Expr::Xor(a, b) | Expr::Arith(_, _, a, b) => {
                self.demand(a, None);
                self.demand(b, None);
            }
        }
    }

    /// All that is read within is kept as it is.
    fn demand_exact(&mut self, x: &Expr) {
        let mut found = Vec::new();
        x.visit(&mut |x| {
            if let Expr::Read(m) | Expr::Element(m, _) = x {
                found.push(*m);
            }
        });
        found.into_iter().for_each(|m| self.raise(m, None));
    }

    fn is_clock(&self, m: MemoryId) -> bool {
        self.e.memory(m).is_some_and(|m| is_of_clock(self.e, m.what))
    }
}

/// The clock of a timer block, or a copy of one that the actions of a pass work on.
fn is_of_clock(e: &Equations, what: What) -> bool {
    match what {
        What::BlockClock(_) => true,
        What::Own(m) | What::Given(m) | What::Begun(m) => e.memory(m).is_some_and(|m| is_of_clock(e, m.what)),
        _ => false,
    }
}
