//! The interpreter of code: receptivities, conditions and bodies.
//!
//! [`crate::Program::new`] has checked that code never pops a value that is not there.
//! So only a value can be wrong, and that is a [`Fault`] with its place.

use crate::bits::{bit, set_bit, word};
use crate::fault::{Fault, FaultKind};
use crate::joined::{Compute, Operand, Sink, Step};
use crate::layout::{REQUESTS, START, head};
use crate::memory::{read, write};
use crate::number::{self, arith, call, compare, convert, limit, negate, truncate};
use crate::ops::{Addr, Arith, Code, GroupId, Num, Op, Service, WORK};
use crate::program::Program;
use crate::state::State;
use crate::tables::{NONE, Receptivity};
use crate::{fb, text};

#[inline(always)]
pub(crate) fn holds(p: &Program, s: &mut State, receptivity: Receptivity) -> Result<bool, Fault> {
    Ok(match receptivity {
        Receptivity::True => true,
        Receptivity::Word(a) => read(s, a) != 0,
        Receptivity::NotWord(a) => read(s, a) == 0,
        Receptivity::Code(code) => value(p, s, code)? != 0,
    })
}

/// Runs code that pushes one value.
#[inline]
pub(crate) fn value(p: &Program, s: &mut State, code: Code) -> Result<u64, Fault> {
    match p.decisions.of(code) {
        NONE => interpreted(p, s, code),
        first => Ok(u64::from(p.decisions.decide(&s.image, first))),
    }
}

#[inline(never)]
fn interpreted(p: &Program, s: &mut State, code: Code) -> Result<u64, Fault> {
    run(p, s, code)?;
    Ok(s.scratch.stack.pop())
}

/// True if a condition is true; an empty one is.
#[inline]
pub(crate) fn condition(p: &Program, s: &mut State, code: Code) -> Result<bool, Fault> {
    Ok(code.is_empty() || value(p, s, code)? != 0)
}

/// The word of a cell of an array: the row of the array, the place of the cell.
#[inline(always)]
fn cell(p: &Program, row: u32, place: u64) -> Result<Addr, FaultKind> {
    match p.joined.arrays.get(row as usize) {
        Some((base, len)) if place < u64::from(*len) => Ok(Addr(base.0 + place as u32)),
        _ => Err(FaultKind::Range),
    }
}

/// The value of an operand.
#[inline(always)]
fn take(p: &Program, s: &mut State, operand: Operand) -> u64 {
    match s.image.get(operand.0 as usize) {
        Some(word) => *word,
        None => aside(p, s, operand),
    }
}

/// The value of an operand that is no word.
#[inline(always)]
fn aside(p: &Program, s: &mut State, operand: Operand) -> u64 {
    if operand == Operand::TOP {
        return s.scratch.stack.pop();
    }
    word(&p.joined.constants, operand.0.wrapping_sub(p.joined.words) as usize)
}

/// The values of two operands, the last of which is on top.
#[inline(always)]
fn take_two(p: &Program, s: &mut State, [a, b, _]: [Operand; 3]) -> (u64, u64) {
    let b = take(p, s, b);
    (take(p, s, a), b)
}

/// The same as LREAL.
#[inline(always)]
fn take_reals(p: &Program, s: &mut State, operands: [Operand; 3]) -> (f64, f64) {
    let (a, b) = take_two(p, s, operands);
    (f64::from_bits(a), f64::from_bits(b))
}

/// Runs code to its end.
pub(crate) fn run(p: &Program, s: &mut State, code: Code) -> Result<(), Fault> {
    s.scratch.worked = true;
    let steps = p.joined.steps.get(..code.end as usize).unwrap_or(&[]);
    let mut pc = code.start;
    while let Some(mut step) = steps.get(pc as usize) {
        let shorter;
        if pc + u32::from(step.len) > code.end {
            // Another code goes on behind the end of this one.
            shorter = p.joined.step(&p.tables.code, pc, code.end);
            step = &shorter;
        }
        pc = make(p, s, step, pc)?;
    }
    Ok(())
}

/// Makes one step; returns the place of the next one.
#[inline(always)]
fn make(p: &Program, s: &mut State, step: &Step, pc: u32) -> Result<u32, Fault> {
    let next = pc + u32::from(step.len);
    let operands = step.operands;
    let fault = |kind| Fault { kind, at: Some(pc + u32::from(step.lead)) };
    let value = match step.compute {
        Compute::Same => take(p, s, operands[0]),
        Compute::Not => u64::from(take(p, s, operands[0]) == 0),
        Compute::And => {
            let (a, b) = take_two(p, s, operands);
            a & b
        }
        Compute::Or => {
            let (a, b) = take_two(p, s, operands);
            a | b
        }
        Compute::Xor => {
            let (a, b) = take_two(p, s, operands);
            a ^ b
        }
        Compute::Signed(orders) => {
            let (a, b) = take_two(p, s, operands);
            orders.hold(a as i64, b as i64)
        }
        Compute::Unsigned(orders) => {
            let (a, b) = take_two(p, s, operands);
            orders.hold(a, b)
        }
        Compute::Real(orders) => {
            let (a, b) = take_reals(p, s, operands);
            orders.hold(a, b)
        }
        Compute::Add => {
            let (a, b) = take_reals(p, s, operands);
            (a + b).to_bits()
        }
        Compute::Sub => {
            let (a, b) = take_reals(p, s, operands);
            (a - b).to_bits()
        }
        Compute::Mul => {
            let (a, b) = take_reals(p, s, operands);
            (a * b).to_bits()
        }
        Compute::Limit => {
            let most = take(p, s, operands[2]);
            let (least, v) = take_two(p, s, operands);
            limit(Num::F64, least, v, most)
        }
        Compute::Sel => {
            let on = take(p, s, operands[2]);
            let (chosen, off) = take_two(p, s, operands);
            if chosen == 0 { off } else { on }
        }
        Compute::Compare(c, n) => {
            let (a, b) = take_two(p, s, operands);
            u64::from(compare(c, n, a, b))
        }
        Compute::Arith(op, n) => {
            let (a, b) = take_two(p, s, operands);
            arith(op, n, a, b).map_err(fault)?
        }
        Compute::Neg(n) => negate(n, take(p, s, operands[0])).map_err(fault)?,
        Compute::Convert(from, to) => convert(from, to, take(p, s, operands[0])).map_err(fault)?,
        Compute::Cell(row) => {
            let place = take(p, s, operands[0]);
            read(s, cell(p, row, place).map_err(fault)?)
        }
        Compute::Element(row) => {
            let (index, low) = take_two(p, s, operands);
            let place = arith(Arith::Sub, Num::I64, index, low).map_err(fault)?;
            let at = Some(pc + u32::from(step.lead) + 1);
            read(s, cell(p, row, place).map_err(|kind| Fault { kind, at })?)
        }
        Compute::Alone => return alone(p, s, pc),
    };
    match step.sink {
        Sink::Push => s.scratch.stack.push(value),
        Sink::Store(a) => write(p, s, a, value),
        Sink::StoreAt(row) => {
            let place = s.scratch.stack.pop();
            let at = Some(next - 1);
            write(p, s, cell(p, row, place).map_err(|kind| Fault { kind, at })?, value);
        }
        Sink::Unless(to) if value == 0 => return jump(s, next - 1, to),
        Sink::When(to) if value != 0 => return jump(s, next - 1, to),
        Sink::Unless(_) | Sink::When(_) => {}
    }
    Ok(next)
}

/// Goes on at `to` behind the jump at `at`. A jump back is counted: a round of a loop. Jumps ahead
/// come to an end by themselves.
#[inline(always)]
fn jump(s: &mut State, at: u32, to: u32) -> Result<u32, Fault> {
    if to <= at {
        s.scratch.work += 1;
        if s.scratch.work > WORK {
            return Err(Fault { kind: FaultKind::Work, at: Some(at) });
        }
    }
    Ok(to)
}

/// Runs an instruction that stands alone; returns the place of the next one.
#[inline(never)]
fn alone(p: &Program, s: &mut State, pc: u32) -> Result<u32, Fault> {
    match p.tables.code.get(pc as usize) {
        Some(Op::Jump(to)) => jump(s, pc, *to),
        Some(op) if *op != Op::Return => {
            rare(p, s, *op).map_err(|kind| Fault { kind, at: Some(pc) })?;
            Ok(pc + 1)
        }
        _ => Ok(u32::MAX),
    }
}

/// The instructions that are not joined with others.
fn rare(p: &Program, s: &mut State, op: Op) -> Result<(), FaultKind> {
    match op {
        Op::Active(step) => {
            let v = u64::from(s.steps.contains(&s.image, step.0));
            s.scratch.stack.push(v);
        }
        Op::Rise(w) => {
            let v = u64::from(bit(&s.image, p.layout.rise, w.0));
            s.scratch.stack.push(v);
        }
        Op::Fall(w) => {
            let v = u64::from(bit(&s.image, p.layout.fall, w.0));
            s.scratch.stack.push(v);
        }
        Op::Timer(w) => {
            let v = u64::from(bit(&s.image, p.layout.q, w.0));
            s.scratch.stack.push(v);
        }
        Op::GroupActive(g) => {
            let v = u64::from(s.group_active(p, g));
            s.scratch.stack.push(v);
        }
        Op::StepTime(step) => {
            let v = s.step_time(p, step) as u64;
            s.scratch.stack.push(v);
        }
        Op::WasActive(step) => {
            let turned = bit(&s.scratch.turned, 0, step.0);
            let was =
                if turned { bit(&s.scratch.was, 0, step.0) } else { s.steps.contains(&s.image, step.0) };
            s.scratch.stack.push(u64::from(was));
        }
        Op::GroupTime(g) => {
            let v = s.group_time(p, g) as u64;
            s.scratch.stack.push(v);
        }
        Op::StepAge(step) => {
            let v = s.step_age(p, step) as u64;
            s.scratch.stack.push(v);
        }
        Op::GroupAge(g) => {
            let v = s.group_age(p, g) as u64;
            s.scratch.stack.push(v);
        }
        Op::Due(period) => {
            let v = u64::from(s.is_due(p, period));
            s.scratch.stack.push(v);
        }
        Op::StepTenths(step) => {
            let v = (s.step_time(p, step) / 100_000_000).clamp(0, 9999) as u64;
            s.scratch.stack.push(v);
        }
        Op::Trunc(from, to) => {
            let v = truncate(from, to, s.scratch.stack.pop())?;
            s.scratch.stack.push(v);
        }
        Op::Call(f, n, count) => {
            let v = call(f, n, s.scratch.stack.top(usize::from(count)))?;
            s.scratch.stack.drop(usize::from(count));
            s.scratch.stack.push(v);
        }
        Op::Text { function, to, cap } => text::call(p, s, function, to, cap)?,
        Op::CompareText(c) => text::compare(s, c),
        Op::StoreText { to, cap } => {
            let from = s.scratch.stack.pop();
            text::copy(p, s, from, to, cap);
        }
        Op::ToText { from, time, to, cap } => text::from_number(p, s, from, time, to, cap),
        Op::FromText(n) => text::to_number(s, n)?,
        Op::Fb(block, base) => fb::call(p, s, block, base)?,
        Op::Service(service) => request(p, s, service),
        Op::ScanTime => {
            let v = word(&s.image, head::DT);
            s.scratch.stack.push(v);
        }
        Op::Random(a) => {
            let seed = read(s, a).wrapping_add(number::RANDOM_STEP);
            write(p, s, a, seed);
            s.scratch.stack.push(number::random(seed));
        }
        Op::Drop => {
            s.scratch.stack.pop();
        }
        // `joined.rs` joins them.
        Op::Push(_)
        | Op::Load(_)
        | Op::Store(_)
        | Op::LoadAt { .. }
        | Op::StoreAt { .. }
        | Op::Not
        | Op::And
        | Op::Or
        | Op::Xor
        | Op::Neg(_)
        | Op::Arith(..)
        | Op::Compare(..)
        | Op::Convert(..)
        | Op::JumpUnless(_)
        // `alone` has done them.
        | Op::Jump(_)
        | Op::Return => {}
    }
    Ok(())
}

/// Notes a request; it takes back what was asked for the same steps before.
fn request(p: &Program, s: &mut State, service: Service) {
    let [init, clear, set, reset] = p.layout.requests;
    let (base, i) = match service {
        Service::ResetTimes => return reset_times(p, s),
        Service::Start => {
            s.set_flag(REQUESTS, true);
            return s.set_flag(START, true);
        }
        Service::Init(g) => (init, g.0),
        Service::Clear(g) => (clear, g.0),
        Service::Set(step) => (set, step.0),
        Service::Reset(step) => (reset, step.0),
    };
    s.set_flag(REQUESTS, true);
    set_bit(&mut s.image, base, i, true);
    match service {
        Service::Init(g) | Service::Clear(g) => {
            let steps = p.tables.groups.get(g.0 as usize).map(|g| g.steps).unwrap_or_default();
            for step in steps.start..steps.end {
                set_bit(&mut s.image, set, step, false);
            }
        }
        Service::Set(step) => drop(set_bit(&mut s.image, reset, step.0, false)),
        Service::Reset(step) => drop(set_bit(&mut s.image, set, step.0, false)),
        Service::Start | Service::ResetTimes => {}
    }
}

/// RESET_XIT: active steps start anew at 0, the others have been active for 0.
fn reset_times(p: &Program, s: &mut State) {
    let (clock, now) = (s.clock(p) as u64, s.now() as u64);
    let l = &p.layout;
    for i in 0..p.tables.steps.len() as u32 {
        let active = s.steps.contains(&s.image, i);
        s.set(l.age(i) as usize, if active { now } else { 0 });
        s.set(l.stamp(i) as usize, if active { clock } else { 0 });
    }
    for g in 0..p.tables.groups.len() as u32 {
        let active = s.group_active(p, GroupId(g));
        s.set((l.group_ages + g) as usize, if active { now } else { 0 });
        s.set((l.group_stamps + g) as usize, if active { clock } else { 0 });
    }
}
