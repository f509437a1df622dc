//! The parts round the passes: clocks and periods, edges and delays, PRE and
//! POST, actions of each scan, counts and limits (SEMANTICS section 4).

use g7_engine::{Arith, Cmp, FaultKind, NONE, StepId, WatchId};
use g7_model::{Span, Type};

use crate::change::{add_one, at_most};
use crate::form::{About, Class, Expr, MemoryId, Section, Stmt, What};
use crate::make::{Make, lower, raise};

impl Make<'_> {
    /// Clocks that run, periods that are due. Made last: by then all are known.
    pub(crate) fn clocks(&mut self) -> Section {
        let mut s = Section::new("Time");
        for (i, period) in (0u32..).zip(&self.t.periods) {
            if *period > 0 {
                let list = self.period(i, *period);
                s.body.extend(list);
            }
        }
        for (clock, runs) in self.clocks.clone() {
            let ty = self.of(clock).map_or(Type::Time, |m| m.ty);
            // Clocks that count scans count one; the others the time gone by.
            let more = if ty == Type::Lint { Expr::long(1) } else { Expr::Read(self.scan_time()) };
            let next = Expr::Read(clock).arith(Arith::Add, ty, more);
            s.body.extend(Stmt::when(runs, vec![Stmt::Set(clock, next)]));
        }
        s
    }

    /// A period is due once its time has run out; instants missed are skipped.
    fn period(&mut self, i: u32, period: i64) -> Vec<Stmt> {
        let until = self.memory(What::Until(i), Class::Kept, Type::Time);
        let due = self.flag(What::Due(i));
        let started = Expr::Read(self.kept(What::Started));
        let dt = Expr::Read(self.scan_time());
        let left = Expr::Read(until).arith(Arith::Sub, Type::Time, dt);
        let over = Expr::Read(until).compare(Cmp::Le, Type::Time, Expr::time(0));
        let nanos = Expr::Convert(Type::Time, Type::Lint, Box::new(Expr::Read(until)));
        let missed = Expr::Neg(Type::Lint, Box::new(nanos))
            .arith(Arith::Div, Type::Lint, Expr::long(period))
            .arith(Arith::Add, Type::Lint, Expr::long(1));
        let more = missed.arith(Arith::Mul, Type::Lint, Expr::long(period));
        let more = Expr::Convert(Type::Lint, Type::Time, Box::new(more));
        let next = Expr::Read(until).arith(Arith::Add, Type::Time, more);
        vec![
            Stmt::Set(until, left),
            Stmt::Set(due, over.or(started.negated())),
            Stmt::If(Expr::Read(due), vec![Stmt::Set(until, next)], Vec::new()),
        ]
    }

    /// Edges and delays, as each pass begins.
    pub(crate) fn watches(&mut self) -> Section {
        let mut s = Section::new("Edges and delays");
        for i in 0..self.t.watches.len() as u32 {
            let Some(w) = self.t.watches.get(i as usize).copied() else { break };
            let id = WatchId(i);
            s.body.push(Stmt::About(About::Watch(id)));
            let (mut list, value) = self.value(w.code);
            let now = match value {
                Expr::Read(_) | Expr::Const(..) => value,
                e => {
                    let now = self.flag(What::Watched(id));
                    list.push(Stmt::Set(now, e));
                    Expr::Read(now)
                }
            };
            let before = self.kept(What::WatchedBefore(id));
            match w.times {
                None => self.edges(id, &now, before, &mut list),
                Some((on, off)) => self.delay(id, &now, before, [on, off], &mut list),
            }
            list.push(Stmt::Set(before, now));
            let due = self.due(w.period);
            s.body.extend(Stmt::when(due, list));
        }
        s
    }

    fn edges(&mut self, id: WatchId, now: &Expr, before: MemoryId, list: &mut Vec<Stmt>) {
        // Nothing is an edge as the first scan begins; its first pass sets Started.
        let later = Expr::Read(self.kept(What::Started));
        let was = Expr::Read(before);
        for (what, e) in [
            (What::Rise(id), Expr::all([now.clone(), was.clone().negated(), later.clone()])),
            (What::Fall(id), Expr::all([now.clone().negated(), was, later])),
        ] {
            let to = self.flag_of_watch(what, id);
            list.push(Stmt::Set(to, e));
        }
    }

    /// `t1/e/t2`: the condition is sampled first; where it fell before the timer
    /// was seen to be due, the timer never came true.
    fn delay(
        &mut self,
        id: WatchId,
        now: &Expr,
        before: MemoryId,
        times: [g7_engine::Code; 2],
        list: &mut Vec<Stmt>,
    ) {
        let clock = self.memory(What::TimerClock(id), Class::Kept, Type::Time);
        let q = self.kept(What::Timer(id));
        self.runs(clock, Expr::Read(before).xor(Expr::Read(q)));
        let turns = now.clone().xor(Expr::Read(before));
        list.extend(Stmt::when(turns, vec![Stmt::Set(clock, Expr::time(0))]));
        for (code, to) in times.into_iter().zip([true, false]) {
            let waits = if to {
                now.clone().and(Expr::Read(q).negated())
            } else {
                now.clone().negated().and(Expr::Read(q))
            };
            let (mut then, time) = self.value(code);
            let known = match &time {
                Expr::Const(_, v) => Some(*v as i64),
                _ => None,
            };
            let over = match known {
                Some(t) if t <= 0 => Expr::truth(true),
                Some(_) => Expr::Read(clock).compare(Cmp::Ge, Type::Time, time),
                // A negative time is none.
                None => Expr::Read(clock).compare(
                    Cmp::Ge,
                    Type::Time,
                    Expr::Call(g7_engine::Builtin::Max, Type::Time, vec![time, Expr::time(0)]),
                ),
            };
            then.extend(Stmt::when(over, vec![Stmt::Set(q, Expr::truth(to))]));
            // The clock of a timer that waits for nothing stands at 0.
            list.extend(Stmt::when(waits, then));
        }
        let idle = now.clone().xor(Expr::Read(q)).negated();
        list.extend(Stmt::when(idle, vec![Stmt::Set(clock, Expr::time(0))]));
    }

    /// PRE, services and what they ask for: once a scan, behind the first look at
    /// the edges.
    pub(crate) fn opening(&mut self) -> Vec<Section> {
        let mut pre = Section::new("PRE");
        pre.body = self.work(self.t.pre);
        pre.body.extend(self.work(self.t.services));
        let mut sections = vec![pre];
        let early = self.t.rules.late_actions.then(|| self.early_pulses());
        let early = early.filter(|s| !s.body.is_empty());
        if early.is_some() {
            let mut start = Section::new("A step has come on before the evolution");
            let (stepped, started) = (self.flag(What::Stepped), self.kept(What::Started));
            start.body.push(Stmt::Set(stepped, Expr::Read(started).negated()));
            start.body.extend(self.no_early_pulses());
            sections.push(start);
        }
        sections.extend(self.requests());
        sections.extend(early);
        sections.push(self.before_the_evolution());
        if self.t.rules.stable {
            let all = sections.into_iter().flat_map(|s| s.body).collect();
            let opening = self.flag(What::Opening);
            let body = Stmt::when(Expr::Read(opening), all);
            return vec![Section { title: "PRE, once a scan", body }];
        }
        sections
    }

    fn before_the_evolution(&mut self) -> Section {
        let mut s = Section::new("Before the evolution");
        let started = self.kept(What::Started);
        s.body.push(Stmt::Set(started, Expr::truth(true)));
        if self.t.rules.periodic_first {
            for (row, step) in self.periodics() {
                let (before, active) = (self.flag(What::Periodic(row)), self.active(step));
                s.body.push(Stmt::Set(before, active));
            }
        }
        if self.t.counts.is_some() {
            let steps = self.memory(What::StepCount, Class::Scratch, Type::Lint);
            let transitions = self.memory(What::TransitionCount, Class::Scratch, Type::Lint);
            s.body.push(Stmt::Set(steps, Expr::long(0)));
            s.body.push(Stmt::Set(transitions, Expr::long(0)));
            let listed: Vec<u32> = self.steps().filter(|s| !self.extra(*s).uncounted).collect();
            for step in listed {
                let active = self.active(step);
                s.body.extend(Stmt::when(active, vec![add_one(steps)]));
            }
            for rank in self.countable() {
                let enabled = self.enabled(rank);
                let was = self.flag(What::Enabled(rank));
                s.body.push(Stmt::Set(was, enabled));
                s.body.extend(Stmt::when(Expr::Read(was), vec![add_one(transitions)]));
            }
        }
        s
    }

    /// Transitions of the text.
    fn countable(&self) -> Vec<u32> {
        let all = (0u32..).zip(&self.t.transitions);
        all.filter(|(_, t)| !t.uncounted).map(|(rank, _)| rank).collect()
    }

    fn enabled(&mut self, rank: u32) -> Expr {
        let Some(tr) = self.t.transitions.get(rank as usize) else { return Expr::truth(false) };
        let steps: Vec<u32> = self.preceding(tr).collect();
        Expr::all(steps.into_iter().map(|s| self.active(s)))
    }

    /// Actions of each scan, with their steps.
    fn periodics(&self) -> Vec<(u32, u32)> {
        self.steps()
            .flat_map(|step| {
                let rows = self.extra(step).periodics;
                (rows.start..rows.end).map(move |row| (row, step))
            })
            .collect()
    }

    /// No action waits for the end of the scan yet.
    pub(crate) fn nothing_late(&mut self) -> Section {
        let mut s = Section::new("No action waits for the end of the scan");
        for action in 0..self.t.actions.len() as u32 {
            if let Some(flag) = self.known(What::Late(action)) {
                s.body.push(lower(flag));
            }
        }
        s
    }

    /// The last part of a scan.
    pub(crate) fn finish(&mut self) -> Vec<Section> {
        let mut sections = vec![self.follow(), self.count()];
        if self.t.rules.periodic_first {
            sections.push(self.each_scan());
            sections.push(self.run_late());
        }
        sections.extend(self.control());
        if !self.t.rules.periodic_first {
            sections.push(self.each_scan());
        }
        sections.push(self.run_late());
        let mut post = Section::new("POST");
        post.body = self.work(self.t.post);
        post.body.extend(self.work(self.t.tail));
        sections.push(post);
        sections.push(self.limits());
        sections
    }

    /// Outputs that follow one step.
    fn follow(&mut self) -> Section {
        let mut s = Section::new("Outputs");
        for (i, step) in (0u32..).zip(&self.t.steps) {
            if step.direct.0 != NONE {
                let (output, _) = self.word(step.direct, Type::Bool);
                let active = self.active(i);
                s.body.push(Stmt::About(About::Step(StepId(i))));
                s.body.push(Stmt::Set(output, active));
            }
        }
        s
    }

    fn each_scan(&mut self) -> Section {
        let mut s = Section::new("Actions of each scan");
        for (row, step) in self.periodics() {
            let Some(action) = self.t.periodics.get(row as usize).copied() else { continue };
            let mut when = self.active(step);
            if self.t.rules.periodic_first {
                when = when.and(Expr::Read(self.flag(What::Periodic(row))));
            }
            let late = self.late(action);
            s.body.push(Stmt::About(About::Action(action)));
            s.body.extend(raise(late, when));
        }
        s
    }

    /// Runs what waits for the end of the scan, in order.
    fn run_late(&mut self) -> Section {
        let mut s = Section::new("Actions at the end of the scan");
        for action in 0..self.t.actions.len() as u32 {
            let Some(flag) = self.known(What::Late(action)) else { continue };
            let mut then = Vec::new();
            if self.t.rules.periodic_first {
                then.push(lower(flag));
            }
            then.extend(self.run(action));
            s.body.push(Stmt::About(About::Action(action)));
            s.body.extend(Stmt::when(Expr::Read(flag), then));
        }
        s
    }

    /// `%SW20` and `%SW21`: what was, and what changed in this scan.
    fn count(&mut self) -> Section {
        let mut s = Section::new("Counts of steps and transitions");
        let Some((steps, transitions)) = self.t.counts else { return s };
        let (step_count, transition_count) = (
            self.memory(What::StepCount, Class::Scratch, Type::Lint),
            self.memory(What::TransitionCount, Class::Scratch, Type::Lint),
        );
        for rank in self.countable() {
            let was = Expr::Read(self.flag(What::Enabled(rank)));
            let turns = self.enabled(rank).xor(was);
            s.body.extend(Stmt::when(turns, vec![add_one(transition_count)]));
        }
        for (addr, count) in [(steps, step_count), (transitions, transition_count)] {
            s.body.extend(at_most(count, 32767));
            let (to, _) = self.word(addr, Type::Int);
            s.body.push(Stmt::Set(to, Expr::Convert(Type::Lint, Type::Int, Box::new(Expr::Read(count)))));
        }
        s
    }

    /// More steps active or transitions enabled than the tables of the target hold.
    fn limits(&mut self) -> Section {
        let mut s = Section::new("The tables of the target");
        let Some((flag, limits)) = self.t.limits else { return s };
        let (flag, _) = self.word(flag, Type::Bool);
        let steps: Vec<Expr> =
            self.steps().filter(|s| !self.extra(*s).uncounted).map(|s| self.active_of(s)).collect();
        let enabled: Vec<Expr> = self.countable().into_iter().map(|r| self.enabled(r)).collect();
        for (list, most) in [(steps, limits.active), (enabled, limits.enabled)] {
            if list.len() <= most as usize {
                continue;
            }
            let count = self.temporary(Type::Lint);
            s.body.push(Stmt::Set(count, Expr::long(0)));
            for e in list {
                s.body.extend(Stmt::when(e, vec![add_one(count)]));
            }
            let over = Expr::Read(count).compare(Cmp::Gt, Type::Lint, Expr::long(most.into()));
            let then =
                vec![Stmt::Set(flag, Expr::truth(true)), Stmt::Fault(FaultKind::Table, Span::default())];
            s.body.extend(Stmt::when(over, then));
        }
        s
    }

    fn active_of(&self, step: u32) -> Expr {
        self.known(What::Step(StepId(step))).map_or_else(|| Expr::truth(false), Expr::Read)
    }
}
