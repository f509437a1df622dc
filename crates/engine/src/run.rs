//! Running code: receptivities, conditions, bodies.
//!
//! Code has been checked by [`crate::Program::new`]: it never pops what is not
//! there. Only values can go wrong, and that is a [`Fault`] with its place.

use crate::bits::{bit, set_bit, word};
use crate::fault::{Fault, FaultKind};
use crate::number::{arith, call, compare, convert, negate, truncate};
use crate::state::{State, head};
use crate::{Addr, Code, Guard, Op, Program, Service, WORK};

/// Value of a word of the variable area.
#[inline(always)]
pub(crate) fn read(s: &State, addr: Addr) -> u64 {
    word(&s.w, (s.vars + addr.0) as usize)
}

/// Writes a word of the variable area; watches that read it are looked at again.
#[inline]
pub(crate) fn write(p: &Program, s: &mut State, addr: Addr, value: u64) {
    let at = (s.vars + addr.0) as usize;
    let old = word(&s.w, at);
    let lasts = addr.0 < p.locals;
    // An unchanged word still counts as written where writes are compared.
    if s.x.logging && lasts {
        log(s, addr, old);
    }
    if old == value {
        return;
    }
    if p.comes_and_goes && lasts {
        note(s, addr, old);
    }
    s.set(at, value);
    s.x.changed |= lasts;
    notice(p, s, addr);
}

/// Notes what a word was as the pass began, at the first write to it.
#[cold]
fn note(s: &mut State, addr: Addr, old: u64) {
    if !set_bit(&mut s.x.written_mark, 0, addr.0, true) {
        s.x.written.push((addr.0, old));
    }
}

fn log(s: &mut State, addr: Addr, old: u64) {
    let serial = s.x.serial;
    if let Some(mark) = s.x.log_mark.get_mut(addr.0 as usize)
        && *mark != serial
    {
        *mark = serial;
        s.x.log.push((addr.0, old));
    }
}

/// Marks the watches that read a word.
#[inline]
pub(crate) fn notice(p: &Program, s: &mut State, addr: Addr) {
    if p.t.word_watches.is_empty() {
        return;
    }
    let at = addr.0 as usize;
    let (Some(&from), Some(&to)) = (p.word_index.get(at), p.word_index.get(at + 1)) else { return };
    for (_, watch) in p.t.word_watches.get(from as usize..to as usize).unwrap_or(&[]) {
        p.layout.dirty.insert(&mut s.w, watch.0);
    }
}

/// The time that step times count in.
#[inline(always)]
pub(crate) fn clock(p: &Program, s: &State) -> i64 {
    word(&s.w, if p.t.rules.scan_clock { head::SCANS } else { head::NOW }) as i64
}

#[inline(always)]
pub(crate) fn guard(p: &Program, s: &mut State, g: Guard) -> Result<bool, Fault> {
    Ok(match g {
        Guard::True => true,
        Guard::Word(a) => read(s, a) != 0,
        Guard::NotWord(a) => read(s, a) == 0,
        Guard::Code(code) => value(p, s, code)? != 0,
    })
}

/// Runs code that pushes one value.
pub(crate) fn value(p: &Program, s: &mut State, code: Code) -> Result<u64, Fault> {
    run(p, s, code)?;
    Ok(s.x.stack.pop().unwrap_or(0))
}

/// Whether a condition holds; an empty one does.
pub(crate) fn condition(p: &Program, s: &mut State, code: Code) -> Result<bool, Fault> {
    Ok(code.is_empty() || value(p, s, code)? != 0)
}

fn pop(s: &mut State) -> u64 {
    s.x.stack.pop().unwrap_or(0)
}

/// Applies `f` to the two values on top.
fn two(s: &mut State, f: impl FnOnce(u64, u64) -> u64) {
    let b = pop(s);
    if let Some(a) = s.x.stack.last_mut() {
        *a = f(*a, b);
    }
}

fn index(s: &mut State, len: u32) -> Result<u32, FaultKind> {
    let i = pop(s) as i64;
    u32::try_from(i).ok().filter(|i| *i < len).ok_or(FaultKind::Range)
}

/// Runs code to its end.
pub(crate) fn run(p: &Program, s: &mut State, code: Code) -> Result<(), Fault> {
    let mut pc = code.start;
    while pc < code.end {
        let Some(op) = p.t.code.get(pc as usize) else { break };
        let at = pc;
        pc += 1;
        match *op {
            Op::Push(v) => s.x.stack.push(v),
            Op::Load(a) => {
                let v = read(s, a);
                s.x.stack.push(v);
            }
            Op::Store(a) => {
                let v = pop(s);
                write(p, s, a, v);
            }
            Op::Active(step) => {
                let v = u64::from(s.steps.contains(&s.w, step.0));
                s.x.stack.push(v);
            }
            Op::Rise(w) => {
                let v = u64::from(bit(&s.w, p.layout.rise, w.0));
                s.x.stack.push(v);
            }
            Op::Fall(w) => {
                let v = u64::from(bit(&s.w, p.layout.fall, w.0));
                s.x.stack.push(v);
            }
            Op::Timer(w) => {
                let v = u64::from(bit(&s.w, p.layout.q, w.0));
                s.x.stack.push(v);
            }
            Op::Not => {
                if let Some(v) = s.x.stack.last_mut() {
                    *v = u64::from(*v == 0);
                }
            }
            Op::And => two(s, |a, b| a & b),
            Op::Or => two(s, |a, b| a | b),
            Op::Xor => two(s, |a, b| a ^ b),
            Op::Compare(c, n) => two(s, |a, b| u64::from(compare(c, n, a, b))),
            Op::Jump(to) => {
                work(s, at)?;
                pc = to;
            }
            Op::JumpUnless(to) => {
                if pop(s) == 0 {
                    work(s, at)?;
                    pc = to;
                }
            }
            Op::Return => break,
            _ => rare(p, s, *op).map_err(|kind| Fault { kind, at: Some(at) })?,
        }
    }
    Ok(())
}

fn work(s: &mut State, at: u32) -> Result<(), Fault> {
    s.x.work += 1;
    if s.x.work > WORK { Err(Fault { kind: FaultKind::Work, at: Some(at) }) } else { Ok(()) }
}

/// The instructions that receptivities seldom have.
fn rare(p: &Program, s: &mut State, op: Op) -> Result<(), FaultKind> {
    match op {
        Op::LoadAt { base, len } => {
            let i = index(s, len)?;
            let v = read(s, Addr(base.0 + i));
            s.x.stack.push(v);
        }
        Op::StoreAt { base, len } => {
            let v = pop(s);
            let i = index(s, len)?;
            write(p, s, Addr(base.0 + i), v);
        }
        Op::GroupActive(g) => {
            let v = u64::from(s.group_active(p, g));
            s.x.stack.push(v);
        }
        Op::StepTime(step) => {
            let v = s.step_time(p, step) as u64;
            s.x.stack.push(v);
        }
        Op::WasActive(step) => {
            let turned = bit(&s.x.turned, 0, step.0);
            let was = if turned { bit(&s.x.was, 0, step.0) } else { s.steps.contains(&s.w, step.0) };
            s.x.stack.push(u64::from(was));
        }
        Op::GroupTime(g) => {
            let v = s.group_time(p, g) as u64;
            s.x.stack.push(v);
        }
        Op::StepAge(step) => {
            let v = s.step_age(p, step) as u64;
            s.x.stack.push(v);
        }
        Op::GroupAge(g) => {
            let v = s.group_age(p, g) as u64;
            s.x.stack.push(v);
        }
        Op::Due(period) => {
            let v = u64::from(crate::watch::is_due(p, s, period));
            s.x.stack.push(v);
        }
        Op::StepTenths(step) => {
            let v = (s.step_time(p, step) / 100_000_000).clamp(0, 9999) as u64;
            s.x.stack.push(v);
        }
        Op::Neg(n) => {
            let v = negate(n, pop(s))?;
            s.x.stack.push(v);
        }
        Op::Arith(a, n) => {
            let r = pop(s);
            let l = pop(s);
            s.x.stack.push(arith(a, n, l, r)?);
        }
        Op::Convert(from, to) => {
            let v = convert(from, to, pop(s))?;
            s.x.stack.push(v);
        }
        Op::Trunc(from, to) => {
            let v = truncate(from, to, pop(s))?;
            s.x.stack.push(v);
        }
        Op::Call(f, n, count) => {
            let from = s.x.stack.len().saturating_sub(usize::from(count));
            let v = call(f, n, s.x.stack.get(from..).unwrap_or(&[]))?;
            s.x.stack.truncate(from);
            s.x.stack.push(v);
        }
        Op::Text { function, to, cap } => crate::text::call(p, s, function, to, cap)?,
        Op::CompareText(c) => crate::text::compare(s, c),
        Op::StoreText { to, cap } => {
            let from = pop(s);
            crate::text::copy(p, s, from, to, cap);
        }
        Op::ToText { from, time, to, cap } => crate::text::from_number(p, s, from, time, to, cap),
        Op::FromText(n) => crate::text::to_number(s, n)?,
        Op::Fb(block, base) => crate::fb::call(p, s, block, base)?,
        Op::Service(service) => request(p, s, service),
        Op::ScanTime => {
            let v = word(&s.w, head::DT);
            s.x.stack.push(v);
        }
        Op::Random(a) => {
            // splitmix64 (Steele, Lea, Flood 2014): one word of state, any seed will do.
            let mut z = read(s, a).wrapping_add(0x9E37_79B9_7F4A_7C15);
            write(p, s, a, z);
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            z ^= z >> 31;
            let v = (z >> 11) as f64 / (1u64 << 53) as f64;
            s.x.stack.push(v.to_bits());
        }
        Op::Drop => {
            pop(s);
        }
        // The frequent ones are done by `run`.
        Op::Push(_)
        | Op::Load(_)
        | Op::Store(_)
        | Op::Active(_)
        | Op::Rise(_)
        | Op::Fall(_)
        | Op::Timer(_)
        | Op::Not
        | Op::And
        | Op::Or
        | Op::Xor
        | Op::Compare(..)
        | Op::Jump(_)
        | Op::JumpUnless(_)
        | Op::Return => {}
    }
    Ok(())
}

fn request(p: &Program, s: &mut State, service: Service) {
    let [init, clear, set, reset] = p.layout.requests;
    let (base, i) = match service {
        Service::Init(g) => (init, g.0),
        Service::Clear(g) => (clear, g.0),
        Service::Set(step) => (set, step.0),
        Service::Reset(step) => (reset, step.0),
        Service::ResetTimes => return reset_times(p, s),
    };
    crate::bits::set_bit(&mut s.w, base, i, true);
    s.flag(crate::state::REQUESTS, true);
}

/// RESET_XIT: active steps start anew at 0, the others have been active for 0.
fn reset_times(p: &Program, s: &mut State) {
    let (clock, now) = (clock(p, s) as u64, s.now() as u64);
    let l = &p.layout;
    for i in 0..p.t.steps.len() as u32 {
        let active = s.steps.contains(&s.w, i);
        s.set((l.ages + i) as usize, if active { now } else { 0 });
        s.set((l.stamps + i) as usize, if active { clock } else { 0 });
    }
    for g in 0..p.t.groups.len() as u32 {
        let active = s.group_active(p, crate::GroupId(g));
        s.set((l.group_ages + g) as usize, if active { now } else { 0 });
        s.set((l.group_stamps + g) as usize, if active { clock } else { 0 });
    }
}
