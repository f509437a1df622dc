//! The values that each memory of whole numbers can have: bounds, a common divisor, and the
//! value from which on all greater ones act alike.
//!
//! # Why this is exact
//!
//! - The bounds and the divisor are those of all that any statement ever stores there,
//!   whatever the conditions, until nothing new comes; what does not settle takes the bounds
//!   of its type. A memory then has as many bits as its values need. Times are multiples of
//!   the period as long as all that is added to them is, so they count periods.
//! - A memory need not be told apart beyond the greatest number that it, or a memory that it
//!   is copied to, is ever compared with. Sums with what is not negative keep that order.
//!   A value that anything else reads (a difference, a sum that may overflow, an output that is
//!   observed) is kept as it is.
//! - Clocks that are read in another way end at [`LONGEST`], since no run lasts so long.

use g7_compile::tree::transfers;
use g7_engine::{Arith, Builtin};
use g7_equations::{Class, Equations, Expr, MemoryId, Stmt, What, expand};
use g7_model::Type;

use super::word::gcd;
use crate::model::Model;

/// 146 years in nanoseconds.
pub(super) const LONGEST: i128 = 1 << 62;
/// Most rounds: a bound that still changes in the last one becomes that of the type.
pub(super) const ROUNDS: usize = 6;

/// The values of a memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Range {
    /// The least value.
    pub(crate) low: i128,
    /// The greatest value.
    pub(crate) high: i128,
    /// Divides all values.
    pub(crate) step: i128,
}

impl Range {
    fn one(v: i128) -> Range {
        Range { low: v, high: v, step: v.abs() }
    }

    fn new(low: i128, high: i128) -> Range {
        Range { low, high, step: 1 }
    }

    fn join(self, other: Range) -> Range {
        Range {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            step: gcd(self.step, other.step),
        }
    }
}

/// The bounds of a type of whole numbers; times are numbers of nanoseconds.
pub(crate) fn bounds(ty: Type) -> (i128, i128) {
    match ty {
        Type::Bool => (0, 1),
        Type::Time => (i64::MIN.into(), i64::MAX.into()),
        _ => ty.bounds().unwrap_or((0, u64::MAX.into())),
    }
}

/// True if values of the type are whole numbers here.
pub(crate) fn is_whole(ty: Type) -> bool {
    ty.is_integer() || ty.is_bits() || matches!(ty, Type::Bool | Type::Time)
}

/// The number that a word of the engine stands for.
pub(crate) fn number(ty: Type, word: u64) -> i128 {
    if bounds(ty).0 < 0 { (word as i64).into() } else { word.into() }
}

/// The values of all memories, and their caps.
pub(crate) struct Ranges {
    ranges: Vec<Range>,
    caps: Vec<Option<i128>>,
}

impl Ranges {
    /// Those of the memories of equations, without caps.
    pub(crate) fn new(e: &Equations, model: &Model<'_>) -> Ranges {
        let first = |m: &g7_equations::Memory| {
            let all = m.init.iter().map(|w| Range::one(number(m.ty, *w)));
            all.reduce(Range::join).unwrap_or(Range::one(0))
        };
        let mut all = Ranges { ranges: e.memories.iter().map(first).collect(), caps: Vec::new() };
        for (m, range) in e.memories.iter().zip(&mut all.ranges) {
            match m.what {
                What::Dt => *range = Range { low: 0, high: model.period.into(), step: model.period.into() },
                What::Until(i) => {
                    let periods = &model.compiled.program.tables().periods;
                    let period = periods.get(i as usize).copied().unwrap_or(0).into();
                    let own: i128 = model.period.into();
                    *range = Range { low: -own, high: period, step: gcd(own, period).max(1) };
                }
                What::Variable(_) if m.class == Class::Input => {
                    let (low, high) = bounds(m.ty);
                    *range = Range::new(low, high);
                }
                _ => {}
            }
        }
        all.settle(e);
        all
    }

    /// The values of a memory.
    pub(crate) fn of(&self, m: MemoryId) -> Range {
        self.ranges.get(m.0 as usize).copied().unwrap_or(Range::one(0))
    }

    /// The value from which on all act alike, a multiple of the step; nothing where it is not
    /// less than the greatest value.
    pub(crate) fn cap_of(&self, m: MemoryId) -> Option<i128> {
        let range = self.of(m);
        let cap = self.caps.get(m.0 as usize).copied().flatten()?;
        let cap = -(-cap).div_euclid(range.step.max(1)) * range.step.max(1);
        (range.low >= 0 && cap < range.high).then_some(cap)
    }

    fn settle(&mut self, e: &Equations) {
        let mut sets: Vec<(MemoryId, Expr)> = Vec::new();
        each(e, &mut |s| gather(s, &mut sets));
        let fixed = |m: &MemoryId| {
            e.memory(*m).is_none_or(|m| matches!(m.what, What::Dt | What::Until(_)) || !is_whole(m.ty))
        };
        sets.retain(|(m, _)| !fixed(m));
        for round in 0.. {
            let mut moved = false;
            for (to, value) in &sets {
                let new = self.range(value);
                let Some(old) = self.ranges.get_mut(to.0 as usize) else { continue };
                let mut joined = old.join(new);
                if joined == *old {
                    continue;
                }
                moved = true;
                if round > ROUNDS {
                    let (low, high) = bounds(e.memory(*to).map_or(Type::Lint, |m| m.ty));
                    joined.low = if joined.low < old.low { low } else { joined.low };
                    joined.high = if joined.high > old.high { high } else { joined.high };
                }
                *old = joined;
            }
            if !moved {
                break;
            }
        }
    }

    /// The values of an expression.
    pub(crate) fn range(&self, x: &Expr) -> Range {
        let truth = Range::new(0, 1);
        match x {
            Expr::Const(ty, v) if is_whole(*ty) => Range::one(number(*ty, *v)),
            Expr::Const(..) | Expr::Text(_) | Expr::Random(_) => Range::one(0),
            Expr::Read(m) | Expr::Element(m, _) => self.of(*m),
            Expr::Not(_)
            | Expr::And(_)
            | Expr::Or(_)
            | Expr::Xor(..)
            | Expr::Compare(..)
            | Expr::Differs(..)
            | Expr::Fails(_) => truth,
            Expr::Neg(ty, a) => {
                let a = self.range(a);
                fit(*ty, Range { low: -a.high, high: -a.low, step: a.step })
            }
            Expr::Arith(op, ty, a, b) => fit(*ty, arith(*op, *ty, self.range(a), self.range(b))),
            Expr::Convert(from, to, a) if is_whole(*from) && is_whole(*to) => {
                let range = self.range(a);
                if *to == Type::Bool {
                    truth
                } else if transfers(*from, *to) {
                    let (low, high) = bounds(*to);
                    if range.low >= low && range.high <= high { range } else { whole_type(*to) }
                } else {
                    fit(*to, range)
                }
            }
            Expr::Convert(_, ty, _) | Expr::Trunc(_, ty, _) => whole_type(*ty),
            Expr::Call(f, ty, args) => {
                let mut list = args.iter().map(|a| self.range(a));
                match f {
                    Builtin::Sel | Builtin::Mux => {
                        let all = list.skip(1).reduce(Range::join);
                        all.map_or(whole_type(*ty), |r| r.join(Range::one(0)))
                    }
                    Builtin::Min | Builtin::Max => {
                        let Some(first) = list.next() else { return whole_type(*ty) };
                        list.fold(first, |a, b| {
                            let less = *f == Builtin::Min;
                            let pick = |x: i128, y: i128| if less { x.min(y) } else { x.max(y) };
                            Range {
                                low: pick(a.low, b.low),
                                high: pick(a.high, b.high),
                                step: gcd(a.step, b.step),
                            }
                        })
                    }
                    Builtin::Limit => list.reduce(Range::join).unwrap_or(whole_type(*ty)),
                    _ => whole_type(*ty),
                }
            }
        }
    }

    /// The same, with the values from which on those of each memory act alike.
    pub(super) fn with_caps(mut self, caps: Vec<Option<i128>>) -> Ranges {
        self.caps = caps;
        self
    }
}

/// All statements that stand in no other one.
pub(super) fn all(e: &Equations) -> impl Iterator<Item = &Stmt> {
    e.sections().flat_map(|s| &s.body).chain(e.questions.iter().flat_map(|q| &q.0))
}

/// Visits all statements.
fn each(e: &Equations, f: &mut dyn FnMut(&Stmt)) {
    all(e).for_each(|s| s.visit(f));
}

fn gather(s: &Stmt, sets: &mut Vec<(MemoryId, Expr)>) {
    match s {
        Stmt::Set(m, value) | Stmt::SetElement(m, _, value) => sets.push((*m, value.clone())),
        Stmt::Call(block, memories) => {
            expand(*block, memories).iter().for_each(|s| s.visit(&mut |s| gather(s, sets)));
        }
        _ => {}
    }
}

fn whole_type(ty: Type) -> Range {
    let (low, high) = if is_whole(ty) { bounds(ty) } else { (0, 0) };
    Range::new(low, high)
}

/// The part of a result that the type can hold; without a value it is 0.
fn fit(ty: Type, r: Range) -> Range {
    if !is_whole(ty) {
        return Range::one(0);
    }
    let (low, high) = bounds(ty);
    if r.low >= low && r.high <= high {
        return r;
    }
    // Only the generator of random numbers counts on wrapping.
    if ty == Type::Ulint {
        return whole_type(ty);
    }
    Range { low: r.low.clamp(low, high).min(0), high: r.high.clamp(low, high).max(0), step: r.step }
}

fn arith(op: Arith, ty: Type, a: Range, b: Range) -> Range {
    let widest = a.low.abs().max(a.high.abs());
    match op {
        Arith::Add => Range { low: a.low + b.low, high: a.high + b.high, step: gcd(a.step, b.step) },
        Arith::Sub => Range { low: a.low - b.high, high: a.high - b.low, step: gcd(a.step, b.step) },
        Arith::Mul => {
            let ends = [(a.low, b.low), (a.low, b.high), (a.high, b.low), (a.high, b.high)]
                .map(|(x, y)| x.saturating_mul(y));
            let step = a.step.checked_mul(b.step).filter(|s| *s < LONGEST).unwrap_or(1);
            Range {
                low: ends.into_iter().fold(i128::MAX, i128::min),
                high: ends.into_iter().fold(i128::MIN, i128::max),
                step,
            }
        }
        Arith::Div => {
            let step = match (b.low == b.high, b.step) {
                (true, k) if k > 0 && a.step % k == 0 => a.step / k,
                _ => 1,
            };
            let least = if b.low > 0 { b.low } else { 1 };
            let most = widest / least;
            let low = if a.low >= 0 && b.low >= 0 { 0 } else { -most };
            Range { low, high: most, step }
        }
        Arith::Mod => {
            let most = widest.min((b.low.abs().max(b.high.abs()) - 1).max(0));
            Range { low: if a.low >= 0 { 0 } else { -most }, high: most, step: gcd(a.step, b.step) }
        }
        Arith::Pow => whole_type(ty),
    }
}
