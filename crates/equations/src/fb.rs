//! The standard function blocks (IEC 61131-3:2003, 2.5.2.3) as assignments.

use g7_engine::{Arith, Block, Builtin, Cmp};
use g7_model::Type;

use crate::form::{Expr, MemoryId, Stmt};

/// The memories of one instance.
struct Instance<'a>(&'a [MemoryId]);

impl Instance<'_> {
    fn id(&self, i: usize) -> MemoryId {
        self.0.get(i).copied().unwrap_or(MemoryId(u32::MAX))
    }

    fn get(&self, i: usize) -> Expr {
        Expr::Read(self.id(i))
    }

    fn set(&self, i: usize, e: Expr) -> Stmt {
        Stmt::Set(self.id(i), e)
    }
}

/// The effect of a call of a function block on its memories: the members in the order
/// of the call, then what it remembers.
///
/// Of TON, TOF and TP the memory behind the members is the clock, then a LINT: bit
/// 0 is IN at the call before; of TOF and TP bit 1 says that time runs, of TOF
/// bit 2 that it has run out. Source: IEC 61131-3:2003, tables 34 to 37.
pub fn expand(block: Block, memories: &[MemoryId]) -> Vec<Stmt> {
    let w = Instance(memories);
    match block {
        Block::Ctu => {
            let up = rose(&w, 0, 5);
            let less = w.get(4).compare(Cmp::Lt, Type::Int, int(i16::MAX));
            let count = Stmt::If(up.and(less), vec![w.set(4, step(w.get(4), Arith::Add))], Vec::new());
            vec![
                Stmt::If(w.get(1), vec![w.set(4, int(0))], vec![count]),
                w.set(5, w.get(0)),
                w.set(3, w.get(4).compare(Cmp::Ge, Type::Int, w.get(2))),
            ]
        }
        Block::Ctd => {
            let down = rose(&w, 0, 5);
            let more = w.get(4).compare(Cmp::Gt, Type::Int, int(i16::MIN));
            let count = Stmt::If(down.and(more), vec![w.set(4, step(w.get(4), Arith::Sub))], Vec::new());
            vec![
                Stmt::If(w.get(1), vec![w.set(4, w.get(2))], vec![count]),
                w.set(5, w.get(0)),
                w.set(3, w.get(4).compare(Cmp::Le, Type::Int, int(0))),
            ]
        }
        Block::Ctud => both_ways(&w),
        Block::Ton => {
            let before = bit(&w, 1);
            vec![
                Stmt::If(
                    w.get(0).and(before.negated()).or(w.get(0).negated()),
                    vec![w.set(4, Expr::time(0))],
                    Vec::new(),
                ),
                Stmt::Set(w.id(3), gone(&w)),
                w.set(2, w.get(0).and(w.get(4).compare(Cmp::Ge, Type::Time, length(&w)))),
                Stmt::If(w.get(0), vec![w.set(5, Expr::long(1))], vec![w.set(5, Expr::long(0))]),
            ]
        }
        Block::Tof => off_delay(&w),
        Block::Tp => pulse(&w),
        Block::RTrig => vec![w.set(1, rose(&w, 0, 2)), w.set(2, w.get(0))],
        // The memory is that of the standard's body, NOT CLK, and starts FALSE: a
        // first call with CLK false is an edge.
        Block::FTrig => {
            vec![w.set(1, w.get(0).negated().and(w.get(2).negated())), w.set(2, w.get(0).negated())]
        }
        Block::Sr => vec![w.set(2, w.get(0).or(w.get(1).negated().and(w.get(2))))],
        Block::Rs => vec![w.set(2, w.get(1).negated().and(w.get(0).or(w.get(2))))],
    }
}

/// The memories of an instance that a call of it writes: all behind its inputs.
pub(crate) fn written(block: Block, memories: &[MemoryId]) -> &[MemoryId] {
    let inputs = match block {
        Block::Ctu | Block::Ctd => 3,
        Block::Ctud => 5,
        Block::Ton | Block::Tof | Block::Tp | Block::Sr | Block::Rs => 2,
        Block::RTrig | Block::FTrig => 1,
    };
    memories.get(inputs..).unwrap_or_default()
}

fn int(v: i16) -> Expr {
    Expr::Const(Type::Int, i64::from(v) as u64)
}

fn step(e: Expr, op: Arith) -> Expr {
    e.arith(op, Type::Int, int(1))
}

/// An input has risen since the call before.
fn rose(w: &Instance<'_>, input: usize, memory: usize) -> Expr {
    w.get(input).and(w.get(memory).negated())
}

fn both_ways(w: &Instance<'_>) -> Vec<Stmt> {
    let (up, down) = (rose(w, 0, 8), rose(w, 1, 9));
    let less = w.get(7).compare(Cmp::Lt, Type::Int, int(i16::MAX));
    let more = w.get(7).compare(Cmp::Gt, Type::Int, int(i16::MIN));
    let counts = |one: Expr, other: Expr, room: Expr| Expr::all([one, other.negated(), room]);
    let downward = Stmt::If(
        counts(down.clone(), up.clone(), more),
        vec![w.set(7, step(w.get(7), Arith::Sub))],
        Vec::new(),
    );
    let upward = Stmt::If(counts(up, down, less), vec![w.set(7, step(w.get(7), Arith::Add))], vec![downward]);
    let load = Stmt::If(w.get(3), vec![w.set(7, w.get(4))], vec![upward]);
    vec![
        Stmt::If(w.get(2), vec![w.set(7, int(0))], vec![load]),
        w.set(8, w.get(0)),
        w.set(9, w.get(1)),
        w.set(5, w.get(7).compare(Cmp::Ge, Type::Int, w.get(4))),
        w.set(6, w.get(7).compare(Cmp::Le, Type::Int, int(0))),
    ]
}

/// PT; a negative one is none.
fn length(w: &Instance<'_>) -> Expr {
    Expr::Call(Builtin::Max, Type::Time, vec![w.get(1), Expr::time(0)])
}

/// The time gone, at most PT.
fn gone(w: &Instance<'_>) -> Expr {
    Expr::Call(Builtin::Min, Type::Time, vec![w.get(4), length(w)])
}

/// A bit of a timer's memory, by its value.
fn bit(w: &Instance<'_>, value: i64) -> Expr {
    // Nothing is divided by 1: linters of printed code report that.
    let shifted = match value {
        1 => w.get(5),
        _ => w.get(5).arith(Arith::Div, Type::Lint, Expr::long(value)),
    };
    shifted.arith(Arith::Mod, Type::Lint, Expr::long(2)).compare(Cmp::Ne, Type::Lint, Expr::long(0))
}

fn off_delay(w: &Instance<'_>) -> Vec<Stmt> {
    let (before, runs, over) = (bit(w, 1), bit(w, 2), bit(w, 4));
    let at_length = |w: &Instance<'_>| w.get(4).compare(Cmp::Ge, Type::Time, length(w));
    let ended = vec![
        w.set(2, Expr::truth(false)),
        w.set(3, length(w)),
        w.set(5, Expr::long(4)),
        w.set(4, Expr::time(0)),
    ];
    let going = vec![w.set(2, Expr::truth(true)), w.set(3, w.get(4)), w.set(5, Expr::long(2))];
    let running = vec![Stmt::If(at_length(w), ended.clone(), going)];
    let idle = vec![w.set(2, Expr::truth(false)), w.set(3, Expr::time(0)), w.set(5, Expr::long(0))];
    let mut falls = vec![w.set(4, Expr::time(0))];
    falls.extend(running.clone());
    let off = Stmt::If(before, falls, vec![Stmt::If(runs, running, vec![Stmt::If(over, ended, idle)])]);
    let on = vec![
        w.set(2, Expr::truth(true)),
        w.set(3, Expr::time(0)),
        w.set(4, Expr::time(0)),
        w.set(5, Expr::long(1)),
    ];
    vec![Stmt::If(w.get(0), on, vec![off])]
}

fn pulse(w: &Instance<'_>) -> Vec<Stmt> {
    let (before, runs) = (bit(w, 1), bit(w, 2));
    let starts = Expr::all([w.get(0), before.negated(), runs.clone().negated()]);
    let within = w.get(4).compare(Cmp::Lt, Type::Time, length(w));
    let with_input = |w: &Instance<'_>, value: i64| {
        Stmt::If(w.get(0), vec![w.set(5, Expr::long(value + 1))], vec![w.set(5, Expr::long(value))])
    };
    let over = vec![
        w.set(2, Expr::truth(false)),
        Stmt::If(w.get(0), vec![w.set(3, length(w))], vec![w.set(3, Expr::time(0))]),
        w.set(4, Expr::time(0)),
        with_input(w, 0),
    ];
    let going = vec![w.set(2, Expr::truth(true)), w.set(3, w.get(4)), with_input(w, 2)];
    let running = vec![Stmt::If(within, going, over.clone())];
    let mut first = vec![w.set(4, Expr::time(0))];
    first.extend(running.clone());
    vec![Stmt::If(starts, first, vec![Stmt::If(runs, running, over)])]
}
