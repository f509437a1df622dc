//! The times of an image one by one, for those who search without counting scans.
//!
//! A time that code only compares with constants acts alike between two of them. [`Program::times`]
//! finds the bounds: within an interval between two neighbours, the limits included from below, no
//! scan can tell one value of the time from another. It reads the program as `clocks.rs` does.

use alloc::vec;
use alloc::vec::Vec;

use crate::bits::word;
use crate::block_words::{MEMORY, STARTS, TIMED, timer_latched};
use crate::clocks::{Owner, Reading};
use crate::layout::{STARTED, head};
use crate::number::{arith, call, compare, convert};
use crate::ops::{Addr, Arith, Block, Builtin, Cmp, Code, Num, Op};
use crate::program::Program;
use crate::tables::Receptivity;

/// A time in the image of a state, such as that of a step or a timer.
#[derive(Clone, Debug)]
pub struct Time {
    kind: Kind,
    at: u32,
    /// It counts scans, not nanoseconds.
    pub scans: bool,
    /// It begins again by itself when it reaches this time, in ns; 0 where it does not.
    pub period: i64,
    /// The bounds, ascending and above 0, in the unit of the time. `None` where code reads the time in
    /// another way, so that every value may matter.
    pub bounds: Option<Vec<i64>>,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Of a step or a group; whether some code may read it when that is not active.
    Stamp(Owner, bool),
    /// Of this watch.
    Timer(u32),
    /// Of the control block at this word; place in [`TIMED`].
    Block(u32, u32),
    /// Of the instance of TON, TOF or TP at this word; whether nobody reads its ET.
    Instance(u32, Block, bool),
    Period(i64),
}

/// The state of a time in a canonical image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Elapsed {
    /// Its value does not matter before it begins anew.
    Off,
    /// It has stopped at this value.
    Still(i64),
    /// It runs, and had this value at the latest scan.
    Runs(i64),
}

/// ET of a timer that runs and has not ended: no call gives it this value, so that each call changes it, as
/// time itself does.
const UNDER_WAY: u64 = u64::MAX;

impl Time {
    /// The state of the time in an image that [`crate::State::canonical`] made. Values beyond the last
    /// bound may be capped.
    pub fn elapsed(&self, p: &Program, image: &[u64]) -> Elapsed {
        let value = word(image, self.at as usize) as i64;
        let runs = match self.kind {
            Kind::Stamp(of, lasts) => {
                let active = is_active(p, image, of);
                if !active && lasts {
                    return Elapsed::Still(value);
                }
                active
            }
            Kind::Timer(watch) => p.layout.running.contains(image, watch),
            Kind::Block(at, place) => timer_latched(word(image, (at + MEMORY) as usize), place),
            Kind::Instance(at, block, _) => {
                let memory = word(image, (at + 5) as usize);
                if block == Block::Ton { memory & 1 != 0 } else { memory & 2 != 0 }
            }
            Kind::Period(period) => {
                if word(image, head::FLAGS) & STARTED == 0 {
                    return Elapsed::Off;
                }
                return Elapsed::Runs(period.wrapping_sub(value));
            }
        };
        if runs { Elapsed::Runs(0i64.wrapping_sub(value)) } else { Elapsed::Off }
    }

    /// Gives the time another value, as if it had begun so much earlier, or had stopped there. It goes on
    /// running, or stays as it is.
    pub fn put(&self, p: &Program, image: &mut [u64], elapsed: i64) {
        let value = match (self.kind, self.elapsed(p, image)) {
            (_, Elapsed::Off) => return,
            (Kind::Period(period), _) => period.wrapping_sub(elapsed),
            (_, Elapsed::Runs(_)) => 0i64.wrapping_sub(elapsed),
            (_, Elapsed::Still(_)) => elapsed,
        };
        if let Some(w) = image.get_mut(self.at as usize) {
            *w = value as u64;
        }
    }

    /// Makes a word one of few values where nobody reads more of it: the time itself when it is off, and ET
    /// of a timer.
    pub fn smooth(&self, p: &Program, image: &mut [u64]) {
        let Some(bounds) = &self.bounds else { return };
        match self.kind {
            Kind::Stamp(of, false) if !is_active(p, image, of) => {
                image.get_mut(self.at as usize).into_iter().for_each(|w| *w = 0);
            }
            Kind::Instance(at, _, true) => {
                if let Some(et) = image.get_mut((at + 3) as usize)
                    && *et != 0
                    && !bounds.contains(&(*et as i64))
                {
                    *et = UNDER_WAY;
                }
            }
            _ => {}
        }
    }
}

fn is_active(p: &Program, image: &[u64], of: Owner) -> bool {
    match of {
        Owner::Step(i) => p.layout.steps.contains(image, i),
        Owner::Group(i) => word(image, (p.layout.groups + i) as usize) != 0,
    }
}

impl Program {
    /// All times whose values some scan may read; `None` where times cannot be told from other words.
    ///
    /// Two canonical images that differ only in times that run, and agree in the interval between
    /// [`Time::bounds`] of each of them behind the next time step, have equal scans: the same situations,
    /// reports and faults; each time is 0, stops, or goes on in both.
    pub fn times(&self) -> Option<Vec<Time>> {
        let (t, l, c) = (&self.tables, &self.layout, &self.clocks);
        if c.absolute {
            return None;
        }
        let code = Bounds { code: Reading::new(t) };
        let mut times = Vec::new();
        let mut add = |kind, at, scans, bounds: Option<Vec<i64>>| {
            let period = if let Kind::Period(p) = kind { p } else { 0 };
            times.push(Time { kind, at, scans, period, bounds: bounds.map(sorted) });
        };
        for s in &c.stamps {
            let bounds = code.of_stamp(s.of, s.scans);
            add(Kind::Stamp(s.of, code.lasts(s.of)), s.at, s.scans, bounds);
        }
        for timer in &c.timers {
            let times = t.watches.get(timer.watch as usize).and_then(|w| w.times);
            let bounds = times.and_then(|(on, off)| Some(vec![code.pushed(on)?, code.pushed(off)?]));
            add(Kind::Timer(timer.watch), l.start + timer.watch, false, bounds);
        }
        for (i, _) in (0u32..).zip(&t.blocks).filter(|(_, b)| !b.plain) {
            let Some(at) = l.block_at.get(i as usize).copied() else { continue };
            for (place, input) in (0u32..).zip(TIMED) {
                let mine = || t.contributions.iter().filter(|c| c.block == i && u32::from(c.input) == input);
                if mine().next().is_none() {
                    continue;
                }
                let given = mine().filter(|c| !c.time.is_empty());
                let bounds = given.map(|c| code.pushed(c.time)).collect();
                add(Kind::Block(at, place), at + STARTS + place, false, bounds);
            }
        }
        for i in &c.instances {
            let base = i.at - l.vars;
            let free = !code.code.is_reached(base, i.block, base + 3);
            let bounds = code.code.values(base + 1).filter(|_| free).map(singled);
            add(Kind::Instance(i.at, i.block, free), i.at + 4, false, bounds);
        }
        for (at, period) in (l.periods..).zip(&t.periods).filter(|(_, p)| **p > 0) {
            add(Kind::Period(*period), at, false, Some(vec![*period]));
        }
        Some(times)
    }
}

fn sorted(mut bounds: Vec<i64>) -> Vec<i64> {
    bounds.retain(|b| *b > 0);
    bounds.sort_unstable();
    bounds.dedup();
    bounds
}

/// PT of a timer has one of these values. With one of them, all that a call asks is whether it is over. With more
/// than one, ET may be at one of them while PT is another.
fn singled(mut values: Vec<i64>) -> Vec<i64> {
    values.retain(|v| *v > 0);
    values.sort_unstable();
    values.dedup();
    if values.len() < 2 {
        return values;
    }
    values.into_iter().flat_map(|v| [v, v.saturating_add(1)]).collect()
}

/// An operation on a time before it is compared. Each keeps the order of its values.
#[derive(Clone, Copy)]
enum Follow {
    Div(Num, u64),
    Min(Num, u64),
    Convert(Num, Num),
}

/// The code of a program, to be searched for comparisons of times.
struct Bounds<'a> {
    code: Reading<'a>,
}

impl Bounds<'_> {
    /// The value that a code pushes, where it is a constant.
    fn pushed(&self, code: Code) -> Option<i64> {
        if code.end.checked_sub(code.start)? != 1 {
            return None;
        }
        self.constant(self.code.t.code.get(code.start as usize).copied()).map(|v| v as i64)
    }

    /// The constant that an instruction pushes: its own, or a variable's that nothing writes.
    fn constant(&self, op: Option<Op>) -> Option<u64> {
        match op? {
            Op::Push(v) => Some(v),
            Op::Load(Addr(a)) => match self.code.values(a)?[..] {
                [v] => Some(v as u64),
                _ => None,
            },
            _ => None,
        }
    }

    /// The bounds of the time of a step or a group.
    fn of_stamp(&self, of: Owner, scans: bool) -> Option<Vec<i64>> {
        let by_scans = self.code.t.rules.scan_clock;
        let mut found = Vec::new();
        for (pc, op) in self.code.t.code.iter().enumerate() {
            let (owner, age) = match op {
                Op::StepTime(s) | Op::StepTenths(s) => (Owner::Step(s.0), false),
                Op::StepAge(s) => (Owner::Step(s.0), true),
                Op::GroupTime(g) => (Owner::Group(g.0), false),
                Op::GroupAge(g) => (Owner::Group(g.0), true),
                _ => continue,
            };
            let same = match (owner, of) {
                (Owner::Step(a), Owner::Step(b)) | (Owner::Group(a), Owner::Group(b)) => a == b,
                _ => false,
            };
            if same && (!by_scans || age != scans) {
                let tenths = matches!(op, Op::StepTenths(_));
                found.extend(self.at(pc, tenths)?);
            }
        }
        Some(found)
    }

    /// True if code may read a time when its step or group is not active. A receptivity is judged only when all
    /// steps before its transition are active, and `5s/X1` asks for the activity of the step.
    fn lasts(&self, of: Owner) -> bool {
        let t = self.code.t;
        (0..t.code.len()).any(|pc| {
            let (asks, mine) = match (t.code.get(pc), of) {
                (Some(Op::StepTime(s) | Op::StepTenths(s) | Op::StepAge(s)), Owner::Step(i)) => {
                    (Op::Active(*s), s.0 == i)
                }
                (Some(Op::GroupTime(g) | Op::GroupAge(g)), Owner::Group(i)) => {
                    (Op::GroupActive(*g), g.0 == i)
                }
                _ => return false,
            };
            let before = pc.checked_sub(1).and_then(|b| t.code.get(b));
            let behind = [pc + 1, pc + 2, pc + 3].map(|at| self.code.op(at));
            let asked = before == Some(&asks)
                && self.code.op(pc).is_some()
                && matches!(behind, [Some(Op::Push(_)), Some(Op::Compare(..)), Some(Op::And)]);
            mine && !asked && !self.is_of_receptivity(pc, of)
        })
    }

    /// True if code stands in the receptivity of a transition behind a step. No other code shares it.
    fn is_of_receptivity(&self, pc: usize, of: Owner) -> bool {
        let (t, Owner::Step(step)) = (self.code.t, of) else { return false };
        let mut mine = t.transitions.iter().filter(|tr| match tr.receptivity {
            Receptivity::Code(code) => (code.start as usize..code.end as usize).contains(&pc),
            _ => false,
        });
        let follows = |tr: &crate::tables::Transition| {
            let mut found = false;
            t.each_from(tr, |s| found |= s == step);
            found
        };
        mine.next().is_some_and(follows) && mine.all(follows)
    }

    /// The bounds of the comparison to which a time goes that is pushed at `pc`.
    fn at(&self, pc: usize, tenths: bool) -> Option<Vec<i64>> {
        let mut chain = Vec::new();
        if tenths {
            chain.extend([Follow::Div(Num::I64, 100_000_000), Follow::Min(Num::I64, 9999)]);
        }
        let mut next = pc + 1;
        loop {
            match self.code.op(next)? {
                Op::Compare(c, n) => {
                    let alone = self.code.op(pc).is_some();
                    let before = pc.checked_sub(1).and_then(|b| self.code.t.code.get(b)).copied();
                    let constant = self.constant(before).filter(|_| alone)?;
                    return self.flips(&chain, turned(c), n, constant);
                }
                Op::Convert(from, to) => {
                    chain.push(Follow::Convert(from, to));
                    next += 1;
                }
                op => {
                    let (constant, behind) = self.converted(self.constant(Some(op))?, next + 1)?;
                    match self.code.op(behind)? {
                        Op::Compare(c, n) => return self.flips(&chain, c, n, constant),
                        Op::Arith(Arith::Div, n) if is_whole(n) && (constant as i64) > 0 => {
                            chain.push(Follow::Div(n, constant));
                        }
                        Op::Call(Builtin::Min, n, 2) => chain.push(Follow::Min(n, constant)),
                        _ => return None,
                    }
                    next = behind + 1;
                }
            }
        }
    }

    /// A constant behind the conversions that follow it, and the place of the next instruction.
    fn converted(&self, mut constant: u64, mut at: usize) -> Option<(u64, usize)> {
        while let Some(Op::Convert(from, to)) = self.code.op(at) {
            constant = convert(from, to, constant).ok()?;
            at += 1;
        }
        Some((constant, at))
    }

    /// The least times at which a comparison with a constant changes.
    fn flips(&self, chain: &[Follow], c: Cmp, n: Num, constant: u64) -> Option<Vec<i64>> {
        // A chain without a fault at both ends has none between them.
        follow(chain, 0)?;
        follow(chain, i64::MAX)?;
        let least = |c: Cmp| -> Option<Vec<i64>> {
            let holds = |x: i64| follow(chain, x).map(|v| compare(c, n, v, constant));
            if holds(0)? || !holds(i64::MAX)? {
                return Some(Vec::new());
            }
            let (mut no, mut yes) = (0i64, i64::MAX);
            while yes - no > 1 {
                let middle = no + (yes - no) / 2;
                if holds(middle)? { yes = middle } else { no = middle }
            }
            Some(vec![yes])
        };
        match c {
            Cmp::Ge | Cmp::Lt => least(Cmp::Ge),
            Cmp::Gt | Cmp::Le => least(Cmp::Gt),
            Cmp::Eq | Cmp::Ne => {
                let mut both = least(Cmp::Ge)?;
                both.extend(least(Cmp::Gt)?);
                Some(both)
            }
        }
    }
}

fn is_whole(n: Num) -> bool {
    !matches!(n, Num::Bool | Num::F32 | Num::F64)
}

/// A comparison with its sides exchanged.
fn turned(c: Cmp) -> Cmp {
    match c {
        Cmp::Lt => Cmp::Gt,
        Cmp::Le => Cmp::Ge,
        Cmp::Gt => Cmp::Lt,
        Cmp::Ge => Cmp::Le,
        Cmp::Eq | Cmp::Ne => c,
    }
}

/// The value that is made of a time; `None` for a fault.
fn follow(chain: &[Follow], time: i64) -> Option<u64> {
    chain.iter().try_fold(time as u64, |v, f| match *f {
        Follow::Div(n, by) => arith(Arith::Div, n, v, by).ok(),
        Follow::Min(n, most) => call(Builtin::Min, n, &[v, most]).ok(),
        Follow::Convert(from, to) => convert(from, to, v).ok(),
    })
}
