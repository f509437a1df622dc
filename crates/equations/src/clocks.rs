//! The clocks that something reads, and the memories of timer blocks.

use g7_compile::tree::Clock;
use g7_engine::{Addr, Arith, Block, Builtin, Cmp, GroupId, StepId};
use g7_model::Type;

use crate::form::{Class, Expr, MemoryId, Stmt, What};
use crate::make::Make;
use crate::whole::StepTimes;

impl Make<'_> {
    /// The memories of an instance: members, then what it remembers.
    pub(crate) fn instance(&mut self, block: Block, base: Addr) -> Vec<MemoryId> {
        use Type::{Bool, Int, Time};
        let types: &[Type] = match block {
            Block::Ctu | Block::Ctd => &[Bool, Bool, Int, Bool, Int, Bool],
            Block::Ctud => &[Bool, Bool, Bool, Bool, Int, Bool, Bool, Int, Bool, Bool],
            Block::Ton | Block::Tof | Block::Tp => &[Bool, Time, Bool, Time, Time, Type::Lint],
            Block::RTrig | Block::FTrig | Block::Sr | Block::Rs => &[Bool, Bool, Bool],
        };
        let timer = matches!(block, Block::Ton | Block::Tof | Block::Tp);
        let mut list = Vec::new();
        for (i, ty) in (0u32..).zip(types) {
            // A clock stands in place of the word that says when the timer started.
            list.push(if timer && i == 4 {
                self.memory(What::BlockClock(base), Class::Kept, Type::Time)
            } else {
                self.word(Addr(base.0 + i), *ty).0
            });
        }
        if let (true, Some(clock), Some(memory)) = (timer, list.get(4), list.get(5)) {
            // Of TOF and TP bit 1 says that time runs; TOF leaves 4 behind where it is over.
            let (op, value) = match block {
                Block::Tof => (Cmp::Eq, 2),
                Block::Tp => (Cmp::Ge, 2),
                _ => (Cmp::Ne, 0),
            };
            let runs = Expr::Read(*memory).compare(op, Type::Lint, Expr::long(value));
            self.runs(*clock, runs);
        }
        list
    }

    /// A clock that something reads.
    pub(crate) fn clock(&mut self, clock: Clock) -> Expr {
        let (what, ty) = match clock {
            Clock::Step(s) | Clock::StepAge(s) => (What::StepTime(s), Type::Time),
            Clock::StepScans(s) => (What::StepScans(s), Type::Lint),
            Clock::Group(g) | Clock::GroupAge(g) => (What::GroupTime(g), Type::Time),
            Clock::GroupScans(g) => (What::GroupScans(g), Type::Lint),
        };
        if let What::StepTime(step) | What::StepScans(step) = what
            && self.options.times == StepTimes::Stamps
            && self.t.rules.scan_clock == (ty == Type::Lint)
        {
            return self.stamped(step, ty);
        }
        let memory = self.memory(what, Class::Kept, ty);
        let active = match what {
            What::StepTime(s) | What::StepScans(s) => self.active(s.0),
            What::GroupTime(g) | What::GroupScans(g) => self.group_active(g),
            _ => Expr::truth(true),
        };
        self.runs(memory, active);
        Expr::Read(memory)
    }

    /// The time of a step that has a stamp.
    fn stamped(&mut self, step: StepId, ty: Type) -> Expr {
        let stamp = Expr::Read(self.memory(What::Stamp(step), Class::Kept, ty));
        let clock = self.memory(What::Clock, Class::Kept, ty);
        self.runs(clock, Expr::truth(true));
        let since = Expr::Read(clock).arith(Arith::Sub, ty, stamp.clone());
        Expr::Call(Builtin::Sel, ty, vec![self.active(step.0), stamp, since])
    }

    /// The stamp of a step, and the clock it is taken from.
    pub(crate) fn stamp(&self, step: StepId) -> Option<(MemoryId, Expr)> {
        Some((self.known(What::Stamp(step))?, Expr::Read(self.known(What::Clock)?)))
    }

    /// The time of a step in units of 100 ms, at most 9999 (INT).
    pub(crate) fn tenths(&mut self, step: StepId) -> Expr {
        let time = self.clock(Clock::Step(step));
        let nanos = Expr::Convert(Type::Time, Type::Lint, Box::new(time));
        let tenths = nanos.arith(Arith::Div, Type::Lint, Expr::long(100_000_000));
        let most = Expr::Call(Builtin::Min, Type::Lint, vec![tenths, Expr::long(9999)]);
        Expr::Convert(Type::Lint, Type::Int, Box::new(most))
    }

    /// The times of a step that comes on or goes off.
    pub(crate) fn times_of(&mut self, step: u32, on: bool) -> Vec<Stmt> {
        let stays = !on && self.t.rules.keep_step_time;
        if let Some((stamp, clock)) = self.stamp(StepId(step)) {
            let ty = self.of(stamp).map_or(Type::Time, |m| m.ty);
            let value = match on {
                true => clock,
                false if stays => clock.arith(Arith::Sub, ty, Expr::Read(stamp)),
                false => Expr::Const(ty, 0),
            };
            let mut list = vec![Stmt::Set(stamp, value)];
            list.extend(self.clocks_of(step, stays));
            return list;
        }
        self.clocks_of(step, stays)
    }

    /// The clocks of a step that comes on or goes off become 0, unless its time stays.
    fn clocks_of(&self, step: u32, stays: bool) -> Vec<Stmt> {
        if stays {
            return Vec::new();
        }
        let whats = [(What::StepTime(StepId(step)), Type::Time), (What::StepScans(StepId(step)), Type::Lint)];
        let known = whats.into_iter().filter_map(|(what, ty)| self.known(what).map(|m| (m, ty)));
        known.map(|(m, ty)| Stmt::Set(m, Expr::Const(ty, 0))).collect()
    }

    /// The times of a group whose steps have changed.
    pub(crate) fn group_times(&mut self, g: GroupId) -> Vec<Stmt> {
        let was = Expr::Read(self.flag(What::GroupWas(g)));
        let active = self.group_active(g);
        let whats = [(What::GroupTime(g), Type::Time), (What::GroupScans(g), Type::Lint)];
        let known: Vec<(MemoryId, Type)> =
            whats.into_iter().filter_map(|(what, ty)| self.known(what).map(|m| (m, ty))).collect();
        let zero: Vec<Stmt> = known.into_iter().map(|(m, ty)| Stmt::Set(m, Expr::Const(ty, 0))).collect();
        let mut list = Stmt::when(active.clone().and(was.clone().negated()), zero.clone());
        if !self.t.rules.keep_step_time {
            list.extend(Stmt::when(was.and(active.negated()), zero));
        }
        list
    }

    pub(crate) fn scan_time(&mut self) -> MemoryId {
        self.memory(What::Dt, Class::Input, Type::Time)
    }

    /// RESET_XIT: all step times become 0.
    pub(crate) fn reset_times(&mut self) -> Vec<Stmt> {
        if self.apart {
            return vec![Stmt::Set(self.flag(What::ResetTimes), Expr::truth(true))];
        }
        let all = (0u32..).map(MemoryId).zip(&self.memories);
        let clocks = all.filter_map(|(id, m)| match m.what {
            What::StepTime(_) | What::StepScans(_) | What::GroupTime(_) | What::GroupScans(_) => {
                Some(Stmt::Set(id, Expr::Const(m.ty, 0)))
            }
            What::Stamp(step) => {
                let clock = Expr::Read(self.known(What::Clock)?);
                let active = Expr::Read(self.known(What::Step(step))?);
                let zero = Expr::Const(m.ty, 0);
                Some(Stmt::Set(id, Expr::Call(Builtin::Sel, m.ty, vec![active, zero, clock])))
            }
            _ => None,
        });
        clocks.collect()
    }

    /// An edge lives one pass of its own charts: longer than a scan where they
    /// have a period.
    pub(crate) fn flag_of_watch(&mut self, what: What, w: g7_engine::WatchId) -> MemoryId {
        let period = self.t.watches.get(w.0 as usize).map_or(0, |w| w.period);
        let lasts = self.t.periods.get(period as usize).is_some_and(|p| *p > 0);
        self.memory(what, if lasts { Class::Kept } else { Class::Scratch }, Type::Bool)
    }

    /// The groups that some clock counts for.
    pub(crate) fn timed_groups(&self) -> Vec<GroupId> {
        let groups = self.memories.iter().filter_map(|m| match m.what {
            What::GroupTime(g) | What::GroupScans(g) => Some(g),
            _ => None,
        });
        let mut groups: Vec<GroupId> = groups.collect();
        groups.sort_unstable();
        groups.dedup();
        groups
    }
}
